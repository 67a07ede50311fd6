"""latex: expressions, names and definitions as LaTeX, the one source of typeset mathematics."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

import sympy
from sympy.core.function import AppliedUndef
from sympy.printing.latex import LatexPrinter

from geomtorsion.exact import PrintedOnce
from geomtorsion.pictures.text import GREEK, MOST_PRIMES, greek_name, ordered_terms, to_sympy
from geomtorsion.support.outgoing import latex_letters

if TYPE_CHECKING:
    from geomtorsion.geometry import Tensor

_NUMBERED = re.compile(r"(\D+?)_?([0-9]+)")
# Plain-text names of some letters in identities, as in Gamma_bar_ab^c.
_NAMES = {
    "Gamma_bar": "Γ\u0304", "R_bar": "R\u0304", "D_bar": "D\u0304", "Gamma": "Γ",
    "T_scalar": "T", "omega": "ω", "eta": "η",
}  # fmt: skip
_NAME = re.compile("|".join(_NAMES))
_ACCENTS = {"\u0304": "bar", "\u0303": "tilde"}
_COMMANDS = {letter: f"\\{name}" for name, letter in GREEK.items()}
_ACCENTED = re.compile(f"(.)([{''.join(_ACCENTS)}])")
_WORD = r"\b[A-Za-z][a-z]+(?![_^\w])"
_WORDS = re.compile(rf" ?{_WORD}(?:[ ,]+{_WORD})* ?")
# Stands for ] until indices are set, where it closes none of theirs.
_CLOSING = "\uf8ff"
_MARKS = re.compile(r"([_^])(?:\{([^{}]*)\}|(\[?[a-z0-9]+\]?))")


def latex_text(expression: object) -> str:
    r"""An expression in LaTeX: positive terms first, an upright e, a'(t) for d a/d t.

    Examples
    --------
    >>> r, M, phi = sympy.symbols("r M phi1", positive=True)
    >>> latex_text(1 - 2 * M / r), latex_text(sympy.exp(2 * r) * sympy.sin(phi) ** 2)
    ('1 - \\frac{2 M}{r}', '\\mathrm{e}^{2 r} \\sin^{2}{\\phi_{1}}')
    """
    return _Printer().doprint(to_sympy(expression))


def latex_name(name: str) -> str:
    r"""A name in LaTeX: Greek letters, a trailing number or the parts after _ as subscript.

    Examples
    --------
    >>> latex_name("phi1"), latex_name("x"), latex_name("mass"), latex_name("f_TT")
    ('\\phi_{1}', 'x', '\\operatorname{mass}', 'f_{TT}')
    """
    head, mark, tail = name.partition("_")
    if mark and head and tail:
        parts = [_subscript(x) for x in tail.split("_") if x]
        return f"{_scripted(latex_name(head))}_{{{' '.join(parts)}}}"
    numbered = _NUMBERED.fullmatch(name)
    if numbered:
        return f"{_scripted(latex_name(numbered[1]))}_{{{numbered[2]}}}"
    if name in GREEK:
        return f"\\{name}"
    letters = latex_letters(name)
    return letters if len(name) == 1 else f"\\operatorname{{{letters}}}"


def _subscript(part: str) -> str:
    """A part of a name below another; a letter that occurs twice, as in f_TT, is not a word."""
    is_plain = part.isascii() and part.isalnum() and (part.isdigit() or len(set(part)) == 1)
    return part if is_plain else latex_name(part)


def _scripted(latex: str) -> str:
    """A name that may have an index, ready for another."""
    return f"{{{latex}}}" if "_" in latex else latex


def equation_latex(text: str) -> str:
    r"""A definition in plain text, such as S_{ab}^c = T_{ab}^c/2, in LaTeX.

    Each index keeps its own column, words are upright.

    Examples
    --------
    >>> equation_latex("f^c = 2 S_a^c_b q'^a, where D_bar_a g_bc = 0")
    "f^{c} = 2\\,S_{a}{}^{c}{}_{b}\\,q'^{a},\\text{ where }\\bar D_{a}\\,g_{b c} = 0"
    >>> equation_latex("[E_i, E_j] = C_ij^k E_k"), equation_latex("A_[abc]")
    ('[E_{i}, E_{j}] = C_{i j}{}^{k}\\,E_{k}', 'A_{[ a b c ]}')
    """
    text = _NAME.sub(lambda match: _NAMES[match.group()], _commutators(text))
    text = re.sub(rf"(?:{_MARKS.pattern})+", lambda match: _staggered(match.group()), text)
    text = _WORDS.sub(lambda match: rf"\text{{{match.group()}}}", text)
    text = _ACCENTED.sub(lambda match: rf"\{_ACCENTS[match[2]]} {match[1]}", text)
    # A blank between two factors is a thin space.
    text = re.sub(r"(?<=[}0-9]) (?=[^\W\d_]|[∂(\\])", r"\\,", text)
    return text.replace(_CLOSING, "]")


def _commutators(text: str) -> str:
    """The text with brackets that do not begin in an index, [X_a, Y_b], kept out of indices."""
    of_indices: list[bool] = []
    signs = list(text)
    for place, sign in enumerate(signs):
        if sign == "[":
            of_indices.append(text[:place].endswith(("_", "^")))
        elif sign == "]" and not (of_indices and of_indices.pop()):
            signs[place] = _CLOSING
    return "".join(signs)


def _staggered(marks: str) -> str:
    """Indices with an empty base between those below and those above."""
    written = [
        f"{sign}{{{' '.join((braced or bare).replace(' ', ''))}}}"
        for sign, braced, bare in _MARKS.findall(marks)
    ]
    return "{}".join(written)


def latex_symbol(symbol: str) -> str:
    r"""A letter, perhaps with a combining accent, in LaTeX.

    Examples
    --------
    >>> latex_symbol("ω"), latex_symbol("Γ\u0304"), latex_symbol("E\u0303")
    ('\\omega', '\\bar\\Gamma', '\\tilde E')
    """
    letter = _COMMANDS.get(symbol[0], symbol[0])
    accents = "".join(f"\\{_ACCENTS[mark]}" for mark in symbol[1:])
    return f"{accents} {letter}" if accents and letter.isalpha() else f"{accents}{letter}"


def latex_matrix(rows: Sequence[Sequence[str]]) -> str:
    """A matrix of formulas.

    Examples
    --------
    >>> latex_matrix([["1", "0"], ["0", "r"]])
    '\\\\begin{pmatrix} 1 & 0 \\\\\\\\ 0 & r \\\\end{pmatrix}'
    """
    body = r" \\ ".join(" & ".join(row) for row in rows)
    return rf"\begin{{pmatrix}} {body} \end{{pmatrix}}"


class _Printer(PrintedOnce, LatexPrinter):
    """sympy's LaTeX, with the order of terms, the primes and the brackets of a person."""

    _default_settings = LatexPrinter._default_settings | {"inv_trig_style": "full"}

    def _as_ordered_terms(self, expr: sympy.Add, order: object = None) -> list[sympy.Expr]:
        return ordered_terms(expr)

    def _print_Symbol(self, expr: sympy.Symbol, style: str = "plain") -> str:
        return latex_name(expr.name)

    def _print_Exp1(self, expr: sympy.Expr, exp: str | None = None) -> str:
        return r"\mathrm{e}"

    def _print_ExpBase(self, expr: sympy.Expr, exp: str | None = None) -> str:
        # Upright, so that it is not mistaken for a one-form e^1.
        power = rf"\mathrm{{e}}^{{{self._print(expr.args[0])}}}"
        return power if exp is None else rf"\left({power}\right)^{{{exp}}}"

    def _print_Function(self, expr: sympy.Expr, exp: str | None = None) -> str:
        power = "" if exp is None else f"^{{{exp}}}"
        inner = ", ".join(self._print(argument) for argument in expr.args)
        name = type(expr).__name__
        if isinstance(expr, AppliedUndef):
            return rf"{latex_name(name)}\left({inner}\right){power}"
        # Many physicists read log as base ten; ln is unambiguous.
        name = {"log": "ln"}.get(name, re.sub("^a(?=sin|cos|tan)", "arc", name))
        head = rf"\{name}" if name in FUNCTIONS else rf"\operatorname{{{name}}}"
        simple = len(expr.args) == 1 and (expr.args[0].is_Symbol or expr.args[0].is_Integer)
        return rf"{head}{power}{{{inner}}}" if simple else rf"{head}{power}\left({inner}\right)"

    _print_log = _print_Function

    def _print_Derivative(self, expr: sympy.Derivative) -> str:
        function = expr.expr
        if not isinstance(function, AppliedUndef):
            return super()._print_Derivative(expr)
        name = latex_name(function.func.__name__)
        inner = ", ".join(self._print(argument) for argument in function.args)
        count = int(expr.derivative_count)
        # Primes would not show which of several arguments is meant.
        if len(function.args) > 1:
            by = " ".join(self._print(v) for v, n in expr.variable_count for _ in range(int(n)))
            name = rf"\partial_{{{by}}} {name}"
        else:
            name += "'" * count if count <= MOST_PRIMES else f"^{{({count})}}"
        return rf"{name}\left({inner}\right)"


# Functions that LaTeX has commands for, and that sympy prints.
FUNCTIONS = "sin cos tan cot sec csc sinh cosh tanh coth ln arcsin arccos arctan".split()


Index = tuple[int, ...]


def letters(slots: str) -> list[str]:
    """A letter for each slot: a, b, c, ... for coordinates, i, j, k, ... for frame vectors.

    Examples
    --------
    >>> letters("dDU")
    ['a', 'i', 'j']
    """
    coordinate, frame = iter("abcdefgh"), iter("ijklmnpq")
    return [next(frame) if slot in "DU" else next(coordinate) for slot in slots]


def text_label(symbol: str, marks: Sequence[str], slots: str) -> str:
    """Symbol with marks below and above, in order.

    Examples
    --------
    >>> text_label("Γ", ["t", "r", "t"], "ddu"), text_label("Γ", ["φ1", "φ2", "φ1"], "ddu")
    ('Γ_{tr}^t', 'Γ_{φ1 φ2}^{φ1}')
    """
    parts = [symbol]
    for up, run in _runs(marks, slots):
        text = ("" if all(len(mark) == 1 for mark in run) else " ").join(run)
        parts.append(f"{'^' if up else '_'}{text if len(text) == 1 else f'{{{text}}}'}")
    return "".join(parts)


def latex_label(symbol: str, marks: Sequence[str], slots: str) -> str:
    """Symbol with marks below and above, each kept in its own column.

    Examples
    --------
    >>> latex_label("S", ["t", "r", "t"], "ddu")
    'S_{t r}{}^{t}'
    """
    parts = [symbol]
    for number, (up, run) in enumerate(_runs(marks, slots)):
        gap = "{}" if number else ""
        parts.append(f"{gap}{'^' if up else '_'}{{{' '.join(run)}}}")
    return "".join(parts)


def text_marks(tensor: Tensor, index: Index, *, greek: bool = True) -> list[str]:
    """Index values as text: names of coordinates, numbers of frame vectors counted from 1."""
    names = [symbol.name for symbol in tensor.frame.coordinates]
    shown = [greek_name(name) for name in names] if greek else names
    return [str(k + 1) if slot in "DU" else shown[k] for slot, k in _places(tensor, index)]


def latex_marks(tensor: Tensor, index: Index) -> list[str]:
    """Index values in LaTeX: names of coordinates, numbers of frame vectors from 1, with a hat."""
    names = [latex_name(symbol.name) for symbol in tensor.frame.coordinates]
    return [rf"\hat{{{k + 1}}}" if slot in "DU" else names[k] for slot, k in _places(tensor, index)]


def _places(tensor: Tensor, index: Index) -> list[tuple[str, int]]:
    return list(zip(tensor.slots, index, strict=True))


def _runs(marks: Sequence[str], slots: str) -> list[tuple[bool, list[str]]]:
    """Adjacent marks, with whether they are upper ones."""
    pairs = list(zip(slots, marks, strict=True))
    runs = groupby(pairs, key=lambda pair: pair[0] in "uU")
    return [(up, [mark for _, mark in run]) for up, run in runs]

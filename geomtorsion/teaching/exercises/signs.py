"""Signs: LaTeX, Unicode and other systems' names as text in keyboard signs."""

from __future__ import annotations

import re
import unicodedata
from itertools import groupby
from types import MappingProxyType

from geomtorsion.errors import ExpressionError
from geomtorsion.support.checks import GREEK

_SPACES = re.compile(
    r"\\(?:left|right|bigg?[lr]?|Bigg?[lr]?|displaystyle|textstyle|quad|qquad|[,;:! ])(?![A-Za-z])"
    r"|\\[,;:! ]|\$"
)
_PRODUCT = re.compile(r"\\(?:cdot|times|ast)(?![A-Za-z])")
_UPRIGHT = re.compile(r"\\(?:mathrm|mathit|mathbf|text|operatorname)\s*\{([^{}]*)\}")
_LETTERS = {"varphi": "phi", "vartheta": "theta", "varepsilon": "epsilon", "arctan": "atan",
            "arcsin": "asin", "arccos": "acos"}  # fmt: skip
_DOT = re.compile(r"\\(d?)dot\s*(?:\{\s*\\?([A-Za-z]+)\s*((?:_\{?[0-9]+\}?)?)\s*\}|\\?([A-Za-z]+))"
                  r"\s*((?:_\{?[0-9]+\}?)?)")  # fmt: skip
_INDEX = re.compile(r"_\s*\{\s*(\w+)\s*\}")
_MATRIX = re.compile(r"\\begin\{(\w*(?:matrix|array))\}(?:\{[lcr|]*\})?(.*?)\\end\{\1\}", re.DOTALL)


def without_latex(text: str) -> str:
    r"""A formula of LaTeX as plain text; unknown commands are unchanged.

    Examples
    --------
    >>> without_latex(r"\frac{\sin\phi_{1}}{2}"), without_latex(r"\dot{\Omega}_1 = \sqrt{x}")
    ('(( sin phi_1)/(2))', "Omega_1' = sqrt(x)")
    >>> without_latex(r"\begin{pmatrix} 1 & 0 \\ 0 & r \end{pmatrix}")
    '[[1, 0], [0, r]]'
    """
    text = re.sub(r"\\delta\s*\\([A-Z])", r"\\d\1", text)
    text = _PRODUCT.sub("*", _SPACES.sub(" ", re.sub(r"\\\\(?=[^A-Za-z]|$)", "\0", text)))
    text = _UPRIGHT.sub(r"\1", _DOT.sub(_rate, text))
    text = _MATRIX.sub(_rows, text.replace("\0", "\\\\"))
    text = _without_braces(text)
    text = _INDEX.sub(r"_\1", text)
    return re.sub(r"\\([A-Za-z]+)", lambda m: f" {_LETTERS.get(m[1], m[1])}", text).strip()


def _rate(match: re.Match[str]) -> str:
    """A letter with dots as a name with primes."""
    name, index = match[2] or match[4], re.sub(r"[{}]", "", (match[3] or "") + match[5])
    return f" {name}{index}{chr(39) * (1 + bool(match[1]))} "


def _rows(match: re.Match[str]) -> str:
    """A matrix as nested lists."""
    rows = [row for row in match[2].split("\\\\") if row.strip()]
    cells = ("[" + ", ".join(cell.strip() for cell in row.split("&")) + "]" for row in rows)
    return f"[{', '.join(cells)}]"


_BRACES = r"\s*\{([^{}]*)\}"
# A part of a fraction that is one sign, such as 2, r or \phi, needs no braces.
_PART = rf"\s*(?:\{{([^{{}}]*)\}}|([0-9A-Za-z]|\\(?:{'|'.join(GREEK)})(?![A-Za-z])))"
_QUOTIENT = re.compile(r"\\[dtc]?frac(?![A-Za-z])" + _PART + _PART)
_ROOT = re.compile(r"\\sqrt\s*(?:\[\s*([0-9]+)\s*\])?" + _BRACES)
_SCRIPT = re.compile(r"([_^])" + _BRACES)
_ARGUMENT = re.compile(r"(\\(?![dtc]?frac|sqrt)[A-Za-z]+)" + _BRACES)


def _without_braces(text: str) -> str:
    """Quotients, roots, scripts and arguments with round brackets, from the inside out."""
    while True:
        before = text
        text = _QUOTIENT.sub(r"((\1\2)/(\3\4))", text)
        text = _ROOT.sub(_root, text)
        text = _SCRIPT.sub(_script, text)
        text = _ARGUMENT.sub(r"\1(\2)", text)
        if text == before:
            return text


def _script(match: re.Match[str]) -> str:
    simple = match[1] == "_" and match[2].strip().isalnum()
    return match[1] + (match[2].strip() if simple else f"({match[2]})")


def _root(match: re.Match[str]) -> str:
    return f"({match[2]})^(1/{match[1]})" if match[1] else f"sqrt({match[2]})"


# How Unicode marks a sign as a superscript or subscript -> how it is typed.
_SMALL = MappingProxyType({"<super>": "^({})", "<sub>": "_{}"})
_SIGNS = str.maketrans(
    {
        **dict.fromkeys("−–—‐‑﹣", "-"), **dict.fromkeys("×⋅·∙•∗", "*"),
        **dict.fromkeys("÷∕⁄", "/"), **dict.fromkeys("′’‘`´", "'"), "″": "''", "√": " sqrt ",
        "∛": " cbrt ", "½": "(1/2)", "¼": "(1/4)", "¾": "(3/4)", "⅓": "(1/3)", "⅔": "(2/3)",
        "“": '"', "”": '"', **dict.fromkeys("\u200b\u200c\u200d\u2060\ufeff", None),
    }
)  # fmt: skip
_DOTTED = re.compile("([^\\W\\d_])([\u0307\u0308])(_?[0-9]*)")
# Constants as Maxima writes them.
_MAXIMA = MappingProxyType({"pi": "pi", "e": "E", "i": "I"})
_PERCENT = re.compile(r"%(pi|e|i)\b")
_BARS = re.compile(r"\|([^|]+)\|")
_LIBRARY = re.compile(r"\b(?:np|numpy|math|cmath|mpmath|sp|sympy)\.(?=[A-Za-z])")


def plain_signs(text: str, where: str) -> str:
    """Text in keyboard signs: superscripts, subscripts, LaTeX and other minus signs are replaced.

    Examples
    --------
    >>> plain_signs("−φ₁² · √2", "q"), plain_signs(r"\\frac{1}{2}\\cos^2\\phi_{1}", "q")
    ('-φ_1^(2) *  sqrt 2', '((1)/(2)) cos^2 phi_1')
    """
    if re.search("[0-9][½¼¾⅓⅔]", text):
        raise ExpressionError(
            f"{where}: expected one number, got a number in front of a fraction sign. Write 5/2 "
            "for two and a half."
        )
    text = "".join(_full_size(kind, "".join(run)) for kind, run in groupby(text, _small_kind))
    text = text.translate(_SIGNS)
    # Compatible forms of letters are one letter; composed dots are taken apart first.
    text = unicodedata.normalize("NFKC", text)
    text = _DOTTED.sub(_primed, unicodedata.normalize("NFD", text))
    text = unicodedata.normalize("NFC", text)
    text = re.sub(r"_\s*\{\s*(\w+)\s*\}", r"_\1", _LIBRARY.sub("", text))
    text = _PERCENT.sub(lambda match: f" {_MAXIMA[match[1]]}", text)
    text = without_latex(text) if "\\" in text or "$" in text else text
    return _BARS.sub(r" abs(\1)", text)


def _small_kind(sign: str) -> str:
    kind = unicodedata.decomposition(sign).partition(" ")[0]
    return kind if kind in _SMALL else ""


def _full_size(kind: str, run: str) -> str:
    return _SMALL[kind].format(unicodedata.normalize("NFKC", run)) if kind else run


def _primed(match: re.Match[str]) -> str:
    return match[1] + match[3] + "'" * (1 + (match[2] == "\u0308"))

"""formula: LaTeX as MathML Core for a browser, and the font that it is set in."""

from __future__ import annotations

import base64
import re
from functools import cache
from pathlib import Path

from math_core import LatexError, LatexToMathML

from geomtorsion.errors import ExpressionError
from geomtorsion.pictures.latex import FUNCTIONS as latex_functions
from geomtorsion.pictures.latex import latex_text
from geomtorsion.pictures.text import GREEK
from geomtorsion.support.checks import cut

# LaTeX has no commands for capitals that look Latin.
LETTERS = GREEK | {"epsilon": "ϵ", "varepsilon": "ε"}
_MACROS = LETTERS | {"ldots": "…", "overline": r"\bar{#1}"}
_WORDS = re.compile(r"(\\(?:text|mathrm|operatorname)\{[^{}]*\})")
_CAPITAL = re.compile("<mi>([Α-Ω])</mi>")
# Brackets around content no higher than themselves, without other such brackets inside.
_LOW = re.compile(
    r"\\left([(\[|])((?:(?!\\left|\\right|\\[dt]?frac|\\sqrt|\\begin).)*)\\right([)\]|])"
)
FUNCTIONS = (*latex_functions, "log", "exp", "det")
# The formulas of a text in Markdown: a display between $$, or a formula between $.
FORMULA = re.compile(r"\$\$(.+?)\$\$|\$(.+?)\$", re.DOTALL)
# A function, perhaps with a power, before an argument in braces that needs no brackets.
_NAMED = re.compile(rf"(\\(?:{'|'.join(FUNCTIONS)})(?:\^\{{[^{{}}]*\}})?)(?=\{{(?!\(|\\left))")


def mathml(latex: str, *, display: bool = False, tall: bool = False) -> str:
    r"""A formula as a math element.

    Parameters
    ----------
    display
        It has a line of its own.
    tall
        Fractions are as large as in a line of their own.

    Raises
    ------
    ExpressionError
        The formula has an unknown command, or braces that do not match.

    Examples
    --------
    >>> mathml("x_1")
    '<math><msub><mi>x</mi><mn>1</mn></msub></math>'
    """
    text = converted(_for_browsers(latex), display=display)
    text = _CAPITAL.sub(r'<mi mathvariant="normal">\1</mi>', text)
    return text.replace("<math>", '<math displaystyle="true">', 1) if tall else text


def _for_browsers(latex: str) -> str:
    """A formula with the space that browsers set around primes, brackets and functions."""
    # As the superscript of a letter a prime is too small to see.
    parts = _WORDS.split(latex)
    parts[::2] = [part.replace("'", r"{\prime}") for part in parts[::2]]
    primed, count = "".join(parts), 1
    while count:
        # Browsers set more space beside a bracket that may grow, even where it does not.
        primed, count = _LOW.subn(r"\1\2\3", primed)
    # A browser sets no space after the name of a function.
    return _NAMED.sub(r"\1\\,", primed)


# A percent sign that begins a comment of LaTeX: the backslashes before it make pairs.
_COMMENT = re.compile(r"(?<!\\)(?:\\\\)*%")


def fault(text: str) -> str:
    r"""The reason why a formula of a text cannot be set; empty if all formulas can.

    text: Markdown with formulas between dollar signs.

    Examples
    --------
    >>> fault(r"Let $r$ be $\frac{1}{2}$."), fault("5 cm")
    ('', '')
    >>> print(fault(r"Let $\frac{1$ be $r$."))
    the formula $\frac{1$: expected closing token "}", but reached end of input
    >>> print(fault("Let $r be the radius."))
    expected a second $ after '$r be the radius.', got none
    >>> print(fault(r"$5\%$ of $r %$ is small."))
    the formula $r %$: % hides the rest of its line; write \%
    """
    for match in FORMULA.finditer(text):
        latex = match[1] or match[2]
        if _COMMENT.search(latex):
            return f"the formula {cut(match[0], 80)}: % hides the rest of its line; write \\%"
        try:
            _convert(_for_browsers(latex))
        except LatexError as error:
            # The number before the reason counts characters of the rewritten formula.
            reason = str(error).split(": ", 1)[-1].rstrip(".")
            return f"the formula {cut(match[0], 80)}: {reason[:1].lower()}{reason[1:]}"
    rest = FORMULA.sub("", text)
    if "$" in rest:
        return f"expected a second $ after {cut(rest[rest.index('$') :], 30)!r}, got none"
    return ""


def converted(latex: str, *, display: bool = False) -> str:
    """A formula as XML, as the library makes it."""
    try:
        text = _convert(latex, display=display)
    except LatexError as error:
        raise ExpressionError(f"formula {latex!r}: {error}") from None
    # XML has no name for this sign.
    return text.replace("&ApplyFunction;", "\u2061")


def _convert(latex: str, *, display: bool = False) -> str:
    return str(_converter().convert_with_local_state(latex, displaystyle=display))


@cache
def _converter() -> LatexToMathML:
    return LatexToMathML(macros=_MACROS, fancy_error=False)


def expression_mathml(expression: object) -> str:
    """An expression as a math element.

    Examples
    --------
    >>> import sympy
    >>> expression_mathml(1 - sympy.Symbol("r"))
    '<math><mn>1</mn><mo>−</mo><mi>r</mi></math>'
    """
    return mathml(latex_text(expression))


# Permission for the embedded font on a page that forbids all loading.
FONT_SOURCE = "font-src data:"
FAMILY = "geomtorsion math"


@cache
def font_face() -> str:
    """Style that brings the font inside the page and sets all formulas in it.

    Examples
    --------
    >>> font_face().count("@font-face"), "http" in font_face()
    (1, False)
    """
    data = Path(__file__).with_name("fonts").joinpath("stix-two-math.woff2").read_bytes()
    text = base64.b64encode(data).decode()
    return (
        f'@font-face {{ font-family: "{FAMILY}"; font-display: block; '
        f'src: url("data:font/woff2;base64,{text}") format("woff2"); }}\n'
        f'math {{ font-family: "{FAMILY}", math; }}\n'
    )

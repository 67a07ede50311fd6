r"""latex_input: LaTeX in an answer, as signs of a keyboard: \frac{a}{b} is ((a)/(b))."""

from __future__ import annotations

import re

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
    r"""A formula of LaTeX as plain text; what is not known stays as it is.

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
    text = re.sub(r"\\[dtc]?frac\s*([0-9])\s*([0-9])", r"((\1)/(\2))", text)
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
_QUOTIENT = re.compile(r"\\[dtc]?frac" + _BRACES + _BRACES)
_ROOT = re.compile(r"\\sqrt\s*(?:\[\s*([0-9]+)\s*\])?" + _BRACES)
_SCRIPT = re.compile(r"([_^])" + _BRACES)
_ARGUMENT = re.compile(r"(\\(?![dtc]?frac|sqrt)[A-Za-z]+)" + _BRACES)


def _without_braces(text: str) -> str:
    """Quotients, roots, scripts and arguments with round brackets, from the inside out."""
    while True:
        before = text
        text = _QUOTIENT.sub(r"((\1)/(\2))", text)
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

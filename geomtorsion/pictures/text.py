"""text: expressions on one line, as a person would type them, in Greek where that can be shown."""

from __future__ import annotations

import re

import sympy
from sympy.core.function import AppliedUndef
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.str import StrPrinter

from geomtorsion.errors import ExpressionError
from geomtorsion.exact import PrintedOnce
from geomtorsion.support import checks
from geomtorsion.support.checks import expression as expression_of

# Letters by the names that LaTeX has for them.
GREEK = checks.GREEK | {"varphi": "φ", "vartheta": "ϑ", "ell": "ℓ"}
_NAME = re.compile(r"([A-Za-z]+?)_?([0-9]*)")
# Nobody counts four primes.
MOST_PRIMES = 3


def greek_name(name: str) -> str:
    """The name of a symbol with its Greek letter, where it is the name of one.

    Examples
    --------
    >>> [greek_name(name) for name in ("theta", "phi1", "Gamma", "theta_0", "M", "mass")]
    ['θ', 'φ1', 'Γ', 'θ0', 'M', 'mass']
    """
    match = _NAME.fullmatch(name)
    if match and match[1] in GREEK:
        return GREEK[match[1]] + match[2]
    return name


def greek_words(text: str) -> str:
    """Words of a sentence with the Greek letters they name.

    Examples
    --------
    >>> greek_words("momentum of phi")
    'momentum of φ'
    """
    return re.sub(r"[A-Za-z]+[0-9]*", lambda match: greek_name(match.group()), text)


def expression_text(expression: object, *, greek: bool = True) -> str:
    """One line of text for an expression: positive terms first, ^ for powers, a'(t) for d a/d t.

    Without Greek letters the text can be read back by ``parse_expression``.

    Examples
    --------
    >>> r, M, theta = sympy.symbols("r M theta", positive=True)
    >>> expression_text(sympy.sqrt(1 - 2 * M / r) * sympy.sin(theta) ** 2)
    'sqrt(1 - 2*M/r)*sin(θ)^2'
    >>> a = sympy.Function("a")(r)
    >>> expression_text(a.diff(r, 2) / a), expression_text(a.diff(r, 2) / a, greek=False)
    ("a''(r)/a(r)", 'diff(a(r), r, 2)/a(r)')
    """
    return _Printer(greek=greek).doprint(to_sympy(expression)).replace("**", "^")


def to_sympy(expression: object) -> sympy.Basic:
    """The expression as a sympy object; no text is read as code."""
    if isinstance(expression, sympy.Basic):
        return expression
    return expression_of(expression, "expression", ExpressionError)


def plain_text(expression: object) -> str:
    """An expression as text that ``parse_expression`` reads back."""
    return expression_text(expression, greek=False)


def ordered_terms(expression: sympy.Add) -> list[sympy.Expr]:
    """Terms of a sum in sympy's order, but with a positive one in front where there is one.

    Examples
    --------
    >>> r, M = sympy.symbols("r M")
    >>> ordered_terms(1 - 2 * M / r)
    [1, -2*M/r]
    """
    terms: list[sympy.Expr] = list(expression.as_ordered_terms())
    first = next((k for k, term in enumerate(terms) if not term.could_extract_minus_sign()), 0)
    return [terms[first], *terms[:first], *terms[first + 1 :]]


class _Printer(PrintedOnce, StrPrinter):
    """sympy's own text, with the order of terms, Greek letters and primes of a person."""

    def __init__(self, *, greek: bool) -> None:
        super().__init__()
        self.greek = greek

    def _name(self, name: str) -> str:
        return greek_name(name) if self.greek else name

    def _print_Symbol(self, expr: sympy.Expr) -> str:
        return self._name(expr.name)

    def _print_Pi(self, expr: sympy.Expr) -> str:
        return "π" if self.greek else "pi"

    def _as_ordered_terms(self, expr: sympy.Add, order: object = None) -> list[sympy.Expr]:
        return ordered_terms(expr)

    # sympy writes r**(-2); a person writes 1/r^2.
    def _print_Pow(self, expr: sympy.Expr, rational: bool = False) -> str:
        base, exponent = expr.args
        if exponent.is_Integer and exponent < -1:
            return f"1/{self.parenthesize(base**-exponent, PRECEDENCE['Mul'], strict=True)}"
        return super()._print_Pow(expr, rational=rational)

    def _print_Function(self, expr: sympy.Expr) -> str:
        arguments = ", ".join(self._print(argument) for argument in expr.args)
        return f"{self._name(expr.func.__name__)}({arguments})"

    def _print_Derivative(self, expr: sympy.Expr) -> str:
        function = expr.expr
        if self.greek and isinstance(function, AppliedUndef) and len(function.args) == 1:
            count = expr.derivative_count
            primes = "'" * count if count <= MOST_PRIMES else f"^({count})"
            return f"{self._name(function.func.__name__)}{primes}({self._print(function.args[0])})"
        steps = []
        for variable, count in expr.variable_count:
            steps += [self._print(variable), *([str(count)] if count != 1 else [])]
        return f"diff({self._print(function)}, {', '.join(steps)})"

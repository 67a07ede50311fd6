"""Engine code: sums of products of elements as plain Python code or as heyoka expressions."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import MissingValueError
from geomtorsion.exact.compile import Program
from geomtorsion.exact.form import Sum, form
from geomtorsion.exact.generators import Generator

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from geomtorsion.exact.element import Element

# A sum of products: pairs (element, names of the arguments that multiply it).
Products = tuple[tuple["Element", tuple[str, ...]], ...]


def python_source(arguments: Sequence[str], outputs: Sequence[Products]) -> tuple[str, set[str]]:
    """Source of `values(arguments...)` that returns a tuple, and the functions that it calls.

    The functions bear NumPy's names; `scalar_names` has them for Python floats.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> x = sympy.Symbol("x")
    >>> source, _ = python_source(["x", "v"], [((Field([x]).read(2 * x), ("v", "v")),)])
    >>> print(source)
    def values(a0, a1):
        return (2.0*a0*a1*a1,)
    """
    program = Program(arguments)
    place = {name: f"a{k}" for k, name in enumerate(arguments)}
    kept: dict[Element, str] = {}
    results = []
    for products in outputs:
        parts = []
        for element, factors in products:
            if element not in kept:
                kept[element] = program.element(element)
                if not _is_short(kept[element]):
                    kept[element] = program._stored(("element", element), kept[element])
            names = [place[name] for name in factors]
            code = kept[element]
            if names and code in ("1.0", "-1.0"):
                parts.append(code.replace("1.0", "") + "*".join(names))
            else:
                parts.append("*".join([code, *names]))
        results.append(" + ".join(parts) or "0.0")
    header = f"def values({', '.join(place.values())}):"
    ending = f"return ({', '.join(results)}{',' * bool(results)})"
    return "\n    ".join([header, *program.lines, ending]), program.functions


def _is_short(code: str) -> bool:
    """Whether code is cheap enough to stand in every product."""
    return code.count("*") < 2 and not any(sign in code for sign in "(/+")


def array_names(functions: set[str]) -> dict[str, Any]:
    """NumPy functions, for code that runs on arrays."""
    import numpy

    return {name: getattr(numpy, name) for name in functions}


def scalar_names(functions: set[str]) -> dict[str, Any]:
    """Functions of the math module, for code that runs on floats (ten times faster there)."""
    import math

    other = {
        "arctan": "atan", "arcsin": "asin", "arccos": "acos", "arcsinh": "asinh",
        "arccosh": "acosh", "arctanh": "atanh", "arctan2": "atan2",
    }  # fmt: skip
    return {name: getattr(math, other.get(name, name)) for name in functions}


class HeyokaWriter:
    """Elements as heyoka expressions, each subexpression made once.

    arguments
        name of a symbol -> heyoka expression.
    number
        rational number p/q as heyoka expression, rounded correctly at the precision in use.
    """

    def __init__(self, arguments: Mapping[str, Any], number: Callable[[int, int], Any]) -> None:
        self._heyoka: Any = import_module("heyoka")
        self._arguments = dict(arguments)
        self._number = number
        self._known: dict[Any, Any] = {}

    def products(self, terms: Products) -> Any:
        """A sum of products."""
        parts = []
        for element, factors in terms:
            value = self._known.get(element)
            if value is None:
                value = self._known[element] = self.element(element)
            names = [self._arguments[name] for name in factors]
            if names and element.is_rational and abs(element.as_fraction()) == 1:
                product = self._heyoka.prod(names)
                parts.append(product if element.as_fraction() == 1 else -product)
            else:
                parts.append(self._heyoka.prod([value, *names]))
        return self._heyoka.sum(parts) if parts else self._number(0, 1)

    def element(self, element: Element) -> Any:
        """One element."""
        written = form(element)
        above, below = [], []
        for base, exponent in written.powers:
            (above if exponent > 0 else below).append(self._power(base, abs(exponent)))
        value = written.coefficient
        p, q = int(value.p), int(value.q)
        if (p, q) != (1, 1) or not above:
            above.insert(0, self._number(p, q))
        result = self._heyoka.prod(above)
        return result / self._heyoka.prod(below) if below else result

    def _power(self, base: Generator | Sum, exponent: int) -> Any:
        key = (base, exponent)
        if key not in self._known:
            if exponent > 1:
                self._known[key] = self._power(base, 1) ** float(exponent)
            elif isinstance(base, Generator):
                self._known[key] = self._generator(base)
            else:
                self._known[key] = self._sum(base)
        return self._known[key]

    def _sum(self, base: Sum) -> Any:
        parts = []
        for value, monomial in base.terms:
            factors = [self._power(generator, exponent) for generator, exponent in monomial]
            p, q = int(value.p), int(value.q)
            if (p, q) != (1, 1) or not factors:
                factors.insert(0, self._number(p, q))
            parts.append(self._heyoka.prod(factors))
        return self._heyoka.sum(parts)

    def _generator(self, generator: Generator) -> Any:
        shown = str(generator.shown)
        if shown in self._arguments:
            return self._arguments[shown]
        kind, argument, tail = generator.kind, generator.argument, generator.tail
        hy = self._heyoka
        if kind in ("cos", "sin", "cosh", "sinh", "chebyshev"):
            return getattr(hy, "cos" if kind == "chebyshev" else kind)(self.element(argument[0]))
        if kind in ("exp", "log"):
            return getattr(hy, kind)(self.element(argument))
        if kind == "root" and tail is not None:
            inner = self.element(tail)
            if generator.degree == 2:
                return hy.sqrt(inner)
            return inner ** self._number(1, generator.degree)
        if kind == "primitive":
            name = type(generator.shown).__name__
            if name in ("acot", "acoth"):
                partner = {"acot": "atan", "acoth": "atanh"}[name]
                return getattr(hy, partner)(self.element(1 / argument[0]))
            return getattr(hy, name)(*(self.element(part) for part in argument[2]))
        if not generator.depends:
            from fractions import Fraction

            digits = Fraction(str(generator.shown.evalf(60)))
            return self._number(digits.numerator, digits.denominator)
        raise MissingValueError(
            f"{generator.shown} has no value in these equations (known are "
            f"{', '.join(self._arguments)}); replace it by an expression in them"
        )

"""Numeric field: arrays of numbers with the interface of exact components.

A frame over such a field gives torsion, curvature and field equations by the formulas of the exact
one, evaluated on power series or grids, without an expression that could grow.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

import numpy as np
import sympy as sp
from flint import arb, fmpq

from geomtorsion.codegen import Graph, balls, graph
from geomtorsion.errors import GravityError, MissingValueError
from geomtorsion.exact import Certainty, Element


class Arithmetic(Protocol):
    """Arithmetic of arrays: power series, or values on a grid."""

    def raised(self, number: Any) -> np.ndarray:
        """A constant as an array."""
        ...

    def shifted(self, series: np.ndarray, number: Any) -> np.ndarray:
        """An array plus a constant."""
        ...

    def multiply(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """The product of two arrays."""
        ...

    def derivative(self, a: np.ndarray, mu: int, /) -> np.ndarray:
        """The partial derivative by a coordinate."""
        ...

    def inverse(self, b: np.ndarray) -> np.ndarray:
        """1 over an array."""
        ...

    def root(self, b: np.ndarray, degree: int) -> np.ndarray:
        """A root."""
        ...

    def power(self, b: np.ndarray, exponent: Any) -> np.ndarray:
        """A power with a constant exponent."""
        ...

    def call(self, name: str, b: np.ndarray) -> np.ndarray:
        """A function by its name."""
        ...

    def slope(self, name: str, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        """The derivative of a function by its argument."""
        ...

    def product_matrix(self, b: np.ndarray) -> np.ndarray:
        """The matrix that multiplies rows of coefficients."""
        ...


class Numeric(Element):
    """A number, or an array of numbers, as a component.

    value: a number for a constant, otherwise an array of the arithmetic.
    slope: coefficients of the linear operator that maps small changes of the fields to the change
        of this component, shape (fields, multi-indices of derivatives, coefficients); None for a
        component that does not change.
    fraction: the rational number that the component is, or None.
    depth: number of derivatives taken on the way, the last orders of a series that are not known.
    """

    __slots__ = ("depth", "fraction", "slope", "value")

    # The shared arithmetic of elements then asks for no polynomial.
    is_kept = True
    _level = -1
    _field: Any

    def __init__(
        self,
        field: NumericField,
        value: Any,
        slope: np.ndarray | None = None,
        fraction: Fraction | None = None,
        depth: int = 0,
    ) -> None:
        self._field, self.value, self.slope, self.fraction = field, value, slope, fraction
        self.depth = depth
        self._bits = self._diffs = self._form = self._hash = self._images = self._sympy = None

    @property
    def is_constant(self) -> bool:
        """Whether the value is one number."""
        return not isinstance(self.value, np.ndarray)

    @property
    def is_zero(self) -> bool | None:
        """Whether the component is the number zero; a rounded value is never decided to vanish."""
        return self.fraction == 0

    @property
    def is_rational(self) -> bool:
        """Whether the component is a rational number."""
        return self.fraction is not None

    @property
    def is_one(self) -> bool:
        """Whether the component is the number one."""
        return self.fraction == 1

    @property
    def length(self) -> float:
        """One term: arrays do not grow."""
        return 1

    def as_fraction(self) -> Fraction:
        """See Element.as_fraction."""
        if self.fraction is None:
            raise ValueError("not a rational number")
        return self.fraction

    @property
    def symbols(self) -> frozenset[sp.Symbol]:
        """No symbols: only numbers are left."""
        return frozenset()

    def written_as(self, expression: sp.Expr) -> Element:
        """Itself: arrays are not written."""
        return self


@dataclass(eq=False)
class NumericField:
    """Arrays over coordinates, with the interface of an exact field.

    coordinates: in order. arithmetic: of the arrays. values: name -> array of each coordinate and
    number of each parameter. exact: whether numbers are balls. fields: number of varied fields,
    whose small changes components follow.

    Examples
    --------
    >>> from geomtorsion.geometry.numeric.power_series import PowerSeries
    >>> x = sp.Symbol("x")
    >>> series = PowerSeries(1, 3)
    >>> field = NumericField((x,), series, {"x": series.variable(0, 0.0)})
    >>> field.read(sp.exp(2 * x)).value.round(6).tolist()
    [1.0, 2.0, 2.0, 1.333333]
    """

    coordinates: tuple[sp.Symbol, ...]
    arithmetic: Arithmetic
    values: Mapping[str, Any]
    in_balls: bool = False
    fields: int = 0

    def __post_init__(self) -> None:
        self.zero = self.rational(0)
        self.one = self.rational(1)
        self.owner: object = None

    # What frames ask of an exact field beside arithmetic.
    is_complex = False
    generators = branches = relied_on = ()

    @property
    def chosen(self) -> dict[sp.Expr, sp.Expr]:
        """No chosen values of roots."""
        return {}

    @property
    def exact(self) -> NumericField:
        """Itself."""
        return self

    @property
    def symbols(self) -> tuple[sp.Symbol, ...]:
        """Coordinates and parameters."""
        own = {x.name for x in self.coordinates}
        return (*self.coordinates, *(sp.Symbol(x) for x in self.values if x not in own))

    def settle(self) -> None:
        """Nothing: numbers have no branches."""

    def declare(self, symbols: Iterable[sp.Symbol]) -> None:
        """Refuse symbols without a value."""
        for symbol in symbols:
            self._check(symbol)

    def _check(self, symbol: object) -> None:
        if str(symbol) not in self.values:
            raise MissingValueError(
                f"values: expected a number for {symbol}, got none. Give one for each coordinate, "
                "parameter and constant of the Lagrangian."
            )

    def generators_of(self, element: Numeric) -> list[Any]:
        """None: numbers are made of no symbols."""
        return []

    def written(self, element: Numeric, names: object = None) -> sp.Expr:
        """A constant, or a name for an array."""
        if element.fraction is not None:
            return sp.Rational(element.fraction.numerator, element.fraction.denominator)
        return sp.Symbol("numbers")

    def certainty(self, element: Numeric) -> Certainty:
        """Numbers prove nothing."""
        return Certainty(proved=element.fraction is not None, error=1.0)

    def conjugate(self, element: Numeric) -> Numeric:
        """Itself: all numbers are real."""
        return element

    # -- arithmetic ------------------------------------------------------------------------------

    def number(self, value: Any) -> Any:
        """A rational or another number as a float or a ball."""
        if isinstance(value, fmpq):
            value = Fraction(int(value.p), int(value.q))
        if self.in_balls:
            return balls.exact_ball(value)
        return float(value)

    def rational(self, p: int | Fraction | fmpq, q: int = 1) -> Numeric:
        """The rational number p/q."""
        above = Fraction(int(p.p), int(p.q)) if isinstance(p, fmpq) else Fraction(p)
        return Numeric(self, self.number(above / q), None, above / q)

    def scaled(self, element: Numeric, factor: int | Fraction | fmpq) -> Numeric:
        """A rational multiple."""
        return self.sum([(factor, element)])

    def sum(self, terms: Iterable[tuple[Any, ...]]) -> Numeric:
        """A sum of products (rational coefficient, element, element, ...)."""
        constant: Fraction | Any = Fraction(0)
        parts: list[np.ndarray] = []
        slopes: list[np.ndarray] = []
        depth = 0
        for coefficient, *factors in terms:
            if not coefficient or any(factor.fraction == 0 for factor in factors):
                continue
            number, product = self._product(coefficient, factors)
            if product is None:
                # A product of constants.
                constant = number + constant if constant else number
                continue
            plain, depth = number == 1, max(depth, product.depth)
            parts.append(product.value if plain else product.value * self._plain(number))
            if product.slope is not None:
                slopes.append(product.slope if plain else product.slope * float(number))
        if not parts:
            if isinstance(constant, Fraction):
                return self.rational(constant) if constant else self.zero
            return Numeric(self, constant)
        total = parts[0]
        for part in parts[1:]:
            total = total + part
        if constant:
            total = self.arithmetic.shifted(total, self._plain(constant))
        return Numeric(self, total, _added(slopes), None, depth)

    def _plain(self, number: Any) -> Any:
        return self.number(number) if isinstance(number, Fraction) else number

    def _product(self, coefficient: Any, factors: Sequence[Numeric]) -> tuple[Any, Numeric | None]:
        """The constant and the array of a product."""
        number: Any = self.rational(coefficient).fraction
        product: Numeric | None = None
        for factor in factors:
            if factor.fraction is not None:
                number = number * (
                    factor.fraction if isinstance(number, Fraction) else factor.value
                )
            elif factor.is_constant:
                number = self._plain(number) * factor.value
            else:
                product = factor if product is None else self._times(product, factor)
        return number, product

    def _times(self, a: Numeric, b: Numeric) -> Numeric:
        value = self.arithmetic.multiply(a.value, b.value)
        pairs = [(x.slope, y.value) for x, y in ((a, b), (b, a)) if x.slope is not None]
        slope = _added([self._moved(x, y) for x, y in pairs])
        return Numeric(self, value, slope, None, max(a.depth, b.depth))

    def _moved(self, slope: np.ndarray, value: np.ndarray) -> np.ndarray:
        """A linear operator times an array."""
        return slope @ self.arithmetic.product_matrix(value)

    def inverse(self, element: Numeric, briefly: bool = False) -> Numeric:
        """1 over an element."""
        if element.fraction is not None:
            if element.fraction == 0:
                raise ZeroDivisionError("division by zero")
            return self.rational(1 / element.fraction)
        if element.is_constant:
            return Numeric(self, 1 / element.value)
        value = self.arithmetic.inverse(element.value)
        return self._through(element, value, lambda: -self.arithmetic.multiply(value, value))

    def _through(self, element: Numeric, value: np.ndarray, slope: Any) -> Numeric:
        """A function of an element, with its derivative for the change."""
        moved = None if element.slope is None else self._moved(element.slope, slope())
        return Numeric(self, value, moved, None, element.depth)

    def root(self, element: Numeric, order: int) -> Numeric:
        """A root; positive."""
        if element.is_constant:
            if element.fraction == 1:
                return element
            size = self._plain(element.value)
            return Numeric(self, size ** (1 / order) if not self.in_balls else size.root(order))
        value = self.arithmetic.root(element.value, order)

        def slope() -> np.ndarray:
            over = self.arithmetic.inverse(element.value)
            return self.arithmetic.multiply(value, over) / order

        return self._through(element, value, slope)

    def derivative(self, element: Numeric, symbol: sp.Symbol) -> Numeric:
        """The derivative by a coordinate."""
        if symbol not in self.coordinates or element.is_constant:
            return self.zero
        mu = self.coordinates.index(symbol)
        value = self.arithmetic.derivative(element.value, mu)
        own = element.slope
        slope = None if own is None else self._differentiated(own, mu)
        return Numeric(self, value, slope, None, element.depth + 1)

    def _differentiated(self, slope: np.ndarray, mu: int) -> np.ndarray:
        """d_mu of c(x) d^alpha: d_mu c times d^alpha, plus c times d^(alpha + mu)."""
        series: Any = self.arithmetic
        fields, count, size = slope.shape
        level = int(series.degrees[count - 1]) + 1
        wide = int(np.searchsorted(series.degrees, level, "right"))
        result = np.zeros((fields, wide, size))
        result[:, :count] = series.derivative(slope, mu)
        result[:, series.raised_by(mu)[:count]] += slope
        return result

    def jet(self, function: Any, orders: tuple[int, ...], arguments: tuple[Any, ...]) -> Numeric:
        """Refused: an unknown function has no numbers."""
        raise GravityError(
            f"expected a Lagrangian in numbers, got the unknown function {function}. Write the "
            "function out: T + c*T**2 for f(T)."
        )

    # -- expressions -----------------------------------------------------------------------------

    def read(self, expr: sp.Expr | Fraction | int, where: str = "expression") -> Numeric:
        """The array of one expression."""
        return self.read_all([(where, expr)])[0]

    def read_all(self, entries: Iterable[tuple[str, Any]]) -> list[Numeric]:
        """The arrays of expressions or exact elements in coordinates and parameters."""
        pairs = list(entries)
        outputs = [
            sp.Rational(x.numerator, x.denominator) if isinstance(x, int | Fraction) else x
            for _, x in pairs
        ]
        return self.evaluated(outputs)

    def evaluated(self, outputs: Sequence[Any]) -> list[Numeric]:
        """Exact elements or expressions, evaluated step by step; shared parts once."""
        for one in outputs:
            for symbol in sorted(_symbols(one), key=str):
                self._check(symbol)
            for generator in one.field.generators_of(one) if isinstance(one, Element) else ():
                if generator.kind == "jet":
                    raise GravityError(
                        f"expected components in coordinates and parameters, got the unknown "
                        f"function {generator.shown}. Give it a value first: frame.subs({{...}})."
                    )
        names = list(self.values)
        return self.run(graph(names, outputs, factor=False), [self.values[x] for x in names])

    def run(self, steps: Graph, arguments: Sequence[Any]) -> list[Numeric]:
        """The outputs of an expression graph at arrays, numbers or elements."""
        given = [x if isinstance(x, Numeric) else self.element(x) for x in arguments]
        made: list[Numeric] = []
        for step in steps.steps:
            inner = [made[place] for place in step.operands]
            made.append(self._step(step, inner, given))
        return [made[k] if sign > 0 else self.scaled(made[k], -1) for sign, k in steps.outputs]

    def function(self, expression: sp.Expr, arguments: Sequence[Any]) -> Numeric:
        """The function of an expression at other arguments than its own."""
        names = [f"argument {k}" for k in range(len(arguments))]
        applied = expression.func(*map(sp.Symbol, names))
        return self.run(graph(names, [applied], factor=False), arguments)[0]

    def element(self, value: Any) -> Numeric:
        """A number or an array as an element."""
        if isinstance(value, int | Fraction) and not isinstance(value, bool):
            return self.rational(value)
        if isinstance(value, np.ndarray) and value.ndim:
            return Numeric(self, value)
        return Numeric(self, value if isinstance(value, arb) else self.number(value))

    def _step(self, step: Any, inner: Sequence[Numeric], given: Sequence[Numeric]) -> Numeric:
        kind = step.kind
        if kind == "argument":
            return given[step.detail]
        if kind == "number":
            return self.rational(step.detail)
        if kind == "digits":
            return Numeric(self, self.number(step.detail))
        if kind == "sum":
            return self.sum(zip(step.signs, inner, strict=True))
        if kind in ("product", "square"):
            return self.sum([(1, inner[0], inner[-1])])
        if kind == "quotient":
            return self.sum([(1, inner[0], self.inverse(inner[1]))])
        if kind == "root":
            return self.root(inner[0], step.detail)
        if kind == "imaginary":
            raise GravityError("expected real components, got the imaginary unit.")
        if step.detail == "power":
            return self._power(*inner)
        return self._called(step.detail, inner)

    def _called(self, name: str, inner: Sequence[Numeric]) -> Numeric:
        arithmetic = self.arithmetic
        if len(inner) != 1:
            raise GravityError(f"expected functions of one argument, got {name}.")
        element = self.as_array(inner[0])
        value = arithmetic.call(name, element.value)
        return self._through(element, value, lambda: arithmetic.slope(name, element.value, value))

    def _power(self, base: Numeric, exponent: Numeric) -> Numeric:
        if not exponent.is_constant:
            raise GravityError("expected powers with a constant exponent, got another one.")
        base, power = self.as_array(base), exponent.value
        value = self.arithmetic.power(base.value, power)

        def slope() -> np.ndarray:
            over = self.arithmetic.inverse(base.value)
            return self.arithmetic.multiply(value, over) * power

        return self._through(base, value, slope)

    def as_array(self, element: Numeric) -> Numeric:
        """An element whose value is an array, also for a constant."""
        if not element.is_constant:
            return element
        return Numeric(self, self.arithmetic.raised(self._plain(element.value)))


def _symbols(output: Any) -> Iterable[object]:
    """Symbols of an expression or an element."""
    return output.symbols if isinstance(output, Element) else output.free_symbols


def _added(slopes: Sequence[np.ndarray]) -> np.ndarray | None:
    """The sum of linear operators of several orders."""
    if not slopes:
        return None
    widest = max(slopes, key=lambda x: x.shape[1])
    total = np.zeros_like(widest)
    for slope in slopes:
        total[:, : slope.shape[1]] += slope
    return total

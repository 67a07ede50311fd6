"""System: first-order equations y' = f(y), each rate a sum of exact coefficients times states."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from geomtorsion.exact.compile import python_function
from geomtorsion.exact.engine_code import Products, array_names, python_source, scalar_names
from geomtorsion.exact.factored import factored
from geomtorsion.exact.line_code import line_expressions, line_source
from geomtorsion.exact.sign import of_same_sign
from geomtorsion.exact.straight_line import StraightLine

Values = Mapping[str, Any]

if TYPE_CHECKING:
    import numpy as np

    # What users give for coordinates and velocities.
    Numbers = Sequence[Any] | np.ndarray


@dataclass(frozen=True, eq=False)
class System:
    """Rates of named states; coefficients are exact, their values come with the parameters.

    states: names of the unknowns, in order; a coefficient knows them as symbols of that name.
    parameters: names of everything else that occurs.
    rates: for each state a sum of products (element, names that multiply it).
    blocks: runs of indices whose sizes are measured together (coordinates; velocities; ...).
    edge: a product sum that is positive inside the chart, or None; the first product vanishes
        where the chart ends, the second is its margin.
    clock: (state, unit) where a state is the time in such units, or None; an engine may put its
        own time in the place of that state, which rounds at every step.
    """

    states: tuple[str, ...]
    parameters: tuple[str, ...]
    rates: tuple[Products, ...]
    blocks: tuple[tuple[int, ...], ...]
    edge: Products | None = None
    clock: tuple[str, int] | None = None

    @property
    def size(self) -> int:
        """Number of states."""
        return len(self.states)

    @cached_property
    def line(self) -> StraightLine | None:
        """The rates with everything shared pulled out, or None where they are too long."""
        return self._line(self.rates)

    @cached_property
    def edge_line(self) -> StraightLine | None:
        """The same of the edge function."""
        return self._line([] if self.edge is None else [self.edge])

    def _line(self, outputs: Sequence[Products]) -> StraightLine | None:
        return factored((*self.states, *self.parameters), outputs, self.parameters)

    def _source(self, line: StraightLine | None, outputs: Sequence[Any]) -> tuple[str, set[str]]:
        names = (*self.states, *self.parameters)
        return python_source(names, outputs) if line is None else line_source(names, line)

    @cached_property
    def code(self) -> tuple[str, set[str]]:
        """Python source of the rates and the functions that it calls."""
        return self._source(self.line, self.rates)

    @cached_property
    def key(self) -> tuple[Any, ...]:
        """What two systems share exactly when one compiled integrator does for both."""
        edge = None if self.edge is None else self.edge_code[0]
        return (len(self.states), len(self.parameters), self.code[0], edge, self.clock)

    @cached_property
    def edge_code(self) -> tuple[str, set[str]]:
        """Python source of the edge function."""
        assert self.edge is not None
        return self._source(self.edge_line, (self.edge,))

    @cached_property
    def scalar_function(self) -> Callable[..., Any]:
        """f(states..., parameters...) on plain floats; raises where f does not exist."""
        return python_function(self.code[0], scalar_names(self.code[1]))

    def scalar_rates(self, values: Sequence[float]) -> Callable[[float, Any], list[float]]:
        """f(t, y) for one motion, on plain floats; not a number where f does not exist."""
        inner = self.scalar_function
        bad = [float("nan")] * self.size

        def rates(_: float, y: Any) -> Any:
            try:
                return inner(*y.tolist(), *values)
            except (ZeroDivisionError, ValueError, OverflowError):
                return bad

        return rates

    @cached_property
    def array_rates(self) -> Callable[..., tuple[Any, ...]]:
        """f(states..., parameters...) on arrays."""
        return python_function(self.code[0], array_names(self.code[1]))

    @cached_property
    def jacobian_system(self) -> tuple[Products, ...]:
        """d rate_i / d state_j, row by row."""
        return tuple(derivative(rate, name) for rate in self.rates for name in self.states)

    @cached_property
    def _jacobian_function(self) -> Callable[..., Any]:
        outputs = self.jacobian_system
        source, functions = self._source(self._line(outputs), outputs)
        return python_function(source, scalar_names(functions))

    def scalar_jacobian(self, values: Sequence[float]) -> Callable[[float, Any], Any]:
        """df/dy at (t, y) as an array."""
        import numpy as np

        inner, n = self._jacobian_function, self.size

        def jacobian(_: float, y: Any) -> Any:
            return np.array(inner(*y.tolist(), *values)).reshape(n, n)

        return jacobian

    def written(
        self, known: Mapping[str, Any], number: Callable[[int, int], Any]
    ) -> tuple[list[Any], Any]:
        """Rates and edge as heyoka expressions of the known ones; number: p, q -> p/q."""
        from geomtorsion.motion.engines.writer import SquaringWriter

        writer = SquaringWriter(known, number)
        if self.line is not None:
            rates = line_expressions(self.line, known, number)
        else:
            rates = [writer.products(rate) for rate in self.rates]
        if self.edge is None:
            return rates, None
        if self.edge_line is not None:
            return rates, line_expressions(self.edge_line, known, number)[0]
        return rates, writer.products(self.edge)

    def edge_values(self, states: Any, values: Sequence[float]) -> Any:
        """The edge function on arrays of states, shape (size, ...)."""
        return self._edge_function(*states, *values)[0]

    @cached_property
    def scalar_edge(self) -> Callable[..., Any]:
        """The edge function on plain floats, in a tuple."""
        return python_function(self.edge_code[0], scalar_names(self.edge_code[1]))

    @cached_property
    def _edge_function(self) -> Callable[..., Any]:
        return python_function(self.edge_code[0], array_names(self.edge_code[1]))

    @cached_property
    def without_edge(self) -> System:
        """The same equations with nothing to watch."""
        return self if self.edge is None else replace(self, edge=None)

    @cached_property
    def to_the_end(self) -> System:
        """The same equations, watched up to where the chart ends and not to its margin.

        There only the sign matters: quotients and even powers below are left out.
        """
        if not self.edge:
            return self
        end, names = self.edge[0]
        shorter = of_same_sign(end)
        # Engines want to watch something that moves.
        return replace(self, edge=((shorter if shorter.symbols else end, names),))


def derivative(products: Products, name: str) -> Products:
    """The derivative of a sum of products with respect to a state, by name."""
    found: list[tuple[Any, tuple[str, ...]]] = []
    for element, factors in products:
        symbol = next((s for s in element.field.symbols if s.name == name), None)
        if symbol is not None:
            slope = element.diff(symbol)
            if not slope.is_zero:
                found.append((slope, factors))
        count = factors.count(name)
        if count:
            rest = list(factors)
            rest.remove(name)
            found.append((element * count, tuple(rest)))
    return tuple(found)


def evaluated(products: Sequence[Products], values: Values) -> list[Any]:
    """Numbers (or arrays) of product sums; values: name -> number or array."""
    import numpy as np

    function = _function(tuple(values), products)
    with np.errstate(all="ignore"):
        return list(function(*values.values()))


# Functions of product sums: the same sums come again and again. Elements of different fields
# refuse to be compared, so it is known by the very objects, which are kept with it.
_functions: OrderedDict[tuple[Any, ...], tuple[Any, Callable[..., Any]]] = OrderedDict()
FUNCTIONS_KEPT = 512


def _function(names: tuple[str, ...], products: Sequence[Products]) -> Callable[..., Any]:
    """Product sums as a function of named arguments."""
    parts = ((id(element), factors) for sums in products for element, factors in (*sums, END))
    key = (names, *parts)
    if key in _functions:
        _functions.move_to_end(key)
        return _functions[key][1]
    source, functions = python_source(names, products)
    made = python_function(source, array_names(functions))
    _functions[key] = (tuple(products), made)
    while len(_functions) > FUNCTIONS_KEPT:
        _functions.popitem(last=False)
    return made


# Stands between two sums in the key of a function.
END = (None, ())


def exact(value: Any) -> Fraction | None:
    """A number as a fraction where it is one (floats are), else None."""
    if isinstance(value, int | float | Fraction):
        return Fraction(value)
    if getattr(value, "is_Rational", False):
        return Fraction(int(value.p), int(value.q))
    if hasattr(value, "dtype") and getattr(value, "shape", None) == ():
        return Fraction(value.item()) if value.dtype.kind in "fiu" else None
    return None


def mpf(value: Any, precision: int) -> Any:
    """A number at a precision in bits, as mpmath number."""
    import mpmath

    with mpmath.workprec(precision):
        if type(value).__name__ in ("longdouble", "real128", "real"):
            return mpmath.mpf(str(value))
        known = exact(value)
        if known is not None:
            return mpmath.mpf(known.numerator) / known.denominator
        if hasattr(value, "evalf"):
            return mpmath.mpmathify(value.evalf(int(precision * 0.302) + 5))
        return +mpmath.mpmathify(value)


def floats(values: Iterable[Any]) -> list[float]:
    """Numbers as floats."""
    return [float(value) for value in values]

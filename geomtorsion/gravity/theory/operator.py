"""Operator: field equations to first order about a background, as a matrix in d/dx."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import comb, prod

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import ExpressionError, GravityError
from geomtorsion.exact import Element, Truncated, TruncatedField, linear_parts
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.gravity.theory.matter import MatterField
from geomtorsion.gravity.theory.residuals import Sources
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive

# The order of a derivative by each coordinate.
Orders = tuple[int, ...]
# Order -> coefficient.
Polynomial = dict[Orders, Element]


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class LinearOperator:
    """First order of the field equations about a background: a polynomial matrix in d/dx.

    Row f applied to the fields is the first order of dS/df, the derivative of the action by the
    field f. All rows vanish on a small wave.

    frame: the background.
    fields: the unknown functions that are small, in the order of rows and columns.
    entries: (row, column) -> {order of the derivative by each coordinate: coefficient}.

    Examples
    --------
    A scalar field in the plane obeys the wave equation.

    >>> import sympy as sp
    >>> import geomtorsion as gt
    >>> t, x, epsilon = sp.symbols("t x epsilon")
    >>> plane = gt.Frame([t, x], [[1, 0], [0, 1]], signature="-+", parameters=[epsilon])
    >>> u = sp.Function("u")(t, x)
    >>> small = gt.gravity.scalar_field(epsilon * u)
    >>> connection = gt.levi_civita(plane.expanded("epsilon", 1))
    >>> waves = gt.gravity.equations(connection, "-X/2 - m**2*phi**2/2", small, constants="m")
    >>> waves.operator([u]).symbol({"t": "s", "x": "p"})
    Matrix([[-m**2 + p**2 - s**2]])
    """

    frame: Frame
    fields: tuple[AppliedUndef, ...]
    entries: Mapping[tuple[int, int], Polynomial]

    def __repr__(self) -> str:
        n = len(self.fields)
        return f"linear operator: {n} x {n}, derivatives up to order {self.order}"

    @cached_property
    def order(self) -> int:
        """The highest order of a derivative."""
        return max((sum(k) for one in self.entries.values() for k in one), default=0)

    def symbol(self, momenta: Mapping[object, object]) -> sp.Matrix:
        """The matrix with a symbol for each derivative: the operator on exp(s t + p z).

        momenta: coordinate -> symbol or number, or their names.

        Raises
        ------
        GravityError
            A field depends on a coordinate without a momentum.
        """
        places = self._momenta(momenta)
        size = len(self.fields)
        matrix = sp.zeros(size, size)
        for (row, column), entry in self.entries.items():
            terms = [
                x.sympy * sp.Mul(*(p**k for p, k in zip(places, orders, strict=True)))
                for orders, x in entry.items()
            ]
            matrix[row, column] = sp.Add(*terms)
        return matrix

    def _momenta(self, momenta: Mapping[object, object]) -> list[sp.Expr]:
        names = {x.name: x for x in self.frame.coordinates}
        values: dict[str, sp.Expr] = {}
        for coordinate, momentum in momenta.items():
            name = str(coordinate)
            checks.known_name(name, names, "coordinate", GravityError)
            values[name] = checks.expression(
                momentum, f"momentum of {name}", GravityError, read=sp.Symbol
            )
        orders = [x for one in self.entries.values() for x in one]
        for k, name in enumerate(names):
            if name not in values and any(x[k] for x in orders):
                raise GravityError(
                    f"symbol: expected a momentum for each coordinate, got none for {name}. Give "
                    f"symbol({{..., '{name}': 'p'}})."
                )
        return [values.get(x.name, sp.S.Zero) for x in self.frame.coordinates]

    @cached_property
    def adjoint(self) -> LinearOperator:
        """The operator with the roles of rows and columns exchanged by partial integration."""
        total: dict[tuple[int, int], list] = {}
        for (row, column), entry in self.entries.items():
            for orders, x in entry.items():
                sign = (-1) ** sum(orders)
                for kept, value in _product_rule(self.frame, orders, x):
                    total.setdefault((column, row), []).append((kept, sign, value))
        return LinearOperator(self.frame, self.fields, _summed(self.frame, total))

    @cached_property
    def is_self_adjoint(self) -> bool:
        """Whether the operator is its adjoint, as each variation of an action is."""
        keys = self.entries.keys() | self.adjoint.entries.keys()
        for key in keys:
            one, two = self.entries.get(key, {}), self.adjoint.entries.get(key, {})
            for orders in one.keys() | two.keys():
                zero = self.frame.field.zero
                if not (one.get(orders, zero) - two.get(orders, zero)).is_zero:
                    return False
        return True


def _product_rule(frame: Frame, orders: Orders, x: Element) -> Iterator[tuple[Orders, Element]]:
    """d^orders (x f) as a sum of derivatives of f times derivatives of x."""
    for kept in product(*(range(k + 1) for k in orders)):
        value = x
        for coordinate, k, m in zip(frame.coordinates, orders, kept, strict=True):
            for _ in range(k - m):
                value = value.diff(coordinate)
        factor = prod(comb(k, m) for k, m in zip(orders, kept, strict=True))
        if factor and not value.is_zero:
            yield kept, factor * value


def _summed(
    frame: Frame, total: Mapping[tuple[int, int], list]
) -> dict[tuple[int, int], Polynomial]:
    """Sums of (order, sign, coefficient), without zeros."""
    entries: dict[tuple[int, int], Polynomial] = {}
    for key, terms in total.items():
        by_order: dict[Orders, list] = {}
        for orders, sign, value in terms:
            by_order.setdefault(orders, []).append((sign, value))
        sums = {orders: frame.field.sum(parts) for orders, parts in by_order.items()}
        kept = {orders: x for orders, x in sorted(sums.items()) if not x.is_zero}
        if kept:
            entries[key] = kept
    return entries


def operator(equations: Sources, fields: Iterable[object]) -> LinearOperator:
    """See FieldEquations.operator."""
    frame = equations.frame
    series = frame.field
    if not isinstance(series, TruncatedField):
        raise GravityError(
            "operator: expected equations over an expanded frame, got an exact frame. Multiply the "
            "fields by a parameter and give frame.expanded('epsilon', 1)."
        )
    ground = equations.coframe_equation.order(0).frame
    functions = _functions(equations, fields)
    _check_background(equations)
    total: dict[tuple[int, int], list] = {}
    for moves, equation in _variations(equations, ground, functions):
        if equation.is_zero:
            continue
        columns = _taken_apart(ground, equation, functions)
        for (row, orders), weight in moves.items():
            # dS/df = (-d)^orders (weight equation) where the field moves by weight d^orders f.
            sign = (-1) ** sum(orders)
            for (column, own), x in columns.items():
                for kept, value in _product_rule(ground, orders, weight * x):
                    whole = tuple(a + b for a, b in zip(own, kept, strict=True))
                    total.setdefault((row, column), []).append((whole, sign, value))
    return LinearOperator(ground, functions, _summed(ground, total))


def _functions(equations: Sources, fields: Iterable[object]) -> tuple[AppliedUndef, ...]:
    """The unknown functions that are meant by symbols or names, in their order."""
    applied = {}
    for generator in equations.frame.field.generators:
        if generator.kind == "jet":
            function, _, places = generator.argument
            if all(place.sympy.is_Symbol for place in places):
                applied[function.__name__] = function(*(place.sympy for place in places))
    chosen = []
    for one in checks.entries(fields, "fields", GravityError):
        name = one.func.__name__ if isinstance(one, AppliedUndef) else str(one)
        chosen.append(applied[checks.known_name(name, applied, "field", GravityError)])
    return tuple(chosen)


def _check_background(equations: Sources) -> None:
    """Refuse a background that does not solve the equations."""
    named = {"E": equations.coframe_equation, "C": equations.connection_equations[0]}
    named |= {f"equation of {name}": one for name, one in equations.matter_equations.items()}
    for name, tensor in named.items():
        for index, x in sorted(tensor.order(0).components.nonzero.items()):
            place = "".join(map(str, index))
            raise GravityError(
                f"operator: expected a background that solves the equations, got {name}_{place} = "
                f"{checks.cut(str(x))} at order 0. Give another background, or other constants."
            )


def _variations(
    equations: Sources, ground: Frame, functions: tuple[AppliedUndef, ...]
) -> Iterator[tuple[dict[tuple[int, Orders], Element], Element]]:
    """Pairs: how fast a component moves with each field, and the density that multiplies it."""
    volume = ground.determinant.element()
    legs = ground.legs.components.get

    def density(tensor: Tensor, mu: int, rest: tuple[int, ...], slot: int) -> Element:
        """e E_n^mu X^n at first order: legs to coordinates in one slot."""
        if not tensor.slots:
            return volume * tensor.order(1).element()
        get = tensor.order(1).components.get
        indices = ((k, (*rest[:slot], k, *rest[slot:])) for k in range(ground.dimension))
        return ground.field.sum([(1, volume, legs((mu, k)), get(index)) for k, index in indices])

    for element, tensor, mu, rest, slot in _varied(equations):
        assert isinstance(element, Truncated)
        moves = _taken_apart(ground, element.parts[1], functions)
        if moves:
            yield moves, density(tensor, mu, rest, slot)


def _varied(
    equations: Sources,
) -> Iterator[tuple[Element, Tensor, int, tuple[int, ...], int]]:
    """Components of coframe, connections and matter fields, each with its equation.

    Then follow the index of the coordinate, the other indices, and the slot of the first one.
    """
    frame, n = equations.frame, range(equations.frame.dimension)
    for i, mu in product(n, repeat=2):
        yield frame.coframe.element(i, mu), equations.coframe_equation, mu, (i,), 1
    for connection, C in zip(equations.connections, equations.connection_equations, strict=True):
        if connection.kind not in ("levi-civita", "cartan"):
            for mu, i, j in product(n, repeat=3):
                yield connection.spin_connection.element(mu, i, j), C, mu, (i, j), 0
    for one in equations.matter:
        if isinstance(one, MatterField):
            tensor = equations.matter_equations[one.symbol]
            for mu, element in enumerate(one.elements(frame)):
                yield element, tensor, mu, (), 0


def _taken_apart(
    ground: Frame, element: Element, functions: tuple[AppliedUndef, ...]
) -> dict[tuple[int, Orders], Element]:
    """(field, order by each coordinate) -> coefficient in an element linear in the fields."""
    places = {x: k for k, x in enumerate(ground.coordinates)}
    numbers = {function: k for k, function in enumerate(functions)}
    try:
        parts = linear_parts(element, functions)
    except ExpressionError as error:
        raise GravityError(f"operator: {error}. Name all small fields.") from None
    apart = {}
    for (function, orders), x in parts.items():
        whole = [0] * len(places)
        for argument, k in zip(function.args, orders, strict=True):
            whole[places[argument]] += k
        apart[numbers[function], tuple(whole)] = x
    return apart

"""Constrained: the connection whose autoparallels are the motions under linear constraints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import product

import sympy as sp

from geomtorsion.errors import ConstraintError, MetricError, TensorIndexError
from geomtorsion.exact import Element, parse_expression
from geomtorsion.geometry.components import Index, minus
from geomtorsion.geometry.connection import Connection
from geomtorsion.geometry.connections import FrameLike, frame_of, from_spin_connection, levi_civita
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.differentials import differentials
from geomtorsion.geometry.forms import Form
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.homes import at_home
from geomtorsion.geometry.orthonormalize import Row, completed_squares
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.geometry.validation import named_symbols
from geomtorsion.support import checks

ADVICE = (
    "Give numbers of legs, (0, 1), or one-forms that vanish on the permitted velocities, "
    '["cos(theta)*dy - sin(theta)*dx"].'
)


def constrained(
    space: FrameLike | Connection,
    allowed: Sequence[object],
    *,
    parameters: Sequence[sp.Symbol | str] | str = (),
) -> Connection:
    """Metric connection with torsion whose autoparallels are the motions under linear constraints.

    The metric of the frame is the kinetic metric: the kinetic energy is g(v, v)/2. A body without
    forces whose velocity obeys the constraints follows an autoparallel (Synge 1928, Vranceanu
    1926; Shabanov, J. Phys. A 31 (1998) 5177): its acceleration has no part along the permitted
    legs (d'Alembert).

    Equation
    --------
    The spin connection of the metric, but omega_ai^j = 0 where only one of the legs i, j is
    permitted.

    Parameters
    ----------
    space
        the frame of the kinetic metric; a connection contributes its frame.
    allowed
        numbers of the legs that span the permitted velocities, counted from 0; or the one-forms
        that vanish on them, as text ("cos(theta)*dy - sin(theta)*dx"), as lists of n components,
        or as forms. With one-forms the connection belongs to an orthonormal frame of the same
        metric that is adapted to them: permitted legs first, forbidden legs last.
    parameters
        names or symbols that occur in the text of one-forms and not yet in the frame.

    Returns
    -------
    Connection, with the numbers of the permitted legs in `allowed` and the verdict `integrable`.

    Raises
    ------
    ConstraintError
        the one-forms depend on each other, or are not linear in the differentials.
    MetricError
        the metric is not positive on the permitted velocities, or permitted legs are not orthogonal
        to forbidden ones.
    TensorIndexError
        a number does not name a leg, or occurs twice.

    Examples
    --------
    A skate slides along its edge and turns:

    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, constrained
    >>> x, y, theta = sp.symbols("x y theta", real=True)
    >>> m, I = sp.symbols("m I", positive=True)
    >>> energy = Frame.from_metric([x, y, theta], [[m, 0, 0], [0, m, 0], [0, 0, I]])
    >>> skate = constrained(energy, ["cos(theta)*dy - sin(theta)*dx"])
    >>> skate.metric_compatible, skate.allowed, skate.integrable
    (True, (0, 1), not integrable: T_12^3 = 1/sqrt(I))
    """
    frame = frame_of(space, "space")
    items = checks.entries(allowed, "allowed", ConstraintError, remedy=ADVICE)
    if not items:
        checks.refuse(ConstraintError, "allowed", "a list", items, ADVICE)
    numbers = [checks.whole(item) for item in items]
    if None not in numbers:
        return _over_legs(frame, tuple(_leg(frame, number) for number in items))
    added = named_symbols(parameters, frame.field.symbols, "parameter")
    adapted, legs = _adapted(frame, [_row(frame, k, x, added) for k, x in enumerate(items)])
    return _over_legs(adapted, legs)


def _leg(frame: Frame, value: object) -> int:
    """Number of a leg."""
    last, remedy = frame.dimension - 1, "Legs count from 0, as the rows of the coframe do."
    wanted = f"numbers of legs from 0 to {last}"
    return checks.count(value, "allowed", TensorIndexError, 0, last, expected=wanted, remedy=remedy)


@derived
def _over_legs(frame: Frame, allowed: tuple[int, ...]) -> Connection:
    """The constrained connection of some legs of a frame."""
    if len(set(allowed)) < len(allowed):
        raise TensorIndexError(
            f"allowed: expected each leg once, got {list(allowed)}. Give it once."
        )
    permitted = frozenset(allowed)
    for (i, j), value in frame.eta.components.nonzero.items():
        if (i in permitted) != (j in permitted):
            raise MetricError(
                f"expected permitted legs orthogonal to the forbidden ones, got legs {i} and {j} "
                f"with product {value}. Give the constraints as one-forms, which adapts the frame."
            )
        if i == j and i in permitted and not value.as_fraction() > 0:
            raise _not_positive(frame, f"leg {i} of square {value}", [value])
    spin = levi_civita(frame).spin_connection.components.get
    zero = frame.field.zero

    def rule(index: Index) -> Element:
        _, i, j = index
        return spin(index) if (i in permitted) == (j in permitted) else zero

    connection = from_spin_connection(frame, Tensor(frame, "dDU", rule))
    return replace(
        connection,
        name="constrained connection",
        kind="metric",
        maker=partial(constrained, allowed=allowed),
        allowed=tuple(sorted(allowed)),
    )


def _not_positive(frame: Frame, found: str, squares: Sequence[Element]) -> MetricError:
    """The refusal of velocities of which the last square is negative."""
    remedy = "Give the metric of a kinetic energy, or permit other velocities."
    signs = [[region.sign(x) for x in squares] for region in frame.regions]
    if frame.domain or any(-1 not in row for row in signs):
        # The sign was read at one point; elsewhere it may be positive.
        columns = zip(squares, zip(*signs, strict=True), strict=True)
        open_ = [f"'{x} > 0'" for x, column in columns if set(column) != {1}]
        remedy = (
            f"Declare where it is positive, domain=[..., {', '.join(open_)}] of the frame. {remedy}"
        )
    return MetricError(
        f"expected a metric that is positive on the permitted velocities, got {found}. {remedy}"
    )


# -- frames adapted to one-forms -----------------------------------------------------------------


def _row(frame: Frame, number: int, item: object, parameters: Sequence[sp.Symbol]) -> Row:
    """Components a_mu of one constraint a_mu q'^mu = 0, without zeros."""
    where, n = f"constraint {number + 1}", frame.dimension
    if isinstance(item, Form):
        form = at_home(frame, item)
        if form is None or item.degree != 1 or item.values:
            raise ConstraintError(
                f"{where}: expected a one-form over the frame of the kinetic metric, got {item!r}. "
                "Build it over this frame, with degree 1."
            )
        row = {mu: value for (mu,), value in form.components.items()}
    else:
        if isinstance(item, str):
            coefficients = _differentials(frame, where, item, parameters)
        else:
            coefficients = checks.entries(item, where, ConstraintError, remedy=ADVICE)
        parts = f"{where}: components"
        checks.check_one_each(coefficients, n, "coordinates", parts, ConstraintError)
        named = [(f"{where}[{mu}]", value) for mu, value in enumerate(coefficients)]
        row = {mu: value for mu, value in enumerate(frame.read(named)) if not value.is_zero}
    if not row:
        raise ConstraintError(
            f"{where}: expected a one-form that does not vanish, got zero. Omit it."
        )
    return row


def _differentials(
    frame: Frame, where: str, text: str, parameters: Sequence[sp.Symbol]
) -> list[sp.Expr]:
    """Coefficients of dq^mu in a text."""
    symbols = dict.fromkeys([*frame.field.symbols, *parameters])
    taken = [symbol.name for symbol in symbols]
    forms = differentials(frame.coordinates, taken, where, ConstraintError)
    names = {symbol.name: symbol for symbol in (*symbols, *forms)}
    value = parse_expression(text, names, where=where)
    coefficients = [sp.expand(value).coeff(form) for form in forms]
    rest = value.subs(dict.fromkeys(forms, 0))
    if not frame.read([(where, rest)])[0].is_zero:
        raise ConstraintError(
            f"{where}: expected a constraint without a part free of velocities, got {text!r} "
            f"with the part {rest}. For a surface that moves, use gt.equations_of_motion(frame, L, "
            "constraints=...)."
        )
    linear = sp.Add(*(x * y for x, y in zip(coefficients, forms, strict=True)))
    if sp.expand(value - rest - linear) != 0 or linear.has(*(d**2 for d in forms)):
        raise ConstraintError(
            f"{where}: expected a sum of functions times {', '.join(map(str, forms))}, got "
            f"{text!r}. {ADVICE}"
        )
    return coefficients


def _adapted(frame: Frame, constraints: list[Row]) -> tuple[Frame, tuple[int, ...]]:
    """Orthonormal frame: legs that span the permitted velocities, then the one-forms in order.

    Vectors b_f = d_f - N_rf d_r span the permitted velocities where the constraints read
    dq^r + N_rf dq^f = 0. Completing squares of the metric takes these vectors first.
    """
    field, n = frame.field, frame.dimension
    solved = _solved(frame, constraints)
    free = [mu for mu in range(n) if mu not in solved]
    if not free:
        raise ConstraintError(
            f"expected at most {n - 1} constraints in {n} dimensions, got {len(solved)}: no "
            "velocity is left."
        )
    vectors: list[Row] = [
        {f: field.one} | {r: -row[f] for r, row in solved.items() if f in row} for f in free
    ]
    vectors += [{r: field.one} for r in solved]
    duals: list[Row] = [{f: field.one} for f in free] + list(solved.values())
    forms = _permitted_forms(frame, vectors, duals, len(free))
    normal, signs = _normalised(frame, constraints)
    adapted = Frame(
        frame.coordinates,
        [[value.sympy for value in form] for form in (*forms, *normal)],
        signature=[*(1 for _ in free), *signs],
        parameters=frame.parameters,
        domain=frame.domain,
        name=frame.name,
    )
    return adapted, tuple(range(len(free)))


def _permitted_forms(
    frame: Frame, vectors: Sequence[Row], duals: Sequence[Row], leading: int
) -> list[list[Element]]:
    """Orthonormal one-forms of the span of the first vectors, in coordinates; duals: of all."""
    field, n = frame.field, frame.dimension
    pairs = product(range(n), repeat=2)
    products = {(i, j): _product(frame.metric, vectors[i], vectors[j]) for i, j in pairs}
    products = {pair: value for pair, value in products.items() if not value.is_zero}
    completed = completed_squares(field, products, n, leading=leading)
    squares = [completed[place] for place in range(leading)]
    forms = []
    for square, form in squares:
        if not field.sample.is_positive(square):
            every = [x for x, _ in squares if x is not square]
            raise _not_positive(frame, f"a velocity of square {square}", [*every, square])
        length = field.root(square, 2)
        terms = [(mu, (1, length, x, y)) for i, x in form.items() for mu, y in duals[i].items()]
        forms.append([field.sum([term for mu, term in terms if mu == nu]) for nu in range(n)])
    return forms


def _product(metric: Tensor, one: Row, two: Row) -> Element:
    """Product of two vectors or forms."""
    get = metric.components.get
    return metric.frame.field.sum(
        [(1, x, get((a, b)), y) for a, x in one.items() for b, y in two.items()]
    )


def _normalised(frame: Frame, constraints: list[Row]) -> tuple[list[list[Element]], list[int]]:
    """The one-forms made orthonormal in order (Gram and Schmidt), and signs of their squares."""
    field, metric = frame.field, frame.inverse_metric
    orthogonal: list[tuple[Element, Row]] = []
    forms, signs = [], []
    for number, row in enumerate(constraints):
        for square, other in orthogonal:
            factor = _product(metric, row, other) / square
            row = minus(field, row, other, factor)
        square = _product(metric, row, row)
        if square.is_zero:
            raise MetricError(
                f"constraint {number + 1}: expected a one-form with a length, got one that is null "
                "in this metric. Give the metric of a kinetic energy."
            )
        orthogonal.append((square, row))
        sign = 1 if field.sample.is_positive(square) else -1
        length = field.root(square * sign, 2)
        forms.append(
            [row[mu] / length if mu in row else field.zero for mu in range(frame.dimension)]
        )
        signs.append(sign)
    return forms, signs


def _solved(frame: Frame, constraints: list[Row]) -> dict[int, Row]:
    """Constraints solved for one differential each: r -> row with 1 at r, 0 at the others."""
    field = frame.field
    solved: dict[int, Row] = {}
    for number, row in enumerate(constraints):
        for place, other in solved.items():
            row = minus(field, row, other, row[place]) if place in row else row
        if not row:
            raise ConstraintError(
                f"constraint {number + 1}: expected independent one-forms, got one that follows "
                "from those before it. Omit it."
            )
        # A number or a parameter does not vanish anywhere.
        place = min(row, key=lambda mu: (_variation(frame, row[mu]), -mu))
        scale = row[place].inverse()
        row = {mu: value * scale for mu, value in row.items()}
        solved = {
            r: minus(field, other, row, other[place]) if place in other else other
            for r, other in solved.items()
        }
        solved[place] = row
    return solved


def _variation(frame: Frame, value: Element) -> int:
    """0 for a number, 1 for a parameter, 2 for a function of the coordinates."""
    if value.is_rational:
        return 0
    return 2 if value.symbols & set(frame.coordinates) else 1

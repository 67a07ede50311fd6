"""Defects: lines and points where a coframe is singular, and the loops that wind around them."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from geomtorsion.errors import LoopError, MissingValueError
from geomtorsion.exact.form import Sum, form
from geomtorsion.geometry.connections import ConnectionLike, FrameLike, as_connection, as_frame
from geomtorsion.geometry.derived import derived
from geomtorsion.loops.affine_form import AffineForm, line_rate
from geomtorsion.loops.affine_map import AffineMap
from geomtorsion.loops.arcs import Number, Parameters, Part, shown
from geomtorsion.loops.defect_lines import Lines
from geomtorsion.loops.forms import Poles, parameter_values
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.poles import arc_samples
from geomtorsion.loops.symbol_values import with_numbers
from geomtorsion.loops.transport import transported
from geomtorsion.loops.validation import rows
from geomtorsion.loops.winding import turns_round
from geomtorsion.support import checks
from geomtorsion.support.checks import exact_number
from geomtorsion.support.checks import expression as expression_of

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.exact.generators import Generator
    from geomtorsion.geometry import Connection, Frame

# A loop this small, as a fraction of the distance to the nearest other defect, measures only one. A
# smaller loop encloses less smooth torsion, but loses more digits to rounding.
ALONE = 0.25
SHAPES = {0: "point", 1: "line", 2: "surface"}


@dataclass(frozen=True)
class Defect:
    """A line (or point) on which the coframe is singular, straight in the coordinates.

    point: a point on it, exact, shape (n,).
    across: two coordinates, or two covectors of shape (n,), that are constant along it: loops
        turn positively from the first to the second. None if it has more than two such
        directions, because loops do not wind around it then.
    name: its name.
    source: "declared", or the expression that vanishes on it.
    names: of the coordinates; free: numbers of the coordinates that vary along it.

    Examples
    --------
    >>> axis = Defect((0, 0, 0), (0, 1), "dislocation")
    >>> axis.winding(Loop.circle([0.1, 0, 5], 1).times(2))
    2
    >>> print(axis)
    dislocation at q0 = 0, q1 = 0
    """

    point: tuple[Number, ...]
    across: tuple[Any, Any] | None
    name: str = "defect"
    source: str = "declared"
    names: tuple[str, ...] = ()
    free: tuple[int, ...] = ()

    def place(self, parameters: Parameters | None = None) -> tuple[float, ...]:
        """Point of the defect as numbers, shape (n,).

        Raises
        ------
        MissingValueError
            The point depends on a parameter that has no value.
        """
        names = {
            name: exact_number(value, f"parameter {name}", LoopError)
            for name, value in checks.by_name(parameters, "parameters", LoopError).items()
        }
        numbers = []
        for value in self.point:
            expression = expression_of(value, f"{self.name}: point", LoopError)
            here = {s: names[s.name] for s in expression.free_symbols if s.name in names}
            for symbol, entry in here.items():
                checks.check_declared(symbol, entry)
            number = expression.subs(here)
            if number.free_symbols:
                missing = ", ".join(sorted(s.name for s in number.free_symbols))
                raise MissingValueError(
                    f"{self.name}: its place depends on {missing}, which has no value. "
                    "Give parameters={name: number}."
                )
            numbers.append(float(number))
        return tuple(numbers)

    def winding(self, loop: Loop, parameters: Parameters | None = None) -> int:
        """Winding number of a loop around it.

        Raises
        ------
        SingularPointError
            The loop passes through the defect; the message names the point.
        LoopError
            It is not a line: loops do not wind around a point in space.
        """
        if self.across is None:
            raise LoopError(
                f"{self}: a loop winds around a line (a point in the plane), not around this. "
                "Surround it with a closed surface instead."
            )

        place = self.place(parameters)
        across = np.array(rows(self.across, len(place)))
        return turns_round(loop.parts, place, across, str(self))

    @property
    def equations(self) -> str:
        """Its position as equations of coordinates, such as "x = 0, y = 0"."""
        names = self.names or tuple(f"q{k}" for k in range(len(self.point)))
        across = self.across if self.across and isinstance(self.across[0], int) else None
        shown = across or [k for k in range(len(self.point)) if k not in self.free]
        return ", ".join(f"{names[k]} = {self.point[k]}" for k in shown)

    def __str__(self) -> str:
        return f"{self.name} at {self.equations}"


@dataclass(frozen=True, eq=False)
class EnclosedDefect:
    """A defect inside a loop.

    defect: the defect; turns: how often the loop winds around it.
    charge: closure failure of one turn: Burgers vector and rotation, in the frame at the base
        point of a small loop; None if it was not measured.
    """

    defect: Defect
    turns: int
    charge: AffineMap | None = None

    def __str__(self) -> str:
        count = "once" if self.turns == 1 else f"{self.turns} times"
        text = f"{self.defect}, {count}"
        if self.charge is not None:
            text += f", b = {shown(self.charge.burgers)} a turn"
        return text


def find_defects(frame: FrameLike, connection: ConnectionLike | None = None) -> tuple[Defect, ...]:
    """Lines on which the coframe is singular, from the exact denominators and the determinant.

    With a connection also lines where its frame coefficients are singular.

    Finds the isolated zeros of each irreducible factor that is a definite quadratic form about some
    point in two of the coordinates or more, such as (x - 1)^2 + y^2. Declare others (curved lines,
    zeros of higher order) as `Defect`.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> [str(defect) for defect in find_defects(load("screw_dislocation").frame)]
    ['singular line at x = 0, y = 0']
    """
    frame = as_frame(frame)
    connection = None if connection is None else as_connection(connection)
    if connection is None or connection.kind == "cartan":
        if isinstance(frame.given, Lines):
            return _of_lines(frame, frame.given)
        return _of_frame(frame)
    return _of_connection(frame, connection)


def _of_lines(frame: Frame, lines: Lines) -> tuple[Defect, ...]:
    """The lines from which a frame was made."""
    names = tuple(symbol.name for symbol in frame.coordinates)
    return tuple(
        Defect((*place, sp.S.Zero), (0, 1), "singular line", f"zero of {source}", names, (2,))
        for place, source in zip(lines.places, lines.names, strict=True)
    )


@derived
def _of_frame(frame: Frame) -> tuple[Defect, ...]:
    """Lines on which a coframe is singular."""
    return _found(frame, factors(frame))


@derived
def _of_connection(frame: Frame, connection: Connection) -> tuple[Defect, ...]:
    """Lines on which a coframe or the coefficients of a connection are singular."""
    bases = dict.fromkeys(factors(frame))
    for element in connection.spin_connection.components.independent.values():
        bases.update(dict.fromkeys(_bases(element, below=True)))
    return _found(frame, tuple(bases))


def _found(frame: Frame, factors: Sequence[sp.Expr]) -> tuple[Defect, ...]:
    """The defects, once for each place."""
    defects: dict[tuple[Hashable, ...], Defect] = {}
    for factor in factors:
        place = isolated_zero(factor, frame.coordinates)
        if place is None:
            continue
        columns = tuple(k for k, symbol in enumerate(frame.coordinates) if symbol in place)
        point = tuple(place.get(symbol, sp.S.Zero) for symbol in frame.coordinates)
        across = (columns[0], columns[1]) if len(columns) == 2 else None
        free = tuple(k for k in range(frame.dimension) if k not in columns)
        name = f"singular {SHAPES.get(len(free), 'set')}"
        names = tuple(symbol.name for symbol in frame.coordinates)
        defect = Defect(point, across, name, f"zero of {factor}", names, free)
        defects.setdefault((columns, point), defect)
    return tuple(defects.values())


def isolated_zero(
    factor: sp.Expr, coordinates: Sequence[sp.Symbol]
) -> dict[sp.Symbol, sp.Expr] | None:
    """Where a definite quadratic polynomial in two coordinates or more vanishes, else None."""
    used = [symbol for symbol in coordinates if factor.has(symbol)]
    if len(used) < 2 or not factor.is_polynomial(*used):
        return None
    poly = sp.Poly(factor, *used)
    if poly.total_degree() != 2:
        return None
    hessian = sp.hessian(factor, used)
    minors = [hessian[:k, :k].det() for k in range(1, len(used) + 1)]
    signs = [sp.sign(minor) for minor in minors]
    definite = all(s == 1 for s in signs) or all(s == (-1) ** (k + 1) for k, s in enumerate(signs))
    if not definite:
        return None
    origin = dict.fromkeys(used, 0)
    slope = sp.Matrix([factor.diff(symbol).subs(origin) for symbol in used])
    point = dict(zip(used, map(sp.cancel, hessian.LUsolve(-slope)), strict=True))
    return point if sp.cancel(sp.expand(factor.subs(point))) == 0 else None


def enclosed_defects(
    frame: FrameLike,
    loop: Loop,
    parameters: Parameters | None = None,
    *,
    defects: Sequence[Defect] | None = None,
    connection: ConnectionLike | None = None,
) -> tuple[EnclosedDefect, ...]:
    """The defects that a loop winds around, with turns and the charge of one turn.

    Parameters
    ----------
    defects
        The defects to look for; default: the result of `find_defects`.
    connection
        Connection with which the charge of each defect is measured, on a small loop around it;
        None: charges are omitted.

    Raises
    ------
    SingularPointError
        The loop passes through a defect; the message names defect and point.
    UnknownNameError, CoordinateError
        The frame has no parameter of this name; a value contradicts the assumptions of its
        parameter.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> frame = load("screw_dislocation").frame
    >>> (inside,) = enclosed_defects(frame, Loop.circle([0.5, 0, 0], 1).times(-2))
    >>> inside.turns, str(inside)
    (-2, 'singular line at x = 0, y = 0, -2 times')
    """
    frame = as_frame(frame)
    connection = None if connection is None else as_connection(connection)
    loop, parameters = with_numbers(frame, loop, parameters)
    # Positions need few of them; all given values are checked nevertheless.
    parameter_values(frame, (), parameters)
    lines = [
        one
        for one in (find_defects(frame, connection) if defects is None else defects)
        if one.across
    ]
    if loop.gap.any():
        # Where coordinates are angles, lines have other places, and nothing here knows them.
        return ()
    turns = [(one, one.winding(loop, parameters)) for one in lines]
    return tuple(
        EnclosedDefect(
            one, count, None if connection is None else charge(connection, one, loop, parameters)
        )
        for one, count in turns
        if count
    )


def winds_around_line(
    frame: Frame,
    loop: Loop,
    part: Part,
    parameters: Parameters | None,
    connection: Connection | None = None,
) -> bool:
    """Whether a part of a loop winds around a singular line, which a surface over it meets.

    Rounding of a large loop hides a small charge, so that line and surface seem to agree.
    """
    lines = [(x, x.across) for x in find_defects(frame, connection) if x.across is not None]
    if not lines or loop.gap.any():
        return False
    points = np.concatenate([x.reshape(len(x), -1) for _, _, x in arc_samples(part)], axis=1)
    for one, sides in lines:
        across = np.array(rows(sides, len(points)))
        low, high = (across @ points).min(axis=1), (across @ points).max(axis=1)
        # Twice the box of the samples contains the curve between them.
        apart = np.abs(across @ np.array(one.place(parameters)) - (low + high) / 2)
        if (apart <= high - low).all() and one.winding(replace(loop, parts=(part,)), parameters):
            return True
    return False


def charge(
    connection: Connection,
    defect: Defect,
    near: Loop,
    parameters: Parameters | None = None,
) -> AffineMap:
    """Charge of one turn around a defect: the development of a small circle about it.

    Parameters
    ----------
    near
        A loop about it: the circle has a quarter of its size, or less, at its height.

    Raises
    ------
    LoopError
        The defect is not a line, or the development does not converge.

    Examples
    --------
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.spaces import load
    >>> frame = load("screw_dislocation").frame
    >>> (axis,) = find_defects(frame)
    >>> loop = Loop.circle([0, 0, 2], 1)
    >>> (charge(cartan(frame), axis, loop, {"b": 0.5}).burgers.round(12) + 0.0).tolist()
    [0.0, 0.0, 0.5]
    """
    frame = connection.frame
    if isinstance(frame.given, Lines) and connection.kind == "cartan":
        vector = _known(frame, frame.given, defect, parameters)
        if vector is not None:
            return AffineMap.of(np.zeros((frame.dimension,) * 2), vector)
    others = find_defects(frame, connection)
    (part,) = _circle_about(frame, defect, near, others, parameters).parts
    form = AffineForm(connection, parameters)
    return transported(part.arcs, line_rate(form, part), 1e-12).motion


def _known(
    frame: Frame, lines: Lines, defect: Defect, parameters: Parameters | None
) -> np.ndarray | None:
    """The Burgers vector with which a line was made, shape (n,)."""
    values = parameter_values(frame, lines.parameters, parameters)
    return lines.vector_at(defect.point[:2], values)


def _circle_about(
    frame: Frame,
    defect: Defect,
    near: Loop,
    others: Sequence[Defect],
    parameters: Parameters | None,
) -> Loop:
    """A small circle about a defect at the height of a loop, with no other defect in it."""
    if defect.across is None:
        raise LoopError(f"{defect}: it is not a line; no loop winds around it.")
    n = frame.dimension
    place = np.array(defect.place(parameters))
    covectors = np.array(rows(defect.across, n))
    # The point of the defect nearest to the loop, and two directions across it.
    dual = np.linalg.pinv(covectors)
    base = np.array(near.base)
    centre = base - dual @ (covectors @ (base - place))
    radius = ALONE * near.size
    for other in others:
        if other == defect or other.across is None:
            continue
        gap = np.array(rows(other.across, n)) @ (centre - np.array(other.place(parameters)))
        radius = min(radius, ALONE * float(np.linalg.norm(gap)))
    return Loop.circle(centre.tolist(), radius, (dual[:, 0], dual[:, 1]))


def lines_alone(frame: Frame, poles: Poles | None, connection: Connection | None = None) -> bool:
    """Whether all zeros of the denominators are straight lines, whose windings are known."""
    lines = [one for one in find_defects(frame, connection) if one.across is not None]
    return poles is not None and len(lines) == len(poles.names)


def factors(frame: Frame) -> tuple[sp.Expr, ...]:
    """Denominators of the coframe and factors of its determinant, those that contain coordinates.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> factors(load("screw_dislocation").frame)
    (x**2 + y**2,)
    """
    bases: dict[sp.Expr, None] = {}
    for element in frame.coframe.components.independent.values():
        bases.update(dict.fromkeys(_bases(element, below=True)))
    determinant = frame.determinant.element()
    bases.update(dict.fromkeys(_bases(determinant, below=True)))
    bases.update(dict.fromkeys(_bases(determinant, below=False)))
    coordinates = set(frame.coordinates)
    return tuple(factor for factor in bases if factor.free_symbols & coordinates)


def _bases(element: Element, below: bool) -> list[sp.Expr]:
    """The factors of a denominator, or of a numerator."""
    return [_expression(base) for base, exponent in form(element).powers if (exponent < 0) is below]


def _expression(base: Generator | Sum) -> sp.Expr:
    """A factor as sympy; for a root its radicand, which has the same zeros."""
    if not isinstance(base, Sum):
        if base.kind == "root" and base.tail is not None:
            return base.tail.sympy
        return base.shown
    terms = []
    for value, monomial in base.terms:
        powers = [generator.shown**exponent for generator, exponent in monomial]
        terms.append(sp.Mul(sp.Rational(int(value.p), int(value.q)), *powers))
    return sp.Add(*terms)

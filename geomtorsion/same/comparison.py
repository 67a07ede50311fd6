"""Comparison: whether two frames, metrics or connections are one geometry in two disguises."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import islice, product

import sympy as sp

from geomtorsion.errors import ArgumentError, CoordinateError
from geomtorsion.geometry import Connection, Frame
from geomtorsion.geometry.connections import FrameLike, frame_of
from geomtorsion.same.equivalence import TRIES, Equivalence
from geomtorsion.same.family import member_of
from geomtorsion.same.invariants import Invariants, refuse_functions
from geomtorsion.support import checks
from geomtorsion.support.exclusive import exclusive

KEEPS = ("metric", "teleparallel", "legs")


@exclusive
def same_geometry(
    one: FrameLike | Connection,
    two: FrameLike | Connection,
    keep: str | None = None,
    *,
    orientation: bool = False,
) -> Equivalence:
    """Whether two frames, metrics or connections are one geometry in different coordinates.

    The components of torsion and curvature and of their covariant derivatives, along legs, are a
    complete set of invariants. Exact ranks count the independent ones, order by order, until their
    number no longer grows [Cartan1946], [Karlhede1980]. The search then looks for a point of the
    second geometry with the same invariants as a generic point of the first. All invariants are
    compared to 50 digits, up to the order after the last growth.

    Parameters
    ----------
    one, two
        Frames, spaces or names of shipped spaces; or two connections, which are compared together
        with the metric. A name that is compared with a frame or space is a family: values of its
        parameters are searched, as in `spaces.identify`.
    keep
        "metric": metrics, whose legs are free. "teleparallel": frames whose legs may differ by a
        constant rotation or reflection. "legs": frames, leg by leg in their order. None:
        "metric"; with two connections, both metric and connection.
    orientation
        True: only maps that keep the orientation count. The legs, in their order, are right-handed;
        if they are complex or come from a metric, the coordinates are.

    Returns
    -------
    Equivalence: "same" with the largest difference, "different" with its proof, or "undecided".
    The verdict is local: it holds near generic points, not globally. Signs of invariants are
    compared in the regions of both frames; otherwise formulas count wherever they are regular.
    Except in a family, parameters with equal names are one constant, which gets a random rational
    value.

    Raises
    ------
    ArgumentError
        The arguments are of other kinds, or contain unknown functions such as a(t).

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> u, v = sp.symbols("u v", real=True)
    >>> disguise = Frame.from_metric([u, v], [[4 / (1 + u**2 + v**2) ** 2, 0],
    ...                                       [0, 4 / (1 + u**2 + v**2) ** 2]])
    >>> sphere = Frame("theta phi", [[1, 0], [0, "sin(theta)"]], domain="0 < theta < pi")
    >>> same_geometry(disguise, sphere).verdict
    'same'
    >>> result = same_geometry(disguise, "s2")
    >>> result.verdict, result.member
    ('same', {'R': 1})
    """
    checks.flag(orientation, "orientation")
    are_connections = [isinstance(x, Connection) for x in (one, two)]
    if keep is None and any(are_connections):
        if not all(are_connections):
            raise ArgumentError(
                "expected two frames or two connections, got one of each. Give both as "
                "connections, such as gt.cartan(frame), or name the geometry: keep='metric'."
            )
        sides = [(x.frame, x) for x in (one, two) if isinstance(x, Connection)]
        return _compared("connection", sides, orientation)
    name = "metric" if keep is None else checks.choice(keep, KEEPS, "keep", ArgumentError)
    first, second = frame_of(one, "one"), frame_of(two, "two")
    for frame in (first, second):
        refuse_functions(frame)
    names = [isinstance(side, str) and not side.endswith(".toml") for side in (one, two)]
    if names == [False, True] and second.parameters:
        return member_of(first, second, name, orientation)
    if names == [True, False] and first.parameters:
        return member_of(second, first, name, orientation, flipped=True)
    return _compared(name, [(first, None), (second, None)], orientation)


def _compared(
    keep: str, sides: Iterable[tuple[Frame, Connection | None]], orientation: bool
) -> Equivalence:
    """The verdict on two geometries."""
    (one, first), (two, second) = sides
    for frame in (one, two):
        refuse_functions(frame)
    assumptions = one.region.assumption, two.region.assumption
    values = parameter_values(one, two)
    if values:
        own = [{k: v for k, v in values.items() if k in map(str, f.parameters)} for f in (one, two)]
        one, two = (f.subs(v) if v else f for f, v in zip((one, two), own, strict=True))
        first, second = (
            c.subs(v) if c is not None and v else c
            for c, v in zip((first, second), own, strict=True)
        )
    invariants = Invariants(one, keep, first)
    equal = one == two and first == second
    other = invariants if equal else Invariants(two, keep, second)
    return Equivalence(invariants, other, orientation, values, assumptions)


def parameter_values(one: Frame, two: Frame) -> dict[str, sp.Rational]:
    """Generic rational values of all parameters, by name, that both regions allow."""
    if not (one.parameters or two.parameters):
        return {}
    sides = (islice(frame.region.points(), TRIES) for frame in (one, two))
    for first, second in product(*sides):
        values = {str(x): second[x] for x in two.parameters}
        values |= {str(x): first[x] for x in one.parameters}
        if _has_points(two, values):
            return values
    names = ", ".join(dict.fromkeys(map(str, (*two.parameters, *one.parameters))))
    raise ArgumentError(
        f"expected parameters that both domains allow, got no values for {names}. Give them "
        "values with frame.subs."
    )


def _has_points(frame: Frame, values: Mapping[str, sp.Rational]) -> bool:
    """Whether the region of a frame has points at values of its parameters."""
    own = {x: values[str(x)] for x in frame.parameters}
    try:
        return not own or bool(frame.subs(own).region.point)
    except CoordinateError:
        return False

"""Linearized: equations of motion to first order around a steady motion, as a matrix.

The Lagrangian and the constraints are expanded to second order at one state, node by node, so that
the equations of motion away from it are never written: they may be far too long for that.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.action import validation
from geomtorsion.action.hamel import coefficients_of
from geomtorsion.action.principles import principle_named
from geomtorsion.action.steady import Linearization, Motion, Point, exactly
from geomtorsion.action.tangent_bundle import bundle_over
from geomtorsion.errors import KineticMatrixError, MissingValueError, StartError, UnknownNameError
from geomtorsion.exact import Field
from geomtorsion.geometry.validation import named_symbols
from geomtorsion.ode.terms import expression, symbol_table
from geomtorsion.support import checks

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry.connections import ConnectionLike, FrameLike


def linearized(
    frame: FrameLike,
    lagrangian: str | int | sp.Expr | Element,
    forces: object = None,
    principle: str = "closed_in_coordinates",
    constraints: object = None,
    *,
    at: Mapping[object, object],
    velocities: Sequence[sp.Symbol | str] | None = None,
    parameters: Iterable[sp.Symbol | str] | None = None,
    connection: ConnectionLike | None = None,
) -> Linearization:
    """Equations of motion to first order around a steady motion, without writing them out.

    Equation
    --------
    d/dt p_k = A_kj^i u^j p_i + E_k L + F_k + lambda_r a^r_k,  a^r_i u^i + c^r = 0,  to first order

    where lambda_r are the reactions of the steady motion. `EquationsOfMotion.linearized` gives the
    same; this function also serves systems whose equations are too long to be written.

    Parameters
    ----------
    frame, lagrangian, forces, principle, constraints, parameters, connection
        as in `equations_of_motion`.
    at
        the steady motion: name of a coordinate, velocity or parameter -> number, text or expression
        over parameters. Velocities that constraints fix follow from the others, which are 0 where
        they are not named. Parameters without a value stay symbols.
    velocities
        the velocities that are independent under constraints; by default the constraints remove the
        last velocities that they determine.

    Raises
    ------
    StartError
        The motion is not steady: a velocity changes, or a coordinate that moves occurs in a force.
    MissingValueError
        A coordinate that matters has no value.
    ConstraintError
        The constraints are not linear in u, or do not determine the other velocities.
    KineticMatrixError
        The kinetic matrix is singular at the state.

    Examples
    --------
    A pendulum upright, with k = g/l:

    >>> q = sp.Symbol("q")
    >>> from geomtorsion.geometry import Frame
    >>> found = linearized(Frame([q], [[1]]), "u1**2/2 - k*cos(q)", at={"q": 0}, parameters=["k"])
    >>> found
    q' = u1
    u1' = k*q
    >>> found.at({"k": 4}).eigenvalues.real.tolist()
    [2.0, -2.0]
    """
    chosen = principle_named(principle)
    frame, connection = validation.checked_frame(frame, connection)
    n = frame.dimension
    pushes = validation.force_entries(forces, n)
    fixed = validation.constraint_entries(constraints, n)
    read = validation.expressions(frame, [("lagrangian", lagrangian), *pushes, *fixed], parameters)
    bundle = bundle_over(frame, read)
    coefficients = coefficients_of(bundle.frame, chosen, connection)
    exact = [exactly(value) for value in read]
    state = Motion(bundle, exact[0], exact[1 : n + 1], exact[n + 1 :], coefficients)
    table = checks.by_name(at, "at", StartError)
    more = set().union(*(x.free_symbols for x in table.values() if isinstance(x, sp.Expr)))
    listed = named_symbols(() if parameters is None else parameters, what="parameter")
    if any(bundle.symbols.time in term.free_symbols for term in state.terms):
        raise StartError(
            f"expected a steady motion, got an explicit time {bundle.symbols.time}. Linearise "
            "without it."
        )
    used = sorted(state.used())
    place, speeds = _values(state, table, used, {*more, *listed})
    values = (*place.values(), *speeds.values())
    field = Field(sorted(set().union(*(x.free_symbols for x in values)), key=str))
    point = Point(state, field, place, used)
    try:
        return point.linearization(*point.steady(speeds, velocities))
    except ZeroDivisionError:
        raise KineticMatrixError(
            "expected a regular kinetic matrix of the free velocities, got one whose determinant "
            "vanishes at this state. Add the kinetic energy that is missing."
        ) from None


def _values(
    motion: Motion,
    at: Mapping[str, object],
    used: Sequence[int],
    extra: Collection[sp.Symbol],
) -> tuple[dict[sp.Symbol, sp.Expr], dict[sp.Symbol, sp.Expr]]:
    """Values of coordinates and parameters, which may be themselves, and of u."""
    symbols, frame = motion.bundle.symbols, motion.bundle.frame
    free = set().union(*(x.free_symbols for x in motion.terms))
    inside = {*symbols.coordinates, *symbols.velocities}
    constants = sorted((free | set(frame.parameters)) - inside, key=str)
    by_name = {symbol.name: symbol for symbol in (*inside, *constants)}
    names = {symbol.name for symbol in inside}
    numbers = {symbol.name: symbol for symbol in extra if symbol.name not in names}
    numbers |= {symbol.name: symbol for symbol in constants}
    real, stated = symbol_table(numbers), {}
    for name, value in at.items():
        kind = "a coordinate, velocity or parameter"
        checks.known_name(name, sorted(by_name), "at", UnknownNameError, expected=kind)
        read = expression(value, f"at[{name!r}]", real)
        stated[by_name[name]] = exactly(read.xreplace({real[x]: numbers[x] for x in numbers}))
    values = {x: y for x, y in stated.items() if x in constants}
    coordinates = symbols.coordinates
    needed = [q.name for mu, q in enumerate(coordinates) if mu in used]
    remedy = "The motion depends on it. Give at={'{missing}': 0}, for example."
    checks.check_values(needed, {q.name for q in stated}, "at", MissingValueError, remedy)
    place = {x: values.get(x, x) for x in constants}
    place |= {q: stated.get(q, q).xreplace(values) for q in coordinates}
    return place, {u: stated[u].xreplace(values) for u in symbols.velocities if u in stated}

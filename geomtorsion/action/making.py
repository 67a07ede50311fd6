"""Making: what a user gives for equations of motion, checked once and read exactly."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from geomtorsion.action.hamel import Hamel
from geomtorsion.action.phase import Phase
from geomtorsion.action.restriction import Restriction, restricted
from geomtorsion.action.twist import twist_of
from geomtorsion.errors import ConstraintError, LagrangianError, ShapeError

if TYPE_CHECKING:
    import sympy as sp

    from geomtorsion.action.principles import Principle
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Connection, Frame

Named = list[tuple[str, Any]]


def force_entries(forces: Any, n: int) -> Named:
    """F_k as n named entries, from a sequence of n or a mapping k -> F_k; none are zero.

    Raises
    ------
    ShapeError
        There are not n of them, or a number in the mapping is not among 0 ... n - 1.
    """
    if forces is None:
        given: Mapping[Any, Any] = {}
    elif isinstance(forces, Mapping):
        given = forces
    else:
        values = _listed(forces, "forces")
        if len(values) != n:
            raise ShapeError(
                f"forces: {n} components F_k were needed, one for each form of the frame, "
                f"{len(values)} came. Give {n}, or a mapping such as {{0: 'M1'}}."
            )
        given = dict(enumerate(values))
    wrong = [key for key in given if key not in range(n)]
    if wrong:
        raise ShapeError(
            f"forces: there is no component {wrong[0]!r}. Count the forms of the frame from 0 "
            f"to {n - 1}."
        )
    return [(f"forces[{k}]", given.get(k, 0)) for k in range(n)]


def constraint_entries(constraints: Any, n: int) -> Named:
    """The constraints, each an expression that stays zero, named for messages.

    Raises
    ------
    ConstraintError
        There are as many as velocities, or more: nothing would move.
    """
    values = [] if constraints is None else _listed(constraints, "constraints")
    if len(values) >= n:
        raise ConstraintError(
            f"{len(values)} constraints came for {n} velocities: nothing could move. Give fewer."
        )
    return [(f"constraints[{r}]", value) for r, value in enumerate(values)]


def _listed(values: Any, what: str) -> list[Any]:
    values = values.tolist() if hasattr(values, "tolist") else values
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise ShapeError(f"{what}: a list was needed, {values!r} came. Put it in brackets.")
    return [row[0] if isinstance(row, list) and len(row) == 1 else row for row in values]


def check_real(frame: Frame) -> None:
    """Refuse complex frames: their velocities are no motion."""
    if frame.complex:
        raise LagrangianError(
            f"{frame.name or 'the frame'} is complex (a null tetrad); mechanics needs a real frame."
        )


def hamel_of(
    phase: Phase,
    lagrangian: sp.Expr,
    forces: Sequence[sp.Expr],
    constraints: Sequence[sp.Expr],
    principle: Principle,
    connection: Connection | None,
) -> Hamel:
    """The equations in quasi-velocities, over the frame or over one adapted to constraints."""
    named = [("lagrangian", lagrangian)]
    named += [(f"forces[{k}]", value) for k, value in enumerate(forces)]
    names = [f"constraints[{r}]" for r in range(len(constraints))]
    every = phase.frame.read([*named, *zip(names, constraints, strict=True)])
    energy, pushes, held = every[0], every[1 : len(named)], every[len(named) :]
    if held:
        restriction = restricted(phase, list(zip(names, held, strict=True)))
        return _restricted(restriction, lagrangian, forces, principle, connection)
    n = phase.dimension
    momenta = tuple(energy.diff(symbol) for symbol in phase.letters.velocities)
    slopes = tuple(phase.along(k, energy) for k in range(n))
    twist = twist_of(phase.frame, principle, connection)
    return Hamel(phase, tuple(range(n)), energy, momenta, slopes, tuple(pushes), twist)


def _restricted(
    restriction: Restriction,
    lagrangian: sp.Expr,
    forces: Sequence[sp.Expr],
    principle: Principle,
    connection: Connection | None,
) -> Hamel:
    """The same over the adapted frame, where the replaced velocities have their values."""
    phase, u = restriction.phase, restriction.phase.letters.velocities
    turned, stopped = restriction.turned(), restriction.stopped()
    energy = phase.frame.read([("lagrangian", lagrangian.xreplace(turned))])[0]

    def held(element: Element) -> Element:
        if not element.symbols & set(stopped):
            return element
        return phase.field.read(element.sympy.subs(stopped))

    momenta = tuple(held(energy.diff(symbol)) for symbol in u)
    slopes = tuple(held(phase.along(k, energy)) for k in range(phase.dimension))
    named = [(f"forces[{k}]", value.xreplace(turned)) for k, value in enumerate(forces)]
    pushes = restriction.carried([held(value) for value in phase.frame.read(named)])
    twist = twist_of(phase.frame, principle, connection)
    free, values = restriction.free, restriction.held
    return Hamel(phase, free, held(energy), momenta, slopes, pushes, twist, values)

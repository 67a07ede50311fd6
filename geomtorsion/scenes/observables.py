"""Observables: what a scene can report, what each is made of and how it is finished."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from geomtorsion.errors import UnknownNameError
from geomtorsion.rigid import attitude
from geomtorsion.rigid.attitude import euler_from_quaternion
from geomtorsion.scenes.assembly import WORK, Assembly
from geomtorsion.scenes.context import (
    ATTITUDE,
    POSITION,
    QUATERNION,
    VELOCITY,
    VERTICAL,
)
from geomtorsion.support.checks import did_you_mean


def nutation(vertical: ArrayLike) -> np.ndarray:
    """phi2, the angle between the third body axis and the vertical n, shape (m,), rad.

    Equation
    --------
    phi2 = atan2(|(n1, n2)|, n3): as accurate at 0 and pi as elsewhere

    Examples
    --------
    >>> nutation([[1e-9, 0, 1.0]]).tolist()
    [1e-09]
    """
    n = np.asarray(vertical, dtype=float)
    return np.arctan2(np.hypot(n[..., 0], n[..., 1]), n[..., 2])


def spin(vertical: ArrayLike) -> np.ndarray:
    """phi1, the angle of rotation about the third body axis, without jumps, shape (m,), rad.

    Equation
    --------
    n = (-sin phi2 cos phi1, sin phi2 sin phi1, cos phi2)

    Examples
    --------
    >>> spin([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).round(6).tolist()
    [0.0, 1.570796]
    """
    n = np.asarray(vertical, dtype=float)
    # Adding 0.0 turns -0.0 into 0.0, whose angle is 0 and not pi.
    return np.unwrap(np.arctan2(n[..., 1], -n[..., 0] + 0.0), axis=0)


def precession(quaternion: ArrayLike) -> np.ndarray:
    """phi3, the angle of the third body axis about the vertical, without jumps, shape (m,), rad."""
    return euler_from_quaternion(quaternion, continuous=True)[..., 2]


def unspun(vectors: ArrayLike) -> np.ndarray:
    """Components along the line of the tilt, the line of nodes and the third body axis.

    These axes follow the third body axis without spinning with it: Rz(phi3) Ry(phi2) of the
    paper's angles. Where it is vertical, phi1 counts as 0.

    Parameters
    ----------
    vectors
        shape (m, 6): a vector in body axes and the vertical n in body axes.

    Returns
    -------
    Array, shape (m, 3): Rz(phi1) v.

    Examples
    --------
    >>> unspun([[1.0, 0.0, 5.0, 0.0, 1.0, 0.0]]).round(12).tolist()  # phi1 is a right angle
    [[0.0, 1.0, 5.0]]
    """
    table = np.asarray(vectors, dtype=float)
    v, n = table[..., :3], table[..., 3:]
    size = np.hypot(n[..., 0], n[..., 1])
    # Upright, phi1 has no meaning by itself; 0 keeps the vector as it is.
    upright = size == 0
    safe = np.where(upright, 1.0, size)
    cos, sin = np.where(upright, 1.0, -n[..., 0] / safe), n[..., 1] / safe
    rows = (cos * v[..., 0] - sin * v[..., 1], sin * v[..., 0] + cos * v[..., 1], v[..., 2])
    return np.stack(rows, -1) + 0.0


Ingredients = Callable[[Assembly], tuple[sp.Expr, ...]]
Finish = Callable[[np.ndarray], np.ndarray]
AXES = ("1", "2", "3")
SPACE = ("x", "y", "z")
# So many times make smooth curves of 45 turns: pieces leave their circle by 1 % of its radius.
# Measures between them are as good as the motion.
FINE = 1001


@dataclass(frozen=True)
class Observable:
    """Something that can be watched.

    name, meaning, unit: the name in requests, a description, and the unit (SI).
    labels: names of its components; none for one number.
    made_of: expressions over states and parameters of an assembly.
    finish: their values, shape (m, k), -> the quantity, (m,) or (m, components); None: as they are.
    """

    name: str
    meaning: str
    unit: str
    labels: tuple[str, ...]
    made_of: Ingredients
    finish: Finish | None = None


def _table() -> tuple[Observable, ...]:
    """Everything that any body can be asked, whatever acts on it."""
    q = Observable

    def in_space(name: str) -> Ingredients:
        return lambda a: tuple(ATTITUDE * getattr(a, name))

    def with_vertical(name: str) -> Ingredients:
        return lambda a: (*getattr(a, name), *VERTICAL)

    body_axis = "seen from the axis that tilts but does not spin with the body"
    return (
        q("omega", "angular velocity, body axes", "rad/s", AXES, lambda a: tuple(a.omega)),
        q("omega_space", "angular velocity, space axes", "rad/s", SPACE, in_space("omega")),
        q("omega_axis", f"angular velocity, {body_axis}", "rad/s", AXES,
          with_vertical("omega"), unspun),
        q("angular_momentum", "angular momentum, body axes", "N m s", AXES,
          lambda a: tuple(a.angular_momentum)),
        q("angular_momentum_space", "angular momentum, space axes", "N m s", SPACE,
          in_space("angular_momentum")),
        q("angular_momentum_axis", f"angular momentum, {body_axis}", "N m s", AXES,
          with_vertical("angular_momentum"), unspun),
        q("quaternion", "attitude, body to space, scalar first", "", ("0", *AXES),
          lambda _: tuple(QUATERNION)),
        q("matrix", "attitude as rotation matrix, body to space", "",
          tuple(f"{i}{j}" for i in AXES for j in AXES),
          lambda _: tuple(QUATERNION), attitude.matrix_from_quaternion),
        euler("euler", attitude.PAPER),
        q("nutation", "angle between the third body axis and the vertical", "rad", (),
          lambda _: tuple(VERTICAL), nutation),
        q("spin", "angle of rotation about the third body axis, phi1", "rad", (),
          lambda _: tuple(VERTICAL), spin),
        q("precession", "angle of the third body axis about the vertical, phi3", "rad", (),
          lambda _: tuple(QUATERNION), precession),
        q("axis", "axis of symmetry, or third body axis, in space", "", SPACE,
          lambda a: tuple(ATTITUDE * sp.Matrix(_axis(a)))),
        q("vertical", "upward direction, body axes", "", AXES, lambda _: tuple(VERTICAL)),
        q("energy", "total energy", "J", (), lambda a: (a.kinetic_energy + a.potential_energy,)),
        q("kinetic_energy", "energy of rotation and translation", "J", (),
          lambda a: (a.kinetic_energy,)),
        q("rotational_energy", "energy of rotation about the centre of mass", "J", (),
          lambda a: (a.rotational_energy,)),
        q("potential_energy", "energy stored in the effects", "J", (),
          lambda a: (a.potential_energy,)),
        q("work", "energy put in by effects since the start", "J", (),
          lambda a: (a.constrained(WORK),)),
        q("energy_balance", "total energy minus the work of the effects: constant", "J", (),
          lambda a: (a.kinetic_energy + a.potential_energy - a.constrained(WORK),)),
        q("position", "centre of mass", "m", SPACE, lambda a: _constrained(a, POSITION)),
        q("velocity", "of the centre of mass, space axes", "m/s", SPACE,
          lambda a: _constrained(a, VELOCITY)),
        q("velocity_body", "of the centre of mass, body axes", "m/s", AXES,
          lambda a: tuple(a.velocity_body)),
        q("momentum", "mass times velocity, space axes", "N s", SPACE,
          lambda a: tuple(a.context.mass * v for v in _constrained(a, VELOCITY))),
    )  # fmt: skip


def euler(name: str, convention: str) -> Observable:
    """Euler angles of a convention; first and third continue beyond pi."""
    finish = partial(attitude.euler_from_quaternion, convention=convention, continuous=True)
    meaning = f"Euler angles {convention}" + (" (the paper's)" if convention == "zyz" else "")
    return Observable(name, meaning, "rad", AXES, lambda _: tuple(QUATERNION), finish)


OBSERVABLES: Mapping[str, Observable] = {item.name: item for item in _table()}


def observable(name: str, assembly: Assembly) -> Observable:
    """The quantity of this name in a scene: known to all, an effect's own, or a bare state.

    Raises
    ------
    UnknownNameError
        no effect provides it; the message names near ones.
    """
    if name == "axis":
        own = assembly.context.body.symmetry_axis is None
        which = "third body axis" if own else "axis of symmetry"
        return replace(OBSERVABLES[name], meaning=f"{which} in space")
    if name in OBSERVABLES:
        return OBSERVABLES[name]
    head, _, convention = name.partition(":")
    if head == "euler":
        return euler(name, attitude.checked_convention(convention))
    for key, part in assembly.parts.items():
        if name in part.outputs:
            output = part.outputs[name]
            many = isinstance(output, list | tuple | sp.MatrixBase)
            parts = tuple(assembly.constrained(x) for x in (output if many else (output,)))
            labels = tuple(str(k) for k in range(1, len(parts) + 1)) if many else ()
            return Observable(name, f"of {key}", "", labels, lambda _, parts=parts: parts)
    # Names of single states come last, so that none hides a quantity.
    bare = {s.name: s for s in (*assembly.rates, *VERTICAL, *QUATERNION, *assembly.substitutions)}
    if name in bare:
        values = (assembly.constrained(bare[name]),)
        return Observable(name, "state", "", (), lambda _: values)
    own = [key for part in assembly.parts.values() for key in part.outputs]
    raise UnknownNameError(unknown(name, own))


def unknown(name: str, own: Iterable[str] = ()) -> str:
    """The message for a name that cannot be watched."""
    names = (*OBSERVABLES, *own)
    hint = did_you_mean(str(name), names)
    return (
        f"nothing called {name!r} can be watched: no effect of the scene provides it. {hint}"
        f"There are {', '.join(names)}, euler:CONVENTION (as euler:ZXZ) and single states."
    )


def _axis(assembly: Assembly) -> list[sp.Expr]:
    """The body's axis of symmetry, or its third axis, as exact numbers."""
    axis = assembly.context.body.symmetry_axis
    return [sp.Rational(float(x)) for x in ((0, 0, 1) if axis is None else axis)]


def _constrained(assembly: Assembly, symbols: Iterable[sp.Symbol]) -> tuple[sp.Expr, ...]:
    return tuple(assembly.constrained(symbol) for symbol in symbols)

"""Development slopes: derivatives of developments by parameters of frame and loop."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from geomtorsion.errors import ChartEdgeError, LoopError, SingularPointError, UnknownNameError
from geomtorsion.geometry.connections import ConnectionLike, as_connection
from geomtorsion.loops.arcs import Parameters
from geomtorsion.loops.development import Development, develop
from geomtorsion.loops.loop import Loop, check_loop
from geomtorsion.support import checks

# Steps of central differences as parts of the parameter. With more of them a difference of smooth
# developments loses more digits to their errors than the extrapolation gains.
STEPS = tuple(2.0**-k for k in range(3, 9))


@dataclass(frozen=True, eq=False)
class DevelopmentDerivative:
    """Derivative of a development by one parameter.

    burgers: db^i/dp, shape (n,). rotation: dR^j_i/dp, shape (n, n); both in the frame at the base.
    error: estimate of the error of burgers; turn_error: of the entries of the rotation.
    """

    burgers: np.ndarray
    rotation: np.ndarray
    error: float
    turn_error: float


def development_derivatives(
    connection: ConnectionLike,
    loop: Loop,
    by: Sequence[str],
    accuracy: float = 1e-12,
    *,
    parameters: Parameters | None = None,
) -> dict[str, DevelopmentDerivative]:
    """Derivatives of the development of a loop by parameters of frame and loop, with errors.

    Equation
    --------
    Central differences over steps that are halved, extrapolated to zero (Richardson 1911). The
    result is the best of all orders; its error is the change by the last order plus the effect of
    the errors of the developments.

    Parameters
    ----------
    by
        names of parameters of frame or loop.
    accuracy, parameters
        see `develop`.

    Returns
    -------
    Name -> DevelopmentDerivative, in the frame at the base point, which moves with the loop.

    Raises
    ------
    UnknownNameError
        Neither frame nor loop has such a parameter.
    LoopError
        The loop cannot be developed on both sides of the value of the parameter.

    Examples
    --------
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.spaces import load
    >>> screw, loop = cartan(load("screw_dislocation").frame), Loop.circle([0, 0, 0], 1)
    >>> slope = development_derivatives(screw, loop, ["b"], parameters={"b": 3})["b"]
    >>> slope.burgers.round(9) + 0.0
    array([0., 0., 1.])
    """
    connection = as_connection(connection)
    check_loop(loop, connection.frame.dimension)
    known = {symbol.name for symbol in (*connection.frame.parameters, *loop.symbols)}
    values = {str(name): x for name, x in (parameters or {}).items()}
    names = [
        checks.known_name(name, sorted(known), "by", UnknownNameError)
        for name in checks.entries(by, "by")
    ]
    # A development without changes: it reports missing numbers, singular points and edges.
    develop(connection, loop, accuracy, parameters=values or None)

    def at(name: str, value: float) -> Development:
        return develop(connection, loop, accuracy, parameters=values | {name: value})

    table = {}
    for name in names:
        value = checks.number(values.get(name), f"parameters: {name}", LoopError)
        table[name] = _derivative([_difference(at, name, value, step) for step in STEPS], name)
    return table


@dataclass(frozen=True, eq=False)
class _Difference:
    """A central difference of the increment of a motion, and the errors it has from both ends."""

    increment: np.ndarray
    error: float
    turn_error: float


def _difference(
    at: Callable[[str, float], Development], name: str, value: float, part: float
) -> _Difference | None:
    """The central difference over a part of a value; None where the loop cannot be developed."""
    step = (abs(value) or 1.0) * part
    try:
        high, low = at(name, value + step), at(name, value - step)
    except (ChartEdgeError, LoopError, SingularPointError):
        return None
    return _Difference(
        (high.motion.increment - low.motion.increment) / (2 * step),
        (high.error + low.error) / (2 * step),
        (high.turn_error + low.turn_error) / (2 * step),
    )


def _derivative(differences: Sequence[_Difference | None], name: str) -> DevelopmentDerivative:
    """The best extrapolation, the errors of translation and rotation each by its own best order."""
    present = [one for one in differences if one is not None]
    if len(present) < 3:
        raise LoopError(
            f"by: expected a loop that can be developed for values of {name} on both sides, got "
            "one at the edge of its frame. Choose another value."
        )
    shift = _best([one.increment[:-1, -1] for one in present], [one.error for one in present])
    turn = _best([one.increment[:-1, :-1] for one in present], [one.turn_error for one in present])
    return DevelopmentDerivative(shift[0], turn[0], shift[1], turn[1])


def _best(samples: Sequence[np.ndarray], noise: Sequence[float]) -> tuple[np.ndarray, float]:
    """The extrapolation to step zero with the smallest error, and this error."""
    rows, errors = list(samples), list(noise)
    best, least = samples[-1], math.inf
    for order in range(1, len(samples)):
        weight = 4.0**order
        higher = [(weight * two - one) / (weight - 1) for one, two in pairwise(rows)]
        # Errors of the developments grow by the weights of the differences.
        lost = [(weight * two + one) / (weight - 1) for one, two in pairwise(errors)]
        for k, value in enumerate(higher):
            change = float(np.abs(value - rows[k + 1]).max(initial=0.0))
            if change + lost[k] < least:
                best, least = value, change + lost[k]
        rows, errors = higher, lost
    return best, least

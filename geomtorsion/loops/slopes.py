"""Slopes: derivatives of Burgers vectors by the parameters of a frame."""

from __future__ import annotations

from collections.abc import Sequence

from geomtorsion.errors import CoframeError, UnknownNameError
from geomtorsion.geometry import Frame
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.geometry.derived import derived
from geomtorsion.loops.arcs import Parameters
from geomtorsion.loops.burgers import burgers_vector
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.result import BurgersVector
from geomtorsion.support import checks


def burgers_derivatives(
    frame: FrameLike,
    loop: Loop,
    by: Sequence[str],
    accuracy: float = 1e-12,
    *,
    parameters: Parameters | None = None,
) -> dict[str, BurgersVector]:
    """Derivatives of the Burgers vector of a loop by parameters of the frame, each with an error.

    Equation
    --------
    db^i/dp = loop integral (de^i_mu/dp) dq^mu

    It is the Burgers vector of the coframe dq^i + de^i/dp, since the integral of dq^i vanishes.
    `prove` works on it as on any Burgers vector.

    Parameters
    ----------
    by
        names of parameters of the frame.
    accuracy, parameters
        see `burgers_vector`.

    Returns
    -------
    Name -> BurgersVector: db^i/dp in the frame, shape (n,).

    Raises
    ------
    UnknownNameError
        The frame has no such parameter.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> screw, loop = load("screw_dislocation"), Loop.circle([0, 0, 0], 1)
    >>> slopes = burgers_derivatives(screw, loop, ["b"], parameters={"b": 3})
    >>> slopes["b"].vector.round(9) + 0.0
    array([0., 0., 1.])
    """
    frame = as_frame(frame)
    names = [symbol.name for symbol in frame.parameters]
    table, kind = {}, "parameters of the frame"
    for name in checks.entries(by, "by"):
        checks.known_name(name, names, "by", UnknownNameError, expected=kind)
        table[name] = burgers_vector(slope(frame, name), loop, accuracy, parameters=parameters)
    return table


@derived
def slope(frame: Frame, name: str) -> Frame:
    """A frame whose Burgers vectors are the derivatives of another's by a parameter.

    Its coframe is c dq^i + de^i/dp with a whole number c for which it is regular.
    """
    symbol = next(symbol for symbol in frame.parameters if symbol.name == name)
    n = frame.dimension
    slopes = [[frame.coframe.element(i, j).diff(symbol).sympy for j in range(n)] for i in range(n)]
    # The determinant is a polynomial of degree n in c, with at most n zeros.
    for c in range(1, n + 2):
        rows = [[x + c * (i == j) for j, x in enumerate(row)] for i, row in enumerate(slopes)]
        try:
            return Frame(frame.coordinates, rows, parameters=frame.parameters, domain=frame.domain)
        except CoframeError:
            continue
    raise AssertionError("a polynomial has more zeros than its degree")

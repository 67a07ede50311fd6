"""Inertial: the flat connection that belongs to a coframe by its limit without gravity."""

from __future__ import annotations

from collections.abc import Mapping

from geomtorsion.errors import GravityError
from geomtorsion.geometry import Connection, from_spin_connection, levi_civita
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.support import checks


def inertial(frame: FrameLike, limit: Mapping) -> Connection:
    """Flat connection with the spin connection that the coframe has without gravity.

    The limit of the coframe without gravity has turning legs only: its Levi-Civita connection is
    flat, and its spin connection omega_ai^j is taken for the coframe itself (Krssak, Saridakis
    2016). The legs may then be chosen freely, as in spherical coordinates.

    Parameters
    ----------
    limit
        Values that switch gravity off, as for `Frame.subs`: {"M": 0} or {a(t): 1}.

    Raises
    ------
    GravityError
        The limit is not flat.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> hole = gt.spaces.load("schwarzschild").frame
    >>> connection = inertial(hole, {"M": 0})
    >>> connection.is_flat, connection.torsion.S.is_zero
    (True, False)
    """
    frame = as_frame(frame, "frame", GravityError)
    reference = levi_civita(frame.subs(limit))
    if not reference.is_flat:
        raise GravityError(
            f"limit: expected values that make the metric flat, got {checks.shown(limit)}. Give "
            "values that switch gravity off, such as {'M': 0}."
        )
    omega = reference.spin_connection
    n = range(frame.dimension)
    entries = [[[omega[a, i, j] for j in n] for i in n] for a in n]
    return from_spin_connection(frame, entries)

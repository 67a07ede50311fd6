"""Hamel coefficients: by how much a varied velocity differs from the change of a variation.

They are the A_kj^i of the transpositional relations.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from geomtorsion.geometry import Tensor, cartan
from geomtorsion.geometry.symmetry import Index, antisymmetric

if TYPE_CHECKING:
    from geomtorsion.action.principles import Principle
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Connection, Frame

HamelCoefficients = Mapping[Index, "Element"]


def coefficients_of(
    frame: Frame, principle: Principle, connection: Connection | None = None
) -> HamelCoefficients:
    """A_kj^i at (k, j, i), with  delta-bar u^i = d/dt dPhi^i + A_kj^i u^j dPhi^k.

    u^i = e^i_mu q'^mu gives  delta u^i - d/dt (e^i_mu dq^mu)
    = (d_mu e^i_nu - d_nu e^i_mu) dq^mu q'^nu: the curl of the coframe, in the frame C_kj^i.
    Where the image closes, the torsion 2 S_kj^i of its connection goes off again: all of it for
    the Cartan connection of the frame, which is taken if none is given.
    """
    if not principle.frame_curl:
        return {}
    curl = frame.anholonomy
    if not principle.image_torsion:
        return curl.components.nonzero
    torsion = torsion_over(frame, connection).in_frame()
    return (curl - torsion).components.nonzero


def torsion_over(frame: Frame, connection: Connection | None) -> Tensor:
    """2 S_ab^c of a connection, slots ddu, over a frame that may live in another field."""
    if connection is None:
        return cartan(frame).torsion.T
    torsion = connection.torsion.T
    if torsion.frame is frame:
        return torsion
    values = {index: value.sympy for index, value in torsion.components.nonzero.items()}
    return Tensor(frame, "ddu", values, antisymmetric(3), "T", "torsion (2S)")

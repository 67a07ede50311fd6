"""atlases: further charts of the shipped spaces, and the maps between them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from geomtorsion.curves.atlas import Atlas, single
from geomtorsion.geometry import Frame
from geomtorsion.spaces.atlas_curvilinear import cartesian, seven_sphere, sphere
from geomtorsion.spaces.atlas_holes import de_sitter, isotropic, schwarzschild
from geomtorsion.spaces.atlas_kerr import kerr
from geomtorsion.spaces.atlas_quaternions import ROWS, quaternions
from geomtorsion.spaces.atlas_rotations import EULER, rotations
from geomtorsion.spaces.space import Space


def attach(space: Space) -> Space:
    """The space, its frame knowing the charts of the space; they are made when they are needed.

    Examples
    --------
    >>> from geomtorsion.curves.atlas import atlas_of
    >>> from geomtorsion.spaces.so3 import space
    >>> atlas_of(attach(space("so3", "")).frame).names
    ('quaternion', 'so3', 'so3_xyz')
    """
    frame = space.frame
    make = ATLASES.get(frame.name, single)
    frame.derived("atlas", lambda: replace(make(frame), origin=(make, frame)))
    return space


ATLASES: dict[str, Callable[[Frame], Atlas]] = {
    **dict.fromkeys(EULER, rotations),
    **dict.fromkeys(ROWS, quaternions),
    "s2": sphere,
    "s7": seven_sphere,
    **dict.fromkeys(("flat_polar", "flat_cylindrical", "flat_spherical"), cartesian),
    "schwarzschild": schwarzschild,
    "schwarzschild_isotropic": isotropic,
    "de_sitter": de_sitter,
    "kerr": kerr,
}

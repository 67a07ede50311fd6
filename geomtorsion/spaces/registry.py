"""registry: the list of shipped spaces, one line each, and their lazy loading."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib import import_module
from os import PathLike
from typing import TYPE_CHECKING

from geomtorsion.errors import UnknownNameError
from geomtorsion.spaces.files import read_file
from geomtorsion.support.checks import close_names, shown

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.spaces.embedding import Embedding
    from geomtorsion.spaces.space import Space

# name, module of this package, what it is
SPACES: tuple[tuple[str, str, str], ...] = (
    ("so3", "so3", "rotations, z-y-z Euler angles, body-fixed frame (the paper's)"),
    ("so3_right", "so3_right", "rotations, z-y-z Euler angles, space-fixed frame"),
    ("so3_zxz", "euler", "rotations, z-x-z Euler angles, body-fixed frame"),
    ("so3_xyz", "euler", "rotations, x-y-z Cardan angles, body-fixed frame"),
    ("so3_zyx", "euler", "rotations, yaw-pitch-roll angles, body-fixed frame"),
    ("so3_quaternion", "so3_quaternion", "rotations, three components of a unit quaternion"),
    ("so3_rodrigues", "so3_rodrigues", "rotations, Rodrigues (Gibbs) vector"),
    ("so3_axis_angle", "so3_axis_angle", "rotations, angle about an axis"),
    ("r3xso3", "r3xso3", "rotations and translations of a rigid body, body-fixed frame"),
    ("flat_polar", "flat", "the plane, orthonormal polar frame"),
    ("flat_cylindrical", "flat", "flat space, orthonormal cylindrical frame"),
    ("flat_spherical", "flat", "flat space, orthonormal spherical frame"),
    ("s2", "s2", "the sphere of radius R, compass frame"),
    ("s3", "s3", "the unit three-sphere, Hopf coordinates, left-invariant frame"),
    ("s7", "s7", "the unit seven-sphere, octonionic parallelism"),
    ("heisenberg", "heisenberg", "the Heisenberg group (Nil)"),
    ("sol", "sol", "the solvable group Sol"),
    ("sl2r", "sl2r", "SL(2,R), Riemannian left-invariant metric"),
    ("ads3", "sl2r", "SL(2,R) with its Killing form: anti-de Sitter space in three dimensions"),
    ("ax_plus_b", "ax_plus_b", "the group of maps x -> a x + b"),
    ("bianchi_i", "bianchi", "Bianchi type I: translations"),
    ("bianchi_ii", "bianchi", "Bianchi type II: Heisenberg algebra"),
    ("bianchi_iii", "bianchi", "Bianchi type III: ax + b times a line"),
    ("bianchi_iv", "bianchi", "Bianchi type IV"),
    ("bianchi_v", "bianchi", "Bianchi type V: hyperbolic space"),
    ("bianchi_vi_0", "bianchi", "Bianchi type VI_0: motions of the Minkowski plane"),
    ("bianchi_vi_h", "bianchi", "Bianchi type VI_h, h = -a^2"),
    ("bianchi_vii_0", "bianchi", "Bianchi type VII_0: motions of the Euclidean plane"),
    ("bianchi_vii_h", "bianchi", "Bianchi type VII_h, h = a^2"),
    ("bianchi_viii", "bianchi", "Bianchi type VIII: algebra of SL(2,R)"),
    ("bianchi_ix", "bianchi", "Bianchi type IX: algebra of the rotations"),
    ("chaplygin_sleigh", "constrained_bodies", "a sledge on a blade, which cannot slip sideways"),
    ("rolling_disc", "constrained_bodies", "an upright disc that rolls without slipping"),
    ("wheeled_robot", "constrained_bodies", "a robot that drives and turns, never sideways"),
    (
        "kustaanheimo_stiefel",
        "kustaanheimo_stiefel",
        "the map from four dimensions to three that makes Kepler an oscillator",
    ),
    ("twisted_bar", "twisted_bar", "a crystal whose lattice turns steadily along z"),
    ("screw_dislocation", "screw_dislocation", "screw dislocation along z"),
    ("screw_core", "screw_dislocation", "screw dislocation with a smooth core"),
    ("edge_dislocation", "edge_dislocation", "edge dislocation along z, Burgers vector along x"),
    ("edge_dislocation_elastic", "edge_dislocation", "edge dislocation in elastic equilibrium"),
    (
        "wedge_disclination",
        "wedge_disclination",
        "wedge disclination, torsion-free multivalued frame",
    ),
    (
        "wedge_disclination_periodic",
        "wedge_disclination",
        "wedge disclination, single-valued frame",
    ),
    ("axial_torsion", "axial_torsion", "flat space with constant axial torsion"),
    ("schwarzschild", "schwarzschild", "black hole, static diagonal tetrad"),
    (
        "schwarzschild_isotropic",
        "schwarzschild_isotropic",
        "black hole, isotropic Cartesian tetrad",
    ),
    (
        "schwarzschild_cartesian",
        "schwarzschild_tetrads",
        "black hole, spherical coordinates, tetrad that tends to Cartesian",
    ),
    ("schwarzschild_falling", "schwarzschild_tetrads", "black hole, tetrad in free fall"),
    ("kerr", "kerr", "rotating black hole, Carter tetrad"),
    ("kerr_kinnersley", "kerr_kinnersley", "rotating black hole, Kinnersley null tetrad"),
    ("kerr_newman", "kerr_newman", "charged rotating black hole, Carter tetrad"),
    ("taub_nut", "taub_nut", "mass with a gravitational magnetic charge, static tetrad"),
    ("pp_wave", "pp_wave", "gravitational wave with flat fronts, unknown profile, null tetrad"),
    ("frw", "frw", "expanding universe, unknown a(t), curvature k"),
    ("frw_flat", "frw", "flat expanding universe, Cartesian tetrad"),
    ("frw_closed", "teleparallel_cosmos", "closed universe, left-invariant tetrad"),
    ("frw_open", "teleparallel_cosmos", "open universe, tetrad of flat space-time"),
    ("torsion_bounce", "torsion_bounce", "universe of dust with spin, which bounces by torsion"),
    ("de_sitter", "de_sitter", "de Sitter space, static patch"),
    ("goedel", "goedel", "Goedel's rotating universe"),
    (
        "kerr_de_sitter_torsion",
        "kerr_de_sitter_torsion",
        "rotating black hole with torsion, of Poincare gauge theory",
    ),
)


def names() -> tuple[str, ...]:
    """Names of all shipped spaces, in the order of the registry; imports none of them.

    Examples
    --------
    >>> names()[0]
    'so3'
    """
    return tuple(name for name, _, _ in SPACES)


def titles() -> dict[str, str]:
    """Name -> what the space is, in one line; imports none of them.

    Examples
    --------
    >>> titles()["kerr"]
    'rotating black hole, Carter tetrad'
    """
    return {name: title for name, _, title in SPACES}


def load(name: str | PathLike[str]) -> Space:
    """Space with this name, or from a tetrad file (a path, or a text that ends in .toml).

    Imports the module of the space and no other one.

    Raises
    ------
    UnknownNameError
        No space has this name; the message lists near ones.
    FileFormatError, ExpressionError, LimitError
        The file cannot be read; see `read_file`.

    Examples
    --------
    >>> load("heisenberg").frame.dimension
    3
    """
    if isinstance(name, PathLike) or (isinstance(name, str) and name.endswith(".toml")):
        return read_file(name)
    for key, module, title in SPACES:
        if isinstance(name, str) and key == name:
            return _with_charts(import_module(f"geomtorsion.spaces.{module}").space(name, title))
    text = name.lower().replace("-", "_") if isinstance(name, str) else ""
    near = close_names(text, names(), most=5, cutoff=0.4)
    hint = f"Near: {', '.join(near)}." if near else "None is near."
    raise UnknownNameError(
        f"expected the name of a shipped space, got {shown(name)}. {hint} "
        "`geomtorsion spaces` (or geomtorsion.spaces.names()) lists all of them."
    )


def _with_charts(space: Space) -> Space:
    """The space; its frame makes the atlas of the space on first use."""
    # Charts need the package of motions, which `import geomtorsion` does not load.
    from geomtorsion.curves.atlas import single

    frame, make = space.frame, space.atlas or single
    frame.attached["atlas"] = replace(make(frame), origin=(make, frame))
    return space


def shipped(frame: Frame) -> Space | None:
    """The shipped space of the same name as a frame; None if no space has this name.

    Examples
    --------
    >>> shipped(load("s2").frame).name
    's2'
    """
    return _loaded(frame.name) if frame.name in names() else None


def shipped_space(name: str) -> Space:
    """The shipped space of this name; equal calls return one space, so that its tensors combine.

    Raises
    ------
    UnknownNameError
        No space has this name; the message lists near ones.

    Examples
    --------
    >>> shipped_space("s2").frame is shipped_space("s2").frame
    True
    """
    return _loaded(name) if name in names() else load(name)


@cache
def _loaded(name: str) -> Space:
    return load(name)


def embedding_of(frame: Frame) -> Embedding | None:
    """The embedding of a shipped space, or None; a file is known by its coframe, not its name.

    Examples
    --------
    >>> embedding_of(load("so3").frame).attitude.shape
    (3, 3)
    >>> embedding_of(load("heisenberg").frame) is None
    True
    """
    space = shipped(frame)
    if space is None or space.embedding is None or not _same(frame, space.frame):
        return None
    return space.embedding(frame)


def _same(one: Frame, two: Frame) -> bool:
    """Whether two frames have the same coframe in coordinates of the same names."""
    n = one.dimension
    names = [symbol.name for symbol in one.coordinates]
    if names != [symbol.name for symbol in two.coordinates]:
        return False
    return all(str(one.coframe[i, k]) == str(two.coframe[i, k]) for i in range(n) for k in range(n))

"""registry: the list of shipped spaces, one line each, and their lazy loading."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib import import_module
from os import PathLike
from typing import TYPE_CHECKING, NamedTuple

from geomtorsion.errors import UnknownNameError
from geomtorsion.spaces.tetrad_files import read_file
from geomtorsion.spaces.typed import typed_space
from geomtorsion.support.checks import close_names, shown
from geomtorsion.support.typed_text import is_typed

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.spaces.embedding import Embedding
    from geomtorsion.spaces.space import Space


class Shipped(NamedTuple):
    """A shipped space: its name, what it is, and its module if named otherwise."""

    name: str
    title: str
    module: str = ""


SPACES: tuple[Shipped, ...] = (
    Shipped("so3", "rotations, z-y-z Euler angles, body-fixed frame (the paper's)"),
    Shipped("so3_right", "rotations, z-y-z Euler angles, space-fixed frame"),
    Shipped("so3_zxz", "rotations, z-x-z Euler angles, body-fixed frame", "euler"),
    Shipped("so3_xyz", "rotations, x-y-z Cardan angles, body-fixed frame", "euler"),
    Shipped("so3_zyx", "rotations, yaw-pitch-roll angles, body-fixed frame", "euler"),
    Shipped("so3_quaternion", "rotations, three components of a unit quaternion"),
    Shipped("so3_rodrigues", "rotations, Rodrigues (Gibbs) vector"),
    Shipped("so3_axis_angle", "rotations, angle about an axis"),
    Shipped("r3xso3", "rotations and translations of a rigid body, body-fixed frame"),
    Shipped("flat_polar", "the plane, orthonormal polar frame", "flat"),
    Shipped("flat_cylindrical", "flat space, orthonormal cylindrical frame", "flat"),
    Shipped("flat_spherical", "flat space, orthonormal spherical frame", "flat"),
    Shipped("s2", "the sphere of radius R, compass frame"),
    Shipped("s3", "the unit three-sphere, Hopf coordinates, left-invariant frame"),
    Shipped("s7", "the unit seven-sphere, octonionic parallelism"),
    Shipped("heisenberg", "the Heisenberg group (Nil)"),
    Shipped("sol", "the solvable group Sol"),
    Shipped("sl2r", "SL(2,R), Riemannian left-invariant metric"),
    Shipped(
        "ads3", "SL(2,R) with its Killing form: anti-de Sitter space in three dimensions", "sl2r"
    ),
    Shipped("ax_plus_b", "the group of maps x -> a x + b"),
    Shipped("bianchi_i", "Bianchi type I: translations", "bianchi"),
    Shipped("bianchi_ii", "Bianchi type II: Heisenberg algebra", "bianchi"),
    Shipped("bianchi_iii", "Bianchi type III: ax + b times a line", "bianchi"),
    Shipped("bianchi_iv", "Bianchi type IV", "bianchi"),
    Shipped("bianchi_v", "Bianchi type V: hyperbolic space", "bianchi"),
    Shipped("bianchi_vi_0", "Bianchi type VI_0: motions of the Minkowski plane", "bianchi"),
    Shipped("bianchi_vi_h", "Bianchi type VI_h, h = -a^2", "bianchi"),
    Shipped("bianchi_vii_0", "Bianchi type VII_0: motions of the Euclidean plane", "bianchi"),
    Shipped("bianchi_vii_h", "Bianchi type VII_h, h = a^2", "bianchi"),
    Shipped("bianchi_viii", "Bianchi type VIII: algebra of SL(2,R)", "bianchi"),
    Shipped("bianchi_ix", "Bianchi type IX: algebra of the rotations", "bianchi"),
    Shipped(
        "chaplygin_sleigh", "a sledge on a blade, which cannot slip sideways", "constrained_bodies"
    ),
    Shipped("rolling_disc", "an upright disc that rolls without slipping", "constrained_bodies"),
    Shipped("wheeled_robot", "a robot that drives and turns, never sideways", "constrained_bodies"),
    Shipped(
        "kustaanheimo_stiefel",
        "the map from four dimensions to three that makes Kepler an oscillator",
    ),
    Shipped("twisted_bar", "a crystal whose lattice turns steadily along z"),
    Shipped("screw_dislocation", "screw dislocation along z"),
    Shipped("screw_core", "screw dislocation with a smooth core", "screw_dislocation"),
    Shipped("edge_dislocation", "edge dislocation along z, Burgers vector along x"),
    Shipped(
        "edge_dislocation_elastic", "edge dislocation in elastic equilibrium", "edge_dislocation"
    ),
    Shipped("wedge_disclination", "wedge disclination, torsion-free multivalued frame"),
    Shipped(
        "wedge_disclination_periodic",
        "wedge disclination, single-valued frame",
        "wedge_disclination",
    ),
    Shipped("axial_torsion", "flat space with constant axial torsion"),
    Shipped("schwarzschild", "black hole, static diagonal tetrad"),
    Shipped("schwarzschild_isotropic", "black hole, isotropic Cartesian tetrad"),
    Shipped(
        "schwarzschild_cartesian",
        "black hole, spherical coordinates, tetrad that tends to Cartesian",
        "schwarzschild_tetrads",
    ),
    Shipped("schwarzschild_falling", "black hole, tetrad in free fall", "schwarzschild_tetrads"),
    Shipped("kerr", "rotating black hole, Carter tetrad"),
    Shipped("kerr_kinnersley", "rotating black hole, Kinnersley null tetrad"),
    Shipped("kerr_newman", "charged rotating black hole, Carter tetrad"),
    Shipped("taub_nut", "mass with a gravitational magnetic charge, static tetrad"),
    Shipped("pp_wave", "gravitational wave with flat fronts, unknown profile, null tetrad"),
    Shipped("frw", "expanding universe, unknown a(t), curvature k"),
    Shipped("frw_flat", "flat expanding universe, Cartesian tetrad", "frw"),
    Shipped("frw_closed", "closed universe, left-invariant tetrad", "teleparallel_cosmos"),
    Shipped("frw_open", "open universe, tetrad of flat space-time", "teleparallel_cosmos"),
    Shipped("torsion_bounce", "universe of dust with spin, which bounces by torsion"),
    Shipped("de_sitter", "de Sitter space, static patch"),
    Shipped("goedel", "Goedel's rotating universe"),
    Shipped("kerr_de_sitter_torsion", "rotating black hole with torsion, of Poincare gauge theory"),
)


# Charts of one metric with parameters. The first is regular in the largest region.
CHARTS: tuple[tuple[str, ...], ...] = (
    (
        "schwarzschild_falling",
        "schwarzschild",
        "schwarzschild_isotropic",
        "schwarzschild_cartesian",
    ),
    ("kerr", "kerr_kinnersley"),
)


def names() -> tuple[str, ...]:
    """Names of all shipped spaces, in the order of the registry; imports none of them.

    Examples
    --------
    >>> names()[0]
    'so3'
    """
    return tuple(one.name for one in SPACES)


def titles() -> dict[str, str]:
    """Name -> one-line title of each shipped space; imports none of them.

    Examples
    --------
    >>> titles()["kerr"]
    'rotating black hole, Carter tetrad'
    """
    return {one.name: one.title for one in SPACES}


def load(name: str | PathLike[str]) -> Space:
    """Space with this name, from a tetrad file, or typed as a line element or as one-forms.

    A path, or a text that ends in .toml, is a file. In a typed text the names after d are the
    coordinates, in their order; other names are real parameters, and f(r) is an unknown function.

    Raises
    ------
    UnknownNameError
        No space has this name; the message lists near ones.
    FileFormatError, ExpressionError, LimitError
        The file cannot be read; see `read_file`.
    MetricError, CoframeError
        The text is neither a line element nor a list of one-forms.

    Examples
    --------
    >>> load("dr^2 + r^2 dtheta^2").frame.metric[1, 1]
    r**2
    >>> load("heisenberg").frame.dimension
    3
    """
    if isinstance(name, PathLike) or (isinstance(name, str) and name.endswith(".toml")):
        return read_file(name)
    for one in SPACES:
        if isinstance(name, str) and one.name == name:
            module = import_module(f"geomtorsion.spaces.{one.module or one.name}")
            return _with_charts(replace(module.space(one.name), title=one.title))
    if isinstance(name, str) and is_typed(name):
        return typed_space(name)
    text = name.lower().replace("-", "_") if isinstance(name, str) else ""
    near = close_names(text, names(), most=5, cutoff=0.4)
    hint = f"Near: {', '.join(near)}." if near else "None is near."
    raise UnknownNameError(
        f"expected the name of a shipped space, got {shown(name)}. {hint} "
        "`geomtorsion spaces` (or geomtorsion.spaces.names()) lists all of them. Another "
        "space may be typed: '-dt^2 + dx^2', or one-forms 'dr, r dtheta'."
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

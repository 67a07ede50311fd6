"""spaces: the shipped frames, each in a file of its own, loaded by name or read from a file."""

from importlib import import_module
from typing import TYPE_CHECKING

from geomtorsion.spaces.checking import disagreements
from geomtorsion.spaces.registry import load, names, shipped_space, titles
from geomtorsion.spaces.space import KnownAnswer, Space
from geomtorsion.spaces.tetrad_files import read_file

if TYPE_CHECKING:
    from geomtorsion.spaces import first_motion
    from geomtorsion.spaces.identification import Identification, Identified, identify
    from geomtorsion.spaces.kerr_orbits import Frequencies, KerrOrbit, kerr_orbit, kerr_orbit_of
    from geomtorsion.spaces.kerr_plunges import KerrPlunge, kerr_plunge
    from geomtorsion.spaces.pair import Pair, pair_problems, refuse_unknown_functions, solve_pair

# Names imported on first use: loading a space needs no motions and no comparison.
_LATER = {
    "Pair": "pair", "pair_problems": "pair", "refuse_unknown_functions": "pair",
    "solve_pair": "pair", "Identification": "identification", "Identified": "identification",
    "identify": "identification", "Frequencies": "kerr_orbits", "KerrOrbit": "kerr_orbits",
    "kerr_orbit": "kerr_orbits", "kerr_orbit_of": "kerr_orbits", "KerrPlunge": "kerr_plunges",
    "kerr_plunge": "kerr_plunges",
}  # fmt: skip

__all__ = [
    "Frequencies",
    "Identification",
    "Identified",
    "KerrOrbit",
    "KerrPlunge",
    "KnownAnswer",
    "Pair",
    "Space",
    "disagreements",
    "first_motion",
    "identify",
    "kerr_orbit",
    "kerr_orbit_of",
    "kerr_plunge",
    "load",
    "names",
    "pair_problems",
    "read_file",
    "refuse_unknown_functions",
    "shipped_space",
    "solve_pair",
    "titles",
]


def __getattr__(name: str) -> object:
    """A public name, imported on first use."""
    if name == "first_motion":
        return import_module("geomtorsion.spaces.first_motion")
    if name not in _LATER:
        hint = ". Did you mean gt.spaces.names()?" if name in ("list", "all") else ""
        raise AttributeError(f"module 'geomtorsion.spaces' has no attribute {name!r}{hint}")
    return getattr(import_module(f"geomtorsion.spaces.{_LATER[name]}"), name)


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]

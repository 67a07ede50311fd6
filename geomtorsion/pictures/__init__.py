"""pictures: loops, curves and prices as matplotlib figures, for a user's own code.

Each function takes a result and returns a figure; `save` writes it. Reports and the pictures
of scenes are written by the command line and by the results of scenes.

Examples
--------
>>> import geomtorsion as gt
>>> frame = gt.spaces.load("so3").frame
>>> b = gt.burgers_vector(frame, gt.Loop.circle([0.3, 1, 0.2], 0.3))
>>> len(gt.pictures.draw_closure(b).axes) if gt.pictures.can_draw() else 2
2
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from geomtorsion.pictures.burgers_circuit import draw_burgers_circuit
    from geomtorsion.pictures.charges import draw_charge
    from geomtorsion.pictures.constraints import draw_constraints
    from geomtorsion.pictures.curve_files import curve_pictures
    from geomtorsion.pictures.degrees_of_freedom import draw_degrees_of_freedom
    from geomtorsion.pictures.development import draw_development
    from geomtorsion.pictures.end_maps import draw_ends
    from geomtorsion.pictures.fits import draw_fit
    from geomtorsion.pictures.gaps import draw_gap
    from geomtorsion.pictures.loops import draw_closure, draw_loop, draw_map
    from geomtorsion.pictures.measured import draw_circuits, draw_survey
    from geomtorsion.pictures.network import draw_dislocations, draw_lines, draw_network
    from geomtorsion.pictures.notebook_pictures import draw_plan
    from geomtorsion.pictures.orbits import draw_closed_orbit
    from geomtorsion.pictures.parallelogram import draw_parallelogram
    from geomtorsion.pictures.particles import draw_particles
    from geomtorsion.pictures.plane_crystals import draw_plane_crystal
    from geomtorsion.pictures.prices import draw_price
    from geomtorsion.pictures.report import write_report
    from geomtorsion.pictures.ringing import draw_ringing
    from geomtorsion.pictures.series import draw_series
    from geomtorsion.pictures.shadow import draw_shadow
    from geomtorsion.pictures.solar_system import draw_post_newtonian
    from geomtorsion.pictures.solutions import draw_solution
    from geomtorsion.pictures.stars import draw_stars
    from geomtorsion.pictures.stress import draw_stress
    from geomtorsion.pictures.style import can_draw, save
    from geomtorsion.pictures.tensors import draw_tensor

# Imported on first use: printing a formula needs neither loops nor motions.
_HOMES = {
    "can_draw": "style",
    "curve_pictures": "curve_files",
    "draw_burgers_circuit": "burgers_circuit",
    "draw_charge": "charges",
    "draw_circuits": "measured",
    "draw_closed_orbit": "orbits",
    "draw_closure": "loops",
    "draw_constraints": "constraints",
    "draw_degrees_of_freedom": "degrees_of_freedom",
    "draw_development": "development",
    "draw_dislocations": "network",
    "draw_ends": "end_maps",
    "draw_fit": "fits",
    "draw_gap": "gaps",
    "draw_lines": "network",
    "draw_loop": "loops",
    "draw_map": "loops",
    "draw_network": "network",
    "draw_parallelogram": "parallelogram",
    "draw_particles": "particles",
    "draw_plan": "notebook_pictures",
    "draw_plane_crystal": "plane_crystals",
    "draw_post_newtonian": "solar_system",
    "draw_price": "prices",
    "draw_ringing": "ringing",
    "draw_shadow": "shadow",
    "draw_solution": "solutions",
    "draw_stars": "stars",
    "draw_series": "series",
    "draw_stress": "stress",
    "draw_survey": "measured",
    "draw_tensor": "tensors",
    "save": "style",
    "write_report": "report",
}

__all__ = [
    "can_draw",
    "curve_pictures",
    "draw_burgers_circuit",
    "draw_charge",
    "draw_circuits",
    "draw_closed_orbit",
    "draw_closure",
    "draw_constraints",
    "draw_degrees_of_freedom",
    "draw_development",
    "draw_dislocations",
    "draw_ends",
    "draw_fit",
    "draw_gap",
    "draw_lines",
    "draw_loop",
    "draw_map",
    "draw_network",
    "draw_parallelogram",
    "draw_particles",
    "draw_plan",
    "draw_plane_crystal",
    "draw_post_newtonian",
    "draw_price",
    "draw_ringing",
    "draw_series",
    "draw_shadow",
    "draw_solution",
    "draw_stars",
    "draw_stress",
    "draw_survey",
    "draw_tensor",
    "save",
    "write_report",
]


def __getattr__(name: str) -> object:
    """A public name, imported on first use."""
    if name not in _HOMES:
        raise AttributeError(f"module 'geomtorsion.pictures' has no attribute {name!r}")
    return getattr(import_module(f"geomtorsion.pictures.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]

"""drawings: figures for the gallery, of examples that draw none themselves.

python examples/site/extensions/drawings.py 01_any_tetrad figure.png
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import geomtorsion as gt


def plan() -> Any:
    """The quantities that the Ricci tensor of a frame needs."""
    return gt.pictures.draw_plan(gt.spaces.load("schwarzschild").frame.plan("ricci"))


def paths(space: str, **options: Any) -> Any:
    """Autoparallel and geodesic of a space from one start."""
    pair = gt.spaces.solve_pair(gt.spaces.load(space), **options)
    return gt.pictures.curve_pictures(pair)["paths"][0](pair)


def closure() -> Any:
    """A circle of rotation angles, and its open image."""
    so3 = gt.spaces.load("so3").frame
    return gt.pictures.draw_closure(gt.burgers_vector(so3, gt.Loop.circle([0.3, 1.0, 0.2], 0.7)))


def pole() -> Any:
    """A geodesic that passes over the pole of the sphere."""
    start = {"start": [1.2, 0.0], "velocity": [-1.0, 0.05], "parameters": {"R": 1}, "t": 6.0}
    return paths("s2", **start)


def top() -> Any:
    """Body rates of a free top, from its action."""
    energy = "(u1**2 + 2*u2**2 + 3*u3**2)/2"
    equations = gt.equations_of_motion(gt.spaces.load("so3").frame, energy)
    start = {"phi1": 0, "phi2": 1, "phi3": 0, "u1": 0.1, "u2": 2, "u3": 0}
    return gt.pictures.draw_solution(gt.solve(gt.ODE.of(equations, start), 20.0))


def lines() -> Any:
    """A square dislocation loop in a periodic box."""
    corners, sides = [[1, 1, 2], [3, 1, 2], [3, 3, 2], [1, 3, 2]], [[0, 1], [1, 2], [2, 3], [3, 0]]
    box = gt.Box.of_bounds([0, 0, 0], [4, 4, 4])
    loop = gt.LineArrays(corners, sides, [[0, 0, 1]] * 4, box)
    return gt.pictures.draw_lines(gt.DislocationNetwork.of_arrays(loop))


def costs() -> Any:
    """What accuracy costs for a motion on SO(3)."""
    so3 = gt.spaces.load("so3").frame
    problem = gt.geodesic(so3, [0.3, 1.0, 0.2], [0.9, 0.4, 0.7])
    return gt.accuracy_cost(problem, t=10.0).plot()


def cosmology() -> Any:
    """The quantities that the torsion of an expanding universe needs."""
    return gt.pictures.draw_plan(gt.spaces.load("frw").frame.plan("torsion"))


def orbit() -> Any:
    """An orbit around a rotating black hole."""
    start = {"M": 1.0, "a": 0.5}
    kerr = gt.geodesic(
        gt.spaces.load("kerr").frame, [0, 8, 1.5, 0], [1.25, 0.05, 0.01, 0.05], parameters=start
    )
    return gt.pictures.draw_solution(gt.solve(kerr, 200.0))


def bound() -> Any:
    """A bound orbit around a rotating black hole, from its shape."""
    shape = gt.kerr_orbit(0.9, 6, 0.3, 0.5)
    return gt.pictures.draw_solution(gt.solve(shape.geodesic(), 300.0))


def fall() -> Any:
    """A body that falls towards a black hole on a geodesic."""
    hole = gt.spaces.load("schwarzschild").frame
    body = gt.geodesic(hole, [0, 10, 1.57, 0], [1.118, 0, 0, 0], parameters={"M": 1})
    return gt.pictures.draw_solution(gt.solve(body, 20.0))


DRAWINGS: dict[str, Callable[[], Any]] = {
    "01_any_tetrad": plan,
    "02_paper_so3": closure,
    "03_straightest_and_shortest": lambda: paths("r3xso3", t=4.0),
    "05_through_the_pole": pole,
    "10_action_principle": top,
    "11_euler_top": lambda: gt.scenes.load("dzhanibekov").run().plot(),
    "13_paper_equations": lambda: paths("so3", t=10.0, moments=[1, 2, 3]),
    "18_lines_between_atoms": lines,
    "19_how_sure_is_a_number": costs,
    "20_field_equations_of_a_tetrad": cosmology,
    "21_kerr_de_sitter_with_torsion": orbit,
    "22_which_path_does_a_body_take": fall,
    "23_orbits_of_kerr": bound,
    "24_constraints_are_torsion": lambda: paths("chaplygin_sleigh", t=6.0),
}

if __name__ == "__main__":
    name, file = sys.argv[1:]
    gt.pictures.save(DRAWINGS[name](), file)

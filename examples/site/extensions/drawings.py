"""drawings: figures for the gallery, of examples that draw none themselves.

python examples/site/extensions/drawings.py 01_any_tetrad figure.png

For the name of a shipped scene, its motion in space is drawn.
"""

from __future__ import annotations

import runpy
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

import geomtorsion as gt
from geomtorsion.pictures.scene_attitude import axes_picture
from geomtorsion.pictures.style import (
    SERIES,
    STROKES,
    captioned,
    legend,
    new_figure,
    quiet,
    space_box,
)
from geomtorsion.scenes.plotting import drawings
from geomtorsion.spaces.registry import embedding_of

# Figures of a scene that show the motion in space, the clearest first.
IN_SPACE = ("laws", "axis", "path", "cones", "attitude")
FINELY = np.linspace(0.0, 1.0, 801)


def plan() -> Any:
    """The quantities that the Ricci tensor of a frame needs."""
    return gt.pictures.draw_plan(gt.spaces.load("schwarzschild").frame.plan("ricci"))


def paths(space: str, figure: str = "paths", **options: Any) -> Any:
    """Autoparallel and geodesic of a space from one start."""
    pair = gt.spaces.solve_pair(gt.spaces.load(space), **options)
    return gt.pictures.curve_pictures(pair)[figure][0](pair)


def closure() -> Any:
    """A circle of rotation angles, and its open image."""
    so3 = gt.spaces.load("so3").frame
    return gt.pictures.draw_closure(gt.burgers_vector(so3, gt.Loop.circle([0.3, 1.0, 0.2], 0.7)))


def pole() -> Any:
    """A geodesic that passes over the pole of the sphere."""
    start = {"start": [1.2, 0.0], "velocity": [-1.0, 0.05], "parameters": {"R": 1}, "t": 6.0}
    return paths("s2", **start)


def top() -> Any:
    """The axes of a free top on the sphere of space, from its action."""
    energy = "(u1**2 + 2*u2**2 + 3*u3**2)/2"
    so3 = gt.spaces.load("so3").frame
    start = {"phi1": 0, "phi2": 1, "phi3": 0, "u1": 0.1, "u2": 2, "u3": 0}
    motion = gt.solve(gt.ODE.of(gt.equations_of_motion(so3, energy), start), FINELY * 8.0)
    angles = np.column_stack([motion[name] for name in ("phi1", "phi2", "phi3")])
    embedding = embedding_of(so3)
    assert embedding is not None
    return axes_picture(embedding.attitudes(angles, {}), "A free top, from its action")


def flip() -> Any:
    """Dzhanibekov's flip: the angular momentum seen from the body, the axis seen from space."""
    return chosen(gt.scenes.load("dzhanibekov").run())


def chosen(result: gt.scenes.SceneResult) -> Any:
    """The figure of a scene that shows its motion in space; lines over time as the last choice."""
    shown = drawings(result)
    name = next(name for name in (*IN_SPACE, "watched") if name in shown)
    return shown[name][0](result)


def lines() -> Any:
    """A square dislocation loop in a periodic box."""
    corners, sides = [[1, 1, 2], [3, 1, 2], [3, 3, 2], [1, 3, 2]], [[0, 1], [1, 2], [2, 3], [3, 0]]
    box = gt.Box.of_bounds([0, 0, 0], [4, 4, 4])
    loop = gt.LineArrays(corners, sides, [[0, 0, 1]] * 4, box)
    return gt.pictures.draw_lines(gt.DislocationNetwork.of_arrays(loop))


def costs() -> Any:
    """What digits and certainty cost for a motion on SO(3)."""
    problem = gt.geodesic("so3", [0.3, 1.0, 0.2], [0.9, 0.4, 0.7])
    return gt.price(problem, 10.0).plot()


def cosmology() -> Any:
    """The quantities that the torsion of an expanding universe needs."""
    return gt.pictures.draw_plan(gt.spaces.load("frw").frame.plan("torsion"))


def example(name: str) -> dict[str, Any]:
    """What the script of an example defines."""
    return runpy.run_path(str(Path(__file__).parents[2] / f"{name}.py"))


def stroke() -> Any:
    """The shapes of a swimmer on a stroke, and the way that it moves."""
    script = example("25_a_gait_is_a_loop")
    loop = gt.Loop.polygon(0.8 * script["SQUARE"][:-1])
    return gt.pictures.draw_development(script["swimmer"](), loop, parameters={"r": 2.0})


def influences() -> Any:
    """The effects on a missile, with the accuracy that decides which of them matter."""
    script = example("32_which_effects_matter")
    return script["missile"]().called_for(1e-2).plot()


def ellipses() -> Any:
    """Orbits around a center of force, one through a collision, solved as oscillations."""
    script = example("26_kepler_as_an_oscillator")
    figure = new_figure(5.6, 3.8)
    axes = figure.add_subplot()
    for series, e in zip(SERIES, (0.0, 0.5, 0.9, 1.0), strict=False):
        start = [1 - e, 0, 0] if e < 1 else [-2.0, 0, 0]
        speed = np.sqrt((1 + e) / (1 - e)) if e < 1 else 0.0
        problem = script["oscillator"](start, [0, speed, 0])
        path = script["places"](gt.solve(problem, FINELY * 2 * np.pi))
        axes.plot(path[:, 0], path[:, 1], **series.line, label=f"$e$ = {e:g}")
    axes.plot(0, 0, "o", color="#222222")
    axes.set_xlabel("$x$")
    axes.set_ylabel("$y$")
    axes.set_aspect("equal")
    quiet(axes)
    legend(figure, axes)
    return figure


def orbit() -> Any:
    """An orbit around a rotating black hole."""
    values = {"M": 1.0, "a": 0.5}
    kerr = gt.geodesic(
        gt.spaces.load("kerr").frame, [0, 8, 1.5, 0], [1.25, 0.05, 0.01, 0.05], parameters=values
    )
    return around(gt.solve(kerr, FINELY * 400.0), 1 + np.sqrt(1 - values["a"] ** 2))


def bound() -> Any:
    """A bound orbit around a rotating black hole, from its shape."""
    shape = gt.spaces.kerr_orbit(0.9, 6, 0.3, 0.5)
    return around(gt.solve(shape.geodesic(), FINELY * 350.0), 1 + np.sqrt(1 - 0.9**2))


def around(orbit: gt.ode.Solution, horizon: float) -> Any:
    """An orbit in coordinates t, r, theta, phi around a black hole, as a curve in space."""
    _, r, theta, phi = np.asarray(orbit.coordinates, float).T
    across = r * np.sin(theta)
    path = np.column_stack([across * np.cos(phi), across * np.sin(phi), r * np.cos(theta)])
    figure = new_figure(5.6, 5.2)
    axes: Any = figure.add_subplot(projection="3d")
    axes.plot(*path.T, **SERIES[0].line)
    up, turn = np.mgrid[0 : np.pi : 25j, 0 : 2 * np.pi : 49j]
    ball = np.array([np.sin(up) * np.cos(turn), np.sin(up) * np.sin(turn), np.cos(up)])
    axes.plot_surface(*(horizon * ball), color="#222222", linewidth=0)
    size = np.abs(path).max()
    space_box(axes, ["$x$", "$y$", "$z$"], np.full(3, -size), np.full(3, size))
    axes.set_box_aspect((1, 1, 1))
    captioned(figure, ["Lengths in units of the mass; black: the horizon."])
    return figure


def fall() -> Any:
    """A body at rest above a black hole: it falls on a geodesic and hovers on an autoparallel."""
    hole = gt.spaces.load("schwarzschild").frame
    rest = {"start": [0, 10, 1.57, 0], "velocity": [1.118, 0, 0, 0], "parameters": {"M": 1}}
    figure = new_figure(5.6, 4.2)
    axes = figure.add_subplot()
    straight, shortest = gt.autoparallel(gt.cartan(hole), **rest), gt.geodesic(hole, **rest)
    curves = {"autoparallel": straight, "geodesic": shortest}
    for name, problem in curves.items():
        motion = gt.solve(problem, FINELY * 30.0)
        axes.plot(motion.times, motion.coordinates[:, 1], **STROKES[name].line, label=name)
    axes.set_xlabel("proper time / $M$")
    axes.set_ylabel("radius / $M$")
    axes.set_ylim(0, 11)
    quiet(axes)
    legend(figure, axes)
    return figure


def massive() -> Any:
    """The potential of a charge, if the vector field has no mass, and if it has one."""
    figure = new_figure(5.6, 4.2)
    axes = figure.add_subplot()
    radius = np.linspace(0.1, 5.0, 200)
    for series, mass in zip(SERIES, (0.0, 0.5, 1.0), strict=False):
        axes.plot(radius, np.exp(-mass * radius) / radius, **series.line, label=f"m = {mass:g}")
    axes.set_xlabel("radius")
    axes.set_ylabel("potential of a unit charge")
    axes.set_ylim(0, 3)
    quiet(axes)
    legend(figure, axes)
    return figure


def isotropic() -> Any:
    """The map between two charts of a black hole: numbers on its closed form."""
    one, two = (
        gt.spaces.load(name).frame.subs({"M": 1})
        for name in ("schwarzschild", "schwarzschild_isotropic")
    )
    result = gt.same_geometry(one, two)
    assert result.match is not None
    start = {str(q): float(value) for q, value in result.match.start.items()}
    radii = np.array([2.3, 3.0, 4.0, 6.0, 8.0, 10.0])
    images = [result.map({**start, "r": float(r)}) for r in radii]
    figure = new_figure(5.6, 4.2)
    axes = figure.add_subplot()
    every = np.linspace(2.0, 10.0, 200)
    exact = (every - 1 + np.sqrt(every**2 - 2 * every)) / 2
    axes.plot(every, exact, **SERIES[0].line, label="closed form")
    rho = [np.linalg.norm([image[q] for q in "xyz"]) for image in images]
    axes.plot(radii, rho, "o", color="#222222", label="map of the coordinates")
    axes.set_xlabel("Schwarzschild's radius / $M$")
    axes.set_ylabel("isotropic radius / $M$")
    quiet(axes)
    legend(figure, axes)
    return figure


def universes() -> Any:
    """The size of universes: dust, dust with a cosmological constant, a quadratic f(T)."""
    script = example("28_from_a_lagrangian_to_a_universe")
    riemannian, parallel = gt.levi_civita(script["COSMOS"]), gt.cartan(script["COSMOS"])
    theories = {
        "dust": (riemannian, "R/2", {}),
        r"dust and $\Lambda$": (riemannian, "R/2 - Lambda", {"Lambda": 2}),
        "$T + T^2/20$": (parallel, "-(T + T**2/20)/2", {}),
    }
    figure = new_figure(5.6, 4.2)
    axes = figure.add_subplot()
    start, near = {"a": 1, "rho": 3}, {"a_1": 1}
    for series, (label, (connection, text, values)) in zip(SERIES, theories.items(), strict=False):
        theory = gt.gravity.equations(connection, text, script["DUST"])
        motion = gt.gravity.solve(theory, "t", FINELY * 1.5, start, values, near=near)
        axes.plot(motion.times, motion["a"], **series.line, label=label)
    axes.set_xlabel("$t$")
    axes.set_ylabel("$a$", rotation=0)
    quiet(axes)
    legend(figure, axes)
    return figure


def motions() -> Any:
    """The flows of the three symmetries of the hyperbolic half plane."""
    half = gt.Frame("x y", [["1/y", "0"], ["0", "1/y"]], domain="y > 0")
    x, y = np.meshgrid(np.linspace(-2, 2, 41), np.linspace(0.1, 3.1, 31))
    figure = new_figure(8.4, 3.0)
    panels = figure.subplots(1, 3, sharey=True)
    for axes, xi, ink in zip(panels, gt.symmetries(half).closed_form, SERIES, strict=False):
        values = xi.at({"x": x, "y": y})
        axes.streamplot(x, y, values[..., 0], values[..., 1], color=ink.line["color"], density=0.7)
        axes.set_title(rf"$\xi = ({sp.latex(xi[0])},\ {sp.latex(xi[1])})$")
        axes.set_xlabel("$x$")
        axes.set_aspect("equal")
        quiet(axes)
    panels[0].set_ylabel("$y$")
    return figure


def stars() -> Any:
    """Masses and radii of polytropes: a dot for the published star."""
    script = example("29_mass_and_radius_of_stars")
    pairs = np.array(script["curve"](list(np.geomspace(3e-4, 2e-2, 25))))
    figure = new_figure(5.6, 4.2)
    axes = figure.add_subplot()
    axes.plot(pairs[:, 1], pairs[:, 0], **SERIES[0].line)
    axes.plot(9.586, 1.400, "o", color=SERIES[1].color)
    axes.set_xlabel("radius")
    axes.set_ylabel("mass")
    quiet(axes)
    captioned(figure, ["Units with G = c = 1 and K = 100; dot: published (Font et al. 2002)."])
    return figure


def boson_stars() -> Any:
    """The fields of two boson stars, which vanish at infinity."""
    script = example("35_a_star_that_ends_nowhere")
    reduced = script["star"]()
    figure = new_figure(5.6, 4.2)
    axes = figure.add_subplot()
    for series, centre in zip(SERIES, (0.271, 0.15), strict=False):
        solution = script["shot"](reduced, centre).solution
        mass = float(solution["M"][-1])
        field = solution["phi"] / np.sqrt(2)
        axes.plot(solution["r"], field, **series.line, label=f"mass {mass:.3f}")
    axes.set_xlabel("radius")
    axes.set_ylabel(r"$\sqrt{4\pi G}\,\varphi$")
    axes.set_xlim(0, 15)
    quiet(axes)
    legend(figure, axes)
    return figure


DRAWINGS: dict[str, Callable[[], Any]] = {
    "01_any_tetrad": plan,
    "02_paper_so3": closure,
    "03_straightest_and_shortest": lambda: paths("r3xso3", t=4.0),
    "05_through_the_pole": pole,
    "10_action_principle": top,
    "11_euler_top": flip,
    "13_paper_equations": lambda: paths("so3", "attitude", t=10.0, moments=[1, 2, 3]),
    "18_lines_between_atoms": lines,
    "19_how_sure_is_a_number": costs,
    "20_field_equations_of_a_tetrad": cosmology,
    "21_kerr_de_sitter_with_torsion": orbit,
    "22_which_path_does_a_body_take": fall,
    "23_orbits_of_kerr": bound,
    "31_is_it_a_new_solution": isotropic,
    "24_constraints_are_torsion": lambda: paths("chaplygin_sleigh", t=6.0),
    "25_a_gait_is_a_loop": stroke,
    "26_kepler_as_an_oscillator": ellipses,
    "33_parameters_from_data": lambda: example("33_parameters_from_data")["mass_and_spin"](
        1
    ).plot(),
    "27_theories_of_your_own": massive,
    "32_which_effects_matter": influences,
    "30_symmetries_and_holonomy": motions,
    "28_from_a_lagrangian_to_a_universe": universes,
    "29_mass_and_radius_of_stars": stars,
    "35_a_star_that_ends_nowhere": boson_stars,
}

if __name__ == "__main__":
    name, file = sys.argv[1:]
    drawn = DRAWINGS[name]() if name in DRAWINGS else chosen(gt.scenes.load(name).run())
    gt.pictures.save(drawn, file)

"""Solutions, Burgers vectors and plans in a notebook: text, and a figure with matplotlib."""

from __future__ import annotations

import pickle
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.pictures import style

pytest.importorskip("matplotlib")

SO3 = gt.spaces.load("so3").frame
START, VELOCITY = [0.3, 1.0, 0.2], [0.1, 0.5, -0.2]


def parts(one: object) -> tuple[str, str]:
    """Text and figure of an object's HTML."""
    html = one._repr_html_()  # type: ignore[attr-defined]
    ElementTree.fromstring(f"<div>{html}</div>")
    assert html.count("<svg") == 1
    return html[: html.index("<svg")], html[html.index("<svg") :]


def test_a_solved_curve_is_drawn():
    """The text gives the error; equal calls give equal figures."""
    solution = gt.solve(gt.autoparallel(gt.cartan(SO3), START, VELOCITY), t=5.0)
    text, picture = parts(solution)
    assert "error below" in text
    assert parts(solution)[1] == picture


def test_lines_are_the_solution():
    """The drawn values are the solution at the drawn times."""
    swing = gt.solve(gt.ODE.of({"x": "v", "v": "-x"}, [1, 0]), 10.0)
    figure = gt.pictures.draw_solution(swing)
    for axes, function in zip(figure.axes, (np.cos, lambda t: -np.sin(t)), strict=True):
        times, values = (np.asarray(x) for x in axes.lines[0].get_data())
        assert (times[0], times[-1]) == (0.0, 10.0)
        assert values == pytest.approx(function(times), abs=1e-8)


def test_a_space_with_a_coordinate_t_is_drawn():
    """The coordinate t is one of the lines, although the curve parameter is also called t."""
    hole = gt.spaces.load("schwarzschild").frame
    fall = gt.geodesic(hole, [0, 10, 1.57, 0], [1.2, 0, 0, 0], parameters={"M": 1})
    solution = gt.solve(fall, 10.0)
    axes = gt.pictures.draw_solution(solution).axes[0]
    times, values = (np.asarray(x) for x in axes.lines[0].get_data())
    assert values[-1] == pytest.approx(solution.at(times[-1]).coordinates[0])


def test_angles_do_not_jump():
    """An angle beyond a full turn is drawn continuously, without a line across the figure."""
    problem = gt.autoparallel(gt.cartan(SO3), START, VELOCITY)
    figure = gt.pictures.draw_solution(gt.solve(problem, 20.0))
    for axes in figure.axes:
        values = np.asarray(axes.lines[0].get_ydata())
        assert np.abs(np.diff(values)).max() < 0.5


def test_the_path_of_a_curve_in_two_coordinates():
    """On a sphere the path is drawn beside the coordinates."""
    sphere = gt.spaces.load("s2").frame
    problem = gt.geodesic(sphere, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
    solution = gt.solve(problem, 2.0)
    figure = gt.pictures.draw_solution(solution)
    assert [axes.get_ylabel() for axes in figure.axes] == [r"$\phi$", r"$\theta$", r"$\phi$"]
    path = np.asarray(figure.axes[0].lines[0].get_data())
    assert path[:, -1] == pytest.approx(solution.coordinates[-1], abs=1e-12)


def test_ensembles_are_drawn():
    """Each motion has a line; motions with only an end time have a text with the reason."""
    decay = gt.ODE.of({"x": "-k*x"}, [1], parameters={"k": 1})
    many = gt.solve_many(decay, {"k": np.array([1.0, 2.0])}, [0.5, 1.0])
    assert len(gt.pictures.draw_solution(many).axes[0].lines) == 2
    assert "2 of 2 motions" in parts(many)[0]
    ends = gt.solve_many(decay, {"k": np.array([1.0, 2.0])}, 1.0)
    assert "at two or more times, got 1" in ends._repr_html_()


def test_a_burgers_vector_is_its_loop_and_its_image():
    """Components, error and check are text; loop, image and gap are a figure."""
    b = gt.burgers_vector(SO3, gt.Loop.circle(START, 0.3))
    text, picture = parts(b)
    for value in b.vector.tolist():
        assert f"{value:.12g}" in text
    assert b.check.text in text
    assert len(picture) > 5000


def test_maps_are_drawn():
    """A map of Burgers vectors on a grid has a text and a figure."""
    grid = gt.burgers_map(SO3, [[0.2, 0.3, 0.4], [1.0, 1.1, 1.2]])
    assert "BurgersMap(4 of 4 loops" in parts(grid)[0]


def test_plans_are_drawn():
    """Each quantity is drawn once, below its inputs; the table is below the figure."""
    plan = gt.spaces.load("kerr").frame.plan("einstein")
    text, picture = parts(plan)
    assert "plan of einstein" in text
    assert "<td>christoffel</td>" in picture
    figure = gt.pictures.draw_plan(plan)
    places = {t.get_text(): t.get_position()[1] for t in figure.axes[0].texts}
    assert len([name for name in places if name in plan.graph]) == len(plan.graph)
    assert all(places[one] > places[two] for one, two in plan.graph.edges)


def test_scenes_are_drawn():
    """A result and its plan each have a text and a figure."""
    scene = gt.scenes.load("lagrange_cusp")
    assert "error below" in parts(scene.run())[0]
    assert "omitted" in parts(scene.selection)[0]


def test_without_the_extra_there_is_text(monkeypatch):
    """The text is present, and a line below it gives the reason for the missing figure."""

    def missing(_: float, __: float) -> None:
        raise gt.errors.MissingExtraError("pictures need matplotlib")

    monkeypatch.setattr("geomtorsion.pictures.loops.new_figure", missing)
    html = gt.burgers_vector(SO3, gt.Loop.circle(START, 0.3))._repr_html_()
    assert "b1 = " in html
    assert "<p>pictures need matplotlib</p>" in html
    assert "<svg" not in html


def test_texts_are_escaped():
    """Text is escaped; names of states never become markup."""
    assert style.pictured("<b>", lambda: style.new_figure(1, 1)).startswith(
        "<div><pre>&lt;b&gt;</pre><div><svg"
    )
    motion = gt.ODE.of({"x": "-x"}, [1], outputs={"half": "x/2"})
    assert "<script" not in gt.solve(motion, 1.0)._repr_html_()


def test_a_plot_is_shown_in_a_notebook_without_pyplot():
    """IPython gets a figure as PNG, also where nobody has loaded matplotlib.pyplot."""
    formatters = pytest.importorskip("IPython.core.formatters")
    figure = gt.gravity.perturbed.spectrum("R", "riemannian").plot()
    shown, _ = formatters.DisplayFormatter().format(figure, include={"image/png"})
    assert shown["image/png"].startswith(b"\x89PNG")
    assert pickle.loads(pickle.dumps(figure)).axes

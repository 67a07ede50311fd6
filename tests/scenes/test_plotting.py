"""Albums: figures that fit the watched quantities, and the files of a run."""

import json

import numpy as np
import pytest
from matplotlib.image import imread
from matplotlib.text import Annotation

from geomtorsion.errors import SceneError, UnknownNameError
from geomtorsion.scenes import Body, Scene, SceneResult, State, load
from geomtorsion.scenes.plotting import drawings, finely, plot
from geomtorsion.scenes.saving import write_run
from tests.rounding import ROUNDED

pytest.importorskip("matplotlib")

ALBUMS = {
    "lagrange_cusp": ["watched", "axis", "trust", "plan"],
    "dzhanibekov": ["watched", "attitude", "cones", "rolling", "trust", "plan"],
    "thrown_body": ["watched", "attitude", "cones", "rolling", "path", "trust", "plan"],
    "helix": ["watched", "attitude", "path", "laws", "trust", "plan"],
    "naive_top": ["watched", "attitude", "laws", "trust", "plan"],
}


# The figures of the other two scenes occur among these.
@pytest.mark.parametrize(
    "name",
    [pytest.param(x, marks=pytest.mark.slow) if x in ("dzhanibekov", "naive_top") else x
     for x in ALBUMS],
)  # fmt: skip
def test_drawings_fit_the_scene(name):
    """Each figure can be drawn, and its text states the accuracy of the numbers."""
    result = load(name).with_values(samples=41).run()
    pictures = drawings(result)
    assert list(pictures) == ALBUMS[name]
    for key, (draw, about) in pictures.items():
        figure = draw(result)
        assert figure.axes, key
        assert about.endswith(".")
        said = "\n".join(text.get_text() for text in figure.texts)
        assert key == "plan" or "error below" in said


def test_a_figure_by_its_name():
    """The attitude: tips on the unit sphere, and each axis from the centre to both ends."""
    start = State(omega=[0.01, 3, 0], euler=(0, 0.3, 0))
    scene = Scene(Body(1.0, moments=(1, 2, 3)), (), start, t=2.0, samples=9, watch=("matrix",))
    result = scene.run()
    (axes,) = result.plot(figure="attitude").axes
    lines = [np.array(line.get_data_3d()).T for line in axes.lines]  # pyright: ignore[reportAttributeAccessIssue]
    spokes = [line for line in lines if len(line) == 2 and not line[0].any()]
    matrices = result["matrix"].reshape(-1, 3, 3)
    expected = [matrices[m][:, k] for k in range(3) for m in (0, -1)]
    assert np.abs(np.array([spoke[1] for spoke in spokes]) - expected).max() < 1e-9
    assert len(result.plot(figure="watched").axes) == len(result.plot().axes)


@pytest.mark.parametrize("name", ["atitude", "path", 3])
def test_a_figure_that_the_outputs_do_not_have(name):
    """The message lists the figures that there are."""
    result = load("dzhanibekov").with_values(samples=5, t=1.0).run()
    with pytest.raises(UnknownNameError, match="There are watched, attitude, cones"):
        result.plot(figure=name)


def test_the_right_law_is_drawn_beside_the_naive_one():
    """Momentum in space changes under the naive law only; energy under neither."""
    result = load("naive_top").with_values(samples=41).run()
    figure = drawings(result)["laws"][0](result)
    energy, momentum = figure.axes
    change = {line.get_label(): np.max(np.asarray(line.get_ydata())) for line in momentum.lines}
    assert change["naive"] > 0.5
    assert change["right"] < 1e-11
    assert max(np.max(np.asarray(line.get_ydata())) for line in energy.lines) < 1e-11


def test_curves_are_smooth_between_the_samples():
    """Figures have more points than the table, at the same times for all quantities."""
    result = load("lagrange_loop").with_values(samples=21).run()
    times, axis, nutation = finely(result, "axis", "nutation")
    assert len(times) == len(axis) == len(nutation) > 1000
    assert np.abs(np.arccos(axis[:, 2]) - nutation).max() < 1e-12
    assert finely(result, "position")[1] is None


@pytest.mark.parametrize(("turns", "smooth"), [(44, True), (46, False)])
def test_how_many_turns_are_smooth(turns, smooth):
    """Up to 45 turns straight pieces leave their circle by less than a hundredth of its radius."""
    spin = State(omega=[0, 2 * np.pi, 0], euler=(0, 0, 0))
    result = Scene(
        Body(1.0, moments=(1, 2, 3)), (), spin, t=turns, samples=5, watch=("axis",)
    ).run()
    axis = finely(result, "axis")[1]
    middles = np.linalg.norm(axis[1:] + axis[:-1], axis=1) / 2
    assert (1 - middles.min() < 0.01) == smooth


def test_drifts_over_time_agree_with_the_result():
    """The largest drift over time is the drift of the result, also across switches."""
    for name in ("lagrange_cusp", "missile", "euler_top"):
        result = load(name).run()
        drifts = result.changes()
        assert drifts.keys() == result.drift.keys()
        for key, values in drifts.items():
            assert values.shape == result.times.shape
            assert values.max() == pytest.approx(result.drift[key], rel=1e-6, abs=ROUNDED)


def test_everything_about_a_run_in_one_place(tmp_path):
    """A result from its own file has no scene, and can be drawn but not written again."""
    result = load("sleeping_top").with_values(samples=21).run()
    steps: list[str] = []
    written = write_run(result, tmp_path, "svg", steps.append)
    assert [path.name for path in written[:4]] == [
        "table.csv", "result.npz", "run.json", "scene.toml",
    ]  # fmt: skip
    assert steps == [f"drawing {name}" for name in drawings(result)]
    facts = json.loads((tmp_path / "run.json").read_text("utf-8"))
    assert facts["pictures"] == [f"{name}.svg" for name in drawings(result)]
    loaded = SceneResult.load(tmp_path / "result.npz")
    assert list(drawings(loaded)) == ["watched", "axis"]
    assert plot(loaded, tmp_path / "again.png").axes
    with pytest.raises(SceneError, match="expected a result with its scene"):
        write_run(loaded, tmp_path)


def test_pictures_are_not_large(tmp_path):
    """Each figure is below 250 kB and wider than 600 points."""
    for path in write_run(load("free_symmetric_top").run(), tmp_path):
        assert path.stat().st_size < 250_000, path.name
        if path.suffix == ".png":
            assert imread(path).shape[1] > 600, path.name


@pytest.mark.parametrize(("tilt", "shown"), [(0.3e-6, False), (0.7e-6, True)])
def test_cones_of_what_turns(tilt, shown):
    """An angular velocity that changes its direction by less than 1e-6 draws no cones."""
    body, start = Body(moments=(1, 1, 2)), State(omega=(tilt, 0, 1))
    assert ("cones" in drawings(Scene(body, (), start, ["omega"], t=10).run())) == shown


def test_a_plan_has_an_arrow_from_each_watched_quantity() -> None:
    """An output that an omitted state gives has its arrow to the state that contains it."""
    axes = load("lagrange_cusp").run().plot(figure="plan").axes[0]
    places = {text.get_text(): text.get_position() for text in axes.texts if text.get_text()}
    starts = {round(a.xyann[1], 6) for a in axes.texts if isinstance(a, Annotation)}
    for name in ("nutation", "axis", "energy"):
        assert round(places[name][1], 6) in starts

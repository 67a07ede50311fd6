"""Figures of scenes, drawn from plain arrays: panels, curves, texts and animations."""

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError, MissingExtraError
from geomtorsion.pictures.scene_attitude import (
    axes_picture,
    axis_picture,
    cones_picture,
    path_picture,
    polhodes,
)
from geomtorsion.pictures.scene_film import block_sides, write_film
from geomtorsion.pictures.scene_over_time import (
    change_picture,
    sweep_picture,
    trust_picture,
    watched_picture,
)
from geomtorsion.pictures.scene_plan import plan_picture
from geomtorsion.pictures.style import save

pytest.importorskip("matplotlib")

TIMES = np.linspace(0, 3, 61)
COS, SIN, NIL = np.cos(TIMES), np.sin(TIMES), np.zeros_like(TIMES)
TURN = np.stack([[COS, -SIN, NIL], [SIN, COS, NIL], [NIL, NIL, NIL + 1]]).transpose(2, 0, 1)
TIPS = np.stack([0.5 * COS, 0.5 * SIN, NIL + np.sqrt(0.75)], axis=1)


def words(figure) -> str:
    """All text of a figure."""
    found = [text.get_text() for text in figure.texts]
    for axes in figure.axes:
        found += [axes.get_title(loc="left"), axes.get_title(), axes.get_xlabel()]
        found += [text.get_text() for text in axes.texts]
        found += list(axes.get_legend_handles_labels()[1])
    return "\n".join(found)


def test_watched_quantities_have_a_panel_each():
    """Each quantity has a panel; a constant is named, and the unit is on the axis."""
    watched = {"omega": TIPS, "energy": NIL + 2.5, "nutation": COS, "matrix": TURN}
    figure = watched_picture(
        TIMES, watched, {"energy": "J"}, {"omega": "xyz"}, {"nutation": "tilt"}, "A top", ["a note"]
    )
    assert len(figure.axes) == 4
    assert [len(axes.lines) for axes in figure.axes] == [3, 1, 1, 9]
    assert figure.axes[1].get_ylabel() == "J"
    assert "constant: 2.5" in words(figure)
    assert "tilt" in words(figure)
    assert figure.axes[0].get_legend_handles_labels()[1] == ["x", "y", "z"]
    assert "a note" in words(figure)


def test_the_tip_of_the_axis_with_its_limits():
    """The unrolled curve has the angles of the data; a long motion shows only its first turns."""
    figure = axis_picture(TIMES, TIPS)
    phi, theta = np.asarray(figure.axes[1].lines[0].get_xydata()).T
    assert theta == pytest.approx(30.0)
    assert phi[-1] == pytest.approx(np.degrees(3))
    many = np.stack([COS, SIN, NIL], axis=1)[np.arange(400) % 61]
    turning = np.linspace(0, 60, 400)
    many = np.stack([np.cos(turning), np.sin(turning), 0 * turning], axis=1)
    assert "the first 3 turns" in words(axis_picture(turning, many, limits=(1.0, 2.0)))
    assert "axis 2 of the body" in words(axes_picture(TURN))


@pytest.mark.parametrize("inertia", [(1, 2, 3), (3, 1, 2), (1, 1, 2), (2, 1, 1)])
def test_polhodes_are_on_sphere_and_ellipsoid(inertia):
    """Each curve satisfies both equations, for each order of the moments."""
    weights = 1 / np.array(inertia, dtype=float)
    for share in (0.1, 0.5, 0.9):
        value = weights.min() + share * np.ptp(weights)
        for ring, special in polhodes(inertia, value):
            assert np.linalg.norm(ring, axis=1) == pytest.approx(1, abs=1e-12)
            assert ring**2 @ weights == pytest.approx(value, abs=1e-12)
            assert not special or value == np.median(weights)
    assert polhodes((1, 2, 3), 0.5)[0][1], "the middle value is the separatrix"


def test_cones_with_and_without_attitude():
    """One panel without the attitude, two with it; a sphere is drawn without polhodes."""
    assert len(cones_picture((1, 2, 3), TIPS).axes) == 1
    figure = cones_picture((1, 1, 1), TIPS, TURN, "free")
    assert len(figure.axes) == 2
    assert "angular velocity" in words(figure)


def test_paths_in_plane_and_space():
    """A constant coordinate has no axis."""
    flat = np.stack([TIMES, NIL, TIMES**2], axis=1)
    figure = path_picture({"flight": flat}, TURN)
    assert figure.axes[0].get_xlabel() == "$x$ / m"
    assert figure.axes[0].get_ylabel() == "$z$ / m"
    helix = np.stack([COS, SIN, TIMES], axis=1)
    figure = path_picture({"helix": helix, "line": helix + TIMES[:, None]})
    assert figure.axes[0].name == "3d"
    assert "helix" in words(figure)
    assert path_picture({"still": np.zeros((5, 3))}, TURN).axes


def test_trust_and_change():
    """A drift that is exactly zero is named, not drawn; two laws have two lines."""
    figure = trust_picture(TIMES, {"energy": NIL, "momentum": 1e-15 * TIMES}, 1e-12, 1e-10)
    assert "drift of energy: exactly zero" in words(figure)
    drawn = [line for line in figure.axes[0].lines if len(np.asarray(line.get_xdata())) > 2]
    assert [line.get_label() for line in drawn] == ["drift of momentum"]
    figure = change_picture(TIMES, {"energy": {"right": NIL + 1, "naive": 1 + TIMES}})
    assert figure.axes[0].lines[1].get_ydata() == pytest.approx(TIMES)
    assert trust_picture(TIMES, {}, 0.0, 1e-10, errors=NIL).axes


def test_plans_and_sweeps():
    """A plan has boxes and reasons; a sweep has points and curve, a second variation a field."""
    figure = plan_picture(
        {"watched": ["energy"], "states": ["Omega", "q"]}, [("energy", "Omega")], {"q": "unused"}
    )
    assert "Omitted: q: unused" in words(figure)
    tilts = np.logspace(-6, -1, 6)
    figure = sweep_picture(
        [("tilt", tilts)], ("period", -np.log(tilts)), ("elliptic", tilts, -np.log(tilts))
    )
    assert figure.axes[0].get_xscale() == "log"
    assert "elliptic" in words(figure)
    field = sweep_picture([("a", tilts), ("b", [1.0, 2.0])], ("c", np.outer(tilts, [1, 2])))
    assert len(field.axes) == 2


def test_a_failing_animation_raises_its_error(tmp_path, monkeypatch):
    """The error of the first frame, or Ctrl-C, is raised unchanged, and no file remains."""
    for reason in (KeyboardInterrupt(), RuntimeError("no memory")):

        def fail(*_, reason=reason, **__):
            raise reason

        with monkeypatch.context() as patch:
            patch.setattr("matplotlib.animation.PillowWriter.grab_frame", fail)
            with pytest.raises(type(reason)) as told:
                write_film(tmp_path / "top.gif", TIMES, TURN)
        assert told.value is reason
    assert list(tmp_path.iterdir()) == []


def test_animations(tmp_path, monkeypatch):
    """A GIF has its frames; sides of a block follow from the moments; other types are refused."""
    from PIL import Image, ImageSequence

    sides = block_sides([13.0, 10.0, 5.0])
    assert sides == pytest.approx(np.array([1, 2, 3]) / 3)
    target = tmp_path / "top.gif"
    seen: list[float] = []
    frames = write_film(target, TIMES, TURN, TIPS, sides, 0.2, "t", seen.append)
    with Image.open(target) as film:
        count = sum(1 for _ in ImageSequence.Iterator(film))
    assert count == frames == 5
    assert seen[-1] == 1.0
    assert [path.name for path in tmp_path.iterdir()] == ["top.gif"]
    with pytest.raises(FileFormatError, match=r"expected the name of a \.gif or \.mp4 file"):
        write_film(tmp_path / "top.avi", TIMES, TURN)
    from matplotlib.animation import FFMpegWriter

    monkeypatch.setattr(FFMpegWriter, "isAvailable", lambda: False)
    with pytest.raises(MissingExtraError, match="ffmpeg"):
        write_film(tmp_path / "top.mp4", TIMES, TURN)


def test_an_animation_of_a_cylinder_reads_no_unset_memory(tmp_path, monkeypatch):
    """Faces with 32 and with 4 corners share an array; unset entries would raise a warning."""
    pytest.importorskip("matplotlib")
    unset = np.empty

    def filled(shape, *arguments, **more):
        made = unset(shape, *arguments, **more)
        if made.dtype == float:
            made.fill(-1.7e308)
        return made

    monkeypatch.setattr(np, "empty", filled)
    film = tmp_path / "disc.gif"
    assert write_film(film, [0, 1], [np.eye(3)] * 2, sides=(1, 1, 0.3)) == 2
    assert film.stat().st_size > 0


def test_figures_can_be_saved(tmp_path):
    """A saved figure has more than 8 kB in each format."""
    for form in ("png", "svg", "pdf"):
        path = tmp_path / f"axis.{form}"
        save(axis_picture(TIMES, TIPS, title="Top"), path)
        assert path.stat().st_size > 8000


@pytest.mark.parametrize(("change", "constant"), [(0.9e-8, True), (1.1e-8, False)])
def test_small_changes_are_called_constant(change, constant):
    """A quantity that changes by less than 1e-8 of its size is called constant."""
    figure = watched_picture(TIMES, {"energy": 2.5 * (1 + change * TIMES / TIMES[-1])})
    assert ("constant: 2.5" in words(figure)) is constant


@pytest.mark.parametrize(("change", "kept"), [(0.9e-8, True), (1.1e-8, False)])
def test_small_changes_are_called_kept(change, kept):
    """A quantity that changes by less than 1e-8 of its size is called kept."""
    figure = change_picture(TIMES, {"energy": {"right": 1 + change * TIMES / TIMES[-1]}})
    assert ("kept: changes below" in words(figure)) is kept


@pytest.mark.parametrize(("tilt", "title"), [(0.34, "from above"), (0.36, "unrolled")])
def test_an_upright_axis_is_seen_from_above(tilt, title):
    """Up to a tilt of 0.35 rad the tip is drawn from above, because its circle is small."""
    tips = np.stack([np.sin(tilt) * COS, np.sin(tilt) * SIN, NIL + np.cos(tilt)], axis=1)
    assert title in words(axis_picture(TIMES, tips))


@pytest.mark.parametrize(("wobble", "cones"), [(0.07, 2), (0.08, 1)])
def test_a_cone_is_drawn_where_the_angle_is_kept(wobble, cones):
    """The body's axis sweeps a cone if its angle from the angular momentum stays within 0.15."""
    angle = 0.5 + wobble * np.sin(4 * TIMES)
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.stack([[cosine, NIL, sine], [NIL, NIL + 1, NIL], [-sine, NIL, cosine]])
    turn = turn.transpose(2, 0, 1)
    # The angular momentum is vertical in space, so the angle of the axis is `angle` itself.
    omega = np.einsum("mji,j->mi", turn, [0.0, 0.0, 1.0])
    space = cones_picture([1, 1, 1], omega, turn).axes[1]
    rays = {line.get_color() for line in space.lines if line.get_linewidth() == 0.5}
    assert len(rays) == cones


@pytest.mark.parametrize(("ratio", "scale"), [(299, "linear"), (301, "log")])
def test_wide_ranges_are_logarithmic(ratio, scale):
    """An axis over more than a factor of 300 is logarithmic."""
    values = np.linspace(1, ratio, 5)
    assert sweep_picture([("spin", values)], ("tilt", values)).axes[0].get_xscale() == scale

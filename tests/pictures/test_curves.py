"""Figures of curves: the list for each space, their content, captions and labels."""

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError
from geomtorsion.ode import RungeKutta
from geomtorsion.pictures.curve_files import curve_pictures
from geomtorsion.pictures.curves import caption
from geomtorsion.pictures.sphere import parted, towards
from geomtorsion.pictures.style import SERIES, STROKES, mathematics, new_figure, number, save
from geomtorsion.spaces import load, names
from geomtorsion.spaces.first_motion import first_motion
from geomtorsion.spaces.pair import solve_pair

SHOWN = {
    "s2": ["paths", "coordinates", "distance", "quality"],
    "r3xso3": ["paths", "attitude", "coordinates", "distance", "quality"],
    "ax_plus_b": ["paths", "coordinates", "distance", "quality"],
    "goedel": ["coordinates", "distance", "quality"],
}


def pair_of(name, **options):
    """The default pair, solved at low cost."""
    return solve_pair(load(name), engine=RungeKutta(), accuracy=1e-6, samples=21, **options)


# ax_plus_b has the figures of s2.
@pytest.mark.parametrize(
    "name",
    ["s2", "r3xso3", *(pytest.param(x, marks=pytest.mark.slow) for x in ("ax_plus_b", "goedel"))],
)
def test_every_picture_is_written_and_shows_something(name, tmp_path):
    """Each figure contains enough dark pixels and more than ten colours."""
    pytest.importorskip("matplotlib")
    from matplotlib.image import imread

    pair = pair_of(name)
    assert list(curve_pictures(pair)) == SHOWN[name]
    for key, (draw, says) in curve_pictures(pair).items():
        assert says.endswith(".")
        save(draw(pair), tmp_path / f"{key}.png")
        pixels = imread(tmp_path / f"{key}.png")[::2, ::2, :3].reshape(-1, 3)
        assert len(np.unique((pixels * 15).round() @ [1, 16, 256])) > 10
        assert (pixels.min(axis=1) < 0.5).mean() > 0.002


def test_a_picture_is_the_same_each_time(tmp_path):
    """Two files of one figure have equal bytes, because they hold no date and no random name."""
    pytest.importorskip("matplotlib")
    pair = pair_of("ax_plus_b")
    for form in ("svg", "png"):
        files = [tmp_path / f"{k}.{form}" for k in (1, 2)]
        for file in files:
            save(curve_pictures(pair)["distance"][0](pair), file)
        assert files[0].read_bytes() == files[1].read_bytes()


def test_labels_do_not_overlap():
    """Legends, titles and captions of the figures of s2 do not overlap."""
    pytest.importorskip("matplotlib")
    pair = pair_of("s2")
    for draw, _ in curve_pictures(pair).values():
        figure = draw(pair)
        figure.draw_without_rendering()
        boxes = [text.get_window_extent() for text in figure.texts]
        boxes += [legend.get_window_extent() for legend in figure.legends]
        boxes += [axes.title.get_window_extent() for axes in figure.axes if axes.get_title()]
        for k, one in enumerate(boxes):
            assert not any(one.overlaps(other) for other in boxes[:k])
            assert figure.bbox.padded(2).fully_overlaps(one)


def test_lines_differ_without_colour():
    """Each line has its own dash pattern, so the lines differ without colour."""
    assert len({str(stroke.dashes) for stroke in STROKES.values()}) == len(STROKES)
    assert len({str(stroke.dashes) for stroke in SERIES}) == len(SERIES)


def test_the_caption_is_complete():
    """The caption gives start, velocity, parameters, accuracy and stops."""
    lines = " ".join(caption(pair_of("s2", start=[0.5, 0.0], velocity=[-0.2, 1.0], t=6)))
    lines = lines.replace("\xa0", " ")
    for part in ("θ = 0.5", "φ′ = 1", "R = 1", "1e−6 requested", "autoparallel stopped at t = 2.4"):
        assert part in lines


def test_angles_continue():
    """An azimuth of more than a full turn, solved in quaternions, has no jumps, as in the table."""
    pair = pair_of("so3", t=20)
    table = pair.columns()
    for curve, points in pair.coordinates.items():
        assert np.abs(np.diff(points, axis=0)).max() < np.pi
        assert np.ptp(points[:, 0]) > 2 * np.pi
        assert (table[f"{curve} phi1"] == points[:, 0]).all()


def test_equal_motions_are_shown_as_equal():
    """The figure of two equal motions states this, on an axis where rounding is not visible."""
    pytest.importorskip("matplotlib")
    pair = pair_of("so3")
    [axes] = curve_pictures(pair)["distance"][0](pair).axes
    assert "equal" in axes.get_title()
    assert axes.get_yscale() == "linear"
    assert axes.get_ylim()[1] > pair.straight.accuracy > pair.distance.max()


def test_numbers_and_names():
    """Numbers have a true minus sign; Greek names become mathematics."""
    assert number(-1.5e-7) == "−1.5e−7"
    assert mathematics("theta") == r"$\theta$"


def test_parts_of_a_curve_join():
    """Neighbouring pieces share their end points, so the ring has no gap."""
    turn = np.linspace(0, 2 * np.pi, 50)[:, None]
    ring = np.hstack([np.cos(turn), np.sin(turn), 0 * turn])
    pieces = parted(ring, np.array([1.0, 0.2, 0.3]))
    assert [front for _, front in pieces] == [False, True, True]
    assert sum(len(part) for part, _ in pieces) == 50 + 2
    assert towards([ring[:10]]) @ ring[5] > 0.8


@pytest.mark.parametrize("name", names())
def test_every_space_has_a_first_motion(name):
    """The start is in the domain, with one velocity per leg; it is timelike where there is time."""
    frame = load(name).frame
    first = first_motion(frame)
    values = dict(zip(frame.coordinates, first.start, strict=True))
    values |= {symbol: first.parameters[symbol.name] for symbol in frame.parameters}
    # Functions of the coordinates, such as a(t), have no numbers; azimuths may start at zero.
    for relation in frame.domain:
        assert relation.subs(values) or 0 in first.start
    assert len(first.frame_velocity) == frame.dimension
    eta = np.array(
        [[float(frame.eta[i, j]) for j in range(frame.dimension)] for i in range(frame.dimension)]
    )
    if np.sum(np.linalg.eigvalsh(eta) < 0) == 1 and not frame.complex:
        u = np.array(first.frame_velocity)
        assert u @ eta @ u == pytest.approx(-1, abs=0.01)


def test_paths_and_types_of_figures(tmp_path):
    """A path may be a string; an unknown file type is refused with our own error."""
    pytest.importorskip("matplotlib")
    figure = new_figure(1, 1)
    save(figure, str(tmp_path / "a.PNG"))
    assert (tmp_path / "a.PNG").read_bytes().startswith(b"\x89PNG")
    for name in ("a.jpg", "a.xyz"):
        with pytest.raises(
            FileFormatError, match=r"expected the name of a \.png, \.svg or \.pdf file"
        ):
            save(figure, tmp_path / name)

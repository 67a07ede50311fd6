"""Figure of a gap: the images close, the paths in the space do not."""

# Bad input is given on purpose; matplotlib declares data of lines loosely.
# pyright: reportArgumentType=false, reportIndexIssue=false, reportOperatorIssue=false

from __future__ import annotations

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, ShapeError, UnknownNameError
from geomtorsion.pictures import draw_gap

pytest.importorskip("matplotlib")

BAR = gt.variation(gt.spaces.load("so3").frame, "closed_in_image")
PATH = gt.ODE.of({"phi1": 1, "phi2": "sin(t)/2", "phi3": 0}, [0, 1, 0])
BESIDE = gt.solve(BAR.gap_ode(PATH, ["sin(pi*t/2)/4", 0, 0]), 2.0)
LINE = gt.variation(gt.Frame("s", [[1]]), "closed_in_image")


def test_images_close_and_paths_do_not():
    """The last points of both lines: equal on the left, the gap apart on the right."""
    left, right = draw_gap(BAR, BESIDE, size=2).axes
    ends = [[line.get_xydata()[-1] for line in axes.lines[::2][:2]] for axes in (left, right)]
    assert np.abs(ends[0][1] - ends[0][0]).max() < 1e-9
    open_end = ends[1][1] - ends[1][0]
    moved = 2 * BESIDE["moved"][-1]
    seen = [k for k in range(3) if f"phi_{{{k + 1}}}" in right.get_xlabel() + right.get_ylabel()]
    assert np.abs(open_end - moved[seen]).max() < 1e-9
    assert np.abs(open_end).max() > 0.1
    assert len(right.texts) == 1
    assert "|b| = " in right.get_title()


def test_closed_variations_have_no_arrow():
    """Nothing is drawn between ends that meet."""
    bar = gt.variation(gt.spaces.load("so3").frame)
    solution = gt.solve(bar.gap_ode(PATH, ["sin(pi*t/2)/4", 0, 0]), 2.0)
    right = draw_gap(bar, solution).axes[1]
    assert not right.texts
    assert right.get_title().endswith("|b| = 0")


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: draw_gap(BAR, gt.solve(PATH, 1.0)), UnknownNameError, "variation.gap_ode"),
        (lambda: draw_gap(BAR, 3), ArgumentError, "solution"),
        (lambda: draw_gap(3, BESIDE), ArgumentError, "variation"),
        (lambda: draw_gap(BAR, BESIDE, size=-1), ArgumentError, "size"),
        (
            lambda: draw_gap(LINE, gt.solve(LINE.gap_ode(gt.ODE.of({"s": 1}, [0]), [1]), 1.0)),
            ShapeError,
            "two or more dimensions",
        ),
    ],
)
def test_refusals(call, error, words):
    """Each message names the expected value."""
    with pytest.raises(error, match=words):
        call()

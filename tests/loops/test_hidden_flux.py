"""Hidden flux: a loop through or beside a bump that no sample meets reports it."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from tests.rounding import ROUNDED

x, y, z = sp.symbols("x y z", real=True)
PLACE = sp.Rational(37, 100)


def bump(steep: int) -> gt.Frame:
    """A torsion at (0.37, 1) that is zero as a float a few widths 1/steep away."""
    one, two = (sp.exp(-((steep * u) ** 2)) for u in (x - PLACE, y - 1))
    return gt.Frame([x, y], [[1, 0], [one * two, 1]])


@pytest.mark.parametrize("steep", [1000, 10_000, 100_000])
def test_a_bump_between_samples_is_found(steep: int) -> None:
    """A side through the bump has |b| = sqrt(pi)/steep, which all samples of a first rule miss."""
    found = gt.burgers_vector(bump(steep), gt.Loop.plaquette([0, 0], (1, 1)))
    truth = np.sqrt(np.pi) / steep
    assert abs(np.linalg.norm(found.vector) - truth) <= found.error + ROUNDED
    assert found.error < 1e-6 * truth
    assert gt.prove(found).holds is True


def test_away_from_the_bump_the_error_stays_zero() -> None:
    """Where the torsion is below all floats on the whole cone, its bound is as well."""
    found = gt.burgers_vector(bump(1000), gt.Loop.plaquette([2, 0], (1, 0.5)))
    assert found.error == 0


@pytest.mark.parametrize(
    ("frame", "loop"),
    [
        (gt.Frame([x, y], [[sp.cos(x), 0], [0, sp.exp(y)]]), gt.Loop.circle([0, 0], 1)),
        (gt.spaces.load("heisenberg").frame, gt.Loop.plaquette([1, 1, 0], (1, 1), (1, 2))),
        (
            gt.Frame([x, y, z], [[1, y, 0], [0, 1, 0], [0, 0, 1]]),
            gt.Loop.circle([0, 0, 0], 1, (0, 2)),
        ),
    ],
)
def test_a_flux_that_vanishes_exactly_has_no_error(frame: gt.Frame, loop: gt.Loop) -> None:
    """No torsion at all, or none in the plane of the loop."""
    found = gt.burgers_vector(frame, loop)
    assert found.error < 1e-14
    assert np.abs(found.vector).max() < ROUNDED

"""Phases: lattices, families by symmetry, and refused lattices."""

import mpmath
import numpy as np
import pytest

from geomtorsion.errors import OrientationError
from geomtorsion.materials.maps import Phase, slip_families
from tests.materials.maps.synthetic import NICKEL
from tests.rounding import ROUNDED

ZINC = ((2.66, 2.66, 4.95), (90, 90, 120))


def test_families():
    """6 of <110>/2 and 4 of <111>/2 in cubes; 3 of <a> and 6 of <a + c> in hexagons, up to sign."""
    assert len(NICKEL.family((0.5, 0.5, 0))) == 6
    assert len(NICKEL.family((0.5, 0.5, 0.5))) == 4
    zinc = Phase("zinc", "6/mmm", *ZINC)
    assert len(zinc.family((1, 0, 0))) == 3
    assert len(zinc.family((1, 0, 1))) == 6
    assert np.linalg.norm(zinc.family((1, 0, 0)), axis=1) == pytest.approx(2.66)


def test_lattices():
    """The lattice has the given lengths and angles; b is along y for horizontal axis y."""
    for horizontal in "xy":
        lattice = Phase("zinc", "6/mmm", *ZINC, horizontal).lattice
        assert np.linalg.norm(lattice, axis=0) == pytest.approx(ZINC[0])
        assert lattice[:, 0] @ lattice[:, 1] == pytest.approx(-(2.66**2) / 2)
        assert lattice[:, "xy".index(horizontal)][1 - "xy".index(horizontal)] == pytest.approx(0)
    skew = Phase("albite", "-1", (8.14, 12.8, 7.16), (94.3, 116.6, 87.7)).lattice
    sizes = np.linalg.norm(skew, axis=0)
    cosines = [skew[:, i] @ skew[:, j] / sizes[i] / sizes[j] for i, j in ((1, 2), (0, 2), (0, 1))]
    assert np.degrees(np.arccos(cosines)) == pytest.approx([94.3, 116.6, 87.7])


def test_bad_lattices_are_refused():
    """Angles that close no cell, negative lengths and missing constants are refused."""
    with pytest.raises(OrientationError, match="expected angles of a cell with a volume"):
        Phase("a", "-1", (1, 1, 1), (30, 30, 170))
    with pytest.raises(OrientationError, match="positive lengths"):
        Phase("a", "-1", (-1, 1, 1))
    with pytest.raises(
        OrientationError, match="expected lattice constants, got none. Give lengths"
    ):
        _ = Phase("a", "m-3m").lattice
    with pytest.raises(OrientationError, match="expected a vector different from zero, got 0"):
        NICKEL.family((0, 0, 0))


FLAT = [(60, 60, 120), (30, 30, 60), (120, 120, 120), (80, 50, 130), (40.1, 50.2, 90.3)]


@pytest.mark.parametrize("angles", FLAT)
def test_edges_in_one_plane_are_refused(angles):
    """Angles of a flat cell are refused, also if rounding makes its volume nonzero."""
    with pytest.raises(OrientationError, match="expected angles of a cell with a volume"):
        Phase("flat", "-1", (3, 4, 5), angles)


@pytest.mark.parametrize("angles", [(60, 60, 120), (40.1, 50.2, 90.3), (120, 120, 120)])
def test_nearly_flat_cells_keep_their_digits(angles):
    """At 1e-9 degrees from a flat cell, the height agrees with 50 digits."""
    last = angles[2] - 1e-9
    with mpmath.workdps(50):
        alpha, beta, gamma = (mpmath.radians(mpmath.mpf(repr(x))) for x in (*angles[:2], last))
        cosine = (mpmath.cos(alpha) - mpmath.cos(beta) * mpmath.cos(gamma)) / mpmath.sin(gamma)
        height = float(5 * mpmath.sqrt(mpmath.sin(beta) ** 2 - cosine**2))
    found = Phase("low", "-1", (3, 4, 5), (*angles[:2], last)).lattice[2, 2]
    assert found == pytest.approx(height, rel=ROUNDED)


def test_a_lattice_without_the_symmetry_of_its_group():
    """In zinc with right angles, <a> turned by 60 degrees is not a lattice vector."""
    odd = Phase("zinc", "6/mmm", ZINC[0])
    for ask in (lambda: odd.family((1, 0, 0)), lambda: slip_families(odd, "hcp")):
        with pytest.raises(OrientationError, match="expected a lattice of the symmetry 6/mmm"):
            ask()
    hardly = Phase("tetragonal", "m-3m", (3.0, 3.0, 3.05))
    assert len(hardly.family((0.5, 0.5, 0))) == 6


@pytest.mark.parametrize(
    ("edge", "angle", "fits"), [(1.24, 90, True), (1.26, 90, False), (1, 83, True), (1, 75, False)]
)
def test_vectors_near_a_lattice_vector_match_it(edge, angle, fits):
    """A cube stretched along one edge or sheared fits up to a quarter of an edge."""
    phase = Phase("drawn", "m-3m", (1, 1, edge), (90, 90, angle))
    if fits:
        assert len(phase.family((1, 0, 0))) == 3
        return
    with pytest.raises(OrientationError, match="expected a lattice of the symmetry m-3m"):
        phase.family((1, 0, 0))

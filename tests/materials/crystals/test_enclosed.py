"""Enclosed atoms: a closed line in good crystal reports how many atoms it adds or removes."""

import numpy as np
import pytest

from geomtorsion.materials.crystals import Crystal
from geomtorsion.materials.crystals.reports import inserted_atoms, inserted_error
from tests.materials.crystals.synthetic import interstitial_loop, vacancy_disc

OPEN = (False, False, False)
LOOPS = ((0, 3), (0, 4), (4, 4), (0, 5))


def counted(crystal, partials=False):
    """Number of atoms that each closed line encloses; all reported errors must be zero."""
    lines = crystal.dislocations(partials).lines
    assert all(line.is_closed and inserted_error(line, crystal) == 0 for line in lines)
    return sorted(round(inserted_atoms(line, crystal)) for line in lines)


# test_reports.py has the case without noise, a small loop in an open box.
@pytest.mark.parametrize(
    ("percent", "radius"),
    [(4, 3), (4, 5), *(pytest.param(*x, marks=pytest.mark.slow) for x in LOOPS)],
)
def test_interstitials_in_an_open_box(percent, radius):
    """The count is exact, though noise changes bonds across the line well inside the loop."""
    places, cell, put_in = interstitial_loop(radius)
    noise = np.random.default_rng(radius).normal(size=places.shape)
    crystal = Crystal(places + percent / 100 * np.sqrt(0.75) * noise, cell, OPEN)
    assert counted(crystal) == [put_in]
    (line,) = crystal.dislocations().lines
    assert line.length == pytest.approx(2 * np.pi * radius, rel=0.03)


# test_reports.py also has the larger loop.
@pytest.mark.parametrize("radius", [4, pytest.param(5, marks=pytest.mark.slow)])
def test_a_slab_in_which_the_loop_nearly_meets_its_images(radius):
    """The good crystal around the loop is found across periodic boundaries."""
    places, cell, put_in = interstitial_loop(radius)
    assert counted(Crystal(places, cell, (True, True, False))) == [put_in]


def test_each_of_several_loops():
    """Two loops in one box are counted separately, and a vacancy outside both is not counted."""
    first, cell, many = interstitial_loop(4)
    second, _, few = interstitial_loop(3)
    places = np.concatenate([first, second + np.array([cell[0], 0, 0])])
    gone = np.linalg.norm(places - [cell[0], 1.0, 1.0], axis=1).argmin()
    crystal = Crystal(np.delete(places, gone, axis=0), periodic=OPEN)
    assert counted(crystal) == [few, many]


@pytest.mark.parametrize("height", [0, 1.8, 2.6])
def test_a_vacancy_next_to_a_loop_takes_nothing_from_it(height):
    """The vacancy may be inside the surface on which sites are counted, or on that surface."""
    places, cell, put_in = interstitial_loop(3)
    gone = np.linalg.norm(places - cell / 2 - [0, 0, height], axis=1).argmin()
    assert counted(Crystal(np.delete(places, gone, axis=0), cell, OPEN)) == [put_in]


@pytest.mark.parametrize("radius", [3, 5])
def test_vacancies_of_a_frank_loop_in_an_open_box(radius):
    """The enclosed fault does not change the count, since good crystal surrounds the loop."""
    places, cell, missing = vacancy_disc(radius)
    assert counted(Crystal(places, cell, OPEN), partials=True) == [-missing]


def test_lines_in_bad_crystal_have_an_error():
    """Under strong noise the count comes from the line, within its nonzero reported error."""
    places, cell, put_in = interstitial_loop(4)
    noise = 0.12 * np.sqrt(0.75) * np.random.default_rng(0).normal(size=places.shape)
    crystal = Crystal(places + noise, cell, OPEN)
    (line,) = crystal.dislocations().lines
    assert 0 < abs(inserted_atoms(line, crystal) - put_in) < inserted_error(line, crystal)

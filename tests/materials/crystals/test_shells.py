"""Shells: triangulating only where neighbours do not close finds the lines of a full Delaunay."""

import numpy as np
import pytest

from geomtorsion.materials.crystals import LATTICES, Crystal
from geomtorsion.materials.crystals.shells import shells_of
from tests.materials.crystals.synthetic import block, with_line


def closed_share(crystal):
    """Share of the atoms that need no triangulation."""
    return shells_of(crystal._places, crystal.frame).closed.mean()


@pytest.mark.parametrize("lattice", LATTICES)
def test_a_perfect_crystal_needs_no_triangulation(lattice):
    """A crystal with a single vacancy and a pair of vacancies needs none either."""
    places, cell = block(lattice, (8, 5, 5))
    assert closed_share(Crystal(places, cell, lattice=lattice)) == 1
    gone = [0, 1, len(places) // 2]
    holes = Crystal(np.delete(places, gone, axis=0), cell, lattice=lattice)
    assert closed_share(holes) == 1
    assert holes.dislocations().lines == ()


def test_vacancies_of_hcp_are_seen_in_all_its_axes():
    """Atoms between two vacancies keep their kind in each equivalent frame of hcp."""
    places, cell = block("hcp", (8, 5, 5))
    holes = np.delete(places, [0, 1, len(places) // 2], axis=0)
    for turn in range(6):
        c, s = np.cos(turn * np.pi / 3), np.sin(turn * np.pi / 3)
        for flip in (1, -1):
            orient = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ np.diag([1, flip, flip])
            assert closed_share(Crystal(holes, cell, lattice="hcp", orient=orient)) == 1


def test_an_unrelaxed_screw_is_seen():
    """All shells of its atoms are perfect, but triangles of neighbours do not close."""
    places, cell = with_line("bcc", (0, 0, 1))
    crystal = Crystal(places, cell, (False, False, True))
    assert 0.9 < closed_share(crystal) < 1
    (line,) = crystal.dislocations().lines
    assert line.family == "<1 0 0>"


def test_near_and_everywhere_give_the_same_lines():
    """Tetrahedra near violations contain all the torsion of the full triangulation."""
    places, cell = with_line("fcc", (0.5, 0.5, 0), (16, 16, 6))
    crystal = Crystal(places, cell, (False, False, True))
    near, _ = crystal._near_torsion(False)
    assert 0 < len(near.mesh.corners) < len(crystal.mesh.corners) / 4
    assert near.values.any(axis=1).sum() == crystal.torsion.values.any(axis=1).sum()


@pytest.mark.parametrize("together", [1, 97, 10**9])
def test_blocks_of_any_size_give_the_same(together):
    """The number of atoms per block changes only the memory, not the result."""
    places, cell = with_line("hcp", (1, 0, 0), (10, 6, 3))
    crystal = Crystal(places, cell, (False, False, True))
    one, other = (shells_of(crystal._places, crystal.frame, *size) for size in ((), (together,)))
    for name in ("near", "kind", "closed"):
        assert (getattr(one, name) == getattr(other, name)).all()


@pytest.mark.parametrize("lattice", ["fcc", "bcc"])
def test_faces_edges_and_corners_are_surfaces(lattice):
    """An open block needs no triangulation; with strictly empty spheres it would."""
    places, _ = block(lattice, (8, 8, 8))
    assert closed_share(Crystal(places, lattice=lattice, orient=np.eye(3))) == 1


def test_most_of_a_ball_is_a_surface():
    """A ball has steps and edges everywhere, but few of its atoms need a triangulation. With larger
    spheres, or strictly empty ones, 45 to 150 would need it."""
    places, cell = block("fcc", (8, 8, 8))
    ball = places[np.linalg.norm(places - cell / 2 - [0.1, 0.07, 0.03], axis=1) < 3.7]
    crystal = Crystal(ball, periodic=(False,) * 3, lattice="fcc", orient=np.eye(3))
    assert round((1 - closed_share(crystal)) * len(ball)) == 27


def test_a_core_differs_from_a_surface():
    """In the core of an edge all atoms that lack a neighbour stay open, not only the innermost."""
    places, cell = with_line("bcc", (1, 0, 0), margin=0.45)
    crystal = Crystal(places, cell, (False, False, True), lattice="bcc", orient=np.eye(3))
    # Three layers of four atoms per period; smaller spheres would give 32 or fewer.
    assert round((1 - closed_share(crystal)) * len(places)) == 36

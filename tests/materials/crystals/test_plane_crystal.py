"""Atoms in a plane: lattices, dislocations as points, grains, strain, files, and refusals."""

import copy
import json
import pickle
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals import Crystal, PlaneCrystal, read, read_all
from tests.cli import running

BASES = {
    "hexagonal": [[1.0, 0.5], [0.0, np.sqrt(3) / 2]],
    "square": [[1.0, 0.0], [0.0, 1.0]],
    "rectangular": [[1.0, 0.0], [0.0, 1.3]],
    "centred rectangular": [[1.0, 0.4], [0.0, np.sqrt(1 - 0.16)]],
    "oblique": [[1.0, 0.35], [0.0, 0.9]],
}


def sheet(name: str, radius: float = 12.0, turn: float = 0.0, size: float = 1.0) -> np.ndarray:
    """Atoms within a circle, turned by degrees."""
    i, j = np.mgrid[-40:41, -40:41].reshape(2, -1)
    base = np.array(BASES["hexagonal" if name == "honeycomb" else name])
    places = np.column_stack([i, j]) @ base.T
    if name == "honeycomb":
        places = places[(i - j) % 3 != 0]
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    return size * places[np.hypot(*places.T) < radius] @ np.array([[c, s], [-s, c]])


def cut(places: np.ndarray, at: tuple[float, float], b: np.ndarray) -> np.ndarray:
    """The same atoms with a displacement that grows by b, anticlockwise around a point.

    It jumps along a line parallel to b, so that no gap opens.
    """
    along = (places - at) @ [1, 1j] * (b[0] - 1j * b[1])
    return places + np.outer(np.angle(along) / (2 * np.pi), b)


def crystal(*args, **options) -> PlaneCrystal:
    made: Any = Crystal(*args, **options)
    assert isinstance(made, PlaneCrystal)
    return made


@pytest.mark.parametrize("turn", [0.0, 17.0])
@pytest.mark.parametrize("name", [*BASES, "honeycomb"])
def test_a_perfect_lattice(name: str, turn: float):
    """Name and vectors of the lattice, no dislocation, no strain, in any unit."""
    made = crystal(sheet(name, turn=turn, size=2.7))
    assert made.lattice == name
    shortest = {"honeycomb": np.sqrt(3), "oblique": np.hypot(0.35, 0.9)}
    spacing = 2.7 * shortest.get(name, 1.0)
    assert made.constant == pytest.approx(spacing)
    assert made.dislocations() == ()
    known = np.isfinite(made.strain).all(axis=(1, 2))
    assert known.mean() > 0.95
    assert np.abs(made.strain[known]).max() < 1e-9
    assert made.grain.max() == 0


@pytest.mark.parametrize("name", [*BASES, "honeycomb"])
def test_a_dislocation(name: str):
    """A displacement that grows by a lattice vector gives minus this vector, at its centre."""
    perfect = sheet(name, 14.0, 11.0)
    for vector in crystal(perfect).grains[0].vectors:
        made = crystal(cut(perfect, (0.4, 0.3), vector))
        (point,) = made.dislocations()
        assert point.burgers == pytest.approx(-vector, abs=0.05 * float(np.hypot(*vector)))
        assert np.hypot(point.position[0] - 0.4, point.position[1] - 0.3) < 1.2
        assert all(x.denominator == 1 for x in point.burgers_lattice)
        frame = made.grains[point.grain].vectors
        assert np.array(point.burgers_lattice, dtype=float) @ frame == pytest.approx(point.burgers,
            abs=0.05)  # fmt: skip


@pytest.mark.parametrize("seed", range(3))
def test_a_pair_in_noise(seed: int):
    """Two opposite dislocations in noise of 5 % of the spacing; their sum is zero."""
    places = cut(cut(sheet("hexagonal", 25), (-7.2, 0.3), np.array([1.0, 0])), (7.2, 0.3),
                 np.array([-1.0, 0]))  # fmt: skip
    noisy = places + np.random.default_rng(seed).normal(0, 0.05, places.shape)
    one, two = crystal(noisy).dislocations()
    assert one.burgers_lattice == tuple(-x for x in two.burgers_lattice)
    assert np.array([one.position, two.position])[:, 0] == pytest.approx([-7.2, 7.2], abs=1)


def test_point_defects_have_no_burgers_vector():
    """Vacancies and an interstitial atom."""
    places = sheet("hexagonal")
    places = np.delete(places, [len(places) // 2, len(places) // 3], axis=0)
    assert crystal(np.append(places, [[3.5, 0.29]], axis=0)).dislocations() == ()


def test_a_hole_with_a_dislocation():
    """Atoms within three spacings are missing; b is the sum around the hole."""
    places = cut(sheet("hexagonal", 16), (0.2, 0.3), np.array([1.0, 0]))
    (point,) = crystal(places[np.hypot(*places.T) > 3]).dislocations()
    assert point.burgers_lattice == (-1, 0)
    assert (
        crystal(sheet("hexagonal", 16)[np.hypot(*sheet("hexagonal", 16).T) > 3]).dislocations()
        == ()
    )


def bicrystal(degrees: float, name: str = "hexagonal") -> np.ndarray:
    left, right = sheet(name, 22), sheet(name, 22, degrees)
    both = np.concatenate([left[left[:, 0] < -0.4], right[right[:, 0] > 0.4]])
    return both[np.abs(both).max(axis=1) < 15]


@pytest.mark.parametrize("name", ["hexagonal", "square"])
def test_grains(name: str):
    """A boundary of 25 degrees separates two grains with their directions."""
    made = crystal(bicrystal(25.0, name))
    assert len(made.grains) == 2
    period = 60 if name == "hexagonal" else 90
    angles = sorted(round(one.angle % period, 3) % period for one in made.grains)
    assert angles == pytest.approx([0, 25], abs=0.05)
    assert sum(len(one.atoms) for one in made.grains) == made.count
    sides = [made.positions[one.atoms, 0].mean() for one in made.grains]
    assert sorted(np.sign(sides)) == [-1, 1]


def test_a_boundary_of_small_angle_is_a_row_of_dislocations():
    """Frank's rule: they are 1 / (2 sin (angle / 2)) spacings apart."""
    made = crystal(bicrystal(6.0))
    assert len(made.grains) == 1
    places = np.array(sorted(one.position[1] for one in made.dislocations()))
    apart = 1 / (2 * np.sin(np.radians(3)))
    assert np.diff(places).mean() == pytest.approx(apart, rel=0.05)
    assert np.abs([one.position[0] for one in made.dislocations()]).max() < 1


def test_a_bent_crystal_has_no_dislocation():
    """The direction turns by more than the period from end to end."""
    places = sheet("hexagonal", 39)
    places = places[np.abs(places[:, 1]) < 2]
    angle, radius = places[:, 0] / 50, 50 + places[:, 1]
    made = crystal(np.column_stack([radius * np.sin(angle), radius * np.cos(angle)]))
    assert made.dislocations() == ()
    assert made.constant == pytest.approx(1, rel=0.01)


def test_strain():
    """One half stretched by 2 % along x, against the other half; truth in closed form."""
    places = sheet("square", 14)
    moved = np.where(places[:, :1] > 0, places * [1.02, 1], places)
    made = crystal(moved)
    e = [np.nanmean(made.strain[side], axis=0) for side in (places[:, 0] > 2, places[:, 0] < -2)]
    ratio = np.sqrt((1 + 2 * e[0][0, 0]) / (1 + 2 * e[1][0, 0]))
    assert ratio == pytest.approx(1.02, abs=1e-6)
    assert e[0][[0, 1, 1], [1, 0, 1]] == pytest.approx(np.zeros(3), abs=1e-4)


def test_a_periodic_cell():
    """A dipole in a periodic cell of graphene-like atoms; without it there is none."""
    i, j = np.mgrid[:24, :24].reshape(2, -1)
    places = np.column_stack([i + j / 2, j * np.sqrt(3) / 2])
    cell = [[24, 0], [12, 12 * np.sqrt(3)]]
    made = crystal(places + np.random.default_rng(0).normal(0, 0.03, places.shape), cell)
    assert made.dislocations() == ()
    assert np.isfinite(made.strain).all()
    # A half row of atoms less: its two ends are opposite dislocations.
    gap = (j == 12) & (i > 5) & (i < 17)
    ends = crystal(places[~gap], cell).dislocations()
    assert not any(sum(one.burgers_lattice[k] for one in ends) for k in (0, 1))


def xyz(path: Path, places: np.ndarray, frames: int = 1, cell: str = "") -> Path:
    rows = [f"C {x:.6f} {y:.6f} 3.35" for x, y in places.tolist()]
    path.write_text("\n".join([str(len(rows)), cell, *rows] * frames) + "\n")
    return path


def test_graphene_from_a_file(tmp_path: Path):
    """Flat atoms in space are a crystal in a plane; vacuum above them does not matter."""
    places = 1.42 * sheet("honeycomb", 15)
    for cell in ("", 'Lattice="90 0 0 0 90 0 0 0 20" pbc="F F T"'):
        made: Any = read(xyz(tmp_path / "a.xyz", places, cell=cell))
        assert isinstance(made, PlaneCrystal)
        assert (made.lattice, round(made.constant, 2)) == ("honeycomb", 2.46)
    path = xyz(tmp_path / "b.xyz", cut(places, (0.5, 0.3), made.grains[0].vectors[0]), 2)
    first, second = read_all(path)
    assert first.dislocations() == second.dislocations()
    said = running.run("crystal", str(path), "-o", str(tmp_path / "o"), code=0)
    assert "atoms in a plane: honeycomb, a = " in said.stdout
    assert "1 dislocation" in said.stdout
    assert (tmp_path / "o/crystal.png").stat().st_size > 10_000
    frames = json.loads((tmp_path / "o/crystal.json").read_text())["frames"]
    assert [len(frame["points"]) for frame in frames] == [1, 1]
    assert frames[0]["points"][0]["burgers_lattice"] == ["-1", "0"]


def test_crystals_in_space_remain_in_space():
    """A layer that repeats at the distance of its atoms is a crystal in space."""
    places = np.array([[x, y, 0] for x in range(8) for y in range(8)], dtype=float)
    assert isinstance(Crystal(places, cell=[8, 8, 1]), Crystal)
    assert isinstance(Crystal(places, cell=[8, 8, 30]), PlaneCrystal)


def test_values():
    """Copies and pickles are equal; equal calls give equal bits."""
    places = cut(sheet("hexagonal"), (0.2, 0.3), np.array([1.0, 0]))
    made = crystal(places)
    for other in (copy.copy(made), pickle.loads(pickle.dumps(made)), crystal(places)):
        assert other.dislocations() == made.dislocations()
        assert np.array_equal(other.strain, made.strain, equal_nan=True)
    assert made.dislocations()[0].burgers_lattice == (Fraction(-1), Fraction(0))
    assert made.bonds.values.shape[1] == 2
    assert "PlaneGrain(0: " in repr(made.grains[0])


RANDOM = np.random.default_rng(0).uniform(0, 10, (300, 2))
REFUSED = [
    (RANDOM, {}, "expected a lattice in a plane"),
    (RANDOM[:12], {}, "expected 20 or more atoms"),
    (np.column_stack([np.arange(30.0), np.zeros(30)]), {}, "positions: expected"),
    (np.repeat(RANDOM[:20], 2, axis=0), {}, "expected different atoms, got atoms"),
    (RANDOM, {"lattice": "kagome"}, "lattice in a plane"),
    (RANDOM, {"cell": [[1, 2], [2, 4]]}, "expected two edges that span a plane"),
    (RANDOM, {"orient": np.eye(3)}, "orient, constant: expected none"),
    (RANDOM, {"species": ["C"]}, "species"),
    (np.full((30, 2), np.nan), {}, "positions"),
]


@pytest.mark.parametrize("number", range(len(REFUSED)))
def test_refusals(number: int):
    """The message names the fault and the remedy."""
    places, options, words = REFUSED[number]
    with pytest.raises(CrystalError, match=words):
        _ = Crystal(places, **options).grains

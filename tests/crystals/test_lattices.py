"""Lattices: the decoder gives the nearest lattice vector, and v and -v opposite ones."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from geomtorsion.crystals import LATTICES
from geomtorsion.crystals.lattices import lattice_named
from geomtorsion.errors import CrystalError

ROWS = arrays(float, (5, 3), elements=st.floats(-9, 9))


@pytest.mark.parametrize("name", LATTICES)
@given(values=ROWS)
def test_the_label_is_nearest(name, values):
    """No lattice vector among all near ones is nearer."""
    lattice = LATTICES[name]
    found = lattice.decode(values)
    around = np.stack(np.meshgrid(*[range(-4, 5)] * 3), axis=-1).reshape(-1, 3)
    every = around @ lattice.translations
    apart = (((values[:, None] - found[:, None] - every) * lattice.units) ** 2).sum(axis=2)
    own = (((values - found) * lattice.units) ** 2).sum(axis=1)
    assert (own <= apart.min(axis=1) + 1e-12).all()
    whole = found @ np.linalg.inv(lattice.translations)
    assert whole == pytest.approx(np.rint(whole), abs=1e-9)


@pytest.mark.parametrize("name", LATTICES)
@given(values=arrays(float, (5, 3), elements=st.integers(-9, 9).map(lambda n: n / 2)))
def test_labels_are_odd_in_ties_too(name, values):
    """label(ji) = -label(ij), on points as far from several lattice vectors, and for any kinds."""
    lattice = LATTICES[name]
    shift = np.array([1, -1, 0, 1, -1])
    assert (lattice.decode(-values) == -lattice.decode(values)).all()
    assert (lattice.decode(-values, -shift) == -lattice.decode(values, shift)).all()


def test_neighbours_and_volumes_are_those_of_textbooks():
    """Numbers of nearest neighbours, their distance, and atoms in a cell."""
    nearest = {
        "fcc": (12, 0.5**0.5),
        "bcc": (8, 0.75**0.5),
        "hcp": (12, 1),
        "diamond": (4, 3**0.5 / 4),
        "hexagonal diamond": (4, 0.375**0.5),
    }
    for name, (count, distance) in nearest.items():
        lattice = LATTICES[name]
        for vectors in lattice.neighbours:
            sizes = np.linalg.norm(vectors * lattice.units, axis=1)
            assert sizes[:count] == pytest.approx(distance)
            assert (sizes[count:] > 1.1 * distance).all()
    per_cell = {name: 1 / LATTICES[name].atom_volume for name in ("fcc", "bcc", "diamond")}
    assert per_cell == pytest.approx({"fcc": 4, "bcc": 2, "diamond": 8})
    assert LATTICES["hcp"].atom_volume == pytest.approx(0.5**0.5)
    assert LATTICES["hexagonal diamond"].atom_volume == pytest.approx(0.5**0.5 / 2)


@pytest.mark.parametrize("name", LATTICES)
def test_neighbours_of_each_kind_are_all_near_sites(name):
    """By hand: all sites of the crystal about one of each kind, and the kinds that decode knows."""
    lattice = LATTICES[name]
    around = np.stack(np.meshgrid(*[range(-3, 4)] * 3), axis=-1).reshape(-1, 3)
    net = around @ lattice.translations
    every = np.concatenate([net + place for place in lattice.offsets])
    kinds = np.repeat(np.arange(len(lattice.offsets)), len(net))
    for kind, vectors in enumerate(lattice.neighbours):
        steps = every - lattice.offsets[kind]
        near = np.linalg.norm(steps * lattice.units, axis=1).argsort()[1 : lattice.shells + 1]
        assert {tuple(v) for v in steps[near].tolist()} == {tuple(v) for v in vectors.tolist()}
        shift = lattice.shift(np.full(len(near), kind), kinds[near])
        assert (lattice.decode(steps[near] + 0.05, shift) == steps[near]).all()


def test_an_unknown_lattice_is_refused():
    """The message names those that there are."""
    with pytest.raises(CrystalError, match="one of fcc, bcc, hcp, diamond, hexagonal diamond was"):
        lattice_named("sc")

"""Slip: numbers of systems as in textbooks, and densities that make up b."""

import numpy as np
import pytest

from geomtorsion.errors import OrientationError
from geomtorsion.materials.maps import (
    Circuit,
    OrientationMap,
    Phase,
    SlipFamily,
    slip_families,
)
from tests.materials.maps.synthetic import NICKEL, bent

IRON = Phase("iron", "m-3m", (2.87, 2.87, 2.87))
ZINC = Phase("zinc", "6/mmm", (2.66, 2.66, 4.95), (90, 90, 120))


@pytest.mark.parametrize(
    ("phase", "structure", "counts"),
    [
        (NICKEL, "fcc", [12]),
        (NICKEL, "diamond", [12]),
        (IRON, "bcc", [12, 12, 24]),
        (ZINC, "hcp", [3, 3, 6, 6]),
        (Phase("zinc", "6/mmm", (2.66, 2.66, 4.95), (90, 90, 120), "y"), "hcp", [3, 3, 6, 6]),
    ],
)
def test_numbers_of_systems(phase, structure, counts):
    """The numbers are from Hirth and Lothe; each vector is in its plane, all of one length."""
    found = slip_families(phase, structure)
    assert [len(one.normals) for one in found] == counts
    for one in found:
        assert np.abs(np.einsum("ki,ki->k", one.normals, one.vectors)).max() < 1e-9
        sizes = np.linalg.norm(one.vectors, axis=1)
        assert sizes == pytest.approx(sizes[0])
        assert np.linalg.norm(one.normals, axis=1) == pytest.approx(1)


def test_first_order_pyramidal_slip():
    """{10-11} <11-23> of hexagonal crystals has twelve systems of length sqrt(a^2 + c^2)."""
    found = SlipFamily.of(ZINC, (1, 0, -1, 1), (-2 / 3, 1 / 3, 1 / 3, 1))
    assert len(found.normals) == 12
    assert np.linalg.norm(found.vectors[0]) == pytest.approx(np.hypot(2.66, 4.95))
    three = SlipFamily.of(ZINC, (1, 0, 1), (-1, 0, 1))
    assert np.abs(np.abs(found.vectors[0]) - np.abs(three.vectors[0])).max() < 1e-9


@pytest.mark.parametrize(("phase", "structure"), [(NICKEL, "fcc"), (IRON, "bcc"), (ZINC, "hcp")])
def test_densities_make_up_b(phase, structure):
    """In a bent crystal edges and screws through the circuit add up to b, with minimal length."""
    crystal = OrientationMap.from_euler(bent((12, 12), 0.1), 0.5, phase, sigma=0)
    b = crystal.burgers(Circuit.square((1, 1), 8))
    normal = b.rotation[2]
    families = slip_families(phase, structure)
    total = np.zeros(3)
    length = 0.0
    for one in b.slip(*families):
        for kind in ("edge", "screw"):
            lines = (
                np.cross(one.family.normals, one.family.vectors)
                if kind == "edge"
                else one.family.vectors
            )
            lines = lines / np.linalg.norm(lines, axis=1)[:, None]
            total += (getattr(one, kind) * (lines @ normal)) @ one.family.vectors
        length += one.total
    assert total / 1e4 == pytest.approx(b.per_area, rel=1e-6)
    # A line contributes at most the length of its b, so |b| over the longest b is the least length.
    longest = max(np.linalg.norm(one.vectors[0]) for one in families)
    assert length >= np.linalg.norm(b.per_area) * 1e4 / longest * (1 - 1e-9)
    more = b.slip(*families, SlipFamily.of(phase, (1, 0, 0), (0, 1, 0)))
    assert sum(one.total for one in more) <= length * (1 + 1e-6)


def test_bad_slip_systems_are_refused():
    """A vector out of the plane, wrong indices, an unknown structure and too few families fail."""
    with pytest.raises(OrientationError, match=r"which is not in it. Give u, v, w with h u \+ k v"):
        SlipFamily.of(IRON, (1, 1, 0), (1, 1, 0))
    with pytest.raises(OrientationError, match="only in a hexagonal or trigonal cell.* for m-3m"):
        SlipFamily.of(IRON, (1, 1, -2, 0), (0, 0, 1))
    with pytest.raises(OrientationError, match="a sum of 0 for the first three, got .1, 1, 1, 0."):
        SlipFamily.of(ZINC, (1, 1, 1, 0), (0, 0, 1))
    with pytest.raises(OrientationError, match="expected three indices"):
        SlipFamily.of(ZINC, (1, 1), (0, 0, 1))
    with pytest.raises(OrientationError, match="structure"):
        slip_families(IRON, "bct")
    crystal = OrientationMap.from_euler(bent((12, 12), 0.1), 0.5, IRON, sigma=0)
    b = crystal.burgers(Circuit.square((1, 1), 8))
    with pytest.raises(OrientationError, match="expected at least one SlipFamily, got none"):
        b.slip()
    olivine = Phase("olivine", "mmm", (4.76, 10.2, 5.98))
    turned = OrientationMap.from_euler(bent((12, 12), 0.1), 0.5, olivine, sigma=0)
    with pytest.raises(OrientationError, match="expected edges and screws that add up to b"):
        turned.burgers(Circuit.square((1, 1), 8)).slip(SlipFamily.of(olivine, (0, 1, 0), (1, 0, 0)))


def test_planes_and_vectors_of_zero_are_refused():
    """Indices that are all 0 have no direction."""
    with pytest.raises(OrientationError, match="plane: expected indices that are not all 0"):
        SlipFamily.of(IRON, (0, 0, 0), (1, 0, 0))
    with pytest.raises(
        OrientationError, match="Burgers vector: expected indices that are not all 0"
    ):
        SlipFamily.of(ZINC, (0, 0, 0, 1), (0, 0, 0, 0))


def test_a_circuit_without_an_area_has_no_density():
    """Cells with opposite senses cancel to the last digit, on any grid."""
    for step in (1.0, 0.3):
        crystal = OrientationMap.from_euler(bent((5, 8), 0.5), step, IRON, sigma=0)
        found = crystal.burgers(Circuit.of_cells([[1, 0, 0], [0, 1, -2]], (1, 1)))
        assert found.area == 0
        with pytest.raises(
            OrientationError, match="circuit: expected a circuit that encloses an area"
        ):
            found.slip(*slip_families(IRON, "bcc"))

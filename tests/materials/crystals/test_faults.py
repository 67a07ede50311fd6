"""Faults: partial dislocations at the edges of stacking faults."""

import numpy as np
import pytest

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals import LATTICES, Crystal
from tests.cli.running import run
from tests.materials.crystals.polycrystals import filled
from tests.materials.crystals.synthetic import block, cylinder, displaced, torn
from tests.materials.crystals.test_crystal import atoms_of


def test_relaxed_copper_has_two_partials_of_one_sum():
    """With partials there are two lines 1/6<1 1 2>, without partials their sum 1/2<1 1 0>."""
    crystal = Crystal(*atoms_of("cu_edge110_relax"))
    (whole,) = crystal.dislocations().lines
    parts = crystal.dislocations(partials=True).lines
    assert [line.family for line in parts] == ["1/6<1 1 2>"] * 2
    assert whole.family == "1/2<1 1 0>"
    total = sum(np.sign(line.image[2]) * np.array(line.burgers, float) for line in parts)
    assert total == pytest.approx(np.sign(whole.image[2]) * np.array(whole.burgers, float))
    for line in parts:
        assert line.length == pytest.approx(13.28236, rel=0.03)


@pytest.mark.parametrize("name", ["al_edge_dipole_relax", "cu_perfect", "cu_edge110"])
def test_no_line_appears_by_the_option(name):
    """A fault across the whole cell adds no line, and an unsplit line stays one line."""
    crystal = Crystal(*atoms_of(name))
    for partials in (False, True):
        lines = crystal.dislocations(partials).lines
        assert [line.family for line in lines] == ["1/2<1 1 0>"] * (name == "cu_edge110")


def test_a_fault_has_no_line():
    """Half of a crystal shifted by 1/6[1 1 -2] over (111), periodic in the plane, has no line."""
    turn = np.array([[1, -1, 0] / np.sqrt(2), [1, 1, -2] / np.sqrt(6), [1, 1, 1] / np.sqrt(3)])
    places, _ = block("fcc", (14, 14, 14))
    turned = (places - 7) @ turn.T
    cell = np.array([np.sqrt(0.5) * 6, np.sqrt(1.5) * 4, 9.0])
    inside = (turned[:, :2] > -1e-6) & (turned[:, :2] < cell[:2] - 1e-6)
    kept = turned[inside.all(axis=1) & (np.abs(turned[:, 2]) < 4)]
    kept[kept[:, 2] > 0.1, 1] += 1 / np.sqrt(6)
    crystal = Crystal(kept, np.diag(cell), (True, True, False))
    assert crystal.lattice == "fcc"
    for partials in (False, True):
        assert crystal.dislocations(partials=partials).lines == ()


@pytest.mark.parametrize(("lattice", "height"), [("fcc", 0.5), ("diamond", -0.125)])
def test_partials_that_are_put_in_come_out(lattice, height):
    """Two opposite 1/6[1 1 -2] bound a fault in (111), in diamond in its glide set: no whole line,
    each partial at its position, and the sum of both is zero."""
    z, y = np.array([1, -1, 0]) / 2**0.5, np.ones(3) / 3**0.5
    turn = np.array([np.cross(y, z), y, z])
    sites = (filled(lattice, np.eye(3), 11) - 0.117) @ turn.T
    period = 4 / 2**0.5
    inside = (np.abs(sites[:, 2] - period / 2 + 1e-6) < period / 2) & (
        np.hypot(sites[:, 0], sites[:, 1]) < 10
    )
    sites = sites[inside]
    b = turn @ np.array([1, 1, -2]) / 6
    places = sites.copy()
    for sense in (1, -1):
        centre = np.array([-5.03 * sense, height / 3**0.5])
        places += displaced(sites, centre, sense * b) - sites
    crystal = Crystal(places, [60, 60, period], (False, False, True), lattice)
    assert crystal.dislocations().lines == ()
    lines = crystal.dislocations(partials=True).lines
    assert [(line.family, line.kind) for line in lines] == [("1/6<1 1 2>", "periodic")] * 2
    assert sorted(line.path[:, 0].mean() for line in lines) == pytest.approx([-5, 5], abs=0.6)
    each = [np.sign(line.image[2]) * np.array(line.burgers, float) for line in lines]
    assert sum(each) == pytest.approx(np.zeros(3), abs=1e-9)
    for line, found in zip(lines, each, strict=True):
        assert line.length == pytest.approx(period, rel=0.03)
        # b is minus the closed integral of du.
        assert found == pytest.approx(np.sign(line.path[:, 0].mean()) * b, abs=0.01)


# b of two partials along [1 -1 0] in the plane (1 1 1), in sixths of a; the leading one is last.
PAIRS = {"screw": ((2, -1, -1), (1, -2, 1)), "sixty": ((2, -1, -1), (1, 1, -2))}


# Quick runs cover the most noise of each lattice, and each pair in one lattice.
SHARP = (("fcc", "screw", 8), ("diamond", "sixty", 8))
PARTED = [
    one if one in SHARP else pytest.param(*one, marks=pytest.mark.slow)
    for lattice in ("fcc", "diamond")
    for percent in (0, 5, 8)
    for line in PAIRS
    for one in [(lattice, line, percent)]
]


@pytest.mark.parametrize(("lattice", "line", "percent"), PARTED)
def test_a_dislocation_is_two_partials(lattice, line, percent):
    """A screw splits into two 30 degree partials, a 60 degree line into partials of 30 and 90; in
    diamond in its glide set. Each has its b and position; without the option they are one line."""
    z, y = np.array([1, -1, 0]) / 2**0.5, np.ones(3) / 3**0.5
    axes = np.array([np.cross(y, z), y, z])
    period, height = 4 / 2**0.5, {"fcc": 0.5, "diamond": -0.125}[lattice] / 3**0.5
    sites = cylinder(lattice, axes, period, radius=7, centre=(0, 0, 0))
    put_in = [
        ((x + 0.03, height), axes @ np.array(b) / 6)
        for x, b in zip((-3, 3), PAIRS[line], strict=True)
    ]
    noise = percent / 100 * LATTICES[lattice].nearest
    places = torn(sites, put_in) + noise * np.random.default_rng(0).normal(size=sites.shape)
    # b is exact in the crystal axes of the construction.
    crystal = Crystal(places, [60, 60, period], (False, False, True), lattice, axes.T, 1.0)
    (whole,) = crystal.dislocations().lines
    assert whole.family == "1/2<1 1 0>"
    parts = crystal.dislocations(partials=True).lines
    parts = sorted(parts, key=lambda one: one.path[:, 0].mean())
    assert [(part.family, part.kind) for part in parts] == [("1/6<1 1 2>", "periodic")] * 2
    for part, ((x, _), b) in zip(parts, put_in, strict=True):
        assert part.path[:, 0].mean() == pytest.approx(x, abs=0.6)
        assert part.length == pytest.approx(period, rel=0.03)
        # b is minus the closed integral of du.
        assert np.sign(part.image[2]) * np.array(part.burgers, float) == pytest.approx(-b)
    total = sum(b for _, b in put_in)
    assert np.sign(whole.image[2]) * np.array(whole.burgers, float) == pytest.approx(-total)


def test_messages_about_a_fault_at_the_surface_name_the_option(tmp_path):
    """A single partial, whose fault reaches the surface, is a line only with partials=True; the
    refusal of a circuit across the fault and the command name the option."""
    z, y = np.array([1, -1, 0]) / 2**0.5, np.ones(3) / 3**0.5
    axes, period = np.array([np.cross(y, z), y, z]), 4 / 2**0.5
    sites = cylinder("fcc", axes, period, radius=7, centre=(0, 0, 0))
    places = torn(sites, [((0.03, 0.5 / 3**0.5), axes @ np.array([1, 1, -2]) / 6)])
    crystal = Crystal(places, [60, 60, period], (False, False, True), "fcc")
    assert crystal.dislocations().lines == ()
    (line,) = crystal.dislocations(partials=True).lines
    assert (line.family, line.kind) == ("1/6<1 1 2>", "periodic")
    with pytest.raises(CrystalError, match=r"stacking fault.*dislocations\(partials=True\)"):
        crystal.circuit.around((0, 0, period / 2), (0, 0, 1), 5)
    np.savez(tmp_path / "fault.npz", positions=places)
    words = ["crystal", str(tmp_path / "fault.npz"), "--cell", f"60,60,{period!r}"]
    assert "--partials" in run(*words, "--periodic", "z").stdout
    assert "--partials" not in run(*words, "--periodic", "z", "--partials").stdout

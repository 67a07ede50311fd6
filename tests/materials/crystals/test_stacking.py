"""Stacking: partial dislocations of hcp and its basal faults."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from geomtorsion.materials.crystals import Crystal
from geomtorsion.materials.crystals.reports import inserted_atoms
from geomtorsion.materials.lines.crystal_analysis import Cluster, crystal_analysis_text
from tests.chosen import one_in
from tests.materials.crystals.synthetic import basal_partials, frank_partials, stacked, vacancy_disc
from tests.materials.crystals.test_crystal import line_of

IDEAL = (8 / 3) ** 0.5
OPEN = (False, False, True)


def upwards(line):
    """b of a line in the sense of +z."""
    return np.sign(line.image[2]) * np.array(line.burgers, float)


def noisy(places, percent, seed=0):
    """Add Gaussian noise to each coordinate, in percent of the neighbour distance."""
    return places + percent / 100 * np.random.default_rng(seed).normal(size=places.shape)


# In percent of the neighbour distance: quick runs use the largest, slow runs all.
NOISE = [*(pytest.param(x, marks=pytest.mark.slow) for x in (0, 4)), 8]


@pytest.mark.parametrize(("line", "ratio"), one_in(3, ["edge", "screw"], [IDEAL, 1.623, 1.58]))
def test_a_basal_dislocation_is_two_partials(line, ratio):
    """Each partial is 1/3<1 -1 0 0> at its position, and their sum is the line without partials."""
    places, period, put_in = basal_partials(line, ratio=ratio)
    crystal = Crystal(places, [60, 60, period], OPEN)
    (whole,) = crystal.dislocations().lines
    assert (crystal.lattice, whole.family) == ("hcp", "1/3<1 1 -2 0>")
    parts = sorted(crystal.dislocations(partials=True).lines, key=lambda x: x.path[:, 0].mean())
    assert [(part.family, part.kind) for part in parts] == [("1/3<0 1 -1 0>", "periodic")] * 2
    for part, ((x, y), b) in zip(parts, put_in, strict=True):
        assert part.path[:, :2].mean(axis=0) == pytest.approx([x, y], abs=0.6)
        assert part.length == pytest.approx(period, rel=0.01)
        # b is minus the closed integral of du; a and c/a are estimated from strained atoms.
        assert upwards(part) == pytest.approx(-b, abs=0.01)
    # In fractions the sum is exact: it equals b of the one line and of a circuit around both.
    each = [int(np.sign(part.image[2])) * np.array(part.burgers_lattice) for part in parts]
    total = each[0] + each[1]
    assert {x.denominator for x in total} == {1}
    assert (total == int(np.sign(whole.image[2])) * np.array(whole.burgers_lattice)).all()
    assert tuple(total) == crystal.circuit.around([0, 0, 1], [0, 0, 1], 7).burgers_lattice


@pytest.mark.parametrize("percent", [pytest.param(4, marks=pytest.mark.slow), 8])
@pytest.mark.parametrize("line", ["edge", "screw"])
def test_noise_leaves_both_partials(line, percent):
    """Noise neither adds nor removes a partial, at wide and at narrow faults."""
    for width in (1.5, 4):
        places, period, put_in = basal_partials(line, width)
        crystal = Crystal(noisy(places, percent), [60, 60, period], OPEN)
        parts = crystal.dislocations(partials=True).lines
        parts = sorted(parts, key=lambda x: x.path[:, 0].mean())
        assert len(parts) == 2
        for part, (_, b) in zip(parts, put_in, strict=True):
            assert upwards(part) == pytest.approx(-b, abs=0.03)


@pytest.mark.parametrize(
    ("layers", "percent"),
    one_in(3, ["ABABABABABAB", "ABABABCACACA", "ABABABCBCBCB", "ABABABCBCBCBABABAB"], (0, 4, 8)),
)
def test_layers_that_end_nowhere_have_no_line(layers, percent):
    """No fault, I2, I1 and two I1 across the whole cell have no lines."""
    places, cell = stacked(layers)
    crystal = Crystal(noisy(places, percent), cell, (True, True, False))
    for partials in (False, True):
        assert crystal.dislocations(partials).lines == ()


@pytest.mark.parametrize("percent", NOISE)
def test_an_extrinsic_fault_has_no_line_and_no_grain(percent):
    """ABABCABAB: three cubic layers between good crystal on both sides."""
    places, cell = stacked("ABABABABCABABABAB")
    crystal = Crystal(noisy(places, percent), cell, (True, True, False))
    assert crystal.grains.is_single
    for partials in (False, True):
        assert crystal.dislocations(partials).lines == ()


@pytest.mark.parametrize(("line", "percent"), one_in(2, ["edge", "screw"], [0, 6]))
def test_a_layer_less_is_two_frank_partials(line, percent):
    """A fault of type I1 has 1/6<2 0 -2 3> at both ends, and no whole line."""
    places, period, ((_, b), _) = frank_partials(line)
    crystal = Crystal(noisy(places, percent), [60, 60, period], OPEN)
    assert crystal.dislocations().lines == ()
    parts = crystal.dislocations(partials=True).lines
    parts = sorted(parts, key=lambda x: x.path[:, 0].mean())
    assert [(part.family, part.kind) for part in parts] == [("1/6<0 2 -2 3>", "periodic")] * 2
    for part, sense in zip(parts, (1, -1), strict=True):
        assert upwards(part) == pytest.approx(sense * b, abs=0.03)
        assert part.path[:, 0].mean() == pytest.approx(-5 * sense, abs=2)


@pytest.mark.parametrize(
    ("burgers", "percent"), one_in(2, [(1, 0, 0), (0.5, 0.75**0.5, 0), (0, 0, IDEAL)], [0, 6])
)
def test_unsplit_dislocations_stay_one_line(burgers, percent):
    """Lines along c with b = a and b = c, which are not in a basal plane, do not split."""
    places, cell = line_of("hcp", burgers)
    crystal = Crystal(noisy(places, percent), cell, OPEN)
    (one,), (other,) = (crystal.dislocations(partials).lines for partials in (False, True))
    assert upwards(other) == pytest.approx(upwards(one), abs=1e-9)
    assert (other.family, other.kind) == (one.family, "periodic")


@given(
    noise=st.floats(0, 8), seed=st.integers(0, 2**32 - 1), line=st.sampled_from(["edge", "screw"])
)
@settings(max_examples=2, deadline=None)
def test_partials_do_not_depend_on_orientation(noise, seed, line):
    """A rotated, shifted, permuted or wrapped specimen has the same lines and no sum at nodes."""
    places, period, put_in = basal_partials(line)
    rng = np.random.default_rng(seed)
    vectors = np.diag([60, 60, period])
    places = noisy(places, noise, seed)
    wound = rng.integers(-2, 3, len(places))[:, None] * vectors[2]
    turn = Rotation.random(random_state=int(seed)).as_matrix()
    moved = (places + wound)[rng.permutation(len(places))] + rng.normal(size=3)
    net = Crystal(moved @ turn.T, vectors @ turn.T, OPEN).dislocations(partials=True)
    assert net.node_rule() == ()
    found = sorted((upwards(part) @ turn).round(1).tolist() for part in net.lines)
    assert found == sorted((-b).round(1).tolist() for _, b in put_in)


def test_ovito_names_the_partials():
    """OVITO calls both 1/3<1-100>: b = 1/sqrt(6) in its lattice constant, as for its own lines."""
    places, period, _ = basal_partials("edge")
    crystal = Crystal(places, [60, 60, period], OPEN)
    net = crystal.dislocations(partials=True)
    ratio = 2 * crystal.frame.lattice.units[2]
    matrix = crystal.constant * crystal.orient.T * np.sqrt([2, 2, 3 / 4 * ratio**2])
    cluster = Cluster("hcp", matrix, len(places))
    rows = crystal_analysis_text(net.arrays, net.polylines, [cluster]).splitlines()
    family = rows[rows.index("1/3<1-100>") + 1].split()
    kept = rows[rows.index("DISLOCATIONS 2") + 2].split()
    sizes = [np.linalg.norm([float(x) for x in b]) for b in (family, kept)]
    assert sizes == pytest.approx([6**-0.5] * 2, abs=1e-9)


@pytest.mark.parametrize("radius", [3, 5])
def test_a_frank_loop_encloses_the_vacancies(radius):
    """b . A of the one closed line is the number of missing atoms, within 1 %."""
    places, cell, missing = vacancy_disc(radius)
    crystal = Crystal(places, cell)
    assert crystal.dislocations().lines == ()
    (line,) = crystal.dislocations(partials=True).lines
    assert (line.family, line.kind) == ("1/6<0 2 -2 3>", "closed")
    assert inserted_atoms(line, crystal) == pytest.approx(-missing, rel=0.01)
    assert line.length == pytest.approx(2 * np.pi * radius, rel=0.05)


def test_a_cell_a_few_atoms_long_has_the_same_partials():
    """In a short cell an atom along the line is a neighbour of its own images."""
    places, period, put_in = basal_partials("screw", periods=2)
    crystal = Crystal(places, [60, 60, period], OPEN)
    parts = sorted(crystal.dislocations(partials=True).lines, key=lambda x: x.path[:, 0].mean())
    for part, (_, b) in zip(parts, put_in, strict=True):
        assert upwards(part) == pytest.approx(-b, abs=0.03)

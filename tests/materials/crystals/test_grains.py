"""Grains: synthetic polycrystals, their misorientations, walls and dislocation lines."""

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals import Crystal
from tests.materials.crystals.polycrystals import amorphous, bicrystal, filled, polycrystal, turned
from tests.materials.crystals.synthetic import block, with_line
from tests.materials.crystals.test_crystal import atoms_of

# Sigma 5: 36.87 degrees about [0 0 1].
SIGMA5 = np.array([[4, -3, 0], [3, 4, 0], [0, 0, 5]]) / 5
TURN = turned(30, (1, 2, 3))
OPEN = (False, False, False)


@cache
def ending_line():
    """A screw of bcc that ends at a wall: its atoms, and the crystal."""
    places, _, _ = bicrystal("bcc", TURN, (0, 0, 1), axis=2, size=(6, 6, 7))
    return places, Crystal(places)


def least_angle(one, other):
    """Misorientation of two cubic crystals in degrees, by the 24 rotations of scipy."""
    cube = Rotation.create_group("O").as_matrix()
    between = one.T @ other @ cube
    cosines = (np.trace(between, axis1=1, axis2=2) - 1) / 2
    return np.degrees(np.arccos(np.clip(cosines.max(), -1, 1)))


@pytest.mark.parametrize(
    ("lattice", "noise"),
    [
        pytest.param("fcc", 0, marks=pytest.mark.slow),
        # test_known_grains.py has three grains of bcc.
        pytest.param("bcc", 0, marks=pytest.mark.slow),
        ("fcc", 0.05),
        pytest.param("bcc", 0.05, marks=pytest.mark.slow),
    ],
)
def test_grains_of_a_polycrystal_have_known_orientations(lattice, noise):
    """Periodic Voronoi grains have the known atoms, orientations and misorientations at walls."""
    turns = [turned(0, (0, 0, 1)), TURN, turned(45, (1, 0, 0)), turned(40, (-1, 1, 3))]
    seeds = np.array([[2, 2, 2], [9, 8, 3], [3, 9, 9], [9, 2, 9.0]])
    constants = [1.0 if lattice == "fcc" else 0.8] * 4
    places, own = polycrystal([lattice] * 4, turns, seeds * 10 / 14, 10, constants)
    places = places + noise * 0.7 * np.random.default_rng(0).normal(size=places.shape)
    crystal = Crystal(places, [10.0] * 3)
    grains = crystal.grains
    assert (crystal.lattice, len(grains), grains.is_single) == (lattice, 4, False)
    assert np.concatenate([grain.atoms for grain in grains]).size == (grains.number >= 0).sum()
    made = []
    for grain in grains:
        counts = np.bincount(own[grain.atoms])
        made.append(int(counts.argmax()))
        assert counts.max() > 0.99 * counts.sum()
        # The mean orientation averages over many atoms, so noise changes it only a little.
        assert least_angle(grain.orient.T, turns[made[-1]]) < 0.3
    assert sorted(made) == [0, 1, 2, 3]
    assert {wall.grains for wall in grains.walls} == {(a, b) for b in range(4) for a in range(b)}
    for wall in grains.walls:
        one, other = (turns[made[k]] for k in wall.grains)
        assert wall.degrees == pytest.approx(least_angle(one, other), abs=0.3)
    assert sum(grains.shares.values()) == pytest.approx(1)
    assert crystal.dislocations().lines == ()


def test_the_misorientation_has_its_axis_in_the_standard_triangle():
    """Checked for Sigma 5 and for Sigma 3, the twin of fcc."""
    places, _, _ = bicrystal("fcc", SIGMA5, size=(5, 5, 4))
    (wall,) = Crystal(places).grains.walls
    assert wall.degrees == pytest.approx(36.87, abs=0.1)
    assert wall.axis == pytest.approx([0, 0, 1], abs=0.01)
    normal, twin = np.ones(3) / 3**0.5, turned(60, (1, 1, 1))
    sites = filled("fcc", np.eye(3), 5.5) - 0.117
    mirrored = sites @ twin.T
    places = np.concatenate([sites[sites @ normal < 1e-6], mirrored[mirrored @ normal > 1e-6]])
    (wall,) = Crystal(places).grains.walls
    assert wall.degrees == pytest.approx(60, abs=0.1)
    assert wall.axis == pytest.approx(normal, abs=0.01)


@pytest.mark.parametrize(
    ("lattice", "burgers", "family"),
    [
        ("fcc", (0.5, 0.5, 0), "1/2<1 1 0>"),
        pytest.param("bcc", (1, 0, 0), "<1 0 0>", marks=pytest.mark.slow),
    ],
)
def test_a_line_in_a_grain_comes_out_as_it_was_put_in(lattice, burgers, family):
    """An edge in one grain of a bicrystal, periodic along it, has the known b and position."""
    places, own, size = bicrystal(lattice, SIGMA5, burgers, size=(11, 8, 3))
    crystal = Crystal(places, [60, 60, size[2]], (False, False, True))
    (line,) = crystal.dislocations().lines
    assert (line.family, line.kind) == (family, "periodic")
    assert line.length == pytest.approx(size[2], rel=0.01)
    atoms = crystal.grains[line.grain or 0].atoms
    assert (own[atoms] == 0).mean() > 0.99
    b = np.sign(line.image[2]) * np.array(line.burgers, float)
    assert b == pytest.approx(-np.array(burgers), abs=0.01)
    assert line.path[:, 0].mean() == pytest.approx(-6.131, abs=0.6)


@pytest.mark.parametrize(
    ("lattice", "burgers"),
    [pytest.param("fcc", (0.5, 0.5, 0), marks=pytest.mark.slow), ("bcc", (0, 0, 1))],
)
def test_a_line_ends_at_the_wall(lattice, burgers):
    """The line runs from a free surface to the wall, through half of the specimen."""
    if lattice == "bcc":
        crystal = ending_line()[1]
    else:
        crystal = Crystal(bicrystal(lattice, TURN, burgers, axis=2, size=(6, 6, 7))[0])
    net = crystal.dislocations()
    (line,) = net.lines
    assert line.kind == "wall"
    ends = sorted(line.path[[0, -1], 2])
    assert ends == pytest.approx([-7, 0], abs=1.7)
    assert sorted(node["wall"] for node in line.ends) == [False, True]
    assert net.node_rule() == ()


def test_results_do_not_depend_on_position_and_numbering():
    """A rotated, moved and permuted specimen has the same grains, wall and line."""
    places, crystal = ending_line()
    order = np.random.default_rng(0).permutation(len(places))
    turn = Rotation.random(random_state=7).as_matrix()
    moved = Crystal((places[order] + 5) @ turn.T)
    (one,), (other,) = crystal.dislocations().lines, moved.dislocations().lines
    assert other.length == pytest.approx(one.length, rel=0.05)
    assert other.family == one.family
    sets = [{frozenset(grain.atoms.tolist()) for grain in crystal.grains}]
    sets += [{frozenset(order[grain.atoms].tolist()) for grain in moved.grains}]
    for atoms in sets[0]:
        # Rounding may decide whether an atom at a wall belongs to a grain.
        assert max(len(atoms & x) / len(atoms | x) for x in sets[1]) > 0.99
    angles = [x.grains.walls[0].degrees for x in (crystal, moved)]
    assert angles[0] == pytest.approx(angles[1], abs=0.1)


def test_circuits_stop_at_walls():
    """b is exact within a grain; a circuit through the wall is refused with grains and angle."""
    _, crystal = ending_line()
    (line,) = crystal.dislocations().lines
    circuit = crystal.circuit.around([0, 0, -4], [0, 0, 1], 4)
    assert abs(np.array(circuit.burgers, float)) == pytest.approx([0, 0, 1], abs=0.01)
    again = crystal.circuit(circuit.atoms)
    assert again.burgers == circuit.burgers
    assert (crystal.grains.number[list(circuit.atoms)] == line.grain).all()
    with pytest.raises(CrystalError, match=r"grain 0 .*grain 1, misoriented by (29\.9|30\.0)"):
        crystal.circuit.around([0, 0, 0], [1, 0, 0], 5)
    deep = [int(grain.atoms[len(grain.atoms) // 2]) for grain in crystal.grains]
    with pytest.raises(CrystalError, match="cannot cross the wall between them"):
        crystal.circuit([*deep, int(crystal.grains[0].atoms[7])])
    inside = [int(k) for k in crystal.grains.walls[0].atoms[:3]]
    with pytest.raises(CrystalError, match="in the wall between grains 0 and 1, misoriented"):
        crystal.circuit(inside)


def tilt_wall(n):
    """A symmetric tilt wall of bcc about [0 0 1] in the plane (1 n 0), periodic in it."""
    angle, period = np.arctan(1 / n), 2 * np.sqrt(1 + n * n)
    halves = []
    for sense in (1, -1):
        turn = turned(np.degrees(sense * angle), (0, 0, 1))
        sites = filled("bcc", np.eye(3), 24) - 0.117
        places = sites[(sites[:, 2] > -1e-6) & (sites[:, 2] < 4 - 1e-6)] @ turn.T
        inside = (places[:, 1] > -1e-6) & (places[:, 1] < period - 1e-6)
        # Atoms in the plane of the wall belong to the first half.
        inside &= (sense * places[:, 0] > -1e-6 * sense) & (np.abs(places[:, 0]) < 15)
        halves.append(places[inside])
    return np.concatenate(halves), [60, period, 4], 2 * np.degrees(angle)


def test_low_angle_walls_are_their_dislocations():
    """A wall below 15 degrees is a row of lines in one crystal; a wall above separates grains."""
    crystal = Crystal(*atoms_of("w_tilt_gb"))
    assert crystal.grains.is_single
    assert [line.family for line in crystal.dislocations().lines] == ["<1 0 0>"] * 4
    for n, count in ((8, 1), (7, 2)):
        places, cell, angle = tilt_wall(n)
        crystal = Crystal(places, cell, (False, True, True))
        lines = crystal.dislocations().lines
        assert len(crystal.grains) == count, angle
        if count == 1:
            # The number of lines is 2 sin(angle / 2) times the length of the wall.
            assert [line.family for line in lines] == ["<1 0 0>"] * 4
        else:
            (wall,) = crystal.grains.walls
            assert wall.degrees == pytest.approx(angle, abs=0.1)
            assert lines == ()


@pytest.mark.parametrize(
    ("lattice", "constant"),
    [
        pytest.param("bcc", 0.8, marks=pytest.mark.slow),
        # This hcp has as many neighbours at the same distance as the fcc lattice around it.
        ("hcp", 0.707),
        pytest.param("diamond", 1.5, marks=pytest.mark.slow),
    ],
)
def test_phases_have_their_shares(lattice, constant):
    """A ball of another lattice in fcc is a grain with its own share."""
    around = filled("fcc", np.eye(3), 9)
    ball = filled(lattice, turned(20, (1, 2, 0)), 5, constant)
    sizes = np.linalg.norm(around, axis=1)
    places = np.concatenate([around[sizes > 5.5], ball])
    grains = Crystal(places).grains
    assert [grain.lattice for grain in grains] == ["fcc", lattice]
    assert grains.shares[lattice] == pytest.approx(len(ball) / len(places), rel=0.15)
    assert np.abs(grains[1].centre).max() < 0.3
    (wall,) = grains.walls
    assert (wall.angle, wall.description) == (None, "of different lattices")


def test_a_region_without_a_lattice_is_reported():
    """A ball of glass in fcc has a share and no line; a specimen of only glass is refused."""
    glass = amorphous(10, 4.0)
    ball = glass[np.linalg.norm(glass, axis=1) < 4.6]
    around = filled("fcc", np.eye(3), 6.8)
    places = np.concatenate([around[np.linalg.norm(around, axis=1) > 5.0], ball])
    crystal = Crystal(places)
    assert crystal.lattice == "fcc"
    # Atoms in the crystal layer next to the glass also lack neighbours.
    with_layer = (np.linalg.norm(places, axis=1) < 5.8).sum()
    assert len(ball) < crystal.grains.shares["none"] * len(places) < with_layer
    assert crystal.dislocations().lines == ()
    with pytest.raises(CrystalError, match="as in a liquid"):
        Crystal(glass, [10.0] * 3).dislocations()


def test_a_single_crystal_is_one_grain():
    """Vacancies, faults, noise, lines and surfaces add no grain."""
    places, cell = with_line("bcc", (1, 0, 0))
    crystal = Crystal(places, cell, (False, False, True))
    assert (repr(crystal.grains), crystal.grains.walls) == ("Grains(1 grain: bcc 100.0%)", ())
    assert crystal.grains[0].frame is crystal.frame
    (line,) = crystal.dislocations().lines
    assert line.grain is None
    fault = Crystal(*atoms_of("al_edge_dipole_relax"))
    assert fault.grains.is_single
    places, cell = block("fcc", (8, 8, 8))
    shaken = places + 0.12 * 0.7 * np.random.default_rng(0).normal(size=places.shape)
    assert Crystal(shaken, cell).grains.is_single


def test_a_grain_is_a_crystal_of_its_own():
    """`crystal.grain` returns the atoms in the grain's frame; wrong grain numbers are refused."""
    places, _, _ = bicrystal("fcc", SIGMA5, size=(5, 5, 4))
    crystal = Crystal(places, species=["Cu"] * len(places))
    grains = crystal.grains
    part = crystal.grain(1)
    assert np.array_equal(part.positions, places[grains[1].atoms])
    assert np.array_equal(part.orient, grains[1].orient)
    assert part.grains.is_single
    assert part.share > 0.5
    assert grains.wall(1, 0) is grains.walls[0]
    with pytest.raises(CrystalError, match="expected two different grains, got grain 0 twice"):
        grains.wall(0, 0)
    with pytest.raises(CrystalError, match="expected the number of a grain"):
        crystal.grain(2)


def test_a_small_grain_is_found():
    """A turned cylinder in a periodic sheet, with less than a quarter of its atoms, is a grain."""
    places, cell = block("fcc", (16, 8, 4))
    inside = np.hypot(*(places - cell / 2)[:, :2].T) < 2.9
    middle = (places - cell / 2) @ turned(37, [0, 0, 1]).T + cell / 2
    both = np.concatenate([places[~inside], middle[inside]])
    assert inside.mean() < 0.25
    grains = Crystal(both, cell, (True, True, False)).grains
    assert [len(grains), len(grains.walls)] == [2, 1]
    assert grains.walls[0].degrees == pytest.approx(37, abs=0.5)

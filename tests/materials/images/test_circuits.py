"""Circuits: b is exact in whole numbers, or the image is refused."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportArgumentType=false

from functools import cache
from itertools import product

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ImageError, LoopError
from tests.chosen import one_in
from tests.materials.images.atoms import crystal

made = cache(crystal)
SIZES, KINDS = (256, 512), ("square", "hexagonal")
CASES = list(product(SIZES, KINDS))


def truth(image, phases: gt.materials.images.LatticePhases) -> list[int]:
    """Minus b_0 in lattice vectors."""
    return (-np.rint(phases.spots @ image.b)).astype(int).tolist()


@pytest.mark.parametrize(("level", "size", "kind"), one_in(2, (0, 1, 2), SIZES, KINDS))
def test_whole_numbers_are_exact_up_to_twice_the_peak_of_an_atom(size, kind, level):
    """Six noisy images of six give the exact b with automatically found spots."""
    image = made(size, kind)
    circuit = gt.Loop.circle(image.centre, 0.3 * size)
    for seed in range(6 if level else 1):
        phases = gt.LatticeImage(image.noisy(level, seed)).phases()
        b = phases.burgers(circuit)
        assert b.whole.tolist() == truth(image, phases) != [0, 0]
        assert b.whole.dtype.kind == "i"
        assert b.chance < 0.05


@pytest.mark.parametrize("kind", ["square", "hexagonal"])
@pytest.mark.parametrize("level", [3, 4, 5, 7])
def test_noisy_images_give_no_wrong_circuit(kind, level):
    """With given spots, each reported b is right; the other images are refused.

    At five times the peak or more, all images are refused.
    """
    image = made(256, kind)
    circuit = gt.Loop.circle(image.centre, 0.15 * 256)
    told = 0
    for seed in range(12):
        phases = gt.LatticeImage(image.noisy(level, seed)).phases(image.vectors)
        try:
            found = phases.burgers(circuit)
        except ImageError as error:
            assert "hole" in str(error) or "noise is too strong" in str(error)  # noqa: PT017
            continue
        told += 1
        assert found.whole.tolist() == truth(image, phases)
    assert told == 0 or level < 5


def test_the_reported_chance_is_not_too_small():
    """In strong noise there are at most as many wrong circuits as the sum of reported chances."""
    image = made(256, "hexagonal")
    circuit = gt.Loop.circle(image.centre, 0.15 * 256)
    told, wrong = [], 0
    for seed in range(40):
        phases = gt.LatticeImage(image.noisy(5, seed)).phases(image.vectors)
        try:
            found = phases.burgers(circuit, risk=1)
        except ImageError:
            continue
        told.append(found.chance)
        wrong += found.whole.tolist() != truth(image, phases)
    assert len(told) > 10
    assert 1 <= wrong <= sum(told)


def test_circuits_follow_the_signs_of_the_house():
    """b is minus the integral of du; a reversed loop has -b and a double loop 2 b."""
    y, x = np.mgrid[199:-1:-1, 0:200] - 99.6
    # u_x = 8 / (2 pi) times the angle: b_0 = 8 along x, one period of the first wave.
    waves = np.cos(2 * np.pi * x / 8 - np.arctan2(y, x)) + np.cos(2 * np.pi * y / 7)
    phases = gt.LatticeImage(waves, step=0.5, unit="nm").phases()
    circuit = gt.Loop.circle([49.8, 49.8], 25)
    b = phases.burgers(circuit)
    assert b.whole.tolist() == [-1, 0]
    assert b.vector == pytest.approx([-4, 0], abs=0.02)
    assert abs(b.vector - [-4, 0]).max() <= b.error
    assert b.in_convention("integral of du") == pytest.approx([4, 0], abs=0.02)
    assert phases.burgers(circuit.reversed()).whole.tolist() == [1, 0]
    assert phases.burgers(circuit.times(2)).whole.tolist() == [-2, 0]
    outside = gt.Loop.polygon([[10, 10], [40, 10], [40, 40], [10, 40]])
    assert phases.burgers(outside).whole.tolist() == [0, 0]


def test_a_circuit_is_the_sum_of_its_squares_and_of_its_steps():
    """Stokes' theorem holds exactly: residues, cochain and path give the same whole numbers."""
    image = made(256, "square")
    phases = gt.LatticeImage(image.noisy(1, 0)[64:192, 64:192]).phases(image.vectors)
    square = gt.Loop.polygon([[20, 20], [100, 20], [100, 100], [20, 100]])
    b = phases.burgers(square)
    assert b.whole.tolist() == truth(image, phases)
    assert phases.residues[:, 20:100, 20:100].sum(axis=(1, 2)).tolist() == b.whole.tolist()
    labels = np.ravel_multi_index(tuple(b.pixels.T), (128, 128))
    cochain = phases.cochain
    assert cochain.is_whole
    assert cochain.around(labels.tolist()).vector.tolist() == b.whole.tolist()
    faces = cochain.coboundary().values.T.reshape(2, 127, 127)
    assert (faces == phases.residues).all()


def test_two_dislocations_add_up():
    """b of a circuit around both dislocations is the sum of b around each."""
    y, x = np.mgrid[255:-1:-1, 0:256] - 127.5
    one, two = np.arctan2(y, x - 40), np.arctan2(y, x + 40)
    waves = np.cos(2 * np.pi * x / 8 - one) + np.cos(2 * np.pi * y / 8 + 2 * two)
    phases = gt.LatticeImage(waves).phases()
    right, left = (gt.Loop.circle([127.5 + k, 127.5], 30) for k in (40, -40))
    both = gt.Loop.ellipse([127.5, 127.5], [100, 60])
    assert phases.burgers(right).whole.tolist() == [-1, 0]
    assert phases.burgers(left).whole.tolist() == [0, 2]
    assert phases.burgers(both).whole.tolist() == [-1, 2]


def test_a_circuit_through_a_hole_is_refused():
    """A circuit through a core or an empty region is refused; a circuit around the core is not."""
    image = made(256, "square")
    values = image.values.copy()
    values[140:200, 30:90] = 0
    phases = gt.LatticeImage(values).phases()
    with pytest.raises(ImageError, match=r"crosses a hole at \(.*circuit around the hole"):
        phases.burgers(gt.Loop.circle([60, 60], 20))
    through_core = gt.Loop.circle([image.centre[0] - 30, image.centre[1]], 30)
    with pytest.raises(ImageError, match=r"crosses a hole at \(12[78]"):
        phases.burgers(through_core)
    assert phases.burgers(gt.Loop.circle(image.centre, 110)).whole.tolist() == truth(image, phases)


def test_spots_where_there_is_no_lattice_give_no_number():
    """Given spots that the image lacks lead to a hole or to noise, not to a whole number."""
    image = made(256, "square")
    noise = np.random.default_rng(0).normal(size=(256, 256))
    circuit = gt.Loop.circle(image.centre, 77)
    for values, spots in (
        (noise, [[0.125, 0], [0, 0.125]]),
        (image.noisy(1, 0), [[0.3, 0.1], [0.1, 0.3]]),
    ):
        with pytest.raises(ImageError, match="hole|noise is too strong"):
            gt.LatticeImage(values).phases(spots).burgers(circuit)


def test_invalid_circuits_are_refused():
    """A loop outside the image, a tiny, too long or spatial loop, and a bad risk are refused."""
    phases = gt.LatticeImage(made(256, "square").values).phases()
    with pytest.raises(ImageError, match=r"leaves the image at .* 0 to 255 in x"):
        phases.burgers(gt.Loop.circle([200, 128], 60))
    with pytest.raises(ImageError, match="expected a circuit that encloses pixels"):
        phases.burgers(gt.Loop.circle([100, 100], 0.3))
    with pytest.raises(ImageError, match="with fewer turns"):
        phases.burgers(gt.Loop.circle([128, 128], 60).times(10**9))
    with pytest.raises(LoopError, match="expected two coordinates, x and y of the image, got 3"):
        phases.burgers(gt.Loop.circle([128, 128, 0], 60))
    with pytest.raises(gt.errors.ArgumentError, match="loop: expected a Loop"):
        phases.burgers([[0, 0], [1, 1]])
    with pytest.raises(ImageError, match="risk: expected a positive number"):
        phases.burgers(gt.Loop.circle([128, 128], 60), risk=-1)

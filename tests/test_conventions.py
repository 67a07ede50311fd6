"""Signs: a textbook edge and screw of atoms, evaluated by the recipe of each convention."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.conventions import BURGERS, burgers
from geomtorsion.errors import ArgumentError, UnknownNameError
from geomtorsion.loops import Cochain, Loop, burgers_vector, exact_burgers_vector
from geomtorsion.loops.cochain import CycleBurgers
from geomtorsion.materials.fields import SampledFrame
from tests.real import real

NU = 0.3


def displacement(kind: str, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Hirth and Lothe, equations (3-1) and (3-45) with b = 1: from perfect to real positions.

    The line is along z, angles run from 0 to 2 pi; returns shape (3, k).
    """
    angle = np.arctan2(y, x) % (2 * np.pi)
    square, zero = x**2 + y**2, np.zeros_like(x)
    if kind == "screw":
        return np.stack([zero, zero, angle / (2 * np.pi)])
    across = (angle + x * y / (2 * (1 - NU) * square)) / (2 * np.pi)
    up = (1 - 2 * NU) / (4 * (1 - NU)) * np.log(square)
    up = -(up + (x**2 - y**2) / (4 * (1 - NU) * square)) / (2 * np.pi)
    return np.stack([across, up, zero])


@pytest.fixture(scope="module")
def crystals() -> dict[str, np.ndarray]:
    """Real positions of the atoms of a simple cubic crystal with one line, shape (3, atoms)."""
    line = np.arange(-12, 12) + 0.5
    heights = np.arange(-3, 4.0)
    x, y, z = (a.ravel() for a in np.meshgrid(line, line, heights, indexing="ij"))
    return {kind: np.stack([x, y, z]) + displacement(kind, x, y) for kind in ("edge", "screw")}


def circuit(atoms: np.ndarray, turns: int) -> CycleBurgers:
    """Circuit from atom to atom that closes in the sample, around +z if turns = 1, else around -z.

    The image of each step is the nearest lattice vector.
    """
    sides = [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)]
    if turns < 0:
        # The same square in the opposite sense.
        sides = [(0, 1, 0), (1, 0, 0), (0, -1, 0), (-1, 0, 0)]

    def nearest(place: np.ndarray) -> int:
        return int(((atoms - place[:, None]) ** 2).sum(axis=0).argmin())

    start = nearest(np.array([-5.5, -5.5, 0.0]))
    path = [start]
    for side in sides:
        for _ in range(11):
            path.append(nearest(atoms[:, path[-1]] + side))
    # The rest of the way to the start, one lattice step at a time.
    while True:
        rest = np.rint(atoms[:, start] - atoms[:, path[-1]]).astype(int)
        if not rest.any():
            break
        step = np.zeros(3)
        axis = int(np.abs(rest).argmax())
        step[axis] = np.sign(rest[axis])
        path.append(nearest(atoms[:, path[-1]] + step))
    assert path[-1] == start
    nodes = list(dict.fromkeys(path))
    number = {atom: k for k, atom in enumerate(nodes)}
    pairs = [(number[a], number[b]) for a, b in pairwise(path)]
    images = [np.rint(atoms[:, b] - atoms[:, a]).astype(int) for a, b in pairwise(path)]
    steps = Cochain.of_edges(pairs, images, labels=nodes)
    assert steps.is_whole
    return steps.around(path)


# The textbook's b: a right-handed screw along its sense, an edge with its half plane above.
TEXTBOOK = {"screw": [0, 0, 1], "edge": [1, 0, 0]}


@pytest.mark.parametrize("kind", ["edge", "screw"])
def test_each_convention_by_its_own_recipe(crystals: dict[str, np.ndarray], kind: str) -> None:
    """Circuits of both senses on atoms give each convention's b, and so does the integral of du."""
    right, left = circuit(crystals[kind], 1), circuit(crystals[kind], -1)
    from_start = right.vector
    assert from_start.tolist() == right.in_convention("SF/RH").tolist()
    assert (-from_start).tolist() == right.in_convention("FS/RH").tolist()
    assert left.vector.tolist() == right.in_convention("LH/SF").tolist()
    assert (-left.vector).tolist() == right.in_convention("FS/LH").tolist()
    angle = np.linspace(0, 2 * np.pi, 1001)[1:-1]
    u = displacement(kind, 5 * np.cos(angle), 5 * np.sin(angle))
    jump = u[:, -1] - u[:, 0]
    assert jump == pytest.approx(right.in_convention("Hirth-Lothe"), abs=5e-3)
    for name in ("FS/RH", "LH/SF", "Hirth-Lothe", "integral of du"):
        assert right.in_convention(name).tolist() == TEXTBOOK[kind]


@pytest.mark.parametrize("name", ["w_screw111", "w_edge100", "cu_edge110", "w_screw111_relax"])
def test_answers_of_ovito(name: str) -> None:
    """Lines made by displacements have the Burgers vector that OVITO's extraction found."""
    truth = json.loads(real("crystal/truth.json").read_text("utf-8"))[name]
    put_in = np.array(truth["b_cart"]) * np.sign(truth["line"][2])
    (found,) = truth["dxa"]["segs"]
    sense = np.sign(found["p1"][2] - found["p0"][2])
    here = gt.conventions.burgers(put_in, "integral of du")
    answer = sense * np.array(found["b_spatial"])
    assert answer == pytest.approx(gt.conventions.burgers(here, "OVITO"), abs=2e-3)
    assert np.linalg.norm(answer) > 2


def test_the_extra_half_plane_follows_the_convention(crystals: dict[str, np.ndarray]) -> None:
    """With FS/RH the half along sense x b, the upper half here, has one more column of atoms."""
    atoms = crystals["edge"]
    b = circuit(atoms, 1).in_convention("FS/RH")
    assert np.cross([0, 0, 1], b).tolist() == [0, 1, 0]
    layer = np.abs(atoms[2]) < 0.5
    inside = layer & (np.abs(atoms[0]) < 6.2)
    above = np.count_nonzero(inside & (np.abs(atoms[1] - 5.3) < 0.5))
    below = np.count_nonzero(inside & (np.abs(atoms[1] + 5.7) < 0.5))
    assert above == below + 1


@pytest.mark.parametrize("kind", ["edge", "screw"])
def test_frames_agree_with_atoms(kind: str) -> None:
    """e = dx - du of the textbook field gives its b; shipped frames have the opposite sign of u."""
    x, y, z, b = *sp.symbols("x y z", real=True), sp.Symbol("b", positive=True)
    row = 2 if kind == "screw" else 0
    rows = [[sp.Integer(int(i == j)) for j in range(3)] for i in range(3)]
    rows[row][0] += b * y / (2 * sp.pi * (x**2 + y**2))
    rows[row][1] -= b * x / (2 * sp.pi * (x**2 + y**2))
    frame = gt.Frame([x, y, z], rows)
    loop = Loop.circle([0, 0, 0], 2)
    found = burgers_vector(frame, loop, parameters={"b": 1})
    assert found.in_convention("Hirth-Lothe") == pytest.approx(TEXTBOOK[kind], abs=1e-12)
    exact = exact_burgers_vector(frame, loop)
    assert exact.in_convention("FS/RH") == tuple(b * k for k in TEXTBOOK[kind])
    shipped = gt.spaces.load(f"{kind}_dislocation").frame
    same = burgers_vector(shipped, loop, parameters={"b": 1})
    assert same.in_convention("SF/RH") == pytest.approx(TEXTBOOK[kind], abs=1e-12)


@pytest.mark.parametrize("window", [1, 3])
def test_the_weighted_burgers_vector_of_a_bent_crystal(window: int) -> None:
    """Wheeler's integral as in MTEX: x and y in the crystal, counterclockwise, per area."""
    step, size = 0.01, 41
    line = step * (np.arange(size) - size // 2)
    x, y = np.meshgrid(line, line, indexing="ij")
    turned = 0.7 * x - 0.4 * y + 0.3 * x * y
    # From crystal to specimen: a rotation about z; its inverse takes specimen to crystal.
    c, s = np.cos(turned), np.sin(turned)
    one, zero = np.ones_like(c), np.zeros_like(c)
    crystal = np.array([[c, s, zero], [-s, c, zero], [zero, zero, one]])
    weights = np.ones(2 * window + 1)
    weights[[0, -1]] = 0.5
    middle = size // 2
    part = slice(middle - window, middle + window + 1)
    low, high = middle - window, middle + window
    along_x, along_y = crystal[:, 0], crystal[:, 1]
    total = (
        along_x[:, part, low] @ weights
        - along_x[:, part, high] @ weights
        + along_y[:, high, part] @ weights
        - along_y[:, low, part] @ weights
    )
    weighted = total / (4 * window**2 * step)
    grid = SampledFrame([line, line], crystal[:, :2], order=4)
    reach = window * step
    square = Loop.polygon([[-reach, -reach], [reach, -reach], [reach, reach], [-reach, reach]])
    b = grid.burgers(square)
    assert b.in_convention("MTEX") / (2 * reach) ** 2 == pytest.approx(weighted, abs=1e-3)
    # Its gradient form: the last column of the Nye tensor, Burgers vector first.
    assert grid.nye[:, 0, middle, middle] == pytest.approx(weighted, abs=2e-3)
    assert np.abs(weighted[:2]).min() > 0.3


def test_the_nye_tensor_has_the_burgers_vector_first() -> None:
    """Screws along x with b along x, edges along z with b along y: alpha^{ik} n_k is b per area."""
    lines = [np.linspace(0, 1, 9)] * 3
    x, y, _ = np.meshgrid(*lines, indexing="ij")
    beta = np.zeros((3, 3, *x.shape))
    beta[0, 2] = 0.5 * y
    beta[1, 1] = 0.25 * x
    grid = SampledFrame.from_distortion(lines, beta)
    alpha = grid.nye[:, :, 4, 4, 4]
    expected = np.zeros((3, 3))
    expected[0, 0], expected[1, 2] = 0.5, 0.25
    assert alpha == pytest.approx(expected, abs=1e-12)
    tilted = Loop.polygon([[0.2, 0.2, 0.2], [0.6, 0.2, 0.2], [0.6, 0.6, 0.2], [0.2, 0.6, 0.2]])
    assert grid.burgers(tilted).vector == pytest.approx(alpha @ [0, 0, 0.16], abs=1e-12)


def test_conversions_are_their_own_inverse_and_names_are_known() -> None:
    """Names are unique, each conversion is its own inverse, and an unknown name lists the known."""
    names = [name for one in BURGERS for name in one.names]
    assert len(names) == len(set(names)) > 10
    for name in names:
        assert burgers(burgers([1, -2, 3], name), name).tolist() == [1, -2, 3]
    with pytest.raises(UnknownNameError, match="a known name, got 'FS-RH'. .*FS/RH"):
        gt.conventions.burgers([1], "FS-RH")
    for wrong in ("abc", ["a"], None):
        with pytest.raises(ArgumentError, match="vector: "):
            burgers(wrong, "FS/RH")  # type: ignore[arg-type]

"""Crystals: lattice, labels, torsion and dislocation lines of atoms."""

import json
from fractions import Fraction

import numpy as np
import pytest

from geomtorsion.crystals import Crystal
from tests.real import real

TRUTH = "crystal/truth.json"
NAMES = (
    "w_perfect",
    "cu_perfect",
    "w_vac1pct",
    "w_noise05",
    "cu_noise08",
    "w_screw111",
    "w_screw111_relax",
    "w_edge100",
    "w_screw_quadrupole_relax",
    "cu_edge110",
    "cu_edge110_relax",
    "al_edge_dipole",
    "al_edge_dipole_relax",
    "w_tilt_gb",
)


def atoms_of(name):
    """Positions, cell and periodicity of a shared file."""
    path = real(f"crystal/{name}.xyz")
    ase_io = pytest.importorskip("ase.io")
    found = ase_io.read(path)
    return found.get_positions(), found.cell.array, found.pbc.tolist()


@pytest.mark.parametrize("name", NAMES)
def test_shared_files_give_their_lines(name):
    """Number, family, length and sum of the lines are those that were put in."""
    truth = json.loads(real(TRUTH).read_text())[name]
    crystal = Crystal(*atoms_of(name))
    assert crystal.lattice == truth["structure"]
    # A cell under strain, or with noise, has another mean lattice constant.
    assert crystal.constant == pytest.approx(truth["a"], rel=0.01)
    net = crystal.dislocations()
    assert len(net.lines) == truth["nlines"]
    assert net.node_rule() == ()
    if truth["nlines"]:
        total = sum(line.length for line in net.lines)
        assert total == pytest.approx(truth["length"], rel=0.03)
        size = sorted(abs(Fraction(x)) for x in truth["b_lattice"])
        for line in net.lines:
            assert sorted(map(abs, line.burgers_lattice)) == size
            assert line.kind == "periodic"
            assert np.linalg.norm(np.array(line.burgers, float)) == pytest.approx(
                np.linalg.norm(truth["b_cart"]), rel=0.01
            )
    if name == "al_edge_dipole":
        assert net.nye == pytest.approx(np.zeros((3, 3)), abs=1e-9)


def test_torsion_has_no_boundary_in_cores_either():
    """d d = 0 on every tetrahedron."""
    crystal = Crystal(*atoms_of("w_screw111"), lattice="bcc")
    torsion = crystal.torsion
    mesh = torsion.mesh
    values = dict(zip(map(tuple, np.sort(mesh.faces[0], axis=1)), torsion.values, strict=True))
    assert len(values) == len(mesh.faces[0])
    assert torsion.values.any()
    edge_of = {pair: k for k, pair in enumerate([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])}
    total = np.zeros((len(mesh.corners), 3), dtype=int)
    for corner in range(4):
        face = [k for k in range(4) if k != corner]
        a, b, c = ((face[0], face[1]), (face[0], face[2]), (face[1], face[2]))
        rows = np.sort(mesh.edges[2][:, [edge_of[a], edge_of[b], edge_of[c]]], axis=1)
        total += (-1) ** corner * np.array([values[tuple(row)] for row in rows])
    assert not total.any()


def test_a_prismatic_loop_is_one_closed_line():
    """One line that ends where it begins, in its plane."""
    net = Crystal(*atoms_of("w_vac_loop111")).dislocations()
    (line,) = net.lines
    assert line.is_closed
    assert line.family == "1/2<1 1 1>"
    assert net.nye == pytest.approx(np.zeros((3, 3)), abs=1e-9)


def test_the_sign_is_that_of_the_conventions():
    """b = closed integral of e is minus the closed integral of du."""
    truth = json.loads(real(TRUTH).read_text())["cu_edge110"]
    (line,) = Crystal(*atoms_of("cu_edge110")).dislocations().lines
    along = np.sign(line.image[2])
    b = along * np.array(line.burgers, float)
    assert b == pytest.approx(-np.array(truth["b_cart"]), abs=0.01)
    assert b == pytest.approx(np.array(truth["dxa"]["segs"][0]["b_spatial"]), abs=0.01)

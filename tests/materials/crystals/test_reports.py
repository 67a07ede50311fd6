"""Reports: atoms enclosed by closed lines, and lines that keep their numbers in time."""

import json

import numpy as np
import pytest

from geomtorsion.materials.crystals import Crystal, read
from geomtorsion.materials.crystals.reports import crystal_report, followed, tracks
from tests.materials.crystals.making import BOX, copper_screw
from tests.materials.crystals.polycrystals import filled, turned
from tests.materials.crystals.synthetic import interstitial_loop
from tests.real import real


def line(b: str, place: float, turned: bool = False) -> dict:
    """A straight line along z of a report; if reversed, b has the opposite sign."""
    path = [[place, 1.0, z] for z in (0.0, 2.0, 4.0)]
    exact = b.split()
    if turned:
        path, exact = (
            path[::-1],
            [x[1:] if x[0] == "-" else f"-{x}" if x != "0" else x for x in exact],
        )
    return {"burgers_lattice": exact, "burgers": [1.0, 2.0, 0.0], "path": path}


def frame(*lines: dict) -> dict:
    """A report of these lines in a periodic cell."""
    cell = [[20.0, 0, 0], [0, 20.0, 0], [0, 0, 4.0]]
    return {"lines": list(lines), "cell": cell, "periodic": [True, True, True]}


def test_lines_keep_their_numbers():
    """Lines keep their numbers when they move across a cell face, change order or are reversed."""
    one, two, other = line("1/2 1/2 0", 3), line("1/2 1/2 0", 12), line("0 0 1", 4)
    later = [
        line("1/2 1/2 0", 13.5, turned=True), line("0 0 1", 2), line("1/2 1/2 0", 19.5),
    ]  # fmt: skip
    assert tracks([frame(one, two, other), frame(*later)]) == [[0, 1, 2], [1, 2, 0]]


def test_b_of_a_track_is_one_vector():
    """A line found in the opposite sense is reversed, with its path and both forms of its b."""
    one = line("1/2 -1/2 0", 3)
    first, second = followed([frame(one), frame(line("1/2 -1/2 0", 3.5, turned=True))])
    assert first["lines"] == [{"track": 0, **one}]
    (later,) = second["lines"]
    assert later["burgers_lattice"] == one["burgers_lattice"]
    assert later["burgers"] == [-1.0, -2.0, 0.0]
    assert later["path"] == line("1/2 -1/2 0", 3.5)["path"]


def test_lines_begin_and_end():
    """A line with another b is a new line, and each number is used only once."""
    first, second = line("1/2 1/2 0", 3), line("1/2 -1/2 0", 3)
    assert tracks([frame(first), frame(second), frame(second, first), frame()]) == [
        [0], [1], [1, 2], [],
    ]  # fmt: skip
    assert tracks([]) == []


def test_a_report_is_plain_data():
    """A report survives JSON unchanged, and its b equals the network's b."""
    crystal = Crystal(copper_screw(), BOX, (False, False, True), "fcc")
    net = crystal.dislocations()
    found = crystal_report(crystal, net)
    assert json.loads(json.dumps(found)) == found
    (one,) = found["lines"]
    assert one["burgers"] == list(net.lines[0].burgers)
    assert one["burgers_lattice"] == [str(x) for x in net.lines[0].burgers_lattice or ()]
    assert found["lattice"] == "fcc"


def test_lines_of_a_crystal_come_back_from_vtk(tmp_path):
    """meshio reads points, lines and b bit for bit as they were written."""
    meshio = pytest.importorskip("meshio")
    net = Crystal(copper_screw(), BOX, (False, False, True), "fcc").dislocations()
    net.save(tmp_path / "lines.vtk")
    mesh = meshio.read(tmp_path / "lines.vtk")
    ((one,), (line,), (pieces,)) = net.polylines, net.lines, mesh.cells
    assert pieces.type == "line"
    assert np.array_equal(mesh.points, one.points)
    assert pieces.data.tolist() == [[k, k + 1] for k in range(len(one.points) - 1)]
    assert mesh.cell_data["line"][0].ravel().tolist() == [0] * len(pieces.data)
    assert mesh.cell_data["burgers"][0].tolist() == [list(line.burgers)] * len(pieces.data)


def test_a_loop_of_vacancies_encloses_vacancies():
    """b . A over the volume of an atom is the number of removed atoms, within one percent."""
    crystal = read(real("crystal/w_vac_loop111.xyz"))
    assert crystal.cell is not None
    (one,) = crystal_report(crystal, crystal.dislocations())["lines"]
    # The perfect crystal in this cell has 9,408 atoms.
    missing = len(crystal.positions) - 9408
    assert missing == -109
    assert one["inserted"] == pytest.approx(missing, rel=0.01)
    assert one["kind"] == "closed"


# test_crystal.py and test_enclosed.py have further loops.
COUNTED = [
    pytest.param(radius, periodic, marks=() if sharp else pytest.mark.slow)
    for radius, periodic, sharp in (
        (3, (True, True, True), False),
        (5, (True, True, True), True),
        (3, (True, True, False), False),
        (5, (True, True, False), True),
        (3, (False, False, False), True),
        (5, (False, False, False), False),
    )
]


@pytest.mark.parametrize(("radius", "periodic"), COUNTED)
def test_atoms_of_a_loop_are_counted(radius, periodic):
    """The count is exact with zero error, in periodic and in open boxes."""
    places, cell, put_in = interstitial_loop(radius)
    crystal = Crystal(places, cell, periodic)
    (one,) = crystal_report(crystal, crystal.dislocations())["lines"]
    assert one["kind"] == "closed"
    assert one["inserted"] == pytest.approx(put_in, rel=1e-9)
    assert one["inserted_error"] == 0.0


def test_atoms_of_a_loop_are_counted_in_its_own_grain():
    """The count uses the volume of an atom in the loop's own grain, not in grain 0."""
    places, _, put_in = interstitial_loop(3)
    other = filled("bcc", turned(30, [1, 1, 1]), 12, 1.3)
    other = other - other.min(axis=0) + [places[:, 0].max() + 3, 0, 0]
    both = np.concatenate([places, other])
    crystal = Crystal(both)
    assert crystal.constant == pytest.approx(1.3)
    (one,) = crystal_report(crystal, crystal.dislocations())["lines"]
    assert (one["grain"], one["inserted_error"]) == (1, 0.0)
    assert one["inserted"] == pytest.approx(put_in, rel=1e-9)

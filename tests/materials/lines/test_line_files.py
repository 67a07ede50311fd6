"""Line files: networks in other formats read back, and other programs read them."""

# The tests pass what users pass, including wrong types.
# pyright: reportArgumentType=false, reportOptionalMemberAccess=false

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from geomtorsion.errors import ArgumentError, FileFormatError, NetworkError
from geomtorsion.materials.lines import Box, DislocationNetwork, LineArrays
from tests.materials.lines.synthetic_networks import rings, straight
from tests.rounding import ROUNDED

BOX = Box.of_bounds([0, 0, 0], [8, 8, 8])


def junctions() -> DislocationNetwork:
    """Two junctions joined by three lines of whole and half b, one across a face of the box."""
    places = {"a": (1, 1, 1), "m": (4, 2, 1), "c": (4, 7, 1), "b": (7, 1, 1)}
    half = Fraction(1, 2)
    lines = [
        ("a", "m", (half, half, half)), ("m", "b", (half, half, half)),
        ("b", "a", (1, 0, 0)), ("b", "c", (-half, half, half)), ("c", "a", (-half, half, half)),
    ]  # fmt: skip
    graph = DislocationNetwork.of_lines(lines, positions=places).to_networkx()
    return DislocationNetwork(graph, box=BOX)


NETWORKS = {
    "junctions": junctions,
    "rings": lambda: DislocationNetwork.of_arrays(rings(12, seed=4, size=7.3)),
    "straight": lambda: DislocationNetwork.of_arrays(
        straight([(0, 0), (9, 3)], [[0, 0, 1], [1, 0, 0]])
    ),
    "empty": lambda: DislocationNetwork.of_arrays(
        LineArrays(np.zeros((0, 3)), np.zeros((0, 2), int), np.zeros((0, 3)), BOX)
    ),
}


def properties_of(net: DislocationNetwork) -> list[tuple[object, ...]]:
    """Properties that do not depend on the format: b, length and ends of each line."""
    return sorted(
        (tuple(round(float(x), 9) for x in one.burgers), round(one.length, 9), one.ends)
        for one in net.polylines
    )


@pytest.mark.parametrize("kind", [".json", ".ca"])
@pytest.mark.parametrize("name", NETWORKS)
def test_written_lines_read_back(tmp_path: Path, name: str, kind: str) -> None:
    """Lines, junctions, box and Nye tensor are the same."""
    net = NETWORKS[name]()
    net.save(tmp_path / f"a{kind}")
    back = DislocationNetwork.read(tmp_path / f"a{kind}")
    assert properties_of(back) == properties_of(net)
    assert len(back.junctions) == len(net.junctions)
    assert np.array_equal(back.box.vectors, net.box.vectors)
    assert np.array_equal(back.box.periodic, net.box.periodic)
    assert back.nye == pytest.approx(net.nye, abs=ROUNDED)
    assert back.node_rule() == net.node_rule() == ()


@pytest.mark.parametrize("name", NETWORKS)
def test_json_keeps_every_bit(tmp_path: Path, name: str) -> None:
    """Fractions, node names and images are exact, and saving twice gives the same bytes."""
    net = NETWORKS[name]()
    net.save(tmp_path / "a.json")
    back = DislocationNetwork.read(tmp_path / "a.json")
    assert back.lines == net.lines
    assert all(type(x) is type(y) for one, two in zip(back.lines, net.lines, strict=True)
               for x, y in zip(one[3], two[3], strict=True))  # fmt: skip
    assert np.array_equal(back.arrays.positions, net.arrays.positions)
    assert back.arrays.image_list == net.arrays.image_list
    back.save(tmp_path / "b.json")
    assert (tmp_path / "b.json").read_bytes() == (tmp_path / "a.json").read_bytes()


@pytest.mark.parametrize("name", ["junctions", "rings", "straight"])
def test_meshio_reads_the_vtk_file(tmp_path: Path, name: str) -> None:
    """meshio finds the points, lengths and b of all lines."""
    meshio = pytest.importorskip("meshio")
    net = NETWORKS[name]()
    net.save(tmp_path / "a.vtk")
    mesh = meshio.read(tmp_path / "a.vtk")
    (block,) = mesh.cells
    lengths = np.linalg.norm(np.diff(mesh.points[block.data], axis=1)[:, 0], axis=1)
    (numbers,), (vectors,) = mesh.cell_data["line"], mesh.cell_data["burgers"]
    for k, one in enumerate(net.polylines):
        pieces = mesh.points[block.data[numbers.ravel() == k]]
        assert np.array_equal(pieces[:, 0], one.points[:-1])
        assert np.array_equal(pieces[:, 1], one.points[1:])
        assert lengths[numbers.ravel() == k].sum() == pytest.approx(one.length, rel=1e-12)
        assert (vectors[numbers.ravel() == k] == [float(x) for x in one.burgers]).all()


def test_names_decide_and_others_are_paradis(tmp_path: Path) -> None:
    """The suffix, in any case, selects the format; a VTK file, which has no box, is refused."""
    net = NETWORKS["rings"]()
    net.save(tmp_path / "a.JSON")
    assert (tmp_path / "a.JSON").read_text().startswith("{")
    net.save(tmp_path / "chains")
    assert (tmp_path / "chains").read_text().startswith("dataFileVersion")
    net.save(tmp_path / "a.vtk")
    with pytest.raises(FileFormatError, match="got a VTK file, which holds no box"):
        DislocationNetwork.read(tmp_path / "a.vtk")
    with pytest.raises(ArgumentError, match="name of a file"):
        net.save(3)


def test_what_a_file_cannot_hold_is_refused(tmp_path: Path) -> None:
    """A .ca file needs a box, .vtk three components, and .json rational b and plain node names."""
    import sympy as sp

    places = {"a": (0, 0, 0), "b": (1, 0, 0)}
    flat = DislocationNetwork.of_lines([("a", "b", (1, 0))], positions=places)
    root = DislocationNetwork.of_lines([("a", "b", (sp.sqrt(2), 0, 0))], positions=places)
    odd = {1.5: (0, 0, 0), "b": (1, 0, 0)}
    named = DislocationNetwork.of_lines([(1.5, "b", (1, 0, 0))], positions=odd)
    for net, kind, message in (
        (flat, "ca", "cell of the simulation"),
        (flat, "vtk", "three components"),
        (root, "json", "rational number or a float"),
        (named, "json", "a whole number, a text or a tuple"),
    ):
        with pytest.raises(NetworkError, match=message):
            net.save(tmp_path / f"a.{kind}")
        assert not (tmp_path / f"a.{kind}").exists()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"format": "geomtorsion', '"format": "other', "expected .*, got .*other"),
        ('"1/2"', '"1/0"', 'a fraction such as "1/2"'),
        ('"1/2"', '"__import__(1)"', 'a fraction such as "1/2"'),
        ('"constraint": 0', '"constraint": "x"', "whole number"),
        ('"image"', '"other"', "expected image as in other lines, got none"),
        ('"position": [', '"position": [1.0, ', "lists of equal lengths"),
        ("}", "", "expected JSON"),
    ],
)
def test_damage_is_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    """Each kind of damage raises our own error with the file's name."""
    path = tmp_path / "a.json"
    junctions().save(path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(FileFormatError, match=f"a.json.*{message}"):
        DislocationNetwork.read(path)

"""The command `stress`: numbers, files, sources, and exit codes."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geomtorsion.materials.elasticity import ElasticConstants, NyeField, stresses
from geomtorsion.materials.lines import Box, DislocationNetwork
from tests.cli import running
from tests.materials.lines.synthetic_networks import rings
from tests.real import real

COPPER = "cubic 168.4 121.4 75.4 GPa"


def run(*arguments: str, code: int = 0) -> Any:
    """Result of `geomtorsion stress`, which must end with the given code."""
    return running.run("stress", *arguments, code=code)


@pytest.fixture
def chains(tmp_path: Path) -> Path:
    """A ParaDiS file of rings."""
    file = tmp_path / "rings.data"
    DislocationNetwork.of_arrays(rings(3, seed=2)).save(file)
    return file


def test_help_has_examples() -> None:
    """The help shows an example."""
    assert "geomtorsion stress chains.data --elastic" in run("--help").stdout


def test_a_network(chains: Path, tmp_path: Path) -> None:
    """JSON holds the numbers of the library, with forces; VTK and a figure are written."""
    folder = tmp_path / "out"
    options = ("--nodes", "16", "--core", "1", "--component", "xy", "--format", "json")
    found = json.loads(run(str(chains), "--elastic", COPPER, *options, "-o", str(folder)).stdout)
    net = DislocationNetwork.read(chains)
    wanted = stresses(
        net, ElasticConstants.of_text(COPPER), shape=16, core=1.0, convention="Hirth-Lothe"
    )
    assert found["energy"] == pytest.approx(wanted.energy, rel=1e-12)
    assert found["convention"] == "Hirth-Lothe"
    saved = json.loads((folder / "stress.json").read_text("utf-8"))
    np.testing.assert_allclose(saved["forces"], wanted.forces, atol=1e-12)
    assert (folder / "stress.vtk").read_bytes().startswith(b"# vtk")
    assert (folder / "stress.png").stat().st_size > 10_000
    text = run(str(chains), "--elastic", COPPER, "--nodes", "12", "--gauge", "0.5").stdout
    assert "12 x 12 x 12 nodes" in text
    assert "gauge length 0.5" in text
    assert "GPa" in text


def test_fields(tmp_path: Path) -> None:
    """A Nye field with open ends is padded and balanced; a frame is read as it is."""
    alpha = np.zeros((3, 3, 8, 8, 1))
    alpha[2, 2, 3, 3] = 0.1
    box = Box.of_bounds([0, 0, 0], [8, 8, 1], (False, False, True))
    NyeField(alpha, box, "um").save(tmp_path / "nye.npz")
    file, steel = str(tmp_path / "nye.npz"), ("--elastic", "isotropic 80 0.3 GPa")
    assert "with perfect crystal: --padding N" in run(file, *steel, code=2).stderr
    assert "Give --balance," in run(file, *steel, "--padding", "8", code=2).stderr
    text = run(file, *steel, "--padding", "8", "--balance").stdout
    assert "16 x 16 x 1 nodes" in text
    assert "is spread over the cell" in text
    assert "GPa um^3" in text
    result = stresses(NyeField.read(file).padded(8), ElasticConstants.isotropic(80, 0.3),
                      balance=True)  # fmt: skip
    result.frame.save(tmp_path / "frame.npz")
    again = json.loads(run(str(tmp_path / "frame.npz"), *steel, "--format", "json").stdout)
    assert again["energy"] == pytest.approx(result.energy, rel=1e-9)


def test_wrong_input_ends_with_two(chains: Path) -> None:
    """A missing file, other constants and other numbers of nodes end with code 2."""
    file, copper = str(chains), ("--elastic", COPPER)
    assert "cannot be read" in run("nothing.data", *copper, code=2).stderr
    assert "3 numbers" in run(file, "--elastic", "cubic 1 2", code=2).stderr
    assert "--nodes: expected one whole number" in run(
        file, *copper, "--nodes", "1_0", code=2
    ).stderr  # fmt: skip
    assert "more nodes with --nodes" in run(
        file, *copper, "--nodes", "8", "--core", "0.1", code=2
    ).stderr  # fmt: skip
    assert "a network" in run(file, *copper, "--padding", "3", code=2).stderr
    assert "component" in run(
        file, *copper, "--nodes", "8", "--component", "rr", "-o", "out", code=2
    ).stderr  # fmt: skip


def test_an_orientation_map_is_refused_with_a_remedy() -> None:
    """An orientation map has several grains: the message shows how to choose one."""
    file = str(real("ebsd/si_wafer.ctf"))
    said = run(file, "--elastic", "isotropic 80 0.3", code=2).stderr
    assert "NyeField.of_frame(map.frame(0))" in " ".join(said.split())


def test_columns_are_for_tables(chains: Path) -> None:
    """A network has no columns; the message names the option."""
    said = run(str(chains), "--elastic", COPPER, "--columns", "x=0", code=2)
    assert "--columns: expected a table, got a network" in said.stderr

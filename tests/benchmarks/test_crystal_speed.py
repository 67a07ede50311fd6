"""Speed of crystals: atoms per second of CPU, beside OVITO's extraction if it is installed."""

import time
from collections.abc import Callable

import numpy as np
import pytest

from geomtorsion.materials.crystals import Crystal
from tests.benchmarks.memory import peak_gigabytes
from tests.materials.crystals.synthetic import block, quadrupole

ROUNDS = 3


def seconds(call: Callable[[], object]) -> float:
    """CPU time of one call."""
    start = time.process_time()
    call()
    return time.process_time() - start


def specimens() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Crystals with four lines, 1 % vacancies or 10 % noise, with a = 3.1652."""
    lines = quadrupole("bcc", (32, 32, 16), (0, 0, 1))
    places, cell = block("bcc", (32, 32, 16))
    rng = np.random.default_rng(0)
    kept = rng.random(len(places)) > 0.01
    shaken = places + 0.1 * np.sqrt(0.75) * rng.normal(size=places.shape)
    found = {"lines": lines, "vacancies": (places[kept], cell), "noise": (shaken, cell)}
    return {name: (x * 3.1652, edges * 3.1652) for name, (x, edges) in found.items()}


@pytest.mark.parametrize("name", ["lines", "vacancies", "noise"])
def test_against_ovito(name: str) -> None:
    """At most OVITO's time for lines and four times OVITO's time for vacancies and noise."""
    data = pytest.importorskip("ovito.data")
    modifiers = pytest.importorskip("ovito.modifiers")
    pipelines = pytest.importorskip("ovito.pipeline")
    places, cell = specimens()[name]

    def theirs() -> object:
        box = data.SimulationCell(pbc=(True, True, True))
        box[:, :3] = np.diag(cell)
        atoms = data.DataCollection()
        atoms.objects.append(box)
        atoms.create_particles(count=len(places)).create_property("Position", data=places)
        pipeline = pipelines.Pipeline(source=pipelines.StaticSource(data=atoms))
        modifier = modifiers.DislocationAnalysisModifier()
        modifier.input_crystal_structure = modifiers.DislocationAnalysisModifier.Lattice.BCC
        pipeline.modifiers.append(modifier)
        return pipeline.compute()

    def ours() -> object:
        return Crystal(places, cell, lattice="bcc").dislocations()

    both = [(seconds(ours), seconds(theirs)) for _ in range(ROUNDS)]
    own, other = (min(column) for column in zip(*both, strict=True))
    print(f"{name}: {len(places) / own:,.0f} atoms/s, OVITO {len(places) / other:,.0f} atoms/s")
    assert own < (1.0 if name == "lines" else 4.0) * other


def test_a_million_atoms() -> None:
    """In a million atoms four lines, the orientation and the constant are found in 30 s of CPU."""
    places, cell = quadrupole("bcc", (100, 100, 50), (0, 0, 1))
    lines: list[int] = []
    spent = seconds(lambda: lines.append(len(Crystal(places, cell).dislocations().lines)))
    print(f"a million atoms: {spent:.1f} s, {peak_gigabytes():.2f} GB at most so far")
    assert lines == [4]
    assert spent < 30

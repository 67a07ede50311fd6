"""Crystals that are nowhere in memory: time and peak memory of dislocation lines in blocks.

python -m tests.benchmarks.crystal_blocks                          # 1e7 atoms
python -m tests.benchmarks.crystal_blocks --atoms 1e6 1e8 --block 100 --workers 2
python -m tests.benchmarks.crystal_blocks --atoms 1e5 4e5 --block 25 --noise 0.1   # of all atoms
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from collections.abc import Iterator
from functools import partial

import numpy as np

from geomtorsion.materials.crystals import blocked_crystal
from tests.benchmarks.blocks import alone, processor


def layers(side: int, depth: int, noise: float) -> Iterator[np.ndarray]:
    """bcc with a = 1, side x side x depth cells, layer by layer along x: four screws along z.

    noise: of each coordinate, as a share of the neighbour distance.
    """
    y, z = (x.ravel() for x in np.meshgrid(np.arange(side), np.arange(depth), indexing="ij"))
    for x in range(side):
        corners = np.column_stack([np.full(len(y), x), y, z]).astype(float)
        places = np.concatenate([corners, corners + 0.5])
        for sx in (0.25, 0.75):
            for sy in (0.25, 0.75):
                sign = 1 if sx == sy else -1
                # The fields of all images add up; those of the nearest ones suffice.
                for m in (-1, 0, 1):
                    for n in (-1, 0, 1):
                        centre = np.array([sx + m, sy + n]) * side + [0.0131, 0.0077]
                        along, up = (places[:, :2] - centre).T
                        places[:, 2] += sign / (2 * np.pi) * np.arctan2(up, along)
        rng = np.random.default_rng(x)
        yield places + noise * 0.75**0.5 * rng.normal(size=places.shape)


def run(atoms: float, block: float, workers: int, noise: float) -> None:
    """Four lines, looked for in atoms that are made as they are read."""
    depth = round((atoms / 2 / 2.5) ** (1 / 3))
    side = round((atoms / 2 / depth) ** 0.5)
    began = time.perf_counter(), sum(processor())
    with tempfile.TemporaryDirectory() as folder:
        crystal = blocked_crystal(
            partial(layers, side, depth, noise), folder, (side, side, depth), block, workers=workers
        )
        lines = crystal.dislocations().lines
    families = [line.family for line in lines]
    assert families == ["<1 0 0>"] * 4, families
    assert all(abs(line.length / depth - 1) < 0.01 for line in lines)
    own, children = processor()
    spent, wall = own + children - began[1], time.perf_counter() - began[0]
    peak = max(resource.getrusage(k).ru_maxrss for k in (0, resource.RUSAGE_CHILDREN)) / 1024
    print(
        f"{crystal.count:.4g} atoms in {len(crystal.atoms.blocks)} blocks, {workers} workers: "
        f"processor {spent:.0f} s, {wall:.0f} s, {crystal.count / spent:,.0f} atoms a second of "
        f"processor, peak {peak:.0f} MB a process",
        flush=True,
    )


def main() -> None:
    """Every number of atoms in a process of its own, so that peaks are apart."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--atoms", type=float, nargs="*", default=[1e7])
    parser.add_argument("--block", type=float, default=80.0)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--noise", type=float, default=0.0)
    given = parser.parse_args()
    for atoms in given.atoms:
        alone(run, atoms, given.block, given.workers, given.noise)


if __name__ == "__main__":
    main()

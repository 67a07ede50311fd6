"""Blocked maps: time and peak memory for fields of 1e7 to 1e9 nodes that are never in memory.

python -m tests.benchmarks.blocked_maps   # 1e7, 1e8 and 1e9 nodes, each in a process of its own
python -m tests.benchmarks.blocked_maps --nodes 1e7 --scheduler threads --workers 2
"""

# dask does not declare its types.
# pyright: reportPrivateImportUsage=false

from __future__ import annotations

import argparse
import math
import multiprocessing
import resource
import tempfile
import time
from collections.abc import Callable
from typing import Any

import dask
import numpy as np

from geomtorsion.materials.fields import blocked_map

BLOCK, SIZE = 1024, 32
LENGTHS = 700.0, 900.0


class Field:
    """e = sin(y / 900) dx + cos(x / 700) dy, computed only for the part that is read."""

    dtype = np.dtype(float)

    def __init__(self, side: int) -> None:
        self.shape = (1, 2, side, side)

    def __getitem__(self, index: tuple[slice, ...]) -> np.ndarray:
        x, y = (np.arange(s.start, s.stop, dtype=float) for s in index[2:])
        values = np.empty((1, 2, len(x), len(y)))
        values[0, 0], values[0, 1] = np.sin(y / LENGTHS[1]), np.cos(x / LENGTHS[0])[:, None]
        return values


def expected(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Burgers vectors of the squares at these corners."""
    across = np.diff(np.cos(np.array([x, x + SIZE]) / LENGTHS[0]), axis=0)[0]
    along = np.diff(np.sin(np.array([y, y + SIZE]) / LENGTHS[1]), axis=0)[0]
    return SIZE * np.subtract.outer(across, along)


def run(nodes: float, scheduler: str, workers: int) -> None:
    """Compute one map of adjacent squares and check it block by block."""
    side = round(math.sqrt(nodes))
    with (
        tempfile.TemporaryDirectory() as folder,
        dask.config.set(scheduler=scheduler, num_workers=workers),
    ):
        began = time.perf_counter(), sum(processor())
        result = blocked_map(
            Field(side), f"{folder}/map.zarr", (1, 1), BLOCK // SIZE, SIZE, sigma=0.01, stride=SIZE
        )
        wall, used = time.perf_counter() - began[0], sum(processor()) - began[1]
        worst = 0.0
        for number, parts in result:
            corners = [SIZE * np.arange(*ends) for ends in result.span(number)]
            worst = max(worst, float(np.abs(parts.vectors[0] - expected(*corners)).max()))
        assert worst < 1e-9, worst
    peak = max(resource.getrusage(k).ru_maxrss for k in (0, resource.RUSAGE_CHILDREN)) / 1024
    print(
        f"{side**2:.3g} nodes, {len(result.numbers)} blocks, {scheduler}, {workers} workers: "
        f"{wall:.1f} s, processor {used:.1f} s, {side**2 / wall / 1e6:.2f} million nodes a "
        f"second, peak {peak:.0f} MB a process",
        flush=True,
    )


def processor() -> tuple[float, float]:
    """Processor time of this process and of its finished children."""
    both = (resource.getrusage(k) for k in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    own, children = (used.ru_utime + used.ru_stime for used in both)
    return own, children


def in_own_process(target: Callable[..., None], *arguments: Any) -> None:
    """Run a call in a process of its own; its failure ends this process."""
    process = multiprocessing.get_context("spawn").Process(target=target, args=arguments)
    process.start()
    process.join()
    if process.exitcode:
        raise SystemExit(process.exitcode)


def main() -> None:
    """Run each number of nodes in a process of its own, so that their peaks are separate."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=float, nargs="*", default=[1e7, 1e8, 1e9])
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--scheduler", default="synchronous")
    given = parser.parse_args()
    for nodes in given.nodes:
        in_own_process(run, nodes, given.scheduler, given.workers)


if __name__ == "__main__":
    main()

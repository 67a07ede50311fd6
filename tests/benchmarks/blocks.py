"""Maps of fields that are nowhere in memory: time and peak memory from 1e7 to 1e9 nodes.

python -m tests.benchmarks.blocks                 # 1e7, 1e8 and 1e9 nodes, each in its own process
python -m tests.benchmarks.blocks --nodes 1e7 --workers 2     # concurrent.futures
python -m tests.benchmarks.blocks --nodes 1e7 --workers 2 --dask
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import resource
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import numpy as np

from geomtorsion.materials.fields import blocked_map

BLOCK, SIZE = 1024, 32
LENGTHS = 700.0, 900.0


def field(index: tuple[slice, slice]) -> np.ndarray:
    """e = sin(y / 900) dx + cos(x / 700) dy on a part of the grid."""
    x, y = (np.arange(s.start, s.stop, dtype=float) for s in index)
    found = np.empty((1, 2, len(x), len(y)))
    found[0, 0], found[0, 1] = np.sin(y / LENGTHS[1]), np.cos(x / LENGTHS[0])[:, None]
    return found


def expected(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """b of the squares at these corners."""
    across = np.diff(np.cos(np.array([x, x + SIZE]) / LENGTHS[0]), axis=0)[0]
    along = np.diff(np.sin(np.array([y, y + SIZE]) / LENGTHS[1]), axis=0)[0]
    return SIZE * np.subtract.outer(across, along)


def run(nodes: float, workers: int, dask: bool) -> None:
    """One map of squares side by side, checked block by block."""
    side = round(math.sqrt(nodes))
    with ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        client: Any = None
        if dask:
            from dask.distributed import Client

            client = stack.enter_context(
                Client(n_workers=workers, threads_per_worker=1, dashboard_address=None)
            )
            # Workers are there, and have loaded what they need.
            client.gather(client.map(_warm, range(workers), pure=False))
        began = time.perf_counter(), sum(processor())
        found = blocked_map(
            field, folder, (1, 1), BLOCK // SIZE, SIZE, shape=(1, 2, side, side), sigma=0.01,
            stride=SIZE, workers=1 if dask else workers, client=client,
        )  # fmt: skip
        wall = time.perf_counter() - began[0]
        if client is not None:
            client.close()
        worst = 0.0
        for number, values in found:
            corners = [SIZE * np.arange(*ends) for ends in found.span(number)]
            worst = max(worst, float(np.abs(values[0] - expected(*corners)).max()))
        assert worst < 1e-9, worst
    own, children = processor()
    peak = max(resource.getrusage(k).ru_maxrss for k in (0, resource.RUSAGE_CHILDREN)) / 1024
    print(
        f"{side**2:.3g} nodes, {len(found.numbers)} blocks, {workers} workers"
        f"{' (dask)' if dask else ''}: {wall:.1f} s, processor {own + children - began[1]:.1f} s, "
        f"{side**2 / wall / 1e6:.2f} million nodes a second, peak {peak:.0f} MB a process",
        flush=True,
    )


def _warm(_: int) -> None:
    """Load the library in a worker."""
    time.sleep(0.5)


def processor() -> tuple[float, float]:
    """Processor time of this process and of those that it has waited for."""
    both = (resource.getrusage(k) for k in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    own, children = (used.ru_utime + used.ru_stime for used in both)
    return own, children


def alone(target: Callable[..., None], *arguments: Any) -> None:
    """A call in a process of its own; its failure ends this one."""
    process = multiprocessing.get_context("spawn").Process(target=target, args=arguments)
    process.start()
    process.join()
    if process.exitcode:
        raise SystemExit(process.exitcode)


def main() -> None:
    """Every number of nodes in a process of its own, so that peaks are apart."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=float, nargs="*", default=[1e7, 1e8, 1e9])
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--dask", action="store_true")
    given = parser.parse_args()
    for nodes in given.nodes:
        alone(run, nodes, given.workers, given.dask)


if __name__ == "__main__":
    main()

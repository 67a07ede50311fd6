"""Dense random frames: processor time, memory and numbers of all their tensors.

python -m tests.benchmarks.dense_frames                       # 100 frames in 2 to 6 dimensions
python -m tests.benchmarks.dense_frames --frames 20 --seed 3

Each is read and computed in a process of its own: it is decided what vanishes of torsion,
contortion, Riemann and Ricci tensors, scalar and Kretschmann's. Then the scalar is compared with
difference quotients of the metric in 60 digits.
"""

from __future__ import annotations

import argparse
import multiprocessing
import time
import warnings
from dataclasses import dataclass

import hypothesis
from hypothesis import HealthCheck, given, settings

from geomtorsion.errors import LimitError
from geomtorsion.exact.parsing import parse_expression
from geomtorsion.geometry import Frame, cartan, levi_civita
from tests.benchmarks.memory import peak_gigabytes
from tests.laws.dense import COORDINATES, dense_frames
from tests.laws.test_dense_frames import check_numbers

# Nothing takes longer than this without its own error.
LONGEST = 60


@dataclass(frozen=True)
class Asked:
    """A frame as text."""

    coordinates: list[str]
    coframe: list[list[str]]
    eta: list[list[str]]


@dataclass(frozen=True)
class Found:
    """What one took, and whether it is right."""

    seconds: float
    gigabytes: float
    limit: str
    wrong: str


def random_frame(seed: int) -> Asked:
    """A frame of its own for each seed."""
    drawn: list[Frame] = []

    # The first examples are the simplest.
    @hypothesis.seed(seed)
    @settings(max_examples=5, deadline=None, database=None,
              suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(dense_frames(largest=6))
    def collect(frame: Frame) -> None:
        drawn.append(frame)

    collect()
    frame = drawn[-1]
    coframe, eta = (
        [[str(entry) for entry in row] for row in tensor.to_sympy().tolist()]
        for tensor in (frame.coframe, frame.eta)
    )
    return Asked([str(x) for x in frame.coordinates], coframe, eta)


def computed(asked: Asked) -> Found:
    """One frame, from its text on."""
    warnings.simplefilter("ignore")
    began = time.process_time()
    symbols = {str(symbol): symbol for symbol in COORDINATES}
    coframe, eta = (
        [[parse_expression(entry, symbols) for entry in row] for row in rows]
        for rows in (asked.coframe, asked.eta)
    )
    frame = Frame([symbols[name] for name in asked.coordinates], coframe, signature=eta)
    limit = wrong = ""
    try:
        curvature = levi_civita(frame).curvature
        parts = (cartan(frame).torsion.S, cartan(frame).contortion, curvature.riemann,
                 curvature.ricci, curvature.scalar, curvature.kretschmann)  # fmt: skip
        assert None not in [tensor.is_zero for tensor in parts]
    except LimitError as error:
        limit = str(error)
    spent, peak = time.process_time() - began, peak_gigabytes()
    try:
        if not limit:
            check_numbers(frame)
    except AssertionError as error:
        wrong = str(error)
    return Found(spent, peak, limit, wrong)


def main() -> None:
    """All of them, one after the other."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    given_ = parser.parse_args()
    seeds = range(1000 * given_.seed, 1000 * given_.seed + given_.frames)
    asked = [random_frame(seed) for seed in seeds]
    done = []
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        for one, found in zip(asked, pool.imap(computed, asked), strict=True):
            done.append(found)
            if found.seconds > 10 or found.gigabytes > 1 or found.limit or found.wrong:
                print(f"{found}\n    {one}", flush=True)
    quick = sum(one.seconds <= 10 and one.gigabytes <= 1 and not one.limit for one in done)
    late = sum(one.seconds > LONGEST and not one.limit for one in done)
    print(
        f"{len(done)} frames: {sum(bool(one.wrong) for one in done)} wrong, {quick} within 10 s of "
        f"processor and 1 GB, {late} above {LONGEST} s without an error, "
        f"{sum(bool(one.limit) for one in done)} at their limit; "
        f"median {sorted(one.seconds for one in done)[len(done) // 2]:.2f} s, at most "
        f"{max(one.seconds for one in done):.1f} s and {max(one.gigabytes for one in done):.2f} GB"
    )


if __name__ == "__main__":
    main()

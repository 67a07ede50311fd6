"""Dense random frames: processor time, memory and numbers of all their tensors.

python -m tests.benchmarks.dense_frames                       # 100 frames in 2 to 6 dimensions
python -m tests.benchmarks.dense_frames --frames 20 --seed 3

A process of its own reads and computes each frame: it decides whether torsion, contortion,
Riemann tensor, Ricci tensor, scalar and Kretschmann scalar vanish, and prints torsion and scalar
unless they exceed the limit of printing. Then the scalar is compared with difference quotients
of the metric in 60 digits.
"""

from __future__ import annotations

import argparse
import multiprocessing
import random
import time
import warnings
from contextlib import suppress
from dataclasses import dataclass

from geomtorsion.errors import LimitError
from geomtorsion.exact.parsing import parse_expression
from geomtorsion.geometry import Frame, cartan, levi_civita
from tests.benchmarks.memory import peak_gigabytes
from tests.laws.dense import COORDINATES
from tests.laws.test_dense_frames import M, check_numbers

# Longest time in seconds without an error of the package.
LONGEST = 60


@dataclass(frozen=True)
class Asked:
    """A frame as text."""

    coordinates: list[str]
    coframe: list[list[str]]
    eta: list[list[str]]


@dataclass(frozen=True)
class Found:
    """Cost of one frame, and whether its numbers are right."""

    seconds: float
    printed: int
    gigabytes: float
    limit: str
    wrong: str


def random_frame(seed: int) -> Asked:
    """A tetrad of varied functions, full in two and three dimensions, partly filled above."""
    rng = random.Random(seed)
    n = rng.choice([2, 2, 2, 3, 3, 4, 5, 6])
    names = [f"x{k}" for k in range(n)]

    def linear() -> str:
        one, other = rng.choice(names), rng.choice(names)
        return rng.choice([one, f"2*{one}", f"{one} - {other}/3", f"{one} + 2*{other}"])

    def factor() -> str:
        one, other = rng.choice(names), rng.choice(names)
        return rng.choice([
            f"M*{one}", f"({one}**2 + 1)**2", f"{one}*{other}", f"sin({linear()})",
            f"cos({linear()})", f"exp({one}/2)", f"exp(-{one})", f"sqrt({one}**2 + {other}**2 + 2)",
            f"1/(2*({one}**2 + 2))", f"tan({one}/4)", f"atan({one})", f"f({one})",
            f"sinh({one})/3", f"sqrt({one} + 5)", f"(sin({one}) + 2)",
        ])  # fmt: skip

    def entry() -> str:
        product = factor() if rng.random() < 0.6 else f"{factor()}*{factor()}"
        scaled = f"{product}/{rng.randint(1, 4)}"
        return rng.choice([scaled, f"{scaled} + {rng.randint(-2, 2)}", f"{scaled} - {factor()}/2"])

    share = {2: 1.0, 3: 1.0, 4: 0.4, 5: 0.25, 6: 0.15}[n]
    coframe = [
        [
            f"{entry()} + {rng.randint(2, 4)}" if i == j
            else entry() if rng.random() < share else "0"
            for j in range(n)
        ]
        for i in range(n)
    ]  # fmt: skip
    signs = [rng.choice("1 -1".split()), *["1"] * (n - 1)]
    eta = [[signs[i] if i == j else "0" for j in range(n)] for i in range(n)]
    if rng.random() < 0.25:
        eta[0][:2], eta[1][:2] = ["0", "1"], ["1", "0"]
    return Asked(names, coframe, eta)


def computed(asked: Asked) -> Found:
    """Compute one frame from its text."""
    warnings.simplefilter("ignore")
    began = time.process_time()
    symbols = {str(symbol): symbol for symbol in (*COORDINATES, M)}
    coframe, eta = (
        [[parse_expression(entry, symbols) for entry in row] for row in rows]
        for rows in (asked.coframe, asked.eta)
    )
    frame = Frame([symbols[name] for name in asked.coordinates], coframe, signature=eta)
    limit, wrong, printed = "", "", 0
    try:
        curvature = levi_civita(frame).curvature
        parts = (cartan(frame).torsion.S, cartan(frame).contortion, curvature.riemann,
                 curvature.ricci, curvature.scalar, curvature.kretschmann)  # fmt: skip
        assert None not in [tensor.is_zero for tensor in parts]
    except LimitError as error:
        limit = str(error)
    for tensor in (cartan(frame).torsion.S, levi_civita(frame).curvature.scalar):
        # A text beyond the limit of printing is refused when it is requested.
        with suppress(LimitError):
            printed += bool(str(tensor))
    spent, peak = time.process_time() - began, peak_gigabytes()
    try:
        if not limit:
            check_numbers(frame)
    except AssertionError as error:
        wrong = str(error)
    return Found(spent, printed, peak, limit, wrong)


def main() -> None:
    """Compute all frames, one after the other."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    seeds = range(1000 * given.seed, 1000 * given.seed + given.frames)
    asked = [random_frame(seed) for seed in seeds]
    done = []
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        for one, found in zip(asked, pool.imap(computed, asked), strict=True):
            done.append(found)
            if found.seconds > 10 or found.gigabytes > 1 or found.limit or found.wrong:
                print(f"{found}\n    {one}", flush=True)
    times = sorted(one.seconds for one in done)
    quick = sum(one.seconds <= 10 and one.gigabytes <= 1 and not one.limit for one in done)
    late = sum(one.seconds > LONGEST and not one.limit for one in done)
    print(
        f"{len(done)} frames: {sum(bool(one.wrong) for one in done)} wrong, {quick} within 10 s of "
        f"processor and 1 GB, {late} above {LONGEST} s without an error, "
        f"{sum(bool(one.limit) for one in done)} at their limit; "
        f"{sum(one.printed for one in done)} of {2 * len(done)} printed; median "
        f"{times[len(done) // 2]:.2f} s, at most {times[-1]:.1f} s and "
        f"{max(one.gigabytes for one in done):.2f} GB"
    )


if __name__ == "__main__":
    main()

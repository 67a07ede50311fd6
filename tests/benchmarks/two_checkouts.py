"""Two checkouts: a race of both on the same 28 solves, in turn, in one run.

    python -m tests.benchmarks.two_checkouts OLD NEW [--what warm cold errors] [--only Kerr ...]
        [--accuracies 1e-6 1e-9 1e-12] [--engine RungeKutta] [--without-heyoka] [--rounds 5]

OLD and NEW are folders that contain `geomtorsion`. Each has a process of its own. Both receive each
problem of each pass in turn, so that they run under the same load. A time is the least CPU time
of all passes; the ratio is NEW over OLD. Cold is the first solve of a fresh process.
Errors are measured with a hundred bits (compiled for each problem, which takes minutes).
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.solves import CASES, ENGINES

WORKER = Path(__file__).with_name("solves.py")
# CPU seconds that a worker spends on one problem before the other worker's turn.
TURN = 0.1
COLD_ACCURACY = 1e-9


class Checkout:
    """A process that solves with the package of one folder."""

    def __init__(self, root: Path, options: argparse.Namespace) -> None:
        command = [sys.executable, "-P", str(WORKER)]
        if options.without_heyoka:
            command.append("--without-heyoka")
        self.engine = options.engine
        self.process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": str(root.resolve())},
            cwd=tempfile.gettempdir(),
        )

    def ask(self, do: str, name: str, accuracy: float, **more: Any) -> dict[str, Any]:
        """Answer of the worker to a request."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        asked = {"do": do, "name": name, "accuracy": accuracy, "engine": self.engine} | more
        self.process.stdin.write(json.dumps(asked) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"the worker ended at {asked}")
        return json.loads(line)

    def close(self) -> None:
        """End the worker."""
        assert self.process.stdin is not None
        self.process.stdin.close()
        self.process.wait()


def least(answers: list[dict[str, Any]]) -> float:
    """The least time; infinity if one solve was refused."""
    return min(answer.get("seconds", np.inf) for answer in answers)


def row(name: str, accuracy: float, old: float, new: float) -> float:
    """Print both times and return their ratio, NaN if a solve was refused."""
    ratio = new / old if np.isfinite([old, new]).all() else np.nan
    times = "  ".join("   refused" if t == np.inf else f"{1e3 * t:7.3g} ms" for t in (old, new))
    print(f"{name:20} {accuracy:.0e}  {times}  {ratio:5.2f}", flush=True)
    return ratio


def summary(ratios: list[float]) -> None:
    """Print the geometric mean and the worst of the ratios."""
    known = [ratio for ratio in ratios if np.isfinite(ratio)]
    if known:
        mean = float(np.exp(np.mean(np.log(known))))
        print(f"{len(known)} ratios: geometric mean {mean:.3f}, worst {max(known):.2f}\n")


def warm(options: argparse.Namespace) -> None:
    """Race repeated solves, in turn."""
    print("warm: CPU time of a repeated solve with its error, nothing remembered")
    pair = [Checkout(root, options) for root in (options.old, options.new)]
    ratios = []
    for name in options.only:
        for accuracy in options.accuracies:
            found: list[list[dict[str, Any]]] = [[], []]
            for _ in range(options.rounds):
                for checkout, answers in zip(pair, found, strict=True):
                    answers.append(checkout.ask("warm", name, accuracy, length=TURN))
            ratios.append(row(name, accuracy, *(least(answers) for answers in found)))
    for checkout in pair:
        checkout.close()
    summary(ratios)


def cold(options: argparse.Namespace) -> None:
    """Race first solves of fresh processes, in turn."""
    print("cold: CPU time of the first solve in a fresh process, problem made before")
    ratios = []
    for name in options.only:
        found: list[list[dict[str, Any]]] = [[], []]
        for _ in range(min(options.rounds, 3)):
            for root, answers in zip((options.old, options.new), found, strict=True):
                checkout = Checkout(root, options)
                answers.append(checkout.ask("cold", name, COLD_ACCURACY))
                checkout.close()
        ratios.append(row(name, COLD_ACCURACY, *(least(answers) for answers in found)))
    summary(ratios)


def errors(options: argparse.Namespace) -> None:
    """Print true and estimated errors of both checkouts."""
    print("errors: real and claimed (claimed/real) of both")
    pair = [Checkout(root, options) for root in (options.old, options.new)]
    above, under, over = [0, 0], [0, 0], [0, 0]
    for name in options.only:
        for accuracy in options.accuracies:
            texts = []
            for k, checkout in enumerate(pair):
                answer = checkout.ask("error", name, accuracy)
                if "refused" in answer:
                    texts.append("refused")
                    continue
                real, claimed = answer["real"], answer["claimed"]
                above[k] += real > accuracy
                under[k] += claimed < 0.5 * real and real > 1e-15
                over[k] += claimed > 100 * real and real > 1e-15
                share = claimed / real if real else np.inf
                texts.append(f"{real:.1e} {claimed:.1e} ({share:.2g})")
            print(f"{name:20} {accuracy:.0e}  {texts[0]:32} {texts[1]}", flush=True)
    for checkout in pair:
        checkout.close()
    print(
        f"real above asked {above}, claimed below half of real {under}, "
        f"claimed above 100 times real {over}\n"
    )


def main() -> None:
    """Read the command line and race."""
    parser = argparse.ArgumentParser(description="Two checkouts of the package, raced.")
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--what", nargs="+", default=["warm"], choices=["warm", "cold", "errors"])
    parser.add_argument("--only", nargs="+", default=list(CASES), choices=list(CASES))
    parser.add_argument("--accuracies", nargs="+", type=float, default=[1e-6, 1e-9, 1e-12])
    parser.add_argument("--engine", default="default", choices=list(ENGINES))
    parser.add_argument("--without-heyoka", action="store_true")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    for what in options.what:
        {"warm": warm, "cold": cold, "errors": errors}[what](options)


if __name__ == "__main__":
    main()

"""Compare: one table of times and ratios, with all contestants in the same run.

    python -m tests.benchmarks.compare                       every case, every installed contestant
    python -m tests.benchmarks.compare --cases so3 goedel --limit 20
    python -m tests.benchmarks.compare --turns 3             every race three times, in turn
    python -m tests.benchmarks.compare --keep results.jsonl  resume an earlier run

Times are CPU seconds of the best run of the whole work in a warm process, with fresh objects in
each run. With --turns all contestants of a case race again in turn, and the best run counts.
geomtorsion computes both connections, torsion, contortion and both curvatures, and converts each
component to sympy. The others compute what they can: Christoffel, Riemann, Ricci, Kretschmann; in
the column "metric only" geomtorsion computes only these. Python packages are timed from sympy
matrices, which they check and read, to sympy expressions; Maxima from its matrices to its
expressions.
"""

from __future__ import annotations

import argparse
import json
import platform
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from tests.benchmarks.cases import NAMES, load
from tests.benchmarks.contestants import ALL, Contestant
from tests.benchmarks.race import Result, race, to_json

_SAME_METRIC = {"kerr_carter": "kerr_metric"}
_PACKAGES = (
    *("sympy", "python-flint", "passagemath-maxima", "einsteinpy", "GraviPy"),
    *("pytearcat", "OGRePy", "lyra-geometry"),
)


def seconds(value: float) -> str:
    """A time with two figures: 8.3 ms, 120 ms, 1.6 s."""
    if value < 0.1:
        return f"{value * 1000:.2g} ms"
    return f"{value * 1000:.0f} ms" if value < 1 else f"{value:.2g} s"


def cell(result: Result | None, ours: Result | None = None) -> str:
    """Text of the table for one race."""
    if result is None:
        return "-"
    if result.failure and not result.rounds:
        return "error"
    if result.best is None:
        done = f" ({result.reached[0]} done)" if result.reached else ""
        return f"> {result.limit:.0f} s{done}"
    words = seconds(result.best)
    if ours is not None and ours.best is not None and result.contestant != ours.contestant:
        words += f" ({_figures(result.best / ours.best)} x)"
    if load(result.case).vacuum and not result.ricci_is_zero:
        words += ", Ricci not 0"
    if result.agrees is False:
        words += ", wrong"
    return words


def _figures(ratio: float) -> str:
    return f"{float(f'{ratio:.2g}'):,g}" if ratio >= 1 else f"{ratio:.2g}"


def table(results: dict[tuple[str, str], Result]) -> str:
    """Markdown table with a row for each case and a column for each contestant that took part."""
    present = [c for c in ALL if any(name == c.name for name, _ in results)]
    cases = [name for name in NAMES if any(case == name for _, case in results)]
    head = ["space", *(c.title for c in present)]
    rows = [head, ["---"] * len(head)]
    for case in cases:
        ours = results.get(("geomtorsion", case))
        row = [load(case).title]
        for contestant in present:
            shown = case if contestant.takes_coframe else _SAME_METRIC.get(case, case)
            if contestant.name == "maxima_frame" and load(case).coframe is None:
                row.append("-")
                continue
            row.append(cell(results.get((contestant.name, shown)), ours))
        rows.append(row)
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def versions() -> str:
    """Versions of all that took part, for the line under the table."""
    found = [f"Python {platform.python_version()}"]
    for package in _PACKAGES:
        try:
            found.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            continue
    return ", ".join(found)


def is_wanted(contestant: Contestant, case: str) -> bool:
    """Whether a race differs from all others."""
    if contestant.name == "maxima_frame":
        return load(case).coframe is not None
    return contestant.takes_coframe or case not in _SAME_METRIC


def _kept(path: Path | None) -> dict[tuple[str, str], Result]:
    if path is None or not path.exists():
        return {}
    found = (Result(**json.loads(line)) for line in path.read_text().splitlines())
    return {(r.contestant, r.case): r for r in found}


def main() -> None:
    """Command line: run all races and print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cases", nargs="+", default=NAMES, choices=NAMES, metavar="CASE")
    parser.add_argument("--contestants", nargs="+", default=[c.name for c in ALL], metavar="NAME")
    parser.add_argument("--limit", type=float, default=60.0, help="CPU seconds for a race")
    parser.add_argument("--turns", type=int, default=1, help="races of each, in turn")
    parser.add_argument("--keep", type=Path, help="file of results to resume from")
    chosen = parser.parse_args()
    results = _kept(chosen.keep)
    racing = [c for c in ALL if c.name in chosen.contestants and c.is_installed]
    for case in chosen.cases:
        keys = [(c.name, case) for c in racing if is_wanted(c, case)]
        keys = [key for key in keys if key not in results]
        for turn in range(chosen.turns):
            for key in keys:
                found = race(*key, limit=chosen.limit)
                if turn:
                    found.rounds += results[key].rounds
                    found.cpu += results[key].cpu
                results[key] = found
        for key in keys:
            print(cell(results[key]), *key, file=sys.stderr)
            if chosen.keep is not None:
                with chosen.keep.open("a") as file:
                    file.write(to_json(results[key]) + "\n")
    print(table(results))
    print(f"\n{versions()}")


if __name__ == "__main__":
    main()

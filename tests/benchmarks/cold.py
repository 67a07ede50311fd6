"""Cold: time of the very first call and of the import, and peak memory.

    python -m tests.benchmarks.cold [--cases so3 goedel] [--runs 3]

Each figure is the best of a few fresh processes. All use compiled bytecode, as in
an installed package. The first call is timed by itself, after `import geomtorsion` and
after the sympy expressions of the case have been made.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.benchmarks.cases import NAMES, load
from tests.benchmarks.compare import seconds

_ROOT = Path(__file__).resolve().parents[2]

_FIRST_CALL = """
import json, resource, sys, time
import geomtorsion
from tests.benchmarks.cases import load
from tests.benchmarks.geometry import whole_geometry
case = load(sys.argv[1])
start = time.perf_counter()
outcome = whole_geometry(case)
spent = time.perf_counter() - start
start = time.perf_counter()
whole_geometry(case)
again = time.perf_counter() - start
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(json.dumps([spent, again, memory, outcome.ricci_is_zero]))
"""

_IMPORT = """
import json, resource, sys, time
start = time.perf_counter()
__import__(sys.argv[1])
spent = time.perf_counter() - start
print(json.dumps([spent, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024]))
"""


def fresh(program: str, argument: str, runs: int, bytecode: str) -> list[list[float]]:
    """The figures that the program prints, from `runs` processes."""
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": bytecode}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)

    def output() -> str:
        return subprocess.run(
            [sys.executable, "-c", program, argument],
            cwd=_ROOT,
            env=environment,
            check=True,
            capture_output=True,
            text=True,
        ).stdout

    output()  # writes the bytecode
    return [json.loads(output()) for _ in range(runs)]


def first_calls(cases: list[str], runs: int, bytecode: str) -> str:
    """Markdown table: first call, second call in the same process, peak memory."""
    lines = ["| space | first call, cold | second call | peak memory |", "|---|---|---|---|"]
    for name in cases:
        figures = fresh(_FIRST_CALL, name, runs, bytecode)
        first, second, memory = (min(f[k] for f in figures) for k in range(3))
        note = ", Ricci not 0" if load(name).vacuum and not figures[0][3] else ""
        words = (load(name).title, seconds(first) + note, seconds(second), f"{memory:.0f} MB")
        lines.append("| " + " | ".join(words) + " |")
    return "\n".join(lines)


def imports(runs: int, bytecode: str) -> str:
    """Markdown table: import of sympy, and of geomtorsion including sympy."""
    lines = ["| import | time | peak memory |", "|---|---|---|"]
    for module in ("sympy", "geomtorsion"):
        figures = fresh(_IMPORT, module, max(runs, 5), bytecode)
        time, memory = (min(f[k] for f in figures) for k in range(2))
        lines.append(f"| {module} | {seconds(time)} | {memory:.0f} MB |")
    return "\n".join(lines)


def main() -> None:
    """Command line: print both tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cases", nargs="+", default=list(NAMES), choices=NAMES, metavar="CASE")
    parser.add_argument("--runs", type=int, default=3, help="processes for each figure")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as bytecode:
        print(imports(chosen.runs, bytecode))
        print()
        print(first_calls(chosen.cases, chosen.runs, bytecode))


if __name__ == "__main__":
    main()

"""Maxima: the package ctensor, in coordinates or in a moving frame, timed by Maxima itself."""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import sympy as sp
from sympy.core.function import AppliedUndef

from tests.benchmarks.cases import Case, sphere

_PRELUDE = """\
load(ctensor)$ display2d:false$ linel:1000000$
wavy(x):=ratsimp(trigsimp(x))$
"""

# One function holds the timed work, so that reading the commands is not timed: from matrices in
# Maxima's memory to Maxima's expressions. init_ctensor and the input are not timed either.
# ctensor leaves Ricci in coordinates and the invariant as sums, so these are simplified here.
# In a frame riemann computes the lower components first; lriemann would compute them again.
_WORK = """\
work():=(start:elapsed_real_time(), cpu:elapsed_run_time(),
cmetric(false), christof(false),
print("@ christoffel", elapsed_run_time()-cpu, elapsed_real_time()-start),
riemann(false), {lower}
print("@ riemann", elapsed_run_time()-cpu, elapsed_real_time()-start),
ricci(false), empty:true,
for i thru dim do for j from i thru dim do if {simple}(ric[i,j]) # 0 then empty:false,
print("@ ricci", elapsed_run_time()-cpu, elapsed_real_time()-start),
{diagonal} uriemann(false), rinvariant(), scalar:{simple}(kinvariant),
print("@ kretschmann", elapsed_run_time()-cpu, elapsed_real_time()-start))$
"""
_ROUND = """\
init_ctensor()$ dim:{n}$ ctrgsimp:{waves}$ cframe_flag:{frame}$ ct_coords:{coordinates}$
{given}
work()$
"""
_REPORT = 'print("@ empty", empty)$ print("@ scalar", string(scalar))$\n'


def environment() -> dict[str, str] | None:
    """Environment for Maxima: the one on the PATH, else the wheel of passagemath-maxima."""
    if shutil.which("maxima"):
        return dict(os.environ)
    wheel = find_spec("sage_wheels")
    if wheel is None or not wheel.submodule_search_locations:
        return None
    root = Path(next(iter(wheel.submodule_search_locations)))
    lisp = next(root.glob("lib/ecl-*"), None)
    if lisp is None or not (root / "bin" / "maxima").exists():
        return None
    found = {"MAXIMA_PREFIX": str(root), "ECLDIR": f"{lisp}/"}
    return {**os.environ, **found, "PATH": f"{root / 'bin'}{os.pathsep}{os.environ['PATH']}"}


def _matrix(matrix: sp.ImmutableMatrix) -> str:
    """The matrix in Maxima's syntax; unknown functions appear by name only."""
    names = {f: sp.Symbol(f.func.__name__) for f in matrix.atoms(AppliedUndef)}
    rows = (",".join(str(entry.subs(names)) for entry in matrix.row(i)) for i in range(matrix.rows))
    return "matrix(" + ",".join(f"[{row}]" for row in rows) + ")"


def _script(case: Case, frame: bool, rounds: int) -> str:
    """The function with the work, and `rounds` calls of it."""
    given = f"lg:{_matrix(case.metric)}$"
    if frame and case.coframe is not None:
        eta = sp.diag(*case.signature).as_immutable()
        given = f"lfg:{_matrix(eta)}$ fri:{_matrix(case.coframe)}$"
    # Without sine and cosine trigsimp takes three times as long and changes nothing.
    waves = case.metric.has(sp.sin, sp.cos)
    work = _WORK.format(
        lower="" if frame else "lriemann(false),",
        simple="wavy" if waves else "ratsimp",
        # In a frame eta is diagonal; ctensor needs a flag for this, and then saves triple sums.
        diagonal="diagmetric:true," if frame else "",
    )
    once = _ROUND.format(
        n=case.dimension,
        waves=str(waves).lower(),
        frame=str(frame).lower(),
        coordinates=f"[{','.join(map(str, case.coordinates))}]",
        given=given,
    )
    return work + once * rounds


def run(case: Case, frame: bool, rounds: int) -> Iterator[tuple[str, str]]:
    """Lines of a session as they come: (stage, two times), ('empty', ...), ('scalar', text)."""
    declared = "".join(
        f"depends({f.func.__name__},[{','.join(map(str, f.args))}])$"
        for f in sorted(case.metric.atoms(AppliedUndef), key=str)
    )
    text = _PRELUDE + _script(sphere(), frame, 1) + 'print("@ warm")$\n'
    text += declared + "\n" + _script(case, frame, rounds) + _REPORT
    # Maxima's Lisp survives the signal of a soft limit, so the limit is made hard.
    soft, _ = resource.getrlimit(resource.RLIMIT_CPU)
    final = "unlimited" if soft == resource.RLIM_INFINITY else soft
    command = ["sh", "-c", f"ulimit -t {final}; exec maxima --very-quiet"]
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=environment(),
        text=True,
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(text)
        process.stdin.close()
        for line in process.stdout:
            if line.startswith("@ "):
                stage, _, rest = line[2:].strip().partition(" ")
                yield stage, rest.strip()


def to_sympy(text: str, case: Case) -> sp.Expr:
    """Maxima's answer as sympy: rational in coordinates, exp, sin, cos and 'diff(A,t,2)."""
    functions = {f.func.__name__: f for f in case.metric.atoms(AppliedUndef)}
    names = {**{str(q): q for q in case.coordinates}, **functions}

    def derivative(match: re.Match[str]) -> str:
        return f"Derivative({match[1]})"

    python = re.sub(r"'diff\(([^()]*)\)", derivative, text.replace("^", "**").replace("%e", "E"))
    return sp.sympify(
        re.sub(r"(\w+),(\d+)(?=[,)])", r"(\1,\2)", python), locals={**names, "E": sp.E}
    )

"""dop853: the steps of DOP853 and their polynomials as generated code on plain floats."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from scipy.integrate import DOP853

from geomtorsion.codegen import Graph, compiled
from geomtorsion.ode.rates import KEPT
from geomtorsion.ode.system import System

STAGES: int = DOP853.n_stages
# Rates whose source has more characters than this are called, not written into the step.
LONGEST_SOURCE = 4000


def step_of(system: System) -> Callable[..., Any]:
    """The step of a system: `step(rates, h, rtol, floors, y, y', parameters)`, all spread out.

    It returns error measures of orders five and three, new states, new rates, all stages.
    """
    return _made("step", system.size, system.rates)


def rows_of(system: System) -> Callable[..., Any]:
    """Dense output of a step: `rows(rates, h, y, y', new y, new y', stages, parameters)`.

    It returns seven rows of coefficients, three more stages being worked out.
    """
    return _made("rows", system.size, system.rates)


@lru_cache(maxsize=KEPT)
def _made(name: str, n: int, rates: Graph) -> Callable[..., Any]:
    """A function of the writer; equal rates give the same one."""
    writer = _writer(n, rates)
    code = "\n    ".join(writer.step() if name == "step" else writer.rows())
    return compiled(code, "floats", name)


def _writer(n: int, rates: Graph) -> _Writer:
    """The writer for rates of n states."""
    values = tuple(f"a{k}" for k in range(n, len(rates.arguments)))
    if len(rates.python_source()) > LONGEST_SOURCE:
        return _Writer(n, values, tuple(range(n)), (), ())
    asked = {step.detail for step in rates.steps if step.kind == "argument"}
    return _Writer(n, values, tuple(k for k in range(n) if k in asked), *rates.python_body)


@dataclass(frozen=True)
class _Writer:
    """Writes functions line by line.

    n: number of states, which rates know as a0, a1, ...; values: names of the parameters.
    needed: the states that rates ask for; others need not be worked out on the way.
    body, results: the rates written out; where there are none, they are called.
    """

    n: int
    values: tuple[str, ...]
    needed: tuple[int, ...]
    body: tuple[str, ...]
    results: tuple[str, ...]

    def _all(self, letter: str) -> str:
        return ", ".join(f"{letter}{i}" for i in range(self.n))

    def _combined(self, row: Sequence[float], i: int) -> str:
        return " + ".join(f"{float(a)!r}*k{s}_{i}" for s, a in enumerate(row) if a)

    def _rates(self, s: int) -> list[str]:
        """A stage from the states a0, a1, ..."""
        if not self.results:
            return [f"{self._all(f'k{s}_')}, = rates({', '.join((self._all('a'), *self.values))})"]
        return [*self.body, *(f"k{s}_{i} = {one}" for i, one in enumerate(self.results))]

    def _stage(self, s: int, row: Sequence[float]) -> list[str]:
        places = [f"a{i} = y{i} + h*({self._combined(row, i)})" for i in self.needed]
        return [*places, *self._rates(s)]

    def step(self) -> list[str]:
        """Source of `step`, see `step_of`."""
        tables, each = DOP853, range(self.n)
        given = ["rates", "h", "rtol", *map(self._all, ("floor", "y", "k0_")), *self.values]
        lines = [f"def step({', '.join(given)}):"]
        for s in range(1, STAGES):
            lines += self._stage(s, tables.A[s, :s])
        lines += [f"d{i} = {self._combined(tables.B, i)}" for i in each]
        lines += [f"n{i} = y{i} + h*d{i}" for i in each]
        lines += [f"a{i} = n{i}" for i in self.needed]
        lines += self._rates(STAGES)
        lines.append("fifth = third = 0.0")
        # Of order three is what the new states are made of, but for three stages.
        gaps = [a - b for a, b in zip(tables.B, tables.E3, strict=False)]
        lower = [a if abs(a) > 1e-15 else 0.0 for a in gaps]
        for i in each:
            lines.append(f"a = abs(y{i}); b = abs(n{i}); s = floor{i} + rtol*(a if a > b else b)")
            lines.append(f"e = ({self._combined(tables.E5, i)})/s; fifth += e*e")
            lines.append(f"e = (d{i} - ({self._combined(lower, i)}))/s; third += e*e")
        every = ", ".join(self._all(f"k{s}_") for s in range(1, STAGES))
        parts = f"({self._all('n')},), ({self._all(f'k{STAGES}_')},), ({every},)"
        return [*lines, f"return fifth, third, {parts}"]

    def rows(self) -> list[str]:
        """Source of `rows`, see `rows_of`."""
        tables, each = DOP853, range(self.n)
        stages = [f"k{s}_" for s in range(1, STAGES)]
        spread = map(self._all, ("y", "k0_", "n", f"k{STAGES}_", *stages))
        lines = [f"def rows({', '.join(['rates', 'h', *spread, *self.values])}):"]
        for s, row in enumerate(tables.A_EXTRA, STAGES + 1):
            lines += self._stage(s, row[:s])
        lines += [f"d{i} = n{i} - y{i}" for i in each]
        rows = [
            [f"d{i}" for i in each],
            [f"h*k0_{i} - d{i}" for i in each],
            [f"2*d{i} - h*(k{STAGES}_{i} + k0_{i})" for i in each],
            *([f"h*({self._combined(row, i)})" for i in each] for row in tables.D),
        ]
        return [*lines, f"return ({', '.join(f'({chr(44).join(row)},)' for row in rows)})"]

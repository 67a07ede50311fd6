"""Files: solved motions read from the files that they were written to."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import FileFormatError, GeomtorsionError, StartError
from geomtorsion.ode.constructor import check_declared, declared_symbols
from geomtorsion.ode.engines import Engine
from geomtorsion.ode.engines.named import engine_named, is_own
from geomtorsion.ode.moment import Moment
from geomtorsion.ode.numbers import checked_times
from geomtorsion.ode.problem import ODE
from geomtorsion.ode.solution import DOUBLE, Cost, Solution
from geomtorsion.ode.terms import At, When
from geomtorsion.ode.trajectory import integrate
from geomtorsion.ode.writing import FORMAT
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import DECLARED, cut, shown
from geomtorsion.support.npz import TEXT_FORM, ArrayForm, json_in, read_npz

_FORMS = {
    "metadata": TEXT_FORM,
    # A file of another version may lack them, and is to be named as such.
    "grid": ArrayForm(("grid",), "f", optional=True),
    "times": ArrayForm(("m",), "f", optional=True),
    "value *": ArrayForm(("m", ...), "f"),
}
_RATIONAL = re.compile(r"-?[0-9]{1,4000}(?:/0*[1-9][0-9]{0,3999})?")
_TERMS = {str: (str, [str])}
_PROBLEM = {
    "rates": {str: str},
    "start": [str],
    "parameters": {str: str},
    "invariants": _TERMS,
    "outputs": _TERMS,
    "time": str,
    "events": [[((float, str), {str: str})]],
    "stop": (str, [str], None),
    "switches?": [[(str, {str: str})]],
    "resting?": [str],
    "varied?": [str],
    "norm_groups": [[str]],
    "normalized": [[str]],
    "name": str,
    "declared?": {str: [frozenset(DECLARED)]},
}
_METADATA = {
    "format": int,
    "kind": str,
    "problem": {},
    "accuracy": float,
    "error": float,
    "engine": str,
    "reason": str,
    "outcome": str,
    "cost": {},
    "drift": {str: float},
    "whole": [str],
    "made": {"engine": str, "tolerance": str, "unit": float},
}
_BAD = "{path}: this is not a solution saved by Solution.save ({reason}). Save the solution again."


@dataclass(frozen=True, eq=False)
class SavedSolution(Mapping[str, np.ndarray]):
    """A saved solution: arrays by name, and metadata.

    times: shape (m,); moment: everything at the times (see `Moment`).
    metadata: problem, accuracy, error, engine, reason, outcome, cost, drift.
    problem: the equations, unless they belong to a curve in a space; else None.

    Examples
    --------
    >>> import tempfile
    >>> from geomtorsion.ode import solve
    >>> file = Path(tempfile.mkdtemp(), "decay.npz")
    >>> solve(ODE.of({"x": "-x"}, [1]), 1.0).save(file)
    >>> saved = SavedSolution.load(file)
    >>> saved.error < 1e-10, round(float(saved["x"][-1]), 9)
    (True, 0.367879441)
    """

    times: np.ndarray
    moment: Moment
    metadata: Mapping[str, Any]
    grid: np.ndarray
    problem: ODE | None = None

    @property
    def error(self) -> float:
        """Error estimate of the saved values, which are doubles."""
        error = float(self.metadata["error"])
        return error if self.metadata["accuracy"] >= DOUBLE else max(error, DOUBLE)

    def __getitem__(self, name: str) -> np.ndarray:
        return self.moment[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.moment)

    def __len__(self) -> int:
        return len(self.moment)

    @cached_property
    def solution(self) -> Solution:
        """The solution, integrated again; equal to the bit on the same machine.

        Raises
        ------
        StartError
            it was a curve in a space, of which the file contains only arrays; or it was made by an
            engine that this package does not contain.
        """
        if self.problem is None:
            raise StartError(
                "expected one of the saved times, got another: a saved curve has values only "
                "there. Solve the problem again for values in between."
            )
        origin, engine = self.metadata["made"], _engine(self.metadata)
        if engine is None:
            raise StartError(
                "expected a solution by Taylor, RungeKutta or Stiff, got one by "
                f"{shown(self.metadata['engine'])}, an engine that files cannot keep. Read the "
                "values at the saved times, or solve `problem` again with that engine."
            )
        stage = self.problem.first_stage(engine.precision, 0.0)
        again = integrate(stage, self.grid, _tolerance(origin["tolerance"]), engine)
        data = self.metadata
        cost = Cost.of(again, [again])
        return Solution(
            self.problem, self.times, data["accuracy"], data["error"], data["engine"],
            data["reason"], cost, again,
        )  # fmt: skip

    def at(self, time: Any) -> Moment:
        """Everything at any time up to the last; the first call integrates the problem again.

        Raises
        ------
        StartError
            as `solution`.
        """
        return self.solution.at(time)

    @classmethod
    def load(cls, path: str | Path) -> SavedSolution:
        """Read what `Solution.save` wrote; nothing in the file is run.

        Raises
        ------
        FileFormatError
            the file is missing, or was not written by `Solution.save`.
        """
        arrays = read_npz(path, _FORMS, message=_BAD)
        header = json_in(arrays, "metadata", {"format?": int}, path=path, message=_BAD)
        if header.get("format", FORMAT) != FORMAT:
            raise FileFormatError(
                f"{path}: expected format {FORMAT}, got {shown(header['format'])}. Use the version "
                "of geomtorsion that wrote it."
            )
        form = _METADATA | ({"problem": _PROBLEM} if header.get("kind") == "ode" else {})
        metadata = json_in(arrays, "metadata", form, path=path, message=_BAD)
        missing = [key for key in ("grid", "times") if key not in arrays]
        if missing:
            raise FileFormatError(_BAD.format(path=path, reason=f"{missing[0]} is missing"))
        values = {
            key.removeprefix("value "): value
            for key, value in arrays.items()
            if key.startswith("value ")
        }
        moment = Moment(arrays["times"], values, tuple(metadata["whole"]))
        problem, part = None, "grid"
        try:
            _check_times(arrays["times"], arrays["grid"])
            part = "metadata: made"
            _ = _tolerance(metadata["made"]["tolerance"]), _engine(metadata)
            part = "metadata: whole"
            if not set(metadata["whole"]) <= set(values):
                raise ValueError("it names arrays that are missing")
            if metadata["kind"] == "ode":
                part = "metadata: problem"
                problem = _problem(metadata["problem"])
                part = "value states"
                if values["states"].shape != (len(arrays["times"]), problem.size):
                    raise ValueError(f"shape {values['states'].shape} does not fit the equations")
        except (
            GeomtorsionError, KeyError, TypeError, ValueError, AttributeError, ArithmeticError,
        ) as error:  # fmt: skip
            reason = f"{part}: {cut(str(error).removesuffix('.'))}"
            raise FileFormatError(_BAD.format(path=path, reason=reason)) from None
        return cls(arrays["times"], moment, metadata, arrays["grid"], problem)


def _problem(data: Mapping[str, Any]) -> ODE:
    """The equations that were described; nothing in the text is run."""
    events: list[At | When] = [At(at, _changes(changes)) for at, changes in data["events"]]
    events += [When(falls, _changes(changes)) for falls, changes in data.get("switches", [])]
    stops = data["stop"]
    if stops is not None:
        events += [When(stop) for stop in (stops if isinstance(stops, list) else [stops])]
    problem = ODE.of(
        data["rates"],
        [_value(x) for x in data["start"]],
        parameters={name: _value(x) for name, x in data["parameters"].items()},
        invariants=data["invariants"],
        outputs=data["outputs"],
        time=data["time"],
        events=events,
        norm_groups=data["norm_groups"],
        normalized=data["normalized"],
        name=str(data["name"]),
    )
    # The text of a symbol does not contain its assumptions.
    declared = declared_symbols(data.get("declared", {}))
    check_declared(declared, problem.parameters)
    varied = tuple(data.get("varied", ()))
    if varied and len(problem.states) % (1 + len(varied)):
        raise ValueError("varied does not fit the states")
    resting = tuple(data.get("resting", ()))
    if not {*resting} <= {*problem.states}:
        raise ValueError("resting names other states")
    rates = replace(problem.rates, declared=declared)
    return replace(problem, rates=rates, varied=varied, resting=resting)


def _changes(table: Mapping[str, Any]) -> dict[str, Any]:
    """New values by name: numbers, or expressions."""
    return {name: _value(x) for name, x in table.items()}


def _check_times(times: np.ndarray, grid: np.ndarray) -> None:
    """Refuse times that no solution has, and a grid that does not go through them."""
    checked_times(grid)
    if grid[0] != 0 or len(times) < len(grid) - 1 or len(times) > len(grid):
        raise ValueError("it does not begin at 0 and go through the times")
    if len(times) == 0 or (grid[len(grid) - len(times) :] != times).any():
        raise ValueError("it does not go through the times")


def _tolerance(text: str) -> float:
    """A tolerance as it was written: a positive float in hexadecimal digits."""
    tolerance = float.fromhex(text)
    if not 0 < tolerance < np.inf:
        raise ValueError(f"{text} is not a tolerance")
    return tolerance


def _engine(metadata: Mapping[str, Any]) -> Engine | None:
    """The engine that made the samples; None for an engine of the user's own."""
    name = metadata["engine"]
    # Older files name another engine in `made` where the engine was the user's own.
    return engine_named(name) if metadata["made"]["engine"] and is_own(name) else None


def _value(text: Any) -> Any:
    """A number from its text: a float, a fraction or an expression such as sqrt(2)."""
    if not isinstance(text, str):
        raise FileFormatError(f"{shown(text)}: expected a number as text.")
    if text.startswith("f"):
        return float.fromhex(text[1:])
    if text.startswith("= "):
        return text[2:]
    # Only as `number_text` writes it: an exponent could ask for a number of any length.
    return Fraction(text) if _RATIONAL.fullmatch(text) else text

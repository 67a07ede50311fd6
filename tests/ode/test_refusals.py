"""Refusals of equations and solutions: each call, the class of its error, and words of it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import (
    AccuracyError,
    ExpressionError,
    FileFormatError,
    ShapeError,
    StartError,
    TimeError,
    UnknownNameError,
)
from geomtorsion.ode import At, RungeKutta, When

# Without types, for calls that are wrong on purpose.
wrong: Any = gt
NAN = float("nan")
solve, many = wrong.solve, wrong.solve_many


def ode(rates: Any, start: Any, **more: Any) -> gt.ODE:
    """Equations, without types."""
    return wrong.ODE.of(rates, start, **more)


def swing(**more: Any) -> gt.ODE:
    """x'' = -k x."""
    return ode({"x": "v", "v": "-k*x"}, {"x": 1, "v": 0}, **({"parameters": {"k": 4}} | more))


def pair(normalized: str) -> gt.ODE:
    """Two constant states, declared to have length 1 together."""
    return ode({"a": 0, "b": 0}, [1, 1], normalized=[normalized])


EQUATIONS = [
    (lambda: ode({"x": 0, "y": 0}, [1]), ShapeError, "expected 2 numbers"),
    (lambda: ode({"x": 0, "y": 0}, {"x": 1}),
     StartError, "start: expected a value for y, got none"),
    (lambda: ode({"x": 0}, {"x": 1, "z": 2}), UnknownNameError, "expected a state, got 'z'"),
    (lambda: ode({"x": 0}, [NAN]), StartError, "start of x: expected a finite number, got nan"),
    (lambda: swing(parameters={"k": [1]}), StartError, r"k: expected a number, got \[1\]"),
    (lambda: swing().with_start(parameters={"kk": 1}),
     UnknownNameError, "expected a parameter, got 'kk'. Did you mean k"),
    (lambda: swing(events=[At(-1, {"k": 2})]),
     TimeError, "expected a time of 0 or later, got t = -1"),
    (lambda: swing(events=[At(1, {"w": 2})]),
     UnknownNameError, "a parameter or a state, got 'w'"),
    (lambda: swing(events=When("x")), TimeError, r"^events: expected a list .*, got When.*Write "),
    (lambda: swing(events=[1.0]), TimeError, r"event: expected At\(.*, got 1.0"),
    (lambda: pair("ab"), StartError, "of length 1 together"),
    (lambda: pair("az"), UnknownNameError, "expected states, got 'z'"),
    (lambda: swing(outputs={"x": "v"}), ExpressionError, "outputs: expected new names, got x"),
    (lambda: swing(outputs={1: "v"}), ExpressionError, "outputs: expected names as keys, got 1"),
    (lambda: ode(3, [1]), ExpressionError, "a mapping from states"),
]  # fmt: skip
SOLUTIONS = [
    (lambda: solve(3, 1.0), StartError, "expected a problem .* or an ODE, got "),
    (lambda: solve(swing(), 50.0, 1e-17, RungeKutta()), AccuracyError, "RungeKutta gets to"),
    (lambda: solve(swing(), 1.0, 0), AccuracyError, "positive"),
    (lambda: solve(swing(), 1.0, NAN), AccuracyError, "positive"),
    (lambda: solve(swing(), [1.0, 1.0]), TimeError, "expected different times"),
    (lambda: solve(swing(), 1.0).at(1.5), TimeError, "from 0 to 1, the range"),
    (lambda: solve(swing(), 1.0).at(-0.1), TimeError, "from 0 to 1, the range"),
]
ENSEMBLES = [
    (lambda: many(swing(), [[1, 2, 3]], 1.0), ShapeError, r"shape \(number, 2\)"),
    (lambda: many(swing(), {"x": [1, 2], "k": [1, 2, 3]}, 1.0), ShapeError, "one common length"),
    (lambda: many(swing(), {"kk": [1]}, 1.0),
     UnknownNameError, "a state or a parameter, got 'kk'. Did you mean k"),
    (lambda: many(swing(), {"x": [1, float("inf")]}, 1.0), StartError, "not finite"),
    (lambda: many(swing(), {"x": [1.0]}),
     TimeError, "t: expected the last time or a list of times, got none"),
    (lambda: many(ode({"a": 0, "b": 0}, [1, 0], normalized=["ab"]), {"a": [1.0, 2.0]}, 1.0),
     StartError, "length 1 together"),
    (lambda: many(ode({"x": -1}, [1], events=[When("x")]), {"x": [1.0, -2.0]}, 1.0),
     StartError, r"expected stop above zero at the start, got x = -2 for member 1"),
    (lambda: many(swing(), {"x": [1.0]}, 1.0, velocities=[[1.0]]), StartError, "has only states"),
    (lambda: many(swing(), {"x": [1.0]}, 50.0, 1e-17, engine=RungeKutta()),
     AccuracyError, "gets to"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), EQUATIONS + SOLUTIONS + ENSEMBLES)
def test_bad_calls_are_refused(
    call: Callable[[], object], error: type[Exception], words: str
) -> None:
    """Each bad argument has an error of its own class, which names the mistake."""
    with pytest.raises(error, match=words):
        call()


FILES: dict[str, tuple[Callable[[Path], object], str]] = {
    "missing": (lambda path: None, "not a solution saved"),
    "other arrays": (lambda path: np.savez(path, a=np.zeros(3)), "not a solution saved"),
    "no archive": (lambda path: path.write_text("no archive"), "not a solution saved"),
    "another format": (
        lambda path: np.savez(path, metadata=np.array('{"format": 99}')),
        "expected format .*, got 99",
    ),
}


@pytest.mark.parametrize("case", FILES)
def test_files_other_than_solutions_are_refused(tmp_path: Path, case: str) -> None:
    """The error of a file names the expected content."""
    write, words = FILES[case]
    write(tmp_path / "a.npz")
    with pytest.raises(FileFormatError, match=words):
        gt.SavedSolution.load(tmp_path / "a.npz")

"""solved_theories: the theory of a file solved, as data, in words and as files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import typer

from geomtorsion.cli.budgets import write_budget
from geomtorsion.cli.terminal import right_aligned, some_rows
from geomtorsion.cli.theories import model_of
from geomtorsion.cli.values import number
from geomtorsion.errors import ArgumentError, FileFormatError
from geomtorsion.gravity import Model, Reduction, Shooting
from geomtorsion.ode import Solution
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.prices import EffectBudget, called_for
from geomtorsion.proofs import Proof, prove
from geomtorsion.support.checks import shown
from geomtorsion.support.files import make_folder
from geomtorsion.support.outgoing import number_text

# Characters of a number in a table, and its digits.
WIDTH = len("  -1.234567e-8")
DIGITS = len("1234567")


class Request(NamedTuple):
    """The accuracy for which terms are to be chosen, and the functions that count."""

    accuracy: float
    watch: list[str] | None


@dataclass(frozen=True, kw_only=True)
class SolvedTheory:
    """A theory of a file with its solution, perhaps proved and with the terms that it calls for."""

    model: Model
    reduction: Reduction
    result: Solution | Shooting
    proof: Proof | None
    budget: EffectBudget | None

    @classmethod
    def of(
        cls,
        source: str,
        text: str,
        accuracy: float,
        step: Callable[[str], object],
        *,
        proved: bool,
        request: Request | None,
    ) -> SolvedTheory:
        """Solve the theory of a file; text: a coordinate and its last value, such as t=10."""
        variable, sign, last = text.partition("=")
        if not sign:
            raise ArgumentError(
                f"--solve: expected a coordinate and its last value, got {shown(text)}. Write "
                "--solve t=10."
            )
        end = number(last, "--solve")
        model = model_of(source)
        if model is None:
            raise FileFormatError(
                f"--solve: expected a tetrad file with a table [theory], got {shown(source)}. "
                "Write one with a lagrangian and a start."
            )
        reduction = model.reduce(variable.strip())
        step("solution")
        result = _result(model, reduction.variable, end, accuracy, request)
        solution = result.solution if isinstance(result, Shooting) else result
        proof = prove(solution) if proved else None
        budget = None
        if request is not None:
            step("terms")
            budget = called_for(solution, request.accuracy, watch=request.watch)
        return cls(model=model, reduction=reduction, result=result, proof=proof, budget=budget)

    @property
    def solution(self) -> Solution:
        """The solution from the start."""
        return self.result.solution if isinstance(self.result, Shooting) else self.result

    def document(self) -> dict[str, Any]:
        """The theory, its equations and its solution as plain data."""
        reduction = self.reduction
        return {
            "space": self.model.space.name,
            "lagrangian": str(self.model.equations.lagrangian.expression),
            "rates": {name: str(rate) for name, rate in reduction.rates.items()},
            "constraints": [str(one) for one in reduction.constraints],
            **self.result.to_json(),
            "proved": None if self.proof is None else self.proof.holds,
            "called_for": None if self.budget is None else self.budget.to_json(),
        }

    def show(self) -> None:
        """Print the theory, a table of the solution, its errors and its proof."""
        lagrangian = self.model.equations.lagrangian.expression
        typer.secho(f"{self.model.space.name}: L = {lagrangian}", bold=True)
        typer.echo(f"{self.reduction}\n")
        typer.echo("\n".join(self._table()))
        typer.echo(f"\n{self.result}")
        if self.proof is not None:
            typer.echo(str(self.proof))
        if self.budget is not None:
            typer.echo(f"\n{self.budget}")

    def write(self, folder: Path) -> list[Path]:
        """Write the solution and, with matplotlib, its picture; the files that were written."""
        make_folder(folder)
        paths = [folder / "solution.npz"]
        self.solution.save(paths[0])
        if can_draw():
            paths.append(folder / "solution.png")
            save(self.solution.plot(), paths[1])
        return paths if self.budget is None else paths + write_budget(self.budget, folder, "png")

    def _table(self) -> Iterator[str]:
        """Some rows of the variable, the states and the outputs."""
        reduction = self.reduction
        names = [reduction.variable, *reduction.states, *reduction.outputs, *self.model.outputs]
        columns = {name: _column(self.solution, name) for name in names}
        errors = {name: _error(self.solution, name) for name in names}
        yield right_aligned(names, WIDTH)
        for row in some_rows(len(self.solution.times)):
            cells = [number_text(float(columns[name][row]), errors[name]) for name in names]
            yield right_aligned([cell[: WIDTH - 2] for cell in cells], WIDTH)


def _result(
    model: Model, variable: str, end: float, accuracy: float, request: Request | None
) -> Solution | Shooting:
    """The solution of a model, by shooting where it has boundary values."""
    if not (model.boundary or model.free):
        return model.solve(variable, end, accuracy)
    if request is not None:
        raise ArgumentError(
            "--called-for: expected a theory with a start, got one with boundary values, "
            "which each omitted term would reach from another start. Write the start "
            "without a table boundary."
        )
    return model.shoot(variable, end, accuracy)


def _column(solution: Solution, name: str) -> np.ndarray:
    """Values of a state or an output, or of the variable where it is the time."""
    return solution.times if name == solution.problem.time_name else solution[name]


def _error(solution: Solution, name: str) -> float:
    """The absolute error with which a column is printed, of at least the printed digits."""
    values = np.abs(_column(solution, name))
    relative = 0.0 if name == solution.problem.time_name else solution.error_of(name)
    return float(values.max()) * max(relative, 10.0**-DIGITS)

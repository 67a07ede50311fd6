"""Files: solved flows written to NPZ files, and read from them again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import sympy as sp

from geomtorsion.errors import FileFormatError, GeomtorsionError
from geomtorsion.motion.engines import Engine, RungeKutta, Stiff, Taylor
from geomtorsion.motion.flows.intake import flow as made_flow
from geomtorsion.motion.solution import Cost

if TYPE_CHECKING:
    from geomtorsion.motion.flows.flow import Flow
    from geomtorsion.motion.flows.solution import FlowSolution

FORMAT = 1


def save(solution: FlowSolution, path: str | Path) -> None:
    """Write arrays (as doubles) and metadata."""
    import numpy as np

    flow = solution.flow
    metadata = {
        "format": FORMAT,
        "flow": described(flow),
        "accuracy": solution.accuracy,
        "error": solution.error,
        "engine": solution.engine,
        "why": solution.why,
        "outcome": solution.outcome,
        "reason": solution.reason,
        "cost": {name: float(value) for name, value in vars(solution.cost).items()},
        "drift": {name: float(value) for name, value in solution.drift.items()},
        "made": solution.recipe.described(),
    }
    arrays: dict[str, Any] = {f"output {name}": solution[name] for name in flow.outputs}
    states = np.asarray(solution.states).astype(float)
    np.savez_compressed(
        path,
        metadata=np.array(json.dumps(metadata)),
        times=solution.times,
        states=states,
        grid=solution.recipe.grid,
        **arrays,
    )


def described(flow: Flow) -> dict[str, Any]:
    """A flow as plain text and numbers as text."""
    return {
        "rates": {name: _text(rate) for name, rate in flow.law.rates.items()},
        "start": [_number(x) for x in flow.start],
        "parameters": {name: _number(x) for name, x in flow.parameters.items()},
        "invariants": {name: _texts(term) for name, term in flow.invariants.items()},
        "outputs": {name: _texts(term) for name, term in flow.outputs.items()},
        "time": flow.law.time,
        "switches": [
            [at, {name: _number(x) for name, x in values.items()}] for at, values in flow.switches
        ],
        "stop": None if flow.law.stop is None else _text(flow.law.stop),
        "blocks": [list(block) for block in flow.law.blocks],
        "unit": [list(group) for group in flow.unit],
        "name": flow.name,
    }


def load(path: str | Path) -> dict[str, Any]:
    """What `save` wrote, as the fields of a solution.

    Raises
    ------
    FileFormatError
        the file is missing, or was not written by `FlowSolution.save`.
    """
    import numpy as np

    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as data:
            arrays = {name: data[name] for name in data.files if name != "metadata"}
            metadata = json.loads(str(data["metadata"]))
        if metadata.get("format") != FORMAT:
            raise FileFormatError(
                f"{path}: format {metadata.get('format')} was found, {FORMAT} is known. "
                "Use the version of geomtorsion that wrote it."
            )
        flow = flow_of(metadata["flow"])
        numbers = metadata["cost"]
        counts = {name: int(numbers[name]) for name in ("steps", "evaluations")}
        cost = Cost(**(numbers | counts))
        made = metadata["made"]
        fields = {key: metadata[key] for key in ("accuracy", "error", "engine", "why")}
        fields |= {key: metadata[key] for key in ("outcome", "reason")}
        grid, times, states = (arrays.pop(name) for name in ("grid", "times", "states"))
    except FileFormatError:
        raise
    except (
        OSError, KeyError, ValueError, TypeError, AttributeError, EOFError, BadZipFile,
        GeomtorsionError,
    ) as error:  # fmt: skip
        raise FileFormatError(
            f"{path}: this is no solution saved by FlowSolution.save ({error}). "
            "Save the solution again."
        ) from None
    return fields | {
        "flow": flow,
        "times": times,
        "states": states,
        "cost": cost,
        "made": made,
        "grid": grid,
        "outputs": {name.removeprefix("output "): value for name, value in arrays.items()},
    }


def flow_of(data: Mapping[str, Any]) -> Flow:
    """The flow that was described; nothing in the text is run."""
    return made_flow(
        data["rates"],
        [_value(x) for x in data["start"]],
        parameters={name: _value(x) for name, x in data["parameters"].items()},
        invariants=data["invariants"],
        outputs=data["outputs"],
        time=data["time"],
        switches=[
            (at, {name: _value(x) for name, x in values.items()}) for at, values in data["switches"]
        ],
        stop=data["stop"],
        blocks=data["blocks"],
        unit=data["unit"],
        name=data["name"],
    )


def engine_of(text: str) -> Engine:
    """The engine whose repr this is, as far as it decides what is computed."""
    name, _, rest = text.partition(":")
    if name == "Taylor":
        precision, optimised = rest.split(",")
        return Taylor(int(precision), {"True": True, "False": False}.get(optimised))
    return Stiff(rest) if name == "Stiff" else RungeKutta()


def engine_text(engine: Engine) -> str:
    """An engine in a word."""
    if isinstance(engine, Taylor):
        return f"Taylor:{engine.precision},{engine.optimised}"
    return f"Stiff:{engine.method}" if isinstance(engine, Stiff) else "RungeKutta:"


def _text(term: sp.Expr) -> str:
    """An expression with its floats as the fractions that they are."""
    return str(term.xreplace({number: sp.Rational(number) for number in term.atoms(sp.Float)}))


def _texts(term: Any) -> Any:
    return [_text(part) for part in term] if isinstance(term, tuple) else _text(term)


def _number(value: Any) -> str:
    return f"f{value.hex()}" if isinstance(value, float) else str(value)


def _value(text: str) -> Any:
    """A number from its text: a float, a fraction or an expression such as sqrt(2)."""
    if text.startswith("f"):
        return float.fromhex(text[1:])
    try:
        return Fraction(text)
    except ValueError:
        return text

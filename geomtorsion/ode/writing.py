"""Writing: solved motions as files, and as tables of pandas."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.errors import MissingExtraError
from geomtorsion.ode.engines.named import own_name
from geomtorsion.ode.moment import Moment
from geomtorsion.ode.numbers import Real
from geomtorsion.ode.trajectory import Trajectory
from geomtorsion.support import checks
from geomtorsion.support.files import written
from geomtorsion.support.npz import write_npz
from geomtorsion.support.outgoing import json_number

# Version of the format of `write_solution`.
FORMAT = 2


def write_solution(
    path: str | Path,
    times: np.ndarray,
    moment: Moment,
    trajectory: Trajectory,
    unit: float,
    known: Mapping[str, object],
) -> None:
    """Write arrays (as doubles) and metadata.

    unit: trajectories count time in units of 1/unit; known: further metadata, by name.
    """
    metadata = {
        "format": FORMAT,
        **known,
        "whole": list(moment.whole),
        "made": {
            "engine": own_name(trajectory.engine),
            "tolerance": trajectory.tolerance.hex(),
            "unit": unit,
        },
    }
    plain = {f"value {x}": np.asarray(y).astype(float) for x, y in moment.values.items()}
    times = times.astype(float)
    grid = times if times[0] == 0 else np.concatenate(([0.0], times))
    file = checks.file_name(path)
    # As numpy names files of arrays.
    if file.name and file.suffix != ".npz":
        file = file.with_name(f"{file.name}.npz")
    with written(file) as part:
        write_npz(part, {"metadata": json.dumps(metadata), "times": times, "grid": grid, **plain})


def term_text(term: sp.Expr) -> str:
    """An expression with its floats as exact fractions."""
    return str(term.xreplace({number: sp.Rational(number) for number in term.atoms(sp.Float)}))


def terms_text(term: sp.Expr | tuple[sp.Expr, ...]) -> str | list[str]:
    """Text of one term, or of each component of a vector."""
    return [term_text(part) for part in term] if isinstance(term, tuple) else term_text(term)


def number_text(value: Any) -> str:
    """A number with all its digits; the text of a float begins with f, of an expression with =."""
    if isinstance(value, sp.Expr) and value.free_symbols:
        return f"= {term_text(value)}"
    return f"f{value.hex()}" if isinstance(value, float) else str(value)


def numbers_text(table: Mapping[str, Real]) -> dict[str, str]:
    """Texts of numbers by name."""
    return {name: number_text(x) for name, x in table.items()}


def plain_columns(columns: Mapping[str, np.ndarray]) -> dict[str, list[float | None]]:
    """Columns by name as lists of doubles; None where a number is not finite."""
    return {name: [json_number(x) for x in column] for name, column in columns.items()}


def pandas_table(columns: Mapping[str, Any]) -> Any:
    """Columns of equal length, by name, as a pandas DataFrame.

    Raises
    ------
    MissingExtraError
        pandas is not installed.
    """
    return _optional("pandas", "to_pandas").DataFrame(columns)


def xarray_dataset(columns: Mapping[str, Any], remarks: Mapping[str, Any]) -> Any:
    """Columns by name as an xarray Dataset; the first is the coordinate along which all run.

    Raises
    ------
    MissingExtraError
        xarray is not installed.
    """
    (along, times), *others = columns.items()
    variables = {name: (along, values) for name, values in others}
    xarray = _optional("xarray", "to_xarray")
    return xarray.Dataset(variables, coords={along: times}, attrs=dict(remarks))


def _optional(module: str, caller: str) -> Any:
    """A library that is not a dependency."""
    try:
        return import_module(module)
    except ImportError:
        raise MissingExtraError(
            f"{caller} needs {module}, which is not installed. Run `pip install {module}`."
        ) from None

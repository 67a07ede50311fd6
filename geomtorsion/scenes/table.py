"""Table: what was watched, a column for each number, as CSV."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np


def columns(
    times: Any, watched: Mapping[str, Any], labels: Mapping[str, Sequence[str]] | None = None
) -> dict[str, np.ndarray]:
    """Columns of a table: t, then each number that is watched.

    Parameters
    ----------
    times
        shape (m,), seconds.
    watched
        name -> values, shape (m,), (m, k) or (m, 3, 3).
    labels
        name -> what its components are called; numbers from 1, if not given.

    Examples
    --------
    >>> watched = {"energy": [1.0, 1.0], "omega": [[1, 2, 3], [1, 2, 3]]}
    >>> list(columns([0.0, 1.0], watched, {"omega": "xyz"}))
    ['t', 'energy', 'omega_x', 'omega_y', 'omega_z']
    """
    import numpy as np

    found = {"t": np.asarray(times, dtype=float)}
    for name, values in watched.items():
        flat = np.asarray(values, dtype=float).reshape(len(found["t"]), -1)
        if flat.shape[1] == 1:
            found[name] = flat[:, 0]
            continue
        parts = (labels or {}).get(name) or [str(k + 1) for k in range(flat.shape[1])]
        found |= {f"{name}_{part}": x for part, x in zip(parts, flat.T, strict=True)}
    return found


def write_csv(path: Path, table: Mapping[str, Any]) -> None:
    """Every number with all its digits."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table)
        rows = zip(*table.values(), strict=True)
        writer.writerows([_cell(value) for value in row] for row in rows)


def _cell(value: Any) -> str:
    """A number that reads back as the same double; texts as they are."""
    return value if isinstance(value, str) else repr(float(value))

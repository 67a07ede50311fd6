"""Table: columns of numbers as CSV, every digit kept."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path


def write_csv(path: Path, table: Mapping[str, Iterable[float | str]]) -> None:
    r"""Write columns of equal length under their names; numbers read back as the same doubles.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "table.csv")
    ...     write_csv(path, {"t": [0.0, 0.1], "engine": ["a", "b"]})
    ...     path.read_text()
    't,engine\n0.0,a\n0.1,b\n'
    """
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table)
        rows = zip(*table.values(), strict=True)
        writer.writerows([_cell(value) for value in row] for row in rows)


def _cell(value: float | str) -> str:
    """A number that reads back as the same double; texts as they are."""
    return value if isinstance(value, str) else repr(float(value))

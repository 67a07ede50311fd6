"""A table as a CSV file."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path

from geomtorsion.support.files import written
from geomtorsion.support.outgoing import csv_cell


def _cell(value: float | str) -> str:
    """A number that reads back as the same double; of texts no formula."""
    return csv_cell(value) if isinstance(value, str) else repr(float(value))


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
    with written(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(map(csv_cell, table))
        rows = zip(*table.values(), strict=True)
        writer.writerows([_cell(value) for value in row] for row in rows)

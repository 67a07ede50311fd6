"""mark table: the table of marks as a file, CSV or JSON."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from geomtorsion.errors import GeomtorsionError
from geomtorsion.support.files import read_json_text, read_text, written

HEAD = (
    "file", "student", "seed", "earned", "at_most", "points", "percent", "percent_at_most",
    "answered", "unread", "counted", "status",
)  # fmt: skip
TAIL = ("diagnoses", "remarks", "fingerprint")


def rows_of(table: Path, numbers: Sequence[str]) -> dict[str, Mapping[str, str]]:
    """Fingerprint -> row of a table that an earlier run wrote; nothing if it is another table."""
    if not table.exists():
        return {}
    head = [*HEAD, *numbers, *TAIL]
    try:
        if table.suffix == ".json":
            data = read_json_text(read_text(table), table.name)
            entries = data["rows"] if isinstance(data, dict) else []
            rows = [{str(key): _as_text(key, x) for key, x in row.items()} for row in entries]
        else:
            with table.open(encoding="utf-8-sig", newline="") as file:
                rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError, csv.Error, GeomtorsionError, KeyError, TypeError,
            AttributeError):  # fmt: skip
        return {}
    return {row["fingerprint"]: row for row in rows if list(row) == head and row["fingerprint"]}


def _as_values(row: Mapping[str, str], numbers: Sequence[str]) -> dict[str, object]:
    """A row with its numbers as numbers."""
    floats = ("earned", "at_most", "percent", "percent_at_most", *numbers)
    kinds = dict.fromkeys(floats, float) | dict.fromkeys(("seed", "points", "unread"), int)
    return {key: kinds.get(key, str)(text) for key, text in row.items()}


def _as_text(key: str, value: object) -> str:
    """A value of a row in the form of the table."""
    if isinstance(value, float):
        return f"{value:.1f}" if key.startswith("percent") else f"{value:g}"
    return str(value)


def write(
    table: Path, rows: Sequence[Mapping[str, str]], numbers: Sequence[str], chosen: str
) -> None:
    """Write the table to a temporary file and rename it: it is never half a table."""
    with (
        written(table.parent, is_folder=True),
        written(table) as aside,
        aside.open("w", encoding="utf-8", newline="") as file,
    ):
        if table.suffix == ".json":
            whole = {
                "counted": list(numbers),
                "chosen": chosen,
                "rows": [_as_values(row, numbers) for row in rows],
            }
            json.dump(whole, file, indent=1, ensure_ascii=False)
        else:
            writer = csv.DictWriter(file, [*HEAD, *numbers, *TAIL], lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)

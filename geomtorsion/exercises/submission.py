"""Submission: the answers of one student, read from a TOML file as data and nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from geomtorsion.errors import FileFormatError
from geomtorsion.exercises.limits import MOST
from geomtorsion.exercises.registry import names
from geomtorsion.files import read_toml


@dataclass(frozen=True)
class Submission:
    """The answers of one student.

    student: name as written, or that of the file. seed: which variant was worked on; None if the
    file does not say.
    answers: number of an exercise -> question -> answer, or one answer.
    unknown: keys that are no exercise.
    """

    student: str
    seed: int | None
    answers: Mapping[str, object]
    unknown: tuple[str, ...] = ()


def read_submission(path: str | PathLike[str]) -> Submission:
    """Read a file of answers.

    Keys
    ----
    student
        A name; that of the file if it is left out.
    seed
        The variant that was worked on.
    answers
        Table: number of an exercise -> answer, or table question -> answer.

    Raises
    ------
    FileFormatError
        It is no regular file, no TOML, or has values of the wrong kind.
    LimitError
        It is longer than MOST.file bytes, or nested too deeply.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "ada.toml")
    ...     _ = file.write_text('seed = 7\\n[answers]\\n"3.2" = "1/tan(phi2)"\\n')
    ...     read_submission(file)
    Submission(student='ada', seed=7, answers={'3.2': '1/tan(phi2)'}, unknown=())
    """
    path = Path(path)
    data = loaded(path)
    # Some write name; it costs nobody marks.
    student = data.get("student", data.get("name", path.stem))
    if not isinstance(student, str) or len(student) > MOST.name:
        raise FileFormatError(
            f"{path.name}: student: a name of at most {MOST.name} letters was needed. Write "
            'student = "Ada Lovelace".'
        )
    seed = data.get("seed")
    if seed is not None and (
        isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed <= MOST.seed
    ):
        raise FileFormatError(
            f"{path.name}: seed: a whole number from 0 to {MOST.seed:,} was needed, but "
            f"{str(seed)[:40]!r} came. Write seed = 7."
        )
    table = data.get("answers", {})
    if not isinstance(table, dict):
        raise FileFormatError(
            f"{path.name}: answers: a table was needed, but {str(table)[:40]!r} came. Write "
            '[answers], and below it "1.1" = "...".'
        )
    flat = _flat(table)
    known = set(names())
    unknown = tuple(key[:60] for key in flat if key not in known)
    answers = {key: value for key, value in flat.items() if key in known}
    # The form has an empty name, which some leave so.
    return Submission(" ".join(student.split()) or path.stem, seed, answers, unknown)


def loaded(path: Path) -> Mapping[str, Any]:
    """The content of a TOML file of answers."""
    advice = 'Answers stand in quotes, as in "1.1" = "sin(x)".'
    return read_toml(path, advice=advice, largest=MOST.file).data


def _flat(table: Mapping[str, object]) -> dict[str, object]:
    """Answers by number; 1.1 written without quotes is a table in a table."""
    found: dict[str, object] = {}
    for key, value in table.items():
        inner = value if isinstance(value, dict) and key.isdecimal() else {}
        if inner and all(part.isdecimal() for part in inner):
            found |= {f"{key}.{part}": answer for part, answer in inner.items()}
        else:
            found[key] = value
    return found

"""Submission: the answers of one student, read from a TOML file as data and nothing else."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from stat import S_ISREG
from typing import Any

from geomtorsion.errors import FileFormatError, GeomtorsionError, LimitError
from geomtorsion.exercises.registry import LARGEST_SEED, names

LARGEST_FILE = 200_000
LONGEST_NAME = 200


@dataclass(frozen=True)
class Submission:
    """The answers of one student.

    student: name as written, or that of the file. seed: which variant was worked on.
    answers: number of an exercise -> question -> answer, or one answer.
    unknown: keys that are no exercise.
    """

    student: str
    seed: int
    answers: Mapping[str, Any]
    unknown: tuple[str, ...] = ()


def read_submission(path: str | PathLike[str]) -> Submission:
    """Read a file of answers.

    Keys
    ----
    student
        A name; that of the file if it is left out.
    seed
        The variant that was worked on; 0 if it is left out.
    answers
        Table: number of an exercise -> answer, or table question -> answer.

    Raises
    ------
    FileFormatError
        It is no regular file, no TOML, or has values of the wrong kind.
    LimitError
        It is longer than LARGEST_FILE bytes, or nested too deeply.

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
    student = data.get("student", data.get("name", path.stem))
    if not isinstance(student, str) or len(student) > LONGEST_NAME:
        raise FileFormatError(
            f"{path.name}: student: a name of at most {LONGEST_NAME} letters was needed. Write "
            'student = "Ada Lovelace".'
        )
    seed = data.get("seed", 0)
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed <= LARGEST_SEED:
        raise FileFormatError(
            f"{path.name}: seed: a whole number from 0 to {LARGEST_SEED:,} was needed, but "
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
    return Submission(" ".join(student.split()), seed, answers, unknown)


def loaded(path: Path) -> dict[str, Any]:
    """The content of a TOML file of answers."""
    try:
        # A pipe or a device would never end.
        if not S_ISREG(path.stat().st_mode):
            raise FileFormatError(f"{path.name}: this is no regular file.")
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise LimitError(
                f"{path.name}: the file is longer than the limit of {LARGEST_FILE:,} bytes."
            )
        data = tomllib.loads(content.decode("utf-8-sig"))
        # Python writes no whole number of many thousand digits, which hexadecimal ones may have.
        _ = repr(data)
        return data
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise FileFormatError(f"{path.name}: the file cannot be read: {reason}.") from None
    except UnicodeDecodeError:
        raise FileFormatError(
            f"{path.name}: the file is no UTF-8 text. Save it as UTF-8."
        ) from None
    except RecursionError:
        raise LimitError(f"{path.name}: lists are nested too deeply to be read.") from None
    except tomllib.TOMLDecodeError as error:
        raise FileFormatError(
            f"{path.name}: this is no TOML: {str(error)[:200]}. Answers stand in quotes, as in "
            '"1.1" = "sin(x)".'
        ) from None
    except GeomtorsionError:
        raise
    except ValueError:
        raise LimitError(
            f"{path.name}: a number has more digits than can be read. Write a shorter one."
        ) from None


def _flat(table: Mapping[str, Any]) -> dict[str, Any]:
    """Answers by number; 1.1 written without quotes is a table in a table."""
    found: dict[str, Any] = {}
    for key, value in table.items():
        inner = isinstance(value, dict) and key.isdecimal()
        if inner and all(part.isdecimal() for part in value):
            found |= {f"{key}.{part}": answer for part, answer in value.items()}
        else:
            found[key] = value
    return found

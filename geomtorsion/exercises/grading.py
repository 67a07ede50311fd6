"""Grading: a folder of answers to a table of marks; what is finished is never lost."""

from __future__ import annotations

import csv
import hashlib
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from geomtorsion.errors import FileFormatError, GeomtorsionError
from geomtorsion.exercises.examiner import SECONDS, Examiner
from geomtorsion.exercises.limits import MOST
from geomtorsion.exercises.registry import load, names
from geomtorsion.exercises.submission import Submission, read_submission

GRADED, PARTLY, REFUSED = "graded", "partly", "not graded"
HEAD = ("file", "student", "seed", "earned", "points", "percent", "status")
TAIL = ("diagnoses", "remarks", "fingerprint")


@dataclass(frozen=True)
class Mark:
    """The marks of one student: a row of the table.

    file, student, seed: whose they are. earned, points: in total.
    status: GRADED, PARTLY (an answer was too large or took too long) or REFUSED.
    parts: number of an exercise -> points earned.
    diagnoses: number:question -> code. remarks: what to look at. fingerprint: of file and task.
    """

    file: str
    student: str
    seed: int
    earned: float
    points: int
    status: str
    parts: Mapping[str, float] = field(default_factory=dict)
    diagnoses: str = ""
    remarks: str = ""
    fingerprint: str = ""

    def row(self, numbers: Sequence[str]) -> dict[str, str]:
        """The mark as a row of text."""
        percent = 100 * self.earned / self.points if self.points else 0.0
        return {
            "file": _harmless(self.file),
            "student": _harmless(self.student),
            "seed": str(self.seed),
            "earned": f"{self.earned:g}",
            "points": str(self.points),
            "percent": f"{percent:.1f}",
            "status": self.status,
            **{number: f"{self.parts.get(number, 0.0):g}" for number in numbers},
            "diagnoses": _harmless(self.diagnoses),
            "remarks": _harmless(self.remarks),
            "fingerprint": self.fingerprint,
        }


def _harmless(text: str) -> str:
    """Text that no spreadsheet takes for a formula, and that can be written as UTF-8."""
    # Names of files may hold bytes of another encoding, which Python keeps as half characters.
    text = text.encode("utf-8", "replace").decode("utf-8")
    text = " ".join(text.split())[: MOST.remark]
    return f"'{text}" if text[:1] in ("=", "+", "-", "@") else text


@dataclass(frozen=True)
class Marks:
    """The table of marks.

    rows: one per file, as text. numbers: the exercises that count. kept: rows of an earlier run.
    """

    rows: tuple[Mapping[str, str], ...]
    numbers: tuple[str, ...]
    kept: int = 0

    @property
    def troubled(self) -> tuple[Mapping[str, str], ...]:
        """Rows that somebody should look at."""
        return tuple(row for row in self.rows if row["status"] != GRADED)


def grade(
    folder: str | os.PathLike[str],
    output: str | os.PathLike[str],
    numbers: Iterable[str] | None = None,
    *,
    seed: int | None = None,
    seconds: float = SECONDS,
    progress: Callable[[int, int, str], object] = lambda *_: None,
) -> Marks:
    """Grade every TOML file of a folder; write the table after each.

    Parameters
    ----------
    numbers
        the exercises that count; those that occur in any file if not given.
    seed
        what every student must have worked on; as each file says if not given.
    seconds
        how long the answers to one exercise may take.
    progress
        is called with (files done, files in all, file).

    Returns
    -------
    Marks. Rows of the output that belong to unchanged files and the same task are kept, so that
    grading that was interrupted goes on where it stopped.

    Raises
    ------
    FileFormatError
        The folder holds no TOML file, or the output cannot be written.
    """
    # Sorted: the same folder gives the same table on every system.
    files = sorted(path for path in Path(folder).iterdir() if path.suffix == ".toml")
    if not files:
        raise FileFormatError(
            f"{folder}: there is no TOML file here. Each student gives one, such as ada.toml."
        )
    read = {path: _read(path) for path in files}
    found = tuple(numbers) if numbers is not None else _occurring(read.values())
    for number in found:
        load(number)
    table = Path(output)
    before = _rows_of(table, found)
    rows: list[Mapping[str, str]] = []
    kept = 0
    with Examiner(seconds) as examiner:
        try:
            for place, path in enumerate(files):
                progress(place, len(files), path.name)
                fingerprint = _fingerprint(path, found, seed)
                old = before.get(fingerprint)
                kept += old is not None
                mark = old or _mark(path, read[path], found, seed, examiner, fingerprint).row(found)
                rows.append(mark)
                # Written after each student, so that an interruption costs at most one.
                if old is None:
                    _write(table, rows, found)
        finally:
            # What an earlier run knew and this one has not reached stays in the table.
            later = [_fingerprint(path, found, seed) for path in files[len(rows) :]]
            rest = [before[key] for key in later if key in before]
            _write(table, [*rows, *rest], found)
    progress(len(files), len(files), "")
    return Marks(tuple(rows), found, kept)


def _read(path: Path) -> Submission | str:
    """The answers in a file, or why it cannot be read."""
    try:
        return read_submission(path)
    except GeomtorsionError as error:
        return str(error)


def _occurring(read: Iterable[Submission | str]) -> tuple[str, ...]:
    """The exercises that occur in any file, in order."""
    found = {number for one in read if isinstance(one, Submission) for number in one.answers}
    return tuple(number for number in names() if number in found)


def _mark(
    path: Path,
    read: Submission | str,
    numbers: Sequence[str],
    seed: int | None,
    examiner: Examiner,
    fingerprint: str,
) -> Mark:
    """The marks of one file."""
    worth = sum(q.points for n in numbers for q in load(n).questions)
    if isinstance(read, str):
        return Mark(path.name, path.stem, 0, 0.0, worth, REFUSED, remarks=read,
                    fingerprint=fingerprint)  # fmt: skip
    if seed is not None and read.seed != seed:
        text = f"seed {read.seed} instead of {seed}"
        return Mark(path.name, read.student, read.seed, 0.0, worth, REFUSED, remarks=text,
                    fingerprint=fingerprint)  # fmt: skip
    parts: dict[str, float] = {}
    codes: list[str] = []
    remarks = [f"no exercise {key!r}" for key in read.unknown]
    status = GRADED
    for number in numbers:
        if number not in read.answers:
            continue
        verdict = examiner.check(number, _table(number, read), read.seed)
        parts[number] = round(verdict.earned, 3)
        said = [(q.name, q.diagnosis) for q in verdict.questions if q.diagnosis]
        codes += [f"{number}:{name} {code}" for name, code in said if code != "empty"]
        remarks += [f"{number}: {note}" for note in verdict.notes]
        if any(code == "too large" for _, code in said):
            status = PARTLY
    earned = round(sum(parts.values()), 3)
    return Mark(path.name, read.student, read.seed, earned, worth, status, parts,
                "; ".join(codes), " ".join(remarks), fingerprint)  # fmt: skip


def _table(number: str, read: Submission) -> Mapping[str, object]:
    """The answers to one exercise as a table question -> answer."""
    given = read.answers[number]
    questions = load(number, read.seed).questions
    known = [question.name for question in questions]
    if isinstance(given, dict) and (set(known) & set(given) or len(known) > 1):
        return given
    return {known[0]: given}


def _fingerprint(path: Path, numbers: Sequence[str], seed: int | None) -> str:
    """Changes when the file or the task does."""
    try:
        content = path.read_bytes() if path.stat().st_size < 10**7 and path.is_file() else b""
    except OSError:
        content = b""
    task = f"{path.name}|{','.join(numbers)}|{seed}|".encode("utf-8", "surrogateescape")
    return hashlib.sha256(task + content).hexdigest()[:16]


def _rows_of(table: Path, numbers: Sequence[str]) -> dict[str, Mapping[str, str]]:
    """Fingerprint -> row of a table that an earlier run wrote; nothing if it is another table."""
    if not table.exists():
        return {}
    head = [*HEAD, *numbers, *TAIL]
    try:
        with table.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.DictReader(file)
            if reader.fieldnames != head:
                return {}
            return {row["fingerprint"]: row for row in reader if row["fingerprint"]}
    except (OSError, UnicodeDecodeError, csv.Error):
        return {}


def _write(table: Path, rows: Sequence[Mapping[str, str]], numbers: Sequence[str]) -> None:
    """Write the table aside and put it in place at once: it is never half a table."""
    table.parent.mkdir(parents=True, exist_ok=True)
    aside = table.with_name(f".{table.name}.part")
    with aside.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, [*HEAD, *numbers, *TAIL], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    os.replace(aside, table)

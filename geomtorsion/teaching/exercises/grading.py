"""Grading: a folder of answers to a table of marks; finished rows are never lost."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import Any

from geomtorsion.errors import ArgumentError, FileFormatError, GeomtorsionError
from geomtorsion.support import checks
from geomtorsion.support.files import read_toml
from geomtorsion.support.outgoing import csv_cell
from geomtorsion.teaching.exercises.chapter_folder import Chapter, load_folder
from geomtorsion.teaching.exercises.examiner import SECONDS, Examiner
from geomtorsion.teaching.exercises.examiner import reply as checked
from geomtorsion.teaching.exercises.limits import MOST
from geomtorsion.teaching.exercises.mark_table import rows_of, write
from geomtorsion.teaching.exercises.registry import Own, load, names
from geomtorsion.teaching.exercises.verdict import Verdict
from geomtorsion.teaching.exercises.worker_pool import Json

# Keys of a file.
KEYS = ("student", "name", "seed", "answers")


@dataclass(frozen=True)
class Submission:
    """The answers of one student.

    student: name as written, or the name of the file. seed: the variant; None if the
    file does not name one.
    answers: number of an exercise -> question -> answer, or one answer.
    unknown: keys that do not name an exercise. outside: other keys of the file, which are ignored.
    """

    student: str
    seed: int | None
    answers: Mapping[str, object]
    unknown: tuple[str, ...] = ()
    outside: tuple[str, ...] = ()


def read_submission(path: str | PathLike[str], chapter: Own = None) -> Submission:
    """Read a file of answers. chapter: the folder of a teacher's chapter.

    Keys
    ----
    student
        A name; the default is the name of the file.
    seed
        The variant of the answers.
    answers
        Table: number of an exercise -> answer, or table question -> answer.

    Raises
    ------
    FileFormatError
        It is not a regular file, is not TOML, or has values of the wrong type.
    LimitError
        It is longer than MOST.file bytes, or nested too deeply.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "ada.toml")
    ...     _ = file.write_text('seed = 7\\n[answers]\\n"3.2" = "1/tan(phi2)"\\n')
    ...     read_submission(file)
    Submission(student='ada', seed=7, answers={'3.2': '1/tan(phi2)'}, unknown=(), outside=())
    """
    path = checks.file_name(path)
    data = loaded(path)
    # Some students write "name"; it costs no marks.
    student = data.get("student", data.get("name", path.stem))
    if not isinstance(student, str) or len(student) > MOST.name:
        raise FileFormatError(
            f"{path.name}: student: expected a name of at most {MOST.name} letters, got "
            f'{checks.shown(student)}. Write student = "Ada Lovelace".'
        )
    seed = data.get("seed")
    if seed is not None:
        subject, remedy = f"{path.name}: seed", "Write seed = 7."
        checks.count(seed, subject, FileFormatError, 0, MOST.seed, remedy=remedy)
    table = data.get("answers", {})
    if not isinstance(table, dict):
        raise FileFormatError(
            f"{path.name}: answers: expected a table, got {checks.shown(table)}. Write [answers], "
            'and below it "1.1" = "...".'
        )
    flat = _flat(table)
    listed = set(names(chapter))
    unknown = tuple(key[:60] for key in flat if key not in listed)
    answers = {key: value for key, value in flat.items() if key in listed}
    outside = tuple(key[:60] for key in _flat(data) if key not in KEYS)
    # The form has an empty name, which some students do not fill in.
    return Submission(" ".join(student.split()) or path.stem, seed, answers, unknown, outside)


def loaded(path: Path) -> Mapping[str, Any]:
    """The content of a TOML file of answers."""
    advice = 'Write answers in quotes, as in "1.1" = "sin(x)".'
    return read_toml(path, advice=advice, largest=MOST.file).data


def _flat(table: Mapping[str, object]) -> dict[str, object]:
    """Answers by number; 1.1 written without quotes is a table in a table."""
    by_number: dict[str, object] = {}
    for key, value in table.items():
        inner = value if isinstance(value, dict) and key.isdecimal() else {}
        if inner and all(part.isdecimal() for part in inner):
            by_number |= {f"{key}.{part}": answer for part, answer in inner.items()}
        else:
            by_number[key] = value
    return by_number


GRADED, PARTLY, TWICE, REFUSED = "graded", "partly", "given twice", "not graded"
# Exercises that count by default: those that occur in any file.
ASKED_FOR, OCCURRING = "as requested", "all that any student answered"


@dataclass(frozen=True, kw_only=True)
class Mark:
    """The marks of one student: a row of the table.

    file, student, seed: the owner. earned: total. at_most: total if every answer is right that a
    person must still read. points: of all questions that count.
    answered: number of answered questions, and of all. unread: number of answers that could not be
    read. counted: the exercises with points.
    status: GRADED, PARTLY (an answer was not checked: unreadable, or to an unknown question),
    TWICE (another file has the same student) or REFUSED.
    parts: number of an exercise -> points earned.
    diagnoses: number:question -> code. remarks: what to check. fingerprint: of file and task.
    """

    file: str
    student: str
    seed: int
    earned: float
    at_most: float
    points: int
    status: str
    answered: str = ""
    unread: int = 0
    counted: str = ""
    parts: Mapping[str, float] = field(default_factory=dict)
    diagnoses: str = ""
    remarks: str = ""
    fingerprint: str = ""

    def row(self, numbers: Sequence[str]) -> dict[str, str]:
        """The mark as a row of text."""
        share = 100 / self.points if self.points else 0.0
        return {
            "file": _harmless(self.file),
            "student": _harmless(self.student),
            "seed": str(self.seed),
            "earned": f"{self.earned:g}",
            "at_most": f"{self.at_most:g}",
            "points": str(self.points),
            "percent": f"{self.earned * share:.1f}",
            "percent_at_most": f"{self.at_most * share:.1f}",
            "answered": self.answered,
            "unread": str(self.unread),
            "counted": self.counted,
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
    return csv_cell(text)


@dataclass(frozen=True)
class Marks:
    """The table of marks.

    rows: one per file, as text. numbers: the exercises that count. kept: rows of an earlier run.
    chosen: why these exercises count, ASKED_FOR or OCCURRING.
    """

    rows: tuple[Mapping[str, str], ...]
    numbers: tuple[str, ...]
    kept: int = 0
    chosen: str = ASKED_FOR

    @property
    def troubled(self) -> tuple[Mapping[str, str], ...]:
        """Rows that a person should check."""
        return tuple(row for row in self.rows if row["status"] != GRADED)

    @property
    def graded(self) -> tuple[Mapping[str, str], ...]:
        """Rows with marks, also those that a person should check."""
        return tuple(row for row in self.rows if row["status"] != REFUSED)


def range_text(row: Mapping[str, str]) -> str:
    """The range of percentages of a row with unread answers, in words.

    Examples
    --------
    >>> range_text({"percent": "11.1", "percent_at_most": "100.0", "unread": "5"})
    '11 % to 100 %, 5 answers to be read by you'
    """
    least, most = (f"{float(row[key]):.0f} %" for key in ("percent", "percent_at_most"))
    answers = "1 answer" if row["unread"] == "1" else f"{row['unread']} answers"
    return f"{least} to {most}, {answers} to be read by you"


def grade(
    folder: str | os.PathLike[str],
    output: str | os.PathLike[str],
    numbers: Iterable[str] | None = None,
    *,
    seed: int | None = None,
    seconds: float = SECONDS,
    progress: Callable[[int, int, str], object] = lambda *_: None,
    chapter: Own = None,
) -> Marks:
    """Grade every TOML file of a folder; write the table after each.

    Parameters
    ----------
    output
        the table: CSV, or JSON if its name ends in .json.
    numbers
        the exercises that count; those that occur in any file if not given.
    seed
        the required seed of every student; by default the seed of each file. A file without a
        seed is graded with this seed, or with 0, and its row reports it.
    seconds
        time limit for the answers to one exercise.
    progress
        is called with (files done, files in all, file).
    chapter
        the folder of a teacher's chapter, whose exercises are graded as well; see `load_folder`.

    Returns
    -------
    Marks. Rows of the output that belong to unchanged files and the same task (with as many
    seconds) are reused, so that interrupted grading resumes where it stopped.

    Raises
    ------
    FileFormatError
        The folder holds no TOML file, or the output cannot be written.
    ArgumentError
        numbers is empty.
    """
    # Sorted: the same folder gives the same table on every system.
    files = sorted(path for path in Path(folder).iterdir() if path.suffix == ".toml")
    if not files:
        raise FileFormatError(
            f"{folder}: expected TOML files of answers, got none. Put one file of each student "
            "there, such as ada.toml."
        )
    # An exercise that is named twice counts once.
    listed = None if numbers is None else tuple(dict.fromkeys(numbers))
    if listed == ():
        raise ArgumentError(
            "numbers: expected at least one exercise that counts, got none. Name one, or omit "
            "numbers: then all exercises with an answer from any student count."
        )
    # Opened once: the same content for every student.
    own = None if chapter is None else load_folder(chapter)
    for number in listed or ():
        load(number, chapter=own)
    with Examiner(seconds, f"{__name__}:reply") as examiner:
        return _graded(files, Path(output), listed, seed, examiner, progress, own)


def _graded(
    files: Sequence[Path],
    table: Path,
    numbers: tuple[str, ...] | None,
    seed: int | None,
    examiner: Examiner,
    progress: Callable[[int, int, str], object],
    chapter: Chapter | None,
) -> Marks:
    """The marks of files that an examiner reads and checks; see `grade`."""
    read = {path: _read(path, examiner, chapter) for path in files}
    exercises = _occurring(read.values(), chapter) if numbers is None else numbers
    chosen = ASKED_FOR if numbers is not None else OCCURRING
    counted = f"{' '.join(exercises) or 'none'} ({chosen})"
    task = _Task(exercises, seed, counted, _namesakes(read), examiner.seconds, chapter)
    before = rows_of(table, exercises)
    rows: list[Mapping[str, str]] = []
    kept = 0
    try:
        for place, path in enumerate(files):
            progress(place, len(files), path.name)
            fingerprint = task.fingerprint(path)
            old = before.get(fingerprint)
            kept += old is not None
            mark = old or _mark(path, read[path], task, examiner, fingerprint).row(exercises)
            rows.append(mark)
            # Written after each student, so that an interruption costs at most one.
            if old is None:
                write(table, rows, exercises, chosen)
    finally:
        # Rows of an earlier run that this run has not reached stay in the table.
        later = [task.fingerprint(path) for path in files[len(rows) :]]
        rest = [before[key] for key in later if key in before]
        write(table, [*rows, *rest], exercises, chosen)
    progress(len(files), len(files), "")
    return Marks(tuple(rows), exercises, kept, chosen)


@dataclass(frozen=True)
class _Task:
    """The task: the exercises, the requested seed, their texts in the table, and duplicates.

    namesakes: file -> other files of the same student. seconds: for the answers to one exercise.
    chapter: of the teacher, besides the shipped ones.
    """

    numbers: tuple[str, ...]
    seed: int | None
    counted: str
    namesakes: Mapping[Path, tuple[str, ...]]
    seconds: float
    chapter: Chapter | None

    def fingerprint(self, path: Path) -> str:
        """Hash of the file, the task and its time limit."""
        try:
            fits = path.stat().st_size < 10**7 and path.is_file()
            content = path.read_bytes() if fits else b""
        except OSError:
            content = b""
        others = ",".join(self.namesakes.get(path, ()))
        task = f"{path.name}|{self.counted}|{self.seed}|{others}|{self.seconds}|"
        # Marks of an earlier text of the chapter are not reused.
        task += self.chapter.digest if self.chapter else ""
        return hashlib.sha256(task.encode("utf-8", "surrogateescape") + content).hexdigest()[:16]


def _namesakes(read: Mapping[Path, Submission | str]) -> dict[Path, tuple[str, ...]]:
    """File -> the other files that name the same student."""
    files: dict[str, list[Path]] = {}
    for path, entry in read.items():
        if isinstance(entry, Submission):
            files.setdefault(entry.student.casefold(), []).append(path)
    return {
        path: tuple(other.name for other in paths if other != path)
        for paths in files.values()
        for path in paths
        if len(paths) > 1
    }


def _read(path: Path, examiner: Examiner, chapter: Chapter | None) -> Submission | str:
    """The answers in a file, or the reason why it cannot be read, from the examiner's process.

    A file that takes too much time or memory costs only its own student marks.
    """
    own = {"chapter": chapter.folder} if chapter else {}
    data = examiner.ask({"path": str(path)} | own, SECONDS)
    if isinstance(data, str):
        return f"{path.name} could not be read: {data}. Write the file again."
    if "refused" in data:
        return str(data["refused"])
    return Submission(
        data["student"], data["seed"], data["answers"], tuple(data["unknown"]),
        tuple(data["outside"]),
    )  # fmt: skip


def reply(request: Json) -> Json:
    """Reply of the examiner's process: the content of a file, or the result of a check."""
    if "path" not in request:
        return checked(request)
    return submission_data(request["path"], request.get("chapter"))


def submission_data(path: str, chapter: Own = None) -> Json:
    """The answers in a file as JSON, or the reason for refusing it under "refused"."""
    try:
        submission = read_submission(path, chapter)
    except GeomtorsionError as error:
        return {"refused": str(error)}
    # A date that was written without quotes is not an answer, but can be shown.
    answers = json.loads(json.dumps(submission.answers, default=str))
    return {**vars(submission), "answers": answers}


def _occurring(read: Iterable[Submission | str], chapter: Own) -> tuple[str, ...]:
    """The exercises that occur in any file, in order."""
    keys = {number for one in read if isinstance(one, Submission) for number in one.answers}
    return tuple(number for number in names(chapter) if number in keys)


def _mark(
    path: Path, read: Submission | str, task: _Task, examiner: Examiner, fingerprint: str
) -> Mark:
    """The marks of one file."""
    worth = sum(q.points for n in task.numbers for q in load(n, chapter=task.chapter).questions)
    refused = Mark(
        file=path.name, student=path.stem, seed=0, earned=0.0, at_most=worth, points=worth,
        status=REFUSED, counted=task.counted, fingerprint=fingerprint,
    )  # fmt: skip
    if isinstance(read, str):
        return replace(refused, remarks=read)
    if None not in (task.seed, read.seed) and read.seed != task.seed:
        refused = replace(refused, remarks=f"seed {read.seed} instead of {task.seed}")
        return replace(refused, student=read.student, seed=read.seed or 0)
    seed = read.seed if read.seed is not None else task.seed or 0
    tally = _Tally.of_keys(read, task.chapter)
    asked = 0
    for number in task.numbers:
        asked += len(load(number, seed, chapter=task.chapter).questions)
        if number in read.answers:
            answers = read.answers[number]
            tally.add(number, examiner.check(number, answers, seed, chapter=task.chapter))
    remarks = tally.remarks
    if read.seed is None:
        remarks.append(f"the file names no seed: graded as seed {seed}.")
    if others := task.namesakes.get(path, ()):
        remarks.insert(0, f"the same student as in {', '.join(others)}: decide which one counts.")
    status = TWICE if others else PARTLY if tally.is_open else GRADED
    return replace(
        refused, student=read.student, seed=seed, earned=round(sum(tally.parts.values()), 3),
        at_most=round(tally.most, 3), status=status, answered=f"{tally.answered} of {asked}",
        unread=tally.unread, parts=tally.parts, diagnoses="; ".join(tally.codes),
        remarks=" ".join(remarks),
    )  # fmt: skip


@dataclass(eq=False)
class _Tally:
    """What the answers of one file add up to.

    parts: marks by exercise; most: with those on which a person decides. codes: diagnoses.
    answered, unread: numbers of questions. is_open: whether a person has to look at the file.
    """

    remarks: list[str]
    is_open: bool
    parts: dict[str, float] = field(default_factory=dict)
    codes: list[str] = field(default_factory=list)
    most: float = 0.0
    answered: int = 0
    unread: int = 0

    @classmethod
    def of_keys(cls, read: Submission, chapter: Own) -> _Tally:
        """The tally before any answer, with remarks on the keys of the file."""
        remarks = [f"no exercise {key!r}: it is not counted." for key in read.unknown]
        remarks += [f"{key!r} is outside of [answers]: it is not read." for key in read.outside]
        # A key that concerns the file only, such as a date, needs nobody's attention.
        is_open = bool(read.unknown) or any(key in names(chapter) for key in read.outside)
        return cls(remarks, is_open)

    def add(self, number: str, verdict: Verdict) -> None:
        """Count the answers to one exercise."""
        self.parts[number] = round(verdict.earned, 3)
        codes = [(q.name, q.diagnosis) for q in verdict.questions]
        self.answered += sum(code != "empty" for _, code in codes)
        self.codes += [f"{number}:{name} {x}" for name, x in codes if x not in ("", "empty")]
        self.remarks += [f"{number}: {note}" for note in verdict.notes]
        # A person decides on these: until then the marks are a range.
        self.most += verdict.at_most
        self.unread += len(verdict.unread)
        self.remarks += [f"{number}: {name} could not be read." for name in verdict.unread]
        self.is_open |= bool(verdict.notes or verdict.unread)

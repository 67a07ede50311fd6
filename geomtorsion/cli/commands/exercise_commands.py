"""exercise_commands: show, hint, solution, check, sheet, export and grade.

Separate from the list of exercises, which needs none of these imports.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from shlex import quote
from typing import Annotated, Any

import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import (
    ChapterFolder,
    Language,
    Number,
    Seed,
    argument,
    directory,
    option,
    say_written,
)
from geomtorsion.cli.terminal import shows_greek, working, wrapped
from geomtorsion.cli.values import parts
from geomtorsion.errors import FileFormatError
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.progress import bar
from geomtorsion.teaching.exercises import Exercise, exports, grading, load
from geomtorsion.teaching.exercises.examiner import Examiner
from geomtorsion.teaching.exercises.grading import loaded, read_submission
from geomtorsion.teaching.exercises.limits import MOST
from geomtorsion.teaching.exercises.prose import text_of
from geomtorsion.teaching.exercises.question import how_to_answer
from geomtorsion.teaching.exercises.registry import chapters
from geomtorsion.teaching.exercises.sheets import write_sheet
from geomtorsion.teaching.exercises.verdict import STATES, TITLES, Verdict
from geomtorsion.teaching.texts import ENGLISH, language_name, texts


def show(
    number: Number,
    seed: Seed = 0,
    language: Language = ENGLISH,
    chapter: ChapterFolder = None,
) -> None:
    """Show the text and the questions of an exercise.

    \b
    Examples:
      geomtorsion exercises show 3.2
      geomtorsion exercises show 3.2 --seed 7
      geomtorsion exercises show 1.1 --language de
      geomtorsion exercises show 8.1 --chapter my_chapter
    """
    exercise = load(number, seed, language, chapter)
    typer.echo(typer.style(f"{exercise.number}  {exercise.title}", bold=True))
    text = texts("sheets", "command", exercise.language)
    facts = {"chapter": exercise.chapter, "level": exercise.level_name, "seed": exercise.seed}
    typer.echo(text("facts", **facts) + "\n")
    _say_note(exercise)
    typer.echo(wrapped(text_of(exercise.statement)))
    words = texts("sheets", "sheet", exercise.language)
    for question in exercise.questions:
        typer.echo()
        name = typer.style(question.name, bold=True)
        points = f" {text('points', points=question.points)}" if question.points > 1 else ""
        typer.echo(f"{name}{points}: " + wrapped(text_of(question.prompt), len(question.name) + 2))
        how = words("answer", how=how_to_answer(question, options=False))
        typer.echo(wrapped(f"  {text_of(how)}"))
        for key, meaning in question.options.items():
            typer.echo(f"    {key}: {meaning}")
    again = _again(exercise)
    hints = len(exercise.hints)
    command = f"`geomtorsion exercises hint {number}{again}`"
    typer.echo("\n" + text("hints", count=hints, command=command))


def _say_note(exercise: Exercise) -> None:
    """The note that the text is English, if it is not translated."""
    if exercise.note:
        typer.echo(f"{wrapped(exercise.note)}\n")


def _again(exercise: Exercise) -> str:
    """Options that choose this exercise in another command."""
    seed = f" --seed {exercise.seed}" if exercise.seed else ""
    language = f" --language {quote(exercise.language)}" if exercise.language != ENGLISH else ""
    chapter = f" --chapter {quote(exercise.folder)}" if exercise.folder else ""
    return seed + language + chapter


def hint(
    number: Number,
    seed: Seed = 0,
    step: Annotated[int, typer.Option(metavar="K", min=1, help="Show hints up to this one.")] = 1,
    language: Language = ENGLISH,
    chapter: ChapterFolder = None,
) -> None:
    """Give hints, one step at a time.

    \b
    Examples:
      geomtorsion exercises hint 3.2
      geomtorsion exercises hint 3.2 --step 2
    """
    exercise = load(number, seed, language, chapter)
    _say_note(exercise)
    for place, text in enumerate(exercise.hints[:step], 1):
        typer.echo(wrapped(f"{place}. {text_of(text)}"))
    # Hints are shown one by one: the next one is requested by its number.
    if step < len(exercise.hints):
        again = _again(exercise)
        command = f"`geomtorsion exercises hint {number}{again} --step {step + 1}`"
        typer.echo(texts("sheets", "command", exercise.language)("next", command=command))


def solution(
    number: Number,
    seed: Seed = 0,
    language: Language = ENGLISH,
    chapter: ChapterFolder = None,
) -> None:
    """Solve an exercise step by step, for the teacher.

    \b
    Examples:
      geomtorsion exercises solution 3.2
      geomtorsion exercises solution 3.2 --seed 7
    """
    exercise = load(number, seed, language, chapter)
    text = texts("sheets", "command", exercise.language)
    heading = text("solved", number=exercise.number, title=exercise.title, seed=seed)
    typer.echo(typer.style(heading, bold=True))
    if exercise.note:
        typer.echo(wrapped(exercise.note))
    for place, step in enumerate(exercise.worked, 1):
        typer.echo(f"\n{place}. " + wrapped(text_of(step.text), 3))
    typer.echo("\n" + text("answers"))
    for name, answer in exercise.answers().items():
        typer.echo(wrapped(f"  {name}: {answer}", len(name) + 4))


# Keys at the top of a file that do not name an answer.
ABOUT = ("student", "name", "seed")
Answers = dict[str, str]


def check(
    number: Number,
    answers: Annotated[
        list[str] | None,
        argument("[QUESTION=]ANSWER", "An answer; name=answer for each of several questions."),
    ] = None,
    file: Annotated[
        Path | None, option("--file", metavar="FILE", text="Answers in a TOML file.")
    ] = None,
    seed: Annotated[
        int | None,
        option(metavar="N", text="Number of the variant; default: the seed in the file, or 0."),
    ] = None,
    seconds: Annotated[
        float, typer.Option(metavar="S", min=0.1, help="Longest time for the check.")
    ] = 20.0,
    language: Language = ENGLISH,
    chapter: ChapterFolder = None,
) -> None:
    """Check answers, and name the likely mistake; ends with 1 if one is wrong.

    \b
    Examples:
      geomtorsion exercises check 3.2 "cos(phi2)/sin(phi2)"
      geomtorsion exercises check 3.3 "ricci=[[1/R^2, 0], [0, sin(r/R)^2]]" "scalar=2/R^2"
      geomtorsion exercises check 3.2 --file answers.toml
      geomtorsion exercises check 8.1 "2*pi/3" --chapter my_chapter
    """
    if (file is None) == (not answers):
        raise FileFormatError(
            f"expected an answer or --file, got {'both' if answers else 'neither'}. Write the "
            f'answer in quotes after the number: geomtorsion exercises check {number} "..."'
        )
    if file is not None:
        submission: object
        submission, own = _from_file(number, file, chapter)
        seed = own if seed is None else seed
    else:
        questions = load(number, seed or 0, chapter=chapter).questions
        submission = _from_words([q.name for q in questions], answers or [])
    with Examiner(seconds) as examiner:
        verdict = examiner.check(number, submission, seed or 0, language, chapter)
    _say(verdict, TITLES.of(language_name(language)))
    if not verdict.right:
        raise typer.Exit(ExitCode.failed)


def _from_file(number: str, file: Path, chapter: Path | None) -> tuple[object, int]:
    """The answers to one exercise in a file, and its seed; 0 if it has none."""
    data = loaded(file)
    read = read_submission(file, chapter)
    if number in read.answers:
        answers = read.answers[number]
    elif "answers" not in data:
        answers = {key: x for key, x in data.items() if key not in ABOUT}
    else:
        raise FileFormatError(
            f"{file.name}: expected answers to exercise {number}, got none. Write them below "
            f'[answers."{number}"].'
        )
    return answers, read.seed or 0


def _from_words(names: list[str], words: list[str]) -> Answers:
    """Answers by question, from words name=answer or a single answer."""
    answers: Answers = {}
    for place, word in enumerate(words):
        name, sign, answer = word.partition("=")
        if sign and name.strip() in names:
            question, answer = name.strip(), answer.strip()
        else:
            question, answer = names[min(place, len(names) - 1)], word
        if question in answers:
            raise FileFormatError(
                f"{question}: expected one answer, got {shown(answers[question])} and "
                f"{shown(answer)}. Write one answer for each of {', '.join(names)}."
            )
        answers[question] = answer
    return answers


SIGNS = {"right": ("✓", typer.colors.GREEN), "wrong": ("✗", typer.colors.RED)}


def _say(verdict: Verdict, titles: Mapping[str, str]) -> None:
    """The verdict in colours, and in signs where the terminal has them."""
    words, states = texts("sheets", "command", verdict.language), STATES.of(verdict.language)
    for question in verdict.questions:
        sign, colour = SIGNS.get(question.state, ("?", typer.colors.YELLOW))
        if not shows_greek():
            sign = states[question.state]
        kind = f" [{titles[question.diagnosis]}]" if question.diagnosis else ""
        text = question.message.removeprefix(f"{question.name}: ")
        message = text if "\n" in text else text_of(text)
        lead = f"{sign} {question.name}{kind}: "
        typer.echo(typer.style(sign, fg=colour) + lead[len(sign) :] + wrapped(message, len(lead)))
        if question.read_as and not question.right:
            typer.echo(f"  {words('read', answer=question.read_as)}")
    for note in verdict.notes:
        typer.echo(note)
    if len(verdict.questions) > 1:
        typer.echo(verdict.points_text)
    if verdict.unread:
        typer.echo(words("unread", names=", ".join(verdict.unread)))


def sheet(
    number: Annotated[str, argument("CHAPTER", "1 to 7, the number of your own, or all.")],
    output: Annotated[Path, directory("Directory of the files, created if missing.")],
    seed: Annotated[int, typer.Option(metavar="N", help="Number of the variant.")] = 0,
    language: Language = ENGLISH,
    chapter: ChapterFolder = None,
) -> None:
    """Write a chapter for students, and its solutions for the teacher.

    For students: a page (HTML with MathML, no network needed), a Jupyter notebook, and a file to
    fill in. For the teacher, in the directory `teacher`: solutions and the mistakes to expect.

    \b
    Examples:
      geomtorsion exercises sheet 2 -o sheets
      geomtorsion exercises sheet all -o sheets --seed 7
      geomtorsion exercises sheet 1 -o sheets --language de
      geomtorsion exercises sheet 8 -o sheets --chapter my_chapter
    """
    numbers = list(chapters(language, chapter)) if number == "all" else [number]
    with working("exercises") as progress:
        for one in numbers:
            say_written(write_sheet(one, output, seed, progress, language, chapter))


class Format(StrEnum):
    """The systems for which exercises are exported; STACK runs in Moodle."""

    stack = "stack"
    moodle = "moodle"
    nbgrader = "nbgrader"


def export(
    to: Annotated[Format, option("--to", metavar="FORMAT", text="The system, as listed above.")],
    output: Annotated[Path, directory("Directory of the files, created if missing.")],
    only: Annotated[
        str | None,
        option(metavar="NUMBER,...", text="These exercises; default: all, or all of --chapter."),
    ] = None,
    seeds: Annotated[
        str | None,
        option(metavar="N,...", text="Variants; default: 0,1,2 for moodle, 0 for nbgrader."),
    ] = None,
    language: Language = ENGLISH,
    chapter: ChapterFolder = None,
) -> None:
    """Write exercises for Moodle (STACK) or nbgrader.

    \b
    moodle    Moodle XML with questions of STACK: a deployed seed for each variant,
              a node of the response tree for each recognised mistake
    stack     the same as moodle
    nbgrader  a course with notebooks: solutions, and hidden tests that grade

    \b
    Examples:
      geomtorsion exercises export --to moodle -o moodle
      geomtorsion exercises export --to moodle -o moodle --seeds 0,1,2,3,4
      geomtorsion exercises export --to nbgrader -o nbgrader --only 3.1,3.2,3.3
    """
    numbers = None if only is None else list(parts(only))
    variants: list[Any] | None = None if seeds is None else list(map(_seed, parts(seeds)))
    with working("exercises") as progress:
        done = exports.export(
            "stack" if to == Format.moodle else to.value,
            output,
            numbers,
            variants,
            progress,
            language,
            chapter,
        )
    count = len(done.files)
    typer.echo(f"wrote {'1 file' if count == 1 else f'{count} files'} to {output}")
    for note in done.notes:
        typer.echo(wrapped(note))


def _seed(text: str) -> int | str:
    """A number if the text is one, otherwise the text, which `load` refuses with a message."""
    return int(text) if text.isdecimal() and len(text) < len(str(MOST.seed)) + 1 else text


def grade(
    folder: Annotated[Path, argument("FOLDER", "One TOML file of answers per student.")],
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="FILE", help="Table of marks: CSV, or JSON by its name."
        ),
    ] = Path("marks.csv"),
    only: Annotated[
        str | None,
        option(
            metavar="NUMBER,...",
            text="Exercises that count; default: all that any student answered.",
        ),
    ] = None,
    seed: Annotated[
        int | None, option(metavar="N", text="Variant that every student must have worked on.")
    ] = None,
    seconds: Annotated[
        float,
        typer.Option(metavar="S", min=0.1, help="Longest time for the answers to one exercise."),
    ] = 10.0,
    chapter: ChapterFolder = None,
) -> None:
    """Grade a folder of answers.

    No file is ever run as code. A broken or hostile file is reported, and the marks of all other
    students are unaffected. The table is written after each student: a second run continues where
    the first was stopped. A row lists how many questions were answered, which exercises count, and
    what to check: a missing seed, an unknown question, two files of one student. The command ends
    with 1 if a file needs such a check.

    \b
    Examples:
      geomtorsion exercises grade answers -o marks.csv
      geomtorsion exercises grade answers -o marks.csv --only 2.2,3.3,5.4
    """
    numbers = None if only is None else list(parts(only))
    if not folder.is_dir():
        kind = "a file" if folder.exists() else "no such folder"
        raise FileFormatError(f"{folder}: expected a folder of TOML files, got {kind}.")
    with bar("grading") as show:

        def progress(done: int, total: int, name: str) -> None:
            if show is not None:
                show(done / total, f"{done} of {total} {name or 'graded'}")

        marks = grading.grade(
            folder,
            output,
            numbers,
            seed=seed,
            seconds=seconds,
            progress=progress,
            chapter=chapter,
        )
    # A long reason is cut here; the table contains the full text.
    for row in marks.rows:
        if row["remarks"] or row["status"] != grading.GRADED:
            reason = cut(row["remarks"] or row["diagnoses"], 100)
            share = f"{grading.range_text(row)}: " if int(row["unread"]) else ""
            typer.echo(f"{row['file']}: {row['status']}: {share}{reason}", err=True)
    if marks.chosen == grading.OCCURRING:
        typer.echo(
            f"counted: {', '.join(marks.numbers) or 'nothing'}, all that any student answered; "
            "choose others with --only"
        )
    note = f", {marks.kept} of them in an earlier run" if marks.kept else ""
    if marks.troubled:
        note += f"; {len(marks.troubled)} to be checked by you"
    typer.echo(f"graded {len(marks.graded)} of {len(marks.rows)} students{note}: {output}")
    if marks.troubled:
        raise typer.Exit(ExitCode.failed)

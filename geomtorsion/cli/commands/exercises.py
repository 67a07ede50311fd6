"""exercises: the list, and the group of their commands."""

from __future__ import annotations

from typing import ClassVar

import typer

from geomtorsion.cli.lazy import SETTINGS, LazyGroup
from geomtorsion.cli.options import ChapterFolder, Language
from geomtorsion.errors import ArgumentError
from geomtorsion.teaching.exercises.exercise import LEVELS
from geomtorsion.teaching.exercises.registry import chapters, levels_of, titles
from geomtorsion.teaching.texts import ENGLISH, language_name, texts


class ExerciseCommands(LazyGroup):
    """The commands below `geomtorsion exercises`."""

    module = "geomtorsion.cli.commands.exercise_commands"
    summaries: ClassVar = {
        "show": "Show the text and the questions of an exercise.",
        "hint": "Give hints, one step at a time.",
        "solution": "Solve an exercise step by step, for the teacher.",
        "sheet": "Write a chapter for students, and its solutions for the teacher.",
        "export": "Write exercises for Moodle (STACK) or nbgrader.",
        "grade": "Grade a folder of answers.",
        "check": "Check answers, and name the likely mistake; ends with 1 if one is wrong.",
    }
    # Grading has a limit for each answer.
    limited = frozenset({"export", "sheet", "solution"})
    # An answer may begin with a minus sign, so -h(...) must not request help.
    settings: ClassVar = {
        "check": {"ignore_unknown_options": True, "help_option_names": ["--help"]}
    }


exercises = typer.Typer(
    cls=ExerciseCommands, name="exercises", invoke_without_command=True, **SETTINGS
)


@exercises.callback()
def overview(
    context: typer.Context, language: Language = ENGLISH, chapter: ChapterFolder = None
) -> None:
    """List, show, check and grade exercises.

    Without a command, all exercises are listed by chapter. Answers are checked exactly, and the
    likely mistake is named; no answer of a student is ever run as code.

    \b
    Examples:
      geomtorsion exercises
      geomtorsion exercises --language de
      geomtorsion exercises --chapter my_chapter
      geomtorsion exercises show 3.2 --seed 7
      geomtorsion exercises check 3.2 "cos(phi2)/sin(phi2)"
      geomtorsion exercises export --to moodle -o moodle
      geomtorsion exercises grade answers -o marks.csv
    """
    if context.invoked_subcommand is not None:
        if language != ENGLISH:
            raise ArgumentError(
                f"--language: expected it behind the command, got it before it. Write `geomtorsion "
                f"exercises {context.invoked_subcommand} ... --language {language}`."
            )
        if chapter is not None:
            raise ArgumentError(
                f"--chapter: expected it behind the command, got it before it. Write `geomtorsion "
                f"exercises {context.invoked_subcommand} ... --chapter {chapter}`."
            )
        return
    named, levels = titles(language, chapter), LEVELS.of(language_name(language))
    level_of = levels_of(chapter)
    for group, title in chapters(language, chapter).items():
        typer.echo(typer.style(f"{group}  {title}", bold=True))
        for number, level in level_of.items():
            if number.startswith(f"{group}."):
                mark = "" if level == "exercise" else f"  ({levels[level]})"
                typer.echo(f"  {number}  {named[number]}{mark}")
    text = texts("sheets", "command", language_name(language))
    typer.echo("\n" + text("list", command="`geomtorsion exercises show 1.1`"))

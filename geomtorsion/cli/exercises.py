"""exercises: list them, show one, give a hint."""

from __future__ import annotations

from typing import Annotated

import typer

from geomtorsion.cli.exercises_check import check
from geomtorsion.cli.exercises_grade import grade
from geomtorsion.cli.exercises_sheet import sheet
from geomtorsion.cli.exercises_text import wrapped
from geomtorsion.cli.guard import guarded

Number = Annotated[str, typer.Argument(metavar="NUMBER", show_default=False, help="Such as 3.2.")]
Seed = Annotated[int, typer.Option(metavar="N", help="Which variant; 0 is that of the paper.")]

exercises = typer.Typer(
    name="exercises",
    invoke_without_command=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


@exercises.callback()
def overview(context: typer.Context) -> None:
    """List, show, check and grade exercises.

    Without a command: all exercises by chapter. Answers are checked exactly, and the likely mistake
    is named; nothing that a student writes is ever run as code.

    \b
    Examples:
      geomtorsion exercises
      geomtorsion exercises show 3.2 --seed 7
      geomtorsion exercises check 3.2 "cos(phi2)/sin(phi2)"
      geomtorsion exercises grade answers -o marks.csv
    """
    if context.invoked_subcommand is None:
        _listed()


def _listed() -> None:
    from geomtorsion.exercises.registry import CHAPTERS, EXERCISES

    for chapter, title in CHAPTERS:
        typer.echo(typer.style(f"{chapter}  {title}", bold=True))
        for number, _, name, level in EXERCISES:
            if number.startswith(f"{chapter}."):
                mark = "" if level == "exercise" else f"  ({level})"
                typer.echo(f"  {number}  {name}{mark}")
    typer.echo("\n`geomtorsion exercises show 1.1` shows one of them.")


def show(number: Number, seed: Seed = 0) -> None:
    """Show an exercise: what is given and what is asked.

    \b
    Examples:
      geomtorsion exercises show 3.2
      geomtorsion exercises show 3.2 --seed 7
    """
    from geomtorsion.exercises import load
    from geomtorsion.exercises.prompts import how_to_answer
    from geomtorsion.exercises.prose import text_of

    exercise = load(number, seed)
    typer.echo(typer.style(f"{exercise.number}  {exercise.title}", bold=True))
    typer.echo(f"{exercise.chapter}; {exercise.level}; seed {exercise.seed}\n")
    typer.echo(wrapped(text_of(exercise.statement)))
    for question in exercise.questions:
        typer.echo()
        name = typer.style(question.name, bold=True)
        points = f" ({question.points} points)" if question.points > 1 else ""
        typer.echo(f"{name}{points}: " + wrapped(text_of(question.prompt), len(question.name) + 2))
        typer.echo(wrapped(f"  Answer: {text_of(how_to_answer(question, options=False))}"))
        for key, said in question.options.items():
            typer.echo(f"    {key}: {said}")
    hints = len(exercise.hints)
    again = f" --seed {seed}" if seed else ""
    typer.echo(f"\n{hints} hints: `geomtorsion exercises hint {number}{again}`.")


def hint(
    number: Number,
    seed: Seed = 0,
    step: Annotated[int, typer.Option(metavar="K", min=1, help="Show hints up to this one.")] = 1,
) -> None:
    """Give hints, one step at a time.

    \b
    Examples:
      geomtorsion exercises hint 3.2
      geomtorsion exercises hint 3.2 --step 2
    """
    from geomtorsion.exercises import load
    from geomtorsion.exercises.prose import text_of

    exercise = load(number, seed)
    for place, text in enumerate(exercise.hints[:step], 1):
        typer.echo(wrapped(f"{place}. {text_of(text)}"))
    if step < len(exercise.hints):
        again = f" --seed {seed}" if seed else ""
        typer.echo(f"Next: `geomtorsion exercises hint {number}{again} --step {step + 1}`.")


for _command in (show, hint, sheet, grade):
    exercises.command()(guarded(_command))
# An answer may begin with a minus sign, and -h(...) is no cry for help.
_MINUS = {"ignore_unknown_options": True, "help_option_names": ["--help"]}
exercises.command(context_settings=_MINUS)(guarded(check))

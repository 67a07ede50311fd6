"""exercises solution: the worked solution, for the teacher."""

from __future__ import annotations

import typer

from geomtorsion.cli.options import Number, Seed
from geomtorsion.cli.terminal import wrapped
from geomtorsion.exercises import load
from geomtorsion.exercises.prose import text_of


def solution(number: Number, seed: Seed = 0) -> None:
    """Solve an exercise step by step, for the teacher.

    \b
    Examples:
      geomtorsion exercises solution 3.2
      geomtorsion exercises solution 3.2 --seed 7
    """
    exercise = load(number, seed)
    typer.echo(typer.style(f"{exercise.number}  {exercise.title}, seed {seed}", bold=True))
    for place, step in enumerate(exercise.worked, 1):
        typer.echo(f"\n{place}. " + wrapped(text_of(step.text), 3))
    typer.echo("\nAnswers, as they are checked:")
    for name, answer in exercise.answers().items():
        typer.echo(wrapped(f"  {name}: {answer}", len(name) + 4))

"""exercises show: what is given and what is asked."""

from __future__ import annotations

import typer

from geomtorsion.cli.options import Number, Seed
from geomtorsion.cli.terminal import wrapped
from geomtorsion.exercises import load
from geomtorsion.exercises.prompts import how_to_answer
from geomtorsion.exercises.prose import text_of


def show(number: Number, seed: Seed = 0) -> None:
    """Show an exercise: what is given and what is asked.

    \b
    Examples:
      geomtorsion exercises show 3.2
      geomtorsion exercises show 3.2 --seed 7
    """
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
        for key, meaning in question.options.items():
            typer.echo(f"    {key}: {meaning}")
    again = f" --seed {seed}" if seed else ""
    hints = len(exercise.hints)
    typer.echo(f"\n{hints} hints: `geomtorsion exercises hint {number}{again}`.")

"""exercises hint: one step after the other."""

from __future__ import annotations

from typing import Annotated

import typer

from geomtorsion.cli.options import Number, Seed
from geomtorsion.cli.terminal import wrapped
from geomtorsion.exercises import load
from geomtorsion.exercises.prose import text_of


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
    exercise = load(number, seed)
    for place, text in enumerate(exercise.hints[:step], 1):
        typer.echo(wrapped(f"{place}. {text_of(text)}"))
    # One at a time: the next is asked for by its number.
    if step < len(exercise.hints):
        again = f" --seed {seed}" if seed else ""
        typer.echo(f"Next: `geomtorsion exercises hint {number}{again} --step {step + 1}`.")

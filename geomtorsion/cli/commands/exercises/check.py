"""exercises check: an answer, and what is said about it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import Number, argument, option
from geomtorsion.cli.terminal import shows_greek, wrapped
from geomtorsion.errors import FileFormatError
from geomtorsion.exercises import load
from geomtorsion.exercises.diagnoses import TITLES
from geomtorsion.exercises.examiner import Examiner
from geomtorsion.exercises.prose import text_of
from geomtorsion.exercises.submission import loaded, read_submission
from geomtorsion.exercises.verdict import Verdict

# Keys at the top of a file that are no answers.
ABOUT = ("student", "name", "seed")
Answers = dict[str, Any]


def check(
    number: Number,
    answers: Annotated[
        list[str] | None,
        argument("[QUESTION=]ANSWER", "An answer; with several questions one each, name=answer."),
    ] = None,
    file: Annotated[
        Path | None, option("--file", metavar="FILE", text="Answers in a TOML file.")
    ] = None,
    seed: Annotated[
        int | None, option(metavar="N", text="Which variant; default: that of the file, or 0.")
    ] = None,
    seconds: Annotated[
        float, typer.Option(metavar="S", min=0.1, help="How long checking may take.")
    ] = 20.0,
) -> None:
    """Check answers, and name the likely mistake; ends with 1 if one is wrong.

    \b
    Examples:
      geomtorsion exercises check 3.2 "cos(phi2)/sin(phi2)"
      geomtorsion exercises check 3.3 "ricci=[[1/R^2, 0], [0, sin(r/R)^2]]" "scalar=2/R^2"
      geomtorsion exercises check 3.2 --file answers.toml
    """
    if (file is None) == (not answers):
        raise FileFormatError(
            "either an answer or --file was needed. Write the answer in quotes after the number, "
            f'as in: geomtorsion exercises check {number} "..."'
        )
    if file is not None:
        given: object
        given, own = _from_file(number, file)
        seed = own if seed is None else seed
    else:
        given = _from_words([q.name for q in load(number, seed or 0).questions], answers or [])
    with Examiner(seconds) as examiner:
        verdict = examiner.check(number, given, seed or 0)
    _say(verdict)
    if not verdict.right:
        raise typer.Exit(ExitCode.failed)


def _from_file(number: str, file: Path) -> tuple[object, int]:
    """The answers to one exercise in a file, and its seed; 0 if it has none."""
    data = loaded(file)
    read = read_submission(file)
    if number in read.answers:
        found = read.answers[number]
    elif "answers" not in data:
        found = {key: x for key, x in data.items() if key not in ABOUT}
    else:
        raise FileFormatError(
            f'{file.name}: it answers nothing of exercise {number}. Write [answers."{number}"].'
        )
    return found, read.seed or 0


def _from_words(names: list[str], words: list[str]) -> Answers:
    """Answers by question, from words name=answer or a single answer."""
    found: Answers = {}
    for place, word in enumerate(words):
        name, sign, answer = word.partition("=")
        if sign and name.strip() in names:
            found[name.strip()] = answer.strip()
        else:
            found[names[min(place, len(names) - 1)]] = word
    return found


def _say(verdict: Verdict) -> None:
    """The verdict in colours, and in signs where the terminal has them."""
    for question in verdict.questions:
        if shows_greek():
            sign = "✓" if question.right else "✗"
        else:
            sign = "right" if question.right else "wrong"
        colour = typer.colors.GREEN if question.right else typer.colors.RED
        kind = f" [{TITLES[question.diagnosis]}]" if question.diagnosis else ""
        said = question.message.removeprefix(f"{question.name}: ")
        message = said if "\n" in said else text_of(said)
        lead = f"{sign} {question.name}{kind}: "
        typer.echo(typer.style(sign, fg=colour) + lead[len(sign) :] + wrapped(message, len(lead)))
    for note in verdict.notes:
        typer.echo(note)
    if len(verdict.questions) > 1:
        typer.echo(f"{verdict.earned:g} of {verdict.points} points")

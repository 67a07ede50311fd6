"""check: the identities of every connection of a space, and its known answers."""

from __future__ import annotations

import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import SpaceOrFile
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import shows_greek, working
from geomtorsion.pictures.verdicts import Verdict, verdicts

# What holds -> its sign, the word where the terminal has no such sign, the colour.
MARKS = {
    True: ("✓", "ok  ", typer.colors.GREEN),
    False: ("✗", "FAIL", typer.colors.RED),
    None: ("?", "?   ", typer.colors.YELLOW),
}


def check(source: SpaceOrFile) -> None:
    """Check the identities of a space exactly.

    The checks are metricity, the decomposition of the connection, both Bianchi identities with
    torsion, the scalar identity, and the known answers of a shipped space. The command ends
    with 1 if a check fails.

    \b
    Examples:
      geomtorsion check kerr
      geomtorsion check my-tetrad.toml
    """
    with working(source) as progress:
        space = open_space(source)
        groups = verdicts(space, progress)
    for title, group in groups.items():
        typer.secho(title, bold=True)
        width = max(len(verdict.name) for verdict in group)
        for verdict in group:
            detail = verdict.detail
            if verdict.equation:
                detail = f"{verdict.equation}   ({detail})"
            typer.echo(f"  {_mark(verdict)} {verdict.name.ljust(width)}  {detail}")
        typer.echo()
    every = [verdict for group in groups.values() for verdict in group if verdict.required]
    failed = sum(verdict.failed for verdict in every)
    undecided = sum(verdict.holds is None for verdict in every)
    parts = [f"{len(every) - failed - undecided} of {len(every)} checks hold"]
    parts += [f"{failed} FAILED"] * bool(failed)
    parts += [f"{undecided} undecided"] * bool(undecided)
    typer.echo(f"{space.name}: {', '.join(parts)}.")
    if failed:
        raise typer.Exit(ExitCode.failed)


def _mark(verdict: Verdict) -> str:
    """A coloured sign for a verdict, in letters where the terminal has no check marks."""
    if not verdict.required and verdict.holds is False:
        return typer.style("–" if shows_greek() else "no  ", dim=True)
    sign, word, colour = MARKS[verdict.holds]
    return typer.style(sign if shows_greek() else word, fg=colour)

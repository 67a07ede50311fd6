"""paper: the equations of the paper, each with its verdict."""

from __future__ import annotations

import json
from dataclasses import asdict

import typer

from geomtorsion.cli.options import Form, Shown
from geomtorsion.paper import statements

TITLE = (
    "P. Fiziev, H. Kleinert, FUB-HEP/94-5 (1994), equations (1) to (27), each recomputed\n"
    "c1, s1, c2, s2: cosines and sines of phi1, phi2; indices count from 1, as in the paper;\n"
    "Omega = (u1, u2, u3), V = (u4, u5, u6), u1dot: the rate of change of u1"
)


def paper(
    form: Shown = Form.text,
) -> None:
    """Recompute the equations of Fiziev and Kleinert (1994).

    Equations (1) to (27): each printed claim, the verdict (it agrees with the computed result, or
    is a misprint), and the correct formula.

    \b
    Examples:
      geomtorsion paper
      geomtorsion paper --format json
    """
    claims = statements()
    if form is Form.json:
        typer.echo(json.dumps([asdict(statement) for statement in claims], indent=2))
        return
    typer.echo(f"{TITLE}\n")
    for statement in claims:
        note = f" ({statement.note})" if statement.note else ""
        right = statement.right if statement.agrees else f"right: {statement.right}"
        typer.echo(f"{statement.equation:<12}{statement.says}")
        typer.echo(f"{'':12}{statement.verdict}{note}")
        typer.echo(f"{'':12}{right}")
    agree = sum(statement.agrees for statement in claims)
    misprints = len(claims) - agree
    typer.echo(f"\n{len(claims)} claims recomputed: {agree} agree, {misprints} misprints.")

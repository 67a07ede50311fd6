"""paper: the equations of the paper, each with its verdict."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Annotated

import typer

from geomtorsion.errors import UnknownNameError

TITLE = (
    "P. Fiziev, H. Kleinert, FUB-HEP/94-5 (1994), equations (1) to (27), each recomputed\n"
    "c1, s1, c2, s2: cosines and sines of phi1, phi2; indices count from 1, as in the paper;\n"
    "Omega = (u1, u2, u3), V = (u4, u5, u6), u1dot: the change of u1"
)


def written(format: str = "text") -> str:
    """The claims of the paper as text or JSON.

    Raises
    ------
    UnknownNameError
        The format is neither text nor json.

    Examples
    --------
    >>> print(written().splitlines()[-1])
    42 claims recomputed: 33 agree, 9 misprints.
    """
    from geomtorsion.cli.claims import claims

    found = claims()
    if format == "json":
        return json.dumps([asdict(claim) for claim in found], indent=2)
    if format != "text":
        raise UnknownNameError(f"paper has no format {format!r}; choose text or json.")
    lines = [TITLE, ""]
    for claim in found:
        note = f" ({claim.note})" if claim.note else ""
        lines.append(f"{claim.equation:<12}{claim.says}")
        lines.append(f"{'':<12}{claim.verdict}{note}")
        lines.append(f"{'':<12}{'' if claim.agrees else 'right: '}{claim.right}")
    right = sum(claim.agrees for claim in found)
    misprints = len(found) - right
    lines += ["", f"{len(found)} claims recomputed: {right} agree, {misprints} misprints."]
    return "\n".join(lines)


def paper(
    format: Annotated[
        str, typer.Option("--format", metavar="FORMAT", help="text or json.")
    ] = "text",
) -> None:
    """Recompute equations (1) to (27) of the paper and say which agree and which are misprints.

    Example:  geomtorsion paper

    Example:  geomtorsion paper --format json
    """
    typer.echo(written(format))

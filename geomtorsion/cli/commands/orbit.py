"""orbit: a closed orbit from a rough guess, proved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from geomtorsion.cli.commands.fit import Curve
from geomtorsion.cli.options import (
    Force,
    Form,
    Moments,
    Parameters,
    Potential,
    Shown,
    argument,
    directory,
    option,
)
from geomtorsion.cli.results import show_result, write_result
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.cli.values import named_numbers, number, start_options
from geomtorsion.errors import StartError
from geomtorsion.ode import is_equation_file, read_equations
from geomtorsion.proofs import closed_orbit
from geomtorsion.spaces import pair_problems
from geomtorsion.support.checks import shown
from geomtorsion.support.typed_text import separated


def orbit(
    source: Annotated[
        str,
        argument("SPACE|FILE", "A file of equations (TOML), a shipped space or a tetrad file."),
    ],
    period: Annotated[str, option("--period", metavar="T", text="Rough guess of the period.")],
    near: Annotated[
        str | None,
        option(
            "--near",
            metavar="NAME=X,...",
            text="Rough guess of the start: states, or coordinates and u1, u2, ... along the legs.",
        ),
    ] = None,
    section: Annotated[
        list[str] | None,
        option(
            "--section",
            metavar="EXPR",
            text="Expression that vanishes at the start; may be repeated. Default: a plane across "
            "the motion.",
        ),
    ] = None,
    symmetry: Annotated[
        str | None,
        option(
            "--symmetry",
            metavar="NAME,...|NAME=X,...",
            text="States that change sign under time reversal, or their mirror values.",
        ),
    ] = None,
    conserved: Annotated[
        list[str] | None,
        option(
            "--conserved",
            metavar="NAME|EXPR[=X]",
            text="Invariant that keeps its value at --near, or has the value X; may be repeated.",
        ),
    ] = None,
    shift: Annotated[
        str | None,
        option(
            "--shift",
            metavar="NAME=X,...",
            text="Increase of a state in one period, such as phi=2*pi; `NAME=free` if it need not "
            "return.",
        ),
    ] = None,
    curve: Annotated[Curve, typer.Option(help="The motion in a space.")] = Curve.geodesic,
    parameters: Parameters = None,
    moments: Moments = None,
    force: Force = None,
    potential: Potential = None,
    digits: Annotated[int, typer.Option(metavar="N", help="Digits of the start and period.")] = 15,
    proved: Annotated[
        bool,
        typer.Option("--proved", help="Also print the box of the theorem and what it assumes."),
    ] = False,
    form: Shown = Form.text,
    output: Annotated[
        Path | None, directory("Write orbit.json and a figure of the orbit to this directory.")
    ] = None,
) -> None:
    """Find a closed orbit, and prove that it exists with its period and stability.

    Newton's method finds it from the guess. All printed digits are proved. A file of equations has
    tables rates, start, and perhaps parameters and invariants:

    \b
      rates = {x = "v", v = "(1-x**2)*v-x"}
      start = {x = 2, v = 0}

    \b
    Examples:
      geomtorsion orbit oscillator.toml --near x=2,v=0 --period 6.5 --section v --proved
      geomtorsion orbit pendulum.toml --period 6.5 --section v --conserved "v**2/2-cos(x)"
      geomtorsion orbit ellipsoid.toml --near theta=1.57,u1=0.01,u2=1 --period 6.2 \\
        --section phi --shift "phi=2*pi" --conserved "u1**2+u2**2=1"
    """
    with working(source):
        problem, start = _problem(
            source, _pairs(near, "--near"), curve.value, parameters, moments, force, potential
        )
        found = closed_orbit(
            problem,
            number(period, "period"),
            near=start or None,
            section=section or None,
            symmetry=_symmetry(symmetry),
            conserved=_conserved(conserved or ()),
            shift=_shift(shift),
            digits=digits,
        )
        document = {"source": source, **found.to_json()}
    lines = [str(found), *(found.theorem() if proved else ())]
    show_result(document, "\n".join(lines), form)
    write_result(output, "orbit", document, found.plot)


def _problem(
    source: str,
    near: Mapping[str, str],
    curve: str,
    parameters: list[str] | None,
    moments: str | None,
    force: str | None,
    potential: str | None,
) -> tuple[Any, dict[str, str]]:
    """The equations of a file or of a motion in a space, and the guessed states."""
    if is_equation_file(source):
        for name, value in (("moments", moments), ("force", force), ("potential", potential)):
            if value is not None:
                raise StartError(
                    f"{name}: expected nothing for a file of equations, got {shown(value)}. Write "
                    "it into the rates."
                )
        return read_equations(source).with_start(None, named_numbers(parameters or ())), dict(near)
    space = open_space(source)
    options = start_options(None, None, None, None, parameters, moments, force, potential)
    problem = pair_problems(space, **options)[0][curve]
    starts = dict(zip(problem.coordinates, problem.start or (), strict=True))
    speeds = {f"u{k + 1}": x for k, x in enumerate(problem.frame_velocity)}
    for name, text in near.items():
        table = starts if name in starts else speeds
        if name not in table:
            raise StartError(
                f"--near: expected one of {', '.join((*starts, *speeds))}, got {shown(name)}."
            )
        table[name] = number(text, name)
    options |= {"start": list(starts.values()), "frame_velocity": list(speeds.values())}
    return pair_problems(space, **options)[0][curve], {}


def _pairs(text: str | None, name: str) -> dict[str, str]:
    """name=value pairs separated by commas."""
    pairs = {}
    for part in separated(text) if text else ():
        key, sign, value = part.partition("=")
        if not sign or not key.strip() or not value.strip():
            raise StartError(f"{name}: expected NAME=X, got {shown(part)}. Write {name} x=1,v=0.")
        if key.strip() in pairs:
            raise StartError(f"{name}: expected {key.strip()} once, got it twice. Give one value.")
        pairs[key.strip()] = value.strip()
    return pairs


def _symmetry(text: str | None) -> dict[str, str] | None:
    """State -> value at its mirror, which is zero where none was typed."""
    if text is None:
        return None
    return _pairs(",".join(x if "=" in x else f"{x}=0" for x in separated(text)), "--symmetry")


def _conserved(texts: Sequence[str]) -> dict[str, str | None]:
    """Quantity -> its value, or None for the value at the guess."""
    pairs = (text.partition("=") for text in texts)
    return {name.strip(): value.strip() if sign else None for name, sign, value in pairs}


def _shift(text: str | None) -> dict[str, str | None] | None:
    """State -> how much it grows, or None for free."""
    pairs = _pairs(text, "--shift")
    return {k: None if x == "free" else x for k, x in pairs.items()} if text else None

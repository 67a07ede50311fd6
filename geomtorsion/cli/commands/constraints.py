"""constraints: whether initial data on a grid satisfy the constraints."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from geomtorsion import gravity
from geomtorsion.cli.options import Form, Shown, argument, directory
from geomtorsion.cli.results import show_result, write_result
from geomtorsion.cli.terminal import working
from geomtorsion.pictures.constraints import draw_constraints


def constraints(
    file: Annotated[
        Path,
        argument(
            "FILE", "An .npz or .h5 file with metric, extrinsic_curvature and axis_x, axis_y, ..."
        ),
    ],
    order: Annotated[
        int, typer.Option("--order", metavar="N", help="Order of differences: 2, 4, 6 or 8.")
    ] = 4,
    constant: Annotated[
        float, typer.Option("--lambda", metavar="X", help="Cosmological constant.")
    ] = 0.0,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for constraints.json and constraints.png, created if missing."),
    ] = None,
) -> None:
    """Check whether initial data on a grid satisfy the constraints of gravity.

    The file holds metric and extrinsic_curvature of shape (3, 3, N, N, N), axis_x, axis_y, axis_z,
    and optionally density, momentum, mask and unit. Errors are estimated from a grid of twice the
    step.

    \b
    Examples:
      geomtorsion constraints slice.npz
      geomtorsion constraints slice.h5 --order 6 -o out
    """
    with working(file.name):
        data = gravity.read_slice(file, order)
        result = data.constraints(constant)
    text = f"{data}\n{result}"
    document = {"file": file.name} | result.to_json()
    show_result(document, text, form)
    write_result(output, "constraints", document, partial(draw_constraints, result))

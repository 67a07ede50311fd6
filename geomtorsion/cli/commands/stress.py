"""stress: the stress of a dislocation network, a coframe or a Nye field."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from geomtorsion.cli.measured_sources import Reading, opened, sigma_of
from geomtorsion.cli.options import (
    Form,
    MeasuredColumns,
    MeasuredSigma,
    Shown,
    argument,
    directory,
    option,
)
from geomtorsion.cli.results import say_on_error
from geomtorsion.cli.terminal import wrapped
from geomtorsion.errors import FileFormatError, GeomtorsionError, GridError, NetworkError
from geomtorsion.materials import Source
from geomtorsion.materials.elasticity import ElasticConstants, NyeField, Stresses, stresses
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.lines import DislocationNetwork
from geomtorsion.materials.readers import is_source
from geomtorsion.pictures.stress import COMPONENTS, draw_stress
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.support.checks import choice, shown
from geomtorsion.support.files import ending, finite_number, make_folder, write_text
from geomtorsion.support.outgoing import measured_text
from geomtorsion.support.progress import bar

# Options in messages of the library -> as typed.
TYPED = {
    "NyeField.of_frame(frame).padded(nodes).balanced()": "--padding N --balance",
    "balance=True or source.balanced(),": "--balance,",
    "balance=True": "--balance",
    "source.padded(nodes)": "--padding N",
    "with shape": "with --nodes",
    "shape:": "--nodes:",
    "shape[": "--nodes[",
    "core:": "--core:",
    "gauge:": "--gauge:",
}


def stress(
    file: Annotated[
        Path,
        argument("FILE", "A network (.data, .ca, .json), a coframe on a grid, or a Nye field."),
    ],
    elastic: Annotated[
        str,
        option(
            metavar="'NAME C ... UNIT'",
            text="Elastic constants: 'isotropic MU NU', 'cubic C11 C12 C44', 'hexagonal C11 C12 "
            "C13 C33 C44' or 'voigt' with 21 numbers, and their unit.",
        ),
    ],
    nodes: Annotated[
        str | None,
        option(
            metavar="N[,N,N]",
            text="Networks: nodes along the longest edge, or along each edge; default: 64.",
        ),
    ] = None,
    core: Annotated[
        float | None,
        option(metavar="X", text="Width of the Gaussian core; default: two steps for lines."),
    ] = None,
    gauge: Annotated[
        float, typer.Option(metavar="X", help="Length scale of the gauge theory of dislocations.")
    ] = 0.0,
    balance: Annotated[
        bool,
        typer.Option("--balance", help="Compensate a net b by a uniform density in the cell."),
    ] = False,
    padding: Annotated[
        int | None,
        option(metavar="N", text="Maps with open ends: nodes of perfect crystal around them."),
    ] = None,
    sigma: MeasuredSigma = None,
    columns: MeasuredColumns = None,
    convention: Annotated[
        str | None,
        option(
            metavar="NAME",
            text="Sign of b in the file: SF/RH, Hirth-Lothe, ...; default: Hirth-Lothe for "
            "networks in .data files, else SF/RH.",
        ),
    ] = None,
    component: Annotated[
        str, typer.Option(metavar="IJ", help="Component in the figure: xx, ..., xy, or mises.")
    ] = "mises",
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for stress.json, stress.vtk and stress.png, created if missing."),
    ] = None,
) -> None:
    """Compute the stress of dislocation lines or of a measured torsion.

    It is the stress of least elastic energy. The source is a dislocation network in a periodic box,
    or a measured field: a coframe on a grid, or an .npz file with a Nye tensor. stress.json holds
    the Peach-Koehler force on each line of a network; stress.vtk opens in ParaView. Lengths are in
    the unit of the file, stresses in the unit of the elastic constants.

    \b
    Examples:
      geomtorsion stress chains.data --elastic "cubic 168.4 121.4 75.4 GPa" --balance -o out
      geomtorsion stress nye.npz --elastic "isotropic 80 0.3 GPa" --sigma 1e-3 --balance
      geomtorsion stress map.csv --elastic "isotropic 80 0.3 GPa" --padding 32 --balance
    """
    constants = ElasticConstants.of_text(elastic)
    choice(component, COMPONENTS, "--component", GridError)
    with bar(f"{file.name}: reading", 3) as show:
        source = _opened(file, padding, Reading(sigma, columns=columns))
        sign = convention or ("Hirth-Lothe" if ending(file) == ".data" else "SF/RH")
        if show is not None:
            show(1, f"{file.name}: stress")
        try:
            result = stresses(
                source, constants, shape=_nodes(nodes), core=core, gauge=gauge, balance=balance,
                convention=sign,
            )  # fmt: skip
        except (GridError, NetworkError) as error:
            raise _typed(error) from None
        document = {"file": file.name, **_summary(result)}
        if show is not None:
            show(2, f"{file.name}: errors")
        errors = result.errors
        causes = {"noise": errors.noise, "grid": errors.grid, "outside": errors.outside}
        document |= {"error": result.error, "energy_error": result.energy_error}
        document["largest_errors"] = {
            k: float(np.nanmax(x, initial=0.0)) for k, x in causes.items()
        }
    typer.echo(json.dumps(document, indent=2)) if form is Form.json else _explain(document)
    if output is not None:
        _save(result, document, component, output)


def _typed(error: GeomtorsionError) -> GeomtorsionError:
    """The same error with options as typed on the command line."""
    message = str(error)
    for python, typed in TYPED.items():
        message = message.replace(python, typed)
    return type(error)(message)


def _opened(
    file: Path, padding: int | None, reading: Reading
) -> DislocationNetwork | SampledFrame | NyeField:
    """The source in a file, by its ending and content."""
    if not is_source(file):
        if reading.columns is not None:
            raise GridError("--columns: expected a table, got a network. Omit it.")
        if padding is not None:
            raise GridError("--padding: expected a field with open ends, got a network. Omit it.")
        if reading.sigma is not None:
            raise GridError("--sigma: expected a measured field, got a network. Omit it.")
        return DislocationNetwork.read(file)
    field: Source | NyeField
    if NyeField.is_in(file):
        field = NyeField.read(file)
        noise = None if reading.sigma is None else sigma_of(reading.sigma)
        if isinstance(noise, str):
            raise GridError(
                "--sigma: expected a number for a Nye field, got estimate. Give the standard "
                "deviation of its values."
            )
        field = field if noise is None else replace(field, sigma=noise)
    else:
        field = opened(str(file), reading)
    if not isinstance(field, SampledFrame | NyeField):
        raise FileFormatError(
            f"{file.name}: expected a network, a coframe on a grid or a Nye field, got "
            f"{type(field).__name__}. Save the Nye tensor of a grain: "
            "NyeField.of_frame(map.frame(0)).save('nye.npz')."
        )
    if padding is None:
        return field
    return (field if isinstance(field, NyeField) else NyeField.of_frame(field)).padded(padding)


def _nodes(text: str | None) -> int | list[int] | None:
    """Numbers of nodes as typed."""
    if text is None:
        return None
    values = [finite_number(word.strip()) for word in text.split(",")]
    whole = [int(x) for x in values if x is not None and x == int(x)]
    if len(whole) != len(values) or len(values) not in (1, 3):
        raise GridError(f"--nodes: expected one whole number or three, got {shown(text)}.")
    return whole[0] if len(whole) == 1 else whole


def _summary(result: Stresses) -> dict[str, Any]:
    """Numbers of a stress, as plain data."""
    mean = np.sqrt((result.stress**2).mean(axis=(2, 3, 4)))
    return {
        "source": repr(result.source),
        "nodes": list(result.cell.shape),
        "core": result.core,
        "gauge": result.gauge,
        "convention": result.convention,
        "unit": result.unit,
        "length_unit": result.length_unit,
        "largest_stress": result.largest,
        "root_mean_square": mean.tolist(),
        "energy": result.energy,
        "energy_unit": result.energy_unit,
        "corrections": list(result.corrections),
    }


def _explain(document: dict[str, Any]) -> None:
    """The summary in words."""
    unit = f" {document['unit']}" if document["unit"] else ""
    energy = document["energy_unit"]
    nodes = " x ".join(map(str, document["nodes"]))
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = document["root_mean_square"]
    gauge = f", gauge length {document['gauge']:.6g}" if document["gauge"] else ""
    typer.secho(document["file"], bold=True)
    largest, error = document["largest_stress"], document["error"]
    parts = {k: x for k, x in document["largest_errors"].items() if x}
    causes = f" ({', '.join(f'{k} {x:.1g}' for k, x in parts.items())})" if len(parts) > 1 else ""
    means = f"xx {xx:.4g}, yy {yy:.4g}, zz {zz:.4g}, yz {yz:.4g}, xz {xz:.4g}, xy {xy:.4g}{unit}"
    for line in (
        document["source"],
        f"{nodes} nodes, core {document['core']:.6g}{gauge}, b as in {document['convention']}",
        f"largest stress {measured_text(largest, error, document['unit'])}{causes}",
        f"root mean square: {means}",
        f"energy {measured_text(document['energy'], document['energy_error'], energy)}",
        *document["corrections"],
    ):
        typer.echo(wrapped(f"  {line}"))


def _save(result: Stresses, document: dict[str, Any], component: str, folder: Path) -> None:
    """stress.json with the forces, stress.vtk and stress.png."""
    make_folder(folder)
    if isinstance(result.source, DislocationNetwork):
        document = {**document, "forces": result.forces.tolist()}
    paths = [folder / "stress.json", folder / "stress.vtk"]
    write_text(paths[0], json.dumps(document, indent=2) + "\n")
    result.save(paths[1])
    if can_draw():
        paths.append(folder / "stress.png")
        save(draw_stress(result, component), paths[-1])
    say_on_error(paths)

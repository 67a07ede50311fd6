"""network: a dislocation network of a simulation, for a person or for a pipeline."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.loop_sources import Texts, typed_loop
from geomtorsion.cli.options import Form, Shown, argument, directory, option
from geomtorsion.cli.terminal import ROWS
from geomtorsion.errors import GeomtorsionError, MissingExtraError, NetworkError
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop
from geomtorsion.materials.lines import DislocationNetwork, DislocationSeries, LineFamily
from geomtorsion.pictures.network import draw_lines
from geomtorsion.pictures.series import draw_series
from geomtorsion.pictures.style import save
from geomtorsion.support.files import make_folder, write_text
from geomtorsion.support.outgoing import count_text
from geomtorsion.support.progress import bar


def network(
    file: Annotated[Path, argument("FILE", "A ParaDiS or ExaDiS .data file, or a folder.")],
    circle: Annotated[
        Texts, option(metavar="CENTRE:RADIUS[:PLANE]", text="A circuit: 0,0,0:5000:x,y")
    ] = [],
    polygon: Annotated[
        Texts, option(metavar="POINT;POINT;...", text="A circuit: '0,0,0;1,0,0;0,1,0'")
    ] = [],
    lattice: Annotated[
        str | None,
        option(
            metavar="NAME", text="sc, fcc, bcc or hcp: show b of circuits also in lattice vectors."
        ),
    ] = None,
    symmetry: Annotated[
        str,
        typer.Option(metavar="NAME", help="Symmetry of the families: cubic, hexagonal or none."),
    ] = "cubic",
    unit: Annotated[
        float | None,
        option(metavar="METRES", text="Unit of length of the file: shows densities per m^2."),
    ] = None,
    bounded: Annotated[bool, typer.Option("--bounded", help="The box is not periodic.")] = False,
    form: Shown = Form.text,
    output: Annotated[
        Path | None,
        directory("Directory for network.json and network.png, created if missing."),
    ] = None,
) -> None:
    """Read a dislocation network, and check that b is conserved at its nodes.

    The output also lists the families of lines with their densities, and b of circuits. Burgers
    vectors and lengths are in the units of the file. A circuit around a line, right-handed about
    its sense, has the b of the line. The command ends with 1 if b is not conserved at an
    inner node, or a circuit fails.

    A folder holds the files of a simulation, one for each time. The output lists density and
    junctions, and the junctions that form and dissolve from each file to the next.

    \b
    Examples:
      geomtorsion network chains.data -o out
      geomtorsion network chains.data --circle 0,0,0:20000:x,y --lattice fcc
      geomtorsion network chains.data --unit 2.55e-10 --format json | jq .density
      geomtorsion network run -o out
    """
    if unit is not None and not 0 < unit < float("inf"):
        raise NetworkError(f"--unit: expected a positive length in metres, got {unit}.")
    loops = _circuits({"circle": circle, "polygon": polygon})
    if lattice is not None and not loops:
        raise NetworkError(
            "--lattice: expected a circuit, got none. Give one with --circle or --polygon."
        )
    if file.is_dir():
        if loops:
            raise NetworkError(
                "--circle, --polygon: expected a single file, got a folder. Name one of its files."
            )
        _show_series(file, symmetry, unit, bounded, form, output)
        return
    parts = 2 + len(loops) + (output is not None)
    with bar(f"{file.name}: reading", parts) as show:
        done = 0

        def progress(what: str) -> None:
            nonlocal done
            done += 1
            if show is not None:
                show(done, f"{file.name}: {what}")

        net = DislocationNetwork.read(file, not bounded)
        progress(f"{len(net.lines):,} lines: node rule")
        document = _summary(net, symmetry, unit) | {"file": file.name}
        document["circuits"] = []
        for k, loop in enumerate(loops, 1):
            progress(f"circuit {k}")
            document["circuits"].append(_circuit(net, loop, lattice))
        if output is not None:
            progress("picture")
            _save(document, net, loops, symmetry, output)
    typer.echo(json.dumps(document, indent=2)) if form is Form.json else _explain(document)
    failed = any("failed" in one for one in document["circuits"])
    if document["violations"] or failed:
        raise typer.Exit(ExitCode.failed)


def _show_series(
    folder: Path,
    symmetry: str,
    unit: float | None,
    bounded: bool,
    form: Form,
    output: Path | None,
) -> None:
    """Networks in time: text or JSON, and network.json with a figure."""
    with bar(f"{folder.name}: reading", 2) as show:
        series = DislocationSeries.read(folder, not bounded)
        if show is not None:
            show(1, f"{folder.name}: {len(series)} networks")
        square = None if unit is None else unit**-2
        document = {
            "file": folder.name,
            "times": np.asarray(series.times).tolist(),
            "density": series.density.tolist(),
            "density_per_m2": None if square is None else (series.density * square).tolist(),
            "densities": {key: row.tolist() for key, row in series.densities(symmetry).items()},
            "junctions": series.junctions.tolist(),
            "reactions": {
                key: {"formed": formed.tolist(), "dissolved": dissolved.tolist()}
                for key, (formed, dissolved) in series.reactions().items()
            },
        }
    typer.echo(json.dumps(document, indent=2) if form is Form.json else _series_text(document))
    if output is None:
        return
    make_folder(output)
    written = [output / "network.json", output / "network.png"]
    try:
        save(draw_series(series, symmetry), written[1])
    except MissingExtraError as error:
        typer.echo(f"No picture: {error}", err=True)
        written.pop()
    write_text(written[0], json.dumps(document, indent=2) + "\n")
    typer.echo(f"wrote {' and '.join(map(str, written))}", err=True)


def _series_text(document: dict[str, Any]) -> str:
    """Networks in time, in columns."""
    times, reactions = document["times"], document["reactions"]
    rows = [typer.style(document["file"], bold=True), f"  {len(times)} networks"]
    rows.append(f"\n  {'time':>12}{'density':>28}{'junctions':>11}{'formed':>8}{'dissolved':>11}")
    for k, time in enumerate(times):
        metres = document["density_per_m2"]
        one = {
            "density": document["density"][k],
            "density_per_m2": None if metres is None else metres[k],
        }
        counts = [
            "" if k == 0 else str(sum(row[name][k - 1] for row in reactions.values()))
            for name in ("formed", "dissolved")
        ]
        rows.append(
            f"  {time:>12g}{_density(one):>28}{document['junctions'][k]:>11,}{counts[0]:>8}"
            f"{counts[1]:>11}"
        )
    totals = {key: (sum(row["formed"]), sum(row["dissolved"])) for key, row in reactions.items()}
    shown = sorted(totals.items(), key=lambda item: -sum(item[1]))[:ROWS]
    rows += ["", f"  {'formed':>8}{'dissolved':>11}  lines that meet"] if shown else []
    rows += [f"  {formed:>8,}{gone:>11,}  {key}" for key, (formed, gone) in shown]
    return "\n".join(rows)


def _circuits(given: dict[str, Texts]) -> list[Loop]:
    """Loops given on the command line, in Cartesian coordinates."""
    space = Frame("x y z", np.eye(3, dtype=int).tolist())
    return [typed_loop(space, kind, text) for kind, texts in given.items() for text in texts]


def _summary(net: DislocationNetwork, symmetry: str, unit: float | None) -> dict[str, Any]:
    """Everything but circuits, as plain data."""
    lines, square = net.arrays, None if unit is None else unit**-2
    sums = np.abs(lines.excess).max(initial=0.0)
    return {
        "nodes": len(lines.positions),
        "lines": len(lines.pairs),
        "junctions": len(net.junctions),
        "length": float(lines.lengths.sum()),
        "density": net.density,
        "density_per_m2": None if square is None else net.density * square,
        "largest_sum_at_a_node": float(sums),
        "violations": [
            {"node": _named(one.node), "missing": [float(x) for x in one.missing], "text": str(one)}
            for one in net.node_rule()
        ],
        "families": [_family(one, square) for one in net.families(symmetry)],
        "nye": net.nye.tolist(),
    }


def _named(node: object) -> str:
    """A node as its file names it."""
    return ",".join(map(str, node)) if isinstance(node, tuple) else str(node)


def _family(one: LineFamily, square: float | None) -> dict[str, Any]:
    """One family as plain data."""
    assert one.density is not None
    return {
        "burgers": one.name,
        "lines": one.lines,
        "length": one.length,
        "density": one.density,
        "density_per_m2": None if square is None else one.density * square,
        "screw": one.screw,
        "edge": one.edge,
    }


def _circuit(net: DislocationNetwork, loop: Loop, lattice: str | None) -> dict[str, Any]:
    """The Burgers vector of one circuit as plain data, or why there is none."""
    try:
        burgers = net.burgers(loop, lattice)
    except GeomtorsionError as error:
        return {"circuit": loop.name, "failed": str(error), "kind": type(error).__name__}
    return {
        "circuit": loop.name,
        "vector": burgers.vector.tolist(),
        "lattice": burgers.whole.tolist() or None,
        "crossings": len(burgers.crossings),
    }


def _explain(document: dict[str, Any]) -> None:
    """The summary in words and columns."""
    say = typer.echo
    typer.secho(document["file"], bold=True)
    say(
        f"  {count_text(document['nodes'], 'node')}, {count_text(document['lines'], 'line')}, "
        f"{count_text(document['junctions'], 'junction')}"
    )
    say(f"  length {document['length']:.6g}, density {_density(document)}")
    broken = document["violations"]
    if not broken:
        say(f"  b is conserved at every node: largest sum {document['largest_sum_at_a_node']:.2g}")
    else:
        where = count_text(len(broken), "node")
        typer.secho(f"  b is not conserved at {where}", fg=typer.colors.RED)
        for row in broken[:ROWS]:
            say(f"    {row['text']}; missing: {_vector(row['missing'])}")
        if len(broken) > ROWS:
            say(f"    and {len(broken) - ROWS} more; -o DIR writes all to network.json")
    say(f"\n  {'b':<22}{'lines':>9}{'length':>13}{'density':>25}{'screw':>8}{'edge':>7}")
    for row in document["families"]:
        say(
            f"  {row['burgers']:<22}{row['lines']:>9,}{row['length']:>13.6g}{_density(row):>25}"
            f"{row['screw']:>8.0%}{row['edge']:>7.0%}"
        )
    for row in document["circuits"]:
        typer.secho(f"\n{row['circuit']}", bold=True)
        if "failed" in row:
            typer.secho(f"  failed: {row['failed']}", fg=typer.colors.RED)
            continue
        whole = "" if row["lattice"] is None else f" = {row['lattice']} in lattice vectors"
        crossings = count_text(row["crossings"], "crossing")
        say(f"  b = {_vector(row['vector'])}{whole}, from {crossings}")


def _density(one: dict[str, Any]) -> str:
    """A density in the units of the file, or per square metre where these are known."""
    metres = one["density_per_m2"]
    return f"{one['density']:.6g} per unit^2" if metres is None else f"{metres:.6g} per m^2"


def _vector(values: Sequence[float]) -> str:
    """A Burgers vector for people; minus zero is zero."""
    return "(" + ", ".join(f"{x + 0.0:.6g}" for x in values) + ")"


def _save(
    document: dict[str, Any],
    net: DislocationNetwork,
    loops: Sequence[Loop],
    symmetry: str,
    folder: Path,
) -> None:
    """network.json and network.png."""
    make_folder(folder)
    written = [folder / "network.json", folder / "network.png"]
    try:
        save(draw_lines(net, loops, symmetry), written[1])
    except (MissingExtraError, NetworkError) as error:
        # An empty network has no picture.
        typer.echo(f"No picture: {error}", err=True)
        written.pop()
    write_text(written[0], json.dumps(document, indent=2) + "\n")
    typer.echo(f"wrote {' and '.join(map(str, written))}", err=True)

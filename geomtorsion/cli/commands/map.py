"""map: Burgers vectors all over an orientation map, and of circles in it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from geomtorsion.checks import cut
from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import argument, directory, option
from geomtorsion.cli.terminal import working
from geomtorsion.errors import GeomtorsionError, LoopError, MissingExtraError, OrientationError
from geomtorsion.loops import Loop
from geomtorsion.orientations import CircuitMap, MapBurgers, OrientationMap
from geomtorsion.pictures.orientations import draw_grains, draw_orientations
from geomtorsion.pictures.style import save

Texts = list[str]


def map(
    file: Annotated[Path, argument("FILE", "An orientation map: .ctf or .ang.")],
    size: Annotated[int, option(metavar="N", text="Cells along a side of the squares.")] = 8,
    circle: Annotated[
        Texts | None, option(metavar="X,Y:RADIUS", text="A circle in the map: 20,30:8")
    ] = None,
    threshold: Annotated[
        float, option(metavar="DEGREES", text="Neighbours below it are in one grain; default: 5.")
    ] = 5.0,
    sigma: Annotated[
        float | None,
        option(metavar="DEGREES", text="Noise of an orientation; default: from the map."),
    ] = None,
    laue: Annotated[
        Texts | None, option(metavar="PHASE=GROUP", text="Symmetry of a phase: 1=m-3m")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Results as data on standard output.")
    ] = False,
    output: Annotated[
        Path | None, directory("Directory for map.npz, map.json and pictures, made if missing.")
    ] = None,
) -> None:
    """Compute Burgers vectors all over an orientation map (EBSD).

    Those of all squares of a size, each in one grain: |b| per area, beside what noise alone
    makes of it. A circle is in the unit of the map, from its first pixel. One that crosses a
    boundary is reported in its place, and the command ends with 1.

    \b
    Examples:
      geomtorsion map scan.ctf --size 8 -o out
      geomtorsion map scan.ang --threshold 3 --circle 20,30:8
      geomtorsion map scan.ctf --laue 1=6/mmm --json
    """
    with working(file.name) as progress:
        crystal = OrientationMap.read(
            file, laue=_symmetries(laue or []), threshold=threshold, sigma=sigma
        )
        progress("grains and circuits")
        squares = crystal.burgers_map(size)
        found = [_circled(crystal, text) for text in circle or []]
    document = {"file": file.name} | _summary(crystal, squares)
    document["circles"] = [told for told, _ in found]
    if as_json:
        typer.echo(json.dumps(document, indent=2))
    else:
        _explain(document)
    if output is not None:
        vectors = [b for _, b in found if b is not None]
        _save(document, crystal, squares, vectors, output)
    if any("failed" in told for told, _ in found):
        raise typer.Exit(ExitCode.failed)


def _symmetries(texts: Texts) -> dict[int, str]:
    """Number of a phase -> Laue group, from PHASE=GROUP."""
    found = {}
    for text in texts:
        number, equals, group = text.partition("=")
        if not equals or not number.strip().isdecimal() or len(number) > 9:
            raise OrientationError(
                f"--laue {cut(text)}: PHASE=GROUP was needed, as in --laue 1=m-3m."
            )
        found[int(number)] = group.strip()
    return found


def _circled(crystal: OrientationMap, text: str) -> tuple[dict[str, Any], MapBurgers | None]:
    """What a circle of the command line encloses."""
    name = f"circle {cut(text)}"
    try:
        centre, _, radius = text.partition(":")
        x, y = (float(part) for part in centre.split(","))
        loop = Loop.circle([x, y], float(radius), name=name)
    except ValueError as error:
        if isinstance(error, GeomtorsionError):
            raise
        raise LoopError(
            f"--circle {cut(text)}: X,Y:RADIUS was needed, as in --circle 20,30:8."
        ) from None
    try:
        b = crystal.burgers(loop)
    except GeomtorsionError as error:
        return {"circle": name, "failed": str(error)}, None
    told = {
        "circle": name,
        "vector": b.vector.tolist(),
        "specimen": b.specimen.tolist(),
        "size": b.size,
        "sigma": b.sigma,
        # JSON knows no infinity, which is what a map without noise gives.
        "significance": b.significance if np.isfinite(b.significance) else None,
        "area": b.area,
        "grain": b.grain,
        "phase": b.phase.name,
        "unit": b.unit,
    }
    return told, b


def _summary(crystal: OrientationMap, squares: CircuitMap) -> dict[str, Any]:
    """What the squares say, as plain data."""
    per_area, floor = squares.per_area[squares.clean], squares.floor[squares.clean]
    known = bool(squares.clean.any())
    return {
        "pixels": list(crystal.shape),
        "steps": list(crystal.steps),
        "unit": crystal.unit,
        "phases": {str(number): phase.name for number, phase in crystal.phases.items()},
        "grains": crystal.grains.count,
        "threshold": crystal.threshold,
        "size": squares.size,
        "clean": int(squares.clean.sum()),
        "circuits": int(squares.clean.size),
        "median_per_area": float(np.median(per_area)) if known else None,
        "noise_per_area": float(np.median(floor)) if known else None,
        "noise_from": "given" if crystal.sigma is not None else "sixth differences of the map",
    }


def _explain(document: dict[str, Any]) -> None:
    """The results in words."""
    rows, columns = document["pixels"]
    names = ", ".join(document["phases"].values())
    typer.secho(f"{document['file']}: {rows} x {columns} pixels, {names}", bold=True)
    typer.echo(f"  {document['grains']} grains at {document['threshold']:g} degrees")
    size, unit = document["size"], document["unit"]
    typer.echo(
        f"  {document['clean']} of {document['circuits']} squares of {size} x {size} cells stay in "
        "one grain"
    )
    if document["median_per_area"] is not None:
        typer.echo(
            f"  |b| per area: median {document['median_per_area']:.3g} 1/{unit}; noise alone "
            f"({document['noise_from']}): {document['noise_per_area']:.3g} 1/{unit}"
        )
    for told in document["circles"]:
        typer.secho(told["circle"], bold=True)
        if "failed" in told:
            typer.secho(f"  failed: {told['failed']}", fg=typer.colors.RED)
            continue
        for axes, key in (("crystal", "vector"), ("specimen", "specimen")):
            shown = ", ".join(f"{x:.4g}" for x in told[key])
            typer.echo(f"  b = ({shown}) {told['unit']} in {axes} axes")
        typer.echo(
            f"  |b| = {told['size']:.4g} +- {told['sigma']:.1g} {told['unit']}, grain "
            f"{told['grain']} ({told['phase']})"
        )


def _save(
    document: dict[str, Any],
    crystal: OrientationMap,
    squares: CircuitMap,
    found: list[MapBurgers],
    folder: Path,
) -> None:
    """map.npz, map.json and pictures."""
    folder.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(
        folder / "map.npz",
        vectors=squares.vectors,
        specimen=squares.specimen,
        clean=squares.clean,
        sigma=squares.sigma,
        significance=squares.significance,
        grain=crystal.grain,
        area=squares.area,
        size=squares.size,
    )
    (folder / "map.json").write_text(json.dumps(document, indent=2) + "\n", "utf-8")
    names = ["map.npz", "map.json"]
    try:
        save(draw_orientations(crystal, squares), folder / "squares.png")
        save(draw_grains(crystal, found[0] if found else None), folder / "grains.png")
        names += ["squares.png", "grains.png"]
    except MissingExtraError as error:
        typer.echo(f"no pictures: {error}", err=True)
    typer.echo(f"wrote {', '.join(names)} into {folder}", err=True)

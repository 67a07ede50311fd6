"""results: Burgers vectors and surveys of measured matter, in words and as files."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.options import NO_PICTURES, Form
from geomtorsion.cli.terminal import working, wrapped
from geomtorsion.errors import GeomtorsionError
from geomtorsion.loops import Loop
from geomtorsion.materials import Burgers, Source, Survey
from geomtorsion.materials.burgers import Json
from geomtorsion.pictures.measured import draw_circuits, draw_survey
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.proofs import prove
from geomtorsion.support.files import make_folder, write_text
from geomtorsion.support.outgoing import count_text, measured_text
from geomtorsion.support.progress import bar

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def burgers_of(
    source: Source, loops: Sequence[Loop], *, raises: bool = True, proved: bool = False
) -> tuple[list[Json], list[Burgers], bool]:
    """Burgers vectors of circuits as plain data, the circuits that did not fail, and whether all
    circuits were computed.

    raises: whether the failure of a single circuit raises an error instead of being a result.
    proved: whether the integrals are proved, where the source has an interpolant.
    """
    results: list[Json] = []
    vectors: list[Burgers] = []
    if not loops:
        return results, vectors, True
    with bar(count_text(len(loops), "circuit")) as show:
        try:
            for k, loop in enumerate(loops):
                if show is not None:
                    show(k / len(loops), loop.name)
                try:
                    b = source.burgers(loop)
                    proof = {"proof": prove(b).to_json()} if proved else {}
                except GeomtorsionError as error:
                    if raises and len(loops) == 1:
                        raise
                    kind = type(error).__name__
                    results.append({"loop": loop.name, "failed": str(error), "kind": kind})
                    continue
                vectors.append(b)
                results.append(b.to_json() | proof)
        except KeyboardInterrupt:
            return results, vectors, False
    return results, vectors, True


def show_result(document: object, text: str, form: Form) -> None:
    """Print a result as JSON or in words."""
    if form is Form.json:
        typer.echo(json.dumps(document, indent=2))
    else:
        typer.echo("\n".join(wrapped(line) for line in text.splitlines()))


def write_result(
    folder: Path | None, name: str, document: object, figure: Callable[[], Figure] | None
) -> None:
    """Write a result as NAME.json and, where matplotlib is installed, its figure as NAME.png.

    figure: draws it; None for a result without figure.
    """
    if folder is None:
        return
    make_folder(folder)
    paths = [folder / f"{name}.json"]
    write_text(paths[0], json.dumps(document, indent=2) + "\n")
    if figure is not None and can_draw():
        paths.append(folder / f"{name}.png")
        save(figure(), paths[-1])
    say_on_error(paths)


def show_burgers(
    source: Source, loops: Sequence[Loop], output: Path | None, *, plain: bool, proved: bool
) -> None:
    """Compute, show and write the Burgers vectors of circuits.

    plain: JSON on standard output rather than words. proved: whether integrals are proved.
    """
    results, vectors, complete = burgers_of(source, loops, proved=proved)
    document = {"about": list(source.description), "complete": complete, "results": results}
    if plain:
        typer.echo(json.dumps(document, indent=2))
    else:
        typer.echo("\n".join(wrapped(line) for line in source.description))
        for result in results:
            explain(result)
    if output is not None:
        make_folder(output)
        target = output / "burgers.json"
        write_text(target, json.dumps(document, indent=2) + "\n")
        written = [target]
        if can_draw():
            written.append(output / "circuits.png")
            save(draw_circuits(source, vectors, refused_of(loops, results)), written[-1])
        say_on_error(written)
    if not complete:
        raise typer.Exit(ExitCode.interrupted)
    if len(vectors) < len(loops):
        raise typer.Exit(ExitCode.failed)


def refused_of(loops: Sequence[Loop], results: Sequence[Json]) -> list[Loop]:
    """The loops whose results are failures."""
    pairs = zip(loops, results, strict=False)
    return [loop for loop, result in pairs if "failed" in result]


def say_on_error(written: Sequence[Path]) -> None:
    """Report the written files, apart from the results, and missing pictures."""
    typer.echo(f"wrote {', '.join(map(str, written))}", err=True)
    if not can_draw():
        typer.echo(f"No pictures: {NO_PICTURES}", err=True)


def explain(result: Json) -> None:
    """One circuit in words."""
    typer.secho(result["loop"], bold=True)
    if "failed" in result:
        typer.secho(wrapped(f"  failed: {result['failed']}"), fg=typer.colors.RED)
        return
    unit = f" {result['vector_unit']}" if result["vector_unit"] else ""
    if "whole" in result:
        typer.echo(
            f"  b = ({_row(result['whole'])}) lattice vectors; the probability that noise "
            f"changed it is {result['chance']:.1g}"
        )
    where = " in crystal axes" if "specimen" in result else ""
    size = measured_text(result["magnitude"], result["error"], result["vector_unit"])
    b = measured_text(result["vector"], result["errors"], result["vector_unit"])
    typer.echo(wrapped(f"  b = {b}{where}, |b| = {size}"))
    if "specimen" in result:
        b = measured_text(result["specimen"], result["specimen_errors"], result["vector_unit"])
        typer.echo(f"  b = {b} in specimen axes")
    if "lattice" in result:
        b = measured_text(result["lattice"], result["lattice_errors"])
        typer.echo(f"  b = {b} lattice vectors a, b, c")
    for one in result.get("slip", ()):
        per = f"per {result['unit']}^2"
        typer.echo(
            f"  slip {one['family']}: edges {one['edge']:.4g}, screws {one['screw']:.4g} {per}"
        )
    if "grain" in result:
        typer.echo(f"  in grain {result['grain']}, {result['phase']}, {result['steps']} steps")
    if result.get("detour"):
        detour, per = result["detour"], f" {result['unit']}" if result["unit"] else ""
        around = count_text(len(detour["nodes"]), "missing node")
        typer.echo(
            wrapped(
                f"  the circuit goes around {around}, up to "
                f"{detour['distance']:.3g}{per} away; its area changes by {detour['change']:.3g}, "
                f"its error by {detour['error']:.2g}"
            )
        )
    if "whole" in result:
        typer.echo(f"  error of its length: {result['grid_error']:.2g}{unit}")
        return
    typer.echo(f"  noise {result['noise']:.2g}, error of the grid {result['grid_error']:.2g}")
    significance = result["significance"]
    much = "without noise" if significance is None else f"{significance:.3g} times its errors"
    verdict = "more than noise explains" if result["significant"] else "it may be noise"
    typer.echo(f"  significance: {much}: {verdict}")
    if "proof" in result:
        typer.echo("\n".join(wrapped(f"  {line}") for line in result["proof"]["text"].splitlines()))


def _row(numbers: Sequence[float]) -> str:
    return ", ".join(f"{x:.6g}" for x in numbers)


def write_survey(survey: Survey, document: Json, folder: Path, picture: str) -> list[Path]:
    """map.csv, map.npz, map.json and, if matplotlib is installed, a picture."""
    make_folder(folder)
    paths = [folder / f"map.{end}" for end in ("csv", "npz", "json")]
    with working("writing") as progress:
        progress("table")
        survey.write_table(paths[0])
        progress("arrays")
        survey.write_arrays(paths[1])
        write_text(paths[2], json.dumps(document, indent=2) + "\n")
        if can_draw():
            progress("picture")
            paths.append(folder / f"map.{picture}")
            save(draw_survey(survey), paths[-1])
    return paths


def survey_lines(survey: Survey, found: Json | None = None) -> list[str]:
    """A survey in words; found: its numbers, if they belong to a larger survey."""
    found = found or survey.summary()
    missing = found["circuits"] - found["known"]
    lines = [f"{count_text(found['known'], 'circuit')} of {survey.extent}"]
    if found.get("detoured"):
        lines[0] += f", {found['detoured']:,} of them around missing nodes"
    if survey.replaced:
        lines[0] += f", {survey.replaced}"
    if missing:
        lines[0] += f"; {missing:,} more {survey.missing}"
    if not found["known"]:
        return [*lines, "no circuit of this size fits: give a smaller --size"]
    unit = f" {found['density_unit']}" if found["density_unit"] else ""
    at = ", ".join(f"{n} = {x:.6g}" for n, x in zip(survey.axes, found["place"], strict=True))
    layer = f", {found['layer']}" if found["layer"] else ""
    share = found["significant"] / found["known"]
    return [
        *lines,
        (
            f"|b| per area: median {found['median']:.3g}{unit}, largest "
            f"{found['largest']:.3g}{unit} at {at}{layer}"
        ),
        f"noise floor: {found['floor']:.3g}{unit} (root mean square of noise only)",
        (
            f"{found['significant']:,} circuits ({share:.1%}) are more than "
            f"{found['level']:.2f} times their errors; noise exceeds this in 0.1 %"
        ),
    ]

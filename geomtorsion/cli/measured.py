"""measured: what the commands on measured fields share: opening, loops, and results in words."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import typer

from geomtorsion.checks import cut, shown
from geomtorsion.cli.exits import ExitCode
from geomtorsion.cli.terminal import working, wrapped
from geomtorsion.errors import GeomtorsionError, GridError, ImageError, OrientationError
from geomtorsion.files import UNSIGNED, write_text
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop
from geomtorsion.materials.measured import Closure, Measured, Survey
from geomtorsion.materials.measured.results import summary, write_arrays, write_table
from geomtorsion.materials.readers import open_source
from geomtorsion.pictures.measured import draw_circuits, draw_survey
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.progress import bar

# What stands on a command line without its dashes in messages of the library.
OPTIONS = tuple(
    "sigma threshold order laue slip size plane spots resolution blocks steps workers".split()
)
_SIZE = re.compile(rf"({UNSIGNED})\s*([^0-9.].*)?")


@dataclass(frozen=True)
class Reading:
    """Options about how a measured file is read, as they are typed."""

    sigma: str | None = None
    threshold: float | None = None
    order: int | None = None
    laue: Sequence[str] = ()
    slip: str | None = None
    pixel: str | None = None
    spots: str | None = None
    resolution: float | None = None

    @property
    def given(self) -> dict[str, object]:
        """The options that were typed, by name."""
        return {f"--{name}": value for name, value in vars(self).items() if value not in (None, ())}


def opened(source: str, reading: Reading) -> Measured:
    """The measured field in a file; errors about an option name it as it is typed."""
    value = None if reading.sigma is None else sigma_of(reading.sigma)
    try:
        return open_source(
            source,
            sigma=value,
            threshold=reading.threshold,
            order=reading.order,
            laue=_symmetries(reading.laue),
            slip=reading.slip,
            pixel=None if reading.pixel is None else _pixel(reading.pixel),
            spots=None if reading.spots is None else _spots(reading.spots),
            resolution=reading.resolution,
        )
    except (GridError, OrientationError, ImageError) as error:
        raise dashed(error) from None


def dashed(error: GeomtorsionError) -> GeomtorsionError:
    """The same error; where it begins with the name of an option, as this is typed."""
    return type(error)(f"--{error}") if str(error).startswith(OPTIONS) else error


def _pixel(text: str) -> tuple[float, str]:
    """Size and unit of a pixel."""
    found = _SIZE.fullmatch(text.strip())
    if found is None or not 0 < float(found[1]) < np.inf:
        raise ImageError(
            f"--pixel {cut(text)}: a size with its unit was needed, as in --pixel 0.03nm."
        )
    return float(found[1]), (found[2] or "").strip() or "px"


def _spots(text: str) -> list[list[float]]:
    """Two Bragg spots."""
    try:
        return [[float(x) for x in part.split(",")] for part in text.split(";")]
    except ValueError:
        raise ImageError(
            f"--spots {cut(text)}: two spots in cycles per unit were needed, as in --spots "
            "'4,0;0,4'."
        ) from None


def _symmetries(texts: Sequence[str]) -> dict[int, str]:
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


def sigma_of(text: str) -> float | str:
    """A number, or the word that asks for an estimate."""
    if text == "estimate":
        return text
    try:
        return float(text)
    except ValueError:
        raise GridError(
            f"--sigma: a number of 0 or more, or estimate, was needed, but {shown(text)} came. "
            "Write --sigma 0.001, or leave it out."
        ) from None


def identity_frame(names: Sequence[str]) -> Frame:
    """A frame whose coordinates are the axes, by which loops name their plane."""
    return Frame(" ".join(names), np.eye(len(names), dtype=int).tolist())


def closures_of(
    field: Measured, loops: Sequence[Loop], *, alone: bool = True
) -> tuple[list[dict[str, Any]], list[Closure], bool]:
    """Results of circuits as plain data, those that did not fail, and whether all were reached.

    alone: whether the failure of a single one is an error rather than a result.
    """
    results: list[dict[str, Any]] = []
    found: list[Closure] = []
    if not loops:
        return results, found, True
    with bar(f"{len(loops)} circuits") as show:
        try:
            for k, loop in enumerate(loops):
                if show is not None:
                    show(k / len(loops), loop.name)
                try:
                    closure = field.closure(loop)
                except GeomtorsionError as error:
                    if alone and len(loops) == 1:
                        raise
                    kind = type(error).__name__
                    results.append({"loop": loop.name, "failed": str(error), "kind": kind})
                    continue
                found.append(closure)
                results.append(closure.to_json())
        except KeyboardInterrupt:
            return results, found, False
    return results, found, True


def measured_burgers(field: Measured, loops: Sequence[Loop], output: Path | None, *, plain: bool
                     ) -> None:  # fmt: skip
    """Compute, show and write the Burgers vectors of circuits.

    plain: JSON on standard output rather than words.
    """
    results, found, complete = closures_of(field, loops)
    document = {"about": list(field.about), "complete": complete, "results": results}
    if plain:
        typer.echo(json.dumps(document, indent=2))
    else:
        typer.echo("\n".join(wrapped(line) for line in field.about))
        for result in results:
            explain(result)
    if output is not None:
        output.mkdir(parents=True, exist_ok=True)
        target = output / "burgers.json"
        write_text(target, json.dumps(document, indent=2) + "\n")
        written = [target]
        if can_draw():
            written.append(output / "circuits.png")
            save(draw_circuits(field, found, refused_of(loops, results)), written[-1])
        say_on_error(written)
    if not complete:
        raise typer.Exit(ExitCode.interrupted)
    if len(found) < len(loops):
        raise typer.Exit(ExitCode.failed)


def refused_of(loops: Sequence[Loop], results: Sequence[dict[str, Any]]) -> list[Loop]:
    """The loops whose results are failures."""
    pairs = zip(loops, results, strict=False)
    return [loop for loop, result in pairs if "failed" in result]


def say_on_error(written: Sequence[Path]) -> None:
    """What was written, aside from the results, and whether pictures are missing."""
    typer.echo(f"wrote {', '.join(map(str, written))}", err=True)
    if not can_draw():
        typer.echo("no pictures: matplotlib is missing: pip install 'geomtorsion[plots]'", err=True)


def explain(result: dict[str, Any]) -> None:
    """One circuit in words."""
    typer.secho(result["loop"], bold=True)
    if "failed" in result:
        typer.secho(wrapped(f"  failed: {result['failed']}"), fg=typer.colors.RED)
        return
    unit = f" {result['vector_unit']}" if result["vector_unit"] else ""
    if "whole" in result:
        typer.echo(
            f"  b = ({_row(result['whole'])}) lattice vectors; the chance that noise has changed "
            f"it is {result['chance']:.1g}"
        )
    where = " in crystal axes" if "specimen" in result else ""
    typer.echo(f"  b = ({_row(result['vector'])}){unit}{where}, |b| = {result['magnitude']:.6g}")
    if "specimen" in result:
        typer.echo(f"  b = ({_row(result['specimen'])}){unit} in specimen axes")
    if "lattice" in result:
        typer.echo(f"  b = ({_row(result['lattice'])}) lattice vectors a, b, c")
    for one in result.get("slip", ()):
        per = f"per {result['unit']}^2"
        typer.echo(
            f"  slip {one['family']}: edges {one['edge']:.4g}, screws {one['screw']:.4g} {per}"
        )
    if "grain" in result:
        typer.echo(f"  in grain {result['grain']}, {result['phase']}, {result['steps']} steps")
    if "whole" in result:
        typer.echo(f"  its length is known to {result['grid_error']:.2g}{unit}")
        return
    typer.echo(f"  noise {result['noise']:.2g}, error of the grid {result['grid_error']:.2g}")
    significance = result["significance"]
    much = "without noise" if significance is None else f"{significance:.3g} times its errors"
    verdict = "more than noise explains" if result["significant"] else "noise alone may give it"
    typer.echo(f"  significance: {much}: {verdict}")


def _row(numbers: Sequence[float]) -> str:
    return ", ".join(f"{x:.6g}" for x in numbers)


def write_survey(
    survey: Survey, document: dict[str, Any], folder: Path, picture: str
) -> list[Path]:
    """map.csv, map.npz, map.json and, where it can be drawn, a picture."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"map.{end}" for end in ("csv", "npz", "json")]
    with working("writing") as progress:
        progress("table")
        write_table(survey, paths[0])
        progress("arrays")
        write_arrays(survey, paths[1])
        write_text(paths[2], json.dumps(document, indent=2) + "\n")
        if can_draw():
            progress("picture")
            paths.append(folder / f"map.{picture}")
            save(draw_survey(survey), paths[-1])
    return paths


def survey_lines(survey: Survey, found: dict[str, Any] | None = None) -> list[str]:
    """A survey in words; found: its numbers, where they are those of a larger one."""
    found = found or summary(survey)
    sides = " x ".join(map(str, survey.size))
    missing = found["circuits"] - found["known"]
    lines = [f"{found['known']:,} circuits of {sides} cells"]
    if missing:
        lines[0] += f"; {missing:,} more {survey.missing}"
    if not found["known"]:
        return [*lines, "no circuit of this size is left: give a smaller --size"]
    unit = f" {found['density_unit']}" if found["density_unit"] else ""
    at = ", ".join(f"{n} = {x:.6g}" for n, x in zip(survey.names, found["place"], strict=True))
    layer = f", {found['layer']}" if found["layer"] else ""
    share = found["significant"] / found["known"]
    return [
        *lines,
        (
            f"|b| per area: median {found['median']:.3g}{unit}, largest "
            f"{found['largest']:.3g}{unit} at {at}{layer}"
        ),
        f"noise floor: {found['floor']:.3g}{unit} (root mean square that noise alone gives)",
        (
            f"{found['significant']:,} circuits ({share:.1%}) are more than "
            f"{found['level']:.2f} times their errors; noise alone gives that in 0.1 %"
        ),
    ]

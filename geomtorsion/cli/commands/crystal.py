"""crystal: from atoms to dislocation lines, for a person or for a pipeline."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from geomtorsion.cli.exits import resumable
from geomtorsion.cli.options import Form, Shown, argument, directory, option
from geomtorsion.cli.terminal import some_rows
from geomtorsion.conventions import burgers
from geomtorsion.errors import CheckpointError, CrystalError, GeomtorsionError, MissingExtraError
from geomtorsion.materials.crystals import LATTICES, PlaneCrystal
from geomtorsion.materials.crystals.atom_files import is_atom_array
from geomtorsion.materials.crystals.reports import Json, followed
from geomtorsion.materials.crystals.trajectories import Wanted, forget, is_begun, reports
from geomtorsion.materials.lines import DislocationNetwork
from geomtorsion.pictures.network import draw_lines
from geomtorsion.pictures.plane_crystals import draw_plane_crystal
from geomtorsion.pictures.style import SERIES, Stroke, save
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import (
    check_resumption,
    make_folder,
    plain_float,
    write_text,
    written,
)
from geomtorsion.support.outgoing import csv_cell
from geomtorsion.support.progress import bar
from geomtorsion.teaching.lab.turning import Curve, Film, turnable

if TYPE_CHECKING:
    from matplotlib.figure import Figure
FRAMES = "frames"
# Words for regions that are not a lattice.
_REGIONS = {"wall": "in walls", "none": "without a lattice"}
_EDGE = Stroke("#9aa0a8", "-", 1.0, "")


def crystal(
    file: Annotated[
        Path, argument("FILE", "Atoms: extended XYZ, LAMMPS dump or data, POSCAR, CIF ...")
    ],
    lattice: Annotated[
        str | None, option(metavar="NAME", text=f"{', '.join(LATTICES)}; default: recognised.")
    ] = None,
    orient: Annotated[
        str | None,
        option(
            metavar="X;Y;Z",
            text="Crystal directions along x, y and z: '1,-1,0;1,1,1;-1,-1,2'; default: fitted.",
        ),
    ] = None,
    constant: Annotated[
        float | None, option(metavar="A", text="Lattice constant; default: fitted.")
    ] = None,
    read_as: Annotated[
        str | None, option("--read-as", metavar="NAME", text="Format of FILE, by its name in ase.")
    ] = None,
    species: Annotated[
        str | None,
        option(
            metavar="NAME,...", text="Keep only these atoms: symbols or type numbers, such as U,Pu."
        ),
    ] = None,
    partials: Annotated[
        bool, typer.Option("--partials", help="Resolve the partial dislocations of a fault.")
    ] = False,
    convention: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="Sign convention of b: SF/RH, FS/RH, OVITO, Hirth-Lothe."
        ),
    ] = "SF/RH",
    form: Shown = Form.text,
    cell: Annotated[
        str | None,
        option(metavar="A,B,C", text="Arrays: lengths of the cell's edges, or ax,ay,az;bx,...;..."),
    ] = None,
    periodic: Annotated[
        str | None,
        option(metavar="XYZ", text="Arrays: edges along which the cell repeats: xyz, z, none."),
    ] = None,
    output: Annotated[
        Path | None,
        directory("Write crystal.json, lines for OVITO, ParaView and ParaDiS, and pictures there."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Resume the trajectory that was stopped in DIR.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Discard a trajectory that was stopped in DIR.")
    ] = False,
) -> None:
    """Find the dislocation lines of a crystal, with their Burgers vectors.

    b is given exactly, in lattice constants along the axes of the crystal, and in the coordinates
    of the file. A trajectory is analysed frame by frame in the axes of its first frame; each line
    keeps its number over time. With -o the finished frames stay in DIR if the command is stopped or
    killed, and --resume continues to the same result, bit for bit.

    FILE may be an array of positions: .npy, or .npz with the arrays positions, cell and periodic.

    \b
    Examples:
      geomtorsion crystal cu_edge.xyz -o out
      geomtorsion crystal w.dump --lattice bcc --orient '1,1,-2;-1,1,0;1,1,1' -o out
      geomtorsion crystal uo2.data.gz --species U -o out
      geomtorsion crystal run.xyz --format json | jq '.frames[].lines[].burgers_lattice'
      geomtorsion crystal atoms.npy --cell 80,80,14.4 --periodic z -o out
    """
    # Refuse an unknown sign convention before any computation.
    burgers([0], convention)
    edges, axes = _cell(cell), _periodic(periodic)
    for name, value in (("--cell", edges), ("--periodic", axes)):
        if value is not None and not is_atom_array(file):
            raise CrystalError(
                f"{name}: expected a file .npy or .npz, got {file.name}, which has its own cell. "
                "Omit the option."
            )
    names = None if species is None else tuple(map(str.strip, species.split(",")))
    settings = Wanted(
        lattice, _axes(orient), constant, read_as, partials, convention, edges, axes, names
    )
    folder = _folder(output, resume=resume, overwrite=overwrite)
    documents: list[Json] = []
    line_makers: list[Callable[[], DislocationNetwork | PlaneCrystal]] = []

    def left() -> str:
        return f"; {len(documents)} frames are in {folder}; resume with --resume" if folder else ""

    with resumable(left):
        with bar(file.name) as progress:

            def seen(done: float, total: int, what: str) -> None:
                if progress is not None:
                    number = min(int(done) + 1, total)
                    progress(
                        done / max(total, 1), f"{file.name}: frame {number} of {total}, {what}"
                    )

            for report, lines in reports(file, settings, folder, seen):
                documents.append(report)
                # Only the last frame is written as lines.
                line_makers = [lines]
        document = _shown(file, documents, form, partials)
        if output is not None:
            _save(document, line_makers[0](), output)
            if folder is not None:
                forget(folder)


def _shown(file: Path, found: list[Json], form: Form, partials: bool) -> Json:
    """Results of all frames, in words or as JSON."""
    document = {"file": file.name, "frames": followed(found)}
    typer.echo(json.dumps(document, indent=1) if form is Form.json else _text(document, partials))
    return document


def _cell(text: str | None) -> tuple[tuple[float, ...], ...] | None:
    """Edges of a cell: three lengths, or three vectors with semicolons between them."""
    if text is None:
        return None
    try:
        rows = [[plain_float(x) for x in part.split(",")] for part in text.split(";")]
    except ValueError:
        rows = []
    if len(rows) == 1 and len(rows[0]) == 3:
        rows = np.diag(rows[0]).tolist()
    if len(rows) != 3 or any(len(row) != 3 for row in rows):
        raise CrystalError(
            "--cell: expected three lengths such as 80,80,14.4 or three edges such as "
            f"80,0,0;0,80,0;0,0,14.4, got {cut(text)}. Write numbers with commas between them."
        )
    return tuple(map(tuple, rows))


def _periodic(text: str | None) -> tuple[bool, bool, bool] | None:
    """Edges along which a cell repeats, as letters."""
    if text is None:
        return None
    letters = "" if text == "none" else text
    if not set(letters) <= set("xyz") or len(set(letters)) < len(letters):
        raise CrystalError(
            "--periodic: expected letters of xyz, for the first to the third edge, or none, got "
            f"{shown(text)}. Write --periodic z where only the third edge repeats."
        )
    return "x" in letters, "y" in letters, "z" in letters


def _axes(text: str | None) -> tuple[tuple[float, ...], ...] | None:
    """The rotation whose columns are the crystal directions along x, y and z."""
    if text is None:
        return None
    message = f"--orient {cut(text)}: expected three directions such as 1,-1,0;1,1,1;-1,-1,2"
    try:
        rows = np.array([[plain_float(x) for x in part.split(",")] for part in text.split(";")])
    except ValueError:
        raise CrystalError(f"{message}, got other text. Write three numbers for each.") from None
    if rows.shape != (3, 3) or not np.isfinite(rows).all() or not rows.any(axis=1).all():
        raise CrystalError(f"{message}, got others. Write three numbers, not all 0, for each.")
    unit = rows / np.linalg.norm(rows, axis=1)[:, None]
    if np.abs(unit @ unit.T - np.eye(3)).max() > 1e-6 or np.linalg.det(unit) < 0:
        raise CrystalError(
            f"{message}, got others. Give orthogonal directions in right-handed order."
        )
    return tuple(map(tuple, unit.T.tolist()))


def _folder(output: Path | None, *, resume: bool, overwrite: bool) -> Path | None:
    """Directory of the frames; refuse to overwrite an unfinished run."""
    if output is None:
        if resume or overwrite:
            raise CheckpointError(
                "--resume, --overwrite: expected a directory, got none. Name it with -o."
            )
        return None
    folder = output / FRAMES
    begun = is_begun(folder)
    check_resumption(folder, "trajectory", begun=begun, resume=resume, overwrite=overwrite)
    if begun and overwrite:
        forget(folder)
    return folder


def _plane_text(document: Json) -> str:
    """The frames of atoms in a plane in words and columns."""
    rows = [typer.style(document["file"], bold=True)]
    for frame in document["frames"]:
        name = f"  frame {frame['frame']}: " if len(document["frames"]) > 1 else "  "
        grains, points = frame["grains"], frame["points"]
        rows.append(
            f"{name}{frame['atoms']:,} atoms in a plane: {frame['lattice']}, a = "
            f"{frame['constant']:.6g}, {len(grains)} grain{'s' * (len(grains) != 1)}, "
            f"{len(points)} dislocation{'s' * (len(points) != 1)}"
        )
        table = [["grain", "lattice", "a", "angle", "atoms"]]
        table += [
            [
                str(one["number"]), one["lattice"], f"{one['constant']:.6g}",
                f"{one['angle']:.2f}", f"{one['atoms']:,}",
            ]
            for one in (grains[k] for k in some_rows(len(grains)))
        ]  # fmt: skip
        rows += _table(table) if len(grains) > 1 else []
        table = [["grain", f"b ({frame['convention']})", "b", "position"]]
        table += [
            [
                str(one["grain"]), f"[{' '.join(one['burgers_lattice'])}]",
                f"({_row(one['burgers'])})", f"({_row(one['position'])})",
            ]
            for one in (points[k] for k in some_rows(len(points)))
        ]  # fmt: skip
        rows += _table(table) if points else []
    return "\n".join(rows)


def _text(document: Json, partials: bool) -> str:
    """The frames in words and columns."""
    frames = document["frames"]
    first = frames[0]
    if "points" in first:
        return _plane_text(document)
    axes = ", ".join(
        f"{name} along [{_row(column)}]"
        for name, column in zip("xyz", np.array(first["orient"]).T, strict=True)
    )
    rows = [
        typer.style(document["file"], bold=True),
        (
            f"  {first['atoms']:,} atoms: {first['lattice']}, a = {first['constant']:.6g}; "
            f"{first['share']:.1%} have the neighbours of the lattice"
        ),
        f"  {axes}",
    ]
    several = len(frames) > 1
    if several:
        rows.append(f"  {len(frames)} frames, in the axes of the first")
    for frame in frames:
        rows += _overlapping(frame, several)
    in_grains = any(len(frame.get("grains", ())) > 1 for frame in frames)
    rows += _grain_rows(frames[-1], several)
    for frame in (frame for frame in frames if frame.get("vanished")):
        gone = frame["vanished"]
        names = f"grain{'s' * (len(gone) > 1)} {', '.join(map(str, gone))}"
        rows.append(f"  {names} vanished in frame {frame['frame']}")
    table = [
        _columns(line, frame, several, in_grains) for frame in frames for line in frame["lines"]
    ]
    # A partial whose fault reaches a surface is omitted without the option.
    faults = not partials and any(frame["lattice"] != "bcc" for frame in frames)
    hint = "; --partials also finds partial dislocations at the edges of faults" if faults else ""
    if not table:
        return "\n".join([*rows, "", f"  no dislocation line{hint}"])
    heads = ["line", f"b / a ({first['convention']})", "b", "family", "length", "ends"]
    if in_grains:
        heads.insert(1, "grain")
    if several:
        heads.insert(0, "frame")
    shown = [heads, *(table[k] for k in some_rows(len(table)))]
    rows += ["", *_table(shown)]
    if len(shown) <= len(table):
        rows.append(f"  {len(shown) - 1} of {len(table):,} rows; -o DIR writes all of them")
    if not several:
        rows += ["", f"  total length {first['length']:.6g}, {first['junctions']} junctions"]
        rows += [_loop(line) for line in first["lines"] if "inserted" in line]
    return "\n".join(rows)


def _overlapping(frame: Json, several: bool) -> list[str]:
    """Atoms at one position, which are reported and do not end the run."""
    pairs = frame.get("overlapping", [])
    if not pairs:
        return []
    some = ", ".join(f"{one} and {other}" for one, other in pairs[:3])
    of_frame = f" of frame {frame['frame']}" if several else ""
    more = " ..." if len(pairs) > 3 else ""
    return [
        f"  {len(pairs):,} pair{'s' * (len(pairs) != 1)} of atoms{of_frame} overlap: {some}{more}"
    ]


def _grain_rows(frame: Json, several: bool) -> list[str]:
    """Grains, walls and phases of a polycrystal; none of a single crystal."""
    shares, grains = frame.get("shares", {}), frame.get("grains", [])
    if len(grains) < 2 and len(shares) < 2:
        return []
    parts = ", ".join(f"{_REGIONS.get(name, name)} {part:.1%}" for name, part in shares.items())
    of_frame = f" of frame {frame['frame']}" if several else ""
    rows = ["", f"  {len(grains)} grain{'s' * (len(grains) != 1)}{of_frame}: {parts} of the atoms"]
    table = [["grain", "lattice", "a", "atoms", "centre"]]
    table += [
        [
            str(one["number"]), one["lattice"], f"{one['constant']:.6g}", f"{one['atoms']:,}",
            f"({_row(one['centre'])})",
        ]
        for one in (grains[k] for k in some_rows(len(grains)))
    ]  # fmt: skip
    rows += _table(table)
    walls = frame["walls"]
    if walls:
        table = [["wall", "misorientation", "about", "atoms"]]
        table += [
            [
                " | ".join(map(str, one["grains"])),
                "other lattice" if one["degrees"] is None else f"{one['degrees']:.2f} degrees",
                "" if one["axis"] is None else f"[{_row(one['axis'])}]",
                f"{one['atoms']:,}",
            ]
            for one in (walls[k] for k in some_rows(len(walls)))
        ]
        rows += ["", *_table(table)]
    if len(table) <= len(walls) or len(grains) > len(some_rows(len(grains))):
        rows.append(f"  {len(walls)} walls of {len(grains)} grains; -o DIR writes all")
    return rows


def _table(rows: list[list[str]]) -> list[str]:
    """Rows in columns."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return [
        "  " + "  ".join(word.ljust(w) for word, w in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def _columns(line: Json, frame: Json, several: bool, in_grains: bool) -> list[str]:
    """One line as a row of the table."""
    row = [
        str(line["track"]),
        *([str(line.get("grain", 0))] if in_grains else []),
        f"({', '.join(line['burgers_lattice'])})",
        f"({_row(line['burgers'])})",
        line["family"],
        f"{line['length']:.6g}",
        line["kind"],
    ]
    return [str(frame["frame"]), *row] if several else row


def _row(values: Any) -> str:
    """Numbers with four digits of a thousandth; minus zero is zero."""
    return ", ".join(f"{round(float(x), 4) + 0.0:g}" for x in values)


def _loop(line: Json) -> str:
    """What a closed line encloses."""
    count = line["inserted"]
    what = "interstitials" if count > 0 else "vacancies"
    # Results of older versions have no error.
    error = line.get("inserted_error", 0.0)
    if error:
        what = (
            f"+- {error:.2g} {what}: at a surface, next to other lines, or in strong noise the "
            "number is only an estimate"
        )
    return f"  line {line['track']} encloses b . A = {abs(count):.4g} {what}"


def _save(document: Json, net: DislocationNetwork | PlaneCrystal, folder: Path) -> None:
    """JSON of all frames, tracks of several, and the last one as lines and pictures."""
    make_folder(folder)
    frames, name = document["frames"], document["file"]
    paths = [folder / "crystal.json", folder / "crystal.html"]
    write_text(paths[0], json.dumps(document, indent=1) + "\n")
    left_out: list[str] = []
    if isinstance(net, PlaneCrystal):
        drawn = _picture(lambda: draw_plane_crystal(net), folder, left_out)
        return _report([paths[0], *drawn], left_out)
    title = name if len(frames) == 1 else f"{name}, frame {frames[-1]['frame']}"
    write_text(paths[1], _page(frames[-1], title))
    if len(frames) > 1:
        paths.append(folder / "tracks.csv")
        _write_tracks(frames, paths[-1])
    if net.lines:
        for end in (".vtk", ".data", ".ca"):
            try:
                net.save(folder / f"lines{end}")
                paths.append(folder / f"lines{end}")
            except GeomtorsionError as error:
                left_out.append(f"no lines{end}: {error}")
        paths += _picture(lambda: draw_lines(net), folder, left_out)
    _report(paths, left_out)


def _picture(draw: Callable[[], Figure], folder: Path, left_out: list[str]) -> list[Path]:
    """The picture of a crystal; without matplotlib, the reason is added to left_out."""
    try:
        save(draw(), folder / "crystal.png")
        return [folder / "crystal.png"]
    except MissingExtraError as error:
        left_out.append(f"no picture: {error}")
        return []


def _report(paths: list[Path], left_out: list[str]) -> None:
    """Which files are written, and which are not."""
    for text in [*left_out, f"wrote {', '.join(map(str, paths))}"]:
        typer.echo(text, err=True)


def _page(report: Json, title: str) -> str:
    """The lines of a report in their cell, coloured by family, as an HTML document.

    Each line is drawn from its first point on, out of the cell where it leads there.
    """
    curves = [Curve(side, _EDGE, thin=True) for side in _sides(report)]
    families = sorted({line["family"] for line in report["lines"]})
    labelled: set[str] = set()
    for line in report["lines"]:
        stroke = SERIES[families.index(line["family"]) % len(SERIES)]
        label = "" if line["family"] in labelled else f"b = {line['family']}"
        labelled.add(line["family"])
        tip = f"({', '.join(line['burgers_lattice'])})"
        curves.append(Curve(line["path"], stroke, label, tip))
    count = len(report["lines"])
    note = f"{count} line{'s' * (count != 1)}; point at a line to see its b in lattice constants."
    return turnable(Film("crystal", title, ("x", "y", "z"), tuple(curves), equal=True, note=note))


def _sides(report: Json) -> list[list[list[float]]]:
    """The edges of the cell, or of the box about all lines where nothing is periodic."""
    corners = np.array(list(product((0.0, 1.0), repeat=3)))
    if report["cell"] is not None:
        places = corners @ np.array(report["cell"])
    else:
        points = np.array([x for line in report["lines"] for x in line["path"]] or [[0, 0, 0]])
        low, high = points.min(axis=0), points.max(axis=0)
        places = low + corners * (high - low)
    return [
        [places[a].tolist(), places[b].tolist()]
        for a in range(8)
        for b in range(a)
        if (corners[a] != corners[b]).sum() == 1
    ]


def _write_tracks(frames: list[Json], path: Path) -> None:
    """One row for each line of each frame."""
    with written(path) as part, part.open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream)
        table.writerow(["frame", "track", "b1", "b2", "b3", "family", "length", "kind"])
        for frame in frames:
            for line in frame["lines"]:
                table.writerow(
                    [
                        frame["frame"], line["track"], *line["burgers_lattice"],
                        csv_cell(line["family"]), repr(line["length"]), csv_cell(line["kind"]),
                    ]
                )  # fmt: skip

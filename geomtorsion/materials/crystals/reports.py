"""Reports: properties of a crystal as plain data, frame by frame, and lines followed in time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.conventions import burgers
from geomtorsion.materials.crystals.crystal import Crystal
from geomtorsion.materials.crystals.frames import Frame
from geomtorsion.materials.crystals.grains import Grain, Wall
from geomtorsion.materials.crystals.known_grains import KnownGrains
from geomtorsion.materials.crystals.lattices import lattice_named
from geomtorsion.materials.crystals.plane_crystal import PlaneCrystal
from geomtorsion.materials.lines import DislocationNetwork
from geomtorsion.materials.lines.line_arrays import DislocationLine

# A frame, or a line in it, as JSON.
Json = dict[str, Any]


def crystal_report(crystal: Crystal, net: DislocationNetwork, convention: str = "SF/RH") -> Json:
    """A crystal and its dislocation lines as plain data; every number to the last digit.

    Parameters
    ----------
    convention
        Convention for the sign of b; see `conventions.burgers`.

    Returns
    -------
    atoms, lattice, constant, orient, deformation, share, cell, periodic: of the crystal; of a
    hexagonal one also ratio, its c/a; overlapping: pairs of atoms at nearly one position, if any.
    length, junctions, nye: of all lines. lines: for each line, burgers (coordinates of the file,
    deformed as the crystal is), burgers_lattice (crystal axes, fractions as text, in lattice
    constants), family, length, kind, path, and for closed lines `inserted`, the number of atoms
    of their half plane, which is negative for vacancies.

    A crystal that has, or had in a frame before, several grains or phases has more. shares: of the
    atoms in each lattice, in walls and in no lattice. grains: for each number, lattice, constant,
    orient, deformation, atoms (how many) and centre. walls: for each, the two grains, degrees and
    axis of the misorientation, and atoms (how many). vanished: grains of the frame before that no
    longer exist; numbers: number of grain labels used so far. Lines have their grain.

    Raises
    ------
    UnknownNameError
        No convention has this name.
    """
    cell = crystal.cell
    return {
        "atoms": crystal.count,
        "lattice": crystal.lattice,
        "constant": crystal.constant,
        **_ratio(crystal.frame),
        "orient": crystal.orient.tolist(),
        "deformation": crystal.deformation.tolist(),
        "share": crystal.share,
        **({"overlapping": pairs.tolist()} if len(pairs := crystal.overlapping) else {}),
        **_polycrystal(crystal),
        "cell": None if cell is None else cell.tolist(),
        "periodic": crystal.periodic.tolist(),
        "convention": convention,
        "length": float(sum(line.length for line in net.lines)),
        "junctions": len(net.junctions),
        "nye": _signed(net.nye, convention).tolist(),
        "lines": [_line(crystal, line, convention) for line in net.lines],
    }


def plane_report(crystal: PlaneCrystal, convention: str = "SF/RH") -> Json:
    """A crystal in a plane and its dislocations as plain data.

    Returns
    -------
    atoms, lattice, constant, cell, periodic. grains: for each its number, lattice, constant, angle
    of the first lattice vector to x in degrees, and atoms (how many). points: for each dislocation
    its position, burgers (coordinates), burgers_lattice (fractions as text) and grain.
    """
    cell = crystal.cell
    return {
        "atoms": crystal.count,
        "lattice": crystal.lattice,
        "constant": crystal.constant,
        "cell": None if cell is None else cell.tolist(),
        "periodic": list(crystal.periodic),
        "convention": convention,
        "grains": [
            {
                "number": one.number, "lattice": one.lattice, "constant": one.constant,
                "angle": one.angle, "atoms": len(one.atoms),
            }
            for one in crystal.grains
        ],
        "points": [
            {
                "position": list(one.position),
                "burgers": _signed(one.burgers, convention).tolist(),
                "burgers_lattice": [
                    str(x if burgers([1], convention)[0] > 0 else -x) for x in one.burgers_lattice
                ],
                "grain": one.grain,
            }
            for one in crystal.dislocations()
        ],
    }  # fmt: skip


def _ratio(frame: Frame) -> Json:
    """c/a of a hexagonal lattice."""
    return {"ratio": frame.lattice.ratio} if frame.lattice.is_hexagonal else {}


def _polycrystal(crystal: Crystal) -> Json:
    """Grains and walls of a crystal that is more than one single crystal."""
    if _is_single(crystal):
        return {}
    grains = crystal.grains
    return {
        "shares": grains.shares,
        "grains": [_grain(grain) for grain in grains],
        "walls": [_wall(wall) for wall in grains.walls],
        "vanished": list(grains.vanished),
        "numbers": grains.used,
    }


def _is_single(crystal: Crystal) -> bool:
    """Whether it is a single crystal, and was one in all frames before."""
    return crystal.grains.is_single and crystal.grains.used == 1


def known_of(report: Json, owner: np.ndarray) -> KnownGrains:
    """The grains of a report, for the next frame; owner: the grain of each atom."""
    rows = report.get("grains", [{"number": 0, **report}])
    frames = {
        row["number"]: Frame(
            lattice_named(row["lattice"], row.get("ratio")), np.array(row["orient"]),
            row["constant"],
        )
        for row in rows
    }  # fmt: skip
    return KnownGrains(frames, owner, report.get("numbers", 1))


def _grain(grain: Grain) -> Json:
    """A grain as plain data."""
    return {
        "number": grain.number,
        "lattice": grain.lattice,
        "constant": grain.constant,
        **_ratio(grain.frame),
        "orient": grain.orient.tolist(),
        "deformation": grain.deformation.tolist(),
        "atoms": len(grain.atoms),
        "centre": grain.centre.tolist(),
    }


def _wall(wall: Wall) -> Json:
    """A wall between grains as plain data."""
    return {
        "grains": list(wall.grains),
        "degrees": wall.degrees,
        "axis": None if wall.axis is None else list(wall.axis),
        "atoms": len(wall.atoms),
    }


def _signed(values: object, convention: str) -> np.ndarray:
    """Burgers vectors in a convention; minus zero is zero."""
    return burgers(np.asarray(values, dtype=float), convention) + 0.0


def _line(crystal: Crystal, line: DislocationLine, convention: str) -> Json:
    """One line as plain data."""
    exact = burgers(list(line.burgers_lattice or ()), convention)
    grain = line.grain
    if grain is None and not _is_single(crystal) and crystal.grains.used > 1:
        grain = crystal.grains.grains[0].number
    data: Json = {
        **({} if grain is None else {"grain": grain}),
        "burgers": _signed(line.burgers, convention).tolist(),
        "burgers_lattice": [str(x) for x in exact],
        "family": line.family,
        "length": line.length,
        "kind": line.kind,
        "path": line.path.tolist(),
    }
    if line.is_closed:
        data["inserted"] = inserted_atoms(line, crystal)
        data["inserted_error"] = inserted_error(line, crystal)
    return data


def inserted_atoms(line: DislocationLine, crystal: Crystal) -> float:
    """Number of atoms that a closed line has between its half planes; negative for vacancies.

    Equation
    --------
    n = b . A / (volume of an atom), A = closed integral of r x dr / 2 along the line; b as in
    conventions.py, which is minus the integral of du, the opening of a cut.

    It is exact where atoms and sites could be counted: where good crystal surrounds the line,
    which is then drawn from that count. `inserted_error` reports whether this is so.
    """
    frame = _frame_of(line, crystal)
    b = np.array([float(x) for x in line.burgers])
    return float(b @ line.area / frame.atom_volume)


def inserted_error(line: DislocationLine, crystal: Crystal) -> float:
    """Largest error of `inserted_atoms`: 0.0 where atoms and sites were counted.

    Elsewhere, at a surface, next to another line, or in much noise, it comes from the line, which
    is drawn where bonds turn from one label to the next, within half a neighbour distance d:
    |b| (length of the line) d / 2 over the volume of an atom.
    """
    excess, frame = inserted_atoms(line, crystal), _frame_of(line, crystal)
    # A line drawn from a count encloses a whole number of atoms, but for rounding.
    if abs(excess - round(excess)) < 1e-9 * max(abs(excess), 1.0):
        return 0.0
    b = np.linalg.norm([float(x) for x in line.burgers])
    nearest = frame.lattice.nearest * frame.constant
    return float(b * line.length * nearest / 2 / frame.atom_volume)


def _frame_of(line: DislocationLine, crystal: Crystal) -> Frame:
    """The frame of the grain that contains a line."""
    if line.grain is not None:
        return crystal.grains[line.grain].frame
    return crystal.frame


def tracks(frames: Sequence[Json]) -> list[list[int]]:
    """Numbers of the lines of each frame, so that one line keeps its number in time.

    Lines of two frames that follow each other are one line if they are in one grain, have the same
    exact b (or opposite b and sense), and are nearest to each other: lines are paired so that the
    sum of mean distances is least. A line without a partner ends or begins.

    Parameters
    ----------
    frames
        Reports of a trajectory, in order.
    """
    numbers: list[list[int]] = []
    count = 0
    for number, frame in enumerate(frames):
        lines = frame["lines"]
        mine = [-1] * len(lines)
        if number:
            before = frames[number - 1]["lines"]
            for group in {_direction(line) for line in lines}:
                here = [k for k, line in enumerate(lines) if _direction(line) == group]
                there = [k for k, line in enumerate(before) if _direction(line) == group]
                costs = np.array(
                    [[_apart(lines[a], before[b], frame) for b in there] for a in here]
                ).reshape(len(here), len(there))
                for a, b in zip(*scipy.optimize.linear_sum_assignment(costs), strict=True):
                    mine[here[a]] = numbers[-1][there[b]]
        for k, track in enumerate(mine):
            if track < 0:
                mine[k] = count
                count += 1
        numbers.append(mine)
    return numbers


def followed(frames: Sequence[Json]) -> list[Json]:
    """The same reports with a number `track` for each line, which it keeps in time, and its sense.

    A line that is found with the opposite sense, and so with -b, is reversed: b of a track is
    one vector.
    """
    if any("points" in frame for frame in frames):
        return list(frames)
    senses: dict[int, list[str]] = {}
    reports = []
    for frame, numbers in zip(frames, tracks(frames), strict=True):
        lines = []
        for line, number in zip(frame["lines"], numbers, strict=True):
            sense = senses.setdefault(number, line["burgers_lattice"])
            same = line if sense == line["burgers_lattice"] else _turned(line)
            lines.append({"track": number, **same})
        reports.append({**frame, "lines": lines})
    return reports


def _turned(line: Json) -> Json:
    """A line described in the opposite sense."""
    return {
        **line,
        "burgers": [-x + 0.0 for x in line["burgers"]],
        "burgers_lattice": _opposite(line["burgers_lattice"]),
        "path": line["path"][::-1],
    }


def _opposite(exact: Sequence[str]) -> list[str]:
    """Fractions as text, with the other sign."""
    return [x[1:] if x.startswith("-") else x if x == "0" else f"-{x}" for x in exact]


def _direction(line: Json) -> tuple[int, tuple[str, ...]]:
    """The grain, and b without its sign, which changes with the sense of the line."""
    exact = line["burgers_lattice"]
    return line.get("grain", 0), max(tuple(exact), tuple(_opposite(exact)))


def _apart(one: Json, two: Json, frame: Json) -> float:
    """Mean distance between the points of two lines, by nearest images."""
    first, second = np.array(one["path"]), np.array(two["path"])
    gaps = first[:, None] - second[None]
    if frame["cell"] is not None:
        cell = np.array(frame["cell"])
        shares = gaps @ np.linalg.inv(cell)
        gaps = gaps - np.where(frame["periodic"], np.rint(shares), 0.0) @ cell
    sizes = np.linalg.norm(gaps, axis=2)
    return float(sizes.min(axis=0).mean() + sizes.min(axis=1).mean()) / 2

"""XYZ: frames of plain and extended XYZ files, species by symbol or by number."""

from __future__ import annotations

import re
from collections.abc import Iterator
from io import TextIOBase

import numpy as np

from geomtorsion.errors import FileFormatError
from geomtorsion.materials.crystals.atom_rows import AtomData, completed
from geomtorsion.support.checks import shown
from geomtorsion.support.text_rows import number_table

# key=value, where a value may be in quotes, in braces, or be a list.
_FIELD = re.compile(r"""(\w+)\s*=\s*(?:"([^"]*)"|'([^']*)'|\{([^}]*)\}|(\[[^="']*\])|(\S+))""")
_SPECIES = ("species", "element", "symbol", "type", "z")
_TRUE, _FALSE = ("t", "true", "1"), ("f", "false", "0")


def xyz_blocks(name: str, stream: TextIOBase) -> Iterator[tuple[int, list[str]]]:
    """Frames of an XYZ file as rows, with the numbers of their first lines.

    The row after a frame is read before the frame is given: one atom too many is not a new frame.
    """
    line, head = _next_head(name, stream, 0)
    while head:
        rows = [head]
        for _ in range(int(head) + 1):
            row = stream.readline()
            if row == "":
                raise FileFormatError(
                    f"{name}: line {line + len(rows) - 1}: the file ends after "
                    f"{max(len(rows) - 2, 0):,} of {int(head):,} atoms. Is it complete?"
                )
            rows.append(row)
        first = line
        line, head = _next_head(name, stream, line + len(rows) - 1)
        yield first, rows


def _next_head(name: str, stream: TextIOBase, line: int) -> tuple[int, str]:
    """The row with the number of atoms of the next frame, and its number; empty at the end."""
    while (head := stream.readline()) != "":
        line += 1
        if not head.strip():
            continue
        if not head.strip().isdecimal() or len(head) > 20:
            raise FileFormatError(
                f"{name}: line {line}: expected the number of atoms of a frame, got "
                f"{shown(head.strip())}. Correct the number of the frame before, or name the "
                "format of the file: form=... (--read-as)."
            )
        return line, head
    return line, ""


def xyz_frame(name: str, line: int, rows: list[str], where: str) -> AtomData:
    """The atoms of a frame from its rows; line: the number of the first row in the file.

    Without `Properties` columns are species, x, y, z and any others. Without `Lattice` nothing
    repeats; with one all edges do, unless `pbc` differs.
    """
    fields = {field[1].lower(): field for field in _FIELD.finditer(rows[1])}
    values = {key: next(x for x in f.groups()[1:] if x is not None) for key, f in fields.items()}
    width = len(rows[2].split()) if len(rows) > 2 else 0
    place, kind, wide = _columns(f"{name}: line {line + 1}", values.get("properties"), rows, width)
    lines = range(line + 2, line + len(rows))
    kinds = () if kind is None else (kind,)
    axes = range(place, place + 3)
    positions, species = number_table(name, lines, rows[2:], wide, axes, kinds)
    edges = np.zeros((3, 3))
    if "lattice" in values:
        texts = re.split(r"[\s,\[\]]+", values["lattice"].strip(" []"))
        if len(texts) != 9:
            raise FileFormatError(
                f"{name}: line {line + 1}: Lattice: expected nine numbers, three edges of the "
                f"cell one after another, got {shown(values['lattice'])}. Correct it."
            )
        edges = number_table(name, [line + 1], [" ".join(texts)], 9, range(9))[0].reshape(3, 3)
    periodic = _periodic(f"{name}: line {line + 1}", values.get("pbc"), "lattice" in values)
    for k, repeats in enumerate(periodic):
        if repeats and not edges[k].any():
            raise FileFormatError(
                f"{where}: expected edge {k + 1} of the cell, along which the atoms are periodic, "
                "got none. Give it (Lattice in extended XYZ), or write pbc F for this edge."
            )
    names = tuple(species[0]) if species else None
    return AtomData(positions, completed(where, edges), periodic, names, where)


def _columns(
    where: str, said: str | None, rows: list[str], width: int
) -> tuple[int, int | None, int]:
    """The first column of positions, the column of species, and how many columns there are."""
    if said is None:
        if width < 4:
            raise FileFormatError(
                f"{where}: expected rows of a species and x, y, z, got rows of {width} columns. "
                "Name the columns: Properties=species:S:1:pos:R:3."
            )
        return 1, 0, width
    parts = said.split(":")
    names, counts = [x.lower() for x in parts[::3]], parts[2::3]
    if len(parts) % 3 or not all(x.isdecimal() and len(x) <= 18 for x in counts):
        raise FileFormatError(
            f"{where}: Properties: expected name:kind:columns, one after another, got "
            f"{shown(said)}. Write, for example, species:S:1:pos:R:3."
        )
    sizes = [int(x) for x in counts]
    most = max((len(row.split()) for row in rows[2:]), default=0)
    if sum(sizes) > most:
        raise FileFormatError(
            f"{where}: Properties: expected at most {most:,} columns, as many as the rows have, "
            f"got {sum(sizes):,}. Correct the line, or export the file again."
        )
    first = dict(zip(reversed(names), np.cumsum([0, *sizes])[-2::-1].tolist(), strict=True))
    if "pos" not in first or sizes[names.index("pos")] != 3:
        raise FileFormatError(
            f"{where}: Properties: expected pos:R:3 among the columns, got {shown(said)}. Export "
            "the positions with the file."
        )
    kind = next((first[x] for x in _SPECIES if x in first), None)
    return first["pos"], kind, sum(sizes)


def _periodic(where: str, said: str | None, default: bool) -> tuple[bool, bool, bool]:
    """Along which edges the cell repeats."""
    if said is None:
        return default, default, default
    flags = re.split(r"[\s,]+", said.strip(" []").lower())
    if len(flags) != 3 or not all(x in (*_TRUE, *_FALSE) for x in flags):
        raise FileFormatError(
            f'{where}: pbc: expected T or F for each of three edges, such as "T T F", got '
            f"{shown(said)}. Correct it."
        )
    return flags[0] in _TRUE, flags[1] in _TRUE, flags[2] in _TRUE

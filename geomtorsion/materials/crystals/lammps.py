"""LAMMPS: frames of its text dumps, and its data files, of every atom style with known columns."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import TextIOBase
from itertools import islice

import numpy as np

from geomtorsion.errors import FileFormatError
from geomtorsion.materials.crystals.atom_rows import (
    AtomData,
    completed,
    is_number,
)
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import finite_number
from geomtorsion.support.text_rows import TextRows, number_table, refuse_row

# Key of a row above the sections of a data file -> number of the row, and its other words.
Said = dict[str, tuple[int, list[str]]]
# Columns of a dump that hold positions, the best first, and whether they are shares of the cell.
_PLACES = (("x y z", False), ("xu yu zu", False), ("xs ys zs", True), ("xsu ysu zsu", True))
# Columns of a dump that name a species, the best first.
_KINDS = ("element", "typelabel", "type")
# Atom style -> columns of the type and of x in a row of a data file, from 0, and how many columns
# there are without image flags, as LAMMPS lists them at its command read_data.
_STYLES = {
    "atomic": (1, 2, 5), "charge": (1, 3, 6), "molecular": (2, 3, 6), "bond": (2, 3, 6),
    "angle": (2, 3, 6), "full": (2, 4, 7), "sphere": (1, 4, 7), "dipole": (1, 3, 9),
    "ellipsoid": (1, 4, 7), "line": (2, 5, 8), "tri": (2, 5, 8), "body": (1, 4, 7),
    "electron": (1, 5, 8), "sph": (1, 5, 8), "meso": (1, 5, 8), "spin": (1, 2, 9),
    "peri": (1, 4, 7), "dpd": (1, 3, 6), "edpd": (1, 4, 7), "hybrid": (1, 2, 5),
}  # fmt: skip
# Styles that are tried where a file names none, in this order.
_LIKELY = ("atomic", "charge", "molecular", "full")
# Ends of the rows above the sections.
_KEYS = (
    "atoms", "atom types", "xlo xhi", "ylo yhi", "zlo zhi", "xy xz yz", "avec", "bvec", "cvec",
)  # fmt: skip
_ATOMS = re.compile(r"(?m)^[ \t]*[0-9]+[ \t]+atoms\b")
_SIDES = re.compile(r"(?m)^[^#\n]*\b(?:xlo[ \t]+xhi|avec)\b")


def seems_dump(text: str) -> bool:
    """Whether a file begins like a text dump."""
    rows = (row for row in text.splitlines() if row.strip() and not row.startswith("#"))
    return next(rows, "").lstrip().startswith("ITEM: ")


def seems_data(text: str) -> bool:
    """Whether a file begins like a data file."""
    return bool(_ATOMS.search(text) and _SIDES.search(text))


# -- dump -----------------------------------------------------------------------------------------


def dump_blocks(name: str, stream: TextIOBase) -> Iterator[tuple[int, list[str]]]:
    """Frames of a dump as rows, with the numbers of their first lines.

    UNITS and TIME may precede each frame. The row after a frame is read before the frame is given:
    one atom too many is not a new frame.
    """
    line, head = _next_item(name, stream, 1, "")
    while head:
        rows = [head]
        while not rows[-1].startswith("ITEM: ATOMS") and (row := stream.readline()):
            rows.append(row)
        count, stated = _declared(name, line, rows)
        rows += (body := _body(name, line + len(rows) - 1, count, stream))
        comment = next((k for k, row in enumerate(body) if row.lstrip().startswith("#")), None)
        if comment is not None:
            raise FileFormatError(
                f"{name}: line {line + len(rows) - len(body) + comment}: expected an atom, got the "
                f"comment {shown(body[comment].strip())}. A dump has no comments: remove the line."
            )
        before = f" after the {count:,} atoms that line {line + stated} declares"
        after = _next_item(name, stream, line + len(rows), before)
        yield line, rows
        line, head = after


def _next_item(name: str, stream: TextIOBase, line: int, before: str) -> tuple[int, str]:
    """The number of the first row of the next frame, and this row; empty at the end."""
    while (row := stream.readline()) and not row.strip():
        line += 1
    if row and not row.startswith("ITEM: "):
        if row.startswith("#"):
            raise FileFormatError(
                f"{name}: line {line}: expected ITEM: TIMESTEP, got the comment "
                f"{shown(row.strip())}. A dump has no comments: remove the line."
            )
        remedy = "Correct it" if before else "Name the format of the file: form=... (--read-as)"
        raise FileFormatError(
            f"{name}: line {line}: expected ITEM: TIMESTEP{before}, got {shown(row.strip())}. "
            f"{remedy}."
        )
    return line, row


def _body(name: str, line: int, count: int, stream: TextIOBase) -> list[str]:
    """The rows of the atoms of a frame; line: the number of the row before them."""
    body = list(islice(stream, count))
    end = next((k for k, row in enumerate(body) if row.startswith("ITEM: ")), len(body))
    while end and not body[end - 1].strip():
        end -= 1
    if end < count:
        raise FileFormatError(
            f"{name}: line {line + end}: the frame ends after {end:,} of {count:,} atoms. Is the "
            "file complete?"
        )
    return body


def _marks(rows: Sequence[str]) -> dict[str, int]:
    """First word of each item -> the number of its row."""
    return {
        row.split()[1]: k
        for k, row in enumerate(rows)
        if row.startswith("ITEM: ") and len(row.split()) > 1
    }


def _declared(name: str, first: int, rows: list[str]) -> tuple[int, int]:
    """The number of atoms that the header of a frame states, and the row that states it.

    first: number of the first row of the header in the file.
    """
    marks = _marks(rows)
    for key in ("TIMESTEP", "NUMBER", "BOX", "ATOMS"):
        if key not in marks:
            raise FileFormatError(
                f"{name}: line {first}: expected ITEM: {key} ... in this frame, got "
                f"{', '.join(marks)}. Is the file complete, and a dump of atoms (dump custom)?"
            )
    row = marks["NUMBER"] + 1
    number = rows[row].strip() if row < len(rows) else ""
    if not number.isdecimal() or len(number) > 18:
        raise FileFormatError(
            f"{name}: line {first + row}: expected the number of atoms, got {shown(number)}. Is "
            "the file complete?"
        )
    return int(number), row


def dump_frame(name: str, line: int, rows: list[str], where: str) -> AtomData:
    """The atoms of a frame in the order of their ids; line: number of its first row in the file.

    A box without flags of its sides repeats along each edge, the default of LAMMPS. Species
    come from the column element, or from type.
    """
    marks = _marks(rows)
    start = marks["ATOMS"]
    columns = rows[start].split()[2:]
    lines = range(line + start + 1, line + len(rows))
    origin, edges, periodic = _box(name, line + marks["BOX"], rows[marks["BOX"] : start])
    axes, scaled = _position_columns(name, line + start, columns)
    kind = next((columns.index(x) for x in _KINDS if x in columns), None)
    numeric = [*axes.split(), *(["id"] if "id" in columns else [])]
    indices = [columns.index(x) for x in numeric]
    body = rows[start + 1 :]
    kinds = () if kind is None else (kind,)
    table, words = number_table(name, lines, body, len(columns), indices, kinds)
    odd = _odd_type(words[0]) if words and body else None
    if odd is not None:
        refuse_row(name, lines[odd], body[odd], len(columns), kinds)
    values = table[:, :3]
    positions = origin + values @ edges if scaled else values
    order = np.argsort(table[:, 3], kind="stable") if "id" in columns else np.arange(len(body))
    species = tuple(words[0][k] for k in order.tolist()) if words else None
    return AtomData(positions[order], completed(where, edges), periodic, species, where)


def _position_columns(name: str, line: int, columns: Sequence[str]) -> tuple[str, bool]:
    """The best columns of positions, and whether they are shares of the cell."""
    for axes, scaled in _PLACES:
        if set(axes.split()) <= set(columns):
            return axes, scaled
    raise FileFormatError(
        f"{name}: line {line}: expected columns x y z (or xu, xs, xsu ...), got "
        f"{cut(' '.join(columns)) or 'none'}. Write the dump with them: dump 1 all custom 100 "
        "a.dump id type x y z."
    )


def _odd_type(types: Sequence[str]) -> int | None:
    """The first row with a word where the types are numbers: a damaged row."""
    if finite_number(types[0]) is None:
        return None
    words = {word for word in set(types) if finite_number(word) is None}
    return next(k for k, word in enumerate(types) if word in words) if words else None


def _box(
    name: str, line: int, rows: Sequence[str]
) -> tuple[np.ndarray, np.ndarray, tuple[bool, bool, bool]]:
    """Origin, edges and periods of the box of a dump, from its item onwards."""
    head = rows[0].split()[3:]
    flags = [x for x in head if re.fullmatch("[pfsm]{1,2}", x)]
    periodic = [x[0] == "p" for x in flags] if len(flags) == 3 else [True] * 3
    general, tilted = head[:2] == ["abc", "origin"], head[:3] == ["xy", "xz", "yz"]
    # Rows of old versions name no tilts.
    width = 4 if general else 3 if tilted else len(rows[1].split()) if len(rows) > 1 else 2
    lines = range(line + 1, line + 4)
    if len(rows) < 4:
        raise FileFormatError(
            f"{name}: line {line}: expected three rows of the box, got {len(rows) - 1}. Is the "
            "file complete?"
        )
    wide = width if width in (2, 3, 4) else 2
    sides, _ = number_table(name, lines, rows[1:4], wide, range(wide))
    flags3 = (periodic[0], periodic[1], periodic[2])
    if general or sides.shape[1] == 4:
        return sides[:, 3], sides[:, :3].copy(), flags3
    low, high = sides[:, 0].copy(), sides[:, 1].copy()
    xy, xz, yz = sides[:, 2] if sides.shape[1] == 3 else np.zeros(3)
    # The box of a dump is the bounding box of the tilted cell.
    low[:2] -= min(0.0, xy, xz, xy + xz), min(0.0, yz)
    high[:2] -= max(0.0, xy, xz, xy + xz), max(0.0, yz)
    return low, _edges(high - low, xy, xz, yz), flags3


def _edges(lengths: np.ndarray, xy: float, xz: float, yz: float) -> np.ndarray:
    """Edges of a cell with tilts as rows."""
    return np.array([[lengths[0], 0, 0], [xy, lengths[1], 0], [xz, yz, lengths[2]]], dtype=float)


# -- data -----------------------------------------------------------------------------------------


def data_frame(name: str, text: str) -> AtomData:
    """The atoms of a data file, in the order of their ids; its cell repeats along each edge.

    The style of the atoms is the word after Atoms (Atoms # atomic), or else the style that columns
    allow. Species are labels of types, comments of Masses, or numbers.
    """
    file = _DataFile.of(name, text)
    header, sections = file.header, file.sections
    if "Atoms" not in sections or "atoms" not in header:
        missing = (
            "section Atoms" if "Atoms" not in sections else "number of atoms (such as 5 atoms)"
        )
        raise FileFormatError(
            f"{name}: expected a LAMMPS data file with a row such as 5 atoms, the box and a "
            f"section Atoms, got a file without the {missing}. Is the file complete?"
        )
    body = file.body("Atoms")
    line, count = header["atoms"][0] + 1, " ".join(header["atoms"][1])
    if not count.isdecimal() or len(count) > 18 or int(count) != len(body):
        raise FileFormatError(
            f"{name}: line {line}: expected {cut(count)} atoms, as this line declares, got "
            f"{len(body):,} rows. Correct the number, or export the file again."
        )
    lines = [file.places[k] + 1 for k in body]
    words = [file.words[k] for k in body]
    texts = [file.rows[k].partition("#")[0] for k in body]
    width = len(words[0]) if words else 0
    odd = next((k for k, row in enumerate(words) if len(row) != width), None)
    if odd is not None:
        refuse_row(name, lines[odd], texts[odd], width, ())
    title = sections["Atoms"]
    style = file.rows[title].partition("#")[2].strip()
    kind, x = _style(name, file.places[title] + 1, style, words, header)
    values, _ = number_table(name, lines, texts, width, (0, x, x + 1, x + 2) if body else ())
    order = np.argsort(values[:, 0], kind="stable")
    labels = file.labels()
    types: list[str] = [words[k][kind] for k in order.tolist()]
    species: tuple[str, ...] = tuple(labels.get(one, one) for one in types)
    return AtomData(values[order, 1:], _cell(name, header), (True, True, True), species, name)


@dataclass(frozen=True)
class _DataFile:
    """The rows of a data file with words, without the title.

    rows, places, words: each row, its number in the file from 0, its words before the comment.
    """

    name: str
    rows: list[str]
    places: list[int]
    words: list[list[str]]

    @classmethod
    def of(cls, name: str, text: str) -> _DataFile:
        """The rows of a text; rows without words take memory only in the text."""
        numbered = [
            (k, row)
            for k, row in enumerate(io.StringIO(text))
            if k and row.partition("#")[0].strip()
        ]
        rows = [row for _, row in numbered]
        words = [row.partition("#")[0].split() for row in rows]
        return cls(name, rows, [k for k, _ in numbered], words)

    @cached_property
    def heads(self) -> list[int]:
        """The rows that are titles of sections, in order."""
        return [k for k, words in enumerate(self.words) if words[0][0].isalpha()]

    @cached_property
    def sections(self) -> dict[str, int]:
        """Title of a section -> its row; the first, where a title occurs twice."""
        return {" ".join(self.words[k]): k for k in reversed(self.heads)}

    def body(self, title: str) -> range:
        """The rows of a section below its title; none without the section."""
        start = self.sections.get(title)
        if start is None:
            return range(0)
        return range(start + 1, next((k for k in self.heads if k > start), len(self.rows)))

    @cached_property
    def header(self) -> Said:
        """Key of a row above the sections -> its place and the words before the key."""
        header: Said = {}
        top = self.heads[0] if self.heads else len(self.rows)
        for place, words in zip(self.places[:top], self.words[:top], strict=True):
            for key in _KEYS:
                ends = key.split()
                if words[-len(ends) :] == ends:
                    header[key] = place, words[: -len(ends)]
        return header

    def labels(self) -> dict[str, str]:
        """Number of a type -> its label: from Atom Type Labels, or the comment after its mass."""
        masses = [
            (self.words[k][0], self.rows[k].partition("#")[2].split()) for k in self.body("Masses")
        ]
        named = [(self.words[k][0], self.words[k][1:]) for k in self.body("Atom Type Labels")]
        return {number: words[0] for number, words in (*masses, *named) if words}


def _style(
    name: str, line: int, said: str, words: Sequence[Sequence[str]], counts: Said
) -> tuple[int, int]:
    """Columns of the type and of x."""
    first = said.split()[0].split("/")[0] if said else ""
    width = len(words[0]) if words else 5
    if first in _STYLES:
        kind, x, most = _STYLES[first]
        if width < most:
            raise FileFormatError(
                f"{name}: line {line}: expected {most} or more columns for atoms of the style "
                f"{first}, got {width}. Correct the word after Atoms #."
            )
        return kind, x
    number = counts.get("atom types", (0, ["0"]))[1][0]
    types = int(number) if number.isdecimal() and len(number) < 10 else 0
    fitting = [style for style in _LIKELY if _fits(words, _STYLES[style], types)]
    if said or len({_STYLES[style][:2] for style in fitting}) != 1:
        seems = f"columns that fit {' and '.join(fitting)}" if fitting else f"{width} columns"
        raise FileFormatError(
            f"{name}: line {line}: expected the style of the atoms (Atoms # atomic), got "
            f"{shown(said) if said else seems}. Write one of {', '.join(_STYLES)} after Atoms #."
        )
    return _STYLES[fitting[0]][:2]


def _fits(words: Sequence[Sequence[str]], style: tuple[int, int, int], types: int) -> bool:
    """Whether rows fit a style: types that exist, and image flags, if any."""
    kind, _, width = style
    extra = (len(words[0]) if words else width) - width
    if extra not in (0, 3):
        return False
    for row in words:
        is_type = row[kind].isdecimal() and 1 <= int(row[kind][:9]) <= types
        whole = [*row[width:], *(row[1:kind] if kind > 1 else ())]
        if not is_type or not all(re.fullmatch("[+-]?[0-9]+", word) for word in whole):
            return False
        if not all(is_number(word) for word in row):
            return False
    return True


def _cell(name: str, said: Said) -> np.ndarray | None:
    """The cell of a data file, from the keys above its sections."""

    def numbers(key: str, count: int) -> list[float]:
        if key not in said:
            raise FileFormatError(
                f"{name}: expected the box of the atoms ({key}) above the sections, got only "
                f"{cut(', '.join(said))}. Is the file complete?"
            )
        k, words = said[key]
        return TextRows(name, line=k + 1).numbers(words, count, key)

    if "avec" in said:
        return completed(name, np.array([numbers(key, 3) for key in ("avec", "bvec", "cvec")]))
    sides = np.array([numbers(f"{axis}lo {axis}hi", 2) for axis in "xyz"])
    tilts = numbers("xy xz yz", 3) if "xy xz yz" in said else [0.0, 0.0, 0.0]
    return completed(name, _edges(sides[:, 1] - sides[:, 0], tilts[0], tilts[1], tilts[2]))

"""LAMMPS: frames of its text dumps, and its data files, of every atom style with known columns."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from io import TextIOBase

import numpy as np

from geomtorsion.checks import cut, shown
from geomtorsion.errors import FileFormatError
from geomtorsion.files import finite_number
from geomtorsion.materials.crystals.atom_rows import (
    AtomData,
    completed,
    is_number,
    numbers_of,
    words_of,
)

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
    return text.lstrip().startswith("ITEM: ")


def seems_data(text: str) -> bool:
    """Whether a file begins like a data file."""
    return bool(_ATOMS.search(text) and _SIDES.search(text))


# -- dump -----------------------------------------------------------------------------------------


def dump_blocks(name: str, stream: TextIOBase) -> Iterator[tuple[int, list[str]]]:
    """Frames of a dump as rows, with the numbers of their first lines.

    UNITS and TIME may precede each frame.
    """
    first, rows, inside = 1, [], False
    for number, row in enumerate(stream, 1):
        is_item = row.startswith("ITEM: ")
        if inside and is_item:
            yield first, _whole_dump(name, first, rows)
            rows, inside = [], False
        if not rows:
            if not row.strip():
                continue
            if not is_item:
                raise FileFormatError(
                    f"{name}: line {number}: expected ITEM: TIMESTEP, got {shown(row.strip())}. "
                    "Name the format of the file: form=... (--read-as)."
                )
            first = number
        inside = inside or row.startswith("ITEM: ATOMS")
        rows.append(row)
    if rows:
        yield first, _whole_dump(name, first, rows)


def _marks(rows: Sequence[str]) -> dict[str, int]:
    """First word of each item -> the number of its row."""
    return {
        row.split()[1]: k
        for k, row in enumerate(rows)
        if row.startswith("ITEM: ") and len(row.split()) > 1
    }


def _whole_dump(name: str, first: int, rows: list[str]) -> list[str]:
    """The rows of a frame, as many as its header states."""
    marks = _marks(rows)
    for key in ("TIMESTEP", "NUMBER", "BOX", "ATOMS"):
        if key not in marks:
            raise FileFormatError(
                f"{name}: line {first}: expected ITEM: {key} ... in this frame, got "
                f"{', '.join(marks)}. Is the file complete, and a dump of atoms (dump custom)?"
            )
    count = marks["NUMBER"] + 1
    number = rows[count].strip() if count < len(rows) else ""
    if not number.isdecimal() or len(number) > 18:
        raise FileFormatError(
            f"{name}: line {first + count}: expected the number of atoms, got {shown(number)}. Is "
            "the file complete?"
        )
    while not rows[-1].strip():
        rows.pop()
    body = len(rows) - 1 - marks["ATOMS"]
    if body > int(number):
        raise FileFormatError(
            f"{name}: line {first + count}: expected {number} atoms, as this line declares, got "
            f"{body:,} rows. Correct the number, or export the file again."
        )
    if body < int(number):
        raise FileFormatError(
            f"{name}: line {first + len(rows) - 1}: the frame ends after {body:,} of "
            f"{int(number):,} atoms. Is the file complete?"
        )
    return rows


def dump_frame(name: str, line: int, rows: list[str], where: str) -> AtomData:
    """The atoms of a frame in the order of their ids; line: number of its first row in the file.

    A box without flags of its sides repeats along each edge, the default of LAMMPS. Species
    come from the column element, or from type.
    """
    marks = _marks(rows)
    start = marks["ATOMS"]
    columns = rows[start].split()[2:]
    lines = range(line + start + 1, line + len(rows))
    words = words_of(name, lines, rows[start + 1 :], len(columns))
    origin, edges, periodic = _box(name, line + marks["BOX"], rows[marks["BOX"] : start])
    choices = [one for one in _PLACES if set(one[0].split()) <= set(columns)]
    if not choices:
        raise FileFormatError(
            f"{name}: line {line + start}: expected columns x y z (or xu, xs, xsu ...), got "
            f"{cut(' '.join(columns)) or 'none'}. Write the dump with them: dump 1 all custom 100 "
            "a.dump id type x y z."
        )
    axes, scaled = choices[0]
    kind = next((columns.index(x) for x in _KINDS if x in columns), None)
    numeric = [*axes.split(), *(["id"] if "id" in columns else [])]
    indices = [columns.index(x) for x in numeric]
    if kind is not None and words and is_number(words[0][kind]):
        # Where types are numbers, a word among them is a damaged row.
        indices.append(kind)
    table = numbers_of(name, lines, words, indices)
    values = table[:, :3]
    positions = origin + values @ edges if scaled else values
    order = np.argsort(table[:, 3], kind="stable") if "id" in columns else np.arange(len(words))
    species = None if kind is None else tuple(words[k][kind] for k in order.tolist())
    return AtomData(positions[order], completed(edges), periodic, species, where)


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
    words = words_of(name, lines, rows[1:4], width if width in (2, 3, 4) else 2)
    if len(words) < 3:
        raise FileFormatError(
            f"{name}: line {line}: expected three rows of the box, got {len(words)}. Is the file "
            "complete?"
        )
    sides = numbers_of(name, lines, words, range(len(words[0])))
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
    # Rows without words take memory only in the text; the first row is a title.
    numbered = [
        (k, row) for k, row in enumerate(io.StringIO(text)) if k and row.partition("#")[0].strip()
    ]
    rows = [row for _, row in numbered]
    places = [k for k, _ in numbered]
    plain = [row.partition("#")[0].split() for row in rows]
    heads = [k for k, words in enumerate(plain) if words[0][0].isalpha()]
    sections = {" ".join(plain[k]): k for k in reversed(heads)}
    top = heads[0] if heads else len(rows)
    header: Said = {}
    for k, words in enumerate(plain[:top]):
        for key in _KEYS:
            ends = key.split()
            if words[-len(ends) :] == ends:
                header[key] = places[k], words[: -len(ends)]
    if "Atoms" not in sections or "atoms" not in header:
        missing = (
            "section Atoms" if "Atoms" not in sections else "number of atoms (such as 5 atoms)"
        )
        raise FileFormatError(
            f"{name}: expected a LAMMPS data file with a row such as 5 atoms, the box and a "
            f"section Atoms, got a file without the {missing}. Is the file complete?"
        )
    start = sections["Atoms"]
    end = next((k for k in heads if k > start), len(rows))
    body = range(start + 1, end)
    line, count = header["atoms"][0] + 1, " ".join(header["atoms"][1])
    if not count.isdecimal() or len(count) > 18 or int(count) != len(body):
        raise FileFormatError(
            f"{name}: line {line}: expected {cut(count)} atoms, as this line declares, got "
            f"{len(body):,} rows. Correct the number, or export the file again."
        )
    lines = [places[k] + 1 for k in body]
    width = len(plain[body[0]]) if body else 0
    words = words_of(name, lines, [" ".join(plain[k]) for k in body], width)
    style = rows[start].partition("#")[2].strip()
    kind, x = _style(name, places[start] + 1, style, words, header)
    values = numbers_of(name, lines, words, (0, x, x + 1, x + 2))
    order = np.argsort(values[:, 0], kind="stable")
    labels = _labels(rows, plain, sections, heads)
    types: list[str] = [words[k][kind] for k in order.tolist()]
    species: tuple[str, ...] = tuple(labels.get(one, one) for one in types)
    return AtomData(values[order, 1:], _cell(name, header), (True, True, True), species, name)


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


def _labels(
    rows: Sequence[str],
    plain: Sequence[Sequence[str]],
    sections: dict[str, int],
    heads: Sequence[int],
) -> dict[str, str]:
    """Number of a type -> its label: from Atom Type Labels, or the comment after its mass."""
    labels: dict[str, str] = {}
    for title in ("Masses", "Atom Type Labels"):
        start = sections.get(title)
        if start is None:
            continue
        end = next((k for k in heads if k > start), len(rows))
        for k in range(start + 1, end):
            comment = rows[k].partition("#")[2].split()
            label = plain[k][1:2] if title == "Atom Type Labels" else comment[:1]
            if label:
                labels[plain[k][0]] = label[0]
    return labels


def _cell(name: str, said: Said) -> np.ndarray | None:
    """The cell of a data file, from the keys above its sections."""

    def numbers(key: str, count: int) -> list[float]:
        if key not in said:
            raise FileFormatError(
                f"{name}: expected the box of the atoms ({key}) above the sections, got only "
                f"{cut(', '.join(said))}. Is the file complete?"
            )
        k, words = said[key]
        values = [finite_number(word) for word in words]
        if len(values) != count or None in values:
            raise FileFormatError(
                f"{name}: line {k + 1}: {key}: expected {count} numbers, got "
                f"{shown(' '.join(words))}. Correct it."
            )
        return [x for x in values if x is not None]

    if "avec" in said:
        return completed(np.array([numbers(key, 3) for key in ("avec", "bvec", "cvec")]))
    sides = np.array([numbers(f"{axis}lo {axis}hi", 2) for axis in "xyz"])
    tilts = numbers("xy xz yz", 3) if "xy xz yz" in said else [0.0, 0.0, 0.0]
    return completed(_edges(sides[:, 1] - sides[:, 0], tilts[0], tilts[1], tilts[2]))

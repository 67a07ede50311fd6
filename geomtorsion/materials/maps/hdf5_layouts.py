"""HDF5 layouts: how programs store an orientation map, its grid and its phases in HDF5."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from geomtorsion.materials.maps.map_files import ANG_LAUE
from geomtorsion.materials.maps.map_phases import LAUE_NUMBERS
from geomtorsion.support.hdf5 import Item, is_data_set, is_group

# Units of angles, in radians.
ANGLES = {"rad": 1.0, "deg": np.pi / 180}


@dataclass(frozen=True)
class Layout:
    """Conventions of a program.

    program: its name. maker: text in the data set `manufacturer`, in lower case, or the name of a
    data set that only this program writes. angle: unit of the angles in radians, None if not known.
    offset: added to the numbers of phases, so that 0 is a point that was not indexed. horizontal:
    as in `Phase`. has_y: whether positions are reliable; otherwise the header gives the grid.
    """

    program: str
    maker: str
    angle: float | None
    offset: int = 0
    horizontal: str = "x"
    has_y: bool = True


# To add a program, add a line here. The first that fits counts.
LAYOUTS = (
    Layout("Oxford", "x cells", ANGLES["rad"], horizontal="y"),
    Layout("EMsoft", "dictionaryeulerangles", ANGLES["rad"], has_y=False),
    Layout("EMSphInx", "emsphinx", ANGLES["rad"], has_y=False),
    Layout("EMsoft", "emsoft", ANGLES["rad"], has_y=False),
    Layout("EMsoft", "emebsd", ANGLES["rad"], has_y=False),
    Layout("EDAX", "edax", ANGLES["rad"]),
    Layout("EDAX", "tsl", ANGLES["rad"]),
    Layout("Bruker", "bruker", ANGLES["deg"]),
    Layout("orix", "orix", ANGLES["rad"], offset=1),
    Layout("kikuchipy", "kikuchipy", ANGLES["rad"], offset=1),
    Layout("DREAM.3D", "crystalstructures", ANGLES["rad"]),
)
UNKNOWN = Layout("unknown", "", None)

# Quantity -> names of its data set, without blanks, lines and case.
QUANTITIES = {
    "euler": ("refinedeulerangles", "eulerangles", "euler", "eulers"),
    "phi1": ("phi1", "euler1", "eulerphi1", "eulerangle1"),
    "Phi": ("phi", "euler2", "eulerphi", "eulerangle2"),
    "phi2": ("phi2", "euler3", "eulerphi2", "eulerangle3"),
    "dictionary": ("dictionaryeulerangles",),
    "matches": ("topmatchindices",),
    "x": ("x", "xsample", "xposition", "xpos", "xbeam"),
    "y": ("y", "ysample", "yposition", "ypos", "ybeam"),
    "z": ("z",),
    "phase": ("phase", "phaseid", "phases", "phasedata", "phaseindex"),
    "inside": ("isindata",),
    "confidence": ("ci", "confidenceindex"),
}
# The same for the header.
HEADER = {
    "columns": ("xcells", "ncolumns", "ncols", "nx"),
    "rows": ("ycells", "nrows", "ny"),
    "dx": ("xstep", "stepx"),
    "dy": ("ystep", "stepy"),
    "unit": ("scanunit",),
    "grid": ("gridtype",),
}
_NAMES = ("phasename", "materialname", "name")
_CELLS = ("latticeconstants", "abcabg")
_SPACE_GROUPS = (
    (2, "-1"), (15, "2/m"), (74, "mmm"), (88, "4/m"), (142, "4/mmm"), (148, "-3"), (167, "-3m"),
    (176, "6/m"), (194, "6/mmm"), (206, "m-3"), (230, "m-3m"),
)  # fmt: skip
_POINT_GROUPS = {
    "-1": "1 -1", "2/m": "2 m 2/m 121 1m1 112 11m", "mmm": "222 mm2 mmm", "4/m": "4 -4 4/m",
    "4/mmm": "422 4mm -42m -4m2 4/mmm", "-3": "3 -3", "-3m": "32 3m -3m 321 312 3m1 31m -31m -3m1",
    "6/m": "6 -6 6/m", "6/mmm": "622 6mm -6m2 -62m 6/mmm", "m-3": "23 m-3 m3",
    "m-3m": "432 -43m m-3m m3m",
}  # fmt: skip
_BY_POINT_GROUP = {name: laue for laue, names in _POINT_GROUPS.items() for name in names.split()}
# Numbers of crystal structures in DREAM.3D.
_STRUCTURES = "6/mmm m-3m 6/m m-3 -1 2/m mmm 4/m 4/mmm -3 -3m".split()


def plain(name: str) -> str:
    """A name without blanks, lines and case."""
    return re.sub(r"[\s_\-]+", "", name).lower()


def data_sets(group: Item, depth: int = 8) -> Iterator[Item]:
    """Data sets below a group, first the direct ones."""
    inner = []
    for key in group:
        item = group.get(key)
        if is_data_set(item):
            yield item
        elif is_group(item) and depth:
            inner.append(item)
    for item in inner:
        yield from data_sets(item, depth - 1)


def last(name: str) -> str:
    """Last part of the path of a data set, plain."""
    return plain(name.rsplit("/", 1)[-1])


def layout_of(file: Item, group: Item) -> Layout:
    """The layout of the program that wrote a file."""
    makers = [text_of(file[key]) for key in file if plain(key) == "manufacturer"]
    makers += [str(value) for key, value in file.attrs.items() if plain(key) == "manufacturer"]
    around = {last(one.name) for place in _near(group) for one in data_sets(place, 3)}
    for layout in LAYOUTS:
        if plain(layout.maker) in around or any(layout.maker in text.lower() for text in makers):
            return layout
    return UNKNOWN


def text_of(item: Item) -> str:
    """A text in a data set; empty for anything else."""
    value = item[()] if hasattr(item, "dtype") and item.size == 1 else b""
    value = np.ravel(value)[0] if np.size(value) else b""
    return value.decode("utf-8", "replace").strip() if isinstance(value, bytes) else str(value)


def header_of(group: Item) -> dict[str, Any]:
    """Numbers and texts about the grid of a map, by quantity."""
    found: dict[str, Any] = {}
    for near in _near(group):
        for place in [near[key] for key in near if plain(key) == "header"] + [near]:
            for key, item in place.items():
                for quantity, names in HEADER.items():
                    if plain(key) in names and is_data_set(item) and item.size == 1:
                        found.setdefault(quantity, np.ravel(item[()])[0])
    shape = _geometry(group)
    return found | shape


def _near(group: Item) -> list[Item]:
    """The groups whose header describes a map: its own, then those beside it.

    Data that Oxford's programs processed have the grid in the header of the measured map.
    """
    own = group.parent
    beside = [own.parent[key] for key in own.parent if plain(key) == "ebsd"]
    return [own, *(one for one in beside if is_group(one) and one.name != own.name)]


def _geometry(group: Item) -> dict[str, Any]:
    """Grid of an image geometry of DREAM.3D: numbers of cells and steps along x, y and z."""
    parent = group.parent
    values: dict[str, Any] = {plain(key).strip("_"): value for key, value in parent.attrs.items()}
    for key in parent:
        if plain(key) in ("simplgeometry", "geometry") and is_group(parent[key]):
            values |= {plain(name): item[()] for name, item in parent[key].items()}
    size, steps = (np.ravel(values.get(name, ())) for name in ("dimensions", "spacing"))
    if len(size) != 3 or len(steps) != 3:
        return {}
    return {
        "columns": size[0], "rows": size[1], "planes": size[2], "dx": steps[0], "dy": steps[1],
    }  # fmt: skip


@dataclass(frozen=True)
class Described:
    """A phase as a file describes it: number, name, Laue group or None, lengths and angles."""

    number: int
    name: str
    laue: str | None
    lattice: tuple[list[float], list[float]]


def phases_of(group: Item, layout: Layout) -> list[Described]:
    """Phases that the header of a map, or the ensembles of DREAM.3D, describe."""
    found: list[Described] = []
    parent = group.parent
    for place in [parent[key] for key in parent if plain(key) == "header"] + [parent]:
        for key in place:
            if plain(key) in ("phases", "phase") and is_group(place[key]):
                for number, entry in place[key].items():
                    if re.fullmatch(r"\d{1,4}", number) and is_group(entry):
                        found.append(_described(int(number) + layout.offset, entry))
                return sorted(found, key=lambda one: one.number)
    for key in parent:
        if plain(key) in ("cellensembledata", "ensembledata"):
            return list(_ensembles(parent[key]))
    return found


def _described(number: int, entry: Item) -> Described:
    """A phase from the data sets of its group."""
    items: dict[str, Item] = {}
    for item in data_sets(entry):
        items.setdefault(last(item.name), item)
    name = next((text_of(items[key]) for key in _NAMES if key in items), "") or f"phase {number}"
    cell: list[float] = []
    if "latticedimensions" in items and "latticeangles" in items:
        cell = [x for key in ("dimensions", "angles") for x in _numbers(items[f"lattice{key}"])]
    elif "latticeconstanta" in items:
        keys = ("a", "b", "c", "alpha", "beta", "gamma")
        cell = [x for key in keys for x in _numbers(items.get(f"latticeconstant{key}"))]
    else:
        cell = next((_numbers(items[key]) for key in _CELLS if key in items), [])
    return Described(number, name, _laue(items), _cell(cell))


def _numbers(item: Item | None) -> list[float]:
    """Finite numbers in a data set; none for anything else."""
    if item is None or item.dtype.kind not in "fiu" or item.size > 6:
        return []
    return [float(x) for x in np.ravel(item[()])]


def _cell(values: list[float]) -> tuple[list[float], list[float]]:
    """Lengths and angles in degrees; smaller angles than 2 pi degrees are in radians."""
    if len(values) != 6 or not min(values) > 0:
        return [0.0] * 3, [90.0] * 3
    lengths, angles = values[:3], values[3:]
    if max(angles) < 2 * np.pi:
        angles = np.degrees(angles).round(4).tolist()
    return lengths, angles


def _laue(items: dict[str, Item]) -> str | None:
    """Laue group from its number, a space group, a point group or a symmetry of EDAX."""
    if "lauegroup" in items and (numbers := _numbers(items["lauegroup"])):
        return LAUE_NUMBERS.get(numbers[0])
    for key in ("it", "spacegroup", "spacegroupnumber"):
        if key in items:
            text = text_of(items[key])
            if re.fullmatch(r"\d{1,3}(\.0)?", text) and 1 <= float(text) <= 230:
                return next(laue for most, laue in _SPACE_GROUPS if float(text) <= most)
            if (laue := _of_symbol(text)) is not None:
                return laue
    for key in ("pointgroup", "symmetry", "lgsymid"):
        if key in items:
            text = text_of(items[key]).removesuffix(".0")
            inner = re.search(r"\[(.+)\]", text)
            text = (inner[1] if inner else text).strip()
            # EDAX writes 43 for m-3m, and 20 for 2/m.
            laue = ANG_LAUE.get(text) if key != "pointgroup" else None
            laue = laue or _BY_POINT_GROUP.get(text) or ANG_LAUE.get(text)
            if laue is not None:
                return laue
    return None


def _of_symbol(text: str) -> str | None:
    """Laue group of the symbol of a space group, such as Fm-3m, P 63/m m c or P 6#sub3/mmc.

    Bruker writes #ovl for a bar and #sub for the number of a screw axis.
    """
    symbol = re.sub(r"#sub\d|_\d|\(.*\)|\s*:?[HRS]$", "", text).replace("#ovl", "-").strip()
    # Directions behind the letter of the centring; glides count as mirrors.
    axes = [re.sub("[abcden]", "m", one) for one in re.sub(r"^[PIFABCR]", "", symbol).split()]
    # "- 3" is "-3", and an axis without symmetry, as in P 1 2/m 1, has no part in the group.
    joined = "".join(axes)
    screws = [re.sub(r"^([2346])[1-5](?!\d)", r"\1", one) for one in axes if one != "1"]
    compact = re.sub(r"(?<!-)([2346])[1-5](?=$|[/m23])", r"\1", joined)
    return next((_BY_POINT_GROUP[x] for x in (joined, "".join(screws), compact)
                 if x in _BY_POINT_GROUP), None)  # fmt: skip


def _ensembles(group: Item) -> Iterator[Described]:
    """Phases of DREAM.3D, one for each entry but the first, which is for points without one."""
    items = {plain(key): item for key, item in group.items() if is_data_set(item)}
    if "crystalstructures" not in items or items["crystalstructures"].size > 1000:
        return
    structures = np.ravel(items["crystalstructures"][()]).tolist()
    names = next((items[key] for key in ("phasename", "materialname") if key in items), None)
    cells = items.get("latticeconstants")
    for number, code in enumerate(structures):
        if number == 0:
            continue
        name = f"phase {number}"
        if names is not None and names.size == len(structures):
            text = np.ravel(names[()])[number]
            name = text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text)
        cell: list[float] = []
        if cells is not None and cells.size == 6 * len(structures):
            cell = np.reshape(cells[()], (-1, 6))[number].astype(float).tolist()
        laue = _STRUCTURES[code] if 0 <= code < len(_STRUCTURES) else None
        yield Described(number, name, laue, _cell(cell))

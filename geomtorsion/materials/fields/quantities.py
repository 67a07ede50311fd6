"""Quantities: what the columns of a table of a field hold, and the values at its points."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import combinations, product
from pathlib import Path

import numpy as np

from geomtorsion.errors import FileFormatError
from geomtorsion.materials.columns import Names

# Names of the columns of other programs, in lower case: coordinates, components of a displacement,
# and columns that are negative where a correlation failed (DICe, VIC).
AXES = (
    ("x", "coordinate_x", "x_coordinate", "pos_x", "x0", "x_position", "x_pos", "x_pic"),
    ("y", "coordinate_y", "y_coordinate", "pos_y", "y0", "y_position", "y_pos", "y_pic"),
    ("z", "coordinate_z", "z_coordinate", "pos_z", "z0", "z_position", "z_pos"),
)
COMPONENTS = (
    ("u", "ux", "u_x", "vx", "dx", "disp_x", "x_displacement", "displacement_x", "u1", "d1",
     "horizontal_displacement_u"),
    ("v", "uy", "u_y", "vy", "dy", "disp_y", "y_displacement", "displacement_y", "u2", "d2",
     "vertical_displacement_v"),
    ("w", "uz", "u_z", "vz", "dz", "disp_z", "z_displacement", "displacement_z", "u3", "d3",
     "out_of_plane_displacement_w"),
)  # fmt: skip
FAILED = ("sigma",)
_KEYS = ("x", "y", "z", "u", "v", "w")
_PLAIN = {
    name: key for key, names in zip(_KEYS, (*AXES, *COMPONENTS), strict=True) for name in names
} | dict.fromkeys(FAILED, "failed")
# A value of the coframe or of a distortion, by its indices.
VALUE = re.compile(r"(e|beta)_([0-9])_([0-9])")
_PAIR = r"[ _-]?([xyz1-3])[ _]?([xyz1-3])"
_STRAIN = re.compile(rf"(?:e|eps|epsilon|ε|ϵ|[a-z_ -]*strain){_PAIR}")
_BEHIND = re.compile(r"([xyz])([xyz])[ _-]strain")
_SHEAR = re.compile(rf"(?:g|gamma|γ|shear|[a-z_ -]*shear_strain){_PAIR}")
_ROTATION = re.compile(rf"(?:w|omega|ω|rot|rotation){_PAIR}")
_SLOPE = re.compile(r"d(?:([uvw])|u_?([xyz]))_?/?d([xyz])")
_ANGLES = ("theta", "θ", "rotation", "rot", "rotation_z", "lattice rotation", "omega", "ω")
# Parts of one, and of a radian.
_UNITS = {
    "%": 0.01, "percent": 0.01, "1e-3": 1e-3, "10^-3": 1e-3, "1e-4": 1e-4, "ustrain": 1e-6,
    "microstrain": 1e-6, "deg": np.pi / 180, "degree": np.pi / 180, "degrees": np.pi / 180,
    "°": np.pi / 180, "mrad": 1e-3, "urad": 1e-6,
}  # fmt: skip
QUANTITIES = (
    "x, y, z; u, v, w of a displacement; exx, exy, eyy, ... and wxy or theta of strain and "
    "rotation; e_0_0, ... of a coframe; beta_0_0, ... of a distortion"
)


def quantity(word: str) -> str | None:
    """The quantity in a column of this name: x, u, exx, gxy, wxy, theta, e_0_0, beta_0_0, failed.

    Examples
    --------
    >>> [quantity(word) for word in ("Strain_XX", "e12", "rotation", "du/dy", "quality")]
    ['exx', 'exy', 'theta', 'beta_0_1', None]
    """
    plain = word.strip().lower()
    if VALUE.fullmatch(plain):
        return plain
    if (joined := _joined(plain)) in _PLAIN:
        return _PLAIN[joined]
    if plain in _ANGLES:
        return "theta"
    if slope := _SLOPE.fullmatch(plain):
        row = "uvw".index(slope[1]) if slope[1] else "xyz".index(slope[2])
        return f"beta_{row}_{'xyz'.index(slope[3])}"
    for key, pattern in (("g", _SHEAR), ("e", _STRAIN), ("e", _BEHIND), ("w", _ROTATION)):
        if pair := pattern.fullmatch(plain):
            i, j = (("xyz" * 2)["xyz123".index(letter)] for letter in pair.groups())
            if key != "e" and i == j:
                return None
            return f"{key}{i}{j}" if key == "w" else f"{key}{''.join(sorted(i + j))}"
    return None


def _joined(word: str) -> str:
    """A name with underscores for blanks, lines and colons."""
    return re.sub(r"[\s_:-]+", "_", word)


def quantities(names: Names) -> dict[str, int]:
    """Number of the column of each quantity; the first name of a quantity counts.

    Where a table has both x and X (VIC: pixels of an image, and lengths on the surface), and the
    same for u and U, capital letters count.
    """
    both = all({word, word.upper()} <= set(names.words) for word in "xyuv")
    small = set("xyzuvw") if both else set()
    places: dict[str, int] = {}
    # Names that come first in the tables above are preferred.
    ranks = {name: k for names in (*AXES, *COMPONENTS) for k, name in enumerate(names)}
    for k, word in enumerate(names.plain):
        key = quantity(word)
        if key is None or names.words[k] in small:
            continue
        old = places.get(key)
        if old is None or ranks.get(_joined(word), 0) < ranks.get(_joined(names.plain[old]), 0):
            places[key] = k
    return places


def form_of(keys: Mapping[str, int]) -> str | None:
    """Quantity in the columns: displacement, coframe, distortion or strain; None for others."""
    if sum(axis in keys for axis in "xyz") < 2:
        return None
    if sum(component in keys for component in "uvw") >= 2:
        return "displacement"
    for form, start in (("coframe", "e_0_"), ("distortion", "beta_0_")):
        if any(key.startswith(start) for key in keys):
            return form
    strained = any(re.fullmatch(r"[eg][xyz][xyz]", key) for key in keys)
    return "strain" if strained else None


def of_form(form: str, key: str) -> bool:
    """Whether a quantity belongs to values of this form."""
    patterns = {
        "displacement": r"[uvw]",
        "coframe": r"e_\d_\d",
        "distortion": r"beta_\d_\d",
        "strain": r"[egw][xyz][xyz]|theta",
    }
    return re.fullmatch(patterns[form], key) is not None


def values_of(
    path: Path, form: str, columns: Mapping[str, np.ndarray], units: Mapping[str, str]
) -> tuple[str, np.ndarray]:
    """Form and values, shape (rows, n) or (rows, columns, n); strain becomes a distortion.

    Raises
    ------
    FileFormatError
        A component is missing.
    """
    if form == "displacement":
        return form, np.array([columns[key] for key in "uvw" if key in columns])
    scaled = {key: values * _scale(units.get(key, "")) for key, values in columns.items()}
    if form == "strain":
        return "distortion", _strained(path, scaled)
    start = "e" if form == "coframe" else "beta"
    indices = [
        (int(found[2]), int(found[3]))
        for key in columns
        if (found := VALUE.fullmatch(key)) and found[1] == start
    ]
    rows, width = (max(index[k] for index in indices) + 1 for k in (0, 1))
    for i, mu in product(range(rows), range(width)):
        _require(path, f"{start}_{i}_{mu}", columns)
    return form, np.array(
        [[scaled[f"{start}_{i}_{mu}"] for mu in range(width)] for i in range(rows)]
    )


def _scale(unit: str) -> float:
    """Value of a unit of strain or rotation; 1 without one."""
    return _UNITS.get(unit.strip().lower(), 1.0)


def _require(path: Path, key: str, columns: Mapping[str, np.ndarray], remedy: str = "") -> None:
    """Refuse a table without a component."""
    if key not in columns:
        raise FileFormatError(
            f"{path}: expected a column {key}, got {', '.join(columns)}. "
            f'{remedy}Name the column: columns={{"{key}": "..."}} (--columns {key}=...).'
        )


def _strained(path: Path, columns: Mapping[str, np.ndarray]) -> np.ndarray:
    """Distortion beta_ij = e_ij + w_ij, w_ij = (d_j u_i - d_i u_j) / 2; theta = w_yx."""
    columns = {
        **{f"e{key[1:]}": values / 2 for key, values in columns.items() if key[0] == "g"},
        **columns,
    }
    axes = "xyz" if any("z" in key for key in columns) else "xy"
    rotation: dict[str, np.ndarray] = {}
    for i, j in combinations(axes, 2):
        if f"w{j}{i}" in columns:
            rotation[f"w{i}{j}"] = -columns[f"w{j}{i}"]
        elif f"w{i}{j}" in columns:
            rotation[f"w{i}{j}"] = columns[f"w{i}{j}"]
        elif axes == "xy" and "theta" in columns:
            rotation["wxy"] = -columns["theta"]
        else:
            remedy = "A strain needs the rotation to give a frame. "
            _require(path, f"w{i}{j}", columns, remedy)
    rows = []
    for i in axes:
        row = []
        for j in axes:
            key = f"e{''.join(sorted(i + j))}"
            _require(path, key, columns)
            turn = rotation[f"w{i}{j}"] if i < j else -rotation[f"w{j}{i}"] if j < i else 0.0
            row.append(columns[key] + turn)
        rows.append(row)
    return np.array(rows)

"""Theory files: a Lagrangian with its constants and invariants, read from TOML."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike

from geomtorsion import checks
from geomtorsion.errors import FileFormatError
from geomtorsion.files import TomlFile, read_toml
from geomtorsion.gravity.geometries import GEOMETRIES
from geomtorsion.gravity.invariants import invariant
from geomtorsion.gravity.lagrangian import Lagrangian

KEYS = ("name", "lagrangian", "geometry", "constants", "invariants")


def read_theory(path: str | PathLike[str]) -> Lagrangian:
    """Read a theory of gravity from a TOML file.

    Keys
    ----
    lagrangian
        Text such as ``"R + c*Y"``.
    name
        Name of the theory; the default is the name of the file.
    geometry
        Kind of connection, as in `Lagrangian`.
    constants
        List of names of constants that do not only multiply invariants.
    invariants
        Table name -> formula with indices, as of `invariant`: ``Y = "R_abcd R^abdc"``.

    Raises
    ------
    FileFormatError
        The file cannot be read, is not TOML, or has an unknown key or a value of the wrong kind.
    ExpressionError, GravityError
        A formula or a name of an invariant is refused.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "square.toml")
    ...     _ = file.write_text('''
    ... lagrangian = "R + c*Y"
    ... [invariants]
    ... Y = "R_abcd R^abdc"
    ... ''')
    ...     read_theory(file)
    square: L = R + c*Y
    """
    path = checks.file_name(path)
    file = read_toml(path)
    for key in file.data:
        if key not in KEYS:
            raise file.unknown((key,), KEYS, f"unknown key {checks.shown(key)}")
    if "lagrangian" not in file.data:
        raise FileFormatError(
            f'{file.name}: expected the key lagrangian, got none. Write lagrangian = "R + c*R1".'
        )
    table = file.data.get("invariants", {})
    if not isinstance(table, Mapping):
        raise FileFormatError(
            f"{file.name}: invariants: expected a table, got {checks.shown(table)}. Write "
            '[invariants], and below it Y = "R_abcd R^abdc".'
        )
    constants = file.data.get("constants", [])
    if not isinstance(constants, list) or not all(isinstance(x, str) for x in constants):
        raise FileFormatError(
            f"{file.name}: constants: expected a list of names, got {checks.shown(constants)}. "
            'Write constants = ["n"].'
        )
    geometry = _text(file, "geometry") or "any"
    return Lagrangian(
        _text(file, "lagrangian"),
        checks.choice(geometry, tuple(GEOMETRIES), f"{file.name}: geometry", FileFormatError),
        _text(file, "name") or path.stem,
        tuple(constants),
        tuple(invariant(name, formula) for name, formula in table.items()),
    )


def _text(file: TomlFile, key: str) -> str:
    """The text of a key, empty if there is none."""
    message = "{subject}: expected text in quotes, got {value}."
    return checks.text(
        file.data.get(key, ""), f"{file.name}: {key}", FileFormatError, message=message
    )

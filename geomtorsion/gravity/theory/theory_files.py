"""Theory files: a Lagrangian with its constants and invariants, read from TOML."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike

from geomtorsion.errors import FileFormatError
from geomtorsion.gravity.theory.geometries import GEOMETRIES
from geomtorsion.gravity.theory.invariants import Invariant, invariant
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.support import checks
from geomtorsion.support.files import TomlFile, read_toml

KEYS = ("lagrangian", "name", "geometry", "constants", "invariants")


def read_theory(path: str | PathLike[str]) -> Lagrangian:
    """Read the table [theory] of a TOML file.

    Keys of [theory]
    ----------------
    lagrangian
        Text such as ``"R + c*Y"``.
    name
        Name of the theory; the default is the name of the file.
    geometry
        Kind of connection, as in `Lagrangian`.
    constants
        Names of constants used elsewhere than as factors, for example exponents: ``"n v"``.
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
    ... [theory]
    ... lagrangian = "R + c*Y"
    ... invariants = {Y = "R_abcd R^abdc"}
    ... ''')
    ...     read_theory(file)
    square: L = R + c*Y, Y = R_abcd R^abdc
    """
    path = checks.file_name(path)
    file = read_toml(path)
    table = _table(file, file.data, "theory", 'lagrangian = "R + c*R1"')
    for key in table:
        if key not in KEYS:
            file.unknown(("theory", key), KEYS, f"theory: unknown key {checks.shown(key)}")
    if "lagrangian" not in table:
        raise FileFormatError(
            f'{file.name}: theory: expected a lagrangian, got none. Write lagrangian = "R".'
        )
    geometry = _text(file, table, "geometry") or "any"
    return Lagrangian(
        _text(file, table, "lagrangian"),
        checks.choice(geometry, tuple(GEOMETRIES), f"{file.name}: geometry", FileFormatError),
        _text(file, table, "name") or path.stem,
        _text(file, table, "constants"),
        invariants_of(file, table),
    )


def invariants_of(file: TomlFile, table: Mapping[str, object]) -> tuple[Invariant, ...]:
    """The invariants of a table [theory]."""
    formulas = _table(file, {"invariants": {}, **table}, "invariants", 'Y = "R_abcd R^abdc"')
    return tuple(invariant(name, formula) for name, formula in formulas.items())


def _table(file: TomlFile, data: Mapping[str, object], key: str, example: str) -> dict:
    """The table of a key."""
    value = data.get(key)
    if not isinstance(value, dict):
        came = checks.shown(value) if key in data else "none"
        raise FileFormatError(
            f"{file.name}: expected a table [{key}], got {came}. Write [{key}], and below it "
            f"{example}."
        )
    return value


def _text(file: TomlFile, table: Mapping[str, object], key: str) -> str:
    """The text of a key, empty if there is none."""
    value, subject = table.get(key, ""), f"{file.name}: {key}"
    return checks.text(value, subject, FileFormatError, expected="text in quotes")

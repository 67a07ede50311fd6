"""Equation files: first-order equations with a start, read from TOML."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any

from geomtorsion.errors import FileFormatError
from geomtorsion.ode.problem import ODE
from geomtorsion.support import checks
from geomtorsion.support.files import TomlFile, read_toml

KEYS = ("rates", "start", "parameters", "invariants", "name")


def is_equation_file(path: object) -> bool:
    """Whether a TOML file has a table of rates, as files of equations have.

    Examples
    --------
    >>> is_equation_file("my-tetrad.csv")
    False
    """
    name = checks.file_name(path)
    return name.suffix == ".toml" and name.is_file() and "rates" in read_toml(name).data


def read_equations(path: str | PathLike[str]) -> ODE:
    """Read first-order equations from a TOML file.

    Numbers are exact: 0.1 is one tenth, and "1/3" or "pi" may be written as texts.

    Keys
    ----
    rates
        Table state -> expression over states and parameters: ``x = "10*(y-x)"``.
    start
        Table state -> number at t = 0, or a list in the order of the rates.
    parameters, invariants
        Tables name -> number, and name -> expression that does not change; both may be missing.
    name
        Text; the default is the name of the file.

    Raises
    ------
    FileFormatError
        The file cannot be read, is not TOML, or has an unknown key or a value of the wrong kind.
    ExpressionError, StartError, UnknownNameError
        An expression or a number is refused, as by `ODE.of`.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "pendulum.toml")
    ...     _ = file.write_text('''
    ... rates = {x = "v", v = "-k*sin(x)"}
    ... start = {x = 1, v = 0}
    ... parameters = {k = 2.5}
    ... ''')
    ...     print(read_equations(file).text)
    x' = v
    v' = -k*sin(x)
    """
    path = checks.file_name(path)
    file = read_toml(path, decimals=True)
    for key in file.data:
        if key not in KEYS:
            file.unknown((key,), KEYS, f"unknown key {checks.shown(key)}")
    start = file.data.get("start")
    if not isinstance(start, dict | list):
        shown = "none" if start is None else checks.shown(start)
        file.fail(("start",), f"start: expected a table, got {shown}. Write start = {{x = 1}}.")
    try:
        return ODE.of(
            _table(file, "rates", required=True), start,
            parameters=_table(file, "parameters"), invariants=_table(file, "invariants"),
            name=checks.text(file.data.get("name", path.stem), "name", FileFormatError),
        )  # fmt: skip
    except FileFormatError as error:
        raise FileFormatError(f"{file.name}: {error}") from None


def _table(file: TomlFile, key: str, *, required: bool = False) -> Mapping[str, Any]:
    """The table of a key; empty where it may be missing."""
    value = file.data.get(key, None if required else {})
    if not isinstance(value, dict):
        shown = "none" if value is None else checks.shown(value)
        file.fail((key,), f'{key}: expected a table, got {shown}. Write {key} = {{x = "..."}}.')
    return value

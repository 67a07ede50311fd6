"""Files: a tetrad file (TOML) read into a space; nothing in it is ever run as code."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from os import PathLike
from typing import Any

from geomtorsion.errors import ArgumentError, CoframeError, FileFormatError, MetricError
from geomtorsion.geometry import (
    Connection,
    Frame,
    constrained,
    from_coefficients,
    from_contortion,
    from_spin_connection,
)
from geomtorsion.geometry.differentials import is_flat, written_out
from geomtorsion.spaces.space import Space
from geomtorsion.spaces.vocabulary import (
    FLAG,
    Vocabulary,
    antisymmetric_array,
    array,
    dimension_of,
    vocabulary,
)
from geomtorsion.support import checks
from geomtorsion.support.checks import flag, known_keys, shown
from geomtorsion.support.file_kinds import naming_other_kinds
from geomtorsion.support.files import Decimal, read_toml
from geomtorsion.support.outgoing import one_line

TEXT_KEYS = ("name", "title", "story", "source", "notes")
SYMBOL_KEYS = ("coordinates", "parameters", "functions", "domain", "names")
SHAPE_KEYS = ("coframe", "frame", "metric", "structure_constants")
CONNECTION_KEYS = ("spin_connection", "contortion", "connection", "constraints")
CHART_KEYS = ("edge", "margin", "charts")
KEYS = (
    *TEXT_KEYS, *SYMBOL_KEYS, "signature", "complex", *SHAPE_KEYS, *CONNECTION_KEYS, *CHART_KEYS,
    "theory",
)  # fmt: skip


ADVICE = 'Put expressions in quotes, as in ["r*sin(theta)", 0]; lists in square brackets.'


@naming_other_kinds("a tetrad")
def read_file(path: str | PathLike[str]) -> Space:
    """Read a space from a tetrad file.

    Keys
    ----
    name, title, story, source, notes
        Texts; the default name is the name of the file.
    coordinates
        List of names, in the order of the columns.
    parameters
        Table name -> assumptions: real, positive, negative, nonnegative, nonpositive, nonzero,
        integer, complex; or a list of names.
    functions
        Table name -> list of arguments, for unknown functions: ``a = ["t"]``.
    domain
        List of inequalities: ``["r > 2*M", "0 < theta < pi"]``.
    coframe, frame, metric, structure_constants
        Exactly one: e[i][mu] with one-forms as rows; legs[mu][i] with legs as columns; g[mu][nu];
        C[i][j][k] of [E_i, E_j] = C_ij^k E_k, a table ``"0,1,2" = 1`` being completed
        antisymmetrically.
    signature
        List of signs, or a constant symmetric matrix; plus signs by default.
    names
        Table name -> quantity that is printed by this name: ``Sigma = "r**2 + a**2"``; a quantity
        may contain the names before it (see `Frame.named`).
    complex
        true if legs may be complex.
    spin_connection, contortion, connection
        At most one: omega[a][i][j], K[a][b][c] or Gamma[a][b][c] of a connection of the space's
        own, a being the direction of differentiation; nested lists or a table of the entries that
        do not vanish, ``"0,1,2" = "1/r"``, indices counted from 0.
    constraints
        Instead of a connection: one-forms that vanish on the permitted velocities,
        ``["cos(theta)*dy - sin(theta)*dx"]``. The kinetic energy is g(v, v)/2; see `constrained`
        for the frame and the connection.
    edge, margin
        An expression that is positive inside the chart, and the value below which motions change
        to another chart.
    charts
        Tables of further charts, [[charts]]: name, coordinates, coframe (of the same metric),
        from_home (its coordinates as functions of the home ones), to_home (the inverse map); angles
        (names of coordinates that count modulo 2 pi), keeps_frame (true if its coframe is the
        same frame), edge and margin of its own. The maps are checked when the file is read.
    theory
        A table for `gravity.read_model`, which is not part of the space.

    Raises
    ------
    FileFormatError
        The file cannot be read, is not TOML, has an unknown key or a value of the wrong kind, or
        a map between charts is wrong.
    ExpressionError
        An expression cannot be read; the message names the entry and the part.
    LimitError
        The file or an expression is too large; the message names the limit.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from pathlib import Path
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "plane.toml")
    ...     _ = file.write_text('coordinates = ["r", "phi"]; coframe = [[1, 0], [0, "r"]]'
    ...                         .replace("; ", chr(10)))
    ...     read_file(file).frame.metric[1, 1]
    r**2
    """
    path = checks.file_name(path)
    data = read_toml(path, advice=ADVICE, decimals=True).data
    file = path.name
    _check_keys(file, data)
    shape = _only(file, data, SHAPE_KEYS, required=True)
    # A line element is a text; its dimension is the number of the coordinates.
    is_line = shape == "metric" and isinstance(data[shape], str)
    n = 0 if is_line else dimension_of(file, shape, data[shape])
    words = vocabulary(file, data, n)
    name = one_line(_text(file, data, "name")) or path.stem
    frame = _named(words, data, _frame(words, data, shape, name))
    connection = _connection(words, data, frame)
    if connection is not None:
        # Constraints adapt the frame to them.
        frame = connection.frame
    if any(key in data for key in CHART_KEYS):
        # Motions load scipy, which files without charts do not need.
        from geomtorsion.spaces.file_charts import attach_charts

        attach_charts(words, data, frame)
    return Space(
        name=name,
        title=one_line(_text(file, data, "title")) or name,
        story=_text(file, data, "story").strip(),
        source=_text(file, data, "source") or file,
        frame=frame,
        group="your own",
        notes=_text(file, data, "notes"),
        connection=connection,
    )


def _check_keys(file: str, data: Mapping[str, object]) -> None:
    """Refuse unknown keys, and those that slipped under a table."""
    known_keys(data, KEYS, file, FileFormatError, expected="a known key")
    for table in ("parameters", "functions", "names"):
        inside = data.get(table)
        for key in inside if isinstance(inside, dict) else ():
            if key in KEYS and key not in data:
                raise FileFormatError(
                    f"{file}: {key} is below [{table}], where it would be a name. In TOML "
                    f"everything below [{table}] belongs to it: move {key} above."
                )


def _only(file: str, data: Mapping[str, object], keys: tuple[str, ...], *, required: bool) -> str:
    """The one key of several that is present; empty if none is, and none is needed."""
    present = [key for key in keys if key in data]
    if len(present) == 1 or not (present or required):
        return present[0] if present else ""
    came = " and ".join(present) or "none"
    needed = "exactly one of" if required else "at most one of"
    raise FileFormatError(f"{file}: expected {needed} {', '.join(keys)}, got {came}.")


def _text(file: str, data: Mapping[str, object], key: str) -> str:
    value = data.get(key, "")
    if not isinstance(value, str) or isinstance(value, Decimal):
        raise FileFormatError(f"{file}: {key}: expected text in quotes, got {shown(value)}.")
    return value


def _texts(file: str, data: Mapping[str, object], key: str) -> list[str]:
    value = data[key]
    if not isinstance(value, list) or not all(isinstance(entry, str) for entry in value):
        raise FileFormatError(
            f"{file}: {key}: expected a list of texts, got {shown(value)}. Write "
            f'{key} = ["cos(theta)*dy - sin(theta)*dx"].'
        )
    return value


def _frame(words: Vocabulary, data: Mapping[str, object], shape: str, name: str) -> Frame:
    """The frame in whichever of the four ways it is given."""
    file, n = words.file, len(words.coordinates)
    signature = _signature(words, data)
    is_complex = flag(
        data.get("complex", False), f"{file}: complex", FileFormatError, expected=FLAG
    )
    domain = words.relations(data["domain"], "domain") if "domain" in data else None
    if shape == "structure_constants":
        _without(file, data, shape, "complex", "domain")
        constants = antisymmetric_array(words, shape, data[shape], n)
        return Frame.from_structure_constants(constants, words.coordinates, signature, name)
    entries = data[shape]
    if is_flat(entries):
        taken = [*words.symbols, *words.functions]
        try:
            entries = written_out(entries, shape, words.coordinates, taken, words.with_forms)
        except (CoframeError, MetricError) as error:
            raise FileFormatError(f"{file}: {error}") from error
    entries = array(words, shape, entries, 2, n)
    options: dict[str, Any] = {"parameters": words.parameters, "domain": domain, "name": name}
    if shape == "metric":
        _without(file, data, shape, "complex")
        return Frame.from_metric(words.coordinates, entries, signature, **options)
    maker = Frame if shape == "coframe" else Frame.from_frame
    return maker(words.coordinates, entries, signature, complex=is_complex, **options)


def _named(words: Vocabulary, data: Mapping[str, object], frame: Frame) -> Frame:
    """The frame, printed by the names that the file gives."""
    table = data.get("names", {})
    if not isinstance(table, dict):
        raise FileFormatError(
            f"{words.file}: names: expected a table, got {shown(table)}. Write "
            '[names] and below it Sigma = "r**2 + a**2*cos(theta)**2".'
        )
    try:
        for name, value in table.items():
            # A quantity may contain the names above it.
            wider = replace(words, parameters=(*words.parameters, *frame.names))
            frame = frame.named(**{name: wider.expression(value, f"names: {name}")})
    except ArgumentError as error:
        raise FileFormatError(f"{words.file}: names: {error}") from error
    return frame


def _without(file: str, data: Mapping[str, object], shape: str, *keys: str) -> None:
    """Refuse keys that mean nothing beside this kind of frame."""
    for key in keys:
        if data.get(key):
            raise FileFormatError(
                f"{file}: {key}: expected no such key with {shape}, where it has no meaning. "
                "Remove it."
            )


def _signature(words: Vocabulary, data: Mapping[str, object]) -> Any:
    """Signs, a matrix, or nothing."""
    value = data.get("signature")
    if value is None:
        return None
    if isinstance(value, list) and value and isinstance(value[0], list):
        return array(words, "signature", value, 2, len(words.coordinates))
    if isinstance(value, list) and all(type(sign) is int and abs(sign) == 1 for sign in value):
        return tuple(value)
    raise FileFormatError(
        f"{words.file}: signature: expected a list of signs 1 and -1 or a constant matrix, got "
        f"{shown(value)}. Write signature = [-1, 1, 1, 1]."
    )


def _connection(words: Vocabulary, data: Mapping[str, object], frame: Frame) -> Connection | None:
    """The space's own connection, if the file gives one."""
    key = _only(words.file, data, CONNECTION_KEYS, required=False)
    if not key:
        return None
    if key == "constraints":
        return constrained(frame, _texts(words.file, data, key))
    makers: dict[str, Callable[[Frame, Any], Connection]] = dict(
        zip(
            CONNECTION_KEYS[:3],
            (from_spin_connection, from_contortion, from_coefficients),
            strict=True,
        )
    )
    return makers[key](frame, array(words, key, data[key], 3, frame.dimension))

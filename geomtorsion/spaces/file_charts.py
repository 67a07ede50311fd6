"""File charts: further charts of a tetrad file, and the maps between them and its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import sympy as sp

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.curves.atlas_check import check_atlas
from geomtorsion.errors import CoordinateError, FileFormatError
from geomtorsion.exact.tokens import Limits
from geomtorsion.geometry import Frame
from geomtorsion.spaces.vocabulary import FLAG, Vocabulary, array, texts, vocabulary
from geomtorsion.support.checks import check_values, entries, flag, known_keys, known_name, shown
from geomtorsion.support.files import Decimal

# Keys of a chart, and of the coordinates of the file.
EDGE_KEYS = ("edge", "margin")
NEEDED = ("name", "coordinates", "coframe", "from_home", "to_home")
KEYS = (*NEEDED, "angles", "keeps_frame", *EDGE_KEYS)


def attach_charts(words: Vocabulary, data: Mapping[str, Any], frame: Frame) -> None:
    """Let a frame know the charts of its file, once all their maps are found right.

    Raises
    ------
    FileFormatError
        A key is unknown or missing, or a value of the wrong kind; or a map is wrong: it does not
        pull the metric back, or does not lead back.
    """
    tables = data.get("charts", [])
    if not isinstance(tables, list) or not all(isinstance(one, dict) for one in tables):
        raise FileFormatError(
            f"{words.file}: charts: expected tables, got {shown(tables)}. Write [[charts]]."
        )
    make = partial(_atlas, words, {key: data[key] for key in EDGE_KEYS if key in data}, tables)
    atlas = make(frame)
    try:
        check_atlas(frame, atlas)
    except CoordinateError as error:
        raise FileFormatError(f"{words.file}: charts: {error}") from None
    frame.attached["atlas"] = replace(atlas, origin=(make, frame))


def _atlas(
    words: Vocabulary, own: Mapping[str, Any], tables: list[dict[str, Any]], frame: Frame
) -> Atlas:
    """The atlas of a frame and the charts of its file."""
    home = frame.name
    charts = {home: Chart.of(frame, home, **_edge(words, own, ""))}
    maps: list[TransitionMap] = []
    for number, table in enumerate(tables):
        place = f"charts[{number}]"
        _check_keys(words.file, table, place)
        name = table["name"]
        if not isinstance(name, str) or not name or name in charts:
            raise FileFormatError(
                f"{words.file}: {place}.name: expected a name that no other chart has, got "
                f"{shown(name)}."
            )
        inner = _words(words, table, place)
        charts[name] = _chart(frame, inner, table, place, name)
        maps += _maps(words, inner, table, place, home, name)
    makers = {name: partial(_same, chart) for name, chart in charts.items()}
    # Motions begin in the chart of the file, and come back where another one ends.
    return Atlas(home, makers, partial(_same, tuple(maps)), tuple(charts))


def _same(value: Any) -> Any:
    return value


def _check_keys(file: str, table: Mapping[str, object], place: str) -> None:
    subject = f"{file}: {place}"
    known_keys(table, KEYS, subject, FileFormatError, expected="a known key")
    check_values(NEEDED, table, subject, FileFormatError, f"Give {', '.join(NEEDED)}.")


def _words(words: Vocabulary, table: Mapping[str, Any], place: str) -> Vocabulary:
    """What may occur in expressions over the coordinates of a further chart."""
    names = texts(words.file, table["coordinates"], f"{place}.coordinates")
    taken = {*words.symbols, *words.functions}
    for name in names:
        if name in taken:
            raise FileFormatError(
                f"{words.file}: {place}.coordinates: expected new names, got {shown(name)}, which "
                "is a name in the file already. Give each coordinate of a chart its own name."
            )
    own = vocabulary(words.file, {"coordinates": names}, len(names))
    return Vocabulary(words.file, own.coordinates, words.parameters, words.functions)


def _chart(
    frame: Frame, words: Vocabulary, table: Mapping[str, Any], place: str, name: str
) -> Chart:
    """A chart with the signature of the frame of the file."""
    each = range(frame.dimension)
    rows = array(words, f"{place}.coframe", table["coframe"], 2, frame.dimension)
    keeps = table.get("keeps_frame", False)
    flag(keeps, f"{words.file}: {place}.keeps_frame", FileFormatError, expected=FLAG)
    eta = [[frame.eta[i, j] for j in each] for i in each]
    chart_frame = Frame(words.coordinates, rows, eta, parameters=words.parameters, name=name)
    return Chart.of(chart_frame, name, keeps_frame=keeps, **_edge(words, table, f"{place}."))


def _edge(words: Vocabulary, table: Mapping[str, Any], place: str) -> dict[str, Any]:
    """Quantity that is positive in a chart, and its value at which motions leave the chart."""
    if "edge" not in table:
        if "margin" in table:
            raise FileFormatError(
                f"{words.file}: {place}margin is the value of edge at which motions leave a chart. "
                "Give also edge: an expression that is positive inside."
            )
        return {}
    margin = table.get("margin", "1/10")
    number: Any = None
    if not isinstance(margin, Decimal):
        number = words.expression(margin, f"{place}margin")
    elif _is_decimal(margin):
        number = sp.Rational(str(margin))
    if not isinstance(number, sp.Rational) or number.p <= 0:
        raise FileFormatError(
            f"{words.file}: {place}margin: expected a positive number, got "
            f"{shown(table['margin'])}."
        )
    near = number.p / number.q
    return {"edge": words.expression(table["edge"], f"{place}edge"), "margin": near}


def _is_decimal(text: str) -> bool:
    """Whether a text is a decimal number without an exponent, of no more digits than are read."""
    return len(text) <= Limits().digits and text.replace(".", "", 1).isdecimal()


def _maps(
    words: Vocabulary, inner: Vocabulary, table: Mapping[str, Any], place: str, home: str, name: str
) -> list[TransitionMap]:
    """The maps into a chart and back."""
    n = len(words.coordinates)
    lists = {}
    for key, reader in (("from_home", words), ("to_home", inner)):
        value = table[key]
        kind = f"a list of {n} expressions, one for each coordinate"
        entries(value, f"{words.file}: {place}.{key}", FileFormatError, n, expected=kind)
        lists[key] = tuple(
            reader.expression(entry, f"{place}.{key}[{k}]") for k, entry in enumerate(value)
        )
    angles = texts(words.file, table.get("angles", []), f"{place}.angles")
    every = [symbol.name for symbol in (*words.coordinates, *inner.coordinates)]
    subject = f"{words.file}: {place}.angles"
    for angle in angles:
        known_name(angle, every, subject, FileFormatError, expected="coordinates")

    def turning(symbols: tuple[sp.Symbol, ...]) -> tuple[int, ...]:
        return tuple(k for k, symbol in enumerate(symbols) if symbol.name in angles)

    there, back = lists["from_home"], lists["to_home"]
    q, x, parameters = words.coordinates, inner.coordinates, words.parameters
    return [
        TransitionMap(home, name, q, there, parameters, turning(x)),
        TransitionMap(name, home, x, back, parameters, turning(q)),
    ]

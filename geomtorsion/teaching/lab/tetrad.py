"""tetrad: a typed coframe, read entry by entry, and its geometry as mathematics."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.errors import CoordinateError, GeomtorsionError, LimitError, SignatureError
from geomtorsion.geometry import Frame
from geomtorsion.geometry.quantities import SECTIONS, TABLE
from geomtorsion.pictures.quantities import chosen_quantities
from geomtorsion.pictures.sections import aligned, section
from geomtorsion.spaces import Space
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab import views
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.typed_expressions import read_typed
from geomtorsion.teaching.texts import ENGLISH, Texts, texts

if TYPE_CHECKING:
    from geomtorsion.pictures.quantities import Quantity

# Quantities of the page, and those that are shown unless others are requested.
OFFERED = tuple(one.name for one in TABLE if one.page)
USUAL = tuple(one.name for one in TABLE if one.page == "shown")
_REAL = "give real entries, or use a tetrad file with complex = true"
_NAME = re.compile(r"[^\W0-9]\w*")
_PLACE = re.compile(r"coframe\[(\d+), (\d+)\]:?\s*")
_FUNCTION = re.compile(r"([^\W0-9]\w*)\s*\(([^()]*)\)")
_SIGN = re.compile(r"[+-]1?|1")
_ROW = re.compile(r"\b([Rr]ow) (\d+)")


def tetrad(
    coordinates: str,
    entries: Sequence[Sequence[str]],
    parameters: str = "",
    signature: str = "",
    show: Sequence[str] = USUAL,
    functions: str = "",
    language: str = ENGLISH,
) -> Json:
    """The geometry of a typed coframe as HTML, or the errors of its entries.

    Parameters
    ----------
    coordinates, parameters
        Names separated by commas or blanks; parameters are assumed to be positive.
    entries
        e[i][mu] as text; rows are one-forms.
    signature
        One sign for each frame vector, such as "-+++"; all + if empty.
    show
        Names of quantities.
    functions
        Unknown functions with their arguments, such as ``a(t), f(r, theta)``.
    language
        of headings and buttons.

    Returns
    -------
    html: cards, empty after an error. errors: "i,mu" -> the error of this entry,
    where i and mu count from 0; messages count rows from 1, as the page does.
    problem: the error of the whole input, if no single entry causes it.

    Examples
    --------
    >>> found = tetrad("r, phi", [["1", "0"], ["0", "r"]], show=["torsion"])
    >>> found["errors"], "<mfrac>" in found["html"]
    ({}, True)
    >>> tetrad("r, phi", [["1", "0"], ["0", "rr"]])["errors"]["1,1"].splitlines()[0]
    'rr is neither a coordinate nor a declared parameter'
    >>> tetrad("t, x", [["1", "0"], ["0", "a(t)"]], functions="a(t)")["errors"]
    {}
    """
    errors: dict[str, str] = {}
    try:
        names, constants = names_of(coordinates, "coordinates"), names_of(parameters, "parameters")
        _check_names(names, constants)
        symbols = {name: sp.Symbol(name, real=True) for name in names}
        symbols |= {name: sp.Symbol(name, positive=True) for name in constants}
        signs = signs_of(signature, len(names))
        unknown = functions_of(functions, symbols)
        rows = _read(entries, symbols, unknown, errors)
        if errors:
            return {"html": "", "errors": errors}
        frame = Frame(
            [symbols[name] for name in names],
            rows,
            signature=signs,
            parameters=[symbols[name] for name in constants],
            name="your tetrad",
        )
        return {"html": _cards(frame, show, language), "errors": {}}
    except GeomtorsionError as error:
        place = _PLACE.match(str(error))
        if place:
            text = from_one(str(error)[place.end() :])
            return {"html": "", "errors": {f"{place[1]},{place[2]}": text}}
        return {"html": "", "errors": errors, "problem": from_one(str(error))}


def from_one(message: str) -> str:
    """A message of the library, with indices counted from 1 instead of 0.

    Examples
    --------
    >>> from_one("Row 1 equals (2) * row 0 (rows counted from 0). coframe[0, 1] is odd.")
    'Row 2 equals (2) * row 1. row 1, column 2 is odd.'
    """
    counted = _ROW.sub(lambda m: f"{m[1]} {int(m[2]) + 1}", message)
    counted = _PLACE.sub(
        lambda m: f"row {int(m[1]) + 1}, column {int(m[2]) + 1}{m[0][m[0].index(']') + 1 :]}",
        counted,
    )
    # The page has no such option.
    counted = counted.replace("declare it with complex=True", _REAL)
    return counted.replace(" (rows counted from 0)", "")


def functions_of(text: str, symbols: Mapping[str, sp.Symbol]) -> dict[str, sp.Expr]:
    """Unknown functions in a line of text, by name.

    Raises
    ------
    CoordinateError
        A part of it is not a function of coordinates and parameters, or a name is taken.

    Examples
    --------
    >>> t, r = sp.symbols("t r", real=True)
    >>> functions_of("a(t), f(t, r)", {"t": t, "r": r})
    {'a': a(t), 'f': f(t, r)}
    """
    functions: dict[str, sp.Expr] = {}
    rest = re.sub(r"[,;\s]+", "", _FUNCTION.sub("", text))
    if rest:
        raise CoordinateError(
            f"unknown functions: expected functions with arguments, got {rest[:40]!r}. Write each "
            "with the variables on which it depends: a(t), f(r, theta)."
        )
    for name, inside in _FUNCTION.findall(text):
        arguments = names_of(inside, f"unknown function {name[:20]}")
        strange = [argument for argument in arguments if argument not in symbols]
        if not arguments or strange:
            raise CoordinateError(
                "unknown functions: expected coordinates or parameters as arguments of "
                f"{name[:20]}, got {', '.join(strange)[:40] or 'none'}. Choose from: "
                f"{', '.join(symbols)}."
            )
        if name in symbols or name in functions:
            raise CoordinateError(
                f"unknown functions: expected different names for coordinates, parameters and "
                f"functions, got {name[:20]} twice. Rename one of them."
            )
        [checked] = names_of(name, "unknown functions")
        functions[checked] = sp.Function(checked)(*(symbols[argument] for argument in arguments))
    return functions


def names_of(text: str, what: str = "names") -> list[str]:
    """Names in a line of text.

    Raises
    ------
    CoordinateError
        A part of it is not a name.

    Examples
    --------
    >>> names_of("t, r theta")
    ['t', 'r', 'theta']
    """
    names = [name for name in re.split(r"[,\s]+", text.strip()) if name]
    for name in names:
        if not _NAME.fullmatch(name) or len(name) > PAGE.name:
            raise CoordinateError(
                f"{what}: expected names, got {name[:40]!r}. Begin each name with a letter, "
                f"use at most {PAGE.name} letters and digits, and separate names by commas: r, "
                "theta, phi1."
            )
    return names


def names_like(text: str, most: int) -> list[str]:
    """A name for each word, x1, x2, ... if it is not a name; one name for an empty text.

    Examples
    --------
    >>> names_like("r, <b>", 6), names_like("", 6)
    (['r', 'x2'], ['x1'])
    """
    words = [name for name in re.split(r"[,\s]+", text.strip()) if name][:most] or [""]
    return [
        name if _NAME.fullmatch(name) and len(name) <= PAGE.name else f"x{k}"
        for k, name in enumerate(words, 1)
    ]


def signs_of(text: str, dimension: int) -> tuple[int, ...] | None:
    """One sign per frame vector, written as signs or as numbers 1 and -1; None for all plus.

    Raises
    ------
    SignatureError
        A character is neither + nor -, or there is not one sign for each frame vector.

    Examples
    --------
    >>> signs_of("- + + +", 4), signs_of("[-1, 1, 1]", 3)
    ((-1, 1, 1, 1), (-1, 1, 1))
    """
    plain = re.sub(r"[\s,;()\[\]]", "", unicodedata.normalize("NFKC", text).replace("−", "-"))
    if not plain:
        return None
    signs = ["-" if "-" in sign else "+" for sign in _SIGN.findall(plain)]
    if _SIGN.sub("", plain) or len(signs) != dimension:
        raise SignatureError(
            f"signature: expected {dimension} signs + or -, one for each row, got {text[:40]!r}. "
            f"Write {'-' + '+' * (dimension - 1)} or {'+' * dimension}."
        )
    return tuple(1 if sign == "+" else -1 for sign in signs)


def _check_names(names: Sequence[str], constants: Sequence[str]) -> None:
    if not names:
        raise CoordinateError(
            "coordinates: expected at least one name, got none. Write names, such as r, phi."
        )
    if len(names) > PAGE.dimensions:
        raise LimitError(
            f"coordinates: expected at most {PAGE.dimensions}, got {len(names)}. Use "
            "`geomtorsion report FILE.toml` for more."
        )
    every = [*names, *constants]
    twice = next((name for name in every if every.count(name) > 1), None)
    if twice:
        raise CoordinateError(
            f"expected different names for coordinates and parameters, got {twice} twice. Rename "
            "one of them."
        )


def _read(
    entries: Sequence[Sequence[str]],
    symbols: dict[str, sp.Symbol],
    functions: Mapping[str, sp.Expr],
    errors: dict[str, str],
) -> list[list[sp.Expr]]:
    """All entries as expressions; the error of an unreadable entry is stored under its index."""
    rows = []
    for i, row in enumerate(entries):
        rows.append([])
        for k, text in enumerate(row):
            where = f"coframe[{i}, {k}]"
            try:
                value = read_typed(text, symbols, functions, where)
            except GeomtorsionError as error:
                errors[f"{i},{k}"] = from_one(_PLACE.sub("", str(error), count=1))
                continue
            rows[-1].append(value)
    return rows


def _cards(frame: Frame, show: Sequence[str], language: str) -> str:
    """All requested quantities, by section."""
    # Sections take a space; a typed frame becomes a space without story or source.
    space = Space("your tetrad", "your tetrad", frame=frame)
    chosen = chosen_quantities(space, [name for name in OFFERED if name in show] or USUAL)
    parts = []
    text = texts("figures", "quantities", language)
    for heading, shown in zip(SECTIONS, text.table("sections").values(), strict=True):
        group = [_card(one, text) for one in chosen if one.entry.section == heading]
        if group:
            parts.append(f"<h3>{escape(shown)}</h3>{''.join(group)}")
    return "".join(parts)


def _card(quantity: Quantity, text: Texts) -> str:
    """A section with a button that copies its formulas."""
    title = text(quantity.entry.name)
    button = views.copy_button(aligned(quantity), title, text.language)
    shown = section(quantity, title, text.of("notes"))
    return shown.removesuffix("</section>") + f"{button}</section>"

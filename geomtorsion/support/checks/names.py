"""Names: converters of names, texts, paths, mappings and instances, and what messages show.

Every converter takes the value, its name in messages ("radius", "start[2]") and the class of the
error. It returns the value in one type or raises "subject: expected X, got Y. What to do".

expected: the X, where the usual one does not fit. remedy: what to do.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from difflib import get_close_matches
from os import PathLike
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from geomtorsion.errors import LONGEST_SHOWN, ArgumentError, GeomtorsionError

ErrorClass = type[GeomtorsionError]
Kind = TypeVar("Kind", bound=object)
Word = TypeVar("Word", str, int)

# Entries of a long list that a message shows, the first number with which it is short enough.
SHOWN_ENTRIES = (8, 4, 2, 1)
# Remedy where a zero cannot be decided.
KNOWN_IDENTITIES = "Use functions whose identities the library knows (roots, sin, exp, ...)."
_SMALL: dict[str, str] = dict(
    zip(
        "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho "
        "sigma tau upsilon phi chi psi omega".split(),
        "αβγδεζηθικλμνξοπρστυφχψω",
        strict=True,
    )
)
# Name -> Greek letter, small and capital.
GREEK = _SMALL | {name.capitalize(): letter.upper() for name, letter in _SMALL.items()}


def text(
    value: object,
    subject: str,
    error: ErrorClass,
    *,
    longest: int = 10**6,
    expected: str = "text",
    remedy: str = "",
) -> str:
    """A text up to a maximal length.

    Examples
    --------
    >>> from geomtorsion.errors import SceneError
    >>> text(3, "name", SceneError)
    Traceback (most recent call last):
    geomtorsion.errors.SceneError: name: expected text, got 3.
    """
    if isinstance(value, str) and len(value) <= longest:
        return value
    refuse(error, subject, expected, value, remedy)


def choice(
    value: object, words: Sequence[Word], subject: str, error: ErrorClass, *, remedy: str = ""
) -> Word:
    """One of a few words or numbers.

    Examples
    --------
    >>> from geomtorsion.errors import LoopError
    >>> choice("lines", ["line", "flux"], "method", LoopError)
    Traceback (most recent call last):
    geomtorsion.errors.LoopError: method: expected one of line, flux, got 'lines'.
    >>> choice(1.0, [2, 4], "order", LoopError)
    Traceback (most recent call last):
    geomtorsion.errors.LoopError: order: expected one of 2, 4, got 1.0.
    """
    is_one = isinstance(value, str) or not (isinstance(value, bool) or hasattr(value, "__len__"))
    for word in words if is_one else ():
        if value == word:
            return word
    refuse(error, subject, f"one of {', '.join(map(str, words))}", value, remedy)


def known_name(
    name: object,
    known: Iterable[str],
    subject: str,
    error: ErrorClass,
    *,
    expected: str = "a known name",
    remedy: str = "",
) -> str:
    """A name out of a set, which the message lists after the name that was probably meant.

    Symbols count by their names.

    Examples
    --------
    >>> from geomtorsion.errors import StartError
    >>> known_name("omga", ["omega"], "start", StartError)
    Traceback (most recent call last):
    geomtorsion.errors.StartError: start: expected a known name, got 'omga'. Did you mean omega? \
There are omega.
    """
    words = list(known)
    name = str(name) if _is_symbol(name) else name
    if isinstance(name, str) and name in words:
        return name
    choices = f"{did_you_mean(name, words)}There are {', '.join(words) or 'none'}."
    refuse(error, subject, expected, name, f"{choices} {remedy}".rstrip())


def known_keys(
    values: object,
    known: Iterable[str],
    subject: str,
    error: ErrorClass,
    *,
    expected: str = "a known name",
) -> dict[str, Any]:
    """A mapping whose keys are all known, by name; see `known_name`.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.errors import StartError
    >>> known_keys({sp.Symbol("M"): 1}, ["M", "a"], "parameters", StartError)
    {'M': 1}
    """
    named = labelled(values)
    if named is None:
        refuse(error, subject, "names with values", values)
    words = list(known)
    for key in named:
        known_name(key, words, subject, error, expected=expected)
    return by_name(named, subject, error)


def labelled(values: object) -> dict[Any, Any] | None:
    """Values that have names, by name: a mapping, a pandas Series or table, a record; else None.

    Lists, arrays, and a Series without names are not labelled.

    Examples
    --------
    >>> import numpy as np
    >>> labelled({"r": 1}), labelled([1])
    ({'r': 1}, None)
    >>> labelled(np.array([(1, 2)], dtype=[("r", int), ("phi", int)]))["phi"]
    array([2])
    """
    if isinstance(values, Mapping):
        return dict(values)
    # pandas and xarray are optional: tables are recognised by their keys.
    table: Any = values
    names = getattr(getattr(table, "dtype", None), "names", None)
    if names is None and hasattr(type(table), "keys"):
        names = list(table.keys())
    if not names or not all(isinstance(name, str) for name in names):
        return None
    return {name: table[name] for name in names}


def table(values: object, subject: str, error: ErrorClass = ArgumentError) -> dict[Any, Any]:
    """A mapping as a dictionary; empty for None.

    Examples
    --------
    >>> table(None, "parameters"), table({"M": 1}, "parameters")
    ({}, {'M': 1})
    """
    if values is None:
        return {}
    named = labelled(values)
    if named is None:
        refuse(error, subject, "names with values", values)
    return named


def by_name(values: object, subject: str, error: ErrorClass = ArgumentError) -> dict[str, Any]:
    """A mapping with names for keys: symbols count by theirs; no name may come twice.

    Examples
    --------
    >>> import sympy as sp
    >>> by_name({sp.Symbol("M"): 1, "a": 2}, "at")
    {'M': 1, 'a': 2}
    >>> by_name({sp.Symbol("M"): 1, "M": 2}, "at")
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: at: expected M once, got Symbol('M') and 'M'. Give one.
    """
    table_by_name: dict[str, Any] = {}
    keys: dict[str, object] = {}
    for key, value in table(values, subject).items():
        if not (isinstance(key, str) or hasattr(key, "name") or getattr(key, "free_symbols", ())):
            refuse(error, subject, "names as keys", key, "Give text or symbols.")
        name = key if isinstance(key, str) else getattr(key, "name", str(key))
        if name in keys:
            raise error(
                f"{subject}: expected {cut(name)} once, got {_written(keys[name])} and "
                f"{_written(key)}. Give one."
            )
        table_by_name[name], keys[name] = value, key
    return table_by_name


def check_values(
    names: Iterable[str], values: Collection[str], subject: str, error: ErrorClass, remedy: str
) -> None:
    """Refuse names without a value.

    remedy: may use ``{missing}``, the first name without one.

    Examples
    --------
    >>> from geomtorsion.errors import StartError
    >>> check_values(["M", "a"], {"M": 1}, "parameters", StartError, "Give it.")
    Traceback (most recent call last):
    geomtorsion.errors.StartError: parameters: expected a value for a, got none. Give it.
    """
    missing = [name for name in names if name not in values]
    if missing:
        wanted = f"a value for {', '.join(missing)}"
        raise error(sentence(subject, wanted, "none", remedy.replace("{missing}", missing[0])))


def instance(
    value: object,
    kind: type[Kind],
    subject: str,
    error: ErrorClass = ArgumentError,
    *,
    expected: str = "",
    remedy: str = "",
) -> Kind:
    """An instance of a class, such as a frame; the message names the class.

    Examples
    --------
    >>> import sympy as sp
    >>> instance([1], sp.Symbol, "symbol")
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: symbol: expected a Symbol, got [1].
    """
    if isinstance(value, kind):
        return value
    article = "an" if kind.__name__[0] in "AEIOU" else "a"
    refuse(error, subject, expected or f"{article} {kind.__name__}", value, remedy)


def file_name(value: object, subject: str = "path", error: ErrorClass = ArgumentError) -> Path:
    """The name of a file or a folder.

    Examples
    --------
    >>> file_name("a.npz").name
    'a.npz'
    >>> file_name(None)
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: path: expected the name of a file, got None.
    """
    name = value.__fspath__() if isinstance(value, PathLike) else value
    if isinstance(name, str):
        return Path(name)
    refuse(error, subject, "the name of a file", value)


# -- names that may have been meant ---------------------------------------------------------------


def close_names(name: str, known: Iterable[str], most: int = 1, cutoff: float = 0.65) -> list[str]:
    """Known names that may have been meant, the likeliest first.

    Examples
    --------
    >>> close_names("kerr_schildd", ["kerr", "kerr_schild", "flat"], most=2)
    ['kerr_schild']
    """
    # Long texts are not misspelt names, and would take long to compare.
    return get_close_matches(name[:LONGEST_SHOWN], list(known), n=most, cutoff=cutoff)


def near_names(name: object, known: Iterable[str]) -> str:
    """Return the known name that was probably meant, or an empty text.

    Examples
    --------
    >>> near_names("thetta", ["r", "theta", "phi"])
    'theta'
    >>> near_names("θ", ["r", "theta", "phi"])
    'theta'
    >>> near_names("Ω", ["Omega"])
    'Omega'
    >>> near_names("banana", ["r", "theta", "phi"])
    ''
    """
    known = list(known)
    if not isinstance(name, str):
        return ""
    for candidate in known:
        if candidate.lower() == name.lower():
            return candidate
        if GREEK.get(candidate) == name or GREEK.get(name) == candidate:
            return candidate
    return next(iter(close_names(name, known)), "")


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """The question "Did you mean ...? " with a space behind it, or an empty text.

    Examples
    --------
    >>> did_you_mean("thetta", ["theta"])
    'Did you mean theta? '
    """
    near = near_names(name, known)
    return f"Did you mean {near}? " if near else ""


# -- what messages show ---------------------------------------------------------------------------


def refuse(
    error: ErrorClass,
    subject: str,
    expected: str,
    value: object,
    remedy: str = "",
) -> NoReturn:
    """Raise "subject: expected X, got Y. What to do".

    Examples
    --------
    >>> refuse(ArgumentError, "step", "two numbers", [1], "Give both.")
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: step: expected two numbers, got [1]. Give both.
    """
    raise error(sentence(subject, expected, shown(value), remedy)) from None


def sentence(subject: str, expected: str, got: object, remedy: str = "") -> str:
    """The text of a refusal; the value is described in words.

    Examples
    --------
    >>> sentence("rows", "3 rows", 2, "Give one for each leg.")
    'rows: expected 3 rows, got 2. Give one for each leg.'
    """
    start = f"{subject}: " if subject else ""
    return f"{start}expected {expected}, got {got}. {remedy}".rstrip()


def cut(text: str, most: int = LONGEST_SHOWN) -> str:
    """A text, shortened for a message.

    Examples
    --------
    >>> cut("abcdefgh", 6), cut("abc", 6)
    ('abc...', 'abc')
    """
    return text if len(text) <= most else f"{text[: most - 3]}..."


def shown(value: object) -> str:
    """A value in one line of at most 200 characters for a message; never an error of its own.

    Long arrays and tables are described by their shape and long lists by their first entries. An
    object that prints several lines is shown by its first line.

    Examples
    --------
    >>> shown("r"), len(shown("r" * 10**6))
    ("'r'", 200)
    >>> shown(list(range(1000)))
    '[0, 1, 2, 3, 4, 5, 6, 7, ...] (1000 entries)'
    """
    try:
        return cut(_one_line(value))
    except Exception:  # noqa: BLE001
        # A whole number of 5,000 digits has no repr, and __repr__ of others may do anything.
        return f"a value of type {type(value).__name__}"


def _one_line(value: object) -> str:
    """The repr of a value without line breaks, or a description where it is long."""
    if isinstance(value, str | bytes):
        # The beginning of a long text is enough; its repr would be as long as the text.
        return repr(value[: LONGEST_SHOWN + 1])
    kind = type(value).__name__
    if isinstance(value, list | tuple | dict | set | frozenset):
        whole = "" if len(value) > LONGEST_SHOWN else _joined(repr(value))
        if 0 < len(whole) <= LONGEST_SHOWN:
            return whole
        if isinstance(value, list | tuple):
            for count in SHOWN_ENTRIES:
                first = _joined(repr(value[:count]))
                entries = f"{first[:-1].rstrip(',')}, ...{first[-1]} ({len(value)} entries)"
                if len(entries) <= LONGEST_SHOWN:
                    return entries
        return f"a {kind} of length {len(value)}"
    text, shape = repr(value), getattr(value, "shape", None)
    if not isinstance(shape, tuple):
        return text.strip().partition("\n")[0]
    whole = _joined(text)
    if len(whole) <= LONGEST_SHOWN and ("\n" not in text or text.startswith(("array", "Matrix"))):
        return whole
    # Tables print their names of rows and columns, which are of no use in one line.
    return f"an array of shape {shape}" if kind == "ndarray" else f"a {kind} of shape {shape}"


def _joined(text: str) -> str:
    """A text of several lines in one, without the blanks that indent lines."""
    return " ".join(line.strip() for line in text.splitlines())


def _written(key: object) -> str:
    """A key as text, with the assumptions of a symbol."""
    if not _is_symbol(key):
        return shown(key)
    # Whoever has a symbol has loaded sympy; help texts do not wait for it.
    from sympy import srepr

    return cut(srepr(key))


def _is_symbol(value: object) -> bool:
    """Whether a value is a symbol of sympy."""
    return getattr(value, "is_Symbol", False) is True

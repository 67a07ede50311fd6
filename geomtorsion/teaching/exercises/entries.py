"""Entries: components from one text, as a table of indices or as nested lists, however written."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.support.checks import cut
from geomtorsion.teaching.exercises.limits import MOST
from geomtorsion.teaching.exercises.signs import plain_signs

if TYPE_CHECKING:
    from geomtorsion.teaching.exercises.compare import Index
    from geomtorsion.teaching.exercises.question import Question

# Between components, and between equations.
SEPARATOR = re.compile(r"[;\n]|\band\b")
_OPEN, _CLOSE = "([{", ")]}"
_WRAPPED = re.compile(r"(?:[\w.]*\b)?(?:Matrix|matrix|array|vector|Vector)\s*\((.*)\)", re.DOTALL)
_DIAGONAL = re.compile(r"diag\s*\((.*)\)", re.DOTALL)
_LISTED = re.compile(r"\s*[\[({]|\s*\w*(?:Matrix|array|diag)\s*\(")
_MARKED = re.compile(r"([_^]?)\s*(\{[^{}]*\}|\([^()]*\)|\[[^\[\]]*\]|[^\s,_^{}()\[\]]+)")
_PAIR = re.compile(r"(['\"])([^'\"]*)\1\s*:\s*(?:(['\"])([^'\"]*)\3|([^,{}]*))")


def table_or_list(question: Question, text: str, where: str) -> object:
    """A table index -> text, or nested lists of texts; a single expression remains text.

    Raises
    ------
    ExpressionError
        A bracket is not closed, or a part does not name a component.
    LimitError
        It is too long, or too many lists are nested.
    """
    check_length(text, where)
    text = _without_label(question, _as_equations(_with_signs(text, where).strip()))
    if "=" in text:
        return _table(question, text, where)
    diagonal, wrapped = _DIAGONAL.fullmatch(text), _WRAPPED.fullmatch(text)
    if diagonal and len(question.shape) == 2:
        entries = split_outside(diagonal[1], ",")
        return {f"{k},{k}": entry for k, entry in enumerate(entries, 1)}
    if wrapped:
        # Maxima writes its rows side by side: matrix([1, 0], [0, r]).
        text = wrapped[1].strip()
        text = f"[{text}]" if text.startswith("[") and _inside(text) is None else text
    if text.startswith("["):
        return nested(question, text, where)
    if text == "0":
        return 0
    return _bare(question, text, where)


def _as_equations(text: str) -> str:
    """A table of other programs with the signs of equations."""
    text = text.replace("==", "=").replace(":=", "=")
    if text.startswith("{") and _PAIR.search(text):
        # A dictionary of Python: {"1,1": "r"}.
        return "; ".join(f"{m[2]} = {m[4] or m[5] or ''}" for m in _PAIR.finditer(text))
    return text if "=" in text else text.replace(":", "=")


def _without_label(question: Question, text: str) -> str:
    """A list or matrix without the name of the quantity in front of it."""
    label, sign, rest = text.partition("=")
    is_list = sign and "=" not in rest and _LISTED.match(rest)
    return rest.strip() if is_list and _is_name(question, label) else text


def check_length(text: str, where: str) -> None:
    """Refuse an answer that is too long.

    Raises
    ------
    LimitError
        It has more than MOST.characters characters.
    """
    if len(text) > MOST.characters:
        raise LimitError(
            f"{where}: expected at most {MOST.characters:,} characters, got {len(text):,}. "
            "Write it shorter."
        )


def _with_signs(text: str, where: str) -> str:
    """Text in keyboard signs; each entry is read separately later."""
    return plain_signs(text, where) if "\\" in text or not text.isascii() else text


def _is_name(question: Question, label: str) -> bool:
    """Whether the text before = names the tensor, such as g or Gamma_ab^c, not a component."""
    try:
        index(question, label, "")
    except ExpressionError:
        return bool(re.search(r"[^\W\d]", label))
    return False


def _table(question: Question, text: str, where: str) -> dict[str, str]:
    """Index -> text, from index = value between semicolons, line ends or commas."""
    table: dict[str, str] = {}
    for line in SEPARATOR.split(text):
        if not line.strip(" ,"):
            continue
        for key, value in _pairs(question, line.strip(" ,")):
            if not value:
                raise ExpressionError(
                    f"{where}: expected index = value, got {line.strip()[:60]!r}. Separate "
                    "components by semicolons."
                )
            if key in table:
                raise ExpressionError(
                    f"{where}: expected each component once, got {key[:60]} twice. Remove one of "
                    "them."
                )
            table[key] = value
    return table


def _pairs(question: Question, line: str) -> Iterator[tuple[str, str]]:
    """Pairs of a line; if there are several, the last comma before an index separates them."""
    first, *pieces = line.split("=")
    key = first.strip()
    several = len(pieces) > 1
    for piece in pieces[:-1]:
        value, following = _parted(question, piece)
        yield key, value.strip()
        key = following.strip()
    yield key, pieces[-1].strip() if pieces else ""
    if several and not key:
        yield "", ""


def _parted(question: Question, piece: str) -> tuple[str, str]:
    """A value and the index of the next component."""
    parts = split_outside(piece, ",")
    # The fewest parts that make an index: 0, 1,2,1 with three indices, x, b2 with a name.
    for count in range(1, len(parts)):
        following = ",".join(parts[-count:])
        try:
            index(question, following, "")
        except ExpressionError:
            continue
        return ",".join(parts[:-count]), following
    return piece, ""


def split_outside(text: str, sign: str) -> list[str]:
    """Parts between signs that are outside of brackets.

    Examples
    --------
    >>> split_outside("a, f(b, c), d", ",")
    ['a', ' f(b, c)', ' d']
    """
    parts, depth, start = [], 0, 0
    for place, letter in enumerate(text):
        depth += (letter in _OPEN) - (letter in _CLOSE)
        if depth == 0 and letter == sign:
            parts.append(text[start:place])
            start = place + 1
    return [*parts, text[start:]]


def _bare(question: Question, text: str, where: str) -> object:
    """Entries with parentheses, curly brackets or none; a single expression remains text."""
    shape = question.shape
    whole = _inside(text)
    several = any(len(split_outside(text if whole is None else whole, sign)) > 1 for sign in ",;\n")
    if text.startswith("{") or (several and shape not in ((), (1,))):
        return nested(question, text if whole is not None else f"[{text}]", where)
    return text


def _inside(text: str) -> str | None:
    """The text between brackets that enclose the whole text; None if no brackets do."""
    text = text.strip()
    if not text or text[0] not in _OPEN or text[-1] != _CLOSE[_OPEN.index(text[0])]:
        return None
    depth = 0
    for place, letter in enumerate(text):
        depth += (letter in _OPEN) - (letter in _CLOSE)
        if depth == 0 and place < len(text) - 1:
            return None
    return text[1:-1] if depth == 0 else None


def nested(question: Question, text: str, where: str) -> list[object]:
    """Nested lists of texts from brackets of any kind; rows may end with semicolons.

    Raises
    ------
    ExpressionError
        The brackets do not pair up.
    LimitError
        Lists are nested more deeply than any question needs.
    """
    depth = deepest = 0
    for letter in text:
        depth += (letter in "[{") - (letter in "]}")
        deepest = max(deepest, depth)
        if depth < 0:
            raise ExpressionError(
                f"{where}: expected a bracket [ before each bracket ], got none. Write [[a, b], "
                "[c, d]]."
            )
    # No tensor here has more indices; deeper lists are meant to exhaust the reader.
    if deepest > MOST.levels:
        raise LimitError(
            f"{where}: expected at most {MOST.levels} nested lists, got {deepest}. Write one level "
            "for each index."
        )
    inner = _inside(text)
    if depth or inner is None:
        raise ExpressionError(
            f"{where}: expected a bracket ] for each bracket [, got {cut(text, 40)!r}. Write "
            "[[a, b], [c, d]]."
        )
    return _listed(question, inner, 0)


def _listed(question: Question, text: str, level: int) -> list[object]:
    """The entries of a list, at a level of nesting from 0."""
    if not text.strip():
        return []
    rank = len(question.shape)
    separator = next((sign for sign in ";\n" if len(split_outside(text, sign)) > 1), ",")
    parts = [part.strip() for part in split_outside(text, separator)]
    if separator != "," and level < rank - 1 and not any(map(_inside, parts)):
        return [_listed(question, row, level + 1) for row in parts if row]
    spaced = text.split()
    if len(parts) == 1 and level == rank - 1 and len(spaced) == question.shape[-1] > 1:
        parts = spaced
    parts = parts[:-1] if parts and not parts[-1] else parts
    return [_entry(question, part, level) for part in parts]


def _entry(question: Question, text: str, level: int) -> object:
    """One entry of a list at a level: a list as well, or a text."""
    inner = _inside(text)
    if inner is None or level >= MOST.levels:
        return _unquoted(text)
    is_list = text[0] in "[{" or len(split_outside(inner, ",")) > 1
    return _listed(question, inner, level + 1) if is_list else _unquoted(text)


def _unquoted(text: str) -> str:
    """An entry without the quotes around it; a prime at its end remains."""
    return text[1:-1] if len(text) > 1 and text[0] == text[-1] and text[0] in "\"'" else text


def index(question: Question, key: object, where: str) -> Index:
    """Indices counted from 0, from a text that counts from 1 or names coordinates.

    ``1,2,1``, ``121``, ``Gamma_12^1``, ``Gamma^1_12``, ``Gamma[1, 2, 1]``, ``b1`` and
    ``phi1,phi2,phi1`` are all accepted. With upper indices, the lower ones fill the lower slots.

    Raises
    ------
    ExpressionError
        It is not an index, has too many or too few parts, or is out of range.
    """
    text = _with_signs(str(key)[:200], where)
    rank, marks = len(question.shape), question.marks
    try:
        below, above, indices = _marked(question, _without_head(question, text), where)
    except ExpressionError:
        # A text that looks like a name before indices may be the first index.
        below, above, indices = _marked(question, text, where)
    if above and marks and len(indices) == rank:
        if (len(below), len(above)) != (marks.count("_"), marks.count("^")):
            raise ExpressionError(
                f"{where}: expected {marks.count('_')} lower and {marks.count('^')} upper indices, "
                f"got {len(below)} and {len(above)} in {text!r}. Write {_example(question)}."
            )
        lower, upper = iter(below), iter(above)
        indices = [next(lower) if mark == "_" else next(upper) for mark in marks]
    if len(indices) != rank:
        raise ExpressionError(
            f"{where}: expected {rank} indices, got {len(indices)} in {text!r}. Write "
            f"{_example(question)}."
        )
    for k, (number, size) in enumerate(zip(indices, question.shape, strict=True)):
        if number >= size or (number < 0 and number != -1):
            raise ExpressionError(
                f"{where}: expected an index from 1 to {size}, got {number + 1} as index {k + 1} "
                f"of {text!r}. Write {_example(question)}."
            )
    return tuple(indices)


def is_part(question: Question, key: object) -> bool:
    """Whether a key of a table names a component or an unknown of a question.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises import load
    >>> [is_part(load("2.1").questions[0], key) for key in ("1,2,2", "conection")]
    [True, False]
    """
    if question.unknowns:
        return "'" in str(key) or "_d" in str(key)
    try:
        return bool(question.shape) and bool(index(question, key, ""))
    except ExpressionError:
        return False


def _without_head(question: Question, text: str) -> str:
    """The indices after a name, as in Gamma_12^1, b1 or 2S[1,2,1]."""
    head = re.match(r"\s*[0-9]?\s*[^\W\d][^\[({_^,]*(?=[\[({_^])", text)
    if head:
        return text[head.end() :].replace("_^", "^")
    numbered = re.fullmatch(r"\s*[^\W\d]+([0-9]+)\s*", text)
    fits = numbered is not None and len(numbered[1]) == len(question.shape)
    return numbered[1] if numbered and fits and text.strip() not in question.domain.names else text


def _marked(question: Question, text: str, where: str) -> tuple[list[int], list[int], list[int]]:
    """Indices below, above, and all in the order in which they are written."""
    rank = len(question.shape)
    parts = [
        (mark, part)
        for mark, group in _MARKED.findall(text)
        for part in re.split(r"[\s,]+", group.strip("{}()[] ")) if part
    ]  # fmt: skip
    whole = sum(len(part) for _, part in parts) == rank and all(p.isdigit() for _, p in parts)
    below, above, written = [], [], []
    for mark, part in parts:
        letters = list(part) if whole else _coordinates(question, part) or [part]
        for letter in letters:
            number = _number(question, letter, len(written), where)
            written.append(number)
            (above if mark == "^" else below).append(number)
    return below, above, written


def _number(question: Question, part: str, place: int, where: str) -> int:
    """One index, counted from 0."""
    names, symbols = question.domain.names, list(question.domain.symbols)
    if part.isdecimal() and len(part) < 4:
        return int(part) - 1
    if part in names:
        return symbols.index(names[part])
    raise ExpressionError(
        f"{where}: expected a number or a coordinate as index {place + 1}, got "
        f"{part!r}. Write {_example(question)}."
    )


def _coordinates(question: Question, part: str) -> list[str]:
    """Coordinates written side by side, such as rphi; empty if the text is anything else."""
    names, rest = [], part
    while rest:
        head = next(
            (name for name in sorted(question.domain.names, key=len, reverse=True)
             if rest.startswith(name)), "",
        )  # fmt: skip
        if not head or len(names) > MOST.levels:
            return []
        names.append(head)
        rest = rest[len(head) :]
    return names


def flat(given: list[object], shape: tuple[int, ...], where: str) -> list[tuple[Index, object]]:
    """Pairs (index, entry) of nested lists, which must have the shape of the question.

    Raises
    ------
    ExpressionError
        A list is too long or too short, or a list is missing.
    """
    if not shape or len(given) != shape[0]:
        needed = f"{' x '.join(map(str, shape))} components" if shape else "one expression"
        remedy = "Write all of them, zeros included." if shape else "Remove the brackets."
        raise ExpressionError(f"{where}: expected {needed}, got a list of {len(given)}. {remedy}")
    if len(shape) == 1:
        return [((k,), entry) for k, entry in enumerate(given)]
    pairs: list[tuple[Index, object]] = []
    for k, row in enumerate(given):
        if not isinstance(row, list):
            raise ExpressionError(
                f"{where}[{k + 1}]: expected a list, got {kind(row)}. Write one list for each row."
            )
        pairs += [((k, *key), x) for key, x in flat(row, shape[1:], f"{where}[{k + 1}]")]
    return pairs


def _example(question: Question) -> str:
    """A component as it may be written."""
    return ",".join("1" for _ in question.shape) + " = ... (indices from 1)"


def kind(value: object) -> str:
    """Description of an answer in a few words.

    Examples
    --------
    >>> kind([1]), kind(True), kind("x"), kind(2.5)
    ('a list', 'true', "'x'", 'the number 2.5')
    """
    if isinstance(value, str):
        return repr(cut(value, 40))
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"the number {cut(str(value), 40)}"
    names = {list: "a list", dict: "a table", type(None): "nothing"}
    return names.get(type(value), f"{type(value).__name__} {str(value)[:40]}")

"""messages: errors of the library in the language of a page, sentence by sentence."""

from __future__ import annotations

import re
from functools import lru_cache

from geomtorsion.teaching.texts import ENGLISH, texts

__all__ = ["in_language"]

# The tables of sentences; the others name a part of the input or introduce an English message.
_SENTENCES = ("parser", "answers", "tetrad", "motion", "maps", "page")
_PLACEHOLDER = re.compile(r"@\{([a-z_]+)\}")
# A part of the input, or the file, that a message names first.
_PLACE = re.compile(r"([\w .\-]{1,60}?)((?:\[[\d, ]+\])?): (?=\S)")
_END = re.compile(r"(?<=[.?]) (?=[A-Z`])")
# What a placeholder is in a sentence: no end of a sentence; in a value: a word or a bracket.
_NO_END = r"(?:(?![.?] [A-Z`]).)+?"
_WORD = r"\([^()]*\)|[^\s,;()]+"
_THOUSANDS = re.compile(r"[0-9]{1,3}(?:,[0-9]{3})+")


def in_language(message: str, language: str = ENGLISH, own: str = "") -> str:
    """A message of the library in another language.

    own: the name of a question, which stays. Quoted input, numbers and other names stay also.
    A message with a sentence that the language lacks stays English, after a note in the language.

    Examples
    --------
    >>> in_language("x[1]: division by zero\\n    1/0\\n      ^", "de").splitlines()[0]
    'x[1]: Division durch null'
    >>> in_language("t: expected a time.", "de")
    'Diese Meldung gibt es nur auf Englisch: t: expected a time.'
    """
    if language == ENGLISH or not message:
        return message
    lines = [
        line if line.startswith("    ") else _line(line, language, own)
        for line in message.split("\n")
    ]
    if None in lines:
        return texts("messages", "note", language)("english", message=message)
    return "\n".join(map(str, lines))


def _line(line: str, language: str, own: str) -> str | None:
    """A line in the language: whole sentences, perhaps after the place that it names."""
    written = _sentences(_END.split(line), language)
    place = _PLACE.match(line)
    if written is not None or place is None:
        return written
    rest = _line(line[place.end() :], language, own)
    name = place[1] if place[1] == own else _named(place[1], language)
    return None if rest is None else f"{name}{place[2]}: {rest}"


def _named(place: str, language: str) -> str:
    """A part of the input in the language, if the language has a word for it."""
    text = texts("messages", "places", language)
    words = {english: key for key, english in texts("messages", "places").table().items()}
    return text(words[place]) if place in words else place


def _sentences(parts: list[str], language: str) -> str | None:
    """Sentences in the language, as many of them at once as one of its texts covers."""
    if not parts:
        return ""
    for count in range(len(parts), 0, -1):
        first = _sentence(" ".join(parts[:count]), language)
        rest = None if first is None else _sentences(parts[count:], language)
        if rest is not None:
            return f"{first} {rest}".rstrip()
    return None


def _sentence(sentence: str, language: str) -> str | None:
    """A text with the values that the English sentence has in the places of its placeholders."""
    for pattern, table, key in _patterns(*_SENTENCES):
        match = pattern.fullmatch(sentence)
        if match is None:
            continue
        text = texts("messages", table, language)
        if not text.translated:
            return None
        return text(key, **{name: _value(x, language) for name, x in match.groupdict().items()})
    return None


def _value(value: str, language: str) -> str:
    """A value in the language; what a user typed is in quotes and stays."""
    if value[0] in "'\"":
        return value
    if _THOUSANDS.fullmatch(value):
        return value.replace(",", "\u202f")
    text = texts("messages", "values", language)
    for pattern, _, key in _patterns("values"):
        value = pattern.sub(lambda match, key=key: text(key, **match.groupdict()), value)
    return value


@lru_cache(maxsize=2)
def _patterns(*tables: str) -> tuple[tuple[re.Pattern[str], str, str], ...]:
    """A pattern for each English text, those with the most letters first."""
    rows = [
        (text, table, key)
        for table in tables
        for key, text in texts("messages", table).entries.items()
        if isinstance(text, str)
    ]
    rows.sort(key=lambda row: -len(_PLACEHOLDER.sub("", row[0])))
    return tuple((_pattern(text, table == "values"), table, key) for text, table, key in rows)


def _pattern(text: str, is_value: bool) -> re.Pattern[str]:
    """The pattern of what a text with placeholders describes."""
    parts, names = [], set[str]()
    for k, piece in enumerate(_PLACEHOLDER.split(text)):
        if k % 2 == 0:
            parts.append(re.escape(piece))
        else:
            inner = _WORD if is_value else _NO_END
            parts.append(f"(?P={piece})" if piece in names else f"(?P<{piece}>{inner})")
            names.add(piece)
    edge = r"(?<![^\W_])" if is_value else ""
    return re.compile(edge + "".join(parts))

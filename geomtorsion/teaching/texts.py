"""texts: the prose of exercises and of the page, from TOML files in a folder for each language."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import Any

from geomtorsion.errors import UnknownNameError
from geomtorsion.pictures.formula import fault
from geomtorsion.support import checks
from geomtorsion.support.files import TomlFile, read_text, read_toml_text

__all__ = [
    "ENGLISH",
    "FOLDER",
    "QUOTES",
    "Keys",
    "Language",
    "TextTable",
    "Texts",
    "argument_of",
    "code_of",
    "is_complete",
    "language_name",
    "languages",
    "own_texts",
    "placeholders",
    "texts",
    "texts_of",
    "untranslated",
    "with_values",
]

ENGLISH = "en"
FOLDER = Path(__file__).parent / "languages"
# The name of a language of the package, or a folder with texts.
Language = str | PathLike[str]
# A text, or several in order.
Entry = str | tuple[str, ...]
# The keys to a value of a file; a number is a place in a list of tables.
Keys = tuple[str | int, ...]
# A placeholder, the sign @ itself, or an @ that is neither.
_MARK = re.compile(r"@(?:\{([a-z][a-z0-9_]*)\}|(@))?")
QUOTES = "Put a text with backslashes between ''' and '''."
_LATEX = "Correct the formula; the page knows the commands of LaTeX and amsmath."
_FORM = "Write a placeholder as @{name}, with small letters, digits and _, and the sign @ as @@."


@dataclass(frozen=True, eq=False)
class Texts:
    """The texts below one heading of a file, in one language.

    name, heading: of the file without its ending, and of the table in it; "" for the texts above
    all tables. language: as requested. translated: whether that language has this heading; if not,
    the texts are English. file: for messages. entries: key -> text, or texts in order.

    Examples
    --------
    >>> text = texts("frames", "legs")
    >>> text("title"), text.all("hints", determinant="r")[-1]
    ('The legs of a coframe', 'Here the determinant is $r$.')
    """

    name: str
    heading: str
    language: str
    translated: bool
    file: TomlFile
    entries: Mapping[str, Entry]

    def __call__(self, key: str, /, **values: object) -> str:
        """The text of a key such as "legs.prompt", with a value for each of its placeholders.

        Raises
        ------
        FileFormatError
            There is no such text, or its placeholders have other names; the message names the line.
        """
        entry = self._entry(key, str)
        self._check(key, placeholders(entry), values)
        return with_values(entry, values)

    def all(self, key: str, /, **values: object) -> tuple[str, ...]:
        """The texts of a list, such as the hints; each value belongs to at least one of them."""
        entry = self._entry(key, tuple)
        self._check(key, placeholders(*entry), values)
        return tuple(with_values(text, values) for text in entry)

    def table(self, key: str = "") -> dict[str, str]:
        """The texts of a table by their names, such as the options of a choice, in order."""
        start = f"{key}." if key else ""
        names = (name.removeprefix(start) for name in self.entries if name.startswith(start))
        found = {name: self(f"{start}{name}") for name in names}
        return found or self.file.fail(self._path(key), f"expected a table {key}, got none.")

    def pairs(self, key: str) -> dict[str, str]:
        """The texts of a list of entries "word: meaning", by their words."""
        pairs = [text.partition(": ") for text in self.all(key)]
        for word, sign, _ in pairs:
            if not sign:
                self.file.fail(self._path(key), f"{key}: expected 'word: meaning', got {word!r}.")
        return {word: meaning for word, _, meaning in pairs}

    def named(self, table: str, name: str) -> str:
        """The text of a table for a name of the library; the name itself if the table has none.

        Examples
        --------
        >>> text = texts("figures", "paths", "de")
        >>> text.named("drawn", "on the sphere"), text.named("drawn", "x")
        ('Auf der Kugel', 'x')
        """
        key = f"{table}.{name}"
        return self(key) if key in self else name

    def __contains__(self, key: str) -> bool:
        return key in self.entries

    def of(self, heading: str, name: str = "") -> Texts:
        """The texts below another heading, of the same file by default."""
        return texts(name or self.name, heading, self.language)

    def _path(self, key: str) -> tuple[str, ...]:
        return tuple(part for part in (self.heading, *key.split(".")) if part)

    def _entry(self, key: str, kind: Callable[..., Any]) -> Any:
        entry = self.entries.get(key)
        if type(entry) is not kind:
            what = "a text" if kind is str else "a list of texts"
            self.file.fail(self._path(key), f"expected {what} {key!r}, got {_kind(entry)}.")
        return entry

    def _check(self, key: str, used: set[str], values: Mapping[str, object]) -> None:
        if used != values.keys():
            self.file.fail(self._path(key), f"{key}: {_differing(used, set(values))}")


class TextTable(Mapping[str, str]):
    """A table of texts that is read when it is first used.

    Examples
    --------
    >>> TextTable("feedback", "messages")["sign"]
    'The sign is wrong.'
    """

    def __init__(self, name: str, heading: str, language: str = ENGLISH) -> None:
        self.name, self.heading, self.language = name, heading, language

    def of(self, language: str) -> TextTable:
        """The same table in another language."""
        return TextTable(self.name, self.heading, language)

    def __getitem__(self, key: str) -> str:
        return self._table[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._table)

    def __len__(self) -> int:
        return len(self._table)

    @property
    def _table(self) -> Mapping[str, str]:
        return _table(self.name, self.heading, self.language)


@lru_cache(maxsize=256)
def _table(name: str, heading: str, language: str) -> Mapping[str, str]:
    return MappingProxyType(texts(name, heading, language).table())


def texts(name: str, heading: str, language: str = ENGLISH) -> Texts:
    """The texts below a heading; English where the language has no such file or heading.

    Raises
    ------
    FileFormatError
        A file of the language is not TOML, lacks a text, has one too many, or has a placeholder
        that the English text has not; the message names the line.
    UnknownNameError
        There is no such language.
    """
    own = None if language == ENGLISH else _read(name, language)
    if own is None or heading not in own[1]:
        file, headings = _english(name)
        if heading not in headings:
            file.fail((), f"expected a table [{heading}], got none.")
        return Texts(name, heading, language, language == ENGLISH, file, headings[heading])
    return Texts(name, heading, language, True, own[0], own[1][heading])


def texts_of(content: str, name: str, heading: str) -> Texts:
    """Texts that are given as the content of a file, for a file of one's own.

    Examples
    --------
    >>> text = texts_of("[cell]\\ntitle = 'A cell of size @{size}'", "cell.toml", "cell")
    >>> text("title", size=3)
    'A cell of size 3'
    """
    return own_texts(read_toml_text(content, name, advice=QUOTES), heading)


def own_texts(file: TomlFile, heading: str, table: Mapping[str, object] | None = None) -> Texts:
    """The texts below a heading of a file of one's own; by default all that is below it.

    Raises
    ------
    FileFormatError
        There is no such heading, a value is not a text, or a formula is not LaTeX; the message
        names the line.

    Examples
    --------
    >>> file = read_toml_text("[cell]\\nsize = 2\\ntitle = 'A cell'", "cell.toml")
    >>> own_texts(file, "cell", {"title": "A cell"})("title")
    'A cell'
    """
    if table is None:
        table = file.data.get(heading)
    if not isinstance(table, Mapping):
        file.fail((heading,), f"expected a table [{heading}], got {_kind(table)}.")
    entries: dict[str, Entry] = {}
    for path, value in _leaves((heading,), table):
        entries[".".join(map(str, path[1:]))] = _entry(file, path, value)
    return Texts(Path(file.name).stem, heading, ENGLISH, True, file, entries)


def _leaves(path: Keys, value: object) -> Iterator[tuple[Keys, object]]:
    """The values of a table and of the tables and lists of tables in it, with their keys."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves((*path, key), inner)
    elif isinstance(value, list) and value and all(isinstance(inner, Mapping) for inner in value):
        for place, inner in enumerate(value):
            yield from _leaves((*path, place), inner)
    else:
        yield path, value


def languages() -> tuple[str, ...]:
    """The languages of the package, English first; a language may lack some texts.

    Examples
    --------
    >>> languages()[0]
    'en'
    """
    own = sorted(path.name for path in FOLDER.iterdir() if path.is_dir())
    return (ENGLISH, *(name for name in own if name != ENGLISH))


def is_complete(language: Language) -> bool:
    """Whether a language promises, in its file language.toml, that none of its texts is English.

    Examples
    --------
    >>> is_complete("de"), is_complete("fr")
    (True, False)
    """
    text = texts("language", "language", language_name(language))
    return text.translated and text("complete") == "yes"


def untranslated(language: Language) -> tuple[str, ...]:
    """The tables of texts that a language lacks and shows in English.

    Examples
    --------
    >>> untranslated("de"), untranslated("fr")[0]
    ((), 'closure.toml title')
    """
    name = language_name(language)
    if name == ENGLISH:
        return ()
    lacking: list[str] = []
    for path in sorted((FOLDER / ENGLISH).glob("*.toml")):
        own = _read(path.stem, name)
        missing = set(_english(path.stem)[1]) - set(own[1] if own else ())
        tables = (f"[{heading}]" if heading else "title" for heading in sorted(missing))
        lacking += [f"{path.name} {table}" for table in tables]
    return tuple(lacking)


def language_name(language: Language) -> str:
    """A language of the package, or the absolute path of a folder with texts.

    Raises
    ------
    UnknownNameError
        It is neither, or the folder has a file with an unknown name.

    Examples
    --------
    >>> language_name("en")
    'en'
    """
    path = checks.file_name(language, "language", UnknownNameError)
    if str(path) in languages():
        return str(path)
    hint = checks.did_you_mean(str(path), languages())
    if not path.is_dir():
        raise UnknownNameError(
            f"language: expected {', '.join(languages())} or a folder with texts, got "
            f"{checks.shown(str(path))}. {hint}"
            "The page 'How to translate a chapter' of the site shows what such a folder holds."
        )
    known = sorted(file.name for file in (FOLDER / ENGLISH).glob("*.toml"))
    own = sorted(file.name for file in path.glob("*.toml"))
    for file in own:
        checks.known_name(file, known, f"language {path}", UnknownNameError)
    if not own:
        raise UnknownNameError(
            f"language: expected a folder with files of texts, got {path}, which has none. Copy a "
            f"file from {FOLDER.name}/{ENGLISH} of the package, such as {known[0]}."
        )
    return str(path.resolve())


def code_of(language: str) -> str:
    """The code of a language for the attribute lang of HTML: the name of its folder.

    Examples
    --------
    >>> code_of("/home/me/texts/fr")
    'fr'
    """
    return Path(language).name


def argument_of(language: str) -> str:
    """The argument of a call in a notebook, empty for English and for a folder.

    The notebook is run on other machines, which have the languages of the package only.

    Examples
    --------
    >>> argument_of("de"), argument_of("en"), argument_of("/home/me/texts/fr")
    (", language='de'", '', '')
    """
    return f", language={language!r}" if language in languages()[1:] else ""


def placeholders(*entries: str) -> set[str]:
    """Names of the placeholders of texts.

    Examples
    --------
    >>> sorted(placeholders("from @{first} to @{last}, by me@@home"))
    ['first', 'last']
    """
    return {match[1] for text in entries for match in _MARK.finditer(text) if match[1]}


def with_values(text: str, values: Mapping[str, object]) -> str:
    """A text with a value for each of its placeholders.

    Examples
    --------
    >>> with_values("r^(2*@{n})", {"n": 3})
    'r^(2*3)'
    """
    return _MARK.sub(lambda match: str(values[match[1]]) if match[1] else "@", text)


@lru_cache(maxsize=256)
def _english(name: str) -> tuple[TomlFile, Mapping[str, Mapping[str, Entry]]]:
    """An English file: the one that all translations follow."""
    file = _toml(FOLDER / ENGLISH / f"{name}.toml")
    return file, _headings(file)


@lru_cache(maxsize=256)
def _read(name: str, language: str) -> tuple[TomlFile, Mapping[str, Mapping[str, Entry]]] | None:
    """A file of another language, compared with the English one; None if there is none."""
    path = FOLDER / language_name(language) / f"{name}.toml"
    if not path.exists():
        return None
    file, (_, english) = _toml(path), _english(name)
    headings = _headings(file)
    for heading, entries in headings.items():
        if heading and heading not in english:
            file.unknown((heading,), [one for one in english if one], f"unknown table {heading}")
        _compare(file, heading, entries, english[heading])
    # In the English order, in which options are shown.
    return file, {
        heading: {key: entries[key] for key in english[heading]}
        for heading, entries in headings.items()
    }


def _toml(path: Path) -> TomlFile:
    return read_toml_text(read_text(path), f"{path.parent.name}/{path.name}", advice=QUOTES)


def _headings(file: TomlFile) -> dict[str, dict[str, Entry]]:
    """Heading -> key -> text; the texts above all tables have the heading ""."""
    headings: dict[str, dict[str, Entry]] = {}
    for key, value in file.data.items():
        if isinstance(value, dict):
            headings[key] = dict(_entries(file, (key,), value))
        else:
            headings.setdefault("", {})[key] = _entry(file, (key,), value)
    return headings


def _entries(
    file: TomlFile, path: tuple[str, ...], table: Mapping[str, object]
) -> Iterator[tuple[str, Entry]]:
    """The texts of a table and of the tables in it, by dotted keys without the heading."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _entries(file, (*path, key), value)
        else:
            yield ".".join((*path[1:], key)), _entry(file, (*path, key), value)


def _entry(file: TomlFile, path: Keys, value: object) -> Entry:
    """A text or a list of texts, each with its lines joined."""
    several: list[Any] = value if isinstance(value, list) else [value]
    name = ".".join(map(str, path))
    for text in several:
        if not isinstance(text, str) or not text.strip():
            file.fail(path, f"{name}: expected a text or a list of texts, got {_kind(value)}.")
        for match in _MARK.finditer(text):
            if match[0] == "@":
                start = text[match.start() : match.start() + 20]
                file.fail(path, f"{name}: expected a placeholder, got {start!r}. {_FORM}")
        # A placeholder counts as letters in braces, because a command may precede it.
        letters = {mark: f"{{{mark.replace('_', '')}}}" for mark in placeholders(text)}
        if wrong := fault(with_values(text, letters)):
            for mark, word in letters.items():
                wrong = wrong.replace(word, f"@{{{mark}}}")
            file.fail(path, f"{name}: expected LaTeX between dollar signs, but {wrong}. {_LATEX}")
    joined = tuple(_joined(text) for text in several)
    return joined if isinstance(value, list) else joined[0]


def _joined(text: str) -> str:
    """A text as Markdown reads it: a line continues the line before, up to a blank line or "- "."""
    lines = "\n".join(line.strip() for line in text.strip().splitlines())
    return re.sub(r"(?<!\n)\n(?!\n|- )", " ", re.sub(r"\n{3,}", "\n\n", lines))


def _compare(
    file: TomlFile, heading: str, own: Mapping[str, Entry], english: Mapping[str, Entry]
) -> None:
    """Refuse a translated table whose keys, lists or placeholders differ from the English ones."""
    above = (heading,) if heading else ()
    for key, entry in own.items():
        path, what = (*above, *key.split(".")), f"{heading}.{key}".strip(".")
        if key not in english:
            file.unknown(path, list(english), f"unknown text {what}")
        first = english[key]
        if _kind(entry) != _kind(first):
            file.fail(path, f"{what}: expected {_kind(first)} as in English, got {_kind(entry)}.")
        several, models = ((x,) if isinstance(x, str) else x for x in (entry, first))
        for text, model in zip(several, models, strict=True):
            used, allowed = placeholders(text), placeholders(model)
            if used != allowed:
                file.fail(path, f"{what}: {_differing(used, allowed)}")
    for key in english:
        if key not in own:
            path, what = (*above, *key.split(".")), f"{heading}.{key}".strip(".")
            file.fail(path, f"expected the text {what}, got none. Translate it from English.")


def _differing(used: set[str], allowed: set[str]) -> str:
    """The reason why placeholders do not fit."""
    shown = ", ".join(f"@{{{name}}}" for name in sorted(allowed)) or "no placeholder"
    extra, missing = sorted(used - allowed), sorted(allowed - used)
    if extra:
        hint = checks.did_you_mean(extra[0], allowed)
        return f"expected {shown}, got @{{{extra[0]}}}. {hint}Use only these names."
    return f"expected {shown}, got no @{{{missing[0]}}}. Put it where its value belongs."


def _kind(entry: object) -> str:
    if isinstance(entry, (list, tuple)):
        return f"a list of {len(entry)} texts" if entry else "an empty list"
    if isinstance(entry, str):
        return "a text" if entry.strip() else "an empty text"
    return "nothing" if entry is None else checks.shown(entry)

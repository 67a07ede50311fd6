"""docstrings: the plain text of docstrings as reStructuredText, with equations as formulas.

Docstrings are written for a terminal: their only markup is `code`. Sections are underlined.
Sections of names (Parameters, Raises, ...) become lists, the section Equation becomes formulas.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache
from inspect import ismodule
from itertools import pairwise

from equations import pieces, whole_line

import geomtorsion
from geomtorsion import errors

# Their entries are names with an indented text each.
LISTS = ("Parameters", "Returns", "Yields", "Raises", "Keys", "Fields", "Times", "How finely")
_UNDERLINE = re.compile(r"-{3,}")
_FIELD = re.compile(r"([A-Za-z_]\w*(?:, [A-Za-z_]\w*)*): (?=\S)")
_CODE = re.compile(r"(`+)([^`]+)\1")
_MARKUP = re.compile(r"([\\*|_<>:])")


def escaped(text: str) -> str:
    """Prose without markup: signs of markup are escaped, `code` is set as code."""
    parts, place = [], 0
    for code in _CODE.finditer(text):
        parts += [_MARKUP.sub(r"\\\1", text[place : code.start()]), _code(code[2])]
        place = code.end()
    return "".join([*parts, _MARKUP.sub(r"\\\1", text[place:]).replace("`", r"\`")])


def _code(text: str) -> str:
    """Code, as a link if it is a public name."""
    name = text.removesuffix("()").removeprefix("gt.").removeprefix("geomtorsion.")
    if name in geomtorsion.__all__:
        return rf"\ :py:obj:`{text} <geomtorsion.{name}>`\ "
    homes = [
        home for home in _homes().get(name.rpartition(".")[2], ()) if home.endswith(f".{name}")
    ]
    if len(homes) == 1 and ("." in name or name[0].isupper()):
        return rf"\ :py:obj:`{text} <{homes[0]}>`\ "
    return rf"\ ``{text}``\ "


@cache
def _homes() -> dict[str, list[str]]:
    """Full names of the functions and classes that the packages export, by their last part."""
    found: dict[str, list[str]] = {}
    exported = [getattr(geomtorsion, name) for name in geomtorsion.__all__]
    packages = [value for value in exported if ismodule(value)]
    for package in packages:
        for name in getattr(package, "__all__", ()):
            if name not in geomtorsion.__all__ and not ismodule(getattr(package, name)):
                found.setdefault(name, []).append(f"{package.__name__}.{name}")
    return found


def with_formulas(line: str) -> str:
    """A sentence with its mathematics set as formulas, and with its `code` as code."""
    parts: list[str] = []
    place = 0
    for code in [*_CODE.finditer(line), None]:
        text = line[place : code.start() if code else len(line)]
        # Blanks beside code are kept.
        inner = " ".join(_set(*piece) for piece in pieces(text))
        parts += [text[: len(text) - len(text.lstrip())], inner]
        parts += [text[len(text.rstrip()) :] if text.strip() else ""]
        if code:
            parts.append(_code(code[2]))
            place = code.end()
    return "".join(parts)


def _set(kind: str, text: str) -> str:
    """A piece of a sentence: a word as it is, mathematics as a formula."""
    if kind == "text":
        return escaped(text)
    latex, stop = text.split("\0")
    return rf"\ :math:`{latex.strip()}`\ {stop}"


def _paragraphs(lines: Iterable[str]) -> Iterator[list[str]]:
    found: list[str] = []
    for line in [*lines, ""]:
        if line.strip():
            found.append(line)
        elif found:
            yield found
            found = []


def _prose(lines: list[str]) -> Iterator[str]:
    """Paragraphs; fields of a class as a list, examples unchanged, all else as text."""
    for paragraph in _paragraphs(lines):
        if paragraph[0].lstrip().startswith(">>>"):
            yield from [*paragraph, ""]
        elif all(line.startswith("    ") for line in paragraph):
            yield from ["::", "", *paragraph, ""]
        elif _FIELD.match(paragraph[0]):
            yield from _fields(paragraph)
        elif paragraph[0].startswith(("- ", "* ")):
            yield from _items(paragraph)
        else:
            yield from [escaped(line.strip()) for line in paragraph]
            yield ""


def _items(lines: list[str]) -> Iterator[str]:
    for line in lines:
        starts = line.startswith(("- ", "* "))
        yield ("- " if starts else "  ") + escaped(line[2:].strip() if starts else line.strip())
    yield ""


def _fields(lines: list[str]) -> Iterator[str]:
    """Fields `name: description`, each with its continuation lines."""
    for line in lines:
        start = _FIELD.match(line)
        if start:
            yield f"{_names(start[1])}"
            yield f"    {escaped(line[start.end() :])}"
        else:
            yield f"    {escaped(line.strip())}"
    yield ""


def _names(text: str) -> str:
    return ", ".join(f"``{name}``" for name in text.split(", "))


def _list(title: str, lines: list[str]) -> Iterator[str]:
    """Names, each with an indented text; other text stays prose."""
    if not any(line.startswith("    ") for line in lines):
        yield from _prose(lines)
        return
    for line in lines:
        if not line.strip():
            yield ""
        elif line.startswith(" "):
            yield f"    {escaped(line.strip())}"
        elif title == "Raises" and hasattr(errors, line.strip()):
            yield f":py:exc:`~geomtorsion.errors.{line.strip()}`"
        else:
            yield _names(line.strip()) if re.fullmatch(r"[\w, *]+", line) else escaped(line)
    yield ""


def _equations(lines: list[str]) -> Iterator[str]:
    """Lines of mathematics as displayed formulas; other formulas within the text."""
    for paragraph in _paragraphs(lines):
        text: list[str] = []
        for line in paragraph:
            equation = whole_line(line)
            if equation is None:
                text.append(with_formulas(line.strip()))
                continue
            latex, source = equation
            yield from [*text, ""]
            text = []
            yield from [".. math::", "", f"    {latex}", ""]
            if source:
                yield from [escaped(source), ""]
        yield from [*text, ""]


def _sections(lines: list[str]) -> Iterator[tuple[str, list[str]]]:
    """Title and lines of each section; the first has no title."""
    starts = [0]
    for number, (_, below) in enumerate(pairwise(lines)):
        if _UNDERLINE.fullmatch(below.strip()) and lines[number].strip():
            starts.append(number)
    for start, end in pairwise([*starts, len(lines)]):
        if start in starts[1:]:
            yield lines[start].strip(), lines[start + 2 : end]
        else:
            yield "", lines[start:end]


def converted(lines: list[str]) -> list[str]:
    """A docstring as reStructuredText."""
    found: list[str] = []
    for title, inner in _sections(lines):
        if title:
            found += [f".. rubric:: {title}", ""]
        if title == "Equation":
            found += _equations(inner)
        elif title in LISTS:
            found += _list(title, inner)
        else:
            found += _prose(inner)
    return found


def _convert(app, what, name, object_, options, lines: list[str]) -> None:
    lines[:] = converted(lines)


def setup(app) -> dict[str, bool]:
    """Convert the docstrings that autodoc reads."""
    app.connect("autodoc-process-docstring", _convert)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

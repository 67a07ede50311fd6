"""Docstrings: arguments, errors and fields that are documented exist; lists have only entries."""

import builtins
import importlib
import inspect
import pkgutil
import re
from collections.abc import Callable, Iterator
from functools import cache, cached_property

import geomtorsion
from geomtorsion import errors

_UNDERLINE = re.compile(r"-{3,}")
_NAMES = re.compile(r"[\w.]+(?:, [\w.]+)*")
_FIELD = re.compile(r"([a-zA-Z_]\w*(?:, [a-zA-Z_]\w*)*): ")
# Errors with a place of their own.
OTHER_ERRORS = {"WorkLimitError"}


@cache
def public() -> dict[str, type | Callable[..., object]]:
    """Full name -> each class and function that a package exports."""
    found: dict[str, type | Callable[..., object]] = {}
    for module in pkgutil.walk_packages(geomtorsion.__path__, "geomtorsion."):
        if module.ispkg:
            package = importlib.import_module(module.name)
            for name in getattr(package, "__all__", ()):
                value = getattr(package, name)
                if inspect.isclass(value) or inspect.isfunction(value):
                    found[f"{value.__module__}.{value.__qualname__}"] = value
    return found


def members(owner: type) -> Iterator[tuple[str, Callable[..., object]]]:
    """Public methods and properties of a class itself, as functions."""
    for name, value in vars(owner).items():
        inner = value.fget if isinstance(value, property) else value
        inner = value.func if isinstance(value, cached_property) else inner
        inner = getattr(inner, "__func__", inner)
        if not name.startswith("_") and inspect.isfunction(inner):
            yield name, inner


def documented() -> Iterator[tuple[str, type | Callable[..., object]]]:
    """All classes and functions, and the members of all classes."""
    for name, value in public().items():
        yield name, value
        if inspect.isclass(value):
            yield from ((f"{name}.{member}", inner) for member, inner in members(value))


def sections(text: str | None) -> dict[str, list[str]]:
    """Title -> lines; the text before the first title has none."""
    lines = inspect.cleandoc(text or "").split("\n")
    found: dict[str, list[str]] = {"": []}
    title = ""
    for number, line in enumerate(lines):
        below = lines[number + 1] if number + 1 < len(lines) else ""
        if line and _UNDERLINE.fullmatch(below):
            title = line
            found[title] = []
        elif not _UNDERLINE.fullmatch(line):
            found[title].append(line)
    return found


def entries(text: str | None, title: str) -> list[str]:
    """The lines of a section that begin an entry."""
    return [line for line in sections(text).get(title, ()) if line and not line.startswith(" ")]


def is_error(name: str) -> bool:
    """Whether this is the name of an error."""
    return hasattr(errors, name) or hasattr(builtins, name) or name in OTHER_ERRORS


def test_all_lists_have_entries_only():
    """Parameters and Raises list names, each with an indented text; other text is above them."""
    assert len(public()) > 300
    loose = [
        (name, line)
        for name, value in documented()
        for title in ("Parameters", "Raises")
        for line in entries(value.__doc__, title)
        if not _NAMES.fullmatch(line)
    ]
    assert not loose


def test_all_errors_exist():
    """Each name under Raises is the name of an error."""
    unknown = [
        (name, error)
        for name, value in documented()
        for line in entries(value.__doc__, "Raises")
        for error in line.split(", ")
        if not is_error(error)
    ]
    assert not unknown


def test_all_arguments_exist():
    """Each name under Parameters is an argument of the function, or of the class."""
    unknown = [
        (name, argument)
        for name, value in documented()
        for line in entries(value.__doc__, "Parameters")
        for argument in line.split(", ")
        if argument not in inspect.signature(inspect.unwrap(value)).parameters
    ]
    assert not unknown


def test_all_fields_exist():
    """Each field in the docstring of a class is a field, a member or an argument of the class."""
    unknown = [
        (name, field)
        for name, value in public().items()
        if inspect.isclass(value)
        for line in sections(value.__doc__)[""][1:]
        if (start := _FIELD.match(line))
        for field in start[1].split(", ")
        if not (
            hasattr(value, field)
            or any(field in inspect.get_annotations(one) for one in value.__mro__)
            or field in inspect.signature(value).parameters
        )
    ]
    assert not unknown


def test_a_wrong_docstring_would_be_found():
    """Loose text, a wrong error and the entries of a list are seen."""
    text = "Sum.\n\nParameters\n----------\nx, y\n    numbers.\nLoose text.\n"
    text += "\nRaises\n------\nNoError\n"
    assert entries(text, "Parameters") == ["x, y", "Loose text."]
    assert not _NAMES.fullmatch("Loose text.")
    assert entries(text, "Raises") == ["NoError"]
    assert not is_error("NoError")

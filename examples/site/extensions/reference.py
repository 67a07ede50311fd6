"""reference: the directive `public`, which documents the public names of a package once each.

A name that `geomtorsion` itself exports is documented on the first page; pages of packages link it.
Each class has a page of its own in api/pages, which is written before Sphinx reads the pages.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import pkgutil
import re
from collections.abc import Iterator
from contextlib import suppress
from importlib import import_module
from inspect import isclass, isfunction, ismodule
from pathlib import Path
from types import ModuleType
from typing import ClassVar

from docstrings import converted, escaped
from docutils import nodes
from docutils.statemachine import StringList
from sources import CLASSES, SITE
from sphinx.util.docutils import SphinxDirective
from sphinx.util.nodes import make_refnode, nested_parse_with_titles
from topics import ordered, table

import geomtorsion

ALL_PUBLIC = ("geomtorsion.conventions", "geomtorsion.errors")
# Packages that only hold packages: each of these has a page of its own.
GROUPS = ("materials", "teaching")
_PLACED = re.compile(r"^\.\. public:: (\S+)(?:\n    :of: ([\w.]+))?", re.MULTILINE)


def public_modules() -> Iterator[ModuleType]:
    """Every module with a list of exports, and the modules that are public as a whole."""
    yield geomtorsion
    for found in pkgutil.walk_packages(geomtorsion.__path__, "geomtorsion."):
        if not found.name.endswith("__main__"):
            module = import_module(found.name)
            if hasattr(module, "__all__") or found.name in ALL_PUBLIC:
                yield module


def public_names(module: ModuleType) -> list[str]:
    """What a package exports, in its order."""
    if module.__name__ == "geomtorsion.errors":
        return [name for name, value in vars(module).items() if isclass(value)]
    listed = getattr(module, "__all__", None)
    if listed is not None:
        return list(listed)
    return [
        name
        for name, value in vars(module).items()
        if not name.startswith("_") and getattr(value, "__module__", None) == module.__name__
    ]


def package_of(name: str) -> str:
    """The package below geomtorsion to which an exported name belongs."""
    value = getattr(geomtorsion, name)
    if ismodule(value):
        return "packages"
    parts = value.__module__.removeprefix("geomtorsion.").split(".")
    return ".".join(parts[:2] if parts[0] in GROUPS else parts[:1])


def has_page(value: object) -> bool:
    """Whether a public name is a class with a page of its own; exceptions share one page."""
    return isclass(value) and not issubclass(value, Exception)


def class_pages() -> dict[str, str]:
    """The text of the page of each public class, by its full name."""
    homes = {
        place: (page.stem, page.read_text("utf-8").split("\n")[0])
        for page in sorted(Path(SITE, "api").glob("*.rst"))
        for place in _PLACED.findall(page.read_text("utf-8"))
    }
    rest = ("rest", "More names")
    pages: dict[str, str] = {}
    for module in public_modules():
        package = module.__name__
        for name in public_names(module):
            if not has_page(getattr(module, name)) or exported_above(package, name):
                continue
            of = package_of(name) if package == "geomtorsion" else ""
            page, title = homes.get((package, of), rest)
            pages[f"{package}.{name}"] = (
                f":orphan:\n\n{name}\n{'=' * len(name)}\n\n"
                f":doc:`Reference </api/index>` › :doc:`{title} </api/{page}>`\n\n"
                f".. autoclass:: {package}.{name}\n"
            )
    return pages


def _write_pages(app) -> None:
    """Write each page that changed, and remove pages of removed classes."""
    CLASSES.mkdir(exist_ok=True)
    pages = {CLASSES / f"{name}.rst": text for name, text in class_pages().items()}
    for path in set(CLASSES.iterdir()) - set(pages):
        path.unlink()
    for path, text in pages.items():
        if not path.is_file() or path.read_text("utf-8") != text:
            path.write_text(text, "utf-8")


def exported_above(package: str, name: str) -> list[str]:
    """The full names under which packages above this one export a name, the highest first."""
    parts = package.split(".")
    above = [".".join(parts[:count]) for count in range(1, len(parts))]
    return [f"{one}.{name}" for one in above if name in getattr(import_module(one), "__all__", ())]


class Public(SphinxDirective):
    """`.. public:: geomtorsion.loops`, or `.. public:: geomtorsion` with `:of: loops`."""

    required_arguments = 1
    option_spec: ClassVar = {"of": str}

    def run(self) -> list[nodes.Node]:
        """The nodes made from the lines of `written`."""
        lines = StringList(self.written(), source="public names")
        node = nodes.section()
        node.document = self.state.document
        nested_parse_with_titles(self.state, lines, node)
        return node.children

    def written(self) -> list[str]:
        """Directives of autodoc, one for each name that has its place here."""
        return self.documented(self.arguments[0], self.options.get("of"))

    def documented(self, name: str, of: str | None = None) -> list[str]:
        """The names of a package; of `geomtorsion` those that are at home in one below it."""
        module = import_module(name)
        names = public_names(module)
        lines: list[str] = []
        if name == "geomtorsion":
            names = [one for one in names if package_of(one) == of]
        else:
            names = [one for one in names if not ismodule(getattr(module, one))]
            lines += [f".. py:module:: {name}", "", *converted((module.__doc__ or "").split("\n"))]
            elsewhere = {one: homes[0] for one in names if (homes := exported_above(name, one))}
            names = [one for one in names if one not in elsewhere]
            if elsewhere:
                links = ", ".join(
                    f":py:mod:`{value.__name__}`" if ismodule(value) else f":py:obj:`{full}`"
                    for one, full in sorted(elsewhere.items())
                    for value in [getattr(module, one)]
                )
                lines += [f"It exports these as well: {links}.", ""]
        topics = ordered(names)
        if name == "geomtorsion" and of != "packages":
            for topic, members in topics.items():
                lines += [f".. rubric:: {topic}", "", *table(name, members)]
        elif classes := [one for one in names if has_page(getattr(module, one))]:
            lines += [".. rubric:: Classes", "", *table(name, classes)]
        for one in [one for members in topics.values() for one in members]:
            if not has_page(getattr(module, one)):
                lines += self.entry(name, one, getattr(module, one))
        return lines

    def entry(self, package: str, name: str, value: object) -> list[str]:
        """The directive that documents one name."""
        full = f"{package}.{name}"
        if ismodule(value):
            first = (value.__doc__ or "").strip().split("\n")[0].rpartition(": ")[2]
            home = f":py:mod:`{value.__name__}`"
            return [f"- {home}\\: {escaped(first)}", ""]
        if isclass(value):
            return [f".. autoexception:: {full}", ""]
        if isfunction(value) or callable(value):
            return [f".. autofunction:: {full}", ""]
        return [f".. autodata:: {full}", "    :no-value:", ""]


class Rest(Public):
    """`.. rest::`: public names without a page, so that no new name is missing."""

    required_arguments = 0

    def written(self) -> list[str]:
        """Whatever no `.. public::` of any page places."""
        pages = Path(self.env.srcdir, "api").glob("*.rst")
        placed = {found for page in pages for found in _PLACED.findall(page.read_text("utf-8"))}
        homes = dict.fromkeys(package_of(one) for one in geomtorsion.__all__)
        lines: list[str] = []
        for home in homes:
            if ("geomtorsion", home) not in placed:
                lines += self.documented("geomtorsion", home)
        for module in public_modules():
            if module is not geomtorsion and (module.__name__, "") not in placed:
                lines += self.documented(module.__name__)
        return lines


def _resolve(app, env, node, contnode):
    """A link for a type in a signature that names a public class without its package.

    A type that is not public stays unchanged, if there is one.
    """
    if node.get("refdomain") != "py":
        return None
    module, _, last = node["reftarget"].rpartition(".")
    if module.startswith("geomtorsion."):
        with suppress(ImportError):
            return contnode if hasattr(import_module(module), last) else None
    objects = env.domains["py"].objects
    short = node["reftarget"].rpartition(".")[2]
    found = sorted({name for name in objects if name.rpartition(".")[2] == short}, key=len)
    entries = {(objects[name].docname, objects[name].node_id): name for name in reversed(found)}
    if len(entries) != 1:
        return None
    ((page, anchor),) = entries
    return make_refnode(app.builder, node["refdoc"], page, anchor, contnode)


def setup(app) -> dict[str, bool]:
    """Register the directive and the links."""
    app.add_directive("public", Public)
    app.add_directive("rest", Rest)
    app.connect("builder-inited", _write_pages)
    app.connect("missing-reference", _resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

"""tables: the conventions of the package and the licences of its dependencies, as tables."""

# pyright: reportMissingImports=false

from __future__ import annotations

import re
import tomllib
from abc import ABC, abstractmethod
from collections.abc import Mapping
from email.message import Message
from importlib.metadata import PackageNotFoundError, metadata
from typing import Any, cast

from docstrings import escaped, with_formulas
from docutils import nodes
from docutils.statemachine import StringList
from equations import latex_of
from sources import ROOT
from sphinx.util.docutils import SphinxDirective

from geomtorsion.conventions import BURGERS, CONVENTIONS


class _Lines(SphinxDirective, ABC):
    """Lines of reStructuredText instead of the directive."""

    @abstractmethod
    def lines(self) -> list[str]:
        """The lines that replace it."""

    def run(self) -> list[nodes.Node]:
        """The lines, read."""
        node = nodes.container()
        self.state.nested_parse(StringList(self.lines(), source="tables"), 0, node)
        return node.children


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> list[str]:
    """A list table."""
    lines = [".. list-table::", "    :header-rows: 1", ""]
    for row in [head, *rows]:
        for number, cell in enumerate(row):
            first, *more = cell.split("\n")
            lines.append(f"    {'* - ' if number == 0 else '  - '}{first}")
            lines += [f"        {line}" for line in more]
    return [*lines, ""]


class Conventions(_Lines):
    """`.. conventions::`: the entries of `geomtorsion.conventions`, formulas set."""

    def lines(self) -> list[str]:
        """One row for each."""
        rows = [
            (one.name, "\n".join([*_formulas(one.formula), "", with_formulas(one.note)]))
            for one in CONVENTIONS
        ]
        return table(("what", "equation and note"), rows)


def _formulas(text: str) -> list[str]:
    """Mathematics set as formulas; the indices in code stay code."""
    lines: list[str] = []
    for part in re.split(r", (?=T = |\[E|L_abc|A_abc|R = |b\^i = |right)|: (?=\w+\[)", text):
        code = re.fullmatch(r"\w+\[[\w, ]+\]", part)
        latex = None if code or part.startswith("right") else latex_of(part)
        lines += [f"``{part}``" if code else f":math:`{latex}`" if latex else escaped(part), ""]
    return lines[:-1]


class BurgersConventions(_Lines):
    """`.. burgers-conventions::`: the sign of b in each convention."""

    def lines(self) -> list[str]:
        """One row for each."""
        rows = [
            (", ".join(one.names), f"{one.sign:+d}", with_formulas(one.meaning)) for one in BURGERS
        ]
        return table(("called", "sign", "how b is found"), rows)


class Licences(_Lines):
    """`.. licences::`: the licence that each installed dependency declares."""

    def lines(self) -> list[str]:
        """One row for each dependency of the package and of its extras."""
        project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
        extras = project["optional-dependencies"]
        users = ("fast", "plots", "lab", "images", "files", "cluster", "crystals")
        groups = {"always": project["dependencies"], **{name: extras[name] for name in users}}
        rows = [
            (_name(one), f"``{group}``", *(escaped(part) for part in _licence(_name(one))))
            for group, needed in groups.items()
            for one in needed
        ]
        return table(("package", "extra", "licence", "version here"), rows)


def _name(requirement: str) -> str:
    found = re.match(r"[A-Za-z0-9_.-]+", requirement)
    return found[0] if found else requirement


def _licence(name: str) -> tuple[str, str]:
    try:
        stated = cast(Message, metadata(name))
    except PackageNotFoundError:
        return "not installed where this was built", "-"
    text = stated.get("License-Expression") or ""
    if not text:
        kinds = [one for one in stated.get_all("Classifier") or [] if one.startswith("License ::")]
        text = ", ".join(one.rpartition(" :: ")[2] for one in kinds)
    # Some packages give the whole text in this field.
    return text or (stated.get("License") or "not stated").split("\n")[0][:60], stated["Version"]


def _date() -> str:
    """The day of the newest release in the changelog."""
    found = re.search(
        r"^## \[[0-9.]+\] - ([0-9-]+)", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.MULTILINE
    )
    assert found is not None
    return found[1]


def bibtex(project: Mapping[str, Any]) -> str:
    """The package, and the paper whose conventions it follows."""
    authors = " and ".join(f"{{{one['name']}}}" for one in project["authors"])
    return f"""@software{{geomtorsion,
  title   = {{geomtorsion: geometry, motions and defects of any tetrad}},
  author  = {{{authors}}},
  version = {{{project["version"]}}},
  date    = {{{_date()}}},
  license = {{{project["license"]}}}
}}

@techreport{{FizievKleinert1994,
  title       = {{Motion of a Rigid Body in Body-Fixed Coordinate System: an Example for
                 Autoparallel Trajectories in Spaces with Torsion}},
  author      = {{Fiziev, P. and Kleinert, H.}},
  number      = {{FUB-HEP/94-5}},
  institution = {{Freie Universität Berlin}},
  year        = {{1994}}
}}"""


def cff(project: Mapping[str, Any]) -> str:
    """The package in the Citation File Format, version 1.2."""
    authors = "\n".join(f"  - name: {one['name']}" for one in project["authors"])
    licences = ", ".join(project["license"].split(" AND "))
    return f"""cff-version: 1.2.0
message: If you use geomtorsion, please cite it as below.
type: software
title: "geomtorsion: geometry, motions and defects of any tetrad"
authors:
{authors}
version: {project["version"]}
date-released: {_date()}
license: [{licences}]"""


class Citation(_Lines):
    """`.. citation:: bibtex` or `.. citation:: cff`, with the version of this checkout."""

    required_arguments = 1

    def lines(self) -> list[str]:
        """A block to copy."""
        project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
        text = {"bibtex": bibtex, "cff": cff}[self.arguments[0]](project)
        language = {"bibtex": "bibtex", "cff": "yaml"}[self.arguments[0]]
        return [f".. code-block:: {language}", "", *(f"    {x}" for x in text.split("\n")), ""]


def setup(app) -> dict[str, bool]:
    """Register the directives."""
    app.add_directive("conventions", Conventions)
    app.add_directive("burgers-conventions", BurgersConventions)
    app.add_directive("licences", Licences)
    app.add_directive("citation", Citation)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

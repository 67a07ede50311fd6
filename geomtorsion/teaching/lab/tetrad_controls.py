"""tetrad controls: fields for one-forms, created again when coordinates are renamed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import TYPE_CHECKING

from geomtorsion.pictures.text import greek_name
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.query import Query
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.space_info import typable
from geomtorsion.teaching.lab.tetrad import OFFERED, USUAL, names_like
from geomtorsion.teaching.texts import ENGLISH, texts

if TYPE_CHECKING:
    from marimo import ui

    from geomtorsion.teaching.lab.tasks import Runner

# Numbers of coordinates of an empty tetrad.
BLANK = (2, 3, 4)
# Largest number of fields for entries.
MOST = PAGE.dimensions**2
_LETTERS = ("x", "y", "z", "w")


def first_start() -> str:
    """The space that is selected when the page is opened."""
    return next(iter(typable().values()))


def starts(mo: ModuleType, query: Query, language: str = ENGLISH) -> ui.dropdown:
    """The list of starting points: an empty tetrad or the tetrad of a space."""
    text = texts("figures", "controls", language)
    options: Json = {**typable(language), **{text("blank", count=n): n for n in BLANK}}
    start = query.one_of("start", list(options.values()), next(iter(options.values())))
    [first] = [title for title, value in options.items() if value == start]
    return mo.ui.dropdown(options, value=first, label=text("start"))


def quantities(language: str = ENGLISH) -> str:
    """The heading of the boxes for quantities.

    Examples
    --------
    >>> quantities()
    'Quantities to show'
    """
    return texts("figures", "controls", language)("quantities")


def facts(start: str | int, runner: Runner) -> Json:
    """The facts of a space, or of an empty tetrad of so many coordinates."""
    return blank(start) if isinstance(start, int) else runner.ask("space_form", space=start)


def tetrad_case(
    values: Mapping[str, str],
    entries: Sequence[Sequence[str]],
    show: Sequence[str],
    language: str = ENGLISH,
) -> Json:
    """Fields as the arguments of the task for tetrads."""
    return {
        "coordinates": values["coordinates"],
        "parameters": values["parameters"],
        "functions": values["functions"],
        "signature": values["signature"],
        "entries": entries,
        "show": show,
        "language": language,
    }


def blank(n: int) -> Json:
    """The facts of an unknown space: the identity."""
    names = list(_LETTERS[:n])
    return {"coordinates": names, "parameters": [], "functions": [], "signature": "", "coframe": []}


def names(mo: ModuleType, info: Json, query: Query, language: str = ENGLISH) -> ui.dictionary:
    """Fields for coordinates, parameters, unknown functions and signature."""
    text = texts("figures", "controls", language)
    return mo.ui.dictionary(
        {
            key: mo.ui.text(
                value=query.text(key, usual),
                placeholder=text(f"examples.{key}"),
                label=text(f"names.{key}"),
                debounce=PAGE.pause,
            )
            for key, usual in _usual_names(info).items()
        }
    )


def _usual_names(info: Json) -> dict[str, str]:
    """Default contents of the fields for names."""
    signs = info["signature"]
    return {
        "coordinates": ", ".join(info["coordinates"]),
        "parameters": ", ".join(info["parameters"]),
        "functions": ", ".join(info["functions"]),
        "signature": signs if "?" not in signs else "",
    }


def entries(
    mo: ModuleType, coordinates: Sequence[str], typed: Mapping[str, str], language: str = ENGLISH
) -> ui.dictionary:
    """A field for each entry of the coframe, by "i,k", with its current text."""
    text = texts("figures", "controls", language)
    n = len(coordinates)
    return mo.ui.dictionary(
        {
            f"{i},{k}": mo.ui.text(
                value=typed.get(f"{i},{k}", "1" if i == k else "0"),
                label=text("row", row=i + 1, name=greek_name(name)),
                debounce=PAGE.pause,
                full_width=True,
            )
            for i in range(n)
            for k, name in enumerate(coordinates)
        }
    )


def typed(info: Json, query: Query) -> dict[str, str]:
    """Entries of a coframe by "i,k", from a space or from the address of the page.

    Examples
    --------
    >>> typed({"coframe": [["1", "0"], ["0", "r"]]}, Query({"coframe": "1|0;0|r^2"}))
    {'0,0': '1', '0,1': '0', '1,0': '0', '1,1': 'r^2'}
    """
    table = info["coframe"]
    if "coframe" in query.texts:
        table = [row.split("|") for row in query.texts["coframe"].split(";")]
    size = range(PAGE.dimensions)
    return {f"{i},{k}": table[i][k] for i in size[: len(table)] for k in size[: len(table[i])]}


def coordinates(values: Mapping[str, str]) -> list[str]:
    """Names of the columns, as far as they can be read, one for each field.

    Examples
    --------
    >>> coordinates({"coordinates": "r, phi, 2x"})
    ['r', 'phi', 'x3']
    """
    return names_like(values["coordinates"], PAGE.dimensions)


def tetrad_query(
    start: str | int,
    info: Json,
    values: Mapping[str, str],
    coframe: Sequence[Sequence[str]],
    show: Sequence[str],
) -> dict[str, tuple[str, str]]:
    """The values of a tetrad that the address stores, each with its default."""

    def joined(rows: Sequence[Sequence[str]]) -> str:
        return ";".join("|".join(row) for row in rows)

    n = len(info["coordinates"])
    ones = [["1" if i == k else "0" for k in range(n)] for i in range(n)]
    usual = _usual_names(info)
    typed = {key: (values[key], usual[key]) for key in usual}
    return {
        "start": (str(start), first_start()),
        **typed,
        "coframe": (joined(coframe), joined(info["coframe"] or ones)),
        "show": (",".join(show), ",".join(USUAL)),
    }


def rows(values: Mapping[str, str], n: int) -> list[list[str]]:
    """Entries by "i,k" as rows.

    Examples
    --------
    >>> rows({"0,0": "1", "0,1": "0", "1,0": "0", "1,1": "r"}, 2)
    [['1', '0'], ['0', 'r']]
    """
    return [[values[f"{i},{k}"] for k in range(n)] for i in range(n)]


def offered(mo: ModuleType, query: Query, language: str = ENGLISH) -> ui.dictionary:
    """Boxes for the quantities that can be shown."""
    text = texts("figures", "quantities", language)
    shown = query.some_of("show", OFFERED, USUAL)
    return mo.ui.dictionary(
        {name: mo.ui.checkbox(value=name in shown, label=text(name)) for name in OFFERED}
    )

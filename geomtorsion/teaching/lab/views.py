"""views: answers of tasks as HTML, the same for the served page and for pages without a server."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import cache, wraps
from html import escape
from pathlib import Path

from geomtorsion.teaching.exercises.prose import html_of
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.guides import (
    ATOMS,
    COMPASS,
    COSTS,
    LOOPS,
    MEASURED,
    PATHS,
    TABS,
    TETRAD,
    TOP,
    Guide,
    part,
    tab,
)
from geomtorsion.teaching.lab.plot import saving
from geomtorsion.teaching.texts import ENGLISH, code_of, texts


@cache
def style() -> str:
    """The style sheet of the page."""
    return Path(__file__).with_name("lab.css").read_text("utf-8")


@cache
def copying() -> str:
    """The scripts that copy LaTeX and save pictures."""
    return Path(__file__).with_name("copy.js").read_text("utf-8") + saving()


def wrapped(html: str) -> str:
    """HTML to which the style sheet applies."""
    return f'<div class="lab">{html}</div>'


def header(language: str = ENGLISH) -> str:
    """The title above all tabs, with the words that its script writes into parts of marimo.

    Examples
    --------
    >>> header("de").count('data-parts="Teile des Labors"')
    1
    """
    text = texts("lab", "page", language)
    english = texts("lab", "page").table("drawn")
    drawn = {english[key]: word for key, word in text.table("drawn").items()}
    data = {"language": code_of(language), "parts": text("parts"), "drawn": json.dumps(drawn)}
    marks = " ".join(f'data-{key}="{escape(value)}"' for key, value in data.items())
    return wrapped(f"<h1 {marks}>{escape(text('name'))}</h1>")


def intro(guide: Guide, language: str = ENGLISH) -> str:
    """The displayed objects, a question with its answer folded away, and an action to try.

    Examples
    --------
    >>> intro(tab(LOOPS).guide).count("<summary>")
    1
    """
    return wrapped(_guide(guide, language))


def _guide(guide: Guide, language: str) -> str:
    text = texts("lab", "page", language)
    asked = (
        f'<details class="guide"><summary><strong>{escape(text("predict"))}</strong> '
        f"{escape(guide.question)} <em>{escape(text('open'))}</em></summary>"
        f"<p>{escape(guide.answer)}</p></details>"
    )
    tried = f'<p class="guide"><strong>{escape(text("try"))}</strong> {escape(guide.tried)}</p>'
    note = f'<p class="note">{escape(guide.note)}</p>' * bool(guide.note)
    return f'{note}<p class="guide">{escape(guide.seen)}</p>{asked * bool(guide.question)}{tried}'


def words(name: str, language: str = ENGLISH) -> str:
    """The terms of a tab, explained."""
    return _terms(tab(name, language).guide, language)


def _terms(guide: Guide, language: str) -> str:
    items = "".join(
        f"<dt>{escape(term)}</dt><dd>{html_of(text)}</dd>" for term, text in guide.words.items()
    )
    title = escape(texts("lab", "page", language)("words"))
    return f'<h3>{title}</h3><dl class="words">{items}</dl>' if items else ""


def copy_button(latex: str, what: str, language: str = ENGLISH) -> str:
    """A button that copies LaTeX; the page's own script handles it.

    Examples
    --------
    >>> copy_button("a < b", "Metric").count("&lt;")
    1
    """
    text = texts("figures", "figure", language)
    return (
        f'<button type="button" class="copy" data-latex="{escape(latex)}" '
        f'data-copied="{escape(text("copied"))}" data-failed="{escape(text("not_copied"))}" '
        f'aria-label="{escape(text("copy_what", what=what))}">{escape(text("copy"))}</button>'
    )


def notice(text: str) -> str:
    """A message about a request that failed.

    Examples
    --------
    >>> notice("a < b")
    '<pre class="notice" role="alert">a &lt; b</pre>'
    """
    return f'<pre class="notice" role="alert">{escape(text)}</pre>'


def problem(reply: Json) -> str:
    """The message of a reply without a result, or an empty text."""
    return notice(reply["problem"]) if reply.get("problem") else ""


def fault(reply: Json, i: int, k: int) -> str:
    """The error of one entry of a tetrad, for display next to it."""
    text = reply.get("errors", {}).get(f"{i},{k}", "")
    return f'<pre class="fault" role="alert">✗ {escape(text)}</pre>' if text else ""


def _or_problem(view: Callable[[Json, str], str]) -> Callable[..., str]:
    """A view in a language, which shows the message of a reply without a result instead."""

    @wraps(view)
    def shown(reply: Json, language: str = ENGLISH) -> str:
        return wrapped(problem(reply) or view(reply, language))

    return shown


def _result(text: str, name: str = "") -> str:
    """The sentence that sums up a result; name: id of its element."""
    mark = f' id="{name}"' if name else ""
    return f'<p class="result"{mark}>{text}</p>'


def tetrad(reply: Json, language: str = ENGLISH) -> str:
    """Cards of a tetrad, or its error."""
    faults = len(reply.get("errors", {}))
    message = ""
    if faults:
        text = texts("figures", "controls", language)
        message = notice(text("faults_one") if faults == 1 else text("faults", count=faults))
    shown = reply.get("html", "")
    return wrapped(problem(reply) + message + shown + (words(TETRAD, language) if shown else ""))


@_or_problem
def loop(reply: Json, language: str) -> str:
    """A loop, its image, and a description of its Burgers vector."""
    pictures = "".join(f"<div>{picture}</div>" for picture in reply["pictures"])
    result = _result(escape(reply["sentence"]), "loop-result")
    return f'<div class="pair" id="loop">{pictures}</div>{result}'


def loop_below(reply: Json, language: str = ENGLISH) -> str:
    """The numbers of a loop, and its words."""
    return _below(reply.get("table", ""), LOOPS, language)


def _below(html: str, name: str, language: str) -> str:
    """Details and terms of a tab, which a phone shows below the controls."""
    return wrapped(f'<div class="later">{html}{words(name, language)}</div>')


@_or_problem
def atoms(reply: Json, language: str) -> str:
    """A crystal with clickable circuits, and an action to try."""
    guide = part(ATOMS, language)
    title = escape(texts("lab", ATOMS, language)("name"))
    inner = f"<h2>{title}</h2>{_guide(guide, language)}{framed(reply)}"
    return f'<div class="atoms" id="atoms">{inner}</div>{_terms(guide, language)}'


def map_field(field: object, language: str = ENGLISH) -> str:
    """The purpose of an uploaded map or image, and the field for the file."""
    title = escape(texts("lab", MEASURED, language)("name"))
    guide = _guide(part(MEASURED, language), language)
    inner = f'<h2>{title}</h2>{guide}<div class="controls">{field}'
    return wrapped(f'<div class="measured">{inner}</div></div>')


def map_description(facts: Json) -> str:
    """Description of a map, or the reason why the file is not one."""
    if facts.get("problem"):
        return wrapped(f'<div class="measured" id="map-problem">{problem(facts)}</div>')
    return wrapped(f'<p class="measured" id="map-facts">{escape(facts["sentence"])}</p>')


def map_circuit(reply: Json, language: str = ENGLISH) -> str:
    """The picture of a map with a circuit, and its Burgers vector or the reason why it has none."""
    if reply.get("problem"):
        return map_description(reply)
    if reply.get("refused"):
        side = notice(reply["refused"])
    else:
        side = _result(escape(reply["sentence"])) + reply["table"]
    picture = f'<div id="map">{reply["picture"]}</div>'
    both = f'<div class="figures">{picture}<div id="map-result">{side}</div></div>'
    terms = _terms(part(MEASURED, language), language)
    return wrapped(f'<div class="measured">{both}{terms}</div>')


@_or_problem
def compass(reply: Json, language: str) -> str:
    """The globe with both paths, and the terms."""
    return f'<div class="globe" id="compass">{framed(reply)}</div>{words(COMPASS, language)}'


@_or_problem
def paths(reply: Json, language: str) -> str:
    """Two curves and the distance between them."""
    curves = framed(reply) or reply.get("picture", "")
    return _figures(curves, _result(escape(reply["sentence"]), "paths-result"), reply["distance"])


def _figures(left: str, result: str, chart: str) -> str:
    """A picture, and beside it the result with a chart."""
    return f'<div class="figures"><div>{left}</div><div>{result}{chart}</div></div>'


def paths_below(reply: Json, language: str = ENGLISH) -> str:
    """Methods and errors of two curves, and the terms."""
    return _below(reply.get("table", ""), PATHS, language)


@_or_problem
def costs(reply: Json, language: str) -> str:
    """Picture, advice and measurements."""
    truth = ""
    if "truth" in reply:
        text = texts("figures", "costs", language)("truth", truth=reply["truth"])
        truth = f" {escape(text)}"
    result = _result(reply["advice"] + truth, "costs-result")
    terms = words(COSTS, language)
    return f'{result}<div class="one">{reply["picture"]}</div>{reply["table"]}{terms}'


@_or_problem
def top(reply: Json, language: str) -> str:
    """An animation of the top, and the watched quantities, also by the naive law."""
    result = _result(escape(reply["sentence"]), "top-result")
    return _figures(framed(reply), result, reply["compared"])


def top_below(reply: Json, language: str = ENGLISH) -> str:
    """Method and errors of the top, its plan, and the terms."""
    plan = f'<div id="top-plan">{reply["plan"]}</div>' if "plan" in reply else ""
    return _below(reply.get("table", "") + plan, TOP, language)


@_or_problem
def exercise(reply: Json, language: str) -> str:
    """Statement of an exercise."""
    head = f"<h2>{escape(reply['number'])} {escape(reply['title'])}</h2>"
    facts = texts("lab", "form", language)(
        "facts", chapter=reply["chapter"], level=reply["level"], variant=reply["seed"]
    )
    note = f'<p class="note">{escape(reply["note"])}</p>' * bool(reply["note"])
    stated = f'<div class="sideways" id="statement">{note}{reply["statement"]}</div>'
    return f'{head}<p class="note">{escape(facts)}</p>{stated}{reply["copy"]}'


_LOOKS = {"right": ("right", "✓"), "wrong": ("wrong", "✗")}


def verdict(reply: Json | None, language: str = ENGLISH) -> str:
    """The verdict on answers; empty without answers."""
    if reply is None:
        return ""
    if reply.get("problem"):
        return wrapped(problem(reply))
    text = texts("lab", "form", language)
    if not reply["questions"]:
        return wrapped(f'<p class="note">{escape(text("first"))}</p>')
    parts = []
    for row in reply["questions"]:
        look, sign = _LOOKS.get(row["state"], ("unread", "?"))
        read = f'<p class="note">{escape(text("read"))} <code>{escape(row["read_as"])}</code></p>'
        parts.append(
            f'<div class="{look}" role="status"><strong>{escape(row["name"])}: {sign} '
            f"{escape(row['label'])}</strong>{row['message']}{read * bool(row['read_as'])}"
            f"{row['copy']}</div>"
        )
    notes = "".join(f'<p class="note">{escape(note)}</p>' for note in reply["notes"])
    parts.append(f'{notes}<p class="note">{escape(reply["points"])}</p>')
    return wrapped(f'<div class="sideways" id="verdict">{"".join(parts)}</div>')


@_or_problem
def steps(reply: Json, language: str) -> str:
    """Hints, in order."""
    items = "".join(f"<li>{hint}</li>" for hint in reply["hints"])
    hints = f'<div class="sideways"><ol id="hints">{items}</ol></div>{reply["copy"]}'
    return hints if items else ""


def framed(reply: Json) -> str:
    """The turnable picture of a reply in a frame of its own, with all its resources; or empty."""
    if not reply.get("space"):
        return ""
    title = escape(reply.get("title", "picture in space"))
    return f'<iframe title="{title}" srcdoc="{escape(reply["space"])}"></iframe>'


def grid(cells: Sequence[str], columns: int) -> str:
    """Pieces of HTML in rows."""
    inner = "".join(f"<div>{cell}</div>" for cell in cells)
    template = f"grid-template-columns: repeat({columns}, minmax(0, 1fr))"
    return f'<div class="tetrad" style="{template}">{inner}</div>'


def controls(pieces: Sequence[object], kind: str = "", language: str = ENGLISH) -> str:
    """Controls side by side, in as many rows as they need.

    kind "after": on a narrow window they are below the picture that they change; several are folded
    there behind a button, so that they do not hide the picture.
    """
    inner = "".join(f"<div>{piece}</div>" for piece in pieces)
    fold = ""
    if kind == "after" and len(pieces) > 1:
        name = escape(texts("lab", "page", language)("controls"))
        fold = f'<button type="button" class="fold" aria-expanded="false">{name}</button>'
    return wrapped(f'{fold}<div class="controls {kind}">{inner}</div>')


def of_tab(name: str, html: str, *, result: bool = True) -> str:
    """Output that belongs to a tab, by its number, so that the page hides it below other tabs.

    result: whether it is what the tab computes; until it is there, the page shows "Computing".

    Examples
    --------
    >>> of_tab(COMPASS, "x"), of_tab(LOOPS, "y", result=False)
    ('<div data-of="0" data-result>x</div>', '<div data-of="1">y</div>')
    """
    return f'<div data-of="{list(TABS).index(name)}"{" data-result" * result}>{html}</div>'


def computing(language: str = ENGLISH) -> str:
    """The word that the page shows while a tab has no result yet."""
    text = escape(texts("lab", "page", language)("computing"))
    return wrapped(f'<p class="computing note" role="status">{text}</p>')

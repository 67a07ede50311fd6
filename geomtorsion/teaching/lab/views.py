"""views: answers of tasks as HTML, the same for the served page and for pages without a server."""

from __future__ import annotations

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
    GUIDES,
    LOOPS,
    MEASURED,
    PATHS,
    TETRAD,
    TOP,
    Guide,
)
from geomtorsion.teaching.lab.plot import saving


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


def header() -> str:
    """The title above all tabs."""
    return wrapped("<h1>Torsion lab</h1>")


def intro(guide: Guide) -> str:
    """The displayed objects, a question with its answer folded away, and an action to try.

    Examples
    --------
    >>> intro(GUIDES[LOOPS]).count("<summary>")
    1
    """
    return wrapped(_guide(guide))


def _guide(guide: Guide) -> str:
    asked = (
        f'<details class="guide"><summary><strong>Predict:</strong> {escape(guide.question)} '
        f"<em>Then open the answer.</em></summary><p>{escape(guide.answer)}</p></details>"
    )
    tried = f'<p class="guide"><strong>Try:</strong> {escape(guide.tried)}</p>'
    return f'<p class="guide">{escape(guide.seen)}</p>{asked * bool(guide.question)}{tried}'


def words(tab: str) -> str:
    """The terms of a tab, explained."""
    return _terms(GUIDES[tab])


def _terms(guide: Guide) -> str:
    items = "".join(
        f"<dt>{escape(term)}</dt><dd>{html_of(text)}</dd>" for term, text in guide.words.items()
    )
    return f'<h3>In words</h3><dl class="words">{items}</dl>' if items else ""


def copy_button(latex: str, what: str) -> str:
    """A button that copies LaTeX; the page's own script handles it.

    Examples
    --------
    >>> copy_button("a < b", "Metric").count("&lt;")
    1
    """
    return (
        f'<button type="button" class="copy" data-latex="{escape(latex)}" '
        f'aria-label="Copy LaTeX: {escape(what)}">Copy LaTeX</button>'
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


def _or_problem(view: Callable[[Json], str]) -> Callable[[Json], str]:
    """A view that shows the message of a reply without a result instead."""

    @wraps(view)
    def shown(reply: Json) -> str:
        return wrapped(problem(reply) or view(reply))

    return shown


def _result(text: str, name: str = "") -> str:
    """The sentence that sums up a result; name: id of its element."""
    mark = f' id="{name}"' if name else ""
    return f'<p class="result"{mark}>{text}</p>'


def tetrad(reply: Json) -> str:
    """Cards of a tetrad, or its error."""
    faults = len(reply.get("errors", {}))
    message = ""
    if faults:
        entries = "1 entry" if faults == 1 else f"{faults} entries"
        message = notice(f"{entries} cannot be read. Read the message below each, and correct it.")
    shown = reply.get("html", "")
    return wrapped(problem(reply) + message + shown + (words(TETRAD) if shown else ""))


@_or_problem
def loop(reply: Json) -> str:
    """A loop, its image, and a description of its Burgers vector."""
    pictures = "".join(f"<div>{picture}</div>" for picture in reply["pictures"])
    result = _result(escape(reply["sentence"]), "loop-result")
    return f'<div class="pair" id="loop">{pictures}</div>{result}'


def loop_below(reply: Json) -> str:
    """The numbers of a loop, and its words."""
    return _below(reply.get("table", ""), LOOPS)


def _below(html: str, tab: str) -> str:
    """Details and terms of a tab, which a phone shows below the controls."""
    return wrapped(f'<div class="later">{html}{words(tab)}</div>')


@_or_problem
def atoms(reply: Json) -> str:
    """A crystal with clickable circuits, and an action to try."""
    inner = f"<h2>From atom to atom</h2>{_guide(ATOMS)}{framed(reply)}"
    return f'<div class="atoms" id="atoms">{inner}</div>{_terms(ATOMS)}'


def map_field(field: object) -> str:
    """The purpose of an uploaded map or image, and the field for the file."""
    inner = f'<h2>A map or an image of your own</h2>{_guide(MEASURED)}<div class="controls">{field}'
    return wrapped(f'<div class="measured">{inner}</div></div>')


def map_description(facts: Json) -> str:
    """Description of a map, or the reason why the file is not one."""
    if facts.get("problem"):
        return wrapped(f'<div class="measured" id="map-problem">{problem(facts)}</div>')
    return wrapped(f'<p class="measured" id="map-facts">{escape(facts["sentence"])}</p>')


def map_circuit(reply: Json) -> str:
    """The picture of a map with a circuit, and its Burgers vector or the reason why it has none."""
    if reply.get("problem"):
        return map_description(reply)
    if reply.get("refused"):
        side = notice(reply["refused"])
    else:
        side = _result(escape(reply["sentence"])) + reply["table"]
    picture = f'<div id="map">{reply["picture"]}</div>'
    both = f'<div class="figures">{picture}<div id="map-result">{side}</div></div>'
    return wrapped(f'<div class="measured">{both}{_terms(MEASURED)}</div>')


@_or_problem
def compass(reply: Json) -> str:
    """The globe with both paths, and the terms."""
    return f'<div class="globe" id="compass">{framed(reply)}</div>{words(COMPASS)}'


@_or_problem
def paths(reply: Json) -> str:
    """Two curves and the distance between them."""
    curves = framed(reply) or reply.get("picture", "")
    return _figures(curves, _result(escape(reply["sentence"]), "paths-result"), reply["distance"])


def _figures(left: str, result: str, chart: str) -> str:
    """A picture, and beside it the result with a chart."""
    return f'<div class="figures"><div>{left}</div><div>{result}{chart}</div></div>'


def paths_below(reply: Json) -> str:
    """Methods and errors of two curves, and the terms."""
    return _below(reply.get("table", ""), PATHS)


@_or_problem
def costs(reply: Json) -> str:
    """Picture, advice and measurements."""
    truth = (
        f" The errors are measured against {escape(reply['truth'])}." if "truth" in reply else ""
    )
    result = _result(reply["advice"] + truth, "costs-result")
    return f'{result}<div class="one">{reply["picture"]}</div>{reply["table"]}{words(COSTS)}'


@_or_problem
def top(reply: Json) -> str:
    """An animation of the top, and the watched quantities, also by the naive law."""
    result = _result(escape(reply["sentence"]), "top-result")
    return _figures(framed(reply), result, reply["compared"])


def top_below(reply: Json) -> str:
    """Method and errors of the top, its plan, and the terms."""
    plan = f'<div id="top-plan">{reply["plan"]}</div>' if "plan" in reply else ""
    return _below(reply.get("table", "") + plan, TOP)


@_or_problem
def exercise(reply: Json) -> str:
    """Statement of an exercise."""
    head = f"<h2>{escape(reply['number'])} {escape(reply['title'])}</h2>"
    facts = f"{escape(reply['chapter'])}; {escape(reply['level'])}; variant {reply['seed']}"
    stated = f'<div class="sideways" id="statement">{reply["statement"]}</div>'
    return f'{head}<p class="note">{facts}</p>{stated}{reply["copy"]}'


_LOOKS = {"right": ("right", "✓"), "wrong": ("wrong", "✗")}


def verdict(reply: Json | None) -> str:
    """The verdict on answers; empty without answers."""
    if reply is None:
        return ""
    if reply.get("problem"):
        return wrapped(problem(reply))
    if not reply["questions"]:
        return wrapped('<p class="note">Type an answer first.</p>')
    parts = []
    for row in reply["questions"]:
        look, sign = _LOOKS.get(row["state"], ("unread", "?"))
        read = f'<p class="note">Read as: <code>{escape(row["read_as"])}</code></p>'
        parts.append(
            f'<div class="{look}" role="status"><strong>{escape(row["name"])}: {sign} '
            f"{escape(row['state'])}</strong>{row['message']}{read * bool(row['read_as'])}"
            f"{row['copy']}</div>"
        )
    notes = "".join(f'<p class="note">{escape(note)}</p>' for note in reply["notes"])
    parts.append(f'{notes}<p class="note">{escape(reply["points"])}</p>')
    return wrapped(f'<div class="sideways" id="verdict">{"".join(parts)}</div>')


@_or_problem
def steps(reply: Json) -> str:
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


def controls(pieces: Sequence[object], kind: str = "") -> str:
    """Controls side by side, in as many rows as they need.

    kind "after": on a narrow window they are below the picture that they change.
    """
    inner = "".join(f"<div>{piece}</div>" for piece in pieces)
    return wrapped(f'<div class="controls {kind}">{inner}</div>')

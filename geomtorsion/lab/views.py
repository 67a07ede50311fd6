"""views: answers of tasks as HTML, the same for the served page and for pages without a server."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from html import escape
from pathlib import Path

from geomtorsion.exercises.worker_pool import Json
from geomtorsion.lab.guides import GUIDES, MEASURED, Guide

# Name of a tab -> what is to be done there, in a sentence.
TABS = {
    "Any tetrad": "Type one-forms; read metric, connections, torsion and curvature, exactly.",
    "Loops": "Carry a frame round a circle: its image does not close where there is torsion.",
    "Straightest and shortest": "Two curves from one start: where torsion pulls, they part.",
    "The top": "Switch on what a body feels; see what is simulated, and what is left out.",
    "What accuracy costs": "Error against time for the case that is set on the other tabs.",
    "Exercises": "The same as on the command line: answer, be told why not, take a hint.",
}
TETRAD, LOOPS, PATHS, TOP, COSTS, EXERCISES = TABS


@cache
def style() -> str:
    """The style sheet of the page."""
    return Path(__file__).with_name("lab.css").read_text("utf-8")


@cache
def copying() -> str:
    """The script that copies LaTeX."""
    return Path(__file__).with_name("copy.js").read_text("utf-8")


def wrapped(html: str) -> str:
    """HTML to which the style sheet applies."""
    return f'<div class="lab">{html}</div>'


def header() -> str:
    """The title, which stands above all tabs."""
    return wrapped("<h1>Torsion lab</h1>")


def intro(tab: str, *, still: bool = False) -> str:
    """What one sees on a tab; and what to try, unless nothing on the page can be changed."""
    guide = GUIDES[tab]
    tried = f'<p class="guide"><strong>Try:</strong> {escape(guide.tried)}</p>'
    return wrapped(f'<p class="guide">{escape(guide.seen)}</p>{"" if still else tried}')


def words(tab: str) -> str:
    """The terms of a tab, explained."""
    return _terms(GUIDES[tab])


def _terms(guide: Guide) -> str:
    items = "".join(
        f"<dt>{escape(term)}</dt><dd>{escape(text)}</dd>" for term, text in guide.words.items()
    )
    return f'<h3>In words</h3><dl class="words">{items}</dl>' if items else ""


def copy_button(latex: str, what: str) -> str:
    """A button that copies LaTeX; the page's own script listens to it.

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
    """A message about something that cannot be done.

    Examples
    --------
    >>> notice("a < b")
    '<pre class="notice" role="alert">a &lt; b</pre>'
    """
    return f'<pre class="notice" role="alert">{escape(text)}</pre>'


def problem(reply: Json) -> str:
    """The message of a reply that is no answer, or nothing."""
    return notice(reply["problem"]) if reply.get("problem") else ""


def fault(reply: Json, i: int, k: int) -> str:
    """What is wrong with one entry of a tetrad, to stand next to it."""
    text = reply.get("errors", {}).get(f"{i},{k}", "")
    return f'<pre class="fault" role="alert">✗ {escape(text)}</pre>' if text else ""


def tetrad(reply: Json) -> str:
    """Cards of a tetrad, or what is wrong."""
    faults = len(reply.get("errors", {}))
    message = ""
    if faults:
        entries = "1 entry" if faults == 1 else f"{faults} entries"
        message = notice(f"{entries} cannot be read; the reason stands beside each.")
    shown = reply.get("html", "")
    return wrapped(problem(reply) + message + shown + (words(TETRAD) if shown else ""))


def loop(reply: Json) -> str:
    """A loop, its image, and what is seen of its Burgers vector."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    pictures = "".join(f"<div>{picture}</div>" for picture in reply["pictures"])
    said = f'<p class="said" id="loop-said">{escape(reply["sentence"])}</p>'
    return wrapped(f'<div class="pair" id="loop">{pictures}</div>{said}')


def loop_below(reply: Json) -> str:
    """The numbers of a loop, and its words."""
    return wrapped(f'<div class="later">{reply.get("table", "")}{words(LOOPS)}</div>')


def map_field(field: object) -> str:
    """What a map or image of one's own is for, and the field that takes it."""
    text = (
        f'<h2>A map or an image of your own</h2><p class="guide">{escape(MEASURED.seen)}</p>'
        f'<p class="guide"><strong>Try:</strong> {escape(MEASURED.tried)}</p>'
    )
    return wrapped(f'<div class="measured">{text}<div class="controls">{field}</div></div>')


def map_told(facts: Json) -> str:
    """What a map is, or why it is none."""
    if facts.get("problem"):
        return wrapped(f'<div class="measured" id="map-problem">{problem(facts)}</div>')
    return wrapped(f'<p class="measured" id="map-facts">{escape(facts["sentence"])}</p>')


def measured(reply: Json) -> str:
    """The picture of a map with a circuit, and its Burgers vector or why it has none."""
    if reply.get("problem"):
        return wrapped(f'<div class="measured" id="map-problem">{problem(reply)}</div>')
    if reply.get("refused"):
        side = notice(reply["refused"])
    else:
        side = f'<p class="said">{escape(reply["sentence"])}</p>{reply["table"]}'
    picture = f'<div id="map">{reply["picture"]}</div>'
    both = f'<div class="figures">{picture}<div id="map-said">{side}</div></div>'
    return wrapped(f'<div class="measured">{both}{_terms(MEASURED)}</div>')


def paths(reply: Json) -> str:
    """Two curves and how far they are apart."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    said = f'<p class="said" id="paths-said">{escape(reply["sentence"])}</p>'
    curves = framed(reply) or reply.get("picture", "")
    side = f"<div>{said}{reply['distance']}</div>"
    return wrapped(f'<div class="figures"><div>{curves}</div>{side}</div>')


def paths_below(reply: Json) -> str:
    """How two curves were computed, and the words."""
    return wrapped(f'<div class="later">{reply.get("table", "")}{words(PATHS)}</div>')


def costs(reply: Json) -> str:
    """Picture, advice and measurements."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    truth = f" Errors against {escape(reply['truth'])}." if "truth" in reply else ""
    said = f'<p class="said" id="costs-said">{reply["advice"]}{truth}</p>'
    picture = f'<div class="one">{reply["picture"]}</div>'
    return wrapped(f"{said}{picture}{reply['table']}{words(COSTS)}")


def top(reply: Json) -> str:
    """A film of the top, and what is watched, by the naive law too."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    said = f'<p class="said" id="top-said">{escape(reply["sentence"])}</p>'
    side = f"<div>{said}{reply['compared']}</div>"
    return wrapped(f'<div class="figures"><div>{framed(reply)}</div>{side}</div>')


def top_below(reply: Json) -> str:
    """How the top was computed, its plan, and the words."""
    plan = f'<div id="top-plan">{reply["plan"]}</div>' if "plan" in reply else ""
    return wrapped(f'<div class="later">{reply.get("table", "")}{plan}{words(TOP)}</div>')


def exercise(reply: Json) -> str:
    """Statement of an exercise."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    head = f"<h2>{escape(reply['number'])} {escape(reply['title'])}</h2>"
    facts = f"{escape(reply['chapter'])}; {escape(reply['level'])}; variant {reply['seed']}"
    stated = f'<div class="sideways" id="statement">{reply["statement"]}</div>'
    return wrapped(f'{head}<p class="note">{facts}</p>{stated}')


def verdict(reply: Json | None) -> str:
    """What is said about answers; nothing if none were given."""
    if reply is None:
        return ""
    if reply.get("problem"):
        return wrapped(problem(reply))
    if not reply["questions"]:
        return wrapped('<p class="note">Write an answer first.</p>')
    parts = []
    for one in reply["questions"]:
        look, sign = ("right", "✓ right") if one["right"] else ("wrong", "✗ not right")
        parts.append(
            f'<div class="{look}" role="status"><strong>{escape(one["name"])}: {sign}</strong>'
            f"{one['message']}</div>"
        )
    notes = "".join(f'<p class="note">{escape(note)}</p>' for note in reply["notes"])
    points = f"{reply['earned']:.3g} of {reply['points']} points"
    parts.append(f'{notes}<p class="note">{points}</p>')
    return wrapped(f'<div class="sideways" id="verdict">{"".join(parts)}</div>')


def steps(reply: Json) -> str:
    """Hints, in order."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    items = "".join(f"<li>{hint}</li>" for hint in reply["hints"])
    return wrapped(f'<div class="sideways"><ol id="hints">{items}</ol></div>' if items else "")


def framed(reply: Json) -> str:
    """The turnable picture of a reply in a frame of its own, with all it needs; or nothing."""
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

    kind "after": on a narrow window they stand below the picture that they change.
    """
    inner = "".join(f"<div>{piece}</div>" for piece in pieces)
    return wrapped(f'<div class="controls {kind}">{inner}</div>')

"""views: answers of tasks as HTML, the same for the served page and for pages without a server."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, wraps
from html import escape
from pathlib import Path

from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.plot import saving
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.uploads import TEXT_MAPS


@dataclass(frozen=True)
class Guide:
    """Sentences for one tab.

    seen: the displayed objects. tried: the first action to try. words: term -> its meaning.
    """

    seen: str
    tried: str
    words: Mapping[str, str] = field(default_factory=dict)


# Name of a tab -> the displayed objects, and an action to try: one sentence each.
GUIDES: Mapping[str, Guide] = {
    "The compass": Guide(
        "The blue ship keeps its compass course, the orange ship sails along a great circle, and "
        "torsion separates their paths.",
        "Press Play, drag the globe to turn it, and set the course to 90 degrees, where the blue "
        "ship stays on its circle of latitude and the orange ship leaves it.",
        {
            "torsion": "two small steps along the legs (unit vectors, here east and north) end at "
            "different points if their order is changed.",
        },
    ),
    "Loops": Guide(
        "The blue curve is a closed loop in two coordinates, the green curve adds up the same "
        "steps, measured along the legs (unit vectors) of the frame at each point, and its gap "
        "(orange) is the Burgers vector b.",
        "Make the radius smaller and compare b with 2 S A in the table, then choose the space "
        "screw_dislocation, where b is the same for every circle around the line.",
        {
            "b": "the Burgers vector: the gap between the start and the end of the green curve, "
            "one component for each leg of the frame.",
            "X¹, X², ...": "the sums of the steps along legs 1, 2, ...: the coordinates of the "
            "green curve.",
            "flux of torsion": "the integral of the torsion over a surface bounded by the loop. "
            "By Stokes' theorem it equals b, unless the frame is singular on a line through the "
            "surface.",
            "2 S A": "twice the torsion S at the centre times the area A inside the loop: the flux "
            "of a small loop.",
            "black dot": "the start of each curve.",
            "units": "lengths have the unit of the frame, and angles are in radians.",
        },
    ),
    "Straightest and shortest": Guide(
        "Two curves start at one point with one velocity: the straightest (solid blue) keeps its "
        "velocity along the legs of the frame, and the shortest (dashed orange) is a geodesic.",
        "Press Play and drag the figure to turn it, then choose the space so3 and change the "
        "moments of inertia: with equal moments the two curves coincide.",
        {
            "straightest (autoparallel)": "a curve whose velocity has constant components u1, u2, "
            "... along the legs of the frame.",
            "shortest (geodesic)": "the shortest path between any two close points on it. With "
            "moments of inertia, the square of the speed is I1 u1² + I2 u2² + I3 u3².",
            "torsion force": "2 S_a^c_b q'^a q'^b, the acceleration that separates the straightest "
            "curve from the shortest; S is the torsion, and q' the velocity in coordinates.",
            "t": "the time, the parameter of both curves.",
            "marks": "a black dot is the start, the other marks are the ends; the green line is "
            "the distance between the two curves.",
            "units": "lengths have the unit of the frame, and angles are in radians. Only the "
            "ratios of the moments matter.",
        },
    ),
    "The top": Guide(
        "The body cone (orange) rolls on the space cone (blue) and touches it along the angular "
        "velocity ω, and the chart compares the right law of motion with a wrong one.",
        "Press Play, then set all three moments to 2, where both laws agree, and then switch on "
        "gravity and the fixed point to get a heavy top.",
        {
            "ω": "the angular velocity, with components along the fixed axes x, y, z.",
            "Ω": "the same angular velocity, with components Ω1, Ω2, Ω3 along the body axes 1, 2, "
            "3; the sliders set it at the start.",
            "body cone": "the cone of all directions of ω in the body. It rolls on the space cone "
            "without slipping.",
            "space cone": "the cone of all directions of ω in space.",
            "I1, I2, I3": "the moments of inertia about the body axes.",
            "L and M": "the angular momentum and the torque, along the body axes. A prime is the "
            "rate of change.",
            "torsion force": "a force that acts like torsion: with it, a free body follows the "
            "straightest curve instead of the shortest.",
            "naive law": "L′ = M in body axes. It omits the term Ω × L, which is there because the "
            "body axes turn.",
            "nutation": "the angle between body axis 3 and the vertical z; tilt is its value at "
            "the start.",
            "attitude": "the matrix R that turns components along the body axes into components "
            "along x, y, z.",
            "black dot": "the start of a curve.",
        },
    ),
    "What accuracy costs": Guide(
        "Each mark is one computation of the loop, the curves or the top of the other tabs: "
        "further right is more accurate, and further down is faster.",
        "Measure the loop and find the fastest rule with an error below 1e-12, then make the loop "
        "smaller on its own tab and measure again.",
        {
            "error": "the largest deviation divided by the largest component, against a closed "
            "form or a computation with many more digits.",
            "trapezoid, Gauss": "rules that integrate along the loop; each mark has a different "
            "number of points.",
            "flux": "the integral of the torsion over the disk bounded by the loop.",
            "burgers_vector": "the function of this library: it computes the loop and the flux and "
            "estimates the error.",
            "Taylor, RungeKutta": "the two methods of this library that solve equations of motion.",
        },
    ),
    "Any tetrad": Guide(
        "Each row of fields holds the coefficients of one one-form, and the page computes "
        "exactly, from all rows together, the metric, the connections, the torsion and the "
        "curvature.",
        "Start from flat_polar, where the torsion is not zero, then type cos(phi) and -r*sin(phi) "
        "into row 1, sin(phi) and r*cos(phi) into row 2: the metric stays the same and the torsion "
        "vanishes.",
        {
            "tetrad (coframe) e": "n one-forms e^1, ..., e^n: they give the components of a step "
            "along n legs at every point. E are the legs, the inverse matrix.",
            "signature, η": "the signs of the squares of the legs, and the diagonal matrix of "
            "these signs.",
            "torsion S": "the part of the connection that is antisymmetric in its lower indices. "
            "Two small steps end at different points if their order is changed.",
            "Levi-Civita connection": "the connection without torsion that keeps lengths. A bar "
            "marks it and its curvature.",
            "Cartan connection": "the connection in which the legs are parallel everywhere.",
            "contortion K": "the Cartan connection minus the Levi-Civita connection.",
            "unknown function": "a function such as a(t). The result contains its derivatives.",
            "indices": "an index written as a coordinate name belongs to that coordinate. A "
            "number with a hat counts the legs of the frame from 1.",
        },
    ),
    "Exercises": Guide(
        "The page checks your answer exactly, accepts every equivalent form of it, and shows the "
        "likely mistake if it is wrong.",
        "Type an answer, press Check, and take a hint if you need one; every variant number is "
        "another task of the same kind, and an unreadable answer costs no points.",
    ),
}

# Two more parts of the tab for loops.
ATOMS = Guide(
    "The first figure is a square crystal with an edge dislocation. A circuit is a closed walk "
    "from atom to atom. The second figure repeats your steps in a perfect lattice, where the gap b "
    "of a circuit is a whole number of lattice vectors.",
    "Press Show a circuit, then click circuits of your own around the core and beside it, and "
    "choose two opposite dislocations to go around one, the other and both.",
    {
        "extra half plane": "the column of atoms that ends at the core. A circuit has one more "
        "step on its side; this step is missing on the other side.",
        "core": "the region where the bonds are too distorted to read. Circuits stay outside of "
        "it, and their exact path does not matter.",
    },
)
MEASURED = Guide(
    "Choose a grid of a coframe or distortion (NPZ or CSV, as SampledFrame.save writes it), an "
    f"orientation map ({', '.join(TEXT_MAPS)}) or a lattice image (PNG, TIFF, NPY). The page draws "
    "it and reports b for the square circuit. The colour at a point is |b| / area of a circuit of "
    f"this size centred there. The limits are {PAGE.upload / 1e6:g} MB, {PAGE.nodes:,} nodes and "
    f"{PAGE.pixels:,} pixels. The file stays in the memory of the machine that serves this page.",
    "Move the circuit to a bright spot and then beside it. Make it larger and watch the noise per "
    "area fall. Move it across a grain boundary or the edge of a hole and read the message. In a "
    "lattice image, look where the whole numbers change.",
    {
        "whole numbers": "the number of turns of the phases of two lattice waves along the "
        "circuit. In an image b is exact, unless noise adds or removes a full turn of a phase.",
        "noise": "one standard deviation of each component, added up from the noise of each node "
        "or pixel along this circuit.",
        "interpolation": "the change of b with another order of interpolation between the nodes.",
        "|b| per area": "for an orientation map, the density of the dislocations that bend the "
        "lattice times the length of their Burgers vector.",
    },
)


# Name of a tab -> its contents in a sentence.
TABS = {
    "The compass": "A ship on a compass course and one on a great circle.",
    "Loops": "A closed loop whose image in the frame has a gap where there is torsion.",
    "Straightest and shortest": "Two curves with one start, separated by torsion.",
    "The top": "A turning body: its cones, the right law and a wrong one, and its equations.",
    "What accuracy costs": "Error against time for the case of another tab.",
    "Any tetrad": "Type one-forms; read metric, connections, torsion and curvature, exactly.",
    "Exercises": "Tasks in variants, with verdicts and hints.",
}
COMPASS, LOOPS, PATHS, TOP, COSTS, TETRAD, EXERCISES = TABS


@cache
def style() -> str:
    """The style sheet of the page."""
    return Path(__file__).with_name("lab.css").read_text("utf-8")


@cache
def copying() -> str:
    """The scripts that copy LaTeX and save pictures."""
    return Path(__file__).with_name("copy.js").read_text("utf-8") + saving()


@cache
def wrapped(html: str) -> str:
    """HTML to which the style sheet applies."""
    return f'<div class="lab">{html}</div>'


def header() -> str:
    """The title above all tabs."""
    return wrapped("<h1>Torsion lab</h1>")


def intro(tab: str, *, still: bool = False) -> str:
    """The displayed objects of a tab, and an action to try if the page has controls."""
    return wrapped(_guide(GUIDES[tab], still=still))


def _guide(guide: Guide, *, still: bool = False) -> str:
    tried = f'<p class="guide"><strong>Try:</strong> {escape(guide.tried)}</p>'
    return f'<p class="guide">{escape(guide.seen)}</p>{"" if still else tried}'


def words(tab: str) -> str:
    """The terms of a tab, explained."""
    return _terms(GUIDES[tab])


def _terms(guide: Guide) -> str:
    items = "".join(
        f"<dt>{escape(term)}</dt><dd>{escape(text)}</dd>" for term, text in guide.words.items()
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
    points = f"{reply['earned']:.3g} of {reply['points']} points"
    parts.append(f'{notes}<p class="note">{points}</p>')
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

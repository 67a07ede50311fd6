"""views: answers of tasks as HTML, the same for the served page and for pages without a server."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from html import escape
from pathlib import Path

from geomtorsion.teaching.exercises.worker_pool import Json
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
        "One ship keeps its compass course (solid blue), another sails along a great circle "
        "(dashed orange), and torsion makes the two paths separate.",
        "Move the course, press Play, and drag the globe to turn it: at 90 degrees the first ship "
        "stays on its parallel, and the second one leaves it.",
    ),
    "Loops": Guide(
        "The left figure shows a circle in two coordinates, and the right figure adds up the same "
        "steps along the legs of the frame: the gap is the Burgers vector b.",
        "Make the radius smaller and compare b with 2 S A; then choose screw_dislocation, where b "
        "is the same for every circle around the line.",
        {
            "b": "the Burgers vector: the gap between start and end of the image of a closed loop, "
            "one component for each leg of the frame.",
            "X¹, X², ...": "the sums of the steps along legs 1, 2, ...: the coordinates of the "
            "right figure.",
            "flux of torsion": "the integral of the torsion over a surface that the loop bounds; "
            "by Stokes' theorem it is b, unless the frame is singular on a line through the "
            "surface.",
            "2 S A": "twice the torsion S at the centre times the area A inside the loop: the flux "
            "of a small loop.",
            "colours": "blue is the loop, green its image, orange the gap b; a black dot is the "
            "start.",
            "units": "lengths have the unit in which the frame is written, angles are in radians.",
        },
    ),
    "Straightest and shortest": Guide(
        "Two curves leave one start with one velocity: the straightest (solid blue) keeps its "
        "velocity along the legs of the frame, the shortest (dashed orange) is a geodesic.",
        "Press Play and turn the figure; then choose so3 and change the moments of inertia: with "
        "equal moments both curves are one.",
        {
            "straightest (autoparallel)": "a curve whose components u1, u2, ... of the velocity "
            "along the legs of the frame are constant.",
            "shortest (geodesic)": "a curve such that no other curve between two close points of "
            "it is shorter; the moments I1, I2, I3 are the weights of the squares of u1, u2, u3.",
            "torsion force": "2 S_a^c_b q'^a q'^b, the acceleration with which the straightest "
            "curve leaves the shortest one; S is the torsion, q' the velocity in coordinates.",
            "t": "the time, the parameter of both curves.",
            "colours": "blue is the straightest curve, orange the shortest, green their distance; "
            "a black dot is the start, the other marks are the ends.",
            "units": "lengths have the unit of the frame, angles are in radians; only the ratios "
            "of the moments matter.",
        },
    ),
    "The top": Guide(
        "A body turns: its angular velocity ω draws the body cone (orange), which rolls on the "
        "space cone (blue), and the chart compares the right law with a wrong one.",
        "Press Play; set all three moments to 2, where both laws agree; then switch on gravity "
        "and the fixed point for a heavy top.",
        {
            "ω and Ω": "the angular velocity along the axes of space, and along the axes of the "
            "body.",
            "body cone": "the cone that ω draws in the body; it rolls without slipping on the "
            "space cone.",
            "space cone": "the cone that ω draws in space.",
            "L and M": "the angular momentum and the torque, along the axes of the body; a prime "
            "is the rate of change.",
            "torsion force": "a force that bends free motion as torsion would: with it the body "
            "follows the straightest curve and not the shortest one.",
            "naive law": "L′ = M in body axes, without the term Ω × L: it forgets that the axes "
            "turn with the body.",
            "nutation": "the angle of body axis 3 from the vertical.",
            "colours": "blue, orange, green and black belong to the animation, purple (right law) "
            "and brown (naive law) to the chart; a black dot is the start.",
        },
    ),
    "What accuracy costs": Guide(
        "Each mark is one way to compute the case of another tab: further right is more accurate, "
        "further down is faster.",
        "Measure the loop and find the first rule with an error below 1e-12; then make the loop "
        "smaller on its tab and measure again.",
        {
            "error": "the largest deviation relative to the largest component, measured against a "
            "closed form or a computation with many more digits.",
        },
    ),
    "Any tetrad": Guide(
        "Each row is a one-form, given by its coefficients of the coordinate differentials, and "
        "below are the metric, the connections, the torsion and the curvature, computed exactly.",
        "Start from flat_polar and read its torsion; then type cos(phi) and -r*sin(phi) into row "
        "1, sin(phi) and r*cos(phi) into row 2: the metric is the same, the torsion is zero.",
        {
            "tetrad (coframe)": "n one-forms e^1, ..., e^n; they give the components of a step "
            "along n legs at every point.",
            "torsion S": "the part of the connection that is antisymmetric in its lower indices: "
            "two small steps, taken in either order, end at different points.",
            "contortion K": "the difference between the Cartan and the Levi-Civita connection.",
            "unknown function": "a function such as a(t); its derivatives stay in the result.",
            "indices": "coordinates stand for coordinate indices; frame indices are counted from 1 "
            "and have a hat.",
        },
    ),
    "Exercises": Guide(
        "Every equivalent form of an answer is right, and for a wrong answer the page names the "
        "likely mistake; an answer that cannot be read costs no points.",
        "Answer, read the verdict, and take a hint; variant 0 is the exercise from the paper, and "
        "every other number gives another variant of the exercise.",
    ),
}

# The part of the tab for loops that takes a file.
ATOMS = Guide(
    "A square lattice with an edge dislocation, as elasticity bends it. Each bond is read as the "
    "nearest lattice vector, and the right figure shows the same steps in a perfect lattice: the "
    "gap of a circuit that closes in the crystal is b, in whole numbers.",
    "Press Show a circuit. Then click circuits of your own: around the core, near it and far away, "
    "and beside it. Then choose two opposite dislocations. Go around one, around the other, and "
    "around both.",
    {
        "extra half plane": "the column of atoms that ends at the core: on its side a circuit has "
        "a step more, and that is the step that is missing on the other.",
        "core": "where the bonds are so bent that no lattice vector is clearly the nearest; "
        "circuits stay outside of it, and it does not matter which way they take.",
    },
)
MEASURED = Guide(
    "A measured map: a grid of a coframe or distortion (NPZ or CSV, as SampledFrame.save writes "
    f"it), an orientation map ({', '.join(TEXT_MAPS)}) or an image of a lattice (PNG, TIFF, NPY). "
    "Colours show |b| per area of square circuits of one size, each at its middle; an image is "
    "shown as it is. "
    "The square outline is the circuit, and b is given for it. The page takes up to "
    f"{PAGE.upload / 1e6:g} MB, {PAGE.nodes:,} nodes or {PAGE.pixels:,} pixels. The file stays in "
    "the memory of the machine that serves this page.",
    "Put the circuit around a bright spot, then beside it; make it larger and see the noise per "
    "area fall; lead it across a grain boundary or the edge of a hole, and read what is said; in a "
    "picture b is made of whole numbers: look where they change.",
    {
        "whole numbers": "how often the phases of two waves of the lattice turn along the circuit: "
        "in a picture b is exact, but for the chance that noise turns a phase once more.",
        "noise": "one standard deviation of each component, from the noise of every node or pixel, "
        "added up along this very circuit.",
        "interpolation": "what another order of interpolation between the nodes would change.",
        "|b| per area": "for an orientation map the density of dislocations that bend the lattice, "
        "times the length of their Burgers vector.",
    },
)


# Name of a tab -> its contents in a sentence.
TABS = {
    "The compass": "A ship on a compass course and one on a great circle.",
    "Loops": "A closed loop whose image in the frame has a gap where there is torsion.",
    "Straightest and shortest": "Two curves from one start, which torsion drives apart.",
    "The top": "A turning body: the right law, a wrong one, and the equations that are needed.",
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
def saving() -> str:
    """The script that saves pictures; turnable pictures also contain it."""
    return Path(__file__).with_name("save.js").read_text("utf-8")


def wrapped(html: str) -> str:
    """HTML to which the style sheet applies."""
    return f'<div class="lab">{html}</div>'


def header() -> str:
    """The title above all tabs."""
    return wrapped("<h1>Torsion lab</h1>")


def intro(tab: str, *, still: bool = False) -> str:
    """The displayed objects of a tab, and an action to try if the page has controls."""
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


def tetrad(reply: Json) -> str:
    """Cards of a tetrad, or its error."""
    faults = len(reply.get("errors", {}))
    message = ""
    if faults:
        entries = "1 entry" if faults == 1 else f"{faults} entries"
        message = notice(f"{entries} cannot be read; the reason stands beside each.")
    shown = reply.get("html", "")
    return wrapped(problem(reply) + message + shown + (words(TETRAD) if shown else ""))


def loop(reply: Json) -> str:
    """A loop, its image, and a description of its Burgers vector."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    pictures = "".join(f"<div>{picture}</div>" for picture in reply["pictures"])
    said = f'<p class="said" id="loop-said">{escape(reply["sentence"])}</p>'
    return wrapped(f'<div class="pair" id="loop">{pictures}</div>{said}')


def loop_below(reply: Json) -> str:
    """The numbers of a loop, and its words."""
    return wrapped(f'<div class="later">{reply.get("table", "")}{words(LOOPS)}</div>')


def atoms(reply: Json) -> str:
    """A crystal with clickable circuits, and an action to try."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    text = (
        f'<h2>From atom to atom</h2><p class="guide">{escape(ATOMS.seen)}</p>'
        f'<p class="guide"><strong>Try:</strong> {escape(ATOMS.tried)}</p>'
    )
    return wrapped(f'<div class="atoms" id="atoms">{text}{framed(reply)}</div>{_terms(ATOMS)}')


def map_field(field: object) -> str:
    """The purpose of an uploaded map or image, and the field for the file."""
    text = (
        f'<h2>A map or an image of your own</h2><p class="guide">{escape(MEASURED.seen)}</p>'
        f'<p class="guide"><strong>Try:</strong> {escape(MEASURED.tried)}</p>'
    )
    return wrapped(f'<div class="measured">{text}<div class="controls">{field}</div></div>')


def map_told(facts: Json) -> str:
    """Description of a map, or the reason why the file is not one."""
    if facts.get("problem"):
        return wrapped(f'<div class="measured" id="map-problem">{problem(facts)}</div>')
    return wrapped(f'<p class="measured" id="map-facts">{escape(facts["sentence"])}</p>')


def measured(reply: Json) -> str:
    """The picture of a map with a circuit, and its Burgers vector or the reason why it has none."""
    if reply.get("problem"):
        return wrapped(f'<div class="measured" id="map-problem">{problem(reply)}</div>')
    if reply.get("refused"):
        side = notice(reply["refused"])
    else:
        side = f'<p class="said">{escape(reply["sentence"])}</p>{reply["table"]}'
    picture = f'<div id="map">{reply["picture"]}</div>'
    both = f'<div class="figures">{picture}<div id="map-said">{side}</div></div>'
    return wrapped(f'<div class="measured">{both}{_terms(MEASURED)}</div>')


def compass(reply: Json) -> str:
    """The globe with both paths."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    return wrapped(f'<div class="globe" id="compass">{framed(reply)}</div>')


def paths(reply: Json) -> str:
    """Two curves and the distance between them."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    said = f'<p class="said" id="paths-said">{escape(reply["sentence"])}</p>'
    curves = framed(reply) or reply.get("picture", "")
    side = f"<div>{said}{reply['distance']}</div>"
    return wrapped(f'<div class="figures"><div>{curves}</div>{side}</div>')


def paths_below(reply: Json) -> str:
    """Methods and errors of two curves, and the terms."""
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
    """An animation of the top, and the watched quantities, also by the naive law."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    said = f'<p class="said" id="top-said">{escape(reply["sentence"])}</p>'
    side = f"<div>{said}{reply['compared']}</div>"
    return wrapped(f'<div class="figures"><div>{framed(reply)}</div>{side}</div>')


def top_below(reply: Json) -> str:
    """Method and errors of the top, its plan, and the terms."""
    plan = f'<div id="top-plan">{reply["plan"]}</div>' if "plan" in reply else ""
    return wrapped(f'<div class="later">{reply.get("table", "")}{plan}{words(TOP)}</div>')


def exercise(reply: Json) -> str:
    """Statement of an exercise."""
    if reply.get("problem"):
        return wrapped(problem(reply))
    head = f"<h2>{escape(reply['number'])} {escape(reply['title'])}</h2>"
    facts = f"{escape(reply['chapter'])}; {escape(reply['level'])}; variant {reply['seed']}"
    stated = f'<div class="sideways" id="statement">{reply["statement"]}</div>'
    return wrapped(f'{head}<p class="note">{facts}</p>{stated}{reply["copy"]}')


_LOOKS = {"right": ("right", "✓"), "wrong": ("wrong", "✗")}


def verdict(reply: Json | None) -> str:
    """The verdict on answers; empty without answers."""
    if reply is None:
        return ""
    if reply.get("problem"):
        return wrapped(problem(reply))
    if not reply["questions"]:
        return wrapped('<p class="note">Write an answer first.</p>')
    parts = []
    for one in reply["questions"]:
        look, sign = _LOOKS.get(one["state"], ("unread", "?"))
        read = f'<p class="note">Read as: <code>{escape(one["read_as"])}</code></p>'
        parts.append(
            f'<div class="{look}" role="status"><strong>{escape(one["name"])}: {sign} '
            f"{escape(one['state'])}</strong>{one['message']}{read * bool(one['read_as'])}"
            f"{one['copy']}</div>"
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
    if not items:
        return wrapped("")
    return wrapped(f'<div class="sideways"><ol id="hints">{items}</ol></div>{reply["copy"]}')


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

"""tabs: what the page without a server shows on each tab, from what stands in its controls."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING, cast

from geomtorsion.exercises.worker_pool import Json
from geomtorsion.lab import controls, exercise_controls, tetrad_controls, views
from geomtorsion.lab.equations import PRINCIPLES
from geomtorsion.lab.kept import Kept
from geomtorsion.lab.live.guides import NOT_HERE, UNGRADED
from geomtorsion.lab.live.toolkit import Choice, Form, row
from geomtorsion.lab.tetrad import OFFERED

if TYPE_CHECKING:
    from geomtorsion.lab.tasks import Runner

# Spaces in which a body turns, and the energy with which its tab begins; in others every velocity
# counts alike.
SPIN = "(I1*u1^2 + I2*u2^2 + I3*u3^2)/2"
MOMENTS = "I1, I2, I3"


@dataclass(frozen=True)
class Shown:
    """A tab as it is to be shown.

    controls: HTML of the form, with empty places for `parts`. shape: tells forms apart that have
    other controls; equal ones are left as they stand, so that nobody's typing is disturbed.
    parts: place -> HTML. kept: key -> text for the address and what it is where nothing changed.
    """

    controls: str
    shape: str
    parts: Mapping[str, str]
    kept: Mapping[str, tuple[str, str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Asked:
    """What the browser asks for: a form as it stands, what was kept in the address, and an action.

    action: "check" where answers are to be looked at, else nothing.
    """

    form: Form
    kept: Kept
    action: str = ""


def tetrad(asked: Asked, runner: Runner) -> Shown:
    """A typed tetrad and its geometry."""
    form, kept = asked.form, asked.kept
    beginning = tetrad_controls.starts(form, kept)
    shown = tetrad_controls.offered(form, kept)
    facts = tetrad_controls.facts(beginning.value, runner)
    own = kept.of_case("start", beginning.value, tetrad_controls.first_start())
    names = tetrad_controls.names(form, facts, own)
    named = _texts(names.value)
    columns = tetrad_controls.coordinates(named)
    entries = tetrad_controls.entries(form, columns, tetrad_controls.typed(facts, own))
    n = len(columns)
    rows = tetrad_controls.rows(_texts(entries.value), n)
    show = [name for name, wanted in shown.value.items() if wanted]
    reply = runner.ask("tetrad", **tetrad_controls.tetrad_case(named, rows, show))
    places = [(i, k) for i in range(n) for k in range(n)]
    cells = [f'{entries[f"{i},{k}"]}<div data-part="fault {i},{k}"></div>' for i, k in places]
    return Shown(
        row([beginning, *names.values()])
        + views.grid(cells, n)
        + f"<details><summary>What to show</summary>{row(list(shown.values()))}</details>",
        f"{beginning.value}|{columns}",
        {"result": views.tetrad(reply)}
        | {f"fault {i},{k}": views.fault(reply, i, k) for i, k in places},
        tetrad_controls.kept_tetrad(beginning.value, facts, named, rows, show),
    )


def _texts(values: Mapping[str, object]) -> dict[str, str]:
    return {name: str(value) for name, value in values.items()}


def loops(asked: Asked, runner: Runner) -> Shown:
    """A circle and its Burgers vector in closed form."""
    form, kept = asked.form, asked.kept
    space = controls.spaces(form, controls.FIRST_LOOP, kept, "loop")
    facts = runner.ask("space_form", space=space.value)
    own = kept.of_case("loop", space.value, controls.FIRST_LOOP)
    plane = controls.plane(form, facts, own)
    radius = form.text(value=own.text("radius form", facts["radius"]), label="radius")
    begin = _exact_centre(facts)
    given = own.text("centre form", ";".join(begin)).split(";")
    given = given if len(given) == len(begin) else begin
    names = facts["coordinates"]
    centre = form.dictionary(
        {
            f"centre {name}": form.text(value=text, label=f"centre, {controls.with_unit(name)}")
            for name, text in zip(names, given, strict=True)
        }
    )
    at = list(centre.value.values())
    reply = runner.ask(
        "circle_form", space=space.value, centre=at, radius=radius.value, plane=plane.value
    )
    shown = [controls.greek_name(name) for name in names]
    i, k = plane.value
    usual = facts["planes"][0]
    return Shown(
        row([space, plane, radius, *centre.values()]),
        space.value,
        {"result": _result(reply, "loop-said")},
        {
            "loop": (space.value, controls.FIRST_LOOP),
            "radius form": (radius.value, facts["radius"]),
            "centre form": (";".join(at), ";".join(begin)),
            "plane": (f"{shown[i]}, {shown[k]}", f"{shown[usual[0]]}, {shown[usual[1]]}"),
        },
    )


def _exact_centre(facts: Json) -> list[str]:
    """Where the first circle of a space is: half a unit along what is an angle or a radius."""
    away = ("theta", "phi2", "r", "chi")
    return ["1/2" if name in away else "0" for name in facts["coordinates"]]


def paths(asked: Asked, runner: Runner) -> Shown:
    """The equations of the straightest and the shortest curves."""
    space = controls.spaces(asked.form, controls.FIRST_PATH, asked.kept, "path")
    reply = runner.ask("curve_equations", space=space.value)
    return Shown(
        row([space]),
        "",
        {"result": _result(reply, "paths-said")},
        {"path": (space.value, controls.FIRST_PATH)},
    )


def top(asked: Asked, runner: Runner) -> Shown:
    """What follows from an action: the equations of a body that turns, or of anything else."""
    form, kept = asked.form, asked.kept
    space = controls.spaces(form, "so3", kept, "over")
    own = kept.of_case("over", space.value, "so3")
    usual, names = _first_action(space.value, runner)
    action = form.text_area(value=own.text("L", usual), label="Lagrangian L(q, u, t)", rows=2)
    parameters = form.text(value=own.text("constants", names), label="parameters")
    titles = {title: name for name, title in PRINCIPLES.items()}
    first = kept.one_of("principle", list(PRINCIPLES), next(iter(PRINCIPLES)))
    principle = form.dropdown(titles, value=PRINCIPLES[first], label="variations")
    reply = runner.ask(
        "equations", space=space.value, lagrangian=action.value, parameters=parameters.value,
        principle=principle.value,
    )  # fmt: skip
    return Shown(
        row([space, principle, parameters]) + str(action),
        space.value,
        {"result": _result(reply, "top-said")},
        {
            "over": (space.value, "so3"),
            "L": (action.value, usual),
            "constants": (parameters.value, names),
            "principle": (principle.value, next(iter(PRINCIPLES))),
        },
    )


def _first_action(space: str, runner: Runner) -> tuple[str, str]:
    """The kinetic energy with which a space begins, and its parameters."""
    if space in controls.BODIES:
        more = " + m*(u4^2 + u5^2 + u6^2)/2" if space == "r3xso3" else ""
        return f"{SPIN}{more}", f"{MOMENTS}{', m' if more else ''}"
    facts = runner.ask("space_form", space=space)
    signs = facts["signature"]
    terms = [f"{sign} u{k}^2/2" for k, sign in enumerate(signs, 1) if sign in "+-"]
    return " ".join(terms).removeprefix("+ "), ""


def exercises(asked: Asked, runner: Runner) -> Shown:
    """An exercise, and what is said about its answers."""
    form, kept = asked.form, asked.kept
    listing = runner.ask("listing")
    chosen = cast(Choice, exercise_controls.exercises(form, listing, kept))
    chosen.apart(NOT_HERE, UNGRADED)
    seed = exercise_controls.seed(form, kept)
    variant = exercise_controls.variant(seed.value)
    stated = runner.ask("exercise", number=chosen.value, seed=variant)
    head = row([chosen, seed])
    shape = f"{chosen.value}|{variant}"
    if "number" not in stated:
        return Shown(head, shape, {"result": views.exercise(stated)})
    fields = exercise_controls.answers(form, stated, kept)
    hint = exercise_controls.next_hint(form, stated)
    taken = runner.ask("hints", number=stated["number"], seed=stated["seed"], count=hint.value)
    parts = {"result": views.steps(taken)}
    if asked.action == "check":
        given = exercise_controls.given(stated, fields.value)
        reply = runner.ask("answer", number=stated["number"], seed=stated["seed"], answers=given)
        parts["verdict"] = views.verdict(reply)
    first = next(iter(chosen.options.values()))
    return Shown(
        f"{head}{views.exercise(stated)}{fields}"
        '<p><button type="button" data-action="check">Check</button></p>'
        f'<div data-part="verdict"></div><p>{hint}</p>',
        shape,
        parts,
        exercise_controls.kept_exercise(stated, first, fields.value),
    )


def _result(reply: Json, name: str) -> str:
    """A sentence and what it is about, or why there is none."""
    if reply.get("problem"):
        return views.wrapped(views.problem(reply))
    return views.wrapped(
        f'<p class="said" id="{name}">{escape(reply["sentence"])}</p>{reply["html"]}'
    )


# Tab -> (who shows it, the control that begins a new case, what survives that).
TABS: Mapping[str, tuple[Callable[[Asked, Runner], Shown], frozenset[str], frozenset[str]]] = {
    views.TETRAD: (tetrad, frozenset({"start from"}), frozenset(OFFERED)),
    views.LOOPS: (loops, frozenset({"space"}), frozenset()),
    views.PATHS: (paths, frozenset({"space"}), frozenset()),
    views.TOP: (top, frozenset({"space"}), frozenset({"variations"})),
    views.EXERCISES: (exercises, frozenset({"exercise", "variant"}), frozenset()),
}
# Tab -> the tasks that are asked for it, which say how long it may take.
TASKS: Mapping[str, tuple[str, ...]] = {
    views.TETRAD: ("space_form", "tetrad"),
    views.LOOPS: ("space_form", "circle_form"),
    views.PATHS: ("curve_equations",),
    views.TOP: ("space_form", "equations"),
    views.EXERCISES: ("exercise", "answer"),
}


def show(request: Json, runner: Runner) -> Json:
    """A tab for the browser.

    Parameters
    ----------
    request
        tab; values: name of a control -> text, empty when the tab is opened; kept: what stands in
        the address, from which begins what is opened; changed: controls that were changed since;
        action: "check" or nothing.

    Returns
    -------
    controls, shape, parts as in `Shown`; kept: key -> text, empty where nothing was changed.

    Examples
    --------
    >>> from geomtorsion.lab.tasks import TASKS as tasks
    >>> class Here:
    ...     def ask(self, name, /, **arguments):
    ...         return tasks[name](**arguments)
    >>> found = show({"tab": "Straightest and shortest", "values": {"space": "nowhere"}}, Here())
    >>> found["kept"], "paths-said" in found["parts"]["result"]
    ({'path': ''}, True)
    """
    maker, begins, survives = TABS[request["tab"]]
    values = {str(k): str(text) for k, text in request.get("values", {}).items()}
    begun = bool(begins & set(request.get("changed", ())))
    if begun:
        values = {k: text for k, text in values.items() if k in begins | survives}
    form = Form(values)
    kept = Kept.of(request.get("kept", {})) if begun or not values else Kept()
    found = maker(Asked(form, kept, request.get("action", "")), runner)
    return {
        "controls": found.controls,
        "shape": found.shape,
        "parts": dict(found.parts),
        "kept": {key: "" if text == usual else text for key, (text, usual) in found.kept.items()},
    }

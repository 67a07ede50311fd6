"""controls: sliders, lists, fields and forms of the page, made of what a worker tells of a case."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from types import ModuleType
from typing import TYPE_CHECKING

from geomtorsion.exercises.worker_pool import Json
from geomtorsion.lab.settings import PAGE
from geomtorsion.lab.space_info import drawable
from geomtorsion.lab.tetrad import OFFERED, USUAL
from geomtorsion.lab.top import SWITCHES, WATCHED
from geomtorsion.lab.views import TABS, intro
from geomtorsion.pictures.text import greek_name

if TYPE_CHECKING:
    from marimo import ui

# Radii of circles, from those that only the flux route can do to those that are easily seen.
RADII = (
    1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45,
    0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0,
)  # fmt: skip
# Spaces in which moments of inertia mean something, with the frame vectors that turn.
BODIES = {"so3": 3, "so3_zxz": 3, "so3_xyz": 3, "so3_zyx": 3, "so3_quaternion": 3, "r3xso3": 3}
BLANK = {f"blank, {n} coordinates": n for n in (2, 3, 4)}
_LETTERS = ("x", "y", "z", "w")


def tabs(mo: ModuleType) -> ui.tabs:
    """The six tabs, which hold nothing but tell which is open."""
    return mo.ui.tabs({name: mo.Html(intro(name)) for name in TABS})


def spaces(mo: ModuleType, chosen: str = "so3", label: str = "space") -> ui.dropdown:
    """A list of the spaces that can be drawn."""
    options = drawable()
    [first] = [title for title, name in options.items() if name == chosen]
    return mo.ui.dropdown(options, value=first, label=label)


# -- any tetrad ---------------------------------------------------------------------------------


def starts(mo: ModuleType) -> ui.dropdown:
    """Where to begin typing: an empty tetrad or that of a space."""
    options: Json = {**drawable(), **BLANK}
    return mo.ui.dropdown(options, value=next(iter(options)), label="start from")


def blank(n: int) -> Json:
    """The facts of a space about which nothing is known: the identity."""
    rows = [["1" if i == k else "0" for k in range(n)] for i in range(n)]
    names = list(_LETTERS[:n])
    return {"coordinates": names, "parameters": [], "signature": "", "coframe": rows}


def names(mo: ModuleType, info: Json) -> ui.dictionary:
    """Fields for coordinates, parameters and signature."""
    signs = info["signature"]
    texts = {
        "coordinates": (", ".join(info["coordinates"]), "r, phi"),
        "parameters": (", ".join(info["parameters"]), "none"),
        "signature": (signs if "?" not in signs else "", "all +"),
    }
    return mo.ui.dictionary(
        {
            key: mo.ui.text(value=text, placeholder=hint, label=key, debounce=PAGE.pause)
            for key, (text, hint) in texts.items()
        }
    )


def entries(mo: ModuleType, info: Json) -> ui.dictionary:
    """A field for each entry of the coframe, by "i,k"."""
    return mo.ui.dictionary(
        {
            f"{i},{k}": mo.ui.text(
                value=text,
                label=f"row {i}, d{greek_name(info['coordinates'][k])}",
                debounce=PAGE.pause,
                full_width=True,
            )
            for i, row in enumerate(info["coframe"])
            for k, text in enumerate(row)
        }
    )


def rows(values: Mapping[str, str], n: int) -> list[list[str]]:
    """Entries by "i,k" as rows.

    Examples
    --------
    >>> rows({"0,0": "1", "0,1": "0", "1,0": "0", "1,1": "r"}, 2)
    [['1', '0'], ['0', 'r']]
    """
    return [[values[f"{i},{k}"] for k in range(n)] for i in range(n)]


def offered(mo: ModuleType) -> ui.dictionary:
    """Boxes for the quantities that can be shown."""
    return mo.ui.dictionary(
        {name: mo.ui.checkbox(value=name in USUAL, label=text) for name, text in OFFERED.items()}
    )


# -- loops, paths, costs ------------------------------------------------------------------------


def centre(mo: ModuleType, info: Json) -> ui.dictionary:
    """A slider for each coordinate of a centre."""
    return mo.ui.dictionary(
        {
            name: mo.ui.slider(
                low, high, step, value=_between(start, low, high), label=greek_name(name),
                show_value=True,
            )
            for name, (low, high, step), start in zip(
                info["coordinates"], info["ranges"], info["start"], strict=True
            )
        }
    )  # fmt: skip


def _between(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


def radius(mo: ModuleType) -> ui.slider:
    """A slider for the radius of a circle, tiny ones included."""
    return mo.ui.slider(steps=list(RADII), value=0.3, label="radius", show_value=True)


def plane(mo: ModuleType, info: Json) -> ui.dropdown:
    """A list of the planes of two coordinates."""
    shown = [greek_name(name) for name in info["coordinates"]]
    options = {f"{shown[i]}, {shown[k]}": (i, k) for i, k in info["planes"]}
    return mo.ui.dropdown(options, value=next(iter(options)), label="plane")


def velocity(mo: ModuleType, info: Json) -> ui.dictionary:
    """A slider for the velocity along each frame vector, one for the time."""
    sliders = {}
    for k, value in enumerate(info["velocity"]):
        most = max(PAGE.fastest, abs(value))
        step = PAGE.step if abs(value / PAGE.step - round(value / PAGE.step)) < 1e-9 else 0.0001
        sliders[f"u{k}"] = mo.ui.slider(
            -most, most, step, value=value, label=f"u{greek_name(str(k))}", show_value=True
        )
    t = info["t"]
    sliders["t"] = mo.ui.slider(
        t / 20, 2 * t, t / 20, value=t, label="time", show_value=True, debounce=False
    )
    return mo.ui.dictionary(sliders)


def moments(mo: ModuleType, space: str) -> ui.dictionary:
    """A slider for each moment of inertia; none where there is no body."""
    return mo.ui.dictionary(
        {
            f"I{k}": mo.ui.slider(0.5, 4, 0.25, value=1, label=f"I{k}", show_value=True)
            for k in range(BODIES.get(space, 0))
        }
    )


def path_case(space: str, speeds: Mapping[str, float], inertia: Mapping[str, float]) -> dict:
    """Sliders as the arguments of the task for paths.

    Examples
    --------
    >>> path_case("s2", {"u0": 0.5, "u1": 1.0, "t": 2.0}, {})
    {'space': 's2', 'velocity': [0.5, 1.0], 't': 2.0, 'moments': None}
    """
    speed = [value for name, value in speeds.items() if name != "t"]
    own = list(inertia.values())
    # Equal unit moments are the metric of the frame itself; who does not turn keeps its own.
    given = [*own, *[1.0] * (len(speed) - len(own))] if any(x != 1 for x in own) else None
    return {"space": space, "velocity": speed, "t": speeds["t"], "moments": given}


def loop_case(space: str, where: Mapping[str, float], size: float, plane: tuple[int, int]) -> Json:
    """Sliders as the arguments of the task for loops."""
    return {
        "space": space, "centre": list(where.values()), "radius": size, "plane": list(plane),
    }  # fmt: skip


def case_kind(mo: ModuleType) -> ui.radio:
    """Which case is to be measured."""
    options = {
        "the loop": "loop",
        "the straightest path": "straightest",
        "the shortest path": "shortest",
        "the top": "top",
    }
    return mo.ui.radio(options, value="the loop", label="measure", inline=True)


# -- the top ------------------------------------------------------------------------------------


def body(mo: ModuleType) -> ui.dictionary:
    """Sliders for moments of inertia, angular velocity, tilt and time."""
    slider = mo.ui.slider
    inertia = {
        f"I{k}": slider(0.5, 4, 0.1, value=k, label=f"I{k}", show_value=True) for k in (1, 2, 3)
    }
    rates = {
        f"w{k}": slider(-20, 20, 0.1, value=value, label=f"ω{k}", show_value=True)
        for k, value in ((1, 0.1), (2, 2.0), (3, 0.1))
    }
    tilt = slider(0, 3, 0.05, value=0.3, label="tilt", show_value=True)
    time = slider(1, 30, 1, value=12, label="time", show_value=True)
    return mo.ui.dictionary({**inertia, **rates, "tilt": tilt, "t": time})


def switches(mo: ModuleType) -> ui.dictionary:
    """A switch for each effect."""
    return mo.ui.dictionary(
        {name: mo.ui.checkbox(value=False, label=text) for name, text in SWITCHES.items()}
    )


def watched(mo: ModuleType) -> ui.dropdown:
    """What the plan shall be made for."""
    options = {text: name for name, text in WATCHED.items()}
    return mo.ui.dropdown(options, value=WATCHED["nutation"], label="to watch")


def top_case(numbers: Mapping[str, float], effects: Mapping[str, bool], watch: str) -> Json:
    """Sliders and switches as the arguments of the task for the top."""
    return {
        "moments": [numbers[f"I{k}"] for k in (1, 2, 3)],
        "omega": [numbers[f"w{k}"] for k in (1, 2, 3)],
        "tilt": numbers["tilt"],
        "t": numbers["t"],
        "effects": [name for name, wanted in effects.items() if wanted],
        "watch": [watch],
    }


def exercises(mo: ModuleType, listing: Json) -> ui.dropdown:
    """A list of all exercises."""
    every = {k: v for chapter in listing.get("chapters", {}).values() for k, v in chapter.items()}
    options = {f"{number} {title}": number for number, title in every.items()}
    return mo.ui.dropdown(options, value=next(iter(options), None), label="exercise")


def seed(mo: ModuleType) -> ui.number:
    """A field for the variant."""
    return mo.ui.number(0, 999_999, 1, value=0, label="variant")


def answers(mo: ModuleType, exercise: Json) -> ui.form:
    """A form with a field for each question; its value comes when it is sent."""
    fields, parts = {}, []
    for number, question in enumerate(exercise.get("questions", ())):
        key = f"q{number}"
        fields[key] = _field(mo, question)
        # Braces are places for fields in the template.
        prompt = question["prompt"].replace("{", "{{").replace("}", "}}")
        how = f'<p class="note">{escape(question["how"])}</p>'
        parts.append(f'<div class="sideways">{prompt}{{{key}}}{how}</div>')
    template = mo.Html(f'<div class="lab">{"".join(parts)}</div>')
    return template.batch(**fields).form(submit_button_label="Check", bordered=False)


def _field(mo: ModuleType, question: Json) -> ui.dropdown | ui.text | ui.text_area:
    label = question["name"] + (f" in {question['unit']}" if question["unit"] else "")
    if question["kind"] == "choice":
        options = {text: key for key, text in question["options"].items()}
        return mo.ui.dropdown(options, label=label)
    if question["kind"] in ("components", "equations"):
        return mo.ui.text_area(label=label, rows=2, full_width=True)
    return mo.ui.text(label=label, full_width=True)


def given(exercise: Json, values: Json) -> dict[str, str]:
    """Fields of the form by the names of the questions.

    Examples
    --------
    >>> given({"questions": [{"name": "legs"}]}, {"q0": "1"})
    {'legs': '1'}
    """
    names = [question["name"] for question in exercise["questions"]]
    return {name: str(values.get(f"q{k}") or "") for k, name in enumerate(names)}


def next_hint(mo: ModuleType, exercise: Json) -> ui.button:
    """A button that counts the hints taken."""
    most = exercise.get("hints", 0)
    return mo.ui.button(
        value=0, on_click=lambda taken: min(taken + 1, most), label="Next hint", kind="neutral"
    )

"""controls: sliders and lists of the page, made from the reply of a worker about a case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import TYPE_CHECKING

from geomtorsion.pictures.text import greek_name
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.guides import COMPASS, TABS, tab
from geomtorsion.teaching.lab.query import Query, numbers_text
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.space_info import drawable
from geomtorsion.teaching.lab.top import SWITCHES, WATCHED
from geomtorsion.teaching.lab.uploads import TEXT_MAPS
from geomtorsion.teaching.lab.views import intro
from geomtorsion.teaching.texts import ENGLISH, Texts, texts

if TYPE_CHECKING:
    from marimo import ui

# Radii of circles, from those that only the flux method resolves to clearly visible ones.
RADII = (
    1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45,
    0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0,
)  # fmt: skip
# Spaces of rigid bodies, with the number of frame vectors that rotate.
BODIES = {"so3": 3, "so3_zxz": 3, "so3_xyz": 3, "so3_zyx": 3, "so3_quaternion": 3, "r3xso3": 3}


# Default space of a list if the address of the page names none.
COURSES = (70, 110)
FIRST_LOOP, FIRST_PATH = "so3", "r3xso3"
# Thresholds of grains, degrees.
THRESHOLDS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.5, 10.0, 15.0, 20.0)
# Moments of inertia (kg m^2), angular velocity (rad/s), tilt (rad) and time (s) of the top.
# A long symmetric body: its cones are circular and touch from outside, which is easy to see.
BODY = {"I": (2.0, 2.0, 1.0), "w": (1.0, 0.0, 2.0), "tilt": 0.3, "t": 12.0}
_ANGLES = ("phi", "theta", "psi", "chi", "yaw", "pitch", "roll")


def tabs(mo: ModuleType, query: Query, language: str = ENGLISH) -> ui.tabs:
    """The tabs; their only value is the open tab."""
    opened = query.one_of("tab", list(TABS), COMPASS)
    shown = [tab(name, language) for name in TABS]
    return mo.ui.tabs(
        {one.name: mo.Html(intro(one.guide, language)) for one in shown},
        value=tab(opened, language).name,
    )


def course(mo: ModuleType, query: Query, language: str = ENGLISH) -> ui.slider:
    """A slider for the course of a ship."""
    [angle] = query.numbers("course", [COURSES], [PAGE.course])
    label = _text(language)("course")
    return mo.ui.slider(*COURSES, 5, value=round(angle / 5) * 5, label=label, show_value=True)


def spaces(
    mo: ModuleType, chosen: str, query: Query, key: str, language: str = ENGLISH
) -> ui.dropdown:
    """A list of the spaces that can be drawn."""
    options = drawable(language)
    space = query.one_of(key, list(options.values()), chosen)
    [first] = [title for title, name in options.items() if name == space]
    return mo.ui.dropdown(options, value=first, label=_text(language)("space"))


def _text(language: str, heading: str = "controls") -> Texts:
    return texts("figures", heading, language)


def with_unit(name: str) -> str:
    """A coordinate, with its unit if its name is the name of an angle.

    Examples
    --------
    >>> with_unit("phi1"), with_unit("x")
    ('φ1 in rad', 'x')
    """
    unit = " in rad" if name.rstrip("0123456789") in _ANGLES else ""
    return f"{greek_name(name)}{unit}"


# -- loops -------------------------------------------------------------------------------------


def place(mo: ModuleType, info: Json, query: Query, language: str = ENGLISH) -> ui.dictionary:
    """A list of the planes of two coordinates, and a slider for each coordinate of a centre."""
    options = {_plane_text(info, pair): pair for pair in info["planes"]}
    plane = query.one_of("plane", list(options), next(iter(options)))
    ranges = [(low, high) for low, high, _ in info["loop_ranges"]]
    usual = [_between(x, *ends) for x, ends in zip(info["loop_centre"], ranges, strict=True)]
    at = query.numbers("centre", ranges, usual)
    return mo.ui.dictionary(
        {"plane": mo.ui.dropdown(options, value=plane, label=_text(language)("plane"))}
        | {
            name: mo.ui.slider(low, high, step, value=x, label=with_unit(name), show_value=True)
            for name, (low, high, step), x in zip(
                info["coordinates"], info["loop_ranges"], at, strict=True
            )
        }
    )


def _plane_text(info: Json, pair: Sequence[int]) -> str:
    """The two coordinates of a plane."""
    return ", ".join(greek_name(info["coordinates"][k]) for k in pair)


def _between(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


def radius(mo: ModuleType, query: Query, language: str = ENGLISH) -> ui.slider:
    """A slider for the radius of a circle, tiny ones included."""
    text = query.one_of("radius", [f"{x:g}" for x in RADII], f"{PAGE.radius:g}")
    label = _text(language)("radius")
    return mo.ui.slider(steps=list(RADII), value=float(text), label=label, show_value=True)


def loop_case(info: Json, place: Json, size: float) -> Json:
    """Sliders as the arguments of the task for loops."""
    centre = [place[name] for name in info["coordinates"]]
    return {"space": info["name"], "centre": centre, "radius": size, "plane": list(place["plane"])}


def loop_query(info: Json, place: Json, size: float) -> dict[str, tuple[str, str]]:
    """The values of a loop that the address stores."""
    centre = loop_case(info, place, size)["centre"]
    return {
        "loop": (info["name"], FIRST_LOOP),
        "centre": (numbers_text(centre), numbers_text(info["loop_centre"])),
        "radius": (f"{size:g}", f"{PAGE.radius:g}"),
        "plane": (_plane_text(info, place["plane"]), _plane_text(info, info["planes"][0])),
    }


# -- an uploaded map or image -------------------------------------------------------------------


def upload(mo: ModuleType, language: str = ENGLISH) -> ui.file:
    """A field for one file of a map; it refuses files above the stated size."""
    ends = [".npz", ".csv", *TEXT_MAPS, ".txt", ".png", ".tif", ".tiff", ".npy"]
    label = _text(language, "maps")("upload", megabytes=f"{PAGE.upload / 1e6:g}")
    return mo.ui.file(ends, kind="button", max_size=PAGE.upload, label=label)


def map_settings(mo: ModuleType, facts: Json, language: str = ENGLISH) -> ui.dictionary:
    """How a file of orientations is read: grains, the phase that is shown, its symmetry."""
    settings = facts.get("settings") or {}
    if not settings:
        return mo.ui.dictionary({})
    text = _text(language, "maps")
    phases = {text("all"): 0} | {f"{number}: {name}": number for number, name in settings["phases"]}
    groups = {text("as_in_file"): ""} | {name: name for name in settings["groups"]}
    return mo.ui.dictionary(
        {
            "threshold": mo.ui.slider(
                steps=list(THRESHOLDS), value=settings["threshold"], show_value=True,
                label=text("threshold"),
            ),
            "phase": mo.ui.dropdown(phases, value=text("all"), label=text("phase")),
            "laue": mo.ui.dropdown(groups, value=text("as_in_file"), label=text("laue")),
        }
    )  # fmt: skip


def map_measure(mo: ModuleType, language: str = ENGLISH) -> ui.radio:
    """Whether positions and sizes are in pixels or in the unit of the map."""
    text = _text(language, "maps")
    options = {text("pixels"): False, text("units"): True}
    return mo.ui.radio(options, value=text("pixels"), label=text("measure"), inline=True)


def map_places(
    mo: ModuleType, facts: Json, measured: bool, language: str = ENGLISH
) -> ui.dictionary:
    """A slider for each coordinate of the middle of a square, one for its side."""
    if "shape" not in facts:
        return mo.ui.dictionary({})
    least, text = facts["least"], _text(language, "maps")
    sliders = {}
    for name, count, start, step, at in zip(
        facts["names"], facts["shape"], facts["starts"], facts["steps"], facts["middle"],
        strict=True,
    ):  # fmt: skip
        ends = sorted((start, start + step * (count - 1))) if measured else (0, count - 1)
        sliders[name] = mo.ui.slider(
            steps=_stations(ends[0], count, abs(step) if measured else 1),
            value=_stations(ends[0], count, abs(step) if measured else 1)[at],
            label=_in_unit(text("centre", name=name), facts, measured, text),
            show_value=True,
        )
    step = abs(facts["steps"][0]) if measured else 1
    sides = _stations(least * step, facts["most"] - least + 1, step)
    sliders["side"] = mo.ui.slider(
        steps=sides,
        value=sides[facts["side"] - least],
        label=_in_unit(text("side"), facts, measured, text),
        show_value=True,
    )
    return mo.ui.dictionary(sliders)


def _stations(first: float, count: int, step: float) -> list[float]:
    """Values of a slider, rounded to a readable number of digits."""
    return [float(f"{first + step * k:.9g}") for k in range(count)]


def _in_unit(label: str, facts: Json, measured: bool, text: Texts) -> str:
    """The label of a slider of a map, with the unit in which it counts."""
    if not measured:
        return text("in_pixels", label=label)
    return text("in_unit", label=label, unit=facts["unit"]) if facts["unit"] else label


def map_case(facts: Json, places: Mapping[str, float], measured: bool) -> Json:
    """Sliders as the arguments of the task for circuits in a map: node and cells.

    Examples
    --------
    >>> facts = {"names": ["x", "y"], "starts": [10.0, 0.0], "steps": [0.5, -2.0]}
    >>> map_case(facts, {"x": 12.0, "y": -6.0, "side": 1.5}, True)
    {'centre': [4, 3], 'side': 3}
    >>> map_case(facts, {"x": 4, "y": 3, "side": 3}, False)
    {'centre': [4, 3], 'side': 3}
    """
    at = [places[name] for name in facts["names"]]
    side = places["side"]
    if measured:
        scales = zip(at, facts["starts"], facts["steps"], strict=True)
        at = [(x - start) / step for x, start, step in scales]
        side /= abs(facts["steps"][0])
    return {"centre": [round(k) for k in at], "side": round(side)}


# -- curves -------------------------------------------------------------------------------------


def curve(mo: ModuleType, info: Json, query: Query, language: str = ENGLISH) -> ui.dictionary:
    """A slider for each component of the velocity, for the time, and for each moment of a body."""
    usual, t = list(info["velocity"]), info["t"]
    most = [max(PAGE.fastest, abs(value)) for value in usual]
    at = query.numbers("velocity", [(-x, x) for x in most], usual)
    [end] = query.numbers("t", [(t / 20, 2 * t)], [t])
    count = BODIES.get(info["name"], 0)
    inertia = query.numbers("moments", [(0.5, 4)] * count, [1.0] * count)
    sliders, text = {}, _text(language)
    for k, (value, limit) in enumerate(zip(at, most, strict=True)):
        step = PAGE.step if abs(value / PAGE.step - round(value / PAGE.step)) < 1e-9 else 0.0001
        sliders[f"u{k}"] = mo.ui.slider(
            -limit, limit, step, value=value, label=_leg(info["name"], k, text), show_value=True
        )
    sliders["t"] = mo.ui.slider(
        t / 20, 2 * t, t / 20, value=end, label=text("time"), show_value=True, debounce=False
    )
    sliders |= {
        f"I{k}": mo.ui.slider(
            0.5, 4, 0.25, value=value, label=text("inertia", number=k + 1), show_value=True
        )
        for k, value in enumerate(inertia)
    }
    return mo.ui.dictionary(sliders)


def _leg(space: str, k: int, text: Texts) -> str:
    """The meaning of a velocity along leg k of a frame.

    Examples
    --------
    >>> text = texts("figures", "controls")
    >>> _leg("r3xso3", 0, text), _leg("r3xso3", 3, text), _leg("s2", 1, text)
    ('turn about axis 1: u1 in rad/time', 'move along axis 1: u4 in length/time', 'u2 along leg 2')
    """
    turns = BODIES.get(space, 0)
    if not turns:
        return text("leg", number=k + 1)
    if k < turns:
        return text("turn", axis=k + 1, number=k + 1)
    return text("move", axis=k + 1 - turns, number=k + 1)


def path_query(info: Json, values: Mapping[str, float]) -> dict[str, tuple[str, str]]:
    """The values of two curves that the address stores."""
    own = _numbered("I", values)
    return {
        "path": (info["name"], FIRST_PATH),
        "velocity": (numbers_text(_numbered("u", values)), numbers_text(info["velocity"])),
        "t": (numbers_text([values["t"]]), numbers_text([info["t"]])),
        "moments": (numbers_text(own), numbers_text([1.0] * len(own))),
    }


def _numbered(letter: str, values: Json) -> list[float]:
    """The values of the sliders whose keys are this letter with a number, in order."""
    return [value for key, value in values.items() if key[0] == letter and key[1:].isdecimal()]


def path_case(space: str, values: Mapping[str, float]) -> dict[str, object]:
    """Sliders as the arguments of the task for paths.

    Examples
    --------
    >>> path_case("s2", {"u0": 0.5, "u1": 1.0, "t": 2.0})
    {'space': 's2', 'velocity': [0.5, 1.0], 't': 2.0, 'moments': None}
    """
    speed, own = _numbered("u", values), _numbered("I", values)
    # Equal unit moments give the metric of the frame; a body that does not turn keeps its metric.
    moments = [*own, *[1.0] * (len(speed) - len(own))] if any(x != 1 for x in own) else None
    return {"space": space, "velocity": speed, "t": values["t"], "moments": moments}


def case_kind(mo: ModuleType, query: Query, language: str = ENGLISH) -> ui.radio:
    """The case that is measured."""
    text = _text(language)
    options = {label: kind for kind, label in text.table("cases").items()}
    case = query.one_of("measure", list(options.values()), "loop")
    [first] = [title for title, kind in options.items() if kind == case]
    return mo.ui.radio(options, value=first, label=text("measure"), inline=True)


# -- the top ------------------------------------------------------------------------------------


def top(mo: ModuleType, query: Query, language: str = ENGLISH) -> ui.dictionary:
    """The quantity in the chart, a switch for each effect, and sliders for the body."""
    slider, text, labels = mo.ui.slider, _text(language), _text(language, "top")
    watch = query.one_of("watch", list(WATCHED), "nutation")
    on = query.some_of("effects", list(SWITCHES), ())
    inertia = query.numbers("body", [(0.5, 4)] * 3, BODY["I"])
    rates = query.numbers("omega", [(-20, 20)] * 3, BODY["w"])
    [tilt] = query.numbers("tilt", [(0, 3)], [BODY["tilt"]])
    [time] = query.numbers("time", [(1, 30)], [BODY["t"]])
    watched = {labels(f"watched.{name}"): name for name in WATCHED}
    chosen = labels(f"watched.{watch}")
    controls = {"watch": mo.ui.dropdown(watched, value=chosen, label=text("watch"))}
    controls |= {
        name: mo.ui.checkbox(value=name in on, label=labels(f"effects.{name}")) for name in SWITCHES
    }
    controls |= {
        f"I{k}": slider(0.5, 4, 0.1, value=x, label=f"I{k} in kg m²", show_value=True)
        for k, x in enumerate(inertia, 1)
    }
    controls |= {
        f"w{k}": slider(-20, 20, 0.1, value=x, label=f"Ω{k} in rad/s", show_value=True)
        for k, x in enumerate(rates, 1)
    }
    controls["tilt"] = slider(0, 3, 0.05, value=tilt, label=text("tilt"), show_value=True)
    controls["t"] = slider(1, 30, 1, value=time, label=text("seconds"), show_value=True)
    return mo.ui.dictionary(controls)


def top_case(values: Json) -> Json:
    """The controls of the top as the arguments of its task."""
    return {
        "moments": _numbered("I", values),
        "omega": _numbered("w", values),
        "tilt": values["tilt"],
        "t": values["t"],
        "effects": [name for name in SWITCHES if values[name]],
        "watch": [values["watch"]],
    }


def top_query(values: Json) -> dict[str, tuple[str, str]]:
    """The values of the top that the address stores."""
    case = top_case(values)
    return {
        "body": (numbers_text(case["moments"]), numbers_text(BODY["I"])),
        "omega": (numbers_text(case["omega"]), numbers_text(BODY["w"])),
        "tilt": (numbers_text([case["tilt"]]), numbers_text([BODY["tilt"]])),
        "time": (numbers_text([case["t"]]), numbers_text([BODY["t"]])),
        "effects": (",".join(case["effects"]), ""),
        "watch": (values["watch"], "nutation"),
    }

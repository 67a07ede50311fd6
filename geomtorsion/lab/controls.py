"""controls: sliders, lists and fields of the page, made of the facts about a space."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from geomtorsion.lab.facts import drawable
from geomtorsion.lab.tetrad import OFFERED, USUAL
from geomtorsion.lab.top import SWITCHES, WATCHED
from geomtorsion.lab.views import TABS, intro
from geomtorsion.pictures.text import greek_name

Facts = Mapping[str, Any]
# Milliseconds without a key pressed after which a typed text is read.
PAUSE = 350
# Radii of circles, from those that only the flux route can do to those that are easily seen.
RADII = (
    1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45,
    0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0,
)  # fmt: skip
# Speeds along a leg, and moments of inertia.
FASTEST, SLOW = 3.0, 0.05
# Spaces in which moments of inertia mean something, with the legs that turn.
BODIES = {"so3": 3, "so3_zxz": 3, "so3_xyz": 3, "so3_zyx": 3, "so3_quaternion": 3, "r3xso3": 3}
BLANK = {f"blank, {n} coordinates": n for n in (2, 3, 4)}
_LETTERS = ("x", "y", "z", "w")


def tabs(mo: Any) -> Any:
    """The six tabs, which hold nothing but tell which is open."""
    return mo.ui.tabs({name: mo.Html(intro(name)) for name in TABS})


def spaces(mo: Any, chosen: str = "so3", label: str = "space") -> Any:
    """A list of the spaces that can be drawn."""
    options = drawable()
    [first] = [title for title, name in options.items() if name == chosen]
    return mo.ui.dropdown(options, value=first, label=label)


# -- any tetrad ---------------------------------------------------------------------------------


def beginnings(mo: Any) -> Any:
    """Where to begin typing: an empty tetrad or that of a space."""
    options: dict[str, Any] = {**drawable(), **BLANK}
    return mo.ui.dropdown(options, value=next(iter(options)), label="start from")


def blank(n: int) -> dict[str, Any]:
    """The facts of a space about which nothing is known: the identity."""
    rows = [["1" if i == k else "0" for k in range(n)] for i in range(n)]
    names = list(_LETTERS[:n])
    return {"coordinates": names, "parameters": [], "signature": "", "coframe": rows}


def names(mo: Any, facts: Facts) -> Any:
    """Fields for coordinates, parameters and signature."""
    signs = facts["signature"]
    texts = {
        "coordinates": (", ".join(facts["coordinates"]), "r, phi"),
        "parameters": (", ".join(facts["parameters"]), "none"),
        "signature": (signs if "?" not in signs else "", "all +"),
    }
    return mo.ui.dictionary(
        {
            key: mo.ui.text(value=text, placeholder=hint, label=key, debounce=PAUSE)
            for key, (text, hint) in texts.items()
        }
    )


def entries(mo: Any, facts: Facts) -> Any:
    """A field for each entry of the coframe, by "i,k"."""
    return mo.ui.dictionary(
        {
            f"{i},{k}": mo.ui.text(
                value=text,
                label=f"row {i}, d{greek_name(facts['coordinates'][k])}",
                debounce=PAUSE,
                full_width=True,
            )
            for i, row in enumerate(facts["coframe"])
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


def offered(mo: Any) -> Any:
    """Boxes for the quantities that can be shown."""
    return mo.ui.dictionary(
        {name: mo.ui.checkbox(value=name in USUAL, label=text) for name, text in OFFERED.items()}
    )


# -- loops, paths, costs ------------------------------------------------------------------------


def centre(mo: Any, facts: Facts) -> Any:
    """A slider for each coordinate of a centre."""
    return mo.ui.dictionary(
        {
            name: mo.ui.slider(
                low, high, step, value=_between(start, low, high), label=greek_name(name),
                show_value=True,
            )
            for name, (low, high, step), start in zip(
                facts["coordinates"], facts["ranges"], facts["start"], strict=True
            )
        }
    )  # fmt: skip


def _between(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


def radius(mo: Any) -> Any:
    """A slider for the radius of a circle, tiny ones included."""
    return mo.ui.slider(steps=list(RADII), value=0.3, label="radius", show_value=True)


def plane(mo: Any, facts: Facts) -> Any:
    """A list of the planes of two coordinates."""
    shown = [greek_name(name) for name in facts["coordinates"]]
    options = {f"{shown[i]}, {shown[k]}": (i, k) for i, k in facts["planes"]}
    return mo.ui.dropdown(options, value=next(iter(options)), label="plane")


def velocity(mo: Any, facts: Facts) -> Any:
    """A slider for the velocity along each leg, one for the time."""
    sliders = {}
    for k, value in enumerate(facts["velocity"]):
        most = max(FASTEST, abs(value))
        step = SLOW if abs(value / SLOW - round(value / SLOW)) < 1e-9 else 0.0001
        sliders[f"u{k}"] = mo.ui.slider(
            -most, most, step, value=value, label=f"u{greek_name(str(k))}", show_value=True
        )
    t = facts["t"]
    sliders["t"] = mo.ui.slider(
        t / 20, 2 * t, t / 20, value=t, label="time", show_value=True, debounce=False
    )
    return mo.ui.dictionary(sliders)


def moments(mo: Any, space: str) -> Any:
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
    # Equal unit moments are the metric of the frame itself; legs that do not turn keep theirs.
    given = [*own, *[1.0] * (len(speed) - len(own))] if any(x != 1 for x in own) else None
    return {"space": space, "velocity": speed, "t": speeds["t"], "moments": given}


def loop_case(
    space: str, where: Mapping[str, float], size: float, plane: tuple[int, int]
) -> dict[str, Any]:
    """Sliders as the arguments of the task for loops."""
    return {
        "space": space, "centre": list(where.values()), "radius": size, "plane": list(plane),
    }  # fmt: skip


def case_kind(mo: Any) -> Any:
    """Which case is to be measured."""
    options = {
        "the loop": "loop",
        "the straightest path": "straightest",
        "the shortest path": "shortest",
        "the top": "top",
    }
    return mo.ui.radio(options, value="the loop", label="measure", inline=True)


# -- the top ------------------------------------------------------------------------------------


def body(mo: Any) -> Any:
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


def switches(mo: Any) -> Any:
    """A switch for each effect."""
    return mo.ui.dictionary(
        {name: mo.ui.checkbox(value=False, label=text) for name, text in SWITCHES.items()}
    )


def watched(mo: Any) -> Any:
    """What the plan shall be made for."""
    options = {text: name for name, text in WATCHED.items()}
    return mo.ui.dropdown(options, value=WATCHED["nutation"], label="to watch")


def top_case(
    numbers: Mapping[str, float], effects: Mapping[str, bool], watch: str
) -> dict[str, Any]:
    """Sliders and switches as the arguments of the task for the top."""
    return {
        "moments": [numbers[f"I{k}"] for k in (1, 2, 3)],
        "omega": [numbers[f"w{k}"] for k in (1, 2, 3)],
        "tilt": numbers["tilt"],
        "t": numbers["t"],
        "effects": [name for name, wanted in effects.items() if wanted],
        "watch": [watch],
    }

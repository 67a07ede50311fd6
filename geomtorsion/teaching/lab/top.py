"""top: a rotating body, as an animation of its two cones; its plan; and the naive law."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.pictures.style import SERIES, Stroke
from geomtorsion.pictures.text import greek_name
from geomtorsion.scenes import Body, Scene, State, effects
from geomtorsion.scenes.effects import Naive
from geomtorsion.support.outgoing import size_text
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.numbers import shown, table
from geomtorsion.teaching.lab.plot import key, plane, svg
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.turning import Curve, Film, in_space, thinned
from geomtorsion.teaching.texts import ENGLISH, Texts, texts

if TYPE_CHECKING:
    from geomtorsion.scenes import Scene, SceneResult
    from geomtorsion.scenes.effects import Effect
    from geomtorsion.scenes.selection import SelectionRow

# Watched for the animation and the table, whatever is chosen for the graph and the plan.
_WATCH = ("omega", "omega_space", "matrix", "angular_momentum_space", "energy")
# Effects with a switch, and quantities that can be watched; the file of texts has their labels.
SWITCHES = ("gravity", "pivot", "damping", "rotor", "magnet", "torsion")
WATCHED = ("omega", "omega_space", "nutation", "matrix", "energy", "position")
# Quantity -> labels of its components, None for its own label, and its unit.
_SHOWN = {
    "omega": (("Ω₁", "Ω₂", "Ω₃"), "rad/s"),
    "omega_space": (("ω_x", "ω_y", "ω_z"), "rad/s"),
    "nutation": (None, "rad"),
    "matrix": (tuple(f"R{i}{k}" for i in "₁₂₃" for k in "₁₂₃"), ""),
    "energy": (None, "J"),
    "position": (("x", "y", "z"), "m"),
}
# On a page a colour has one meaning: the colours of the chart do not occur in the animation.
_SPACE, _BODY, _AXIS, _MOMENTUM, _RIGHT, _NAIVE = SERIES


def top(
    moments: Sequence[float],
    omega: Sequence[float],
    tilt: float,
    t: float,
    effects: Sequence[str] = (),
    watch: Sequence[str] = ("nutation",),
    language: str = ENGLISH,
) -> Json:
    """A body with some effects, by the correct law and by the naive law.

    Parameters
    ----------
    moments, omega
        about the body axes, kg m^2 and rad/s.
    tilt
        of the third body axis from the vertical at the start, rad.
    t
        s.
    effects
        keys of SWITCHES.
    watch
        keys of WATCHED: the quantity in the graph, for which the plan is made.
    language
        of the words in pictures, tables and sentence.

    Returns
    -------
    space: an HTML document, the animation; title: its name. plan: HTML. compared: svg.
    table, sentence: HTML and text.
    omega: the last angular velocity, body axes; naive: the naive law's value, or None.

    Examples
    --------
    >>> found = top([1, 2, 3], [0.1, 2, 0.1], 0.3, 5.0)
    >>> found["naive"], len(found["omega"])
    ([0.1, 2.0, 0.1], 3)
    """
    turns = math.hypot(*omega) * float(t) / (2 * math.pi)
    samples = round(min(max(PAGE.least_times, PAGE.each_turn * turns), PAGE.most_times))
    acting = made(effects)
    watch = tuple(watch) or ("nutation",)
    every = tuple(dict.fromkeys((*_WATCH, *watch)))
    scene = scene_of(moments, omega, tilt, t, acting, every, samples)
    result = scene.run()
    wrong = None
    if "torsion" not in effects:
        naive = (*acting, Naive())
        wrong = scene_of(moments, omega, tilt, t, naive, every, samples).run()
    plan = scene_of(moments, omega, tilt, t, acting, watch, samples)
    text = texts("figures", "top", language)
    return {
        **in_space(_cones(result, text)),
        "plan": _plan(plan, text),
        "compared": _compared(result, wrong, watch[0], text),
        "table": _table(result, wrong, text),
        "sentence": _sentence(result, wrong, text),
        "omega": [float(x) for x in result["omega"][-1]],
        "naive": None if wrong is None else [float(x) for x in wrong["omega"][-1]],
    }


def made(names: Sequence[str]) -> tuple[Effect, ...]:
    """The effects that are switched on.

    Examples
    --------
    >>> [effect.key for effect in made(["pivot", "gravity"])]
    ['gravity', 'pivot']
    """
    makers = {
        "gravity": lambda: effects.Gravity(9.81),
        "pivot": lambda: effects.Pivot((0, 0, 0.5)),
        "damping": lambda: effects.AngularDamping(0.05),
        "rotor": lambda: effects.Rotor((0, 0, 1), momentum=2),
        "magnet": lambda: effects.Magnet((0, 0, 1), (0, 0, 1)),
        "torsion": effects.Torsion,
    }
    return tuple(make() for name, make in makers.items() if name in names)


def scene_of(
    moments: Sequence[float],
    omega: Sequence[float],
    tilt: float,
    t: float,
    effects: Sequence[Effect],
    watch: Sequence[str],
    samples: int = PAGE.least_times,
) -> Scene:
    """The scene that the switches and sliders describe."""
    return Scene(
        Body(mass=1.0, moments=tuple(moments)),
        tuple(effects),
        State(omega=tuple(omega), euler=(0, tilt, 0)),
        watch=tuple(watch),
        t=float(t),
        accuracy=PAGE.accuracy,
        samples=samples,
    )


def _cones(result: SceneResult, text: Texts) -> Film:
    """Body cone and space cone: one rolls on the other."""
    omega, fixed, turns = result["omega"], result["omega_space"], result["matrix"]
    size = float(np.linalg.norm(omega, axis=1).max()) or 1.0
    momentum = result["angular_momentum_space"]
    long = float(np.linalg.norm(momentum, axis=1).max()) or 1.0
    tips = thinned((fixed / size).tolist(), PAGE.frames)
    curves = [
        Curve(tips, _SPACE, text("space_cone"), tip="ω", cone=True),
        Curve(
            thinned(turns[:, :, 2].tolist(), PAGE.frames),
            replace(_AXIS, width=1.4), text("axis"), tip="3",
        ),
        Curve(
            [(0, 0, 0), (momentum[0] / long).tolist()],
            replace(_MOMENTUM, end="", width=2.0), text("momentum"), tip="L",
        ),
    ]  # fmt: skip
    polhode = thinned((omega / size).tolist(), PAGE.frames)
    rim = replace(_BODY, end="", width=2.4)
    axis = Stroke(_BODY.color, "-", 1.2, "")
    # Axis 3 ends in the mark of its path, which has its number.
    ends = {"1": (0.5, 0, 0), "2": (0, 0.5, 0), "": (0, 0, 1)}
    moving = (
        Curve(polhode, rim, text("body_cone"), cone=True),
        *(Curve([(0, 0, 0), end], axis, tip=tip) for tip, end in ends.items()),
    )
    return Film(
        "top", text("title"), ("x", "y", "z"), tuple(curves), moving,
        note=text("note"), language=text.language,
        attitudes=thinned(turns.tolist(), PAGE.frames),
        times=thinned(result.times.tolist(), PAGE.frames), equal=True,
    )  # fmt: skip


def _plan(scene: Scene, text: Texts) -> str:
    """A table of the simulated and the omitted parts."""
    plan = scene.selection
    rows = []
    for row in plan.rows:
        inside = text("included" if row.inside else "omitted")
        table_of_names = "acting" if row.kind == "effect" else "groups"
        named = text.named(table_of_names, row.name)
        rows.append([inside, text(row.kind), named, _reason(row, text)])
    watched = ", ".join(text(f"watched.{name}") for name in scene.watch)
    caption = text("plan", quantity=watched, count=len(plan.states))
    return table(("", text("kind"), text("name"), text("reason")), rows, caption)


def _reason(row: SelectionRow, text: Texts) -> str:
    """The cause of a row of the plan in a sentence."""
    users = "watched" if row.cause == "watched_as" else "groups"
    lists = {
        "states": [text.named("groups", _greek(name)) for name in row.states],
        "users": [text.named(users, name) for name in row.users],
        "effects": [text.named("acting", name) for name in row.effects],
    }
    values = {name: ", ".join(names) for name, names in lists.items() if names}
    return text(f"causes.{row.cause}", **values)


def _greek(name: str) -> str:
    """A state or a run of states, such as Omega1..Omega3, in Greek letters."""
    return "..".join(map(greek_name, name.split("..")))


def _compared(result: SceneResult, wrong: SceneResult | None, watch: str, text: Texts) -> str:
    """The watched quantity over time; its component with the largest error of the naive law."""
    names, unit = _SHOWN[watch]
    right = result[watch].reshape(len(result.times), -1)
    naive = right if wrong is None else wrong[watch].reshape(right.shape)
    differences = np.abs(right - naive).max(axis=0)
    k = int((differences if differences.any() else np.ptp(right, axis=0)).argmax())
    label = text(f"watched.{watch}") if names is None else names[k]
    title = text("over" if wrong is None else "over_both", quantity=label)
    upright = text("unit", quantity=label, unit=unit) if unit else label
    figure, axes = plane(title, (text("t"), upright), height=3.4)
    axes.plot(result.times, right[:, k], **_RIGHT.line, label=text("right"))
    if wrong is not None:
        axes.plot(result.times, naive[:, k], **_NAIVE.line, label=text("naive"))
    key(figure, axes)
    return svg(figure, text.language)


def _change(values: np.ndarray) -> float:
    """Largest change of a vector since the start, relative to its size."""
    moved = np.linalg.norm(values - values[0], axis=-1).max()
    return float(moved / (np.linalg.norm(values, axis=-1).max() or 1.0))


def _table(result: SceneResult, wrong: SceneResult | None, text: Texts) -> str:
    """Engine, cost and conserved quantities of each solution."""
    rows = []
    for name, motion in ((text("right_law"), result), (text("naive_law"), wrong)):
        if motion is None:
            continue
        energy = motion["energy"]
        scale = float(abs(energy).max()) or 1.0
        rows.append(
            [
                name,
                text.named("methods", motion.closed_form or motion.engine),
                size_text(motion.error, 0),
                shown(_change(motion["angular_momentum_space"]), PAGE.accuracy),
                shown(float(abs(energy - energy[0]).max()) / scale, PAGE.accuracy),
            ]
        )
    named = ("method", "error", "change_momentum", "change_energy")
    return table(("", *map(text, named)), rows, text("caption"))


def _sentence(result: SceneResult, wrong: SceneResult | None, text: Texts) -> str:
    """Description of the result in words."""
    change = _change(result["angular_momentum_space"])
    right = text("constant" if change < 1e3 * PAGE.accuracy else "torques")
    if wrong is None:
        return f"{right} {text('no_naive')}"
    naive_change = _change(wrong["angular_momentum_space"])
    if max(change, naive_change) < 1e3 * PAGE.accuracy:
        return f"{right} {text('agree')}"
    return f"{right} {text('differ', share=f'{naive_change:.1%}')}"

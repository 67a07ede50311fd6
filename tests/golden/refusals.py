"""Public calls that are refused: name -> call. Class and text of each error are frozen."""

# Calls that a checker of types refuses as well.
# pyright: reportArgumentType=false

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import networkx as nx
import sympy as sp

import geomtorsion as gt
from geomtorsion.materials.lines import Reaction
from tests.golden.calls import (
    ORBIT,
    SPEED,
    START,
    circle,
    develop_period,
    heavy_top,
    kerr,
    log_map,
    ode,
    polar,
    s,
    s2,
    screw,
    so3,
    stone,
    top_action,
    x,
    y,
)

# Their numbers are rounding errors or depend on the steps, so only the words are compared.
WORDS_ONLY = {
    "accuracy out of reach",
    "end of the chart",
    "motion that runs away",
    "opposite poles",
    "plunge through one chart",
}
NAN = float("nan")
ONES = [[1, 0], [0, 1]]
TOP = sum(u**2 for u in sp.symbols("u1 u2 u3"))
# Without types, for calls that are wrong on purpose.
wrong: Any = gt


def refused(call: Callable[[], Any]) -> dict[str, str]:
    """Class and text of the error that a call raises."""
    try:
        call()
    except gt.GeomtorsionError as error:
        return {"error": type(error).__name__, "text": str(error)}
    raise AssertionError("nothing was refused")


def line() -> Any:
    """A geodesic on so3."""
    return gt.geodesic(so3, START, SPEED)


def solved() -> Any:
    """The same geodesic, solved."""
    return gt.solve(line(), 1.0)


def swing(**more: Any) -> Any:
    """An oscillator."""
    options: dict[str, Any] = {"parameters": {"k": 1}} | more
    return ode({"x": "v", "v": "-k*x"}, [1, 0], **options)


def lines(*rows: Any, **more: Any) -> Any:
    """A network of dislocation lines."""
    return gt.DislocationNetwork.of_lines(list(rows), **more)


def square() -> gt.loops.Network:
    """A network of one loop."""
    graph = nx.Graph()
    for node, place in enumerate([(1, 1, 0), (2, 1, 0), (2, 2, 0), (1, 2, 0)]):
        graph.add_node(node, position=place)
    nx.add_cycle(graph, range(4))
    return gt.loops.Network(so3, graph)


REFUSALS: dict[str, Callable[[], Any]] = {
    # Frames and tensors
    "coframe that is not square": lambda: gt.Frame([x, y], [[1, 0]]),
    "coframe that is singular": lambda: gt.Frame([x, y], [[1, x], [2, 2 * x]]),
    "coordinate given twice": lambda: gt.Frame([x, y, x], sp.eye(3).tolist()),
    "coordinate that is a parameter": lambda: gt.Frame([x, y], [[1, 0], [0, y]], parameters=[y]),
    "entry that is not smooth": lambda: gt.Frame([x, y], [[1, 0], [sp.floor(x), 1]]),
    "entry that is complex": lambda: gt.Frame([x, y], [[1, sp.I * x], [0, 1]]),
    "entry that is a float": lambda: gt.Frame([x, y], [[1, 0], [0, 0.5]]),
    "metric that is not symmetric": lambda: gt.Frame.from_metric([x, y], [[1, x], [0, 1]]),
    "metric that is degenerate": lambda: gt.Frame.from_metric([x, y], [[1, 1], [1, 1]]),
    "metric of another signature": lambda: gt.Frame.from_metric(
        [x, y], [[-1, 0], [0, 1]], signature=(1, 1)
    ),
    "invalid signature": lambda: gt.Frame([x, y], ONES, signature=(1, 5)),
    "structure constants without jacobi": lambda: gt.Frame.from_structure_constants(
        [
            [[0, 0, 0], [0, 1, 0], [0, 0, 0]],
            [[0, -1, 0], [0, 0, 0], [1, 0, 0]],
            [[0, 0, 0], [-1, 0, 0], [0, 0, 0]],
        ]
    ),
    "unknown space": lambda: gt.spaces.load("ker"),
    "unknown quantity": lambda: so3.quantity("ricc"),
    "index out of range": lambda: wrong.spaces.load("so3").frame.metric[0, 3],
    "contraction of two lower indices": lambda: gt.contract(
        "abc,bd->acd", gt.cartan(so3).torsion.S, so3.metric
    ),
    "tensors of two frames": lambda: so3.metric + s2.metric,
    "point without a value": lambda: screw.metric.at({"x": 1, "y": 2, "z": 3}),
    "singular point": lambda: polar().inverse_metric.at({"r": 0, "theta": 1}),
    "coefficients of wrong shape": lambda: gt.from_coefficients(so3, [[0, 0], [0, 0]]),
    "blend of two frames": lambda: gt.blend(gt.cartan(so3), gt.levi_civita(s2)),
    "velocity of wrong length": lambda: gt.cartan(so3).torsion.force([1, 2]),
    "text with an unknown name": lambda: gt.parse_expression("sin(q)*x", {"x": x}),
    "text that is code": lambda: gt.parse_expression("__import__('os')", {"x": x}),
    "text with a decimal": lambda: gt.parse_expression("0.5*x", {"x": x}),
    "text without its bracket": lambda: gt.parse_expression("sin(x", {"x": x}),
    # Curves
    "start of wrong length": lambda: gt.geodesic(so3, [0.3, 1.0], SPEED),
    "start that is not finite": lambda: gt.geodesic(so3, [0.3, NAN, 0], SPEED),
    "start at the edge of the chart": lambda: gt.geodesic(so3, [0.3, 0.0, 0.2], SPEED),
    "no velocity": lambda: gt.geodesic(so3, START),
    "both velocities": lambda: gt.geodesic(so3, START, SPEED, frame_velocity=SPEED),
    "parameter without a value": lambda: gt.geodesic(s2, [1, 0], [0, 1]),
    "invalid parameter": lambda: gt.geodesic(s2, [1, 0], [0, 1], parameters={"r": 1}),
    "timelike in space": lambda: gt.geodesic(so3, START, SPEED, causal="timelike"),
    "timelike but null": lambda: gt.geodesic(
        gt.spaces.load("schwarzschild").frame,
        [0, 6, 1.5, 0],
        frame_velocity=[1, 1, 0, 0],
        parameters={"M": 1},
        causal="timelike",
    ),
    "moments of a singular metric": lambda: gt.geodesic(so3, START, SPEED, metric=[1, 0, 2]),
    "transport of a short vector": lambda: gt.parallel_transport(line(), [1, 2]),
    "deviation without a place": lambda: gt.geodesic_deviation(
        gt.geodesic(so3, frame_velocity=SPEED), [1, 0, 0]
    ),
    "holonomy along too few expressions": lambda: gt.holonomy(
        gt.levi_civita(s2), [s], parameters={"R": 1}
    ),
    "opposite poles": lambda: log_map(
        gt.levi_civita(s2), [sp.pi / 2, 0], [sp.pi / 2, sp.pi], parameters={"R": 1}
    ),
    "accuracy that is not positive": lambda: gt.solve(line(), 1.0, 0.0),
    "accuracy out of reach": lambda: gt.solve(line(), 20.0, 1e-16, gt.RungeKutta()),
    "times on both sides": lambda: gt.solve(line(), [-1.0, 1.0]),
    "time that is not finite": lambda: gt.solve(line(), NAN),
    "time after the end": lambda: solved().at(1.5),
    "end of the chart": lambda: gt.solve(
        gt.autoparallel(gt.cartan(s2), [1.0, 0.0], frame_velocity=[-1, 0], parameters={"R": 1}),
        2.0,
        1e-8,
    ),
    "plunge through one chart": lambda: gt.solve(
        gt.geodesic(
            kerr,
            [0, 6, 1.5, 0],
            frame_velocity=[1, -2, 0, 0],
            parameters=ORBIT["parameters"],
            causal=None,
        ).with_charts("kerr"),
        40.0,
        1e-8,
    ),
    "invalid engine": lambda: wrong.solve(line(), 1.0, 1e-8, "taylor"),
    "many of the wrong shape": lambda: gt.solve_many(line(), [[1, 2]], 1.0),
    "many without starts": lambda: gt.solve_many(line(), t=1.0),
    "solve something other than a problem": lambda: wrong.solve(3, 1.0),
    "free top without a moment": lambda: gt.rigid.free_top((1, 0, 2), (1, 1, 1)),
    # Equations of one's own
    "rates without a start": lambda: ode({"x": 0, "y": 0}, [1]),
    "invalid state": lambda: ode({"x": 0}, {"x": 1, "z": 2}),
    "rate with an unknown name": lambda: ode({"x": "w*x"}, [1]),
    "rate with steps": lambda: ode({"x": sp.floor(x)}, [1]),
    "number that is a list": lambda: swing(parameters={"k": [1]}),
    "switch before the start": lambda: swing(events=[gt.At(-1, {"k": 2})]),
    "switch of an unknown name": lambda: swing(events=[gt.At(1, {"w": 2})]),
    "group that has not length one": lambda: ode({"a": 0, "b": 0}, [1, 1], normalized=["ab"]),
    "output with the name of a state": lambda: swing(outputs={"x": "v"}),
    "stop that no text is": lambda: stone(events=[gt.When(3j)]),
    "motion that runs away": lambda: gt.solve(ode({"x": "x**2"}, [1]), 2.0, 1e-8),
    "invalid output": lambda: gt.solve(swing(), 1.0)["energy"],
    "many with a wrong column": lambda: gt.solve_many(swing(), {"q": [1, 2]}, 1.0),
    # Actions
    "lagrangian with an unknown velocity": lambda: gt.equations_of_motion(
        so3, TOP + sp.Symbol("u7")
    ),
    "kinetic matrix that is singular": lambda: gt.equations_of_motion(so3, sp.Symbol("u1") ** 2),
    "forces of wrong length": lambda: gt.equations_of_motion(so3, TOP, [1, 2]),
    "constraints other than a list": lambda: gt.equations_of_motion(so3, TOP, constraints="u1"),
    "invalid principle": lambda: top_action(principle="Naive"),
    # Loops
    "loop of another dimension": lambda: gt.burgers_vector(so3, gt.Loop.circle([0, 0], 1)),
    "loop through a line": lambda: gt.burgers_vector(
        screw, gt.Loop.circle([1, 0, 0], 1), parameters={"b": 1}
    ),
    "accuracy of a loop": lambda: gt.burgers_vector(so3, circle(), 2),
    "loop without a parameter": lambda: gt.burgers_vector(screw, circle()),
    "radius that is negative": lambda: gt.Loop.circle(START, -1),
    "loops that miss each other": lambda: gt.Loop.circle([0, 0], 1).then(gt.Loop.circle([0, 0], 2)),
    "path without a length": lambda: gt.develop_path(gt.cartan(so3), [START]),
    "period that does not close": lambda: develop_period(
        gt.levi_civita(polar()), [[1, 0], [1, 6]], {"theta": 2 * sp.pi}
    ),
    "screws at one place": lambda: gt.loops.parallel_screws([(0, 0), (0, 0)], [1, 2]),
    "cycle without an edge": lambda: square().burgers([0, 2, 1]),
    "burgers vector that is zero": lambda: lines((0, 1, (0, 0, 0))),
    "node that does not balance": lambda: lines(("a", "j", (1, 0)), surface="a").checked(),
    "reaction that does not conserve": lambda: Reaction([(1, 0, 0)], [(1, 1, 0)]),
    "spline in closed form": lambda: gt.exact_burgers_vector(
        so3, gt.Loop.spline([[0, 1, 0], [1, 1, 0], [0, 2, 0]])
    ),
    # Scenes
    "body that is impossible": lambda: gt.Body(moments=(1, 1, 5)),
    "quantity that cannot be watched": lambda: heavy_top(watch=["nutaton"]),
    "invalid path": lambda: heavy_top().with_values({"gravity.gg": 1}),
    "gravity without a mass": lambda: gt.Scene(
        gt.Body(moments=(1, 1, 1)),
        [gt.effects.Gravity(9.81), gt.effects.Pivot([0, 0, 0.1])],
        gt.State(omega=(0, 0, 1)),
    ).run(),
    "spring that pushes": lambda: gt.effects.Spring(-1.0),
    "scene without times": lambda: heavy_top(t=[1, 1]),
    "unknown scene": lambda: gt.scenes.load("dzanibekov"),
    "sweep of a wrong measure": lambda: heavy_top().sweep(
        {"gravity.g": [1.0, 2.0]}, "maxi nutation"
    ),
    "scene without a start": lambda: gt.Scene(gt.Body(moments=(1, 2, 2)), watch=["omega"]),
    # Exercises
    "unknown exercise": lambda: gt.exercises.load("3.9"),
    "invalid seed": lambda: wrong.exercises.load("3.2", seed="a"),
    "invalid question": lambda: gt.exercises.load("3.2").question("ricci"),
}

"""Public calls with frozen answers: name -> (tolerance, call).

A call gives a number, a text, or lists and mappings of them. The tolerance is relative to the
largest number of a list. Exported names that may be renamed are collected below.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import sympy as sp
from typer.testing import CliRunner

import geomtorsion as gt
from geomtorsion.cli.app import app

# Exported names: if one is renamed, change it here.
log_map = gt.log_map
develop_period = gt.loops.develop_period
ode = gt.ODE.of

# Exactly computed values may differ by the rounding errors of their evaluation.
EXACT = 1e-13
# Two answers with errors of 1e-10 differ by at most the sum of both errors.
SOLVED = 2e-10

x, y, z, r, s = sp.symbols("x y z r s", positive=True)
so3 = gt.spaces.load("so3").frame
s2 = gt.spaces.load("s2").frame
kerr = gt.spaces.load("kerr").frame
screw = gt.spaces.load("screw_dislocation").frame
START, SPEED = [0.3, 1.0, 0.2], [0.1, 0.5, -0.2]
MOMENTS, SPIN = (1.1, 2.2, 3.3), (0.9, 0.4, 0.7)
FREE_TOP = gt.rigid.free_top(MOMENTS, SPIN)
RING = gt.Loop.circle([0.3, 0, 0], 1)
ORBIT = {
    "start": [0, 8.0, 1.4, 0],
    "frame_velocity": [1.2, 0.05, 0.2, 0.36],
    "parameters": {"M": 1, "a": 0.6},
}


POINTS = {
    "so3": {"phi1": 0.3, "phi2": 1.0, "phi3": 0.2},
    "kerr": {"t": 0, "r": 5, "theta": 1, "phi": 0, "M": 1, "a": 0.6},
    "s2": {"theta": 1, "phi": 0.5, "R": 1.5},
    "wavy": {"x": 0.7, "y": 1.2, "z": 0.4},
}


def wavy() -> gt.Frame:
    """A frame without symmetry."""
    rows = [[1 + y**2, 0, x / 3], [z / 2, 2, 0], [0, sp.sin(x), 1 + x * y]]
    return gt.Frame([x, y, z], rows, name="wavy")


def at(tensor: Any) -> Any:
    """Numbers of a tensor at the point of its frame."""
    frame = tensor.frame
    values = POINTS[frame.name.partition(":")[0].partition(",")[0]]
    names = {symbol.name: symbol for symbol in (*frame.coordinates, *frame.parameters)}
    return tensor.at({names[name]: value for name, value in values.items()})


def polar() -> gt.Frame:
    """The plane with the orthonormal frame of its polar coordinates."""
    theta = sp.Symbol("theta", real=True)
    return gt.Frame([r, theta], [[1, 0], [0, r]])


def circle(radius: float = 0.5, plane: tuple[int, int] = (0, 1)) -> gt.Loop:
    """A circle around the start on so3."""
    return gt.Loop.circle(centre=START, radius=radius, plane=plane)


def half() -> gt.Connection:
    """The connection a third of the way from Levi-Civita's to Cartan's on so3."""
    return gt.blend(gt.levi_civita(so3), gt.cartan(so3), sp.Rational(1, 3))


def states(solution: Any) -> Any:
    """States at the end of a solved ODE."""
    return solution.states[-1]


def place(solution: Any) -> dict[str, Any]:
    """Position and velocity at the end of a curve."""
    return {
        "coordinates": solution.coordinates[-1],
        "velocity": solution.velocity[-1],
        "frame velocity": solution.frame_velocity[-1],
    }


def lines(*arguments: str) -> list[str]:
    """The printed lines of a command."""
    result = CliRunner().invoke(app, list(arguments))
    assert result.exit_code == 0, result.output
    return result.stdout.rstrip().splitlines()


def stone(**more: Any) -> Any:
    """A stone that falls from 20 m."""
    return ode({"z": "v", "v": "-g"}, {"z": 20, "v": 0}, parameters={"g": 10}, **more)


def pushed() -> Any:
    """An oscillator with friction, pushed from 1/3 to 1/2 and stopped at 2."""
    switches = [(1 / 3, {"a": 3}), (0.5, {"a": 0}), (2, {"v": 0})]
    return ode(
        {"x": "v", "v": "-x - v/10 + a"},
        [1, 0],
        parameters={"a": 0},
        events=[gt.At(*each) for each in switches],
    )


def turning() -> Any:
    """Euler's equations with the attitude as a quaternion of unit length."""
    rates = {
        "a": "(B - C)/A*b*c",
        "b": "(C - A)/B*c*a",
        "c": "(A - B)/C*a*b",
        "q0": "-(q1*a + q2*b + q3*c)/2",
        "q1": "(q0*a + q2*c - q3*b)/2",
        "q2": "(q0*b + q3*a - q1*c)/2",
        "q3": "(q0*c + q1*b - q2*a)/2",
    }
    numbers = dict(zip("ABC", MOMENTS, strict=True))
    unit = [("q0", "q1", "q2", "q3")]
    return ode(rates, [*SPIN, 1, 0, 0, 0], parameters=numbers, normalized=unit)


def heavy_top(**more: Any) -> gt.Scene:
    """The top of the README."""
    return gt.Scene(
        gt.Body(mass=1.0, moments=(1, 1, 0.5)),
        effects=[gt.effects.Gravity(9.81), gt.effects.Pivot([0, 0, 0.1])],
        start=gt.State(omega=(0, 0, 20), euler=(0, 0.3, 0)),
        **({"watch": ["nutation", "energy", "euler"], "t": 3, "accuracy": 1e-10} | more),
    )


def scene(name: str, t: float) -> dict[str, Any]:
    """Final values of the watched quantities of a shipped scene."""
    result = gt.scenes.load(name).with_values(t=t).run()
    return {key: np.asarray(result[key])[-1] for key in result.values}


def carried(solution: Any) -> Any:
    """Vectors transported along a curve, at its end."""
    return solution.transported[-1]


def top_action(**more: Any) -> Any:
    """Equations of motion of a top on so3, from its energy."""
    spin = sp.symbols("u1 u2 u3")
    energy = sum(i * u**2 for i, u in zip(sp.symbols("I1 I2 I3"), spin, strict=True)) / 2
    return gt.equations_of_motion(so3, energy, **more)


def motion_of_action() -> Any:
    """The final state of the same top."""
    start = {"phi1": 0, "phi2": 1, "phi3": 0, "u1": 0.1, "u2": 2, "u3": 0}
    numbers = {"I1": 1, "I2": 2, "I3": 3}
    return states(gt.solve(ode(top_action(), start, parameters=numbers), 10.0, 1e-10))


def sampled() -> Any:
    """b of a loop in a frame that is known only on a grid."""
    axes = [np.linspace(0.5, 1.5, 13)] * 3
    grid = gt.SampledFrame.from_frame(wavy(), axes, 6)
    return grid.burgers(gt.Loop.circle([1.0, 1.0, 1.0], 0.3)).vector


def network() -> Any:
    """b of two loops of a small graph around two screws."""
    nodes = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [3, 1, 0], [3, -1, 0]])
    edges = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [2, 4], [4, 5], [5, 1]])
    screws = gt.loops.parallel_screws([(0, 0), (2, 0)], [1, "1/3"])
    net = gt.loops.Network(screws, gt.loops.EdgeList(nodes, edges))
    return net.burgers([0, 1, 2, 3]).vector, net.burgers([1, 5, 4, 2]).vector


def verdict(number: str, answers: Any) -> dict[str, Any]:
    """The verdict of an exercise on these answers."""
    said = gt.exercises.load(number, seed=0).check(answers)
    return {q.name: [q.right, q.score, q.diagnosis, q.message] for q in said.questions}


def solution(number: str) -> dict[str, str]:
    """The solution of an exercise, as text."""
    found = gt.exercises.load(number, seed=7).solution()
    return {name: str(answer) for name, answer in found.items()}


Call = Callable[[], Any]

GEOMETRY: dict[str, tuple[float, Call]] = {
    "kretschmann of kerr": (EXACT, lambda: at(kerr.quantity("kretschmann"))),
    "weyl of kerr in its frame": (EXACT, lambda: at(kerr.quantity("weyl").in_frame())),
    "torsion of so3": (EXACT, lambda: at(gt.cartan(so3).torsion.S)),
    "torsion of so3 in its frame": (EXACT, lambda: at(gt.cartan(so3).torsion.S.in_frame())),
    "torsion vector": (EXACT, lambda: at(gt.cartan(wavy()).torsion.vector)),
    "axial torsion": (EXACT, lambda: at(gt.cartan(wavy()).torsion.axial)),
    "torsion with its index down": (EXACT, lambda: at(gt.cartan(wavy()).torsion.S.lowered(2))),
    "contortion": (EXACT, lambda: at(gt.cartan(wavy()).contortion)),
    "cartan connection": (EXACT, lambda: at(gt.cartan(wavy()).coefficients)),
    "christoffel symbols": (EXACT, lambda: at(gt.levi_civita(wavy()).coefficients)),
    "ricci of a frame without symmetry": (EXACT, lambda: at(wavy().quantity("ricci"))),
    "scalar curvature": (EXACT, lambda: at(wavy().quantity("scalar_curvature"))),
    "curvature of a connection in between": (EXACT, lambda: at(half().curvature.ricci)),
    "ricci of a sphere": (EXACT, lambda: at(s2.quantity("ricci"))),
    "torsion force": (EXACT, lambda: at(gt.cartan(wavy()).torsion.force([1, 2, -1]))),
    "connections of polar coordinates": (
        0, lambda: [str(gt.cartan(polar())[0, 1, 1]), str(gt.levi_civita(polar())[1, 1, 0])]),
    "identities": (
        0, lambda: [[c.name, c.holds, c.checked] for c in gt.identities(gt.cartan(s2))]),
    "parsed expression": (0, lambda: str(gt.parse_expression("x^2*sin(2*x)/3 - 1/7", {"x": x}))),
}  # fmt: skip

LOOPS: dict[str, tuple[float, Call]] = {
    "burgers vector by its line": (1e-12, lambda: gt.burgers_vector(so3, circle()).vector),
    "burgers vector of a tiny circle": (
        1e-12, lambda: gt.burgers_vector(so3, circle(1e-12)).vector),
    "burgers vector of a screw": (
        1e-12,
        lambda: gt.burgers_vector(
            screw, gt.Loop.circle([0, 0, 0], 1).times(-2), parameters={"b": 0.7}).vector),
    "burgers vector of a polygon": (
        1e-12,
        lambda: gt.burgers_vector(
            wavy(), gt.Loop.polygon([[1, 1, 1], [2, 1, 1], [2, 2, 1.5]])).vector),
    "burgers vector in closed form": (
        0,
        lambda: str(gt.exact_burgers_vector(
            gt.spaces.load("heisenberg").frame, gt.Loop.circle([7, 2, 0], r)).vector)),
    "burgers vectors of many circles": (
        1e-10, lambda: gt.burgers_vectors(so3, [START, [1, 2, 3]], 0.1, (1, 2)).vectors),
    "burgers vectors of a grid": (
        1e-10,
        lambda: gt.burgers_map(
            so3, (np.linspace(0, 0.5, 3), np.linspace(0, 0.4, 3)), at=START).vectors),
    "development": (
        1e-12,
        lambda: [gt.develop(half(), circle()).burgers, gt.develop(half(), circle()).rotation]),
    "angle of a development on a sphere": (
        1e-12,
        lambda: gt.develop(
            gt.levi_civita(s2), gt.Loop.circle([1, 0.5], 1e-6), parameters={"R": 1}).angle),
    "development of a path": (
        1e-12, lambda: gt.develop_path(half(), [START, [0.5, 1.4, 1], [1, 1, 1]]).burgers),
    "development once around": (
        1e-12,
        lambda: develop_period(
            gt.levi_civita(polar()), [[1, 0], [1, 2 * np.pi]], {"theta": 2 * np.pi}).rotation),
    "enclosed defects": (
        0,
        lambda: [
            [str(found.defect), found.turns]
            for found in gt.loops.enclosed_defects(screw, RING, {"b": 1})]),
    "burgers vectors of a network": (1e-11, network),
    "burgers vector of a sampled frame": (1e-9, sampled),
    "loops: area and winding": (
        EXACT, lambda: [circle().area, gt.Loop.circle([0, 0, 0], 1).winding([0, 0, 0])]),
}  # fmt: skip

MOTIONS: dict[str, tuple[float, Call]] = {
    "autoparallel on so3": (
        SOLVED, lambda: place(gt.solve(gt.autoparallel(gt.cartan(so3), START, SPEED), 50.0))),
    "geodesic on so3 with moments": (
        SOLVED,
        lambda: place(gt.solve(
            gt.geodesic(so3, START, frame_velocity=SPIN, metric=MOMENTS), 5.0))),
    "geodesic of kerr": (
        SOLVED, lambda: place(gt.solve(gt.geodesic(kerr, causal=None, **ORBIT), 300.0))),
    "autoparallel in between": (
        SOLVED, lambda: place(gt.solve(gt.autoparallel(half(), START, SPEED), 5.0))),
    "geodesic at a time in between": (
        SOLVED,
        lambda: gt.solve(
            gt.geodesic(s2, [1, 0.5], [0.4, 0.9], parameters={"R": 2}), 5.0).at(1.23).coordinates),
    "transport along a geodesic": (
        SOLVED,
        lambda: carried(gt.solve(gt.parallel_transport(
            gt.geodesic(s2, [1, 0.5], [0.4, 0.9], parameters={"R": 2}), [1, 2]), 2.0))),
    "deviation of geodesics": (
        SOLVED,
        lambda: carried(gt.solve(gt.geodesic_deviation(
            gt.geodesic(s2, [1, 0.5], frame_velocity=[0.6, 0.8], parameters={"R": 2}),
            [0.1, 0.2], [0.3, 0.1]), 2.0))),
    "distance apart": (
        1e-9,
        lambda: gt.distance_apart(
            gt.solve(gt.autoparallel(gt.cartan(s2), [1, 0], [0.3, 0.5], parameters={"R": 1}), 1.0),
            gt.solve(gt.geodesic(s2, [1, 0], [0.3, 0.5], parameters={"R": 1}), 1.0))[-1]),
    "exponential map": (
        SOLVED,
        lambda: gt.exponential_map(
            gt.levi_civita(s2), [1.5, 0.3], [-1.2, 0.4], parameters={"R": 1})),
    "inverse of the exponential map": (
        1e-9, lambda: log_map(gt.levi_civita(s2), [1, 0], [2, 1], parameters={"R": 1}).vector),
    "holonomy of a circle of latitude": (
        SOLVED, lambda: gt.holonomy(gt.levi_civita(s2), [1, 2 * sp.pi * s], parameters={"R": 1})),
    "free top": (
        1e-14,
        lambda: [
            FREE_TOP.omega(1e3), FREE_TOP.quaternion(1e3)]),
    "many geodesics": (
        SOLVED,
        lambda: gt.solve_many(
            gt.geodesic(so3, START, frame_velocity=SPIN, metric=MOMENTS), None, 2.0, 1e-10,
            frame_velocities=[SPIN, [0.1, 1, 0.2], [1, 0, 0]]).coordinates),
}  # fmt: skip

FLOWS: dict[str, tuple[float, Call]] = {
    "pendulum": (SOLVED, lambda: states(gt.solve(ode({"x": "v", "v": "-sin(x)"}, [2, 0]), 20.0))),
    "pendulum by RungeKutta": (
        SOLVED,
        lambda: states(gt.solve(
            ode({"x": "v", "v": "-sin(x)"}, [2, 0]), 20.0, 1e-10, gt.RungeKutta()))),
    "switches and a jump": (SOLVED, lambda: gt.solve(pushed(), [0.4, 1, 2, 4]).states),
    "stop": (
        SOLVED,
        lambda: [gt.solve(stone(events=[gt.When("z")]), 5.0).times[-1],
                 states(gt.solve(stone(events=[gt.When("z")]), 5.0))[1]]),
    "attitude of unit length": (SOLVED, lambda: states(gt.solve(turning(), 20.0))),
    "outputs": (
        SOLVED, lambda: gt.solve(stone(outputs={"energy": "v**2/2 + g*z"}), 1.0)["energy"][-1]),
    "stiff": (
        1e-6,
        lambda: states(gt.solve(
            ode({"x": "-1000*(x - cos(t))", "w": "x - w"}, [0, 0]), 3.0, 1e-7, gt.Stiff()))),
    "many pendulums": (
        SOLVED,
        lambda: gt.solve_many(
            ode({"x": "v", "v": "-k*sin(x)"}, [2, 0], parameters={"k": 1}),
            {"k": [0.5, 1, 2], "x": [1, 2, 3]}, [1.0, 5.0]).states),
    "motion from an action": (SOLVED, motion_of_action),
}  # fmt: skip

SCENES: dict[str, tuple[float, Call]] = {
    "heavy top": (
        SOLVED, lambda: [heavy_top().run()["nutation"][-1], heavy_top().run()["euler"][-1]]),
    "states of the heavy top": (
        0, lambda: [list(heavy_top(watch=["nutation"]).selection.states),
                    list(heavy_top(watch=["nutation"]).selection.left_out)]),
    "dzhanibekov": (SOLVED, lambda: scene("dzhanibekov", 20.0)),
    "missile": (SOLVED, lambda: scene("missile", 3.0)),
    "rolling disc": (SOLVED, lambda: scene("rolling_disc", 2.0)),
    "sweep of flips": (
        1e-9,
        lambda: gt.scenes.load("dzhanibekov").sweep(
            {"start.omega[0]": [1e-6, 1e-3]}, "first zero omega[1]")["first zero omega[1]"]),
}  # fmt: skip

OTHERS: dict[str, tuple[float, Call]] = {
    "euler equations": (0, lambda: [str(line) for line in top_action().residuals]),
    "invariants of an action": (0, lambda: sorted(top_action().invariants)),
    "variation": (0, lambda: str(gt.variation(so3)).splitlines()),
    "naive accelerations": (
        0, lambda: [str(a) for a in top_action(principle="naive").accelerations]),
    "exercise solved": (0, lambda: solution("2.3")),
    "exercise of numbers": (1e-12, lambda: gt.exercises.load("4.1", seed=7).solution()),
    "right answer": (0, lambda: verdict("3.2", "1/tan(phi2)")),
    "wrong sign": (0, lambda: verdict("3.2", "-cos(phi2)/sin(phi2)")),
    "command geometry": (0, lambda: lines("geometry", "so3", "--only", "torsion,ricci")),
    "command check": (0, lambda: lines("check", "s2")),
    "command spaces": (0, lambda: lines("spaces")),
    "command plan": (0, lambda: lines("plan", "so3", "ricci")),
    "command burgers": (0, lambda: lines("burgers", "so3", "--circle", "0.3,1,0.2:1e-12")[1:2]),
    "command exercises check": (
        0, lambda: lines("exercises", "check", "3.2", "cos(phi2)/sin(phi2)")),
}  # fmt: skip

VALUES = GEOMETRY | LOOPS | MOTIONS | FLOWS | SCENES | OTHERS

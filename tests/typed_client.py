"""Calls that a checker of types passes, and calls that it refuses, which end in "# wrong"."""

from fractions import Fraction

import numpy as np
import sympy as sp

import geomtorsion as gt

r, theta = sp.symbols("r theta", positive=True)
frame = gt.Frame([r, theta], [[1, 0], [0, r]])


def right(loop: gt.Loop) -> None:
    """Frames, motions, fits and quantities in the ways in which users write them."""
    gt.Frame("r theta", [["1", "0"], ["0", "r"]], domain="r > 0")
    gt.Frame("t x", [[1, 0], [0, "a"]], signature="-+", parameters="a")
    gt.Frame(("x", "y"), ((1, Fraction(1, 2)), (0, 1)), (1, 1), ["k"], ["x > 0"])
    gt.Frame([r, "phi"], [[1, 0], [0, r]], parameters=[sp.Symbol("M")])
    gt.Frame("x y", np.eye(2, dtype=int))
    gt.Frame("x y", sp.eye(2))
    gt.Frame.from_metric("r theta", frame.metric, [1, 1], None, [r > 0])
    gt.Frame.from_metric("r theta", sp.diag(1, r**2))
    gt.Frame.from_frame("r theta", [[1, 0], [0, 1 / r]])
    gt.Frame.from_structure_constants({(0, 1, 2): 1})
    frame.vector([1, r])
    frame.scalar("2 r")
    gt.from_torsion(frame, [[[0, 0], [0, 1]], [[0, -1], [0, 0]]])
    gt.from_torsion(frame, gt.cartan(frame).torsion.S)
    curve = gt.geodesic(frame, [1, 0], (0, 0.5), stop="3 - r", parameters={"R": 2})
    gt.geodesic("s2", {"theta": 1, "phi": 0}, frame_velocity=np.array([0, 1]))
    gt.autoparallel(gt.cartan(frame), [1, 0], [1, 0], force=["0", "-r"], potential="r**2")
    gt.autoparallel("so3", frame_velocity=[1, 2, 3], stop=[gt.When("phi1")])
    solution = gt.solve(curve, 3)
    gt.solve(curve, "3 min")
    gt.solve(curve, np.linspace(0, 1, 3), accuracy=1e-9, engine=gt.Taylor())
    gt.solve(curve, [0, Fraction(1, 2), 1.0], derivatives=["r"])
    gt.solve(curve, range(3))
    gt.solve_many(curve, [[1, 0], [2, 0]], 1.0)
    gt.solve_many(curve, {"r": [1.0, 2.0]}, t=[0, 1])
    gt.solve_many(curve, velocities=np.zeros((3, 2)), t=1)
    gt.fit(curve, solution.times, {"r": solution["r"]}, 0.1, ["r"], loss="huber")
    gt.fit(curve, "t", solution.to_pandas(), None, ["r"], bounds={"r": (0, None)})
    gt.fit(curve, [1, 2], solution, {"r": 0.1}, ["r"])
    gt.burgers_vector("so3", loop, accuracy=1e-9).vector.round(3)
    gt.levi_civita(frame).curvature.scalar.subs(r, 2).at({"theta": 1})
    frame.metric.subs({"r": 2}).subs([("k", 1)])
    component: sp.Expr = gt.cartan(frame).torsion.S[0, 1, 1]
    component.subs(r, 2)
    gt.levi_civita(frame)["r", theta, -1].diff(r)
    frame.metric[:, 0].tolist()
    frame.metric.at({r: [1, 2]}).sum()


def wrong(curve: gt.CurveProblem, loop: gt.Loop) -> None:
    """Slips: arguments in another order, of another kind, and names that do not exist."""
    gt.Frame([r, theta], 3)  # wrong
    gt.Frame(3, [[1, 0], [0, r]])  # wrong
    gt.Frame([r, theta], [1, r])  # wrong
    gt.Frame("r theta", [[1, 0], [0, 1.5]])  # wrong
    gt.Frame("r theta", [["1", "0"], ["0", "r"]], signature=-1)  # wrong
    gt.Frame("r theta", [["1", "0"], ["0", "r"]], parameters=2)  # wrong
    gt.Frame("r theta", [["1", "0"], ["0", "r"]], domain=0)  # wrong
    gt.Frame.from_metric("r theta", r**2 + 1, metric=3)  # wrong
    gt.Frame.from_metric("r theta", 1)  # wrong
    frame.vector(1)  # wrong
    gt.from_torsion(frame, 0)  # wrong
    gt.solve(curve)  # wrong
    gt.solve(curve, t=None)  # wrong
    gt.solve(curve, t=curve)  # wrong
    gt.solve("kerr", 1.0)  # wrong
    gt.solve(1.0, curve)  # wrong
    gt.solve_many(curve, 3, 1.0)  # wrong
    gt.solve_many(curve, [1, 0], 1.0)  # wrong
    gt.geodesic(frame, 1, 0)  # wrong
    gt.geodesic(frame, [1, 0], [0, 1], stop=3)  # wrong
    gt.geodesic(frame, [1, 0], [0, 1], force=1.5)  # wrong
    gt.autoparallel(frame, [1, 0], [0, 1])  # wrong
    gt.fit(curve, [1, 2], [3, 4], 0.1, ["r"])  # wrong
    gt.fit(curve, [1, 2], {"r": [3, 4]}, 0.1, ["r"], bounds=(0, 1))  # wrong
    gt.fit(curve, [1, 2], {"r": [3, 4]}, 0.1, ["r"], loss=1)  # wrong
    gt.burgers_vector(loop, frame)  # wrong
    gt.burgers_vector(frame, [1, 0])  # wrong
    gt.levi_civita(frame).curvature.riemann[0, 0, 0, 0].tolist()  # wrong
    frame.metric.at([1, 2])  # wrong
    frame.metric.diff(1)  # wrong

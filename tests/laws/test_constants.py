"""Laws: constants in equations keep their values, however a motion is read."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy.core.function import AppliedUndef

from geomtorsion.curves import CurveProblem, autoparallel, distance_apart, geodesic, log_map
from geomtorsion.errors import ChartEdgeError
from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.ode import (
    ODE,
    Engine,
    RungeKutta,
    SavedSolution,
    Taylor,
    solve,
    solve_many,
)
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.spaces import load, names
from geomtorsion.spaces.first_motion import first_motion
from tests.cli.running import run

COORDINATES = sp.symbols("x y z", real=True)
ENGINES = [RungeKutta(), *([Taylor(), Taylor(64), Taylor(113)] if is_available() else [])]
FACTOR = 5 * sp.sqrt(2) / 7
CONSTANTS = [sp.sqrt(2), 1 / (2 * sp.pi), sp.exp(sp.Rational(1, 3)), sp.cos(1), sp.sqrt(3) / 7]


def irrational_motions(name: str) -> tuple[list[CurveProblem], float]:
    """Geodesics of a shipped space with irrational numbers, and the duration to follow them.

    The numbers are parameters, or entries of a frame without parameters. A space without parameters
    gets an irrational unit of length.
    """
    frame = load(name).frame
    motion = first_motion(frame)
    functions = frame.coframe.to_sympy().atoms(AppliedUndef)
    frame = frame.subs({a: sp.sqrt(2) + a.args[0] ** 2 for a in functions}) if functions else frame
    numbers = {p: sp.nsimplify(x) * FACTOR for p, x in motion.parameters.items()}
    given: dict[str, Any] = {"start": motion.start, "frame_velocity": motion.frame_velocity}
    if numbers:
        made = [
            geodesic(frame, **given, parameters=numbers),
            geodesic(frame.subs(numbers), **given),
        ]
    else:
        coframe = sp.Matrix(frame.coframe.to_sympy().tolist()) * FACTOR
        eta = sp.Matrix(frame.eta.to_sympy().tolist())
        made = [geodesic(Frame(frame.coordinates, coframe, eta, domain=frame.domain), **given)]
    assert not made[-1].frame.parameters
    return made, motion.t / 16


def check_readings(problem: CurveProblem, times: np.ndarray, folder: Path) -> None:
    """All ways to read a motion give the coordinates of Runge-Kutta steps at the times."""
    truth = solve(problem, times, 1e-10, RungeKutta()).coordinates
    end, size = float(times[-1]), np.abs(truth).max()

    def same(found: Any, wanted: Any = truth) -> None:
        assert np.abs(np.asarray(found).astype(float) - wanted).max() < 1e-8 * size

    solution = solve(problem, times)
    same(solution.coordinates)
    same(solution.at(times).coordinates)
    same(solve(problem, end).at(times).coordinates)
    assert solution.error_between < 1e-8
    moving = int(np.argmax(np.abs(truth[-1] - truth[0])))
    middle = len(times) // 2
    name = problem.coordinates[moving]
    crossings = solution.event_times(sp.Symbol(name, real=True) - float(truth[middle, moving]))
    assert np.abs(crossings - times[middle]).min() < 1e-6
    same(distance_apart(solution, solve(problem, times, engine=RungeKutta())), 0.0)
    kept = solve(problem, times, checkpoint=folder / "run.npz", overwrite=True)
    same(kept.coordinates)
    assert problem.start is not None
    starts = [problem.start] * 2
    many = solve_many(problem, starts, times, frame_velocities=[problem.frame_velocity] * 2)
    same(many.coordinates)
    solution.save(folder / "saved.npz")
    same(SavedSolution.load(folder / "saved.npz")["coordinates"])
    for engine in ENGINES[1:]:
        same(solve(problem, times, engine=engine).coordinates)


# One space of each kind: parameters, unknown functions, no parameters, charts, a group, torsion,
# three and seven coordinates. `pytest -m slow` has all.
KINDS = ("kerr_newman", "frw", "s2", "schwarzschild", "so3", "edge_dislocation", "s7")
# A complex tetrad has no motions.
OTHERS = [
    pytest.param(name, marks=pytest.mark.slow)
    for name in names()
    if name not in ("kerr_kinnersley", *KINDS)
]


@pytest.mark.parametrize("name", [*KINDS, *OTHERS])
def test_a_motion_in_a_shipped_space(name: str, tmp_path: Path) -> None:
    """Every way to read the motion agrees with its samples."""
    problems, end = irrational_motions(name)
    for problem in problems:
        check_readings(problem, end * np.array([0.25, 0.5, 0.75, 1.0]), tmp_path)


@st.composite
def frames_with_constants(draw: st.DrawFn) -> Frame:
    """A Riemannian frame without parameters, nearly diagonal, whose entries contain constants."""
    n = draw(st.integers(2, 3))
    symbols = COORDINATES[:n]
    symbol, constant = st.sampled_from(symbols), st.sampled_from(CONSTANTS)
    matrix = sp.zeros(n)
    for i in range(n):
        shape = draw(st.sampled_from([sp.Integer(2), sp.sin(draw(symbol)), draw(symbol) ** 2]))
        matrix[i, i] = 2 + draw(constant) * (1 + shape)
        for j in range(i):
            part = draw(st.sampled_from([sp.Integer(0), draw(symbol), sp.cos(draw(symbol))]))
            matrix[i, j] = draw(constant) * part / 4
    return Frame(symbols, matrix)


@settings(max_examples=5)
@given(
    frame=frames_with_constants(),
    velocity=st.lists(st.integers(1, 9), min_size=3, max_size=3),
    shortest=st.booleans(),
)
def test_a_motion_in_a_random_frame(
    frame: Frame, velocity: list[int], shortest: bool, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Geodesics and autoparallels agree; log_map recovers the velocity of a short geodesic."""
    n = frame.dimension
    start, direction = [0.1, 0.2, 0.3][:n], [x / 5 for x in velocity[:n]]
    make = geodesic if shortest else autoparallel
    space = levi_civita(frame) if shortest else cartan(frame)
    problem = make(space, start, frame_velocity=direction)
    times = np.array([0.25, 0.5, 0.75, 1.0])
    check_readings(problem, times, tmp_path_factory.mktemp("motion"))
    end = solve(problem, 0.25).coordinates[-1]
    shot = log_map(space, start, end, guess=[x / 4 for x in direction])
    assert 4 * shot.vector == pytest.approx(np.array(direction), rel=1e-7)


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_an_edge_that_is_a_constant(engine: Engine) -> None:
    """A straight line in the plane meets the circle r = 1/sqrt(2), where its chart ends."""
    r, phi = sp.symbols("r phi", positive=True)
    frame = Frame([r, phi], [[1, 0], [0, r]], domain=[r > 1 / sp.sqrt(2)])
    problem = geodesic(frame, [2, 0.5], frame_velocity=[-1, 0])
    with pytest.raises(ChartEdgeError) as caught:
        solve(problem, [1.0, 1.2928, 1.2930, 1.5], 1e-8, engine)
    assert "t = 1.29289" in str(caught.value)
    assert caught.value.solution.times.tolist() == [1.0, 1.2928]


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_equations_of_a_user(engine: Engine, tmp_path: Path) -> None:
    """x'' = -sqrt(2) x/(2 pi) gives a cosine between its times, also from a file."""
    problem = ODE.of({"x": "v", "v": "-sqrt(2)*x/(2*pi)"}, [1, 0])
    solution = solve(problem, 3.0, 1e-9, engine)
    solution.save(tmp_path / "saved.npz")
    times = np.linspace(0.1, 2.9, 5)
    for some in (solution, SavedSolution.load(tmp_path / "saved.npz")):
        found = some.at(times)["x"].astype(float)
        assert found == pytest.approx(np.cos(np.sqrt(np.sqrt(2) / (2 * np.pi)) * times), abs=1e-7)


SCREW = """
coordinates = ["r", "phi", "z"]
domain = ["r > 0"]
coframe = [["1", "0", "0"], ["0", "r", "0"], ["0", "1/(2*pi)", "1"]]
"""


def test_commands(tmp_path: Path) -> None:
    """`price` and `curve` integrate a screw whose Burgers vector is 1: r^2 phi' and z' by hand.

    A geodesic of dr^2 + r^2 dphi^2 + (dz + dphi/(2 pi))^2 is a straight line in r and phi, and z +
    phi/(2 pi) grows evenly.
    """
    file = tmp_path / "screw.toml"
    file.write_text(SCREW)
    motion = (str(file), "--start", "1,0,0", "--frame-velocity", "0,1,0.5", "--t", "1")
    run("price", *motion, "--accuracies", "1e-8", "--proofs", "10", "-o", str(tmp_path))
    rows = json.loads((tmp_path / "price.json").read_text("utf-8"))["rows"]
    assert rows
    assert all(row["true"][1] < 1e-7 for row in rows)
    run("curve", *motion, "--samples", "3", "-o", str(tmp_path))
    with (tmp_path / "curve.csv").open(encoding="utf-8", newline="") as lines:
        last = list(csv.DictReader(lines))[-1]
    found = [float(last[f"geodesic {name}"]) for name in ("r", "phi", "z")]
    phi = np.pi / 4
    assert found == pytest.approx([np.sqrt(2), phi, 0.5 - phi / (2 * np.pi)], abs=1e-9)

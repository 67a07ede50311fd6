"""Reduced systems: exactly the same motion, with the momenta of cyclic coordinates as constants."""

from functools import cache

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.errors import ChartEdgeError
from geomtorsion.geometry import Frame
from geomtorsion.motion import Recorded, RungeKutta, Stiff, Taylor, geodesic, solve
from geomtorsion.motion.charts import Chart
from geomtorsion.motion.engines.taylor import is_available
from geomtorsion.motion.equations import written
from geomtorsion.motion.journey import departure
from geomtorsion.motion.laws import Hamel
from geomtorsion.motion.reduced.rates import in_momenta
from geomtorsion.motion.reduced.runs import Reduction, integrated
from geomtorsion.spaces import load, names
from tests.motion.engines import every_engine
from tests.motion.reduced_truth import compare, reduction_of, split_of

X, Y, Z, W, STRENGTH = sp.symbols("x y z w k", positive=True)
with_heyoka = pytest.mark.skipif(not is_available(), reason="needs more than double precision")

# M = 1, a = 0.6: bound, inclined, eccentric.
BOUND = {"start": [0, 8.0, 1.4, 0], "frame_velocity": [1.2, 0.05, 0.2, 0.45]}
KERR = {"M": 1, "a": 0.6}


@cache
def kerr():
    return load("kerr").frame


def orbit(**changes):
    """A geodesic of Kerr's space in the coordinates of Boyer and Lindquist."""
    given_values = BOUND | {"parameters": KERR, "causal": None} | changes
    return geodesic(kerr(), **given_values).with_charts("kerr")


def started(problem, bits=53):
    """Equations, system without edge, start and parameters."""
    name, _, vector, parameters = departure(problem, bits)
    equations = problem.equations(name)
    return equations, equations.system.without_edge, vector, parameters


# -- exactly ---------------------------------------------------------------------------------------

functions = st.sampled_from(
    [sp.Integer(1), X, 1 + X**2, sp.exp(Y), 2 + sp.sin(X), X * Y, STRENGTH * X, 1 / (1 + X * Y)]
)


@st.composite
def cyclic_frames(draw):
    """Frames over x, y, z, w in which z and w do not occur, of any signature."""
    matrix = sp.diag(draw(functions), draw(functions), draw(functions), draw(functions))
    matrix[2, 3] = draw(functions | st.just(sp.Integer(0)))
    order = draw(st.permutations(range(4)))
    rows = [list(matrix.row(i)) for i in order]
    signs = draw(st.sampled_from([(1, 1, 1, 1), (-1, 1, 1, 1), (1, -1, 1, 1)]))
    return Frame((X, Y, Z, W), rows, signature=signs, parameters=(STRENGTH,))


@settings(max_examples=25, deadline=None)
@given(cyclic_frames(), st.integers(0, 2), st.booleans())
def test_the_rates_are_those_of_the_frame(frame, scaled, squared):
    """q' and p' of both forms agree, exactly, once u = G^-1 E p and N = G u u are put in."""
    equations = written(frame, Hamel(), Chart.of(frame))
    if not equations.moves:
        return
    parts = split_of(equations)
    (inverse,) = parts.leg(parts.others[min(scaled, len(parts.others) - 1)]).values()
    scale = frame.field.one if scaled == 2 else 1 / (inverse * inverse)
    squares = [i for i in parts.along if len(parts.leg(i)) > 1] if squared else []
    small = in_momenta(parts, scale, squares)
    compare(equations, parts, small)


def test_where_it_is_found():
    """Where rates are long enough for it to pay; elsewhere the equations stay as they are."""
    found = set()
    for name in names():
        frame = load(name).frame
        symbols = {s.name for s in frame.field.symbols}
        if frame.complex or any(g.kind == "opaque" for g in frame.field.generators):
            continue
        assert symbols
        if written(frame, Hamel(), Chart.of(frame)).reduction is not None:
            found.add(name)
    assert {"kerr", "schwarzschild", "schwarzschild_isotropic", "de_sitter"} <= found
    assert not found & {"so3", "s2", "flat_polar", "s7", "r3xso3"}


def test_compiled_integrators_are_kept_apart():
    """The smaller system has a key of its own, and fewer states."""
    equations = orbit().equations("kerr")
    small = reduction_of(equations).system
    assert small.key != equations.system.key
    assert small.states == ("t", "r", "theta", "phi", "v_r", "v_theta")
    assert small.without_edge.key != small.key


def test_the_end_is_watched_without_quotients():
    """Only the sign of delta sin(theta) / r^2 matters there; the margin needs its size."""
    equations = orbit().equations("kerr")
    watched = reduction_of(equations).watching(equations.system.to_the_end)
    assert "/" not in watched.edge_code[0]
    assert "/" in reduction_of(equations).watching(equations.system).edge_code[0]
    for r, theta in ((8, 1.4), (1.9, 1.4), (1.7, 0.3), (0.1, 2.0), (3, -0.2), (-1, 0.5)):
        numbers = (0, r, theta, 0, *(0.3 for _ in watched.states[4:]))
        values = {"a": 0.6, "M": 1}
        found = watched.scalar_edge(*numbers, *(values.get(p, 0.3) for p in watched.parameters))
        assert np.sign(found[0]) == np.sign((r * r - 2 * r + 0.36) * np.sin(theta))


# -- as numbers ------------------------------------------------------------------------------------

STARTS = {
    "bound": BOUND["frame_velocity"],
    "null": [1.3, 0.3, 0.4, 1.2],
    "no angular momentum": [1.2, 0.05, 0.2, 0.0],
    "spacelike": [0.0, 0.5, 0.2, 0.1],
    "only along cyclic coordinates": [1.2, 0.0, 0.0, 0.45],
}


@with_heyoka
@pytest.mark.parametrize("velocity", STARTS.values(), ids=STARTS)
@pytest.mark.parametrize("end", [20.0, -20.0])
def test_against_the_full_system(velocity, end):
    """At 113 bits both systems give the same states, velocities and dense output."""
    engine, tolerance = Taylor(113), 1e-26
    equations, system, vector, parameters = started(orbit(frame_velocity=velocity), 113)
    times = np.linspace(0, end, 9)
    whole = engine.run(system, vector, parameters, times, tolerance, dense=True)
    assert reduction_of(equations).opened(engine, vector, parameters) is not None
    small = integrated(engine, equations, system, vector, parameters, times, tolerance, dense=True)
    assert small.states.shape == whole.states.shape
    gaps = [small.states - whole.states, (small.last - whole.last)[None]]
    between = times[:-1] + 0.3
    assert small.dense is not None
    assert whole.dense is not None
    gaps.append(small.dense(between) - whole.dense(between))
    # Errors of steps, a few dozen of them, that grow along the way.
    assert max(np.abs(gap.astype(float)).max() for gap in gaps) < 1e-20


@with_heyoka
@pytest.mark.parametrize("bits", [53, 64, 300])
def test_at_every_precision(bits):
    """Each number type comes back as it is, with all of its digits."""
    engine = Taylor(bits)
    equations, system, vector, parameters = started(orbit(), bits)
    times = np.linspace(0, 4.0, 5)
    whole = engine.run(system, vector, parameters, times, engine.finest)
    small = integrated(engine, equations, system, vector, parameters, times, engine.finest)
    assert small.states.dtype == whole.states.dtype
    gap = np.abs((small.states - whole.states).astype(float)).max()
    assert gap < 2.0 ** (10 - bits)


@with_heyoka
def test_carters_constant():
    """p_theta^2 + cos^2 theta (a^2 (m^2 - E^2) + L^2 / sin^2 theta) stays what it was."""
    problem = orbit()
    equations, system, vector, parameters = started(problem, 64)
    times = np.linspace(0, 300.0, 40)
    found = integrated(Taylor(64), equations, system, vector, parameters, times, 1e-20)
    _, r, theta, _, u1, u2, u3, u4 = found.states.T
    # The parameter is the double nearest to 0.6.
    a = np.longdouble(0.6)
    rho = np.sqrt(r**2 + (a * np.cos(theta)) ** 2)
    delta = r**2 - 2 * r + a**2
    energy = (np.sqrt(delta) * u1 + a * np.sin(theta) * u4) / rho
    turn = np.sin(theta) / rho * (a * np.sqrt(delta) * np.sin(theta) * u1 + (r**2 + a**2) * u4)
    mass = u1**2 - u2**2 - u3**2 - u4**2
    constant = (rho * u3) ** 2 + np.cos(theta) ** 2 * (
        a**2 * (mass - energy**2) + turn**2 / np.sin(theta) ** 2
    )
    for kept in (energy, turn, mass, constant):
        assert np.abs(kept / kept[0] - 1).max() < 1e-16


@every_engine
def test_all_engines_solve_it(engine):
    """States agree, and the momenta drift by rounding alone although the norm may drift more."""
    sol = solve(orbit(), 60.0, 1e-8, engine)
    tight = solve(orbit(), 60.0, 1e-11, RungeKutta())
    sizes = np.abs(tight.coordinates).max()
    assert np.abs(sol.coordinates - tight.coordinates).max() < 2e-8 * sizes
    equations, system, vector, parameters = started(orbit())
    found = integrated(engine or Taylor(), equations, system, vector, parameters, sol.times, 1e-9)
    small = reduction_of(equations)
    first = np.array(small.constants(vector, parameters))
    momenta = [small.names.index(f"p_{name}") for name in ("t", "phi")]
    for row in found.states:
        again = np.array(small.constants(row, parameters))
        assert np.abs(again / first - 1)[momenta].max() < 1e-14


def test_a_circle_by_blocks():
    """Velocities that are left vanish: engines that measure by blocks keep the full system."""
    frame = load("schwarzschild").frame
    speed = [np.sqrt(4 / 3), 0.0, 0.0, np.sqrt(1 / 3)]
    start = [0, 6.0, np.pi / 2, 0]
    problem = geodesic(frame, start, frame_velocity=speed, parameters={"M": 1})
    problem = problem.with_charts("schwarzschild")
    equations, _, vector, parameters = started(problem)
    for engine in (RungeKutta(), Stiff()):
        assert reduction_of(equations).opened(engine, vector, parameters) is None
    sol = solve(problem, 50.0, 1e-9, RungeKutta())
    assert np.abs(sol.column("r") - 6).max() < 1e-7
    if is_available():
        assert reduction_of(equations).opened(Taylor(), vector, parameters) is not None


def test_digits_that_momenta_would_lose():
    """u = E p with large parts that cancel: such starts keep the full system."""
    rows = [
        [1 + X**2, 0, 0, 0],
        [0, 2 + sp.sin(X * Y), 0, 0],
        [0, 0, sp.exp(X), sp.Integer(10) ** 10 * sp.sqrt(1 + Y**2)],
        [0, 0, 0, 1 + X * Y],
    ]
    frame = Frame((X, Y, Z, W), rows)
    problem = geodesic(frame, [0.3, 0.4, 0, 0], frame_velocity=[0.1, 0.2, 1.0, 0.7])
    equations, _, vector, parameters = started(problem)
    parts = split_of(equations)
    smaller = Reduction(equations.system, in_momenta(parts, frame.field.one, ()))
    assert smaller.opened(RungeKutta(), vector, parameters) is None
    near = smaller.opening(vector, parameters, 53)
    back = smaller.widened(near.start[None, :], near, 53)[0]
    assert np.abs(back - vector).max() > 1e-9


@every_engine
def test_it_stops_at_the_edge(engine):
    """Falling in, the one chart ends at the horizon: with place, and with what there was."""
    problem = geodesic(
        load("schwarzschild").frame,
        [0, 6.0, 1.2, 0],
        frame_velocity=[1.5, -1.1, 0.1, 0.2],
        parameters={"M": 1},
        causal=None,
    )
    with pytest.raises(ChartEdgeError, match="chart 'schwarzschild' ends") as caught:
        solve(problem.with_charts("schwarzschild"), 30.0, 1e-7, engine)
    r = caught.value.solution.column("r")
    assert len(r) > 5
    assert (np.diff(r) < 0).all()


def test_through_the_horizon():
    """The momenta go over into the chart behind the horizon: energy and size are as before."""
    problem = geodesic(
        load("schwarzschild").frame,
        [0, 6.0, 1.2, 0],
        frame_velocity=[1.5, -1.1, 0.1, 0.2],
        parameters={"M": 1},
        causal=None,
    )
    sol = solve(problem, 4.0, 1e-8)
    assert sol.charts != ("schwarzschild",)
    assert max(sol.drift.values()) < 1e-6


def test_reading_and_saving(tmp_path):
    """Between the samples, as a table and from a file all numbers are there."""
    sol = solve(orbit(), 30.0, 1e-9)
    finer = solve(orbit(), np.array([0.0, 7.3, 11.9]), 1e-11)
    moment = sol.at([7.3, 11.9])
    assert np.abs(moment.coordinates - finer.coordinates[1:]).max() < 1e-7
    assert np.abs(moment.frame_velocity - finer.frame_velocity[1:]).max() < 1e-8
    table = sol.to_pandas()
    assert list(table.columns[-4:]) == ["u1", "u2", "u3", "u4"]
    sol.save(tmp_path / "orbit.npz")
    again = Recorded.load(tmp_path / "orbit.npz")
    assert np.array_equal(again.frame_velocity, sol.frame_velocity)
    assert again.metadata["drift"]["momentum of t"] < 1e-13

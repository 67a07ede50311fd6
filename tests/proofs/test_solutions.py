"""Solutions: through charts and jumps, and random motions whose errors are judged."""

import math

import numpy as np
import pytest
import sympy as sp
from flint import arb

import geomtorsion as gt
from geomtorsion.spaces.pair import solve_pair
from geomtorsion.support.precision import ball_precision
from tests.chosen import few
from tests.ode.engines import needs_heyoka
from tests.proofs.campaign import FAMILIES, campaign


@needs_heyoka
@pytest.mark.parametrize("seed", [1])
def test_one_motion_of_each_family(seed):
    """Each motion is proved, and its error holds."""
    found = campaign(len(FAMILIES), seed)
    assert [x.family for x in found] == [x.__name__ for x in FAMILIES]
    assert all(x.holds for x in found), "\n".join(map(str, found))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 5))
def test_a_campaign_of_random_motions(seed):
    """All of a hundred motions are proved; errors that do not hold are rare and off by little."""
    found = campaign(104, seed)
    print("\n".join(str(x) for x in found if x.holds is not True))
    assert not [x for x in found if x.words.startswith("not proved")]
    broken = [x for x in found if x.holds is False]
    assert len(broken) <= 5
    assert all(x.proved <= 5 * x.claimed for x in broken)


@pytest.mark.parametrize("space", ["so3_rodrigues", "so3_axis_angle", "s3", "so3_right", "goedel"])
def test_first_motions_of_spaces(space):
    """The first motions of a space are proved in the charts of their solutions."""
    pair = solve_pair(gt.spaces.load(space))
    for solution in pair.curves.values():
        proof = gt.prove(solution)
        assert proof.holds is not False
        assert set(proof.charts) <= {"home", space, "quaternion", *solution.charts}


def _judged(solution):
    """The proof of a solution, or the reason without one within a minute."""
    try:
        with gt.limits(seconds=60):
            return gt.prove(solution)
    except (gt.errors.ProofError, gt.errors.AllowanceError) as error:
        return error


@pytest.mark.slow
@pytest.mark.parametrize("name", gt.spaces.names())
def test_no_error_of_a_first_motion_is_wrong(name):
    """First motions of every shipped space are proved, or refused with a message."""
    try:
        pair = solve_pair(gt.spaces.load(name))
    except gt.errors.StartError as error:
        pytest.skip(f"it has no motions in numbers: {error}")
    for solution in pair.curves.values():
        verdict = _judged(solution)
        print(verdict)
        assert isinstance(verdict, Exception) or verdict.holds is not False


@pytest.mark.slow
@pytest.mark.parametrize("name", gt.scenes.names())
def test_no_error_of_a_scene_is_wrong(name):
    """Every shipped scene is proved, or refused with a message."""
    verdict = _judged(gt.scenes.load(name).run().solution)
    print(verdict)
    assert isinstance(verdict, Exception) or verdict.holds is not False


def test_over_gimbal_lock():
    """Through two sets of angles at gimbal lock, body velocities are the same numbers."""
    so3 = gt.spaces.load("so3").frame
    problem = gt.geodesic(
        so3, [0.01, 1.2, 0.2], frame_velocity=[0.01, -1.0, 0.02], metric=[1, 2, 3]
    )
    hops = gt.prove(gt.solve(problem.with_charts("so3", "so3_xyz"), 2.4))
    hub = gt.prove(gt.solve(problem, 2.4))
    assert hops.holds
    assert set(hops.charts) == {"so3", "so3_xyz"}
    with ball_precision(120):
        for one, other in zip(hops.balls, hub.balls, strict=True):
            assert all(x.overlaps(y) for x, y in zip(one[3:6], other[4:7], strict=True))


def test_a_transported_vector_keeps_its_length():
    """Transported vectors are proved as well."""
    s2 = gt.spaces.load("s2").frame
    great = gt.geodesic(s2, [1.0, 0.0], [0.3, 0.5], parameters={"R": 1})
    problem = gt.parallel_transport(great, [1.0, 2.0])
    proof = gt.prove(gt.solve(problem, 2.0))
    assert proof.holds
    with ball_precision(120):
        *_, x, y = proof.balls[-1]
        assert (x * x + y * y).contains(5)


def test_velocities_are_in_the_time_of_users():
    """Frame velocities agree with the result, whatever unit of time the solver used."""
    s2 = gt.spaces.load("s2").frame
    for speed in (1e-3, 1.0, 300.0):
        solution = gt.solve(
            gt.geodesic(s2, [1.0, 0.0], [0.3 * speed, 0.5 * speed], parameters={"R": 1}), 1 / speed
        )
        proof = gt.prove(solution)
        assert proof.holds
        moving = proof.values[:, 2:4]
        assert np.abs(moving - solution.frame_velocity).max() < 1e-9 * speed


def test_long_numbers_are_judged_as_such():
    """A solution in quadruple precision has its own error, and the proof uses more digits."""
    pytest.importorskip("heyoka")
    solution = gt.solve(gt.ODE.of({"x": "v", "v": "-x"}, [1, 0]), 3.0, 1e-25, gt.Taylor(113))
    proof = gt.prove(solution)
    assert proof.holds
    assert proof.error < 1e-24


@needs_heyoka
def test_a_motion_without_rates_stays():
    """An equilibrium at zero or elsewhere is not reported as wrong."""
    for start in ([0, 0], [math.pi, 0]):
        proof = gt.prove(gt.solve(gt.ODE.of({"x": "v", "v": "-sin(x)"}, start), 5.0))
        assert proof.holds is not False


def test_motions_up_to_an_edge_are_proved():
    """A motion that left its chart is proved at the times that it reached."""
    r, phi = sp.symbols("r phi", real=True)
    frame = gt.Frame([r, phi], [[1, 0], [0, r]], domain=[r > 0])
    problem = gt.geodesic(frame, [1.0, 0.0], [-1.0, 0.0])
    with pytest.raises(gt.errors.ChartEdgeError) as caught:
        gt.solve(problem, np.linspace(0, 2, 8))
    proof = gt.prove(caught.value.solution)
    assert proof.holds
    assert len(proof.balls) == len(caught.value.solution.times)


def test_a_zero_is_not_decided_by_a_ball_around_it():
    """Velocities that are zero in the result are not reported as wrong."""
    so3 = gt.spaces.load("so3").frame
    rest = gt.geodesic(so3, [0.3, 1.0, 0.2], frame_velocity=[0, 0, 0], metric=[1, 2, 3])
    proof = gt.prove(gt.solve(rest, 10.0))
    assert all(x.contains(0) for x in proof.balls[-1][4:7])
    assert proof.holds is None


def test_a_length_of_one_is_made_so():
    """A quaternion not quite of length one starts normalised, as in the library."""
    rates = {"a": "-b", "b": "a"}
    problem = gt.ODE.of(rates, [0.6, 0.8 + 1e-9], normalized=[["a", "b"]])
    proof = gt.prove(gt.solve(problem, 10.0))
    assert proof.holds
    with ball_precision(120):
        a, b = proof.balls[-1]
        assert (a * a + b * b).contains(1)


def test_a_wrong_chart_map_would_be_seen(monkeypatch):
    """A map off by 1e-9 gives balls that do not contain the result."""
    from geomtorsion.proofs import charts

    s2 = gt.spaces.load("s2").frame
    solution = gt.solve(gt.geodesic(s2, [1.0, 0.0], [-1.0, 0.01], parameters={"R": 1}), 3.0)
    assert len(set(solution.charts)) == 2
    assert gt.prove(solution).holds
    plain = charts.SetMap.__call__

    def moved(self, whole, parameters):
        found = plain(self, whole, parameters)
        middle = (found.middle[0] + arb(2) ** -30, *found.middle[1:])
        return charts.LohnerSet(middle, found.axes, found.spread)

    monkeypatch.setattr(charts.SetMap, "__call__", moved)
    assert gt.prove(solution).holds is False


@pytest.mark.parametrize(
    "engine",
    [pytest.param(None, marks=needs_heyoka), gt.RungeKutta()],
    ids=["default", "Runge-Kutta"],
)
def test_a_proof_sees_what_no_step_saw(engine):
    """A bump much narrower than a step: the reported error is too small, and the proof finds it."""
    problem = gt.ODE.of({"x": "1 + exp(-(500*(y - 20.2))**2)", "y": 1}, {"x": 0, "y": 0.3})
    solution = gt.solve(problem, 60.0, 1e-9, engine)
    assert solution["x"][-1] == pytest.approx(60, abs=1e-9)
    proof = gt.prove(solution)
    assert proof.holds is False
    assert float(proof.error) == pytest.approx(math.sqrt(math.pi) / 500 / 60, rel=0.1)


@pytest.mark.parametrize("steep", few(1, [100, 1000]))
def test_a_wall_between_two_samples_is_right_or_refused(steep):
    """x' = 2 + tanh(k x) from far before the wall: every returned answer is proved."""
    for begin in (-20.3, -33.1):
        problem = gt.ODE.of({"x": "2 + tanh(k*x)"}, [begin], parameters={"k": steep})
        try:
            solution = gt.solve(problem, 60.0, 1e-9)
        except gt.errors.AccuracyError:
            continue
        assert gt.prove(solution).holds is True

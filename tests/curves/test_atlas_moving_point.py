"""Moving points: points and answers carried between charts keep all reported digits."""

from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import geodesic
from geomtorsion.curves.atlas import Chart, MovingPoint, atlas_of
from geomtorsion.geometry import Frame
from geomtorsion.ode import ODE, Taylor, solve
from geomtorsion.spaces import load
from tests.ode.engines import needs_heyoka
from tests.rounding import ROUNDED

R, PHI = sp.symbols("r phi", positive=True)
POLAR = Frame([R, PHI], [[1, 0], [0, R]], name="polar")
START, VELOCITY = [Fraction(1, 3), Fraction(1, 7)], [Fraction(1, 7), Fraction(2, 11)]


def straight(time):
    """Polar coordinates and velocities of the straight line through START, at any precision."""
    r, phi, dr, dphi = (mpmath.mpf(x.numerator) / x.denominator for x in (*START, *VELOCITY))
    turn = mpmath.expj(phi)
    place, speed = r * turn, (dr + 1j * r * dphi) * turn
    place += speed * time
    along = mpmath.conj(place) * speed / abs(place) ** 2
    velocity = abs(place) * along.real, along.imag
    frame_velocity = velocity[0], abs(place) * velocity[1]
    return {
        "coordinates": (abs(place), mpmath.arg(place)),
        "velocity": velocity,
        "frame_velocity": frame_velocity,
    }


def digits(value):
    """All digits of a number of any engine."""
    return mpmath.mpf(str(value))


@needs_heyoka
@pytest.mark.parametrize("accuracy", [1e-17, 1e-25, 1e-40, 1e-60])
def test_a_velocity_of_fractions(accuracy):
    """Coordinates and both velocities have the reported error, in numbers of one type."""
    found = solve(geodesic(POLAR, START, VELOCITY), 1.0, accuracy)
    assert found.error <= accuracy
    with mpmath.workdps(100):
        for name, truth in straight(1).items():
            values = found[name][-1]
            assert values.dtype == found.coordinates.dtype != np.float64
            size = max(map(abs, truth))
            for value, wanted in zip(values, truth, strict=True):
                assert abs(digits(value) - wanted) <= found.error * 2 * size


@needs_heyoka
def test_results_have_floats_or_digits_as_requested():
    """An accuracy of doubles returns doubles with an error of at least one rounding."""
    found = solve(geodesic(POLAR, START, VELOCITY), 1.0, 1e-15, Taylor(113))
    assert found.coordinates.dtype == found.velocity.dtype == np.float64
    assert 2.0**-53 <= found.error <= 1e-15
    np.testing.assert_allclose(
        found.coordinates[-1], [float(x) for x in straight(1)["coordinates"]], rtol=ROUNDED
    )


@needs_heyoka
@pytest.mark.parametrize("accuracy", [1e-17, 1e-25, 1e-40])
def test_numpy_functions_work_on_long_numbers(accuracy):
    """NumPy functions keep the digits of numbers from an engine or another chart."""
    found = solve(geodesic(POLAR, START, VELOCITY), 1.0, accuracy)
    r, phi = found["r"], found["phi"]
    east = (r * np.cos(phi)).astype(float)
    assert np.ptp(np.diff(east)) < ROUNDED
    assert np.isfinite(r).all()
    assert (np.sqrt(r * r) - r).astype(float).max() < 1e-17


@needs_heyoka
def test_an_engine_with_too_few_bits_names_its_precision():
    """An accuracy beyond the bits of an engine raises an AccuracyError."""
    with pytest.raises(Exception, match=r"Taylor\(113\) gets to") as found:
        solve(geodesic(POLAR, START, VELOCITY), 1.0, 1e-40, Taylor(113))
    assert type(found.value).__name__ == "AccuracyError"


@needs_heyoka
def test_outputs_of_equations_have_all_digits():
    """Outputs and states agree with mpmath to 30 digits."""
    swing = ODE.of(
        {"x": "v", "v": "-k*x"},
        {"x": Fraction(1, 3), "v": 0},
        parameters={"k": 1},
        outputs={"energy": "(v**2 + k*x**2)/2", "both": ["sin(x)", "x/3"]},
    )
    found = solve(swing, 2.0, 1e-30)
    with mpmath.workdps(60):
        x = mpmath.cos(2) / 3
        assert abs(digits(found["x"][-1]) - x) < 1e-30
        assert abs(digits(found["energy"][-1]) - mpmath.mpf(1) / 18) < 1e-30
        assert abs(digits(found["both"][-1][0]) - mpmath.sin(x)) < 1e-30
        assert abs(digits(found["both"][-1][1]) - x / 3) < 1e-30


@needs_heyoka
def test_states_of_length_one_have_all_digits():
    """A rotating unit vector keeps length one to the last of its digits."""
    turn = ODE.of(
        {"a": "-b", "b": "a"}, {"a": Fraction(3, 5), "b": Fraction(4, 5)}, normalized=[["a", "b"]]
    )
    found = solve(turn, 1.0, 1e-30)
    with mpmath.workdps(60):
        a, b = (digits(found[name][-1]) for name in "ab")
        assert abs(a**2 + b**2 - 1) < 1e-32
        assert abs(a - (3 * mpmath.cos(1) - 4 * mpmath.sin(1)) / 5) < 1e-30


@pytest.mark.parametrize("space", ["so3", "s3", "r3xso3"])
def test_a_chart_without_an_edge_is_begun_in(space):
    """A motion begins in the chart of the unit quaternion, which has no edge."""
    start = [0.5, 1.2, 0.3, 0, 0, 0][: load(space).frame.dimension]
    problem = geodesic(load(space).frame, start, frame_velocity=[0.3] * len(start))
    assert problem.first_stage(53, 0.0).label == "quaternion"


def test_numbers_that_a_law_brings_are_perturbed_with_the_start():
    """(B - C)/A of a top is rounded and perturbed in each chart; a radius given as float is not."""
    ball = load("s2").frame
    there = geodesic(ball, [1.2, 0.3], frame_velocity=[1, 2], parameters={"R": 1.5})
    top = geodesic(load("s3").frame, [0.5, 1.2, 0.3], frame_velocity=[1, 2, 3], metric=[1.1, 2, 4])
    for problem, part in ((there, 0.0), (top, 1e-9)):
        exact, other = (problem.first_stage(64, part).parameters for part in (0.0, 1e-9))
        gaps = [abs(float(y / x) - 1) for x, y in zip(exact, other, strict=True)]
        assert max(gaps) == pytest.approx(part, rel=1e-6)


def test_states_are_perturbed_only_at_the_start():
    """The stage after a chart begins at the end of that chart, without a new perturbation."""
    problem = geodesic(load("s2").frame, [1.0, 0.3], frame_velocity=[-1, 0.5], parameters={"R": 1})
    after = []
    for part in (0.0, 1e-3):
        event = problem.first_stage(53, part).boundary
        assert event is not None
        assert event.then is not None
        after.append(event.then(1.0, np.array([0.1, 0.4, -1.0, 0.5])))
    assert [stage.label for stage in after] == ["s2_x", "s2_x"]
    assert after[0].first.tolist() == after[1].first.tolist()


@pytest.mark.parametrize(("theta", "label"), [(0.86, "s2"), (0.83, "s2_x")])
def test_how_far_from_its_edge_a_chart_is_begun_in(theta, label):
    """A start uses its own chart down to three margins, sin(theta) = 3/4; nearer, another one."""
    start = [theta, np.pi / 2]
    problem = geodesic(load("s2").frame, start, frame_velocity=[0.3, 0.4], parameters={"R": 1})
    assert problem.first_stage(53, 0.0).label == label


def test_far_from_its_edge_the_first_chart_needs_no_other():
    """The three other charts of Kerr are not made, but the motion begins as with all of them."""
    problem = geodesic(
        load("kerr").frame, [0, 8, 1.4, 0], frame_velocity=[1.2, 0.05, 0.2, 0.36],
        parameters={"M": 1, "a": 0.6}, causal=None,
    )  # fmt: skip

    def refuse() -> Chart:
        raise AssertionError

    atlas = problem.atlas
    makers = {name: make if name == "kerr" else refuse for name, make in atlas.makers.items()}
    alone = replace(problem, atlas=replace(atlas, makers=makers, origin=None))
    assert alone.charts == problem.charts
    assert alone.first_stage(53, 0.0).label == problem.first_stage(53, 0.0).label == "kerr"


@pytest.mark.parametrize(("distance", "found"), [(1.45, None), (1.55, "s2_x")])
def test_another_chart_must_reach_farther(distance, found):
    """Another chart must be 1.5 margins farther from its edge, so that motions do not alternate."""
    theta = float(np.arccos(distance / 4))
    problem = geodesic(load("s2").frame, [theta, 0], frame_velocity=[0.3, 0.4], parameters={"R": 1})
    point = MovingPoint([theta, 0.0], [0.3, 0.4], [])
    assert problem.atlas.best_chart(problem.charts, "s2", point, problem.parameters, 53) == found


@pytest.mark.parametrize("space", ["schwarzschild", "so3"])
def test_many_points_are_carried_as_each_of_them(space):
    """Arrays of points give in doubles what each point gives in 113 bits, in every chart."""
    frame = load(space).frame
    atlas, numbers = atlas_of(frame), {"M": 1.0} if space == "schwarzschild" else {}
    random = np.random.default_rng(5)
    q = np.array([[0.0], [8.0], [1.2], [0.3]] if numbers else [[0.3], [1.0], [0.2]])
    q = q + 0.1 * random.random((len(q), 7))
    u = random.normal(size=q.shape)
    targets = [name for name in atlas.names if name != atlas.home]
    assert targets
    for target in targets:
        many = atlas.moved(atlas.home, target, MovingPoint(q, u, []), numbers, 53)
        for k in range(q.shape[1]):
            point = MovingPoint(q[:, k].tolist(), u[:, k].tolist(), [])
            one = atlas.moved(atlas.home, target, point, numbers, 113)
            for got, wanted in zip(many, one, strict=True):
                column = [float(x) for x in np.asarray(got)[:, k]] if len(got) else []
                assert column == pytest.approx([float(x) for x in wanted], rel=1e-13, abs=1e-13)

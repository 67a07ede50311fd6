"""Burgers vectors: closed forms, laws of loops, routes and their choice, and bad input."""

import json
import math

import mpmath
import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad

from geomtorsion.errors import (
    CoordinateError,
    LoopError,
    MissingValueError,
    SingularPointError,
    UnknownNameError,
)
from geomtorsion.geometry import Frame, cartan
from geomtorsion.loops import (
    Loop,
    burgers_vector,
)
from geomtorsion.spaces import load, names
from tests.rounding import rounded

SAME = 1e-12  # the requested accuracy

x, y, z = sp.symbols("x y z", real=True)
k = sp.Symbol("k", positive=True)


@pytest.fixture(scope="module")
def so3() -> Frame:
    return load("so3").frame


@pytest.fixture(scope="module")
def heisenberg() -> Frame:
    """e3 = dz + (k/2)(x dy - y dx)."""
    return Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-k * y / 2, k * x / 2, 1]], parameters=[k])


def exponential_frame() -> Frame:
    """so3 in exponential coordinates, left-invariant."""
    w = sp.sqrt(x**2 + y**2 + z**2)
    turn = sp.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    coframe = sp.eye(3) - (1 - sp.cos(w)) / w**2 * turn + (w - sp.sin(w)) / w**3 * turn * turn
    return Frame([x, y, z], coframe.tolist(), name="so3, exponential coordinates")


@pytest.mark.parametrize(
    "loop",
    [
        Loop.circle([0, 0, 0], 1),
        Loop.circle([0.3, 0.1, 7], 2),
        Loop.circle([0, 0, 0], 1e-9),
        Loop.polygon([[1, 1, 0], [-1, 1, 3], [-1, -1, 1], [1, -1, 0]]),
        Loop.spline([[1, 0, 0], [0, 2, 1], [-1, 0, 0], [0, -1, 0]]),
        Loop.ellipse([0, 0.5, 0], (3, 1)),
    ],
    ids=lambda loop: loop.name,
)
def test_screw_has_b_for_every_turn(loop: Loop) -> None:
    """Any loop around the axis gives b e3, and the result states that a encloses a defect."""
    frame = load("screw_dislocation").frame
    for turns in (1, -2, 3):
        b = burgers_vector(frame, loop.times(turns), parameters={"b": 0.7})
        assert b.vector == pytest.approx([0, 0, 0.7 * turns], abs=SAME)
        assert b.route == "line"
        assert b.check.agrees is False
        assert "encloses a defect" in b.reason
        assert b.check.difference == pytest.approx(b.vector)


def test_no_turn_no_burgers_vector() -> None:
    """A loop beside the axis has exactly b = 0, because the torsion vanishes identically."""
    frame = load("screw_dislocation").frame
    b = burgers_vector(frame, Loop.circle([3, 0, 0], 1), parameters={"b": 1})
    assert b.vector.tolist() == [0, 0, 0]
    assert b.error == 0
    assert b.reached
    assert b.vanishes
    assert b.check.agrees


@pytest.mark.parametrize("name", ["edge_dislocation", "edge_dislocation_elastic"])
def test_edge_has_b_along_x(name: str) -> None:
    """Stress does not change the Burgers vector: both edge dislocations have b along x."""
    values = {"b": 0.25} if name == "edge_dislocation" else {"b": 0.25, "nu": 0.3}
    square = Loop.polygon([[1, -1, 0], [1, 1, 0], [-1, 1, 0], [-1, -1, 0]])
    b = burgers_vector(load(name).frame, square, parameters=values)
    assert b.vector == pytest.approx([0.25, 0, 0], abs=SAME)
    assert b.screw([0, 0, 1]) == pytest.approx([0, 0, 0], abs=SAME)
    assert b.edge([0, 0, 1]) == pytest.approx([0.25, 0, 0], abs=SAME)


def test_parallel_screws_add_with_their_winding() -> None:
    """The vector is the sum over the screws of winding number times strength."""
    axes, strengths = [(0, 0), (2, 0), (0, 3)], [1, -2, 5]
    terms = [
        sp.Rational(s) / (2 * sp.pi * ((x - p) ** 2 + (y - q) ** 2))
        for (p, q), s in zip(axes, strengths, strict=True)
    ]
    third = [
        sum(-f * (y - q) for f, (_, q) in zip(terms, axes, strict=True)),
        sum(f * (x - p) for f, (p, _) in zip(terms, axes, strict=True)),
        1,
    ]
    frame = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], third])
    curve = Loop.parametric(
        ["1 + 2*cos(s) + cos(2*s)/2", "5/2*sin(s) + sin(2*s)/2", "sin(s)"], interval=(0, "2*pi")
    )
    expected = sum(curve.winding([p, q, 0]) * s for (p, q), s in zip(axes, strengths, strict=True))
    assert expected != 0
    b = burgers_vector(frame, curve)
    assert b.vector == pytest.approx([0, 0, expected], abs=SAME)


def test_screw_with_a_core() -> None:
    """b(r) = b r^2 / (r^2 + c^2), and line and flux agree."""
    frame = load("screw_core").frame
    for radius in (1e-6, 0.1, 1.0, 30.0):
        b = burgers_vector(
            frame, Loop.circle([0, 0, 0], radius), parameters={"b": 2, "c": sp.Rational(1, 2)}
        )
        assert b.vector[2] == pytest.approx(2 * radius**2 / (radius**2 + 0.25), rel=SAME)
    assert b.check.flux is None or b.check.agrees


@pytest.mark.parametrize(
    "loop",
    [
        Loop.circle([4, 5, 6], 2),
        Loop.polygon([[0, 0, 0], [3, 0, 1], [2, 2, 0], [1, -5, 7]]),
        Loop.parametric(["cos(s) + 2*sin(3*s)", "sin(2*s)*cos(s)", "cos(7*s)"], "s", (0, "2*pi")),
        Loop.spline([[1, 0, 0], [0, 2, 1], [-1, 0, 0], [0, -1, 0]]),
        Loop.circle([4, 5, 6], 1e-12),
        Loop.circle([0, 0, 0], 1e6),
    ],
    ids=lambda loop: f"{loop.name} {loop.size:g}",
)
def test_heisenberg_counts_the_signed_area(heisenberg: Frame, loop: Loop) -> None:
    """The vector is k times the signed area for any curve, because the torsion is constant."""
    b = burgers_vector(heisenberg, loop, parameters={k: 1.5})
    assert b.vector[2] == pytest.approx(1.5 * loop.area[0, 1], rel=SAME)
    assert abs(b.vector[:2]).max() <= max(b.error, 1e-30)


@pytest.mark.parametrize("radius", [1e-9, 0.01, 1.0, 3.0])
def test_so3_in_exponential_coordinates(radius: float) -> None:
    """Flat circle of radius R about the identity: -2 pi (1 - cos R)."""
    b = burgers_vector(exponential_frame(), Loop.circle([0, 0, 0], radius))
    expected = -4 * np.pi * np.sin(radius / 2) ** 2
    if radius > 1e-6:
        assert b.vector[2] == pytest.approx(expected, rel=1e-9)
    # Near the origin the frame itself cancels, (1 - cos w) / w^2, and the error covers that.
    assert abs(b.vector[2] - expected) <= 10 * b.error


def test_polar_frame() -> None:
    """The orthonormal polar frame: a circle about the origin gives (0, 2 pi r)."""
    frame = load("flat_polar").frame
    rectangle = Loop.polygon([[1, 0], [3, 0], [3, 2], [1, 2]])
    b = burgers_vector(frame, rectangle)
    assert b.vector == pytest.approx([0, 4], rel=SAME)
    cartesian = Frame(
        [x, y],
        [
            [x / sp.sqrt(x**2 + y**2), y / sp.sqrt(x**2 + y**2)],
            [-y / sp.sqrt(x**2 + y**2), x / sp.sqrt(x**2 + y**2)],
        ],
    )
    b = burgers_vector(cartesian, Loop.circle([0, 0], 2.5))
    assert b.vector == pytest.approx([0, 5 * np.pi], abs=rounded(5 * np.pi))


@pytest.mark.parametrize(
    "name", [name for name in names() if not name.startswith(("frw", "pp_wave"))]
)
def test_small_loops_have_twice_torsion_times_area(name: str) -> None:
    """b^i = S_{mn}^i A^{mn} for small loops, with the torsion of the shipped spaces."""
    frame = load(name).frame
    point = {s: float(v) for s, v in frame.sample_point.items()}
    centre = [point[s] for s in frame.coordinates]
    values = {s: v for s, v in point.items() if s not in frame.coordinates}
    S = cartan(frame).torsion.S.at(point)
    radius = 1e-9
    for plane in [(0, 1), (1, 0)] + [(0, 2), (1, 2)] * (frame.dimension > 2):
        loop = Loop.circle(centre, radius, plane)
        b = burgers_vector(frame, loop, parameters=values)
        expected = np.einsum("abc,ab->c", S, loop.area)
        scale = radius**2
        assert b.in_coordinates() / scale == pytest.approx(expected / scale, rel=1e-6, abs=1e-6)
        assert b.check.agrees
        assert b.reached or b.vanishes


def test_unknown_functions_are_named() -> None:
    """A space with an unknown function a(t) is refused, and the error names the function."""
    with pytest.raises(MissingValueError, match=r"unknown functions \(a\(t\)\)"):
        burgers_vector(load("frw").frame, Loop.circle([1, 0.5, 1, 0], 0.1))


def test_so3_torsion_is_minus_one(so3: Frame) -> None:
    """On SO(3) b^3 = -A for a loop of area A in the plane of the first two legs."""
    centre = [0.3, 1.0, 0.2]
    legs = so3.legs.at(dict(zip(("phi1", "phi2", "phi3"), centre, strict=True)))
    loop = Loop.ellipse(centre, (1e-7, 1e-7), (legs[:, 0].tolist(), legs[:, 1].tolist()))
    b = burgers_vector(so3, loop)
    assert b.vector == pytest.approx([0, 0, -np.pi * 1e-14], rel=1e-6, abs=1e-20)


def test_addition_reversal_and_multiples(so3: Frame) -> None:
    """Joined loops add their vectors, reversal changes the sign, and n turns give n times."""
    one = Loop.polygon([[0.3, 1, 0.2], [1.3, 1, 0.2], [1.0, 1.8, 0.5]])
    two = Loop.polygon([[0.3, 1, 0.2], [0.5, 2, 0.9], [-0.4, 1.2, 0.2]])
    b1, b2 = burgers_vector(so3, one).vector, burgers_vector(so3, two).vector
    assert burgers_vector(so3, one.then(two)).vector == pytest.approx(b1 + b2, rel=SAME)
    assert burgers_vector(so3, one.reversed()).vector == pytest.approx(-b1, rel=SAME)
    assert burgers_vector(so3, one.times(7)).vector == pytest.approx(7 * b1, rel=SAME)
    nothing = burgers_vector(so3, one.then(one.reversed()))
    assert nothing.vector == pytest.approx([0, 0, 0], abs=rounded(b1))
    assert nothing.vanishes


def test_parts_of_very_different_size(so3: Frame) -> None:
    """A tiny loop after a large one adds its share, to the last digits of the large one."""
    big = Loop.polygon([[1.3, 1, 0.2], [1.3, 2, 0.2], [0.3, 1, 0.2]])
    tiny = Loop.polygon([[0, 0, 0], [1, 0, 0], [0, 1, 0]], centre=[1.3, 1, 0.2], size=1e-7)
    both = burgers_vector(so3, big.then(tiny))
    sums = burgers_vector(so3, big).vector + burgers_vector(so3, tiny).vector
    assert both.vector == pytest.approx(sums, abs=rounded(sums))


def test_the_speed_along_a_loop_does_not_matter(so3: Frame) -> None:
    """Reparametrisation of a loop does not change its vector."""
    plain = Loop.parametric(["3/10 + cos(s)/5", "1 + sin(s)/5", "1/5"], interval=(0, "2*pi"))
    uneven = Loop.parametric(
        ["3/10 + cos(s + sin(s)/2)/5", "1 + sin(s + sin(s)/2)/5", "1/5"], interval=(0, "2*pi")
    )
    circle = Loop.circle([0.3, 1, 0.2], 0.2)
    expected = burgers_vector(so3, circle).vector
    for loop in (plain, uneven):
        assert burgers_vector(so3, loop).vector == pytest.approx(expected, rel=SAME)


def test_the_flux_counts_for_tiny_loops(so3: Frame) -> None:
    """For a tiny loop the result uses the flux and states the reason."""
    tiny = burgers_vector(so3, Loop.circle([0.3, 1, 0.2], 1e-9))
    assert tiny.route == "flux"
    assert "so small" in tiny.reason
    assert tiny.check.agrees
    assert tiny.check.line_error > 1e6 * tiny.error
    assert abs(tiny.check.difference).max() <= tiny.check.line_error  # type: ignore[arg-type]
    assert 0 < tiny.evaluations < 1000
    assert tiny.seconds > 0


def test_smaller_than_all_doubles(so3: Frame) -> None:
    """b of a loop of radius 1e-300 is about 1e-600, which mpmath numbers hold."""
    b = burgers_vector(so3, Loop.circle([0.3, 1, 0.2], 1e-300))
    assert b.vector.tolist() == [0, 0, 0]
    assert b.relative_error < 1e-14
    b1 = burgers_vector(so3, Loop.circle([0.3, 1, 0.2], 1e-9))
    ratio = b.numbers[0] / mpmath.mpf(b1.vector[0])
    # At radius 1e-9 the ratio differs from its limit by less than 1e-12.
    assert float(ratio * mpmath.mpf(10) ** 582) == pytest.approx(1, rel=1e-12)


def test_magnitude_parts_and_coordinates(so3: Frame) -> None:
    """Screw and edge part are orthogonal and add up; the legs convert to coordinates."""
    b = burgers_vector(so3, Loop.circle([0.3, 1, 0.2], 0.1, (1, 2)))
    direction = [1, 2, -1]
    screw, edge = b.screw(direction), b.edge(direction)
    assert screw + edge == pytest.approx(b.vector)
    assert screw @ edge == pytest.approx(0, abs=1e-18)
    assert b.magnitude == pytest.approx(np.linalg.norm(b.vector))
    point = {"phi1": 0.3, "phi2": 1.0, "phi3": 0.2}
    assert so3.coframe.at(point) @ b.in_coordinates() == pytest.approx(b.vector)
    other = b.in_coordinates([0.4, 1.1, 0.2])
    assert abs(other - b.in_coordinates()).max() > 1e-3
    with pytest.raises(LoopError, match="direction: expected 3 coordinates"):
        b.screw([1, 2])
    with pytest.raises(LoopError, match="no length"):
        b.screw([0, 0, 0])


def test_signature_counts_in_the_magnitude() -> None:
    """A time-like and a space-like component of equal size give length zero."""
    t, r = sp.symbols("t r", real=True)
    frame = Frame([t, r], [[1, t], [t, 1 - t]], signature=(-1, 1))
    b = burgers_vector(frame, Loop.polygon([[0, 0], [1, 0], [1, 1], [0, 1]]))
    assert b.vector == pytest.approx([1, -1], rel=SAME)
    assert b.magnitude == pytest.approx(0, abs=1e-7)


def test_complex_frames() -> None:
    """Null tetrads have complex Burgers vectors; conjugate legs have conjugate components."""
    frame = load("kerr_kinnersley").frame
    point = frame.sample_point
    centre = [float(point[s]) for s in frame.coordinates]
    values = {s: float(v) for s, v in point.items() if s not in frame.coordinates}
    b = burgers_vector(frame, Loop.circle(centre, 0.01, (1, 2)), parameters=values)
    assert b.vector.dtype == complex
    assert b.vector[2] == pytest.approx(np.conj(b.vector[3]))
    assert b.check.agrees
    assert json.dumps(b.to_json())


def test_plain_data(so3: Frame) -> None:
    """to_json gives plain data, as the command prints it."""
    data = json.loads(json.dumps(burgers_vector(so3, Loop.circle([0.3, 1, 0.2], 0.1)).to_json()))
    assert data["check"]["agrees"] is True
    assert data["reached"] is True
    assert len(data["vector"]) == 3


def test_parameters_are_checked() -> None:
    """Missing, unknown and bad parameters are named in the error."""
    frame, loop = load("screw_dislocation").frame, Loop.circle([0, 0, 0], 1)
    with pytest.raises(MissingValueError, match=r"got none. Give parameters=\{'b'"):
        burgers_vector(frame, loop)
    with pytest.raises(UnknownNameError, match="expected a parameter of this frame, got 'c'"):
        burgers_vector(frame, loop, parameters={"b": 1, "c": 2})
    with pytest.raises(LoopError, match="parameter b: expected a finite number"):
        burgers_vector(frame, loop, parameters={"b": float("nan")})
    with pytest.raises(LoopError, match="parameter b: expected a number"):
        burgers_vector(frame, loop, parameters={"b": "much"})


def test_other_bad_input(so3: Frame) -> None:
    """A loop of another dimension and a bad accuracy are refused."""
    with pytest.raises(LoopError, match="the loop has 2 coordinates, the frame 3"):
        burgers_vector(so3, Loop.circle([0, 0], 1))
    for accuracy in (0, -1, 2, float("nan")):
        with pytest.raises(LoopError, match="accuracy: expected a relative error"):
            burgers_vector(so3, Loop.circle([0, 0, 0], 1), accuracy)
    line = Frame([x], [[1]])
    with pytest.raises(LoopError, match="frame 1"):
        burgers_vector(line, Loop.circle([0, 0], 1))


@pytest.mark.parametrize(
    "loop",
    [
        Loop.polygon([[1, 0, 0], [-1, 0, 0], [1, -1, 0]]),
        Loop.polygon([[1, 1, 0], [-2, -2, 0], [1, -1, 0]]),
        Loop.circle([1, 0, 0], 1),
        Loop.circle([1e-9, 0, 0], 1e-9),
        Loop.polygon([[0, 0, 0], [1, 0, 0], [0, 1, 0]]),
    ],
    ids=["along", "across", "circle", "tiny circle", "corner"],
)
def test_a_loop_through_the_defect_is_refused(loop: Loop) -> None:
    """The error names the point, also if no node of a quadrature rule meets it."""
    with pytest.raises(
        SingularPointError, match=r"passes through .* where x\*\*2 \+ y\*\*2 vanish"
    ):
        burgers_vector(load("screw_dislocation").frame, loop, parameters={"b": 1})


def test_values_of_a_loop_against_declarations():
    """A value against the assumptions of a symbol that only the loop contains is refused."""
    r = sp.Symbol("r", negative=True)
    loop = Loop.circle([1, 0], -r)
    with pytest.raises(
        CoordinateError,
        match="r: expected a value that is negative, nonpositive, as declared, got 2",
    ):
        loop.at({"r": 2})
    assert loop.at({"r": -2}).area[0, 1] == pytest.approx(4 * np.pi)


def gaussian(width: float, height: str) -> float:
    """Closed integral of exp(-(width (x - 1/7))^2) (1 + y) dx around the unit square or circle."""
    rim = {"square": lambda x: 1.0, "circle": lambda x: math.sqrt(1 - x * x)}[height]
    return -2 / width * quad(lambda u: rim(1 / 7 + u / width) * math.exp(-u * u), -9, 9)[0]


@pytest.mark.parametrize("width", [100, 1000, 10**6])
@pytest.mark.parametrize("height", ["square", "circle"])
def test_a_narrow_peak_is_found(width, height):
    """All points of the first rule miss a Gauss function of such a width."""
    frame = Frame("x y", [["1", "0"], [f"exp(-({width}*(x - 1/7))^2)*(1 + y)", "1"]])
    square = Loop.polygon([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    loop = square if height == "square" else Loop.circle([0, 0], 1)
    found = burgers_vector(frame, loop)
    truth = gaussian(width, height)
    assert abs(found.vector[1] - truth) <= found.error + 1e-9 * abs(truth)
    assert found.error < 1e-4 * abs(truth)


@pytest.mark.parametrize("width", [100, 10**4])
def test_a_steep_step_has_an_error(width):
    """tanh at arguments at which sinh and cosh overflow: b = -4, with an error that is a number."""
    frame = Frame("x y", [["1", "0"], [f"tanh({width}*(y - 1/7))", "1"]])
    found = burgers_vector(frame, Loop.polygon([[-1, -1], [1, -1], [1, 1], [-1, 1]]))
    assert abs(found.vector[1] + 4) <= found.error < 1e-12


def test_a_narrow_peak_of_a_complex_frame_is_found():
    """The peak in a complex leg, beside a complex denominator: b is i times the real one."""
    square = Loop.polygon([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    peak = sp.exp(-((1000 * (x - sp.Rational(1, 7))) ** 2)) * (1 + y)
    frame = Frame([x, y], [[1, 1 / (x + 2 * sp.I)], [sp.I * peak, 1]], complex=True)
    found = burgers_vector(frame, square)
    assert abs(found.vector[1] - 1j * gaussian(1000, "square")) <= found.error + 1e-12

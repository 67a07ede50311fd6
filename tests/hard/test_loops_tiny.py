"""Tiny loops: full relative accuracy at every radius, against 50 digits, and errors that hold."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop, burgers_vector
from geomtorsion.spaces import load
from tests.loops.reference import reference
from tests.rounding import ROUNDED

# Promise of the library, accuracy for shipped spaces, and factor by which its own estimate may be
# too small.
PROMISED = 1e-12
REACHED = ROUNDED
HONEST = 10

PLACES = {
    "so3": ([0.3, 1.0, 0.2], {}),
    "r3xso3": ([0.3, 1.0, 0.2, 0.4, -0.5, 0.6], {}),
    "s2": ([1.0, 0.2], {"R": 1.5}),
    "twisted_bar": ([0.3, 1.0, 0.2], {"kappa": 0.7}),
}
PLANES = [
    (name, (a, b))
    for name, (centre, _) in PLACES.items()
    for a in range(len(centre))
    for b in range(a + 1, len(centre))
]
RADII = [10.0**-decade for decade in range(1, 13)]


def truth(
    frame: Frame, centre: list[float], radius: float, plane: tuple[int, int], values: dict
) -> list:
    """b / radius at 70 digits by the trapezoid rule, directly from the coframe."""
    coordinates = list(frame.coordinates)
    names = [symbol for symbol in frame.field.symbols if symbol.name in values]
    matrix = frame.coframe.to_sympy()
    entries = [[matrix[i, mu] for mu in plane] for i in range(frame.dimension)]
    function = sp.lambdify([*coordinates, *names], entries, "mpmath")
    numbers = [mpmath.mpf(values[symbol.name]) for symbol in names]
    total = [mpmath.mpf(0)] * frame.dimension
    count = 32
    for k in range(count):
        angle = 2 * mpmath.pi * k / count
        point = [mpmath.mpf(q) for q in centre]
        point[plane[0]] += mpmath.mpf(radius) * mpmath.cos(angle)
        point[plane[1]] += mpmath.mpf(radius) * mpmath.sin(angle)
        rows = function(*point, *numbers)
        for i, (first, second) in enumerate(rows):
            total[i] += second * mpmath.cos(angle) - first * mpmath.sin(angle)
    return [x * 2 * mpmath.pi / count for x in total]


@pytest.mark.parametrize(
    "radii", [RADII[::4] + RADII[-1:], pytest.param(RADII, marks=pytest.mark.slow)], ids=len
)
@pytest.mark.parametrize(("name", "plane"), PLANES)
def test_every_radius_and_every_plane(
    name: str, plane: tuple[int, int], radii: list[float]
) -> None:
    """Radii from 1e-1 to 1e-12: relative error below 1e-14, and never ten times the estimate."""
    centre, values = PLACES[name]
    frame = load(name).frame
    with mpmath.workdps(70):
        for radius in radii:
            b = burgers_vector(frame, Loop.circle(centre, radius, plane), parameters=values)
            exact = [x * mpmath.mpf(radius) for x in truth(frame, centre, radius, plane, values)]
            largest = max(map(abs, exact))
            pairs = zip(b.vector.tolist(), exact, strict=True)
            error = max(abs(mpmath.mpf(x) - y) for x, y in pairs)
            if largest < mpmath.mpf(10) ** -60:
                assert b.vanishes
                assert error <= max(b.error, largest)
                continue
            assert error <= REACHED * largest, (radius, b)
            assert error <= HONEST * b.error, (radius, b, b.check)
            assert b.reached
            assert b.check.agrees


@pytest.mark.parametrize("radius", [1e-20, 1e-100, 1e-160, 1e-300])
def test_far_below_all_doubles(radius: float) -> None:
    """Where b underflows, its mpmath numbers are right to the last digit of a double."""
    frame = load("so3").frame
    b = burgers_vector(frame, Loop.circle([0.3, 1, 0.2], radius))
    with mpmath.workdps(30):
        length = mpmath.pi * mpmath.mpf(radius) ** 2
        exact = (length * mpmath.cos(mpmath.mpf(0.3)), -length * mpmath.sin(mpmath.mpf(0.3)))
        for one, two in zip(b.numbers, exact, strict=False):
            assert abs(one - two) <= ROUNDED * abs(two)


def test_torsion_much_smaller_than_the_gradient() -> None:
    """Torsion of 1e-8 under a gradient of order one: the exact curl contains no gradient."""
    x, y = sp.symbols("x y", real=True)
    small = sp.Rational(1, 10**8)
    frame = Frame([x, y], [[1 + sp.sin(x) * y, -sp.cos(x) + small * x], [0, 1]])
    for radius in (1e-2, 1e-6, 1e-10):
        b = burgers_vector(frame, Loop.circle([0.7, 0.4], radius))
        assert b.vector[0] == pytest.approx(1e-8 * np.pi * radius**2, rel=1e-9)
        assert b.relative_error < 1e-9


def test_tiny_loops_of_other_shapes() -> None:
    """Polygons, splines, ellipses and curves of size 1e-12: b = 2 S A to eleven digits."""
    frame = load("so3").frame
    point = {"phi1": 0.3, "phi2": 1.0, "phi3": 0.2}
    centre, size = [0.3, 1.0, 0.2], 1e-12
    flat = [[1, 0.2, 0], [0, 1, 0.5], [-1, 0, 0.3], [0.1, -1, 0]]
    loops = [
        Loop.polygon(flat, centre=centre, size=size),
        Loop.spline(flat, centre=centre, size=size),
        Loop.ellipse(centre, (2 * size, size), (1, 2)),
        Loop.parametric(
            ["cos(s)", "sin(s)", "cos(3*s)/2"], "s", (0, "2*pi"), centre=centre, size=size
        ),
    ]
    S = frame.quantity("torsion").at(point)
    for loop in loops:
        area = loop.area / size**2
        expected = frame.coframe.at(point) @ np.einsum("abc,ab->c", S, area)
        b = burgers_vector(frame, loop)
        assert b.route == "flux"
        assert b.vector / size**2 == pytest.approx(expected, rel=1e-11, abs=1e-11)


x, y, z = sp.symbols("x y z", real=True)
parts = st.sampled_from(
    [x, y, z, x * y, sp.sin(x), sp.cos(2 * y), sp.exp(z), y**2 - z, 1 / (3 + x)]
)


@st.composite
def frames(draw: st.DrawFn) -> Frame:
    """Unit triangular coframes without symmetry."""
    return Frame([x, y, z], [[1, draw(parts), draw(parts)], [0, 1, draw(parts)], [0, 0, 1]])


@st.composite
def loops(draw: st.DrawFn) -> Loop:
    """Circles, triangles and curves of all sizes around points of order one."""
    centre = [draw(st.integers(-8, 8)) / 10 for _ in range(3)]
    size = 10.0 ** -draw(st.integers(0, 11))
    kind = draw(st.sampled_from(["circle", "triangle", "curve"]))
    if kind == "circle":
        plane = draw(st.sampled_from([(0, 1), (1, 2), (2, 0), ([1, 1, 0], [0, 1, 1])]))
        return Loop.circle(centre, size, plane)
    if kind == "triangle":
        return Loop.polygon([[1, 0, 0], [0, 1, 0.5], [-0.5, 0, 1]], centre=centre, size=size)
    return Loop.parametric(
        ["cos(s)", "sin(s) + cos(2*s)/2", "sin(3*s)/3"], "s", (0, "2*pi"), centre, size
    )


@settings(max_examples=12)
@given(frames(), loops())
def test_errors_hold_for_random_frames(frame: Frame, loop: Loop) -> None:
    """The estimate is never below a tenth of the true error, and the promise is kept."""
    exact = reference(frame, loop)
    b = burgers_vector(frame, loop)
    error = max(abs(mpmath.mpf(u) - v) for u, v in zip(b.vector.tolist(), exact, strict=True))
    # The reference reads 0.1 as 1/10, the loop as the nearest double.
    given_as = 4e-16 * loop.size**2
    assert error <= HONEST * b.error + given_as
    if not b.vanishes:
        assert b.relative_error < PROMISED

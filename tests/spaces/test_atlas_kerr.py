"""Charts of Kerr's space: no digits cancel near axis, horizons and a = M; closed forms inside."""

# Tests pass what users pass, wrong input included, and read values that may be missing.
# pyright: reportArgumentType=false, reportOptionalMemberAccess=false

from functools import cache
from itertools import product

import mpmath
import numpy as np
import pytest

from geomtorsion.curves import geodesic
from geomtorsion.curves.atlas import atlas_of
from geomtorsion.errors import ChartEdgeError, SingularPointError
from geomtorsion.ode import solve
from geomtorsion.spaces import load
from tests.chosen import one_in
from tests.ode.engines import ENGINES
from tests.rounding import ROUNDED

SPINS = (1e-6, 0.6, 1 - 1e-9, 1 - 2.0**-53)
RADII = (1e-3, 0.3, 1.05, 3.0, 10.0, 1e4)
BITS = 400


def places(chart, a):
    """Points near and far from axis, horizon and ring, where the chart is regular."""
    outer = 1 + np.sqrt(1 - a * a)
    if chart == "kerr":
        near = [outer + x for x in (1e-6, 1e-3, 0.3, 5.0, 1e4)]
        return [[0.7, r, theta, 0.4] for r, theta in product(near, (1e-8, 0.01, 1.5, 2.9))]
    if chart in ("ingoing", "outgoing"):
        radii = (*RADII, outer)
        return [[0.7, r, theta, 0.4] for r, theta in product(radii, (1e-8, 1e-3, 0.3, 1.5, 2.9))]
    beside = (1e-12, 1e-4, 0.3, 1.0)
    poles = [[0.6 * x, side * (1 - 0.8 * x)] for x, side in product(beside, (1, -1))]
    return [[0.7, r, *place] for r, place in product((*RADII, outer), poles)]


def exactly(change, q, numbers):
    """The map by its exact expressions, in 120 digits; None where it has no real value."""
    point = dict(zip([c.name for c in change.coordinates], q, strict=True))
    point |= {p.name: numbers[p.name] for p in change.parameters}
    shared = {}
    try:
        values = [element.evaluate(point, BITS, shared) for element in change.elements]
    except (ArithmeticError, SingularPointError):
        return None
    real = all(isinstance(x, mpmath.mpf) and abs(x) < 1e6 for x in values)
    return np.array(values, dtype=object) if real else None


def maps():
    """The maps between charts of Kerr's space, by name."""
    atlas = atlas_of(load("kerr").frame)
    every = atlas.names
    return {
        (change.source, change.target): change
        for one, other in product(every, every)
        for change in atlas.route(one, other)
    }


@pytest.mark.parametrize(("pair", "a"), one_in(4, list(maps()), SPINS))
def test_maps_lose_no_digits(pair, a):
    """In doubles each coordinate is right to 1e-13, plus the effect of rounding the point."""
    change, numbers, counted = maps()[pair], {"M": 1.0, "a": a}, 0
    for q in places(change.source, a):
        want = exactly(change, q, numbers)
        charted = pair[0] in ("ingoing", "outgoing") and pair[1] == "kerr"
        on_horizon = charted and q[1] == 1 + np.sqrt(1 - a * a)
        if want is None or on_horizon:
            continue
        beside = [exactly(change, [*q[:k], np.nextafter(q[k], 9e9), *q[k + 1 :]], numbers)
                  for k in range(4)]  # fmt: skip
        moved = sum(abs(row - want) for row in beside if row is not None)
        bound = 1e-13 * abs(want) + 4 * moved + 1e-300
        assert (abs(change(q, numbers) - want) <= bound).all(), q
        counted += 1
    assert counted >= 15


@pytest.mark.parametrize(
    ("pair", "q"),
    [
        (("kerr", "ingoing"), [0.5, 3.0, 1.0, 0.2]),
        (("ingoing", "kerr"), [0.5, 3.0, 1.0, 0.2]),
    ],
)
@pytest.mark.parametrize(("a", "beside"), [(1.0, 1 - 1e-24), (0.0, 1e-24)])
def test_maps_have_limits(pair, q, a, beside):
    """At a = M and a = 0 maps give the limits of neighbouring values, at any precision."""
    change = maps()[pair]
    with mpmath.workdps(60):
        near = 1 - mpmath.mpf(10) ** -24 if a else mpmath.mpf(10) ** -24
        want = exactly(change, q, {"M": 1.0, "a": near})
    assert change(q, {"M": 1.0, "a": a}) == pytest.approx(want.astype(float), rel=ROUNDED)
    many = change.precisely(q, {"M": 1.0, "a": a}, 200)
    assert max(abs(x - y) for x, y in zip(many, want, strict=True)) < 1e-20


@pytest.mark.parametrize(
    ("chart", "a"), one_in(6, atlas_of(load("kerr").frame).names, (0.0, *SPINS, 1.0))
)
def test_rates_lose_no_digits(chart, a):
    """Rates of a geodesic agree with 60 digits, relative to the largest of their kind."""
    u, numbers = [1.2, -0.4, 0.2, 0.36], {"M": 1.0, "a": a}
    problem = geodesic(load("kerr").frame, [0, 8, 1, 0], frame_velocity=u, parameters=numbers)
    equations, place = problem.equations(chart), problem.atlas.chart(chart)
    rates, counted = equations.system.rates.numpy(), 0
    for q in places(chart, a or 1e-300):
        values = dict(zip(equations.states, q + u, strict=True)) | numbers
        # Motions leave the charts near their edges.
        if place.distance({name: values[name] for name in place.names} | numbers) < 1:
            continue
        got = rates(*(values[name] for name in (*equations.states, *equations.parameters)))
        want, shared = [], {}
        with mpmath.workdps(60):
            for products in equations.rates:
                terms = [
                    mpmath.fprod(
                        [element.evaluate(values, 200, shared), *(values[x] for x in names)]
                    )
                    for element, names in products
                ]
                want.append(mpmath.fsum(terms))
        for group in ([0], [1], [2, 3], [4, 5, 6, 7]):
            size = max(abs(want[k]) for k in group)
            assert max(abs(got[k] - want[k]) for k in group) <= 1e-13 * size, q
        counted += 1
    assert counted >= 4


# -- motions ---------------------------------------------------------------------------------------


def kerr_schild(sol, a):
    """T = v - r and x + i y = (r + i a) sin(theta) exp(i phi_in), z = r cos(theta)."""
    v, r, theta, phi = sol.in_chart("ingoing").T
    place = (r + 1j * a) * np.sin(theta) * np.exp(1j * phi)
    return np.column_stack((v - r, place.real, place.imag, r * np.cos(theta)))


def without_momentum(r, theta, radial, polar, a):
    """A timelike geodesic with L = 0, by velocities in Carter's tetrad."""
    tilt = a * np.sin(theta) * np.sqrt(r * r - 2 * r + a * a) / (r * r + a * a)
    u0 = np.sqrt((1 + radial**2 + polar**2) / (1 - tilt**2))
    return geodesic(
        load("kerr").frame, [0, r, theta, 0], frame_velocity=[u0, radial, polar, -tilt * u0],
        parameters={"M": 1, "a": a}, causal="timelike",
    )  # fmt: skip


@cache
def finest_polar_orbit():
    """The orbit below by the default engine, used as the truth for all engines."""
    return solve(without_momentum(12.0, np.pi / 2, 0.0, 0.35, 0.6), [100.0, 300.0], 1e-13)


# In the normal run test_polar_orbit_of_kerr of the curves takes other engines over the poles.
POLAR = [pytest.param(engine, accuracy, marks=() if (engine, accuracy) == (ENGINES[-1], 1e-9)
                      else pytest.mark.slow)
         for engine, accuracy in product(ENGINES, (1e-9, 1e-12))]  # fmt: skip


@pytest.mark.parametrize(("engine", "accuracy"), POLAR)
def test_a_polar_orbit(engine, accuracy):
    """An orbit from r = 12 over both poles reaches the same point at each accuracy."""
    sol = solve(without_momentum(12.0, np.pi / 2, 0.0, 0.35, 0.6), [100.0, 300.0], accuracy, engine)
    assert set(sol.charts) == {"kerr", "axis"}
    assert sol.error <= accuracy
    assert max(sol.drift.values()) < 10 * accuracy
    places = [kerr_schild(x, 0.6) for x in (sol, finest_polar_orbit())]
    assert np.abs(places[0] - places[1]).max() < 2 * accuracy * np.abs(places[1]).max()


@pytest.mark.parametrize(
    "accuracy", [1e-7, *(pytest.param(x, marks=pytest.mark.slow) for x in (1e-9, 1e-11))]
)
def test_a_polar_plunge_names_its_end(accuracy):
    """After turning inside, it returns to the inner horizon, where ingoing v is infinite."""
    problem = without_momentum(6.0, 1.5, -0.3, 0.1, 0.9)
    with pytest.raises(ChartEdgeError, match="leaves through a horizon outwards") as caught:
        solve(problem, 40.0, accuracy)
    assert "t = 11.4585" in str(caught.value)
    assert f"r_ax = {1 - np.sqrt(0.19):.6g}"[:12] in str(caught.value)


def test_without_spin_it_is_schwarzschild():
    """a = 0: over the axis and through the horizon as in Schwarzschild's space."""
    start, velocity = [0, 6.0, 1.2, 0.3], [1.3, -0.5, -np.sqrt(0.44), 0.0]
    kerr, plain = (
        solve(
            geodesic(load(name).frame, start, frame_velocity=velocity, parameters=numbers),
            np.linspace(0.5, 9.6, 9),
            1e-11,
        )
        for name, numbers in (("kerr", {"M": 1, "a": 0}), ("schwarzschild", {"M": 1}))
    )
    one, two = kerr_schild(kerr, 0.0), plain.in_chart("kerr_schild")
    # One T contains log(r - 2 M), the other log(r / (2 M) - 1).
    one[:, 0] -= 2 * np.log(2)
    assert np.linalg.norm(two[-1, 1:]) < 1.9
    assert np.abs(one - two).max() < 1e-9


def test_an_extremal_plunge():
    """a = M, E = 1, L = a on the equator: with s^2 = 2 M r - a^2 all is closed.

    r' = -s / r, so that (s^3 / 3 + a^2 s) / (2 M^2) falls by the proper time; phi_in changes by 2 M
    / (s + M), and v' = (r^2 + a^2) / (r (r + s)).
    """
    r, a = 6.0, 1.0
    s, root = np.sqrt(2 * r - 1), r - 1
    problem = geodesic(
        load("kerr").frame, [0, r, np.pi / 2, 0.3], frame_velocity=[r / root, -s / root, 0, 0],
        parameters={"M": 1, "a": a}, causal="timelike",
    )  # fmt: skip
    last = np.array([2.5, 1.5, 1.0, 0.6, 0.2])
    times = ((s**3 - last**3) / 3 + (s - last)) / 2
    sol = solve(problem, times, 1e-11)
    assert sol.charts == ("kerr", "ingoing")
    q = sol.in_chart("ingoing")
    assert q[:, 1] == pytest.approx((last**2 + 1) / 2, rel=1e-9)
    lagging = 0.3 - 1 / root
    assert q[:, 3] == pytest.approx(lagging + 2 / (last + 1) - 2 / (s + 1), abs=1e-9)
    # dv/ds = -(r^2 + a^2) / (M (r + s)), integrated by quadrature, from v = r* at the start.
    begin = r + 2 * np.log(root) - 2 / root

    def slope(x):
        return -2 * (((x * x + 1) / 2) ** 2 + 1) / (x + 1) ** 2

    v = [begin + float(mpmath.quad(slope, [s, float(x)])) for x in last]
    assert q[:, 0] == pytest.approx(v, rel=1e-9)


def test_near_extremal_reading():
    """Kerr-Schild coordinates of the start at a = 1 - 1e-9 agree with 50 digits."""
    a, start = 1 - 1e-9, [0.0, 4.0, 1.1, 0.3]
    problem = geodesic(
        load("kerr").frame, start, frame_velocity=[1.2, 0.1, 0.2, 0.3],
        parameters={"M": 1, "a": a},
    )  # fmt: skip
    found = kerr_schild(solve(problem, [0.0, 1.0], 1e-10), a)[0]
    with mpmath.workdps(50):
        spin, r, theta, phi = map(mpmath.mpf, (a, *start[1:]))
        gap = mpmath.sqrt(1 - spin**2)
        outer, inner = 1 + gap, 1 - gap
        logs = mpmath.log(r - outer), mpmath.log(r - inner)
        height = (outer * logs[0] - inner * logs[1]) / gap
        turned = phi + spin / (2 * gap) * (logs[0] - logs[1])
        place = (r + 1j * spin) * mpmath.sin(theta) * mpmath.expjpi(turned / mpmath.pi)
        want = [height, place.real, place.imag, r * mpmath.cos(theta)]
    assert found == pytest.approx([float(x) for x in want], rel=1e-13)

"""Lagrangians of textbooks: tops, charges, relativity, time, Lorentzian frames."""

import pytest
import sympy as sp
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

import geomtorsion as gt
from geomtorsion import spaces
from tests.action.test_equations import MASS, MOMENTS, SPIN, U, equal


def test_heavy_top_by_lagranges_method():
    """Accelerations of a heavy top agree with sympy.physics.mechanics."""
    angles = dynamicsymbols("phi1 phi2 phi3")
    rates = dynamicsymbols("phi1 phi2 phi3", 1)
    frame = spaces.load("so3").frame
    plain = dict(zip(frame.coordinates, angles, strict=True))
    forms = frame.coframe.to_sympy().tomatrix().subs(plain)
    omega = forms * sp.Matrix(rates)
    weight = sp.Symbol("w")
    kinetic = sum(i * o**2 for i, o in zip(MOMENTS, omega, strict=True)) / 2
    method = LagrangesMethod(kinetic - weight * sp.cos(angles[1]), list(angles))
    method.form_lagranges_equations()
    found = gt.equations_of_motion(frame, SPIN - weight * sp.cos(frame.coordinates[1]))
    # Quasi-accelerations: d/dt (e q') with q'' from sympy, at a point to 40 digits.
    place = dict(
        zip(angles, (sp.Rational(1, 3), sp.Rational(7, 5), sp.Rational(2, 9)), strict=True)
    )
    speeds = dict(zip(rates, (sp.Rational(1, 2), sp.Rational(-3, 7), 2), strict=True))
    numbers = {MOMENTS[0]: 2, MOMENTS[1]: 3, MOMENTS[2]: sp.Rational(5, 2), weight: 7}

    def here(expression):
        return sp.N(expression.subs(numbers).subs(speeds).subs(place), 40)

    mass, forcing = here(method.mass_matrix), here(method.forcing)
    second = mass.LUsolve(forcing)
    turning = here(forms) * second + here(sum(
        (forms.diff(a) * v for a, v in zip(angles, rates, strict=True)), start=sp.zeros(3, 3)
    ) * sp.Matrix(rates))  # fmt: skip
    values = dict(zip(U[:3], here(omega), strict=True))
    values |= dict(zip(frame.coordinates, place.values(), strict=True))
    mine = [sp.N(a.subs(numbers).subs(values), 40) for a in found.accelerations]
    assert max(abs(one - two) for one, two in zip(mine, turning, strict=True)) < 1e-35
    assert max(map(abs, mine)) > 1


def test_lagrange_top_has_its_three_integrals():
    """Energy, p_phi and p_psi of a symmetric heavy top; without symmetry p_psi is not constant."""
    frame = spaces.load("so3").frame
    weight, tilt = sp.Symbol("w"), frame.coordinates[1]
    lagrangian = SPIN - weight * sp.cos(tilt)
    assert list(gt.equations_of_motion(frame, lagrangian).invariants) == [
        "energy",
        "momentum of phi3",
    ]
    symmetric = gt.equations_of_motion(frame, lagrangian.subs(MOMENTS[1], MOMENTS[0]))
    assert list(symmetric.invariants) == ["energy", "momentum of phi1", "momentum of phi3"]
    assert symmetric.invariants["momentum of phi1"] == MOMENTS[2] * U[2]


def test_charge_in_a_magnetic_field():
    """L = m u^2/2 + A_i u^i: the Lorentz force B x u for B = curl A, in polar coordinates."""
    frame = spaces.load("flat_polar").frame
    radius = frame.coordinates[0]
    field = sp.Symbol("B")
    found = gt.equations_of_motion(
        frame, MASS * (U[0] ** 2 + U[1] ** 2) / 2 + field * radius * U[1] / 2
    )
    free = gt.equations_of_motion(frame, MASS * (U[0] ** 2 + U[1] ** 2) / 2)
    lorentz = [field * U[1] / MASS, -field * U[0] / MASS]
    pairs = zip(found.accelerations, free.accelerations, strict=True)
    assert equal([one - two for one, two in pairs], lorentz)
    assert found.agrees is True


def test_relativistic_particle():
    """L = - m c sqrt(c^2 - u^2) - V(r): the momentum is gamma m u; energy is gamma m c^2 + V."""
    frame = spaces.load("flat_polar").frame
    radius, light = frame.coordinates[0], sp.Symbol("c", positive=True)
    potential = sp.Function("V")(radius)
    square = U[0] ** 2 + U[1] ** 2
    root = sp.sqrt(light**2 - square)
    found = gt.equations_of_motion(frame, -MASS * light * root - potential)
    assert found.agrees is True
    gamma = light / root
    for momentum, u in zip(found.momenta, U[:2], strict=True):
        assert sp.simplify(momentum - gamma * MASS * u) == 0
    energy = found.invariants["energy"]
    assert sp.simplify(energy - gamma * MASS * light**2 - potential) == 0


def test_time_in_the_lagrangian():
    """A pendulum with a shaking support: Mathieu's equation, and the energy is not constant."""
    angle, t = sp.Symbol("theta", real=True), sp.Symbol("t")
    length, shake = sp.Symbol("l", positive=True), sp.Function("z")(t)
    frame = gt.Frame([angle], [[1]])
    u, g = sp.symbols("u1 g")
    lagrangian = length**2 * u**2 / 2 + length * u * shake.diff(t) * sp.sin(angle)
    lagrangian += g * length * sp.cos(angle)
    found = gt.equations_of_motion(frame, lagrangian)
    expected = -(g + shake.diff(t, 2)) * sp.sin(angle) / length
    assert sp.simplify(found.accelerations[0] - expected) == 0
    assert found.agrees is True
    assert "energy" not in found.invariants


@pytest.mark.parametrize("name", ["kerr", "schwarzschild_isotropic"])
def test_lorentzian_geodesics(name):
    """L = eta_ij u^i u^j / 2 gives geodesics; if t is a coordinate, time gets another name."""
    frame = spaces.load(name).frame
    signs = [frame.eta[i, i] for i in range(4)]
    found = gt.equations_of_motion(frame, sum(s * u**2 for s, u in zip(signs, U, strict=False)) / 2)
    assert found.time.name == "time"
    assert found.agrees is True
    letters = {s.name: s for s in (*frame.coordinates, *frame.parameters, *found.velocities)}
    twist, eta = frame.anholonomy, frame.eta
    n = range(4)
    for k in n:
        right = sum(
            twist[k, j, i] * letters[f"u{j + 1}"] * eta[i, i] * letters[f"u{i + 1}"]
            for j in n
            for i in n
        )
        pair = found.hamel.bundle.frame.read(
            [("found", found.accelerations[k] * eta[k, k]), ("expected", right)]
        )
        assert pair[0] == pair[1]


def pendulum(links):
    """A chain of point masses on massless rods, angles from the vertical."""
    angles = sp.symbols(f"q1:{links + 1}", real=True)
    masses, lengths = sp.symbols(f"m1:{links + 1}"), sp.symbols(f"l1:{links + 1}")
    frame = gt.Frame(angles, sp.eye(links).tolist())
    along = across = height = energy = sp.S.Zero
    speeds = sp.symbols(f"u1:{links + 1}")
    for mass, length, angle, rate in zip(masses, lengths, angles, speeds, strict=True):
        along += length * sp.cos(angle) * rate
        across += length * sp.sin(angle) * rate
        height -= length * sp.cos(angle)
        energy += mass * (along**2 + across**2) / 2 - mass * sp.Symbol("g") * height
    return frame, energy


def numbers(expressions, place):
    """Values of expressions at a point, as floats."""
    function = sp.lambdify(list(place), list(expressions), "math", cse=True)
    return function(*place.values())


def somewhere(found):
    """A point: values for all symbols of a Lagrangian and its velocities."""
    names = sorted(found.lagrangian.free_symbols, key=str)
    return {symbol: (3 + 5 * k) / (11 + k) for k, symbol in enumerate(names)}


@pytest.mark.parametrize("links", [2, 4])
def test_chain_of_pendulums(links):
    """Accelerations solve M u' = f; for long chains they stay quotients and are still proved."""
    frame, energy = pendulum(links)
    found = gt.equations_of_motion(frame, energy)
    assert found.agrees is True
    assert list(found.invariants) == ["energy"]
    assert (found.hamel.accelerations is None) == (links == 4)
    place = somewhere(found)
    dots = sp.symbols("u1dot u2dot u3dot u4dot")[:links]
    place |= dict(zip(dots, numbers(found.accelerations, place), strict=True))
    assert max(map(abs, numbers(found.residuals, place))) < 1e-8
    assert min(abs(place[symbol]) for symbol in dots) > 1e-3


def test_a_long_chain_under_a_constraint():
    """The reaction on a fixed angle is the residue of its Euler-Lagrange equation."""
    frame, energy = pendulum(5)
    found = gt.equations_of_motion(frame, energy, constraints=["u5"])
    assert found.hamel.accelerations is None
    place = somewhere(found) | {sp.Symbol("u5"): 0}
    moved = [*numbers(found.accelerations, place), 0]
    rates = {sp.Symbol(f"q{k}dot"): place[sp.Symbol(f"u{k}")] for k in range(1, 6)}
    rates |= {sp.Symbol(f"q{k}ddot"): value for k, value in enumerate(moved, 1)}
    (expected,) = numbers([found.euler_lagrange[4]], place | rates)
    (reaction,) = numbers([found.reactions["u5"]], place)
    assert abs(reaction - expected) < 1e-9 * abs(expected)
    assert list(found.invariants) == ["energy"]

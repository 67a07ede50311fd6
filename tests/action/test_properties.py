"""Properties: over random frames both derivations agree, and invariants are constant."""

import sympy as sp
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import geomtorsion as gt
from geomtorsion.exact import Field
from tests.laws.frames import frames

U = sp.symbols("u1:5")
T = sp.Symbol("t")
MASSES = sp.symbols("m1:5", positive=True)
QUIET = settings(
    max_examples=20, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)


@st.composite
def cases(draw, *, rheonomic=True):
    """A frame with a Lagrangian: kinetic energy, coupling, linear and potential terms."""
    frame = draw(frames(largest=3))
    n, q = frame.dimension, frame.coordinates
    u = U[:n]
    lagrangian = sum(m * v**2 for m, v in zip(MASSES, u, strict=False)) / 2
    symbol, other = draw(st.sampled_from(q)), draw(st.sampled_from(q))
    lagrangian += draw(st.sampled_from([0, sp.Rational(1, 3)])) * u[0] * u[-1]
    lagrangian += draw(st.sampled_from([0, symbol**2, sp.sin(symbol)])) * u[0] ** 2
    lagrangian += draw(st.sampled_from([0, symbol, sp.cos(other)])) * u[-1]
    lagrangian -= draw(st.sampled_from([0, symbol * other, sp.exp(symbol), sp.Symbol("k") * other]))
    if rheonomic:
        lagrangian += draw(st.sampled_from([0, T * symbol, sp.sin(T) * u[0], T * u[-1] ** 2]))
    return frame, sp.sympify(lagrangian)


def pushes(draw, frame):
    """Forces that depend on coordinates, velocities, time and a parameter."""
    symbol = st.sampled_from(frame.coordinates)
    return [
        draw(st.sampled_from([0, T, U[k] ** 2, sp.Symbol("c") * U[0]])) * draw(symbol)
        for k in range(frame.dimension)
    ]


@QUIET
@given(data=st.data(), principle=st.sampled_from(["closed_in_coordinates", "closed_in_image"]))
def test_quasi_velocities_and_coordinates_agree(data, principle):
    """Boltzmann-Geodesic equals Euler-Lagrange exactly, with forces, for both right principles."""
    frame, lagrangian = data.draw(cases())
    forces = pushes(data.draw, frame)
    found = gt.equations_of_motion(frame, lagrangian, forces, principle)
    assert found.agrees is True


@QUIET
@given(cases(rheonomic=False))
def test_energy_is_kept_without_time_and_forces(case):
    """p u - L is always among the invariants, and invariants are constant also numerically."""
    frame, lagrangian = case
    found = gt.equations_of_motion(frame, lagrangian)
    assert "energy" in found.invariants
    expected = sum(U[i] * sp.diff(lagrangian, U[i]) for i in range(frame.dimension)) - lagrangian
    difference = found.invariants["energy"] - expected
    # A parameter of the Lagrangian may have been declared otherwise by the frame.
    difference = difference.xreplace({s: sp.Symbol(s.name) for s in difference.free_symbols})
    assert Field(sorted(difference.free_symbols, key=str)).read(difference).is_zero is True
    for name, value in found.invariants.items():
        assert abs(drift(found, value)) < 1e-20, name


def drift(found, value):
    """d/dt of an expression along the motion at one point, to 30 digits, by sympy only."""
    symbols = {s.name: s for s in value.free_symbols}
    change = sp.diff(value, T)
    for name, rate in found.rates.items():
        if name in symbols:
            change += sp.diff(value, symbols[name]) * rate
    free = sorted(change.free_symbols, key=str)
    place = {s: sp.Rational(3 + 2 * k, 7 + k) for k, s in enumerate(free)}
    return sp.N(change.subs(place), 30)


@QUIET
@given(data=st.data())
def test_power_of_forces_changes_the_energy(data):
    """d/dt (p u - L) = F_k u^k - dL/dt, for any forces and any L."""
    frame, lagrangian = data.draw(cases())
    forces = [sp.sympify(force) for force in pushes(data.draw, frame)]
    found = gt.equations_of_motion(frame, lagrangian, forces)
    energy = sum(p * u for p, u in zip(found.momenta, found.velocities, strict=True))
    power = sum(f * u for f, u in zip(found.forces, found.velocities, strict=True))
    entries = [energy - found.lagrangian, power - sp.diff(found.lagrangian, T)]
    left, right = found.hamel.bundle.frame.read([("value", entry) for entry in entries])
    assert (found.hamel.derivative(left) - right).is_zero is True


@QUIET
@given(data=st.data())
def test_a_constraint_takes_its_velocity_away(data):
    """With a random constraint both derivations agree, and the rates satisfy the constraint."""
    frame, lagrangian = data.draw(cases(rheonomic=False))
    n = frame.dimension
    symbol = data.draw(st.sampled_from(frame.coordinates))
    row = [data.draw(st.sampled_from([0, 1, symbol, 2])) for _ in range(n - 1)] + [1]
    constraint = sum(a * u for a, u in zip(row, U, strict=False))
    found = gt.equations_of_motion(frame, lagrangian, constraints=[constraint])
    assert found.agrees is True
    assert len(found.velocities) == n - 1
    assert "energy" in found.invariants or not found.hamel.lagrangian.symbols
    forms = frame.coframe.to_sympy()
    rates = [found.rates[q.name] for q in frame.coordinates]
    speeds = [sum(forms[i, mu] * rates[mu] for mu in range(n)) for i in range(n)]
    kept = sum(a * v for a, v in zip(row, speeds, strict=True))
    (element,) = found.hamel.bundle.frame.read([("constraint", kept)])
    assert element.is_zero is True


@QUIET
@given(frames(largest=3))
def test_variations_follow_from_the_path(frame):
    """delta-bar u^i by the chain rule over any frame; naive only if the frame is holonomic."""
    assert gt.variation(frame).proved is True
    assert gt.variation(frame, "closed_in_image").proved is True
    holonomic = frame.anholonomy.is_zero
    assert gt.variation(frame, "naive").proved is holonomic


@QUIET
@given(cases())
def test_image_of_another_connection(case):
    """Levi-Civita changes nothing; a half blend removes half of the torsion force."""
    frame, lagrangian = case
    right = gt.equations_of_motion(frame, lagrangian)
    bar = gt.levi_civita(frame)
    same = gt.equations_of_motion(frame, lagrangian, principle="closed_in_image", connection=bar)
    assert same.residuals == right.residuals
    half = gt.blend(bar, gt.cartan(frame), sp.Rational(1, 2))
    middle = gt.equations_of_motion(frame, lagrangian, principle="closed_in_image", connection=half)
    assert middle.agrees is True
    for one, two, force in zip(middle.residuals, right.residuals, right.torsion_force, strict=True):
        assert sp.simplify(one - two - force / 2) == 0

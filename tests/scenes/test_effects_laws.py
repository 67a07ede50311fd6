"""Laws that every effect obeys: energy is accounted for, in symbols and for every motion."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.scenes import Body, effects
from geomtorsion.scenes.assembly import Assembly, assemble, by_quaternion
from geomtorsion.scenes.context import ATTITUDE, QUATERNION
from geomtorsion.scenes.effects import EFFECTS
from tests.rounding import ROUNDED

E = effects
BODY = Body(mass=2.0, moments=(1.0, 1.6, 2.1))
SKEW = Body(mass=2.0, inertia=[[1.2, 0.1, -0.2], [0.1, 1.6, 0.3], [-0.2, 0.3, 2.1]])

# At least one of each kind, with every field in use.
SAMPLES = [
    E.Spin(),
    E.Drift(),
    E.Gravity(9.81),
    E.Pivot((0.3, -0.2, 0.5)),
    E.Pivot((0.1, 0.0, 0.2), place=(1, 2, 3), moments_at="pivot"),
    E.GravityGradient(rate=0.7, phase=0.2),
    E.Spring(3.0),
    E.Spring(3.0, length=0.4, anchor=(1, -2, 0.5), arm=(0.2, 0.1, -0.3)),
    E.LinearDrag(0.3, arm=(0.1, 0.2, -0.4), wind=(1, 0, 0.5)),
    E.QuadraticDrag(0.3, arm=(0.1, 0.2, -0.4), wind=(1, 0, 0.5), smoothing=0.1),
    E.AngularDamping(0.4),
    E.AngularDamping((0.4, 0.1, 0)),
    E.Thrust((1, "2*exp(-t)", "Omega1*vx"), point=(0.1, 0.2, -1), start=0.5, end=2),
    E.BodyMoment(("sin(t)", 2, "-Omega3"), end=3),
    E.Magnet((0.1, 0.2, 1.5), (0.4, 0, 2)),
    E.Magnet((0.1, 0.2, 1.5), ("cos(t)", "sin(t)", 2)),
    E.Rotor((1, 2, 2), momentum=1.7),
    E.Rotor((0, 3, 4), momentum=1.7, inertia=0.4),
    E.Rotor((0, 3, 4), momentum=1.7, inertia=0.4, torque="cos(t) - 0.2*w"),
    E.Rolling(0.3),
    E.Rolling(0.3, "ball"),
    E.KnifeEdge((0.2, -0.1, 0.4), speed=1.5),
    E.Torsion(0.7),
    E.Naive(),
    E.Custom(
        moment=("-k*a", 0, 0), force=("-2*x", 0, "t"), parameters={"k": 3}, states={"a": "Omega1"},
        start={"a": 0.2}, energy="k*a**2/2 + x**2", power="t*vz",
    ),
]  # fmt: skip


def numbers(made: Assembly, seed: int) -> dict:
    """A random state of motion, with a rotation for R."""
    rng = np.random.default_rng(seed)
    q = rng.normal(size=4)
    turned = {s: float(x) for s, x in zip(QUATERNION, q / np.linalg.norm(q), strict=True)}
    table = {s: float(x.xreplace(turned)) for s, x in by_quaternion().items()}
    own = [s for s in made.rates if s.name not in made.context.values]
    names = sorted({*own, *sp.symbols("Omega1:4 x y z vx vy vz t")}, key=str)
    table |= {s: float(x) for s, x in zip(names, rng.normal(size=len(names)), strict=True)}
    return table | turned | {sp.Symbol(k): float(v) for k, v in made.values.items()}


def value(expression, table) -> float:
    return float(sp.sympify(expression).xreplace(table))


def balance(made: Assembly, table: dict) -> tuple[float, float]:
    """Rate of the energy less the power put in, and the largest part of the rate."""
    energy = made.kinetic_energy + made.potential_energy
    slopes = [sp.diff(energy, s) * made.rate_of(s) for s in energy.free_symbols]
    parts = [value(slope, table) for slope in slopes] + [value(made.power, table)]
    return sum(parts[:-1]) - parts[-1], max(map(abs, parts))


def test_every_kind_is_sampled():
    assert {type(sample) for sample in SAMPLES} == set(EFFECTS)
    assert len({kind.key for kind in EFFECTS}) == len(EFFECTS)


@pytest.mark.parametrize(
    "body",
    [pytest.param(BODY, id="principal", marks=pytest.mark.slow), pytest.param(SKEW, id="skew")],
)
@pytest.mark.parametrize("effect", SAMPLES, ids=lambda effect: effect.key)
def test_energy_is_accounted_for(effect, body):
    """d(T + V)/dt = power for all states of motion: forces and potentials agree."""
    made = assemble(body, {effect.key: effect})
    for seed in range(3):
        lost, size = balance(made, numbers(made, seed))
        # Rounding of sums of some hundred terms.
        assert abs(lost) < 1e-12 * max(size, 1)


@pytest.mark.parametrize(
    "held",
    [
        E.Pivot((0.3, -0.2, 0.5)),
        E.Rolling(0.3),
        E.Rolling(0.3, "ball"),
        E.KnifeEdge((0.2, 0, 0)),
    ],
    ids=lambda effect: effect.key,
)
def test_energy_is_accounted_for_where_much_acts_on_a_held_body(held):
    """Gravity, a spring, drag, damping, a free rotor with friction on a constrained body."""
    acting = [
        held, E.Gravity(9.81), E.Spring(3.0, arm=(0.2, 0.1, -0.3)), E.LinearDrag(0.3),
        E.AngularDamping(0.4), E.Rotor((0, 0, 1), 1.7, inertia=0.4, torque="-0.2*w"),
    ]  # fmt: skip
    made = assemble(BODY, {effect.key: effect for effect in acting})
    for seed in range(2):
        lost, size = balance(made, numbers(made, seed))
        assert abs(lost) < 1e-11 * max(size, 1)


DISSIPATIVE = [
    E.LinearDrag(0.3, arm=(0.1, 0.2, -0.4)),
    E.QuadraticDrag(0.3, arm=(0.1, 0.2, -0.4), smoothing=0),
    E.AngularDamping(0.4),
    E.AngularDamping((0.4, 0.1, 0)),
    E.Rotor((0, 3, 4), momentum=1.7, inertia=0.4, torque="-0.2*w"),
]


@pytest.mark.parametrize("effect", DISSIPATIVE, ids=lambda effect: effect.key)
def test_dissipation_never_puts_energy_in(effect):
    made = assemble(BODY, {effect.key: effect})
    powers = [value(made.power, numbers(made, seed)) for seed in range(20)]
    assert max(powers) < 0


def test_drag_takes_force_times_speed():
    """By hand: -c w^2 at the centre of pressure, -c |w|^3, -c Omega^2."""
    arm = np.array([0.1, 0.2, -0.4])
    linear, square, damping = DISSIPATIVE[:3]
    for effect, law in (
        (linear, lambda w, _: -0.3 * w @ w),
        (square, lambda w, _: -0.3 * np.linalg.norm(w) ** 3),
        (damping, lambda _, omega: -0.4 * omega @ omega),
    ):
        made = assemble(BODY, {effect.key: effect})
        table = numbers(made, 3)
        omega = np.array([table[s] for s in sp.symbols("Omega1:4")])
        turn = np.array([[table[ATTITUDE[i, j]] for j in range(3)] for i in range(3)])
        v = np.array([table[s] for s in sp.symbols("vx vy vz")])
        w = v + turn @ np.cross(omega, arm)
        assert value(made.power, table) == pytest.approx(law(w, omega), rel=1e-12)


def test_needs_are_read_off_the_equations():
    needs = {effect.key: effect.needs() for effect in SAMPLES[::-1]}
    assert needs["spin"] == needs["drift"] == frozenset()
    assert needs["gravity"] == {"position"}
    assert needs["gravity_gradient"] == {"attitude", "time"}
    assert needs["quadratic_drag"] == {"attitude", "omega", "velocity"}
    assert needs["angular_damping"] == {"omega"}
    assert needs["thrust"] == {"attitude", "omega", "velocity", "time"}
    assert needs["torsion"] == {"attitude", "omega", "velocity"}
    assert E.Magnet((0, 0, 1), (0, 0, 1)).needs() == {"vertical"}
    assert E.LinearDrag(1).needs() == {"velocity"}


def test_constraints_hold_for_all_velocities():
    """Pivot, contact point and blade satisfy their constraints."""
    omega = sp.Matrix(sp.symbols("Omega1:4"))
    made = assemble(BODY, {"pivot": E.Pivot((0.3, -0.2, 0.5))})
    table = numbers(made, 0)
    arm = sp.Matrix([0.3, -0.2, 0.5])
    held = (made.velocity_body - omega.cross(arm)).xreplace(table)
    assert max(map(abs, held)) < ROUNDED
    for shape in ("disc", "ball"):
        made = assemble(BODY, {"rolling": E.Rolling(0.3, shape)})
        table = numbers(made, 1)
        n = np.array([table[ATTITUDE[2, k]] for k in range(3)])
        flat = np.array([n[0], n[1], 0]) / np.hypot(n[0], n[1]) if shape == "disc" else n
        spin = np.array([table[s] for s in omega])
        velocity = np.array(made.velocity_body.xreplace(table).tolist(), dtype=float).ravel()
        assert abs(velocity + np.cross(spin, -0.3 * flat)).max() < ROUNDED
    made = assemble(BODY, {"knife_edge": E.KnifeEdge((0.2, -0.1, 0.0))})
    table = numbers(made, 2)
    blade = made.velocity_body - made.omega.cross(sp.Matrix([0.2, -0.1, 0]))
    assert abs(value(blade[1], table)) < ROUNDED
    assert abs(value(blade[2], table)) < ROUNDED

"""Conserved: a scene reports exactly the quantities that it conserves."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.ode import RungeKutta
from geomtorsion.scenes import Body, Scene, State, effects, load
from geomtorsion.scenes.assembly import assemble
from geomtorsion.scenes.to_ode import is_constant

E = effects
START = State(omega=(0.1, 0.2, 3), euler=(0, 0.3, 0))
ASYMMETRIC, SYMMETRIC = Body(moments=(1, 2, 3)), Body(moments=(2, 2, 3))
SKEW = Body(inertia=[[1, 0.1, 0], [0.1, 2, 0.2], [0, 0.2, 2.5]])
TOP = (E.Gravity(), E.Pivot([0, 0, 0.1]))
ALL = ["matrix", "energy", "position", "omega"]
ROTATION = {"rotational_energy", "angular_momentum_space", "angular_momentum_squared"}


@pytest.mark.parametrize(
    ("body", "acting", "kept"),
    [
        (ASYMMETRIC, (), {"energy", "vertical_angular_momentum", *ROTATION}),
        (SKEW, (), {"energy", "vertical_angular_momentum", *ROTATION}),
        (ASYMMETRIC, (E.Gravity(),), {"energy", "vertical_angular_momentum", *ROTATION}),
        (ASYMMETRIC, TOP, {"energy", "vertical_angular_momentum"}),
        (SKEW, TOP, {"energy", "vertical_angular_momentum"}),
        (SYMMETRIC, TOP, {"energy", "vertical_angular_momentum", "axial_angular_momentum"}),
        (ASYMMETRIC, (E.AngularDamping(0.1),), set()),
        (ASYMMETRIC, (E.Spring(1.0),), {"energy", "vertical_angular_momentum", *ROTATION}),
        (SYMMETRIC, (E.Rolling(0.3), E.Gravity()), {"energy"}),
        (
            ASYMMETRIC,
            (E.BodyMoment(("0", "0", "1")),),
            set(),
        ),
        (
            ASYMMETRIC,
            (E.Thrust((0, 0, 1), start=1, end=2),),
            {*ROTATION, "vertical_angular_momentum"},
        ),
    ],
    ids=lambda value: None,
)
def test_conserved_quantities_follow_from_symmetry(body, acting, kept):
    """Noether: the symmetry of the effects gives energy, momentum and angular momenta."""
    scene = Scene(body, acting, START, ALL, t=1)
    assert set(scene.ode.invariants) == kept
    drift = scene.run(engine=None).drift
    assert set(drift) == kept
    assert max(drift.values(), default=0) < 1e-10


def test_only_what_the_states_make():
    """The energy of translation is not added, because it would need more states."""
    scene = Scene(ASYMMETRIC, (E.Gravity(),), START, ["omega"], t=1)
    assert set(scene.ode.invariants) == {"rotational_energy", "angular_momentum_squared"}


def test_a_switch_does_not_fool_the_proof():
    """Before its start a thrust is zero, and yet the energy is not an invariant."""
    scene = Scene(ASYMMETRIC, (E.Thrust((0, 0, 1), start=0.5),), START, ["energy"], t=1)
    assert "energy" not in scene.ode.invariants


def test_the_wrong_law_shows_what_it_breaks():
    """The drifts of the naive law are drifts of the right law's invariants."""
    scene = Scene(ASYMMETRIC, (E.Naive(),), START, ["matrix", "energy"], t=3)
    drift = scene.run().drift
    assert drift["angular_momentum_space"] > 0.01
    assert drift["energy"] < 1e-12


def test_close_misses_are_seen():
    """A moment changed by one part in 10^30 breaks the conservation of the axial momentum."""
    almost = Body(moments=(2, 2 + sp.Rational(1, 10**30), 3))
    momentum = sp.Symbol("Omega3")
    assert is_constant(assemble(SYMMETRIC, {}), momentum)
    assert not is_constant(assemble(almost, {}), momentum)
    free = assemble(SYMMETRIC, {})
    near = free.kinetic_energy + sp.Rational(1, 10**30) * sp.Symbol("Omega1")
    assert is_constant(free, free.kinetic_energy)
    assert not is_constant(free, near)


def test_forces_beyond_all_numbers():
    """A torque without a double at the sample points gives no invariant."""
    huge = E.BodyMoment(("0", "0", "exp(exp(exp(exp(t + 10))))"))
    scene = Scene(ASYMMETRIC, (huge,), START, ["omega"], t=1)
    assert "rotational_energy" not in scene.ode.invariants


def test_the_drift_of_a_balance_is_how_far_it_moved():
    """The drift is the change of energy less work, relative to the energies, and not zero here."""
    scene = load("missile")
    watch = (*scene.watch, "energy_balance", "kinetic_energy")
    for accuracy in (1e-6, 1e-9):
        result = scene.with_values(watch=watch, accuracy=accuracy).run(RungeKutta())
        balance, kinetic = result["energy_balance"], result["kinetic_energy"]
        moved = np.abs(balance - balance[0]).max()
        # The terms are the kinetic energy and the work that made it.
        size = (np.abs(kinetic) + np.abs(kinetic - balance)).max()
        assert moved > 0
        assert result.drift["energy_balance"] == pytest.approx(moved / size, rel=1e-6)

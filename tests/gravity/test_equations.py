"""Field equations: compared with the variation of the action, and their identities."""

# Compiled functions of arrays.
# pyright: reportArgumentType=false

import random

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g
from tests.chosen import one_in
from tests.gravity.action import fields, invariants, variation
from tests.gravity.samples import COORDINATES, sample_connection, sample_frame

LINEAR = ("T1", "T2", "T3", "R", "R1", "R2", "R3", "R4", "R5", "R6", "R7", "P3")
AFFINE = (*LINEAR, "Q1", "Q2", "Q3", "Q4", "Q5", "U1", "U2", "U3")


def compiled(values: sp.Array, q: tuple) -> object:
    """point -> (array, its derivatives with the direction first)."""
    slopes = sp.derive_by_array(values, q)
    both = [sp.lambdify([q], x.tolist(), "numpy") for x in (values, slopes)]
    return lambda point: tuple(np.array(f(point), float) for f in both)


@pytest.mark.parametrize(
    ("n", "metric", "free"),
    [
        *((3, True, False), (3, False, False), (4, True, False), (4, False, False)),
        *((5, False, False), (3, True, True), (4, True, True)),
    ],
)
def test_equations_are_the_variation_of_the_action(n: int, metric: bool, free: bool) -> None:
    """E and C of a Lagrangian with random couplings agree with complex steps in the action.

    free: a metric connection is varied among all connections, as in metric-affine gravity.
    """
    seed = 10 * n + metric
    frame = sample_frame(n, seed)
    connection = sample_connection(frame, seed + 1, metric=metric)
    chosen = random.Random(seed)
    names = (*(LINEAR if metric else AFFINE), *(("holst",) if n == 4 else ()))
    couplings = {name: chosen.randint(-9, 9) for name in names}
    curved = "T1*R/3" if metric else "T1*R/3 - Q1*R"
    text = " + ".join(f"{x}*{name}/10" for name, x in couplings.items()) + " + " + curved
    found = g.equations(connection, g.Lagrangian(text, "metric-affine") if free else text)
    eta = np.diag([-1.0] + [1.0] * (n - 1))

    def density(e, de, w, dw):
        known = fields(eta, e, de, w, dw)
        values = invariants(eta, known)
        total = sum(x / 10 * values[name] for name, x in couplings.items())
        total = total + values["T1"] * values["R"] / 3
        return known["e"] * (total if metric else total - values["Q1"] * values["R"])

    q = frame.coordinates
    array = frame.coframe.to_sympy()
    spin = connection.spin_connection.to_sympy()
    point = np.array([0.3, -0.2, 0.5, 0.4, -0.6][:n])
    of_e, of_w = variation(density, compiled(array, q), compiled(spin, q), point)
    at = dict(zip(q, map(sp.Rational, map(str, point)), strict=True))
    e = frame.determinant.at(at)
    legs = frame.legs.at(at)
    E = e * np.einsum("in,mn->im", found.E.at(at), legs)
    C = e * np.einsum("nij,mn->mij", found.C.at(at), legs)
    assert np.abs(of_e).max() > 1
    assert np.allclose(E, of_e, rtol=1e-8, atol=1e-8 * np.abs(of_e).max())
    if metric and not free:
        # A metric connection is varied within metric connections: omega_aij antisymmetric.
        of_w = np.einsum("aij,jk->aik", of_w, eta)
        of_w = np.einsum("aik,kj->aij", (of_w - np.swapaxes(of_w, 1, 2)) / 2, eta)
    assert np.allclose(C, of_w, rtol=1e-8, atol=1e-8 * np.abs(of_w).max())


NAMES = (
    *("T", "tensor2", "vector2", "axial2", "R", "R2", "R3", "R5", "R7", "P1", "P2", "P3", "P4"),
    *("P5", "P6", "GB", "Q1", "Q2", "Q3", "Q4", "Q5", "Q", "U1", "U2", "U3"),
    *("f(T, R, Q)", "f(2*T + R) + f(T, T)", "sqrt(3 + R1)", "R**2*T + Q1*T2 - 1/(1 + T)"),
)


@pytest.mark.parametrize(("n", "metric"), one_in(2, [2, 3, 4], [False, True]))
def test_identities_hold_off_shell(n: int, metric: bool) -> None:
    """Translations and rotations of the legs leave each Lagrangian invariant: two identities."""
    frame = sample_frame(n, n)
    connection = sample_connection(frame, n + 7, metric=metric)
    names = NAMES if n < 4 else (*NAMES[:-4], "holst", "nieh_yan", "euler", "pontryagin")
    absent = ("Q", "Q1", "Q2", "Q3", "Q4", "Q5", "U1", "U2", "U3", "R7") if metric else ()
    for name in names:
        if name in absent:
            continue
        found = g.equations(connection, name)
        assert [check.holds for check in found.identities()] == [True, True], name
        assert [check.checked for check in found.identities()] == [n, n * (n - 1) // 2]


def test_a_wrong_equation_breaks_the_identities(monkeypatch: pytest.MonkeyPatch) -> None:
    """The identities fail for the equation of another Lagrangian."""
    connection = sample_connection(sample_frame(3, 1), 2, metric=False)
    found, other = (g.equations(connection, text) for text in ("T1 + R1", "T1 + R1 + T2"))
    vars(found)["E"] = other.E
    assert [check.holds for check in found.identities()] == [False, False]


def test_topological_invariants_have_no_equations() -> None:
    """Euler, Pontryagin and Nieh-Yan have no equations, here with torsion and curvature."""
    connection = sample_connection(sample_frame(4, 3), 4, metric=True)
    assert not connection.torsion.S.is_zero
    assert not connection.curvature.is_zero
    for name in ("euler", "pontryagin", "nieh_yan"):
        found = g.equations(connection, name)
        assert found.E.is_zero, name
        assert found.C.is_zero, name
    parts = g.equations(connection, "P1 - P2 + P3 - P4 + P5 + P6 - euler")
    assert parts.L.is_zero


def test_the_rest_of_the_squares_is_not_topological() -> None:
    """Each square by itself has an equation, so that the test above can fail."""
    connection = sample_connection(sample_frame(4, 3), 4, metric=True)
    assert not any(g.equations(connection, f"P{k}").C.is_zero for k in range(1, 7))


def test_several_connections_over_one_frame() -> None:
    """R = R_bar + T + 2 D_bar v: Rbar + T has no equation, and f(T, Rbar) has its identities."""
    frame = sample_frame(3, 5)
    pair = [gt.cartan(frame), gt.levi_civita(frame)]
    assert g.equations(pair, "T + Rbar").E.is_zero
    assert not g.equations(pair, "T - Rbar").E.is_zero
    for text in ("f(T, Rbar)", "T + a*T*Rbar", "T1*R3bar"):
        found = g.equations(pair, text)
        assert all(check.holds for check in found.identities()), text
    bent = [sample_connection(frame, k, metric=bool(k)) for k in (0, 1)]
    found = g.equations([*bent, gt.levi_civita(frame)], "T1*R_2 + Q1*Rbar + R1*T2_2")
    assert all(check.holds for check in found.identities())
    assert not any(one.is_zero for one in found.connection_equations[:2])


def test_a_rotated_coframe_with_its_spin_connection_gives_the_rotated_equation() -> None:
    """A local Lorentz transformation that keeps the connection does not change E."""
    t, x, y = q = COORDINATES[:3]
    coframe = sp.Matrix([[1 + x**2, 0, 0], [y, 1, 0], [0, t * x, 1]])
    boost = sp.Matrix(
        [[sp.cosh(x * t), sp.sinh(x * t), 0], [sp.sinh(x * t), sp.cosh(x * t), 0], [0, 0, 1]]
    )
    turn = sp.Matrix([[1, 0, 0], [0, sp.cos(y), sp.sin(y)], [0, -sp.sin(y), sp.cos(y)]])
    turned = boost * turn
    back = turned.inv().applyfunc(sp.simplify)
    frame = gt.Frame(q, coframe, (-1, 1, 1))
    other = gt.Frame(q, turned * coframe, (-1, 1, 1))
    # E'_i = E_j back[j, i] with parallel E_j, so that D_a E'_i = E'_k (turned d_a back)[k, i].
    omega = [(turned * back.diff(s)).T.applyfunc(sp.simplify).tolist() for s in q]
    kept = gt.from_spin_connection(other, omega)
    assert kept.is_flat
    assert kept.kind == "metric"
    for theory in (g.tegr, g.new_gr(2, 3, 5), g.f_of("T", lambda T: T**2)):
        one, two = g.equations(gt.cartan(frame), theory), g.equations(kept, theory)
        values = two.E.in_coordinates().to_sympy()
        for index, value in np.ndenumerate(np.array(one.E.in_coordinates().to_sympy())):
            (first, second) = other.read([("one", value), ("two", values[index])])
            assert first == second
    wrong = g.equations(gt.cartan(other), g.f_of("T", lambda T: T**2))
    assert not wrong.antisymmetric.is_zero


def test_scalars_and_momenta_are_read_by_name() -> None:
    """The value of an invariant by its name, and the derivatives of L."""
    frame = sample_frame(3, 2)
    connection = gt.cartan(frame)
    found = g.equations(connection, "T + 2*T1")
    assert found.scalar("T") == connection.torsion.scalar[()]
    assert set(found.scalars) == {"T", "T1"}
    P = g.equations(connection, "T1").P
    assert (P - connection.torsion.T.in_frame().raised(0).raised(1).lowered(2) * 2).is_zero
    bent = sample_connection(frame, 3, metric=False)
    N = g.equations(bent, "Q1").N
    assert (N.lowered() - bent.nonmetricity.in_frame() * 2).is_zero
    Z = g.equations(bent, "R1").Z
    assert (Z.lowered() - bent.curvature.lower.in_frame() * 2).is_zero


def test_equal_calls_give_equal_equations() -> None:
    """Equal calls give the same components with the same text."""
    texts = [str(g.equations(gt.cartan(sample_frame(3, 9)), "T**2").E) for _ in range(2)]
    assert texts[0] == texts[1]

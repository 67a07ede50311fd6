"""Laws: exterior calculus and Lie derivatives over every shipped space and over random frames."""

from itertools import product

import pytest
import sympy as sp
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from geomtorsion.geometry import (
    Connection,
    Form,
    Frame,
    Tensor,
    cartan,
    contract,
    levi_civita,
    lie,
    lie_bracket,
)
from geomtorsion.spaces import load, names
from tests import chosen
from tests.laws.frames import connections, frames

few = settings(
    max_examples=12,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def some_forms(frame: Frame) -> tuple[Form, Form, list[sp.Expr]]:
    """A one-form, a two-form and a vector with components that depend on the coordinates."""
    q, n = frame.coordinates, frame.dimension
    one = Form(frame, 1, {k: q[(k + 1) % n] ** 2 - k for k in range(0, n, 2)})
    two = one.d + (Form(frame, 1, {0: q[-1]}) ^ Form(frame, 1, {n - 1: q[0] * q[-1]}))
    return one, two, [q[(k + 1) % n] if k < 2 else sp.Integer(0) for k in range(n)]


def check_calculus(frame: Frame) -> None:
    """d d = 0, Leibniz, and Cartan's formula against the Lie derivative of the tensor."""
    one, two, xi = some_forms(frame)
    assert one.d.d.is_zero is True
    assert (frame.coframe_form(0) * frame.coordinates[0]).d.d.is_zero is True
    assert (one ^ two) == (two ^ one)
    assert (one ^ one).is_zero is True
    assert (one ^ two).d == (one.d ^ two) - (one ^ two.d)
    assert one.lie(xi).tensor == lie(xi, one.tensor)
    assert two.lie(xi).tensor == lie(xi, two.tensor)
    assert Form.of(two.tensor) == two
    # The interior product is an antiderivation.
    assert (one ^ two).interior(xi) == (one.interior(xi) ^ two) - (one ^ two.interior(xi))


def check_star(frame: Frame) -> None:
    """** is a sign, alpha ^ *alpha is the square times the volume, the dual of 1 is epsilon."""
    n = frame.dimension
    one, two, _ = some_forms(frame)
    volume = Form.of(frame.epsilon)
    unit = Form(frame, 0, {(): 1})
    assert unit.star == volume
    sign = volume.star.element().as_fraction()
    assert sign in (1, -1)
    for form, p in ((one, 1), (two, 2)):
        if p <= n:
            assert form.star.star == form * (sign * (-1) ** (p * (n - p)))
    square = contract("a,ab,b->", one.tensor, frame.inverse_metric, one.tensor)
    assert (one ^ one.star) == volume * square


def check_structure(connection: Connection) -> None:
    """Both structure equations and both Bianchi identities, in forms."""
    frame = connection.frame
    coframe, omega = frame.coframe_form(), connection.connection_form()
    torsion, curvature = connection.torsion_form(), connection.curvature_form()
    n = frame.dimension
    assert coframe.D(connection) == torsion
    assert torsion.tensor.raised().slots == "Uuu"
    for k in range(n):
        total = coframe.part(k).d
        for i in range(n):
            total = total + (omega.part(i, k) ^ coframe.part(i))
        assert total == connection.torsion_form(k)
    # Torsion and curvature tensors, index by index.
    whole = connection.torsion.T._with_slot(2, "U")
    for k, a, b in product(range(n), repeat=3):
        assert torsion.element(k, a, b) == whole.element(a, b, k)
    for i, j in ((0, n - 1), (n - 1, 0)):
        total = omega.part(i, j).d
        for k in range(n):
            total = total + (omega.part(k, j) ^ omega.part(i, k))
        assert total == connection.curvature_form(i, j)
    bianchi = torsion.D(connection)
    for k in range(n):
        total = bianchi.part(k)
        for i in range(n):
            total = total - (curvature.part(i, k) ^ coframe.part(i))
        assert total.is_zero is True
    assert curvature.D(connection).is_zero is True


SMALL = [name for name in names() if load(name).frame.dimension <= 4]


@pytest.mark.parametrize("name", SMALL)
def test_calculus_over_a_shipped_space(name: str) -> None:
    """d, wedge, interior and Lie satisfy their laws over the frame of a space."""
    check_calculus(load(name).frame)


@pytest.mark.parametrize("name", chosen.few(20, names()))
def test_dual_over_a_shipped_space(name: str) -> None:
    """The Hodge dual in every dimension and signature, null tetrads included."""
    check_star(load(name).frame)


@pytest.mark.parametrize("name", SMALL)
def test_structure_equations_over_a_shipped_space(name: str) -> None:
    """Torsion and curvature forms agree with the tensors."""
    frame = load(name).frame
    check_structure(cartan(frame))
    check_structure(levi_civita(frame))


def test_structure_equations_of_any_connection() -> None:
    """As above over random connections that need be neither metric nor flat."""

    @few
    @given(connections(largest=3))
    def law(connection: Connection) -> None:
        check_structure(connection)

    law()


def test_calculus_over_random_frames() -> None:
    """As above over random frames of either signature."""

    @few
    @given(frames())
    def law(frame: Frame) -> None:
        check_calculus(frame)
        check_star(frame)

    law()


def test_derivatives_of_tensors_and_connections_along_a_field() -> None:
    """[L_xi, L_eta] = L_[xi, eta], and L_xi Gamma from L_xi of the metric or the torsion."""

    @few
    @given(connections(largest=3), st.data())
    def law(connection: Connection, data: st.DataObject) -> None:
        frame = connection.frame
        q, n = frame.coordinates, frame.dimension
        xi = frame.vector([q[-1], *[q[0]] * (n - 1)])
        eta = frame.vector([q[0] * q[-1], *[sp.Integer(data.draw(st.integers(-2, 2)))] * (n - 1)])
        mixed: Tensor = connection.torsion.T
        both = lie(xi, lie(eta, mixed)) - lie(eta, lie(xi, mixed))
        assert both == lie(lie_bracket(frame, xi, eta), mixed)
        assert lie(xi, eta) == -lie(eta, xi)
        assert lie_bracket(xi, eta) == lie_bracket(frame, xi, eta) == lie(xi, eta)
        assert lie_bracket(xi, xi) == 0
        # Torsion is the antisymmetric part of the coefficients.
        gamma = lie(xi, connection)
        assert gamma - Tensor(frame, "ddu", lambda i: gamma.element(i[1], i[0], i[2])) == lie(
            xi, mixed
        )
        # A quadratic field, which has second derivatives. For Levi-Civita:
        # (L Gamma)_ab^c = g^cd (D_a h_bd + D_b h_ad - D_d h_ab) / 2, h = L g.
        bar = levi_civita(frame)
        slope = bar.covariant_derivative(lie(eta, frame))
        lower = Tensor(
            frame,
            "ddd",
            lambda i: (
                (
                    slope.element(*i)
                    + slope.element(i[1], i[0], i[2])
                    - slope.element(i[2], i[0], i[1])
                )
                / 2
            ),
        )
        assert lie(eta, bar) == lower.raised(2)

    law()

"""Connections: the functions that make them, their checks, and their kinds."""

import pytest
import sympy as sp

from geomtorsion.errors import TensorIndexError
from geomtorsion.geometry import (
    Frame,
    blend,
    cartan,
    from_coefficients,
    from_contortion,
    from_nonmetricity,
    from_spin_connection,
    identities,
    levi_civita,
)
from geomtorsion.geometry.connection import Connection

x, y, z = sp.symbols("x y z", real=True)
c, s = sp.symbols("c s", real=True)


@pytest.fixture
def frame() -> Frame:
    return Frame([x, y], [[1, 0], [0, sp.exp(x)]], signature=(-1, 1))


def zeros(n: int = 2) -> list:
    return [[[0] * n for _ in range(n)] for _ in range(n)]


def test_connections_of_a_frame_are_kept(frame: Frame) -> None:
    """A second call returns the same connection."""
    assert cartan(frame) is cartan(frame)
    assert levi_civita(frame) is levi_civita(frame)


def test_order_of_indices(frame: Frame) -> None:
    """The first lower index is the direction of differentiation: D_x e_y = e_y."""
    gamma = cartan(frame)
    assert gamma[0, 1, 1] == 1
    assert gamma[1, 0, 1] == 0


def test_lorentzian_spin_connection_is_metric_compatible(frame: Frame) -> None:
    """A boost has omega_01 = -omega_10 lowered, so omega_0^1 = omega_1^0."""
    boost, turn = zeros(), zeros()
    boost[0][0][1] = boost[0][1][0] = c
    turn[0][0][1], turn[0][1][0] = c, -c
    assert from_spin_connection(frame, boost).metric_compatible is True
    assert from_spin_connection(frame, boost).nonmetricity.is_zero is True
    assert from_spin_connection(frame, turn).metric_compatible is False


def test_spin_connection_of_the_makers(frame: Frame) -> None:
    """Zero for Cartan; otherwise the given one, with D_a E_i = omega_ai^j E_j."""
    assert cartan(frame).spin_connection.is_zero is True
    omega = zeros()
    omega[0][0][1] = omega[0][1][0] = c * y
    connection = from_spin_connection(frame, omega)
    assert connection.spin_connection.nonzero() == {(0, 0, 1): c * y, (0, 1, 0): c * y}
    moved = connection.covariant_derivative(frame.legs)
    # legs[mu, i] is one tensor with a coordinate and a frame index: its derivative vanishes.
    assert moved.is_zero is True


def test_nonmetricity_must_be_one(frame: Frame) -> None:
    """Q_abc = Q_acb is checked, and Q with indices up or in the frame is converted."""
    wrong = zeros()
    wrong[0][0][1] = x
    with pytest.raises(TensorIndexError, match=r"\[0, 0, 1\] and \[0, 1, 0\] differ"):
        from_nonmetricity(frame, wrong)
    right = zeros()
    right[0][1][1] = x
    connection = from_nonmetricity(frame, right)
    assert connection.is_torsion_free
    assert connection.nonmetricity.nonzero() == {(0, 1, 1): x}
    moved = connection.nonmetricity.raised(1).in_frame()
    assert from_nonmetricity(frame, moved).coefficients == connection.coefficients


def test_contortion_in_any_form(frame: Frame) -> None:
    """Frame components and lowered indices are converted to K_ab^c."""
    contortion = cartan(frame).contortion
    for form in (contortion, contortion.lowered(2), contortion.in_frame()):
        assert from_contortion(frame, form).coefficients == cartan(frame).coefficients


def test_coefficients_have_everything(frame: Frame) -> None:
    """Torsion, curvature and nonmetricity of one general connection, checked by hand."""
    gamma = zeros()
    gamma[0][1][1] = y
    connection = from_coefficients(frame, gamma)
    assert connection.torsion.S.nonzero() == {(0, 1, 1): y / 2, (1, 0, 1): -y / 2}
    # R_mnl^k = d_m G_nl^k - ...: R_101^1 = d_1 G_01^1 = 1
    assert connection.curvature.riemann.nonzero() == {(0, 1, 1, 1): -1, (1, 0, 1, 1): 1}
    # Q_011 = d_0 g_11 - 2 g_11 G_01^1
    (expected,) = frame.read([("Q", (2 - 2 * y) * sp.exp(2 * x))])
    assert connection.nonmetricity.element(0, 1, 1) == expected
    assert not connection.metric_compatible
    assert [identity.holds for identity in identities(connection)] == [False, True, True, True]


def test_ends_of_a_blend(frame: Frame) -> None:
    """Shares 0 and 1 give the two connections; between them torsion is linear in the share."""
    bar, gamma = levi_civita(frame), cartan(frame)
    assert blend(bar, gamma, 0).coefficients == bar.coefficients
    assert blend(bar, gamma, 1).coefficients == gamma.coefficients
    half = blend(bar, gamma)
    assert half.torsion.T == gamma.torsion.T / 2
    assert blend(bar, gamma, s).contortion == gamma.contortion * s


def test_cartan_schouten_connections_of_rotations() -> None:
    """On SO(3) the blends with share 1 and -1 are flat, and the blend with share 1/2 is not."""
    cy, sy, cz, sz = sp.cos(y), sp.sin(y), sp.cos(z), sp.sin(z)
    left = Frame([x, y, z], [[cy * cz, sz, 0], [-cy * sz, cz, 0], [sy, 0, 1]])
    bar, plus = levi_civita(left), cartan(left)
    assert plus.is_flat is True
    assert blend(bar, plus, -1).is_flat is True
    assert blend(bar, plus, sp.Rational(1, 2)).is_flat is False
    # The curvature of the blend with a share is (1 - share^2) times R_bar.
    family = blend(bar, plus, s)
    assert family.curvature.riemann == bar.curvature.riemann * (1 - s**2)


def test_a_false_claim_is_exposed(frame: Frame) -> None:
    """A connection that only claims to be the Cartan connection is not found flat."""
    gamma = zeros()
    gamma[0][1][1] = y
    pretended = from_coefficients(frame, gamma)
    claim = Connection(frame, pretended.coefficients, "false", "cartan")
    assert claim.is_flat is False
    assert claim.metric_compatible is False
    assert not all(identity.holds for identity in identities(claim))


def test_repr(frame: Frame) -> None:
    """The text begins with the name; LaTeX shows the components."""
    assert repr(cartan(frame)).startswith("Cartan connection Gamma_{ab}^{c} (")
    assert r"\Gamma_{x y }{}^{y }" in cartan(frame)._repr_latex_()


def test_the_first_component_in_doubt_is_named() -> None:
    """The first of several undecided components is named, unless another component fails."""
    # Ai(c) and K_{1/3} are the same function; the package does not know this relation.
    order, place = sp.Rational(1, 3), sp.Rational(2, 3) * c ** sp.Rational(3, 2)
    airy = sp.airyai(c) - sp.sqrt(c / 3) / sp.pi * sp.besselk(order, place)
    plane = Frame([x, y], [[1, 0], [0, 1]])
    for last, holds, worst in ((airy, None, (0, 0, 0)), (1, False, (1, 1, 1))):
        gamma = from_coefficients(plane, [[[airy, 0], [0, 0]], [[0, 0], [0, last]]])
        check = identities(gamma)[0]
        assert (check.name, check.holds, check.worst) == ("metricity", holds, worst)


def test_printed_components_are_those_by_index():
    """The printed S_ab^c of a polar frame, and the curvature of a sphere, by index."""
    polar = Frame("r phi", [["1", "0"], ["0", "r"]])
    torsion = cartan(polar).torsion
    assert torsion[0, 1, 1] == torsion.S[0, 1, 1] == torsion["r", "phi", "phi"]
    assert repr(torsion).splitlines()[1].strip() == f"S[0, 1, 1] = {torsion[0, 1, 1]}"
    sphere = Frame("theta phi", [["1", "0"], ["0", "sin(theta)"]])
    curvature = levi_civita(sphere).curvature
    assert curvature[0, 1, 0, 1] == curvature.riemann[0, 1, 0, 1] == -1
    assert len(list(curvature)) == 2

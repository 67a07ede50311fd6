"""Laws: identities that every connection over every frame obeys, exactly."""

from collections import Counter

import pytest
import sympy as sp
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st

from geomtorsion.geometry import (
    Connection,
    Frame,
    cartan,
    contract,
    from_contortion,
    from_nonmetricity,
    from_spin_connection,
    identities,
    levi_civita,
)
from geomtorsion.geometry.curvature import curvature_rule
from geomtorsion.geometry.tensor import Tensor
from tests.laws.frames import MAKERS, connections, frames

METRIC = ("cartan", "levi_civita", "spin", "contortion", "family")
few = settings(
    max_examples=25,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def by_coefficients(connection: Connection) -> Tensor:
    """Curvature only from the coefficients, without any short cut."""
    return Tensor(connection.frame, "dddu", curvature_rule(connection))


@pytest.mark.parametrize("maker", MAKERS)
def test_identities_hold_for_every_maker(maker: str) -> None:
    """Decomposition and both Bianchi identities hold for any connection, the rest if metric."""
    counted: Counter[str] = Counter()

    @few
    @given(connections(makers=(maker,)))
    def law(connection: Connection) -> None:
        results = {identity.name: identity for identity in identities(connection)}
        for name, identity in results.items():
            counted[name] += identity.checked
            if name != "metricity":
                assert identity.holds is True, str(identity)
        if maker in METRIC:
            assert results["metricity"].holds is True
            assert "scalar" in results
            assert connection.metric_compatible
        event(f"flat: {connection.is_flat}")

    law()
    assert counted["decomposition"] > 100
    assert min(counted["first Bianchi"], counted["second Bianchi"]) > 10


@few
@given(frames(largest=5))
def test_cartan_curvature_vanishes_by_the_long_way(frame: Frame) -> None:
    """The short cut of parallel legs agrees with the curvature of the coefficients: zero."""
    connection = cartan(frame)
    assert by_coefficients(connection).is_zero is True
    assert connection.curvature.is_zero is True
    assert connection.metric_compatible is True
    assert connection.nonmetricity.is_zero is True


@few
@given(frames(largest=3))
def test_riemann_by_two_routes(frame: Frame) -> None:
    """Second derivatives of the metric and derivatives of the Christoffel symbols agree."""
    bar = levi_civita(frame)
    assert by_coefficients(bar) == bar.curvature.riemann
    assert bar.curvature.lower == bar.curvature.riemann.lowered(3)
    assert bar.is_torsion_free is True


@few
@given(connections(makers=("cartan", "spin", "contortion")))
def test_curvature_symmetries_that_are_taken_for_granted(connection: Connection) -> None:
    """R_mnlk is antisymmetric in each pair: tested on components computed without symmetry."""
    lower = by_coefficients(connection).lowered(3)
    assert lower == connection.curvature.lower
    assert (lower + contract("abcd->bacd", lower)).is_zero
    assert (lower + contract("abcd->abdc", lower)).is_zero


@few
@given(connections())
def test_commutator_of_derivatives(connection: Connection) -> None:
    """[D_m, D_n] v^k = R_mnl^k v^l - T_mn^t D_t v^k for a vector field of the frame."""
    frame = connection.frame
    x = frame.coordinates[0]
    components = {(i,): x**i + 1 for i in range(frame.dimension)}
    vector = Tensor(frame, "u", components)
    first = connection.covariant_derivative(vector)
    second = connection.covariant_derivative(first)
    # D_m D_n v^k as a second derivative; its antisymmetric part is the commutator.
    commutator = second - contract("mnk->nmk", second)
    bent = contract("mnlk,l->mnk", connection.curvature.riemann, vector)
    twisted = contract("mnt,tk->mnk", connection.torsion.T, first)
    assert commutator == bent - twisted


@few
@given(connections())
def test_spin_connection_gives_the_connection_back(connection: Connection) -> None:
    """Gamma -> omega -> Gamma is the identity."""
    again = from_spin_connection(connection.frame, connection.spin_connection)
    assert again.coefficients == connection.coefficients


@few
@given(connections(makers=METRIC))
def test_contortion_gives_the_connection_back(connection: Connection) -> None:
    """Gamma -> K -> Gamma is the identity for a metric connection."""
    again = from_contortion(connection.frame, connection.contortion_from_torsion)
    assert again.coefficients == connection.coefficients
    assert connection.contortion == connection.contortion_from_torsion


@few
@given(connections())
def test_nonmetricity_and_torsion_give_the_connection_back(connection: Connection) -> None:
    """Gamma -> Q and S -> Gamma is the identity for every connection."""
    again = from_nonmetricity(connection.frame, connection.nonmetricity, connection.torsion)
    assert again.coefficients == connection.coefficients


@few
@given(connections())
def test_parts_of_torsion(connection: Connection) -> None:
    """Vector, axial and tensor part add up; the tensor part has no trace and no axial part."""
    frame, torsion = connection.frame, connection.torsion
    lower, axial, rest = torsion.T.lowered(2), torsion.axial, torsion.tensor
    n = frame.dimension
    trace = contract("a,bc->abc", torsion.vector, frame.metric)
    vector = (trace - contract("abc->bac", trace)) / (n - 1)
    assert axial + vector + rest == lower
    assert contract("abb->a", rest.raised(2)).is_zero
    cyclic = rest + contract("abc->bca", rest) + contract("abc->cab", rest)
    assert cyclic.is_zero
    assert torsion.T == torsion.S * 2


@few
@given(frames(largest=4))
def test_anholonomy_is_twice_the_torsion_in_the_frame(frame: Frame) -> None:
    """C_ij^k = 2 S_ij^k of the Cartan connection."""
    assert cartan(frame).torsion.T.in_frame() == frame.anholonomy


@few
@given(connections())
def test_changes_of_indices_come_back(connection: Connection) -> None:
    """in_frame, raised and lowered have inverses."""
    tensor = connection.torsion.T
    framed = Tensor(tensor.frame, "DDU", tensor.in_frame().components)
    assert framed.in_coordinates() == tensor
    raised = Tensor(tensor.frame, "uuu", tensor.raised().components)
    assert raised.lowered(0).lowered(1) == tensor
    assert framed.lowered(2) == tensor.lowered(2).in_frame()


@few
@given(connections(), st.data())
def test_one_component_equals_the_same_among_all(connection: Connection, data: st.DataObject):
    """A single requested component equals the whole tensor's, and only it is computed."""
    frame = connection.frame
    place = st.integers(0, frame.dimension - 1)
    index = tuple(data.draw(place) for _ in range(4))
    alone = Tensor(frame, "dddu", curvature_rule(connection))
    value = alone.element(*index)
    assert alone.components.computed == 1
    assert value == connection.curvature.riemann.element(*index)


@few
@given(frames(smallest=3, largest=4))
def test_weyl_has_no_trace(frame: Frame) -> None:
    """The trace of the Weyl tensor vanishes, and in three dimensions the tensor itself."""
    curvature = levi_civita(frame).curvature
    weyl = curvature.weyl
    assert contract("abcd,da->bc", weyl, frame.inverse_metric).is_zero
    if frame.dimension == 3:
        assert weyl.is_zero


@few
@given(frames(largest=3))
def test_metric_gives_the_same_geometry(frame: Frame) -> None:
    """A frame made from the metric has the same Kretschmann scalar and reproduces the metric."""
    metric = frame.metric.to_sympy().tolist()
    again = Frame.from_metric(frame.coordinates, metric)
    rebuilt = contract("ia,ij,jb->ab", again.coframe, again.eta, again.coframe)
    assert rebuilt == again.metric
    scalar, other = (levi_civita(f).curvature.kretschmann[()] for f in (frame, again))
    (difference,) = frame.read([("difference", scalar - other)])
    assert difference.is_zero
    assert sorted(map(sp.sign, again.eta.nonzero().values())) == sorted(
        map(sp.sign, frame.eta.nonzero().values())
    )

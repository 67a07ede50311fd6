"""Laws: every connection of every shipped space obeys the identities, exactly."""

import pytest

from geomtorsion.geometry import Connection, cartan, contract, identities, levi_civita
from geomtorsion.spaces import load, names


def connections(name: str) -> list[Connection]:
    """Cartan, Levi-Civita and, where the space has one, its own connection."""
    space = load(name)
    own = [] if space.connection is None else [space.connection]
    return [cartan(space.frame), levi_civita(space.frame), *own]


@pytest.mark.parametrize("name", names())
def test_identities_of_a_shipped_space(name: str) -> None:
    """Decomposition, both Bianchi identities, and metricity and the scalar where they apply."""
    for connection in connections(name):
        results = identities(connection)
        assert len(results) >= 4
        assert results[1].checked == connection.frame.dimension**3
        for identity in results:
            if identity.name != "metricity" or connection.metric_compatible:
                assert identity.holds is True, f"{connection.name}: {identity}"


@pytest.mark.parametrize("name", names())
def test_the_first_two_connections_are_what_they_are_called(name: str) -> None:
    """Cartan: flat and metric. Levi-Civita: metric, free of torsion. Legs inverse to coframe."""
    flat, bar = connections(name)[:2]
    frame = flat.frame
    assert flat.is_flat is True
    assert flat.metric_compatible is True
    assert flat.nonmetricity.is_zero is True
    assert bar.metric_compatible is True
    assert bar.nonmetricity.is_zero is True
    assert bar.is_torsion_free is True
    unit = contract("ia,aj->ij", frame.coframe, frame.legs).nonzero()
    assert unit == {(i, i): 1 for i in range(frame.dimension)}
    assert flat.torsion.T.in_frame() == frame.anholonomy

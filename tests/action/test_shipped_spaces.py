"""Shipped spaces: in each both principles give the curves that motion/ solves."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.curves.equations import Geodesic
from tests.chosen import one_in

NAMES = [name for name in gt.spaces.names() if not gt.spaces.load(name).frame.complex]


def test_there_are_enough():
    """At least 45 shipped spaces are real."""
    assert len(NAMES) >= 45


@pytest.mark.parametrize("name", one_in(4, NAMES))
def test_geodesics_and_autoparallels(name):
    """L = eta_ij u^i u^j / 2: Hamilton's principle gives geodesics, Kleinert's u' = 0."""
    frame = gt.spaces.load(name).frame
    n = range(frame.dimension)
    u = [sp.Symbol(f"u{k + 1}") for k in n]
    energy = sp.Add(*(frame.eta[i, j] * u[i] * u[j] for i in n for j in n)) / 2
    shortest = gt.equations_of_motion(frame, energy)
    assert shortest.agrees is True
    assert [symbol.name for symbol in shortest.velocities] == [symbol.name for symbol in u]
    law = Geodesic().rates(frame, [symbol.name for symbol in u])
    assert law is not None
    own = shortest.hamel.bundle.frame
    assert shortest.hamel.accelerations is not None
    for found, products in zip(shortest.hamel.accelerations, law.products, strict=True):
        rate = sp.Add(*(c.sympy * sp.Mul(*map(sp.Symbol, names)) for c, names in products))
        assert own.read([("rate", rate)])[0] == found
    straightest = gt.equations_of_motion(frame, energy, principle="closed_in_image")
    assert not any(straightest.accelerations)

"""Logarithm: how near to a conjugate point geodesics are found, and by how many shots."""

from importlib import import_module

import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import log_map
from geomtorsion.errors import EndpointError, GeomtorsionError
from geomtorsion.geometry import Frame, levi_civita
from geomtorsion.ode import RungeKutta
from geomtorsion.ode.trajectory import integrate
from geomtorsion.spaces import load


@pytest.mark.parametrize(("short", "found"), [(1e-5, True), (2e-6, True), (5e-7, False)])
def test_how_near_to_a_conjugate_point_geodesics_are_found(short, found):
    """At the antipode of a sphere the end depends on one direction only; so near to it, no more."""
    start, end = [np.pi / 2, 0.0], [np.pi / 2, np.pi - short]
    call = {"parameters": {"R": 1}, "guess": [0.0, np.pi - 3 * short]}
    connection = levi_civita(load("s2").frame)
    if found:
        vector = log_map(connection, start, end, **call).vector
        assert np.abs(vector) == pytest.approx([0, np.pi - short], abs=1e-6)
    else:
        with pytest.raises(GeomtorsionError):
            log_map(connection, start, end, **call)


MODULE = import_module("geomtorsion.curves.log_map")
SPHERE = levi_civita(load("s2").frame), [1.5, 0.0], [1.6, 3.0], {"R": 1}
PLANE = levi_civita(load("flat_polar").frame), [1, 0], [1, 0.5], {}


def ends(case, guess, monkeypatch):
    """How many motions are followed, and the answer; None where there is none."""
    connection, start, end, parameters = case
    followed = []

    def counted(*given):
        followed.append(given)
        return integrate(*given)

    monkeypatch.setattr(MODULE, "integrate", counted)
    call = {"parameters": parameters, "accuracy": 1e-9, "engine": RungeKutta()}
    try:
        found = log_map(connection, start, end, guess=guess, **call)
    except EndpointError:
        return len(followed), None
    return len(followed), found


def test_how_many_shots_there_are(monkeypatch):
    """A guess in the wrong direction takes thirteen; what leads nowhere is given up after forty."""
    _, found = ends(PLANE, [-3.0, 0.1], monkeypatch)
    assert found is not None
    assert found.vector == pytest.approx([np.cos(0.5) - 1, np.sin(0.5)], abs=1e-8)
    assert 10 < found.shots < 20
    many, nowhere = ends(SPHERE, [3.0, 0.1], monkeypatch)
    assert nowhere is None
    assert 40 < many < 100


def test_slopes_are_used_again_where_they_lead_closer_quickly(monkeypatch):
    """That takes fewer motions than slopes anew at each shot; old ones all the way miss."""
    again, found = ends(PLANE, [-3.0, 0.1], monkeypatch)
    monkeypatch.setattr(MODULE, "STALE", 0.0)
    anew, same = ends(PLANE, [-3.0, 0.1], monkeypatch)
    assert found is not None
    assert same is not None
    assert same.vector == pytest.approx(found.vector, abs=1e-8)
    assert again < anew
    monkeypatch.setattr(MODULE, "STALE", 1.0)
    assert ends(PLANE, [-3.0, 0.1], monkeypatch)[1] is None


def test_how_quickly_is_quickly(monkeypatch):
    """Slopes that are kept four times as long miss this end, those kept a quarter cost more."""
    followed, found = ends(SPHERE, [0.3, -1.0], monkeypatch)
    assert found is not None
    assert followed < 43


def test_what_counts_modulo_a_full_turn():
    """A coordinate whose domain is a full turn, wherever that begins; not one that ends at 2 pi."""
    x, y = sp.symbols("x y", real=True)
    plane = levi_civita(Frame([x, y], sp.eye(2), domain=[x < 2 * sp.pi]))
    assert log_map(plane, [0, 0], [5, 0]).vector == pytest.approx([5, 0], abs=1e-9)
    r, phi = sp.symbols("r phi", real=True)
    polar = Frame([r, phi], sp.diag(1, r), domain=[r > 0, phi > -sp.pi, phi < sp.pi])
    found = log_map(levi_civita(polar), [1, 3], [1, -3])
    chord = 2 * np.sin(np.pi - 3)
    assert np.linalg.norm(found.vector) == pytest.approx(chord, abs=1e-9)

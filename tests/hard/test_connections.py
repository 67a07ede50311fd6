"""Connections of every kind agree with the oracle and reproduce their input."""

from __future__ import annotations

from itertools import product

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import geomtorsion as gt
from tests.differences import agrees
from tests.hard.support import numbers, oracle_of, quick, values_at
from tests.strategies import COORDINATES, coframes, rationals


def connection_numbers(connection: gt.Connection, values: dict) -> dict[str, np.ndarray]:
    """Curvature, torsion, nonmetricity and spin connection, from the package."""
    return {
        "curvature": numbers(connection.curvature.riemann, values),
        "torsion": numbers(connection.torsion.S, values),
        "nonmetricity": numbers(connection.nonmetricity, values),
        "spin_connection": numbers(connection.spin_connection, values),
    }


def disagreements(connection: gt.Connection, values: dict) -> list[str]:
    """Names of the quantities that differ from the oracle."""
    size = range(connection.frame.dimension)
    gamma = [[[connection[a, b, c] for c in size] for b in size] for a in size]
    oracle = oracle_of(connection.frame, values, gamma)
    exact = connection_numbers(connection, values)
    with mpmath.workdps(30):
        return [n for n, found in exact.items() if not agrees(found, getattr(oracle, n), 1e-15)]


def array_of(draw, size):
    """A sparse array of polynomials, size x size x size."""
    x, y = COORDINATES[:2]
    entry = st.just(sp.S.Zero) | st.builds(lambda c, s: c * s, rationals(), st.sampled_from([
        sp.S.One, x, y, x * y, sp.sin(x), sp.exp(y)]))  # fmt: skip
    return [[[draw(entry) for _ in range(size)] for _ in range(size)] for _ in range(size)]


@quick
@given(st.data(), coframes(2, 2))
def test_general_coefficients(data, case):
    """Connections from any coefficients, with torsion, curvature and nonmetricity, agree."""
    coordinates, matrix, signature = case
    frame = gt.Frame(coordinates, matrix, signature=signature)
    gamma = array_of(data.draw, 2)
    connection = gt.from_coefficients(frame, gamma)
    values = values_at(coordinates, 4)
    assert disagreements(connection, values) == []
    for a, b, c in product(range(2), repeat=3):
        assert connection.coefficients.element(a, b, c) == frame.field.read(gamma[a][b][c])


@quick
@given(st.data(), coframes(2, 3))
def test_connections_from_a_spin_connection(data, case):
    """The given omega is reproduced, and its coefficients agree with the oracle."""
    coordinates, matrix, signature = case
    frame = gt.Frame(coordinates, matrix, signature=signature)
    omega = array_of(data.draw, frame.dimension)
    connection = gt.from_spin_connection(frame, omega)
    values = values_at(coordinates, 4)
    assert disagreements(connection, values) == []
    for a, i, j in product(range(frame.dimension), repeat=3):
        assert connection.spin_connection.element(a, i, j) == frame.field.read(omega[a][i][j])


@settings(quick, max_examples=5)
@given(st.data(), coframes(2, 3))
def test_connections_from_a_contortion_and_blends(data, case):
    """An antisymmetric K gives a metric connection with this contortion; a blend agrees as well."""
    check_contortion(data, case)


@pytest.mark.slow
@settings(quick, max_examples=40)
@given(st.data(), coframes(2, 3))
def test_many_connections_from_a_contortion(data, case):
    """As above, for more frames."""
    check_contortion(data, case)


def check_contortion(data, case):
    """Check a connection from a contortion, and its blend, against the oracle."""
    coordinates, matrix, signature = case
    frame = gt.Frame(coordinates, matrix, signature=signature)
    size = frame.dimension
    raw = array_of(data.draw, size)
    lower = {(a, b, c): raw[a][b][c] - raw[a][c][b] for a, b, c in product(range(size), repeat=3)}
    contortion = gt.Tensor(frame, "ddd", lower)
    connection = gt.from_contortion(frame, contortion)
    values = values_at(coordinates, 4)
    assert connection.metric_compatible is True
    assert connection.nonmetricity.is_zero is True
    assert connection.contortion.lowered(2) == contortion
    assert disagreements(connection, values) == []
    mixed = gt.blend(connection, gt.levi_civita(frame), sp.Rational(1, 3))
    assert disagreements(mixed, values) == []

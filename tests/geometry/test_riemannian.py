"""Riemannian: quantities from the anholonomy equal those from the metric."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.geometry import Frame, cartan, contract, from_coefficients, levi_civita
from tests.laws.dense import dense_frames

t, r = sp.symbols("t r", real=True)
M = sp.Symbol("M", positive=True)
f = sp.Function("f")


def issue_frame() -> Frame:
    """A frame of products of different functions, one of them unknown."""
    rows = [
        [M * t / 2 + 2, (t**2 + 1) ** 2],
        [sp.sin(r) + sp.Rational(4, 3), f(t) * sp.cos(r - t) / 2 - 1],
    ]
    return Frame([t, r], rows)


def check_both_bases(frame: Frame) -> None:
    """Riemann, Ricci, scalar, Kretschmann and contortion by two routes."""
    curvature = levi_civita(frame).curvature
    # Other connections compute curvature from coefficients, here the Christoffel symbols.
    other = from_coefficients(frame, levi_civita(frame).coefficients).curvature
    assert curvature.riemann == other.riemann
    assert curvature.lower == other.lower
    assert curvature.ricci == other.ricci
    trace = contract("ab,ab->", frame.inverse_metric, other.ricci)
    assert (curvature.scalar - trace).is_zero is True
    square = contract("abcd,abcd->", other.lower, other.riemann.raised())
    assert (curvature.kretschmann - square).is_zero is True
    assert cartan(frame).contortion == cartan(frame).contortion_from_torsion


@settings(max_examples=6, deadline=None)
@given(dense_frames(largest=2))
def test_both_bases_agree_in_the_plane(frame):
    """Random dense frames of two dimensions, with either signature and with null legs."""
    check_both_bases(frame)


@settings(max_examples=3, deadline=None)
@given(dense_frames(smallest=3))
def test_both_bases_agree_in_space(frame):
    """Random dense frames of three dimensions."""
    check_both_bases(frame)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(dense_frames(largest=4))
def test_both_bases_agree(frame):
    """Many random dense frames of up to four dimensions."""
    check_both_bases(frame)


@given(st.sampled_from(("riemann", "ricci", "kretschmann", "contortion", "scalar_curvature")))
def test_the_basis_is_chosen_by_length_and_reported(name):
    """The anholonomy is used if the metric is at least twice as long as the coframe."""
    dense = issue_frame()
    assert 2 * dense.coframe.components.length <= dense.metric.components.length
    assert "anholonomy" in dense.plan(name).graph
    assert "christoffel" in dense.plan(name).left_out
    polar = Frame([t, r], [[1, 0], [0, t]])
    assert "christoffel" in polar.plan(name).graph
    given_metric = Frame.from_metric(dense.coordinates, dense.metric.to_sympy().tolist())
    assert "christoffel" in given_metric.plan(name).graph


def test_the_frame_of_products_is_decided_and_written():
    """All quantities are decided; scalar and torsion are short enough to read."""
    frame = issue_frame()
    curvature = levi_civita(frame).curvature
    for tensor in (
        cartan(frame).torsion.S,
        cartan(frame).contortion,
        curvature.riemann,
        curvature.ricci,
        curvature.scalar,
        curvature.kretschmann,
    ):
        assert tensor.is_zero is False
    assert curvature.einstein.is_zero is True
    assert len(str(curvature.scalar[()])) < 5000
    assert len(str(cartan(frame).torsion.S.nonzero())) < 3000
    # In two dimensions the Kretschmann scalar is the square of the curvature scalar (Gauss).
    square = curvature.scalar * curvature.scalar
    assert (curvature.kretschmann - square).is_zero is True


def test_forms_know_what_they_were_made_from():
    """Curvature in the frame and back is equal; raised and lowered it is the same object."""
    lower = levi_civita(issue_frame()).curvature.lower
    there = lower.in_frame()
    assert there.slots == "DDDD"
    assert there.in_coordinates() == lower
    assert lower.raised(3).lowered(3) is lower

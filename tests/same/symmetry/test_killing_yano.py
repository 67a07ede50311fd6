"""Killing-Yano forms: known numbers, their equation, and their squares, Killing tensors."""

from itertools import product
from math import comb

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity
from geomtorsion.errors import GeomtorsionError

t, x, y, z, r, theta, phi = sp.symbols("t x y z r theta phi", positive=True)
FLAT = gt.Frame([t, x, y, z], sp.eye(4), signature=(-1, 1, 1, 1))
BALL = gt.Frame([t, r, theta, phi], sp.diag(1, 1, r, r * sp.sin(theta)), signature=(-1, 1, 1, 1))


def shipped(name: str) -> gt.Frame:
    """The frame of a shipped space."""
    return gt.spaces.load(name).frame


def is_killing_yano(form: gt.Form) -> bool:
    """Whether D_a f_b... is antisymmetric in a and b, exactly."""
    frame, p = form.frame, form.degree
    slope = gt.levi_civita(frame).covariant_derivative(form.tensor)
    n = range(frame.dimension)
    return all(
        (slope.element(a, b, *rest) + slope.element(b, a, *rest)).is_zero
        for a, b, *rest in product(n, repeat=p + 1)
    )


# Frame, degree, number of forms.
KNOWN = {
    "flat": (FLAT, 2, 10),
    "flat, three indices": (FLAT, 3, 5),
    "flat, volume": (FLAT, 4, 1),
    "flat, spherical": (BALL, 2, 10),
    "S2, covectors": (shipped("s2"), 1, 3),
    "S3": (shipped("s3"), 2, 4),
    "Schwarzschild": (shipped("schwarzschild"), 2, 1),
    "Goedel": (shipped("goedel"), 3, 1),
}


@pytest.mark.parametrize("name", KNOWN)
def test_known_numbers(name: str) -> None:
    """At most comb(n + 1, p + 1) forms, in flat space and on spheres exactly so many."""
    frame, degree, count = KNOWN[name]
    forms = gravity.killing_yano(frame, degree)
    assert len(forms) == count <= comb(frame.dimension + 1, degree + 1)
    assert all(is_killing_yano(one) for one in forms)


def test_covectors_are_killing_vectors() -> None:
    """Forms with one index are the Killing vectors, with the index lowered."""
    frame = shipped("s2")
    for one in gravity.killing_yano(frame, 1):
        assert gt.lie(one.tensor.raised(0), frame).is_zero


@pytest.mark.slow
@pytest.mark.parametrize("name", ["kerr", "taub_nut"])
def test_rotating_holes(name: str) -> None:
    """Kerr and Taub-NUT have one form, which squares to a Killing tensor."""
    frame = shipped(name)
    (form,) = gravity.killing_yano(frame)
    assert is_killing_yano(form)


def test_the_square_is_a_killing_tensor() -> None:
    """D_(a K_bc) = 0 for K_ab = f_ac f_b^c in Schwarzschild's space."""
    frame = shipped("schwarzschild")
    (form,) = gravity.killing_yano(frame)
    f = form.tensor
    square = gt.contract("ac,bd,cd->ab", f, f, frame.inverse_metric)
    slope = gt.levi_civita(frame).covariant_derivative(square)
    for a, b, c in product(range(4), repeat=3):
        terms = (slope.element(*index) for index in ((a, b, c), (b, c, a), (c, a, b)))
        assert sum(terms, frame.field.zero).is_zero


REFUSALS = [
    (lambda: gravity.killing_yano("s2", 3), "degree"),
    (lambda: gravity.killing_yano("s2", 0), "degree"),
    (lambda: gravity.killing_yano(3), "frame"),  # pyright: ignore[reportArgumentType]
]


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_bad_input_is_refused(call, words):
    """Each bad argument is refused with its own message."""
    with pytest.raises(GeomtorsionError, match=words):
        call()

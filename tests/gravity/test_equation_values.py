"""Equations as numbers: field equations at points, without expressions of them."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError
from geomtorsion.support.precision import EPS
from tests.gravity.samples import sample_connection, sample_frame

FLAT = gt.Frame("t x y", [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "-++")
BENT = gt.Frame("t x y", [["1 + x*t", "y", 0], ["t", "2 + x**2", 0], [0, "x", "1 + t**2"]], "-++")
PLACE = {"t": Fraction(1, 2), "x": Fraction(1, 4), "y": 1}
wrong: Any = g


def agrees(equations: g.FieldEquations, point: dict[str, Any]) -> bool:
    """Whether numbers at a point are the exact components there, within the stated errors."""
    values = equations.at(point)
    numbers = {**values.tensors, **values.matter}
    exact = {**equations.tensors, **equations.matter_equations}
    assert numbers.keys() == exact.keys()
    # Constants become symbols of the frame when components are computed.
    assert all(tensor.components.support is not None for tensor in exact.values())
    return all(
        bool((np.abs(numbers[name] - tensor.at(point)) <= 4 * values.errors[name] + EPS).all())
        for name, tensor in exact.items()
    )


def test_flat_space_has_no_equations_left():
    """In flat space with constant legs every component is zero, with a proved bound."""
    values = g.equations(gt.cartan(FLAT), "T").at({"t": 0, "x": 0, "y": 0})
    assert values.largest == 0
    assert values.error == 0
    assert values.E.shape == (3, 3)
    assert values.L == 0


@pytest.mark.parametrize(
    ("make", "lagrangian"),
    [
        (gt.cartan, "T1 + 3*T2**2 + T3*T"),
        (gt.cartan, "sqrt(4 + T1) + exp(T3/9) + sin(T2)*cos(T1) + log(5 + T1**2)"),
        (gt.levi_civita, "R**2 + R4"),
        (gt.levi_civita, "R/2 - Lambda"),
    ],
)
def test_numbers_are_the_exact_components(make: Any, lagrangian: str):
    """E of torsion, of second and of fourth order agrees with the exact components."""
    point = PLACE | ({"Lambda": 3} if "Lambda" in lagrangian else {})
    assert agrees(g.equations(make(BENT), lagrangian), point)


@pytest.mark.parametrize("metric", [True, False])
def test_connections_of_their_own(metric: bool):
    """C, M and E of metric and general connections agree with the exact components."""
    frame = sample_frame(3, seed=4)
    connection = sample_connection(frame, seed=5, metric=metric)
    theory = "R + T1*T2 + R1" if metric else "R + Q1 + T1*Q3 + R1"
    point = {f"x{k}": Fraction(k + 1, 5) for k in range(3)}
    assert agrees(g.equations(connection, theory), point)


def test_matter_fields():
    """Equations of a scalar and of a Maxwell field agree with the exact components."""
    matter = [g.scalar_field("t*x"), g.maxwell(["x*y", "t", "t**2"])]
    assert agrees(g.equations(gt.levi_civita(BENT), "R + X*phi**2 + F2*R", matter), PLACE)


def test_frames_from_metrics_and_several_connections():
    """A frame given by its metric, and a theory of two connections, agree as well."""
    metric = [["-1 - x**2", "y", 0], ["y", "2 + x**2", 0], [0, 0, "1 + t**2"]]
    assert agrees(g.equations(gt.levi_civita(gt.Frame.from_metric("t x y", metric)), "R"), PLACE)
    both = [gt.cartan(BENT), gt.levi_civita(BENT)]
    assert agrees(g.equations(both, "T*Rbar + T"), PLACE)


def test_kerr_solves_its_equations():
    """The equations of general relativity vanish on Kerr within the bound, at several points."""
    equations = g.equations(gt.levi_civita("kerr"), "R")
    point = {"t": 0, "r": [3, 5], "theta": 1, "phi": 0, "M": 1, "a": Fraction(1, 2)}
    values = equations.at(point)
    assert values.E.shape == (2, 4, 4)
    assert values.scalars["R"].shape == (2,)
    assert values.largest <= values.error < EPS


def test_a_dense_frame_satisfies_noether_s_identity():
    """E of nine quadratic polynomials, T + c T^2, is covariantly conserved: a truth by itself.

    e_j^i D_n(e E_i^n) = e T_in^j E_j^n for every coframe, here by central differences of two
    steps, whose error falls by four.
    """
    monomials = ["1", "x", "y", "z", "x*y", "x*z", "y*z", "x**2", "y**2", "z**2"]
    draw = np.random.default_rng(3).integers(1, 9, (3, 3, 10))
    rows = [
        [
            f"{5 * (i == j)} + "
            + " + ".join(f"{k}*{m}/9" for k, m in zip(draw[i, j], monomials, strict=True))
            for j in range(3)
        ]
        for i in range(3)
    ]
    frame = gt.Frame("x y z", rows, "-++")
    equations = g.equations(gt.cartan(frame), "T + c*T**2")
    start = {"x": 0.25, "y": 0.5, "z": 0.125, "c": 0.5}

    def density(point: dict[str, float]) -> np.ndarray:
        """E_i^n det(e) E_n^mu, axes (i, mu)."""
        place = {x: point[x] for x in "xyz"}
        legs, det = frame.legs.at(place), float(frame.determinant.at(place))
        return det * equations.at(point).E @ legs.T

    values = equations.at(start)
    torsion = frame.anholonomy.at({x: start[x] for x in "xyz"})
    det = float(frame.determinant.at({x: start[x] for x in "xyz"}))
    right = det * np.einsum("inj,jn->i", torsion, values.E)
    misses = []
    for step in (2.0**-5, 2.0**-6):
        left = sum(
            (density(start | {x: start[x] + step}) - density(start | {x: start[x] - step}))[:, mu]
            / (2 * step)
            for mu, x in enumerate("xyz")
        )
        misses.append(np.abs(left - right).max())
    assert misses[1] < 0.01 * np.abs(right).max()
    assert 3.5 < misses[0] / misses[1] < 4.5


def test_equal_calls_give_equal_bits():
    """Two evaluations give the same floats."""
    point = PLACE | {"c": 1}
    one, two = (g.equations(gt.cartan(BENT), "T + c*T**2").at(point).E for _ in range(2))
    assert one.tobytes() == two.tobytes()


COSMOS = gt.spaces.load("frw_flat").frame
POLAR = gt.Frame("r phi", [[1, 0], [0, "r"]])
SMALL = gt.Frame("t x", [[1, 0], [0, "1 + epsilon*t"]], "-+", parameters="epsilon")
REFUSALS = [
    (lambda: g.equations(gt.cartan(BENT), "f(T)").at(PLACE), "unknown function f"),
    (lambda: g.equations(gt.cartan(COSMOS), "T").at(dict.fromkeys("txyz", 1)),
     r"unknown function a\(t\)"),
    (lambda: g.equations(gt.cartan(BENT), "T").at({"t": 1}), "none for x, y"),
    (lambda: g.equations(gt.cartan(BENT), "c*T + T").at(PLACE), "a number for c"),
    (lambda: g.equations(gt.cartan(BENT), "T").at({**PLACE, "q": 1}), "got 'q'"),
    (lambda: g.equations(gt.cartan(BENT), "T").at({**PLACE, "x": "1"}), "expected a number"),
    (lambda: g.equations(gt.cartan(BENT), "T").at({**PLACE, "x": np.inf}), "x"),
    (lambda: g.equations(gt.cartan(BENT), "T").at({**PLACE, "x": [1, 2], "y": [1, 2, 3]}),
     "one shape"),
    (lambda: g.equations(gt.cartan(BENT), "T").at({**PLACE, "x": []}), "at least one point"),
    (lambda: wrong.equations(gt.cartan(BENT), "T").at(3), "names with values"),
    (lambda: g.equations(gt.cartan(SMALL.expanded("epsilon", 1)), "T1").at({"t": 0, "x": 0}),
     "series in a small parameter"),
    (lambda: g.equations(gt.levi_civita(POLAR), "R**2").at({"r": 0, "phi": 0}),
     "denominator that does not vanish"),
    (lambda: g.equations(gt.cartan(BENT), "T").at(PLACE).C, "do not have"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_refusals(call: Any, words: str):
    """The message of each wrong call names the expected value."""
    with pytest.raises(GeomtorsionError, match=words):
        call()


def test_odd_functions_are_evaluated():
    """Functions of coordinates have the series that sympy's derivatives give."""
    functions = ["tan(t)", "sinh(t)", "cosh(t)", "tanh(t)", "atan(t)", "asin(t)", "asinh(t)"]
    frame = gt.Frame("t x", [[" + ".join(["2", *functions]), 0], [0, "1 + t**2 + sqrt(2 + t)"]])
    equations = g.equations(gt.cartan(frame), "T1**2")
    assert agrees(equations, {"t": Fraction(1, 3), "x": 0})


def test_zeros_are_zeros():
    """A component whose ball contains zero is zero; its error bounds the ball."""
    equations = g.equations(gt.levi_civita("kerr"), "R")
    point = {"t": 0, "r": 3, "theta": 1, "phi": 0, "M": 1, "a": Fraction(1, 2)}
    values = equations.at(point)
    assert not values.E.any()
    assert 0 < values.error < EPS
    assert str(values) == repr(values)


def test_printed_components_have_errors():
    """Printing lists the components that do not vanish, each with its error."""
    text = str(g.equations(gt.cartan(BENT), "T1").at(PLACE))
    assert "E[0, 0] = " in text
    assert all(" +- " in line for line in text.splitlines()[1:])


def test_many_points_are_single_points():
    """Points in one call have the bits of single calls, also with a constant that varies."""
    equations = g.equations(gt.cartan(BENT), "T + c*T**2")
    t, c = np.linspace(0, 1, 6).reshape(2, 3), np.array([[1, 2, 1], [2, 2, 3]])
    many = equations.at({"t": t, "x": 0.25, "y": 1, "c": c})
    assert many.E.shape == (2, 3, 3, 3)
    for k in np.ndindex(2, 3):
        one = equations.at({"t": t[k], "x": 0.25, "y": 1, "c": c[k]})
        assert one.E.tobytes() == many.E[k].tobytes()
        assert one.L.tobytes() == many.L[k].tobytes()

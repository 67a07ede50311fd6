"""Degrees of freedom: theories whose count is in every textbook, and f(T) in three dimensions."""

import re
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError
from geomtorsion.gravity import perturbed
from tests.chosen import few

A2 = g.invariant("A2", "A_a A^a")
CHERN_SIMONS = g.invariant("CS", "eps^abc A_a F_bc")
# A universe that a massless scalar field drives in T + X/2: an exact solution, dT does not vanish.
ROOT = "sqrt(1 + t)"
UNIVERSE = gt.Frame("t x y", [[1, 0, 0], [0, ROOT, 0], [0, 0, ROOT]], "-++")
count = perturbed.degrees_of_freedom


@pytest.mark.parametrize("n", [3, 4])
@pytest.mark.parametrize(
    ("lagrangian", "options", "number"),
    few(
        3,
        [
            ("-X/2 - phi**2/2 - phi**4/4", {"scalars": "phi"}, lambda n: 1),
            ("-F2/4", {"vectors": 1}, lambda n: n - 2),
            ("-F2/4 - A2/2", {"vectors": 1, "invariants": A2}, lambda n: n - 1),
            ("-F2/4 - A2/2 - A2**2/8", {"vectors": 1, "invariants": A2}, lambda n: n - 1),
            ("-X/2 - F2*(1 + phi)/4", {"scalars": "phi", "vectors": 1}, lambda n: n - 1),
        ],
    ),
)
def test_matter_in_flat_space(n: int, lagrangian: str, options: dict[str, Any], number: Any):
    """Scalar 1, Maxwell n - 2, Proca n - 1 with and without a quartic term, and a sum."""
    answer = count(lagrangian, "flat", dimension=n, **options)
    assert answer.settled, answer.reason
    assert answer.number == number(n)


@pytest.mark.parametrize(
    ("lagrangian", "n", "order", "number"),
    [
        ("-H2/12", 3, None, 0),
        ("-H2/12", 4, None, 1),
        ("-H2/12 - B2/4", 3, 7, 1),
        pytest.param("-H2/12 - B2/4", 4, None, 3, marks=pytest.mark.slow),
    ],
)
def test_two_forms(lagrangian: str, n: int, order: int | None, number: int):
    """Kalb and Ramond's field has (n - 2 over 2), with a mass (n - 1 over 2)."""
    answer = count(lagrangian, "flat", dimension=n, two_forms=1, order=order)
    assert answer.settled, answer.reason
    assert answer.number == number


@pytest.mark.slow
def test_a_two_form_beside_a_vector_and_a_scalar():
    """The gauge functions of all fields add up: 1 + 2 + 1 in four dimensions."""
    answer = count("-H2/12 - F2/4 - X/2", "flat", dimension=4, scalars="phi", vectors=1,
                   two_forms=1)  # fmt: skip
    assert answer.number == 4
    assert sum(m for m, _ in answer.gauge) == 4


def test_chern_simons_has_none():
    """Chern and Simons' vector field in three dimensions: gauge, and no degree of freedom."""
    answer = count("CS", "flat", dimension=3, vectors=1, invariants=CHERN_SIMONS)
    assert answer.number == 0
    assert answer.gauge == ((1, 1),)
    assert answer.branch == ("CS",)


@pytest.mark.parametrize(
    ("lagrangian", "geometry", "gauge"),
    few(1, [("R", "riemannian", 3), ("R - 2*Lambda", "riemannian", 3), ("R", "poincare", 6),
            ("T", "teleparallel", 6)]),
)  # fmt: skip
def test_gravity_in_three_dimensions_has_none(lagrangian: str, geometry: str, gauge: int):
    """General relativity in its three forms: n(n - 3)/2 = 0, with its gauge functions."""
    answer = count(lagrangian, geometry, dimension=3)
    assert answer.settled, answer.reason
    assert answer.number == 0
    assert sum(m for m, _ in answer.gauge) == gauge


def test_brans_dicke_has_one_more():
    """A scalar that multiplies R adds one degree of freedom."""
    assert count("(2 + phi)*R - X", "riemannian", dimension=3, scalars="phi").number == 1


def test_f_of_t_in_three_dimensions():
    """f(T) and a scalar field where dT does not vanish: 2 + 1 of them."""
    answer = count("T + c*T**2 + X/2", "teleparallel", dimension=3, near=UNIVERSE,
                   scalars={"phi": "log(1 + t)"}, parameters={"c": 0.1})  # fmt: skip
    assert answer.settled, answer.reason
    assert answer.number == 3
    assert answer.branch == ()
    assert sum(m for m, _ in answer.gauge) == 3


@pytest.mark.slow
def test_f_of_t_in_the_vacuum():
    """The coupling of the scalar is turned off step by step: f(T) has 2."""
    options: Any = {"dimension": 3, "scalars": {"phi": "log(1 + t)"}, "constants": "s"}
    near: Any = UNIVERSE
    for s in (1, 0.5, 0):
        near = count("T + c*T**2 + s*X/2", "teleparallel", near=near,
                     parameters={"c": 0.1, "s": s}, **options)  # fmt: skip
    # The scalar without a coupling is a function of all coordinates, and no known gauge.
    assert not near.settled
    alone = count("T + c*T**2", "teleparallel", dimension=3, near=near, parameters={"c": 0.1})
    assert alone.settled, alone.reason
    assert alone.number == 2
    assert alone.branch == ()


@pytest.mark.slow
def test_a_start_in_flat_space_falls_on_another_branch():
    """From flat space T is constant on the solution of f(T), and no number is guessed."""
    answer = count("T + c*T**2", "teleparallel", dimension=3, parameters={"c": 0.3})
    assert not answer.settled
    assert answer.number is None
    assert answer.branch == ("T",)
    assert re.search("gradient of T vanishes|ranks are not sure", answer.reason)


def test_equal_calls_give_equal_bits():
    """Two calls give the same solution to the bit; another seed gives the same count."""
    one, two = (count("-F2/4", "flat", dimension=3, vectors=1) for _ in range(2))
    assert all(one.fields[x].tobytes() == two.fields[x].tobytes() for x in one.fields)
    other = count("-F2/4", "flat", dimension=3, vectors=1, seed=1)
    assert not np.array_equal(other.fields["A 0 0"], one.fields["A 0 0"])
    assert other.number == one.number


def test_an_earlier_answer_is_a_start():
    """A mass turned on step by step: Maxwell's count becomes Proca's."""
    massless = count("-F2/4", "flat", dimension=3, vectors=1)
    massive = count("-F2/4 - A2/2", "flat", dimension=3, vectors=1, near=massless, invariants=A2)
    assert (massless.number, massive.number) == (1, 2)


@pytest.mark.slow
def test_f_of_r_has_one_more():
    """R + c R^2 in three dimensions: one degree of freedom, at order nine."""
    answer = count("R + c*R**2", "riemannian", dimension=3, parameters={"c": 0.3}, order=9)
    assert answer.number == 1


@pytest.mark.slow
def test_new_general_relativity_in_three_dimensions():
    """All three terms: nine components less three gauge functions twice; T + c v^2: two."""
    answer = count("a*T1 + b*T2 + c*T3", "teleparallel", dimension=3, order=6)
    assert answer.number == 3
    assert answer.gauge == ((3, 1),)
    assert count("T + c*vector2", "teleparallel", dimension=3, order=7).number == 2


@pytest.mark.slow
@pytest.mark.parametrize("order", [5, 6, 7])
def test_f_of_q_is_not_settled(order: int):
    """Numbers of f(Q) fall at each order: no count, also where the last differences agree."""
    answer = count("Q + c*Q**2 + X/2", "symmetric teleparallel", dimension=3, near=UNIVERSE,
                   scalars={"phi": "log(1 + t)"}, parameters={"c": 0.1}, order=order)  # fmt: skip
    assert answer.number is None
    assert answer.reason


def test_an_order_more_where_the_count_is_not_settled():
    """Proca's hidden constraint shows at one order more than the fields of Maxwell."""
    answer = count("-F2/4 - A2/2", "flat", dimension=3, vectors=1, invariants=A2)
    assert (answer.number, answer.order) == (2, 6)
    early = count("-F2/4 - A2/2", "flat", dimension=3, vectors=1, invariants=A2, order=5)
    assert early.number is None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("lagrangian", "geometry", "options", "number"),
    [
        ("R", "riemannian", {}, 2),
        ("Q", "symmetric teleparallel", {}, 2),
        ("T", "teleparallel", {}, 2),
        ("(2 + phi)*R - X", "riemannian", {"scalars": "phi"}, 3),
        ("a*T1 + b*T2 + c*T3", "teleparallel", {}, 8),
    ],
)
def test_gravity_in_four_dimensions(
    lagrangian: str, geometry: str, options: dict[str, Any], number: int
):
    """General relativity in both forms 2, Brans and Dicke 2 + 1, new general relativity 8."""
    assert count(lagrangian, geometry, dimension=4, **options).number == number


wrong: Any = count
OTHER = gt.Frame("t x", [[1, 0], [0, 1]], "-+")
REFUSALS = [
    (lambda: count("T", "cartan"), "geometry: expected one of"),
    (lambda: count("T", "teleparallel", dimension=5), "dimension"),
    (lambda: count("T", "teleparallel", dimension=3, near=OTHER), "one of 2"),
    (lambda: wrong("T", "teleparallel", dimension=3, near=3), "near"),
    (lambda: count("T", "riemannian", dimension=3), "T, which vanishes"),
    (lambda: count("f(T)", "teleparallel", dimension=2), "unknown function f"),
    (lambda: count("-X/2", "flat", dimension=3), "matter field"),
    (lambda: count("R", "riemannian", dimension=3, parameters={"c": 1}), "a constant of L"),
    (lambda: count("-X/2", "flat", dimension=2, scalars="phi", order=2), "order"),
    (lambda: count("-X/2", "flat", dimension=2, scalars="phi", seed=-1), "seed"),
    (lambda: wrong("-X/2", "flat", dimension=2, scalars={"phi": "log(t)"}), "zero|finite|positive"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_refusals(call: Any, words: str):
    """The message of each wrong call names the expected value."""
    with pytest.raises(GeomtorsionError, match=words):
        call()


@pytest.mark.parametrize(
    ("lagrangian", "geometry", "dimension", "words"),
    [
        ("0", "flat", 2, "expected a matter field"),
        ("0", "riemannian", 3, "zero for every field"),
        ("R", "riemannian", 2, "zero for every field"),
        ("T", "teleparallel", 2, "zero for every field"),
        ("1", "riemannian", 3, "a number that is not zero"),
        ("P1", "riemannian", 3, "zero for every field"),
        ("GB", "riemannian", 4, "zero for every field"),
    ],
)
def test_no_equations(lagrangian, geometry, dimension, words):
    """Nothing, a topological term and a bare constant are refused in words."""
    with pytest.raises(GeomtorsionError, match=words):
        count(lagrangian, geometry, dimension=dimension)


@pytest.mark.parametrize("lagrangian", few(1, ["R/10**20", "10**20*R", "c*R"]))
def test_the_unit_of_the_action_does_not_count(lagrangian: str):
    """A factor of the Lagrangian changes no solution."""
    values = {"c": "1e-30"} if "c" in lagrangian else None
    answer = count(lagrangian, dimension=3, parameters=values)
    assert (answer.number, answer.numbers) == (0, count("R", dimension=3).numbers)


@pytest.mark.parametrize(
    ("lagrangian", "options", "number"),
    [
        # A constant electric field is a number, no function.
        ("-F2/4", {"vectors": 1}, 0),
        ("-X/2", {"scalars": "phi"}, 1),
        # Jackiw and Teitelboim, and f(R), which is a dilaton with a potential.
        ("phi*R", {"scalars": "phi"}, 0),
        ("R + c*R**2", {}, 0),
        ("Q", {"dimension": 3}, 0),
        pytest.param("R + c*R**2", {"dimension": 3}, 1, marks=pytest.mark.slow),
        # New massive gravity: Bergshoeff, Hohm and Townsend (2009).
        pytest.param("-R + R4 - 3*R6/8", {"dimension": 3}, 2, marks=pytest.mark.slow),
    ],
)
def test_without_a_geometry(lagrangian: str, options: dict[str, Any], number: int):
    """Known counts, with the geometry that the Lagrangian names."""
    every: dict[str, Any] = {"dimension": 2} | options
    answer = count(lagrangian, **every)
    assert answer.settled, answer.reason
    assert answer.number == number

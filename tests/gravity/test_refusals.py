"""Refusals of gravity: each call, the class of its error, and words of its message."""

from collections.abc import Callable
from typing import Any

import pytest

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError, GravityError, StartError
from tests.gravity.test_stars import star

# Without types, for calls that are wrong on purpose.
wrong: Any = g
HOLE = gt.spaces.load("schwarzschild").frame
RHO = {"rho0": 1}
FLAT = gt.Frame([*"txyz"], [[int(i == j) for j in range(4)] for i in range(4)], (-1, 1, 1, 1))
COSMOS = gt.spaces.load("frw_flat").frame
DUST = g.fluid("rho(t)", 0, [1, 0, 0, 0])
UNIVERSE = g.equations(gt.levi_civita(COSMOS), "R/2 - Lambda", DUST)
NUMBERS = {"start": {"a": 1, "rho": 3}, "parameters": {"Lambda": 0}, "near": {"a_1": 1}}
NO_MAPPINGS: tuple[Any, ...] = (3, "Lambda", [1], ["a"], b"x")


def begin(density: str, start: dict[str, Any], values: dict[str, Any]) -> object:
    """The centre of a star of a density."""
    return star(density).begin(start, values)


REFUSALS = [
    (lambda: g.inertial(HOLE, {"M": 1}), GravityError, "make the metric flat"),
    (lambda: wrong.inertial(3, {}), GravityError, "expected a"),
    (lambda: g.newman_penrose(gt.spaces.load("kerr").frame),
     GeomtorsionError, "expected a null tetrad"),
    (lambda: g.newman_penrose(gt.spaces.load("s2").frame),
     GeomtorsionError, "expected a null tetrad"),
    (lambda: g.equations(gt.levi_civita(HOLE), "R - X/2 - phi**2", g.scalar_field("u(r)")),
     GravityError, r"scalar_field\(..., name='chi'\)"),
    *((lambda name=name: wrong.scalar_field("u(t)", name=name),
       GravityError, "name: expected a") for name in ["R", "X", "a b", "sin", "Rbar", 3, ""]),
    (lambda: begin("rho0", {"p": 1, "A": 1}, RHO), StartError, "got B = -1 or 1"),
    (lambda: begin("rho0", {"p": 1, "A": 1, "B": 2}, RHO), StartError, "Omit one of the values"),
    (lambda: begin("rho0", {"p": 1, "A": 1, "B": 1}, {}), StartError, "got none for rho0"),
    (lambda: begin("rho0*exp(-1/r)", {"p": 1, "A": 1, "B": 1}, RHO),
     GeomtorsionError, "got a function with a pole"),
    (lambda: begin("sqrt(p(r)/K) + p(r)", {"p": 0, "A": 1, "B": 1}, {"K": 1}),
     GeomtorsionError, "got a root, a logarithm or a quotient at zero"),
    # Invariants that a kind of connection never has, with another kind that has them.
    *((lambda text=text, make=make: g.equations(make(COSMOS), text), GravityError, words)
      for make, text, words in [
        (gt.levi_civita, "T + c*T**2", "T, which vanishes for every Levi-Civita.*gt.cartan"),
        (gt.levi_civita, "f(T)", "T, which vanishes for every Levi-Civita.*gt.cartan"),
        (gt.levi_civita, "tensor2 - axial2", "vanishes for every Levi-Civita.*with torsion"),
        (gt.levi_civita, "Q", "Q, which vanishes for every Levi-Civita.*gt.from_coefficients"),
        (gt.levi_civita, "U1", "U1, which vanishes for every Levi-Civita"),
        (gt.levi_civita, "holst", "holst, which vanishes for every Levi-Civita.*torsion"),
        (gt.levi_civita, "P3 + R7", "which vanishes for every Levi-Civita"),
        (gt.cartan, "R4 - 2*Lambda", "R4, which vanishes for every Cartan.*gt.levi_civita"),
        (gt.cartan, "GB", "GB, which vanishes for every Cartan.*gt.levi_civita"),
        (gt.cartan, "Q1", "Q1, which vanishes for every Cartan.*gt.from_coefficients"),
    ]),
    # Functions without a value at zero.
    (lambda: g.equations(gt.cartan(FLAT), "sqrt(T)").E[0, 0],
     GravityError, r"got 1/sqrt\(T\) at T = 0"),
    (lambda: g.equations(gt.levi_civita(HOLE), "sqrt(R)").E[0, 0],
     GravityError, r"got 1/sqrt\(R\) at R = 0"),
    (lambda: g.equations(gt.levi_civita(HOLE), "R + c*R*log(R/b)", constants="b").L[()],
     GravityError, r"got log\(R/b\) at R/b = 0"),
    (lambda: g.equations(gt.cartan(FLAT), "exp(1/T)").L[()], GravityError, "got 1/T at T = 0"),
    # Numbers by names.
    *((lambda key=key, value=value: wrong.solve(
        UNIVERSE, "t", 1, **{**NUMBERS, key: value}),
       GeomtorsionError, f"{key}: expected names with values")
      for key in ("start", "parameters", "near", "outputs") for value in NO_MAPPINGS),
    *((lambda key=key, value=value: wrong.shoot(
        UNIVERSE, "t", 1, **{**NUMBERS, key: value}, free=["a"], boundary={"a": 2}),
       GeomtorsionError, f"{key}: expected names with values")
      for key in ("start", "parameters", "near", "outputs") for value in NO_MAPPINGS),
]  # fmt: skip


def test_a_term_that_vanishes_for_the_connection_is_named() -> None:
    """The rest of the Lagrangian has equations; the printed object names the other term."""
    equations = g.equations(gt.levi_civita(COSMOS), "R + c*T")
    assert repr(equations).endswith("T vanishes for every Levi-Civita connection")
    # Nieh and Yan's density is a square of torsion for parallel legs, and belongs to no list.
    assert "vanishes" not in repr(g.equations(gt.cartan(COSMOS), "nieh_yan"))
    both = g.equations([gt.cartan(COSMOS), gt.levi_civita(COSMOS)], "T + Rbar + Tbar")
    assert repr(both).endswith("; Tbar vanishes for every Levi-Civita connection")
    # Any cosmos would solve "general relativity" of parallel legs, which have no curvature.
    empty = g.equations(gt.cartan(COSMOS), "R")
    assert empty.E.is_zero
    assert "; R vanishes for every Cartan connection" in str(empty)
    assert "vanishes" not in repr(g.equations(gt.levi_civita(COSMOS), "R"))


@pytest.mark.parametrize(("call", "error", "words"), REFUSALS)
def test_bad_calls_are_refused(
    call: Callable[[], object], error: type[Exception], words: str
) -> None:
    """Each bad argument has an error of its own class, which names the mistake."""
    with pytest.raises(error, match=words):
        call()

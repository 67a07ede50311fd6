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
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSALS)
def test_bad_calls_are_refused(
    call: Callable[[], object], error: type[Exception], words: str
) -> None:
    """Each bad argument has an error of its own class, which names the mistake."""
    with pytest.raises(error, match=words):
        call()

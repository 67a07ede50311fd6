"""Invariance: numbers of free functions as published, Lie derivatives, and refusals."""

# Bad input.
# pyright: reportArgumentType=false

import re
from collections.abc import Iterable
from typing import Any

import pytest
import sympy as sp
from sympy.core.function import AppliedUndef

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError

t, r, theta, phi, x, y, z = sp.symbols("t r theta phi x y z")
FLAT = gt.Frame([t, x, y, z], sp.eye(4), "-+++")
ROTATIONS = [[0, 0, z, -y], [0, z, 0, -x]]
TURNS = [
    [0, 0, sp.sin(phi), sp.cos(phi) * sp.cos(theta) / sp.sin(theta)],
    [0, 0, sp.cos(phi), -sp.sin(phi) * sp.cos(theta) / sp.sin(theta)],
]
A, B = (sp.Function(name)(t, r) for name in "AB")
BALL = gt.Frame([t, r, theta, phi], sp.diag(A, B, r, r * sp.sin(theta)), "-+++")
ROWS = [[A, B, 0, 0], [0, 1, 0, 0], [0, 0, r, 0], [0, 0, 0, r * sp.sin(theta)]]
SHEARED = gt.Frame([t, r, theta, phi], ROWS, "-+++")
# A plane in other coordinates, in which two of its three symmetries have no closed form.
FIFTH_POWER = gt.Frame([y, z], sp.eye(2) * 5 * (y**2 + z**2) ** 2)
# Two translations and a screw: no point stays fixed, and no leg either.
SCREW = [[0, 0, 1, 0], [0, 0, 0, 1], [0, 1, -z, y]]


def shipped(name: str) -> gt.Frame:
    """The frame of a shipped space."""
    return gt.spaces.load(name).frame


# Frame, vectors, functions of torsion and of a connection: Tsamparlis (1979) and Hohmann (2020)
# for cosmology and spheres; n^2 (n - 1)/2 and n^3 where no point stays fixed.
KNOWN = {
    "flat universe": (shipped("frw_flat"), None, 2, 5),
    "curved universe": (shipped("frw"), None, 2, 5),
    "static sphere": (shipped("schwarzschild"), None, 8, 20),
    "static sphere, Cartesian legs": (shipped("schwarzschild_cartesian"), None, 8, 20),
    "sphere": (BALL, TURNS, 8, 20),
    "sphere, legs that are not orthogonal to the orbits": (SHEARED, TURNS, 8, 20),
    "sphere in Cartesian coordinates": (FLAT, ROTATIONS, 8, 20),
    "axis and time": (shipped("kerr"), None, 24, 64),
    "screw": (FLAT, SCREW, 24, 64),
    "Goedel": (shipped("goedel"), None, 8, 20),
    "S3": (shipped("s3"), None, 1, 1),
}


def functions(values: Iterable[Any]) -> set:
    """The unknown functions or constants whose names begin with u."""
    atoms = {one for value in values for one in value.atoms(AppliedUndef, sp.Symbol)}
    return {one for one in atoms if re.fullmatch(r"u\d+(\(.*\))?", str(one))}


# Other tests have the sphere and the Cartesian legs.
DEAR = "static sphere, Cartesian legs"


@pytest.mark.parametrize(
    "name", [pytest.param(x, marks=[pytest.mark.slow] if x == DEAR else []) for x in KNOWN]
)
def test_published_numbers_of_functions(name: str) -> None:
    """As many functions as published, and all Lie derivatives of the result vanish."""
    frame, vectors, of_torsion, of_connection = KNOWN[name]
    every = g.symmetries(frame).vectors if vectors is None else vectors
    S = g.invariant_torsion(frame, vectors)
    assert len(functions(S.nonzero().values())) == of_torsion
    connection = g.invariant_connection(frame, vectors)
    assert len(functions(connection.coefficients.nonzero().values())) == of_connection
    for xi in every:
        assert gt.lie(xi, S).is_zero
        assert gt.lie(xi, connection).is_zero


def test_functions_of_invariant_coordinates() -> None:
    """The functions depend on coordinates that no vector changes, or are constants."""
    values = g.invariant_torsion(FLAT, ROTATIONS).nonzero().values()
    assert {one.args for one in functions(values)} == {(t, x**2 + y**2 + z**2)}
    [static] = {
        one.args for one in functions(g.invariant_torsion(shipped("kerr")).nonzero().values())
    }
    assert {str(one) for one in static} == {"r", "theta"}
    constants = functions(g.invariant_torsion(shipped("s3")).nonzero().values())
    assert constants == {sp.Symbol("u1")}


def test_torsion_of_a_cosmos() -> None:
    """A vector part along time and an axial part (Tsamparlis 1979), with any beginning of names."""
    frame = shipped("frw_flat")
    S = g.invariant_torsion(frame, name="w")
    one, two = (sp.Function(name)(frame.coordinates[0]) for name in ("w1", "w2"))
    assert {i: v for i, v in S.nonzero().items() if i[0] < i[1]} == {
        **{(0, k, k): one for k in (1, 2, 3)},
        (1, 2, 3): two,
        (1, 3, 2): -two,
        (2, 3, 1): two,
    }
    assert g.invariant_torsion(frame, name="w").nonzero() == S.nonzero()


def test_the_torsion_of_a_symmetric_tetrad_is_among_them() -> None:
    """Cartan's torsion of Cartesian legs is the invariant torsion with certain functions."""
    frame = shipped("schwarzschild_cartesian")
    S = g.invariant_torsion(frame)
    own = gt.cartan(frame).torsion.S.in_frame()
    every = sorted(functions(S.nonzero().values()), key=str)
    places = sorted({*S.nonzero(), *own.nonzero()})
    values = {"r": sp.Rational(7, 2), "theta": 1, "phi": 2, "M": 1}
    at = {
        one: values[one.name] for one in (*frame.coordinates, *frame.parameters) if one.name != "t"
    }
    rows = [[sp.N(S[p].diff(u).subs(at), 40) for u in every] for p in places]
    right = [sp.N(own[p].subs(at), 40) for p in places]
    matrix, vector = sp.Matrix(rows), sp.Matrix(right)
    solution = (matrix.T * matrix).LUsolve(matrix.T * vector)
    assert max(abs(one) for one in matrix * solution - vector) < 1e-30
    assert max(abs(one) for one in vector) > 0.01


def test_coframes_with_parallel_legs() -> None:
    """Six functions of a spherical tetrad and two of a cosmos (Hohmann et al. 2019)."""
    frame = g.invariant_coframe(FLAT, ROTATIONS)
    assert len(functions(frame.coframe.nonzero().values())) == 6
    for xi in ROTATIONS:
        assert gt.lie(xi, frame).is_zero
        assert gt.lie(xi, gt.cartan(frame)).is_zero
    cosmos = g.invariant_coframe(shipped("frw_flat"))
    assert len(functions(cosmos.coframe.nonzero().values())) == 2
    static = g.invariant_coframe(shipped("schwarzschild_cartesian"))
    assert len(functions(static.coframe.nonzero().values())) == 6
    assert g.symmetries(static, keep="teleparallel").dimension == 4


def test_all_cosmologies_of_a_theory() -> None:
    """Einstein and Cartan: without spin, the connection equation makes all torsion vanish."""
    frame = shipped("frw_flat")
    connection = gt.from_torsion(frame, g.invariant_torsion(frame))
    equations = g.equations(connection, "R")
    left = functions(equations.C.nonzero().values())
    assert len(left) == 2
    solved = sp.solve(list(equations.C.nonzero().values()), list(left), dict=True)
    assert solved == [dict.fromkeys(left, 0)]


REFUSED = {
    "not Killing": (lambda: g.invariant_torsion(FLAT, [[0, x, 0, 0]]), "got [0, x, 0, 0], along"),
    "legs that turn": (
        lambda: g.invariant_coframe(shipped("schwarzschild")),
        "expected legs that turn by one angle everywhere",
    ),
    "no vector": (lambda: g.invariant_torsion(FLAT, []), "expected at least one vector"),
    "no symmetry": (
        lambda: g.invariant_torsion(gt.Frame([x, y], [[1, x * y], [0, 1 + x**3 + y]])),
        "the frame has no symmetry that is found",
    ),
    "not all": (
        lambda: g.invariant_torsion(FIFTH_POWER),
        "expected all 3 Killing vectors in closed form, got 1",
    ),
    "a number": (lambda: g.invariant_torsion(FLAT, 3), "expected a list of vectors or"),
    "length": (lambda: g.invariant_torsion(FLAT, [[1, 0]]), "vector"),
    "another frame": (
        lambda: g.invariant_torsion(FLAT, [BALL.vector([1, 0, 0, 0])]),
        "expected vectors over the frame",
    ),
    "name": (lambda: g.invariant_torsion(FLAT, ROTATIONS, "1"), "expected the beginning of new"),
    "taken": (
        lambda: g.invariant_torsion(
            gt.Frame([t, x], sp.diag(1, sp.Function("u1")(t)), "-+"), [[0, 1]]
        ),
        "Give another: name='w'",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_calls_are_refused(case: str) -> None:
    """Each refusal is an error of this package and names the expectation or the remedy."""
    call, words = REFUSED[case]
    with pytest.raises(GeomtorsionError, match=re.escape(words)):
        call()

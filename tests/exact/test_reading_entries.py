"""Entries: symbols of the same name mean the same, in each run of Python."""

import os
import subprocess
import sys
import textwrap

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import CoordinateError, GeomtorsionError

r, twin = sp.Symbol("r"), sp.Symbol("r", positive=True)
phi = sp.Symbol("phi")
M, twin_of_M = sp.Symbol("M"), sp.Symbol("M", positive=True)
PLANE = gt.Frame([r, phi], [[1, 0], [0, r]])


@pytest.mark.parametrize(
    "frame",
    [
        lambda: gt.Frame([r, phi], [[1, 0], [0, twin]]),
        lambda: gt.Frame([r, phi], [[1, 0], [0, (r + twin) / 2]]),
        lambda: gt.Frame([r, phi], [[1, 0], [0, twin]], domain=[twin > 0]),
        lambda: gt.Frame.from_metric([r, phi], [[1, 0], [0, twin * r]], domain=[twin > 0]),
        lambda: gt.Frame.from_frame([r, phi], [[1, 0], [0, 1 / twin]]),
        lambda: gt.Frame([r, phi], [[1, 0], [0, sp.Function("f")(twin)]]),
        lambda: gt.Frame([r, phi], [[1, 0], [0, sp.sqrt(r**2 + twin**2)]]),
    ],
    ids=["entry", "both", "domain", "from_metric", "from_frame", "function", "root"],
)
def test_a_twin_counts_as_the_coordinate(frame):
    """A symbol with the name of a coordinate is the coordinate, also in derivatives."""
    made = frame()
    assert made.coordinates == (r, phi)
    assert not made.parameters
    gamma = gt.levi_civita(made).coefficients
    size = made.metric[1, 1]
    assert sp.simplify(gamma[1, 1, 0] + sp.diff(size, r) / 2) == 0
    assert gamma[1, 1, 0] != 0


@pytest.mark.parametrize(
    "call",
    [
        lambda: gt.Frame([r, phi], [[1, 0], [0, r * M + twin_of_M]]),
        lambda: gt.Frame([r, phi], [[1, 0], [0, r * M]], domain=[r > twin_of_M]),
        lambda: gt.Frame("M phi", [[1, 0], [0, M * twin_of_M]]),
        lambda: gt.Frame([r, phi], [[1, 0], [0, r]], parameters=[M, twin_of_M]),
        lambda: gt.Frame.from_metric([r, phi], [[M, 0], [0, twin_of_M]]),
        lambda: gt.Frame.from_structure_constants(
            [[[0, 0], [0, M + 2 * twin_of_M]], [[0, -M - 2 * twin_of_M], [0, 0]]]
        ),
        lambda: gt.from_coefficients(PLANE, [[[M, 0], [0, 0]], [[0, twin_of_M], [0, 0]]]),
        lambda: gt.Loop.parametric([M * sp.cos(r), twin_of_M * sp.sin(r)], r, (0, 2 * sp.pi)),
        lambda: gt.Loop.circle([M, 0], twin_of_M),
        lambda: gt.equations_of_motion(PLANE, M * sp.Symbol("u1") ** 2 + twin_of_M),
    ],
    ids=["entries", "domain", "text", "parameters", "from_metric", "constants", "connection",
         "curve", "circle", "lagrangian"],
)  # fmt: skip
def test_twins_that_nobody_declared_are_refused(call):
    """Two symbols of one name that nobody declared are refused; both are named with assumptions."""
    with pytest.raises(
        GeomtorsionError,
        match=r"called M: Symbol\('M'\) and Symbol\('M', positive=True\)\. Create the symbol once",
    ):
        call()


def test_a_declared_parameter_is_meant():
    """With a declared parameter, each symbol of its name is the parameter."""
    frame = gt.Frame([r, phi], [[1, 0], [0, r * M + twin_of_M]], parameters=[M])
    assert frame.parameters == (M,)
    assert sp.expand(frame.coframe[1, 1]) == M * r + M


def test_connections_loops_and_numbers():
    """Connections, points, loops and curves match symbols to the frame by name."""
    frame = gt.Frame([r, phi], [[1, 0], [0, M * r]])
    gamma = gt.from_coefficients(frame, [[[twin, 0], [0, 0]], [[0, 0], [0, twin_of_M]]])
    assert gamma.coefficients[0, 0, 0].diff(r) == 1
    assert gamma.coefficients[1, 1, 1] == M
    assert frame.metric.at({twin: 2, phi: 0, twin_of_M: 3})[1, 1] == 36
    loop = gt.Loop.circle([2, 0], 0.5)
    one = gt.burgers_vector(frame, loop, parameters={M: 2})
    assert (gt.burgers_vector(frame, loop, parameters={twin_of_M: 2}).vector == one.vector).all()
    curve = gt.Loop.parametric([sp.cos(r), sp.sin(twin)], r, (0, 2 * sp.pi))
    assert abs(curve.area[0, 1] - sp.pi) < 1e-12


@pytest.mark.parametrize(
    "call",
    [
        lambda table: PLANE.metric.at({**table, phi: 0}),
        lambda table: gt.burgers_vector(PLANE, gt.Loop.circle([2, 0], 1), parameters=table),
        lambda table: gt.geodesic(PLANE, [1, 0], [0, 1], parameters=table),
        lambda table: gt.Loop.circle([2, 0], r).at(table),
    ],
    ids=["at", "burgers_vector", "geodesic", "loop"],
)
def test_two_values_for_one_name_are_refused(call):
    """The error names both keys."""
    with pytest.raises(
        GeomtorsionError, match=r"expected r once, got 'r' and Symbol\('r', positive"
    ):
        call({"r": 2, twin: 2})
    with pytest.raises(
        GeomtorsionError, match=r"expected r once, got Symbol\('r'\) and Symbol\('r', p"
    ):
        call({r: 2, twin: 3})


SCRIPT = """
    import sympy as sp
    import geomtorsion as gt

    r, twin, M, other, phi = sp.Symbol("r"), sp.Symbol("r", real=True), *sp.symbols("M q phi")
    for coframe, more in (
        ([[1, 0], [0, twin]], {}),
        ([[1, 0], [0, r * twin + M]], {}),
        ([[M, 0], [0, sp.Symbol("M", real=True)]], {}),
        ([[M, 0], [0, sp.Symbol("M", real=True)]], {"parameters": [M]}),
        ([[1, 0], [0, r]], {"domain": [twin > 0, sp.Symbol("r", positive=True) < 5]}),
        ([[1, 0], [0, sp.Symbol("r", positive=True) * twin]], {}),
    ):
        try:
            frame = gt.Frame([r, phi], coframe, **more)
            print(frame, gt.levi_civita(frame).coefficients, frame.domain)
        except gt.GeomtorsionError as error:
            print(error)
"""


def test_every_run_gives_the_same_text():
    """Messages and results do not depend on the order of sets, which differs from run to run."""
    answers = set()
    for seed in range(3):
        done = subprocess.run(
            [sys.executable, "-c", textwrap.dedent(SCRIPT)],
            env={**os.environ, "PYTHONHASHSEED": str(seed)},
            capture_output=True, text=True, check=True, timeout=120,
        )  # fmt: skip
        answers.add(done.stdout)
    (answer,) = answers
    assert "called M: Symbol('M') and Symbol('M', real=True)" in answer
    assert answer.count("Levi-Civita") == 5


def test_a_repeated_coordinate_is_refused():
    """A symbol of the same name cannot be a second coordinate."""
    with pytest.raises(CoordinateError, match="coordinate r is repeated"):
        gt.Frame([r, twin], [[1, 0], [0, 1]])

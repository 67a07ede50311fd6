"""Settled: digits are right beside removable singularities and zeros; other points stay."""

# Bad input, and results that may be None.
# pyright: reportArgumentType=false

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation

from geomtorsion import numpy_function
from geomtorsion.codegen import graph
from geomtorsion.codegen.arrays import BLOCK, Settled
from geomtorsion.errors import SingularPointError
from geomtorsion.exact import Field
from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.spaces import load
from tests.rounding import ROUNDED

A = sp.symbols("a1:4", real=True)


def rotation_vector_frame():
    """Body axes of rotations over rotation vectors; each coefficient is regular at a = 0."""
    w = sp.sqrt(sum(x**2 for x in A))
    row, (x, y, z) = sp.Matrix(A), A
    turn = sp.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    long = row * row.T * (w - sp.sin(w)) / w**3
    return Frame(A, (sp.eye(3) * sp.sin(w) / w - turn * (1 - sp.cos(w)) / w**2 + long).tolist())


FRAME = rotation_vector_frame()
DIRECTION = np.array([0.6, 0.5, -0.62])
SIZES = [1.0, 0.3, 3e-2, 3e-4, 1e-6, 3e-8, 1e-14, 1e-20, 1e-40]


def test_the_connection_at_small_rotations():
    """Gamma_12^3 of this frame is -1/2 + O(a); cancellation once gave -1.4e14 at 3e-8."""
    element = cartan(FRAME).coefficients.element(0, 1, 2)
    found = numpy_function([element], A)(*(DIRECTION[:, None] * np.array(SIZES)))[0]
    for size, value in zip(SIZES, found, strict=True):
        point = dict(zip(A, (DIRECTION * size).tolist(), strict=True))
        assert value == pytest.approx(float(element.evaluate(point, 100)), rel=1e-12)
    assert found[-1] == -0.5


@pytest.mark.parametrize("size", SIZES)
def test_every_coefficient_at_random_points(size):
    """Each component of the Levi-Civita connection agrees with exact evaluation."""
    elements = list(levi_civita(FRAME).coefficients.components.independent.values())
    points = np.random.default_rng(7).uniform(-size, size, (3, 4))
    found = numpy_function(elements, A)(*points)
    for k, element in enumerate(elements):
        for j in range(4):
            exact = element.evaluate(dict(zip(A, points[:, j].tolist(), strict=True)), 100)
            assert found[k, j] == pytest.approx(float(exact), rel=1e-12, abs=0)


def test_the_coframe_turns_vectors_of_rotations():
    """Agreement with SciPy's rotations: R(a)^T R(a + da) = 1 + e^i_mu da^mu to first order."""
    function = numpy_function(list(FRAME.coframe.components.independent.values()), A)
    for size in (1.0, 1e-5):
        matrix = np.reshape(function(*(DIRECTION * size)), (3, 3))
        for mu in range(3):
            step = np.eye(3)[mu] * 1e-6
            ends = [Rotation.from_rotvec(DIRECTION * size + sign * step) for sign in (1, -1)]
            turn = (ends[1].inv() * ends[0]).as_rotvec() / 2e-6
            assert matrix[:, mu] == pytest.approx(turn, abs=1e-9)


def test_zeros_of_a_polynomial():
    """Values are right beside a zero, where terms cancel, and on it; also in large grids."""
    x = sp.Symbol("x")
    function = numpy_function(
        [Field([x]).read(x**3 - 3 * x**2 + 3 * x - 1), Field([x]).read(x)], [x]
    )
    steps = np.array([2.0**-k for k in range(3, 50)] + [0.0])
    found = function(1 + steps)
    assert (found[0] == steps**3).all()
    assert (found[1] == 1 + steps).all()
    grid = np.linspace(0.9, 1.1, 40000).reshape(200, 200)
    assert function(grid)[0] == pytest.approx((grid - 1) ** 3, rel=1e-9, abs=0)
    assert float(function(1.0)[0]) == 0.0


def test_functions_of_two_arguments_and_roots():
    """Each kind of step with an argument that lost digits agrees with 100 bits."""
    x, y = sp.symbols("x y", positive=True)
    small = (1 + x) ** 2 - 1 - 2 * x
    expressions = [
        sp.atan2(small, y), sp.sqrt(small), small ** sp.Rational(1, 3), sp.log(1 + small),
        sp.exp(small) - 1, sp.sin(small) / y, small / (x * y), sp.cosh(small) - 1,
        sp.tan(small) * y,
    ]  # fmt: skip
    field = Field([x, y])
    elements = [field.read(expression) for expression in expressions]
    points = np.array([[1e-3, 1e-5, 1e-7, 0.3], [0.7, 1e-3, 2.0, 0.2]])
    found = numpy_function(elements, [x, y])(*points)
    for k, element in enumerate(elements):
        for j, (one, two) in enumerate(points.T.tolist()):
            exact = float(element.evaluate({x: one, y: two}, 100))
            assert found[k, j] == pytest.approx(exact, rel=1e-12, abs=0), expressions[k]


def test_complex_values_are_right_too():
    """exp(i x) - 1 - i x has twelve right digits near zero."""
    x = sp.Symbol("x", real=True)
    element = Field([x], complex=True).read(sp.exp(sp.I * x) - 1 - sp.I * x)
    for value in (1.0, 1e-4, 1e-9):
        exact = complex(element.evaluate({x: value}, 100))
        found = complex(numpy_function([element], [x])(value)[0])
        assert abs(found - exact) <= 1e-12 * abs(exact)


def test_poles_are_named_by_the_check_and_infinite_without_it():
    """A pole is named, a removable singularity is not; without the check inf is returned."""
    x = sp.Symbol("x")
    elements = [Field([x]).read((1 - sp.cos(x)) / x**2), Field([x]).read(1 / (x - 2))]
    function = numpy_function(elements, [x])
    assert function(np.array([1e-9, 1.0]))[0] == pytest.approx([0.5, 1 - np.cos(1)], rel=1e-12)
    with pytest.raises(SingularPointError, match="x = 2"):
        function(np.array([1e-9, 2.0]))
    loose = numpy_function(elements, [x], check=False)
    assert np.isinf(loose(2.0)[1])
    assert loose(1e-9)[0] == 0.0


def test_most_points_are_left_as_they_are():
    """At ordinary points Kerr's curvature is not evaluated again: error bounds are tight."""
    frame = load("kerr").frame
    elements = list(levi_civita(frame).curvature.riemann.components.independent.values())
    names = [symbol.name for symbol in frame.field.symbols]
    rng = np.random.default_rng(3)
    table = {
        "t": np.zeros(5000), "phi": np.zeros(5000), "r": rng.uniform(3, 20, 5000),
        "theta": rng.uniform(0.1, 3.0, 5000), "M": 1.0, "a": 0.6,
    }  # fmt: skip
    points = [table[name] for name in names]
    function = numpy_function(elements, frame.field.symbols)
    loose = numpy_function(elements, frame.field.symbols, check=False)
    found, plain = function(*points), loose(*points)
    assert (found == plain).mean() > 0.999
    np.testing.assert_allclose(plain, found, rtol=1e-9, atol=ROUNDED)


def test_more_points_than_a_block_holds():
    """Points evaluated together have the same bits as the same points in small groups."""
    x, y = sp.symbols("x y")
    function = Settled(graph(["x", "y"], [x**2 - y, sp.sin(x) * y]))
    points = np.random.default_rng(4).normal(size=(2, 3 * BLOCK + 5))
    values, doubtful = function(*points)
    for first in (0, BLOCK - 3, 3 * BLOCK - 2):
        part = slice(first, first + 7)
        again, others = function(*points[:, part])
        assert (again == values[:, part]).all()
        assert (others == doubtful[:, part]).all()

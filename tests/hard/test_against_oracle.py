"""Every exact quantity agrees with the floating-point oracle: shipped spaces and random frames."""

from __future__ import annotations

from functools import cache
from itertools import product

import mpmath
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import geomtorsion as gt
from geomtorsion.geometry.quantities import FRAME_QUANTITIES
from tests.chosen import few
from tests.differences import DIGITS, agrees
from tests.hard.support import numbers, oracle_of, quick, values_at
from tests.strategies import COORDINATES, F, coframes, k

# Quantity of the package -> attribute of the oracle, for the frame and its two connections.
OF_FRAME = {
    "coframe": "e",
    "legs": "legs",
    "metric": "metric",
    "inverse_metric": "inverse_metric",
    "determinant": "determinant",
    "anholonomy": "anholonomy",
    "cartan_connection": "gamma",
    "christoffel": "christoffel",
    "torsion": "torsion",
    "torsion_T": "torsion_whole",
    "torsion_vector": "torsion_vector",
    "torsion_axial": "torsion_axial",
    "torsion_tensor": "torsion_tensor",
    "torsion_scalar": "torsion_scalar",
    "superpotential": "superpotential",
    "torsion_force": "force_coefficients",
    "spin_connection": "metric_spin_connection",
    "contortion": "contortion",
    "cartan_curvature": "curvature",
    "ricci": "ricci",
    "riemann": "riemann",
    "riemann_frame": "riemann_in_frame",
    "scalar_curvature": "scalar",
    "einstein": "einstein",
    "weyl": "weyl",
    "schouten": "schouten",
    "kretschmann": "kretschmann",
}


def compare(
    frame: gt.Frame,
    values: dict,
    quantities: dict[str, str] = OF_FRAME,
    written: bool = False,
) -> list[str]:
    """Names of the quantities that differ from the oracle's at the point."""
    oracle = oracle_of(frame, values)
    wrong = []
    for name, attribute in quantities.items():
        if name in ("weyl", "schouten") and frame.dimension < 3:
            continue
        exact = numbers(frame.quantity(name), values, written)
        with mpmath.workdps(30):
            if not agrees(exact, getattr(oracle, attribute), 1e-15):
                wrong.append(name)
    return wrong


def point_of(frame: gt.Frame) -> dict:
    """The frame's own sample point as exact numbers."""
    return {s: sp.Rational(v) for s, v in frame.sample_point.items()}


# S^7 takes a second; in the normal run the laws of all shipped spaces cover it.
@pytest.mark.parametrize(
    "name",
    [
        *few(20, [x for x in gt.spaces.names() if x != "s7"]),
        pytest.param("s7", marks=pytest.mark.slow),
    ],
)
def test_shipped_spaces(name):
    """Every shipped space agrees with the oracle in every quantity (S^7: without Riemann's)."""
    frame = gt.spaces.load(name).frame
    heavy = {"riemann", "riemann_frame", "weyl", "kretschmann", "cartan_curvature", "einstein"}
    chosen = {q: a for q, a in OF_FRAME.items() if frame.dimension < 6 or q not in heavy}
    assert compare(frame, point_of(frame), chosen, written=True) == []


def test_every_space_and_quantity_is_compared():
    """The comparison covers all spaces and every named quantity."""
    assert len(gt.spaces.names()) >= 30
    # Cotton's tensor takes third differences: tests/geometry/test_forms compares it.
    assert OF_FRAME.keys() | {"cotton"} == FRAME_QUANTITIES.keys()


@quick
@given(coframes(2, 3), st.integers(2, 9))
def test_random_frames(case, seed):
    """Random frames without symmetry, two and three dimensions, both signatures."""
    coordinates, matrix, signature = case
    values = values_at(coordinates, seed)
    frame = gt.Frame(coordinates, matrix, signature=signature)
    assert compare(frame, values) == []


@cache
def frames_of_higher_dimension() -> dict[str, gt.Frame]:
    """Fixed frames in four and five dimensions with all kinds of entries."""
    x, y, z, u, v = COORDINATES
    four = [
        [1 + y**2, sp.sin(x), 0, 0],
        [0, sp.exp(z), k * u, 0],
        [0, 0, 1, sp.cos(x) * y],
        [0, 0, 0, 2 + sp.sin(2 * z)],
    ]
    five = [
        [1, 0, y, 0, 0],
        [0, 1 + x**2, 0, 0, u],
        [0, 0, 1, 0, 0],
        [0, z, 0, sp.cosh(v), 0],
        [0, 0, 0, 0, 2 + sp.sin(x)],
    ]
    unknown = [[F(x), 0, 0], [0, 1, F(y)], [0, 0, sp.sqrt(1 + F(x) ** 2)]]
    null = [[0, 1, 0, y], [1, 0, 0, 0], [0, x, 1, sp.I], [0, x, 1, -sp.I]]
    eta = [[0, -1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]]
    return {
        "four": gt.Frame([x, y, z, u], four, signature=(-1, 1, 1, 1)),
        "five": gt.Frame([x, y, z, u, v], five),
        "unknown": gt.Frame([x, y, z], unknown),
        "null": gt.Frame([x, y, z, u], null, signature=eta, complex=True),
        "metric": gt.Frame.from_metric(
            [x, y, z], [[2, x, 0], [x, 3 + y**2, sp.sin(z)], [0, sp.sin(z), 4]]
        ),
        "eta": gt.Frame([x, y], [[1, sp.sin(y)], [x, 2]], signature=[[2, 1], [1, 3]]),
        "legs": gt.Frame.from_frame([x, y], [[1, 0], [x * y, 1 + x**2]]),
    }


@pytest.mark.parametrize("name", ["four", "five", "unknown", "null", "metric", "eta", "legs"])
def test_fixed_frames(name):
    """Four and five dimensions, unknown functions, null legs, a metric, another eta."""
    frame = frames_of_higher_dimension()[name]
    heavy = {"riemann", "riemann_frame", "weyl"} if frame.dimension == 5 else set()
    chosen = {q: a for q, a in OF_FRAME.items() if q not in heavy}
    assert compare(frame, values_at(frame.coordinates, 5), chosen, name == "unknown") == []


def test_from_metric_has_the_metric():
    """The given metric is reproduced exactly."""
    frame = frames_of_higher_dimension()["metric"]
    x, y, z = frame.coordinates
    given_metric = [[2, x, 0], [x, 3 + y**2, sp.sin(z)], [0, sp.sin(z), 4]]
    for i, j in product(range(3), repeat=2):
        assert frame.metric.element(i, j) == frame.field.read(given_metric[i][j])


def test_torsion_force():
    """2 S_a^c_b q'^a q'^b agrees with the oracle, on a frame where it does not vanish."""
    frame = frames_of_higher_dimension()["four"]
    values = values_at(frame.coordinates, 5)
    velocity = [1, sp.Rational(-2, 3), 3, sp.Rational(1, 7)]
    exact = numbers(gt.cartan(frame).torsion.force(velocity), values)
    oracle = oracle_of(frame, values)
    with mpmath.workdps(DIGITS):
        wanted = oracle.force([mpmath.mpf(sp.Rational(v).p) / sp.Rational(v).q for v in velocity])
        assert agrees(exact, wanted, 1e-15)
        assert any(abs(x) > 0.01 for x in wanted)


def test_tensor_at_gives_floats():
    """.at(point) agrees with the oracle to double precision."""
    frame = frames_of_higher_dimension()["four"]
    values = values_at(frame.coordinates, 5)
    known = {s: v for s, v in values.items() if s in (*frame.coordinates, *frame.parameters)}
    found = gt.levi_civita(frame).curvature.ricci.at(known)
    exact = numbers(frame.quantity("ricci"), values)
    assert found.dtype == float
    assert agrees(found.astype(object), exact, 1e-13)

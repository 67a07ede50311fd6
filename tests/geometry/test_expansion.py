"""Expansion: frames in a small parameter agree with the series of the exact tensors."""

# Bad input, and sums that start with the number 0.
# pyright: reportAttributeAccessIssue=false, reportArgumentType=false

import pickle
from itertools import product

import mpmath
import pytest
import sympy as sp
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from tests.chosen import one_in
from tests.laws.frames import STRENGTH, entries

t, x, y, z, k = sp.symbols("t x y z k", real=True)
epsilon = sp.Symbol("epsilon", real=True)
Q = (t, x, y, z)
few = settings(
    max_examples=12,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def polynomial(tensor: gt.Tensor, order: int) -> dict:
    """Components of an exact tensor as series in epsilon, by sympy's derivatives."""
    found = {}
    for index, value in tensor.nonzero().items():
        terms = [
            value.diff(epsilon, j).subs(epsilon, 0) * epsilon**j / sp.factorial(j)
            for j in range(order + 1)
        ]
        total = tensor.frame.scalar(sp.Add(*terms))
        if not total.is_zero:
            found[index] = total
    return found


def agree(series: gt.Tensor, exact: gt.Tensor, order: int) -> None:
    """Each component of the truncated tensor is the truncated series of the exact component."""
    wanted = polynomial(exact, order)
    for index in product(range(series.frame.dimension), repeat=len(series.slots)):
        value = exact.frame.scalar(series[index])
        assert value == wanted.get(index, exact.frame.scalar(0)), index


QUANTITIES = ("inverse_metric", "christoffel", "torsion_T", "ricci", "scalar_curvature", "legs")
COFRAME = gt.Frame(
    [x, y],
    [[1, sp.sin(epsilon * x)], [epsilon**2, sp.sqrt(1 + epsilon * x) * k]],
)
METRIC = gt.Frame.from_metric(
    [t, x], [[-sp.exp(2 * epsilon * x), epsilon * t], [epsilon * t, 1 / (1 - epsilon * t)]]
)
LEGS = gt.Frame.from_frame([x, y], [[1, epsilon * y**2], [epsilon, sp.cos(epsilon + x)]])


@pytest.mark.parametrize(("made", "name"), one_in(3, ["coframe", "metric", "legs"], QUANTITIES))
def test_quantities_are_cut_series(made: str, name: str) -> None:
    """Quantities to second order, for frames from a coframe, a metric and legs."""
    frame = {"coframe": COFRAME, "metric": METRIC, "legs": LEGS}[made]
    agree(frame.expanded("epsilon", 2).quantity(name), frame.quantity(name), 2)


def test_unknown_functions_are_expanded_by_taylors_formula() -> None:
    """F(x + epsilon t, epsilon) and its derivatives by x and t to second order."""
    F, G = sp.Function("F"), sp.Function("G")
    lapse = F(x + epsilon * t, epsilon) + epsilon * G(x * (1 + epsilon))
    frame = gt.Frame.from_metric([t, x], [[-(lapse**2), 0], [0, 1]])
    series = frame.expanded("epsilon", 2)
    agree(series.metric, frame.metric, 2)
    bar, exact = gt.levi_civita(series), gt.levi_civita(frame)
    agree(bar.coefficients, exact.coefficients, 2)


def test_random_frames_are_cut_series() -> None:
    """As above for random triangular frames, in which epsilon occurs in different ways."""

    @few
    @given(entries((x, y)), entries((x, y)), st.integers(0, 2))
    def law(one: sp.Expr, two: sp.Expr, order: int) -> None:
        moved = {STRENGTH: k + epsilon}
        first, second = one.xreplace(moved), two.xreplace(moved)
        frame = gt.Frame([x, y], [[1 + epsilon * second, first], [0, 1 + epsilon]])
        series = frame.expanded(epsilon, order) if epsilon in frame.parameters else None
        if series is not None:
            agree(series.anholonomy, frame.anholonomy, order)
            bar = gt.levi_civita(frame).curvature.scalar
            agree(gt.levi_civita(series).curvature.scalar, bar, order)

    law()


def test_linearised_ricci_of_ten_functions() -> None:
    """(d_c d_a h^c_b + d_c d_b h^c_a - box h_ab - d_a d_b h) / 2 for any h."""
    eta = (-1, 1, 1, 1)
    h = {}
    for a in range(4):
        for b in range(a, 4):
            h[a, b] = h[b, a] = sp.Function(f"h{a}{b}")(*Q)
    metric = [[(a == b) * eta[a] + epsilon * h[a, b] for b in range(4)] for a in range(4)]
    frame = gt.Frame.from_metric(Q, metric).expanded("epsilon", 1)
    ricci = gt.levi_civita(frame).curvature.ricci
    trace = sum(eta[c] * h[c, c] for c in range(4))
    assert ricci.order(0).is_zero
    for a, b in product(range(4), repeat=2):
        wave = sum(
            eta[c]
            * (h[c, b].diff(Q[c], Q[a]) + h[c, a].diff(Q[c], Q[b]) - h[a, b].diff(Q[c], Q[c]))
            for c in range(4)
        )
        wanted = (wave - trace.diff(Q[a], Q[b])) / 2
        assert sp.expand(ricci.order(1)[a, b] - wanted) == 0


def test_known_expansions() -> None:
    """Slowly rotating Kerr is vacuum and drags frames; first-order Schwarzschild is Newtonian."""
    kerr = gt.spaces.load("kerr").frame
    slow = kerr.expanded("a", 1)
    assert gt.levi_civita(slow).curvature.ricci.is_zero
    dragging = slow.metric.order(1)
    r, theta, M = kerr.coordinates[1], kerr.coordinates[2], kerr.parameters[0]
    assert dragging[0, 3] == -2 * M * sp.sin(theta) ** 2 / r
    weak = gt.spaces.load("schwarzschild").frame.expanded("M", 1)
    gamma = gt.levi_civita(weak).coefficients
    assert gamma.order(1)[0, 0, 1] == 1 / weak.coordinates[1] ** 2
    assert gamma.order(0)[2, 2, 1] == -weak.coordinates[1]


def test_what_an_expanded_frame_can_do() -> None:
    """Numbers, substitution, copies, forms, identities and a second parameter all work."""
    series = METRIC.expanded("epsilon", 2)
    assert METRIC.expanded(epsilon, 2) is series
    at = series.metric.at({"t": 1, "x": 2, "epsilon": 0.5})
    assert at[0, 0] == -1 - 2 - 2
    digits = series.metric.at({"t": 1, "x": 2, "epsilon": sp.Rational(1, 3)}, digits=40)
    assert mpmath.nstr(digits[0, 0], 30) == "-3." + 29 * "2"
    again = pickle.loads(pickle.dumps(series.metric))
    assert again.nonzero() == series.metric.nonzero()
    assert again.frame.field.order == 2
    cone = COFRAME.expanded("epsilon", 1)
    assert cone.subs({"k": 2}).metric[1, 1] == 4 * epsilon * x + 4
    assert cone.subs({"epsilon": 0}).metric.nonzero() == {(0, 0): 1, (1, 1): k**2}
    assert cone.coframe_form(0).d[0, 1] == epsilon
    assert gt.cartan(cone).is_flat is True
    assert str(gt.cartan(cone).curvature.riemann.certainty) == "proved"
    delta = sp.Symbol("delta")
    both = gt.Frame([x, y], [[1, delta * x], [0, 1 + epsilon * delta * y]])
    twice = both.expanded("epsilon", 1).expanded("delta", 1)
    assert twice.determinant[()] == 1 + delta * epsilon * y
    assert twice.determinant.order(1)[()] == epsilon * y
    assert gt.levi_civita(twice).is_flat is True
    assert "epsilon" in repr(series.metric)
    for identity in gt.identities(gt.cartan(cone)):
        assert identity.holds is True


def test_expanded_frames_in_other_coordinates_and_on_surfaces() -> None:
    """Results from an expanded frame are truncated at the same order."""
    series = COFRAME.expanded("epsilon", 1)
    moved = series.in_coordinates([x, y], {x: x + y})
    exact = COFRAME.in_coordinates([x, y], {x: x + y})
    agree(moved.metric, exact.metric, 1)
    agree(series.metric.in_coordinates([x, y], {x: x + y}), exact.metric, 1)
    flat = gt.Frame.from_metric([x, y, z], sp.diag(1, 1, 1 + epsilon * sp.sin(x)))
    sheet = gt.surface(flat, [x, y], {"z": x * y})
    cut = gt.surface(flat.expanded("epsilon", 1), [x, y], {"z": x * y})
    agree(cut.metric, sheet.metric, 1)
    agree(cut.extrinsic_curvature, sheet.extrinsic_curvature, 1)
    assert gt.surface(series, [x]).metric.nonzero() == {(0, 0): 1}
    named = series.named(w="1 + x**2")
    assert named.metric.nonzero() == series.metric.nonzero()


REFUSALS = [
    (lambda: METRIC.expanded("x", 1), "coordinate x"),
    (lambda: METRIC.expanded("epsilo", 1), "epsilon"),
    (lambda: METRIC.expanded(epsilon + 1, 1), "symbol or name"),
    (lambda: METRIC.expanded("epsilon", -1), "order"),
    (lambda: METRIC.expanded("epsilon", 1.5), "order"),
    (lambda: gt.Frame([x, y], [[epsilon, 0], [0, 1]]).expanded("epsilon", 1), "singular there"),
    (
        lambda: gt.Frame([x, y], [[sp.sqrt(epsilon**2 + epsilon), 1], [1, 0]]).expanded(
            "epsilon", 1
        ),
        "regular at",
    ),
    (lambda: gt.Frame([x, y], [[sp.log(epsilon), 1], [1, 0]]).expanded("epsilon", 1), "regular"),
    (lambda: METRIC.metric.order(1), "expanded"),
    (lambda: METRIC.expanded("epsilon", 1).metric.order(2), "order"),
    (
        lambda: gt.numpy_function(METRIC.expanded("epsilon", 1).metric, ["t", "x", "epsilon"]),
        "cut after order 1",
    ),
]


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_frames_without_an_expansion_are_refused(call, words):
    """Each frame or argument without an expansion is refused with its own message."""
    with pytest.raises(GeomtorsionError, match=words):
        call()

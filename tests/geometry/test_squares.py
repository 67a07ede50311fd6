"""Squares: orthonormal frames of metrics of all kinds."""

import pytest
import sympy as sp

from geomtorsion.errors import MetricError
from geomtorsion.geometry import Frame, contract, levi_civita

t, x, y, z = sp.symbols("t x y z", real=True)
r, M = sp.symbols("r M", positive=True)


def rebuilt(frame: Frame) -> bool:
    """Whether e^T eta e is the given metric."""
    product = contract("ia,ij,jb->ab", frame.coframe, frame.eta, frame.coframe)
    return product == frame.metric


@pytest.mark.parametrize(
    ("metric", "minus"),
    [
        ([[1, x], [x, 1 + 2 * x**2]], 0),
        ([[0, 1], [1, 0]], 1),
        ([[0, sp.exp(x)], [sp.exp(x), 0]], 1),
        ([[-1, x], [x, 0]], 1),
        ([[-(1 + x**2), 0], [0, -1]], 2),
        ([[0, 1, 0], [1, 0, x], [0, x, 1]], 1),
        ([[0, 0, 0, 1], [0, 0, 1, 0], [0, 1, 0, 0], [1, 0, 0, 0]], 2),
    ],
    ids=str,
)
def test_metric_is_rebuilt(metric: list, minus: int) -> None:
    """Each metric is the square of its frame, with the right number of minus signs (Sylvester)."""
    frame = Frame.from_metric([t, x, y, z][: len(metric)] if len(metric) > 2 else [x, y], metric)
    assert rebuilt(frame)
    assert sum(sign == -1 for sign in frame.eta.nonzero().values()) == minus


def test_signature_orders_the_rows() -> None:
    """The rows have the order of the signature."""
    metric = [[1, 0], [0, -(1 + x**2)]]
    frame = Frame.from_metric([x, y], metric, signature=(-1, 1))
    assert frame.eta.nonzero() == {(0, 0): -1, (1, 1): 1}
    assert frame.coframe[1, 0] == 1
    assert rebuilt(frame)


def test_signature_finds_the_side_of_a_horizon() -> None:
    """Schwarzschild has its minus sign at dt outside and at dr inside; the domain decides."""
    f = 1 - 2 * M / r
    metric = sp.diag(-f, 1 / f)
    outside = Frame.from_metric([t, r], metric, signature=(-1, 1))
    assert outside.coframe[0, 0] == sp.sqrt(r - 2 * M) / sp.sqrt(r)
    inside = Frame.from_metric([t, r], metric, domain=r < M)
    assert [inside.eta[i, i] for i in range(2)] == [1, -1]
    assert rebuilt(outside)
    assert rebuilt(inside)


def test_given_metric_is_kept() -> None:
    """Levi-Civita quantities do not use the square roots of the frame."""
    frame = Frame.from_metric([x, y], [[1 + x**2, 0], [0, 1 + y**2]])
    steps = [step.name for step in frame.plan("christoffel").steps]
    assert steps == ["metric", "inverse_metric", "christoffel"]
    assert levi_civita(frame).is_flat
    assert not levi_civita(frame)[0, 0, 0].has(sp.sqrt(1 + x**2))


@pytest.mark.parametrize(
    ("metric", "message"),
    [
        ([[1, x], [y, 1]], r"\[0, 1\] is x, entry \[1, 0\] is y"),
        ([[1, 1], [1, 1]], "degenerate"),
        ([[sp.sin(x) ** 2, sp.sin(2 * x)], [sp.sin(2 * x), 4 * sp.cos(x) ** 2]], "degenerate"),
    ],
    ids=["unequal", "numbers", "identity"],
)
def test_bad_metrics(metric: list, message: str) -> None:
    """Refused: not symmetric, degenerate, degenerate because of an identity."""
    with pytest.raises(MetricError, match=message):
        Frame.from_metric([x, y], metric)


def test_wrong_signature_names_the_right_one() -> None:
    """The message names both signatures, found and expected."""
    with pytest.raises(
        MetricError, match=r"signature \(-1, 1\), got one of signature \(1, 1\) in its domain"
    ):
        Frame.from_metric([x, y], [[1 + x**2, 0], [0, 1]], signature=(-1, 1))

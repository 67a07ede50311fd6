"""Field equations on a grid: samples of a frame give the values of the exact frame."""

from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError

FRAME = gt.Frame(
    "x y z",
    [["1 + x*y/4", "y/5", 0], ["sin(z)/3", "2 + x**2", 0], [0, "x/3", "exp(x*z/4)"]],
)
FLAT = gt.Frame("x y z", [[1, 0, 0], [0, 1, 0], [0, 0, 1]])


def grid(n: int, frame: gt.Frame = FRAME) -> gt.SampledFrame:
    """Samples of a frame on n nodes along each axis."""
    return gt.SampledFrame.from_frame(frame, [np.linspace(-1, 1, n)] * 3)


def test_flat_space_on_a_grid():
    """A constant coframe leaves nothing of the equations."""
    values = g.equations(gt.cartan(FRAME), "T").at({}, grid(9, FLAT))
    assert values.E.shape == (9, 9, 9, 3, 3)
    assert values.largest == values.error == 0


THEORIES = [
    (gt.cartan, "T1 + c*T2**2", {"c": 0.25}, []),
    (gt.levi_civita, "R - 2*Lambda", {"Lambda": 2}, []),
    (gt.levi_civita, "R + R**2/8", {}, []),
    (gt.levi_civita, "R + X + phi**2*R + F2", {},
     [g.scalar_field("x*y"), g.maxwell(["y*z", "x", "x*y"])]),
]  # fmt: skip


@pytest.mark.parametrize(("make", "theory", "constants", "matter"), THEORIES)
def test_samples_agree_with_the_frame(make: Any, theory: str, constants: Any, matter: Any):
    """E, matter equations and invariants agree with exact ones within the errors, and converge."""
    equations = g.equations(make(FRAME), theory, matter)
    worst = []
    for n in (13, 25):
        values = equations.at(constants, grid(n))
        for node in (n // 2, n // 3):
            place = -1 + 2 * node / (n - 1)
            exact = equations.at({**constants, "x": place, "y": place, "z": place})
            for group, other in zip(
                (values.tensors, values.matter, values.scalars),
                (exact.tensors, exact.matter, exact.scalars),
                strict=True,
            ):
                for name, truth in other.items():
                    away = np.abs(group[name][node, node, node] - truth)
                    assert (away <= values.errors[name][node, node, node]).all(), name
        # The middle is the same point in both grids.
        middle = equations.at({**constants, "x": 0, "y": 0, "z": 0})
        worst.append(np.abs(values.E[n // 2, n // 2, n // 2] - middle.E).max())
    assert worst[0] > 8 * worst[1]


REFUSALS = [
    (lambda: g.equations(gt.cartan(FRAME), "T + c*T**2").at({}, grid(9)), "a number for c"),
    (lambda: g.equations(gt.cartan(FRAME), "T").at({"x": 1}, grid(9)), "constants"),
    (lambda: g.equations(gt.cartan("so3"), "T").at({}, gt.SampledFrame(
        [np.arange(9.0)] * 2, np.ones((2, 2, 9, 9)))), "3 axes and rows"),
    (lambda: g.equations(gt.cartan(gt.Frame("x y z", np.eye(3, dtype=int).tolist(), "-++")), "T")
     .at({}, grid(9)), "signature"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_refusals(call: Any, words: str):
    """The message of each wrong call names the expected value."""
    with pytest.raises(GeomtorsionError, match=words):
        call()

"""Charged holes: gravitational and electromagnetic waves are coupled, in both parities."""

from __future__ import annotations

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from geomtorsion.gravity import perturbed
from geomtorsion.gravity.theory.matter import MatterField
from tests.chosen import few
from tests.gravity.perturbed.leaver import reissner_nordstrom, schwarzschild

t, r, theta, phi, M, Q = sp.symbols("t r theta phi M Q")
FIELD = gt.gravity.maxwell(["Q/r", 0, 0, 0])
MAGNET = gt.gravity.maxwell([0, 0, 0, "-Q*cos(theta)"])
# Horizons at 8/5 and 2/5.
NUMBERS = {"M": 1, "Q": "4/5"}


def charged() -> gt.Frame:
    f = 1 - 2 * M / r + Q**2 / r**2
    rows = sp.diag(sp.sqrt(f), 1 / sp.sqrt(f), r, r * sp.sin(theta))
    domain = [r > M + sp.sqrt(M**2 - Q**2), theta > 0, sp.pi > theta]
    return gt.Frame([t, r, theta, phi], rows, signature="-+++", parameters=[M, Q], domain=domain)


@pytest.mark.parametrize(
    ("matter", "l", "parity", "published"),
    few(
        1,
        [
            (FIELD, 2, "axial", [(-1, 0.4 - 0.09j), (1, 0.57 - 0.1j)]),
            (FIELD, 2, "polar", [(-1, 0.4 - 0.09j), (1, 0.57 - 0.1j)]),
            (FIELD, 1, "axial", [(1, 0.32 - 0.1j)]),
            (MAGNET, 2, "axial", [(-1, 0.4 - 0.09j)]),
            (MAGNET, 2, "polar", [(-1, 0.4 - 0.09j)]),
        ],
    ),
)
def test_charged_holes_ring_as_published(
    matter: MatterField,
    l: int,  # noqa: E741
    parity: str,
    published: list[tuple[int, complex]],
) -> None:
    """Both parities, of electric and of magnetic charges, have the frequencies of Moncrief."""
    rings = perturbed.ringing(
        "R - F2", charged(), l=l, parity=parity, modes=len(published), parameters=NUMBERS,
        matter=matter,
    )  # fmt: skip
    for mode, (sign, start) in zip(rings.modes, published, strict=True):
        assert abs(mode.omega - reissner_nordstrom(l, sign, start, count=240)) < mode.error


def test_a_charge_of_zero_rings_as_no_charge() -> None:
    kerr_newman = gt.spaces.load("kerr_newman").frame
    rings = perturbed.ringing(
        "R - F2", kerr_newman, parity="axial", parameters={"M": 1, "a": 0, "q": 0},
        matter=gt.gravity.maxwell([0, 0, 0, 0]),
    )  # fmt: skip
    assert abs(rings.modes[0].omega - schwarzschild(2, 0.37 - 0.09j, spin=2)) < rings.modes[0].error


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"matter": None}, "Give matter="),
        ({"matter": gt.gravity.maxwell(["2*Q/r", 0, 0, 0])}, "solves the equations, got E_00"),
        ({"matter": gt.gravity.maxwell([0, 0, 0, "Q*cos(theta)**2"])}, "electric charge"),
        ({"matter": gt.gravity.maxwell(["Q/r", 0, 0, "Q*cos(theta)"])}, "got both"),
        ({"matter": [FIELD, FIELD]}, "at most one Maxwell field"),
        ({"matter": [FIELD, "Q/r"]}, "matter"),
        ({"matter": gt.gravity.maxwell(["Q*t", 0, 0, 0])}, "electric charge"),
        ({"matter": "Q/r"}, "matter"),
        ({"parameters": {"M": 1}}, "'Q': 1"),
        ({"l": 0}, "l:"),
        ({"l": 1, "parity": "polar"}, "parity='axial'"),
        ({"l": 1, "matter": MAGNET}, "electric charge"),
    ],
)
def test_refusals(options: dict, words: str) -> None:
    arguments = {"parity": "axial", "parameters": NUMBERS, "matter": FIELD} | options
    with pytest.raises(GeomtorsionError, match=words):
        perturbed.ringing("R - F2", charged(), **arguments)

"""Charts of a hole: the frequencies do not depend on them, and other frames are refused."""

from __future__ import annotations

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GravityError
from geomtorsion.gravity import perturbed
from tests.chosen import few
from tests.gravity.perturbed.leaver import frequency

t, r, theta, phi = COORDINATES = sp.symbols("t r theta phi")
ANGLE = sp.sin(theta)
F = 1 - 2 / r
ISOTROPIC = 1 + 1 / (2 * r)
SCALAR = 0.29293613 - 0.09765999j


def frame(*rows: list[sp.Expr | int]) -> gt.Frame:
    return gt.Frame(list(COORDINATES), sp.Matrix(rows), signature="-+++")


def spheres(radius: sp.Expr) -> tuple[list, list]:
    return [0, 0, radius, 0], [0, 0, 0, radius * ANGLE]


CHARTS = {
    "Painleve and Gullstrand": frame([1, 0, 0, 0], [sp.sqrt(2 / r), 1, 0, 0], *spheres(r)),
    "Eddington and Finkelstein": frame(
        [(1 + F) / 2, -1, 0, 0], [(1 - F) / 2, 1, 0, 0], *spheres(r)
    ),
    "isotropic": frame(
        [(2 - ISOTROPIC) / ISOTROPIC, 0, 0, 0], [0, ISOTROPIC**2, 0, 0],
        *spheres(r * ISOTROPIC**2),
    ),
    "inverse radius": frame(
        [sp.sqrt(1 - 2 * r), 0, 0, 0], [0, 1 / (r**2 * sp.sqrt(1 - 2 * r)), 0, 0], *spheres(1 / r)
    ),
    "cosine": frame(
        [sp.sqrt(F), 0, 0, 0], [0, 1 / sp.sqrt(F), 0, 0],
        [0, 0, r / sp.sqrt(1 - theta**2), 0], [0, 0, 0, r * sp.sqrt(1 - theta**2)],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", few(2, list(CHARTS)))
def test_all_charts_ring_alike(name: str) -> None:
    (mode,) = perturbed.ringing("-X/2", CHARTS[name], l=1).modes
    assert abs(mode.frequency - SCALAR) < mode.error + 1e-8


@pytest.mark.parametrize(
    ("space", "parameters"),
    few(
        2,
        [
            ("schwarzschild_isotropic", {"M": 1}),
            ("schwarzschild_cartesian", {"M": 1}),
            ("schwarzschild_falling", {"M": 1}),
            ("kerr", {"M": 1, "a": 0}),
        ],
    ),
)
def test_shipped_spaces_ring_alike(space: str, parameters: dict) -> None:
    (mode,) = perturbed.ringing("-X/2", space, l=1, parameters=parameters).modes
    assert abs(mode.frequency - SCALAR) < mode.error + 1e-8


def test_a_charge_in_another_chart() -> None:
    """With the time of Painleve and Gullstrand, M = 1 and Q = 4/5."""
    fall = sp.sqrt(2 / r - sp.Rational(16, 25) / r**2)
    falling = frame([1, 0, 0, 0], [fall, 1, 0, 0], *spheres(r))
    rings = perturbed.ringing(
        "R - F2", falling, l=1, parity="axial", matter=gt.gravity.maxwell(["4/(5*r)", 0, 0, 0])
    )
    assert abs(rings.modes[0].frequency - (0.323493598 - 0.098272500j)) < 1e-9


@pytest.mark.parametrize(("lagrangian", "l"), few(1, [("-X/2", 0), ("-X/2", 2), ("-F2/4", 1)]))
def test_test_fields_on_a_hole_with_another_radial_part(lagrangian: str, l: int) -> None:  # noqa: E741
    """The dilaton hole of Gibbons and Maeda, -f dt^2 + dr^2/f + r (r - 1/2) dOmega^2."""
    area = r * (r - sp.Rational(1, 2))
    radius = sp.sqrt(area)
    hole = frame([sp.sqrt(F), 0, 0, 0], [0, 1 / sp.sqrt(F), 0, 0], *spheres(radius))
    mode = perturbed.ringing(lagrangian, hole, l=l, digits=6).modes[0]
    bend = sp.simplify((F * radius.diff(r)).diff(r) / radius) if "X" in lagrangian else 0
    potential = F * (l * (l + 1) / area + bend)
    horizons = sp.Integer(2), sp.Integer(0)
    series = [frequency(potential, horizons, mode.frequency, count=n) for n in (200, 300)]
    assert abs(mode.omega - series[1]) < mode.error + abs(series[1] - series[0])


TORTOISE = 2 * (1 + sp.LambertW(sp.exp(r / 2 - 1)))
REFUSED = [
    (frame([1, 0, 0, 0], [0, 1, 0, 0], *spheres(sp.sqrt(r**2 + 1))), "expected a horizon"),
    (frame([1, 0, 0, 0], [0, 1, 0, 0], *spheres(r)), "expected a horizon"),
    (frame([t * sp.sqrt(F), 0, 0, 0], [0, 1 / sp.sqrt(F), 0, 0], *spheres(r)), "static hole"),
    (frame([sp.sqrt(1 - 2 / TORTOISE), 0, 0, 0], [0, sp.sqrt(1 - 2 / TORTOISE), 0, 0],
           *spheres(TORTOISE)), "another rational radius"),
    (frame([sp.sqrt(F), 0, 0, 0], [0, 1 / sp.sqrt(F), 0, 0], [0, 0, r, 0], [0, 0, 0, r]),
     "static hole"),
    (frame([sp.sqrt(F), 0, 0, 0], [0, 1 / sp.sqrt(F), 0, 0],
           *spheres(sp.sqrt(r**2 - r / 2))), "Test fields"),
]  # fmt: skip


@pytest.mark.parametrize(("other", "words"), REFUSED)
def test_refusals(other: gt.Frame, words: str) -> None:
    with pytest.raises(GravityError, match=words):
        perturbed.ringing("R", other, parity="axial")

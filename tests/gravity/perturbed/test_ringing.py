"""Ringing: frequencies of Leaver, of Schwarzschild and de Sitter, of test fields, and refusals."""

import json
from pathlib import Path

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from geomtorsion.gravity import perturbed
from tests.chosen import few
from tests.cli import running

t, r, theta, phi = sp.symbols("t r theta phi")
MASS = {"M": 1}


def hole(f: sp.Expr) -> gt.Frame:
    """The static frame of f."""
    rows = sp.diag(sp.sqrt(f), 1 / sp.sqrt(f), r, r * sp.sin(theta))
    return gt.Frame([t, r, theta, phi], rows, signature="-+++")


# Leaver (1985) and Jansen (2017) for M = 1; scalar and Maxwell fields: Leaver, Iyer.
LEAVER = [
    ("R", "axial", 2, [0.373671684418042 - 0.088962315688936j]),
    ("R", "polar", 2, [0.373671684418042 - 0.088962315688936j,
                       0.346710996879163 - 0.273914875291235j]),
    ("R", "axial", 3, [0.5994432884 - 0.0927030479j]),
    ("-X/2", "both", 0, [0.11045494 - 0.10489572j]),
    ("-X/2", "both", 1, [0.29293613 - 0.09765999j]),
    ("-F2/4", "both", 1, [0.24826326 - 0.09248772j]),
]  # fmt: skip


@pytest.mark.parametrize(("lagrangian", "parity", "l", "published"), few(3, LEAVER))
def test_schwarzschild(lagrangian: str, parity: str, l: int, published: list[complex]) -> None:  # noqa: E741
    rings = perturbed.ringing(
        lagrangian, "schwarzschild", l=l, parity=parity, modes=len(published), parameters=MASS
    )
    for one, value in zip(rings.modes, published, strict=True):
        # The published digits are rounded in the last place.
        digits = len(repr(value.imag).partition(".")[2])
        assert abs(one.frequency - value) < 10.0**-digits + one.error
        assert one.error < 1e-8


# Other published values: Leaver (1985) with 2 M = 1, Berti, Cardoso and Starinets (2009) with
# 2 M = 1, and with M = 1 Konoplya (2003) and Iyer (1987).
TABLE = [
    ("R", "axial", 2, "1/2", [0.747343 - 0.177925j, 0.693422 - 0.547830j, 0.602107 - 0.956554j,
                              0.503010 - 1.410296j]),
    ("R", "axial", 3, "1/2", [1.198887 - 0.185406j, 1.165288 - 0.562596j, 1.103370 - 0.958186j,
                              1.023924 - 1.380674j, 0.940348 - 1.831299j]),
    ("R", "polar", 4, "1/2", [1.6184 - 0.1883j]),
    ("R", "axial", 6, "1/2", [2.4240 - 0.1905j]),
    ("-X/2", "both", 0, 1, [0.1105 - 0.1049j, 0.0861 - 0.3481j]),
    ("-X/2", "both", 1, 1, [0.2929 - 0.0977j, 0.2645 - 0.3063j]),
    ("-X/2", "both", 2, 1, [0.4836 - 0.0968j, 0.4639 - 0.2956j, 0.4305 - 0.5086j]),
    ("-F2/4", "both", 1, 1, [0.2483 - 0.0925j, 0.2145 - 0.2937j]),
    ("-F2/4", "both", 2, 1, [0.4576 - 0.0950j, 0.4365 - 0.2907j, 0.4012 - 0.5016j]),
]  # fmt: skip


@pytest.mark.parametrize(("lagrangian", "parity", "l", "mass", "published"), few(2, TABLE))
def test_overtones(
    lagrangian: str,
    parity: str,
    l: int,  # noqa: E741
    mass: object,
    published: list[complex],
) -> None:
    rings = perturbed.ringing(
        lagrangian, "schwarzschild", l=l, parity=parity, modes=len(published), digits=4,
        parameters={"M": mass},
    )  # fmt: skip
    for one, value in zip(rings.modes, published, strict=True):
        digits = len(repr(value.real).partition(".")[2])
        assert abs(one.frequency - value) < 10.0**-digits + one.error


def test_errors_hold_and_digits_are_kept() -> None:
    """A mode of 5 digits agrees with one of 15 within its error."""
    options = {"parity": "axial", "parameters": MASS}
    rough, fine = (
        perturbed.ringing("R", "schwarzschild", digits=n, **options).modes[0]  # type: ignore[arg-type]
        for n in (5, 15)
    )
    assert abs(complex(rough.omega - fine.omega)) <= rough.error
    assert fine.error < 1e-15
    assert str(fine).startswith("axial, l = 2: 0.373671684418041")


def test_a_horizon_of_de_sitter() -> None:
    """Lambda = 0.02 (Zhidenko 2004): both parities ring alike."""
    f = 1 - 2 / r - r**2 / 150
    rings = perturbed.ringing("R - 2*Lambda", hole(f), parameters={"Lambda": "1/50"})
    assert [one.parity for one in rings.modes] == ["axial", "polar"]
    for one in rings.modes:
        assert abs(one.frequency - (0.3383914276 - 0.0817564455j)) < 2e-10


@pytest.mark.parametrize(
    ("constant", "published"),
    few(1, [("1/25", 0.2989 - 0.0733j), ("2/25", 0.1975 - 0.0499j), ("1/10", 0.1179 - 0.0302j)]),
)
def test_larger_constants(constant: str, published: complex) -> None:
    """Zhidenko (2004), four digits."""
    f = 1 - 2 / r - sp.Rational(constant) * r**2 / 3
    rings = perturbed.ringing(
        "R - 2*Lambda", hole(f), parity="axial", parameters={"Lambda": constant}
    )
    assert abs(rings.modes[0].frequency - published) < 1e-4


def test_almost_extremal_holes_of_de_sitter() -> None:
    """omega = kappa (sqrt((l + 2)(l - 1) - 1/4) - i/2), Cardoso and Lemos (2003).

    kappa is the surface gravity. The formula is off by the distance of the horizons over r.
    """
    constant = sp.Rational(11111, 100000)
    f = 1 - 2 / r - constant * r**2 / 3
    rings = perturbed.ringing("R - 2*Lambda", hole(f), parity="axial",
                              parameters={"Lambda": constant})  # fmt: skip
    roots = sorted(sp.re(x) for x in sp.Poly(sp.numer(sp.together(f)), r).nroots(n=40))
    near, far = roots[-2:]
    kappa = float(f.diff(r).subs(r, near) / 2)
    limit = complex(15**0.5 / 2, -0.5)
    assert abs(rings.modes[0].frequency / kappa - limit) < abs(limit) * float((far - near) / near)


@pytest.mark.parametrize(
    ("lagrangian", "geometry"), few(1, [("-T/2", "teleparallel"), ("R/2 + R**2", "riemannian")])
)
def test_theories_that_ring_as_general_relativity(lagrangian: str, geometry: str) -> None:
    rings = perturbed.ringing(
        lagrangian, "schwarzschild", parity="axial", parameters=MASS, geometry=geometry
    )
    assert abs(rings.modes[0].frequency - (0.373671684418042 - 0.088962315688936j)) < 1e-9


def test_frequencies_scale_with_the_mass() -> None:
    one, two = (
        perturbed.ringing("-X/2", "schwarzschild", l=1, parameters={"M": mass}).modes[0]
        for mass in (1, "7/2")
    )
    assert abs(one.frequency - 3.5 * two.frequency) < one.error + 3.5 * two.error


REFUSED = [
    (lambda: perturbed.ringing("R", "schwarzschild"), "none for M"),
    (lambda: perturbed.ringing("R", "kerr", parameters=MASS), "static hole"),
    (lambda: perturbed.ringing("R", "s2"), "static hole"),
    (lambda: perturbed.ringing("R", "so3"), "static hole"),
    (lambda: perturbed.ringing("R", hole(1 - 2 / r - r**2 / 150)), "solves the equations"),
    (lambda: perturbed.ringing("R + R4", "schwarzschild", parity="polar", parameters=MASS),
     "parity='axial'"),
    (lambda: perturbed.ringing("R**2", "schwarzschild", parameters=MASS), "0 = 0"),
    (lambda: perturbed.ringing("R**2", "schwarzschild", parity="polar", parameters=MASS),
     "0 = 0"),
    (lambda: perturbed.ringing("R", "schwarzschild", l=1, parameters=MASS), "l:"),
    (lambda: perturbed.ringing("R", "schwarzschild", parameters={"M": 1, "z": 2}), "z"),
    (lambda: perturbed.ringing("R", "schwarzschild", parameters={"M": 1, "R": 2}), "R"),
    (lambda: perturbed.ringing("R1 - X/2", "schwarzschild", parameters=MASS), "X"),
    (lambda: perturbed.ringing("R", "schwarzschild", parameters={"M": 0}), "positive r"),
    (lambda: perturbed.ringing("-X/2", hole((1 - 1 / r) ** 2)), "double zero"),
    (lambda: perturbed.ringing("-X/2 + mu*phi**2/2", "schwarzschild",
                               parameters={"M": 1, "mu": "1/100"}), r"m\^2 = -1/100"),
    (lambda: perturbed.ringing("-X/2 - mu*phi**2/2", "schwarzschild", parameters=MASS), "mu"),
    (lambda: perturbed.ringing("R", "schwarzschild", parity="odd", parameters=MASS), "parity"),
    (lambda: perturbed.ringing("R", "schwarzschild", parameters={"M": "x"}), "x"),
    (lambda: perturbed.ringing("R", "schwarzschild", modes=9, digits=3, parity="axial",
                               parameters=MASS), "fewer digits or modes"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "words"), REFUSED)
def test_refusals(call, words: str) -> None:
    with pytest.raises(GeomtorsionError, match=words):
        call()


def test_the_command(tmp_path: Path) -> None:
    folder = tmp_path / "rings"
    shown = running.run(
        "ringing", "schwarzschild", "--set", "M=1", "-L", "-X/2", "-l", "0", "--format", "json",
        "-o", str(folder),
    )  # fmt: skip
    document = json.loads(shown.stdout)
    assert document == json.loads((folder / "ringing.json").read_text())
    assert document["modes"][0]["real"].startswith("0.1104549")
    assert (folder / "ringing.png").stat().st_size > 1000

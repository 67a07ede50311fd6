"""Scalars that ring: fields with a mass, the scalar of f(R), and fields that multiply R."""

from __future__ import annotations

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import AccuracyError, GeomtorsionError
from geomtorsion.gravity import perturbed
from geomtorsion.gravity.perturbed import frequencies
from tests.chosen import few
from tests.gravity.perturbed.leaver import schwarzschild

MASS = {"M": 1}
TETRAD = 0.373671684418042 - 0.088962315688936j


@pytest.mark.parametrize(
    ("l", "mass2", "start"),
    few(
        1,
        [
            (0, "1/400", 0.11 - 0.1j),
            (1, "1/100", 0.297 - 0.095j),
            (2, "1/6", 0.537 - 0.078j),
            (2, "1/4", 0.565 - 0.068j),
        ],
    ),
)
def test_a_test_field_with_a_mass(l: int, mass2: str, start: complex) -> None:  # noqa: E741
    """Leaver's series with the mass (Konoplya and Zhidenko 2005) gives the same frequency."""
    rings = perturbed.ringing(
        "-X/2 - m2*phi**2/2", "schwarzschild", l=l, digits=5, parameters={"M": 1, "m2": mass2}
    )
    mode = rings.modes[0]
    series = [schwarzschild(l, start, mass2=sp.Rational(mass2), count=n) for n in (300, 400)]
    assert abs(mode.omega - series[1]) < mode.error + abs(series[1] - series[0])
    assert mode.field == "scalar"


@pytest.mark.parametrize(
    ("l", "mass2", "start"),
    few(
        1,
        [
            # The damping of the first mode is 0 before this mass; it exists no longer.
            (1, "3/10", 0.2609 - 0.2198j),
            (1, "1/5", 0.3833 - 0.0337j),
            (2, "1/2", 0.6507 - 0.0314j),
            (3, "1", 0.9286 - 0.026j),
        ],
    ),
)
def test_a_heavy_field(l: int, mass2: str, start: complex) -> None:  # noqa: E741
    """The first mode, and not its overtone, by a long series of Leaver."""
    (mode,) = heavy(l, mass2)
    series = [schwarzschild(l, start, mass2=sp.Rational(mass2), count=n) for n in (800, 1200)]
    assert abs(mode.omega - series[1]) < mode.error + abs(series[1] - series[0])


def heavy(l: int, mass2: str, modes: int = 1) -> tuple[perturbed.Mode, ...]:  # noqa: E741
    numbers = {"M": 1, "m2": mass2}
    return perturbed.ringing(
        "-X/2 - m2*phi**2/2", "schwarzschild", l=l, modes=modes, digits=5, parameters=numbers
    ).modes


@pytest.mark.slow
def test_a_mode_that_is_almost_undamped() -> None:
    """The damping of the first mode decreases to 0, and it is the first until then."""
    modes = [heavy(1, mass2)[0].frequency for mass2 in ("1/4", "57/200")]
    assert 0 < -modes[1].imag < -modes[0].imag / 20
    assert 0 < modes[1].real - modes[0].real < 0.02


def test_a_large_l() -> None:
    (mode,) = perturbed.ringing("-X/2", "schwarzschild", l=10, digits=5, parameters=MASS).modes
    assert abs(mode.omega - schwarzschild(10, 2.02 - 0.096j)) < 1e-9 + mode.error


@pytest.mark.slow
def test_overtones_of_a_heavy_field_are_in_order() -> None:
    first, second = heavy(2, "1/2", 2)
    assert abs(first.frequency - heavy(2, "1/2")[0].frequency) < first.error
    assert abs(second.frequency - (0.530309 - 0.169125j)) < 1e-6


@pytest.mark.slow
def test_the_heavy_scalar_of_f_of_r() -> None:
    """m^2 = 1/(6 c) = 1/5."""
    rings = perturbed.ringing(
        "R + c*R**2", "schwarzschild", l=1, parameters={"M": 1, "c": "5/6"}
    )  # fmt: skip
    assert abs(rings.modes[0].frequency - heavy(1, "1/5")[0].frequency) < 1e-8


def test_a_first_mode_that_the_coarse_grids_miss(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the first rough frequency the overtone settles, and is refused as the first mode."""
    found = frequencies.rough
    monkeypatch.setattr(
        frequencies, "rough", lambda radial: found(radial)[radial.mass2 != 0 :]
    )  # fmt: skip
    with pytest.raises(AccuracyError, match=r"none near 0\.383 - 0\.0337 i"):
        heavy(1, "1/5")


def test_a_first_mode_without_mass_that_the_coarse_grids_miss(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An overtone has three times the damping of waves near the light ring, 1/(6 sqrt 3)."""
    found = frequencies.rough
    monkeypatch.setattr(frequencies, "rough", lambda radial: found(radial)[1:])
    with pytest.raises(AccuracyError, match=r"about 0\.0962.* got 0\.264 - 0\.306 i"):
        perturbed.ringing("-X/2", "schwarzschild", l=1, parameters=MASS)


@pytest.mark.parametrize("false", few(1, [0.31 - 0.05j, 0.4 - 0.09j]))
def test_a_less_damped_wave_that_does_not_settle(
    monkeypatch: pytest.MonkeyPatch, false: complex
) -> None:
    """A rough frequency is lost on finer grids: the others are not returned."""
    found = frequencies.rough
    monkeypatch.setattr(frequencies, "rough", lambda radial: [false, *found(radial)])
    with pytest.raises(AccuracyError, match="did not settle"):
        perturbed.ringing("-X/2", "schwarzschild", l=1, parameters=MASS)


def test_a_less_damped_wave_that_stalls(monkeypatch: pytest.MonkeyPatch) -> None:
    """The changes of the first mode do not decrease: its overtone is not returned."""
    refine = frequencies.Candidate.refine

    def noisy(one: frequencies.Candidate, matrices: object) -> None:
        refine(one, matrices)  # type: ignore[arg-type]
        if one.changes and one.frequency.imag > -0.2:
            one.changes[-1] = 1e-4

    monkeypatch.setattr(frequencies.Candidate, "refine", noisy)
    with pytest.raises(AccuracyError, match=r"near 0\.293 - 0\.0977 i that did not settle"):
        perturbed.ringing("-X/2", "schwarzschild", l=1, parameters=MASS)


def test_the_scalar_of_f_of_r_rings_beside_the_tetrad() -> None:
    """R + c R^2 has a scalar with m^2 = 1/(6 c), and the tetrad rings as in general relativity."""
    rings = perturbed.ringing(
        "R + c*R**2", "schwarzschild", parity="polar", parameters={"M": 1, "c": "2/3"}
    )
    tetrad, scalar = rings.modes
    assert (tetrad.field, scalar.field) == ("gravity", "scalar")
    assert abs(tetrad.frequency - TETRAD) < tetrad.error + 1e-15
    series = schwarzschild(2, 0.565 - 0.068j, mass2=sp.Rational(1, 4), count=300)
    assert abs(scalar.omega - series) < scalar.error
    assert str(scalar).startswith("scalar field, polar, l = 2: 0.56493691")


@pytest.mark.parametrize(
    ("lagrangian", "parameters", "field"),
    few(
        2,
        [
            ("R + R**2*5/3", MASS, None),
            ("R + c*R**2 + R**3", {"M": 1, "c": "5/3"}, None),
            ("exp(10*R/3) - 1", MASS, None),
            ("phi*R - 3*(phi - 1)**2/20", MASS, "1"),
            ("R/2 - X/2 - phi**2/20", MASS, "0"),
            ("(1 + phi**2)*R/2 - X/2 - phi**2/20", MASS, "0"),
        ],
    ),
)
def test_theories_with_one_scalar_of_the_same_mass(
    lagrangian: str, parameters: dict, field: str | None
) -> None:
    """m^2 = 1/10 in each, also for l = 1, where the tetrad has no wave."""
    matter = None if field is None else gt.gravity.scalar_field(field)
    rings = perturbed.ringing(
        lagrangian, "schwarzschild", l=1, digits=5, parameters=parameters, matter=matter
    )
    (mode,) = rings.modes
    series = schwarzschild(1, 0.338 - 0.069j, mass2=sp.Rational(1, 10), count=300)
    assert abs(mode.omega - series) < mode.error


def test_the_scalar_of_f_of_r_in_de_sitter_space() -> None:
    """m^2 = f'/(3 f'') - R/3 with R = 4 Lambda: 1/3 for c = 1/2 and Lambda = 1/25."""
    t, r, theta, phi = sp.symbols("t r theta phi")
    f = 1 - 2 / r - r**2 / 75
    rows = sp.diag(sp.sqrt(f), 1 / sp.sqrt(f), r, r * sp.sin(theta))
    hole = gt.Frame([t, r, theta, phi], rows, signature="-+++")
    square = perturbed.ringing(
        "R + c*R**2 - 2*Lambda", hole, l=1, parity="polar",
        parameters={"Lambda": "1/25", "c": "1/2"},
    ).modes[0]  # fmt: skip
    test = perturbed.ringing("-X/2 - phi**2/6", hole, l=1).modes[0]
    assert abs(square.omega - test.omega) < square.error + test.error


def test_f_of_r_without_a_scalar_rings_as_general_relativity() -> None:
    """R + R^3 has no scalar where R = 0."""
    rings = perturbed.ringing("R + R**3", "schwarzschild", parity="polar", parameters=MASS)
    (mode,) = rings.modes
    assert abs(mode.frequency - TETRAD) < mode.error + 1e-15


@pytest.mark.parametrize(
    ("lagrangian", "options", "words"),
    [
        ("R - R**2", {}, "m\\^2 = -1/6"),
        ("phi*R", {"l": 2}, "phi"),
        ("phi*R", {"matter": gt.gravity.scalar_field("1/r")}, "constant scalar field"),
        ("phi*R + R**2", {"matter": gt.gravity.scalar_field(1)}, "no other scalar"),
        ("phi*R/2 - phi**2", {"matter": gt.gravity.scalar_field(1)}, "solves the equations"),
        ("R/2 - V*phi**2", {"matter": gt.gravity.scalar_field(0)}, "V"),
        ("R/2 - phi**2", {"matter": gt.gravity.scalar_field(0)}, "scalar with a wave"),
        ("-X/2", {"matter": gt.gravity.scalar_field(0)}, "test field"),
        ("R + c*R**2", {}, "'c': 1"),
        ("R + 1/R", {}, "two derivatives by R"),
        ("R + lambda*R**2", {"parameters": {"M": 1, "lambda": 0}}, "l: expected"),
    ],
)
def test_refusals(lagrangian: str, options: dict, words: str) -> None:
    with pytest.raises(GeomtorsionError, match=words):
        perturbed.ringing(lagrangian, "schwarzschild", **{"l": 1, "parameters": MASS} | options)

"""Waves over time: numbers on a cosmos, from closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geomtorsion.errors import GeomtorsionError
from geomtorsion.gravity import perturbed
from geomtorsion.pictures.modes import draw_evolution

TIMES = np.linspace(1, 10, 7)
# Closed forms in doubles take a few roundings of numbers of order one.
ROUNDING = 16 * np.finfo(float).eps


def test_einstein_on_any_cosmos() -> None:
    """Speed of light, no running: at one time, in whole numbers, on a static cosmos."""
    waves = perturbed.tensor_modes("R/2", "riemannian")
    for a, times in (("t**(2/3)", TIMES), ("exp(t)", [0]), ("cosh(t)", [-1, 1])):
        values = waves.over_time(times, a=a).values
        assert {name: set(x) for name, x in values.items()} == {
            "speed2": {1.0}, "kinetic": {1.0}, "alpha_M": {0.0}, "alpha_T": {0.0},
        }  # fmt: skip


def test_gauss_bonnet_over_time() -> None:
    """c_T^2 = (1 + 8 c phi'')/(1 + 8 c H phi') with a = t^(1/2), phi = t^2."""
    waves = perturbed.tensor_modes("R/2 - X/2 + c*phi*GB", "riemannian", scalars="phi")
    evolution = waves.over_time(TIMES, a="t**(1/2)", phi="t**2", c="1/10")
    H = 1 / (2 * TIMES)
    kinetic = 1 + 0.8 * H * 2 * TIMES
    assert_allclose(evolution.values["kinetic"], kinetic, rtol=ROUNDING)
    assert_allclose(evolution.values["speed2"], (1 + 1.6) / kinetic, rtol=ROUNDING)
    assert evolution.to_json()["times"] == TIMES.tolist()
    assert "phi = t**2" in str(evolution)


def test_running_of_a_coupled_field() -> None:
    """alpha_M = d ln F / d ln a for F = 1 + phi^2, phi = t, a = t^(2/3): 3 t^2/(1 + t^2)."""
    waves = perturbed.tensor_modes("(1 + phi**2)*R/2 - X/2", "riemannian", scalars="phi")
    values = waves.over_time(TIMES, a="t**(2/3)", phi="t").values
    assert_allclose(values["alpha_M"], 3 * TIMES**2 / (1 + TIMES**2), rtol=ROUNDING)


def test_friedmann_equation_of_a_stiff_field() -> None:
    """a = t^(1/3), phi' = sqrt(2/3)/t solves it; another field leaves its left side."""
    waves = perturbed.scalar_modes("R/2 - X/2")
    exact = waves.over_time(TIMES, a="t**(1/3)", phi="sqrt(2/3)*log(t)").values
    assert set(exact["speed2"]) == {1.0}
    assert set(exact["friedmann"]) == {0.0}
    # Q_s = phi'^2/(2 H^2) = 3.
    assert_allclose(exact["kinetic"], 3, rtol=ROUNDING)
    wrong = waves.over_time([1], a="t**(1/3)", phi="t").values
    assert_allclose(abs(wrong["friedmann"]), [1 / 2 - 1 / 3], rtol=ROUNDING)


def test_growth_depends_on_the_wave_number() -> None:
    """R + R^2/3: G = (1 + 4 x)/(1 + 3 x) with x = 2 k^2/(3 a^2) (Tsujikawa 2007)."""
    growth = perturbed.growth("R/2 + R**2/6")
    values = growth.over_time(TIMES, a="t**(2/3)", k=2).values
    x = 2 * 4 / (3 * TIMES ** (4 / 3))
    assert_allclose(values["G"], (1 + 4 * x) / (1 + 3 * x), rtol=ROUNDING)
    assert_allclose(values["slip"], (1 + 2 * x) / (1 + 4 * x), rtol=ROUNDING)


def test_figure() -> None:
    """One axis for the speed and one for the other numbers."""
    waves = perturbed.tensor_modes("R/2", "riemannian")
    evolution = waves.over_time(TIMES, a="t")
    figure = evolution.plot()
    speed, others = figure.axes
    assert len(others.get_lines()) == 3
    assert speed.get_legend() is not None
    with pytest.raises(GeomtorsionError, match="evolution"):
        draw_evolution(waves)  # type: ignore[arg-type]


WAVES = perturbed.tensor_modes("F(phi)*R/2 - X/2", "riemannian", scalars="phi")


@pytest.mark.parametrize(
    ("times", "cosmos", "words"),
    [
        ([1], {"phi": "t"}, "scale factor"),
        ([1], {"a": "t"}, "got none for F_phi|got none for F|got none for phi"),
        ([1], {"a": "t", "phi": "t"}, "write the function in the Lagrangian"),
        ([1], {"a": "t", "b": 1}, "field or coupling"),
        ([1], {"a": "t", "H": 1}, "field or coupling"),
        ([1], {"a": "x", "phi": "t"}, "a: "),
        ([], {"a": "t"}, "at least one time"),
        ("1,2", {"a": "t"}, "times"),
        ([float("nan")], {"a": "t"}, "finite"),
    ],
)
def test_refusals(times: object, cosmos: dict[str, object], words: str) -> None:
    with pytest.raises(GeomtorsionError, match=words):
        WAVES.over_time(times, **cosmos)  # type: ignore[arg-type]


def test_a_singular_time_is_refused() -> None:
    with pytest.raises(GeomtorsionError, match="kinetic has no finite real value at t = 0"):
        perturbed.tensor_modes("R/2 + R**2", "riemannian").over_time([0, 1], a="t**2")

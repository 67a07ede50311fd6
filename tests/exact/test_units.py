"""Units: written quantities are converted to SI, and a unit that does not fit is refused."""

import math

import pytest

from geomtorsion.errors import ExpressionError, LimitError, UnitError
from geomtorsion.exact.units import quantity, unit, with_unit
from tests.rounding import ROUNDED


@pytest.mark.parametrize(
    ("given", "field", "value"),
    [
        ("9.81 m/s^2", "m/s^2", 9.81),
        ("9.81m/s^2", "m/s^2", 9.81),
        ("9.81 m s^-2", "m/s^2", 9.81),
        ("981 cm/s**2", "m/s^2", 9.81),
        ("3 rpm", "rad/s", 3 * 2 * math.pi / 60),
        ("-2 turn/s", "rad/s", -4 * math.pi),
        ("20 deg", "rad", math.radians(20)),
        ("20°", "rad", math.radians(20)),
        ("pi/2", "rad", math.pi / 2),
        ("2 * pi rad/s", "rad/s", 2 * math.pi),
        ("sqrt(2)/2 kg m^2", "kg m^2", math.sqrt(2) / 2),
        ("1.5e3 g", "kg", 1.5),
        ("90 min", "s", 5400.0),
        ("72 km/h", "m/s", 20.0),
        ("0.25 N m", "N m", 0.25),
        ("50 uT", "T", 5e-5),
        ("2 A m^2", "J/T", 2.0),
        ("5 1/s", "rad/s", 5.0),
        ("5", "m", 5.0),
        (7, "kg", 7),
        (0.1, "", 0.1),
        ("1e-3", "", 1e-3),
        ("1/3", "", 1 / 3),
        ("0.5*pi rad", "rad", math.pi / 2),
    ],
)
def test_quantities(given, field, value):
    """A quantity as a person writes it has its value in the unit of the field, up to rounding."""
    assert quantity(given, field) == pytest.approx(value, rel=ROUNDED)


@pytest.mark.parametrize(
    ("given", "field", "words"),
    [
        ("9.81 m/s", "m/s^2", "expected a value in m/s\\^2, got the unit m/s"),
        ("3 rpm", "m", "expected a value in m"),
        ("3 rad/s", "1/s", "expected a value in 1/s"),
        ("3 deg", "", "expected a plain number"),
        ("3 Hz", "rad/s", "whether turns or radians"),
        ("3 mm^-999", "m", "too large for a number"),
        ("3 mm^999", "m", "too large for a number"),
        ("3 m^" + "9" * 5000, "m", "too large for a number"),
        ("3 day^99", "s", "too large for a number"),
        ("3 metre", "m", "expected a unit, got 'metre'"),
        ("3 Deg", "rad", "Did you mean deg"),
        ("3 m/sek", "m/s", "expected a unit, got 'sek'"),
    ],
)
def test_units_that_do_not_fit(given, field, words):
    """A wrong unit is refused; the message names both units, or the nearest known one."""
    with pytest.raises(UnitError, match=words):
        quantity(given, field)


@pytest.mark.parametrize(
    "given",
    [True, None, [1], "", "x", "t", "1 +", "__import__('os')", "1/0", "sqrt(-1)", "inf", "nan",
     float("nan"), float("inf"), "1e999", "1e9999999*2",
     "0." + 5000 * "1" + "*2", "2**2**2**2**2**2"],
)  # fmt: skip
def test_invalid_numbers_are_refused(given):
    """Names, code, and numbers that are not finite are refused with an error of ours."""
    with pytest.raises((ExpressionError, LimitError, UnitError)):
        quantity(given, "m")


def test_expressions_keep_their_text():
    """An expression keeps its text; its unit is split off."""
    assert with_unit("5*exp(-t/2) N")[0] == "5*exp(-t/2)"
    assert with_unit("5*sin(2*t) + 1") == ("5*sin(2*t) + 1", None)
    assert with_unit("1e-3") == ("1e-3", None)


def test_kinds_of_derived_units():
    """Derived units equal their combinations of base units."""
    assert unit("N").kind == unit("kg m/s^2").kind == "kg*m/s^2"
    assert unit("T").powers == unit("N A^-1 m^-1").powers
    assert unit("J/T").powers == unit("A m^2").powers
    assert unit("W").powers == unit("J/s").powers
    assert unit("m/m").kind == "1"

"""Units: numbers with units as a person writes them, in the units of this package (SI)."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import TypeVar, cast

from geomtorsion.errors import ExpressionError, GeomtorsionError, UnitError
from geomtorsion.exact.parsing import parse_expression
from geomtorsion.support.checks import cut, known_name, shown
from geomtorsion.support.exclusive import exclusive

T = TypeVar("T")

# Exponents of kilogram, metre, second, ampere and angle.
_Powers = tuple[int, int, int, int, int]
_NONE: _Powers = (0, 0, 0, 0, 0)
_BASES = ("kg", "m", "s", "A", "rad")

_NUMBER = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_GLUED = re.compile(rf"\s*([-+]?{_NUMBER})([^\W0-9_].*|°.*)", re.DOTALL)
_PLAIN = re.compile(rf"\s*[-+]?{_NUMBER}\s*")
_NOT_FINITE = re.compile(r"\s*[-+]?(inf|infinity|nan)\s*", re.IGNORECASE)
_PIECE = re.compile(
    r"\s*(?:([*/·])\s*)?(?:(1(?![0-9.]))|([^\W0-9_]+|°)(?:(?:\^|\*\*)([-+]?[0-9]+))?)"
)
_HERTZ = "Hz leaves open whether turns or radians are meant: write rad/s, rpm or turn/s"


@dataclass(frozen=True)
class Unit:
    """A unit: how much it is in SI units, and of which kind.

    text: as it was written. scale: its size in kg, m, s, A, rad. powers: of these five.
    """

    text: str
    scale: float
    powers: _Powers

    @property
    def kind(self) -> str:
        """The unit in base units, for messages.

        Examples
        --------
        >>> unit("N m").kind, unit("rpm").kind
        ('kg*m^2/s^2', 'rad/s')
        """
        above, below = "", ""
        for base, power in zip(_BASES, self.powers, strict=True):
            mark = base if abs(power) == 1 else f"{base}^{abs(power)}"
            above += f"*{mark}" if power > 0 else ""
            below += f"/{mark}" if power < 0 else ""
        return (above.removeprefix("*") or "1") + below


def _table() -> dict[str, tuple[float, _Powers]]:
    """Every unit by name."""
    mass, length, time = (1, 0, 0, 0, 0), (0, 1, 0, 0, 0), (0, 0, 1, 0, 0)
    current, angle = (0, 0, 0, 1, 0), (0, 0, 0, 0, 1)
    force, energy, power = (1, 1, -2, 0, 0), (1, 2, -2, 0, 0), (1, 2, -3, 0, 0)
    found: dict[str, tuple[float, _Powers]] = {
        "kg": (1.0, mass), "g": (1e-3, mass), "mg": (1e-6, mass),
        "m": (1.0, length), "nm": (1e-9, length), "mm": (1e-3, length), "cm": (1e-2, length),
        "km": (1e3, length),
        "s": (1.0, time), "ms": (1e-3, time), "us": (1e-6, time), "µs": (1e-6, time),
        "min": (60.0, time), "h": (3600.0, time), "day": (86400.0, time),
        "rad": (1.0, angle), "radian": (1.0, angle), "radians": (1.0, angle),
        "mrad": (1e-3, angle), "deg": (math.pi / 180, angle), "°": (math.pi / 180, angle),
        "degree": (math.pi / 180, angle), "degrees": (math.pi / 180, angle),
        "turn": (2 * math.pi, angle), "turns": (2 * math.pi, angle), "rev": (2 * math.pi, angle),
        "rpm": (2 * math.pi / 60, (0, 0, -1, 0, 1)),
        "N": (1.0, force), "mN": (1e-3, force), "kN": (1e3, force),
        "J": (1.0, energy), "mJ": (1e-3, energy), "kJ": (1e3, energy), "Nm": (1.0, energy),
        "W": (1.0, power),
        "A": (1.0, current), "mA": (1e-3, current),
        "T": (1.0, (1, 0, -2, -1, 0)), "mT": (1e-3, (1, 0, -2, -1, 0)),
        "uT": (1e-6, (1, 0, -2, -1, 0)), "µT": (1e-6, (1, 0, -2, -1, 0)),
        "nT": (1e-9, (1, 0, -2, -1, 0)),
        "Hz": (1.0, (0, 0, -1, 0, 0)),
    }  # fmt: skip
    return found


UNITS: Mapping[str, tuple[float, _Powers]] = _table()


@cache
def unit(text: str) -> Unit:
    """Read a unit.

    Raises
    ------
    UnitError
        A part of it is not a known unit; the message names the nearest.

    Examples
    --------
    >>> unit("km/h").scale * 36
    10.0
    >>> unit("m s^-2") == unit("m/s^2")
    False
    >>> unit("m s^-2").powers == unit("m/s^2").powers
    True
    """
    scale, powers, place = 1.0, list(_NONE), 0
    text = text.strip()
    while place < len(text):
        piece = _PIECE.match(text, place)
        if piece is None:
            raise UnitError(f"{text!r} is not a unit. Write for instance m/s^2, kg m^2 or rad/s.")
        sign, one, name, exponent = piece.groups()
        place = piece.end()
        # In 1/s, the 1 itself is not a unit.
        if one:
            continue
        known_name(name, UNITS, "", UnitError, expected="a unit")
        size, kind = UNITS[name]
        try:
            power = int(exponent or 1) * (-1 if sign == "/" else 1)
            scale *= size**power
        # Python reads no whole number of 5,000 digits, and floats end at 1e308.
        except (OverflowError, ValueError):
            scale, power = math.inf, 0
        if not 0 < scale < math.inf:
            raise UnitError(f"{cut(text)!r} is too large for a number. Write a smaller exponent.")
        powers = [a + power * b for a, b in zip(powers, kind, strict=True)]
    return Unit(text, scale, (powers[0], powers[1], powers[2], powers[3], powers[4]))


def with_unit(text: str) -> tuple[str, Unit | None]:
    """Split an expression from the unit after it; None where there is no unit.

    Examples
    --------
    >>> with_unit("9.81 m/s^2")[0], with_unit("2*pi rad/s")[1].text, with_unit("3rpm")[0]
    ('9.81', 'rad/s', '3')
    >>> with_unit("sqrt(2)/2")
    ('sqrt(2)/2', None)
    """
    if _PLAIN.fullmatch(text):
        return text, None
    for head, tail in _splits(text):
        # Two adjacent words do not form an expression: the second must be a unit.
        if re.match(r"[^\W0-9_]|°|1\s*/", tail) and _is_unit(tail):
            return head, unit(tail)
    return text, None


def _splits(text: str) -> Iterator[tuple[str, str]]:
    """Positions at which a unit may begin: after a number, after any blank."""
    glued = _GLUED.fullmatch(text)
    if glued is not None:
        yield glued[1], glued[2]
    for blank in re.finditer(r"\s+", text):
        head, tail = text[: blank.start()], text[blank.end() :]
        if head.strip() and head.rstrip()[-1] not in "+-*/^(," and tail:
            yield head, tail


def _is_unit(text: str) -> bool:
    """Whether a text is made of pieces of units only, known ones or not."""
    place = 0
    while place < len(text):
        piece = _PIECE.match(text, place)
        if piece is None or piece.end() == place:
            return False
        place = piece.end()
    return True


def scale_of(given: Unit, field: str) -> float:
    """How many of a field's units one of the given units is.

    Raises
    ------
    UnitError
        The two do not measure the same.

    Examples
    --------
    >>> scale_of(unit("cm"), "m")
    0.01
    >>> scale_of(unit("m/s"), "m/s^2")
    Traceback (most recent call last):
    geomtorsion.errors.UnitError: expected a value in m/s^2, got the unit m/s.
    """
    wanted = unit(field)
    if given.powers[:4] == wanted.powers[:4]:
        # A person who writes Hz may mean turns; a wrong guess would be wrong by 2 pi.
        if "Hz" in given.text and wanted.powers[4]:
            raise UnitError(f"{_HERTZ}.")
        # The unit of an angle may be omitted, as in 1/s, but not added where no angle is measured.
        if given.powers[4] in (0, wanted.powers[4]):
            return given.scale / wanted.scale
    needed = f"a value in {field}" if field else "a plain number, without a unit"
    raise UnitError(f"expected {needed}, got the unit {given.text}.")


def quantity(value: object, field: str = "") -> float:
    """A number in the unit of a field: a number as it is, or text such as "9.81 m/s^2".

    Parameters
    ----------
    value
        A number, or an expression without names (pi and sqrt may occur), with a unit or without.
    field
        The unit in which the field is measured, for instance "m/s^2"; empty for plain numbers.

    Raises
    ------
    UnitError
        The unit is unknown, or measures something else.
    ExpressionError
        The text is not a number.

    Examples
    --------
    >>> quantity("30 deg", "rad") == 30 * math.pi / 180, quantity("1/4"), quantity(2)
    (True, 0.25, 2)
    >>> quantity("3 rpm", "m")
    Traceback (most recent call last):
    geomtorsion.errors.UnitError: expected a value in m, got the unit rpm.
    """
    # True is an int in Python, but not a number here.
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ExpressionError(
            f'expected a number, got {value!r}. Write 9.81, "sqrt(2)/2" or "9.81 m/s^2".'
        )
    if not isinstance(value, str):
        number: float = value
        given = None
    else:
        expression, given = with_unit(value)
        number = _value(expression)
    if given is not None:
        number = number * scale_of(given, field)
    if not abs(number) <= sys.float_info.max:
        written = value if isinstance(value, str) else shown(value)
        raise ExpressionError(f"expected a finite number, got {cut(written)}.")
    return number


def in_unit(value: T, field: str, name: str, error: type[GeomtorsionError]) -> T:
    """The value with texts such as "3 rpm" read in the unit of a field, also within lists.

    Everything else, such as a text without a number, stays as it is, for the checks of its own.

    Raises
    ------
    The given error, with the name
        The unit is unknown, or measures something else.

    Examples
    --------
    >>> from geomtorsion.errors import StartError
    >>> in_unit(("30 rpm", 0, 1), "rad/s", "omega", StartError) == (math.pi, 0, 1)
    True
    """
    if isinstance(value, str):
        try:
            return cast(T, quantity(value, field))
        except ExpressionError:
            return value
        except UnitError as unread:
            raise error(f"{name}: {unread}") from None
    if isinstance(value, list | tuple):
        return cast(T, tuple(in_unit(part, field, name, error) for part in value))
    return value


@exclusive
def _value(text: str) -> float:
    """The value of an expression without names."""
    if _PLAIN.fullmatch(text) or _NOT_FINITE.fullmatch(text):
        return float(text)
    read = parse_expression(text, {}, {}, where="number", decimals=True)
    if not read.is_real:
        raise ExpressionError(f"expected a real number, got {text!r}.")
    # Thirty digits first, so that the double is the nearest one.
    return float(read.evalf(30))

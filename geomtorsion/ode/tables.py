"""Tables: functions given by rows of numbers, joined by polynomials from row to row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # loads its parts on first use
import sympy as sp

from geomtorsion.errors import ExpressionError, FileFormatError
from geomtorsion.ode.pieces import ends, joined
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property, read_only
from geomtorsion.support.copies import ByContent
from geomtorsion.support.files import read_text

INTERPOLATIONS = ("cubic", "monotone", "linear", "steps", "akima")
OUTSIDE = ("refuse", "hold")


@dataclass(frozen=True, eq=False)
class Table(ByContent):
    """Function of one number, from rows (place, value); it has no free parameters.

    places: shape (m,), increasing. values: shape (m,).
    interpolation: "cubic" (spline with two continuous derivatives), "monotone" (cubic without
        overshoot: PCHIP), "akima", "linear", or "steps" (each value holds up to the next place).
    outside: the values before the first and after the last row: "refuse" (a motion that gets there
        raises an error) or "hold" (the first and the last value).

    A solver restarts at each row, where a derivative of the function jumps.

    Raises
    ------
    ExpressionError
        fewer than two rows, places that do not increase, numbers that are not finite, or an
        unknown interpolation.
    FileFormatError
        a row of the file does not consist of two numbers.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, solve
    >>> thrust = Table.of([(0, 0), (1, 2), (3, 2)], "linear")
    >>> rocket = ODE.of({"v": "F(t)"}, [0], tables={"F": thrust})
    >>> solve(rocket, [1, 3])["v"].round(9).tolist()
    [1.0, 5.0]
    """

    places: np.ndarray
    values: np.ndarray
    interpolation: str = "cubic"
    outside: str = "refuse"

    @classmethod
    def of(
        cls,
        rows: object,
        interpolation: str = "cubic",
        outside: str = "refuse",
    ) -> Table:
        """Table from rows (place, value), or from a text file with two columns.

        rows: shape (m, 2), or the path of a file: two numbers in each line, with a comma, a
        semicolon or blanks between them; lines that begin with # and a line of names are skipped.

        Examples
        --------
        >>> Table.of([(0, 1), (1, 3)], "linear")(0.5)
        2.0
        """
        if isinstance(rows, str | PathLike):
            rows = _rows_of(Path(rows))
        array = checks.array(rows, "table", ExpressionError)
        if array.ndim != 2 or array.shape[1] != 2:
            raise ExpressionError(
                f"table: expected at least two rows (place, value), got shape {array.shape}. Give "
                "two numbers in each row."
            )
        return cls(array[:, 0], array[:, 1], interpolation, outside)

    def __post_init__(self) -> None:
        """Check the rows and the names once."""
        checks.choice(self.interpolation, INTERPOLATIONS, "interpolation", ExpressionError)
        checks.choice(self.outside, OUTSIDE, "outside", ExpressionError)
        places = checks.array(self.places, "places", ExpressionError, shape=(None,))
        values = checks.array(self.values, "values", ExpressionError, shape=(None,))
        if len(places) < 2 or len(places) != len(values):
            raise ExpressionError(
                f"table: expected at least two rows (place, value), got places of shape "
                f"{places.shape} and values of shape {values.shape}. Give one value for each place."
            )
        bad = np.flatnonzero(np.diff(places) <= 0)
        if len(bad):
            k = int(bad[0])
            raise ExpressionError(
                f"table: expected increasing places, got {places[k]:.9g} before "
                f"{places[k + 1]:.9g} in row {k + 2}. Sort the rows, and keep one of each place."
            )
        object.__setattr__(self, "places", read_only(places.copy()))
        object.__setattr__(self, "values", read_only(values.copy()))

    def __repr__(self) -> str:
        low, high = self.places[[0, -1]].tolist()
        rows = f"{len(self.places)} rows from {low:.6g} to {high:.6g}"
        return f"Table of {rows}, {self.interpolation}"

    @cached_property
    def _coefficients(self) -> np.ndarray:
        """Polynomials in x - place for each interval, highest power first, shape (order, m - 1)."""
        x, y = self.places, self.values
        if self.interpolation == "steps":
            return y[None, :-1]
        if self.interpolation == "linear" or len(x) == 2:
            return np.array([np.diff(y) / np.diff(x), y[:-1]])
        kinds = scipy.interpolate
        made = {
            "cubic": kinds.CubicSpline, "monotone": kinds.PchipInterpolator,
            "akima": kinds.Akima1DInterpolator,
        }[self.interpolation](x, y)  # fmt: skip
        return made.c

    @cached_property
    def function(self) -> type[sp.Function]:
        """The table as a function of sympy, for text."""

        class Rows(sp.Function):
            """The table of rows."""

            @classmethod
            def eval(cls, *places: sp.Expr) -> sp.Expr:
                if len(places) != 1:
                    raise ExpressionError(
                        f"table: expected one argument, got {len(places)}. Write F(t)."
                    )
                return self._of(places[0])

        return Rows

    def __call__(self, place: object) -> Any:
        """The function of an expression, exact between the rows; of numbers, a float or an array.

        Raises
        ------
        ExpressionError
            a number is outside of a table that refuses it.

        Examples
        --------
        >>> table = Table.of([(0, 1), (1, 3)], "linear")
        >>> table(0.5), table(sp.Rational(1, 2)), table([0, 0.25]).tolist()
        (2.0, 2, [1.0, 1.5])
        """
        if isinstance(place, sp.Expr):
            return self._of(place)
        numbers = checks.array(place, "place", ExpressionError)
        low, high = self.places[[0, -1]].tolist()
        outside = (numbers < low) | (numbers > high)
        if self.outside == "refuse" and outside.any():
            raise ExpressionError(
                f"place: expected numbers from {low:.6g} to {high:.6g}, got "
                f'{numbers[outside].ravel()[0]:.6g}. Give more rows, or outside="hold".'
            )
        values = [float(self._of(_exact(x))) for x in numbers.ravel()]
        return np.reshape(values, numbers.shape) if numbers.ndim else values[0]

    def _of(self, term: sp.Expr) -> sp.Expr:
        """The function of an expression."""
        levels = [_exact(x) for x in self.places]
        rows = zip(levels, self._coefficients.T, strict=False)
        branches = [_polynomial(term - level, column) for level, column in rows]
        first, last = _exact(self.values[0]), _exact(self.values[-1])
        # The last row itself belongs to the table.
        levels[-1] = _exact(np.nextafter(self.places[-1], np.inf))
        if self.outside == "refuse":
            first = last = ends(term)
        return joined(term, levels, [first, *branches, last])


def _exact(value: float) -> sp.Rational:
    return sp.Rational(*float(value).as_integer_ratio())


def _polynomial(x: sp.Expr, column: Sequence[float]) -> sp.Expr:
    """Polynomial in Horner's form."""
    total: sp.Expr = sp.S.Zero
    for number in column:
        total = total * x + _exact(number)
    return total


def _rows_of(path: Path) -> list[list[float]]:
    """Two numbers from each line of a file."""
    rows: list[list[float]] = []
    for number, line in enumerate(read_text(path).splitlines(), 1):
        words = line.replace(";", " ").replace(",", " ").split()
        if not words or words[0].startswith("#"):
            continue
        try:
            row = [float(word) for word in words]
        except ValueError:
            row = []
        if len(row) != 2:
            if not rows and not row and len(words) == 2:
                # Names of the columns.
                continue
            raise FileFormatError(
                f"{path.name}, line {number}: expected two numbers, got {checks.shown(line)}. "
                "Write a place and a value in each line."
            )
        rows.append(row)
    return rows

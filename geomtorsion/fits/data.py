"""Data: measured numbers by name, with their noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from geomtorsion.errors import ShapeError, StartError, UnknownNameError
from geomtorsion.support import checks
from geomtorsion.support.copies import ByContent

# One number for all data of a quantity, or one for each; None: columns sigma_NAME of the data.
Noise: TypeAlias = "float | Sequence[float] | np.ndarray | Mapping[str, object] | None"
NOISE = "sigma_"


@dataclass(frozen=True, eq=False)
class Data(ByContent):
    """Measured numbers with their noise, NaN where one is missing.

    at: times, or numbers of loops, shape (m,).
    values, sigma: name -> numbers and their standard deviations, shape (m,) or (m, k) each.
    """

    at: np.ndarray
    values: Mapping[str, np.ndarray]
    sigma: Mapping[str, np.ndarray]

    @classmethod
    def of(cls, at: np.ndarray, data: object, sigma: object, quantities: Sequence[str]) -> Data:
        """Checked data of some quantities.

        sigma: None for the entries sigma_NAME of the data.

        Raises
        ------
        UnknownNameError, ShapeError, StartError
            A name is unknown, an array has another length, or a sigma is not positive.
        """
        values, noise = {}, {}
        table = checks.by_name(data, "data", StartError)
        if sigma is None:
            sigma = {x.removeprefix(NOISE): table.pop(x) for x in list(table) if NOISE in x[:6]}
        for name, entry in table.items():
            kind, remedy = "quantities of the model", "Choose the columns of these names."
            checks.known_name(
                name, quantities, "data", UnknownNameError, expected=kind, remedy=remedy
            )
            values[name] = _array(entry, name, len(at))
            noise[name] = _positive(sigma, name, values[name])
        if not any(np.isfinite(x).any() for x in values.values()):
            raise StartError("data: expected name -> numbers, got none.")
        return cls(at, values, noise)

    @classmethod
    def column(cls, data: object, name: str) -> tuple[object, dict[str, object]]:
        """The column with a name, which may be an index of the table, and the other columns."""
        table: Any = data
        columns = checks.by_name(data, "data", StartError)
        own: Any = getattr(table, "coords", {})
        index = getattr(table, "index", None)
        if name in columns:
            times = columns.pop(name)
        elif name in own:
            times = own[name]
        elif index is not None and getattr(index, "name", None) == name:
            times = index
        else:
            listed = ", ".join(columns) or "none"
            raise UnknownNameError(
                f"times: expected the times, or the name of a column, got {name!r}. "
                f"The columns are {listed}."
            )
        return np.asarray(times), columns

    @property
    def present(self) -> Mapping[str, np.ndarray]:
        """Where there are numbers."""
        return {name: np.isfinite(values) for name, values in self.values.items()}

    def compared(self, name: str, prediction: np.ndarray) -> np.ndarray:
        """(prediction - data) / sigma of one name, where there are data, shape (N,)."""
        if prediction.shape != self.values[name].shape:
            raise ShapeError(
                f"data of {name}: expected shape {prediction.shape}, got {self.values[name].shape}."
            )
        here = self.present[name]
        return ((prediction - self.values[name]) / self.sigma[name])[here]

    def slopes(self, name: str, columns: Sequence[np.ndarray]) -> np.ndarray:
        """Derivatives of the numbers of `compared`, from the predictions', shape (N, k)."""
        here, sigma = self.present[name], self.sigma[name]
        return np.stack([(column / sigma)[here] for column in columns], axis=1)

    def laid_out(self, row: np.ndarray) -> dict[str, np.ndarray]:
        """Numbers of all data in a row, by name and in the shape of the data."""
        table, first = {}, 0
        for name, here in self.present.items():
            table[name] = np.full(here.shape, np.nan)
            last = first + int(here.sum())
            table[name][here] = row[first:last]
            first = last
        return table


def _array(entry: object, name: str, length: int) -> np.ndarray:
    """Numbers of one name."""
    numbers = _floats(entry)
    if numbers.ndim not in (1, 2) or len(numbers) != length or np.isinf(numbers).any():
        raise ShapeError(
            f"data of {name}: expected {length} finite numbers (or NaN), got {checks.shown(entry)}."
        )
    return numbers


def _floats(entry: object) -> np.ndarray:
    """Numbers as floats, NaN where one is missing; nothing for what holds no numbers."""
    table: Any = entry
    try:
        if hasattr(table, "isna"):
            # A column of pandas has marks of its own for missing numbers.
            return table.astype("Float64").to_numpy(dtype=float, na_value=np.nan)
        return np.array(table, dtype=float)
    except (TypeError, ValueError):
        return np.zeros(0)


def _positive(sigma: object, name: str, values: np.ndarray) -> np.ndarray:
    """Standard deviations of the data of one name; any where a number is missing."""
    shape = values.shape
    if isinstance(sigma, Mapping):
        table = checks.by_name(sigma, "sigma", StartError)
        remedy = f"Give sigma, or a column {NOISE}{name}."
        checks.check_values((name,), table, "sigma", StartError, remedy)
        sigma = table[name]
    try:
        array = np.broadcast_to(_floats(sigma), shape).copy()
    except ValueError:
        array = np.zeros(shape)
    array[np.isnan(values)] = 1.0
    if not (np.isfinite(array) & (array > 0)).all():
        raise StartError(
            f"sigma of {name}: expected positive numbers, one or as many as data, got "
            f"{checks.shown(sigma)}."
        )
    return array

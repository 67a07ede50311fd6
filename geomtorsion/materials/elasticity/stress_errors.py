"""Errors of stresses: noise of the data, their grid, and the unknown crystal outside a map."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from geomtorsion.materials.elasticity.cell import Cell
from geomtorsion.materials.elasticity.constants import ElasticConstants
from geomtorsion.materials.elasticity.nye_field import NyeField, checked_frame
from geomtorsion.materials.elasticity.readings import Reading
from geomtorsion.materials.elasticity.torsion import TorsionModes
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.grid_circuits import unexplained
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import CALCULATED

# Random fields of noise: the spread of a standard deviation from N fields is 1 / sqrt(2 N), 13 %.
DRAWS = 32


@dataclass(frozen=True, eq=False, repr=False)
class StressErrors:
    """Errors of stresses, by their causes; all in the unit of the stress and of its shape.

    noise: standard deviation from the noise of the data, zero where the noise is not known.
    grid: error of the differences on the grid, without the share of the noise.
    outside: error from the unknown crystal outside a map, for a perfect crystal there.
    At nodes outside a map all three are NaN, because nothing was measured there.
    """

    noise: np.ndarray
    grid: np.ndarray
    outside: np.ndarray
    unit: str = ""

    @classmethod
    def of_grid(cls, grid: np.ndarray, unit: str) -> StressErrors:
        """Errors of the grid only, of data without noise and without a border."""
        return cls(np.zeros_like(grid), grid, np.zeros_like(grid), unit)

    @cached_property
    def total(self) -> np.ndarray:
        """One standard error: the three causes, added in quadrature."""
        return np.sqrt(self.noise**2 + self.grid**2 + self.outside**2)

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        parts = {"noise": self.noise, "grid": self.grid, "outside": self.outside}
        sizes = (f"{name} {_largest(x):.2g}{unit}" for name, x in parts.items())
        return f"StressErrors(largest: {', '.join(sizes)})"


def _largest(values: np.ndarray) -> float:
    """The largest value that is known, 0 without any."""
    return float(np.nanmax(values, initial=0.0))


@dataclass(frozen=True, eq=False)
class Spread:
    """How a result changes with the noise of its data, the rule of their grid, and the padding.

    source: a coframe or a Nye field. relax: modes of least energy. modes: of the result.
    """

    source: SampledFrame | NyeField
    torsion: TorsionModes
    relax: Callable[[np.ndarray, Cell, np.ndarray], np.ndarray]
    cell: Cell
    waves: np.ndarray
    modes: np.ndarray

    def errors(
        self, reading: Reading, is_measured: np.ndarray | bool = True, unit: str = ""
    ) -> StressErrors:
        """Errors of numbers that depend on the modes in any way; NaN where nothing is measured."""
        value = reading(self.cell, self.waves, self.modes)

        def change(modes: np.ndarray) -> np.ndarray:
            return reading(self.cell, self.waves, self.modes + modes) - value

        noise, less = np.zeros_like(value), np.zeros_like(value)
        if self._has_noise:
            # Equal calls give equal bits.
            rng = np.random.default_rng(0)
            for _ in range(DRAWS):
                one, two = self._draw(rng)
                noise += change(one) ** 2 / DRAWS
                less += change(two) ** 2 / DRAWS
        grid = unexplained(np.abs(change(-self._beyond())), less)
        blank = np.where(is_measured, 0.0, np.nan)
        outside = self._outside(value, reading)
        return StressErrors(np.sqrt(noise) + blank, grid + blank, outside + blank, unit)

    def at_nodes(self, constants: ElasticConstants) -> StressErrors:
        """Errors of the stress at all nodes, shape (3, 3, grid...)."""
        shape = self._measured

        def read(cell: Cell, waves: np.ndarray, modes: np.ndarray) -> np.ndarray:
            # A smaller cell has the same nodes within the map.
            values = constants.stress(cell.field(modes, waves))
            return values[..., : shape[0], : shape[1], : shape[2]]

        inner = self.errors(read, unit=constants.unit)
        wider = [(0, 0)] * 2 + [(0, n - m) for n, m in zip(self.cell.shape, shape, strict=True)]
        noise, grid, outside = (
            np.pad(x, wider, constant_values=np.nan)
            for x in (inner.noise, inner.grid, inner.outside)
        )
        return StressErrors(noise, grid, outside, constants.unit)

    @property
    def _measured(self) -> tuple[int, ...]:
        """Number of measured nodes along each edge."""
        return self.source.measured if isinstance(self.source, NyeField) else self.cell.shape

    def is_measured(self, points: np.ndarray) -> np.ndarray:
        """Whether points are within the map, shape (points, 3) -> (points,)."""
        shares = (points - np.asarray(self.cell.box.origin)) @ self.cell.box.inverse
        nodes, last = shares * np.array(self.cell.shape), np.array(self._measured) - 1
        everywhere = last + 1 == np.array(self.cell.shape)
        within = (nodes >= -CALCULATED) & (nodes <= last + CALCULATED)
        return (everywhere | within).all(axis=1)

    @property
    def _has_noise(self) -> bool:
        if isinstance(self.source, NyeField):
            return self.source.sigma is not None
        return self.source.noise is not None

    def _solved(self, values: np.ndarray) -> np.ndarray:
        """Modes of least energy of other data at the same nodes."""
        name = "distortion" if self.torsion.alpha is None else "alpha"
        torsion = replace(self.torsion, **{name: values})
        return self.relax(torsion.modes(self.cell, self.waves), self.cell, self.waves)

    def _short(self, modes: np.ndarray) -> np.ndarray:
        """The part of modes in waves shorter than four steps."""
        high = np.any(np.abs(self.waves) > np.array(self.cell.shape) // 4, axis=1)
        return np.where(high[:, None, None], modes, 0.0)

    def _beyond(self) -> np.ndarray:
        """Modes that another rule of the grid lacks."""
        rival = self.source.rival() if isinstance(self.source, NyeField) else None
        return self._short(self.modes) if rival is None else self.modes - self._solved(rival)

    def _draw(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """Modes of random noise, and the part that another rule of the grid lacks."""
        if isinstance(self.source, NyeField):
            values, rival = self.source.draw(rng)
            modes = self._solved(values)
            return modes, self._short(modes) if rival is None else self._solved(values - rival)
        coframe, inverse = checked_frame(self.source)
        assert self.source.noise is not None
        rows, columns = self.source.coframe.shape[:2]
        drawn = np.zeros_like(coframe)
        values = self.source.noise.draw(self.source.coframe.shape, rng)
        drawn[:rows, :columns] = values.reshape(rows, columns, *drawn.shape[2:])
        modes = self._solved(np.tensordot(inverse, drawn, 1))
        return modes, self._short(modes)

    def _outside(self, value: np.ndarray, reading: Reading) -> np.ndarray:
        """Change of a result towards a larger and larger crystal around the map.

        Images at the distance L act as 1 / L^2 if no net b is left; the change from a smaller cell
        to this one is extrapolated by this law.
        """
        smaller = self.source.in_smaller_cell() if isinstance(self.source, NyeField) else None
        if smaller is None:
            return np.zeros_like(value)
        cell = Cell(smaller.box, smaller.shape)
        waves = cell.waves()
        torsion = replace(self.torsion, alpha=smaller.values)
        modes = self.relax(torsion.modes(cell, waves), cell, waves)
        wider = [n / m for n, m in zip(self.cell.shape, smaller.shape, strict=True) if n > m]
        return np.abs(value - reading(cell, waves, modes)) / (min(wider) ** 2 - 1)

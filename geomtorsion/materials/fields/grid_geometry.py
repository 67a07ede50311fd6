"""Grid geometry: curvature and other tensors of a frame on a grid, by the exact formulas."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import scipy  # loads its subpackages at first use
import sympy as sp

from geomtorsion.errors import GridError
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.geometry.numeric.frames import numeric_frame
from geomtorsion.geometry.numeric.grid_values import GridValues
from geomtorsion.geometry.numeric.numeric_field import Numeric, NumericField
from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.materials.fields.densities import Density
from geomtorsion.materials.fields.differences import Differences
from geomtorsion.materials.fields.grid import Grid, signs_of
from geomtorsion.materials.fields.samples import Samples


@dataclass(frozen=True, eq=False)
class GridGeometry:
    """A frame whose components are values at the nodes of a grid.

    frame: over the field of these values. differences: their derivatives.
    """

    frame: Frame
    differences: Differences

    @classmethod
    def of(
        cls,
        differences: Differences,
        coframe: np.ndarray,
        signature: Sequence[int],
        values: Mapping[str, Any],
        coordinates: Sequence[sp.Symbol] = (),
    ) -> GridGeometry:
        """The geometry of a coframe of shape (n, n, grid...); values: see `at_two_steps`."""
        n, grid = len(coframe), differences.grid
        coordinates = tuple(coordinates) or sp.symbols(f"x0:{n}", real=True)
        field = NumericField(coordinates, GridValues(grid.shape, differences), dict(values))
        eta = {(i, i): field.rational(sign) for i, sign in enumerate(signature)}
        made = cls(Frame(coordinates, np.eye(n, dtype=int).tolist(), list(signature)), differences)
        entries = {
            (i, mu): made.element(coframe[i, mu], field) for i, mu in product(range(n), repeat=2)
        }
        given = {index: x for index, x in entries.items() if not x.is_zero}
        return cls(numeric_frame(made.frame, field, {"coframe": given, "eta": eta}), differences)

    def element(self, values: np.ndarray, field: Any = None) -> Numeric:
        """Values at the nodes as a component; one value at all nodes is a constant."""
        field = self.frame.field if field is None else field
        holes = self.differences.grid.holes
        known = values[~holes]
        if known.size and (known == known[0]).all():
            constant = float(known[0])
            return field.element(int(constant) if constant.is_integer() else constant)
        return field.element(np.where(holes, np.nan, values))

    def tensor(self, values: np.ndarray, slots: str) -> Tensor:
        """Values of shape (n, ..., grid...) as a tensor with these slots."""
        places = product(range(self.frame.dimension), repeat=len(slots))
        return Tensor(self.frame, slots, {k: self.element(values[k]) for k in places})

    def values(self, tensor: Tensor) -> tuple[np.ndarray, int]:
        """Components at the nodes, shape (n, ..., grid...), and the number of derivatives."""
        grid, n = self.differences.grid, self.frame.dimension
        array = np.empty((n,) * len(tensor.slots) + grid.shape)
        depth = 0
        for index in product(range(n), repeat=len(tensor.slots)):
            component: Any = tensor.components.get(index)
            array[index], depth = component.value, max(depth, component.depth)
        array[..., grid.holes] = np.nan
        return array, depth


# Factor of safety of an error from two steps [Roache, J. Fluids Eng. 116 (1994) 405].
SAFETY = 3.0
# Values at the nodes and number of derivatives, by name.
Values = dict[str, tuple[np.ndarray, int]]
# Tensors by their names, from a geometry on the grid.
Formulas = Callable[[GridGeometry], Mapping[str, Tensor]]


@dataclass(frozen=True, eq=False)
class TwoSteps:
    """Tensors at the nodes from differences of one step and of two.

    samples: the frame. fine, coarse: for one step and for two. share: error of a value as a share
    of the difference between both, shape (N_1, ..., N_d).
    """

    samples: Samples
    fine: Values
    coarse: Values
    share: np.ndarray

    @property
    def inside(self) -> np.ndarray:
        """Nodes where the share is smallest, because stencils are centred; all for order 2."""
        return self.share == self.share.min()

    def error(self, differences: np.ndarray) -> np.ndarray:
        """Error of values from their differences from twice the step, shape (..., grid...).

        The largest difference of neighbouring nodes counts, because it may vanish at a node by
        chance. Noise and rounding differ between neighbours, and a smaller step makes more of
        them: they count in full. NaN stays.
        """
        grid = self.samples._grid
        tensors = (1,) * (differences.ndim - grid.dimension)
        unknown = np.isnan(differences)
        filled = np.where(unknown, 0.0, differences)
        widest = _widest(np.abs(filled), grid, tensors, 1)
        size, mode = _window(grid, tensors, 1)
        mean, count = (
            scipy.ndimage.uniform_filter(x, size, mode=mode) for x in (filled, 1.0 * ~unknown)
        )
        mean = np.divide(mean, count, out=np.zeros_like(mean), where=~unknown)
        rough = np.where(unknown, 0.0, np.abs(filled - mean))
        error = np.maximum(widest * self.share, _widest(rough, grid, tensors, 1))
        return np.where(unknown, np.nan, error)

    def density(self, name: str) -> Density:
        """A tensor with its error; all its components share the rounding of the largest."""
        (values, depth), (other, _) = self.fine[name], self.coarse[name]
        largest = float(np.nanmax(np.abs(values), initial=0.0))
        error = self.error(other - values) + ROUNDING * largest
        unit = f"1/{self.samples.unit}" if depth and self.samples.unit else ""
        unit += f"^{depth}" if unit and depth > 1 else ""
        unknown = np.isnan(error)
        sigma = np.where(unknown, np.nan, 0.0)
        return Density(np.where(unknown, np.nan, values), error, sigma, unit)


def at_two_steps(
    samples: Samples,
    formulas: Formulas,
    values: Mapping[str, Any] | None = None,
    coordinates: Sequence[sp.Symbol] = (),
) -> TwoSteps:
    """Tensors of a sampled frame at the nodes, from differences of one step and of two.

    Parameters
    ----------
    formulas
        Function of a `GridGeometry` with the tensors by name.
    values
        Number, or array on the grid, of each name in the formulas.
    coordinates
        Symbols of the axes in the formulas.

    Raises
    ------
    GridError
        There are not as many rows as axes, the grid is too small for twice the step, or the frame
        comes from a displacement.
    """
    grid = samples._grid
    if samples.rows != samples.dimension:
        raise GridError(
            f"coframe: expected as many rows as axes for a metric, {samples.dimension}, got "
            f"{samples.rows}. Give all rows of the coframe."
        )
    if samples.displacement is not None:
        raise GridError(
            "expected a coframe or a metric for geometry, got a displacement, whose coframe is "
            "flat between its jumps. Use burgers_map for its defects."
        )
    signs = signs_of(samples.signature, samples.rows)
    results: list[Values] = []
    centred: list[np.ndarray] = []
    for stride in (1, 2):
        differences = Differences.of(grid, samples.order, stride)
        if differences.grid.holes.all():
            raise GridError(
                "mask: expected nodes with known neighbours along all axes, up to two steps away "
                "on both sides or four on one, got none. Mask fewer nodes, or give a finer grid."
            )
        centred.append(differences.centred)
        geometry = GridGeometry.of(differences, samples.coframe, signs, values or {}, coordinates)
        results.append({k: geometry.values(x) for k, x in formulas(geometry).items()})
    # Where stencils are centred, the difference is 2^order - 1 times the error; elsewhere its share
    # is not known.
    inside = SAFETY / (2.0**samples.order - 1)
    share = _widest(np.where(np.logical_and(*centred), inside, 1.0), grid, (), samples.order // 2)
    return TwoSteps(samples, results[0], results[1], share)


def _window(grid: Grid, tensors: tuple[int, ...], reach: int) -> tuple[tuple[int, ...], list[str]]:
    """Size of a neighbourhood of nodes, and how it continues beyond the edges."""
    size = (*tensors, *(2 * reach + 1,) * grid.dimension)
    mode = ["wrap" if x else "nearest" for x in (*(False,) * len(tensors), *grid.periodic)]
    return size, mode


def _widest(values: np.ndarray, grid: Grid, tensors: tuple[int, ...], reach: int) -> np.ndarray:
    """Largest value at each node and up to some nodes away."""
    size, mode = _window(grid, tensors, reach)
    return scipy.ndimage.maximum_filter(values, size, mode=mode)

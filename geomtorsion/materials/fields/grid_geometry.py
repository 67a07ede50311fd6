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
        constants: Mapping[str, float],
    ) -> GridGeometry:
        """The geometry of a coframe of shape (n, n, grid...)."""
        n, grid = len(coframe), differences.grid
        coordinates = sp.symbols(f"x0:{n}", real=True)
        field = NumericField(coordinates, GridValues(grid.shape, differences), dict(constants))
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


# Tensors by their names, from a geometry on the grid.
Formulas = Callable[[GridGeometry], Mapping[str, Tensor]]


def sampled_tensors(
    samples: Samples, formulas: Formulas, constants: Mapping[str, float] | None = None
) -> dict[str, Density]:
    """Tensors of a sampled frame at the nodes, with their errors.

    The error is the difference from twice the step. Where differences converge, it is
    2^order - 1 times the error of the values. The largest difference of neighbouring nodes counts,
    because it may vanish at a node by chance.

    Parameters
    ----------
    formulas
        Function of a `GridGeometry` with the tensors by name.
    constants
        Values of the names in the formulas.

    Raises
    ------
    GridError
        There are not as many rows as axes, the grid is too small for twice the step, or the frame
        comes from a displacement.
    """
    grid, order = samples._grid, samples.order
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
    results: list[dict[str, tuple[np.ndarray, int]]] = []
    for stride in (1, 2):
        differences = Differences.of(grid, order, stride)
        if differences.grid.holes.all():
            raise GridError(
                "mask: expected nodes with known neighbours along all axes, up to two steps away "
                "on both sides or four on one, got none. Mask fewer nodes, or give a finer grid."
            )
        geometry = GridGeometry.of(differences, samples.coframe, signs, constants or {})
        results.append({k: geometry.values(x) for k, x in formulas(geometry).items()})
    fine, coarse = results
    made = {}
    for name, (values, depth) in fine.items():
        error = _around(np.abs(coarse[name][0] - values), grid)
        # All components share the rounding of the largest.
        error += ROUNDING * np.nanmax(np.abs(values), initial=0.0)
        values = np.where(np.isnan(error), np.nan, values)
        unit = f"1/{samples.unit}" if depth and samples.unit else ""
        unit += f"^{depth}" if unit and depth > 1 else ""
        made[name] = Density(values, error, np.where(np.isnan(error), np.nan, 0.0), unit)
    return made


def _around(differences: np.ndarray, grid: Grid) -> np.ndarray:
    """Largest difference at each node and its neighbours; NaN stays."""
    tensors = (1,) * (differences.ndim - grid.dimension)
    size = (*tensors, *(3,) * grid.dimension)
    mode = ["wrap" if x else "nearest" for x in (*(False,) * len(tensors), *grid.periodic)]
    unknown = np.isnan(differences)
    filled = np.where(unknown, 0.0, differences)
    largest = scipy.ndimage.maximum_filter(filled, size, mode=mode)
    return np.where(unknown, np.nan, largest)

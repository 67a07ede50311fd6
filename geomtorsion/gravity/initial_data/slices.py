"""Slices: the metric and the extrinsic curvature of initial data, from a file of arrays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import FileFormatError, GridError
from geomtorsion.gravity.initial_data.sampled_constraints import (
    SampledConstraints,
    sampled_constraints,
)
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.grid_files import read_arrays
from geomtorsion.support import checks
from geomtorsion.support.npz import ArrayForm, text_of

FORMS = {
    "names": ArrayForm((None,), "U", optional=True),
    "axis_*": ArrayForm((None,)),
    "metric": ArrayForm((None, None, ...)),
    "extrinsic_curvature": ArrayForm((None, None, ...), optional=True),
    "density": ArrayForm((None, None, ...), optional=True),
    "momentum": ArrayForm((None, None, None, ...), optional=True),
    "mask": ArrayForm((None, None, ...), "biu", optional=True),
    "periodic": ArrayForm((None,), "b", optional=True),
    "unit": ArrayForm((), "U", optional=True),
    "source": ArrayForm((), "U", optional=True),
}


@dataclass(frozen=True, eq=False, repr=False)
class Slice:
    """Initial data on a grid.

    frame: the metric. extrinsic_curvature: K_ij, shape (d, d, N_1, ..., N_d). density: rho, shape
    (N_1, ..., N_d). momentum: j_i, shape (d, N_1, ..., N_d). None is zero.
    """

    frame: SampledFrame
    extrinsic_curvature: np.ndarray | None = None
    density: np.ndarray | None = None
    momentum: np.ndarray | None = None

    def constraints(self, cosmological_constant: float = 0.0) -> SampledConstraints:
        """Both constraints at the nodes, see `constraints`."""
        return sampled_constraints(
            self.frame, self.extrinsic_curvature, self.density, self.momentum,
            cosmological_constant,
        )  # fmt: skip

    def __repr__(self) -> str:
        names = ("extrinsic_curvature", "density", "momentum")
        given = [name for name in names if getattr(self, name) is not None]
        return f"Slice({self.frame}{', with ' if given else ''}{', '.join(given)})"


def read_slice(path: str | Path, order: int = 4) -> Slice:
    """Read initial data from an .npz file of arrays.

    metric of shape (d, d, N_1, ..., N_d) and one array axis_x, axis_y, ... for each axis, in the
    order of `names` or of the arrays in the file. Optional arrays are extrinsic_curvature, density
    and momentum, mask (1 or True at excised nodes), periodic, and the texts unit and source.

    order: of differences in the spacing, 2, 4, 6 or 8.

    Raises
    ------
    FileFormatError
        The file is missing or damaged, lacks an array, or does not hold a regular grid.
    GridError
        The order is not 2, 4, 6 or 8.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> axes = {f"axis_{name}": np.linspace(0, 1, 9) for name in "xyz"}
    >>> flat = np.eye(3)[:, :, None, None, None] * np.ones((9, 9, 9))
    >>> with TemporaryDirectory() as folder:
    ...     np.savez(f"{folder}/flat.npz", metric=flat, **axes)
    ...     found = read_slice(f"{folder}/flat.npz")
    >>> found.constraints().is_solution
    True
    """
    file = checks.file_name(path)
    checks.choice(order, (2, 4, 6, 8), "order", GridError)
    if file.suffix.lower() != ".npz":
        raise FileFormatError(
            f"{file}: expected a name ending in .npz, got {file.suffix!r}. Save the arrays by "
            "numpy.savez."
        )
    axes, names, arrays = read_arrays(file, FORMS)
    options: dict[str, Any] = {k: text_of(arrays[k]) for k in ("unit", "source") if k in arrays}
    options |= {k: arrays[k] for k in ("periodic",) if k in arrays}
    if "mask" in arrays:
        options["mask"] = arrays["mask"] != 0
    try:
        frame = SampledFrame.from_metric(axes, arrays["metric"], order, names, **options)
    except GridError as error:
        raise FileFormatError(f"{file}: {error}") from None
    fields = ("extrinsic_curvature", "density", "momentum")
    return Slice(frame, *(arrays.get(name) for name in fields))

"""Slices: the metric and the extrinsic curvature of initial data, from a file of arrays."""

from __future__ import annotations

from collections.abc import Sequence
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
from geomtorsion.materials.fields.data_sets import read_data_sets
from geomtorsion.materials.fields.grid_files import grid_options, read_arrays
from geomtorsion.support import checks
from geomtorsion.support.files import ending
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
# Arrays beside the metric, in the order of the fields of a slice.
FIELDS = ("extrinsic_curvature", "density", "momentum")
TEXTS = ("unit", "source")


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
        given = [name for name in FIELDS if getattr(self, name) is not None]
        return f"Slice({self.frame}{', with ' if given else ''}{', '.join(given)})"


def read_slice(path: str | Path, order: int = 4) -> Slice:
    """Read initial data from an .npz or .h5 file of arrays.

    The file contains the array metric, shape (d, d, N_1, ..., N_d), and one array axis_x, axis_y,
    ... for each axis, in the order of `names` or of the arrays in the file. Optional arrays are
    extrinsic_curvature, density and momentum, mask (1 or True at excised nodes), periodic, and the
    texts unit and source. In an HDF5 file (.h5, .hdf5; extra `files`) the arrays are data sets, and
    names, periodic, unit and source are attributes; names and periodic list axes, "x y z". Sizes
    are checked before memory is allocated.

    order: order of the difference formulas in the spacing, 2, 4, 6 or 8.

    Raises
    ------
    FileFormatError
        The file is missing or damaged, lacks an array, or does not hold a regular grid.
    LimitError
        An array declares an impossible size.
    MissingExtraError
        h5py is not installed.
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
    readers = {".npz": _npz, ".h5": _hdf5, ".hdf5": _hdf5}
    if (end := ending(file)) not in readers:
        raise FileFormatError(
            f"{file}: expected a name ending in .npz or .h5, got {file.suffix!r}. Save the arrays "
            "by numpy.savez or h5py."
        )
    axes, names, arrays, options = readers[end](file)
    try:
        frame = SampledFrame.from_metric(axes, arrays["metric"], order, names, **options)
    except GridError as error:
        raise FileFormatError(f"{file}: {error}") from None
    return Slice(frame, *(arrays.get(name) for name in FIELDS))


# Axes, their names, arrays, and options of the frame.
_Contents = tuple[list[np.ndarray], tuple[str, ...], dict[str, np.ndarray], dict[str, Any]]


def _npz(file: Path) -> _Contents:
    """Read an NPZ file."""
    axes, names, arrays = read_arrays(file, FORMS)
    options: dict[str, Any] = {k: text_of(arrays[k]) for k in TEXTS if k in arrays}
    options |= {k: arrays[k] for k in ("periodic",) if k in arrays}
    if "mask" in arrays:
        options["mask"] = arrays["mask"] != 0
    return axes, names, arrays, options


def _hdf5(file: Path) -> _Contents:
    """Read an HDF5 file."""

    def wanted(names: Sequence[str]) -> tuple[str, ...]:
        if "metric" not in names:
            raise FileFormatError(
                f"{file}: expected a data set metric, got {checks.shown(list(names))}. Write the "
                "metric of the slice under this name."
            )
        return ("metric", *FIELDS, "mask")

    axes, names, arrays, texts = read_data_sets(file, wanted)
    options = grid_options(file, arrays, texts)
    own = (*TEXTS, "periodic", "mask")
    return axes, names, arrays, {k: options[k] for k in own if k in options}

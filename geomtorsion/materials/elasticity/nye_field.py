"""Nye field: a density of dislocations on the nodes of a cell, measured or computed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from geomtorsion.errors import LONGEST_SHOWN, FileFormatError, GridError, NetworkError
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.lines import Box
from geomtorsion.support import checks
from geomtorsion.support.files import ending, written
from geomtorsion.support.npz import TEXT_FORM, ArrayForm, read_npz, text_of, write_npz

FORMS = {
    "nye": ArrayForm((3, 3, None, None, None)),
    "vectors": ArrayForm((3, 3)),
    "origin": ArrayForm((3,), optional=True),
    "periodic": ArrayForm((3,), "b", optional=True),
    "unit": replace(TEXT_FORM, optional=True),
}


@dataclass(frozen=True, eq=False, repr=False)
class NyeField:
    """Nye tensor alpha^{ik} at the nodes of a cell: b^i of the lines that cross area n_k.

    values: alpha^{ik}, shape (3, 3, N_1, N_2, N_3), per `unit`; first index b, second the line. A
        plane map has N_3 = 1 and lines along z, so that only alpha^{i3} may differ from zero.
    box: the cell; its nodes are at the shares 0, 1/N, ... of the edges. Where it is not periodic,
        nothing is known beyond it; see `padded`.
    unit: of lengths, any text.
    corrections: sentences about the changes to the values, in their order.

    Raises
    ------
    GridError
        Wrong shapes, values that are not finite, or lines across a plane map.

    Examples
    --------
    A measured map holds more lines of one sign; the neighbours balance them:

    >>> alpha = np.zeros((3, 3, 8, 8, 1))
    >>> alpha[0, 2, 3:5, 3:5] = 0.01
    >>> measured = NyeField(alpha, Box.of_bounds([0, 0, 0], [8, 8, 1], (False, False, True)))
    >>> measured.padded(8).balanced()
    NyeField(16 x 16 x 1 nodes, 2 corrections)
    """

    values: np.ndarray
    box: Box
    unit: str = ""
    corrections: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check shapes and numbers once."""
        shape = (3, 3, None, None, None)
        values = checks.array(self.values, "values", GridError, shape=shape)
        checks.measured(values, "values", GridError)
        checks.instance(self.box, Box, "box", GridError)
        checks.text(self.unit, "unit", GridError, longest=LONGEST_SHOWN)
        if not values.size:
            raise GridError(f"values: expected nodes, got shape {values.shape}.")
        if values.shape[-1] == 1 and values[:, :2].any():
            raise GridError(
                "values: expected lines along z in a map with one node along z, got alpha^{i1} or "
                "alpha^{i2} other than 0. Give alpha[:, 2], and zero else."
            )
        object.__setattr__(self, "values", values)

    def __repr__(self) -> str:
        parts = [f"{' x '.join(map(str, self.shape))} nodes"]
        count = len(self.corrections)
        parts += [f"in {self.unit}"] if self.unit else []
        parts += [f"{count} correction{'s' * (count > 1)}"] if count else []
        return f"NyeField({', '.join(parts)})"

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of nodes along each edge."""
        return self.values.shape[2:]

    @classmethod
    def of_frame(cls, frame: SampledFrame) -> NyeField:
        """The Nye tensor of a coframe on a grid, such as a map that is not periodic.

        b is described in the coordinates of the sample: alpha = <e>^-1 curl e with the mean <e> of
        the coframe. A plane map is repeated along z.

        Raises
        ------
        GridError
            The frame has holes, has neither two nor three axes, or its mean is singular.
        """
        checks.instance(frame, SampledFrame, "frame", GridError)
        values, inverse = checked_frame(frame)
        alpha = np.zeros((3, 3, *values.shape[2:]))
        rows = np.arange(3)[: frame.rows]
        nye = frame.nye
        # A plane map knows the last column.
        alpha[rows, 3 - nye.shape[1] :] = nye.reshape(*nye.shape[:2], *values.shape[2:])
        return cls(np.tensordot(inverse, alpha, 1), box_of(frame), frame.unit)

    def padded(self, nodes: int) -> NyeField:
        """The field in a larger cell of perfect crystal, periodic; for maps that are not.

        Parameters
        ----------
        nodes
            Number of nodes without dislocations beyond each edge that is not periodic. The field
            repeats after them, so that its images act less on it the more there are.

        Raises
        ------
        GridError
            The cell is periodic already.
        """
        checks.count(nodes, "nodes", GridError, 1)
        flags = np.asarray(self.box.periodic)
        if flags.all():
            raise GridError("padded: expected a field with open ends, got a periodic one. Omit it.")
        added = np.where(flags, 0, nodes)
        values = np.pad(self.values, [(0, 0)] * 2 + [(0, int(n)) for n in added])
        edges = np.asarray(self.box.vectors)
        share = (1 + added / np.array(self.shape))[:, None]
        text = f"Perfect crystal of {nodes} nodes surrounds the map, and the whole repeats."
        return NyeField(
            values, Box(edges * share, self.box.origin), self.unit, (*self.corrections, text)
        )

    def balanced(self) -> NyeField:
        """The field without its mean: the net b through the cell is spread with opposite sign."""
        mean = self.values.mean(axis=(2, 3, 4), keepdims=True)
        texts = (*self.corrections, balance_text(mean[..., 0, 0, 0], self.unit))
        return NyeField(self.values - mean, self.box, self.unit, texts)

    @staticmethod
    def is_in(path: str | Path) -> bool:
        """Whether a file is an .npz file with an array nye."""
        form = replace(FORMS["nye"], shape=None, optional=True)
        return ending(path) == ".npz" and bool(read_npz(path, {"nye": form}))

    @classmethod
    def read(cls, path: str | Path) -> NyeField:
        """Read an .npz file: arrays nye and vectors (edges as rows), and origin, periodic, unit.

        Raises
        ------
        FileFormatError
            The file is missing, truncated or malformed.
        """
        arrays = read_npz(path, FORMS)
        origin = arrays.get("origin", np.zeros(3))
        flags = arrays.get("periodic", np.ones(3, bool))
        unit = text_of(arrays["unit"]) if "unit" in arrays else ""
        try:
            return cls(arrays["nye"], Box(arrays["vectors"], origin, flags), unit)
        except (GridError, NetworkError) as error:
            raise FileFormatError(f"{path}: {error}") from None

    def save(self, path: str | Path) -> None:
        """Write an .npz file that `read` reads; corrections are not kept."""
        box = self.box
        arrays = {
            "nye": self.values, "vectors": box.vectors, "origin": box.origin,
            "periodic": box.periodic, "unit": self.unit,
        }  # fmt: skip
        with written(path) as file:
            write_npz(file, arrays)


def balance_text(mean: np.ndarray, unit: str) -> str:
    """What `balanced` has done."""
    over = f" per {unit}" if unit else ""
    return (
        f"The mean Nye tensor, at most {np.abs(mean).max():.3g}{over}, is spread over the cell "
        "with opposite sign."
    )


def box_of(frame: SampledFrame) -> Box:
    """The cell of a frame; a plane map is one unit thick and repeats along z."""
    sizes = [step * len(axis) for step, axis in zip(frame.steps, frame.axes, strict=True)]
    corner = [float(axis[0]) for axis in frame.axes]
    more = 3 - len(sizes)
    return Box(
        np.diag(sizes + [1.0] * more), corner + [0.0] * more, [*frame.periodic, *[True] * more]
    )


def checked_frame(frame: SampledFrame) -> tuple[np.ndarray, np.ndarray]:
    """The coframe as e[i, mu] on a grid of three axes, and the inverse of its mean.

    The perfect crystal supplies rows and columns that a plane map does not have.

    Raises
    ------
    GridError
        The frame has holes, has neither two nor three axes, or its mean is singular.
    """
    d = frame.dimension
    if d not in (2, 3) or frame.rows not in (2, 3) or frame.rows < d:
        raise GridError(
            f"frame: expected two or three axes and as many rows or three, got {d} axes and "
            f"{frame.rows} rows. Give all components."
        )
    if np.asarray(frame.mask).any():
        count = int(np.count_nonzero(frame.mask))
        raise GridError(
            f"frame: expected a coframe at every node, got {count:,} unknown nodes. Fill them, or "
            "give a NyeField with the torsion that they hold."
        )
    given = np.asarray(frame.coframe)
    values = np.zeros((3, 3, *frame.coframe.shape[2:], *(1,) * (3 - d)))
    values[: frame.rows, : given.shape[1]] = given.reshape(*given.shape[:2], *values.shape[2:])
    if frame.rows == 2:
        values[2, 2] = 1.0
    if given.shape[1] == 2:
        # The third leg is normal to the plane of the first two, in the axes of the crystal.
        normal = np.cross(*values.mean(axis=(2, 3, 4))[:, :2].T)
        values[:, 2] = normal[:, None, None, None]
    mean = values.mean(axis=(2, 3, 4))
    if not np.linalg.det(mean) > np.finfo(float).eps:
        raise GridError(
            f"frame: expected a mean coframe with positive determinant, got "
            f"{checks.shown(mean.round(6).tolist())}. Give the coframe, which is near 1 without "
            "strain: SampledFrame.from_distortion adds the 1."
        )
    return values, np.linalg.inv(mean)

"""Nye field: a density of dislocations on the nodes of a cell, measured or computed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from geomtorsion.errors import LONGEST_SHOWN, FileFormatError, GridError, NetworkError
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.cells import curl
from geomtorsion.materials.fields.grid_circuits import Field
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
    "sigma": ArrayForm((3, 3, None, None, None), optional=True),
}


@dataclass(frozen=True, eq=False)
class Curl:
    """The Nye tensor as the curl of a measured coframe, inverse @ curl e.

    field: the values of the coframe, with their noise and order. inverse: of the mean coframe.
    """

    field: Field
    inverse: np.ndarray

    def alpha(self, values: np.ndarray | None = None, *, other: bool = False) -> np.ndarray:
        """alpha^{ik} of values of a coframe, by default the measured ones, shape (3, 3, grid...).

        other: whether to use the order that estimates the error of the grid.
        """
        field = self.field if values is None else replace(self.field, values=values)
        field = replace(field, order=field.other_order) if other else field
        shape = field.grid.shape
        alpha = np.zeros((3, 3, *shape, *(1,) * (3 - len(shape))))
        rows = np.arange(3)[: field.rows]
        # A plane map knows the last column.
        planes = {2: (0, 1)} if len(shape) == 2 else {0: (1, 2), 1: (2, 0), 2: (0, 1)}
        for k, plane in planes.items():
            alpha[rows, k] = curl(field, plane).reshape(-1, *alpha.shape[2:])
        return np.tensordot(self.inverse, alpha, 1)

    def draw(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """alpha of random noise of the coframe, by both orders; zero if no noise is known."""
        assert self.field.noise is not None
        values = self.field.noise.draw(self.field.values.shape, rng)
        return self.alpha(values), self.alpha(values, other=True)


@dataclass(frozen=True, eq=False, repr=False)
class NyeField:
    """Nye tensor alpha^{ik} at the nodes of a cell: b^i of the lines that cross area n_k.

    values: alpha^{ik}, shape (3, 3, N_1, N_2, N_3), per `unit`; first index b, second the line. A
        plane map has N_3 = 1 and lines along z, so that only alpha^{i3} may differ from zero.
    box: the cell; its nodes are at the shares 0, 1/N, ... of the edges. Where it is not periodic,
        nothing is known beyond it; see `padded`.
    unit: of lengths, any text.
    corrections: sentences about the changes to the values, in their order.
    sigma: standard deviation of the noise of each value, independent for all values: a number, or
        an array of shape (3, 3) or of the values. `of_frame` computes it from the noise of the
        coframe and remembers how the noise of neighbours is correlated. Errors of `stresses`
        contain it.

    Raises
    ------
    GridError
        Wrong shapes, values that are not finite, a negative sigma, or lines across a plane map.

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
    sigma: np.ndarray | float | None = None
    _curl: Curl | None = None
    _map: NyeField | None = None

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
        if self.sigma is not None:
            object.__setattr__(self, "sigma", checked_sigma(self.sigma, values.shape))

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
        if frame.displacement is not None:
            alpha = np.zeros((3, 3, *values.shape[2:]))
            nye = frame.nye
            alpha[: frame.rows, 3 - nye.shape[1] :] = nye.reshape(*nye.shape[:2], *values.shape[2:])
            return cls(np.tensordot(inverse, alpha, 1), box_of(frame), frame.unit)
        curled, sigma = Curl(frame._field, inverse), None
        alpha = curled.alpha()
        if frame.noise is not None:
            floor = frame.nye_noise
            sigma = np.zeros_like(alpha)
            sigma[: frame.rows, 3 - floor.shape[1] :] = floor.reshape(
                *floor.shape[:2], *values.shape[2:]
            )
            sigma = np.sqrt(np.tensordot(inverse**2, sigma**2, 1))
        return cls(alpha, box_of(frame), frame.unit, sigma=sigma, _curl=curled)

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
        text = f"Perfect crystal of {nodes} nodes surrounds the map, and the whole repeats."
        return replace(self._within(nodes), corrections=(*self.corrections, text))

    def _within(self, nodes: int) -> NyeField:
        """The field in a cell with a number of nodes more along each edge that is not periodic."""
        added = np.where(self.box.periodic, 0, nodes)
        wider = [(0, 0)] * 2 + [(0, int(n)) for n in added]
        sigma = None if self.sigma is None else np.pad(self.sigma, wider)
        share = (1 + added / np.array(self.shape))[:, None]
        box = Box(np.asarray(self.box.vectors) * share, self.box.origin)
        values = np.pad(self.values, wider)
        return NyeField(values, box, self.unit, sigma=sigma, _curl=self._curl, _map=self)

    def balanced(self) -> NyeField:
        """The field without its mean: the net b through the cell is spread with opposite sign."""
        mean = self.values.mean(axis=(2, 3, 4), keepdims=True)
        texts = (*self.corrections, balance_text(mean[..., 0, 0, 0], self.unit))
        return replace(self, values=self.values - mean, corrections=texts)

    # -- errors -----------------------------------------------------------------------------------

    @property
    def measured(self) -> tuple[int, ...]:
        """Number of measured nodes along each edge; `padded` adds others after them."""
        return self.shape if self._map is None else self._map.shape

    def _laid(self, values: np.ndarray) -> np.ndarray:
        """Values at the measured nodes, and zero at the others."""
        return np.pad(
            values,
            [(0, 0)] * 2 + [(0, n - m) for n, m in zip(self.shape, self.measured, strict=True)],
        )

    def rival(self) -> np.ndarray | None:
        """alpha by differences of another order, if the values are the curl of a coframe."""
        return None if self._curl is None else self._laid(self._curl.alpha(other=True))

    def draw(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray | None]:
        """Random noise of the values, and the noise of `rival`."""
        if self._curl is not None:
            one, two = self._curl.draw(rng)
            return self._laid(one), self._laid(two)
        return self.sigma * rng.choice([-1.0, 1.0], self.values.shape), None

    def in_smaller_cell(self) -> NyeField | None:
        """The map in half as much perfect crystal; None if nothing outside is assumed."""
        if self._map is None:
            return None
        added = max(n - m for n, m in zip(self.shape, self.measured, strict=True))
        return self._map._within(added // 2)

    @staticmethod
    def is_in(path: str | Path) -> bool:
        """Whether a file is an .npz file with an array nye."""
        form = replace(FORMS["nye"], shape=None, optional=True)
        return ending(path) == ".npz" and bool(read_npz(path, {"nye": form}))

    @classmethod
    def read(cls, path: str | Path) -> NyeField:
        """Read an .npz file: nye and vectors (edges as rows), and origin, periodic, unit, sigma.

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
            box = Box(arrays["vectors"], origin, flags)
            return cls(arrays["nye"], box, unit, sigma=arrays.get("sigma"))
        except (GridError, NetworkError) as error:
            raise FileFormatError(f"{path}: {error}") from None

    def save(self, path: str | Path) -> None:
        """Write an .npz file that `read` reads, without corrections.

        The file holds sigma of each value, without the correlations of neighbours that the noise
        of a coframe has. Errors of stresses are then larger.
        """
        box = self.box
        arrays = {
            "nye": self.values, "vectors": box.vectors, "origin": box.origin,
            "periodic": box.periodic, "unit": self.unit,
        }  # fmt: skip
        if self.sigma is not None:
            arrays["sigma"] = self.sigma
        with written(path) as file:
            write_npz(file, arrays)


def checked_sigma(given: object, shape: tuple[int, ...]) -> np.ndarray:
    """Standard deviations of all values; zero for lines across a plane map, which it cannot see."""
    sigmas = np.asarray(checks.array(given, "sigma", GridError))
    shapes = {(): (1,) * 5, (3, 3): (3, 3, 1, 1, 1), shape: shape}
    if sigmas.shape not in shapes:
        raise GridError(
            f"sigma: expected a number, or shape (3, 3) or {shape}, got {sigmas.shape}."
        )
    if not (np.isfinite(sigmas) & (sigmas >= 0)).all():
        raise GridError("sigma: expected finite standard deviations of 0 or more, got others.")
    every = np.broadcast_to(sigmas.reshape(shapes[sigmas.shape]), shape).copy()
    if shape[-1] == 1:
        every[:, :2] = 0.0
    return every


def balance_text(mean: np.ndarray, unit: str) -> str:
    """Report of `balanced` in words."""
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

"""Cell: a periodic cell with a regular grid of nodes, and the Fourier modes on it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.materials.lines import Box
from geomtorsion.support import checks


@dataclass(frozen=True, eq=False)
class Cell:
    """A periodic cell and a grid: f(x) = sum of f_m exp(i k_m x), x from the corner of the cell.

    The highest wave of an axis with an even number of nodes has no derivative on the grid and is
    omitted, so that derivatives of fields are exact.

    box: the cell. shape: nodes along each edge, one where nothing depends on this direction.
    """

    box: Box
    shape: tuple[int, ...]

    def __post_init__(self) -> None:
        """Refuse a grid that does not fit into memory."""
        nodes = int(np.prod([float(n) for n in self.shape]))
        text = f"shape: a grid of {' x '.join(map(str, self.shape))} nodes"
        # Ten tensors for each node: distortion, torsion and stress, as modes and as values.
        checks.check_room(90 * nodes, text, "Give fewer nodes.")

    def waves(self, lowest: Sequence[int] = (0, 0, 0)) -> np.ndarray:
        """Whole numbers of waves along each edge of the used modes, shape (modes, 3).

        lowest: only modes whose number along some edge exceeds the one listed here; by default all
        but the mean.
        """
        n1, n2, n3 = self.shape
        ranges = (*(np.fft.fftfreq(n, 1 / n) for n in (n1, n2)), np.fft.rfftfreq(n3, 1 / n3))
        mesh = np.meshgrid(*(np.rint(m).astype(int) for m in ranges), indexing="ij")
        used, high = np.ones(mesh[0].shape, bool), np.zeros(mesh[0].shape, bool)
        for m, n, low in zip(mesh, self.shape, lowest, strict=True):
            used &= 2 * np.abs(m) < n
            high |= np.abs(m) > low
        return np.stack([m[used & high] for m in mesh], axis=1)

    def vectors(self, waves: np.ndarray) -> np.ndarray:
        """Wave vectors k of numbers of waves, shape (modes, 3)."""
        return 2 * np.pi * waves @ self.box.inverse.T

    def modes(self, field: np.ndarray, waves: np.ndarray) -> np.ndarray:
        """Modes of a field on the grid, shape (components..., grid) -> (modes, components...)."""
        every = scipy.fft.rfftn(field, axes=(-3, -2, -1), norm="forward")
        return np.moveaxis(every[..., *waves.T], -1, 0)

    def field(self, modes: np.ndarray, waves: np.ndarray) -> np.ndarray:
        """The field on the grid of some modes, shape (components..., grid)."""
        n1, n2, n3 = self.shape
        every = np.zeros((*modes.shape[1:], n1, n2, n3 // 2 + 1), complex)
        every[..., *waves.T] = np.moveaxis(modes, 0, -1)
        return scipy.fft.irfftn(every, s=self.shape, axes=(-3, -2, -1), norm="forward")

    def weights(self, waves: np.ndarray) -> np.ndarray:
        """How often each mode counts in a sum over all: twice where its conjugate is not listed."""
        return np.where(waves[:, 2] > 0, 2.0, 1.0)

    def pieces(
        self, starts: np.ndarray, steps: np.ndarray, waves: np.ndarray
    ) -> Iterator[tuple[slice, np.ndarray]]:
        """Means of exp(-i k x) over straight pieces, exactly, block by block: (pieces, modes).

        starts, steps: in coordinates, shape (pieces, 3); points are pieces without length.
        """
        lowest, highest = waves.min(axis=0, initial=0), waves.max(axis=0, initial=0)
        ranges = [np.arange(low, high + 1) for low, high in zip(lowest, highest, strict=True)]
        places = (waves - lowest).T
        middles = (starts + steps / 2 - np.asarray(self.box.origin)) @ self.box.inverse
        shares = steps @ self.box.inverse
        # Blocks of 16 MB: less than the fields of a usual grid, and few calls for a small one.
        size = max(1, 2**20 // max(1, len(waves)))
        for first in range(0, len(starts), size):
            block = slice(first, first + size)
            # Factors of one axis each; exponentials of all modes would take most of the time.
            one, two, three = (
                np.exp(-2j * np.pi * np.outer(x, m))[:, place]
                for m, x, place in zip(ranges, middles[block].T, places, strict=True)
            )
            yield block, one * two * three * np.sinc(shares[block] @ waves.T)

    def points(self) -> np.ndarray:
        """Positions of the nodes, shape (3, grid...)."""
        shares = np.meshgrid(*(np.arange(n) / n for n in self.shape), indexing="ij")
        places = np.tensordot(np.asarray(self.box.vectors).T, np.array(shares), 1)
        return places + np.asarray(self.box.origin)[:, None, None, None]

    @property
    def steps(self) -> np.ndarray:
        """Distance of the planes of nodes along each edge, shape (3,)."""
        return 1 / (np.linalg.norm(self.box.inverse, axis=0) * np.array(self.shape))

    @property
    def is_along_axes(self) -> bool:
        """Whether the edges are along the coordinates, so that the grid has axes."""
        edges = np.asarray(self.box.vectors)
        return bool((edges == np.diag(np.diag(edges))).all())

    @property
    def axes(self) -> list[np.ndarray]:
        """Coordinates of the nodes along each axis, if the edges are along the coordinates."""
        edges = np.diag(np.asarray(self.box.vectors))
        origin = np.asarray(self.box.origin)
        return [
            o + edge * np.arange(n) / n
            for o, edge, n in zip(origin, edges, self.shape, strict=True)
        ]

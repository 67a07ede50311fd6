"""Step grid: integrals of a coframe along the steps between pixels, and sums of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.loops import Cochain
from geomtorsion.orientations.circuits import Circuit
from geomtorsion.orientations.lattice_edges import GrainMap


@dataclass(frozen=True, eq=False)
class Chain:
    """Steps to the next pixel in a row or a column, and how often each is made.

    starts, ends: row and column of pixels, shape (k, 2); times: shape (k,).
    """

    starts: np.ndarray
    ends: np.ndarray
    times: np.ndarray

    @property
    def along(self) -> np.ndarray:
        """Which steps run along a row."""
        return self.starts[:, 0] == self.ends[:, 0]


@dataclass(frozen=True, eq=False)
class StepGrid:
    """Trapezoids of the coframe e^i_mu along the steps of a map.

    grains: which steps stay in a grain. coframe: shape (rows, columns, 3, 2). steps, shift: of the
    map. threshold: of grains, degrees, for messages.
    """

    grains: GrainMap
    coframe: np.ndarray
    steps: tuple[float, float]
    shift: float
    threshold: float

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of pixels."""
        rows, columns = self.grains.grain.shape
        return rows, columns

    # -- single steps -----------------------------------------------------------------------------

    @cached_property
    def right(self) -> np.ndarray:
        """Integral of e along the step to the next pixel in a row, (rows, columns - 1, 3)."""
        along = self.coframe[..., 0]
        return self.steps[0] / 2 * (along[:, :-1] + along[:, 1:])

    @cached_property
    def down(self) -> np.ndarray:
        """Integral of e along the step to the next pixel in a column, (rows - 1, columns, 3)."""
        e = self.coframe
        found = self.steps[1] / 2 * (e[:-1, :, :, 1] + e[1:, :, :, 1])
        if self.shift:
            # On from an even row to an odd one, back from an odd one.
            sign = 1 - 2 * (np.arange(self.shape[0] - 1) % 2)
            way = sign[:, None, None] * self.shift * self.steps[0]
            found += way / 2 * (e[:-1, :, :, 0] + e[1:, :, :, 0])
        return found

    @property
    def cochain(self) -> Cochain:
        """The steps within grains as a cochain; nodes are pixels, numbered row by row."""
        rows, columns = self.shape
        number = np.arange(rows * columns).reshape(self.shape)
        right, down = self.grains.right, self.grains.down
        pairs = np.concatenate(
            [
                np.stack([number[:, :-1][right], number[:, 1:][right]], axis=1),
                np.stack([number[:-1][down], number[1:][down]], axis=1),
            ]
        )
        values = np.concatenate([self.right[right], self.down[down]])
        return Cochain.of_edges(pairs, values, nodes=rows * columns)

    # -- one circuit ------------------------------------------------------------------------------

    def chain(self, circuit: Circuit) -> Chain:
        """The steps of a circuit, after looking at each: it stays in the map and in one grain."""
        found = self.ascending(circuit)
        along = found.along
        fine = np.empty(len(along), dtype=bool)
        fine[along] = self.grains.right[tuple(found.starts[along].T)]
        fine[~along] = self.grains.down[tuple(found.starts[~along].T)]
        if not fine.all():
            self._refuse(found.starts[~fine], found.ends[~fine])
        return found

    def ascending(self, circuit: Circuit) -> Chain:
        """The steps of a circuit, those that go back as negative multiples of those that go on."""
        last = np.maximum(circuit.starts, circuit.ends)
        outside = (last >= self.shape).any(axis=1)
        if outside.any():
            pixel = tuple(last[np.argmax(outside)].tolist())
            raise OrientationError(
                f"{circuit.name}: pixel {pixel} lies outside of the map of "
                f"{self.shape[0]} x {self.shape[1]} pixels. Choose another place, or a smaller one."
            )
        first = np.minimum(circuit.starts, circuit.ends)
        sign = np.where((circuit.starts == first).all(axis=1), 1, -1)
        return Chain(first, last, sign * circuit.times)

    def _refuse(self, starts: np.ndarray, ends: np.ndarray) -> None:
        """Say which pixels a circuit must not join, and why; of many, of the first three."""
        named = []
        for one, other in zip(starts[:3].tolist(), ends[:3].tolist(), strict=True):
            pixels = tuple(one), tuple(other)
            grains = [int(self.grains.grain[pixel]) for pixel in pixels]
            if min(grains) < 0:
                named.append(f"pixel {pixels[grains.index(-1)]} has no orientation")
            elif grains[0] != grains[1]:
                named.append(
                    f"{pixels[0]} lies in grain {grains[0]}, {pixels[1]} in grain {grains[1]}"
                )
            else:
                named.append(
                    f"from {pixels[0]} to {pixels[1]} the lattice of grain {grains[0]} turns by "
                    f"{self.threshold:g} degrees or more"
                )
        more = f"; and {len(starts) - 3} steps more" if len(starts) > 3 else ""
        raise OrientationError(
            f"the circuit crosses a boundary: {'; '.join(named)}{more}. Lead it through one grain, "
            f"or give a threshold above {self.threshold:g} degrees."
        )

    def total(self, chain: Chain) -> np.ndarray:
        """The integral of the coframe along a chain, shape (3,)."""
        along = chain.along
        values = np.empty((len(along), 3))
        values[along] = self.right[tuple(chain.starts[along].T)]
        values[~along] = self.down[tuple(chain.starts[~along].T)]
        return chain.times @ values

    def area(self, chain: Chain) -> float:
        """Half of the sum of x dy - y dx: the area that a chain encloses."""
        one, other = self._places(chain.starts), self._places(chain.ends)
        return float(chain.times @ (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])) / 2

    def moments(self, chain: Chain) -> np.ndarray:
        """How each pixel enters the sum: half of the steps that touch it, shape (pixels, 3)."""
        ways = self._places(chain.ends) - self._places(chain.starts)
        keys = np.concatenate([chain.starts, chain.ends]) @ np.array([self.shape[1], 1])
        _, where = np.unique(keys, return_inverse=True)
        found = np.zeros((int(where.max()) + 1, 3))
        np.add.at(found[:, :2], where, np.tile(chain.times[:, None] * ways / 2, (2, 1)))
        return found

    def _places(self, pixels: np.ndarray) -> np.ndarray:
        """x and y of pixels from the first one, shape (k, 2)."""
        rows, columns = pixels.T
        x = (columns + self.shift * (rows % 2)) * self.steps[0]
        return np.stack([x, rows * self.steps[1]], axis=1)

    # -- all squares ------------------------------------------------------------------------------

    def squares(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Integrals round all squares of n x n cells, and which of them stay in one grain.

        Sums from the first pixel of each row and column make any size as cheap as a cell.
        """
        (right, down), (crossed, dropped) = self._sums, self._crossings
        bottom, side = right[:, n:] - right[:, :-n], down[n:] - down[:-n]
        vectors = bottom[:-n] - bottom[n:] + side[:, n:] - side[:, :-n]
        across, along = crossed[:, n:] - crossed[:, :-n], dropped[n:] - dropped[:-n]
        return vectors, across[:-n] + across[n:] + along[:, n:] + along[:, :-n] == 0

    @cached_property
    def _sums(self) -> tuple[np.ndarray, np.ndarray]:
        """Sums of the steps from the first pixel of each row, and of each column."""
        right, down = (np.zeros((*self.shape, 3)) for _ in range(2))
        np.cumsum(self.right, axis=1, out=right[:, 1:])
        np.cumsum(self.down, axis=0, out=down[1:])
        return right, down

    @cached_property
    def _crossings(self) -> tuple[np.ndarray, np.ndarray]:
        """How many steps from the first pixel of each row, and of each column, leave a grain."""
        right, down = (np.zeros(self.shape, dtype=np.int32) for _ in range(2))
        np.cumsum(~self.grains.right, axis=1, out=right[:, 1:])
        np.cumsum(~self.grains.down, axis=0, out=down[1:])
        return right, down

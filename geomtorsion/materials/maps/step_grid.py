"""Step grid: integrals of a coframe along the steps between pixels, and sums over steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.loops import Cochain
from geomtorsion.materials.detours import Detour, Passages, detour_of, too_large
from geomtorsion.materials.fields.grid_circuits import unexplained
from geomtorsion.materials.maps.lattice_edges import GrainMap, spread_of_sums
from geomtorsion.materials.maps.pixel_circuits import Circuit
from geomtorsion.materials.rings import Rings
from geomtorsion.materials.windows import Windows
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property


def two_steps(steps: object) -> tuple[float, float]:
    """Steps along x and y, from two numbers or from one for both."""
    values = (steps, steps)
    if checks.real(steps) is None:
        values = checks.numbers(steps, 2, "steps", OrientationError)
    sizes = [checks.positive(step, "steps", OrientationError) for step in values]
    for size in sizes:
        checks.measured(size, "steps", OrientationError, is_length=True)
    return sizes[0], sizes[1]


@dataclass(frozen=True, eq=False)
class Chain:
    """Steps to the next pixel in a row or a column, with multiplicities.

    starts, ends: row and column of pixels, shape (k, 2). times: how often each step is made, shape
    (k,).
    """

    starts: np.ndarray
    ends: np.ndarray
    times: np.ndarray

    def named(self, name: str) -> Circuit:
        """The chain as a circuit."""
        return Circuit(self.starts, self.ends, self.times, name)

    @property
    def along(self) -> np.ndarray:
        """Whether each step runs along a row."""
        return self.starts[:, 0] == self.ends[:, 0]


@dataclass(frozen=True, eq=False)
class StepGrid:
    """Integrals of the coframe e^i_mu along the steps of a map, by the trapezoidal rule.

    grains: of the map, which decide which steps are allowed. coframe: shape (rows, columns, 3, 2).
    steps, shift: of the map. threshold: of grains, degrees, for messages.
    """

    grains: GrainMap
    coframe: np.ndarray
    steps: tuple[float, float]
    shift: float
    threshold: float

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns of pixels."""
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
        integrals = self.steps[1] / 2 * (e[:-1, :, :, 1] + e[1:, :, :, 1])
        if self.shift:
            # The shift is positive from an even row to an odd one, and negative from an odd row.
            sign = 1 - 2 * (np.arange(self.shape[0] - 1) % 2)
            way = sign[:, None, None] * self.shift * self.steps[0]
            integrals += way / 2 * (e[:-1, :, :, 0] + e[1:, :, :, 0])
        return integrals

    @cached_property
    def bends(self) -> tuple[np.ndarray, np.ndarray]:
        """Fourth-order rule minus trapezoidal rule for each step, in the order right, down.

        (-f_-1 + 13 f_0 + 13 f_1 - f_2) / 24 - (f_0 + f_1) / 2 is the mean of the second differences
        at both ends, times -1/12. At the edge of a grain, the only known second difference is used
        for both ends; a step without any contributes zero.
        """
        e, grain = self.coframe, self.grains.grain
        right = -_bends(self.steps[0] * e[..., 0].swapaxes(0, 1), grain.T).swapaxes(0, 1)
        if not self.shift:
            return right, -_bends(self.steps[1] * e[..., 1], grain)
        # Along a straight line from row to row, the column changes by one at every second row.
        rows, columns = self.shape
        down = np.zeros((rows - 1, columns, 3))
        for first, way in ((0, 1), (1, -1)):
            # From even rows, lines go right if odd rows begin further right, otherwise left.
            shifts = way * int(np.sign(self.shift)) * ((np.arange(rows) + first) // 2)
            index = (np.arange(columns) + shifts[:, None]) % columns
            place = (np.arange(rows)[:, None], index)
            step = self.steps[1] * e[..., 1] + way * self.shift * self.steps[0] * e[..., 0]
            # A line that leaves the map and re-enters at the other side is a different line.
            laps = (np.arange(columns) + shifts[:, None]) // columns
            mine = grain[place] + (laps - laps.min()) * (grain.max() + 1)
            differences = -_bends(step[place], np.where(grain[place] < 0, -1, mine))
            back = (np.arange(columns) - shifts[:-1, None]) % columns
            down[first::2] = differences[np.arange(rows - 1)[:, None], back][first::2]
        return right, down

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

    @cached_property
    def rings(self) -> Rings:
        """Rings of steps around pixels that are not indexed, within a grain; axes x, y."""
        usable = self.grains.right.T, self.grains.down.T
        return Rings.of(self.grains.grain.T < 0, usable=usable)

    def chain(self, circuit: Circuit) -> tuple[Chain, np.ndarray]:
        """The steps of a circuit, around pixels that are not indexed.

        Also returns the holes of all steps into and out of holes. Raise an error unless all steps
        are in the map and in one grain.
        """
        ordered, passages = self._around(self.ascending(circuit))
        along = ordered.along
        fine = np.empty(len(along), dtype=bool)
        fine[along] = self.grains.right[tuple(ordered.starts[along].T)]
        fine[~along] = self.grains.down[tuple(ordered.starts[~along].T)]
        if not fine.all():
            self._refuse(ordered.starts[~fine], ordered.ends[~fine])
        # Separate parts of a circuit, such as distant cells, may be in different grains.
        grains = np.unique(self.grains.grain[tuple(ordered.starts.T)]).tolist()
        if len(grains) > 1:
            raise OrientationError(
                f"{circuit.name}: expected a circuit in one grain, got parts in grains "
                f"{checks.cut(', '.join(map(str, grains)))}. Make one circuit for each grain."
            )
        return ordered, passages

    def detour(
        self, circuit: Circuit, chain: Chain, passages: np.ndarray, noise: np.ndarray
    ) -> Detour | None:
        """The detour of a circuit from its chain and passages; None without passages.

        noise: covariance of an orientation. Raise an error for a circuit that is too small.
        """
        if not len(passages):
            return None
        before = self.area(self.ascending(circuit))
        holes, times = np.unique(passages, return_counts=True)
        # A circuit enters and leaves a hole at each passage.
        cells = float(times @ self.rings.cells[holes]) / 2
        within = cells * self.steps[0] * self.steps[1]
        if too_large(within, abs(before)) or not len(chain.starts):
            column, row, _ = np.argwhere(self.rings.hole == holes[0])[0].tolist()
            raise OrientationError(
                f"{circuit.name}: pixel {(row, column)} has no orientation. To go around such "
                f"pixels, expected at least twice the area of the rings around them, {within:.4g}, "
                f"got {abs(before):.4g}. Choose a larger circuit, or another position."
            )
        error = float(times @ self.ring_errors(noise)[holes]) / 2
        return detour_of(self.rings, holes, times / 2, self.area(chain) - before, self.steps, error)

    def ring_errors(self, noise: np.ndarray) -> np.ndarray:
        """|b| of each ring without the part that noise explains, shape (rings,)."""
        rings = self.rings
        edges = self.right.transpose(2, 1, 0), self.down.transpose(2, 1, 0)
        sizes = np.linalg.norm(rings.totals_of(rings.steps_of(edges)), axis=0)
        spread = spread_of_sums(self.ring_weights.T, noise)
        return unexplained(sizes, np.trace(spread, axis1=1, axis2=2))

    @cached_property
    def ring_weights(self) -> np.ndarray:
        """Sums over the pixels of each ring of squared weights: x x, y y, x y, shape (3, rings).

        The weight of a pixel is half of the steps of the ring before it and after it.
        """
        rings = self.rings
        if not rings.count:
            return np.zeros((3, 0))
        x, y, _ = np.unravel_index(rings.edge, rings.hole.shape)
        ends = (
            self.places(np.stack([y + k * (rings.axis == 1), x + k * (rings.axis == 0)], axis=1))
            for k in (0, 1)
        )
        one, two = ends
        ways = rings.sign * (two - one).T
        before = np.roll(ways, 1, axis=1)
        before[:, rings.first[:-1]] = ways[:, rings.first[1:] - 1]
        x, y = (ways + before) / 2
        return rings.totals_of(np.stack([x * x, y * y, x * y]))

    def _around(self, chain: Chain) -> tuple[Chain, np.ndarray]:
        """A chain with steps of rings instead of steps to pixels that are not indexed.

        Also returns the holes of all steps into and out of holes, with repetitions.
        """
        absent = self.grains.grain < 0
        meets = absent[tuple(chain.starts.T)] | absent[tuple(chain.ends.T)]
        if not meets.any():
            return chain, np.zeros(0, dtype=np.int64)
        rows, columns = self.shape
        starts, moves, times = [], [], []
        passages = []
        for axis, chosen in ((0, meets & chain.along), (1, meets & ~chain.along)):
            row, column = chain.starts[chosen].T
            replaced, steps, holes = self.rings.expanded(
                axis, column * rows + row, chain.times[chosen]
            )
            meets[np.flatnonzero(chosen)[~replaced]] = False
            passages.append(holes)
            for k, edge, count in steps:
                starts.append(np.stack([edge % rows, edge // rows], axis=1))
                moves.append(np.full(len(edge), k))
                times.append(count)
        starts.append(chain.starts[~meets])
        moves.append(np.where(chain.along[~meets], 0, 1))
        times.append(chain.times[~meets])
        keys = np.concatenate([2 * (x @ np.array([columns, 1])) for x in starts])
        keys += np.concatenate(moves)
        # Ways that a circuit makes in both directions cancel.
        unique, where = np.unique(keys, return_inverse=True)
        total = np.rint(np.bincount(where, np.concatenate(times), len(unique))).astype(np.int64)
        unique, total = unique[total != 0], total[total != 0]
        first = np.stack(np.divmod(unique // 2, columns), axis=1)
        last = first + np.where((unique % 2 == 0)[:, None], [0, 1], [1, 0])
        return Chain(first, last, total), np.concatenate(passages)

    def ascending(self, circuit: Circuit) -> Chain:
        """The steps of a circuit in ascending direction; backward steps count negative."""
        last = np.maximum(circuit.starts, circuit.ends)
        outside = (last >= self.shape).any(axis=1)
        if outside.any():
            pixel = tuple(last[np.argmax(outside)].tolist())
            raise OrientationError(
                f"{circuit.name}: expected pixels in the map of {self.shape[0]} x {self.shape[1]} "
                f"pixels, got {pixel}. Move the circuit, or choose a smaller one."
            )
        first = np.minimum(circuit.starts, circuit.ends)
        sign = np.where((circuit.starts == first).all(axis=1), 1, -1)
        return Chain(first, last, sign * circuit.times)

    def _refuse(self, starts: np.ndarray, ends: np.ndarray) -> None:
        """Raise an error that names the first three forbidden steps of a circuit, with reasons."""
        named = []
        for one, other in zip(starts[:3].tolist(), ends[:3].tolist(), strict=True):
            pixels = tuple(one), tuple(other)
            grains = [int(self.grains.grain[pixel]) for pixel in pixels]
            if min(grains) < 0:
                named.append(f"pixel {pixels[grains.index(-1)]} has no orientation")
            elif grains[0] != grains[1]:
                named.append(
                    f"pixel {pixels[0]} is in grain {grains[0]}, {pixels[1]} in grain {grains[1]}"
                )
            else:
                named.append(
                    f"from {pixels[0]} to {pixels[1]} the lattice of grain {grains[0]} turns by "
                    f"{self.threshold:g} degrees or more"
                )
        more = f"; and {len(starts) - 3} more steps" if len(starts) > 3 else ""
        raise OrientationError(
            f"expected a circuit within one grain, got one that crosses a boundary: "
            f"{'; '.join(named)}{more}. Lead it through one grain, or give a threshold above "
            f"{self.threshold:g} degrees."
        )

    def total(self, chain: Chain) -> np.ndarray:
        """The integral of the coframe along a chain, shape (3,)."""
        along = chain.along
        values = np.empty((len(along), 3))
        values[along] = self.right[tuple(chain.starts[along].T)]
        values[~along] = self.down[tuple(chain.starts[~along].T)]
        return chain.times @ values

    def bend(self, chain: Chain) -> np.ndarray:
        """Correction of the trapezoidal rule along a chain, from the sum of `bends`, shape (3,)."""
        along, (right, down) = chain.along, self.bends
        values = np.empty((len(along), 3))
        values[along] = right[tuple(chain.starts[along].T)]
        values[~along] = down[tuple(chain.starts[~along].T)]
        return chain.times @ values

    def area(self, chain: Chain) -> float:
        """Half of the sum of x dy - y dx: the area that a chain encloses."""
        # The net number of enclosed cells is a whole number; if it is 0, the area is exactly 0.
        if not (chain.times * chain.starts[:, 0])[chain.along].sum():
            return 0.0
        one, other = self.places(chain.starts), self.places(chain.ends)
        return float(chain.times @ (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])) / 2

    def moments(self, chain: Chain) -> np.ndarray:
        """Weight of each pixel in the sum: half of the steps that touch it, shape (pixels, 3)."""
        ways = self.places(chain.ends) - self.places(chain.starts)
        keys = np.concatenate([chain.starts, chain.ends]) @ np.array([self.shape[1], 1])
        _, where = np.unique(keys, return_inverse=True)
        weights = np.zeros((int(where.max()) + 1, 3))
        np.add.at(weights[:, :2], where, np.tile(chain.times[:, None] * ways / 2, (2, 1)))
        return weights

    def bent_moments(self, chain: Chain) -> np.ndarray:
        """Weight of each pixel in `bend`, ignoring edges of grains, shape (pixels, 3)."""
        ways = chain.times[:, None] * (self.places(chain.ends) - self.places(chain.starts)) / 24
        one, two = chain.starts, chain.ends
        # The straight line through a step has a pixel before its start and one after its end.
        every = np.concatenate([one, two, 2 * one - two, 2 * two - one])
        keys = every @ np.array([4 * self.shape[1], 1])
        _, where = np.unique(keys, return_inverse=True)
        weights = np.zeros((int(where.max()) + 1, 3))
        np.add.at(weights[:, :2], where, np.concatenate([ways, ways, -ways, -ways]))
        return weights

    def places(self, pixels: np.ndarray) -> np.ndarray:
        """x and y of pixels, relative to the first pixel of the map, shape (k, 2)."""
        rows, columns = pixels.T
        x = (columns + self.shift * (rows % 2)) * self.steps[0]
        return np.stack([x, rows * self.steps[1]], axis=1)

    def path(self, circuit: Circuit) -> np.ndarray:
        """Steps of a circuit for a figure, shape (2, k), with NaN between them."""
        ends = np.stack([self.places(circuit.starts), self.places(circuit.ends)], axis=1)
        gaps = np.full((len(ends), 1, 2), np.nan)
        return np.concatenate([ends, gaps], axis=1).reshape(-1, 2).T

    # -- all squares ------------------------------------------------------------------------------

    def squares(self, n: int) -> tuple[np.ndarray, np.ndarray, Passages]:
        """Integrals around all squares of n x n cells, and whether each stays in one grain.

        Squares go around pixels that are not indexed. The cost does not depend on n, because sums
        over windows are shared. Arrays have the axes x, y last.
        """
        passages = Passages(self.rings, Windows((0, 1), (n, n), (False, False)))
        right, down, lines = ~self.grains.right, ~self.grains.down, passages.windows
        absent = self.rings.missing.T
        if absent.any():
            # Steps that end at a pixel without orientation are decided by the passages.
            right &= ~(absent[:, :-1] | absent[:, 1:])
            down &= ~(absent[:-1] | absent[1:])
        clean = np.logical_not(passages.refused)
        if right.any() or down.any():
            clean &= (
                lines.sums(*lines.along(right.T.astype(np.int32), down.T.astype(np.int32))) == 0
            )
        return self.rounds(passages, self.right, self.down), clean, passages

    def square_bends(self, passages: Passages) -> np.ndarray:
        """The `bend` of all squares, shape (3, x, y)."""
        return self.rounds(passages, *self.bends)

    def rounds(self, passages: Passages, right: np.ndarray, down: np.ndarray) -> np.ndarray:
        """Sums of steps (rows, columns, 3) around all squares, with detours, shape (3, x, y)."""
        edges = right.transpose(2, 1, 0), down.transpose(2, 1, 0)
        if self.rings.missing.any():
            edges = self.rings.filled(edges)
        return passages.windows.rounds(*passages.windows.along(*edges))


def _bends(f: np.ndarray, grain: np.ndarray) -> np.ndarray:
    """A twelfth of the second difference of f, averaged over both ends of each step on axis 0.

    f: shape (points, lines, 3). grain: shape (points, lines); only second differences within one
    grain are used.
    """
    bend, inner = np.zeros_like(f), np.zeros(grain.shape, dtype=bool)
    bend[1:-1] = f[2:] - 2 * f[1:-1] + f[:-2]
    inner[1:-1] = (grain[2:] == grain[1:-1]) & (grain[:-2] == grain[1:-1]) & (grain[1:-1] >= 0)
    bend[~inner] = 0
    number = np.maximum(inner[:-1].astype(int) + inner[1:], 1)
    return (bend[:-1] + bend[1:]) / (12 * number[..., None])

"""Sets: where all motions of a ball of starts are, as m + A r with A from a QR factorization.

Boxes turn with the motion and would have to be wrapped in wider boxes at each step. Directions that
turn with it do not [Lohner 1987; Nedialkov, Jackson, Corliss 1999].
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from flint import arb, arb_mat

from geomtorsion.errors import ProofError
from geomtorsion.proofs.wanted import FAR_BELOW, around_zero, log2, upper
from geomtorsion.support.precision import ball_precision

# Bits of bounds of small quantities, in which relative roundings of 2^-64 do not matter.
LOW_BITS = 64
# States and radii further below the largest than this number of bits count as if they were this far
# below: floats end at 2^-1074.
FURTHEST = 300.0


@dataclass(frozen=True)
class LohnerSet:
    """All points m + A r.

    middle: m, exact numbers; axes: A, exact numbers, one row for each state.
    spread: the radii of r, a box about zero.
    columns: derivatives of the points by numbers at the start, each a set: they move by the
        derivative of a map (Zgliczynski's C^1-Lohner algorithm [Zgliczynski 2002]).
    """

    middle: tuple[arb, ...]
    axes: arb_mat
    spread: tuple[arb, ...]
    columns: tuple[LohnerSet, ...] = ()

    @classmethod
    def of(cls, balls: Sequence[arb], columns: Iterable[Sequence[arb]] = ()) -> LohnerSet:
        """A box, with a box for each column of derivatives."""
        n = len(balls)
        unit = arb_mat([[int(i == j) for j in range(n)] for i in range(n)])
        return cls(
            tuple(x.mid() for x in balls),
            unit,
            tuple(arb(x.rad()) for x in balls),
            tuple(
                cls(tuple(x.mid() for x in column), unit, tuple(arb(x.rad()) for x in column))
                for column in columns
            ),
        )

    @property
    def radii(self) -> list[arb]:
        """How far states are from m at most."""
        rows = range(len(self.middle))
        return [
            sum((upper(self.axes[i, j]) * x for j, x in enumerate(self.spread)), arb(0)).upper()
            for i in rows
        ]

    @property
    def hull(self) -> list[arb]:
        """The smallest box around it."""
        return [x + around_zero(r) for x, r in zip(self.middle, self.radii, strict=True)]

    def image(self, values: Sequence[arb], slopes: arb_mat) -> list[arb]:
        """A box around the image under a map.

        values: of the map at m; slopes: its derivative on the whole set.
        """
        turned = slopes * self.axes
        return [
            x + sum((turned[i, j] * around_zero(r) for j, r in enumerate(self.spread)), arb(0))
            for i, x in enumerate(values)
        ]

    def moved(
        self,
        values: Sequence[arb],
        slopes: arb_mat,
        sizes: Sequence[float] | None = None,
        columns: Sequence[Sequence[arb]] | None = None,
    ) -> LohnerSet:
        """The set around the image under a map; see `image`.

        sizes: logarithms of the sizes of states, in units of which directions are compared.
        columns: slopes times the middle of each column, where it is known better than by slopes.

        With W = slopes A and z what rounding and steps add: r' = (Q^-1 W) r + Q^-1 z, where the
        columns of Q are orthogonal and begin with the longest of W r.
        """
        if columns is None:
            columns = [times(slopes, column.middle) for column in self.columns]
        with ball_precision(LOW_BITS):
            turned = slopes * self.axes
            logarithms = [log2(x) for x in values] if sizes is None else sizes
            axes = _orthogonal(turned, self.spread, logarithms)
            try:
                inverse = axes.inv()
            except ZeroDivisionError:
                raise ProofError("the directions of the set collapse") from None
            product = inverse * turned
            # Derivatives turn with the set: they are measured along its directions.
            products = [
                product if column.axes is self.axes else inverse * (slopes * column.axes)
                for column in self.columns
            ]
        moved = tuple(
            _in_frame(axes, inverse, matrix, column.spread, image)
            for matrix, column, image in zip(products, self.columns, columns, strict=True)
        )
        whole = _in_frame(axes, inverse, product, self.spread, values)
        return replace(whole, columns=moved)


def _in_frame(
    axes: arb_mat, inverse: arb_mat, product: arb_mat, spread: Sequence[arb], values: Sequence[arb]
) -> LohnerSet:
    """The set around values, with product r + inverse z for what they are off by, z."""
    middle = tuple(x.mid() for x in values)
    rest = [upper(x - m) for x, m in zip(values, middle, strict=True)]
    with ball_precision(LOW_BITS):
        column = arb_mat([[around_zero(x)] for x in spread])
        total = product * column + inverse * arb_mat([[around_zero(x)] for x in rest])
        return LohnerSet(middle, axes, tuple(upper(total[i, 0]) for i in range(len(middle))))


def times(matrix: arb_mat, vector: Sequence[arb]) -> list[arb]:
    """A matrix times a vector."""
    product = matrix * arb_mat([[x] for x in vector])
    return [product[i, 0] for i in range(matrix.nrows())]


def _orthogonal(turned: arb_mat, spread: Sequence[arb], sizes: Sequence[float]) -> arb_mat:
    """Exact numbers near an orthogonal matrix in units of the states; any matrix would be right."""
    n, columns = turned.nrows(), turned.ncols()
    units = _exponents(sizes)
    widths = _exponents([log2(x) for x in spread])
    table = np.array(
        [
            [_scaled(turned[i, j].mid(), widths[j] - units[i]) for j in range(columns)]
            for i in range(n)
        ]
    )
    if not np.isfinite(table).all():
        raise ProofError("the set has no finite bounds")
    order = np.argsort(-(table**2).sum(axis=0), kind="stable")
    factor = np.linalg.qr(table[:, order], mode="complete")[0]
    rows = [[arb(x) * arb(2) ** units[i] for x in row] for i, row in enumerate(factor.tolist())]
    return arb_mat(rows)


def _exponents(sizes: Sequence[float]) -> list[int]:
    """Whole exponents of two, cut off for zero and for sizes far below the largest."""
    top = max(sizes)
    if top <= FAR_BELOW:
        return [0] * len(sizes)
    return [round(max(x, top - FURTHEST)) for x in sizes]


def _scaled(x: arb, exponent: int) -> float:
    """A number times a power of two as a float."""
    return float(x * arb(2) ** exponent)

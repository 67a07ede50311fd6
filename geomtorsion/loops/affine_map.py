"""Affine maps: kept as their difference from the identity, so that tiny ones lose nothing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.errors import LoopError, ShapeError
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import PRINTED

# Where the parts of a loop cancel, the rotation consists of rounding errors.
ROUNDING = 64 * float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class AffineMap:
    """The affine map v -> rotation v + translation, kept as increment = map - identity.

    increment: shape (n + 1, n + 1): rotation - 1, translation in the last column, last row zero.

    Examples
    --------
    >>> import numpy as np
    >>> tiny = AffineMap.of(1e-20 * np.array([[0.0, -1.0], [1.0, 0.0]]), [2e-20, 0.0])
    >>> tiny.angle, (tiny @ tiny).burgers.tolist()
    (-1e-20, [4e-20, 2e-40])
    """

    increment: np.ndarray

    @classmethod
    def of(cls, turn: np.ndarray, translation: np.ndarray | list[float]) -> AffineMap:
        """From rotation - 1, shape (n, n), and translation, shape (n,)."""
        turn, column = np.asarray(turn), np.asarray(translation)
        if turn.shape != (len(column), len(column)):
            raise ShapeError(
                f"expected a square matrix and a vector of its size, got shapes {turn.shape} "
                f"and {column.shape}."
            )
        increment = np.zeros((len(column) + 1,) * 2, dtype=np.result_type(turn, column, float))
        increment[:-1, :-1], increment[:-1, -1] = turn, column
        return cls(increment)

    @property
    def matrix(self) -> np.ndarray:
        """The map in homogeneous form, shape (n + 1, n + 1)."""
        return np.eye(len(self.increment)) + self.increment

    @property
    def burgers(self) -> np.ndarray:
        """Translation, shape (n,): the closure failure."""
        return self.increment[:-1, -1]

    @property
    def turn(self) -> np.ndarray:
        """Rotation - 1, shape (n, n), to full relative accuracy."""
        return self.increment[:-1, :-1]

    @property
    def rotation(self) -> np.ndarray:
        """Linear part, shape (n, n): a rotation where the connection keeps lengths."""
        return self.matrix[:-1, :-1]

    def __matmul__(self, other: AffineMap) -> AffineMap:
        """This motion's path first, then the other's, seen from the first one's base."""
        first, second = self.increment, other.increment
        return AffineMap(first + second + first @ second)

    @cached_property
    def inverse(self) -> AffineMap:
        """Inverse map: the development of the reversed path."""
        return AffineMap(-np.linalg.solve(self.matrix, self.increment))

    def seen_from(self, path: AffineMap) -> AffineMap:
        """Development of the same loop from another base point at the end of a path (conjugation).

        Equation
        --------
        G' = P^-1 G P, with P the development of the path from the old base point to the new.
        """
        return AffineMap(np.linalg.solve(path.matrix, self.increment @ path.matrix))

    # -- invariants -----------------------------------------------------------------------------

    @cached_property
    def frank(self) -> np.ndarray:
        """Logarithm of the transport around the loop, shape (n, n): rotation = exp(-frank).

        A positive angle means that a transported vector rotates from the first leg towards the
        second: the area on the unit sphere, 2 pi (1 - alpha) on a cone.

        Raises
        ------
        LoopError
            There is no real logarithm, or it is not unique (half a turn in some plane).
        """
        return -logarithm(self.turn)

    @property
    def frank_vector(self) -> np.ndarray:
        """Axis times angle of the transported frame, shape (3,); only in three dimensions."""
        self._needs(3, "frank_vector")
        angle, axis = self.angle, self.axis
        return np.zeros(3) if axis is None else angle * axis

    @property
    def angle(self) -> float:
        """Angle by which a transported vector rotates: signed in the plane, otherwise in [0, pi].

        The sign in the plane counts from the first leg to the second. In more than three
        dimensions it is the Frobenius norm of frank over sqrt(2).

        Raises
        ------
        LoopError
            The linear part is not a rotation: the connection does not keep Euclidean lengths.
        """
        n = len(self.increment) - 1
        turn = self._rotating
        if n == 2:
            return float(np.arctan2((turn[0, 1] - turn[1, 0]) / 2, 1 + np.trace(turn) / 2))
        if n == 3:
            sine = _length(_axial(turn))
            return float(np.arctan2(sine, 1 + np.trace(turn) / 2))
        return float(np.linalg.norm(self.frank) / np.sqrt(2))

    @property
    def axis(self) -> np.ndarray | None:
        """Unit vector of the rotation axis, shape (3,); None if there is no rotation."""
        self._needs(3, "axis")
        vector = -_axial(self._rotating)
        size, cosine = _length(vector), 1 + float(np.trace(self.turn)) / 2
        if size == 0.0 and cosine > 0:
            return None
        if cosine > -0.9:
            return vector / size
        # Near half a turn the antisymmetric part is small; the symmetric one knows the axis.
        outer = (self.rotation + self.rotation.T) / 2 - cosine * np.eye(3)
        column = outer[:, np.argmax(np.diag(outer))]
        column = column / np.linalg.norm(column)
        return -column if column @ vector < 0 else column

    @property
    def along_axis(self) -> float:
        """Translation along the axis, equal for all base points; |b| without a rotation."""
        axis = self.axis
        return _length(self.burgers) if axis is None else float(axis @ self.burgers)

    @property
    def centre(self) -> np.ndarray | None:
        """The point of the screw axis nearest to the base point, in the frame there, shape (n,).

        In two and three dimensions it is the apparent position of the defect. None without a
        rotation.
        """
        n = len(self.increment) - 1
        if not np.abs(self.turn).max() > 0:
            return None
        if n == 2:
            return np.linalg.solve(-self.turn, self.burgers)
        self._needs(3, "centre")
        axis = self.axis
        assert axis is not None
        scale = np.abs(self.turn).max()
        across = self.burgers - axis * self.along_axis
        system = -self.turn / scale + np.outer(axis, axis)
        return np.linalg.solve(system, across / scale)

    @cached_property
    def _rotating(self) -> np.ndarray:
        """The turn, where it belongs to a rotation."""
        turn = self.turn
        stretch = np.abs(turn + turn.T + turn @ turn.T).max(initial=0.0)
        # It stretches if it changes lengths by more than it should as a share of what it turns.
        if not stretch <= PRINTED * float(np.abs(turn).max(initial=0.0)) + ROUNDING:
            raise LoopError(
                "the linear part is not a rotation: the connection does not keep Euclidean "
                "lengths. Use .frank, the logarithm, which also exists for boosts and shears."
            )
        return turn

    def _needs(self, dimension: int, what: str) -> None:
        """Refuse quantities that exist only in one dimension."""
        n = len(self.increment) - 1
        if n != dimension:
            raise ShapeError(
                f"{what} is defined only in {dimension} dimensions, not in {n}. "
                "Use .frank, the logarithm of the rotation, in any dimension."
            )


def _axial(turn: np.ndarray) -> np.ndarray:
    """sin(angle) * axis of a rotation given as rotation - 1."""
    pairs = (turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1])
    return np.array(pairs) / 2


def _length(vector: np.ndarray) -> float:
    """The length of a vector whose squares may underflow."""
    scale = float(np.abs(vector).max())
    return scale * float(np.linalg.norm(vector / scale)) if scale else 0.0


def logarithm(turn: np.ndarray) -> np.ndarray:
    """log(1 + turn), to full relative accuracy for tiny turns; turn has shape (n, n)."""
    n = len(turn)
    identity = np.eye(n)
    if not np.abs(turn).max(initial=0.0) > 0:
        return np.zeros_like(turn)
    # So near the identity the series converges in few terms, and keeps every digit.
    if np.linalg.norm(turn, 2) < 0.3:
        z = np.linalg.solve(2 * identity + turn, turn)
        square, power, total = z @ z, z, z.copy()
        for k in range(3, 40, 2):
            power = power @ square
            total = total + power / k
        return 2 * total
    if np.linalg.eigvals(identity + turn).real.min() < 0:
        # A real root of the map exists only away from negative eigenvalues.
        values = np.linalg.eigvals(identity + turn)
        if np.abs(values[values.real < 0].imag).min() < 1e-9:
            raise LoopError(
                "the rotation has no unique real logarithm: it is half a turn in some plane. "
                "Use .rotation, or .angle and .axis."
            )
    log = np.array(scipy.linalg.logm(identity + turn))
    return log if np.iscomplexobj(turn) else np.real(log)

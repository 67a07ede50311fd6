"""Search: motions from one point to another, found along lines and from a fan of directions."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import combinations, product

import numpy as np

from geomtorsion.curves.shooting import ROUNDING, Aim, Line, Shooter, Shot, lengths_of, tried
from geomtorsion.ode.numbers import PARTS

# Newton steps until a shot has hit or is given up.
SHOTS = 40
# Below this singular value of the slopes two motions count as one found twice.
CONJUGATE = 1e-6
# Slopes are computed again where a shot misses by more than this part of the last miss.
STALE = 0.05


@dataclass(frozen=True, eq=False)
class Hit:
    """A motion that hits: its shot, the target, d v / d gap as last known, and Newton's shots."""

    shot: Shot
    aim: Aim
    inverse: np.ndarray | None
    shots: int

    @property
    def vector(self) -> np.ndarray:
        """Weighted initial velocity."""
        return self.shot.vector

    @property
    def length(self) -> float:
        """Its Euclidean length."""
        return float(lengths_of(self.shot.vector))


@dataclass(frozen=True, eq=False)
class Followed:
    """The motion that hits the end of a line, if one does, and the length of the last motion."""

    hit: Hit | None
    length: float


@dataclass(frozen=True, eq=False)
class Search:
    """Search for motions from a start to an end.

    shooter: the motions; aim: the end; accuracy: relative to the length of a motion.
    near_conjugate: velocities at which the end hardly depended on one direction, as they were met.
    """

    shooter: Shooter
    aim: Aim
    accuracy: float
    near_conjugate: list[np.ndarray] = field(default_factory=list, repr=False)

    def allowed(self, vector: np.ndarray, aim: Aim) -> float:
        """The largest miss of a hit."""
        return self.accuracy * float(lengths_of(vector)) + aim.rounding

    def followed(self, line: Line) -> Followed:
        """The motion that follows its end along a line, from the start towards the line's end."""
        shooter, total = self.shooter, line.length
        n = len(line.start)
        if not np.isfinite(total):
            first = shooter.step(line.start, line.end - line.start)
            return Followed(self.hit(self.aim, first), float(lengths_of(first)))
        at, step, shots, hit = 0.0, total, 0, None
        vector, inverse, is_fresh = np.zeros(n), np.eye(n), True
        # The way past a conjugate point takes short steps: three times as many as for one target.
        for _ in range(3 * SHOTS):
            is_last = at + step >= total * (1 - ROUNDING)
            place = line.at(total if is_last else at + step)
            step = min(step, total - at)
            move = shooter.step(line.at(at + step / 2), place - line.at(at))
            length = float(lengths_of(move))
            if not step / 2 < length < 2 * step:
                # Coordinates are far from those in which the frame is constant here.
                move = move * (step / length)
            aim, ahead = tried(shooter.aim, place), None
            if aim is not None:
                # The last hit was loose: its miss is made good here.
                gap = move if hit is None else move - hit.shot.gap
                enough = 0.0 if is_last else STALE * step
                within = float(lengths_of(move)) / 2
                for first in (vector + inverse @ gap, _turned(vector, inverse @ gap)):
                    ahead = ahead or self.hit(aim, first, inverse, within, enough)
            # A motion longer than the line up to here is not the shortest.
            bound = (1 + STALE) * (at + step) if shooter.is_definite else np.inf
            if ahead is None or ahead.length > bound:
                step /= 2
                if not is_fresh and hit is not None:
                    slopes = self.inverse_slopes(hit.shot, hit.aim)
                    inverse, is_fresh = inverse if slopes is None else slopes, True
                if step <= ROUNDING * total:
                    break
                continue
            hit, shots = ahead, shots + ahead.shots
            if is_last:
                return Followed(replace(hit, shots=shots), hit.length)
            assert hit.inverse is not None
            vector, inverse, is_fresh = hit.vector, hit.inverse, False
            at, step = at + step, 2 * step
        return Followed(None, 0.0 if hit is None else hit.length)

    def hit(
        self,
        aim: Aim,
        first: np.ndarray,
        inverse: np.ndarray | None = None,
        within: float = np.inf,
        enough: float = 0.0,
    ) -> Hit | None:
        """Newton's iteration on the initial velocity; None if it does not hit.

        inverse: d v / d gap near the first velocity, if known. within: a finite largest first miss;
        then each further miss is to be half of the one before. enough: a miss that counts as a hit.
        """
        is_steady = bool(np.isfinite(within))
        vector, miss = first, within
        best, move, is_turned = None, np.zeros_like(first), False
        for count in range(1, SHOTS + 1):
            shot = tried(self.shooter.shot, vector, aim)
            if shot is not None and shot.size <= max(self.allowed(vector, aim), enough):
                return Hit(shot, aim, inverse, count)
            least = miss / 2 if is_steady and best is not None else miss
            if shot is None or shot.size >= least:
                if best is None:
                    return None
                if not is_turned:
                    vector, is_turned = _turned(best, move), True
                elif is_steady:
                    return None
                else:
                    move, inverse, is_turned = move / 2, None, False
                    vector = best + move
                if lengths_of(vector - best) < 1e-14 * lengths_of(best):
                    return None
                continue
            # Slopes are used again as long as they lead closer quickly.
            if inverse is None or (best is not None and shot.size > STALE * miss):
                inverse = self.inverse_slopes(shot, aim)
                if inverse is None:
                    return None
            miss, best, is_turned = shot.size, vector, False
            move = -inverse @ shot.gap
            limit = 2 * float(lengths_of(vector))
            move = move * min(1.0, limit / max(float(lengths_of(move)), 1e-300))
            vector = best + move
        return None

    def inverse_slopes(self, shot: Shot, aim: Aim) -> np.ndarray | None:
        """d v / d gap; None near a conjugate point."""
        slopes = tried(self.shooter.slopes, shot, aim)
        if slopes is None or not np.isfinite(slopes).all():
            return None
        u, s, vt = np.linalg.svd(slopes)
        if s[-1] < self.slope_noise(shot.vector, aim):
            self.near_conjugate.append(shot.vector)
            return None
        return vt.T @ np.diag(1 / s) @ u.T

    def slope_noise(self, vector: np.ndarray, aim: Aim) -> float:
        """Four times the error of slopes by central differences, whose two parts balance."""
        share = self.shooter.difference(vector, aim) / float(lengths_of(vector))
        return (2 * share) ** 2

    def direction_error(self, hit: Hit, miss: float) -> float:
        """Bound, perhaps infinite, of the angle between the direction of a hit and the true one."""
        inverse = self.inverse_slopes(hit.shot, hit.aim)
        if inverse is None:
            return np.inf
        return float(2 * np.linalg.norm(inverse, 2)) * miss / hit.length

    def directions(self, found: list[Hit]) -> list[np.ndarray]:
        """Unit vectors of the fan: back along each motion found, then axes and between axes."""
        n = len(self.shooter.start)
        # Three axes at once in space, two in more dimensions, where there are enough of these.
        most = min(n, 3 if n <= 3 else 2)
        star = []
        for count in range(1, most + 1):
            for axes, signs in product(
                combinations(range(n), count), product((1, -1), repeat=count)
            ):
                direction = np.zeros(n)
                direction[list(axes)] = np.array(signs) / np.sqrt(count)
                star.append(direction)
        return [*(-hit.vector / hit.length for hit in found), *star]

    def apart(self, found: list[Hit]) -> list[Hit]:
        """Motions that differ from each other, in the same order."""
        distinct: list[Hit] = []
        for hit in found:
            # Near a conjugate point the same motion is found with large errors.
            same = np.sqrt(CONJUGATE) * hit.length + 4 * self.aim.rounding
            if all(lengths_of(hit.vector - one.vector) > same for one in distinct):
                distinct.append(hit)
        return distinct

    def fan(self, directions: list[np.ndarray], reach: float, known: list[Hit]) -> list[Hit]:
        """Motions to the end that continue from the points of a fan that are nearest to it."""
        parts = np.linspace(0, 1, PARTS + 1)[1:]
        near: list[tuple[float, int, np.ndarray]] = []
        for direction in directions:
            places = tried(self.shooter.places, reach * direction, parts) or []
            sizes = self.shooter.distances(places, self.aim)
            for k, size in enumerate(sizes.tolist()):
                vector = parts[k] * reach * direction
                away = min((lengths_of(vector - hit.vector) for hit in known), default=np.inf)
                is_nearest = size <= sizes[max(k - 1, 0) : k + 2].min()
                # In a flat space, and between straight lines that part, a known motion explains a
                # miss that is at least as long as the difference of both velocities.
                if is_nearest and np.isfinite(size) and size < away:
                    near.append((size, len(near), vector))
        near.sort()
        most = 2 * len(self.shooter.start)
        hits = [self.hit(self.aim, vector) for _, _, vector in near[:most]]
        return [hit for hit in hits if hit is not None]

    def conjugate_parts(self, vector: np.ndarray) -> tuple[float, ...]:
        """Parts of a motion at which a point before its end is conjugate to its start."""
        if not vector.any():
            return ()
        parts = np.linspace(0, 1, PARTS + 1)[1:]
        measured = tried(self.shooter.spreads, vector, parts, self.aim)
        if measured is None:
            return ()
        (spreads, is_reversed), conjugate = measured, []
        for k in range(1, len(spreads) - 1):
            before, here, after = spreads[k - 1 : k + 2]
            # Past a zero a singular value grows again as it fell, |t - t*|. Its lowest sample has
            # at most a quarter of the sum of its neighbours, or somewhat more where they curve.
            if here <= min(before, after) and here < (before + after) / 3:
                conjugate.append(float(parts[k] + parts[0] * (before - after) / (before + after)))
        # The end may be nearer to a conjugate point before it than to the next sample.
        noise = self.slope_noise(vector, self.aim)
        if is_reversed and noise < spreads[-1] < spreads[-2]:
            conjugate.append(float(1 - parts[0] * spreads[-1] / (spreads[-1] + spreads[-2])))
        return tuple(conjugate)


def _turned(vector: np.ndarray, move: np.ndarray) -> np.ndarray:
    """A velocity after a move whose part across it turns it, and does not lengthen it.

    Near a conjugate point velocities of one length lead near to it from all sides.
    """
    there, length = vector + move, float(lengths_of(vector))
    ahead = float(lengths_of(there))
    if not ahead or not length:
        return there
    return (length + float(move @ (vector / length))) / ahead * there


def reach_of(followed: list[Followed], lines: list[Line]) -> float:
    """The length within which the shortest motion ends, or may end."""
    lengths = [one.length for one in followed if one.hit is not None]
    if lengths:
        return min(*lengths, lines[0].length)
    # Lines may be much longer than any motion, and motions of their length may take very long.
    longest = 2 * max(one.length for one in followed)
    line = lines[0].length
    return min(longest, line) if longest and np.isfinite(line) else longest or line

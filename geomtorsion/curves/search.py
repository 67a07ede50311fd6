"""Search: motions from one point to another, found along lines and from a fan of directions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from geomtorsion.curves.shooting import ROUNDING, Aim, Line, Shooter
from geomtorsion.ode.newton import SHOTS, STALE, Hit, Newton, lengths_of, tried, turned
from geomtorsion.ode.numbers import PARTS
from geomtorsion.support.caching import cached_property

# Below this singular value of the slopes two motions count as one found twice.
CONJUGATE = 1e-6


@dataclass(frozen=True, eq=False)
class Followed:
    """The motion that hits the end of a line, if one does, and the length of the last motion."""

    hit: Hit | None
    length: float


@dataclass(frozen=True, eq=False)
class Search:
    """Search for motions from a start to an end.

    shooter: the motions; aim: the end; accuracy: relative to the length of a motion.
    """

    shooter: Shooter
    aim: Aim
    accuracy: float

    @cached_property
    def newton(self) -> Newton:
        """Newton's iteration on the initial velocity."""
        return Newton(self.shooter, self.accuracy)

    def followed(self, line: Line) -> Followed:
        """The motion that follows its end along a line, from the start towards the line's end."""
        shooter, total = self.shooter, line.length
        n = len(line.start)
        if not np.isfinite(total):
            first = shooter.step(line.start, line.end - line.start)
            return Followed(self.newton.hit(self.aim, first), float(lengths_of(first)))
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
                for first in (vector + inverse @ gap, turned(vector, inverse @ gap)):
                    ahead = ahead or self.newton.hit(aim, first, inverse, within, enough)
            # A motion longer than the line up to here is not the shortest.
            bound = (1 + STALE) * (at + step) if shooter.is_definite else np.inf
            if ahead is None or ahead.length > bound:
                step /= 2
                if not is_fresh and hit is not None:
                    slopes = self.newton.inverse_slopes(hit.shot, hit.aim)
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

    def direction_error(self, hit: Hit, miss: float) -> float:
        """Bound, perhaps infinite, of the angle between the direction of a hit and the true one."""
        inverse = self.newton.inverse_slopes(hit.shot, hit.aim)
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
        hits = [self.newton.hit(self.aim, vector) for _, _, vector in near[:most]]
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
        noise = self.newton.slope_noise(vector, self.aim)
        if is_reversed and noise < spreads[-1] < spreads[-2]:
            conjugate.append(float(1 - parts[0] * spreads[-1] / (spreads[-1] + spreads[-2])))
        return tuple(conjugate)


def reach_of(followed: list[Followed], lines: list[Line]) -> float:
    """The length within which the shortest motion ends, or may end."""
    lengths = [one.length for one in followed if one.hit is not None]
    if lengths:
        return min(*lengths, lines[0].length)
    # Lines may be much longer than any motion, and motions of their length may take very long.
    longest = 2 * max(one.length for one in followed)
    line = lines[0].length
    return min(longest, line) if longest and np.isfinite(line) else longest or line

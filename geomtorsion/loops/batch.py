"""Batch: line and flux of many loops of one shape at once, refined where they need it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.codegen import numpy_function
from geomtorsion.errors import GeomtorsionError, SingularPointError
from geomtorsion.loops.burgers import DISAGREE, burgers_vector
from geomtorsion.loops.cells import LEVELS, Cell, Rule
from geomtorsion.loops.forms import curl, forms, parameter_values
from geomtorsion.loops.line import EPS, SHAKE
from geomtorsion.loops.loop import Loop

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

# Where a denominator falls below this share of its largest value, a loop is looked at alone.
NEAR_POLE = 0.05
Values = Callable[..., tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True, eq=False)
class Found:
    """Results of several loops, arrays that are filled piece by piece.

    vectors, density, expected: shape (n, k); errors: shape (k,); enclosed: shape (k,).
    """

    vectors: np.ndarray
    density: np.ndarray
    errors: np.ndarray
    expected: np.ndarray
    enclosed: np.ndarray

    def fill(self, chosen: slice, piece: Found) -> None:
        """Put the results of a piece in their place."""
        for name in ("vectors", "density", "errors", "expected", "enclosed"):
            getattr(self, name)[..., chosen] = getattr(piece, name)


@dataclass(frozen=True, eq=False)
class Batch:
    """What all loops of a survey share.

    frame, cell, plane, accuracy, parameters: as the user gave them.
    line: e^i along both directions of the plane, from points (n, k) to (2, n, k), and its noise.
    flux: (de)^i over the plane, from points to (1, n, k), and its noise; None if it vanishes.
    poles: denominators of the coframe, from points (n, k) to (poles, k), or None.
    spent: how many points were evaluated so far, in a list of one.
    """

    frame: Frame
    cell: Cell
    plane: np.ndarray
    accuracy: float
    parameters: Mapping[Any, Any] | None
    line: Values
    flux: Values | None
    poles: Callable[[np.ndarray], np.ndarray] | None
    spent: list[int]

    @classmethod
    def of(
        cls,
        frame: Frame,
        cell: Cell,
        plane: np.ndarray,
        accuracy: float,
        parameters: Mapping[Any, Any] | None,
    ) -> Batch:
        """Compile what a survey needs of a frame."""

        n, spent, compiled = frame.dimension, [0], forms(frame)
        entries = frame.coframe.components.nonzero
        line = _weighted(
            frame,
            [(i, value, plane[:, mu]) for (i, mu), value in entries.items() if plane[:, mu].any()],
            parameters,
            spent,
        )
        bivector = np.outer(plane[0], plane[1]) - np.outer(plane[1], plane[0])
        pairs = [(a, b) for a in range(n) for b in range(a + 1, n) if bivector[a, b]]
        curls = [
            (i, value, bivector[a, b : b + 1])
            for a, b in pairs
            for i in range(n)
            if (value := curl(frame, i, a, b)).is_zero is not True
        ]
        flux = _weighted(frame, curls, parameters, spent) if curls else None
        numbers = parameter_values(frame, compiled.parameters, parameters)

        def poles(points: np.ndarray) -> np.ndarray:
            spent[0] += points.shape[1]
            assert compiled.poles is not None
            return compiled.poles(*points, *numbers)

        return cls(
            frame,
            cell,
            plane,
            accuracy,
            parameters,
            line,
            flux,
            poles if compiled.poles else None,
            spent,
        )

    def solve(self, centres: np.ndarray, axes: np.ndarray) -> Found:
        """All loops with these centres, shape (n, k), and axes, shape (2, k)."""

        scale = axes.max(axis=0)
        rim, rim_error = self._refined(self._along, centres, axes)
        flux, flux_error, expected = np.zeros_like(rim), np.zeros(len(scale)), np.zeros_like(rim)
        if self.flux is not None:
            flux, flux_error = self._refined(self._inside, centres, axes)
            expected = self.flux(centres)[0] * self.cell.area
        # Everything in units of the area of a rectangle; the line integral has one size less.
        across = axes.min(axis=0)
        line, line_error = rim / across, rim_error / across
        apart = np.abs(line - flux).max(axis=0)
        agree = apart <= DISAGREE * (line_error + flux_error)
        by_line = ~agree | (line_error < flux_error)
        value = np.where(by_line, line, flux)
        error = np.where(by_line, line_error, flux_error)
        vectors = np.where(by_line, rim * scale, flux * across * scale)
        result = Found(
            vectors,
            value / self.cell.area,
            error * across * scale,
            expected * axes[0] * axes[1],
            ~agree & np.isfinite(apart) & np.isfinite(flux_error),
        )
        largest = np.abs(value).max(axis=0)
        unsure = ~(error <= np.maximum(self.accuracy * largest, 0)) & ~(largest <= error)
        unsure |= ~np.isfinite(flux_error) | self._near_poles(centres, axes)
        for k in np.flatnonzero(unsure):
            self._single(result, int(k), centres[:, k], axes[:, k])
        return result

    def _near_poles(self, centres: np.ndarray, axes: np.ndarray) -> np.ndarray:
        """Loops on which a denominator of the coframe comes close to zero, shape (k,)."""

        if self.poles is None:
            return np.zeros(axes.shape[1], dtype=bool)
        points = self._points(self.cell.rim(2), centres, axes)
        values = self.poles(points).reshape(-1, axes.shape[1], points.shape[1] // axes.shape[1])
        sizes = np.abs(values)
        near = ~(sizes.min(axis=2) >= NEAR_POLE * sizes.max(axis=2))
        if not np.iscomplexobj(values):
            near |= (values.min(axis=2) < 0) & (values.max(axis=2) > 0)
        return near.any(axis=0)

    def _refined(
        self,
        rule: Callable[[int, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]],
        centres: np.ndarray,
        axes: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Values and errors by rules of rising level, on those loops that need them."""

        before, noise = rule(0, centres, axes)
        error = np.full(len(noise), np.inf)
        value, todo = before.copy(), np.arange(len(noise))
        for level in range(1, LEVELS):
            better, rounding = rule(level, centres[:, todo], axes[:, todo])
            truncation = np.abs(better - before[:, todo]).max(axis=0)
            value[:, todo], before[:, todo] = better, better
            error[todo] = truncation + rounding
            wanted = np.maximum(self.accuracy / 4 * np.abs(better).max(axis=0), rounding)
            todo = todo[~(truncation <= wanted)]
            if not len(todo):
                break
        error[todo] = np.where(np.isfinite(error[todo]), error[todo], np.inf)
        return value, error

    def _points(self, rule: Rule, centres: np.ndarray, axes: np.ndarray) -> np.ndarray:
        """Points of a rule on every loop, shape (n, loops * points)."""

        offsets = axes[:, :, None] * rule.points[:, None, :]
        spread = np.tensordot(self.plane, offsets, axes=(0, 0))
        return (centres[:, :, None] + spread).reshape(len(centres), -1)

    def _along(
        self, level: int, centres: np.ndarray, axes: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Line integrals over the larger axis, and what rounding does to them."""

        rule = self.cell.rim(level)
        points = self._points(rule, centres, axes)
        values, _ = self.line(points)
        shares = axes / axes.max(axis=0)
        shape = (2, len(centres), axes.shape[1], -1)
        sums = np.einsum("ankp,ap,ak->nk", values.reshape(shape), rule.weights, shares)
        few = points.reshape(len(centres), axes.shape[1], -1)[:, :, ::5].reshape(len(centres), -1)
        values, noise = self.line(few, shaken=True)
        noise = noise.reshape(shape).mean(axis=3)
        lengths = np.abs(rule.weights).sum(axis=1)
        return sums, np.einsum("ank,a,ak->nk", noise, lengths, shares).max(axis=0)

    def _inside(
        self, level: int, centres: np.ndarray, axes: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Fluxes over the product of the axes, and what rounding does to them."""
        assert self.flux is not None
        rule = self.cell.inside(level)
        values, _ = self.flux(self._points(rule, centres, axes))
        sums = values[0].reshape(len(centres), axes.shape[1], -1) @ rule.weights
        _, noise = self.flux(centres, shaken=True)
        return sums, self.cell.area * noise[0].max(axis=0)

    def _single(self, result: Found, k: int, centre: np.ndarray, axes: np.ndarray) -> None:
        """One loop that the batch could not settle."""

        try:
            loop = self._loop(centre, axes)
            b = burgers_vector(self.frame, loop, self.accuracy, parameters=self.parameters)
        except (SingularPointError, GeomtorsionError):
            result.vectors[:, k], result.density[:, k] = np.nan, np.nan
            result.errors[k], result.enclosed[k] = np.inf, False
            return
        self.spent[0] += b.evaluations
        result.vectors[:, k], result.errors[k] = b.vector, b.error
        result.density[:, k] = b.reduced * b.size ** (b.power - 1) / (self.cell.area * axes.min())
        result.enclosed[k] = b.check.agrees is False

    def _loop(self, centre: np.ndarray, axes: np.ndarray) -> Loop:
        """A loop of the survey as a loop of its own."""
        first, second = self.plane.tolist()
        if self.cell.name == "circle":
            return Loop.circle(centre.tolist(), float(axes[0]), (first, second))
        a, b = (axes / axes.max()).tolist()
        corners = [(-a / 2, -b / 2), (a / 2, -b / 2), (a / 2, b / 2), (-a / 2, b / 2)]
        vertices = [[x * u + y * v for u, v in zip(first, second, strict=True)] for x, y in corners]
        return Loop.polygon(vertices, centre=centre.tolist(), size=float(axes.max()))


def _weighted(
    frame: Frame,
    terms: list[tuple[int, Any, np.ndarray]],
    parameters: Mapping[Any, Any] | None,
    spent: list[int],
) -> Values:
    """Sums of (row, element, weights) as a function of points, with the noise if it is asked for.

    The function gives values of shape (weights, n, k), and how far rounding may move them.
    """

    elements = [value for _, value, _ in terms]
    needed = {symbol for value in elements for symbol in value.symbols} - set(frame.coordinates)
    wanted = [symbol for symbol in frame.field.symbols if symbol in needed]
    numbers = parameter_values(frame, wanted, parameters)
    key = f"survey {[str(x) for x in elements]}"
    arguments = [*frame.coordinates, *wanted]
    function = frame.derived(key, lambda: numpy_function(elements, arguments, check=False))
    gather = np.zeros((len(terms[0][2]), frame.dimension, len(terms)))
    for column, (row, _, weights) in enumerate(terms):
        gather[:, row, column] = weights

    def values(points: np.ndarray, shaken: bool = False) -> tuple[np.ndarray, np.ndarray]:
        spent[0] += points.shape[1] * (2 if shaken else 1)
        here = function(*points, *numbers)
        if not shaken:
            return gather @ here, np.zeros(1)
        signs = np.where(np.arange(points.size).reshape(points.shape) * 7 % 3 == 1, SHAKE, -SHAKE)
        there = function(*(points * (1 + signs)), *numbers)
        noise = np.abs(there - here) / 4 + 4 * EPS * np.abs(here)
        return gather @ here, np.abs(gather) @ noise

    return values

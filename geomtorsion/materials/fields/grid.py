"""Grid: regular axes, which of them are periodic, and the nodes that are holes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.loops.arcs import shown
from geomtorsion.materials.fields.stencils import SLACK, KnownNodes, Rule, plain_rule
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

# Largest relative deviation of a step; coordinates are often stored as 32-bit floats.
REGULAR = 1e-4
ORDERS = (2, 4, 6, 8)


def numbers(values: object, where: str) -> np.ndarray:
    """An array of real numbers; nan is unknown."""
    return checks.measured(checks.array(values, where, GridError, infinite=None), where, GridError)


def check_order(order: object) -> None:
    """Refuse an order without rules."""
    checks.choice(order, ORDERS, "order", GridError)


def other_order(order: int) -> int:
    """The order to compare with, which gives the error of an order."""
    return order - 2 if order > 2 else 4


def check_length(names: Sequence[str], shape: Sequence[int], order: int) -> None:
    """Refuse axes that are too short for an order and its `other_order`."""
    needed = max(order, other_order(order)) + 1
    for name, count in zip(names, shape, strict=True):
        if count < needed:
            raise GridError(
                f"axis {name}: expected {needed} points or more, for order {order} with its error "
                f"estimate, got {count}. Choose a lower order."
            )


def regular_axis(values: object, name: str) -> np.ndarray:
    """Coordinates of a regular axis, checked."""
    axis = numbers(values, f"axis {name}")
    if axis.ndim != 1 or len(axis) < 2:
        raise GridError(f"axis {name}: expected a list of coordinates, got shape {axis.shape}.")
    if not np.isfinite(axis).all():
        bad = int(np.flatnonzero(~np.isfinite(axis))[0])
        raise GridError(f"axis {name}: expected finite numbers, got {axis[bad]} at entry {bad}.")
    step = (axis[-1] - axis[0]) / (len(axis) - 1)
    checks.measured(axis[-1] - axis[0], f"axis {name}", GridError, is_length=True)
    worst = int(np.abs(np.diff(axis) - step).argmax())
    if step == 0 or abs(axis[worst + 1] - axis[worst] - step) > REGULAR * abs(step):
        raise GridError(
            f"axis {name}: expected equal steps other than 0, got "
            f"{axis[worst + 1] - axis[worst]:.6g} at step {worst} and {step:.6g} on average. "
            "Resample the data."
        )
    return axis


def check_names(axes: Sequence[object], names: Sequence[str]) -> None:
    """Refuse a grid with fewer than two axes, or without a name for each axis."""
    if len(names) != len(axes) or len(axes) < 2:
        raise GridError(
            f"axes: expected two axes or more with a name for each, got {len(axes)} axes and "
            f"{len(names)} names."
        )


def two_axes(plane: object, dimension: int) -> tuple[int, int]:
    """The axes of a plane: two different ones of the grid."""
    pair = tuple(checks.rows(plane)) if checks.is_list(plane) else ()
    chosen_axes = [x for x in pair if isinstance(x, int) and x in range(dimension)]
    if len(pair) != 2 or len(set(chosen_axes)) != 2:
        raise GridError(
            f"plane: expected two different axes from 0 to {dimension - 1}, got "
            f"{checks.shown(plane)}. Give them like (0, 1)."
        )
    return pair[0], pair[1]


def periodic_axes(given: object, names: Sequence[str]) -> tuple[bool, ...]:
    """Whether each axis is periodic, from truth values or from names of periodic axes."""
    if given is None or given is False:
        return (False,) * len(names)
    if given is True:
        return (True,) * len(names)
    entries = [given] if isinstance(given, str) else checks.entries(given, "periodic", GridError)
    if not entries:
        return (False,) * len(names)
    if all(isinstance(entry, str) for entry in entries):
        for entry in entries:
            checks.known_name(entry, names, "periodic", GridError)
        return tuple(name in entries for name in names)
    if len(entries) != len(names) or not all(isinstance(x, bool | np.bool_) for x in entries):
        raise GridError(
            f"periodic: expected True or False for each of {len(names)} axes, or names of axes, "
            f"got {checks.shown(given)}."
        )
    return tuple(bool(entry) for entry in entries)


def mask_of(given: object, shape: tuple[int, ...]) -> np.ndarray:
    """Unknown nodes, from a mask of truth values."""
    if given is None:
        return np.zeros(shape, dtype=bool)
    try:
        mask = np.asarray(given)
    except (TypeError, ValueError):
        mask = np.array(None)
    if mask.dtype.kind != "b" or mask.shape != shape:
        raise GridError(
            f"mask: expected truth values of shape {shape}, True at unknown nodes, got "
            f"{mask.dtype} of shape {mask.shape}."
        )
    return mask


@dataclass(frozen=True, eq=False)
class Grid:
    """A regular grid with holes.

    axes: coordinates, one array for each axis. names: of the axes. periodic: whether the first node
    of an axis follows the last. holes: True where nothing is known, shape (N_1, ..., N_d).
    spacing: of the axes, if it must not be computed from them, so that all blocks of a grid have
    equal spacing.
    """

    axes: tuple[np.ndarray, ...]
    names: tuple[str, ...]
    periodic: tuple[bool, ...]
    holes: np.ndarray
    spacing: tuple[float, ...] | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of nodes along each axis."""
        return tuple(len(axis) for axis in self.axes)

    @cached_property
    def steps(self) -> tuple[float, ...]:
        """Spacing of each axis; negative where it decreases."""
        if self.spacing is not None:
            return self.spacing
        return tuple(float(axis[-1] - axis[0]) / (len(axis) - 1) for axis in self.axes)

    @property
    def dimension(self) -> int:
        """Number of axes."""
        return len(self.axes)

    @cached_property
    def has_holes(self) -> bool:
        """Whether the grid has holes."""
        return bool(self.holes.any())

    @cached_property
    def known(self) -> KnownNodes:
        """Stencils for points between the nodes."""
        return KnownNodes(self.shape, self.periodic, self.holes)

    def rule(self, order: int, axis: int, slopes: bool = False) -> Rule:
        """Integrals over the edges along an axis, or derivatives at the nodes (spacing 1)."""
        points = self.shape[axis]
        if not self.has_holes:
            return plain_rule(order, points, self.periodic[axis], slopes)
        lines = np.moveaxis(self.holes, axis, 0).reshape(points, -1)
        return Rule.of(order, lines, self.periodic[axis], slopes)

    def place_of(self, node: Sequence[int]) -> str:
        """Coordinates of a node, for messages."""
        return ", ".join(
            f"{name} = {axis[k]:.6g}"
            for name, axis, k in zip(self.names, self.axes, node, strict=True)
        )

    def pixels(self, nodes: np.ndarray) -> str:
        """Nodes as text, from their numbers, shape (k, d), for messages."""
        rows = np.unique(nodes, axis=0)
        return checks.cut(", ".join(str(tuple(row)) for row in rows.tolist()))

    def places(self, points: np.ndarray, what: str) -> np.ndarray:
        """Points of shape (d, k) in units of the spacing; points outside the grid are refused."""
        places = np.array(
            [
                (row - axis[0]) / step
                for row, axis, step in zip(points, self.axes, self.steps, strict=True)
            ]
        )
        last = np.array([len(axis) - 1 for axis in self.axes])[:, None]
        free = np.array(self.periodic)[:, None]
        outside = ~free & ((places < -SLACK) | (places > last + SLACK)) | ~np.isfinite(places)
        if outside.any():
            axis, k = (int(i) for i in np.argwhere(outside)[0])
            low, high = sorted((float(self.axes[axis][0]), float(self.axes[axis][-1])))
            raise GridError(
                f"the {what} leaves the grid at {shown(points[:, k])}: axis {self.names[axis]} "
                f"runs from {low:.6g} to {high:.6g}. Stay inside the grid, because values are "
                "not extrapolated."
            )
        return np.where(free, places, np.clip(places, 0, last))

    def check_periods(self, gap: np.ndarray) -> None:
        """Refuse a loop whose ends do not differ by whole periods of the grid."""
        for k, name in enumerate(self.names):
            period = abs(self.steps[k]) * self.shape[k]
            turns = float(gap[k]) / period
            if abs(turns - (round(turns) if self.periodic[k] else 0)) > REGULAR:
                has = f"has the period {period:.6g}" if self.periodic[k] else "is not periodic"
                raise GridError(
                    f"the loop ends {gap[k]:.6g} from its start along {name}, but that axis {has}. "
                    "Give the grid and the loop the same periods."
                )

    def refuse_holes(self, used: np.ndarray, places: np.ndarray, what: str) -> None:
        """Refuse points without known nodes around them; the message names the unknown nodes."""
        bad = np.flatnonzero(used == 0)
        if not len(bad):
            return
        cells = np.floor(places[:, bad[0]] + SLACK).astype(int)
        thin = np.abs(places[:, bad[0]] - cells) < SLACK
        ends = np.array(list(np.ndindex(*(2,) * self.dimension)))
        corners = (ends * ~thin + cells) % np.array(self.shape)
        nodes = corners[self.holes[tuple(corners.T)]]
        point = [
            float(axis[0] + step * place)
            for axis, step, place in zip(self.axes, self.steps, places[:, bad[0]], strict=True)
        ]
        raise GridError(
            f"the {what} touches a hole at {shown(point)}, where values are missing at node "
            f"{self.pixels(nodes)}. Only a {what} in a plane of nodes, of at least twice the area "
            "of the rings around its holes, goes around them. Avoid the hole: .holes lists all "
            "holes, and .loop_around(hole) makes a loop around one."
        )


def check_shape(values: np.ndarray, shape: tuple[int, ...]) -> None:
    """Refuse values that do not fit the axes."""
    d = len(shape)
    columns = (d, 3) if d == 2 else (d,)
    if values.shape[2:] != shape or not len(values) or values.shape[1] not in columns:
        raise GridError(
            f"coframe: expected shape (rows, {d}, {', '.join(map(str, shape))}) (frame index, "
            f"coordinate index, grid), got {values.shape}."
        )


def check_values(values: np.ndarray, grid: Grid) -> None:
    """Refuse infinite values, and grids without any known node."""
    bad = np.argwhere(np.isinf(values) & ~grid.holes)
    if len(bad):
        i, mu, *place = bad[0].tolist()
        raise GridError(
            f"coframe[{i}, {mu}]: expected finite values, got infinity at {grid.place_of(place)} "
            f"(and at {len(bad) - 1} more entries). Mask those nodes (NaN is a hole) or fill them; "
            "a singular line must be between nodes."
        )
    if grid.holes.all():
        raise GridError(
            "coframe: expected values at some nodes, got none: every node is masked or has a NaN. "
            "Is the mask inverted? True marks an unknown node."
        )


def several(given: object, count: int, name: str, least: int) -> tuple[int, ...]:
    """Whole numbers, one for each axis, from one for each or one for all."""
    entries = checks.rows(given)
    rows = list(entries) if isinstance(entries, list | tuple) else [given] * count
    if len(rows) != count:
        raise GridError(f"{name}: expected one number or {count}, got {checks.shown(given)}.")
    return tuple(checks.count(n, name, GridError, least) for n in rows)


def signs_of(signature: object, count: int) -> tuple[int, ...]:
    """Signs of the rows of a coframe from a text such as "-+++"; all + for an empty text."""
    text = checks.text(signature, "signature", GridError)
    if text and (len(text) != count or set(text) - set("+-")):
        raise GridError(
            f"signature: expected {count} signs, one for each row, like {'-' + '+' * (count - 1)}, "
            f"got {checks.shown(text)}."
        )
    return tuple(-1 if sign == "-" else 1 for sign in text or "+" * count)

"""scene cones: how a body turns, seen from itself (polhode) and from space (herpolhode, cones)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.pictures.sphere import BEHIND, curve_on, globe, parted, space_axes, towards
from geomtorsion.pictures.style import SERIES, Stroke, captioned, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SEPARATRIX, OTHERS = "#b04a86", "#a9cbe6"
# A direction that keeps its angle from the angular momentum within this (radians) sweeps a cone.
CONE = 0.15
POLHODE, AXIS, SPIN, MOMENTUM = (
    Stroke("#0072B2", "-", 2.0, "^"), SERIES[0], SERIES[1], SERIES[3],
)  # fmt: skip
FAMILY = (0.06, 0.2, 0.4, 0.6, 0.8, 0.94)


def cones_picture(
    moments: Sequence[float],
    omega: Any,
    matrices: Any = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """The angular momentum on its sphere in the body; axis and angular velocity in space.

    In the body, pale: all motions with this angular momentum and no moment; violet: those that
    part turning about the first from turning about the third axis.

    Parameters
    ----------
    moments
        principal moments of inertia, shape (3,).
    omega
        angular velocity, body axes, shape (m, 3).
    matrices
        rotations from body to space, shape (m, 3, 3); without them only the first panel is drawn.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    inertia = np.asarray(moments, dtype=float)
    momentum = inertia * np.asarray(omega, dtype=float)
    sizes = np.linalg.norm(momentum, axis=1, keepdims=True)
    direction = momentum / np.where(sizes > 0, sizes, 1)
    panels = 1 if matrices is None else 2
    figure = new_figure(5.6 * panels, 5.7)
    ball: Any = figure.add_subplot(1, panels, 1, projection="3d")
    _in_body(ball, inertia, direction)
    lines = ["Body: direction of the angular momentum; pale: other free motions of the body."]
    if matrices is not None:
        turn = np.asarray(matrices, dtype=float)
        space: Any = figure.add_subplot(1, panels, 2, projection="3d")
        _in_space(space, turn, np.asarray(omega, dtype=float), momentum)
        lines.append("Dots: start; triangle and square: ends.")
    if title:
        figure.suptitle(title, fontsize=12)
    captioned(figure, [*notes, *lines])
    return figure


def _in_body(axes: Any, inertia: np.ndarray, direction: np.ndarray) -> None:
    """The sphere of angular momentum with the family of polhodes and the one that is travelled."""
    viewer = globe(axes, 1.0, towards([direction]), elevation=24.0)
    for value in _levels(inertia):
        for ring, special in polhodes(inertia, value):
            color = SEPARATRIX if special else OTHERS
            for part, front in parted(ring, viewer):
                alpha = (0.9 if special else 1.0) if front else BEHIND
                axes.plot(*part.T, color=color, linewidth=1.1, alpha=alpha)
    for k, pin in enumerate(np.eye(3)):
        for sign in (1, -1):
            look = {"alpha": 1.0 if sign * pin @ viewer >= 0 else BEHIND, "color": "#555555"}
            axes.plot(*(np.array([pin, 1.09 * pin]).T * sign), linewidth=1.4, **look)
            if sign > 0:
                axes.text(*(1.17 * pin), str(k + 1), ha="center", va="center", **look)
    curve_on(axes, direction, viewer, POLHODE)
    axes.set_title("seen from the body", fontsize=11, pad=16)


def _levels(inertia: np.ndarray) -> list[float]:
    """Values of 2 E / L^2 between the least and the largest, the middle axis among them."""
    low, middle, high = sorted(1 / inertia)
    if high - low <= 1e-9 * high:
        return []
    found = [low + share * (middle - low) for share in FAMILY if middle - low > 1e-9 * high]
    found += [middle + share * (high - middle) for share in FAMILY if high - middle > 1e-9 * high]
    return [*found, float(np.float64(middle))]


def polhodes(inertia: Any, value: float) -> list[tuple[np.ndarray, bool]]:
    """Closed curves on the unit sphere on which sum l_k^2 / I_k is constant.

    Each comes with whether it is the separatrix. The sphere is cut as a function of the angle
    about the axis that the curve goes round.

    Examples
    --------
    >>> import numpy as np
    >>> rings = polhodes([1.0, 2.0, 3.0], 0.8)
    >>> len(rings), bool(abs((rings[0][0] ** 2 / [1, 2, 3]).sum(axis=1) - 0.8).max() < 1e-12)
    (2, True)
    """
    weights = 1 / np.asarray(inertia, dtype=float)
    order = np.argsort(weights)
    low, middle, high = weights[order]
    special = bool(abs(value - middle) <= 1e-12 * high) and low < middle < high
    # Below the middle the curves go round the axis of least weight, above round that of largest.
    pole = order[2] if value >= middle else order[0]
    first, second = (k for k in range(3) if k != pole)
    turn = np.linspace(0, 2 * np.pi, 241)
    across = weights[first] * np.cos(turn) ** 2 + weights[second] * np.sin(turn) ** 2
    gap = weights[pole] - across
    with np.errstate(divide="ignore", invalid="ignore"):
        sine = np.where(gap != 0, (weights[pole] - value) / gap, 1.0)
    sine = np.sqrt(np.clip(sine, 0.0, 1.0))
    found = []
    for sign in (1.0, -1.0):
        ring = np.empty((len(turn), 3))
        ring[:, first], ring[:, second] = sine * np.cos(turn), sine * np.sin(turn)
        ring[:, pole] = sign * np.sqrt(1 - sine**2)
        found.append((ring, special))
    return found


def _in_space(axes: Any, turn: np.ndarray, omega: np.ndarray, momentum: np.ndarray) -> None:
    """Axis of the body, angular velocity and angular momentum as directions in space."""
    tip = turn[:, :, 2]
    spin = np.einsum("mij,mj->mi", turn, omega)
    fixed = np.einsum("mij,mj->mi", turn, momentum)
    curves = []
    for vectors in (tip, spin, fixed):
        sizes = np.linalg.norm(vectors, axis=1, keepdims=True)
        curves.append(vectors / np.where(sizes > 0, sizes, 1))
    viewer = globe(axes, 1.0, towards(curves[:2]), elevation=24.0)
    space_axes(axes, 1.0, viewer)
    names = ("axis 3 of the body", "angular velocity", "angular momentum")
    for points, stroke, name in zip(curves, (AXIS, SPIN, MOMENTUM), names, strict=True):
        curve_on(axes, points, viewer, stroke, name)
    for points, stroke in zip(curves[:2], (AXIS, SPIN), strict=True):
        angle = np.arccos(np.clip((points * curves[2]).sum(axis=1), -1, 1))
        if np.ptp(angle) > CONE:
            continue
        for place in points[:: max(len(points) // 60, 1)]:
            axes.plot(
                *np.array([np.zeros(3), place]).T, color=stroke.color, linewidth=0.5, alpha=0.25
            )
    axes.set_title("seen from space", fontsize=11, pad=16)
    axes.legend(
        loc="upper center", bbox_to_anchor=(0.5, 0.05), frameon=False, fontsize=9, ncols=3,
        handlelength=2.4, columnspacing=1.2,
    )  # fmt: skip

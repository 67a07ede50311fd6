"""Cone: the development of a loop from curvature and torsion on the cone over it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geomtorsion.errors import LoopError, SingularPointError
from geomtorsion.loops.affine_form import AffineForm
from geomtorsion.loops.affine_map import AffineMap
from geomtorsion.loops.arcs import Part, Segment
from geomtorsion.loops.forms import perturbed
from geomtorsion.loops.integrals import probes
from geomtorsion.loops.quadrature import ROUNDING, ray_rule
from geomtorsion.loops.transport import (
    Integrand,
    Transported,
    collocation,
    inner_turns,
    transported,
)

# Gauss points along the rays: pairs that are compared, the next if they disagree.
LEVELS = ((6, 10), (10, 16), (16, 26))
# Loops whose area is below this lose digits to underflow; the line integral alone is left to them.
SMALLEST_AREA = float(np.finfo(float).tiny / np.finfo(float).eps)


def around_cone(form: AffineForm, part: Part, accuracy: float) -> Transported | None:
    """The development of one part, once round, from its base point; None if the cone is singular.

    Equation
    --------
    With g(u) the development along the ray from the centre to a point x(s) of the loop,
    H' = H integral_0^1 u g F(x, x') g^-1 du, F = (R, T) curvature and torsion: Stokes for
    path-ordered products. G = g^-1 H g at the base point. F is exact and x is the offset itself,
    so that nothing cancels, however small the loop.

    """
    if part.size * part.size < SMALLEST_AREA:
        return None
    try:
        levels = _levels(form, part, accuracy)
        if levels is None:
            return None
        count, missed, turn_missed = levels
        found = transported(part.arcs, lambda x, v: cone_rate(form, part, x, v, count), accuracy)
        # Without turns a motion is a plain sum, the same from everywhere.
        ray = from_centre(form, part) if form.turns else None
    except (SingularPointError, LoopError):
        return None
    turn_error = found.turn_error + turn_missed * len(part.arcs)
    error = found.error + missed * len(part.arcs)
    motion = found.motion
    if ray is not None:
        motion = motion.seen_from(ray)
        error += float(np.linalg.norm(ray.burgers)) * turn_error
    error += ROUNDING * float(np.abs(motion.burgers).max())
    return Transported(motion, error, turn_error, found.scale, found.points * count)


def _levels(form: AffineForm, part: Part, accuracy: float) -> tuple[int, float, float] | None:
    """How many points the rays need; what they and rounding miss of translation and rotation."""
    x, v, _ = probes(part.arcs)
    centre = tuple(perturbed(np.array(part.centre)).tolist())
    moved = replace(part, centre=centre)
    known: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    for few, many in LEVELS:
        for count in (few, many):
            if count not in known:
                known[count] = cone_rate(form, part, x, v, count)
        other = cone_rate(form, moved, x, v, many)
        errors, good = [], True
        for coarse, fine, after in zip(known[few], known[many], other, strict=True):
            size = float(np.abs(fine).max(initial=0.0))
            noise = float(np.abs(after - fine).max(initial=0.0)) + ROUNDING * size
            missed = float(np.abs(coarse - fine).max(initial=0.0))
            good &= missed <= max(accuracy * size, 2 * noise)
            errors.append(missed + noise)
        if good:
            return many, errors[1], errors[0]
    return None


def cone_rate(
    form: AffineForm, part: Part, offsets: np.ndarray, slopes: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """The rate of H at points of the loop, seen from the centre, shapes (k, n, n) and (k, n)."""
    n, k = offsets.shape
    u, weights = ray_rule(count)
    centre = np.array(part.centre)[:, None]
    x, v = np.repeat(offsets, count, axis=1), np.repeat(slopes, count, axis=1)
    inner = np.tile(u, k)
    rho, tau = form.over(centre + part.size * (inner * x), part.size * x, part.size * v)
    rho, tau = rho.reshape(k, count, n, n), tau.reshape(k, count, n)
    if form.turns:
        turn, shift = _along_rays(form, part, offsets, u)
        turned = turn @ rho @ np.linalg.inv(turn)
        tau = (turn @ tau[..., None] - turned @ shift[..., None])[..., 0]
        rho = turned
    return np.einsum("u,kuij->kij", weights, rho), np.einsum("u,kui->ki", weights, tau)


def _along_rays(
    form: AffineForm, part: Part, offsets: np.ndarray, stops: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Rotation and translation along each ray up to the stops, shapes (k, u, n, n), (k, u, n)."""
    n, k = offsets.shape
    nodes, _, integrals = collocation(len(stops))
    centre = np.array(part.centre)[:, None]
    x = np.repeat(offsets, len(nodes), axis=1)
    places = centre + part.size * (np.tile(nodes, k) * x)
    omega, theta = form.along(places, part.size * x)
    omega, theta = omega.reshape(k, -1, n, n), theta.reshape(k, -1, n)
    inner = inner_turns(omega, integrals)
    rates = theta + (inner @ theta[..., None])[..., 0]
    turn_rates = omega + inner @ omega
    # The polynomials through the nodes, integrated up to the stops.
    upto = integrals_up_to(stops, len(nodes))
    turn = np.eye(n) + (upto @ turn_rates.reshape(k, -1, n * n)).reshape(k, -1, n, n)
    return turn, upto @ rates


def integrals_up_to(stops: np.ndarray, stages: int) -> np.ndarray:
    """Integrals of the node polynomials from 0 to each stop, shape (stops, stages)."""
    x, w = np.polynomial.legendre.leggauss(stages)
    values = np.polynomial.legendre.legvander(2 * stops - 1, stages)
    k = np.arange(stages)
    basis = np.polynomial.legendre.legvander(x, stages - 1)
    expansion = basis.T * w * (2 * k[:, None] + 1) / 2
    upto = np.empty((len(stops), stages))
    upto[:, 0] = 2 * stops
    upto[:, 1:] = (values[:, 2:] - values[:, :-2]) / (2 * k[1:] + 1)
    return upto @ expansion / 2


def from_centre(form: AffineForm, part: Part) -> AffineMap:
    """Development from the centre of a part straight to its base point."""
    base = tuple(part.base_offset.tolist())
    ray = Segment((0.0,) * len(base), base)
    return transported([ray], line_rate(form, part), 1e-14).motion


def line_rate(form: AffineForm, part: Part) -> Integrand:
    """The form along an arc of a part, from offsets and slopes."""
    centre = np.array(part.centre)[:, None]

    def rate(offsets: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return form.along(centre + part.size * offsets, part.size * slopes)

    return rate

"""Frequencies: the waves of radial equations that only leave, those damped least, none missing.

Coarse grids in doubles give rough frequencies. Newton's iteration in many digits gives the others,
on finer and finer grids. A field with a mass is followed from the same field without mass, so that
a frequency that the coarse grids miss is noticed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import mpmath
import numpy as np
import scipy  # loads its parts on first use
import sympy as sp
from flint import acb, acb_mat, ctx

from geomtorsion.errors import AccuracyError
from geomtorsion.gravity.perturbed.collocation import Dispersion, Radial

# Numbers of nodes: of the rough frequencies, and of the finer grids with their step.
ROUGH = (30, 38)
FIRST, STEP, LAST = 44, 12, 128
# Frequencies that are looked for: oscillations in units of 1/duration of the hole, and the largest
# damping in units of 1/r_h.
SLOWEST, MOST = 0.02, 4.0
# Relative distance in which two rough grids share a frequency.
SHARED = 1e-2
# Relative distance from a rough frequency that the iteration may go, and the steps it may take.
NEAR, STEPS = 0.1, 30
# Halvings of a step in m^2 after which a mode is lost.
HALVINGS = 8


def _shared(radial: Radial) -> np.ndarray:
    """Rows of w and k, in doubles, that two grids share.

    A grid also has false waves, many of them where k is almost 0.
    """
    first, second = (_eigenvalues(radial.matrices(count)) for count in ROUGH)
    rows = []
    for z in second[second != 0]:
        w, k = complex(radial.dispersion.frequency(acb(z))), radial.dispersion.momentum(acb(z))
        if np.abs(first - z).min() < SHARED * abs(complex(k)):
            rows.append((w, complex(k)))
    return np.array(rows, complex).reshape(-1, 2)


def rough(radial: Radial) -> list[complex]:
    """Numbers z of waves that two rough grids share, those damped least first."""
    hole, waves = radial.hole, []
    for w, k in _shared(radial):
        z = complex(w if radial.dispersion.mass2 == 0 else w + k)
        if not radial.dispersion.leaves(z):
            continue
        if w.real * hole.duration < SLOWEST or w.imag >= 0:
            continue
        if -w.imag * float(hole.inner) > MOST:
            continue
        waves.append((-w.imag, z))
    return [z for _, z in sorted(waves, key=lambda one: one[0])]


def _eigenvalues(matrices: Sequence[acb_mat]) -> np.ndarray:
    """Finite eigenvalues of a matrix of polynomials, by its companion."""
    parts = [np.array([[complex(x) for x in row] for row in m.tolist()]) for m in matrices]
    degree, n = len(parts) - 1, len(parts[0])
    left = np.zeros((degree * n, degree * n), complex)
    right = np.eye(degree * n, dtype=complex)
    for k in range(degree - 1):
        left[k * n : (k + 1) * n, (k + 1) * n : (k + 2) * n] = np.eye(n)
    for k in range(degree):
        left[(degree - 1) * n :, k * n : (k + 1) * n] = -parts[k]
    right[(degree - 1) * n :, (degree - 1) * n :] = parts[degree]
    values = scipy.linalg.eigvals(left, right)
    return values[np.isfinite(values)]


def frequencies(radial: Radial, modes: int, digits: int) -> list[tuple[acb, float]]:
    """Frequencies with their errors, those damped least first.

    Raises
    ------
    AccuracyError
        The digits are not reached, there are fewer modes, or one that is damped less is missing.
    """
    with mpmath.workdps(digits + 30), ctx.workdps(digits + 30):
        followed = _followed(radial, modes)
        candidates = [Candidate(radial.dispersion, acb(z)) for z in rough(radial)]
    settled, distinct = _on_grids(radial, candidates, modes, digits)
    result = distinct[:modes]
    last = result[-1][0] if len(result) == modes else None
    missing = [one for one in candidates if _before(one.frequency, last) and one not in settled]
    if last is None:
        left = [one.changes[-1] for one in missing if one.changes and one.alive]
        others = ", ".join(f"{x:.0e}" for x in left[:modes]) or "nothing"
        raise AccuracyError(
            f"ringing: expected {modes} frequencies with {digits} digits, got {len(distinct)}; the "
            f"finest grid changed others by {others}. Request fewer digits or modes."
        )
    if missing:
        raise _missing(result, f"a wave near {_text(missing[0].frequency)} that did not settle")
    if followed is None:
        _check_damping(radial, complex(result[0][0]))
    for w in followed or ():
        if _before(acb(w), last) and all(_size(acb(w) - x) > SHARED * abs(w) for x, _ in result):
            raise _missing(result, f"none near {_text(acb(w))}, to which a mode leads from m = 0")
    return result


def _on_grids(
    radial: Radial, candidates: Sequence[Candidate], modes: int, digits: int
) -> tuple[list[Candidate], list[tuple[acb, float]]]:
    """Candidates that settled on finer and finer grids, and their distinct frequencies."""
    tolerance = 10.0**-digits
    settled, distinct = list[Candidate](), list[tuple[acb, float]]()
    for count in range(FIRST, LAST + 1, STEP):
        # A finer grid loses more digits.
        work = digits + 30 + count // 2
        with mpmath.workdps(work), ctx.workdps(work):
            active = _refined(candidates, radial.matrices(count), modes, tolerance)
            settled = [one for one in active if one.settled(tolerance)]
            distinct = _distinct([(one.frequency, one.error) for one in settled])
        is_enough = len(distinct) >= modes and all(x in settled or x.stalled for x in active)
        if is_enough or all(one in settled or not one.alive for one in candidates):
            break
    return settled, distinct


def _before(value: acb, last: acb | None) -> bool:
    """Whether a frequency is damped less than another, where there is one."""
    return last is None or float((value - last).imag.mid()) > SHARED * float(last.imag.mid())


def _text(value: acb) -> str:
    w = complex(value)
    return f"{w.real:.3g} - {-w.imag:.3g} i"


def _missing(result: Sequence[tuple[acb, float]], cause: str) -> AccuracyError:
    return AccuracyError(
        f"ringing: expected all modes that are damped less than {_text(result[-1][0])}, got "
        f"{cause}. Request fewer digits or modes, or a smaller mass of the field."
    )


def _check_damping(radial: Radial, least: complex) -> None:
    """Refuse a mode damped least that is an overtone by its damping.

    The overtone n of waves near the light ring is damped 2 n + 1 times as fast as the first mode.
    """
    damping = radial.hole.damping
    if -least.imag > 2 * damping:
        raise AccuracyError(
            f"ringing: expected a mode with a damping of about {damping:.3g}, as waves near the "
            f"light ring have, got {_text(acb(least))} as the first. The mode damped least does "
            "not oscillate or is missing; use another l or another hole."
        )


# -- fields with a mass ----------------------------------------------------------------------------


def _followed(radial: Radial, modes: int) -> list[complex] | None:
    """Frequencies of the modes damped least, followed from the field without mass.

    A mode whose damping decreases to 0 on the way exists no longer [Ohashi, Sakagami 2004]; the
    next overtone takes its place. None for a field without mass.
    """
    if radial.dispersion.mass2 == 0:
        return None
    light = radial.with_mass(sp.S.Zero)
    starts = rough(light)
    if not starts:
        raise AccuracyError(
            "ringing: expected a mode of the field without mass, from which the mode is followed, "
            "got none. Use another l or another hole."
        )
    _check_damping(light, starts[0])
    number, ends = 0, list[complex]()
    spectra: dict[sp.Expr, np.ndarray] = {}
    while len(ends) < modes and number < len(starts):
        number = min(number + modes - len(ends), len(starts))
        ends = _ends(radial, starts[:number], spectra)
    return ends


def _ends(
    radial: Radial, starts: Sequence[complex], spectra: dict[sp.Expr, np.ndarray]
) -> list[complex]:
    """Frequencies at the mass of a field, from those without mass; without modes that vanish.

    The step in m^2 is halved where it is not certain which mode is which. spectra: by m^2.
    """
    points = [np.array([w, w]) for w in starts]
    slopes = [np.zeros(2, complex) for _ in starts]
    full = radial.mass2
    part = sp.S.Zero
    step = sp.Rational(1, 2 ** max(math.ceil(math.log2(full / abs(starts[0]) ** 2)), 0))
    least = step / 2**HALVINGS
    while part < 1 and points:
        step = min(step, 1 - part)
        if step < least:
            raise AccuracyError(
                f"ringing: expected to follow the modes from m = 0 to m^2 = {full}, got to "
                f"{_text(acb(points[0][0]))} at m^2 = {part * full}. Use a smaller mass of the "
                "field, or fewer modes."
            )
        mass2 = (part + step) * full
        if mass2 not in spectra:
            spectra[mass2] = _shared(radial.with_mass(mass2))
        ahead = [p + float(step) * s for p, s in zip(points, slopes, strict=True)]
        moved = [q for one in ahead if (q := _match(spectra[mass2], one)) is not None]
        if len(moved) < len(ahead):
            step /= 2
            continue
        # A mode does not grow.
        pairs = [(p, q) for p, q in zip(points, moved, strict=True) if q[0].imag < 0]
        slopes = [(q - p) / float(step) for p, q in pairs]
        points, part, step = [q for _, q in pairs], part + step, 2 * step
    return [complex(w) for w, _ in points]


def _match(spectrum: np.ndarray, ahead: np.ndarray) -> np.ndarray | None:
    """The row near a prediction; None where another is less than three times as far."""
    if len(spectrum) == 0:
        return None
    distances = np.abs(spectrum - ahead).sum(axis=1)
    others = np.delete(distances, distances.argmin())
    return spectrum[distances.argmin()] if (others > 3 * distances.min()).all() else None


# -- on finer grids --------------------------------------------------------------------------------


@dataclass(eq=False)
class Candidate:
    """A rough frequency on its way to digits.

    z: see Dispersion. changes: of the frequency by each finer grid; None before the first grid.
    alive: False once the iteration has left its neighbourhood.
    """

    dispersion: Dispersion
    z: acb
    changes: list[float] | None = None
    alive: bool = True

    @property
    def frequency(self) -> acb:
        """w at z."""
        return self.dispersion.frequency(self.z)

    @property
    def error(self) -> float:
        """Twice the larger change by the last two refinements: one may be small by chance."""
        return 2 * max(self.changes[-2:]) if self.changes and len(self.changes) > 1 else math.inf

    @property
    def stalled(self) -> bool:
        """Whether the last finer grid changed it no less than the grid before."""
        last = (self.changes or [])[-2:]
        return len(last) > 1 and last[1] >= last[0]

    def settled(self, tolerance: float) -> bool:
        """Whether its relative error is within a tolerance."""
        return self.error < tolerance * _size(self.frequency)

    def refine(self, matrices: Sequence[acb_mat]) -> None:
        """Follow it to the next grid."""
        before, value = self.frequency, _newton(matrices, self.z)
        if value is None:
            self.alive = False
            return
        self.z = value
        if self.changes is None:
            # The value before was rough.
            self.changes = []
            return
        self.changes.append(_size(self.frequency - before))


def _refined(
    candidates: Sequence[Candidate], matrices: Sequence[acb_mat], modes: int, tolerance: float
) -> list[Candidate]:
    """Those damped least, refined; more than modes where one stalls or occurs twice."""
    active: list[Candidate] = []
    values: list[tuple[acb, float]] = []
    for one in candidates:
        # Rough frequencies damped almost alike have no order.
        last = active[-1].frequency if active else acb(0)
        beyond = float((last - one.frequency).imag.mid()) > SHARED * _size(last)
        if len(values) >= modes and beyond:
            break
        if not one.settled(tolerance):
            one.refine(matrices)
        if one.alive:
            active.append(one)
            if not one.stalled:
                values = _distinct([*values, (one.frequency, min(one.error, 1e-2 * tolerance))])
    return active


def _size(value: acb) -> float:
    return float(abs(value).mid())


def _distinct(values: Sequence[tuple[acb, float]]) -> list[tuple[acb, float]]:
    """Frequencies that differ, those damped least first."""
    kept: list[tuple[acb, float]] = []
    for value, error in sorted(values, key=lambda one: -float(one[0].imag.mid())):
        if all(_size(value - other) > 100 * (error + e) for other, e in kept):
            kept.append((value, error))
    return kept


def _newton(matrices: Sequence[acb_mat], start: acb) -> acb | None:
    """The eigenvalue near a start; None where the iteration leaves its neighbourhood.

    Each step squares the error, so that twice the digits are right behind the last one.
    """
    w, n = start, matrices[0].nrows()
    vector = acb_mat(n, 1, [acb(1)] * n)
    for number in range(STEPS):
        whole, slope = matrices[0], matrices[0] * acb(0)
        for k, matrix in enumerate(matrices[1:], 1):
            whole = whole + matrix * w**k
            slope = slope + matrix * (k * w ** (k - 1))
        try:
            moved = whole.solve(slope * vector, algorithm="approx")
        except ZeroDivisionError:
            return w
        peak = max(range(n), key=lambda k: _size(moved[k, 0]))
        step = (vector[peak, 0] / moved[peak, 0]).mid()
        vector = acb_mat(n, 1, [(moved[k, 0] / moved[peak, 0]).mid() for k in range(n)])
        w = (w - step).mid()
        if _size(w - start) > NEAR * _size(start):
            return None
        # The first step has no direction yet: it is small near an eigenvalue, and inaccurate.
        if number and _size(step) < 10.0 ** (-ctx.dps / 4):
            return w
    return None

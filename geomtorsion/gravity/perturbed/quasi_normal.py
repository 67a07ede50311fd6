"""Ringing: quasi-normal modes of a static black hole, from the Lagrangian to digits."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import mpmath
import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import parse_expression
from geomtorsion.geometry import Frame
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.gravity.lagrangian import Lagrangian, known_as, names
from geomtorsion.gravity.matter import Maxwell
from geomtorsion.gravity.perturbed.collocation import Hole, R, frequencies
from geomtorsion.gravity.perturbed.geometries import (
    theory_in,
)
from geomtorsion.gravity.perturbed.hole_waves import SYSTEMS, Theory, horizons, missing_number
from geomtorsion.support import checks
from geomtorsion.support.displays import Plot, drawn_by, figure_by

PARITIES = ("axial", "polar", "both")


@dataclass(frozen=True, kw_only=True)
class Mode:
    """One quasi-normal mode: waves exp(-i omega t) times a spherical harmonic.

    omega: the frequency; its imaginary part is negative, minus the rate of damping.
    error: a bound from two grids on the error of omega.
    parity: axial or polar; empty for test fields. l: of the spherical harmonic.
    """

    omega: mpmath.mpc
    error: float
    parity: str
    l: int  # noqa: E741

    @property
    def frequency(self) -> complex:
        """omega as a Python number."""
        return complex(self.omega)

    @property
    def _digits(self) -> int:
        """Digits behind the point that the error allows."""
        return max(int(-mpmath.log10(self.error or mpmath.eps)), 1)

    def to_json(self) -> dict[str, Any]:
        """The mode as plain data."""
        real, imag = (mpmath.nstr(x, self._digits) for x in (self.omega.real, self.omega.imag))
        return {"l": self.l, "parity": self.parity, "real": real, "imag": imag, "error": self.error}

    def __str__(self) -> str:
        digits = self._digits
        kind = f"{self.parity}, " * bool(self.parity)
        real = mpmath.nstr(self.omega.real, digits)
        imag = mpmath.nstr(-self.omega.imag, digits)
        return f"{kind}l = {self.l}: {real} - {imag} i +- {self.error:.0e}"


@dataclass(frozen=True, repr=False)
class Ringing:
    """How a static black hole rings: its modes, those damped least first.

    lagrangian: the theory. f: g_tt = -f, with its values.
    """

    lagrangian: Lagrangian
    f: sp.Expr
    modes: tuple[Mode, ...]

    _repr_html_ = drawn_by("ringing", "ringing_html")
    plot: ClassVar[Plot] = figure_by("ringing", "draw_ringing")

    def to_json(self) -> dict[str, Any]:
        """Modes as plain data, each part of a frequency as text with all its digits."""
        return {
            "lagrangian": str(self.lagrangian.expression),
            "f": str(self.f),
            "modes": [one.to_json() for one in self.modes],
        }

    def __str__(self) -> str:
        head = f"ringing of f = {self.f} in {self.lagrangian!r}"
        return "\n".join([head, *map(str, self.modes)])

    __repr__ = __str__


def ringing(
    lagrangian: Lagrangian | str | sp.Expr,
    frame: FrameLike,
    *,
    l: int = 2,  # noqa: E741
    parity: str = "both",
    modes: int = 1,
    digits: int = 8,
    parameters: Mapping[str, object] | None = None,
    geometry: str = "riemannian",
    matter: Maxwell | None = None,
) -> Ringing:
    """Quasi-normal modes of a static, spherical black hole of a theory.

    Equation
    --------
    First order of the field equations for waves exp(-i omega t) of one spherical harmonic, which
    fall into the hole and leave outwards, or through the outer horizon.
    [Regge, Wheeler 1957], [Zerilli 1970], [Moncrief 1974], [Leaver 1985]

    Parameters
    ----------
    lagrangian
        As in `gravity.equations`, with the values of its constants. A Lagrangian of only a
        scalar field, "-X/2", or only a Maxwell field, "-F2/4", is a test field on the frame.
    frame
        A frame or space with the metric -f dt^2 + dr^2/f + r^2 dOmega^2.
    l
        Number of the spherical harmonic.
    parity
        "axial", "polar" or "both".
    modes
        How many for each parity, those damped least.
    digits
        Digits of each frequency.
    parameters
        Numbers for the parameters of frame and Lagrangian, {"M": 1}.
    geometry
        "riemannian" or "teleparallel".
    matter
        The Maxwell field of a charged hole, `maxwell(["Q/r", 0, 0, 0])`. Gravitational and
        electromagnetic waves are then coupled, and both ring.

    Raises
    ------
    GravityError
        The frame is of another form or not a solution, or the waves need more than two
        derivatives.
    AccuracyError
        The digits are not reached.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> rings = perturbed.ringing("R", "schwarzschild", parity="axial", parameters={"M": 1})
    >>> round(rings.modes[0].frequency.real, 8), rings.modes[0].error < 1e-8
    (0.37367168, True)
    """
    known = known_as(lagrangian)
    kind = _kind(known)
    lowest = {"gravity": 2, "scalar": 0, "Maxwell": 1}[kind]
    checks.count(l, "l", GravityError, lowest, 29)
    checks.count(modes, "modes", GravityError, 1, 20)
    checks.count(digits, "digits", GravityError, 1, 30)
    checks.choice(parity, PARITIES, "parity", GravityError)
    checks.choice(geometry, ("riemannian", "teleparallel"), "geometry", GravityError)
    space = as_frame(frame, "frame", GravityError)
    values = {str(x): _number(value, str(x)) for x, value in (parameters or {}).items()}
    f = _static(space, values)
    of_frame = {x.name for x in space.parameters}
    voltage = None if matter is None else _voltage(matter, space, values, kind)
    theory = Theory(theory_in(lagrangian, geometry), geometry, values, frozenset(of_frame), voltage)
    hole = Hole(f, *horizons(f))
    parities = ("",)
    if kind == "gravity":
        parities = ("axial", "polar") if parity == "both" else (parity,)
    rings = [
        Mode(omega=_complex(w), error=error, parity=name, l=l)
        for name in parities
        for w, error in frequencies(SYSTEMS[kind, name](theory, hole, l), modes, digits)
    ]
    return Ringing(theory.lagrangian, f, tuple(rings))


# -- the hole --------------------------------------------------------------------------------------


def _kind(theory: Lagrangian) -> str:
    """gravity, or the test field of which a Lagrangian consists."""
    words = set(re.findall(r"[^\W\d]\w*", str(theory.expression)))
    invariants = {name for name in words if name in names}
    if invariants == {"F2"}:
        return "Maxwell"
    return "scalar" if "X" in words and invariants <= {"X", "phi"} else "gravity"


def _number(value: object, name: str) -> sp.Expr:
    number = checks.expression(
        value, f"parameters[{name}]", GravityError, read=lambda text: parse_expression(text, {})
    )
    if number.free_symbols:
        checks.refuse(GravityError, f"parameters[{name}]", "a number", value)
    if number.is_Float:
        return sp.Rational(*checks.repr_fraction(float(number)).as_integer_ratio())
    return number


def _static(frame: Frame, values: Mapping[str, sp.Expr]) -> sp.Expr:
    """f(r) of a frame with the metric -f dt^2 + dr^2/f + r^2 dOmega^2."""
    if frame.dimension == 4:
        _, r, theta, _ = frame.coordinates
        entries = frame.metric.components
        f = -entries.get((0, 0))
        area = frame.field.read(r**2)
        wanted = {
            (0, 0): -f,
            (1, 1): f,
            (2, 2): area,
            (3, 3): area * frame.field.read(sp.sin(theta) ** 2),
        }
        fits = entries.nonzero.keys() == wanted.keys()
        for index, value in wanted.items() if fits else ():
            entry = entries.get(index)
            same = entry * value - 1 if index == (1, 1) else entry - value
            fits = fits and same.is_zero is True
        named = {x: values[x.name] for x in frame.parameters if x.name in values}
        written = f.sympy.xreplace(named)
        if fits and not written.free_symbols & {*frame.coordinates} - {r}:
            for symbol in sorted(written.free_symbols - {r}, key=str):
                raise missing_number(symbol)
            written = sp.cancel(written.xreplace({r: R}))
            if written.is_rational_function(R):
                return written
    raise GravityError(
        "frame: expected a static hole with the metric -f(r) dt^2 + dr^2/f(r) + r^2 dtheta^2 + "
        f"r^2 sin(theta)^2 dphi^2, got {frame.name or 'another frame'}. Give its frame in these "
        "coordinates, such as schwarzschild."
    )


def _voltage(matter: object, frame: Frame, values: Mapping[str, sp.Expr], kind: str) -> sp.Expr:
    """A_t(r) of a Maxwell field (A_t, 0, 0, 0)."""
    checks.instance(matter, Maxwell, "matter", GravityError)
    assert isinstance(matter, Maxwell)
    if kind != "gravity":
        raise GravityError(
            "matter: expected no field of the hole for a test field, got a Maxwell field. Omit it, "
            "or give the Lagrangian of gravity and the field, such as R - F2."
        )
    matter.check(frame)
    first, *others = matter.elements(frame)
    r = frame.coordinates[1]
    written = first.sympy.xreplace(
        {x: values[x.name] for x in frame.parameters if x.name in values}
    )
    for symbol in sorted(written.free_symbols & {*frame.parameters}, key=str):
        raise missing_number(symbol)
    written = sp.cancel(written.xreplace({r: R}))
    radial = written.is_rational_function(R) and not written.free_symbols - {R}
    if not radial or any(not x.is_zero for x in others):
        raise GravityError(
            "matter: expected a potential A_t(r), 0, 0, 0 of an electric charge, got "
            f"{checks.cut(', '.join(map(str, matter.potential)))}. Give maxwell(['Q/r', 0, 0, 0])."
        )
    return written


def _complex(w: object) -> mpmath.mpc:
    with mpmath.workdps(50):
        return mpmath.mpc(w.real.mid().str(45, radius=False), w.imag.mid().str(45, radius=False))  # type: ignore[attr-defined]

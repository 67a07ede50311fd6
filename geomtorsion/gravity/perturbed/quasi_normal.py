"""Ringing: quasi-normal modes of a static black hole, from the Lagrangian to digits."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import mpmath
import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import names as words
from geomtorsion.exact import parse_expression
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.gravity.perturbed.collocation import Hole, R
from geomtorsion.gravity.perturbed.frequencies import frequencies
from geomtorsion.gravity.perturbed.geometries import geometry_of, theory_in
from geomtorsion.gravity.perturbed.hole_waves import SYSTEMS, Theory
from geomtorsion.gravity.perturbed.static_holes import chart_of, fields_of
from geomtorsion.gravity.theory.lagrangian import Lagrangian, known_as, names
from geomtorsion.gravity.theory.matter import MatterField
from geomtorsion.support import checks
from geomtorsion.support.csv_table import write_csv
from geomtorsion.support.displays import Plot, drawn_by, figure_by

PARITIES = ("axial", "polar", "both")
# The name of the scalar of f(R) in the equations.
SCALARON = "scalaron"


@dataclass(frozen=True, kw_only=True)
class Mode:
    """One quasi-normal mode: waves exp(-i omega t) times a spherical harmonic.

    omega: the frequency; its imaginary part is negative, minus the rate of damping.
    error: a bound from two grids on the error of omega.
    parity: axial or polar; empty for test fields. l: of the spherical harmonic.
    field: gravity, with the light of a charged hole; scalar or Maxwell.
    """

    omega: mpmath.mpc
    error: float
    parity: str
    l: int  # noqa: E741
    field: str = "gravity"

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
        names = {"l": self.l, "parity": self.parity, "field": self.field}
        return {**names, "real": real, "imag": imag, "error": self.error}

    def _repr_latex_(self) -> str:
        """The frequency, for notebooks."""
        return f"${self._latex}$"

    @property
    def _latex(self) -> str:
        real, imag = (mpmath.nstr(abs(x), self._digits) for x in (self.omega.real, self.omega.imag))
        mantissa, exponent = f"{self.error:.0e}".split("e")
        kind = ", ".join(x for x in (self.field, self.parity, f"l = {self.l}") if x)
        return (
            rf"\omega = {real} - {imag}\, i \pm {mantissa} \times 10^{{{int(exponent)}}} "
            rf"\quad (\text{{{kind}}})"
        )

    def __str__(self) -> str:
        digits = self._digits
        kind = f"{self.field} field, " * (self.field != "gravity")
        kind += f"{self.parity}, " * bool(self.parity)
        real = mpmath.nstr(self.omega.real, digits)
        imag = mpmath.nstr(-self.omega.imag, digits)
        return f"{kind}l = {self.l}: {real} - {imag} i +- {self.error:.0e}"


@dataclass(frozen=True, repr=False)
class Ringing:
    """Quasi-normal modes of a static black hole, the least damped ones first.

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

    def to_csv(self, path: str | Path) -> None:
        """Write the modes as a table of doubles; `to_json` has all digits."""
        rows = [one.to_json() for one in self.modes]
        table = {name: [row[name] for row in rows] for name in ("l", "parity", "field", "error")}
        for name in ("real", "imag"):
            table[name] = [float(row[name]) for row in rows]
        write_csv(checks.file_name(path), table)

    def _repr_latex_(self) -> str:
        """The frequencies, for notebooks."""
        lines = r" \\ ".join(one._latex for one in self.modes)
        return rf"$$\begin{{gathered}} {lines} \end{{gathered}}$$"

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
    geometry: str | None = None,
    matter: MatterField | Iterable[MatterField] | None = None,
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
        f(R) has a scalar with the mass m^2 = f'/(3 f'') - R/3 of its own [Whitt 1984].
    frame
        A frame or space with the metric -f dt^2 + dr^2/f + r^2 dOmega^2, also with another time,
        another rational radius or Cartesian coordinates. Test fields may have another g_rr.
    l
        Number of the spherical harmonic: from 2 for waves of the tetrad, 1 for light, 0 for
        scalars.
    parity
        "axial", "polar" or "both".
    modes
        Number of modes for each field and parity, the least damped ones. Modes of a massive field
        are followed from m = 0: a mode whose damping falls to 0 on the way exists no longer, and
        the next overtone becomes the first [Ohashi, Sakagami 2004]. A missing mode raises an error.
    digits
        Digits of each frequency.
    parameters
        Numbers for the parameters of frame and Lagrangian, {"M": 1}.
    geometry
        "riemannian" or "teleparallel"; by default teleparallel for T, riemannian for others.
    matter
        Fields of the hole: electric or magnetic, `maxwell(["Q/r", 0, 0, 0])` or
        `maxwell([0, 0, 0, "-P*cos(theta)"])`, whose waves are coupled with gravity, and a
        constant scalar field, `scalar_field(1)`.

    Raises
    ------
    GravityError
        The frame is of another form or not a solution, the waves need more than two derivatives,
        or a scalar does not decouple.
    AccuracyError
        The digits are not reached, or a less damped mode is missing or did not converge.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> rings = perturbed.ringing("R", "schwarzschild", parity="axial", parameters={"M": 1})
    >>> round(rings.modes[0].frequency.real, 8), rings.modes[0].error < 1e-8
    (0.37367168, True)
    """
    known = known_as(lagrangian)
    kind = _kind(known)
    checks.count(modes, "modes", GravityError, 1, 20)
    checks.count(digits, "digits", GravityError, 1, 30)
    checks.choice(parity, PARITIES, "parity", GravityError)
    geometry = geometry_of(known, geometry, (), ("riemannian", "teleparallel"))
    space = as_frame(frame, "frame", GravityError)
    values = {str(x): _number(value, str(x)) for x, value in (parameters or {}).items()}
    chart = chart_of(space, values)
    background = fields_of(_matter(matter, kind), chart, values)
    hole = chart.hole()
    if kind == "gravity" and (hole.stretch, hole.area_radius) != (1, R):
        raise GravityError(
            "frame: expected g_tt g_rr = -1 in the radius of the spheres for waves of the tetrad, "
            f"got f = {hole.f} with another g_rr. Test fields such as '-X/2' ring on it."
        )
    of_frame = frozenset(x.name for x in space.parameters)
    theory = Theory(theory_in(lagrangian, geometry), geometry, values, of_frame, background)
    rings = [
        Mode(omega=_complex(w), error=error, parity=name, l=l, field=field)
        for theory_of_wave, field, name in _waves(theory, hole, kind, parity, l)
        for w, error in frequencies(SYSTEMS[field, name](theory_of_wave, hole, l), modes, digits)
    ]
    return Ringing(theory.lagrangian, hole.f, tuple(rings))


# -- the theory ----------------------------------------------------------------------------------


def _kind(theory: Lagrangian) -> str:
    """gravity, or the test field of which a Lagrangian consists."""
    written = set(re.findall(r"[^\W\d]\w*", str(theory.expression)))
    invariants = {name for name in written if name in names}
    if invariants == {"F2"}:
        return "Maxwell"
    return "scalar" if "X" in written and invariants <= {"X", "phi"} else "gravity"


def _matter(
    matter: MatterField | Iterable[MatterField] | None, kind: str
) -> tuple[MatterField, ...]:
    """The fields of the hole; none for a test field."""
    if matter is None:
        return ()
    fields = (
        (matter,)
        if isinstance(matter, MatterField)
        else checks.entries(matter, "matter", GravityError)
    )
    for one in fields:
        checks.instance(one, MatterField, "matter", GravityError)
    if kind != "gravity" and fields:
        raise GravityError(
            "matter: expected no field of the hole for a test field, got a Maxwell field. Omit it, "
            "or give the Lagrangian of gravity and the field, such as R - F2."
        )
    return tuple(fields)


def _waves(
    theory: Theory,
    hole: Hole,
    kind: str,
    parity: str,
    l: int,  # noqa: E741
) -> list[tuple[Theory, str, str]]:
    """Theory, field and parity of each kind of wave."""
    if kind != "gravity":
        checks.count(l, "l", GravityError, {"scalar": 0, "Maxwell": 1}[kind], 29)
        return [(theory, kind, "")]
    waves, tetrad = [], 1 if theory.background.charged else 2
    scalar = theory if parity == "axial" else _with_scalar(theory, hole)
    own = parity != "axial" and scalar.background.scalar is not None
    checks.count(l, "l", GravityError, 0 if own else tetrad, 29)
    if l == 1 and theory.background.charged and (parity != "axial" or theory.magnetic):
        raise GravityError(
            "l: expected at least 2, or the axial light of an electric hole with l = 1, got "
            f"{parity} waves with l = 1. The same frequencies come from parity='axial' and the "
            "potential of an electric charge, maxwell(['Q/r', 0, 0, 0])."
        )
    if l >= tetrad:
        waves += [(theory, "gravity", "axial")] * (parity != "polar")
        waves += [(scalar, "gravity", "polar")] * (parity != "axial")
    return waves + [(scalar, "scalar", "polar")] * own


def _written(lagrangian: str | sp.Expr) -> sp.Expr:
    """A Lagrangian as an expression; all its names are symbols."""
    if not isinstance(lagrangian, str):
        return lagrangian
    own = set(re.findall(r"\b[^\W\d]\w*\b(?!\s*\()", lagrangian)) - {*words.CONSTANTS}
    return parse_expression(lagrangian, {x: sp.Symbol(x) for x in own}, where="lagrangian")


def _number(value: object, name: str) -> sp.Expr:
    number = checks.expression(
        value, f"parameters[{name}]", GravityError, read=lambda text: parse_expression(text, {})
    )
    if number.free_symbols:
        checks.refuse(GravityError, f"parameters[{name}]", "a number", value)
    if number.is_Float:
        return sp.Rational(*checks.repr_fraction(float(number)).as_integer_ratio())
    return number


def _with_scalar(theory: Theory, hole: Hole) -> Theory:
    """A theory f(R) with its scalar chi: L = f(chi) + f'(chi) (R - chi), chi = R on the hole.

    Other theories, and theories that are linear in R to the second order, are returned as they
    are. [Whitt 1984]
    """
    whole, f, r = _written(theory.lagrangian.expression), hole.f, R
    curvature, chi = sp.Symbol("R"), sp.Symbol(SCALARON)
    bend = whole.diff(curvature, 2)
    if theory.geometry != "riemannian" or bend == 0:
        return theory
    constant = sp.cancel(2 / r**2 - (r**2 * f).diff(r, 2) / r**2)
    if constant.has(r) or theory.background.scalar is not None:
        raise GravityError(
            "ringing: expected a constant R on the hole and no other scalar field for polar waves "
            f"of {theory.lagrangian!r}, got R = {checks.cut(str(constant))}. Use parity='axial'."
        )
    named = {x: theory.values[x.name] for x in bend.free_symbols if x.name in theory.values}
    there = bend.xreplace(named).subs(curvature, constant)
    if there.has(sp.zoo, sp.oo, sp.nan):
        raise GravityError(
            f"ringing: expected a Lagrangian with two derivatives by R at R = {constant}, got "
            f"{theory.lagrangian!r}. Give another theory, or a hole with another R."
        )
    if sp.simplify(there) == 0:
        return theory
    at_chi = {curvature: chi}
    slope = whole.diff(curvature).xreplace(at_chi)
    linear = whole.xreplace(at_chi) + slope * (curvature - chi)
    return replace(
        theory,
        lagrangian=replace(theory.lagrangian, expression=linear),
        background=replace(theory.background, scalar=(SCALARON, constant)),
    )


def _complex(w: object) -> mpmath.mpc:
    with mpmath.workdps(50):
        return mpmath.mpc(w.real.mid().str(45, radius=False), w.imag.mid().str(45, radius=False))  # type: ignore[attr-defined]

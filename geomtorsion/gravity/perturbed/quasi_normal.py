"""Ringing: quasi-normal modes of a static black hole, from the Lagrangian to digits."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import mpmath
import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, Truncated, linear_parts, parse_expression
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.gravity.equations import FieldEquations, equations
from geomtorsion.gravity.lagrangian import Lagrangian, known_as, names
from geomtorsion.gravity.matter import MatterField, Maxwell, maxwell, scalar_field
from geomtorsion.gravity.perturbed.collocation import Hole, R, Radial, Row, frequencies
from geomtorsion.gravity.perturbed.geometries import (
    ETA,
    GEOMETRIES,
    SMALL,
    check_couplings,
    theory_in,
)
from geomtorsion.support import checks
from geomtorsion.support.displays import Plot, drawn_by, figure_by

T, THETA, PHI = sp.symbols("t theta azimuth")
# A direction at which the angular factors are rational and, for l below 30, not zero.
DIRECTION = {sp.sin(THETA): sp.Rational(4, 5), sp.cos(THETA): sp.Rational(3, 5)}
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
        electromagnetic waves are then coupled, and the modes are those of both.

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
    theory = _Theory(
        theory_in(lagrangian, geometry), geometry, values, frozenset(of_frame), voltage
    )
    hole = Hole(f, *_horizons(f))
    parities = ("",)
    if kind == "gravity":
        parities = ("axial", "polar") if parity == "both" else (parity,)
    rings = [
        Mode(omega=_complex(w), error=error, parity=name, l=l)
        for name in parities
        for w, error in frequencies(_SYSTEMS[kind, name](theory, hole, l), modes, digits)
    ]
    return Ringing(theory.lagrangian, f, tuple(rings))


@dataclass(frozen=True)
class _Theory:
    """A theory with numbers for its constants.

    values: numbers by name; of_frame: names among them that belong to the frame.
    voltage: A_t(r) of the hole; None without a Maxwell field.
    """

    lagrangian: Lagrangian
    geometry: str
    values: Mapping[str, sp.Expr]
    of_frame: frozenset[str]
    voltage: sp.Expr | None = None

    def charged(self, *small: sp.Expr) -> list[MatterField]:
        """The Maxwell field of the hole with a small wave A_mu, where it has one."""
        if self.voltage is None:
            return []
        wave = [SMALL * x for x in small]
        return [maxwell([self.voltage + wave[0], *wave[1:]])]

    def equations(self, frame: Frame, matter: Sequence[MatterField] = ()) -> FieldEquations:
        """Its equations on a frame; its constants stay symbols."""
        own = [name for name in self.values if name not in self.of_frame]
        connection = GEOMETRIES[self.geometry].connection(frame)
        system = equations(connection, self.lagrangian, matter, constants=own)
        check_couplings(system, [SMALL])
        for name in own:
            checks.known_name(name, [*self.of_frame, *system.constants], "parameter", GravityError)
        return system

    def at(self, element: Element) -> sp.Expr:
        """An element with the numbers, at a direction where angular factors are rational.

        Raises
        ------
        GravityError
            A constant has no number.
        """
        expression = element.sympy.subs(DIRECTION)
        named = {x: self.values[x.name] for x in expression.free_symbols if x.name in self.values}
        value = sp.cancel(sp.together(expression.xreplace(named)))
        for symbol in sorted(value.free_symbols - {R}, key=str):
            raise _missing_number(symbol)
        return value


def _missing_number(symbol: sp.Basic) -> GravityError:
    return GravityError(
        f"ringing: expected numbers for all parameters, got none for {symbol}. Give "
        f"parameters={{'{symbol}': 1}}."
    )


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
                raise _missing_number(symbol)
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
        raise _missing_number(symbol)
    written = sp.cancel(written.xreplace({r: R}))
    radial = written.is_rational_function(R) and not written.free_symbols - {R}
    if not radial or any(not x.is_zero for x in others):
        raise GravityError(
            "matter: expected a potential A_t(r), 0, 0, 0 of an electric charge, got "
            f"{checks.cut(', '.join(map(str, matter.potential)))}. Give maxwell(['Q/r', 0, 0, 0])."
        )
    return written


def _horizons(f: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """The outermost horizon that encloses the hole, and the one around its outside, or oo."""
    top = sp.Poly(sp.numer(sp.together(f)), R)
    if top.degree() and not top.is_sqf:
        raise GravityError(
            f"ringing: expected simple zeros of f at the horizons, got f = {f} with a double zero. "
            "Waves at an extremal horizon need another method; change the parameters."
        )
    roots = top.nroots(n=200, maxsteps=500) if top.degree() else []
    real = [x for x in roots if abs(sp.im(x)) < sp.Float(10) ** -60 and sp.re(x) > 0]
    real = sorted(sp.re(x) for x in real)
    limit = sp.limit(f, R, sp.oo)
    if limit == 1 and real:
        return real[-1], sp.oo
    if limit == -sp.oo and len(real) > 1:
        return real[-2], real[-1]
    raise GravityError(
        "ringing: expected a horizon at a positive r, and outside of it flat space or a horizon of "
        f"de Sitter, got f = {f}. Change the parameters."
    )


def _complex(w: object) -> mpmath.mpc:
    with mpmath.workdps(50):
        return mpmath.mpc(w.real.mid().str(45, radius=False), w.imag.mid().str(45, radius=False))  # type: ignore[attr-defined]


# -- radial equations ------------------------------------------------------------------------------


def _functions(*names: str) -> list[sp.Expr]:
    return [sp.Function(name)(T, R) for name in names]


def _frame(f: sp.Expr, rows: sp.Matrix) -> Frame:
    """A frame outside of the hole, expanded in the wave."""
    inner, outer = (
        x if x == sp.oo else sp.Rational(*checks.repr_fraction(float(x)).as_integer_ratio())
        for x in _horizons(f)
    )
    domain = [inner < R, THETA > 0, sp.pi > THETA, *([outer > R] if outer != sp.oo else [])]
    frame = Frame((T, R, THETA, PHI), rows, signature=ETA, parameters=[SMALL], domain=domain)
    return frame.expanded(SMALL, 1)


def _radial(theory: _Theory, element: Element, fields: Sequence[sp.Expr]) -> Row:
    """An equation as coefficients of each field, without its common angular factor."""
    assert isinstance(element, Truncated)
    parts = linear_parts(element.parts[1], fields)
    row: list[dict[tuple[int, int], sp.Expr]] = [{} for _ in fields]
    for (function, orders), x in parts.items():
        if (value := theory.at(x)) != 0:
            row[fields.index(function)][orders[0], orders[1]] = value
    if any(order > 2 for one in row for _, order in one):
        raise GravityError(
            "ringing: expected waves with two derivatives at most, got more. Waves of another "
            "parity, or test fields on this frame, may still be found."
        )
    return row


def _rows(
    theory: _Theory, frame: Frame, matter: Sequence[MatterField]
) -> tuple[Tensor, Tensor | None]:
    """E_ij and Maxwell's equation of a solution."""
    system = theory.equations(frame, matter)
    lower = system.E.lowered(1)
    current = system.matter_equations["A"] if matter else None
    for name, tensor in (("E_", lower), ("J_", current)):
        background = {} if tensor is None else tensor.order(0).components.nonzero
        for index, x in sorted(background.items()):
            if (value := theory.at(x)) != 0:
                raise GravityError(
                    "ringing: expected a frame that solves the equations, got "
                    f"{name}{''.join(map(str, index))} = {checks.cut(str(value))}. Give another "
                    "frame, other constants, or the field of the hole, "
                    "matter=maxwell(['Q/r', 0, 0, 0])."
                )
    return lower, current


def _sum(tensor: Tensor, i: int, j: int) -> Element:
    """E_ij + E_ji, or E_ii."""
    one = tensor.element(i, j)
    return one if i == j else one + tensor.element(j, i)


def _axial(theory: _Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
    """Waves that drag the sphere around: two fields in the last leg, and A_phi."""
    f, (h0, h1, a) = hole.f, _functions("H0", "H1", "a")
    slope = sp.legendre(l, sp.cos(THETA)).diff(THETA)
    rows = sp.diag(sp.sqrt(f), 1 / sp.sqrt(f), R, R * sp.sin(THETA))
    rows[3, 0], rows[3, 1] = SMALL * h0 * slope / R, SMALL * h1 * slope / R
    light = theory.charged(sp.S.Zero, sp.S.Zero, sp.S.Zero, a * sp.sin(THETA) * slope)
    tensor, current = _rows(theory, _frame(f, rows), light)
    elements = [_sum(tensor, *index) for index in ((2, 3), (1, 3))]
    fields, scales = [h0, h1], [R, R / f]
    if current is not None:
        elements.append(current.element(3))
        fields, scales = [*fields, a], [*scales, sp.S.One]
    return Radial(hole, [_radial(theory, x, fields) for x in elements], scales)


def _polar(theory: _Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
    """Waves that stretch the sphere: after the gauge and H2 = H0, three fields, A_t and A_r."""
    f, (h0, h1, h2, k) = hole.f, _functions("H0", "H1", "H2", "K")
    a0, a1 = _functions("a0", "a1")
    shape = sp.legendre(l, sp.cos(THETA))
    half = SMALL * shape / 2
    rows = sp.diag(
        sp.sqrt(f) * (1 - half * h0),
        (1 + half * h2) / sp.sqrt(f),
        R * (1 + half * k),
        R * sp.sin(THETA) * (1 + half * k),
    )
    rows[1, 0] = SMALL * shape * h1 * sp.sqrt(f)
    light = theory.charged(a0 * shape, a1 * shape, sp.S.Zero, sp.S.Zero)
    tensor, current = _rows(theory, _frame(f, rows), light)
    fields, scales = [h0, h1, h2, k], [R / f, R / f, sp.S.One]
    if current is not None:
        fields, scales = [*fields, a0, a1], [*scales, sp.S.One, 1 / f]
    stress = _radial(theory, tensor.element(2, 2) - tensor.element(3, 3), fields)
    one, two = stress[0], stress[2]
    others = stress[1] or any(stress[3:]) or one.keys() != {(0, 0)}
    if others or sp.cancel(one[0, 0] + two[0, 0]) != 0:
        raise GravityError(
            "ringing: expected polar waves of the tetrad only, got a field of its own, such as the "
            "scalar of R + c*R**2. Use parity='axial'."
        )
    elements = [_sum(tensor, *index) for index in ((0, 1), (0, 2), (1, 2), (1, 1))]
    if current is not None:
        elements[2:2] = [current.element(2), current.element(1)]
    parts = [_radial(theory, x, fields) for x in elements]
    system = [[_added(row[0], row[2]), row[1], *row[3:]] for row in parts]
    return Radial(hole, _first_order(system), scales)


def _added(one: Mapping, two: Mapping) -> dict[tuple[int, int], sp.Expr]:
    """Coefficients of two fields that are equal."""
    total = dict(one)
    for orders, x in two.items():
        total[orders] = sp.cancel(total.get(orders, sp.S.Zero) + x)
    return {orders: x for orders, x in total.items() if x != 0}


def _first_order(system: Sequence[Sequence[Mapping]]) -> list[Row]:
    """Equations with derivatives by r, and the algebraic one that follows from all.

    All but the last give the slopes of the fields. The last but one then follows from the others.
    """
    w, n = sp.Symbol("w"), len(system) - 1
    slopes, values = sp.symbols(f"s0:{n}"), sp.symbols(f"v0:{n}")

    def line(row: Sequence[Mapping]) -> sp.Expr:
        return sp.Add(
            *(
                c * (-sp.I * w) ** a * (slopes[k] if b else values[k])
                for k, one in enumerate(row)
                for (a, b), c in one.items()
            )
        )

    lines = [line(row) for row in system]
    (solved,) = sp.linsolve(lines[:n], slopes)
    rest = sp.numer(sp.together(lines[n].subs(dict(zip(slopes, solved, strict=True)))))
    poly = sp.Poly(sp.expand(rest), w, *values)
    algebraic: list[dict[tuple[int, int], sp.Expr]] = [{} for _ in values]
    for (power, *which), c in poly.terms():
        algebraic[which.index(1)][power, 0] = c * sp.I**power
    return [*system[: n - 1], algebraic]


def _scalar(theory: _Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
    """A scalar test field."""
    (u,) = _functions("u")
    f = hole.f
    frame = _frame(f, sp.diag(sp.sqrt(f), 1 / sp.sqrt(f), R, R * sp.sin(THETA)))
    small = scalar_field(SMALL * u * sp.legendre(l, sp.cos(THETA)))
    system = theory.equations(frame, [small])
    row = _radial(theory, system.matter_equations["phi"].element(), [u])
    # Far away waves move as exp(i w r); with a mass they do not.
    far = sp.limit(row[0].get((0, 0), sp.S.Zero) / row[0].get((0, 2), sp.S.One), R, sp.oo)
    if hole.outer == sp.oo and far != 0:
        raise GravityError(
            f"ringing: expected a massless field in space that is flat far away, got m^2 = {-far}. "
            "Omit the mass, or choose a hole in de Sitter space."
        )
    return Radial(hole, [row], [1 / R])


def _maxwell(theory: _Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
    """A Maxwell test field, whose parities ring alike: A_phi."""
    (a,) = _functions("a")
    f = hole.f
    frame = _frame(f, sp.diag(sp.sqrt(f), 1 / sp.sqrt(f), R, R * sp.sin(THETA)))
    slope = sp.sin(THETA) * sp.legendre(l, sp.cos(THETA)).diff(THETA)
    small = maxwell([0, 0, 0, SMALL * a * slope])
    system = theory.equations(frame, [small])
    row = _radial(theory, system.matter_equations["A"].element(3), [a])
    return Radial(hole, [row], [sp.S.One])


_SYSTEMS = {
    ("gravity", "axial"): _axial,
    ("gravity", "polar"): _polar,
    ("scalar", ""): _scalar,
    ("Maxwell", ""): _maxwell,
}

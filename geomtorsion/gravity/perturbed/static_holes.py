"""Static holes: the metric of a spherical frame in any chart, its horizons and its fields."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.geometry import Frame
from geomtorsion.gravity.perturbed.collocation import Hole, R
from geomtorsion.gravity.theory.matter import MatterField, Maxwell, ScalarField
from geomtorsion.support import checks

# The radial coordinate of a chart.
RHO = sp.Symbol("rho", positive=True)
FORM = "-f(r) dt^2 + dr^2/f(r) + r^2 dtheta^2 + r^2 sin(theta)^2 dphi^2"


def missing_number(symbol: sp.Basic) -> GravityError:
    """The error for a parameter without a number."""
    return GravityError(
        f"ringing: expected numbers for all parameters, got none for {symbol}. Give "
        f"parameters={{'{symbol}': 1}}."
    )


@dataclass(frozen=True)
class Chart:
    """A chart of a static, spherical frame: -A dt^2 + 2 B dt drho + C drho^2 + S dOmega^2.

    time, mixed2, radial, area: A, B^2, C and S, functions of rho without other symbols.
    cartesian: whether the coordinates are t, x, y, z, with rho^2 = x^2 + y^2 + z^2.
    """

    frame: Frame
    time: sp.Expr
    mixed2: sp.Expr
    radial: sp.Expr
    area: sp.Expr
    cartesian: bool = False

    def hole(self) -> Hole:
        """The hole in the radius of its spheres where g_tt g_rr = -1, or in its own radius.

        The time is shifted by a function of the radius where the chart mixes both.
        """
        block = sp.cancel(self.mixed2 + self.time * self.radial)
        if sp.cancel(4 * self.area * block - self.area.diff(RHO) ** 2) == 0:
            f = self.by_radius(self.time)
            return Hole(f, *horizons(f))
        stretch = _root(block)
        if stretch is None:
            raise self.refused()
        f, stretch, area = (
            sp.cancel(x.xreplace({RHO: R})) for x in (self.time, stretch, self.area)
        )
        return Hole(f, *horizons(f), stretch, sp.sqrt(area))

    def by_radius(self, expression: sp.Expr) -> sp.Expr:
        """A function of rho as a rational function of the radius r of the spheres, r^2 = S."""
        if self.area == RHO**2:
            return sp.cancel(expression.xreplace({RHO: R}))
        if not expression.has(RHO):
            return expression
        radius, value = _root(self.area), sp.Symbol("value")
        if radius is None:
            raise self.refused()
        lines = (sp.numer(sp.together(x)) for x in (R - radius, value - expression))
        relation = sp.resultant(*lines, RHO)
        for factor, _ in sp.factor_list(relation)[1]:
            if sp.degree(factor, value) == 1:
                (found,) = sp.solve(factor, value)
                if sp.cancel(found.xreplace({R: radius}) - expression) == 0:
                    return sp.cancel(found)
        raise self.refused()

    def refused(self) -> GravityError:
        """The error for a chart whose radius has no rational form."""
        return refused(self.frame)


def refused(frame: Frame) -> GravityError:
    """The error for a frame of another form."""
    return GravityError(
        f"frame: expected a static hole with the metric {FORM}, got {frame.name or 'another'} "
        "frame. Give its frame in these coordinates, such as schwarzschild; charts with another "
        "time or another rational radius are read."
    )


def _root(square: sp.Expr) -> sp.Expr | None:
    """A rational square root, if there is one."""
    if not square.is_rational_function(RHO):
        return None
    root = sp.S.One
    for poly, sign in zip(sp.fraction(sp.together(square)), (1, -1), strict=True):
        constant, factors = sp.factor_list(poly, RHO)
        root *= sp.sqrt(constant) ** sign
        for factor, power in factors:
            if power % 2:
                return None
            root *= factor ** (sign * power // 2)
    return sp.cancel(root)


def chart_of(frame: Frame, values: Mapping[str, sp.Expr]) -> Chart:
    """The chart of a static, spherical frame in spherical or Cartesian coordinates.

    Raises
    ------
    GravityError
        The frame is of another form, or a parameter has no number.
    """
    if frame.dimension == 4:
        named = {x: values[x.name] for x in frame.parameters if x.name in values}
        written = {
            (index[0], index[1]): sp.cancel(x.sympy.xreplace(named))
            for index, x in frame.metric.components.nonzero.items()
            if index[0] <= index[1]
        }
        entries = {index: x for index, x in written.items() if x != 0}
        for form in (_spherical, _cartesian):
            functions = form(frame, entries)
            if functions is None:
                continue
            for symbol in sorted(
                set().union(*(x.free_symbols for x in functions)) - {RHO}, key=str
            ):
                raise missing_number(symbol)
            functions = [sp.cancel(sp.together(x)) for x in functions]
            if all(x.is_rational_function(RHO) for x in functions):
                return Chart(frame, *functions, cartesian=form is _cartesian)
    raise refused(frame)


Entries = Mapping[tuple[int, int], sp.Expr]


def _spherical(frame: Frame, entries: Entries) -> list[sp.Expr] | None:
    """A, B^2, C, S of a metric in the coordinates t, rho, theta or cos(theta), phi."""
    _, r, theta, _ = frame.coordinates
    block = [
        -entries.get((0, 0), sp.S.Zero),
        *(entries.get(x, sp.S.Zero) for x in ((0, 1), (1, 1))),
    ]
    if entries.keys() - {(0, 0), (0, 1), (1, 1), (2, 2), (3, 3)} or (2, 2) not in entries:
        return None
    for along, around in (
        (sp.S.One, sp.sin(theta) ** 2),
        (1 / (1 - theta**2), 1 - theta**2),
    ):
        area = sp.cancel(entries[2, 2] / along)
        functions = [*block, area]
        fits = all(not x.free_symbols & {*frame.coordinates} - {r} for x in functions)
        if fits and _is_zero(frame, entries.get((3, 3), sp.S.Zero) - area * around):
            a, b, c, s = (x.xreplace({r: RHO}) for x in functions)
            return [a, b**2, c, s]
    return None


def _cartesian(frame: Frame, entries: Entries) -> list[sp.Expr] | None:
    """A, B^2, C, S of a metric in the coordinates t, x, y, z, rho^2 = x^2 + y^2 + z^2.

    A spherical metric is g_ti = B x_i/rho, g_ij = C x_i x_j/rho^2 + W (delta_ij - x_i x_j/rho^2).
    """
    t, *places = frame.coordinates
    ray = dict(zip(places, (RHO, sp.S.Zero, sp.S.Zero), strict=True))

    indices = ((0, 0), (0, 1), (1, 1), (2, 2))
    a, b, c, w = (entries.get(index, sp.S.Zero).subs(ray) for index in indices)
    a = -a
    if any(x.has(t, sp.zoo, sp.nan) for x in (a, b, c, w)):
        return None
    rho = sp.sqrt(sp.Add(*(x**2 for x in places)))
    back = {RHO: rho}
    n = [x / rho for x in places]
    for i in range(4):
        for j in range(i, 4):
            if i == 0:
                wanted = -a if j == 0 else b * n[j - 1]
            else:
                both = n[i - 1] * n[j - 1]
                wanted = c * both + w * (int(i == j) - both)
            if not _is_zero(frame, entries.get((i, j), sp.S.Zero) - wanted.xreplace(back)):
                return None
    return [a, b**2, c, w * RHO**2]


def _is_zero(frame: Frame, expression: sp.Expr) -> bool:
    return frame.field.read(expression).is_zero is True


# -- fields of the hole ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Fields:
    """Fields of a hole besides its metric.

    voltage: A_t(r) of an electric charge; None without a Maxwell field. magnetic: the magnetic
    charge P of A_phi = -P cos(theta). scalar: name and constant value of a scalar field.
    """

    voltage: sp.Expr | None = None
    magnetic: sp.Expr = sp.S.Zero
    scalar: tuple[str | None, sp.Expr] | None = None

    @property
    def charged(self) -> bool:
        """Whether there is a Maxwell field."""
        return self.voltage is not None


def fields_of(matter: Iterable[MatterField], chart: Chart, values: Mapping[str, sp.Expr]) -> Fields:
    """Fields of a hole from matter on its frame.

    Raises
    ------
    GravityError
        A field depends on other coordinates, or there are two of one kind.
    """
    voltage, magnetic, scalar = None, sp.S.Zero, None
    for one in matter:
        if isinstance(one, Maxwell) and voltage is None:
            voltage, magnetic = _charges(one, chart, values)
        elif isinstance(one, ScalarField) and scalar is None:
            one.check(chart.frame)
            value = _numbers(one.elements(chart.frame)[0].sympy, chart, values)
            if value.free_symbols:
                raise GravityError(
                    "matter: expected a constant scalar field on the hole, got "
                    f"{checks.cut(str(one.phi))}. Give scalar_field(1), or a test field."
                )
            scalar = one.name, value
        else:
            raise GravityError(
                "matter: expected at most one Maxwell field and one scalar field, got "
                f"{checks.cut(repr(one))}. Omit the others."
            )
    return Fields(voltage, magnetic, scalar)


def _numbers(expression: sp.Expr, chart: Chart, values: Mapping[str, sp.Expr]) -> sp.Expr:
    """An expression on the frame with numbers for its parameters."""
    own = chart.frame.parameters
    written = expression.xreplace({x: values[x.name] for x in own if x.name in values})
    for symbol in sorted(written.free_symbols & {*own}, key=str):
        raise missing_number(symbol)
    return written


def _charges(
    matter: Maxwell, chart: Chart, values: Mapping[str, sp.Expr]
) -> tuple[sp.Expr, sp.Expr]:
    """A_t(r), and P of A_phi = -P cos(theta)."""
    matter.check(chart.frame)
    _, r, theta, _ = coordinates = chart.frame.coordinates
    potential = [_numbers(x.sympy, chart, values) for x in matter.elements(chart.frame)]
    electric, radial, polar, around = potential
    polar_cosine = around.subs(theta, sp.acos(theta)) if around.has(sp.cos(theta)) else around
    magnetic = -sp.cancel(polar_cosine.diff(theta))
    fits = not magnetic.free_symbols and sp.cancel(polar) == 0
    fits = fits and not (electric.free_symbols | radial.free_symbols) & {*coordinates} - {r}
    if chart.cartesian:
        fits = sp.cancel(radial) == 0 and sp.cancel(around) == 0 and sp.cancel(polar) == 0
        electric = electric.subs(dict(zip(coordinates[1:], (RHO, 0, 0), strict=True)))
    electric = sp.cancel(electric.xreplace({r: RHO}))
    if not fits or electric.free_symbols - {RHO} or not electric.is_rational_function(RHO):
        raise GravityError(
            "matter: expected the potential of an electric charge, A_t(r), or of a magnetic one, "
            f"A_phi = -P cos(theta), got {checks.cut(', '.join(map(str, matter.potential)))}. Give "
            "maxwell(['Q/r', 0, 0, 0]) or maxwell([0, 0, 0, '-P*cos(theta)'])."
        )
    if magnetic != 0 and electric.has(RHO):
        raise GravityError(
            "matter: expected an electric or a magnetic charge, got both. For L linear in F2 "
            "give one electric charge, the root of the sum of both squares: it has the same modes."
        )
    return chart.by_radius(electric), magnetic


# -- horizons --------------------------------------------------------------------------------------


def horizons(f: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
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

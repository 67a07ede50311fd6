"""Hole waves: radial equations of a wave on a static hole, from the Lagrangian."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, Truncated, linear_parts
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.gravity.equations import FieldEquations, equations
from geomtorsion.gravity.lagrangian import Lagrangian
from geomtorsion.gravity.matter import MatterField, maxwell, scalar_field
from geomtorsion.gravity.perturbed.collocation import Hole, R, Radial, Row
from geomtorsion.gravity.perturbed.geometries import ETA, GEOMETRIES, SMALL, check_couplings
from geomtorsion.support import checks

T, THETA, PHI = sp.symbols("t theta azimuth")
# A direction at which the angular factors are rational and, for l below 30, not zero.
DIRECTION = {sp.sin(THETA): sp.Rational(4, 5), sp.cos(THETA): sp.Rational(3, 5)}


@dataclass(frozen=True)
class Theory:
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
            raise missing_number(symbol)
        return value


def missing_number(symbol: sp.Basic) -> GravityError:
    """The error for a parameter without a number."""
    return GravityError(
        f"ringing: expected numbers for all parameters, got none for {symbol}. Give "
        f"parameters={{'{symbol}': 1}}."
    )


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


# -- radial equations ------------------------------------------------------------------------------


def _functions(*names: str) -> list[sp.Expr]:
    return [sp.Function(name)(T, R) for name in names]


def _frame(f: sp.Expr, rows: sp.Matrix) -> Frame:
    """A frame outside of the hole, expanded in the wave."""
    inner, outer = (
        x if x == sp.oo else sp.Rational(*checks.repr_fraction(float(x)).as_integer_ratio())
        for x in horizons(f)
    )
    domain = [inner < R, THETA > 0, sp.pi > THETA, *([outer > R] if outer != sp.oo else [])]
    frame = Frame((T, R, THETA, PHI), rows, signature=ETA, parameters=[SMALL], domain=domain)
    return frame.expanded(SMALL, 1)


def _radial(theory: Theory, element: Element, fields: Sequence[sp.Expr]) -> Row:
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
    theory: Theory, frame: Frame, matter: Sequence[MatterField]
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


def _axial(theory: Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
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


def _polar(theory: Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
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


def _scalar(theory: Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
    """A scalar test field."""
    (u,) = _functions("u")
    f = hole.f
    frame = _frame(f, sp.diag(sp.sqrt(f), 1 / sp.sqrt(f), R, R * sp.sin(THETA)))
    small = scalar_field(SMALL * u * sp.legendre(l, sp.cos(THETA)))
    system = theory.equations(frame, [small])
    row = _radial(theory, system.matter_equations["phi"].element(), [u])
    return Radial(hole, [row], [1 / R], _mass2(hole, row[0]))


def _mass2(hole: Hole, wave: Mapping[tuple[int, int], sp.Expr]) -> sp.Expr:
    """m^2 of a field far away, from the coefficients of its equation."""
    if hole.outer != sp.oo:
        return sp.S.Zero
    mass2 = -sp.limit(wave.get((0, 0), sp.S.Zero) / wave.get((0, 2), sp.S.One), R, sp.oo)
    if mass2.is_finite and mass2 >= 0:
        return mass2
    raise GravityError(
        f"ringing: expected a field with m^2 >= 0 far away, got m^2 = {mass2}. Such a field grows "
        "by itself, and the hole is unstable; change the signs of its terms."
    )


def _maxwell(theory: Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
    """A Maxwell test field, whose parities ring alike: A_phi."""
    (a,) = _functions("a")
    f = hole.f
    frame = _frame(f, sp.diag(sp.sqrt(f), 1 / sp.sqrt(f), R, R * sp.sin(THETA)))
    slope = sp.sin(THETA) * sp.legendre(l, sp.cos(THETA)).diff(THETA)
    small = maxwell([0, 0, 0, SMALL * a * slope])
    system = theory.equations(frame, [small])
    row = _radial(theory, system.matter_equations["A"].element(3), [a])
    return Radial(hole, [row], [sp.S.One])


SYSTEMS = {
    ("gravity", "axial"): _axial,
    ("gravity", "polar"): _polar,
    ("scalar", ""): _scalar,
    ("Maxwell", ""): _maxwell,
}

"""Hole waves: radial equations of a wave on a static hole, from the Lagrangian."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, Truncated, linear_parts
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.gravity.perturbed.collocation import Hole, R, Radial, Row
from geomtorsion.gravity.perturbed.geometries import ETA, GEOMETRIES, SMALL, check_couplings
from geomtorsion.gravity.perturbed.static_holes import Fields, missing_number
from geomtorsion.gravity.theory.field_equations import FieldEquations, equations
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.gravity.theory.matter import MatterField, maxwell, scalar_field
from geomtorsion.support import checks

T, THETA, PHI = sp.symbols("t theta azimuth")
# A direction at which the angular factors are rational and, for l below 30, not zero.
DIRECTION = {sp.sin(THETA): sp.Rational(4, 5), sp.cos(THETA): sp.Rational(3, 5)}


@dataclass(frozen=True)
class Theory:
    """A theory with numbers for its constants.

    values: numbers by name; of_frame: names among them that belong to the frame.
    background: fields of the hole.
    """

    lagrangian: Lagrangian
    geometry: str
    values: Mapping[str, sp.Expr]
    of_frame: frozenset[str]
    background: Fields

    @property
    def magnetic(self) -> bool:
        """Whether the hole has a magnetic charge."""
        return self.background.magnetic != 0

    def matter(self, light: Sequence[sp.Expr] = (0, 0, 0, 0), u: sp.Expr = sp.S.Zero) -> list:
        """The fields of the hole with small waves A_mu and u."""
        own, fields = self.background, list[MatterField]()
        if own.voltage is not None:
            a = [SMALL * x for x in light]
            around = a[3] - own.magnetic * sp.cos(THETA)
            fields.append(maxwell([own.voltage + a[0], a[1], a[2], around]))
        if own.scalar is not None:
            name, value = own.scalar
            fields.append(scalar_field(value + SMALL * u, name))
        return fields

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
        if expression.has(THETA):
            # Legendre's polynomials from l = 10 contain multiples of the angle.
            expression = sp.expand_trig(element.sympy).subs(DIRECTION)
        named = {x: self.values[x.name] for x in expression.free_symbols if x.name in self.values}
        value = sp.cancel(sp.together(expression.xreplace(named)))
        for symbol in sorted(value.free_symbols - {R}, key=str):
            raise missing_number(symbol)
        return value


# -- radial equations ------------------------------------------------------------------------------


def _functions(*names: str) -> list[sp.Expr]:
    return [sp.Function(name)(T, R) for name in names]


def _frame(hole: Hole, rows: sp.Matrix) -> Frame:
    """A frame outside of the hole, expanded in the wave."""
    inner, outer = (
        x if x == sp.oo else sp.Rational(*checks.repr_fraction(float(x)).as_integer_ratio())
        for x in (hole.inner, hole.outer)
    )
    domain = [inner < R, THETA > 0, sp.pi > THETA, *([outer > R] if outer != sp.oo else [])]
    frame = Frame((T, R, THETA, PHI), rows, signature=ETA, parameters=[SMALL], domain=domain)
    return frame.expanded(SMALL, 1)


def _at_rest(hole: Hole) -> sp.Matrix:
    """Rows of the coframe without a wave."""
    f, radius = hole.f, hole.area_radius
    return sp.diag(sp.sqrt(f), hole.stretch / sp.sqrt(f), radius, radius * sp.sin(THETA))


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


def _rows(theory: Theory, frame: Frame, matter: Sequence[MatterField]) -> dict[str, Tensor]:
    """E_ij of a solution under the name E, and equations of its matter by their fields."""
    system = theory.equations(frame, matter)
    rows = {"E": system.E.lowered(1), **system.matter_equations}
    for name, tensor in rows.items():
        for index, x in sorted(tensor.order(0).components.nonzero.items()):
            if (value := theory.at(x)) != 0:
                letter = {"E": "E_", "A": "J_"}.get(name, f"equation of {name}")
                raise GravityError(
                    "ringing: expected a frame that solves the equations, got "
                    f"{letter}{''.join(map(str, index))} = {checks.cut(str(value))}. Give another "
                    "frame, other constants, or the field of the hole, "
                    "matter=maxwell(['Q/r', 0, 0, 0])."
                )
    return rows


def _sum(tensor: Tensor, i: int, j: int) -> Element:
    """E_ij + E_ji, or E_ii."""
    one = tensor.element(i, j)
    return one if i == j else one + tensor.element(j, i)


def _axial(theory: Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
    """Waves that drag the sphere around: two fields in the last leg, and light.

    Light is A_phi, or A_t and A_r on a magnetic hole. For l = 1 only the first field remains.
    """
    f, (h0, h1, a, a0, a1) = hole.f, _functions("H0", "H1", "a", "a0", "a1")
    shape = sp.legendre(l, sp.cos(THETA))
    slope = shape.diff(THETA)
    rows = _at_rest(hole)
    rows[3, 0], rows[3, 1] = SMALL * h0 * slope / R, SMALL * h1 * slope / R * int(l > 1)
    if theory.magnetic:
        wave = [a0 * shape, a1 * shape, 0, 0]
    else:
        wave = [0, 0, 0, a * sp.sin(THETA) * slope]
    tensors = _rows(theory, _frame(hole, rows), theory.matter(wave))
    drag = [((1, 3), h0, R), ((2, 3), h1, R / f)][: 1 + (l > 1)]
    elements = [_sum(tensors["E"], *index) for index, *_ in drag]
    fields, scales = [x for _, x, _ in drag], [x for *_, x in drag]
    if theory.background.charged:
        light = [(2, a0, sp.S.One), (1, a1, 1 / f)] if theory.magnetic else [(3, a, sp.S.One)]
        elements += [tensors["A"].element(k) for k, *_ in light]
        fields, scales = fields + [x for _, x, _ in light], scales + [x for *_, x in light]
    system = [_radial(theory, x, fields) for x in elements]
    _check_waves(theory, system)
    return Radial(hole, system, scales)


def _check_waves(theory: Theory, rows: Sequence[Row]) -> None:
    """Refuse equations of the first order that vanish."""
    if not all(any(row) for row in rows):
        raise GravityError(
            "ringing: expected field equations with waves of the tetrad, got 0 = 0 at the first "
            f"order for {theory.lagrangian!r}. Add a term of gravity such as R."
        )


def _polar(theory: Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
    """Waves that stretch the sphere: after the gauge and H2 = H0, three fields, and light.

    Light is A_t and A_r, or A_phi and its slope on a magnetic hole.
    """
    f, (h0, h1, h2, k) = hole.f, _functions("H0", "H1", "H2", "K")
    a, a0, a1 = _functions("a", "a0", "a1")
    shape = sp.legendre(l, sp.cos(THETA))
    half = SMALL * shape / 2
    rows = _at_rest(hole) * sp.diag(1 - half * h0, 1 + half * h2, 1 + half * k, 1 + half * k)
    rows[1, 0] = SMALL * shape * h1 * sp.sqrt(f)
    if theory.magnetic:
        wave = [0, 0, 0, a * sp.sin(THETA) * shape.diff(THETA)]
    else:
        wave = [a0 * shape, a1 * shape, 0, 0]
    tensors = _rows(theory, _frame(hole, rows), theory.matter(wave))
    tensor = tensors["E"]
    fields, scales = [h0, h1, h2, k], [R / f, R / f, sp.S.One]
    if theory.background.charged:
        fields += [a] if theory.magnetic else [a0, a1]
        scales += [sp.S.One, 1 / f]
    stress = _radial(theory, tensor.element(2, 2) - tensor.element(3, 3), fields)
    _check_waves(theory, [stress])
    one, two = stress[0], stress[2]
    others = stress[1] or any(stress[3:]) or one.keys() != {(0, 0)}
    if others or sp.cancel(one[0, 0] + two[0, 0]) != 0:
        raise GravityError(
            "ringing: expected polar waves of the tetrad and at most one scalar that decouples, "
            "such as the scalar of R + c*R**2, got another field of the theory. Use "
            "parity='axial'."
        )
    elements = [_sum(tensor, *index) for index in ((0, 1), (0, 2), (1, 2), (1, 1))]
    if theory.background.charged:
        elements[2:2] = [tensors["A"].element(i) for i in ((3,) if theory.magnetic else (2, 1))]
    parts = [_radial(theory, x, fields) for x in elements]
    system = [[_added(row[0], row[2]), row[1], *row[3:]] for row in parts]
    if theory.magnetic:
        system = _with_slope(system)
    return Radial(hole, _first_order(system), scales)


def _with_slope(system: Sequence[Sequence[Mapping]]) -> list[Row]:
    """Equations with the slope of the last field as one more field."""
    rows: list[Row] = []
    for *others, last in system:
        value = {key: x for key, x in last.items() if key[1] == 0}
        slope = {(i, j - 1): x for (i, j), x in last.items() if j > 0}
        rows.append([*others, value, slope])
    definition: list[Mapping] = [{} for _ in rows[0]]
    definition[-2:] = {(0, 1): sp.S.One}, {(0, 0): sp.S.NegativeOne}
    rows.insert(2, definition)
    return rows


def _decoupled(theory: Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
    """The scalar of a theory of gravity, where it is constant on the hole.

    The wave (1 + epsilon k) g with phi + epsilon u, k = alpha u, solves all E_ij exactly. The
    action of the first order is symmetric, so that all other waves leave the scalar unchanged.
    """
    k, u = fields = _functions("k", "u")
    shape = sp.legendre(l, sp.cos(THETA))
    rows = _at_rest(hole) * (1 + SMALL * shape * k / 2)
    tensors = _rows(theory, _frame(hole, rows), theory.matter(u=u * shape))
    lower, name = tensors["E"], next(x for x in tensors if x not in ("E", "A"))
    pairs = [(i, j) for i in range(4) for j in range(i, 4)]
    stress = [_radial(theory, _sum(lower, *pair), fields) for pair in pairs]
    both = ((one[key], two[key]) for one, two in stress for key in one.keys() & two.keys())
    alpha = next((-sp.cancel(y / x) for x, y in both), sp.S.Zero)
    rest = [x for one, two in stress for x in _added(_times(one, alpha), two).values()]
    wave = _radial(theory, tensors[name].element(), fields)
    row = _added(_times(wave[0], alpha), wave[1])
    if alpha.has(R) or rest:
        raise GravityError(
            "ringing: expected a scalar that decouples from the tetrad, got terms of both in "
            "their equations. Use parity='axial', or another background."
        )
    if (0, 2) not in row:
        raise GravityError(
            f"ringing: expected a scalar with a wave, got none for {theory.lagrangian!r}. Add a "
            "kinetic term such as -X/2."
        )
    return Radial(hole, [[row]], [1 / R], _mass2(hole, row))


def _times(one: Mapping, factor: sp.Expr) -> dict[tuple[int, int], sp.Expr]:
    return {orders: factor * x for orders, x in one.items()}


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
    frame = _frame(hole, _at_rest(hole))
    small = scalar_field(SMALL * u * sp.legendre(l, sp.cos(THETA)))
    system = theory.equations(frame, [small])
    row = _radial(theory, system.matter_equations["phi"].element(), [u])
    return Radial(hole, [row], [1 / R], _mass2(hole, row[0]))


def _mass2(hole: Hole, wave: Mapping[tuple[int, int], sp.Expr]) -> sp.Expr:
    """m^2 of a field far away, from the coefficients of its equation."""
    if hole.outer != sp.oo:
        return sp.S.Zero
    mass2 = sp.limit(wave.get((0, 0), sp.S.Zero) / wave.get((2, 0), sp.S.One), R, sp.oo)
    if mass2.is_finite and mass2 >= 0:
        return mass2
    raise GravityError(
        f"ringing: expected a field with m^2 >= 0 far away, got m^2 = {mass2}. Such a field grows "
        "by itself, and the hole is unstable; change the signs of its terms."
    )


def _maxwell(theory: Theory, hole: Hole, l: int) -> Radial:  # noqa: E741
    """A Maxwell test field, whose parities have equal modes: A_phi."""
    (a,) = _functions("a")
    frame = _frame(hole, _at_rest(hole))
    slope = sp.sin(THETA) * sp.legendre(l, sp.cos(THETA)).diff(THETA)
    small = maxwell([0, 0, 0, SMALL * a * slope])
    system = theory.equations(frame, [small])
    row = _radial(theory, system.matter_equations["A"].element(3), [a])
    return Radial(hole, [row], [sp.S.One])


SYSTEMS = {
    ("gravity", "axial"): _axial,
    ("gravity", "polar"): _polar,
    ("scalar", "polar"): _decoupled,
    ("scalar", ""): _scalar,
    ("Maxwell", ""): _maxwell,
}

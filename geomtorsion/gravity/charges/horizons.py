"""Horizons: radius, area, surface gravity, temperature and entropy, exactly or as numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp
from flint import arb

from geomtorsion.codegen import balls, graph
from geomtorsion.errors import GravityError
from geomtorsion.exact import Element
from geomtorsion.geometry import levi_civita
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.gravity.charges.algebraic import Root, centre, real_roots
from geomtorsion.gravity.charges.enclosed_roots import EnclosedRoot, enclosed_roots
from geomtorsion.gravity.charges.horizon import Horizon
from geomtorsion.gravity.charges.spheres import Sphere, number, reduced, region_remarks, sphere
from geomtorsion.gravity.theory.field_equations import equations
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.support import checks
from geomtorsion.support.precision import CONSTANT_BITS, ball_precision

# Two directions with rational sine and cosine, at which the surface gravity must agree.
DIRECTIONS = ((4, 3, 5), (5, 12, 13))
# The parameters that are eliminated first.
MASSES = ("M", "m", "mu", "mass")


def horizons(
    frame: FrameLike,
    lagrangian: Lagrangian | str = "R",
    *,
    parameters: Mapping[Any, Any] | None = None,
    surface: Mapping[Any, Any] | str | None = None,
    over: Mapping[Any, Any] | None = None,
) -> tuple[Horizon, ...]:
    """Horizons of a stationary frame, with temperature and entropy.

    Equation
    --------
    S = -(1/8) integral dL/dR_abcd eps_ab eps_cd [Wald1993]: A/4 for L = R
    T = kappa/(2 pi), d(xi^2) = -2 kappa xi for the Killing vector xi of the horizon

    Parameters
    ----------
    frame
        A frame, a space or its name, in coordinates in which g^rr vanishes at the horizon, or the
        lapse.
    lagrangian
        L(R), "R + c*R**2", "R + alpha*GB", as in `gravity.equations`.
    parameters
        Numbers for all parameters of frame and Lagrangian: the result then has one horizon for
        each positive root, sorted. For functions that are not algebraic the result has all roots
        between 2^-45 and 2^45, which is proved. Without numbers it has one horizon with one
        parameter expressed by the radius.
    surface, over
        As in `charge`.

    Returns
    -------
    Tuple of Horizon.

    Raises
    ------
    GravityError
        There is no horizon, no parameter can be expressed by its radius, or its surface gravity
        varies.

    Examples
    --------
    >>> from geomtorsion import gravity
    >>> (hole,) = gravity.horizons("kerr")
    >>> hole.entropy, hole.relation
    (pi*(a**2 + r**2), {M: (a**2 + r**2)/(2*r)})
    >>> hole.angular_velocity
    a/(a**2 + r**2)
    """
    own = as_frame(frame, "frame", GravityError)
    one = sphere(own, surface, over, None, 1)
    if one.values:
        checks.refuse(GravityError, "surface", "the names of time and radius", surface)
    system = equations(levi_civita(own), lagrangian)
    symbols = {x.name: x for x in own.parameters}
    symbols |= {name: sp.Symbol(name) for name in system.constants if name not in symbols}
    values = _values(parameters, symbols)
    hole = _Hole(one, system.Z.raised(3).components.get)
    text = str(system.lagrangian.expression)
    if values or not symbols:
        inside = {x: values[x] for x in own.parameters}
        is_centre = hole.condition.xreplace(inside) == one.symbol
        relation = {} if is_centre or not inside else hole.relation()
        if inside and not is_centre and not relation:
            # No parameter is a formula in the radius: the frame takes its numbers.
            one = sphere(own.subs(inside), surface, over, None, 1)
            system = equations(levi_civita(one.frame), system.lagrangian)
            hole = _Hole(one, system.Z.raised(3).components.get)
        return hole.numbers(values, relation, text)
    if hole.condition == one.symbol:
        return (hole.at_centre(text),)
    relation = hole.relation()
    if not relation:
        raise GravityError(
            f"parameters: expected numbers, because the radius of the horizon, a root of "
            f"{checks.cut(str(hole.condition))}, determines no parameter, got none. Give "
            f"parameters={{'{next(iter(symbols))}': 1}}."
        )
    return (hole.formulas(relation, text),)


def _values(
    parameters: Mapping[Any, Any] | None, symbols: Mapping[str, sp.Symbol]
) -> dict[sp.Symbol, sp.Expr]:
    """Numbers for all parameters, or for none."""
    given = checks.known_keys(parameters or {}, symbols, "parameters", GravityError)
    values = {symbols[name]: number(x, f"parameters[{name}]") for name, x in given.items()}
    for symbol, value in values.items():
        checks.check_declared(symbol, value)
    if values and len(values) < len(symbols):
        missing = next(name for name in symbols if symbols[name] not in values)
        raise GravityError(
            f"parameters: expected numbers for all of {', '.join(symbols)}, got none for "
            f"{missing}. Give all, or none for formulas."
        )
    return values


@dataclass(frozen=True)
class _Hole:
    """A family of surfaces around a hole.

    momentum: dL/dR_abcd, slots UUUU. root: the radius, where no parameter is expressed by it.
    """

    sphere: Sphere
    momentum: Any
    root: Root | EnclosedRoot | None = None

    @property
    def condition(self) -> sp.Expr:
        """Factors of g^rr that vanish at the horizon, without angles; or factors of the lapse.

        Only the lapse vanishes where the radius is a distance, as in Rindler's coordinates.
        """
        one = self.sphere
        around = {q for q, _, _ in one.ranges}
        inverse = one.frame.inverse_metric.components.get
        t, r, q = one.time, one.radius, one.symbol
        wholes = [self._factors(x) for x in (inverse((r, r)), inverse((t, t)).inverse())]
        for whole in wholes:
            own = [x for x in whole if x != q]
            if own and not any(x.free_symbols & around for x in own):
                return sp.Mul(*own)
        # The radius is a factor of many metrics at their centre: it counts only without others.
        if [q] in wholes:
            return q
        above = sp.fraction(sp.together(inverse((r, r)).sympy))[0]
        raise GravityError(
            f"frame: expected a factor of g^{2 * str(q)} or of the lapse that vanishes at a "
            f"horizon, got {checks.cut(str(above))}. Use coordinates such as the ones of Boyer and "
            "Lindquist; a space without horizon has no temperature."
        )

    def _factors(self, element: Element) -> list[sp.Expr]:
        """Factors of a numerator that contain the radius."""
        above = sp.fraction(sp.together(element.sympy))[0]
        parts = [part for part, _ in sp.factor_list(above)[1]]
        return [x for x in parts if self.sphere.symbol in x.free_symbols]

    def relation(self) -> dict[sp.Symbol, sp.Expr]:
        """The first parameter that the radius of the horizon determines; empty if there is none."""
        one, condition = self.sphere, self.condition
        own = one.frame.parameters
        order = sorted(own, key=lambda x: (x.name not in MASSES, own.index(x)))
        for symbol in order:
            if symbol not in condition.free_symbols:
                continue
            # Formulas in a positive radius and positive parameters.
            positive = _positive(self.sphere, condition.free_symbols - {symbol})
            roots = _solved(condition.xreplace(positive), symbol)
            if one.frame.region.sign(symbol) == 1:
                roots = [x for x in roots if x.is_negative is not True]
            if len(roots) == 1:
                back = {dummy: x for x, dummy in positive.items()}
                return {symbol: sp.factor(roots[0].xreplace(back))}
        if condition.xreplace(_positive(one, condition.free_symbols)).is_nonzero:
            raise GravityError(
                f"frame: expected a horizon, got {checks.cut(str(condition))}, which has no root. "
                "A space without horizon has no temperature."
            )
        return {}

    def formulas(self, put: Mapping[sp.Symbol, sp.Expr], text: str) -> Horizon:
        """All quantities in terms of the radius."""
        one = self.sphere
        frame = one.frame
        t, r = one.time, one.radius
        inverse = frame.inverse_metric.components.get
        gtt, grr, gtr = inverse((t, t)), inverse((r, r)), inverse((t, r))
        velocity, turning = self._turning(put)
        kappa = self._surface_gravity(put, velocity, turning)
        normal = (gtr * gtr - gtt * grr).inverse()
        weight = self._at(normal * self._contracted(), put)
        others = [k for k in range(frame.dimension) if k not in (t, r)]
        metric = [
            [self._at(frame.metric.components.get((i, j)), put) for j in others] for i in others
        ]
        density = self._root(sp.factor(sp.Matrix(metric).det()))
        (area, open_area), (entropy, open_entropy) = (
            reduced(one, x) for x in (density, density * weight / 8)
        )
        if open_area or open_entropy:
            raise GravityError(
                "frame: expected a horizon whose area has a closed form, got none. Use another "
                "coordinate."
            )
        area, entropy = self._tidy(area), self._tidy(entropy)
        return Horizon(
            radius=one.symbol, relation=dict(put), area=area, angular_velocity=velocity,
            surface_gravity=kappa, temperature=sp.factor(kappa / (2 * sp.pi)), entropy=entropy,
            error=0.0, lagrangian=text, assumed=self._assumed,
        )  # fmt: skip

    @property
    def _assumed(self) -> tuple[str, ...]:
        """Assumptions about the surface, the region of the frame and the root, in words."""
        return (*self.sphere.assumed, *region_remarks(self.sphere.frame))

    def _roots(self, condition: sp.Expr) -> Sequence[Root | EnclosedRoot]:
        """Positive radii at which a condition holds; others if there is none and the region has."""
        one, r = self.sphere, self.sphere.symbol
        if condition == r:
            return [centre(r)]
        positive = real_roots(condition, r, positive=True)
        if positive is None:
            return enclosed_roots(condition, r)
        if positive or one.frame.region.sign(r) == 1:
            return positive
        return real_roots(condition, r, positive=False) or []

    def at_centre(self, text: str) -> Horizon:
        """All quantities at radius zero, as in Rindler's coordinates."""
        r = self.sphere.symbol
        one = replace(self, root=centre(r)).formulas({}, text)
        values = {name: getattr(one, name).subs(r, 0) for name in one.quantities}
        return replace(one, **values)

    def _turning(self, put: Mapping[sp.Symbol, sp.Expr]) -> tuple[sp.Expr, int | None]:
        """Angular velocity, and the coordinate of the angle; None for a hole that does not turn."""
        one, get = self.sphere, self.sphere.frame.metric.components.get
        for k in range(one.frame.dimension):
            if k in (one.time, one.radius) or get((one.time, k)).is_zero:
                continue
            ratio = get((one.time, k)) * get((k, k)).inverse() * -1
            return self._constant(self._at(ratio, put), "angular velocity"), k
        return sp.S.Zero, None

    def _surface_gravity(
        self, put: Mapping[sp.Symbol, sp.Expr], velocity: sp.Expr, turning: int | None
    ) -> sp.Expr:
        """kappa from the lapse; from d(xi^2) where coordinates are regular at the horizon."""
        one = self.sphere
        t, r, q = one.time, one.radius, one.symbol
        inverse, metric = (x.components.get for x in (one.frame.inverse_metric, one.frame.metric))
        if inverse((t, r)).is_zero:
            others = [k for k in range(one.frame.dimension) if k != t]
            is_static = all(metric((t, k)).is_zero for k in others)
            square = metric((t, t)) if is_static else inverse((t, t)).inverse()
            square = square * -one.signature
            if not self._vanishes(self._tidy(self._at(inverse((r, r)), put)), {}):
                size = inverse((r, r)) * square.diff(q) ** 2 * square.inverse() * one.signature
                size = self._root(self._at(size, put)) / 2
                return self._constant(size, "surface gravity")
            if not self._vanishes(self._tidy(sp.simplify(self._at(square, put))), {}):
                raise GravityError(
                    f"frame: expected a horizon, got a throat: g^{2 * str(q)} vanishes where the "
                    "lapse does not. It has no temperature."
                )
            ratio = self._root(self._at(inverse((r, r)) * inverse((t, t)) * -1, put))
            slope = self._at(square.diff(q), put) / 2
            return self._constant(slope * ratio, "surface gravity")
        slope, normal = (
            sum(
                (factor * self._at(change(metric(place)), put) for factor, place in terms),
                sp.S.Zero,
            )
            for change, terms in (
                (lambda x: x.diff(q), self._squared(velocity, turning)),
                (lambda x: x, [(1, (t, r)), *([(velocity, (turning, r))] if turning else [])]),
            )
        )
        size = self._root(sp.factor(normal**2))
        return self._constant(-slope * one.signature / (2 * size), "surface gravity")

    def _squared(
        self, velocity: sp.Expr, turning: int | None
    ) -> list[tuple[sp.Expr, tuple[int, int]]]:
        """Terms of the square of d_t + velocity d_phi: factors of components of the metric."""
        t = self.sphere.time
        terms: list[Any] = [(sp.S.One, (t, t))]
        if turning is not None:
            terms += [(2 * velocity, (t, turning)), (velocity**2, (turning, turning))]
        return terms

    def _tidy(self, expression: sp.Expr) -> sp.Expr:
        """An expression with factors, and without roots of squares."""
        positive = _positive(self.sphere, expression.free_symbols)
        back = {dummy: x for x, dummy in positive.items()}
        deep = sp.powdenest(sp.factor(expression.xreplace(positive), deep=True))
        return sp.factor(deep).xreplace(back)

    def _contracted(self) -> Element:
        """dL/dR_abcd eps_ab eps_cd over the square of eps_tr."""
        one = self.sphere
        legs, n = one.frame.legs.components.get, range(one.frame.dimension)
        t, r = one.time, one.radius
        pairs = {
            (i, j): legs((t, i)) * legs((r, j)) - legs((r, i)) * legs((t, j)) for i in n for j in n
        }
        pairs = {x: value for x, value in pairs.items() if not value.is_zero}
        return one.frame.field.sum(
            [(1, x, y, self.momentum((*a, *b))) for a, x in pairs.items() for b, y in pairs.items()]
        )

    def _at(self, element: Element, put: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
        """An element at the horizon, with the parameter that the radius determines.

        Raises
        ------
        GravityError
            Its denominator vanishes at the horizon.
        """
        expression = element.sympy
        positive = _positive(self.sphere, expression.free_symbols | set(put))
        for q, _, _ in self.sphere.ranges:
            positive |= {f(q): sp.Dummy(f.__name__) for f in (sp.sin, sp.cos)}
        back = {dummy: x for x, dummy in positive.items()}
        values = {x: value.xreplace(positive) for x, value in put.items()}
        parts = sp.fraction(sp.together(expression))
        variable = next(iter(put), self.sphere.symbol)
        while True:
            above, below = (
                self._reduced(x.xreplace(values).xreplace(positive), back) for x in parts
            )
            if not (above.is_rational_function() and below.is_rational_function()):
                above, below = (sp.simplify(sp.expand(part)) for part in (above, below))
            if not self._vanishes(below, back):
                return sp.factor(above / below).xreplace(back)
            if self._vanishes(above, back) and variable in parts[1].free_symbols:
                # Roots leave common factors: the rule of L'Hopital.
                parts = tuple(part.diff(variable) for part in parts)
                continue
            raise GravityError(
                "frame: expected quantities without poles at the horizon, got "
                f"{checks.cut(str(expression))}. Use coordinates that are regular there, or a "
                "metric without roots."
            )

    def _vanishes(self, expression: sp.Expr, back: Mapping[sp.Dummy, sp.Basic]) -> bool:
        """Whether an expression is zero at the horizon."""
        if self.root is None:
            return sp.factor(expression) == 0
        angles = [x for x, value in back.items() if isinstance(value, sp.sin | sp.cos)]
        angles = [x for x in angles if expression.has(x)]
        parts = sp.Poly(expression, *angles).coeffs() if angles else [expression]
        return all(self.root.vanishes(x.xreplace(back)) for x in parts)

    def _reduced(self, part: sp.Expr, back: Mapping[sp.Dummy, sp.Basic]) -> sp.Expr:
        """A quotient of polynomials without even powers of a cosine, reduced at the root."""
        sines = {x.args[0]: dummy for dummy, x in back.items() if isinstance(x, sp.sin)}
        for c, x in back.items():
            if isinstance(x, sp.cos) and part.has(c) and part.is_rational_function(c):
                above, below = sp.fraction(sp.together(part))
                square = c**2 + sines[x.args[0]] ** 2 - 1
                part = sp.rem(above, square, c) / sp.rem(below, square, c)
        if self.root is None:
            return part
        # Multiples of what vanishes at the root are zero.
        parts = [x.xreplace(back) for x in sp.fraction(sp.together(part))]
        try:
            above, below = (self.root.remainder(x) for x in parts)
        except sp.PolynomialError:
            return part
        if below == 0:
            return part
        return (above / below).xreplace({x: dummy for dummy, x in back.items()})

    def _root(self, expression: sp.Expr) -> sp.Expr:
        """The root of an expression, even powers taken out with the sign of the region."""
        one = self.sphere
        positive = _positive(self.sphere, expression.free_symbols)
        for q, low, high in self.sphere.ranges:
            if (low, high) == (0, sp.pi):
                positive[sp.sin(q)] = sp.Dummy("s", positive=True)
        back = {dummy: x for x, dummy in positive.items()}
        outside, inside = sp.S.One, sp.S.One
        above, below = sp.fraction(sp.together(expression).xreplace(positive))
        for whole, sign in ((above, 1), (below, -1)):
            factor, parts = sp.factor_list(whole)
            inside *= factor**sign
            for part, power in parts:
                own = one.frame.region.sign(part.xreplace(back)) if power > 1 else 1
                if own is None:
                    inside *= part ** (sign * power)
                    continue
                outside *= (own * part) ** (sign * (power // 2))
                inside *= part ** (sign * (power % 2))
        return (outside * sp.sqrt(inside)).xreplace(back)

    def _constant(self, expression: sp.Expr, name: str) -> sp.Expr:
        """What does not depend on the direction."""
        found = [self._tidy(expression.subs(self._direction(x))) for x in DIRECTIONS]
        if not self._vanishes(self._tidy(sp.simplify(found[0] - found[1])), {}):
            raise GravityError(
                f"frame: expected a horizon with one {name}, got one that depends on the "
                "direction. The horizon is not where the coordinates put it."
            )
        return self._tidy(sp.simplify(found[0]))

    def _direction(self, triple: tuple[int, int, int]) -> dict[sp.Expr, sp.Expr]:
        s, c, one = triple
        put: dict[sp.Expr, sp.Expr] = {}
        for q, _, _ in self.sphere.ranges:
            put |= {sp.sin(q): sp.Rational(s, one), sp.cos(q): sp.Rational(c, one)}
        return put

    def numbers(
        self,
        values: Mapping[sp.Symbol, sp.Expr],
        relation: Mapping[sp.Symbol, sp.Expr],
        text: str,
    ) -> tuple[Horizon, ...]:
        """One horizon for each real root of g^rr that the formulas have."""
        own = {x: values[x] for x in self.sphere.frame.parameters}
        condition = self.condition.xreplace(own)
        ((symbol, value),) = relation.items() or ((None, condition),)
        if symbol is not None:
            condition = value.xreplace(own) - own[symbol]
        roots = self._roots(condition)
        if not roots:
            raise GravityError(
                f"parameters: expected a horizon, got none: {checks.cut(str(condition))} has no "
                "root in the region of the frame. Give other numbers."
            )
        names = {x: number for x, number in values.items() if x != symbol}
        formula = self.formulas(relation, text) if relation else None
        found = []
        for root in roots:
            one = formula or replace(self, root=root).formulas({}, text)
            exprs = [getattr(one, x).xreplace(names) for x in one.quantities]
            found.append(_evaluated(one, root, exprs))
        return tuple(found)


def _solved(condition: sp.Expr, symbol: sp.Symbol) -> list[sp.Expr]:
    """Solutions for a parameter; none where sympy has no method."""
    try:
        return sp.solve(condition, symbol, dict=False)
    except NotImplementedError:
        return []


def _positive(one: Sphere, symbols: set[sp.Basic]) -> dict[sp.Basic, sp.Dummy]:
    """Positive twins of the radius and of parameters that are positive in the region."""
    region, around = one.frame.region, {q for q, _, _ in one.ranges}
    chosen = sorted((x for x in symbols if x not in around), key=str)
    known = set(one.frame.field.symbols)
    return {
        x: sp.Dummy(str(x), positive=True) for x in chosen if x in known and region.sign(x) == 1
    }


def _evaluated(formula: Horizon, root: Root | EnclosedRoot, exprs: list[sp.Expr]) -> Horizon:
    """The formulas at a root, in balls."""
    code = balls.BallCode(graph([root.symbol.name], exprs, factor=False))
    with ball_precision(CONSTANT_BITS):
        found = code.real([root.ball])
        if not all(x.is_finite() for x in found):
            raise GravityError(
                f"parameters: expected a regular horizon, got {root.symbol} = "
                f"{float(root.value):.6g} without finite values."
            )
        values = [float(x.mid()) for x in found]
        errors = [
            float((abs(x - arb(value)) / abs(arb(value))).upper()) if value else 0.0
            for x, value in zip(found, values, strict=True)
        ]
    named = dict(zip(formula.quantities, values, strict=True))
    named["surface_gravity"] = abs(named["surface_gravity"])
    named["temperature"] = abs(named["temperature"])
    assumed = (*formula.assumed, *root.assumed)
    return replace(formula, relation={}, error=max(errors), assumed=assumed, **named)

"""Spheres: closed surfaces where time and one coordinate are constant, and integrals over them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from flint import acb, arb
from sympy.integrals.rationaltools import ratint_ratpart

from geomtorsion.codegen import balls, graph
from geomtorsion.errors import AccuracyError, GravityError
from geomtorsion.exact import Element, parse_expression
from geomtorsion.geometry import Frame
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import CONSTANT_BITS, ball_precision

# Names of coordinates that are taken for angles around an axis where nothing bounds them.
AROUND = ("phi", "varphi", "azimuth")


def region_remarks(frame: Frame) -> tuple[str, ...]:
    """The region of a frame in a list of assumptions; nothing where the domain was declared."""
    if not frame.region.assumed:
        return ()
    return (f"the region {frame.region}; declare domain=[...] for another",)


@dataclass(frozen=True)
class Sphere:
    """A closed surface of a frame on which two coordinates are constant.

    frame: the frame around it. time, radius: the two coordinates, numbers in `frame.coordinates`.
    values: numbers for parameters and for the two coordinates, by symbol.
    ranges: the other coordinates, and between which values they run. assumed: remarks.
    outwards: 1 if the outside is at larger values of the radius, otherwise -1.
    """

    frame: Frame
    time: int
    radius: int
    values: Mapping[sp.Symbol, sp.Expr]
    ranges: tuple[tuple[sp.Symbol, sp.Expr, sp.Expr], ...]
    assumed: tuple[str, ...]
    outwards: int

    @cached_property
    def signature(self) -> int:
        """1 for one minus sign in the metric, -1 for one plus sign."""
        signs = self.frame.region.signature
        if signs.count(-1) == 1:
            return 1
        if signs.count(1) == 1:
            return -1
        raise GravityError(
            f"frame: expected a metric with one time, got the signs {signs}. Give a signature such "
            'as "-+++".'
        )

    @cached_property
    def volume(self) -> Element:
        """The root of |det g|."""
        volume = self.frame.volume.element()
        sign = self.frame.region.sign(volume)
        if sign is None:
            verdict = self.frame.region.sign_verdict(volume)
            raise GravityError(
                f"frame: expected a determinant of one sign in the region, got {verdict}. Declare "
                "where it is positive: domain=[...]."
            )
        return volume * sign

    def flux(self, component: Element) -> sp.Expr:
        """Density of the flux of F^ab outwards: |det g|^(1/2) F^ab at (time, radius)."""
        return self.put((self.volume * component).sympy) * self.outwards

    def put(self, expression: sp.Expr) -> sp.Expr:
        """An expression with the numbers of the surface."""
        return expression.xreplace(dict(self.values))

    @property
    def symbol(self) -> sp.Symbol:
        """The coordinate that plays the radius."""
        return self.frame.coordinates[self.radius]

    def __str__(self) -> str:
        held = [self.frame.coordinates[k] for k in (self.time, self.radius)]
        parts = [f"{q} = {self.values.get(q, 'const')}" for q in held]
        parts += [f"{q} from {low} to {high}" for q, low, high in self.ranges]
        return ", ".join(parts)

    @property
    def outside(self) -> str:
        """Which side of the surface is outside, in words."""
        return f"{'larger' if self.outwards > 0 else 'smaller'} {self.symbol}"

    def check_outside_horizons(self, *, is_slice: bool) -> None:
        """Refuse a surface that meets a horizon or is inside of one.

        Raises
        ------
        GravityError
            The radius is not a direction of space on the whole surface; for a surface of a slice
            (is_slice), or time is not a direction of time.
        """
        inverse = self.frame.inverse_metric.components
        for k, wanted in ((self.radius, 1), *([(self.time, -1)] if is_slice else [])):
            q = self.frame.coordinates[k]
            slope = self.put(inverse.get((k, k)).sympy * self.signature)
            free = slope.free_symbols - {x for x, _, _ in self.ranges}
            if free:
                continue
            signs = {int(sp.sign(slope.subs(point).evalf())) for point in self._points()}
            if signs != {wanted}:
                place = "is on" if signs == {0} else "crosses" if len(signs) > 1 else "is inside of"
                raise GravityError(
                    f"surface: expected one outside of all horizons, got {self}, which {place} "
                    f"a horizon: g^{2 * str(q)} has another sign. Choose another {self.symbol}."
                )

    def check_domain(self) -> None:
        """Refuse values outside of the declared domain of the frame."""
        for relation in self.frame.domain:
            if relation.subs(dict(self.values)) == sp.false:
                raise GravityError(
                    f"surface: expected values in the domain of the frame, got {self}, where "
                    f"{relation} does not hold. Choose others."
                )

    def _points(self) -> list[dict[sp.Symbol, sp.Expr]]:
        """Points on the surface, apart from its poles."""
        shares = [sp.Rational(k, 9) for k in range(1, 9)]
        return [{q: low + (high - low) * x for q, low, high in self.ranges} for x in shares]


def sphere(
    frame: Frame,
    surface: object,
    over: Mapping[Any, Any] | None,
    parameters: Mapping[Any, Any] | None,
    outside: int,
) -> Sphere:
    """The surface that a user describes; see `charge`."""
    if frame.dimension < 3:
        raise GravityError(
            f"frame: expected three dimensions or more, got {frame.dimension}. A charge needs a "
            "closed surface."
        )
    if frame.complex:
        raise GravityError(
            "frame: expected real legs, got a complex frame. Give the metric to Frame.from_metric."
        )
    symbols = {q.name: q for q in frame.coordinates}
    held = _held(surface, symbols)
    values = _values(frame, held, parameters)
    time, radius = (frame.coordinates.index(symbols[name]) for name in held)
    own = [q for q in frame.coordinates if q.name not in held]
    wanted = checks.known_keys(over or {}, [q.name for q in own], "over", GravityError)
    found = [_range(frame, q, wanted.get(q.name)) for q in own]
    side = checks.choice(
        outside, (1, -1), "outside", GravityError, remedy="Give 1 for larger values, or -1."
    )
    assumed = tuple(
        f"{q} is an angle from 0 to 2*pi" for q, one in zip(own, found, strict=True) if one[2]
    )
    ranges = tuple((q, low, high) for q, (low, high, _) in zip(own, found, strict=True))
    one = Sphere(frame, time, radius, values, ranges, assumed, side)
    # Refuses a metric without time.
    _ = one.signature
    _check_closed(one)
    return one


def _values(
    frame: Frame, held: Mapping[str, object], parameters: Mapping[Any, Any] | None
) -> dict[sp.Symbol, sp.Expr]:
    """Numbers for parameters, and for the constant coordinates that have one."""
    own = {x.name: x for x in frame.parameters}
    given = checks.known_keys(parameters or {}, list(own), "parameters", GravityError)
    values = {own[x]: number(value, f"parameters[{x}]") for x, value in given.items()}
    symbols = {q.name: q for q in frame.coordinates}
    for name, value in held.items():
        if value is not None:
            values[symbols[name]] = number(value, f"surface[{name}]")
    for symbol, value in values.items():
        checks.check_declared(symbol, value)
    return values


def _held(surface: object, symbols: Mapping[str, sp.Symbol]) -> dict[str, object]:
    """The two constant coordinates, time first, with their values or None."""
    first, second, *_ = symbols
    if surface is None:
        return {first: None, second: None}
    if isinstance(surface, str):
        listed: dict[Any, Any] = dict.fromkeys(surface.replace(",", " ").split())
    else:
        listed = checks.table(surface, "surface", GravityError)
    held = checks.known_keys(listed, symbols, "surface", GravityError, expected="a coordinate")
    if len(held) == 1:
        (name,) = held
        held = {first: None, **held} if name != first else {first: held[name], second: None}
    if len(held) != 2:
        raise GravityError(
            f"surface: expected two constant coordinates, time and radius, got {len(held)}. Give "
            f"such as {{'{second}': 10}} or '{first} {second}'."
        )
    return held


def number(value: object, name: str) -> sp.Expr:
    """An exact real number from a number or text; a float is the shortest decimal that it has."""

    def decimal(text: str) -> sp.Expr:
        return parse_expression(text, {}, where=name, decimals=True)

    read = checks.expression(value, name, GravityError, read=decimal)
    if read.free_symbols or read.is_real is not True:
        checks.refuse(GravityError, name, "a real number", value)
    if read.is_Float:
        return sp.Rational(*checks.repr_fraction(float(read)).as_integer_ratio())
    return read


def _range(frame: Frame, q: sp.Symbol, given: object) -> tuple[sp.Expr, sp.Expr, bool]:
    """Between which values a coordinate runs, and whether that is assumed from its name."""
    if given is not None:
        pair = checks.entries(given, f"over[{q}]", GravityError)
        if len(pair) != 2:
            checks.refuse(GravityError, f"over[{q}]", "two numbers", given)
        low, high = (number(x, f"over[{q}]") for x in pair)
        if not low < high:
            checks.refuse(GravityError, f"over[{q}]", "a smaller and a larger number", given)
        return low, high, False
    bounds: dict[int, sp.Expr] = {}
    for relation in (*frame.domain, *frame.region.relations):
        for one in relation.args if isinstance(relation, sp.And) else (relation,):
            if one.free_symbols != {q} or q not in one.args:
                continue
            left, right = one.args
            is_lower = (left == q) == isinstance(one, sp.Gt | sp.Ge)
            bounds.setdefault(0 if is_lower else 1, right if left == q else left)
    if q.is_nonnegative:
        bounds.setdefault(0, sp.S.Zero)
    if set(bounds) == {0, 1} and all(x.is_finite for x in bounds.values()):
        return bounds[0], bounds[1], False
    if q.name in AROUND or q.name.rstrip("_0123456789") in AROUND:
        return sp.S.Zero, 2 * sp.pi, True
    raise GravityError(
        f"surface: expected a closed surface, got no bounds for {q}. Give the bounds of an angle, "
        f"over={{'{q}': (0, '2*pi')}}, or write the metric in coordinates with two angles."
    )


def _check_closed(one: Sphere) -> None:
    """Refuse a surface with an edge.

    A coordinate runs between two poles, where the area vanishes, or once around.
    """
    frame = one.frame
    others = [k for k in range(frame.dimension) if k not in (one.time, one.radius)]
    entries = [[one.put(frame.metric[i, j]) for j in others] for i in others]
    area = sp.Matrix(entries).det()
    for q, low, high in one.ranges:
        ends = [sp.simplify(area.subs(q, end)) for end in (low, high)]
        turns = area.free_symbols.isdisjoint({q}) or sp.simplify(ends[0] - ends[1]) == 0
        is_pole = all(x == 0 for x in ends)
        if not is_pole and not (turns and not _is_short(q, low, high)):
            raise GravityError(
                f"surface: expected a closed surface, got an edge at {q} = {low} or {high}. Give "
                f"over={{'{q}': (from, to)}} from pole to pole, or once around."
            )


def _is_short(q: sp.Symbol, low: sp.Expr, high: sp.Expr) -> bool:
    """Whether an angle around an axis runs less or more than once around."""
    return q.name in AROUND and high - low != 2 * sp.pi


def divergence(
    one: Sphere, current: Callable[[int], Element]
) -> tuple[sp.Expr, dict[sp.Symbol, sp.Expr]]:
    """The exact derivative of a flux inside its slice, and its flux through ends of coordinates.

    dQ/dr is the integral of d_k F^{tk} and of what enters through the ends of each coordinate q of
    the surface, F^{tq} at the lower end less F^{tq} at the upper one; current: k -> F^{tk}, a
    tensor density.
    """
    frame, field = one.frame, one.frame.field
    others = [k for k in range(frame.dimension) if k != one.time]
    total = field.sum([(1, current(k).diff(frame.coordinates[k])) for k in others])
    leaks = {}
    for q, low, high in one.ranges:
        flux = current(frame.coordinates.index(q))
        if flux.is_zero or q not in flux.sympy.free_symbols:
            continue
        whole = one.put(flux.sympy)
        ends = [_end(whole, q, end, side) for end, side in ((low, "+"), (high, "-"))]
        if ends[0] != ends[1]:
            leaks[q] = sp.factor(ends[0] - ends[1]) / sp.pi * one.outwards
    value = sp.S.Zero if total.is_zero else one.put(total.sympy) * one.outwards / sp.pi
    return value, leaks


def _end(expression: sp.Expr, q: sp.Symbol, end: sp.Expr, side: str) -> sp.Expr:
    """An expression at an end of a coordinate; its limit where it is not finite there."""
    value = sp.simplify(expression.subs(q, end))
    return sp.limit(expression, q, end, side) if value.has(sp.nan, sp.zoo, sp.oo) else value


# -- integrals -------------------------------------------------------------------------------------


def integrated(one: Sphere, density: sp.Expr) -> tuple[sp.Expr | None, float, float]:
    """The integral of a density: its closed form if one is known; else a number and its error.

    Raises
    ------
    GravityError
        There is no closed form, and a symbol has no number.
    AccuracyError
        There is no enclosure of the integral.
    """
    left, rest = reduced(one, density)
    if not rest:
        return left, float("nan"), 0.0
    free = sorted(left.free_symbols - {x for x, _, _ in rest}, key=str)
    if free:
        raise GravityError(
            f"charge: expected numbers, because this integral has no closed form here, got none "
            f"for {free[0]}. Give surface={{'{one.symbol}': 10}} and parameters={{...}}."
        )
    return (None, *_number(left, rest))


def reduced(
    one: Sphere, density: sp.Expr
) -> tuple[sp.Expr, tuple[tuple[sp.Symbol, sp.Expr, sp.Expr], ...]]:
    """A density after its integrals in closed form, and the ranges that are left."""
    for k in reversed(range(len(one.ranges))):
        exact = _exact(one, density, *one.ranges[k])
        if exact is None:
            return density, one.ranges[: k + 1]
        density = exact
    return density, ()


def _exact(
    one: Sphere, density: sp.Expr, q: sp.Symbol, low: sp.Expr, high: sp.Expr
) -> sp.Expr | None:
    """One integral in closed form: of what does not depend on q, of moments, of fractions."""
    if q not in density.free_symbols:
        return density * (high - low)
    s, c = sp.Dummy("s"), sp.Dummy("c")
    replaced = sp.expand_trig(density).xreplace({sp.sin(q): s, sp.cos(q): c})
    if q in replaced.free_symbols or not replaced.is_rational_function(s, c):
        return None
    above, below = sp.fraction(sp.cancel(sp.together(replaced)))
    if below.free_symbols.isdisjoint({s, c}):
        return _moments(sp.Poly(above, s, c), low, high, below)
    return _fraction(one, sp.Poly(above, s, c), sp.Poly(below, s, c), (low, high))


def _moments(above: sp.Poly, low: sp.Expr, high: sp.Expr, below: sp.Expr) -> sp.Expr | None:
    """The integral of a polynomial in sine and cosine over quarters of a circle."""
    quarter = sp.pi / 2
    if low != 0 or high not in (quarter, sp.pi, 2 * sp.pi):
        return None
    total = sp.S.Zero
    for (i, j), factor in above.terms():
        one = sp.gamma(sp.Rational(i + 1, 2)) * sp.gamma(sp.Rational(j + 1, 2))
        one /= 2 * sp.gamma(sp.Rational(i + j, 2) + 1)
        # Signs of sin^i cos^j in the four quarters.
        signs = [1, (-1) ** j, (-1) ** (i + j), (-1) ** i][: int(high / quarter)]
        total += factor * one * sum(signs)
    return sp.cancel(total / below)


def _fraction(
    one: Sphere, above: sp.Poly, below: sp.Poly, ends: tuple[sp.Expr, sp.Expr]
) -> sp.Expr | None:
    """The integral of sin(q) R(cos(q)) from pole to pole, by x = cos(q)."""
    if ends != (0, sp.pi):
        return None
    s, c = above.gens
    squares = [sp.Poly(x.rem(sp.Poly(s**2 + c**2 - 1, s, c)), s) for x in (above, below)]
    parts = [(x.coeff_monomial(s), x.coeff_monomial(1)) for x in squares]
    (odd, even), (odd_below, even_below) = parts
    if even != 0 or odd_below != 0:
        if even == 0 or even_below != 0:
            return None
        # R / sin(q) is sin(q) R / (1 - x^2).
        odd, even_below = even, odd_below * (1 - c**2)
    p, r = sp.fraction(sp.cancel(odd / even_below))
    whole, remainder = sp.Poly(p, c).div(sp.Poly(r, c))
    part, rest = ratint_ratpart(remainder, sp.Poly(r, c), c)
    part += whole.integrate(c).as_expr()
    if rest != 0:
        angle = _arctangent(one, rest, c)
        if angle is None:
            return None
        part += angle
    difference = part.subs(c, 1) - part.subs(c, -1)
    return sp.cancel(difference) if rest == 0 else sp.simplify(difference)


def _arctangent(one: Sphere, fraction: sp.Expr, x: sp.Symbol) -> sp.Expr | None:
    """The integral of b / (u x^2 + v) with u and v of one sign: b/(uv)^(1/2) arctan."""
    above, below = (sp.Poly(part, x) for part in sp.fraction(sp.cancel(fraction)))
    if below.degree() != 2 or below.coeff_monomial(x) != 0 or above.degree() > 0:
        return None
    u, v = below.coeff_monomial(x**2), below.coeff_monomial(1)
    region = one.frame.region
    signs = [region.sign(part) if part.free_symbols else sp.sign(part) for part in (u, v)]
    if signs not in ([1, 1], [-1, -1]):
        return None
    positive = {
        symbol: sp.Dummy(symbol.name, positive=True)
        for symbol in (u * v).free_symbols
        if region.sign(symbol) == 1
    }
    back = {dummy: symbol for symbol, dummy in positive.items()}
    root = sp.sqrt(sp.factor((u * v).xreplace(positive))).xreplace(back)
    return above.as_expr() / root * sp.atan(u * x / root)


def _number(
    density: sp.Expr, ranges: Sequence[tuple[sp.Symbol, sp.Expr, sp.Expr]]
) -> tuple[float, float]:
    """The integral over some coordinates in balls: a number, and a bound on its error."""
    code = balls.BallCode(graph([q.name for q, _, _ in ranges], [density], factor=False))
    function = code.complex_function()
    with ball_precision(CONSTANT_BITS):
        numbers = code.numbers()
        bounds = [[balls.exact_ball(x) for x in (low, high)] for _, low, high in ranges]
        tolerance = arb(2) ** (8 - CONSTANT_BITS // 2)

        def along(fixed: list[acb], k: int, is_inner: bool) -> acb:
            """The integral over the coordinates from k on."""
            low, high = bounds[k]

            def inner(x: acb, analytic: bool) -> acb:
                point, smooth = [*fixed, low + (high - low) * x], analytic or is_inner
                if k + 1 < len(bounds):
                    return along(point, k + 1, smooth)
                return function(point, numbers, smooth)[0]

            return (high - low) * balls.integral(inner, tolerance)

        value = along([], 0, False).real
        if not value.is_finite():
            raise AccuracyError(
                "charge: expected an integral with an enclosure, got none: the density has a pole "
                "or a root on the surface. Choose another surface."
            )
        middle = float(value.mid())
        return middle, float(abs(value - arb(middle)).upper())

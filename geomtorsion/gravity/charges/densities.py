"""Densities: what a charge integrates over a closed surface, one function for each kind."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, cast

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, parse_expression
from geomtorsion.geometry import Connection, Form, Frame, Tensor, cartan, levi_civita, lie, surface
from geomtorsion.gravity.charges.spheres import Sphere, number
from geomtorsion.gravity.theory.field_equations import equations
from geomtorsion.gravity.theory.fields import FrameFields
from geomtorsion.gravity.theory.inertial import inertial
from geomtorsion.gravity.theory.lagrangian import Lagrangian, known_as
from geomtorsion.support import arguments, checks


@dataclass(frozen=True)
class Request:
    """The arguments of `charge`.

    connection: the connection that was given, or None for a frame.
    """

    frame: Frame
    connection: Connection | None
    killing: object
    lagrangian: Lagrangian | str | None
    leg: int
    potential: object
    vary: object
    reference: Any


@dataclass(frozen=True)
class Density:
    """A density on a surface.

    expression: in the coordinates of the surface. name: of the charge. formula: in words.
    current: k -> component (time, k) of the antisymmetric tensor density whose flux is the charge;
        None for an integrand of another kind.
    at_infinity: whether the radius grows without bound. assumed: assumptions, in words.
    """

    expression: sp.Expr
    name: str
    formula: str
    current: Callable[[int], Element] | None = None
    at_infinity: bool = False
    assumed: tuple[str, ...] = ()

    @classmethod
    def of_flux(
        cls,
        one: Sphere,
        component: Callable[[int], Element],
        factor: sp.Expr,
        name: str,
        formula: str,
        assumed: tuple[str, ...] = (),
    ) -> Density:
        """The flux of an antisymmetric tensor: factor |g|^(1/2) F^{tr}; component: k -> F^{tk}."""
        share = sp.Rational(factor * sp.pi)
        rational = one.frame.field.rational(Fraction(int(share.p), int(share.q)))

        def current(k: int) -> Element:
            return one.volume * component(k) * rational

        flux = one.put(current(one.radius).sympy) * one.outwards / sp.pi
        return cls(flux, name, formula, current, assumed=assumed)


def _killing(request: Request) -> Tensor:
    """The Killing vector, slot u.

    Raises
    ------
    GravityError
        The metric changes along the vector, or there is none.
    """
    frame, given = request.frame, request.killing
    names = [q.name for q in frame.coordinates]
    if given is None:
        given = names[0]
    if isinstance(given, str | sp.Symbol):
        name = checks.known_name(given, names, "killing", GravityError, expected="a coordinate")
        given = [int(q == name) for q in names]
    xi = frame.vector(cast(arguments.Vector, given))
    if lie(xi, frame).is_zero is not True:
        raise GravityError(
            f"killing: expected a Killing vector, got {checks.shown(list(map(str, xi)))}: the "
            "metric changes along it. gt.symmetries(frame) lists the Killing vectors."
        )
    return xi


def _kind(one: Sphere, xi: Tensor) -> tuple[str, bool]:
    """Name of the charge of a Killing vector, and whether it is tangent to the surface."""
    inside = xi.components.get((one.time,)).is_zero is True
    if not inside and len(xi.components.nonzero) > 1:
        return "charge of the Killing vector", inside
    return ("angular momentum" if inside else "mass"), inside


def _row(one: Sphere, tensor: Tensor) -> Callable[[int], Element]:
    """k -> the component (time, k) of a tensor with two upper indices."""
    get = tensor.components.get
    return lambda k: get((one.time, k))


def komar(request: Request, one: Sphere) -> Density:
    """-(n - 2)/(n - 3)/(16 pi) |g|^(1/2) (d xi)^{tr}; 1/(16 pi) of it for angular momenta."""
    given = request.connection
    if given is not None and given.is_torsion_free is not True:
        raise GravityError(
            f"connection: expected no torsion for a Komar charge, got {given.name}: *d xi is "
            "closed by the Einstein equations of the metric. Give the frame, or kind "
            "'teleparallel'."
        )
    xi = _killing(request)
    name, inside = _kind(one, xi)
    n = request.frame.dimension
    if n == 3 and not inside:
        raise GravityError(
            "kind: expected four dimensions or more for a Komar mass, got 3. Use kind 'varied' "
            "with vary='M'."
        )
    factor = sp.Rational(1, 16) if inside else -sp.Rational(n - 2, 16 * (n - 3))
    # (d xi)^{tk}, twice the derivative D^t xi^k.
    row = _row(one, Form.of(xi.lowered()).d.tensor.raised())
    formula = f"{factor}/pi * surface integral of *d(xi)"
    return Density.of_flux(one, row, factor * one.signature / sp.pi, name, formula)


def teleparallel(request: Request, one: Sphere) -> Density:
    """-1/(8 pi) |g|^(1/2) (dL/dT)^{tr}_k, k a leg."""
    assumed: tuple[str, ...] = ()
    if request.reference:
        connection = inertial(request.frame, request.reference)
    elif request.connection is not None:
        connection = request.connection
    else:
        connection = cartan(request.frame)
        remark = (
            "the tetrad is proper, without torsion where gravity is absent; for another tetrad "
            "give reference={'M': 0}"
        )
        assumed = (remark,)
    theory = known_as(request.lagrangian or "T")
    momentum = equations(connection, theory).P
    leg = checks.count(request.leg, "leg", GravityError, 0, request.frame.dimension - 1)
    legs = request.frame.legs.components.get

    def component(mu: int) -> Element:
        return request.frame.field.sum(
            [
                (1, legs((one.time, i)), legs((mu, j)), value)
                for (i, j, k), value in momentum.components.nonzero.items()
                if k == leg
            ]
        )

    name = "energy" if leg == one.time else f"momentum along leg {leg}"
    formula = f"-1/(8*pi) * surface integral of dL/dT^(ab)_k, k = leg {leg}, a and b coordinates"
    factor = -one.signature / (8 * sp.pi)
    formula = f"{formula}, L = {theory.expression}"
    return Density.of_flux(one, component, factor, name, formula, assumed)


def noether(request: Request, one: Sphere) -> Density:
    """-1/(16 pi) |g|^(1/2) J^{tr}, with the Noether potential J^{ab} of a Killing vector xi.

    J^{ab} = 2 P^{abcd} D_c xi_d - 4 xi_d D_c P^{abcd}, P = dL/dR_abcd with the symmetries of the
    curvature, R = g^{ac} g^{bd} R_abcd [Iyer, Wald 1994]. Its divergence is L xi^a + 2 E^a_b xi^b.
    """
    xi = _killing(request)
    inside = _kind(one, xi)[1]
    theory = known_as(request.lagrangian or "R")
    system = equations(levi_civita(request.frame), theory)
    P = _with_symmetries(system.Z.raised(3))
    connection, n = system.connections[0], range(request.frame.dimension)
    # D_c xi_d and D_c P^{abcd}, along the legs.
    slope = connection.covariant_derivative(xi.lowered()).in_frame().components
    flow = FrameFields(connection).divergence(P, paired=True).components.get
    low, legs = xi.lowered().in_frame().components, request.frame.legs.components.get
    get = P.components.get

    def along(a: int, b: int) -> Element:
        """J^{ab}, a and b legs; the divergence is over the third slot, P^{abcd} = P^{cdab}."""
        terms: list[Any] = [(2, get((a, b, c, d)), x) for (c, d), x in slope.nonzero.items()]
        terms += [(-4, flow((d, a, b)), x) for (d,), x in low.nonzero.items()]
        return request.frame.field.sum(terms)

    pairs = {(i, j): along(i, j) for i in n for j in n if i != j}

    def component(mu: int) -> Element:
        terms = [(1, legs((one.time, i)), legs((mu, j)), x) for (i, j), x in pairs.items()]
        return request.frame.field.sum(terms)

    factor = one.signature * (1 if inside else -1) / (16 * sp.pi)
    name = "angular momentum" if inside else "Noether charge"
    formula = f"Noether charge of L = {theory.expression}, without boundary terms"
    return Density.of_flux(one, component, factor, name, formula)


def _with_symmetries(tensor: Tensor) -> Tensor:
    """-dL/dR_abcd with the symmetries of the curvature and the sign of R = g^{ac} g^{bd} R_abcd."""
    get = tensor.components.get
    pairs = [(0, 1, 2, 3, 1), (1, 0, 2, 3, -1), (0, 1, 3, 2, -1), (1, 0, 3, 2, 1)]

    def paired(index: tuple[int, ...]) -> list[Any]:
        found: list[Any] = []
        for *places, sign in pairs:
            x = tuple(index[k] for k in places)
            found += [(Fraction(-sign, 8), get(x)), (Fraction(-sign, 8), get((*x[2:], *x[:2])))]
        return found

    def rule(index: tuple[int, ...]) -> Element:
        a, b, c, d = index
        terms = [(Fraction(2, 3) * x, y) for x, y in paired(index)]
        for other in ((a, c, d, b), (a, d, b, c)):
            terms += [(-Fraction(1, 3) * x, y) for x, y in paired(other)]
        return tensor.frame.field.sum(terms)

    return Tensor(tensor.frame, "UUUU", rule)


def electric(request: Request, one: Sphere) -> Density:
    """1/(4 pi) |g|^(1/2) F^{tr}, of the potential A_mu."""
    frame = request.frame
    if request.potential is None:
        raise GravityError(
            "potential: expected the components A_mu for an electric charge, got none. Give "
            "potential=['-Q/r', 0, 0, 0]."
        )
    names = {q.name: q for q in (*frame.coordinates, *frame.parameters)}
    parts = checks.entries(request.potential, "potential", GravityError)
    if len(parts) != frame.dimension:
        raise GravityError(
            f"potential: expected {frame.dimension} components, got {len(parts)}. Give one for "
            "each coordinate."
        )
    read = [
        checks.expression(x, "potential", GravityError, read=lambda text: _parsed(text, names))
        for x in parts
    ]
    field = Form(frame, 1, dict(enumerate(read))).d.tensor.raised()
    formula = "1/(4*pi) * surface integral of *F, F = dA"
    factor = one.signature / (4 * sp.pi)
    return Density.of_flux(one, _row(one, field), factor, "electric charge", formula)


def _parsed(text: str, names: dict[str, Any]) -> sp.Expr:
    return parse_expression(text, names, where="potential")


def varied(request: Request, one: Sphere) -> Density:
    """Change of the charge of a Killing vector with a parameter, in GR with Lambda.

    k^{mn} = |g|^(1/2)/(8 pi) (xi^m D_s h^{ns} - xi^m D^n h + xi_s D^n h^{ms} + h D^n xi^m / 2
    - h^{sn} D_s xi^m), antisymmetric in mn, h = dg/dM [Iyer, Wald 1994], [Barnich, Brandt 2002].
    """
    frame, xi = request.frame, _killing(request)
    parameter = _parameter(frame, request.vary)
    name, inside = _kind(one, xi)
    field, n = frame.field, range(frame.dimension)
    metric = frame.metric.components.get
    h = Tensor(frame, "dd", lambda x: metric(x).diff(parameter))
    connection = levi_civita(frame)
    # D^a h^{bc} and D^a xi^b, all indices up.
    dh = connection.covariant_derivative(h).raised().components.get
    dxi = connection.covariant_derivative(xi).raised(0).components.get
    up, low = xi.components.get, xi.lowered().components.get
    mixed, g = h.raised(0).components.get, metric
    both = h.raised()
    trace = field.sum([(1, mixed((a, a))) for a in n])
    inverse = frame.inverse_metric.components.get

    def half(m: int, k: int) -> list[Any]:
        terms: list[Any] = [
            (-1, up((m,)), inverse((k, a)), trace.diff(frame.coordinates[a])) for a in n
        ]
        for s in n:
            terms += [(1, up((m,)), g((s, a)), dh((a, k, s))) for a in n]
            terms.append((1, low((s,)), dh((k, m, s))))
            terms += [(-1, both.components.get((s, k)), g((s, a)), dxi((a, m))) for a in n]
        terms.append((Fraction(1, 2), trace, dxi((k, m))))
        return terms

    t = one.time

    def component(k: int) -> Element:
        return field.sum([*half(t, k), *((-x[0], *x[1:]) for x in half(k, t))])

    factor = one.signature * (-1 if inside else 1) / (16 * sp.pi)
    formula = "surface integral of the charge of dg, general relativity with Lambda"
    return Density.of_flux(one, component, factor, f"d({name})/d{parameter}", formula)


def _parameter(frame: Frame, given: object) -> sp.Symbol:
    names = {x.name: x for x in frame.parameters}
    if given is None:
        raise GravityError(
            f"vary: expected a parameter of the frame, got none. Give one of {', '.join(names)}."
        )
    return names[checks.known_name(given, names, "vary", GravityError, expected="a parameter")]


# -- a slice ---------------------------------------------------------------------------------------


def _slice(one: Sphere) -> Frame:
    """The slice of constant time, with a positive metric."""
    others = [q for k, q in enumerate(one.frame.coordinates) if k != one.time]
    unknown = sorted(map(str, one.put(sp.Matrix(one.frame.metric[:, :])).atoms(AppliedUndef)))
    if unknown:
        raise GravityError(
            f"frame: expected a metric of known functions for this kind, got {unknown[0]}. Put a "
            "formula in its place with frame.subs."
        )
    frame = surface(one.frame, [q.name for q in others]).frame
    known = {*others, *one.frame.parameters}
    where = one.frame.domain or one.frame.region.relations
    domain = [x for x in where if x.free_symbols <= known]
    return _with_metric(frame, domain, lambda value: value * one.signature)


def _with_metric(
    frame: Frame, domain: Sequence[sp.Basic], changed: Callable[[sp.Expr], sp.Expr]
) -> Frame:
    """The frame with every component of its metric changed."""
    n = range(frame.dimension)
    rows = [[changed(frame.metric[i, j]) for j in n] for i in n]
    return Frame.from_metric(
        frame.coordinates, rows, parameters=frame.parameters, domain=domain or None
    )


def brown_york(request: Request, one: Sphere) -> Density:
    """1/(8 pi) (k0 - k) of a sphere, k0 its mean curvature in flat space."""
    _check_four(one, "brown-york")
    around = [q.name for q, _, _ in one.ranges]
    ball = surface(_slice(one), around, orientation=one.outwards)
    curvature = levi_civita(ball.frame).curvature.scalar.element()
    if curvature.symbols & {q for q, _, _ in one.ranges}:
        raise GravityError(
            f"surface: expected a sphere of constant curvature for brown-york, got {one}, whose "
            "curvature varies. The embedding in flat space is implemented for constant curvature. "
            "Choose kind 'komar' or 'adm'."
        )
    k0 = sp.sqrt(2 * curvature.sympy)
    volume = ball.frame.volume.element()
    area = volume.sympy * (one.frame.region.sign(volume) or 1)
    density = (k0 - ball.mean_curvature.element().sympy) * area / (8 * sp.pi)
    density = _rooted(one, density)
    return Density(one.put(density), "quasi-local mass", "1/(8*pi) * surface integral of k0 - k")


def _rooted(one: Sphere, expression: sp.Expr) -> sp.Expr:
    """An expression with roots of squares replaced by values that are positive there."""
    region = one.frame.region
    positive = {
        x: sp.Dummy(x.name, positive=True) for x in expression.free_symbols if region.sign(x) == 1
    }
    back = {dummy: x for x, dummy in positive.items()}
    return sp.powdenest(expression.xreplace(positive)).xreplace(back)


def _check_four(one: Sphere, kind: str) -> None:
    if one.frame.dimension != 4:
        raise GravityError(
            f"kind: expected four dimensions for {kind!r}, got {one.frame.dimension}. Use 'komar' "
            "or 'varied'."
        )


def adm(request: Request, one: Sphere) -> Density:
    """1/(16 pi) (D^j h_ij - D_i h) at infinity; D and traces of the reference metric."""
    _check_four(one, "adm")
    space = _slice(one)
    names = {x.name: x for x in space.parameters}
    given = checks.known_keys(
        request.reference or {}, names, "reference", GravityError, expected="a parameter"
    )
    if not given:
        advice = (
            f"Give reference={{'{next(iter(names))}': 0}}, or other values."
            if names
            else "Write the metric with a parameter, such as its mass."
        )
        raise GravityError(
            f"reference: expected the parameters for which the slice is flat, got none. {advice}"
        )
    put = {names[x]: number(value, f"reference[{x}]") for x, value in given.items()}
    flat = _with_metric(space, (), lambda value: value.subs(put))
    connection = levi_civita(flat)
    if connection.curvature.riemann.is_zero is not True:
        raise GravityError(
            f"reference: expected values that make the slice flat, got {checks.shown(given)}, with "
            "curvature. ADM masses belong to spaces that are flat at infinity; use kind 'varied'."
        )
    n = range(3)
    places = [(i, j) for i in n for j in n]
    differences = [(f"g{x}", space.metric[x] - flat.metric[x]) for x in places]
    read = dict(zip(places, flat.read(differences), strict=True))
    h = Tensor(flat, "dd", lambda x: read[x[0], x[1]])
    dh = connection.covariant_derivative(h).components.get
    inverse = flat.inverse_metric.components.get
    r = flat.coordinates.index(one.symbol)
    component = flat.field.sum(
        [
            (sign, inverse((r, i)), inverse((j, k)), dh(place))
            for i in n
            for j in n
            for k in n
            for sign, place in ((1, (j, i, k)), (-1, (i, j, k)))
        ]
    )
    volume = flat.volume.element()
    density = (component * volume).sympy * (one.frame.region.sign(volume) or 1)
    density = _at_infinity(one.put(density) * one.outwards, one.symbol) / (16 * sp.pi)
    formula = "1/(16*pi) * surface integral of D^j h_ij - D_i h at infinity"
    return Density(density, "mass", formula, at_infinity=True)


def _at_infinity(density: sp.Expr, r: sp.Symbol) -> sp.Expr:
    """The limit of a density as the radius grows."""
    above, below = sp.fraction(sp.cancel(sp.together(density)))
    if not (above.is_polynomial(r) and below.is_polynomial(r)):
        value = sp.limit(density, r, sp.oo)
    else:
        top, bottom = sp.Poly(above, r), sp.Poly(below, r)
        if top.degree() > bottom.degree():
            value = sp.oo
        elif top.degree() < bottom.degree():
            value = sp.S.Zero
        else:
            value = sp.cancel(top.LC() / bottom.LC())
    if value.has(sp.oo, sp.zoo, sp.nan):
        raise GravityError(
            f"charge: expected a finite limit for large {r}, got none. The slice does not become "
            "flat fast enough in these coordinates."
        )
    return value


KINDS: dict[str, Callable[[Request, Sphere], Density]] = {
    "komar": komar,
    "noether": noether,
    "teleparallel": teleparallel,
    "varied": varied,
    "brown-york": brown_york,
    "adm": adm,
    "electric": electric,
}
# Kinds whose surface must be outside of all horizons.
OUTSIDE: Sequence[str] = ("komar", "noether", "teleparallel", "brown-york")

"""Charges: mass, angular momentum and electric charge inside a closed surface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.geometry import Connection
from geomtorsion.geometry.connections import ConnectionLike, FrameLike, as_frame
from geomtorsion.gravity.charges.densities import KINDS, OUTSIDE, Request
from geomtorsion.gravity.charges.spheres import (
    divergence,
    integrated,
    number,
    region_remarks,
    sphere,
)
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.support import checks
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.outgoing import measured_text


@dataclass(frozen=True, repr=False)
class Charge:
    """A charge inside a closed surface.

    kind: how it is defined. name: mass, angular momentum, ...
    value: a sympy expression where the integral has a closed form, otherwise a float.
    error: bound on the error of a float; 0 for a closed form.
    formula: the integral, in words. surface: where it is taken. outside: which side is outside.
    conserved: whether the value is the same on every surface r = const; None if it is unknown.
    source: the exact derivative of the integrand, a density in all coordinates of a slice: the
        charges of two surfaces differ by its integral between them. 0 for a closed form, whose
        charge is the same on any surface that can be deformed into this one; None for "brown-york"
        and "adm".
    leaks: flux density through the ends of the coordinates of the surface, by coordinate; empty
        where the surface is closed for the integrand.
    assumed: assumptions, in words.
    """

    kind: str
    name: str
    value: Any
    error: float
    formula: str
    surface: str
    outside: str
    conserved: bool | None
    source: sp.Expr | None
    leaks: Mapping[sp.Symbol, sp.Expr]
    assumed: tuple[str, ...]
    radius: sp.Symbol

    _repr_html_ = drawn_by("charges", "charge_html")
    plot: ClassVar[Plot] = figure_by("charges", "draw_charge")

    @property
    def is_exact(self) -> bool:
        """Whether the value is a closed form."""
        return isinstance(self.value, sp.Expr)

    @property
    def is_closed(self) -> bool | None:
        """Whether the integrand is closed, decided exactly; None where it is not a form."""
        return None if self.source is None else self.source == 0

    @property
    def proved_by(self) -> str:
        """Certainty of the value, in words."""
        if self.is_exact:
            return "closed form, an exact integral by computer algebra"
        return f"ball arithmetic: the charge is within {self.error:.1g} of the value"

    @property
    def symbols(self) -> frozenset[str]:
        """Names of the symbols in the value."""
        free = self.value.free_symbols if isinstance(self.value, sp.Expr) else ()
        return frozenset(str(x) for x in free)

    def __float__(self) -> float:
        """The value as a number.

        Raises
        ------
        GravityError
            The value contains symbols.
        """
        if not isinstance(self.value, sp.Expr):
            return self.value
        free = sorted(map(str, self.value.free_symbols))
        if free:
            raise GravityError(
                f"charge: expected a value without symbols, got {', '.join(free)}. Give numbers "
                "in parameters and surface, or use charge.at({...})."
            )
        return float(self.value)

    def at(self, values: Mapping[Any, Any]) -> float:
        """The value at numbers for its symbols, by name.

        Raises
        ------
        GravityError
            A name is not in the value, or a symbol has no number.

        Examples
        --------
        >>> from geomtorsion import gravity
        >>> tetrad = gravity.charge("schwarzschild", "brown-york")
        >>> round(tetrad.at({"M": 1, "r": 10}), 6)
        1.055728
        """
        if not isinstance(self.value, sp.Expr):
            return self.value
        names = {x.name: x for x in self.value.free_symbols}
        given = checks.known_keys(values, names, "values", GravityError)
        put = {names[x]: number(v, f"values[{x}]") for x, v in given.items()}
        value = self.value.subs(put)
        if value.free_symbols or value.is_real is not True:
            raise GravityError(
                f"values: expected numbers with a real charge, got {value}. Give all of "
                f"{', '.join(sorted(names))}, outside of horizons."
            )
        return float(value)

    def to_json(self) -> dict[str, Any]:
        """The charge as plain data; a closed form as text."""
        value = self.value if isinstance(self.value, float) else str(self.value)
        return {
            "kind": self.kind,
            "name": self.name,
            "value": value,
            "error": self.error,
            "formula": self.formula,
            "surface": self.surface,
            "outside": self.outside,
            "conserved": self.conserved,
            "closed": self.is_closed,
            "source": None if self.source is None else str(self.source),
            "leaks": {str(q): str(x) for q, x in self.leaks.items()},
            "proved_by": self.proved_by,
            "assumed": list(self.assumed),
        }

    def __str__(self) -> str:
        shown = (
            f"{self.value}"
            if isinstance(self.value, sp.Expr)
            else measured_text(self.value, self.error)
        )
        same = {
            True: "the same on every such surface",
            False: "depends on the surface",
            None: "",
        }[self.conserved]
        lines = [
            f"{self.name} = {shown}" + f", {same}" * bool(same),
            f"  {self.kind}: {self.formula}",
            f"  on {self.surface}; outside: {self.outside}",
            *self._sources,
            f"  proved by: {self.proved_by}",
            *(f"  assumed: {one}" for one in self.assumed),
        ]
        return "\n".join(lines)

    __repr__ = __str__

    @property
    def _sources(self) -> list[str]:
        """Where the flux of the integrand enters, in words."""
        lines = [
            f"  flux enters at the ends of {q}, where the frame is singular (a string): "
            f"{checks.cut(str(x))} per angle and {self.radius}"
            for q, x in self.leaks.items()
        ]
        if self.source == 0:
            lines.append("  closed: the exact derivative of the integrand is zero")
        elif self.source is not None:
            lines.append(f"  source between surfaces: density {checks.cut(str(self.source))}")
        return lines


def charge(
    frame: FrameLike | ConnectionLike,
    kind: str = "komar",
    *,
    killing: object = None,
    surface: Mapping[Any, Any] | str | None = None,
    parameters: Mapping[Any, Any] | None = None,
    lagrangian: Lagrangian | str | None = None,
    leg: int = 0,
    potential: object = None,
    vary: str | sp.Symbol | None = None,
    reference: Mapping[Any, Any] | None = None,
    over: Mapping[Any, Any] | None = None,
    outside: int = 1,
) -> Charge:
    """Mass, angular momentum or electric charge inside a closed surface.

    Equation
    --------
    komar [Komar1959], closed where Ric(xi) = 0:
    M = -1/(8 pi) integral *d xi, J = 1/(16 pi) integral *d xi
    noether [IyerWald1994], with P = dL/dR_abcd:
    Q = -1/(16 pi) integral (2 P^abcd D_c xi_d - 4 xi_d D_c P^abcd)
    teleparallel [Maluf1994], positive for L = T:
    P_k = -1/(8 pi) integral dL/dT^ab_k
    varied [IyerWald1994], in general relativity with Lambda: dQ/dM of a Killing vector

    brown-york [BrownYork1993]:
    E = 1/(8 pi) integral (k0 - k)
    adm [ArnowittDeserMisner1962], at infinity:
    M = 1/(16 pi) integral (D^j h_ij - D_i h)
    electric:
    Q = 1/(4 pi) integral *dA
    with G = c = 1. Integrals run over a surface where time and radius are constant.

    Parameters
    ----------
    frame
        A frame, a space or its name; for teleparallel also a flat connection.
    kind
        komar, noether, teleparallel, varied, brown-york, adm or electric.
    killing
        Name of a coordinate, or components xi^mu, shape (n,), of a Killing vector, for komar,
        noether and varied. A vector along the surface gives an angular momentum, with noether in
        every theory L(R). The default is the first coordinate. The noether charge of the Killing
        vector of a horizon is T S there, without the boundary term of a mass: M/2 for
        Schwarzschild.
    surface
        The two constant coordinates, time first: "t r", or with values, {"r": 10}. The default is
        the first two.
    parameters
        Numbers for the parameters of the frame.
    lagrangian
        L(T) for teleparallel, the default is "T"; L(R) for noether, the default is "R".
    leg
        Number of the leg k for teleparallel, 0 for the energy; a and b are coordinates.
    potential
        A_mu, shape (n,), coordinate indices, for electric.
    vary
        Name of a parameter for varied.
    reference
        Values of the parameters without gravity, {"M": 0}: for adm, and for a teleparallel charge
        of a tetrad with torsion there (see `gravity.inertial`).
    over
        {coordinate: (from, to)} of the surface, where the frame has no bounds for it.
    outside
        1: at larger values of the radius; -1: at smaller ones.

    Raises
    ------
    GravityError
        The vector is not a Killing vector, the surface has an edge or meets a horizon, a connection
        with torsion was given to komar, or a number is missing.
    AccuracyError
        The integral has no enclosure.

    Examples
    --------
    >>> from geomtorsion import gravity
    >>> hole = gravity.charge("kerr")
    >>> hole.value, hole.conserved, hole.outside
    (M, True, 'larger r')
    >>> gravity.charge("kerr", killing="phi", surface={"r": 3}).value
    M*a
    """
    checks.choice(kind, list(KINDS), "kind", GravityError)
    connection = frame if isinstance(frame, Connection) else None
    own = connection.frame if connection is not None else as_frame(frame, "frame", GravityError)
    request = Request(own, connection, killing, lagrangian, leg, potential, vary, reference)
    one = sphere(own, surface, over, parameters, outside)
    if kind in OUTSIDE:
        one.check_outside_horizons(is_slice=kind != "komar")
    one.check_domain()
    density = KINDS[kind](request, one)
    found = density.expression
    time = own.coordinates[one.time]
    if time in found.free_symbols:
        raise GravityError(
            f"surface: expected a charge that does not change with {time}, got one that does. Give "
            f"surface={{'{time}': 0, '{one.symbol}': 10}}."
        )
    exact, value, error = integrated(one, found)
    source, leaks = divergence(one, density.current) if density.current else (None, {})
    conserved = True if source == 0 and not leaks else None
    is_held = one.symbol in one.values
    if conserved is None and exact is not None and not is_held and not density.at_infinity:
        conserved = sp.simplify(exact.diff(one.symbol)) == 0
    return Charge(
        kind=kind,
        name=density.name,
        value=value if exact is None else exact,
        error=error,
        formula=density.formula,
        surface=f"{one.symbol} to infinity" if density.at_infinity else str(one),
        outside=one.outside,
        conserved=conserved,
        source=source,
        leaks=leaks,
        assumed=(*one.assumed, *density.assumed, *region_remarks(own)),
        radius=one.symbol,
    )

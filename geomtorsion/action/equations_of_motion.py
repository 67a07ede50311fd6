"""Equations: the motion that a Lagrangian over a frame leads to, exactly, in two formulations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.action import equation_text, validation
from geomtorsion.action.hamel import (
    Hamel,
    HamelCoefficients,
    coefficients_of,
    hamel_of,
    torsion_over,
)
from geomtorsion.action.invariants import ConservedQuantities, conserved
from geomtorsion.action.linearized import linearized
from geomtorsion.action.principles import Principle, principle_named
from geomtorsion.action.steady import Linearization
from geomtorsion.action.tangent_bundle import TangentBundle, bundle_over
from geomtorsion.errors import LagrangianError, LimitError
from geomtorsion.geometry.assumption import assumption_latex, assumption_of
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import drawn_by

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Connection, Frame
    from geomtorsion.geometry.connections import ConnectionLike, FrameLike


@dataclass(frozen=True)
class Reduced:
    """Rates of u^k in u, t and parameters, as on a Lie group, and their invariants.

    rates: name of a velocity -> its rate.
    invariants: name -> f(u, t).
    """

    rates: Mapping[str, sp.Expr]
    invariants: Mapping[str, sp.Expr]

    @property
    def text(self) -> str:
        """The rates as text, one line each."""
        return equation_text.rate_text(self.rates)

    @property
    def latex(self) -> str:
        """The rates as aligned LaTeX."""
        return equation_text.rate_latex(self.rates)

    def _repr_latex_(self) -> str:
        return f"$${self.latex}$$"

    _repr_html_ = drawn_by("notebook_tables", "equations_html")

    def __str__(self) -> str:
        return self.text


def reduced(
    rates: Mapping[str, sp.Expr],
    invariants: Mapping[str, sp.Expr],
    coordinates: tuple[sp.Symbol, ...],
) -> Reduced:
    """Omit the coordinates.

    Raises
    ------
    LagrangianError
        A coordinate occurs in the rate of a velocity; the message names both.
    """
    inside = {symbol.name: symbol for symbol in coordinates}
    remaining = {name: rate for name, rate in rates.items() if name not in inside}
    for name, rate in remaining.items():
        met = sorted(symbol.name for symbol in rate.free_symbols & set(coordinates))
        if met:
            raise LagrangianError(
                f"expected velocities that evolve without the coordinates, got a rate of {name} "
                f"that depends on {', '.join(met)}. Use the equations with their coordinates."
            )
    still = {k: v for k, v in invariants.items() if not v.free_symbols & set(coordinates)}
    return Reduced(remaining, still)


@dataclass(frozen=True, eq=False, repr=False)
class EquationsOfMotion:
    """Equations of motion in quasi-velocities u^i = e^i_mu q'^mu, solved for u'^i.

    frame: the frame whose forms give the velocities.
    lagrangian: L(q, u, t).
    forces: F_k(q, u, t), one for each form of the frame: F_k u^k is their power.
    constraints: expressions that stay zero, linear in u plus a term without u.
    principle: how the action is varied.
    hamel, lagrange: the two derivations, in exact elements.
    """

    frame: Frame
    lagrangian: sp.Expr
    forces: tuple[sp.Expr, ...]
    constraints: tuple[sp.Expr, ...]
    principle: str
    hamel: Hamel
    lagrange: Lagrange

    @property
    def velocities(self) -> tuple[sp.Symbol, ...]:
        """Quasi-velocities that change: all of them, or the free ones under constraints."""
        return tuple(self.hamel.bundle.symbols.velocities[i] for i in self.hamel.free)

    @property
    def time(self) -> sp.Symbol:
        """The symbol of the time."""
        return self.hamel.bundle.symbols.time

    @cached_property
    def momenta(self) -> tuple[sp.Expr, ...]:
        """p_i = dL/du^i, for all i; under constraints in the frame adapted to them."""
        return tuple(value.sympy for value in self.hamel.momenta)

    @cached_property
    def residuals(self) -> tuple[sp.Expr, ...]:
        """d/dt p_k - A_kj^i u^j p_i - E_k(L) - F_k, which vanish on a motion (Boltzmann, Hamel).

        There is one for each velocity that changes; u'^k are written u1dot, u2dot, ...
        """
        dots = self.hamel.bundle.symbols.accelerations
        residuals = []
        for k in self.hamel.free:
            pairs, rest = self.hamel.residuals[k]
            residuals.append(
                sp.Add(
                    *(value.sympy * dots[i] for i, value in pairs),
                    equation_text.by_powers(rest, self.velocities),
                )
            )
        return tuple(residuals)

    @cached_property
    def accelerations(self) -> tuple[sp.Expr, ...]:
        """Accelerations u'^k, one for each velocity that changes.

        If a denominator with angles does not factor, the acceleration is an unsimplified quotient.
        """
        values, moving = self.hamel.accelerations, self.velocities
        if values is None:
            return tuple(above.sympy / below.sympy for above, below in self.hamel.quotients)
        return tuple(equation_text.by_powers(value, moving) for value in values)

    @cached_property
    def rates(self) -> Mapping[str, sp.Expr]:
        """Name of a state -> its rate: q'^mu = E_i^mu u^i, then u'^k."""
        names = [symbol.name for symbol in (*self.frame.coordinates, *self.velocities)]
        rates = [equation_text.by_powers(value, self.velocities) for value in self.hamel.rates]
        return dict(zip(names, (*rates, *self.accelerations), strict=True))

    @cached_property
    def euler_lagrange(self) -> tuple[sp.Expr, ...]:
        """Euler-Lagrange equations; q'^mu and q''^mu are written phi1dot, phi1ddot.

        There is one for each coordinate, derived from L(q, e q', t) without use of `residuals`.
        Under constraints their right sides are the forces of reaction, otherwise zero.
        """
        return tuple(value.sympy for value in self.lagrange.residuals)

    @cached_property
    def agrees(self) -> bool | None:
        """Whether the equations in frame and coordinates agree exactly; None if undecided."""
        return self.lagrange.agrees(self.hamel)

    @cached_property
    def torsion_force(self) -> tuple[sp.Expr, ...]:
        """C_kj^i u^j p_i in the frame: a term of Hamilton's principle, absent in Kleinert's.

        With p_i = eta_ij u^j it is minus the torsion force 2 S_a^c_b q'^a q'^b.
        """
        hamilton = principle_named("closed_in_coordinates")
        image = principle_named("closed_in_image")
        frame, connection = self.hamel.bundle.frame, self.lagrange.connection
        whole = replace(self.hamel, coefficients=coefficients_of(frame, hamilton)).gyroscopic
        flat = replace(
            self.hamel, coefficients=coefficients_of(frame, image, connection)
        ).gyroscopic
        pairs = zip(whole, flat, strict=True)
        every = [(one - two).sympy for one, two in pairs]
        return tuple(every[k] for k in self.hamel.free)

    @cached_property
    def invariants(self) -> ConservedQuantities:
        """Conserved quantities f(q, u, t) by name, each proved by exact zero."""
        return conserved(self.hamel, self.frame, self.lagrange.bundle.frame)

    @cached_property
    def reactions(self) -> Mapping[str, sp.Expr]:
        """Forces of constraint, each by the name of the velocity that its constraint removes."""
        hamel, names = self.hamel, self.hamel.bundle.symbols.velocities
        if hamel.reactions is not None:
            return {names[k].name: value.sympy for k, value in hamel.reactions.items()}
        moving, reactions = dict(zip(hamel.free, self.accelerations, strict=True)), {}
        for k in hamel.fixed:
            pairs, rest = hamel.residuals[k]
            reactions[names[k].name] = sp.Add(*(x.sympy * moving[i] for i, x in pairs), rest.sympy)
        return reactions

    @cached_property
    def reduced(self) -> Reduced:
        """Rates of the velocities only; no coordinate may occur in them.

        Raises
        ------
        LagrangianError
            The rates of the velocities depend on coordinates.
        """
        return reduced(self.rates, self.invariants, self.frame.coordinates)

    def linearized(
        self, at: Mapping[object, object], parameters: Iterable[sp.Symbol | str] | None = None
    ) -> Linearization:
        """The equations to first order around a steady motion; see `geomtorsion.linearized`.

        at: the steady motion: name of a coordinate, velocity or parameter -> value.
        parameters: further names that may occur in texts there.

        Examples
        --------
        A top about its middle axis, which is unstable:

        >>> from geomtorsion.spaces import load
        >>> top = equations_of_motion(load("so3").frame, "(u1**2 + 2*u2**2 + 3*u3**2)/2")
        >>> top.linearized(at={"u2": 1}).eigenvalues.real.round(6).tolist()
        [0.57735, 0.0, -0.57735]
        """
        listed = None if parameters is None else [*self.hamel.bundle.frame.parameters, *parameters]
        return linearized(
            self.frame, self.lagrangian, list(self.forces), self.principle,
            list(self.constraints) or None, at=at, velocities=self.velocities,
            parameters=listed, connection=self.lagrange.connection,
        )  # fmt: skip

    @property
    def text(self) -> str:
        """The rates as text, one line each."""
        return equation_text.rate_text(self.rates)

    @property
    def latex(self) -> str:
        """The rates as aligned LaTeX."""
        return equation_text.rate_latex(
            self.rates, assumption_latex(self.frame, self.rates.values())
        )

    def _repr_latex_(self) -> str:
        return f"$${self.latex}$$"

    _repr_html_ = drawn_by("notebook_tables", "equations_html")

    def __str__(self) -> str:
        remark = assumption_of(self.frame, self.rates.values())
        return f"{self.text}\n{remark}" if remark else self.text

    def __repr__(self) -> str:
        where = f" on {self.frame.name}" if self.frame.name else ""
        return f"equations of motion{where}, {self.principle}:\n{self}"


def equations_of_motion(
    frame: FrameLike,
    lagrangian: str | int | sp.Expr | Element,
    forces: object = None,
    principle: str = "closed_in_coordinates",
    constraints: object = None,
    *,
    parameters: Iterable[sp.Symbol | str] | None = None,
    connection: ConnectionLike | None = None,
) -> EquationsOfMotion:
    """Equations of motion of any Lagrangian L(q, u, t) in the velocities of a frame.

    Equation
    --------
    d/dt p_k = A_kj^i u^j p_i + E_k^mu dL/dq^mu + F_k,  p_i = dL/du^i       (Boltzmann, Hamel)
    with A_kj^i = 2 S_kj^i of the frame for closed_in_coordinates    [FizievKleinert1994], (17);
    A = 0 for naive; for closed_in_image the torsion of the image is subtracted.

    Parameters
    ----------
    frame
        any real frame, with n one-forms.
    lagrangian
        expression or text in the coordinates, u1 ... un, t and parameters.
    forces
        F_k in the frame, n of them or a mapping k -> F_k (k from 0); they may depend on q, u, t.
    principle
        "closed_in_coordinates" (Hamilton, Poincare), "closed_in_image" (Kleinert) or "naive".
        Where L depends on q, closed_in_image takes dq^mu = E_i^mu dPhi^i, as Kleinert and Pelster
        do (gr-qc/9605028); with a gap at the end the equations would depend on the future.
    constraints
        expressions a_i(q) u^i + c(q, t) that stay zero (rolling, knife edge, driven wheels). The
        frame is adapted to them; each removes a velocity, the last of constant coefficient if any.
    parameters
        further names or symbols that may occur. In sympy expressions all other symbols are
        parameters unless a list is given; a text may use only known and listed names.
    connection
        for closed_in_image: its torsion is the torsion of the image; None: the Cartan connection.

    Raises
    ------
    LagrangianError, ExpressionError
        An unknown symbol or text that cannot be read; or a complex frame.
    KineticMatrixError
        The accelerations are not determined; the message names them.
    ConstraintError
        A constraint is not linear in u, or follows from the others.
    ShapeError
        The number of forces differs from the number of forms.
    UnknownNameError
        No principle has this name; the message names the nearest.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.spaces import load
    >>> u1, u2, u3, I1, I2, I3 = sp.symbols("u1 u2 u3 I1 I2 I3")
    >>> kinetic = (I1 * u1**2 + I2 * u2**2 + I3 * u3**2) / 2
    >>> euler = equations_of_motion(load("so3").frame, kinetic)
    >>> print(*euler.residuals, sep="\\n")
    I1*u1dot + u2*u3*(-I2 + I3)
    I2*u2dot + u1*u3*(I1 - I3)
    I3*u3dot + u1*u2*(-I1 + I2)
    >>> euler.agrees
    True
    >>> equations_of_motion(load("so3").frame, kinetic, principle="naive").accelerations
    (0, 0, 0)
    """
    chosen = principle_named(principle)
    frame, connection = validation.checked_frame(frame, connection)
    n = frame.dimension
    pushes = validation.force_entries(forces, n)
    fixed = validation.constraint_entries(constraints, n)
    read = validation.expressions(frame, [("lagrangian", lagrangian), *pushes, *fixed], parameters)
    energy, loads, conditions = read[0], tuple(read[1 : n + 1]), tuple(read[n + 1 :])
    bundle = bundle_over(frame, read)
    try:
        hamel = hamel_of(bundle, energy, loads, conditions, chosen, connection)
        _ = hamel.matrix  # a singular kinetic matrix is refused here, not later
    except LimitError as error:
        raise LimitError(
            f"{error}. For small motions around a steady one, gt.linearized(..., at={{...}}) needs "
            "no equations that are written out"
        ) from None
    lagrange = Lagrange(bundle, energy, loads, chosen, connection)
    return EquationsOfMotion(frame, energy, loads, conditions, principle, hamel, lagrange)


def conserved_quantities(
    frame: FrameLike,
    lagrangian: str | int | sp.Expr | Element,
    forces: object = None,
    principle: str = "closed_in_coordinates",
    constraints: object = None,
    *,
    parameters: Iterable[sp.Symbol | str] | None = None,
    connection: ConnectionLike | None = None,
) -> ConservedQuantities:
    """Conserved quantities f(q, u, t) by name: the `invariants` of the equations of motion.

    The search covers this ansatz, which `ansatz` of the result lists in detail:

    - the energy, and Casimirs;
    - momenta p_k xi^k of coordinates, of legs and of right-invariant fields on a Lie group;
    - momenta of fields xi = sum c f(q) E_k with constants c and functions f from products of 1, x,
      cos(x), sin(x), as they fit each coordinate x; only 1 and x where there would be too many;
    - momenta of fields xi = sum c f(q) d_mu with polynomials f of degree 2;
    - sums of c f(q) p_k p_l with terms f of the coframe, such as Carter's constant.

    All rational combinations in it are found; each is exactly conserved. Others may exist.

    Parameters
    ----------
    frame, lagrangian, forces, principle, constraints, parameters, connection
        as in `equations_of_motion`.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> conserved_quantities(load("flat_polar").frame, "(u1**2 + u2**2)/2")
    energy: u1**2/2 + u2**2/2
    momentum of phi: r*u2
    killing 1: u1*sin(phi) + u2*cos(phi)
    killing 2: u1*cos(phi) - u2*sin(phi)
    searched:
      energy p_k u^k - L
      sums of c*p(xi), the momenta along coordinates and legs
      sums of c*f(q)*p_k, f a product of one of each (1, r) (1, phi, cos(phi), sin(phi))
      sums of c*f(q)*p(q), the momenta of coordinates, f of degree 2 in r, phi
      sums of c*f(q)*p_k*p_l, f one of (1, r**2)

    Carter's constant of Kerr's space, in Carter's tetrad:

    >>> found = conserved_quantities(load("kerr").frame, "(-u1**2 + u2**2 + u3**2 + u4**2)/2")
    >>> found["killing tensor 1"]
    a**2*u1**2*cos(theta)**2 - a**2*u2**2*cos(theta)**2 + r**2*u3**2 + r**2*u4**2
    """
    equations = equations_of_motion(
        frame, lagrangian, forces, principle, constraints,
        parameters=parameters, connection=connection,
    )  # fmt: skip
    return equations.invariants


@dataclass(frozen=True, eq=False)
class Lagrange:
    """d/dt P_mu - dL/dq^mu + X_mu nu^la q'^nu P_la - Q_mu, P_mu = dL/dq'^mu, from L(q, e q', t).

    X is the torsion that the principle subtracts: zero for Hamilton's principle.

    bundle: the given frame, not adapted to constraints.
    lagrangian, forces: in q, u, t; forces F_k in the frame, Q_mu = e^k_mu F_k.
    principle, connection: how the action is varied.
    """

    bundle: TangentBundle
    lagrangian: sp.Expr
    forces: tuple[sp.Expr, ...]
    principle: Principle
    connection: Connection | None

    @cached_property
    def velocities(self) -> dict[sp.Symbol, sp.Expr]:
        """u^i = e^i_mu q'^mu, written out."""
        symbols = self.bundle.symbols
        velocities = {}
        for i, row in enumerate(self.bundle.frame.coframe.components.rows):
            terms = [value.sympy * symbols.rates[mu] for mu, value in row]
            velocities[symbols.velocities[i]] = sp.Add(*terms)
        return velocities

    def _read(self, where: str, expression: sp.Expr) -> Element:
        """An expression in q, u, t read with coordinate velocities instead of u."""
        return self.bundle.frame.read([(where, expression.xreplace(self.velocities))])[0]

    @cached_property
    def residuals(self) -> tuple[Element, ...]:
        """One for each coordinate; they vanish on the motions without constraints."""
        bundle, symbols, field = self.bundle, self.bundle.symbols, self.bundle.field
        field.declare((*symbols.rates, *symbols.second_rates))
        rates = [field.symbol(symbol) for symbol in symbols.rates]
        second = [field.symbol(symbol) for symbol in symbols.second_rates]
        energy = self._read("lagrangian", self.lagrangian)
        momenta = [energy.diff(symbol) for symbol in symbols.rates]
        pushes = [self._read(f"forces[{k}]", value) for k, value in enumerate(self.forces)]
        terms: list[list] = []
        for momentum, symbol in zip(momenta, symbols.coordinates, strict=True):
            row = [(1, bundle.change(momentum, rates)), (-1, energy.diff(symbol))]
            pairs = zip(symbols.rates, second, strict=True)
            terms.append(row + [(1, momentum.diff(rate), value) for rate, value in pairs])
        for (a, b, c), value in self._torsion().items():
            terms[a].append((1, value, rates[b], momenta[c]))
        for k, row in enumerate(bundle.frame.coframe.components.rows):
            for mu, value in row:
                terms[mu].append((-1, value, pushes[k]))
        return tuple(field.sum(row) for row in terms)

    def _torsion(self) -> HamelCoefficients:
        """X_mu nu^la, the term that the principle subtracts."""
        principle, frame = self.principle, self.bundle.frame
        if principle.frame_curl and not principle.image_torsion:
            return {}
        connection = self.connection if principle.image_torsion else None
        return torsion_over(frame, connection).components.nonzero

    def agrees(self, hamel: Hamel) -> bool | None:
        """Whether E_k^mu times these equals the equations in quasi-velocities, for free k.

        Decided by exact zero, after q' = E u and q'' = d/dt (E u) are inserted.
        """
        field, symbols = hamel.bundle.field, hamel.bundle.symbols
        field.declare(symbols.accelerations)
        moving = {i: field.symbol(symbols.accelerations[i]) for i in hamel.free}
        table = dict(zip(symbols.rates, (rate.sympy for rate in hamel.rates), strict=True))
        for symbol, rate in zip(symbols.second_rates, hamel.rates, strict=True):
            terms = [(1, value, rate.diff(symbols.velocities[i])) for i, value in moving.items()]
            change = field.sum([(1, hamel.bundle.change(rate, hamel.rates)), *terms])
            table[symbol] = change.sympy
        covector = field.read_all(
            [("equation", value.sympy.xreplace(table)) for value in self.residuals]
        )
        verdicts = []
        for k in hamel.free:
            pairs, rest = hamel.residuals[k]
            expected = field.sum([(1, rest), *((1, value, moving[i]) for i, value in pairs)])
            columns = hamel.bundle.frame.legs.components.columns[k]
            terms = [(1, value, covector[mu]) for mu, value in columns]
            verdicts.append(field.sum([*terms, (-1, expected)]).is_zero)
        if False in verdicts:
            return False
        return None if None in verdicts else True

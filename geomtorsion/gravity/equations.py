"""Equations: three formulas give the field equations of any Lagrangian and connection."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion import checks
from geomtorsion.caching import cached_property
from geomtorsion.displays import drawn_by
from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, Truncated, TruncatedField
from geomtorsion.exclusive import exclusive
from geomtorsion.geometry import Connection, Frame, IdentityCheck, Tensor, antisymmetric, at_home
from geomtorsion.geometry.connections import ConnectionLike, as_connection
from geomtorsion.gravity.fields import HALF, FrameFields, Index, Terms
from geomtorsion.gravity.fluids import Fluid
from geomtorsion.gravity.geometries import check_geometry, listed
from geomtorsion.gravity.identities import rotations, translations
from geomtorsion.gravity.invariants import INVARIANTS, Scalars
from geomtorsion.gravity.lagrangian import Lagrangian, Reading, known_as, read
from geomtorsion.gravity.matter import MatterField, numbered
from geomtorsion.gravity.momenta import Momenta
from geomtorsion.gravity.naming import with_names
from geomtorsion.gravity.reduction import Reduction, reduced
from geomtorsion.gravity.residuals import Sources
from geomtorsion.gravity.vocabulary import Vocabulary, declared_constants, meanings


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class FieldEquations:
    """Field equations of a Lagrangian: the expressions that vanish on a solution.

    connections: the connections over one frame.
    lagrangian: the theory.
    matter: matter fields and fluids.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> from geomtorsion import gravity
    >>> hole = gt.spaces.load("schwarzschild").frame
    >>> gravity.equations(gt.cartan(hole), gravity.tegr).E.is_zero
    True
    """

    connections: tuple[Connection, ...]
    lagrangian: Lagrangian
    matter: tuple[MatterField | Fluid, ...] = ()

    _repr_html_ = drawn_by("field_equations", "field_equations_html")

    def __repr__(self) -> str:
        names = ", ".join(one.name for one in self.connections)
        constants = ", constants: " + " ".join(self.constants) if self.constants else ""
        return f"field equations of {self.lagrangian!r} ({names}){constants}"

    @property
    def frame(self) -> Frame:
        """The frame of all connections."""
        return self.connections[0].frame

    # -- the Lagrangian ------------------------------------------------------------------------

    @cached_property
    def _scalars(self) -> tuple[Scalars, ...]:
        return tuple(
            Scalars(FrameFields(one, self._stays_metric(number)))
            for number, one in enumerate(self.connections)
        )

    def _stays_metric(self, number: int) -> bool:
        """Whether a connection is metric, and is varied among metric connections only."""
        connection, n = self.connections[number], self.frame.dimension
        if connection.kind == "levi-civita":
            return True
        if self.lagrangian.geometry == "metric-affine":
            return False
        if connection.kind != "general":
            return True
        own = (self._meanings.get(name) for name in self._named.symbols.values())
        entries = [INVARIANTS[one[1]] for one in own if one is not None and one[0] == number]
        if any(entry.has_nonmetricity(n) for entry in entries):
            return False
        return connection.metric_compatible is True

    @cached_property
    def _meanings(self) -> dict[str, tuple[int, str]]:
        return meanings(self.connections)

    @cached_property
    def _matter_names(self) -> dict[str, tuple[MatterField, str]]:
        return {name: (one, name) for one in self._fields for name in one.names}

    def check_names(self) -> None:
        """Raise an error for unknown names in the Lagrangian."""
        _ = self._named

    @cached_property
    def _named(self) -> Reading:
        frame, fields = self.frame, self._fields
        vocabulary = Vocabulary(
            frame,
            self.connections,
            (*self._meanings, *self._matter_names),
            {one: field.symbol for field in fields for one in field.parts(frame)},
            {one: x.symbol for x in fields if (one := x.function(frame)) is not None},
            declared_constants(self.lagrangian.constants),
        )
        reading = read(self.lagrangian, vocabulary)
        occurring = set(reading.symbols.values())
        for field in fields:
            if occurring.isdisjoint(field.names):
                raise GravityError(
                    f"matter: expected a Lagrangian with {' or '.join(field.names)}, got "
                    f"{checks.cut(str(self.lagrangian.expression))}. Add a term of the "
                    f"{field.kind} {field.symbol} to the Lagrangian, or omit the field."
                )
        return reading

    @property
    def constants(self) -> tuple[str, ...]:
        """Names of the constants that the Lagrangian introduces, sorted."""
        return self._named.constants

    @cached_property
    def _reading(self) -> Reading:
        """The Lagrangian with the values of all its names."""
        reading = self._named
        for symbol, name in reading.symbols.items():
            reading.values[symbol] = self._value(name)
        return reading

    def _value(self, name: str) -> Element:
        """The value of a name in the Lagrangian."""
        if name in self._matter_names:
            field, own = self._matter_names[name]
            return field.value(self.frame, own)
        number, invariant = self._meanings[name]
        return self._scalars[number].value(invariant)

    @cached_property
    def scalars(self) -> dict[str, sp.Expr]:
        """The invariants that occur in the Lagrangian, by name."""
        values = {name: self._reading.values[x] for x, name in self._reading.symbols.items()}
        return {name: self.frame.written(value) for name, value in values.items()}

    @property
    def expression(self) -> sp.Expr:
        """The Lagrangian in the names of its invariants."""
        return self._named.expression

    def written(self, element: Element) -> sp.Expr:
        """An element as it is printed, with unknown functions of an invariant: f(T), f'(T).

        In an expanded frame they are taken at order zero: f(T_0).

        Examples
        --------
        >>> import geomtorsion as gt
        >>> cosmos = gt.spaces.load("frw_flat").frame
        >>> equations = gt.gravity.equations(gt.cartan(cosmos), "f(T)")
        >>> equations.written(equations.E.element(0, 0))
        (a(t)**2*f(T) - 12*Derivative(a(t), t)**2*Derivative(f(T), T))/a(t)**2
        """
        functions = {one.func for one in self.expression.atoms(AppliedUndef)}
        field = self.frame.field
        if isinstance(field, TruncatedField) and not isinstance(element, Truncated):
            element = field.raised(element)
        return with_names(self.frame.written(element), self._places, functions)

    @cached_property
    def _places(self) -> Mapping[str, sp.Expr]:
        """Arguments of unknown functions by name: T, or T_0 for a series at order zero."""
        reading, field = self._reading, self.frame.field
        if not isinstance(field, TruncatedField):
            return self.scalars
        series = {f"{name}_0": reading.values[x] for x, name in reading.symbols.items()}
        return {
            name: self.frame.written(field.raised(value.parts[0]))
            for name, value in series.items()
            if isinstance(value, Truncated)
        }

    def scalar(self, name: str) -> Tensor:
        """An invariant by its name in the Lagrangian, whether it occurs there or not.

        Raises
        ------
        GravityError
            There is no such invariant here.
        """
        names = [*self._meanings, *self._matter_names]
        checks.known_name(name, names, "invariant", GravityError)
        return self.frame.scalar(lambda: self._value(name), name, "invariant")

    @cached_property
    def L(self) -> Tensor:
        """The Lagrangian on these fields, rank 0."""
        reading = self._reading
        return self.frame.scalar(lambda: reading.element(reading.expression), "L", "Lagrangian")

    @cached_property
    def _slopes(self) -> dict[str, Element]:
        """dL/dI for every name I that occurs."""
        reading = self._reading
        slopes = {}
        for symbol, name in reading.symbols.items():
            slope = reading.expression.diff(symbol)
            if slope != 0:
                slopes[name] = reading.element(slope)
        return slopes

    @cached_property
    def momenta(self) -> tuple[Momenta, ...]:
        """P = dL/dT, Z = dL/dR, N = dL/dQ of each connection."""
        weights: list[dict[str, Element]] = [{} for _ in self.connections]
        for name, slope in self._slopes.items():
            if name in self._meanings:
                number, invariant = self._meanings[name]
                own = weights[number]
                own[invariant] = own[invariant] + slope if invariant in own else slope
        return tuple(map(Momenta, self._scalars, weights))

    @property
    def P(self) -> Tensor:
        """P^{ab}_c = dL/dT_ab^c of the first connection, slots UUD."""
        return self.momenta[0].P

    @property
    def Z(self) -> Tensor:
        """Z^{abi}_j = dL/dR_abi^j of the first connection, slots UUUD."""
        return self.momenta[0].Z

    @property
    def N(self) -> Tensor:
        """N^{aij} = dL/dQ_aij of the first connection, slots UUU."""
        return self.momenta[0].N

    # -- the equations -------------------------------------------------------------------------

    @cached_property
    def E(self) -> Tensor:
        """E_i^n = (1/e) d(eL)/d e^i_n, slots DU: the equation of the coframe."""
        frame, field = self.frame, self.frame.field
        divergences = [
            one.fields.divergence(one.P, paired=True).components.get for one in self.momenta
        ]
        moved = [
            one.moved.lowered().components.get for one in self.momenta if one.fields.is_riemannian
        ]
        sources = [one.coframe_source(self.connections[0]) for one in self._fluids]

        def rule(index: Index) -> Element:
            i, n = index
            terms: Terms = [(1, self.L.element())] if i == n else []
            for one, divergence in zip(self.momenta, divergences, strict=True):
                terms += one.coframe_terms(i, n)
                terms.append((-2, divergence((n, i))))
            terms += [term for one in self._fields for term in one.coframe_terms(self, i, n)]
            terms += [(1, source.components.get(index)) for source in sources]
            return field.sum(terms)

        def lower(index: Index) -> Element:
            i, n = index
            terms: Terms = [(1, own((i, n)))]
            return field.sum(terms + [(1, get((n, i))) for get in moved])

        bare = Tensor(frame, "DU", rule, (), "E", "coframe equation")
        if not moved:
            return bare
        own = bare.lowered().components.get
        return Tensor(frame, "DD", lower, (), "E", "coframe equation").raised(1)

    @cached_property
    def _fields(self) -> list[MatterField]:
        """Matter fields with the numbers by which their names differ."""
        return [one for one in numbered(self.matter) if isinstance(one, MatterField)]

    @property
    def _fluids(self) -> list[Fluid]:
        return [one for one in self.matter if isinstance(one, Fluid)]

    @cached_property
    def _varied(self) -> tuple[int, ...]:
        """The connections with an equation of their own: all but the Levi-Civita ones."""
        return tuple(k for k, one in enumerate(self.connections) if one.kind != "levi-civita")

    @cached_property
    def connection_equations(self) -> tuple[Tensor, ...]:
        """C of each connection; zero for the metric's own, which is not varied separately."""
        tensors = []
        for number, momenta in enumerate(self.momenta):
            total = momenta.C if number in self._varied else Tensor(self.frame, "UUD", {})
            if number == 0:
                for fluid in self._fluids:
                    total = total + fluid.connection_source(self.connections[0])
            tensors.append(
                Tensor(
                    self.frame, "UUD", total.components, total.symmetry, "C", "connection equation"
                )
            )
        return tuple(tensors)

    @property
    def C(self) -> Tensor:
        """C^{ni}_j = (1/e) d(eL)/d omega_ni^j, slots UUD: the equation of the first connection.

        Antisymmetric in ij for a metric connection, which is varied among metric connections,
        unless the Lagrangian contains nonmetricity or its geometry is "metric-affine". Zero for
        the Levi-Civita connection, whose variation is part of E. The connection of a teleparallel
        theory has no equation besides the antisymmetric part of E.
        """
        return self.connection_equations[0]

    @cached_property
    def M(self) -> Tensor:
        """2 M_ij = E_ji + D_n C^n_ij, slots DD: the metric equation, which follows from both."""
        frame = self.frame
        lower = self.E.lowered(1).components.get
        turned = [get.lowered().components.get for get in self._turned]

        def rule(index: Index) -> Element:
            i, j = index
            terms = [(HALF, get(index)) for get in turned]
            return frame.field.sum([(HALF, lower((j, i))), *terms])

        return Tensor(frame, "DD", rule, (), "M", "metric equation")

    @cached_property
    def _turned(self) -> tuple[Tensor, ...]:
        """(1/e) D_n(e C^{ni}_j), slots UD, of each connection."""
        pairs = zip(self.momenta, self.connection_equations, strict=True)
        return tuple(one.fields.divergence(c) for one, c in pairs)

    @cached_property
    def antisymmetric(self) -> Tensor:
        """E_[ij], slots DD: for a teleparallel theory the equation of the spin connection.

        Where it does not vanish the spin connection does not belong to the coframe. Where it
        vanishes the spin connection may still be wrong.
        """
        lower = self.E.lowered(1).components.get

        def rule(index: Index) -> Element:
            i, j = index
            return self.frame.field.sum([(HALF, lower((i, j))), (-HALF, lower((j, i)))])

        return Tensor(self.frame, "DD", rule, antisymmetric(2), "E", "antisymmetric part of E")

    @cached_property
    def tensors(self) -> dict[str, Tensor]:
        """E and E_[ij]; C where a connection is varied on its own, M where it is not metric."""
        metric = [one.fields.is_metric for one in self._scalars]
        tensors = {"E": self.E, "E_[ij]": self.antisymmetric}
        kinds = {one.kind for one in self.connections}
        if kinds - {"cartan", "levi-civita"} or not all(metric):
            tensors["C"] = self.C
        if not all(metric):
            tensors["M"] = self.M
        return tensors

    @cached_property
    def matter_equations(self) -> dict[str, Tensor]:
        """(1/e) d(eL)/d(field) of each matter field, by its name."""
        return {one.symbol: one.equation(self) for one in self._fields}

    def slope(self, name: str) -> Element:
        """dL/dI of a name in the Lagrangian, zero where it does not occur."""
        return self._slopes.get(name, self.frame.field.zero)

    def reduce(self, variable: object, conditions: object = ()) -> Reduction:
        """First-order equations for unknown functions of one variable, with constraints.

        variable: the coordinate on which all unknown functions depend, such as "t" or "r".
        conditions: further equations: an equation of state "p = rho/3", a gauge "N = 1".

        Raises
        ------
        GravityError
            The equations leave a function free, contradict each other, or depend on more.
        """
        parts = self.E, self.M, self.connection_equations, self.matter_equations
        sources = Sources(self.connections, self.matter, self.momenta[0].fields, *parts)
        return reduced(sources, variable, conditions)

    # -- identities ----------------------------------------------------------------------------

    def identities(self) -> list[IdentityCheck]:
        """Noether identities of translations and of rotations of the frame, checked exactly.

        They hold for every coframe and connection where the Lagrangian has no given function of
        the coordinates and no fluid in it.

        Equation
        --------
        D_n(e E_i^n)/e = T_in^j E_j^n + R_ink^j C^{nk}_j + Q_ijk M^jk + (matter),  M_[ij] = 0
        """
        if self._fluids:
            raise GravityError(
                "identities: expected a Lagrangian without a fluid, got a fluid, whose equations "
                "of motion are not derived from it. Omit the fluid."
            )
        parts = [
            (one.fields, C, turned)
            for one, C, turned in zip(
                self.momenta, self.connection_equations, self._turned, strict=True
            )
        ]

        def matter(i: int) -> Terms:
            return [term for one in self._fields for term in one.noether_terms(self, i)]

        return [translations(self.E, self.M, parts, matter), rotations(self.M)]


def equations(
    connections: ConnectionLike | Iterable[ConnectionLike],
    lagrangian: Lagrangian | str | sp.Expr,
    matter: MatterField | Fluid | Iterable[MatterField | Fluid] = (),
    *,
    constants: str | sp.Symbol | Iterable[str | sp.Symbol] = (),
) -> FieldEquations:
    """Field equations of a Lagrangian on given connections, exactly.

    Equation
    --------
    E_i^n = L E_i^n - 2 P_j^{nb} T_ib^j - 2 Z^{nbk}_j R_ibk^j - N^{njk} Q_ijk - (2/e) D_m(e P_i^mn)
    C^{ni}_j = 2 P^{ni}_j - 2 N^{ni}_j - (2/e) D_m(e Z^{mni}_j)

    Parameters
    ----------
    connections
        One connection, or several over one frame. A space, or the name of a shipped one,
        contributes its own connection, or the Cartan connection if it has none. Names of
        invariants of the second and third connection end in _2, _3; names of the Levi-Civita
        connection beside others end in bar.
    lagrangian
        Text, a sympy expression in `gravity.names`, or a theory such as `gravity.tegr`. A new name
        that multiplies invariants is a constant; functions such as f(T) may be unknown.
    matter
        Matter fields, whose names occur in the Lagrangian, and fluids, which are sources. A second
        scalar field is X_2 and phi_2, a second Maxwell field F2_2.
    constants
        Names of other constants, "alpha beta". Lambda needs no declaration.

    Raises
    ------
    GravityError
        The Lagrangian has an unknown name, a matter field does not occur in it, or the connection
        is not of the theory.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> from geomtorsion import gravity
    >>> cosmos = gt.spaces.load("frw").frame
    >>> gravity.equations(gt.levi_civita(cosmos), "R").antisymmetric.is_zero
    True
    """
    message = "{subject}: expected one connection or a list of connections, got {value}."
    own = listed(connections, ConnectionLike, "connections", message)
    several = [as_connection(one, "connections", GravityError) for one in own]
    if not several:
        raise GravityError(
            "equations: expected a connection, got an empty list. Give gt.cartan(frame) or another."
        )
    over_one = [at_home(several[0].frame, connection) for connection in several]
    several = [connection for connection in over_one if connection is not None]
    if len(several) < len(over_one):
        raise GravityError(
            "equations: expected connections over one frame, got different frames. Make all "
            "connections over equal frames."
        )
    if sum(one.kind == "levi-civita" for one in several) > 1:
        raise GravityError(
            "equations: expected the Levi-Civita connection once, got it twice. Give it once."
        )
    theory = known_as(lagrangian)
    declared = (*declared_constants(theory.constants), *declared_constants(constants))
    theory = replace(theory, constants=declared)
    check_geometry(theory, several)
    message = (
        "{subject}: expected gravity.scalar_field, gravity.maxwell, gravity.fluid or "
        "gravity.weyssenhoff, or a list of these, got {value}."
    )
    sources = listed(matter, MatterField | Fluid, "matter", message)
    for source in sources:
        source.check(several[0].frame)
    result = FieldEquations(tuple(several), theory, tuple(sources))
    # Reads the Lagrangian, so that a wrong name is refused here.
    result.check_names()
    return result

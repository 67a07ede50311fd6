"""Equations: three formulas give the field equations of any Lagrangian and connection."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, Truncated, TruncatedField
from geomtorsion.geometry import Connection, Frame, IdentityCheck, Tensor, at_home
from geomtorsion.geometry.connections import ConnectionLike, as_connection
from geomtorsion.gravity.numeric.equation_values import EquationValues, equations_at
from geomtorsion.gravity.numeric.grid_equations import equations_on_grid
from geomtorsion.gravity.reduced.reduction import Reduction
from geomtorsion.gravity.theory.catalogue import Catalogue
from geomtorsion.gravity.theory.content import Content
from geomtorsion.gravity.theory.distinct import distinct
from geomtorsion.gravity.theory.equation_lines import Lines, distinct_components
from geomtorsion.gravity.theory.fields import (
    HALF,
    Index,
    Terms,
    antisymmetric_part,
    symmetric_part,
    turning,
)
from geomtorsion.gravity.theory.geometries import check_geometry, listed
from geomtorsion.gravity.theory.hypermomentum import Source
from geomtorsion.gravity.theory.identities import rotations, translations
from geomtorsion.gravity.theory.invariants import Invariant
from geomtorsion.gravity.theory.lagrangian import Lagrangian, Reading, known_as
from geomtorsion.gravity.theory.matter import MatterField, numbered
from geomtorsion.gravity.theory.momenta import Momenta
from geomtorsion.gravity.theory.naming import Call, calls_of, jet_names, shorthand
from geomtorsion.gravity.theory.operator import LinearOperator, operator
from geomtorsion.gravity.theory.reducing import reduced
from geomtorsion.gravity.theory.residuals import Sources
from geomtorsion.gravity.theory.unknown_terms import terms_of
from geomtorsion.gravity.theory.variation import Variation
from geomtorsion.gravity.theory.vocabulary import declared_constants
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.hints import attribute_hints

# Parts of the coframe equation by the names that `readable` has for them.
DIVIDED = {"E": "E", "E_ij": "E_lower", "E_(ij)": "symmetric", "E_[ij]": "antisymmetric"}


@attribute_hints(
    is_zero="equations.E.is_zero",
    holds="equations.E.is_zero",
    solve='gt.gravity.solve(equations, "t", 10, start)',
)
@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class FieldEquations:
    """Field equations of a Lagrangian: the expressions that vanish on a solution.

    connections: the connections over one frame.
    lagrangian: the theory.
    matter: matter fields and fluids.

    All tensors have leg slots, written in capitals; in coordinates: `.in_coordinates()`.
    `E[0, 0]` is exact in the coordinates; `print(E)` and LaTeX write f_T for df/dT, and `readable`
    gives components in the names of invariants.

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
    matter: tuple[MatterField | Source, ...] = ()

    _repr_html_ = drawn_by("field_equations", "field_equations_html")

    def __repr__(self) -> str:
        names = ", ".join(one.name for one in self.connections)
        constants = ", constants: " + " ".join(self.constants) if self.constants else ""
        zeros = "".join(f"; {remark}" for remark in self.remarks)
        return f"field equations of {self.lagrangian!r} ({names}){constants}{zeros}"

    def __str__(self) -> str:
        return "\n".join([repr(self), *self._lines.text()])

    def to_latex(self) -> str:
        r"""Invariants and the equations that differ, as an `aligned` environment.

        `sympy.latex(equations)` gives the same.

        Examples
        --------
        >>> import geomtorsion as gt
        >>> cosmos = gt.spaces.load("frw_flat").frame
        >>> "f_{TT}" in gt.gravity.equations(gt.cartan(cosmos), "f(T)").to_latex()
        True
        """
        return self._lines.latex()

    def _latex(self, _: object) -> str:
        return self.to_latex()

    @property
    def _lines(self) -> Lines:
        every = {x: one for x, one in self.tensors.items() if x != "E_[ij]"}
        equations = distinct_components(every | self.matter_equations, self._shown)
        return Lines(self.scalars, equations, self.matter_equations)

    @property
    def frame(self) -> Frame:
        """The frame of all connections."""
        return self.connections[0].frame

    # -- the Lagrangian ------------------------------------------------------------------------

    @cached_property
    def _catalogue(self) -> Catalogue:
        return Catalogue(self.connections, self.lagrangian.invariants, self._fields)

    @cached_property
    def _content(self) -> Content:
        metric = tuple(self._stays_metric(number) for number in range(len(self.connections)))
        return Content(self._catalogue, metric)

    def _stays_metric(self, number: int) -> bool:
        """Whether a connection is metric, and is varied among metric connections only."""
        connection = self.connections[number]
        if connection.kind == "levi-civita":
            return True
        if self.lagrangian.geometry == "metric-affine":
            return False
        if connection.kind != "general":
            return True
        if self._catalogue.has_nonmetricity(self._named.symbols.values(), number):
            return False
        return connection.metric_compatible is True

    def is_metric(self, number: int) -> bool:
        """Whether a connection is metric, and is varied among metric connections only."""
        return self._content.metric[number]

    @property
    def invariant_names(self) -> tuple[str, ...]:
        """Names of the invariants that occur in the Lagrangian."""
        return tuple(self._named.symbols.values())

    def at(self, point: Mapping[Any, Any], samples: SampledFrame | None = None) -> EquationValues:
        """E, C, M and the matter equations as numbers at a point, without symbolic expressions.

        The formulas run on power series of the frame at the point, in ball arithmetic, so that a
        frame of long expressions takes as long as a short one, and errors are bounds.

        Parameters
        ----------
        point
            Value of each coordinate, parameter and constant of the Lagrangian, by symbol or name;
            a float has its binary value. Lists and arrays of one shape have an entry for each
            point.
        samples
            A coframe on a grid, which replaces the coframe of these equations. The values belong to
            its nodes, and point holds constants only.

        Raises
        ------
        CoordinateError, ShapeError
            A name is unknown, a value is not finite, or lists have no common shape.
        MissingValueError
            A symbol has no value.
        SingularPointError
            The frame or a function has no power series at the point.
        GravityError
            The Lagrangian or the frame has an unknown function; the frame is complex or expanded.

        Examples
        --------
        >>> import geomtorsion as gt
        >>> frame = gt.Frame("t x", [["1 + x*t", "t**2"], ["x**3", "2 + t"]], "-+")
        >>> equations = gt.gravity.equations(gt.cartan(frame), "T1 + c*T1**2")
        >>> values = equations.at({"t": 0, "x": 1, "c": 2})
        >>> values.E.round(3).tolist(), values.error < 1e-13
        ([[-22.0, 14.0], [-138.0, -298.0]], True)
        """
        if samples is not None:
            return equations_on_grid(cast(Any, self), samples, point)
        return equations_at(cast(Any, self), point)

    def check_names(self) -> None:
        """Raise an error for unknown names in the Lagrangian."""
        _ = self._named

    def check_presence(self) -> None:
        """Refuse a Lagrangian whose invariants vanish for all connections of these kinds."""
        names = list(self._named.symbols.values())
        if names and len(self._absent) == len(names):
            name, (kind, owners) = next(iter(self._absent.items()))
            raise GravityError(
                f"lagrangian: expected an invariant that this connection has, got {name}, which "
                f"vanishes for every {kind} connection: this Lagrangian has no field equation. "
                f"Give {owners}."
            )

    @cached_property
    def _absent(self) -> dict[str, tuple[str, str]]:
        """Invariant -> the kind of connection for which it vanishes, and others that have it."""
        kinds = {name: self._catalogue.absent(name) for name in self._named.symbols.values()}
        return {name: kind for name, kind in kinds.items() if kind is not None}

    @property
    def remarks(self) -> list[str]:
        """Sentences about invariants that vanish for all connections of these kinds.

        Examples
        --------
        >>> import geomtorsion as gt
        >>> cosmos = gt.spaces.load("frw_flat").frame
        >>> gt.gravity.equations(gt.cartan(cosmos), "R").remarks
        ['R vanishes for every Cartan connection']
        """
        kinds = {
            name: self._catalogue.absent(name, varied=False)
            for name in self._named.symbols.values()
        }
        return [
            f"{name} vanishes for every {kind[0]} connection"
            for name, kind in kinds.items()
            if kind
        ]

    @cached_property
    def _named(self) -> Reading:
        return self._catalogue.read(self.lagrangian)

    @property
    def constants(self) -> tuple[str, ...]:
        """Names of the constants that the Lagrangian introduces, sorted."""
        return self._named.constants

    @cached_property
    def _reading(self) -> Reading:
        """The Lagrangian with the values of all its names."""
        reading = self._named
        for symbol, name in reading.symbols.items():
            reading.values[symbol] = self._content.value(name)
        return reading

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
        field = self.frame.field
        if isinstance(field, TruncatedField) and not isinstance(element, Truncated):
            element = field.raised(element)
        names = jet_names(field.generators, self._calls)
        return self.frame.written(element).xreplace(names)

    @cached_property
    def _calls(self) -> list[Call]:
        """Calls of unknown functions, for a series at order zero with arguments such as T_0."""
        return calls_of(self._reading, self.frame.field)

    @cached_property
    def terms(self) -> dict[sp.Expr, Tensor]:
        """E as a sum of unknown functions times tensors: f(T), f'(T), f''(T) times T', ...

        The key 1 belongs to the rest, and is the only one where the Lagrangian has no unknown
        function. In an expanded frame, E is not divided.

        Examples
        --------
        >>> import geomtorsion as gt
        >>> cosmos = gt.spaces.load("frw_flat").frame
        >>> terms = gt.gravity.equations(gt.cartan(cosmos), "f(T)").terms
        >>> for unknown, tensor in terms.items():
        ...     print(unknown, tensor[1, 1])
        f(T) 1
        Derivative(f(T), T) -4*(a(t)*Derivative(a(t), (t, 2)) + 2*Derivative(a(t), t)**2)/a(t)**2
        Derivative(T(t), t)*Derivative(f(T), (T, 2)) -4*Derivative(a(t), t)/a(t)
        """
        if isinstance(self.frame.field, TruncatedField) or not self._calls:
            return {sp.S.One: self.E}
        terms = terms_of(self._reading, self._content)
        rest = terms.get(sp.S.One, Tensor(self.frame, "DU", {}))
        sources = (one.coframe_source(self.connections[0]) for one in self._fluids)
        return {**terms, sp.S.One: sum(sources, rest)} if self._fluids else terms

    def readable(self, name: str, *index: int) -> sp.Expr:
        """A component of an equation in names of invariants, f(T) and f'(T), as sympy writes it.

        name: of one of the `tensors` or `matter_equations`, or E_ij, E_(ij), L, P, Z, N.
        index: numbers of its indices, none for L and for the equation of a scalar field.
        E and its parts are sums of unknown functions times components.

        Examples
        --------
        >>> import geomtorsion as gt
        >>> cosmos = gt.spaces.load("frw_flat").frame
        >>> equations = gt.gravity.equations(gt.cartan(cosmos), "f(T)")
        >>> equations.readable("E", 0, 0)
        f(T) - 12*Derivative(a(t), t)**2*Derivative(f(T), T)/a(t)**2
        >>> equations.readable("L"), equations.readable("P", 0, 1, 1)
        (f(T), 2*Derivative(a(t), t)*Derivative(f(T), T)/a(t))
        """
        further = DIVIDED | {x: x for x in "LPZN"}
        every = {**self.tensors, **self.matter_equations}
        checks.choice(name, (*every, *further), "name", GravityError)
        tensor = every[name] if name in every else getattr(self, further[name])
        terms = self._divided.get(name, {})
        if terms.keys() <= {sp.S.One}:
            return self.written(tensor.element(*index))
        written = self.frame.written
        return sp.Add(*(x * written(one.element(*index)) for x, one in terms.items()))

    def _shown(self, tensor: Tensor, index: Index, element: Element) -> sp.Expr:
        """A component as tensors print it: f_T for df/dT, and the parts of E by unknown functions.

        Tensors in other coordinates have other elements, which are written as they are.
        """
        labels = [x for x, name in DIVIDED.items() if self.__dict__.get(name) is tensor]
        field = self.frame.field
        if labels:
            expression = self.readable(labels[0], *index)
        elif tensor.frame.field in (field, getattr(field, "base", field)):
            expression = self.written(element)
        else:
            return tensor.frame.written(element)
        return shorthand(expression, self.frame.coordinates)

    def _printed(self, tensor: Tensor) -> Tensor:
        """A tensor whose components print with the names of invariants."""
        return replace(tensor, source=tensor.components, writing=self._shown)

    @cached_property
    def _divided(self) -> dict[str, dict[sp.Expr, Tensor]]:
        parts = {
            "E": lambda one: one,
            "E_ij": lambda one: one.lowered(1),
            "E_(ij)": symmetric_part,
            "E_[ij]": antisymmetric_part,
        }
        return {x: {y: part(one) for y, one in self.terms.items()} for x, part in parts.items()}

    @cached_property
    def background(self) -> dict[str, sp.Expr]:
        """The distinct equations at order zero of an expanded frame: empty on a solution.

        Labels as in `distinct`. The first order of the equations is a statement on perturbations
        only where these vanish, identically or by conditions on the functions in them.

        Raises
        ------
        GravityError
            The frame was not expanded.

        Examples
        --------
        >>> import sympy as sp
        >>> import geomtorsion as gt
        >>> t, x, epsilon = sp.symbols("t x epsilon")
        >>> u = sp.Function("u")(t)
        >>> waves = gt.Frame([t, x], [[1, 0], [0, 1 + epsilon * u]], (-1, 1)).expanded("epsilon", 1)
        >>> gt.gravity.equations(gt.levi_civita(waves), "R").background
        {}
        >>> gt.gravity.equations(gt.levi_civita(waves), "R - 2*Lambda").background
        {'E_1^1': Lambda}
        """
        if not isinstance(self.frame.field, TruncatedField):
            raise GravityError(
                f"background: expected the equations of an expanded frame, got {self.frame!r}. "
                "Expand it first: frame.expanded('epsilon', 1)."
            )
        return distinct(self._orders(0), self.written, ())

    def order(self, k: int) -> dict[str, Tensor]:
        """Coefficients of a power of the small parameter: E, C where it is varied, and matter.

        Each is a tensor over the frame at order zero, by names as in `distinct`.

        Raises
        ------
        GravityError
            The frame was not expanded, or the background does not solve the equations: the message
            names the first one. `equations.E.order(1)` does not check this.
        """
        for label, expression in self.background.items():
            if k:
                raise GravityError(
                    f"order {k}: expected a background that solves the equations, got {label} = "
                    f"{checks.cut(str(expression))} at order 0. Give a frame whose order 0 is a "
                    "solution, or take equations.E.order(1) together with these conditions."
                )
        return self._orders(k)

    def _orders(self, k: int) -> dict[str, Tensor]:
        every = {x: one for x, one in self.tensors.items() if x in ("E", "C")}
        return {x: one.order(k) for x, one in (every | self.matter_equations).items()}

    @cached_property
    def distinct(self) -> dict[str, sp.Expr]:
        """Numerators of the equations that differ, without common factors, by their labels.

        Examples
        --------
        >>> import geomtorsion as gt
        >>> cosmos = gt.spaces.load("frw").frame
        >>> gt.gravity.equations(gt.levi_civita(cosmos), "R").distinct["E_1^1"]
        k + Derivative(a(t), t)**2
        """
        every = {x: one for x, one in self.tensors.items() if x in ("E", "C")}
        return distinct(every | self.matter_equations, self.written, self._sources.nonzero)

    def scalar(self, name: str) -> Tensor:
        """An invariant by its name in the Lagrangian, whether it occurs there or not.

        Raises
        ------
        GravityError
            There is no such invariant here.
        """
        checks.known_name(name, self._catalogue.names, "invariant", GravityError)
        return self.frame.scalar(lambda: self._content.value(name), name, "invariant")

    @cached_property
    def L(self) -> Tensor:
        """The Lagrangian on these fields, rank 0."""
        reading = self._reading
        return self._printed(
            self.frame.scalar(lambda: reading.element(reading.expression), "L", "Lagrangian")
        )

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
    def _variation(self) -> Variation:
        return Variation(self._content, self._slopes)

    @property
    def momenta(self) -> tuple[Momenta, ...]:
        """P = dL/dT, Z = dL/dR, N = dL/dQ of each connection."""
        return self._variation.momenta

    @cached_property
    def P(self) -> Tensor:
        """P^{ab}_c = dL/dT_ab^c of the first connection, slots UUD."""
        return self._printed(self.momenta[0].P)

    @cached_property
    def Z(self) -> Tensor:
        """Z^{abi}_j = dL/dR_abi^j of the first connection, slots UUUD."""
        return self._printed(self.momenta[0].Z)

    @cached_property
    def N(self) -> Tensor:
        """N^{aij} = dL/dQ_aij of the first connection, slots UUU."""
        return self._printed(self.momenta[0].N)

    # -- the equations -------------------------------------------------------------------------

    @cached_property
    def E(self) -> Tensor:
        """E_i^n = (1/e) d(eL)/d e^i_n, slots DU: the equation of the coframe.

        Its two indices are different, one down and one up: `E_lower` has both down, and
        `symmetric` and `antisymmetric` are its parts. In coordinates: `E.in_coordinates()`.

        E[0, 0] is exact and contains unknown functions themselves, so that a formula can replace
        them; sympy prints their derivatives as `Subs(...)`. `E.to_sympy(short=True)` has the names
        of the printed tensor, f_T for df/dT.

        Examples
        --------
        >>> import geomtorsion as gt
        >>> cosmos = gt.spaces.load("frw_flat").frame
        >>> E = gt.gravity.equations(gt.cartan(cosmos), "f(T)").E
        >>> E.to_sympy(short=True)[0, 0]
        -12*f_T*Derivative(a(t), t)**2/a(t)**2 + f(T)
        """
        own = self._variation.coframe.components.get
        sources = [one.coframe_source(self.connections[0]) for one in self._fluids]

        def rule(index: Index) -> Element:
            i, n = index
            terms: Terms = [(1, self.L.element())] if i == n else []
            terms += [(1, source.components.get(index)) for source in sources]
            return self.frame.field.sum([*terms, (1, own(index))])

        return self._printed(Tensor(self.frame, "DU", rule, (), "E", "coframe equation"))

    @cached_property
    def E_lower(self) -> Tensor:
        """E_ij, slots DD: the equation of the coframe with both indices down in the frame.

        Examples
        --------
        >>> import geomtorsion as gt
        >>> cosmos = gt.spaces.load("frw_flat").frame
        >>> equations = gt.gravity.equations(gt.cartan(cosmos), "T")
        >>> equations.E[0, 0], equations.E_lower[0, 0]
        (-6*Derivative(a(t), t)**2/a(t)**2, 6*Derivative(a(t), t)**2/a(t)**2)
        """
        lower = self.E.lowered(1)
        return self._printed(replace(lower, name="coframe equation, both indices down"))

    @cached_property
    def symmetric(self) -> Tensor:
        """E_(ij) = (E_ij + E_ji)/2, slots DD: the symmetric part of the coframe equation.

        E[i, j] + E[j, i] of the mixed components is another sum: it vanishes for i = 0, j > 0
        wherever E_ij is symmetric, because index 0 changes its sign where it is lowered.
        """
        return self._printed(symmetric_part(self.E))

    @cached_property
    def _fields(self) -> list[MatterField]:
        """Matter fields with the numbers by which their names differ."""
        return [one for one in numbered(self.matter) if isinstance(one, MatterField)]

    @property
    def _fluids(self) -> list[Source]:
        return [one for one in self.matter if not isinstance(one, MatterField)]

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
                if self._content.metric[0] and self._fluids:
                    total = turning(total)
            total = replace(total, symbol="C", name="connection equation")
            tensors.append(self._printed(total))
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

        return self._printed(Tensor(frame, "DD", rule, (), "M", "metric equation"))

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
        return self._printed(antisymmetric_part(self.E))

    @cached_property
    def tensors(self) -> dict[str, Tensor]:
        """E and E_[ij]; C where a connection is varied on its own, M where it is not metric."""
        metric = [one.is_metric for one in self._content.geometry]
        tensors = {"E": self.E, "E_[ij]": self.antisymmetric}
        kinds = {one.kind for one in self.connections}
        if kinds - {"cartan", "levi-civita"} or not all(metric):
            tensors["C"] = self.C
        if not all(metric):
            tensors["M"] = self.M
        return tensors

    @cached_property
    def matter_equations(self) -> dict[str, Tensor]:
        """(1/e) d(eL)/d(field) of each matter field, by its name; a scalar's is [0].

        Examples
        --------
        >>> import geomtorsion as gt
        >>> flat = gt.levi_civita(gt.Frame("t", [[1]], (-1,)))
        >>> field = gt.gravity.scalar_field("phi(t)")
        >>> gt.gravity.equations(flat, "-X/2 - phi(t)**2/2", field).matter_equations["phi"][0]
        -phi(t) - Derivative(phi(t), (t, 2))
        """
        return {x: self._printed(one) for x, one in self._variation.matter_equations.items()}

    def reduce(self, variable: object = None, conditions: object = ()) -> Reduction:
        """First-order equations for unknown functions of one variable, with constraints.

        variable: the coordinate on which all unknown functions depend, such as "t" or "r"; it may
            be omitted where there is only one.
        conditions: further equations: a state "p = rho/3", a gauge "N = 1", a new name "S(r) = R".

        Raises
        ------
        GravityError
            The equations leave a function free, contradict each other, or depend on more.
        """
        return reduced(self._sources, variable, conditions)

    def operator(self, fields: Iterable[str | sp.Expr]) -> LinearOperator:
        """First order about a background as a polynomial matrix in d/dx, one row for each field.

        The frame, the connection or the matter contain the fields times a small parameter, and the
        frame is expanded in it. Row f is the first order of dS/df.

        fields: unknown functions of the coordinates, or their names.

        Raises
        ------
        GravityError
            The frame is not expanded, the background is not a solution, or other small fields
            occur.

        Examples
        --------
        >>> import sympy as sp
        >>> import geomtorsion as gt
        >>> t, z, epsilon = sp.symbols("t z epsilon")
        >>> h = sp.Function("h")(t, z)
        >>> rows = [[1, 0, 0], [0, 1 + epsilon * h, 0], [0, 0, 1]]
        >>> plane = gt.Frame([t, sp.Symbol("x"), z], rows, signature="-++", parameters=[epsilon])
        >>> equations = gt.gravity.equations(gt.cartan(plane.expanded("epsilon", 1)), "vector2")
        >>> equations.operator([h]).symbol({"t": "s", "z": "p"})
        Matrix([[-2*p**2 + 2*s**2]])
        """
        return operator(self._sources, fields)

    @property
    def _sources(self) -> Sources:
        parts = self.E, self.M, self.connection_equations, self.matter_equations
        matter = (*self._fields, *self._fluids)
        fields, scalars = self.momenta[0].fields, self.scalars
        return Sources(self.connections, matter, fields, scalars, *parts, self.inner)

    @cached_property
    def inner(self) -> tuple[str, ...]:
        """Invariants inside known functions of the Lagrangian, such as T in exp(c*T)."""
        expression = self._named.expression
        functions = expression.atoms(sp.Function) - expression.atoms(AppliedUndef)
        functions |= {x for x in expression.atoms(sp.Pow) if not x.exp.is_Integer}
        inner = {symbol for one in functions for symbol in one.free_symbols}
        return tuple(name for symbol, name in self._named.symbols.items() if symbol in inner)

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
            return [term for one in self._fields for term in one.noether_terms(self._variation, i)]

        return [translations(self.E, self.M, parts, matter), rotations(self.M)]


def equations(
    connections: ConnectionLike | Iterable[ConnectionLike],
    lagrangian: Lagrangian | str | sp.Expr,
    matter: MatterField | Source | Iterable[MatterField | Source] = (),
    *,
    constants: str | sp.Symbol | Iterable[str | sp.Symbol] = (),
    invariants: Invariant | Iterable[Invariant] = (),
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
    invariants
        User-defined invariants, made by `gravity.invariant`.

    Raises
    ------
    GravityError
        The Lagrangian has an unknown name, a matter field does not occur in it, the connection does
        not belong to the theory, or all invariants vanish for this connection.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> from geomtorsion import gravity
    >>> cosmos = gt.spaces.load("frw").frame
    >>> gravity.equations(gt.levi_civita(cosmos), "R").antisymmetric.is_zero
    True
    """
    wanted = "one connection or a list of connections"
    own = listed(connections, ConnectionLike | Frame, "connections", wanted)
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
    wanted = "gravity.invariant(name, formula), or a list of them"
    added = listed(invariants, Invariant, "invariants", wanted)
    theory = replace(theory, constants=declared, invariants=(*theory.invariants, *added))
    check_geometry(theory, several)
    wanted = (
        "gravity.scalar_field, maxwell, fluid, weyssenhoff or hypermomentum, or a list of these"
    )
    sources = listed(matter, MatterField | Source, "matter", wanted)
    for source in sources:
        source.check(several[0].frame)
    result = FieldEquations(tuple(several), theory, tuple(sources))
    # Reads the Lagrangian, so that a wrong name is refused here.
    result.check_names()
    result.check_presence()
    return result

"""Reduction: field equations of functions of one variable, as first-order equations to solve."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.errors import GravityError, StartError
from geomtorsion.exact import parse_expression
from geomtorsion.geometry.assumption import assumption_latex, assumption_of
from geomtorsion.gravity.reduced.beginning import Beginning, Start
from geomtorsion.gravity.reduced.branches import Branch, Search
from geomtorsion.gravity.reduced.centre import Centre
from geomtorsion.gravity.reduced.elimination import Eliminated
from geomtorsion.gravity.reduced.jets import Jets
from geomtorsion.gravity.reduced.starts import check_parameters, numbers_of
from geomtorsion.ode import ODE, At, When
from geomtorsion.ode import Centre as StartCentre
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import latex_of

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame


@dataclass(frozen=True, eq=False, repr=False)
class Reduction:
    """First-order equations and constraints that follow from field equations.

    A state a_1 is the derivative of a, a_2 the derivative of a_1. Functions that an equation
    without derivatives determines, such as torsion, are outputs. Made by `FieldEquations.reduce`.

    jets: the unknown functions and their derivatives as symbols.
    branch: the rules for highest derivatives, and the constraints.
    search: for the other branches.
    frame: of the ansatz; signs of roots are read in its region.
    names: conditions that name invariants inside of functions, such as S(r) = T for exp(T).

    Examples
    --------
    >>> import sympy as sp
    >>> import geomtorsion as gt
    >>> t, x, y, z = sp.symbols("t x y z")
    >>> a = sp.Function("a")(t)
    >>> cosmos = gt.Frame([t, x, y, z], sp.diag(1, a, a, a), (-1, 1, 1, 1))
    >>> dust = gt.gravity.fluid("rho(t)", 0, [1, 0, 0, 0])
    >>> reduced = gt.gravity.equations(gt.levi_civita(cosmos), "R/2", dust).reduce("t")
    >>> print(reduced)
    rho' = -3*a_1*rho/a
    a' = a_1
    a_1' = -a_1**2/(2*a)
    0 = a**2*rho - 3*a_1**2
    >>> ode = reduced.ode({"a": 1, "rho": 3}, near={"a_1": 1})
    >>> solution = gt.solve(ode, 10)
    >>> round(float(solution["a"][-1]), 9), round(16 ** (2 / 3), 9)
    (6.349604208, 6.349604208)
    """

    jets: Jets
    branch: Branch
    search: Search
    frame: Frame
    names: tuple[str, ...] = ()

    @property
    def eliminated(self) -> Eliminated:
        """The rules for highest derivatives, and the constraints."""
        return self.branch.eliminated

    @property
    def vanishing(self) -> tuple[str, ...]:
        """The factors of products, or leading coefficients, that this branch sets to zero."""
        return tuple(str(one.element.short) for one in self.branch.factors)

    @cached_property
    def branches(self) -> tuple[Reduction, ...]:
        """All consistent branches of the equations, this one's first; none contains another.

        An equation may be a product of unknowns. A branch is omitted if all of its solutions solve
        an earlier one. `open_factors` names the cases without an answer. Solutions along which
        only a leading coefficient vanishes are not sought.

        Examples
        --------
        An empty universe with T + c T^2 has a fixed rate of expansion, or is at rest:

        >>> import geomtorsion as gt
        >>> cosmos = gt.spaces.load("frw_flat").frame
        >>> reduced = gt.gravity.equations(gt.cartan(cosmos), "T + c*T**2").reduce("t")
        >>> [(one.vanishing, str(one).splitlines()[-1]) for one in reduced.branches]
        [((), '0 = a**2 + 18*a_1**2*c'), (('a_1',), "a' = 0")]
        """
        return tuple(
            replace(self, branch=one) for one in self._all_branches[0] if not self._free(one)
        )

    @cached_property
    def open_factors(self) -> tuple[str, ...]:
        """Factors whose vanishing leaves a function free, or whose case is not decided.

        Give such a factor as a condition, with another one for the function that is free.
        """
        every, undecided = self._all_branches
        free = {str(x.element.short) for one in every if self._free(one) for x in one.factors}
        return tuple(sorted(free | undecided))

    @cached_property
    def _all_branches(self) -> tuple[tuple[Branch, ...], frozenset[str]]:
        return self.search.all()

    def _free(self, branch: Branch) -> bool:
        """Whether a branch leaves a function without an equation."""
        return not set(self.search.make().unknowns) <= set(branch.eliminated.rules)

    @property
    def variable(self) -> str:
        """The name of the variable."""
        return self.jets.variable.name

    @cached_property
    def rates(self) -> Mapping[str, sp.Expr]:
        """State -> its derivative, over states, parameters and the variable."""
        rates: dict[str, sp.Expr] = {}
        for function, rule in self.eliminated.rules.items():
            for order in range(rule.order):
                name = self.jets.symbol(function, order).name
                last = order + 1 == rule.order
                rates[name] = rule.value.short if last else self.jets.symbol(function, order + 1)
        return rates

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(self.rates)

    @cached_property
    def outputs(self) -> Mapping[str, sp.Expr]:
        """Functions that are determined without derivatives, over the states."""
        rules = self.eliminated.rules.items()
        return {
            self.jets.symbol(function, 0).name: rule.value.short
            for function, rule in rules
            if rule.order == 0
        }

    @cached_property
    def constraints(self) -> tuple[sp.Expr, ...]:
        """Expressions that vanish along a solution, once they do so at its start."""
        return tuple(one.short for one in self.eliminated.constraints)

    @cached_property
    def differential_equations(self) -> Mapping[str, sp.Eq]:
        """Function -> its equation for `sympy.dsolve`, solved for the highest derivative.

        Examples
        --------
        >>> import sympy as sp
        >>> import geomtorsion as gt
        >>> t, r, theta, phi = sp.symbols("t r theta phi")
        >>> A, h = sp.Function("A")(r), sp.Function("h")(r)
        >>> coframe = sp.diag(A, 1 / sp.sqrt(h), r, r * sp.sin(theta))
        >>> static = gt.Frame([t, r, theta, phi], coframe, (-1, 1, 1, 1))
        >>> reduced = gt.gravity.equations(gt.levi_civita(static), "R - 2*Lambda").reduce("r")
        >>> sp.dsolve(reduced.differential_equations["h"])
        Eq(h(r), C1/r - Lambda*r**2/3 + 1)
        """
        table: dict[sp.Basic, sp.Basic] = {}
        for function in self.eliminated.rules:
            for order in range(self.jets.highest + 1):
                derivative = function.diff(self.jets.variable, order) if order else function
                table[self.jets.symbol(function, order)] = derivative
        return {
            self.jets.symbol(function, 0).name: sp.Eq(
                table[self.jets.symbol(function, rule.order)], rule.value.short.xreplace(table)
            )
            for function, rule in self.eliminated.rules.items()
        }

    @property
    def invariants(self) -> Mapping[str, sp.Expr]:
        """The constraints by names, constraint or constraint_1, ..., as an `ODE` takes them."""
        if len(self.constraints) == 1:
            return {"constraint": self.constraints[0]}
        return {f"constraint_{k}": one for k, one in enumerate(self.constraints, 1)}

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters."""
        expressions = [*self.rates.values(), *self.constraints, *self.outputs.values()]
        symbols = {x for one in expressions for x in one.free_symbols}
        return tuple(sorted({x.name for x in symbols} - {*self.states, self.variable}))

    @property
    def constants(self) -> list[str]:
        """Names of all constants of the theory, also of those that drop out of the equations."""
        return [one.name for one in self.jets.field.symbols if one not in self.jets.symbols]

    def complete(
        self,
        start: Mapping[str, object],
        parameters: Mapping[str, object] | None = None,
        *,
        near: Mapping[str, object] | None = None,
        origin: object = 0,
    ) -> dict[str, sp.Expr]:
        """A number for each state: from the start, or from the constraints.

        Where the equations have a pole at the origin, or where a function such as the radius of a
        sphere begins at zero, as at the centre of a star, a regular solution is a power series.
        Its coefficients complete the start, which may hold higher derivatives there, such as B_2.

        Parameters
        ----------
        start
            state -> number, for as many states as the constraints leave free.
        parameters
            name -> number.
        near
            state -> rough number, where a constraint has several solutions.
        origin
            the value of the variable at the start.

        Raises
        ------
        StartError
            Numbers are missing, a constraint does not hold or has several solutions.
        """
        return dict(self.beginning(Start.of(start, parameters, near, origin)).states)

    def begin(
        self,
        start: Mapping[str, object],
        parameters: Mapping[str, object] | None = None,
        *,
        near: Mapping[str, object] | None = None,
        origin: object = 0,
        reach: sp.Expr | None = None,
    ) -> tuple[sp.Expr, dict[str, sp.Expr]]:
        """The value of the variable where the integration starts, and all states there.

        It is the origin, unless the equations have a pole there. Then it is a small way from the
        pole, at most `reach`, and a power series gives the states. Other arguments as for
        `complete`.

        Raises
        ------
        StartError, GravityError
            as for `complete`, or a regular solution has no power series at the origin.
        """
        place, states = self.beginning(Start.of(start, parameters, near, origin)).within(reach)
        return place, dict(states)

    def beginning(self, start: Start) -> Beginning:
        """The start with its numbers read, for `complete`, `begin`, `centre` and `ode`.

        Raises
        ------
        StartError
            a name is unknown, or a value is not a finite real number.
        """
        parameters = numbers_of(start.parameters, self.constants, "parameters")
        (place,) = numbers_of({"origin": start.origin}, ("origin",), "origin").values()
        centre = None
        if self._has_pole(place, start.values):
            centre = Centre(self.jets, self.eliminated, place, self.names)
        names = self.states if centre is None else centre.names
        return Beginning(
            rates=self.rates,
            constraints=self.constraints,
            values=numbers_of(start.values, names, "start"),
            parameters=parameters,
            written=start.parameters,
            near=numbers_of(start.near, names, "near"),
            variable=self.variable,
            place=place,
            centre=centre,
        )

    def _has_pole(self, place: sp.Expr, start: Mapping[str, object]) -> bool:
        """Whether a rate has a pole at a place, perhaps by functions with a simple zero there."""
        rules = self.eliminated.rules
        names = [(self.jets.symbol(x, 0), self.jets.symbol(x, 1).name) for x in rules]
        every = {name for function, first in names for name in (function.name, first)}
        pairs = checks.by_name(start, "start", StartError).items()
        values = numbers_of({x: y for x, y in pairs if x in every}, tuple(sorted(every)), "start")
        here: dict[sp.Basic, sp.Basic] = {
            function: sp.S.Zero
            for function, first in names
            if values.get(function.name) == 0 and values.get(first) != 0
        }
        here[self.jets.variable] = place
        return any(sp.fraction(rate)[1].xreplace(here) == 0 for rate in self.rates.values())

    def ode(
        self,
        start: Mapping[str, object],
        parameters: Mapping[str, object] | None = None,
        *,
        near: Mapping[str, object] | None = None,
        origin: object = 0,
        outputs: Mapping[str, object] | None = None,
        events: Iterable[At | When] = (),
    ) -> ODE:
        """The equations with a start, as `gt.solve` and `gt.prove` take them.

        The constraints are invariants: a solution reports their drift. An `ODE` starts at time
        zero: if the variable begins elsewhere, the time s counts from there, and the variable is
        an output.

        Parameters
        ----------
        start, parameters, near, origin
            as for `complete`.
        outputs
            name -> further expression over states, outputs, parameters and the variable.
        events
            `When(expression)` ends the solution where it falls through zero, as at a surface.

        Raises
        ------
        StartError, GravityError
            as for `complete` and `begin`.
        """
        return self.ode_of(
            self.beginning(Start.of(start, parameters, near, origin)), outputs or {}, events
        )

    def ode_of(
        self,
        beginning: Beginning,
        outputs: Mapping[str, object],
        events: Iterable[At | When],
    ) -> ODE:
        """The same as `ode`, from the result of `beginning`."""
        place, states = beginning.first
        ode = self.ode_at(place, states, beginning.written, outputs, events)
        return replace(ode, centre=self._centre_of(beginning))

    def ode_at(
        self,
        place: sp.Expr,
        states: Mapping[str, sp.Expr],
        parameters: Mapping[str, object],
        outputs: Mapping[str, object],
        events: Iterable[At | When],
    ) -> ODE:
        """The equations with numbers for all states at a place; other arguments as for `ode`."""
        check_parameters(self.parameters, parameters)
        ends = [self._read_end(event) for event in events]
        rates, invariants, time = self.rates, self.invariants, self.variable
        every = {**self.outputs, **self.read(outputs, "output")}
        numbers: dict[str, object] = {x: parameters[x] for x in self.parameters}
        if place:
            taken = {*rates, *self.parameters, *every}
            time = next(x for x in ("s", "way", "way_s") if x not in taken)
            # Real like all symbols of an ODE. A parameter, so that the place may change.
            here = sp.Symbol(time, real=True) + sp.Symbol(self.place_name, real=True)
            numbers[self.place_name] = place
            rates, invariants = self._moved(rates, here), self._moved(invariants, here)
            every = {**self._moved(every, here), self.variable: here}
            ends = [self._moved_end(event, here) for event in ends]
        return ODE.of(
            rates,
            states,
            parameters=numbers,
            invariants=invariants,
            outputs=every,
            time=time,
            events=ends,
        )

    def centre(
        self,
        start: Mapping[str, object],
        parameters: Mapping[str, object] | None = None,
        *,
        near: Mapping[str, object] | None = None,
        origin: object = 0,
    ) -> StartCentre | None:
        """The point where a regular solution begins, with its values there, as `prove` needs it.

        None where the equations have no pole at the origin. Arguments as for `complete`.
        """
        return self._centre_of(self.beginning(Start.of(start, parameters, near, origin)))

    def _centre_of(self, beginning: Beginning) -> StartCentre | None:
        """The point of a regular solution from a start that was read; see `centre`."""
        if beginning.centre is None:
            return None
        return StartCentre(beginning.place, self.place_name, beginning.states)

    def _read_end(self, event: At | When) -> At | When:
        """A condition of an event, with outputs replaced by their values."""
        if not isinstance(event, When) or not self.outputs:
            return event
        return replace(event, falls=self.read({"stop": event.falls}, "event")["stop"])

    def _moved_end(self, event: At | When, here: sp.Expr) -> At | When:
        """A condition with another value of the variable, where it is not text."""
        if not isinstance(event, When) or not isinstance(event.falls, sp.Expr):
            return event
        return replace(event, falls=event.falls.xreplace({self.jets.variable: here}))

    @property
    def place_name(self) -> str:
        """The parameter of an `ODE` that is the value of the variable at time zero, such as r_0."""
        name = f"{self.variable}_0"
        while name in {*self.states, *self.outputs, *self.parameters}:
            name += "0"
        return name

    def read(self, expressions: Mapping[str, object], subject: str) -> dict[str, sp.Expr]:
        """Expressions over states and the variable, with outputs replaced by their values.

        expressions: name -> text, over states, outputs, parameters and the variable, or sympy.

        Raises
        ------
        ExpressionError
            an expression cannot be read, or contains a name without a meaning.

        Examples
        --------
        >>> import sympy as sp
        >>> import geomtorsion as gt
        >>> t, x, y, z = sp.symbols("t x y z")
        >>> a = sp.Function("a")(t)
        >>> cosmos = gt.Frame([t, x, y, z], sp.diag(1, a, a, a), (-1, 1, 1, 1))
        >>> reduced = gt.gravity.equations(gt.levi_civita(cosmos), "R - 2*Lambda").reduce("t")
        >>> reduced.read({"H": "a_1/a"}, "output")
        {'H': a_1/a}
        """
        symbols = {x.name: x for x in (self.jets.variable, *self.jets.symbols)}
        symbols |= {name: sp.Symbol(name, real=True) for name in self.parameters}
        table = {sp.Symbol(name, real=True): value for name, value in self.outputs.items()}
        result = {}
        for name, value in checks.by_name(expressions, f"{subject}s", GravityError).items():
            where = f"{subject} {name}"
            read = partial(parse_expression, symbols=symbols, where=where, decimals=True)
            result[name] = checks.expression(value, where, GravityError, read=read).xreplace(table)
        return result

    def _moved(self, table: Mapping[str, sp.Expr], here: sp.Expr) -> dict[str, sp.Expr]:
        """Expressions with another value of the variable."""
        return {name: one.xreplace({self.jets.variable: here}) for name, one in table.items()}

    @property
    def text(self) -> str:
        """The equations, line by line."""
        lines = [f"{name}' = {rate}" for name, rate in self.rates.items()]
        lines += [f"{name} = {value}" for name, value in self.outputs.items()]
        lines += [f"0 = {one}" for one in self.constraints]
        return "\n".join([*lines, *filter(None, [self.assumption])])

    @property
    def assumption(self) -> str:
        """The region that was assumed for the ansatz, if the equations depend on it."""
        return assumption_of(self.frame, self._every)

    @property
    def _every(self) -> list[sp.Expr]:
        return [*self.rates.values(), *self.outputs.values(), *self.constraints]

    @property
    def latex(self) -> str:
        """The equations in LaTeX, for a notebook."""
        dot = f"\\frac{{d}}{{d {latex_of(self.jets.variable)}}} "
        lines = [
            f"{dot}{latex_of(sp.Symbol(name))} &= {latex_of(rate)}"
            for name, rate in self.rates.items()
        ]
        lines += [
            f"{latex_of(sp.Symbol(name))} &= {latex_of(value)}"
            for name, value in self.outputs.items()
        ]
        lines += [f"0 &= {latex_of(one)}" for one in self.constraints]
        remark = assumption_latex(self.frame, self._every)
        lines += [f"&{remark}"] * bool(remark)
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"

    def _repr_latex_(self) -> str:
        return f"$${self.latex}$$"

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        number = len(self.constraints)
        words = "1 constraint" if number == 1 else f"{number} constraints"
        return f"reduction to {', '.join(self.states)} as functions of {self.variable}, {words}"

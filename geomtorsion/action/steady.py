"""Steady: a motion with constant velocities, and the first-order equations around it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

import mpmath
import numpy as np
import sympy as sp

from geomtorsion.action.equation_text import rate_text
from geomtorsion.action.expansion import Expansion, Jet
from geomtorsion.errors import ConstraintError, MissingValueError, StartError, UnknownNameError
from geomtorsion.exact import Field
from geomtorsion.geometry.components import determinant, inverse
from geomtorsion.ode.terms import expression
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import EXACT_BITS, PRINTED, working_precision

if TYPE_CHECKING:
    from geomtorsion.action.tangent_bundle import TangentBundle
    from geomtorsion.exact import Element
    from geomtorsion.geometry.components import Components

# An array of elements.
Grid: TypeAlias = np.ndarray


@dataclass(frozen=True, eq=False, repr=False)
class Linearization:
    """x' = matrix x for small deviations x from a steady motion.

    states: names of the coordinates and velocities that deviate. Coordinates that no force depends
        on, such as the position on a plane, are omitted: they follow by integration.
    matrix: over numbers and the parameters that have no value.
    """

    states: tuple[str, ...]
    matrix: sp.ImmutableMatrix

    @cached_property
    def polynomial(self) -> tuple[sp.Expr, ...]:
        """Coefficients of the characteristic polynomial, of the highest power (1) first."""
        n, symbols = len(self.states), sorted(self.matrix.free_symbols, key=str)
        field = Field(symbols)
        named = [(f"matrix[{k}]", value) for k, value in enumerate(self.matrix)]
        values = field.read_all(named)
        rows = np.array(values, dtype=object).reshape(n, n)
        # Faddeev and Le Verrier: no quotient but by whole numbers.
        coefficients, power = [field.one], rows * field.zero
        for k in range(1, n + 1):
            power = rows @ power
            for i in range(n):
                power[i, i] = power[i, i] + coefficients[-1]
            trace = field.sum([(1, value) for value in (rows * power.T).ravel()])
            coefficients.append(trace * Fraction(-1, k))
        return tuple(value.sympy for value in coefficients)

    @cached_property
    def eigenvalues(self) -> np.ndarray:
        """Complex roots of the characteristic polynomial, the fastest growing first.

        Zero is exact and has its multiplicity; other roots are rounded once.

        Raises
        ------
        MissingValueError
            A parameter has no value.
        """
        names = sorted(symbol.name for symbol in self.matrix.free_symbols)
        remedy = "Use linearization.at({'{missing}': ...}).eigenvalues."
        checks.check_values(names, (), "eigenvalues", MissingValueError, remedy)
        coefficients = list(self.polynomial)
        zeros = 0
        while coefficients[-1] == 0:
            coefficients.pop()
            zeros += 1
        with working_precision(EXACT_BITS):
            numbers = [mpmath.mpf(sp.N(x, mpmath.mp.dps)) for x in coefficients]
            # Twice the digits once more: a root that is nearly double has half of them.
            nonzero = (
                mpmath.polyroots(numbers, maxsteps=1000, extraprec=2 * EXACT_BITS)
                if len(numbers) > 1 else []
            )  # fmt: skip
        roots = [complex(x) for x in nonzero] + [0j] * zeros
        return np.array(sorted(roots, key=lambda x: (-round(x.real, 12), x.imag)))

    def at(self, values: Mapping[object, object]) -> Linearization:
        """This linearization with values for some parameters.

        Raises
        ------
        UnknownNameError
            The matrix has no such parameter.
        """
        parameters = {symbol.name: symbol for symbol in self.matrix.free_symbols}
        table = {}
        for name, value in checks.by_name(values, "at").items():
            known = sorted(parameters)
            checks.known_name(name, known, "at", UnknownNameError, expected="a parameter")
            table[parameters[name]] = exactly(expression(value, name, {}))
        return replace(self, matrix=sp.ImmutableMatrix(self.matrix.xreplace(table)))

    def __repr__(self) -> str:
        rates = self.matrix * sp.Matrix([sp.Symbol(name) for name in self.states])
        return rate_text(dict(zip(self.states, rates, strict=True)))


def exactly(value: sp.Expr) -> sp.Expr:
    """An expression with fractions instead of its floats."""
    return value.xreplace({x: sp.Rational(x) for x in value.atoms(sp.Float)})


@dataclass(frozen=True, eq=False)
class Motion:
    """Lagrangian, forces and constraints of a motion, before expansion at a point.

    bundle: frame and symbols; lagrangian, forces, constraints: in q, u and parameters.
    coefficients: A_kj^i of the principle.
    """

    bundle: TangentBundle
    lagrangian: sp.Expr
    forces: Sequence[sp.Expr]
    constraints: Sequence[sp.Expr]
    coefficients: Mapping[tuple[int, ...], Element]

    @property
    def terms(self) -> tuple[sp.Expr, ...]:
        """Everything that may depend on the state."""
        return (self.lagrangian, *self.forces, *self.constraints)

    def used(self) -> set[int]:
        """Numbers of the coordinates on which the velocities depend, directly or through others."""
        symbols, frame = self.bundle.symbols, self.bundle.frame
        number = {symbol: mu for mu, symbol in enumerate(symbols.coordinates)}
        numbers: set[int] = set()
        for term in self.terms:
            numbers |= {number[x] for x in term.free_symbols & number.keys()}
        for value in self.coefficients.values():
            numbers |= {number[x] for x in value.symbols & number.keys()}
        waiting = sorted(numbers)
        while waiting:
            for _, value in frame.legs.components.rows[waiting.pop()]:
                more = {number[x] for x in value.symbols & number.keys()} - numbers
                numbers |= more
                waiting += sorted(more)
        return numbers


@dataclass(frozen=True, eq=False)
class Point:
    """A state, and the expansions around it.

    field: of the parameters that have no value.
    place: values of coordinates and parameters; used: coordinates on which the velocities depend.
    """

    state: Motion
    field: Field
    place: Mapping[sp.Symbol, sp.Expr]
    used: Sequence[int]

    def read(self, element: Element) -> Element:
        """An element of the bundle at the point."""
        return self.field.read(element.sympy.xreplace(dict(self.place)))

    def jets(self, terms: Sequence[sp.Expr], speeds: Sequence[sp.Expr]) -> list[Jet]:
        """Expansions in the coordinates, then in the velocities."""
        symbols = self.state.bundle.symbols
        values = dict(self.place) | dict(zip(symbols.velocities, speeds, strict=True))
        variables = (*symbols.coordinates, *symbols.velocities)
        expansion = Expansion(self.field, variables, values)
        return [expansion.of(term) for term in terms]

    def steady(
        self, given: Mapping[sp.Symbol, sp.Expr], velocities: Sequence[sp.Symbol | str] | None
    ) -> tuple[list[sp.Expr], list[int], list[int], Grid]:
        """All velocities, numbers of the free and bound ones, and the inverse of a^r_bound."""
        u, terms, field = self.state.bundle.symbols.velocities, self.state.constraints, self.field
        n = len(u)
        jets = self.jets(terms, [sp.S.Zero] * n)
        for r, jet in enumerate(jets):
            if any(i >= n and j >= n for i, j in jet.second):
                raise ConstraintError(
                    f"constraints[{r}]: expected an expression linear in the velocities, got "
                    f"{terms[r]}."
                )
        rows = self.first(jets, range(n, 2 * n))
        free = self._free(rows, velocities, given)
        bound = [i for i in range(n) if i not in free]
        try:
            solved = self.inverted(rows[:, bound])
        except ZeroDivisionError:
            names = ", ".join(u[i].name for i in bound)
            raise ConstraintError(
                f"expected constraints that determine {names} at this state, got coefficients "
                "whose determinant vanishes. Choose other independent velocities=[...]."
            ) from None
        speeds = [given.get(x, sp.S.Zero) for x in u]
        moving = self.array([field.read(speeds[i]) for i in free])
        constants = self.array([jet.value for jet in jets])
        rest = self.array(-solved @ (rows[:, free] @ moving + constants))
        for i, value in zip(bound, rest, strict=True):
            if u[i] in given and not is_small(field.read(given[u[i]]) - value, [*moving, value]):
                raise StartError(
                    f"at: expected {u[i].name} = {value.sympy}, as the constraints require, got "
                    f"{given[u[i]]}. Omit it, and it follows from the other velocities."
                )
            speeds[i] = value.sympy
        return speeds, free, bound, solved

    def _free(
        self,
        rows: Grid,
        velocities: Sequence[sp.Symbol | str] | None,
        given: Mapping[sp.Symbol, sp.Expr],
    ) -> list[int]:
        """Numbers of the independent velocities: the requested ones, else the given ones."""
        u = self.state.bundle.symbols.velocities
        names = [symbol.name for symbol in u]
        if velocities is not None:
            chosen = [checks.cut(str(x)) for x in checks.entries(velocities, "velocities")]
            wrong = [x for x in chosen if x not in names]
            if wrong or len(set(chosen)) != len(u) - len(rows):
                raise ConstraintError(
                    f"velocities: expected {len(u) - len(rows)} of {', '.join(names)}, got "
                    f"{', '.join(chosen)}."
                )
            return [i for i, name in enumerate(names) if name in chosen]
        # Row by row, of the velocities that have no value yet the last with a constant coefficient.
        left, taken = [list(row) for row in rows], []
        for r, row in enumerate(left):
            places = [i for i in range(len(u)) if not row[i].is_zero and i not in taken]
            if not places:
                raise ConstraintError(
                    f"constraints[{r}]: expected an independent constraint, got one that follows "
                    "from those before at this state. Omit it."
                )
            pivot = max(places, key=lambda i: (u[i] not in given, row[i].is_rational, i))
            taken.append(pivot)
            for later_row in left[r + 1 :]:
                factor = later_row[pivot] / row[pivot]
                for i in range(len(u)):
                    later_row[i] = later_row[i] - factor * row[i]
        return [i for i in range(len(u)) if i not in taken]

    def linearization(
        self, speeds: Sequence[sp.Expr], free: Sequence[int], bound: Sequence[int], solved: Grid
    ) -> Linearization:
        """The matrix over the coordinates used and the free velocities."""
        state, field, used = self.state, self.field, list(self.used)
        n, symbols = state.bundle.dimension, state.bundle.symbols
        energy, *others = self.jets((state.lagrangian, *state.forces, *state.constraints), speeds)
        pushes, ties = others[:n], others[n:]
        u, q = range(n, 2 * n), used
        u0 = self.array([field.read(x) for x in speeds])
        legs, leg_slopes = self.sloped(
            {(row, i): x for row, mu in enumerate(used) for i, x in self.legs.rows[mu]},
            (len(used), n),
        )
        moving = [
            symbols.coordinates[mu].name
            for mu, rate in zip(used, legs @ u0, strict=True)
            if not is_small(rate, u0)
        ]
        if moving:
            raise StartError(
                f"expected a steady motion, got {', '.join(moving)}, which change and occur in the "
                "equations. Use a co-moving frame, in which the equations depend only on the "
                "velocities."
            )
        # R_k = (p_k)' - A_kj^i u^j p_i - E_k^mu L_mu - F_k: its value, and its slopes in q and u.
        twist, twist_slopes = self.sloped(state.coefficients, (n, n, n))
        p0, pull = self.first([energy], u)[0], self.first([energy], q)[0]
        mass, mixed, bend = (self.second(energy, *x) for x in ((u, u), (u, q), (q, q)))
        turned = np.tensordot(twist, u0, (1, 0))
        value = -turned @ p0 - legs.T @ pull - self.array([push.value for push in pushes])
        by_u = -turned @ mass - twist @ p0 - legs.T @ mixed.T - self.first(pushes, u)
        by_q = -turned @ mixed - legs.T @ bend - self.first(pushes, q)
        for c in range(len(used)):
            by_q[:, c] -= np.tensordot(twist_slopes[c], u0, (1, 0)) @ p0 + leg_slopes[c].T @ pull
        # Reactions of the steady motion, from the equations of the bound velocities.
        for tie, reaction in zip(ties, solved.T @ value[bound], strict=True):
            value = value - reaction * self.first([tie], u)[0]
            by_q = by_q - reaction * self.second(tie, u, q)
        # du = along dw + tilt dq keeps the constraints, and dq' = leg du + turn dq.
        along, tilt = self.array(np.zeros((n, len(free)))), self.array(np.zeros((n, len(used))))
        along[free, range(len(free))] = field.one
        along[bound] = -solved @ self.first(ties, u)[:, free]
        tilt[bound] = -solved @ self.first(ties, q)
        turn = self.array(np.zeros((len(used), len(used))))
        for c in range(len(used)):
            turn[:, c] = leg_slopes[c] @ u0
        q_by_q, q_by_w = self.array(legs @ tilt + turn), self.array(legs @ along)
        swing = mass @ tilt + mixed
        solve = -self.inverted(along.T @ mass @ along)
        w_by_q = self.array(solve @ along.T @ (by_u @ tilt + by_q + swing @ q_by_q))
        w_by_w = self.array(solve @ along.T @ (by_u @ along + swing @ q_by_w))
        names = [symbols.velocities[i].name for i in free]
        scale = [*u0, *self.array(value)]
        for name, change in zip(names, self.array(solve @ along.T @ value), strict=True):
            if not is_small(change, scale):
                raise StartError(
                    f"expected a steady motion, got {name}' = {change.sympy} at this state. Give a "
                    "state in which all velocities are constant."
                )
        whole = np.block([[q_by_q, q_by_w], [w_by_q, w_by_w]])
        states = (*(symbols.coordinates[mu].name for mu in used), *names)
        return Linearization(states, sp.ImmutableMatrix([[x.sympy for x in row] for row in whole]))

    @property
    def legs(self) -> Components:
        """E_i^mu of the frame."""
        return self.state.bundle.frame.legs.components

    def array(self, values: object) -> Grid:
        """An array of elements; numbers of an empty sum become the field's."""
        grid = np.array(values, dtype=object)
        for place, value in np.ndenumerate(grid):
            if isinstance(value, int | float):
                grid[place] = self.field.rational(int(value))
        return grid

    def first(self, jets: Sequence[Jet], places: Sequence[int]) -> Grid:
        """Slopes of some jets."""
        zero = self.field.zero
        rows = [[jet.first.get(place, zero) for place in places] for jet in jets]
        return self.array(rows).reshape(len(jets), len(places))

    def second(self, jet: Jet, rows: Sequence[int], columns: Sequence[int]) -> Grid:
        """Second derivatives of a jet."""
        values = [[jet.slope(i, j) for j in columns] for i in rows]
        return self.array(values).reshape(len(rows), len(columns))

    def sloped(
        self, entries: Mapping[tuple[int, ...], Element], shape: tuple[int, ...]
    ) -> tuple[Grid, list[Grid]]:
        """Elements of the bundle at the point, and their slopes along the coordinates used."""
        values = self.array(np.zeros(shape))
        slopes = [self.array(np.zeros(shape)) for _ in self.used]
        for index, element in entries.items():
            values[index] = self.read(element)
            for slope, mu in zip(slopes, self.used, strict=True):
                slope[index] = self.read(element.diff(self.state.bundle.symbols.coordinates[mu]))
        return values, slopes

    def inverted(self, matrix: Grid) -> Grid:
        """The inverse of a matrix.

        Raises
        ------
        ZeroDivisionError
            It is singular.
        """
        n = len(matrix)
        entries = {x: value for x, value in np.ndenumerate(matrix) if not value.is_zero}
        grid = self.array(np.zeros((n, n)))
        if n and determinant(self.field, entries, n).is_zero:
            raise ZeroDivisionError("singular matrix")
        for index, value in inverse(self.field, entries, n).items() if n else ():
            grid[index] = value
        return grid


@exclusive
def is_small(element: Element, scale: Iterable[Element]) -> bool:
    """Whether an element is zero, or a number that rounding of the state explains."""
    if element.is_zero:
        return True
    if element.symbols:
        return False
    sizes = [abs(complex(sp.N(x.sympy))) for x in scale if not x.symbols]
    return abs(complex(sp.N(element.sympy))) <= PRINTED * max(sizes, default=0.0)

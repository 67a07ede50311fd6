"""Hamel: the equations of motion in quasi-velocities, in a frame adapted to the constraints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.action.tangent_bundle import TangentBundle
from geomtorsion.errors import ConstraintError, KineticMatrixError, LimitError, UndecidedError
from geomtorsion.geometry import Frame, Tensor, cartan
from geomtorsion.geometry.components import (
    Index,
    antisymmetric,
    blocks,
    dependence,
    determinant,
    inverse,
)
from geomtorsion.geometry.validation import Opened
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    from geomtorsion.action.principles import Principle
    from geomtorsion.exact import Element, Field
    from geomtorsion.geometry import Connection


Matrix = Mapping[tuple[int, int], "Element"]
Quotient = tuple["Element", "Element"]


def quotients(field: Field, matrix: Matrix, right: Sequence[Element]) -> list[Quotient]:
    """x_i = above_i / below_i with M x = right, for a symmetric regular matrix, block by block.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.exact import Field
    >>> a, b = sp.symbols("a b")
    >>> field = Field([a, b])
    >>> matrix = {(0, 0): field.read(a), (0, 1): field.one}
    >>> matrix |= {(1, 0): field.one, (1, 1): field.read(b)}
    >>> quotients(field, matrix, [field.one, field.zero])
    [(Element(b), Element(a*b - 1)), (Element(-1), Element(a*b - 1))]
    """
    n = len(right)
    solutions: dict[int, Quotient] = {}
    for rows, columns in blocks(matrix, n):
        if len(rows) == 1:
            solutions[columns[0]] = (right[rows[0]], matrix[rows[0], columns[0]])
            continue
        size = len(rows)
        terms: list[list] = [[] for _ in rows]
        whole: list = []
        for r, row in enumerate(rows):
            for c, column in enumerate(columns):
                others = _part(matrix, rows[:r] + rows[r + 1 :], columns[:c] + columns[c + 1 :])
                cofactor = determinant(field, others, size - 1)
                sign = -1 if (r + c) % 2 else 1
                terms[c].append((sign, cofactor, right[row]))
                if r == 0 and (row, column) in matrix:
                    whole.append((sign, cofactor, matrix[row, column]))
        below = field.sum(whole)
        for c, column in enumerate(columns):
            solutions[column] = (field.sum(terms[c]), below)
    return [solutions[i] for i in range(n)]


def _part(
    matrix: Matrix, rows: Sequence[int], columns: Sequence[int]
) -> dict[tuple[int, int], Element]:
    """The submatrix of some rows and columns, renumbered."""
    return {
        (r, c): matrix[row, column]
        for r, row in enumerate(rows)
        for c, column in enumerate(columns)
        if (row, column) in matrix
    }


HamelCoefficients = Mapping[Index, "Element"]


def coefficients_of(
    frame: Frame, principle: Principle, connection: Connection | None = None
) -> HamelCoefficients:
    """A_kj^i at (k, j, i), with  delta-bar u^i = d/dt dPhi^i + A_kj^i u^j dPhi^k.

    u^i = e^i_mu q'^mu gives  delta u^i - d/dt (e^i_mu dq^mu)
    = (d_mu e^i_nu - d_nu e^i_mu) dq^mu q'^nu: the curl of the coframe, in the frame C_kj^i.
    Where the image closes, the torsion 2 S_kj^i of its connection is subtracted again: all of it
    for the Cartan connection of the frame, which is taken if none is given.
    """
    if not principle.frame_curl:
        return {}
    curl = frame.anholonomy
    if not principle.image_torsion:
        return curl.components.nonzero
    torsion = torsion_over(frame, connection).in_frame()
    return (curl - torsion).components.nonzero


def torsion_over(frame: Frame, connection: Connection | None) -> Tensor:
    """2 S_ab^c of a connection, slots ddu, over a frame that may have another field."""
    if connection is None:
        return cartan(frame).torsion.T
    torsion = connection.torsion.T
    if torsion.frame is frame:
        return torsion
    values = {index: value.sympy for index, value in torsion.components.nonzero.items()}
    return Tensor(frame, "ddu", values, antisymmetric(3), "T", "torsion (2S)")


@dataclass(frozen=True, eq=False)
class Hamel:
    """d/dt p_k = A_kj^i u^j p_i + E_k(L) + F_k over a frame, some velocities fixed.

    bundle: the frame, adapted to the constraints if there are any.
    free: numbers of the quasi-velocities that move.
    lagrangian: L, where the fixed velocities have their values.
    momenta: p_i = dL/du^i for all i, likewise.
    slopes: E_k(L) at fixed u, for all k, likewise.
    forces: F_k, for all k, likewise.
    coefficients: A_kj^i of the variation.
    fixed: values of the other velocities, functions of q and t, mostly zero.
    """

    bundle: TangentBundle
    free: tuple[int, ...]
    lagrangian: Element
    momenta: tuple[Element, ...]
    slopes: tuple[Element, ...]
    forces: tuple[Element, ...]
    coefficients: HamelCoefficients
    fixed: Mapping[int, Element] = field(default_factory=dict)

    @cached_property
    def velocities(self) -> tuple[Element, ...]:
        """u^i as elements, with the values of the fixed ones."""
        every = enumerate(self.bundle.velocities)
        return tuple(self.fixed.get(i, value) for i, value in every)

    @cached_property
    def rates(self) -> tuple[Element, ...]:
        """q'^mu = E_i^mu u^i."""
        return tuple(self.bundle.rates(self.velocities))

    @cached_property
    def gyroscopic(self) -> tuple[Element, ...]:
        """A_kj^i u^j p_i for each k."""
        field = self.bundle.field
        terms: list[list] = [[] for _ in range(self.bundle.dimension)]
        # Sums over all velocities: a fixed one may still drive the others.
        for (k, j, i), value in self.coefficients.items():
            terms[k].append((1, value, self.velocities[j], self.momenta[i]))
        return tuple(field.sum(row) for row in terms)

    def kinetic(self, rows: Sequence[int]) -> dict[tuple[int, int], Element]:
        """M_kl = dp_k/du^l at (index of k in rows, index of l among the free velocities)."""
        symbols = [self.bundle.symbols.velocities[i] for i in self.free]
        entries = {}
        for place, k in enumerate(rows):
            for column, symbol in enumerate(symbols):
                value = self.momenta[k].diff(symbol)
                if not value.is_zero:
                    entries[place, column] = value
        return entries

    @cached_property
    def rest(self) -> tuple[Element, ...]:
        """The residual without its accelerations, for each k."""
        field, bundle = self.bundle.field, self.bundle
        rests = []
        for k in range(bundle.dimension):
            change = bundle.change(self.momenta[k], self.rates)
            parts = ((1, change), (-1, self.gyroscopic[k]), (-1, self.slopes[k]))
            rests.append(field.sum([*parts, (-1, self.forces[k])]))
        return tuple(rests)

    @cached_property
    def matrix(self) -> dict[tuple[int, int], Element]:
        """The kinetic matrix of the free velocities, found regular."""
        matrix = self.kinetic(self.free)
        self._check_regular(matrix, len(self.free))
        return matrix

    @cached_property
    def accelerations(self) -> tuple[Element, ...] | None:
        """u'^k of the free velocities, in their order: M u' = - rest.

        None where a denominator full of roots and sines is too long to be multiplied out.
        """
        field, n = self.bundle.field, len(self.free)
        try:
            inverted = inverse(field, self.matrix, n)
        except LimitError:
            return None
        if any(value.is_kept for value in inverted.values()):
            return None
        terms: list[list] = [[] for _ in range(n)]
        for (row, column), value in inverted.items():
            terms[row].append((-1, value, self.rest[self.free[column]]))
        return tuple(field.sum(row) for row in terms)

    @cached_property
    def quotients(self) -> tuple[Quotient, ...]:
        """The accelerations as pairs (numerator, denominator), never divided."""
        right = [-self.rest[k] for k in self.free]
        return tuple(quotients(self.bundle.field, self.matrix, right))

    def _check_regular(self, matrix: dict[tuple[int, int], Element], n: int) -> None:
        field, symbols = self.bundle.field, self.bundle.symbols
        size = determinant(field, matrix, n)
        if size.is_zero is None:
            raise UndecidedError(
                f"whether the kinetic matrix is singular cannot be decided: its determinant is "
                f"{size}. {checks.KNOWN_IDENTITIES}"
            )
        if not size.is_zero:
            return
        names = [symbols.velocities[i].name for i in self.free]
        lost = sorted(set(range(n)) - {column for _, column in matrix})
        relation = "; ".join(f"{names[k]} does not occur quadratically" for k in lost)
        if not lost:
            combination = dependence(field, matrix, n) or {}
            weights = [f"({value})*dL/d{names[i]}" for i, value in combination.items()]
            relation = f"{' + '.join(weights)} contains no velocity"
        raise KineticMatrixError(
            "the kinetic matrix d2L/du^i du^j is singular, so the accelerations are not "
            f"determined: {relation}. Add the kinetic energy that is missing, or constrain the "
            "velocity that carries none."
        )

    @cached_property
    def whole_matrix(self) -> dict[tuple[int, int], Element]:
        """M_kl at (k, index of l among the free velocities), for all k."""
        return self.kinetic(range(self.bundle.dimension))

    @cached_property
    def residuals(self) -> tuple[tuple[tuple[tuple[int, Element], ...], Element], ...]:
        """For each k the pairs (l, M_kl) with l counted among all velocities, and the rest."""
        matrix, residuals = self.whole_matrix, []
        for k in range(self.bundle.dimension):
            pairs = [(self.free[c], value) for (row, c), value in matrix.items() if row == k]
            residuals.append((tuple(pairs), self.rest[k]))
        return tuple(residuals)

    @cached_property
    def reactions(self) -> dict[int, Element] | None:
        """Forces that hold the fixed velocities: the residuals along them; None as above."""
        if self.accelerations is None:
            return None
        moving = dict(zip(self.free, self.accelerations, strict=True))
        reactions = {}
        for k in range(self.bundle.dimension):
            if k not in self.free:
                pairs, rest = self.residuals[k]
                terms = [(1, value, moving[i]) for i, value in pairs]
                reactions[k] = self.bundle.field.sum([*terms, (1, rest)])
        return reactions

    def derivative(self, element: Element) -> Element:
        """d/dt of f(q, u, t) along the motion, where accelerations could not be divided times
        the denominators of all: the same factor for every f.
        """
        symbols, field = self.bundle.symbols, self.bundle.field
        change = self.bundle.change(element, self.rates)
        slopes = [element.diff(symbols.velocities[i]) for i in self.free]
        if self.accelerations is not None:
            pairs = zip(slopes, self.accelerations, strict=True)
            return field.sum([(1, change), *((1, slope, value) for slope, value in pairs)])
        every = list(dict.fromkeys(below for _, below in self.quotients))
        terms: list = [(1, change, *every)]
        for slope, (above, below) in zip(slopes, self.quotients, strict=True):
            terms.append((1, slope, above, *(other for other in every if other != below)))
        return field.sum(terms)


def hamel_of(
    bundle: TangentBundle,
    lagrangian: sp.Expr,
    forces: Sequence[sp.Expr],
    constraints: Sequence[sp.Expr],
    principle: Principle,
    connection: Connection | None,
) -> Hamel:
    """The equations in quasi-velocities, over the frame or over one adapted to constraints."""
    named = [("lagrangian", lagrangian)]
    named += [(f"forces[{k}]", value) for k, value in enumerate(forces)]
    names = [f"constraints[{r}]" for r in range(len(constraints))]
    every = bundle.frame.read([*named, *zip(names, constraints, strict=True)])
    energy, pushes, fixed = every[0], every[1 : len(named)], every[len(named) :]
    if fixed:
        adapted = adapted_frame(bundle, list(zip(names, fixed, strict=True)))
        return _restricted(adapted, lagrangian, forces, principle, connection)
    n = bundle.dimension
    momenta = tuple(energy.diff(symbol) for symbol in bundle.symbols.velocities)
    slopes = tuple(bundle.along(k, energy) for k in range(n))
    coefficients = coefficients_of(bundle.frame, principle, connection)
    return Hamel(bundle, tuple(range(n)), energy, momenta, slopes, tuple(pushes), coefficients)


def _restricted(
    adapted: AdaptedFrame,
    lagrangian: sp.Expr,
    forces: Sequence[sp.Expr],
    principle: Principle,
    connection: Connection | None,
) -> Hamel:
    """The same over the adapted frame, where the replaced velocities have their values."""
    bundle, u = adapted.bundle, adapted.bundle.symbols.velocities
    replaced, values_at = adapted.velocity_substitution(), adapted.fixed_values()
    energy = bundle.frame.read([("lagrangian", lagrangian.xreplace(replaced))])[0]

    def at_fixed(element: Element) -> Element:
        if not element.symbols & set(values_at):
            return element
        return bundle.field.read(element.sympy.subs(values_at))

    momenta = tuple(at_fixed(energy.diff(symbol)) for symbol in u)
    slopes = tuple(at_fixed(bundle.along(k, energy)) for k in range(bundle.dimension))
    named = [(f"forces[{k}]", value.xreplace(replaced)) for k, value in enumerate(forces)]
    pushes = adapted.covector([at_fixed(value) for value in bundle.frame.read(named)])
    coefficients = coefficients_of(bundle.frame, principle, connection)
    free, values = adapted.free, adapted.fixed
    return Hamel(bundle, free, at_fixed(energy), momenta, slopes, pushes, coefficients, values)


Row = dict[int, "Element"]


@dataclass(frozen=True, eq=False)
class AdaptedFrame:
    """A frame in which constraints a^r_i u^i + c^r = 0 read w^r = -c^r; all other forms stay.

    bundle: the adapted frame, in the field of the frame before.
    free: numbers of the forms that stay; the others are replaced by constraints, in order.
    fixed: w^r = -c^r(q, t) by the number of the form that it replaces; mostly zero.
    given: B^i_k with u^i = B^i_k w^k, at (i, k).
    """

    bundle: TangentBundle
    free: tuple[int, ...]
    fixed: Mapping[int, Element]
    given: Mapping[tuple[int, int], Element]

    def covector(self, values: Sequence[Element]) -> tuple[Element, ...]:
        """B^i_k v_i: a covector (momenta, forces) in the adapted frame."""
        n, field = self.bundle.dimension, self.bundle.field
        terms: list[list] = [[] for _ in range(n)]
        for (i, k), value in self.given.items():
            terms[k].append((1, value, values[i]))
        return tuple(field.sum(row) for row in terms)

    def velocity_substitution(self) -> dict[sp.Symbol, sp.Expr]:
        """u^i = B^i_k w^k, the new velocities under the names of the old ones."""
        u = self.bundle.symbols.velocities
        terms: list[list[sp.Expr]] = [[] for _ in u]
        for (i, k), value in self.given.items():
            terms[i].append(value.sympy * u[k])
        return {symbol: sp.Add(*row) for symbol, row in zip(u, terms, strict=True)}

    def fixed_values(self) -> dict[sp.Symbol, sp.Expr]:
        """The values of the replaced velocities."""
        u = self.bundle.symbols.velocities
        return {u[k]: value.sympy for k, value in self.fixed.items()}


def adapted_frame(
    bundle: TangentBundle, constraints: Sequence[tuple[str, Element]]
) -> AdaptedFrame:
    """The frame adapted to constraints that are linear in the velocities.

    Each constraint replaces one form: a form with a constant coefficient if there is
    any, so that the adapted frame ends where the given one does; the last such.

    Raises
    ------
    ConstraintError
        A constraint is not linear in u, its coefficients depend on t, or it follows from others.
    """
    read = [_coefficients(bundle, where, value) for where, value in constraints]
    rows = [row for row, _ in read]
    replaced = _pivots(bundle, rows, [where for where, _ in constraints])
    n, unit = bundle.dimension, bundle.field.one
    turn = {(i, i): unit for i in range(n) if i not in replaced}
    for row, place in zip(rows, replaced, strict=True):
        turn.update(((place, i), value) for i, value in row.items())
    coframe = {}
    for (k, i), value in turn.items():
        for mu, form in bundle.frame.coframe.components.rows[i]:
            coframe.setdefault((k, mu), []).append((1, value, form))
    summed = {index: bundle.field.sum(terms) for index, terms in coframe.items()}
    free = tuple(i for i in range(n) if i not in replaced)
    adapted = _reframed(bundle.frame, summed)
    fixed = {place: -rest for place, (_, rest) in zip(replaced, read, strict=True)}
    return AdaptedFrame(bundle.over(adapted), free, fixed, inverse(bundle.field, turn, n))


def _reframed(frame: Frame, coframe: Mapping[tuple[int, int], Element]) -> Frame:
    """Another coframe over the same coordinates, in the same field."""
    entries = {index: value for index, value in coframe.items() if not value.is_zero}
    opened = Opened(frame.coordinates, frame.parameters, frame.domain, frame.complex, frame.field)
    # A frame of its own field would not know the symbols of the velocities.
    adapted: Frame = object.__new__(Frame)
    given = {"coframe": entries, "eta": dict(frame.given["eta"])}
    adapted.fill(opened, frame.name, given, ("coframe", dict(entries)))
    return adapted


def _coefficients(bundle: TangentBundle, where: str, value: Element) -> tuple[Row, Element]:
    """a_i and c of a_i(q) u^i + c(q, t)."""
    row: Row = {}
    for i, symbol in enumerate(bundle.symbols.velocities):
        slope = value.diff(symbol)
        if not slope.is_zero:
            row[i] = slope
    terms = [(-1, a, bundle.velocities[i]) for i, a in row.items()]
    rest = bundle.field.sum([(1, value), *terms])
    velocities = set(bundle.symbols.velocities)
    bound = [a for a in row.values() if a.symbols & {*velocities, bundle.symbols.time}]
    if rest.symbols & velocities or bound or not row:
        raise ConstraintError(
            f"{where}: expected a constraint linear in the velocities, got {value} = 0. Give a sum "
            "of coefficients of q times u^i, plus a function of q and t if required, as in 'u2' "
            "or 'sin(theta)*u1 - cos(theta)*u2'."
        )
    return row, rest


def _pivots(bundle: TangentBundle, rows: Sequence[Row], names: Sequence[str]) -> list[int]:
    """For each constraint the form that it replaces, such that the result is a frame."""
    field, done = bundle.field, []
    places: list[int] = []
    for name, row in zip(names, rows, strict=True):
        reduced = dict(row)
        for place, pivot_row in done:
            factor = reduced.pop(place, None)
            if factor is None:
                continue
            for i, value in pivot_row.items():
                if i != place:
                    terms = [(1, reduced[i])] if i in reduced else []
                    reduced[i] = field.sum([*terms, (-1, factor, value)])
        reduced = {i: value for i, value in reduced.items() if not value.is_zero}
        if not reduced:
            raise ConstraintError(
                f"{name}: expected an independent constraint, got one that follows from the "
                "constraints before it, or contradicts them. Omit it."
            )
        # A pivot that may vanish would end the adapted frame where the given frame continues.
        place = min(reduced, key=lambda i: (_rank(bundle, reduced[i]), -i))
        scale = reduced[place].inverse()
        done.append((place, {i: value * scale for i, value in reduced.items()}))
        places.append(place)
    return places


def _rank(bundle: TangentBundle, value: Element) -> int:
    """0 for a number, 1 for a parameter, 2 for a function that may vanish somewhere."""
    if value.is_rational:
        return 0
    return 2 if value.symbols & set(bundle.frame.coordinates) else 1

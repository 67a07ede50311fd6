"""Symmetry: vector fields whose flow keeps a metric and a connection, counted and found."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, combinations_with_replacement, product

import sympy as sp

from geomtorsion import checks
from geomtorsion.errors import ArgumentError, ShapeError
from geomtorsion.exact import Echelon, Element, vanishing_sums
from geomtorsion.exclusive import exclusive
from geomtorsion.geometry import Connection, Frame, Tensor, at_home, cartan, levi_civita, lie
from geomtorsion.geometry.connections import FrameLike, as_frame

Row = list[Element]
KEEPS = ("metric", "teleparallel")


@exclusive
def symmetries(frame: FrameLike, keep: str | Connection = "metric") -> Symmetries:
    """Vector fields along which the geometry of a frame does not change.

    Equation
    --------
    L_xi g = 0 and L_xi Gamma = 0. The values of xi and of D_[a xi_b] at one point determine xi;
    the conditions L_xi R = 0, L_xi T = 0 and their derivatives are linear in them, and where their
    rank does not grow from one order to the next it never will [Nomizu1960].

    Parameters
    ----------
    keep
        "metric": Killing vectors of the metric. "teleparallel": the metric and the connection with
        parallel legs, which separates good tetrads of a symmetric space from bad ones. A
        connection over the frame: the metric and this connection.

    Returns
    -------
    Symmetries, with the dimension at a generic point and the vectors of a stated ansatz.

    Raises
    ------
    ArgumentError
        `keep` has another value.
    ShapeError
        The connection belongs to another frame.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> from geomtorsion.gravity import symmetries
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> plane = Frame([r, phi], [[1, 0], [0, r]])
    >>> print(symmetries(plane))
    3 symmetries of the metric, orbits of dimension 2
    found 3 of 3:
      [0, 1]
      [sin(phi), cos(phi)/r]
      [-cos(phi), sin(phi)/r]
    >>> symmetries(plane, keep="teleparallel").dimension
    1
    """
    frame = as_frame(frame)
    if isinstance(keep, Connection):
        kept = at_home(frame, keep)
        if kept is None:
            raise ShapeError(
                "keep: expected a connection over the frame, got one over another frame. Build it "
                "over this one."
            )
        return Symmetries(frame, kept)
    name = checks.choice(keep, KEEPS, "keep", ArgumentError)
    return Symmetries(frame, cartan(frame) if name == "teleparallel" else levi_civita(frame))


def killing_equations(frame: FrameLike) -> tuple[sp.Eq, ...]:
    """The equations (L_xi g)_ab = 0, a <= b, of unknown components xi^a of all coordinates.

    Equation
    --------
    xi^m d_m g_ab + g_mb d_a xi^m + g_am d_b xi^m = 0

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> from geomtorsion.gravity import killing_equations
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> for one in killing_equations(Frame([r, phi], [[1, 0], [0, r]])):
    ...     print(one.lhs)
    2*Derivative(xi^r(r, phi), r)
    r**2*Derivative(xi^phi(r, phi), r) + Derivative(xi^r(r, phi), phi)
    2*r*(r*Derivative(xi^phi(r, phi), phi) + xi^r(r, phi))
    """
    frame = as_frame(frame)
    q, n = frame.coordinates, frame.dimension
    change = lie([sp.Function(f"xi^{one.name}")(*q) for one in q], frame)
    return tuple(sp.Eq(change[a, b], 0, evaluate=False) for a in range(n) for b in range(a, n))


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class Symmetries:
    """Vector fields along which a metric and a connection do not change.

    frame: the frame of the metric.
    connection: the connection that is preserved with it.
    """

    frame: Frame
    connection: Connection

    @cached_property
    def kept(self) -> str:
        """The geometry that is preserved, in words."""
        if self.connection.kind == "levi-civita":
            return "the metric"
        return f"the metric and the {self.connection.name}"

    @cached_property
    def _ranks(self) -> tuple[list[int], Echelon]:
        """Rank of the conditions at each order, the last two equal, and the conditions."""
        n = self.frame.dimension
        echelon = Echelon(self.frame.field, n + n * (n - 1) // 2)
        new = echelon.extend(sorted(self._conditions(), key=_length))
        ranks = [echelon.rank]
        # A condition that depends on others has derivatives that depend on theirs.
        while True:
            derived = [self._derivative(row, a) for row in new for a in range(n)]
            new = echelon.extend(sorted(derived, key=_length))
            ranks.append(echelon.rank)
            if not new:
                return ranks, echelon

    @property
    def ranks(self) -> tuple[int, ...]:
        """Rank of the conditions with derivatives up to order 0, 1, ...: the last two are equal."""
        return tuple(self._ranks[0])

    @property
    def dimension(self) -> int:
        """The number of independent symmetries near a generic point."""
        return self._ranks[1].width - self.ranks[-1]

    @property
    def isotropy(self) -> int:
        """The number of fields that leave a generic point fixed."""
        n, echelon = self.frame.dimension, self._ranks[1]
        turns = range(n, echelon.width)
        return len(turns) - echelon.rank_of_columns(turns)

    @property
    def orbits(self) -> int:
        """The dimension of the orbit of a generic point."""
        return self.dimension - self.isotropy

    # -- conditions on (xi^c, F_bc = D_b xi_c) at a point ------------------------------------------

    @cached_property
    def _turns(self) -> list[tuple[int, int]]:
        """Index pairs of F_bc, b < c, in the order of the unknowns."""
        return list(combinations(range(self.frame.dimension), 2))

    def _conditions(self) -> Iterator[Row]:
        """L_xi of the curvature and of the difference from the connection of the metric."""
        bar = levi_civita(self.frame)
        if self.frame.dimension > 1:
            yield from self._kept_tensor(bar.curvature.lower)
        if self.connection.kind != "levi-civita":
            yield from self._kept_tensor(_difference(self.connection, bar))

    def _kept_tensor(self, tensor: Tensor) -> Iterator[Row]:
        """(L_xi t)_a^b = xi^c D_c t_a^b + t_m^b D_a xi^m - t_a^m D_m xi^b."""
        frame, n = self.frame, self.frame.dimension
        get = tensor.components.get
        slope = levi_civita(frame).covariant_derivative(tensor).components.get
        inverse = frame.inverse_metric.components.rows
        for index in _representatives(tensor):
            # Coefficients of F_bc for all b, c.
            turning: dict[tuple[int, int], list] = {}
            for k, slot in enumerate(tensor.slots):
                head, own, tail = index[:k], index[k], index[k + 1 :]
                if slot == "d":
                    # t_{..m..} F_own^m
                    for c in range(n):
                        terms = [(1, x, get((*head, m, *tail))) for m, x in inverse[c]]
                        turning.setdefault((own, c), []).extend(terms)
                else:
                    # - t^{..m..} F_m^own
                    for c, x in inverse[own]:
                        for m in range(n):
                            turning.setdefault((m, c), []).append((-1, x, get((*head, m, *tail))))
            yield [
                *(slope((c, *index)) for c in range(n)),
                *self._antisymmetrised(turning),
            ]

    def _antisymmetrised(self, turning: dict[tuple[int, int], list]) -> Iterator[Element]:
        """Coefficients of F_bc for b < c, from those for all b, c."""
        for b, c in self._turns:
            negative = [(-sign, *factors) for sign, *factors in turning.get((c, b), ())]
            yield self.frame.field.sum([*turning.get((b, c), ()), *negative])

    def _derivative(self, row: Row, a: int) -> Row:
        """The condition that follows by d_a, with d_a xi and d_a F inserted.

        d_a xi^b = F_a^b - Gamma_ac^b xi^c
        d_a F_bc = R_bcad xi^d + Gamma_ab^e F_ec + Gamma_ac^e F_be
        """
        frame, n, field = self.frame, self.frame.dimension, self.frame.field
        bar = levi_civita(frame)
        gamma = bar.coefficients.components.get
        riemann = bar.curvature.lower.components.get
        inverse = frame.inverse_metric.components.get
        shifts: list[list] = [[(1, x.diff(frame.coordinates[a]))] for x in row[:n]]
        turning: dict[tuple[int, int], list] = {
            pair: [(1, x.diff(frame.coordinates[a]))]
            for pair, x in zip(self._turns, row[n:], strict=True)
        }
        for b, x in enumerate(row[:n]):
            for c in range(n):
                turning.setdefault((a, c), []).append((1, x, inverse((c, b))))
                shifts[c].append((-1, x, gamma((a, c, b))))
        for (b, c), x in zip(self._turns, row[n:], strict=True):
            for d in range(n):
                shifts[d].append((1, x, riemann((b, c, a, d))))
                turning.setdefault((d, c), []).append((1, x, gamma((a, b, d))))
                turning.setdefault((b, d), []).append((1, x, gamma((a, c, d))))
        return [*(field.sum(terms) for terms in shifts), *self._antisymmetrised(turning)]

    # -- vectors ---------------------------------------------------------------------------------

    @cached_property
    def vectors(self) -> tuple[Tensor, ...]:
        """The symmetries found: xi^a, slot u, each checked exactly.

        See `ansatz` for the components searched; where fewer than `dimension` are found, others
        have components of another kind.
        """
        vectors: list[Tensor] = []
        constants = self.frame.parameters
        for degree, factors in ((0, ()), (1, ()), (2, ()), (2, constants), (3, ())):
            products = _monomials(self.frame, degree)
            products += [c * one for c in factors for one in products]
            vectors = self._independent([*vectors, *self._solved(products)])
            if len(vectors) >= self.dimension:
                break
        return tuple(vectors)

    def _independent(self, vectors: Sequence[Tensor]) -> list[Tensor]:
        """Elements that are not sums of others with constant coefficients.

        A symmetry is determined by its value and its derivative at one point.
        """
        bar, n = levi_civita(self.frame), self.frame.dimension
        echelon = Echelon(self.frame.field, n + len(self._turns))
        independent = []
        for xi in vectors:
            slope = bar.covariant_derivative(xi.lowered(0))
            row = [*(xi.element(a) for a in range(n)), *(slope.element(*x) for x in self._turns)]
            if echelon.add(row):
                independent.append(xi)
        return independent

    @property
    def ansatz(self) -> str:
        """The components that were searched for vectors."""
        functions = {str(q): coordinate_functions(self.frame, q) for q in self.frame.coordinates}
        text = "; ".join(f"{q}: {', '.join(map(str, every))}" for q, every in functions.items())
        return (
            "rational combinations of products of up to two of these and a parameter, or of three "
            f"of different coordinates: {text}"
        )

    def _solved(self, functions: Sequence[sp.Expr]) -> list[Tensor]:
        """All xi with components in the span of some functions."""
        frame, n, field = self.frame, self.frame.dimension, self.frame.field
        elements = frame.read([("ansatz", one) for one in functions])
        # The last function of each relation, such as sin**2 + cos**2 = 1, is a sum of the others.
        relations = vanishing_sums([elements], len(elements))
        spare = {max(k for k, c in enumerate(one) if c) for one in relations}
        elements = [x for k, x in enumerate(elements) if k not in spare]
        g = frame.metric.components.get
        unknowns = list(product(range(n), elements))
        equations = []
        for m in range(n):
            for k in range(m, n):
                row = []
                for a, one in unknowns:
                    along = frame.coordinates
                    row.append(
                        field.sum(
                            [
                                (1, one, g((m, k)).diff(along[a])),
                                (1, g((a, k)), one.diff(along[m])),
                                (1, g((m, a)), one.diff(along[k])),
                            ]
                        )
                    )
                equations.append(row)
        killing = [
            self._vector(unknowns, weights) for weights in vanishing_sums(equations, len(unknowns))
        ]
        if self.connection.kind == "levi-civita" or not killing:
            return killing
        # Sums of Killing vectors that keep the connection as well.
        extra = _difference(self.connection, levi_civita(frame))
        changes = [lie(one, extra) for one in killing]
        rows = [[x.components.get(index) for x in changes] for index in _representatives(extra)]
        sums = vanishing_sums(rows, len(killing))
        return [
            Tensor(
                frame,
                "u",
                {
                    (b,): field.sum(
                        [(c, one.element(b)) for c, one in zip(weights, killing, strict=True)]
                    )
                    for b in range(n)
                },
                (),
                "\\xi",
                "symmetry",
            )
            for weights in sums
        ]

    def _vector(self, unknowns: Sequence[tuple[int, Element]], found: Sequence[object]) -> Tensor:
        """The vector of a solution."""
        terms: dict[int, list] = {a: [] for a in range(self.frame.dimension)}
        for (a, function), c in zip(unknowns, found, strict=True):
            if c:
                terms[a].append((c, function))
        values = {(a,): self.frame.field.sum(own) for a, own in terms.items() if own}
        return Tensor(self.frame, "u", values, (), "\\xi", "symmetry")

    def __repr__(self) -> str:
        return str(self)

    def __str__(self) -> str:
        n = self.frame.dimension
        lines = [f"{self.dimension} symmetries of {self.kept}, orbits of dimension {self.orbits}"]
        lines.append(f"found {len(self.vectors)} of {self.dimension}:")
        shown = [[one[a] for a in range(n)] for one in self.vectors]
        lines += [f"  {value}" for value in shown]
        if len(self.vectors) < self.dimension:
            lines.append(f"searched: {self.ansatz}")
        return "\n".join(lines)


def _difference(connection: Connection, bar: Connection) -> Tensor:
    """Gamma - Gamma_bar, a tensor with slots ddu."""
    rule = (connection.coefficients - bar.coefficients).components
    return Tensor(connection.frame, "ddu", rule)


def _representatives(tensor: Tensor) -> Iterator[tuple[int, ...]]:
    """One index of each set of components that determine each other."""
    n = tensor.frame.dimension
    for index in product(range(n), repeat=len(tensor.slots)):
        if tensor.components.representative(index) == (1, index):
            yield index


def _length(row: Row) -> float:
    """How long a condition is: short ones are taken first."""
    return sum(x.length for x in row)


def coordinate_functions(frame: Frame, q: sp.Symbol) -> list[sp.Expr]:
    """Functions of one coordinate that occur in symmetries of such a metric."""
    metric = frame.metric.components.independent.values()
    # Only the metric counts: the field may know functions that were read later.
    made_of = [g for value in metric for g in frame.field.generators_of(value)]
    shown = dict.fromkeys(g.shown for g in made_of if q in g.depends)
    waves = [function for function in (sp.sin(q), sp.cos(q)) if function in shown]
    steep = [function for function in (sp.sinh(q), sp.cosh(q)) if function in shown]
    is_cyclic = all(x.free_of(q) for x in metric)
    functions: list[sp.Expr] = []
    if waves:
        functions += [sp.sin(q), sp.cos(q), 1 / sp.sin(q), 1 / sp.cos(q)]
        functions += [sp.cos(q) / sp.sin(q), sp.sin(q) / sp.cos(q)]
    elif steep:
        functions += [sp.sinh(q), sp.cosh(q), 1 / sp.sinh(q), sp.cosh(q) / sp.sinh(q)]
    else:
        functions.append(q)
    if is_cyclic:
        # Where the metric is free of q, symmetries that do not commute with d/dq depend on it so.
        functions += [sp.cos(q), sp.sin(q)]
        if not any(g.kind in ("cos", "sin") for g in made_of):
            functions += [sp.exp(q), sp.exp(-q)]
    for function in shown:
        if isinstance(function, sp.exp):
            functions += [function, 1 / function]
    # The slope of the logarithm of a component, such as 1/r or cot(theta).
    for value in metric:
        slope = value.diff(q)
        if slope is not frame.field.zero and not slope.is_zero:
            ratio = (slope / value).sympy
            constant, rest = ratio.as_independent(*frame.coordinates)
            if not rest.free_symbols - {q} and len(str(rest)) < 20 and constant.is_Rational:
                functions.append(rest)
    # A space of constant curvature has sqrt(1 - k r**2) and its ratio to r in its symmetries.
    legs = frame.coframe.components.nonzero.values()
    roots = [g for x in legs for g in frame.field.generators_of(x) if g.kind == "root"]
    own = [g.shown for g in roots if g.depends.intersection(frame.coordinates) == {q}]
    functions += [root * f for root in dict.fromkeys(own) for f in (1, *functions)]
    return list(dict.fromkeys(functions))


def _monomials(frame: Frame, degree: int) -> list[sp.Expr]:
    """Products of up to a given number of functions of coordinates."""
    every = [(q, f) for q in frame.coordinates for f in coordinate_functions(frame, q)]
    products: list[sp.Expr] = [sp.S.One]
    if degree >= 1:
        products += [f for _, f in every]
    if degree >= 2:
        products += [f * h for (_, f), (_, h) in combinations_with_replacement(every, 2)]
    if degree >= 3:
        products += [
            f * g * h for (p, f), (q, g), (s, h) in combinations(every, 3) if len({p, q, s}) == 3
        ]
    return list(dict.fromkeys(products))

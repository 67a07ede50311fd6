"""Invariance: the most general torsion, connection and coframe that Killing vectors keep."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement as repeated
from itertools import product
from typing import cast

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import Echelon, Element, unknown_functions, vanishing_sums
from geomtorsion.geometry import (
    Connection,
    Frame,
    Tensor,
    antisymmetric,
    at_home,
    from_coefficients,
    levi_civita,
    lie,
    lie_bracket,
)
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.gravity.theory.fields import Index
from geomtorsion.same import Symmetries, functions_of_coordinates, symmetries
from geomtorsion.support import arguments, checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive

Vectors = Symmetries | Iterable[object] | None


def invariant_torsion(frame: FrameLike, vectors: Vectors = None, name: str = "u") -> Tensor:
    """The most general torsion S_ab^c that is invariant under Killing vectors, slots DDU.

    It contains unknown functions u1, u2, ... of the coordinates that the vectors do not change, or
    constants if there are none. `gt.from_torsion` makes the metric connection of it.

    Equation
    --------
    L_xi S = 0 for each xi. At a point, the vectors that vanish there leave S unchanged.

    Parameters
    ----------
    vectors
        Killing vectors xi^a in coordinates, shape (m, n), or `gravity.symmetries(frame)`; by
        default all Killing vectors that are found for the metric.
    name
        Beginning of the names of the unknown functions.

    Raises
    ------
    GravityError
        A vector changes the metric, or the invariant tensors are not sums of products of simple
        functions of the coordinates with the legs of this frame.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> from geomtorsion import gravity
    >>> cosmos = gt.spaces.load("frw_flat").frame
    >>> gravity.invariant_torsion(cosmos).table()
    torsion S_{ij}^{k}: 12 of 64 components do not vanish
      S_{12}^{2}  [0, 1, 1]  u1(t)
      S_{13}^{3}  [0, 2, 2]  u1(t)
      S_{14}^{4}  [0, 3, 3]  u1(t)
      S_{23}^{4}  [1, 2, 3]  u2(t)
      S_{24}^{3}  [1, 3, 2]  -u2(t)
      S_{34}^{2}  [2, 3, 1]  u2(t)
      6 more follow by symmetry
    """
    action = _action(frame, vectors)
    return action.tensor("DDU", antisymmetric(3), name, ("S", "torsion"))


def invariant_connection(frame: FrameLike, vectors: Vectors = None, name: str = "u") -> Connection:
    """The most general connection that is invariant under Killing vectors.

    Equation
    --------
    Gamma = Gamma_bar + X with L_xi X = 0, because L_xi Gamma_bar = 0 for a Killing vector.

    See `invariant_torsion` for parameters and errors.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> from geomtorsion import gravity
    >>> cosmos = gt.spaces.load("frw_flat").frame
    >>> connection = gravity.invariant_connection(cosmos)
    >>> connection.coefficients[0, 0, 0], connection.coefficients[1, 1, 0]
    (u1(t), (a(t)*u4(t) + Derivative(a(t), t))*a(t))
    """
    action = _action(frame, vectors)
    extra = action.tensor("DDU", (), name, ("X", "difference of connections"))
    bar = levi_civita(action.frame).coefficients
    total = bar + Tensor(action.frame, "ddu", extra.in_coordinates().components)
    return from_coefficients(action.frame, total.to_sympy())


def invariant_coframe(frame: FrameLike, vectors: Vectors = None, name: str = "u") -> Frame:
    """The most general coframe that turns along Killing vectors as the coframe of a frame does.

    Equation
    --------
    L_xi e^i = Lambda^i_j e^j with constants Lambda of the given coframe; the result H^i_j e^j has
    the same Lambda, so that its parallel legs have the symmetry [HohmannEtAl2019].

    See `invariant_torsion` for parameters and other errors.

    Raises
    ------
    GravityError
        The legs do not turn by the same angle everywhere. Use Cartesian legs.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> from geomtorsion import gravity
    >>> cosmos = gt.spaces.load("frw_flat").frame
    >>> gravity.invariant_coframe(cosmos).coframe.nonzero()
    {(0, 0): u1(t), (1, 1): a(t)*u2(t), (2, 2): a(t)*u2(t), (3, 3): a(t)*u2(t)}
    """
    action = _action(frame, vectors)
    action.check_rigid()
    own = action.frame
    change = action.tensor("UD", (), name, ("H", "change of the coframe"))
    rows = (change @ own.coframe).to_sympy()
    return Frame(own.coordinates, rows.tolist(), own.eta.to_sympy().tolist(), domain=own.domain)


def _action(frame: FrameLike, vectors: Vectors) -> Action:
    """The action of vectors and of their brackets on the legs of a frame."""
    frame = as_frame(frame)
    if vectors is None or isinstance(vectors, Symmetries):
        source = symmetries(frame) if vectors is None else vectors
        closed = source.closed_form
        if len(closed) < source.dimension:
            raise GravityError(
                f"vectors: expected all {source.dimension} Killing vectors in closed form, got "
                f"{len(closed)}. Give the vectors that are kept, as lists of components in the "
                "coordinates."
            )
        listed: Sequence[object] = closed
    else:
        wanted = "a list of vectors or gravity.symmetries(frame)"
        listed = checks.entries(vectors, "vectors", GravityError, expected=wanted)
    if not listed:
        raise GravityError(
            "vectors: expected at least one vector, got none: the frame has no symmetry that is "
            "found. Give vectors, or write the tensor itself."
        )
    return Action(frame, tuple(_vector(frame, one) for one in listed))


def _vector(frame: Frame, one: object) -> Tensor:
    """A vector, slot u."""
    if not isinstance(one, Tensor):
        return frame.vector(cast(arguments.Vector, one))
    home = at_home(frame, one)
    if home is None or len(home.slots) != 1:
        raise GravityError(
            "vectors: expected vectors over the frame, got a tensor over another frame or with "
            f"slots {one.slots!r}. Give lists of components."
        )
    return home.raised(0).in_coordinates()


@exclusive
@dataclass(frozen=True, eq=False)
class Action:
    """Killing vectors, as they act on components in the frame.

    frame: the frame.
    given: vectors xi^a, slot u, which may lack brackets of others.
    """

    frame: Frame
    given: tuple[Tensor, ...]

    @cached_property
    def vectors(self) -> list[tuple[Tensor, Tensor]]:
        """The vectors and their brackets, with Lambda of each: independent ones."""
        echelon = Echelon(self.frame.field, self.frame.dimension * (self.frame.dimension + 1))
        chosen: list[tuple[Tensor, Tensor]] = []
        waiting = list(self.given)
        while waiting:
            xi = waiting.pop(0)
            turn = self._turn(xi)
            n = range(self.frame.dimension)
            row = [*(xi.element(k) for k in n), *(turn.element(i, j) for i in n for j in n)]
            # A Killing vector is determined by its value and its derivative at one point.
            if echelon.add(row):
                waiting += [lie_bracket(self.frame, xi, other) for other, _ in chosen]
                chosen.append((xi, turn))
        return chosen

    def _turn(self, xi: Tensor) -> Tensor:
        """Lambda^i_j of L_xi e^i = Lambda^i_j e^j, slots UD."""
        frame, get = self.frame, self.frame.coframe.components.get
        changes = []
        for i in range(frame.dimension):
            form = Tensor(frame, "d", lambda index, i=i: get((i, *index)))
            changes.append(lie(xi, form).in_frame().components.get)
        turn = Tensor(frame, "UD", lambda index: changes[index[0]](index[1:]))
        lower = turn.lowered(0).components.get
        for i, j in repeated(range(frame.dimension), 2):
            if frame.field.sum([(1, lower((i, j))), (1, lower((j, i)))]).is_zero is not True:
                components = ", ".join(str(xi[k]) for k in range(frame.dimension))
                raise GravityError(
                    f"vectors: expected Killing vectors of the metric, got [{components}], along "
                    "which the metric changes. See gravity.symmetries(frame)."
                )
        return turn

    def check_rigid(self) -> None:
        """Refuse legs that turn by different angles at different points."""
        frame = self.frame
        for xi, turn in self.vectors:
            for index, value in turn.components.nonzero.items():
                if not all(value.diff(q).is_zero for q in frame.coordinates):
                    components = ", ".join(str(xi[k]) for k in range(frame.dimension))
                    raise GravityError(
                        f"frame: expected legs that turn by one angle everywhere along "
                        f"[{components}], got the angle {value.sympy} in the plane "
                        f"{tuple(k + 1 for k in index)}. Use Cartesian legs."
                    )

    # -- invariant tensors -------------------------------------------------------------------------

    def _acted(self, shape: Tensor) -> list[dict[tuple[int, int], Element]]:
        """For each vector, (Lambda t) at component K from component L of t: matrix at (K, L)."""
        places = _places(shape)
        numbers = {place: k for k, place in enumerate(places)}
        matrices = []
        for _, turn in self.vectors:
            own = turn.components.nonzero
            terms: dict[tuple[int, int], list] = {}
            for k, place in enumerate(places):
                for slot, kind in enumerate(shape.slots):
                    for (i, j), x in own.items():
                        # t_{..i..} Lambda^i_own for a lower index, - t^{..j..} Lambda^own_j above.
                        here, other, sign = (j, i, 1) if kind == "D" else (i, j, -1)
                        if place[slot] != here:
                            continue
                        moved = (*place[:slot], other, *place[slot + 1 :])
                        parity, first = shape.components.representative(moved)
                        if parity:
                            terms.setdefault((k, numbers[first]), []).append((sign * parity, x))
            matrices.append({at: self.frame.field.sum(every) for at, every in terms.items()})
        return matrices

    def _count(self, shape: Tensor) -> int:
        """The number of independent invariant tensors at a generic point."""
        width, field = len(_places(shape)), self.frame.field
        matrices = self._acted(shape)
        echelon = Echelon(field, width)
        for combination in self._isotropy:
            rows: dict[int, dict[int, list]] = {}
            for c, matrix in zip(combination, matrices, strict=True):
                for (k, m), x in matrix.items():
                    rows.setdefault(k, {}).setdefault(m, []).append((1, c, x))
            echelon.extend(
                [field.sum(row[m]) if m in row else field.zero for m in range(width)]
                for row in rows.values()
            )
        return width - echelon.rank

    @cached_property
    def _isotropy(self) -> list[list[Element]]:
        """Combinations of the vectors that vanish at a point, as functions of the point."""
        field, n = self.frame.field, self.frame.dimension
        rows = []
        for k, (xi, _) in enumerate(self.vectors):
            unit = [field.one if k == m else field.zero for m in range(len(self.vectors))]
            rows.append(([xi.element(a) for a in range(n)], unit))
        for a in range(n):
            pivot = next((row for row in rows if row[0][a].is_zero is False), None)
            if pivot is None:
                continue
            rows.remove(pivot)
            for place, (row, weights) in enumerate(rows):
                if row[a].is_zero is False:
                    ratio = row[a] / pivot[0][a]
                    rows[place] = tuple(
                        [field.sum([(1, x), (-1, ratio, y)]) for x, y in zip(one, two, strict=True)]
                        for one, two in ((row, pivot[0]), (weights, pivot[1]))
                    )
        return [weights for _, weights in rows]

    @cached_property
    def arguments(self) -> tuple[sp.Expr, ...]:
        """Independent functions of the coordinates that no vector changes."""
        frame, n = self.frame, self.frame.dimension
        orbits = len(self.vectors) - len(self._isotropy)
        echelon = Echelon(frame.field, n)
        chosen: list[sp.Expr] = []
        for functions in self._ansatz():
            elements = frame.read([("ansatz", one) for one in functions])
            equations = [[self._along(xi, x) for x in elements] for xi, _ in self.vectors]
            for weights in vanishing_sums(equations, len(elements)):
                terms = zip(weights, functions, strict=True)
                expression = sp.Add(
                    *(sp.Rational(c.numerator, c.denominator) * x for c, x in terms)
                )
                (element,) = frame.read([("ansatz", expression)])
                if echelon.add([element.diff(q) for q in frame.coordinates]):
                    chosen.append(expression)
            if len(chosen) >= n - orbits:
                return tuple(chosen)
        raise GravityError(
            f"vectors: expected {n - orbits} functions of the coordinates that the vectors do not "
            f"change, and {len(chosen)} of them are found among sums of products of coordinates. "
            "Use coordinates of which some are constant on the orbits."
        )

    def _along(self, xi: Tensor, value: Element) -> Element:
        """xi^m d_m f."""
        q = self.frame.coordinates
        terms = [(1, x, value.diff(q[m])) for (m,), x in xi.components.nonzero.items()]
        return self.frame.field.sum(terms)

    def _ansatz(self) -> Iterator[list[sp.Expr]]:
        """Lists of functions, each longer than the one before."""
        q = self.frame.coordinates
        every = [x for one in functions_of_coordinates(self.frame, {}, 1).values() for x in one]
        every += [1 / x for x in every]
        # Legs that turn along a coordinate of which the metric is free.
        metric = self.frame.metric.components.independent.values()
        cyclic = [one for one in q if all(x.free_of(one) for x in metric)]
        every += [f(one) for one in cyclic for f in (sp.cos, sp.sin)]
        yield [sp.S.One, *q]
        functions = list(dict.fromkeys([sp.S.One, *q, *every]))
        yield functions
        # The product with 1 is the function itself.
        for factors, degree in (([sp.S.One, *q], 2), ([sp.S.One, *q], 3), (functions, 2)):
            yield list(dict.fromkeys(sp.Mul(*x) for x in repeated(factors, degree)))

    def _basis(self, rank: int, symmetry: tuple) -> list[Tensor]:
        """Invariant tensors, indices down, independent at a generic point, as many as there are."""
        key = rank, symmetry
        if key in self._bases:
            return self._bases[key]
        frame = self.frame
        shape = Tensor(frame, "D" * rank, {}, symmetry)
        places, count = _places(shape), self._count(shape)
        echelon = Echelon(frame.field, len(places))
        candidates = self._candidates(shape)
        chosen: list[dict[Index, Element]] = []
        while len(chosen) < count:
            values = next(candidates, None)
            if values is None:
                raise GravityError(
                    f"frame: expected {count} invariant tensors, and {len(chosen)} of them are "
                    "sums of products of simple functions of the coordinates with the legs. Use "
                    "legs that the vectors turn less, such as those along the orbits."
                )
            if echelon.add([values[place] for place in places]):
                chosen.append(values)
        basis = [Tensor(frame, shape.slots, one, symmetry) for one in sorted(chosen, key=_first)]
        self._bases[key] = basis
        return basis

    @cached_property
    def _bases(self) -> dict[tuple[int, tuple], list[Tensor]]:
        return {}

    def _candidates(self, shape: Tensor) -> Iterator[dict[Index, Element]]:
        """Invariant tensors: constant ones, products of those with fewer indices, then others."""
        yield from self._sums(shape, [sp.S.One])
        if len(shape.slots) > 1:
            yield from self._products(shape)
        for functions in self._ansatz():
            yield from self._sums(shape, functions)

    def _products(self, shape: Tensor) -> Iterator[dict[Index, Element]]:
        """Products of an invariant vector and tensor, with the symmetry of a shape."""
        rank, field = len(shape.slots), self.frame.field
        for vector, place in product(self._basis(1, ()), range(rank)):
            for rest in self._basis(rank - 1, ()):
                values = {}
                for index in _places(shape):
                    orders: list[tuple[int, Index]] = [(1, index)]
                    for order, sign in shape.symmetry:
                        orders += [(sign * x, tuple(one[k] for k in order)) for x, one in orders]
                    terms = [
                        (
                            x,
                            vector.components.get((one[place],)),
                            rest.components.get((*one[:place], *one[place + 1 :])),
                        )
                        for x, one in orders
                    ]
                    values[index] = field.sum(terms)
                yield values

    def _sums(self, shape: Tensor, functions: Sequence[sp.Expr]) -> Iterator[dict[Index, Element]]:
        """Invariant tensors whose components are rational sums of functions."""
        frame, places = self.frame, _places(shape)
        elements = frame.read([("ansatz", one) for one in functions])
        slopes = [[self._along(xi, x) for x in elements] for xi, _ in self.vectors]
        equations = self._equations(len(places), self._acted(shape), elements, slopes)
        for weights in vanishing_sums(equations, len(places) * len(elements)):
            values = {}
            for k, place in enumerate(places):
                own = weights[k * len(elements) : (k + 1) * len(elements)]
                terms = [(c, x) for c, x in zip(own, elements, strict=True) if c]
                values[place] = frame.field.sum(terms)
            yield values

    def _equations(
        self,
        size: int,
        matrices: Sequence[dict[tuple[int, int], Element]],
        elements: Sequence[Element],
        slopes: Sequence[Sequence[Element]],
    ) -> Iterator[list[Element]]:
        """(L_xi t)_K = xi(t_K) + (Lambda t)_K as rows over all constants, one for each K."""
        zero, count = self.frame.field.zero, len(elements)
        for matrix, along in zip(matrices, slopes, strict=True):
            rows: dict[int, list[Element]] = {}
            width = size * count
            if any(x is not zero for x in along):
                for k in range(size):
                    row = rows.setdefault(k, [zero] * width)
                    row[k * count : (k + 1) * count] = along
            for (k, m), x in matrix.items():
                row = rows.setdefault(k, [zero] * width)
                for j, f in enumerate(elements):
                    row[m * count + j] = row[m * count + j] + x * f
            yield from rows.values()

    def tensor(self, slots: str, symmetry: tuple, name: str, label: tuple[str, str]) -> Tensor:
        """The most general invariant tensor, with unknown functions of the arguments."""
        frame, beginning = self.frame, checks.text(name, "name", GravityError)
        basis = [_scaled(one, slots) for one in self._basis(len(slots), symmetry)]
        names = [f"{beginning}{k}" for k in range(1, len(basis) + 1)]
        # Only functions of the frame count: the field also contains functions of earlier calls.
        own = unknown_functions(frame.coframe.components.nonzero.values())
        taken = {x.name for x in (*frame.coordinates, *frame.parameters)}
        taken |= {one.func.__name__ for one in own}
        for one in names:
            if not one.isidentifier() or one in taken:
                raise GravityError(
                    f"name: expected the beginning of new names, got {checks.shown(name)}, and "
                    f"{one} is not a new name. Give another: name='w'."
                )
        arguments = self.arguments
        unknown = [sp.Function(x)(*arguments) if arguments else sp.Symbol(x) for x in names]
        elements = frame.read(list(zip(names, unknown, strict=True)))

        def rule(index: Index) -> Element:
            terms = zip(elements, basis, strict=True)
            return frame.field.sum([(1, u, one.components.get(index)) for u, one in terms])

        return Tensor(frame, slots, rule, symmetry, *label)


def _places(shape: Tensor) -> list[Index]:
    """One index of each set of components that determine each other."""
    return [
        index
        for index in product(range(shape.frame.dimension), repeat=len(shape.slots))
        if shape.components.representative(index) == (1, index)
    ]


def _first(values: Mapping[Index, Element]) -> Index:
    """The first component that does not vanish."""
    return next(place for place, value in values.items() if value.is_zero is False)


def _scaled(tensor: Tensor, slots: str) -> Tensor:
    """A tensor with some indices up, divided by its first component if that is a number."""
    for k, slot in enumerate(slots):
        tensor = tensor.raised(k) if slot == "U" else tensor
    _, first = min(tensor.components.nonzero.items())
    return tensor if first.symbols else tensor / first

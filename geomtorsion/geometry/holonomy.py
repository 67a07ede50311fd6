"""Holonomy: the Lie algebra of the rotations by which loops turn vectors, from the curvature."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

from geomtorsion.errors import TensorIndexError, UndecidedError
from geomtorsion.exact import Echelon, Element, Reduced, Specialization, reduced, signature
from geomtorsion.geometry.assumption import assumption_of
from geomtorsion.geometry.brackets import Brackets
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.lie_algebra import LieAlgebra
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive

Row = list[Element]


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class HolonomyAlgebra:
    """The holonomy algebra of a connection at a generic point.

    frame: the frame of the connection.
    label: the name of the connection.
    is_metric: whether lengths and angles are kept.
    dimensions: dimension of the algebra from up to 0, 1, ... derivatives of the curvature; the last
        derivative adds nothing.
    generators: a basis, X_i^j with slots DU (du for complex legs), functions of the point.

    Equation
    --------
    The span of R_ab, D_c R_ab, D_c D_d R_ab, ... as matrices X_i^j, with all of their brackets
    [Nijenhuis1953]. A loop turns a vector at its start by the exponential of such a matrix.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> holonomy = gt.levi_civita("schwarzschild").holonomy_algebra
    >>> holonomy
    holonomy of the Levi-Civita connection: so(3, 1), dimension 6
    >>> holonomy.dimensions, gt.cartan("so3").holonomy_algebra.dimension
    ((6,), 0)
    """

    frame: Frame
    label: str
    is_metric: bool
    dimensions: tuple[int, ...]
    generators: tuple[Tensor, ...]

    @property
    def dimension(self) -> int:
        """The number of independent generators."""
        return len(self.generators)

    @cached_property
    def _place(self) -> tuple[Specialization, Reduced]:
        """A point at which the generators stay independent, and their span there."""
        frame = self.frame
        width = frame.dimension**2
        region, q = frame.region, frame.coordinates
        for place in Specialization.nearer(frame.field, q, region.point, region.surrounds):
            try:
                rows = [place.all(_entries(one)) for one in self.generators]
                span = reduced(place.field, rows, width)
            except ZeroDivisionError:
                continue
            if span.rank == self.dimension:
                return place, span
        raise UndecidedError(
            f"expected a point at which the curvature is regular, got none in the region {region}. "
            "Declare a part of it: domain=[...]."
        )

    @cached_property
    def algebra(self) -> LieAlgebra:
        """The Lie algebra of the generators, with a basis at one point near the generic point."""
        place, span = self._place
        n = self.frame.dimension
        table = {
            (i, j): [_bracket(a, b, n)[k] for k in span.pivots]
            for (i, a), (j, b) in combinations(enumerate(span.rows), 2)
        }
        return LieAlgebra.of(Brackets.of(place.field, span.rank, table))

    @property
    def name(self) -> str:
        """The name of the algebra; all rotations of the metric are so(p, q)."""
        n = self.frame.dimension
        if self.is_metric and n > 1 and self.dimension == n * (n - 1) // 2:
            place, _ = self._place
            metric = self.frame.metric.element
            form = [[place(metric(i, j)) for j in range(n)] for i in range(n)]
            q, p = sorted(signature(place.field, form)[:2])
            return f"so({p}, {q})" if q else f"so({p})"
        if self.dimension == n * n:
            return f"gl({n}, R)"
        return self.algebra.name

    def parallel(self, slots: str) -> int:
        """The number of independent parallel tensors with these slots near a generic point.

        slots: a letter for each index, u (up) or d (down). Parallel vectors have "u", one-forms
        "d", metrics and two-forms "dd", complex structures "ud" (beside the identity).

        Raises
        ------
        TensorIndexError
            A slot is neither u nor d.

        Examples
        --------
        >>> import geomtorsion as gt
        >>> waves = gt.levi_civita("pp_wave").holonomy_algebra
        >>> waves.name, waves.parallel("u"), waves.parallel("dd")
        ('R^2', 1, 4)
        """
        if not isinstance(slots, str) or set(slots) - {"u", "d"}:
            raise TensorIndexError(
                f"slots: expected letters u (index up) and d (index down), got "
                f"{checks.shown(slots)}. Write 'u' for vectors and 'dd' for metrics."
            )
        place, span = self._place
        n, field = self.frame.dimension, place.field
        indices = list(product(range(n), repeat=len(slots)))
        number = {index: k for k, index in enumerate(indices)}
        rows = []
        for X in span.rows:
            for index in indices:
                row = [field.zero] * len(indices)
                for k, slot in enumerate(slots):
                    for m in range(n):
                        other = number[(*index[:k], m, *index[k + 1 :])]
                        # v^m X_m^i of vectors, - X_i^m w_m of one-forms.
                        x = X[m * n + index[k]] if slot == "u" else -X[index[k] * n + m]
                        row[other] = row[other] + x
                rows.append(row)
        return len(indices) - reduced(field, rows, len(indices)).rank

    def __repr__(self) -> str:
        return f"holonomy of the {self.label}: {self.name}, dimension {self.dimension}"

    def __str__(self) -> str:
        return "\n".join([repr(self), *self.lines()])

    def lines(self) -> list[str]:
        """Dimensions by the order of derivatives, and parallel tensors, in words."""
        orders = ", ".join(map(str, self.dimensions))
        return [
            f"dimension with up to 0, 1, ... derivatives of the curvature: {orders}",
            f"parallel vectors: {self.parallel('u')}",
            f"parallel one-forms: {self.parallel('d')}",
            f"parallel tensors with two lower indices: {self.parallel('dd')}",
            *filter(None, [assumption_of(self.frame)]),
        ]

    _repr_html_ = drawn_by("notebook_tables", "holonomy_html")


def holonomy(
    riemann: Tensor, derivative: Callable[[Tensor], Tensor], label: str, is_metric: bool
) -> HolonomyAlgebra:
    """The algebra of a connection, from its curvature R_abc^d and its covariant derivative."""
    frame, n = riemann.frame, riemann.frame.dimension
    echelon = Echelon(frame.field, n * n)
    dimensions: list[int] = []
    largest = n * (n - 1) // 2 if is_metric else n * n
    tensor = riemann
    while True:
        shown = tensor if frame.complex else tensor.in_frame()
        echelon.extend(_matrices(shown, n))
        # Brackets, until they add nothing.
        while echelon.extend([_bracket(a, b, n) for a, b in combinations(echelon.rows, 2)]):
            pass
        if dimensions and dimensions[-1] == echelon.rank:
            break
        dimensions.append(echelon.rank)
        if echelon.rank in (0, largest):
            break
        tensor = derivative(tensor)
    slots = "du" if frame.complex else "DU"
    pairs = list(product(range(n), repeat=2))
    generators = tuple(
        Tensor(frame, slots, dict(zip(pairs, row, strict=True)), (), "X", "generator of holonomy")
        for row in echelon.rows
    )
    return HolonomyAlgebra(frame, label, is_metric, tuple(dimensions), generators)


def _matrices(tensor: Tensor, n: int) -> Iterator[Row]:
    """The matrices X_i^j of (D ... D R)_{..ab i}^j for a < b."""
    for index in product(range(n), repeat=len(tensor.slots) - 2):
        if index[-2] < index[-1]:
            yield [tensor.element(*index, i, j) for i in range(n) for j in range(n)]


def _bracket(first: Sequence[Element], second: Sequence[Element], n: int) -> Row:
    """first_i^k second_k^j - second_i^k first_k^j."""
    field = first[0].field
    return [
        field.sum(
            [(1, first[i * n + k], second[k * n + j]) for k in range(n)]
            + [(-1, second[i * n + k], first[k * n + j]) for k in range(n)]
        )
        for i in range(n)
        for j in range(n)
    ]


def _entries(generator: Tensor) -> Row:
    n = range(generator.frame.dimension)
    return [generator.element(i, j) for i in n for j in n]

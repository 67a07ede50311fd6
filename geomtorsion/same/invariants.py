"""Invariants: the tensors that determine a geometry, and how many are independent."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, product

from geomtorsion.errors import ArgumentError
from geomtorsion.exact import Certainty, Echelon, Element, unknown_functions
from geomtorsion.exact.element import least_certain
from geomtorsion.geometry import Connection, Frame, Tensor, cartan, levi_civita
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import ByContent
from geomtorsion.support.exclusive import exclusive

Index = tuple[int, ...]
# The chance that rows which are dependent at a random point modulo a prime are independent.
RANK = Certainty(proved=False, error=1e-70)


@dataclass(frozen=True)
class Growth:
    """Independent functions among the invariants up to one order of derivatives.

    rank: their number on the bundle of frames, or on the space itself where the legs are fixed.
    isotropy: the dimension of the turns of the frame at a generic point that keep all of them.
    """

    rank: int
    isotropy: int


@exclusive
@dataclass(frozen=True, eq=False)
class Invariants(ByContent):
    """The invariants of a frame, of a metric, or of a metric with a connection, order by order.

    frame: the frame.
    keep: "legs", "teleparallel", "metric" or "connection" (see `same_geometry`).
    connection: the connection that is compared, for "connection".
    """

    frame: Frame
    keep: str
    connection: Connection | None = None

    @property
    def turns(self) -> bool:
        """Whether the legs are free to turn."""
        return self.keep != "legs"

    @cached_property
    def pairs(self) -> list[tuple[int, int]]:
        """Planes in which the frame may turn."""
        return list(combinations(range(self.frame.dimension), 2)) if self.turns else []

    @property
    def width(self) -> int:
        """Dimension of the bundle of frames, or of the space where the legs are fixed."""
        return self.frame.dimension + len(self.pairs)

    @cached_property
    def slot(self) -> str:
        """Letter of all lower indices: D for real legs, d where legs are complex or roots."""
        plain = self.turns and (self.frame.complex or self.frame.shape == "metric")
        return "d" if plain else "D"

    @cached_property
    def scalar_product(self) -> Tensor:
        """The metric with these indices."""
        return self.frame.metric if self.slot == "d" else self.frame.eta

    @cached_property
    def transport(self) -> Connection:
        """The connection by which invariants are differentiated."""
        flat = self.keep in ("legs", "teleparallel")
        return cartan(self.frame) if flat else levi_civita(self.frame)

    @cached_property
    def start(self) -> list[Tensor]:
        """The invariants without derivatives: torsion, or curvature and distortion."""
        if not self.turns:
            return [self.transport.torsion.T.in_frame()]
        if self.keep == "teleparallel":
            return [self._form(self.transport.torsion.T)]
        tensors = []
        if self.frame.dimension > 1:
            tensors.append(self._form(self.transport.curvature.lower))
        if self.connection is not None:
            rest = (self.connection.coefficients - self.transport.coefficients).components
            tensors.append(self._form(Tensor(self.frame, "ddu", rest, (), "N", "distortion")))
        return tensors

    @property
    def weights(self) -> tuple[int, ...]:
        """Powers of 1/length of the invariants without derivatives: curvature 2, torsion 1."""
        return tuple(2 if len(t.slots) == 4 else 1 for t in self.start)

    @cached_property
    def _orders(self) -> list[list[Tensor]]:
        return [self.start]

    def order(self, k: int) -> list[Tensor]:
        """The k-th covariant derivatives of the invariants, the newest index first."""
        while len(self._orders) <= k:
            slopes = [self.transport.covariant_derivative(t) for t in self._orders[-1]]
            changed = [self._form(t) if self.turns else t.in_frame() for t in slopes]
            self._orders.append(changed)
        return self._orders[k]

    def _form(self, tensor: Tensor) -> Tensor:
        """A tensor with all its indices down, in the basis of the invariants."""
        lower = tensor.lowered()
        return lower.in_frame() if self.slot == "D" else lower.in_coordinates()

    # -- ranks -----------------------------------------------------------------------------------

    @property
    def growth(self) -> tuple[Growth, ...]:
        """The independent functions at each order at which their number grows."""
        return self._ranks[0]

    @cached_property
    def _ranks(self) -> tuple[tuple[Growth, ...], Certainty]:
        """The ranks at each order, and their certainty."""
        n, zero = self.frame.dimension, self.frame.field.zero
        echelon, steps = Echelon(self.frame.field, self.width), list[Growth]()
        places = [(j, i) for j, t in enumerate(self.start) for i in representatives(t)]
        sure = least_certain(t.certainty for t in self.start)
        while True:
            # A function of others has derivatives that are functions of theirs.
            rows = {place: list(self._row(len(steps), *place)) for place in places}
            rows = {place: row for place, row in rows.items() if any(x is not zero for x in row)}
            new = [place for place, row in rows.items() if echelon.add(row)]
            # An independent row is proved, a dependent one is not.
            if len(new) < len(rows) and echelon.rank < self._largest:
                sure = least_certain([sure, RANK])
            if not new:
                return tuple(steps), sure
            columns = range(n, self.width)
            free = len(columns) - echelon.rank_of_columns(columns) if self.turns else 0
            steps.append(Growth(echelon.rank, free))
            if echelon.rank == self._largest:
                return tuple(steps), sure
            places = [(j, (c, *index)) for j, index in new for c in range(n)]

    @property
    def rank(self) -> int:
        """The number of independent functions among all invariants."""
        return self.growth[-1].rank if self.growth else 0

    @property
    def symmetries(self) -> int:
        """The number of independent symmetries near a generic point."""
        return self.width - self.rank

    @property
    def isotropy(self) -> int:
        """The dimension of the symmetries that leave a generic point fixed."""
        return self.growth[-1].isotropy if self.growth else len(self.pairs)

    @property
    def coordinates(self) -> int:
        """The number of coordinates on which the geometry depends: n minus the orbit dimension."""
        return self.frame.dimension - self.symmetries + self.isotropy

    @property
    def highest(self) -> int:
        """The order up to which invariants must agree: the first without growth."""
        return len(self.growth)

    @property
    def certainty(self) -> Certainty:
        """Certainty of the ranks, which are taken at a random point modulo a prime."""
        return self._ranks[1]

    @cached_property
    def _largest(self) -> int:
        """The largest rank that the cyclic coordinates allow: each of them is a symmetry."""
        matrix = self.frame.metric if self.keep in ("metric", "connection") else self.frame.coframe
        made_of = [*matrix.components.independent.values()]
        if self.connection is not None:
            made_of += self.connection.coefficients.components.independent.values()
        cyclic = [q for q in self.frame.coordinates if all(x.free_of(q) for x in made_of)]
        return self.width - len(cyclic)

    def _row(self, k: int, j: int, index: Index) -> Iterator[Element]:
        """The change of one invariant along each leg, and in each plane of turning."""
        (tensor, slope), n = (self.order(k)[j], self.order(k + 1)[j]), self.frame.dimension
        yield from (slope.element(c, *index) for c in range(n))
        if not self.turns:
            return
        frame, get = self.frame, tensor.components.get
        inverse = frame.inverse_metric if self.slot == "d" else frame.inverse_eta
        turning: dict[tuple[int, int], list] = {}
        for place, own in enumerate(index):
            head, tail = index[:place], index[place + 1 :]
            for c in range(n):
                terms = [(1, x, get((*head, m, *tail))) for m, x in inverse.components.rows[c]]
                turning.setdefault((own, c), []).extend(terms)
        for b, c in self.pairs:
            negative = [(-sign, *factors) for sign, *factors in turning.get((c, b), ())]
            yield frame.field.sum([*turning.get((b, c), ()), *negative])


def representatives(tensor: Tensor) -> Iterator[Index]:
    """One index of each set of components that determine each other."""
    for index in product(range(tensor.frame.dimension), repeat=len(tensor.slots)):
        if tensor.components.representative(index) == (1, index):
            yield index


def refuse_functions(frame: Frame) -> None:
    """Refuse a frame with unknown functions such as a(t)."""
    functions = unknown_functions(x for matrix in frame.given.values() for x in matrix.values())
    if functions:
        raise ArgumentError(
            f"expected a frame without unknown functions, got {functions[0]}. Give it a value, as "
            f"in frame.subs({{{functions[0]}: ...}})."
        )

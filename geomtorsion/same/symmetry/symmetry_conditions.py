"""Conditions: linear equations at each point that the values of symmetries satisfy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product

from geomtorsion.exact import Echelon, Element
from geomtorsion.geometry import Connection, Frame, Tensor, levi_civita

Row = list[Element]


@dataclass(frozen=True, eq=False)
class Conditions:
    """Conditions on the values (xi^a, F_bc, phi, k_a) of vector fields at a point.

    D_a xi_b = F_ab + phi g_ab with F antisymmetric, k_a = D_a phi. The unknowns are xi, then F_bc
    for b < c, then phi unless it is zero, then k unless phi is constant.

    frame: the frame of the metric.
    connection: the connection that is preserved with it.
    scaling: 0 for phi = 0 (Killing vectors), 1 for constant phi (homotheties), 2 for any phi.
    """

    frame: Frame
    connection: Connection
    scaling: int

    @property
    def turns(self) -> list[tuple[int, int]]:
        """Index pairs of F_bc, b < c, in the order of the unknowns."""
        return list(combinations(range(self.frame.dimension), 2))

    @property
    def width(self) -> int:
        """The number of unknowns."""
        n = self.frame.dimension
        return n + len(self.turns) + (0, 1, 1 + n)[self.scaling]

    @cached_property
    def echelons(self) -> tuple[list[int], Echelon]:
        """Rank of the conditions at each order, the last two equal, and the conditions."""
        echelon = Echelon(self.frame.field, self.width)
        new = echelon.extend(sorted(self._first(), key=_length))
        ranks = [echelon.rank]
        # A condition that depends on others has derivatives that depend on theirs.
        while True:
            derived = [self._derivative(row, a) for row in new for a in range(self.frame.dimension)]
            new = echelon.extend(sorted(derived, key=_length))
            ranks.append(echelon.rank)
            if not new:
                return ranks, echelon

    def rates(self, a: int) -> list[Row]:
        """d_a of each unknown, as a sum of all unknowns: a matrix."""
        zero, one = self.frame.field.zero, self.frame.field.one
        n = range(self.width)
        return [self._derivative([one if i == j else zero for j in n], a) for i in n]

    def values(self, xi: Tensor) -> Row:
        """The values of a vector field, functions of the point."""
        n, field = self.frame.dimension, self.frame.field
        bar = levi_civita(self.frame)
        slope = bar.covariant_derivative(xi.lowered(0)).components.get
        row = [xi.element(a) for a in range(n)]
        row += [(slope((b, c)) - slope((c, b))) / 2 for b, c in self.turns]
        if self.scaling:
            phi = field.sum([(1, bar.divergence(xi).element())]) / n
            row += [phi]
            row += [phi.diff(q) for q in self.frame.coordinates] if self.scaling == 2 else []
        return row

    def _first(self) -> Iterator[Row]:
        """The change of curvature and of the difference from the connection of the metric."""
        bar, n = levi_civita(self.frame), self.frame.dimension
        if self.scaling == 2:
            tensor, weight = (bar.curvature.cotton, 0) if n == 3 else (bar.curvature.weyl, 2)
            yield from self._preserved(tensor, weight)
        elif n > 1:
            yield from self._preserved(bar.curvature.lower, 2)
        if self.connection.kind != "levi-civita":
            yield from self._preserved(difference(self.connection, bar), 0)

    def _preserved(self, tensor: Tensor, weight: int) -> Iterator[Row]:
        """L_xi t = weight phi t.

        (L_xi t)_a^b = xi^c D_c t_a^b + t_m^b D_a xi^m - t_a^m D_m xi^b
        """
        frame, n = self.frame, self.frame.dimension
        get = tensor.components.get
        slope = levi_civita(frame).covariant_derivative(tensor).components.get
        inverse = frame.inverse_metric.components.rows
        scale = tensor.slots.count("d") - tensor.slots.count("u") - weight
        for index in representatives(tensor):
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
            row = [slope((c, *index)) for c in range(n)]
            row += self._antisymmetrised(turning)
            row += [get(index) * scale] if self.scaling else []
            yield row + [frame.field.zero] * (self.width - len(row))

    def _antisymmetrised(self, turning: dict[tuple[int, int], list]) -> Iterator[Element]:
        """Coefficients of F_bc for b < c, from those for all b, c."""
        for b, c in self.turns:
            negative = [(-sign, *factors) for sign, *factors in turning.get((c, b), ())]
            yield self.frame.field.sum([*turning.get((b, c), ()), *negative])

    def _derivative(self, row: Row, a: int) -> Row:
        """The condition that follows by d_a, with the derivatives of the unknowns inserted.

        d_a xi^b = F_a^b + phi delta_a^b - Gamma_ac^b xi^c
        d_a F_bc = R_bcad xi^d + k_b g_ac - k_c g_ab + Gamma_ab^e F_ec + Gamma_ac^e F_be
        d_a phi = k_a
        d_a k_b = - xi^c D_c P_ab - P_mb D_a xi^m - P_am D_b xi^m + Gamma_ab^c k_c
        """
        frame, n, field = self.frame, self.frame.dimension, self.frame.field
        bar = levi_civita(frame)
        gamma = bar.coefficients.components.get
        riemann = bar.curvature.lower.components.get
        inverse, g = frame.inverse_metric.components.get, frame.metric.components.get
        end = n + len(self.turns)
        slopes = [x.diff(frame.coordinates[a]) for x in row]
        shifts: list[list] = [[(1, x)] for x in slopes[:n]]
        turning: dict[tuple[int, int], list] = {
            pair: [(1, x)] for pair, x in zip(self.turns, slopes[n:end], strict=True)
        }
        for b, x in enumerate(row[:n]):
            for c in range(n):
                turning.setdefault((a, c), []).append((1, x, inverse((c, b))))
                shifts[c].append((-1, x, gamma((a, c, b))))
        for (b, c), x in zip(self.turns, row[n:end], strict=True):
            for d in range(n):
                shifts[d].append((1, x, riemann((b, c, a, d))))
                turning.setdefault((d, c), []).append((1, x, gamma((a, b, d))))
                turning.setdefault((b, d), []).append((1, x, gamma((a, c, d))))
        scales: list[list] = []
        if self.scaling:
            scales = [[(1, slopes[end]), (1, row[a])]]
        if self.scaling == 2:
            gradient: list[list] = [[(1, x)] for x in slopes[end + 1 :]]
            gradient[a].append((1, row[end]))
            for (b, c), x in zip(self.turns, row[n:end], strict=True):
                gradient[b].append((1, x, g((a, c))))
                gradient[c].append((-1, x, g((a, b))))
            schouten = bar.curvature.schouten
            P = schouten.components.get
            slope = bar.covariant_derivative(schouten).components.get
            for b, x in enumerate(row[end + 1 :]):
                for c in range(n):
                    shifts[c].append((-1, x, slope((c, a, b))))
                    gradient[c].append((1, x, gamma((a, b, c))))
                    for m in range(n):
                        turning.setdefault((a, c), []).append((-1, x, P((m, b)), inverse((c, m))))
                        turning.setdefault((b, c), []).append((-1, x, P((a, m)), inverse((c, m))))
                scales[0].append((-2, x, P((a, b))))
            scales += gradient
        return [
            *(field.sum(terms) for terms in shifts),
            *self._antisymmetrised(turning),
            *(field.sum(terms) for terms in scales),
        ]


def difference(connection: Connection, bar: Connection) -> Tensor:
    """Gamma - Gamma_bar, a tensor with slots ddu."""
    rule = (connection.coefficients - bar.coefficients).components
    return Tensor(connection.frame, "ddu", rule)


def representatives(tensor: Tensor) -> Iterator[tuple[int, ...]]:
    """One index of each set of components that determine each other."""
    n = tensor.frame.dimension
    for index in product(range(n), repeat=len(tensor.slots)):
        if tensor.components.representative(index) == (1, index):
            yield index


def _length(row: Sequence[Element]) -> float:
    """How long a condition is: short ones are taken first."""
    return sum(x.length for x in row)

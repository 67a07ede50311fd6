"""Fields: torsion, curvature and nonmetricity of a connection with all indices in the frame."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from geomtorsion.exact import Element
from geomtorsion.geometry import Connection, Frame, Tensor, antisymmetric, symmetric
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive

Index = tuple[int, ...]
# A product in a sum: a rational number, then elements.
Terms = list[tuple]

HALF = Fraction(1, 2)


def along(frame: Frame, leg: int, value: Element) -> Terms:
    """E_i(f): terms of the derivative of an element along a leg."""
    entries = frame.legs.components.columns[leg]
    return [(1, x, value.diff(frame.coordinates[mu])) for mu, x in entries]


def antisymmetric_part(E: Tensor) -> Tensor:
    """E_[ij], slots DD, of E_i^n."""
    lower = E.lowered().components.get

    def rule(index: Index) -> Element:
        i, j = index
        return E.frame.field.sum([(HALF, lower((i, j))), (-HALF, lower((j, i)))])

    return Tensor(E.frame, "DD", rule, antisymmetric(2), "E", "antisymmetric part of E")


def symmetric_part(E: Tensor) -> Tensor:
    """E_(ij), slots DD, of E_i^n."""
    lower = E.lowered().components.get

    def rule(index: Index) -> Element:
        i, j = index
        return E.frame.field.sum([(HALF, lower((i, j))), (HALF, lower((j, i)))])

    return Tensor(E.frame, "DD", rule, symmetric(2), "E", "symmetric part of E")


def turning(C: Tensor) -> Tensor:
    """The part of C^{ni}_j that is antisymmetric in ij, slots UUD."""
    lower = C.lowered().components.get

    def rule(index: Index) -> Element:
        n, i, j = index
        return C.frame.field.sum([(HALF, lower((n, i, j))), (-HALF, lower((n, j, i)))])

    return Tensor(C.frame, "DDD", rule, antisymmetric(3, 1, 2)).raised(0).raised(1)


@exclusive
@dataclass(frozen=True, eq=False)
class FrameFields:
    """The fields of one connection, all indices in the frame.

    connection: the connection; in the frame its coefficients are omega_ai^j.
    metric: whether omega_aij is antisymmetric in ij and stays so in variations; None: whether the
        connection is metric by its construction.

    Equation
    --------
    T_ij^k = C_ij^k + omega_ij^k - omega_ji^k,  Q_aij = - omega_aij - omega_aji,
    R_abi^j = E_a(omega_bi^j) - E_b(omega_ai^j) + C_ab^c omega_ci^j
              - omega_ai^t omega_bt^j + omega_bi^t omega_at^j
    """

    connection: Connection
    metric: bool | None = None

    @property
    def frame(self) -> Frame:
        """The frame of the connection."""
        return self.connection.frame

    @property
    def is_riemannian(self) -> bool:
        """Whether the connection is the Levi-Civita one, which the coframe determines."""
        return self.connection.kind == "levi-civita"

    @property
    def is_metric(self) -> bool:
        """Whether omega_aij is antisymmetric in ij and stays so in variations."""
        return self.connection.kind != "general" if self.metric is None else self.metric

    @cached_property
    def omega(self) -> Tensor:
        """omega_ai^j, slots DDU."""
        frame = self.frame
        if self.connection.kind == "cartan":
            return Tensor(frame, "DDU", {})
        if not self.is_riemannian:
            spin = self.connection.spin_connection
            return Tensor(frame, "dDU", spin.components).in_frame()
        lower = frame.anholonomy.lowered(2).components.get

        def rule(index: Index) -> Element:
            a, b, c = index
            terms = [(-HALF, lower((a, b, c))), (HALF, lower((b, c, a))), (-HALF, lower((c, a, b)))]
            return frame.field.sum(terms)

        return Tensor(frame, "DDD", rule, antisymmetric(3, 1, 2)).raised(2)

    @cached_property
    def torsion(self) -> Tensor:
        """T_ij^k, slots DDU."""
        frame = self.frame
        if self.is_riemannian:
            return Tensor(frame, "DDU", {}, antisymmetric(3))
        if self.connection.kind == "cartan":
            return frame.anholonomy
        omega, anholonomy = self.omega.components.get, frame.anholonomy.components.get

        def rule(index: Index) -> Element:
            i, j, k = index
            return frame.field.sum(
                [(1, anholonomy(index)), (1, omega((i, j, k))), (-1, omega((j, i, k)))]
            )

        return Tensor(frame, "DDU", rule, antisymmetric(3))

    @property
    def curvature_symmetry(self) -> tuple:
        """Symmetry of R_abij: antisymmetric in ab, and in ij for a metric connection."""
        first = antisymmetric(4)
        return first + antisymmetric(4, 2, 3) if self.is_metric else first

    @cached_property
    def curvature(self) -> Tensor:
        """R_abij, slots DDDD."""
        frame = self.frame
        symmetry = self.curvature_symmetry
        if self.connection.kind == "cartan":
            return Tensor(frame, "DDDD", {}, symmetry)
        if self.is_riemannian:
            return self.connection.curvature.lower.in_frame()
        mixed, lower = self.omega.components.get, self.omega.lowered(2).components.get
        anholonomy = frame.anholonomy.components.get

        def rule(index: Index) -> Element:
            a, b, i, j = index
            terms = along(frame, a, lower((b, i, j)))
            terms += [(-1, *term[1:]) for term in along(frame, b, lower((a, i, j)))]
            for t in range(frame.dimension):
                terms.append((1, anholonomy((a, b, t)), lower((t, i, j))))
                terms.append((-1, mixed((a, i, t)), lower((b, t, j))))
                terms.append((1, mixed((b, i, t)), lower((a, t, j))))
            return frame.field.sum(terms)

        return Tensor(frame, "DDDD", rule, symmetry)

    @cached_property
    def rotation_curvature(self) -> Tensor:
        """R_ab[ij], slots DDDD: the curvature itself where the connection is metric."""
        if self.is_metric:
            return self.curvature
        get = self.curvature.components.get

        def rule(index: Index) -> Element:
            a, b, i, j = index
            return self.frame.field.sum([(HALF, get(index)), (-HALF, get((a, b, j, i)))])

        return Tensor(self.frame, "DDDD", rule, antisymmetric(4) + antisymmetric(4, 2, 3))

    @cached_property
    def nonmetricity(self) -> Tensor:
        """Q_aij, slots DDD."""
        frame = self.frame
        if self.is_metric:
            return Tensor(frame, "DDD", {}, symmetric(3, 1, 2))
        omega = self.omega.lowered(2).components.get

        def rule(index: Index) -> Element:
            a, i, j = index
            return frame.field.sum([(-1, omega((a, i, j))), (-1, omega((a, j, i)))])

        return Tensor(frame, "DDD", rule, symmetric(3, 1, 2))

    def divergence(self, tensor: Tensor, *, paired: bool = False) -> Tensor:
        """(1/e) D_m(e X^{m...}), the first slot U; paired: X^{mn...} is antisymmetric in mn.

        Paired, it is E_a(X^{an}) + C_ab^b X^{an} - C_ab^n X^{ab} / 2 in the frame, where the
        connection acts only on the other indices.
        """
        frame, n = self.frame, self.frame.dimension
        get, omega = tensor.components.get, self.omega.components.get
        anholonomy, vector = frame.anholonomy.components.get, self._vector.components.get
        others = range(2 if paired else 1, len(tensor.slots))

        def rule(index: Index) -> Element:
            terms: Terms = []
            for a in range(n):
                place = (a, *index)
                terms += along(frame, a, get(place))
                terms.append((1, vector((a,)), get(place)))
                for k in others:
                    for t in range(n):
                        component = get((*place[:k], t, *place[k + 1 :]))
                        if tensor.slots[k] == "U":
                            terms.append((1, omega((a, t, place[k])), component))
                        else:
                            terms.append((-1, omega((a, place[k], t)), component))
                if paired:
                    # Both orders of the pair give the same product.
                    for b in range(a):
                        terms.append((-1, anholonomy((a, b, index[0])), get((a, b, *index[1:]))))
            return frame.field.sum(terms)

        return Tensor(frame, tensor.slots[1:], rule)

    @cached_property
    def _vector(self) -> Tensor:
        """C_ab^b, slots D: the divergence of a leg."""
        frame, get = self.frame, self.frame.anholonomy.components.get

        def rule(index: Index) -> Element:
            return frame.field.sum([(1, get((*index, b, b))) for b in range(frame.dimension)])

        return Tensor(frame, "D", rule)

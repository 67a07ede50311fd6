"""Torsion: S and T = 2S of a connection, its three parts, its scalar and its force."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, overload

import sympy as sp

from geomtorsion.exact import Element
from geomtorsion.geometry.components import Index, alternating, antisymmetric, symmetric
from geomtorsion.geometry.contraction import contract
from geomtorsion.geometry.from_arrays import tensor_from_array
from geomtorsion.geometry.parts import torsion_parts
from geomtorsion.geometry.substitution import Replaced, Value
from geomtorsion.geometry.tensor import Scalar, Tensor
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.hints import attribute_hints

if TYPE_CHECKING:
    from geomtorsion.geometry.connection import Connection
    from geomtorsion.geometry.indexing import One, Place

HALF, THIRD, QUARTER = Fraction(1, 2), Fraction(1, 3), Fraction(1, 4)


@attribute_hints(tensor="torsion.T")
@exclusive
@dataclass(frozen=True, repr=False)
class Torsion:
    """Torsion of a connection, with the half (S) and without (T), and its parts.

    connection: Gamma_ab^c, a the direction of differentiation.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, cartan
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> torsion = cartan(Frame([r, phi], [[1, 0], [0, r]])).torsion
    >>> torsion.S[0, 1, 1], torsion.T[0, 1, 1], torsion.vector[0], torsion.scalar[()]
    (1/(2*r), 1/r, 1/r, 0)
    """

    connection: Connection

    @overload
    def __getitem__(self, index: tuple[Place, ...]) -> sp.Expr: ...
    @overload
    def __getitem__(self, index: One | tuple[One, ...]) -> Any: ...
    def __getitem__(self, index: One | tuple[One, ...]) -> Any:
        """S_ab^c, as it is printed: a sympy expression, or an array of components (see Tensor)."""
        return self.S[index]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.S)

    @cached_property
    def T(self) -> Tensor:
        """T_ab^c = Gamma_ab^c - Gamma_ba^c, slots ddu: torsion without the half.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        connection = self.connection
        gamma = connection.coefficients.components.get

        def rule(index: Index) -> Element:
            a, b, c = index
            return connection.frame.field.sum([(1, gamma((a, b, c))), (-1, gamma((b, a, c)))])

        if connection.kind == "levi-civita":
            # The coefficients are symmetric because each is stored once for (a, b) and (b, a).
            return Tensor(connection.frame, "ddu", {}, antisymmetric(3), "T", "torsion (2S)")
        return Tensor(connection.frame, "ddu", rule, antisymmetric(3), "T", "torsion (2S)")

    @cached_property
    def S(self) -> Tensor:
        """S_ab^c = (Gamma_ab^c - Gamma_ba^c) / 2, slots ddu: torsion with the half.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        whole = self.T.components.get

        def rule(index: Index) -> Element:
            return whole(index) * HALF

        return Tensor(self.connection.frame, "ddu", rule, antisymmetric(3), "S", "torsion")

    @cached_property
    def vector(self) -> Tensor:
        """Torsion vector v_a = T_ab^b, slots d.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        whole, n = self.T.components.get, self.connection.frame.dimension

        def rule(index: Index) -> Element:
            return self.connection.frame.field.sum([(1, whole((index[0], b, b))) for b in range(n)])

        return Tensor(self.connection.frame, "d", rule, (), "v", "torsion vector")

    @cached_property
    def axial(self) -> Tensor:
        """Axial part T_[abc] = (T_abc + T_bca + T_cab) / 3, slots ddd: totally antisymmetric.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        lower = self.T.lowered(2).components.get

        def rule(index: Index) -> Element:
            a, b, c = index
            terms = [
                (THIRD, lower((a, b, c))),
                (THIRD, lower((b, c, a))),
                (THIRD, lower((c, a, b))),
            ]
            return self.connection.frame.field.sum(terms)

        return Tensor(self.connection.frame, "ddd", rule, alternating(3), "A", "axial torsion")

    @cached_property
    def tensor(self) -> Tensor:
        """Tensor part T_abc - T_[abc] - (v_a g_bc - v_b g_ac) / (n - 1), slots ddd: traceless.

        Its contractions and its totally antisymmetric part vanish.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        frame = self.connection.frame
        lower, axial = self.T.lowered(2).components.get, self.axial.components.get
        vector, metric = self.vector.components.get, frame.metric.components.get
        # In one dimension there is no torsion, and no trace to subtract.
        share = Fraction(1, max(frame.dimension - 1, 1))

        def rule(index: Index) -> Element:
            a, b, c = index
            return frame.field.sum(
                [
                    (1, lower(index)),
                    (-1, axial(index)),
                    (-share, vector((a,)), metric((b, c))),
                    (share, vector((b,)), metric((a, c))),
                ]
            )

        return Tensor(frame, "ddd", rule, antisymmetric(3), "q", "tensor part of torsion")

    @cached_property
    def parts(self) -> Mapping[str, Tensor]:
        """Tensor, vector and axial part of T_abc, slots ddd; they add up to `T.lowered()`.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, cartan
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> parts = cartan(Frame([r, phi], [[1, 0], [0, r]])).torsion.parts
        >>> {name: part.is_zero for name, part in parts.items()}
        {'tensor': True, 'vector': False, 'axial': True}
        """
        return torsion_parts(self.T.lowered(2))

    @cached_property
    def scalar(self) -> Tensor:
        """Torsion scalar T_abc T^abc / 4 + T_abc T^cba / 2 - v_a v^a, rank 0.

        R_bar = -scalar - 2 D_bar_a v^a for a flat connection.
        """
        frame = self.connection.frame

        def rule() -> Element:
            # In the frame indices move by constants; with parallel legs T is the anholonomy there.
            has_parallel_legs = self.connection.kind == "cartan"
            return scalar_of(frame.anholonomy if has_parallel_legs else self.T.in_frame())

        return frame.scalar(rule, "T", "torsion scalar")

    @cached_property
    def superpotential(self) -> Tensor:
        """P^ab_c = (T^ab_c + T_c^ba - T_c^ab) / 2 - v^a delta^b_c + v^b delta^a_c, slots uud.

        The derivative of the torsion scalar by T_ab^c, so that scalar = T_ab^c P^ab_c / 2. Other
        authors call it S_c^ab.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        frame = self.connection.frame
        upper = self.T.raised().lowered(2).components.get
        swapped = self.T.lowered(2).raised(1).raised(2).components.get
        vector, zero = self.vector.raised().components.get, frame.field.zero

        def rule(index: Index) -> Element:
            a, b, c = index
            return frame.field.sum(
                [
                    (HALF, upper((a, b, c))),
                    (HALF, swapped((c, b, a))),
                    (-HALF, swapped((c, a, b))),
                    (-1, vector((a,)) if b == c else zero),
                    (1, vector((b,)) if a == c else zero),
                ]
            )

        return Tensor(frame, "uud", rule, antisymmetric(3), "P", "superpotential")

    @cached_property
    def force_coefficients(self) -> Tensor:
        """Coefficients F_ab^c = S_a^c_b + S_b^c_a, slots ddu, of the force f^c = F_ab^c q'^a q'^b.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        frame = self.connection.frame
        lower = self.S.lowered(2).components.get

        def rule(index: Index) -> Element:
            a, b, c = index
            return frame.field.sum([(1, lower((a, c, b))), (1, lower((b, c, a)))])

        tensor = Tensor(frame, "ddd", rule, symmetric(3), "f", "torsion force")
        return tensor.raised(2)

    def force(self, velocity: Sequence[Scalar] | Tensor) -> Tensor:
        """Force per unit mass that bends an autoparallel away from the geodesic.

        Equation
        --------
        f^c = 2 S_a^c_b q'^a q'^b                      [FizievKleinert1994], below eq. (6)

        Parameters
        ----------
        velocity
            q'^a, shape (n,), coordinates per unit of the curve parameter; or a tensor, slot u.

        Returns
        -------
        Tensor, shape (n,), index up, coordinate basis; coordinates per parameter squared.

        Raises
        ------
        ShapeError
            velocity does not have one component per coordinate.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, cartan
        >>> r, phi, u, w = sp.symbols("r phi u w", positive=True)
        >>> torsion = cartan(Frame([r, phi], [[1, 0], [0, r]])).torsion
        >>> torsion.force([u, w]).nonzero()
        {(0,): -r*w**2, (1,): u*w/r}
        """
        frame = self.connection.frame
        if not isinstance(velocity, Tensor):
            velocity = tensor_from_array(frame, "u", velocity, "velocity")
        return contract("abc,a,b->c", self.force_coefficients, velocity, velocity)

    def subs(self, values: Replaced, value: Value | None = None) -> Torsion:
        """The torsion with values for parameters and unknown functions (see Frame.subs)."""
        return self.connection.subs(values, value).torsion

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.connection,)

    def __deepcopy__(self, _: object) -> Torsion:
        """Itself: it never changes."""
        return self

    def __repr__(self) -> str:
        return repr(self.S)

    def _repr_latex_(self) -> str:
        return self.S._repr_latex_()

    _repr_html_ = drawn_by("notebook_tables", "torsion_html")


def scalar_of(torsion: Tensor) -> Element:
    """The torsion scalar of T_ij^k in the frame, slots DDU."""
    lower = torsion.lowered(2)
    upper = lower.raised()
    vector = contract("abb->a", lower.raised(2))
    squares = (
        (QUARTER, contract("abc,abc->", lower, upper)),
        (HALF, contract("abc,cba->", lower, upper)),
        (-1, vector @ vector.raised()),
    )
    return torsion.frame.field.sum([(factor, square.element()) for factor, square in squares])

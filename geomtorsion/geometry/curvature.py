"""Curvature: of any connection, with its traces and the square."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, overload

import sympy as sp

from geomtorsion.errors import ShapeError
from geomtorsion.exact import Element
from geomtorsion.geometry import riemannian
from geomtorsion.geometry.components import (
    RIEMANN,
    Index,
    Rule,
    Symmetry,
    antisymmetric,
    symmetric,
)
from geomtorsion.geometry.contraction import contract
from geomtorsion.geometry.frame_matrices import is_dense
from geomtorsion.geometry.parts import curvature_parts
from geomtorsion.geometry.substitution import Replaced, Value
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.geometry.torsion import scalar_of
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.hints import attribute_hints

if TYPE_CHECKING:
    from geomtorsion.geometry.connection import Connection
    from geomtorsion.geometry.frame import Frame
    from geomtorsion.geometry.indexing import One, Place

HALF = Fraction(1, 2)


@attribute_hints(tensor="curvature.riemann")
@exclusive
@dataclass(frozen=True, repr=False)
class Curvature:
    """Curvature of a connection.

    connection: Gamma_ab^c, a the direction of differentiation.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, cartan, levi_civita
    >>> theta, phi = sp.symbols("theta phi")
    >>> sphere = Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]])
    >>> levi_civita(sphere).curvature.scalar[()], cartan(sphere).curvature.is_zero
    (2, True)
    """

    connection: Connection

    @overload
    def __getitem__(self, index: tuple[Place, ...]) -> sp.Expr: ...
    @overload
    def __getitem__(self, index: One | tuple[One, ...]) -> Any: ...
    def __getitem__(self, index: One | tuple[One, ...]) -> Any:
        """R_mnl^k, as it is printed: a sympy expression, or an array of components (see Tensor)."""
        return self.riemann[index]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.riemann)

    @property
    def _is_riemannian(self) -> bool:
        """Whether the connection is the Levi-Civita connection."""
        return self.connection.kind == "levi-civita"

    @cached_property
    def riemann(self) -> Tensor:
        """Riemann tensor R_mnl^k, slots dddu.

        R_mnl^k = d_m G_nl^k - d_n G_ml^k - G_ml^t G_nt^k + G_nl^t G_mt^k

        Coordinate slots; along the legs: `.in_frame()`.
        """
        frame = self.connection.frame
        if self._is_riemannian:
            if is_dense(frame):
                return riemannian.riemann_in_frame(frame).raised(3).in_coordinates()
            return riemannian.riemann(frame).raised(3)
        rule = curvature_rule(self.connection)
        if self.connection.kind == "cartan":
            rule = self._unless_parallel(rule)
        return Tensor(frame, "dddu", rule, self._symmetry, "R", "curvature")

    def _unless_parallel(self, rule: Rule) -> Rule:
        """The rule, or zero where all legs are parallel, because the connection is flat then."""

        def shorter(index: Index) -> Element:
            zero = self.connection.frame.field.zero
            return zero if self.connection.has_parallel_legs else rule(index)

        return shorter

    @property
    def _symmetry(self) -> Symmetry:
        """Symmetry of the all-lower form."""
        if self._is_riemannian:
            return RIEMANN
        if self.connection.kind != "general":
            return antisymmetric(4) + antisymmetric(4, 2, 3)
        return antisymmetric(4)

    @cached_property
    def lower(self) -> Tensor:
        """Riemann tensor with all indices down, R_mnlk, slots dddd.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        if self._is_riemannian:
            return riemannian.riemann(self.connection.frame)
        return self.riemann.lowered(3)

    @cached_property
    def ricci(self) -> Tensor:
        """Ricci tensor R_nl = R_mnl^m, slots dd: positive for spheres.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        frame, of_metric = self.connection.frame, self._is_riemannian
        if of_metric and is_dense(frame):
            return riemannian.ricci_in_frame(frame).in_coordinates()
        n = frame.dimension
        mixed, lower = self.riemann.components.get, self.lower.components.get
        inverse = frame.inverse_metric.components

        def rule(index: Index) -> Element:
            j, i = index
            # The lower Riemann tensor has all its symmetries, so that fewer components are needed.
            if not of_metric:
                return frame.field.sum([(1, mixed((m, j, i, m))) for m in range(n)])
            entries = inverse.nonzero.items()
            return frame.field.sum([(1, x, lower((m, j, i, k))) for (m, k), x in entries])

        return Tensor(frame, "dd", rule, symmetric(2) if of_metric else (), "R", "Ricci tensor")

    @cached_property
    def scalar(self) -> Tensor:
        """Curvature scalar g^{nl} R_nl, rank 0."""
        frame = self.connection.frame

        def rule() -> Element:
            if self._is_riemannian and is_dense(frame):
                return scalar_from_anholonomy(frame)
            inverse, ricci = frame.inverse_metric.components.nonzero, self.ricci.components.get
            return frame.field.sum([(1, x, ricci(index)) for index, x in inverse.items()])

        return frame.scalar(rule, "R", "curvature scalar")

    @cached_property
    def einstein(self) -> Tensor:
        """Einstein tensor R_nl - g_nl R / 2, slots dd.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        frame, get = self.connection.frame, self.ricci.components.get
        metric = frame.metric.components.get

        def rule(index: Index) -> Element:
            scalar = self.scalar.element()
            return frame.field.sum([(1, get(index)), (-HALF, metric(index), scalar)])

        return Tensor(frame, "dd", rule, self.ricci.symmetry, "G", "Einstein tensor")

    @cached_property
    def weyl(self) -> Tensor:
        """Weyl tensor: trace-free part of R_mnlk, slots dddd (zero below three dimensions).

        C_mnlk = R_mnlk - (g_mk R_nl - g_nk R_ml - g_ml R_nk + g_nl R_mk) / (n - 2)
                 + R (g_mk g_nl - g_nk g_ml) / ((n - 1) (n - 2))

        Coordinate slots; along the legs: `.in_frame()`.
        """
        frame = self.connection.frame
        n = frame.dimension
        if n < 3:
            return Tensor(frame, "dddd", {}, RIEMANN, "C", "Weyl tensor")
        lower, R = self.lower.components.get, self.ricci.components.get
        g = frame.metric.components.get
        share, of_scalar = Fraction(1, n - 2), Fraction(1, (n - 1) * (n - 2))

        def rule(index: Index) -> Element:
            a, b, c, d = index
            scalar = self.scalar.element()
            return frame.field.sum(
                [
                    (1, lower(index)),
                    (-share, g((a, d)), R((b, c))),
                    (share, g((b, d)), R((a, c))),
                    (share, g((a, c)), R((b, d))),
                    (-share, g((b, c)), R((a, d))),
                    (of_scalar, g((a, d)), g((b, c)), scalar),
                    (-of_scalar, g((b, d)), g((a, c)), scalar),
                ]
            )

        return Tensor(frame, "dddd", rule, self._symmetry, "C", "Weyl tensor")

    @cached_property
    def schouten(self) -> Tensor:
        """Schouten tensor P_ab = (R_ab - R g_ab / (2 (n - 1))) / (n - 2), slots dd, for n >= 3.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        frame, n = self.connection.frame, self.connection.frame.dimension
        ricci, g = self.ricci.components.get, frame.metric.components.get

        def rule(index: Index) -> Element:
            if n < 3:
                raise ShapeError(
                    f"Schouten tensor: expected a space of three dimensions or more, got {n}. In "
                    "two dimensions use curvature.ricci."
                )
            share, of_scalar = Fraction(1, n - 2), Fraction(1, 2 * (n - 1) * (n - 2))
            scalar = self.scalar.element()
            return frame.field.sum([(share, ricci(index)), (-of_scalar, g(index), scalar)])

        return Tensor(frame, "dd", rule, self.ricci.symmetry, "P", "Schouten tensor")

    @cached_property
    def cotton(self) -> Tensor:
        """Cotton tensor C_abc = D_a P_bc - D_b P_ac, slots ddd, with the Schouten tensor P.

        In three dimensions it vanishes exactly where the metric is conformally flat. Above three
        D_k C_abc^k of the Weyl tensor is (n - 3) C_abc.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        frame = self.connection.frame
        derivative = self.connection.covariant_derivative(self.schouten).components.get

        def rule(index: Index) -> Element:
            a, b, c = index
            return frame.field.sum([(1, derivative((a, b, c))), (-1, derivative((b, a, c)))])

        return Tensor(frame, "ddd", rule, antisymmetric(3), "C", "Cotton tensor")

    @cached_property
    def parts(self) -> Mapping[str, Tensor]:
        """Irreducible parts of R_mnlk, slots dddd; they add up to `lower`.

        Names: weyl, paircom, pseudoscalar, ricci, antiricci, scalar. A connection that is not
        metric also has strain, R_mn(lk).

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, levi_civita
        >>> theta, phi = sp.symbols("theta phi")
        >>> sphere = Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]])
        >>> [name for name, part in levi_civita(sphere).curvature.parts.items() if not part.is_zero]
        ['scalar']
        """
        is_metric = self.connection.kind != "general" or bool(self.connection.metric_compatible)
        return curvature_parts(self.lower, is_metric=is_metric)

    @cached_property
    def kretschmann(self) -> Tensor:
        """Kretschmann scalar R_mnlk R^mnlk, rank 0."""
        frame = self.connection.frame

        def rule() -> Element:
            if not self._is_riemannian:
                upper = self.riemann.raised()
                return contract("abcd,abcd->", self.lower, upper).element()
            # R_ab^cd R_cd^ab, each pair in one order: four times the sum.
            born = riemannian.riemann_in_frame(frame).raised(3) if is_dense(frame) else self.riemann
            mixed = born.raised(2).components
            get = mixed.get
            terms = []
            for a, b, c, d in mixed.independent:
                if (a, b) <= (c, d):
                    times = 4 if (a, b) == (c, d) else 8
                    terms.append((times, get((a, b, c, d)), get((c, d, a, b))))
            return frame.field.sum(terms)

        return frame.scalar(rule, "K", "Kretschmann scalar")

    @property
    def is_zero(self) -> bool | None:
        """Whether the curvature vanishes; None if that cannot be decided."""
        return self.lower.is_zero if self._is_riemannian else self.riemann.is_zero

    def subs(self, values: Replaced, value: Value | None = None) -> Curvature:
        """The curvature with values for parameters and unknown functions (see Frame.subs)."""
        return self.connection.subs(values, value).curvature

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.connection,)

    def __deepcopy__(self, _: object) -> Curvature:
        """Itself: it never changes."""
        return self

    def __repr__(self) -> str:
        return repr(self.riemann)

    def _repr_latex_(self) -> str:
        return self.riemann._repr_latex_()

    _repr_html_ = drawn_by("notebook_tables", "curvature_html")


def curvature_rule(connection: Connection) -> Rule:
    """R_mnl^k from only the coefficients: valid for any connection.

    The rule differentiates each coefficient once.
    """
    frame = connection.frame
    gamma, field = connection.coefficients.components.get, frame.field
    n, q = frame.dimension, frame.coordinates

    def rule(index: Index) -> Element:
        m, n_, l, k = index  # noqa: E741  (the letters of the formula)
        terms: list = [(1, gamma((n_, l, k)).diff(q[m])), (-1, gamma((m, l, k)).diff(q[n_]))]
        for t in range(n):
            terms.append((-1, gamma((m, l, t)), gamma((n_, t, k))))
            terms.append((1, gamma((n_, l, t)), gamma((m, t, k))))
        return field.sum(terms)

    return rule


def scalar_from_anholonomy(frame: Frame) -> Element:
    """Curvature scalar of the metric, from only C_ij^k.

    R_bar = - T_scalar - 2 D_bar_a v^a with v_i = C_ij^j and D_bar_a v^a = E_i(v^i) + v_i v^i
    """
    anholonomy = frame.anholonomy
    vector = contract("abb->a", anholonomy)
    upper = vector.raised()
    terms: list = [(-1, scalar_of(anholonomy)), (-2, (vector @ upper).element())]
    for i, along in enumerate(frame.legs.components.columns):
        value = upper.components.get((i,))
        terms += [(-2, leg, value.diff(frame.coordinates[a])) for a, leg in along]
    return frame.field.sum(terms)

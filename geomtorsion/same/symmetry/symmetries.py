"""Symmetry: vector fields whose flow keeps a metric and a connection, counted and found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from geomtorsion.errors import ArgumentError, ShapeError, UndecidedError
from geomtorsion.exact import Echelon, Element, vanishing_sums
from geomtorsion.geometry import (
    Connection,
    Frame,
    LieAlgebra,
    Tensor,
    at_home,
    cartan,
    levi_civita,
    lie,
)
from geomtorsion.geometry.assumption import assumption_of
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.same.symmetry.symmetry_algebra import AtPoint, points
from geomtorsion.same.symmetry.symmetry_conditions import Conditions, difference, representatives
from geomtorsion.same.symmetry.symmetry_integration import IntegratedSymmetry
from geomtorsion.same.symmetry.symmetry_products import functions_of_coordinates, products, waves
from geomtorsion.same.symmetry.symmetry_search import killing_vectors
from geomtorsion.support import checks
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive

Row = list[Element]
KEEPS = ("metric", "teleparallel", "homothetic", "conformal")


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
        parallel legs, which separates good tetrads of a symmetric space from bad ones.
        "homothetic": L_xi g = 2 phi g with constant phi. "conformal": phi may be a function. A
        connection over the frame: the metric and this connection.

    Returns
    -------
    Symmetries, with the dimension at a generic point and the vectors of a stated ansatz.

    Raises
    ------
    ArgumentError
        `keep` has another value.
    ShapeError
        The connection belongs to another frame, or "conformal" in fewer than three dimensions.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> from geomtorsion.same import symmetries
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> plane = Frame([r, phi], [[1, 0], [0, r]])
    >>> print(symmetries(plane))
    3 symmetries of the metric, orbits of dimension 2
    algebra: e(2)
    vectors:
      [0, 1]
      [sin(phi), cos(phi)/r]
      [-cos(phi), sin(phi)/r]
    >>> symmetries(plane, keep="teleparallel").dimension
    1
    >>> symmetries(plane, keep="homothetic").dimension
    4
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
    if name == "teleparallel":
        return Symmetries(frame, cartan(frame))
    if name == "conformal" and frame.dimension < 3:
        raise ShapeError(
            f"keep: expected a space of three dimensions or more for conformal vectors, got "
            f'{frame.dimension}. In two dimensions there are infinitely many: use "homothetic".'
        )
    scaling = {"homothetic": 1, "conformal": 2}.get(name, 0)
    return Symmetries(frame, levi_civita(frame), scaling)


def killing_equations(frame: FrameLike) -> tuple[sp.Eq, ...]:
    """Killing equations (L_xi g)_ab = 0, a <= b, for unknown functions xi^a of the coordinates.

    Equation
    --------
    xi^m d_m g_ab + g_mb d_a xi^m + g_am d_b xi^m = 0

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> from geomtorsion.same import killing_equations
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
    scaling: 0; 1 if the metric may change by a constant factor, 2 if by a function.
    """

    frame: Frame
    connection: Connection
    scaling: int = 0

    @cached_property
    def kept(self) -> str:
        """The geometry that is preserved, in words."""
        if self.connection.kind == "levi-civita":
            return ("the metric", "the metric up to a factor", "the metric up to a function")[
                self.scaling
            ]
        return f"the metric and the {self.connection.name}"

    @cached_property
    def conditions(self) -> Conditions:
        """The linear conditions on the values of symmetries at a point."""
        return Conditions(self.frame, self.connection, self.scaling)

    @property
    def _echelon(self) -> Echelon:
        return self.conditions.echelons[1]

    @property
    def ranks(self) -> tuple[int, ...]:
        """Rank of the conditions with derivatives up to order 0, 1, ...: the last two are equal."""
        return tuple(self.conditions.echelons[0])

    @property
    def dimension(self) -> int:
        """The number of independent symmetries near a generic point."""
        return self._echelon.width - self.ranks[-1]

    @property
    def isotropy(self) -> int:
        """The number of fields that leave a generic point fixed."""
        n, echelon = self.frame.dimension, self._echelon
        turns = range(n, echelon.width)
        return len(turns) - echelon.rank_of_columns(turns)

    @property
    def orbits(self) -> int:
        """The dimension of the orbit of a generic point."""
        return self.dimension - self.isotropy

    @cached_property
    def algebra(self) -> LieAlgebra:
        """The Lie algebra of all symmetries, exact, from their values at one point.

        Its basis consists of the `vectors` if all have a closed form. Otherwise each basis element
        has one of the values that are free at the point equal to 1, and the others equal to 0.

        Equation
        --------
        With F_bc = D_b xi_c the bracket zeta of xi and xi' has
        zeta^a = xi^m F'_m^a - xi'^m F_m^a
        D_b zeta_c = F_b^m F'_mc - F'_b^m F_mc + (xi^m xi'^d - xi'^m xi^d) R_mcbd

        Parameters have generic values.

        Examples
        --------
        >>> import geomtorsion as gt
        >>> gt.symmetries("schwarzschild").algebra.name
        'so(3) + R'
        """
        closed = self.closed_form
        if len(closed) < self.dimension:
            return self._point.algebra
        fields = [self.conditions.values(xi) for xi in closed]
        for point in points(self.conditions):
            basis = point.basis(fields)
            if basis is not None:
                return LieAlgebra.of(point.algebra.exact.in_basis(basis))
        raise UndecidedError("the symmetries depend on each other at every point that was tried.")

    @cached_property
    def _point(self) -> AtPoint:
        """The conditions at one point."""
        return next(points(self.conditions))

    # -- vectors ---------------------------------------------------------------------------------

    @cached_property
    def vectors(self) -> tuple[Tensor | IntegratedSymmetry, ...]:
        """All symmetries: xi^a, slot u, in closed form and checked exactly, if there is one.

        See `ansatz` for the components searched. The remaining symmetries give their values at
        points, `vectors[k].at({"r": 3, ...})`, with errors: they are integrated from a base point.
        """
        closed = self.closed_form
        if len(closed) == self.dimension:
            return closed
        conditions = self._point.conditions
        rest = [
            IntegratedSymmetry(self.conditions, conditions, conditions.free[k])
            for k in self._point.missing([self.conditions.values(xi) for xi in closed])
        ]
        return (*closed, *rest)

    @cached_property
    def closed_form(self) -> tuple[Tensor, ...]:
        """The symmetries in closed form: xi^a, slot u, each checked exactly (see `ansatz`)."""
        if self.connection.kind != "levi-civita":
            return tuple(self._preserving(self._metric.closed_form))
        vectors: list[Tensor] = []
        slots = "ud" if self.frame.complex else "uDd"
        for degree, constants in ((1, False), (1, True), (2, False), (2, True)):
            functions = products(self.frame, self.waves, degree, constants)
            for slot in slots:
                if len(vectors) >= self.dimension:
                    break
                vectors = self._independent(
                    [*vectors, *killing_vectors(self.frame, functions, slot, self.scaling)]
                )
        return tuple(vectors)

    @cached_property
    def _metric(self) -> Symmetries:
        """The symmetries of the metric."""
        return Symmetries(self.frame, levi_civita(self.frame))

    @cached_property
    def waves(self) -> dict[sp.Symbol, list[sp.Expr]]:
        """Functions of the coordinates on which the metric does not depend."""
        metric = self if self.connection.kind == "levi-civita" else self._metric
        return waves(self.frame, metric._point)

    def _preserving(self, killing: Sequence[Tensor]) -> list[Tensor]:
        """Sums of Killing vectors that keep the connection as well."""
        frame, field = self.frame, self.frame.field
        extra = difference(self.connection, levi_civita(frame))
        changes = [lie(one, extra) for one in killing]
        rows = [[x.components.get(index) for x in changes] for index in representatives(extra)]
        vectors = []
        for weights in vanishing_sums(rows, len(killing)):
            pairs = list(zip(weights, killing, strict=True))
            values = {
                (b,): field.sum([(c, one.element(b)) for c, one in pairs])
                for b in range(frame.dimension)
            }
            vectors.append(Tensor(frame, "u", values, (), "\\xi", "symmetry"))
        return vectors

    def _independent(self, vectors: Sequence[Tensor]) -> list[Tensor]:
        """Elements that are not sums of others with constant coefficients."""
        echelon = Echelon(self.frame.field, self.conditions.width)
        return [xi for xi in vectors if echelon.add(self.conditions.values(xi))]

    @property
    def ansatz(self) -> str:
        """The components that were searched for vectors."""
        lists = functions_of_coordinates(self.frame, self.waves, 1)
        text = "; ".join(f"{q}: {', '.join(map(str, every))}" for q, every in lists.items())
        return (
            "components along coordinates or legs, sums of products with one factor or two of "
            f"each coordinate and with parameters: {text}"
        )

    def __repr__(self) -> str:
        return str(self)

    _repr_html_ = drawn_by("notebook_tables", "symmetries_html")

    def __str__(self) -> str:
        n = self.frame.dimension
        lines = [f"{self.dimension} symmetries of {self.kept}, orbits of dimension {self.orbits}"]
        lines.append(f"algebra: {self.algebra.name}")
        closed = self.closed_form
        if len(closed) == self.dimension:
            lines.append("vectors:" if closed else "no vectors")
        else:
            lines.append(f"{len(closed)} of {self.dimension} vectors have a closed form here:")
        lines += [f"  {[one[a] for a in range(n)]}" for one in closed]
        if len(closed) < self.dimension:
            lines += [f"  {one!r}" for one in self.vectors[len(closed) :]]
            lines.append(f"searched: {self.ansatz}")
        lines += filter(None, [assumption_of(self.frame)])
        return "\n".join(lines)

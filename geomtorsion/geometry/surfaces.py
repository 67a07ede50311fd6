"""Surface: a space inside another, with its induced metric, normal and extrinsic curvature."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import overload

import sympy as sp

from geomtorsion.errors import MetricError, ShapeError, TensorIndexError
from geomtorsion.exact import Element
from geomtorsion.geometry.change import Map, coordinate_map, moved_domain
from geomtorsion.geometry.components import Components, Index, determinant, symmetric
from geomtorsion.geometry.connections import FrameLike, as_frame, levi_civita
from geomtorsion.geometry.expansion import again, whole_of
from geomtorsion.geometry.forms import Form
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.homes import over_frame
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.geometry.validation import with_functions
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive


def surface(
    frame: FrameLike,
    coordinates: object,
    embedding: object = None,
    domain: object = None,
    orientation: int = 1,
) -> Surface:
    """Surface in the space of a frame, given by coordinates of the space as functions on it.

    Parameters
    ----------
    frame
        The space around the surface; only its metric counts.
    coordinates
        The coordinates of the surface, symbols or names: fewer than the space has.
    embedding
        {coordinate of the space: expression in coordinates of the surface}, or expressions in the
        order of the coordinates of the space. A coordinate without an expression is a coordinate of
        the surface if it is listed there, otherwise a constant parameter of the same name. New
        symbols are parameters; text may use known names only.
    domain
        Relations that hold on the surface.
    orientation
        1: the first component n_mu that does not vanish is positive at a sample point, so that the
        normal of r = const points to larger r; -1: the other side.

    Raises
    ------
    CoordinateError
        A coordinate is not known or has no expression.
    ShapeError
        There are not fewer coordinates than in the space.
    MetricError
        The induced metric is degenerate, as on a light cone.

    Examples
    --------
    >>> from geomtorsion.geometry import surface
    >>> from geomtorsion.spaces import load
    >>> hole = load("schwarzschild").frame
    >>> tube = surface(hole, "t theta phi")  # r = const
    >>> tube.extrinsic_curvature[0, 0], tube.extrinsic_curvature[1, 1]
    (-M*sqrt(r*(-2*M + r))/r**3, sqrt(r*(-2*M + r)))
    """
    frame = as_frame(frame)
    way = coordinate_map(frame, coordinates, {} if embedding is None else embedding)
    if len(way.new) >= frame.dimension:
        raise ShapeError(
            f"coordinates: expected fewer than {frame.dimension} for a surface, got "
            f"{len(way.new)}. For as many use frame.in_coordinates."
        )
    remedy = "Give the side of the normal."
    orientation = checks.choice(orientation, (1, -1), "orientation", ShapeError, remedy=remedy)
    return Surface(frame, way, tuple(moved_domain(frame, way, domain)), orientation)


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class Surface:
    """A surface in the space of a frame.

    ambient: the frame of the space. way: its coordinates as functions on the surface.
    domain: relations that hold on the surface. orientation: the side of the normal, 1 or -1.
    """

    ambient: Frame
    way: Map
    domain: tuple[sp.Basic, ...]
    orientation: int

    @cached_property
    def frame(self) -> Frame:
        """The frame of the induced metric g_ab = g_mu_nu d_a q^mu d_b q^nu."""
        whole = whole_of(self.ambient)
        if whole is not self.ambient:
            return again(Surface(whole, self.way, self.domain, 1).frame, self.ambient)
        n, size = self.ambient.dimension, len(self.way.new)
        metric = self.ambient.metric
        rows = [[metric[i, j] for j in range(n)] for i in range(n)]
        half = self.way.pulled(rows)
        entries = [
            [sp.Add(*(self.way.slope(mu, b) * half[mu][a] for mu in range(n))) for b in range(size)]
            for a in range(size)
        ]
        constants = [one for one in self.ambient.parameters if one not in self.way.new]
        return Frame.from_metric(
            self.way.new, entries, parameters=constants, domain=self.domain or None
        )

    @property
    def metric(self) -> Tensor:
        """The induced metric, slots dd."""
        return self.frame.metric

    def _on(self, components: Components) -> Components:
        """Components of the space as functions on the surface."""

        def moved(index: Index, value: Element) -> Element:
            (element,) = self.frame.read([(f"component {list(index)}", self.way(value.sympy))])
            return element

        return components.mapped(self.frame.field, moved)

    @cached_property
    def _slope(self) -> dict[tuple[int, int], Element]:
        """d_a q^mu at (mu, a)."""
        places = list(product(range(self.ambient.dimension), range(len(self.way.new))))
        read = self.frame.read([("slope of the embedding", self.way.slope(*x)) for x in places])
        return dict(zip(places, read, strict=True))

    @overload
    def pullback(self, field: Form) -> Form: ...
    @overload
    def pullback(self, field: Tensor) -> Tensor: ...
    def pullback(self, field: Tensor | Form) -> Tensor | Form:
        """Pullback to the surface of a tensor with lower indices, or of a form.

        Raises
        ------
        ShapeError
            It belongs to another frame.
        TensorIndexError
            An index is up.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Form, Frame, surface
        >>> x, y, z, t = sp.symbols("x y z t")
        >>> space = Frame([x, y, z], sp.eye(3))
        >>> helix = surface(space, [t], [sp.cos(t), sp.sin(t), t])
        >>> helix.pullback(Form(space, 1, {0: -y, 1: x, 2: 2}))
        3 dt
        """
        if isinstance(field, Form):
            if field.values:
                raise TensorIndexError(
                    f"form: expected a scalar-valued form, got values {field.values!r}. Take a "
                    "component with form.part(index)."
                )
            return Form.of(self.pullback(field.tensor))
        tensor = checks.instance(field, Tensor, "field")
        home = over_frame(self.ambient, tensor, "field", ShapeError)
        if set(field.slots) - set("dD"):
            raise TensorIndexError(
                f"{field.label}: expected lower indices for a pullback, got slots "
                f"{field.slots!r}. Lower them with lowered()."
            )
        plain = home.in_coordinates()
        components = self._on(plain.components).nonzero
        slope = self._slope

        def rule(index: Index) -> Element:
            terms = [
                (1, value, *(slope[mu, a] for mu, a in zip(place, index, strict=True)))
                for place, value in components.items()
            ]
            return self.frame.field.sum(terms)

        return Tensor(self.frame, plain.slots, rule, plain.symmetry, field.symbol, field.name)

    # -- hypersurfaces ---------------------------------------------------------------------------

    def _check_hypersurface(self) -> None:
        if len(self.way.new) != self.ambient.dimension - 1:
            raise ShapeError(
                f"expected a surface of {self.ambient.dimension - 1} dimensions, got "
                f"{len(self.way.new)}: only a hypersurface has one normal. The induced metric and "
                "pullbacks exist for all."
            )

    @cached_property
    def _normal(self) -> tuple[list[Element], list[Element], int]:
        """n_mu, n^mu and n.n, over the frame of the surface."""
        self._check_hypersurface()
        n, field = self.ambient.dimension, self.frame.field
        lower = []
        for mu in range(n):
            others = [nu for nu in range(n) if nu != mu]
            entries = {
                (i, a): self._slope[nu, a]
                for i, nu in enumerate(others)
                for a in range(n - 1)
                if not self._slope[nu, a].is_zero
            }
            minor = determinant(field, entries, n - 1)
            lower.append(-minor if mu % 2 else minor)
        inverse = self._on(self.ambient.inverse_metric.components)
        upper = [
            field.sum([(1, inverse.get((mu, nu)), lower[nu]) for nu in range(n)]) for mu in range(n)
        ]
        square = field.sum([(1, x, y) for x, y in zip(lower, upper, strict=True)])
        if square.is_zero:
            raise MetricError("expected a surface that is not null, got one whose normal is null.")
        sign = 1 if _value(self.frame, square) > 0 else -1
        size = (square * sign).sqrt().inverse()
        lower, upper = [x * size for x in lower], [x * size for x in upper]
        first = next(x for x in lower if not x.is_zero)
        side = self.orientation * (1 if _value(self.frame, first) > 0 else -1)
        return [x * side for x in lower], [x * side for x in upper], sign

    @property
    def normal(self) -> tuple[sp.Expr, ...]:
        """Unit normal n^mu in the coordinates of the space, as functions on the surface."""
        return tuple(x.sympy for x in self._normal[1])

    @property
    def normal_sign(self) -> int:
        """n.n: 1, or -1 where the normal is timelike for the signature (-+++)."""
        return self._normal[2]

    @cached_property
    def extrinsic_curvature(self) -> Tensor:
        """Extrinsic curvature K_ab = (D_mu n_nu) d_a q^mu d_b q^nu, slots dd, symmetric.

        D is the Levi-Civita derivative of the space. With the outward normal a sphere has positive
        curvature.
        """
        lower, _, _ = self._normal
        n, field = self.ambient.dimension, self.frame.field
        gamma = self._on(levi_civita(self.ambient).coefficients.components).nonzero
        slope, new = self._slope, self.way.new

        def rule(index: Index) -> Element:
            a, b = index
            terms: list = [(-1, lower[m], slope[m, a].diff(new[b])) for m in range(n)]
            for (i, j, m), value in gamma.items():
                terms.append((-1, lower[m], value, slope[i, a], slope[j, b]))
            return field.sum(terms)

        return Tensor(self.frame, "dd", rule, symmetric(2), "K", "extrinsic curvature")

    @cached_property
    def mean_curvature(self) -> Tensor:
        """Mean curvature K = g^ab K_ab, rank 0: 2/r on a sphere."""
        frame, K = self.frame, self.extrinsic_curvature.components.get

        def rule() -> Element:
            entries = frame.inverse_metric.components.nonzero
            return frame.field.sum([(1, x, K(index)) for index, x in entries.items()])

        return frame.scalar(rule, "K", "mean curvature")

    def __repr__(self) -> str:
        pairs = zip(self.way.old, self.way.functions, strict=True)
        text = ", ".join(f"{q} = {f}" for q, f in pairs)
        return f"surface ({', '.join(map(str, self.way.new))}): {text}"


def _value(frame: Frame, element: Element) -> float:
    """A value at the sample point, for signs."""
    point = with_functions(element, frame.region.point)
    return complex(element.evaluate(point)).real

"""Connection: coefficients of any affine connection and the quantities derived from them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, ClassVar, overload

import numpy as np

from geomtorsion.errors import ShapeError, TensorIndexError
from geomtorsion.exact import Element
from geomtorsion.geometry import integrability, riemannian
from geomtorsion.geometry.assumption import assumption_latex, assumption_of
from geomtorsion.geometry.components import (
    Components,
    Index,
    Rule,
    antisymmetric,
    shifted,
    symmetric,
)
from geomtorsion.geometry.contraction import contract
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.frame_matrices import is_dense, parallel_rows
from geomtorsion.geometry.holonomy import HolonomyAlgebra, holonomy
from geomtorsion.geometry.homes import over_frame
from geomtorsion.geometry.notation import ComponentTable, Names, Where
from geomtorsion.geometry.parts import nonmetricity_parts
from geomtorsion.geometry.substitution import Replaced, Value, replacements
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import instance
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.hints import attribute_hints

if TYPE_CHECKING:
    import sympy as sp
    from numpy.typing import DTypeLike

    from geomtorsion.geometry.curvature import Curvature
    from geomtorsion.geometry.forms import Form
    from geomtorsion.geometry.indexing import One, Place
    from geomtorsion.geometry.torsion import Torsion

HALF = Fraction(1, 2)


@attribute_hints(
    ricci="connection.curvature.ricci",
    riemann="connection.curvature.riemann",
    T="connection.torsion.T",
    S="connection.torsion.S",
    metric="connection.frame.metric",
    christoffel="connection.coefficients",
    gamma="connection.coefficients",
)
@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class Connection:
    """An affine connection over a frame.

    frame: the frame it is made from.
    coefficients: Gamma_ab^c, coordinate slots ddu, a the direction of differentiation; nested
        lists or an array are read as in `from_coefficients`. `spin_connection` has leg slots.
    name: its name in messages.
    kind: "cartan" or "levi-civita" where a shorter way to its curvature is known, "metric" where
        it is metric compatible by its construction, else "general".
    maker: function that makes the connection from its frame, or None; copies and pickles use it.
    allowed: numbers of the legs that constraints permit (see `constrained`); None: all legs.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, cartan, levi_civita
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> frame = Frame([r, phi], [[1, 0], [0, r]])
    >>> cartan(frame)[0, 1, 1], levi_civita(frame)[1, 1, 0]
    (1/r, -r)
    """

    frame: Frame
    coefficients: Tensor
    name: str = "connection"
    kind: str = "general"
    maker: Callable[[Frame], Connection] | None = None
    allowed: tuple[int, ...] | None = None

    has_own_field: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Read coefficients, which do not form a tensor."""
        if not isinstance(self.coefficients, Tensor):
            # Functions that make connections import this file.
            from geomtorsion.geometry.connections import from_coefficients

            read = from_coefficients(self.frame, self.coefficients)
            object.__setattr__(self, "frame", read.frame)
            object.__setattr__(self, "coefficients", read.coefficients)

    @overload
    def __getitem__(self, index: tuple[Place, ...]) -> sp.Expr: ...
    @overload
    def __getitem__(self, index: One | tuple[One, ...]) -> Any: ...
    def __getitem__(self, index: One | tuple[One, ...]) -> Any:
        """Gamma_ab^c as a sympy expression, or an array of coefficients (see Tensor)."""
        return self.coefficients[index]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.coefficients)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> np.ndarray:
        """All coefficients Gamma_ab^c (see Tensor)."""
        return np.asarray(self.coefficients, dtype=dtype)

    def table(
        self, names: Names | None = None, *, where: Where | None = None, every: bool = False
    ) -> ComponentTable:
        """The coefficients that do not vanish, with names of their indices (see Tensor.table).

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, levi_civita
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> bar = levi_civita(Frame([r, phi], [[1, 0], [0, r]]))
        >>> print(bar.table("rφ", where={2: "r"}))  # only Gamma_ab^r
        Levi-Civita Gamma_bar_{ab}^{c}: 3 of 8 components do not vanish
          Gamma_bar_{φφ}^{r}  [1, 1, 0]  -r
        """
        return self.coefficients.table(names, where=where, every=every)

    # -- deviations from the metric and from the frame -------------------------------------------

    @cached_property
    def torsion(self) -> Torsion:
        """Torsion and its parts."""
        # A torsion is made of a connection, so that the two files import each other.
        from geomtorsion.geometry.torsion import Torsion

        return Torsion(self)

    @cached_property
    def curvature(self) -> Curvature:
        """Curvature and its traces."""
        # A curvature is made of a connection, so that the two files import each other.
        from geomtorsion.geometry.curvature import Curvature

        return Curvature(self)

    @cached_property
    def holonomy_algebra(self) -> HolonomyAlgebra:
        """The Lie algebra of the rotations by which loops turn vectors (see HolonomyAlgebra).

        Examples
        --------
        >>> import geomtorsion as gt
        >>> gt.levi_civita("s2").holonomy_algebra.dimension
        1
        """
        riemann, is_metric = self.curvature.riemann, self.kind != "general"
        return holonomy(riemann, self.covariant_derivative, self.name, is_metric)

    @cached_property
    def nonmetricity(self) -> Tensor:
        """Nonmetricity Q_abc = D_a g_bc, slots ddd, symmetric in bc.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        lower = self.coefficients.lowered(2).components.get
        derivative = riemannian.metric_derivative(self.frame).get

        def rule(index: Index) -> Element:
            a, b, c = index
            terms = [(1, derivative(index)), (-1, lower((a, b, c))), (-1, lower((a, c, b)))]
            return self.frame.field.sum(terms)

        return Tensor(self.frame, "ddd", rule, symmetric(3, 1, 2), "Q", "nonmetricity")

    @cached_property
    def nonmetricity_parts(self) -> Mapping[str, Tensor]:
        """Irreducible parts of Q_abc, slots ddd: symmetric, mixed, Lambda, Weyl; they add up.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, from_coefficients
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> polar = Frame([r, phi], [[1, 0], [0, r]])
        >>> bare = from_coefficients(polar, [[[0, 0], [0, 0]], [[0, 0], [0, 0]]])
        >>> bare.nonmetricity[0, 1, 1], bare.nonmetricity_parts["Weyl"][0, 1, 1]
        (2*r, r)
        """
        return nonmetricity_parts(self.nonmetricity)

    @cached_property
    def contortion(self) -> Tensor:
        """Contortion K_ab^c = S_ab^c - S_b^c_a + S^c_ab, slots ddu.

        For a metric connection it is Gamma_ab^c - Gamma_bar_ab^c. K_abc is
        antisymmetric in b and c.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        if self.kind == "cartan" and is_dense(self.frame):
            # In the frame its own coefficients vanish.
            return riemannian.contortion_in_frame(self.frame).in_coordinates()
        if self.kind != "general":
            bar = riemannian.christoffel(self.frame)
            difference = self.coefficients - bar
            symmetry = antisymmetric(3, 1, 2)
            return Tensor(self.frame, "ddu", difference.components, symmetry, "K", "contortion")
        return self.contortion_from_torsion

    @cached_property
    def contortion_from_torsion(self) -> Tensor:
        """The contortion by its definition in terms of the torsion, for any connection."""
        return riemannian.contortion_of(self.torsion.S)

    @cached_property
    def disformation(self) -> Tensor:
        """Disformation L_ab^c, L_abc = -(Q_abc + Q_bac - Q_cab) / 2, slots ddu, symmetric in ab.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        nonmetricity = self.nonmetricity.components.get

        def rule(index: Index) -> Element:
            a, b, c = index
            places = ((-HALF, (a, b, c)), (-HALF, (b, a, c)), (HALF, (c, a, b)))
            return self.frame.field.sum([(sign, nonmetricity(place)) for sign, place in places])

        return Tensor(self.frame, "ddd", rule, symmetric(3), "L", "disformation").raised(2)

    @cached_property
    def coframe_deviation(self) -> Tensor:
        """W_ab^j = Gamma_ab^m e^j_m - d_a e^j_b, slots ddU: minus D_a e^j_b of each form.

        A capital is a leg slot, a small letter a coordinate slot; along the legs: `.in_frame()`.
        """
        rule = self._deviation(self.frame.coframe.components, self.frame.coframe_derivative)
        return Tensor(self.frame, "ddU", rule, (), "W", "coframe deviation", anchored=(1, 2))

    @cached_property
    def has_parallel_legs(self) -> bool | None:
        """Whether all legs of the frame are parallel, which makes the connection flat."""
        rows = parallel_rows(self.frame)
        return Tensor(self.frame, "ddU", self._deviation(rows.forms, rows.derivative)).is_zero

    def _deviation(self, forms: Components, derivatives: Components) -> Rule:
        """Gamma_ab^m r^j_m - (derivative of r)_ajb for rows r^j of one-forms."""
        coefficients, derivative = self.coefficients.components.get, derivatives.get

        def rule(index: Index) -> Element:
            a, b, j = index
            # One sum for all: the field brings its terms over one denominator only once.
            terms: list = [(1, coefficients((a, b, m)), leg) for m, leg in forms.rows[j]]
            return self.frame.field.sum([*terms, (-1, derivative((a, j, b)))])

        return rule

    @cached_property
    def spin_connection(self) -> Tensor:
        """Spin connection omega_ai^j = e^j_m D_a E_i^m, slots dDU; only a may change its basis.

        A capital is a leg slot, a small letter a coordinate slot; along the legs: `.in_frame()`.
        """
        deviation = self.coframe_deviation
        free = Tensor(self.frame, "ddU", deviation.components, (), "\\omega", "spin connection")
        turned = free._with_slot(1, "D")
        return Tensor(
            self.frame,
            "dDU",
            turned.components,
            (),
            "\\omega",
            "spin connection",
            anchored=(1, 2),
        )

    def covariant_derivative(self, tensor: Tensor) -> Tensor:
        """Covariant derivative D_a of a tensor; its index a, coordinate and down, comes first.

        Equation
        --------
        D_a v^m = d_a v^m + Gamma_ab^m v^b;  D_a w_m = d_a w_m - Gamma_am^b w_b;
        frame indices with the spin connection instead of Gamma.

        Raises
        ------
        TensorIndexError
            The argument is not a tensor, but for example connection coefficients.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, levi_civita
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> frame = Frame([r, phi], [[1, 0], [0, r]])
        >>> levi_civita(frame).covariant_derivative(frame.metric).is_zero
        True
        """
        frame = self.frame
        home = over_frame(frame, instance(tensor, Tensor, "tensor"), "tensor", ShapeError)
        if tensor.anchored:
            raise TensorIndexError(
                f"{tensor.label}: expected a tensor in all its indices, got other components."
            )
        tensor = home
        get, n, coordinates = tensor.components.get, frame.dimension, frame.coordinates
        tables = {"d": self.coefficients.components.get}
        if tensor.slots != tensor.slots.lower():
            tables["D"] = self.spin_connection.components.get

        zero = frame.field.zero

        def rule(index: Index) -> Element:
            a, rest = index[0], index[1:]
            terms: list = [(1, get(rest).diff(coordinates[a]))]
            for k, slot in enumerate(tensor.slots):
                table = tables["d" if slot in "du" else "D"]
                up = slot in "uU"
                head, own, tail = rest[:k], rest[k], rest[k + 1 :]
                for b in range(n):
                    coefficient = table((a, b, own) if up else (a, own, b))
                    # A component that multiplies zero is not computed.
                    if coefficient is not zero:
                        terms.append((1 if up else -1, coefficient, get((*head, b, *tail))))
            return frame.field.sum(terms)

        symmetry = shifted(tensor.symmetry, 1)
        return Tensor(frame, "d" + tensor.slots, rule, symmetry, f"D{tensor.symbol}", "")

    def divergence(self, tensor: Tensor, index: int = 0) -> Tensor:
        """Divergence D_a t^{... a ...}: the derivative contracted with one index of a tensor.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, levi_civita
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> plane = Frame([r, phi], [[1, 0], [0, r]])
        >>> levi_civita(plane).divergence(plane.vector([r, 0]))[()]
        2
        """
        raised = instance(tensor, Tensor, "tensor").raised(index)
        derivative = self.covariant_derivative(raised)
        if raised.slots[index] == "U":
            derivative = derivative._with_slot(0, "D")
        letters = "bcdefghijklmnopqrstuvwxyz"[: len(raised.slots)]
        summed = letters[:index] + "a" + letters[index + 1 :]
        rest = letters[:index] + letters[index + 1 :]
        return contract(f"a{summed}->{rest}", derivative)

    def laplacian(self, tensor: Tensor) -> Tensor:
        """Laplacian g^{ab} D_a D_b of a tensor, of the same slots; Laplace-Beltrami for scalars.

        With a Lorentzian metric this is the d'Alembertian. It is the rough Laplacian: curvature
        terms, as in the Laplacian of Hodge, are not added.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, levi_civita
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> plane = Frame([r, phi], [[1, 0], [0, r]])
        >>> levi_civita(plane).laplacian(plane.scalar(r**3))[()]
        9*r
        """
        second = self.covariant_derivative(self.covariant_derivative(tensor))
        letters = "cdefghijklmnopqrstuvwxyz"[: len(tensor.slots)]
        return contract(f"ab,ab{letters}->{letters}", self.frame.inverse_metric, second)

    def dalembertian(self, tensor: Tensor) -> Tensor:
        """g^{ab} D_a D_b of a tensor: the name of `laplacian` for a Lorentzian metric.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, levi_civita
        >>> t, x = sp.symbols("t x")
        >>> plane = Frame([t, x], [[1, 0], [0, 1]], signature=(-1, 1))
        >>> levi_civita(plane).dalembertian(plane.scalar(sp.sin(t + 2 * x)))[()]
        -3*sin(t + 2*x)
        """
        return self.laplacian(tensor)

    # -- forms -----------------------------------------------------------------------------------

    def torsion_form(self, *index: int) -> Form:
        """Torsion two-form T^k = d e^k + omega_i^k ^ e^i, of all legs or of leg k.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, cartan
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> cartan(Frame([r, phi], [[1, 0], [0, r]])).torsion_form(1)
        dr ^ dphi
        """
        # A form is taken along connections, so that the two files import each other.
        from geomtorsion.geometry.forms import torsion_form

        return torsion_form(self).part(*index) if index else torsion_form(self)

    def curvature_form(self, *index: int) -> Form:
        """Curvature two-form R_i^j = d omega_i^j + omega_k^j ^ omega_i^k, of all legs or of i, j.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, levi_civita
        >>> theta, phi = sp.symbols("theta phi")
        >>> sphere = Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]])
        >>> levi_civita(sphere).curvature_form(1, 0)
        sin(theta) dtheta ^ dphi
        """
        # See torsion_form.
        from geomtorsion.geometry.forms import curvature_form

        return curvature_form(self).part(*index) if index else curvature_form(self)

    def connection_form(self, *index: int) -> Form:
        """Connection one-form omega_i^j = omega_ai^j dq^a, of all legs or of legs i, j.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, levi_civita
        >>> theta, phi = sp.symbols("theta phi")
        >>> sphere = Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]])
        >>> levi_civita(sphere).connection_form(0, 1)
        cos(theta) dphi
        """
        # See torsion_form.
        from geomtorsion.geometry.forms import connection_form

        return connection_form(self).part(*index) if index else connection_form(self)

    @cached_property
    def transposed(self) -> Connection:
        """The connection Gamma_ba^c: the same autoparallels, the opposite torsion.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, cartan
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> polar = cartan(Frame([r, phi], [[1, 0], [0, r]]))
        >>> polar.torsion.T[0, 1, 1], polar.transposed.torsion.T[0, 1, 1]
        (1/r, -1/r)
        >>> polar.volume, polar.transposed.volume
        (parallel volume: r, parallel volume: 1)
        """
        if self.is_torsion_free:
            return self
        get, what = self.coefficients.components.get, ("\\Gamma", "connection")
        swapped = Tensor(self.frame, "ddu", lambda x: get((x[1], x[0], x[2])), (), *what, (1, 2))
        return Connection(self.frame, swapped, f"transposed {self.name}")

    @cached_property
    def volume(self) -> integrability.ParallelVolume:
        """Parallel volume f sqrt|g|, or the component that rules it out; decided exactly.

        D_a (f sqrt|g|) = 0 for d_a log f = Gamma_ab^b - d_a log sqrt|g|. A metric connection keeps
        sqrt|g|. Integration of D_a w^a by parts needs the volume of `transposed` (Saa 1993). For a
        metric connection with torsion vector 3 d_a Theta it is exp(-3 Theta) sqrt|g| (Fiziev 1998).
        """
        return integrability.parallel_volume(self.coefficients, self.kind != "general")

    def subs(self, values: Replaced, value: Value | None = None) -> Connection:
        """The connection with values for parameters and unknown functions (see Frame.subs).

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, cartan
        >>> r, phi, k = sp.symbols("r phi k", positive=True)
        >>> cone = Frame([r, phi], [[1, 0], [0, k * r]])
        >>> cartan(cone).subs({k: 2}) is cartan(cone.subs({k: 2}))
        True
        """
        values = replacements(values, value)
        if self.maker is not None:
            return self.maker(self.frame.subs(values))
        coefficients = self.coefficients.subs(values)
        return Connection(coefficients.frame, coefficients, self.name, self.kind)

    def in_coordinates(self, new: object, old: object, domain: object = None) -> Connection:
        """The connection over its frame in other coordinates (see Frame.in_coordinates).

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, cartan
        >>> x, y = sp.symbols("x y")
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> flat = cartan(Frame([x, y], [[1, 0], [0, 1]]))
        >>> flat.in_coordinates([r, phi], [r * sp.cos(phi), r * sp.sin(phi)])[1, 1, 0]
        -r
        """
        # A change of coordinates makes connections, so that the two files import each other.
        from geomtorsion.geometry.change import connection_in

        return connection_in(self, new, old, domain)

    # -- verdicts --------------------------------------------------------------------------------

    @property
    def is_flat(self) -> bool | None:
        """Whether the curvature vanishes."""
        return self.curvature.riemann.is_zero

    @property
    def metric_compatible(self) -> bool | None:
        """Whether the metric is parallel, so that transport keeps lengths and angles."""
        return self.nonmetricity.is_zero

    @cached_property
    def integrable(self) -> integrability.Integrability:
        """Whether the constraints are holonomic: the permitted velocities are tangent to surfaces.

        They are holonomic exactly if the torsion components along the forbidden legs vanish
        (Frobenius); see `constrained`. Without constraints the answer is yes.
        """
        legs = range(self.frame.dimension) if self.allowed is None else self.allowed
        return integrability.integrability(self.torsion.T, legs)

    @property
    def is_torsion_free(self) -> bool | None:
        """Whether the coefficients are symmetric."""
        return self.torsion.S.is_zero

    # -- equality and copies ---------------------------------------------------------------------

    def __eq__(self, other: object) -> bool:
        """Equal frames, permitted legs and coefficients, decided exactly; names do not count."""
        if not isinstance(other, Connection):
            return NotImplemented
        if self is other:
            return True
        if self.allowed != other.allowed or self.frame != other.frame:
            return False
        if self.maker is not None and self.maker == other.maker:
            return True
        return self.coefficients == other.coefficients

    def __hash__(self) -> int:
        return hash((self.frame, self.allowed))

    def _carried(self, frame: Frame) -> Connection:
        """This connection over an equal frame."""
        if self.maker is not None:
            return self.maker(frame)
        return replace(self, frame=frame, coefficients=self.coefficients._carried(frame))

    def __reduce__(self) -> tuple[object, ...]:
        # The frame can make its own connections again, bit for bit; that pickle is shorter.
        if self.maker is not None:
            return self.maker, (self.frame,)
        return type(self), (self.frame, self.coefficients, self.name, self.kind)

    def __deepcopy__(self, _: object) -> Connection:
        """Itself: it never changes."""
        return self

    @property
    def assumption(self) -> str:
        """Remark on the assumed region, if the coefficients or the permitted legs depend on it.

        Examples
        --------
        >>> from geomtorsion.geometry import Frame, cartan
        >>> cartan(Frame("x y", [["log(x)", 0], [0, 1]])).assumption
        'for 0 < x < 1, assumed; declare domain=[...] for another region'
        """
        independent = self.coefficients.components.independent
        return assumption_of(self.frame, None if self.allowed else independent.values())

    def __repr__(self) -> str:
        text = f"{self.name} {repr(self.coefficients).removeprefix(f'{self.coefficients.name} ')}"
        remark = self.assumption
        return f"{text}\n  {remark}" if remark and remark not in text else text

    def _repr_latex_(self) -> str:
        text = self.coefficients._repr_latex_()
        remark = assumption_latex(self.frame) if self.allowed else ""
        return text if not remark or remark in text else rf"{text[:-1]}\quad {remark}$"

    _repr_html_ = drawn_by("notebook_tables", "connection_html")

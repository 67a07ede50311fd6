"""Frame: a field of frames and its coframe, with everything that follows from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import FunctionType, MethodType
from typing import TYPE_CHECKING, Any, ClassVar

import sympy as sp

from geomtorsion.errors import ArgumentError
from geomtorsion.exact import Branch, Element, Field
from geomtorsion.geometry import (
    constructors,
    evaluation,
    frame_matrices,
    homes,
    naming,
    notation,
    substitution,
    validation,
)
from geomtorsion.geometry.components import Components, alternating, inverse, symmetric
from geomtorsion.geometry.frame_text import toml_text
from geomtorsion.geometry.from_arrays import tensor_from_array
from geomtorsion.geometry.real_points import RationalPoint
from geomtorsion.geometry.regions import Region, regions
from geomtorsion.geometry.substitution import Replaced, Value, replacements
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support import arguments, checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive, unlocked
from geomtorsion.support.hints import attribute_hints

if TYPE_CHECKING:
    from geomtorsion.geometry.forms import Form
    from geomtorsion.geometry.plan import DependencyGraph

Elements = dict[tuple[int, int], Element]
Plain = tuple[str, validation.Matrix] | tuple[Callable[..., "Frame"], tuple[object, ...]]


@attribute_hints(
    torsion="gt.cartan(frame).torsion",
    curvature="gt.levi_civita(frame).curvature",
    ricci="gt.levi_civita(frame).curvature.ricci",
    riemann="gt.levi_civita(frame).curvature.riemann",
    connection="gt.cartan(frame)",
    christoffel="gt.levi_civita(frame)",
    det="frame.determinant",
    e="frame.coframe",
    g="frame.metric",
    plot="frame.metric.plot(at={...})",
    tetrad="frame.coframe",
    vielbein="frame.coframe",
)
@exclusive
@dataclass(frozen=True, eq=False, repr=False, init=False)
class Frame:
    """A frame field: n one-forms e^i = e^i_mu dq^mu and the constant metric eta of the frame.

    coordinates: symbols q^mu, in the order of the columns.
    parameters: every other symbol, constant in all derivatives.
    domain: relations between symbols that hold where the frame is used.
    complex: whether legs may be complex (null tetrads).
    name: its name in messages and pages.
    field: the exact field of all components.
    given: the matrices it was made from, as exact elements: eta and coframe, legs or metric.
    attached: further data by name: "atlas", "names" for printing, and "substituted": the frame and
        the values from which `subs` made it.

    Parameters
    ----------
    coframe
        e^i_mu, rows i, columns mu: nested lists or a sympy matrix. Entries may be text in the
        coordinates and the listed parameters, and rows one-forms in text: ["dr", "r dphi"].
    signature
        a tuple of signs, a text such as "-+++", or a constant symmetric matrix eta; None: all +1.
    domain
        one relation or several, also as text: "r > 0, 0 < theta < pi".
    branches
        {root: value} for roots that are rational in other symbols and shall not have the positive
        sign, such as {sqrt(1 - sin(x)**2): -cos(x)}.

    Raises
    ------
    CoframeError
        The coframe is not square, or its determinant vanishes identically.
    ShapeError
        The number of coordinates differs from the number of columns.
    CoordinateError
        Coordinates are repeated or clash with parameters.
    SignatureError
        eta is not constant, symmetric and regular.
    ExpressionError
        An entry cannot be read exactly (Piecewise, floats, Abs of a term with both signs in the
        domain, ...); the message names it.

    Examples
    --------
    >>> import sympy as sp
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> frame = Frame([r, phi], [[1, 0], [0, r]])
    >>> frame.metric[1, 1], frame.legs[1, 1], frame.anholonomy[0, 1, 1]
    (r**2, 1/r, 1/r)
    >>> cone = Frame("r phi", [["1", "0"], ["0", "k r"]], parameters="k", domain="r > 0")
    >>> cone.metric[1, 1], cone.domain
    (k**2*r**2, (r > 0,))
    """

    coordinates: tuple[sp.Symbol, ...]
    parameters: tuple[sp.Symbol, ...]
    domain: tuple[sp.Basic, ...]
    complex: bool
    name: str
    field: Field
    given: Mapping[str, Elements]
    attached: dict[str, Any]

    has_own_field: ClassVar[bool] = True

    @exclusive
    def __init__(
        self,
        coordinates: arguments.Coordinates,
        coframe: arguments.Matrix,
        signature: arguments.Signature | None = None,
        parameters: arguments.Parameters | None = None,
        domain: arguments.Domain | None = None,
        complex: bool = False,
        name: str | None = None,
        branches: Mapping[sp.Expr, sp.Expr] | None = None,
    ) -> None:
        n, entries = validation.typed_entries(coframe, "coframe", coordinates, parameters)
        signs = validation.signature_entries(signature, n)
        opened = validation.opened(
            coordinates, n, entries, parameters, domain, complex, branches, "coframe", signs
        )
        elements = validation.read_matrix(opened.field, entries, "coframe")
        eta = validation.read_signature(opened.field, signs, n)
        validation.check_regular(opened.field, elements, n, "coframe")
        self.fill(opened, name, {"coframe": elements, "eta": eta}, ("coframe", entries))

    def fill(
        self,
        opened: validation.Opened,
        name: str | None,
        given: Mapping[str, Elements],
        plain: Plain,
    ) -> None:
        """Set the fields of a new frame, once all is checked (for makers).

        plain: what it is made from (coframe, legs or metric), unchanged; or a maker of frames with
            its arguments, where that is shorter.
        """
        for key in ("coordinates", "parameters", "domain", "complex", "field"):
            object.__setattr__(self, key, getattr(opened, key))
        object.__setattr__(
            self, "name", "" if name is None else checks.text(name, "name", ArgumentError)
        )
        object.__setattr__(self, "given", given)
        object.__setattr__(self, "_derived", {})
        object.__setattr__(self, "attached", {})
        object.__setattr__(self, "_plain", plain)
        # The frame does not rely on anything read into the field later.
        self.field.settle()
        object.__setattr__(self, "_branches", self.field.branches)
        # A frame that is adapted to another frame shares its field.
        self.field.owner = self.field.owner or self

    if TYPE_CHECKING:
        _branches: tuple[Branch, ...]
        _derived: dict[tuple[object, ...], Any]
        _plain: Plain

    @classmethod
    def from_frame(
        cls,
        coordinates: arguments.Coordinates,
        legs: arguments.Matrix,
        signature: arguments.Signature | None = None,
        parameters: arguments.Parameters | None = None,
        domain: arguments.Domain | None = None,
        complex: bool = False,
        name: str | None = None,
        branches: Mapping[sp.Expr, sp.Expr] | None = None,
    ) -> Frame:
        """Frame from its legs: legs[mu, i], one leg per column.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> Frame.from_frame([r, phi], [[1, 0], [0, 1 / r]]).coframe[1, 1]
        r
        """
        return constructors.from_frame(
            cls, coordinates, legs, signature, parameters, domain, complex, name, branches
        )

    @classmethod
    def from_metric(
        cls,
        coordinates: arguments.Coordinates,
        metric: arguments.Matrix | Sequence[arguments.Entry],
        signature: arguments.Signature | None = None,
        parameters: arguments.Parameters | None = None,
        domain: arguments.Domain | None = None,
        name: str | None = None,
        branches: Mapping[sp.Expr, sp.Expr] | None = None,
    ) -> Frame:
        """Orthonormal frame of a metric g_{mu nu}, by completing squares (Lagrange, LDL).

        The metric is kept as given, so that Levi-Civita quantities never see the square roots; the
        roots are taken when the coframe itself is first read. Without a signature the rows have the
        signs that the metric has in the domain. The metric is a matrix, a list of its diagonal, or
        a line element in text.

        Raises
        ------
        MetricError
            The metric is not symmetric, degenerate, or has another signature.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> Frame.from_metric([r, phi], [[1, 0], [0, r**2]]).coframe[1, 1]
        r
        >>> hole = "-(1 - 2M/r) dv^2 + 2 dv dr + r^2 (dtheta^2 + sin(theta)^2 dphi^2)"
        >>> Frame.from_metric("v r theta phi", hole, parameters="M").metric[0, 1]
        1
        """
        return constructors.from_metric(
            cls, coordinates, metric, signature, parameters, domain, name, branches
        )

    @classmethod
    def from_structure_constants(
        cls,
        constants: arguments.Cube | Mapping[tuple[int, int, int], arguments.Entry],
        coordinates: arguments.Coordinates | None = None,
        signature: arguments.Signature | None = None,
        name: str | None = None,
    ) -> Frame:
        """Left-invariant frame of the Lie group with given structure constants.

        Equation
        --------
        [E_i, E_j] = C_ij^k E_k,  de^k = -(1/2) C_ij^k e^i ^ e^j     (Maurer and Cartan)

        Parameters
        ----------
        constants
            C_ij^k, shape (n, n, n): the brackets of the legs. The object of anholonomy of the
            frame, 2 S of its Cartan connection, is minus these. Entries are numbers or parameters.
            A mapping {(0, 1, 2): 1} lists the nonzero ones, each for one order of i and j.
        coordinates
            Coordinates of the second kind; x1 ... xn if not given.

        Raises
        ------
        StructureConstantError
            C is not antisymmetric, violates the Jacobi identity (indices named), or has an
            adjoint matrix whose exponential is not elementary.

        Examples
        --------
        >>> from geomtorsion.geometry import Frame
        >>> C = [[[0, 0], [0, 1]], [[0, -1], [0, 0]]]
        >>> Frame.from_structure_constants(C).anholonomy.nonzero()
        {(0, 1, 1): -1, (1, 0, 1): 1}
        """
        return constructors.from_structure_constants(cls, constants, coordinates, signature, name)

    def read(self, entries: Sequence[tuple[str, object]]) -> list[Element]:
        """Exact elements of pairs (where, expression); new symbols become parameters."""
        return validation.read_more(self.field, entries)

    @property
    @unlocked
    def dimension(self) -> int:
        """Number of coordinates."""
        return len(self.coordinates)

    @property
    def shape(self) -> str:
        """How the frame was given: "coframe", "legs" or "metric"."""
        return next(shape for shape in ("metric", "legs", "coframe") if shape in self.given)

    # -- matrices -------------------------------------------------------------------------------

    @cached_property
    def coframe(self) -> Tensor:
        """Coframe e^i_mu, slots Ud: rows i, columns mu; inverse to legs.

        A capital is a leg slot, a small letter a coordinate slot; along the legs: `.in_frame()`.
        """
        return Tensor(self, "Ud", frame_matrices.coframe(self), (), "e", "coframe")

    @cached_property
    def eta(self) -> Tensor:
        """Constant metric of the frame, slots DD."""
        return Tensor(self, "DD", self.given["eta"], symmetric(2), "\\eta", "frame metric")

    @cached_property
    def inverse_eta(self) -> Tensor:
        """Inverse of eta, slots UU."""
        entries = inverse(self.field, self.given["eta"], self.dimension)
        return Tensor(self, "UU", entries, symmetric(2), "\\eta", "inverse frame metric")

    @cached_property
    def legs(self) -> Tensor:
        """Legs E_i^mu, slots uD: legs[mu, i], one leg per column.

        A capital is a leg slot, a small letter a coordinate slot; along the legs: `.in_frame()`.
        """
        return Tensor(self, "uD", frame_matrices.legs(self), (), "E", "legs")

    @cached_property
    def metric(self) -> Tensor:
        """Metric g_{mu nu} = e^i_mu eta_ij e^j_nu, slots dd.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        return Tensor(self, "dd", frame_matrices.metric(self), symmetric(2), "g", "metric")

    @cached_property
    def inverse_metric(self) -> Tensor:
        """Inverse metric g^{mu nu}, slots uu.

        Coordinate slots; along the legs: `.in_frame()`.
        """
        return Tensor(
            self, "uu", frame_matrices.inverse_metric(self), symmetric(2), "g", "inverse metric"
        )

    @cached_property
    def coframe_derivative(self) -> Components:
        """Partial derivatives d_a e^i_b at (a, i, b), from which every connection is computed."""
        return frame_matrices.coframe_derivative(self)

    @cached_property
    def anholonomy(self) -> Tensor:
        """Object of anholonomy C_ij^k, slots DDU: de^k = (1/2) C_ij^k e^i ^ e^j.

        It equals 2 S_ij^k of the Cartan connection and minus the structure functions of the legs.

        Leg slots; in coordinates: `.in_coordinates()`.
        """
        return frame_matrices.anholonomy(self)

    # -- scalars --------------------------------------------------------------------------------

    def scalar(
        self,
        value: arguments.Entry | Callable[[], Element],
        symbol: str = "f",
        name: str = "scalar",
    ) -> Tensor:
        """A scalar (rank 0), from an expression or from a rule that runs when the scalar is read.

        Examples
        --------
        >>> import sympy as sp
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> frame = Frame([r, phi], [[1, 0], [0, r]])
        >>> frame.scalar(r**2) + 1 == r**2 + 1
        True
        """
        if isinstance(value, FunctionType | MethodType):
            return Tensor(self, "", lambda _: value(), (), symbol, name)
        (element,) = self.read([(name or "scalar", value)])
        return Tensor(self, "", {(): element}, (), symbol, name)

    @cached_property
    def determinant(self) -> Tensor:
        """det e^i_mu, a scalar density (rank 0)."""
        return self.scalar(lambda: frame_matrices.coframe_determinant(self), "e", "determinant")

    @cached_property
    def volume(self) -> Tensor:
        """Volume element: det e * sqrt|det eta|, a signed root of |det g| (rank 0)."""
        return self.scalar(lambda: frame_matrices.volume(self), "\\sqrt{g}", "volume element")

    @cached_property
    def epsilon(self) -> Tensor:
        """Volume form epsilon_{a...} as a tensor, slots d: epsilon_{0 1 ...} = `volume`."""
        n = self.dimension

        def rule(_: object) -> Element:
            return self.volume.element()

        return Tensor(self, "d" * n, rule, alternating(n), "\\epsilon", "volume form")

    def vector(self, components: arguments.Vector) -> Tensor:
        """A vector field v^a from its components in the coordinate basis, slot u.

        Examples
        --------
        >>> import sympy as sp
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> Frame([r, phi], [[1, 0], [0, r]]).vector([0, 1]).in_frame().nonzero()
        {(1,): r}
        """
        return tensor_from_array(self, "u", components, "vector", symbol="v")

    def coframe_form(self, *index: int) -> Form:
        """One-form e^i of a leg; without an index, of all legs, with a frame index.

        Examples
        --------
        >>> import sympy as sp
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> Frame([r, phi], [[1, 0], [0, r]]).coframe_form(1)
        r dphi
        """
        # A form is made over a frame, so that the two files import each other.
        from geomtorsion.geometry.forms import Form

        every = Form.of(self.coframe, 1)
        return every.part(*index) if index else every

    @property
    def branches(self) -> tuple[Branch, ...]:
        """Signs chosen for roots whose sign does not follow from the domain."""
        return self._branches

    @cached_property
    def regions(self) -> tuple[Region, ...]:
        """Regions where the coframe is real, finite and regular, the preferred one first.

        Raises
        ------
        CoordinateError
            No region contains a point; the message names conditions that exclude each other.

        Examples
        --------
        >>> [str(region) for region in Frame("t r", [["sqrt(r**2 - 1)", 0], [0, 1]]).regions]
        ['r > 1', 'r < -1']
        """
        return regions(self)

    @property
    def region(self) -> Region:
        """The region where signs are read: the declared domain, or the preferred one.

        Without a declared domain a region is chosen: preferably the first coordinate is timelike
        (if the metric has one time), and parameters and coordinates are positive, far from walls.

        Raises
        ------
        CoordinateError
            No region contains a point.

        Examples
        --------
        >>> frame = Frame("r phi", [[1, 0], [0, "r"]])
        >>> frame.region, frame.region.assumed
        (Region(r > 0), True)
        """
        return self.regions[0]

    @cached_property
    def sample_point(self) -> RationalPoint:
        """Generic point in the region of the frame: symbol -> number.

        Raises
        ------
        CoordinateError
            No region contains a point.
        """
        return evaluation.sample_point(self)

    # -- named quantities -----------------------------------------------------------------------

    def quantity(self, name: str) -> Tensor:
        """A named quantity of this frame, of `geometry.quantities`; only its needs are computed.

        Raises
        ------
        UnknownNameError
            There is no quantity of this name; the message lists near ones.

        Examples
        --------
        >>> import sympy as sp
        >>> theta, phi = sp.symbols("theta phi")
        >>> frame = Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]])
        >>> frame.quantity("scalar_curvature")[()]
        2
        """
        # A plan is one of a frame, so that the two files import each other.
        from geomtorsion.geometry.plan import frame_quantity

        return frame_quantity(self, name)

    def plan(self, name: str) -> DependencyGraph:
        """Steps that compute a named quantity, in order, and the quantities they omit."""
        # See quantity.
        from geomtorsion.geometry.plan import DependencyGraph

        return DependencyGraph(self, name)

    # -- other values ---------------------------------------------------------------------------

    def subs(self, values: Replaced, value: Value | None = None) -> Frame:
        """The frame with values for parameters, and expressions for unknown functions.

        All replacements are simultaneous, and all later results are as exact as before. Equal
        values give the same frame, so that tensors with equal values can be added.

        Parameters
        ----------
        values
            {parameter: number or constant expression}, {a(t): expression of t}; also names and
            text: {"M": "m1 + 1"}, where names that are new to the frame become parameters. Also a
            list of pairs, or one parameter followed by its value, as in sympy.

        Raises
        ------
        UnknownNameError
            There is no such parameter or function.
        CoordinateError
            A coordinate was given a value; or the value of a parameter is not constant, contradicts
            its declaration or is outside of the domain.
        SingularPointError
            An entry has no finite value at these values.
        CoframeError
            The frame is singular at these values.

        Examples
        --------
        >>> import sympy as sp
        >>> r, phi, k = sp.symbols("r phi k", positive=True)
        >>> cone = Frame([r, phi], [[1, 0], [0, k * r]])
        >>> cone.subs(k, sp.Rational(1, 2)).metric[1, 1], cone.subs({"k": 1}).parameters
        (r**2/4, ())
        """
        put = substitution.substitution(replacements(values, value), self.coordinates, self.field)
        return constructors.substituted(self, put)

    def conformal(self, factor: arguments.Entry) -> Frame:
        """The frame with every one-form multiplied by a function; the metric gets its square.

        factor: an expression or text in the coordinates and parameters of the frame; new names
            become parameters.

        Raises
        ------
        CoframeError
            The factor vanishes identically.
        ExpressionError
            The factor cannot be read.

        Examples
        --------
        >>> Frame("x y", [[1, 0], [0, 1]], domain="y > 0").conformal("1/y").metric.nonzero()
        {(0, 0): y**(-2), (1, 1): y**(-2)}
        """
        return constructors.conformal(self, factor)

    def to_toml(self) -> str:
        """The text of a tetrad file, which `geomtorsion.read` and all commands take.

        Charts are not written.

        Examples
        --------
        >>> print(Frame("r phi", [[1, 0], [0, "k*r"]], parameters="k", domain="r > 0").to_toml())
        coordinates = ["r", "phi"]
        domain = ["r > 0"]
        coframe = [
          [1, 0],
          [0, "k*r"],
        ]
        <BLANKLINE>
        [parameters]
        k = "complex"
        <BLANKLINE>
        """
        return toml_text(self)

    def in_coordinates(self, new: object, old: object, domain: object = None) -> Frame:
        """This frame in other coordinates.

        The legs stay the same. A frame made from a metric is made from it again, so that its legs
        may differ. Tensors and connections have the same method.

        Parameters
        ----------
        new
            The new coordinates: symbols or names.
        old
            {old coordinate: expression of the new ones}, or expressions in the order of the old
            coordinates; also as text. A coordinate without an expression stays.
        domain
            Relations of the new coordinates; the frame's own relations are translated and added.

        Raises
        ------
        CoordinateError
            A coordinate is not known, has no expression, or the map leaves the domain.
        CoframeError, MetricError
            The map is singular.

        Examples
        --------
        >>> x, y = sp.symbols("x y")
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> plane = Frame([x, y], [[1, 0], [0, 1]])
        >>> plane.in_coordinates([r, phi], [r * sp.cos(phi), r * sp.sin(phi)]).metric.nonzero()
        {(0, 0): 1, (1, 1): r**2}
        """
        # A change of coordinates makes frames, so that the two files import each other.
        from geomtorsion.geometry.change import frame_in

        return frame_in(self, new, old, domain)

    def expanded(self, symbol: sp.Symbol | str, order: int) -> Frame:
        """This frame as a power series in a small parameter, truncated after an order.

        All quantities of the new frame are such series, found order by order: products above the
        order are never formed. `tensor.order(k)` gives one coefficient.

        Parameters
        ----------
        symbol
            A parameter of the frame; where it is zero, the frame must be regular.
        order
            The highest power kept.

        Raises
        ------
        UnknownNameError, CoordinateError
            The symbol is not a parameter of the frame.
        CoframeError, SingularPointError
            The frame is singular, or an entry has no series, where the parameter is zero.

        Examples
        --------
        >>> t, x, epsilon = sp.symbols("t x epsilon")
        >>> h = sp.Function("h")(t, x)
        >>> frame = Frame.from_metric([t, x], [[-1 - epsilon * h, 0], [0, 1]])
        >>> frame.expanded("epsilon", 1).quantity("scalar_curvature")[()]
        -epsilon*Derivative(h(t, x), (x, 2))
        """
        # An expansion makes frames, so that the two files import each other.
        from geomtorsion.geometry.expansion import expanded, small_parameter

        last = checks.count(order, "order", ArgumentError)
        return expanded(self, small_parameter(self, symbol), last)

    # -- names ----------------------------------------------------------------------------------

    @property
    def names(self) -> dict[sp.Symbol, sp.Expr]:
        """Meaning of each name used to print quantities; empty without `named`."""
        return dict(self.attached.get("names", {}))

    def named(self, /, **quantities: sp.Expr | str) -> Frame:
        """This frame, with tensors printed by names for quantities that occur often in them.

        Texts, tables, HTML, LaTeX and `to_sympy(short=True)` have names where that is shorter;
        `.subs(frame.names)` replaces them by their expressions. Components themselves stay in
        coordinates. A quantity is an expression or text over the symbols of the frame and earlier
        names.

        Raises
        ------
        ArgumentError, UnknownNameError, ExpressionError
            A name has another meaning; a quantity is a number, too long or has an unknown symbol.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> kerr = load("kerr").frame.named(Sigma="r**2 + a**2*cos(theta)**2")
        >>> kerr.metric.to_sympy(short=True)[0, 0], kerr.metric[0, 0]
        ((2*M*r - Sigma)/Sigma, -(-2*M*r + a**2*cos(theta)**2 + r**2)/(a**2*cos(theta)**2 + r**2))
        """
        meanings = naming.meanings(self.field.exact, self.names, quantities)
        return constructors.named(self, tuple(meanings.items()))

    def written(self, element: Element) -> sp.Expr:
        """An element as it is printed: short, with the names of the frame (see `named`)."""
        return self.field.written(element, constructors.names(self))

    # -- equality and copies --------------------------------------------------------------------

    def __eq__(self, other: object) -> bool:
        """Equal coordinates, parameters, domain, branches, coframe and eta; names do not count.

        Tensors, forms and connections of equal frames combine. False where it cannot be decided
        that two coframes are equal.
        """
        return homes.are_equal(self, other) if isinstance(other, Frame) else NotImplemented

    @unlocked
    def __hash__(self) -> int:
        return homes.number(self)

    def __reduce__(self) -> tuple[object, ...]:
        """Made again from its original input, so that every result is the same to the bit."""
        shape, entries = self._plain
        if not isinstance(shape, str):
            return shape, entries, self.attached
        assert isinstance(entries, dict)
        n = self.dimension
        rows = [[checks.plain(entries.get((i, j), 0)) for j in range(n)] for i in range(n)]
        given = constructors.keywords(self, shape)
        return _made_again, (shape, self.coordinates, rows, given), self.attached

    def __setstate__(self, attached: dict[str, Any]) -> None:
        self.attached.update(attached)

    def __deepcopy__(self, _: object) -> Frame:
        """Itself: it never changes."""
        return self

    def __repr__(self) -> str:
        return notation.frame_text(self)

    def _repr_latex_(self) -> str:
        return notation.frame_latex(self)

    _repr_html_ = drawn_by("notebook_tables", "frame_html")


def _made_again(
    shape: str, coordinates: tuple[sp.Symbol, ...], rows: list[list[Any]], given: dict[str, Any]
) -> Frame:
    """A frame from the plain data that `Frame.__reduce__` gives."""
    return constructors.maker(Frame, shape)(coordinates, rows, **given)

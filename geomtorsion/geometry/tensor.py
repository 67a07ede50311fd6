"""Tensor: components over one frame, with index kinds and positions; sparse, lazy, immutable."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, ClassVar, SupportsIndex, cast, overload

import sympy as sp

from geomtorsion.errors import ArgumentError, TensorIndexError
from geomtorsion.exact import Certainty, Element
from geomtorsion.exact.element import least_certain
from geomtorsion.exact.expansion import Expansion, limit
from geomtorsion.geometry import arithmetic, evaluation, indexing, notation
from geomtorsion.geometry.components import Components, Index, Symmetry, change_slot, effective
from geomtorsion.geometry.index_types import EXCHANGES, KINDS, moved
from geomtorsion.geometry.nested_entries import nested_entries
from geomtorsion.geometry.notation import ComponentTable, Names, Where
from geomtorsion.geometry.substitution import (
    Replaced,
    Value,
    approaches,
    replacements,
    substitution,
)
from geomtorsion.support import arguments, checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.hints import attribute_hints

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, DTypeLike

    from geomtorsion.geometry.frame import Frame

Number = int | float | complex | Fraction | sp.Expr
Scalar = int | Fraction | sp.Expr | Element
Point = Mapping[str, Number] | Mapping[sp.Expr, Number]
Points = Mapping[str, "Number | ArrayLike"] | Mapping[sp.Expr, "Number | ArrayLike"]
Source = (
    Components
    | Mapping[Index, Scalar]
    | Callable[[Index], Element]
    | Sequence[object]
    | arguments.Array
)


@attribute_hints(
    doit="tensor.simplify()", T="sympy.Matrix(tensor).T", trace="sympy.Matrix(tensor).trace()",
    applyfunc="tensor.to_sympy().applyfunc(f)", rank="ndim", item="tensor[()]",
    has="tensor.free_symbols", atoms="tensor.free_symbols", expand="tensor.simplify()",
    factor="tensor.simplify()", transpose="sympy.Matrix(tensor).T",
    rewrite="tensor.to_sympy().applyfunc(f)", as_matrix="sympy.Matrix(tensor)",
    to_matrix="sympy.Matrix(tensor)", to_numpy="numpy.array(tensor)",
    is_symmetric="sympy.Matrix(tensor).is_symmetric()",
    eigenvals="sympy.Matrix(tensor).eigenvals()",
)  # fmt: skip
@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class Tensor:
    """Tensor field over a frame: exact components, each computed when first read.

    frame: the frame whose coordinates and legs the indices refer to.
    slots: one letter per index: d, u coordinate index down, up; D, U frame index down, up.
    source: components: nested lists or an array, a mapping index -> value (the rest vanishes), or a
        rule index -> Element.
    symmetry: generators of the symmetry that the all-lower (or all-upper) form has.
    symbol, name: how it is written and called.
    anchored: indices whose basis cannot be changed, as of connection coefficients.
    writing: how a component is printed; without it, by the names of the frame.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> metric = Frame([r, phi], [[1, 0], [0, r]]).metric
    >>> metric[1, 1], metric.slots
    (r**2, 'dd')
    >>> metric.raised(0).nonzero()
    {(0, 0): 1, (1, 1): 1}
    >>> Tensor(metric.frame, "u", [0, 1 / r]).lowered(0)[1]
    r
    """

    frame: Frame
    slots: str
    source: Source
    symmetry: Symmetry = ()
    symbol: str = "t"
    name: str = ""
    anchored: tuple[int, ...] = ()
    writing: notation.Writing | None = None

    has_own_field: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Refuse invalid slots."""
        if not isinstance(self.slots, str) or set(self.slots) - set(KINDS):
            raise TensorIndexError(
                f"slots {checks.shown(self.slots)}: each letter must be one of d, u (coordinate "
                "index down, up) or D, U (frame index down, up)."
            )

    @cached_property
    def components(self) -> Components:
        """The array behind the tensor."""
        symmetry = effective(self.symmetry, self.slots)
        field, rank, dimension = self.frame.field, len(self.slots), self.frame.dimension
        if isinstance(self.source, Components):
            return self.source
        if callable(self.source):
            return Components(field, rank, dimension, self.source, symmetry)
        listed = self.source
        if not isinstance(listed, Mapping):
            listed = nested_entries(listed, rank, dimension, self.symbol)
        named = [(f"{self.symbol}{list(i)}", value) for i, value in listed.items()]
        values = dict(zip(listed, self.frame.read(named), strict=True))
        return Components.placed(field, rank, dimension, values, symmetry)

    # -- reading -------------------------------------------------------------------------------

    def element(self, *index: SupportsIndex) -> Element:
        """One component as an exact element.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> x, y = sp.symbols("x y")
        >>> Frame([x, y], [[1, x], [0, 1]]).metric.element(0, 1).sympy
        x
        """
        place = self._checked(index)
        # A zero that is not proved carries the chance that it is wrong.
        return self.components.zeros.get(place, self.components.get(place))

    @overload
    def __getitem__(self, index: tuple[indexing.Place, ...]) -> sp.Expr: ...
    @overload
    def __getitem__(self, index: indexing.One | tuple[indexing.One, ...]) -> Any: ...
    def __getitem__(self, index: indexing.One | tuple[indexing.One, ...]) -> Any:
        """One component as a sympy expression, or with slices or fewer indices an array of them.

        An index is a number, negative from the end, or a coordinate index by symbol or name. The
        component of a scalar is [()] or [0].
        Other components are not computed.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> metric = Frame([r, phi], [[1, 0], [0, r]]).metric
        >>> metric["phi", -1], metric[phi], metric[:, 0]
        (r**2, [0, r**2], [1, 0])
        """
        return indexing.chosen(self, index)

    def __iter__(self) -> Iterator[Any]:
        return indexing.rows(self)

    def __len__(self) -> int:
        if not self.slots:
            raise TensorIndexError(
                f"{self.label}: expected a tensor with indices, got a scalar, which has no length."
            )
        return self.frame.dimension

    @property
    def ndim(self) -> int:
        """Number of indices."""
        return len(self.slots)

    @property
    def shape(self) -> tuple[int, ...]:
        """The dimension, once for each index."""
        return (self.frame.dimension,) * len(self.slots)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> np.ndarray:
        """Floats if all components are numbers, else an array of sympy expressions."""
        return indexing.numpy_array(self, dtype)

    # Numbers and arrays of NumPy leave sums, products and comparisons to the tensor.
    __array_ufunc__ = None

    def __bool__(self) -> bool:
        return indexing.truth(self)

    def _checked(self, index: Sequence[SupportsIndex]) -> Index:
        """An index tuple of the right length and range."""
        rank, n = len(self.slots), self.frame.dimension
        # The most frequent case, for which no name is worked out.
        place = tuple([k for k in index if type(k) is int and 0 <= k < n])
        if len(place) == len(index) == rank:
            return cast("Index", place)
        return checks.indices(index, rank, n, self.label, TensorIndexError)

    def nonzero(self) -> dict[Index, sp.Expr]:
        """All components that are known not to vanish: index -> sympy expression."""
        return notation.written(self, are_open=False)

    def undecided(self) -> dict[Index, sp.Expr]:
        """All components for which no known relation decides whether they vanish, by index.

        Examples
        --------
        >>> from geomtorsion import spaces
        >>> spaces.load("kerr").frame.metric.undecided()
        {}
        """
        return notation.written(self, are_open=True)

    @cached_property
    def is_zero(self) -> bool | None:
        """Whether every component vanishes; None if that cannot be decided."""
        if len(self.components.independent) > len(self.components.undecided):
            return False
        return None if self.components.undecided else True

    @cached_property
    def certainty(self) -> Certainty:
        """Certainty about which components vanish: proved, up to a chance of error, or undecided.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> x, y = sp.symbols("x y")
        >>> print(Frame([x, y], [[1, x], [0, 1]]).anholonomy.certainty)
        proved
        """
        elements = [*self.components.undecided.values(), *self.components.zeros.values()]
        return least_certain(value.certainty for value in elements)

    def to_sympy(self, *, short: bool = False) -> sp.ImmutableDenseNDimArray | sp.Expr:
        """All components as a sympy array (an expression for a scalar).

        short: as they are printed, by the names of the frame if it has some (`Frame.named`).
        """
        return notation.array(self, checks.flag(short, "short"))

    def tolist(self) -> list[Any]:
        """All components as nested lists of sympy expressions."""
        return self.to_sympy().tolist() if self.slots else self[()]

    @property
    def free_symbols(self) -> set[sp.Symbol]:
        """The coordinates and parameters that the components contain."""
        return {symbol for x in self.components.independent.values() for symbol in x.symbols}

    def evalf(self, n: int = 15) -> sp.ImmutableDenseNDimArray | sp.Expr:
        """All components as a sympy array whose numbers are decimal, with n digits."""
        array = self.to_sympy()
        return array.applyfunc(lambda x: x.evalf(n)) if self.slots else array.evalf(n)

    def at(self, point: Points, *, digits: int | None = None) -> np.ndarray:
        """Numbers at a point: array of floats (complex if the frame is), one axis per index.

        If values are lists or arrays, they give numbers at many points; the common shape of the
        lists comes first in the shape of the result.

        Parameters
        ----------
        point
            Value of each coordinate and parameter on which the tensor depends; keys are symbols
            or their names. A float has its binary value: write Fraction(1, 10), not 0.1. Lists and
            arrays have one entry for each point; for very many points `numpy_function` is faster.
        digits
            Number of correct decimal digits, up to 1000; the result is then an array of mpmath
            numbers. None: floats.

        Raises
        ------
        CoordinateError
            A name is unknown, a value is not a finite number or contradicts the declaration of a
            parameter, or digits is not a whole number from 1 to 1000.
        MissingValueError
            A symbol has no value.
        ShapeError
            Lists and arrays have no common shape.
        SingularPointError
            A component has no finite value there.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> frame = Frame([r, phi], [[1, 0], [0, r]])
        >>> frame.metric.at({r: 3}).tolist()
        [[1.0, 0.0], [0.0, 9.0]]
        >>> frame.metric.at({r: [1, 2, 3]}).shape
        (3, 2, 2)
        >>> print(frame.metric.at({r: sp.sqrt(2)}, digits=30)[1, 1])
        2.0
        """
        values = checks.table(point, "point")
        several = {key: x for key, x in values.items() if evaluation.is_several(x)}
        if several:
            return evaluation.at_points(self, values, several, digits)
        return evaluation.at_point(self, values, digits)

    # -- changing indices ----------------------------------------------------------------------

    def _with_slot(self, k: int, slot: str) -> Tensor:
        """The same tensor with index k of another kind or in another position."""
        if slot == self.slots[k]:
            return self
        if k in self.anchored and KINDS[slot] != KINDS[self.slots[k]]:
            raise TensorIndexError(
                f"index {k} of {self.label} cannot change its basis: {self.label} is not a tensor "
                "in this index. For the coefficients of a connection in the frame use "
                "connection.spin_connection."
            )
        slots = self.slots[:k] + slot + self.slots[k + 1 :]
        name, turned = EXCHANGES[self.slots[k] + slot]
        matrix = getattr(self.frame, name).components
        rows, columns = matrix.rows, matrix.columns
        if turned:
            rows, columns = columns, rows
        symmetry = effective(self.symmetry, slots)
        source = change_slot(self.frame.field, self.components, k, rows, columns, symmetry)
        return replace(self, slots=slots, source=source)

    def in_frame(self) -> Tensor:
        """The same tensor with all indices in the frame."""
        return self._form(self.slots.upper())

    def in_coordinates(
        self, new: object = None, old: object = None, domain: object = None
    ) -> Tensor:
        """The same tensor with all indices in the coordinate basis; or in other coordinates.

        With a map, as in `Frame.in_coordinates`, it is the tensor over the frame in the new
        coordinates, with the same slots.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> x, y = sp.symbols("x y")
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> turning = Frame([x, y], [[1, 0], [0, 1]]).vector([-y, x])
        >>> turning.in_coordinates([r, phi], {x: r * sp.cos(phi), y: r * sp.sin(phi)}).nonzero()
        {(1,): 1}
        """
        if new is None and old is None:
            return self._form(self.slots.lower())
        # A change of coordinates makes tensors, so that the two files import each other.
        from geomtorsion.geometry.change import tensor_in

        return tensor_in(self, new, old, domain)

    def raised(self, k: SupportsIndex | None = None) -> Tensor:
        """The same tensor with index k up, or all indices up."""
        return self._form(moved(self.slots, self._place(k), up=True))

    def lowered(self, k: SupportsIndex | None = None) -> Tensor:
        """The same tensor with index k down, or all indices down."""
        return self._form(moved(self.slots, self._place(k), up=False))

    def _form(self, slots: str) -> Tensor:
        """The form with these slots: one change after the other, each made once."""
        if slots == self.slots:
            return self
        if slots not in self._forms:
            k = next(k for k in range(len(slots)) if slots[k] != self.slots[k])
            step = self.slots[:k] + slots[k] + self.slots[k + 1 :]
            if step == slots:
                form = self._forms[slots] = self._with_slot(k, slots[k])
                form.__dict__["_lineage"] = (self, *self._lineage)
            else:
                self._forms[slots] = self._form(step)._form(slots)
        return self._forms[slots]

    @cached_property
    def _forms(self) -> dict[str, Tensor]:
        """The forms of this tensor known so far, by their slots: converting back costs nothing."""
        return {tensor.slots: tensor for tensor in self._lineage}

    @cached_property
    def _lineage(self) -> tuple[Tensor, ...]:
        """The forms from which this one was made, one from the next."""
        return ()

    def _place(self, k: SupportsIndex | None) -> int | None:
        """A valid position of an index, or None."""
        if k is None:
            return None
        last = len(self.slots) - 1
        wanted = f"the number of an index from 0 to {last}" if self.slots else "no index"
        return checks.count(k, self.label, TensorIndexError, 0, last, expected=wanted)

    # -- arithmetic ----------------------------------------------------------------------------

    def __add__(self, other: Tensor | Scalar) -> Tensor:
        return arithmetic.combined(self, other, 1)

    __radd__ = __add__

    def __sub__(self, other: Tensor | Scalar) -> Tensor:
        return arithmetic.combined(self, other, -1)

    def __rsub__(self, other: Scalar) -> Tensor:
        return arithmetic.combined(-self, other, 1)

    def __neg__(self) -> Tensor:
        return arithmetic.multiple(self, -1)

    def __mul__(self, factor: Tensor | Scalar) -> Tensor:
        return arithmetic.multiple(self, factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: Tensor | Scalar) -> Tensor:
        return arithmetic.quotient(self, divisor)

    def __rtruediv__(self, dividend: Scalar) -> Tensor:
        return arithmetic.multiple(arithmetic.power(self, -1), dividend)

    def __pow__(self, exponent: Scalar) -> Tensor:
        return arithmetic.power(self, exponent)

    def __float__(self) -> float:
        return arithmetic.number(self)

    def __matmul__(self, other: Tensor) -> Tensor:
        """Sum over the last index of self and the first of other."""
        # A contraction gives a tensor, so that the two files import each other.
        from geomtorsion.geometry.contraction import product

        return product(self, other)

    def __eq__(self, other: object) -> bool:
        """Exact equality of all components; the slots must agree.

        A scalar equals its expression, a tensor that vanishes equals 0, and a tensor equals a
        matrix or an array of its components.

        Raises
        ------
        UndecidedError
            It cannot be decided.
        """
        if isinstance(other, Tensor):
            return arithmetic.equal(self, other)
        return arithmetic.equals(self, other)

    def __hash__(self) -> int:
        if not self.slots:
            return hash(self[()])
        # Elements of equal frames are written by other generators, so that places count only.
        places = frozenset(self.components.support)
        return hash((self.slots, self.frame, places)) if places else hash(0)

    @property
    def _sympy_(self) -> Callable[[], sp.Expr]:
        """Hook by which sympy reads a scalar as an expression, and other tensors as arrays.

        An array is neither an expression nor a matrix:
        sympy leaves sums and comparisons to the tensor.
        """
        return self.to_sympy

    @property
    def _op_priority(self) -> float:
        """Priority that makes sympy leave a product such as Lambda * g to the tensor."""
        if not self.slots:
            raise AttributeError("a tensor of rank 0 is an expression")
        return sp.Expr._op_priority + 1

    # -- verbs of sympy ------------------------------------------------------------------------

    def diff(self, *symbols: sp.Symbol | str) -> Tensor:
        """Partial derivatives of every component; the result is not a tensor in general.

        symbols: symbols or names. `connection.covariant_derivative(tensor)` gives a tensor.

        Raises
        ------
        UnknownNameError
            The frame has no such coordinate or parameter.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> Frame([r, phi], [[1, 0], [0, r]]).metric.diff(r).nonzero()
        {(1, 1): 2*r}
        """
        return indexing.derivative(self, symbols)

    def simplify(self) -> Tensor:
        """The same tensor, every component written as sympy's `simplify` writes it."""
        return self._mapped(lambda value, _: sp.simplify(value), written=True)

    def det(self) -> Tensor:
        """Determinant of the matrix of components of a tensor with two indices.

        The determinant of a metric g_{ab} is a density, not a scalar.

        Raises
        ------
        TensorIndexError
            The tensor does not have two indices.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> Frame([r, phi], [[1, 0], [0, r]]).metric.det()[()]
        r**2
        """
        return indexing.determinant_of(self)

    def inv(self) -> Tensor:
        """Inverse of the matrix of components, such as g^{ab} of g_{ab}.

        Raises
        ------
        TensorIndexError
            The tensor does not have two indices.
        SingularPointError
            The determinant vanishes.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> frame = Frame([r, phi], [[1, 0], [0, r]])
        >>> frame.metric.inv() == frame.inverse_metric
        True
        """
        return indexing.inverse_of(self)

    # -- other values and points ---------------------------------------------------------------

    def subs(self, values: Replaced, value: Value | None = None) -> Tensor:
        """The tensor with values for parameters and unknown functions, over `frame.subs(values)`.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, phi, k = sp.symbols("r phi k", positive=True)
        >>> Frame([r, phi], [[1, 0], [0, k * r]]).metric.subs({k: 2}).nonzero()
        {(0, 0): 1, (1, 1): 4*r**2}
        """
        values = replacements(values, value)
        frame = self.frame.subs(values)
        put = substitution(values, self.frame.coordinates, self.frame.field)
        return self._mapped(put.value, frame)

    def limit(self, symbol: sp.Symbol | str, point: Value, side: str | None = None) -> Tensor:
        """Limit of every component as a coordinate or parameter tends to a point; the frame stays.

        Parameters
        ----------
        point
            A number, an expression or text; oo and -oo for infinity.
        side
            "+" from above, "-" from below. None: both sides, where the domain and the declaration
            of the symbol allow them; the two limits must agree.

        Raises
        ------
        SingularPointError
            A component has no limit: it grows, oscillates, or differs between the two sides.
        UndecidedError
            A limit cannot be computed.
        CoordinateError, UnknownNameError
            The symbol is unknown, or the point is outside of the domain.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.spaces import load
        >>> hole = load("schwarzschild").frame
        >>> hole.metric.limit("r", sp.oo)[0, 0], hole.coframe.limit("M", 0)[1, 1]
        (-1, 1)
        """
        ways = approaches(symbol, point, side, self.frame.domain, self.frame.field)
        return self._mapped(lambda value, name: limit(self.frame.field, value, ways, name))

    def series(self, symbol: sp.Symbol | str, point: Value, order: int) -> Tensor:
        """Power series of every component in (symbol - point), up to and including an order.

        At infinity it is a series in 1/symbol. Powers may be negative, and fractional where roots
        vanish. Note that sympy's `series` ends before the requested order.

        Raises
        ------
        SingularPointError
            A component has no such series there.
        ArgumentError
            The order is not a whole number from 0 up.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> load("schwarzschild").frame.coframe.series("M", 0, 2)[0, 0]
        -M**2/(2*r**2) - M/r + 1
        """
        last, field = checks.count(order, "order", ArgumentError), self.frame.field
        way, *_ = approaches(symbol, point, None, self.frame.domain, field)
        return self._mapped(lambda x, at: Expansion(field, x, way, at).series(last), written=True)

    def order(self, k: int) -> Tensor:
        """The coefficient of the k-th power of the small parameter, over the frame at order zero.

        For tensors over `frame.expanded(symbol, order)`.

        Raises
        ------
        ArgumentError
            The frame was not expanded, or not to this order.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> x, y, epsilon = sp.symbols("x y epsilon")
        >>> frame = Frame([x, y], [[1, epsilon * x], [0, 1]]).expanded("epsilon", 2)
        >>> frame.inverse_metric.order(2).nonzero()
        {(0, 0): x**2}
        """
        # An expansion makes tensors, so that the two files import each other.
        from geomtorsion.geometry.expansion import coefficient

        return coefficient(self, k)

    def _mapped(
        self,
        change: Callable[[sp.Expr, str], sp.Expr],
        frame: Frame | None = None,
        written: bool = False,
    ) -> Tensor:
        """Every component changed when it is read; change: maps an expression and its name."""
        over = frame or self.frame

        def changed(index: Index, value: Element) -> Element:
            name = f"{notation.plain_symbol(self.symbol)}{list(index)}"
            expression = change(value.sympy, name)
            (element,) = over.read([(name, expression)])
            return element.written_as(expression) if written else element

        return replace(self, frame=over, source=self.components.mapped(over.field, changed))

    # -- copies --------------------------------------------------------------------------------

    def _carried(self, frame: Frame) -> Tensor:
        """This tensor over an equal frame."""
        if frame.field is self.frame.field:
            return replace(self, frame=frame, source=self.components)
        return self._mapped(lambda value, _: value, frame)

    def __reduce__(self) -> tuple[object, ...]:
        values = {index: x.sympy for index, x in self.components.independent.items()}
        symmetry = effective(self.symmetry, self.slots)
        names = (self.symbol, self.name, self.anchored, self.writing)
        return type(self), (self.frame, self.slots, values, symmetry, *names)

    def __deepcopy__(self, _: object) -> Tensor:
        """Itself: it never changes."""
        return self

    # -- writing -------------------------------------------------------------------------------

    @property
    def label(self) -> str:
        """Symbol with its indices in ASCII, such as S_{ab}^{c}."""
        return notation.ascii_label(self)

    def table(
        self, names: Names | None = None, *, where: Where | None = None, every: bool = False
    ) -> ComponentTable:
        """The components that do not vanish, with names of their indices.

        Parameters
        ----------
        names
            Names of the values of an index, one for each coordinate: "trθφ", or a list
            of texts. Without it coordinates have their own names and legs their numbers.
        where
            {index: its value} selects components: with {2: "r"}, the index number 2 is r.
        every
            Also list components that follow from others by symmetry.

        Raises
        ------
        TensorIndexError
            There are not as many names as coordinates, or an index or its value does not exist.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> print(Frame([r, phi], [[1, 0], [0, r]]).metric.table())
        metric g_{ab}: 2 of 4 components do not vanish
          g_{r r}      [0, 0]  1
          g_{phi phi}  [1, 1]  r**2
        """
        return notation.table(self, names, where, every)

    def __repr__(self) -> str:
        return notation.text(self)

    def _repr_latex_(self) -> str:
        return notation.latex(self)

    def to_latex(self) -> str:
        r"""LaTeX of the components: a matrix for two indices, else the independent components.

        Examples
        --------
        >>> from geomtorsion.geometry import Frame
        >>> Frame("r phi", [["1", "0"], ["0", "r"]]).metric.to_latex()
        'g_{ab} = \\begin{pmatrix} 1 & 0 \\\\ 0 & r^{2} \\end{pmatrix}'
        """
        return notation.sympy_latex(self, None)

    _repr_html_ = drawn_by("notebook_tables", "tensor_html")
    plot: ClassVar[Plot] = figure_by("tensors", "draw_tensor")
    # A hook of sympy, which would mistake this class for a sympy tensor by its name.
    _latex, _pretty, _sympystr = notation.sympy_latex, notation.sympy_pretty, notation.sympy_text
    # `sympy.lambdify` takes the tensor as one argument, not as a list of rows.
    _iterable = False

"""Forms: exterior calculus over a frame, with values in its tensors."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import TYPE_CHECKING, ClassVar

import sympy as sp

from geomtorsion.errors import ArgumentError, ShapeError, TensorIndexError, UndecidedError
from geomtorsion.exact import Element
from geomtorsion.geometry.components import (
    Entries,
    Index,
    alternating,
    determinant,
    is_odd,
    shifted,
)
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.homes import at_home, over_frame
from geomtorsion.geometry.lie_derivative import lie, vector
from geomtorsion.geometry.tensor import Scalar, Tensor
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.hints import attribute_hints

if TYPE_CHECKING:
    from geomtorsion.geometry.connection import Connection

Source = Mapping[Index, Scalar] | Mapping[int, Scalar] | Callable[[Index], Element]


@attribute_hints()
@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class Form:
    """Differential form over a frame, scalar-valued or tensor-valued.

    frame: the frame of the form.
    degree: number p of the form indices, which are coordinate indices.
    source: {index: component}, or a function of the index, called for increasing form indices.
        An index lists the value indices first, then the p form indices; a component belongs to the
        antisymmetric tensor: alpha = sum over a1 < ... < ap of alpha_{a1...ap} dq^a1 ^ ... ^ dq^ap.
    values: slots of the value indices (see Tensor), empty for a scalar-valued form.
    symbol: how the form is written.

    Raises
    ------
    TensorIndexError
        An index repeats a form index or has another length; a slot letter is unknown.
    ArgumentError
        The degree is not a whole number from 0 on.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Form, Frame
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> plane = Frame([r, phi], [[1, 0], [0, r]])
    >>> turning = Form(plane, 1, {1: r**2})
    >>> turning.d[0, 1], turning.star[0], turning.d.star[()]
    (2*r, -r, 2)
    >>> plane.coframe_form(0) ^ plane.coframe_form(1)
    r dr ^ dphi
    """

    frame: Frame
    degree: int
    source: Source
    values: str = ""
    symbol: str = "alpha"

    has_own_field: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Check frame, degree and value slots."""
        checks.instance(self.frame, Frame, "frame")
        object.__setattr__(self, "degree", checks.count(self.degree, "degree", ArgumentError))
        # Refuses slots that do not exist.
        Tensor(self.frame, self.values, {})
        if not callable(self.source):
            checks.table(self.source, "source")

    @classmethod
    def of(cls, tensor: Tensor, degree: int | None = None) -> Form:
        """The form of a tensor that is antisymmetric in its last `degree` indices, all lower.

        Raises
        ------
        TensorIndexError
            A form index is not lower, or two components do not cancel.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Form, Frame
        >>> x, y = sp.symbols("x y")
        >>> Form.of(Frame([x, y], [[1, x], [0, 1]]).epsilon)
        dx ^ dy
        """
        checks.instance(tensor, Tensor, "tensor")
        rank = len(tensor.slots)
        p = rank if degree is None else checks.count(degree, "degree", ArgumentError)
        head = rank - p
        if p > rank or set(tensor.slots[head:]) - set("dD"):
            raise TensorIndexError(
                f"degree: expected {p} lower indices at the end of {tensor.label}, got slots "
                f"{tensor.slots!r}. Lower them with lowered(k), or give a smaller degree."
            )
        for k in range(head, rank):
            tensor = tensor._with_slot(k, "d")
        get = tensor.components.get
        for index in tensor.components.nonzero:
            for k in range(head, rank - 1):
                turned = (*index[:k], index[k + 1], index[k], *index[k + 2 :])
                if (get(index) + get(turned)).is_zero is not True:
                    raise TensorIndexError(
                        f"{tensor.label}: expected a tensor antisymmetric in its last {p} indices, "
                        f"got components {list(index)} and {list(turned)} that do not cancel. "
                        "Antisymmetrise it first."
                    )
        return cls(tensor.frame, p, get, tensor.slots[:head], tensor.symbol)

    # -- components ------------------------------------------------------------------------------

    @cached_property
    def components(self) -> dict[Index, Element]:
        """Components at increasing form indices, without trivially vanishing ones."""
        n, rank = self.frame.dimension, len(self.values)
        if callable(self.source):
            rule = self.source
            places = [
                (*head, *tail)
                for head in product(range(n), repeat=rank)
                for tail in combinations(range(n), self.degree)
            ]
            components = {place: rule(place) for place in places}
        else:
            entries = {k if isinstance(k, tuple) else (k,): x for k, x in self.source.items()}
            named = [(f"{self.symbol}{list(index)}", x) for index, x in entries.items()]
            components = {}
            for index, value in zip(entries, self.frame.read(named), strict=True):
                sign, place = self._sorted(index)
                if sign == 0 or place in components:
                    raise TensorIndexError(
                        f"{self.symbol}{list(index)}: expected each component of the form once, "
                        "with different form indices, got one index twice. Omit one of them."
                    )
                components[place] = value if sign > 0 else -value
        return {place: x for place, x in sorted(components.items()) if x.is_zero is not True}

    def _sorted(self, index: Sequence[object]) -> tuple[int, Index]:
        """Sign and increasing order of an index; sign 0 where a form index is repeated."""
        n, head = self.frame.dimension, len(self.values)
        place = checks.indices(index, head + self.degree, n, self.symbol, TensorIndexError)
        tail = place[head:]
        if len(set(tail)) < len(tail):
            return 0, place
        return -1 if is_odd(tail) else 1, (*place[:head], *sorted(tail))

    def element(self, *index: int) -> Element:
        """One component, its form indices in any order, as an exact element."""
        sign, place = self._sorted(index)
        value = self.components.get(place, self.frame.field.zero)
        if sign == 0:
            return self.frame.field.zero
        return value if sign > 0 else -value

    def __getitem__(self, index: int | tuple[int, ...]) -> sp.Expr:
        """One component, its form indices in any order, as a sympy expression."""
        return self.element(*(index if isinstance(index, tuple) else (index,))).sympy

    def nonzero(self) -> dict[Index, sp.Expr]:
        """The components at increasing form indices that do not vanish."""
        return {place: value.sympy for place, value in self.components.items()}

    @property
    def is_zero(self) -> bool | None:
        """Whether the form vanishes; None if that cannot be decided."""
        verdicts = {value.is_zero for value in self.components.values()}
        return False if False in verdicts else None if verdicts else True

    @cached_property
    def tensor(self) -> Tensor:
        """The antisymmetric tensor of the form: value indices first, then form indices."""
        slots = self.values + "d" * self.degree
        symmetry = shifted(alternating(self.degree), len(self.values))
        return Tensor(self.frame, slots, lambda place: self.element(*place), symmetry, self.symbol)

    def part(self, *index: int) -> Form:
        """Scalar-valued form at given value indices.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, cartan
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> cartan(Frame([r, phi], [[1, 0], [0, r]])).torsion_form().part(1)
        dr ^ dphi
        """
        n, length = self.frame.dimension, len(self.values)
        checks.indices(index, length, n, f"{self.symbol}: values", TensorIndexError)
        return Form(self.frame, self.degree, lambda place: self.element(*index, *place))

    # -- algebra ---------------------------------------------------------------------------------

    def _same(self, other: object, what: str) -> Form:
        """Another form over the same frame."""
        return over_frame(self.frame, checks.instance(other, Form, what), what, ShapeError)

    def _combined(self, other: object, sign: int) -> Form:
        two = self._same(other, "other form")
        if (two.degree, two.values) != (self.degree, self.values):
            raise TensorIndexError(
                f"other form: expected degree {self.degree} and values {self.values!r}, got "
                f"degree {two.degree} and values {two.values!r}. Only like forms can be added."
            )

        def rule(place: Index) -> Element:
            terms = [(1, self.element(*place)), (sign, two.element(*place))]
            return self.frame.field.sum(terms)

        return Form(self.frame, self.degree, rule, self.values)

    def __add__(self, other: Form) -> Form:
        return self._combined(other, 1)

    def __sub__(self, other: Form) -> Form:
        return self._combined(other, -1)

    def __neg__(self) -> Form:
        return self * -1

    def __mul__(self, factor: Scalar | Tensor) -> Form:
        """The form times a number, an expression or a tensor of rank 0."""
        scale = factor if isinstance(factor, Tensor) else self.frame.scalar(factor)
        value = (self.frame.scalar(1) * scale).element()

        def rule(place: Index) -> Element:
            return self.element(*place) * value

        return Form(self.frame, self.degree, rule, self.values)

    __rmul__ = __mul__

    def __eq__(self, other: object) -> bool:
        """Exact equality of two forms over equal frames; a form that vanishes equals 0.

        Raises
        ------
        UndecidedError
            It cannot be decided.
        """
        if not isinstance(other, Form):
            is_scalar = not self.degree and not self.values
            return self.tensor.__eq__(other) if is_scalar or _is_zero(other) else NotImplemented
        same = at_home(self.frame, other)
        if same is None or (same.degree, same.values) != (self.degree, self.values):
            return False
        verdict = (self - same).is_zero
        if verdict is None:
            raise UndecidedError(
                "whether two forms are equal cannot be decided exactly: functions occur whose "
                "relations are not known. Compare numbers with form.tensor.at(point)."
            )
        return verdict

    def __hash__(self) -> int:
        return hash((self.degree, self.tensor))

    def __bool__(self) -> bool:
        return bool(self.tensor)

    def wedge(self, other: Form) -> Form:
        """Exterior product; value indices of this form come before the others.

        Equation
        --------
        (alpha ^ beta)_{A} = sum over splittings of A into B, C of sign(B, C) alpha_B beta_C

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Form, Frame
        >>> x, y = sp.symbols("x y")
        >>> plane = Frame([x, y], [[1, 0], [0, 1]])
        >>> Form(plane, 1, {0: y}).wedge(Form(plane, 1, {0: 1, 1: x}))
        x*y dx ^ dy
        """
        two = self._same(other, "other form")
        return Form(
            self.frame, self.degree + two.degree, self._product(two), self.values + two.values
        )

    __xor__ = wedge

    def _product(self, two: Form) -> Source:
        one_head, two_head = len(self.values), len(two.values)
        collected: dict[Index, list] = defaultdict(list)
        for one_place, first in self.components.items():
            for two_place, second in two.components.items():
                tail = one_place[one_head:] + two_place[two_head:]
                if len(set(tail)) == len(tail):
                    head = one_place[:one_head] + two_place[:two_head]
                    sign = -1 if is_odd(tail) else 1
                    collected[(*head, *sorted(tail))].append((sign, first, second))
        field = self.frame.field
        return lambda place: field.sum(collected.get(place, ()))

    def interior(self, xi: object) -> Form:
        """Interior product with a vector: (i_xi alpha)_{b...} = xi^a alpha_{a b...}.

        Parameters
        ----------
        xi
            xi^a, shape (n,), expressions; or a tensor with slot u or U.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> plane = Frame([r, phi], [[1, 0], [0, r]])
        >>> (plane.coframe_form(0) ^ plane.coframe_form(1)).interior([r, 0])
        r**2 dphi
        """
        head = len(self.values)
        along = vector(self.frame, xi, "xi").components.nonzero.items()

        def rule(place: Index) -> Element:
            front, tail = place[:head], place[head:]
            terms = [(1, x, self.element(*front, a, *tail)) for (a,), x in along]
            return self.frame.field.sum(terms)

        if self.degree == 0:
            return Form(self.frame, 0, {}, self.values)
        return Form(self.frame, self.degree - 1, rule, self.values)

    @cached_property
    def star(self) -> Form:
        """Hodge dual: (*alpha)_{b...} = alpha^{a...} epsilon_{a... b...} / p!.

        Applied twice it is (-1)^(p (n - p)) times the sign of det g. The orientation follows the
        coframe: `frame.volume` is negative where det e is.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> t, x = sp.symbols("t x")
        >>> plane = Frame([t, x], [[1, 0], [0, 1]], signature=(-1, 1))
        >>> plane.coframe_form(0).star, plane.coframe_form(0).star.star
        (-dx, dt)
        """
        frame, n, p, head = self.frame, self.frame.dimension, self.degree, len(self.values)
        volume, field = frame.volume.element(), frame.field
        # A minor of the inverse metric is a minor of the metric over its determinant (Jacobi).
        is_upper = 2 * p <= n
        matrix = frame.inverse_metric if is_upper else frame.metric
        entries = matrix.components.nonzero
        # det g is the square of the volume, up to the sign of eta's determinant.
        factor = volume if is_upper else volume.inverse() * _sign_of_metric(frame)
        everything = frozenset(range(n))

        def rule(place: Index) -> Element:
            front, tail = place[:head], place[head:]
            missing = tuple(sorted(everything - set(tail)))
            outer = -1 if is_odd((*missing, *tail)) else 1
            terms = []
            for summed in combinations(range(n), p):
                value = self.components.get((*front, *summed))
                if value is None:
                    continue
                if is_upper:
                    terms.append((outer, _minor(frame, entries, missing, summed), value))
                else:
                    rest = tuple(sorted(everything - set(summed)))
                    sign = -1 if is_odd((*summed, *rest)) else 1
                    terms.append((sign, _minor(frame, entries, tail, rest), value))
            return field.sum(terms) * factor

        if p > n:
            raise ShapeError(
                f"star: expected a form of degree 0 to {n}, got degree {p}. A form above degree "
                f"{n} vanishes in {n} dimensions and has no dual."
            )
        return Form(frame, n - p, rule, self.values)

    # -- derivatives -----------------------------------------------------------------------------

    @cached_property
    def d(self) -> Form:
        """Exterior derivative; of a tensor-valued form, component by component.

        Equation
        --------
        (d alpha)_{a0...ap} = sum_k (-1)^k d_{ak} alpha_{a0...ap without ak}

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Form, Frame
        >>> x, y = sp.symbols("x y")
        >>> Form(Frame([x, y], [[1, 0], [0, 1]]), 0, {(): x * y**2}).d
        y**2 dx + 2*x*y dy
        """
        return self._derivative(None)

    def D(self, connection: Connection) -> Form:
        """Exterior covariant derivative: value indices are transported by the connection.

        Equation
        --------
        (D alpha)^j = d alpha^j + omega_i^j ^ alpha^i
        (D beta)_i = d beta_i - omega_i^j ^ beta_j

        Raises
        ------
        ShapeError
            The connection belongs to another frame.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame, levi_civita
        >>> r, phi = sp.symbols("r phi", positive=True)
        >>> plane = Frame([r, phi], [[1, 0], [0, r]])
        >>> plane.coframe_form().D(levi_civita(plane)).is_zero
        True
        """
        carrier = at_home(self.frame, connection) if hasattr(connection, "coefficients") else None
        if carrier is None:
            raise ShapeError(
                "connection: expected a connection over the frame of the form, got "
                f"{checks.shown(connection)}. Build both over one frame."
            )
        return self._derivative(carrier)

    def _derivative(self, connection: Connection | None) -> Form:
        head, n, field = len(self.values), self.frame.dimension, self.frame.field
        coordinates = self.frame.coordinates
        tables = {}
        if connection is not None and self.values:
            tables["d"] = connection.coefficients.components.get
            if self.values != self.values.lower():
                tables["D"] = connection.spin_connection.components.get

        def rule(place: Index) -> Element:
            front, tail = place[:head], place[head:]
            terms: list = []
            for k, a in enumerate(tail):
                rest = tail[:k] + tail[k + 1 :]
                sign = -1 if k % 2 else 1
                terms.append((sign, self.element(*front, *rest).diff(coordinates[a])))
                for slot, letter in enumerate(self.values if tables else ""):
                    table, up = tables["d" if letter in "du" else "D"], letter in "uU"
                    own = front[slot]
                    for b in range(n):
                        factor = table((a, b, own) if up else (a, own, b))
                        if factor is not field.zero:
                            component = self.element(*front[:slot], b, *front[slot + 1 :], *rest)
                            terms.append((sign if up else -sign, factor, component))
            return field.sum(terms)

        return Form(self.frame, self.degree + 1, rule, self.values)

    def lie(self, xi: object) -> Form:
        """Lie derivative along a vector field, by Cartan's formula: d i_xi + i_xi d.

        Frame indices of a tensor-valued form are treated as in `lie`.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Form, Frame
        >>> x, y = sp.symbols("x y")
        >>> Form(Frame([x, y], [[1, 0], [0, 1]]), 1, {1: x}).lie([y, 0])
        y dy
        """
        if self.values:
            return Form.of(lie(xi, self.tensor), self.degree)
        along = vector(self.frame, xi, "xi")
        return self.interior(along).d + self.d.interior(along)

    # -- copies and writing ------------------------------------------------------------------------

    def _carried(self, frame: Frame) -> Form:
        """This form over an equal frame."""
        get = self.tensor._carried(frame).components.get
        return Form(frame, self.degree, get, self.values, self.symbol)

    def __reduce__(self) -> tuple[object, ...]:
        entries = {place: value.sympy for place, value in self.components.items()}
        return type(self), (self.frame, self.degree, entries, self.values, self.symbol)

    def __deepcopy__(self, _: object) -> Form:
        """Itself: it never changes."""
        return self

    def __repr__(self) -> str:
        if self.values:
            return repr(self.tensor)
        return _text(self, str, " ^ ", " ", "d{}")

    def _repr_latex_(self) -> str:
        if self.values:
            return self.tensor._repr_latex_()
        text = _text(self, sp.latex, " \\wedge ", " \\, ", "\\mathrm{{d}}{}")
        return f"${text}$"


def _is_zero(value: object) -> bool:
    """Whether a value is the number zero."""
    return checks.fraction(value) == 0


def _text(form: Form, write: Callable[[object], str], wedge: str, space: str, basis: str) -> str:
    """A form with values in numbers as a sum of its parts."""
    names = [basis.format(write(q)) for q in form.frame.coordinates]
    parts = []
    for place, element in form.components.items():
        value = form.frame.written(element)
        product_ = wedge.join(names[k] for k in place)
        coefficient = f"({write(value)})" if value.is_Add and product_ else write(value)
        if product_ and value in (1, -1):
            coefficient = "-" if value == -1 else ""
            parts.append(coefficient + product_)
        else:
            parts.append(space.join(filter(None, [coefficient, product_])))
    return " + ".join(parts).replace("+ -", "- ") or "0"


def _minor(frame: Frame, entries: Entries, rows: Index, columns: Index) -> Element:
    """Determinant of some rows and columns of a matrix."""
    chosen = {
        (i, j): entries[row, column]
        for i, row in enumerate(rows)
        for j, column in enumerate(columns)
        if (row, column) in entries
    }
    return determinant(frame.field, chosen, len(rows))


def _sign_of_metric(frame: Frame) -> int:
    """The sign of det g, where det g is this times the square of the volume."""
    eta = determinant(frame.field, frame.eta.components.nonzero, frame.dimension)
    whole = eta * frame.determinant.element() ** 2
    return 1 if whole == frame.volume.element() ** 2 else -1


def torsion_form(connection: Connection) -> Form:
    """T^k = d e^k + omega_i^k ^ e^i, values U."""
    frame, get = connection.frame, connection.torsion.T._with_slot(2, "U").components.get
    return Form(frame, 2, lambda place: get((place[1], place[2], place[0])), "U", "T")


def curvature_form(connection: Connection) -> Form:
    """R_i^j = d omega_i^j + omega_k^j ^ omega_i^k, values DU."""
    riemann = connection.curvature.riemann._with_slot(2, "D")._with_slot(3, "U")
    get = riemann.components.get
    return Form(connection.frame, 2, lambda x: get((x[2], x[3], x[0], x[1])), "DU", "R")


def connection_form(connection: Connection) -> Form:
    """omega_i^j = omega_ai^j dq^a, values DU."""
    get = connection.spin_connection.components.get
    return Form(connection.frame, 1, lambda x: get((x[2], x[0], x[1])), "DU", "omega")

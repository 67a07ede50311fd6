"""Lie derivative: of tensors and connections along a vector field, brackets, Killing equations."""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

from geomtorsion.errors import ArgumentError, ShapeError, TensorIndexError
from geomtorsion.exact import Element
from geomtorsion.geometry.components import Index, symmetric
from geomtorsion.geometry.connection import Connection
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.from_arrays import tensor_from_array
from geomtorsion.geometry.homes import over_frame
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support import checks

if TYPE_CHECKING:
    from geomtorsion.geometry.forms import Form


def vector(frame: Frame, values: object, name: str = "vector") -> Tensor:
    """A vector field in coordinates, slot u: from expressions, or from a tensor of rank 1.

    Raises
    ------
    ShapeError
        There is not one component for each coordinate, or the tensor belongs to another frame.
    TensorIndexError
        The tensor does not have exactly one index.
    """
    if not isinstance(values, Tensor):
        return tensor_from_array(frame, "u", values, name)
    home = over_frame(frame, values, name, ShapeError)
    if len(values.slots) != 1:
        raise TensorIndexError(
            f"{name}: expected a tensor with one index, got slots {values.slots!r}. Give a vector."
        )
    return home.raised(0).in_coordinates()


@overload
def lie(xi: object, field: Form) -> Form: ...
@overload
def lie(xi: object, field: Tensor | Connection | Frame) -> Tensor: ...
def lie(xi: object, field: Tensor | Connection | Frame | Form) -> Tensor | Form:
    """Lie derivative of a tensor, a form, a connection or the metric of a frame.

    Equation
    --------
    (L_xi t)_a^b = xi^m d_m t_a^b + t_m^b d_a xi^m - t_a^m d_m xi^b
    (L_xi Gamma)_ab^c = xi^m d_m Gamma_ab^c + Gamma_mb^c d_a xi^m + Gamma_am^c d_b xi^m + Z_ab^c
    Z_ab^c = d_a d_b xi^c - Gamma_ab^m d_m xi^c

    Parameters
    ----------
    xi
        xi^a, shape (n,), expressions in the coordinate basis; or a tensor with slot u or U.
    field
        The object to differentiate; a frame means its metric. The result has the slots of the
        tensor: the derivative is taken in coordinates and then referred to the legs.

    Returns
    -------
    Tensor with the slots of the given one; for a connection a tensor with slots ddu, which
    vanishes exactly where the flow of xi keeps the connection.

    Raises
    ------
    ShapeError
        xi does not have one component for each coordinate.
    TensorIndexError
        The argument consists of connection coefficients. Give the connection.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, cartan, lie
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> plane = Frame([r, phi], [[1, 0], [0, r]])
    >>> shift = [sp.cos(phi), -sp.sin(phi) / r]
    >>> lie(shift, plane).is_zero
    True
    >>> lie([0, 1], cartan(plane)).is_zero, lie(shift, cartan(plane)).is_zero
    (True, False)
    """
    if isinstance(field, Connection):
        return _of_connection(field, vector(field.frame, xi, "xi"))
    if isinstance(field, Frame):
        field = field.metric
    if not isinstance(field, Tensor):
        derivative = getattr(field, "lie", None)
        if derivative is None:
            raise ArgumentError(
                "field: expected a tensor, a form, a connection or a frame, got "
                f"{checks.shown(field)}. Make a tensor with frame.scalar or gt.Tensor."
            )
        return derivative(xi)
    if field.anchored:
        raise TensorIndexError(
            f"{field.label}: expected a tensor in all its indices, got connection coefficients. "
            "Give the connection itself: lie(xi, connection)."
        )
    frame, slots = field.frame, field.slots
    along, slope = _slopes(vector(frame, xi, "xi"))
    plain = field.in_coordinates()
    get, coordinates, sum_ = plain.components.get, frame.coordinates, frame.field.sum

    def rule(index: Index) -> Element:
        terms: list = [(1, x, get(index).diff(coordinates[m])) for m, x in along]
        for k, slot in enumerate(plain.slots):
            head, own, tail = index[:k], index[k], index[k + 1 :]
            for m in range(frame.dimension):
                if slot == "d":
                    terms.append((1, get((*head, m, *tail)), slope[own, m]))
                else:
                    terms.append((-1, get((*head, m, *tail)), slope[m, own]))
        return sum_(terms)

    result = Tensor(frame, plain.slots, rule, plain.symmetry, f"L{field.symbol}", "Lie derivative")
    return result._form(slots)


def _slopes(xi: Tensor) -> tuple[list[tuple[int, Element]], dict[tuple[int, int], Element]]:
    """Pairs (m, xi^m) that do not vanish, and d_a xi^m at (a, m)."""
    frame, get = xi.frame, xi.components.get
    slope = {
        (a, m): get((m,)).diff(q)
        for a, q in enumerate(frame.coordinates)
        for m in range(frame.dimension)
    }
    return [(m, x) for (m,), x in xi.components.nonzero.items()], slope


def _of_connection(connection: Connection, xi: Tensor) -> Tensor:
    """(L_xi Gamma)_ab^c, slots ddu."""
    frame, get = connection.frame, connection.coefficients.components.get
    along, slope = _slopes(xi)
    coordinates = frame.coordinates

    def rule(index: Index) -> Element:
        a, b, c = index
        terms: list = [(1, x, get(index).diff(coordinates[m])) for m, x in along]
        terms.append((1, slope[b, c].diff(coordinates[a])))
        for m in range(frame.dimension):
            terms.append((1, get((m, b, c)), slope[a, m]))
            terms.append((1, get((a, m, c)), slope[b, m]))
            terms.append((-1, get((a, b, m)), slope[m, c]))
        return frame.field.sum(terms)

    symmetry = symmetric(3) if connection.kind == "levi-civita" else ()
    return Tensor(frame, "ddu", rule, symmetry, "L\\Gamma", "Lie derivative of a connection")


@overload
def lie_bracket(frame: Frame, first: object, second: object) -> Tensor: ...
@overload
def lie_bracket(frame: object, first: object) -> Tensor: ...
def lie_bracket(frame: object, first: object, second: object = None) -> Tensor:
    """Lie bracket [first, second]^a = first^m d_m second^a - second^m d_m first^a, slot u.

    Parameters
    ----------
    frame
        May be omitted if a vector field is a tensor, which belongs to a frame.
    first, second
        Vector fields: expressions in the coordinate basis, shape (n,), or tensors with slot u, U.

    Raises
    ------
    ShapeError
        A vector does not have one component for each coordinate, or the tensors belong to two
        frames.
    ArgumentError
        There is no frame, or one vector field is missing.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, lie_bracket
    >>> x, y = sp.symbols("x y")
    >>> plane = Frame([x, y], [[1, 0], [0, 1]])
    >>> turn = lie_bracket(plane, [1, 0], [-y, x])
    >>> turn.nonzero()
    {(1,): 1}
    >>> lie_bracket(turn, [y, 0]).nonzero()
    {(0,): 1}
    """
    if second is None:
        if isinstance(frame, Frame):
            raise ArgumentError("second: expected a second vector field, got none.")
        fields = (frame, first)
        home = next((field.frame for field in fields if isinstance(field, Tensor)), None)
        if home is None:
            raise ArgumentError(
                "frame: expected a frame, or a vector field that is a tensor, got "
                f"{checks.shown(frame)}. Give the frame first: lie_bracket(frame, first, second)."
            )
    else:
        home, fields = checks.instance(frame, Frame, "frame"), (first, second)
    return lie(vector(home, fields[0], "first"), vector(home, fields[1], "second"))

"""Connections: how they are made over a frame, a space, or the name of a space."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import Protocol, TypeAlias, runtime_checkable

from geomtorsion.errors import ArgumentError, GeomtorsionError, ShapeError, TensorIndexError
from geomtorsion.exact import Element
from geomtorsion.geometry import riemannian
from geomtorsion.geometry.components import Index, symmetric
from geomtorsion.geometry.connection import Connection
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.frame_matrices import parallel_rows
from geomtorsion.geometry.from_arrays import tensor_from_array
from geomtorsion.geometry.homes import at_home, over_frame
from geomtorsion.geometry.tensor import Scalar, Source, Tensor
from geomtorsion.geometry.torsion import Torsion
from geomtorsion.support import arguments, checks
from geomtorsion.support.higher import higher

HALF = Fraction(1, 2)


@runtime_checkable
class HasConnection(Protocol):
    """A space: it has a frame and one connection that it is about."""

    @property
    def frame(self) -> Frame:
        """The frame of the space."""
        ...

    def own_connection(self) -> Connection:
        """The connection of the space, or the Cartan connection of its frame."""
        ...


FrameLike: TypeAlias = Frame | HasConnection | str
ConnectionLike: TypeAlias = Connection | HasConnection | str


def as_frame(
    value: object, name: str = "frame", error: type[GeomtorsionError] = ArgumentError
) -> Frame:
    """A frame from a frame, a space, or the name of a shipped space.

    Raises
    ------
    ArgumentError
        The value is none of these; `error` replaces this class.
    UnknownNameError
        No space has this name; the message lists near ones.

    Examples
    --------
    >>> as_frame("so3").dimension
    3
    """
    space = _named(value)
    return space.frame if isinstance(space, HasConnection) else _instance(space, name, error)


def frame_of(value: object, name: str = "frame") -> Frame:
    """A frame as in `as_frame`, or the frame over which a connection was made."""
    return value.frame if isinstance(value, Connection) else as_frame(value, name)


def as_connection(
    value: object, name: str = "connection", error: type[GeomtorsionError] = ArgumentError
) -> Connection:
    """A connection from a connection, a space, or the name of a shipped space.

    A space contributes its own connection, if it has one, otherwise the Cartan connection.

    Raises
    ------
    ArgumentError
        The value is none of these; `error` replaces this class. A frame has many connections.
    UnknownNameError
        No space has this name; the message lists near ones.

    Examples
    --------
    >>> as_connection("so3").kind, as_connection("chaplygin_sleigh").allowed
    ('cartan', (0, 1))
    """
    space = _named(value)
    if isinstance(space, HasConnection):
        return space.own_connection()
    if isinstance(space, Frame):
        raise error(
            f"{name}: expected a Connection, got a frame, which has many. Give cartan(frame) or "
            "levi_civita(frame)."
        )
    return checks.instance(space, Connection, name, error)


def _instance(value: object, name: str, error: type[GeomtorsionError]) -> Frame:
    """A frame; for a connection the message names the way to its frame."""
    if isinstance(value, Connection):
        raise error(f"{name}: expected a Frame, got a connection. Give connection.frame.")
    return checks.instance(value, Frame, name, error)


def _named(value: object) -> object:
    """The shipped space for its name; every other value as it is.

    Spaces are made of frames; only a text that a user typed leads from here to them.
    """
    if isinstance(value, str):
        return higher("spaces").shipped_space(value)
    return value


def _coefficients(frame: Frame, source: Source, symbol: str, name: str) -> Tensor:
    """Coefficients Gamma_ab^c; slots b and c do not transform as a tensor."""
    return Tensor(frame, "ddu", source, (), symbol, name, anchored=(1, 2))


def cartan(frame: FrameLike | Connection) -> Connection:
    """The connection in which the legs of the frame are parallel (Cartan, Weitzenboeck).

    A space, or the name of a shipped one, and a connection contribute their frame.

    Equation
    --------
    Gamma_ab^c = E_i^c d_a e^i_b                    [FizievKleinert1994], below eq. (6)

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> cartan(Frame([r, phi], [[1, 0], [0, r]])).torsion.T[0, 1, 1]
    1/r
    """
    return _cartan(frame_of(frame))


@derived
def _cartan(frame: Frame) -> Connection:
    rows = parallel_rows(frame)
    derivative, duals = rows.derivative.get, rows.duals

    def rule(index: Index) -> Element:
        a, b, c = index
        return frame.field.sum([(1, x, derivative((a, i, b))) for i, x in duals.rows[c]])

    coefficients = _coefficients(frame, rule, "\\Gamma", "Cartan")
    return Connection(frame, coefficients, "Cartan connection", "cartan", cartan)


def levi_civita(frame: FrameLike | Connection) -> Connection:
    """The torsion-free connection of the metric of the frame.

    A space, its name or a connection contributes its frame. The contortion of a metric connection
    is its difference from this one.

    Equation
    --------
    Gamma_ab^c = g^{ce} (d_a g_be + d_b g_ae - d_e g_ab) / 2

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> levi_civita(Frame([r, phi], [[1, 0], [0, r]])).is_flat
    True
    """
    return _levi_civita(frame_of(frame))


@derived
def _levi_civita(frame: Frame) -> Connection:
    coefficients = riemannian.christoffel(frame)
    return Connection(frame, coefficients, "Levi-Civita connection", "levi-civita", levi_civita)


def from_coefficients(frame: FrameLike, coefficients: arguments.Cube) -> Connection:
    """Connection with any coefficients Gamma_ab^c; it may have torsion and nonmetricity.

    Parameters
    ----------
    coefficients
        Gamma_ab^c, shape (n, n, n), axes (a, b, c), a the direction of differentiation.

    Raises
    ------
    ShapeError
        The array does not have the shape (n, n, n).

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> x, y = sp.symbols("x y")
    >>> flat = Frame([x, y], [[1, 0], [0, 1]])
    >>> bent = from_coefficients(flat, [[[0, 0], [y, 0]], [[0, 0], [0, 0]]])
    >>> bent.torsion.S[0, 1, 0], bent.is_flat, bent.metric_compatible
    (y/2, False, False)
    """
    frame = as_frame(frame)
    if isinstance(coefficients, Tensor):
        tensor = _given(frame, coefficients, "ddu", "connection coefficients")
    else:
        tensor = tensor_from_array(frame, "ddu", coefficients, "connection coefficients")
    return Connection(frame, _coefficients(frame, tensor.components, "\\Gamma", "connection"))


def from_spin_connection(frame: FrameLike, omega: arguments.Cube) -> Connection:
    """Connection from its spin connection omega_ai^j: D_a E_i = omega_ai^j E_j.

    Equation
    --------
    Gamma_ab^c = E_j^c (d_a e^j_b + omega_ai^j e^i_b)

    Parameters
    ----------
    omega
        omega_ai^j, shape (n, n, n), axes (a, i, j): direction (coordinate) first, then legs; or a
        tensor whose first index, of either kind, is the direction: slots dDU, DDU, dDD, ..., and
        dUD for omega_a^j_i. Metric when omega_aij is antisymmetric in i and j.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, levi_civita
    >>> theta, phi = sp.symbols("theta phi")
    >>> frame = Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]])
    >>> again = from_spin_connection(frame, levi_civita(frame).spin_connection)
    >>> again.is_torsion_free, again.metric_compatible
    (True, True)
    """
    frame = as_frame(frame)
    if isinstance(omega, Tensor):
        tensor = _direction_first(frame, omega)
    else:
        tensor = tensor_from_array(frame, "dDU", omega, "spin connection")
    spin = tensor.components
    bent = Tensor(frame, "dDU", spin)._with_slot(1, "d").components.get
    derivative, legs = frame.coframe_derivative.get, frame.legs.components
    field = frame.field

    def rule(index: Index) -> Element:
        a, b, c = index
        terms = []
        for j, leg in legs.rows[c]:
            terms += [(1, leg, derivative((a, j, b))), (1, leg, bent((a, b, j)))]
        return field.sum(terms)

    lower = Tensor(frame, "dDU", spin).lowered(2).components
    metric = all(_cancels(lower.get((a, i, j)), lower.get((a, j, i))) for a, i, j in lower.nonzero)
    coefficients = _coefficients(frame, rule, "\\Gamma", "connection")
    kind = "metric" if metric else "general"
    return Connection(frame, coefficients, "connection from spin connection", kind)


def _direction_first(frame: Frame, omega: Tensor) -> Tensor:
    """A spin connection with slots dDU from a tensor with the direction first, in other slots."""
    slots = omega.slots
    home = at_home(frame, omega)
    if home is not None and len(slots) == 3 and slots[0] in "dD" and set(slots[1:]) <= {*"DU"}:
        free = Tensor(frame, slots, home.components)._with_slot(0, "d")
        if slots[1:] == "UD":
            get = free.components.get
            return Tensor(frame, "dDU", lambda index: get((index[0], index[2], index[1])))
        return free.lowered(1).raised(2)._with_slot(0, "d")
    return _given(frame, omega, "dDU", "spin connection")


def from_contortion(frame: FrameLike, contortion: arguments.Cube) -> Connection:
    """Metric connection from its contortion: Gamma_ab^c = Gamma_bar_ab^c + K_ab^c.

    Parameters
    ----------
    contortion
        K_ab^c, shape (n, n, n) in coordinates, or a tensor with slots ddu (or DDU, ddd, ...).

    Raises
    ------
    TensorIndexError
        K_abc is not antisymmetric in b and c, as a contortion must be.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> x, y, c = sp.symbols("x y c")
    >>> plane = Frame([x, y], [[1, 0], [0, 1]])
    >>> turning = from_contortion(plane, [[[0, c], [-c, 0]], [[0, 0], [0, 0]]])
    >>> turning.metric_compatible, turning.torsion.S[0, 1, 0]
    (True, -c/2)
    """
    frame = as_frame(frame)
    tensor = _with_slots(frame, contortion, "contortion")
    lower = tensor.lowered(2).components
    for a, b, c in lower.nonzero:
        if not _cancels(lower.get((a, b, c)), lower.get((a, c, b))):
            raise TensorIndexError(
                f"contortion: K_abc must be antisymmetric in its last two indices, but components "
                f"[{a}, {b}, {c}] and [{a}, {c}, {b}] do not cancel. "
                "Use from_coefficients for a connection that does not keep lengths."
            )
    total_ = riemannian.christoffel(frame) + tensor
    coefficients = _coefficients(frame, total_.components, "\\Gamma", "connection")
    return Connection(frame, coefficients, "connection from contortion", "metric")


def from_torsion(frame: FrameLike, torsion: arguments.Cube | Torsion) -> Connection:
    """The only metric connection with the torsion S_ab^c = (Gamma_ab^c - Gamma_ba^c)/2.

    Equation
    --------
    Gamma_ab^c = Gamma_bar_ab^c + K_ab^c,  K_abc = S_abc - S_bca + S_cab
                                      [HehlEtAl1976], section II, whose K has the other sign

    Parameters
    ----------
    torsion
        S_ab^c (with the half), shape (n, n, n) in coordinates, or a tensor with slots ddu (or DDU,
        ddd, ...); a `Torsion` gives its S.

    Raises
    ------
    TensorIndexError
        S_ab^c is not antisymmetric in a and b, as a torsion must be.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> frame = Frame([r, phi], [[1, 0], [0, r]])
    >>> again = from_torsion(frame, cartan(frame).torsion.S)
    >>> again.metric_compatible, again.coefficients == cartan(frame).coefficients
    (True, True)
    """
    frame = as_frame(frame)
    tensor = _with_slots(frame, torsion.S if isinstance(torsion, Torsion) else torsion, "torsion")
    own = tensor.components
    for a, b, c in own.nonzero:
        if not _cancels(own.get((a, b, c)), own.get((b, a, c))):
            raise TensorIndexError(
                f"torsion: S_ab^c must be antisymmetric in its first two indices, but components "
                f"[{a}, {b}, {c}] and [{b}, {a}, {c}] do not cancel. "
                "Use from_coefficients for coefficients, from_contortion for a contortion."
            )
    gamma = riemannian.christoffel(frame) + riemannian.contortion_of(tensor)
    coefficients = _coefficients(frame, gamma.components, "\\Gamma", "connection")
    return Connection(frame, coefficients, "connection from torsion", "metric")


def from_nonmetricity(
    frame: FrameLike, nonmetricity: arguments.Cube, torsion: arguments.Cube | Torsion | None = None
) -> Connection:
    """The only connection with the nonmetricity Q_abc = D_a g_bc and a given torsion.

    Equation
    --------
    Gamma_ab^c = Gamma_bar_ab^c + K_ab^c + L_ab^c,  L_abc = (Q_cab - Q_abc - Q_bac) / 2

    Parameters
    ----------
    nonmetricity
        Q_abc, symmetric in b and c, shape (n, n, n) in coordinates, or a tensor with slots ddd (or
        DDD, dud, ...).
    torsion
        S_ab^c as in `from_torsion`; without it the connection has no torsion.

    Raises
    ------
    TensorIndexError
        Q_abc is not symmetric in b and c, or S_ab^c not antisymmetric in a and b.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> x, y = sp.symbols("x y")
    >>> plane = Frame([x, y], [[1, 0], [0, 1]])
    >>> stretched = from_nonmetricity(plane, [[[x, 0], [0, 0]], [[0, 0], [0, 0]]])
    >>> stretched.nonmetricity.nonzero(), stretched.is_torsion_free
    ({(0, 0, 0): x}, True)
    """
    frame = as_frame(frame)
    Q = _with_slots(frame, nonmetricity, "nonmetricity", "ddd").components.get
    for a, b, c in product(range(frame.dimension), repeat=3):
        if b < c and not _cancels(Q((a, b, c)), -Q((a, c, b))):
            raise TensorIndexError(
                "nonmetricity: Q_abc must be symmetric in its last two indices, but components "
                f"[{a}, {b}, {c}] and [{a}, {c}, {b}] differ. Use from_coefficients for "
                "coefficients."
            )

    def rule(index: Index) -> Element:
        a, b, c = index
        terms = [(HALF, Q((c, a, b))), (-HALF, Q((a, b, c))), (-HALF, Q((b, a, c)))]
        return frame.field.sum(terms)

    metric = levi_civita(frame) if torsion is None else from_torsion(frame, torsion)
    extra = Tensor(frame, "ddd", rule, symmetric(3)).raised(2)
    coefficients = _coefficients(
        frame, (metric.coefficients + extra).components, "\\Gamma", "connection"
    )
    return Connection(frame, coefficients, "connection from nonmetricity", "general")


def blend(first: ConnectionLike, second: ConnectionLike, share: Scalar = HALF) -> Connection:
    """Connection (1 - share) first + share second: the Cartan-Schouten family of two connections.

    Parameters
    ----------
    share
        Number or expression; 0 gives the first connection, 1 the second.

    Raises
    ------
    ShapeError
        The connections belong to different frames.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> r, phi, s = sp.symbols("r phi s", positive=True)
    >>> frame = Frame([r, phi], [[1, 0], [0, r]])
    >>> blend(levi_civita(frame), cartan(frame), s).torsion.T[0, 1, 1]
    s/r
    """
    first, second = as_connection(first, "first"), as_connection(second, "second")
    second_here = over_frame(first.frame, second, "second", ShapeError)
    (weight,) = first.frame.read([("share", share)])
    # One difference and one product a component; (1 - s) A + s B would take two products.
    mixed = first.coefficients + (second_here.coefficients - first.coefficients) * weight
    coefficients = _coefficients(first.frame, mixed.components, "\\Gamma", "connection")
    kind = "general" if "general" in (first.kind, second.kind) else "metric"
    name = f"blend of {first.name} and {second.name}"
    return Connection(first.frame, coefficients, name, kind)


def _cancels(one: Element, two: Element) -> bool:
    """Whether two components add to zero."""
    return (one + two).is_zero is True


def _with_slots(frame: Frame, values: object, what: str, slots: str = "ddu") -> Tensor:
    """Torsion or another field in one form, from a tensor in any form or from an array."""
    if not isinstance(values, Tensor):
        return tensor_from_array(frame, slots, values, what)
    tensor = values.in_coordinates()
    for k, slot in enumerate(slots[: len(tensor.slots)]):
        tensor = tensor.raised(k) if slot == "u" else tensor.lowered(k)
    return _given(frame, tensor, slots, what)


def _given(frame: Frame, tensor: Tensor, slots: str, what: str) -> Tensor:
    """A tensor handed in for an array: the same frame and the right slots."""
    home = over_frame(frame, tensor, what, ShapeError)
    if tensor.slots != slots:
        raise TensorIndexError(
            f"{what}: expected slots {slots!r}, got {tensor.slots!r}. Use raised, lowered, "
            "in_frame or in_coordinates."
        )
    return home

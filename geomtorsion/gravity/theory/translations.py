"""Translations: symbols of other papers and programs in symbols of this package, each tested."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from geomtorsion.exact import Element
from geomtorsion.geometry import Connection, Tensor, contract
from geomtorsion.gravity.theory.field_equations import equations
from geomtorsion.gravity.theory.fields import Index, Terms

HALF, QUARTER = Fraction(1, 2), Fraction(1, 4)


@dataclass(frozen=True)
class Translation:
    """A symbol of another paper or program, with its translation.

    source: paper, review or program.
    theirs: the symbol with its indices, in the order of the source.
    definition: its definition there, in the symbols of the source.
    here: the same in symbols of this package.
    their_value: connection -> the symbol by its definition, in coordinates.
    own_value: connection -> the same by quantities of this package.
    """

    source: str
    theirs: str
    definition: str
    here: str
    their_value: Callable[[Connection], Tensor]
    own_value: Callable[[Connection], Tensor]

    def holds(self, connection: Connection) -> bool:
        """Whether both are equal on a connection."""
        return (self.their_value(connection) - self.own_value(connection)).is_zero is True

    def __str__(self) -> str:
        return f"{self.source}: {self.theirs} = {self.definition}; here {self.here}"


def _made(connection: Connection, slots: str, terms: Callable[[Index], Terms]) -> Tensor:
    """A tensor from the terms of its components."""
    frame = connection.frame
    return Tensor(frame, slots, lambda index: frame.field.sum(terms(index)))


def _gamma(connection: Connection) -> Callable[[Index], Element]:
    return connection.coefficients.components.get


def _first_up(connection: Connection) -> Tensor:
    """Gamma^c_ba - Gamma^c_ab with the derivative last, at [c, a, b]."""
    # Their Gamma^c_ba, derivative a last, is Gamma_ab^c here.
    get = _gamma(connection)
    return _made(
        connection, "udd", lambda i: [(1, get((i[1], i[2], i[0]))), (-1, get((i[2], i[1], i[0])))]
    )


def _moved(tensor: Tensor, letters: str) -> Tensor:
    """The same tensor with its indices in another order, as contract writes it."""
    return contract(letters, tensor)


def _maluf(connection: Connection) -> Tensor:
    """Sigma^abc from T^abc, the leg first."""
    upper = _moved(connection.torsion.T.raised(), "abc->cab")
    T, metric = upper.components.get, connection.frame.inverse_metric.components.get
    # T^a = T^b_b^a.
    trace = contract("aab->b", upper.lowered(0)).components.get

    def terms(index: Index) -> Terms:
        a, b, c = index
        return [
            (QUARTER, T((a, b, c))),
            (QUARTER, T((b, a, c))),
            (-QUARTER, T((c, a, b))),
            (HALF, metric((a, c)), trace((b,))),
            (-HALF, metric((a, b)), trace((c,))),
        ]

    return _made(connection, "uuu", terms)


def _own_momentum(connection: Connection) -> Tensor:
    """P^{bca} / 2 of L = T, the leg first."""
    momentum = equations(connection, "T").P.in_coordinates().raised()
    return _moved(momentum, "bca->abc") * HALF


def _modified(connection: Connection) -> Tensor:
    """S_ij^k + delta_i^k S_jl^l - delta_j^k S_il^l."""
    half = connection.torsion.S.components.get
    n = range(connection.frame.dimension)

    def terms(index: Index) -> Terms:
        i, j, k = index
        summands: Terms = [(1, half(index))]
        summands += [(1, half((j, m, m))) for m in n if i == k]
        summands += [(-1, half((i, m, m))) for m in n if j == k]
        return summands

    return _made(connection, "ddu", terms)


def _spin_momentum(connection: Connection) -> Tensor:
    """- C^k_ij of L = R, which is -(T_ij^k + ...) without the half."""
    C = equations(connection, "R").C.in_coordinates().lowered(1)
    return _moved(C, "kij->ijk") * HALF * -1


def _hehl_contortion(connection: Connection) -> Tensor:
    """- S_ij^k + S_j^k_i - S^k_ij."""
    half = connection.torsion.S.lowered(2).components.get
    lower = _made(
        connection,
        "ddd",
        lambda i: [(-1, half(i)), (1, half((i[1], i[2], i[0]))), (-1, half((i[2], i[0], i[1])))],
    )
    return lower.raised(2)


def _krssak(connection: Connection) -> Tensor:
    """S^amn = K^mna + g^am T^n - g^an T^m, T^m = T^am_a."""
    first = _first_up(connection).lowered(0)
    up = first.raised().components.get
    trace = contract("aba->b", first.raised(0)).raised().components.get
    g = connection.frame.inverse_metric.components.get

    def terms(index: Index) -> Terms:
        a, m, n = index
        return [
            (HALF, up((n, m, a))),
            (HALF, up((a, m, n))),
            (-HALF, up((m, n, a))),
            (1, g((a, m)), trace((n,))),
            (-1, g((a, n)), trace((m,))),
        ]

    return _made(connection, "uuu", terms)


def _torsion_form(connection: Connection) -> Tensor:
    """d_m e^a_n - d_n e^a_m + omega_mb^a e^b_n - omega_nb^a e^b_m, at [a, m, n]."""
    frame = connection.frame
    d, e = frame.coframe_derivative.get, frame.coframe.components.get
    omega = connection.spin_connection.components.get

    def terms(index: Index) -> Terms:
        a, m, n = index
        summands: Terms = [(1, d((m, a, n))), (-1, d((n, a, m)))]
        for b in range(frame.dimension):
            summands += [(1, omega((m, b, a)), e((b, n))), (-1, omega((n, b, a)), e((b, m)))]
        return summands

    return _made(connection, "Udd", terms)


def _scalar(connection: Connection) -> Tensor:
    """T = S_a^mn T^a_mn / 2."""
    return contract("amn,amn->", _krssak(connection), _first_up(connection).lowered()) * HALF


def _xact_riemann(connection: Connection) -> Tensor:
    """R_abc^d from [D_a, D_b] w_c = R_abc^d w_d - T^d_ab D_d w_c."""
    get, n = _gamma(connection), range(connection.frame.dimension)
    q = connection.frame.coordinates

    def terms(index: Index) -> Terms:
        a, b, c, d = index
        summands: Terms = [(1, get((a, c, d)).diff(q[b])), (-1, get((b, c, d)).diff(q[a]))]
        for e in n:
            summands.append((-1, get((b, c, e)), get((a, e, d))))
            summands.append((1, get((a, c, e)), get((b, e, d))))
        return summands

    return _made(connection, "dddu", terms)


TABLE = (
    Translation(
        "Maluf",
        "T^a_mn",
        "d_m e^a_n - d_n e^a_m",
        "T_mn^a, the leg last",
        _first_up,
        lambda c: _moved(c.torsion.T, "mna->amn"),
    ),
    Translation(
        "Maluf",
        "T^a",
        "T^b_b^a",
        "-v^a",
        lambda c: contract("aab->b", _first_up(c)),
        lambda c: -c.torsion.vector,
    ),
    Translation(
        "Maluf",
        "Sigma^abc",
        "(T^abc + T^bac - T^cab)/4 + (g^ac T^b - g^ab T^c)/2",
        "P^bca/2 of L = T",
        _maluf,
        _own_momentum,
    ),
    Translation(
        "Hohmann, Bahamonde",
        "T^c_ab",
        "Gamma^c_ba - Gamma^c_ab, the derivative last",
        "T_ab^c",
        _first_up,
        lambda c: _moved(c.torsion.T, "abc->cab"),
    ),
    Translation(
        "Krssak",
        "S^amn",
        "(T^nma + T^amn - T^mna)/2 - g^an T^m + g^am T^n, T^m = T^am_a",
        "P^mna of L = T",
        _krssak,
        lambda c: _own_momentum(c) * 2,
    ),
    Translation(
        "Krssak, Hohmann, Bahamonde",
        "T",
        "S_a^mn T^a_mn/2",
        "T; with (+---) both are -6 H^2 in a flat cosmos, with (-+++) both are 6 H^2",
        _scalar,
        lambda c: c.torsion.scalar,
    ),
    Translation(
        "Hehl 1976",
        "S_ij^k",
        "(Gamma_ij^k - Gamma_ji^k)/2",
        "S_ij^k",
        lambda c: _made(
            c,
            "ddu",
            lambda i: [(HALF, _gamma(c)(i)), (-HALF, _gamma(c)((i[1], i[0], i[2])))],
        ),
        lambda c: c.torsion.S,
    ),
    Translation(
        "Hehl 1976",
        "K_ij^k",
        "-S_ij^k + S_j^k_i - S^k_ij",
        "-K_ij^k",
        _hehl_contortion,
        lambda c: -c.contortion_from_torsion,
    ),
    Translation(
        "Hehl 1976",
        "T_ij^k, modified torsion",
        "S_ij^k + delta_i^k S_jl^l - delta_j^k S_il^l",
        "-C^k_ij/2 of L = R, for a metric connection",
        _modified,
        _spin_momentum,
    ),
    Translation(
        "Hehl 1995",
        "Q_abc",
        "-D_a g_bc",
        "-Q_abc",
        lambda c: -c.covariant_derivative(c.frame.metric),
        lambda c: -c.nonmetricity,
    ),
    Translation(
        "xAct",
        "T^c_ab",
        "Gamma^c_ab - Gamma^c_ba, the derivative first",
        "T_ab^c",
        lambda c: _made(
            c,
            "udd",
            lambda i: [
                (1, _gamma(c)((i[1], i[2], i[0]))),
                (-1, _gamma(c)((i[2], i[1], i[0]))),
            ],
        ),
        lambda c: _moved(c.torsion.T, "abc->cab"),
    ),
    Translation(
        "xAct",
        "R_abc^d",
        "[D_a, D_b] w_c = R_abc^d w_d - T^d_ab D_d w_c",
        "-R_abc^d; Ricci is the same",
        _xact_riemann,
        lambda c: -c.curvature.riemann,
    ),
    Translation(
        "GRG and Hehl 1995",
        "Theta^a, T^a",
        "d e^a + omega_b^a ^ e^b, components at mn",
        "T_mn^a",
        _torsion_form,
        lambda c: contract("mnc,ac->amn", c.torsion.T, c.frame.coframe),
    ),
)


def translations() -> tuple[Translation, ...]:
    """Symbols of other papers and programs, written in symbols of this package.

    Examples
    --------
    >>> print(translations()[1])
    Maluf: T^a = T^b_b^a; here -v^a
    """
    return TABLE

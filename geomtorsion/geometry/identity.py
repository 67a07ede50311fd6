"""Identity: relations that every connection obeys, run as checks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations, product

from geomtorsion.exact import Certainty, Element
from geomtorsion.exact.element import PROVED, least_certain
from geomtorsion.geometry import notation, riemannian
from geomtorsion.geometry.components import Index
from geomtorsion.geometry.connection import Connection
from geomtorsion.geometry.connections import ConnectionLike, as_connection, cartan, levi_civita
from geomtorsion.geometry.frame import Frame


@dataclass(frozen=True)
class IdentityCheck:
    """Result of one check.

    name, equation: of the identity that was checked.
    holds: True, False, or None where it cannot be decided.
    checked: how many components were compared.
    worst: index of the first component that fails, or else is undecided; None if all hold.
    certainty: how certain it is that the components found to vanish do vanish.
    """

    name: str
    equation: str
    holds: bool | None
    checked: int
    worst: Index | None = None
    certainty: Certainty = PROVED

    def __str__(self) -> str:
        verdict = {True: "holds", False: "FAILS", None: "undecided"}[self.holds]
        where = "" if self.worst is None else f", first at {list(self.worst)}"
        sure = "" if self.certainty.proved else f"; {self.certainty}"
        return f"{self.name}: {verdict} ({self.checked} components{where}{sure}): {self.equation}"


class IdentityChecks(list[IdentityCheck]):
    """The checks of one connection, in a list that prints one per line."""

    def __repr__(self) -> str:
        return "\n".join(map(str, self))

    def _repr_html_(self) -> str:
        words = {True: "holds", False: "fails", None: "undecided"}
        return notation.html_table(
            ("identity", "verdict", "components", "equation"),
            [(check.name, words[check.holds], check.checked, check.equation) for check in self],
        )


def identities(connection: ConnectionLike | Frame) -> IdentityChecks:
    """Check the identities that apply to a connection, exactly; for a frame, its Cartan connection.

    Metricity is a property rather than an identity: it fails for a connection that does not keep
    lengths. The scalar identity is checked for metric connections; on a flat one it reads
    R_bar = - T_scalar - 2 D_bar_a v^a.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, cartan
    >>> theta, phi = sp.symbols("theta phi")
    >>> sphere = Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]])
    >>> for identity in identities(cartan(sphere)):
    ...     print(identity.name, identity.holds, identity.checked)
    metricity True 6
    decomposition True 8
    first Bianchi True 0
    second Bianchi True 0
    scalar True 1
    """
    if isinstance(connection, Frame):
        connection = cartan(connection)
    connection = as_connection(connection)
    results = [metricity(connection), decomposition(connection)]
    results += [first_bianchi(connection), second_bianchi(connection)]
    if connection.metric_compatible:
        results.append(scalar_identity(connection))
    return IdentityChecks(results)


def metricity(connection: Connection) -> IdentityCheck:
    """D_a g_bc = 0."""
    n, get = connection.frame.dimension, connection.nonmetricity.components.get
    indices = ((a, b, c) for a, b, c in product(range(n), repeat=3) if b <= c)
    return _checked("metricity", "D_a g_bc = 0", indices, get)


def decomposition(connection: Connection) -> IdentityCheck:
    """Gamma = Levi-Civita + contortion (by its definition from the torsion) + disformation."""
    gamma = connection.coefficients.components.get
    parts = [
        riemannian.christoffel(connection.frame).components.get,
        connection.contortion_from_torsion.components.get,
        connection.disformation.components.get,
    ]

    def difference(index: Index) -> Element:
        terms = [(-1, part(index)) for part in parts]
        return connection.frame.field.sum([(1, gamma(index)), *terms])

    indices = product(range(connection.frame.dimension), repeat=3)
    equation = "Gamma_ab^c = Gamma_bar_ab^c + K_ab^c + L_ab^c"
    return _checked("decomposition", equation, indices, difference)


def first_bianchi(connection: Connection) -> IdentityCheck:
    """Cyclic sum of R_abl^k equals the cyclic sum of D_a T_bl^k + T_ab^t T_tl^k."""
    n = connection.frame.dimension
    riemann = connection.curvature.riemann.components.get
    torsion = connection.torsion.T
    whole = torsion.components.get
    derivative = connection.covariant_derivative(torsion).components.get

    def difference(index: Index) -> Element:
        *triple, k = index
        terms: list = []
        for a, b, c in _cyclic(*triple):
            terms += [(1, riemann((a, b, c, k))), (-1, derivative((a, b, c, k)))]
            terms += [(-1, whole((a, b, t)), whole((t, c, k))) for t in range(n)]
        return connection.frame.field.sum(terms)

    indices = ((*triple, k) for triple in combinations(range(n), 3) for k in range(n))
    equation = "sum over cyclic abl: R_abl^k = D_a T_bl^k + T_ab^t T_tl^k"
    return _checked("first Bianchi", equation, indices, difference)


def second_bianchi(connection: Connection) -> IdentityCheck:
    """Cyclic sum of D_a R_mnl^k + T_am^t R_tnl^k vanishes."""
    n = connection.frame.dimension
    curvature = connection.curvature.riemann
    riemann = curvature.components.get
    whole = connection.torsion.T.components.get
    derivative = connection.covariant_derivative(curvature).components.get

    def total(index: Index) -> Element:
        *triple, c, k = index
        terms: list = []
        for a, m, b in _cyclic(*triple):
            terms.append((1, derivative((a, m, b, c, k))))
            terms += [(1, whole((a, m, t)), riemann((t, b, c, k))) for t in range(n)]
        return connection.frame.field.sum(terms)

    indices = (
        (*triple, c, k)
        for triple in combinations(range(n), 3)
        for c, k in product(range(n), repeat=2)
    )
    equation = "sum over cyclic amn: D_a R_mnl^k + T_am^t R_tnl^k = 0"
    return _checked("second Bianchi", equation, indices, total)


def scalar_identity(connection: Connection) -> IdentityCheck:
    """R = R_bar + T_scalar + 2 D_bar_a v^a for a metric connection."""
    frame = connection.frame
    bar = levi_civita(frame)
    upper = connection.torsion.vector.raised(0)
    slope = bar.covariant_derivative(upper).components.get

    def difference(_: Index) -> Element:
        terms: list = [(2, slope((a, a))) for a in range(frame.dimension)]
        terms.append((1, bar.curvature.scalar.element()))
        terms.append((1, connection.torsion.scalar.element()))
        terms.append((-1, connection.curvature.scalar.element()))
        return frame.field.sum(terms)

    equation = "R = R_bar + T_scalar + 2 D_bar_a v^a"
    if connection.is_flat:
        equation = "R_bar = - T_scalar - 2 D_bar_a v^a"
    return _checked("scalar", equation, [()], difference)


def _cyclic(a: int, b: int, c: int) -> tuple[Index, ...]:
    """The three cyclic orders."""
    return (a, b, c), (b, c, a), (c, a, b)


def _checked(
    name: str,
    equation: str,
    indices: Iterator[Index] | list[Index],
    value: Callable[[Index], Element],
) -> IdentityCheck:
    """Evaluate the difference of both sides at every index."""
    checked, holds, worst = 0, True, None
    zeros = []
    for index in indices:
        checked += 1
        element = value(index)
        verdict = element.is_zero
        if verdict is not False:
            zeros.append(element.certainty)
        if (verdict is False and holds is not False) or (verdict is None and holds):
            holds, worst = verdict, index
    return IdentityCheck(name, equation, holds, checked, worst, least_certain(zeros))

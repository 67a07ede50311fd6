"""Embedded: the connection with torsion of a matrix with more rows than columns."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import sympy as sp

from geomtorsion.errors import CoframeError, MetricError
from geomtorsion.exact import Element
from geomtorsion.geometry.components import Index
from geomtorsion.geometry.connection import Connection
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.geometry.validation import Coordinates, signs_or_rows
from geomtorsion.support import checks

_entries = partial(
    checks.entries, error=CoframeError, expected="rows of entries", remedy="Give nested lists."
)


def embedded(
    coordinates: Coordinates,
    rows: object,
    signature: Sequence[int] | None = None,
    parameters: Sequence[sp.Symbol] | None = None,
    domain: object = None,
    name: str | None = None,
) -> Connection:
    """Metric connection with torsion from m >= n one-forms eps^i of n coordinates in flat space.

    The forms map each step dq to a step eps^i_mu dq^mu in flat space with Cartesian coordinates
    x^i. Parallel transport there is projected back. Rows d x^i(q) embed a surface and give its
    Levi-Civita connection. Rows that are not gradients give torsion. Parallel transport keeps
    lengths in both cases.

    Equation
    --------
    g_ab = eps^i_a eta_ij eps^j_b,  Gamma_ab^c = g^{cd} eps^i_d eta_ij d_a eps^j_b
    (Kleinert and Shabanov, Phys. Lett. B 428 (1998) 315)

    Parameters
    ----------
    coordinates
        q^mu, as many as the rows have entries.
    rows
        eps^i_mu, shape (m, n) with m >= n, one row for each flat coordinate. With m = n these are
        the rows of a coframe, and the connection is its Cartan connection.
    signature
        m signs of the metric of flat space; None: all +1.
    parameters, domain, name
        As for `Frame`.

    Returns
    -------
    Connection, over `Frame.from_metric` of the induced metric.

    Raises
    ------
    CoframeError
        The rows differ in length, or are fewer than the columns.
    MetricError
        The induced metric is degenerate: the columns depend on each other.

    Examples
    --------
    A plane whose steps along y also climb by k x:

    >>> import sympy as sp
    >>> from geomtorsion.geometry import embedded
    >>> x, y, k = sp.symbols("x y k", real=True)
    >>> ramp = embedded([x, y], [[1, 0], [0, 1], [0, k * x]])
    >>> ramp.frame.metric[1, 1], ramp.torsion.T[0, 1, 1], ramp.metric_compatible
    (k**2*x**2 + 1, k**2*x/(k**2*x**2 + 1), True)
    """
    entries = [
        [
            checks.expression(x, f"rows[{i}, {mu}]")
            for mu, x in enumerate(_entries(row, f"rows[{i}]"))
        ]
        for i, row in enumerate(_entries(rows, "rows"))
    ]
    lengths = {len(row) for row in entries}
    if len(lengths) != 1 or lengths == {0}:
        raise CoframeError(
            f"rows: expected rows of one length, got lengths {[len(row) for row in entries]}. Give "
            "one entry for each coordinate in every row."
        )
    m, (n,) = len(entries), lengths
    if m < n:
        raise CoframeError(
            f"rows: expected at least {n} rows for {n} columns, got {m}. Give one row for each "
            "coordinate of the flat space."
        )
    signs = list(signs_or_rows(signature)) if signature is not None else [1] * m
    if len(signs) != m or any(sign not in (1, -1) for sign in signs):
        raise MetricError(
            f"signature: expected {m} signs, one for each row, got {checks.shown(signature)}. Give "
            "1 or -1 for each."
        )
    metric = [
        [
            sp.Add(*(s * row[a] * row[b] for s, row in zip(signs, entries, strict=True)))
            for b in range(n)
        ]
        for a in range(n)
    ]
    frame = Frame.from_metric(coordinates, metric, parameters=parameters, domain=domain, name=name)
    flat = frame.read(
        [(f"rows[{i}, {mu}]", x) for i, row in enumerate(entries) for mu, x in enumerate(row)]
    )
    forms = [flat[n * i : n * (i + 1)] for i in range(m)]
    field, inverse = frame.field, frame.inverse_metric.components.rows

    def projected(index: Index) -> Element:
        a, b, d = index
        along = frame.coordinates[a]
        return field.sum([(s, x[d], x[b].diff(along)) for s, x in zip(signs, forms, strict=True)])

    lower = Tensor(frame, "ddd", projected).components.get

    def rule(index: Index) -> Element:
        a, b, c = index
        return field.sum([(1, x, lower((a, b, d))) for d, x in inverse[c]])

    coefficients = Tensor(frame, "ddu", rule, (), "\\Gamma", "connection", anchored=(1, 2))
    return Connection(frame, coefficients, "connection by embedding", "metric")

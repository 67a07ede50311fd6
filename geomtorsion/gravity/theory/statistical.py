"""Statistical: the alpha-connections of a metric and a totally symmetric cubic tensor."""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations

import sympy as sp

from geomtorsion.errors import ShapeError, TensorIndexError
from geomtorsion.geometry import Connection, Tensor, at_home, from_coefficients, levi_civita
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.support import checks


def statistical(
    metric: FrameLike, cubic: object, alpha: int | Fraction | sp.Expr | str = "alpha"
) -> Connection:
    """The alpha-connection of a statistical manifold.

    Equation
    --------
    Gamma_abc = Gamma_bar_abc - alpha C_abc / 2          [Amari1985]
    D_a g_bc = alpha C_abc

    Parameters
    ----------
    metric
        A frame; for a family of distributions the frame of its Fisher metric, by
        `Frame.from_metric`.
    cubic
        C_abc, totally symmetric: nested lists, shape (n, n, n), or a tensor with slots ddd.
    alpha
        A number, an expression or the name of a parameter. The connections of alpha and -alpha are
        dual to each other.

    Raises
    ------
    ShapeError
        The cubic form has another shape, or belongs to another frame.
    TensorIndexError
        The cubic form is not totally symmetric.

    Examples
    --------
    Normal distributions with mean m and deviation s:

    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> from geomtorsion.gravity import statistical
    >>> m, s = sp.symbols("m s", positive=True)
    >>> fisher = Frame.from_metric([m, s], [[1 / s**2, 0], [0, 2 / s**2]])
    >>> C = [[[0, 2 / s**3], [2 / s**3, 0]], [[2 / s**3, 0], [0, 8 / s**3]]]
    >>> statistical(fisher, C).curvature.scalar[()], statistical(fisher, C, 1).is_flat
    ((alpha - 1)*(alpha + 1), True)
    """
    metric = as_frame(metric, "metric")
    n = metric.dimension
    if isinstance(cubic, Tensor):
        home = at_home(metric, cubic)
        if home is None or cubic.slots.lower() != "ddd":
            raise ShapeError(
                f"cubic: expected a tensor over the metric's frame with slots ddd, got "
                f"{cubic.label} with slots {cubic.slots!r}. Lower its indices."
            )
        tensor = home.in_coordinates()
    else:
        tensor = Tensor(metric, "ddd", _entries(checks.rows(cubic), n), (), "C", "cubic form")
    for index in tensor.components.nonzero:
        for order in permutations(range(3)):
            turned = (index[order[0]], index[order[1]], index[order[2]])
            if tensor.element(*index) != tensor.element(*turned):
                raise TensorIndexError(
                    f"cubic: expected a totally symmetric C_abc, got components {list(index)} and "
                    f"{list(turned)} that differ. Symmetrise it."
                )
    share = sp.Symbol(alpha) if isinstance(alpha, str) else checks.expression(alpha, "alpha")
    bent = levi_civita(metric).coefficients - tensor.raised(2) * (share / 2)
    return from_coefficients(metric, Tensor(metric, "ddu", bent.components))


def _entries(rows: object, n: int) -> dict[tuple[int, ...], object]:
    """Components of nested lists, checked."""
    entries: dict[tuple[int, ...], object] = {}

    def enter(value: object, index: tuple[int, ...]) -> None:
        if len(index) == 3:
            entries[index] = value
            return
        if not isinstance(value, list | tuple) or len(value) != n:
            raise ShapeError(
                f"cubic{list(index) or ''}: expected {n} entries, got {checks.shown(value)}. Give "
                "nested lists C[a][b][c]."
            )
        for k, part in enumerate(value):
            enter(part, (*index, k))

    enter(rows, ())
    return entries

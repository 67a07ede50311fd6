"""s7: the unit seven-sphere with the parallelism that octonions give it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

import sympy as sp
from sympy import Expr, Integer, symbols
from sympy.combinatorics.permutations import Permutation

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import MARGIN
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, alternating, diagonal

# e_i e_j = e_k for these lines of the Fano plane and their cyclic orders.
LINES = ((1, 2, 4), (2, 3, 5), (3, 4, 6), (4, 5, 7), (5, 6, 1), (6, 7, 2), (7, 1, 3))
UNITS = range(1, 8)


def structure_constants() -> dict[tuple[int, int, int], int]:
    """phi_ijk with e_i e_j = -delta_ij + phi_ijk e_k; indices 1 to 7, totally antisymmetric.

    Examples
    --------
    >>> structure_constants()[1, 2, 4], structure_constants()[2, 1, 4]
    (1, -1)
    """
    table = {}
    for line in LINES:
        for order in permutations(range(3)):
            key = (line[order[0]], line[order[1]], line[order[2]])
            table[key] = int(Permutation(order).signature())
    return table


def product(left: list[Expr], right: list[Expr]) -> list[Expr]:
    """Product of two octonions, each a list of eight components, the real one first."""
    result = [left[0] * right[0] - sum(left[k] * right[k] for k in UNITS)]
    result += [left[0] * right[k] + left[k] * right[0] for k in UNITS]
    for (i, j, k), sign in structure_constants().items():
        result[k] += sign * left[i] * right[j]
    return result


def space(name: str) -> Space:
    """Point p = (1 + x)^2 / (1 + x.x) for an imaginary octonion x; coframe Im(conj(p) dp)."""
    x = symbols("x1:8", real=True)
    square = sum(component**2 for component in x)
    scale = (1 + square) ** 2
    phi = structure_constants()
    coframe = [
        [
            2
            * (
                (1 - square if i == m else 0)
                + 2 * x[i - 1] * x[m - 1]
                - 2 * sum(phi.get((i, k, m), 0) * x[k - 1] for k in UNITS)
            )
            / scale
            for m in UNITS
        ]
        for i in UNITS
    ]
    frame = Frame(x, coframe, name=name)
    return Space(
        name,
        story=(
            "The only sphere beyond S^3 that has a parallelism: the octonions comb it.\n"
            "Its torsion is totally antisymmetric but not constant: octonions do not associate."
        ),
        source="E. Cartan, J. A. Schouten, Proc. Kon. Akad. Amsterdam 29 (1926) 933; "
        "F. Guersey, C.-H. Tze, Phys. Lett. B 127 (1983) 191",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([4 / scale] * 7)),
            KnownAnswer("torsion", alternating(_torsion(x, square)), basis="frame"),
            KnownAnswer("torsion_vector", {}),
            KnownAnswer("torsion_tensor", {}),
            KnownAnswer("torsion_scalar", -42),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([6] * 7), basis="frame"),
            KnownAnswer("scalar_curvature", 42),
            KnownAnswer("weyl", {}),
        ),
        atlas=_atlas,
        motion=FirstMotion(
            (-0.17, 0.45, -0.54, 0.27, -0.37, 0.19, -0.76),
            (0.612, 0.408, 0.204, 0.408, 0.204, 0.408, 0.204),
        ),
        group="spheres",
        notes="Stereographic chart: it covers all of the sphere but one point. T_abc T^abc = 168.",
    )


def _torsion(x: tuple[Expr, ...], square: Expr) -> dict[tuple[int, ...], Expr]:
    """S_ijk = -<(p e_i) e_j, p e_k> by octonion algebra: [E_i, E_j] = (p e_i) e_j - (p e_j) e_i."""
    point = [1 - square, *(2 * component for component in x)]
    units = [[Integer(place == k) for place in range(8)] for k in range(8)]
    legs = {k: product(point, units[k]) for k in UNITS}
    table = {}
    for i in UNITS:
        for j in range(i + 1, 8):
            twice = product(legs[i], units[j])
            for k in range(j + 1, 8):
                inner = sum(left * right for left, right in zip(twice, legs[k], strict=True))
                table[i - 1, j - 1, k - 1] = -inner / (1 + square) ** 2
    return table


def _atlas(frame: Frame) -> Atlas:
    """A second stereographic chart, about the antipode: x / x.x is an isometry."""
    x = frame.coordinates
    y = sp.symbols("y1:8", real=True)

    def turned() -> Chart:
        rows = frame.coframe.to_sympy().subs(dict(zip(x, y, strict=True)), simultaneous=True)
        other = Frame(y, rows.tolist(), name="s7_far")
        return Chart.of(other, edge=_nearness(y), margin=MARGIN, keeps_frame=False)

    makers = {"s7": lambda: Chart.of(frame, edge=_nearness(x), margin=MARGIN), "s7_far": turned}
    maps = tuple(
        TransitionMap(one, other, q, tuple(k / sum(c**2 for c in q) for k in q))
        for one, other, q in (("s7", "s7_far", x), ("s7_far", "s7", y))
    )
    return Atlas("s7", makers, lambda: maps)


def _nearness(x: Sequence[sp.Symbol]) -> sp.Expr:
    """One half plus half of the cosine of the angle from the origin of a stereographic chart."""
    return 1 / (1 + sum(k**2 for k in x))

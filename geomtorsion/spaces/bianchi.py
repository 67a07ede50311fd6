"""bianchi: the nine types of three-dimensional Lie algebras, each with an orthonormal frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from sympy import Expr, Integer, KroneckerDelta, LeviCivita, Rational, Symbol, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.rotations import XYZ, angle_atlas, angle_embedding
from geomtorsion.spaces.space import KnownAnswer, Space, matrix
from geomtorsion.support.checks import expression

A = Symbol("a", positive=True)


@dataclass(frozen=True)
class Type:
    """One row of the table: n = diag(n1, n2, n3), the vector (a, 0, 0), and two lines."""

    n: tuple[int, int, int]
    a: Expr | int
    story: str


TYPES = {
    "bianchi_i": Type(
        (0, 0, 0),
        0,
        "Translations of flat space: everything commutes and the torsion is zero.\n"
        "The homogeneous cosmology on it is Kasner's.",
    ),
    "bianchi_ii": Type(
        (1, 0, 0),
        0,
        "The Heisenberg algebra: one commutator, and that one commutes with all.\n"
        "The only torsion component is a uniform density of screw dislocations.",
    ),
    "bianchi_iii": Type(
        (0, 1, -1),
        1,
        "The hyperbolic plane times a line, that is ax + b times R: type VI_h with h = -1.\n"
        "One leg commutes with the rest only after turning the frame by 45 degrees.",
    ),
    "bianchi_iv": Type(
        (0, 0, 1),
        1,
        "Zoom and shear at once: the case between V and VII_h.\n"
        "Torsion with a vector part and an axial part.",
    ),
    "bianchi_v": Type(
        (0, 0, 0),
        1,
        "Hyperbolic space H^3 as a group of zooms and shifts, the open Friedmann universe.\n"
        "The torsion is all vector: no axial and no tensor part.",
    ),
    "bianchi_vi_0": Type(
        (0, 1, -1),
        0,
        "Motions of the Minkowski plane, the algebra of Sol.\n"
        "Torsion without a vector part; its axial part vanishes too.",
    ),
    "bianchi_vi_h": Type(
        (0, 1, -1),
        A,
        "A family with parameter h = -a^2: stretching in two directions at unequal rates.\n"
        "At a = 1 it is type III, for a -> 0 it becomes VI_0.",
    ),
    "bianchi_vii_0": Type(
        (0, 1, 1),
        0,
        "Motions of the Euclidean plane: the frame of the twisted bar.\n"
        "The metric is flat although the torsion is not zero.",
    ),
    "bianchi_vii_h": Type(
        (0, 1, 1),
        A,
        "A family with parameter h = a^2: turning and zooming, a logarithmic spiral.\n"
        "The metric is hyperbolic space of curvature -a^2 whatever the turning.",
    ),
    "bianchi_viii": Type(
        (-1, 1, 1),
        0,
        "The algebra of SL(2,R), one of the two that are simple.\n"
        "Torsion of mixed signs, scalar curvature negative.",
    ),
    "bianchi_ix": Type(
        (1, 1, 1),
        0,
        "The algebra of the rotations: so3 again, now from its structure constants.\n"
        "Its cosmology is the mixmaster universe.",
    ),
}


def structure_constants(n: tuple[int, int, int], a: Expr | int) -> list[list[list[Expr]]]:
    """C[i][j][k] with [E_i, E_j] = C_ij^k E_k: eps_ijl n^lk + a_i delta_j^k - a_j delta_i^k.

    Examples
    --------
    >>> structure_constants((1, 1, 1), 0)[0][1]
    [0, 0, 1]
    """
    vector = (expression(a), Integer(0), Integer(0))
    return [
        [
            [
                LeviCivita(i, j, k) * n[k]
                + vector[i] * KroneckerDelta(j, k)
                - vector[j] * KroneckerDelta(i, k)
                for k in range(3)
            ]
            for j in range(3)
        ]
        for i in range(3)
    ]


def space(name: str) -> Space:
    """The type of this name."""
    kind = TYPES[name]
    constants = structure_constants(kind.n, kind.a)
    frame = Frame.from_structure_constants(
        constants, coordinates=symbols("x1 x2 x3", real=True), name=name
    )
    half = Rational(1, 2)
    torsion = {
        (i, j, k): -half * constants[i][j][k]
        for i in range(3)
        for j in range(3)
        for k in range(3)
        if constants[i][j][k] != 0
    }
    trace, squares = sum(kind.n), sum(entry**2 for entry in kind.n)
    scalar = -6 * expression(kind.a) ** 2 - squares + half * trace**2
    return Space(
        name,
        story=kind.story,
        source="G. F. R. Ellis, M. A. H. MacCallum, Commun. Math. Phys. 12 (1969) 108",
        frame=frame,
        known=(
            KnownAnswer("torsion", torsion, basis="frame"),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", _ricci(kind.n, kind.a), basis="frame"),
            KnownAnswer("scalar_curvature", scalar),
        ),
        atlas=partial(angle_atlas, XYZ) if name == "bianchi_ix" else None,
        embedding=partial(angle_embedding, XYZ) if name == "bianchi_ix" else None,
        group="Bianchi types",
        notes="Legs are the left-invariant fields of the algebra, orthonormal by definition.",
    )


def _ricci(n: tuple[int, int, int], a: Expr | int) -> dict[tuple[int, ...], Expr]:
    """Ricci tensor of the orthonormal frame in closed form, from n and a."""
    a = expression(a)
    trace, squares = sum(n), sum(entry**2 for entry in n)
    common = -2 * a**2 - squares + Rational(1, 2) * trace**2
    rows = [[Integer(0)] * 3 for _ in range(3)]
    for k in range(3):
        rows[k][k] = 2 * n[k] ** 2 - trace * n[k] + common
    rows[1][2] = rows[2][1] = a * (n[1] - n[2])
    return matrix(rows)

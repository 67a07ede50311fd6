"""teleparallel_cosmos: closed and open universes in tetrads as symmetric as their metrics."""

from itertools import permutations

from sympy import Expr, Function, LeviCivita, Rational, cos, cosh, pi, sin, sinh, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, box, diagonal

T, CHI, PSI, THETA, PHI = symbols("t chi psi theta phi", real=True)
SCALE = Function("a")(T)
RATE = SCALE.diff(T)
HALF = Rational(1, 2)
SOURCE = "M. Hohmann, L. Jaerv, M. Krssak, C. Pfeifer, Phys. Rev. D 100 (2019) 084002"


def space(name: str) -> Space:
    """A closed universe in left-invariant legs, an open one in legs of Minkowski space."""
    return _closed(name) if name == "frw_closed" else _open(name)


def _einstein(k: int) -> dict[tuple[int, ...], Expr]:
    """The Einstein tensor of a universe of curvature k, time first."""
    density = 3 * (RATE**2 + k) / SCALE**2
    pressure = -2 * SCALE.diff(T, 2) / SCALE - (RATE**2 + k) / SCALE**2
    return diagonal([density, pressure, pressure, pressure])


def _closed(name: str) -> Space:
    """Coframe (dt, a sigma^i / 2), sigma^i the left-invariant forms of the three-sphere."""
    s = SCALE / 2
    frame = Frame(
        (T, PSI, THETA, PHI),
        [
            [1, 0, 0, 0],
            [0, 0, s * cos(PSI), s * sin(PSI) * sin(THETA)],
            [0, 0, s * sin(PSI), -s * cos(PSI) * sin(THETA)],
            [0, s, 0, s * cos(THETA)],
        ],
        signature=(-1, 1, 1, 1),
        domain=box({PSI: (0, 4 * pi), THETA: (0, pi), PHI: (0, 2 * pi)}),
        name=name,
    )
    torsion = {(0, j, j): HALF * RATE / SCALE for j in (1, 2, 3)}
    for i, j, k in permutations((1, 2, 3)):
        if i < j:
            torsion[i, j, k] = LeviCivita(i, j, k) / SCALE
    return Space(
        name,
        story=(
            "The closed universe in legs that left translations of the three-sphere keep.\n"
            "Every f(T) theory accepts it: the antisymmetric part of the field equations is zero."
        ),
        source=SOURCE,
        frame=frame,
        known=(
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_tensor", {}),
            KnownAnswer("torsion_scalar", 6 * (RATE**2 - 1) / SCALE**2),
            KnownAnswer("einstein", _einstein(1), basis="frame"),
            KnownAnswer("weyl", {}),
        ),
        group="gravity",
        notes="Signature (-, +, +, +). Curvature k = 1.",
    )


def _open(name: str) -> Space:
    """Coframe X^A dt + a dX^A, X on the hyperboloid X.X = -1 of Minkowski space."""
    n = (sin(THETA) * cos(PHI), sin(THETA) * sin(PHI), cos(THETA))
    place = (cosh(CHI), *(sinh(CHI) * x for x in n))
    inner = (CHI, THETA, PHI)
    frame = Frame(
        (T, *inner),
        [[x, *(SCALE * x.diff(q) for q in inner)] for x in place],
        signature=(-1, 1, 1, 1),
        domain=[CHI > 0, *box({THETA: (0, pi), PHI: (0, 2 * pi)})],
        name=name,
    )
    lower = (-place[0], *place[1:])
    torsion = {
        (b, c, c): -HALF * (RATE - 1) / SCALE * lower[b]
        for b in range(4)
        for c in range(4)
        if b != c
    }
    return Space(
        name,
        story=(
            "The open universe in the legs of flat space-time, taken along as the cosmos expands.\n"
            "For a = t it is Milne's universe, flat and without torsion; f(T) theories accept it."
        ),
        source=SOURCE,
        frame=frame,
        known=(
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_tensor", {}),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("torsion_scalar", 6 * (RATE - 1) ** 2 / SCALE**2),
            KnownAnswer(
                "scalar_curvature", 6 * (SCALE * SCALE.diff(T, 2) + RATE**2 - 1) / SCALE**2
            ),
            KnownAnswer("weyl", {}),
        ),
        group="gravity",
        notes="Signature (-, +, +, +). Curvature k = -1.",
    )

"""section 2: equations (5) to (12), the geometry of rotations and of motions."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.paper.frames import PaperFrames
from geomtorsion.paper.statement import (
    Statement,
    c1,
    c2,
    epsilon,
    listed,
    lost,
    rows,
    s1,
    s2,
    same,
    short,
    verdict,
)

RATES = sp.symbols("w1 w2 w3", real=True)
WHERE_POSITIVE = "where s2 > 0: there sqrt|g| = s2"


def _transformation(frames: PaperFrames) -> Iterator[Statement]:
    """Equations (5) to (8): the body's velocities and the anholonomic forms."""
    frame, wide = frames.rotations, frames.motions
    coframe = frame.coframe
    w1, w2, w3 = RATES
    printed = (s1 * w2 - c1 * s2 * w3, c1 * w2 + s1 * s2 * w3, w1 + c2 * w3)
    omega = {(i, mu): sp.diff(printed[i], RATES[mu]) for i in range(3) for mu in range(3)}
    yield Statement(
        "(5)",
        "Omega^i = e^i_mu w^mu: s1 w2 - c1 s2 w3, c1 w2 + s1 s2 w3, w1 + c2 w3",
        verdict(same(coframe, omega)),
        f"e = (R^T R')^vee = {rows(coframe)}",
        "w^mu are the rates of the Euler angles, not the space-fixed angular velocity",
    )
    turn = frames.motion_forms[3:, 3:]
    closed = all(
        wide.anholonomy[3 + i, j, 3 + k] == 0 for i in range(3) for j in range(3) for k in range(3)
    )
    structure = {}
    for (i, j, k), value in epsilon(1).items():
        structure[i, j, k] = -value  # d(dPhi^k) = -(1/2) eps_kij dPhi^i ^ dPhi^j
        structure[k, 3 + j, 3 + i] = value  # d(dX^i) = eps_ijk dPhi^k ^ dX^j
        structure[3 + j, k, 3 + i] = -value
    # eps is a rotation: nine products, 1 on the diagonal.
    rotation = frame.read([("V", x) for x in turn * turn.T])
    orthogonal = all(x == int(k % 4 == 0) for k, x in enumerate(rotation))
    yield Statement(
        "(6)",
        "V^i = eps^i_mu v^mu with d_[nu eps^i_mu] != 0",
        verdict(orthogonal and not closed and same(wide.anholonomy, structure)),
        "eps = R^T, eps eps^T = 1; d(dX^i) = eps_ijk dPhi^k ^ dX^j, as in the algebra of motions",
    )
    yield Statement(
        "(7)",
        "dPhi^i = e^i_mu dphi^mu is not integrable: d_mu e^i_nu - d_nu e^i_mu != 0",
        verdict(frame.anholonomy.is_zero is False),
        f"in the frame C_ij^k: {listed('C', frame.anholonomy)}",
    )
    matrix = {(0, 1): s1, (0, 2): -c1 * s2, (1, 1): c1, (1, 2): s1 * s2, (2, 0): 1, (2, 2): c2}
    yield Statement(
        "(8)",
        "e = [[0, s1, -c1 s2], [0, c1, s1 s2], [1, 0, c2]]",
        verdict(same(coframe, matrix)),
        f"e = {rows(coframe)}, det e = {short(frame.determinant[()])}",
    )


def _metric(frame: Frame) -> Iterator[Statement]:
    """Equation (9) and the statements about it."""
    inverse, size = frame.inverse_metric, frame.volume * frame.volume[()]
    unit = {(0, 0): 1, (1, 1): 1, (2, 2): 1, (0, 2): c2, (2, 0): c2}
    yield Statement(
        "(9) left",
        "g = [[1, 0, c2], [0, 1, 0], [c2, 0, 1]]",
        verdict(same(frame.metric, unit)),
        f"g = {rows(frame.metric)}",
    )
    printed = {(0, 0): 1, (1, 1): s2**2, (2, 2): 1, (0, 2): -c2, (2, 0): -c2}
    # The print is g^-1 times |g|: dividing by |g| has to give the inverse.
    repaired = {index: value / s2**2 for index, value in printed.items()}
    lost = "the factor 1/|g| = 1/s2**2 is lost"
    if not same(inverse, repaired):
        lost = "not even proportional to the inverse of g"
    yield Statement(
        "(9) right",
        "g^-1 = [[1, 0, -c2], [0, s2**2, 0], [-c2, 0, 1]]",
        verdict(same(inverse, printed), lost),
        f"g^-1 = {rows(inverse)}",
    )
    yield Statement(
        "after (9)",
        "|g| = det g = s2**2",
        verdict(same(size, {(): s2**2})),
        f"|g| = {short(size[()])}",
    )
    yield Statement(
        "after (9)",
        "'g^-1 = |g|^-1 is the determinant of g'",
        verdict(same(size, {(): 1 / s2**2}), "a garbled sentence"),
        f"|g| = {short(size[()])} is the determinant of g; |g|^-1 is the factor lost in g^-1",
    )


def _riemann(frame: Frame) -> Iterator[Statement]:
    """Below (9): Christoffel symbols, Ricci and scalar curvature."""
    bar = levi_civita(frame)
    root = frame.volume[()]
    minus, plus = [(0, 1, 2), (1, 0, 2), (1, 2, 0), (2, 1, 0)], [(0, 2, 1), (2, 0, 1)]
    printed = dict.fromkeys(minus, -root / 2) | dict.fromkeys(plus, root / 2)
    gamma = bar.coefficients.lowered(2)
    yield Statement(
        "below (9)",
        "Gamma_bar_mnl = -sqrt|g|/2 on 123, 213, 231, 321; +sqrt|g|/2 on 132, 312",
        verdict(same(gamma, printed)),
        listed("Gamma_bar", gamma),
        WHERE_POSITIVE,
    )
    ricci, scalar = bar.curvature.ricci, bar.curvature.scalar
    yield Statement(
        "below (9)",
        "Ricci_bar = g/2",
        verdict(ricci == frame.metric / 2),
        f"Ricci_bar = {rows(ricci)}",
        "positive for spheres: R_nl = R_mnl^m",
    )
    yield Statement(
        "below (9)",
        "R_bar = 3/2",
        verdict(same(scalar, {(): sp.Rational(3, 2)})),
        f"R_bar = {short(scalar[()])}",
        "the sphere S^3 of radius 2",
    )


def _torsion(frame: Frame) -> Iterator[Statement]:
    """Equations (10) to (12), flatness and the force."""
    connection = cartan(frame)
    torsion, gamma = connection.torsion, connection.coefficients
    printed = {(0, 1, 0): c2 / s2, (1, 2, 2): c2 / s2, (0, 2, 1): s2}
    printed |= {(0, 1, 2): -1 / s2, (1, 2, 0): -1 / s2}
    yield Statement(
        "(10)",
        "Gamma_12^1 = Gamma_23^3 = c2/s2, Gamma_12^3 = Gamma_23^1 = -1/s2, Gamma_13^2 = s2 only",
        verdict(same(gamma, printed)),
        listed("Gamma", gamma),
    )
    flat = connection.curvature.riemann
    yield Statement(
        "before (10)",
        "the Cartan curvature vanishes: affine-flat",
        verdict(flat.is_zero is True),
        listed("R", flat),
    )
    lower = torsion.S.lowered(2)
    yield Statement(
        "below (10)",
        "S_abc = -(1/2) sqrt|g| eps_abc",
        verdict(same(lower, epsilon(-frame.volume[()] / 2))),
        listed("S", lower),
        WHERE_POSITIVE,
    )
    framed = torsion.T.in_frame().lowered(2)
    holds = framed == frame.anholonomy.lowered(2)
    yield Statement(
        "(11)",
        "2 S_ijk = 2 e_i^a e_j^b e_k^m S_abc is the object of anholonomy",
        verdict(
            any(same(framed, one) for one in _unsummed(frame)),
            lost("the sum over the last index of S", holds),
        ),
        f"2 e_i^a e_j^b e_k^c S_abc = C_ijk: {listed('C', frame.anholonomy.lowered(2))}",
        "the leg has the index m, S has c",
    )
    yield Statement(
        "(12)",
        "2 S_ijk = -eps_ijk",
        verdict(same(framed, epsilon(-1))),
        listed("2 S", framed),
        "for both signs of s2",
    )
    force = torsion.force(RATES)
    yield Statement(
        "section 1",
        "autoparallels and geodesics differ by the torsion force 2 S_a^c_b w^a w^b",
        verdict(force.is_zero is True),
        listed("force", force),
        "it vanishes here, S being totally antisymmetric: the curves are the same",
    )


def _unsummed(frame: Frame) -> list[dict[tuple[int, ...], sp.Expr]]:
    """2 e_i^a e_j^b S_abc times the sum of e_k^m over m, for each c that nothing sums over."""
    n, legs = range(3), frame.legs
    partly = cartan(frame).torsion.T.lowered(2)
    return [
        {
            (i, j, k): sp.Add(
                *(legs[a, i] * legs[b, j] * legs[m, k] * partly[a, b, c]
                  for a in n for b in n for m in n)
            )
            for i in n for j in n for k in n
        }
        for c in n
    ]  # fmt: skip


def statements(frames: PaperFrames) -> Iterator[Statement]:
    """The statements of section 2, equations (5) to (12), in their order."""
    yield from _transformation(frames)
    yield from _metric(frames.rotations)
    yield from _riemann(frames.rotations)
    yield from _torsion(frames.rotations)

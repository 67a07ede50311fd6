"""claims_translation: section 4 with (2) and (4), equations (20) to (27), recomputed."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from geomtorsion.cli import claims_frames
from geomtorsion.cli.claims_motion import (
    FLIGHT_ENERGY,
    FORCE,
    MASS,
    MOMENTS,
    ROTATION_ENERGY,
    SPEED,
    TORQUE,
    TURN,
    Mechanics,
    Strip,
    angular_momentum,
    cross,
    equal,
    momentum,
    written,
)
from geomtorsion.cli.claims_rotation import by_parts, euler, lost
from geomtorsion.cli.printed import Claim, verdict


def mechanics() -> Mechanics:
    """The body that turns and flies."""
    return Mechanics(claims_frames.motions(), ROTATION_ENERGY + FLIGHT_ENERGY, (*TORQUE, *FORCE))


def newton() -> tuple[list[sp.Expr], list[sp.Expr]]:
    """P' and Omega x P."""
    change = [MASS * dot for dot in sp.symbols("u4dot u5dot u6dot")]
    return change, cross(TURN, momentum())


def second() -> Iterator[Claim]:
    """Equation (2)."""
    change, gyroscopic = newton()
    printed = [a + b - f for a, b, f in zip(change, gyroscopic, FORCE, strict=True)]
    found = mechanics()
    yield Claim(
        "(2)",
        "P' + Omega x P = F with P = M V",
        verdict(equal(found.residuals()[3:], printed) and found.right.agrees is True),
        f"0 = {written(found.right.residuals[3:])}",
        "without force V' = -Omega x V: straight lines in space, geodesics and no autoparallels",
    )


def fourth() -> Iterator[Claim]:
    """Equation (4)."""
    found = mechanics().change_in_space(momentum())
    yield Claim(
        "(4)",
        "p' = f for the momentum in space",
        verdict(equal(found, FORCE)),
        f"R^T d/dt (R P) = {written(found)} along the motions of (2)",
    )


def geometry() -> Iterator[Claim]:
    """Equations (20) to (22)."""
    from geomtorsion.geometry import cartan, levi_civita

    found = mechanics()
    frame, n = found.frame, range(3)
    forms = frame.coframe.to_sympy().tomatrix()
    turn = claims_frames.attitude().T
    twisted = any(frame.anholonomy[i, j, 3 + k] != 0 for i in range(6) for j in range(6) for k in n)
    yield Claim(
        "(20)",
        "dX^i = eps^i_mu dx^mu, not integrable",
        verdict(forms[3:, 3:] == turn and forms[3:, :3].is_zero_matrix and twisted),
        "dX = R^T dx, d(dX^i) = eps_ijk dPhi^k ^ dX^j",
    )
    turning = claims_frames.rotations()
    blocks = sp.diag(turning.coframe.to_sympy().tomatrix(), turn)
    metric = sp.diag(turning.metric.to_sympy().tomatrix(), sp.eye(3))
    yield Claim(
        "(21)",
        "E = diag(e, eps), G = E^T E = diag(g, 1)",
        verdict(forms == blocks and frame.metric.to_sympy().tomatrix() == metric),
        "so it is with the coordinates in the order (phi, x) and the forms (dPhi, dX)",
    )
    other = sp.Matrix(6, 6, lambda i, mu: forms[(i + 3) % 6, (mu + 3) % 6])
    yield Claim(
        "around (21)",
        "{x^mu, phi^mu} = {q^M}, {X^i, Phi^i} = {Q^I} with E = diag(e, eps)",
        verdict(other == blocks, "in this order E is diag(eps, e)"),
        "q = (phi, x), Q = (Phi, X); the library keeps this order",
    )
    connection = cartan(frame)
    bent = levi_civita(frame).curvature.riemann
    yield Claim(
        "below (21)",
        "torsion S != 0, Cartan curvature 0, Riemann curvature != 0",
        verdict(
            connection.torsion.S.is_zero is False
            and connection.curvature.riemann.is_zero is True
            and bent.is_zero is False
        ),
        f"2 S has {len(frame.anholonomy.nonzero())} components in the frame, R_bar "
        f"{len(bent.in_frame().nonzero())}",
    )
    spin = turning.coframe.to_sympy().tomatrix()
    kinetic = sp.diag(spin.T * sp.diag(*MOMENTS) * spin, MASS * sp.eye(3))
    yield Claim(
        "(22)",
        "L_B = M/2 X'^i X'^i + I_i/2 Phi'^i Phi'^i",
        verdict(found.transformed(kinetic)),
        "L = M/2 x'^mu x'^mu + I_i/2 e^i_mu e^i_nu phi'^mu phi'^nu, with V = R^T x'",
    )
    naive, free = found.varied("naive"), found.varied("closed_in_coordinates")
    change, _ = newton()
    yield Claim(
        "below (22)",
        "varied naively it gives M X''^i = 0, which is wrong",
        verdict(equal(naive.residuals[3:], change) and not equal(naive.residuals, free.residuals)),
        f"naive: 0 = {written(naive.residuals[3:])}",
    )


def variations() -> Iterator[Claim]:
    """Equations (23), (24) and the relation under it."""
    bar = mechanics().variation
    turned, moved, rates = bar.images[:3], bar.images[3:], bar.image_rates[3:]
    mine, other = cross(TURN, moved), cross(turned, SPEED)
    printed = [d + b - a for d, a, b in zip(rates, mine, other, strict=True)]
    right = [d + a - b for d, a, b in zip(rates, mine, other, strict=True)]
    wrong = "the second term has the wrong sign"
    if not equal(bar.changes[3:], right):
        wrong = "wrong in more than a sign"
    yield Claim(
        "(23)",
        "delta-bar X'^i = d/dt dX^i + eps^i_jk (dPhi^j X'^k - Phi'^j dX^k)",
        verdict(equal(bar.changes[3:], printed) and bar.proved is True, wrong),
        "delta-bar X'^i = d/dt dX^i + eps^i_jk (Phi'^j dX^k - dPhi^j X'^k)",
        "; ".join(bar.text.splitlines()[3:]),
    )
    strip = Strip(claims_frames.motions())
    yield Claim(
        "(24)",
        "delta (eps^i_mu x'^mu) = d/dt (eps^i_mu dx^mu) + d_la eps^i_mu (x'^mu dphi^la - "
        "phi'^la dx^mu)",
        verdict(all(strip.holds(3 + i, range(3), range(3, 6)) for i in range(3))),
        "differentiated along phi(s, t), x(s, t): delta is d/ds",
    )
    frame, turn = claims_frames.rotations(), claims_frames.attitude().T
    forms, n = frame.coframe.to_sympy().tomatrix(), range(3)
    signs = set()
    for angle, symbol in enumerate(frame.coordinates):
        spin = turn.diff(symbol) * turn.T
        for i in n:
            for j in n:
                value = sp.Add(*(sp.LeviCivita(i, j, k) * forms[k, angle] for k in n))
                pair = frame.read([("left", spin[i, j]), ("right", value)])
                signs |= {s for s in (1, -1) if pair[0] != pair[1] * s}
    yield Claim(
        "under (24)",
        "(d eps eps^T)_ij = -eps_ijk dPhi^k",
        verdict(-1 not in signs, "the sign" if 1 not in signs else "more than a sign"),
        "(d eps eps^T)_ij = +eps_ijk dPhi^k",
        "with (8) and (9); it is what turns the sign of (23)",
    )


def action() -> Iterator[Claim]:
    """Equations (25) to (27)."""
    bar = mechanics().variation
    images, rates, n = bar.images, bar.image_rates, range(3)
    change, gyroscopic = newton()
    rest = by_parts(momentum(), bar.changes[3:], images, rates[3:])
    integrand = [r - c for r, c in zip(rest[3:], change, strict=True)]
    printed = [-(c + g) for c, g in zip(change, gyroscopic, strict=True)]
    yield Claim(
        "(25)",
        "delta-bar T_trans = d/dt (M X'^i dX^i) - M (X''^i + eps^i_jk Phi'^j X'^k) dX^i",
        verdict(equal(integrand, printed) and equal(rest[:3], [0, 0, 0])),
        "the same; dPhi drops out of X'^i eps_ijk dPhi^j X'^k",
        "only the corrected sign of (23) gives it",
    )
    momenta = [*angular_momentum(), *momentum()]
    turning = euler()
    whole = by_parts(momenta, bar.changes, images, rates)
    dots = [*turning[0], *change]
    total = [w - d for w, d in zip(whole, dots, strict=True)]
    expected = [-(c + g) for c, g in zip(*turning, strict=True)] + printed
    holds = equal(total, expected)
    # Without its index the second Phi' could only be one and the same component for all i.
    body = sp.Add(*(p * c for p, c in zip(momenta[:3], bar.changes, strict=False)))
    readings = [sp.Add(*momenta[:3]) * bar.changes[k] for k in n]
    yield Claim(
        "(26)",
        "delta-bar A_B = int (I_i Phi'^i delta-bar Phi' + M X'^i delta-bar X'^i)",
        verdict(
            any(sp.expand(body - one) == 0 for one in readings),
            lost("the index i of the second Phi'", holds),
        ),
        "delta-bar A_B = int (I_i Phi'^i delta-bar Phi'^i + M X'^i delta-bar X'^i)",
        "with the index it is p_i delta-bar u^i, and (27) follows",
    )
    undotted = [-(p + g) for p, g in zip(angular_momentum(), turning[1], strict=True)]
    yield Claim(
        "(27)",
        "= - int [dPhi^i (L + Omega x L)^i + dX^i (P' + Omega x P)^i]",
        verdict(holds and equal(total[:3], undotted), lost("the dot of the first L", holds)),
        "= - int [dPhi^i (L' + Omega x L)^i + dX^i (P' + Omega x P)^i]",
        f"so that 0 = {written([-sp.expand(total[3 + i]) for i in n])} for dX",
    )

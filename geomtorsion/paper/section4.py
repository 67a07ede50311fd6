"""section 4: equations (20) to (27), the action principle for a body that turns and flies."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from geomtorsion.geometry import cartan, levi_civita
from geomtorsion.paper.frames import PaperFrames, attitude
from geomtorsion.paper.mechanics import (
    ANGULAR_MOMENTUM,
    MASS,
    MOMENTS,
    MOMENTUM,
    OMEGA,
    VELOCITY,
    Mechanics,
    Strip,
    by_parts,
    cross,
    dot,
    equal,
    euler,
    flying_body,
    minus,
    newton,
    total,
    written,
)
from geomtorsion.paper.statement import Statement, lost, verdict


def statements(frames: PaperFrames) -> Iterator[Statement]:
    """The statements of section 4, equations (20) to (27), in their order."""
    body = flying_body(frames)
    yield from _geometry(frames)
    yield from _energy(frames, body)
    yield from _variations(frames, body)
    yield from _principle(body)


def _geometry(frames: PaperFrames) -> Iterator[Statement]:
    """Equations (20) and (21)."""
    frame, n = frames.motions, range(3)
    forms, turn = frames.motion_forms, attitude().T
    twisted = any(frame.anholonomy[i, j, 3 + k] != 0 for i in range(6) for j in range(6) for k in n)
    yield Statement(
        "(20)",
        "dX^i = eps^i_mu dx^mu, not integrable",
        verdict(forms[3:, 3:] == turn and forms[3:, :3].is_zero_matrix and twisted),
        "dX = R^T dx, d(dX^i) = eps_ijk dPhi^k ^ dX^j",
    )
    blocks = sp.diag(frames.spin_forms, turn)
    metric = sp.diag(frames.rotations.metric.to_sympy().tomatrix(), sp.eye(3))
    yield Statement(
        "(21)",
        "E = diag(e, eps), G = E^T E = diag(g, 1)",
        verdict(forms == blocks and frame.metric.to_sympy().tomatrix() == metric),
        "so it is with the coordinates in the order (phi, x) and the forms (dPhi, dX)",
    )
    # E in the order in which the paper names its coordinates: positions first.
    other = sp.Matrix(6, 6, lambda i, mu: forms[(i + 3) % 6, (mu + 3) % 6])
    yield Statement(
        "around (21)",
        "{x^mu, phi^mu} = {q^M}, {X^i, Phi^i} = {Q^I} with E = diag(e, eps)",
        verdict(other == blocks, "in this order E is diag(eps, e)"),
        "q = (phi, x), Q = (Phi, X); the library keeps this order",
    )
    connection = cartan(frame)
    bent = levi_civita(frame).curvature.riemann
    yield Statement(
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


def _energy(frames: PaperFrames, body: Mechanics) -> Iterator[Statement]:
    """Equation (22)."""
    spin = frames.spin_forms
    kinetic = sp.diag(spin.T * sp.diag(*MOMENTS) * spin, MASS * sp.eye(3))
    yield Statement(
        "(22)",
        "L_B = M/2 X'^i X'^i + I_i/2 Phi'^i Phi'^i",
        verdict(body.transformed(kinetic)),
        "L = M/2 x'^mu x'^mu + I_i/2 e^i_mu e^i_nu phi'^mu phi'^nu, with V = R^T x'",
    )
    naive, free = body.varied("naive"), body.varied("closed_in_coordinates")
    change, _ = newton()
    yield Statement(
        "below (22)",
        "varied naively it gives M X''^i = 0, which is wrong",
        verdict(equal(naive.residuals[3:], change) and not equal(naive.residuals, free.residuals)),
        f"naive: 0 = {written(naive.residuals[3:])}",
    )


def _variations(frames: PaperFrames, body: Mechanics) -> Iterator[Statement]:
    """Equations (23), (24) and the relation under it."""
    bar = body.variation
    rates, n = bar.image_rates[3:], range(3)
    mine, other = cross(OMEGA, bar.images[3:]), cross(bar.images[:3], VELOCITY)
    printed = total(rates, other, minus(mine))
    right = total(rates, mine, minus(other))
    # The print swaps the two terms; anything else would be a worse mistake.
    wrong = "the second term has the wrong sign"
    if not equal(bar.changes[3:], right):
        wrong = "wrong in more than a sign"
    yield Statement(
        "(23)",
        "delta-bar X'^i = d/dt dX^i + eps^i_jk (dPhi^j X'^k - Phi'^j dX^k)",
        verdict(equal(bar.changes[3:], printed) and bar.proved is True, wrong),
        "delta-bar X'^i = d/dt dX^i + eps^i_jk (Phi'^j dX^k - dPhi^j X'^k)",
        "; ".join(bar.text.splitlines()[3:]),
    )
    strip = Strip(frames.motions)
    yield Statement(
        "(24)",
        "delta (eps^i_mu x'^mu) = d/dt (eps^i_mu dx^mu) + d_la eps^i_mu (x'^mu dphi^la - "
        "phi'^la dx^mu)",
        verdict(all(strip.holds(3 + i, range(3), range(3, 6)) for i in n)),
        "differentiated along phi(s, t), x(s, t): delta is d/ds",
    )
    signs = _signs(frames)
    yield Statement(
        "under (24)",
        "(d eps eps^T)_ij = -eps_ijk dPhi^k",
        verdict(-1 not in signs, "the sign" if 1 not in signs else "more than a sign"),
        "(d eps eps^T)_ij = +eps_ijk dPhi^k",
        "with (8) and (9); it is what turns the sign of (23)",
    )


def _signs(frames: PaperFrames) -> set[int]:
    """Signs s for which (d eps eps^T)_ij = s eps_ijk dPhi^k fails in some component."""
    frame, turn, n = frames.rotations, attitude().T, range(3)
    failing: set[int] = set()
    for mu, angle in enumerate(frame.coordinates):
        spin = turn.diff(angle) * turn.T
        for i in n:
            for j in n:
                value = dot([sp.LeviCivita(i, j, k) for k in n], list(frames.spin_forms[:, mu]))
                left, right = frame.read([("left", spin[i, j]), ("right", value)])
                failing |= {sign for sign in (1, -1) if left != right * sign}
    return failing


def _principle(body: Mechanics) -> Iterator[Statement]:
    """Equations (25) to (27)."""
    bar = body.variation
    change, gyroscopic = newton()
    rest = by_parts(MOMENTUM, bar.changes[3:], bar.images, bar.image_rates[3:])
    integrand = total(rest[3:], minus(change))
    printed = minus(total(change, gyroscopic))
    yield Statement(
        "(25)",
        "delta-bar T_trans = d/dt (M X'^i dX^i) - M (X''^i + eps^i_jk Phi'^j X'^k) dX^i",
        verdict(equal(integrand, printed) and equal(rest[:3], [0, 0, 0])),
        "the same; dPhi drops out of X'^i eps_ijk dPhi^j X'^k",
        "only the corrected sign of (23) gives it",
    )
    momenta = [*ANGULAR_MOMENTUM, *MOMENTUM]
    turning = euler()
    whole = by_parts(momenta, bar.changes, bar.images, bar.image_rates)
    varied = total(whole, minus([*turning[0], *change]))
    holds = equal(varied, minus(total(*turning)) + printed)
    # Without its index the second Phi' could only be one and the same component for all i.
    right = dot(momenta[:3], bar.changes[:3])
    readings = [sp.Add(*momenta[:3]) * bar.changes[k] for k in range(3)]
    yield Statement(
        "(26)",
        "delta-bar A_B = int (I_i Phi'^i delta-bar Phi' + M X'^i delta-bar X'^i)",
        verdict(
            any(sp.expand(right - one) == 0 for one in readings),
            lost("the index i of the second Phi'", holds),
        ),
        "delta-bar A_B = int (I_i Phi'^i delta-bar Phi'^i + M X'^i delta-bar X'^i)",
        "with the index it is p_i delta-bar u^i, and (27) follows",
    )
    undotted = minus(total(ANGULAR_MOMENTUM, turning[1]))
    yield Statement(
        "(27)",
        "= - int [dPhi^i (L + Omega x L)^i + dX^i (P' + Omega x P)^i]",
        verdict(holds and equal(varied[:3], undotted), lost("the dot of the first L", holds)),
        "= - int [dPhi^i (L' + Omega x L)^i + dX^i (P' + Omega x P)^i]",
        f"so that 0 = {written([-sp.expand(value) for value in varied[3:]])} for dX",
    )

"""claims_rotation: sections 1 and 3, equations (1), (3) and (13) to (19), recomputed."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from geomtorsion.cli import claims_frames
from geomtorsion.cli.claims_motion import (
    MOMENTS,
    ROTATION_ENERGY,
    TORQUE,
    TURN,
    Mechanics,
    Row,
    Strip,
    angular_momentum,
    cross,
    equal,
    written,
)
from geomtorsion.cli.printed import Claim, verdict


def mechanics() -> Mechanics:
    """The turning body."""
    return Mechanics(claims_frames.rotations(), ROTATION_ENERGY, TORQUE)


def euler() -> tuple[list[sp.Expr], list[sp.Expr]]:
    """L' and Omega x L."""
    dots = sp.symbols("u1dot u2dot u3dot")
    change = [moment * dot for moment, dot in zip(MOMENTS, dots, strict=True)]
    return change, cross(TURN, angular_momentum())


def first() -> Iterator[Claim]:
    """Equation (1)."""
    change, gyroscopic = euler()
    printed = [a + b - m for a, b, m in zip(change, gyroscopic, TORQUE, strict=True)]
    found = mechanics()
    yield Claim(
        "(1)",
        "L' + Omega x L = M with L_i = I_i Omega^i",
        verdict(equal(found.residuals(), printed) and found.right.agrees is True),
        f"from variations closed in the angles: 0 = {written(found.right.residuals)}",
        "proved equal to the Euler-Lagrange equations in the angles; u^i = Omega^i",
    )


def third() -> Iterator[Claim]:
    """Equation (3)."""
    found = mechanics().change_in_space(angular_momentum())
    yield Claim(
        "(3)",
        "l' = m for the angular momentum in space",
        verdict(equal(found, TORQUE)),
        f"R^T d/dt (R L) = {written(found)} along the motions of (1)",
    )


def between() -> Iterator[Claim]:
    """Section 1: straight lines of the image are autoparallels, not geodesics."""
    found = mechanics()
    straight = found.varied("closed_in_image")
    curved = found.varied("closed_in_coordinates")
    yield Claim(
        "section 1",
        "straight lines in the image go over into autoparallels, Hamilton's principle in M_q "
        "gives geodesics; they lack the torsion force",
        verdict(
            straight.accelerations == (0, 0, 0)
            and straight.agrees is True
            and equal(
                [one - two for one, two in zip(straight.residuals, curved.residuals, strict=True)],
                curved.torsion_force,
            )
        ),
        f"closed_in_image: Omega' = 0; the force that differs is {written(curved.torsion_force)}",
        "for equal moments it vanishes; for unequal ones bodies move on geodesics of g_kin",
    )


def action() -> Iterator[Claim]:
    """Equations (13) and (14)."""
    found = mechanics()
    forms = found.frame.coframe.to_sympy().tomatrix()
    kinetic = forms.T * sp.diag(*MOMENTS) * forms
    yield Claim(
        "(13)",
        "A_B = int dt I_i Phi'^i Phi'^i / 2, from g_kin = I_i e^i e^i",
        verdict(found.transformed(kinetic)),
        "I_i e^i_mu e^i_nu phi'^mu phi'^nu = I_i Omega^i Omega^i",
    )
    from geomtorsion.action import variation

    naive, free = found.varied("naive"), found.varied("closed_in_coordinates")
    change, _ = euler()
    yield Claim(
        "below (13)",
        "varied naively it gives I_i Phi''^i = 0, which is not (1)",
        verdict(
            equal(naive.residuals, change)
            and not equal(naive.residuals, free.residuals)
            and variation(found.frame, "naive").proved is False
        ),
        f"naive: 0 = {written(naive.residuals)}",
        "the naive variation is that of no path: it differs from (15)",
    )
    vector = burgers()
    yield Claim(
        "(14)",
        "Phi_2 = Phi_1 + int e phi' dt takes closed paths to open ones: b = closed int e dphi != 0",
        verdict(any(value != 0 for value in vector)),
        f"phi1 from 0 to 1, phi2 from 1 to 2 and back: b = {written(vector)}",
    )


def burgers() -> tuple[sp.Expr, ...]:
    """b^i of the rectangle 0 < phi1 < 1, 1 < phi2 < 2."""
    from geomtorsion.loops import Loop, exact_burgers_vector

    corners = [[0, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]]
    return tuple(exact_burgers_vector(claims_frames.rotations(), Loop.polygon(corners)).vector)


def variations() -> Iterator[Claim]:
    """Equations (15) to (17)."""
    bar = mechanics().variation
    images, rates = bar.images, bar.image_rates
    right = [d + c for d, c in zip(rates, cross(TURN, images), strict=True)]
    yield Claim(
        "(15)",
        "delta-bar Phi'^i = d/dt dPhi^i + eps^i_jk Phi'^j dPhi^k",
        verdict(equal(bar.changes, right) and bar.proved is True),
        "; ".join(bar.text.splitlines()),
    )
    strip, n = Strip(claims_frames.rotations()), range(3)
    yield Claim(
        "(16)",
        "delta (e^i_mu phi'^mu) = d/dt (e^i_mu dphi^mu) + (d_mu e^i_nu - d_nu e^i_mu) "
        "phi'^nu dphi^mu",
        verdict(all(strip.holds(i, n, n) for i in n)),
        "differentiated along phi(s, t): delta is d/ds",
    )
    from geomtorsion.geometry import cartan

    torsion = cartan(bar.frame).torsion.T.in_frame()
    doubled = [
        rates[i]
        + sp.Add(*(torsion[k, j, i] * TURN[j] * images[k] for k in n for j in n))
        for i in n
    ]  # fmt: skip
    holds = equal(bar.changes, doubled)
    yield Claim(
        "(17)",
        "delta-bar Phi^i = d/dt dPhi^i + 2 S_kj^i Phi'^j dPhi^k",
        verdict(holds and equal(images, doubled), lost("the dot of Phi on the left", holds)),
        "delta-bar Phi'^i = d/dt dPhi^i + 2 S_kj^i Phi'^j dPhi^k",
        "a velocity stands on the right",
    )


def lost(what: str, holds: bool) -> str:
    """What is wrong in print, where the corrected formula was found to hold."""
    return f"{what} is lost" if holds else "wrong in more than its notation"


def by_parts(momenta: Row, changes: Row, images: Row, rates: Row) -> list[sp.Expr]:
    """Coefficients of dPhi^k in p_i delta-bar u^i - d/dt (p_i dPhi^i), p' written u'dot."""
    total = sp.expand(
        sp.Add(*(p * (c - r) for p, c, r in zip(momenta, changes, rates, strict=True)))
    )
    return [total.coeff(image) for image in images]


def principle() -> Iterator[Claim]:
    """Equations (18) and (19)."""
    found, bar = mechanics(), mechanics().variation
    change, gyroscopic = euler()
    rest = by_parts(angular_momentum(), bar.changes, bar.images, bar.image_rates)
    # The boundary term takes d/dt dPhi with it and leaves - L' dPhi.
    integrand = [r - c for r, c in zip(rest, change, strict=True)]
    printed = [-(c + g) for c, g in zip(change, gyroscopic, strict=True)]
    holds = equal(integrand, printed)
    middle = sp.Add(*(p * d for p, d in zip(angular_momentum(), bar.images, strict=True)))
    varied = sp.Add(*(p * c for p, c in zip(angular_momentum(), bar.changes, strict=True)))
    yield Claim(
        "(18)",
        "delta-bar A_B = int I_i Phi'^i delta-bar Phi^i = - int dPhi^i (L' + Omega x L)^i",
        verdict(
            holds and sp.expand(middle - varied) == 0, lost("the dot of the second Phi", holds)
        ),
        "delta-bar A_B = int I_i Phi'^i delta-bar Phi'^i = - int dPhi^i (L' + Omega x L)^i",
        "its right side holds",
    )
    free = found.varied("closed_in_coordinates")
    yield Claim(
        "(19)",
        "delta-bar A_B = 0 gives the right equations in the body",
        verdict(holds and equal([-value for value in integrand], free.residuals)),
        f"0 = {written(free.residuals)}",
    )

"""section 3: equations (13) to (19), the action principle for a body that turns."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from geomtorsion.action import variation
from geomtorsion.geometry import cartan
from geomtorsion.loops import Loop, exact_burgers_vector
from geomtorsion.paper.frames import PaperFrames
from geomtorsion.paper.mechanics import (
    ANGULAR_MOMENTUM,
    MOMENTS,
    OMEGA,
    Mechanics,
    Strip,
    by_parts,
    cross,
    dot,
    equal,
    euler,
    minus,
    total,
    turning_body,
    written,
)
from geomtorsion.paper.statement import Statement, lost, verdict


def statements(frames: PaperFrames) -> Iterator[Statement]:
    """The statements of section 3, equations (13) to (19), in their order."""
    body = turning_body(frames)
    yield from _action(frames, body)
    yield from _variations(frames, body)
    yield from _principle(body)


def _action(frames: PaperFrames, body: Mechanics) -> Iterator[Statement]:
    """Equations (13) and (14)."""
    forms = frames.spin_forms
    yield Statement(
        "(13)",
        "A_B = int dt I_i Phi'^i Phi'^i / 2, from g_kin = I_i e^i e^i",
        verdict(body.transformed(forms.T * sp.diag(*MOMENTS) * forms)),
        "I_i e^i_mu e^i_nu phi'^mu phi'^nu = I_i Omega^i Omega^i",
    )
    naive, free = body.varied("naive"), body.varied("closed_in_coordinates")
    change, _ = euler()
    yield Statement(
        "below (13)",
        "varied naively it gives I_i Phi''^i = 0, which is not (1)",
        verdict(
            equal(naive.residuals, change)
            and not equal(naive.residuals, free.residuals)
            and variation(body.frame, "naive").proved is False
        ),
        f"naive: 0 = {written(naive.residuals)}",
        "no path has the naive variation: it differs from (15)",
    )
    rectangle = Loop.polygon([[0, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]])
    vector = exact_burgers_vector(frames.rotations, rectangle).vector
    yield Statement(
        "(14)",
        "Phi_2 = Phi_1 + int e phi' dt takes closed paths to open ones: b = closed int e dphi != 0",
        verdict(any(value != 0 for value in vector)),
        f"phi1 from 0 to 1, phi2 from 1 to 2 and back: b = {written(vector)}",
    )


def _variations(frames: PaperFrames, body: Mechanics) -> Iterator[Statement]:
    """Equations (15) to (17)."""
    bar, n = body.variation, range(3)
    right = total(bar.image_rates, cross(OMEGA, bar.images))
    yield Statement(
        "(15)",
        "delta-bar Phi'^i = d/dt dPhi^i + eps^i_jk Phi'^j dPhi^k",
        verdict(equal(bar.changes, right) and bar.proved is True),
        "; ".join(bar.text.splitlines()),
    )
    strip = Strip(frames.rotations)
    yield Statement(
        "(16)",
        "delta (e^i_mu phi'^mu) = d/dt (e^i_mu dphi^mu) + (d_mu e^i_nu - d_nu e^i_mu) "
        "phi'^nu dphi^mu",
        verdict(all(strip.holds(i, n, n) for i in n)),
        "differentiated along phi(s, t): delta is d/ds",
    )
    # 2 S is T, the torsion without the half.
    torsion = cartan(body.frame).torsion.T.in_frame()
    twist = [
        sp.Add(*(torsion[k, j, i] * OMEGA[j] * bar.images[k] for k in n for j in n)) for i in n
    ]
    doubled = total(bar.image_rates, twist)
    holds = equal(bar.changes, doubled)
    yield Statement(
        "(17)",
        "delta-bar Phi^i = d/dt dPhi^i + 2 S_kj^i Phi'^j dPhi^k",
        verdict(holds and equal(bar.images, doubled), lost("the dot of Phi on the left", holds)),
        "delta-bar Phi'^i = d/dt dPhi^i + 2 S_kj^i Phi'^j dPhi^k",
        "the right-hand side contains a velocity",
    )


def _principle(body: Mechanics) -> Iterator[Statement]:
    """Equations (18) and (19)."""
    bar = body.variation
    change, gyroscopic = euler()
    rest = by_parts(ANGULAR_MOMENTUM, bar.changes, bar.images, bar.image_rates)
    # The boundary term takes d/dt dPhi with it and leaves - L' dPhi.
    integrand = total(rest, minus(change))
    holds = equal(integrand, minus(total(change, gyroscopic)))
    middle, varied = dot(ANGULAR_MOMENTUM, bar.images), dot(ANGULAR_MOMENTUM, bar.changes)
    yield Statement(
        "(18)",
        "delta-bar A_B = int I_i Phi'^i delta-bar Phi^i = - int dPhi^i (L' + Omega x L)^i",
        verdict(
            holds and sp.expand(middle - varied) == 0, lost("the dot of the second Phi", holds)
        ),
        "delta-bar A_B = int I_i Phi'^i delta-bar Phi'^i = - int dPhi^i (L' + Omega x L)^i",
        "its right side holds",
    )
    free = body.varied("closed_in_coordinates")
    yield Statement(
        "(19)",
        "delta-bar A_B = 0 gives the right equations in the body",
        verdict(holds and equal(minus(integrand), free.residuals)),
        f"0 = {written(free.residuals)}",
    )

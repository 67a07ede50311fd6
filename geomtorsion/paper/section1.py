"""section 1: equations (1) to (4) in the body and in space, and the statements about them."""

from __future__ import annotations

from collections.abc import Iterator

from geomtorsion.paper.frames import PaperFrames
from geomtorsion.paper.mechanics import (
    ANGULAR_MOMENTUM,
    FORCE,
    MOMENTUM,
    TORQUE,
    equal,
    euler,
    flying_body,
    minus,
    newton,
    total,
    turning_body,
    written,
)
from geomtorsion.paper.statement import Statement, verdict


def statements(frames: PaperFrames) -> Iterator[Statement]:
    """Equations (1) to (4) and the sentence on straight lines of the image."""
    turning, flying = turning_body(frames), flying_body(frames)
    printed = total(*euler(), minus(TORQUE))
    yield Statement(
        "(1)",
        "L' + Omega x L = M with L_i = I_i Omega^i",
        verdict(equal(turning.residuals(), printed) and turning.right.agrees is True),
        f"from variations closed in the angles: 0 = {written(turning.right.residuals)}",
        "proved equal to the Euler-Lagrange equations in the angles; u^i = Omega^i",
    )
    printed = total(*newton(), minus(FORCE))
    yield Statement(
        "(2)",
        "P' + Omega x P = F with P = M V",
        verdict(equal(flying.residuals()[3:], printed) and flying.right.agrees is True),
        f"0 = {written(flying.right.residuals[3:])}",
        "without force V' = -Omega x V: straight lines in space, geodesics and no autoparallels",
    )
    change = turning.change_in_space(ANGULAR_MOMENTUM)
    yield Statement(
        "(3)",
        "l' = m for the angular momentum in space",
        verdict(equal(change, TORQUE)),
        f"R^T d/dt (R L) = {written(change)} along the motions of (1)",
    )
    change = flying.change_in_space(MOMENTUM)
    yield Statement(
        "(4)",
        "p' = f for the momentum in space",
        verdict(equal(change, FORCE)),
        f"R^T d/dt (R P) = {written(change)} along the motions of (2)",
    )
    straight = turning.varied("closed_in_image")
    curved = turning.varied("closed_in_coordinates")
    difference = total(straight.residuals, minus(curved.residuals))
    yield Statement(
        "section 1",
        "straight lines in the image go over into autoparallels, Hamilton's principle in M_q "
        "gives geodesics; they lack the torsion force",
        verdict(
            straight.accelerations == (0, 0, 0)
            and straight.agrees is True
            and equal(difference, curved.torsion_force)
        ),
        f"closed_in_image: Omega' = 0; the force that differs is {written(curved.torsion_force)}",
        "for equal moments it vanishes; for unequal ones bodies move on geodesics of g_kin",
    )

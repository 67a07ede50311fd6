"""guides: what the tabs of the page without a server say, and what they cannot do."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from geomtorsion.lab import views
from geomtorsion.lab.views import GUIDES, Guide

LIVE: Mapping[str, Guide] = {
    views.TETRAD: GUIDES[views.TETRAD],
    views.LOOPS: Guide(
        "A circle in two coordinates, and the Burgers vector b that is missing at the end of its "
        "image in the frame: in closed form, in the radius R and the parameters of the space.",
        "take screw_dislocation, where b does not depend on R; then heisenberg, where it is 2 S A; "
        "write 1/2 or 3*R in the place of R.",
    ),
    views.PATHS: Guide(
        "The equations of the straightest and of the shortest curves of a space, in the "
        "components u of the velocity along its frame. What they differ by is the torsion force.",
        "compare so3, where both are one, with flat_polar, where they part.",
    ),
    views.TOP: Guide(
        "What follows from a Lagrangian over a frame: equations of motion in the velocities u of "
        "the frame, and what they keep. Over so3 these are Euler's equations of a body that turns.",
        "choose the naive variations, and see the gyroscopic terms go; then write "
        "(I1*u1^2 + I1*u2^2 + I3*u3^2)/2 - k*cos(phi2), with k among the parameters: a heavy "
        "symmetric top.",
    ),
    views.EXERCISES: GUIDES[views.EXERCISES],
}
# Tab -> why it is empty.
UNAVAILABLE: Mapping[str, str] = {
    views.COSTS: "What accuracy costs is measured on motions and integrals in numbers, and numpy "
    "and scipy have no builds for browsers on PyPI or npm. Where geomtorsion is installed, "
    "geomtorsion lab has this tab.",
}
# Exercises whose solutions are motions or loops in numbers, and what the list says above them.
UNGRADED = frozenset("4.1 4.4 5.3 5.4 5.5 5.6 5.7 6.6 7.1 7.2 7.3 7.4".split())
NOT_HERE = "need numbers: not in this page"


def note() -> str:
    """What the page is, and what it cannot do, in a few sentences."""
    text = (
        "Everything here is computed in your browser; nothing that you type leaves it. What is "
        "exact works. Motions as curves and films, loops in numbers, maps of your own, and the "
        "exercises that need these do not: they take numpy and scipy, which have no builds for "
        "browsers on PyPI or npm. "
    )
    return f'<p class="note">{escape(text)}<code>geomtorsion lab</code> on a computer has all.</p>'

"""Principles: the three ways to vary an action over a frame, by name."""

from __future__ import annotations

from dataclasses import dataclass

from geomtorsion.errors import UnknownNameError
from geomtorsion.support.checks import known_name


@dataclass(frozen=True)
class Principle:
    """A way to vary: the variations with fixed ends, and which of curl and torsion enters.

    name: its name in requests.
    closes: the variations with fixed ends.
    leads_to: the curves that it gives for a kinetic energy.
    frame_curl: share of C_kj^i, the object of anholonomy of the frame.
    image_torsion: share of T_kj^i = 2 S_kj^i, the torsion of the connection of the image.
    """

    name: str
    closes: str
    leads_to: str
    frame_curl: int
    image_torsion: int


PRINCIPLES = (
    Principle(
        "closed_in_coordinates",
        "dq^mu vanish at the ends; the frame image of the varied path does not close "
        "(Hamilton, Poincare)",
        "geodesics of the kinetic metric",
        1,
        0,
    ),
    Principle(
        "closed_in_image",
        "dPhi^i vanish at the ends of the flat image; in the coordinates the varied path misses "
        "its end by a Burgers vector (Kleinert)",
        "autoparallels",
        1,
        -1,
    ),
    Principle(
        "naive",
        "dPhi^i vanish at the ends as if Phi^i were coordinates; no variation of the path does "
        "this where the frame is anholonomic",
        "constant momenta in the frame: wrong for a body",
        0,
        0,
    ),
)


def principle_named(name: str) -> Principle:
    """The principle of this name.

    Raises
    ------
    UnknownNameError
        No principle has this name; the message names the nearest and lists all.

    Examples
    --------
    >>> principle_named("naive").leads_to
    'constant momenta in the frame: wrong for a body'
    """
    by_name = {principle.name: principle for principle in PRINCIPLES}
    kind = "the name of a principle"
    return by_name[known_name(name, by_name, "principle", UnknownNameError, expected=kind)]

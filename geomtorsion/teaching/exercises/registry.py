"""registry: the list of chapters and exercises, and their lazy loading."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from importlib import import_module
from typing import TYPE_CHECKING

from geomtorsion.errors import UnknownNameError
from geomtorsion.support.checks import close_names, count, shown
from geomtorsion.teaching.exercises.draw import Draw
from geomtorsion.teaching.exercises.exercise import Exercise
from geomtorsion.teaching.exercises.limits import MOST

if TYPE_CHECKING:
    from geomtorsion.teaching.exercises.verdict import Verdict

# number, subject
CHAPTERS: tuple[tuple[str, str], ...] = (
    ("1", "Frames and anholonomy"),
    ("2", "Cartan connection and torsion"),
    ("3", "Curvature, Cartan and Riemann"),
    ("4", "Straightest and shortest"),
    ("5", "Loops that fail to close"),
    ("6", "The action principle and the top"),
    ("7", "What accuracy costs"),
)
# number, module of this package, title, level
EXERCISES: tuple[tuple[str, str, str, str], ...] = (
    ("1.1", "frames.legs", "The legs of a coframe", "warm-up"),
    ("1.2", "frames.metric", "The metric of a coframe", "exercise"),
    ("1.3", "frames.anholonomy", "Forms that are not closed", "exercise"),
    ("1.4", "frames.body_rates", "The angular velocity of a body", "exercise"),
    ("2.1", "torsion.one_coefficient", "One coefficient of the Cartan connection", "warm-up"),
    ("2.2", "torsion.cartan_connection", "A whole Cartan connection", "exercise"),
    ("2.3", "torsion.in_coordinates", "Torsion in coordinates", "exercise"),
    ("2.4", "torsion.in_the_frame", "Torsion in the frame", "exercise"),
    ("3.1", "curvature.flat_or_not", "Which connection is flat", "warm-up"),
    ("3.2", "curvature.christoffel", "A Christoffel symbol", "warm-up"),
    ("3.3", "curvature.surface", "The curvature of a surface", "exercise"),
    ("3.4", "curvature.group_ricci", "The curvature of a group", "exercise"),
    ("3.5", "curvature.disguise", "A sphere in disguise?", "exercise"),
    ("4.1", "straightest.spiral", "Where the straightest line leads", "warm-up"),
    ("4.2", "straightest.force", "The torsion force", "exercise"),
    ("4.3", "straightest.equations", "Equations of the autoparallels", "exercise"),
    ("4.4", "straightest.compass", "By compass and on the great circle", "exercise"),
    ("4.5", "straightest.constraint", "The torsion of a constraint", "exercise"),
    ("5.1", "closure.small_loop", "A small loop", "warm-up"),
    ("5.2", "closure.circle", "A circle in closed form", "exercise"),
    ("5.3", "closure.rotations", "A loop in the rotations", "exercise"),
    ("5.4", "closure.dislocation", "Around a dislocation", "exercise"),
    ("5.5", "closure.frank", "Parallel transport on the sphere", "exercise"),
    ("5.6", "closure.screw_atoms", "Around a screw, atom by atom", "exercise"),
    ("5.7", "closure.half_plane", "An edge and its half plane", "warm-up"),
    ("6.1", "principle.euler", "Euler's equations", "warm-up"),
    ("6.2", "principle.moment", "The torque of the weight", "exercise"),
    ("6.3", "principle.variation", "Variations in a frame", "exercise"),
    ("6.4", "principle.symmetric_top", "The free symmetric top", "exercise"),
    ("6.5", "principle.carried", "The velocity of a rotating body", "exercise"),
    ("6.6", "principle.helix_or_line", "Helix or straight line?", "project"),
    ("7.1", "cost.digits", "Digits that a tiny loop loses", "warm-up"),
    ("7.2", "cost.sums", "Two ways to add up a loop", "exercise"),
    ("7.3", "cost.growth", "How an error grows", "exercise"),
    ("7.4", "cost.states", "How many variables describe a motion", "warm-up"),
)


def names() -> tuple[str, ...]:
    """Numbers of all exercises, in order; loads none of them.

    Examples
    --------
    >>> names()[0]
    '1.1'
    """
    return tuple(number for number, _, _, _ in EXERCISES)


def titles() -> dict[str, str]:
    """Number -> title; loads nothing.

    Examples
    --------
    >>> titles()["1.1"]
    'The legs of a coframe'
    """
    return {number: title for number, _, title, _ in EXERCISES}


def chapter_of(number: str) -> str:
    """Title of the chapter of an exercise."""
    return dict(CHAPTERS)[number.partition(".")[0]]


def load(number: str, seed: int = 0) -> Exercise:
    """An exercise in the variant of a seed; nothing is solved before an answer is checked.

    Raises
    ------
    UnknownNameError
        There is no such exercise, or no such seed; the message lists the known ones.

    Examples
    --------
    >>> load("1.1").title, load("1.1", seed=7).seed
    ('The legs of a coframe', 7)
    """
    seed = count(seed, "seed (which variant)", UnknownNameError, 0, MOST.seed)
    for key, module, title, level in EXERCISES:
        if key == number:
            return _loaded(key, module, title, level, seed)
    if not isinstance(number, str):
        example = str(number) if str(number) in names() else names()[0]
        raise UnknownNameError(
            f"expected the number of an exercise as text, got {shown(number)}. Write it in quotes: "
            f'"{example}".'
        )
    near = close_names(number[:20], names(), 3, 0.6)
    hint = f" Did you mean {' or '.join(near)}?" if near else ""
    raise UnknownNameError(
        f"expected the number of an exercise, from {names()[0]} to {names()[-1]}, got "
        f"{number[:20]!r}.{hint} `geomtorsion exercises` lists all exercises."
    )


# A class has a few variants of each exercise; solving one again costs time.
@lru_cache(maxsize=512)
def _loaded(number: str, module: str, title: str, level: str, seed: int) -> Exercise:
    """An exercise from the cache: results computed for one student serve the next."""
    variant = import_module(f"geomtorsion.teaching.exercises.{module}").make(Draw(seed))
    return Exercise(number, title, chapter_of(number), level, seed, variant, load)


def check(number: str, answers: Mapping[str, object] | str, seed: int = 0) -> Verdict:
    """The verdict on the answers to an exercise; see `Exercise.check`.

    Examples
    --------
    >>> check("1.1", "[[1, 0], [0, 1]]").right
    False
    """
    return load(number, seed).check(answers)

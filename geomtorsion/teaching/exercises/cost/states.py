"""7.4: how many variables describe a motion."""

from itertools import permutations

from geomtorsion.curves import CurveProblem, autoparallel, geodesic
from geomtorsion.geometry import cartan
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import Draw, Mistake, Question, Step, Variant, steps

START = (0.3, 1.0, 0.2, 0.0, 0.0, 0.0)
SPEEDS = (1.0, 0.5, -0.2, 0.1, 0.2, 0.3)


def make(draw: Draw) -> Variant:
    """A free top; the seed chooses its moments."""
    flying = draw.choice((False, True))
    moments = draw.choice(tuple(permutations(range(1, 8), 3)))
    name = "r3xso3" if flying else "so3"
    frame = load(name).frame
    inertia = (*moments, 1, 1, 1)[: frame.dimension]
    start, speeds = START[: frame.dimension], SPEEDS[: frame.dimension]
    alone = geodesic(frame, frame_velocity=speeds, metric=inertia)
    whole = geodesic(frame, start, frame_velocity=speeds, metric=inertia)
    straight = autoparallel(cartan(frame), start, frame_velocity=speeds)
    moves = "rotates and moves freely" if flying else "rotates freely about a fixed point"
    rates = "the angular velocity and the velocity" if flying else "only the angular velocity"
    place = "attitude and position" if flying else "attitude"

    def ask(name: str, prompt: str, right: CurveProblem, chart: str | None, *wrong) -> Question:
        return Question(
            name=name,
            kind="number",
            prompt=prompt,
            answer=lambda: states(right, chart),
            errors=lambda: [Mistake(code, states(p, at), note) for code, p, at, note in wrong],
            tolerance=1e-9,
            generic=(),
        )

    return Variant(
        statement=(
            f"A body with the moments of inertia ${moments}$ {moves}. Its motion is solved as a "
            r"system of first order for the coordinates $q^\mu$ and the frame velocities $u^k$: "
            r"$\dot q^\mu = E_i{}^\mu u^i$ with the legs $E_i$, and $\dot u^k = \ldots$ The solver "
            "integrates only the variables that the requested quantities depend on."
        ),
        questions=(
            ask(
                "omega",
                f"You request {rates} along the axes of the body"
                f"{', but no coordinates' * flying}. How many variables does the solver integrate?",
                alone,
                None,
                (
                    "forgotten",
                    whole,
                    name,
                    "On a group the equations of the velocities contain no coordinates.",
                ),
            ),
            ask(
                "angles",
                f"How many variables does the solver integrate if you also request the {place}, "
                "with three angles for the attitude?",
                whole,
                name,
                ("forgotten", alone, None, "The coordinates must also be integrated."),
                (
                    "another",
                    whole,
                    "quaternion",
                    "That is the number with a quaternion for the attitude.",
                ),
            ),
            ask(
                "quaternion",
                "How many variables are there if a quaternion instead of three angles describes "
                "the attitude? (A quaternion needs no change of charts.)",
                whole,
                "quaternion",
                (
                    "forgotten",
                    whole,
                    name,
                    "A quaternion has four components, one more than three angles.",
                ),
            ),
            ask(
                "straightest",
                "How many variables are there for an autoparallel (**straightest** line) of the "
                "body-fixed frame, with three angles for the attitude?",
                straight,
                name,
                (
                    "levi-civita",
                    whole,
                    name,
                    "On an autoparallel frame velocities are constant and not integrated.",
                ),
            ),
        ),
        hints=steps(
            r"Euler's equations contain only $\Omega$, not the angles.",
            "Constant quantities need not be integrated.",
            "In Python: `gt.geodesic(...).equations().system.states`.",
        ),
        worked=lambda: _worked(flying),
    )


def states(problem: CurveProblem, chart: str | None) -> int:
    """How many states the equations of a problem have, in a chart."""
    return len(problem.equations(chart).system.states)


def _worked(flying: bool) -> tuple[Step, ...]:
    """Counting velocities and coordinates."""
    n = 6 if flying else 3
    moved = ": three of rotation and three of translation" if flying else ""
    return (
        Step(
            f"The frame has {n} velocities{moved}. On a group their equations contain no "
            f"coordinates: {n} variables.",
            "omega",
            n,
        ),
        Step(f"The {n} coordinates are added: {2 * n} variables.", "angles", 2 * n),
        Step(
            f"A quaternion has four components instead of three angles: {2 * n + 1} variables.",
            "quaternion",
            2 * n + 1,
        ),
        Step(
            "On the autoparallel the frame velocities are constant. Only the "
            f"{n} coordinates are integrated.",
            "straightest",
            n,
        ),
    )

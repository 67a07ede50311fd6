"""7.4: how many numbers describe a motion."""

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
    moves = "turns and flies freely" if flying else "turns freely about a fixed point"
    rates = "velocities in the body (of turning and of flying)" if flying else "angular velocity"
    place = "attitude and place are" if flying else "the attitude is"

    def ask(name: str, prompt: str, right: CurveProblem, chart: str | None, *wrong) -> Question:
        return Question(
            name=name,
            kind="number",
            prompt=prompt,
            answer=lambda: states(right, chart),
            errors=lambda: [Mistake(code, states(p, at), said) for code, p, at, said in wrong],
            tolerance=1e-9,
            generic=(),
        )

    return Variant(
        statement=(
            f"A body with the moments of inertia ${moments}$ {moves}. Its motion is solved as "
            r"$\dot q^\mu = E_i{}^\mu u^i$, $\dot u^k = \ldots$ of first order. Nothing is computed"
            " that nobody asked for."
        ),
        questions=(
            ask(
                "omega",
                f"How many numbers does the solver follow if only the {rates} are asked for?"
                if flying
                else "How many numbers does the solver follow if only the angular velocity in the "
                "body is asked for?",
                alone,
                None,
                ("forgotten", whole, name, "On a group the velocities need no coordinates."),
            ),
            ask(
                "angles",
                f"How many if {place} asked for as well, the attitude by three angles?",
                whole,
                name,
                ("forgotten", alone, None, "The angles have to be followed, too."),
                ("another", whole, "quaternion", "So many if the attitude is a quaternion."),
            ),
            ask(
                "quaternion",
                "How many with the attitude as a quaternion, which needs no change of charts?",
                whole,
                "quaternion",
                ("forgotten", whole, name, "A quaternion has one component more than angles."),
            ),
            ask(
                "straightest",
                "How many for the **straightest** line of the body-fixed frame, by three angles?",
                straight,
                name,
                ("levi-civita", whole, name, "On it the frame velocities are constant."),
            ),
        ),
        hints=steps(
            r"Euler's equations contain $\Omega$ alone.",
            "What is constant need not be followed.",
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
    moved = "three of turning and three of flying" if flying else "three of turning"
    return (
        Step(
            f"The frame has {n} velocities, {moved}; on a group their equations contain no "
            f"coordinates: {n} numbers.",
            "omega",
            n,
        ),
        Step(f"The coordinates are {n} more: {2 * n} numbers.", "angles", 2 * n),
        Step(
            f"A quaternion has four components in the place of three angles: {2 * n + 1} numbers.",
            "quaternion",
            2 * n + 1,
        ),
        Step(
            "On the straightest line the frame velocities are constant; what is followed are the "
            f"{n} coordinates.",
            "straightest",
            n,
        ),
    )

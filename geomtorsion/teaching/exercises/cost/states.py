"""7.4: how many variables describe a motion."""

from itertools import permutations

from geomtorsion.curves import CurveProblem, autoparallel, geodesic
from geomtorsion.geometry import cartan
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import Draw, Mistake, Question, Step, Texts, Variant

START = (0.3, 1.0, 0.2, 0.0, 0.0, 0.0)
SPEEDS = (1.0, 0.5, -0.2, 0.1, 0.2, 0.3)


def make(draw: Draw, text: Texts) -> Variant:
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
        statement=text("flying" if flying else "statement", moments=moments),
        questions=(
            ask(
                "omega",
                text("omega.prompt_flying") if flying else text("omega.prompt"),
                alone,
                None,
                ("forgotten", whole, name, text("omega.forgotten")),
            ),
            ask(
                "angles",
                text("angles.prompt_flying") if flying else text("angles.prompt"),
                whole,
                name,
                ("forgotten", alone, None, text("angles.forgotten")),
                ("another", whole, "quaternion", text("angles.another")),
            ),
            ask(
                "quaternion",
                text("quaternion.prompt"),
                whole,
                "quaternion",
                ("forgotten", whole, name, text("quaternion.forgotten")),
            ),
            ask(
                "straightest",
                text("straightest.prompt"),
                straight,
                name,
                ("levi-civita", whole, name, text("straightest.levi-civita")),
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, flying),
    )


def states(problem: CurveProblem, chart: str | None) -> int:
    """How many states the equations of a problem have, in a chart."""
    return len(problem.equations(chart).system.states)


def _worked(text: Texts, flying: bool) -> tuple[Step, ...]:
    """Counting velocities and coordinates."""
    n = 6 if flying else 3
    return (
        Step(text("worked.1_flying" if flying else "worked.1", n=n), "omega", n),
        Step(text("worked.2", n=n, total=2 * n), "angles", 2 * n),
        Step(text("worked.3", total=2 * n + 1), "quaternion", 2 * n + 1),
        Step(text("worked.4", n=n), "straightest", n),
    )

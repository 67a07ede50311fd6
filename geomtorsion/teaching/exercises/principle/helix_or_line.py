"""6.6: the six-dimensional case, where the paper must be read with care."""

from functools import cache
from math import cos, hypot, pi, sin, sqrt

import sympy as sp

from geomtorsion.action import equations_of_motion
from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.geometry import Frame, cartan
from geomtorsion.ode import solve
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import (
    TORSION,
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    by_hand,
    scaled,
    tex,
)

# Key of an option -> the principle of the library.
PRINCIPLES = {"coordinates": "closed_in_coordinates", "image": "closed_in_image", "naive": "naive"}
U = sp.symbols("u1:7", real=True)
START = (0.3, 1.0, 0.2, 0.0, 0.0, 0.0)


def make(draw: Draw, text: Texts) -> Variant:
    """Spin and velocity; the seed chooses them."""
    frame = load("r3xso3").frame
    spin = draw.choice((2, 1, 3, 4))
    across, along = draw.choice((1, 2, 3)), draw.choice((1, 2))
    last = draw.choice((1.0, 0.5, 1.5))
    thrown = [0, 0, spin, across, 0, along]

    def torsion():
        return cartan(frame).torsion.T.in_frame()

    @cache
    def place(straightest: bool, time: float) -> tuple[float, ...]:
        line = autoparallel(cartan(frame), START, frame_velocity=thrown) if straightest else (
            geodesic(frame, START, frame_velocity=thrown)
        )  # fmt: skip
        return tuple(map(float, solve(line, [time], 1e-8).coordinates[-1, 3:]))

    def radius() -> float:
        half = pi / spin
        return sqrt(sum(x * x for x in place(True, half)) - (along * half) ** 2) / 2

    def separation() -> float:
        pairs = zip(place(True, last), place(False, last), strict=True)
        return hypot(*(x - y for x, y in pairs))

    return Variant(
        statement=text("statement"),
        questions=(
            Question(
                name="torsion",
                kind="expression",
                prompt=text("torsion.prompt"),
                domain=Domain(),
                answer=lambda: torsion()[0, 4, 5],
                remarks=TORSION.of(text.language),
                errors=lambda: [
                    Mistake("factor", torsion()[0, 4, 5] / 2, text("torsion.factor")),
                    Mistake("another", torsion()[3, 4, 5], text("torsion.another")),
                ],
            ),
            Question(
                name="force",
                kind="components",
                prompt=text("force.prompt"),
                domain=Domain(U),
                answer=lambda: force(frame),
                errors=lambda: [
                    Mistake("forgotten", {}, text("force.forgotten")),
                    Mistake("factor", scaled(force(frame), sp.Rational(1, 2))),
                ],
                shape=(6,),
                label="f",
                remarks=TORSION.of(text.language),
                points=2,
            ),
            Question(
                name="radius",
                kind="number",
                prompt=text("radius.prompt", spin=spin, across=across, along=along),
                answer=radius,
                errors=lambda: [
                    Mistake("factor", 2 * radius(), text("radius.factor")),
                    Mistake(
                        "forgotten", sqrt(across**2 + along**2) / spin, text("radius.forgotten")
                    ),
                ],
            ),
            Question(
                name="apart",
                kind="number",
                prompt=text("apart.prompt", last=f"{last:g}"),
                answer=separation,
                errors=lambda: [
                    Mistake("forgotten", last**2 * spin * across / 2, text("apart.forgotten"))
                ],
                points=2,
            ),
            Question(
                name="principle",
                kind="choice",
                prompt=text("principle.prompt"),
                answer=lambda: next(key for key in PRINCIPLES if flies_straight(frame, key)),
                errors=lambda: [
                    Mistake("principle", "image", text("principle.principle")),
                    Mistake("naive", "naive"),
                ],
                options=text.table("principle.options"),
            ),
            Question(
                name="law",
                kind="choice",
                prompt=text("law.prompt"),
                answer=lambda: "autoparallel" if is_straightest(frame) else "geodesic",
                errors=lambda: [Mistake("principle", "autoparallel", text("law.principle"))],
                options=text.table("law.options"),
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, spin, across, last),
    )


def force(frame: Frame) -> list[sp.Expr]:
    """The torsion force in the frame, which acts on autoparallels but not on geodesics."""
    energy = sp.Add(*(x**2 / 2 for x in sp.symbols("u1:7")))
    table = dict(zip(sp.symbols("u1:7"), U, strict=True))
    components = equations_of_motion(frame, energy).torsion_force
    return [-value.xreplace(table) for value in components]


def flies_straight(frame: Frame, principle: str) -> bool:
    """Whether a principle gives V' = - Omega x V."""
    u = sp.symbols("u1:7")
    energy = sp.Add(*(x**2 / 2 for x in u))
    accelerations = equations_of_motion(
        frame, energy, principle=PRINCIPLES[principle]
    ).accelerations[3:]
    cross = sp.Matrix(u[:3]).cross(sp.Matrix(u[3:]))
    return all(sp.expand(x + y) == 0 for x, y in zip(accelerations, cross, strict=True))


def is_straightest(frame: Frame) -> bool:
    """Whether the motions of a free body are autoparallels."""
    return not any(force(frame))


def _worked(text: Texts, spin: int, across: int, last: float) -> tuple[Step, ...]:
    """The force from a vector product; circle and tangent."""
    pull = by_hand.cross(U[:3], U[3:])
    circle = across / spin
    gap = hypot(circle * sin(spin * last) - across * last, circle * (1 - cos(spin * last)))
    return (
        Step(text("worked.1"), "torsion", sp.Integer(-1)),
        Step(
            text("worked.2", force=tex.matrix([[x] for x in pull])), "force", [sp.S.Zero] * 3 + pull
        ),
        Step(text("worked.3", across=across, spin=spin, circle=f"{circle:.6g}"), "radius", circle),
        Step(
            text("worked.4", angle=f"{spin * last:g}", path=f"{across * last:g}", gap=f"{gap:.6g}"),
            "apart",
            gap,
        ),
        Step(text("worked.5"), "principle", "coordinates"),
        Step(text("worked.6"), "law", "geodesic"),
    )

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
    Variant,
    by_hand,
    scaled,
    steps,
    tex,
)

PRINCIPLES = {
    "coordinates": "variations closed in the coordinates (Hamilton, Poincare)",
    "image": "variations closed in the flat image (Kleinert)",
    "naive": "variations closed in the frame, as if its forms were closed",
}
LONG = {"coordinates": "closed_in_coordinates", "image": "closed_in_image", "naive": "naive"}
U = sp.symbols("u1:7", real=True)
START = (0.3, 1.0, 0.2, 0.0, 0.0, 0.0)


def make(draw: Draw) -> Variant:
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
        statement=(
            "A rigid body in space has six coordinates, the angles and the place of its centre of "
            "mass (in this order). Its frame $(e^1, e^2, e^3) = \\Omega\\,\\mathrm{d}t$, "
            "$(e^4, e^5, e^6) = V\\,\\mathrm{d}t$ reads angular velocity and velocity off along "
            "the axes of the body. On the rotations alone the straightest lines of such a frame "
            "are the shortest. **Here they are not**, and the conclusion that bodies follow "
            "straightest lines must be read with care.\n\n"
            "The body has the kinetic energy $\\tfrac12\\,(\\Omega^2 + V^2)$: moments and mass are "
            "all 1."
        ),
        questions=(
            Question(
                name="torsion",
                kind="expression",
                prompt="The component $2S_{15}{}^6$ of the torsion in the frame: turning about "
                "axis 1 with moving along axis 2.",
                domain=Domain(),
                answer=lambda: torsion()[0, 4, 5],
                remarks=TORSION,
                errors=lambda: [
                    Mistake("factor", torsion()[0, 4, 5] / 2, "That is $S$; asked is $2S$."),
                    Mistake("another", torsion()[3, 4, 5], "Does moving alone fail to close?"),
                ],
            ),
            Question(
                name="force",
                kind="components",
                prompt=r"The torsion force $f^k = 2\,S_i{}^k{}_j\,u^i u^j$ in the frame, six "
                "components in `u1` to `u6` (the first three are $\\Omega$, the others $V$).",
                domain=Domain(U),
                answer=lambda: force(frame),
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        {},
                        "On the rotations alone it vanishes, but here $S$ is not totally "
                        "antisymmetric.",
                    ),
                    Mistake("factor", scaled(force(frame), sp.Rational(1, 2))),
                ],
                shape=(6,),
                label="f",
                remarks=TORSION,
                points=2,
            ),
            Question(
                name="radius",
                kind="number",
                prompt=f"The body is thrown with $\\Omega = (0, 0, {spin})$ and "
                f"$V = ({across}, 0, {along})$. If it followed the **straightest** line, its "
                "centre would move on a helix. Of which radius?",
                answer=radius,
                errors=lambda: [
                    Mistake("factor", 2 * radius(), "That is the diameter."),
                    Mistake(
                        "forgotten",
                        sqrt(across**2 + along**2) / spin,
                        "Only the part of $V$ across the axis of turning goes round.",
                    ),
                ],
            ),
            Question(
                name="apart",
                kind="number",
                prompt=f"How far from the centre of the body that flies freely would it be at "
                f"$t = {last:g}$?",
                answer=separation,
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        last**2 * spin * across / 2,
                        "That is the first term in the time only.",
                    )
                ],
                points=2,
            ),
            Question(
                name="principle",
                kind="choice",
                prompt=r"Which principle gives $\dot V + \Omega\times V = 0$, eq. (2) of the paper "
                "without force?",
                answer=lambda: next(key for key in PRINCIPLES if flies_straight(frame, key)),
                errors=lambda: [
                    Mistake(
                        "principle",
                        "image",
                        "That one has the straightest lines: $\\dot V = 0$ in the body, a helix.",
                    ),
                    Mistake("naive", "naive"),
                ],
                options=PRINCIPLES,
            ),
            Question(
                name="law",
                kind="choice",
                prompt="What, then, is the flight of a free body in the geometry of this frame?",
                answer=lambda: "autoparallel" if is_straightest(frame) else "geodesic",
                errors=lambda: [
                    Mistake(
                        "principle",
                        "autoparallel",
                        "It is not: on an autoparallel $\\Omega$ and $V$ are constant in the body.",
                    )
                ],
                options={
                    "autoparallel": "an autoparallel of the Cartan connection",
                    "geodesic": "a geodesic of the metric, not an autoparallel",
                },
            ),
        ),
        hints=steps(
            r"The velocity is carried round by the turning body: "
            r"$\mathrm{d}e^{3+i} = \epsilon_{ijk}\,e^k\wedge e^{3+j}$ for $i, j, k = 1, 2, 3$.",
            r"On an autoparallel $\dot u = 0$, on a geodesic $\dot\Omega = 0$ and "
            r"$\dot V = -\Omega\times V$: the torsion force is the difference.",
            "On the straightest line the body sees its velocity constant while it turns: in space "
            "the velocity goes round with the angular velocity of the spin.",
            "The free body keeps its velocity in space. Compare a circle with its tangent.",
        ),
        worked=lambda: _worked(spin, across, last),
    )


def force(frame: Frame) -> list[sp.Expr]:
    """The torsion force in the frame, which acts on autoparallels but not on geodesics."""
    energy = sp.Add(*(x**2 / 2 for x in sp.symbols("u1:7")))
    table = dict(zip(sp.symbols("u1:7"), U, strict=True))
    found = equations_of_motion(frame, energy).torsion_force
    return [-value.xreplace(table) for value in found]


def flies_straight(frame: Frame, principle: str) -> bool:
    """Whether a principle gives V' = - Omega x V."""
    u = sp.symbols("u1:7")
    energy = sp.Add(*(x**2 / 2 for x in u))
    found = equations_of_motion(frame, energy, principle=LONG[principle]).accelerations[3:]
    cross = sp.Matrix(u[:3]).cross(sp.Matrix(u[3:]))
    return all(sp.expand(x + y) == 0 for x, y in zip(found, cross, strict=True))


def is_straightest(frame: Frame) -> bool:
    """Whether the motions of a free body are autoparallels."""
    return not any(force(frame))


def _worked(spin: int, across: int, last: float) -> tuple[Step, ...]:
    """The force from a vector product; circle and tangent."""
    pull = by_hand.cross(U[:3], U[3:])
    circle = across / spin
    gap = hypot(circle * sin(spin * last) - across * last, circle * (1 - cos(spin * last)))
    return (
        Step(
            r"$\mathrm{d}e^{3+i} = \epsilon_{ijk}\,e^k\wedge e^{3+j}$. For $i = 3$, $e^1\wedge "
            r"e^5$ has $k = 1$, $j = 2$ and $\epsilon_{321} = -1$: $2S_{15}{}^6 = -1$.",
            "torsion",
            sp.Integer(-1),
        ),
        Step(
            r"A geodesic has $\dot\Omega = 0$ and $\dot V + \Omega\times V = 0$, an autoparallel "
            r"$\dot\Omega = 0$ and $\dot V = 0$. What is left of the first equations on the "
            r"second is the force, $f = (0, \Omega\times V)$: "
            f"$${tex.matrix([[x] for x in pull])}$$ in the last three components.",
            "force",
            [sp.S.Zero] * 3 + pull,
        ),
        Step(
            r"On the straightest line the velocity turns with $\Omega$: across the axis the centre "
            f"runs with speed {across} on a circle, of radius ${across}/{spin} = {circle:.6g}$.",
            "radius",
            circle,
        ),
        Step(
            "The free centre goes on along the tangent. Circle and tangent share the motion along "
            f"the axis; across it they are $\\rho\\sin {spin * last:g} - {across * last:g}$ and "
            f"$\\rho(1 - \\cos {spin * last:g})$ apart, with the radius $\\rho$: together "
            f"${gap:.6g}$.",
            "apart",
            gap,
        ),
        Step(
            r"$\dot V + \Omega\times V = 0$ is the equation of the geodesics, which Hamilton's "
            "principle gives: variations closed in the coordinates.",
            "principle",
            "coordinates",
        ),
        Step("So the free body follows a geodesic, no autoparallel.", "law", "geodesic"),
    )

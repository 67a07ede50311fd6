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
    "coordinates": "end points fixed in the coordinates (Hamilton, Poincare)",
    "image": "end points fixed in the flat image of the path (Kleinert)",
    "naive": "variations in the frame, as if its forms were differentials of coordinates",
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
            "A rigid body in space has six coordinates: three angles and the position of its "
            "centre of mass (in this order). Its frame gives the angular velocity $\\Omega$ and "
            "the velocity $V$ along the axes of the body: on a motion, $(e^1, e^2, e^3) = "
            "\\Omega\\,\\mathrm{d}t$ and $(e^4, e^5, e^6) = V\\,\\mathrm{d}t$. If the body only "
            "rotates, the autoparallels (straightest lines) of such a frame are geodesics "
            "(shortest lines). **Here they are not.** So be careful with the conclusion that "
            "bodies follow straightest lines.\n\n"
            "The kinetic energy is $\\tfrac12\\,(\\Omega^2 + V^2)$: the moments of inertia and the "
            "mass are all 1."
        ),
        questions=(
            Question(
                name="torsion",
                kind="expression",
                prompt="Find the component $2S_{15}{}^6$ of the torsion in the frame. It combines "
                "rotation about axis 1 with translation along axis 2.",
                domain=Domain(),
                answer=lambda: torsion()[0, 4, 5],
                remarks=TORSION,
                errors=lambda: [
                    Mistake("factor", torsion()[0, 4, 5] / 2, "That is $S$, not $2S$."),
                    Mistake(
                        "another",
                        torsion()[3, 4, 5],
                        "That is $2S_{45}{}^6$. Translations commute, but a rotation and a "
                        "translation do not.",
                    ),
                ],
            ),
            Question(
                name="force",
                kind="components",
                prompt=r"Find the torsion force $f^k = 2\,S_i{}^k{}_j\,u^i u^j$ in the frame: six "
                "components in `u1` to `u6` (the first three are $\\Omega$, the others $V$).",
                domain=Domain(U),
                answer=lambda: force(frame),
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        {},
                        "The force vanishes only if $S_{ijk}$ is totally antisymmetric, as for a "
                        "body that only rotates. Here it is not.",
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
                prompt=f"The body starts with $\\Omega = (0, 0, {spin})$ and "
                f"$V = ({across}, 0, {along})$. On the autoparallel (**straightest** line), its "
                "centre of mass would move on a helix. What is the radius of the helix?",
                answer=radius,
                errors=lambda: [
                    Mistake("factor", 2 * radius(), "That is the diameter."),
                    Mistake(
                        "forgotten",
                        sqrt(across**2 + along**2) / spin,
                        "Only the part of $V$ perpendicular to the rotation axis counts.",
                    ),
                ],
            ),
            Question(
                name="apart",
                kind="number",
                prompt="A free body starts in the same way. How far apart are the two centres of "
                f"mass at $t = {last:g}$?",
                answer=separation,
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        last**2 * spin * across / 2,
                        "That is only the first term of a power series in the time.",
                    )
                ],
                points=2,
            ),
            Question(
                name="principle",
                kind="choice",
                prompt=r"Which principle gives $\dot V + \Omega\times V = 0$, eq. (2) of the paper "
                "without a force?",
                answer=lambda: next(key for key in PRINCIPLES if flies_straight(frame, key)),
                errors=lambda: [
                    Mistake(
                        "principle",
                        "image",
                        "That principle gives the autoparallels: $\\dot V = 0$ in the body, and "
                        "the centre of mass moves on a helix.",
                    ),
                    Mistake("naive", "naive"),
                ],
                options=PRINCIPLES,
            ),
            Question(
                name="law",
                kind="choice",
                prompt="Which curve does a free body follow in the geometry of this frame?",
                answer=lambda: "autoparallel" if is_straightest(frame) else "geodesic",
                errors=lambda: [
                    Mistake(
                        "principle",
                        "autoparallel",
                        "On an autoparallel $V$ is constant in the body. For a rotating free body "
                        "it is constant in space.",
                    )
                ],
                options={
                    "autoparallel": "an autoparallel of the Cartan connection",
                    "geodesic": "a geodesic of the metric, not an autoparallel",
                },
            ),
        ),
        hints=steps(
            r"The axes along which $V$ is measured rotate with the body: "
            r"$\mathrm{d}e^{3+i} = \epsilon_{ijk}\,e^k\wedge e^{3+j}$ for $i, j, k = 1, 2, 3$.",
            r"On an autoparallel $\dot u = 0$. On a geodesic $\dot\Omega = 0$ and "
            r"$\dot V = -\Omega\times V$. The torsion force is $\dot u$ on the autoparallel minus "
            r"$\dot u$ on the geodesic.",
            "On the autoparallel the velocity is constant along the axes of the body. So in space "
            "the velocity rotates with the angular velocity of the body.",
            "The free body has a constant velocity in space. Compare a circle with its tangent.",
        ),
        worked=lambda: _worked(spin, across, last),
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
    accelerations = equations_of_motion(frame, energy, principle=LONG[principle]).accelerations[3:]
    cross = sp.Matrix(u[:3]).cross(sp.Matrix(u[3:]))
    return all(sp.expand(x + y) == 0 for x, y in zip(accelerations, cross, strict=True))


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
            r"On a geodesic $\dot\Omega = 0$ and $\dot V = -\Omega\times V$. On an autoparallel "
            r"$\dot\Omega = 0$ and $\dot V = 0$. The autoparallel minus the geodesic gives the "
            r"torsion force $f = (0, \Omega\times V)$. Its last three "
            f"components are $${tex.matrix([[x] for x in pull])}.$$",
            "force",
            [sp.S.Zero] * 3 + pull,
        ),
        Step(
            r"On the autoparallel the velocity rotates with $\Omega$. Perpendicular to the axis "
            f"the centre moves with speed {across} on a circle of radius "
            f"${across}/{spin} = {circle:.6g}$.",
            "radius",
            circle,
        ),
        Step(
            "The centre of the free body moves along the tangent of the circle. Both centres move "
            "equally along the axis. Perpendicular to the axis, the components of their distance "
            f"are $\\rho\\sin {spin * last:g} - {across * last:g}$ and $\\rho(1 - \\cos "
            f"{spin * last:g})$, where $\\rho$ is the radius. The distance is ${gap:.6g}$.",
            "apart",
            gap,
        ),
        Step(
            r"$\dot V + \Omega\times V = 0$ is the equation of the geodesics. It follows from "
            "Hamilton's principle, with end points fixed in the coordinates.",
            "principle",
            "coordinates",
        ),
        Step("So the free body follows a geodesic that is not an autoparallel.", "law", "geodesic"),
    )

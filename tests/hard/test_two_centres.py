"""Two black holes at rest (Majumdar, Papapetrou): long algebra of two roots, compiled and right."""

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import geodesic
from geomtorsion.errors import SingularPointError
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop, burgers_vector
from geomtorsion.ode import RungeKutta, Taylor, solve
from tests.rounding import ROUNDED


def two_centres(numbers=True, places=((0, 0, 1), (0, 0, -1))):
    """Coframe diag(1/U, U, U, U), U = 1 + m1/r1 + m2/r2."""
    t, *q = sp.symbols("t x y z", real=True)
    masses = (1, 1) if numbers else sp.symbols("m1 m2", positive=True)
    roots = [sp.sqrt(sum((x - c) ** 2 for x, c in zip(q, place, strict=True))) for place in places]
    potential = 1 + masses[0] / roots[0] + masses[1] / roots[1]
    return Frame(
        [t, *q], sp.diag(1 / potential, *[potential] * 3).tolist(), signature=(-1, 1, 1, 1),
        parameters=() if numbers else masses, name="two centres",
    )  # fmt: skip


def potential(q, places=((0, 0, 1), (0, 0, -1))):
    """U for two masses of one."""
    return 1 + sum(1 / mpmath.norm(mpmath.matrix(list(q)) - mpmath.matrix(c)) for c in places)


@pytest.mark.parametrize("numbers", [True, False])
def test_light_along_the_axis(numbers):
    """dz/dlambda = -1 and dt = U^2 dz from z = 5 on: t in closed form.

    At z = 1 + sqrt(2) a conjugate of U vanishes; the motion passes.
    """
    frame = two_centres(numbers)
    start, u = 5.0, 1 + 1 / 4 + 1 / 6
    problem = geodesic(
        frame, [0, 0, 0, start], frame_velocity=[u, 0, 0, -u], causal="null",
        parameters={} if numbers else {"m1": 1, "m2": 1},
    )  # fmt: skip
    times = np.array([0.5, 1.0, 3.0])
    sol = solve(problem, times, 1e-10, RungeKutta())

    def height(z):
        # The integral of U^2 = (1 + 1/(z-1) + 1/(z+1))^2.
        logs = 2 * np.log((z - 1) * (z + 1)) + np.log((z - 1) / (z + 1))
        return z - 1 / (z - 1) - 1 / (z + 1) + logs

    z = start - times
    want = np.transpose([height(start) - height(z), 0 * z, 0 * z, z])
    assert sol.coordinates == pytest.approx(want, rel=1e-9, abs=1e-9)


def test_a_burgers_vector_where_conjugates_of_the_potential_vanish():
    """1 - 1/r1 - 1/r2 vanishes on the loop: a factor of both parts of 1/U, and not a pole."""
    loop = Loop.circle((0, 0.3, 0.2, 3.0), 1.0, (1, 3))
    found = burgers_vector(two_centres(), loop)
    assert found.check.agrees
    with mpmath.workdps(30):

        def side(turn):
            x, z = 0.3 + mpmath.cos(turn), 3 + mpmath.sin(turn)
            return potential([x, mpmath.mpf("0.2"), z])

        want = [
            mpmath.quad(lambda s: -side(s) * mpmath.sin(s), [0, mpmath.pi, 2 * mpmath.pi]),
            mpmath.quad(lambda s: side(s) * mpmath.cos(s), [0, mpmath.pi, 2 * mpmath.pi]),
        ]  # fmt: skip
    assert found.vector == pytest.approx([0, float(want[0]), 0, float(want[1])], abs=1e-12)


def test_symbolic_masses_are_those_with_numbers():
    """With masses as parameters both engines give the same curve, and loops the same b."""
    masses = {"m1": 1, "m2": 1}
    start, velocity = [0, 3, 1, 0.5], [1.1, 0.3, 0.2, -0.1]
    ends = [
        solve(
            geodesic(two_centres(numbers), start, frame_velocity=velocity, parameters=given),
            [2.0], 1e-10, engine,
        ).coordinates[-1]
        for numbers, given, engine in (
            (True, {}, Taylor()), (False, masses, Taylor()), (False, masses, RungeKutta()),
        )
    ]  # fmt: skip
    assert ends[1] == pytest.approx(ends[0], rel=1e-12)
    assert ends[2] == pytest.approx(ends[0], rel=1e-10)
    loop = Loop.circle((0, 0.3, 0.2, 3.0), 1.0, (1, 3))
    found = burgers_vector(two_centres(False), loop, parameters=masses)
    assert found.check.agrees
    assert found.vector == pytest.approx(burgers_vector(two_centres(), loop).vector, abs=ROUNDED)


def test_a_loop_through_a_centre_is_refused():
    """A loop through a centre, where U is infinite, is refused."""
    with pytest.raises(SingularPointError, match="passes through"):
        burgers_vector(two_centres(), Loop.circle((0, 0, 0, 2.0), 1.0, (1, 3)))


def test_centres_off_the_axes():
    """With longer algebra the two routes still agree."""
    frame = two_centres(places=((1, 2, 3), (-2, 1, -1)))
    assert burgers_vector(frame, Loop.circle((0, 0.3, 0.2, 0.0), 0.5, (1, 3))).check.agrees

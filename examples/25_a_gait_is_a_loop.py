"""A gait is a loop of shapes: Purcell's swimmer, its displacement per stroke, and its torsion.

    python examples/25_a_gait_is_a_loop.py
    python examples/25_a_gait_is_a_loop.py --ratio 1.6 --amplitude 0.5

Purcell's swimmer (Am. J. Phys. 45 (1977) 3) has three equal links and two hinges. In a viscous
fluid its velocity is linear in the rates of the two angles. The two rows for the translation are a
coframe over the space of shapes, and the row for the rotation is a spin connection. The development
of a loop of shapes is the displacement after one stroke (Shapere and Wilczek, J. Fluid Mech. 198
(1989) 557). The torsion at the straight shape is the displacement per area of a small stroke:
5 (r - 1)/81 links, for the ratio r of the drag across a link to the drag along it.
"""

import argparse

import numpy as np
import sympy as sp

import geomtorsion as gt

ALPHA = sp.symbols("alpha1 alpha2", real=True)
RATIO = sp.Symbol("r", positive=True)
SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])


def velocities() -> sp.Matrix:
    """Velocity (forward, sideways, turn) of the middle link per rate of each angle, exactly."""
    half = sp.Rational(1, 2)
    drag = sp.zeros(3, 5)
    for side, angle in ((-1, ALPHA[0]), (0, sp.S.Zero), (1, ALPHA[1])):
        along = sp.Matrix([sp.cos(angle), sp.sin(angle)])
        across = sp.Matrix([-along[1], along[0]])
        centre = side * half * (along + sp.Matrix([1, 0]))
        slopes = [[part.diff(alpha) for alpha in ALPHA] for part in centre]
        move = sp.Matrix([[1, 0, -centre[1], *slopes[0]], [0, 1, centre[0], *slopes[1]]])
        turn = sp.Matrix([[0, 0, 1, *(angle.diff(alpha) for alpha in ALPHA)]])
        force = (along * along.T + RATIO * across * across.T) * move
        torque = centre[0] * force[1, :] - centre[1] * force[0, :] + RATIO * turn / 12
        drag += force.col_join(torque)
    # Force and torque on the whole swimmer vanish.
    return -drag[:, :3].adjugate() * drag[:, 3:] / drag[:, :3].det()


def swimmer() -> gt.Connection:
    """The connection over the space of shapes."""
    rows = velocities()
    shapes = gt.Frame(ALPHA, rows[:2, :].tolist(), parameters=[RATIO], name="Purcell's swimmer")
    spin = [[[0, rows[2, a]], [-rows[2, a], 0]] for a in range(2)]
    return gt.from_spin_connection(shapes, spin)


def small_stroke() -> sp.Expr:
    """Component T_12^1 of the torsion, forward per area: T^1 = d e^1 - A ^ e^2, A the turn."""
    plane = gt.Frame(ALPHA, sp.eye(2), parameters=[RATIO])
    rows = velocities().tolist()
    forward, sideways, turn = (gt.Form(plane, 1, dict(enumerate(row))) for row in rows)
    return (forward.d - (turn ^ sideways))[0, 1]


def simulated(ratio: float, amplitude: float, steps: int = 200) -> np.ndarray:
    """Displacement (x, y, angle) of a square stroke: drag summed along the links, Runge-Kutta."""
    nodes = (np.array([-1, 1]) / np.sqrt(3) + 1) / 2

    def rate(state: np.ndarray, shape: np.ndarray, speed: np.ndarray) -> np.ndarray:
        resistance, push = np.zeros((3, 3)), np.zeros(3)
        for side, k in ((-1, 0), (0, None), (1, 1)):
            angle, spin = (0.0, 0.0) if k is None else (shape[k], speed[k])
            along = np.array([np.cos(angle), np.sin(angle)])
            across = np.array([-along[1], along[0]])
            friction = np.outer(along, along) + ratio * np.outer(across, across)
            for s in nodes:
                arm = side * s if side else s - 0.5
                place = np.array([side / 2, 0]) + arm * along
                lever = np.array([[1, 0, -place[1]], [0, 1, place[0]]])
                resistance += lever.T @ friction @ lever
                push += lever.T @ friction @ (arm * spin * across)
        x, y, turn = -np.linalg.solve(resistance, push)
        c, s = np.cos(state[2]), np.sin(state[2])
        return np.array([c * x - s * y, s * x + c * y, turn])

    state = np.zeros(3)
    for begin, end in zip(SQUARE[:-1] * amplitude, SQUARE[1:] * amplitude, strict=True):
        speed, h = end - begin, 1 / steps
        for step in range(steps):
            early, middle, late = (begin + speed * (step + part) * h for part in (0, 0.5, 1))
            k1 = rate(state, early, speed)
            k2 = rate(state + h / 2 * k1, middle, speed)
            k3 = rate(state + h / 2 * k2, middle, speed)
            k4 = rate(state + h * k3, late, speed)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return state


def main(arguments: list[str] | None = None) -> None:
    """Show displacements per stroke; the example ends in assertions."""
    parser = argparse.ArgumentParser(description="Purcell's swimmer.")
    parser.add_argument("--ratio", type=float, default=2.0, help="drag across over drag along")
    parser.add_argument("--amplitude", type=float, default=0.8, help="of the angles, in radians")
    options = parser.parse_args(arguments)
    connection = swimmer()
    straight = dict.fromkeys(ALPHA, 0)
    torsion = small_stroke().subs(straight)
    print(f"torsion at the straight shape: {sp.factor(torsion)} links per area of the stroke")
    assert sp.simplify(torsion - 5 * (RATIO - 1) / 81) == 0

    law = float(torsion.subs(RATIO, options.ratio))
    numbers = {"r": options.ratio}
    for part in (1.0, 0.5, 0.25, 0.125):
        amplitude = options.amplitude * part
        stroke = gt.develop_path(connection, SQUARE * amplitude, parameters=numbers)
        size = float(np.hypot(*stroke.burgers))
        print(
            f"amplitude {amplitude:.3f}: moves by {size:.6f} links, turns by {stroke.angle:.1e}, "
            f"{size / (4 * amplitude**2):.6f} per area, law {law:.6f}"
        )
        assert abs(size - 4 * amplitude**2 * law) < 2 * amplitude**4 * abs(law)
    stroke = gt.develop_path(connection, SQUARE * options.amplitude, parameters=numbers)
    own = simulated(options.ratio, options.amplitude)
    gap = float(np.abs(own - [*stroke.burgers, stroke.angle]).max())
    print(f"the sum of the drag along the links, integrated separately, differs by {gap:.1e}")
    assert gap < 1e-9


if __name__ == "__main__":
    main()

"""One action, three ways to vary it: only one variation gives the real motion of a top.

    python examples/10_action_principle.py
    python examples/10_action_principle.py --moments 2 2 3 --spin 0.1 0 5 --time 20

In the moving frame of a body the kinetic energy has constant coefficients. Still, the equations of
motion do not make the momenta constant: the velocities belong to no coordinates, and their
variation has a second term, the torsion of the frame. Without this term the top turns wrongly.
"""

import argparse
from fractions import Fraction

import numpy as np
import sympy as sp

import geomtorsion as gt

U = sp.symbols("u1 u2 u3")


def top(moments: list[Fraction]) -> dict[str, gt.action.EquationsOfMotion]:
    """The equations of a free top from each of the three variations."""
    frame = gt.spaces.load("so3").frame  # u = body components of the angular velocity
    energy = sum(sp.Rational(i) * u**2 for i, u in zip(moments, U, strict=True)) / 2
    names = ("closed_in_coordinates", "closed_in_image", "naive")
    return {name: gt.equations_of_motion(frame, energy, principle=name) for name in names}


def sleigh() -> gt.action.EquationsOfMotion:
    """Chaplygin's sleigh: a blade that cannot slip sideways, with the mass ahead of it."""
    x, y, heading = sp.symbols("x y heading", real=True)
    c, s = sp.cos(heading), sp.sin(heading)
    frame = gt.Frame([x, y, heading], [[c, s, 0], [-s, c, 0], [0, 0, 1]])
    energy = "m*(u1**2 + (u2 + a*u3)**2)/2 + J*u3**2/2"
    return gt.equations_of_motion(frame, energy, constraints=["u2"], parameters=["m", "a", "J"])


def main(arguments: list[str] | None = None) -> None:
    """Derive, prove, solve, and compare with closed forms."""
    parser = argparse.ArgumentParser(description="Three variations of one action.")
    parser.add_argument(
        "--moments", type=Fraction, nargs=3, default=[Fraction(k) for k in (1, 2, 3)]
    )
    parser.add_argument("--spin", type=float, nargs=3, default=[0.02, 2.0, 0.01])
    parser.add_argument("--time", type=float, default=10.0)
    options = parser.parse_args(arguments)

    frame = gt.spaces.load("so3").frame
    print("Variation of the velocities when the ends of the path are fixed:")
    print(gt.variation(frame), "\n")
    found = top(options.moments)
    for name, equations in found.items():
        print(f"{name}: 0 = {', '.join(map(str, equations.residuals))}")
        possible = gt.variation(frame, name).proved
        print(f"    is a path variation: {possible}; conserves {', '.join(equations.invariants)}")
    right, naive = found["closed_in_coordinates"], found["naive"]
    assert right.agrees is True, "the same as Euler and Lagrange in the angles, by exact zero"

    # Solve both with the attitude: the right motion conserves angular momentum in space.
    start = [0.3, 1.0, 0.2, *options.spin]
    solved = {
        name: gt.solve(gt.ODE.of(equations, start), options.time, accuracy=1e-9)
        for name, equations in (("right", right), ("naive", naive))
    }
    space = right.invariants["space momentum 1"]
    measure = sp.lambdify([*frame.coordinates, *U], space, "numpy")
    print("\n  t   body spin, right          body spin, naive          l_x right  l_x naive")
    values = {name: measure(*solution.states.T) for name, solution in solved.items()}
    for k in range(0, len(solved["right"].times), 16):
        rows = [solved[name].states[k, 3:].round(4) for name in ("right", "naive")]
        momenta = [values[name][k] for name in ("right", "naive")]
        print(f"{solved['right'].times[k]:5.2f}  {rows[0]!s:25} {rows[1]!s:25} "
              f"{momenta[0]:9.5f}  {momenta[1]:9.5f}")  # fmt: skip
    assert np.ptp(values["right"]) < 1e-7 * max(1.0, abs(values["right"][0]))

    # Known: the free top in Jacobi's elliptic functions.
    closed = gt.rigid.free_top([float(i) for i in options.moments], options.spin)
    gap = np.abs(solved["right"].states[:, 3:] - closed.omega(solved["right"].times)).max()
    print(f"\nlargest distance from the elliptic functions: {gap:.1e}")
    assert gap < 1e-7

    # Known: a sleigh that starts with spin only ends in a straight slide, v = c tanh(k t).
    blade = sleigh()
    print(f"\nChaplygin's sleigh:\n{blade}")
    m, a, j, spin = 2.0, 0.5, 1.5, 3.0
    slide = gt.solve(
        gt.ODE.of(blade, {"x": 0, "y": 0, "heading": 0, "u1": 0, "u3": spin},
                parameters={"m": m, "a": a, "J": j}),
        options.time,
        accuracy=1e-9,
    )  # fmt: skip
    whole = j + m * a**2
    speed = spin * np.sqrt(whole / m)
    known = speed * np.tanh(m * a * speed / whole * slide.times)
    print(f"it ends with speed {slide['u1'][-1]:.9f}; known {known[-1]:.9f}")
    assert np.abs(slide["u1"] - known).max() < 1e-7


if __name__ == "__main__":
    main()

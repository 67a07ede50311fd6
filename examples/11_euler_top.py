"""Euler's top: from the action principle to Jacobi's functions, in three ways.

    python examples/11_euler_top.py
    python examples/11_euler_top.py --t 1000 --accuracy 1e-12

The right variation of the action in the frame of the body gives Euler's equations. With equal
moments their solutions are the autoparallels of the frame, with unequal moments they are not. Then
the motion is solved in closed form, by integration, and by a scene that integrates only the
requested quantities.
"""

import argparse

import numpy as np
import sympy as sp

import geomtorsion as gt


def main(arguments: list[str] | None = None) -> None:
    """Derive the equations, solve them three times, and compare."""
    parser = argparse.ArgumentParser(description="Euler's top in three ways.")
    parser.add_argument("--t", type=float, default=100.0, help="final time in s")
    parser.add_argument("--accuracy", type=float, default=1e-11)
    options = parser.parse_args(arguments)

    so3 = gt.spaces.load("so3").frame
    i1, i2, i3, u1, u2, u3 = sp.symbols("I1:4 u1:4")
    energy = (i1 * u1**2 + i2 * u2**2 + i3 * u3**2) / 2
    derived = gt.equations_of_motion(so3, energy)
    print("Poincare and Hamel:")
    for name, rate in list(derived.rates.items())[-3:]:
        print(f"  {name}' = {rate}")
    euler = [(i2 - i3) / i1 * u2 * u3, (i3 - i1) / i2 * u3 * u1, (i1 - i2) / i3 * u1 * u2]
    for found, known in zip(list(derived.rates.values())[-3:], euler, strict=True):
        assert sp.expand(found - known) == 0

    moments, start = (1, 2, 3), (0.5, 0.4, 1.0)
    scene = gt.Scene(
        gt.Body(mass=1, moments=moments),
        start=gt.State(omega=start),
        watch=["omega"],
        t=options.t,
        accuracy=options.accuracy,
    )
    print(f"\n{scene.selection}\n")
    closed = scene.run()
    top = gt.rigid.free_top(moments, start)
    flow = gt.ODE.of(
        {"a": "(2-3)/1*b*c", "b": "(3-1)/2*c*a", "c": "(1-2)/3*a*b"},
        dict(zip("abc", start, strict=True)),
    )
    solved = gt.solve(flow, scene.times, accuracy=options.accuracy)
    print(f"scene: {closed.closed_form}")
    print(f"flow:  {solved.engine}, error below {solved.error:.1e}")
    print(f"top:   one turn along the polhode takes {top.period:.9f} s")
    first = np.abs(closed["omega"] - top.omega(scene.times)).max()
    second = np.abs(closed["omega"] - solved.states).max()
    print(f"they agree to {first:.1e} and {second:.1e}")
    assert first < 1e-12
    assert second < 3 * options.accuracy
    # Known: after one period the angular velocity has its first value again.
    again = top.omega(np.array([top.period]))[0]
    assert np.abs(again - start).max() < 1e-13


if __name__ == "__main__":
    main()

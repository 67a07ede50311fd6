"""How sure is a number: three results, the errors that they report, and what is proved of them.

    python examples/19_how_sure_is_a_number.py
    python examples/19_how_sure_is_a_number.py --digits 30

A result comes with an estimate of its error: two runs are compared. `gt.prove` makes the number
again in ball arithmetic, where every rounding and every step is bounded, and says whether the
estimate holds. A Burgers vector next to the core of a dislocation, an orbit around a Kerr black
hole, and a pendulum that almost stands still at the top.
"""

import argparse
from dataclasses import replace

import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import SingularPointError


def show(title: str, proof: gt.Proof) -> None:
    """The certain digits, with the reported error and the proved one."""
    print(f"\n{title}\n{proof}")
    assert proof.holds


def main(arguments: list[str] | None = None) -> None:
    """Prove three results, and check them against what is known."""
    parser = argparse.ArgumentParser(description="Balls that contain the true value.")
    parser.add_argument("--digits", type=int, default=15)
    digits = parser.parse_args(arguments).digits

    # A circle that passes the core of a screw dislocation at a millionth of its radius.
    frame = gt.spaces.load("screw_dislocation").frame
    near = gt.Loop.circle([1, 0, 0], 1 + sp.Rational(1, 10**6))
    b = gt.burgers_vector(frame, near, parameters={"b": 1})
    show("Burgers vector, the core at 1e-6 of the radius", gt.prove(b, digits))

    # At 1e-15 the library refuses: doubles do not tell on which side the core is. Balls do, and the
    # vector does not depend on the distance.
    nearer = gt.Loop.circle([1, 0, 0], 1 + sp.Rational(1, 10**15))
    try:
        gt.burgers_vector(frame, nearer, parameters={"b": 1})
    except SingularPointError as refused:
        print(f"\nrefused: {refused}")
    proof = gt.prove(replace(b, loop=nearer), digits)
    show("The same at 1e-15", proof)
    # Known: the vector is that of the dislocation, of length one.
    assert proof.balls[2].contains(1)

    kerr = gt.spaces.load("kerr").frame
    orbit = gt.geodesic(
        kerr, [0, 8, 1.3, 0.2], [1.3, 0.05, 0.02, 0.05], parameters={"M": 1, "a": 0.9}
    )
    show("Orbit around a Kerr black hole, a = 0.9", gt.prove(gt.solve(orbit, 50.0), digits))

    # Started a billionth too slowly, the pendulum lingers at the top and falls back.
    slow = 2 - sp.Rational(1, 10**9)
    pendulum = gt.ODE.of({"x": "v", "v": "-sin(x)"}, [0, slow])
    proof = gt.prove(gt.solve(pendulum, 50.0), digits)
    show("Pendulum near its separatrix", proof)
    # Known: v**2/2 - cos(x) is kept. It starts from 1 - 2e-9 + 5e-19.
    x, v = proof.balls[-1]
    assert abs(v * v / 2 - x.cos() - (1 - 2e-9)) < 1e-14
    print("\nall errors hold")


if __name__ == "__main__":
    main()

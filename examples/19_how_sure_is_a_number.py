"""How sure is a number: three results, their error estimates, and proofs of both.

    python examples/19_how_sure_is_a_number.py
    python examples/19_how_sure_is_a_number.py --digits 30

Each result has an estimate of its error, from a comparison of two runs. `gt.prove` computes the
number again in ball arithmetic, which bounds each rounding and each step, and reports whether the
estimate holds. The results are a Burgers vector near the core of a dislocation, an orbit around a
Kerr black hole, and a pendulum that almost stops at the top.
"""

import argparse
from dataclasses import replace

import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import SingularPointError


def show(title: str, proof: gt.proofs.Proof) -> None:
    """Print the certain digits with the estimated and the proved error."""
    print(f"\n{title}\n{proof}")
    assert proof.holds


def main(arguments: list[str] | None = None) -> None:
    """Prove three results and check them against known values."""
    parser = argparse.ArgumentParser(description="Proofs with balls that contain the true value.")
    parser.add_argument("--digits", type=int, default=15)
    digits = parser.parse_args(arguments).digits

    # A circle that passes the core of a screw dislocation at a millionth of its radius.
    frame = gt.spaces.load("screw_dislocation").frame
    near = gt.Loop.circle([1, 0, 0], 1 + sp.Rational(1, 10**6))
    b = gt.burgers_vector(frame, near, parameters={"b": 1})
    show("Burgers vector, the core at 1e-6 of the radius", gt.prove(b, digits))

    # At 1e-15 the library refuses: doubles cannot decide on which side of the loop the core is.
    # Balls can, and the vector does not depend on the distance.
    nearer = gt.Loop.circle([1, 0, 0], 1 + sp.Rational(1, 10**15))
    try:
        gt.burgers_vector(frame, nearer, parameters={"b": 1})
    except SingularPointError as refused:
        print(f"\nrefused: {refused}")
    proof = gt.prove(replace(b, loop=nearer), digits)
    show("The same at 1e-15", proof)
    # Known: the vector is the Burgers vector of the dislocation, of length one.
    assert proof.balls[2].contains(1)

    kerr = gt.spaces.load("kerr").frame
    orbit = gt.geodesic(
        kerr, [0, 8, 1.3, 0.2], [1.3, 0.05, 0.02, 0.05], parameters={"M": 1, "a": 0.9}
    )
    show("Orbit around a Kerr black hole, a = 0.9", gt.prove(gt.solve(orbit, 50.0), digits))

    # Started a billionth too slowly, the pendulum stays long near the top and falls back.
    slow = 2 - sp.Rational(1, 10**9)
    pendulum = gt.ODE.of({"x": "v", "v": "-sin(x)"}, [0, slow])
    proof = gt.prove(gt.solve(pendulum, 50.0), digits)
    show("Pendulum near its separatrix", proof)
    # Known: v**2/2 - cos(x) is conserved. Its first value is 1 - 2e-9 + 5e-19.
    x, v = proof.balls[-1]
    assert abs(v * v / 2 - x.cos() - (1 - 2e-9)) < 1e-14
    print("\nall error estimates hold")


if __name__ == "__main__":
    main()

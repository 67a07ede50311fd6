"""A star that ends nowhere: values at infinity decide the numbers at the centre.

    python examples/35_a_star_that_ends_nowhere.py
    python examples/35_a_star_that_ends_nowhere.py --values 0.1,0.2,0.35

A boson star is a complex scalar field that holds itself together. It has no surface: its field
vanishes at infinity, which is so for a single value of the lapse at the centre. Shooting finds it.
The field is written as two real ones, phi(r) cos(t) and phi(r) sin(t), so that its frequency is
one; a lapse that is one at infinity gives the frequency in units of the mass. The heaviest star has
sqrt(4 pi G) phi(0) = 0.271, the mass 0.633 and the frequency 0.853 (Kaup 1968; Gleiser 1988).
A static black hole has no such field: the only one that is regular at the horizon and vanishes
at infinity is zero.
"""

import argparse
import math

import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity

T, R, THETA, PHI = sp.symbols("t r theta varphi")
A, B, H = (sp.Function(name)(R) for name in "ABh")
STATIC = gt.Frame([T, R, THETA, PHI], sp.diag(A, B, R, R * sp.sin(THETA)), signature=(-1, 1, 1, 1))
HOLE = sp.diag(A * sp.sqrt(H), 1 / sp.sqrt(H), R, R * sp.sin(THETA))
OUTPUTS = {"M": "r*(1 - 1/B**2)/2", "omega": "1/(A*B)"}


def star() -> gravity.Reduction:
    """The equations of a boson star, for units with 8 pi G = 1 and the frequency one."""
    waves = [
        gravity.scalar_field("phi(r)*cos(t)", name="c"),
        gravity.scalar_field("phi(r)*sin(t)", name="s"),
    ]
    lagrangian = "R/2 - (X + X_2)/2 - m**2*(c**2 + s**2)/2"
    return gravity.equations(gt.levi_civita(STATIC), lagrangian, waves).reduce("r")


def shot(reduced: gravity.Reduction, centre: float) -> gravity.Shooting:
    """The star with a value of sqrt(4 pi G) phi at its centre."""
    # The star without nodes has nearly this lapse; other guesses lead to stars with nodes.
    start = {"A": 1 - 0.72 * centre, "phi": centre * math.sqrt(2)}
    return gravity.shoot(
        reduced, "r", 25, start, {"m": 1}, near={"B": 1},
        free=["A"], boundary={"phi": 0}, outputs=OUTPUTS, accuracy=1e-8,
    )  # fmt: skip


def hair() -> float:
    """The field at the horizon of a static hole that vanishes far away, from a guess of 1/10."""
    frame = gt.Frame([T, R, THETA, PHI], HOLE, signature=(-1, 1, 1, 1))
    field = gravity.scalar_field("psi(r)", name="psi")
    equations = gravity.equations(gt.levi_civita(frame), "R/2 - X/2 - m**2*psi**2/2", field)
    start = {"A": 1, "h": 0, "psi": "1/10"}
    answer = gravity.shoot(
        equations, "r", 6, start, {"m": 1}, near={"h_1": 1}, origin=1,
        free=["psi"], boundary={"psi": 0}, accuracy=1e-8,
    )  # fmt: skip
    return answer.values["psi"]


def main(arguments: list[str] | None = None) -> None:
    """Boson stars of some values at the centre, and a hole without a field."""
    parser = argparse.ArgumentParser(description="A star that ends nowhere.")
    parser.add_argument("--values", default="0.15,0.271", help="of sqrt(4 pi G) phi at the centre")
    centres = [float(x) for x in parser.parse_args(arguments).values.split(",")]

    reduced = star()
    print(reduced, "\n")
    print("centre  lapse there           mass      frequency")
    for centre in centres:
        answer = shot(reduced, centre)
        mass, frequency = (float(answer.solution[name][-1]) for name in OUTPUTS)
        assert answer.solution["phi"].min() > -1e-6, "the star without nodes"
        lapse, error = answer.values["A"], answer.errors["A"]
        print(f"{centre:6.3f}  {lapse:.8f} +- {error:.0e}  {mass:.5f}  {frequency:.5f}")
        if centre == 0.271:
            assert abs(mass - 0.633) < 1e-3, "the published mass"
            assert abs(frequency - 0.853) < 1e-3, "the published frequency"

    field = hair()
    print(f"\nfield at the horizon of a static hole: {field:.1e}")
    assert abs(field) < 1e-6, "no black hole has scalar hair"


if __name__ == "__main__":
    main()

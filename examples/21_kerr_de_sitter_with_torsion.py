"""Kerr-de Sitter with torsion: a rotating black hole of Poincare gauge theory, with free symbols.

    python examples/21_kerr_de_sitter_with_torsion.py

McCrea, Baekler and Guerses (1987) found a black hole whose mass causes torsion. It solves the field
equations of a family of Lagrangians that are quadratic in torsion and curvature. Mass, spin,
cosmological constant and coupling constants stay symbols, and zero is proved. A wrong coupling
gives a result that is not zero. The irreducible parts show the kind of torsion and curvature.
"""

import argparse

import geomtorsion as gt
from geomtorsion import gravity

LAGRANGIAN = "a*(R - 2*Lambda) + {b}*(tensor2 - 2*vector2) + w*(P1 - P2 - P4) + p*P6"
# a + 2 b = 4 Lambda (w - p) / 3
SOLVED = "(2*Lambda*(w - p)/3 - a/2)"


def main(arguments: list[str] | None = None) -> None:
    """Check both field equations, with the right coupling and with a free one."""
    parser = argparse.ArgumentParser(description="Field equations with torsion and curvature.")
    parser.add_argument("--coupling", default=SOLVED, help="value of the coupling b")
    coupling = parser.parse_args(arguments).coupling

    space = gt.spaces.load("kerr_de_sitter_torsion")
    connection = space.connection
    assert connection is not None
    print(space.title)
    for name, part in connection.torsion.parts.items():
        print(f"torsion, {name} part: {'zero' if part.is_zero else 'not zero'}")
    for name, part in connection.curvature.parts.items():
        print(f"curvature, {name} part: {'zero' if part.is_zero else 'not zero'}")

    found = gravity.equations(connection, LAGRANGIAN.format(b=coupling))
    print(f"\nL = {found.lagrangian.expression}")
    print(f"E = 0: {found.E.is_zero}, {found.E.certainty}")
    print(f"C = 0: {found.C.is_zero}, {found.C.certainty}")

    free = gravity.equations(connection, LAGRANGIAN.format(b="b"))
    print(f"with b free: E = 0: {free.E.is_zero}, C = 0: {free.C.is_zero}")
    assert not free.E.is_zero
    assert not free.C.is_zero

    # Known: with the right coupling both vanish, and R of the metric is 4 Lambda.
    right = gravity.equations(connection, LAGRANGIAN.format(b=SOLVED))
    assert right.E.is_zero
    assert right.C.is_zero
    assert right.E.certainty.proved
    assert gt.levi_civita(space.frame).curvature.scalar == 4 * space.frame.parameters[-1]


if __name__ == "__main__":
    main()

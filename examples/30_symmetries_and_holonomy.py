"""Symmetries and holonomy: which groups belong to a space, and which to a connection.

    python examples/30_symmetries_and_holonomy.py
    python examples/30_symmetries_and_holonomy.py --space goedel

The symmetries of a metric form a Lie algebra; a loop turns vectors by an element of the holonomy
algebra. Both follow exactly from one point. With torsion a metric keeps its symmetries, but a
tetrad may keep fewer, and parallel legs have no holonomy at all.
"""

import argparse

import numpy as np
import sympy as sp

import geomtorsion as gt

SPACES = {
    "flat_polar": ("e(2)", "trivial"),
    "s2": ("so(3)", "so(2)"),
    "heisenberg": ("oscillator algebra", "so(3)"),
    "goedel": ("sl(2, R) + R^2", "sl(2, R)"),
    "schwarzschild": ("so(3) + R", "so(3, 1)"),
    "de_sitter": ("so(4, 1)", "so(3, 1)"),
}


def table() -> None:
    """Symmetries and holonomy of six spaces, with the Levi-Civita connection."""
    print(f"{'space':15} {'symmetries':25} holonomy")
    for name, expected in SPACES.items():
        symmetries = gt.symmetries(name).algebra
        holonomy = gt.levi_civita(name).holonomy_algebra
        print(f"{name:15} {symmetries.dimension:2} {symmetries.name:22} {holonomy.name}")
        assert (symmetries.name, holonomy.name) == expected


def legs() -> None:
    """A tetrad of a symmetric space need not be symmetric."""
    r, phi = sp.symbols("r phi", positive=True)
    polar = gt.Frame([r, phi], [[1, 0], [0, r]], name="polar legs")
    counts = [gt.symmetries(polar, keep).dimension for keep in ("metric", "teleparallel")]
    print(f"plane: {counts[0]} symmetries of the metric, {counts[1]} of the polar legs")
    assert counts == [3, 1]
    assert gt.cartan(polar).holonomy_algebra.name == "trivial"


def loop(space: str) -> float:
    """The rotation of a developed loop is the exponential of a sum of generators."""
    connection = gt.levi_civita(space)
    base = {q.name: 0.3 + 0.4 * k for k, q in enumerate(connection.frame.coordinates)}
    numbers = {p.name: 1.0 for p in connection.frame.parameters}
    corners = np.array([list(base.values())] * 4)
    corners[1:3, 0] += 0.2
    corners[2:4, 1] += 0.3
    turn = gt.develop(connection, gt.Loop.polygon(corners.tolist()), parameters=numbers).frank
    generators = connection.holonomy_algebra.generators
    rows = np.array([one.at(base | numbers).T.ravel() for one in generators])
    weights, *_ = np.linalg.lstsq(rows.T, turn.ravel(), rcond=None)
    gap = float(np.abs(rows.T @ weights - turn.ravel()).max())
    print(
        f"{space}: a loop turns vectors by {np.abs(turn).max():.4f}; outside the algebra {gap:.0e}"
    )
    return gap


def main(arguments: list[str] | None = None) -> None:
    """Show the table, a tetrad and a loop; each ends in an assertion."""
    parser = argparse.ArgumentParser(description="Symmetries and holonomy.")
    parser.add_argument("--space", default="goedel", help="the space of the loop")
    options = parser.parse_args(arguments)
    table()
    legs()
    assert loop(options.space) < 1e-8


if __name__ == "__main__":
    main()

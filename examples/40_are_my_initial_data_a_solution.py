"""Constraints of initial data: a slice of a hole as formulas, on a grid, and with a wrong factor.

    python examples/40_are_my_initial_data_a_solution.py
    python examples/40_are_my_initial_data_a_solution.py --picture constraints.png

The metric and the extrinsic curvature of a slice are initial data of a spacetime only if the
Hamiltonian and the momentum constraint vanish.
"""

import argparse
from pathlib import Path

import numpy as np

import geomtorsion as gt
from geomtorsion import gravity, pictures

IDENTITY = np.eye(3)[:, :, None, None, None]


def kerr_schild(nodes: int) -> tuple[gt.SampledFrame, np.ndarray]:
    """Metric and K_ij of the Kerr-Schild slice of a hole of mass 1."""
    axes = [np.linspace(1, 3, nodes)] * 3
    x = np.array(np.meshgrid(*axes, indexing="ij"))
    r = np.sqrt((x**2).sum(axis=0))
    ray = (x / r)[:, None] * (x / r)[None]
    metric = IDENTITY + 2 / r * ray
    curvature = 2 / r**2 / np.sqrt(1 + 2 / r) * (IDENTITY - (2 + 1 / r) * ray)
    return gt.SampledFrame.from_metric(axes, metric, unit="M"), curvature


def two_holes(nodes: int) -> gt.SampledFrame:
    """Two holes at rest (Brill and Lindquist 1963); spheres around the punctures are excised."""
    axes = [np.linspace(-2, 2, nodes), np.linspace(-2, 2, nodes), np.linspace(-3, 3, nodes)]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    one, two = (np.sqrt(x**2 + y**2 + (z - b) ** 2) for b in (1, -1))
    mask = (one < 0.6) | (two < 0.6)
    psi = 1 + 0.5 / np.maximum(one, 0.1) + 0.5 / np.maximum(two, 0.1)
    return gt.SampledFrame.from_metric(axes, IDENTITY * psi**4, mask=mask, unit="M")


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Are my initial data a solution?")
    parser.add_argument("--picture", type=Path, help="file for a figure")
    options = parser.parse_args(arguments)

    # Formulas: exact zeros, for a slice of a spacetime.
    slice_of_kerr = gt.surface("kerr", "r theta phi")
    assert gravity.constraints(slice_of_kerr).is_zero

    # A grid: residuals fall with the order of the differences, and are within their errors.
    for nodes in (15, 29):
        metric, curvature = kerr_schild(nodes)
        found = gravity.constraints(metric, curvature)
        print(found)
        assert found.is_solution
        assert found.residuals["hamiltonian"].order > 2.5

    # A wrong factor does not fall.
    wrong = gravity.constraints(metric, 1.1 * curvature)
    print(wrong)
    assert not wrong.is_solution
    assert abs(wrong.residuals["hamiltonian"].order) < 0.5

    holes = gravity.constraints(two_holes(31))
    print(holes)
    assert holes.is_solution
    if options.picture:
        pictures.save(pictures.draw_constraints(found), options.picture)


if __name__ == "__main__":
    main()

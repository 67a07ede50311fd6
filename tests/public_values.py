"""Public values: one value of each public class that `tests.copied` lacks, for tests of copies."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import geomtorsion as gt


def values() -> dict[str, Callable[[], Any]]:
    """Functions that make small values as in the README, by class."""
    so3, s2 = gt.spaces.load("so3").frame, gt.spaces.load("s2").frame
    motion = gt.ODE.of({"x": "-x"}, [1])
    solution = gt.solve(motion, 1.0)
    file = Path(tempfile.mkdtemp()) / "motion.npz"
    solution.save(file)
    corners, sides = [[1, 1, 2], [3, 1, 2], [3, 3, 2], [1, 3, 2]], [[0, 1], [1, 2], [2, 3], [3, 0]]
    box = gt.Box.of_bounds([0, 0, 0], [4, 4, 4])
    arrays = gt.LineArrays(corners, sides, [[0, 0, 1]] * 4, box)
    steel = gt.ElasticConstants.isotropic(80, 0.3, unit="GPa")
    line = np.linspace(-3, 3, 20)
    x, y = np.meshgrid(line, line, indexing="ij")
    jump = 0.286 / (2 * np.pi) * np.arctan2(y, x)
    points = np.random.default_rng(0).uniform(-3, 3, (200, 2))
    tracked = 0.286 / (2 * np.pi) * np.arctan2(points[:, 1], points[:, 0])
    rows, columns = np.mgrid[127:-1:-1, 0:128] - 63.5
    fringes = np.cos(2 * np.pi * columns / 8) + np.cos(2 * np.pi * rows / 8)
    picture = gt.LatticeImage(fringes, step=0.04, unit="nm")
    energy = "u1**2/2 + u2**2/2 + u3**2/2"
    scene = gt.scenes.load("dzhanibekov")
    wall = gt.OrientationMap.from_euler(np.zeros((6, 6, 3)), steps=0.5, phase="m-3m", threshold=10)
    problem = gt.geodesic(s2, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
    sites = np.argwhere(np.ones((6, 6, 6)))
    atoms = sites[sites.sum(axis=1) % 2 == 0] * 3.0
    return {
        "At": lambda: gt.At(0.5, {"x": 1}),
        "Atlas": lambda: problem.atlas,
        "Body": lambda: gt.Body(moments=(1, 2, 3)),
        "Box": lambda: box,
        "BurgersMap": lambda: gt.burgers_map(so3, [[0.2, 0.3], [1.0, 1.1]]),
        "Certainty": lambda: so3.metric.certainty,
        "Circuit": lambda: gt.Circuit.rectangle((0, 1), rows=2, columns=2),
        "ClosedOrbit": lambda: gt.closed_orbit(
            gt.ODE.of({"x": "x*(1-x**2-y**2)-y", "y": "y*(1-x**2-y**2)+x"}, [1.1, 0]), 6
        ),
        "Crossing": lambda: gt.poincare(gt.ODE.of({"x": "v", "v": "-x"}, [1, 0]), "x", 3),
        "Cochain": lambda: gt.Cochain.of_edges([[0, 1], [1, 0]], [[3, 0], [-3, 0]]),
        "Complex": lambda: gt.Complex.grid((4, 3)),
        "ComponentTable": lambda: so3.metric.table("abc"),
        "Integrability": lambda: gt.spaces.load("rolling_disc").own_connection().integrable,
        "ParallelVolume": lambda: gt.cartan(so3).transposed.volume,
        "CoordinateMap": lambda: gt.same_geometry("s3", "s3").map,
        "MappedPoint": lambda: gt.same.MappedPoint({"x": 1.0}, 1e-12),
        "Equivalence": lambda: gt.same_geometry("s3", "s3"),
        "Crystal": lambda: gt.crystals.Crystal(atoms, np.diag([18.0] * 3)),
        "Diffusion": lambda: gt.diffusion(gt.cartan(so3)),
        "DislocationNetwork": lambda: gt.DislocationNetwork.of_arrays(arrays),
        "DislocationSeries": lambda: gt.DislocationSeries(
            [0], [gt.DislocationNetwork.of_arrays(arrays)]
        ),
        "ElasticConstants": lambda: steel,
        "NyeField": lambda: gt.NyeField(np.zeros((3, 3, 4, 4, 4)), box, "um"),
        "Stresses": lambda: gt.stresses(gt.DislocationNetwork.of_arrays(arrays), steel, shape=8),
        "EffectBudget": lambda: scene.called_for(1e-2),
        "EquationsOfMotion": lambda: gt.equations_of_motion(so3, energy),
        "Fit": lambda: gt.fit(
            gt.ODE.of({"x": "k"}, [0], parameters={"k": 1}), [1, 2], {"x": [2.1, 3.9]}, 0.1, ["k"]
        ),
        "Form": lambda: gt.levi_civita(so3).curvature_form(),
        "FreeTop": lambda: gt.rigid.free_top((1, 2, 3), (0.1, 1, 0)),
        "Gravity": lambda: gt.effects.Gravity(9.81),
        "IdentityCheck": lambda: gt.identities(gt.cartan(s2))[0],
        "KerrOrbit": lambda: gt.spaces.kerr_orbit(0.9, 6, 0.3, 0.5),
        "Frequencies": lambda: gt.spaces.kerr_orbit(0.9, 6, 0.3, 0.5).frequencies,
        "Linearization": lambda: gt.linearized(so3, energy, at={"u1": 1}),
        "LatticeImage": lambda: picture,
        "LatticePhases": picture.phases,
        "LineArrays": lambda: arrays,
        "HolonomyAlgebra": lambda: gt.cartan(so3).holonomy_algebra,
        "Region": lambda: s2.region,
        "LieAlgebra": lambda: gt.LieAlgebra({(0, 1, 2): 1}),
        "LogMap": lambda: gt.log_map(
            gt.levi_civita(s2), [1.0, 0.0], [1.2, 0.3], parameters={"R": 1}
        ),
        "OrientationMap": lambda: wall,
        "Proof": lambda: gt.prove(solution),
        "RungeKutta": gt.RungeKutta,
        "SampledFrame": lambda: gt.SampledFrame.from_displacement(
            [line, line], jump[None], branch=0.286, unit="nm"
        ),
        "SavedSolution": lambda: gt.SavedSolution.load(file),
        "ScatteredFrame": lambda: gt.ScatteredFrame.from_displacement(
            points, tracked[None], branch=0.286, unit="nm"
        ),
        "Space": lambda: gt.spaces.load("so3"),
        "State": lambda: scene.start,
        "StateSelection": lambda: scene.selection,
        "Stiff": gt.Stiff,
        "Surface": lambda: gt.surface(so3, ["phi1", "phi2"]),
        "Symmetries": lambda: gt.symmetries(s2),
        "EndMap": lambda: gt.end_map(
            gt.ODE.of({"z": "v", "v": "-10"}, [1, 0], events=[gt.When("z")]),
            {"z": [1, 2], "v": [0, 1]},
            3.0,
        ),
        "Shadow": lambda: gt.shadow("schwarzschild", [0, 10, 1.5, 0], parameters={"M": 1}),
        "Table": lambda: gt.Table.of([(0, 1), (1, 3)]),
        "Taylor": gt.Taylor,
        "Variation": lambda: gt.variation(so3),
        "When": lambda: gt.When("x"),
    }

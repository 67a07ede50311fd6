"""Damaged files: each is read, or refused with the one error of its kind; none hangs."""

from __future__ import annotations

import json
from contextlib import suppress

import numpy as np
import pytest

from geomtorsion import scenes
from geomtorsion.errors import CheckpointError, FileFormatError, GeomtorsionError
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop
from geomtorsion.loops.loop_files import read_loops
from geomtorsion.materials.elasticity import ElasticConstants, NyeField, stresses
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.lines import Box, DislocationNetwork
from geomtorsion.ode import ODE, RungeKutta, SavedSolution, solve
from geomtorsion.scenes import SceneResult
from geomtorsion.scenes.checkpoint import partial_result
from tests.damage import campaign, spoilt_bytes, spoilt_json, spoilt_npz, spoilt_words
from tests.materials.lines.synthetic_networks import rings

PLANE = Frame("x y", [[1, 0], [0, 1]])
LOOPS = {
    "loops": [
        {"circle": {"centre": [0, 0], "radius": "pi/2", "plane": ["y", "x"]}, "name": "c"},
        {"ellipse": {"centre": ["1/2", 0], "axes": [2, 1]}, "times": -2},
        {"polygon": {"vertices": [[0, 0], [1, 0], [0, 1]], "centre": [5, 5], "size": 1e-9}},
        {"plaquette": {"corner": [0, 0], "steps": [1, 2], "plane": [[1, 0], [1, 1]]}},
        {"curve": {"expressions": ["cos(t)", "sin(t)"], "parameter": "t",
                   "interval": [0, "2*pi"]}},
        {"spline": {"points": [[1, 0], [0, 1], [-1, 0], [0, -1]]}},
    ],
    "parameters": {"R": "3/2", "b": 1},
    "accuracy": 1e-9,
}  # fmt: skip


class Grid:
    """A grid of a coframe."""

    name, error, spoil = "grid.npz", FileFormatError, staticmethod(spoilt_npz)

    @staticmethod
    def write(path):
        axes = [np.linspace(-1, 1, 7), np.linspace(0, 2, 8)]
        values = np.zeros((2, 2, 7, 8))
        values[0, 0] = values[1, 1] = 1
        SampledFrame(axes, values, names=("x", "y")).save(path)

    @staticmethod
    def read(path):
        SampledFrame.read(path).plaquettes()


class Nye:
    """A Nye field."""

    name, error, spoil = "nye.npz", FileFormatError, staticmethod(spoilt_npz)

    @staticmethod
    def write(path):
        values = np.random.default_rng(0).normal(size=(3, 3, 4, 5, 6))
        NyeField(values, Box.of_bounds([0, 0, 0], [1, 2, 3]), "um").save(path)

    @staticmethod
    def read(path):
        field = NyeField.read(path)
        # Damaged numbers may need an option; the file is valid then.
        with suppress(GeomtorsionError):
            _ = stresses(field, ElasticConstants.isotropic(1, 0.3), balance=True).energy


class Solution:
    """A saved solution, which can be integrated again."""

    name, error, spoil = "solution.npz", FileFormatError, staticmethod(spoilt_npz)

    @staticmethod
    def write(path):
        ode = ODE.of(
            {"x": "y*w", "y": "-x*w"}, [1, 0], parameters={"w": 1}, outputs={"p": "x*y"},
            invariants={"I": "x**2+y**2"},
        )  # fmt: skip
        solve(ode, [0.1, 0.2, 0.3], 1e-6, RungeKutta()).save(path)

    @staticmethod
    def read(path):
        saved = SavedSolution.load(path)
        assert len(saved) == len({name: saved[name] for name in saved})
        _ = saved.error, str(saved.problem)
        # Equations that the damage changed may be too hard; the file is valid then.
        with suppress(GeomtorsionError):
            saved.at(0.15)


class Result:
    """The result of a scene."""

    name, error, spoil = "result.npz", FileFormatError, staticmethod(spoilt_npz)

    @staticmethod
    def write(path):
        scene = scenes.load("lagrange_cusp").with_values(t=0.2, accuracy=1e-6)
        scene.run().save(path)

    @staticmethod
    def read(path):
        result = SceneResult.load(path)
        _ = str(result), result.columns(), result.complete, result.changes()


class Checkpointed:
    """The checkpoint of a solution."""

    name, error, spoil = "checkpoint.npz", CheckpointError, staticmethod(spoilt_npz)
    ode = ODE.of({"x": "y", "y": "-x"}, [1, 0])

    @classmethod
    def write(cls, path):
        solve(cls.ode, [0.1, 0.2], 1e-6, RungeKutta(), checkpoint=path)

    @classmethod
    def read(cls, path):
        solve(cls.ode, [0.1, 0.2], 1e-6, RungeKutta(), checkpoint=path)


class SceneCheckpoint:
    """The checkpoint of a scene."""

    name, error, spoil = "scene.npz", CheckpointError, staticmethod(spoilt_npz)
    scene = scenes.load("lagrange_cusp").with_values(t=0.1, accuracy=1e-6)

    @classmethod
    def write(cls, path):
        cls.scene.run(RungeKutta(), path)

    @classmethod
    def read(cls, path):
        str(partial_result(cls.scene, path, RungeKutta()))


class Loops:
    """Loops in JSON."""

    name, error = "loops.json", GeomtorsionError

    @staticmethod
    def spoil(whole, draw):
        if draw.random() < 0.3:
            return spoilt_bytes(whole, draw)
        return spoilt_json(whole.decode(), draw).encode()

    @staticmethod
    def write(path):
        path.write_text(json.dumps(LOOPS), "utf-8")

    @staticmethod
    def read(path):
        for loop in read_loops(PLANE, path).loops:
            _ = str(loop), loop.size


class Table(Loops):
    """Loops in CSV."""

    name = "loops.csv"

    @staticmethod
    def spoil(whole, draw):
        return spoilt_bytes(whole, draw)

    @staticmethod
    def write(path):
        path.write_text(
            "name,x,y,radius,plane\na,0,0,1,\nb,1/2,0,2,y x\nc,1,1,sqrt(2),0 1\n", "utf-8"
        )


class Lines:
    """A dislocation network: bytes spoilt, or words replaced, dropped, doubled and exchanged."""

    name, error = "lines.data", FileFormatError

    @staticmethod
    def spoil(whole, draw):
        return spoilt_bytes(whole, draw) if draw.random() < 0.4 else spoilt_words(whole, draw)

    @staticmethod
    def write(path):
        DislocationNetwork.of_arrays(rings(3, seed=1, sides=4)).save(path)

    @staticmethod
    def read(path):
        net = DislocationNetwork.read(path)
        _ = net.node_rule(), net.density, net.nye, net.families(), net.opendis()
        # The rest of a network may have no answer; the file is valid then.
        with suppress(GeomtorsionError):
            net.burgers(Loop.circle([5, 5, 5], 4))


KINDS = [Grid, Nye, Solution, Result, Checkpointed, SceneCheckpoint, Loops, Table, Lines]


def check(kind, folder, seeds):
    """Run a campaign over one kind of file; more than a third of the spoilt files are refused."""
    path = folder / kind.name
    kind.write(path)
    kind.read(path)
    refused, wrong = campaign(path, kind.spoil, kind.read, kind.error, seeds)
    assert not wrong, f"{len(wrong)} of {len(seeds)}:\n" + "\n".join(wrong[:20])
    assert refused > len(seeds) / 3


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_spoilt(kind, tmp_path):
    """Ten spoilt copies of each kind of file are read or refused."""
    check(kind, tmp_path, range(10))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_spoilt_often(kind, tmp_path):
    """Another 450 copies of each kind, 4,050 files in all, are read or refused."""
    check(kind, tmp_path, [*range(10, 60), *range(1000, 1400)])

"""Constraints are torsion: autoparallels of `constrained` are the motions of d'Alembert."""

from __future__ import annotations

import random

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt

NAMES = "v w x y z"
# Two runs at this accuracy, each to t = 1.
ACCURACY, CLOSE = 1e-12, 1e-11


def smooth(rng: random.Random, symbols: tuple[sp.Symbol, ...]) -> sp.Expr:
    """A smooth function of a coordinate."""
    one = rng.choice(symbols)
    return rng.choice([one, sp.sin(one), one**2]) / rng.choice([2, 3, 4])


def kinetic(rng: random.Random, symbols: tuple[sp.Symbol, ...]) -> sp.Matrix:
    """A positive metric: A^T A with ones on the diagonal of a triangular A."""
    n = len(symbols)
    root = sp.eye(n)
    i, j = sorted(rng.sample(range(n), 2))
    root[i, j] = smooth(rng, symbols)
    return root.T * root


def forms(rng: random.Random, symbols: tuple[sp.Symbol, ...], number: int) -> list[list[sp.Expr]]:
    """Independent one-forms: each is solved for a differential of its own."""
    n = len(symbols)
    solved = rng.sample(range(n), number)
    rows = []
    for place in solved:
        row = [sp.S.Zero] * n
        row[place] = sp.S.One
        for mu in rng.sample([k for k in range(n) if k not in solved], min(2, n - number)):
            row[mu] = smooth(rng, symbols)
        rows.append(row)
    return rows


def compared(seed: int, n: int, number: int) -> None:
    """Solve one random system in both ways."""
    rng = random.Random(seed)
    symbols = sp.symbols(NAMES, real=True)[-n:]
    metric, rows = kinetic(rng, symbols), forms(rng, symbols, number)
    height = smooth(rng, symbols)
    energy = gt.Frame.from_metric(symbols, metric.tolist())
    connection = gt.constrained(energy, rows)
    assert connection.metric_compatible is True
    start = [rng.randint(1, 9) / 10 for _ in symbols]
    permitted = n - number
    speeds = [rng.randint(-6, 6) / 10 for _ in range(permitted - 1)] + [0.5] + [0.0] * number
    problem = gt.autoparallel(connection, start, frame_velocity=speeds, potential=height)
    curve = gt.solve(problem, 1.0, ACCURACY)

    plain = gt.Frame(symbols, sp.eye(n).tolist())
    u = sp.Matrix(sp.symbols(f"u1:{n + 1}", real=True))
    equations = gt.equations_of_motion(
        plain,
        (u.T * metric * u)[0] / 2 - height,
        constraints=[sum(a * b for a, b in zip(row, u, strict=True)) for row in rows],
    )
    names = [symbol.name for symbol in symbols]
    rates = dict(zip((str(one) for one in u), curve.velocity[0], strict=True))
    moving = {symbol.name: rates[symbol.name] for symbol in equations.velocities}
    motion = gt.solve(
        gt.ODE.of(equations, dict(zip(names, start, strict=True)) | moving), 1.0, ACCURACY
    )
    ends = np.array([motion[name][-1] for name in names])
    assert np.abs(curve.at(1.0).coordinates - ends).max() < CLOSE
    assert np.abs(curve.frame_velocity[:, permitted:]).max() == 0.0
    assert curve.drift["energy"] < CLOSE


@pytest.mark.parametrize(("seed", "n", "number"), [(1, 3, 1), (5, 5, 2)])
def test_autoparallels_are_motions_under_constraints(seed, n, number):
    """Random metrics, potentials and constraints: the same path as from a Lagrangian."""
    compared(seed, n, number)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10, 40))
def test_many_autoparallels_are_motions_under_constraints(seed):
    """More random systems in three to five dimensions."""
    n = 3 + seed % 3
    compared(seed, n, 1 + seed % (n - 2))


@pytest.mark.parametrize("seed", range(4))
def test_gradients_are_integrable(seed):
    """Constraints df = 0: the torsion along the forbidden legs vanishes; x df + dz: it does not."""
    rng = random.Random(seed)
    symbols = sp.symbols("x y z", real=True)
    x, y, z = symbols
    energy = gt.Frame.from_metric(symbols, kinetic(rng, symbols).tolist())
    surface = z + smooth(rng, (x, y)) + x * y
    gradient = [sp.diff(surface, one) for one in symbols]
    assert bool(gt.constrained(energy, [gradient]).integrable)
    contact = gt.constrained(energy, [[y, 0, 1]]).integrable
    assert not contact
    assert list(contact.obstructions) == [(0, 1, 2)]


def test_free_body_leaves_the_constraint():
    """Without the constraint the sleigh goes elsewhere, so that the law above can fail."""
    symbols = sp.symbols("x y theta", real=True)
    theta = symbols[2]
    offset = sp.Rational(3, 10)
    metric = sp.Matrix(
        [
            [2, 0, -2 * offset * sp.sin(theta)],
            [0, 2, 2 * offset * sp.cos(theta)],
            [-2 * offset * sp.sin(theta), 2 * offset * sp.cos(theta), 1],
        ]
    )
    sleigh = gt.constrained(
        gt.Frame.from_metric(symbols, metric.tolist()), ["cos(theta)*dy - sin(theta)*dx"]
    )
    start, speeds = [0, 0, 0], [1.0, 2.0, 0.0]
    bound = gt.solve(gt.autoparallel(sleigh, start, frame_velocity=speeds), 5.0, 1e-10)
    free = gt.solve(gt.geodesic(sleigh, start, frame_velocity=speeds), 5.0, 1e-10)
    assert np.abs(bound.at(5.0).coordinates - free.at(5.0).coordinates).max() > 1

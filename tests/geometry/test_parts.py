"""Parts: they add up, are orthogonal, and have the right number of components."""

import random
from itertools import combinations, product

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from tests.gravity.samples import COORDINATES, sample_connection, sample_frame

Parts = dict[str, gt.Tensor]


def square(one: gt.Tensor, other: gt.Tensor) -> sp.Expr:
    """Full contraction of two tensors."""
    letters = "abcd"[: len(one.slots)]
    return gt.contract(f"{letters},{letters}->", one, other.raised())


def families(connection: gt.Connection) -> list[tuple[gt.Tensor, Parts]]:
    """Torsion, nonmetricity and curvature of a connection, each with its parts."""
    return [
        (connection.torsion.T.lowered(2), dict(connection.torsion.parts)),
        (connection.nonmetricity, dict(connection.nonmetricity_parts)),
        (connection.curvature.lower, dict(connection.curvature.parts)),
    ]


@pytest.mark.parametrize("metric", [True, False])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_parts_add_up_and_are_orthogonal(n: int, metric: bool) -> None:
    """The sum is the whole tensor, and the product of any two parts is zero."""
    connection = sample_connection(sample_frame(n, 1), 5, metric=metric)
    for whole, parts in families(connection):
        total, *others = parts.values()
        for part in others:
            total = total + part
        assert (total - whole).is_zero
        for one, two in combinations(parts.values(), 2):
            assert square(one, two).is_zero


def constant(n: int, kind: str, seed: int) -> gt.Connection:
    """Flat space with a connection whose field of one kind is random at the origin."""
    chosen = random.Random(seed)
    q = COORDINATES[:n]
    frame = gt.Frame(q, sp.eye(n), (-1,) + (1,) * (n - 1))
    omega = sp.MutableDenseNDimArray.zeros(n, n, n)
    signs = [-1] + [1] * (n - 1)
    if kind == "curvature":
        for a, i, j in product(range(n), repeat=3):
            if i < j:
                value = sum(chosen.randint(-9, 9) * x for x in q)
                omega[a, i, j], omega[a, j, i] = value * signs[j], -value * signs[i]
    else:
        for a, i, j in product(range(n), repeat=3):
            omega[a, i, j] = chosen.randint(-9, 9)
    return gt.from_spin_connection(frame, omega.tolist())


# Components of each part, by the dimension: as in the classification for n = 4.
RANKS = {
    ("torsion", 3): {"tensor": 5, "vector": 3, "axial": 1},
    ("torsion", 4): {"tensor": 16, "vector": 4, "axial": 4},
    ("torsion", 5): {"tensor": 35, "vector": 5, "axial": 10},
    ("nonmetricity", 3): {"symmetric": 7, "mixed": 5, "Lambda": 3, "Weyl": 3},
    ("nonmetricity", 4): {"symmetric": 16, "mixed": 16, "Lambda": 4, "Weyl": 4},
    ("nonmetricity", 5): {"symmetric": 30, "mixed": 35, "Lambda": 5, "Weyl": 5},
    ("curvature", 3): {"weyl": 0, "paircom": 0, "pseudoscalar": 0}
    | {"ricci": 5, "antiricci": 3, "scalar": 1},
    ("curvature", 4): {"weyl": 10, "paircom": 9, "pseudoscalar": 1}
    | {"ricci": 9, "antiricci": 6, "scalar": 1},
}  # fmt: skip


@pytest.mark.parametrize(("kind", "n"), RANKS)
def test_the_number_of_components(kind: str, n: int) -> None:
    """The rank of many random samples of a part is its dimension."""
    samples: dict[str, list] = {}
    most = sum(RANKS[kind, n].values()) + 2
    for seed in range(most):
        connection = constant(n, kind, seed)
        parts = {
            "torsion": lambda c: c.torsion.parts,
            "nonmetricity": lambda c: c.nonmetricity_parts,
            "curvature": lambda c: c.curvature.parts,
        }[kind](connection)
        origin = dict.fromkeys(connection.frame.coordinates, 0)
        for name, part in parts.items():
            samples.setdefault(name, []).append(part.at(origin).ravel())
    found = {}
    for name, rows in samples.items():
        found[name] = int(np.linalg.matrix_rank(np.array(rows)))
    assert found == RANKS[kind, n]


def test_traces_of_the_parts() -> None:
    """Only vector parts have traces; the weyl part of curvature has none."""
    connection = sample_connection(sample_frame(4, 1), 5, metric=False)
    tensor, axial = (connection.torsion.parts[name] for name in ("tensor", "axial"))
    for part in (tensor, axial):
        assert gt.contract("abb->a", part.raised(2)).is_zero
    vector = gt.contract("abb->a", connection.torsion.parts["vector"].raised(2))
    assert vector == connection.torsion.vector
    for name in ("weyl", "paircom", "pseudoscalar"):
        assert gt.contract("abca->bc", connection.curvature.parts[name].raised(3)).is_zero
    for name in ("symmetric", "mixed"):
        part = connection.nonmetricity_parts[name]
        assert gt.contract("abb->a", part.raised(2)).is_zero
        assert gt.contract("aab->b", part.raised(0)).is_zero


def test_parts_of_the_metric_are_those_that_are_known() -> None:
    """Without torsion only the Weyl, traceless Ricci and scalar parts remain."""
    bar = gt.levi_civita(sample_frame(4, 2))
    parts = bar.curvature.parts
    assert (parts["weyl"] - bar.curvature.weyl).is_zero
    assert [name for name, part in parts.items() if part.is_zero] == [
        *("paircom", "pseudoscalar", "antiricci"),
    ]
    flat = gt.cartan(sample_frame(4, 2))
    assert (flat.torsion.parts["tensor"] - flat.torsion.tensor).is_zero
    assert (flat.torsion.parts["axial"] - flat.torsion.axial).is_zero

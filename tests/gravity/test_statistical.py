"""Statistical: alpha-connections of the normal distributions, and refusals."""

from itertools import product

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from geomtorsion.gravity import statistical

m, s = sp.symbols("m s", positive=True)
alpha = sp.Symbol("alpha")
NORMAL = gt.Frame.from_metric([m, s], [[1 / s**2, 0], [0, 2 / s**2]])
CUBIC = [[[0, 2 / s**3], [2 / s**3, 0]], [[2 / s**3, 0], [0, 8 / s**3]]]


def test_normal_distributions() -> None:
    """Flat for alpha = 1 and -1; R = alpha^2 - 1, Q_abc = alpha C_abc, no torsion."""
    general = statistical(NORMAL, CUBIC)
    assert general.is_torsion_free
    assert general.curvature.scalar == alpha**2 - 1
    for a, b, c in product(range(2), repeat=3):
        assert general.nonmetricity[a, b, c] == alpha * CUBIC[a][b][c]
    assert statistical(NORMAL, CUBIC, 1).is_flat
    assert statistical(NORMAL, CUBIC, -1).is_flat
    assert statistical(NORMAL, CUBIC, 0).coefficients == gt.levi_civita(NORMAL).coefficients
    # Mixture type: mean and second moment are affine coordinates for alpha = -1.
    moments = statistical(NORMAL, CUBIC, -1)
    for function in (m, m**2 + s**2):
        slope = moments.covariant_derivative(gt.Form(NORMAL, 0, {(): function}).d.tensor)
        assert slope.is_zero


def test_duality() -> None:
    """d_a g_bc = Gamma(alpha)_abc + Gamma(-alpha)_acb."""
    one = statistical(NORMAL, CUBIC).coefficients.lowered(2)
    two = statistical(NORMAL, CUBIC, -alpha).coefficients.lowered(2)
    for a, b, c in product(range(2), repeat=3):
        slope = NORMAL.metric[b, c].diff((m, s)[a])
        assert sp.simplify(slope - one[a, b, c] - two[a, c, b]) == 0


def test_cubic_as_a_tensor() -> None:
    """The cubic form may be a tensor in either basis."""
    values = {i: CUBIC[i[0]][i[1]][i[2]] for i in product(range(2), repeat=3)}
    tensor = gt.Tensor(NORMAL, "ddd", values)
    found = statistical(NORMAL, tensor.in_frame(), "k")
    assert found.curvature.scalar == sp.Symbol("k") ** 2 - 1


REFUSALS = [
    (lambda: statistical(NORMAL, [[[0, 1], [0, 0]], [[0, 0], [0, 0]]]), "symmetric"),
    (lambda: statistical(NORMAL, [[0, 1], [0, 0]]), "2 entries"),
    (lambda: statistical(NORMAL, CUBIC, ()), "alpha"),  # pyright: ignore[reportArgumentType]
    (lambda: statistical(NORMAL, NORMAL.metric), "slots"),
    (lambda: statistical(CUBIC, CUBIC), "metric"),  # pyright: ignore[reportArgumentType]
]


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_anything_but_a_statistical_manifold_is_refused(call, words):
    """Each bad argument is refused with its own message."""
    with pytest.raises(GeomtorsionError, match=words):
        call()

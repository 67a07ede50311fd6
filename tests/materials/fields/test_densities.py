"""Densities: dislocations, disclinations and incompatibility against closed forms and scatter."""

from typing import Any

import numpy as np
import pytest

from geomtorsion.errors import GeomtorsionError, GridError
from geomtorsion.materials.fields import (
    Density,
    SampledFrame,
    defect_conservation,
    defect_densities,
)

LINE = np.linspace(-1, 1, 13)
AXES = [LINE, np.linspace(1, -1, 11), np.linspace(0, 1.5, 12)]
X, Y, Z = np.meshgrid(*AXES, indexing="ij")
ZERO = np.zeros((3, 3, *X.shape))
# Even permutations; all other entries of eps are their negatives or zero.
EPS = np.zeros((3, 3, 3))
for one, two, three in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    EPS[one, two, three], EPS[one, three, two] = 1, -1


def cubic(seed: int, rows: int = 3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Random cubic fields with their exact first and second derivatives."""
    c = np.random.default_rng(seed).normal(size=(rows, 3, 3, 3, 3))
    r = np.array([X, Y, Z])
    values = np.einsum("imabc,axyz,bxyz,cxyz->imxyz", c, r, r, r)
    s = c + np.moveaxis(c, (2, 3, 4), (3, 2, 4)) + np.moveaxis(c, (2, 3, 4), (4, 3, 2))
    first = np.einsum("imabc,bxyz,cxyz->imaxyz", s, r, r)
    t = s + s.swapaxes(3, 4)
    second = np.einsum("imabc,cxyz->imabxyz", t, r)
    return values, first, second


def test_incompatibility_of_a_polynomial_is_exact() -> None:
    """Cubic strains: fourth order is exact; the tensor is the double curl, and symmetric."""
    beta, _, second = cubic(1)
    strain = (second + second.swapaxes(0, 1)) / 2
    expected = np.einsum("kab,lcd,bdacxyz->klxyz", EPS, EPS, strain)
    eta = SampledFrame.from_distortion(AXES, beta).incompatibility
    assert np.abs(eta.values - expected).max() < 1e-10 * np.abs(expected).max()
    assert np.abs(eta.values - eta.values.swapaxes(0, 1)).max() < 1e-10


def test_a_displacement_has_no_densities() -> None:
    """The gradient of a displacement is compatible within its reported error."""
    # For u = sin(x + 2 y), cos(y z), exp(x - z).
    exact = np.array(
        [
            [np.cos(X + 2 * Y), 2 * np.cos(X + 2 * Y), 0 * X],
            [0 * X, -Z * np.sin(Y * Z), -Y * np.sin(Y * Z)],
            [np.exp(X - Z), 0 * X, -np.exp(X - Z)],
        ]
    )
    densities = defect_densities(SampledFrame.from_distortion(AXES, exact))
    assert densities.disclination is None
    for density in (densities.dislocation, densities.incompatibility):
        assert (np.abs(density.values) <= density.error).mean() > 0.98
        assert np.abs(density.values).max() < 0.2


def test_densities_of_a_coframe_are_its_nye_tensor() -> None:
    """Values and noise agree with the Nye tensor of the frame, also around a hole."""
    beta, _, _ = cubic(2)
    hole = np.abs(X) + np.abs(Y) + np.abs(Z - 0.7) < 0.5
    for mask in (None, hole):
        field = SampledFrame.from_distortion(AXES, beta, mask=mask, sigma=0.01)
        alpha = defect_densities(field).dislocation
        assert np.array_equal(np.isnan(alpha.values), np.isnan(field.nye))
        assert np.nanmax(np.abs(alpha.values - field.nye)) < 1e-9
        assert np.nanmax(np.abs(alpha.sigma - field.nye_noise)) < 1e-12


def test_many_holes_leave_exact_values_or_none() -> None:
    """With a third of the nodes masked, each known value of a quadratic field is exact."""
    c = np.random.default_rng(10).normal(size=(3, 3, 3, 3))
    c += c.swapaxes(2, 3)
    beta = np.einsum("imab,axyz,bxyz->imxyz", c, [X, Y, Z], [X, Y, Z])
    strain = c + c.swapaxes(0, 1)
    expected = np.einsum("kab,lcd,bdac->kl", EPS, EPS, strain)[..., None, None, None]
    mask = np.random.default_rng(11).random(X.shape) < 0.35
    eta = SampledFrame.from_distortion(AXES, beta, 2, mask=mask).incompatibility
    known = np.isfinite(eta.values)
    assert 100 < known.sum() < known.size / 4
    assert np.abs((eta.values - expected)[known]).max() < 1e-9


def test_strain_and_bend_give_the_densities_of_the_distortion() -> None:
    """With kappa = d w the strain and the bend have the Nye tensor of 1 + E + W, and theta = 0."""
    beta, first, _ = cubic(3)
    strain = (beta + beta.swapaxes(0, 1)) / 2
    # W_ij = -eps_ijm w_m, so that w_m = -eps_ijm W_ij / 2.
    kappa = -np.einsum("ijm,ijaxyz->maxyz", EPS, (first - first.swapaxes(0, 1)) / 2) / 2
    whole = SampledFrame.from_distortion(AXES, beta)
    parts = defect_densities(SampledFrame.from_distortion(AXES, strain), SampledFrame(AXES, kappa))
    assert parts.disclination is not None
    assert np.abs(parts.dislocation.values - whole.nye).max() < 1e-10
    assert np.abs(parts.disclination.values).max() < 1e-10
    assert np.abs(parts.incompatibility.values - whole.incompatibility.values).max() < 1e-9


def test_kroeners_relation_holds_for_an_incompatible_bend() -> None:
    """Eta is the symmetric part of the curl of alpha plus theta, for any strain and bend."""
    strain, kappa = (cubic(k)[0] for k in (4, 5))
    strain = (strain + strain.swapaxes(0, 1)) / 2
    densities = defect_densities(
        SampledFrame.from_distortion(AXES, strain), SampledFrame(AXES, kappa)
    )
    alpha, theta = densities.dislocation.values, densities.disclination
    assert theta is not None
    assert np.abs(theta.values).max() > 1
    curl = SampledFrame(AXES, alpha.swapaxes(0, 1)).nye.swapaxes(0, 1) + theta.values.swapaxes(0, 1)
    symmetric = (curl + curl.swapaxes(0, 1)) / 2
    assert np.abs(densities.incompatibility.values - symmetric).max() < 1e-8


def test_densities_of_strain_and_bend_are_conserved() -> None:
    """De Wit's laws are identities of computed densities, and fail without the disclinations."""
    strain, kappa = (cubic(k)[0] for k in (6, 7))
    strain = (strain + strain.swapaxes(0, 1)) / 2
    densities = defect_densities(
        SampledFrame.from_distortion(AXES, strain), SampledFrame(AXES, kappa)
    )
    assert densities.disclination is not None
    alpha = SampledFrame(AXES, densities.dislocation.values)
    theta = SampledFrame(AXES, densities.disclination.values)
    both, without = defect_conservation(alpha, theta), defect_conservation(alpha)
    assert both.disclination is not None
    assert np.abs(both.dislocation.values).max() < 1e-8
    assert np.abs(both.disclination.values).max() < 1e-8
    assert np.abs(without.dislocation.values).max() > 1


@pytest.mark.parametrize("periodic", [False, True])
def test_sigma_is_the_scatter(periodic: bool) -> None:
    """Over many noisy fields with correlated columns, the scatter of each density is its sigma."""
    rng = np.random.default_rng(8)
    root = rng.normal(size=(9, 9)) / 3
    shape = (5, 6, 5)
    axes = [np.arange(float(n)) for n in shape]

    def densities(covariance: np.ndarray | None = None) -> list[Density]:
        fields = [
            SampledFrame(axes, x.reshape(3, 3, *shape), 2, periodic=periodic, covariance=covariance)
            for x in np.einsum("pq,nqxyz->npxyz", root, rng.normal(size=(2, 9, *shape)))
        ]
        result = defect_densities(*fields)
        assert result.disclination is not None
        law = defect_conservation(*fields).dislocation
        return [result.dislocation, result.disclination, result.incompatibility, law]

    sigmas = [density.sigma for density in densities(root @ root.T)]
    count = 40
    rows = [[density.values for density in densities()] for _ in range(count)]
    for values, sigma in zip(zip(*rows, strict=True), sigmas, strict=True):
        ratio = np.sqrt(np.mean(np.square(values), axis=0)) / sigma
        # The scatter of 40 fields has a relative error of 11 percent at each node.
        assert ratio.mean() == pytest.approx(1, abs=0.03)
        assert np.abs(ratio - 1).max() < 5 / np.sqrt(2 * count)


def test_conservation_reports_lines_that_end() -> None:
    """Pure noise gives a mismatch near 1; lines that end inside exceed it, at their ends."""
    rng = np.random.default_rng(9)
    noise = 0.01 * rng.normal(size=ZERO.shape)
    # Two stencils also differ by chance, which the error counts, so that it is a little large.
    assert 0.75 < defect_conservation(SampledFrame(AXES, noise, sigma=0.01)).mismatch < 1.05
    ended = noise.copy()
    ended[1, 2] += 1 / (1 + np.exp(-8 * (Z - 0.75)))
    law = defect_conservation(SampledFrame(AXES, ended, sigma=0.01))
    assert law.mismatch > 2
    assert law.worst[0] == 1
    assert abs(AXES[2][law.worst[3]] - 0.75) < 0.3
    assert repr(law).startswith("DefectConservation(mismatch ")


def test_a_plane_grid_has_one_component() -> None:
    """A disclination of the plane: strain and bend on a map of two axes, with three rows."""
    x, y = np.meshgrid(LINE, LINE, indexing="ij")
    strain, kappa = np.zeros((2, 3, 3, *x.shape))
    strain[0, 0], kappa[2, 1], kappa[0, 0] = y**2, x, y
    densities = defect_densities(
        SampledFrame.from_distortion([LINE, LINE], strain), SampledFrame([LINE, LINE], kappa)
    )
    assert densities.disclination is not None
    assert densities.incompatibility.values == pytest.approx(np.full((1, 1, 13, 13), 2.0))
    assert densities.disclination.values[2, 0] == pytest.approx(np.ones(x.shape))
    assert densities.dislocation.values[0, 0] == pytest.approx(-2 * y)
    assert densities.dislocation.values[1, 0] == pytest.approx(-x)
    assert densities.dislocation.values[2, 0] == pytest.approx(y)


FIELD = SampledFrame.from_distortion(AXES, ZERO)
NO_FIELD: Any = "bend"
PLANE = SampledFrame([LINE, LINE], np.zeros((2, 2, 13, 13)))
REFUSALS = (
    (lambda: SampledFrame([LINE] * 2, np.zeros((1, 2, 13, 13))).incompatibility, "expected 2 rows"),
    (lambda: defect_conservation(PLANE), "expected 3 rows on a grid of three axes, got 2 rows"),
    (lambda: defect_densities(PLANE, PLANE), "expected 3 rows or more"),
    (lambda: defect_densities(FIELD, SampledFrame([LINE] * 3, np.zeros((3, 3, 13, 13, 13)))),
     "expected the same nodes"),
    (lambda: defect_conservation(FIELD, SampledFrame([x + 0.1 for x in AXES], ZERO)),
     "expected the same nodes"),
    (lambda: defect_densities(FIELD, NO_FIELD), "bend"),
    (lambda: SampledFrame.from_displacement([LINE] * 2, np.zeros((2, 13, 13))).incompatibility,
     "differences of a displacement"),
    (lambda: SampledFrame([np.arange(5.0)] * 4, np.zeros((4, 4, 5, 5, 5, 5)), 2).incompatibility,
     "two or three axes"),
)  # fmt: skip


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_refusals(call, words) -> None:
    """Fields that do not fit are refused with the reason."""
    with pytest.raises(GeomtorsionError, match=words):
        call()


def test_a_large_grid_is_refused_before_memory_is_used() -> None:
    """A million nodes in three dimensions need too much memory for second derivatives."""
    axes = [np.arange(101.0)] * 3
    with pytest.raises(GeomtorsionError, match=r"stencils of 1,030,301 nodes .*smaller part"):
        _ = SampledFrame(axes, np.zeros((3, 3, 101, 101, 101))).incompatibility


def test_errors_are_of_the_grid() -> None:
    """A refusal of a field is a GridError."""
    with pytest.raises(GridError):
        defect_conservation(PLANE)

"""Symmetry: groups against scipy's, disorientations against a search over all variants."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from geomtorsion.errors import OrientationError
from geomtorsion.materials.maps import LAUE_GROUPS, laue_group

# Schoenflies names of the groups that scipy has; their axis is z.
SCIPY = {
    "-1": "C1", "mmm": "D2", "4/m": "C4", "4/mmm": "D4", "-3": "C3", "-3m": "D3", "6/m": "C6",
    "6/mmm": "D6", "m-3": "T", "m-3m": "O",
}  # fmt: skip


def scalar_last(q):
    """Quaternions in scipy's order of components."""
    return Rotation.from_quat(np.roll(q, -1, axis=-1))


def random_quaternions(count, seed):
    return np.roll(Rotation.random(count, rng=np.random.default_rng(seed)).as_quat(), 1, axis=-1)


@pytest.mark.parametrize("name", sorted(SCIPY))
def test_groups_agree_with_scipy(name):
    """The same rotations, generated from at most two generators."""
    ours = laue_group(name).quaternions
    theirs = np.roll(Rotation.create_group(SCIPY[name]).as_quat(), 1, axis=-1)
    assert len(ours) == len(theirs)
    assert np.abs(ours @ theirs.T).max(axis=1).min() > 1 - 1e-12


def test_monoclinic_turns_about_b():
    """The unique axis of 2/m is y."""
    assert abs(laue_group("2/m").quaternions[1]).round(12).tolist() == [0, 0, 1, 0]


def test_horizontal_axis_of_trigonal_crystals():
    """The two-fold axis of -3m is along x or y, as requested."""
    for axis, k in (("x", 1), ("y", 2)):
        halves = laue_group("-3m", axis).quaternions
        assert np.abs(halves[:, k]).max() == pytest.approx(1)
        assert np.abs(halves[:, 3 - k]).max() < 0.9


@pytest.mark.parametrize("name", LAUE_GROUPS)
def test_disorientation_is_the_smallest_of_all(name):
    """The disorientation is the least over all variants, symmetric, and the same for each."""
    group = laue_group(name)
    p, q = random_quaternions(40, 1), random_quaternions(40, 2)
    found = group.disorientation(p, q)
    variants = scalar_last(group.quaternions)
    s, t = np.indices((len(variants), len(variants))).reshape(2, -1)
    for k in range(len(p)):
        one, other = scalar_last(p[k]), scalar_last(q[k])
        angles = ((one * variants[s]).inv() * (other * variants[t])).magnitude()
        assert 2 * np.arccos(min(found[k, 0], 1)) == pytest.approx(min(angles), abs=1e-7)
    assert group.disorientation(q, p) == pytest.approx(found, abs=1e-9)
    rng = np.random.default_rng(3)
    chosen = rng.integers(len(group.quaternions), size=(2, len(p)))
    moved = [
        np.roll((scalar_last(a) * variants[list(n)]).as_quat(), 1, axis=-1)
        for a, n in zip((p, q), chosen, strict=True)
    ]
    assert group.disorientation(*moved) == pytest.approx(found, abs=1e-9)


def test_cubic_axes_are_in_the_standard_triangle():
    """Components satisfy z >= x >= y >= 0; no angle exceeds 62.8 degrees (Mackenzie 1958)."""
    found = laue_group("m-3m").disorientation(
        random_quaternions(2000, 4), random_quaternions(2000, 5)
    )
    _, x, y, z = found.T
    assert (y >= -1e-12).all()
    assert (x >= y - 1e-12).all()
    assert (z >= x - 1e-12).all()
    assert 60 < np.degrees(2 * np.arccos(found[:, 0].min())) <= 62.8


def test_unknown_group():
    """The message lists the known groups."""
    with pytest.raises(OrientationError, match="a known name, got 'm3m'.*m-3m"):
        laue_group("m3m")

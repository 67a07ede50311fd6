"""The lists of zeros and near-zeros themselves are right, checked by mpmath only."""

import mpmath
import pytest

from tests.exact import deep_zeros, hard_zeros, near_zeros
from tests.exact.symbols import number

ZEROS = {
    f"{group}: {label}": e
    for group, cases in (
        *hard_zeros.REAL_GROUPS.items(),
        ("complex", hard_zeros.COMPLEX),
        ("deep", deep_zeros.DEEP),
    )
    for label, e in cases.items()
}
NEAR = {
    f"{group}: {label}": e
    for group, cases in (*near_zeros.REAL_GROUPS.items(), ("complex", near_zeros.COMPLEX))
    for label, e in cases.items()
}


@pytest.mark.parametrize("label", ZEROS)
def test_zeros_vanish(label):
    """Every listed zero is below 1e-100 at the point."""
    with mpmath.workdps(200):
        assert abs(number(ZEROS[label], digits=200)) < mpmath.mpf(10) ** -100


@pytest.mark.parametrize("label", NEAR)
def test_near_zeros_do_not_vanish(label):
    """Every listed near-zero is above 1e-310 at the point, with 400 digits carried."""
    with mpmath.workdps(400):
        assert abs(number(NEAR[label], digits=400)) > mpmath.mpf(10) ** -310


def test_there_are_enough():
    """At least 80 zeros (besides the deep ones) and 50 near-zeros."""
    assert len(ZEROS) - len(deep_zeros.DEEP) >= 80
    assert len(NEAR) >= 50

"""Translations: each symbol of another source equals its counterpart here."""

from dataclasses import replace

import pytest

import geomtorsion as gt
from geomtorsion import gravity as g
from tests.gravity.samples import sample_connection, sample_frame


@pytest.mark.parametrize("row", g.translations(), ids=str)
@pytest.mark.parametrize("n", [3, 4])
def test_each_line_is_true(row: g.Translation, n: int) -> None:
    """Each line holds with torsion and curvature, and for parallel legs."""
    frame = sample_frame(n, 1)
    for connection in (sample_connection(frame, 2, metric=True), gt.cartan(frame)):
        assert row.holds(connection)
    bent = sample_connection(frame, 2, metric=False)
    assert row.holds(bent) is not row.here.endswith("for a metric connection")


def test_a_wrong_line_is_noticed() -> None:
    """With a sign changed each line is false, because its value on the sample does not vanish."""
    connection = sample_connection(sample_frame(3, 1), 2, metric=False)
    for row in g.translations():
        turned = replace(row, own_value=lambda c, row=row: -row.own_value(c))
        assert not turned.holds(connection), str(row)

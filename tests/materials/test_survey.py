"""Surveys: tables, numbers and units."""

import csv

import numpy as np
import pytest

from geomtorsion.materials.fields import SampledFrame
from tests.materials.fields.test_sampled_source import field


def test_tables_omit_unknown_circuits(tmp_path):
    """Tables omit unknown circuits, and values read back as the same doubles."""
    mask = np.zeros((11, 13), dtype=bool)
    mask[5, 6] = True
    survey = field(mask=mask, sigma=0.01).burgers_map(1, widen=False)
    survey.write_table(tmp_path / "t.csv")
    rows = list(csv.DictReader((tmp_path / "t.csv").read_text().splitlines()[3:]))
    assert len(rows) == 10 * 12 - 4
    assert float(rows[0]["b1"]) == survey.vectors[1, 0, 0]
    assert float(rows[0]["significance"]) == survey.significance[0, 0]
    assert "layer" not in rows[0]


def test_tables_name_layers(tmp_path):
    """A table of three axes names the layer of each circuit."""
    axes = [np.arange(6.0)] * 3
    x, _, z = np.meshgrid(*axes, indexing="ij")
    cube = SampledFrame(axes, np.array([[0 * x, x * z, 0 * x]]), sigma=0.01)
    cube.burgers_map(1).write_table(tmp_path / "t.csv")
    rows = list(csv.DictReader((tmp_path / "t.csv").read_text().splitlines()[3:]))
    assert {row["layer"] for row in rows} == {f"z = {k}" for k in range(6)}
    found = cube.burgers_map(1).summary()
    assert found["layer"] == "z = 5"
    assert found["largest"] == pytest.approx(5.0)


def test_surveys_without_known_circuits_can_be_written(tmp_path):
    """A survey without known circuits has no largest value, and can be written."""
    mask = np.zeros((11, 13), dtype=bool)
    mask[::2, ::2] = True
    survey = field(mask=mask, sigma=0.1, order=2).burgers_map(3)
    assert survey.summary()["known"] == 0
    assert survey.summary()["largest"] is None
    survey.write_arrays(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as arrays:
        assert not arrays["known"].any()


@pytest.mark.parametrize(
    ("unit", "other", "expected"), [("nm", "", "1/nm"), ("um", "nm", "nm/um^2"), ("", "", "")]
)
def test_units_of_the_density(unit, other, expected):
    """The unit of the density is b per area."""
    assert field(sigma=0.1, unit=unit, vector_unit=other).burgers_map(1).density_unit == expected

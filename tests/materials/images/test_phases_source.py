"""Phases of an image as a source."""

import numpy as np
import pytest

from geomtorsion.errors import ImageError
from geomtorsion.loops import Loop
from geomtorsion.materials.images import LatticePhases
from geomtorsion.materials.readers import open_source
from tests.materials.images.atoms import crystal

IMAGE = crystal(256, "square", turned=0.0)
STEP = 0.05


@pytest.fixture(scope="module")
def field(tmp_path_factory) -> LatticePhases:
    """Atoms 0.4 nm apart with an edge dislocation, and noise of half an atom's peak."""
    path = tmp_path_factory.mktemp("images") / "atoms.npy"
    np.save(path, IMAGE.noisy(0.5, 1))
    found = open_source(path, pixel=(STEP, "nm"))
    assert isinstance(found, LatticePhases)
    return found


def test_a_circuit_has_whole_numbers(field):
    """b is minus the integral of du, 0.4 nm; beside the core it is zero."""
    middle = [STEP * x for x in IMAGE.centre]
    found = field.burgers(Loop.circle(middle, 3.0))
    assert found.facts["whole"] == [-1, 0]
    assert found.vector == pytest.approx([-0.4, 0], abs=4e-3)
    assert found.is_significant
    assert found.area == pytest.approx(np.pi * 9, rel=0.02)
    beside = field.burgers(Loop.circle([3.0, 3.0], 2.0))
    assert (beside.magnitude, beside.is_significant) == (0, False)
    assert "0.4" in field.description[1]


def test_a_survey_holds_the_dislocation_where_it_is(field):
    """Squares around the core have b, others have zero, and squares that touch it are unknown."""
    survey = field.burgers_map(40)
    assert survey.density_unit == "1/nm"
    places = np.argwhere(survey.significant & survey.known)
    assert len(places) > 100
    far = [abs(survey.lines[k][places[:, k]] - STEP * IMAGE.centre[k]).max() for k in (0, 1)]
    assert max(far) < 20 * STEP
    sizes = np.linalg.norm(survey.vectors, axis=0)
    inside = sizes[survey.significant & survey.known]
    assert inside == pytest.approx(0.4, rel=0.01)
    outside = survey.known & ~survey.significant
    assert (sizes[outside] > 0.2).sum() < 0.02 * outside.sum()
    assert not survey.known.all()
    for plane in ((1, 0), 1):
        with pytest.raises(ImageError, match="the only plane of an image, got"):
            field.burgers_map(4, plane)


def test_the_backdrop_is_the_image(field):
    """The backdrop has grey values with x to the right and y upwards."""
    backdrop = field.backdrop()
    assert backdrop.kind == "image"
    assert (backdrop.values == IMAGE.noisy(0.5, 1)[::-1].T).all()

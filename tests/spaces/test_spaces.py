"""What every shipped space must be: told in two lines, sourced, and sampled inside its domain."""

import numpy as np
import pytest
import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.spaces import load, names, titles
from geomtorsion.spaces.space import KnownAnswer


@pytest.mark.parametrize("name", names())
def test_a_space_tells_its_story(name: str) -> None:
    """Name, title, two lines of story, a source, a shelf, known answers with sound indices."""
    space = load(name)
    assert space.name == name == space.frame.name
    assert space.title == titles()[name]
    lines = space.story.splitlines()
    assert len(lines) == 2
    assert all(20 < len(line) <= 90 for line in lines)
    assert len(space.source) > 15
    assert space.group
    assert len(space.known) >= 3
    for answer in space.known:
        assert answer.basis in ("coordinate", "frame", "natural")
        if isinstance(answer.components, dict):
            sizes = {len(index) for index in answer.components}
            assert len(sizes) <= 1
            assert all(0 <= k < space.frame.dimension for index in answer.components for k in index)


@pytest.mark.parametrize("name", names())
def test_the_sample_point_is_in_the_domain(name: str) -> None:
    """A point with all coordinates and parameters, inside the domain, frame regular and finite."""
    frame = load(name).frame
    point = frame.sample_point
    assert set(point) >= {*frame.coordinates, *frame.parameters}
    for relation in frame.domain:
        assert relation.subs(point) == sp.true
    for symbol in frame.parameters:
        if symbol.is_positive:
            assert point[symbol] > 0
    size = frame.determinant[()]
    values = dict.fromkeys(size.atoms(AppliedUndef), 1)
    assert abs(complex(size.subs(values).subs(point))) > 1e-12


@pytest.mark.parametrize("name", names())
def test_parameters_are_declared_with_assumptions(name: str) -> None:
    """Coordinates and parameters are real, and parameters of the shipped spaces say so."""
    frame = load(name).frame
    assert all(symbol.is_real for symbol in (*frame.coordinates, *frame.parameters))


def test_signature_of_gravity() -> None:
    """Spaces of gravity have signature (-, +, +, +), in the null tetrad as well."""
    found = 0
    for name in names():
        space = load(name)
        if space.group != "gravity":
            continue
        found += 1
        # The metric is real even where the legs are not.
        functions = dict.fromkeys(space.frame.determinant[()].atoms(AppliedUndef), 1)
        metric = space.frame.metric.at({**space.frame.sample_point, **functions})
        signs = np.sign(np.linalg.eigvalsh(metric))
        assert signs.tolist() == [-1, 1, 1, 1], name
        assert "Signature (-, +, +, +)" in space.notes, name
    assert found >= 8


def test_an_answer_knows_whether_it_says_zero() -> None:
    """Only a complete, empty listing says that a quantity vanishes."""
    assert KnownAnswer("ricci", {}).vanishes
    assert KnownAnswer("scalar_curvature", 0).vanishes
    assert not KnownAnswer("ricci", {}, complete=False).vanishes
    assert not KnownAnswer("ricci", {(0, 0): 1}).vanishes

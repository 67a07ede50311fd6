"""Requirements of every shipped space: two lines of story, a source, a sample in its domain."""

import numpy as np
import pytest
import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.spaces import load, names, titles
from geomtorsion.spaces.space import KnownAnswer


@pytest.mark.parametrize("name", names())
def test_a_space_has_its_description(name: str) -> None:
    """Name, title, two lines of story, a source, a group, known answers with sound indices."""
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
    """A point with all coordinates and parameters is in the domain, with a regular frame."""
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


# A point that belongs to the space, one that does not (or None), and parameters.
REACH = {
    "so3_rodrigues": ({"g1": 9, "g2": -7, "g3": 4}, None, {}),
    "s7": (dict.fromkeys([f"x{k}" for k in range(1, 8)], -5), None, {}),
    "screw_dislocation": ({"x": -3, "y": 40}, {"x": 0, "y": 0}, {}),
    "edge_dislocation": ({"x": -30, "y": 5}, {"x": 0, "y": sp.Rational(1, 10)}, {"b": 1}),
    "edge_dislocation_elastic": ({"x": -30, "y": 5}, {"x": 0, "y": 0}, {"nu": sp.Rational(1, 3)}),
    "wedge_disclination": ({"r": 1, "phi": 50}, {"r": -1, "phi": 50}, {}),
    "schwarzschild_isotropic": (
        {"x": -1, "y": 0, "z": 0},
        {"x": sp.Rational(1, 5), "y": 0, "z": 0},
        {"M": 1},
    ),
    "so3_quaternion": (
        {"q1": sp.Rational(9, 10), "q2": 0, "q3": 0},
        {"q1": sp.Rational(9, 10), "q2": sp.Rational(-1, 2), "q3": 0},
        {},
    ),
    "kerr": (
        {"r": sp.Rational(3, 2), "theta": 1, "phi": 1},
        {"r": sp.Rational(7, 5), "theta": 1, "phi": 1},
        {"M": 1, "a": sp.Rational(9, 10)},
    ),
    "frw": (
        {"r": 1, "theta": 1, "phi": 1},
        {"r": 2, "theta": 1, "phi": 1},
        {"k": sp.Rational(1, 2)},
    ),
}


@pytest.mark.parametrize("name", REACH)
def test_the_domain_is_where_the_space_is(name: str) -> None:
    """The domain contains only the regular points on this side of the edge; it is not a box."""
    inside, outside, numbers = REACH[name]
    frame = load(name).frame
    by_name = {symbol.name: symbol for symbol in (*frame.coordinates, *frame.parameters)}
    for place, wanted in ((inside, True), (outside, False)):
        if place is not None:
            point = {by_name[key]: value for key, value in {**place, **numbers}.items()}
            values = [relation.subs(point) for relation in frame.domain]
            assert all(value in (sp.true, sp.false) for value in values)
            assert all(values) is wanted


@pytest.mark.parametrize("name", names())
def test_parameters_are_declared_with_assumptions(name: str) -> None:
    """Coordinates and parameters of the shipped spaces are declared real."""
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
        unknown = space.frame.metric.to_sympy().atoms(AppliedUndef)
        functions = dict.fromkeys(unknown, 1)
        metric = space.frame.metric.at({**space.frame.sample_point, **functions})
        signs = np.sign(np.linalg.eigvalsh(metric))
        assert signs.tolist() == [-1, 1, 1, 1], name
        assert "Signature (-, +, +, +)" in space.notes, name
    assert found >= 8


def test_only_complete_empty_answers_are_zero() -> None:
    """Only a complete, empty listing states that a quantity vanishes."""
    assert KnownAnswer("ricci", {}).vanishes
    assert KnownAnswer("scalar_curvature", 0).vanishes
    assert not KnownAnswer("ricci", {}, complete=False).vanishes
    assert not KnownAnswer("ricci", {(0, 0): 1}).vanishes

"""Embeddings: the drawn surface is the space, checked against its coframe by differences."""

from dataclasses import replace

import numpy as np
import pytest

from geomtorsion.errors import CoordinateError
from geomtorsion.geometry import Frame
from geomtorsion.spaces import load, names, read_file, titles
from geomtorsion.spaces.registry import embedding_of
from tests.rounding import ROUNDED

STEP = 1e-6
SPACE_FIXED = ("so3_right",)
DRAWN = [name for name in names() if load(name).embedding is not None]


def at_sample(name):
    """Embedding, sample point, parameters, and the coframe there."""
    frame = load(name).frame
    embedding = embedding_of(frame)
    assert embedding is not None
    values = {symbol.name: float(value) for symbol, value in frame.sample_point.items()}
    point = np.array([values[symbol.name] for symbol in frame.coordinates])
    return embedding, point, values, np.real(frame.coframe.at(values))


def slopes(function, point, values):
    """Central differences of a function of points, one entry for each coordinate."""
    steps = STEP * np.eye(len(point))
    ahead, behind = function(point + steps, values), function(point - steps, values)
    return (ahead - behind) / (2 * STEP)


@pytest.mark.parametrize("name", [n for n in DRAWN if n.startswith(("so3", "r3xso3"))])
def test_attitudes_turn_as_the_coframe(name):
    """R is a rotation, and its angular velocity is the coframe: R^T dR, or dR R^T in space."""
    embedding, point, values, coframe = at_sample(name)
    turn = embedding.attitudes(point[None], values)[0]
    # Differences are good to about 1e-9.
    assert np.allclose(turn @ turn.T, np.eye(3), atol=ROUNDED)
    assert np.linalg.det(turn) == pytest.approx(1)
    for k, rate in enumerate(slopes(embedding.attitudes, point, values)):
        spin = rate @ turn.T if name in SPACE_FIXED else turn.T @ rate
        assert [spin[2, 1], spin[0, 2], spin[1, 0]] == pytest.approx(coframe[:3, k], abs=1e-8)


# The scale of frw is an unknown function: nothing is claimed, nothing can be checked.
@pytest.mark.parametrize("name", sorted(set(DRAWN) - {"frw"}))
def test_isometric_means_isometric(name):
    """An embedding has the lengths of the metric exactly where it is marked as isometric."""
    embedding, point, values, coframe = at_sample(name)
    if not embedding.place:
        return
    rows = slopes(embedding.places, point, values)
    metric = coframe.T @ coframe
    if name == "r3xso3":
        # Only the position is drawn in space; attitudes are drawn on the globe.
        rows, metric = rows[3:], metric[3:, 3:]
    assert np.allclose(rows @ rows.T, metric, atol=1e-8) == embedding.isometric


def test_a_name_is_not_enough():
    """A frame that is only named s2 is not drawn on a sphere."""
    frame = load("s2").frame
    impostor = Frame(frame.coordinates, [[1, 0], [0, 1]], name="s2")
    assert embedding_of(impostor) is None
    assert embedding_of(load("goedel").frame) is None


def test_a_file_that_is_the_sphere_is_drawn_as_one(tmp_path):
    """The coframe decides, not its origin."""
    file = tmp_path / "s2.toml"
    file.write_text(
        'name = "s2"\ncoordinates = ["theta", "phi"]\nparameters = {R = "positive"}\n'
        'coframe = [["R", 0], [0, "R*sin(theta)"]]\n'
    )
    space = read_file(file)
    assert embedding_of(space.frame) is not None
    assert replace(space, title="").frame is space.frame


def test_values_against_declarations():
    """The radius of a sphere must be positive, as declared."""
    embedding, point, values, _ = at_sample("s2")
    with pytest.raises(
        CoordinateError,
        match="R: expected a value that is positive, nonnegative, as declared, got -1",
    ):
        embedding.places(point[None, :], values | {"R": -1})


@pytest.mark.parametrize("name", sorted(titles()))
def test_each_coordinate_of_a_place_has_an_axis(name: str):
    """A figure needs the name of an axis for each coordinate of a position."""
    embedding = embedding_of(load(name).frame)
    assert embedding is None or len(embedding.axes) == len(embedding.place)

"""Figures of developments and networks agree with the computed values."""

from collections.abc import Hashable

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import LimitError, NetworkError
from geomtorsion.geometry import Frame, levi_civita

# Tests pass wrong types on purpose, as users do, and read attributes that may be missing.
# pyright: reportAttributeAccessIssue=false
from geomtorsion.loops import EdgeList, Loop, Network, develop, dispiration, parallel_screws
from geomtorsion.loops.paths import developed_path
from geomtorsion.materials.lines import DislocationNetwork, LineArrays
from geomtorsion.pictures import draw_lines
from tests.materials.lines.synthetic_networks import rings

pytest.importorskip("matplotlib")

SQUARES = np.array([[x, y, 0.0] for y in (-1, 0, 1) for x in (-1, 0.2, 1)])
SIDES = [(k, k + 1) for k in range(9) if k % 3 < 2] + [(k, k + 3) for k in range(6)]


@pytest.fixture(scope="module")
def net() -> Network:
    crystal = parallel_screws([(0.5, 0.5), (-0.5, -0.5)], [1, "1/2"])
    return Network(crystal, EdgeList(SQUARES, np.array(SIDES)))


def texts(figure) -> str:
    """All words in a figure."""
    return " | ".join(t.get_text() for axes in figure.axes for t in [*axes.texts, axes.title])


def test_rolled_path_ends_where_the_development_does():
    """The last position is the Burgers vector, the last frame the rotation."""
    theta, phi = sp.symbols("theta phi")
    sphere = levi_civita(Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]]))
    for loop in (Loop.circle([1, 0.5], 0.6), Loop.plaquette([1, 0], (0.3, 0.4)).reversed()):
        turn = develop(sphere, loop)
        path = developed_path(sphere, loop, 60)
        assert np.abs(path.places[:, -1] - turn.burgers).max() < 1e-12
        assert np.abs(path.legs[-1] - turn.rotation).max() < 1e-12
        assert np.abs(path.points[:, 0] - path.points[:, -1]).max() < 1e-12


def test_development_shows_gap_and_turn(tmp_path):
    """Titles give |b|, the angle and the defects; the gap is an arrow between the two frames."""
    from geomtorsion.pictures.development import draw_development

    figure = draw_development(levi_civita(dispiration("5/6", 0)), Loop.circle([0, 0, 0], 1))
    said = texts(figure)
    assert "|b| = 1," in said
    assert "turn = 60°" in said
    assert "encloses 1 defect" in said
    arrow = next(t for t in figure.axes[1].texts if not t.get_text())
    assert np.abs(np.array(arrow.xy) - [-0.5, -np.sqrt(0.75)]).max() < 1e-12  # type: ignore[attr-defined]
    figure.savefig(tmp_path / "development.png")
    assert (tmp_path / "development.png").stat().st_size > 10_000


def test_network_fills_the_cycles_that_do_not_close(net, tmp_path):
    """Two of four meshes hold a line; each is filled and labelled with its |b|."""
    from geomtorsion.pictures.network import draw_network

    figure = draw_network(net)
    assert "4 cycles of a minimum basis, 2 do not close" in texts(figure)
    assert len(figure.axes[0].patches) == 2
    assert sorted(t.get_text() for t in figure.axes[0].texts) == ["0.5", "1"]
    figure.savefig(tmp_path / "network.png")
    many = EdgeList(
        np.random.default_rng(1).random((6000, 3)), np.arange(6000)[:, None] + [[0, -1]]
    )
    with pytest.raises(LimitError, match="expected at most"):
        draw_network(Network(net.frame, EdgeList(many.positions, np.abs(many.pairs))))


def test_dislocations_show_sense_strength_and_violations(tmp_path):
    """Each line has its b; a node that violates the rule is labelled with the excess."""
    from geomtorsion.pictures.network import draw_dislocations

    lines = [("a", "j", (1, 0, 0)), ("b", "j", (0, 1, 0)), ("j", "c", (1, 2, 0))]
    places: dict[Hashable, tuple[int, int]] = {"a": (0, 1), "b": (0, -1), "j": (1, 0), "c": (2, 0)}
    broken = DislocationNetwork.of_lines(lines, "abc", places)
    figure = draw_dislocations(broken)
    said = texts(figure)
    assert "b is not conserved at 1 node" in said
    assert "j: (0, 1, 0) too much" in said
    assert all(b in said for b in ("(1, 0, 0)", "(0, 1, 0)", "(1, 2, 0)"))
    figure.savefig(tmp_path / "dislocations.png")
    whole = DislocationNetwork.of_lines([*lines[:2], ("j", "c", (1, 1, 0))], "abc")
    assert "conserved at every inner node" in texts(draw_dislocations(whole))
    with pytest.raises(NetworkError, match="expected a position, got none"):
        draw_dislocations(broken, {"a": (0, 0)})


def test_lines_are_drawn_in_the_box_once():
    """The box, one collection per family with all its lines, and line centres in the box."""
    lines = rings(10, seed=4)
    mixed = lines.burgers.copy()
    mixed[:12] = [0, 0, 1]
    net = DislocationNetwork.of_arrays(LineArrays(lines.positions, lines.pairs, mixed, lines.box))
    space, bars = draw_lines(net, [Loop.circle([5, 5, 5], 4)]).axes
    box, *families = space.collections
    assert len(box._segments3d) == 12
    segments = np.concatenate([one._segments3d for one in families])
    assert sorted(len(one._segments3d) for one in families) == [12, 108]
    middles = segments.mean(axis=1)
    assert middles.min() >= 0
    assert middles.max() <= 10
    assert len(space.lines) == 1
    widths = [bar.get_width() for bar in bars.patches]
    assert sum(widths) == pytest.approx(100)


def test_broken_nodes_are_marked_and_counted():
    """Both ends of a line that ends inside the crystal are marked, without a box."""
    line = LineArrays([[0, 0, 0], [1, 0, 0]], [[0, 1]], [[1.0, 0, 0]])
    figure = draw_lines(DislocationNetwork.of_arrays(line))
    assert "not conserved at 2 nodes" in figure.get_suptitle()
    assert len(figure.axes[0].collections) == 2


def test_nothing_is_refused():
    """A network without lines is refused."""
    empty = LineArrays(np.zeros((1, 3)), np.zeros((0, 2), int), np.zeros((0, 3)))
    with pytest.raises(NetworkError, match="expected a network with lines"):
        draw_lines(DislocationNetwork.of_arrays(empty))

"""Domain: a loop that leaves the declared domain is refused by every way to ask for it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ChartEdgeError, ProofError
from geomtorsion.loops.domain import edge_values, refuse_outside
from geomtorsion.loops.edges import edge_integrals
from geomtorsion.loops.loop_files import read_loops

POLAR = gt.spaces.load("flat_polar").frame
CONNECTION = gt.levi_civita(POLAR)
SCREW = gt.spaces.load("screw_dislocation").frame
t = sp.Symbol("t", real=True)
R = sp.Symbol("R", positive=True)
x, y = sp.symbols("x y", real=True)
DIP = gt.Loop.parametric([2 - 2.0001 * sp.sin(t) ** 31, sp.cos(t)], t, (0, 2 * sp.pi))
# Positive at all points at which loops are looked at first.
BETWEEN = gt.Loop.parametric([2 - 2.0001 * sp.sin(t - 0.3) ** 31, sp.cos(t)], t, (0, 2 * sp.pi))
OUTSIDE = {
    "circle": gt.Loop.circle([0, 0], 0.2),
    "ellipse": gt.Loop.ellipse([1, 0], [1.5, 0.2]),
    "polygon": gt.Loop.polygon([[1, 0], [2, 0], [-0.5, 1]]),
    "touching corner": gt.Loop.polygon([[1, 0], [2, 0], [0, 1]]),
    "plaquette": gt.Loop.plaquette([-0.1, 0], (1, 1)),
    "spline": gt.Loop.spline([[1, 0], [2, 0], [-1, 1]]),
    "parametrised": gt.Loop.parametric([sp.cos(t), sp.sin(t)], t, (0, 2 * sp.pi)),
    "narrow dip": DIP,
    "dip between samples": BETWEEN,
    "negative side": gt.Loop.circle([-2, 0], 0.5),
    "second part": gt.Loop.circle([2, 0], 1).then(gt.Loop.polygon([[3, 0], [-1, 0], [-1, 1]])),
}
WORDS = r"a loop inside the domain of the frame, the domain is r > 0, got the point"


@pytest.mark.parametrize("name", OUTSIDE)
def test_loops_outside_are_refused(name: str) -> None:
    """Numbers, closed forms and developments refuse with the condition and a point."""
    loop = OUTSIDE[name]
    with pytest.raises(ChartEdgeError, match=WORDS):
        gt.burgers_vector(POLAR, loop)
    with pytest.raises(ChartEdgeError, match=WORDS):
        gt.develop(CONNECTION, loop)
    if name in ("circle", "polygon", "parametrised"):
        with pytest.raises(ChartEdgeError, match=WORDS):
            gt.exact_burgers_vector(POLAR, loop)


def test_no_circle_about_the_edge_has_a_closed_form() -> None:
    """A circle of any radius about r = 0 is refused; one of a fixed radius inside is not."""
    with pytest.raises(ChartEdgeError, match=WORDS):
        gt.exact_burgers_vector(POLAR, gt.Loop.circle([0, 0], R))
    inside = gt.exact_burgers_vector(POLAR, gt.Loop.circle([3, 0], 1))
    assert [float(v) for v in inside.vector] == pytest.approx([0, np.pi])


def test_a_file_of_loops_is_refused(tmp_path) -> None:
    """A loop that was read from a file is refused as well."""
    file = tmp_path / "loops.json"
    file.write_text('[{"circle": {"centre": [0, 0], "radius": 0.2}}]', "utf-8")
    with pytest.raises(ChartEdgeError, match=WORDS):
        gt.burgers_vector(POLAR, read_loops(POLAR, file).loops[0])


def test_a_proof_refuses_them() -> None:
    """A result that claims a loop outside is not confirmed."""
    result = gt.burgers_vector(POLAR, gt.Loop.circle([2, 0], 0.2))
    assert gt.prove(result).holds
    for name in ("circle", "negative side", "narrow dip"):
        with pytest.raises(ProofError, match=r"leaves the domain near .*the domain is r > 0"):
            gt.prove(replace(result, loop=OUTSIDE[name]))
    turned = gt.develop(CONNECTION, gt.Loop.circle([2, 0], 0.2))
    assert gt.prove(turned).holds is not False
    with pytest.raises(ProofError, match="leaves the domain near"):
        gt.prove(replace(turned, loop=OUTSIDE["circle"]))


def test_edges_of_networks_are_refused() -> None:
    """A straight edge across r = 0."""
    ends = np.array([[1.0, 0.0]]), np.array([[-1.0, 1.0]])
    with pytest.raises(ChartEdgeError, match="expected an edge inside the domain"):
        edge_integrals(POLAR, *ends)


def test_a_map_has_no_vector_outside() -> None:
    """Circles of a map that reach r <= 0 have none; the others are right."""
    found = gt.burgers_vectors(POLAR, [[0.1, 0.0], [2.0, 0.0]], 0.5)
    assert np.isnan(found.vectors[:, 0]).all() or np.isnan(found.vectors[0]).all()
    assert np.isfinite(found.vectors).any()


def test_signs_that_were_declared_count() -> None:
    """A coordinate declared positive is an edge as a domain is."""
    r = sp.Symbol("r", positive=True)
    phi = sp.Symbol("phi", real=True)
    frame = gt.Frame([r, phi], [[1, 0], [0, r]])
    with pytest.raises(ChartEdgeError, match="r was declared positive"):
        gt.burgers_vector(frame, gt.Loop.circle([0, 0], 0.2))


@pytest.mark.parametrize(
    ("frame", "loop", "options"),
    [
        (SCREW, gt.Loop.circle([0, 0, 0], 1), {"parameters": {"b": 2}}),
        (POLAR, gt.Loop.circle([2, 6.5], 1), {}),
        (POLAR, gt.Loop.circle([0.2000001, 0], 0.2), {}),
        (gt.Frame([x, y], [[1, 0], [0, 1 + x]], domain=[x > -1]), gt.Loop.circle([0, 0], 0.9), {}),
    ],
)
def test_loops_inside_stay_right(frame, loop, options) -> None:
    """Around a line, over a full turn of an angle, and close to an edge."""
    found = gt.burgers_vector(frame, loop, **options)
    assert found.reached
    assert gt.prove(found).holds is not False


def test_without_a_domain_nothing_is_refused() -> None:
    """A frame that declares nothing has no edge."""
    frame = gt.Frame([x, y], [[1, 0], [0, 1 + x * x]])
    assert edge_values(frame, None) is None
    refuse_outside(frame, gt.Loop.circle([0, 0], 5).parts, None)

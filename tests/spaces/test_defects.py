"""Defects of crystals: the Burgers vector of a loop around the line, summed directly."""

import math

import numpy as np
import pytest
import sympy as sp

from geomtorsion.geometry import Frame
from geomtorsion.spaces import load

POINTS = 400


def parameter(frame: Frame, name: str) -> sp.Symbol:
    """The parameter of a frame that has this name."""
    return next(symbol for symbol in frame.parameters if symbol.name == name)


def gathered(name: str, radius: float, values: dict[str, float]) -> np.ndarray:
    """Sum of the coframe along a circle around the z axis; spectrally exact for these frames."""
    frame = load(name).frame
    constants = {parameter(frame, key): value for key, value in values.items()}
    columns = range(3)
    total = np.zeros(3)
    entries = sp.lambdify(
        frame.coordinates[:2],
        [[frame.coframe[i, m].subs(constants) for m in columns] for i in columns],
    )
    for k in range(POINTS):
        angle = 2 * math.pi * (k + 0.5) / POINTS
        x, y = radius * math.cos(angle), radius * math.sin(angle)
        total += np.array(entries(x, y), dtype=float) @ np.array([-y, x, 0.0])
    return total * 2 * math.pi / POINTS


@pytest.mark.parametrize("radius", [1.0, 7.0])
@pytest.mark.parametrize(
    ("name", "values", "burgers"),
    [
        ("screw_dislocation", {"b": 0.25}, (0, 0, 0.25)),
        ("edge_dislocation", {"b": 0.25}, (0.25, 0, 0)),
        ("edge_dislocation_elastic", {"b": 0.25, "nu": 0.3}, (0.25, 0, 0)),
    ],
)
def test_burgers_vector_of_a_line(
    name: str, values: dict[str, float], burgers: tuple[float, ...], radius: float
) -> None:
    """Every loop around the line gives b, whatever its radius."""
    assert gathered(name, radius, values) == pytest.approx(burgers, abs=1e-12)


@pytest.mark.parametrize("radius", [0.5, 2.0])
def test_burgers_vector_of_a_core(radius: float) -> None:
    """With a core of radius c a loop of radius r gives b r^2 / (r^2 + c^2), the flux."""
    b, c = 0.25, 0.8
    frame = load("screw_core").frame
    x, y, _ = frame.coordinates
    s = sp.Symbol("s", positive=True)
    torsion = 2 * frame.quantity("torsion").in_frame()[0, 1, 2]
    along = torsion.subs({parameter(frame, "b"): b, parameter(frame, "c"): c, x: s, y: 0})
    density = sp.lambdify(s, 2 * sp.pi * s * along)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    flux = sum(w * density(radius * (1 + n) / 2) for n, w in zip(nodes, weights, strict=True))
    expected = b * radius**2 / (radius**2 + c**2)
    assert flux * radius / 2 == pytest.approx(expected, abs=1e-12)
    assert gathered("screw_core", radius, {"b": b, "c": c}) == pytest.approx(
        (0, 0, expected), abs=1e-12
    )


def test_the_edge_dislocation_is_in_elastic_equilibrium() -> None:
    """The strain of the elastic edge dislocation has a divergence-free stress (plane strain)."""
    frame = load("edge_dislocation_elastic").frame
    x, y, _ = frame.coordinates
    nu = parameter(frame, "nu")
    distortion = [[frame.coframe[i, m] - (1 if i == m else 0) for m in range(2)] for i in range(2)]
    trace = distortion[0][0] + distortion[1][1]
    lame = 2 * nu / (1 - 2 * nu)
    stress = [
        [
            lame * trace * (1 if i == m else 0) + distortion[i][m] + distortion[m][i]
            for m in range(2)
        ]
        for i in range(2)
    ]
    for row in stress:
        force = frame.field.read(sp.diff(row[0], x) + sp.diff(row[1], y))
        assert force.is_zero is True


def test_the_disclination_comes_back_turned() -> None:
    """A turn around the axis rotates multivalued legs by 2 pi alpha, and periodic legs not."""
    for name, turned in (("wedge_disclination", True), ("wedge_disclination_periodic", False)):
        frame = load(name).frame
        _, phi, _ = frame.coordinates
        alpha = parameter(frame, "alpha")
        here = sp.Matrix([[frame.coframe[i, m] for m in range(2)] for i in range(2)])
        after = here.subs(phi, phi + 2 * sp.pi)
        angle = 2 * sp.pi * alpha if turned else 0
        rotation = sp.Matrix([[sp.cos(angle), -sp.sin(angle)], [sp.sin(angle), sp.cos(angle)]])
        for entry in after - rotation * here:
            assert frame.field.read(entry).is_zero is True

"""Laws of geometries: products, scale, conformal changes, and maps there and back."""

import math
from itertools import pairwise

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.same import classified

X, Y, Z = sp.symbols("x y z", real=True)


def metric(coordinates: str, *rows: str, domain: str = "") -> gt.Frame:
    """A metric by its rows, entries separated by spaces; one row of n entries is a diagonal."""
    entries = [row.split() for row in rows]
    if len(entries) == 1:
        (diagonal,) = entries
        n = range(len(diagonal))
        entries = [[diagonal[i] if i == k else "0" for k in n] for i in n]
    return gt.Frame.from_metric(coordinates, entries, domain=domain or None)


def scaled(frame: gt.Frame, factor: object) -> gt.Frame:
    """The metric times a function of the coordinates."""
    rows = (frame.metric.to_sympy().tomatrix() * sp.sympify(factor)).tolist()
    return gt.Frame.from_metric(frame.coordinates, rows, domain=frame.domain or None)


SPHERE = "1 sin(a)**2"
HYPERBOLIC = "1 sinh(b)**2"

# -- classes ---------------------------------------------------------------------------------------

# A metric, a factor that makes its curvature scalar vary, and its Petrov type in the literature
# [Stephani2003]: black holes 4.3, waves 24.5, Kasner 13.5, Nariai 12.1, round spheres 8.5.
PETROV = {
    "black hole": (
        metric("t r a c", "-(1-2/r) 1/(1-2/r) r**2 r**2*sin(a)**2", domain="r > 2, 0 < a < pi"),
        "r**2",
        "D",
    ),
    "plane wave": (
        metric("u v x y", "x**2-y**2 1 0 0", "1 0 0 0", "0 0 1 0", "0 0 0 1"),
        "(3+x**2)",
        "N",
    ),
    "Kasner": (
        metric("t x y z", "-1 t**(-4/7) t**(6/7) t**(12/7)", domain="t > 0"),
        "t**2",
        "I",
    ),
    # A sphere and a universe of de Sitter in two dimensions; with anti-de Sitter, of opposite
    # curvature, the Weyl tensor vanishes (Bertotti and Robinson).
    "Nariai": (
        metric("t r a c", "-cos(r)**2 1 1 sin(a)**2", domain="0 < r < 1, 0 < a < pi"),
        "1+r**2",
        "D",
    ),
    "Bertotti-Robinson": (
        metric("t r a c", "-cosh(r)**2 1 1 sin(a)**2", domain="0 < a < pi"),
        "1+r**2",
        "O",
    ),
    "cosmos": (metric("t x y z", "-1 t t t", domain="t > 0"), "1+x**2", "O"),
}


@pytest.mark.parametrize("name", PETROV)
def test_conformal_metrics_have_one_petrov_type(name):
    """The Weyl tensor knows no scale: a metric times a function keeps its known type."""
    frame, factor, kind = PETROV[name]
    table = {q.name: q for q in frame.coordinates}
    for one in (frame, scaled(frame, sp.sympify(factor, locals=table))):
        found = classified(one)
        assert found.petrov == kind
        assert found.conformally_flat == (kind == "O")


LINE, CURVED = (1, 0), None
# A metric, and the factors of de Rham by construction: dimension and constant curvature.
PRODUCTS = {
    "line and unit 3-sphere": (
        metric("t b a c", "1 1 sin(b)**2 sin(b)**2*sin(a)**2", domain="0 < b < pi, 0 < a < pi"),
        [LINE, (3, 1)],
    ),
    # The Heisenberg group has R = -1/2 everywhere, and no constant curvature.
    "line and Heisenberg group": (
        metric("t x y z", "1 0 0 0", "0 1 0 0", "0 0 1+x**2 x", "0 0 x 1"),
        [LINE, (3, CURVED)],
    ),
    "plane and sphere": (
        metric("x y a c", "1 1 4 4*sin(a)**2", domain="0 < a < pi"),
        [(2, 0), (2, sp.Rational(1, 4))],
    ),
    "time and sphere": (metric("t a c", f"-1 {SPHERE}", domain="0 < a < pi"), [LINE, (2, 1)]),
    "sphere and hyperbolic plane": (
        metric("a c b d", f"{SPHERE} {HYPERBOLIC}", domain="0 < a < pi, b > 0"),
        [(2, CURVED), (2, CURVED)],
    ),
    "3-sphere": (
        metric("b a c", "1 sin(b)**2 sin(b)**2*sin(a)**2", domain="0 < b < pi, 0 < a < pi"),
        [],
    ),
    "flat": (metric("r c", "1 r**2", domain="r > 0"), []),
    # A parallel null vector splits nothing off.
    "plane wave": (PETROV["plane wave"][0], []),
}


@pytest.mark.parametrize("name", PRODUCTS)
def test_products_have_the_factors_they_are_made_of(name):
    """Factors are a flat one first, then curved ones; irreducible metrics have none."""
    frame, expected = PRODUCTS[name]
    found = classified(frame).factors
    assert [(one.dimension, one.curvature) for one in found] == expected


# -- two sides -------------------------------------------------------------------------------------


def test_the_order_of_factors_changes_nothing():
    """A product is the same in the other order, also where curvatures have two signs."""
    domain = "0 < a < pi, b > 0"
    one = metric("a c b d", f"{SPHERE} {HYPERBOLIC}", domain=domain)
    two = metric("b d a c", f"{HYPERBOLIC} {SPHERE}", domain=domain)
    assert gt.same_geometry(one, two).verdict == "same"
    wider = metric("a c b d", f"{SPHERE} 2 2*sinh(b)**2", domain=domain)
    assert gt.same_geometry(two, wider).verdict == "different"


SCALES = {
    "flat": (metric("r c", "1 r**2", domain="r > 0"), "same"),
    "sphere": (metric("a c", SPHERE, domain="0 < a < pi"), "different"),
    "surface": (metric("x y", "1 (1+x**2)**2"), "different"),
    # exp(2 x) dx^2 + exp(2 x) dy^2 is flat, and so is a cone about its axis.
    "cone": (metric("r c", "1 r**2/4", domain="r > 0"), "same"),
}


@pytest.mark.parametrize("name", SCALES)
def test_only_flat_metrics_are_the_same_at_another_scale(name):
    """A constant factor is a change of coordinates of flat metrics only."""
    frame, verdict = SCALES[name]
    larger = scaled(frame, 4)
    for sides in ((frame, larger), (larger, frame)):
        assert gt.same_geometry(*sides).verdict == verdict
    assert gt.same_geometry(larger, scaled(frame, 4)).verdict == "same"


# A function f of the position, and the dimension of the motions of space that keep it.
STRENGTHS = {
    "constant": (sp.Integer(1), 6),
    "along a line": (1 + X**2, 3),
    "about an axis": (1 + X**2 + Y**2, 2),
    "about a point": (1 + X**2 + Y**2 + Z**2, 3),
    "in a plane": (1 + X**2 + 3 * Y**2, 1),
    "anywhere": (1 + X**2 + 3 * Y**2 + 5 * Z**2, 0),
}


@pytest.mark.parametrize("name", STRENGTHS)
def test_a_connection_has_the_symmetries_of_its_torsion(name):
    """Axial torsion f eps_abc in flat space has the motions that keep f."""
    strength, symmetries = STRENGTHS[name]
    flat = gt.Frame([X, Y, Z], sp.eye(3).tolist())

    def twisted(f: sp.Expr) -> gt.Connection:
        n = range(3)
        epsilon = [[[f * sp.LeviCivita(a, b, c) for c in n] for b in n] for a in n]
        return gt.from_torsion(flat, epsilon)

    one, two = twisted(strength), twisted(strength.subs({X: Y, Y: Z, Z: X}, simultaneous=True))
    result = gt.same_geometry(one, two)
    assert result.symmetries == (symmetries, symmetries)
    assert result.growth == result.swapped().growth


def test_a_map_leads_there_and_back():
    """A map of the plane keeps distances, and the map of the swapped verdict is its inverse."""
    polar = gt.Frame("r c", [[1, 0], [0, "r"]], domain="r > 0")
    skew = gt.Frame.from_metric("u v", [["1", "1/2"], ["1/2", "1"]])
    result = gt.same_geometry(polar, skew)
    there, back = result.map, result.swapped().map
    assert result.match is not None
    start = {str(q): float(x) for q, x in result.match.start.items()}
    points = [{"r": start["r"] * s, "c": start["c"] + t} for s, t in ((1, 0.3), (1.2, 0), (0.9, 1))]
    images = [there(point).coordinates for point in points]
    for point, image in zip(points, images, strict=True):
        again = back(image)
        assert again["r"] == pytest.approx(point["r"], abs=1e-8)
        assert again["c"] == pytest.approx(point["c"], abs=1e-8)
    for (p, one), (q, two) in pairwise(zip(points, images, strict=True)):
        turn = math.cos(p["c"] - q["c"])
        distance = math.sqrt(p["r"] ** 2 + q["r"] ** 2 - 2 * p["r"] * q["r"] * turn)
        u, v = one["u"] - two["u"], one["v"] - two["v"]
        assert math.sqrt(u**2 + u * v + v**2) == pytest.approx(distance, abs=1e-8)

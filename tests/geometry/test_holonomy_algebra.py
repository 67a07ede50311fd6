"""Holonomy algebras: known dimensions and names, parallel tensors, and developments of loops."""

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError

x, y, z, u, v = sp.symbols("x y z u v", real=True)


def own(name: str) -> gt.Connection:
    """The own connection of a shipped space."""
    return gt.spaces.load(name).own_connection()


def product_of_spheres() -> gt.Connection:
    """The Levi-Civita connection of S2 x S2."""
    coframe = sp.diag(1, sp.sin(x), 1, sp.sin(u))
    return gt.levi_civita(gt.Frame([x, y, u, v], coframe))


def projective_plane() -> gt.Connection:
    """CP2 with the metric of Fubini and Study: legs of SU(2) and a radial one [Eguchi1980]."""
    r, psi, theta, phi = sp.symbols("r psi theta phi", positive=True)
    f = 1 / (1 + r**2)
    s1 = [0, 0, sp.cos(psi), sp.sin(psi) * sp.sin(theta)]
    s2 = [0, 0, -sp.sin(psi), sp.cos(psi) * sp.sin(theta)]
    s3 = [0, 1, 0, sp.cos(theta)]
    rows = [
        [f, 0, 0, 0],
        [r * f / 2 * e for e in s3],
        [r * sp.sqrt(f) / 2 * e for e in s1],
        [r * sp.sqrt(f) / 2 * e for e in s2],
    ]
    return gt.levi_civita(gt.Frame([r, psi, theta, phi], rows))


# Connection, dimensions by order, name, parallel vectors, parallel tensors dd.
KNOWN = {
    "S2": (lambda: gt.levi_civita("s2"), (1,), "so(2)", 0, 2),
    "so3": (lambda: gt.levi_civita("so3"), (3,), "so(3)", 0, 1),
    "so3, parallel legs": (lambda: gt.cartan("so3"), (0,), "trivial", 3, 9),
    "Schwarzschild": (lambda: gt.levi_civita("schwarzschild"), (6,), "so(3, 1)", 0, 1),
    "Kerr": (lambda: gt.levi_civita("kerr"), (6,), "so(3, 1)", 0, 1),
    "Kerr, null legs": (lambda: gt.levi_civita("kerr_kinnersley"), (6,), "so(3, 1)", 0, 1),
    "pp wave": (lambda: gt.levi_civita("pp_wave"), (2,), "R^2", 1, 4),
    "Goedel": (lambda: gt.levi_civita("goedel"), (3,), "sl(2, R)", 1, 2),
    "de Sitter": (lambda: gt.levi_civita("de_sitter"), (6,), "so(3, 1)", 0, 1),
    "S7": (lambda: gt.levi_civita("s7"), (21,), "so(7)", 0, 1),
    "bounce with torsion": (lambda: own("torsion_bounce"), (6,), "so(3, 1)", 0, 1),
    "Kerr-de Sitter, torsion": (lambda: own("kerr_de_sitter_torsion"), (6,), "so(3, 1)", 0, 1),
    "S2 x S2": (product_of_spheres, (2,), "R^2", 0, 4),
    "CP2": (projective_plane, (4,), "so(3) + R", 0, 2),
}


@pytest.mark.parametrize("name", KNOWN)
def test_known_algebras(name: str) -> None:
    """Dimensions, names and numbers of parallel tensors of known connections."""
    make, dimensions, algebra, vectors, forms = KNOWN[name]
    holonomy = make().holonomy_algebra
    assert (holonomy.dimensions, holonomy.name) == (dimensions, algebra)
    assert holonomy.dimension == dimensions[-1] == len(holonomy.generators)
    assert (holonomy.parallel("u"), holonomy.parallel("dd")) == (vectors, forms)


def test_complex_structures() -> None:
    """S2, S2 x S2 and CP2 are Kaehler: parallel maps beside the identity; S3 has none."""
    assert gt.levi_civita("s2").holonomy_algebra.parallel("ud") == 2
    assert product_of_spheres().holonomy_algebra.parallel("ud") == 4
    assert projective_plane().holonomy_algebra.parallel("ud") == 2
    assert gt.levi_civita("s3").holonomy_algebra.parallel("ud") == 1


def test_derivatives_add_generators() -> None:
    """Two steps of a triangular connection: derivatives of the curvature add two generators."""
    rows = [[[0] * 3 for _ in range(3)] for _ in range(3)]
    rows[1][1][0] = x**2 / 2
    rows[1][2][1] = x
    frame = gt.Frame([x, y, z], sp.eye(3))
    holonomy = gt.from_coefficients(frame, rows).holonomy_algebra
    assert holonomy.dimensions == (1, 3)
    assert holonomy.name == "Heisenberg algebra"
    # Strictly triangular matrices annihilate one vector and one form.
    assert (holonomy.parallel("u"), holonomy.parallel("d")) == (1, 1)


def test_general_connections() -> None:
    """A connection without a metric may turn and stretch vectors in all directions."""
    rows = [[[0] * 2 for _ in range(2)] for _ in range(2)]
    rows[0][0][1], rows[0][1][0], rows[1][0][0] = y, x * y, x**2
    holonomy = gt.from_coefficients(gt.Frame([x, y], sp.eye(2)), rows).holonomy_algebra
    assert holonomy.name == "gl(2, R)"
    assert holonomy.parallel("dd") == 0


def plane_wave() -> gt.Connection:
    """The Levi-Civita connection of a pp wave with H = x^2 - y^2 + x y u."""
    return gt.levi_civita(gt.spaces.load("pp_wave").frame.subs({"H": "x**2 - y**2 + x*y*u"}))


LOOPS = {
    "S2": (lambda: gt.levi_civita("s2"), [1.0, 0.3], {"R": 1.0}),
    "pp wave": (plane_wave, [0.3, 0.2, 0.7, 0.4], {}),
    "Goedel": (lambda: gt.levi_civita("goedel"), [0.1, 0.2, 0.3, 0.4], {"a": 1.3}),
    "S2 x S2": (product_of_spheres, [1.0, 0.2, 0.8, 0.1], {}),
    "so3": (lambda: gt.levi_civita("so3"), [0.4, 1.0, 0.2], {}),
}


@pytest.mark.parametrize("name", LOOPS)
def test_developments_of_loops(name: str) -> None:
    """The rotation of each developed loop is the exponential of a sum of generators at its base."""
    make, base, parameters = LOOPS[name]
    connection = make()
    point = dict(zip((q.name for q in connection.frame.coordinates), base, strict=True))
    generators = connection.holonomy_algebra.generators
    rows = np.array([one.at(point | parameters).T.ravel() for one in generators], dtype=float)
    n = len(base)
    for i in range(n):
        j = (i + 1) % n
        corners = np.array([base] * 4)
        corners[1:3, i] += 0.2
        corners[2:4, j] += 0.3
        loop = gt.Loop.polygon(corners.tolist())
        turn = gt.develop(connection, loop, parameters=parameters or None).frank
        weights, *_ = np.linalg.lstsq(rows.T, turn.ravel(), rcond=None)
        assert np.abs(rows.T @ weights - turn.ravel()).max() < 1e-9


def test_report() -> None:
    """Text and notebook show name, orders and parallel tensors."""
    holonomy = gt.levi_civita("pp_wave").holonomy_algebra
    text = str(holonomy)
    assert text.startswith("holonomy of the Levi-Civita connection: R^2, dimension 2\n")
    assert "parallel vectors: 1" in text
    assert "generators" in holonomy._repr_html_()


REFUSALS = [
    (lambda: gt.levi_civita("s2").holonomy_algebra.parallel("U"), "expected letters u"),
    (lambda: gt.levi_civita("s2").holonomy_algebra.parallel(2), "got 2"),  # pyright: ignore[reportArgumentType]
]


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_bad_input_is_refused(call, words):
    """Each bad argument is refused with its own message."""
    with pytest.raises(GeomtorsionError, match=words):
        call()

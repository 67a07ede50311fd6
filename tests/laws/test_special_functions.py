"""Frames with special functions: geometry, undecided components, and motions."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from tests.cli.running import run
from tests.rounding import ROUNDED

T, X, theta, phi = sp.symbols("T X theta phi", real=True)
x, y, r = sp.symbols("x y r", positive=True)
M = sp.Symbol("M", positive=True)
AIRY = sp.airyai(x) - sp.sqrt(x / 3) / sp.pi * sp.besselk(
    sp.Rational(1, 3), 2 * x ** sp.Rational(3, 2) / 3
)


def kruskal() -> gt.Frame:
    """Schwarzschild's space-time in Kruskal coordinates."""
    radius = 2 * M * (1 + sp.LambertW((X**2 - T**2) / sp.E))
    factor = sp.sqrt(32 * M**3 / radius) * sp.exp(-radius / (4 * M))
    rows = sp.diag(factor, factor, radius, radius * sp.sin(theta))
    return gt.Frame([T, X, theta, phi], rows, signature=(-1, 1, 1, 1))


def test_kruskal_chart_is_a_vacuum():
    """Ricci vanishes, K = 48 M**2/r**6, the Bianchi identities hold; everything is decided."""
    frame = kruskal()
    curvature = gt.levi_civita(frame).curvature
    assert curvature.ricci.is_zero is True
    assert curvature.ricci.nonzero() == curvature.ricci.undecided() == {}
    assert 0 < curvature.ricci.certainty.error < 1e-30
    radius = 2 * M * (1 + sp.LambertW((X**2 - T**2) / sp.E))
    scalar = frame.quantity("kretschmann").element()
    assert scalar == frame.field.read(48 * M**2 / radius**6)
    assert scalar != frame.field.read(47 * M**2 / radius**6)
    for check in gt.identities(gt.levi_civita(frame)):
        assert check.holds is True, check


def test_kruskal_chart_has_values_on_the_horizon():
    """Where X = T, so that W = 0, the radius is 2 M and K is 3/(4 M**4)."""
    at = {T: 1, X: 1, theta: 1, phi: 0, M: 1}
    assert kruskal().quantity("kretschmann").at(at) == pytest.approx(0.75, rel=1e-13)


def _kruskal_geodesic(start, velocity, end):
    """T, X, phi by mpmath from the Lagrangian in the equatorial plane, with M = 1."""
    angular = 2 * (1 + mpmath.lambertw((start[1] ** 2 - start[0] ** 2) / mpmath.e)) * velocity[2]

    def rates(_, state):
        t, q, _, dt, dq = state
        w = mpmath.lambertw((q**2 - t**2) / mpmath.e)
        radius = 2 * (1 + w)
        size = 32 * mpmath.exp(-radius / 2) / radius
        # By W' = exp(-W)/(1 + W), in both coordinates.
        slope = 4 * mpmath.exp(-w) / (1 + w) / mpmath.e
        by_t, by_q = -slope * t, slope * q
        change = -size * (1 / radius + mpmath.mpf(1) / 2)
        turn = angular / radius**2
        whole = change * (by_t * dt + by_q * dq)
        square = (dq * dq - dt * dt) / 2
        return [
            dt,
            dq,
            turn,
            -(change * by_t * square + radius * by_t * turn**2 + whole * dt) / size,
            (change * by_q * square + radius * by_q * turn**2 - whole * dq) / size,
        ]

    radius = 2 * (1 + mpmath.lambertw((start[1] ** 2 - start[0] ** 2) / mpmath.e))
    scale = mpmath.sqrt(32 * mpmath.exp(-radius / 2) / radius)
    first = [start[0], start[1], mpmath.mpf(0), velocity[0] / scale, velocity[1] / scale]
    return mpmath.odefun(rates, 0, first, tol=mpmath.mpf(10) ** -18)(end)[:3]


@pytest.mark.parametrize(("start", "end"), [((0, 1), 1.0), ((1, 1), 0.5)])
def test_geodesics_in_the_kruskal_chart(start, end):
    """Geodesics through the horizon, or from it, agree with mpmath at twenty digits."""
    frame = kruskal().subs({M: 1})
    first = [*map(float, start), float(np.pi / 2), 0.0]
    velocity = [float(np.sqrt(1.25)), 0.3, 0.0, 0.4]
    solution = gt.solve(gt.geodesic(frame, first, frame_velocity=velocity), end)
    with mpmath.workdps(25):
        given = [mpmath.sqrt(mpmath.mpf("1.25")), mpmath.mpf("0.3"), mpmath.mpf("0.4")]
        want = np.array(_kruskal_geodesic(list(map(mpmath.mpf, start)), given, end), dtype=float)
    found = solution.coordinates[-1][[0, 1, 3]]
    assert np.abs(found - want).max() < max(solution.error, 1e-15) < 1e-10
    assert np.abs(solution.at(end)["coordinates"][[0, 1, 3]] - want).max() < 1e-10


def test_geodesics_on_a_surface_with_bessel_functions():
    """ds**2 = dr**2 + (2 + J_1(r))**2 dphi**2: phi and r agree with mpmath, by Clairaut."""
    frame = gt.Frame([r, phi], [[1, 0], [0, 2 + sp.besselj(1, r)]])
    solution = gt.solve(gt.geodesic(frame, [0.5, 0.0], frame_velocity=[0.6, 0.8]), 2.0)
    with mpmath.workdps(25):

        def rates(_, state):
            size = 2 + mpmath.besselj(1, state[0])
            slope = mpmath.besselj(1, state[0], derivative=1)
            return [state[1], slope * clairaut**2 / size**3, clairaut / size**2]

        clairaut = (2 + mpmath.besselj(1, mpmath.mpf("0.5"))) * mpmath.mpf("0.8")
        first = [mpmath.mpf("0.5"), mpmath.mpf("0.6"), mpmath.mpf(0)]
        want = mpmath.odefun(rates, 0, first, tol=mpmath.mpf(10) ** -18)(2)
    found = solution.coordinates[-1]
    assert abs(found - np.array([want[0], want[2]], dtype=float)).max() < solution.error < 1e-10


@pytest.mark.parametrize(
    "name",
    ["erf", "erfc", "gamma", "loggamma", "LambertW", "Ei", "airyai", "Si"],
)
def test_motions_with_each_special_function(name):
    """y' = f(x) with x' = 1 gives the integral, compared with mpmath."""
    function = getattr(sp, name)
    solution = gt.solve(gt.ODE.of({"x": 1, "y": function(x)}, [1, 0]), 1.0)
    with mpmath.workdps(25):
        want = mpmath.quad(sp.lambdify(x, function(x), "mpmath"), [1, 2])
    assert abs(solution["y"][-1] - float(want)) < max(solution.error, 1e-15) < 1e-9


def test_engines_without_a_form_name_a_remedy():
    """Taylor has no series of Bessel functions; the error names a remedy."""
    problem = gt.ODE.of({"x": 1, "y": sp.besselj(1, x)}, [1, 0])
    with pytest.raises(gt.GeomtorsionError, match="besselj has no Taylor series .* another engine"):
        gt.solve(problem, 1.0, engine=gt.Taylor())
    with pytest.raises(gt.GeomtorsionError, match="accuracy"):
        gt.solve(problem, 1.0, accuracy=1e-20)


def test_members_with_special_functions():
    """Many motions at once agree with single ones."""
    rates = {"x": 1, "y": sp.Symbol("k") * sp.besselj(0, x)}
    problem = gt.ODE.of(rates, [1, 0], parameters={"k": 1})
    many = gt.solve_many(problem, {"k": [1.0, 3.0]}, 1.0)
    alone = gt.solve(problem, 1.0)
    assert many["y"][:, -1] == pytest.approx(np.array([1, 3]) * alone["y"][-1], abs=1e-9)


def test_exported_python_has_the_same_numbers(tmp_path):
    """An exported module for W, K and erfi agrees with the exact components."""
    file = tmp_path / "special.toml"
    entry = "LambertW(x) + besselk(1, x) + erfi(x) + gamma(x)"
    file.write_text(f'name = "s"\ncoordinates = ["x", "y"]\ncoframe = [[1, "{entry}"], [0, 1]]\n')
    source = run("geometry", str(file), "--only", "coframe", "--format", "python").stdout
    module: dict = {}
    exec(source, module)
    want = sp.LambertW(x) + sp.besselk(1, x) + sp.erfi(x) + sp.gamma(x)
    assert module["coframe"](0.7, 0.0)[0, 1] == pytest.approx(float(want.subs(x, 0.7)), rel=1e-12)
    entry = "polygamma(1, x) + expint(2, x)"
    file.write_text(f'name = "s"\ncoordinates = ["x", "y"]\ncoframe = [[1, "{entry}"], [0, 1]]\n')
    text = run("geometry", str(file), "--only", "coframe", "--format", "python", code=2).output
    assert "expected functions that NumPy or SciPy have" in text


# -- undecided components ------------------------------------------------------------------------


def doubtful() -> gt.Frame:
    """A frame with one component that vanishes, which no known relation proves."""
    return gt.Frame([x, y], [[1, AIRY], [0, 1]])


def test_undecided_components_are_shown_as_undecided():
    """Undecided components are not listed as nonzero, in any form; and nothing is proved."""
    coframe = doubtful().coframe
    assert set(coframe.nonzero()) == {(0, 0), (1, 1)}
    assert set(coframe.undecided()) == {(0, 1)}
    assert coframe.is_zero is False
    assert not coframe.certainty.proved
    table = coframe.table()
    assert "2 of 4 components do not vanish, 1 is undecided" in str(table)
    assert str(table).count("(undecided)") == 1
    assert repr(coframe).count("(undecided)") == 1
    assert "1 is undecided" in table._repr_html_()
    assert table._repr_html_().count("(undecided)") == 1
    assert coframe._repr_latex_().count("(undecided)") == 1
    # Numbers and arrays contain components that may vanish.
    assert coframe.to_sympy()[0, 1] != 0
    assert coframe.at({x: Fraction(1, 2)})[0, 1] == pytest.approx(0, abs=ROUNDED)


def test_a_tensor_of_undecided_components_is_undecided():
    """A tensor of undecided components is neither zero nor nonzero."""
    torsion = gt.cartan(doubtful()).torsion.S
    assert torsion.is_zero is None
    assert torsion.nonzero() == {}
    assert torsion.undecided()
    assert not torsion.certainty.proved
    for check in gt.identities(gt.cartan(doubtful())):
        assert check.holds or not check.certainty.proved


TEXT = """
name = "doubtful"
title = "a component in doubt"
coordinates = ["x", "y"]
coframe = [
  [1, "airyai(x) - sqrt(x/3)/pi*besselk(1/3, 2*x**(3/2)/3)"],
  [0, 1],
]
domain = ["x > 0"]
"""


@pytest.mark.parametrize("form", ["text", "latex", "json", "python", "mathematica"])
def test_the_command_line_marks_undecided_components(form, tmp_path):
    """The command line marks undecided components in each form."""
    file = tmp_path / "doubtful.toml"
    file.write_text(TEXT)
    shown = run("geometry", str(file), "--only", "coframe", "--format", form).stdout
    assert "undecided" in shown


def test_reports_mark_undecided_components(tmp_path):
    """A report marks undecided components on its page."""
    file = tmp_path / "doubtful.toml"
    file.write_text(TEXT)
    run("report", str(file), "-o", str(tmp_path / "page"))
    pages = list((tmp_path / "page").rglob("*.html"))
    assert pages
    assert any("Undecided whether zero" in page.read_text() for page in pages)

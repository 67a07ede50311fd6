"""Metrics typed as line elements or diagonals, and coframes typed as one-forms."""

from __future__ import annotations

from typing import Any

import pytest
import sympy as sp

import geomtorsion as gt

SPHERE = "r^2 (dtheta^2 + sin(theta)^2 dphi^2)"


@pytest.mark.parametrize(
    ("coordinates", "line", "rows"),
    [
        ("x", "dx^2", [[1]]),
        ("t x", "ds^2 = -dt^2 + dx^2", [[-1, 0], [0, 1]]),
        ("u v", "ds**2 = -du dv", [[0, "-1/2"], ["-1/2", 0]]),
        ("u v", "(du + v dv)*(du - v dv)", [[1, 0], [0, "-v**2"]]),
        ("t x", "-(dt - t*dx)^2 + dt^2/4", [["-3/4", "t"], ["t", "-t**2"]]),
        ("r θ", "dr^2 + r^2 dθ^2", [[1, 0], [0, "r**2"]]),
        ("θ φ", "4 dΩ^2", [[4, 0], [0, "4*sin(θ)**2"]]),
        ("theta phi", "dOmega_2**2", [[1, 0], [0, "sin(theta)**2"]]),
    ],
)  # fmt: skip
def test_a_line_element_is_its_matrix(coordinates, line, rows):
    """The coefficient of dq^mu dq^nu is 2 g_{mu nu} for different coordinates, as in books."""
    assert gt.Frame.from_metric(coordinates, line).metric == (
        gt.Frame.from_metric(coordinates, rows).metric
    )


def test_kerr_as_books_write_it_is_a_vacuum():
    """The line element of Boyer and Lindquist with squares of one-forms solves R_ab = 0."""
    sigma, delta = "(r^2 + a^2 cos(theta)^2)", "(r^2 - 2 M r + a^2)"
    line = (
        f"-{delta}/{sigma}*(dt - a sin(theta)^2 dphi)^2 + {sigma}/{delta}*dr^2 + {sigma} dtheta^2"
        f" + sin(theta)^2/{sigma}*((r^2 + a^2) dphi - a dt)^2"
    )
    frame = gt.Frame.from_metric("t r theta phi", line, parameters="M a")
    assert gt.levi_civita(frame).curvature.ricci.is_zero
    assert not gt.levi_civita(frame).curvature.is_zero


def test_vaidya_has_null_dust_only():
    """R_vv = 2 m'(v)/r^2 is the only component of the Ricci tensor (Vaidya 1951)."""
    line = f"-(1 - 2 m(v)/r) dv^2 + 2 dv dr + {SPHERE}"
    ricci = gt.levi_civita(gt.Frame.from_metric("v r theta phi", line)).curvature.ricci
    v, r = sp.symbols("v r")
    assert set(ricci.nonzero()) == {(0, 0)}
    assert ricci[0, 0] == 2 * sp.Function("m")(v).diff(v) / r**2


def test_symbols_with_assumptions_keep_them():
    """The text uses the symbols of the coordinates."""
    r, phi = sp.symbols("r phi", positive=True)
    assert gt.Frame.from_metric([r, phi], "dr^2 + r^2 dphi^2").coframe[1, 1] == r


def test_a_list_is_the_diagonal_of_a_metric():
    """Numbers, text and expressions; one entry in one dimension."""
    r = sp.Symbol("r")
    frame = gt.Frame.from_metric("t r theta", [-1, "1", r**2])
    assert frame.metric == gt.Frame.from_metric("t r theta", sp.diag(-1, 1, r**2)).metric
    assert gt.Frame.from_metric("x", ["x^2"]).metric[0, 0] == sp.Symbol("x") ** 2


def test_one_forms_in_text_are_rows_of_the_coframe():
    """In one dimension a text is the form, or its component."""
    rows = gt.Frame("r theta", [[1, 0], ["cos(theta)", "r"]])
    assert gt.Frame("r theta", ["dr", "cos(theta) dr + r dtheta"]) == rows
    assert gt.Frame("r", ["r dr"]) == gt.Frame("r", ["r"]) == gt.Frame("r", [["r"]])


def test_a_tetrad_file_may_have_them(tmp_path):
    """Names of the file, unknown functions included, may occur in all three."""
    for number, (shape, text, trace) in enumerate(
        [
            ("metric", '"-dt^2 + a^2 k^2 dx^2"', "a(t)**2*k**2 - 1"),
            ("metric", '["-1", "a^2 k^2"]', "a(t)**2*k**2 - 1"),
            ("coframe", '["dt", "a k dx"]', "a(t)**2*k**2 + 1"),
        ]
    ):
        path = tmp_path / f"cosmos{number}.toml"
        head = 'coordinates = ["t", "x"]\nparameters = ["k"]\nfunctions.a = ["t"]\n'
        path.write_text(f"{head}{shape} = {text}\n", "utf-8")
        g = gt.read(path).frame.metric
        names = {"t": sp.Symbol("t", real=True), "k": sp.Symbol("k", real=True)}
        assert sp.expand(g[0, 0] + g[1, 1] - gt.parse_expression(trace, names)) == 0


# What no checker of types lets pass.
MAPPED: Any = gt.Frame.from_metric
REFUSALS = {
    "linear": (lambda: gt.Frame.from_metric("r phi", "dr + dphi^2"), "quadratic in dr, dphi"),
    "cubic": (lambda: gt.Frame.from_metric("r phi", "dr^3"), "quadratic in dr, dphi"),
    "number": (lambda: gt.Frame.from_metric("r phi", "1"), "quadratic in dr, dphi"),
    "root": (lambda: gt.Frame.from_metric("r phi", "sqrt(dr^4 + dphi^4)"), "quadratic in"),
    "empty": (lambda: gt.Frame.from_metric("r phi", ""), "the expression is empty"),
    "no coordinates": (lambda: gt.Frame.from_metric("", "dr^2"), "dr is neither a coordinate"),
    "solid angle": (lambda: gt.Frame.from_metric("r phi", "dr^2 + r^2 dOmega^2"), "dOmega is"),
    "degenerate": (lambda: gt.Frame.from_metric("r phi", "dr^2"), "metric is degenerate"),
    "name": (lambda: gt.Frame.from_metric("r dr", "dr^2"), "uses one of the names dr, ddr"),
    "product": (lambda: gt.Frame("r phi", ["dr", "dr dphi"]), r"coframe\[1\]: exp"),
    "function": (lambda: gt.Frame("r phi", ["dr", "r"]), r"coframe\[1\]: exp"),
    "one row": (lambda: gt.Frame("r phi", ["dr"]), "coframe is not square"),
    "mapping": (lambda: MAPPED("r", {(0, 0): 1}), 'text: "dr\\^2'),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSALS)
def test_refusals(case):
    """The message names the entry, the expectation, and the typed text."""
    make, words = REFUSALS[case]
    with pytest.raises(gt.GeomtorsionError, match=words):
        make()


def test_a_file_names_itself_in_refusals(tmp_path):
    """A text that is not quadratic is an error of the file."""
    path = tmp_path / "line.toml"
    path.write_text('coordinates = ["r"]\nmetric = "dr"\n', "utf-8")
    with pytest.raises(gt.errors.FileFormatError, match="line.toml: metric: expected a sum"):
        gt.read(path)


def test_the_texts_that_a_wrong_name_suggests_are_spaces():
    """The message about a space that is not shipped contains texts that can be typed."""
    with pytest.raises(gt.errors.UnknownNameError) as refused:
        gt.spaces.load("minkowski")
    line, forms = str(refused.value).split("'")[3::2]
    assert gt.levi_civita(line).curvature.is_zero
    assert gt.cartan(forms).torsion.S[0, 1, 1] == 1 / (
        2 * gt.spaces.load(forms).frame.coordinates[0]
    )


def test_one_text_of_one_forms():
    """A coframe in one text is the coframe of its parts; functions keep their commas."""
    one = gt.Frame("x y", "f(x, y) dx, dy - x dx")
    assert one.coframe == gt.Frame("x y", ["f(x, y) dx", "dy - x dx"]).coframe
    nested = gt.Frame("x y", "atan2(x, sin(y)) dx, dy")
    assert str(nested.coframe[0, 0]) == "atan2(x, sin(y))"
    assert gt.same_geometry("dx^2 + dy^2", "dr^2 + r^2 dphi^2").verdict == "same"

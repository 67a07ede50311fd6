"""gravity: field equations for a Lagrangian in one line."""

import json
from pathlib import Path

import sympy as sp

from geomtorsion.exact import parse_expression
from tests.cli.running import run


def test_equations_of_a_tetrad() -> None:
    """A quadratic f(T) in a cosmology: the scalar, the equations and both Noether identities."""
    text = run("gravity", "frw", "-L", "T + c*T**2").stdout
    assert text.startswith("frw: L = T + c*T**2\nCartan connection\nconstants: c\nT = ")
    assert "\nE_1^1 = " in text
    assert "translations: holds" in text
    assert "rotations: holds" in text


def test_unknown_functions_are_named() -> None:
    """f(T) and its derivatives are printed by the name of the invariant: E = f - 12 H^2 f'."""
    text = run("gravity", "frw_flat", "-L", "f(T)").stdout
    assert "\nE_1^1 = f(T) - 12*a'(t)^2*f'(T)/a(t)^2\n" in text
    assert "\nE_2^2 = E_3^3 = E_4^4 = f(T) - 4*" in text
    assert "T'(t)" in text
    assert "Subs" not in text
    assert "diff(g(T, T1), T, T1)" in run("gravity", "frw_flat", "-L", "g(T, T1)").stdout


def test_invariants_of_one_value_keep_apart() -> None:
    """R = R6 = 0: both keep their names in f(R, R6)."""
    text = run("gravity", "schwarzschild", "-c", "levi-civita", "-L", "f(R, R6)").stdout
    assert "\nE_1^1 = E_2^2 = E_3^3 = E_4^4 = f(R, R6)\n" in text


def test_a_solution_is_one_line() -> None:
    """E = 0 takes one line: Kerr solves TEGR, Schwarzschild solves R + alpha GB."""
    assert "\nE = 0\n" in run("gravity", "kerr").stdout
    made = run("gravity", "schwarzschild", "-c", "levi-civita", "-L", "R + alpha*GB")
    assert "\nE = 0\n" in made.stdout


def test_two_connections_and_json() -> None:
    """Two connections with the Lagrangian T*Rbar; all equations in the JSON are readable."""
    made = run(
        *("gravity", "frw", "-c", "cartan", "-c", "levi-civita"),
        *("-L", "T*Rbar", "--format", "json"),
    )
    data = json.loads(made.stdout)
    assert data["connections"] == ["Cartan connection", "Levi-Civita connection"]
    assert data["identities"] == {"translations": True, "rotations": True}
    assert data["constants"] == []
    assert set(data["scalars"]) == {"T", "Rbar"}
    names = {"t": sp.Symbol("t"), "r": sp.Symbol("r"), "theta": sp.Symbol("theta")}
    names |= {"k": sp.Symbol("k")}
    for text in data["equations"]["E"].values():
        parse_expression(text, names)


def test_constants_are_declared_and_printed() -> None:
    """An exponent is declared by --constants, and the output and the data list it."""
    text = run("gravity", "frw_flat", "-L", "T + c*T**n", "--constants", "n").stdout
    assert "\nconstants: c n\n" in text
    made = run("gravity", "frw_flat", "-L", "T**n", "--constants", "n", "--format", "json")
    assert json.loads(made.stdout)["constants"] == ["n"]
    assert "--constants n" in run("gravity", "frw_flat", "-L", "T**n", code=2).stderr


def test_invariants_and_matter_of_the_command() -> None:
    """A formula with indices, a scalar field and a vector field, with the equations of matter."""
    text = run(
        *("gravity", "frw_flat", "-c", "levi-civita", "-L", "R - X/2 + c*Y"),
        *("--invariant", "Y = G^ab chi_a chi_b", "--scalar", "chi = u(t)"),
    ).stdout
    assert "\nY = 3*a'(t)^2*u'(t)^2/a(t)^2\n" in text
    assert "\nequation of chi: -(" in text
    assert "translations: holds" in text
    proca = (
        *("gravity", "frw_flat", "-L", "T - F2/4 - m**2*Y/2", "--invariant", "Y = A_a A^a"),
        *("--maxwell", "A(t), 0, 0, 0"),
    )
    assert "\nequation of A^1: m^2*A(t) = 0\n" in run(*proca).stdout
    data = json.loads(run(*proca, "--format", "json").stdout)
    assert data["matter_equations"] == {"A": {"0": "m^2*A(t)"}}
    error = run("gravity", "frw_flat", "-L", "Y", "--invariant", "R_ab R^ab", code=2).stderr
    assert 'Write --invariant "Y = R_abcd R^abdc".' in error


def test_invariant_connections_of_the_command(tmp_path: Path) -> None:
    """The most general torsion of a universe has two functions; a frame may have no symmetry."""
    text = run("gravity", "frw_flat", "-c", "invariant-torsion", "-L", "R").stdout
    assert "u1(t)" in text
    assert "u2(t)" in text
    assert "translations: holds" in text
    assert "u5(t)" in run("gravity", "frw_flat", "-c", "invariant", "-L", "R").stdout
    file = tmp_path / "none.toml"
    file.write_text('coordinates = ["x", "y"]\ncoframe = [[1, "x*y"], [0, "1 + x**3 + y"]]\n')
    error = run("gravity", str(file), "-c", "invariant", "-L", "R", code=2).stderr
    assert "the frame has no symmetry that is found" in error


def test_a_theory_file_of_the_command(tmp_path: Path) -> None:
    """-L takes a file; a theory of the metric has the Levi-Civita connection."""
    file = tmp_path / "square.toml"
    file.write_text(
        '[theory]\nlagrangian = "R + c*Y"\ngeometry = "riemannian"\n'
        'invariants = {Y = "R_ab R^ab"}\n'
    )
    text = run("gravity", "schwarzschild", "-L", str(file)).stdout
    assert "Levi-Civita connection" in text
    assert "\nE = 0\n" in text
    assert "no_file.toml" in run("gravity", "s2", "-L", "no_file.toml", code=2).stderr


def test_refusals_of_the_command() -> None:
    """An unknown name and a connection that does not fit end with code 2 and a message."""
    for text in ("", "  ", "nan", "self", "R + Ric2/2", "f(T,B)", "kretschmann", "foo"):
        error = run("gravity", "frw_flat", "-L", text, code=2).stderr
        assert error.startswith("geomtorsion: lagrangian: expected")
    assert "Did you mean T1" in run("gravity", "s2", "-L", "t1", code=2).stderr
    assert (
        "expected a flat metric connection"
        in run("gravity", "s2", "-L", "tegr", "-c", "levi-civita", code=2).stderr
    )

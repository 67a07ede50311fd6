"""Printing: field equations and waves with f_T, H and Hdot, as readers write them."""

import pickle

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity
from geomtorsion.gravity import perturbed

COSMOS = gt.spaces.load("frw_flat").frame
FLAT = gt.Frame("t x", [["1", "0"], ["0", "1"]], signature="-+")


def teleparallel(lagrangian: str, constants: str = "") -> gravity.FieldEquations:
    """Equations on the flat cosmos with the Cartan connection."""
    return gravity.equations(gt.cartan(COSMOS), lagrangian, constants=constants)


def test_friedmann_equation_of_f_of_t() -> None:
    """f - 12 H^2 f_T = 0 (Ferraro and Fiorini 2007), in text and in LaTeX."""
    E = teleparallel("f(T)").E
    assert "E[0, 0] = -12*f_T*Derivative(a(t), t)**2/a(t)**2 + f(T)" in str(E)
    for latex in (sp.latex(E), E.to_latex(), E._repr_latex_()):
        assert "f_{T}" in latex
        assert r"f_{TT} \frac{d}{d t} T" in latex
        assert "xi" not in latex


def test_components_stay_exact() -> None:
    """E[0, 0] is an expression in the coordinates, in which f can be given."""
    value = teleparallel("f(T)").E[0, 0]
    f = sp.Function("f")
    given = value.replace(f, lambda x: x**2).doit()
    assert sp.simplify(given - teleparallel("T**2").E[0, 0]) == 0


@pytest.mark.parametrize("form", ["E_lower", "symmetric", "M", "C", "L", "P"])
def test_no_tensor_of_the_equations_has_dummies(form: str) -> None:
    """All tensors of the equations name the function and its argument."""
    tensor = getattr(teleparallel("f(T)"), form)
    for text in (str(tensor), sp.latex(tensor), str(tensor.table()), str(-2 * tensor)):
        assert "Subs" not in text
        assert "xi" not in text
        assert "f_T" in text or "f(T)" in text or r"f{\left(T \right)}" in text or "f_{T}" in text


def test_forms_keep_the_names() -> None:
    """Coordinates, heights, orders and pickles of E print as E does."""
    equations = teleparallel("f(T)")
    again = pickle.loads(pickle.dumps(equations.E))
    assert str(again) == str(gravity.equations(gt.cartan(again.frame), "f(T)").E)
    assert "f_TT" in str(equations.E.in_coordinates())
    epsilon, z = sp.Symbol("epsilon"), COSMOS.coordinates[3]
    h = sp.Function("h")(COSMOS.coordinates[0], z)
    a = sp.Function("a")(COSMOS.coordinates[0])
    rows = sp.diag(1, a * (1 + epsilon * h), a * (1 - epsilon * h), a)
    waves = gt.Frame(COSMOS.coordinates, rows, "-+++", parameters=[epsilon])
    first = gravity.equations(gt.cartan(waves.expanded("epsilon", 1)), "f(T)").E.order(1)
    assert "f_T*" in str(first)
    assert "Subs" not in str(first)


def test_sums_and_several_arguments() -> None:
    """f'(T + c T1) for a sum, f_T_T1 for two arguments."""
    assert "f''(T + T1*c)" in str(teleparallel("f(T + c*T1)", constants="c"))
    assert "f_T_T1" in str(teleparallel("f(T, T1)"))
    assert "f_T_phi" in str(
        gravity.equations(gt.cartan(COSMOS), "f(T, phi)", gravity.scalar_field("phi(t)"))
    )


def test_a_sum_among_several_arguments_has_its_number() -> None:
    """f(T, Rbar + T): f_T2 is the derivative by T and by the second argument."""
    waves = perturbed.tensor_modes("f(T, Rbar + T)", "teleparallel")
    assert "f_T2" in str(waves)
    assert "Subs" not in str(waves)
    assert "M^2 = -2*f_T\n" in str(waves)


def test_names_with_another_meaning_are_not_used() -> None:
    """A constant f_T beside f(T): the derivative is written out."""
    text = str(teleparallel("f(T) + f_T*T1"))
    assert "Derivative(f(T), T)" in text
    assert "f_TT" in text


def test_equations_print_themselves() -> None:
    """Invariants and the distinct equations; nothing but the Lagrangian in flat space."""
    lines = str(teleparallel("f(T)")).splitlines()
    assert [line.split(" = ")[0].strip() for line in lines[1:]] == ["T", "E_1^1", "E_2^2"]
    flat = str(gravity.equations(gt.cartan(FLAT), "T1")).splitlines()
    assert flat[1:] == ["  T1 = 0", "  all equations hold"]
    field = gravity.equations(
        gt.levi_civita(COSMOS), "R/2 - X/2 - V(phi)", gravity.scalar_field("phi(t)")
    )
    assert "equation of phi: " in str(field)
    assert "V_phi" in str(field)
    assert sp.latex(field) == field.to_latex()
    assert r"\text{equation of } \phi" in field.to_latex()
    assert "V_{\\phi}" in field.to_latex()


def test_notebook_shows_the_same_names() -> None:
    """The page of a notebook writes f_T with a subscript."""
    html = teleparallel("f(T)")._repr_html_()
    assert "<msub><mi>f</mi><mi>T</mi></msub>" in html


def test_waves_have_dots() -> None:
    """c_T^2 = (1 + 8 c phi'')/(1 + 8 c H phi'), M^2 = -2 f_T."""
    waves = perturbed.tensor_modes("R/2 - X/2 + c*phi*GB", "riemannian", scalars="phi")
    assert "c_T^2 = (8*c*phiddot + 1)/(8*H*c*phidot + 1)" in str(waves)
    assert r"\ddot{\phi}" in waves._repr_latex_()
    assert "M^2 = -2*f_T\n" in str(perturbed.tensor_modes("f(T)", "teleparallel"))
    assert "G = -1/(2*f_T)" in str(perturbed.growth("f(T)", "teleparallel"))
    field = perturbed.scalar_modes("R/2 + K(X)")
    assert "K_XX" in str(field)
    assert "Derivative" not in str(field)

"""Connections: from a torsion, from a connection, and refusals by name."""

from typing import Any

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ExpressionError, SignatureError

X, Y, Z, C = sp.symbols("x y z c")
R, PHI = sp.symbols("r phi", positive=True)
POLAR = gt.Frame([R, PHI], [[1, 0], [0, R]])


@pytest.mark.parametrize("name", ["so3", "kerr", "axial_torsion", "twisted_bar"])
def test_torsion_leads_back(name):
    """The metric connection with the torsion of the Cartan connection is the Cartan connection."""
    frame = gt.spaces.load(name).frame
    cartan = gt.cartan(frame)
    again = gt.from_torsion(frame, cartan.torsion)
    assert again.coefficients == cartan.coefficients
    assert again.metric_compatible
    assert gt.from_torsion(frame, cartan.torsion.S.in_frame()).coefficients == cartan.coefficients


def test_torsion_from_an_array():
    """Totally antisymmetric torsion on flat space: K = S, and geodesics are autoparallels."""
    flat = gt.Frame([X, Y, Z], sp.eye(3))
    torsion = [[[C * sp.LeviCivita(a, b, k) for k in range(3)] for b in range(3)] for a in range(3)]
    connection = gt.from_torsion(flat, torsion)
    assert connection.torsion.S[0, 1, 2] == C
    assert connection.contortion[0, 1, 2] == C
    assert connection.torsion.force_coefficients.is_zero
    assert connection.metric_compatible


def test_of_a_connection_its_frame_is_taken():
    """levi_civita and cartan of a connection use its frame; identities of a frame use cartan."""
    cartan = gt.cartan(POLAR)
    assert gt.levi_civita(cartan) is gt.levi_civita(POLAR)
    assert gt.cartan(gt.levi_civita(POLAR)) is cartan
    assert gt.identities(POLAR) == gt.identities(cartan)
    wrong: Any = POLAR.metric
    with pytest.raises(TypeError, match="frame: expected a Frame, got "):
        gt.levi_civita(wrong)
    with pytest.raises(TypeError, match="connection: expected a Connection, got "):
        gt.identities(wrong)


def test_surface_with_unknown_functions():
    """E, F, G unknown: the coframe has sqrt(E), and Brioschi's formula gives the curvature."""
    e, f, g = (sp.Function(name)(X, Y) for name in "EFG")
    frame = gt.Frame.from_metric([X, Y], [[e, f], [f, g]])
    assert frame.eta[0, 0] == frame.eta[1, 1] == 1
    assert frame.coframe[0, 0] == sp.sqrt(e)
    assert sp.simplify(frame.determinant[()] ** 2 - (e * g - f**2)) == 0
    assert frame.sample_point
    first = sp.Matrix(
        [
            [-e.diff(Y, 2) / 2 + f.diff(X, Y) - g.diff(X, 2) / 2, e.diff(X) / 2,
             f.diff(X) - e.diff(Y) / 2],
            [f.diff(Y) - g.diff(X) / 2, e, f],
            [g.diff(Y) / 2, f, g],
        ]
    )  # fmt: skip
    second = sp.Matrix([[0, e.diff(Y) / 2, g.diff(X) / 2], [e.diff(Y) / 2, e, f],
                        [g.diff(X) / 2, f, g]])  # fmt: skip
    gauss = (first.det() - second.det()) / (e * g - f**2) ** 2
    assert gt.levi_civita(frame).curvature.scalar == 2 * gauss


def test_unknown_functions_with_a_signature():
    """Signs follow from the requested signature, or from visible signs of the entries."""
    e, f, g = (sp.Function(name)(X, Y) for name in "EFG")
    asked = gt.Frame.from_metric([X, Y], [[e, f], [f, g]], signature=(-1, 1))
    assert (asked.eta[0, 0], asked.eta[1, 1]) == (-1, 1)
    assert asked.coframe[1, 0] == sp.sqrt(e)
    shown = gt.Frame.from_metric([X, Y], [[-e, 0], [0, g]])
    assert (shown.eta[0, 0], shown.eta[1, 1]) == (-1, 1)


@pytest.mark.parametrize("signature", [5, "+x", (1, 2), (1,), [[1, 2], [3, 4]], (1, "1"), None])
def test_invalid_signatures_are_refused(signature):
    """A number, a text, entries other than 1 and -1, or a wrong size is refused as signature."""
    makers = (
        lambda: gt.Frame([X, Y], [[1, 0], [0, 1]], signature=signature),
        lambda: gt.Frame.from_frame([X, Y], [[1, 0], [0, 1]], signature=signature),
        lambda: gt.Frame.from_metric([X, Y], [[1, 0], [0, 1]], signature=signature),
    )
    for make in makers:
        if signature is None:
            assert make().eta[0, 0] == 1
        else:
            with pytest.raises(SignatureError, match="signature"):
                make()


@pytest.mark.parametrize(
    "entry",
    [sp.I * X, (1 + sp.I) * (1 - sp.I), (sp.exp(sp.I * X) + sp.exp(-sp.I * X)) / 2, 1j, 2 + 0j],
)
def test_complex_entries_are_named(entry):
    """Entries that are complex and not declared so are refused by name, also if I cancels."""
    with pytest.raises(ExpressionError, match=r"coframe\[1, 1\]: .*complex"):
        gt.Frame([X, Y], [[1, 0], [0, entry]])
    with pytest.raises(ExpressionError, match=r"connection coefficients\[0, 1, 0\]: .*complex"):
        gt.from_coefficients(POLAR, [[[0, 0], [entry, 0]], [[0, 0], [0, 0]]])


def test_complex_entries_that_are_declared():
    """With complex=True exact complex entries are read; 1j is refused."""
    frame = gt.Frame([X, Y], [[1, sp.I], [1, -sp.I]], [[0, 1], [1, 0]], complex=True)
    assert frame.metric[0, 0] == 2
    with pytest.raises(ExpressionError, match=r"coframe\[0, 1\]: 1j .*sympy\.I"):
        gt.Frame([X, Y], [[1, 1j], [1, -1j]], [[0, 1], [1, 0]], complex=True)


def test_plain_texts_have_no_latex():
    """repr contains no LaTeX."""
    for thing in (gt.levi_civita(POLAR), gt.cartan(POLAR), gt.levi_civita(POLAR).spin_connection,
                  gt.levi_civita(POLAR).curvature, POLAR.volume, POLAR.eta):  # fmt: skip
        assert "\\" not in repr(thing)
    assert "Gamma_bar[0, 1, 1] = 1/r" in repr(gt.levi_civita(POLAR))
    assert "sqrt(g) = r" in repr(POLAR.volume)


def test_identities_and_plans_show_themselves():
    """Identities and plans print one line each in a terminal, and a table in a notebook."""
    checks = gt.identities(gt.cartan(POLAR))
    assert repr(checks).splitlines()[0] == "metricity: holds (6 components): D_a g_bc = 0"
    assert checks._repr_html_().count("<tr>") == 6
    plan = POLAR.plan("ricci")
    assert repr(plan) == str(plan)
    assert "<td>christoffel</td>" in plan._repr_html_()
    assert "\\" not in repr(plan)


@pytest.mark.parametrize("zero", [0, X])
def test_a_connection_takes_coefficients_as_nested_lists(zero: Any) -> None:
    """Lists and arrays are read as by `from_coefficients`; a wrong shape is refused."""
    flat = gt.Frame([X, Y], sp.eye(2))
    entries = [[[zero, 0], [Y, 0]], [[0, 0], [0, 0]]]
    wrong: Any = gt.Connection
    for values in (entries, sp.Array(entries)):
        own = wrong(flat, values)
        assert own.coefficients == gt.from_coefficients(flat, entries).coefficients
        assert own.torsion.S[0, 1, 0] == Y / 2
    for values in ([1, 2], 3, None, "Gamma"):
        with pytest.raises(gt.GeomtorsionError):
            wrong(flat, values)

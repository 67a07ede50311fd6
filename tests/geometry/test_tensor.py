"""Tensor: access, changes of indices, arithmetic, numbers and notation."""

import math
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import (
    CoordinateError,
    GeomtorsionError,
    MissingValueError,
    SingularPointError,
    TensorIndexError,
)
from geomtorsion.geometry import Frame, Tensor, cartan, contract, levi_civita
from geomtorsion.geometry.components import antisymmetric, symmetric
from geomtorsion.geometry.from_arrays import tensor_from_array
from geomtorsion.spaces import load

r, phi, M = sp.symbols("r phi M", positive=True)


@pytest.fixture
def frame() -> Frame:
    return Frame([r, phi], [[1, 0], [0, r]])


def test_a_single_component_computes_only_itself(frame: Frame) -> None:
    """The computation of one component does not compute others."""
    tensor = cartan(frame).torsion.T
    assert tensor[0, 1, 1] == 1 / r
    assert tensor.components.computed == 1
    assert cartan(frame).coefficients.components.computed == 2


def test_symmetric_components_are_computed_once(frame: Frame) -> None:
    """The rule is called for one of several components that follow from each other."""
    asked = []

    def rule(index):
        asked.append(index)
        return frame.field.one

    tensor = Tensor(frame, "dd", rule, antisymmetric(2))
    assert tensor.to_sympy().tolist() == [[0, 1], [-1, 0]]
    assert asked == [(0, 1)]


def test_symmetry_holds_only_between_indices_of_one_kind(frame: Frame) -> None:
    """A symmetric tensor with one index raised is not symmetric."""
    tensor = Tensor(frame, "dd", {(0, 1): r}, symmetric(2))
    assert tensor.raised(0).nonzero() == {(0, 1): r, (1, 0): 1 / r}
    assert tensor.raised(0).lowered(0) == tensor


def test_index_changes(frame: Frame) -> None:
    """Each change of a slot multiplies by the right matrix."""
    vector = tensor_from_array(frame, "u", [0, 1], "v")
    assert vector.lowered().nonzero() == {(1,): r**2}
    assert vector.in_frame().nonzero() == {(1,): r}
    assert vector.in_frame().slots == "U"
    covector = vector.lowered()
    assert covector.in_frame().nonzero() == {(1,): r}
    assert covector.in_frame().in_coordinates() == covector
    assert frame.metric.raised() == frame.inverse_metric
    assert frame.eta.raised().nonzero() == {(0, 0): 1, (1, 1): 1}


def test_lorentzian_frame_index() -> None:
    """A frame index is moved by eta."""
    t, x = sp.symbols("t x", real=True)
    frame = Frame([t, x], [[1, 0], [0, 1]], signature=(-1, 1))
    vector = tensor_from_array(frame, "U", [2, 3], "v")
    assert vector.lowered(0).nonzero() == {(0,): -2, (1,): 3}


def test_connection_coefficients_have_no_frame_form(frame: Frame) -> None:
    """Connection coefficients have no frame form; the error names the spin connection."""
    with pytest.raises(TensorIndexError, match="spin_connection"):
        cartan(frame).coefficients.in_frame()
    with pytest.raises(TensorIndexError, match="expected a tensor in all its indices"):
        cartan(frame).covariant_derivative(cartan(frame).coefficients)
    assert levi_civita(frame).spin_connection.in_frame().slots == "DDU"


def test_arithmetic(frame: Frame) -> None:
    """Sums, multiples, quotients and exact equality."""
    g = frame.metric
    assert g + g == g * 2 == 2 * g
    assert (g - g).is_zero is True
    assert -g == g * -1
    assert (g * M / M) == g
    assert hash(g + g) == hash(g * 2)
    assert g != frame.inverse_metric
    assert g != "g"
    with pytest.raises(TensorIndexError, match="equal slots"):
        _ = g + frame.inverse_metric
    with pytest.raises(TensorIndexError, match="contract"):
        _ = g * g
    with pytest.raises(TensorIndexError, match="expected a tensor to add"):
        _ = g + 1  # pyright: ignore[reportOperatorIssue] - also refused at run time
    with pytest.raises(ZeroDivisionError, match="exactly zero"):
        _ = g / (sp.sin(r) ** 2 + sp.cos(r) ** 2 - 1)


def test_matmul(frame: Frame) -> None:
    """@ sums the last index of one over the first of the other."""
    assert (frame.metric @ frame.inverse_metric).nonzero() == {(0, 0): 1, (1, 1): 1}
    with pytest.raises(TensorIndexError, match="down in"):
        _ = frame.metric @ frame.metric


def test_contraction(frame: Frame) -> None:
    """Traces, permutations and products, each against sums written out."""
    torsion = cartan(frame).torsion.T
    trace = contract("abb->a", torsion)
    for k in range(2):
        assert trace[k] == sum(torsion[k, b, b] for b in range(2))
    turned = contract("abc->cab", torsion)
    assert turned.slots == "udd"
    assert turned[1, 0, 1] == torsion[0, 1, 1]
    lower = contract("abc,cd->abd", torsion, frame.metric)
    assert lower == torsion.lowered(2)
    other = torsion.raised(0).raised(1).lowered(2)
    square = contract("abc,abd,cd->", lower, other, frame.inverse_metric)
    assert square.slots == ""
    assert square[()] == sp.Rational(2) / r**2
    assert contract("abc,cd", torsion, frame.metric) == lower


def test_contraction_computes_only_one_component(frame: Frame) -> None:
    """A contraction computes only the requested component."""
    lower = contract("abc,cd->abd", cartan(frame).torsion.T, frame.metric)
    assert lower[0, 1, 1] == r
    assert lower.components.computed == 1


def test_contraction_keeps_symmetries(frame: Frame) -> None:
    """Free indices of a factor keep their known symmetries."""
    lower = contract("abc,cd->abd", cartan(frame).torsion.T, frame.metric)
    assert lower.components.symmetry == antisymmetric(3)


def test_numbers(frame: Frame) -> None:
    """Values at a point, by symbol or by name; missing and wrong values are named."""
    metric = frame.metric * M
    assert np.array_equal(metric.at({r: 3, "M": sp.Rational(1, 2)}), [[0.5, 0], [0, 4.5]])
    with pytest.raises(MissingValueError, match="M"):
        metric.at({r: 3})
    with pytest.raises(CoordinateError, match="rho"):
        metric.at({"rho": 3})
    assert metric.at({sp.Symbol("r"): 3, M: 1})[1, 1] == 9
    with pytest.raises(
        CoordinateError, match=r"expected r once, got Symbol\('r', .*\) and Symbol\('r'\)"
    ):
        metric.at({r: 3, sp.Symbol("r"): 3, M: 1})
    with pytest.raises(SingularPointError, match="r = 0"):
        frame.inverse_metric.at({r: 0})


@pytest.mark.parametrize("digits", [1, 15, 30, 50, 400])
def test_numbers_of_many_digits(frame: Frame, digits: int) -> None:
    """All requested digits are right at any mpmath precision; signs are exact."""
    point = {r: sp.Rational(1, 3), M: sp.sqrt(2)}
    torsion = (cartan(frame).torsion.T * M).at(point, digits=digits)
    with mpmath.workdps(digits + 20):
        truth = 3 * mpmath.sqrt(2)
        assert abs(torsion[0, 1, 1] / truth - 1) < mpmath.mpf(10) ** -digits
        assert torsion[1, 0, 1] == -torsion[0, 1, 1]
    assert torsion[0, 0, 0] == 0
    assert mpmath.mp.dps == 15


@pytest.mark.parametrize("digits", [0, -3, 2.5, 1001, "50", True])
def test_digits_are_a_whole_number(frame: Frame, digits: object) -> None:
    """A number of digits that is not a whole number from 1 to 1,000 is refused."""
    with pytest.raises(CoordinateError, match="digits: expected a whole number from 1 to 1,000"):
        frame.metric.at({r: 1}, digits=digits)  # type: ignore[arg-type]


def test_a_number_that_floats_do_not_hold_has_digits(frame: Frame) -> None:
    """A value beyond the range of floats is finite with digits."""
    value = frame.metric.at({r: 10**200}, digits=20)[1, 1]
    assert abs(mpmath.log10(value) - 400) < 1e-12


def test_numbers_of_a_scalar(frame: Frame) -> None:
    """A scalar gives an array without axes."""
    assert float(frame.determinant.at({r: 2})) == 2.0


def test_numbers_of_an_antisymmetric_tensor(frame: Frame) -> None:
    """Signs of components that follow from others are right."""
    torsion = cartan(frame).torsion.T.at({r: 2})
    assert torsion[0, 1, 1] == 0.5
    assert torsion[1, 0, 1] == -0.5


def test_given_components_follow_the_symmetry(frame: Frame) -> None:
    """A mapping may name any of the equivalent components."""
    tensor = Tensor(frame, "dd", {(1, 0): r}, antisymmetric(2))
    assert tensor[0, 1] == -r
    assert tensor[1, 0] == r


def test_arrays_come_back(frame: Frame) -> None:
    """to_sympy and reading are inverse to each other; NumPy arrays of exact numbers are read."""
    torsion = cartan(frame).torsion.T
    assert tensor_from_array(frame, "ddu", torsion.to_sympy(), "T") == torsion
    assert tensor_from_array(frame, "d", np.array([0, 2]), "w").nonzero() == {(1,): 2}
    assert frame.determinant.to_sympy() == r


def test_notation(frame: Frame) -> None:
    """repr names and lists components; LaTeX shows each index at its height."""
    torsion = cartan(frame).torsion
    assert repr(torsion.S).splitlines()[1] == "  S[0, 1, 1] = 1/(2*r)"
    assert torsion.S.label == "S_{ab}^{c}"
    assert "vanish" in repr(levi_civita(frame).torsion.S)
    assert r"S_{r \phi }{}^{\phi } &= \frac{1}{2 r}" in torsion.S._repr_latex_()
    assert r"C_{\hat{1}\hat{2}}{}^{\hat{2}}" in frame.anholonomy._repr_latex_()
    assert frame.metric._repr_latex_().startswith(r"$\displaystyle g_{ab} = \begin{pmatrix}")
    assert frame.determinant._repr_latex_() == r"$\displaystyle e = r$"
    assert r"\mathrm{d}\phi" in frame._repr_latex_()
    assert "e^2 = r dphi" in repr(frame)
    assert "0" in cartan(frame).curvature._repr_latex_()


@pytest.mark.parametrize(
    "bad", [math.nan, math.inf, -math.inf, sp.nan, sp.oo, sp.zoo, complex(0, math.inf)], ids=str
)
@pytest.mark.parametrize("symbol", ["M", "r", "theta"])
def test_no_number_is_refused_by_name_at_once(bad: object, symbol: str) -> None:
    """A value that is not finite is refused by name, because its evaluation would never end."""
    black_hole = load("schwarzschild").frame
    point = {"t": 0, "r": 5, "theta": 1, "phi": 0, "M": 1, symbol: bad}
    before = mpmath.mp.prec
    for tensor in (black_hole.metric, levi_civita(black_hole).curvature.kretschmann):
        for digits in (None, 30):
            with pytest.raises(CoordinateError, match=f"point: {symbol}: expected a .*number"):
                tensor.at(point, digits=digits)
    assert mpmath.mp.prec == before


def test_masked_points_are_not_known(frame: Frame) -> None:
    """A masked point is refused, instead of taking the number under the mask."""
    hidden = np.ma.array([1.0, 2.0], mask=[False, True])
    with pytest.raises(CoordinateError, match="point: r: expected a number, got None"):
        cartan(frame).torsion.T.at({r: hidden})
    assert cartan(frame).torsion.T.at({r: np.ma.array([1.0, 2.0])}).shape == (2, 2, 2, 2)


@pytest.mark.parametrize("digits", [None, 30])
def test_values_against_declarations(digits):
    """A value against the assumptions of M is refused; the error names the first of several."""
    M = sp.Symbol("M", positive=True)
    x, y = sp.symbols("x y", real=True)
    metric = Frame([x, y], [[1, 0], [0, sp.sqrt(M**2) + x**2]]).metric
    said = "M: expected a value that is positive, nonnegative, as declared, got {}"
    for key in (M, "M", sp.Symbol("M")):
        with pytest.raises(CoordinateError, match=said.format("-1")):
            metric.at({x: 1, key: -1}, digits=digits)
    with pytest.raises(CoordinateError, match=said.format("-1.5")):
        metric.at({x: 1, M: [1, -1.5, -2]}, digits=digits)
    assert metric.at({x: 0, M: [0, 2]}, digits=digits)[:, 1, 1].tolist() == [0, 4]


def test_components_as_an_array() -> None:
    """Nested lists and arrays give the tensor of the same table; other things are refused."""
    frame = load("s2").frame
    table = Tensor(frame, "dd", {(0, 0): 1, (0, 1): "R"})
    for values in ([[1, "R"], [0, 0]], sp.Matrix([[1, sp.Symbol("R", positive=True)], [0, 0]])):
        assert (Tensor(frame, "dd", values) - table).is_zero
    wrong: list[Any] = [5, "x", None, [1, 2], [[1, 0]]]
    for values in wrong:
        with pytest.raises(GeomtorsionError, match="expected 2 entries"):
            Tensor(frame, "dd", values)[0, 0]

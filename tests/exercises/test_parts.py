"""Parts: domain, numeric values, limits, reading, writing, mistakes."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion import spaces
from geomtorsion.errors import ExpressionError, LimitError, UnknownNameError
from geomtorsion.exercises import registry
from geomtorsion.exercises.answers import answer_text, components, expression, index, rational
from geomtorsion.exercises.domain import POINTS, Domain
from geomtorsion.exercises.equations import equations
from geomtorsion.exercises.families import ANGLES, attitude, matrix_of, seen_from_space
from geomtorsion.exercises.limits import ANSWER, MOST, check_constants, check_weight
from geomtorsion.exercises.numbers import numbers
from geomtorsion.exercises.numeric import at_point, at_points
from geomtorsion.exercises.prompts import plain_name
from geomtorsion.exercises.question import (
    Mistake,
    Question,
    all_mistakes,
    deviation,
    normal,
    permuted,
    reordered,
    scaled,
)

x, y = sp.symbols("x y", real=True)


def question(kind="expression", **more) -> Question:
    """A question whose answer is x."""
    return Question("q", kind, "?", lambda: more.pop("right", x), Domain((x, y)), **more)


def test_points_lie_in_the_domain():
    """As many as asked for, spread over the whole of it, the same each time."""
    frame = spaces.load("so3").frame
    domain = Domain.of(frame)
    assert len(domain.points) == POINTS
    for relation in frame.domain:
        assert all(relation.subs(point) == sp.true for point in domain.points)
    second = [float(point[frame.coordinates[1]]) for point in domain.points]
    assert min(second) < 0.6
    assert max(second) > 2.5
    assert domain.points == Domain.of(frame).points


def test_greek_letters_are_names():
    """phi2 may be written as a person would."""
    names = Domain.of(spaces.load("so3").frame).names
    assert names["φ2"] == names["phi2"]


@pytest.mark.parametrize(
    "text",
    ["sin(x)*exp(y)/(2 + cos(x))", "sqrt(2 + x)", "atan2(x, y)", "acot(x)", "sec(x)*csc(y)",
     "log(3 + x, 2)", "asinh(x) + acosh(2 + y) + atanh(y/3)", "sech(x)*csch(y)", "pi*E*coth(x)",
     "x^(1/3)"],
)  # fmt: skip
def test_values_agree_with_sympy(text):
    """Floats at many points and many digits at one, against sympy's own evaluation."""
    expr = expression(question(), text, "q")
    point = {x: sp.Rational(3, 7), y: sp.Rational(5, 9)}
    exact = complex(expr.subs(point).evalf(40))
    arrays = {symbol: np.array([float(value)]) for symbol, value in point.items()}
    assert complex(at_points(expr, arrays)[0]) == pytest.approx(exact, rel=1e-13)
    many = at_point(expr, point)
    assert many is not None
    want = mpmath.mpmathify(expr.subs(point).evalf(60))
    assert abs(many - want) < mpmath.mpf(10) ** -55 * (1 + abs(want))


def test_no_value_is_none():
    """Poles and numbers beyond all size have no value; neither takes time or memory."""
    assert at_point(1 / (x - y), {x: sp.Integer(1), y: sp.Integer(1)}) is None
    assert at_point(sp.exp(sp.exp(sp.exp(x))), {x: sp.Integer(30)}) is None
    assert np.isnan(np.real(at_points(1 / x - 1 / x**2, {x: np.array([0.0])}))).all()


def test_weights_bound_what_is_multiplied_out():
    """Powers, products, multiple angles and fractions all count."""
    check_weight(sp.sin(5 * x) / (1 + x) + sp.sqrt(1 + y), "q")
    for heavy in (
        ((1 + x + y) * (1 - x + 2 * y) * (x - 3 * y + 5)) ** 24,
        sp.sin(10**9 * x),
        sp.Add(*(1 / (x + k * y + k**2) for k in range(30))),
        sp.Mul(*(sp.sqrt(x + k) for k in range(2, 9))),
    ):
        with pytest.raises(LimitError, match="Write it shorter"):
            check_weight(heavy, "q")


@pytest.mark.parametrize(
    "text", ["sin(1000*pi)", "x^24", "exp(-30)*x", "sqrt(10^40)", "log(10^40)", "cosh(x)^2",
             "10^20*x", "pi^2/E", "1/3 - 1/2", "atan2(1, x)", "sin(", "", "x x"],
)  # fmt: skip
def test_constants_of_use(text):
    """What a person writes passes; what is no expression is left to the parser."""
    try:
        check_constants(text, ["x"], "q", ANSWER)
    except LimitError:
        pytest.fail("refused for its size")
    except ExpressionError:
        assert text in ("sin(", "", "x x")


@pytest.mark.parametrize(
    "text",
    ["sin(10^20)", "sec(cosh(9999))", "exp(10^5)", "x^(10^3/7)", "tan(-10^9)", "cosh(1/10^-9)"],
)
def test_constants_beyond_use(text):
    """Functions of huge constants are refused before sympy sees them."""
    with pytest.raises(LimitError, match="Write it shorter"):
        check_constants(text, ["x"], "q", ANSWER)


def test_decimals_are_exact():
    """0.1 is a tenth."""
    assert rational("0.1 + 2.5e-2*x") == "(1/10) + (25/1000)*x"
    assert expression(question(), "0.1*3 - 0.3", "q") == 0
    assert expression(question(), "x^0.5", "q") == sp.sqrt(x)
    assert plain_name("phi1' + r''") == "phi1_d + r_dd"


@pytest.mark.parametrize(
    ("text", "found"),
    [("1,2,1", (0, 1, 0)), ("121", (0, 1, 0)), ("Gamma_12^1", (0, 1, 0)), ("Γ_{12}^{1}", (0, 1, 0)),
     ("Gamma[1, 2, 1]", (0, 1, 0)), ("x,y,x", (0, 1, 0)), ("(1 2 1)", (0, 1, 0)),
     ("0,1,0", (-1, 0, -1))],
)  # fmt: skip
def test_indices(text, found):
    """All ways to write an index."""
    assert index(question("components", shape=(2, 2, 2)), text, "q") == found


@pytest.mark.parametrize(
    "text", ["1,2", "1,2,3", "1,2,9999", "a,b,c", "", "1,-2,1", "x", "1.5,1,1"]
)
def test_no_indices(text):
    """What is no index is refused with an example."""
    with pytest.raises(ExpressionError, match=r"1,1,1 = \.\.\.|runs from 1 to 2"):
        index(question("components", shape=(2, 2, 2)), text, "q")


def test_components_are_counted():
    """More entries than there can be are refused."""
    with pytest.raises(LimitError, match="the limit is"):
        components(question("components", shape=(2, 2)), {f"1,{k}": 1 for k in ["1"] * 1} | {
            f"1,1{' ' * k}": 1 for k in range(600)
        }, "q")  # fmt: skip


def test_answers_are_written_as_they_are_read():
    """Texts that the library writes are read back as the same values."""
    value = {(0, 1): sp.sin(x) / y, (1, 1): -x}
    asked = question("components", shape=(2, 2))
    assert components(asked, answer_text(asked, value), "q") == value
    asked = question("equations", unknowns=("x'", "y''"))
    value = {(0,): x * y, (1,): -x}
    assert answer_text(asked, value) == "x' = x*y; y'' = -x"
    assert equations(asked, answer_text(asked, value), "q") == value
    asked = question("number", unit="deg")
    assert numbers(asked, answer_text(asked, {(): 12.5}), "q") == {(): 12.5}


def test_deviation_counts_tolerances():
    """One tolerance away is one, relative to the largest component."""
    asked = question("number", tolerance=1e-2)
    assert deviation(asked, {(): 101.0}, {(): 100.0}) == pytest.approx(1)
    assert deviation(asked, {(0,): 100.0, (1,): 2.0}, {(0,): 100.0}) == pytest.approx(2)
    assert deviation(asked, {(): 0.01}, {}) == pytest.approx(1)


def test_mistakes_never_equal_the_solution():
    """A permuted symmetric tensor, a doubled zero: these are no mistakes."""
    symmetric = Question(
        "q", "components", "?", lambda: [[1, 2], [2, 3]], Domain((x,)),
        lambda: [Mistake("inverse", [[1, 2], [2, 3]])], shape=(2, 2),
    )  # fmt: skip
    assert {m.code for m in all_mistakes(symmetric)} == {"sign", "factor"}
    zero = Question("q", "expression", "?", lambda: 0, Domain((x,)))
    assert all_mistakes(zero) == ()


def test_permutations():
    """All other orders of the indices, once each."""
    value = {(0, 1, 2): 5}
    assert len(list(permuted(value, (3, 3, 3)))) == 5
    assert list(permuted(value, (3, 3, 2))) == []
    assert reordered(value, (2, 0, 1)) == {(2, 0, 1): 5}
    assert scaled(value, -1) == {(0, 1, 2): -5}
    assert normal(sp.Matrix([[0, 1]])) == {(0, 1): 1}
    assert normal(np.array([0.0, 2.0])) == {(1,): 2.0}


@pytest.mark.parametrize("name", sorted(ANGLES))
def test_frames_belong_to_their_attitude(name):
    """R^T R' is the coframe applied to the rates, R' R^T that of the space-fixed frame."""
    frame, turn = spaces.load(name).frame, attitude(name)
    angles = frame.coordinates
    here = dict(zip(angles, (0.3, 1.1, -0.7), strict=True))

    def numbers_of(matrix) -> np.ndarray:
        return np.array(matrix.subs(here).tolist(), dtype=float)

    body_space = numbers_of(turn)
    assert body_space.T @ body_space == pytest.approx(np.eye(3), abs=1e-14)
    for mu, angle in enumerate(angles):
        slope = numbers_of(turn.diff(angle))
        for table, matrix in (
            (frame, body_space.T @ slope),
            (seen_from_space(name), slope @ body_space.T),
        ):
            column = numbers_of(matrix_of(table.coframe))[:, mu]
            assert column == pytest.approx([matrix[2, 1], matrix[0, 2], matrix[1, 0]], abs=1e-14)


def test_the_space_fixed_frame_is_the_shipped_one():
    """For the angles of the paper it is so3_right."""
    assert matrix_of(seen_from_space("so3").coframe) == matrix_of(
        spaces.load("so3_right").frame.coframe
    )


def test_listing_loads_nothing(monkeypatch):
    """Numbers and titles come without any exercise."""
    monkeypatch.setattr(registry, "import_module", None)
    assert len(registry.names()) == len(registry.titles()) >= 24


def test_loading_solves_nothing(monkeypatch):
    """An exercise is stated without its solution."""

    def refuse(question):
        raise AssertionError("a solution was computed")

    monkeypatch.setattr(Question, "solution", property(refuse))
    for entry in registry.EXERCISES:
        exercise = registry._loaded.__wrapped__(*entry, 11)
        assert exercise.statement
        assert exercise.hints


@pytest.mark.parametrize(
    ("number", "seed", "says"),
    [("9.9", 0, "There are 1.1 to"), ("3.22", 0, "Near: 3.2"), ("", 0, "no exercise"),
     ("1.1", -1, "whole number from 0"), ("1.1", True, "whole number"),
     ("1.1", "7", "whole number"),
     ("1.1", 10**12, "whole number")],
)  # fmt: skip
def test_unknown_exercises(number, seed, says):
    """What there is, is said."""
    with pytest.raises(UnknownNameError, match=says):
        registry.load(number, seed)


def test_limits_hold_on_both_sides():
    """What is allowed passes, one more is refused: entries, equations, roots."""
    many = Question("q", "components", "?", lambda: 0, Domain((x,)), shape=(MOST.entries,))
    assert len(components(many, ["x"] * MOST.entries, "q")) == MOST.entries
    more = replace(many, shape=(MOST.entries + 1,))
    with pytest.raises(LimitError, match="501 entries; the limit is 500"):
        components(more, ["x"] * (MOST.entries + 1), "q")
    roots = [sp.sqrt(x**2 + k) for k in range(1, MOST.roots + 2)]
    check_weight(sp.Add(*roots[:-1]), "q")
    with pytest.raises(LimitError, match="more than 4 different roots"):
        check_weight(sp.Add(*roots), "q")
    names = [f"v{k}'" for k in range(1, MOST.equations + 2)]
    text = "; ".join(f"{name} = x" for name in names)
    asked = Question("q", "equations", "?", lambda: 0, Domain((x,)), unknowns=(*names[:-1],))
    assert len(equations(asked, text.rpartition(";")[0], "q")) == MOST.equations
    with pytest.raises(LimitError, match="13 equations; the limit is 12"):
        equations(replace(asked, unknowns=(*names,)), text, "q")


@pytest.mark.parametrize(("power", "refused"), [("201/2", True), ("199/2", False), ("101", False)])
def test_powers_that_are_no_whole_numbers(power, refused):
    """Above 100 they are refused, before sympy sees them."""
    if refused:
        with pytest.raises(LimitError, match="a power above 100"):
            check_constants(f"2^({power})", ["x"], "q", ANSWER)
    else:
        check_constants(f"2^({power})", ["x"], "q", ANSWER)

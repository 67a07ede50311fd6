"""Closed forms: Burgers vectors as expressions, and an error if there is none."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
import sympy as sp

from geomtorsion.errors import (
    LoopError,
    MissingValueError,
    SingularPointError,
    UndecidedError,
    UnknownNameError,
)
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop, burgers_vector, exact_burgers_vector, parallel_screws
from geomtorsion.loops.exact_integral import definite
from geomtorsion.spaces import load
from tests.rounding import ROUNDED

R, b = sp.symbols("R b", positive=True)
t = sp.Symbol("t", real=True)
J1 = sp.besselj(1, R)
THIRD = sp.Rational(3, 10)


@pytest.mark.parametrize(
    ("space", "loop", "expected"),
    [
        ("screw_dislocation", Loop.circle([0, 0, 0], R), (0, 0, b)),
        ("screw_dislocation", Loop.circle([0.3, 0.1, 0], 1).times(-2), (0, 0, -2 * b)),
        ("screw_dislocation", Loop.circle([3, 0.1, 0], 1), (0, 0, 0)),
        ("heisenberg", Loop.circle([7, 2, 0], R), (0, 0, -sp.pi * R**2)),
        ("heisenberg", Loop.ellipse([0, 0, 0], (0.3, 0.1)), (0, 0, -3 * sp.pi / 100)),
        (
            "heisenberg",
            Loop.circle([0, 0, 0], 1, ([1, 1, 0], [0, 1, 1])),
            (0, 0, -sp.pi / sp.sqrt(3)),
        ),
        ("heisenberg", Loop.polygon([[0, 0, 0], [1, 0, 0], [0.5, 1, 2]]), (0, 0, -sp.S.Half)),
        (
            "so3",
            Loop.circle([0.3, 1, 0.2], R),
            (2 * sp.pi * R * sp.cos(THIRD) * J1, -2 * sp.pi * R * sp.sin(THIRD) * J1, 0),
        ),
        ("flat_polar", Loop.plaquette([1, 0], (2, 3)), (0, 6)),
        ("flat_polar", Loop.polygon([[1, 0], [2, 0], [2, 3], [1, 3]]), (0, 3)),
    ],
    ids=lambda value: value if isinstance(value, str) else getattr(value, "name", ""),
)
def test_closed_forms(space: str, loop: Loop, expected: tuple[sp.Expr, ...]) -> None:
    """Each closed form equals the result by hand, with tables for Bessel functions."""
    found = exact_burgers_vector(load(space).frame, loop)
    for one, two in zip(found.vector, expected, strict=True):
        assert sp.simplify(one - two) == 0, found


def test_values_are_put_in_exactly() -> None:
    """Values may be given for some or all symbols; a symbol without a value remains."""
    frame, loop = load("screw_dislocation").frame, Loop.circle([0, 0, 0], R)
    assert exact_burgers_vector(frame, loop, parameters={"b": 0.3}).vector[2] == THIRD
    area = sp.Symbol("a") * R
    plane = load("heisenberg").frame
    ellipse = Loop.ellipse([0, 0, 0], (R, sp.Symbol("a")))
    for values, left in (({R: 0.3}, area.subs(R, THIRD)), ({R: 2, "a": 3}, 6), ({}, area)):
        found = exact_burgers_vector(plane, ellipse, parameters=values)
        assert found.vector == (0, 0, -sp.pi * left)
    with pytest.raises(UnknownNameError, match="expected a parameter of this frame, got 'c'"):
        exact_burgers_vector(frame, loop, parameters={"b": 1, "c": 2})


def test_a_value_decides_whether_a_line_is_enclosed() -> None:
    """Without a value no single closed form holds."""
    frame, loop = load("screw_dislocation").frame, Loop.circle([1, 0, 0], R)
    with pytest.raises(UndecidedError, match="depends on R"):
        exact_burgers_vector(frame, loop)
    for radius, expected in ((0.5, 0), (2, b)):
        found = exact_burgers_vector(frame, loop, parameters={"R": radius})
        assert found.vector == (0, 0, expected)


def test_closed_form_and_numbers_agree() -> None:
    """For a frame without symmetry the closed form and the numerical integral agree."""
    frame = load("so3").frame
    loop = Loop.circle([0.3, 1, 0.2], R, (1, 2))
    closed = exact_burgers_vector(frame, loop).at({"R": 0.5})
    assert closed == pytest.approx(burgers_vector(frame, loop.at({"R": 0.5})).vector, rel=ROUNDED)


def test_so3_in_exponential_coordinates() -> None:
    """Flat circle of radius R: -2 pi (1 - cos R)."""
    x, y = sp.symbols("x y", real=True)
    w = sp.sqrt(x**2 + y**2)
    third = [(1 - sp.cos(w)) / w**2 * y, -(1 - sp.cos(w)) / w**2 * x]
    frame = Frame([x, y, "z"], [[1, 0, 0], [0, 1, 0], [*third, 1]])
    found = exact_burgers_vector(frame, Loop.circle([0, 0, 0], R))
    assert sp.simplify(found.vector[2] + 2 * sp.pi * (1 - sp.cos(R))) == 0


@pytest.mark.parametrize(
    ("integrand", "expected"),
    [
        (sp.cos(t) ** 4, 3 * sp.pi / 4),
        (sp.sin(3 * t) * sp.sin(t) ** 3, -sp.pi / 4),
        (sp.cos(R * sp.cos(t)), 2 * sp.pi * sp.besselj(0, R)),
        (sp.sin(R * sp.sin(t)) * sp.sin(t), 2 * sp.pi * J1),
        (sp.cos(3 * sp.cos(t) + 4 * sp.sin(t)), 2 * sp.pi * sp.besselj(0, 5)),
        (1 / (2 + sp.cos(t)), 2 * sp.pi / sp.sqrt(3)),
        (1 / (5 - 4 * sp.cos(t)) ** 2, 10 * sp.pi / 27),
        (sp.exp(sp.cos(t)), 2 * sp.pi * sp.besseli(0, 1)),
        (t**2, 8 * sp.pi**3 / 3),
        (t * sp.cos(t), 0),
    ],
)
def test_integrals_over_one_turn(integrand: sp.Expr, expected: sp.Expr) -> None:
    """Integrals from tables (Gradshteyn and Ryzhik, 3.6 and 3.9)."""
    found = definite(integrand, t, sp.S.Zero, 2 * sp.pi)
    assert found is not None
    assert abs((found - expected).subs(R, 2).evalf(30)) < 1e-25


# A time limit that ends within a callback of Python is reported there and raised again.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_no_closed_form_raises_an_error() -> None:
    """The error advises numbers; neither a partial integral nor a number is returned."""
    x, y = sp.symbols("x y", real=True)
    frame = Frame([x, y], [[1, sp.exp(sp.sin(x * y) + x**4)], [0, 1]])
    with pytest.raises(UndecidedError, match="use gt.burgers_vector"):
        exact_burgers_vector(frame, Loop.circle([0, 1], 1), seconds=2)


def test_a_spline_has_no_closed_form() -> None:
    """A spline, which is only known numerically, is refused."""
    spline = Loop.spline([[0, 1, 0], [1, 1, 0], [0, 2, 0]])
    with pytest.raises(LoopError, match="only known numerically"):
        exact_burgers_vector(load("so3").frame, spline)
    with pytest.raises(LoopError, match="the loop has 2 coordinates"):
        exact_burgers_vector(load("so3").frame, Loop.circle([0, 0], 1))


def test_numbers_from_a_closed_form() -> None:
    """Numbers need a value for each symbol."""
    found = exact_burgers_vector(load("screw_dislocation").frame, Loop.circle([0, 0, 0], R))
    assert found.at({"b": 3}).tolist() == [0, 0, 3]
    with pytest.raises(MissingValueError, match="values: expected a value for b, got none"):
        found.at()
    assert repr(found) == "ExactBurgersVector([0, 0, b])"
    assert "b = " in found._repr_latex_()


def test_the_time_ends_in_threads_too() -> None:
    """The time limit also works in threads, where no signal arrives."""
    x, y = sp.symbols("x y", real=True)
    frame = Frame([x, y], [[1, sp.exp(sp.sin(x * y) + x**4)], [0, 1]])
    with ThreadPoolExecutor(1) as pool:
        found = pool.submit(exact_burgers_vector, frame, Loop.circle([0, 1], 1), seconds=0.2)
        with pytest.raises(UndecidedError, match=r"no closed form was found in 0\.2 s"):
            found.result(timeout=60)


@pytest.mark.parametrize(
    "loop",
    [
        Loop.circle([1, 0, 0], 1),
        Loop.polygon([[0, 0, 0], [1, 0, 0], [1, 1, 0]]),
        Loop.polygon([[-1, 0, 0], [1, 0, 0], [1, 1, 0]]),
    ],
)
def test_a_closed_form_through_the_defect_is_refused(loop: Loop) -> None:
    """A loop through the line is refused with the point, instead of half or an eighth of b."""
    with pytest.raises(SingularPointError, match="passes through"):
        exact_burgers_vector(load("screw_dislocation").frame, loop)


@pytest.mark.parametrize("seconds", [0, -1, float("nan"), "1"])
def test_the_time_is_a_positive_number(seconds: Any) -> None:
    """A time that is not a positive number is refused."""
    with pytest.raises(LoopError, match="seconds: expected a"):
        exact_burgers_vector(load("heisenberg").frame, Loop.circle([0, 0, 0], 1), seconds)


X = sp.Symbol("X", positive=True)


@pytest.mark.parametrize(
    ("frame", "loop", "names"),
    [
        (load("screw_dislocation").frame, Loop.circle([X, 0, 0], 1), "X"),
        (load("screw_dislocation").frame, Loop.circle([THIRD, 0, 0], R), "R"),
        (load("screw_dislocation").frame, Loop.circle([X, 0, 0], R), "R, X"),
        (parallel_screws([(X, 0)], [1]), Loop.circle([0, 0, 0], 1), "X"),
    ],
)
def test_enclosed_lines_may_depend_on_symbols(frame: Frame, loop: Loop, names: str) -> None:
    """No closed form holds for a line that is inside only for some values."""
    with pytest.raises(
        UndecidedError, match=f"winding number around the singular line .* depends on {names}:"
    ):
        exact_burgers_vector(frame, loop)


def test_a_symbolic_position_where_nothing_is_singular() -> None:
    """The position of a loop may contain a symbol."""
    found = exact_burgers_vector(load("heisenberg").frame, Loop.circle([X, 0, 0], R))
    assert sp.simplify(found.vector[2] + sp.pi * R**2) == 0


def test_infinite_closed_forms_are_refused() -> None:
    """sin(k x) / k at k = 0 is refused, and the error names the value; never nan."""
    x, y, k = sp.symbols("x y k")
    frame = Frame([x, y], [[1, sp.sin(k * x) / k], [0, 1]])
    closed = exact_burgers_vector(frame, Loop.circle([1, 1], sp.Rational(1, 2)))
    assert closed.at({"k": 0.5})[0] == pytest.approx(
        burgers_vector(frame, Loop.circle([1, 1], 0.5), parameters={"k": 0.5}).vector[0]
    )
    with pytest.raises(SingularPointError, match="no finite value at k = 0"):
        closed.at({"k": 0})


def test_decimals_of_curves_are_exact() -> None:
    """0.5 is read as 1/2 in text and in expressions, as for circles."""
    s = sp.Symbol("s", real=True)
    half = sp.Float(0.5)
    frame = load("heisenberg").frame
    for first in ("0.5*cos(s)", half * sp.cos(s), 0.5 * sp.cos(s)):
        loop = Loop.parametric([first, "sin(s)/2", 0], s, (0, "2*pi"))
        assert exact_burgers_vector(frame, loop).vector == (0, 0, -sp.pi / 4)

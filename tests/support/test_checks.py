"""Checks: each validator accepts valid values and refuses all others with its own message."""

from decimal import Decimal
from fractions import Fraction

import mpmath
import numpy as np
import pandas as pd
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    ArgumentError,
    CoordinateError,
    GridError,
    LimitError,
    LoopError,
    ShapeError,
    StartError,
)
from geomtorsion.exact import Field
from geomtorsion.support import checks

X = sp.Symbol("x")
HALVES = [
    0.5,
    Fraction(1, 2),
    np.float64(0.5),
    np.float32(0.5),
    np.array(0.5),
    np.array(Fraction(1, 2)),
    sp.Rational(1, 2),
    sp.Float("0.5"),
    sp.cos(sp.pi / 3),
    mpmath.mpf("0.5"),
    Decimal("0.5"),
    Field([X]).read(sp.Rational(1, 2)),
]


class Disguised:
    """An object whose text is a number."""

    def __str__(self) -> str:
        return "1/2"

    __repr__ = __str__


NO_NUMBERS = [
    "1/2",
    b"1",
    ["1"],
    [0.5],
    (0.5,),
    {"a": 1},
    {0.5},
    None,
    True,
    np.True_,
    np.str_("1"),
    np.array(["1"]),
    np.array("1"),
    np.array([0.5]),
    1j,
    np.complex64(1),
    sp.I,
    X,
    sp.Matrix([1]),
    sp.Tuple(1),
    X > 0,
    Disguised(),
]
INFINITE = [float("nan"), float("inf"), -np.inf, np.float32("nan"), sp.oo, sp.nan, 10**400]


@pytest.mark.parametrize("value", HALVES, ids=lambda x: type(x).__name__)
def test_numbers_of_all_kinds(value):
    """A half of any type has the value 1/2 and stays exact where exact numbers are requested."""
    assert checks.real(value) == 0.5
    assert checks.number(value, "a", LoopError) == 0.5
    assert checks.rational(value, "a", LoopError) in (sp.Rational(1, 2), sp.cos(sp.pi / 3))
    assert float(checks.expression(value, "a", LoopError)) == 0.5
    kept = checks.exact_number(value, "a", LoopError)
    assert kept is value or kept == value.item()


@pytest.mark.parametrize("value", NO_NUMBERS, ids=repr)
def test_no_numbers(value):
    """Text, lists, truth values and symbols are refused; the message names the argument."""
    assert checks.real(value) is None
    assert checks.fraction(value) is None
    for check in (checks.number, checks.exact_number, checks.rational, checks.positive):
        with pytest.raises(LoopError, match=r"^radius: expected .*number, got .*\.$"):
            check(value, "radius", LoopError)
    with pytest.raises(LoopError, match="radius"):
        checks.count(value, "radius", LoopError)


@pytest.mark.parametrize("value", INFINITE, ids=lambda x: str(x)[:5])
def test_infinite_numbers(value):
    """A number that is not finite has a message of its own."""
    with pytest.raises(LoopError, match="t: expected a finite number, got "):
        checks.number(value, "t", LoopError)
    with pytest.raises(StartError, match=r"t: expected a time, got .* Give another\.$"):
        checks.exact_number(value, "t", StartError, expected="a time", remedy="Give another.")
    with pytest.raises(LoopError, match="finite"):
        checks.rational(value, "t", LoopError)


@pytest.mark.parametrize("value", [x for x in NO_NUMBERS if x is not X], ids=repr)
def test_no_expressions(value):
    """Only numbers, complex ones included, and expressions become expressions."""
    if isinstance(value, complex | np.complexfloating | sp.Expr):
        assert isinstance(checks.expression(value, "f", LoopError), sp.Expr)
    else:
        with pytest.raises(LoopError, match="f: expected one expression, got "):
            checks.expression(value, "f", LoopError)


def test_expressions_keep_what_they_are():
    """Symbols stay unchanged; only the given reader reads text."""
    assert checks.expression(X**2, "f", LoopError) == X**2
    assert checks.expression(Field([X]).read(X**2), "f", LoopError) == X**2
    assert checks.expression("anything", "f", LoopError, read=sp.Symbol) == (sp.Symbol("anything"))
    with pytest.raises(LoopError):
        checks.expression(["anything"], "f", LoopError, read=sp.Symbol)


def test_rational_numbers():
    """A float becomes its exact fraction or, with decimal=True, its shortest decimal."""
    assert checks.rational(0.1, "a", LoopError) == sp.Rational(*(0.1).as_integer_ratio())
    assert checks.rational(0.1, "a", LoopError, decimal=True) == sp.Rational(1, 10)
    assert checks.rational(1e-300, "a", LoopError, decimal=True) == sp.Rational(1, 10**300)
    assert checks.rational(sp.sqrt(2), "a", LoopError) == sp.sqrt(2)
    with mpmath.workdps(50):
        third = mpmath.mpf(1) / 3
    exact = checks.rational(third, "a", LoopError)
    assert abs(exact - sp.Rational(1, 3)) < sp.Rational(1, 10**49)
    assert checks.fraction(-mpmath.mpf(3) / 4) == Fraction(-3, 4)
    assert checks.fraction(np.float32(0.5)) == Fraction(1, 2)
    assert checks.fraction(float("nan")) is None
    assert checks.fraction(mpmath.inf) is None


def test_messages_are_short():
    """A value of a million characters is cut; a value whose text fails is named by its type."""
    with pytest.raises(LoopError) as caught:
        checks.number("r" * 10**6, "radius", LoopError)
    assert len(str(caught.value)) < 300
    assert checks.shown(10**5000) == "a value of type int"

    class Broken:
        def __repr__(self) -> str:
            raise SystemError

    assert checks.shown(Broken()) == "a value of type Broken"


def test_braces_in_values_are_unchanged():
    """Braces in a value are shown unchanged, not filled as fields of the message."""
    with pytest.raises(LoopError, match=r"a\{0\}: expected a number, got '\{subject\}'"):
        checks.number("{subject}", "a{0}", LoopError)


def test_positive_and_whole_numbers():
    """Bounds belong to the range; values beyond them are refused."""
    assert checks.positive(1e-300, "r", LoopError) == 1e-300
    for value in (0, -1, -1e-300):
        with pytest.raises(LoopError, match="r: expected a positive number"):
            checks.positive(value, "r", LoopError)
    for value in (1, 9, sp.Integer(3), np.int64(4)):
        assert checks.count(value, "n", LoopError, 1, 9) == int(value)
    for value in (0, 10, 3.0, "3", True):
        with pytest.raises(LoopError, match="n: expected a whole number from 1 to 9, got "):
            checks.count(value, "n", LoopError, 1, 9)
    with pytest.raises(LoopError, match="from 1 on"):
        checks.count(0, "n", LoopError, 1)


def test_lists_of_numbers():
    """A list has the right length and keeps its numbers; list and entries have own errors."""
    kept = checks.numbers([1, Fraction(1, 3), np.float64(2)], 3, "u", StartError)
    assert kept == (1, Fraction(1, 3), 2.0)
    assert type(kept[2]) is float
    assert checks.numbers(np.eye(2)[0], None, "u", StartError) == (1, 0)
    for values in ("12", {1: 2}, 3, None, np.array(1.0)):
        with pytest.raises(ShapeError, match=r"u: expected a list of 2 numbers, got .*"):
            checks.numbers(values, 2, "u", StartError, shape_error=ShapeError)
    with pytest.raises(ShapeError, match="u: expected 2 numbers, got 3"):
        checks.numbers([1, 2, 3], 2, "u", StartError, shape_error=ShapeError)
    for wrong in ([1, "2"], [1, [2]], [1, None], [[1], 2], [1, np.array([2])]):
        with pytest.raises(StartError, match=r"u\[[01]\]: expected a number"):
            checks.numbers(wrong, 2, "u", StartError, shape_error=ShapeError)
    with pytest.raises(StartError, match=r"u\[1\]: expected a finite number, got nan"):
        checks.numbers([1, np.nan], 2, "u", StartError)
    with pytest.raises(StartError, match=r"u: expected two numbers, got \[1, 2, 3\]\. Give both\."):
        checks.numbers([1, 2, 3], 2, "u", StartError, expected="two numbers", remedy="Give both.")


def test_arrays():
    """Lists, arrays and exact numbers become doubles of the required shape."""
    assert checks.array([1, 2], "a", GridError).dtype == np.float64
    exact = checks.array([[Fraction(1, 2), sp.sqrt(4)], [1, 2.5]], "a", GridError, shape=(2, 2))
    assert exact.tolist() == [[0.5, 2], [1, 2.5]]
    assert checks.array(np.float32(2), "a", GridError, shape=()) == 2
    wrong = (["1"], "1", [1, "2"], [None], [[1], [1, 2]], [1j], [True], {"a": 1}, [X], [[["1"]]])
    for values in wrong:
        with pytest.raises(GridError, match="a: expected an array of real numbers"):
            checks.array(values, "a", GridError)
    with pytest.raises(ShapeError, match=r"expected shape \(any, 2\), got \(2, 3\)"):
        checks.array(np.ones((2, 3)), "a", GridError, shape=(None, 2), shape_error=ShapeError)
    with pytest.raises(GridError, match=r"a\[1, 0\] = inf is not finite"):
        checks.array([[1, 2], [np.inf, 3]], "a", GridError)
    assert np.isnan(checks.array([np.nan], "a", GridError, infinite=None)[0])


def test_names():
    """Known names pass as text or symbol; messages offer similar names and cut long ones."""
    assert checks.known_name("a", ["a", "b"], "p", StartError) == "a"
    assert checks.known_name(sp.Symbol("a"), ["a", "b"], "p", StartError) == "a"
    near = r"'omgea'\. Did you mean omega\? There are omega, b\."
    with pytest.raises(StartError, match=f"^p: expected a known name, got {near}$"):
        checks.known_name("omgea", ["omega", "b"], "p", StartError)
    with pytest.raises(
        StartError, match=r"^expected a rate, got 'omgea'. There are none. Add it.$"
    ):
        checks.known_name("omgea", [], "", StartError, expected="a rate", remedy="Add it.")
    for value in (1, None, ["a"], {"a": 1}.keys()):
        with pytest.raises(StartError, match="p: expected a known name, got "):
            checks.known_name(value, ["a"], "p", StartError)
    with pytest.raises(StartError) as caught:
        checks.known_name("a" * 10**6, ["a"], "p", StartError)
    assert len(str(caught.value)) < 300


def test_keys():
    """A table with known keys is accepted; anything else is refused."""
    assert checks.known_keys({"a": 1, X: 2}, ["a", "x"], "p", StartError) == {"a": 1, "x": 2}
    with pytest.raises(StartError, match="p: expected a known name, got 'c'"):
        checks.known_keys({"c": 1}, ["a"], "p", StartError)
    for value in ("a", [("a", 1)], None, 3):
        with pytest.raises(StartError, match="p: expected names with values"):
            checks.known_keys(value, ["a"], "p", StartError)


def test_words_and_texts():
    """Words are one of several choices; texts have a largest length."""
    assert checks.choice("line", ["line", "flux"], "method", LoopError) == "line"
    for value in ("lin", 1, None, ["line"]):
        with pytest.raises(LoopError, match="method: expected one of line, flux"):
            checks.choice(value, ["line", "flux"], "method", LoopError)
    assert checks.text("abc", "name", LoopError, longest=3) == "abc"
    for value in ("abcd", 3, b"abc", None):
        with pytest.raises(LoopError, match="name: expected text"):
            checks.text(value, "name", LoopError, longest=3)


@pytest.mark.parametrize(("length", "whole"), [(190, True), (210, False)])
def test_how_long_a_shown_value_is(length, whole):
    """A shown value has up to two hundred characters; the middle of a longer value is omitted."""
    text = "a" * length
    assert (checks.cut(text) == text) == whole


def test_arrays_are_limited_to_two_gigabytes():
    """The limit for an array is two gigabytes of doubles."""
    checks.check_room(249_000_000, "t", "Give fewer.")
    with pytest.raises(LimitError, match="limit is 2 GB"):
        checks.check_room(251_000_000, "t", "Give fewer.")


@pytest.mark.parametrize("kind", [float, np.float32, int, object])
def test_masked_numbers_are_never_used(kind):
    """A masked number is never used: it is refused, or becomes nan if nan is allowed."""
    given = np.ma.array(
        np.array([[1, 7], [3, 4]], dtype=kind), mask=np.array([[False, True], [False, False]])
    )
    with pytest.raises(ArgumentError, match=r"x\[0, 1\] = nan is not finite"):
        checks.array(given, "x", ArgumentError)
    assert np.isnan(checks.array(given, "x", ArgumentError, infinite=None)[0, 1])
    whole = np.ma.array(np.array([1, 7], dtype=kind), mask=False)
    assert checks.array(whole, "x", ArgumentError).tolist() == [1, 7]
    for one in (np.ma.masked, given[0, 1], np.ma.array(7, mask=True)):
        with pytest.raises(ArgumentError, match="x"):
            checks.number(one, "x", ArgumentError)


@pytest.mark.parametrize(
    "kind", [int, float, Fraction, np.float64, mpmath.mpf, sp.Integer, complex]
)
def test_values_against_declarations(kind):
    """Values of each kind of number are checked; zero counts as positive and as negative."""
    symbols = {word: sp.Symbol("M", **{word: True}) for word in ("positive", "negative", "real")}
    said = "M: expected a value that is {}.*, as declared, got .*. Give another value, or declare M"
    for word, value in {"positive": -1, "negative": 1}.items():
        with pytest.raises(CoordinateError, match=said.format(word)):
            checks.check_declared(symbols[word], kind(value))
        for allowed in (0, -value):
            checks.check_declared(symbols[word], kind(allowed))
    checks.check_declared(symbols["real"], kind(-1))
    with pytest.raises(CoordinateError, match=said.format("real")):
        checks.check_declared(symbols["real"], 1 + 1j)
    whole = sp.Symbol("M", integer=True)
    checks.check_declared(whole, kind(-1))
    with pytest.raises(
        CoordinateError, match="M: expected a value that is integer, as declared, got 0.5"
    ):
        checks.check_declared(whole, 0.5)
    checks.check_declared(sp.Symbol("M"), 1j)


@pytest.mark.parametrize("kind", [int, float, Fraction, np.int64, mpmath.mpf, sp.Integer])
def test_even_and_odd_are_declared(kind):
    """sympy simplifies (-1)**n to 1 for a declared even n, so each other value of n is refused."""
    for word, right, wrong in (("even", (0, 2, -4), (3, -1)), ("odd", (3, -1), (0, 2, -4))):
        n = sp.Symbol("n", **{word: True})
        for value in right:
            checks.check_declared(n, kind(value))
        for value in wrong:
            with pytest.raises(
                CoordinateError, match=f"n: expected a value that is {word}, as declared, got"
            ):
                checks.check_declared(n, kind(value))
        with pytest.raises(
            CoordinateError,
            match=f"n: expected a value that is integer, {word}, as declared, got 0.5",
        ):
            checks.check_declared(n, 0.5)


def test_large_whole_numbers_keep_their_last_digit():
    """Parity is checked exactly, also beyond the digits and the range of floats."""
    n, whole = sp.Symbol("n", even=True), sp.Symbol("k", integer=True)
    checks.check_declared(n, 10**30)
    checks.check_declared(whole, 10**400)
    with pytest.raises(CoordinateError, match="n: expected a value that is even"):
        checks.check_declared(n, 10**30 + 1)


def test_zero_is_where_other_numbers_end():
    """Zero is accepted for a nonzero symbol, as for a positive one."""
    checks.check_declared(sp.Symbol("n", nonzero=True), 0)


REFUSED = {
    "too many entries": (
        lambda: checks.entries([1, 2, 3], "axes", LoopError, 2, expected="two semi-axes"),
        r"axes: expected two semi-axes, got \[1, 2, 3\]\.",
    ),
    "a set": (lambda: checks.entries({1}, "axes", LoopError), r"a list, got \{1\}\. Put it"),
    "a word for flags": (
        lambda: checks.flags("yes", 2, "periodic", LoopError, remedy="Give two."),
        r"periodic: expected 2 truth values, got 'yes'\. Give two\.",
    ),
    "one flag": (lambda: checks.flags(True, 2, "p", LoopError), "p: expected 2 truth values, got"),
    "a two among flags": (lambda: checks.flags([1, 2], 2, "p", LoopError), "2 truth values"),
    "arrays as flags": (lambda: checks.flags([[1], 0], 2, "p", LoopError), "2 truth values"),
    "fractions": (
        lambda: checks.whole_array([[0.5, 1]], "pairs", LoopError, 2),
        r"pairs: expected whole numbers of shape \(any, 2\), got float64 of shape \(1, 2\)\.",
    ),
    "three columns": (
        lambda: checks.whole_array([[0, 1, 2]], "pairs", LoopError, 2),
        r"whole numbers of shape \(any, 2\), got int64 of shape \(1, 3\)",
    ),
    "a negative length": (
        lambda: checks.not_negative(-1, "core", LoopError, remedy="Give a length."),
        r"core: expected 0 or a positive number, got -1\. Give a length\.",
    ),
    "an endless length": (lambda: checks.not_negative(np.inf, "core", LoopError), "got inf"),
    "no length": (lambda: checks.not_negative("1", "core", LoopError), "got '1'"),
    "too few": (
        lambda: checks.check_one_each("ab", 3, "atoms", "species", LoopError, "Give three."),
        r"species: expected one for each of 3 atoms, got 2\. Give three\.",
    ),
    "no value": (
        lambda: checks.check_values("abc", {"a": 1}, "at", LoopError, "Give {missing}."),
        r"at: expected a value for b, c, got none\. Give b\.",
    ),
    "a truth value as a number": (
        lambda: checks.choice(True, (1, -1), "side", LoopError),
        "side: expected one of 1, -1, got True",
    ),
    "an array as a choice": (
        lambda: checks.choice(np.array([1, 2]), (1, -1), "side", LoopError),
        "side: expected one of 1, -1, got array",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refusals(case):
    """Each refusal names the expected value, the received value and a remedy."""
    call, words = REFUSED[case]
    with pytest.raises(LoopError, match=words):
        call()


def test_several_values():
    """Lists of a length, truth values, whole arrays and choices pass in one type."""
    assert checks.entries((1, 2), "axes", LoopError, 2) == [1, 2]
    assert checks.flags(np.array([True, False]), 2, "periodic", LoopError) == (True, False)
    assert checks.flags((np.True_, 0), 2, "periodic", LoopError) == (True, False)
    assert checks.whole_array([], "pairs", LoopError, 2).shape == (0, 2)
    assert checks.not_negative(0, "core", LoopError) == 0.0
    assert checks.choice(sp.Integer(-1), (1, -1), "side", LoopError) == -1
    checks.check_values("ab", {"a": 1, "b": 2}, "at", LoopError, "")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (pd.DataFrame({"x": [1.0, 2.0], "y": [3, 4]}), "a DataFrame of shape (2, 2)"),
        (np.zeros((30, 40)), "an array of shape (30, 40)"),
        (np.eye(2), "array([[1., 0.], [0., 1.]])"),
        (sp.zeros(30, 30), "a MutableDenseMatrix of shape (30, 30)"),
        (list(range(10**4)), "[0, 1, 2, 3, 4, 5, 6, 7, ...] (10000 entries)"),
        ((1 / 3,) * 11, "(" + "0.3333333333333333, " * 8 + "...) (11 entries)"),
        ([[1 / 3] * 30] * 30, "a list of length 30"),
        ({str(k): k for k in range(1000)}, "a dict of length 1000"),
        ([], "[]"),
        ({}, "{}"),
        (np.float64(1e-7), "np.float64(1e-07)"),
        (gt.spaces.load("s2").frame, "s2 (coordinates theta, phi)"),
    ],
)
def test_messages_show_no_part_of_a_number(value, text):
    """Long values are described or shortened between entries, and all texts have one line."""
    assert checks.shown(value) == text

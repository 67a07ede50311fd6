"""Signs in a region: proved for all of its points, or shown at two of them, never guessed."""

from random import Random

import pytest
import sympy as sp

import geomtorsion as gt


def diagonal(*entries: str) -> list[list[object]]:
    """A diagonal matrix as rows."""
    size = range(len(entries))
    return [[entries[i] if i == j else 0 for j in size] for i in size]


SCHWARZSCHILD = gt.Frame.from_metric(
    "t r theta phi",
    diagonal("-(1-2*M/r)", "1/(1-2*M/r)", "r**2", "r**2*sin(theta)**2"),
    parameters="M",
)
KERR = gt.Frame.from_metric(
    "t r", diagonal("-(r**2-2*M*r+a**2)", "1/(r**2-2*M*r+a**2)"), parameters="M a"
)
# The region 0 < x < 1 with y and z of any value.
STRIP = gt.Frame("x y z", diagonal("sqrt(x)*sqrt(1 - x)", "1", "1"))
DISC = gt.Frame.from_metric("x y", diagonal("1/(1-x**2-y**2)", "1/(1-x**2-y**2)"))

CASES = [
    # r > 2 M > 0 and 0 < theta < pi.
    (SCHWARZSCHILD, "r - M", "positive"),
    (SCHWARZSCHILD, "2*M/r - 1", "negative"),
    (SCHWARZSCHILD, "r - 201*M/100", "both"),
    (SCHWARZSCHILD, "pi - theta", "positive"),
    (SCHWARZSCHILD, "theta - 314/100", "both"),
    (SCHWARZSCHILD, "theta - 4", "negative"),
    (SCHWARZSCHILD, "1 - sin(theta)", "positive"),
    (SCHWARZSCHILD, "999999/1000000 - sin(theta)", "both"),
    (SCHWARZSCHILD, "1000001/1000000 - sin(theta)", "positive"),
    (SCHWARZSCHILD, "sqrt(2)*r - 2*M", "positive"),
    (SCHWARZSCHILD, "pi*r - 6*M", "positive"),
    (SCHWARZSCHILD, "pi*r - 63*M/10", "both"),
    (SCHWARZSCHILD, "sqrt(r - 2*M) + M", "positive"),
    (SCHWARZSCHILD, "r**3 - 6*M*r**2 + 13*M**2*r - 10*M**3", "positive"),
    (SCHWARZSCHILD, "cosh(t) - cos(theta)", "positive"),
    (SCHWARZSCHILD, "exp(t) + exp(-t) - 2", "positive"),
    (SCHWARZSCHILD, "exp(t) + exp(-t) - 2000001/1000000", "both"),
    (SCHWARZSCHILD, "t**2 - 1/1000000", "both"),
    (SCHWARZSCHILD, "t**2 + 1/1000000", "positive"),
    (SCHWARZSCHILD, "0", "zero"),
    (SCHWARZSCHILD, "sin(theta)**2 + cos(theta)**2 - 1", "zero"),
    # Outside of both horizons, where they exist.
    (KERR, "r**2 + a**2", "positive"),
    (KERR, "r**2 - 2*M*r + a**2", "positive"),
    (KERR, "r - M", "positive"),
    (KERR, "M - a", "both"),
    # Slivers that a hundred points miss.
    (STRIP, "(x - 1/2)**2 - 1/1000000", "both"),
    (STRIP, "(x - 1/3)**2 - 1/1000000", "both"),
    (STRIP, "(x - 1/2)**2 + 1/1000000", "positive"),
    (STRIP, "(x - y)**2 - 1/1000000", "both"),
    (STRIP, "(x - y)**2 + (x - z)**2 + 1/1000000", "positive"),
    (STRIP, "x**2 - x", "negative"),
    (STRIP, "2 + sin(y) + exp(y)", "positive"),
    (STRIP, "exp(y) + sin(y)", "both"),
    (STRIP, "2*cosh(y) + sinh(y)", "positive"),
    (STRIP, "sin(x/2) + x", "positive"),
    # cos(2) = -0.4161...
    (STRIP, "cos(2*x) + 41615/100000", "positive"),
    (STRIP, "cos(2*x) + 41/100", "both"),
    (STRIP, "x**2 - x + 1/4", "positive"),
    (STRIP, "x**2 - x + 249999/1000000", "both"),
    (STRIP, "2 - x - x*exp(-y**2)", "positive"),
    (STRIP, "1 - log(x)", "positive"),
    (STRIP, "x*y**2 - y + 1/4/x + 1/1000", "positive"),
    (STRIP, "x*y**2 - y + 1/4/x - 1/1000", "both"),
    (STRIP, "x**4*y**2*z**2 + 1 - 2*x**2*y*z", "positive"),
    (DISC, "1 - x**2 - y**2", "positive"),
    (DISC, "x + y", "both"),
]


@pytest.mark.parametrize(("frame", "expression", "verdict"), CASES, ids=[x[1] for x in CASES])
def test_the_sign_in_a_region(frame: gt.Frame, expression: str, verdict: str):
    """One sign all over, or both; the truth is elementary."""
    region = frame.region
    assert region.sign_verdict(expression) == verdict
    assert region.sign(expression) == {"positive": 1, "negative": -1}.get(verdict)


def test_the_sign_of_polynomials():
    """Agrees with the number of real roots (Sturm) for random polynomials between 0 and 1."""
    numbers, (x, *_) = Random(1), STRIP.coordinates
    counts = {"positive": 0, "negative": 0, "both": 0}
    for _ in range(60):
        size = numbers.randint(1, 5)
        poly = sp.Poly([numbers.randint(-9, 9) or 1 for _ in range(size + 1)], x)
        odd = [f for f, power in poly.factor_list()[1] if power % 2]
        turns = any(f.count_roots(0, 1) - (f.eval(0) == 0) - (f.eval(1) == 0) for f in odd)
        middle = poly.eval(sp.Rational(numbers.randint(400, 600), 1009))
        truth = "both" if turns else "positive" if middle > 0 else "negative"
        counts[truth] += 1
        assert STRIP.region.sign_verdict(poly.as_expr()) == truth, poly
    assert min(counts.values()) >= 5


def test_a_polynomial_of_many_terms():
    """1 + (1 + x + ... + x**21) (1 + y + ... + y**21) is negative at y = -2, and positive at 0."""
    terms = [f"x**{i}*y**{j}" for i in range(22) for j in range(22)]
    assert STRIP.region.sign_verdict(" + ".join(["1", *terms])) == "both"


@pytest.mark.parametrize("expression", ["x - sin(x)", "exp(x) - 1 - x", "x*log(x) - x + 1"])
def test_a_sign_without_proof_is_undecided(expression: str):
    """Functions of one symbol that hold each other up are positive; no other sign is stated."""
    assert STRIP.region.sign_verdict(expression) in ("positive", "undecided")


def test_a_domain_with_a_hole_has_both_sides():
    """x != 0 leaves both signs of x."""
    frame = gt.Frame("x y", diagonal("1", "1"), domain=[sp.Ne(sp.Symbol("x"), 0)])
    assert frame.region.sign_verdict("x") in ("both", "undecided")
    assert frame.region.sign_verdict("x**2 + 1") == "positive"


def test_an_unknown_function_is_undecided():
    """Nothing is assumed of an unknown function, unless its root is in the frame."""
    r = sp.Symbol("r")
    f, g = sp.Function("f")(r), sp.Function("g")(r)
    region = gt.Frame("t r", [[sp.sqrt(f), 0], [0, 1 / sp.sqrt(f)]]).region
    assert region.sign_verdict(f) == "positive"
    assert region.sign_verdict(f + r**2) == "positive"
    assert region.sign_verdict(g) == "undecided"


def test_the_answers_are_the_same_at_each_call():
    """Equal calls give equal verdicts, also on an equal frame."""
    other = gt.Frame("x y z", diagonal("sqrt(x)*sqrt(1 - x)", "1", "1"))
    for expression in ("x - y", "(x - 1/3)**2 - 1/1000000", "x**2 - x"):
        assert STRIP.region.sign_verdict(expression) == other.region.sign_verdict(expression)

"""Factoring: a separate process gives the same factors, and can be ended."""

import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import sympy as sp
from flint import Ordering, fmpq, fmpq_mpoly_ctx

import geomtorsion as gt
from geomtorsion.errors import AllowanceError
from geomtorsion.exact import Field, factoring_process, parse_expression
from geomtorsion.exact.limits import FACTORED_HERE
from geomtorsion.exact.other_process import OtherProcess
from geomtorsion.exact.polynomials import (
    factored,
    factored_apart,
    is_irreducible_on_a_line,
    known_taken_out,
)
from tests.processes import interruptible

ROOT = Path(__file__).parents[2]
CTX = fmpq_mpoly_ctx.get(["x", "y"], Ordering.lex)


def sparse(degree, terms, seed):
    """A polynomial with few terms of high degree."""
    rng = random.Random(seed)
    exponents = [tuple(rng.randint(0, degree) for _ in range(2)) for _ in range(terms)]
    return CTX.from_dict({e: fmpq(rng.randint(1, 9), rng.randint(1, 9)) for e in exponents})


def size(poly):
    """The quantity that decides in which process a polynomial is factored."""
    return len(poly) * sum(map(int, poly.degrees()))


@pytest.mark.parametrize(("degree", "apart"), [(6, False), (30, True)])
def test_here_and_apart(degree, apart):
    """Below and above the bound, the factors equal those that flint gives directly."""
    product = sparse(degree, 12, 1) * sparse(degree, 12, 2) ** 2
    assert (size(product) > FACTORED_HERE) is apart
    content, factors = factored(product, FACTORED_HERE)
    plain_content, plain = product.factor()
    assert content == plain_content
    assert factors == [(factor, int(exponent)) for factor, exponent in plain]


LINEAR = {
    "one coefficient is one term": "x**2*y + 3*x*y**2*w - x**3 - 5",
    "coefficients without a common factor": "(x + y)*w + x**2 - 3*y",
    "a common factor": "((x + y)*w + x**2 - 3*y)*(x - 2*y)",
    "a common power": "-((x + y)*w + x**2 - 3*y)*(x - 2*y)**3/7",
    "linear in two variables": "(x*y + 1)*(w*(x**2 + y**2) - y)*(x**2 - 2)",
    "linear below the common factor": "(x*w + y + 1)*(x*v - 2*y)*(y**2 + 2)**2",
    "divided by a variable": "x*(x*w + y)",
}


@pytest.mark.parametrize("text", LINEAR.values(), ids=LINEAR.keys())
def test_linear_polynomials_have_the_factors_of_flint(text):
    """Polynomials linear in a variable have the factors that flint finds."""
    ring = fmpq_mpoly_ctx.get(["v", "w", "x", "y"], Ordering.lex)
    names = dict(zip("vwxy", ring.gens(), strict=True))
    symbols = {name: sp.Symbol(name) for name in names}
    terms = sp.Poly(sp.expand(parse_expression(text, symbols)), *symbols.values()).terms()
    poly = ring.from_dict({m: fmpq(int(c.p), int(c.q)) for m, c in terms})
    content, plain = poly.factor()
    found, factors = factored(poly, FACTORED_HERE)
    assert found == content
    assert {str(f): e for f, e in factors} == {str(f): int(e) for f, e in plain}


def test_a_process_that_ended_is_replaced():
    """A process that was ended is replaced by a new one at the next call."""
    other, poly = OtherProcess(str(factoring_process.__file__)), sparse(6, 12, 1) * sparse(6, 12, 2)
    for _ in range(2):
        found = factored_apart(poly, other)
        assert found is not None
        assert found[1] == [(factor, int(exponent)) for factor, exponent in poly.factor()[1]]
        other.end()


x, y = sp.symbols("x y", positive=True)
# flint needs half a minute or more for this.
RNG = random.Random(1)
SLOW = sp.Mul(
    *[
        sp.Add(
            *[
                RNG.randint(1, 9) * x ** RNG.randint(0, 80) * y ** RNG.randint(0, 80)
                for _ in range(17)
            ]
        )
        for _ in range(2)
    ]
)


def test_limits_end_it():
    """The root of a product needs its factors; after the time limit the field still works."""
    field = Field([x, y])
    with pytest.raises(AllowanceError, match="more than 1 s"), gt.limits(seconds=1):
        field.read(sp.sqrt(sp.expand(SLOW)))
    assert field.read(sp.sqrt(x**2 * y) - x * sp.sqrt(y)).is_zero is True


def test_ctrl_c_ends_it():
    """Ctrl-C ends a factorization, in a separate Python process, with a KeyboardInterrupt."""
    code = "import geomtorsion as gt, sympy\nx, y = sympy.symbols('x y', positive=True)\n"
    code += f"value = {sp.expand(SLOW)}\nprint('reads', flush=True)\n"
    code += "gt.Frame([x, y], [[sympy.sqrt(value), 0], [0, 1]])\n"
    with interruptible(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=ROOT,
        text=True,
    ) as running:
        assert running.stdout is not None
        running.stdout.readline()
        time.sleep(2)
        assert running.poll() is None, "this was meant to take long"
        running.send_signal(signal.SIGINT)
        _, error = running.communicate(timeout=60)
    assert "KeyboardInterrupt" in error


def test_known_factors_come_out_first():
    """Known factors are divided out with their powers, products included; the rest is returned."""
    x, y = CTX.gens()
    known = [x + y, x**2 + x + 1, x - 1, y]
    poly = fmpq(-3, 2) * x**2 * y * (x + y) ** 3 * (x**3 - 1) ** 2 * (x**2 - 5 * y)
    content, powers, rest = known_taken_out(poly, known)
    assert {str(factor): exponent for factor, exponent in powers} == {
        "x": 2, "y": 1, "x + y": 3, "x^2 + x + 1": 2, "x - 1": 2,
    }  # fmt: skip
    assert rest == x**2 - 5 * y
    product = content * rest
    for factor, exponent in powers:
        product *= factor**exponent
    assert product == poly


def test_factors_do_not_depend_on_which_are_known():
    """A field that knows some factors as denominators writes the same factorization."""
    x, y = sp.symbols("x y")
    whole = sp.expand((x + y) ** 2 * (x - 2 * y) * (x**2 + y) * x * sp.Rational(-2, 3))
    fresh, met = Field([x, y]), Field([x, y])
    for expression in (1 / (x - 2 * y), y / (x**2 + y), 1 / (x + y)):
        met.read(expression)
    one, two = (field.factored(field.lift(field.read(whole))) for field in (fresh, met))
    assert (one[0], [(str(f), e) for f, e in one[1]]) == (two[0], [(str(f), e) for f, e in two[1]])
    assert len(one[1]) == 4


def dense(rng, variables, terms, degree):
    """A polynomial with many terms of low degree."""
    context = fmpq_mpoly_ctx.get([f"x{k}" for k in range(variables)], Ordering.lex)
    found = {}
    for _ in range(terms):
        exponents = [0] * variables
        for _ in range(rng.randint(0, degree)):
            exponents[rng.randrange(variables)] += 1
        found[tuple(exponents)] = fmpq(rng.choice((-9, -4, -1, 2, 6)), rng.randint(1, 4))
    return context.from_dict(found)


def test_dense_polynomials_have_the_factors_of_flint():
    """The factorization of dense polynomials equals flint's, irreducible or not, signs included."""
    rng, kinds = random.Random(5), set()
    for k in range(60):
        poly = dense(rng, 4, rng.randint(9, 20), 3)
        poly *= dense(rng, 4, 4, 2) if k % 3 == 0 else fmpq(-6, 7) ** (k % 2)
        content, factors = factored(poly, FACTORED_HERE)
        plain_content, plain = poly.factor()
        assert (content, factors) == (plain_content, [(f, int(e)) for f, e in plain])
        kinds.add(is_irreducible_on_a_line(poly))
    assert kinds == {True, False}
    square = dense(rng, 3, 9, 2) ** 2
    assert not is_irreducible_on_a_line(square)

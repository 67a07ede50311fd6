"""Zero test: each hard zero is zero and each near-zero is not."""

import random

import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.exact import Field
from tests.exact import deep_zeros, hard_zeros, near_zeros
from tests.exact.symbols import POINT, plain


def read(expression, *, complex=False, sample=POINT):
    """An expression read into a new field."""
    symbols = sorted(expression.free_symbols, key=str)
    given = None if sample is None else {s: v for s, v in sample.items() if s in symbols}
    return Field(symbols, complex=complex, sample=given).read(expression)


def cases(groups):
    """All cases of a dictionary of groups, as pytest parameters with readable names."""
    return [
        pytest.param(sp.sympify(e), id=f"{group}: {label}".replace(" ", "-"))
        for group, members in groups.items()
        for label, e in members.items()
    ]


REAL_ZEROS = cases(hard_zeros.REAL_GROUPS)
REAL_NEAR = cases(near_zeros.REAL_GROUPS)


@pytest.mark.parametrize("expression", REAL_ZEROS)
def test_hard_zeros_are_zero(expression):
    """A listed zero is read as zero."""
    assert read(expression).is_zero is True


@pytest.mark.parametrize("expression", REAL_ZEROS)
def test_hard_zeros_are_never_called_non_zero_without_assumptions(expression):
    """Symbols without assumptions, no sample: zero on the stated branch, or undecided."""
    bare = plain(expression)
    try:
        element = read(bare, sample=None)
    except ExpressionError:
        return
    assert element.is_zero in (True, None) or element.field.branches


@pytest.mark.parametrize("expression", REAL_ZEROS)
def test_hard_zeros_plus_one_are_not_zero(expression):
    """A hard zero plus one is not zero."""
    assert read(expression + 1).is_zero is False


@pytest.mark.parametrize("expression", REAL_NEAR)
def test_near_zeros_are_not_zero(expression):
    """A near-zero is not zero, however small; an expression beyond a limit may be refused."""
    try:
        element = read(expression)
    except LimitError:
        return
    assert element.is_zero is False


@pytest.mark.parametrize("expression", REAL_NEAR)
def test_near_zeros_have_an_inverse(expression):
    """A near-zero can be inverted: e * (1 / e) is one."""
    try:
        element = read(expression)
    except LimitError:
        pytest.skip("refused, see above")
    assert element * element.inverse() == element.field.one


@pytest.mark.parametrize("expression", cases({"complex": hard_zeros.COMPLEX}))
def test_complex_zeros(expression):
    """Zeros that need the imaginary unit."""
    assert read(expression, complex=True).is_zero is True


@pytest.mark.parametrize("expression", cases({"complex": near_zeros.COMPLEX}))
def test_complex_near_zeros(expression):
    """Near-zeros that need the imaginary unit."""
    assert read(expression, complex=True).is_zero is False


@pytest.mark.parametrize("expression", cases({"deep": deep_zeros.DEEP}))
def test_deep_zeros_are_never_called_non_zero(expression):
    """A deep zero is refused, undecided or zero; calling it non-zero would be wrong."""
    try:
        element = read(expression)
    except ExpressionError:
        return
    assert element.is_zero in (True, None)


X, Y = sp.symbols("x y", positive=True)
ATOMS = (
    X, Y, sp.sin(X), sp.cos(X), sp.tan(Y / 2), sp.cos(X + 2 * Y), sp.exp(X - Y), sp.sinh(Y),
    sp.sqrt(X + 1), sp.sqrt(X * Y + 2), sp.cbrt(X + 3), sp.log(X + Y), sp.atan(X), sp.sqrt(2),
    sp.pi, sp.cos(sp.pi / 7), sp.cos(2 * sp.pi / 7), sp.cbrt(2 + sp.sqrt(5)), sp.Integer(3),
)  # fmt: skip
# Ways to rewrite an expression; sympy may leave it unchanged.
REWRITINGS = (
    sp.expand,
    sp.together,
    lambda e: e.expand(trig=True),
    lambda e: e.rewrite(sp.sinh, sp.exp),
    lambda e: e.subs(sp.tan(Y / 2), sp.sin(Y) / (1 + sp.cos(Y))),
    lambda e: e.subs(sp.cos(2 * sp.pi / 7), 2 * sp.cos(sp.pi / 7) ** 2 - 1),
    lambda e: e.subs(sp.cbrt(2 + sp.sqrt(5)), (1 + sp.sqrt(5)) / 2),
)
MORE = (0, 0, 0, sp.Rational(1, 10**40), sp.Rational(1, 10**25) * X, sp.sin(X) / 10**30)


def random_expression(rng, depth=2):
    """A sum, product, quotient or power of random expressions."""
    if not depth:
        return rng.choice(ATOMS)
    one, two = (random_expression(rng, depth - 1) for _ in range(2))
    kind = rng.randrange(5)
    if kind == 0:
        return one * two
    if kind == 1:
        return one / (two**2 + 1)
    if kind == 2:
        return (one + rng.randint(-3, 3)) ** 2
    return one + rng.choice((-2, -1, 1, 3)) * two


def disagreements(seed, count):
    """Differences of two forms of an expression whose zero test disagrees with sixty digits."""
    rng, wrong, zeros = random.Random(seed), [], 0
    place = {X: sp.Rational(17, 11), Y: sp.Rational(5, 7)}
    for _ in range(count):
        one = random_expression(rng)
        two = rng.choice(REWRITINGS)(rng.choice(REWRITINGS)(one))
        difference = sp.Add(one, -two, rng.choice(MORE), evaluate=False)
        value = sp.N(difference, 60, subs=place, maxn=400)
        vanishes = bool(abs(value) < sp.Float(10, 60) ** -55)
        zeros += vanishes
        if read(difference, sample=place).is_zero is not vanishes:
            wrong.append(f"{one} - ({two}): {value}")
    assert 3 * zeros > count
    return wrong


def test_nonzero_values_decide_sums_of_dependent_roots():
    """Sums with possibly dependent roots are long; a non-zero value is enough to decide them."""
    field = Field([X])
    third = sp.Rational(1, 3)
    root = field.read((sp.cosh(X) ** third + 1) ** sp.Rational(3, 4))
    total = root + field.read(X) + 1
    assert not field.all_sure
    assert total.is_zero is False


def test_unrelated_roots_do_not_change_a_decision():
    """A polynomial of independent generators is decided, whatever else was read."""
    field = Field([X])
    field.read((sp.cosh(X) ** sp.Rational(1, 3) + 1) ** sp.Rational(3, 4))
    assert not field.all_sure
    something = field.read(sp.cosh(X) ** 2 + X)
    nothing = field.read(sp.cosh(X) ** 2 - sp.sinh(X) ** 2 - 1)
    assert something.is_zero is False
    assert nothing.is_zero is True


def test_against_sixty_digits():
    """The zero test agrees with sixty digits on random differences."""
    assert not disagreements(1, 80)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_many_more_against_sixty_digits(seed):
    """As above, with more expressions."""
    assert not disagreements(100 + seed, 500)

"""Branches: each choice of a root or inverse function is stated, selectable and consistent."""

# Bad input, lists as arrays and results that may be None: the types are stricter.
# pyright: reportArgumentType=false

import pytest
import sympy as sp
from sympy import acos, asin, atan, atan2, cos, log, pi, sin, sqrt, tan

import geomtorsion as gt
from geomtorsion.errors import ExpressionError
from geomtorsion.exact import Field

x, y, r, m = sp.symbols("x y r m")
n = sp.Symbol("n", negative=True)

# radical, sample, value at that sample point, another sample, value there
CHOICES = {
    "cosine": (sqrt(1 - sin(x) ** 2), {x: 1}, cos(x), {x: 2}, -cos(x)),
    "sine": (sqrt(1 - cos(x) ** 2), {x: 1}, sin(x), {x: 4}, -sin(x)),
    "difference": (sqrt((r - m) ** 2), {r: 2, m: 1}, r - m, {r: 1, m: 2}, m - r),
    "square": (sqrt(x**2), {x: 1}, x, {x: -1}, -x),
    "quotient": (sqrt(x**2 / y**2), {x: 1, y: 1}, x / y, {x: 1, y: -1}, -x / y),
    "sixth": ((x**6) ** sp.Rational(1, 6), {x: 1}, x, {x: -1}, -x),
    "nested": (
        sqrt(x**2 + 2 * x * sqrt(y) + y),
        {x: 1, y: 1},
        x + sqrt(y),
        {x: -2, y: 1},
        -x - sqrt(y),
    ),
    "arc sine": (asin(sin(x)), {x: sp.Rational(1, 2)}, x, {x: 2}, pi - x),
    "arc cosine": (acos(cos(x)), {x: 1}, x, {x: -1}, -x),
    "arc tangent": (atan(tan(x)), {x: 1}, x, {x: 2}, x - pi),
    "double arc": (
        asin(2 * x * sqrt(1 - x**2)),
        {x: sp.Rational(1, 3)},
        2 * asin(x),
        {x: sp.Rational(9, 10)},
        pi - 2 * asin(x),
    ),
    "reciprocal": (
        atan(x) + atan(1 / x),
        {x: 2},
        pi / 2,
        {x: -2},
        -pi / 2,
    ),
    "angle of a point": (
        atan2(y, x) - atan(y / x),
        {x: 1, y: 1},
        sp.S.Zero,
        {x: -1, y: 1},
        pi,
    ),
    "logarithm of a square": (
        log((x - y) ** 2) / 2,
        {x: 2, y: 1},
        log(x - y),
        {x: 1, y: 2},
        log(y - x),
    ),
}


@pytest.mark.parametrize("label", CHOICES)
@pytest.mark.parametrize("which", [0, 1])
def test_the_sample_point_decides(label, which):
    """Two sample points on both sides of a threshold give two values, each the right one."""
    radical, *rest = CHOICES[label]
    sample, wanted = rest[2 * which], rest[2 * which + 1]
    field = Field(sorted(radical.free_symbols, key=str), sample=sample)
    element = field.read(radical)
    assert element == field.read(wanted)
    assert float(element.evaluate(sample)) == pytest.approx(float(radical.subs(sample)))


@pytest.mark.parametrize("label", CHOICES)
def test_every_choice_is_stated(label):
    """A choice that no assumption settles is listed among the branches, with its condition."""
    radical, sample, wanted, *_ = CHOICES[label]
    field = Field(sorted(radical.free_symbols, key=str), sample=sample)
    field.read(wanted)
    field.read(radical)
    assert field.branches
    for branch in field.branches:
        assert str(branch.condition)
        assert str(branch.read_as)


def test_nothing_is_stated_where_nothing_was_chosen():
    """A field lists no branches for roots of positive expressions."""
    p, q = sp.symbols("p q", positive=True)
    field = Field([p, q])
    field.read(sqrt(p * q) / sqrt(p + q) + sqrt(p**2) + log(p * q))
    assert field.branches == ()


def test_one_field_keeps_one_choice():
    """A choice stays when an expression read later prefers another sample point."""
    field = Field([r, m])
    first = field.read(sqrt((r - m) ** 2))
    for later in (log(r - 2 * m), log(m - r), sqrt(r - 3 * m)):
        try:
            field.read(later)
        except ExpressionError:
            continue
        assert field.read(sqrt((r - m) ** 2)) == first


def test_branches_can_be_chosen():
    """branches={root: value} selects the other sign; a value that is not a root is refused."""
    root = sqrt(1 - sin(x) ** 2)
    field = Field([x], branches={root: -cos(x)})
    assert field.read(root) == field.read(-cos(x))
    with pytest.raises(ExpressionError, match="root"):
        Field([x], branches={root: sin(x)}).read(root)


@pytest.mark.parametrize("power", [-3, -1, 3])
def test_a_chosen_branch_holds_for_the_powers_of_its_root(power):
    """With sqrt(1 - sin(x)**2) read as -cos(x), powers of the root are powers of -cos(x)."""
    root = sqrt(1 - sin(x) ** 2)
    field = Field([x], branches={root: -cos(x)})
    assert field.read(root**power) == field.read((-cos(x)) ** power)


@pytest.mark.parametrize(
    "value",
    [
        pytest.param(-sqrt(1 + x**2), id="the other sign"),
        pytest.param(sqrt(1 + x**2), id="itself"),
    ],
)
def test_a_root_is_not_chosen_by_itself(value):
    """The choice of a root by itself is refused, and the message states what to write instead."""
    root = sqrt(1 + x**2)
    field = Field([x], branches={root: value})
    for _ in range(2):
        with pytest.raises(ExpressionError, match=r"without this root.*, got .*write -sqrt\(x"):
            field.read(root)
    with pytest.raises(ExpressionError, match=r"coframe\[0, 0\]: branches\[sqrt"):
        gt.Frame([x], [[root]], branches={root: value})


def test_the_same_root_written_otherwise():
    """A value that the field writes with the same root is refused."""
    root = sqrt(1 + x**2)
    field = Field([x], branches={root: -sqrt(2 + 2 * x**2) / sqrt(2)})
    field.read(sqrt(root))
    with pytest.raises(ExpressionError, match="without this root"):
        field.read(root)


def test_roots_chosen_in_a_circle():
    """Two roots that are chosen by each other are refused."""
    one, two = sqrt(1 + x**2), sqrt(1 + y**2)
    with pytest.raises(ExpressionError, match="without this root"):
        Field([x, y], branches={one: two, two: one}).read(one)


def test_the_other_sign_in_the_coframe():
    """A minus sign at the root, as the message advises, gives the other branch."""
    root = sqrt(1 + x**2)
    other = gt.cartan(gt.Frame([x, y], [[1, 0], [0, x - root]]))[0, 1, 1]
    assert other == gt.cartan(gt.Frame([x, y], [[1, 0], [0, root - x]]))[0, 1, 1] == -1 / root


def test_negative_symbols():
    """Assumptions about symbols count: n < 0."""
    field = Field([n])
    assert field.read(sqrt(n**2) + n).is_zero is True
    assert field.read(sqrt(-n) ** 2 + n).is_zero is True
    assert field.read(log(-2 * n) - log(2) - log(-n)).is_zero is True
    with pytest.raises(ExpressionError, match="negative"):
        field.read(log(n))


def test_parts_of_a_turn_are_recognised():
    """asin(sin(x + pi/60)) is x + pi/60: the field decides the branch of a small shift."""
    x = sp.Symbol("x", positive=True)
    assert Field([x]).read(asin(sin(x + pi / 60))).sympy == x + pi / 60

"""Modular: the zero test at a random point modulo a prime agrees with the exact test."""

import random

import pytest
import sympy as sp

from geomtorsion.exact import Field
from geomtorsion.exact.kept import kept
from geomtorsion.exact.modular import ModularPoint

x, y, k = sp.symbols("x y k")
f = sp.Function("f")
ATOMS = (
    x, y, k, sp.sin(x), sp.cos(x), sp.sin(x + y), sp.cos(2 * y), sp.exp(x), sp.exp(x / 2 - y),
    sp.cosh(y), sp.sinh(2 * y), sp.sqrt(x**2 + 1), sp.sqrt(x + y), sp.sqrt(2), sp.sqrt(3) / 2,
    (x + 2) ** sp.Rational(1, 3), sp.log(y), sp.atan(x), f(x), f(x).diff(x), sp.tan(x / 2),
)  # fmt: skip
# Terms that are small, but not zero.
NEAR = (sp.Rational(1, 10**40), sp.Rational(-3, 2**200))


def random_terms(rng: random.Random, field: Field) -> list[tuple]:
    """Coefficients and factors of a sum of products of small elements."""

    def element():
        return field.read(sum(rng.randint(-3, 3) * rng.choice(ATOMS) for _ in range(2)) + 1)

    return [
        (rng.choice((-2, -1, 1, 3)), *(element() for _ in range(rng.randint(1, 3))))
        for _ in range(rng.randint(1, 3))
    ]


def disagreements(seed: int, count: int) -> list[str]:
    """Cases with a wrong zero test: a sum minus itself, plus nothing, a small or a large term."""
    rng, wrong = random.Random(seed), []
    field = Field([x, y, k])
    for number in range(count):
        if number % 100 == 0:
            field = Field([x, y, k])
        terms = random_terms(rng, field)
        value = field.one
        for term in terms[:1]:
            value = field.sum([term])
        rest = field.sum(terms[1:])
        whole = field.sum([(1, value), (1, rest)])
        more = rng.choice((0, 0, *NEAR, sp.sin(x), 1))
        unexpanded = kept(field, [*terms, (-1, whole), (1, field.read(more))])
        if (unexpanded.is_zero is True) != (more == 0):
            wrong.append(f"{number}: {terms}, {more}")
    return wrong


def test_sums_less_themselves():
    """A sum minus itself is zero; 1e-40 more is not."""
    assert not disagreements(1, 300)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_ten_thousand_sums(seed):
    """The zero test is right for ten thousand sums minus themselves."""
    assert not disagreements(100 + seed, 1000)


def test_the_error_probability_matches_256_bits():
    """The bound on the probability of an error is the degree 3 times about 2**-255."""
    field = Field([x, y])
    chance = ModularPoint(field).chance(field.read(x**3 - y))
    assert 2.0**-256 < chance / 3 < 2.0**-254


RELATIONS = {
    "circle": "sin(x)**2 + cos(x)**2 - 1",
    "hyperbola": "cosh(2*x) - 2*cosh(x)**2 + 1",
    "nested roots": "sqrt(x + sqrt(x**2 - y))**4 - 2*x*(x + sqrt(x**2 - y)) + y",
    "cube root": "(x + 2)**(1/3)**1 * (x + 2)**(2/3) - x - 2",
    "half angle": "tan(x/2) - sin(x)/(1 + cos(x))",
    "third of an angle": "4*cos(x/3)**3 - 3*cos(x/3) - cos(x)",
    "exponentials": "exp(x + y) - exp(x)*exp(y)",
    "constant roots": "sqrt(2)*sqrt(3) - sqrt(6)",
}


@pytest.mark.parametrize("relation", RELATIONS.values(), ids=RELATIONS.keys())
def test_generators_obey_their_relations(relation):
    """An identity vanishes at the point, and each root satisfies its equation there."""
    field = Field([x, y])
    zero = field.read(sp.sympify(relation))
    every = field.sum((1, field.generator_element(g)) for g in field.generators)
    point = ModularPoint(field)
    assert point.image(zero) == 0
    assert point.image(every) != 0
    for generator in field.generators:
        if generator.tail is not None and not generator.middle:
            w = field.generator_element(generator)
            assert point.image(w) ** generator.degree == point.image(generator.tail)


def test_the_same_in_every_field():
    """Two fields of the same symbols have the same point, so that results do not vary."""
    images = []
    for _ in range(2):
        field = Field([x, y])
        images.append(int(ModularPoint(field).image(field.read(sp.sin(x) / (y + sp.sqrt(x))))))
    assert images[0] == images[1]


def test_a_small_error_probability_is_reported():
    """A zero that is not multiplied out carries a bound on the error probability below 1e-30."""
    field = Field([x, y])
    powers = range(45)
    long = [
        field.read(sp.Add(*[(i + j + m) * x**i * y**j for i in powers for j in powers]))
        for m in (1, 2, 3)
    ]
    a, b, c = long
    other = field.sum([(1, a, b), (-1, b, a)])
    assert other.is_zero is True
    deep = a * b * c * a * b * c - c * b * a * c * b * a
    assert deep.is_zero is True
    assert not deep.certainty.proved
    assert 0 < deep.certainty.error < 1e-30
    assert "chance of error below" in str(deep.certainty)
    assert (deep + 1).is_zero is False
    assert (deep + 1).certainty.proved


PARTS_OF_A_TURN = {
    "three cosines of sevenths": "cos(pi/7)*cos(2*pi/7)*cos(4*pi/7) + 1/8",
    "three sines of sevenths": "sin(pi/7)*sin(2*pi/7)*sin(3*pi/7) - sqrt(7)/8",
    "ninths": "cos(pi/9)*cos(2*pi/9)*cos(4*pi/9) - 1/8",
    "sum of elevenths": "cos(pi/11)+cos(3*pi/11)+cos(5*pi/11)+cos(7*pi/11)+cos(9*pi/11) - 1/2",
    "seventeenths": "2*cos(pi/17)**2 - 1 - cos(2*pi/17)",
}


@pytest.mark.parametrize("text", PARTS_OF_A_TURN.values(), ids=PARTS_OF_A_TURN.keys())
def test_parts_of_a_turn_are_decided(text):
    """Identities of sines and cosines of pi-fractions are decided, by roots of unity."""
    field = Field([x])
    zero = field.read(sp.sympify(text))
    assert zero.is_zero is True
    assert (zero * field.read(x) + field.read(sp.Rational(1, 10**40))).is_zero is False


@pytest.mark.parametrize("degree", [100, 400])
def test_products_go_to_products(degree):
    """The value at the point respects products and sums, also of polynomials of high degree."""
    field = Field([x, y])
    a, b = field.read(x**degree - 7 * y + sp.sqrt(2)), field.read(3 * x * y**5 + sp.Rational(1, 3))
    point = ModularPoint(field)
    assert point.image(a * b) == point.image(a) * point.image(b)
    assert point.image(a + b) == point.image(a) + point.image(b)


def test_roots_of_numbers_that_few_primes_have():
    """Roots of numbers, one nested: other symbols do not help, another prime does."""
    third = sp.Rational(1, 3)
    roots = [sp.Integer(6) ** third, (1 + sp.Integer(10) ** third) ** third, 7**third, sp.sqrt(29)]
    field = Field([x])
    one, two, three, four = (field.read(root) for root in roots)
    point = ModularPoint(field)
    whole = field.read(x) * (one + two) * (three + four)
    assert int(point.image(whole * whole - whole)) != 0
    for known in (one**3 - 6, (two**3 - 1) ** 3 - 10, three**3 - 7, four**2 - 29):
        assert int(point.image(whole * known)) == 0
    assert (field.read(x * sum(roots)) - field.read(x) * (one + two + three + four)).is_zero is True


def test_roots_of_unlike_symbols_are_found_one_symbol_after_the_other():
    """Eight square roots in each of three symbols need 3 * 2**8 trials; 2**24 would be too many."""
    symbols = sp.symbols("x y z", positive=True)
    field = Field(list(symbols))
    sums = [
        field.read(sum(k * sp.sqrt(s**2 + k * s + k) for k in (1, 2, 3, 5, 6, 7, 8, 9)))
        for s in symbols
    ]
    one, two, three = sums
    whole = field.sum([(1, one, two, three), (-1, three, two, one)])
    point = ModularPoint(field)
    assert point.image(whole) == 0
    assert point.image(field.sum([(1, one, two), (1, three)])) != 0
    for generator in field.generators:
        if generator.tail is not None:
            root = field.generator_element(generator)
            assert point.image(root**2 - generator.tail) == 0


@pytest.mark.parametrize("constant", [0, sp.sqrt(3), sp.cos(sp.pi / 7), sp.I * sp.sqrt(5)])
def test_twelve_cube_roots_of_one_symbol(constant):
    """Modulo a prime that is 2 modulo 3 each number has one cube root: no search over 3**12 cases.

    This holds also with a constant that needs its own primes; sqrt(3) leaves four roots.
    """
    count = 4 if constant == sp.sqrt(3) else 12
    field = Field([x], complex=bool(constant and constant.has(sp.I)))
    third = sp.Rational(1, 3)
    roots = [field.read((x**2 + k * x + 1) ** third) for k in range(3, 3 + count)]
    total = field.sum([(1, field.read(constant)), *((1, root) for root in roots)])
    point = ModularPoint(field)
    assert point.image(total) != 0
    for k, root in enumerate(roots):
        assert point.image(root**3 - field.read(x**2 + (k + 3) * x + 1)) == 0
    assert point.image(field.read(constant) ** 2 - field.read(constant**2)) == 0
    assert field.sum([(1, total, total), (-1, total, total)]).is_zero is True


def test_roots_that_need_roots_of_unity_have_images():
    """Roots of several odd degrees have images also beside constants that need roots of unity."""
    field = Field([x, y, k])
    roots = [(s + 2) ** sp.Rational(1, n) for s in (x, y, k) for n in (3, 5)]
    total = field.read(sum(roots) + sp.cos(sp.pi / 9) * sp.sin(sp.pi / 25))
    point = ModularPoint(field)
    assert point.image(total) != 0
    for root, n in zip(roots, (3, 5) * 3, strict=True):
        assert point.image(field.read(root) ** n - field.read(root**n)) == 0

"""Printing: texts are equal to sympy's, and a repeated part is written once."""

import random

import pytest
import sympy as sp

from geomtorsion.exact.printing import TexPrinter, TextPrinter

x, y = sp.symbols("x y")
f = sp.Function("f")
LEAVES = [x, y, sp.Integer(-2), sp.Rational(3, 7), sp.pi, f(x), f(x).diff(x), f(x, y).diff(x, y)]


def expression(numbers, depth):
    """Products, sums, powers and functions of a few parts, which occur at many places."""
    parts = list(LEAVES)
    for _ in range(depth):
        one, other = numbers.choice(parts), numbers.choice(parts)
        exponent = numbers.choice([2, -1, sp.Rational(1, 2), sp.Rational(-3, 4)])
        made = [
            one * other + 1,
            one - other,
            sp.sin(one),
            sp.exp(one) * other,
            (one + x) ** exponent,
        ]
        parts.append(numbers.choice(made))
    return sp.Add(*parts[-3:])


@pytest.mark.parametrize(
    "seed", [pytest.param(k, marks=() if k < 8 else pytest.mark.slow) for k in range(20)]
)
def test_texts_agree_with_sympy(seed):
    """One printer, which remembers the parts that it wrote, prints many expressions like sympy."""
    numbers = random.Random(seed)
    plain, tex = TextPrinter(), TexPrinter()
    for _ in range(10):
        one = expression(numbers, 12)
        assert plain.doprint(one) == str(one)
        assert tex.doprint(one) == sp.latex(one)


@pytest.mark.parametrize("printer", [TextPrinter, TexPrinter])
def test_repeated_sums_are_printed_once(printer):
    """A sum that occurs in a thousand terms is printed once."""

    class Counting(printer):
        sums = 0

        def _print_Add(self, expr, order=None):
            self.sums += 1
            return super()._print_Add(expr, order=order)

    below = x * sp.sin(y) + y * sp.cos(x) + 2
    whole = sp.Add(*(sp.Symbol(f"a{k}") * below * sp.sin(below) for k in range(1000)))
    counting = Counting()
    text = counting.doprint(whole)
    assert text == printer().doprint(whole)
    assert text.count("a") >= 1000
    assert counting.sums == 2

"""Primitives: logarithms and inverse functions, kept independent by their derivatives.

Functions with derivatives in the field are algebraically dependent exactly when a constant
combination of them is in the field (Ostrowski 1946, Kolchin 1968).  Each new one is
therefore compared, derivative by derivative, with those known, with the exponents and
angles in use and with the coordinates themselves.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import repeat
from operator import truediv
from typing import TYPE_CHECKING

import mpmath
import sympy
from flint import fmpq
from mpmath.libmp import to_rational

from geomtorsion.errors import ExpressionError
from geomtorsion.exact.arguments import express
from geomtorsion.exact.generators import Branch, Generator
from geomtorsion.exact.limits import LARGEST_MULTIPLE
from geomtorsion.exact.polynomials import prime_factors
from geomtorsion.support.precision import EXACT_BITS, working_precision

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower

    # Argument of a logarithm; or inner element, slope and arguments of an inverse function.
    Data = Element | tuple[Element, Element, tuple[Element, ...]]

# Values at the generic point have 90 digits: what differs by less than this is equal.
_CLOSE = mpmath.mpf(10) ** -70


def _stated_root(radicand: Element) -> Element:
    """The square root in a slope; a chosen sign is stated as for any other root."""
    # Not evaluated, or sympy makes Abs of it.
    radical = sympy.Pow(radicand.sympy, sympy.Rational(1, 2), evaluate=False)
    return radicand.field.root(radicand, 2, radical)


_SLOPES: dict[str, Callable[[Element], Element]] = {
    "atan": lambda u: (u * u + 1).inverse(),
    "acot": lambda u: -(u * u + 1).inverse(),
    "asin": lambda u: _stated_root(1 - u * u).inverse(),
    "acos": lambda u: -_stated_root(1 - u * u).inverse(),
    "asinh": lambda u: _stated_root(u * u + 1).inverse(),
    "acosh": lambda u: _stated_root(u * u - 1).inverse(),
    "atanh": lambda u: (1 - u * u).inverse(),
    "acoth": lambda u: (1 - u * u).inverse(),
}
INVERSE_FUNCTIONS = frozenset(_SLOPES)


class Primitives:
    """The logarithms and inverse functions of one field."""

    def __init__(self, field: Tower, arguments: Callable[[], list[Element]]) -> None:
        self._field = field
        self._arguments = arguments
        self._known: list[tuple[Element, tuple[Element, ...]]] = []
        self._by_argument: dict[tuple[str, tuple[Element, ...]], Element] = {}

    def log(self, element: Element) -> Element:
        """The logarithm, as a sum over the factors of its argument.

        Raises
        ------
        ExpressionError
            the argument is zero.
        """
        field = self._field
        if not element._num:
            raise ExpressionError("log of an expression that is exactly zero")
        field.sample.prefer_positive(element)
        content, factors = field.factored(field.lift(element))
        # log(x**2 y) = 2 log(x) + log(y): the logarithms of irreducible factors are independent.
        powers = [(field.polynomial(factor), exponent) for factor, exponent in factors]
        powers += [(field.polynomial(field.factors[i]), -e) for i, e in element._den]
        total, value = [], fmpq(content)
        for base, exponent in powers:
            if not field.sample.is_positive(base):
                base, value = -base, value * (-1) ** (exponent % 2)
            if len(powers) > 1 or exponent != 1:
                self._state(element, base)
            total.append((exponent, self._log_of_factor(base)))
        if value < 0:
            total.append((1, self._imaginary_turn(element)))
        for prime, exponent in prime_factors(abs(value.p)):
            total.append((exponent, self._log_of_prime(int(prime))))
        for prime, exponent in prime_factors(value.q):
            total.append((-exponent, self._log_of_prime(int(prime))))
        return self._principal(element, field.sum(total))

    def _principal(self, element: Element, value: Element) -> Element:
        """A sum of complex logarithms brought back to an angle between -pi and pi."""
        field = self._field
        if not field.is_complex:
            return value
        try:
            with working_precision(EXACT_BITS):
                excess = field.sample.value(value) - mpmath.log(field.sample.value(element))
                turns = int(mpmath.nint(mpmath.im(excess) / (2 * mpmath.pi)))
        except (ArithmeticError, ValueError):
            return value
        return value - field.read(2 * sympy.pi) * field.imaginary * turns

    def _state(self, element: Element, base: Element) -> None:
        """Notes that a logarithm was split, unless the factor is positive by assumption."""
        shown = base.sympy
        if not shown.is_positive:
            whole = sympy.log(element.sympy)
            split = sympy.expand_log(whole, force=True)
            condition, holds = f"{shown} > 0", base
            if self._field.is_complex:
                condition, holds = self._field.sample.place_in_words(), None
            self._field.state_branch(Branch(whole, split, condition, holds))

    def _imaginary_turn(self, element: Element) -> Element:
        """log(-1) = i pi."""
        field = self._field
        if not field.is_complex:
            raise ExpressionError(
                f"contains log of {element}, which is negative at the sample point; "
                "change its sign, or give a domain where it is positive"
            )
        return field.read(sympy.pi) * field.imaginary

    def _log_of_prime(self, prime: int) -> Element:
        field = self._field
        shown = sympy.log(prime)
        for generator in field.generators:
            if generator.kind == "constant" and generator.shown == shown:
                return field.generator_element(generator)
        # Whole numbers have one factorization: logarithms of primes are independent.
        return field.add(Generator("constant", field.next_name("number"), shown, frozenset()))

    def _log_of_factor(self, base: Element) -> Element:
        """The logarithm of one factor; exponentials and roots need no generator."""
        field = self._field
        logarithm = self._by_argument.get(("log", (base,)))
        if logarithm is not None:
            return logarithm
        # log(exp(u)) is u; the logarithm of a root is a part of a logarithm.
        for generator in field.generators_of(base):
            if generator.kind == "imaginary" and base == field.imaginary:
                return field.read(sympy.pi / 2) * field.imaginary
            if base == field.generator_element(generator):
                if generator.kind == "exp":
                    return generator.argument
                if generator.kind == "root" and generator.tail is not None:
                    return self.log(generator.tail) * fmpq(1, generator.degree)
        slopes = tuple(map(truediv, map(base.diff, field.symbols), repeat(base)))
        value = self._added("log", sympy.log(base.sympy), (base,), slopes, base)
        self._by_argument["log", (base,)] = value
        return value

    def inverse_function(self, name: str, argument: Element) -> Element:
        """atan, asin, acos, acot, asinh, acosh, atanh, acoth of an argument."""
        slope = _SLOPES[name](argument)
        return self._primitive(name, (argument,), argument, slope)

    def atan2(self, y: Element, x: Element) -> Element:
        """The polar angle of (x, y)."""
        ratio = y / x
        return self._primitive("atan2", (y, x), ratio, (ratio * ratio + 1).inverse())

    def _primitive(
        self, name: str, arguments: tuple[Element, ...], inner: Element, slope: Element
    ) -> Element:
        primitive = self._by_argument.get((name, arguments))
        if primitive is None:
            # Unevaluated, so that its type stays the name: sympy rewrites asinh(-u).
            shown = getattr(sympy, name)(*(part.sympy for part in arguments), evaluate=False)
            slopes = tuple(slope * inner.diff(s) for s in self._field.symbols)
            data = (inner, slope, arguments)
            primitive = self._added(name, shown, arguments, slopes, data)
            self._by_argument[name, arguments] = primitive
        return primitive

    def _added(
        self,
        name: str,
        shown: sympy.Expr,
        arguments: tuple[Element, ...],
        slopes: tuple[Element, ...],
        data: Data,
    ) -> Element:
        """The function as combination of known ones plus a constant, or a new generator."""
        field = self._field
        depends: frozenset[sympy.Symbol] = frozenset()
        for argument in arguments:
            depends |= argument.symbols
        # A constant: its derivatives do not show dependence.
        if not any(slope._num for slope in slopes):
            return self._constant_function(name, shown, data)
        value = self._number(name, arguments)
        combination = self._combination(slopes)
        sure = True
        if combination is not None:
            constant = None if value is None else self._constant(value, combination)
            if constant is not None:
                result = combination + constant
                self._field.state_branch(Branch(shown, result.sympy, field.sample.place_in_words()))
                return result
            # A constant that is not recognised may or may not be rational: nothing is claimed.
            sure = False
        kind = "log" if name == "log" else "primitive"
        generator = Generator(kind, field.next_name(kind), shown, depends, argument=data, sure=sure)
        element = field.add(generator)
        if sure:
            self._known.append((element, slopes))
        return element

    def _constant_function(
        self,
        name: str,
        shown: sympy.Expr,
        data: Data,
    ) -> Element:
        """A logarithm or inverse function of a constant; only log(pi) is believed to be more."""
        field = self._field
        pi = field.by_name.get("pi")
        sure = name == "log" and pi is not None and data == field.generator_element(pi)
        kind = "log" if name == "log" else "primitive"
        new = field.next_name(kind)
        return field.add(Generator(kind, new, shown, frozenset(), argument=data, sure=sure))

    def _combination(self, slopes: tuple[Element, ...]) -> Element | None:
        """Known functions with the same derivatives, combined; or None."""
        field = self._field
        candidates = [(field.symbol(s), _unit(field, k)) for k, s in enumerate(field.symbols)]
        candidates += [
            (atom, tuple(atom.diff(s) for s in field.symbols)) for atom in self._arguments()
        ]
        # All functions with derivatives in the field; by Ostrowski there is no other relation.
        # A field may have had fewer symbols when a function was added.
        for function, rates in self._known:
            is_old = len(rates) < len(field.symbols)
            rates = tuple(map(function.diff, field.symbols)) if is_old else rates
            candidates.append((function, rates))
        basis: list[tuple[Element, Sequence[Element]]] = list(candidates)
        if field.is_complex:
            turn = field.imaginary
            basis += [(turn * f, [turn * d for d in slope]) for f, slope in candidates]
        coefficients = express(field, slopes, [slope for _, slope in basis])
        if coefficients is None:
            return None
        return field.sum((q, f) for q, (f, _) in zip(coefficients, basis, strict=True) if q)

    def _number(self, name: str, arguments: tuple[Element, ...]) -> mpmath.mpf | None:
        """The value of the function at the sample point, or None."""
        try:
            with working_precision(EXACT_BITS):
                return getattr(mpmath, name)(*map(self._field.sample.value, arguments))
        except (ArithmeticError, ValueError):
            return None

    def _constant(self, value: mpmath.mpf, combination: Element) -> Element | None:
        """The constant value - combination where it is a part of pi or a simple logarithm."""
        field = self._field
        with working_precision(EXACT_BITS):
            rest = mpmath.mpmathify(value - field.sample.value(combination))
            size = 1 + abs(value)
            if abs(mpmath.im(rest)) > size * _CLOSE:
                return None
            rest = mpmath.re(rest)
            if abs(rest) < size * _CLOSE:
                return field.zero
            for number, scale in ((rest / mpmath.pi, sympy.pi), (mpmath.exp(rest), None)):
                if mpmath.mag(number) > EXACT_BITS:
                    continue
                # With so many digits no fraction as short as this is near by chance.
                near = Fraction(*map(int, to_rational(number._mpf_))).limit_denominator(
                    LARGEST_MULTIPLE
                )
                ratio = sympy.Rational(near.numerator, near.denominator)
                if ratio and abs(number - mpmath.mpf(ratio.p) / ratio.q) < size * _CLOSE:
                    exact = ratio * scale if scale is not None else sympy.log(ratio)
                    return field.read(exact)
        return None


def _unit(field: Tower, k: int) -> tuple[Element, ...]:
    return tuple(field.one if j == k else field.zero for j in range(len(field.symbols)))

"""Evaluate: numbers of any precision from elements at given points."""

from __future__ import annotations

from functools import partial
from itertools import repeat
from numbers import Rational
from typing import TYPE_CHECKING, Any

import mpmath
import sympy
from flint import acb, arb, fmpq

from geomtorsion.errors import MissingValueError, SingularPointError
from geomtorsion.exact import polynomials
from geomtorsion.exact.element import in_order, inside_out, leaves
from geomtorsion.exact.form import LONGEST_FACTORED, Sum, form
from geomtorsion.exact.generators import Generator
from geomtorsion.exact.polynomials import as_fmpq
from geomtorsion.exact.roots import roots_restored
from geomtorsion.exact.special_values import VALUES, number
from geomtorsion.support.precision import ball_precision, working_precision

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from flint import fmpq_mpoly

    from geomtorsion.exact.element import Denominator, Element
    from geomtorsion.exact.roots import Below

    Given = Callable[[Generator], mpmath.mpf]
    Known = dict[str | int | tuple[str, int], Any]
    AtPoint = dict[int, Known]


# Bits at the beginning beyond the requested ones. The value does not depend on them; they change
# how often the precision is doubled.
_GUARD = 30
# Expanded numerators cancel; precision is doubled up to this many bits until they agree.
LARGEST_BITS = 2**12
# With more bits before the point one sum takes a tenth of a second, and all of them minutes.
_MOST_BEFORE_THE_POINT = 16 * LARGEST_BITS


def evaluate(
    element: Element, point: Mapping[Any, Any], precision: int = 53, at: AtPoint | None = None
) -> mpmath.mpf:
    """The value of an element at a point; see `Element.evaluate`.

    at: known values there from other elements, by working precision.
    """
    number_of = partial(_given, point)
    value = settled_value(
        partial(_written_value, element, number_of),
        {} if at is None else at,
        precision,
        LARGEST_BITS,
        partial(_bits_before_the_point, element),
    )
    if not element.field.is_complex and mpmath.im(value):
        raise SingularPointError(
            f"{element} is not real here: a root or logarithm of a negative number occurs; move "
            "the point into the domain, or declare the frame complex"
        )
    if precision > 53:
        with working_precision(precision):
            return +value
    return complex(value) if isinstance(value, mpmath.mpc) and value.imag else float(value.real)


def _bits_before_the_point(element: Element, known: Known) -> int:
    """How many bits terms of the element may have before the point, from known values there."""
    field, bits = element.field, 0
    for leaf in leaves(element):
        below = [(field.factors[index], exponent) for index, exponent in leaf._den]
        for poly, exponent in [(field.lift(leaf), 1), *below]:
            for generator, degree in zip(field.generators, poly.degrees(), strict=False):
                value = known.get(generator.name) if degree else None
                if value and mpmath.isfinite(value):
                    bits += abs(mpmath.mag(value)) * int(degree) * exponent
    return bits


def settled_value(
    compute: Callable[[Known], mpmath.mpf],
    levels: AtPoint,
    precision: int,
    largest: int,
    more: Callable[[Known], int] = lambda known: 0,
) -> mpmath.mpf:
    """The value on which two working precisions agree to the requested precision.

    levels: known values at the point, by working precision; each is passed to `compute`.

    Zero is accepted only at the largest precision, if the value is below 2**(-largest/4) there.
    `more` returns the number of bits before the point: two runs with twice as many see them.

    Raises
    ------
    SingularPointError
        no finite value, or none that rises above cancellation, up to the largest precision.
    """
    # An expanded numerator may cancel to any depth, which one run cannot see: two that agree can.
    bits, before = precision + _GUARD, None
    while True:
        with working_precision(bits):
            numbers = levels.setdefault(mpmath.mp.prec, {})
            try:
                value = compute(numbers)
            except (SingularPointError, ZeroDivisionError):
                if bits > largest + 2 * min(more(numbers), _MOST_BEFORE_THE_POINT):
                    raise
                value = None
            if before is not None and value is not None and mpmath.isfinite(value):
                if value and abs(value - before) <= mpmath.ldexp(abs(value), -precision - 3):
                    return value
                before_the_point = more(numbers) if bits > largest else 0
                is_seen = before_the_point <= _MOST_BEFORE_THE_POINT
                if bits > largest and (not is_seen or bits > largest + 2 * before_the_point):
                    if is_seen and abs(value) < mpmath.ldexp(1, -largest // 4):
                        # Below all rounding of the largest precision, so that it counts as zero.
                        return value * 0
                    raise SingularPointError(
                        f"the value is lost in cancellation even with {bits} bits; "
                        "move the point away from the edge of the chart"
                    )
        before, bits = value, 2 * bits


def _written_value(element: Element, given: Given, known: Known) -> mpmath.mpf:
    """The value of the written form, which has fewer removable singularities."""
    if element.is_kept:
        return _kept_value(element, given, known, _written_value)
    if len(element._num) > LONGEST_FACTORED:
        # Its numerator would be written term by term, as it is.
        return _quotient(element, *roots_restored(element), given, known)
    written = form(element)
    result = mpmath.mpf(int(written.coefficient.p)) / int(written.coefficient.q)
    for base, exponent in written.powers:
        if isinstance(base, Sum):
            value = _total(base.terms, given, known)
        else:
            value = _generator(base, given, known)
        if not value and exponent < 0:
            raise SingularPointError(
                f"{element} has no finite value here: its denominator vanishes; "
                "move the point away from the edge of the chart"
            )
        result *= value**exponent
    return result


def values(element: Element, given: Given, known: Known) -> mpmath.mpf:
    """The value from the values of generators; `given` answers for symbols and jets."""
    if element.is_kept:
        return _kept_value(element, given, known, values)
    for generator in element.field.generators_of(element):
        if generator.name not in known:
            _generator(generator, given, known)
    return _quotient(element, element.field.lift(element), element._den, {}, given, known)


def _quotient(
    element: Element, num: fmpq_mpoly, den: Denominator, below: Below, given: Given, known: Known
) -> mpmath.mpf:
    """The value of an element that is num over den and over `below`, term by term."""
    factors, generators = element.field.factors, element.field.generators
    value = _total(polynomials.terms(generators, num), given, known)
    divisors = [(factors[index], exponent) for index, exponent in den]
    for divisor, exponent in [*divisors, *below.values()]:
        factor = _total(polynomials.terms(generators, divisor), given, known)
        if not factor:
            raise SingularPointError(
                f"{element} has no finite value here: its denominator vanishes; "
                "move the point away from the edge of the chart"
            )
        value /= factor**exponent
    return value


def _kept_value(
    element: Element,
    given: Given,
    known: Known,
    value_of: Callable[[Element, Given, Known], mpmath.mpf],
) -> mpmath.mpf:
    """The value of an element that is kept as it was built, part after part."""

    def shared(part: Element) -> mpmath.mpf:
        # The part is kept with its value, so that no other part can get its identity.
        if id(part) not in known:
            known[id(part)] = (part, value_of(part, given, known))
        return known[id(part)][1]

    for node in in_order(element, lambda x: id(x) in known):
        recipe = node._recipe
        total = mpmath.mpf(0)
        for coefficient, *factors in recipe.terms:
            ratio = as_fmpq(coefficient)
            term = mpmath.mpf(int(ratio.p)) / int(ratio.q)
            for factor in factors:
                term *= shared(factor)
            total += term
        if recipe.below:
            if not total:
                raise SingularPointError(
                    "an element has no finite value here: its denominator vanishes; "
                    "move the point away from the edge of the chart"
                )
            total = 1 / total
        known[id(node)] = (node, total)
    return shared(element)


def _total(
    terms: Iterable[tuple[fmpq, Sequence[tuple[Generator, int]]]], given: Given, known: Known
) -> mpmath.mpf:
    """A sum of monomials, (coefficient, powers of generators) each.

    Thousands of them take Arb a tenth of mpmath's time; how far the sum can be trusted is seen by
    another precision (`settled_value`), as of all numbers here, not by its radius.
    """
    with ball_precision(mpmath.mp.prec):
        total: arb | acb = arb(0)
        for coefficient, monomial in terms:
            term: arb | acb = arb(coefficient)
            for generator, exponent in monomial:
                power = known.get((generator.name, exponent))
                if power is None:
                    value = known.get(generator.name)
                    if value is None:
                        value = _generator(generator, given, known)
                    power = _ball(value) ** exponent
                    known[generator.name, exponent] = power
                term = term * power
            total = total + term
    if isinstance(total, acb):
        return mpmath.mpc(_number_of(total.real), _number_of(total.imag))
    return _number_of(total)


def _ball(value: mpmath.mpf) -> arb | acb:
    """A number of mpmath for Arb, exactly."""
    return acb(arb(value.real), arb(value.imag)) if isinstance(value, mpmath.mpc) else arb(value)


def _number_of(ball: arb) -> mpmath.mpf:
    """The midpoint of a ball as a number of mpmath."""
    if not ball.is_finite():
        return mpmath.nan
    mantissa, exponent = ball.mid().man_exp()
    return mpmath.mpf((int(mantissa), int(exponent)))


def _generator(generator: Generator, given: Given, known: Known) -> mpmath.mpf:
    """The value of one generator, computed once per point after those that it is made of."""
    for part in inside_out(generator, made_of, lambda inner: inner.name in known):
        known[part.name] = _computed(part, given, known)
    return known[generator.name]


def arguments(generator: Generator) -> tuple[Element, ...]:
    """The elements of which a generator is a function."""
    kind, argument = generator.kind, generator.argument
    if kind in ("cos", "sin", "cosh", "sinh", "chebyshev"):
        return (argument[0],)
    if kind in ("exp", "log"):
        return (argument,)
    if kind == "primitive":
        return argument[2]
    if kind == "opaque" and type(generator.shown).__name__ in VALUES:
        return argument
    return () if generator.tail is None else (generator.tail,)


def made_of(generator: Generator) -> list[Generator]:
    """The generators on whose values a generator depends."""
    made_of: list[Generator] = []
    for part in arguments(generator):
        made_of += part.field.generators_of(part)
    return made_of


def _computed(generator: Generator, given: Given, known: Known) -> mpmath.mpf:
    """The value of one generator from the values of its arguments."""
    kind = generator.kind
    if kind in ("symbol", "jet"):
        return given(generator)
    if kind == "imaginary":
        return mpmath.mpc(0, 1)
    name = type(generator.shown).__name__
    if kind == "constant" or (kind == "opaque" and name not in VALUES):
        return _by_sympy(generator, given)
    numbers = list(map(values, arguments(generator), repeat(given), repeat(known)))
    if kind == "log" and not numbers[0]:
        raise SingularPointError(f"{generator.shown} has no finite value here")
    if kind == "opaque":
        try:
            return number(name, *numbers)
        except ZeroDivisionError:
            raise SingularPointError(f"{generator.shown} has no finite value here") from None
    if kind == "root":
        return mpmath.root(numbers[0], generator.degree)
    if kind == "primitive":
        kind = type(generator.shown).__name__
    return getattr(mpmath, "cos" if kind == "chebyshev" else kind)(*numbers)


def _by_sympy(generator: Generator, given: Given) -> mpmath.mpf:
    """Opaque functions and constants: sympy's own evaluation."""
    digits = int(mpmath.mp.dps) + 5
    table = {s: given(Generator("symbol", "", s, frozenset((s,)))) for s in generator.depends}
    number = generator.shown.evalf(digits, subs=table)
    if not number.is_number or number.free_symbols:
        raise MissingValueError(
            f"expected a number for {generator.shown}, got none. Give values to its symbols."
        )
    real, imaginary = number.as_real_imag()
    value = mpmath.mpf(str(real))
    return mpmath.mpc(value, mpmath.mpf(str(imaginary))) if imaginary else value


def _given(point: Mapping[Any, Any], generator: Generator) -> mpmath.mpf:
    """The value that the user gave for a symbol or a jet."""
    for key in (generator.shown, str(generator.shown)):
        if key in point:
            return _number(point[key])
    raise MissingValueError(
        f"expected a value for {generator.shown}, got none. Add it to the point: "
        f"{{..., {generator.shown}: number}}."
    )


def _number(value: Any) -> mpmath.mpf:
    """A number of any kind as mpmath takes it, exact ones to the working precision."""
    if isinstance(value, sympy.Basic):
        return mpmath.mpmathify(value.evalf(int(mpmath.mp.dps) + 5))
    if isinstance(value, Rational):
        return mpmath.mpf(int(value.numerator)) / int(value.denominator)
    if type(value).__name__ in ("fmpq", "fmpz"):
        return mpmath.mpf(int(fmpq(value).p)) / int(fmpq(value).q)
    return mpmath.mpmathify(value)

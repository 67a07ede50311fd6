"""Reading: elements, their products and sympy expressions as sums over literals, and as steps.

Sums of cosh and sinh are merged into powers of exp.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb
from operator import attrgetter
from typing import Any

import sympy
import sympy as sp
from flint import fmpq

from geomtorsion.codegen.printers import FUNCTIONS
from geomtorsion.codegen.steps import Builder, Signed
from geomtorsion.codegen.sums import ONE, Sums, Term, content, shared, without
from geomtorsion.errors import ExpressionError, MissingValueError
from geomtorsion.exact.element import Element, Lazy, in_order, inside_out
from geomtorsion.exact.evaluate import arguments
from geomtorsion.exact.form import Monomial, Sum, form
from geomtorsion.exact.generators import Generator
from geomtorsion.exact.lengths import short_of
from geomtorsion.exact.polynomials import as_fmpq
from geomtorsion.support.checks import cut, expression

# A monomial without hyperbolic functions of some argument; powers of exp of that argument.
Merged = tuple[Monomial, tuple[tuple[Generator, int], ...]]


def merged(base: Sum) -> dict[Merged, fmpq] | None:
    """The terms of a sum by exp where they are fewer: cosh(x) - sinh(x) is exp(-x).

    Fewer terms cancel less: at x = 20 that difference has no right digit. None where exp saves
    nothing; powers of exp(x) go by the generator of cosh(x).

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> from geomtorsion.exact.form import form
    >>> x = sympy.Symbol("x", real=True)
    >>> element = Field([x]).read(sympy.cosh(x) - sympy.sinh(x))
    >>> ((base, _),) = form(element).powers
    >>> [(number, power) for (_, ((_, power),)), number in merged(base).items()]
    [(1, -1)]
    """
    even = _cosh_of(base)
    if not even:
        return None
    total: dict[Merged, fmpq] = {}
    for value, monomial in base.terms:
        rest = tuple((g, n) for g, n in monomial if g not in even)
        for powers, number in _by_exp(monomial, even).items():
            key = rest, powers
            total[key] = total.get(key, fmpq(0)) + value * number
    terms = {key: number for key, number in total.items() if number}
    return terms if len(terms) < len(base.terms) else None


def _cosh_of(base: Sum) -> dict[Generator, Generator]:
    """For each sinh(x) and cosh(x) of a sum in which both occur: the generator cosh(x)."""
    generators = {g for _, monomial in base.terms for g, _ in monomial}
    arguments = {g.shown.args[0]: g for g in generators if g.kind == "cosh"}
    pairs = [g for g in generators if g.kind == "sinh" and g.shown.args[0] in arguments]
    even = {g: arguments[g.shown.args[0]] for g in pairs}
    return even | {g: g for g in even.values()}


def _by_exp(
    monomial: Monomial, even: dict[Generator, Generator]
) -> dict[tuple[tuple[Generator, int], ...], fmpq]:
    """The hyperbolic functions of a monomial as {powers of exp: coefficient}."""
    parts: dict[tuple[tuple[Generator, int], ...], fmpq] = {(): fmpq(1)}
    for cosh in dict.fromkeys(even[g] for g, _ in monomial if g in even):
        odd, whole = (
            sum(n for g, n in monomial if even.get(g) is cosh and g.kind == kind)
            for kind in ("sinh", "cosh")
        )
        powers = _powers(whole, odd)
        parts = {
            (*product, (cosh, power)) if power else product: number * factor
            for product, number in parts.items()
            for power, factor in powers.items()
        }
    return parts


def _powers(even: int, odd: int) -> dict[int, fmpq]:
    """cosh(x)**even * sinh(x)**odd as {power of exp(x): coefficient}."""
    coefficients: dict[int, fmpq] = {}
    for i in range(even + 1):
        for j in range(odd + 1):
            power = even + odd - 2 * (i + j)
            number = fmpq((-1) ** j * comb(even, i) * comb(odd, j), 2 ** (even + odd))
            coefficients[power] = coefficients.get(power, fmpq(0)) + number
    return coefficients


def never_negative(tree: sympy.Expr) -> bool:
    """Whether an expression is zero or more wherever it has a value: sums of even powers.

    sympy itself does not decide y**2/x**2, which has no value at x = 0.

    Examples
    --------
    >>> import sympy
    >>> x, y = sympy.symbols("x y", real=True)
    >>> never_negative(x**2 / (2 * y**2) + 1), never_negative(x**2 - y**2)
    (True, False)
    """
    if tree.is_Add or tree.is_Mul:
        return all(never_negative(part) for part in tree.args)
    if tree.is_Pow and tree.exp.is_even and tree.base.is_real:
        return True
    return bool(tree.is_nonnegative)


# A sum of products: pairs (element, names of the arguments that multiply it).
Products = tuple[tuple[Element, tuple[str, ...]], ...]
# Types of outputs of a graph.
Output = Element | Products | sp.Expr | int | Fraction

# Up to this exponent, powers are spelt out, so that factoring sees what they share.
SPELT_OUT = 24
# Generators of a field that are functions of their first argument.
_OF_ANGLES = {"cos": "cos", "sin": "sin", "cosh": "cosh", "sinh": "sinh", "chebyshev": "cos"}
# Functions that are one over another one.
_RECIPROCALS = {
    "cot": "tan", "sec": "cos", "csc": "sin", "coth": "tanh", "sech": "cosh", "csch": "sinh",
}  # fmt: skip
# Functions that are another one of the inverse.
_OF_INVERSES = {"acot": "atan", "acoth": "atanh", "asec": "acos", "acsc": "asin", "asech": "acosh",
                "acsch": "asinh"}  # fmt: skip


@dataclass(frozen=True)
class Meaning:
    """Meaning of a literal that is neither a sum nor a pair of others.

    kind: argument, digits, imaginary, root, power or call.
    detail: position, number, degree, exponent or name of the function.
    sums: numbers of the sums that it is a function of.
    """

    kind: str
    detail: Any
    sums: tuple[int, ...] = ()


class Reader:
    """Reads outputs; equal parts get the same literal.

    is_complex: whether something was read that may take complex values.
    """

    def __init__(self, arguments: Sequence[str], constants: Collection[str]) -> None:
        self.sums: Sums = Sums()
        self.meaning: dict[int, Meaning] = {}
        self.is_complex = False
        self.arguments: dict[str, Term] = {}
        self._known: dict[object, Term] = {}
        # Literal of a root -> degree and radicand.
        self._roots: dict[int, tuple[int, Term]] = {}
        # Literals of exp(-x) where x is never negative: exp(x) overflows above and below a line.
        self._falling: dict[int, None] = {}
        for position, name in enumerate(arguments):
            self.arguments[name] = self._made(
                Meaning("argument", position), constant=name in constants
            )

    def output(self, entry: Output) -> int:
        """The number of the sum that an output is."""
        if isinstance(entry, Element):
            return self.sums.entered([self._element(entry)])
        if isinstance(entry, tuple):
            return self.sums.entered([self._product(element, names) for element, names in entry])
        # A sum is not read as one literal: an output need not be shared.
        terms = sp.Add.make_args(expression(entry))
        for term in terms:
            for part in inside_out(term, attrgetter("args"), self._known.__contains__):
                self._known[part] = self._tree(part)
        return self.sums.entered([self._known[term] for term in terms])

    # Literals and products of them.

    def _made(self, meaning: Meaning, *, constant: bool) -> Term:
        literal = self.sums.fresh(constant=constant)
        self.meaning[literal] = meaning
        return (ONE, (literal,), ()) if constant else (ONE, (), (literal,))

    def _function(self, kind: str, detail: int | str, *inner: Term) -> Term:
        """A function of terms."""
        key = (kind, detail, *inner)
        if key not in self._known:
            sums = tuple(map(self.sums.entered, zip(inner)))
            constant = not any(rest for _, _, rest in inner)
            self._known[key] = self._made(Meaning(kind, detail, sums), constant=constant)
        return self._known[key]

    def _call(self, name: str, *inner: Term) -> Term:
        return self._function("call", name, *inner)

    def _number(self, value: sp.Expr) -> Term:
        """A number that is not rational."""
        key = ("digits", str(value))
        if key not in self._known:
            self._known[key] = self._made(Meaning("digits", value), constant=True)
        return self._known[key]

    def _root(self, degree: int, inner: Term) -> Term:
        term = self._function("root", degree, inner)
        self._roots[(term[1] or term[2])[0]] = (degree, inner)
        return term

    def _power(self, term: Term, exponent: int) -> Term:
        """A term to a whole power."""
        if exponent == 1:
            return term
        if not term[0]:
            # 0**0 is 1, 0**n is 0, and 1/0 is left to the engines: it has no value in any.
            if exponent < 0:
                return self._call("power", term, (Fraction(exponent), (), ()))
            return term if exponent else (ONE, (), ())
        if abs(exponent) > SPELT_OUT:
            number, constants, rest = self._function("power", abs(exponent), term)
            sign = 1 if exponent > 0 else -1
            return number, tuple(sign * c for c in constants), tuple(sign * r for r in rest)
        number, constants, rest = term
        sign = -1 if exponent < 0 else 1
        spelt = tuple(sorted(sign * literal for literal in constants * abs(exponent)))
        spelt_rest = tuple(sorted(sign * literal for literal in rest * abs(exponent)))
        return (ONE if number is ONE else number**exponent, spelt, spelt_rest)

    def _times(self, terms: Iterable[Term]) -> Term:
        """A product of terms; a root as often as its degree gives its radicand."""
        number, constants, rest = ONE, list[int](), list[int]()
        for value, some, others in terms:
            # Most numbers are one, and products of fractions are slow.
            if value is not ONE:
                number = value if number is ONE else number * value
            constants += some
            rest += others
        for entries in (constants, rest) if self._roots else ():
            for literal in sorted(set(map(abs, entries)) & self._roots.keys()):
                degree, inner = self._roots[literal]
                above, below = entries.count(literal), entries.count(-literal)
                for sign, times in ((1, above // degree), (-1, below // degree)):
                    for _ in range(times * degree):
                        entries.remove(sign * literal)
                    if times:
                        value, some, others = self._power(inner, sign * times)
                        number *= value
                        constants += some
                        rest += others
        for literal in self._falling:
            while literal in rest and -literal in rest:
                rest.remove(literal)
                rest.remove(-literal)
        return (number, tuple(sorted(constants)), tuple(sorted(rest)))

    # Elements.

    def _product(self, element: Element, names: tuple[str, ...]) -> Term:
        """An element times arguments, without those that it divides by."""
        number, constants, rest = self._element(element)
        left, below = list[Term](), list(rest)
        for term in (self.arguments[name] for name in names):
            literal = term[2][0] if term[2] else 0
            if -literal in below:
                below.remove(-literal)
            else:
                left.append(term)
        return self._times([(number, constants, tuple(below)), *left])

    def _element(self, element: Element) -> Term:
        if isinstance(element, Lazy):
            # Multiplied out and in factors, less cancels than in the sums as they were built.
            short = short_of(element)
            if short is None:
                return self._kept(element)
            element = short
        written = form(element)
        number = _fraction(written.coefficient)
        is_complex = element.field.is_complex
        parts: list[Term] = [(number, (), ())]
        for base, exponent in written.powers:
            parts.append(self._power(self._base(base, is_complex), exponent))
        return self._times(parts)

    def _kept(self, element: Lazy) -> Term:
        """An element that is not multiplied out: a literal for each sum in it."""
        for node in in_order(element, lambda x: x._recipe in self._known):
            recipe = node._recipe
            terms = [
                self._times(
                    [
                        (_fraction(as_fmpq(c)), (), ()),
                        *(
                            self._known[x._recipe] if isinstance(x, Lazy) else self._element(x)
                            for x in xs
                        ),
                    ]
                )
                for c, *xs in recipe.terms
            ]
            total = self._sum(terms)
            self._known[recipe] = self._power(total, -1) if recipe.below else total
        return self._known[element._recipe]

    def _base(self, base: Generator | Sum, is_complex: bool) -> Term:
        """A generator or a sum, after those that it is made of."""
        for part in inside_out(base, self._made_of, self._known.__contains__):
            self._known[part] = (
                self._generator(part, is_complex)
                if isinstance(part, Generator)
                else self._polynomial(part, is_complex)
            )
        return self._known[base]

    def _made_of(self, base: Generator | Sum) -> list[Generator | Sum]:
        """Generators and sums that are read before a generator or a sum."""
        if isinstance(base, Sum):
            return list(dict.fromkeys(g for _, monomial in base.terms for g, _ in monomial))
        if str(base.shown) in self.arguments:
            return []
        return [
            inner for part in arguments(base) if not part.is_kept for inner, _ in form(part).powers
        ]

    def _polynomial(self, base: Sum, is_complex: bool) -> Term:
        terms = []
        shorter = merged(base) or {(monomial, ()): value for value, monomial in base.terms}
        for (monomial, powers), value in shorter.items():
            parts = [self._power(self._base(g, is_complex), exponent) for g, exponent in monomial]
            for cosh, exponent in powers:
                exp = self._call("exp", self._element(cosh.argument[0]))
                parts.append(self._power(exp, exponent))
            terms.append(self._times([(_fraction(value), (), ()), *parts]))
        return self._sum(terms)

    def _sum(self, terms: list[Term]) -> Term:
        """A sum as one term, with factors that grow like exp(y**2) in front of it."""
        front: Term = (ONE, (), ())
        for literal in self._falling:
            growth = max([rest.count(-literal) for _, _, rest in terms], default=0)
            front = self._times([front, (ONE, (), (-literal,) * growth)])
            terms = [self._times([(ONE, (), (literal,) * growth), term]) for term in terms]
        return self._times([front, self.sums.literal(terms)])

    def _generator(self, generator: Generator, is_complex: bool) -> Term:
        shown = str(generator.shown)
        if shown in self.arguments:
            return self.arguments[shown]
        kind, argument, tail = generator.kind, generator.argument, generator.tail
        if kind == "imaginary" or (is_complex and kind in ("root", "log", "primitive")):
            self.is_complex = True
        if kind in _OF_ANGLES:
            return self._call(_OF_ANGLES[kind], self._element(argument[0]))
        if kind == "exp" and generator.depends and never_negative(generator.shown.args[0]):
            inverse = self._call("exp", self._element(-argument))
            self._falling.update(dict.fromkeys(inverse[2]))
            return self._power(inverse, -1)
        if kind in ("exp", "log"):
            return self._call(kind, self._element(argument))
        if kind == "root" and tail is not None:
            return self._root(generator.degree, self._element(tail))
        if kind == "imaginary":
            return self._function("imaginary", "I")
        return self._by_name(generator)

    def _by_name(self, generator: Generator) -> Term:
        """A primitive, a constant, or another function by its name."""
        kind, argument = generator.kind, generator.argument
        name = type(generator.shown).__name__
        if kind == "primitive" and name in _OF_INVERSES:
            return self._call(_OF_INVERSES[name], self._element(1 / argument[0]))
        if kind == "primitive":
            return self._call(name, *(self._element(part) for part in argument[2]))
        if not generator.depends:
            return self._number(generator.shown)
        if kind == "opaque" and name in FUNCTIONS:
            return self._call(name, *(self._element(part) for part in argument))
        if kind == "opaque":
            raise MissingValueError(
                f"{generator.shown} has no NumPy form here; evaluate it point by point with "
                ".evaluate(point)"
            )
        raise self._unknown(generator.shown)

    def _unknown(self, shown: sp.Expr) -> MissingValueError:
        return MissingValueError(
            f"{shown} is not among the arguments "
            f"({cut(', '.join(self.arguments)) or 'none'}); add it to the symbols"
        )

    # sympy's trees, whose parts have been read before.

    def _tree(self, tree: sp.Basic) -> Term:
        if isinstance(tree, sp.Symbol):
            if tree.name not in self.arguments:
                raise self._unknown(tree)
            return self.arguments[tree.name]
        if isinstance(tree, sp.Rational | sp.Float):
            return (_fraction(sp.Rational(tree)), (), ())
        if isinstance(tree, sp.NumberSymbol):
            return self._number(tree)
        if tree is sp.I:
            self.is_complex: bool = True
            return self._function("imaginary", "I")
        inner = [self._known[part] for part in tree.args]
        if isinstance(tree, sp.Add):
            return self.sums.literal(inner)
        if isinstance(tree, sp.Mul):
            return self._times(inner)
        if isinstance(tree, sp.Pow):
            return self._tree_power(tree.args[0], *inner)
        name = type(tree).__name__
        if name in _RECIPROCALS:
            return self._power(self._call(_RECIPROCALS[name], *inner), -1)
        if name in _OF_INVERSES:
            return self._call(_OF_INVERSES[name], self._power(inner[0], -1))
        if name in FUNCTIONS:
            return self._call(name, *inner)
        raise ExpressionError(f"{tree} has no numerical form here; write it in other functions")

    def _tree_power(self, base: sp.Basic, below: Term, above: Term) -> Term:
        """A power: for whole and half exponents by products and square roots."""
        if base is sp.E:
            return self._call("exp", above)
        number, constants, rest = above
        if constants or rest or number.denominator > 2:
            return self._call("power", below, above)
        root = below if number.denominator == 1 else self._root(2, below)
        return self._times([self._power(root, number.numerator)])


def _fraction(value: fmpq | sp.Rational) -> Fraction:
    """A rational number of FLINT or sympy."""
    return ONE if value == 1 else Fraction(int(value.p), int(value.q))


class Emitter:
    """Writes sums as steps, literals in the order in which they need each other."""

    def __init__(self, reader: Reader) -> None:
        self.meaning: dict[int, Meaning] = reader.meaning
        self.sums: Sums = reader.sums
        self.builder: Builder = Builder()
        self._done: dict[int, Signed] = {}

    def outputs(self, numbers: Sequence[int]) -> list[Signed]:
        """Sign and position of some of the sums."""
        outputs = []
        for number in numbers:
            for needed in self._of_sum(number):
                for literal in inside_out(needed, self._of_literal, self._done.__contains__):
                    self._done[literal] = self._literal(literal)
            outputs.append(self._sum(number))
        return outputs

    def _of_sum(self, number: int) -> list[int]:
        terms = self.sums.sums[number]
        return [abs(inner) for _, constants, rest in terms for inner in (*constants, *rest)]

    def _of_literal(self, literal: int) -> list[int]:
        if literal in self.sums.named:
            return self._of_sum(self.sums.named[literal])
        if literal in self.sums.pairs:
            return [abs(inner) for inner in self.sums.pairs[literal]]
        return [x for number in self.meaning[literal].sums for x in self._of_sum(number)]

    def _literal(self, literal: int) -> Signed:
        if literal in self.sums.named:
            return self._sum(self.sums.named[literal])
        if literal in self.sums.pairs:
            return self._term((Fraction(1), (), self.sums.pairs[literal]))
        meaning, builder = self.meaning[literal], self.builder
        if meaning.kind == "argument":
            constant = literal in self.sums.constant
            return 1, builder.argument(int(meaning.detail), constant=constant)
        if meaning.kind in ("digits", "imaginary"):
            return 1, builder.add(meaning.kind, detail=meaning.detail, constant=True)
        inner = tuple(map(self._unsigned, meaning.sums))
        if meaning.kind == "power":
            return 1, builder.power(inner[0], int(meaning.detail))
        return 1, builder.add(meaning.kind, inner, meaning.detail)

    def _unsigned(self, number: int) -> int:
        """A sum without a sign of its own."""
        sign, place = self._sum(number)
        if sign > 0:
            return place
        step = self.builder.steps[place]
        if step.kind == "number":
            return self.builder.number(-step.detail)
        return self.builder.product(self.builder.number(Fraction(-1)), place)

    def _sum(self, number: int) -> Signed:
        terms = self.sums.sums[number]
        if not terms:
            return 1, self.builder.number(Fraction(0))
        value, constants = terms[0][0], terms[0][1]
        for coefficient, some, _ in terms:
            value, constants = content(value, coefficient), shared(constants, some)
        front = _in_front([(value, constants, ())])
        if len(terms) > 1 and front:
            bare = [(n / value, without(some, constants), rest) for n, some, rest in terms]
            if _in_front(bare) + front <= _in_front(terms):
                sign, place = self.builder.total([self._term(term) for term in bare])
                turn, scale = self._scale(value, constants)
                return sign * turn, self.builder.product(scale, place)
        return self.builder.total([self._term(term) for term in terms])

    def _term(self, term: Term) -> Signed:
        number, constants, rest = term
        sign, above, below = self._split(rest)
        scale = None
        if constants or abs(number) != 1:
            turn, scale = self._scale(number, constants)
        else:
            turn = 1 if number > 0 else -1
        if above is None:
            above, scale = scale, None
        if above is None:
            above = self.builder.number(Fraction(1))
        if below is not None:
            above = self.builder.quotient(above, below)
        return sign * turn, above if scale is None else self.builder.product(scale, above)

    def _scale(self, number: Fraction, constants: tuple[int, ...]) -> Signed:
        """A number times constants."""
        sign, above, below = self._split(constants)
        if number < 0:
            sign, number = -sign, -number
        if above is None:
            above = self.builder.number(number)
        elif number != 1:
            above = self.builder.product(self.builder.number(number), above)
        return sign, above if below is None else self.builder.quotient(above, below)

    def _split(self, literals: tuple[int, ...]) -> tuple[int, int | None, int | None]:
        """Sign, and positions of numerator and denominator, None if absent."""
        sign, above, below = 1, list[int](), list[int]()
        for literal in literals:
            turn, place = self._done[abs(literal)]
            sign *= turn
            (above if literal > 0 else below).append(place)
        return sign, self._chain(above), self._chain(below)

    def _chain(self, places: Sequence[int]) -> int | None:
        """The product of steps, equal ones as powers."""
        if len(places) < 2:
            return places[0] if places else None
        count: dict[int, int] = {}
        for place in sorted(places):
            count[place] = count.get(place, 0) + 1
        result = None
        for place, times in count.items():
            power = self.builder.power(place, times)
            result = power if result is None else self.builder.product(result, power)
        return result


def _in_front(terms: Iterable[Term]) -> int:
    """How many numbers and constants are in front of terms."""
    return sum(len(some) + (abs(number) != 1) for number, some, _ in terms)

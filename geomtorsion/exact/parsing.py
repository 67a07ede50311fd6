"""Parsing: text to sympy by a whitelist; nothing is ever evaluated as code."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, NoReturn

import sympy

from geomtorsion.errors import ArgumentError, ExpressionError
from geomtorsion.exact.names import (
    CONSTANTS,
    DERIVATIVE_NAMES,
    FUNCTIONS,
    NOT_SMOOTH,
    SPECIAL,
    SPECIAL_IF_DECLARED,
    SUBSTITUTION_NAME,
)
from geomtorsion.exact.syntax import Node, parse, too_deep, with_products
from geomtorsion.exact.tokens import Limits, Source, Token, tokens_of
from geomtorsion.support import checks
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.checks import exponent_too_large, near_names, too_large

_NO_NUMBER = (sympy.zoo, sympy.oo, -sympy.oo, sympy.nan)


def parse_expression(
    text: str,
    symbols: Mapping[str, sympy.Symbol],
    functions: Mapping[str, Any] | None = None,
    *,
    where: str = "expression",
    limits: Limits | None = None,
    decimals: bool = False,
    unknown: str = "",
    free: bool = False,
    undeclared: bool = False,
) -> sympy.Expr:
    """Read a sympy expression from text of any source, without running code.

    Numbers are exact; ``2 r sin(theta)`` is a product; ``**`` and ``^`` are powers; ``pi``, ``E``
    and ``I`` are the constants unless ``symbols`` redefines them; ``diff(f(r), r, 2)`` is a
    derivative of an unknown function, also in sympy's form: ``Derivative(f(r), (r, 2))`` and
    ``Subs(Derivative(f(x), x), x, 2*r)``.

    Parameters
    ----------
    text
        The expression, such as ``"sqrt(1 - 2*M/r)"``.
    symbols
        Name -> sympy Symbol, for every name that may occur.
    functions
        Name -> sympy function class (``f``, then written ``f(r)``) or applied function (``a`` then
        means ``a(t)``). None: an unknown name that is called is taken for an unknown function.
    where
        How errors call this expression, for instance ``"coframe[0, 1]"``.
    limits
        What the expression may cost; the defaults suit everything written by a person.
    decimals
        Whether decimal numbers are read, as exact fractions: 0.1 is 1/10. Otherwise they are
        refused.
    unknown
        What errors advise about an unknown name ({name} in the text); by default to declare it
        as a parameter.
    free
        Whether an unknown name is a new symbol instead of an error.
    undeclared
        Whether an unknown name that is called is an unknown function even if ``functions`` is
        given.

    Returns
    -------
    A sympy expression, as sympy builds it, not simplified.

    Raises
    ------
    ExpressionError
        The text is not an expression, uses an undeclared name or a decimal number, or is code.
    LimitError
        The text, its nesting, an exponent or a number is larger than ``limits`` allow.

    Examples
    --------
    >>> r, M = sympy.symbols("r M", positive=True)
    >>> parse_expression("sqrt(1 - 2*M/r)", {"r": r, "M": M})
    sqrt(-2*M/r + 1)
    >>> parse_expression("0.1*r", {"r": r}, where="g[0]")
    Traceback (most recent call last):
    geomtorsion.errors.ExpressionError: g[0]: 0.1 is a decimal number; exact work needs a rational
        0.1*r
        ^^^
    Write 1/10 if that is what you mean, or a named parameter.
    """
    kind, remedy = "an expression as text", 'Write it in quotes, for instance "r*sin(theta)".'
    checks.text(text, where, ExpressionError, longest=sys.maxsize, expected=kind, remedy=remedy)
    limits = Limits() if limits is None else checks.instance(limits, Limits, "limits")
    for name, symbol in checks.table(symbols, "symbols").items():
        if not isinstance(name, str) or not isinstance(symbol, sympy.Expr):
            raise ArgumentError(
                f"symbols: expected names with symbols, got {checks.shown(name)}: "
                f"{checks.shown(symbol)}."
            )
    for name, function in checks.table(functions, "functions").items():
        if not isinstance(name, str) or not isinstance(
            function, sympy.Expr | sympy.core.function.FunctionClass
        ):
            raise ArgumentError(
                f"functions: expected names with functions of sympy, got {checks.shown(name)}: "
                f"{checks.shown(function)}."
            )
    source = Source(text, where)
    tokens = tokens_of(source, {*symbols, *(functions or ())}, limits, decimals=decimals)
    nodes = with_products(source, tokens)
    return read_tokens(
        source, nodes, symbols, functions, limits, unknown, free=free, undeclared=undeclared
    )


def read_tokens(
    source: Source,
    tokens: Sequence[Token],
    symbols: Mapping[str, sympy.Symbol],
    functions: Mapping[str, Any] | None,
    limits: Limits,
    unknown: str = "",
    *,
    free: bool = False,
    undeclared: bool = False,
) -> sympy.Expr:
    """Read an expression from the tokens of any notation; see `parse_expression`."""
    try:
        closed = functions is not None and not undeclared
        reader = _Reader(source, symbols, functions or {}, limits, unknown, free, closed)
        return reader.read(parse(source, tokens, limits))
    except (RecursionError, MemoryError):
        raise source.limit(0, 1, too_deep(limits), "Write it flatter.") from None


@dataclass
class _Reader:
    """Turns nodes into sympy; long sums and products are walked, not recursed."""

    source: Source
    symbols: Mapping[str, sympy.Symbol]
    functions: Mapping[str, Any]
    limits: Limits
    unknown: str = ""
    free: bool = False
    closed: bool = False
    denominator: int = field(default=1)

    def read(self, node: Node) -> sympy.Expr:
        check_limits()
        if node.kind == "number":
            number = Fraction(node.text)
            return sympy.Rational(number.numerator, number.denominator)
        if node.kind == "name":
            return self._symbol(node)
        if node.kind == "call":
            return self._call(node)
        if node.kind == "sum":
            return self._sum(node)
        if node.kind == "product":
            coefficient, rest = self._product(node)
            return coefficient * rest
        if node.kind == "group":
            self._fail(node, "a comma is allowed only between the arguments of a function")
        base, exponent = node.parts
        return self._power(node, self.read(base), self.read(exponent))

    def _sum(self, node: Node) -> sympy.Expr:
        # Coefficients of equal parts are added up first: that is most of the work in a long sum.
        collected: dict[sympy.Expr, sympy.Expr] = {}
        for part, sign in _flat(node):
            coefficient, rest = self._product(part)
            collected[rest] = collected.get(rest, 0) + sign * coefficient
        return sympy.Add(*(coefficient * rest for rest, coefficient in collected.items()))

    def _product(self, node: Node) -> tuple[sympy.Expr, sympy.Expr]:
        """Rational coefficient and the rest of a product."""
        coefficient, factors, bits = sympy.Integer(1), [], 0
        for part, power in _flat(node, "product"):
            factor = self.read(part)
            if power < 0:
                if factor == 0:
                    self._fail(part, "division by zero")
                factor = 1 / factor
            bits += _bits(factor)
            if bits > self._most_bits:
                self._too_long(part)
            if factor.is_Rational:
                coefficient *= factor
            else:
                factors.append(factor)
        self._note(node, coefficient)
        return coefficient, sympy.Mul(*factors) if len(factors) != 1 else factors[0]

    def _power(self, node: Node, base: Any, exponent: Any) -> Any:
        if base == 0 and exponent.is_negative:
            self._fail(node, "division by zero")
        if exponent.is_Rational:
            if abs(exponent) > self.limits.exponent or exponent.q > self.limits.exponent:
                self._too_high(node, exponent)
            if _bits(base) * abs(exponent) > self._most_bits:
                self._too_long(node)
        self._bound(node, exponent_too_large(exponent, self.limits.argument))
        result = base**exponent
        for factor in sympy.Mul.make_args(result):
            power = factor.as_base_exp()[1]
            if power.is_Rational and abs(power) > self.limits.exponent:
                self._too_high(node, power)
        self._note(node, result)
        return result

    def _note(self, node: Node, value: Any) -> None:
        # A sum of fractions grows as the common denominator does, however short its terms are.
        coefficient = value.as_coeff_Mul()[0]
        if coefficient.is_Rational and coefficient.q != 1:
            self.denominator = math.lcm(self.denominator, int(coefficient.q))
            if self.denominator.bit_length() > self._most_bits:
                self._too_long(node)

    @property
    def _most_bits(self) -> float:
        return self.limits.digits / math.log10(2)

    def _symbol(self, node: Node) -> Any:
        name = node.text
        if name in self.symbols:
            return self.symbols[name]
        if name in self.functions:
            declared = self.functions[name]
            if isinstance(declared, sympy.Expr):
                return declared
            self._fail(node, f"{name} is a function", f"Write its arguments: {name}(...).")
        if name in CONSTANTS:
            return CONSTANTS[name]
        if name in FUNCTIONS:
            self._fail(node, f"{name} is a function", f"Write its argument: {name}(...).")
        if self.free:
            return sympy.Symbol(name)
        # I1 is near to I by its letters only: a constant of one letter is meant where all agree.
        constants = [one for one in CONSTANTS if len(one) > 1 or one.lower() == name.lower()]
        names = [*self.symbols, *self.functions, *constants]
        advice = self.unknown or "Otherwise declare {name} as a parameter."
        remedy = advice.replace("{name}", name)
        near = near_names(name, names)
        remedy = f"Did you mean {near}? {remedy}" if near else remedy.removeprefix("Otherwise ")
        reason = f"{name} is neither a coordinate nor a declared parameter"
        self._fail(node, reason, remedy[0].upper() + remedy[1:])

    def _call(self, node: Node) -> Any:
        name = node.text
        # For a mistake in the name itself, the message shows the name without its arguments.
        called = replace(node, end=node.start + len(name))
        if name in DERIVATIVE_NAMES and name not in self.functions:
            return self._derivative(node, name)
        if name == SUBSTITUTION_NAME and name not in self.functions:
            return self._at_a_place(node)
        if name in self.symbols:
            remedy = f"For a product write {name}*(...)."
            self._fail(called, f"{name} is a symbol, not a function", remedy)
        arguments = [self.read(argument) for argument in node.parts]
        if name in self.functions:
            return self._declared(node, name, self.functions[name], arguments)
        entry = FUNCTIONS.get(name) or SPECIAL.get(name)
        if entry is None and self.closed:
            entry = SPECIAL_IF_DECLARED.get(name)
        if entry is not None:
            function, counts = entry
            self._count(node, name, counts)
            self._bound(node, too_large(name, arguments, self.limits.argument))
            value = function(*arguments)
            if value.has(*_NO_NUMBER):
                self._fail(node, f"{name} has no finite value here")
            self._note(node, value)
            return value
        if name in NOT_SMOOTH:
            self._fail(called, f"{name} is not smooth", NOT_SMOOTH[name])
        near = near_names(name, [*self.functions, *FUNCTIONS])
        if self.closed or near or not arguments:
            hint = f"Did you mean {near}? Otherwise d" if near else "D"
            remedy = f"{hint}eclare it as an unknown function with its arguments, as in {name}(r)."
            self._fail(called, f"{name} is not a function that is known here", remedy)
        return sympy.Function(name)(*arguments)

    def _declared(self, node: Node, name: str, declared: Any, arguments: list[Any]) -> Any:
        if isinstance(declared, sympy.Expr):
            self._count(node, name, (len(declared.args),))
            return declared.func(*arguments)
        if not arguments:
            self._fail(node, f"{name} has no argument", f"Write what it depends on: {name}(r).")
        if not isinstance(declared, sympy.core.function.UndefinedFunction):
            self._bound(node, too_large(name, arguments, self.limits.argument))
            if len(arguments) not in declared.nargs:
                self._fail(node, f"{name} does not take {len(arguments)} arguments")
        return declared(*arguments)

    def _derivative(self, node: Node, name: str) -> Any:
        usage = f"Write {name}(f(r), r) or {name}(f(r), r, 2)."
        if len(node.parts) < 2:
            self._fail(node, f"{name} needs a function and a symbol", usage)
        parts = [part for argument in node.parts[1:] for part in _parts(argument)]
        target, *wrt = [self.read(argument) for argument in (node.parts[0], *parts)]
        if not isinstance(target, sympy.core.function.AppliedUndef | sympy.Derivative):
            self._fail(node.parts[0], "only unknown functions are differentiated here", usage)
        variables: list[Any] = []
        for item in wrt:
            if item.is_Integer and variables and 0 < item <= self.limits.depth:
                variables += [variables[-1]] * (int(item) - 1)
            elif item.is_Symbol:
                variables.append(item)
            else:
                self._fail(node, f"{item} is not a symbol to differentiate by", usage)
        return target.diff(*variables)

    def _at_a_place(self, node: Node) -> Any:
        """A derivative of an unknown function whose arguments are not single symbols."""
        usage = "Write Subs(Derivative(f(x), x), x, 2*r)."
        if len(node.parts) != 3:
            self._fail(node, "Subs needs a derivative, its symbols and their places", usage)
        slots, places = _parts(node.parts[1]), _parts(node.parts[2])
        symbols = {slot.text: sympy.Symbol(slot.text) for slot in slots if slot.kind == "name"}
        if not symbols or not len(symbols) == len(slots) == len(places):
            self._fail(node, "Subs needs one place for each of its symbols", usage)
        inner = replace(self, symbols={**self.symbols, **symbols}).read(node.parts[0])
        if not isinstance(inner, sympy.Derivative):
            self._fail(node.parts[0], "only derivatives of unknown functions have a place", usage)
        return sympy.Subs(inner, tuple(symbols.values()), tuple(map(self.read, places)))

    def _count(self, node: Node, name: str, counts: tuple[int, ...]) -> None:
        """Fail unless the number of arguments is one of counts."""
        if len(node.parts) not in counts:
            needed = " or ".join(str(count) for count in counts)
            reason = (
                f"{name} takes {needed} argument{'s' * (counts != (1,))}, not {len(node.parts)}"
            )
            self._fail(node, reason)

    def _fail(self, node: Node, reason: str, remedy: str = "") -> NoReturn:
        raise self.source.error(node.start, node.end, reason, remedy)

    def _bound(self, node: Node, reason: str) -> None:
        if reason:
            raise self.source.limit(node.start, node.end, reason, "Write it shorter.")

    def _too_long(self, node: Node) -> NoReturn:
        reason = f"a number here has more digits than the limit of {self.limits.digits:,}"
        raise self.source.limit(node.start, node.end, reason, "Replace it by a parameter.")

    def _too_high(self, node: Node, exponent: Any) -> NoReturn:
        shown = str(exponent) if _bits(exponent) < 64 else "a number of many digits"
        reason = f"the exponent is {shown}; the limit is {self.limits.exponent}"
        remedy = "Replace it by a parameter, as in r**n."
        raise self.source.limit(node.start, node.end, reason, remedy)


def _parts(node: Node) -> tuple[Node, ...]:
    """The parts of a bracket with commas; any other part by itself."""
    return node.parts if node.kind == "group" else (node,)


def _flat(node: Node, kind: str = "sum") -> Iterator[tuple[Node, int]]:
    """Terms of a sum, or factors of a product, in brackets too, each with its sign."""
    waiting = [(node, 1)]
    while waiting:
        part, sign = waiting.pop()
        if part.kind == kind:
            inner = zip(part.parts, part.signs, strict=True)
            waiting += [(x, sign * own) for x, own in inner][::-1]
        else:
            yield part, sign


def _bits(value: Any) -> int:
    """Length in bits of the rational coefficient of an expression, 0 for one."""
    coefficient = value.as_coeff_Mul()[0]
    if not coefficient.is_Rational or coefficient in (1, -1):
        return 0
    return max(int(coefficient.p).bit_length(), int(coefficient.q).bit_length())

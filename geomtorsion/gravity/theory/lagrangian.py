"""Lagrangian: an expression in the names of invariants, read, differentiated and evaluated."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NoReturn

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, parse_expression
from geomtorsion.exact import names as words
from geomtorsion.geometry import Frame, Tensor, at_home
from geomtorsion.geometry.numeric.numeric_field import NumericField
from geomtorsion.gravity.theory.indexed import named_contractions
from geomtorsion.gravity.theory.invariants import INVARIANTS, Invariant
from geomtorsion.gravity.theory.vocabulary import MATTER, WAVE_OPERATORS, Vocabulary
from geomtorsion.support import checks


class Names(Mapping[str, sp.Symbol]):
    """The symbols of invariants and matter fields for Lagrangians written in sympy.

    Examples
    --------
    >>> names["T"] + names["T"] ** 2
    T**2 + T
    >>> names["Rbar"], "tensor2" in names
    (Rbar, True)
    """

    _known = (*INVARIANTS, *(f"{name}bar" for name in INVARIANTS), *MATTER)

    def __getitem__(self, name: str) -> sp.Symbol:
        return sp.Symbol(checks.known_name(name, self._known, "name", GravityError))

    def __iter__(self) -> Iterator[str]:
        return iter(self._known)

    def __len__(self) -> int:
        return len(self._known)

    def __contains__(self, name: object) -> bool:
        return name in self._known

    def __repr__(self) -> str:
        return f"names of invariants: {', '.join(self._known)}"


names = Names()

_NAME = re.compile(r"[^\W\d]\w*")
# Names in calls that are not unknown functions.
_CALLED = {*words.FUNCTIONS, *words.SPECIAL, *words.NOT_SMOOTH, *words.DERIVATIVE_NAMES}
_CALLED.add(words.SUBSTITUTION_NAME)


@dataclass(frozen=True)
class Lagrangian:
    """A theory: its Lagrangian and the connections for which it is meant.

    expression: text or sympy expression in `names`, parameters and opaque functions. Text may have
        contractions, "R/2 + c*R_ab R^ab".
    geometry: "any", "teleparallel", "symmetric teleparallel", "metric", "riemannian", or
        "metric-affine", whose connection is varied freely also where it is metric.
    name: of the theory, for messages.
    constants: names of constants used elsewhere than as factors, such as exponents, "n v" or a
        tuple.
    invariants: user-defined invariants, from `gravity.invariant`.

    Examples
    --------
    >>> Lagrangian("T + c*T**2", "teleparallel", "quadratic")
    quadratic: L = T + c*T**2
    """

    expression: str | sp.Expr
    geometry: str = "any"
    name: str = "Lagrangian"
    constants: str | tuple[str, ...] = ()
    invariants: tuple[Invariant, ...] = ()

    def __repr__(self) -> str:
        own = "" if self.name == Lagrangian.name else f"{self.name}: "
        return f"{own}{self.written}"

    @property
    def written(self) -> str:
        """L, and the invariants that it defines."""
        return ", ".join([f"L = {self.expression}", *map(str, self.invariants)])


def known_as(text: object) -> Lagrangian:
    """A Lagrangian from text, a sympy expression, a number or a theory."""
    if isinstance(text, Lagrangian):
        if not isinstance(text.expression, str):
            return text
        expression, own = named_contractions(text.expression)
        return replace(text, expression=expression, invariants=(*text.invariants, *own))
    if isinstance(text, str):
        return known_as(Lagrangian(text))
    wanted = (
        "text such as 'T + c*T**2', a sympy expression in gravity.names, or a theory such as "
        "gravity.tegr"
    )
    return Lagrangian(checks.expression(text, "lagrangian", GravityError, expected=wanted))


@dataclass(frozen=True, eq=False)
class Reading:
    """A Lagrangian read for one frame.

    expression: in symbols of invariants, of the frame, and of parameters.
    symbols: symbol -> name of the invariant, for those that occur.
    constants: names of the parameters that the Lagrangian introduces.
    """

    frame: Frame
    expression: sp.Expr
    symbols: dict[sp.Symbol, str]
    constants: tuple[str, ...] = ()
    values: dict[sp.Symbol, Element] = field(default_factory=dict)

    def element(self, expression: sp.Expr) -> Element:
        """The value of an expression: sums, products and powers are never written out."""
        exact = self.frame.field
        if expression in self.values:
            return self.values[expression]  # type: ignore[index]
        if not expression.free_symbols & self.values.keys():
            (read,) = self.frame.read([("lagrangian", expression)])
            return read
        if expression.is_Add:
            return exact.sum([(1, self.element(argument)) for argument in expression.args])
        if expression.is_Mul:
            product = exact.one
            for argument in expression.args:
                product = product * self.element(argument)
            return product
        if expression.is_Pow and expression.exp.is_Integer:
            base = self.element(expression.base)
            if expression.exp.is_negative and base.is_zero:
                self._refuse(expression, [base.sympy])
            return base ** int(expression.exp)
        if isinstance(expression, AppliedUndef | sp.Derivative | sp.Subs):
            return self._unknown(expression)
        if isinstance(exact, NumericField):
            return exact.function(expression, [self.element(x) for x in expression.args])
        values = [self.element(argument).sympy for argument in expression.args]
        value = expression.func(*values)
        if value.has(sp.zoo, sp.nan, sp.oo):
            self._refuse(expression, values)
        (read,) = self.frame.read([("lagrangian", value)])
        return read

    @staticmethod
    def _refuse(expression: sp.Expr, values: Sequence[sp.Expr]) -> NoReturn:
        """Refuse a function without a value at the values of its arguments."""
        places = [
            f"{argument} = {checks.cut(str(value))}"
            for argument, value in zip(expression.args, values, strict=False)
            if argument.free_symbols
        ]
        raise GravityError(
            f"lagrangian: expected functions with a value on this connection, got {expression} at "
            f"{', '.join(places)}. It occurs in the Lagrangian or in its derivatives, which the "
            "field equations contain. Give another Lagrangian or connection."
        )

    def _unknown(self, expression: AppliedUndef | sp.Derivative | sp.Subs) -> Element:
        """An unknown function, or a partial derivative of it, at the values of its arguments."""
        places: dict[sp.Expr, sp.Expr] = {}
        if isinstance(expression, sp.Subs):
            places = dict(zip(expression.variables, expression.point, strict=True))
            expression = expression.expr
        counts: dict[sp.Expr, int] = {}
        if isinstance(expression, sp.Derivative):
            counts = {x: int(n) for x, n in expression.variable_count}
            expression = expression.expr
        orders = tuple(counts.get(x, 0) for x in expression.args)
        values = tuple(self.element(x.xreplace(places)) for x in expression.args)
        return self.frame.field.jet(expression.func, orders, values)


def read(given: Lagrangian, vocabulary: Vocabulary) -> Reading:
    """A Lagrangian in the names of a vocabulary.

    Raises
    ------
    GravityError
        A name is unknown, has two meanings, or a function has no invariant in it.
    """
    frame, names = vocabulary.frame, vocabulary.names
    expression = given.expression
    if isinstance(expression, str):
        if not expression.strip():
            raise GravityError(
                "lagrangian: expected a formula in invariants, got an empty text. Write one such "
                "as T + c*T**2."
            )
        expression = _parsed(expression, vocabulary)
    changed: dict[sp.Symbol, sp.Symbol] = {}
    for symbol in sorted(expression.free_symbols, key=str):
        name = symbol.name
        # A symbol with assumptions is not the invariant of the same name.
        if name in names and symbol in frame.field.symbols and symbol != sp.Symbol(name):
            continue
        vocabulary.check_name(name)
        if name in names:
            changed[symbol] = sp.Symbol(name)
        elif name in vocabulary.symbols:
            changed[symbol] = vocabulary.symbols[name]
    expression = vocabulary.with_fields(expression.xreplace(changed))
    meanings = {
        symbol: symbol.name
        for symbol in sorted(expression.free_symbols, key=str)
        if symbol.name in names and symbol == sp.Symbol(symbol.name)
    }
    _check_functions(expression, meanings, vocabulary)
    constants = vocabulary.constants(expression, meanings.keys())
    return Reading(frame, expression, meanings, constants)


def scalar_of(
    frame: Frame, value: object, where: str, scalars: Mapping[str, sp.Expr] | None = None
) -> Element:
    """An exact element of a number, an expression, text or a tensor of rank 0.

    scalars: values of further names in a text.
    """
    if isinstance(value, Tensor) and not value.slots:
        home = at_home(frame, value)
        if home is not None:
            return home.element()
    applied = dict(scalars or {}) | {
        generator.argument[0].__name__: generator.shown
        for generator in frame.field.generators
        if generator.kind == "jet"
        and isinstance(generator.shown, AppliedUndef)
        and all(place.is_Symbol for place in generator.shown.args)
    }
    expression = checks.expression(
        value,
        where,
        GravityError,
        read=lambda text: _parsed(text, Vocabulary(frame), where, applied),
    )
    (element,) = frame.read([(where, expression)])
    return element


_WAVES = r"(?:\b[Bb]ox\s+|\u25a1\s*)"


def _parsed(
    text: str,
    vocabulary: Vocabulary,
    where: str = "lagrangian",
    applied: Mapping[str, sp.Expr] | None = None,
) -> sp.Expr:
    """Text by the reader of this package; names that are new become parameters.

    applied: functions that may be written without their arguments.
    """
    # Many write the operator of waves without brackets.
    for name in vocabulary.boxes:
        text = re.sub(rf"{_WAVES}{re.escape(name)}\b", f"Box({name})", text)
        text = re.sub(rf"\u25a1(?=\s*\(\s*{re.escape(name)}\b)", "Box", text)
    functions: dict[str, sp.Basic] = dict(applied or {})
    symbols = {}
    names, own = vocabulary.names, vocabulary.symbols
    fields = vocabulary.called
    for word in dict.fromkeys(_NAME.findall(text)):
        is_called = re.search(rf"\b{word}\s*\(", text)
        if is_called and (word in fields or word not in names or word.lower() in WAVE_OPERATORS):
            if word in fields or word not in _CALLED:
                functions[word] = sp.Function(word)
            if word in names and re.search(rf"\b{word}\b(?!\s*\()", text):
                raise GravityError(
                    f"lagrangian: expected one way to write {word}, got {word} and {word}(...). "
                    f"Write {word}."
                )
        elif word in functions:
            continue
        elif word in own and word not in names:
            vocabulary.check_name(word)
            symbols[word] = own[word]
        elif word in names or word in vocabulary.declared or word not in words.CONSTANTS:
            vocabulary.check_name(word)
            symbols[word] = sp.Symbol(word)
    return parse_expression(text, symbols, functions, where=where)


def _check_functions(
    expression: sp.Expr, invariants: Collection[sp.Symbol], vocabulary: Vocabulary
) -> None:
    """Refuse a function without a varied argument, and anything that is not a scalar."""
    for part in sp.preorder_traversal(expression):
        if isinstance(part, sp.Abs):
            raise GravityError(
                f"lagrangian: expected a smooth expression, got {part}, which is not smooth. Write "
                f"{part.args[0]} or -({part.args[0]}), whichever is positive in your domain."
            )
        if isinstance(part, sp.Indexed | sp.IndexedBase | sp.Integral | sp.MatrixBase | sp.Idx):
            raise GravityError(
                f"lagrangian: expected a scalar expression in invariants, got {part}. Write "
                "contractions by their names, listed in gravity.names."
            )
        if isinstance(part, AppliedUndef):
            symbols = part.free_symbols
            if not any(x in invariants or vocabulary.is_own(x.name) for x in symbols):
                raise GravityError(
                    f"lagrangian: expected invariants as arguments of {part.func}, got {part}. "
                    "Write f(T) or f(T, Rbar)."
                )
            if not symbols.isdisjoint(invariants):
                vocabulary.check_function(part.func.__name__)

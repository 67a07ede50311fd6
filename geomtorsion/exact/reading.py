"""Reading: sympy expressions into elements, after all of their angles and exponents were found.

Entries are checked first: parts that can be read, in symbols of one meaning.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable
from fractions import Fraction
from itertools import islice
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import sympy
from flint import fmpq
from sympy.core.function import AppliedUndef

from geomtorsion.errors import CoordinateError, ExpressionError, GeomtorsionError, LimitError
from geomtorsion.exact.arguments import Angles, Exponents
from geomtorsion.exact.element import inside_out
from geomtorsion.exact.functions import jet, opaque, smooth_form
from geomtorsion.exact.generators import Branch, Generator
from geomtorsion.exact.kept import stays_kept
from geomtorsion.exact.limits import check_exponent, check_size
from geomtorsion.exact.points import leave_point
from geomtorsion.exact.polynomials import split
from geomtorsion.exact.primitives import INVERSE_FUNCTIONS, Primitives
from geomtorsion.exact.special import meaning, undone
from geomtorsion.support.checks import ErrorClass, cut, plain, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower

    Exprs = list[sympy.Basic]


_NOT_SMOOTH = (
    "sign", "floor", "ceiling", "frac", "Piecewise", "Max", "Min", "Heaviside",
    "DiracDelta", "re", "im", "arg", "conjugate", "Mod", "KroneckerDelta", "SingularityFunction",
)  # fmt: skip
_OPERATIONS = frozenset((sympy.Add, sympy.Mul, sympy.Pow))
_INFINITE = frozenset((sympy.oo, -sympy.oo, sympy.zoo, sympy.nan))
_REMEDIES = {
    "Piecewise": "give the expression of one piece at a time; gt.ODE.of takes all pieces of a rate",
}


def checked(where: str, value: Any, declared: Iterable[sympy.Symbol] | None = None) -> sympy.Expr:
    """A sympy expression that consists of readable parts only.

    declared: symbols that it is written in, where it has others of the same names.

    Raises
    ------
    ExpressionError
        a part is a float, not smooth, infinite or no scalar; the message names it.
    CoordinateError
        two symbols share a name that is not declared.
    """
    if isinstance(value, bool) or value is None:
        raise ExpressionError(f"{where}: {shown(value)} is not an expression")
    if isinstance(value, Fraction):
        return sympy.Rational(value.numerator, value.denominator)
    if isinstance(value, int):
        return sympy.Integer(value)
    if isinstance(value, complex):
        raise ExpressionError(
            f"{where}: {value} is a complex floating-point number; write it exactly with sympy.I, "
            "and declare the frame with complex=True"
        )
    if isinstance(value, float):
        value = sympy.Float(value)
    if isinstance(value, str):
        raise ExpressionError(
            f"{where}: {shown(value)} is text; read text with geomtorsion.parse_expression first"
        )
    inner = plain(value)
    if inner is not value:
        return checked(where, inner, declared)
    if not isinstance(value, sympy.Expr):
        kind = "a relation" if isinstance(value, sympy.logic.boolalg.Boolean) else "no scalar"
        raise ExpressionError(f"{where}: {cut(str(value))} is {kind}; give one sympy expression")
    seen: set[sympy.Basic] = set()
    stack: list[sympy.Basic] = [value]
    while stack:
        part = stack.pop()
        if part in seen:
            continue
        seen.add(part)
        reason = _reason(part)
        if reason:
            of = "" if part == value else f" in {cut(str(value), 60)}"
            raise ExpressionError(f"{where}: {cut(str(part), 60)}{of} {reason}")
        stack.extend(part.args)
    if declared is None or not {part for part in seen if part.is_Symbol}.difference(declared):
        return value
    # Some of these may be bound, as in a derivative at a place.
    return value.xreplace(counted_as(value.free_symbols.difference(declared), declared))


def _reason(part: sympy.Basic) -> str:
    """Why a part cannot be read, or nothing."""
    if part.is_Rational or type(part) in _OPERATIONS:
        return ""
    if part.is_Float:
        exact = sympy.nsimplify(part, rational=True)
        return f"is a floating-point number; write it exactly, for example {exact}"
    if part in _INFINITE:
        return "is not a finite number, such as the result of 1/0; give a finite expression"
    if isinstance(part, sympy.Integral | sympy.Sum | sympy.Product | sympy.Limit):
        return "is unevaluated; work it out, or use an unknown function with its derivative"
    if getattr(part, "is_Matrix", False) or isinstance(part, sympy.MatrixExpr):
        return "is a matrix; give its entries one by one"
    name = type(part).__name__
    if name in _NOT_SMOOTH:
        remedy = _REMEDIES.get(name, "replace it with a smooth expression valid in your domain")
        return f"is not smooth; {remedy}"
    if isinstance(part, sympy.Symbol) and part.is_commutative is False:
        return "does not commute; coordinates and parameters are numbers"
    return ""


def counted_as(
    symbols: Iterable[sympy.Basic],
    declared: Iterable[sympy.Symbol] = (),
    error: ErrorClass = CoordinateError,
) -> dict[sympy.Basic, sympy.Symbol]:
    """Which declared symbol each other one of its name counts as: {twin: declared symbol}.

    In one frame a name has one meaning, whatever its assumptions are. Two twins without a
    declaration are ambiguous and refused.

    Raises
    ------
    CoordinateError
        Two symbols share a name that is not declared, or is declared twice.

    Examples
    --------
    >>> r, twin = sympy.Symbol("r"), sympy.Symbol("r", positive=True)
    >>> counted_as([r, twin], declared=[r]) == {twin: r}
    True
    >>> counted_as([r, twin])
    Traceback (most recent call last):
    geomtorsion.errors.CoordinateError: two different symbols are called r: Symbol('r') and \
Symbol('r', positive=True). Create the symbol once and use it everywhere.
    """
    by_name = _by_name(declared, error)
    twins: dict[sympy.Basic, sympy.Symbol] = {}
    others = []
    for symbol in symbols:
        if not isinstance(symbol, sympy.Symbol):
            continue
        own = by_name.get(symbol.name)
        if own is None:
            others.append(symbol)
        elif own != symbol:
            twins[symbol] = own
    _by_name(others, error)
    return twins


def _by_name(symbols: Iterable[sympy.Symbol], error: ErrorClass) -> dict[str, sympy.Symbol]:
    """Symbols by their names, each of which belongs to one only."""
    distinct = set(symbols)
    by_name = {symbol.name: symbol for symbol in distinct}
    if len(by_name) == len(distinct):
        return by_name
    by_name = {}
    # In an order that does not depend on the addresses of symbols.
    for symbol in sorted(distinct, key=sympy.srepr):
        twin = by_name.setdefault(symbol.name, symbol)
        if twin != symbol:
            both = " and ".join(cut(sympy.srepr(one)) for one in (twin, symbol))
            raise error(
                f"two different symbols are called {cut(symbol.name)}: {both}. "
                "Create the symbol once and use it everywhere."
            )
    return by_name


# The value of a function from what reads its argument, and the argument.
Rule = Callable[["Reader", "Element"], "Element"]


def _circular(form: Callable[[Element, Element], Element]) -> Rule:
    """A function of cos and sin of its argument."""
    return lambda reader, argument: form(*reader.cos_sin(argument))


def _hyperbolic(form: Callable[[Element, Element], Element]) -> Rule:
    """A function of cosh and sinh of its argument."""
    return lambda reader, argument: form(*reader.cosh_sinh(argument))


CIRCULAR: dict[str, Rule] = {
    "cos": _circular(lambda c, s: c),
    "sin": _circular(lambda c, s: s),
    "tan": _circular(lambda c, s: s / c),
    "cot": _circular(lambda c, s: c / s),
    "sec": _circular(lambda c, s: 1 / c),
    "csc": _circular(lambda c, s: 1 / s),
}
HYPERBOLIC: dict[str, Rule] = {
    "cosh": _hyperbolic(lambda c, s: c),
    "sinh": _hyperbolic(lambda c, s: s),
    "tanh": _hyperbolic(lambda c, s: s / c),
    "coth": _hyperbolic(lambda c, s: c / s),
    "sech": _hyperbolic(lambda c, s: 1 / c),
    "csch": _hyperbolic(lambda c, s: 1 / s),
}
FUNCTIONS: dict[str, Rule] = {
    **CIRCULAR,
    **HYPERBOLIC,
    "exp": lambda reader, argument: reader.exp(argument),
}


# Functions that keep their arguments unchanged, by name.
_PLAIN_FUNCTIONS = {*FUNCTIONS, *INVERSE_FUNCTIONS, "log", "atan2", "Abs"}


class Scan:
    """Arguments of circular functions, exponents and hyperbolic arguments, by nesting."""

    def __init__(self, exprs: list[sympy.Expr]) -> None:
        self._depth: dict[sympy.Basic, int] = {}
        self._found: dict[int, tuple[Exprs, Exprs, Exprs]] = {}
        for expr in exprs:
            for part in inside_out(expr, attrgetter("args"), self._depth.__contains__):
                self._depth[part] = self._visit(part)

    def levels(self) -> Iterator[tuple[Exprs, Exprs, Exprs]]:
        """(angles, exponents, hyperbolic arguments), innermost first."""
        for depth in sorted(self._found):
            yield self._found[depth]

    def _visit(self, expr: sympy.Basic) -> int:
        """The depth of functions inside an expression, from the depths of its parts; notes it."""
        if not expr.args:
            return 0
        depth = max([self._depth[arg] for arg in expr.args])
        name = type(expr).__name__
        if name in CIRCULAR:
            self._note(depth, 0, expr.args[0])
        elif name == "exp":
            self._note(depth, 1, expr.args[0])
        elif name in HYPERBOLIC:
            self._note(depth, 2, expr.args[0])
        elif isinstance(expr, sympy.Pow) and not expr.exp.is_Rational:
            base, exponent = expr.args
            if base is sympy.E:
                self._note(depth, 1, exponent)
            else:
                depth += 1
                self._note(depth, 1, exponent * sympy.log(base))
        if expr.is_Function or (isinstance(expr, sympy.Pow) and not expr.exp.is_Integer):
            depth += 1
        return depth

    def _note(self, depth: int, kind: int, argument: sympy.Basic) -> None:
        self._found.setdefault(depth, ([], [], []))[kind].append(argument)


class Reader:
    """Reads expressions into one field, each once."""

    def __init__(self, field: Tower) -> None:
        self.field = field
        self.angles: Angles = Angles(field)
        self.exponents: Exponents = Exponents(field)
        self.primitives: Primitives = Primitives(field, self._arguments)
        self._known: dict[sympy.Basic, Element] = {}
        # Functions known by name whose meanings were looked for, and those left for later.
        self._met: set[str] = set()
        self._open: list[Generator] = []
        # Roots whose chosen values are being read.
        self._choosing: set[sympy.Basic] = set()

    def _arguments(self) -> list[Element]:
        return [*self.angles.basis.elements, *self.exponents.basis.elements]

    def read_all(self, entries: Iterable[tuple[str, Any]]) -> list[Element]:
        """Reads all entries, on one common basis of angles and exponents."""
        own = self.field.symbols
        exprs = [(where, checked(where, value, own)) for where, value in entries]
        where = exprs[0][0] if exprs else ""
        try:
            scan = Scan([expr for _, expr in exprs])
            for level in scan.levels():
                # What cannot be read fails again below, where its entry is known.
                with contextlib.suppress(GeomtorsionError, ZeroDivisionError):
                    self._prepare(*level)
            elements = []
            for entry in exprs:
                where = entry[0]
                element = self.element(entry[1])
                if not (element.is_kept and stays_kept(element)):
                    check_size(element)
                written = entry[1]
                if element._sympy is None and _is_longer(element, written):
                    # The input is shorter than any form of the element.
                    element._sympy = None if written.has(sympy.Abs) else written
                elements.append(element)
            self._close()
            return elements
        except RecursionError as error:
            raise LimitError(
                f"{where}: the expression is nested too deeply to be read; write it with "
                "fewer levels of brackets"
            ) from error
        except ZeroDivisionError as error:
            raise ExpressionError(f"{where}: a denominator is exactly zero") from error
        except GeomtorsionError as error:
            if str(error).startswith(f"{where}: "):
                raise
            raise type(error)(f"{where}: {error}") from error

    def _prepare(self, angles: Exprs, exponents: Exprs, hyperbolic: Exprs) -> None:
        """One level of the scan: the arguments are read, then their units chosen."""
        circular, plain, doubled = [], [], []
        for arg in angles:
            real, imaginary = self._parts(self.element(arg))
            circular.append(real)
            doubled.append(imaginary)
        for batch, real_parts in ((exponents, plain), (hyperbolic, doubled)):
            for arg in batch:
                real, imaginary = self._parts(self.element(arg))
                real_parts.append(real)
                circular.append(imaginary)
        self.angles.prepare(circular)
        self.exponents.prepare(plain, doubled)

    def _parts(self, element: Element) -> tuple[Element, Element]:
        """(a, b) with element = a + i b."""
        field = self.field
        generator = field.by_name.get("I")
        if generator is None:
            return element, field.zero
        low, high = split(field.lift(element), field.generators.index(generator))
        if not high:
            return element, field.zero
        below = field.denominator(element).inverse()
        return field.polynomial(low) * below, field.polynomial(high) * below

    def element(self, expr: sympy.Basic) -> Element:
        """Reads one expression."""
        element = self._known.get(expr)
        if element is not None:
            return element
        for part in inside_out(expr, self._parts_of, self._known.__contains__):
            self._known[part] = self._read(part)
        return self._known[expr]

    def _parts_of(self, expr: sympy.Basic) -> tuple[sympy.Basic, ...]:
        """Parts that are read before an expression, in this order; none for rare kinds."""
        if expr.is_Atom:
            return ()
        if expr.is_Add or expr.is_Mul or _is_plain_function(expr):
            return expr.args
        if expr.is_Pow:
            base, exponent = expr.args
            if exponent.is_Integer:
                return (base,)
            if base is sympy.E:
                return (exponent,)
            if not exponent.is_Rational:
                return exponent, base
            if expr in self.field.chosen:
                return ()
            return (base,) if exponent.p == 1 else (_single_root(expr),)
        return ()

    def _read(self, expr: sympy.Basic) -> Element:
        field = self.field
        if expr.is_Symbol:
            return field.symbol(expr)
        if expr.is_Rational:
            return field.rational(fmpq(int(expr.p), int(expr.q)))
        if expr.is_Add:
            return field.sum([(1, self._known[arg]) for arg in expr.args])
        if expr.is_Mul:
            return self._product(expr.args)
        if expr.is_Pow:
            return self._power(expr)
        if isinstance(expr, AppliedUndef):
            arguments = tuple(self.element(arg) for arg in expr.args)
            return jet(field, expr.func, (0,) * len(arguments), arguments)
        if isinstance(expr, sympy.Derivative):
            return self._derivative(expr)
        if isinstance(expr, sympy.Subs):
            return self._substituted(expr)
        if expr.is_Function:
            return self._function(expr)
        return self._constant(expr)

    def _product(self, args: tuple[sympy.Basic, ...]) -> Element:
        if len(args) <= 8:
            return self.field.sum([(1, *[self._known[arg] for arg in args])])
        half = len(args) // 2
        return self._product(args[:half]) * self._product(args[half:])

    def _power(self, expr: sympy.Basic) -> Element:
        base, exponent = expr.args
        if exponent.is_Integer:
            below = self.element(base)
            if exponent.is_negative:
                self._close()
            return below ** int(exponent)
        if base is sympy.E:
            return self.exp(self.element(exponent))
        if exponent.is_Rational:
            chosen = self._chosen(expr)
            if chosen is not None:
                return chosen
            if exponent.p == 1:
                return self.field.root(self.element(base), int(exponent.q), expr)
            # The root itself is read once for all of its powers.
            return self.element(_single_root(expr)) ** int(exponent.p)
        return self.exp(self.element(exponent) * self.primitives.log(self.element(base)))

    def _chosen(self, expr: sympy.Basic) -> Element | None:
        """The value that the user chose for a root or an absolute value, checked."""
        chosen = self.field.chosen.get(expr)
        if chosen is None:
            return None
        if expr in self._choosing:
            raise _chosen_by_itself(expr, chosen)
        self._choosing.add(expr)
        try:
            value = self.element(chosen)
        finally:
            self._choosing.remove(expr)
        # The same root in another notation: results with it would be read as the other root.
        if value.sympy.has(expr):
            raise _chosen_by_itself(expr, chosen)
        if isinstance(expr, sympy.Abs):
            base, exponent = expr.args[0] ** 2, sympy.S.Half
        else:
            base, exponent = expr.args
        if value ** int(exponent.q) != self.element(base) ** int(exponent.p):
            raise ExpressionError(
                f"the branch chosen for {expr} is {chosen}, but its power {exponent.q} is not "
                f"{base}; choose a root of it"
            )
        return value

    def exp(self, exponent: Element) -> Element:
        """exp of any element."""
        real, imaginary = self._parts(exponent)
        check_exponent(real)
        value = self.exponents.exp(real)
        if imaginary._num:
            cos, sin = self.angles.cos_sin(imaginary)
            value = value * (cos + self.field.imaginary * sin)
        return value

    def cos_sin(self, angle: Element) -> tuple[Element, Element]:
        """(cos, sin) of any element."""
        real, imaginary = self._parts(angle)
        cos, sin = self.angles.cos_sin(real)
        if imaginary._num:
            ch, sh = self.exponents.cosh_sinh(imaginary)
            i = self.field.imaginary
            cos, sin = cos * ch - i * sin * sh, sin * ch + i * cos * sh
        return cos, sin

    def cosh_sinh(self, argument: Element) -> tuple[Element, Element]:
        """(cosh, sinh) of any element."""
        real, imaginary = self._parts(argument)
        ch, sh = self.exponents.cosh_sinh(real)
        if imaginary._num:
            cos, sin = self.angles.cos_sin(imaginary)
            i = self.field.imaginary
            ch, sh = ch * cos + i * sh * sin, sh * cos + i * ch * sin
        return ch, sh

    def _function(self, expr: sympy.Basic) -> Element:
        name = type(expr).__name__
        if name in FUNCTIONS:
            return FUNCTIONS[name](self, self.element(expr.args[0]))
        if isinstance(expr, sympy.Abs):
            return self._size(expr)
        if name == "log" and len(expr.args) == 1:
            argument = self.element(expr.args[0])
            value = self.primitives.log(argument)
            if not self.field.all_sure:
                for generator in self.field.generators_of(value):
                    if generator.kind == "log":
                        self._note_meaning(generator)
            return value
        if name in INVERSE_FUNCTIONS:
            return self.primitives.inverse_function(name, self.element(expr.args[0]))
        if name == "atan2":
            return self.primitives.atan2(*(self.element(arg) for arg in expr.args))
        rewritten = smooth_form(expr)
        if rewritten is not None:
            return self.element(rewritten)
        arguments = [self.element(arg) for arg in expr.args]
        shown = expr.func(*(a.sympy for a in arguments))
        if not isinstance(shown, expr.func):
            # With its arguments in another form sympy has it in other functions.
            return self.element(shown)
        if name == "LambertW":
            inner = undone(self.field, shown, tuple(arguments))
            if inner is not None:
                return inner
        value = opaque(self.field, shown, arguments)
        self._note_meaning(self.field.generators_of(value)[0])
        return value

    def _size(self, expr: sympy.Abs) -> Element:
        """|u| as u or -u: the sign that u has at the sample point, stated as a branch.

        Raises
        ------
        ExpressionError
            u is complex, or has both signs in the declared domain.
        """
        field, chosen = self.field, self._chosen(expr)
        if chosen is not None:
            return chosen
        (shown,) = expr.args
        inner = self.element(shown)
        if self._parts(inner)[1]._num:
            raise ExpressionError(
                f"{expr}: expected a real argument, got {inner}. Write the real expression of it, "
                "such as sqrt(x**2 + y**2)"
            )
        sign = field.sample.sign(inner)
        if sign is None:
            raise ExpressionError(
                f"{expr}: expected an argument of one sign in the declared domain, got {inner}, "
                f"which has both. Declare one side, such as domain=[{shown} > 0], or give one "
                "frame for each side"
            )
        size = inner * sign
        if not size.sympy.is_nonnegative:
            field.state_branch(Branch(expr, size.sympy, "", size))
        return size

    def _note_meaning(self, generator: Generator) -> None:
        """What a new function known by name, or a logarithm, is in terms of others."""
        if generator.name in self._met:
            return
        self._met.add(generator.name)
        if type(generator.shown) is sympy.LambertW:
            # It needs exp(W), whose unit is chosen when the whole expression is known.
            self._open.append(generator)
            return
        self._give_meaning(generator)

    def _give_meaning(self, generator: Generator) -> None:
        """Looks for the meaning of a generator; values that were chosen without it are left."""
        value = meaning(self.field, generator)
        if value is not None:
            self.field.meanings[generator.name] = value
            leave_point(self.field)

    def _close(self) -> None:
        """Meanings that had to wait."""
        while self._open:
            self._give_meaning(self._open.pop())

    def _derivative(self, expr: sympy.Derivative) -> Element:
        value = self.element(expr.expr)
        for variable, count in expr.variable_count:
            for _ in range(int(count)):
                value = value.diff(variable)
        return value

    def _substituted(self, expr: sympy.Subs) -> Element:
        """Subs(Derivative(f(xi), xi), xi, place): a jet at a composite place."""
        inner = expr.expr
        if not isinstance(inner, sympy.Derivative) or not isinstance(inner.expr, AppliedUndef):
            return self.element(expr.doit())
        table = dict(zip(expr.variables, expr.point, strict=True))
        orders = [0] * len(inner.expr.args)
        for variable, count in inner.variable_count:
            places = [k for k, arg in enumerate(inner.expr.args) if arg == variable]
            if len(places) != 1:
                raise ExpressionError(f"{expr}: write the derivative with respect to one argument")
            orders[places[0]] += int(count)
        arguments = tuple(self.element(arg.subs(table)) for arg in inner.expr.args)
        return jet(self.field, inner.expr.func, tuple(orders), arguments)

    def _constant(self, expr: sympy.Basic) -> Element:
        """pi, E, I and other numbers with a name."""
        field = self.field
        if expr is sympy.I:
            return field.imaginary
        if expr is sympy.E:
            return self.exp(field.one)
        if expr is sympy.pi:
            generator = field.by_name.get("pi")
            if generator is not None:
                return field.generator_element(generator)
            return field.add(Generator("constant", "pi", sympy.pi, frozenset()))
        if expr is sympy.GoldenRatio:
            return self.element((1 + sympy.sqrt(5)) / 2)
        if expr.is_number and expr.is_finite and expr.is_Atom:
            return opaque(field, expr, ())
        raise ExpressionError(f"{expr} cannot be read as an exact scalar")


def _single_root(power: sympy.Basic) -> sympy.Expr:
    """x**(1/q) of x**(p/q)."""
    base, exponent = power.args
    return base ** sympy.Rational(1, exponent.q)


def _is_plain_function(expr: sympy.Basic) -> bool:
    """Whether an expression is a function that is made of its arguments, as they are."""
    return isinstance(expr, AppliedUndef) or type(expr).__name__ in _PLAIN_FUNCTIONS


def _chosen_by_itself(root: sympy.Basic, value: sympy.Expr) -> ExpressionError:
    """The error for a root whose chosen value is made of the root."""
    return ExpressionError(
        f"branches[{root}]: expected a value without this root, such as -cos(x) for "
        f"sqrt(1 - sin(x)**2), got {value}. To take the other sign, write -{root} instead of "
        f"{root} in each entry concerned, and omit branches."
    )


def _is_longer(element: Element, written: sympy.Expr) -> bool:
    """Whether an element has more terms, multiplied out, than the input has parts."""
    if element.is_kept:
        return True
    terms = len(element._num)
    return terms > 1 and sum(1 for _ in islice(sympy.preorder_traversal(written), terms)) < terms

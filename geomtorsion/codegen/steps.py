"""Steps: values computed one after another, each once; and steps made of steps, as derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from typing import Any

import sympy

from geomtorsion.codegen import special
from geomtorsion.errors import ExpressionError
from geomtorsion.exact.special_values import VALUES

# So many quotients by one value make its inverse pay: a product costs less than a quotient.
MANY_QUOTIENTS = 6

# Further functions that occur in slopes of special functions.
_EVERYDAY = (sympy.exp, sympy.log, sympy.sin, sympy.cos, sympy.sinh, sympy.cosh)

# Functions whose derivative is another function, with a sign.
_SLOPES = {
    "sin": ("cos", 1), "cos": ("sin", -1), "sinh": ("cosh", 1), "cosh": ("sinh", 1),
    "Abs": ("sign", 1),
}  # fmt: skip

# Sign and position of a step.
Signed = tuple[int, int]


@dataclass(frozen=True)
class Step:
    """One value.

    kind: argument, number (rational), digits (pi and its kind), imaginary (the unit), sum,
        product, square, quotient, root or call.
    operands: positions of earlier steps.
    signs: of each operand of a sum; otherwise empty.
    detail: the position of an argument, the number, the degree of a root, the name of a function
        (sympy's, or power).
    constant: whether the step changes only with constant arguments.
    """

    kind: str
    operands: tuple[int, ...] = ()
    signs: tuple[int, ...] = ()
    detail: Any = None
    constant: bool = False


class Builder:
    """Collects steps; equal ones are made once."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self._known: dict[tuple[object, ...], int] = {}

    def add(
        self,
        kind: str,
        operands: tuple[int, ...] = (),
        detail: Any = None,
        *,
        signs: tuple[int, ...] = (),
        constant: bool | None = None,
    ) -> int:
        """The position of a step; constant: None where its operands decide."""
        key = (kind, operands, signs, detail)
        position = self._known.get(key)
        if position is None:
            if constant is None:
                constant = all(self.steps[place].constant for place in operands)
            position = self._known[key] = len(self.steps)
            self.steps.append(Step(kind, operands, signs, detail, constant))
        return position

    def argument(self, position: int, *, constant: bool) -> int:
        """An argument of the graph."""
        return self.add("argument", detail=position, constant=constant)

    def number(self, value: Fraction) -> int:
        """A rational number."""
        return self.add("number", detail=value, constant=True)

    def root(self, place: int, degree: int) -> int:
        """A root."""
        return self.add("root", (place,), degree)

    def total(self, parts: Sequence[Signed]) -> Signed:
        """A sum of signed steps, with its own sign: minus where all are minus."""
        if len(parts) == 1:
            return parts[0]
        sign = -1 if all(s < 0 for s, _ in parts) else 1
        ordered = sorted(((sign * s, p) for s, p in parts), key=lambda part: -part[0])
        signs, operands = zip(*ordered, strict=True)
        return sign, self.add("sum", operands, signs=signs)

    def product(self, first: int, second: int) -> int:
        """A product, constants in front; equal factors make a square."""
        if first == second:
            return self.add("square", (first,))
        one, two = self.steps[first], self.steps[second]
        if (two.constant, first) > (one.constant, second):
            first, second = second, first
        return self.add("product", (first, second))

    def quotient(self, above: int, below: int) -> int:
        """A quotient."""
        return self.add("quotient", (above, below))

    def power(self, place: int, exponent: int) -> int:
        """A whole power by squares and products.

        heyoka's series of x**n divides by x where n > 2, and has no value on x = 0; squares and
        products have.
        """
        if exponent == 1:
            return place
        half = self.power(place, exponent // 2)
        square = self.product(half, half)
        return self.product(square, place) if exponent % 2 else square

    def needed(self, outputs: Sequence[Signed]) -> tuple[tuple[Step, ...], tuple[Signed, ...]]:
        """The steps that outputs need; inverses where many quotients share a denominator."""
        count: dict[int, int] = {}
        for step in self.steps:
            if step.kind == "quotient" and not step.constant:
                count[step.operands[1]] = count.get(step.operands[1], 0) + 1
        many = {place for place, times in count.items() if times >= MANY_QUOTIENTS}
        is_needed = [False] * len(self.steps)
        for _, place in outputs:
            is_needed[place] = True
        for place in range(len(self.steps) - 1, -1, -1):
            if is_needed[place]:
                for operand in self.steps[place].operands:
                    is_needed[operand] = True
        fresh = Builder()
        moved: dict[int, int] = {}
        for place, step in enumerate(self.steps):
            if not is_needed[place]:
                continue
            operands = tuple(moved[p] for p in step.operands)
            quotient = step.kind == "quotient"
            if quotient and step.operands[1] in many and not is_one(self.steps[step.operands[0]]):
                inverse = fresh.quotient(fresh.number(Fraction(1)), operands[1])
                moved[place] = fresh.product(operands[0], inverse)
            else:
                moved[place] = fresh.add(
                    step.kind, operands, step.detail, signs=step.signs, constant=step.constant
                )
        return tuple(fresh.steps), tuple((s, moved[p]) for s, p in outputs)


def is_one(step: Step) -> bool:
    """Whether a step is the number one."""
    return step.kind == "number" and step.detail == 1


def uses(steps: Sequence[Step], outputs: Sequence[Signed]) -> list[int]:
    """How often each step is read; a square reads its base twice."""
    count = [0] * len(steps)
    for step in steps:
        for place in step.operands:
            count[place] += 2 if step.kind == "square" else 1
    for _, place in outputs:
        count[place] += 1
    return count


# Derivatives that are not zero: argument -> sign and position.
Slopes = dict[int, Signed]


def jacobian(
    steps: Sequence[Step], outputs: Sequence[Signed], positions: Sequence[int]
) -> tuple[tuple[Step, ...], tuple[Signed, ...]]:
    """Steps and outputs for d output / d argument, ordered by output.

    Derivatives are carried forward from step to step; derivatives that are zero are never written.
    """
    work = Forward(steps, positions)
    for place, step in enumerate(steps):
        work.slopes.append(work.of_step(place, step))
    zero = work.builder.number(Fraction(0))
    derivatives = []
    for sign, place in outputs:
        slopes = work.slopes[place]
        for j in range(len(positions)):
            turn, where = slopes.get(j, (1, zero))
            derivatives.append((sign * turn, where))
    return work.builder.needed(derivatives)


class Forward:
    """Steps with their derivatives; the old steps come first and keep their positions."""

    def __init__(self, steps: Sequence[Step], positions: Sequence[int]) -> None:
        self.builder: Builder = Builder()
        self.slopes: list[Slopes] = []
        self._seeds = {position: j for j, position in enumerate(positions)}
        for step in steps:
            self.builder.add(
                step.kind, step.operands, step.detail, signs=step.signs, constant=step.constant
            )
        self._one = self._number(1)

    def _number(self, value: int | Fraction) -> int:
        return self.builder.number(Fraction(value))

    def _call(self, name: str, *operands: int) -> int:
        return self.builder.add("call", operands, name)

    def _plus_one(self, place: int, sign: int = 1) -> int:
        """1 + (or minus) a step."""
        return self.builder.total([(1, self._one), (sign, place)])[1]

    def _times(self, slope: Signed, factor: int) -> Signed:
        sign, place = slope
        if place == self._one:
            return sign, factor
        return sign, place if factor == self._one else self.builder.product(factor, place)

    def _over(self, slope: Signed, below: int) -> Signed:
        return slope[0], self.builder.quotient(slope[1], below)

    def _sum(self, parts: Sequence[tuple[int, Slopes]]) -> Slopes:
        """The sum of signed slopes."""
        by_argument: dict[int, list[Signed]] = {}
        for sign, slopes in parts:
            for j, (turn, place) in slopes.items():
                entry = (sign * turn, place)
                opposite = (-sign * turn, place)
                terms = by_argument.setdefault(j, [])
                if opposite in terms:
                    terms.remove(opposite)
                else:
                    terms.append(entry)
        return {j: self.builder.total(terms) for j, terms in by_argument.items() if terms}

    def _scaled(self, slopes: Slopes, factor: int, sign: int = 1) -> Slopes:
        """Slopes times a step."""
        products = {j: self._times(slope, factor) for j, slope in slopes.items()}
        return {j: (sign * turn, place) for j, (turn, place) in products.items()}

    def _divided(self, slopes: Slopes, below: int, sign: int = 1) -> Slopes:
        quotients = {j: self._over(slope, below) for j, slope in slopes.items()}
        return {j: (sign * turn, place) for j, (turn, place) in quotients.items()}

    def partials(self, place: int, step: Step) -> Slopes:
        """The derivatives of a call with respect to its operands, by their number.

        Raises
        ------
        ExpressionError
            the function has no derivative here.
        """
        return self._of_call(place, step, [{k: (1, self._one)} for k in range(len(step.operands))])

    def of_step(self, place: int, step: Step) -> Slopes:
        """The derivatives of a step."""
        kind, operands = step.kind, step.operands
        if kind == "argument":
            assert isinstance(step.detail, int)
            position = step.detail
            return {self._seeds[position]: (1, self._one)} if position in self._seeds else {}
        inner = [self.slopes[operand] for operand in operands]
        if not any(inner):
            return {}
        if kind == "sum":
            return self._sum(list(zip(step.signs, inner, strict=True)))
        if kind == "product":
            first, second = operands
            return self._sum(
                [(1, self._scaled(inner[0], second)), (1, self._scaled(inner[1], first))]
            )
        if kind == "square":
            return self._scaled(inner[0], self.builder.product(self._number(2), operands[0]))
        if kind == "quotient":
            # (a / b)' = (a' - (a / b) b') / b
            slopes = self._sum([(1, inner[0]), (-1, self._scaled(inner[1], place))])
            return self._divided(slopes, operands[1])
        if kind == "root":
            # w**n = u: w' = w u' / (n u), for square roots u' / (2 w).
            degree = self._number(Fraction(step.detail))
            if step.detail == 2:
                return self._divided(inner[0], self.builder.product(degree, place))
            below = self.builder.product(degree, operands[0])
            return self._divided(self._scaled(inner[0], place), below)
        return self._of_call(place, step, inner)

    def _of_call(self, place: int, step: Step, inner: Sequence[Slopes]) -> Slopes:
        name, operands = str(step.detail), step.operands
        first = operands[0]
        if name == "power":
            return self._of_power(place, operands, inner)
        if name == "atan2":
            # atan2(y, x)' = (x y' - y x') / (x**2 + y**2)
            y, x = operands
            parts = [(1, self._scaled(inner[0], x)), (-1, self._scaled(inner[1], y))]
            squares = [(1, self.builder.product(x, x)), (1, self.builder.product(y, y))]
            return self._divided(self._sum(parts), self.builder.total(squares)[1])
        if name in ("sign", "floor", "ceiling"):
            return {}
        square = self.builder.product(first, first)
        if name in _SLOPES:
            slope, sign = _SLOPES[name]
            return self._scaled(inner[0], self._call(slope, first), sign)
        if name in ("tan", "tanh"):
            sign = 1 if name == "tan" else -1
            return self._scaled(inner[0], self._plus_one(self.builder.product(place, place), sign))
        if name == "exp":
            return self._scaled(inner[0], place)
        if name == "log":
            return self._divided(inner[0], first)
        if name in ("atan", "atanh"):
            return self._divided(inner[0], self._plus_one(square, 1 if name == "atan" else -1))
        if name in ("asin", "acos", "asinh", "acosh"):
            below = self._plus_one(square, 1 if name == "asinh" else -1)
            if name == "acosh":
                below = self.builder.total([(1, square), (-1, self._one)])[1]
            root = self.builder.root(below, 2)
            return self._divided(inner[0], root, -1 if name == "acos" else 1)
        if name in VALUES:
            return self._of_special(name, operands, inner)
        raise ExpressionError(f"{name} has no derivative here; write it in other functions")

    def _of_special(self, name: str, operands: Sequence[int], inner: Sequence[Slopes]) -> Slopes:
        """The chain rule with the slopes that sympy knows."""
        table: dict[sympy.Expr, int] = {}
        values: list[sympy.Expr] = []
        for operand in operands:
            step = self.builder.steps[operand]
            value = sympy.Dummy()
            if step.kind == "number":
                # Functions of an order that is a number have slopes of their own.
                value = sympy.Rational(step.detail.numerator, step.detail.denominator)
            values.append(value)
            table[value] = operand
        parts = [
            (1, self._scaled(slopes, self._expression(special.slope(name, values, k), table)))
            for k, slopes in enumerate(inner)
            if slopes
        ]
        return self._sum(parts)

    def _expression(self, tree: sympy.Basic, table: dict[sympy.Expr, int]) -> int:
        """An expression of sympy over steps that exist."""
        if tree in table:
            return table[tree]
        if isinstance(tree, sympy.Rational):
            return self._number(Fraction(int(tree.p), int(tree.q)))
        if isinstance(tree, sympy.NumberSymbol):
            return self.builder.add("digits", (), tree, constant=True)
        inner = [self._expression(part, table) for part in tree.args]
        if isinstance(tree, sympy.Add):
            return self.builder.total([(1, place) for place in inner])[1]
        if isinstance(tree, sympy.Mul):
            return reduce(self.builder.product, inner)
        if isinstance(tree, sympy.Pow) and tree.args[0] is not sympy.E:
            exponent = tree.args[1]
            if exponent.is_Integer:
                power = self.builder.power(inner[0], abs(int(exponent)))
                return power if exponent > 0 else self.builder.quotient(self._one, power)
            return self._call("power", *inner)
        name = type(tree).__name__
        if name not in VALUES and not isinstance(tree, _EVERYDAY):
            raise ExpressionError(f"{tree} has no derivative here; write it in other functions")
        return self._call(name, *inner)

    def _of_power(self, place: int, operands: Sequence[int], inner: Sequence[Slopes]) -> Slopes:
        """(u**v)' = v u**(v - 1) u' + u**v log(u) v'"""
        base, exponent = operands
        exponent_step = self.builder.steps[exponent]
        if exponent_step.kind == "number":
            less = self._number(Fraction(exponent_step.detail) - 1)
        else:
            less = self.builder.total([(1, exponent), (-1, self._one)])[1]
        lower = self.builder.product(exponent, self._call("power", base, less))
        parts = [(1, self._scaled(inner[0], lower))]
        if inner[1]:
            slope = self.builder.product(place, self._call("log", base))
            parts.append((1, self._scaled(inner[1], slope)))
        return self._sum(parts)


# Steps that cost an engine nothing: they stay where they are.
_GIVEN = ("argument", "number", "digits")
Part = tuple[tuple[Step, ...], tuple[Signed, ...]]


def hoisted(
    steps: Sequence[Step], outputs: Sequence[Signed], width: int, first: int
) -> tuple[Part, Part]:
    """Steps that read constants as further arguments, and steps that make these.

    An engine of series takes any value that is made in the equations for a series, and a product
    with it for one of two series; a number that is given to it costs one multiplication at each
    order.

    Quotients by constants become products with their inverses.

    width: how many arguments there are; first: position of the first that is constant, as all
    after it are, which are the arguments of what makes the constants.
    """
    made, constant_outputs = Builder(), list[Signed]()
    rest, places, own = Builder(), list[int](), list[int]()
    positions: dict[int, int] = {}

    def further(place: int) -> int:
        """An argument for a constant, by its position in `made`."""
        if place not in positions:
            positions[place] = width + len(constant_outputs)
            constant_outputs.append((1, place))
        return rest.argument(positions[place], constant=True)

    def read(place: int) -> int:
        step = steps[place]
        return further(own[place]) if step.constant and step.kind not in _GIVEN else places[place]

    for step in steps:
        if step.constant:
            detail = step.detail - first if step.kind == "argument" else step.detail
            operands = tuple(own[place] for place in step.operands)
            own.append(made.add(step.kind, operands, detail, signs=step.signs, constant=True))
            is_given = step.kind in _GIVEN
            places.append(rest.add(step.kind, (), step.detail, constant=True) if is_given else -1)
            continue
        own.append(-1)
        below = steps[step.operands[1]] if step.kind == "quotient" else None
        if below is not None and below.constant and below.kind != "number":
            one = made.number(Fraction(1))
            inverse = further(made.quotient(one, own[step.operands[1]]))
            places.append(rest.product(read(step.operands[0]), inverse))
            continue
        operands = tuple(map(read, step.operands))
        places.append(rest.add(step.kind, operands, step.detail, signs=step.signs, constant=False))
    results = [(sign, read(place)) for sign, place in outputs]
    return rest.needed(results), made.needed(constant_outputs)


# A value smaller than this many roundings of its terms has no definite sign.
ROUNDINGS = 8


def term_sizes(
    steps: Sequence[Step], outputs: Sequence[Signed]
) -> tuple[tuple[Step, ...], tuple[Signed, ...]]:
    """Steps and outputs for the sizes, by which roundings of terms are measured."""
    builder, sizes = _with_sizes(steps)
    return builder.needed([(1, sizes[place]) for _, place in outputs])


def above_rounding(
    steps: Sequence[Step], outputs: Sequence[Signed]
) -> tuple[tuple[Step, ...], tuple[Signed, ...]]:
    """Steps and outputs that are positive only where rounding in doubles leaves no doubt of it.

    A root is replaced by its radicand, which has the same sign as long as there is a root.
    """
    builder, sizes = _with_sizes(steps)
    share = builder.number(Fraction(ROUNDINGS, 2**52))
    margins = []
    for sign, place in outputs:
        inner = steps[place].operands[0] if steps[place].kind == "root" else place
        doubt = builder.product(share, sizes[inner])
        margins.append(builder.total([(sign, inner), (-1, doubt)]))
    return builder.needed(margins)


def _with_sizes(steps: Sequence[Step]) -> tuple[Builder, list[int]]:
    """All steps, and for each the position of its size."""
    builder = Builder()
    sizes: list[int] = []
    # First all old steps, so that their positions stay.
    for step in steps:
        builder.add(step.kind, step.operands, step.detail, signs=step.signs, constant=step.constant)
    for place, step in enumerate(steps):
        inner = [sizes[operand] for operand in step.operands]
        if step.kind == "sum":
            size = builder.total([(1, operand) for operand in inner])[1]
        elif step.kind in ("product", "square"):
            size = builder.product(inner[0], inner[-1])
        elif step.kind == "quotient":
            size = builder.quotient(inner[0], builder.add("call", step.operands[1:], "Abs"))
        else:
            size = builder.add("call", (place,), "Abs")
        sizes.append(size)
    return builder, sizes

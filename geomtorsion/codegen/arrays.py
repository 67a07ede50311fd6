"""Arrays: elements as one function of arrays, with more digits where rounding would spoil them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from geomtorsion.codegen.balls import BallCode, float_values
from geomtorsion.codegen.expression_graph import Graph, branch_check, graph
from geomtorsion.codegen.printers import FUNCTIONS, compiled, python_body, python_source
from geomtorsion.codegen.steps import Forward, Signed, Step
from geomtorsion.errors import ArgumentError, ExpressionError, MissingValueError, SingularPointError
from geomtorsion.exact.element import Element
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import array, cut, entries, flag, instance, shown
from geomtorsion.support.precision import CALCULATED


def numpy_function(
    elements: Sequence[Element], symbols: Sequence[sp.Expr], *, check: bool = True
) -> Callable[..., np.ndarray]:
    """A function of arrays that gives the values of all elements at once.

    Parameters
    ----------
    elements
        the outputs, k of them.
    symbols
        the arguments in order: sympy symbols, or unknown functions such as f(r).
    check
        raise where a value is inaccurate or not finite; False: return values unchecked, and NaN
        where a root has another sign than the sign with which it was read.

    Returns
    -------
    Function of len(symbols) numbers or arrays of one shape; it returns an array of shape
    (k, *shape).  Its source is kept in the attribute `source`.  Values have a relative error below
    1e-12: where rounding may leave fewer digits, as near a removable singularity or a zero, they
    are computed with more digits.

    Raises
    ------
    MissingValueError
        an element contains a symbol that is not among the arguments.
    ArgumentError
        (also from the function) a symbol occurs twice; an argument is neither a real number nor an
        array of real numbers, or, with `check`, is not finite.
    BranchError
        (from the function) a root has another sign than it was read with, see `Frame.branches`.
    SingularPointError
        (from the function) a value is not finite, or is lost in rounding errors with any number of
        digits; the message names element and point.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion import numpy_function
    >>> from geomtorsion.exact import Field
    >>> r = sympy.Symbol("r")
    >>> f = numpy_function([Field([r]).read(r**2 + 1)], [r])
    >>> f([1.0, 2.0])
    array([[2., 5.]])
    """
    symbols = entries(symbols, "symbols")
    elements = entries(elements, "elements")
    for k, element in enumerate(elements):
        instance(element, Element, f"elements[{k}]")
    flag(check, "check")
    for k, symbol in enumerate(symbols):
        if str(symbol) in map(str, symbols[:k]):
            raise ArgumentError(f"symbols[{k}]: {cut(str(symbol))} occurs twice. Give it once.")
    shared_graph = graph([str(symbol) for symbol in symbols], elements, factor=False)
    inner, settled = shared_graph.numpy(), Settled(shared_graph)
    names = [str(symbol) for symbol in symbols]
    branches = branch_check((element.field for element in elements), names)

    def last_resort(k: int, point: tuple[float | complex, ...]) -> float | complex | None:
        try:
            value = elements[k].evaluate(dict(zip(symbols, point, strict=True)))
        except (SingularPointError, ZeroDivisionError, ValueError):
            return None
        return value if np.isfinite(value) else None

    def function(*values: ArrayLike) -> np.ndarray:
        if len(values) != len(symbols):
            raise MissingValueError(
                f"expected {len(symbols)} arguments ({', '.join(map(str, symbols))}), "
                f"got {len(values)}"
            )
        arrays = tuple(_argument(*pair, check) for pair in zip(names, values, strict=True))
        shapes = set(map(np.shape, arrays)) - {()}
        try:
            if len(shapes) > 1:
                np.broadcast_shapes(*shapes)
        except ValueError:
            came = shown(values)
            raise ArgumentError(f"expected numbers or arrays of one shape, got {came}") from None
        if not check:
            result = inner(*arrays)
            if branches is not None:
                result[:, branches.broken(*arrays).any(axis=0)] = np.nan
            return result
        if branches is not None:
            branches.refuse(*arrays)
        result, doubtful = settled(*arrays)
        if doubtful.any():
            lost = settled.mend(result, doubtful, arrays, last_resort)
            if lost is not None:
                raise SingularPointError(_where_singular(lost, arrays, elements, symbols))
        return result

    # Functions accept attributes of their own, which their type does not declare.
    function.source = shared_graph.python_source()  # type: ignore[attr-defined]
    return function


def _argument(name: str, value: ArrayLike, is_finite: bool) -> ArrayLike:
    """An argument as floats; floats are returned unchanged."""
    is_float = type(value) is float or (type(value) is np.ndarray and value.dtype == np.float64)
    if is_float and not (is_finite and not np.isfinite(value).all()):
        return value
    wanted = "a number or an array of real numbers"
    infinite = "{subject}{place} = {value} is not finite. Give finite numbers."
    return array(
        value, name, ArgumentError, expected=wanted, infinite=infinite if is_finite else None
    )


def _where_singular(
    first: tuple[int, ...],
    values: Sequence[ArrayLike],
    elements: Sequence[Element],
    symbols: Sequence[sp.Expr],
) -> str:
    """The message that names the first value that there is not."""
    broad = np.broadcast_arrays(*values)
    point = ", ".join(
        f"{symbol} = {array[first[1:]]:.6g}" for symbol, array in zip(symbols, broad, strict=True)
    )
    return (
        f"{elements[first[0]]} has no finite value at {point}; "
        "move the point away from the edge of the chart"
    )


# Points computed at once: intermediate values stay in the cache of the processor. No bit of a
# result depends on it.
BLOCK = 8192

# Fallback that computes a value where balls fail: (output, point) -> value, or None.
LastResort = Callable[[int, tuple[float | complex, ...]], float | complex | None]


@dataclass(frozen=True, eq=False)
class Settled:
    """The values of a graph on arrays, each right to 1e-12 of itself.

    Each value carries a bound of its rounding error. Where that is too large, or the
    value is not finite, ball arithmetic computes it again.
    """

    graph: Graph

    @cached_property
    def _bounds(self) -> Bounds:
        return rounding_bounds(
            self.graph.steps, self.graph.outputs, is_complex=self.graph.is_complex
        )

    @cached_property
    def _code(self) -> Callable[..., tuple[np.ndarray, ...]]:
        """Values, and after them the bounds of those that need one at each point."""
        bounds = self._bounds
        body = python_body(bounds.steps, (*bounds.values, *bounds.absolute))
        return compiled(python_source(len(self.graph.arguments), body), "arrays")

    def __call__(self, *arguments: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Values as doubles give them, and which of them are doubtful; shapes (size, *shape)."""
        dtype, size = complex if self.graph.is_complex else float, self.graph.size
        arrays = [np.asarray(argument, dtype=dtype) for argument in arguments]
        shape = np.broadcast_shapes(*(array.shape for array in arrays))
        values, doubtful = np.empty((size, *shape), dtype=dtype), np.zeros((size, *shape), bool)
        moving = [k for k, relative in enumerate(self._bounds.relative) if relative is None]
        roundings = CALCULATED / 2.0**-53
        with np.errstate(all="ignore"):
            for parts, part in _blocks(arrays, shape):
                computed = self._code(*parts)
                for k in range(size):
                    part(values[k, ...])[...] = computed[k]
                for k, bound in zip(moving, computed[size:], strict=True):
                    spoilt = ~(np.abs(bound) <= roundings * np.abs(computed[k]))
                    if spoilt.any():
                        part(doubtful[k, ...])[...] = spoilt
            finite = np.isfinite(values)
            if not finite.all():
                doubtful |= ~finite
        return values, doubtful

    def mend(
        self,
        values: np.ndarray,
        doubtful: np.ndarray,
        arguments: tuple[ArrayLike, ...],
        last_resort: LastResort,
    ) -> tuple[int, ...] | None:
        """Recompute doubtful values in place; return the index of the first that fails."""
        dtype = values.dtype
        columns = np.broadcast_arrays(*(np.asarray(x, dtype=dtype) for x in arguments))
        codes: dict[tuple[int, ...], BallCode] = {}
        for place in np.argwhere(doubtful.any(axis=0)):
            at = tuple(place.tolist())
            point = tuple(column[at].item() for column in columns)
            which = tuple(np.flatnonzero(doubtful[(slice(None), *at)]).tolist())
            if which not in codes:
                outputs = tuple(self.graph.outputs[k] for k in which)
                codes[which] = BallCode(replace(self.graph, outputs=outputs))
            recomputed = float_values(codes[which], point)
            for k, value in zip(which, recomputed, strict=True):
                # A value above the largest float is not finite either.
                lost = value is None or not np.isfinite(value)
                replacement = last_resort(k, point) if lost else value
                if replacement is None:
                    return (k, *at)
                values[(k, *at)] = replacement
        return None


def _blocks(
    arrays: list[np.ndarray], shape: tuple[int, ...]
) -> Iterator[tuple[list[np.ndarray], Callable[[np.ndarray], np.ndarray]]]:
    """Parts of arrays that are computed at once, and the function that takes each part."""
    count = int(np.prod(shape))
    # Arrays that are still to be broadcast are small: they are computed before that.
    if count <= BLOCK or any(array.shape not in ((), shape) for array in arrays):
        yield arrays, lambda whole: whole
        return
    rows = [array if array.shape == () else array.reshape(-1) for array in arrays]
    for begin in range(0, count, BLOCK):
        some = slice(begin, begin + BLOCK)
        parts = [row if row.shape == () else row[some] for row in rows]
        yield parts, lambda whole, some=some: whole.reshape(-1)[some]


@dataclass(frozen=True)
class Bounds:
    """Steps for values and for bounds of their errors, in units of one rounding.

    relative: of each output, where it is the same at all points; None where it is not.
    absolute: sign and position of the bound of each other output.
    """

    steps: tuple[Step, ...]
    values: tuple[Signed, ...]
    relative: tuple[int | None, ...]
    absolute: tuple[Signed, ...]


def rounding_bounds(
    steps: Sequence[Step], outputs: Sequence[Signed], *, is_complex: bool = False
) -> Bounds:
    """A running error analysis: each step's bound from its operands' bounds, to first order.

    Arguments count as exact. A product of exact numbers is right to one rounding wherever it is
    evaluated, and so is a sum of terms of one sign; only where terms may cancel does the bound
    depend on the point. [Higham, Accuracy and Stability of Numerical Algorithms, 3.3]
    """
    work = _Analysis(steps)
    for place, step in enumerate(steps):
        work.signs.append(0 if is_complex else work.sign(step))
        work.errors.append(work.error(place, step))
    errors = [work.errors[place] for _, place in outputs]
    relative = tuple(None if error.moving else error.roundings for error in errors)
    moving = [place for (_, place), r in zip(outputs, relative, strict=True) if r is None]
    places = [(1, work.absolute(place)) for place in moving]
    needed_steps, moved = work.forward.builder.needed([*outputs, *places])
    return Bounds(needed_steps, moved[: len(outputs)], relative, moved[len(outputs) :])


@dataclass(frozen=True)
class _Error:
    """An error of at most a number of roundings of the value, plus a further error (a step)."""

    roundings: int
    rest: int | None = None

    @property
    def moving(self) -> bool:
        """Whether it depends on the point by more than the value."""
        return self.rest is not None


class _Analysis:
    """Steps with bounds; the old steps come first and keep their positions."""

    def __init__(self, steps: Sequence[Step]) -> None:
        self.forward = Forward(steps, ())
        self.builder = self.forward.builder
        self.steps = steps
        self.errors: list[_Error] = []
        self.signs: list[int] = []

    # -- signs that do not depend on the point ----------------------------------------------------

    def sign(self, step: Step) -> int:
        """1 or -1 where a step has this sign (or vanishes) wherever it is real; 0 if unknown."""
        inner = [self.signs[place] for place in step.operands]
        if step.kind == "number":
            return 1 if step.detail >= 0 else -1
        if step.kind == "sum":
            signs = {s * t for s, t in zip(step.signs, inner, strict=True)}
            return signs.pop() if len(signs) == 1 else 0
        if step.kind in ("product", "quotient"):
            return inner[0] * inner[1]
        if step.kind in ("square", "digits"):
            return 1
        if step.kind == "root":
            return 1 if step.detail % 2 == 0 else inner[0]
        return 1 if step.kind == "call" and step.detail in ("exp", "cosh", "Abs") else 0

    # -- bounds ----------------------------------------------------------------------------------

    def absolute(self, place: int) -> int:
        """The bound of the error of a step, as a step."""
        error = self.errors[place]
        parts = [] if error.rest is None else [error.rest]
        if error.roundings:
            parts.append(self._times(error.roundings, self._size(place)))
        return self._total(parts)

    def error(self, place: int, step: Step) -> _Error:
        """The bound of a step."""
        kind, operands = step.kind, step.operands
        if kind in ("argument", "imaginary"):
            return _Error(0)
        if kind == "number":
            return _Error(0 if _is_float(step.detail) else 1)
        if kind == "digits":
            return _Error(1)
        if kind == "sum":
            return self._of_sum(step)
        inner = [self.errors[operand] for operand in operands]
        if kind in ("product", "quotient", "square"):
            return self._of_product(place, kind, operands * 2 if kind == "square" else operands)
        if kind == "root":
            (error,) = inner
            roundings = -(-error.roundings // step.detail) + (
                1 if step.detail == 2 else _roundings_of("power")
            )
            if error.rest is None:
                return _Error(roundings)
            part = self.builder.quotient(error.rest, self._size(operands[0]))
            return _Error(roundings, self.builder.product(part, self._size(place)))
        return self._of_call(place, step, inner)

    def _of_product(self, place: int, kind: str, operands: Sequence[int]) -> _Error:
        """Roundings add; |a b| moves by |b| for a and |a| for b, |a/b| by 1/|b| and |a/b|/|b|."""
        one, other = (self.errors[operand] for operand in operands)
        exact = any(self._is_power_of_two(operand) for operand in operands)
        roundings = one.roundings + other.roundings + (0 if exact else 1)
        builder, (above, below) = self.builder, operands
        is_quotient = kind == "quotient"
        write = builder.quotient if is_quotient else builder.product
        pairs = ((one.rest, below), (other.rest, below if is_quotient else above))
        parts = [write(rest, self._size(k)) for rest, k in pairs if rest is not None]
        if is_quotient and other.rest is not None:
            parts[-1] = builder.product(parts[-1], self._size(place))
        return self._bound(roundings, parts)

    def _of_sum(self, step: Step) -> _Error:
        inner = [self.errors[place] for place in step.operands]
        signs = {s * self.signs[place] for s, place in zip(step.signs, step.operands, strict=True)}
        adding = len(inner) - 1
        parts = [error.rest for error in inner if error.rest is not None]
        if len(signs) == 1 and 0 not in signs:
            most = max(error.roundings for error in inner) + adding
            return self._bound(most, parts)
        # The last addition rounds the sum itself, those before it what may be larger.
        before = adding - 1
        for error, place in zip(inner, step.operands, strict=True):
            if error.roundings + before:
                parts.append(self._times(error.roundings + before, self._size(place)))
        return self._bound(1, parts)

    def _of_call(self, place: int, step: Step, inner: Sequence[_Error]) -> _Error:
        name = step.detail
        if name in ("sign", "floor", "ceiling"):
            return _Error(0)
        if name in ("Max", "Min"):
            parts = [self.absolute(p) for p in step.operands if self.errors[p] != _Error(0)]
            return self._bound(0, parts)
        parts = []
        try:
            slopes = self.forward.partials(place, step)
        except ExpressionError:
            # Its derivative is not known: it passes relative errors on as they come.
            slopes = {}
        for k, operand in enumerate(step.operands):
            if self.errors[operand] != _Error(0) and k in slopes:
                slope = self._size(slopes[k][1])
                parts.append(self.builder.product(slope, self.absolute(operand)))
        most = max(error.roundings for error in inner) if not slopes else 0
        return self._bound(most + _roundings_of(name), parts)

    # -- writing ---------------------------------------------------------------------------------

    def _size(self, place: int) -> int:
        """The absolute value of a step."""
        step = self.builder.steps[place]
        if step.kind == "number":
            return self.builder.number(abs(step.detail))
        if place < len(self.signs) and self.signs[place] > 0:
            return place
        return self.builder.add("call", (place,), "Abs")

    def _times(self, factor: int, place: int) -> int:
        return place if factor == 1 else self.builder.product(self._number(factor), place)

    def _bound(self, roundings: int, parts: Sequence[int]) -> _Error:
        """So many roundings and the sum of further errors, if there are any."""
        return _Error(roundings, self._total(parts) if parts else None)

    def _total(self, places: Sequence[int]) -> int:
        return (
            self.builder.total([(1, place) for place in places])[1] if places else self._number(0)
        )

    def _number(self, value: int) -> int:
        return self.builder.number(Fraction(value))

    def _is_power_of_two(self, place: int) -> bool:
        step = self.steps[place]
        if step.kind != "number" or not step.detail:
            return False
        above, below = abs(step.detail.numerator), step.detail.denominator
        return above & (above - 1) == 0 == below & (below - 1)


def _roundings_of(name: str) -> int:
    """To how many roundings a function is right."""
    return FUNCTIONS.get(name, FUNCTIONS["exp"]).roundings


def _is_float(value: Fraction) -> bool:
    """Whether a float holds a number without rounding."""
    below = value.denominator
    return below & (below - 1) == 0 and abs(value.numerator) < 2**53

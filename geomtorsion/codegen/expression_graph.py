"""Expression graph: outputs over named arguments, equal parts once, printed for any engine.

With the check whether roots still have the signs with which they were read, at given numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import mpmath
import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from geomtorsion.codegen.evaluation import exact_values
from geomtorsion.codegen.poles import pole_values
from geomtorsion.codegen.printers import (
    FUNCTIONS,
    Body,
    Expression,
    Number,
    compiled,
    heyoka_expressions,
    python_body,
    python_source,
)
from geomtorsion.codegen.reading import Emitter, Output, Reader
from geomtorsion.codegen.steps import (
    Builder,
    Signed,
    Step,
    above_rounding,
    hoisted,
    jacobian,
    term_sizes,
)
from geomtorsion.codegen.sums import factor as pull_out
from geomtorsion.errors import BranchError
from geomtorsion.exact.element import Element
from geomtorsion.exact.generators import Branch
from geomtorsion.exact.tower import Tower
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import only_fields
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import EXACT_BITS


@exclusive
def graph(
    arguments: Sequence[str],
    outputs: Sequence[Output],
    constants: Collection[str] = (),
    *,
    factor: bool = True,
) -> Graph:
    """The graph of elements, sums of products of elements, and sympy expressions.

    Parameters
    ----------
    arguments
        names in order; symbols and unknown functions by their str.
    outputs
        k of them; elements of several fields, sympy expressions and sums of products may mix.
    constants
        the arguments that stay constant while others change: terms of constants are computed once,
        and products with them cost little.
    factor
        whether common factors of terms are pulled out. Sums that are too long for this stay
        unchanged.

    Raises
    ------
    MissingValueError
        a symbol is not among the arguments.
    ExpressionError
        a function has no numerical form.

    Examples
    --------
    >>> import sympy
    >>> x, y = sympy.symbols("x y")
    >>> made = graph(["x", "y"], [x * (x - y) ** 2, y * (y - x) ** 2])
    >>> [step.kind for step in made.steps]
    ['argument', 'argument', 'sum', 'square', 'product', 'product']
    >>> made.python()(3.0, 1.0)
    (12.0, 4.0)
    """
    reader = Reader(arguments, constants)
    numbers = list(map(reader.output, outputs))
    reader.sums.inline()
    if factor:
        pull_out(reader.sums)
        reader.sums.inline()
    emitter = Emitter(reader)
    steps, places = emitter.builder.needed(emitter.outputs(numbers))
    return Graph(tuple(arguments), steps, places, reader.is_complex)


@dataclass(frozen=True, eq=False)
class Graph:
    """Graph of expressions: shared values are computed once. Equal code makes equal graphs.

    arguments: names, in order.
    steps: values in order; values that no output needs are omitted.
    outputs: sign and position of each.
    is_complex: whether values may be complex where arguments are real.
    """

    arguments: tuple[str, ...]
    steps: tuple[Step, ...] = field(repr=False)
    outputs: tuple[Signed, ...]
    is_complex: bool = False

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @property
    def size(self) -> int:
        """Number of outputs."""
        return len(self.outputs)

    @cached_property
    def operations(self) -> Mapping[str, int]:
        """Number of operations on values that are not constant, by kind.

        A sum of n terms counts n - 1 times, a product with a constant as "scale" and a function
        by its name.

        Examples
        --------
        >>> import sympy
        >>> x, a = sympy.symbols("x a")
        >>> dict(graph(["x", "a"], [sympy.sin(x) ** 2 + a * x + 1], ["a"]).operations)
        {'sin': 1, 'scale': 1, 'square': 1, 'sum': 2}
        """
        count: dict[str, int] = {}
        for step in self.steps:
            if step.constant or step.kind == "argument":
                continue
            kind, times = step.kind, 1
            if kind == "call":
                kind = str(step.detail)
            elif kind == "sum":
                times = len(step.operands) - 1
            elif kind in ("product", "quotient"):
                # A constant numerator makes no quotient cheaper.
                first, second = (self.steps[place].constant for place in step.operands)
                kind = "scale" if second or (first and kind == "product") else kind
            count[kind] = count.get(kind, 0) + times
        return MappingProxyType(count)

    @cached_property
    def key(self) -> str:
        """Key that two graphs share exactly when their code is the same up to argument names."""
        lines = [f"{len(self.arguments)} {self.is_complex} {self.outputs}"]
        for step in self.steps:
            parts = (step.kind, step.detail, step.operands, step.signs, step.constant)
            lines.append(" ".join(map(str, parts)))
        return "\n".join(lines)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Graph):
            return NotImplemented
        return self.arguments == other.arguments and self.key == other.key

    def __hash__(self) -> int:
        return hash((self.arguments, self.key))

    @cached_property
    def python_body(self) -> Body:
        """Statements over a0, a1, ..., and the code of each output after them.

        For code that has more to do than to return the outputs; see `python_source`.
        """
        return python_body(self.steps, self.outputs)

    @cached_property
    def _source(self) -> str:
        return python_source(len(self.arguments), self.python_body)

    def python_source(self) -> str:
        """Source of `values(a0, a1, ...)`, which returns a tuple.

        Functions bear their names in the math module; `compiled` knows all of them.

        Examples
        --------
        >>> import sympy
        >>> x, v = sympy.symbols("x v")
        >>> print(graph(["x", "v"], [2 * x * v**2]).python_source())
        def values(a0, a1):
            return (2.0*(a0*(a1*a1)),)
        """
        return self._source

    def python(self) -> Callable[..., tuple[float, ...]]:
        """A function of floats.

        It raises ZeroDivisionError, ValueError or OverflowError where there is no value, and
        takes no complex graphs; `numpy` does.
        """
        return compiled(self._source, "floats")

    def numpy(self, real: type[np.floating[Any]] = np.float64) -> Callable[..., np.ndarray]:
        """A function of numbers or arrays of one shape; it returns an array (size, *shape).

        real: the type of numbers in which it works, where values are real.
        Where there is no value, the result is infinite or NaN, without a warning.

        Examples
        --------
        >>> import sympy
        >>> x = sympy.Symbol("x")
        >>> graph(["x"], [1 / x, sympy.sqrt(x)]).numpy()([-1.0, 0.0, 4.0])
        array([[-1.  ,   inf,  0.25],
               [  nan,  0.  ,  2.  ]])
        """
        inner = compiled(self._source, "arrays")
        dtype, size = complex if self.is_complex else real, self.size

        def values(*arguments: ArrayLike) -> np.ndarray:
            arrays = [np.asarray(argument, dtype=dtype) for argument in arguments]
            shapes = {array.shape for array in arrays} - {()}
            shape = shapes.pop() if len(shapes) == 1 else np.broadcast_shapes(*shapes)
            result = np.empty((size, *shape), dtype=dtype)
            with np.errstate(all="ignore"):
                for k, value in enumerate(inner(*arrays)):
                    result[k] = value
            return result

        return values

    def heyoka(self, known: Mapping[str, Expression], number: Number) -> list[Expression]:
        """Expressions of heyoka.

        known: name of an argument -> its expression.
        number: p, q -> p/q as expression at the precision in use.
        """
        places = [known.get(name) for name in self.arguments]
        return heyoka_expressions(self.steps, self.outputs, places, number)

    @property
    def has_series(self) -> bool:
        """Whether heyoka knows the Taylor series of all functions in it."""
        called = (step.detail for step in self.steps if step.kind == "call")
        return all(name == "power" or FUNCTIONS[name].heyoka for name in called)

    def exactly(self, values: Sequence[Any], bits: int = EXACT_BITS) -> list[Fraction | mpmath.mpf]:
        """Values at one point: fractions where rational, else numbers of a given precision.

        Examples
        --------
        >>> import sympy
        >>> x = sympy.Symbol("x")
        >>> third, root = graph(["x"], [x / 3, sympy.sqrt(x)]).exactly([2])
        >>> third, root**2 - 2 < 1e-100
        (Fraction(2, 3), True)
        """
        return exact_values(self.steps, self.outputs, values, bits)

    def sizes(self, *arguments: ArrayLike) -> np.ndarray:
        """Sums of the absolute sizes of all terms: the scale against which rounding is measured.

        Arguments are numbers or arrays of one shape; the result is an array (size, *shape).

        Examples
        --------
        >>> import sympy
        >>> x, y = sympy.symbols("x y")
        >>> graph(["x", "y"], [x**2 - y**2]).sizes(2.0, 2.0)
        array([8.])
        """
        return self._sizes.numpy()(*arguments)

    @cached_property
    def _sizes(self) -> Graph:
        return Graph(self.arguments, *term_sizes(self.steps, self.outputs))

    @cached_property
    def poles(self) -> Graph:
        """Values at whose zeros an output may have no value, such as denominators.

        Examples
        --------
        >>> import sympy
        >>> x = sympy.Symbol("x")
        >>> graph(["x"], [1 / (x**2 * (x - 3)), sympy.exp(-x)]).poles.python()(5.0)
        (-2.0, 5.0)
        """
        return Graph(self.arguments, *pole_values(self.steps), self.is_complex)

    def above_rounding(self) -> Graph:
        """The outputs (for roots, the radicands) minus what rounding in doubles may add.

        Examples
        --------
        >>> import sympy
        >>> x = sympy.Symbol("x")
        >>> graph(["x"], [sympy.sqrt(1 - x**2)]).above_rounding().python()(1 - 2**-52)[0] > 0
        False
        """
        return Graph(self.arguments, *above_rounding(self.steps, self.outputs), self.is_complex)

    def with_factors(
        self, arguments: Mapping[str, str], outputs: Sequence[str], more: Sequence[str]
    ) -> Graph:
        """The graph with constant factors of arguments and outputs, which are further arguments.

        arguments: name of an argument -> name of its factor; outputs: names of factors, one for
        each output, or none; more: names of all factors in order.

        Examples
        --------
        >>> import sympy
        >>> made = graph(["x"], [sympy.Symbol("x") ** 2])
        >>> made.with_factors({"x": "a"}, ["b"], ["a", "b"]).python()(3.0, 2.0, 10.0)
        (360.0,)
        """
        first = len(self.arguments)
        builder, places = Builder(), list[int]()
        factors = {name: builder.argument(first + k, constant=True) for k, name in enumerate(more)}
        for step in self.steps:
            inner = tuple(places[place] for place in step.operands)
            place = builder.add(
                step.kind, inner, step.detail, signs=step.signs, constant=step.constant
            )
            if step.kind == "argument":
                factor = arguments.get(self.arguments[step.detail])
                place = place if factor is None else builder.product(place, factors[factor])
            places.append(place)
        signed = [(sign, places[place]) for sign, place in self.outputs]
        if outputs:
            pairs = zip(signed, outputs, strict=True)
            signed = [(s, builder.product(place, factors[name])) for (s, place), name in pairs]
        return Graph((*self.arguments, *more), *builder.needed(signed), self.is_complex)

    def hoisted(self, first: int, name: str) -> tuple[Graph, Graph]:
        """The graph over constants that are computed once, and the graph that computes them.

        first: position of the first constant argument; all after it are also constant, and are
        the arguments of the second graph; name: of the new arguments, which are numbered.

        Examples
        --------
        >>> import sympy
        >>> x, a, b = sympy.symbols("x a b")
        >>> made, constants = graph(["x", "a", "b"], [x * a / b], ["a", "b"]).hoisted(1, "c")
        >>> made.arguments, constants.python()(3.0, 2.0), made.python()(10.0, 3.0, 2.0, 1.5)
        (('x', 'a', 'b', 'c 0'), (1.5,), (15.0,))
        """
        rest, constants = hoisted(self.steps, self.outputs, len(self.arguments), first)
        more = (f"{name} {k}" for k in range(len(constants[1])))
        return (
            Graph((*self.arguments, *more), *rest, self.is_complex),
            Graph(self.arguments[first:], *constants, self.is_complex),
        )

    def derivative(self, names: Sequence[str]) -> Graph:
        """All derivatives with respect to arguments, ordered by output.

        Examples
        --------
        >>> import sympy
        >>> x, y = sympy.symbols("x y")
        >>> graph(["x", "y"], [x**2 * y, sympy.sin(x)]).derivative(["x", "y"]).python()(0.0, 3.0)
        (0.0, 0.0, 1.0, 0.0)
        """
        positions = [self.arguments.index(name) for name in names]
        steps, outputs = jacobian(self.steps, self.outputs, positions)
        return Graph(self.arguments, steps, outputs, self.is_complex)


# Two readings of one root that differ by more than this part of their size are of two branches.
# Branches differ by a sign, or a part of a turn; rounding is smaller than both.
APART = 1e-3


@exclusive
def branch_check(fields: Iterable[Tower], names: Sequence[str]) -> BranchCheck | None:
    """The check of all branches on which elements of some fields rely; None where there is none.

    names: of the arguments; elements in these do not rely on branches that depend on others.
    """
    own_names = set(names)
    branches = [
        (field.is_complex, branch)
        for field in dict.fromkeys(fields)
        for branch in field.relied_on
        if {symbol.name for symbol in branch.radical.free_symbols} <= own_names
    ]
    return _kept(BranchCheck(tuple(names), tuple(branches))) if branches else None


@dataclass(frozen=True, eq=False)
class BranchCheck:
    """Whether roots have the signs with which they were read.

    names: of the arguments. branches: each with whether it is about complex numbers.
    """

    names: tuple[str, ...]
    branches: tuple[tuple[bool, Branch], ...]

    # Checks of the very same branches are the same; whether others are may be undecided.
    @property
    def _key(self) -> tuple[object, ...]:
        return self.names, *((is_complex, id(branch)) for is_complex, branch in self.branches)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, BranchCheck) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    @cached_property
    def _graph(self) -> Graph:
        """For each branch the root as written and as read, or a quantity that must be positive."""
        outputs: list[Element | sp.Expr] = []
        for is_complex, branch in self.branches:
            if branch.holds is not None and not is_complex:
                outputs += [branch.holds, sp.S.Zero]
            else:
                outputs += [branch.radical, branch.read_as]
        joint_graph = graph(self.names, outputs, factor=False)
        # Points of complex frames are complex, also where nothing in a root is.
        is_complex = joint_graph.is_complex or any(is_complex for is_complex, _ in self.branches)
        return replace(joint_graph, is_complex=is_complex)

    def broken(self, *values: ArrayLike) -> np.ndarray:
        """For each branch whether it is left, shape (branches, ...)."""
        quantities = self._graph.numpy()(*values)
        written, read = quantities[0::2], quantities[1::2]
        result = np.zeros(written.shape, dtype=bool)
        with np.errstate(all="ignore"):
            for k, (is_complex, branch) in enumerate(self.branches):
                if branch.holds is not None and not is_complex:
                    result[k] = written[k].real < 0
                else:
                    size = np.maximum(np.abs(written[k]), np.abs(read[k]))
                    result[k] = np.abs(written[k] - read[k]) > APART * size
        return result

    def refuse(self, *values: ArrayLike) -> None:
        """Raise BranchError where a branch is left; the message names it and the first point."""
        broken = self.broken(*values)
        if not broken.any():
            return
        first = tuple(int(k) for k in np.argwhere(broken)[0])
        broad = np.broadcast_arrays(*values)
        needed = {symbol.name for symbol in self.branches[first[0]][1].radical.free_symbols}
        point = ", ".join(
            f"{name} = {array[first[1:]]:.6g}"
            for name, array in zip(self.names, broad, strict=True)
            if name in needed
        )
        branch = self.branches[first[0]][1]
        advice = "State a domain around the point; several readings are decided there."
        if isinstance(branch.radical, sp.Pow):
            advice = (
                "State a domain around the point (roots are read as they are there), or the value "
                f"that is meant: branches={{{branch.radical}: ...}}."
            )
        raise BranchError(f"{branch}; got the point {point}. {advice}")


@lru_cache(maxsize=64)
def _kept(check: BranchCheck) -> BranchCheck:
    """The first of equal checks: its code is made once."""
    return check

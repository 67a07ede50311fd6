"""Compile: elements into one NumPy function with shared subexpressions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.errors import MissingValueError, SingularPointError
from geomtorsion.exact.form import Sum, form
from geomtorsion.exact.generators import Generator

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from geomtorsion.exact.element import Element

_NUMPY_NAMES = {
    "atan": "arctan", "asin": "arcsin", "acos": "arccos", "asinh": "arcsinh",
    "acosh": "arccosh", "atanh": "arctanh", "atan2": "arctan2",
}  # fmt: skip


def python_function(
    source: str, names: Mapping[str, Any], name: str = "values"
) -> Callable[..., Any]:
    """A function of source that we have written ourselves, by its name there."""
    table: dict[str, Any] = dict(names)
    # The source is made of our own names and numbers; no text of a user gets into it.
    exec(compile(source, "<geomtorsion>", "exec"), table)  # noqa: S102
    return table[name]


def numpy_function(
    elements: Sequence[Element], symbols: Sequence[Any], *, check: bool = True
) -> Callable[..., Any]:
    """A function of arrays that gives the values of all elements at once.

    Parameters
    ----------
    elements
        what to compute, k of them.
    symbols
        the arguments in order: sympy symbols, or unknown functions such as f(r).
    check
        whether a value that is not finite raises instead of being returned.

    Returns
    -------
    Function of len(symbols) numbers or arrays of one shape; it returns an array of shape
    (k, *shape).  Its source is kept in the attribute `source`.

    Raises
    ------
    MissingValueError
        an element contains a symbol that is not among the arguments.
    SingularPointError
        (from the function) a value is not finite; the message names element and point.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> r = sympy.Symbol("r")
    >>> f = numpy_function([Field([r]).read(r**2 + 1)], [r])
    >>> f([1.0, 2.0])
    array([[2., 5.]])
    """
    import numpy

    program = Program(symbols, bool(elements) and elements[0].field.is_complex)
    results = [program.element(element) for element in elements]
    arguments = ", ".join(f"a{k}" for k in range(len(symbols)))
    source = "\n    ".join(
        [
            f"def values({arguments}):",
            *program.lines,
            f"return ({', '.join(results)}{',' * bool(results)})",
        ]
    )
    names: dict[str, Any] = {name: getattr(numpy, name) for name in program.functions}
    if program.special:
        from scipy import special

        names.update({name: getattr(special, name) for name in program.special})
    inner = python_function(source, names)
    dtype = complex if program.complex else float

    def function(*values: Any) -> Any:
        if len(values) != len(symbols):
            raise MissingValueError(
                f"{len(symbols)} arguments are needed ({', '.join(map(str, symbols))}), "
                f"{len(values)} came"
            )
        arrays = [numpy.asarray(value, dtype=dtype) for value in values]
        shape = numpy.broadcast_shapes(*(array.shape for array in arrays))
        result = numpy.empty((len(elements), *shape), dtype=dtype)
        with numpy.errstate(all="ignore"):
            for k, value in enumerate(inner(*arrays)):
                result[k] = value
        if check and not numpy.isfinite(result).all():
            raise SingularPointError(_where_singular(result, arrays, elements, symbols))
        return result

    # Functions have room for attributes of their own, which types do not say.
    function.source = source  # type: ignore[attr-defined]
    return function


_SCIPY_NAMES = {
    "erf": "erf", "erfc": "erfc", "erfi": "erfi", "gamma": "gamma", "loggamma": "gammaln",
    "besselj": "jv", "bessely": "yv", "besseli": "iv", "besselk": "kv", "Ei": "expi",
}  # fmt: skip


class Program:
    """Statements in order, each value computed once."""

    def __init__(self, symbols: Sequence[Any], complex_field: bool = False) -> None:
        self._arguments = {str(symbol): f"a{k}" for k, symbol in enumerate(symbols)}
        self.lines: list[str] = []
        self.functions: set[str] = set()
        self.special: set[str] = set()
        self.complex = False
        self._field_is_complex = complex_field
        self._names: dict[Any, str] = {}

    def _stored(self, key: Any, code: str) -> str:
        name = self._names[key] = f"t{len(self.lines)}"
        self.lines.append(f"{name} = {code}")
        return name

    def element(self, element: Element) -> str:
        """The code of an element."""
        written = form(element)
        above, below = [], []
        for base, exponent in written.powers:
            (above if exponent > 0 else below).append(self._power(base, abs(exponent)))
        value = written.coefficient
        if abs(value.p) != 1 or not above:
            above.insert(0, _integer(abs(value.p)))
        if value.q != 1:
            below.insert(0, _integer(value.q))
        code = "*".join(above)
        if below:
            code += f"/({'*'.join(below)})"
        return f"-{code}" if value.p < 0 else code

    def _power(self, base: Generator | Sum, exponent: int) -> str:
        known = self._names.get((base, exponent))
        if known is not None:
            return known
        if exponent == 1:
            code = self._generator(base) if isinstance(base, Generator) else self._sum(base)
            if code.isidentifier():
                self._names[base, 1] = code
                return code
        else:
            half = self._power(base, exponent // 2)
            code = f"{half}*{half}" + (f"*{self._power(base, 1)}" if exponent % 2 else "")
        return self._stored((base, exponent), code)

    def _sum(self, base: Sum) -> str:
        parts = []
        for value, monomial in base.terms:
            factors = [self._power(generator, exponent) for generator, exponent in monomial]
            if abs(value) != 1 or not factors:
                number = _integer(abs(value.p))
                factors.insert(0, number if value.q == 1 else f"({number}/{_integer(value.q)})")
            parts.append(("-" if value < 0 else "+") + "*".join(factors))
        return "".join(parts).removeprefix("+")

    def _generator(self, generator: Generator) -> str:
        """The code of a generator."""
        shown = str(generator.shown)
        if shown in self._arguments:
            return self._arguments[shown]
        kind, argument = generator.kind, generator.argument
        if kind in ("root", "log", "primitive") and self._field_is_complex:
            self.complex = True
        if kind == "imaginary":
            self.complex = True
            return "1j"
        if kind in ("cos", "sin", "cosh", "sinh", "chebyshev"):
            return self._called("cos" if kind == "chebyshev" else kind, argument[0])
        if kind in ("exp", "log"):
            return self._called(kind, argument)
        if kind == "root" and generator.tail is not None:
            if generator.degree == 2:
                return self._called("sqrt", generator.tail)
            return f"({self.element(generator.tail)})**(1/{generator.degree})"
        if kind == "primitive":
            return self._primitive(type(generator.shown).__name__, argument)
        if not generator.depends:
            return repr(float(generator.shown))
        if kind == "opaque" and type(generator.shown).__name__ in _SCIPY_NAMES:
            name = _SCIPY_NAMES[type(generator.shown).__name__]
            self.special.add(name)
            return f"{name}({', '.join(self.element(part) for part in argument)})"
        if kind == "opaque":
            raise MissingValueError(
                f"{generator.shown} has no NumPy form here; evaluate it point by point with "
                ".evaluate(point)"
            )
        raise MissingValueError(
            f"{generator.shown} is not among the arguments "
            f"({', '.join(self._arguments) or 'none'}); add it to the symbols"
        )

    def _primitive(self, name: str, argument: Any) -> str:
        if name in ("acot", "acoth"):
            partner = {"acot": "arctan", "acoth": "arctanh"}[name]
            return self._called(partner, 1 / argument[0])
        return self._called(_NUMPY_NAMES[name], *argument[2])

    def _called(self, name: str, *arguments: Element) -> str:
        self.functions.add(name)
        return f"{name}({', '.join(self.element(argument) for argument in arguments)})"


def _integer(value: Any) -> str:
    """An integer as floating-point code."""
    return repr(float(int(value)))


def _where_singular(
    result: Any, arrays: list[Any], elements: Sequence[Element], symbols: Sequence[Any]
) -> str:
    """The message that names the first value that is not finite."""
    import numpy

    first = tuple(int(i) for i in numpy.argwhere(~numpy.isfinite(result))[0])
    broad = numpy.broadcast_arrays(*arrays)
    point = ", ".join(
        f"{symbol} = {array[first[1:]]:.6g}" for symbol, array in zip(symbols, broad, strict=True)
    )
    return (
        f"{elements[first[0]]} has no finite value at {point}; "
        "move the point away from the edge of the chart"
    )

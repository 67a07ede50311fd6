"""numpy_code: quantities as NumPy functions that run without this package."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import sympy
from sympy.core.function import AppliedUndef
from sympy.printing.numpy import NumPyPrinter

from geomtorsion.pictures.quantities import Quantity
from geomtorsion.pictures.text import plain_text
from geomtorsion.spaces.space import Space

# Names that the written functions use themselves.
_TAKEN = ("numpy", "result")
# Symbols, unknown functions and derivatives by the names of the arguments that stand for them.
Names = Mapping[sympy.Basic, str]


def python_of(space: Space, quantities: Sequence[Quantity]) -> str:
    """A module with one function for each quantity; its arguments are numbers or arrays."""
    title = f"{space.name}: {space.title}".replace("\\", "/").replace('"', "'")
    head = f'"""{title}. Exact components, computed by geomtorsion."""\n\nimport numpy\n'
    return "\n\n".join([head, *(_function(space, chosen) for chosen in quantities)])


def _function(space: Space, chosen: Quantity) -> str:
    """Source of one function."""
    frame = space.frame
    components = {index: element.sympy for index, element in chosen.nonzero.items()}
    arguments = _arguments([*frame.coordinates, *frame.parameters], components.values())
    renamed = {old: sympy.Symbol(new) for old, new in arguments.items()}
    shared, values = sympy.cse(
        [_replaced(value, renamed) for value in components.values()],
        symbols=sympy.numbered_symbols("_t"),
    )
    printer = NumPyPrinter()
    names = ", ".join(arguments.values())
    kind = "complex" if frame.complex else "float"
    rank = len(chosen.tensor.slots)
    size = f"({frame.dimension},) * {rank}" if rank else "()"
    lines = [
        f"def {chosen.entry.name}({names}):",
        f'    """{_description(chosen, arguments)}"""',
        f"    {names}, = ({_each('numpy.asarray({}, ' + kind + ')', arguments)},)",
        f"    shape = numpy.broadcast_shapes({_each('{}.shape', arguments)})",
        f"    result = numpy.zeros(shape + {size}, {kind})",
    ]
    lines += [f"    {symbol} = {printer.doprint(value)}" for symbol, value in shared]
    for index, value in zip(components, values, strict=True):
        place = ", ".join(["...", *map(str, index)])
        lines.append(f"    result[{place}] = {printer.doprint(value)}")
    return "\n".join([*lines, "    return result\n"])


def _each(pattern: str, arguments: Names) -> str:
    """The pattern for each argument, separated by commas."""
    return ", ".join(pattern.format(name) for name in arguments.values())


def _description(chosen: Quantity, arguments: Names) -> str:
    """Docstring of a function: what it is, its axes, and what replaces unknown functions."""
    axes = ", ".join(chosen.letters)
    text = f"{chosen.entry.title} {chosen.text_label}: {chosen.entry.equation}"
    if axes:
        text += f"; last axes ({axes}), slots {chosen.tensor.slots}"
    unknown = [f"{new} is {plain_text(old)}" for old, new in arguments.items() if not old.is_Symbol]
    return ". ".join([text, *unknown]) + "."


def _arguments(
    symbols: Sequence[sympy.Symbol], values: Iterable[sympy.Expr]
) -> dict[sympy.Basic, str]:
    """Arguments of a function: symbols, then the unknown functions and derivatives that occur."""
    found: set[sympy.Basic] = set()
    for value in values:
        found |= value.atoms(AppliedUndef, sympy.Derivative)
    # A function that occurs only inside a derivative is no argument by itself.
    functions = sorted(found, key=lambda part: (part.is_Derivative, str(part)))
    arguments: dict[sympy.Basic, str] = {}
    for part in (*symbols, *functions):
        name = _identifier(part)
        while name in arguments.values() or name in _TAKEN:
            name += "_"
        arguments[part] = name
    return arguments


def _identifier(part: sympy.Basic) -> str:
    """A Python name for a symbol, a function a(t) or a derivative: a, a_t, a_t_t."""
    if part.is_Symbol:
        return NumPyPrinter().doprint(part)
    if not part.is_Derivative:
        return part.func.__name__
    by = [variable.name for variable, count in part.variable_count for _ in range(int(count))]
    return "_".join([part.expr.func.__name__, *by])


def _replaced(value: sympy.Expr, renamed: Mapping[sympy.Basic, sympy.Symbol]) -> sympy.Expr:
    """The expression in terms of the arguments; derivatives before the functions inside them."""
    order = sorted(renamed, key=lambda part: (not part.is_Derivative, -len(str(part))))
    return value.xreplace({part: renamed[part] for part in order})

"""wolfram: components as Mathematica rules."""

from __future__ import annotations

from collections.abc import Sequence

import sympy
from sympy.printing.mathematica import MCodePrinter

from geomtorsion.pictures.quantities import Quantity
from geomtorsion.spaces.space import Space

# Single capitals that Mathematica has taken for itself.
_TAKEN = frozenset("CDEIKNO")


def mathematica_of(space: Space, quantities: Sequence[Quantity]) -> str:
    """One assignment for each quantity: a sparse array with indices from 1."""
    parts = [f"(* {space.name}: {space.title}; indices count from 1 *)"]
    parts += [_assignment(space, chosen) for chosen in quantities]
    return "\n\n".join(parts)


def _assignment(space: Space, chosen: Quantity) -> str:
    entry, tensor = chosen.entry, chosen.tensor
    first, *rest = entry.name.split("_")
    name = first + "".join(part.capitalize() for part in rest)
    comment = f"(* {entry.title}, slots {tensor.slots or 'none'} *)"
    printer = _Printer()
    written = {i: printer.doprint(_renamed(x.sympy)) for i, x in chosen.nonzero.items()}
    if not tensor.slots:
        return f"{comment}\n{name} = {written.get((), '0')};"
    rules = [
        f"{{{', '.join(str(k + 1) for k in index)}}} -> {value}" for index, value in written.items()
    ]
    size = ", ".join([str(space.frame.dimension)] * len(tensor.slots))
    body = ",\n  ".join(rules)
    return f"{comment}\n{name} = SparseArray[{{\n  {body}}}, {{{size}}}];"


def _renamed(expression: sympy.Expr) -> sympy.Expr:
    """The expression with symbols that Mathematica accepts: no underscores, no taken letters."""
    names = {}
    for symbol in expression.free_symbols:
        name = symbol.name.replace("_", "")
        name = f"{name}symbol" if name in _TAKEN else name
        if name != symbol.name:
            names[symbol] = sympy.Symbol(name)
    return expression.xreplace(names)


class _Printer(MCodePrinter):
    """sympy's printer, with derivatives that are not held."""

    def _print_Derivative(self, expr: sympy.Derivative) -> str:
        by = [f"{{{self._print(v)}, {int(count)}}}" for v, count in expr.variable_count]
        return f"D[{self._print(expr.expr)}, {', '.join(by)}]"

"""formats: the components of a space as text, LaTeX, Mathematica rules and NumPy functions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

import sympy
import typer
from sympy.core.function import AppliedUndef
from sympy.printing.codeprinter import PrintMethodNotImplementedError
from sympy.printing.mathematica import MCodePrinter
from sympy.printing.numpy import NumPyPrinter, SciPyPrinter

from geomtorsion.errors import CoordinateError, ExpressionError
from geomtorsion.geometry import Frame
from geomtorsion.geometry.assumption import assumption_of
from geomtorsion.geometry.notation import open_mark
from geomtorsion.pictures.latex import text_label, text_marks
from geomtorsion.pictures.quantities import Quantity
from geomtorsion.pictures.sections import aligned
from geomtorsion.pictures.text import expression_text, plain_text
from geomtorsion.spaces import Space
from geomtorsion.support.outgoing import latex_comment, mathematica_comment, one_line, python_text

# Letters with bars come first; otherwise their bars would remain.
_ASCII = {
    "Γ\u0304": "Gamma_bar", "R\u0304": "R_bar", "Γ": "Gamma", "Φ": "Phi", "δ": "delta",
    "η": "eta", "ω": "omega", "∂": "d", "∧": "^", "θ": "theta",
}  # fmt: skip


def text_of(
    space: Space, quantities: Sequence[Quantity], *, greek: bool = True, every: bool = False
) -> str:
    """A heading and the quantities, one paragraph each; `every` shows what symmetry repeats."""
    parts = [_heading(space, greek=greek)]
    parts += [_paragraph(chosen, greek=greek, every=every) for chosen in quantities]
    return "\n\n".join(parts)


def in_ascii(text: str) -> str:
    """Symbols of the catalogue in letters that every terminal has."""
    for symbol, name in _ASCII.items():
        text = text.replace(symbol, name)
    return text


def _region(frame: Frame) -> list[str]:
    """The region that was assumed, if one was, as a line."""
    try:
        region = frame.region
    except CoordinateError as error:
        return [f"region: {error}"]
    return [f"region {region}, assumed; add domain = [...] for another one"] * region.assumed


def _heading(space: Space, *, greek: bool) -> str:
    frame, n = space.frame, space.frame.dimension

    def written(expressions: Iterable[sympy.Basic]) -> str:
        return ", ".join(expression_text(part, greek=greek) for part in expressions)

    same = space.title == space.name
    title = one_line(space.name if same else f"{space.name}: {space.title}")
    facts = [f"coordinates {written(frame.coordinates)}"]
    facts += [f"parameters {written(frame.parameters)}"] * bool(frame.parameters)
    facts += [f"domain {written(frame.domain)}"] * bool(frame.domain)
    facts += _region(frame)
    diagonal = [frame.eta[i, i] for i in range(n)]
    if len(frame.eta.components.nonzero) == n and set(diagonal) <= {1, -1}:
        facts.append("signature " + "".join("+" if sign == 1 else "-" for sign in diagonal))
    else:
        rows = ("[" + written(frame.eta[i, j] for j in range(n)) + "]" for i in range(n))
        facts.append(f"frame metric [{', '.join(rows)}]")
    facts += [f"{written([name])} = {written([what])}" for name, what in frame.names.items()]
    facts += [
        f"root {written([b.radical])} read as {written([b.read_as])}: right where {b.condition}"
        for b in frame.field.branches
    ]
    return "\n".join([typer.style(title, bold=True), *facts])


def _paragraph(chosen: Quantity, *, greek: bool, every: bool) -> str:
    entry, tensor = chosen.entry, chosen.tensor
    adapted = str if greek else in_ascii
    symbol, label = adapted(entry.symbol), adapted(chosen.text_label)
    title = typer.style(entry.title, bold=True)
    components = chosen.nonzero if every else chosen.independent
    if not components:
        return f"{title}  {label} = 0"
    if not tensor.slots:
        value = expression_text(chosen.written(components[()]), greek=greek)
        return f"{title}  {symbol} = {value}{open_mark(tensor, ())}"
    # Align the equal signs.
    lines = [f"{title}  {label}   [{adapted(entry.equation)}]"]
    labels = {
        index: text_label(symbol, text_marks(tensor, index, greek=greek), tensor.slots)
        for index in components
    }
    width = max(map(_width, labels.values()))
    for index, element in components.items():
        gap = " " * (width - _width(labels[index]))
        value = expression_text(chosen.written(element), greek=greek)
        lines.append(f"  {labels[index]}{gap} = {value}{open_mark(tensor, index)}")
    total = len(chosen.nonzero)
    if total > len(components):
        rest = total - len(components)
        lines.append(f"  ({rest} more follow{'s' * (rest == 1)} by symmetry)")
    return "\n".join(lines)


def _width(label: str) -> int:
    """Columns that a label takes: a bar above a letter takes none."""
    return len(label) - label.count("\u0304")


def latex_of(space: Space, quantities: Sequence[Quantity], *, every: bool = False) -> str:
    """One align* environment for each quantity; needs amsmath."""
    head = [f"{space.name}: {space.title}", r"needs \usepackage{amsmath}"]
    head += [f"{name} = {what}" for name, what in space.frame.names.items()]
    head += filter(None, [assumption_of(space.frame)])
    parts = ["\n".join(map(latex_comment, head))]
    parts += [aligned(chosen, every=every) for chosen in quantities]
    return "\n\n".join(parts)


# Single capitals that Mathematica reserves for itself.
_CAPITALS = frozenset("CDEIKNO")


def mathematica_of(space: Space, quantities: Sequence[Quantity]) -> str:
    """One assignment for each quantity: a sparse array with indices from 1."""
    region = filter(None, [assumption_of(space.frame)])
    parts = [mathematica_comment(f"{space.name}: {space.title}; indices count from 1")]
    parts += map(mathematica_comment, region)
    renamed = _renamed(x.sympy for chosen in quantities for x in chosen.nonzero.values())
    parts += [_assignment(space, chosen, renamed) for chosen in quantities]
    return "\n\n".join(parts)


def _assignment(space: Space, chosen: Quantity, renamed: Mapping[sympy.Basic, sympy.Basic]) -> str:
    entry, tensor = chosen.entry, chosen.tensor
    first, *rest = entry.name.split("_")
    name = first + "".join(part.capitalize() for part in rest)
    comment = mathematica_comment(
        f"{entry.title}, slots {tensor.slots or 'none'}{_open(chosen, first=1)}"
    )
    printer = _MathematicaPrinter()
    written = {i: printer.doprint(x.sympy.xreplace(renamed)) for i, x in chosen.nonzero.items()}
    if not tensor.slots:
        return f"{comment}\n{name} = {written.get((), '0')};"
    rules = [
        f"{{{', '.join(str(k + 1) for k in index)}}} -> {value}" for index, value in written.items()
    ]
    size = ", ".join([str(space.frame.dimension)] * len(tensor.slots))
    body = ",\n  ".join(rules)
    return f"{comment}\n{name} = SparseArray[{{\n  {body}}}, {{{size}}}];"


def _renamed(expressions: Iterable[sympy.Expr]) -> dict[sympy.Basic, sympy.Basic]:
    """Symbols and unknown functions -> names that Mathematica accepts, without reserved capitals.

    Different symbols get different names, without underscores.
    """
    parts = sympy.Tuple(*expressions).atoms(sympy.Symbol, AppliedUndef)
    named = {part: part.name if part.is_Symbol else part.func.__name__ for part in parts}
    names: dict[str, str] = {}
    # Names that need no change come first, so that no other symbol takes them.
    for name in sorted(set(named.values()), key=lambda name: (name != _plain(name), name)):
        new = _plain(name)
        while new in names.values():
            new += "symbol"
        names[name] = new
    symbols: dict[sympy.Basic, sympy.Basic] = {
        part: sympy.Symbol(names[name])
        for part, name in named.items()
        if part.is_Symbol and names[name] != name
    }
    functions = {
        part: sympy.Function(names[name])(*(each.xreplace(symbols) for each in part.args))
        for part, name in named.items()
        if not part.is_Symbol and names[name] != name
    }
    return symbols | functions


def _plain(name: str) -> str:
    """A name of letters and digits only, which is not a reserved capital."""
    name = re.sub(r"\W|_", "", name) or "symbol"
    return f"{name}symbol" if name in _CAPITALS else name


class _MathematicaPrinter(MCodePrinter):
    """sympy's printer, with evaluated derivatives and derivatives at arbitrary positions."""

    def _print_Derivative(self, expr: sympy.Derivative) -> str:
        by = [f"{{{self._print(v)}, {int(count)}}}" for v, count in expr.variable_count]
        return f"D[{self._print(expr.expr)}, {', '.join(by)}]"

    def _print_Subs(self, expr: sympy.Subs) -> str:
        pairs = zip(expr.variables, expr.point, strict=True)
        rules = (f"{self._print(name)} -> {self._print(place)}" for name, place in pairs)
        return f"({self._print(expr.expr)} /. {{{', '.join(rules)}}})"


# Names that the written functions use themselves.
_OWN_NAMES = ("numpy", "result", "shape", "float", "complex")
# Symbols, unknown functions and derivatives -> name of the argument that represents them.
Names = Mapping[sympy.Basic, str]


def _open(chosen: Quantity, first: int = 0) -> str:
    """Which components may vanish or not, for a comment; first: the number of the first index."""
    if not chosen.undecided:
        return ""
    places = ", ".join(str([k + first for k in index]) for index in chosen.undecided)
    return f"; undecided whether zero: {places}"


def python_of(space: Space, quantities: Sequence[Quantity]) -> str:
    """A module with one function for each quantity; its arguments are numbers or arrays."""
    title, region = python_text(f"{space.name}: {space.title}"), assumption_of(space.frame)
    about = f"{title}. Exact components, computed by geomtorsion."
    about += f" They hold {python_text(region)}." if region else ""
    head = f'"""{about}"""\n\nimport numpy\n'
    functions = [_function(space, chosen) for chosen in quantities]
    if any("scipy.special" in function for function in functions):
        head += "import scipy.special\n"
    return "\n\n".join([head, *functions])


class _PythonPrinter(SciPyPrinter):
    """Functions of NumPy, and special functions of SciPy."""

    def _print_Pi(self, expr: sympy.Basic) -> str:
        return "numpy.pi"

    def _print_Exp1(self, expr: sympy.Basic) -> str:
        return "numpy.e"

    def _print_LambertW(self, expr: sympy.Basic) -> str:
        # SciPy's function is complex; the result is nan where it is not real.
        value = f"scipy.special.lambertw({', '.join(map(self._print, expr.args))})"
        return f"numpy.where(numpy.isreal({value}), {value}.real, numpy.nan)"

    def _print_erfi(self, expr: sympy.Basic) -> str:
        return f"scipy.special.erfi({self._print(expr.args[0])})"

    def doprint(self, expr: sympy.Basic) -> str:
        """The code of an expression.

        Raises
        ------
        ExpressionError
            it has a function that neither NumPy nor SciPy has.
        """
        try:
            return super().doprint(expr)
        except PrintMethodNotImplementedError:
            names = sorted(str(part.func) for part in expr.atoms(sympy.Function))
            raise ExpressionError(
                f"--format python: expected functions that NumPy or SciPy have, got one of "
                f"{', '.join(dict.fromkeys(names))}. Use --format json or mathematica."
            ) from None


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
    printer = _PythonPrinter()
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
    """Docstring of a function: its quantity, its axes, and the names for unknown functions."""
    axes = ", ".join(chosen.letters)
    text = f"{chosen.entry.title} {chosen.text_label}: {chosen.entry.equation}"
    if axes:
        text += f"; last axes ({axes}), slots {chosen.tensor.slots}"
    text += _open(chosen)
    unknown = [f"{new} is {plain_text(old)}" for old, new in arguments.items() if not old.is_Symbol]
    return ". ".join([text, *unknown]) + "."


def _arguments(
    symbols: Sequence[sympy.Symbol], values: Iterable[sympy.Expr]
) -> dict[sympy.Basic, str]:
    """Arguments of a function: symbols, then the unknown functions and derivatives that occur."""
    terms: set[sympy.Basic] = set()
    for value in values:
        # The slope of f at 2*r is one argument; nothing inside it is another argument.
        elsewhere = value.atoms(sympy.Subs)
        rest = value.xreplace(dict.fromkeys(elsewhere, sympy.S.One))
        terms |= elsewhere | rest.atoms(AppliedUndef, sympy.Derivative)
    # A function that occurs only inside a derivative is not an argument by itself.
    functions = sorted(terms, key=lambda part: (not part.is_Function, str(part)))
    arguments: dict[sympy.Basic, str] = {}
    for part in (*symbols, *functions):
        name = _identifier(part)
        while name in arguments.values() or name in _OWN_NAMES:
            name += "_"
        arguments[part] = name
    return arguments


def _identifier(part: sympy.Basic) -> str:
    """A Python name for a symbol, a function a(t) or a derivative: a, a_t, a_t_t."""
    if part.is_Symbol:
        return NumPyPrinter().doprint(part)
    if isinstance(part, sympy.Subs):
        return _identifier(part.expr)
    if not part.is_Derivative:
        return part.func.__name__
    by = [variable.name for variable, count in part.variable_count for _ in range(int(count))]
    return "_".join([part.expr.func.__name__, *by])


def _replaced(value: sympy.Expr, renamed: Mapping[sympy.Basic, sympy.Symbol]) -> sympy.Expr:
    """The expression in terms of the arguments; derivatives before the functions inside them."""
    order = sorted(renamed, key=lambda part: (not part.is_Derivative, -len(str(part))))
    return value.xreplace({part: renamed[part] for part in order})

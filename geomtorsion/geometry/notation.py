"""Notation: how tensors are written, as text, table and LaTeX, with index positions visible."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import sympy as sp
from sympy.printing.pretty.stringpict import prettyForm

from geomtorsion.errors import AllowanceError, LimitError, TensorIndexError
from geomtorsion.exact.printing import TexPrinter, TextPrinter
from geomtorsion.geometry.assumption import assumption_latex, assumption_of
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import drawn_by, latex_of
from geomtorsion.support.outgoing import html_text

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry.frame import Frame
    from geomtorsion.geometry.tensor import Tensor

# Names of the values of an index, and values that are chosen: {index: value}.
Names = str | Sequence[str]
Where = Mapping[int, int | str]
# A component as it is printed: tensor, its index and its value -> expression.
Writing = Callable[["Tensor", tuple[int, ...], "Element"], sp.Expr]
# Components that are written one by one, as text and as formulas; more fill the screen, and of
# others their number is given.
SHOWN = 12
SHOWN_LATEX = 60
# Mark printed after a component that may or may not vanish.
OPEN = "(undecided)"


def letters(slots: str) -> list[str]:
    """A letter for each slot: from a on for coordinate indices, from i on for frame indices."""
    frame = iter("ijklmnpqrstuvw")
    coordinate = iter("abcdefgh" if any(s in "DU" for s in slots) else "abcdefghijklmnopqr")
    return [next(frame) if slot in "DU" else next(coordinate) for slot in slots]


def _indexed(symbol: str, marks: list[str], slots: str) -> str:
    """Symbol with marks below and above, in order: S_{ab}^{c}."""
    parts = [symbol]
    pairs = list(zip(slots, marks, strict=True))
    for number, (up, run) in enumerate(groupby(pairs, key=lambda pair: pair[0] in "uU")):
        gap = "{}" if number else ""
        parts.append(f"{gap}{'^' if up else '_'}{{{''.join(mark for _, mark in run)}}}")
    return "".join(parts)


def plain_symbol(symbol: str) -> str:
    r"""A symbol of LaTeX as it is written in a line of text.

    Examples
    --------
    >>> plain_symbol(r"\bar\Gamma"), plain_symbol(r"\sqrt{g}"), plain_symbol("DR")
    ('Gamma_bar', 'sqrt(g)', 'DR')
    """
    bare = re.sub(r"\\bar ?(\\?\w+)", r"\1_bar", symbol)
    return re.sub(r"\{(.*?)\}", r"(\1)", bare).replace("\\", "")


def ascii_label(tensor: Tensor) -> str:
    """Symbol with index letters, such as S_{ab}^{c}."""
    label = _indexed(plain_symbol(tensor.symbol), letters(tensor.slots), tensor.slots)
    return label.replace("{}", "")


def html_table(head: Sequence[str], rows: Iterable[Sequence[object]], below: str = "") -> str:
    """A table for notebooks, with a line below it."""

    def line(cells: Sequence[object], tag: str) -> str:
        written = "".join(f"<{tag}>{html_text(str(cell))}</{tag}>" for cell in cells)
        return f"<tr>{written}</tr>"

    body = "".join(line(row, "td") for row in rows)
    ending = f"<p>{html_text(below)}</p>" if below else ""
    return f"<table><thead>{line(head, 'th')}</thead><tbody>{body}</tbody></table>{ending}"


def component(
    tensor: Tensor, index: tuple[int, ...], write: Callable[[Element], sp.Expr]
) -> sp.Expr:
    """One component as an expression, through its representative so that it is made once."""
    sign, representative = tensor.components.representative(index)
    value = tensor.components.get(representative)
    if not sign or value is tensor.frame.field.zero:
        return sp.S.Zero
    written = named(tensor, index, value, write)
    return written if sign > 0 else -written


def named(
    tensor: Tensor, index: tuple[int, ...], value: Element, write: Callable[[Element], sp.Expr]
) -> sp.Expr:
    """A component as an expression; an error names the component that is too long."""
    try:
        return write(value)
    except AllowanceError:
        raise
    except LimitError as error:
        place = f"[{', '.join(map(str, index))}]" if index else ""
        raise LimitError(f"{plain_symbol(tensor.symbol)}{place}: {error}") from None


def written(tensor: Tensor, *, are_open: bool) -> dict[tuple[int, ...], sp.Expr]:
    """Undecided or nonzero components, including the ones that follow by symmetry."""
    components = tensor.components
    chosen = [i for i in components.independent if (i in components.undecided) == are_open]
    own = {i: named(tensor, i, components.independent[i], plain) for i in chosen}
    places = ((i, *components.representative(i)) for i in components.support)
    return {i: own[k] if sign > 0 else -own[k] for i, sign, k in places if k in own}


def plain(value: Element) -> sp.Expr:
    """An element as an expression."""
    return value.sympy


def short(tensor: Tensor, index: tuple[int, ...]) -> sp.Expr:
    """One component as it is printed."""
    writing = tensor.writing
    if writing is None:
        return component(tensor, index, tensor.frame.written)
    _, first = tensor.components.representative(index)
    return component(tensor, index, lambda value: writing(tensor, first, value))


def array(tensor: Tensor, is_short: bool) -> sp.ImmutableDenseNDimArray | sp.Expr:
    """See Tensor.to_sympy."""
    if not tensor.slots:
        return short(tensor, ()) if is_short else tensor[()]
    n, rank = tensor.frame.dimension, len(tensor.slots)
    flat: list[sp.Expr] = [sp.S.Zero] * n**rank
    short_forms = {i: short(tensor, i) for i in tensor.components.support} if is_short else None
    every = {**tensor.nonzero(), **tensor.undecided()} if short_forms is None else short_forms
    for index, value in every.items():
        place = 0
        for k in index:
            place = place * n + k
        flat[place] = value
    return sp.ImmutableDenseNDimArray(flat, (n,) * rank)


def open_count(tensor: Tensor) -> int:
    """How many components may vanish or not."""
    components = tensor.components
    return sum(components.representative(i)[1] in components.undecided for i in components.support)


def open_mark(tensor: Tensor, index: tuple[int, ...]) -> str:
    """Mark printed after a component that may or may not vanish."""
    _, first = tensor.components.representative(index)
    return f"  {OPEN}" if first in tensor.components.undecided else ""


def in_words(tensor: Tensor) -> str:
    """How many components do not vanish, and how many are undecided."""
    undecided = open_count(tensor)
    nonzero = len(tensor.components.support) - undecided
    words = f"{nonzero} {'does' if nonzero == 1 else 'do'} not vanish"
    return f"{words}, {undecided} {'is' if undecided == 1 else 'are'} undecided"


def _ranges(tensor: Tensor) -> str:
    """What the letters of the label count: coordinates, by name, and legs."""
    names = ", ".join(symbol.name for symbol in tensor.frame.coordinates)
    marks = list(zip(letters(tensor.slots), tensor.slots, strict=True))
    of_coordinates = ", ".join(letter for letter, slot in marks if slot in "du")
    of_legs = ", ".join(letter for letter, slot in marks if slot in "DU")
    parts = [f"{of_coordinates}: coordinates {names}" if of_coordinates else f"coordinates {names}"]
    return "; ".join([*parts, *([f"{of_legs}: legs"] if of_legs else [])])


def text(tensor: Tensor) -> str:
    """Name, label and the first non-vanishing components, one per line."""
    independent: Mapping[tuple[int, ...], Element] = tensor.components.independent
    heading = f"{tensor.name or 'tensor'} {ascii_label(tensor)}".strip()
    heading += f" ({_ranges(tensor)})"
    if not independent:
        return f"{heading}: all components vanish"
    lines, write = [heading], TextPrinter().doprint
    for index in list(independent)[:SHOWN]:
        place = f"[{', '.join(map(str, index))}]" if index else ""
        value = f"{write(short(tensor, index))}{open_mark(tensor, index)}"
        lines.append(f"  {plain_symbol(tensor.symbol)}{place} = {value}")
    total = len(tensor.components.support)
    hidden = len(independent) - min(SHOWN, len(independent))
    if hidden:
        lines.append(f"  and {hidden} more independent components")
    if total > len(independent):
        counted = in_words(tensor) if tensor.components.undecided else f"{total} do not vanish"
        lines.append(f"  ({counted}; the others follow by symmetry)")
    assumption = assumption_of(tensor.frame, independent.values())
    return "\n".join([*lines, *[f"  {assumption}"] * bool(assumption)])


def _marks(tensor: Tensor, index: tuple[int, ...]) -> list[str]:
    """Index values as they are written: coordinate names, hatted numbers for the frame."""
    marks = []
    for slot, k in zip(tensor.slots, index, strict=True):
        if slot in "DU":
            marks.append(rf"\hat{{{k + 1}}}")
        else:
            marks.append(latex_of(tensor.frame.coordinates[k]) + " ")
    return marks


def _symbol_latex(symbol: str) -> str:
    """A symbol in LaTeX: long names upright."""
    if symbol.startswith("\\") or len(symbol) == 1:
        return symbol
    return latex_of(sp.Symbol(symbol))


def latex(tensor: Tensor) -> str:
    """LaTeX for notebooks: a matrix for two indices, else a list of independent components."""
    symbol = _symbol_latex(tensor.symbol)
    label = _indexed(symbol, letters(tensor.slots), tensor.slots)
    write = TexPrinter().doprint
    independent = tensor.components.independent
    assumption = assumption_latex(tensor.frame, independent.values()) if independent else ""
    beside = rf"\quad {assumption}" if assumption else ""
    if not tensor.slots:
        mark = rf"\quad\text{{{OPEN}}}" if open_mark(tensor, ()) else beside
        return rf"$\displaystyle {symbol} = {write(short(tensor, ()))}{mark}$"
    if not independent:
        return rf"$\displaystyle {label} = 0$"
    if len(tensor.slots) == 2:
        n = tensor.frame.dimension
        rows = [" & ".join(write(short(tensor, (i, j))) for j in range(n)) for i in range(n)]
        body = r" \\ ".join(rows)
        undecided = ", ".join(
            _indexed(symbol, _marks(tensor, i), tensor.slots) for i in tensor.undecided()
        )
        mark = rf"\quad {undecided}\ \text{{{OPEN}}}" if undecided else ""
        mark += beside
        return rf"$\displaystyle {label} = \begin{{pmatrix}} {body} \end{{pmatrix}}{mark}$"
    lines = []
    for index in list(independent)[:SHOWN_LATEX]:
        left = _indexed(symbol, _marks(tensor, index), tensor.slots)
        mark = rf"\quad\text{{{OPEN}}}" if open_mark(tensor, index) else ""
        lines.append(rf"{left} &= {write(short(tensor, index))}{mark}")
    hidden = len(independent) - len(lines)
    if hidden > 0:
        lines.append(rf"&\text{{and {hidden} more independent components}}")
    lines += [f"&{assumption}"] * bool(assumption)
    body = r" \\ ".join(lines)
    return rf"$\displaystyle \begin{{aligned}} {body} \end{{aligned}}$"


def sympy_latex(tensor: Tensor, _: object) -> str:
    """Output of `sympy.latex`: the same without dollars."""
    return latex(tensor).removeprefix(r"$\displaystyle ").removesuffix("$")


def sympy_text(tensor: Tensor, _: object) -> str:
    """Output of `sympy.sstr`."""
    return text(tensor)


def sympy_pretty(tensor: Tensor, _: object) -> prettyForm:
    """Output of `sympy.pprint`: the text, padded since pprint would centre shorter lines."""
    lines = text(tensor).splitlines()
    return prettyForm("\n".join(line.ljust(max(map(len, lines))) for line in lines))


def frame_text(frame: Frame) -> str:
    """Name, coordinates, the one-forms of a coframe, and the region that was assumed for it."""
    names = ", ".join(symbol.name for symbol in frame.coordinates)
    lines = [f"{frame.name or 'frame'} (coordinates {names})"]
    lines += [f"  e^{i + 1} = {_one_form(frame, i, str, ' ')}" for i in range(frame.dimension)]
    lines += [f"  {symbol} = {quantity}" for symbol, quantity in frame.names.items()]
    lines += [f"  {branch}" for branch in frame.branches]
    assumption = assumption_of(frame)
    return "\n".join([*lines, *[f"  {assumption}"] * bool(assumption)])


def frame_latex(frame: Frame) -> str:
    """The one-forms of a coframe in LaTeX, and the region that was assumed for it."""
    lines = [
        rf"e^{{\hat{{{i + 1}}}}} &= {_one_form(frame, i, latex_of, chr(92) + ', ')}"
        for i in range(frame.dimension)
    ]
    assumption = assumption_latex(frame)
    body = r" \\ ".join([*lines, *[f"&{assumption}"] * bool(assumption)])
    return rf"$\displaystyle \begin{{aligned}} {body} \end{{aligned}}$"


def _one_form(frame: Frame, i: int, write: Callable[[sp.Expr], str], gap: str) -> str:
    """Row i of the coframe as a sum of coordinate differentials."""
    d = r"\mathrm{d}" if write is latex_of else "d"
    parts = []
    for mu, symbol in enumerate(frame.coordinates):
        factor = short(frame.coframe, (i, mu)) if frame.names else frame.coframe[i, mu]
        if factor == 0:
            continue
        name = f"{d}{write(symbol)}"
        if factor == 1:
            parts.append(name)
        elif factor.is_Add:
            parts.append(f"({write(factor)}){gap}{name}")
        else:
            parts.append(f"{write(factor)}{gap}{name}")
    return " + ".join(parts).replace("+ -", "- ")


@dataclass(frozen=True)
class ComponentRow:
    """One component.

    index: its position, as in tensor[index].
    label: symbol with the names of its indices.
    value: exact.
    """

    index: tuple[int, ...]
    label: str
    value: sp.Expr


@dataclass(frozen=True, eq=False, repr=False)
class ComponentTable:
    """Components of a tensor that do not vanish: one line each, and a table in notebooks.

    tensor: the tensor of the components.
    names: names of its indices, one for each coordinate.
    chosen: whether these names differ from the names of the coordinates.
    indices: of the rows, in order.
    hidden: how many more follow from these by symmetry.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, cartan
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> torsion = cartan(Frame([r, phi], [[1, 0], [0, r]])).torsion.S
    >>> print(torsion.table(names="rφ"))
    torsion S_{ab}^{c}: 2 of 8 components do not vanish
      S_{rφ}^{φ}  [0, 1, 1]  1/(2*r)
      1 more follows by symmetry
    """

    tensor: Tensor
    names: tuple[str, ...]
    chosen: bool
    indices: tuple[tuple[int, ...], ...]
    hidden: int

    @cached_property
    def rows(self) -> tuple[ComponentRow, ...]:
        """All rows, every value as a sympy expression."""
        tensor = self.tensor
        return tuple(
            ComponentRow(index, self.label(index), tensor[index]) for index in self.indices
        )

    def marks(self, index: tuple[int, ...]) -> list[str]:
        """Names of the indices of one component; legs have numbers from 1, or the chosen names."""
        return [
            self.names[k] if self.chosen or slot in "du" else str(k + 1)
            for slot, k in zip(self.tensor.slots, index, strict=True)
        ]

    def label(self, index: tuple[int, ...]) -> str:
        """One component with the names of its indices."""
        tensor = self.tensor
        is_spaced = any(len(name) > 1 for name in self.names) and (
            self.chosen or tensor.slots != tensor.slots.upper()
        )
        ends = [f"{mark} " if is_spaced else mark for mark in self.marks(index)]
        indexed = _indexed(plain_symbol(tensor.symbol), ends, tensor.slots)
        return indexed.replace("{}", "").replace(" }", "}")

    @property
    def count(self) -> str:
        """Number of components that do not vanish, in words; empty for a nonzero scalar."""
        tensor = self.tensor
        nonzero = len(tensor.components.support)
        if not nonzero:
            return "all components vanish" if tensor.slots else "vanishes"
        if not tensor.slots:
            return ""
        every, undecided = tensor.frame.dimension ** len(tensor.slots), open_count(tensor)
        do = "does" if nonzero - undecided == 1 else "do"
        count = f"{nonzero - undecided} of {every} components {do} not vanish"
        if undecided:
            count += f", {undecided} {'is' if undecided == 1 else 'are'} undecided"
        return count

    @property
    def heading(self) -> str:
        """Name of the tensor, and how many components do not vanish."""
        name = f"{self.tensor.name or 'tensor'} {self.tensor.label}".strip()
        return f"{name}: {self.count}" if self.count else name

    @property
    def ending(self) -> str:
        """How many components are not listed, and why."""
        follow = "follows" if self.hidden == 1 else "follow"
        return f"{self.hidden} more {follow} by symmetry" if self.hidden else ""

    @cached_property
    def assumption(self) -> str:
        """The region that was assumed, if a listed value depends on it."""
        components = self.tensor.components
        values = (components.get(components.representative(i)[1]) for i in self.indices)
        return assumption_of(self.tensor.frame, values) if self.indices else ""

    _repr_html_ = drawn_by("notebook_tables", "table_html")

    def __iter__(self) -> Iterator[ComponentRow]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.indices)

    def __str__(self) -> str:
        labels = [row.label for row in self.rows]
        places = [str(list(row.index)) if row.index else "" for row in self.rows]
        wide = max(map(len, labels), default=0)
        lines = [
            f"  {label:<{wide}}  {place}  {short(self.tensor, row.index)}"
            f"{open_mark(self.tensor, row.index)}"
            for label, place, row in zip(labels, places, self.rows, strict=True)
        ]
        remarks = filter(None, [self.ending, self.assumption])
        return "\n".join([self.heading, *lines, *(f"  {remark}" for remark in remarks)])

    def __repr__(self) -> str:
        return str(self)


def table(tensor: Tensor, names: Names | None, where: Where | None, every: bool) -> ComponentTable:
    """See Tensor.table."""
    checks.flag(every, "every")
    called = index_names(tensor, names)
    fixed = _fixed(tensor, called, where)
    support = tensor.components.support if every or fixed else tuple(tensor.components.independent)
    shown = tuple(i for i in support if all(i[k] == value for k, value in fixed.items()))
    hidden = 0 if fixed else len(tensor.components.support) - len(shown)
    return ComponentTable(tensor, called, names is not None, shown, hidden)


def index_names(tensor: Tensor, names: Names | None) -> tuple[str, ...]:
    """A name for each coordinate: the given name, or its own."""
    coordinates = [symbol.name for symbol in tensor.frame.coordinates]
    if names is None:
        return tuple(coordinates)
    n = len(coordinates)
    listed: list[object] = []
    if isinstance(names, str):
        parted = names.replace(",", " ").split()
        listed = list(parted if len(parted) == n else names)
    elif isinstance(names, Sequence):
        listed = list(names)
    valid = [name for name in listed if isinstance(name, str) and name.strip()]
    if len(valid) != n or len(listed) != n or len(set(valid)) != n:
        raise TensorIndexError(
            f"names: expected {n} different names, one for each of {', '.join(coordinates)}, got "
            f"{checks.shown(names)}. Give them as a string of {n} letters, or as a list of strings."
        )
    return tuple(valid)


def _fixed(tensor: Tensor, names: tuple[str, ...], where: Where | None) -> dict[int, int]:
    """Which indices have one value only, given by number or by name."""
    coordinates = [symbol.name for symbol in tensor.frame.coordinates]
    fixed = {}
    for key, value in checks.table(where, "where").items():
        last, remedy = len(tensor.slots) - 1, "Give {index: its value}, such as {0: 'r'}."
        wanted = f"an index of {tensor.label} from 0 to {last}"
        place = checks.count(
            key, "where", TensorIndexError, 0, last, expected=wanted, remedy=remedy
        )
        labels = next((list_ for list_ in (names, coordinates) if value in list_), None)
        number = labels.index(value) if labels is not None and isinstance(value, str) else value
        last = len(names) - 1
        wanted = f"a whole number from 0 to {last}, or one of {', '.join(names)}"
        fixed[place] = checks.count(
            number, f"where[{place}]", TensorIndexError, 0, last, expected=wanted
        )
    return fixed

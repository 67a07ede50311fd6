"""Space: a frame with its story, its source and the answers that are known, as index tables."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from itertools import permutations
from typing import TYPE_CHECKING

import sympy
from sympy import Basic, Expr, Integer, Symbol
from sympy.combinatorics.permutations import Permutation

from geomtorsion.errors import UnknownNameError
from geomtorsion.geometry import Connection, Frame, Tensor, cartan, quantities
from geomtorsion.geometry.plan import property_of
from geomtorsion.support.checks import expression
from geomtorsion.support.copies import ByContent
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.hints import attribute_hints
from geomtorsion.support.outgoing import markdown_text

if TYPE_CHECKING:
    from geomtorsion.curves.atlas import Atlas
    from geomtorsion.spaces.embedding import Embedding

Index = tuple[int, ...]
Closed = sympy.Expr | int | str
# Closed forms, written once per independent component.
Table = dict[Index, sympy.Expr]


@dataclass(frozen=True)
class KnownAnswer:
    """Published closed form that this package must reproduce.

    Fields
    ------
    quantity
        A name in the table `geomtorsion.geometry.quantities`, as `Space.quantity` takes it.
    components
        Index tuple (counted from 0, in the order of the quantity's slots) -> closed form; for a
        scalar the closed form itself.
    basis
        "coordinate" or "frame": the basis of every index; "natural": slots as the quantity has
        them, for those that mix the two (coframe, legs).
    complete
        True: all components that are not listed vanish.
    source
        Where the closed form comes from; empty: the source of the space.

    Examples
    --------
    >>> KnownAnswer("ricci", {}).vanishes
    True
    """

    quantity: str
    components: Mapping[Index, Closed] | Closed = field(hash=False)
    basis: str = "coordinate"
    complete: bool = True
    source: str = ""

    @property
    def vanishes(self) -> bool:
        """Whether the answer is zero in all components."""
        if isinstance(self.components, Mapping):
            return self.complete and not self.components
        return self.components == 0


@dataclass(frozen=True)
class FirstMotion:
    """Where a motion begins, how, and for how long.

    start: coordinates q^mu.
    frame_velocity: u^i = e^i_mu q'^mu.
    t: last value of the curve parameter.
    parameters: name -> number.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> load("s2").motion.parameters
    {'R': 1.0}
    """

    start: tuple[float, ...]
    frame_velocity: tuple[float, ...]
    t: float = 2.0
    parameters: Mapping[str, float] = field(default_factory=dict, hash=False)


@attribute_hints(
    metric="space.frame.metric", coframe="space.frame.coframe", torsion="gt.cartan(space).torsion",
    parameters="space.frame.parameters", coordinates="space.frame.coordinates",
)  # fmt: skip
@dataclass(frozen=True, eq=False, repr=False)
class Space(ByContent):
    """Space from the library or a file: a frame with its description, source and known results.

    Fields
    ------
    name, title
        The key by which it is loaded, and a one-line title; shipped spaces have it from the
        registry.
    story
        Two lines: what the space is used for, and what its torsion is like.
    source
        Book or paper, with place.
    frame
        The coframe with coordinates, signature, parameters and domain.
    known
        Closed forms that the tests check by exact equality.
    group
        Heading under which `geomtorsion spaces` lists it.
    notes
        What a user must know before trusting it: multivalued forms, branches, edges.
    connection
        A connection other than the Cartan connection of the frame, if the space is about one.
    atlas
        Frame -> its charts and the maps between them; None: only the chart of the frame.
    motion
        A start, a velocity and a time for a first look; None: chosen by the frame.
    embedding
        Frame -> positions of its points in ordinary space, for figures; None: not drawn.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> load("so3").frame.dimension
    3
    """

    name: str
    title: str = ""
    story: str = ""
    source: str = ""
    _: KW_ONLY
    frame: Frame
    known: tuple[KnownAnswer, ...] = ()
    group: str = ""
    notes: str = ""
    connection: Connection | None = None
    atlas: Callable[[Frame], Atlas] | None = None
    motion: FirstMotion | None = None
    embedding: Callable[[Frame], Embedding] | None = None

    def own_connection(self) -> Connection:
        """The connection of the space, or the Cartan connection of its frame.

        Functions that take a connection use it where they are given a space.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> load("so3").own_connection().name
        'Cartan connection'
        """
        return cartan(self.frame) if self.connection is None else self.connection

    def quantity(self, name: str) -> Tensor:
        """A named quantity of the frame, or of the space's own connection; see `Frame.quantity`.

        Raises
        ------
        UnknownNameError
            No quantity has this name (the message lists near ones), or it needs a connection that
            the space does not have.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> load("axial_torsion").quantity("connection_scalar")[()]
        -6*lambda**2
        """
        row = quantities.entry(name)
        if row.of != "connection":
            return self.frame.quantity(name)
        if self.connection is None:
            raise UnknownNameError(
                f"{name}: expected a space with its own connection, got {self.name}, which only "
                "has the connections of its frame. Use cartan_connection, christoffel or another "
                "quantity of the frame, or give the space a connection."
            )
        return property_of(self.connection, row)

    def __repr__(self) -> str:
        lines = [f"{self.name}: {self.title}", self.story, f"source: {self.source}"]
        if self.notes:
            lines.append(f"notes: {self.notes}")
        return "\n".join([*(line for line in lines if line), repr(self.frame)])

    _repr_html_ = drawn_by("notebook_tables", "space_html")

    def _repr_markdown_(self) -> str:
        name, title, story, source, notes = map(
            markdown_text, (self.name, self.title, self.story, self.source, self.notes)
        )
        notes = f"\n\n*{notes}*" if notes else ""
        source = f"\n\nSource: {source}" if source else ""
        return f"**{name}**: {title}\n\n{story}{source}{notes}\n\n{self.frame._repr_latex_()}"


def box(ranges: Mapping[Symbol, tuple[Expr | int, Expr | int]]) -> tuple[Basic, ...]:
    """Relations low < symbol < high of all symbols; bounds at infinity are omitted.

    Examples
    --------
    >>> from sympy import oo, symbols
    >>> r, M = symbols("r M", positive=True)
    >>> box({r: (2 * M, oo)})
    (r > 2*M,)
    """
    relations: list[Basic] = []
    for symbol, (low, high) in ranges.items():
        if expression(low).is_finite is not False:
            relations.append(symbol > low)
        if expression(high).is_finite is not False:
            relations.append(symbol < high)
    return tuple(relations)


def alternating(components: Mapping[Index, Expr | int]) -> Table:
    """All index orders of a totally antisymmetric tensor, from one order of each.

    Examples
    --------
    >>> alternating({(0, 1, 2): 5})[0, 2, 1]
    -5
    """
    table: Table = {}
    for index, value in components.items():
        for order in permutations(range(len(index))):
            sign = Integer(Permutation(order).signature())
            table[tuple(index[place] for place in order)] = sign * expression(value)
    return table


def antisymmetric(components: Mapping[Index, Expr | int]) -> Table:
    """Both orders of the first two indices, the second with the opposite sign.

    Examples
    --------
    >>> antisymmetric({(0, 1, 2): 5})
    {(0, 1, 2): 5, (1, 0, 2): -5}
    """
    table: Table = {}
    for (first, second, *rest), value in components.items():
        table[first, second, *rest] = expression(value)
        table[second, first, *rest] = -expression(value)
    return table


def symmetric(components: Mapping[Index, Expr | int]) -> Table:
    """Both orders of the first two indices, with the same value.

    Examples
    --------
    >>> symmetric({(0, 1, 2): 5})
    {(0, 1, 2): 5, (1, 0, 2): 5}
    """
    table: Table = {}
    for (first, second, *rest), value in components.items():
        table[first, second, *rest] = expression(value)
        table[second, first, *rest] = expression(value)
    return table


def diagonal(values: Sequence[Expr | int]) -> Table:
    """The diagonal of a tensor with two indices; zeros are omitted.

    Examples
    --------
    >>> diagonal([1, 0, 2])
    {(0, 0): 1, (2, 2): 2}
    """
    return {(k, k): expression(value) for k, value in enumerate(values) if value != 0}


def matrix(rows: Sequence[Sequence[Expr | int]]) -> Table:
    """The nonzero entries of a matrix.

    Examples
    --------
    >>> matrix([[0, 3], [1, 0]])
    {(0, 1): 3, (1, 0): 1}
    """
    return {
        (i, j): expression(value)
        for i, row in enumerate(rows)
        for j, value in enumerate(row)
        if value != 0
    }

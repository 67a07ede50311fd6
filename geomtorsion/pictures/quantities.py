"""quantities: quantities of a space to show, each with its tensor and its label."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import UnknownNameError
from geomtorsion.geometry.assumption import assumption_of
from geomtorsion.geometry.notation import open_mark, short
from geomtorsion.geometry.quantities import entries
from geomtorsion.pictures.latex import letters, text_label
from geomtorsion.pictures.text import plain_text
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    import sympy

    from geomtorsion.exact import Element
    from geomtorsion.geometry import Tensor
    from geomtorsion.geometry.quantities import Entry
    from geomtorsion.spaces import Space


# Data written as JSON.
Data = dict[str, Any]
BASES = ("natural", "coordinate", "frame")


@dataclass(frozen=True)
class Quantity:
    """A quantity of a space, computed when its components are read.

    entry: how it is presented. tensor: its components, in the requested basis.
    """

    entry: Entry
    tensor: Tensor

    @property
    def letters(self) -> list[str]:
        """A letter for each index."""
        return letters(self.tensor.slots)

    @property
    def text_label(self) -> str:
        """Symbol with index letters."""
        return text_label(self.entry.symbol, self.letters, self.tensor.slots)

    def written(self, element: Element) -> sympy.Expr:
        """A component as it is printed."""
        if self.tensor.writing is not None:
            return short(self.tensor, self._places[id(element)])
        frame = self.tensor.frame
        return frame.written(element) if frame.names else element.sympy

    @cached_property
    def independent(self) -> dict[tuple[int, ...], Element]:
        """Components not known to vanish, one of each set that symmetry ties together."""
        return dict(sorted(self.tensor.components.independent.items()))

    @cached_property
    def nonzero(self) -> dict[tuple[int, ...], Element]:
        """All components that are not known to vanish."""
        return dict(sorted(self.tensor.components.nonzero.items()))

    @cached_property
    def _places(self) -> dict[int, tuple[int, ...]]:
        """Identity of each component that may not vanish -> its index."""
        return {id(element): index for index, element in self.nonzero.items()}

    @cached_property
    def undecided(self) -> tuple[tuple[int, ...], ...]:
        """The indices of undecided components."""
        return tuple(index for index in self.nonzero if open_mark(self.tensor, index))


def chosen_quantities(
    space: Space,
    names: Iterable[str] = (),
    basis: str = "natural",
    progress: Callable[[str], object] = lambda _: None,
) -> list[Quantity]:
    """The quantities of these names, or all that a report shows; progress hears each title.

    Raises
    ------
    UnknownNameError
        No quantity or basis has this name, or it belongs to a connection that the space lacks.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> [ricci] = chosen_quantities(load("s2"), ["ricci"])
    >>> ricci.text_label, len(ricci.independent)
    ('R̄_{ab}', 2)
    """
    if basis not in BASES:
        raise UnknownNameError(f"basis: expected one of {', '.join(BASES)}, got {basis!r}.")
    names = tuple(names)
    quantities = []
    for entry in entries(names):
        if not names and entry.of == "connection" and space.connection is None:
            continue
        progress(entry.title)
        tensor = space.quantity(entry.name)
        quantity = Quantity(entry, _in_basis(tensor, basis))
        # Computed now, so that progress hears of each quantity before the time that it takes.
        _ = quantity.independent
        quantities.append(quantity)
    return quantities


def _in_basis(tensor: Tensor, basis: str) -> Tensor:
    """The tensor with its indices in a basis; anything else stays as it is."""
    if basis == "natural" or tensor.anchored:
        return tensor
    return tensor.in_frame() if basis == "frame" else tensor.in_coordinates()


def geometry_data(space: Space, quantities: Sequence[Quantity]) -> Data:
    """A space and its quantities as nested dictionaries of text.

    Expressions are written so that ``parse_expression`` reads them back. Indices are counted from
    0; in slots d and u are coordinate indices down and up, D and U frame indices.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> space = load("s2")
    >>> data = geometry_data(space, chosen_quantities(space, ["ricci"]))
    >>> data["quantities"]["ricci"]["components"]
    {'0,0': '1', '1,1': 'sin(theta)^2'}
    """
    frame = space.frame
    return {
        "name": space.name,
        "title": space.title,
        "story": space.story,
        "source": space.source,
        "notes": space.notes,
        "coordinates": [symbol.name for symbol in frame.coordinates],
        "parameters": [symbol.name for symbol in frame.parameters],
        "domain": [str(relation) for relation in frame.domain],
        **({"region": region} if (region := assumption_of(frame)) else {}),
        "frame_metric": [
            [plain_text(frame.eta[i, j]) for j in range(frame.dimension)]
            for i in range(frame.dimension)
        ],
        "branches": [str(branch) for branch in frame.field.branches],
        "conventions": "Gamma_ab^c differentiates along its first index; S = T/2; slots d, u: "
        "coordinate index down, up; D, U: frame index; indices counted from 0",
        "quantities": {one.entry.name: _quantity(one) for one in quantities},
    }


def _quantity(quantity: Quantity) -> Data:
    return {
        "title": quantity.entry.title,
        "equation": quantity.entry.equation,
        "slots": quantity.tensor.slots,
        "components": {
            ",".join(map(str, index)): plain_text(element.sympy)
            for index, element in quantity.nonzero.items()
        },
        **({"undecided": _keys(quantity.undecided)} if quantity.undecided else {}),
    }


def _keys(indices: Iterable[tuple[int, ...]]) -> list[str]:
    return [",".join(map(str, index)) for index in indices]

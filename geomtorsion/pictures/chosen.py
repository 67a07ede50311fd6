"""Chosen: the quantities of a space that are to be shown, each with its tensor and its label."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from geomtorsion.errors import UnknownNameError
from geomtorsion.pictures.catalogue import CONNECTION, Entry, entries
from geomtorsion.pictures.labels import letters, text_label
from geomtorsion.spaces.checking import CONNECTION_QUANTITIES

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Tensor
    from geomtorsion.spaces.space import Space

BASES = ("natural", "coordinate", "frame")


@dataclass(frozen=True)
class Chosen:
    """A quantity of a space, computed when its components are asked for.

    entry: how it is presented. tensor: its components, in the basis asked for.
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

    @cached_property
    def independent(self) -> dict[tuple[int, ...], Element]:
        """Nonzero components, one of each set that symmetry ties together."""
        return dict(sorted(self.tensor.components.independent.items()))

    @cached_property
    def nonzero(self) -> dict[tuple[int, ...], Element]:
        """All nonzero components."""
        return dict(sorted(self.tensor.components.nonzero.items()))


def choose(
    space: Space,
    names: Iterable[str] = (),
    basis: str = "natural",
    progress: Callable[[str], object] = lambda _: None,
) -> list[Chosen]:
    """The quantities of these names, or all that a report shows; progress hears each title.

    Raises
    ------
    UnknownNameError
        No quantity or basis has this name, or it belongs to a connection that the space lacks.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> [ricci] = choose(load("s2"), ["ricci"])
    >>> ricci.text_label, len(ricci.independent)
    ('R̄_{ab}', 2)
    """
    if basis not in BASES:
        raise UnknownNameError(f"no basis is called {basis!r}. There are: {', '.join(BASES)}.")
    names = tuple(names)
    found = []
    for entry in entries(names):
        own = entry.section == CONNECTION
        if own and space.connection is None:
            if names:
                raise UnknownNameError(
                    f"{entry.name} belongs to a connection of the space's own, but {space.name} "
                    "has none beside those of its frame. Ask for cartan_connection or christoffel."
                )
            continue
        progress(entry.title)
        if own and space.connection is not None:
            tensor = CONNECTION_QUANTITIES[entry.name](space.connection)
        else:
            tensor = space.frame.quantity(entry.name)
        chosen = Chosen(entry, _in_basis(tensor, basis))
        _ = chosen.independent
        found.append(chosen)
    return found


def _in_basis(tensor: Tensor, basis: str) -> Tensor:
    """The tensor with its indices in a basis; what is no tensor stays as it is."""
    if basis == "natural" or tensor.anchored:
        return tensor
    return tensor.in_frame() if basis == "frame" else tensor.in_coordinates()

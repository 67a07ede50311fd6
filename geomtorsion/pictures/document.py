"""Document: the geometry of a space as plain data, ready for JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from geomtorsion.pictures.chosen import Chosen
from geomtorsion.pictures.text import expression_text

if TYPE_CHECKING:
    from geomtorsion.spaces.space import Space


def document(space: Space, quantities: Sequence[Chosen]) -> dict[str, Any]:
    """A space and its quantities as nested dictionaries of text.

    Expressions are written so that ``parse_expression`` reads them back. Indices are counted from
    0; in slots d and u are coordinate indices down and up, D and U frame indices.

    Examples
    --------
    >>> from geomtorsion.pictures.chosen import choose
    >>> from geomtorsion.spaces import load
    >>> space = load("s2")
    >>> document(space, choose(space, ["ricci"]))["quantities"]["ricci"]["components"]
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
        "frame_metric": [
            [plain(frame.eta[i, j]) for j in range(frame.dimension)] for i in range(frame.dimension)
        ],
        "branches": [str(branch) for branch in frame.field.branches],
        "conventions": "Gamma_ab^c differentiates along its first index; S = T/2; slots d, u: "
        "coordinate index down, up; D, U: frame index; indices counted from 0",
        "quantities": {chosen.entry.name: _quantity(chosen) for chosen in quantities},
    }


def plain(expression: Any) -> str:
    """An expression as text that can be read back."""
    return expression_text(expression, greek=False)


def _quantity(chosen: Chosen) -> dict[str, Any]:
    return {
        "title": chosen.entry.title,
        "equation": chosen.entry.equation,
        "slots": chosen.tensor.slots,
        "components": {
            ",".join(map(str, index)): plain(element.sympy)
            for index, element in chosen.nonzero.items()
        },
    }

"""checking: whether the known answers of a space agree with what this package computes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sympy import Expr

from geomtorsion.exact import parse_expression
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.spaces.space import Closed, Index, KnownAnswer, Space


@dataclass(frozen=True)
class Disagreement:
    """One component in which a known answer and the computed one differ.

    Fields
    ------
    quantity, index
        Which component, in the basis of the answer.
    expected, found
        The closed form of the answer and the computed component.
    """

    quantity: str
    index: Index
    expected: Expr
    found: Expr

    def __str__(self) -> str:
        place = list(self.index) if self.index else ""
        return f"{self.quantity}{place}: expected {self.expected}, found {self.found}"


def disagreements(space: Space, answer: KnownAnswer) -> tuple[Disagreement, ...]:
    """Components in which a known answer differs from the computed one, decided exactly.

    A component counts as equal only if the difference is proved to vanish.

    Raises
    ------
    UnknownNameError
        No quantity has this name, or it needs a connection that the space does not have.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> space = load("so3")
    >>> [disagreements(space, answer) for answer in space.known[:2]]
    [(), ()]
    """
    tensor = computed(space, answer)
    entries = answer.components
    values: dict[Index, Closed] = dict(entries) if isinstance(entries, Mapping) else {(): entries}
    if answer.complete:
        for index in tensor.components.nonzero:
            values.setdefault(index, 0)
    named = [
        (f"{answer.quantity}{list(index)}", _expression(space.frame, value))
        for index, value in values.items()
    ]
    found = []
    for index, expected in zip(values, space.frame.field.read_all(named), strict=True):
        if (tensor.element(*index) - expected).is_zero is not True:
            found.append(Disagreement(answer.quantity, index, expected.sympy, tensor[index]))
    return tuple(found)


def computed(space: Space, answer: KnownAnswer) -> Tensor:
    """The quantity that an answer speaks of, in the basis of the answer.

    Raises
    ------
    UnknownNameError
        No quantity has this name, or it needs a connection that the space does not have.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> space = load("heisenberg")
    >>> computed(space, KnownAnswer("torsion_scalar", 0))[()]
    1/2
    """
    tensor = space.quantity(answer.quantity)
    if answer.basis == "frame":
        return tensor.in_frame()
    return tensor.in_coordinates() if answer.basis == "coordinate" else tensor


def _expression(frame: Frame, value: Closed) -> Expr | int:
    """A closed form as sympy has it; text is read by the whitelist."""
    if not isinstance(value, str):
        return value
    symbols = {symbol.name: symbol for symbol in (*frame.coordinates, *frame.parameters)}
    return parse_expression(value, symbols)

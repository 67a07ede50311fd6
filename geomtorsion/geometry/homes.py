"""Homes: whether frames are equal, and tensors of an equal frame carried into the field of one.

Every frame has an exact field of its own. Equal frames are not made one object: they may print by
other names, have other charts, and two threads that load a space must get their own result.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol, TypeVar
from weakref import WeakValueDictionary

from geomtorsion.errors import GeomtorsionError
from geomtorsion.exact import Element, TruncatedField

if TYPE_CHECKING:
    import sympy as sp

    from geomtorsion.geometry.frame import Frame

Matrix = Mapping[tuple[int, int], Element]


class Resident(Protocol):
    """A tensor, form or connection: its components are elements of the field of its frame."""

    @property
    def frame(self) -> Frame:
        """The frame of its components."""
        ...

    def _carried(self, frame: Frame) -> Resident: ...


R = TypeVar("R", bound=Resident)


def at_home(frame: Frame, value: R) -> R | None:
    """A tensor, form or connection with its components in the field of this frame.

    None if its own frame is not equal to this one.
    """
    if value.frame is frame:
        return value
    # A copy lives as long as its frame, so that the number of the frame is not taken again.
    copies: WeakValueDictionary[int, Any] = value.__dict__.setdefault(
        "_copies", WeakValueDictionary()
    )
    copy: Any = copies.get(id(frame))
    if copy is None and value.frame == frame:
        copy = copies[id(frame)] = value._carried(frame)
    return copy


def over_frame(frame: Frame, value: R, subject: str, error: type[GeomtorsionError]) -> R:
    """A tensor, form or connection with its components in the field of this frame.

    Raises
    ------
    GeomtorsionError
        Its own frame is not equal to this one; the class is `error`.
    """
    home = at_home(frame, value)
    if home is None:
        kind = type(value).__name__.lower()
        raise error(
            f"{subject}: expected a {kind} over this frame, got one over another frame. Build both "
            "over one frame."
        )
    return home


def are_equal(one: Frame, two: Frame) -> bool:
    """Whether two frames have equal coordinates, coframe, eta and domain; False if undecided."""
    if one is two:
        return True
    if _plain(one) != _plain(two) or one.field.chosen != two.field.chosen:
        return False
    series = isinstance(one.field, TruncatedField)
    if series != isinstance(two.field, TruncatedField):
        return False
    if one.given is two.given:
        return True
    if series:
        # The same maker of an equal frame: `expanded` with its parameter and order.
        return one._plain == two._plain
    shapes = [one.shape, two.shape]
    if "metric" in shapes and shapes[0] == shapes[1]:
        pairs = [(one.given["metric"], two.given["metric"])]
    else:
        pairs = [(one.coframe.components.nonzero, two.coframe.components.nonzero)]
    return all(_same(a, b) for a, b in [(one.given["eta"], two.given["eta"]), *pairs])


def _plain(frame: Frame) -> tuple[object, ...]:
    """What two equal frames share and `==` decides at once."""
    return frame.coordinates, frame.parameters, frame.domain, frame.complex


def number(frame: Frame) -> int:
    """Hash of a frame, without any of its components."""
    return hash(_plain(frame))


def _same(one: Matrix, two: Matrix) -> bool:
    """Whether matrices over two fields have equal entries."""
    if one.keys() != two.keys():
        return False
    return all(_agree(x, two[place]) for place, x in one.items())


def _agree(one: Element, two: Element) -> bool:
    """Whether two elements of two fields are equal."""
    if one.field is two.field:
        return one == two
    expression: sp.Expr = two.sympy
    return one.sympy == expression or one.field.read(expression) == one

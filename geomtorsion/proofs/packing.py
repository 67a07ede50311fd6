"""Packing: results with balls of FLINT, which cannot be pickled, are pickled as exact numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flint import acb, arb

from geomtorsion.support.copies import only_fields


class WithBalls:
    """A result whose fields contain balls, also in tuples and dictionaries."""

    def __getstate__(self) -> dict[str, object]:
        return {name: _packed(value) for name, value in only_fields(self).items()}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        for name, value in state.items():
            object.__setattr__(self, name, _unpacked(value))


class _Numbers(tuple[int, ...]):
    """The numbers of one ball, or of a complex one."""

    __slots__ = ()


def _packed(value: Any) -> Any:
    """The balls as numbers."""
    if isinstance(value, arb):
        (m, e), (r, s) = value.mid().man_exp(), value.rad().man_exp()
        return _Numbers((int(m), int(e), int(r), int(s)))
    if isinstance(value, acb):
        return _Numbers((*_packed(value.real), *_packed(value.imag)))
    return _each(value, _packed)


def _unpacked(value: Any) -> Any:
    """The balls again."""
    if isinstance(value, _Numbers):
        parts = [_ball(*value[k : k + 4]) for k in range(0, len(value), 4)]
        return parts[0] if len(parts) == 1 else acb(*parts)
    return _each(value, _unpacked)


def _each(value: Any, change: Any) -> Any:
    if type(value) is dict:
        return {name: change(x) for name, x in value.items()}
    return tuple(change(x) for x in value) if type(value) is tuple else value


def _ball(mantissa: int, exponent: int, radius: int, power: int) -> arb:
    return arb((mantissa, exponent), (radius, power))

"""Start: initial coordinates and velocities, checked once at the door."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import MissingValueError, ShapeError, SingularPointError, StartError

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

CAUSAL = ("timelike", "null", "spacelike")


def checked_numbers(values: Any, wanted: int, what: str) -> tuple[Any, ...]:
    """So many finite real numbers, kept as they came (fractions and sympy numbers too)."""
    if isinstance(values, (str, Mapping)) or not hasattr(values, "__iter__"):
        raise ShapeError(f"{what}: a list of {wanted} numbers was needed, {values!r} came.")
    found = tuple(x.item() if hasattr(x, "item") and hasattr(x, "dtype") else x for x in values)
    if len(found) != wanted:
        raise ShapeError(f"{what}: {wanted} numbers were needed, {len(found)} came.")
    for k, value in enumerate(found):
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise StartError(f"{what}[{k}] = {value!r} is no real number.") from None
        if not math.isfinite(number):
            raise StartError(f"{what}[{k}] = {number} is not finite. Give finite numbers.")
    return found


def checked_parameters(frame: Frame, parameters: Mapping[Any, Any] | None) -> dict[str, Any]:
    """Parameters by name, each one known to the frame and finite."""
    known = {symbol.name for symbol in frame.field.symbols} - {s.name for s in frame.coordinates}
    found: dict[str, Any] = {}
    for key, value in (parameters or {}).items():
        name = getattr(key, "name", key)
        if name not in known:
            listed = ", ".join(sorted(known)) or "none"
            raise StartError(f"{name!r} is no parameter of this frame. Known are {listed}.")
        checked_numbers([value], 1, f"parameter {name}")
        found[name] = value
    return found


def checked_start(frame: Frame, start: Any, parameters: Mapping[str, Any]) -> tuple[Any, ...]:
    """Coordinates at which the frame is regular."""
    names = ", ".join(symbol.name for symbol in frame.coordinates)
    found = checked_numbers(start, frame.dimension, f"start ({names})")
    point = {s.name: float(x) for s, x in zip(frame.coordinates, found, strict=True)}
    where = ", ".join(f"{name} = {value:.6g}" for name, value in point.items())
    point |= {name: float(value) for name, value in parameters.items()}
    try:
        size = abs(complex(frame.determinant.element().evaluate(point)))
        frame.legs.at(point)
    except MissingValueError as error:
        raise StartError(f"{error} Give parameters={{...}}.") from None
    except (SingularPointError, ZeroDivisionError):
        size = 0.0
    if size == 0.0 or not math.isfinite(size):
        raise StartError(
            f"the frame {frame.name or 'of this problem'} is singular at the start {where}: "
            "its determinant vanishes or has no value. Start beside the edge of the chart, "
            "or in another chart."
        )
    return found


def frame_velocities(
    frame: Frame,
    start: Sequence[Any] | None,
    velocity: Any,
    frame_velocity: Any,
    parameters: Mapping[str, Any],
) -> tuple[Any, ...]:
    """u^i, as given or from the coordinate velocity."""
    import numpy as np

    if (velocity is None) == (frame_velocity is None):
        came = "none" if velocity is None else "both"
        raise StartError(
            f"exactly one of velocity (q'^mu) and frame_velocity (u^i) was needed, {came} came."
        )
    if velocity is None:
        return checked_numbers(frame_velocity, frame.dimension, "frame_velocity")
    rates = checked_numbers(velocity, frame.dimension, "velocity")
    if start is None:
        raise StartError("velocity needs a start; without one, give frame_velocity (u^i).")
    point = {s.name: float(x) for s, x in zip(frame.coordinates, start, strict=True)}
    point |= {name: float(value) for name, value in parameters.items()}
    coframe = frame.coframe.at(point)
    return tuple(float(x) for x in np.real(coframe) @ np.array([float(x) for x in rates]))


def check_causal(frame: Frame, velocity: Sequence[Any], causal: str | None) -> None:
    """Refuse a velocity that has not the causal character asked for."""
    import numpy as np

    if causal is None:
        return
    if causal not in CAUSAL:
        raise StartError(f"causal={causal!r}: one of {', '.join(CAUSAL)} was needed.")
    eta = np.real(frame.eta.at({}))
    if np.linalg.eigvalsh(eta).min() > 0:
        raise StartError(f"causal={causal!r} needs a metric with time; this one is Euclidean.")
    u = np.array([float(x) for x in velocity])
    norm, size = float(u @ eta @ u), float(abs(eta).max() * (u @ u))
    is_null = abs(norm) <= 1e-12 * size
    found = "null" if is_null else ("timelike" if norm < 0 else "spacelike")
    if found != causal:
        raise StartError(
            f"the velocity is {found}: eta_ij u^i u^j = {norm:.6g}, but {causal} was asked for. "
            "Give another velocity, or causal=None."
        )

"""Start: initial coordinates and velocities, checked once."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import BranchError, MissingValueError, SingularPointError, StartError
from geomtorsion.ode.numbers import Real, checked_numbers, floats
from geomtorsion.precision import CALCULATED

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

CAUSAL = ("timelike", "null", "spacelike")


def checked_parameters(frame: Frame, parameters: Mapping[Any, Any] | None) -> dict[str, Real]:
    """Parameters by name, each one known to the frame and finite."""
    known = {symbol.name for symbol in frame.field.symbols} - {s.name for s in frame.coordinates}
    found: dict[str, Real] = {}
    for name, value in checks.by_name(parameters, "parameters", StartError).items():
        if name not in known:
            listed = ", ".join(sorted(known)) or "none"
            raise StartError(
                f"{checks.shown(name)} is no parameter of this frame. Known are {listed}."
            )
        checked_numbers([value], 1, f"parameter {name}")
        found[name] = value
    return found


def checked_start(frame: Frame, start: object, parameters: Mapping[str, Real]) -> tuple[Real, ...]:
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
    except BranchError as error:
        # The frame may be regular there, but was read for the other side.
        raise StartError(f"start {where}: {error}") from None
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
    start: Sequence[Real] | None,
    velocity: object,
    frame_velocity: object,
    parameters: Mapping[str, Real],
) -> tuple[tuple[Real, ...], tuple[Real, ...] | None]:
    """u^i, as given or from the coordinate velocity, and that velocity if it was given."""
    if (velocity is None) == (frame_velocity is None):
        came = "none" if velocity is None else "both"
        raise StartError(
            f"exactly one of velocity (q'^mu) and frame_velocity (u^i) was needed, {came} came."
        )
    if velocity is None:
        return checked_numbers(frame_velocity, frame.dimension, "frame_velocity"), None
    rates = checked_numbers(velocity, frame.dimension, "velocity")
    if start is None:
        raise StartError("velocity needs a start; without one, give frame_velocity (u^i).")
    point = {s.name: float(x) for s, x in zip(frame.coordinates, start, strict=True)}
    point |= {name: float(value) for name, value in parameters.items()}
    coframe = frame.coframe.at(point)
    found = np.real(coframe) @ np.array(floats(rates))
    return tuple(found.tolist()), rates


def check_causal(frame: Frame, velocity: Sequence[Real], causal: str | None) -> None:
    """Refuse a velocity that has not the causal character asked for."""
    if causal is None:
        return
    if causal not in CAUSAL:
        raise StartError(f"causal={causal!r}: one of {', '.join(CAUSAL)} was needed.")
    eta = np.real(frame.eta.at({}))
    if np.linalg.eigvalsh(eta).min() > 0:
        raise StartError(f"causal={causal!r} needs a metric with time; this one is Euclidean.")
    u = np.array([float(x) for x in velocity])
    norm, size = float(u @ eta @ u), float(abs(eta).max() * (u @ u))
    # Null as far as rounding can tell: the norm is nothing against its terms.
    is_null = abs(norm) <= CALCULATED * size
    found = "null" if is_null else ("timelike" if norm < 0 else "spacelike")
    if found != causal:
        raise StartError(
            f"the velocity is {found}: eta_ij u^i u^j = {norm:.6g}, but {causal} was asked for. "
            "Give another velocity, or causal=None."
        )

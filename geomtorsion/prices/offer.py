"""Offer: the ways to one result, each a run at an accuracy with its claim, and the truth."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol, runtime_checkable

from geomtorsion.errors import ArgumentError
from geomtorsion.ode import Engine
from geomtorsion.support import checks

# Accuracies that are requested where none are named, and digits of proofs.
ACCURACIES = (1e-3, 1e-6, 1e-9, 1e-12)
PROOFS = (10, 30)


class Claim(NamedTuple):
    """Value of a run, and the relative error that it claims; None: no claim."""

    value: Any
    error: float | None


class Bounds(NamedTuple):
    """Lower and upper bound of a true error."""

    low: float
    high: float


Run = Callable[[], Claim]


@dataclass(frozen=True)
class Way:
    """One way to a result.

    name: of the way. certainty: "plain", "estimate" or "proof".
    ready: accuracy -> function that makes the run; preparation is not part of the run.
    accuracies: in the order of rising cost.
    engine: name of its engine or rule, the same for each certainty; the name of the way if empty.
    """

    name: str
    certainty: str
    ready: Callable[[float], Run]
    accuracies: Sequence[float]
    engine: str = ""


@dataclass(frozen=True)
class Offer:
    """All ways to one result, and how their errors are judged.

    name: of the thing. truth: what the true errors are measured against, in words.
    judge: (value, requested accuracy) -> bounds of the true error; None where nothing is known.
    effects: run that measures what each effect costs, (name, seconds) in order.
    unit: of requests: "accuracy", or "spacing" of a grid.
    floor: relative error from noise, a lower bound for every request; None: no noise.
    """

    name: str
    ways: Sequence[Way]
    truth: str
    judge: Callable[[Any, float], Bounds | None]
    effects: Callable[[], Sequence[tuple[str, float]]] | None = None
    unit: str = "accuracy"
    floor: float | None = None


@dataclass(frozen=True)
class Request:
    """Arguments of `price`.

    at: times, a loop or a point. accuracies: finest last. engines: None chooses.
    parameters: values by name. proofs: digits of proofs; none: no proof, and no enclosed truth.
    """

    at: Any = None
    accuracies: tuple[float, ...] = ACCURACIES
    engines: tuple[Engine, ...] | None = None
    parameters: Mapping[Any, Any] | None = None
    proofs: tuple[int, ...] = PROOFS

    @property
    def proved(self) -> tuple[float, ...]:
        """Accuracies of the proofs."""
        return tuple(10.0**-digits for digits in self.proofs)


def at(request: Request, place: Any) -> Request:
    """The same request for a thing that knows its own times, loop or point.

    Raises
    ------
    ArgumentError
        The request names another one.
    """
    if request.at is not None:
        raise ArgumentError(
            "at: expected nothing for a result, which knows its times or its loop; got "
            f"{checks.shown(request.at)}. Drop it, or give the problem or the frame."
        )
    return replace(request, at=place)


@runtime_checkable
class HasPrice(Protocol):
    """Interface of an object with its own offer for `price`, such as a scene."""

    def offer(self, request: Request, /) -> Offer:
        """The ways to its result."""
        ...


def digits_of(accuracy: float) -> int:
    """Digits of the accuracy of a proof.

    Examples
    --------
    >>> digits_of(1e-30)
    30
    """
    return max(1, round(-math.log10(accuracy)))

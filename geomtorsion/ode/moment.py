"""Moment: where a motion is at one time, or at several."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import UnknownNameError
from geomtorsion.support.checks import known_name
from geomtorsion.support.copies import ByContent
from geomtorsion.support.displays import drawn_by, key_completions, values_text


@dataclass(frozen=True, eq=False)
class Moment(ByContent, Mapping[str, np.ndarray]):
    """All quantities of a motion at some times, by name.

    time: the requested times, shape (...).
    values: name -> array; one number of a motion has shape (...), a vector (..., number).
    whole: names of the vectors, such as "velocity"; their components have names of their own.

    For a curve: "coordinates" q^mu, "velocity" q'^mu, "frame_velocity" u^i, "transported" (the
    transported vectors), and each component by its own name. For other equations: "states" and
    outputs.
    """

    time: np.ndarray
    values: Mapping[str, np.ndarray]  # type: ignore[assignment]  # a field, not the method
    whole: tuple[str, ...] = ()

    def __repr__(self) -> str:
        parts = ", ".join(f"{name} = {values_text(self[name])}" for name in self)
        return f"Moment at {values_text(self.time)}: {parts}"

    _repr_html_ = drawn_by("notebook_pictures", "moment_html")
    _ipython_key_completions_ = key_completions

    def __getitem__(self, name: str) -> np.ndarray:
        if isinstance(name, str) and name in self.values:
            return self.values[name]
        kind = "a quantity of this motion"
        return self.values[known_name(name, self, "", UnknownNameError, expected=kind)]

    def __iter__(self) -> Iterator[str]:
        return iter(x for x in self.values if x not in self.whole)

    def __len__(self) -> int:
        return len(self.values) - len(self.whole)

    @property
    def states(self) -> np.ndarray:
        """All states, shape (..., size)."""
        return self["states"]

    @property
    def coordinates(self) -> np.ndarray:
        """q^mu in the chart of the problem, shape (..., n)."""
        return self["coordinates"]

    @property
    def velocity(self) -> np.ndarray:
        """q'^mu in the chart of the problem, shape (..., n)."""
        return self["velocity"]

    @property
    def frame_velocity(self) -> np.ndarray:
        """u^i = e^i_mu q'^mu, shape (..., n)."""
        return self["frame_velocity"]

    @property
    def transported(self) -> np.ndarray:
        """Transported vectors (frame) or deviation (offset, rate), shape (..., number)."""
        return self["transported"]


@dataclass(frozen=True)
class Term:
    """A function of moments.

    values: moment -> array.
    names: what it reads of a moment; None: all of it.
    """

    values: Callable[[Moment], np.ndarray]
    names: frozenset[str] | None = None

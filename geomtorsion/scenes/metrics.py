"""Metrics: one number read off a motion: a last value, an extreme, a time between zeros."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.errors import SceneError, UnknownNameError
from geomtorsion.support.checks import did_you_mean, known_name

# A number, or a vector of them, as a sweep varies it.
Values = float | tuple[float, ...]
# Samples from which a value between them is interpolated: as good as the motion, for 1001 samples.
NEIGHBOURS = 12
_NAMED = re.compile(
    r"\s*(?:(?P<what>[a-z ]+?)\s+)?(?P<name>[^\W\d][\w:]*)(?:\[(?P<part>\d+)\])?\s*"
)


@dataclass(frozen=True, eq=False)
class SweepRun:
    """One motion of a sweep, the argument of a measure.

    times: shape (m,), s. values: watched quantity -> array, shape (m,) or (m, components).
    varied: path -> the value it has here.
    """

    times: np.ndarray
    values: Mapping[str, np.ndarray]
    varied: Mapping[str, Values]

    def __getitem__(self, name: str) -> np.ndarray:
        """A watched quantity at the times."""
        kind = "a watched quantity"
        return self.values[known_name(name, self.values, "", UnknownNameError, expected=kind)]

    def part(self, name: str, part: int | None = None) -> np.ndarray:
        """A quantity that is one number, or one component of it, shape (m,)."""
        column = self[name].reshape(len(self.times), -1)
        if part is None and column.shape[1] == 1:
            part = 0
        if part is None or not 0 <= part < column.shape[1]:
            raise SceneError(
                f"{name}: expected one component, got {column.shape[1]}. Name one, as in {name}[0]."
            )
        return column[:, part]

    def zeros(self, name: str, part: int | None = None) -> np.ndarray:
        """Times at which a quantity crosses zero, interpolated between the samples.

        One that touches zero, or stays there, does not cross it.

        Examples
        --------
        >>> import numpy as np
        >>> times = np.linspace(0, 10, 201)
        >>> run = SweepRun(times, {"x": np.cos(times)}, {})
        >>> bool(np.abs(run.zeros("x") - np.pi * np.array([0.5, 1.5, 2.5])).max() < 1e-12)
        True
        """
        values = self.part(name, part)
        # Samples that are exactly zero have no sign: their neighbours decide.
        signed = np.flatnonzero(values)
        change = np.flatnonzero(np.diff(np.sign(values[signed])))
        crossings = [
            self._crossing(values, int(k)) if after == k + 1 else float(self.times[k + 1])
            for k, after in zip(signed[change], signed[change + 1], strict=True)
        ]
        return np.array(crossings, float)

    def largest(self, name: str, part: int | None = None, sign: int = 1) -> float:
        """The largest value (sign 1) or the smallest (-1), between the samples too.

        Examples
        --------
        >>> import numpy as np
        >>> times = np.linspace(0, 10, 201)
        >>> run = SweepRun(times, {"x": np.cos(times + 0.01)}, {})
        >>> abs(run.largest("x", sign=-1) + 1) < 1e-12
        True
        """
        values = sign * self.part(name, part)
        k = int(np.argmax(values))
        best = float(values[k])
        # The extreme is in one of the two intervals next to the largest sample.
        for first in (k - 1, k):
            if 0 <= first < len(values) - 1:
                between = self._between(values, first)
                minimum: Any = scipy.optimize.minimize_scalar(
                    lambda x, f=between: -f(x), bounds=(0.0, 1.0), method="bounded",
                    options={"xatol": 1e-9},
                )  # fmt: skip
                best = max(best, -float(minimum.fun))
        return sign * best

    def _crossing(self, values: np.ndarray, k: int) -> float:
        """The zero between samples k and k + 1."""
        a, b = float(self.times[k]), float(self.times[k + 1])
        root: Any = scipy.optimize.brentq(
            self._between(values, k), 0.0, 1.0, xtol=1e-15, rtol=1e-15
        )
        return a + float(root) * (b - a)

    def _between(self, values: np.ndarray, k: int) -> Callable[[float], float]:
        """Values from sample k (at 0) to k + 1 (at 1), by the polynomial through neighbours."""
        low = min(max(k + 1 - NEIGHBOURS // 2, 0), max(len(values) - NEIGHBOURS, 0))
        near = slice(low, low + NEIGHBOURS)
        a, b = float(self.times[k]), float(self.times[k + 1])
        place = (self.times[near] - a) / (b - a)
        # Weights of barycentric interpolation; the gap of a sample to itself does not count.
        gaps = place[:, None] - place[None, :]
        np.fill_diagonal(gaps, 1.0)
        weights = 1 / gaps.prod(axis=1)

        def value(x: float) -> float:
            """Barycentric interpolation."""
            gap = x - place
            hit = np.flatnonzero(gap == 0)
            if len(hit):
                return float(values[near][hit[0]])
            shares = weights / gap
            return float(shares @ values[near] / shares.sum())

        return value


def _between(run: SweepRun, name: str, part: int | None) -> float:
    """Time from the first to the second zero; NaN if there are not two."""
    zeros = run.zeros(name, part)
    return float(zeros[1] - zeros[0]) if len(zeros) > 1 else float("nan")


def _first_zero(run: SweepRun, name: str, part: int | None) -> float:
    zeros = run.zeros(name, part)
    return float(zeros[0]) if len(zeros) else float("nan")


Reader = Callable[[SweepRun, str, int | None], float]
WORDS: Mapping[str, Reader] = {
    "last": lambda run, name, part: float(run.part(name, part)[-1]),
    "max": lambda run, name, part: run.largest(name, part),
    "min": lambda run, name, part: run.largest(name, part, -1),
    "mean": lambda run, name, part: float(run.part(name, part).mean()),
    "first zero": _first_zero,
    "between zeros": _between,
}
Measure = str | Callable[[SweepRun], float]


def measures(
    asked: Measure | Mapping[str, Measure] | Sequence[str],
) -> dict[str, Callable[..., float]]:
    """Name -> function of a run, from words, functions, or several of them by name.

    Raises
    ------
    SceneError
        The words are not a measure.

    Examples
    --------
    >>> list(measures(["max nutation", "between zeros omega[1]"]))
    ['max nutation', 'between zeros omega[1]']
    """
    if isinstance(asked, str):
        asked = {asked: asked}
    elif callable(asked):
        asked = {getattr(asked, "__name__", "measure"): asked}
    elif not asked or not isinstance(asked, list | tuple | Mapping):
        raise SceneError(
            f'measure: expected words such as "max nutation", or a function, got {asked!r}.'
        )
    elif not isinstance(asked, Mapping):
        asked = {str(item): item for item in asked}
    return {name: item if callable(item) else _spoken(item) for name, item in asked.items()}


def _spoken(text: str) -> Callable[[SweepRun], float]:
    """A measure in words."""
    match = _NAMED.fullmatch(text) if isinstance(text, str) else None
    what = (match["what"] or "last").strip() if match else ""
    if match is None or what not in WORDS:
        hint = did_you_mean(what, WORDS)
        raise SceneError(
            f"measure: expected words or a function, got {text!r}. {hint}Write one of "
            f'{", ".join(WORDS)} before a watched quantity, as in "max nutation" or "between zeros '
            'omega[1]".'
        )
    name, part = match["name"], match["part"]
    reader = WORDS[what]
    return lambda run: reader(run, name, None if part is None else int(part))


def only_words(asked: Measure | Mapping[str, Measure] | Sequence[str]) -> bool:
    """Whether all measures are words, so that it is known which quantities they are about.

    Examples
    --------
    >>> only_words(["max nutation"]), only_words(len)
    (True, False)
    """
    items = [asked] if isinstance(asked, str) or callable(asked) else asked
    return all(
        isinstance(x, str) for x in (items.values() if isinstance(items, Mapping) else items)
    )


def quantities(asked: Measure | Mapping[str, Measure] | Sequence[str]) -> tuple[str, ...]:
    """Names of the quantities that measures in words are about.

    Examples
    --------
    >>> quantities("between zeros omega[1]")
    ('omega',)
    """
    items = [asked] if isinstance(asked, str) or callable(asked) else asked
    texts = items.values() if isinstance(items, Mapping) else items
    matches = [_NAMED.fullmatch(text) for text in texts if isinstance(text, str)]
    return tuple(dict.fromkeys(match["name"] for match in matches if match))

"""Record: the Taylor polynomials of all steps, as dense output."""

from __future__ import annotations

from typing import Any


class Record:
    """Callback that keeps the Taylor coefficients of every step."""

    def __init__(self, integrator: Any, start: Any) -> None:
        self.times = [start]
        self.coefficients: list[Any] = []
        self.integrator = integrator

    def __call__(self, integrator: Any) -> bool:
        """Keep one step; True goes on."""
        self.coefficients.append(integrator.tc.copy())
        self.times.append(integrator.time)
        return True

    def dense(self) -> Any:
        """Function of times, by the polynomial of the step in which each lies."""
        import numpy as np

        times = np.array(self.times, dtype=type(self.times[0]))
        table = np.array(self.coefficients, dtype=self.integrator.state.dtype)
        forward = bool(times[-1] >= times[0])

        def values(t: Any) -> Any:
            t = np.asarray(t, dtype=times.dtype)
            order = times.astype(float) if forward else -times.astype(float)
            place = np.searchsorted(order, (t if forward else -t).astype(float), "right") - 1
            place = np.clip(place, 0, len(table) - 1)
            h = (t - times[place])[..., None]
            rows = table[place]
            result = rows[..., -1]
            for k in range(rows.shape[-1] - 2, -1, -1):
                result = result * h + rows[..., k]
            return result

        return values

"""Poles: samples of a motion that are within rounding of a state where its rates have no value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np

from geomtorsion.codegen import Graph
from geomtorsion.codegen.arrays import BLOCK
from geomtorsion.ode.numbers import Real, mpf
from geomtorsion.ode.system import NO_VALUE, System, columns
from geomtorsion.ode.trajectory import Segment, Stage, Trajectory
from geomtorsion.support.precision import working_precision

AT_A_POLE = "its rates have no value at a state that is within the rounding of the time"
# Rates with a pole of order p change by a part of 1 - 2**-p where the distance to it doubles. Below
# an order of 1/12 the change of the state is a rounding.
PART = 1 / 20


def ended_at_poles(answer: Trajectory) -> Trajectory:
    """The trajectory, ended as stuck at the first sample, stop or switch that is at a pole."""
    for number, segment in enumerate(answer.segments):
        stage, run = segment.stage, segment.run
        if not stage.system.rates.poles.size:
            continue
        times, states = segment.times, segment.states
        is_last = segment is answer.segments[-1]
        if run.outcome == "done" or (is_last and answer.outcome == "stopped"):
            times = np.append(times, run.reached)
            states = np.concatenate((states, segment.last[None]))
        rows = columns([states], stage.parameters)
        elapsed = np.abs(times.astype(float))
        for k in np.flatnonzero(may_be_at_poles(stage.system, rows, elapsed, run.steps)).tolist():
            if _is_at_pole(stage, states[k], times[k], answer):
                kept = slice(segment.head + min(k, segment.count))
                run = replace(
                    run, times=run.times[kept], states=run.states[kept], reached=times[k],
                    last=states[k], outcome="stuck", reason=AT_A_POLE, dense=None,
                )  # fmt: skip
                ended = Segment(stage, run, segment.head, min(k, segment.count))
                segments = (*answer.segments[:number], ended)
                return Trajectory(answer.engine, answer.tolerance, segments, "stuck", AT_A_POLE)
    return answer


def may_be_at_poles(
    system: System, rows: np.ndarray, elapsed: np.ndarray, steps: np.ndarray | float
) -> np.ndarray:
    """Which states may be at a pole, by a test in doubles: shape (m,).

    A value that must not vanish is smaller than its change when time and state are rounded.

    rows: states above parameters, shape (size + parameters, m); elapsed: time since the start.
    """
    poles, size = system.rates.poles, system.size
    result = np.zeros(len(elapsed), dtype=bool)
    if not poles.size:
        return result
    parts = np.broadcast_to(2.0**-52 * np.sqrt(np.maximum(steps, 1)), result.shape)
    values = poles.numpy()
    for first in range(0, len(elapsed), BLOCK):
        block = slice(first, first + BLOCK)
        some = rows[:, block]
        with np.errstate(all="ignore"):
            rates = np.broadcast_to(system.array_function(*some), (size, some.shape[1]))
            change = np.zeros_like(some)
            change[:size] = parts[block] * elapsed[block] * rates
            change[:size] += 2.0**-52 * np.abs(some[:size]) * np.sign(rates)
            here, before, after = (values(*(some + x * change)) for x in (0, -1, 1))
            moved = np.maximum(np.abs(after - here), np.abs(before - here))
            # Not a number counts as near.
            result[block] = ~(np.abs(here) >= moved).all(axis=0)
    return result & (elapsed > 0)


def _is_at_pole(stage: Stage, state: np.ndarray, time: Any, answer: Trajectory) -> bool:
    """Whether a state is at a pole, in the digits of its engine.

    A removable pole, as in sin(x)/x, leaves the values of the rates as they are.
    """
    rates, poles = stage.system.rates, stage.system.rates.poles
    precision = answer.engine.precision
    bits = 2 * precision

    def real(graph: Graph, row: Sequence[Real]) -> list[Real]:
        values = graph.exactly([*row, *numbers], bits)
        if any(isinstance(value, mpmath.mpc) for value in values):
            raise ValueError
        return [mpf(value, bits) for value in values]

    with working_precision(bits):
        here, begin, numbers = (
            [mpf(x, bits) for x in row] for row in (state, stage.start, stage.parameters)
        )
        elapsed, last = abs(mpf(time, bits)), mpf(2.0 ** (1 - precision), bits)
        part = last * math.sqrt(max(answer.steps, 1))
        try:
            try:
                speeds = real(rates, here)
            except NO_VALUE:
                # A fraction may have no value just where its limit is reached.
                here = [x + last * (y - x) for x, y in zip(here, begin, strict=True)]
                speeds = real(rates, here)
            change = [
                part * elapsed * v + last * abs(x) * ((v > 0) - (v < 0))
                for x, v in zip(here, speeds, strict=True)
            ]
            values = real(poles, here)
            for side in (-1, 1):
                there = [x + side * dx for x, dx in zip(here, change, strict=True)]
                others = real(poles, there)
                if all(abs(x) >= abs(y - x) for x, y in zip(values, others, strict=True)):
                    continue
                for x, v, w in zip(here, speeds, real(rates, there), strict=True):
                    if abs(w - v) > max(PART * abs(v), abs(x) / elapsed):
                        return True
        except NO_VALUE:
            return True
    return False

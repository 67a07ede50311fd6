"""Loops: the price of Burgers vectors and developments of a formula, and of measured circuits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from time import thread_time
from typing import Any

import numpy as np
from flint import arb

from geomtorsion.errors import AllowanceError, ArgumentError, GeomtorsionError, UndecidedError
from geomtorsion.geometry import Connection
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.loops import (
    BurgersVector,
    Development,
    Loop,
    burgers_vector,
    develop,
    exact_burgers_vector,
    forms,
)
from geomtorsion.loops.integrals import line_route
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.prices import offer as offers
from geomtorsion.prices.motions import proved_claim
from geomtorsion.prices.offer import Bounds, Claim, Offer, Request, Way
from geomtorsion.proofs import Proof, prove
from geomtorsion.support import checks
from geomtorsion.support.allowance import Limits

# Digits of the proof against which errors are measured: twice as many as a double has.
TRUTH_DIGITS = 2 * np.finfo(float).precision
# How long a closed form is looked for, in seconds of the processor, so that the rows of a list do
# not depend on other work of the machine: a price list should not take longer.
FORMULA_SECONDS = 2.0
# A grid is compared with every second, fourth and eighth of its nodes.
STRIDES = (8, 4, 2, 1)


def loop_of(request: Request) -> Loop:
    """The loop of a request.

    Raises
    ------
    ArgumentError
        It names none.
    """
    return checks.instance(request.at, Loop, "at")


def burgers_offer(frame: FrameLike, request: Request) -> Offer:
    """The price of the Burgers vector of a loop in a frame: numbers, a closed form and a proof."""
    frame, loop = as_frame(frame), loop_of(request)
    run = partial(burgers_vector, frame, loop, parameters=request.parameters)
    finest = run(min(request.accuracies))
    truth = _Balls.of(finest, bool(request.proofs))
    ways = [
        Way(
            "line and flux",
            "estimate",
            _each(partial(_vector, run, truth)),
            request.accuracies,
            engine="line",
        ),
        Way("line", "plain", partial(_line, finest), request.accuracies),
        Way("formula", "plain", partial(_formula, finest), (0.0,)),
    ]
    ways += _proof(finest, request)
    return Offer(f"{loop} in {frame.name or 'a frame'}", ways, truth.name, truth.judged)


def development_offer(connection: Connection, request: Request) -> Offer:
    """The price of the development of a loop: translation and rotation."""
    loop = loop_of(request)
    run = partial(develop, connection, loop, parameters=request.parameters)
    finest = run(min(request.accuracies))
    truth = _Balls.of(finest, bool(request.proofs))
    ways = [
        Way("line and cone", "estimate", _each(partial(_turn, run, truth)), request.accuracies),
        *_proof(finest, request),
    ]
    name = connection.frame.name or "a frame"
    return Offer(f"development of {loop} in {name}", ways, truth.name, truth.judged)


def _each(run: Callable[[float], Claim]) -> Callable[[float], offers.Run]:
    return lambda accuracy: partial(run, accuracy)


def _proof(finest: Any, request: Request) -> list[Way]:
    """The proof of a result, as a way."""
    if not request.proofs:
        return []
    return [Way("proof", "proof", _each(partial(proved_claim, finest)), request.proved)]


class _Balls:
    """The truth about a loop: balls of its components, and their size."""

    def __init__(self, name: str, balls: Sequence[arb], scales: np.ndarray) -> None:
        self.name, self.balls, self.scales = name, balls, scales

    @classmethod
    def of(cls, finest: BurgersVector | Development, proved: bool) -> _Balls:
        """From a proof where it is wanted and possible, else from the finest result."""
        values = numbers_of(finest)
        scales = _scales(finest)
        if proved:
            try:
                balls = prove(finest, TRUTH_DIGITS).balls
            except GeomtorsionError:
                pass
            else:
                return cls("a proof, so that they are enclosed", balls, scales)
        errors = _errors(finest)
        balls = [arb(x, error) for x, error in zip(values.tolist(), errors.tolist(), strict=True)]
        return cls("the finest result with its error", balls, scales)

    def claimed(self, result: BurgersVector | Development) -> float:
        """The error that a result claims, relative to the size of the truth."""
        return float((_errors(result) / self.scales).max())

    def judged(self, value: np.ndarray | Proof, accuracy: float) -> Bounds:
        """Bounds of the largest error of some components, relative."""
        if isinstance(value, Proof):
            return Bounds(0.0, value.relative_radius)
        low = high = 0.0
        for x, ball, scale in zip(value.tolist(), self.balls, self.scales.tolist(), strict=True):
            gap = abs(ball - arb(x)) / arb(scale)
            low, high = max(low, float(gap.lower())), max(high, float(gap.upper()))
        return Bounds(max(low, 0.0), high)


def numbers_of(result: BurgersVector | Development) -> np.ndarray:
    """Components of a result in the order of the balls of its proof."""
    if isinstance(result, BurgersVector):
        return result.vector
    return np.concatenate([result.burgers, result.rotation.ravel()])


def _errors(result: BurgersVector | Development) -> np.ndarray:
    """The claimed error of each component."""
    n = len(numbers_of(result))
    if isinstance(result, BurgersVector):
        return np.full(n, result.error)
    count = len(result.burgers)
    return np.concatenate([np.full(count, result.error), np.full(n - count, result.turn_error)])


def _scales(result: BurgersVector | Development) -> np.ndarray:
    """Sizes for relative errors: of the largest component of b, and 1 for rotations.

    The size of the loop where b vanishes.
    """
    b = result.vector if isinstance(result, BurgersVector) else result.burgers
    scales = np.ones(len(numbers_of(result)))
    scales[: len(b)] = float(np.abs(b).max()) or result.loop.size
    return scales


def _vector(run: Callable[[float], BurgersVector], truth: _Balls, accuracy: float) -> Claim:
    b = run(accuracy)
    return Claim(b.vector, truth.claimed(b))


def _turn(run: Callable[[float], Development], truth: _Balls, accuracy: float) -> Claim:
    turn = run(accuracy)
    return Claim(numbers_of(turn), truth.claimed(turn))


def _line(b: BurgersVector, accuracy: float) -> offers.Run:
    """Only the sum along the loop, without the flux that checks it."""
    compiled = forms(b.frame, b.parameters)

    def run() -> Claim:
        total = np.zeros(b.frame.dimension)
        for part in b.loop.parts:
            values = line_route(compiled, part, accuracy).values[:, 0]
            total = total + part.times * part.size * values
        return Claim(total, None)

    return run


def _formula(b: BurgersVector, accuracy: float) -> offers.Run:
    """The closed form, derived once and evaluated for the clock."""
    try:
        with Limits(FORMULA_SECONDS, None, thread_time):
            formula = exact_burgers_vector(b.frame, b.loop, parameters=b.parameters)
    except AllowanceError:
        raise UndecidedError(
            f"no closed form was found in {FORMULA_SECONDS:g} s of the processor. Use "
            "gt.exact_burgers_vector(frame, loop, seconds=...) for a longer search."
        ) from None
    return lambda: Claim(formula.at(), None)


def result_offer(result: BurgersVector | Development, request: Request) -> Offer:
    """The price of a Burgers vector or a development that was computed before."""
    parameters = {**result.parameters, **(request.parameters or {})}
    wanted = replace(offers.at(request, result.loop), parameters=parameters)
    if isinstance(result, BurgersVector):
        return burgers_offer(result.frame, wanted)
    return development_offer(result.connection, wanted)


def proof_offer(proof: Proof, request: Request) -> Offer:
    """The price of a proof of the same result by digits."""
    if request.at is not None:
        offers.at(request, None)
    ways = [Way("proof", "proof", _each(partial(proved_claim, proof.result)), request.proved)]
    name = f"proof of a {type(proof.result).__name__}"

    def judged(value: Proof, accuracy: float) -> Bounds:
        return Bounds(0.0, value.relative_radius)

    return Offer(name, ways, "the proof itself", judged)


def measured_offer(source: Any, request: Request) -> Offer:
    """The price of a circuit through measured matter: error against spacing, and its noise floor.

    A grid is compared with every second, fourth and eighth of its nodes; other sources are
    measured once. A whole number of cells instead of a loop means the survey of all circuits of
    this size on a grid.
    """
    if isinstance(source, SampledFrame) and checks.whole(request.at) is not None:
        return _survey_offer(source, request)
    loop = loop_of(request)
    whole = source.burgers(loop)
    scale = float(np.abs(whole.vector).max()) or loop.size
    name = f"{loop} in {type(source).__name__}"
    floor = whole.noise / scale
    run = partial(_circuit, loop=loop, scale=scale)
    if not isinstance(source, SampledFrame) or source.displacement is not None:
        way = Way("circuit", "estimate", lambda a: partial(run, source), (0.0,))
        return Offer(name, [way], "not known", lambda value, accuracy: None, None, "-", floor)
    grids = _spacings(source)
    way = Way("circuit", "estimate", _on_grids(source, run), tuple(grids))
    judged = partial(_against, whole.vector, whole.error / scale, scale)
    return Offer(name, [way], "all nodes, within their own error", judged, None, "spacing", floor)


def _survey_offer(grid: SampledFrame, request: Request) -> Offer:
    """The price of a survey: circuits of equal length on coarser grids, where these have any."""
    size = checks.count(request.at, "at", ArgumentError, 1)
    whole = grid.burgers_map(size)
    scale = float(np.nanmax(np.abs(whole.vectors))) or 1.0
    floor = float(np.nanmedian(whole.noise)) / scale
    grids = [step for step, stride in _spacings(grid).items() if size % stride == 0]

    def run(coarse: SampledFrame, cells: int) -> Claim:
        survey = coarse.burgers_map(cells)
        return Claim(survey.vectors, float(np.nanmax(survey.errors)) / scale)

    def ready(spacing: float) -> offers.Run:
        stride = _spacings(grid)[spacing]
        return partial(run, _coarser(grid, stride), size // stride)

    def judged(value: np.ndarray, spacing: float) -> Bounds:
        stride = _spacings(grid)[spacing]
        same = whole.vectors[(slice(None), *(slice(None, None, stride),) * grid.dimension)]
        same = same[tuple(slice(None, n) for n in value.shape)]
        own = float(np.nanmax(whole.errors)) / scale
        return _against(same, own, scale, value, spacing)

    name = f"{whole.known.size} circuits of {size} x {size} cells"
    way = Way("survey", "estimate", ready, grids)
    return Offer(name, [way], "all nodes, within their own error", judged, None, "spacing", floor)


def _spacings(grid: SampledFrame) -> dict[float, int]:
    """Spacing of coarser grids -> every how many nodes they have, the coarsest first."""
    step = float(max(abs(axis[1] - axis[0]) for axis in grid.axes))
    return {stride * step: stride for stride in STRIDES}


def _on_grids(
    grid: SampledFrame, run: Callable[[SampledFrame], Claim]
) -> Callable[[float], offers.Run]:
    return lambda spacing: partial(run, _coarser(grid, _spacings(grid)[spacing]))


def _against(
    true: np.ndarray, own: float, scale: float, value: np.ndarray, spacing: float
) -> Bounds:
    """Bounds of an error, from a result on all nodes with its own error."""
    gap = float(np.nanmax(np.abs(value - true))) / scale
    return Bounds(max(0.0, gap - own), gap + own)


def _circuit(source: Any, loop: Loop, scale: float) -> Claim:
    b = source.burgers(loop)
    return Claim(b.vector, b.error / scale)


def _coarser(grid: SampledFrame, stride: int) -> SampledFrame:
    """Every so many nodes of a grid."""
    if stride == 1:
        return grid
    nodes = (slice(None, None, stride),) * grid.dimension
    periodic = [
        wraps and len(axis) % stride == 0
        for wraps, axis in zip(grid.periodic, grid.axes, strict=True)
    ]
    sigma = grid.sigma
    if sigma is not None and sigma.shape[2:] == grid.mask.shape:
        sigma = sigma[(slice(None), slice(None), *nodes)]
    return SampledFrame(
        [axis[::stride] for axis in grid.axes],
        grid.coframe[(slice(None), slice(None), *nodes)],
        grid.order,
        grid.names,
        mask=grid.mask[nodes],
        sigma=sigma,
        periodic=periodic,
        unit=grid.unit,
        vector_unit=grid.vector_unit,
    )

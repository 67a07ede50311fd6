"""Measuring: `price`, which runs every way of an offer at every accuracy for the clock."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from threading import Lock
from typing import Any

from geomtorsion.curves import CurveProblem
from geomtorsion.errors import AccuracyError, ArgumentError, GeomtorsionError
from geomtorsion.geometry import Connection, Curvature, Frame, Tensor, Torsion
from geomtorsion.geometry.connections import HasConnection
from geomtorsion.loops import BurgersVector, Development, HasBurgers
from geomtorsion.ode import ODE, Engine, Ensemble, Solution
from geomtorsion.prices import loops, motions, tensors
from geomtorsion.prices.offer import ACCURACIES, PROOFS, HasPrice, Offer, Request, Run, Way
from geomtorsion.prices.price_list import PriceList, PriceRow
from geomtorsion.proofs import Proof
from geomtorsion.support import checks
from geomtorsion.support.budget import timed
from geomtorsion.support.progress import reports

# Things with a price, first match first: each kind makes its offer for a request.
KINDS: tuple[tuple[Any, Callable[[Any, Request], Offer]], ...] = (
    ((CurveProblem, ODE), motions.motion_offer),
    (Solution, motions.solution_offer),
    (Ensemble, motions.ensemble_offer),
    ((BurgersVector, Development), loops.result_offer),
    (Proof, loops.proof_offer),
    (Connection, loops.development_offer),
    ((Tensor, Torsion, Curvature), tensors.tensor_offer),
    (HasPrice, lambda thing, request: thing.offer(request)),
    (HasBurgers, loops.measured_offer),
    ((Frame, HasConnection, str), loops.burgers_offer),
)
# The peak of memory belongs to the whole process.
_TRACING = Lock()


def price(
    thing: Any,
    at: Any = None,
    accuracies: Sequence[float] = ACCURACIES,
    *,
    engines: Sequence[Engine] | None = None,
    parameters: Mapping[Any, Any] | None = None,
    proofs: Sequence[int] = PROOFS,
    memory: bool = False,
    progress: Callable[[float], object] | bool | None = None,
) -> PriceList:
    """Cost of a result: time of its digits, of its certainty and of the effects of a scene.

    Each way to the result runs at each accuracy: plain, with its error estimate, and proved. The
    time is the fastest of repeated runs, in seconds of processor time; first runs, which may
    compile, do not count. True errors are enclosed by a proof where `prove` applies, and otherwise
    measured against the reference that `truth` of the list names.

    Parameters
    ----------
    thing
        a problem (`geodesic`, `ODE.of`, ...), a frame, connection or tensor, measured data (a
        `SampledFrame` or anything else that closes loops), a scene; or a result: a solution, an
        ensemble, a Burgers vector, a development, a proof.
    at
        times for a problem (10 by default); a loop for a frame, connection or measured data; a
        number of cells for the survey of a grid; a point for a tensor, by names or as a list of
        all coordinates; omit it for a result or a scene, which have their own.
    accuracies
        relative errors to request.
    engines
        of motions; by default Taylor() (if installed) and RungeKutta().
    parameters
        values of parameters of frame, loop or tensor, {symbol or name: number}.
    proofs
        digits of proofs; () omits them and measures true errors without a proof.
    memory
        also measure the peak of memory, by a traced run that may take a hundred times as long.
    progress
        called with the finished fraction, from 0 to 1; True shows a bar.

    Returns
    -------
    PriceList: prints as a table; `seconds(accuracy)` and its inverse `accuracy(seconds)` predict
    other rows from three.

    Raises
    ------
    AccuracyError
        an accuracy is not a positive number, or none is given.
    ArgumentError
        thing has no price, `at` does not fit it, or memory is neither True nor False.

    Examples
    --------
    >>> from geomtorsion.curves import geodesic
    >>> from geomtorsion.ode import RungeKutta
    >>> problem = geodesic("so3", frame_velocity=[1, 2, 3], metric=[1, 2, 3])
    >>> table = price(problem, 1.0, [1e-4, 1e-8], engines=[RungeKutta()], proofs=[10])
    >>> [row.holds for row in table.rows if row.certainty == "estimate"], table.truth
    ([True, True], 'a proof, so that they are enclosed')
    >>> table.seconds(1e-6) > 0, table.accuracy(1.0)
    (True, 1e-08)
    """
    memory = checks.flag(memory, "memory")
    sizes = [checks.positive(a, "accuracies", AccuracyError) for a in accuracies]
    if not sizes:
        raise AccuracyError(
            "accuracies: expected at least one, got none. Give some, such as [1e-6, 1e-9]."
        )
    digits = [checks.count(d, "proofs", ArgumentError, 1, 1000) for d in proofs]
    solvers = None if engines is None else tuple(engines)
    ordered = tuple(sorted(sizes, reverse=True))
    request = Request(at, ordered, solvers, parameters, tuple(sorted(digits)))
    offer = offer_of(thing, request)
    runs = [(way, accuracy) for way in offer.ways for accuracy in way.accuracies]
    rows: list[PriceRow] = []
    with reports(progress, "price") as show:
        for way, accuracy in runs:
            rows.append(_row(offer, way, accuracy, memory=memory))
            if show is not None:
                show(len(rows) / len(runs))
        effects = () if offer.effects is None else tuple(offer.effects())
    return PriceList(offer.name, offer.truth, tuple(rows), effects, offer.unit, offer.floor)


def offer_of(thing: Any, request: Request) -> Offer:
    """The ways to the result of a thing.

    Raises
    ------
    ArgumentError
        It has no price.
    """
    for kind, make in KINDS:
        if isinstance(thing, kind):
            return make(thing, request)
    raise ArgumentError(
        "thing: expected a problem, a frame with a loop, a connection, a tensor, a scene, measured "
        f"data or a result, got {checks.shown(thing)}. For the result of a scene give its scene."
    )


def _row(offer: Offer, way: Way, accuracy: float, *, memory: bool) -> PriceRow:
    """One way at one accuracy, for the clock, for its memory and against the truth."""
    row = PriceRow(way.name, way.certainty, accuracy, engine=way.engine or way.name)
    try:
        run = way.ready(accuracy)
        # The first run at an accuracy may compile; a proof does not.
        measured = timed(run, first=way.certainty != "proof")
        peak = _peak(run) if memory and way.certainty != "proof" else None
    except GeomtorsionError as error:
        return replace(row, note=str(error).split(". ")[0])
    value, claimed = measured.result
    true = offer.judge(value, accuracy)
    return replace(
        row,
        claimed=claimed,
        true=true,
        seconds=measured.seconds,
        spread=measured.spread,
        memory=peak,
    )


def _peak(run: Run) -> int:
    """The peak of what Python and NumPy allocate during a run, in bytes."""
    with _TRACING:
        own = not tracemalloc.is_tracing()
        if own:
            tracemalloc.start()
        tracemalloc.reset_peak()
        before = tracemalloc.get_traced_memory()[0]
        try:
            run()
            return max(0, tracemalloc.get_traced_memory()[1] - before)
        finally:
            if own:
                tracemalloc.stop()

"""Burgers: the closure failure of a loop, by two independent routes, with an error that holds."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial
from itertools import chain

import numpy as np

from geomtorsion.errors import ArgumentError
from geomtorsion.geometry import Frame
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.loops.arcs import Parameters, Part
from geomtorsion.loops.defects import lines_alone, winds_around_line
from geomtorsion.loops.domain import refuse_outside
from geomtorsion.loops.forms import forms
from geomtorsion.loops.hidden_flux import hidden_flux
from geomtorsion.loops.integrals import (
    Route,
    agreement,
    flux_route,
    line_route,
    refuse_other_periods,
)
from geomtorsion.loops.loop import Loop, check_loop
from geomtorsion.loops.poles import refuse_poles
from geomtorsion.loops.protocols import HasBurgers
from geomtorsion.loops.result import BurgersVector, Check
from geomtorsion.loops.symbol_values import with_numbers
from geomtorsion.loops.validation import check_accuracy
from geomtorsion.support import checks
from geomtorsion.support.budget import affordable
from geomtorsion.support.hints import argument_hints
from geomtorsion.support.outgoing import size_text

# Accuracy of a Burgers vector for which none is requested.
ACCURACY = 1e-12
HIDDEN = "line: the loop encloses a singular line, which the flux does not contain"


@argument_hints(
    tol="accuracy=1e-8",
    rtol="accuracy=1e-8",
    values="parameters={name: number}",
    exact="exact_burgers_vector(frame, loop)",
)
def burgers_vector(
    frame: FrameLike,
    loop: Loop,
    accuracy: float = ACCURACY,
    *,
    parameters: Parameters | None = None,
    seconds: float | None = None,
) -> BurgersVector:
    """Burgers vector of a loop: the gap in the frame of a loop that closes in the coordinates.

    Equation
    --------
    b^i = loop integral e^i_mu dq^mu = flux of S_{mn}^i dx^m ^ dx^n
    [FizievKleinert1994], below (13)

    Both sides of Stokes are computed: the line integral, by the trapezoid rule on smooth loops, by
    Gauss on the sides of parallelograms and by Gauss and Kronrod on the sides of other polygons;
    and the flux through a parallelogram or the cone over another loop, from the exact curl of the
    coframe. The line integral loses a digit for every decade by which the loop shrinks; the
    flux loses none. If both agree, the result is the more accurate value. If they differ, torsion
    is concentrated on a line or point inside, and the result is the line integral.

    A looser accuracy saves points only where the form oscillates along the loop. Every call takes
    two nested sets of points along the loop and two inside, because their difference is the error
    estimate; on most loops these have 15 digits already, and their number does not depend on the
    accuracy. For one loop most of the time goes into calls, not points: `burgers_map` and
    `burgers_vectors` share them among many loops.

    Narrow peaks of denominators, exp, tanh, atan and erf are found. Another peak, such as a high
    power of a cosine, that is narrower than a fiftieth of a side, or of the radius of a circle, may
    be missed: the route then reports the value without it. `prove` of the result compares the
    error with a bound over the whole loop and reports such a peak.

    Parameters
    ----------
    frame
        A frame, a space, or the name of a shipped one. Measured data have a method for their
        loops, such as `SampledFrame.burgers`, because their spacing determines the error.
    accuracy
        Requested relative error of the vector (largest component); `reached` reports success.
    parameters
        Values of the parameters of frame and loop, {symbol or name: number}.
    seconds
        Processor time instead of an accuracy, as in `solve`: `accuracy` of the result names the
        accuracy that this time buys.

    Returns
    -------
    BurgersVector: b^i in the frame, shape (n,), with error, route, check and cost.

    Raises
    ------
    LoopError
        The loop has another dimension than the frame, or the accuracy is out of range.
    AccuracyError
        Even an accuracy of 1e-2 takes longer than `seconds`.
    ArgumentError
        The frame is measured data; or both seconds and an accuracy are given.
    MissingValueError
        A parameter has no value.
    CoordinateError
        A value contradicts the assumptions of its parameter.
    SingularPointError
        The loop passes through a point where the coframe is singular.
    ChartEdgeError
        The loop leaves the domain that the frame declares.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> x, y, z = sp.symbols("x y z")
    >>> frame = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-y, x, 1]])
    >>> b = burgers_vector(frame, Loop.circle([5, 0, 0], 1e-9))
    >>> b.vector, b.route, b.check.agrees
    (array([0.00000000e+00, 0.00000000e+00, 6.28318531e-18]), 'flux', True)
    """
    if isinstance(frame, HasBurgers):
        raise ArgumentError(
            "frame: expected a frame given by formulas, got measured data, which have a method for "
            "their loops. Use data.burgers(loop)."
        )
    frame = as_frame(frame)
    check_loop(loop, frame.dimension)
    if seconds is not None:
        if accuracy != ACCURACY:
            raise ArgumentError(
                "seconds: expected no accuracy, because seconds choose it; got "
                f"accuracy={checks.shown(accuracy)}. Give one of them."
            )
        run = partial(burgers_vector, frame, loop, parameters=parameters)
        accuracy = affordable(run, seconds, "a shorter loop")
    check_accuracy(accuracy)

    start = time.perf_counter()
    loop, parameters = with_numbers(frame, loop, parameters)
    compiled = forms(frame, parameters)
    for part in loop.parts:
        refuse_other_periods(compiled, part)
    near = [refuse_poles(compiled.poles, part) for part in loop.parts]
    refuse_outside(frame, loop.parts, parameters)
    pairs = [
        (line_route(compiled, part, accuracy, cuts), flux_route(compiled, part, accuracy))
        for part, cuts in zip(loop.parts, near, strict=True)
    ]
    only_lines = not any(near) or lines_alone(frame, compiled.poles)
    beside = [bool(cuts) and not only_lines for cuts in near]
    chosen = _choices(loop, pairs, beside, accuracy)
    if compiled.poles is not None:
        chosen = _without_hidden(frame, loop, pairs, chosen, parameters)
    routes, verdicts, reasons = zip(*chosen, strict=True)
    power = min(route.power for route in routes)
    with np.errstate(over="ignore", invalid="ignore"):
        # Loops beyond 1e154 have vectors beyond all doubles; `numbers` has them.
        reduced, error = _total(loop, routes, power)
        if error == 0 and compiled.curl is not None:
            # Samples that are zero do not show that the torsion is.
            error = hidden_flux(frame, loop.parts, parameters) / loop.size**power
        check = _check(loop, pairs, verdicts)
    return BurgersVector(
        frame=frame,
        loop=loop,
        reduced=reduced,
        reduced_error=error,
        size=loop.size,
        power=power,
        route=" and ".join(sorted({_name(route) for route in routes}, reverse=True)),
        reason="; ".join(dict.fromkeys(reasons)),
        check=check,
        accuracy=accuracy,
        evaluations=sum(route.points for route in chain(*pairs) if route is not None),
        seconds=time.perf_counter() - start,
        parameters={str(key): value for key, value in (parameters or {}).items()},
    )


def _name(route: Route) -> str:
    """What a route is called."""
    return "flux" if route.power == 2 else "line"


def _chosen(
    part: Part, line: Route, flux: Route | None, accuracy: float
) -> tuple[Route, bool | None, str]:
    """The better route, whether both agree, and why it was chosen."""
    if flux is None:
        return (
            line,
            None,
            "line: the flux does not converge, the torsion is not smooth inside (or too wavy)",
        )
    agrees, better = (bool(x[0]) for x in agreement(line, flux, np.array([part.size])))
    if not agrees:
        return (
            line,
            False,
            "line: the flux of the torsion differs, so the loop encloses a defect of the frame",
        )
    if not better:
        return line, True, "line: both methods agree; this one is more accurate"
    error, largest = float(line.error[0]), float(np.abs(line.values).max())
    if error <= accuracy * largest:
        return flux, True, "flux: both methods agree; this one is more accurate"
    digits = f"{error / largest:.0e}" if largest else "no digit"
    why = f"flux: the loop is so small that the line integral is good to {digits} of b only"
    return flux, True, why


def _choices(
    loop: Loop,
    pairs: Sequence[tuple[Route, Route | None]],
    beside: Sequence[bool],
    accuracy: float,
) -> list[tuple[Route, bool | None, str]]:
    """The route of each part, whether both routes agree, and why it was chosen.

    pairs: line and flux of each part. beside: whether a part runs beside a pole of unknown shape.
    """
    return [
        _near_pole(part, *pair) if near else _chosen(part, *pair, accuracy)
        for part, pair, near in zip(loop.parts, pairs, beside, strict=True)
    ]


def _without_hidden(
    frame: Frame,
    loop: Loop,
    pairs: Sequence[tuple[Route, Route | None]],
    chosen: Sequence[tuple[Route, bool | None, str]],
    parameters: Parameters | None,
) -> list[tuple[Route, bool | None, str]]:
    """The choices, but the line integral where the flux misses the charge of an enclosed line."""
    return [
        (pair[0], False, HIDDEN)
        if choice[0] is pair[1] and winds_around_line(frame, loop, part, parameters)
        else choice
        for part, pair, choice in zip(loop.parts, pairs, chosen, strict=True)
    ]


def _near_pole(part: Part, line: Route, flux: Route | None) -> tuple[Route, bool | None, str]:
    """Only the line, so near to a pole of unknown shape that it may or may not be inside."""
    why = "line: so near to a pole, the flux does not decide on which side of the loop it is"
    if flux is None:
        return line, None, why
    return line, bool(agreement(line, flux, np.array([part.size]))[0][0]), why


def _total(loop: Loop, routes: Sequence[Route], power: int) -> tuple[np.ndarray, float]:
    """Sum over the parts of a loop and its error, in units of size**power."""
    total, error, size = np.zeros(1), 0.0, loop.size
    for part, route in zip(loop.parts, routes, strict=True):
        share = part.size / size
        scale = share**route.power * size ** (route.power - power)
        total = total + part.times * scale * route.values[:, 0]
        error += abs(part.times) * scale * float(route.error[0])
    return total, error


def _check(
    loop: Loop, pairs: Sequence[tuple[Route, Route | None]], verdicts: Sequence[bool | None]
) -> Check:
    """Both routes over the whole loop, side by side."""
    line, line_error = _total(loop, [line for line, _ in pairs], 1)
    fluxes = [flux for _, flux in pairs if flux is not None]
    size = loop.size
    line, line_error = line * size, line_error * size
    rules = ", ".join(dict.fromkeys(route.rule for route, _ in pairs))
    if len(fluxes) < len(pairs):
        text = f"line ({rules}); no flux to compare with: the torsion is not smooth inside"
        return Check(line, line_error, None, None, None, text)
    flux, flux_error = _total(loop, fluxes, 1)
    flux, flux_error = flux * size, flux_error * size
    agrees = all(verdict is True for verdict in verdicts)
    others = ", ".join(dict.fromkeys(route.rule for route in fluxes))
    word = "agree to" if agrees else "DISAGREE: a defect is enclosed; they differ by"
    text = f"line ({rules}) and flux ({others}) {word} {size_text(abs(line - flux).max())}"
    return Check(line, line_error, flux, flux_error, agrees, text)

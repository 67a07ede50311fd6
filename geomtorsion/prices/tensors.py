"""Tensors: the price of the digits of their components at a point."""

from __future__ import annotations

from functools import partial
from typing import Any

import mpmath
import numpy as np

from geomtorsion.errors import ArgumentError
from geomtorsion.geometry import Curvature, Tensor, Torsion
from geomtorsion.prices import offer as offers
from geomtorsion.prices.offer import Bounds, Claim, Offer, Request, Way
from geomtorsion.support import checks
from geomtorsion.support.precision import working_digits


def tensor_offer(thing: Tensor | Torsion | Curvature, request: Request) -> Offer:
    """The price of all components of a tensor at request.at.

    thing: a tensor; a torsion means S, a curvature the Riemann tensor, as they print.
    at: {coordinate or parameter: value}, or the values of all coordinates in order.

    Raises
    ------
    ArgumentError
        There is no point, or it does not have one value for each coordinate.
    """
    if request.at is None:
        raise ArgumentError(
            "at: expected a point for a tensor, got None. Give one, such as {'r': 3}."
        )
    if isinstance(thing, Tensor):
        tensor = thing
    else:
        tensor = thing.S if isinstance(thing, Torsion) else thing.riemann
    place = request.at
    if checks.is_list(place):
        coordinates = tensor.frame.coordinates
        values = checks.numbers(place, len(coordinates), "at", ArgumentError)
        place = dict(zip(coordinates, values, strict=True))
    point = {**checks.table(place, "at"), **(request.parameters or {})}
    # Twice as many digits as the finest row.
    digits = 2 * max(offers.digits_of(a) for a in (*request.accuracies, *request.proved))
    truth = tensor.at(point, digits=digits)
    with working_digits(digits):
        scale = max((abs(x) for x in truth.ravel()), default=mpmath.mpf(0)) or mpmath.mpf(1)
    accuracies = sorted({*request.accuracies, *request.proved}, reverse=True)
    ways = [
        Way("float", "plain", lambda a: partial(_floats, tensor, point), (2.0**-53,)),
        Way("digits", "estimate", lambda a: partial(_digits, tensor, point, a), accuracies),
    ]

    def judged(value: np.ndarray, accuracy: float) -> Bounds:
        with working_digits(digits):
            gaps = [
                abs(mpmath.mpmathify(x) - y)
                for x, y in zip(value.ravel().tolist(), truth.ravel().tolist(), strict=True)
            ]
            gap = float(max(gaps, default=mpmath.mpf(0)) / scale)
        return Bounds(gap, gap)

    title = f"{tensor.name or 'tensor'} at a point"
    return Offer(title, ways, f"{digits} digits", judged)


def _floats(tensor: Tensor, point: Any) -> Claim:
    return Claim(tensor.at(point), None)


def _digits(tensor: Tensor, point: Any, accuracy: float) -> Claim:
    return Claim(tensor.at(point, digits=offers.digits_of(accuracy)), accuracy)

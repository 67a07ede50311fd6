"""Gaps: the gap of a varied path as equations beside the motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion import checks
from geomtorsion.action.tangent_bundle import bundle_over
from geomtorsion.errors import ExpressionError, ShapeError
from geomtorsion.exact import parse_expression
from geomtorsion.ode import ODE, When

if TYPE_CHECKING:
    from geomtorsion.action.variations import Variation

LIST = "{subject}: expected a list, got {value}. Give dPhi^i for each leg, as text or expressions."


def gap_ode(
    variation: Variation, motion: ODE, images: Sequence[object], parameters: Mapping[str, object]
) -> ODE:
    """See Variation.gap_ode."""
    frame = variation.frame
    checks.instance(motion, ODE, "motion")
    coordinates = [symbol.name for symbol in frame.coordinates]
    missing = [name for name in coordinates if name not in motion.states]
    if missing:
        raise ShapeError(
            f"motion: expected the coordinates {', '.join(coordinates)} among its states, got "
            f"{', '.join(motion.states)}. Give the equations of the path, with ODE.of."
        )
    gaps = [symbol.name for symbol in variation.gaps]
    taken = sorted({*gaps} & {*motion.states, *motion.rates.parameters, motion.time_name})
    if taken:
        raise ExpressionError(
            f"motion: expected names other than {', '.join(taken)}, which the gap has. Rename them."
        )
    velocities = _velocities(variation, motion)
    varied = _images(variation, motion, images, parameters)
    meanings = dict(zip(variation.velocities, velocities, strict=True))
    meanings |= dict(zip(variation.images, varied, strict=True))
    rates = [rate.xreplace(meanings) for rate in variation.gap_rates]
    stop = motion.rates.stop
    return ODE.of(
        {**motion.rates.expressions, **dict(zip(gaps, rates, strict=True))},
        {**dict(zip(motion.states, motion.start, strict=True)), **dict.fromkeys(gaps, 0)},
        parameters={**motion.parameters, **parameters},
        invariants=motion.invariants,
        outputs={
            **motion.outputs,
            "frame_velocity": velocities,
            "image": varied,
            "moved": [shift.xreplace(meanings) for shift in variation.coordinates],
        },
        time=motion.time_name,
        events=[*motion.events, *([] if stop is None else [When(stop)])],
        normalized=motion.normalized,
        name=f"gap beside {motion.name or 'a path'}",
    )


def _velocities(variation: Variation, motion: ODE) -> list[sp.Expr]:
    """u^i = e^i_mu q'^mu with the rates of the motion, exact, so that u^i of a state is a state."""
    bundle = bundle_over(variation.frame, [])
    frame = bundle.frame
    own = {x.name: x for x in (*frame.coordinates, *frame.parameters, *variation.velocities)}
    rates = []
    for symbol in frame.coordinates:
        rate = motion.rates.expressions[symbol.name]
        renamed = {x: own.get(str(x), x) for x in rate.free_symbols}
        rates.append((f"rate of {symbol.name}", rate.xreplace(renamed)))
    steps = frame.read(rates)
    rows = frame.coframe.components.rows
    return [frame.field.sum([(1, x, steps[mu]) for mu, x in row]).sympy for row in rows]


def _images(
    variation: Variation, motion: ODE, images: Sequence[object], parameters: Mapping[str, object]
) -> list[sp.Expr]:
    """dPhi^i as expressions over the states, parameters and time of the motion."""
    entries, n = checks.entries(images, "images", ShapeError, message=LIST), len(variation.images)
    if len(entries) != n:
        raise ShapeError(
            f"images: expected {n} functions dPhi^i, one for each leg, got {len(entries)}."
        )
    names = (*motion.states, *motion.rates.parameters, *parameters, motion.time_name)
    table = {name: sp.Symbol(name, real=True) for name in names}
    return [
        checks.expression(
            entry,
            f"images[{k}]",
            read=lambda text, k=k: parse_expression(
                text, table, where=f"images[{k}]", decimals=True
            ),
        )
        for k, entry in enumerate(entries)
    ]

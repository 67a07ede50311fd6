"""Gaps: the gap of a varied path as equations beside the motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from geomtorsion.action.tangent_bundle import bundle_over, symbols_of
from geomtorsion.errors import ExpressionError, ShapeError
from geomtorsion.exact import parse_expression
from geomtorsion.geometry import Frame
from geomtorsion.ode import ODE, When
from geomtorsion.support import checks

REMEDY = "Give dPhi^i for each leg, as text or expressions."


@dataclass(frozen=True)
class Gap:
    """The gap of a variation, in symbols.

    frame: the frame of the velocities u^i.
    images: dPhi^i. symbols: b^i.
    rates: b'^i over q, u, dPhi and b.
    shifts: dq^mu over q, dPhi and b.
    """

    frame: Frame
    images: tuple[sp.Symbol, ...]
    symbols: tuple[sp.Symbol, ...]
    rates: tuple[sp.Expr, ...]
    shifts: tuple[sp.Expr, ...]

    def beside(
        self, motion: ODE, functions: Sequence[object], parameters: Mapping[str, object]
    ) -> ODE:
        """The motion with the gap as further states; see Variation.gap_ode."""
        checks.instance(motion, ODE, "motion")
        coordinates = [symbol.name for symbol in self.frame.coordinates]
        if not set(coordinates) <= {*motion.states}:
            raise ShapeError(
                f"motion: expected the coordinates {', '.join(coordinates)} among its states, got "
                f"{', '.join(motion.states)}. Give the equations of the path, with ODE.of."
            )
        gaps = [symbol.name for symbol in self.symbols]
        taken = sorted({*gaps} & {*motion.states, *motion.rates.parameters, motion.time_name})
        if taken:
            raise ExpressionError(
                f"motion: expected names other than {', '.join(taken)}, which the gap has. Rename "
                "them."
            )
        velocities = _velocities(self.frame, motion)
        varied = _varied(len(self.images), motion, functions, parameters)
        meanings = dict(zip(symbols_of(self.frame).velocities, velocities, strict=True))
        meanings |= dict(zip(self.images, varied, strict=True))
        rates = [rate.xreplace(meanings) for rate in self.rates]
        ends = [When(stop) for stop in motion.rates.stops]
        return ODE.of(
            {**motion.rates.expressions, **dict(zip(gaps, rates, strict=True))},
            {**dict(zip(motion.states, motion.start, strict=True)), **dict.fromkeys(gaps, 0)},
            parameters={**motion.parameters, **parameters},
            invariants=motion.invariants,
            outputs={
                **motion.outputs,
                "frame_velocity": velocities,
                "image": varied,
                "moved": [shift.xreplace(meanings) for shift in self.shifts],
            },
            time=motion.time_name,
            events=[*motion.events, *motion.switches, *ends],
            normalized=motion.normalized,
            name=f"gap beside {motion.name or 'a path'}",
        )


def _velocities(frame: Frame, motion: ODE) -> list[sp.Expr]:
    """u^i = e^i_mu q'^mu with the rates of the motion, exact, so that u^i of a state is a state."""
    bundle = bundle_over(frame, [])
    own = bundle.frame
    symbols = (*own.coordinates, *own.parameters, *bundle.symbols.velocities)
    table = {symbol.name: symbol for symbol in symbols}
    rates = []
    for symbol in own.coordinates:
        rate = motion.rates.expressions[symbol.name]
        renamed = {x: table.get(str(x), x) for x in rate.free_symbols}
        rates.append((f"rate of {symbol.name}", rate.xreplace(renamed)))
    steps = own.read(rates)
    rows = own.coframe.components.rows
    return [own.field.sum([(1, x, steps[mu]) for mu, x in row]).sympy for row in rows]


def _varied(
    n: int, motion: ODE, functions: Sequence[object], parameters: Mapping[str, object]
) -> list[sp.Expr]:
    """dPhi^i as expressions over the states, parameters and time of the motion."""
    entries = checks.entries(functions, "images", ShapeError, remedy=REMEDY)
    checks.check_one_each(entries, n, "legs", "images", ShapeError, REMEDY)
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

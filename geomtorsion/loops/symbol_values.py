"""Values: numbers for the symbols of a frame and a loop in it, given together."""

from __future__ import annotations

import numpy as np

from geomtorsion.errors import LoopError
from geomtorsion.geometry import Frame
from geomtorsion.geometry.domain_edges import is_angle
from geomtorsion.loops import validation
from geomtorsion.loops.arcs import Parameters, exact_number, shown
from geomtorsion.loops.forms import refuse_unknown
from geomtorsion.loops.loop import Loop, filled
from geomtorsion.support import checks


def with_numbers(
    frame: Frame, loop: Loop, parameters: Parameters | None
) -> tuple[Loop, Parameters | None]:
    """A loop with numbers for its symbols, and the values that are left for the frame.

    Raises
    ------
    MissingValueError
        A symbol of the loop has no value.
    LoopError
        The loop closes only modulo turns that nobody declared.
    """
    if not loop.symbols:
        refuse_undeclared_turns(frame, loop)
        return loop, parameters
    names = {symbol.name for symbol in frame.field.symbols}
    alone = {symbol.name for symbol in loop.symbols} - names
    numeric_loop = loop.at(parameters or {})
    refuse_undeclared_turns(frame, numeric_loop)
    return numeric_loop, {k: v for k, v in (parameters or {}).items() if str(k) not in alone}


def with_values(frame: Frame, loop: Loop, parameters: Parameters | None) -> tuple[Frame, Loop]:
    """A frame and a loop with exact values for some of their symbols: 0.3 becomes 3/10.

    Raises
    ------
    UnknownNameError
        A name means nothing to frame and loop.
    """
    values = checks.by_name(parameters, "parameters", LoopError)
    if not values:
        refuse_undeclared_turns(frame, loop)
        return frame, loop
    of_loop = {symbol.name for symbol in loop.symbols}
    of_frame = {symbol.name for symbol in frame.parameters}
    left = {
        name: exact_number(validation.exact_input(value, name))
        for name, value in values.items()
        if name in of_frame or name not in of_loop
    }
    refuse_unknown(frame, left)
    loop = filled(loop, values)
    refuse_undeclared_turns(frame, loop)
    return frame.subs(left) if left else frame, loop


def refuse_undeclared_turns(frame: Frame, loop: Loop) -> None:
    """Refuse a loop whose ends are whole turns apart in a coordinate without a declared turn.

    Raises
    ------
    LoopError
        The domain of the frame does not give such a coordinate one turn.
    """
    for part in loop.parts:
        for column in np.flatnonzero(part.gap).tolist() if part.assumed else ():
            symbol = frame.coordinates[column]
            if not is_angle(frame, symbol):
                raise LoopError(
                    f"curve: it does not close: the gap between its ends is "
                    f"{shown(part.size * np.array(part.gap))}. Choose the interval so that both "
                    f"ends meet. If {symbol} is an angle, declare it: periods={{{column}: '2*pi'}} "
                    f"of the curve, or domain=[{symbol} > 0, {symbol} < 2*pi] of the frame."
                )

"""Values: numbers for the symbols of a frame and a loop in it, given together."""

from __future__ import annotations

from geomtorsion.errors import LoopError
from geomtorsion.geometry import Frame
from geomtorsion.loops import validation
from geomtorsion.loops.arcs import Parameters, exact_number
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
    """
    if not loop.symbols:
        return loop, parameters
    names = {symbol.name for symbol in frame.field.symbols}
    alone = {symbol.name for symbol in loop.symbols} - names
    numeric_loop = loop.at(parameters or {})
    return numeric_loop, {k: v for k, v in (parameters or {}).items() if str(k) not in alone}


def with_values(frame: Frame, loop: Loop, parameters: Parameters | None) -> tuple[Frame, Loop]:
    """A frame and a loop with exact values for some of their symbols: 0.3 is put in as 3/10.

    Raises
    ------
    UnknownNameError
        A name means nothing to frame and loop.
    """
    values = checks.by_name(parameters, "parameters", LoopError)
    if not values:
        return frame, loop
    of_loop = {symbol.name for symbol in loop.symbols}
    of_frame = {symbol.name for symbol in frame.parameters}
    left = {
        name: exact_number(validation.exact_input(value, name))
        for name, value in values.items()
        if name in of_frame or name not in of_loop
    }
    refuse_unknown(frame, left)
    return frame.subs(left) if left else frame, filled(loop, values)

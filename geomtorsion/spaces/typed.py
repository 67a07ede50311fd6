"""Typed: a line element or one-forms in one text as a space, with the names read from it."""

from __future__ import annotations

import re

from geomtorsion.errors import CoordinateError
from geomtorsion.exact import names as words
from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import Space
from geomtorsion.support import checks
from geomtorsion.support.outgoing import one_line
from geomtorsion.support.typed_text import ANGLES, DIFFERENTIAL, QUADRATIC, SPHERE, separated

_NAME = re.compile(r"(?<![^\W\d])[^\W\d]\w*(?!\w|\s*\()")
_LENGTH = re.compile(r"(?<!\w)ds(?!\w)")


def typed_space(text: str) -> Space:
    """The space of a line element, or of one-forms separated by commas.

    The coordinates are the names after d, in their order. Other names are real parameters, and
    f(r) is an unknown function. dOmega^2 is the unit sphere of theta and phi.

    Raises
    ------
    CoordinateError
        The text has no differential.
    ExpressionError, MetricError, CoframeError
        The text is neither a line element nor a list of one-forms.

    Examples
    --------
    >>> typed_space("-(1 - 2M/r) dt^2 + dr^2/(1 - 2M/r) + r^2 dOmega^2").frame.parameters
    (M,)
    >>> typed_space("dr, r dtheta").frame.coframe[1, 1]
    r
    """
    checks.text(text, "space", CoordinateError)
    sphere = SPHERE.search(text)
    found = [(match.start(1), match[1][1:]) for match in DIFFERENTIAL.finditer(text)]
    if sphere:
        pair = next(pair for pair in ANGLES if ("Ω" in sphere[0]) == (pair[0] == "θ"))
        known = {name for _, name in found} & {x for both in ANGLES for x in both}
        found += [] if known else [(sphere.start(), name) for name in pair]
    coordinates = list(dict.fromkeys(name for _, name in sorted(found, key=lambda x: x[0])))
    if not coordinates:
        raise CoordinateError(
            f"space: expected differentials such as dr, got {checks.shown(text)}. Write for "
            'instance "dr^2 + r^2 dtheta^2".'
        )
    rest = _LENGTH.sub("", SPHERE.sub("", text))
    taken = {*coordinates, *(f"d{name}" for name in coordinates), *words.CONSTANTS}
    parameters = [x for x in dict.fromkeys(_NAME.findall(rest)) if x not in taken]
    forms = separated(text)
    title = one_line(text)
    if len(forms) > 1 or not QUADRATIC.search(text):
        frame = Frame(coordinates, forms, parameters=parameters, name="typed")
    else:
        frame = Frame.from_metric(coordinates, text, parameters=parameters, name="typed")
    return Space(name="typed", title=title, source=title, frame=frame, group="your own")

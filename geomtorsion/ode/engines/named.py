"""Named: the engines of this package, by the names that files keep."""

from __future__ import annotations

import re

from geomtorsion.errors import UnknownNameError
from geomtorsion.ode.engines.runge_kutta import METHODS, RungeKutta, Stiff
from geomtorsion.ode.engines.taylor import Taylor
from geomtorsion.ode.system import Engine
from geomtorsion.support.checks import cut

# All engines of this package; the first of each class is what the command line calls by its class.
SHIPPED: tuple[Engine, ...] = (Taylor(), RungeKutta(), *map(Stiff, METHODS))
_TAYLOR = re.compile(r"Taylor(?:\((?:(\d{1,4})|(?:(\d{1,4}), )?(optimised))\))?")


def is_own(name: str) -> bool:
    """Whether an engine of this package has a name."""
    return _TAYLOR.fullmatch(name) is not None or any(engine.name == name for engine in SHIPPED)


def engine_named(name: str) -> Engine:
    """The engine of this package with a name.

    Raises
    ------
    UnknownNameError
        no engine of this package has the name.

    Examples
    --------
    >>> engine_named("Taylor(113)").precision, engine_named("Stiff(LSODA)").name
    (113, 'Stiff(LSODA)')
    """
    taylor = _TAYLOR.fullmatch(name)
    if taylor is not None:
        alone, before, optimised = taylor.groups()
        return Taylor(precision=int(alone or before or 53), optimised=optimised is not None)
    for engine in SHIPPED:
        if engine.name == name:
            return engine
    raise UnknownNameError(f"expected {', '.join(x.name for x in SHIPPED)}, got {cut(name)}.")


def own_name(engine: Engine) -> str:
    """The name of an engine of this package; empty for an engine of the user's own."""
    name = engine.name
    return name if is_own(name) and type(engine_named(name)) is type(engine) else ""

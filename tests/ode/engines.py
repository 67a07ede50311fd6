"""Engines on which the tests of motions run: all that are installed."""

import pytest

from geomtorsion.ode import RungeKutta, Taylor
from geomtorsion.ode.engines.taylor import is_available

ENGINES = [RungeKutta(), *([Taylor()] if is_available() else [])]
every_engine = pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
needs_heyoka = pytest.mark.skipif(not is_available(), reason="heyoka is not installed")

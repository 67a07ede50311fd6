"""Random loops of all sizes in several spaces: errors hold, and both routes agree."""

import numpy as np
import pytest

import geomtorsion.spaces as spaces
from geomtorsion.geometry import blend, cartan, levi_civita
from geomtorsion.loops import Loop, develop

SPACES = {
    "so3": ((0.3, 1.0, 0.2), {}),
    "schwarzschild": ((0, 6, 1.2, 0.3), {"M": 1}),
    "sol": ((0.1, 0.2, 0.3), {}),
    "screw_core": ((0.1, 0.2, 0), {"b": 1, "c": 0.3}),
}


@pytest.mark.parametrize("name", SPACES)
def test_errors_hold_and_routes_agree(name):
    """Bounds cover the distance to a much tighter result; Stokes holds within the errors."""
    centre, values = SPACES[name]
    frame = spaces.load(name).frame
    numbers = {symbol.name: 1.0 for symbol in frame.parameters} | values
    rng = np.random.default_rng(sum(map(ord, name)))
    checked = 0
    for connection in (cartan(frame), levi_civita(frame), blend(levi_civita(frame), cartan(frame))):
        for k in range(4):
            size, accuracy = 10 ** rng.uniform(-12, -0.5), 10 ** rng.uniform(-10, -4)
            maker = Loop.polygon if k % 2 else Loop.spline
            loop = maker(rng.normal(size=(5, len(centre))).tolist(), centre, size)
            rough = develop(connection, loop, accuracy, parameters=numbers)
            fine = develop(connection, loop, 1e-15, parameters=numbers)
            apart = np.abs(rough.motion.increment - fine.motion.increment)
            assert apart[:-1, -1].max() <= rough.error + fine.error
            assert apart[:-1, :-1].max() <= rough.turn_error + fine.turn_error
            assert rough.check.agrees is True
            assert fine.check.agrees is True
            checked += 1
    assert checked == 12

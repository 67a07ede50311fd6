"""inlined: functions written out give what they gave, and what is not plain is left."""

import math

import pytest

from geomtorsion.exact.compile import python_function
from geomtorsion.geometry import levi_civita
from geomtorsion.motion import geodesic
from geomtorsion.motion.engines.inlined import inlined
from geomtorsion.motion.engines.stepper import Steps
from geomtorsion.spaces import load

NESTED = """def inner(x, y):
    t0 = x*y
    t1 = t0 + sin(x)
    return (t1, t0*t1,)
def outer(a, x):
    t0, t1, = inner(x, a)
    u, v, = inner(t1, t0)
    return (t0 - u, v,)
def values(a0, a1, a2):
    t0 = a0/a1
    t1, t2, = outer(t0, a2)
    return (t1 - t0, t2*t2, a2,)"""


def test_nested_functions():
    """Names of several functions do not meet; the same operations in the same order."""
    plain = inlined(NESTED)
    assert plain is not None
    lines, results = plain
    flat = "\n    ".join(["def values(a0, a1, a2):", *lines, f"return ({', '.join(results)},)"])
    numbers = 0.3, -1.7, 2.1
    one, two = (python_function(source, {"sin": math.sin}) for source in (flat, NESTED))
    assert one(*numbers) == two(*numbers)


@pytest.mark.parametrize(
    "source",
    [
        "def other(a0):\n    return (a0,)",
        "def values(a0):\n    return a0",
        "def values(a0):\n    a0 += 1\n    return (a0,)",
        "def values(a0):\n    if a0:\n        b = a0\n    return (b,)",
        "def values(a0):\n    b = c = a0\n    return (b,)",
        "def two(x):\n    return (x, x,)\ndef values(a0):\n    b, = two(a0)\n    return (b,)",
        "def values(a0):\n    b, = values(a0)\n    return (b,)",
    ],
)
def test_what_is_not_plain(source):
    """Such rates are called."""
    assert inlined(source) is None


def test_steps_are_the_same_where_rates_are_called(monkeypatch):
    """Written into the step or called, in all states, those which rates do not ask for too."""
    from geomtorsion.motion.engines import dop853
    from geomtorsion.motion.journey import departure

    hole = geodesic(
        levi_civita(load("kerr").frame), [0, 8.0, 1.4, 0],
        frame_velocity=[1.2, 0.05, 0.2, 0.6], parameters={"M": 1, "a": 0.6},
    )  # fmt: skip
    chart, _, vector, values = departure(hole, 53)
    system = hole.equations(chart).system
    start, numbers = [float(x) for x in vector], [float(x) for x in values]
    ends = []
    for longest in (10**9, 0):
        monkeypatch.setattr(dop853, "LONGEST_SOURCE", longest)
        dop853._made.cache_clear()
        walk = Steps(system, numbers, start, (0.0, 40.0), 1e-9, [1.0] * 8, math.inf, 10**6)
        pieces = []
        while walk.time != 40.0:
            piece = walk.advance()
            assert piece is not None
            pieces.append(piece._rows)
        ends.append((walk.state, pieces))
    dop853._made.cache_clear()
    assert ends[0] == ends[1]

"""Seconds that were requested and seconds that a motion took.

Run with `python -m pytest tests/benchmarks/test_seconds.py -s` on a quiet machine. Errors are
asserted, times are printed. Often no accuracy costs the requested time, because the next digit
needs another run or longer numbers, and the time jumps by a factor of two to five. The time for a
tenth of a digit more shows where this is the case.
"""

from __future__ import annotations

import pytest

import geomtorsion as gt
from geomtorsion.support.budget import timed

SECONDS = (0.002, 0.01, 0.05)
# The finest accuracy that seconds buy, and the factor between two accuracies.
FINEST, TENTH = 1.001e-12, 10**0.1


@pytest.mark.parametrize("engine", [None, gt.RungeKutta()], ids=["chosen", "RungeKutta"])
def test_seconds_requested_and_taken(engine, capsys):
    """The accuracy that a time buys is reached, and its run takes at most about this time."""
    top = gt.geodesic("so3", frame_velocity=[1, 2, 3], metric=[1, 2, 3])
    lines = []
    for t in (5.0, 500.0, 5000.0):
        for seconds in SECONDS:
            try:
                bought = gt.solve(top, t, engine=engine, seconds=seconds)
            except gt.errors.AccuracyError as error:
                assert "seconds: expected at least" in str(error)  # noqa: PT017  # part of a sweep
                continue
            assert bought.error <= bought.accuracy
            again = timed(lambda a=bought.accuracy, t=t: gt.solve(top, t, a, engine))
            line = f"t = {t:6g}: {1e3 * seconds:5g} ms bought {bought.accuracy:.1e}, which takes "
            line += f"{100 * again.seconds / seconds:.0f} % of it"
            if bought.accuracy > FINEST:
                more = bought.accuracy / TENTH
                finer = timed(lambda a=more, t=t: gt.solve(top, t, a, engine), first=True)
                line += f"; a tenth of a digit more takes {100 * finer.seconds / seconds:.0f} %"
            lines.append(line)
    assert lines
    with capsys.disabled():
        print("", *lines, sep="\n")

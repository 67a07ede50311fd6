"""Allowance: limits of time and memory act in time or change nothing; finished work is kept."""

import itertools
import os
import random
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import flint
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import AllowanceError, ArgumentError, LimitError
from geomtorsion.exact import Field
from geomtorsion.support.precision import ball_precision

t, r, x, y, z = sp.symbols("t r x y z", real=True)
f, g = sp.Function("f"), sp.Function("g")
# Some seconds of work of all kinds: reading, signs of roots, sums, zeros, writing.
ROWS = [
    [2 + f(x) * sp.sqrt(y + 3), sp.sin(x * y) + z, sp.exp(z) / 3],
    [sp.tan(y / 2), 3 + g(z) * sp.sqrt(x**2 + 1), x * z + sp.cos(y - z)],
    [sp.atan(x) * y, sp.sqrt(z + 2) / 2, 4 + f(y) * sp.sinh(z)],
]
SMALL = [
    [2 + sp.sqrt(t + 3) * r, sp.sqrt(r**2 + t + 1), 0],
    [sp.cbrt(t + 2) * r + 1, f(t) * sp.cos(r - t / 3) / 2 - sp.sqrt(r + 2), 1],
    [sp.log(r + t), sp.tan(r / 2), 3 + sp.exp(t - r)],
]


def endless(frame):
    """Work without end, longer than any limit of a test."""
    torsion = gt.cartan(frame).torsion.T
    for power in itertools.count(1):
        _ = (torsion * power).to_sympy()


def test_a_limit_of_time_is_met_in_time():
    """The error is an AllowanceError that names the quantity and the limit."""
    frame = gt.Frame([x, y, z], ROWS)
    with (
        pytest.raises(AllowanceError, match=r"takes more than 0\.5 s") as caught,
        gt.limits(seconds=0.5),
    ):
        endless(frame)
    assert isinstance(caught.value, LimitError)
    assert caught.value.quantity
    assert caught.value.quantity in str(caught.value)
    assert "Finished quantities are kept" in str(caught.value)


def again_and_again():
    """The same geometry again and again, each time from a new frame."""
    while True:
        curvature = gt.levi_civita(gt.Frame([x, y, z], ROWS)).curvature
        _ = curvature.ricci.is_zero, curvature.kretschmann.is_zero


def test_the_quantity_is_named():
    """The error names the requested quantity by its tensor or by the call."""
    with pytest.raises(AllowanceError) as caught, gt.limits(seconds=0.3):
        again_and_again()
    asked = (
        "Frame",
        "inverse frame metric",
        "Ricci tensor",
        "Kretschmann",
        "curvature",
        "Curvature",
    )
    assert caught.value.quantity.startswith((*asked, "levi_civita"))


def grow(kept):
    """Compute powers without end and keep them all."""
    while True:
        kept.append(Field([x, y, z]).read(1 + x + y + z) ** 40)


def test_a_limit_of_memory_is_met():
    """The message names the limit of memory."""
    with pytest.raises(AllowanceError, match=r"takes more than 50 MB"), gt.limits(megabytes=50):
        grow([])


def test_limits_that_are_not_met_do_nothing():
    """The value is the same as without limits."""
    with gt.limits(seconds=100, megabytes=4000):
        inside = gt.spaces.load("kerr").frame.quantity("kretschmann")[()]
    assert inside == gt.spaces.load("kerr").frame.quantity("kretschmann")[()]


def within_less():
    """An inner limit that ends its work, followed by work without end."""
    with pytest.raises(AllowanceError, match=r"more than 0\.2 s"), gt.limits(seconds=0.2):
        again_and_again()
    again_and_again()


def test_nested_limits():
    """The inner limit acts first, then the outer limit."""
    with pytest.raises(AllowanceError, match=r"more than 0\.5 s"), gt.limits(seconds=0.5):
        within_less()


def test_errors_inside_stay_what_they_are():
    """An error of another class passes through the limits."""
    with pytest.raises(ZeroDivisionError), gt.limits(seconds=10):
        _ = 1 / 0


@pytest.mark.parametrize("wrong", [{}, {"seconds": 0}, {"megabytes": -1}, {"seconds": "soon"}])
def test_bad_limits_are_refused(wrong):
    """Missing, non-positive and non-numeric limits are refused at the call."""
    with pytest.raises(ArgumentError):
        gt.limits(**wrong)


def everything(frame):
    """Texts of the results, computed step by step."""
    curvature = gt.levi_civita(frame).curvature
    cartan = gt.cartan(frame)
    assert cartan.curvature.is_zero
    return [
        str(frame.metric.to_sympy()),
        str(frame.anholonomy.nonzero()),
        str(curvature.ricci.is_zero),
        str(curvature.scalar.at(PLACE)),
    ]


PLACE = {t: 0.3, r: 0.7, z: 0.1, f(t): 1.5, sp.diff(f(t), t): 0.25, sp.diff(f(t), t, 2): -0.5}


def test_finished_work_is_kept_and_right():
    """Work interrupted at many moments and resumed gives the same as work without a limit."""
    plain = everything(gt.Frame([t, r, z], SMALL))
    frame, found, met = None, None, 0
    for attempt in range(1, 40):
        try:
            # Each attempt has more time, so that it ends on any machine.
            with gt.limits(seconds=0.01 * 1.2**attempt):
                frame = frame or gt.Frame([t, r, z], SMALL)
                found = everything(frame)
            if met > 2:
                break
            frame = None
        except AllowanceError:
            met += 1
    assert met > 2
    assert found == plain


ZEROS = (
    sp.sin(x + y) - sp.sin(x) * sp.cos(y) - sp.cos(x) * sp.sin(y),
    4 * sp.cos(x / 3) ** 3 - 3 * sp.cos(x / 3) - sp.cos(x),
    sp.sqrt(x**2 + 2 * x * sp.exp(y) + sp.exp(2 * y)) - x - sp.exp(y),
    sp.sqrt(x + 2) * sp.sqrt(y + 3) - sp.sqrt((x + 2) * (y + 3)),
    sp.log((x + 2) ** 2 * sp.exp(z)) - 2 * sp.log(x + 2) - z,
    sp.cbrt(x + 5) ** 2 / (x + 5) - 1 / sp.cbrt(x + 5),
    sp.sinh(2 * z) - 2 * sp.sinh(z) * sp.cosh(z),
    sp.atan(x) + sp.atan(1 / x) - sp.pi / 2,
    sp.tan(z / 2) - sp.sin(z) / (1 + sp.cos(z)),
    1 / (sp.sqrt(x + 2) + sp.sqrt(y + 3)) * (x - y - 1) - sp.sqrt(x + 2) + sp.sqrt(y + 3),
)


def test_a_field_survives_interruptions():
    """Fields that are interrupted while reading still satisfy all identities afterwards.

    There are several fields: one field may read everything within its limits, from sympy's cache.
    """
    assert sum(map(interruptions, range(6)))


def interruptions(seed):
    """Number of interruptions of one field."""
    field, rng, met = Field([x, y, z]), random.Random(seed), 0
    order = rng.sample(ZEROS, len(ZEROS))
    for expression in order:
        verdict = None
        for attempt in itertools.count(1):
            try:
                with gt.limits(seconds=rng.uniform(1e-5, 2e-4) * 1.1**attempt):
                    element = field.read(expression)
                    verdict = element.is_zero
            except AllowanceError:
                met += 1
            else:
                break
        assert verdict is True
        assert field.read(expression + sp.Rational(1, 10**30)).is_zero is False
    return met


def unfinished():
    """A generator that keeps a precision set until it finishes."""
    with ball_precision(800):
        while True:
            yield gt.levi_civita(gt.Frame([x, y, z], ROWS)).curvature.ricci.is_zero


def test_precisions_are_set_back():
    """Precisions are restored, even if a generator that set one never finishes."""
    before = flint.ctx.prec
    with pytest.raises(AllowanceError), gt.limits(seconds=0.2), ball_precision(400):
        for _ in unfinished():
            pass
    assert flint.ctx.prec == before


def test_a_thread_has_its_own_limits():
    """A limit does not act on another thread."""
    begun = threading.Event()

    def work():
        begun.wait(10)
        return [str(gt.levi_civita(gt.Frame([t, r, z], SMALL)).curvature.scalar.is_zero)]

    with ThreadPoolExecutor(1) as pool:
        other = pool.submit(work)
        begun.set()
        with pytest.raises(AllowanceError), gt.limits(seconds=0.2):
            again_and_again()
        assert other.result(timeout=100) == ["False"]


KERR = gt.spaces.load("kerr").frame
LORENZ = gt.ODE.of({"x": "10*(y-x)", "y": "x*(28-z)-y", "z": "x*y-8*z/3"}, [1, 1, 1])
HIGH = sp.sqrt(x + 2) * sp.cbrt(y + 3) + sp.sqrt(z + 5)


def numbers():
    """Compute values at many points."""
    rows = [[sp.exp(x * y), x], [sp.sqrt(y + 3), 2 + sp.sin(x)]]
    scalar = gt.levi_civita(gt.Frame([x, y], rows)).curvature.scalar
    _ = scalar.at({x: sp.Rational(1, 7), y: 1}, digits=900)


def readings():
    """Read expressions of all kinds."""
    field = Field([x, y, z])
    for expression in ZEROS:
        _ = field.read(expression * (x + 5)).is_zero


def printing():
    """Write one tensor in all forms."""
    ricci = gt.levi_civita(gt.Frame([x, y], [[sp.exp(x * y), x], [sp.sin(y), 2]])).curvature.ricci
    _ = str(ricci), ricci._repr_latex_()


def roots():
    """Divide sums with roots."""
    _ = (1 / Field([x, y, z]).read(HIGH + 4)).sympy


def derivatives():
    """Compute derivatives of high order."""
    element = Field([x, y, z]).read(sp.exp(sp.sin(x * y)) / (sp.sqrt(x + y) + z))
    for _ in range(6):
        element = element.diff(x)


def motions():
    """Solve a motion of many steps."""
    gt.solve(LORENZ, 20.0, 1e-8)


def curvature():
    """Compute the curvature of a frame, and decide zeros."""
    tensors = gt.levi_civita(gt.Frame([x, y, z], ROWS)).curvature
    _ = tensors.ricci.is_zero, tensors.kretschmann.is_zero


@pytest.mark.parametrize(
    "work", [numbers, readings, printing, roots, derivatives, motions, curvature]
)
def test_every_kind_of_work_looks_at_the_limits(work):
    """A limit that has passed at the beginning ends each kind of work at its first check."""
    with pytest.raises(AllowanceError), gt.limits(seconds=1e-9):
        work()


def test_in_a_process(tmp_path):
    """A script that exceeds a limit ends with the message in its traceback."""
    file = tmp_path / "script.py"
    file.write_text(
        "import geomtorsion as gt, sympy as sp\n"
        "x, y = sp.symbols('x y', real=True)\n"
        "rows = [[(x + y + 1)**100, x*y], [sp.sin(x)**80 + y, (x - y)**50 + 2]]\n"
        "with gt.limits(seconds=0.3):\n"
        "    while True:\n"
        "        str(gt.levi_civita(gt.Frame([x, y], rows)).curvature.scalar.is_zero)\n"
    )
    done = subprocess.run(
        [sys.executable, str(file)],
        capture_output=True, text=True, timeout=100, check=False,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
    )  # fmt: skip
    assert done.returncode == 1
    assert "AllowanceError" in done.stderr.splitlines()[-1]
    assert "takes more than 0.3 s" in done.stderr

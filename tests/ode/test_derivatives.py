"""Derivatives of motions: closed forms, another program, balls, and events."""

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ExpressionError, StartError, UnknownNameError
from tests.ode.engines import every_engine

TIMES = np.linspace(0, 3, 7)
SWING = gt.ODE.of(
    {"x": "v", "v": "-k*sin(x)"}, [1, 0.2], parameters={"k": 4}, outputs={"E": "v**2/2 - k*cos(x)"}
)


@every_engine
def test_derivatives_of_an_oscillator(engine):
    """x = cos(w t) with w^2 = k: by k, by both starts, and an output."""
    problem = gt.ODE.of(
        {"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 4}, outputs={"force": "-k*x"}
    )
    solution = gt.solve(problem, TIMES, 1e-10, engine, derivatives=["k", "x", "v"])
    w, x = 2.0, np.cos(2 * TIMES)
    by_k = -TIMES * np.sin(w * TIMES) / (2 * w)
    assert solution["dx_dk"] == pytest.approx(by_k, abs=1e-9)
    assert solution["dx_dx"] == pytest.approx(x, abs=1e-9)
    assert solution["dx_dv"] == pytest.approx(np.sin(w * TIMES) / w, abs=1e-9)
    assert solution["dforce_dk"] == pytest.approx(-x - 4 * by_k, abs=1e-8)
    largest = np.abs(by_k - solution["dx_dk"]).max()
    assert largest <= solution.error_of("dx_dk") * np.abs(solution["dv_dk"]).max()


def test_heyoka_has_the_same_variational_equations():
    """A pendulum with a force that depends on time, by `heyoka.var_ode_sys`."""
    hy = pytest.importorskip("heyoka")
    x, v = hy.make_vars("x", "v")
    rates = [(x, v), (v, -hy.par[0] * hy.sin(x) + hy.cos(hy.time))]
    system = hy.var_ode_sys(rates, [hy.par[0], x])
    other = hy.taylor_adaptive(system, [1.0, 0.2], pars=[4.0], compact_mode=True)
    other.propagate_until(3.0)
    problem = gt.ODE.of({"x": "v", "v": "-k*sin(x) + cos(t)"}, [1, 0.2], parameters={"k": 4})
    solution = gt.solve(problem, [0, 3.0], 1e-12, derivatives=["k", "x"])
    names = ["x", "v", "dx_dk", "dx_dx", "dv_dk", "dv_dx"]
    assert [solution[name][-1] for name in names] == pytest.approx(other.state, rel=1e-11)


def test_balls_hold_the_derivatives():
    """The proved interval of each derivative is within the estimated error."""
    solution = gt.solve(SWING, TIMES, derivatives=["k", "x"])
    proof = gt.prove(solution)
    assert proof.holds
    assert {"dx_dk", "dv_dx"} <= set(proof.names[-1])


def test_events_at_times():
    """A parameter acts up to the event that replaces it; a replaced state has no memory."""
    burn = gt.ODE.of(
        {"z": "v", "v": "a - g"}, [0, 1], parameters={"a": 3, "g": 1},
        events=[gt.At(1.0, {"a": 0}), gt.At(2.0, {"v": 5})],
    )  # fmt: skip
    solution = gt.solve(burn, [0.0, 0.5, 1.5, 2.5], derivatives=["a", "g", "v"])
    assert solution["dv_da"] == pytest.approx([0, 0.5, 1, 0], abs=1e-12)
    assert solution["dz_da"] == pytest.approx([0, 0.125, 1, 1.5], abs=1e-12)
    assert solution["dv_dg"] == pytest.approx([0, -0.5, -1.5, -0.5], abs=1e-12)
    assert solution["dv_dv"] == pytest.approx([1, 1, 1, 0], abs=1e-12)


def test_derivatives_cost_no_second_compilation():
    """Other values of what varies use the compiled code of the first solve."""
    problem = SWING.with_derivatives(["k", "v"])
    gt.solve(problem, 1.0)
    again = gt.solve(problem.with_values({"k": 3.7, "v": 0.1}), 1.0)
    assert again.cost.compile_seconds == 0
    assert again["dv_dv"][0] == 1


@every_engine
def test_times_of_events(engine):
    """Zeros of cos(w t), and of a term with the parameter and the time in it."""
    problem = gt.ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 4.0})
    solution = gt.solve(problem, 5.0, 1e-10, engine, derivatives=["k", "x"])
    zeros = solution.event_derivatives("x", "k")
    assert zeros.times == pytest.approx(np.pi / 4 * np.array([1, 3, 5]), abs=1e-9)
    expected = -zeros.times / 8
    assert np.abs(zeros.values - expected).max() <= zeros.error < 1e-8
    assert np.asarray(solution.event_derivatives("x", "x")) == pytest.approx([0] * 3, abs=1e-9)
    assert solution.event_derivatives("x", "k", 1).times == pytest.approx(zeros.times[1:2])
    late = solution.event_derivatives("t - k", "k")
    assert late.values == pytest.approx([1])


def test_events_after_a_parameter_was_replaced():
    """The new value does not change with the old one."""
    burn = gt.ODE.of(
        {"z": "v", "v": "a"}, [0, 0], parameters={"a": 2}, events=[gt.At(1.0, {"a": 0})]
    )
    solution = gt.solve(burn, 4.0, derivatives=["a"])
    # z = a/2 + a (t - 1) crosses 3 at t = 1/2 + 3/a; the a in a term is the replaced one.
    assert solution.event_derivatives("z - 3", "a").values == pytest.approx([-3 / 4])
    assert solution.event_derivatives("z - 3 + a", "a").values == pytest.approx([-3 / 4])


REFUSALS = [
    (lambda: gt.solve(SWING, 3.0).event_derivatives("x", "k"), UnknownNameError, "Solve it with"),
    (
        lambda: gt.solve(SWING, 3.0, derivatives=["k"]).event_derivatives("sign(x) - x", "k"),
        ExpressionError, "smooth",
    ),
    (
        lambda: gt.solve(SWING, 3.0, derivatives=["k"]).event_derivatives("dx_dk + 0.1", "k"),
        UnknownNameError, "derivative of dx_dk",
    ),
    (lambda: SWING.with_derivatives(["K"]), UnknownNameError, "There are k, x, v"),
    (lambda: SWING.with_derivatives(["k", "k"]), StartError, "Name each of them once"),
    (lambda: SWING.with_derivatives([]), StartError, "expected different names"),
    (lambda: SWING.with_derivatives("k"), StartError, "Put it in brackets"),
    (lambda: gt.solve(SWING, 1.0, derivatives=["E"]), UnknownNameError, "at the start, got 'E'"),
    (
        lambda: gt.ODE.of({"x": "k", "dx_dk": 1}, [0, 0], parameters={"k": 1}).with_derivatives(
            ["k"]
        ),
        ExpressionError, "Rename it",
    ),
    (
        lambda: SWING.with_derivatives(["k"]).with_derivatives(["x"]).with_derivatives(["k"]),
        ExpressionError, "all derivatives at once",
    ),
    (
        lambda: gt.ODE.of(
            {"x": "k"}, [0], parameters={"k": 1}, outputs={"s": sp.sign(sp.Symbol("x"))}
        ).with_derivatives(["k"]).outputs["ds_dk"],
        KeyError, "ds_dk",
    ),
    (
        lambda: gt.ODE.of(
            {"a": 0, "b": 0}, [1, 0], normalized=[("a", "b")]
        ).with_derivatives(["a"]),
        UnknownNameError, "expected names of parameters",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSALS)
def test_bad_requests_are_refused(call, error, words):
    """Unknown, repeated or taken names, and outputs with jumps."""
    with pytest.raises(error, match=words):
        call()

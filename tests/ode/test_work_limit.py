"""protocol: errors about too much work count time as users do, in whatever units a run counts."""

import pickle

import pytest
import sympy as sp

from geomtorsion.curves import geodesic, holonomy
from geomtorsion.errors import ChartEdgeError, LimitError, StuckError, TimeError
from geomtorsion.geometry import Frame, levi_civita
from geomtorsion.ode import ODE, RungeKutta, Stiff, Taylor, solve
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.spaces import load

ENGINES = [RungeKutta(max_evaluations=20_000), Stiff("LSODA", max_evaluations=20_000)]
ENGINES += [Taylor(max_steps=2_100)] if is_available() else []


def reached(problem, t, engine, name="t"):
    """The time that the error names."""
    with pytest.raises(LimitError, match="more than .* were needed by") as caught:
        solve(problem, t, 1e-9, engine=engine)
    # It says the same in the process of a caller.
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    text = str(caught.value).split(f"by {name} = ")[1]
    return float(text.split()[0].rstrip("."))


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_scaled_runs(engine):
    """x'' = -k^2 x takes the same work by k t = const, though the run counts in other units."""
    made = [ODE.of({"x": "v", "v": f"-{k}**2*x"}, [1, 0], time="s") for k in ("1", "(10**15)")]
    slow, fast = reached(made[0], 1e5, engine, "s"), reached(made[1], 1e-10, engine, "s")
    assert fast == pytest.approx(slow * 1e-15, rel=0.3)


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_curves_of_many_turns(engine):
    """A hundred times the speed gets a hundredth as far in the curve parameter."""
    so3 = load("so3").frame
    slow = geodesic(so3, [0.3, 1.0, 0.2], [0.1, 0.5, -0.2])
    fast = geodesic(so3, [0.3, 1.0, 0.2], [100, 500, -200])
    one, two = reached(slow, 1e6, engine), reached(fast, 1e3, engine)
    assert two == pytest.approx(one / 1000, rel=0.3)


def test_the_time_is_called_as_it_is():
    """Errors of equations in s, and of paths in s, say s."""
    ending = ODE.of({"x": "-sqrt(x)"}, [1], time="s")
    with pytest.raises(StuckError, match="at s = 2, "):
        solve(ending, 5.0)
    swing = solve(ODE.of({"x": "v", "v": "-x"}, [1, 0], time="s"), 2.0)
    assert "to s = 2" in str(swing)
    with pytest.raises(TimeError, match="s = 3 lies outside"):
        swing.at(3.0)
    s, x, y = sp.symbols("s x y")
    bar = levi_civita(Frame([x, y], [[1, 0], [0, 1 / sp.sqrt(1 - x)]]))
    with pytest.raises(ChartEdgeError, match=r"chart at s = 0\.5 \([^()]*(\([^()]*\))?[^()]*\)\."):
        holonomy(bar, [2 * s, s], 1.0)

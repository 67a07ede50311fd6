"""Engines: Taylor series, Runge-Kutta and stiff solvers behind one small protocol."""

from geomtorsion.ode.engines.runge_kutta import RungeKutta, Stiff
from geomtorsion.ode.engines.taylor import Taylor
from geomtorsion.ode.system import Engine, Run

__all__ = ["Engine", "Run", "RungeKutta", "Stiff", "Taylor"]

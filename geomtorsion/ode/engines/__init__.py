"""Engines: Taylor series, Runge-Kutta and stiff solvers behind one small protocol."""

from geomtorsion.ode.engines.protocol import Engine, Run
from geomtorsion.ode.engines.runge_kutta import RungeKutta, Stiff
from geomtorsion.ode.engines.taylor import Taylor

__all__ = ["Engine", "Run", "RungeKutta", "Stiff", "Taylor"]

"""Engines: Taylor series, Runge-Kutta and stiff solvers behind one small protocol."""

from geomtorsion.motion.engines.protocol import Engine, Run
from geomtorsion.motion.engines.rungekutta import RungeKutta, Stiff
from geomtorsion.motion.engines.taylor import Taylor

__all__ = ["Engine", "Run", "RungeKutta", "Stiff", "Taylor"]

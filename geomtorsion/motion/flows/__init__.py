"""Flows: first-order equations of any kind, solved like motions."""

from geomtorsion.motion.flows.flow import Flow
from geomtorsion.motion.flows.intake import flow
from geomtorsion.motion.flows.many import FlowBundle
from geomtorsion.motion.flows.solution import FlowMoment, FlowSolution

__all__ = ["Flow", "FlowBundle", "FlowMoment", "FlowSolution", "flow"]

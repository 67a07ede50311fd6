"""Accuracy: what accuracy costs in time, measured."""

from geomtorsion.accuracy.cost import CostRow, CostTable, accuracy_cost

__all__ = ["CostRow", "CostTable", "accuracy_cost"]

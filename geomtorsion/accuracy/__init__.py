"""Accuracy: measured cost of accuracy in time."""

from geomtorsion.accuracy.cost import CostRow, CostTable, accuracy_cost

__all__ = ["CostRow", "CostTable", "accuracy_cost"]

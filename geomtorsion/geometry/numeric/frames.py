"""Frames over a numeric field: the formulas of exact frames, evaluated on arrays of numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from geomtorsion.geometry import validation
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.numeric.numeric_field import NumericField


def numeric_frame(frame: Frame, field: NumericField, matrices: Mapping[str, Any]) -> Frame:
    """A frame over a numeric field with the symbols of another frame."""
    opened = validation.Opened(frame.coordinates, frame.parameters, (), False, field)  # type: ignore[arg-type]
    filled = object.__new__(Frame)
    filled.fill(opened, frame.name, matrices, ("coframe", {}))
    return filled

"""Grid equations: field equations of a sampled frame at the nodes of its grid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from geomtorsion.errors import CoordinateError, GravityError, ShapeError
from geomtorsion.geometry import Tensor
from geomtorsion.gravity.numeric.equation_values import (
    Equations,
    EquationValues,
    evaluated_connection,
)
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.grid_geometry import GridGeometry, at_two_steps
from geomtorsion.support import checks
from geomtorsion.support.exclusive import exclusive


@exclusive
def equations_on_grid(
    equations: Equations, samples: SampledFrame, constants: Mapping[Any, Any]
) -> EquationValues:
    """Field equations of a theory for a sampled frame, see FieldEquations.at."""
    checks.instance(samples, SampledFrame, "samples")
    frame = equations.frame
    n = frame.dimension
    if samples.dimension != n or samples.rows != n:
        raise ShapeError(
            f"samples: expected {n} axes and rows, one for each coordinate of the frame, got "
            f"{samples.dimension} axes and {samples.rows} rows."
        )
    signs = tuple(-1 if sign == "-" else 1 for sign in samples.signature or "+" * n)
    if [frame.eta[i, j] for i in range(n) for j in range(n)] != np.diag(signs).ravel().tolist():
        raise GravityError(
            f"samples: expected the signature of the frame, {frame.eta.tolist()}, got "
            f"{samples.signature or '+' * n}. Give SampledFrame(..., signature=...)."
        )
    named = checks.by_name(constants, "point", CoordinateError)
    own = [x.name for x in frame.coordinates]
    known = [x.name for x in frame.parameters] + list(equations.constants)
    for name, value in named.items():
        checks.known_name(name, known, "point", CoordinateError, expected="constants on a grid")
        checks.number(value, f"point: {name}", CoordinateError)
    nodes = np.meshgrid(*samples.axes, indexing="ij")
    given = {name: float(value) for name, value in named.items()} | dict(
        zip(own, nodes, strict=True)
    )

    def formulas(geometry: GridGeometry) -> dict[str, Tensor]:
        connections = tuple(
            evaluated_connection(one, geometry.frame, equations.is_metric(k))
            for k, one in enumerate(equations.connections)
        )
        numeric: Any = replace(equations, connections=connections)  # type: ignore[type-var]
        scalars = {"L": numeric.L} | {x: numeric.scalar(x) for x in equations.invariant_names}
        groups = (numeric.tensors, numeric.matter_equations, scalars)
        return {f"{k} {name}": x for k, one in enumerate(groups) for name, x in one.items()}

    found = at_two_steps(samples, formulas, given, frame.coordinates)
    groups: tuple[dict[str, np.ndarray], ...] = ({}, {}, {})
    errors: dict[str, np.ndarray] = {}
    for key in found.fine:
        density = found.density(key)
        inner = tuple(range(density.values.ndim - n, density.values.ndim))
        values, error = (
            np.moveaxis(x, inner, tuple(range(n))) for x in (density.values, density.error)
        )
        group, name = key.split(" ", 1)
        groups[int(group)][name] = values
        # A matter field and its equation have one name.
        errors[name] = np.maximum(error, errors.get(name, 0.0))
    tensors, matter, scalars = map(MappingProxyType, groups)
    return EquationValues(tensors, matter, scalars, MappingProxyType(errors))

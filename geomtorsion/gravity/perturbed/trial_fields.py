"""Trial fields: power series of all fields near which a solution is searched."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import parse_expression
from geomtorsion.geometry import Frame
from geomtorsion.geometry.numeric.numeric_field import NumericField
from geomtorsion.geometry.numeric.power_series import PowerSeries
from geomtorsion.gravity.numeric.varied import Setting
from geomtorsion.support import checks

# Relative size of the random change of the start: larger ones end on other branches.
SPREAD = 0.05


def start_coordinates(near: Frame, n: int) -> tuple[sp.Symbol, ...]:
    """Coordinates of a frame that can be a start."""
    if near.dimension != n:
        raise GravityError(
            f"near: expected a frame of {n} dimensions, got one of {near.dimension}. Give "
            f"dimension={near.dimension}, or another frame."
        )
    signs = [near.eta[i, j] for i in range(n) for j in range(n)]
    if signs != [0 if i != j else -1 if i == 0 else 1 for i in range(n) for j in range(n)]:
        raise GravityError(
            "near: expected a frame of signature -++..., got another signature. Order the legs "
            "with the timelike one first."
        )
    if near.parameters:
        raise GravityError(
            f"near: expected a frame without parameters, got {', '.join(map(str, near.parameters))}"
            ". Give them values: frame.subs({...})."
        )
    return near.coordinates


def labels(setting: Setting) -> list[str]:
    """A name for each field, by which a later start finds it."""
    labels = [f"e {i} {mu}" for i, mu in setting.kind.coframe]
    labels += [f"w {a} {i} {j}" for a, i, j in setting.kind.turning]
    labels += [f"scalar {k}" for k in range(setting.scalars)]
    labels += [f"A {k} {mu}" for k in range(setting.vectors) for mu in range(setting.dimension)]
    pairs = range(setting.dimension * (setting.dimension - 1) // 2)
    labels += [f"B {k} {pair}" for k in range(setting.two_forms) for pair in pairs]
    return labels


def named_fields(setting: Setting, fields: np.ndarray) -> dict[str, np.ndarray]:
    """Coefficients of each field, by its label."""
    return dict(zip(labels(setting), fields, strict=True))


def trial(
    setting: Setting, series: PowerSeries, near: object, formulas: Mapping[str, object]
) -> np.ndarray:
    """Coefficients of all fields at the start, without a random change."""
    fields = np.zeros((setting.size, series.size))
    for k, (i, mu) in enumerate(setting.kind.coframe):
        fields[k, 0] = float(i == mu)
    if isinstance(near, Mapping):
        for k, label in enumerate(labels(setting)):
            row = near.get(label, np.zeros(1))[: series.size]
            fields[k, : len(row)] = row
        return fields
    point: dict[Any, Any] = dict.fromkeys(setting.coordinates, 0.0)
    if isinstance(near, Frame):
        point = {x: float(sp.Rational(str(near.sample_point[x]))) for x in near.coordinates}
    variables = {
        x.name: series.variable(mu, float(point[x])) for mu, x in enumerate(setting.coordinates)
    }
    field = NumericField(setting.coordinates, series, variables)
    if isinstance(near, Frame) and setting.kind.coframe:
        rows = _coframe_rows(near, field, setting)
        fields[: len(rows)] = rows
    first = len(setting.kind.coframe) + len(setting.kind.turning)
    names = {x.name: x for x in setting.coordinates}

    def read(text: str) -> sp.Expr:
        return parse_expression(text, names, where="scalars")

    for k, (text, formula) in enumerate(formulas.items()):
        if formula is not None:
            where = f"scalars: {text}"
            expression = checks.expression(formula, where, GravityError, read=read)
            fields[first + k] = field.as_array(field.read(expression, where)).value
    return fields


def _coframe_rows(near: Frame, field: NumericField, setting: Setting) -> list[np.ndarray]:
    """Coefficients of the components of a coframe that are unknown; the others vanish."""
    legs = range(setting.dimension)
    every: list[tuple[int, ...]] = [(i, mu) for i in legs for mu in legs]
    values = field.evaluated([near.coframe.element(*place) for place in every])
    table = dict(zip(every, values, strict=True))
    for place, value in table.items():
        if place not in setting.kind.coframe and value.fraction != 0:
            raise GravityError(
                f"near: expected a coframe with zeros above its diagonal, got "
                f"{near.coframe[place]} in row {place[0]}, column {place[1]}. Rotate the legs, "
                "or use the geometry teleparallel."
            )
    return [field.as_array(table[place]).value for place in setting.kind.coframe]


def moved(fields: np.ndarray, series: PowerSeries, setting: Setting, seed: int) -> np.ndarray:
    """A start with a random change, smaller for higher orders; matter of size one."""
    random = np.random.default_rng(checks.count(seed, "seed", GravityError))
    change = (
        SPREAD
        * random.normal(size=(setting.size, 1 + series.size))
        / 2.0 ** np.append(0, series.degrees)
    )
    result = fields + change[:, 1:]
    first = len(setting.kind.coframe) + len(setting.kind.turning)
    result[first:, 0] += change[first:, 0] / SPREAD
    return result

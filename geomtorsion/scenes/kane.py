"""Kane: the equations of motion of the speeds that constraints leave."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from geomtorsion.scenes.assembly import Assembly, vector_sum
from geomtorsion.scenes.context import ATTITUDE


def accelerations(made: Assembly) -> list[Any]:
    """Rates of the speeds, in their order; without a constraint Euler's equations.

    Equation
    --------
    omega_k . (I a + omega x L + h' - M) + v_k . (m v' + m omega x v - R^T F) = 0 for each speed,
    omega_k, v_k the partial velocities (body axes), L = I omega + h        [KaneLevinson1985]
    """
    context, parts = made.context, made.parts.values()
    inertia, omega = made.inertia, made.omega
    internal = made.tied(vector_sum(parts, "momentum"))
    turning = made.tied(vector_sum(parts, "moment"))
    turning -= omega.cross(inertia * omega + internal) + internal.applyfunc(made.derivative)
    if made.constraint is None:
        return _solved(made, inertia, list(turning))
    v, mass = made.velocity_body, context.mass
    pulling = made.tied(ATTITUDE.T * vector_sum(parts, "force"))
    # With the speeds held: how the partial velocities themselves change.
    held = replace(made, rates={s: r for s, r in made.rates.items() if s not in made.speeds})
    pulling -= mass * (v.applyfunc(held.derivative) + omega.cross(v))
    turning -= inertia * omega.applyfunc(held.derivative)
    pairs = [(omega.diff(speed), v.diff(speed)) for speed in made.speeds]
    matrix = sp.Matrix(
        [[sp.expand(w.dot(inertia * o) + mass * m.dot(n)) for o, n in pairs] for w, m in pairs]
    )
    return _solved(made, matrix, [w.dot(turning) + m.dot(pulling) for w, m in pairs])


def _solved(made: Assembly, matrix: Any, right: Sequence[Any]) -> list[Any]:
    """matrix^-1 right, one term for each product of states."""
    size = len(right)
    parameters = frozenset(sp.Symbol(name) for name in made.values)
    rows = [gathered(value, parameters) for value in right]
    if all(matrix[i, j] == 0 for i in range(size) for j in range(size) if i != j):
        return [
            _total({rest: n / matrix[k, k] for rest, n in rows[k].items()}) for k in range(size)
        ]
    if matrix.free_symbols <= parameters and not matrix.free_symbols & made.context.switched:
        inverse = _named(made, matrix)
    else:
        inverse = matrix.adjugate() / matrix.det(method="berkowitz")
    found = []
    for k in range(size):
        parts = [
            (rest, number * inverse[k, j])
            for j, row in enumerate(rows)
            for rest, number in row.items()
        ]
        found.append(_total(_merged(parts)))
    return found


def _named(made: Assembly, matrix: Any) -> Any:
    """The inverse of a constant matrix as parameters J11, J12, ...: exact, and short to write."""
    numbers = {sp.Symbol(name): value for name, value in made.values.items()}
    inverse = matrix.xreplace(numbers).inv()
    names = sp.zeros(*matrix.shape)
    for i in range(matrix.rows):
        for j in range(i + 1):
            name = f"J{j + 1}{i + 1}"
            names[i, j] = names[j, i] = made.context.parameter(name, inverse[i, j])
    return names


def gathered(expression: Any, parameters: frozenset[Any]) -> dict[Any, Any]:
    """Products of states -> sums of parameters; what cancels is gone.

    Examples
    --------
    >>> I1, I2, Omega1 = sp.symbols("I1 I2 Omega1")
    >>> gathered(I1 * Omega1 - I2 * Omega1, frozenset({I1, I2}))
    {Omega1: I1 - I2}
    """
    parts = []
    for term in sp.Add.make_args(sp.expand_mul(expression)):
        number = sp.Mul(*(f for f in sp.Mul.make_args(term) if f.free_symbols <= parameters))
        parts.append((term / number, number) if number != 0 else (sp.S.One, sp.S.Zero))
    return _merged(parts)


def _merged(parts: Iterable[tuple[Any, Any]]) -> dict[Any, Any]:
    found: dict[Any, Any] = {}
    for rest, number in parts:
        found[rest] = found.get(rest, sp.S.Zero) + number
    return {rest: number for rest, number in found.items() if number != 0}


def _total(table: Mapping[Any, Any]) -> Any:
    return sp.Add(*(rest * number for rest, number in table.items()))

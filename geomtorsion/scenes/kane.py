"""Kane: the equations of motion of the speeds that constraints leave.

The action principle (`geomtorsion.action`) gives the same equations, as tests prove for each
shipped scene; but in angles, where these stand in elements of R, and for most scenes in 3 to 9
times the time (10 to 28 ms, here 1 to 6 ms; 38 ms for the rolling disc). Two routes that share no
code are also the better check.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.scenes.context import ATTITUDE

if TYPE_CHECKING:
    from geomtorsion.scenes.assembly import Assembly
    from geomtorsion.scenes.effects.protocol import Contribution

# Product of states -> sum of parameters.
Sum = dict[sp.Expr, sp.Expr]
# Terms with more operations than this are not multiplied out: gathering like terms saves operations
# in short sums, and only costs time and length in long ones (a thrust that is a formula).
SHORT = 60


def accelerations(assembly: Assembly) -> list[sp.Expr]:
    """Rates of the speeds, in their order; without a constraint Euler's equations.

    Equation
    --------
    omega_k . (I a + omega x L + h' - M) + v_k . (m v' + m omega x v - R^T F) = 0 for each speed,
    omega_k, v_k the partial velocities (body axes), L = I omega + h        [KaneLevinson1985]
    """
    context, parts = assembly.context, assembly.parts.values()
    inertia, omega = assembly.inertia, assembly.omega
    internal = assembly.constrained(vector_sum(parts, "momentum"))
    turning = assembly.constrained(vector_sum(parts, "moment"))
    turning -= omega.cross(inertia * omega + internal) + internal.applyfunc(assembly.derivative)
    # A free body: translation and rotation are separate, and the speeds are Omega.
    if assembly.constraint is None:
        return _solved(assembly, inertia, list(turning))
    v, mass = assembly.velocity_body, context.mass
    pulling = assembly.constrained(ATTITUDE.T * vector_sum(parts, "force"))
    # With constant speeds: how the partial velocities themselves change.
    fixed = replace(
        assembly, rates={s: r for s, r in assembly.rates.items() if s not in assembly.speeds}
    )
    pulling -= mass * (v.applyfunc(fixed.derivative) + omega.cross(v))
    turning -= inertia * omega.applyfunc(fixed.derivative)
    pairs = [(omega.diff(speed), v.diff(speed)) for speed in assembly.speeds]
    matrix = sp.Matrix(
        [[sp.expand(w.dot(inertia * o) + mass * m.dot(n)) for o, n in pairs] for w, m in pairs]
    )
    return _solved(assembly, matrix, [w.dot(turning) + m.dot(pulling) for w, m in pairs])


def vector_sum(parts: Iterable[Contribution], name: str) -> sp.Matrix:
    """Sum of one kind of vector over all contributions."""
    total = sp.zeros(3, 1)
    for part in parts:
        vector = getattr(part, name)
        if vector is not None:
            total = total + sp.Matrix(list(vector))
    return total


def _solved(assembly: Assembly, matrix: sp.Matrix, right: Sequence[sp.Expr]) -> list[sp.Expr]:
    """matrix^-1 right: one term for each product of states, where that is short."""
    size = len(right)
    parameters = frozenset(sp.Symbol(name) for name in assembly.values)
    # Principal axes, as most scenes have them: one division for each speed.
    if all(matrix[i, j] == 0 for i in range(size) for j in range(size) if i != j):
        rows = [_terms(value, parameters) for value in right]
        return [
            _total({rest: n / matrix[k, k] for rest, n in rows[k].items()}) for k in range(size)
        ]
    # A constant matrix is inverted once, in exact numbers.
    if matrix.free_symbols <= parameters and not matrix.free_symbols & assembly.context.switched:
        inverse, rows = _named(assembly, matrix), [_terms(value, parameters) for value in right]
        return [_total(_merged(_products(inverse[k, :], rows))) for k in range(size)]
    # Nothing is multiplied out that engines can take as it is.
    adjugate, determinant = matrix.adjugate(), matrix.det(method="berkowitz")
    return [
        sp.Add(*(adjugate[k, j] * right[j] for j in range(size))) / determinant for k in range(size)
    ]


def _terms(value: sp.Expr, parameters: frozenset[sp.Symbol]) -> Sum:
    """The terms of a sum: gathered, but for long ones, which stay as they are."""
    long = [term for term in sp.Add.make_args(value) if term.count_ops() > SHORT]
    found = gathered(value - sp.Add(*long), parameters)
    return found | dict.fromkeys(long, sp.S.One)


def _products(factors: Iterable[sp.Expr], rows: Sequence[Sum]) -> Iterable[tuple[sp.Expr, sp.Expr]]:
    """Terms of a sum of factors times rows."""
    for factor, row in zip(factors, rows, strict=True):
        for rest, number in row.items():
            yield rest, number * factor


def _named(assembly: Assembly, matrix: sp.Matrix) -> sp.Matrix:
    """The inverse of a constant matrix as parameters J11, J12, ...: exact, and short to write."""
    numbers = {sp.Symbol(name): value for name, value in assembly.values.items()}
    inverse = matrix.xreplace(numbers).inv()
    names = sp.zeros(*matrix.shape)
    for i in range(matrix.rows):
        for j in range(i + 1):
            name = f"J{j + 1}{i + 1}"
            names[i, j] = names[j, i] = assembly.context.parameter(name, inverse[i, j])
    return names


def gathered(expression: sp.Expr, parameters: frozenset[sp.Symbol]) -> Sum:
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


def _merged(parts: Iterable[tuple[sp.Expr, sp.Expr]]) -> Sum:
    found: Sum = {}
    for rest, number in parts:
        found[rest] = found.get(rest, sp.S.Zero) + number
    return {rest: number for rest, number in found.items() if number != 0}


def _total(table: Sum) -> sp.Expr:
    return sp.Add(*(rest * number for rest, number in table.items()))

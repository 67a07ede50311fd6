"""Groups: a left-invariant coframe of the Lie group with given structure constants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations, product
from typing import Any

import sympy as sp

from geomtorsion.errors import ShapeError, StructureConstantError
from geomtorsion.exact import Element, Field
from geomtorsion.exact.reading import counted_as
from geomtorsion.geometry.validation import free_symbols, named_symbols
from geomtorsion.support import checks


def invariant_coframe(
    constants: object, coordinates: Sequence[sp.Symbol] | str | None
) -> tuple[list[sp.Symbol], sp.Matrix]:
    """Coordinates of the second kind and the coframe with de^k = -(1/2) C_ij^k e^i ^ e^j.

    g = exp(x1 X_1) ... exp(xn X_n) has g^-1 dg = sum_m dx_m exp(-x_n ad_n) ... exp(-x_(m+1)
    ad_(m+1)) X_m, with [X_i, X_j] = C_ij^k X_k.
    """
    table = checked_constants(constants)
    n = len(table)
    symbols = _symbols(coordinates, n)
    coframe = sp.eye(n)
    # Column m of the result passes through every later exponential, the nearest first.
    columns = [sp.eye(n)[:, m] for m in range(n)]
    for later in range(1, n):
        adjoint = sp.Matrix(n, n, lambda k, j, i=later: table[i][j][k])
        flow = exponential(-adjoint, symbols[later])
        for m in range(later):
            columns[m] = flow * columns[m]
    for m, column in enumerate(columns):
        coframe[:, m] = column
    return symbols, coframe


def _dense(constants: Mapping[object, object]) -> list[list[list[object]]]:
    """C_ij^k as nested lists from {(i, j, k): value}; one order of i and j is enough."""
    given: dict[tuple[int, ...], object] = {}
    for index, value in constants.items():
        numbers = tuple(map(checks.whole, index)) if isinstance(index, tuple) else ()
        places = tuple(k for k in numbers if k is not None and k >= 0)
        if len(places) != 3 or len(numbers) != 3:
            raise StructureConstantError(
                "structure constants: expected three indices (i, j, k), counted from 0, as a key, "
                f"got {checks.shown(index)}. Write {{(0, 1, 2): 1}} for [E_0, E_1] = E_2."
            )
        given[places] = value
    legs = {leg for places in given for leg in places}
    n = len(legs)
    # A single large index would fill the memory.
    if legs != set(range(n)):
        raise StructureConstantError(
            f"structure constants: expected each leg from 0 to {max(legs)} in some index, got "
            f"{n} of them. Add an index with the value 0 for a leg that commutes with all others."
        )
    opposite = {
        (j, i, k): -checks.expression(value, f"structure constants[{i}, {j}, {k}]")
        for (i, j, k), value in given.items()
    }
    whole = opposite | given
    return [[[whole.get((i, j, k), 0) for k in range(n)] for j in range(n)] for i in range(n)]


def checked_constants(constants: object) -> list[list[list[sp.Expr]]]:
    """C_ij^k as nested lists; antisymmetric and satisfying the Jacobi identity, both exactly."""
    if isinstance(constants, Mapping):
        constants = _dense(constants)
    shape = "C_ij^k of shape (n, n, n), axes (i, j, k)"
    error = StructureConstantError
    rows = checks.entries(constants, "structure constants", error, expected=shape)
    n = len(rows)
    table = [[_listed(line) for line in _listed(b)] for b in rows]
    if n == 0 or any(len(b) != n or any(len(line) != n for line in b) for b in table):
        raise StructureConstantError(
            f"structure constants: expected {shape}, got {n} blocks, not all of {n} lines with {n} "
            "entries. Give nested lists C[i][j][k]."
        )
    places = list(product(range(n), repeat=3))
    named = [(f"structure constants[{i}, {j}, {k}]", table[i][j][k]) for i, j, k in places]
    free = free_symbols([value for _, value in named])
    counted_as(free)
    field = Field(sorted(free, key=str))
    value = dict(zip(places, field.read_all(named), strict=True))
    _check_algebra(field, n, value)
    return [[[value[i, j, k].sympy for k in range(n)] for j in range(n)] for i in range(n)]


def _check_algebra(field: Field, n: int, value: Mapping[tuple[int, ...], Element]) -> None:
    """Refuse constants that are not antisymmetric, or violate the Jacobi identity."""
    for i, j, k in value:
        if not (value[i, j, k] + value[j, i, k]).is_zero:
            raise StructureConstantError(
                f"structure constants are not antisymmetric: C[{i}, {j}, {k}] = {value[i, j, k]}, "
                f"C[{j}, {i}, {k}] = {value[j, i, k]}. They must be opposite."
            )
    for (i, j, k), m in product(combinations(range(n), 3), range(n)):
        terms = [
            (1, value[a, b, s], value[s, c, m])
            for a, b, c in ((i, j, k), (j, k, i), (k, i, j))
            for s in range(n)
        ]
        excess = field.sum(terms)
        if not excess.is_zero:
            raise StructureConstantError(
                f"structure constants violate the Jacobi identity: for i, j, k = {i}, {j}, {k} "
                f"and component {m} the cyclic sum of C_ij^s C_sk^m is {excess}, not 0. "
                "Only constants with a vanishing sum belong to a group."
            )


def _symbols(coordinates: Sequence[sp.Symbol] | str | None, n: int) -> list[sp.Symbol]:
    """The given coordinates, or x1 ... xn."""
    if coordinates is None:
        return [sp.Symbol(f"x{k + 1}") for k in range(n)]
    symbols = named_symbols(coordinates)
    checks.check_one_each(symbols, n, "legs", "coordinates", ShapeError)
    return symbols


def _listed(values: object) -> list[Any]:
    """The entries of one level of the constants; an empty list if it is not a list."""
    return list(values) if isinstance(values, list | tuple) else []


def exponential(matrix: sp.Matrix, x: sp.Symbol) -> sp.Matrix:
    """exp(x A) of a constant matrix, in real elementary functions.

    A = S + N with S semisimple, N nilpotent, SN = NS; exp(x S) by projectors on the factors of
    the minimal polynomial of S, each linear or quadratic.
    """
    n, variable = matrix.rows, sp.Dummy("z")
    polynomial = sp.Poly(matrix.charpoly().all_coeffs(), variable)
    if not polynomial.domain.is_Field:
        polynomial = polynomial.to_field()
    factors = [factor for factor, _ in polynomial.factor_list()[1]]
    semisimple = _semisimple(matrix, factors, variable)
    nilpotent = (matrix - semisimple).applyfunc(sp.cancel)
    result, power = sp.zeros(n, n), sp.eye(n)
    for factor in factors:
        result += _projector(semisimple, factor, factors, variable) * _block(
            semisimple, factor, variable, x
        )
    # The series of a nilpotent matrix ends after at most n terms.
    series, k = sp.eye(n), 1
    while True:
        power = (power * nilpotent / k).applyfunc(sp.cancel)
        if power.is_zero_matrix:
            break
        series += power * x**k
        k += 1
    return (result * series).applyfunc(sp.expand)


def _value(polynomial: sp.Poly, matrix: sp.Matrix) -> sp.Matrix:
    """A polynomial of a matrix (Horner)."""
    n = matrix.rows
    result = sp.zeros(n, n)
    for coefficient in polynomial.all_coeffs():
        result = (result * matrix + coefficient * sp.eye(n)).applyfunc(sp.cancel)
    return result


def _semisimple(matrix: sp.Matrix, factors: list[sp.Poly], z: sp.Symbol) -> sp.Matrix:
    """The semisimple part: Newton's iteration for the root of the square-free polynomial."""
    # Each step doubles the power of the nilpotent part that is right: it ends, and is exact.
    radical = sp.Poly(1, z, domain=factors[0].domain)
    for factor in factors:
        radical = radical * factor
    slope = radical.diff(z)
    current = matrix
    while True:
        value = _value(radical, current)
        if value.is_zero_matrix:
            return current
        current = (current - value * _value(slope, current).inv()).applyfunc(sp.cancel)


def _projector(
    matrix: sp.Matrix, factor: sp.Poly, factors: list[sp.Poly], z: sp.Symbol
) -> sp.Matrix:
    """Projector on the invariant subspace of one factor."""
    others = sp.Poly(1, z, domain=factor.domain)
    for other in factors:
        if other != factor:
            others = others * other
    inverse = sp.invert(others, factor) if others.degree() else others
    return _value(others * sp.Poly(inverse, z, domain=factor.domain), matrix)


def _block(matrix: sp.Matrix, factor: sp.Poly, z: sp.Symbol, x: sp.Symbol) -> sp.Matrix:
    """exp(x S) on the subspace of one factor, linear or quadratic."""
    identity = sp.eye(matrix.rows)
    coefficients = [sp.cancel(c / factor.LC()) for c in factor.all_coeffs()]
    if factor.degree() == 1:
        return sp.exp(-coefficients[1] * x) * identity
    if factor.degree() > 2:
        raise StructureConstantError(
            f"the adjoint matrix {matrix.tolist()} has the irreducible characteristic factor "
            f"{factor.as_expr()} of degree {factor.degree()}: its exponential is not elementary "
            "here. Change the basis of the algebra, or give the coframe itself."
        )
    middle = sp.cancel(-coefficients[1] / 2)
    discriminant = sp.cancel(middle**2 - coefficients[2])
    rest = matrix - middle * identity
    # Where the sign of the discriminant is open, cosh and sinh hold for either.
    if discriminant.is_negative:
        rate = sp.sqrt(-discriminant)
        even, odd = sp.cos(rate * x), sp.sin(rate * x) / rate
    else:
        rate = sp.sqrt(discriminant)
        even, odd = sp.cosh(rate * x), sp.sinh(rate * x) / rate
    return sp.exp(middle * x) * (even * identity + odd * rest)

"""Theories: Lagrangians by name; their equations come from the general code."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.gravity.theory.lagrangian import Lagrangian, names
from geomtorsion.support import checks

Number = int | str | sp.Expr

tegr = Lagrangian("T", "teleparallel", "teleparallel equivalent of general relativity")
stegr = Lagrangian("Q", "symmetric teleparallel", "symmetric teleparallel equivalent")
general_relativity = Lagrangian("R", "riemannian", "general relativity")
einstein_cartan = Lagrangian("R/(2*kappa)", "metric", "Einstein-Cartan")
gauss_bonnet = Lagrangian("GB", "riemannian", "Gauss-Bonnet")


def new_gr(c1: Number, c2: Number, c3: Number) -> Lagrangian:
    """New general relativity, L = c1 T1 + c2 T2 + c3 T3 (Hayashi, Shirafuji 1979).

    (c1, c2, c3) = (1/4, 1/2, -1) is TEGR.

    Examples
    --------
    >>> new_gr("c1", "c2", "c3")
    new general relativity: L = T1*c1 + T2*c2 + T3*c3
    """
    terms = zip((c1, c2, c3), ("T1", "T2", "T3"), strict=True)
    return Lagrangian(
        sp.Add(*(_number(c) * names[name] for c, name in terms)),
        "teleparallel",
        "new general relativity",
    )


def f_of(invariants: str | Sequence[str], f: object = "f") -> Lagrangian:
    """Theory with L = f(T), f(Q), f(R) or f of several invariants.

    f is a name, a sympy function or a lambda. f(T) is teleparallel, f(Q) symmetric teleparallel;
    f(R) and f(GB) use only the metric. All other invariants accept any connections.

    Examples
    --------
    >>> f_of("T", lambda T: T + T**2 / 2)
    f(T): L = T**2/2 + T
    """
    listed = [invariants] if isinstance(invariants, str) else checks.entries(invariants, "f_of")
    for name in listed:
        checks.known_name(name, names, "f_of", GravityError)
    function = sp.Function(f) if isinstance(f, str) else f
    if not callable(function):
        raise GravityError(
            f"f_of: expected the name of a function or a function, got {checks.shown(f)}. Write "
            "f_of('T', 'f') or f_of('T', lambda T: T**2)."
        )
    geometries = {
        "T": "teleparallel",
        "Q": "symmetric teleparallel",
        "R": "riemannian",
        "Rbar": "riemannian",
        "GB": "riemannian",
    }
    geometry = geometries.get(listed[0], "any") if len(listed) == 1 else "any"
    value = function(*(names[name] for name in listed))
    wanted = "a sympy expression as the value of f"
    expression = checks.expression(value, "f_of", GravityError, expected=wanted)
    return Lagrangian(expression, geometry, f"f({', '.join(listed)})")


def poincare(
    scalar: Number = "a",
    cosmological: Number = 0,
    *,
    tensor: Number = 0,
    vector: Number = 0,
    axial: Number = 0,
    curvature: Sequence[Number] = (0,) * 6,
) -> Lagrangian:
    """Poincare gauge theory: a (R - 2 Lambda) + squares of the parts of torsion and curvature.

    Parameters
    ----------
    scalar, cosmological
        a and Lambda.
    tensor, vector, axial
        Factors of the squares tensor2, vector2, axial2 of the parts of torsion.
    curvature
        Six factors of P1 ... P6: weyl, paircom, pseudoscalar, ricci, antiricci, scalar.

    Examples
    --------
    >>> poincare("a", "Lambda", tensor="b", curvature=(0, 0, 0, 0, 0, "w"))
    Poincare gauge theory: L = P6*w + a*(-2*Lambda + R) + b*tensor2
    """
    squares = checks.entries(curvature, "curvature", GravityError)
    if len(squares) != 6:
        raise GravityError(
            f"curvature: expected six factors, got {len(squares)}. Give one for each of P1 ... P6."
        )
    constant = _number(cosmological)
    total = _number(scalar) * (names["R"] - 2 * constant)
    total += sum(
        _number(x) * names[f"{part}2"]
        for part, x in (("tensor", tensor), ("vector", vector), ("axial", axial))
    )
    total += sum(_number(x) * names[f"P{k}"] for k, x in enumerate(squares, 1))
    added = sorted(x.name for x in constant.free_symbols & total.free_symbols)
    return Lagrangian(total, "metric", "Poincare gauge theory", tuple(added))


def holst(barbero_immirzi: Number = "gamma") -> Lagrangian:
    """Holst's theory, L = R - eps^abmn R_abmn / (2 gamma) (Holst 1996), in four dimensions.

    Examples
    --------
    >>> holst()
    Holst: L = R - holst/(2*gamma)
    """
    return Lagrangian(
        names["R"] - names["holst"] / (2 * _number(barbero_immirzi)), "metric", "Holst"
    )


def _number(value: Number) -> sp.Expr:
    """A factor: a number, an expression, or the name of a parameter."""
    return sp.Symbol(value) if isinstance(value, str) and value.isidentifier() else _read(value)


def _read(value: object) -> sp.Expr:
    wanted = "a number, an expression or the name of a parameter"
    return checks.expression(value, "factor", GravityError, expected=wanted)

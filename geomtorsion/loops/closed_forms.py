"""Closed forms: definite integrals in one variable that can be done exactly, and how."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import product
from math import comb
from typing import NoReturn

import sympy as sp

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.exact import Field

# A symbol for cos(t) and one for sin(t), once all multiples of t are expanded.
COS, SIN = sp.Symbol("C", real=True), sp.Symbol("S", real=True)
Method = Callable[[sp.Expr, sp.Symbol, sp.Expr, sp.Expr], sp.Expr | None]


class OutOfTimeError(BaseException):
    """Raised inside sympy when the time is over; not an Exception, so that nothing swallows it."""


@contextmanager
def deadline(seconds: float) -> Iterator[None]:
    """End the body by OutOfTimeError when the time is over."""
    if hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread():
        before = signal.signal(signal.SIGALRM, _over)
        signal.setitimer(signal.ITIMER_REAL, seconds)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)
        return
    # Where there are no timers, every call looks at the clock, at half the speed.
    end, hook = time.monotonic() + seconds, sys.getprofile()

    def watch(*_: object) -> None:
        if time.monotonic() > end:
            _over()

    sys.setprofile(watch)
    try:
        yield
    finally:
        sys.setprofile(hook)


def _over(*_: object) -> NoReturn:
    """The time is over."""
    raise OutOfTimeError


def definite(f: sp.Expr, t: sp.Symbol, low: sp.Expr, high: sp.Expr) -> sp.Expr | None:
    """Integral of f over t from low to high, or None if no method here finds a closed form."""
    f = tidy(f, t)
    if not f.has(t):
        return f * (high - low)
    if f.is_polynomial(t):
        return sp.integrate(sp.expand(f), (t, low, high))
    turns = (high - low) / (2 * sp.pi)
    if turns.is_Integer:
        for method in (_bessel, _residues):
            result = method(f, t)
            if result is not None:
                return turns * result
    result = sp.integrate(f, (t, low, high))
    return None if result.has(sp.Integral, sp.nan, sp.zoo) else result


def tidy(f: sp.Expr, t: sp.Symbol) -> sp.Expr:
    """The same function on a common basis, where the field can read it."""
    f = f.replace(_is_shifted, lambda wave: _split(wave, t))
    # cos(3/10) and cos(1) stay what they are: their common basis would be cos(1/10).
    known = [x for x in f.atoms(sp.cos, sp.sin) if not x.free_symbols]
    names = {x: sp.Dummy(f"k{k}", real=True) for k, x in enumerate(known)}
    plain = f.subs(names)
    try:
        found = Field([t, *sorted(plain.free_symbols - {t}, key=str)]).read(plain).sympy
    except (ExpressionError, LimitError, ZeroDivisionError):
        found = plain
    return found.subs({name: x for x, name in names.items()})


def _is_shifted(x: sp.Expr) -> bool:
    """Whether this is the sine or cosine of a sum."""
    return isinstance(x, sp.cos | sp.sin) and x.args[0].is_Add


def _split(wave: sp.Expr, t: sp.Symbol) -> sp.Expr:
    """cos(a + b) and sin(a + b) by the addition theorem, a free of t."""
    a, b = wave.args[0].as_independent(t, as_Add=True)
    if isinstance(wave, sp.cos):
        return sp.cos(a) * sp.cos(b) - sp.sin(a) * sp.sin(b)
    return sp.sin(a) * sp.cos(b) + sp.cos(a) * sp.sin(b)


def _in_circle(f: sp.Expr, t: sp.Symbol) -> sp.Expr | None:
    """f with symbols for cos(t) and sin(t), None if t occurs in other ways."""
    wanted = [x for x in f.atoms(sp.cos, sp.sin) if x.args[0].has(t) and x.args[0].is_polynomial(t)]
    found = f.subs({x: sp.expand_trig(x) for x in wanted})
    found = found.subs({sp.cos(t): COS, sp.sin(t): SIN})
    return None if found.has(t) else found


def _bessel(f: sp.Expr, t: sp.Symbol) -> sp.Expr | None:
    """Polynomials in cos t, sin t and waves of a cos t + b sin t, over one turn.

    integral_0^{2 pi} exp(i (a cos t + b sin t)) exp(i n t) dt
        = 2 pi i^n ((a + i b) / r)^n J_n(r),  r^2 = a^2 + b^2                  (Jacobi, Anger)
    """
    found = _in_circle(f, t)
    if found is None:
        return None
    waves = [x for x in found.atoms(sp.cos, sp.sin) if x.has(COS, SIN)]
    flat = found.subs({x: x.rewrite(sp.exp) for x in waves})
    flat = sp.powsimp(sp.expand(flat), combine="exp")
    total: list[sp.Expr] = []
    for term in sp.Add.make_args(sp.expand(flat, power_exp=False)):
        part = _term(term)
        if part is None:
            return None
        total.append(part)
    return _real(sp.Add(*total))


def _term(term: sp.Expr) -> sp.Expr | None:
    """Integral over one turn of constant * C^p * S^q * exp(linear in C and S)."""
    constant, rest = term.as_independent(COS, SIN, as_Add=False)
    p = q = 0
    a = b = sp.S.Zero
    for factor in sp.Mul.make_args(rest):
        base, exponent = factor.as_base_exp()
        if base == COS and exponent.is_Integer and exponent > 0:
            p += int(exponent)
        elif base == SIN and exponent.is_Integer and exponent > 0:
            q += int(exponent)
        elif isinstance(factor, sp.exp) and factor.args[0].is_polynomial(COS, SIN):
            linear = sp.Poly(factor.args[0], COS, SIN)
            if linear.total_degree() > 1:
                return None
            a += linear.coeff_monomial(COS) / sp.I
            b += linear.coeff_monomial(SIN) / sp.I
            constant *= sp.exp(linear.coeff_monomial(1))
        elif factor != 1:
            return None
    if not sp.expand(constant):
        return sp.S.Zero
    r = sp.sqrt(sp.factor(sp.expand(a**2 + b**2)))
    result = sp.S.Zero
    for j, k in product(range(p + 1), range(q + 1)):
        # C^p S^q as a sum of exp(i n t).
        n = p - 2 * j + q - 2 * k
        weight = sp.Rational(comb(p, j) * comb(q, k) * (-1) ** k, 2 ** (p + q)) / sp.I**q
        if r == 0:
            result += weight * (1 if n == 0 else 0)
        else:
            bessel = sp.besselj(abs(n), r) * ((-1) ** abs(n) if n < 0 else 1)
            result += weight * sp.I**n * sp.expand((a + sp.I * b) / r) ** n * bessel
    return 2 * sp.pi * constant * result


def _real(total: sp.Expr) -> sp.Expr:
    """A sum of conjugate pairs, written without I."""
    return sp.factor_terms(sp.expand(sp.expand_trig(sp.expand(total).rewrite(sp.cos))))


def _residues(f: sp.Expr, t: sp.Symbol) -> sp.Expr | None:
    """Rational functions of cos t and sin t with numbers in the denominator, over one turn."""
    found = _in_circle(f, t)
    if found is None or not found.is_rational_function(COS, SIN):
        return None
    z = sp.Symbol("z")
    table = {COS: (z + 1 / z) / 2, SIN: (z - 1 / z) / (2 * sp.I)}
    above, below = sp.fraction(sp.cancel(sp.together(found.subs(table) / (sp.I * z))))
    factor, below = below.as_independent(z, as_Add=False)
    if below.free_symbols - {z}:
        return None
    total = sp.S.Zero
    roots = sp.roots(sp.Poly(below, z))
    if sum(roots.values()) != sp.degree(below, z):
        return None
    for root in roots:
        if abs(complex(root.evalf(30))) < 1:
            total += sp.residue(above / (factor * below), z, root)
    return sp.simplify(sp.radsimp(2 * sp.pi * sp.I * total))

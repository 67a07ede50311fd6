"""Exponents: exp, cosh and sinh of any argument in terms of one generator an atom."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy
from flint import fmpq

from geomtorsion.exact import limits
from geomtorsion.exact.generators import Generator
from geomtorsion.exact.rational_basis import RationalBasis, single_generator, undone_by_exp

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower


class Exponents:
    """exp over a rational basis of the exponents.

    An atom met only under cosh and sinh keeps these two as its generators; one that is
    also met under exp is written in exp alone.
    """

    def __init__(self, field: Tower) -> None:
        self._field = field
        self.basis: RationalBasis = RationalBasis(field, undone_by_exp)
        self._plain: set[int] = set()
        self._base: dict[int, tuple[fmpq, Element, Element]] = {}
        self._powers: dict[tuple[int, fmpq], tuple[Element, Element]] = {}

    def prepare(self, exponents: list[Element], hyperbolic: list[Element]) -> None:
        """Chooses units that serve all these at once, and which atoms take exp."""
        self.basis.choose([*exponents, *hyperbolic])
        for plain, batch in ((True, exponents), (False, hyperbolic)):
            for exponent in batch:
                for coefficient, index in self.basis.decompose(exponent):
                    if index not in self._base:
                        self.basis.refine_unit(index, coefficient)
                        if plain:
                            self._plain.add(index)

    def exp(self, exponent: Element) -> Element:
        """exp of an exponent without imaginary part."""
        result = self._field.one
        for coefficient, index in self.basis.decompose(exponent):
            self._plain.add(index)
            result = result * self._power(index, coefficient)[0]
        return result

    def cosh_sinh(self, argument: Element) -> tuple[Element, Element]:
        """(cosh, sinh) of an argument without imaginary part."""
        # cosh and sinh of a sum are sums of products of exponentials, each of one atom.
        up = down = self._field.one
        for coefficient, index in self.basis.decompose(argument):
            a, b = self._power(index, coefficient)
            up, down = up * a, down * b
        half = fmpq(1, 2)
        return (up + down) * half, (up - down) * half

    def _power(self, index: int, coefficient: fmpq) -> tuple[Element, Element]:
        """exp of plus and of minus coefficient * atom."""
        known = self._powers.get((index, coefficient))
        if known is not None:
            return known
        if index not in self._base:
            self._make(index, coefficient)
        unit, up, down = self._base[index]
        count = coefficient / unit
        if count.q != 1:
            parts = int(count.q)
            limits.check_multiple(parts, "exponents", self.basis.elements[index], unit / parts)
            up = self._field.root(up, parts)
            unit, down = unit / parts, up.inverse()
            self._base[index] = (unit, up, down)
            count = coefficient / unit
        n = int(count.p)
        limits.check_multiple(n, "exponents", self.basis.elements[index], unit)
        result = (up**n, down**n) if n > 0 else (down**-n, up**-n)
        self._powers[index, coefficient] = result
        return result

    def _make(self, index: int, coefficient: fmpq) -> None:
        field = self._field
        atom = self.basis.elements[index]
        inverse = self._of_inverse_function(atom)
        if inverse is not None:
            self._base[index] = (fmpq(1), inverse, inverse.inverse())
            return
        unit = self.basis.units[index] or abs(coefficient)
        self.basis.units[index] = unit
        exponent = atom * unit
        n, shown = len(field.generators), exponent.sympy
        if index in self._plain:
            name = f"ex{n}"
            up = field.add(
                Generator("exp", name, _power_of_logs(shown), exponent.symbols, argument=exponent)
            )
            self._base[index] = (unit, up, up.inverse())
            return
        names = (f"ch{n}", f"sh{n}")
        cosh = field.add(
            Generator(
                "cosh",
                names[0],
                sympy.cosh(shown),
                exponent.symbols,
                argument=(exponent, names[1]),
            )
        )
        sinh = field.add(
            Generator(
                "sinh",
                names[1],
                sympy.sinh(shown),
                exponent.symbols,
                2,
                cosh * cosh - 1,
                argument=(exponent, names[0]),
            )
        )
        # exp(u) and exp(-u) by cosh and sinh, so that results read in these two.
        self._base[index] = (unit, cosh + sinh, cosh - sinh)

    def _of_inverse_function(self, atom: Element) -> Element | None:
        """exp of log, asinh, acosh, atanh: algebraic."""
        field = self._field
        generator = single_generator(field, atom)
        if generator is None:
            return None
        if generator.kind == "constant" and isinstance(generator.shown, sympy.log):
            return field.read(generator.shown.args[0])
        if generator.kind not in ("log", "primitive"):
            return None
        if generator.kind == "log":
            return generator.argument
        u = generator.argument[0]
        name = type(generator.shown).__name__
        if name == "asinh":
            return u + (u * u + 1).sqrt()
        if name == "acosh":
            return u + (u * u - 1).sqrt()
        if name in ("atanh", "acoth"):
            return ((1 + u) / (1 - u) if name == "atanh" else (u + 1) / (u - 1)).sqrt()
        return None


def _power_of_logs(exponent: sympy.Expr) -> sympy.Expr:
    """exp(exponent), as base**p where the exponent is p * log(base)."""
    factors = sympy.Mul.make_args(exponent)
    logs = [factor for factor in factors if isinstance(factor, sympy.log)]
    if len(logs) != 1:
        return sympy.exp(exponent)
    return logs[0].args[0] ** (exponent / logs[0])

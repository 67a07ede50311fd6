"""Conserved: the quantities that a scene keeps, as far as they are made of its states."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from random import Random
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.errors import GeomtorsionError
from geomtorsion.precision import EXACT_BITS, working_precision
from geomtorsion.scenes.assembly import WORK, Assembly, by_quaternion
from geomtorsion.scenes.context import ATTITUDE, QUATERNION, TIME, VERTICAL

if TYPE_CHECKING:
    from geomtorsion.scenes.selection import StateSelection

# With fractions a rate is zero exactly; with roots and functions a rate that is below its terms by
# half of the bits that are worked out counts as zero.
NOTHING = 0.5 ** (EXACT_BITS // 2)


def invariants(
    selection: StateSelection, correct: Assembly, chosen: Mapping[sp.Symbol, sp.Expr]
) -> dict[str, sp.Expr | list[sp.Expr]]:
    """Name -> expression (or several) that does not change, over the states that are solved for.

    A quantity is taken for conserved if its rate vanishes, exactly or to 60 digits, at random
    states of motion.

    correct: the equations by which a quantity is to be conserved.
    chosen: elements of R -> expressions in the states that are solved for.
    """
    assembly = selection.assembly
    here = {*selection.symbols, *selection.constants, TIME}
    if selection.uses_quaternion:
        here |= set(ATTITUDE)
    parameters = {sp.Symbol(name) for name in assembly.values}
    switched = {
        name for part in assembly.parts.values() for _, values in part.switches for name in values
    }
    found: dict[str, sp.Expr | list[sp.Expr]] = {}
    for name, parts in _candidates(assembly).items():
        # Where the energy is kept, the balance says nothing more.
        if name == "energy_balance" and "energy" in found:
            continue
        free = {symbol for part in parts for symbol in part.free_symbols} - parameters
        # It has to be made of what is solved for, and of nothing that a switch changes.
        if not free or not free <= here or {s.name for s in free} & switched:
            continue
        if all(is_constant(correct, part) for part in parts):
            given = [part.xreplace(dict(chosen)) for part in parts]
            found[name] = given if len(given) > 1 else given[0]
    return found


def _candidates(assembly: Assembly) -> dict[str, tuple[sp.Expr, ...]]:
    """What may be conserved, most telling first; momenta that are kept are no states at all."""
    energy = assembly.kinetic_energy + assembly.potential_energy
    momentum = assembly.angular_momentum
    return {
        "energy": (energy,),
        "energy_balance": (energy - assembly.constrained(WORK),),
        "rotational_energy": (assembly.rotational_energy,),
        "angular_momentum_space": tuple(ATTITUDE * momentum),
        "angular_momentum_squared": (momentum.dot(momentum),),
        "vertical_angular_momentum": (sp.Matrix(VERTICAL).dot(momentum),),
        "axial_angular_momentum": (momentum[2],),
    }


def is_constant(assembly: Assembly, quantity: sp.Expr) -> bool:
    """Whether the rate of a quantity vanishes at random states; False where it has no value.

    Examples
    --------
    >>> from geomtorsion.scenes import Body
    >>> from geomtorsion.scenes.assembly import assemble
    >>> free = assemble(Body(moments=(1, 2, 3)), {})
    >>> is_constant(free, free.kinetic_energy), is_constant(free, free.context.Omega[0])
    (True, False)
    """
    terms = [sp.diff(quantity, s) * assembly.rate_of(s) for s in quantity.free_symbols]
    terms = [term for term in terms if term != 0]
    if not terms:
        return True
    names = sorted({symbol.name for term in terms for symbol in term.free_symbols})
    made_of = graph(names, terms, factor=False)
    chance = Random(20)
    try:
        # One place could be a zero of the rate by accident, three are none.
        for _ in range(3):
            place = _place(assembly, chance)
            here = [place.get(name, _number(chance)) for name in names]
            if not all(map(math.isfinite, made_of.numpy()(*[float(x) for x in here]).tolist())):
                return False  # More digits of exp(exp(exp(...))) would take for ever.
            values = made_of.exactly(here)
            with working_precision(EXACT_BITS):
                total = abs(sum(values[1:], values[0]))
                if total > NOTHING * max(abs(value) for value in values):
                    return False
    # A root or a logarithm that has no real value at that place proves nothing.
    except (ArithmeticError, ValueError, TypeError, GeomtorsionError):
        return False
    return True


def _place(assembly: Assembly, chance: Random) -> dict[str, sp.Expr]:
    """Parameters as they are (but for those that switches change), and a rotation for R."""
    moving = {symbol.name for symbol in assembly.context.switched}
    place: dict[str, sp.Expr] = {k: v for k, v in assembly.values.items() if k not in moving}
    q: Sequence[int] = [chance.randint(1, 9) for _ in QUATERNION]
    numbers = dict(zip(QUATERNION, q, strict=True))
    size = sum(x * x for x in q)
    return place | {s.name: value.xreplace(numbers) / size for s, value in by_quaternion().items()}


def _number(chance: Random) -> Fraction:
    """A fraction that no special relation suggests."""
    return Fraction(chance.randint(101, 997), chance.choice((107, 211, 307)))

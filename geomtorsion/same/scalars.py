"""Scalars: exact invariants that need no frame, by which two geometries are proved different."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations_with_replacement
from math import gcd

import mpmath

from geomtorsion.exact import Certainty, Element
from geomtorsion.exact.common_values import can_agree
from geomtorsion.exact.element import least_certain
from geomtorsion.geometry import Tensor, contract, levi_civita
from geomtorsion.same.invariants import Invariants, representatives
from geomtorsion.same.matching import DIGITS, WORKING

# So many scalars exclude a point; more only take longer.
DEMANDS = 10
# Geometries that are the same in one sense are so in the next as well.
WEAKER = {"legs": "teleparallel", "teleparallel": "metric", "connection": "metric"}
# Squares of a tensor with three indices.
CUBIC = ("abc,abc->", "abc,acb->", "abc,bac->", "abc,bca->", "abc,cba->")


def scalars(invariants: Invariants) -> dict[str, Element]:
    """Scalar invariants by name: components along fixed legs, otherwise contractions."""
    if not invariants.turns:
        return _components(invariants)
    return {name: value for name, (value, _) in _weighted(invariants).items()}


def _weighted(invariants: Invariants) -> dict[str, tuple[Element, int]]:
    """Contractions by name, each with its power of 1/length."""
    tensors: dict[str, Tensor] = {}
    weights: dict[str, int] = {}
    for tensor in invariants.start:
        symbol, rank = tensor.symbol.strip("\\"), len(tensor.slots)
        upper = tensor.raised()
        if rank == 4:
            curvature = invariants.transport.curvature
            ricci = curvature.ricci
            tensors["the curvature scalar"] = curvature.scalar
            tensors["Ric_ab Ric^ab"] = contract("ab,ab->", ricci, ricci.raised())
            tensors["R_abcd R^abcd"] = contract("abcd,abcd->", tensor, upper)
            weights |= {"the curvature scalar": 2, "Ric_ab Ric^ab": 4, "R_abcd R^abcd": 4}
            continue
        for rule in CUBIC:
            first, second = rule.removesuffix("->").split(",")
            tensors[f"{symbol}_{first} {symbol}^{second}"] = contract(rule, tensor, upper)
            weights[f"{symbol}_{first} {symbol}^{second}"] = 2
    values = {name: tensor.element() for name, tensor in tensors.items()}
    varying = [name for name, value in values.items() if not is_constant(invariants, value)][:3]
    bar = levi_civita(invariants.frame)
    slopes = {name: bar.covariant_derivative(tensors[name]) for name in varying}
    for one, two in combinations_with_replacement(varying, 2):
        name = f"the product of the gradients of {one} and {two}"
        values[name] = contract("a,a->", slopes[one], slopes[two].raised()).element()
        weights[name] = weights[one] + weights[two] + 2
    for name in varying:
        values[f"the Laplacian of {name}"] = bar.laplacian(tensors[name]).element()
        weights[f"the Laplacian of {name}"] = weights[name] + 2
    if not varying:
        for tensor, slope in zip(invariants.start, invariants.order(1), strict=True):
            letters = "abcde"[: len(slope.slots)]
            square = contract(f"{letters},{letters}->", slope, slope.raised())
            name = f"the square of the derivative of {tensor.symbol}"
            values[name] = square.element()
            weights[name] = 6 if len(tensor.slots) == 4 else 4
    return {name: (value, weights[name]) for name, value in values.items()}


def _components(invariants: Invariants) -> dict[str, Element]:
    """All components that are compared, along the legs, counted from 1."""
    values = {}
    for k in range(invariants.highest + 1):
        for tensor in invariants.order(k):
            for index in representatives(tensor):
                places = "".join(str(i + 1) for i in index[k:])
                along = "".join(f"E_{i + 1} " for i in index[:k])
                values[f"{along}T_{places[:2]}^{places[2:]}"] = tensor.element(*index)
    return values


def pseudoscalars(invariants: Invariants) -> Iterator[tuple[str, Element]]:
    """Scalars of an odd number of volume forms."""
    frame, n = invariants.frame, invariants.frame.dimension
    letters = "abcdef"[:n]
    plain = invariants.slot == "d"
    volume = (frame.epsilon if plain else frame.epsilon.in_frame()).raised()
    for tensor in invariants.start:
        rank, symbol = len(tensor.slots), tensor.symbol
        if rank == 3 and n == 3:
            yield "the axial torsion", contract(f"{letters},{letters}->", volume, tensor).element()
        elif rank == 3 and n == 4:
            yield (
                f"epsilon^abcd {symbol}_abe {symbol}_cd^e",
                contract("abcd,abe,cde->", volume, tensor, tensor.raised(2)).element(),
            )
        elif rank == 4 and n == 3:
            ricci = contract("abac->bc", tensor.raised(0))
            slope = levi_civita(frame).covariant_derivative(ricci)
            slope = slope.in_coordinates() if plain else slope.in_frame()
            yield (
                "epsilon^abc Ric_ad D_b Ric_c^d",
                contract("abc,ad,bcd->", volume, ricci.raised(1), slope).element(),
            )
        elif rank == 4 and n == 4:
            mixed = tensor.raised(2).raised(3)
            yield (
                f"epsilon^abcd {symbol}_abef {symbol}_cd^ef",
                contract("abcd,abef,cdef->", volume, tensor, mixed).element(),
            )


def is_constant(invariants: Invariants, value: Element) -> bool:
    """Whether an invariant is the same at all points."""
    return all(value.diff(q).is_zero is True for q in invariants.frame.coordinates)


def contradiction(
    one: Invariants, two: Invariants, first: Mapping[str, Element], second: Mapping[str, Element]
) -> tuple[str, Certainty] | None:
    """An invariant that vanishes, or is constant, for one geometry only, or has two constants."""
    for name, a in first.items():
        b = second[name]
        zeros, sure = (a.is_zero, b.is_zero), [a.certainty, b.certainty]
        if None in zeros:
            continue
        if zeros[0] != zeros[1]:
            return f"{name} vanishes for the {_which(zeros[0])} geometry only", least_certain(sure)
        if zeros == (True, True):
            continue
        constants = is_constant(one, a), is_constant(two, b)
        slopes = [(inv, x) for inv, x in ((one, a), (two, b)) if is_constant(inv, x)]
        sure += [x.diff(q).certainty for inv, x in slopes for q in inv.frame.coordinates]
        if constants[0] != constants[1]:
            reason = f"{name} is constant for the {_which(constants[0])} geometry only"
            return reason, least_certain(sure)
        if constants == (True, True):
            values = _number(one, a), _number(two, b)
            if abs(values[0] - values[1]) > mpmath.mpf(10) ** -DIGITS * abs(values[0]):
                shown = (_text(x, number) for x, number in zip((a, b), values, strict=True))
                reason = f"{name} is {' for the first and '.join(shown)} for the second geometry"
                return reason, least_certain(sure)
    return None


def is_excluded(one: Invariants, two: Invariants, proper: bool = False) -> bool:
    """Whether no point has the scalars of a generic one, here or for a weaker `keep`.

    Parameters of the second geometry may have any values. proper: scalars that a reflection
    changes in sign count as well.
    """
    keeps = [one.keep]
    while keeps[-1] in WEAKER:
        keeps.append(WEAKER[keeps[-1]])
    # The weakest has the shortest invariants.
    for keep in reversed(keeps):
        sides = (one, two)
        if keep != one.keep:
            sides = Invariants(one.frame, keep), Invariants(two.frame, keep)
        if _differ(*sides, proper=proper, by_ratios=bool(one.turns) and not proper):
            return True
    return False


def _differ(one: Invariants, two: Invariants, *, proper: bool, by_ratios: bool) -> bool:
    """The same as `is_excluded`, for the invariants of one `keep`.

    by_ratios: whether ratios of scalars are compared as well, where the second has parameters.
    """
    first, second = map(scalars, (one, two))
    if proper:
        first, second = first | dict(pseudoscalars(one)), second | dict(pseudoscalars(two))
    varying = [k for k, x in first.items() if k in second and x.is_zero is False]
    varying = sorted(varying, key=lambda k: second[k].length)[:DEMANDS]
    parameters = two.frame.parameters
    if not varying or not (one.coordinates or parameters):
        return False
    symbols = (*two.frame.coordinates, *parameters)
    if can_agree([first[k] for k in varying], [second[k] for k in varying], symbols) is False:
        return True
    if not parameters or not by_ratios:
        return False
    ratios = _ratios(one, varying), _ratios(two, varying)
    return bool(ratios[0]) and can_agree(*ratios, symbols) is False


def _ratios(invariants: Invariants, names: Sequence[str]) -> list[Element]:
    """Ratios of powers of scalars without a unit, which do not depend on the scale of a family."""
    weighted = _weighted(invariants)
    base, unit = weighted[names[0]]
    result = []
    for name in names[1:]:
        value, weight = weighted[name]
        shared = gcd(unit, weight)
        result.append(value ** (unit // shared) / base ** (weight // shared))
    return result


def _text(value: Element, number: mpmath.mpf) -> str:
    """A constant, exact if that is short."""
    exact = str(value)
    return exact if len(exact) < 20 else mpmath.nstr(number, 6)


def _which(is_first: bool | None) -> str:
    return "first" if is_first else "second"


def _number(invariants: Invariants, value: Element) -> mpmath.mpf:
    """The value of an invariant that is constant."""
    return value.evaluate(invariants.frame.region.point, mpmath.libmp.dps_to_prec(WORKING))

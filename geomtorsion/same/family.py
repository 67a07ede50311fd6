"""Family: the member of a family of geometries, a frame with parameters, that a geometry is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, islice, product
from math import prod

import numpy as np
import sympy as sp

from geomtorsion.errors import GeomtorsionError
from geomtorsion.exact import Certainty, Element
from geomtorsion.exact.element import least_certain
from geomtorsion.geometry import Frame
from geomtorsion.same.classification import Classification, classification
from geomtorsion.same.equivalence import RESULTANTS, TRIES, UNKNOWN, Equivalence, Outcome
from geomtorsion.same.fitting import parameters_near
from geomtorsion.same.invariants import Invariants
from geomtorsion.same.petrov import ZERO
from geomtorsion.same.scalars import is_excluded, pseudoscalars, scalars
from geomtorsion.same.signs import Contrast, opposite_signs
from geomtorsion.same.vanishing import never_vanishes
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.caching import cached_property

# Parameters are looked for as a rational number times powers of the parameters of the frame.
POWERS = (Fraction(0), Fraction(1), Fraction(-1), Fraction(2), Fraction(-2), Fraction(1, 2))
# The largest denominator of that rational number; it must be met far more exactly than by chance.
LARGEST = 1000
CLOSE = 0.1 / LARGEST**2


@dataclass(frozen=True, eq=False)
class Stratum:
    """The members of a family at which some parameters are zero; positive ones tend to zero.

    family: the frame with all parameters.
    zeros: names of the parameters that are zero.
    frame: the frame with the other parameters.
    """

    family: Frame
    zeros: tuple[str, ...]
    frame: Frame
    keep: str

    @cached_property
    def invariants(self) -> Invariants:
        """The invariants for general values of the other parameters."""
        return Invariants(self.frame, self.keep)

    @cached_property
    def classification(self) -> Classification:
        """The properties for general values of the other parameters."""
        return classification(self.invariants)


def strata(family: Frame, keep: str) -> tuple[Stratum, ...]:
    """The general members first, then the limits with most parameters zero."""
    names = [str(x) for x in family.parameters]
    result = [Stratum(family, (), family, keep)]
    for count in range(len(names), 0, -1):
        for zeros in combinations(names, count):
            frame = _regular_limit(family, zeros)
            if frame is not None:
                result.append(Stratum(family, zeros, frame, keep))
    return tuple(result)


def _regular_limit(family: Frame, zeros: tuple[str, ...]) -> Frame | None:
    """The frame at which parameters are zero; None where it is regular nowhere."""
    try:
        frame = _limit(family, zeros)
        return frame if frame.region.point else None
    except GeomtorsionError:
        return None


def _limit(frame: Frame, names: tuple[str, ...]) -> Frame:
    """The frame at which parameters are zero, also where they are declared positive."""
    zeros = {x: 0 for x in frame.parameters if str(x) in names}
    n = range(frame.dimension)
    relations = [relation.subs(zeros) for relation in frame.domain]
    # Roots of squares take the signs that they have in the domain: sqrt(r**2) is r.
    signs = {q: sp.Dummy(positive=True) for q in frame.coordinates if frame.region.sign(q) == 1}
    back = {dummy: q for q, dummy in signs.items()}
    rows = [
        [sp.powdenest(frame.coframe[i, k].subs({**zeros, **signs})).subs(back) for k in n]
        for i in n
    ]
    return Frame(
        frame.coordinates,
        rows,
        [[frame.eta[i, k] for k in n] for i in n],
        parameters=[x for x in frame.parameters if x not in zeros],
        domain=[relation for relation in relations if relation != sp.true],
        complex=frame.complex,
    )


def member(frame: Frame, values: Mapping[str, sp.Expr]) -> Frame:
    """The frame at values of its parameters, or its limit where a positive one is zero."""
    zeros = tuple(str(x) for x in frame.parameters if values[str(x)] == 0 and x.is_zero is False)
    limit = _limit(frame, zeros) if zeros else frame
    own = {str(x): values[str(x)] for x in limit.parameters}
    return limit.subs(own) if own else limit


@dataclass(frozen=True)
class Query:
    """A geometry whose member of a family is searched, at generic values of its parameters.

    values: those values, by name.
    classification: properties for general values.
    assumption: the region that was assumed, in words.
    """

    one: Invariants
    values: Mapping[str, sp.Rational]
    classification: Classification
    assumption: str

    @classmethod
    def of(cls, frame: Frame, keep: str) -> Query:
        """The query for a frame."""
        point = frame.region.point
        values = {str(x): point[x] for x in frame.parameters}
        whole = Invariants(frame, keep)
        one = Invariants(frame.subs(values), keep) if values else whole
        return cls(one, values, classification(whole), frame.region.assumption)

    def equivalence(
        self,
        family: Frame,
        values: Mapping[str, sp.Expr],
        near: np.ndarray | None = None,
        orientation: bool = False,
    ) -> Equivalence | None:
        """The comparison with a member of a family; None for values that it does not allow.

        values: of the parameters of the family by name, in parameters of the frame.
        near: coordinates of the member from which the search for a point begins.
        """
        numbers = {
            k: x.subs({own: self.values[own.name] for own in x.free_symbols})
            for k, x in values.items()
        }
        try:
            two = Invariants(member(family, numbers), self.one.keep)
            assumptions = self.assumption, ""
            result = Equivalence(self.one, two, orientation, self.values, assumptions, near, values)
            _ = result.verdict
        except GeomtorsionError:
            return None
        return result

    # -- which values ------------------------------------------------------------------------------

    def candidates(
        self, stratum: Stratum
    ) -> Iterator[tuple[np.ndarray | None, dict[str, sp.Expr], tuple[str, ...]]]:
        """For each start of a fit a place, values of all parameters, and limits, as "M -> oo".

        The values are empty where the fit fails or runs to a limit.
        """
        zeros = dict.fromkeys(stratum.zeros, sp.Integer(0))
        names = [str(x) for x in stratum.frame.parameters]
        if not names:
            yield None, zeros, ()
            return
        tried = set[tuple[sp.Expr, ...]]()
        if not zeros and set(names) <= set(self.values):
            # Parameters of the same names are the same constants, if they fit.
            yield None, {x: sp.Symbol(x, positive=True) for x in names}, ()
        # A few points, each from a few starts.
        points = islice(self.one.frame.region.points(), TRIES // 4)
        for number, start in enumerate(points):
            for fit in parameters_near(self.one, start, stratum.invariants, TRIES // 3):
                if fit is None:
                    yield None, {}, ()
                    continue
                ends = tuple(
                    f"{name} -> {'0' if value == 0 else 'oo'}"
                    for x, name, value in zip(
                        stratum.frame.parameters, names, fit.values, strict=True
                    )
                    if np.isinf(value) or (value == 0 and x.is_zero is False)
                )
                if ends:
                    yield None, {}, ends
                    continue
                options = [list(islice(expressions(x, self.values), 4)) for x in fit.values]
                for chosen in product(*options):
                    if chosen not in tried:
                        tried.add(chosen)
                        values = zeros | dict(zip(names, chosen, strict=True))
                        ordered = {str(x): values[str(x)] for x in stratum.family.parameters}
                        yield None if number else fit.place, ordered, ()

    def excluded(self, stratum: Stratum) -> Contrast | None:
        """Why no member of a stratum is the geometry, by cheap properties; None: some may be."""
        own, other, two = self.classification, stratum.classification, stratum.invariants
        sure = [self.one.certainty, two.certainty]
        if own.excludes(other) and not own.may_be_special(other):
            if self.one.growth == two.growth:
                sure.append(Certainty(proved=False, error=10.0**-ZERO))
            text = f"the {{first}} geometry: {own}; the {{second}}: {other}"
            return Contrast(text, least_certain(sure))
        return None

    def proof(self, stratum: Stratum) -> Contrast | None:
        """The proof by invariants that no member of a stratum is the geometry, if there is one."""
        two = stratum.invariants
        first, second = _named(self.one), _named(two)
        for name in (name for name in first if name in second):
            a, b = first[name], second[name]
            if a.is_zero is True and never_vanishes(b, stratum.frame):
                reason = f"{name} vanishes for the {{first}} geometry only"
                return Contrast(reason, least_certain([a.certainty, b.certainty]))
        if is_excluded(self.one, two):
            reason = (
                "no point of the {second} geometry has the invariants of a generic point of the "
            )
            return Contrast(reason + "{first}, for any values of the parameters", RESULTANTS)
        return opposite_signs(self.one, two, scalars(self.one), scalars(two))


def _named(invariants: Invariants) -> dict[str, Element]:
    """Scalars, also those that a reflection changes in sign; none along fixed legs."""
    return scalars(invariants) | dict(pseudoscalars(invariants)) if invariants.turns else {}


def member_of(
    frame: Frame, family: Frame, keep: str, orientation: bool, flipped: bool = False
) -> Equivalence:
    """The comparison of a geometry with a member of a family, or with all members.

    flipped: the family is the first geometry of the answer.
    """
    query, whole = Query.of(frame, keep), Invariants(family, keep)
    sides = (whole, query.one) if flipped else (query.one, whole)
    texts = ("", query.assumption) if flipped else (query.assumption, "")
    every = Equivalence(*sides, orientation, query.values, texts)
    if every.simple_difference is not None:
        return every
    contrasts, ends, is_open = [], dict[str, None](), False
    for stratum in strata(family, keep):
        contrast = query.excluded(stratum)
        candidates = () if contrast is not None else query.candidates(stratum)
        for number, (place, values, limits) in enumerate(candidates):
            check_limits()
            ends |= dict.fromkeys(limits)
            result = query.equivalence(family, values, place, orientation) if values else None
            if result is not None and (result.verdict == "same" or result.is_mirror_image):
                return result.swapped() if flipped else result
            if result is not None and not stratum.frame.parameters:
                if result.verdict == "different":
                    contrast = Contrast("the members without parameters differ", result.certainty)
            elif number == 0:
                contrast = query.proof(stratum)
            if contrast is not None:
                break
        is_open = is_open or contrast is None
        contrasts += [] if contrast is None else [contrast]
    outcome = _decided(contrasts, list(ends), family.parameters, is_open, flipped)
    return replace(every, decided=outcome)


def _decided(
    contrasts: Sequence[Contrast],
    ends: Sequence[str],
    parameters: Sequence[sp.Symbol],
    is_open: bool,
    flipped: bool,
) -> Outcome:
    """The outcome without an equal member; is_open: some members are not excluded."""
    towards = f"; the invariants are approached for {', '.join(ends)}" if ends else ""
    if is_open:
        names = ", ".join(map(str, parameters))
        text = f"no values of {names} were found, and not all are excluded{towards}"
        return Outcome("undecided", text, UNKNOWN)
    sure = least_certain(x.certainty for x in contrasts)
    return Outcome("different", contrasts[0].reason(flipped) + towards, sure)


def expressions(value: float, own: Mapping[str, sp.Rational]) -> Iterator[sp.Expr]:
    """A float as a simple number times powers of parameters, the simplest first."""
    if value == 0:
        yield sp.Integer(0)
    if not value or not np.isfinite(value):
        return
    simple = []
    for powers in product(POWERS, repeat=len(own)):
        factors = zip(own.values(), powers, strict=True)
        size = prod(float(v) ** float(p) for v, p in factors)
        for root in (1, 2):
            ratio = _simple((value / size) ** root)
            if ratio and abs(float(ratio) - (value / size) ** root) < CLOSE * abs(float(ratio)):
                number = sp.Rational(ratio.numerator, ratio.denominator)
                number = number if root == 1 else sp.sign(sp.Float(value)) * sp.sqrt(number)
                monomial = sp.prod(
                    sp.Symbol(k, positive=True) ** sp.Rational(p.numerator, p.denominator)
                    for k, p in zip(own, powers, strict=True)
                )
                cost = ratio.numerator + ratio.denominator + 5 * sum(map(abs, powers)) + 9 * root
                simple.append((cost, str(number * monomial), number * monomial))
                break
    for _, _, expression in sorted(simple, key=lambda entry: entry[:2]):
        yield expression


def _simple(value: float) -> Fraction:
    """The nearest fraction of small whole numbers, or the nearest whole number."""
    if abs(value) <= 1:
        return Fraction(value).limit_denominator(LARGEST)
    inverse = Fraction(1 / value).limit_denominator(LARGEST)
    close = inverse and abs(value * float(inverse) - 1) < CLOSE
    return 1 / inverse if close else Fraction(round(value))

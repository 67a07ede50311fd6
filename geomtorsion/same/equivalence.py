"""Equivalence: the verdict on two geometries, its reason, its certainty and matched points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import SupportsFloat

import numpy as np
import sympy as sp

from geomtorsion.errors import UndecidedError
from geomtorsion.exact import Certainty, Element
from geomtorsion.exact.element import PROVED, least_certain
from geomtorsion.same.classification import signature
from geomtorsion.same.coordinate_map import CoordinateMap
from geomtorsion.same.invariants import Growth, Invariants
from geomtorsion.same.matching import DIGITS, Match, Search, identity
from geomtorsion.same.scalars import contradiction, is_excluded, scalars
from geomtorsion.same.signs import Contrast, mirror_images, opposite_signs
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import ByContent
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive

# Chance of error of a proof by resultants modulo a prime.
RESULTANTS = Certainty(proved=False, error=1e-60)
# Starts of the search for a point, and of that for a turn.
TRIES = 12
# Two geometries that differ agree to fewer digits than this, except by accident.
AGREES = 10.0 ** (8 - DIGITS)


@dataclass(frozen=True)
class Outcome:
    """A verdict, its reason, its certainty, and the points at which it was found."""

    verdict: str
    reason: str
    certainty: Certainty
    match: Match | None = None

    @classmethod
    def of(cls, contrast: Contrast) -> Outcome:
        """The outcome of opposite signs."""
        return cls("different", contrast.reason(), contrast.certainty)


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class Equivalence(ByContent):
    """Verdict on two geometries, with its reason and certainty.

    one, two: their invariants.
    orientation: whether left and right are kept apart.
    parameters: values that were given to parameters, by name.
    assumptions: the regions that were assumed for frames without a declared domain, in words.
    near: coordinates of the second geometry to which the search for a point is limited, if known.
    member: values of the parameters of a family at which it was compared, by name.
    decided: the outcome, where it is about all members of a family.
    """

    one: Invariants
    two: Invariants
    orientation: bool = False
    parameters: Mapping[str, sp.Rational] = field(default_factory=dict)
    assumptions: tuple[str, str] = ("", "")
    near: np.ndarray | None = field(default=None, repr=False)
    member: Mapping[str, sp.Expr] = field(default_factory=dict)
    decided: Outcome | None = field(default=None, repr=False, compare=False)

    @property
    def verdict(self) -> str:
        """ "same", "different" or "undecided"."""
        return self._outcome.verdict

    @property
    def reason(self) -> str:
        """Reason for the verdict, in words."""
        return self._outcome.reason

    @property
    def certainty(self) -> Certainty:
        """Certainty of the verdict.

        "different" is proved, up to the chance of error of ranks modulo a prime, or rests on signs
        that are proved in both regions. "same" is proved
        where all invariants are constants that agree exactly; otherwise its error is the largest
        difference of invariants at the matched point, as two geometries that differ agree to so
        many digits only by accident.
        """
        return self._outcome.certainty

    @property
    def match(self) -> Match | None:
        """The two points at which the invariants agree; None if the search found no such points."""
        return self._outcome.match

    @property
    def difference(self) -> float | None:
        """The largest relative difference of invariants at the matched points, or None."""
        return None if self.match is None else self.match.difference

    @property
    def growth(self) -> tuple[Growth, ...]:
        """Independent invariants of the first geometry at each order of derivatives."""
        return self.one.growth

    @property
    def symmetries(self) -> tuple[int, int]:
        """The number of symmetries of both, near a generic point."""
        return self.one.symmetries, self.two.symmetries

    @property
    def isotropy(self) -> tuple[int, int]:
        """Dimension of the isotropy group at a generic point: turns that keep all invariants."""
        return self.one.isotropy, self.two.isotropy

    @property
    def is_mirror_image(self) -> bool:
        """Whether only a reflection, which does not count here, takes one into the other."""
        if not self.orientation or self.verdict == "same":
            return False
        return replace(self, orientation=False).verdict == "same"

    def swapped(self) -> Equivalence:
        """The verdict on the second and the first geometry."""
        outcome = None
        if self.verdict == "same":
            match = None if self.match is None else self.match.inverted()
            outcome = replace(self._outcome, match=match)
        return replace(
            self,
            one=self.two,
            two=self.one,
            assumptions=self.assumptions[::-1],
            near=None,
            decided=outcome,
        )

    @cached_property
    def map(self) -> CoordinateMap:
        """The map from coordinates of the first geometry to coordinates of the second.

        Raises
        ------
        UndecidedError
            The geometries are not the same, or this is not known.
        """
        if self.verdict != "same" or self.match is None:
            raise UndecidedError(
                f"expected two geometries that are the same, got the verdict {self.verdict}: "
                f"{self.reason}. Only geometries that are the same have a map."
            )
        return CoordinateMap(self.one, self.two, self.match)

    def __bool__(self) -> bool:
        if self.verdict == "undecided":
            raise UndecidedError(
                f"whether the geometries are the same is undecided: {self.reason}. "
                "Read `verdict` and `reason`."
            )
        return self.verdict == "same"

    # -- the verdict -----------------------------------------------------------------------------

    @cached_property
    def _outcome(self) -> Outcome:
        one, two = self.one, self.two
        if self.decided is not None:
            return self.decided
        if one is two:
            return Outcome("same", "both are given by equal formulas", PROVED, identity(one))
        simple = self.simple_difference
        if simple is not None:
            return Outcome("different", simple, PROVED)
        sure = least_certain([one.certainty, two.certainty])
        for which, inv in (("first", one), ("second", two)):
            if inv.certainty.error >= 1:
                reason = f"whether invariants of the {which} geometry vanish cannot be decided"
                return Outcome("undecided", reason, inv.certainty)
        if one.growth != two.growth:
            return Outcome("different", self._ranks(), sure)
        first, second = scalars(one), scalars(two)
        proof = contradiction(one, two, first, second)
        if proof is not None:
            return Outcome("different", *proof)
        opposite = opposite_signs(one, two, first, second)
        if opposite is not None:
            return Outcome.of(opposite)
        match = self._searched()
        if match is not None and match.difference < AGREES:
            exact = one.rank == 0 and one.keep in ("legs", "metric") and _are_equal(first, second)
            error = Certainty(proved=False, error=max(match.difference, 10.0**-DIGITS))
            certainty = sure if exact else least_certain([sure, error])
            return Outcome("same", "all invariants agree", certainty, match)
        if is_excluded(one, two):
            reason = "no point of the second geometry has the invariants of a generic point"
            return Outcome("different", reason + " of the first", RESULTANTS)
        if self.orientation:
            mirror = replace(self, orientation=False)
            if mirror.verdict == "same":
                contrast = mirror_images(one, two)
                if contrast is not None:
                    return Outcome.of(contrast)
                reason = "the same after a reflection only"
                if is_excluded(one, two, proper=True):
                    return Outcome("different", reason, RESULTANTS)
                reason = "the same after a reflection, and no map without one was found"
                return Outcome("undecided", reason, UNKNOWN)
        return Outcome("undecided", self._unmatched(match), UNKNOWN, match)

    def _searched(self) -> Match | None:
        """The best match, from a generic point of either geometry.

        One region may be part of the other, as the outside of a black hole is.
        """
        # The search evaluates the second geometry often.
        swapped = self.near is None and _length(self.one) < _length(self.two)
        best: Match | None = None
        for other_way in (swapped, not swapped):
            sides = (self.two, self.one) if other_way else (self.one, self.two)
            match = Search(
                *sides, self.orientation, TRIES, None if other_way else self.near
            ).match()
            if match is not None and (best is None or match.difference < best.difference):
                best = match.inverted() if other_way else match
            if self.near is not None or (best is not None and best.difference < AGREES):
                break
        return best

    @property
    def simple_difference(self) -> str | None:
        """A difference of dimension or signature, in words."""
        one, two = self.one.frame, self.two.frame
        if one.dimension != two.dimension:
            return f"the dimensions are {one.dimension} and {two.dimension}"
        if not self.one.turns:
            n = range(one.dimension)
            same = all(one.eta[i, j] == two.eta[i, j] for i in n for j in n)
            return None if same else "the scalar products eta of the legs differ"
        first, second = signature(one), signature(two)
        if first == second:
            return None
        hint = ""
        if first == tuple(reversed(second)):
            hint = "; compare it with minus the other metric (change the sign of its eta)"
        texts = [f"({'-' * minus}{'+' * plus})" for minus, plus in (first, second)]
        return f"the signatures are {texts[0]} and {texts[1]}{hint}"

    def _ranks(self) -> str:
        """The difference of ranks, in words."""
        one, two = self.one, self.two
        if one.symmetries != two.symmetries:
            return f"the first has {one.symmetries} symmetries, the second {two.symmetries}"
        if one.isotropy != two.isotropy:
            return (
                f"{one.isotropy} symmetries of the first leave a generic point fixed, and "
                f"{two.isotropy} of the second"
            )
        ranks = ([g.rank for g in x.growth] for x in (one, two))
        return "the numbers of independent invariants by order are {} and {}".format(*ranks)

    def _unmatched(self, match: Match | None) -> str:
        """Why nothing is known."""
        if match is None:
            return "no point was found at which the invariants agree, and none is excluded"
        return (
            f"the best pair of points leaves a relative difference of {match.difference:.0e}, and "
            "other points are not excluded"
        )

    # -- writing ---------------------------------------------------------------------------------

    @property
    def compared(self) -> str:
        """The kind of geometry that was compared."""
        match = self.match if self.verdict == "same" else None
        either = "turn" if self.orientation else "turn or reflection"
        change = either if match is None else "reflection" if match.reflects else "turn"
        return {
            "legs": "frames, leg by leg",
            "teleparallel": f"frames up to one constant {change}",
            "metric": "metrics",
            "connection": "metrics with connections",
        }[self.one.keep]

    def rows(self) -> dict[str, str]:
        """The printed lines, by name."""
        values = ", ".join(f"{k} = {v}" for k, v in self.member.items())
        with_values = f" for {values}" if values else ""
        rows = {
            "verdict": f"{self.verdict}{with_values}: {self.reason}",
            "compared": self.compared,
        }
        if self.verdict == "same" and self.difference is not None and not self.certainty.proved:
            rows["certainty"] = (
                f"largest difference {self.difference:.0e} at a pair of generic points"
                if self.difference
                else "no difference at a pair of generic points"
            )
        else:
            rows["certainty"] = str(self.certainty)
        if self.verdict == "undecided":
            del rows["certainty"]
        one = self.one
        if self.verdict == "same":
            steps = ", ".join(str(g.rank) for g in one.growth) or "none"
            rows["independent invariants"] = f"{steps} (order by order)"
            fixed = f", of which {one.isotropy} leave a point fixed" if one.turns else ""
            rows["symmetries"] = f"{one.symmetries}{fixed}"
            assert self.match is not None
            rows["first point"] = _point_text(self.match.start)
            rows["second point"] = _point_text(self.match.goal)
        for which, text in zip(("first", "second"), self.assumptions, strict=True):
            if text:
                rows[f"{which} region"] = text
        if self.parameters:
            rows["at"] = ", ".join(f"{k} = {v}" for k, v in self.parameters.items())
        return rows

    def __repr__(self) -> str:
        return str(self)

    def __str__(self) -> str:
        (_, verdict), *rest = self.rows().items()
        return "\n".join([verdict, *(f"  {name}: {text}" for name, text in rest)])

    _repr_html_ = drawn_by("notebook_tables", "equivalence_html")


def _are_equal(first: Mapping[str, Element], second: Mapping[str, Element]) -> bool:
    """Whether constants are equal, as rational numbers."""
    pairs = [(x, second[name]) for name, x in first.items()]
    rational = all(x.is_rational and y.is_rational for x, y in pairs)
    return rational and all(x.as_fraction() == y.as_fraction() for x, y in pairs)


UNKNOWN = Certainty(proved=False, error=1.0)


def _point_text(point: Mapping[sp.Symbol, SupportsFloat]) -> str:
    """A point in one line, with six digits."""
    return ", ".join(f"{q} = {float(x):.6g}" for q, x in point.items())


def _length(invariants: Invariants) -> float:
    """How long the invariants without derivatives are."""
    return sum(x.length for t in invariants.start for x in t.components.independent.values())

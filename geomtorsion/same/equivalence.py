"""Equivalence: whether two frames, metrics or connections are one geometry in two disguises."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import islice, product
from typing import SupportsFloat

import numpy as np
import sympy as sp

from geomtorsion.errors import ArgumentError, CoordinateError, UndecidedError
from geomtorsion.exact import Certainty, Element, unknown_functions
from geomtorsion.exact.element import PROVED, least_certain
from geomtorsion.geometry import Connection, Frame
from geomtorsion.geometry.connections import FrameLike, frame_of
from geomtorsion.same.classification import signature
from geomtorsion.same.coordinate_map import CoordinateMap
from geomtorsion.same.invariants import Growth, Invariants
from geomtorsion.same.matching import DIGITS, Match, Search, identity
from geomtorsion.same.scalars import contradiction, is_excluded, scalars
from geomtorsion.same.signs import mirror_images, opposite_signs
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import content_hash, equal_content, only_fields
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive

KEEPS = ("metric", "teleparallel", "legs")
# Chance of error of a proof by resultants modulo a prime.
RESULTANTS = Certainty(proved=False, error=1e-60)
# Starts of the search for a point, and of that for a turn.
TRIES = 12
# Two geometries that differ agree to fewer digits than this, except by accident.
AGREES = 10.0 ** (8 - DIGITS)


@exclusive
def same_geometry(
    one: FrameLike | Connection,
    two: FrameLike | Connection,
    keep: str | None = None,
    *,
    orientation: bool = False,
) -> Equivalence:
    """Whether two frames, metrics or connections are one geometry in different coordinates.

    The components of torsion and curvature and of their covariant derivatives, along legs, are all
    the invariants there are. Exact ranks count the independent ones, order by order, until their
    number stays [Cartan1946], [Karlhede1980]. A point of the second geometry is then searched at
    which the invariants of a generic point of the first one recur; all of them are compared to 50
    digits, up to the order after the last growth.

    Parameters
    ----------
    one, two
        Frames, spaces or names of shipped ones; or two connections, which are compared together
        with the metric.
    keep
        "metric": metrics, whose legs are free. "teleparallel": frames whose legs may differ by one
        constant turn. "legs": frames, leg by leg in their order. None: "metric", or connections.
    orientation
        True: maps that exchange left and right do not count. Legs in their order are right-handed;
        where the legs are complex or come from a metric, coordinates in their order are.

    Returns
    -------
    Equivalence: "same" with the largest difference, "different" with its proof, or "undecided".
    It is local: it holds near generic points, and not for the shape in the large. Formulas count
    wherever they are regular, also beyond the stated domains.
    Parameters of one name are one constant, to which a random rational value is given.

    Raises
    ------
    ArgumentError
        The arguments are of other kinds, or contain unknown functions such as a(t).

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> u, v = sp.symbols("u v", real=True)
    >>> disguise = Frame.from_metric([u, v], [[4 / (1 + u**2 + v**2) ** 2, 0],
    ...                                       [0, 4 / (1 + u**2 + v**2) ** 2]])
    >>> sphere = Frame("theta phi", [[1, 0], [0, "sin(theta)"]], domain="0 < theta < pi")
    >>> same_geometry(disguise, sphere).verdict
    'same'
    """
    checks.flag(orientation, "orientation")
    are_connections = [isinstance(x, Connection) for x in (one, two)]
    if keep is None and any(are_connections):
        if not all(are_connections):
            raise ArgumentError(
                "expected two frames or two connections, got one of each. Give both as "
                "connections, such as gt.cartan(frame), or name the geometry: keep='metric'."
            )
        sides = [(x.frame, x) for x in (one, two) if isinstance(x, Connection)]
        return _compared("connection", sides, orientation)
    name = "metric" if keep is None else checks.choice(keep, KEEPS, "keep", ArgumentError)
    frames = [frame_of(x, which) for x, which in ((one, "one"), (two, "two"))]
    return _compared(name, [(frame, None) for frame in frames], orientation)


def _compared(
    keep: str, sides: Iterable[tuple[Frame, Connection | None]], orientation: bool
) -> Equivalence:
    """The verdict on two geometries."""
    (one, first), (two, second) = sides
    for frame in (one, two):
        refuse_functions(frame)
    assumptions = one.region.assumption, two.region.assumption
    values = parameter_values(one, two)
    if values:
        own = [{k: v for k, v in values.items() if k in map(str, f.parameters)} for f in (one, two)]
        one, two = (f.subs(v) if v else f for f, v in zip((one, two), own, strict=True))
        first, second = (
            c.subs(v) if c is not None and v else c
            for c, v in zip((first, second), own, strict=True)
        )
    invariants = Invariants(one, keep, first)
    equal = one == two and first == second
    other = invariants if equal else Invariants(two, keep, second)
    return Equivalence(invariants, other, orientation, values, assumptions)


def refuse_functions(frame: Frame) -> None:
    """Refuse a frame with unknown functions such as a(t)."""
    functions = unknown_functions(x for matrix in frame.given.values() for x in matrix.values())
    if functions:
        raise ArgumentError(
            f"expected a frame without unknown functions, got {functions[0]}. Give it a value, as "
            f"in frame.subs({{{functions[0]}: ...}})."
        )


def parameter_values(one: Frame, two: Frame) -> dict[str, sp.Rational]:
    """Generic rational values of all parameters, by name, that both regions allow."""
    if not (one.parameters or two.parameters):
        return {}
    sides = (islice(frame.region.points(), TRIES) for frame in (one, two))
    for first, second in product(*sides):
        values = {str(x): second[x] for x in two.parameters}
        values |= {str(x): first[x] for x in one.parameters}
        if _has_points(two, values):
            return values
    names = ", ".join(dict.fromkeys(map(str, (*two.parameters, *one.parameters))))
    raise ArgumentError(
        f"expected parameters that both domains allow, found no values for {names}. Give them "
        "values with frame.subs."
    )


def _has_points(frame: Frame, values: Mapping[str, sp.Rational]) -> bool:
    """Whether the region of a frame has points at values of its parameters."""
    own = {x: values[str(x)] for x in frame.parameters}
    try:
        return not own or bool(frame.subs(own).region.point)
    except CoordinateError:
        return False


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class Equivalence:
    """Verdict on two geometries, with its reason and certainty.

    one, two: their invariants.
    orientation: whether left and right are kept apart.
    parameters: values that were given to parameters, by name.
    assumptions: the regions that were assumed for frames without a declared domain, in words.
    near: coordinates of the second geometry from which the search for a point begins, if known.
    """

    one: Invariants
    two: Invariants
    orientation: bool = False
    parameters: Mapping[str, sp.Rational] = field(default_factory=dict)
    assumptions: tuple[str, str] = ("", "")
    near: np.ndarray | None = field(default=None, repr=False)

    def __eq__(self, other: object) -> bool:
        return equal_content(self, other)

    def __hash__(self) -> int:
        return content_hash(self)

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @property
    def verdict(self) -> str:
        """ "same", "different" or "undecided"."""
        return self._outcome.verdict

    @property
    def reason(self) -> str:
        """Why, in words."""
        return self._outcome.reason

    @property
    def certainty(self) -> Certainty:
        """How sure the verdict is.

        "different" is proved, up to the chance of error of ranks modulo a prime, or rests on signs
        that were read at some hundred points of both regions. "same" is proved
        where all invariants are constants that agree exactly; otherwise its error is the largest
        difference of invariants at the matched point, as two geometries that differ agree to so
        many digits only by accident.
        """
        return self._outcome.certainty

    @property
    def match(self) -> Match | None:
        """The two points at which the invariants agree; None if none were found."""
        return self._outcome.match

    @property
    def difference(self) -> float | None:
        """The largest relative difference of invariants at the matched points; None without."""
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
        """The dimension of the turns at a generic point that no invariant fixes, for both."""
        return self.one.isotropy, self.two.isotropy

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
    def _outcome(self) -> _Outcome:
        one, two = self.one, self.two
        if one is two:
            return _Outcome("same", "both are given by equal formulas", PROVED, identity(one))
        simple = self._simple_difference()
        if simple is not None:
            return _Outcome("different", simple, PROVED)
        sure = least_certain([one.certainty, two.certainty])
        for which, inv in (("first", one), ("second", two)):
            if inv.certainty.error >= 1:
                reason = f"whether invariants of the {which} geometry vanish cannot be decided"
                return _Outcome("undecided", reason, inv.certainty)
        if one.growth != two.growth:
            return _Outcome("different", self._ranks(), sure)
        first, second = scalars(one), scalars(two)
        proof = contradiction(one, two, first, second)
        if proof is not None:
            return _Outcome("different", *proof)
        opposite = opposite_signs(one, two, first, second)
        if opposite is not None:
            return _Outcome("different", *opposite)
        match = self._searched()
        if match is not None and match.difference < AGREES:
            exact = one.rank == 0 and one.keep in ("legs", "metric") and _are_equal(first, second)
            error = Certainty(proved=False, error=max(match.difference, 10.0**-DIGITS))
            certainty = sure if exact else least_certain([sure, error])
            return _Outcome("same", "all invariants agree", certainty, match)
        if is_excluded(one, two):
            reason = "no point of the second geometry has the invariants of a generic point"
            return _Outcome("different", reason + " of the first", RESULTANTS)
        if match is None and self.orientation:
            mirror = replace(self, orientation=False)
            if mirror.verdict == "same":
                proof = mirror_images(one, two)
                if proof is not None:
                    return _Outcome("different", *proof)
                reason = "the same after a reflection, and no map without one was found"
                return _Outcome("undecided", reason, UNKNOWN)
        return _Outcome("undecided", self._unmatched(match), UNKNOWN, match)

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
            if best is not None and best.difference < AGREES:
                break
        return best

    def _simple_difference(self) -> str | None:
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
        reflected = match is not None and match.reflects
        return {
            "legs": "frames, leg by leg",
            "teleparallel": f"frames up to one constant {'reflection' if reflected else 'turn'}",
            "metric": "metrics",
            "connection": "metrics with connections",
        }[self.one.keep]

    def rows(self) -> dict[str, str]:
        """The printed lines, by name."""
        rows = {"verdict": f"{self.verdict}: {self.reason}", "compared": self.compared}
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


@dataclass(frozen=True)
class _Outcome:
    """A verdict, its reason, its certainty, and the points at which it was found."""

    verdict: str
    reason: str
    certainty: Certainty
    match: Match | None = None


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

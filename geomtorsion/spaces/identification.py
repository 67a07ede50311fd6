"""Identify: the shipped space that a frame is, in other coordinates or with other legs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp

from geomtorsion.errors import ArgumentError
from geomtorsion.exact import unknown_functions
from geomtorsion.geometry import Frame
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.same import Classification, Equivalence
from geomtorsion.same.classification import signature
from geomtorsion.same.comparison import KEEPS
from geomtorsion.same.family import Query, Stratum, strata
from geomtorsion.same.invariants import refuse_functions
from geomtorsion.spaces.registry import CHARTS, names, shipped_space
from geomtorsion.support import checks
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.copies import ByContent


@dataclass(frozen=True, eq=False, repr=False)
class Identified(ByContent):
    """Shipped space that a frame describes.

    name, title, source: of the space.
    parameters: values of its parameters by name, with parameters of the frame; 0 is a limit of the
        space where its parameter is positive.
    equivalence: the comparison, with its certainty and the map of the coordinates.
    """

    name: str
    title: str
    source: str
    parameters: Mapping[str, sp.Expr]
    equivalence: Equivalence

    def __str__(self) -> str:
        values = ", ".join(f"{k} = {v}" for k, v in self.parameters.items())
        with_values = f" with {values}" if values else ""
        return f"{self.name}: {self.title}{with_values}"

    def __repr__(self) -> str:
        return str(self)


@dataclass(frozen=True, eq=False, repr=False)
class Identification(ByContent):
    """Result of `identify`: properties of a frame, and shipped spaces that are the same geometry.

    matches: the spaces that are the same geometry; the first one only, unless all were requested.
    undecided: names of spaces that may or may not be the same.
    special: names of spaces that may be the same for special values of their parameters only.
    classification: properties such as flat, of constant curvature, vacuum or a product.
    assumption: the region that was assumed, in words; empty where the domain was declared.
    negated: whether minus the metric was identified, as its signature has more minus signs.

    It is true where a space is found, and where the curvature is constant.
    """

    matches: tuple[Identified, ...]
    undecided: tuple[str, ...]
    special: tuple[str, ...]
    classification: Classification
    assumption: str = ""
    negated: bool = False

    def __bool__(self) -> bool:
        return bool(self.matches) or self.classification.curvature is not None

    def __str__(self) -> str:
        about = str(self.classification)
        if self.matches:
            lines = [*map(str, self.matches), f"  {about}"]
        elif self.classification.curvature is not None:
            lines = [about, "  none of the shipped spaces is a chart of it"]
        elif self.undecided:
            lines = [f"undecided: {', '.join(self.undecided)}", f"  {about}"]
        else:
            lines = ["none of the shipped spaces", f"  {about}"]
        if self.special and not self:
            lines.append(f"  special parameters are not excluded for {', '.join(self.special)}")
        if self.negated:
            lines.append("  for minus the metric, which has more plus signs")
        if self.assumption:
            lines.append(f"  {self.assumption}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return str(self)


def identify(frame: FrameLike, keep: str = "metric", *, every: bool = False) -> Identification:
    """Properties of a frame, and the shipped space that it describes, with its parameters.

    Dimension, signature, constant curvature, Ricci and Weyl tensor, torsion, the number of
    symmetries and the Petrov type are compared first. Where they agree, values of parameters are
    fitted at one point, read as rational numbers times powers of the parameters of the frame, and
    confirmed by all invariants to 50 digits, as in `same_geometry`.

    Parameters
    ----------
    frame
        A frame, a space or a name; without unknown functions.
    keep
        "metric", "teleparallel" or "legs", as in `same_geometry`.
    every
        True: all spaces that are the same; False: the first one.

    Returns
    -------
    Identification: matches, properties, and the region that was assumed for a frame without domain.
    A space that cannot be excluded is reported as undecided.

    Raises
    ------
    ArgumentError
        The frame contains unknown functions, or `keep` has another value.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> print(identify(Frame("u v", [["3/u", 0], [0, "3/u"]], domain="u > 0")))
    constant curvature -1/9, 3 symmetries
      none of the shipped spaces is a chart of it
    >>> print(identify(Frame("u v", [[3, 0], [0, "3*cos(u)"]], domain="0 < u < 1")))
    s2: the sphere of radius R, compass frame with R = 3
      constant curvature 1/9, 3 symmetries
    """
    frame = as_frame(frame)
    refuse_functions(frame)
    name = checks.choice(keep, KEEPS, "keep", ArgumentError)
    checks.flag(every, "every")
    minus, plus = signature(frame)
    negated = minus > plus
    frame = _negated(frame) if negated else frame
    query = Query.of(frame, name)
    matches, undecided, special = list[Identified](), list[str](), list[str]()
    general, limits, rest = _candidates(query.classification, name)
    for stage, names_ in ((general, undecided), (limits, undecided), (rest, special)):
        for charts, stratum in stage:
            check_limits()
            equal, is_open = _compared(query, charts, stratum, every)
            matches += equal
            names_ += [charts[0]] if is_open and charts[0] not in names_ else []
            if matches and not every:
                break
        if matches:
            break
    parts = tuple(matches), tuple(undecided), tuple(special)
    return Identification(*parts, query.classification, query.assumption, negated)


def _negated(frame: Frame) -> Frame:
    """The frame with minus its metric."""
    n = range(frame.dimension)
    domain, parameters = frame.domain, frame.parameters
    if frame.shape == "metric":
        rows = [[-frame.metric[i, j] for j in n] for i in n]
        return Frame.from_metric(frame.coordinates, rows, domain=domain, parameters=parameters)
    return Frame(
        frame.coordinates,
        [[frame.coframe[i, k] for k in n] for i in n],
        [[-frame.eta[i, j] for j in n] for i in n],
        domain=domain,
        parameters=parameters,
        complex=frame.complex,
    )


Candidate = tuple[tuple[str, ...], Stratum]


def _candidates(
    own: Classification, keep: str
) -> tuple[list[Candidate], list[Candidate], list[Candidate]]:
    """Families with the same properties, limits with them, and those with special members only."""
    general, limits, special = list[Candidate](), list[Candidate](), list[Candidate]()
    for charts in _groups(keep):
        frame = shipped_space(charts[0]).frame
        if frame.dimension != own.dimension or _has_functions(frame):
            continue
        whole = _whole(charts[0], keep)
        # In flat spaces only the legs depend on parameters.
        if whole.classification.is_flat and keep == "metric" and frame.parameters:
            continue
        if not own.excludes(whole.classification):
            general.append((charts, whole))
        if not frame.parameters or not own.may_be_special(whole.classification):
            continue
        for stratum in _strata(charts[0], keep):
            other = stratum.classification
            # A space of constant curvature is named by its properties.
            if stratum.zeros and other.curvature is not None:
                continue
            if stratum.zeros and not own.excludes(other):
                limits.append((charts, stratum))
            elif own.may_be_special(other):
                special.append((charts, stratum))
    return general, limits, special


def _groups(keep: str) -> list[tuple[str, ...]]:
    """Names of the shipped spaces; charts of one metric together, the first to be fitted."""
    if keep != "metric":
        return [(name,) for name in names()]
    group = {name: charts for charts in CHARTS for name in charts}
    return list(dict.fromkeys(group.get(name, (name,)) for name in names()))


def _has_functions(frame: Frame) -> bool:
    return bool(unknown_functions(x for matrix in frame.given.values() for x in matrix.values()))


@cache
def _whole(name: str, keep: str) -> Stratum:
    """A shipped space for general values of its parameters."""
    frame = shipped_space(name).frame
    return Stratum(frame, (), frame, keep)


@cache
def _strata(name: str, keep: str) -> tuple[Stratum, ...]:
    """The general members of a shipped space, and its limits."""
    return _whole(name, keep), *strata(shipped_space(name).frame, keep)[1:]


def _compared(
    query: Query, charts: tuple[str, ...], stratum: Stratum, every: bool
) -> tuple[list[Identified], bool]:
    """The first or every chart that is the same, and whether none is found or excluded."""
    if query.excluded(stratum) is not None:
        return [], False
    for number, (place, values, _) in enumerate(query.candidates(stratum)):
        if values or not stratum.family.parameters:
            same, is_open = _equal_charts(query, charts, values, every, place)
            if same or not stratum.family.parameters:
                return same, is_open
        # Most geometries that are the same fit at once; a proof that none does saves other starts.
        if number == 0 and query.proof(stratum) is not None:
            return [], False
    return [], True


def _equal_charts(
    query: Query,
    charts: tuple[str, ...],
    values: Mapping[str, sp.Expr],
    every: bool,
    place: np.ndarray | None,
) -> tuple[list[Identified], bool]:
    """The first or every chart that is the same geometry at values of its parameters."""
    same, is_open = [], False
    for name in sorted(charts, key=names().index):
        space = shipped_space(name)
        near = place if name == charts[0] else None
        equivalence = query.equivalence(space.frame, values, near)
        if equivalence is None:
            continue
        is_open = is_open or equivalence.verdict == "undecided"
        if equivalence.verdict == "same":
            same.append(Identified(name, space.title, space.source, values, equivalence))
            if not every:
                break
    return same, is_open and not same

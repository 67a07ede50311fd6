"""Identify: the shipped space that a frame is, in other coordinates or with other legs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice, product
from math import prod

import sympy as sp

from geomtorsion.errors import ArgumentError, GeomtorsionError
from geomtorsion.exact import unknown_functions
from geomtorsion.geometry import Frame
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.same import Equivalence, Invariants, same_geometry
from geomtorsion.same.equivalence import KEEPS, TRIES, parameter_values, refuse_functions, signature
from geomtorsion.same.matching import parameters_near
from geomtorsion.spaces.registry import names, shipped_space
from geomtorsion.support import checks
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.copies import content_hash, equal_content, only_fields

# Parameters are looked for as a rational number times powers of the parameters of the frame.
POWERS = (Fraction(0), Fraction(1), Fraction(-1), Fraction(2), Fraction(-2), Fraction(1, 2))
# The largest denominator of that rational number; it must be met far more exactly than by chance.
LARGEST = 1000
CLOSE = 0.1 / LARGEST**2


@dataclass(frozen=True, eq=False, repr=False)
class Identified:
    """A shipped space that a frame is.

    name, title, source: of the space.
    parameters: values of its parameters by name, with parameters of the frame.
    equivalence: the comparison, with its certainty and the map of the coordinates.
    """

    name: str
    title: str
    source: str
    parameters: Mapping[str, sp.Expr]
    equivalence: Equivalence

    def __eq__(self, other: object) -> bool:
        return equal_content(self, other)

    def __hash__(self) -> int:
        return content_hash(self)

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    def __str__(self) -> str:
        values = ", ".join(f"{k} = {v}" for k, v in self.parameters.items())
        with_values = f" with {values}" if values else ""
        return f"{self.name}: {self.title}{with_values}"

    def __repr__(self) -> str:
        return str(self)


@dataclass(frozen=True, eq=False, repr=False)
class Identification:
    """The shipped spaces that a frame is.

    matches: the spaces that are the same geometry; the first one only, unless all were requested.
    undecided: names of spaces that may or may not be the same.
    """

    matches: tuple[Identified, ...]
    undecided: tuple[str, ...]

    def __eq__(self, other: object) -> bool:
        return equal_content(self, other)

    def __hash__(self) -> int:
        return content_hash(self)

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    def __bool__(self) -> bool:
        return bool(self.matches)

    def __str__(self) -> str:
        lines = [str(match) for match in self.matches] or ["none of the shipped spaces"]
        if self.undecided and not self.matches:
            lines.append(f"undecided: {', '.join(self.undecided)}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return str(self)


def identify(frame: FrameLike, keep: str = "metric", *, every: bool = False) -> Identification:
    """The shipped space that a frame is, with the values of its parameters.

    The frame is compared with all shipped spaces of its dimension and signature that contain no
    unknown function. Values of parameters are found as floats, read as rational numbers times
    powers of the parameters of the frame, and confirmed by `same_geometry`.

    Parameters
    ----------
    frame
        A frame, a space or a name; without unknown functions.
    keep
        "metric", "teleparallel" or "legs", as in `same_geometry`.
    every
        True: all spaces that are the same; False: the first one.

    Raises
    ------
    ArgumentError
        The frame contains unknown functions, or `keep` has another value.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> print(identify(Frame("u v", [["3/u", 0], [0, "3/u"]], domain="u > 0")))
    none of the shipped spaces
    >>> print(identify(Frame("u v", [[3, 0], [0, "3*cos(u)"]], domain="0 < u < 1")))
    s2: the sphere of radius R, compass frame with R = 3
    """
    frame = as_frame(frame)
    refuse_functions(frame)
    name = checks.choice(keep, KEEPS, "keep", ArgumentError)
    checks.flag(every, "every")
    matches, undecided = list[Identified](), list[str]()
    for space_name in names():
        check_limits()
        space = shipped_space(space_name)
        if _is_excluded(frame, space.frame):
            continue
        match = _compared(frame, space.frame, name)
        if match is None:
            continue
        values, equivalence = match
        if equivalence.verdict == "undecided":
            undecided.append(space_name)
        elif equivalence.verdict == "same":
            texts = space_name, space.title, space.source
            matches.append(Identified(*texts, values, equivalence))
            if not every:
                break
    return Identification(tuple(matches), tuple(undecided))


def _is_excluded(frame: Frame, other: Frame) -> bool:
    """Whether a space has another dimension or signature, or unknown functions."""
    if frame.dimension != other.dimension:
        return True
    if unknown_functions(x for matrix in other.given.values() for x in matrix.values()):
        return True
    return signature(frame) != signature(other)


def _compared(
    frame: Frame, other: Frame, keep: str
) -> tuple[Mapping[str, sp.Expr], Equivalence] | None:
    """The comparison with a space, at the values of its parameters that fit; None if none do."""
    if not other.parameters:
        return {}, same_geometry(frame, other, keep)
    own = {str(k): v for k, v in parameter_values(frame, frame).items()}
    one = Invariants(frame.subs(own) if own else frame, keep)
    generic = other.subs(parameter_values(other, other))
    if one.growth != Invariants(generic, keep).growth:
        return None
    for values in _fitting(one, other, keep, own):
        try:
            chosen = other.subs(values)
            result = same_geometry(frame, chosen, keep)
        except GeomtorsionError:
            # Values that the domain of the space does not allow.
            continue
        if result.verdict == "same":
            return {str(k): v for k, v in values.items()}, result
    return None


def _fitting(
    one: Invariants, other: Frame, keep: str, own: Mapping[str, sp.Rational]
) -> Iterator[dict[str, sp.Expr]]:
    """Values of parameters at which the invariants of a point recur."""
    two = Invariants(other, keep)
    tried = set[tuple[sp.Expr, ...]]()
    for values in parameters_near(one, two, TRIES // 2):
        options = [list(islice(_expressions(x, own), 4)) for x in values]
        for chosen in product(*options):
            if chosen not in tried:
                tried.add(chosen)
                yield dict(zip(map(str, other.parameters), chosen, strict=True))


def _expressions(value: float, own: Mapping[str, sp.Rational]) -> Iterator[sp.Expr]:
    """A float as a simple number times powers of parameters, the simplest first."""
    simple = []
    for powers in product(POWERS, repeat=len(own)):
        factors = zip(own.values(), powers, strict=True)
        size = prod(float(v) ** float(p) for v, p in factors)
        for root in (1, 2):
            ratio = Fraction((value / size) ** root).limit_denominator(LARGEST)
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

"""Rounding: steps for bounds of the errors that rounding leaves in outputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from geomtorsion.codegen.printers import FUNCTIONS
from geomtorsion.codegen.steps import Signed, Step
from geomtorsion.codegen.transformations import Forward
from geomtorsion.errors import ExpressionError


@dataclass(frozen=True)
class Bounds:
    """Steps for values and for bounds of their errors, in units of one rounding.

    relative: of each output, where it is the same at all points; None where it is not.
    absolute: sign and place of the bound of each other output.
    """

    steps: tuple[Step, ...]
    values: tuple[Signed, ...]
    relative: tuple[int | None, ...]
    absolute: tuple[Signed, ...]


def rounding_bounds(
    steps: Sequence[Step], outputs: Sequence[Signed], *, is_complex: bool = False
) -> Bounds:
    """A running error analysis: each step's bound from those of its operands, to first order.

    Arguments count as exact. A product of exact numbers is right to one rounding wherever it is
    evaluated, and so is a sum of terms of one sign; only where terms may cancel does the bound
    depend on the point. [Higham, Accuracy and Stability of Numerical Algorithms, 3.3]
    """
    work = _Analysis(steps)
    for place, step in enumerate(steps):
        work.signs.append(0 if is_complex else work.sign(step))
        work.errors.append(work.error(place, step))
    found = [work.errors[place] for _, place in outputs]
    relative = tuple(None if error.moving else error.roundings for error in found)
    moving = [place for (_, place), r in zip(outputs, relative, strict=True) if r is None]
    places = [(1, work.absolute(place)) for place in moving]
    kept, moved = work.forward.builder.needed([*outputs, *places])
    return Bounds(kept, moved[: len(outputs)], relative, moved[len(outputs) :])


@dataclass(frozen=True)
class _Error:
    """An error of at most so many roundings of the value, and what else there is (a step)."""

    roundings: int
    rest: int | None = None

    @property
    def moving(self) -> bool:
        """Whether it depends on the point by more than the value."""
        return self.rest is not None


class _Analysis:
    """Steps with bounds; places of the first steps are those of the old ones."""

    def __init__(self, steps: Sequence[Step]) -> None:
        self.forward = Forward(steps, ())
        self.builder = self.forward.builder
        self.steps = steps
        self.errors: list[_Error] = []
        self.signs: list[int] = []

    # -- signs that do not depend on the point ----------------------------------------------------

    def sign(self, step: Step) -> int:
        """1 or -1 where a step has this sign (or vanishes) wherever it is real; 0 if unknown."""
        inner = [self.signs[place] for place in step.operands]
        if step.kind == "number":
            return 1 if step.detail >= 0 else -1
        if step.kind == "sum":
            signs = {s * t for s, t in zip(step.signs, inner, strict=True)}
            return signs.pop() if len(signs) == 1 else 0
        if step.kind in ("product", "quotient"):
            return inner[0] * inner[1]
        if step.kind in ("square", "digits"):
            return 1
        if step.kind == "root":
            return 1 if step.detail % 2 == 0 else inner[0]
        return 1 if step.kind == "call" and step.detail in ("exp", "cosh", "Abs") else 0

    # -- bounds ----------------------------------------------------------------------------------

    def absolute(self, place: int) -> int:
        """The bound of the error of a step, as a step."""
        error = self.errors[place]
        parts = [] if error.rest is None else [error.rest]
        if error.roundings:
            parts.append(self._times(error.roundings, self._size(place)))
        return self._total(parts)

    def error(self, place: int, step: Step) -> _Error:
        """The bound of a step."""
        kind, operands = step.kind, step.operands
        if kind in ("argument", "imaginary"):
            return _Error(0)
        if kind == "number":
            return _Error(0 if _is_float(step.detail) else 1)
        if kind == "digits":
            return _Error(1)
        if kind == "sum":
            return self._of_sum(step)
        inner = [self.errors[operand] for operand in operands]
        if kind in ("product", "quotient", "square"):
            if kind == "square":
                inner, operands = inner * 2, operands * 2
            exact = any(self._is_power_of_two(operand) for operand in operands)
            roundings = sum(error.roundings for error in inner) + (0 if exact else 1)
            parts = []
            for error, other, own in zip(inner, reversed(operands), operands, strict=True):
                if error.rest is None:
                    continue
                if kind != "quotient":
                    parts.append(self.builder.product(error.rest, self._size(other)))
                elif own == operands[0]:
                    parts.append(self.builder.quotient(error.rest, self._size(operands[1])))
                if kind == "quotient" and own == operands[1]:
                    part = self.builder.quotient(error.rest, self._size(own))
                    parts.append(self.builder.product(part, self._size(place)))
            return _Error(roundings, self._total(parts) if parts else None)
        if kind == "root":
            (error,) = inner
            roundings = -(-error.roundings // step.detail) + (
                1 if step.detail == 2 else _roundings_of("power")
            )
            if error.rest is None:
                return _Error(roundings)
            part = self.builder.quotient(error.rest, self._size(operands[0]))
            return _Error(roundings, self.builder.product(part, self._size(place)))
        return self._of_call(place, step, inner)

    def _of_sum(self, step: Step) -> _Error:
        inner = [self.errors[place] for place in step.operands]
        signs = {s * self.signs[place] for s, place in zip(step.signs, step.operands, strict=True)}
        adding = len(inner) - 1
        parts = [error.rest for error in inner if error.rest is not None]
        if len(signs) == 1 and 0 not in signs:
            most = max(error.roundings for error in inner) + adding
            return _Error(most, self._total(parts) if parts else None)
        # The last addition rounds the sum itself, those before it what may be larger.
        before = adding - 1
        for error, place in zip(inner, step.operands, strict=True):
            if error.roundings + before:
                parts.append(self._times(error.roundings + before, self._size(place)))
        return _Error(1, self._total(parts) if parts else None)

    def _of_call(self, place: int, step: Step, inner: Sequence[_Error]) -> _Error:
        name = step.detail
        if name in ("sign", "floor", "ceiling"):
            return _Error(0)
        if name in ("Max", "Min"):
            parts = [self.absolute(p) for p in step.operands if self.errors[p] != _Error(0)]
            return _Error(0, self._total(parts) if parts else None)
        parts = []
        try:
            slopes = self.forward.partials(place, step)
        except ExpressionError:
            # Its derivative is not known: it passes relative errors on as they come.
            slopes = {}
        for k, operand in enumerate(step.operands):
            if self.errors[operand] != _Error(0) and k in slopes:
                slope = self._size(slopes[k][1])
                parts.append(self.builder.product(slope, self.absolute(operand)))
        most = max(error.roundings for error in inner) if not slopes else 0
        return _Error(most + _roundings_of(name), self._total(parts) if parts else None)

    # -- writing ---------------------------------------------------------------------------------

    def _size(self, place: int) -> int:
        """The absolute value of a step."""
        step = self.builder.steps[place]
        if step.kind == "number":
            return self.builder.number(abs(step.detail))
        if place < len(self.signs) and self.signs[place] > 0:
            return place
        return self.builder.add("call", (place,), "Abs")

    def _times(self, factor: int, place: int) -> int:
        return place if factor == 1 else self.builder.product(self._number(factor), place)

    def _total(self, places: Sequence[int]) -> int:
        return (
            self.builder.total([(1, place) for place in places])[1] if places else self._number(0)
        )

    def _number(self, value: int) -> int:
        return self.builder.number(Fraction(value))

    def _is_power_of_two(self, place: int) -> bool:
        step = self.steps[place]
        if step.kind != "number" or not step.detail:
            return False
        above, below = abs(step.detail.numerator), step.detail.denominator
        return above & (above - 1) == 0 == below & (below - 1)


def _roundings_of(name: str) -> int:
    """To how many roundings a function is right."""
    return FUNCTIONS.get(name, FUNCTIONS["exp"]).roundings


def _is_float(value: Fraction) -> bool:
    """Whether a float holds a number without rounding."""
    below = value.denominator
    return below & (below - 1) == 0 and abs(value.numerator) < 2**53

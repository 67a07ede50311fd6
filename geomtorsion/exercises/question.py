"""Question: what is asked, how it is answered, and which mistakes are likely."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from geomtorsion.exercises.compare import Index, Value
from geomtorsion.exercises.ground import Ground
from geomtorsion.geometry import Tensor

KINDS = ("expression", "components", "equations", "number", "choice")


@dataclass(frozen=True)
class Mistake:
    """A wrong answer that is recognised.

    code: one of `diagnoses.TITLES`. value: the wrong answer, in any form `normal` understands.
    message: what to say about it, where the exercise knows better than the code.
    """

    code: str
    value: Any
    message: str = ""


def _none() -> Iterable[Mistake]:
    return ()


@dataclass(frozen=True, eq=False)
class Question:
    """One thing that is asked.

    name: key of the answer. kind: one of KINDS. prompt: Markdown with LaTeX.
    ground: symbols that may be used, with their domain.
    answer: computes the right answer with the library, when it is first needed.
    errors: computes the wrong answers that this exercise expects.
    shape: numbers of components, as (3, 3, 3); () for a single one.
    label: what one component is called in messages, such as "Gamma".
    symmetry: "antisymmetric" or "symmetric" in the first two indices: half may be given.
    unknowns: of equations: what stands before the sign of equality, such as "Omega1'".
    unit, tolerance: of numbers; the tolerance is relative to the largest component.
    options: of choices: key -> text.
    generic: mistakes looked for without being named by the exercise.
    points: what a right answer is worth.
    """

    name: str
    kind: str
    prompt: str
    answer: Callable[[], Any]
    ground: Ground = field(default_factory=Ground)
    errors: Callable[[], Iterable[Mistake]] = _none
    shape: tuple[int, ...] = ()
    label: str = ""
    symmetry: str = ""
    unknowns: tuple[str, ...] = ()
    unit: str = ""
    tolerance: float = 1e-3
    options: Mapping[str, str] = field(default_factory=dict)
    generic: tuple[str, ...] = ("sign", "factor", "permuted", "counted")
    points: int = 1

    @cached_property
    def solution(self) -> Value:
        """The right answer as index -> expression or number; what is missing is zero."""
        return normal(self.answer())

    @cached_property
    def mistakes(self) -> tuple[Mistake, ...]:
        """Wrong answers that are recognised, in the order in which they are tried."""
        from geomtorsion.exercises.mistakes import all_mistakes

        return all_mistakes(self)


def normal(value: Any) -> Value:
    """Index -> component, from a tensor, a mapping, nested lists, or a single expression.

    Examples
    --------
    >>> normal([0, 5]), normal([[1, 0], [0, 2]]), normal(3)
    ({(1,): 5}, {(0, 0): 1, (1, 1): 2}, {(): 3})
    """
    if isinstance(value, Tensor):
        return dict(value.nonzero())
    if isinstance(value, Mapping):
        pairs = {key if isinstance(key, tuple) else (key,): x for key, x in value.items()}
        return {key: x for key, x in pairs.items() if not _is_zero(x)}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Sequence) and not isinstance(value, str):
        found: dict[Index, Any] = {}
        for k, entry in enumerate(value):
            found |= {(k, *key): x for key, x in normal(entry).items()}
        return found
    return {} if _is_zero(value) else {(): value}


def _is_zero(value: Any) -> bool:
    return not isinstance(value, str) and value == 0

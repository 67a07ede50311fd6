"""Branches: equations with a product of unknowns, solved factor by factor."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

from geomtorsion.errors import GravityError, LimitError
from geomtorsion.gravity.elimination import (
    ContradictionError,
    Eliminated,
    Elimination,
    Residual,
)
from geomtorsion.support import checks


def eliminated(make: Callable[[], Elimination], pool: Sequence[Residual]) -> Eliminated:
    """Rules and constraints of residuals, in the first branch that has a solution.

    Elimination divides by factors that may vanish. If the residuals then contradict each other,
    a factor with an unknown function of a connection is one more residual, the shortest first.
    A solution with more residuals is a solution.

    make: a new elimination for each branch.

    Raises
    ------
    GravityError
        No branch has a solution, or no elimination ends.
    LimitError
        The elimination without further residuals is too large.
    """
    queue, seen = deque[tuple[Residual, ...]]([()]), {frozenset[str]()}
    first, tried, undecided, special = None, set[str](), set[str](), set[str]()
    while queue:
        branch = queue.popleft()
        elimination = make()
        try:
            return elimination.run([*pool, *branch])
        except ContradictionError as contradiction:
            first = first or contradiction
            tried |= {str(one.element) for one in branch}
        except (GravityError, LimitError, RecursionError):
            if not branch:
                raise
            undecided |= {str(one.element) for one in branch}
            continue
        special |= elimination.special
        for factor in sorted(elimination.factors, key=lambda x: (x.length, str(x))):
            own = frozenset(place.function for place in elimination.jets.places(factor))
            longer = (*branch, Residual(factor, own))
            names = frozenset(str(one.element) for one in longer)
            if names not in seen:
                seen.add(names)
                queue.append(longer)
    raise GravityError(f"{first}{_words(tried, undecided, special)}") from None


def _words(tried: set[str], undecided: set[str], special: set[str]) -> str:
    """The branches of a refusal, as sentences."""
    sentences = (
        ("There is no solution either where {} vanishes.", tried - undecided),
        ("The case is undecided where {} vanishes: give this as a condition.", undecided),
        ("Special solutions where {} vanishes were not sought.", special),
    )
    lists = (
        (text, " or ".join(checks.cut(one) for one in sorted(names, key=lambda x: (len(x), x))))
        for text, names in sentences
        if names
    )
    return "".join(" " + text.format(names) for text, names in lists)

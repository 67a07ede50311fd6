"""Branches: equations with a product of unknowns, solved factor by factor."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from geomtorsion.errors import GeomtorsionError, GravityError
from geomtorsion.gravity.reduced.elimination import (
    ContradictionError,
    Eliminated,
    Elimination,
    Residual,
)
from geomtorsion.support import checks


@dataclass(frozen=True, eq=False)
class Branch:
    """Rules and constraints of residuals, where some factors also vanish.

    eliminated: the rules and constraints. factors: residuals that were added, none in the first
        branch of most equations.
    """

    eliminated: Eliminated
    factors: tuple[Residual, ...]


@dataclass(frozen=True, eq=False)
class Search:
    """The branches of residuals.

    Elimination divides by factors that may vanish. If the residuals then contradict each other,
    or if further branches are requested, a factor is one more residual: those with an unknown
    function of a connection first, the shortest first. A solution with more residuals is a
    solution.

    make: a new elimination for each branch. pool: the residuals.
    """

    make: Callable[[], Elimination]
    pool: tuple[Residual, ...]

    def first(self) -> Branch:
        """The first branch that has a solution.

        Raises
        ------
        GravityError
            No branch has a solution, or no elimination ends.
        LimitError
            The elimination without further residuals is too large.
        """
        undecided = set[str]()
        for branch, _ in self._walk(undecided):
            return branch
        raise AssertionError("the search ends with a branch or with a refusal")

    def all(self) -> tuple[tuple[Branch, ...], frozenset[str]]:
        """All branches that no earlier one contains, and factors whose case is undecided."""
        undecided, branches = set[str](), list[Branch]()
        for branch, elimination in self._walk(undecided):
            if not any(elimination.contains(one.eliminated) for one in branches):
                branches.append(branch)
        return tuple(branches), frozenset(undecided)

    def _walk(self, undecided: set[str]) -> Iterator[tuple[Branch, Elimination]]:
        """Branches in order; names of factors are added to those whose case is undecided."""
        queues = deque[tuple[Residual, ...]]([()]), deque[tuple[Residual, ...]]()
        seen, tried, leading = {frozenset[str]()}, set[str](), set[str]()
        refusal, has_solution = None, False
        while any(queues):
            branch = (queues[0] or queues[1]).popleft()
            elimination = self.make()
            try:
                result = elimination.run(self.pool, branch)
            except ContradictionError as contradiction:
                refusal = refusal or contradiction
                tried |= {str(one.element) for one in branch}
            except (GeomtorsionError, RecursionError):
                if not branch:
                    raise
                undecided |= {str(one.element) for one in branch}
                continue
            else:
                has_solution = True
                yield Branch(result, branch), elimination
            leading |= elimination.leading
            for queue, factors in zip(queues, elimination.factors, strict=True):
                for factor in sorted(factors, key=lambda x: (x.length, str(x))):
                    own = frozenset(place.function for place in elimination.jets.places(factor))
                    longer = (*branch, Residual(factor, own))
                    names = frozenset(str(one.element) for one in longer)
                    if names not in seen:
                        seen.add(names)
                        queue.append(longer)
        if not has_solution:
            raise GravityError(
                f"{refusal}{_words(tried, undecided, leading - tried - undecided)}"
            ) from None


def _words(tried: set[str], undecided: set[str], leading: set[str]) -> str:
    """The branches of a refusal, as sentences."""
    sentences = (
        ("There is no solution either where {} vanishes.", tried - undecided),
        ("The case is undecided where {} vanishes: give this as a condition.", undecided),
        ("Special solutions where {} vanishes were not sought.", leading),
    )
    lists = (
        (text, " or ".join(checks.cut(one) for one in sorted(names, key=lambda x: (len(x), x))))
        for text, names in sentences
        if names
    )
    return "".join(" " + text.format(names) for text, names in lists)

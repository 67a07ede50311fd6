"""Chosen: the cases that stay in the normal run, spread evenly over all cases."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import pytest


def one_in(count: int, *choices: Sequence[Any]) -> list[Any]:
    """All combinations; those whose positions do not add up to a multiple of `count` are slow.

    With three choices each pair of two choices stays, if the third choice has at least `count`
    entries; with two choices each single entry stays.
    """
    return [
        _case(
            [choice[k] for choice, k in zip(choices, places, strict=True)],
            slow=sum(places) % count > 0,
        )
        for places in product(*(range(len(choice)) for choice in choices))
    ]


def few(count: int, cases: Sequence[Any]) -> list[Any]:
    """All cases; but for `count` of them, from the first to the last, they are slow.

    A case of several arguments is a tuple; of one case in the normal run, it is the first.
    """
    last = len(cases) - 1
    kept = {round(k * last / max(count - 1, 1)) for k in range(count)}
    return [
        _case(case if isinstance(case, tuple) else (case,), slow=k not in kept)
        for k, case in enumerate(cases)
    ]


def _case(arguments: Sequence[Any], slow: bool) -> Any:
    """The arguments of one case."""
    return pytest.param(*arguments, marks=[pytest.mark.slow] if slow else [])

"""Chosen: the combinations that stay in the normal run, spread evenly over all combinations."""

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
        pytest.param(
            *(choice[k] for choice, k in zip(choices, places, strict=True)),
            marks=[pytest.mark.slow] if sum(places) % count else [],
        )
        for places in product(*(range(len(choice)) for choice in choices))
    ]

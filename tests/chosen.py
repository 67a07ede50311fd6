"""Chosen: which of all combinations stay in the normal run, spread over all of them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import pytest


def one_in(count: int, *choices: Sequence[Any]) -> list[Any]:
    """All combinations; those whose places do not add up to a multiple of a count are slow.

    Of three choices every pair of two stays, where the third has so many; of two every single one.
    """
    return [
        pytest.param(
            *(choice[k] for choice, k in zip(choices, places, strict=True)),
            marks=[pytest.mark.slow] if sum(places) % count else [],
        )
        for places in product(*(range(len(choice)) for choice in choices))
    ]

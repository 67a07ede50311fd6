"""Settings of the whole suite: random tests repeat themselves, nothing stays set; one browser."""

import decimal
import warnings
from collections.abc import Iterator
from typing import Any

import flint
import mpmath
import numpy as np
import pytest
from hypothesis import settings

from tests.browser import address, browser, context, lab, watched

__all__ = ["address", "browser", "context", "lab", "watched"]

settings.register_profile("geomtorsion", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("geomtorsion")


def global_settings() -> dict[str, Any]:
    """What libraries keep for the whole process, and what users would notice if it changed."""
    context = decimal.getcontext()
    # Packages filter warnings of their own classes when they are imported, which is no change.
    filters = [one for one in warnings.filters if one[2].__module__ == "builtins"]
    return {
        "mpmath precision": mpmath.mp.prec,
        "mpmath intervals": mpmath.iv.prec,
        "flint precision": flint.ctx.prec,
        "numpy errors": np.geterr(),
        "numpy printing": np.get_printoptions(),
        "warnings": filters,
        "decimal": (context.prec, context.rounding, dict(context.traps)),
    }


@pytest.fixture(autouse=True)
def nothing_stays_set() -> Iterator[None]:
    """Global settings of other libraries are the same after every test."""
    before = global_settings()
    yield
    after = global_settings()
    changed = {name: (before[name], after[name]) for name in before if before[name] != after[name]}
    assert not changed, f"this test leaves global settings changed: {changed}"

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
from tests.exercises.processes import one_pool

__all__ = ["address", "browser", "context", "lab", "one_pool", "watched"]

settings.register_profile("geomtorsion", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("geomtorsion")


def global_settings() -> dict[str, Any]:
    """What libraries keep for the whole process, and what users would notice if it changed."""
    exact = decimal.getcontext()
    # On import packages filter single messages and classes of their own, which misleads nobody.
    filters = [x for x in warnings.filters if x[1] is None and x[2].__module__ == "builtins"]
    return {
        "mpmath precision": mpmath.mp.prec,
        "mpmath intervals": mpmath.iv.prec,
        "flint precision": flint.ctx.prec,
        "numpy errors": np.geterr(),
        "numpy printing": np.get_printoptions(),
        "warnings": filters,
        "decimal": (exact.prec, exact.rounding, dict(exact.traps)),
    }


@pytest.fixture(autouse=True)
def nothing_stays_set() -> Iterator[None]:
    """Global settings of other libraries are the same after every test."""
    before = global_settings()
    yield
    after = global_settings()
    changed = {name: (before[name], after[name]) for name in before if before[name] != after[name]}
    assert not changed, f"this test leaves global settings changed: {changed}"

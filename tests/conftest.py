"""Settings of the whole suite: random tests repeat themselves, nothing stays set; one browser."""

import decimal
import gc
import warnings
from collections.abc import Iterator
from typing import Any

import flint
import mpmath
import numpy as np
import pytest
from hypothesis import settings

from tests.browser import (
    address,
    browser,
    context,
    lab,
    playwright,
    standing,
    standing_pages,
    watched,
)
from tests.teaching.exercises.processes import one_pool

__all__ = [
    "address", "browser", "context", "lab", "one_pool", "playwright", "standing",
    "standing_pages", "watched",
]  # fmt: skip

settings.register_profile("geomtorsion", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("geomtorsion")


# What takes longest, or waits for a browser: nothing of it is to be left for one worker at the end.
LONG = ("tests/teaching/lab/", "tests/test_types.py", "tests/hard/")


def pytest_addoption(parser: pytest.Parser) -> None:
    """--prove: results of the hard cases are proved as well, which takes some minutes."""
    parser.addoption("--prove", action="store_true", help="prove the results of tests/hard")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes long."""
    items.sort(key=lambda item: not item.nodeid.startswith(LONG))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> object:
    """Folders in the order in which tests stand, not those of most tests first."""
    # The Python of browsers, where parts of the suite run, has no workers.
    from tests.by_folder import ByFolder

    config.option.loadscopereorder = False
    return ByFolder(config, log)


def pytest_collection(session: pytest.Session) -> None:
    """Do not look for rubbish among what is collected: all of it is kept."""
    gc.disable()


def pytest_collection_finish(session: pytest.Session) -> None:
    """Look for rubbish of tests only, and seldom: looking through all tests again takes a second
    each time, and as often as by itself a tenth of the whole run."""
    gc.enable()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


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

"""Settings of the suite: repeatable random tests, unchanged global settings, one shared browser."""

import decimal
import gc
import warnings
from collections.abc import Iterator
from importlib import import_module
from itertools import filterfalse
from typing import Any
from zlib import crc32

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
    shared_lab,
    shared_pages,
    watched,
)
from tests.teaching.exercises.processes import one_pool

__all__ = [
    "address", "browser", "context", "lab", "one_pool", "playwright", "shared_lab",
    "shared_pages", "watched",
]  # fmt: skip

settings.register_profile("geomtorsion", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("geomtorsion")


# Tests that take longest or wait for a browser: they start first, so that none is left for one
# worker at the end.
LONG = ("tests/teaching/lab/", "tests/test_types.py", "tests/hard/")


@pytest.fixture
def blocks(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """One entry for each block of steps, of 2000 steps or fewer."""
    blocks: list[int] = []
    for name in ("taylor", "stepper", "stepwise"):
        module = import_module(f"geomtorsion.ode.engines.{name}")
        monkeypatch.setattr(module, "check_limits", lambda: blocks.append(1))
    return blocks


def pytest_addoption(parser: pytest.Parser) -> None:
    """--prove: prove the results of the hard cases as well, which takes some minutes.

    --part: run one part of the tests, drawn by their names, so that N runs have run each of them.
    """
    parser.addoption("--prove", action="store_true", help="prove the results of tests/hard")
    parser.addoption("--part", type=part_of, default=(0, 1), metavar="K/N", help="K from 0 to N-1")


def part_of(text: str) -> tuple[int, int]:
    """The numbers of "3/20", part 3 of the parts 0 to 19."""
    part, count = map(int, text.split("/"))
    if not 0 <= part < count:
        raise ValueError(f"expected a part from 0 to {count - 1}, got {part}")
    return part, count


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Run the long tests first, and none of other parts."""
    part, count = config.option.part

    def drawn(item: pytest.Item) -> bool:
        return crc32(item.nodeid.encode()) % count == part

    config.hook.pytest_deselected(items=list(filterfalse(drawn, items)))
    items[:] = sorted(filter(drawn, items), key=lambda item: not item.nodeid.startswith(LONG))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> object:
    """Run the folders in the order of their tests, not the folder with most tests first."""
    # The Python in a browser, which runs parts of the suite, has no workers.
    from tests.by_folder import ByFolder

    config.option.loadscopereorder = False
    return ByFolder(config, log)


def pytest_collection(session: pytest.Session) -> None:
    """Collect no garbage while tests are collected: every object is kept."""
    gc.disable()


def pytest_collection_finish(session: pytest.Session) -> None:
    """Collect garbage of tests only, and seldom: each pass over all collected tests takes a second,
    and at the default frequency a tenth of the whole run."""
    gc.enable()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


def global_settings() -> dict[str, Any]:
    """Settings that libraries keep for the whole process and whose change a user would notice."""
    exact = decimal.getcontext()
    # On import some packages filter single messages and classes of their own; this is harmless.
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
    """The global settings of other libraries are the same after each test."""
    before = global_settings()
    yield
    after = global_settings()
    changed = {name: (before[name], after[name]) for name in before if before[name] != after[name]}
    assert not changed, f"this test leaves global settings changed: {changed}"

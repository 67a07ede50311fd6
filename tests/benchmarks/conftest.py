"""Options of the benchmarks."""

from __future__ import annotations

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--limit`: CPU seconds after which a competitor is stopped."""
    parser.addoption("--limit", type=float, default=60.0, help="CPU seconds for one competitor")

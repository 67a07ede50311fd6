"""Fixtures of the tests of the command line."""

import sys

import pytest


@pytest.fixture
def no_pictures(monkeypatch):
    """As if matplotlib were not installed."""
    monkeypatch.setitem(sys.modules, "matplotlib", None)

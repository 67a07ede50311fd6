"""Fixtures for the tests of the command line."""

import sys

import pytest


@pytest.fixture
def no_pictures(monkeypatch):
    """Simulate a missing matplotlib."""
    monkeypatch.setitem(sys.modules, "matplotlib", None)

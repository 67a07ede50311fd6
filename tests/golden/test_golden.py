"""Public calls return the same values and raise the same messages as before."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from tests.golden.calls import VALUES
from tests.golden.record import (
    MESSAGES_FILE,
    MOVED_FILE,
    NAMES_FILE,
    VALUES_FILE,
    plain,
    read,
    same_words,
)
from tests.golden.refusals import REFUSALS, refused

FROZEN, MESSAGES = read(VALUES_FILE), read(MESSAGES_FILE)


def gap(found: Any, frozen: Any) -> float:
    """Largest difference, relative to the largest number of its list; texts must be equal."""
    if isinstance(frozen, dict):
        assert found.keys() == frozen.keys()
        return max(gap(found[key], part) for key, part in frozen.items())
    try:
        numbers = np.array(frozen, float)
    except ValueError:
        if not isinstance(frozen, list):
            assert found == frozen
            return 0.0
        return max(gap(one, two) for one, two in zip(found, frozen, strict=True))
    assert np.shape(found) == numbers.shape
    return float(np.abs(np.array(found, float) - numbers).max() / (np.abs(numbers).max() or 1.0))


def test_enough_is_frozen():
    """Neither a call nor a frozen answer is missing."""
    assert FROZEN.keys() == VALUES.keys()
    assert MESSAGES.keys() == REFUSALS.keys()
    assert len(VALUES) >= 75
    assert len(REFUSALS) >= 96


@pytest.mark.parametrize("name", VALUES)
def test_value(name):
    """The value equals the frozen value within the tolerance."""
    tolerance, call = VALUES[name]
    assert tolerance == FROZEN[name]["tolerance"]
    assert gap(plain(call()), FROZEN[name]["value"]) <= tolerance


@pytest.mark.parametrize("name", REFUSALS)
def test_message(name):
    """Class and text are as frozen; a text that differs from the first one has a reason."""
    frozen = MESSAGES[name]
    found = refused(REFUSALS[name])
    assert found["error"] == frozen["error"]
    assert same_words(name, found["text"], frozen["text"]), found["text"]
    assert "first" not in frozen or frozen.get("may_change")


def test_differences_are_seen():
    """The comparison fails for other numbers, shapes and words."""
    assert gap([1.0, 2.0], [1.0, 2.2]) == pytest.approx(0.2 / 2.2)
    assert gap({"a": [[1.0], [1.0, 3.0]]}, {"a": [[1.0], [1.0, 2.0]]}) == 0.5
    with pytest.raises(AssertionError):
        gap([1.0], [1.0, 2.0])
    assert gap([["a", 1]], [["a", 2]]) == 0.5
    with pytest.raises(AssertionError):
        gap(["b", 1], ["a", 1])
    assert not same_words("unknown space", "one", "two")
    assert same_words("accuracy out of reach", "gets to 1.1e-15", "gets to 3e-16")


def test_public_names():
    """`import geomtorsion` exports exactly the recorded names."""
    assert sorted(gt.__all__) == read(NAMES_FILE)


def test_old_names_work_and_name_the_new_place():
    """A name that moved is the same object, with a warning, and is not listed any more."""
    moved = read(MOVED_FILE)
    assert not set(moved) & set(gt.__all__)
    for name, package in moved.items():
        new = f"geomtorsion.{package}"
        with pytest.warns(DeprecationWarning, match=rf"geomtorsion\.{name} is {new}\.{name} now"):
            old = getattr(gt, name)
        home = import_module(new)
        assert name in home.__all__
        assert old is getattr(home, name)

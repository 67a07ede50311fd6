"""Input that the address of the page stores: read as it was written, and never trusted."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import pytest

from geomtorsion.teaching.lab.query import Query, numbers_text, store
from geomtorsion.teaching.lab.settings import PAGE


class Address(dict[str, str]):
    """An address that can be written, with the methods of marimo's."""

    def set(self, key: str, text: str) -> None:
        self[key] = text

    def remove(self, key: str) -> None:
        del self[key]


def address(query: Address, values: Mapping[str, tuple[str, str]]) -> Address:
    """The address after these values were stored."""
    page: Any = SimpleNamespace(query_params=lambda: query)
    store(page, values)
    return query


def test_only_changed_values_are_written():
    """Only changed values are in the address; a value that returns to its default leaves it."""
    query = address(Address(tab="Loops"), {"radius": ("0.1", "0.3"), "t": ("2", "2")})
    assert query == {"tab": "Loops", "radius": "0.1"}
    assert address(query, {"radius": ("0.3", "0.3")}) == {"tab": "Loops"}


def test_long_texts_are_not_written():
    """Text beyond the limit of an address is neither written nor read."""
    assert address(Address(), {"coframe": ("1" * (PAGE.address + 1), "")}) == {}
    assert Query.of({"coframe": "1" * (PAGE.address + 1)}).text("coframe", "0") == "0"


@pytest.mark.parametrize("values", [[0.1, 1 / 3, 1e-12], [0.0], [-3.0, 2.5]])
def test_numbers_come_back(values: list[float]):
    """Stored numbers have ten digits, more than a slider needs."""
    query = Query({"x": numbers_text(values)})
    found = query.numbers("x", [(-10, 10)] * len(values), [9.0] * len(values))
    assert found == pytest.approx(values, rel=1e-9)


@pytest.mark.parametrize(
    "text", ["", "nan", "inf", "1e999", "2", "-1", "0.5,0.5", "x", "0x1", "__import__('os')"]
)
def test_odd_numbers_count_as_absent(text: str):
    """A text that is not a number, out of range, or too long a list counts as absent."""
    assert Query({"x": text}).numbers("x", [(0, 1)], [0.25]) == [0.25]


def test_names_are_looked_up():
    """Only names on a list are chosen."""
    query = Query.of({"tab": "<b>", "effects": "gravity,rm,pivot", "two": ["a", "b"]})
    assert query.one_of("tab", ["Loops"], "first") == "first"
    assert query.some_of("effects", ["gravity", "pivot", "spin"], ()) == ["gravity", "pivot"]
    assert query.one_of("two", ["a", "b"], "b") == "a"

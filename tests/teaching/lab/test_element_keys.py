"""Fields of one case take nothing from the fields of the previous case."""

from __future__ import annotations

from itertools import pairwise
from types import ModuleType, SimpleNamespace

from geomtorsion.teaching.lab.element_keys import keyed, skip_numbers

CASES = ["so3", "s2", "flat_polar", "heisenberg", "frw", 2, 3, 4]


def first_number(chosen: object) -> int:
    """The number from which fields of a case are counted."""
    made: list[None] = []
    page = ModuleType("marimo")
    page.ui = SimpleNamespace(checkbox=lambda: made.append(None))  # type: ignore[attr-defined]
    skip_numbers(page, CASES, chosen, 4)
    return len(made)


def test_numbers_of_cases_that_follow_each_other_are_apart():
    """Neighbouring cases differ by nine numbers or more: two per field, one for the dictionary."""
    firsts = [first_number(chosen) for chosen in CASES]
    for k in range(len(CASES) - 3):
        ordered = sorted(firsts[k : k + 4])
        assert all(b - a >= 9 for a, b in pairwise(ordered))
    assert max(firsts) <= 50


def test_another_case_has_another_tag():
    """A number and its text have different tags; equal cases have equal tags."""
    tags = {keyed("", *case) for case in (("so3",), ("so3", 3), ("so33",), (3,), ("3",))}
    assert len(tags) == 5
    assert keyed("<b>x</b>", "so3", 3) == keyed("<b>x</b>", "so3", 3)

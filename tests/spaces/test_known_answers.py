"""Every shipped space agrees exactly with its known closed forms."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import pytest

from geomtorsion.errors import UnknownNameError
from geomtorsion.spaces import load, names
from geomtorsion.spaces.checking import computed, disagreements
from geomtorsion.spaces.space import Closed, Index, KnownAnswer, Space


@cache
def shared(name: str) -> Space:
    """A space shared between tests: it never changes."""
    return load(name)


@pytest.mark.parametrize("name", names())
def test_known_answers(name: str) -> None:
    """All closed forms agree, and listed zeros vanish."""
    space = shared(name)
    quantities = {answer.quantity for answer in space.known}
    assert quantities & {"torsion", "connection_torsion"}, "no closed form of the torsion"
    assert quantities & {"ricci", "riemann", "einstein", "scalar_curvature", "connection_ricci"}
    wrong = [str(d) for answer in space.known for d in disagreements(space, answer)]
    assert wrong == []


@pytest.mark.parametrize("name", names())
def test_every_answer_can_be_wrong(name: str) -> None:
    """A doubled answer, or one added to a zero, is found at exactly that index."""
    space = shared(name)
    for answer in space.known:
        given = answer.components
        table: dict[Index, Closed] = dict(given) if isinstance(given, Mapping) else {(): given}
        rank = len(next(iter(table), (0,) * len(computed(space, answer).slots)))
        index = max(table, default=(0,) * rank)
        value = table.get(index, 0)
        changed = {**table, index: value * 2 if value != 0 else 1}
        (found,) = disagreements(space, replace(answer, components=changed))
        assert (found.quantity, found.index) == (answer.quantity, index)


@pytest.mark.parametrize("name", ["so3", "schwarzschild", "kerr_kinnersley"])
def test_wrong_answers_are_detected(name: str) -> None:
    """A closed form that is off by a little, or that omits a component, is detected."""
    space = shared(name)
    answer = next(a for a in space.known if a.quantity == "metric")
    assert isinstance(answer.components, dict)
    index = min(answer.components)
    off = {**answer.components, index: answer.components[index] * (1 + space.frame.coordinates[1])}
    (found,) = disagreements(space, replace(answer, components=off))
    assert found.index == index
    assert found.quantity == "metric"
    missing = {key: value for key, value in answer.components.items() if key != index}
    (found,) = disagreements(space, replace(answer, components=missing))
    assert found.index == index
    assert found.expected == 0
    assert disagreements(space, replace(answer, components=missing, complete=False)) == ()


def test_wrong_zero_is_detected() -> None:
    """The torsion of so3 is not zero, and the listing names all six components."""
    space = shared("so3")
    found = disagreements(space, KnownAnswer("torsion", {}, basis="frame"))
    assert {d.index for d in found} == {
        (0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (2, 1, 0), (0, 2, 1)
    }  # fmt: skip
    assert "expected 0, found -1/2" in str(next(d for d in found if d.index == (0, 1, 2)))


def test_wrong_scalar_is_detected() -> None:
    """A wrong scalar is detected."""
    (found,) = disagreements(shared("s2"), KnownAnswer("scalar_curvature", "1/R**2"))
    assert found.index == ()
    assert disagreements(shared("s2"), KnownAnswer("scalar_curvature", "2/R**2")) == ()


def test_a_connection_is_needed() -> None:
    """An answer about a missing connection is refused with a reason."""
    with pytest.raises(
        UnknownNameError, match="got so3, which only has the connections of its frame"
    ):
        disagreements(shared("so3"), KnownAnswer("connection_torsion", {}))

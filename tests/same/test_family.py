"""Families: a typed metric is a member of a shipped family, with values of its parameters."""

# pyright: reportOptionalMemberAccess=false

import math

import pytest

import geomtorsion as gt
from geomtorsion.errors import UndecidedError


def diagonal(coordinates: str, entries: list[str], parameters: str | None = None) -> gt.Frame:
    """A diagonal metric without domain."""
    n = range(len(entries))
    rows = [[entries[i] if i == k else "0" for k in n] for i in n]
    return gt.Frame.from_metric(coordinates, rows, parameters=parameters)


def hole(f: str, parameters: str | None = None) -> gt.Frame:
    """A static black hole -f dt^2 + dr^2/f + r^2 dOmega^2."""
    entries = [f"-({f})", f"1/({f})", "r**2", "r**2*sin(theta)**2"]
    return diagonal("t r theta phi", entries, parameters)


PLANE = diagonal("a b", ["1", "1"])
FLAT = diagonal("t x y z", ["-1", "1", "1", "1"])
# Static walls of Taub, the limit of a black hole of infinite mass with negative mass.
WALLS = diagonal("t z x y", ["-1/z", "z", "z**2", "z**2"])
MEMBERS = [
    (hole("1 - rs/r", "rs"), "schwarzschild", {"M": "rs/2"}),
    (hole("1 - 2/r"), "kerr", {"M": "1", "a": "0"}),
    (diagonal("a b", ["9", "9*sin(a)**2"]), "s2", {"R": "3"}),
    (FLAT, "schwarzschild", {"M": "0"}),
    (FLAT, "kerr", {"M": "0", "a": "0"}),
    *(
        pytest.param(*member, marks=pytest.mark.slow)
        for member in (
            (hole("1 - 2/r"), "schwarzschild", {"M": "1"}),
            (hole("1 - 2*m/r", "m"), "schwarzschild_isotropic", {"M": "m"}),
            (hole("1 - 2*M/r", "M"), "schwarzschild", {"M": "M"}),
            (hole("1 - 2/r + 1/(4*r**2)"), "kerr_newman", {"M": "1", "a": "0", "q": "1/2"}),
        )
    ),
]
STRANGERS = [
    (WALLS, "schwarzschild", "for any values of the parameters"),
    (WALLS, "kerr", "vanishes for the first geometry only"),
    pytest.param(WALLS, "taub_nut", "vanishes for the first geometry", marks=pytest.mark.slow),
    (hole("1 - 2/r + 1/(4*r**2)"), "schwarzschild", "the second: "),
    (PLANE, "s2", "vanishes for the first geometry only"),
    (diagonal("a b", ["1", "(2 + cos(a))**2"]), "s2", "the second: "),
    (diagonal("a b", ["1", "sin(a)**2"]), "schwarzschild", "dimensions are 2 and 4"),
]


@pytest.mark.parametrize(("typed", "name", "values"), MEMBERS, ids=lambda x: str(x)[:30])
def test_a_name_is_a_family(typed, name, values):
    """A metric with fewer or other parameters is the same for the true values of the family's."""
    result = gt.same_geometry(typed, name)
    assert result.verdict == "same", result
    assert {k: str(v) for k, v in result.member.items()} == values
    texts = ", ".join(f"{k} = {v}" for k, v in values.items())
    assert str(result).startswith(f"same for {texts}: all invariants agree")


@pytest.mark.parametrize(("typed", "name", "words"), STRANGERS, ids=lambda x: str(x)[:30])
def test_a_stranger_is_not_a_member(typed, name, words):
    """A geometry outside of a family is different, for all values of the parameters."""
    result = gt.same_geometry(typed, name)
    assert result.verdict == "different", result
    assert words in result.reason
    assert result.certainty.error < 1e-20
    assert not result


def test_the_family_may_come_first():
    """The order of the two sides changes neither the verdict nor the values; maps go across."""
    result = gt.same_geometry("schwarzschild_isotropic", hole("1 - 2/r"))
    assert dict(result.member) == {"M": 1}
    start = {str(q): float(x) for q, x in result.match.start.items()}
    rho = math.sqrt(sum(start[q] ** 2 for q in "xyz"))
    image = result.map(start)
    # r = rho (1 + M/(2 rho))^2
    assert image["r"] == pytest.approx(rho * (1 + 1 / (2 * rho)) ** 2, abs=1e-9)


def test_reasons_name_the_sides_in_their_order():
    """The reason is about the first and the second geometry as they were given."""
    for sides, words in (
        ((PLANE, "s2"), "vanishes for the first geometry only"),
        (("s2", PLANE), "vanishes for the second geometry only"),
        (("s2", FLAT), "dimensions are 2 and 4"),
        ((FLAT, "s2"), "dimensions are 4 and 2"),
    ):
        result = gt.same_geometry(*sides)
        assert result.verdict == "different"
        assert words in result.reason


def test_legs_of_a_family_are_fitted():
    """Leg by leg, and up to a constant turn, the radius of a sphere is found."""
    sphere = gt.Frame("a b", [[0, "3*sin(a)"], [3, 0]])
    assert dict(gt.same_geometry(sphere, "s2", "teleparallel").member) == {"R": 3}
    assert gt.same_geometry(sphere, "s2", "legs").verdict == "different"


@pytest.mark.slow
def test_an_undecided_verdict_is_neither_true_nor_false():
    """`bool` of an undecided verdict raises an error with the reason."""
    melvin = diagonal(
        "t rho phi z",
        ["-(1 + rho**2)**2", "(1 + rho**2)**2", "rho**2/(1 + rho**2)**2", "(1 + rho**2)**2"],
    )
    result = gt.same_geometry(melvin, "kerr_newman")
    assert result.verdict == "undecided"
    with pytest.raises(UndecidedError, match="no values of M, a, q"):
        bool(result)

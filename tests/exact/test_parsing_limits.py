"""Parsing limits: texts built to exhaust the machine are refused at once; long texts are read."""

import pytest
import sympy

from geomtorsion.errors import LimitError
from geomtorsion.exact.parsing import parse_expression
from geomtorsion.exact.tokens import Limits

t, r, theta, M = sympy.symbols("t r theta M", positive=True)
NAMES = {"t": t, "r": r, "theta": theta, "M": M}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("9**9**9", "the exponent is 387420489; the limit is 256"),
        ("9**9**9**9**9", "the limit is 256"),
        ("r**257", "the exponent is 257; the limit is 256"),
        ("(r**256)**2", "the exponent is 512; the limit is 256"),
        ("r**(1/1000)", "the exponent is 1/1000; the limit is 256"),
        ("10**255*10**255*10**255*10**255", "more digits than the limit of 1,000"),
        ("((2*r)**250)**4*(2*r)**250*(9*r)**250", "the limit is"),
        ("*".join("9" * 2000), "more digits than the limit of 1,000"),
        ("+".join(f"1/{p}" for p in range(1, 5000)), "more digits than the limit of 1,000"),
        ("+".join(f"r/{p}" for p in range(1, 5000)), "more digits than the limit of 1,000"),
        ("9" * 1001, "has 1,001 digits; the limit is 1,000"),
        ("1e5000", "more digits than the limit"),
        ("(" * 51 + "r" + ")" * 51, "nested too deeply; the limit is 50"),
        ("-" * 1000 + "r", "nested too deeply; the limit is 50"),
        ("r**" * 1000 + "2", "nested too deeply; the limit is 50"),
        ("sin(" * 5000 + "r" + ")" * 5000, "nested too deeply; the limit is 50"),
        ("r" * 2_000_001, "has 2,000,001 characters; the limit is 2,000,000"),
    ],
)
def test_every_limit_is_stated(text, message):
    """Text that would take hours or all memory is refused, and the message states the limit."""
    with pytest.raises(LimitError, match=message):
        parse_expression(text, NAMES)


def test_limits_can_be_moved():
    """Limits can be changed by an argument."""
    assert parse_expression("r**300", NAMES, limits=Limits(exponent=300)) == r**300
    with pytest.raises(LimitError, match="the limit is 2 levels"):
        parse_expression("((r))", NAMES, limits=Limits(depth=2))
    assert parse_expression("(r)", NAMES, limits=Limits(depth=2)) == r


@pytest.mark.parametrize("count", [39, 40, 41, 1600, 1601, 3000])
def test_long_chains_keep_their_signs(count):
    """Signs are right around the lengths at which a chain is split into portions of forty."""
    assert parse_expression("r" + "-M" * count, NAMES) == r - count * M
    assert parse_expression("-r" + "-M+1" * count, NAMES) == -r - count * M + count
    assert parse_expression("2*(r" + "-M" * count + ")-r", NAMES) == 2 * (r - count * M) - r
    powers = parse_expression("r" + "/M*theta/t" * 20 + "*1" * count, NAMES)
    assert powers == r * theta**20 / (M * t) ** 20
    flipped = parse_expression("*".join(["-1"] * count), NAMES)
    assert flipped == (-1) ** count


def test_a_hundred_thousand_terms():
    """A sum of 100,000 terms is read; Python's own parser fails at some thousand."""
    text = "+".join(["r", "M", "t"] * 33_333 + ["theta"])
    assert parse_expression(text, NAMES) == 33_333 * (r + M + t) + theta

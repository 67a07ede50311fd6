"""Products: contractions written with indices, such as R_abcd R^abdc, read from text."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import count, product
from math import prod

from geomtorsion.exact import tokens
from geomtorsion.exact.tokens import Source, Token
from geomtorsion.support import checks

# Tensors of a connection, with all indices down, and the number of their indices.
OF_CONNECTION = {"T": 3, "R": 4, "Q": 3}
OF_MATTER = {"A": 1, "F": 2}
METRIC, EPSILON = "g", "eps"
# The tensor of second derivatives of a scalar field, before the name of the field.
HESSIAN = "hessian of "
# Tensors made of others: (name, number of indices) -> terms; free indices are a, b.
_MADE: dict[tuple[str, int], tuple[tuple[Fraction, str], ...]] = {
    ("R", 2): ((Fraction(1), "R_xabx"),),
    ("R", 0): ((Fraction(1), "R_xyyx"),),
    ("G", 2): ((Fraction(1), "R_xabx"), (Fraction(-1, 2), "g_ab R_xyyx")),
    ("V", 2): ((Fraction(1), "R_abxx"),),
    ("v", 1): ((Fraction(1), "T_axx"),),
    ("Q", 1): ((Fraction(1), "Q_axx"),),
    ("q", 1): ((Fraction(1), "Q_xxa"),),
}
# Names that a scalar field cannot have: its derivatives have indices.
TENSORS = frozenset((*OF_CONNECTION, *OF_MATTER, METRIC, EPSILON, *(name for name, _ in _MADE)))
KNOWN = (
    "R_abcd, R_ab, R, G_ab, V_ab, T_abc, v_a, Q_abc, Q_a, q_a, g_ab, eps_abcd, A_a, F_ab, and "
    "phi_a and phi_ab for the first and second derivatives of a scalar field phi"
)
LIMITS = tokens.Limits(characters=2000)
_FACTOR = re.compile(r"(?P<name>[^\W_]+?)(?P<suffix>bar|_[2-9]\d*)?(?P<runs>([_^][^\W\d_]+)*)")


@dataclass(frozen=True)
class Factor:
    """A tensor with its indices; equal numbers are summed.

    name: T, R, Q, g, eps, A, F, or a scalar field for its derivatives.
    indices: one number for each index.
    suffix: "bar" or "_2", of another connection or another field.
    """

    name: str
    indices: tuple[int, ...]
    suffix: str = ""


@dataclass(frozen=True)
class Product:
    """A rational number times factors, all of whose indices are summed."""

    coefficient: Fraction
    factors: tuple[Factor, ...]


def hessian_name(field: str) -> str:
    """The name of the tensor of second derivatives of a scalar field."""
    return HESSIAN + field


@cache
def read_products(text: str, where: str = "formula") -> tuple[Product, ...]:
    """A sum of products of tensors with indices.

    Raises
    ------
    ExpressionError
        The text has a sign or a tensor that has no meaning here, or an index that is not summed.

    Examples
    --------
    >>> read_products("v_a v^a / 2")[0].factors
    (Factor(name='T', indices=(1, 2, 2), suffix=''), Factor(name='T', indices=(1, 3, 3), suffix=''))
    """
    source = Source(text, where)
    result = []
    for sign, pieces in _terms(source, _tokens(source)):
        result += _expanded(source, sign, pieces)
    return tuple(result)


@dataclass(frozen=True)
class _Written:
    """A factor as it is written: its name, suffix, letters and their positions in the text."""

    name: str
    suffix: str
    letters: str
    heights: str
    start: int
    end: int


def _tokens(source: Source) -> list[Token]:
    """Tokens of a text; an upper index is a name after a power sign."""
    words = frozenset(re.findall(r"\w+", source.text))
    result: list[Token] = []
    for token in tokens.tokens_of(source, words, LIMITS):
        before = result[-1] if result else None
        is_index = token.kind == "name" and before is not None and before.end == token.start
        if is_index and before is not None and before.text == "**" and len(result) > 1:
            power, base = result.pop(), result.pop()
            if base.kind != "name":
                raise source.error(base.start, token.end, "expected a tensor before its indices")
            indexed = f"{base.text}^{token.text}"
            token = Token("name", indexed, base.start, token.end)
            del power
        result.append(token)
    return result


def _terms(source: Source, tokens: list[Token]) -> Iterator[tuple[Fraction, list[_Written]]]:
    """Terms: the number and the factors of each."""
    number, factors = Fraction(1), []
    is_empty, operation = True, ""
    position = 0
    while position < len(tokens):
        token = tokens[position]
        position += 1
        if token.text in ("+", "-"):
            if operation:
                raise _misplaced(source, token)
            if not is_empty:
                yield number, factors
            number, factors = Fraction(f"{token.text}1"), []
            is_empty, operation = True, token.text
        elif token.text in ("*", "/"):
            if is_empty or operation:
                raise _misplaced(source, token)
            operation = token.text
        elif token.kind == "number":
            number *= _number(source, token, operation == "/")
            is_empty, operation = False, ""
        elif token.kind == "name":
            if operation == "/":
                reason = f"expected a number after /, got {token.text}"
                raise source.error(token.start, token.end, reason)
            factor, power = _factor(source, token), 1
            if position + 1 < len(tokens) and tokens[position].text == "**":
                power = _power(source, factor, tokens[position + 1])
                position += 2
            factors += [factor] * power
            is_empty, operation = False, ""
        else:
            raise _misplaced(source, token)
    if is_empty or operation:
        end = len(source.text)
        raise source.error(end, end + 1, "expected a product such as R_abcd R^abcd")
    yield number, factors


def _number(source: Source, token: Token, is_below: bool) -> Fraction:
    """A number of a product, or its inverse below the line."""
    value = int(token.text)
    if is_below and not value:
        raise source.error(token.start, token.end, "expected a number that is not zero")
    return Fraction(1, value) if is_below else Fraction(value)


def _misplaced(source: Source, token: Token) -> Exception:
    """The error for a sign that has no place in a sum of products."""
    reason = f"expected a sum of products of tensors and numbers, got {token.text} here"
    remedy = "Write it without brackets, such as R_abcd R^abdc - 4 R_ab R^ab."
    return source.error(token.start, token.end, reason, remedy)


def _power(source: Source, factor: _Written, token: Token) -> int:
    """The exponent of a scalar factor."""
    if factor.letters or token.kind != "number" or not 0 < int(token.text) <= LIMITS.exponent:
        reason = f"expected a power from 1 to {LIMITS.exponent} of a scalar such as R"
        raise source.error(factor.start, token.end, reason, "Write the factors one by one.")
    return int(token.text)


def _factor(source: Source, token: Token) -> _Written:
    """A tensor with its letters."""
    match = _FACTOR.fullmatch(token.text)
    if match is None:
        reason = f"expected a tensor with indices such as R_ab^cd, got {token.text}"
        raise source.error(token.start, token.end, reason)
    name, suffix = match["name"], match["suffix"] or ""
    heights = letters = ""
    for run in re.findall(r"[_^][^\W\d_]+", match["runs"]):
        letters += run[1:]
        heights += run[0] * (len(run) - 1)
    rank = len(letters)
    ranks = [*(k for known, k in _MADE if known == name)]
    ranks += [table[name] for table in (OF_CONNECTION, OF_MATTER) if name in table]
    if name == METRIC:
        ranks = [2]
    if name == EPSILON:
        ranks = [max(rank, 2)]
    if name not in TENSORS and rank not in (1, 2):
        near = checks.did_you_mean(name, sorted(TENSORS))
        reason = f"expected a tensor, got {token.text}. {near}Known are {KNOWN}"
        remedy = "Multiply an invariant by a scalar in the Lagrangian."
        raise source.error(token.start, token.end, reason, "" if rank else remedy)
    if name in TENSORS and rank not in ranks:
        wanted = " or ".join(str(k) for k in sorted(ranks))
        reason = f"expected {name} with {wanted} indices, got {rank}"
        raise source.error(token.start, token.end, reason)
    if suffix and name in (METRIC, EPSILON):
        reason = f"expected {name} without {suffix}: all connections have one metric"
        raise source.error(token.start, token.end, reason)
    return _Written(name, suffix, letters, heights, token.start, token.end)


def _expanded(source: Source, number: Fraction, written: list[_Written]) -> Iterator[Product]:
    """Products of tensors that are not made of others."""
    _check_sums(source, written)
    numbers = {letter: k for k, letter in enumerate(dict.fromkeys(_letters(written)), 1)}
    ways = [_MADE.get((one.name, len(one.letters)), ((Fraction(1), ""),)) for one in written]
    size = prod(map(len, ways))
    if size > LIMITS.exponent:
        reason = f"expected at most {LIMITS.exponent} products, got {size} where G_ab is a sum"
        raise source.limit(written[0].start, written[-1].end, reason, "Write fewer factors G_ab.")
    for way in product(*ways):
        fresh = count(len(numbers) + 1)
        coefficient, factors = number, []
        for one, (share, formula) in zip(written, way, strict=True):
            own = tuple(numbers[letter] for letter in one.letters)
            coefficient *= share
            if not formula:
                factors.append(Factor(one.name, own, one.suffix))
                continue
            places = dict(zip("ab", own, strict=False))
            for piece in formula.split():
                name, _, letters = piece.partition("_")
                for letter in letters:
                    if letter not in places:
                        places[letter] = next(fresh)
                indices = tuple(places[letter] for letter in letters)
                factors.append(Factor(name, indices, "" if name == METRIC else one.suffix))
        if coefficient:
            yield Product(coefficient, tuple(factors))


def _letters(written: list[_Written]) -> str:
    return "".join(one.letters for one in written)


def _check_sums(source: Source, written: list[_Written]) -> None:
    """Each index occurs twice, once up and once down."""
    heights: dict[str, str] = {}
    for one in written:
        for letter, height in zip(one.letters, one.heights, strict=True):
            heights[letter] = heights.get(letter, "") + height
    for letter, both in heights.items():
        if sorted(both) == ["^", "_"]:
            continue
        own = [one for one in written if letter in one.letters]
        counts = Counter(both)
        reason = (
            f"expected index {letter} once up and once down, got it {counts['^']} times up and "
            f"{counts['_']} times down"
        )
        remedy = "Each index is summed, as in R_ab R^ab."
        raise source.error(own[0].start, own[-1].end, reason, remedy)


def simplified(factors: tuple[Factor, ...], free: frozenset[int]) -> tuple[tuple[Factor, ...], int]:
    """Factors without metrics that only rename an index, and the number of traces of g."""
    traces = 0
    remaining = list(factors)
    while True:
        counts = Counter(k for one in remaining for k in one.indices)
        one = next(
            (
                one
                for one in remaining
                if one.name == METRIC and any(counts[k] > 1 and k not in free for k in one.indices)
            ),
            None,
        )
        if one is None:
            return tuple(remaining), traces
        remaining.remove(one)
        first, second = one.indices
        if first == second:
            traces += 1
            continue
        summed, other = (
            (first, second) if counts[first] > 1 and first not in free else (second, first)
        )
        for k, factor in enumerate(remaining):
            indices = tuple(other if x == summed else x for x in factor.indices)
            remaining[k] = replace(factor, indices=indices)

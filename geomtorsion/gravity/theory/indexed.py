"""Contractions: products with indices in the text of a Lagrangian, such as c*R_ab R^ab."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import count, permutations

from geomtorsion.gravity.theory.invariants import FORMULAS, INVARIANTS, Invariant, invariant
from geomtorsion.gravity.theory.products import Factor, read_products

# LaTeX: R_{ab}, R^{\mu\nu}, R_{\mu \nu}.
_BRACES = re.compile(r"([_^])\{((?:\s*\\?[^\W\d_])+\s*)\}")
_LETTER = re.compile(r"\\([a-z]+)|([^\W\d_])")
# A tensor with indices, and several of them in a product.
_TENSOR = r"[^\W\d_]+(?:_[2-9]\d*)?(?:[_^][^\W\d_]+)+(?!\w)"
_PRODUCT = re.compile(rf"(?<![\w^]){_TENSOR}(?:\s*(?:\*(?!\*)\s*)?{_TENSOR})*(?!\s*(?:\*\*|\^))")
_ONE = re.compile(_TENSOR)
_RUN = re.compile(r"([_^])([^\W\d_]+)")
# Squares of tensors, by name and number of indices.
_SQUARES = {
    ("F", 2): "F2", ("B", 2): "B2", ("H", 3): "H2", ("C", 4): "P1", ("Weyl", 4): "P1",
}  # fmt: skip
_SAME = re.compile(r"\b(Riem(ann)?|Ric(ci)?)(?=[_^])")


def named_contractions(text: str) -> tuple[str, tuple[Invariant, ...]]:
    r"""A text with a name for each contraction, and the invariants that had no name.

    Raises
    ------
    ExpressionError
        A contraction contains a tensor that has no meaning.

    Examples
    --------
    >>> named_contractions(r"R/2 + c*R_{\mu\nu}R^{\mu\nu}")
    ('R/2 + c*R4', ())
    >>> text, (own,) = named_contractions("R/2 + c*A_a A^a")
    >>> text, str(own)
    ('R/2 + c*Y1', 'Y1 = A_a A^a')
    """
    plain = _SAME.sub("R", _BRACES.sub(_without_braces, text))
    own: dict[str, Invariant] = {}

    def name_of(tensors: Sequence[str]) -> str:
        """The name of a contraction, which may be new."""
        if square := _square(tensors):
            return square
        formula = " ".join(tensors)
        form = _form(formula)
        known = [(name, FORMULAS[name]) for name in FORMULAS if name in INVARIANTS]
        for name, other in [*known, *((one.name, one.meaning) for one in own.values())]:
            if _form(other) == form:
                return name
        number = next(k for k in count(len(own) + 1) if f"Y{k}" not in plain)
        own[f"Y{number}"] = invariant(f"Y{number}", formula)
        return f"Y{number}"

    def replaced(match: re.Match[str]) -> str:
        """A product, in which names replace contractions."""
        if plain[: match.start()].rstrip().endswith("/") and "*" in match[0]:
            return match[0]
        groups = _groups(_ONE.findall(match[0]))
        return "*".join(name_of(x) if is_closed else x[0] for x, is_closed in groups)

    changed = _PRODUCT.sub(replaced, plain)
    return (changed, tuple(own.values())) if changed != plain else (text, ())


def _without_braces(match: re.Match[str]) -> str:
    """Indices in braces as letters, apart from the next name."""
    follows = match.string[match.end() : match.end() + 1].isalnum()
    return match[1] + _letters(match[2]) + " " * follows


def _square(tensors: Sequence[str]) -> str:
    """The name of the square of a tensor, or nothing."""
    if len(tensors) != 2:
        return ""
    names = {re.split("[_^]", one)[0] for one in tensors}
    letters = {"".join(x for _, x in _RUN.findall(one)) for one in tensors}
    if len(names) > 1 or len(letters) > 1:
        return ""
    return _SQUARES.get((names.pop(), len(letters.pop())), "")


def _letters(braced: str) -> str:
    r"""Indices in braces as letters; \mu is the letter of that name."""
    greek = {name: chr(945 + k) for k, name in enumerate(_GREEK)}
    return "".join(greek.get(x[1], x[1]) if x[1] else x[2] for x in _LETTER.finditer(braced))


_GREEK = (
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho "
    "varsigma sigma tau upsilon phi chi psi omega"
).split()


def _closed_at(tensors: Sequence[str]) -> int:
    """How many of the first tensors have each index once up and once down; 0 if never."""
    seen: set[tuple[str, str]] = set()
    for number, tensor in enumerate(tensors, 1):
        for sign, letters in _RUN.findall(tensor):
            for letter in letters:
                if (letter, sign) in seen:
                    return 0
                seen.add((letter, sign))
        if all((letter, "^" if sign == "_" else "_") in seen for letter, sign in seen):
            return number
    return 0


def _groups(tensors: list[str]) -> Iterator[tuple[list[str], bool]]:
    """Contractions, the shortest first, and with False names that only look like tensors."""
    start = 0
    while start < len(tensors):
        number = _closed_at(tensors[start:])
        yield tensors[start : start + max(number, 1)], number > 0
        start += max(number, 1)


def _form(formula: str) -> frozenset[tuple[object, ...]]:
    """A formula whatever the names of its indices and the order of its factors."""
    return frozenset(
        (
            str(term.coefficient),
            min(
                map(
                    _renamed,
                    permutations(term.factors) if len(term.factors) < 5 else [term.factors],
                )
            ),
        )
        for term in read_products(formula, "lagrangian")
    )


def _renamed(factors: Sequence[Factor]) -> tuple[tuple[str, str, tuple[int, ...]], ...]:
    """Factors with indices numbered by their first places."""
    numbers: dict[int, int] = {}
    return tuple(
        (one.name, one.suffix, tuple(numbers.setdefault(k, len(numbers)) for k in one.indices))
        for one in factors
    )

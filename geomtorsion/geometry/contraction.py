"""Contraction: sums over pairs of indices, with positions and kinds checked."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence

from geomtorsion.errors import ShapeError, TensorIndexError
from geomtorsion.geometry.components import Symmetry, effective, joined
from geomtorsion.geometry.homes import over_frame
from geomtorsion.geometry.index_types import KINDS, POSITIONS
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support.checks import shown, text


def contract(letters: str, *tensors: Tensor) -> Tensor:
    """Contract tensors by index letters, as numpy.einsum does, with the index positions checked.

    A letter that occurs twice is summed over; one of the two must be up and the other down,
    both coordinate or both frame indices. A letter that occurs once is an index of the result.

    Equation
    --------
    contract("abc,cd->abd", S, g):  S_{abd} = S_{ab}^c g_{cd}

    Parameters
    ----------
    letters
        Letters of each tensor, separated by commas, then "->" and the letters of the result;
        without it the result has the letters that occur once, in alphabetical order.
    tensors
        Tensors over one frame, as many as there are groups of letters.

    Returns
    -------
    Tensor with one slot per letter of the result, in that order.

    Raises
    ------
    TensorIndexError
        Letters do not fit the slots, or a summed pair is not one up and one down of one kind.
    ShapeError
        The tensors do not belong to one frame.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, contract
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> frame = Frame([r, phi], [[1, 0], [0, r]])
    >>> contract("ab,bc->ac", frame.metric, frame.inverse_metric).nonzero()
    {(0, 0): 1, (1, 1): 1}
    """
    groups, result_letters = _parse(letters, tensors)
    frame = tensors[0].frame
    tensors = tuple(over_frame(frame, tensor, tensor.label, ShapeError) for tensor in tensors)
    slots = _check(letters, groups, result_letters, tensors)
    field = frame.field
    current, current_letters = tensors[0].components, groups[0]
    for position in range(1, len(groups)):
        # Letters that are not needed later are summed at once: the arrays stay small.
        later = set("".join(groups[position + 1 :])) | set(result_letters)
        merged = _free(current_letters + groups[position], later)
        if position == len(groups) - 1:
            merged = result_letters
        symmetry = _inherited(slots, merged, groups[: position + 1], tensors)
        current = joined(
            field,
            (current, tensors[position].components),
            (current_letters, groups[position]),
            merged,
            symmetry,
        )
        current_letters = merged
    if len(groups) == 1:
        symmetry = _inherited(slots, result_letters, groups, tensors)
        current = joined(field, (current,), (groups[0],), result_letters, symmetry)
    return Tensor(frame, "".join(slots[x] for x in result_letters), current, current.symmetry)


def _parse(letters: str, tensors: Sequence[Tensor]) -> tuple[list[str], str]:
    """Groups of letters and the letters of the result."""
    text(letters, "letters", TensorIndexError)
    left, arrow, result_letters = letters.replace(" ", "").partition("->")
    groups = left.split(",")
    if not tensors or len(groups) != len(tensors):
        raise TensorIndexError(
            f"{shown(letters)}: expected {len(groups)} tensors, one for each group of letters, got "
            f"{len(tensors)}. Write one group for each tensor, separated by commas."
        )
    if not arrow:
        counts = Counter("".join(groups))
        result_letters = "".join(sorted(letter for letter, count in counts.items() if count == 1))
    return groups, result_letters


def _check(
    text: str, groups: Sequence[str], wanted: str, tensors: Sequence[Tensor]
) -> dict[str, str]:
    """Slots of the remaining letters; an error if anything does not fit."""
    seen: dict[str, list[tuple[str, str]]] = defaultdict(list)
    for group, tensor in zip(groups, tensors, strict=True):
        if len(group) != len(tensor.slots):
            raise TensorIndexError(
                f"{shown(text)}: expected {len(tensor.slots)} letters for {tensor.label}, one for "
                f"each index, got {shown(group)}."
            )
        for letter, slot in zip(group, tensor.slots, strict=True):
            seen[letter].append((slot, tensor.label))
    free = {letter: uses[0][0] for letter, uses in seen.items() if len(uses) == 1}
    if sorted(wanted) != sorted(free):
        raise TensorIndexError(
            f"{shown(text)}: expected the letters that occur once after the arrow, "
            f"{', '.join(sorted(free)) or 'none'}, got {shown(wanted)}."
        )
    for letter, uses in seen.items():
        _check_pair(text, letter, uses)
    return {letter: uses[0][0] for letter, uses in seen.items()}


def _check_pair(text: str, letter: str, uses: Sequence[tuple[str, str]]) -> None:
    """A summed letter joins one upper and one lower index of one kind."""
    if not letter.isalpha() or len(uses) > 2:
        raise TensorIndexError(
            f"{shown(text)}: expected each letter once (kept) or twice (summed), got {letter!r} "
            f"{len(uses)} times."
        )
    if len(uses) == 1:
        return
    (first, left), (second, right) = uses
    if KINDS[first] != KINDS[second]:
        raise TensorIndexError(
            f"{shown(text)}: index {letter!r} is a {KINDS[first]} index of {left} and a "
            f"{KINDS[second]} index of {right}. "
            "Bring both to one basis with in_frame() or in_coordinates()."
        )
    if POSITIONS[first] == POSITIONS[second]:
        raise TensorIndexError(
            f"{shown(text)}: index {letter!r} is {POSITIONS[first]} in {left} and in {right}. "
            f"Move one of them with {'raised' if POSITIONS[first] == 'down' else 'lowered'}(k)."
        )


def _free(letters: str, needed: set[str]) -> str:
    """Letters that later steps still need, each once."""
    return "".join(letter for letter in dict.fromkeys(letters) if letter in needed)


def _inherited(
    slots: dict[str, str], letters: str, groups: Sequence[str], tensors: Sequence[Tensor]
) -> Symmetry:
    """Symmetries of single factors that exchange only letters kept in the result."""
    symmetries = []
    for group, tensor in zip(groups, tensors, strict=False):
        for order, sign in effective(tensor.symmetry, tensor.slots):
            moved = {group[k]: group[j] for k, j in enumerate(order) if k != j}
            if all(letter in letters for letter in moved) and len(set(group)) == len(group):
                image = tuple(letters.index(moved.get(letter, letter)) for letter in letters)
                symmetries.append((image, sign))
    return tuple(dict.fromkeys(symmetries))


def product(one: Tensor, two: Tensor) -> Tensor:
    """The sum over the last index of one tensor and the first of another: one @ two."""
    if not one.slots or not two.slots:
        raise TensorIndexError(
            "@: expected two tensors with indices, got a scalar. Use * to multiply by a scalar."
        )
    names = "abcdefghijklmnopqrstuvwxyz"
    left = names[: len(one.slots)]
    right = left[-1] + names[len(left) : len(left) + len(two.slots) - 1]
    return contract(f"{left},{right}->{left[:-1]}{right[1:]}", one, two)

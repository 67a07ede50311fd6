"""Arguments: types of what users give, with names, for checkers of types."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

if TYPE_CHECKING:
    import sympy as sp


class Exact(Protocol):
    """An exact element, which has a form in sympy."""

    @property
    def sympy(self) -> Any:
        """The expression."""
        ...


class Array(Protocol):
    """A table of any number of axes: an array of NumPy, a matrix or array of SymPy, a tensor."""

    @property
    def shape(self) -> tuple[Any, ...]:
        """Length of each axis."""
        ...

    def __getitem__(self, index: Any, /) -> Any: ...


class Labelled(Protocol):
    """A table with named columns: a mapping, a Series or DataFrame, a Dataset, a solution."""

    def keys(self) -> Iterable[Any]:
        """Names of the columns."""
        ...

    def __getitem__(self, name: Any, /) -> Any: ...


# An exact value; text is read as an expression.
Entry: TypeAlias = "int | Fraction | str | sp.Expr | Exact"
# A real number; floats have their binary values.
Real: TypeAlias = "float | Fraction | sp.Expr | Exact"
# Names of coordinates: symbols, or text such as "r theta".
Coordinates: TypeAlias = "str | Sequence[sp.Symbol] | Sequence[str] | Sequence[sp.Symbol | str]"
Parameters: TypeAlias = Coordinates
# Components, as nested lists or as a table.
Vector: TypeAlias = "Sequence[Entry] | Array"
Matrix: TypeAlias = "Sequence[Sequence[Entry]] | Array"
Cube: TypeAlias = "Sequence[Sequence[Sequence[Entry]]] | Array"
# Signs such as "-+++" or (-1, 1, 1, 1), or a constant symmetric matrix.
Signature: TypeAlias = "str | Sequence[int] | Matrix"
# Inequalities.
Domain: TypeAlias = "str | sp.Basic | Sequence[sp.Basic | str]"
# The last time or all times; text has a unit, as "3 min".
Times: TypeAlias = "float | Fraction | str | sp.Expr | Iterable[Real | str]"
# One row of numbers for each motion, or columns by name.
Starts: TypeAlias = "Sequence[Sequence[Real]] | Sequence[Array] | Array | Labelled"
# Functions of coordinates by the names of forces or constraints, or one without a name.
Forces: TypeAlias = "Vector | Mapping[str, Any]"

"""Lie algebra: structure constants, Killing form, series of ideals, and its name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

import sympy as sp

from geomtorsion.errors import ArgumentError, ShapeError
from geomtorsion.exact import Field, vanishes
from geomtorsion.exact.reading import counted_as
from geomtorsion.geometry import algebra_names
from geomtorsion.geometry.brackets import Brackets, Vector
from geomtorsion.geometry.groups import checked_constants
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive


@exclusive
@dataclass(frozen=True, eq=False, repr=False, init=False)
class LieAlgebra:
    """A real Lie algebra of finite dimension, from its structure constants.

    exact: the brackets of the basis elements X_0, X_1, ...

    Equation
    --------
    [X_i, X_j] = C_ij^k X_k,  C_[ij^s C_k]s^m = 0

    Symbols in the constants have generic values. The signs of the Killing form, and so the name,
    may depend on them; they are given at `sample`.

    Parameters
    ----------
    constants
        C_ij^k, shape (n, n, n), axes (i, j, k), or a mapping {(0, 1, 2): 1} of the nonzero ones,
        each for one order of i and j (see `Frame.from_structure_constants`).

    Raises
    ------
    StructureConstantError
        The constants are not antisymmetric, or violate the Jacobi identity.

    Examples
    --------
    >>> from geomtorsion.geometry import LieAlgebra
    >>> rotations = LieAlgebra({(0, 1, 2): 1, (1, 2, 0): 1, (2, 0, 1): 1})
    >>> rotations.name, rotations.bianchi, rotations.signature
    ('so(3)', 'IX', (0, 3, 0))
    >>> print(LieAlgebra({(0, 1, 2): 1}))
    Heisenberg algebra: dimension 3, Bianchi II
    [X_0, X_1] = X_2
    Killing form: 0 positive, 0 negative, 3 zero
    derived series: 3, 1, 0
    """

    exact: Brackets

    def __init__(self, constants: object) -> None:
        rows = checked_constants(constants)
        free = sorted({s for a in rows for b in a for x in b for s in x.free_symbols}, key=str)
        counted_as(free)
        field, n = Field(free), len(rows)
        pairs = combinations(range(n), 2)
        table = {(i, j): field.read_all([("C", x) for x in rows[i][j]]) for i, j in pairs}
        object.__setattr__(self, "exact", Brackets.of(field, n, table))

    @classmethod
    def of(cls, exact: Brackets) -> LieAlgebra:
        """The algebra with brackets that satisfy the Jacobi identity by their construction."""
        new = cls.__new__(cls)
        object.__setattr__(new, "exact", exact)
        return new

    def __reduce__(self) -> tuple[object, ...]:
        return _made_again, (self.dimension, self.brackets())

    @property
    def dimension(self) -> int:
        """The number of basis elements."""
        return self.exact.dimension

    def brackets(self) -> dict[tuple[int, int, int], sp.Expr]:
        """(i, j, k) -> C_ij^k for i < j, without vanishing ones.

        Examples
        --------
        >>> from geomtorsion.geometry import LieAlgebra
        >>> LieAlgebra({(1, 0, 0): -2}).brackets()
        {(0, 1, 0): 2}
        """
        return {
            (i, j, k): x.sympy
            for (i, j), row in sorted(self.exact.table.items())
            for k, x in enumerate(row)
            if not vanishes(x)
        }

    @cached_property
    def structure_constants(self) -> sp.ImmutableDenseNDimArray:
        """C_ij^k, shape (n, n, n), axes (i, j, k)."""
        n = self.dimension
        constants = sp.MutableDenseNDimArray.zeros(n, n, n)
        for (i, j, k), value in self.brackets().items():
            constants[i, j, k], constants[j, i, k] = value, -value
        return sp.ImmutableDenseNDimArray(constants)

    @cached_property
    def sample(self) -> dict[sp.Symbol, sp.Rational]:
        """Values of the symbols in the constants at which signs are read off."""
        occurring = {s for row in self.exact.table.values() for x in row for s in x.symbols}
        return {
            s: sp.Rational(
                Fraction(
                    float(self.exact.field.sample.value(self.exact.field.symbol(s)))
                ).limit_denominator(1000)
            )
            for s in self.exact.field.symbols
            if s in occurring
        }

    def bracket(self, first: Sequence[object], second: Sequence[object]) -> tuple[sp.Expr, ...]:
        """Components of [first, second], from the components of both, shape (n,).

        Raises
        ------
        ShapeError
            One of them does not have n components.

        Examples
        --------
        >>> from geomtorsion.geometry import LieAlgebra
        >>> LieAlgebra({(0, 1, 2): 1}).bracket([1, 0, 0], [0, 3, 5])
        (0, 0, 3)
        """
        read = []
        for name, vector in (("first", first), ("second", second)):
            entries = checks.entries(vector, name, ArgumentError)
            checks.check_one_each(entries, self.dimension, "basis elements", name, ShapeError)
            read.append(self.exact.field.read_all([(name, x) for x in entries]))
        return tuple(x.sympy for x in self.exact.bracket(*read))

    # -- questions -------------------------------------------------------------------------------

    @cached_property
    def killing_form(self) -> sp.ImmutableMatrix:
        """K_ij = C_im^k C_jk^m, shape (n, n)."""
        entries = [x.sympy for row in self.exact.killing for x in row]
        return sp.ImmutableMatrix(self.dimension, self.dimension, entries)

    @cached_property
    def signature(self) -> tuple[int, int, int]:
        """How many squares of the Killing form are positive, negative and zero."""
        return self.exact.signature

    @cached_property
    def derived_series(self) -> tuple[int, ...]:
        """Dimensions of g, [g, g], [[g, g], [g, g]], ... until they no longer fall."""
        return self.exact.derived_dimensions

    @property
    def lower_central_series(self) -> tuple[int, ...]:
        """Dimensions of g, [g, g], [g, [g, g]], ... until they no longer fall."""
        return self.exact.lower_central

    @property
    def center(self) -> int:
        """Dimension of the centre, whose elements commute with all others."""
        return len(self.exact.center)

    @property
    def radical(self) -> int:
        """Dimension of the radical, the largest solvable ideal."""
        return self.exact.radical.rank

    @property
    def is_abelian(self) -> bool:
        """Whether all brackets vanish."""
        return not self.exact.table

    @property
    def is_nilpotent(self) -> bool:
        """Whether the lower central series ends with 0."""
        return self.lower_central_series[-1] == 0

    @property
    def is_solvable(self) -> bool:
        """Whether the derived series ends with 0."""
        return self.derived_series[-1] == 0

    @property
    def is_semisimple(self) -> bool:
        """Whether the Killing form is regular, and the algebra not trivial (Cartan)."""
        return self.dimension > 0 and self.radical == 0

    @cached_property
    def is_unimodular(self) -> bool:
        """Whether C_ik^k = 0: left-invariant volumes are right-invariant."""
        n = range(self.dimension)
        return all(
            vanishes(self.exact.field.sum([(1, self.exact.constant(i, k)[k]) for k in n]))
            for i in n
        )

    @cached_property
    def name(self) -> str:
        """The name of the algebra up to isomorphism, or a description where it has none.

        Examples
        --------
        >>> from geomtorsion.geometry import LieAlgebra
        >>> boosted = {(0, 1, 2): 1, (1, 2, 0): -1, (2, 0, 1): 1}
        >>> LieAlgebra(boosted).name, LieAlgebra({(0, 1, 1): 1, (0, 2, 2): 1}).name
        ('sl(2, R)', 'Bianchi V')
        """
        return algebra_names.name(self.exact)

    @cached_property
    def bianchi(self) -> str | None:
        """Bianchi type, such as "VII_0" or "VI_h, h = -1/4"; None except in three dimensions."""
        return algebra_names.bianchi(self.exact)

    # -- as an object ----------------------------------------------------------------------------

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, LieAlgebra):
            return NotImplemented
        return self.dimension == other.dimension and self.brackets() == other.brackets()

    def __hash__(self) -> int:
        return hash((self.dimension, frozenset(self.brackets().items())))

    def __repr__(self) -> str:
        return f"LieAlgebra: {self.name}, dimension {self.dimension}"

    def __str__(self) -> str:
        return "\n".join([self.heading, *self.lines()])

    @property
    def heading(self) -> str:
        """Name, dimension and Bianchi type in one line."""
        bianchi = self.bianchi
        repeated = bianchi is None or self.name.startswith("Bianchi")
        text = f"{self.name}: dimension {self.dimension}"
        text += "" if repeated else f", Bianchi {bianchi}"
        places = ", ".join(f"{s} = {value}" for s, value in self.sample.items())
        return f"{text} (signs at {places})" if places else text

    def lines(self) -> list[str]:
        """The brackets that do not vanish, the Killing form and the derived series, in words."""
        shown = [
            f"[X_{i}, X_{j}] = {self._sum(row)}" for (i, j), row in sorted(self.exact.table.items())
        ]
        positive, negative, zero = self.signature
        series = ", ".join(map(str, self.derived_series))
        return [
            *(shown or ["all brackets vanish"]),
            f"Killing form: {positive} positive, {negative} negative, {zero} zero",
            f"derived series: {series}",
        ]

    def _sum(self, row: Vector) -> str:
        """Components as a sum of basis elements."""
        text = ""
        for k, x in enumerate(row):
            if vanishes(x):
                continue
            value = str(x.sympy)
            if isinstance(x.sympy, sp.Add):
                value = f"({value})"
            minus = value.startswith("-")
            size = value[minus:]
            joint = (" - " if minus else " + ") if text else "-" * minus
            text += joint + (f"X_{k}" if size == "1" else f"{size}*X_{k}")
        return text

    _repr_html_ = drawn_by("notebook_tables", "algebra_html")


def _made_again(dimension: int, brackets: dict[tuple[int, int, int], sp.Expr]) -> LieAlgebra:
    """An algebra from its plain brackets."""
    free = sorted({s for x in brackets.values() for s in x.free_symbols}, key=str)
    field = Field(free)
    table: dict[tuple[int, int], Vector] = {}
    for (i, j, k), value in brackets.items():
        row = table.setdefault((i, j), [field.zero] * dimension)
        row[k] = field.read(value)
    return LieAlgebra.of(Brackets.of(field, dimension, table))

"""Reduced split: the legs along coordinates that do not occur, with what belongs to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from geomtorsion.exact.engine_code import Products
from geomtorsion.geometry.matrices import inverse
from geomtorsion.motion.reduced.system import Reduced, gathered

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Frame
    from geomtorsion.motion.equations import Equations
    from geomtorsion.motion.laws import Momenta

Pairs = Mapping[tuple[int, int], "Element"]
HALF = Fraction(1, 2)


@dataclass(frozen=True, eq=False)
class Single:
    """What belongs to one coordinate.

    place, symbol: of the coordinate; weight: A; rest: W with the names of constants.
    root: h; state, constant: names of v and c.
    """

    place: int
    symbol: Any
    weight: Element
    rest: Products
    root: Element
    state: str
    constant: str

    @property
    def factor(self) -> Element:
        """v over p."""
        return self.root * self.weight

    @property
    def square(self) -> Products:
        """Q, with names of constants."""
        cleared = self.root * self.root * self.weight
        rest = ((value * -cleared, names) for value, names in self.rest)
        return ((cleared, (self.constant,)), *rest)

    @property
    def value(self) -> Products:
        """c, as a sum of products of v and constants."""
        above = self.root * self.root * self.weight
        return ((1 / above, (self.state, self.state)), *self.rest)


@dataclass(frozen=True, eq=False)
class Written:
    """A smaller system, and how it hangs together with the full one.

    system: states are coordinates, then momenta; parameters are the old ones, then constants.
    width: number of coordinates.
    momenta: those that are states, as sums over the full states.
    constants: name -> sum over full states; mixtures: name -> products of constants.
    velocities: for each u^i the sum over states and constants that gives it.
    along: legs along cyclic coordinates alone.
    singles: coordinates that have a constant each.
    """

    system: Reduced
    width: int
    momenta: tuple[Products, ...]
    constants: Mapping[str, Products]
    mixtures: Mapping[str, Products]
    velocities: tuple[Products, ...]
    along: tuple[int, ...]
    singles: tuple[Single, ...] = ()

    @property
    def separators(self) -> dict[str, Products]:
        """Name -> a further constant as a sum over coordinates, momenta and constants."""
        return {one.constant: one.value for one in self.singles}


@dataclass(frozen=True, eq=False)
class Split:
    """Legs along cyclic coordinates alone, and all that is needed to write them.

    along: those legs; others: the rest.
    lower, upper: G and its inverse where they do not vanish.
    cyclic: places of the coordinates that do not occur.
    names: of the momenta, by the place of the coordinate.
    norm: name of G_ij u^i u^j.
    """

    equations: Equations
    frame: Frame
    along: tuple[int, ...]
    others: tuple[int, ...]
    lower: Pairs
    upper: Pairs
    cyclic: tuple[int, ...]
    names: Mapping[int, str]
    norm: str

    @classmethod
    def of(cls, equations: Equations, momenta: Momenta) -> Split | None:
        """The legs along cyclic coordinates, if there are any that G does not tie to others."""
        frame, cyclic = momenta.frame, momenta.cyclic
        n = frame.dimension
        lower = {(i, j): x for i, row in enumerate(momenta.lower) for j, x in row}
        along = set(range(n))
        along -= {i for mu, i in frame.legs.components.nonzero if mu not in cyclic}
        while tied := {i for i, j in lower if i in along and j not in along}:
            along -= tied
        if not along or len(along) == n:
            return None
        taken = {*equations.system.states, *equations.system.parameters}
        taken |= {symbol.name for symbol in frame.field.symbols}
        names = {mu: free_name(f"p_{frame.coordinates[mu].name}", taken) for mu in range(n)}
        others = tuple(i for i in range(n) if i not in along)
        upper = inverse(frame.field, lower, n)
        norm = free_name("norm", taken)
        return cls(
            equations, frame, tuple(sorted(along)), others, lower, upper, cyclic, names, norm
        )

    def momentum(self, mu: int) -> Products:
        """p_mu = e^i_mu G_ij u^j."""
        u, found = self.equations.velocities, {}
        for (i, nu), value in self.frame.coframe.components.nonzero.items():
            if nu == mu:
                for (row, j), entry in self.lower.items():
                    if row == i:
                        found.setdefault((u[j],), []).append((1, value, entry))
        return gathered(found)

    @property
    def square(self) -> Products:
        """G_ij u^i u^j."""
        u = self.equations.velocities
        return tuple((x, (u[i], u[j])) for (i, j), x in self.lower.items())

    def leg(self, i: int) -> dict[int, Element]:
        """E_i^mu by mu."""
        nonzero = self.frame.legs.components.nonzero
        return {mu: value for (mu, j), value in nonzero.items() if j == i}

    def velocity(self, i: int, names: Mapping[int, str]) -> Products:
        """u^i = G^ik E_k^mu p_mu, with names for the momenta."""
        found: dict[tuple[str, ...], list[Any]] = {}
        for (row, k), weight in self.upper.items():
            if row == i:
                for mu, value in self.leg(k).items():
                    found.setdefault((names[mu],), []).append((1, weight, value))
        return gathered(found)

    @property
    def constants(self) -> dict[str, Products]:
        """The momenta of cyclic coordinates."""
        return {self.names[mu]: self.momentum(mu) for mu in self.cyclic}


def free_name(name: str, taken: set[str]) -> str:
    """A name that nothing else has."""
    while name in taken:
        name += "_"
    return name

"""Grain circuits: closed paths from atom to atom in a polycrystal, each within one grain."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals.circuits import AtomCircuit, AtomCircuits
from geomtorsion.materials.crystals.grains import Grains, Nowhere
from geomtorsion.support import checks


@dataclass(frozen=True, eq=False)
class GrainCircuits:
    """Makes circuits in a polycrystal, as `AtomCircuits` does in a single crystal.

    whole: of all atoms. grains: the grain of each atom. single: circuits in each single grain.

    A circuit through a wall has no Burgers vector: bonds there are vectors of neither lattice.
    """

    whole: AtomCircuits
    grains: Grains
    single: Callable[[int], AtomCircuits]

    def __call__(self, atoms: Sequence[int]) -> AtomCircuit:
        """The circuit through atoms of one grain, from each to the nearest image of the next.

        Raises
        ------
        CrystalError
            As in a single crystal, or atoms are in two grains or in none.
        """
        last = len(self.grains.number) - 1
        numbers = [
            checks.count(k, f"atoms[{j}]", CrystalError, 0, last)
            for j, k in enumerate(checks.entries(checks.rows(atoms), "atoms", CrystalError))
        ]
        number = self._one_grain(numbers)
        inside = self.grains[number].atoms
        return self._named(number, self.single(number)(np.searchsorted(inside, numbers).tolist()))

    def around(self, point: ArrayLike, normal: ArrayLike, radius: float) -> AtomCircuit:
        """The circuit along a circle within one grain; as in a single crystal.

        Raises
        ------
        CrystalError
            As in a single crystal, or the circle meets a wall.
        """
        rim = self.whole.rim(point, normal, radius)
        number = self._one_grain([self.whole.nearest(place)[0] for place in rim])
        return self._named(number, self.single(number).around(point, normal, radius))

    def _one_grain(self, atoms: Sequence[int]) -> int:
        """The common grain of all these atoms."""
        atom = {int(self.grains.number[k]): k for k in reversed(atoms)}
        inside = sorted(number for number in atom if number >= 0)
        if len(inside) > 1:
            one, other = inside[:2]
            how = self.grains.wall(one, other).description
            raise CrystalError(
                f"expected a circuit within one grain, got atom {atom[one]} in grain {one} and "
                f"atom {atom[other]} in grain {other}, {how}. Lead the circuit through one of "
                "them: it cannot cross the wall between them."
            )
        if len(inside) < len(atom):
            code = max(number for number in atom if number < 0)
            where = "a region without a lattice"
            if code == Nowhere.wall:
                where = self._where(atom[code])
            raise CrystalError(
                f"expected a circuit within one grain, got atom {atom[code]} in {where}. Lead "
                "the circuit through a grain."
            )
        if not inside:
            raise CrystalError("atoms: expected three or more different atoms, got none.")
        return inside[0]

    def _where(self, atom: int) -> str:
        """The wall that contains an atom, in words."""
        for wall in self.grains.walls:
            if (wall.atoms == atom).any():
                one, other = wall.grains
                return f"the wall between grains {one} and {other}, {wall.description}"
        return "a wall"

    def _named(self, number: int, circuit: AtomCircuit) -> AtomCircuit:
        """The circuit with the atom numbers of the polycrystal."""
        inside = self.grains[number].atoms
        return replace(circuit, atoms=tuple(int(inside[k]) for k in circuit.atoms))

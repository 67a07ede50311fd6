"""Method: the lengths and shares that decide what belongs to a core, all in one place."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians


@dataclass(frozen=True)
class Method:
    """Values that decide where a crystal ends and how lines are drawn; b depends on none of them.

    reach: radius of the largest empty sphere of a crystal with a vacancy in it, in neighbour
        distances; a larger sphere is a void, or is outside.
    uneven: share of that radius beyond which the other atoms leave an atom at a surface. A share up
        to the sphere of a single vacancy (one neighbour distance or two thirds of the radius) would
        take cores for surfaces; the whole radius would miss surfaces with a step or an edge.
    jitter: share of that radius by which atoms are moved, so that those on exact lattice sites have
        one Delaunay triangulation, the same in every image.
    sound: factor on the length of a line through triangles without torsion and doubt, so that lines
        stay where the crystal is torn.
    width: of a core, in neighbour distances: lines have no shorter waves, closed lines no
        wider than this are point defects, nearer junctions are one.
    wall: least misorientation of two grains, rad: a smaller one is a row of dislocations, a larger
        one a wall (the usual limit, [Brandon1966]: their cores, b/wall = 4 b apart, then touch).
    strain: a lattice constant further than this from the one of the atoms has other units or
        belongs to another lattice: perfect metals yield at shears of 1 / 2 pi [HirthLothe1982].
    share: at most this share of the atoms of a liquid have neighbours like those in a crystal.
    least: where fewer atoms fit, lines are missed: of diamond in noise of 12 % of the neighbour
        distance, the most that is promised, 1.5 % fit.
    places: in a crystal with so much noise that hardly an atom fits, more than this share of atoms
        have another atom near each neighbour place; in a gas up to a seventh have, by chance.
    crowd: atoms with more than so many times the neighbours of the lattice belong to a lattice with
        more atoms: one more in two cells of diamond, as in fluorite, is half as many more.
    sigma: a deformation counts if it is more than so many standard errors: atoms around a line
        deviate together, so that three, which noise by itself needs, are too few.
    seeds, sample: number of atoms that suggest an orientation, and number of atoms that decide.
    together: number of atoms that are processed together; it affects memory, not values.
    """

    reach: float = 1.5
    uneven: float = 0.8
    jitter: float = 1e-5
    sound: float = 2.0
    width: float = 2.0
    wall: float = radians(15)
    strain: float = 0.15
    share: float = 0.1
    least: float = 0.01
    places: float = 0.25
    crowd: float = 1.25
    sigma: float = 5.0
    seeds: int = 16
    sample: int = 2000
    together: int = 2**16


METHOD = Method()

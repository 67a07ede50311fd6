"""latex: components as aligned equations, ready for a document."""

from __future__ import annotations

from collections.abc import Sequence

from geomtorsion.pictures.quantities import Quantity
from geomtorsion.pictures.sections import aligned
from geomtorsion.spaces.space import Space


def latex_of(space: Space, quantities: Sequence[Quantity], *, every: bool = False) -> str:
    """One align* environment for each quantity; needs amsmath."""
    parts = [f"% {space.name}: {space.title}\n% needs \\usepackage{{amsmath}}"]
    parts += [aligned(chosen, every=every) for chosen in quantities]
    return "\n\n".join(parts)

"""Map phases: phases from files of orientation maps, with corrections by the user."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from geomtorsion.errors import FileFormatError, OrientationError
from geomtorsion.materials.maps.phases import Phase
from geomtorsion.support.checks import shown

# Numbers of Laue groups in files of Oxford Instruments.
LAUE_NUMBERS: dict[float, str] = dict(
    enumerate(
        "-1 2/m mmm 4/m 4/mmm -3 -3m 6/m 6/mmm m-3 m-3m".split(),
        start=1,
    )
)


def described(
    where: str,
    number: int,
    name: str,
    laue: str | None,
    given: Mapping[int, str],
    lattice: tuple[Sequence[float], Sequence[float]] = ((0.0, 0.0, 0.0), (90.0, 90.0, 90.0)),
    horizontal: str = "x",
) -> Phase:
    """A phase with the Laue group given by the user, or otherwise by the file.

    where: position in the file, for messages. lattice: lengths and angles. horizontal: as in
    `Phase`.

    Raises
    ------
    FileFormatError
        The symmetry is given neither by the user nor by the file, or the lattice is invalid.
    """
    group = given.get(number, given.get(0, laue))
    if group is None:
        raise FileFormatError(
            f"{where}: phase {number} ({name}): its symmetry is not known. Give it, for example "
            f'laue={{{number}: "m-3m"}} (--laue).'
        )
    lengths, angles = ((float(x[0]), float(x[1]), float(x[2])) for x in lattice)
    try:
        return Phase(name, group, lengths, angles, horizontal)
    except OrientationError as error:
        raise FileFormatError(f"{where}: {error}") from None


def check_laue(name: str, laue: Mapping[int, str], phases: Mapping[int, Phase]) -> None:
    """Refuse Laue groups for phases that are not in the file."""
    for number in laue:
        if number not in (0, *phases):
            raise FileFormatError(
                f"{name}: laue: expected numbers of phases in the file "
                f"({', '.join(map(str, phases))}), got {shown(number)}. Use one of these."
            )


def whole_phases(
    name: str, phase: np.ndarray, phases: Mapping[int, Phase], start: int | None = None
) -> np.ndarray:
    """Phase numbers as whole numbers; phases that the file does not describe are refused.

    start: line of the first point, counted from 1; None for binary files.
    """
    unknown = ~np.isin(phase, [0, *phases])
    if unknown.any():
        k = int(np.argmax(unknown))
        choices = ", ".join(f"{n} ({p.name})" for n, p in phases.items()) or "none"
        place = f"point {k + 1}" if start is None else f"line {start + k}"
        raise FileFormatError(
            f"{name}: {place}: expected a phase in the header ({choices}) or 0 for a pixel without "
            f"an orientation, got {phase[k]:g}. Correct it, or describe the phase."
        )
    return phase.astype(np.int64)

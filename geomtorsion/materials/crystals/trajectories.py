"""Trajectories: reports of all frames of a file, kept one by one so that a run can resume."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from geomtorsion.errors import CheckpointError, GeomtorsionError
from geomtorsion.materials.crystals.atom_files import (
    atom_frames,
    frame_count,
    is_atom_array,
    read_atom_array,
)
from geomtorsion.materials.crystals.atom_rows import AtomData
from geomtorsion.materials.crystals.crystal import Crystal
from geomtorsion.materials.crystals.known_grains import KnownGrains
from geomtorsion.materials.crystals.plane_crystal import PlaneCrystal
from geomtorsion.materials.crystals.reading import crystal_of
from geomtorsion.materials.crystals.reports import Json, crystal_report, known_of, plane_report
from geomtorsion.materials.lines import DislocationNetwork
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import LARGEST_ARRAYS
from geomtorsion.support.files import digest_of, read_json_text, read_text, write_text, written
from geomtorsion.support.npz import mapped_npy

SETTINGS = "settings.json"


@dataclass(frozen=True)
class Wanted:
    """Settings for every frame.

    lattice, orient (rows), constant, form: as for `read`. partials: as for `dislocations`.
    convention: of the sign of b. cell, periodic: of arrays, as for `read_atom_array`. species: of
    the atoms to keep; all if None.
    """

    lattice: str | None = None
    orient: tuple[tuple[float, ...], ...] | None = None
    constant: float | None = None
    form: str | None = None
    partials: bool = False
    convention: str = "SF/RH"
    cell: tuple[tuple[float, ...], ...] | None = None
    periodic: tuple[bool, bool, bool] | None = None
    species: tuple[str, ...] | None = None


def reports(
    path: Path,
    wanted: Wanted,
    folder: Path | None = None,
    seen: Callable[[float, int, str], object] = lambda done, total, what: None,
) -> Iterator[tuple[Json, Callable[[], DislocationNetwork | PlaneCrystal]]]:
    """The report of each frame, and a function that returns its lines, or its atoms in a plane.

    Parameters
    ----------
    folder
        Where reports are kept, one file a frame. Existing reports are used unchanged, so that a
        run that was killed gives the same bits.
    seen
        Called with the number of finished frames (also halves), the number of all, and the next
        step: lattice or lines.

    Raises
    ------
    CheckpointError
        The folder holds reports of another file or of other settings.
    """
    is_array = is_atom_array(path)
    total = 1 if is_array else frame_count(path, wanted.form)
    settings = "" if folder is None else _settings(path, wanted, folder)
    grains = None
    frames = iter([_atoms(path, wanted)]) if is_array else atom_frames(path, wanted.form)
    for number, data in enumerate(frames):
        frame = _Frame(data.chosen(wanted.species), wanted, grains)
        file = None if folder is None else folder / f"{number:06}.json"
        if file is not None and file.exists():
            report = read_json_text(read_text(file, LARGEST_ARRAYS), file.name)
            if "points" not in report:
                grains = known_of(report, _owner(file, report))
        else:
            seen(number, total, "lattice")
            if isinstance(frame.crystal, Crystal):
                _ = frame.crystal.frame
            seen(number + 0.5, total, "lines")
            report = {"frame": number, **frame.report()}
            if isinstance(frame.crystal, Crystal):
                grains = KnownGrains.of(frame.crystal.grains)
            if file is not None:
                # A run that fails in its first frame leaves no files, so that it can be corrected.
                with written(file.parent, is_folder=True):
                    write_text(file.with_name(SETTINGS), settings)
                if "grains" in report and grains is not None:
                    with written(file.with_suffix(".npy")) as part, part.open("wb") as stream:
                        np.save(stream, grains.owner)
                # The report is written last: where it exists, all files of its frame do.
                write_text(file, json.dumps(report))
        seen(number + 1, total, "lines")
        yield report, frame.drawn


def _atoms(path: Path, wanted: Wanted) -> AtomData:
    """The single frame of an array."""
    cell = None if wanted.cell is None else np.array(wanted.cell)
    return read_atom_array(path, cell, wanted.periodic)


class _Frame:
    """A frame whose crystal is made on first use."""

    def __init__(self, data: AtomData, wanted: Wanted, known: KnownGrains | None) -> None:
        self.data, self.wanted, self.known = data, wanted, known

    @cached_property
    def crystal(self) -> Crystal | PlaneCrystal:
        """The crystal in the axes of the frames before."""
        options, orient = self.wanted, self.wanted.orient
        axes = None if orient is None else np.array(orient)
        return crystal_of(self.data, options.lattice, axes, options.constant, self.known)

    @cached_property
    def defects(self) -> DislocationNetwork | PlaneCrystal:
        """The lines of the frame, or the atoms in a plane, whose dislocations are points."""
        if isinstance(self.crystal, PlaneCrystal):
            return self.crystal
        return self.crystal.dislocations(self.wanted.partials)

    def drawn(self) -> DislocationNetwork | PlaneCrystal:
        """The defects of the frame, as a method."""
        return self.defects

    def report(self) -> Json:
        """The report of the frame."""
        defects, convention = self.defects, self.wanted.convention
        if isinstance(defects, PlaneCrystal):
            return plane_report(defects, convention)
        assert isinstance(self.crystal, Crystal)
        return crystal_report(self.crystal, defects, convention)


def _owner(kept: Path, report: Json) -> np.ndarray:
    """The grain of each atom of a kept frame."""
    count = report["atoms"]
    if "grains" not in report:
        return np.zeros(count, dtype=np.int64)
    file = kept.with_suffix(".npy")
    try:
        owner = mapped_npy(file)
    except (OSError, ValueError, EOFError):
        owner = np.zeros(0)
    if owner.shape != (count,) or owner.dtype != np.int64:
        raise CheckpointError(
            f"{file}: expected the grain of each of {count:,} atoms, got a file that is missing or "
            "damaged. Restart with --overwrite."
        )
    return owner


def _settings(path: Path, wanted: Wanted, folder: Path) -> str:
    """File and settings of the reports in a folder, checked against its note."""
    settings = {"file": path.name, "digest": digest_of(path), **asdict(wanted)}
    text, note = json.dumps(settings, indent=1), folder / SETTINGS
    if note.exists() and read_text(note) != text:
        raise CheckpointError(
            f"{folder}: expected frames of this file with these settings, got frames of another "
            f"file or of other settings. Use the settings in {note}, or another directory."
        )
    return text


def is_begun(folder: Path) -> bool:
    """Whether a folder holds reports of a run."""
    return (folder / SETTINGS).exists()


def forget(folder: Path) -> None:
    """Remove the reports of a run, and nothing else."""
    files = [*folder.glob("[0-9]" * 6 + ".json"), *folder.glob("[0-9]" * 6 + ".npy")]
    for file in (*sorted(files), folder / SETTINGS):
        file.unlink(missing_ok=True)
    try:
        folder.rmdir()
    except OSError as error:
        raise GeomtorsionError(
            f"{folder}: expected a directory with only reports, got one that cannot be removed "
            f"({error.strerror}). Move other files out of it, or name another directory."
        ) from None

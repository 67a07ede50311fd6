"""Trajectories: reports of all frames of a file, kept one by one so that a run can go on."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from geomtorsion.checks import LARGEST_ARRAYS
from geomtorsion.crystals.atom_files import AtomData, atom_frames, frame_count
from geomtorsion.crystals.crystal import Crystal
from geomtorsion.crystals.reading import crystal_of
from geomtorsion.crystals.reports import Json, crystal_report
from geomtorsion.errors import CheckpointError, GeomtorsionError
from geomtorsion.files import read_json_text, read_text
from geomtorsion.loops import DislocationNetwork

SETTINGS = "settings.json"


@dataclass(frozen=True)
class Wanted:
    """What is asked of every frame.

    lattice, orient (rows), constant, form: as for `read`. partials: as for `dislocations`.
    convention: of the sign of b.
    """

    lattice: str | None = None
    orient: tuple[tuple[float, ...], ...] | None = None
    constant: float | None = None
    form: str | None = None
    partials: bool = False
    convention: str = "SF/RH"


def reports(
    path: Path,
    wanted: Wanted,
    folder: Path | None = None,
    seen: Callable[[int, int], object] = lambda done, total: None,
) -> Iterator[tuple[Json, Callable[[], DislocationNetwork]]]:
    """The report of each frame, and a function that gives its lines.

    Parameters
    ----------
    folder
        Where reports are kept, one file a frame. What lies there is taken as it is, so that a run
        that was killed gives the same bits.
    seen
        Called with the frames that are done and how many there are.

    Raises
    ------
    CheckpointError
        The folder holds reports of another file or of other settings.
    """
    total = frame_count(path, wanted.form)
    if folder is not None:
        _prepared(path, wanted, folder)
    axes = wanted.lattice, wanted.orient, wanted.constant
    for number, data in enumerate(atom_frames(path, wanted.form)):
        seen(number, total)
        frame = _Frame(data, axes, wanted.partials)
        kept = None if folder is None else folder / f"{number:06}.json"
        if kept is not None and kept.exists():
            report = read_json_text(read_text(kept, LARGEST_ARRAYS), kept.name)
        else:
            report = {"frame": number, **frame.report(wanted.convention)}
            if kept is not None:
                _write(kept, json.dumps(report))
        axes = report["lattice"], report["orient"], report["constant"]
        yield report, frame.lines
    seen(total, total)


class _Frame:
    """A frame whose crystal is made when it is first asked for."""

    def __init__(self, data: AtomData, axes: tuple[Any, Any, Any], partials: bool) -> None:
        self.data, self.axes, self.partials = data, axes, partials

    @cached_property
    def crystal(self) -> Crystal:
        """The crystal in the axes of the frames before."""
        return crystal_of(self.data, *self.axes)

    @cached_property
    def network(self) -> DislocationNetwork:
        """Its lines."""
        return self.crystal.dislocations(self.partials)

    def lines(self) -> DislocationNetwork:
        """Its lines, as a function."""
        return self.network

    def report(self, convention: str) -> Json:
        """What is found in it."""
        return crystal_report(self.crystal, self.network, convention)


def _prepared(path: Path, wanted: Wanted, folder: Path) -> None:
    """Note what the reports in a folder are of, or check that it is the same."""
    said = {"file": path.name, "bytes": path.stat().st_size, **asdict(wanted)}
    text = json.dumps(said, indent=1)
    note = folder / SETTINGS
    if not note.exists():
        folder.mkdir(parents=True, exist_ok=True)
        _write(note, text)
    elif read_text(note) != text:
        raise CheckpointError(
            f"{folder} holds frames of another file or of other settings. Give those that stand in "
            f"{note}, or begin anew in another directory."
        )


def is_begun(folder: Path) -> bool:
    """Whether reports of a run lie in a folder."""
    return (folder / SETTINGS).exists()


def forget(folder: Path) -> None:
    """Remove the reports of a run, and nothing else."""
    for file in (*sorted(folder.glob("[0-9][0-9][0-9][0-9][0-9][0-9].json")), folder / SETTINGS):
        file.unlink(missing_ok=True)
    try:
        folder.rmdir()
    except OSError as error:
        raise GeomtorsionError(f"{folder}: it holds other files, which stay: {error}") from None


def _write(target: Path, text: str) -> None:
    """A file that is whole or not there."""
    half = target.with_suffix(".part")
    half.write_text(text, "utf-8")
    half.replace(target)

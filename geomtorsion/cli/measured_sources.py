"""measured_sources: the file of measured data that a name on the command line means."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geomtorsion import spaces
from geomtorsion.errors import (
    FileFormatError,
    GeomtorsionError,
    GridError,
    ImageError,
    OrientationError,
)
from geomtorsion.geometry import Frame
from geomtorsion.materials import Source
from geomtorsion.materials.readers import open_source
from geomtorsion.support.checks import shown
from geomtorsion.support.files import UNSIGNED, plain_float

# Options that begin messages of the library, without the dashes of the command line.
OPTIONS = tuple(
    "sigma threshold order missing columns slice laue slip size plane spots resolution blocks "
    "steps workers".split()
)
_SIZE = re.compile(rf"({UNSIGNED})\s*([^0-9.].*)?")


@dataclass(frozen=True)
class Reading:
    """Options for reading a measured file, as typed."""

    sigma: str | None = None
    threshold: float | None = None
    order: int | None = None
    laue: Sequence[str] = ()
    slip: str | None = None
    pixel: str | None = None
    spots: str | None = None
    resolution: float | None = None
    missing: Sequence[float] = ()
    columns: str | None = None
    slice: str | None = None

    @property
    def given(self) -> dict[str, object]:
        """The typed options, by name."""
        return {f"--{name}": value for name, value in vars(self).items() if value not in (None, ())}


def opened(source: str, reading: Reading) -> Source:
    """The source in a file; errors about an option name it as typed."""
    if source in spaces.names() and not Path(source).exists():
        raise FileFormatError(
            f"{source}: expected a file of measured data, got a shipped space. Use `geomtorsion "
            f"burgers {source} --circle CENTRE:RADIUS` for its loops."
        )
    value = None if reading.sigma is None else sigma_of(reading.sigma)
    try:
        return open_source(
            source,
            sigma=value,
            threshold=reading.threshold,
            order=reading.order,
            laue=_symmetries(reading.laue),
            slip=reading.slip,
            pixel=None if reading.pixel is None else _pixel(reading.pixel),
            spots=None if reading.spots is None else _spots(reading.spots),
            resolution=reading.resolution,
            missing=reading.missing or None,
            columns=None if reading.columns is None else columns_of(reading.columns),
            slice=None if reading.slice is None else _number_or_name(reading.slice),
        )
    except (GridError, OrientationError, ImageError) as error:
        raise dashed(error) from None


def dashed(error: GeomtorsionError) -> GeomtorsionError:
    """The same error; if it begins with the name of an option, the option as typed."""
    return type(error)(f"--{error}") if str(error).startswith(OPTIONS) else error


def columns_of(text: str) -> dict[str, int | str]:
    """Columns of a table by quantity, from QUANTITY=COLUMN,...; a column of digits is a number."""
    columns: dict[str, int | str] = {}
    for part in text.split(","):
        key, equals, column = (word.strip() for word in part.partition("="))
        if not (key and equals and column) or key in columns:
            raise GridError(
                f"--columns: expected QUANTITY=COLUMN,..., each quantity once, got {shown(text)}. "
                "Write --columns x=0,y=1,exx=strain_xx; columns count from 0."
            )
        columns[key] = _number_or_name(column)
    return columns


def _number_or_name(text: str) -> int | str:
    """A whole number from a text of digits, or the text."""
    return int(text) if text.isdecimal() and text.isascii() and len(text) < 10 else text


def _pixel(text: str) -> tuple[float, str]:
    """Size and unit of a pixel."""
    size = _SIZE.fullmatch(text.strip())
    if size is None or not 0 < float(size[1]) < np.inf:
        raise ImageError(
            f"--pixel: expected a positive size with its unit, got {shown(text)}. Write "
            "--pixel 0.03nm."
        )
    return float(size[1]), (size[2] or "").strip() or "px"


def _spots(text: str) -> list[list[float]]:
    """Two Bragg spots."""
    try:
        return [[plain_float(x) for x in part.split(",")] for part in text.split(";")]
    except ValueError:
        raise ImageError(
            f"--spots: expected two spots in cycles per unit, got {shown(text)}. Write --spots "
            "'4,0;0,4'."
        ) from None


def _symmetries(texts: Sequence[str]) -> dict[int, str]:
    """Number of a phase -> Laue group, from PHASE=GROUP."""
    groups = {}
    for text in texts:
        number, equals, group = text.partition("=")
        if not equals or not number.strip().isdecimal() or len(number) > 9:
            raise OrientationError(
                f"--laue: expected PHASE=GROUP, got {shown(text)}. Write --laue 1=m-3m."
            )
        groups[int(number)] = group.strip()
    return groups


def sigma_of(text: str) -> float | str:
    """A number, or the word that asks for an estimate."""
    if text == "estimate":
        return text
    try:
        return plain_float(text)
    except ValueError:
        raise GridError(
            f"--sigma: expected a number of 0 or more, or estimate, got {shown(text)}. Write "
            "--sigma 0.001, or omit it."
        ) from None


def identity_frame(names: Sequence[str]) -> Frame:
    """A frame whose coordinates are the axes, by which loops name their plane."""
    return Frame(" ".join(names), np.eye(len(names), dtype=int).tolist())

"""map circuits: square circuits in an uploaded map or image, with errors and a picture."""

from __future__ import annotations

from collections.abc import Sequence

from geomtorsion.errors import FileFormatError, GeomtorsionError
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.maps import MapPicture, UploadedMap, uploaded
from geomtorsion.teaching.lab.plot import plane, svg
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.uploads import read_map, title_of
from geomtorsion.teaching.texts import ENGLISH

# Bright with a dark edge: visible on every colour of the map.
LINE, EDGE, UNKNOWN = "#ffffff", "#a3201a", "#cdd0d5"


def map_facts(
    content: bytes,
    name: str,
    threshold: float | None = None,
    phase: int = 0,
    laue: str = "",
    language: str = ENGLISH,
) -> Json:
    """Description of a map, and the possible positions of circuits in it.

    Parameters
    ----------
    content
        The bytes of the file, which determine its format.
    name
        Of the file, for messages.
    threshold, phase, laue
        For orientation maps: least angle between grains, degrees; the displayed phase, 0 for all;
        its Laue group, empty for the group in the file.
    language
        of the description.

    Returns
    -------
    sentence: description. shape: nodes along x and y. starts, steps: coordinates of the first node
    and differences to the next, in `unit`. names: of the axes. middle, side: of the first circuit,
    numbers of nodes and of cells; most: largest number of cells of a side. settings: options for
    reading the file. problem: why the file can only be read with another option.

    Raises
    ------
    GeomtorsionError
        The file has a format that the page does not read.

    Examples
    --------
    >>> import numpy as np
    >>> rows = ["x,y,e_0_0,e_0_1"]
    >>> rows += [f"{x},{y},{-y / 2},{x / 2}" for x in range(9) for y in range(8)]
    >>> text = "\\n".join(rows).encode()
    >>> found = map_facts(text, "a.csv")
    >>> found["shape"], found["middle"], found["side"], found["most"]
    ([9, 8], [4, 4], 1, 7)
    """
    title = title_of(name)
    problem = ""
    try:
        upload = _read(content, title, threshold, phase, laue, language)
    except FileFormatError as error:
        # The file may be readable if some symmetry is assumed for its phases.
        if laue or "its symmetry is not known" not in str(error):
            raise
        upload = _read(content, title, threshold, 0, "-1", language)
        problem = f"{str(error).partition(' Give it')[0]} Choose a Laue group below."
    layout = upload.layout
    most = min(layout.shape) - 1
    facts = {
        "sentence": upload.text("file", file=title, description=upload.description),
        "unit": layout.unit,
        "shape": list(layout.shape),
        "starts": list(layout.starts),
        "steps": list(layout.steps),
        "names": list(layout.names),
        "middle": [n // 2 for n in layout.shape],
        "side": max(upload.least, min(layout.shape) // PAGE.parts),
        "least": upload.least,
        "most": most,
        "settings": upload.settings,
    }
    return facts | {"problem": problem} if problem else facts


def map_circuit(
    content: bytes,
    name: str,
    centre: Sequence[int],
    side: int,
    threshold: float | None = None,
    phase: int = 0,
    laue: str = "",
    language: str = ENGLISH,
) -> Json:
    """A square circuit in a map, and |b| per area of all circuits of its size.

    Parameters
    ----------
    content, name, threshold, phase, laue, language
        As for `map_facts`.
    centre
        The node at its centre, numbers along x and y from 0.
    side
        Cells along its side.

    Returns
    -------
    picture: svg, the map and its scale. refused: why the circuit has no b, if it has none.
    Otherwise sentence, table: text and HTML; b, noise: by component; interpolation; unit.

    Raises
    ------
    GeomtorsionError
        The file has a format that the page does not read, or the side is longer than the map.

    Examples
    --------
    >>> rows = ["x,y,e_0_0,e_0_1"]
    >>> rows += [f"{x},{y},{-y / 2},{x / 2}" for x in range(9) for y in range(8)]
    >>> found = map_circuit("\\n".join(rows).encode(), "a.csv", [4, 4], 3)
    >>> [round(x, 9) for x in found["b"]]
    [9.0]
    """
    upload = _read(content, title_of(name), threshold, phase, laue, language)
    corner = [int(k) - int(side) // 2 for k in centre]
    reply: dict[str, object] = {"picture": _picture(upload, upload.picture(side), corner, side)}
    try:
        return {**reply, **upload.circuit(corner, side)}
    except GeomtorsionError as error:
        return {**reply, "refused": str(error)}


def _read(
    content: bytes, title: str, threshold: float | None, phase: int, laue: str, language: str
) -> UploadedMap:
    """The content of the file, read with the chosen options."""
    data = read_map(content, title, threshold, (laue, phase) if laue else None)
    return uploaded(data, phase, language)


def _picture(found: UploadedMap, shown: MapPicture, corner: Sequence[int], side: int) -> str:
    """The map with the circuit; beside it the scale."""
    layout, text = found.layout, found.text
    (x, y), (dx, dy) = layout.starts, layout.steps
    one, two = (
        text("in_unit", label=name, unit=layout.unit) if layout.unit else name
        for name in layout.names
    )
    figure, axes = plane(shown.title, (one, two), equal=True)
    # A figure exists only if matplotlib is installed.
    from matplotlib import colormaps
    from matplotlib.patches import Patch

    def at(i: float, k: float) -> tuple[float, float]:
        return x + dx * i, y + dy * k

    # For an even side, a value belongs to the centre node, and covers one step around it.
    shift = 0.5 * (shown.side % 2)
    last = (layout.shape[0] - 0.5 + shift, layout.shape[1] - 0.5 + shift)
    ends = zip(at(shift - 0.5, shift - 0.5), at(*last), strict=True)
    (left, right), (bottom, top) = (sorted(pair) for pair in ends)
    image = axes.imshow(
        shown.pixels, origin="lower", extent=(left, right, bottom, top), interpolation="none",
        cmap=colormaps["viridis"].with_extremes(bad=UNKNOWN), vmin=0.0, zorder=2,
    )  # fmt: skip
    if shown.pixels.ndim == 2:
        figure.colorbar(image, ax=axes, shrink=0.86, label=shown.unit)
        grey = Patch(color=UNKNOWN, label=text("no_value"))
        figure.legend(handles=[grey], loc="outside lower center", frameon=False)
    i, k = corner
    square = [at(i, k), at(i + side, k), at(i + side, k + side), at(i, k + side), at(i, k)]
    for color, width in ((EDGE, 4.0), (LINE, 1.8)):
        axes.plot(*zip(*square, strict=True), color=color, linewidth=width, gid="circuit")
    return svg(figure, text.language)

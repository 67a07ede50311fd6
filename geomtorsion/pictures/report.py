"""report: the whole geometry of a space as one page and as data, in a directory."""

from __future__ import annotations

import json
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from geomtorsion.pictures.page import page
from geomtorsion.pictures.quantities import chosen_quantities, geometry_data
from geomtorsion.pictures.report_figures import loop_card, motions_card
from geomtorsion.pictures.verdicts import verdicts

if TYPE_CHECKING:
    from geomtorsion.spaces.space import Space


def write_report(
    space: Space,
    directory: str | PathLike[str],
    progress: Callable[[str], object] = lambda _: None,
    *,
    pictures: bool = True,
    basis: str = "natural",
) -> Path:
    """Write index.html and geometry.json and return the path of the page.

    The page needs no network: mathematics is MathML, style and pictures are inside. Without
    matplotlib the pictures are missing, and the page says so; ``pictures=False`` leaves out motions
    and loops. Indices refer to the basis: "natural" (each quantity in the one in which it is
    defined), "coordinate" or "frame". The directory is made if it is missing; nothing is written
    before everything is computed.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from geomtorsion.spaces import load
    >>> with TemporaryDirectory() as folder:
    ...     write_report(load("s2"), folder, pictures=False).name
    'index.html'
    """
    quantities = chosen_quantities(space, (), basis, progress)
    checked = verdicts(space, progress)
    seen = {}
    if pictures:
        seen = {"Motions": motions_card(space, progress), "Closure": loop_card(space, progress)}
    progress("writing")
    html = page(space, quantities, checked, seen)
    data = geometry_data(space, quantities)
    data["checks"] = {
        title: [{"name": v.name, "holds": v.holds, "detail": v.detail} for v in found]
        for title, found in checked.items()
    }
    # From here on nothing can fail but the disk.
    target = Path(directory)
    target.mkdir(parents=True, exist_ok=True)
    (target / "geometry.json").write_text(json.dumps(data, indent=2) + "\n", "utf-8")
    (target / "index.html").write_text(html, "utf-8")
    return target / "index.html"

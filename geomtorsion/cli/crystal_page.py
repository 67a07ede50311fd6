"""crystal page: dislocation lines of a crystal in its cell, as a page with a turnable view."""

from __future__ import annotations

from itertools import product

import numpy as np

from geomtorsion.materials.crystals.reports import Json
from geomtorsion.pictures.style import SERIES, Stroke
from geomtorsion.teaching.lab.turning import Curve, Film, turnable

EDGE = Stroke("#9aa0a8", "-", 1.0, "")


def crystal_page(report: Json, title: str) -> str:
    """The lines of a report in their cell, coloured by family, as an HTML document.

    Each line is drawn from its first point on, out of the cell where it leads there.
    """
    curves = [Curve(side, EDGE, thin=True) for side in _sides(report)]
    families = sorted({line["family"] for line in report["lines"]})
    labelled: set[str] = set()
    for line in report["lines"]:
        stroke = SERIES[families.index(line["family"]) % len(SERIES)]
        label = "" if line["family"] in labelled else f"b = {line['family']}"
        labelled.add(line["family"])
        tip = f"({', '.join(line['burgers_lattice'])})"
        curves.append(Curve(line["path"], stroke, label, tip))
    count = len(report["lines"])
    note = f"{count} line{'s' * (count != 1)}; point at a line to see its b in lattice constants."
    return turnable(Film("crystal", title, ("x", "y", "z"), tuple(curves), equal=True, note=note))


def _sides(report: Json) -> list[list[list[float]]]:
    """The edges of the cell, or of the box about all lines where nothing is periodic."""
    corners = np.array(list(product((0.0, 1.0), repeat=3)))
    if report["cell"] is not None:
        places = corners @ np.array(report["cell"])
    else:
        points = np.array([x for line in report["lines"] for x in line["path"]] or [[0, 0, 0]])
        low, high = points.min(axis=0), points.max(axis=0)
        places = low + corners * (high - low)
    return [
        [places[a].tolist(), places[b].tolist()]
        for a in range(8)
        for b in range(a)
        if (corners[a] != corners[b]).sum() == 1
    ]

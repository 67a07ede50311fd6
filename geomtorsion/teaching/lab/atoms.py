"""atoms: a crystal with circuits that are clicked, and their images in a perfect lattice."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from html import escape
from pathlib import Path

import numpy as np

from geomtorsion.loops import Cochain
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.plot import save, saving
from geomtorsion.teaching.texts import ENGLISH, code_of, texts

# Name of a crystal -> its edge dislocations: position, and b along x of the displacement.
CRYSTALS: dict[str, tuple[tuple[float, float, int], ...]] = {
    "one": ((0.0, 0.0, 1),),
    "equal": ((-3.0, 0.0, 1), (3.0, 0.0, 1)),
    "opposite": ((-3.0, 0.0, 1), (3.0, 0.0, -1)),
    "none": (),
}
# Half the numbers of columns and rows.
SIZE = (8, 6)
_STYLE = """
* { box-sizing: border-box; }
body { margin: 0; font: 15px/1.4 system-ui, sans-serif; color: #1d2330; background: #fff; }
.bar { display: flex; flex-wrap: wrap; gap: 6px 10px; align-items: center; margin: 4px 2px 6px; }
select, button { font: inherit; padding: 3px 10px; border: 1px solid #1f5fa8; border-radius: 6px;
  background: #fff; color: #1f5fa8; cursor: pointer; max-width: 100%; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(300px, 1fr)); gap: 8px; }
figure { margin: 0; min-width: 0; }
figcaption { text-align: center; font-weight: 600; font-size: 14px; }
svg { display: block; width: 100%; height: auto; max-height: 21rem; touch-action: manipulation; }
#crystal { cursor: pointer; }
svg:focus-visible, button:focus-visible, select:focus-visible { outline: 3px solid #1f5fa8; }
p { margin: 6px 2px; min-height: 2.8em; }
"""


@cache
def crystal(name: str) -> Json:
    """Atoms of a square lattice with dislocations in it, and the lattice vectors of their bonds.

    Equation
    --------
    x = X + u(X), u the displacement of edge dislocations [HirthLothe1982], (3-45); its jump at the
    cut is a lattice vector. The label of a bond is the lattice vector nearest to it.

    Returns
    -------
    atoms: positions, shape (n, 2). bonds: [first, second, dx, dy] of nearest neighbours,
    integers, from the first to the second.

    Examples
    --------
    >>> perfect = crystal("none")
    >>> len(perfect["atoms"]), len(perfect["bonds"])
    (221, 412)
    """
    columns, rows = (np.arange(-n, n + 1) for n in SIZE)
    # Half steps shift the lattice so that no dislocation line passes through an atom.
    perfect = np.array(
        [(x + 0.5 * (len(CRYSTALS[name]) % 2), y + 0.5) for y in rows for x in columns]
    )
    moved = perfect + sum(_displacement(perfect, one) for one in CRYSTALS[name])
    bonds = []
    for first in range(len(moved)):
        steps = moved[first + 1 :] - moved[first]
        labels = np.rint(steps)
        near = np.flatnonzero(np.abs(labels).sum(axis=1) == 1)
        bonds += [[first, first + 1 + int(k), *map(int, labels[k])] for k in near]
    return {"atoms": moved.round(3).tolist(), "bonds": bonds}


def _displacement(places: np.ndarray, line: Sequence[float], poisson: float = 0.34) -> np.ndarray:
    """Displacement of an edge dislocation, shape (n, 2), in copper; its cut runs to the left."""
    x, y = (places - line[:2]).T
    square = x**2 + y**2
    across = np.arctan2(y, x) + x * y / (2 * (1 - poisson) * square)
    along = (1 - 2 * poisson) * np.log(square) + (x**2 - y**2) / square
    return line[2] / (2 * np.pi) * np.stack([across, -along / (4 * (1 - poisson))], axis=1)


def closure(name: str, path: Sequence[int]) -> list[int]:
    """b of a closed path from atom to atom, in lattice vectors, from start to finish.

    Examples
    --------
    >>> closure("none", [0, 1, 18, 17])
    [0, 0]
    """
    data = crystal(name)
    bonds = np.array(data["bonds"])
    labels = Cochain.of_edges(bonds[:, :2], bonds[:, 2:], labels=range(len(data["atoms"])))
    return labels.around(list(path)).vector.tolist()


def atoms(language: str = ENGLISH) -> Json:
    """The picture as an HTML document with all it needs: click atoms, see the image beside them.

    Returns
    -------
    space: the document. title: its title.

    Examples
    --------
    >>> page = atoms()["space"]
    >>> "http" in page.replace("http://www.w3.org", ""), page.count("<svg")
    (False, 2)
    """
    text = texts("figures", "atoms", language)
    content = {"crystals": {name: crystal(name) for name in CRYSTALS}, "text": text.table("script")}
    # In a script element only the end tag of the element ends the text.
    data = json.dumps(content, separators=(",", ":")).replace("</", "<\\/")
    options = "".join(
        f'<option value="{name}">{escape(label)}</option>'
        for name, label in text.table("crystals").items()
    )
    script = Path(__file__).with_name("atoms.js").read_text("utf-8")

    def shown(key: str) -> str:
        return escape(text(key))

    page = (
        f'<!doctype html><html lang="{escape(code_of(language))}"><head><meta charset="utf-8">'
        f"<title>{shown('title')}</title><style>{_STYLE}</style></head><body>"
        f'<div class="bar"><label>{shown("crystal")} <select id="which">{options}</select></label>'
        f'<button id="example" type="button">{shown("example")}</button>'
        f'<button id="back" type="button">{shown("back")}</button>'
        f'<button id="restart" type="button">{shown("restart")}</button></div>'
        '<p id="result" role="status"></p><div class="pair"><figure>'
        f"<figcaption>{shown('first')}</figcaption>"
        '<svg id="crystal" tabindex="0" role="application" '
        f'aria-label="{shown("crystal_label")}"></svg>'
        f"{save(language)}</figure>"
        f"<figure><figcaption>{shown('second')}</figcaption>"
        f'<svg id="image" role="img" aria-label="{shown("image_label")}"></svg>'
        f"{save(language)}</figure>"
        "</div>"
        f'<script type="application/json" id="data">{data}</script>'
        f"<script>{script}{saving()}</script></body></html>"
    )
    return {"space": page, "title": text("title")}

"""measured: a square circuit in a map that somebody gives: its Burgers vector, errors, picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import GeomtorsionError
from geomtorsion.exercises.worker_pool import Json
from geomtorsion.lab.numbers import raised, table
from geomtorsion.lab.plot import Look, Plot
from geomtorsion.lab.raster import address, colours, png, scale
from geomtorsion.lab.settings import PAGE
from geomtorsion.lab.uploads import read_map, title_of
from geomtorsion.loops import Loop, SampledFrame
from geomtorsion.orientations import Circuit, OrientationMap
from geomtorsion.pictures.style import number

# Bright with a dark edge: seen on every colour of the map.
LINE, EDGE = Look("#ffffff", "", "", 2.4), Look("#a3201a", "", "", 5.0)


@dataclass(frozen=True)
class Found:
    """Burgers vector of one circuit.

    vector, noise: by component; heads: what these are. interpolation: of the largest component,
    None where it is far below the noise. unit: of all. significance: |b| against its errors.
    told: what else is to be said.
    """

    vector: Sequence[float]
    noise: Sequence[float]
    heads: Sequence[str]
    interpolation: float | None
    unit: str
    significance: float
    told: str

    @property
    def size(self) -> float:
        """|b|."""
        return float(np.linalg.norm(self.vector))


def map_facts(content: bytes, name: str) -> Json:
    """What a map is, and where circuits may lie in it.

    Parameters
    ----------
    content
        The bytes of the file; what they are is seen in them.
    name
        Of the file, for messages.

    Returns
    -------
    sentence: what it is. shape: nodes along x and y. starts, steps: coordinates of the first node
    and from one to the next, in `unit`. names: of the axes. middle, side: of the first circuit,
    numbers of nodes and of cells; most: cells that its side may have.

    Raises
    ------
    GeomtorsionError
        The file is nothing that the page reads.

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
    found = read_map(content, title)
    shape, starts, steps, names = _layout(found)
    if isinstance(found, OrientationMap):
        phases = ", ".join(phase.name for phase in found.phases.values())
        what = f"an orientation map of {shape[1]} × {shape[0]} pixels ({phases})"
    else:
        noise = "unknown" if found.sigma is None else found.sigma_source
        holes = f"; holes: {len(found.holes)}" if found.holes else ""
        sizes = " × ".join(str(len(axis)) for axis in found.axes)
        what = f"a sampled frame of {sizes} nodes; its noise: {noise}{holes}"
        if len(found.axes) > 2:
            what += "; circuits lie in the middle of its other axes"
    most = min(shape) - 1
    return {
        "sentence": f"{title} is {what}.",
        "unit": found.unit,
        "shape": list(shape),
        "starts": starts,
        "steps": steps,
        "names": list(names),
        "middle": [n // 2 for n in shape],
        "side": max(1, min(shape) // PAGE.parts),
        "most": most,
    }


def map_circuit(content: bytes, name: str, centre: Sequence[int], side: int) -> Json:
    """A square circuit in a map, and |b| per area of all circuits of its size.

    Parameters
    ----------
    content, name
        As for `map_facts`.
    centre
        The node in its middle, numbers along x and y from 0.
    side
        Cells along its side.

    Returns
    -------
    picture: svg elements, the map and its scale. refused: why the circuit has no b, where it has
    none. Otherwise sentence, table: text and HTML; b, noise: by component; interpolation; unit.

    Raises
    ------
    GeomtorsionError
        The file is nothing that the page reads, or the side is longer than the map.

    Examples
    --------
    >>> rows = ["x,y,e_0_0,e_0_1"]
    >>> rows += [f"{x},{y},{-y / 2},{x / 2}" for x in range(9) for y in range(8)]
    >>> found = map_circuit("\\n".join(rows).encode(), "a.csv", [4, 4], 3)
    >>> [round(x, 9) for x in found["b"]]
    [9.0]
    """
    found = read_map(content, title_of(name))
    corner = [int(k) - int(side) // 2 for k in centre]
    if isinstance(found, OrientationMap):
        squares = found.burgers_map(side)
        density = squares.per_area.T
    else:
        cells = found.burgers_map(side)
        others = tuple(len(axis) // 2 for axis in found.axes[2:])
        sizes = np.sqrt((cells.vectors**2).sum(axis=0)) / cells.area
        density = sizes[(slice(None), slice(None), *others)]
    reply: dict[str, object] = {"picture": _picture(found, density, corner, side)}
    try:
        if isinstance(found, OrientationMap):
            one = _of_map(found, corner, side)
        else:
            one = _of_frame(found, corner, side)
    except GeomtorsionError as error:
        return {**reply, "refused": str(error)}
    return {
        **reply,
        "sentence": _sentence(one, side),
        "table": _table(one),
        "b": list(one.vector),
        "noise": list(one.noise),
        "interpolation": one.interpolation,
        "unit": one.unit,
    }


def _layout(
    found: SampledFrame | OrientationMap,
) -> tuple[tuple[int, int], list[float], list[float], tuple[str, str]]:
    """Nodes along x and y, coordinates of the first node, steps, names of the axes."""
    if isinstance(found, OrientationMap):
        rows, columns = found.shape
        return (columns, rows), [0.0, 0.0], [float(x) for x in found.steps], ("x", "y")
    x, y = found.axes[:2]
    starts, steps = [float(x[0]), float(y[0])], [float(found.steps[0]), float(found.steps[1])]
    return (len(x), len(y)), starts, steps, (found.names[0], found.names[1])


def _of_map(found: OrientationMap, corner: Sequence[int], side: int) -> Found:
    """A circuit in an orientation map: crystal axes, lengths in the unit of the map."""
    column, row = corner
    b = found.burgers(Circuit.square((row, column), side))
    noise = np.sqrt(np.diagonal(b.rotation.T @ b.covariance @ b.rotation).clip(0))
    told = (
        f"Grain {b.grain}, {b.phase.name}; components along the axes of the crystal. The error of "
        "interpolation is far below the noise."
    )
    heads = [f"b{raised(k)}" for k in range(3)]
    return Found(b.vector.tolist(), noise.tolist(), heads, None, b.unit, b.significance, told)


def _of_frame(found: SampledFrame, corner: Sequence[int], side: int) -> Found:
    """A circuit in a sampled frame, from x to y."""
    low = [float(a[0]) + h * k for a, h, k in zip(found.axes, found.steps, corner, strict=False)]
    high = [a + h * side for a, h in zip(low, found.steps, strict=False)]
    (x0, x1), (y0, y1) = (sorted(pair) for pair in zip(low, high, strict=True))
    rest = [float(axis[len(axis) // 2]) for axis in found.axes[2:]]
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    b = found.burgers(Loop.polygon([[*point, *rest] for point in corners], name="square"))
    told = "" if found.sigma is not None else "Nothing is known of the noise of this map."
    heads = [f"b{raised(k)}" for k in range(found.rows)]
    other = b.interpolation_error + b.quadrature_error
    return Found(b.vector.tolist(), b.sigmas.tolist(), heads, other, b.unit, b.significance, told)


def _sentence(one: Found, side: int) -> str:
    """What the circuit has, in words."""
    unit = f" {one.unit}" if one.unit else ""
    noise = float(np.max(one.noise))
    said = f"Circuit of {side} × {side} cells: |b| = {one.size:.4g}{unit}"
    said += f"; noise {noise:.1e}{unit} in its noisiest component"
    if one.interpolation is not None:
        said += f", interpolation {one.interpolation:.1e}{unit}"
    if np.isfinite(one.significance):
        # Noise alone: |b| against sigma is the root of the number of components.
        alone = len(one.vector) ** 0.5
        times = number(float(f"{one.significance:.3g}"))
        said += f". Against its errors |b| is {times}; errors alone give {alone:.1f}"
    return f"{said}. {one.told}".rstrip()


def _table(one: Found) -> str:
    """Component by component, with both errors."""
    other = "–" if one.interpolation is None else f"{one.interpolation:.1e}"
    rows = [
        [head, number(float(f"{value:.5g}")), f"{sigma:.1e}", other]
        for head, value, sigma in zip(one.heads, one.vector, one.noise, strict=True)
    ]
    unit = f" in {one.unit}" if one.unit else ""
    heads = ("", "b", "noise", "interpolation")
    return table(heads, rows, f"Burgers vector of the circuit{unit}")


def _picture(
    found: SampledFrame | OrientationMap, density: np.ndarray, corner: Sequence[int], side: int
) -> str:
    """The map with the circuit, each circuit of its size at its middle; below it the scale."""
    shape, starts, steps, names = _layout(found)
    whole = np.full(shape, np.nan)
    half = side // 2
    whole[half : half + density.shape[0], half : half + density.shape[1]] = density
    known = density[np.isfinite(density)]
    most = float(known.max()) if known.size else 0.0
    # Pixels run as coordinates do, also where an axis descends.
    turned = whole[:: int(np.sign(steps[0])), :: int(np.sign(steps[1]))]
    pixels = png(colours(turned.T, most))
    unit = f" in {found.unit}" if found.unit else ""
    labels = (f"{names[0]}{unit}", f"{names[1]}{unit}")
    plot = Plot(f"|b| per area, circuits of {side} × {side} cells", labels, equal=True)

    def at(i: float, k: float) -> tuple[float, float]:
        return starts[0] + steps[0] * i, starts[1] + steps[1] * k

    # A value at even sides stands for the node in the middle, and covers a step about it.
    shift = 0.0 if side % 2 == 0 else 0.5
    ends = zip(
        at(shift - 0.5, shift - 0.5),
        at(shape[0] - 0.5 + shift, shape[1] - 0.5 + shift),
        strict=True,
    )
    (left, right), (bottom, top) = (sorted(pair) for pair in ends)
    plot.picture((left, bottom), (right, top), address(pixels))
    i, k = corner
    square = [at(i, k), at(i + side, k), at(i + side, k + side), at(i, k + side), at(i, k)]
    plot.line(square, EDGE).line(square, LINE)
    vectors = found.unit if isinstance(found, OrientationMap) else found.vector_unit
    return plot.svg() + scale(most, _density_unit(vectors, found.unit))


def _density_unit(vectors: str, lengths: str) -> str:
    """The unit of b per area.

    Examples
    --------
    >>> _density_unit("um", "um"), _density_unit("nm", "um"), _density_unit("", "")
    ('1/um', 'nm/um²', '')
    """
    if not lengths or not vectors:
        return ""
    return f"1/{lengths}" if vectors == lengths else f"{vectors}/{lengths}²"

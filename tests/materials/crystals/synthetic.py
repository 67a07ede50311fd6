"""Synthetic crystals with Volterra dislocations whose lines and Burgers vectors are known."""

from functools import cache

import numpy as np
from scipy.spatial import cKDTree

LATTICE_SITES = {
    "fcc": ((0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)),
    "bcc": ((0, 0, 0), (0.5, 0.5, 0.5)),
    "diamond": (
        *((0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)),
        *((0.25, 0.25, 0.25), (0.75, 0.75, 0.25), (0.75, 0.25, 0.75), (0.25, 0.75, 0.75)),
    ),
    "hcp": ((0, 0, 0), (0.5, 0.5, 0), (0, 1 / 3, 0.5), (0.5, 5 / 6, 0.5)),
    "hexagonal diamond": (
        *((0, 0, 0), (0.5, 0.5, 0), (0, 1 / 3, 0.5), (0.5, 5 / 6, 0.5)),
        *((0, 0, 3 / 8), (0.5, 0.5, 3 / 8), (0, 1 / 3, 7 / 8), (0.5, 5 / 6, 7 / 8)),
    ),
}
CELLS = {
    "fcc": np.ones(3),
    "bcc": np.ones(3),
    "diamond": np.ones(3),
    "hcp": np.array([1, np.sqrt(3), np.sqrt(8 / 3)]),
    "hexagonal diamond": np.array([1, np.sqrt(3), np.sqrt(8 / 3)]),
}


def block(lattice, repeats):
    """Atoms of a perfect crystal with a = 1 along its axes, and the edges of its cell."""
    cells = np.stack(np.meshgrid(*map(np.arange, repeats), indexing="ij"), axis=-1).reshape(-1, 3)
    sites = (cells[:, None] + np.array(LATTICE_SITES[lattice])).reshape(-1, 3)
    return sites * CELLS[lattice], np.array(repeats) * CELLS[lattice]


def displaced(places, centre, burgers, poisson=0.3):
    """Isotropic Volterra field of a straight dislocation along z through a centre (x, y).

    The edge part is the field of [HirthLothe1982] for b along x, turned to the direction of b.
    """
    b = np.array(burgers, dtype=float)
    x, y = (places[:, :2] - centre).T
    across = np.hypot(*b[:2])
    angle = np.arctan2(b[1], b[0]) if across else 0.0
    c, s = np.cos(angle), np.sin(angle)
    x, y = c * x + s * y, c * y - s * x
    theta, square = np.arctan2(y, x), x**2 + y**2
    along = across / (2 * np.pi) * (theta + x * y / (2 * (1 - poisson) * square))
    upwards = (
        -across
        / (2 * np.pi)
        * (
            (1 - 2 * poisson) / (4 * (1 - poisson)) * np.log(square)
            + (x**2 - y**2) / (4 * (1 - poisson) * square)
        )
    )
    moved = places.copy()
    moved[:, 0] += c * along - s * upwards
    moved[:, 1] += s * along + c * upwards
    moved[:, 2] += b[2] / (2 * np.pi) * theta
    return moved


def with_line(lattice, burgers, repeats=(12, 12, 4), margin=0.35):
    """A crystal with a straight line along z, open across it, and its cell.

    The cut moves some atoms onto others; one atom of each such pair is removed.
    """
    places, cell = block(lattice, repeats)
    # The line is between atoms and off each lattice plane.
    centre = cell[:2] / 2 + np.array([0.131, 0.077])
    moved = displaced(places, centre, burgers)
    wrapped = moved.copy()
    wrapped[:, 2] %= cell[2]
    box = [1e6, 1e6, cell[2]]
    pairs = cKDTree(wrapped - wrapped.min(axis=0) * [1, 1, 0], boxsize=box).query_pairs(
        margin, output_type="ndarray"
    )
    kept = np.ones(len(moved), dtype=bool)
    kept[pairs[:, 1]] = False
    return moved[kept], cell


def quadrupole(lattice, repeats, burgers):
    """Two screws and two opposite screws on a square, periodic in all directions, and the cell."""
    places, cell = block(lattice, repeats)
    moved = places.copy()
    for sx, sy in ((0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75)):
        sign = 1 if (sx < 0.5) == (sy < 0.5) else -1
        # The fields of all images of a quadrupole add up; the nearest images suffice.
        for m in (-1, 0, 1):
            for n in (-1, 0, 1):
                centre = np.array([sx + m + 0.0131, sy + n + 0.0077]) * cell[:2]
                angle = np.arctan2(*(places[:, :2] - centre).T[::-1])
                moved += sign * angle[:, None] / (2 * np.pi) * np.array(burgers, float)
    return moved, cell


def twisted(repeats, height):
    """fcc with two twist walls across z, and the cell. The halves are turned by
    +-atan(1 / repeats); height: height of each half."""
    side = np.hypot(repeats, 1)
    sites, _ = block("fcc", (2 * repeats + 2, 2 * repeats + 2, height))
    sites -= [repeats + 1, repeats + 1, 0]
    halves = []
    for sign, start in ((1, 0), (-1, height)):
        c, s = repeats / side, sign / side
        x, y, z = sites.T
        places = np.stack([c * x + s * y, c * y - s * x, z + start], axis=1)
        # Only the lower one of two opposite faces belongs to the cell.
        across = places[:, :2]
        halves.append(places[((across > -1e-9) & (across < side - 1e-9)).all(axis=1)])
    return np.concatenate(halves), np.array([side, side, 2 * height])


def solid_angle(points, ring):
    """Solid angle of a polygon from points, shape (k,), by its triangles [Oosterom1983]."""
    total = np.zeros(len(points))
    middle = ring.mean(axis=0) - points
    size = np.linalg.norm(middle, axis=1)
    for one, two in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        a, b = one - points, two - points
        p, q = np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)
        volume = (middle * np.cross(a, b)).sum(axis=1)
        below = size * p * q + (middle * a).sum(axis=1) * q
        below += (middle * b).sum(axis=1) * p + (a * b).sum(axis=1) * size
        total += 2 * np.arctan2(volume, below)
    return total


@cache
def interstitial_loop(radius):
    """bcc with z along [1 1 1] and a disc of interstitials, its cell, and their number.

    Atoms move away from the disc by b/(4 pi) times its solid angle; one more layer fills the gap.
    """
    axes = np.array([[1, 1, -2] / np.sqrt(6), [-1, 1, 0] / np.sqrt(2), [1, 1, 1] / np.sqrt(3)])
    cell = np.sqrt([6, 2, 0.75]) * [6, 10, 16]
    sites, _ = block("bcc", (40, 40, 40))
    places = (sites - 20) @ axes.T + cell / 2
    # Only the lower one of two opposite faces belongs to the cell.
    places = places[((places > -1e-6) & (places < cell - 1e-6)).all(axis=1)]
    centre, b = cell / 2 + [0.11, 0.07, 0.21], np.sqrt(0.75)
    turn = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    ring = centre + radius * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    share = solid_angle(places, ring) / (4 * np.pi)
    above = places[:, 2] > centre[2]
    moved = places.copy()
    moved[:, 2] += np.where(above, 1, -1) * b * np.abs(share)
    disc = np.hypot(*(places[:, :2] - centre[:2]).T) < radius
    layer = disc & ~above & (places[:, 2] > centre[2] - b)
    found = np.concatenate([moved, moved[layer] + [0, 0, b]])
    # All tests share these arrays.
    found.flags.writeable = cell.flags.writeable = False
    return found, cell, int(layer.sum())


def cylinder(lattice, axes, period, radius, ratio=None, centre=(0.117, 0.093, 0.071)):
    """A cylinder of crystal along z, with a = 1. axes: the axes of space in crystal axes, as rows;
    centre: crystal coordinates of the cylinder's axis, in cell edges; ratio: c/a of hcp."""
    edges = CELLS[lattice] * ([1, 1, 1] if ratio is None else [1, 1, ratio / np.sqrt(8 / 3)])
    count = np.ceil((radius + period) / edges).astype(int) + 1
    cells = np.stack(np.meshgrid(*[np.arange(-n, n) for n in count], indexing="ij"), axis=-1)
    sites = (cells.reshape(-1, 1, 3) + np.array(LATTICE_SITES[lattice])).reshape(-1, 3)
    places = ((sites - centre) * edges) @ np.array(axes).T
    inside = (places[:, 2] > -1e-6) & (places[:, 2] < period - 1e-6)
    return places[inside & (np.hypot(*places[:, :2].T) < radius)]


def torn(places, lines):
    """Positions moved by the fields of lines (position in x and y, b); all cuts go towards -x."""
    moved = places.copy()
    for centre, b in lines:
        # The cut of `displaced` points against the edge part of b.
        sense = 1 if b[0] >= 0 else -1
        moved += sense * (displaced(places, np.array(centre), sense * np.array(b)) - places)
    return moved


# The axes of space in hcp axes, with z along a line in the basal plane and y along the axis c,
# and the period along that line.
BASAL = {
    "edge": (np.array([[-1, 0, 0], [0, 0, 1], [0, 1, 0]]), np.sqrt(3)),
    "screw": (np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]), 1.0),
}
PERIODS = {"edge": 3, "screw": 5}


def basal_partials(line, width=4.0, ratio=1.623, periods=None):
    """A dislocation 1/3[2 -1 -1 0] of hcp split into two partials, its period, and both partials
    with their b.

    The fault of type I2 is between them in the plane y = 0.
    """
    axes, period = BASAL[line]
    period *= periods or PERIODS[line]
    # The layers are at a quarter and three quarters of c.
    sites = cylinder("hcp", axes, period, 9, ratio, centre=(0.117, 0.093, 0.25))
    # In this order the layers are never directly above each other.
    parts = [axes @ np.array([0.5, s / np.sqrt(12), 0]) for s in (1, -1)]
    lines = [((x + 0.03, 0.0), b) for x, b in zip((-width, width), parts, strict=True)]
    return torn(sites, lines), period, lines


def frank_partials(line, ratio=1.623):
    """Two opposite Frank partials of hcp around a missing layer, their period and their b.

    The fault of type I1 is between them: ABABCBCB.
    """
    axes, period = BASAL[line]
    period *= PERIODS[line]
    sites = cylinder("hcp", axes, period, 9, ratio, centre=(0.117, 0.093, 0))
    kept = sites[(np.abs(sites[:, 1]) > 0.1) | (np.abs(sites[:, 0]) > 5)]
    b = axes @ np.array([0, 1 / np.sqrt(3), -ratio / 2])
    lines = [((5.0, 1e-9), b), ((-5.0, 1e-9), -b)]
    return torn(kept, lines), period, lines


def stacked(layers, repeats=(9, 5), ratio=1.623):
    """Close-packed layers such as "ABABCACA", each of repeats[0] by repeats[1] cells of a by
    sqrt(3) a, and the cell with two empty layers on top."""
    cells = np.stack(np.meshgrid(*map(np.arange, repeats), indexing="ij"), axis=-1)
    sites = cells.reshape(-1, 1, 2) + np.array([[0, 0], [0.5, 0.5]])
    x, y = (sites.reshape(-1, 2) * [1, np.sqrt(3)]).T
    places = [
        np.stack([x, y + "ABC".index(layer) / np.sqrt(3), 0 * x + k * ratio / 2], axis=1)
        for k, layer in enumerate(layers)
    ]
    cell = np.array([repeats[0], np.sqrt(3) * repeats[1], (len(layers) + 2) * ratio / 2])
    return np.concatenate(places), cell


def vacancy_disc(radius, ratio=1.623):
    """hcp without a disc of one basal layer, closed with the shear of a Frank loop; its cell, and
    the number of missing atoms."""
    repeats = (2 * radius + 5, radius + 4, 8)
    sites, cell = block("hcp", repeats)
    sites, cell = (x * [1, 1, ratio / np.sqrt(8 / 3)] for x in (sites, cell))
    centre = np.array([cell[0] / 2 + 0.11, cell[1] / 2 + 0.07, 4 * ratio])
    height = sites[:, 2] - centre[2]
    gone = (np.abs(height) < 0.1) & (np.hypot(*(sites - centre)[:, :2].T) < radius)
    turn = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    ring = centre + radius * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    kept = sites[~gone]
    share = np.abs(solid_angle(kept, ring)) / (4 * np.pi)
    b = np.array([0, 1 / np.sqrt(3), -ratio / 2])
    side = np.where(np.abs(height) < 0.1, 0, np.sign(height))[~gone]
    return kept + (side * share)[:, None] * b, cell, int(gone.sum())

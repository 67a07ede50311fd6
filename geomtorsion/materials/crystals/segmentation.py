"""Segmentation: which atoms belong to which grain of a polycrystal.

Neighbours whose own orientations differ by less than the angle of a wall belong together, as far as
all of them are within this angle of the mean of their grain. Dislocations of low-angle walls remain
dislocations: between them the orientation changes by less from atom to atom.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals.frames import Frame, best_frame, upright
from geomtorsion.materials.crystals.grains import (
    Grain,
    Grains,
    Nowhere,
    in_variant,
    quaternion_of,
    single_grain,
    wall_between,
)
from geomtorsion.materials.crystals.lattices import Lattice
from geomtorsion.materials.crystals.local_frames import symmetry_of
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.specimen import (
    Local,
    Specimen,
    fitting,
    is_lost,
    local_of,
    mean_frame,
    nearest_held,
)
from geomtorsion.materials.crystals.torsion import components


def segmented(specimen: Specimen) -> Grains:
    """All grains of a polycrystal."""
    count = len(specimen.places)
    numbers, vectors = specimen.neighbours(np.arange(count))
    lattices = specimen.lattices
    local = local_of(lattices, vectors)
    groups: list[tuple[Frame, np.ndarray]] = []
    for k, lattice in enumerate(lattices):
        groups += _groups(lattice, local, local.phase == k, numbers, vectors)
    groups = _inner(groups, numbers)
    if not groups:
        share = float((local.phase >= 0).mean())
        if share > max(2 * fitting(specimen.frame, vectors).mean(), METHOD.share):
            raise CrystalError(
                "positions: expected a crystal, or grains wider than a core, got only narrower "
                f"grains, as in a small cluster of many twins ({share:.1%} of the atoms have "
                "neighbours as in a lattice). Give a larger cluster."
            )
        return single_grain(specimen.frame, specimen.places)
    groups = _in_order(specimen, groups, vectors)
    while True:
        owner = _owners(groups, count)
        filled, touching = _filled(specimen, owner, numbers, vectors)
        merged_groups = _joined(groups, touching, vectors)
        if merged_groups is None:
            break
        groups = _in_order(specimen, merged_groups, vectors)
    if len(groups) == 1 and (filled == 0).all():
        return single_grain(specimen.frame, specimen.places)
    frames = _in_variants([frame for frame, _ in groups])
    grains = []
    for k, frame in enumerate(frames):
        atoms = np.flatnonzero(filled == k)
        grains.append(Grain(k, frame, atoms, _centre(specimen, atoms)))
    walls = [
        wall_between(grains[a], grains[b], atoms) for (a, b), atoms in sorted(touching.items())
    ]
    fits = float((owner >= 0).mean())
    return Grains(tuple(grains), filled, tuple(walls), fits, len(grains))


# -- groups of atoms ------------------------------------------------------------------------------


def _groups(
    lattice: Lattice, local: Local, mine: np.ndarray, numbers: np.ndarray, vectors: np.ndarray
) -> list[tuple[Frame, np.ndarray]]:
    """Connected atoms of one lattice near the mean orientation of their group."""
    group, q = symmetry_of(lattice.name), local.quaternions
    atoms = np.flatnonzero(mine)
    pairs = np.stack(
        [np.repeat(atoms, lattice.shells), numbers[atoms, : lattice.shells].ravel()], axis=1
    )
    pairs = pairs[mine[pairs[:, 1]]]
    _, angles = group.nearest(q[pairs[:, 0]], q[pairs[:, 1]])
    pairs = pairs[angles < METHOD.wall]
    queue, clusters = _parts(mine, pairs, lattice.shells), []
    while queue:
        part = queue.pop()
        frame = mean_frame(lattice, local, part, vectors)
        own = np.tile(quaternion_of(frame), (len(part), 1))
        near = group.nearest(own, q[part])[1] < METHOD.wall
        if near.all():
            clusters.append((frame, part))
            continue
        if not near.any():
            continue
        for chosen in (part[near], part[~near]):
            inside = np.zeros(len(mine), dtype=bool)
            inside[chosen] = True
            queue += _parts(inside, pairs, lattice.shells)
    return clusters


def _parts(inside: np.ndarray, pairs: np.ndarray, least: int) -> list[np.ndarray]:
    """Sets of more than so many atoms connected by pairs, smallest number first."""
    both = pairs[inside[pairs].all(axis=1)]
    number = components(len(inside), both)
    atoms = np.flatnonzero(inside)
    order = atoms[np.argsort(number[atoms], kind="stable")]
    parts = np.split(order, np.flatnonzero(np.diff(number[order])) + 1)
    return sorted((p for p in parts if len(p) > least), key=lambda p: -int(p[0]))


def _inner(
    groups: list[tuple[Frame, np.ndarray]], numbers: np.ndarray
) -> list[tuple[Frame, np.ndarray]]:
    """Groups with an inside.

    Most neighbours of an inner atom belong to its group, and no neighbour of it or of these
    neighbours belongs to another group.

    A group no wider around its middle than a core, two neighbour distances, is a fault: its two or
    three layers are as in hcp within fcc, or as in fcc within hcp, but have no inside.
    """
    owner = _owners(groups, len(numbers))
    clear = np.ones(len(numbers), dtype=bool)
    for k, (frame, part) in enumerate(groups):
        around = owner[numbers[part, : frame.lattice.shells]]
        clear[part] = ((around == k) | (around < 0)).all(axis=1)
    inner_groups = []
    for k, (frame, part) in enumerate(groups):
        near = numbers[part, : frame.lattice.shells]
        most = 2 * (owner[near] == k).sum(axis=1) > frame.lattice.shells
        if (most & clear[part] & clear[near].all(axis=1)).any():
            inner_groups.append((frame, part))
    return inner_groups


def _owners(groups: list[tuple[Frame, np.ndarray]], count: int) -> np.ndarray:
    """Number of the group of each atom, -1 where there is none."""
    owner = np.full(count, Nowhere.wall)
    for k, (_, part) in enumerate(groups):
        owner[part] = k
    return owner


def _in_order(
    specimen: Specimen, groups: list[tuple[Frame, np.ndarray]], vectors: np.ndarray
) -> list[tuple[Frame, np.ndarray]]:
    """The group of the frame of the specimen first, then by size; with the given values."""
    main = specimen.frame

    def off(frame: Frame) -> float:
        if frame.lattice.name != main.lattice.name:
            return np.inf
        group = symmetry_of(main.lattice.name)
        return float(group.nearest(quaternion_of(main)[None], quaternion_of(frame)[None])[1][0])

    rest = sorted(groups, key=lambda x: (-len(x[1]), int(x[1][0])))
    near = [k for k, (frame, _) in enumerate(rest) if off(frame) < METHOD.wall]
    if near:
        rest.insert(0, rest.pop(near[0]))
    ordered = []
    for k, (frame, part) in enumerate(rest):
        if frame.lattice.name == main.lattice.name and specimen.keep_constant:
            frame = frame.along(replace(frame, constant=main.constant))
        if k == 0 and near and specimen.keep_orient:
            frame = in_variant(frame, main).along(replace(frame, orient=main.orient))
        elif k == 0 and near:
            frame = in_variant(frame, main)
        else:
            frame = upright(frame)
        ordered.append((frame, part))
    return ordered


def _in_variants(frames: list[Frame]) -> list[Frame]:
    """Each group in the variant nearest to the first group of its lattice."""
    first: dict[str, Frame] = {}
    variants = []
    for frame in frames:
        like = first.setdefault(frame.lattice.name, frame)
        variants.append(frame if like is frame else in_variant(frame, like))
    return variants


# -- all other atoms ------------------------------------------------------------------------------


def _filled(
    specimen: Specimen, owner: np.ndarray, numbers: np.ndarray, vectors: np.ndarray
) -> tuple[np.ndarray, dict[tuple[int, int], np.ndarray]]:
    """The grain of each atom, and atoms in the walls of grains that touch.

    An atom that fits nowhere is in a wall if two grains are at most the width of a core away from
    it. In the midst of a region of such atoms it is in no grain. Else it is in a core or at a
    surface of the nearest grain.
    """
    filled = owner.copy()
    held = owner >= 0
    odd = np.flatnonzero(~held)
    # Under noise few atoms fit in frames of their own, and more in the frame of the crystal.
    fits = held | fitting(specimen.frame, vectors)
    first, second = _two_nearest(specimen, odd, owner)
    wall = second >= 0
    far = 2 * METHOD.width * specimen.nearest
    lost = odd[is_lost(specimen, odd, vectors[odd], fits)]
    if len(lost):
        deep = np.zeros(len(owner), dtype=bool)
        deep[lost] = True
        _, distances = nearest_held(specimen, odd, deep, far)
        filled[odd[(distances <= far) & ~wall]] = Nowhere.none
    rest = odd[~wall & (filled[odd] != Nowhere.none)]
    if len(rest):
        reach = float(np.linalg.norm(np.ptp(specimen.places, axis=0))) + far
        reach = far if (first[~wall] >= 0).all() else reach
        which, _ = nearest_held(specimen, rest, held, reach)
        filled[rest] = owner[which]
    contacts: dict[tuple[int, int], list[np.ndarray]] = {}
    # Grains touch in a wall, or where atoms that fit into one neighbour atoms of the other.
    steps = numbers[:, : specimen.frame.lattice.shells]
    a, b = np.repeat(owner, steps.shape[1]), owner[steps].ravel()
    met = (a != b) & (a >= 0) & (b >= 0)
    for x, y in {(min(p), max(p)) for p in zip(a[met].tolist(), b[met].tolist(), strict=True)}:
        contacts[x, y] = []
    pairs = np.sort(np.stack([first[wall], second[wall]], axis=1), axis=1)
    for x, y in np.unique(pairs, axis=0).tolist():
        contacts.setdefault((x, y), []).append(odd[wall][(pairs == (x, y)).all(axis=1)])
    none = np.zeros(0, dtype=np.int64)
    return filled, {pair: np.concatenate([none, *atoms]) for pair, atoms in contacts.items()}


def _two_nearest(
    specimen: Specimen, atoms: np.ndarray, owner: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The nearest grain and the second nearest to some atoms, within the width of a core."""
    reach = METHOD.width * specimen.nearest
    chosen = np.flatnonzero(owner >= 0)
    points, numbers, _ = specimen.cell.with_ghosts(specimen.places[chosen], reach)
    tree = scipy.spatial.cKDTree(points)
    codes = np.append(owner[chosen[numbers]], Nowhere.wall)
    first, second = np.full(len(atoms), Nowhere.wall), np.full(len(atoms), Nowhere.wall)
    # A sphere of this width holds at most so many atoms of a crystal.
    most = min(max(int(8 * METHOD.width**3), 2), len(points))
    for start in range(0, len(atoms), METHOD.together):
        part = slice(start, start + METHOD.together)
        _, k = tree.query(
            specimen.places[atoms[part]], k=range(1, most + 1), distance_upper_bound=reach
        )
        near_codes = codes[k]
        first[part] = near_codes[:, 0]
        other = (near_codes != near_codes[:, :1]) & (near_codes >= 0)
        column = other.argmax(axis=1)
        rows = np.arange(len(near_codes))
        second[part] = np.where(other.any(axis=1), near_codes[rows, column], Nowhere.wall)
    return first, second


def _joined(
    groups: list[tuple[Frame, np.ndarray]],
    touching: dict[tuple[int, int], np.ndarray],
    vectors: np.ndarray,
) -> list[tuple[Frame, np.ndarray]] | None:
    """The groups, with two neighbours merged if they differ by less than the angle of a wall."""
    for one, other in sorted(touching):
        (frame, part), (second, more) = groups[one], groups[other]
        name = frame.lattice.name
        if second.lattice.name != name:
            continue
        q, r = quaternion_of(frame)[None], quaternion_of(second)[None]
        if symmetry_of(name).nearest(q, r)[1][0] < METHOD.wall:
            both = np.sort(np.concatenate([part, more]))
            some = both[np.linspace(0, len(both) - 1, min(METHOD.sample, len(both))).astype(int)]
            shared_frame = best_frame(frame, vectors[some][:, : frame.lattice.shells])
            rest = [x for k, x in enumerate(groups) if k not in (one, other)]
            return [(shared_frame, both), *rest]
    return None


def _centre(specimen: Specimen, atoms: np.ndarray) -> np.ndarray:
    """Centre of gravity of atoms, across the edges of a periodic cell, in the cell."""
    cell, places = specimen.cell, specimen.places[atoms]
    shares = places @ cell.inverse
    turns = np.exp(2j * np.pi * shares).mean(axis=0)
    start = np.where(cell.periodic, np.angle(turns) / (2 * np.pi), 0.0)
    away = shares - start
    away -= np.where(cell.periodic, np.rint(away), 0.0)
    inside, _ = cell.wrapped(((start + away.mean(axis=0)) @ cell.vectors)[None])
    return inside[0]

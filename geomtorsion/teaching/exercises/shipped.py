"""shipped: the list of chapters and exercises of the package."""

from __future__ import annotations

# number, package of its exercises and file of their texts
CHAPTERS: tuple[tuple[str, str], ...] = (
    ("1", "frames"),
    ("2", "torsion"),
    ("3", "curvature"),
    ("4", "straightest"),
    ("5", "closure"),
    ("6", "principle"),
    ("7", "cost"),
)
# number, module of this package, level
EXERCISES: tuple[tuple[str, str, str], ...] = (
    ("1.1", "frames.legs", "warm-up"),
    ("1.2", "frames.metric", "exercise"),
    ("1.3", "frames.anholonomy", "exercise"),
    ("1.4", "frames.body_rates", "exercise"),
    ("2.1", "torsion.one_coefficient", "warm-up"),
    ("2.2", "torsion.cartan_connection", "exercise"),
    ("2.3", "torsion.in_coordinates", "exercise"),
    ("2.4", "torsion.in_the_frame", "exercise"),
    ("3.1", "curvature.flat_or_not", "warm-up"),
    ("3.2", "curvature.christoffel", "warm-up"),
    ("3.3", "curvature.surface", "exercise"),
    ("3.4", "curvature.group_ricci", "exercise"),
    ("3.5", "curvature.disguise", "exercise"),
    ("4.1", "straightest.spiral", "warm-up"),
    ("4.2", "straightest.force", "exercise"),
    ("4.3", "straightest.equations", "exercise"),
    ("4.4", "straightest.compass", "exercise"),
    ("4.5", "straightest.constraint", "exercise"),
    ("5.1", "closure.small_loop", "warm-up"),
    ("5.2", "closure.circle", "exercise"),
    ("5.3", "closure.rotations", "exercise"),
    ("5.4", "closure.dislocation", "exercise"),
    ("5.5", "closure.frank", "exercise"),
    ("5.6", "closure.screw_atoms", "exercise"),
    ("5.7", "closure.half_plane", "warm-up"),
    ("6.1", "principle.euler", "warm-up"),
    ("6.2", "principle.moment", "exercise"),
    ("6.3", "principle.variation", "exercise"),
    ("6.4", "principle.symmetric_top", "exercise"),
    ("6.5", "principle.carried", "exercise"),
    ("6.6", "principle.helix_or_line", "project"),
    ("7.1", "cost.digits", "warm-up"),
    ("7.2", "cost.sums", "exercise"),
    ("7.3", "cost.growth", "exercise"),
    ("7.4", "cost.states", "warm-up"),
)

"""guides: what one sees on each tab, what to try there, and what its words mean."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from geomtorsion.lab.settings import PAGE


@dataclass(frozen=True)
class Guide:
    """Sentences for one tab.

    seen: what is shown. tried: what to do first. words: term -> what it means.
    """

    seen: str
    tried: str
    words: Mapping[str, str] = field(default_factory=dict)


GUIDES: Mapping[str, Guide] = {
    "Any tetrad": Guide(
        "Each row is a one-form, written by its entries along dx, dy and so on. Below stand the "
        "metric, the connections, torsion and curvature that follow from the rows, exactly.",
        "start from flat_polar and read the torsion; then write cos(phi) and "
        "-r*sin(phi) into row 1, sin(phi) and r*cos(phi) into row 2: the metric stays, the "
        "torsion goes.",
        {
            "tetrad (coframe)": "n one-forms, which say how far a step leads along each of n axes "
            "that are carried along at every point.",
            "torsion S": "the part of the connection that is antisymmetric in its lower indices: "
            "two steps, taken in either order, do not end at the same place.",
            "contortion K": "the difference of the two connections, Cartan's and Levi-Civita's.",
            "unknown function": "a function such as a(t) of which nothing is known but what it "
            "depends on; its derivatives stay in the result.",
            "indices": "are named by coordinates, or counted from 1, with a hat, where they belong "
            "to the frame.",
        },
    ),
    "Loops": Guide(
        "Left: a circle in two coordinates, which closes. Right: the same steps, added up along "
        "the axes of the frame: where there is torsion inside, an arrow b is missing at the end.",
        "make the radius smaller and see b follow 2 S A ever more closely; then take "
        "screw_dislocation, where b stays the same however small the circle is. At the foot of the "
        "page a map of your own is measured.",
        {
            "b": "the Burgers vector: what is missing when the image of a closed loop is drawn in "
            "the frame, one component for each of its axes.",
            "flux of torsion": "the torsion that goes through a surface which the loop bounds, "
            "added up; by Stokes' theorem it is b, unless the surface meets a line on which the "
            "frame is singular.",
            "2 S A": "twice the torsion at the centre times the area A inside the loop: what the "
            "flux is for a small loop.",
            "units": "lengths are in the unit in which the frame is written, angles in radians.",
        },
    ),
    "Straightest and shortest": Guide(
        "Two curves from one start, with one velocity: the straightest keeps its direction in the "
        "frame, the shortest has the smallest length. The torsion force pulls them apart.",
        "turn the picture and run the film; then choose so3: with equal moments I1, I2, I3 both "
        "are one curve, with unequal ones they part.",
        {
            "straightest (autoparallel)": "its components of velocity u1, u2, ... along the "
            "frame stay what they are: it never steers.",
            "shortest (geodesic)": "no curve nearby between two of its points is shorter, if "
            "the points are close; the moments I1, I2, I3 say how motion is measured.",
            "torsion force": "2 S_a^c_b q'^a q'^b, the acceleration by which the straightest "
            "curve leaves the shortest one.",
            "units": "lengths are in the unit of the frame, angles in radians; u1, u2, ... are "
            "per unit of the time t; moments count against each other only.",
        },
    ),
    "The top": Guide(
        "A body turns. The cone that the angular velocity draws in the body rolls on the cone "
        "that it draws in space; next to it is what you watch, by the right law and by a wrong "
        "one.",
        "press Play; then set all three moments to 2 and see that both laws agree; then "
        "switch on gravity and the fixed point for a heavy top.",
        {
            "body cone": "drawn by the angular velocity ω as the body sees it; it rolls without "
            "slipping on the space cone.",
            "space cone": "drawn by ω as somebody in the room sees it.",
            "torsion force": "a force that bends free motion as torsion would; with it on, the "
            "body follows the straightest curve of its space and not the shortest.",
            "naive law": "L' = M in body axes, without the term Ω × L: the mistake of forgetting "
            "that the axes turn with the body.",
            "nutation": "the angle of the third body axis from the vertical.",
        },
    ),
    "What accuracy costs": Guide(
        "Each mark is one way to compute the case that is set on another tab: how wrong it was, "
        "and how long it took. To the right is more accurate, lower is faster.",
        "measure the loop and find the first rule that comes below 1e-12; then make the loop "
        "smaller on its tab, and measure again.",
        {
            "error": "relative to the largest component, against a closed form or many more "
            "digits: it is measured and not assumed.",
        },
    ),
    "Exercises": Guide(
        "The same exercises as on the command line. An answer in any equal form is right; of a "
        "wrong one you are told what has probably happened.",
        "answer, read what is said, and take a hint before you look anything up; "
        "variant 0 is that of the paper, every other number gives other functions.",
    ),
}

# The part of the tab for loops that takes a file.
MEASURED = Guide(
    "A measured map: a grid of a coframe or distortion (NPZ or CSV, as SampledFrame.save writes "
    "it), an orientation map (.ctf, .ang) or a picture of a lattice (PNG, TIFF, NPY). Colours show "
    "|b| per area of square circuits of one size, each at its middle; a picture is shown as it is. "
    "The frame is the circuit whose b is given. Up to "
    f"{PAGE.upload / 1e6:g} MB, {PAGE.nodes:,} nodes or {PAGE.pixels:,} pixels; the file stays in "
    "the memory of the machine that serves this page.",
    "put the circuit round a bright spot, then beside it; make it larger and see the noise per "
    "area fall; lead it across a grain boundary or the edge of a hole, and read what is said; in a "
    "picture b is made of whole numbers: look where they change.",
    {
        "whole numbers": "how often the phases of two waves of the lattice turn along the circuit: "
        "in a picture b is exact, but for the chance that noise turns a phase once more.",
        "noise": "one standard deviation of each component, from the noise of every node or pixel, "
        "added up along this very circuit.",
        "interpolation": "what another order of interpolation between the nodes would change.",
        "|b| per area": "for an orientation map the density of dislocations that bend the lattice, "
        "times the length of their Burgers vector.",
    },
)

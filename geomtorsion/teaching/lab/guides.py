"""guides: the words of each tab, on the served page and on pages without a server."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.uploads import TEXT_MAPS


@dataclass(frozen=True)
class Guide:
    """Sentences for one tab.

    seen: the displayed objects. tried: the first action to try. question, answer: a prediction to
    make before the answer is opened. words: term -> its meaning, with formulas in LaTeX.
    """

    seen: str
    tried: str
    question: str = ""
    answer: str = ""
    words: Mapping[str, str] = field(default_factory=dict)


# Name of a tab -> the displayed objects, and an action to try: one sentence each.
GUIDES: Mapping[str, Guide] = {
    "The compass": Guide(
        "The blue ship keeps its compass course, the orange ship sails along a great circle, and "
        "torsion separates their paths.",
        "Press Play, drag the globe to turn it, and set the course to 90 degrees to check your "
        "prediction.",
        "The course is 90 degrees, due east. Which ship stays on its circle of latitude?",
        "The blue ship: everywhere it sails due east. The great circle of the orange ship bends "
        "towards the equator.",
        {
            "torsion": "two small steps along the legs (unit vectors, here east and north) end at "
            "different points if their order is changed.",
        },
    ),
    "Loops": Guide(
        "The blue curve is a closed loop in two coordinates, the green curve adds up the same "
        "steps, measured along the legs (unit vectors) of the frame at each point, and its gap "
        "(orange) is the Burgers vector b.",
        "Make the radius smaller and compare b with 2 S A in the table, then choose the space "
        "screw_dislocation and move the circle around the line and beside it.",
        "The radius becomes half as large. By which factor does b become smaller?",
        "By about 4, because a small loop has b = 2 S A, and its area A becomes 4 times smaller. A "
        "circle around the line of a screw dislocation is different: there b does not change.",
        {
            "b": "the Burgers vector: the gap between the start and the end of the green curve, "
            "one component for each leg of the frame.",
            "X¹, X², ...": "the sums of the steps along legs 1, 2, ...: the coordinates of the "
            "green curve.",
            "flux of torsion": "the integral of the torsion over a surface bounded by the loop. "
            "By Stokes' theorem it equals b, unless the frame is singular on a line through the "
            "surface.",
            "2 S A": "twice the torsion S at the centre times the area A inside the loop: the flux "
            "of a small loop.",
            "black dot": "the start of each curve.",
            "units": "lengths have the unit of the frame, and angles are in radians.",
        },
    ),
    "Straightest and shortest": Guide(
        "Two curves start at one point with one velocity: the straightest (solid blue) keeps its "
        "velocity along the legs of the frame, and the shortest (dashed orange) is a geodesic.",
        "Press Play and drag the figure to turn it, then choose the space so3 and change the "
        "moments of inertia.",
        "For which moments of inertia do the two curves in the space so3 coincide?",
        "For equal moments: then the torsion force vanishes at every velocity.",
        {
            "straightest (autoparallel)": "a curve whose velocity has constant components u1, u2, "
            "... along the legs of the frame.",
            "shortest (geodesic)": "the shortest path between any two close points on it. With "
            "moments of inertia, the square of the speed is I1 u1² + I2 u2² + I3 u3².",
            "torsion force": r"$2\,S_a{}^c{}_b\,q'^a q'^b$, the acceleration that separates the "
            "straightest curve from the shortest; $S$ is the torsion, and $q'$ the velocity in "
            "coordinates.",
            "t": "the time, the parameter of both curves.",
            "marks": "a black dot is the start, the other marks are the ends; the green line is "
            "the distance between the two curves.",
            "units": "lengths have the unit of the frame, and angles are in radians. Only the "
            "ratios of the moments matter.",
        },
    ),
    "The top": Guide(
        "The body cone (orange) rolls on the space cone (blue) and touches it along the angular "
        "velocity ω, and the chart compares the right law of motion with a wrong one.",
        "Press Play, then set all three moments to 2, and then switch on gravity and the fixed "
        "point to get a heavy top.",
        "For which moments of inertia does the naive law give the right motion of a free body?",
        "For three equal moments: then L is parallel to Ω, and the omitted term Ω × L vanishes.",
        {
            "ω": "the angular velocity, with components along the fixed axes x, y, z.",
            "Ω": "the same angular velocity, with components Ω1, Ω2, Ω3 along the body axes 1, 2, "
            "3.",
            "body cone": "the cone of all directions of ω in the body. It rolls on the space cone "
            "without slipping.",
            "space cone": "the cone of all directions of ω in space.",
            "I1, I2, I3": "the moments of inertia about the body axes.",
            "L and M": "the angular momentum and the torque, along the body axes. A prime is the "
            "rate of change.",
            "torsion force": "a force that acts like torsion: with it, a free body follows the "
            "straightest curve instead of the shortest.",
            "naive law": "L′ = M in body axes. It omits the term Ω × L, which is there because the "
            "body axes turn.",
            "nutation": "the angle between body axis 3 and the vertical z; tilt is its value at "
            "the start.",
            "attitude": "the matrix R that turns components along the body axes into components "
            "along x, y, z.",
            "black dot": "the start of a curve.",
        },
    ),
    "What accuracy costs": Guide(
        "Each mark is one computation of the loop, the curves or the top of the other tabs: "
        "further right is more accurate, and further down is faster.",
        "Measure the loop, then make it smaller on its own tab, measure again, and see which "
        "method keeps its digits.",
        "How much longer do twelve digits of a path take than three, and a run with an error "
        "estimate than one without?",
        "By Taylor series, twelve digits take about five times as long as three. A run of twelve "
        "digits takes about ten times as long with its error estimate as without: certainty costs "
        "more than digits.",
        {
            "error": "the largest deviation divided by the largest component, against a proof, a "
            "closed form or a computation with many more digits.",
            "line": "the integral along the loop, without a check.",
            "line and flux": "the integral along the loop and the integral of the torsion over the "
            "disk that it bounds; they check each other and give the error estimate.",
            "formula": "the closed form, evaluated.",
            "proof": "ball arithmetic: bounds that contain the true value.",
            "Taylor, RungeKutta": "the two methods of this library that solve equations of motion; "
            "plain: without an error estimate.",
        },
    ),
    "Any tetrad": Guide(
        "Each row of fields holds the coefficients of one one-form, and the page computes "
        "exactly, from all rows together, the metric, the connections, the torsion and the "
        "curvature.",
        "Start from flat_polar, then type cos(phi) and -r*sin(phi) into row 1, and sin(phi) and "
        "r*cos(phi) into row 2.",
        "The legs of flat_polar point along r and φ. You turn them at each point until they point "
        "along x and y. Do the metric and the torsion change?",
        "The metric stays the same. The torsion of the Cartan connection vanishes, because legs "
        "along x and y are the same at every point of the plane.",
        {
            "tetrad (coframe) e": "n one-forms e^1, ..., e^n: they give the components of a step "
            "along n legs at every point. E are the legs, the inverse matrix.",
            "signature, η": "the signs of the squares of the legs, and the diagonal matrix of "
            "these signs.",
            "torsion S": "the part of the connection that is antisymmetric in its lower indices. "
            "Two small steps end at different points if their order is changed.",
            "Levi-Civita connection": "the connection without torsion that keeps lengths. A bar "
            "marks it and its curvature.",
            "Cartan connection": "the connection in which the legs are parallel everywhere.",
            "contortion K": "the Cartan connection minus the Levi-Civita connection.",
            "unknown function": "a function such as a(t). The result contains its derivatives.",
            "indices": "an index written as a coordinate name belongs to that coordinate. A "
            "number with a hat counts the legs of the frame from 1.",
        },
    ),
    "Exercises": Guide(
        "The page checks your answer exactly, accepts every equivalent form of it, and shows the "
        "likely mistake if it is wrong.",
        "Type an answer, press Check, and take a hint if you need one; every variant number is "
        "another task of the same kind, and you can correct an answer that cannot be read.",
    ),
}

# Two more parts of the tab for loops.
ATOMS = Guide(
    "The first figure is a square crystal with an edge dislocation. A circuit is a closed walk "
    "from atom to atom. The second figure repeats your steps in a perfect lattice, where the gap b "
    "of a circuit is a whole number of lattice vectors.",
    "Press Show a circuit, then click circuits of your own around the core and beside it, and "
    "choose two opposite dislocations to go around one, the other and both.",
    "A circuit encloses two opposite dislocations. Which gap does it have?",
    "None: the Burgers vectors of the two dislocations add up to zero.",
    {
        "extra half plane": "the column of atoms that ends at the core. A circuit has one more "
        "step on its side; this step is missing on the other side.",
        "core": "the region where the bonds are too distorted to read. Circuits stay outside of "
        "it, and their exact path does not matter.",
    },
)
MEASURED = Guide(
    "Choose a grid of a coframe or distortion (NPZ or CSV, as SampledFrame.save writes it), an "
    f"orientation map ({', '.join(TEXT_MAPS)}) or a lattice image (PNG, TIFF, NPY). The page draws "
    "it and reports b for the square circuit. The colour at a point is |b| / area of a circuit of "
    f"this size centred there. The limits are {PAGE.upload / 1e6:g} MB, {PAGE.nodes:,} nodes and "
    f"{PAGE.pixels:,} pixels. The file stays in the memory of the machine that serves this page.",
    "Move the circuit to a bright spot and then beside it. Make it larger and watch the noise per "
    "area. Move it across a grain boundary or the edge of a hole and read the message. In a "
    "lattice image, look where the whole numbers change.",
    "The circuit becomes larger. Does the noise per area rise or fall?",
    "It falls: the noise adds up along the edge of the circuit, and the area grows faster.",
    {
        "whole numbers": "the number of turns of the phases of two lattice waves along the "
        "circuit. In an image b is exact, unless noise adds or removes a full turn of a phase.",
        "noise": "one standard deviation of each component, added up from the noise of each node "
        "or pixel along this circuit.",
        "interpolation": "the change of b with another order of interpolation between the nodes.",
        "|b| per area": "for an orientation map, the density of the dislocations that bend the "
        "lattice times the length of their Burgers vector.",
    },
)


# Name of a tab -> its contents in a sentence.
TABS = {
    "The compass": "A ship on a compass course and one on a great circle.",
    "Loops": "A closed loop whose image in the frame has a gap where there is torsion.",
    "Straightest and shortest": "Two curves with one start, separated by torsion.",
    "The top": "A turning body: its cones, the right law and a wrong one, and its equations.",
    "What accuracy costs": "Error against time for the case of another tab.",
    "Any tetrad": "Type one-forms; read metric, connections, torsion and curvature, exactly.",
    "Exercises": "Tasks in variants, with verdicts and hints.",
}
COMPASS, LOOPS, PATHS, TOP, COSTS, TETRAD, EXERCISES = TABS


@dataclass(frozen=True)
class StillPage:
    """A tab as a page without a server, which has computed cases and no fields.

    title: of the page. summary: its contents in a sentence. guide: its sentences.
    """

    title: str
    summary: str
    guide: Guide


STILL: Mapping[str, StillPage] = {
    COMPASS: StillPage(
        COMPASS,
        "A ship on a compass course and one on a great circle, for five courses.",
        GUIDES[COMPASS],
    ),
    LOOPS: StillPage(
        LOOPS,
        "Loops of nine radii in three spaces, and circuits in a crystal that you can click.",
        replace(
            GUIDES[LOOPS], tried="Make the radius smaller and compare b with 2 S A in the table."
        ),
    ),
    PATHS: StillPage(
        PATHS,
        "Two curves with one start, separated by torsion, in five spaces.",
        replace(
            GUIDES[PATHS],
            tried="Press Play and drag a figure to turn it, and compare the distances between the "
            "two curves in the five spaces.",
        ),
    ),
    TOP: StillPage(
        TOP,
        "Four turning bodies: their cones, the right law and a wrong one, and their equations.",
        replace(
            GUIDES[TOP],
            tried="Press Play and drag a figure to turn it, and compare the two laws for the four "
            "bodies.",
        ),
    ),
    COSTS: StillPage(
        COSTS,
        "Error against time for a loop and for a shortest path.",
        replace(
            GUIDES[COSTS],
            seen="Each mark is one computation of a loop (first figure) or of a shortest path "
            "(second figure): further right is more accurate, and further down is faster.",
            tried="Find the fastest method with an error below 1e-12, first for the loop and then "
            "for the path.",
        ),
    ),
    TETRAD: StillPage(
        "Five tetrads",
        "The metric, the connections, the torsion and the curvature of five tetrads, exact.",
        replace(
            GUIDES[TETRAD],
            seen="Each tetrad is a list of one-forms, one in each row, and its metric, "
            "connections, torsion and curvature were computed from all rows together, exactly.",
            tried="Open flat_polar and look for the components of the torsion that are not zero.",
        ),
    ),
    EXERCISES: StillPage(
        EXERCISES,
        "The tasks with their hints, to read; the served page and the command line check answers.",
        Guide(
            "The tasks and their hints are here to read, and this page has no fields for answers.",
            "Write down an answer, then check it with the command below the task, or on the page "
            "that the command geomtorsion lab serves.",
        ),
    ),
}

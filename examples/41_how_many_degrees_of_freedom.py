"""How many degrees of freedom has f(T), counted on power series, in three dimensions.

    python examples/41_how_many_degrees_of_freedom.py
    python examples/41_how_many_degrees_of_freedom.py --picture count.png

Papers disagree about f(T) since 2011. A count near a universe in which T varies gives three for
f(T) with a scalar field, hence two for f(T). From flat space Newton's method ends where T is
constant, and the answer is "not settled": there f(T) is general relativity.
"""

import argparse
from pathlib import Path

import geomtorsion as gt
from geomtorsion import pictures
from geomtorsion.gravity import perturbed


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="How many degrees of freedom.")
    parser.add_argument("--picture", type=Path, help="file for a figure of the numbers of f(T)")
    options = parser.parse_args(arguments)

    count = perturbed.degrees_of_freedom
    print(count("-F2/4", "flat", dimension=3, vectors=1))
    # General relativity has n (n - 3)/2, and none in three dimensions.
    assert count("R", "riemannian", dimension=3).number == 0
    # New general relativity: nine fields, and only three functions of gauge.
    assert count("a*T1 + b*T2 + c*T3", "teleparallel", dimension=3).number == 3

    root = "sqrt(1 + t)"
    universe = gt.Frame("t x y", [[1, 0, 0], [0, root, 0], [0, 0, root]], "-++")
    both = count("T + c*T**2 + X/2", "teleparallel", dimension=3, near=universe,
                 scalars={"phi": "log(1 + t)"}, parameters={"c": 0.1})  # fmt: skip
    print(both)
    assert both.number == 3
    assert both.branch == ()

    flat = count("T + c*T**2", "teleparallel", dimension=3, parameters={"c": 0.3}, order=5)
    print(flat)
    assert flat.number is None
    assert flat.branch == ("T",)

    if options.picture:
        pictures.save(both.plot(), options.picture)


if __name__ == "__main__":
    main()

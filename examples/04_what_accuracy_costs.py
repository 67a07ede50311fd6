"""What accuracy costs: one rotation solved by each engine, with true errors and times.

    python examples/04_what_accuracy_costs.py
    python examples/04_what_accuracy_costs.py --time 100 --picture cost.png

A body rotates at a constant rate. Its attitude is an exponential, known to any number of digits, so
each error in the table is a true error, and the estimate in its row can be judged.
"""

import argparse

import geomtorsion as gt
from geomtorsion.accuracy import accuracy_cost
from geomtorsion.curves import autoparallel


def main(arguments: list[str] | None = None) -> None:
    """Measure, print the table, and check each row against the requested accuracy."""
    parser = argparse.ArgumentParser(description="What accuracy costs in time.")
    parser.add_argument("--time", type=float, default=50.0)
    parser.add_argument("--accuracies", type=float, nargs="+", default=[1e-3, 1e-6, 1e-9, 1e-12])
    parser.add_argument("--picture", help="file for the work-precision picture (needs matplotlib)")
    options = parser.parse_args(arguments)

    so3 = gt.spaces.load("so3").frame
    turning = autoparallel(gt.cartan(so3), [0.3, 1.0, 0.2], [0.1, 0.5, -0.2])
    table = accuracy_cost(turning, options.time, accuracies=options.accuracies)
    print(table)
    if options.picture:
        table.plot().savefig(options.picture, dpi=150)

    # Known: R(t) = R(0) exp(t [Omega]x). The table measures errors against this.
    assert table.truth == "the closed form"
    for row in table.rows:
        assert row.holds, f"{row.engine} promised {row.asked} and reached {row.achieved}"
        assert row.estimated is not None
        assert row.achieved is not None
        # Below 1e-15 only rounding of single numbers remains.
        assert 0.1 * row.achieved <= row.estimated
        assert row.estimated <= max(100 * row.achieved, 1e-15)
    print("\neach error is below the requested accuracy; each estimate is within a factor of 100")


if __name__ == "__main__":
    main()

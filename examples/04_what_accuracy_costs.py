"""What accuracy costs: a free top by each engine, with enclosed errors, and digits for seconds.

    python examples/04_what_accuracy_costs.py
    python examples/04_what_accuracy_costs.py --time 100 --picture price.png

Ball arithmetic encloses the true motion, so that each claimed error in the table can be judged.
Three rows predict the time of any other accuracy, and the accuracy that a time buys.
"""

import argparse

import geomtorsion as gt


def main(arguments: list[str] | None = None) -> None:
    """Measure, print the table, and check each claim against the enclosed error."""
    parser = argparse.ArgumentParser(description="What accuracy costs in time.")
    parser.add_argument("--time", type=float, default=20.0)
    parser.add_argument("--accuracies", type=float, nargs="+", default=[1e-3, 1e-6, 1e-9, 1e-12])
    parser.add_argument("--picture", help="file for the figure (needs matplotlib)")
    options = parser.parse_args(arguments)

    so3 = gt.spaces.load("so3").frame
    top = gt.geodesic(so3, frame_velocity=[1, 2, 3], metric=[1, 2, 3])
    prices = gt.price(top, options.time, options.accuracies, proofs=[10])
    print(prices)
    if options.picture:
        prices.plot().savefig(options.picture, dpi=150)

    # Each true error is enclosed by a proof.
    assert "enclosed" in prices.truth
    for row in prices.rows:
        if row.certainty == "estimate":
            assert row.holds, f"{row.way} claimed {row.claimed}, and its error is {row.true}"
            assert row.reached

    middle = (options.accuracies[0] * options.accuracies[-1]) ** 0.5
    seconds = prices.seconds(middle)
    print(f"\naccuracy {middle:.1e} is predicted to take {1e3 * seconds:.3g} ms")
    solution = gt.solve(top, options.time, seconds=10 * seconds)
    print(f"ten times as long buys {solution.accuracy:.1e}, with an error of {solution.error:.1e}")
    again = gt.solve(top, options.time, solution.accuracy)
    assert (solution["u1"] == again["u1"]).all()
    print("\neach claimed error is at least the true error; the same accuracy gives the same bits")


if __name__ == "__main__":
    main()

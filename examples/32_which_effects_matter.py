"""Which effects matter: an accuracy decides which forces on a missile are simulated.

    python examples/32_which_effects_matter.py
    python examples/32_which_effects_matter.py --accuracies 1e-1 1e-4 --picture effects.png

Each effect is omitted once, and the change of the watched quantities is its influence. Effects are
then omitted, the smallest first, as long as the omission and the integration together stay within
the accuracy. Here the total error is checked against a run with all effects. The other direction is
at the end: how much the effects that the scene does not have would change it.
"""

import argparse
from dataclasses import replace

import numpy as np

import geomtorsion as gt
from geomtorsion import effects


def missile() -> gt.Scene:
    """A missile with an engine that pushes askew, its weight, and three kinds of drag."""
    scene = gt.scenes.load("missile")
    more = [effects.Gravity(9.81), effects.QuadraticDrag(1e-4), effects.AngularDamping(1e-4)]
    return replace(scene, effects=[*scene.effects, *more, effects.LinearDrag(1e-3)])


def total_error(scene: gt.Scene, part: gt.Scene, accuracy: float) -> float:
    """Largest change of a watched quantity by part of the effects, relative to its size."""
    whole, run = replace(scene, accuracy=accuracy / 100).run(), part.run()
    sizes = [np.abs(run[name] - whole[name]).max() / np.abs(whole[name]).max() for name in whole]
    return float(max(sizes))


def main(arguments: list[str] | None = None) -> None:
    """Print the effects for each accuracy, and check the total error."""
    parser = argparse.ArgumentParser(description="Which effects an accuracy calls for.")
    parser.add_argument("--accuracies", type=float, nargs="+", default=[1e-1, 1e-2, 1e-3, 1e-5])
    parser.add_argument("--picture", help="file for the influences (needs matplotlib)")
    options = parser.parse_args(arguments)

    flight = missile()
    turning = replace(flight, watch=("omega",), title="the same, only its rotation is watched")
    for scene in (flight, turning):
        print(scene)
        print("accuracy  equations  true error  effects")
        for accuracy in options.accuracies:
            budget = scene.called_for(accuracy)
            error = total_error(scene, budget.chosen, accuracy)
            assert error <= accuracy
            assert budget.error <= accuracy
            names = ", ".join(budget.effects) or "none"
            print(f"{accuracy:>8.0e}  {budget.chosen.ode.size:>9}  {error:>10.1e}  {names}")
        print()
    if options.picture:
        flight.called_for(options.accuracies[0]).plot(options.picture)

    weightless = gt.scenes.load("missile")
    table = weightless.magnitudes()
    print(table)
    # Known: the weight changes the velocity by g t, whatever the engine does.
    weight = next(row for row in table.rows if row.effect.key == "gravity")
    change = weight.changes["velocity"] * np.abs(weightless.run()["velocity"]).max()
    fall = table.surroundings.gravity * weightless.times[-1]
    assert abs(change - fall) < 1e-8 * fall


if __name__ == "__main__":
    main()

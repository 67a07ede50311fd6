"""Which effects matter: an accuracy decides which forces on a missile are simulated.

    python examples/32_which_effects_matter.py
    python examples/32_which_effects_matter.py --accuracies 1e-1 1e-4 --picture effects.png

Each effect is omitted once, and the change of the watched quantities is its influence. Effects are
then omitted, the smallest first, as long as the omission and the integration together stay within
the accuracy. Here the total error is checked against a run with all effects. The same is done for a
satellite, whose forces are effects, and for a universe, whose theory has terms. The other direction
is at the end: how much the effects that a scene does not have would change it.
"""

import argparse
from dataclasses import replace

import numpy as np
import sympy as sp

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


def satellite() -> gt.ode.Solution:
    """A satellite of a flattened planet, with a moon far away and a trace of air."""
    attraction = {"centre": "-1/r", "flattening": "-1/(2000 r^3)", "moon": "-r^2/10^8"}
    flat = gt.levi_civita("flat_polar")
    drag = {"air": ["-u1/10^7", "-u2/10^7"]}
    orbit = gt.autoparallel(flat, [1, 0], [0, 1.1], potential=attraction, force=drag)
    return gt.solve(orbit, 10)


def universe() -> gt.ode.Solution:
    """Dust and a little radiation, in a theory with a weak square of the curvature."""
    a = sp.Function("a")(sp.Symbol("t"))
    frame = gt.Frame("t x y z", sp.diag(1, a, a, a), "-+++")
    dust = gt.gravity.fluid("rho(t)", 0, [1, 0, 0, 0])
    radiation = gt.gravity.fluid("sigma(t)", "sigma(t)/3", [1, 0, 0, 0])
    theory = "R/2 - Lambda + alpha*R**2"
    equations = gt.gravity.equations(gt.levi_civita(frame), theory, [dust, radiation])
    start = {"a": 1, "rho": 2, "sigma": 1e-5, "a_1": 1, "a_2": 0}
    return gt.gravity.solve(equations, "t", 1, start, {"Lambda": 1, "alpha": 1e-5})


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
        gt.pictures.save(flight.called_for(options.accuracies[0]).plot(), options.picture)

    for solution in (satellite(), universe()):
        budget = gt.called_for(solution, 1e-3)
        print(budget, end="\n\n")
        sizes = [np.abs(solution[name]).max() for name in budget.watch]
        gaps = [np.abs(budget.result[name] - solution[name]).max() for name in budget.watch]
        assert max(np.divide(gaps, sizes)) <= budget.error <= 1e-3
    # Known: with dust and a cosmological constant only, a grows as sinh(phase)^(2/3).
    phase = np.arcsinh(np.sqrt(1 / 2)) + np.sqrt(3) / 2
    assert abs(budget.result["a"][-1] - (2 * np.sinh(phase) ** 2) ** (1 / 3)) < 1e-4

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

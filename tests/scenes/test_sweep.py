"""Sweeps: many motions measured at once agree with single solves."""

import csv

import numpy as np
import pytest
from scipy.special import ellipkm1

from geomtorsion.errors import SceneError, StartError, StuckError, UnknownNameError
from geomtorsion.ode import RungeKutta
from geomtorsion.scenes import Body, Scene, State, effects, load
from geomtorsion.scenes.metrics import SweepRun, measures
from tests.ode.engines import needs_heyoka
from tests.rounding import ROUNDED

FLIP = "between zeros omega[1]"


def flip_time(tilt):
    """Half a period 2 K / rate of the middle component, moments 1, 2, 3, omega (tilt, 1, 0)."""
    squared, twice = tilt**2 + 4, tilt**2 + 2
    rate = np.sqrt((2 - 1) * (3 * twice - squared) / 6)
    return 2 * ellipkm1(tilt**2 / (1 + tilt**2)) / rate


def test_flips_wait_for_an_elliptic_integral():
    """Flip times at tilts from 0.1 to 1e-9 agree with an elliptic integral."""
    tilts = np.geomspace(1e-9, 0.1, 6)
    scene = load("dzhanibekov").with_values(t=120)
    sweep = scene.sweep({"start.omega[0]": tilts}, FLIP)
    assert sweep[FLIP] == pytest.approx(flip_time(tilts), rel=1e-11)
    assert sweep.engine == "closed form"
    assert sweep.error < sweep.accuracy
    assert "6 start.omega[0]" in str(sweep)


def test_batches_agree_with_single_runs():
    """Parameters of effects and of the start, in every combination."""
    scene = load("lagrange_cusp").with_values(t=0.5, watch=("nutation", "energy"))
    varied = {"gravity.g": [1.62, 9.81], "start.omega[2]": [80.0, 100.0, 150.0]}
    sweep = scene.sweep(varied, ["max nutation", "last energy"], engine=RungeKutta())
    assert sweep["max nutation"].shape == (2, 3)
    for i, g in enumerate(varied["gravity.g"]):
        for j, spin in enumerate(varied["start.omega[2]"]):
            one = scene.with_values({"gravity.g": g, "start.omega[2]": spin, "samples": 2001}).run()
            assert sweep["last energy"][i, j] == pytest.approx(one["energy"][-1], rel=1e-9)
            largest = sweep["max nutation"][i, j]
            assert one["nutation"].max() - 1e-9 <= largest <= one["nutation"].max() + 1e-5


def test_equations_that_differ_are_solved_apart():
    """A value of zero and equal moments change the equations; results still agree."""
    scene = load("lagrange_cusp").with_values(t=0.2, watch=("nutation",))
    equal = (scene.body.moments or (0,))[0]
    paths = {"gravity.g": [0.0, 9.81], "body.moments[1]": [equal, 3e-4]}
    sweep = scene.sweep(paths, "last nutation", together=True)
    assert sweep["last nutation"].shape == (2,)
    for k in range(2):
        one = scene.with_values({path: values[k] for path, values in paths.items()}).run()
        assert sweep["last nutation"][k] == pytest.approx(one["nutation"][-1], rel=1e-8)


def test_motions_that_stop_are_run_one_by_one():
    """A user's function measures the time of a fall from several heights."""
    fall = Scene(
        Body(moments=(1, 1, 1)),
        [effects.Gravity(10), effects.Custom(stop="z")],
        State(omega=(0, 0, 1), quaternion=(1, 0, 0, 0), position=(0, 0, 5)),
        watch=["position"],
        t=10,
    )

    def lasts(run: SweepRun) -> float:
        return float(run.times[-1])

    heights = np.array([5.0, 20.0])
    sweep = fall.sweep({"start.position[2]": heights}, lasts)
    assert sweep["lasts"] == pytest.approx(np.sqrt(2 * heights / 10), rel=1e-9)


def test_tables_and_pictures(tmp_path):
    """CSV and pandas have a row for each combination; figures are curves or, for two, fields."""
    scene = load("dzhanibekov").with_values(t=40)
    sweep = scene.sweep({"start.omega[0]": [1e-3, 1e-2], "start.omega[1]": [1.0, 2.0, 3.0]}, FLIP)
    sweep.to_csv(tmp_path / "sweep.csv")
    with (tmp_path / "sweep.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 6
    assert float(rows[1]["start.omega[1]"]) == 2.0
    assert float(rows[4][FLIP]) == sweep[FLIP][1, 1]
    pandas = pytest.importorskip("pandas")
    assert isinstance(sweep.to_pandas(), pandas.DataFrame)
    pytest.importorskip("matplotlib")
    sweep.plot(tmp_path / "field.png")
    tilts = np.geomspace(1e-4, 1e-1, 4)
    line = scene.sweep({"start.omega[0]": tilts}, FLIP)
    figure = line.plot(tmp_path / "line.png", known=flip_time, known_name="elliptic integral")
    assert "elliptic integral" in figure.axes[0].get_legend_handles_labels()[1]
    assert (tmp_path / "line.png").stat().st_size > 8000
    three = scene.sweep({"start.omega[0]": [0.1], "start.omega[1]": [1.0], "body.mass": [1]}, FLIP)
    with pytest.raises(SceneError, match="expected two varied quantities for a picture, got 3"):
        three.plot()


def test_measures():
    """Words and functions measure between samples as well as at them."""
    times = np.linspace(0, 10, 301)
    run = SweepRun(times, {"x": np.sin(times), "v": np.stack([times, -times], 1)}, {})
    made = measures(
        ["max x", "min x", "mean x", "x", "first zero x", FLIP.replace("omega[1]", "x")]
    )
    found = {name: reader(run) for name, reader in made.items()}
    assert found["max x"] == pytest.approx(1, abs=ROUNDED)
    assert found["min x"] == pytest.approx(-1, abs=ROUNDED)
    assert found["x"] == np.sin(10)
    assert found["first zero x"] == pytest.approx(np.pi, rel=1e-13)
    assert found["between zeros x"] == pytest.approx(np.pi, rel=1e-13)
    assert np.isnan(measures("first zero v[0]")["first zero v[0]"](run))
    with pytest.raises(SceneError, match="v: expected one component, got 2"):
        measures("max v")["max v"](run)
    with pytest.raises(UnknownNameError, match="expected a watched quantity"):
        measures("max w")["max w"](run)
    with pytest.raises(SceneError, match="Did you mean max"):
        measures("maxi x")


@pytest.mark.parametrize(
    ("varied", "measure", "error", "words"),
    [
        ({}, FLIP, SceneError, "varied: expected paths with values, got none"),
        ([1], FLIP, SceneError, "varied: expected"),
        ({"start.omega[0]": [1]}, None, SceneError, "measure: expected words"),
        ({"start.omega[0]": [1]}, [3], SceneError, "measure: expected words"),
        ({"start.omega[0]": []}, FLIP, SceneError, "varied: expected at least one value, got none"),
        ({"start.omga[0]": [1]}, FLIP, UnknownNameError, "Did you mean omega"),
        ({"gravity.g": [1]}, FLIP, UnknownNameError, "does not exist"),
        ({"start.omega[7]": [1]}, FLIP, UnknownNameError, r"no \[7\]"),
        ({"start.omega[0]": [float("nan")]}, FLIP, (StartError, SceneError), "nan"),
        ({"start.omega[0]": [1]}, "biggest omega[0]", SceneError, "measure: expected words"),
        ({"start.omega[0]": [1]}, "max omgea[0]", UnknownNameError, "Did you mean omega"),
    ],
)
def test_bad_calls_are_refused(varied, measure, error, words):
    """Each error is ours and names the path."""
    with pytest.raises(error, match=words):
        load("dzhanibekov").sweep(varied, measure)
    with pytest.raises(SceneError, match="together: expected lists of equal length"):
        load("dzhanibekov").sweep(
            {"start.omega[0]": [1, 2], "start.omega[1]": [1]}, FLIP, together=True
        )


def test_whole_vectors():
    """An attitude has four numbers that vary together; each is a column of the table."""
    turns = [(1, 0, 0, 0), (0.6, 0.8, 0, 0), (0.6, 0, 0, -0.8)]
    scene = load("dzhanibekov").with_values(t=1, watch=("omega_space",))
    sweep = scene.sweep({"start.quaternion": turns, "start.omega[0]": [0.1, 0.2]}, LAST)
    for place in np.ndindex(3, 2):
        changes = {"start.quaternion": turns[place[0]], "start.omega[0]": (0.1, 0.2)[place[1]]}
        single = scene.with_values(changes).run()["omega_space"][-1, 2]
        assert sweep[LAST][place] == pytest.approx(single, abs=1e-9)
    turned = scene.sweep({"start.omega[0]": [0.1, 0.2], "start.quaternion": turns}, LAST)
    assert turned[LAST] == pytest.approx(sweep[LAST].T, abs=1e-9)
    assert scene.sweep({"start.euler": [(0, 0, 0)]}, LAST)[LAST].shape == (1,)
    columns = sweep.columns()
    assert columns["start.quaternion[1]"].tolist() == [0, 0, 0.8, 0.8, 0, 0]
    moments = scene.sweep({"body.moments": [(1, 2, 3), (1, 2, 2.5)]}, LAST)
    assert moments[LAST].shape == (2,)
    assert "number" in moments.plot().axes[0].get_xlabel()


LAST = "last omega_space[2]"


def test_members_that_fail():
    """A motion that ends at a pole has no value and is reported; the others are unaffected."""
    pole = effects.Custom(force=("k*x**3", 0, 0), parameters={"k": 1.0})
    start = State(position=(1, 0, 0), velocity=(1, 0, 0))
    scene = Scene(Body(moments=(1, 2, 2.5)), [pole], start, ["position"], t=1.2)
    sweep = scene.sweep({"custom.parameters.k": [0.1, 9.0, 0.2]}, "max position[0]")
    single = scene.with_values({"custom.parameters.k": 0.2}).run()["position"][-1, 0]
    assert sweep["max position[0]"][2] == pytest.approx(single, rel=1e-9)
    assert np.isnan(sweep["max position[0]"]).tolist() == [False, True, False]
    [(where, why)] = sweep.unfinished
    assert where == {"custom.parameters.k": 9.0}
    assert "1 without a value" in str(sweep)
    assert "does not reach" in why
    with pytest.raises(StuckError, match="expected a motion that reaches its end, got none"):
        scene.sweep({"custom.parameters.k": [9.0, 10.0]}, "max position[0]")
    assert "none" in str(scene.sweep({"custom.parameters.k": [0.1]}, "first zero position[0]"))


@pytest.mark.parametrize("column", [3.0, ["a", "b"], [(1, 2), (1, 2, 3)]])
def test_invalid_columns_are_refused(column):
    """One number, words, and vectors of unequal length are refused."""
    with pytest.raises(SceneError, match="a list of numbers, or of vectors"):
        load("dzhanibekov").sweep({"body.moments": column}, FLIP)


def test_batches_in_parts(monkeypatch):
    """Motions that do not all fit into memory are solved in parts, with the same result."""
    scene, varied = load("lagrange_cusp").with_values(t=0.2), {"gravity.g": [9.7, 9.8, 9.9]}
    whole = scene.sweep(varied, "max nutation")
    monkeypatch.setattr("geomtorsion.scenes.sweep.LARGEST_BATCH", 10_000)
    parts = scene.sweep(varied, "max nutation")
    assert np.abs(whole["max nutation"] - parts["max nutation"]).max() < 2 * scene.accuracy


def test_each_motion_of_a_sweep_has_its_own_error():
    """A top that swings as a pendulum, 301 starts, one of them on the separatrix: omega = 2/cosh t.

    Half the moment of inertia (about the pivot) is the torque of the weight: theta'' = -sin theta.
    """
    scene = Scene(
        Body(moments=(1, 1, 1), mass=1),
        [effects.Gravity(2), effects.Pivot((0, 0, -1))],
        State(omega=(1.5, 0, 0), euler=(0, 0, 0)),
        t=8,
        watch=("omega",),
    )
    sweep = scene.sweep({"start.omega[0]": np.linspace(1.5, 2.5, 301)}, "last omega[0]")
    assert sweep.errors.shape == (301,)
    assert sweep.error == sweep.errors.max() <= sweep.accuracy
    gap = abs(sweep["last omega[0]"][150] - 2 / np.cosh(8)) / 2
    assert gap <= sweep.errors[150] <= 1e-9


@needs_heyoka
def test_only_motions_that_need_more_digits_are_solved_singly(monkeypatch):
    """Only the motion on the separatrix needs more than doubles up to t = 22: it is redone."""
    scene = Scene(
        Body(moments=(1, 1, 1), mass=1),
        [effects.Gravity(2), effects.Pivot((0, 0, -1))],
        State(omega=(1.5, 0, 0), euler=(0, 0, 0)),
        t=22,
        watch=("omega",),
    )
    singly = []
    run = Scene.run

    def counted(self, *arguments, **options):
        singly.append(float(self.start.omega[0]))
        return run(self, *arguments, **options)

    monkeypatch.setattr(Scene, "run", counted)
    shares = []
    sweep = scene.sweep(
        {"start.omega[0]": np.linspace(1.5, 2.5, 41)}, "last omega[0]", progress=shares.append
    )
    assert singly == [2.0]
    assert len(shares) == 41
    assert shares[-1] == 1.0
    assert (sweep.errors <= sweep.accuracy).all()
    gap = abs(sweep["last omega[0]"][20] - 2 / np.cosh(22)) / 2
    assert gap <= sweep.errors[20]


def test_each_free_body_of_a_sweep_is_checked():
    """Each closed form of a sweep has its own error, independent of the other motions."""
    scene = load("dzhanibekov").with_values(t=60)
    tilts = [1e-7, 1e-4, 1e-1]
    sweep = scene.sweep({"start.omega[0]": tilts}, FLIP)
    assert sweep.engine == "closed form"
    assert (sweep.errors > 0).all()
    assert sweep.error == sweep.errors.max() <= sweep.accuracy
    for tilt, error in zip(tilts, sweep.errors, strict=True):
        alone = scene.sweep({"start.omega[0]": [tilt]}, FLIP)
        assert alone.errors.tolist() == [error]


@pytest.mark.parametrize("engine", [None, RungeKutta()])
def test_an_interruption_keeps_measured_values(engine):
    """After Ctrl-C in a sweep the finished values are kept, and the rest is named."""
    scene = load("lagrange_cusp").with_values(t=0.1)
    masses = [0.4, 0.5, 0.6]
    whole = scene.sweep({"body.mass": masses}, "last nutation", engine=engine)
    after = [2]

    def stop(_: float) -> None:
        after[0] -= 1
        if after[0] == 0:
            raise KeyboardInterrupt

    partial = scene.sweep({"body.mass": masses}, "last nutation", engine=engine, progress=stop)
    assert partial.interrupted
    assert not whole.interrupted
    assert "Ctrl-C" in str(partial)
    found = partial["last nutation"]
    assert found[:2].tolist() == whole["last nutation"][:2].tolist()
    assert np.isnan(found[2])
    assert [reason for _, reason in partial.unfinished] == [
        "Ctrl-C stopped the sweep before this motion"
    ]


def test_unknown_names_of_a_sweep_are_refused():
    """An unknown name is refused with the known names, not with a KeyError."""
    found = load("lagrange_cusp").sweep({"gravity.g": [9.0]}, "last nutation")
    assert found["gravity.g"].tolist() == [9.0]
    with pytest.raises(UnknownNameError, match="Did you mean last nutation"):
        _ = found["last mutation"]
    with pytest.raises(UnknownNameError, match="There are last nutation"):
        found.plot(measure="gravity.g")


def test_last_times_and_accuracies_that_are_varied():
    """Each motion is solved to its own last time and accuracy."""
    scene = load("lagrange_cusp").with_values(watch=["nutation"], t=0.1)
    found = scene.sweep({"t": [0.1, 0.2], "accuracy": [1e-6, 1e-10]}, "last nutation")
    alone = [scene.with_values(t=t).run()["nutation"][-1] for t in (0.1, 0.2)]
    for k in range(2):
        assert found["last nutation"][:, k] == pytest.approx(alone, abs=1e-6)
    assert found.errors[:, 1].max() <= 1e-10


def test_each_body_of_a_sweep_has_its_own_axis_of_symmetry():
    """Each body has its own axis, even where all equations are written alike."""
    turned = np.array([[1.0, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])
    bodies = [np.diag(moments) for moments in ((1.0, 1.0, 1.5), (1.0, 1.5, 1.0))]
    tensors = [turned @ body @ turned.T for body in bodies]
    scene = Scene(
        Body(inertia=tensors[0]), [effects.AngularDamping(0.1)],
        State(omega=(0, 0, 0), euler=(0, 0, 0)), watch=["axis"], t=1,
    )  # fmt: skip
    found = scene.sweep({"body.inertia": tensors}, "last axis[2]")
    alone = [
        scene.with_values({"body.inertia": rows.tolist()}).run()["axis"][-1, 2] for rows in tensors
    ]
    assert abs(alone[0] - alone[1]) > 0.1
    assert found["last axis[2]"] == pytest.approx(alone, abs=1e-9)

"""Scene: dotted paths, several effects of a kind, costs, and results that are saved."""

# The tests pass bad input and arrays for lists, and use results that could be None.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import (
    AccuracyError,
    FileFormatError,
    SceneError,
    TimeError,
    UnknownNameError,
)

E = gt.effects
TOP = gt.Scene(
    gt.Body(mass=1.0, moments=(1, 1, 0.5)),
    [E.Gravity(9.81), E.Pivot([0, 0, 0.1])],
    gt.State(omega=(0, 0, 20), euler=(0, 0.3, 0)),
    watch=["nutation", "energy"],
    t=2,
    title="A top",
)


def test_the_first_lines():
    """The first example: plan, run, and every result."""
    result = TOP.run()
    assert result["nutation"].shape == result.times.shape == (201,)
    assert result.error < TOP.accuracy
    assert result.drift["energy"] < 1e-10
    assert result.complete
    assert "A top: 6 equations for nutation, energy" in str(result.selection)
    assert "by Taylor" in str(result) or "by RungeKutta" in str(result)


def test_times():
    assert TOP.times.tolist() == np.linspace(0, 2, 201).tolist()
    assert TOP.with_values(samples=3).times.tolist() == [0, 1, 2]
    assert TOP.with_values(t=[0.5, 1.5]).run().times.tolist() == [0.5, 1.5]
    assert TOP.with_values(t=0).run()["nutation"] == pytest.approx([0.3])


def test_replacing():
    """Each kind of path changes its value only, and everything is checked again."""
    changed = TOP.with_values(
        {"body.moments[2]": 0.7, "gravity.g": 1.62, "start.omega[0]": 1e-3, "pivot.arm[2]": 0.2},
        t=5,
    )
    assert changed.body.moments == (1, 1, 0.7)
    assert changed.keyed["gravity"].g == 1.62
    assert changed.start.omega == (1e-3, 0, 20)
    assert changed.keyed["pivot"].arm == (0, 0, 0.2)
    assert changed.t == 5
    assert changed.watch == TOP.watch
    assert TOP.with_values(start=gt.State(omega=(0, 0, 1), euler=(0, 0, 0))).start.omega == (
        0,
        0,
        1,
    )
    with pytest.raises(gt.errors.BodyError, match="impossible"):
        TOP.with_values({"body.moments[2]": 5})


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("gravty.g", "'gravty.g' does not exist. Did you mean gravity"),
        ("gravity.h", "'gravity.h' does not exist. There are g"),
        ("gravity", "got the whole effect"),
        ("body.momnts", "Did you mean moments"),
        ("start.omega[7]", "no \\[7\\] among 3 values"),
        ("start.position[0]", "None has no components; set it as a whole first"),
        ("start.omega.x", "'start.omega.x' does not exist"),
        ("effects", "expected 'called for', got 1"),
        ("a b", "expected a path with dots"),
        ("mass", "does not exist. There are body"),
    ],
)
def test_paths_that_lead_nowhere(path, words):
    with pytest.raises(UnknownNameError, match=words):
        TOP.with_values({path: 1})


def test_equal_equations_share_one_integrator():
    """Another number needs no compilation."""
    TOP.run()
    other = TOP.with_values({"gravity.g": 3.3, "start.omega[2]": 11.0})
    assert other.ode.system is TOP.ode.system
    assert other.run().cost.compile_seconds == 0


def test_numbers_of_scenes():
    """A sweep varies starts and parameters by name, exactly."""
    start, parameters = TOP.numbers
    assert list(start) == list(TOP.selection.states)
    assert float(parameters["g"]) == 9.81
    assert set(parameters) == {"m", "I1", "I3", "g", "a3"}
    assert TOP.ode.with_start(start=start, parameters=parameters).start == TOP.ode.start


def test_several_of_a_kind():
    """Keys and parameters are numbered; two springs pull with the sum of their forces."""
    start = gt.State(omega=(0, 0, 1), position=(1, 0, 0))
    body = gt.Body(moments=(1, 1, 1))
    two = gt.Scene(body, [E.Spring(1.0), E.Spring(3.0)], start, ["position"], t=3)
    one = gt.Scene(body, [E.Spring(4.0)], start, ["position"], t=3)
    assert tuple(two.keyed) == ("spring", "spring2")
    assert np.abs(two.run()["position"] - one.run()["position"]).max() < 1e-9
    assert np.abs(one.run()["position"][:, 0] - np.cos(2 * one.times)).max() < 1e-9
    assert two.with_values({"spring2.stiffness": 1.0}).keyed["spring2"].stiffness == 1.0


def test_result_between_times_and_bad_requests():
    result = TOP.run()
    again = result.at(result.times[[3, 100]])
    assert np.abs(again["nutation"] - result["nutation"][[3, 100]]).max() < 1e-9
    with pytest.raises(
        UnknownNameError, match="expected a watched quantity, got 'nutaton'. Did you mean nutation"
    ):
        result["nutaton"]
    with pytest.raises(TimeError, match=r"expected t from 0 to .*, got 2\.5"):
        result.at(2.5)
    with pytest.raises(AccuracyError):
        TOP.with_values(accuracy=0)
    with pytest.raises(TimeError):
        TOP.with_values(t=[1, 1])


def test_save_and_load(tmp_path):
    """Everything except the scene and the dense output is restored."""
    scene = TOP.with_values(watch=["nutation", "matrix", "omega"], t=1)
    result = scene.run()
    result.save(tmp_path / "top.npz")
    back = gt.scenes.SceneResult.load(tmp_path / "top.npz")
    for name in scene.watch:
        assert (back[name] == result[name]).all()
    assert (back.times == result.times).all()
    assert back.error == result.error
    assert back.drift == dict(result.drift)
    assert back.cost == result.cost
    assert back.units == result.units
    assert back.labels["matrix"] == result.labels["matrix"]
    assert str(result.selection) == back.selection
    assert str(back).splitlines()[1:] == str(result).splitlines()[1:]
    with pytest.raises(SceneError, match="from a file"):
        back.at(0.5)
    with pytest.raises(SceneError, match="from a file"):
        _ = back.solution
    (tmp_path / "no.npz").write_bytes(b"nothing")
    with pytest.raises(FileFormatError, match="not a saved result of a scene"):
        gt.scenes.SceneResult.load(tmp_path / "no.npz")
    np.savez(tmp_path / "other.npz", a=1)
    with pytest.raises(FileFormatError, match="not a saved result of a scene"):
        gt.scenes.SceneResult.load(tmp_path / "other.npz")


def test_tables():
    pandas = pytest.importorskip("pandas")
    result = TOP.with_values(watch=["nutation", "omega", "matrix"], t=1, samples=5).run()
    table = result.to_pandas()
    assert isinstance(table, pandas.DataFrame)
    names = ["t", "nutation", "omega_1", "omega_2", "omega_3", "matrix_11"]
    assert list(table.columns)[:6] == names
    assert table.shape == (5, 14)
    assert (table["omega_3"] == result["omega"][:, 2]).all()
    assert (table["matrix_23"] == result["matrix"][:, 1, 2]).all()


def test_picture(tmp_path):
    pytest.importorskip("matplotlib")
    result = TOP.with_values(watch=["nutation", "omega"], t=1).run()
    figure = result.plot(tmp_path / "top.png")
    assert len(figure.axes) == 2
    assert (tmp_path / "top.png").stat().st_size > 5000


def test_what_each_effect_costs():
    """There is one row for each effect; states grow as effects bring their needs."""
    scene = TOP.with_values(watch=["omega"], t=1)
    cost = scene.cost(repeats=1)
    assert [row.effect for row in cost.rows] == ["spin", "gravity", "pivot"]
    assert [row.states for row in cost.rows] == [3, 3, 6]
    assert all(row.run_seconds > 0 and row.steps > 0 for row in cost.rows)
    text = str(cost)
    assert "+ pivot" in text
    assert "added, ms" in text
    rotor = E.Rotor((0, 0, 1), momentum=0.1, inertia=0.01)
    late = gt.Scene(TOP.body, [E.Gravity(), rotor], TOP.start, ["rotor_speed"], t=1)
    rows = late.cost(repeats=1).rows
    assert "not by itself" in rows[0].note
    assert rows[2].states > 0


def test_progress_and_checkpoint(tmp_path):
    """Progress and checkpoint are passed to the integrator."""
    seen = []
    scene = TOP.with_values(t=3, samples=21)
    result = scene.run(checkpoint=tmp_path / "c.npz", progress=seen.append)
    assert seen[-1] == pytest.approx(1)
    assert (tmp_path / "c.npz").exists()
    again = scene.run(checkpoint=tmp_path / "c.npz")
    assert (again["nutation"] == result["nutation"]).all()


@pytest.mark.parametrize("bad", [None, "no", float("nan"), [1], [[1, 2], [3]], object(), 1j])
def test_nonsense_gets_an_error_of_ours(bad):
    """Wrong input anywhere gives a message of ours, never an internal traceback."""
    body, start = gt.Body(moments=(1, 2, 3)), gt.State(omega=(0, 0, 1), euler=(0, 0, 0))
    given = {"body": body, "start": start}
    attempts = [
        lambda: gt.Body(mass=bad, moments=(1, 2, 3)),
        lambda: gt.Body(moments=bad),
        lambda: gt.Body.box(1, bad),
        lambda: gt.Body.points(bad),
        lambda: gt.Body.points([(1, bad)]),
        lambda: gt.State(matrix=7 if bad is None else bad),
        lambda: gt.State(omega=7 if bad is None else bad),
        lambda: gt.State(euler_convention=bad),
        lambda: gt.Scene(**{**given, "body": bad}),
        lambda: gt.Scene(**{**given, "start": bad}),
        lambda: gt.Scene(**given, watch=bad),
        lambda: gt.Scene(**given, watch=[bad]),
        lambda: gt.Scene(**given, effects=[bad]),
        lambda: gt.Scene(**given, effects=bad),
        lambda: gt.Scene(**given, accuracy=bad),
        lambda: gt.Scene(**given, samples=bad),
        lambda: gt.Scene(**given, effects=[E.Gravity(bad), E.Pivot((0, 0, 1))]).ode,
        lambda: gt.Scene(**given, effects=[E.Pivot(bad)]).ode,
        lambda: TOP.with_values({"start.omega[0]": bad}).ode,
        lambda: TOP.with_values({"nothing": bad}),
    ]
    for attempt in attempts:
        with pytest.raises(gt.GeomtorsionError, match=".{20}"):
            attempt()


def test_what_can_be_watched():
    """Every listed name can be watched, names of effects as well."""
    rotor = E.Rotor((0, 0, 1), momentum=0.1, inertia=0.01)
    scene = gt.Scene(TOP.body, [rotor], TOP.start)
    names = scene.observables
    assert names["rotor_speed"] == "of rotor"
    assert len(names) > 24
    result = scene.with_values(watch=list(names), t=0.5, samples=3).run()
    assert set(result.values) == set(names)
    assert set(result.units) == set(names)


def test_a_stuck_motion_carries_its_partial_result():
    """A force that grows beyond all bounds at t = 1 raises an error with the partial result."""
    pole = E.Custom(force=("0", "0", "1/(1 - t)**2"))
    start = gt.State(omega=(0, 0, 1))
    scene = gt.Scene(TOP.body, [pole], start, ["velocity"], t=2)
    with pytest.raises(gt.errors.StuckError) as caught:
        scene.run()
    so_far = caught.value.solution
    assert isinstance(so_far, gt.scenes.SceneResult)
    assert not so_far.complete
    assert so_far.times[-1] < 1
    t = so_far.times
    assert np.abs(so_far["velocity"][:, 2] - t / (1 - t)).max() < 1e-6


def test_a_force_without_a_value_at_the_start():
    """The error names the time and the rate."""
    start = gt.State(omega=(0, 0, 1))
    scene = gt.Scene(TOP.body, [E.Custom(force=("log(t - 1)", "0", "0"))], start, ["velocity"], t=2)
    with pytest.raises(gt.errors.StuckError, match="t = 0.*vx' = nan"):
        scene.run()


@pytest.mark.parametrize("engine", ["taylor", 3, gt.RungeKutta])
def test_invalid_engines_are_refused(engine):
    """A name or a class is refused as an engine."""
    with pytest.raises(gt.errors.StartError, match=r"engine = .*RungeKutta.., Stiff.."):
        TOP.run(engine=engine)
    with pytest.raises(gt.errors.StartError, match="expected "):
        gt.solve_many(TOP.ode, {"Omega1": [1.0, 2.0]}, 1.0, engine=engine)


def test_replacing_an_attitude_or_inertia():
    """A new attitude or inertia replaces the old one, however the old one was given."""
    scene = TOP.with_values({"start.quaternion": (1, 0, 0, 0), "body.inertia": np.eye(3).tolist()})
    assert scene.start.euler is None
    assert scene.body.moments is None
    again = scene.with_values({"start.euler": (0, 0.1, 0), "body.moments": (1, 1, 1)})
    assert again.start.quaternion is None
    assert again.body.inertia is None


def test_whole_numbers_of_numpy_and_numbers_that_are_too_small():
    """samples may come from NumPy; zero repeats are refused with an error of ours."""
    assert len(TOP.with_values(samples=np.int64(5)).times) == 5
    with pytest.raises(SceneError, match="samples: expected a whole number from 2 on, got True"):
        TOP.with_values(samples=True)
    with pytest.raises(SceneError, match="repeats: expected a whole number from 1 on"):
        TOP.cost(repeats=0)


def test_an_index_behind_an_effect_leads_nowhere():
    """gravity[5].g is refused instead of changing gravity.g."""
    with pytest.raises(UnknownNameError, match="gravity is one effect"):
        TOP.with_values({"gravity[5].g": 1.0})

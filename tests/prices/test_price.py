"""price: claims judged against an enclosed truth, times predicted, and refusals."""

import csv
import io
import json
import math
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import AccuracyError, ArgumentError, MissingExtraError, UnknownNameError
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.prices import (
    Bounds,
    Claim,
    Offer,
    PriceList,
    PriceRow,
    Request,
    Way,
    loops,
)
from tests.rounding import ROUNDED

SO3 = gt.spaces.load("so3").frame
TURN = gt.autoparallel(gt.cartan(SO3), [0.3, 1.0, 0.2], [0.1, 0.5, -0.2])
TOP = gt.geodesic(SO3, frame_velocity=[1.0, 0.2, 0.1], metric=[1, 2, 3])
CIRCLE = gt.Loop.circle([0.3, 1, 0.2], 0.3)
SWING = gt.ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 1})
QUICK = [gt.RungeKutta()]
AXES = [np.linspace(-1, 1, 33)] * 2
X, Y = np.meshgrid(*AXES, indexing="ij")
FIELD = np.array([[-np.sin(3 * Y), np.sin(2 * X)]]) / 2


def rows_of(table: PriceList, certainty: str) -> list[PriceRow]:
    """The rows of one kind."""
    return [row for row in table.rows if row.certainty == certainty]


def test_claims_of_a_motion_are_judged():
    """Each claim holds against a proof, and the plain run has the same error without a claim."""
    table = gt.price(TOP, 5.0, [1e-4, 1e-8], engines=QUICK, proofs=[10])
    assert table.truth == "a proof, so that they are enclosed"
    claimed, plain = rows_of(table, "estimate"), rows_of(table, "plain")
    assert [row.requested for row in claimed] == [1e-4, 1e-8]
    assert all(row.holds and row.reached for row in claimed)
    for row, other in zip(claimed, plain, strict=True):
        assert other.claimed is None
        assert other.holds is None
        assert other.true == row.true
        assert row.calibration is not None
        assert 1 <= row.calibration < 1000
    (proof,) = rows_of(table, "proof")
    assert proof.claimed is not None
    assert proof.claimed < 1e-10
    assert proof.seconds > max(row.seconds for row in plain)


def test_the_enclosed_truth_agrees_with_a_closed_form():
    """A rotation at a constant rate has a closed form, whose error is within the proved bounds."""
    table, closed = (
        gt.price(TURN, 5.0, [1e-4, 1e-8], engines=QUICK, proofs=proofs) for proofs in ([10], [])
    )
    assert closed.truth == "the closed form"
    pairs = zip(rows_of(table, "estimate"), rows_of(closed, "estimate"), strict=True)
    for enclosed, exact in pairs:
        assert exact.true is not None
        assert enclosed.true is not None
        # The difference of two doubles is rounded.
        low, high = enclosed.true.low - 1e-15, enclosed.true.high + 1e-15
        assert low <= exact.true.high <= high


class Thing:
    """A thing with an offer of its own: one way, whose run returns a claim."""

    def __init__(self, run: Callable[[], Claim], error: float = 0.0) -> None:
        self.run, self.error = run, error

    def offer(self, request: Request) -> Offer:
        """The way, whose true error is known."""
        ways = [Way("A", "estimate", lambda _: self.run, request.accuracies)]
        truth = Bounds(self.error, self.error)
        return Offer("thing", ways, "the truth", lambda value, accuracy: truth)


@pytest.mark.parametrize(("error", "holds"), [(2e-7, False), (5e-8, True)])
def test_a_wrong_claim_is_found(error, holds):
    """A claim below the true error is judged as wrong."""
    thing = Thing(lambda: Claim(1.0, 1e-7), error)
    (row,) = gt.price(thing, accuracies=[1e-4]).rows
    assert row.holds is holds
    assert row.calibration == pytest.approx(1e-7 / error)


def test_unreachable_accuracies_are_in_the_table():
    """Runge-Kutta at 1e-17 fails, which is a row with a note and no time."""
    table = gt.price(TOP, 2.0, [1e-6, 1e-17], engines=QUICK, proofs=[])
    good, bad = rows_of(table, "estimate")
    assert good.reached
    assert not bad.measured
    assert "gets to" in bad.note
    assert bad.note in str(table)
    expected = "quadruple precision" if is_available() else "the finest Runge-Kutta solution"
    assert table.truth == expected
    data = json.loads(json.dumps(table.to_json()))
    assert data["rows"][1]["seconds"] is None


def bessel() -> float:
    """b^1 of CIRCLE in closed form: a Bessel function."""
    radius, place = mpmath.mpf(3) / 10, mpmath.mpf(3) / 10
    return float(2 * mpmath.pi * radius * mpmath.besselj(1, radius) * mpmath.cos(place))


def test_the_search_for_a_formula_ends(monkeypatch):
    """A search that takes too much time of the processor leaves a reason, not an error."""
    monkeypatch.setattr(loops, "FORMULA_SECONDS", 1e-9)
    table = gt.price(SO3, CIRCLE, [1e-3], proofs=[])
    (formula,) = (row for row in table.rows if row.way == "formula")
    assert not formula.measured
    assert "no closed form was found in 1e-09 s of the processor" in formula.note


def test_a_loop_of_a_formula():
    """Numbers, the closed form and proofs of a loop, each with its true error."""
    table = gt.price(SO3, CIRCLE, [1e-3, 1e-12], proofs=[10, 40])
    assert table.ways == ("line and flux", "line", "formula", "proof")
    assert all(row.holds for row in rows_of(table, "estimate"))
    (formula,) = (row for row in table.rows if row.way == "formula")
    assert formula.true is not None
    assert formula.true.high < ROUNDED
    for row in rows_of(table, "proof"):
        assert row.claimed is not None
        assert row.claimed <= row.requested
    b = gt.burgers_vector(SO3, CIRCLE)
    again = gt.price(b, accuracies=[1e-3, 1e-12], proofs=[])
    assert again.ways == ("line and flux", "line", "formula")
    # The judge is right: it reports the difference from the Bessel function.
    wrong = b.vector + np.array([1e-5, 0, 0])
    bounds = loops.burgers_offer(SO3, Request(CIRCLE)).judge(wrong, 1e-3)
    assert bounds is not None
    assert bounds.low <= bounds.high
    expected = (wrong[0] - bessel()) / np.abs(b.vector).max()
    assert bounds.high == pytest.approx(expected, rel=1e-9)


def test_a_vanishing_burgers_vector():
    """Errors of a zero count against the size of the loop."""
    flat = gt.Frame("x y", [["1", "0"], ["0", "1"]])
    table = gt.price(flat, gt.Loop.circle([0, 0], 1e-3), [1e-9], proofs=[])
    assert rows_of(table, "estimate")[0].reached


def test_a_development_and_a_proof():
    """Translation and rotation are judged together; a proof has a price by digits."""
    turn = gt.develop(gt.levi_civita(SO3), CIRCLE)
    table = gt.price(turn, accuracies=[1e-9], proofs=[10])
    assert rows_of(table, "estimate")[0].holds
    proofs = gt.price(gt.prove(gt.burgers_vector(SO3, CIRCLE)), proofs=[10, 300])
    assert [row.way for row in proofs.rows] == ["proof", "proof"]
    assert proofs.rows[1].true is not None
    assert proofs.rows[1].true.high < 1e-300
    assert proofs.recommendation.startswith("Proofs: 1e-10 in ")


def test_digits_of_a_tensor():
    """Floats have 1e-16, and each row at least the digits that were requested."""
    point = {"phi1": 0.3, "phi2": 1, "phi3": 0.2}
    table = gt.price(gt.cartan(SO3).torsion.S, point, [1e-6, 1e-20], proofs=[50])
    plain, *digits = table.rows
    assert plain.true is not None
    assert 0 < plain.true.high < ROUNDED
    assert [row.requested for row in digits] == [1e-6, 1e-20, 1e-50]
    assert all(row.reached for row in digits)
    listed = gt.price(gt.cartan(SO3).torsion.S, [0.3, 1, 0.2], [1e-6, 1e-20], proofs=[50])
    assert [row.true for row in listed.rows] == [row.true for row in table.rows]


def test_torsion_and_curvature_are_tensors():
    """A torsion has the price of S, a curvature the price of the Riemann tensor."""
    sphere = gt.levi_civita("s2")
    point = {"R": 2, "theta": 1, "phi": 0}
    for whole, part in (
        (gt.cartan(SO3).torsion, gt.cartan(SO3).torsion.S),
        (sphere.curvature, sphere.curvature.riemann),
    ):
        place = point if part.frame.dimension == 2 else [0.3, 1, 0.2]
        one, two = (gt.price(thing, place, [1e-8], proofs=[]) for thing in (whole, part))
        assert one.name == two.name
        assert [row.true for row in one.rows] == [row.true for row in two.rows]
    with pytest.raises(ArgumentError, match="at: expected 3 numbers, got 2"):
        gt.price(gt.cartan(SO3).torsion, [0.3, 1], [1e-8])


@pytest.mark.parametrize(
    ("low", "high", "holds"),
    [(0.0, 5e-7, True), (0.0, 2e-6, None), (1.5e-6, 2e-6, False), (1e-6, 1e-6, True)],
)
def test_bounds_around_a_claim_decide_nothing(low, high, holds):
    """A claim holds or fails only where both bounds of the true error are on one side of it."""
    row = PriceRow("way", "estimate", 1e-6, claimed=1e-6, true=Bounds(low, high))
    assert row.holds is holds


@pytest.mark.parametrize("times", [3.0, [0.0, 1.0, 3.0]])
def test_an_ensemble(times):
    """Members are judged against proofs of three of them."""
    many = gt.solve_many(SWING, {"k": np.linspace(1, 4, 5)}, times, engine=gt.RungeKutta())
    table = gt.price(many, accuracies=[1e-4, 1e-9], engines=QUICK, proofs=[10])
    assert table.truth == "a proof, so that they are enclosed (members 0, 2, 4)"
    for row in table.rows:
        assert row.holds
        assert row.true is not None
        assert row.true.high > 1e-16


def test_an_ensemble_of_curves():
    """Members of a curve are judged in the coordinates in which they were followed."""
    velocities = [[0.3, 0.1, 0.2], [0.1, -0.4, 0.3]]
    problem = gt.geodesic(SO3, [0.3, 1, 0.2], [1, 0.2, 0.3], metric=[1, 2, 3])
    many = gt.solve_many(problem, t=1.0, frame_velocities=velocities, engine=gt.RungeKutta())
    table = gt.price(many, accuracies=[1e-8], engines=QUICK, proofs=[])
    assert table.rows[0].holds


def test_a_scene_and_its_effects():
    """A scene has claims that hold, and the price of its effects one by one."""
    scene = gt.scenes.load("lagrange_wave").with_values(t=0.2)
    table = gt.price(scene, accuracies=[1e-4, 1e-9], engines=QUICK, proofs=[])
    assert all(row.holds for row in rows_of(table, "estimate"))
    assert [name for name, _ in table.effects] == ["spin", *scene.keyed]
    assert all(seconds > 0 for _, seconds in table.effects)


def test_a_closed_form_of_a_scene_is_not_judged_by_itself():
    """The closed form of a free top has an error against quadruple precision."""
    scene = gt.scenes.load("free_symmetric_top").with_values(t=0.5)
    table = gt.price(scene, accuracies=[1e-9], engines=QUICK, proofs=[])
    assert table.truth in {"quadruple precision", "the finest Runge-Kutta solution"}
    (formula,) = (row for row in table.rows if row.way == "closed form")
    assert formula.true is not None
    assert 0 < formula.true.high <= 1e-9


def test_rows_of_a_scene_are_its_runs():
    """Each row with an estimate claims the error that `run` reports, in closed form or not."""
    for name in ("free_symmetric_top", "thrown_body"):
        scene = gt.scenes.load(name).with_values(t=0.5)
        table = gt.price(scene, accuracies=[1e-9], engines=QUICK, proofs=[])
        closed = [row for row in table.rows if row.engine == "closed form"]
        assert len(closed) == (scene.run().closed_form is not None)
        asked = replace(scene, accuracy=1e-9)
        for row in closed:
            assert row.claimed == asked.run().error
        for engine in QUICK:
            (row,) = (row for row in rows_of(table, "estimate") if row.engine == engine.name)
            assert row.claimed == asked.run(engine).error


def test_a_grid_has_a_noise_floor():
    """Without noise the error falls with the spacing; noise is a floor that the list names."""
    loop = gt.Loop.circle([0, 0], 0.6)
    smooth = gt.price(gt.SampledFrame(AXES, FIELD), loop)
    claims = [row.claimed or 0.0 for row in smooth.rows]
    assert smooth.unit == "spacing"
    assert [row.requested for row in smooth.rows] == [0.5, 0.25, 0.125, 0.0625]
    assert claims == sorted(claims, reverse=True)
    assert not smooth.floor
    noisy = gt.price(gt.SampledFrame(AXES, FIELD, sigma=0.01), loop)
    b = gt.SampledFrame(AXES, FIELD, sigma=0.01).burgers(loop)
    assert noisy.floor == pytest.approx(b.noise / np.abs(b.vector).max())
    assert "Noise: " in str(noisy)


def test_coarser_grids_have_their_own_errors():
    """The bounds of the error of every eighth node hold the difference from the exact integral."""
    loop, angle = gt.Loop.circle([0, 0], 0.6), np.arange(256) / 256 * 2 * np.pi
    x, y = 0.6 * np.cos(angle), 0.6 * np.sin(angle)
    exact = np.mean(np.sin(3 * y) * y + np.sin(2 * x) * x) * np.pi
    first = gt.price(gt.SampledFrame(AXES, FIELD), loop).rows[0]
    nodes = [axis[::8] for axis in AXES]
    coarse = gt.SampledFrame(nodes, FIELD[..., ::8, ::8]).burgers(loop).vector[0]
    assert first.true is not None
    assert 0 < first.true.low <= abs(coarse - exact) / exact <= first.true.high


def test_a_survey_of_a_grid():
    """All circuits of one size, on grids on which the size is a whole number of cells."""
    table = gt.price(gt.SampledFrame(AXES, FIELD, sigma=1e-5), 4)
    assert [row.requested for row in table.rows] == [0.25, 0.125, 0.0625]
    assert table.name == "841 circuits of 4 x 4 cells"
    assert all(row.holds is not False for row in table.rows)
    coarse, _, finest = table.rows
    assert coarse.true is not None
    assert finest.true is not None
    assert coarse.true.high > finest.true.high
    assert finest.true.low == 0
    # Twice the noise is twice the floor.
    noisy = gt.price(gt.SampledFrame(AXES, FIELD, sigma=2e-5), 4)
    assert noisy.floor == pytest.approx(2 * (table.floor or 0.0))


def test_other_measured_data():
    """Other sources are measured once, with their claim."""
    lines = gt.LineArrays([[1.0, 1, 0], [1, 1, 4]], [[0, 1]], [[0, 0, 1.0]])
    source = gt.DislocationNetwork.of_arrays(lines)
    (row,) = gt.price(source, gt.Loop.circle([1, 1, 2], 0.5)).rows
    assert row.measured
    assert row.true is None


# -- prediction and presentation -----------------------------------------------------------------


def listed(seconds: list[float], **fields: Any) -> PriceList:
    """A list with one way at 2, 5, 8, 11 digits, and a proof."""
    rows = [
        PriceRow("A", "estimate", 10.0**-d, 10.0**-d, Bounds(0.0, 10.0 ** -(d + 1)), s)
        for d, s in zip((2, 5, 8, 11), seconds, strict=True)
    ]
    proof = PriceRow("proof", "proof", 1e-10, 1e-12, Bounds(0.0, 1e-12), 100.0)
    return PriceList("a thing", "the truth", (*rows, proof), **fields)


def test_three_rows_predict_time_and_digits():
    """Time of other digits, its inverse, and how far the model is off in the row that is left."""
    law = {d: 1 + 0.1 * d + 0.02 * d * d for d in (2, 5, 8, 11)}
    table = listed(list(law.values()))
    assert table.seconds(1e-5) == pytest.approx(law[5])
    assert table.seconds(1e-9) == pytest.approx(1 + 0.9 + 0.02 * 81)
    assert -math.log10(table.accuracy(law[8] + 1e-9)) == pytest.approx(8)
    assert table.accuracy(1e9) == pytest.approx(1e-11)
    assert table.misfit() == pytest.approx(1)
    assert listed([1, 2, 4, 8]).misfit() > 1.01
    assert table.seconds(1e-10, "proof") == 100


def test_recommendation():
    """The first line names the fastest way, the others what fewer digits and a proof cost."""
    text = listed([1.0, 2.0, 3.0, 4.0]).recommendation
    assert text.startswith("Take A: 1e-11 in 4 s.")
    assert "1e-02 takes 25 % of this time" in text
    assert text.splitlines()[-1] == "A proof to 1e-10 takes 25 times as long."
    single = PriceList("a thing", "the truth", (priced("A", "estimate", 1.0),)).recommendation
    assert single == "Take A: 1e-06 in 1 s."


def priced(engine: str, certainty: str, seconds: float, **fields: Any) -> PriceRow:
    """A row at six digits."""
    way = engine if certainty == "estimate" else f"{engine}, plain"
    return PriceRow(way, certainty, 1e-6, 1e-6, Bounds(0.0, 1e-7), seconds, engine=engine, **fields)


def test_the_plain_run_is_of_the_same_engine():
    """Not of one whose name begins alike, and of no other where it has none."""
    long = [priced("Taylor(113)", "estimate", 8.0), priced("Taylor(113), x", "plain", 5.0)]
    rows = [*long, priced("Taylor", "estimate", 4.0), priced("Taylor", "plain", 1.0)]
    text = PriceList("a thing", "the truth", tuple(rows)).recommendation
    assert "Take Taylor: 1e-06 in 4 s" in text
    assert "Without an error estimate it takes 25 %." in text
    alone = PriceList("a thing", "the truth", tuple(rows[:3]))
    assert alone.plain(rows[2]) is None
    assert "Without an error estimate" not in alone.recommendation


def test_the_plain_run_is_at_the_same_accuracy():
    """A coarser run of the same engine, which is cheaper, is another one."""
    coarse, fine = (
        replace(priced("A", "plain", seconds), requested=accuracy)
        for accuracy, seconds in ((1e-3, 1.0), (1e-9, 3.0))
    )
    best = replace(priced("A", "estimate", 4.0), requested=1e-9)
    assert PriceList("a thing", "the truth", (coarse, fine, best)).plain(best) is fine
    assert PriceList("a thing", "the truth", (coarse, best)).plain(best) is None


def test_rows_without_a_name_are_of_the_fastest_way_to_the_finest_accuracy():
    """A cheaper way that stops at fewer digits, and a slower one to the same, are not taken."""
    ways = (("A", 1e-3, 1.0), ("B", 1e-9, 7.0), ("C", 1e-9, 5.0))
    rows = [
        replace(priced(engine, "estimate", seconds), requested=accuracy, true=Bounds(0.0, 1e-10))
        for engine, accuracy, seconds in ways
    ]
    assert PriceList("a thing", "the truth", tuple(rows)).of() == (rows[2],)


def test_a_way_without_results_has_its_own_reason():
    """The message quotes the note of that way, not of the first row."""
    rows = [
        priced("A", "estimate", math.nan, note="A is too coarse"),
        priced("B", "estimate", math.nan, note="B has no more digits"),
    ]
    with pytest.raises(AccuracyError, match="B has no more digits"):
        PriceList("a thing", "the truth", tuple(rows)).of("B")


def test_csv_holds_every_row():
    """Numbers read back as the same doubles."""
    table = listed([1.0, 2.0, 1 / 3, 4.0])
    rows = list(csv.DictReader(io.StringIO(table.csv_text())))
    assert [float(row["seconds"]) for row in rows] == [row.seconds for row in table.rows]
    assert [float(row["true_high"]) for row in rows] == [
        row.true.high for row in table.rows if row.true
    ]


def test_figure_and_notebook(monkeypatch):
    """One figure has the prices of digits, certainty and effects; a notebook shows it."""
    pytest.importorskip("matplotlib")
    table = listed([1.0, 2.0, 3.0, 4.0], effects=(("spin", 0.1), ("gravity", 0.2)))
    digits, certainty, effects = table.plot().axes
    assert digits.get_xscale() == digits.get_yscale() == "log"
    assert [text.get_text() for text in certainty.get_yticklabels()] == [
        "with error estimate",
        "proof, 1e-10",
    ]
    widths: list[Any] = list(effects.patches)
    assert [text.get_text() for text in effects.get_yticklabels()] == ["spin", "+ gravity"]
    assert [bar.get_width() for bar in widths] == [100.0, 200.0]
    assert table._repr_html_().count("<tr>") == 6
    (spacing,) = replace(table, effects=(), unit="spacing", floor=1e-3).plot().axes
    assert "noise floor" in spacing.get_legend_handles_labels()[1]
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match="plots"):
        table.plot()


def test_memory_is_measured_on_request():
    """The peak of a run that allocates a megabyte is a megabyte."""
    thing = Thing(lambda: Claim(np.zeros(2**17).sum(), None))
    assert gt.price(thing, accuracies=[1e-3]).rows[0].memory is None
    peak = gt.price(thing, accuracies=[1e-3], memory=True).rows[0].memory
    assert peak == pytest.approx(2**20, rel=0.1)


def test_times_are_of_the_processor(monkeypatch):
    """The fastest of repeated runs counts, and the first, which may compile, does not."""
    now, count = [0.0], [0]

    def run() -> Claim:
        count[0] += 1
        now[0] += 5.0 if count[0] == 1 else 0.011
        return Claim(1.0, None)

    def clock():
        now[0] += 1e-4  # other runs take time as well
        return now[0]

    monkeypatch.setattr(time, "thread_time", clock)
    table = gt.price(Thing(run), accuracies=[1e-6])
    assert table.rows[0].seconds == pytest.approx(0.011, rel=0.02)


ANY: Any = 5
LIST = listed([1.0, 2.0, 3.0, 4.0])


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: gt.price(ANY), ArgumentError, "thing: expected a problem"),
        (lambda: gt.price(SO3), ArgumentError, "at: expected a Loop"),
        (lambda: gt.price("so3", 1.0), ArgumentError, "at: expected a Loop"),
        (lambda: gt.price("so9", CIRCLE), UnknownNameError, "so3"),
        (lambda: gt.price(SO3.metric), ArgumentError, "expected a point"),
        (lambda: gt.price(gt.burgers_vector(SO3, CIRCLE), CIRCLE), ArgumentError, "Drop it"),
        (lambda: gt.price(TOP, 1.0, []), AccuracyError, "expected at least one, got none"),
        (lambda: gt.price(TOP, 1.0, [-1e-6]), AccuracyError, "positive"),
        (lambda: gt.price(TOP, 1.0, memory=ANY), ArgumentError, "memory: expected True or False"),
        (lambda: gt.price(TOP, 1.0, proofs=[0]), ArgumentError, "whole number from 1"),
        (lambda: LIST.seconds(0), AccuracyError, "positive"),
        (lambda: LIST.seconds(1e-14), AccuracyError, "the finest row"),
        (lambda: LIST.accuracy(0.5), AccuracyError, "expected at least 1 s"),
        (lambda: LIST.seconds(1e-3, "B"), UnknownNameError, "expected one of A, proof"),
    ],
)
def test_refused(call, error, words):
    """Things without a price, and times or digits that nobody knows, are refused."""
    with pytest.raises(error, match=words):
        call()

"""Fits of motions: true values, errors that hold, and what data do not determine."""

import json

# A test passes bad input.
# pyright: reportArgumentType=false
import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import (
    AccuracyError,
    ShapeError,
    StartError,
    TimeError,
    UnknownNameError,
)

TIMES = np.linspace(0, 5, 40)
SWING = gt.ODE.of(
    {"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 3.9}, outputs={"both": ["x", "v"]}
)
KERR = gt.geodesic(
    "kerr", [0, 10, 1.2, 0], velocity=[1.2, 0, 0.012, 0.034], parameters={"M": 1.0, "a": 0.6}
)
TOP = gt.ODE.of(
    {
        "w1": "(I2 - I3)/I1*w2*w3", "w2": "(I3 - I1)/I2*w3*w1", "w3": "(I1 - I2)/I3*w1*w2",
    },
    [1, 0.3, 0.2],
    parameters={"I1": 1, "I2": 2, "I3": 3},
)  # fmt: skip


def noisy(seed: int, size: float = 0.01) -> np.ndarray:
    """Positions of the oscillator with k = 4, with noise."""
    return np.cos(2 * TIMES) + size * np.random.default_rng(seed).normal(size=len(TIMES))


def test_pulls_are_normal():
    """Over 100 seeds, errors of the values in units of the stated errors have rms one."""
    pulls = []
    for seed in range(100):
        fit = gt.fit(SWING, TIMES, {"x": noisy(seed)}, 0.01, ["k", "x"], accuracy=1e-8)
        truth = {"k": 4.0, "x": 1.0}
        pulls.append([(fit[name] - x) / fit.errors[name] for name, x in truth.items()])
    rms = np.sqrt(np.mean(np.square(pulls), axis=0))
    assert rms == pytest.approx([1, 1], abs=0.1)


def test_a_line_has_the_closed_form():
    """x = x0 + v t: values and covariance of linear regression."""
    line = gt.ODE.of({"x": "v"}, [0.5], parameters={"v": 1})
    data = 2 + 3 * TIMES + np.random.default_rng(2).normal(size=len(TIMES))
    fit = gt.fit(line, TIMES, {"x": data}, 1.0, ["x", "v"])
    design = np.stack([np.ones_like(TIMES), TIMES], axis=1)
    expected, (chi2,), *_ = np.linalg.lstsq(design, data)
    assert list(fit.values.values()) == pytest.approx(expected, rel=1e-8)
    assert fit.covariance == pytest.approx(np.linalg.inv(design.T @ design), rel=1e-8)
    assert fit.chi2 == pytest.approx(chi2, rel=1e-8)
    assert fit.degrees == 38
    assert fit.residuals["x"] == pytest.approx(data - design @ expected, abs=1e-7)
    assert not fit.warnings


def test_mass_and_spin_of_kerr():
    """From 60 noisy radii and angles of one orbit, with an unknown start."""
    times, sigma = np.linspace(5, 300, 60), {"r": 1e-3, "phi": 1e-4}
    truth = gt.solve(KERR, times, 1e-11)
    draws = np.random.default_rng(3)
    data = {name: truth[name] + x * draws.normal(size=60) for name, x in sigma.items()}
    guess = KERR.with_values({"M": 1.0005, "a": 0.55, "r": 10.002})
    fit = gt.fit(guess, times, data, sigma, ["M", "a", "r"])
    for name in fit.values:
        assert abs(fit[name] - KERR.variables[name]) < 3 * fit.errors[name]
        assert fit.errors[name] < 1e-3
    assert 0.01 < fit.chance < 0.99
    assert fit.correlation[0, 1] > 0.9


def test_moments_of_a_free_top_have_no_scale():
    """Only ratios of the moments matter: one direction stays undetermined, and is named."""
    truth = gt.solve(TOP, TIMES)
    draws = np.random.default_rng(0)
    data = {x: truth[x] + 1e-3 * draws.normal(size=40) for x in ("w1", "w2", "w3")}
    guess = TOP.with_values({"I1": 1.1, "I2": 2.1})
    fit = gt.fit(guess, TIMES, data, 1e-3, ["I1", "I2", "I3"])
    (direction,) = fit.undetermined
    shares = [direction.changes[name] / fit[name] for name in ("I1", "I2", "I3")]
    assert shares == pytest.approx([shares[0]] * 3, rel=1e-6)
    assert fit["I2"] / fit["I1"] == pytest.approx(2, abs=0.02)
    assert all(np.isinf(x) for x in fit.errors.values())
    assert "do not determine I1 and I2 and I3" in fit.warnings[0]
    assert fit.degrees == 3 * 40 - 2
    assert len(fit.warnings) == 1
    assert json.loads(json.dumps(fit.to_json()))["errors"]["I1"] is None
    fixed = gt.fit(guess, TIMES, data, 1e-3, ["I2", "I3"])
    assert not fixed.warnings
    assert abs(fixed["I2"] - 2.2) < 3 * fixed.errors["I2"]


def test_a_parameter_without_effect():
    """Its error is infinite, and the others have theirs."""
    fall = gt.ODE.of({"v": "-g", "q": "c"}, [0, 0], parameters={"g": 9, "c": 1})
    fit = gt.fit(fall, [1, 2, 3], {"v": [-9.7, -19.7, -29.4]}, 0.1, ["g", "c"])
    assert fit.errors["g"] == pytest.approx(0.1 / np.sqrt(14), rel=1e-6)
    assert np.isinf(fit.errors["c"])
    assert fit["c"] == 1


def test_weak_data_are_noticed():
    """A sigma that reaches over the wells of chi^2: errors are not sigmas."""
    fit = gt.fit(SWING, TIMES[:4], {"x": noisy(1, 2.0)[:4]}, 2.0, ["k"])
    assert fit.curved is not None
    assert "errors are not sigmas" in fit.warnings[0]


def test_data_of_several_kinds():
    """A vector output, missing numbers, repeated times in any order, and noise by number."""
    truth = np.stack([np.cos(2 * TIMES), -2 * np.sin(2 * TIMES)], axis=1)
    order = np.random.default_rng(0).permutation(len(TIMES))
    times = np.concatenate((TIMES[order], TIMES[:3]))
    both = np.concatenate((truth[order], truth[:3]))
    both[5, 1] = np.nan
    fit = gt.fit(SWING, times, {"both": both}, {"both": np.full((43, 2), 0.1)}, ["k"])
    assert fit["k"] == pytest.approx(4, rel=1e-7)
    assert np.isnan(fit.residuals["both"][5, 1])
    assert fit.degrees == 2 * 43 - 2


def test_backward_and_single_times():
    """A motion to the past, and one number."""
    growth = gt.ODE.of({"x": "k*x"}, [1], parameters={"k": 0.9})
    assert gt.fit(growth, [-2, -1], {"x": np.exp([-2, -1])}, 1e-6, ["k"])["k"] == pytest.approx(1)
    assert gt.fit(growth, [2], {"x": [np.exp(2)]}, 1e-6, ["k"])["k"] == pytest.approx(1)


def test_trials_without_a_motion():
    """A trial that ends at an edge is rejected, and the fit continues."""
    root = gt.ODE.of({"x": "-sqrt(x) * k"}, [1.0], parameters={"k": 1.5})
    times = np.linspace(0, 1.2, 10)
    fit = gt.fit(root, times, {"x": (1 - 0.1 * times / 2) ** 2}, 1e-3, ["k"])
    assert fit["k"] == pytest.approx(0.1, abs=1e-6)


def outlying(seed: int) -> np.ndarray:
    """Positions of the oscillator with k = 4, a tenth of them with a hundred times the noise."""
    draws = np.random.default_rng(seed)
    wild = draws.random(len(TIMES)) < 0.1
    return noisy(seed) + wild * draws.normal(size=len(TIMES))


def test_a_robust_loss_survives_outliers():
    """Over 30 seeds with outliers, deviations in units of the errors have mean square near one."""
    pulls = []
    for seed in range(30):
        loss = ("soft_l1", "huber", "cauchy")[seed % 3]
        fit = gt.fit(SWING, TIMES, {"x": outlying(seed)}, 0.01, ["k"], loss=loss, accuracy=1e-8)
        pulls.append((fit["k"] - 4) / fit.errors["k"])
    # Thirty squares have a standard deviation of a quarter of their mean, more with outliers.
    assert np.sqrt(np.mean(np.square(pulls))) == pytest.approx(1, abs=0.35)


def test_a_point_far_off_is_reported():
    """A datum 150 sigma off: a warning names it; a robust fit has the value without it."""
    data = noisy(0)
    data[7] += 1.5
    fit = gt.fit(SWING, TIMES, {"x": data}, 0.01, ["k"])
    (warning,) = fit.warnings
    assert f"sigma, x at {TIMES[7]:.6g}" in warning
    assert "too large for chance" in warning
    robust = gt.fit(SWING, TIMES, {"x": data}, 0.01, ["k"], loss="soft_l1")
    without = np.where(np.arange(40) == 7, np.nan, data)
    clean = gt.fit(SWING, TIMES, {"x": without}, 0.01, ["k"])
    assert abs(robust["k"] - clean["k"]) < clean.errors["k"]
    assert abs(fit["k"] - clean["k"]) > 5 * clean.errors["k"]
    assert not robust.warnings
    assert "(loss soft_l1; beyond 5 sigma: 1)" in str(robust)


def test_losses_agree_where_there_is_no_outlier():
    """Squares and soft_l1 of small residuals are equal to first order."""
    exact = {"x": np.cos(2 * TIMES)}
    values = [gt.fit(SWING, TIMES, exact, 1.0, ["k"], loss=x)["k"] for x in ("linear", "soft_l1")]
    assert values == pytest.approx([4, 4], rel=1e-7)


def test_a_parameter_that_changes_nothing_keeps_its_value():
    """The radius of a sphere does not change its geodesics; only rounding noise depends on it."""
    curve = gt.geodesic("s2", [1, 0], [0, 1], parameters={"R": 1})
    for engine in (None, gt.RungeKutta()):
        fit = gt.fit(curve, [0, 1, 2], {"theta": [1, 1.2, 1.6]}, 0.1, ["R"], engine=engine)
        assert str(fit).startswith("R = 1, undetermined")
        assert "Fix it" in fit.warnings[0]
        both = gt.fit(curve, [0, 1, 2], {"theta": [1, 1.2, 1.6]}, 0.1, ["R", "phi'"], engine=engine)
        assert both["R"] == 1
        assert np.isinf(both.errors["R"])
        assert np.isfinite(both.errors["phi'"])


def test_bounds_stop_a_value():
    """Bounds that contain the answer change nothing; another one is reported."""
    data = {"x": noisy(1)}
    free = gt.fit(SWING, TIMES, data, 0.01, ["k"])
    wide = gt.fit(SWING, TIMES, data, 0.01, ["k"], bounds={"k": (3, 5)})
    assert wide["k"] == pytest.approx(free["k"], rel=1e-6)
    assert not wide.warnings
    stopped = gt.fit(SWING, TIMES, data, 0.01, ["k"], bounds={"k": (None, 3.95)})
    assert stopped["k"] == pytest.approx(3.95, rel=1e-6)
    assert stopped.at_bounds == {"k": 3.95}
    assert "k is at its bound 3.95" in stopped.warnings[0]


def test_tables_of_pandas_and_xarray():
    """Columns by name: the time as a column or an index, the noise as columns, missing numbers."""
    pandas = pytest.importorskip("pandas")
    x = noisy(1)
    x[[3, 4]] = np.nan
    sigma = np.where(np.isnan(x), np.nan, 0.01)
    expected = gt.fit(SWING, TIMES, {"x": x}, 0.01, ["k"])
    table = pandas.DataFrame({"t": TIMES, "x": x, "sigma_x": sigma})
    marked = table.astype({"x": "Float64"})
    for data in (table, marked, table.set_index("t"), table.to_records(index=False)):
        assert gt.fit(SWING, "t", data, None, ["k"]) == expected
    assert gt.fit(SWING, table["t"], table[["x"]], 0.01, ["k"]) == expected
    assert gt.fit(SWING, table["t"], table[["t", "x"]], 0.01, ["k"]) == expected
    xarray = pytest.importorskip("xarray")
    data = xarray.Dataset({"x": ("t", x)}, coords={"t": TIMES})
    assert gt.fit(SWING, "t", data, 0.01, ["k"]) == expected
    truth = gt.solve(SWING.with_values({"k": 4.0}), TIMES)
    for data in (truth.to_pandas(), truth.to_xarray()):
        assert gt.fit(SWING, "t", data[["t", "x"]], 0.01, ["k"])["k"] == pytest.approx(4)
    assert gt.fit(SWING, truth.times, truth, 0.01, ["k"])["k"] == pytest.approx(4)


def test_equal_calls_give_equal_bits():
    """Values and covariance, on a second call."""
    one, two = (gt.fit(SWING, TIMES, {"x": noisy(1)}, 0.01, ["k", "x"]) for _ in range(2))
    assert one == two


def test_it_shows_itself():
    """As text, in a notebook, and as a figure."""
    fit = gt.fit(SWING, TIMES, {"x": noisy(1), "both": np.full((40, 2), np.nan)}, 0.01, ["k"])
    assert str(fit).startswith("k = 3.9962 +- 0.0033")
    assert "<svg" in fit._repr_html_()
    labels = [axes.get_ylabel() for axes in fit.plot().axes]
    assert labels[:2] == ["$x$", "residual / $\\sigma$"]
    assert len(labels) == 6


X = {"x": np.cos(2 * TIMES)}
REFUSALS = [
    (lambda: gt.fit(SWING, TIMES, X, 0.01, ["K"]), UnknownNameError, "There are k, x, v"),
    (lambda: gt.fit(SWING, TIMES, {"y": TIMES}, 0.01, ["k"]), UnknownNameError, "got 'y'"),
    (lambda: gt.fit(SWING, TIMES, {}, 0.01, ["k"]), StartError, "got none"),
    (lambda: gt.fit(SWING, TIMES, X, 0.0, ["k"]), StartError, "expected positive numbers"),
    (lambda: gt.fit(SWING, TIMES, X, {"v": 1}, ["k"]), StartError, "a value for x"),
    (lambda: gt.fit(SWING, TIMES[1:], X, 1, ["k"]), ShapeError, "expected 39 finite numbers"),
    (lambda: gt.fit(SWING, TIMES, {"both": TIMES}, 1, ["k"]), ShapeError, "shape"),
    (lambda: gt.fit(SWING, [], X, 1, ["k"]), TimeError, "got none"),
    (lambda: gt.fit(SWING, [1], {"x": [1]}, 1, ["k", "x"]), StartError, "Free fewer"),
    (lambda: gt.fit(SWING, TIMES, X, 1e-12, ["k"], accuracy=1e-6), AccuracyError, "Give accuracy"),
    (lambda: gt.fit(SWING, "t", X, 1, ["k"]), UnknownNameError, "The columns are x"),
    (lambda: gt.fit(SWING, TIMES, X, None, ["k"]), StartError, "Give sigma, or a column sigma_x"),
    (lambda: gt.fit(SWING, TIMES, X, 1, ["k"], loss="l2"), StartError, "soft_l1, huber, cauchy"),
    (lambda: gt.fit(SWING, TIMES, X, 1, ["k"], bounds={"q": (0, 1)}), UnknownNameError, "'q'"),
    (lambda: gt.fit(SWING, TIMES, X, 1, ["k"], bounds={"k": 3}), StartError, "got 3"),
    (lambda: gt.fit(SWING, TIMES, X, 1, ["k"], bounds={"k": (5, 6)}), StartError, "first guess"),
    (lambda: gt.fit(SWING, TIMES, X, 1, ["k"], bounds={"k": ("a", 6)}), StartError, "or None"),
    (
        lambda: gt.fit(SWING, TIMES, X, 1, ["k"], bounds={"k": (5, 3)}),
        StartError,
        "lower bound first",
    ),
    (lambda: gt.fit("kerr", TIMES, X, 1, ["M"]), StartError, "expected a problem"),
]


@pytest.mark.parametrize(("call", "error", "words"), REFUSALS)
def test_bad_requests_are_refused(call, error, words):
    """Names, shapes, noise, and accuracies that do not do."""
    with pytest.raises(error, match=words):
        call()

"""Tables that a solution writes are data of a fit."""

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import UnknownNameError

R, THETA = sp.symbols("r theta", positive=True)
K = sp.Symbol("k", positive=True)
CONE = gt.Frame([R, THETA], [[1, 0], [0, K * R]], parameters=[K])
PROBLEM = gt.geodesic(
    CONE, start={"r": 1, "theta": 0.2}, velocity={"r": 0.3, "theta": 0.5}, parameters={"k": 1.2}
)
TIMES = np.linspace(0, 1, 11)


def table() -> dict[str, np.ndarray]:
    """The columns of a solution: t, r, theta, r', theta', u1, u2."""
    pytest.importorskip("pandas")
    frame = gt.solve(PROBLEM, TIMES).to_pandas()
    assert {"r'", "theta'", "u1", "u2"} < set(frame.columns)
    return {name: frame[name].to_numpy() for name in frame.columns}


@pytest.mark.parametrize("mark", ["'", "dot"])
def test_a_table_of_a_solution_is_data(mark: str):
    """Coordinate velocities repeat the frame velocities: the result is that without them."""
    columns = {name.replace("'", mark): values for name, values in table().items()}
    guess = PROBLEM.with_values({"k": 1.1})
    found = gt.fit(guess, "t", columns, 1e-3, ["k"])
    assert abs(found.values["k"] - 1.2) < found.errors["k"]
    fewer = {name: columns[name] for name in ("t", "r", "theta", "u1", "u2")}
    assert gt.fit(guess, "t", fewer, 1e-3, ["k"]).values == found.values
    noisy = columns | {f"sigma_{name}": 1e-3 + 0 * TIMES for name in columns if name != "t"}
    assert gt.fit(guess, "t", noisy, None, ["k"]).values["k"] == pytest.approx(found.values["k"])


def test_coordinate_velocities_are_refused():
    """The message names the frame velocities and how to get them."""
    columns = table()
    for without in ("u1", "u2"):
        data = {name: values for name, values in columns.items() if name not in (without, "t")}
        with pytest.raises(UnknownNameError, match=r"frame velocities u1, u2, got .* r'"):
            gt.fit(PROBLEM, TIMES, data, 1e-3, ["k"])
    with pytest.raises(UnknownNameError, match="quantities of the model"):
        gt.fit(PROBLEM, TIMES, {"phi'": TIMES, "r": TIMES}, 1e-3, ["k"])

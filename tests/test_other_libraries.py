"""Ordinary lines of users of SymPy, NumPy, pandas and Jupyter, each with its expected result."""

# ruff: noqa: PLW0108 (a line runs in its own test)
# Slips of users, which a checker of types finds too.
# pyright: reportAttributeAccessIssue=false, reportCallIssue=false, reportArgumentType=false

import copy
import json
import pickle

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    CoordinateError,
    ExpressionError,
    GeomtorsionError,
    ShapeError,
    StartError,
    TensorIndexError,
    TimeError,
)
from geomtorsion.ode import ODE

r, theta, k = sp.symbols("r theta k", positive=True)
POLAR = gt.Frame([r, theta], [[1, 0], [0, r]])
G = POLAR.metric
MATRIX = sp.Matrix([[1, 0], [0, r**2]])
TORSION = gt.cartan(POLAR).torsion.T
CONE = gt.Frame([r, theta], [[1, 0], [0, k * r]])
THIRD = gt.Frame("x y", [["1/3", "0"], ["0", "1"]])
SPHERE = gt.levi_civita("s2")
CURVE = gt.geodesic("flat_polar", [1, 0], [1, 0])
MOTION = gt.solve(CURVE, [0.0, 1.0, 2.0])
SCREW = gt.burgers_vector("screw_dislocation", gt.Loop.circle([0, 0, 0], 1), parameters={"b": 2})

SYMPY = {
    "Matrix": (lambda: sp.Matrix(G), MATRIX),
    "ImmutableMatrix": (lambda: sp.ImmutableMatrix(G), sp.ImmutableMatrix(MATRIX)),
    "constants stay exact": (lambda: sp.Matrix(THIRD.metric)[0, 0], sp.Rational(1, 9)),
    "Array": (lambda: sp.Array(G), sp.Array(MATRIX)),
    "sympify": (lambda: sp.sympify(G), sp.Array(MATRIX)),
    "rows": (lambda: [list(row) for row in G], MATRIX.tolist()),
    "tolist": (lambda: G.tolist(), MATRIX.tolist()),
    "index": (lambda: (G[1, 1], G[-1, -1], G[theta, theta]), (r**2, r**2, r**2)),
    "column": (lambda: list(G[:, 1]), [0, r**2]),
    "det": (lambda: (G.det()[()], sp.sqrt(G.det())), (r**2, r)),
    "inv": (lambda: sp.Matrix(G.inv()), MATRIX.inv()),
    "diff": (lambda: sp.Matrix(G.diff(r)), MATRIX.diff(r)),
    "sympy.diff": (lambda: sp.Matrix(sp.diff(G, r)), MATRIX.diff(r)),
    "simplify": (lambda: sp.simplify(G), sp.Array(MATRIX)),
    "method simplify": (lambda: G.simplify() == G, True),
    "latex": (lambda: sp.latex(G), r"g_{ab} = \begin{pmatrix} 1 & 0 \\ 0 & r^{2} \end{pmatrix}"),
    "lambdify": (lambda: sp.lambdify([r, theta], G)(3, 0).tolist(), [[1, 0], [0, 9]]),
    "free symbols": (lambda: G.free_symbols, {r}),
    "evalf": (lambda: THIRD.metric.evalf(5)[0, 0], sp.Rational(1, 9).evalf(5)),
    "subs of a mapping": (lambda: CONE.metric.subs({k: 2})[1, 1], 4 * r**2),
    "subs of two arguments": (lambda: CONE.metric.subs(k, 2)[1, 1], 4 * r**2),
    "subs of a name": (lambda: CONE.subs("k", 2).metric[1, 1], 4 * r**2),
    "subs of pairs": (lambda: CONE.metric.subs([(k, sp.Rational(1, 2))])[1, 1], r**2 / 4),
    "subs of a connection": (lambda: gt.levi_civita(CONE).subs(k, 2)[1, 1, 0], -4 * r),
    "subs of a torsion": (lambda: gt.cartan(CONE).torsion.subs(k, 2).T[0, 1, 1], 1 / r),
    "subs of a curvature": (lambda: SPHERE.curvature.subs("R", 2).scalar[()], sp.Rational(1, 2)),
    "an exact point": (lambda: G.to_sympy().subs(r, 2), sp.Array([[1, 0], [0, 4]])),
    "equal to a matrix": (lambda: (G == MATRIX, MATRIX == G), (True, True)),
    "multiples": (lambda: sp.Matrix(2 * G - G / 2 - sp.pi * G + sp.pi * G), MATRIX * 3 / 2),
    "a scalar in an expression": (
        lambda: sp.sympify(SPHERE.curvature.scalar) * 2 == 4 / sp.Symbol("R", positive=True) ** 2,
        True,
    ),
    "a component of torsion": (lambda: sp.limit(TORSION[0, 1, 1], r, sp.oo), 0),
    "str": (lambda: str(G).splitlines()[0], "metric g_{ab} (a, b: coordinates r, theta)"),
}  # fmt: skip

NUMPY = {
    "array of symbols": (lambda: np.array(G).dtype == object, True),
    "array of constants": (lambda: np.array(THIRD.metric).tolist(), [[1 / 9, 0], [0, 1]]),
    "a given dtype": (lambda: np.array(THIRD.metric, dtype=complex).dtype, np.dtype(complex)),
    "numbers at a point": (lambda: G.at({"r": 2}).tolist(), [[1, 0], [0, 4]]),
    "numbers at many points": (lambda: G.at({r: np.arange(1.0, 4.0)})[:, 1, 1].tolist(), [1, 4, 9]),
    "float of a scalar": (lambda: float(SPHERE.curvature.scalar.at({"R": 2})), 0.5),
    "a frame of lists": (lambda: gt.Frame(("x", "y"), np.eye(2, dtype=int)) == 0, False),
    "a start of arrays": (
        lambda: gt.geodesic("flat_polar", np.array([1, 0]), np.array([1, 0])).start, CURVE.start
    ),
    "a start of sympy columns": (
        lambda: gt.geodesic("flat_polar", sp.Matrix([1, 0]), sp.Matrix([1, 0])).start, CURVE.start
    ),
    "a range of times": (lambda: gt.solve(CURVE, range(3))["r"].tolist(), MOTION["r"].tolist()),
    "a Burgers vector": (lambda: np.array(SCREW).round(9).tolist(), [0, 0, 2]),
    "its norm": (lambda: round(np.linalg.norm(SCREW), 9), 2),
    "its format": (lambda: f"{SCREW:.2f}".replace("-0.00", "0.00"), "[0.00, 0.00, 2.00]"),
    "a map of Burgers vectors": (
        lambda: np.array(
            gt.burgers_map("flat_polar", ([1, 2, 3], [0, 1]), plane=("r", "phi"))
        ).shape,
        (2, 2, 1),
    ),
    "a solution": (lambda: np.array(MOTION)[:, 1].round(9).tolist(), [1, 2, 3]),
    "the last value": (lambda: round(MOTION["r"][-1], 9), 3),
}  # fmt: skip

TABLES = {
    "names": (lambda: list(MOTION.keys()), ["r", "phi", "u1", "u2"]),
    "keys print names": (lambda: "'r'" in repr(MOTION.keys()), True),
    "values": (lambda: [x.shape for x in MOTION.values()], [(3,)] * 4),
    "items": (lambda: [name for name, _ in MOTION.items()], ["r", "phi", "u1", "u2"]),
    "dict": (lambda: dict(MOTION)["r"].round(9).tolist(), [1, 2, 3]),
    "length": (lambda: len(MOTION), 4),
    "json": (lambda: json.loads(json.dumps(SCREW.to_json()))["loop"], "circle"),
    "a copy": (lambda: copy.deepcopy(G) == G, True),
    "a pickle": (lambda: pickle.loads(pickle.dumps(G)) == G, True),
    "a key of a dict": (lambda: {G: "metric"}[POLAR.metric], "metric"),
    "LaTeX in a notebook": (lambda: G._repr_latex_().startswith("$"), True),
    "a scene for a minute": (
        lambda: gt.scenes.load("dzhanibekov").with_values({"samples": 2}).run(t="1 min").times[-1],
        60.0,
    ),
    "a scene at times with units": (
        lambda: gt.scenes.load("dzhanibekov").with_values(t=[0, "1 min"]).t, (0.0, 60.0)
    ),
    "a motion for a minute": (lambda: gt.solve(CURVE, "1 min").times[-1], 60.0),
}  # fmt: skip
LINES = SYMPY | NUMPY | TABLES


@pytest.mark.parametrize("line", LINES)
def test_a_line_of_another_library_gives_what_its_user_expects(line: str) -> None:
    """Each line runs as typed and gives the result beside it."""
    call, expected = LINES[line]
    assert call() == expected


def test_the_table_has_more_than_fifty_lines() -> None:
    """No two lines have the same name."""
    assert len(LINES) == len(SYMPY) + len(NUMPY) + len(TABLES) > 50


def test_a_solution_is_a_table_of_pandas() -> None:
    """`pandas.DataFrame(dict(solution))` and `to_pandas` have a column for each name."""
    pandas = pytest.importorskip("pandas")
    assert list(pandas.DataFrame(dict(MOTION))) == list(MOTION)
    assert MOTION.to_pandas()["r"].round(9).tolist() == [1, 2, 3]


def test_names_of_a_table_count_not_its_order() -> None:
    """A Series, a table and a record are read by their names, in any order."""
    pandas = pytest.importorskip("pandas")
    swing = ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 1})
    series = pandas.Series({"phi": 0, "r": 1})
    record = np.array([(0, 1)], dtype=[("phi", int), ("r", int)])[0]
    for start in (series, record, {"phi": 0, r: 1}):
        assert gt.geodesic("flat_polar", start, series[::-1] * 0 + [1, 0]).start == CURVE.start
    starts = pandas.DataFrame({"v": [0.0, 2.0], "x": [3.0, 0.0]})
    for members in (starts, starts.to_records(index=False), starts.to_numpy()[:, ::-1]):
        ends = gt.solve_many(swing, members, [0.0, 1.0])["x"][:, 0]
        assert ends.tolist() == [3, 0]
    places = pandas.DataFrame({"phi": [0.5, 1.5], "r": [2.0, 3.0]})
    ends = gt.solve_many(CURVE, places, t=[0.0, 1.0])
    assert ends["r"][:, 0].tolist() == [2, 3]
    radial = gt.solve_many(CURVE, {"r": [2.0, 3.0]}, t=[0.0, 1.0])
    assert radial["phi"][:, 0].tolist() == [0, 0]


SLIPS = [
    (lambda: G.subs(r, 2), CoordinateError, r"exact ones tensor.to_sympy\(\).subs\(r, ...\)"),
    (lambda: CONE.metric.subs(k, 2.5), ExpressionError, "for example 5/2"),
    (lambda: G * sp.Matrix([1, 2]), TensorIndexError, r"products of matrices write sympy.Matrix"),
    (lambda: G * [1, 2], TensorIndexError, "expected a number or an expression"),
    (lambda: G.T, AttributeError, r"sympy.Matrix\(tensor\).T"),
    (lambda: G.rank, AttributeError, "mean ndim"),
    (lambda: G.applyfunc, AttributeError, r"tensor.to_sympy\(\).applyfunc"),
    (lambda: SPHERE.christoffel, AttributeError, "connection.coefficients"),
    (lambda: POLAR.e, AttributeError, "frame.coframe"),
    (lambda: gt.spaces.list, AttributeError, r"gt.spaces.names\(\)"),
    (lambda: gt.load, AttributeError, r"gt.spaces.load\(name\)"),
    (lambda: gt.spaces.load("kerr").parameters, AttributeError, "space.frame.parameters"),
    (lambda: MOTION.to_numpy, AttributeError, r"numpy.array\(solution\)"),
    (lambda: gt.scenes.load("dzhanibekov").run(t="1 kg"), TimeError, "t: "),
    (lambda: gt.scenes.load("dzhanibekov").run(t="soon"), GeomtorsionError, "soon"),
    (lambda: gt.solve_many(CURVE, {"q": [1, 2]}, t=1.0), StartError, "'q'"),
    (lambda: gt.solve_many(CURVE, {"r": [1, 2], "phi": [0] * 3}, t=1.0), ShapeError, "equal len"),
    (lambda: gt.solve(CURVE, "abc"), TimeError, "expected a number or a list of numbers"),
]


@pytest.mark.parametrize(("call", "error", "words"), SLIPS)
def test_a_slip_of_another_library_is_answered(call, error, words) -> None:
    """Each slip raises an error that names the remedy."""
    with pytest.raises(error, match=words):
        call()

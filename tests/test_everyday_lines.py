"""Everyday lines, as a user types them, each with its result; and what slips are answered with."""

# Slips of users, which a checker of types finds too.
# pyright: reportAttributeAccessIssue=false, reportCallIssue=false, reportArgumentType=false

import importlib
import inspect
import sys
from types import ModuleType

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import exercises, gravity
from geomtorsion.errors import (
    ArgumentError,
    CoordinateError,
    ExpressionError,
    LoopError,
    MissingExtraError,
    MissingValueError,
    ShapeError,
    SignatureError,
    StartError,
    StructureConstantError,
    UnknownNameError,
)
from geomtorsion.pictures import can_draw

SO3 = gt.spaces.load("so3")
PLACE = [0.3, 1, 0.2]
LOOP = gt.Loop.circle(PLACE, 0.3)
CURVE = gt.geodesic("flat_polar", [1, 0], [1, 0.5])
POLAR = gt.Frame("r theta", [["1", "0"], ["0", "r"]])
HOLE = gt.Frame(
    "t r theta phi",
    [["sqrt(1 - 2 M/r)", 0, 0, 0], [0, "1/sqrt(1 - 2 M/r)", 0, 0], [0, 0, "r", 0],
     [0, 0, 0, "r sin(theta)"]],
    signature="-+++", parameters="M", domain="r > 2 M, M > 0, 0 < theta < pi",
)  # fmt: skip
SCENE = gt.Scene(gt.Body(moments=(1, 2, 3)), start=gt.State(omega=(1, 0, 0)))
MOTION = gt.solve(CURVE, [0.0, 1.0])
r = sp.Symbol("r")

LINES = {
    "a name for a frame": (lambda: gt.cartan("so3").is_flat, True),
    "a space for a frame": (
        lambda: str(gt.cartan(SO3).torsion.T[0, 1, 2]),
        str(gt.cartan(SO3.frame).torsion.T[0, 1, 2]),
    ),
    "equal names give tensors that combine": (
        lambda: (gt.levi_civita("s2").coefficients - gt.levi_civita("s2").coefficients).is_zero,
        True,
    ),
    "Levi-Civita of a name": (lambda: gt.levi_civita("flat_polar").is_flat, True),
    "Burgers vector of a space": (
        lambda: list(gt.burgers_vector(SO3, LOOP).vector),
        list(gt.burgers_vector(SO3.frame, LOOP).vector),
    ),
    "exact Burgers vector of a name": (
        lambda: len(gt.exact_burgers_vector("heisenberg", gt.Loop.circle([0, 0, 0], 1)).vector),
        3,
    ),
    "autoparallel of a space": (
        lambda: gt.autoparallel(SO3, [0.3, 1, 0.2], frame_velocity=[1, 0, 0]).text,
        gt.autoparallel(gt.cartan(SO3.frame), [0.3, 1, 0.2], frame_velocity=[1, 0, 0]).text,
    ),
    "a space's own connection": (
        lambda: gt.spaces.load("chaplygin_sleigh").own_connection().allowed,
        (0, 1),
    ),
    "development of a name": (
        lambda: gt.develop("so3", LOOP).angle,
        gt.develop(gt.cartan(SO3.frame), LOOP).angle,
    ),
    "identities of a name": (lambda: all(x.holds for x in gt.identities("flat_polar")), True),
    "symmetries of a name": (lambda: gt.symmetries("flat_polar").dimension, 3),
    "constraints over a name": (
        lambda: gt.constrained("flat_polar", [0]).allowed,
        (0,),
    ),
    "field equations of a name": (lambda: gravity.equations("frw", "T").frame.dimension, 4),
    "metric of a frame in text": (lambda: POLAR.metric[1, 1] == sp.Symbol("r") ** 2, True),
    "a scalar in text": (lambda: POLAR.scalar("2 r")[()] == 2 * sp.Symbol("r"), True),
    "a vector in text": (lambda: POLAR.vector(["r", "0"])[0] == sp.Symbol("r"), True),
    "a signature in text": (lambda: [HOLE.eta[k, k] for k in range(4)], [-1, 1, 1, 1]),
    "a domain in text": (lambda: len(HOLE.domain), 4),
    "a black hole in text": (lambda: gt.levi_civita(HOLE).curvature.ricci.is_zero, True),
    "a metric in text": (
        lambda: gt.Frame.from_metric("r phi", [["1", "0"], ["0", "r^2"]], domain="r>0").shape,
        "metric",
    ),
    "legs in text": (
        lambda: str(gt.Frame.from_frame("r phi", [["1", "0"], ["0", "1/r"]]).coframe[1, 1]),
        "r",
    ),
    "text beside a symbol": (
        lambda: gt.Frame([r, "phi"], [[1, 0], [0, "r"]]).metric[1, 1] == r**2,
        True,
    ),
    "structure constants by index": (
        lambda: gt.Frame.from_structure_constants(
            {(0, 1, 2): 1, (1, 2, 0): 1, (2, 0, 1): 1}
        ).anholonomy[0, 1, 2],
        -1,
    ),
    "a start by name": (
        lambda: gt.geodesic("flat_polar", {"phi": 0, "r": 1}, {"phi": 0.5, "r": 1}).start,
        CURVE.start,
    ),
    "a velocity by name": (
        lambda: gt.geodesic("flat_polar", {"phi": 0, "r": 1}, {"phi": 0.5, "r": 1}).frame_velocity,
        CURVE.frame_velocity,
    ),
    "frame velocities by name": (
        lambda: gt.autoparallel("so3", frame_velocity={"u3": 3, "u1": 1, "u2": 2}).frame_velocity,
        (1, 2, 3),
    ),
    "a product without a sign": (
        lambda: gt.parse_expression("2 r", {"r": r}) == 2 * r,
        True,
    ),
    "hasattr of a slip": (lambda: hasattr(gt, "autoparralel"), False),
    "hasattr of a slip on a frame": (lambda: hasattr(POLAR, "torsion"), False),
    "hasattr of a name on a frame": (lambda: hasattr(POLAR, "metric"), True),
    "getattr with a default": (lambda: getattr(LOOP, "curve", 3), 3),
    "help of a hinted function": (
        lambda: list(inspect.signature(gt.solve).parameters)[:3], ["problem", "t", "accuracy"]
    ),
    "a scene in short": (lambda: repr(SCENE), "Scene(scene: no effects; watched: omega)"),
    "a body in short": (lambda: repr(SCENE.body), "Body(moments=(1, 2, 3))"),
    "a state in short": (lambda: repr(SCENE.start), "State(omega=(1, 0, 0))"),
    "a moment in short": (lambda: repr(MOTION.at(0.0))[:24], "Moment at 0: r = 1, phi "),
    "a verdict in short": (
        lambda: repr(exercises.load("3.2", 1).check({"christoffel": "1"})),
        "Verdict(exercise 3.2: 0 of 1 points; christoffel wrong)",
    ),
    "a proof in a notebook": (
        lambda: gt.prove(gt.burgers_vector(SO3, LOOP))._repr_html_().count("<tr>"), 4
    ),
    "a loop in a notebook": (lambda: "circle" in LOOP._repr_html_(), True),
    "a moment in a notebook": (lambda: MOTION.at(0.0)._repr_html_().count("<tr>"), 5),
    "a metric as a matrix": (lambda: POLAR.metric._repr_html_().count("<mtr>"), 2),
    "a torsion is not a matrix": (
        lambda: gt.cartan(POLAR).torsion.S._repr_html_().count("<mtr>"), 0
    ),
    "a plane by names": (
        lambda: list(gt.burgers_vectors(SO3, [PLACE], 0.1, plane=("phi1", "phi2")).vectors[0]),
        list(gt.burgers_vectors(SO3, [PLACE], 0.1, plane=(0, 1)).vectors[0]),
    ),
    "a plane of a map by names": (
        lambda: list(
            gt.burgers_map("flat_polar", ([1, 2, 3], [0, 1]), plane=("phi", "r")).plane[0]
        ),
        [0, 1],
    ),
    "keys after a bracket": (lambda: list(MOTION._ipython_key_completions_()), list(MOTION)),
    "keys of a moment": (lambda: MOTION.at(0)._ipython_key_completions_()[:2], ["r", "phi"]),
    "keys of a verdict": (
        lambda: exercises.load("3.2", 1).check({})._ipython_key_completions_(), ["christoffel"]
    ),
    "field equations in a notebook": (
        lambda: gravity.equations("frw", "T")._repr_html_().count("<section"),
        3,
    ),
}  # fmt: skip


@pytest.mark.parametrize("line", LINES)
def test_an_everyday_line_gives_what_its_user_expects(line: str) -> None:
    """Each line runs as typed and gives the result beside it."""
    call, expected = LINES[line]
    assert call() == expected


SLIPS = [
    (lambda: gt.cartan("so33"), UnknownNameError, "Near: so3"),
    (lambda: gt.cartan(3), ArgumentError, "expected a Frame, got 3"),
    (lambda: gt.burgers_vector(gt.cartan(SO3), LOOP), ArgumentError, "Give connection.frame"),
    (lambda: gt.autoparallel(SO3.frame, [0, 1, 0]), ArgumentError, r"Give cartan\(frame\) or"),
    (lambda: gt.Frame("r", [["a r"]]), ExpressionError, "a is neither a coordinate nor a declared"),
    (lambda: gt.Frame("r", [["r"]], domain="r"), CoordinateError, "expected a comparison"),
    (lambda: gt.Frame("r", [["r"]], signature="x"), SignatureError, r'"-\+\+\+"'),
    (lambda: gt.Frame("r", [["1/r sin(r)"]]), ExpressionError, "read in two ways"),
    (lambda: gt.Frame("r", [["__import__('os')"]]), ExpressionError, "expressions|starts with"),
    (
        lambda: gt.Frame.from_structure_constants({(0, 1): 1}),
        StructureConstantError,
        "expected three indices",
    ),
    (
        lambda: gt.Frame.from_structure_constants({(0, 1, 10**9): 1}),
        StructureConstantError,
        "expected each leg from 0",
    ),
    (lambda: gt.geodesic("flat_polar", {"ph": 0, "r": 1}, [1, 0]), StartError, "Did you mean phi"),
    (lambda: gt.geodesic("flat_polar", {"r": 1}, [1, 0]), StartError, "a value for phi, got none"),
    (lambda: LOOP.plot(names=["x"]), ShapeError, "one for each of 3 coordinates, got 1"),
    (
        lambda: gt.cartan(POLAR).torsion.S.plot(at={}),
        ShapeError,
        "expected a tensor with two indices",
    ),
    (lambda: POLAR.metric.plot(at={}), MissingValueError, "r"),
    (lambda: gt.Loop.circle([0, 0], 1, ("r", "phi")), LoopError, "count them from 0"),
    (
        lambda: gt.burgers_vectors(SO3, [PLACE], 0.1, plane=("phi1", "phi4")),
        LoopError,
        "got 'phi4'. Did you mean phi",
    ),
    (lambda: gt.autoparralel, AttributeError, r"Did you mean autoparallel\?"),
    (lambda: POLAR.torsion, AttributeError, r"mean gt.cartan\(frame\).torsion\?"),
    (lambda: POLAR.cofram, AttributeError, r"Did you mean coframe\?"),
    (lambda: POLAR.quite_another, AttributeError, "no attribute 'quite_another'$"),
    (lambda: POLAR._private, AttributeError, "no attribute '_private'$"),
    (lambda: SO3.metric, AttributeError, r"mean space.frame.metric\?"),
    (lambda: gt.cartan(POLAR).ricci, AttributeError, r"mean connection.curvature.ricci\?"),
    (lambda: POLAR.metric.trace, AttributeError, r"mean sympy.Matrix\(tensor\).trace\(\)\?"),
    (lambda: POLAR.metric.element_, AttributeError, r"Did you mean element\?"),
    (lambda: LOOP.curve, AttributeError, r"Did you mean gt.Loop.parametric\?"),
    (lambda: CURVE.strat, AttributeError, r"Did you mean start\?"),
    (lambda: MOTION.y, AttributeError, r"mean solution.states\?"),
    (lambda: gt.solve(CURVE, 1, method="RK45"), ArgumentError, r"mean engine=RungeKutta\(\)\?"),
    (lambda: gt.solve(CURVE, 1, acuracy=1e-3), ArgumentError, r"Did you mean accuracy\?"),
    (lambda: gt.geodesic(POLAR, [1, 0], velocty=[1, 0]), ArgumentError, r"mean velocity\?"),
    (
        lambda: gt.burgers_vector(SO3, LOOP, exact=True),
        ArgumentError,
        r"mean exact_burgers_vector\(frame, loop\)",
    ),
    (lambda: gt.burgers_vector(SO3, LOOP, tol=1e-8), ArgumentError, "mean accuracy=1e-8"),
    (lambda: gt.develop("so3", LOOP, conection=1), ArgumentError, r"mean connection\?"),
]


@pytest.mark.parametrize(("call", "error", "words"), SLIPS)
def test_a_slip_is_answered(call, error, words) -> None:
    """Each slip raises an error that names the remedy."""
    with pytest.raises(error, match=words):
        call()


MODULES = [getattr(gt, name) for name in gt.__all__ if inspect.ismodule(getattr(gt, name))]
PACKAGES = [module for module in MODULES if hasattr(module, "__all__")]


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.__name__)
def test_tab_shows_the_public_names(package: ModuleType) -> None:
    """`dir` of a public package is its __all__, and each name is there."""
    assert dir(package) == sorted(package.__all__)
    assert importlib.import_module(package.__name__) is package
    assert all(getattr(package, one) is not None for one in package.__all__)


FIGURES = {
    "Burgers vector": (lambda: gt.burgers_vector(SO3, LOOP), 2),
    "development": (lambda: gt.develop("so3", LOOP), 2),
    "solution": (lambda: gt.solve(CURVE, [0.0, 1.0]), 1),
    "loop": (lambda: LOOP, 1),
    "constant tensor": (lambda: POLAR.eta, 1),
    "plan": (lambda: SO3.frame.plan("metric"), 1),
    "stress": (
        lambda: gt.stresses(
            gt.NyeField(np.zeros((3, 3, 4, 4, 4)), gt.Box.of_bounds([0, 0, 0], [1, 1, 1])),
            gt.ElasticConstants.isotropic(1, 0.3),
        ),
        1,
    ),
    "map": (
        lambda: gt.burgers_map(
            "screw_dislocation", (np.linspace(-1, 1, 4), np.linspace(-1, 1, 4)), parameters={"b": 1}
        ),
        1,
    ),
}


@pytest.mark.skipif(not can_draw(), reason="the extra plots is not installed")
@pytest.mark.parametrize("what", FIGURES)
def test_a_result_draws_itself(what: str) -> None:
    """`.plot()` gives the figure of the package of pictures."""
    make, least = FIGURES[what]
    assert len(make().plot().axes) >= least


@pytest.mark.skipif(not can_draw(), reason="the extra plots is not installed")
def test_a_tensor_draws_its_components() -> None:
    """A figure of a metric shows the numbers at the point, row by row."""
    axes = POLAR.metric.plot(at={"r": 3}).axes[0]
    assert [text.get_text() for text in axes.texts] == ["1", "0", "0", "9"]
    assert [text.get_text() for text in axes.get_xticklabels()] == ["$r$", "$\\theta$"]


def test_a_motion_goes_to_xarray() -> None:
    """`to_xarray` has the columns of `to_pandas` along the time, and the error."""
    pytest.importorskip("xarray")
    data = MOTION.to_xarray()
    assert data["r"].dims == ("t",)
    assert data["r"].values.tolist() == MOTION["r"].tolist()
    assert float(data["phi"].sel(t=1.0)) == MOTION["phi"][-1]
    assert data.attrs["error"] == MOTION.error


def test_without_xarray_a_line_names_the_remedy(monkeypatch) -> None:
    """`to_xarray` names the library that is missing."""
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(MissingExtraError, match="to_xarray needs xarray"):
        MOTION.to_xarray()


def test_a_call_without_an_argument_names_it():
    """The error belongs to this library and lists the arguments."""
    for call in (gt.burgers_vector, gt.solve, gt.shadow, gt.burgers_map):
        with pytest.raises(gt.errors.ArgumentError, match="got no "):
            call()

"""Canary cases: one valid call of each public function, class and method of values."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
import sympy as sp

import geomtorsion as gt
from geomtorsion import exercises, scenes, spaces
from geomtorsion.scenes import effects
from geomtorsion.teaching.exercises.exports.tasks import tasks
from tests.canary import Case
from tests.golden import record

# Public names of packages that were at the top level until 0.3.0.
MOVED: dict[str, str] = record.read(record.MOVED_FILE)
X, Y = sp.symbols("x y")
PLANE = gt.Frame([X, Y], [[1, 0], [0, 1 + X**2]], name="bent")
FLAT = gt.Frame("t x y z", sp.eye(4), signature=(-1, 1, 1, 1))
FALL = gt.ODE.of({"z": "v", "v": "-10"}, [1, 0], events=[gt.When("z")])
CORE = gt.Frame("x y", [["1", "0"], ["b*y", "1"]], parameters="b")
CRYSTAL = gt.loops.parallel_screws([(0, 0)], [1])
SCREW = gt.loops.parallel_screws([(0, 0)], [sp.Symbol("b")])
LINE = gt.loops.Defect((0, 0, 0), (0, 1))
CARTAN, RIEMANN = gt.cartan(PLANE), gt.levi_civita(PLANE)
PLANE_METRIC = gt.numpy_function([PLANE.metric.element(1, 1)], [X, Y])
CIRCLE = gt.Loop.circle([0, 0], 1)
ROUND = gt.Loop.circle([0, 0, 0], 1)
VECTOR = gt.Tensor(PLANE, "u", {(0,): PLANE.read([("x", X)])[0]})
CURVE = gt.geodesic(PLANE, [0, 0], [1, 1])
ODE = gt.ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 1})
SOLVED = gt.solve(CURVE, 0.5, 1e-6, gt.RungeKutta())
RUN = gt.solve(ODE, 0.5, 1e-6, gt.RungeKutta())
BODY = scenes.Body(moments=(1, 2, 3))
SCENE = scenes.Scene(
    BODY, [effects.AngularDamping(0.1)], scenes.State(omega=(1, 2, 3)), t=0.5, accuracy=1e-6
)
RESULT = SCENE.run(gt.RungeKutta())
GRID = gt.SampledFrame([np.arange(9.0), np.arange(9.0)], np.ones((1, 2, 9, 9)))
_CUBE = [np.arange(9.0)] * 3
BLOCK = gt.SampledFrame(_CUBE, np.broadcast_to(np.eye(3)[:, :, None, None, None], (3, 3, 9, 9, 9)))
SLOPES = gt.SampledFrame(_CUBE, np.zeros((3, 3, 9, 9, 9)))
_POINTS = np.random.default_rng(0).uniform(-1, 1, (60, 2))
SCATTERED = gt.ScatteredFrame.from_coframe(
    _POINTS, np.ones((1, 2, 60)), mask=np.hypot(*_POINTS.T) < 0.3
)
HOLED = gt.SampledFrame(GRID.axes, GRID.coframe, mask=np.pad([[True]], 4))
CRYSTALS = gt.OrientationMap.from_euler(np.zeros((8, 8, 3)), 1.0, "m-3m", sigma=0.1)
IRON = gt.Phase("iron", "m-3m", (2.87, 2.87, 2.87))
TRIANGLE = nx.Graph()
for _k, _place in enumerate([(0, 0), (1, 0), (0, 1)]):
    TRIANGLE.add_node(_k, position=_place)
nx.add_cycle(TRIANGLE, range(3))
NETWORK = gt.loops.Network(PLANE, TRIANGLE)
TRIANGLE_FILE = str(Path(__file__).parent / "data" / "triangle.data")
RING = gt.LineArrays(
    [[1, 1, 2], [3, 1, 2], [2, 3, 2]], [[0, 1], [1, 2], [2, 0]], [[0, 0, 1]] * 3,
    gt.Box.of_bounds([0, 0, 0], [4, 4, 4]),
)  # fmt: skip
PLACED = gt.DislocationNetwork.of_arrays(RING)
STEEL = gt.ElasticConstants.isotropic(80.0, 0.3, "GPa")
OPEN_FIELD = gt.NyeField(
    np.zeros((3, 3, 2, 2, 2)), gt.Box.of_bounds([0, 0, 0], [4, 4, 4], periodic=False)
)
_Y, _X = np.mgrid[63:-1:-1, 0:64]
PICTURE = np.cos(np.pi * _X / 3) + np.cos(np.pi * _Y / 3)
PHASES = gt.LatticeImage(PICTURE).phases()
ATOM_FILE = Path(__file__).parent / "data" / "tungsten.xyz"
CORNERS = np.argwhere(np.ones((4, 4, 4)))
ATOMS = 3.2 * np.concatenate([CORNERS, CORNERS + 0.5])
IRON_ATOMS = gt.crystals.Crystal(ATOMS, np.diag([12.8] * 3))
LINES = gt.DislocationNetwork.of_lines([("a", "b", (1, 0, 0)), ("b", "a", (1, 0, 0))])
EXERCISE = exercises.load("3.2", 1)
ANSWERS = {question.name: "1" for question in EXERCISE.questions}
QUICK = gt.RungeKutta()
NOTHING: dict[str, Any] = {}


def _of(name: str, call: Callable[..., Any], /, **arguments: Any) -> Case:
    return Case(name, call, arguments)


def _public(name: str, /, **arguments: Any) -> Case:
    home = MOVED.get(name)
    package = gt if home is None else import_module(f"geomtorsion.{home}")
    return Case(name, getattr(package, name), arguments)


def gravity_functions() -> list[Case]:
    """Lagrangians, connections and matter of field equations."""
    g = gt.gravity
    space = gt.Frame([X, Y, sp.Symbol("z")], sp.eye(3))
    tau = [[[0, 0, 0], [0, 0, 1], [0, -1, 0]]] * 3
    fluid = {"density": "rho", "pressure": 0, "velocity": [1, 0]}
    return [
        _of(
            "gravity.equations", g.equations, connections=[CARTAN, RIEMANN],
            lagrangian="T + c*Rbar + v", matter=[], constants="v",
        ),
        _of("gravity.fluid", lambda **given: _with_matter(g.fluid(**given)), **fluid),
        _of(
            "gravity.weyssenhoff", lambda **given: _with_matter(g.weyssenhoff(**given)),
            **fluid, spin=[[0, 0], [0, 0]],
        ),
        _of(
            "gravity.scalar_field", lambda phi, name: _with_matter(g.scalar_field(phi, name)),
            phi="x", name="chi",
        ),
        _of(
            "gravity.maxwell", lambda potential: _with_matter(g.maxwell(potential)),
            potential=["y", 0],
        ),
        _of(
            "gravity.kalb_ramond", lambda potential: _with_matter(g.kalb_ramond(potential)),
            potential=["y"],
        ),
        _of("gravity.killing_yano", g.killing_yano, frame=PLANE, degree=1),
        _of("gravity.f_of", g.f_of, invariants=["T", "Rbar"], f="f"),
        _of("gravity.new_gr", g.new_gr, c1=1, c2="c2", c3=X),
        _of("gravity.holst", g.holst, barbero_immirzi="gamma"),
        _of(
            "gravity.poincare", g.poincare, scalar=1, cosmological=0, tensor=0, vector=0, axial=0,
            curvature=[0] * 6,
        ),
        _of("gravity.torsion_from_spin", g.torsion_from_spin, frame=space, tau=tau, kappa=1),
        _of("gravity.inertial", g.inertial, frame=space, limit={}),
    ]  # fmt: skip


def _with_matter(matter: Any) -> Any:
    names = getattr(matter, "names", ())
    return gt.gravity.equations(CARTAN, " + ".join(["T", *names]), matter)


def public_functions() -> list[Case]:
    """All names that geomtorsion exports itself."""
    u1, u2 = sp.symbols("u1 u2")
    energy = {"lagrangian": (u1**2 + u2**2) / 2, "forces": [0, 0], "constraints": None}
    energy |= {"principle": "closed_in_coordinates", "parameters": None, "connection": None}
    starts = {"start": [0, 0], "velocity": [1, 1]}
    settings = {"parameters": {}, "causal": None, "atlas": None, "stop": "u1 + 9"}
    return [
        _public(
            "Frame", coordinates=[X, Y], coframe=[[1, 0], [0, X]], signature=(1, 1),
            parameters=[], domain=[X > 0], complex=False, name="plane", branches={},
        ),
        _public("Tensor", frame=PLANE, slots="u", source={(0,): X}, symmetry=(), name="t"),
        _public("Connection", frame=PLANE, coefficients=CARTAN.coefficients, name="c"),
        _public("Curvature", connection=CARTAN),
        _public("Torsion", connection=CARTAN),
        _public("DependencyGraph", frame=PLANE, name="ricci"),
        _public("blend", first=CARTAN, second=RIEMANN, share=sp.Rational(1, 2)),
        _public("cartan", frame=PLANE),
        _public("constrained", space=PLANE, allowed=[0], parameters="c"),
        _public(
            "embedded", coordinates=[X, Y], rows=[[1, 0], [0, 1], [2 * X, 0]], signature=(1, 1, 1),
            parameters=[], domain=[X > 0], name="parabolic",
        ),
        _public("diffusion", connection=CARTAN),
        _public("defect_densities", strain=BLOCK, bend=SLOPES),
        _public("defect_conservation", dislocation=SLOPES, disclination=SLOPES),
        _public(
            "stresses", source=PLACED, constants=STEEL, shape=[8, 8, 8], core=1.0, gauge=0.1,
            mean_stress=np.eye(3), balance=False, convention="SF/RH",
        ),
        _public("ElasticConstants", voigt=np.eye(6), unit="GPa"),
        _public("NyeField", values=np.zeros((3, 3, 4, 4, 4)), box=RING.box, unit="um"),
        _public("limits", seconds=1.0, megabytes=100.0),
        _public("levi_civita", frame=PLANE),
        _public("identities", connection=CARTAN),
        *gravity_functions(),
        _public("Form", frame=PLANE, degree=1, source={0: X}, values="", symbol="alpha"),
        _public("lie", xi=[X, Y], field=PLANE),
        _public("lie_bracket", frame=PLANE, first=[X, Y], second=[Y, X]),
        _public(
            "surface", frame=PLANE, coordinates=["u"], embedding={"x": 1, "y": "u"},
            domain=None, orientation=1,
        ),
        _public("symmetries", frame=PLANE, keep="metric"),
        _public("killing_equations", frame=PLANE),
        _public("LieAlgebra", constants={(0, 1, 2): 1}),
        _public("same_geometry", one=PLANE, two=PLANE, keep="metric", orientation=False),
        _public(
            "spinning", connection=RIEMANN, start=[0, 0], velocity=[1, 1],
            spin=[[0, 0], [0, 0]], coupling="orbital", parameters={},
        ),
        _of("contract", _contracted, letters="ab,b->a"),
        _public("from_coefficients", frame=PLANE, coefficients=[[[0, X], [0, 0]]] * 2),
        _public("from_contortion", frame=PLANE, contortion=[[[0, 0], [0, 0]]] * 2),
        _public(
            "from_nonmetricity", frame=PLANE, nonmetricity=[[[0, 0], [0, X]]] * 2, torsion=None
        ),
        _public("from_torsion", frame=PLANE, torsion=[[[0, 0], [0, 0]]] * 2),
        _public("from_spin_connection", frame=PLANE, omega=[[[0, X], [-X, 0]]] * 2),
        _public("numpy_function", elements=[PLANE.metric.element(1, 1)], symbols=[X, Y]),
        _public(
            "parse_expression", text="x + f(x)", symbols={"x": X},
            functions={"f": sp.Function("f")}, where="here", limits=None,
        ),
        _public("equations_of_motion", frame=PLANE, **energy),
        _public("conserved_quantities", frame=PLANE, **energy),
        _public("linearized", frame=PLANE, **energy, at={"x": 1, "y": 0}, velocities=None),
        _public("kerr_orbit", a=0.9, p=6, e=0.3, x=0.5),
        _public("variation", frame=PLANE, principle="closed_in_coordinates", connection=None),
        _public("autoparallel", connection=CARTAN, **starts, frame_velocity=None, **settings),
        _public(
            "geodesic", space=PLANE, **starts, frame_velocity=None, metric=None, **settings
        ),
        _public("geodesic_deviation", problem=CURVE, offset=[0, 1], rate=[0, 0]),
        _public("parallel_transport", problem=CURVE, vectors=[[1, 0]], connection=None),
        _public(
            "holonomy", connection=RIEMANN, path=[X, X], t=0.5, parameters={},
            accuracy=1e-6, engine=QUICK,
        ),
        _public(
            "exponential_map", connection=RIEMANN, start=[0, 0], vector=[1, 1],
            parameters={}, accuracy=1e-6, engine=QUICK,
        ),
        _public(
            "log_map", connection=RIEMANN, start=[0, 0], end=[0.5, 0.25], guess=[0.5, 0.25],
            parameters={}, accuracy=1e-6, engine=QUICK,
        ),
        _public("distance_apart", one=SOLVED, two=SOLVED, chart=None),
        _public("prove", result=SOLVED, digits=5, start=[0, 0], parameters={}),
        _public("poincare", problem=ODE, section="v", t=7.0, digits=5, count=1),
        _public("closed_orbit", problem=ODE, period=6.0, near=[1, 0], section="v",
                conserved=["k*x**2 + v**2"], digits=5),
        _public(
            "solve", problem=CURVE, t=[0, 0.5], accuracy=1e-6, engine=QUICK, checkpoint=None,
            progress=None, overwrite=False, derivatives=["x"],
        ),
        _public(
            "fit", problem=gt.ODE.of({"x": "-k*x"}, [1], parameters={"k": 1}), times=[0.5, 1.0],
            data={"x": [0.6, 0.4]}, sigma={"x": 0.1}, free=["k"], accuracy=1e-6, engine=QUICK,
        ),
        _public(
            "solve_many", problem=CURVE, starts=[[0, 0], [0, 1]], t=0.5, accuracy=1e-6,
            engine=QUICK, velocities=None, frame_velocities=[[1, 0], [1, 0]], check=1,
            progress=None, executor=None,
        ),
        _public(
            "end_map", problem=FALL, values={"z": [1.0, 2.0], "v": [0.0]}, t=0.5, accuracy=1e-6,
            engine=QUICK, progress=None, executor=None,
        ),
        _public(
            "shadow", space=FLAT, camera=[0, 9, 0, 0], parameters=None, axis=None, up=None,
            dark="x**2 + y**2 + z**2 - 1", sky="99 - x**2 - y**2 - z**2", light="geodesic",
            length=40.0, engine=QUICK, executor=None,
        ),
        _of(
            "ODE", gt.ODE.of, rates={"x": "v", "v": "-k*x"}, start=[1, 0], parameters={"k": 1},
            invariants={"energy": "v**2 + k*x**2"}, outputs={"twice": "2*x"}, time="t",
            events=[gt.At(0.25, {"k": 2}), gt.When("x + 2")], norm_groups=[["x", "v"]],
            normalized=[], name="spring", tables={"F": gt.Table.of([(0, 1), (1, 3)])},
        ),
        _of("At", _switched, time=0.25, changes={"k": 2}),
        _of("When", _stopped, falls="x + 2", changes={}),
        _of(
            "Table", gt.Table.of, rows=[(0, 1), (1, 3)], interpolation="linear", outside="refuse",
        ),
        _public(
            "Taylor", precision=53, max_steps=1000
        ),
        _public("RungeKutta", max_evaluations=10**5),
        _public("Stiff", method="Radau", max_evaluations=10**5),
        _public("free_top", moments=(1, 2, 3), omega=(1, 2, 3), quaternion=(1, 0, 0, 0)),
        _public(
            "FreeTop", moments=(1.0, 2.0, 3.0), omega0=(1.0, 2.0, 3.0),
            quaternion0=(1.0, 0.0, 0.0, 0.0),
        ),
        _public(
            "price", thing=CURVE, at=0.25, accuracies=[1e-3], engines=[QUICK], parameters={},
            proofs=[10], memory=False,
        ),
        _public("called_for", thing=CURVE, accuracy=1e-3, at=0.25, watch=["x"], engine=QUICK),
        _public("burgers_vector", frame=PLANE, loop=CIRCLE, accuracy=1e-6, parameters={}),
        _public("exact_burgers_vector", frame=PLANE, loop=CIRCLE, seconds=5.0),
        _public(
            "burgers_derivatives", frame=CORE, loop=CIRCLE, by=["b"], accuracy=1e-6,
            parameters={"b": 0.5},
        ),
        _public(
            "fit_frame", frame=CORE, points=[[0, 1]], coframe=[[[1, 0], [0.4, 1]]], sigma=0.1,
            free=["b"], parameters={"b": 0.5},
        ),
        _public(
            "fit_loops", frame=CORE, loops=[CIRCLE], vectors=[[0, 1]], sigma=0.1, free=["b"],
            parameters={"b": 0.5}, accuracy=1e-6,
        ),
        _public(
            "burgers_vectors", frame=PLANE, centres=[[0, 0], [1, 0]], radius=0.5, plane=(0, 1),
            accuracy=1e-6, parameters={}, executor=None,
        ),
        _public(
            "burgers_map", frame=PLANE, edges=([0, 1, 2], [0, 1]), plane=(0, 1), at=[0, 0],
            executor=None,
            accuracy=1e-6, parameters={},
        ),
        _public(
            "develop", connection=CARTAN, loop=CIRCLE, accuracy=1e-6, parameters={}, defects=[]
        ),
        _public(
            "develop_path", connection=CARTAN, points=[[0, 0], [1, 0], [1, 1]], accuracy=1e-6,
            parameters={},
        ),
        _public(
            "develop_period", connection=CARTAN, points=[[0, 0], [1, 0], [0, 0.5]],
            periods={"y": 0.5}, accuracy=1e-6, parameters={},
        ),
        _public("dispiration", alpha=sp.Rational(1, 2), b=1),
        _public("find_defects", frame=CRYSTAL),
        _public(
            "enclosed_defects", frame=CRYSTAL, loop=ROUND, parameters={},
            defects=[gt.loops.Defect((0, 0, 0), (0, 1))], connection=None,
        ),
        _public(
            "parallel_dislocations", positions=[(0, 0), (1, 0)], burgers=[(0, 0, 1), (1, 0, 0)],
            name="two",
        ),
        _public("parallel_edges", positions=[(0, 0)], burgers=[(1, 0)]),
        _public("parallel_screws", positions=[(0, 0)], burgers=[1]),
        _of(
            "Defect", lambda **given: gt.loops.Defect(**given).place({}), point=(0, 0, 1),
            across=(0, 1), name="axis", source="declared", names=("x", "y", "z"), free=(2,),
        ),
        _public("Network", frame=PLANE, graph=TRIANGLE, position="position", accuracy=1e-6),
        _public("EdgeList", positions=[[0, 0], [1, 0], [0, 1]], pairs=[[0, 1], [1, 2], [2, 0]]),
        _public(
            "Cochain", complex=gt.Complex.of_edges([[0, 1], [1, 0]]), values=[[1, 2], [3, 4]],
            errors=[0, 0], degree=1,
        ),
        _public(
            "Complex", nodes=2, pairs=[[0, 1]], images=[[1]], faces=None, cells=None, labels="ab"
        ),
        _public("Circuit", starts=[(0, 0), (0, 1), (1, 1), (1, 0)],
                ends=[(0, 1), (1, 1), (1, 0), (0, 0)], times=[1, 1, 1, 1]),
        _public("Phase", name="iron", laue="m-3m", lengths=(2.87, 2.87, 2.87), angles=(90, 90, 90),
                horizontal="x"),
        _public("OrientationMap", quaternions=CRYSTALS.quaternions, phase=CRYSTALS.phase,
                phases={1: IRON}, steps=(1, 1), shift=0, threshold=5, sigma=0.1, unit="um"),
        _public("LatticeImage", values=PICTURE, step=1, unit="nm"),
        _of("crystals.Crystal", gt.crystals.Crystal, positions=ATOMS, cell=np.diag([12.8] * 3),
            periodic=(True, True, True), lattice="bcc", orient=np.eye(3), constant=3.2,
            species=["W"] * len(ATOMS)),
        _of("crystals.read", gt.crystals.read, path=str(ATOM_FILE), frame=0, lattice="bcc",
            orient=np.eye(3), constant=3.2, form="extxyz"),
        _of("Crystal.circuit", IRON_ATOMS.circuit, atoms=[0, 1, 8, 7]),
        _of("Crystal.circuit.around", IRON_ATOMS.circuit.around, point=[6, 6, 6],
            normal=[0, 0, 1], radius=4.0),
        _public(
            "SampledFrame", axes=[np.arange(9.0), np.arange(9.0)],
            coframe=np.ones((1, 2, 9, 9)), order=4, names=("x", "y"),
            mask=np.zeros((9, 9), bool), sigma=0.1, periodic=("x",), unit="um", vector_unit="um",
        ),
        _public("Reaction", before=[(1, 0, 0)], after=[(1, 0, 0)], tolerance=1e-9),
        _public("Loop", parts=CIRCLE.parts, name="loop"),
        _public("AffineMap", increment=np.zeros((3, 3))),
    ]  # fmt: skip


def public_methods() -> list[Case]:
    """Methods that take values, and other constructors."""
    loop = gt.Loop
    return [
        _of(
            "Frame.from_frame", gt.Frame.from_frame, coordinates=[X, Y], legs=[[1, 0], [0, X]],
            signature=(1, 1), parameters=[], domain=X > 0, complex=False, name="a", branches={},
        ),
        _of(
            "Frame.from_metric", gt.Frame.from_metric, coordinates="x y",
            metric=[[1, 0], [0, X**2]], signature=(1, 1), parameters=[], domain=[X > 0], name="a",
            branches={},
        ),
        _of(
            "Frame.from_structure_constants", gt.Frame.from_structure_constants,
            constants=[[[0, 0], [1, 0]], [[-1, 0], [0, 0]]], coordinates="x y", signature=(1, 1),
            name="a",
        ),
        _of("Frame.quantity", PLANE.quantity, name="ricci"),
        _of("Space.quantity", spaces.load("s2").quantity, name="ricci"),
        _of("Frame.plan", PLANE.plan, name="ricci"),
        _of("Frame.read", PLANE.read, entries=[("entry", X)]),
        _of("Tensor.at", PLANE.metric.at, point={"x": 1, "y": 2}),
        _of("Tensor.element", lambda i: PLANE.metric[i, 0], i=0),
        _of("Tensor.raised", PLANE.metric.raised, k=0),
        _of("Tensor ==", lambda other: PLANE.metric == other, other=1),
        _of("Tensor *", lambda other: PLANE.metric * other, other=2),
        _of("Tensor +", lambda other: PLANE.metric + other, other=PLANE.metric),
        _of("Element ==", lambda other: PLANE.metric.element(1, 1) == other, other=2),
        _of("Element +", lambda other: PLANE.metric.element(1, 1) + other, other=2),
        _of("Element *", lambda other: other * PLANE.metric.element(1, 1), other=2),
        _of("Element.diff", PLANE.metric.element(1, 1).diff, symbol=X),
        _of("Connection.covariant_derivative", CARTAN.covariant_derivative, tensor=VECTOR),
        _of("Torsion.force", CARTAN.torsion.force, velocity=[1, 2]),
        _of("numpy_function()",
            _metric_at,
            a=1.0, b=2.0),
        _of(
            "Loop.circle", loop.circle, centre=[0, 0], radius=1, plane=(0, 1), name="circle"
        ),
        _of("Loop.circle in a plane", loop.circle, centre=[0, 0, 0], radius=sp.Symbol("a"),
            plane=((1, 0, 0), (0, 1, 1))),
        _of(
            "Loop.ellipse", loop.ellipse, centre=[0, 0], axes=(1, 2), plane=(0, 1), name="ellipse"
        ),
        _of("Loop.ellipse with symbols", loop.ellipse, centre=[X, 0], axes=(1, 2), plane=(0, 1)),
        _of(
            "Loop.polygon", loop.polygon, vertices=[[0, 0], [1, 0], [0, 1]], centre=[1, 1],
            size=0.1, name="polygon",
        ),
        _of(
            "Loop.parametric", loop.parametric, expressions=["cos(s)", "sin(s)"], parameter="s",
            interval=(0, 2 * sp.pi), centre=[1, 1], size=1, symbols={"a": sp.Symbol("a")},
            name="curve", periods={1: 1},
        ),
        _of("conventions.burgers", gt.conventions.burgers, vector=[0, 1], name="FS/RH"),
        _of("BurgersVector.in_convention", gt.burgers_vector(PLANE, CIRCLE).in_convention,
            name="OVITO"),
        _of("Loop.plaquette", loop.plaquette, corner=[0, 0], steps=(1, 1), plane=(0, 1), name="a"),
        _of(
            "Loop.spline", loop.spline, points=[[0, 0], [1, 0], [1, 1], [0, 1]], centre=[0, 0],
            size=1, name="spline",
        ),
        _of("Loop.from_cycle", loop.from_cycle, graph=TRIANGLE, cycle=[0, 1, 2],
            position="position", name="cycle"),
        _of("Loop.from_cycle of positions", _cycle_with, position=(0, 0)),
        _of("Loop.at", loop.circle([0, 0], sp.Symbol("a")).at, values={"a": 1}),
        _of("Loop.times", CIRCLE.times, count=2),
        _of("Loop.then", CIRCLE.then, other=CIRCLE),
        _of("Loop.points", CIRCLE.points, count=10),
        _of("Loop.winding", CIRCLE.winding, axis=[0, 0], plane=(0, 1)),
        _of("Defect.place", gt.loops.Defect((0, X, 0), (0, 1)).place, parameters={"x": 1}),
        _of("Defect.winding", LINE.winding, loop=ROUND, parameters={}),
        _of(
            "burgers_vector with a parameter",
            gt.burgers_vector, frame=SCREW, loop=ROUND,
            accuracy=1e-6, parameters={"b": 1},
        ),
        _of("BurgersVector.in_coordinates", gt.burgers_vector(PLANE, CIRCLE).in_coordinates,
            point=[0, 0]),
        _of("BurgersVector.screw", gt.burgers_vector(CRYSTAL, ROUND).screw, direction=[0, 0, 1]),
        _of("ExactBurgersVector.at",
            gt.exact_burgers_vector(PLANE, gt.Loop.circle([0, 0], sp.Symbol("a"))).at,
            values={"a": 1}),
        _of("Cochain.of_edges", gt.Cochain.of_edges, pairs=[[0, 1]], values=[[1]], errors=[0],
            images=[[0]], nodes=2, labels="ab"),
        _of("Cochain.of_graph", gt.Cochain.of_graph, graph=nx.DiGraph([(0, 1, {"vector": (1,)})]),
            value="vector", error="error", image="image"),
        _of("Cochain.around", NETWORK.cochain.around, cycle=[0, 1, 2]),
        _of("Cochain.over", NETWORK.cochain.over, chains={0: 1}),
        _of("Cochain.mapped", NETWORK.cochain.mapped, matrix=[[1, 0], [0, 1]]),
        _of("Cochain.between", gt.Cochain.between, complex=gt.Complex.grid((2,), True),
            positions=[[0], [1]], periods=[[2]]),
        _of("Complex.of_edges", gt.Complex.of_edges, pairs=[[0, 1]], nodes=2, images=[[0]],
            labels="ab"),
        _of("Complex.of_simplices", gt.Complex.of_simplices, simplices=[[0, 1, 2]], nodes=3),
        _of("Complex.grid", gt.Complex.grid, shape=(2, 2), periodic=(True, False)),
        _of("Complex.with_faces", gt.Complex.of_edges([[0, 1], [1, 2], [2, 0]]).with_faces,
            cycles=[[0, 1, 2]]),
        _of("Complex.boundary", gt.Complex.grid((2, 2)).boundary, degree=1),
        _of("Network.edge", NETWORK.edge, start=0, end=1),
        _of("Network.burgers", NETWORK.burgers, cycle=[0, 1, 2]),
        _of("Network.cycles", NETWORK.cycles, basis="fundamental"),
        _of("Network.loop", NETWORK.loop, cycle=[0, 1, 2]),
        _of("Network.node_rule", NETWORK.node_rule, cells=None),
        _of("DislocationNetwork.of_lines", gt.DislocationNetwork.of_lines,
            lines=[("a", "b", (1, 0, 0)), ("b", "a", (1, 0, 0))], surface=[],
            positions={"a": (0, 0, 0), "b": (1, 0, 0)}),
        _of("DislocationNetwork.excess", LINES.excess, node="a"),
        _of("DislocationNetwork.split", LINES.split, line=next(iter(LINES.graph.edges)),
            parts=[(2, 0, 0), (-1, 0, 0)]),
        _of("DislocationNetwork.of_arrays", gt.DislocationNetwork.of_arrays, lines=RING,
            tolerance=1e-9),
        _of("DislocationNetwork.of_opendis", gt.DislocationNetwork.of_opendis,
            data=PLACED.opendis()),
        _of("DislocationNetwork.read", gt.DislocationNetwork.read, path=TRIANGLE_FILE,
            periodic=True),
        _of("Table", gt.Table, places=[0, 1], values=[1, 3]),
        _of("Table.of", gt.Table.of, rows=[(0, 1), (1, 3)]),
        _of("DislocationSeries", gt.DislocationSeries, times=[0, 1], networks=[PLACED, PLACED]),
        _of("DislocationSeries.read", gt.DislocationSeries.read, source=TRIANGLE_FILE,
            periodic=True, times=[0]),
        _of("DislocationNetwork.burgers", PLACED.burgers, loop=gt.Loop.circle([1, 1, 1], 0.5),
            lattice=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        _of("DislocationNetwork.families", PLACED.families, symmetry="cubic"),
        _of("Box.of_bounds", gt.Box.of_bounds, low=(0, 0, 0), high=(1, 1, 1), periodic=True),
        _of("Box", gt.Box, vectors=[[1, 0, 0], [0, 1, 0], [0, 0, 1]], origin=(0, 0, 0),
            periodic=(True, True, False)),
        _of("LineArrays", gt.LineArrays, positions=[[0, 0, 0], [1, 0, 0]], pairs=[[0, 1]],
            burgers=[[1, 0, 0]], box=gt.Box.of_bounds([0, 0, 0], [4, 4, 4]), images=[[0, 0, 0]],
            labels="ab", constraints=[0, 7], planes=[[0, 0, 1]]),
        _of("ElasticConstants.isotropic", gt.ElasticConstants.isotropic, shear=1, poisson=0.3,
            unit="GPa"),
        _of("ElasticConstants.cubic", gt.ElasticConstants.cubic, c11=3, c12=1, c44=1, unit="GPa"),
        _of("ElasticConstants.hexagonal", gt.ElasticConstants.hexagonal, c11=3, c12=1, c13=1,
            c33=3, c44=1, unit="GPa"),
        _of("ElasticConstants.of_voigt", gt.ElasticConstants.of_voigt, values=np.eye(6),
            unit="GPa"),
        _of("ElasticConstants.of_text", gt.ElasticConstants.of_text, text="isotropic 1 0.3 GPa"),
        _of("ElasticConstants.rotated", STEEL.rotated, rotation=np.eye(3)),
        _of("NyeField.padded", OPEN_FIELD.padded, nodes=2),
        _of("NyeField.of_frame", gt.NyeField.of_frame, frame=BLOCK),
        _of("Stresses.at", gt.stresses(PLACED, STEEL, shape=8).at, points=[[0, 0, 0]]),
        _of("Circuit.rectangle", gt.Circuit.rectangle, corner=(1, 1), rows=2, columns=2),
        _of("Circuit.of_cells", gt.Circuit.of_cells, cells=[[1, 1]], corner=(0, 0)),
        _of("Circuit.through", gt.Circuit.through, pixels=[(0, 0), (0, 2), (2, 2), (2, 0)]),
        _of("OrientationMap.from_euler", gt.OrientationMap.from_euler,
            angles=np.zeros((6, 6, 3)), steps=1.0, phase="m-3m", threshold=5, sigma=0.1),
        _of("OrientationMap.burgers", CRYSTALS.burgers, circuit=gt.Circuit.square((1, 1), 3)),
        _of("OrientationMap.circuit", CRYSTALS.circuit, loop=gt.Loop.circle([3, 3], 2)),
        _of("OrientationMap.burgers_map", CRYSTALS.burgers_map, size=3),
        _of("Phase.family", IRON.family, vector=(1, 0, 0)),
        _of("SampledFrame.from_distortion", gt.SampledFrame.from_distortion,
            axes=[np.arange(9.0), np.arange(9.0)], distortion=np.zeros((2, 2, 9, 9)), order=4,
            names=("x", "y")),
        _of("SampledFrame.from_frame", gt.SampledFrame.from_frame, frame=PLANE,
            axes=[np.arange(9.0), np.arange(9.0)], order=4, parameters={}),
        _of("LatticeImage.phases", gt.LatticeImage(PICTURE).phases,
            spots=[[1 / 6, 0], [0, 1 / 6]], resolution=6),
        _of("LatticePhases.burgers", PHASES.burgers, loop=gt.Loop.circle([32, 32], 12), risk=0.1),
        _of("LatticePhases.sampled", PHASES.sampled, order=4, lengths=True),
        _of("SampledFrame.plaquettes", GRID.plaquettes, plane=(0, 1)),
        _of("SampledFrame.burgers_map", GRID.burgers_map, size=2, plane=(0, 1)),
        _of("SampledFrame.loop_around", HOLED.loop_around, hole=0, margin=1, plane=(0, 1),
            at=[4, 4]),
        _of("SampledFrame.gnd_density", GRID.gnd_density, burgers=0.25),
        _of("SampledFrame.from_displacement", gt.SampledFrame.from_displacement,
            axes=[np.arange(9.0), np.arange(9.0)], displacement=np.zeros((2, 9, 9)), order=4,
            names=("x", "y"), branch=0.25, sigma=0.1),
        _of("SampledFrame.from_strain_rotation", gt.SampledFrame.from_strain_rotation,
            axes=[np.arange(9.0), np.arange(9.0)], strain=np.zeros((2, 2, 9, 9)),
            rotation=np.zeros((9, 9)), order=4, names=("x", "y")),
        _of("SampledFrame.burgers", GRID.burgers, loop=gt.Loop.circle([4, 4], 1)),
        _of("ScatteredFrame.from_coframe", gt.ScatteredFrame.from_coframe, points=_POINTS,
            coframe=np.ones((1, 2, 60)), order=4, sigma=0.1, mask=np.zeros(60, bool), longest=2.0,
            boundary=[[-1, -1], [1, -1], [1, 1], [-1, 1]], unit="um", vector_unit="um",
            source="text"),
        _of("ScatteredFrame.from_distortion", gt.ScatteredFrame.from_distortion, points=_POINTS,
            distortion=np.zeros((2, 2, 60)), covariance=np.eye(4)),
        _of("ScatteredFrame.from_strain_rotation", gt.ScatteredFrame.from_strain_rotation,
            points=_POINTS, strain=np.zeros((2, 2, 60)), rotation=np.zeros(60)),
        _of("ScatteredFrame.from_displacement", gt.ScatteredFrame.from_displacement,
            points=_POINTS, displacement=np.zeros((2, 60)), branch=0.25, sigma=0.1),
        _of("ScatteredFrame.burgers", SCATTERED.burgers, circuit=gt.Loop.circle([0, 0], 0.6)),
        _of("ScatteredFrame.burgers_map", SCATTERED.burgers_map, rings=1),
        _of("ScatteredFrame.loop_around", SCATTERED.loop_around, hole=0, margin=1),
        _of("Solution.at", SOLVED.at, time=0.25),
        _of("Solution[]", lambda name: SOLVED[name], name="x"),
        _of("Solution.event_times", SOLVED.event_times, term="x - 1/2", direction=0),
        _of("Solution.in_chart", SOLVED.in_chart, name="bent"),
        _of(
            "CurveProblem.with_start", CURVE.with_start, start=[0, 0], velocity=[1, 0],
            frame_velocity=None,
        ),
        _of("CurveProblem.with_charts", lambda name: CURVE.with_charts(*[name]), name="bent"),
        _of("ODE.with_start", ODE.with_start, start=[1, 0], parameters={"k": 2}, events=None),
        _of("Solution of an ODE.at", RUN.at, time=0.25),
        _of("Solution of an ODE.event_times", RUN.event_times, term="x - 1/2", direction=0),
        _of("Solution of an ODE[]", lambda name: RUN[name], name="x"),
        _of(
            "solve_many of an ODE", gt.solve_many, problem=ODE, starts=[[1, 0], [2, 0]], t=0.5,
            accuracy=1e-6, engine=QUICK, check=1,
        ),
        _of("FreeTop.omega", gt.rigid.free_top((1, 2, 3), (1, 2, 3)).omega, times=[0, 1]),
        _of("SceneResult.at", RESULT.at, time=0.25),
        _of("Scene.with_values", SCENE.with_values, changes={"start.omega[0]": 2.0}),
        _of("Scene.sweep", SCENE.sweep, varied={"start.omega[0]": [1.0, 2.0]},
            measure=["max omega[0]"]),
        _of(
            "Chart.of", gt.Chart.of, frame=PLANE, name="bent", edge=X, margin=0.0,
            keeps_frame=True,
        ),
        _of(
            "TransitionMap", gt.curves.TransitionMap, source="a", target="b", coordinates=(X, Y),
            expressions=(X, Y), parameters=(), angles=(), sample={X: 1, Y: 1},
        ),
        _of(
            "Chart.redundant", gt.Chart.redundant, name="b", coordinates=[X, Y],
            legs=[[1, 0], [0, 1]], kept=None, parameters=[],
        ),
    ]  # fmt: skip


def _contracted(letters: Any) -> Any:
    """A contraction of two tensors."""
    return gt.contract(letters, PLANE.metric, VECTOR)


def _switched(time: Any, changes: Any) -> Any:
    """An equation whose parameters change at a time."""
    return gt.ODE.of({"x": "-k*x"}, [1], parameters={"k": 1}, events=[gt.At(time, changes)])


def _stopped(falls: Any, changes: Any) -> Any:
    """An equation that ends where an expression falls through zero."""
    return gt.ODE.of({"x": "-x"}, [1], events=[gt.When(falls, changes)])


def _metric_at(a: Any, b: Any) -> Any:
    """A compiled function of two coordinates."""
    return PLANE_METRIC(a, b)


def _cycle_with(position: Any) -> Any:
    """A loop through the nodes of a graph; one node has the given position."""
    graph = TRIANGLE.copy()
    graph.nodes[0]["position"] = position
    return gt.Loop.from_cycle(graph, [0, 1, 2])


def _selected(**given: Any) -> Any:
    """The states that a scene with this start integrates."""
    return scenes.Scene(BODY, [effects.Gravity(1)], scenes.State(**given)).selection


def _with_effect(make: Callable[..., Any]) -> Callable[..., Any]:
    """The selection of a scene with an effect, which passes the effect's parameters to sympy."""

    def call(**given: Any) -> Any:
        effect = make(**given)
        start = scenes.State(omega=(1, 2, 3), euler=(0.3, 0.4, 0.5))
        return scenes.Scene(BODY, [effect], start, t=0.1, accuracy=1e-3).selection

    return call


def scene_cases() -> list[Case]:
    """Bodies, starts, scenes and all effects."""
    vector = (0, 0, 1)
    given: dict[str, dict[str, Any]] = {
        "Gravity": {"g": 9.81},
        "Pivot": {"arm": vector, "place": vector, "moments_at": "centre"},
        "GravityGradient": {"rate": 1, "phase": 0},
        "Spring": {"stiffness": 1, "length": 0, "anchor": vector, "arm": vector},
        "LinearDrag": {"coefficient": 1, "arm": vector, "wind": vector},
        "QuadraticDrag": {"coefficient": 1, "arm": vector, "wind": vector, "smoothing": 0.1},
        "AngularDamping": {"coefficient": 1},
        "Thrust": {"force": ("t", 0, 1), "point": vector, "start": 0.1, "end": 0.2},
        "BodyMoment": {"moment": ("t", 0, 1), "start": 0.1, "end": 0.2},
        "Magnet": {"dipole": vector, "field": vector},
        "Rotor": {"axis": vector, "momentum": 1, "inertia": 1, "torque": 0},
        "Rolling": {"radius": 1, "shape": "disc"},
        "KnifeEdge": {"arm": vector, "speed": 0},
        "Torsion": {"strength": 1},
        "Custom": {
            "moment": ("k*Omega1", 0, 0), "force": (0, 0, "s"), "axes": "space",
            "parameters": {"k": 1}, "states": {"s": "-s"}, "start": {"s": 1}, "energy": "s",
            "power": "k", "outputs": {"twice": "2*s"}, "switches": [(0.05, {"k": 2})],
            "stop": "s - 1/10",
        },
        "Spin": {}, "Drift": {}, "Naive": {},
    }  # fmt: skip
    made = [
        _of(f"effects.{name}", _with_effect(getattr(effects, name)), **values)
        for name, values in given.items()
    ]
    return [
        *made,
        _of("Body", scenes.Body, mass=1.0, moments=(1, 2, 3), inertia=None),
        _of("Body with inertia", scenes.Body, mass=1.0, inertia=[[1, 0, 0], [0, 2, 0], [0, 0, 2]]),
        _of("Body.box", scenes.Body.box, mass=1, sides=(1, 2, 3)),
        _of("Body.ellipsoid", scenes.Body.ellipsoid, mass=1, semiaxes=(1, 2, 3)),
        _of("Body.cylinder", scenes.Body.cylinder, mass=1, radius=1, height=2),
        _of(
            "Body.points", scenes.Body.points,
            masses=[(1, (1, 0, 0)), (1, (0, 1, 0)), (1, (0, 0, 1))],
        ),
        _of(
            "State", _selected,
            omega=(1, 2, 3), euler=(0.1, 0.2, 0.3), position=(0, 0, 0), velocity=(0, 0, 0),
            euler_convention="zyz",
        ),
        _of("State with a quaternion", scenes.State, quaternion=(1, 0, 0, 0)),
        _of("State with a matrix", scenes.State, matrix=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        _of(
            "Scene", lambda **g: scenes.Scene(**g).selection, body=BODY,
            effects=[effects.AngularDamping(0.1)], start=scenes.State(omega=(1, 2, 3)),
            watch=["omega"], t=1.0, accuracy=1e-6, name="a", title="b", samples=11,
        ),
        _of("scenes.load", scenes.load, name="euler_top"),
        _of("scenes.to_toml", scenes.to_toml, scene=SCENE, story="a story"),
    ]  # fmt: skip


def other_cases() -> list[Case]:
    """Spaces and exercises."""
    known = {"quantity": "ricci", "components": {(0, 0): "1"}, "basis": "coordinate"}
    return [
        _of("spaces.load", spaces.load, name="kerr"),
        _of("read", gt.read, path=str(Path(__file__).parent / "data" / "nil.toml")),
        _of("spaces.KnownAnswer", spaces.KnownAnswer, **known),
        _of("exercises.load", exercises.load, number="3.2", seed=1),
        _of("exercises.check", exercises.check, number="3.2", answers=ANSWERS, seed=1),
        _of("Exercise.check", EXERCISE.check, answers=ANSWERS),
        _of("exports.tasks", tasks, numbers=["3.1"], seeds=[1]),
    ]


# Results: the package makes them itself from checked input. They enter from outside only through
# files, and the readers of files are tested.
RESULTS = frozenset(
    "BurgersMap BurgersVector Development EnclosedDefect EndMap Ensemble Shadow "
    "EquationsOfMotion ExactBurgersVector Fit IdentityCheck LogMap NodeRule SavedSolution "
    "SceneCost SceneResult Solution StateSelection Variation Atlas Chart CurveProblem "
    "DislocationNetwork Engine LatticeBurgers LatticePhases Certainty Proof Linearization "
    "ClosedOrbit Crossing "
    "KerrOrbit Frequencies Surface Symmetries Diffusion Integrability ParallelVolume Stresses "
    "HolonomyAlgebra Region EffectBudget PriceList PriceRow "
    "CoordinateMap Equivalence MappedPoint".split()
)

"""Quantities: by name, with the dependencies of each and the computation that a request starts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, ClassVar

from geomtorsion.errors import UnknownNameError
from geomtorsion.geometry import frame_matrices
from geomtorsion.geometry.components import effective, orbits
from geomtorsion.geometry.connections import cartan, levi_civita
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import close_names, shown
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.exclusive import exclusive

if TYPE_CHECKING:
    import networkx as nx


@dataclass(frozen=True)
class Quantity:
    """A node of the derivation graph.

    name, meaning: its name in requests, and its definition.
    needs: names of the quantities it is computed from.
    make: frame -> tensor, nothing computed yet.
    products: n -> upper bound of the number of products in one component.
    """

    name: str
    meaning: str
    needs: tuple[str, ...]
    make: Callable[[Frame], Tensor]
    products: Callable[[int], int]


def _table() -> tuple[Quantity, ...]:
    """All quantities, each after those it needs."""

    def torsion(part: str) -> Callable[[Frame], Tensor]:
        return lambda frame: getattr(cartan(frame).torsion, part)

    def bar(part: str) -> Callable[[Frame], Tensor]:
        return lambda frame: getattr(levi_civita(frame).curvature, part)

    q = Quantity
    return (
        q("coframe", "e^i_mu", (), lambda f: f.coframe, lambda n: 0),
        q("metric", "g_ab", ("coframe",), lambda f: f.metric, lambda n: n),
        q("inverse_metric", "g^ab", ("metric",), lambda f: f.inverse_metric, lambda n: n),
        q("legs", "E_i^mu", ("coframe",), lambda f: f.legs, lambda n: n),
        q("determinant", "det e", ("coframe",), lambda f: f.determinant, lambda n: n),
        q("anholonomy", "C_ij^k", ("coframe", "legs"), lambda f: f.anholonomy, lambda n: n * n),
        q(
            "cartan_connection",
            "Gamma_ab^c with parallel legs",
            ("coframe", "legs"),
            lambda f: cartan(f).coefficients,
            lambda n: n,
        ),
        q(
            "christoffel",
            "Gamma_bar_ab^c of the metric",
            ("metric", "inverse_metric"),
            lambda f: levi_civita(f).coefficients,
            lambda n: n,
        ),
        q("torsion_T", "T = 2S", ("cartan_connection",), torsion("T"), lambda n: 0),
        q("torsion", "S_ab^c", ("torsion_T",), torsion("S"), lambda n: 0),
        q("torsion_vector", "T_ab^b", ("torsion_T",), torsion("vector"), lambda n: 0),
        q("torsion_axial", "T_[abc]", ("torsion_T", "metric"), torsion("axial"), lambda n: n),
        q(
            "torsion_tensor",
            "T without vector and axial part",
            ("torsion_T", "torsion_vector", "torsion_axial", "metric"),
            torsion("tensor"),
            lambda n: n + 2,
        ),
        q("torsion_scalar", "T_scalar", ("anholonomy",), torsion("scalar"), lambda n: 3 * n**3),
        q(
            "torsion_force",
            "S_a^c_b + S_b^c_a",
            ("torsion", "metric", "inverse_metric"),
            torsion("force_coefficients"),
            lambda n: 2 * n,
        ),
        q(
            "contortion",
            "K_ab^c = Gamma - Gamma_bar",
            ("cartan_connection", "christoffel"),
            lambda f: cartan(f).contortion,
            lambda n: 0,
        ),
        q(
            "cartan_curvature",
            "curvature of the Cartan connection",
            ("cartan_connection", "coframe"),
            lambda f: cartan(f).curvature.riemann,
            lambda n: 2 * n,
        ),
        q(
            "spin_connection",
            "omega_ai^j of the metric",
            ("coframe", "legs", "christoffel"),
            lambda f: levi_civita(f).spin_connection,
            lambda n: 2 * n,
        ),
        q("riemann", "R_mnl^k", ("metric", "christoffel"), bar("riemann"), lambda n: 2 * n),
        q(
            "riemann_frame",
            "R_mnlk in the frame",
            ("riemann", "legs"),
            lambda f: levi_civita(f).curvature.lower.in_frame(),
            lambda n: n,
        ),
        q("ricci", "R_nl", ("riemann", "inverse_metric"), bar("ricci"), lambda n: n * n),
        q(
            "scalar_curvature",
            "g^nl R_nl",
            ("ricci", "inverse_metric"),
            bar("scalar"),
            lambda n: n * n,
        ),
        q(
            "einstein",
            "R_nl - g_nl R / 2",
            ("ricci", "scalar_curvature", "metric"),
            bar("einstein"),
            lambda n: 1,
        ),
        q(
            "weyl",
            "trace-free part of Riemann",
            ("riemann", "ricci", "scalar_curvature", "metric"),
            bar("weyl"),
            lambda n: 6,
        ),
        q(
            "schouten",
            "(R_ab - R g_ab / (2 (n - 1))) / (n - 2)",
            ("ricci", "scalar_curvature", "metric"),
            bar("schouten"),
            lambda n: 1,
        ),
        q(
            "cotton",
            "D_a P_bc - D_b P_ac of the Schouten tensor",
            ("schouten", "christoffel"),
            bar("cotton"),
            lambda n: 4 * n,
        ),
        q(
            "kretschmann",
            "R_mnlk R^mnlk",
            ("riemann", "inverse_metric"),
            bar("kretschmann"),
            lambda n: n**4,
        ),
    )


QUANTITIES = {quantity.name: quantity for quantity in _table()}


def known_quantity(name: str) -> Quantity:
    """The node of this name, or an error that lists near ones."""
    if isinstance(name, str) and name in QUANTITIES:
        return QUANTITIES[name]
    near = close_names(name, QUANTITIES, most=3, cutoff=0.5) if isinstance(name, str) else []
    hint = f"Did you mean {' or '.join(near)}?" if near else f"Known are {', '.join(QUANTITIES)}."
    raise UnknownNameError(f"there is no quantity called {shown(name)}. {hint}")


# For a dense coframe these come from the anholonomy, in the frame.
_IN_FRAME = {
    "contortion": ("anholonomy", "coframe", "legs"),
    "riemann_frame": ("anholonomy", "legs"),
    "riemann": ("riemann_frame", "coframe"),
    "ricci": ("riemann_frame", "coframe"),
    "scalar_curvature": ("anholonomy", "legs"),
    "kretschmann": ("riemann_frame",),
}


def needs(frame: Frame, name: str) -> tuple[str, ...]:
    """Direct dependencies of a quantity of this frame."""
    if "metric" in frame.given:
        if name == "metric":
            return ()
        if name == "coframe":
            return ("metric",)
        if name in ("legs", "cartan_connection"):
            return ("metric", "inverse_metric", *(["coframe"] if name == "legs" else []))
        if name == "cartan_curvature":
            return ("cartan_connection",)
    if name == "legs" and "legs" in frame.given:
        return ()
    if name == "coframe" and "legs" in frame.given:
        return ("legs",)
    if name in _IN_FRAME and frame_matrices.is_dense(frame):
        return _IN_FRAME[name]
    if name == "legs" and frame_matrices.goes_through_metric(frame):
        return ("coframe", "inverse_metric")
    if name == "inverse_metric" and not frame_matrices.inverts_metric(frame):
        return ("legs",)
    return QUANTITIES[name].needs


@dataclass(frozen=True)
class Step:
    """One step of a plan.

    name, meaning: the quantity.
    components: how many independent components it has.
    products: an upper bound of the products to be formed, zeros not yet skipped.
    """

    name: str
    meaning: str
    components: int
    products: int


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class DependencyGraph:
    """Computation of one quantity: its ancestors in the derivation graph, and no others.

    frame: the frame that computes it.
    name: the requested quantity.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> theta, phi = sp.symbols("theta phi")
    >>> plan = Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]]).plan("ricci")
    >>> [step.name for step in plan.steps]
    ['coframe', 'metric', 'inverse_metric', 'christoffel', 'riemann', 'ricci']
    >>> "torsion" in plan.left_out
    True
    """

    frame: Frame
    name: str

    def __post_init__(self) -> None:
        """Refuse a name that is not a quantity."""
        known_quantity(self.name)

    @cached_property
    def graph(self) -> nx.DiGraph[str]:
        """Ancestors of the quantity, edges from each quantity to those that need it."""
        # networkx is slow to load, and few who import geomtorsion need it.
        import networkx as nx

        graph = nx.DiGraph()
        waiting = [self.name]
        graph.add_node(self.name)
        while waiting:
            name = waiting.pop()
            for needed in needs(self.frame, name):
                if needed not in graph:
                    waiting.append(needed)
                graph.add_edge(needed, name)
        return graph

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The computation in order, each step after those it needs."""
        # See graph.
        import networkx as nx

        places = {name: place for place, name in enumerate(QUANTITIES)}
        ordered = nx.lexicographical_topological_sort(self.graph, key=places.__getitem__)
        return tuple(self._step(name) for name in ordered)

    def _step(self, name: str) -> Step:
        """A step with its cost."""
        node, n = QUANTITIES[name], self.frame.dimension
        tensor = node.make(self.frame)
        symmetry = effective(tensor.symmetry, tensor.slots)
        count = len(orbits(len(tensor.slots), n, symmetry).representatives)
        return Step(name, node.meaning, count, count * node.products(n))

    @property
    def left_out(self) -> tuple[str, ...]:
        """Names of the quantities that are not computed."""
        return tuple(name for name in QUANTITIES if name not in self.graph)

    def run(self) -> dict[str, float]:
        """Compute every step in order; seconds spent on each."""
        spent = {}
        for step in self.steps:
            start = perf_counter()
            _ = QUANTITIES[step.name].make(self.frame).components.independent
            spent[step.name] = perf_counter() - start
        return spent

    def to_dot(self) -> str:
        """The graph in the DOT language, for drawing."""
        lines = [f'digraph "{self.name}" {{', "  rankdir=LR;", "  node [shape=box];"]
        lines += [f'  {s.name} [label="{s.name}\\n{s.meaning}"];' for s in self.steps]
        lines += [f"  {first} -> {second};" for first, second in self.graph.edges]
        return "\n".join([*lines, "}"])

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.frame, self.name)

    def __repr__(self) -> str:
        return str(self)

    _repr_html_ = drawn_by("notebook_pictures", "plan_html")
    plot: ClassVar[Plot] = figure_by("notebook_pictures", "draw_plan")

    def __str__(self) -> str:
        heading = f"{'step':<20}{'components':>11}{'products at most':>18}  what it is"
        lines = [
            f"{step.name:<20}{step.components:>11}{step.products:>18}  {step.meaning}"
            for step in self.steps
        ]
        return "\n".join([heading, *lines, f"omitted: {', '.join(self.left_out)}"])

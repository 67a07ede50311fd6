"""plan: a named quantity of a frame, and the steps that a request for it starts."""

from __future__ import annotations

from dataclasses import dataclass
from operator import attrgetter
from time import perf_counter
from typing import TYPE_CHECKING, ClassVar

from geomtorsion.errors import UnknownNameError
from geomtorsion.geometry import frame_matrices
from geomtorsion.geometry.components import effective, orbits
from geomtorsion.geometry.connections import cartan, levi_civita
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.quantities import FRAME_QUANTITIES, Entry, entry
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.exclusive import exclusive

if TYPE_CHECKING:
    import networkx as nx

    from geomtorsion.geometry.connection import Connection


def frame_quantity(frame: Frame, name: str) -> Tensor:
    """The quantity of this name of a frame; nothing is computed yet.

    Raises
    ------
    UnknownNameError
        No quantity has this name, or a frame does not determine it.
    """
    row = _of_frame(name)
    owners = {"frame": lambda x: x, "cartan": cartan, "levi_civita": levi_civita}
    return property_of(owners[row.of](frame), row)


def property_of(owner: Frame | Connection, row: Entry) -> Tensor:
    """The tensor that a row names; owner: the frame or the connection that has it."""
    tensor: Tensor = attrgetter(row.attribute)(owner)
    return tensor.in_frame() if row.in_frame else tensor


def _of_frame(name: str) -> Entry:
    """The row of a quantity that a frame determines."""
    row = entry(name)
    if row.of == "connection":
        raise UnknownNameError(
            f"{name}: expected a quantity of a frame, got one of a connection. Use connection."
            f"{row.attribute}, or space.quantity({name!r}) of a space with its own connection."
        )
    return row


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
    row = FRAME_QUANTITIES[name]
    if row.needs_if_dense and frame_matrices.is_dense(frame):
        return row.needs_if_dense
    if name == "legs" and frame_matrices.goes_through_metric(frame):
        return ("coframe", "inverse_metric")
    if name == "inverse_metric" and not frame_matrices.inverts_metric(frame):
        return ("legs",)
    return row.needs


@dataclass(frozen=True)
class Step:
    """One step of a plan.

    name, meaning: the quantity and its usual name.
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
        _of_frame(self.name)

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
        """Steps in order; each follows the steps that it needs."""
        # See graph.
        import networkx as nx

        places = {name: place for place, name in enumerate(FRAME_QUANTITIES)}
        ordered = nx.lexicographical_topological_sort(self.graph, key=places.__getitem__)
        return tuple(self._step(name) for name in ordered)

    def _step(self, name: str) -> Step:
        """A step with its cost."""
        node, n = FRAME_QUANTITIES[name], self.frame.dimension
        tensor = frame_quantity(self.frame, name)
        symmetry = effective(tensor.symmetry, tensor.slots)
        count = len(orbits(len(tensor.slots), n, symmetry).representatives)
        return Step(name, node.title, count, count * node.products(n))

    @property
    def left_out(self) -> tuple[str, ...]:
        """Names of the quantities that are not computed."""
        return tuple(name for name in FRAME_QUANTITIES if name not in self.graph)

    def run(self) -> dict[str, float]:
        """Compute every step in order, and return the seconds spent on each."""
        spent = {}
        for step in self.steps:
            start = perf_counter()
            _ = frame_quantity(self.frame, step.name).components.independent
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

"""Plan: a quantity is computed from its ancestors and nothing else."""

import networkx as nx
import pytest
import sympy as sp

from geomtorsion.errors import ShapeError
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.geometry.quantities import FRAME_QUANTITIES

t, r, theta, phi = sp.symbols("t r theta phi", positive=True)
M = sp.Symbol("M", positive=True)


def schwarzschild() -> Frame:
    h = sp.sqrt(1 - 2 * M / r)
    coframe = sp.diag(h, 1 / h, r, r * sp.sin(theta))
    return Frame([t, r, theta, phi], coframe, signature=(-1, 1, 1, 1))


def kinds() -> dict[str, Frame]:
    """A new frame of each kind of construction."""
    c, s = sp.cos(theta), sp.sin(theta)
    return {
        "coframe": schwarzschild(),
        "metric": Frame.from_metric([r, theta], [[1, 0], [0, r**2]]),
        "legs": Frame.from_frame([r, theta], [[1, r], [0, 1 / r]]),
        "turned": Frame([r, theta], [[c, -r * s], [s, r * c]]),
    }


@pytest.mark.parametrize("kind", kinds())
@pytest.mark.parametrize("name", FRAME_QUANTITIES)
def test_nothing_else_is_computed(kind: str, name: str) -> None:
    """After the computation of a quantity, no quantity outside its plan has a component."""
    frame = kinds()[kind]
    planned = {step.name for step in frame.plan(name).steps}
    given = {"coframe", *frame.given}
    frame = kinds()[kind]
    if name in ("schouten", "cotton") and frame.dimension < 3:
        with pytest.raises(ShapeError, match="three dimensions"):
            _ = frame.quantity(name).components.nonzero
        return
    _ = frame.quantity(name).components.nonzero
    # Matrices that decide on the cheaper route are examined for each frame.
    planned |= given | {"metric"}
    for other in FRAME_QUANTITIES:
        if other not in planned:
            tensor: Tensor = frame.quantity(other)
            assert tensor.components.computed == 0, f"{other} was computed for {name}"


@pytest.mark.parametrize("name", FRAME_QUANTITIES)
def test_every_quantity_can_be_computed(name: str) -> None:
    """Each name gives a tensor over the frame."""
    frame = schwarzschild()
    tensor = frame.quantity(name)
    assert tensor.frame is frame
    assert tensor.is_zero in (True, False)


def test_graph() -> None:
    """The graph has edges along the needs, no cycles, and the quantity last."""
    plan = schwarzschild().plan("einstein")
    assert nx.is_directed_acyclic_graph(plan.graph)
    assert set(plan.graph) == {step.name for step in plan.steps}
    assert plan.steps[-1].name == "einstein"
    assert ("ricci", "einstein") in plan.graph.edges
    assert "torsion" in plan.left_out
    assert not set(plan.left_out) & set(plan.graph)
    assert set(plan.left_out) | set(plan.graph) == set(FRAME_QUANTITIES)
    everything = nx.DiGraph(
        (need, name) for name, q in FRAME_QUANTITIES.items() for need in q.needs
    )
    assert nx.is_directed_acyclic_graph(everything)


def test_cost_counts_independent_components() -> None:
    """Symmetric pairs count once: 40 Christoffel symbols and 10 Ricci components."""
    steps = {step.name: step for step in schwarzschild().plan("kretschmann").steps}
    assert steps["christoffel"].components == 40
    assert schwarzschild().plan("ricci").steps[-1].components == 10
    assert all(step.products >= 0 for step in steps.values())


def test_writing() -> None:
    """A plan gives a table as text, DOT for drawing, and seconds when run."""
    plan = schwarzschild().plan("torsion")
    lines = str(plan).splitlines()
    assert lines[0].split()[:2] == ["step", "components"]
    assert lines[-1].startswith("omitted: ")
    assert len(lines) == len(plan.steps) + 2
    assert "  torsion_T -> torsion;" in plan.to_dot()
    spent = plan.run()
    assert list(spent) == [step.name for step in plan.steps]
    assert all(seconds >= 0 for seconds in spent.values())

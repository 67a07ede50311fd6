"""Graphs for tests: expressions of many kinds, and geodesics of shipped spaces."""

# Bad input, lists as arrays and results that may be None: the types are stricter.
# pyright: reportArgumentType=false, reportOperatorIssue=false

import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.spaces import load

x, y, z, a, b = SYMBOLS = sp.symbols("x y z a b")
NAMES = [str(symbol) for symbol in SYMBOLS]
TABLE = dict(zip(NAMES, SYMBOLS, strict=True))
SPACES = ("so3", "kerr", "schwarzschild", "s2", "flat_spherical", "goedel")
# Operations that cost as much as a product of two series.
COSTLY = ("product", "square", "quotient", "root", "call")


def costly(made):
    """Number of steps that cost a product of two series."""
    steps = made.steps
    return sum(
        step.kind in COSTLY and not any(steps[p].constant for p in step.operands) for step in steps
    )


def products(field, rows):
    """Sums of products, from texts."""
    return [
        tuple((field.read(sp.sympify(entry, TABLE)), factors) for entry, factors in row)
        for row in rows
    ]


def read_back(made, field):
    """The outputs of a graph, evaluated again in a field."""
    values = []
    for step in made.steps:
        inner = [values[place] for place in step.operands]
        if step.kind == "argument":
            name = made.arguments[step.detail]
            values.append(next(field.read(s) for s in field.symbols if s.name == name))
        elif step.kind == "number":
            values.append(field.rational(step.detail.numerator, step.detail.denominator))
        elif step.kind == "sum":
            pairs = zip(step.signs, inner, strict=True)
            values.append(sum((sign * value for sign, value in pairs), field.zero))
        elif step.kind in ("product", "square"):
            values.append(inner[0] * inner[-1])
        elif step.kind == "quotient":
            values.append(inner[0] / inner[1])
        elif step.kind == "root":
            assert step.detail == 2
            values.append(inner[0].sqrt())
        else:
            function = getattr(sp, step.detail)
            values.append(field.read(function(*(value.sympy for value in inner))))
    return [sign * values[place] for sign, place in made.outputs]


def expanded(outputs, field):
    """Sums of products, multiplied out in a field."""
    found = []
    for output in outputs:
        total = field.zero
        for element, factors in output:
            moved = field.read(element.sympy)
            for name in factors:
                moved = moved * next(field.read(s) for s in field.symbols if s.name == name)
            total = total + moved
        found.append(total)
    return found


def geodesic_rates(name):
    """Arguments, parameters and rates (as sums of products) of geodesics in the frame of a space.

    q' = E u, u'_k = C_ki^j u_j u^i: Hamel's equations of the metric.
    """
    frame = load(name).frame
    n, eta, c = frame.dimension, frame.eta.components, frame.anholonomy.components
    u = [f"u{i}" for i in range(n)]
    rates = [tuple((v, (u[i],)) for i, v in row) for row in frame.legs.components.rows]
    for k in range(n):
        entries = [((i, j), c.get((k, i, j))) for i in range(n) for j in range(n)]
        rates.append(
            tuple(
                (value * eta.get((j, j)) * eta.get((k, k)), (u[j], u[i]))
                for (i, j), value in entries
                if value is not None
            )
        )
    states = [*map(str, frame.coordinates), *u]
    found = {s.name for row in rates for element, _ in row for s in element.symbols}
    return states, sorted(found - set(states)), rates


def geodesic_graph(name, **options):
    """The graph of these rates."""
    states, parameters, rates = geodesic_rates(name)
    return graph([*states, *parameters], rates, parameters, **options)

"""Change: the same frame, tensor or connection in other coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from geomtorsion.errors import CoframeError, CoordinateError, ShapeError, TensorIndexError
from geomtorsion.exact import Element, parse_expression
from geomtorsion.exact.reading import checked
from geomtorsion.geometry import constructors, validation
from geomtorsion.geometry.components import Index, change_slot, effective, inverse
from geomtorsion.geometry.connection import Connection
from geomtorsion.geometry.connections import levi_civita
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.expansion import again, whole_of
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support import checks


@dataclass(frozen=True)
class Map:
    """Old coordinates as functions of new ones.

    new: the new coordinates. old: the old ones. functions: old^mu of the new ones.
    """

    new: tuple[sp.Symbol, ...]
    old: tuple[sp.Symbol, ...]
    functions: tuple[sp.Expr, ...]

    def __call__(self, expression: sp.Basic) -> sp.Expr:
        """An expression of the old coordinates in the new ones."""
        moved = expression.subs(dict(zip(self.old, self.functions, strict=True)), simultaneous=True)
        return moved.doit()

    def slope(self, mu: int, a: int) -> sp.Expr:
        """d old^mu / d new^a."""
        return self.functions[mu].diff(self.new[a])

    def pulled(self, matrix: Sequence[Sequence[sp.Expr]]) -> list[list[sp.Expr]]:
        """Rows m_i_mu in the new coordinates: m_i_mu d old^mu / d new^a."""
        return [
            [
                sp.Add(*(self(x) * self.slope(mu, a) for mu, x in enumerate(row) if x != 0))
                for a in range(len(self.new))
            ]
            for row in matrix
        ]


def coordinate_map(frame: Frame, new: object, old: object, count: int | None = None) -> Map:
    """Checked map from a user's input.

    old: {old coordinate: expression or text}, or expressions in the order of the old coordinates.
    A coordinate without an expression is one of the new ones, or constant on a surface.
    count: the number of new coordinates; None for a surface.
    """
    by_name = {one.name: one for one in frame.coordinates}
    constants = {one.name: one for one in frame.field.symbols if one.name not in by_name}
    table: dict[Any, Any]
    if isinstance(old, Mapping):
        table = {str(key): value for key, value in old.items()}
    else:
        listed = checks.entries(old, "old coordinates", CoordinateError)
        each = f"coordinates {', '.join(by_name)}"
        checks.check_one_each(listed, frame.dimension, each, "old coordinates", ShapeError)
        table = dict(zip(by_name, listed, strict=True))
    kind = "names of coordinates"
    for name in table:
        checks.known_name(name, by_name, "old coordinates", CoordinateError, expected=kind)
    plain = [one for one in table.values() if isinstance(one, sp.Basic)]
    candidates = [*validation.free_symbols(plain), *frame.field.symbols]
    # A name that the expressions use is the symbol with its assumptions.
    order = {one.name: one for one in reversed(candidates)}
    symbols = tuple(validation.named_symbols(new, order.values()))
    if count is not None and len(symbols) != count:
        raise ShapeError(
            f"new coordinates: expected {count}, got {len(symbols)}. Give one for each old "
            "coordinate; for a surface with fewer use gt.surface."
        )
    names = {**constants, **{one.name: one for one in symbols}}
    if count is None:
        names = by_name | names
    functions = []
    for name, own in by_name.items():
        if name not in table and name not in names:
            raise CoordinateError(
                f"old coordinates: expected an expression for {name}, got none, and {name} is not "
                "among the new coordinates. Add it."
            )
        value = table.get(name, names.get(name))
        function = checks.expression(
            value,
            f"old coordinate {own}",
            CoordinateError,
            read=lambda text: parse_expression(text, names),
        )
        functions.append(checked(f"old coordinate {own}", function, tuple(names.values())))
    return Map(symbols, frame.coordinates, tuple(functions))


def moved_domain(frame: Frame, way: Map, domain: object) -> list[sp.Basic]:
    """Relations of the old coordinates in the new ones, and added relations."""
    relations = []
    for relation in frame.domain:
        moved = relation.subs(dict(zip(way.old, way.functions, strict=True)), simultaneous=True)
        if moved == sp.false:
            raise CoordinateError(
                f"the frame is declared where {relation}, which does not hold for "
                f"{dict(zip(way.old, way.functions, strict=True))}. Give a map into the domain."
            )
        if moved != sp.true:
            relations.append(moved)
    return [*relations, *validation.domain_relations(domain)]


@derived
def _frame_in(frame: Frame, way: Map, domain: tuple[sp.Basic, ...]) -> Frame:
    """The frame in new coordinates, made from its metric or its coframe."""
    whole = whole_of(frame)
    if whole is not frame:
        return again(_frame_in(whole, way, domain), frame)
    n = frame.dimension
    shape = "metric" if frame.shape == "metric" else "coframe"
    matrix = frame.metric if shape == "metric" else frame.coframe
    rows = [[matrix[i, j] for j in range(n)] for i in range(n)]
    if shape == "metric":
        half = way.pulled(rows)
        rows = [[half[mu][a] for mu in range(n)] for a in range(n)]
        # The first index as well; the entries of the half are in the new coordinates already.
        rows = [
            [sp.Add(*(way.slope(mu, b) * rows[a][mu] for mu in range(n))) for b in range(n)]
            for a in range(n)
        ]
    else:
        rows = way.pulled(rows)
    options = constructors.keywords(frame, shape)
    roots = {way(root): way(value) for root, value in frame.field.chosen.items()}
    options |= {
        "domain": domain,
        "branches": {k: x for k, x in roots.items() if isinstance(k, sp.Pow | sp.Abs)},
    }
    return constructors.maker(type(frame), shape)(way.new, rows, **options)


@derived
def _slopes(frame: Frame, new: Frame, way: Map) -> tuple[dict, dict]:
    """d old^mu / d new^a at (mu, a) and its inverse at (a, mu), over the new frame."""
    n = frame.dimension
    places = [(mu, a) for mu in range(n) for a in range(n)]
    read = new.read([("slope of the map", way.slope(mu, a)) for mu, a in places])
    slopes = {place: x for place, x in zip(places, read, strict=True) if not x.is_zero}
    return slopes, inverse(new.field, slopes, n)


def _changed(frame: Frame, new: object, old: object, domain: object) -> tuple[Frame, Map]:
    """The frame in new coordinates and the map that leads there."""
    way = coordinate_map(frame, new, old, frame.dimension)
    return _frame_in(frame, way, tuple(moved_domain(frame, way, domain))), way


def frame_in(frame: Frame, new: object, old: object, domain: object) -> Frame:
    """See Frame.in_coordinates."""
    return _changed(frame, new, old, domain)[0]


def tensor_in(tensor: Tensor, new: object, old: object, domain: object) -> Tensor:
    """See Tensor.in_coordinates."""
    return _tensor_in(tensor, *_changed(tensor.frame, new, old, domain))


def connection_in(connection: Connection, new: object, old: object, domain: object) -> Connection:
    """See Connection.in_coordinates."""
    frame = connection.frame
    over, way = _changed(frame, new, old, domain)
    if connection.kind == "levi-civita":
        return levi_civita(over)
    # A metric chooses its legs again; legs that were given stay the same legs.
    if connection.maker is not None and frame.shape != "metric":
        return connection.maker(over)
    if connection.allowed is not None:
        raise CoframeError(
            "expected legs given as one-forms or vectors, got legs derived from a metric, which "
            "differ in other coordinates. Make the frame from its coframe: "
            "gt.Frame(frame.coordinates, frame.coframe.to_sympy())."
        )
    difference = (connection.coefficients - levi_civita(frame).coefficients).components
    extra = _tensor_in(Tensor(frame, "ddu", difference), over, way)
    total = levi_civita(over).coefficients + extra
    coefficients = replace(total, symbol="\\Gamma", name="connection")
    kind = "general" if connection.kind == "general" else "metric"
    return Connection(over, coefficients, connection.name, kind)


def _tensor_in(tensor: Tensor, over: Frame, way: Map) -> Tensor:
    """A tensor over the frame in new coordinates, with the slots of the given one."""
    if tensor.anchored:
        raise TensorIndexError(
            f"{tensor.label}: expected a tensor in all its indices, got connection coefficients. "
            "Change the connection itself: connection.in_coordinates(new, old)."
        )
    frame, n = tensor.frame, over.dimension
    # A metric chooses its legs again, so that frame indices go through coordinates.
    plain = tensor.in_coordinates()

    def moved(index: Index, value: Element) -> Element:
        (element,) = over.read([(f"{tensor.symbol}{list(index)}", way(value.sympy))])
        return element

    components = plain.components.mapped(over.field, moved)
    forward, back = _slopes(frame, over, way)
    symmetry = effective(plain.symmetry, plain.slots)
    for k, slot in enumerate(plain.slots):
        # Rows are new indices: (new, old).
        matrix = {(a, mu): x for (mu, a), x in forward.items()} if slot == "d" else back
        rows: list[list[tuple[int, Element]]] = [[] for _ in range(n)]
        columns: list[list[tuple[int, Element]]] = [[] for _ in range(n)]
        for (a, mu), x in matrix.items():
            rows[a].append((mu, x))
            columns[mu].append((a, x))
        last = k == len(plain.slots) - 1
        own = symmetry if last else ()
        components = change_slot(
            over.field, components, k, [*map(tuple, rows)], [*map(tuple, columns)], own
        )
    transformed = Tensor(over, plain.slots, components, plain.symmetry, tensor.symbol, tensor.name)
    return transformed._form(tensor.slots)

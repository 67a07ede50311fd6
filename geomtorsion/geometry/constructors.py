"""Constructors: frames from legs, from a metric, from structure constants."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any, cast

import sympy as sp

from geomtorsion.errors import CoordinateError
from geomtorsion.exact import TruncatedField
from geomtorsion.geometry import naming, validation
from geomtorsion.geometry.components import inverse
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.groups import invariant_coframe
from geomtorsion.geometry.orthonormalize import orthonormal_rows, requested_signs
from geomtorsion.geometry.substitution import INFINITE, Substitution
from geomtorsion.support import arguments

if TYPE_CHECKING:
    from geomtorsion.exact.generators import Names
    from geomtorsion.geometry.frame import Frame


def from_frame(
    cls: type[Frame],
    coordinates: validation.Coordinates,
    legs: object,
    signature: object = None,
    parameters: Sequence[sp.Symbol] | None = None,
    domain: object = None,
    complex: bool = False,
    name: str | None = None,
    branches: Mapping[sp.Expr, sp.Expr] | None = None,
) -> Frame:
    """See Frame.from_frame."""
    n, entries = validation.typed_entries(legs, "legs", coordinates, parameters)
    signs = validation.signature_entries(signature, n)
    opened = validation.opened(
        coordinates, n, entries, parameters, domain, complex, branches, "legs", signs
    )
    elements = validation.read_matrix(opened.field, entries, "legs")
    eta = validation.read_signature(opened.field, signs, n)
    validation.check_regular(opened.field, elements, n, "matrix of legs")
    coframe = inverse(opened.field, elements, n)
    frame = object.__new__(cls)
    matrices = {"coframe": coframe, "legs": elements, "eta": eta}
    frame.fill(opened, name, matrices, ("legs", entries))
    return frame


def from_metric(
    cls: type[Frame],
    coordinates: validation.Coordinates,
    metric: object,
    signature: object = None,
    parameters: Sequence[sp.Symbol] | None = None,
    domain: object = None,
    name: str | None = None,
    branches: Mapping[sp.Expr, sp.Expr] | None = None,
) -> Frame:
    """See Frame.from_metric."""
    n, entries = validation.typed_entries(metric, "metric", coordinates, parameters)
    signs = None
    if signature is not None:
        signs = requested_signs(validation.signs_or_rows(signature), n)
    opened = validation.opened(
        coordinates, n, entries, parameters, domain, False, branches, "metric", signs
    )
    elements = validation.read_matrix(opened.field, entries, "metric")
    validation.check_symmetric(elements, n)
    sample = opened.field.sample
    points = chain([sample.values], sample.places.points())
    rows, squares, eta = orthonormal_rows(opened.field, elements, n, points, signs)
    frame = object.__new__(cls)
    matrices = {"metric": elements, "rows": rows, "squares": squares, "eta": eta}
    frame.fill(opened, name, matrices, ("metric", entries))
    return frame


def maker(cls: type[Frame], shape: str) -> Callable[..., Frame]:
    """Function that makes a frame from coordinates and a coframe, legs or a metric."""
    return {"coframe": cls, "legs": cls.from_frame, "metric": cls.from_metric}[shape]


def keywords(frame: Frame, shape: str) -> dict[str, Any]:
    """The other arguments with which its maker gives this frame again."""
    n = frame.dimension
    eta = [[frame.eta[i, j] for j in range(n)] for i in range(n)]
    arguments: dict[str, Any] = {
        # A metric takes a list of signs, one for each row.
        "signature": [eta[i][i] for i in range(n)] if shape == "metric" else eta,
        "parameters": frame.parameters,
        "domain": frame.domain,
        "name": frame.name,
        "branches": frame.field.chosen,
    }
    return arguments if shape == "metric" else arguments | {"complex": frame.complex}


def conformal(frame: Frame, factor: object) -> Frame:
    """See Frame.conformal."""
    scale = frame.scalar(cast("Any", factor), name="factor")[()]
    rows = [[scale * entry for entry in row] for row in frame.coframe.tolist()]
    return type(frame)(frame.coordinates, rows, **keywords(frame, "coframe"))


@derived
def substituted(frame: Frame, put: Substitution) -> Frame:
    """The frame with other values, made as it was made (see Frame.subs)."""
    if isinstance(frame.field, TruncatedField):
        # A series is expanded again, unless the small parameter has a value now.
        whole, symbol, order = cast("tuple[Frame, sp.Symbol, int]", frame._plain[1])
        replaced = substituted(whole, put)
        return replaced if symbol in put.symbols else replaced.expanded(symbol, order)
    shape, n = frame.shape, frame.dimension
    entries = [
        (f"{shape}[{i}, {j}]", frame.given[shape].get((i, j))) for i in range(n) for j in range(n)
    ]
    flat = [sp.S.Zero if x is None else put.value(x.sympy, where) for where, x in entries]
    roots = {put(root): put(value) for root, value in frame.field.chosen.items()}
    arguments = keywords(frame, shape) | {
        "parameters": [one for one in frame.parameters if one not in put.symbols],
        "domain": _substituted_domain(frame, put),
        # A root that the substitution removed has no branch.
        "branches": {k: value for k, value in roots.items() if isinstance(k, sp.Pow | sp.Abs)},
    }
    rows = [flat[n * i : n * (i + 1)] for i in range(n)]
    replaced = maker(type(frame), shape)(frame.coordinates, rows, **arguments)
    if not put.functions:
        # Charts of the whole frame hold for this one, with the same values.
        replaced.attached["substituted"] = (frame, dict(put.symbols))
    names = {symbol.name: put(quantity) for symbol, quantity in frame.names.items()}
    # A quantity that became a number needs no name.
    names = {x: q for x, q in names.items() if q.free_symbols and not q.has(*INFINITE)}
    return replaced.named(**names) if names else replaced


def _substituted_domain(frame: Frame, put: Substitution) -> list[sp.Basic]:
    """The conditions of a domain with other values, without those that always hold."""
    domain = {relation: put(relation) for relation in frame.domain}
    for relation, replaced in domain.items():
        if replaced == sp.false:
            raise CoordinateError(
                f"{put}: expected values inside the domain of the frame, got values that violate "
                f"{relation}. Give other values."
            )
    return [replaced for replaced in domain.values() if replaced != sp.true]


@derived
def named(frame: Frame, meanings: tuple[tuple[sp.Symbol, sp.Expr], ...]) -> Frame:
    """The frame in the same field, printed with names (see Frame.named)."""
    opened = validation.Opened(
        frame.coordinates, frame.parameters, frame.domain, frame.complex, frame.field
    )
    named_frame = object.__new__(type(frame))
    named_frame.fill(opened, frame.name, frame.given, frame._plain)
    named_frame.__setstate__({**frame.attached, "names": dict(meanings)})
    # This raises at once for bad names.
    named_frame.written(frame.field.zero)
    return named_frame


@derived
def names(frame: Frame) -> Names:
    """The names of a frame as they are written, with exact elements."""
    return naming.names(frame.field.exact, frame.names)


def from_structure_constants(
    cls: type[Frame],
    constants: object,
    coordinates: validation.Coordinates | None = None,
    signature: arguments.Signature | None = None,
    name: str | None = None,
) -> Frame:
    """See Frame.from_structure_constants."""
    symbols, coframe = invariant_coframe(constants, coordinates)
    return cls(symbols, coframe, signature=signature, name=name)

"""Geometries: kinds of connection that a theory assumes."""

from __future__ import annotations

from collections.abc import Sequence
from types import UnionType

from geomtorsion.errors import GravityError
from geomtorsion.geometry import Connection
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.support import checks

# Geometry that a theory assumes: the property that a connection must have, in words.
GEOMETRIES = {
    "any": "any connection",
    "metric-affine": "any connection",
    "teleparallel": "a flat metric connection, such as gt.cartan(frame)",
    "symmetric teleparallel": "a flat connection without torsion",
    "metric": "a metric connection",
    "riemannian": "the connection gt.levi_civita(frame)",
}


def check_geometry(theory: Lagrangian, connections: Sequence[Connection]) -> None:
    """Refuse a connection that is not of the theory."""
    checks.choice(theory.geometry, tuple(GEOMETRIES), "geometry", GravityError)
    others = [one for one in connections if one.kind != "levi-civita"]
    fits = {
        "any": True,
        "metric-affine": True,
        "teleparallel": others and all(one.is_flat and one.metric_compatible for one in others),
        "symmetric teleparallel": others
        and all(one.is_flat and one.is_torsion_free for one in others),
        "metric": all(one.metric_compatible for one in connections),
        "riemannian": not others,
    }
    if not fits[theory.geometry]:
        names = ", ".join(one.name for one in connections)
        raise GravityError(
            f"{theory.name}: expected {GEOMETRIES[theory.geometry]}, got {names}, which "
            f"{_fault(theory.geometry, connections)}. Give another connection, or write the "
            "Lagrangian as text, which takes any connection."
        )


def _fault(geometry: str, connections: Sequence[Connection]) -> str:
    """Mismatch between a connection and the assumption of its theory."""
    others = [one for one in connections if one.kind != "levi-civita"]
    if geometry == "riemannian":
        return "is not the Levi-Civita connection of the metric"
    if geometry != "metric" and not others:
        return "is not constructed as a flat connection"
    if geometry != "metric" and not all(one.is_flat for one in others):
        return "is not flat"
    if geometry == "symmetric teleparallel":
        return "has torsion"
    return "is not metric"


def listed(values: object, kind: type | UnionType, subject: str, expected: str) -> list:
    """One value of a kind, or a list of some."""
    if isinstance(values, kind):
        return [values]
    entries = list(checks.entries(values, subject, GravityError, expected=expected))
    for value in entries:
        if not isinstance(value, kind):
            checks.refuse(GravityError, subject, expected, value)
    return entries

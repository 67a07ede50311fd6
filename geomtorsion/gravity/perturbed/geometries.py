"""Geometries: small fields about flat space, and the frame and connection that they make."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import parse_expression
from geomtorsion.geometry import (
    Connection,
    Frame,
    cartan,
    from_coefficients,
    from_spin_connection,
    levi_civita,
)
from geomtorsion.gravity.theory.field_equations import FieldEquations
from geomtorsion.gravity.theory.geometries import listed
from geomtorsion.gravity.theory.invariants import INVARIANTS, Invariant
from geomtorsion.gravity.theory.lagrangian import Lagrangian, known_as
from geomtorsion.gravity.theory.lagrangian import names as gravity_names
from geomtorsion.gravity.theory.matter import MatterField, maxwell, scalar_field
from geomtorsion.gravity.theory.naming import shorthand
from geomtorsion.gravity.theory.vocabulary import BOUNDARY
from geomtorsion.support import checks

# Coordinates of flat space; a wave travels along z.
T, X, Y, Z = sp.symbols("t x y z")
ETA = (-1, 1, 1, 1)
SMALL = sp.Symbol("small_wave")


@dataclass(frozen=True)
class Component:
    """One component of a small tensor field.

    name: of the tensor. indices: from 0, the time, to 3. antisymmetric: whether the last two
    indices exchange with a sign, so that only the smaller first is listed.
    """

    name: str
    indices: tuple[int, ...]
    antisymmetric: bool = False

    def moved(self, slot: int, index: int) -> tuple[Component, int] | None:
        """The component with another index in a slot, and a sign; None where it vanishes."""
        indices = [*self.indices]
        indices[slot] = index
        sign = 1
        if self.antisymmetric:
            *_, i, j = indices
            if i == j:
                return None
            if i > j:
                indices[-2:], sign = [j, i], -1
        return Component(self.name, tuple(indices), self.antisymmetric), sign

    @property
    def function(self) -> sp.Expr:
        """The component as an unknown function of t and z."""
        return sp.Function("_".join([self.name, *map(str, self.indices)]))(T, Z)


def _tensor(name: str, rank: int) -> list[Component]:
    return [Component(name, indices) for indices in product(range(4), repeat=rank)]


def _value(components: Sequence[Component], name: str, *indices: int) -> sp.Expr:
    return SMALL * Component(name, indices).function


def _symmetric_teleparallel(frame: Frame) -> Connection:
    """The connection whose coefficients vanish in these coordinates (the coincident gauge)."""
    return from_coefficients(frame, [[[0] * 4] * 4] * 4)


def _poincare(frame: Frame) -> Connection:
    def omega(a: int, i: int, j: int) -> sp.Expr:
        if i == j:
            return sp.S.Zero
        sign = 1 if i < j else -1
        one = Component("w", (a, min(i, j), max(i, j)), antisymmetric=True)
        return ETA[j] * sign * SMALL * one.function

    return from_spin_connection(frame, _rows(omega))


def _metric_affine(frame: Frame) -> Connection:
    def omega(a: int, i: int, j: int) -> sp.Expr:
        return ETA[j] * SMALL * Component("w", (a, i, j)).function

    return from_spin_connection(frame, _rows(omega))


def _rows(rule: Callable[[int, int, int], sp.Expr]) -> list[list[list[sp.Expr]]]:
    n = range(4)
    return [[[rule(a, i, j) for j in n] for i in n] for a in n]


_TURNING = [
    Component("w", (a, i, j), antisymmetric=True)
    for a in range(4)
    for i in range(4)
    for j in range(i + 1, 4)
]


@dataclass(frozen=True)
class FlatGeometry:
    """A kind of geometry about flat space.

    connection: of a frame. fields: components of the connection that vary on their own.
    theory: geometry of a Lagrangian, see `gravity.Lagrangian`.
    """

    connection: Callable[[Frame], Connection]
    fields: tuple[Component, ...]
    theory: str

    def connections(self, frame: Frame, theory: Lagrangian) -> list[Connection]:
        """The connection, and the Levi-Civita one beside it where the theory has Rbar or others."""
        own = self.connection(frame)
        words = re.findall(r"[^\W\d]\w*", str(theory.expression))
        has_metric = any(x.endswith("bar") and x in gravity_names for x in words)
        return [own, levi_civita(frame)] if has_metric and own.kind != "levi-civita" else [own]


GEOMETRIES = {
    "riemannian": FlatGeometry(levi_civita, (), "riemannian"),
    "teleparallel": FlatGeometry(cartan, (), "teleparallel"),
    "symmetric teleparallel": FlatGeometry(_symmetric_teleparallel, (), "symmetric teleparallel"),
    "poincare": FlatGeometry(_poincare, tuple(_TURNING), "any"),
    "metric-affine": FlatGeometry(_metric_affine, tuple(_tensor("w", 3)), "metric-affine"),
}
# Geometry of a theory -> the one of its small fields.
OF_THEORY = {"metric": "poincare"}
# Invariants that vanish for the Levi-Civita connection.
WITH_TORSION = frozenset(("holst", "nieh_yan", "P2", "P3", "P5"))


def geometry_of(
    lagrangian: object,
    name: object,
    invariants: Invariant | Iterable[Invariant] = (),
    choices: Sequence[str] = tuple(GEOMETRIES),
    bare: str = "riemannian",
) -> str:
    """The name of the geometry: given, assumed by the theory, or read from the Lagrangian.

    bare: geometry of a Lagrangian without an invariant of torsion, curvature or nonmetricity.
    """
    if name is None:
        theory = known_as(lagrangian)
        meant = OF_THEORY.get(theory.geometry, theory.geometry)
        own = listed(invariants, Invariant, "invariants", "gravity.invariant(name, formula)")
        name = _meant(theory, own, bare) if meant == "any" else meant
    if isinstance(name, str):
        plain = {_plain(one): one for one in choices}
        name = plain.get(_plain(name), name)
    return checks.choice(name, tuple(choices), "geometry", GravityError)


def _plain(name: str) -> str:
    """A name in lower case with blanks between its words."""
    return name.lower().replace("-", " ").replace("_", " ").strip()


def _meant(theory: Lagrangian, invariants: Sequence[Invariant], bare: str) -> str:
    """The geometry with the fewest fields in which no invariant of a theory vanishes."""
    known = INVARIANTS | {one.name: one for one in (*theory.invariants, *invariants)}
    words = set(re.findall(r"[^\W\d]\w*+(?!\s*\()", str(theory.expression)))  # no functions
    terms = [term for name in words & known.keys() for term in known[name].products(4)]
    tensors = [one for term in terms for one in term.factors if not one.suffix]
    has = {one.name for one in tensors} | ({"T"} if BOUNDARY in words else set())
    # Its trace R_abc^c vanishes for metric connections.
    traced = any(one.name == "R" and one.indices[2] == one.indices[3] for one in tensors)
    if traced or ("Q" in has and has & {"R", "T"}):
        return "metric-affine"
    if words & WITH_TORSION or {"R", "T"} <= has:
        return "poincare"
    if has & {"Q", "T"}:
        return "teleparallel" if "T" in has else "symmetric teleparallel"
    return "riemannian" if "R" in has else bare


def titled(theory: Lagrangian, geometry: str = "") -> str:
    """The Lagrangian and its geometry, for the first line of a result."""
    own = f"{theory.name}, " if theory.name != Lagrangian.name else ""
    return f"{own}{theory.written} ({geometry or theory.geometry})"


def riemannian_only(lagrangian: object, geometry: object, caller: str) -> str:
    """The name of the geometry, which must be riemannian."""
    name = geometry_of(lagrangian, geometry)
    if name != "riemannian":
        raise GravityError(
            f"{caller}: expected the geometry riemannian, got {name}. Waves of a connection are "
            "listed by perturbed.spectrum."
        )
    return name


def theory_in(lagrangian: object, name: str) -> Lagrangian:
    """A theory; one given as text belongs to the geometry of that name."""
    theory = known_as(lagrangian)
    if isinstance(lagrangian, Lagrangian):
        return theory
    return replace(theory, geometry=GEOMETRIES[name].theory)


def check_couplings(equations: FieldEquations, taken: Iterable[sp.Basic]) -> None:
    """Refuse a coupling with the name of a coordinate or of a symbol in the result."""
    own = {*map(str, equations.frame.coordinates), *map(str, taken)}
    names = sorted({s.name for s in equations.expression.free_symbols} & own)
    if names:
        raise GravityError(
            f"lagrangian: expected couplings with names of their own, got {names[0]}, which is a "
            "coordinate or a symbol of the result here. Give the coupling another name."
        )


def replacements(
    couplings: Iterable[sp.Symbol], values: Mapping[Any, object]
) -> dict[sp.Symbol, sp.Expr]:
    """Values by coupling, from names or symbols."""
    names = {s.name: s for s in couplings}
    replaced = {}
    for name, value in values.items():
        symbol = names[checks.known_name(str(name), names, "coupling", GravityError)]
        replaced[symbol] = checks.expression(
            value,
            str(name),
            GravityError,
            read=lambda text, where=str(name): parse_expression(text, names, where=where),
        )
    return replaced


def shown(expression: sp.Basic) -> sp.Basic:
    """A result as it is printed: H, Hdot and phidot for functions of the time, f_T for df/dT."""
    return shorthand(expression, [T, X, Y, Z], T)


def names_of(scalars: str | Iterable[str]) -> list[str]:
    """Names of scalar fields from one text or a list."""
    if isinstance(scalars, str):
        return scalars.replace(",", " ").split()
    return [str(one) for one in checks.entries(scalars, "scalars", GravityError)]


def small_frame() -> tuple[Frame, list[Component]]:
    """Flat space with a small wave in its coframe, e^i_m = delta^i_m + epsilon h^i_m."""
    h = _tensor("h", 2)
    rows = [[int(i == m) + _value(h, "h", i, m) for m in range(4)] for i in range(4)]
    frame = Frame([T, X, Y, Z], rows, signature=ETA, parameters=[SMALL])
    return frame.expanded(SMALL, 1), h


def small_matter(scalars: Sequence[str], vectors: int) -> tuple[list[MatterField], list[Component]]:
    """Scalar fields by name and vector fields, all small."""
    matter: list[MatterField] = []
    components: list[Component] = []
    for name in scalars:
        one = Component(f"s_{name}", ())
        matter.append(scalar_field(SMALL * one.function, None if name == "phi" else name))
        components.append(one)
    for number in range(1, vectors + 1):
        own = [Component(f"A{number}", (k,)) for k in range(4)]
        matter.append(maxwell([SMALL * one.function for one in own]))
        components += own
    return matter, components

"""Catalogue: the names that a Lagrangian may use, as products of the tensors of a theory."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from geomtorsion.errors import GravityError
from geomtorsion.geometry import Connection, Frame
from geomtorsion.gravity.theory.invariants import INVARIANTS, Invariant
from geomtorsion.gravity.theory.lagrangian import Lagrangian, Reading, read
from geomtorsion.gravity.theory.matter import MatterField, ScalarField
from geomtorsion.gravity.theory.products import (
    EPSILON,
    KNOWN,
    METRIC,
    OF_CONNECTION,
    OF_MATTER,
    Factor,
    Product,
    hessian_name,
)
from geomtorsion.gravity.theory.vocabulary import Vocabulary, declared_constants
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

# Tensors that vanish for each connection of a kind, and names of the kinds in messages.
ABSENT = {"levi-civita": ("T", "Q"), "cartan": ("R", "Q"), "metric": ("Q",)}
KINDS = {"levi-civita": "Levi-Civita", "cartan": "Cartan", "metric": "metric"}
# Invariants that vanish by the symmetries of the curvature: of its last pair, or by Bianchi's.
WITHOUT_TRACE = frozenset(("R7",))
WITHOUT_TORSION = frozenset(("R7", "P2", "P3", "P5", "holst", "nieh_yan"))
# Connections that have a tensor.
OWNERS = {
    "T": "gt.cartan(frame), or another connection with torsion",
    "R": "gt.levi_civita(frame), or another connection with curvature",
    "Q": "a connection that is not metric, such as one of gt.from_coefficients",
}

# Curvature as far as it turns vectors: R_ab[ij].
TURNING = "turning R"


@dataclass(frozen=True, eq=False)
class Catalogue:
    """Invariants of connections and of matter fields, by their names in a Lagrangian.

    connections: the connections over one frame.
    own: invariants besides those that the package names.
    matter: matter fields, with their numbers.
    """

    connections: tuple[Connection, ...]
    own: tuple[Invariant, ...] = ()
    matter: Sequence[MatterField] = ()

    def __post_init__(self) -> None:
        """Refuse two meanings of one name."""
        names = [one.name for one in self.own]
        taken = {*self.of_matter, *self.tensors_of_matter}
        for k, name in enumerate(names):
            if name in names[:k] or name in taken:
                other = "a matter field" if name in taken else "another invariant"
                raise GravityError(
                    f"invariants: expected different names, got {name} for an invariant and for "
                    f"{other}. Give another name."
                )

    @property
    def frame(self) -> Frame:
        """The frame of all connections."""
        return self.connections[0].frame

    @cached_property
    def invariants(self) -> dict[str, Invariant]:
        """All invariants by their own names, whether they exist in this dimension or not."""
        return {**INVARIANTS, **{one.name: one for one in self.own}}

    @cached_property
    def numbers(self) -> dict[str, int]:
        """Ending of a name -> number of the connection: "", "_2", "bar"."""
        numbers: dict[str, int] = {}
        count = 1
        for number, connection in enumerate(self.connections):
            if connection.kind == "levi-civita":
                endings = ["bar"] if len(self.connections) > 1 else ["", "bar"]
            else:
                endings = [""] if count == 1 else [f"_{count}"]
                count += 1
            numbers |= dict.fromkeys(endings, number)
        return numbers

    @cached_property
    def meanings(self) -> dict[str, tuple[str, Invariant]]:
        """Name in a Lagrangian -> (ending, invariant)."""
        table: dict[str, tuple[str, Invariant]] = {}
        for one in self.invariants.values():
            if one.only not in (0, self.frame.dimension):
                continue
            factors = [x for product in one.products(self.frame.dimension) for x in product.factors]
            # An invariant of matter only, or of stated connections, is one invariant.
            is_relative = one.name in INVARIANTS or any(
                x.name in OF_CONNECTION and not x.suffix for x in factors
            )
            for ending in self.numbers if is_relative else [""]:
                table[one.name + ending] = ending, one
        return table

    @cached_property
    def of_matter(self) -> dict[str, MatterField]:
        """Name in a Lagrangian -> its matter field."""
        return {name: field for field in self.matter for name in field.names}

    @cached_property
    def tensors_of_matter(self) -> dict[str, MatterField]:
        """Name of a tensor -> its matter field."""
        return {name: field for field in self.matter for name in field.ranks}

    @property
    def names(self) -> tuple[str, ...]:
        """All names."""
        return (*self.meanings, *self.of_matter)

    def read(self, lagrangian: Lagrangian) -> Reading:
        """A Lagrangian in these names.

        Raises
        ------
        GravityError
            A name has no meaning, or a matter field does not occur.
        """
        frame, fields = self.frame, self.matter
        vocabulary = Vocabulary(
            frame,
            self.connections,
            self.names,
            {one: field.symbol for field in fields for one in field.parts(frame)},
            {one: x.symbol for x in fields if (one := x.function(frame)) is not None},
            {x.symbol: x.box for x in fields if isinstance(x, ScalarField)},
            declared_constants(lagrangian.constants),
            self.invariants,
        )
        reading = read(lagrangian, vocabulary)
        occurring = set(reading.symbols.values())
        products = [product for name in occurring for product in self.products(name)]
        occurring |= {x.name for one in products for x in one.factors if not x.suffix}
        for field in fields:
            if occurring.isdisjoint((*field.names, *field.ranks)):
                raise GravityError(
                    f"matter: expected a Lagrangian with {' or '.join(field.names)}, got "
                    f"{checks.cut(str(lagrangian.expression))}. Add a term of the "
                    f"{field.kind} {field.symbol} to the Lagrangian, or omit the field."
                )
        return reading

    def absent(self, name: str, *, varied: bool = True) -> tuple[str, str] | None:
        """The kind of connection for which an invariant vanishes, and connections that have it.

        varied: whether an invariant counts as present if its derivatives do not vanish also.
        None if it does not vanish for all connections of these kinds.
        """
        factors = [
            [x for x in product.factors if x.suffix.isdigit()] for product in self.products(name)
        ]
        gone = []
        for product in factors:
            own = [x for x in product if x.name[-1] in self._absent_of(x)]
            # The Cartan connection is varied: the derivative of R by its curvature does not vanish.
            if not own or (varied and own[0].name[-1] == "R" and len(own) == 1):
                break
            gone.append(own[0])
        else:
            if gone:
                kind = self.connections[int(gone[0].suffix)].kind
                return KINDS[kind], OWNERS[gone[0].name[-1]]
        return self._absent_by_symmetry(name)

    def _absent_of(self, factor: Factor) -> tuple[str, ...]:
        """The tensors that vanish for the connection of a factor."""
        return ABSENT.get(self.connections[int(factor.suffix)].kind, ())

    def _absent_by_symmetry(self, name: str) -> tuple[str, str] | None:
        if name not in self.meanings:
            return None
        ending, invariant = self.meanings[name]
        kind = self.connections[self.numbers.get(ending, 0)].kind
        if kind == "levi-civita" and invariant.name in WITHOUT_TORSION:
            return KINDS[kind], "a connection with torsion, such as one of gt.from_torsion"
        if kind == "metric" and invariant.name in WITHOUT_TRACE:
            return KINDS[kind], OWNERS["Q"]
        return None

    def has_nonmetricity(self, names: Iterable[str], number: int) -> bool:
        """Whether invariants contain the nonmetricity of a connection."""
        factors = (x for name in names for one in self.products(name) for x in one.factors)
        return any(x.name == "Q" and x.suffix == str(number) for x in factors)

    def products(self, name: str) -> tuple[Product, ...]:
        """An invariant as products of tensors, whose suffix is the number of the connection.

        Raises
        ------
        GravityError
            A tensor belongs to a connection or to a matter field that is not given.
        """
        if name in self.of_matter:
            return self.of_matter[name].products.get(name, ())
        ending, invariant = self.meanings[name]
        return tuple(
            replace(one, factors=tuple(self._placed(x, ending, invariant) for x in one.factors))
            for one in invariant.products(self.frame.dimension)
        )

    def _placed(self, factor: Factor, ending: str, invariant: Invariant) -> Factor:
        """A factor with the number of its connection, or with the name of its matter field."""
        if factor.name in (METRIC, EPSILON):
            return factor
        written = factor.name + factor.suffix
        if factor.name in OF_CONNECTION:
            if (factor.suffix or ending) not in self.numbers:
                raise GravityError(
                    f"invariant {invariant.name}: expected tensors of the given connections, got "
                    f"{written}. Give the other connection also: equations([gt.cartan(frame), "
                    "gt.levi_civita(frame)], ...)."
                )
            name = TURNING if factor.name == "R" and invariant.antisymmetric else factor.name
            return Factor(name, factor.indices, str(self.numbers[factor.suffix or ending]))
        if written not in self.tensors_of_matter:
            remedy = "gravity.maxwell(A)"
            if factor.name not in OF_MATTER:
                remedy = f"gravity.scalar_field(..., name='{written}')"
                if written == "phi":
                    remedy = "gravity.scalar_field(phi)"
            raise GravityError(
                f"invariant {invariant.name}: {written} belongs to a matter field, and none is "
                f"given. Give matter={remedy}, or another formula. Known are {KNOWN}."
            )
        is_second = len(factor.indices) == 2 and factor.name not in OF_MATTER
        return Factor(hessian_name(written) if is_second else written, factor.indices)

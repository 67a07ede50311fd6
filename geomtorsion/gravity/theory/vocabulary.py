"""Vocabulary: the names in a Lagrangian, what each means, and the refusal of all others."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.exact import names as words
from geomtorsion.geometry import Connection, Frame
from geomtorsion.gravity.theory.invariants import INVARIANTS, SUFFIXED, WORDS, Invariant, new_name
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

# Theories that need no numbers; each is a Lagrangian in the package.
THEORIES = ("tegr", "stegr", "einstein_cartan", "general_relativity", "gauss_bonnet")
# Names of matter fields, and the functions that introduce them.
MATTER = {
    "X": "gravity.scalar_field(phi)",
    "Box": "gravity.scalar_field(phi)",
    "hessian2": "gravity.scalar_field(phi)",
    "hessian3": "gravity.scalar_field(phi)",
    "phi": "gravity.scalar_field(phi)",
    "F2": "gravity.maxwell(A)",
    "H2": "gravity.kalb_ramond(B)",
    "B2": "gravity.kalb_ramond(B)",
}
# The same for perturbations and counts, which make the fields themselves.
SCALARS = 'scalars="phi" (on the command line --scalars phi)'
COUNTED = {"F2": "vectors=1", "H2": "two_forms=1", "B2": "two_forms=1"}
# The cosmological constant: the one constant that is added to invariants without a declaration.
COSMOLOGICAL = ("Lambda", "Λ")
# The boundary term in f(T, B), which has derivatives of torsion.
BOUNDARY = "B"
# Other names of invariants, in small letters. "C" and "G" are constants in too many papers.
SYNONYMS = {
    "kretschmann": "R1", "riemann2": "R1", "riem2": "R1", "ricci2": "R4", "ric2": "R4",
    "ricci": "R", "ricciscalar": "R", "ricci_scalar": "R", "curvature": "R",
    "scalar_curvature": "R", "torsion": "T", "torsion_scalar": "T", "nonmetricity": "Q",
    "weyl": "P1", "weyl2": "P1", "gaussbonnet": "GB", "gauss_bonnet": "GB",
    "chern_simons": "pontryagin",
}  # fmt: skip
# Names of the operator of waves, in small letters: Box(phi) of a scalar field phi.
WAVE_OPERATORS = frozenset("box dalembert dalembertian".split())
# Operators, in small letters: a Lagrangian contains invariants without their derivatives.
OPERATORS = WAVE_OPERATORS | frozenset(
    "d del div curl grad nabla lap laplace laplacian partial".split()
)
_FAMILY = re.compile(r"[TRQPU][1-9]\d*(bar|_[2-9])?")
_INDICES = re.compile(r"(Riem(ann)?|Ric(ci)?|Weyl|[TRQSKC])_[a-z]{2,4}")


@dataclass(frozen=True, eq=False)
class Vocabulary:
    """The names that a Lagrangian may use.

    frame: whose coordinates and parameters may occur.
    connections: whose symbols may occur.
    names: invariants and matter.
    parts: unknown functions of which matter fields are made -> name of the field.
    functions: those that are a matter field themselves -> name of the field.
    boxes: name of a scalar field -> name of its Box.
    declared: names of constants.
    invariants: all invariants, whether they exist in this dimension or not.
    """

    frame: Frame
    connections: tuple[Connection, ...] = ()
    names: Collection[str] = ()
    parts: Mapping[AppliedUndef, str] = field(default_factory=dict)
    functions: Mapping[AppliedUndef, str] = field(default_factory=dict)
    boxes: Mapping[str, str] = field(default_factory=dict)
    declared: tuple[str, ...] = ()
    invariants: Mapping[str, Invariant] = field(default_factory=lambda: INVARIANTS)

    @cached_property
    def symbols(self) -> dict[str, sp.Symbol]:
        """Name -> symbol of everything that was read over the frame."""
        return {symbol.name: symbol for symbol in self.frame.field.symbols}

    @cached_property
    def _given(self) -> frozenset[str]:
        """Coordinates and parameters of the frame."""
        return frozenset(x.name for x in (*self.frame.coordinates, *self.frame.parameters))

    @cached_property
    def _of_connections(self) -> frozenset[str]:
        """Symbols in the coefficients of connections that more than the frame determines."""
        tensors = [x.coefficients for x in self.connections if x.kind in ("metric", "general")]
        elements = (x for one in tensors for x in one.components.nonzero.values())
        return frozenset(symbol.name for x in elements for symbol in x.symbols)

    def is_own(self, name: str) -> bool:
        """Whether the frame or a connection has a symbol of this name.

        Constants of other Lagrangians over the same frame do not count.
        """
        if name in self._given:
            return True
        return name in self.symbols and name in self._of_connections

    @property
    def _listed(self) -> str:
        """The names for a message, without second names: Rbar where R means the same."""
        alone = len(self.connections) == 1
        return ", ".join(x for x in self.names if not (alone and x.endswith("bar")))

    def check_name(self, name: str) -> None:
        """Refuse a name that has two meanings, or that looks like one that is not there."""
        if name in self.names:
            if self.is_own(name):
                remedy = "Rename the symbol of the frame."
                if name in self.functions.values() or name in MATTER:
                    remedy += " A scalar field may have another name: scalar_field(..., name='chi')"
                    remedy += "."
                raise GravityError(
                    f"lagrangian: {name} is an invariant and a symbol of the frame. {remedy}"
                )
            return
        if self.is_own(name) or name in self.declared or not self.names:
            return
        self._check_invariant(name)
        theory = checks.close_names(name.lower(), THEORIES, cutoff=0.75)
        if theory and name.lower() not in SYNONYMS:
            raise GravityError(
                f"lagrangian: expected invariants or the name of a theory, got {name}. Did you "
                f"mean {theory[0]}, in Python gravity.{theory[0]}? If {name} is a constant, "
                f"declare it: {_declaration([*self.declared, name])}."
            )
        near = checks.close_names(name, [one for one in self.names if len(one) > 2], cutoff=0.75)
        same = [one for one in self.names if one.lower() == name.lower()]
        indexed = bool(_INDICES.fullmatch(name))
        other = name == BOUNDARY or name.lower() in SYNONYMS
        if near or same or indexed or other or _FAMILY.fullmatch(name):
            raise GravityError(
                f"lagrangian: expected the name of an invariant or of a parameter, got {name}. "
                f"{self._hint(name)}Known are {self._listed}. Give a parameter another name, or "
                f"declare it: {_declaration([*self.declared, name])}."
            )

    def _check_invariant(self, name: str) -> None:
        """Refuse an invariant or a matter field that does not exist here."""
        suffixed = SUFFIXED.fullmatch(name)
        base = suffixed[1] if suffixed else name
        if base in self.invariants and self.invariants[base].only not in (0, self.frame.dimension):
            dimension = self.invariants[base].only
            raise GravityError(
                f"lagrangian: {name} exists in {dimension} dimensions only. Use a frame of "
                f"dimension {dimension}, or other invariants."
            )
        if base in self.invariants:
            raise GravityError(
                f"lagrangian: expected invariants of the given connections, got {name}. Give the "
                "other connection also: equations([gt.cartan(frame), gt.levi_civita(frame)], ...)."
            )
        if base in MATTER:
            owned = "a matter field" if base == name else "another matter field"
            raise GravityError(
                f"lagrangian: {name} belongs to {owned}, and none is given. Give matter="
                f"{MATTER[base]}, in perturbations {COUNTED.get(base, SCALARS)}, or rename the "
                f"parameter if {name} is yours."
            )
        if name.lower() in WORDS:
            raise GravityError(
                f"lagrangian: expected a formula in invariants, got {name}. Write one such as "
                "T + c*T**2."
            )

    def _hint(self, name: str) -> str:
        """A question or a remark about a name that means nothing."""
        if _INDICES.fullmatch(name):
            return "In a contraction each index is once up and once down, such as c*R_ab R^ab. "
        if name == BOUNDARY:
            return (
                "The boundary term B is Rbar + T: give equations([gt.cartan(frame), "
                "gt.levi_civita(frame)], ...) and write f(T, Rbar + T). "
            )
        meant = SYNONYMS.get(name.lower())
        for one in (meant, f"{meant}bar"):
            if one in self.names:
                return f"Did you mean {one} ({INVARIANTS[str(meant)].meaning})? "
        return checks.did_you_mean(name, [one for one in self.names if len(one) > 1])

    def check_function(self, name: str) -> None:
        """Refuse a function that looks like an operator, or like a function that is known."""
        if name.lower().split("_")[0] in OPERATORS:
            raise GravityError(
                f"lagrangian: expected invariants without derivatives, got {name}(...). Second "
                "derivatives of a scalar field phi are Box(phi), hessian2 and hessian3. Use these, "
                "or another name if it is an unknown function."
            )
        known = [*words.FUNCTIONS, *words.SPECIAL]
        near = [one for one in known if one.lower() == name.lower()]
        known += [one for one in INVARIANTS if len(one) > 2]
        near = near or checks.close_names(name, known, cutoff=0.75)
        if name.lower() in SYNONYMS:
            near = [SYNONYMS[name.lower()]]
        if near:
            raise GravityError(
                f"lagrangian: expected a function, got {name}(...). Did you mean {near[0]}? Give "
                "an unknown function another name."
            )

    def constants(self, expression: sp.Expr, invariants: Collection[sp.Symbol]) -> tuple[str, ...]:
        """The constants in a Lagrangian, sorted; invariants: its symbols that are not constant.

        Raises
        ------
        GravityError
            A new name neither multiplies an invariant nor is declared, or a declared one does not
            occur.
        """
        symbols = expression.free_symbols.difference(invariants)
        new = {symbol for symbol in symbols if not self.is_own(symbol.name)}
        occurring = {x.name for x in symbols}
        for name in self.declared:
            if name not in occurring:
                hint = checks.did_you_mean(name, occurring)
                raise GravityError(
                    f"constants: expected names that occur in the Lagrangian, got {name}. {hint}"
                    "Remove it, or correct it."
                )
        scales = {*invariants, *(x for x in new if x.name in COSMOLOGICAL)}
        free = {x for x in new if x.name not in self.declared} - scales
        for symbol, place in _misplaced(expression, scales, free):
            context = "" if place == symbol else f" in {checks.cut(str(place))}"
            raise GravityError(
                f"lagrangian: expected invariants, or constants that multiply them, got "
                f"{symbol.name}{context}. {self._hint(symbol.name)}Known are "
                f"{self._listed}. If {symbol.name} is a constant, declare it: "
                f"{_declaration([*self.declared, symbol.name])}."
            )
        return tuple(sorted({x.name for x in new}))

    @property
    def called(self) -> set[str]:
        """Names of the unknown functions of which matter fields are made."""
        return {part.func.__name__ for part in self.parts}

    def with_fields(self, expression: sp.Expr) -> sp.Expr:
        """The expression with matter fields by name: phi for phi(t).

        Raises
        ------
        GravityError
            The expression has another part of a matter field, by which it would not be varied.
        """
        names = {(one.func.__name__, one.args): name for one, name in self.functions.items()}
        owners = {(one.func.__name__, one.args): name for one, name in self.parts.items()}
        changed = {}
        for part in expression.atoms(AppliedUndef):
            key = part.func.__name__, part.args
            if key in names:
                changed[part] = sp.Symbol(names[key])
            elif key in owners:
                raise GravityError(
                    f"lagrangian: expected matter fields by their names, got {part}, a part of "
                    f"{owners[key]}. Write names such as X, phi and F2."
                )
        for slope, part in product(expression.atoms(sp.Derivative), changed):
            if slope.expr.has(part) and not part.free_symbols.isdisjoint(slope.variables):
                raise GravityError(
                    f"lagrangian: expected derivatives of a scalar field in X, got {slope}. Write "
                    "X = g^ij d_i phi d_j phi, or second derivatives as Box(phi)."
                )
        return self._with_boxes(expression.xreplace(changed))

    def _with_boxes(self, expression: sp.Expr) -> sp.Expr:
        """The expression with the names of second derivatives: Box for Box(phi)."""
        fields = {(sp.Symbol(name),): sp.Symbol(box) for name, box in self.boxes.items()}
        return expression.xreplace(
            {
                part: fields[part.args]
                for part in expression.atoms(AppliedUndef)
                if part.func.__name__.lower() in WAVE_OPERATORS and part.args in fields
            }
        )


def _declaration(names: Iterable[str]) -> str:
    """How constants are declared, in Python and on the command line."""
    text = " ".join(names)
    quoted = f'"{text}"' if " " in text else text
    return f'constants="{text}", on the command line --constants {quoted}'


def _misplaced(
    expression: sp.Basic, scales: set[sp.Symbol], new: set[sp.Symbol]
) -> Iterator[tuple[sp.Symbol, sp.Basic]]:
    """New symbols that multiply nothing that varies, each with the place where it occurs."""
    varies = bool(expression.free_symbols & scales)
    for part in expression.args if varies else (expression,):
        if part.free_symbols & scales:
            yield from _misplaced(part, scales, new)
        # The other factors of a product are the coefficient of those that vary.
        elif not varies or not expression.is_Mul:
            yield from ((symbol, expression) for symbol in sorted(part.free_symbols & new, key=str))


def declared_constants(constants: str | sp.Symbol | Iterable[str | sp.Symbol]) -> tuple[str, ...]:
    """Names of constants from text or a list.

    Examples
    --------
    >>> declared_constants("alpha, beta")
    ('alpha', 'beta')
    """
    if isinstance(constants, str):
        entries = constants.replace(",", " ").split()
    elif isinstance(constants, sp.Symbol):
        entries = [constants]
    else:
        wanted = 'names such as "alpha beta"'
        entries = checks.entries(constants, "constants", GravityError, expected=wanted)
    return tuple(dict.fromkeys(new_name(entry, "constants") for entry in entries))

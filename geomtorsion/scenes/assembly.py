"""Assembly: equations of motion of a scene, by Kane's method, from the states that it keeps."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.errors import SceneError
from geomtorsion.rigid.attitude import rotation_rows
from geomtorsion.scenes.context import (
    ATTITUDE,
    OMEGA,
    POSITION,
    QUATERNION,
    TIME,
    VELOCITY,
    Context,
    Number,
    Symbols,
)
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import expression as expression_of

if TYPE_CHECKING:
    from geomtorsion.scenes.body import Body
    from geomtorsion.scenes.effects.protocol import Constraint, Contribution, Effect

# Product of states -> sum of parameters.
Sum = dict[sp.Expr, sp.Expr]
# Terms with more operations than this are not multiplied out: gathering like terms saves operations
# in short sums, and only costs time and length in long ones (a thrust that is a formula).
SHORT = 60


def accelerations(assembly: Assembly) -> list[sp.Expr]:
    """Rates of the speeds, in their order; without a constraint Euler's equations.

    Equation
    --------
    omega_k . (I a + omega x L + h' - M) + v_k . (m v' + m omega x v - R^T F) = 0 for each speed,
    omega_k, v_k the partial velocities (body axes), L = I omega + h        [KaneLevinson1985]
    """
    matrix, right = _projected(_Outline(_symbols(assembly), assembly))
    return _solved(assembly, matrix, right)


@dataclass(frozen=True)
class _Outline:
    """The symbols of an assembly, which decide its equations; numbers have no part in them."""

    symbols: tuple[object, ...]
    assembly: Assembly = field(compare=False)


def _symbols(assembly: Assembly) -> tuple[object, ...]:
    """Everything of which accelerations are made, as a key."""
    context, held = assembly.context, assembly.constraint
    parts = [
        (part.naive, *(v and tuple(map(expression_of, v)) for v in vectors))
        for part in assembly.parts.values()
        for vectors in [(part.moment, part.force, part.momentum)]
    ]
    tied = None
    if held is not None:
        vectors = held.omega, held.velocity, held.arm or ()
        tied = held.speeds, *(tuple(map(expression_of, vector)) for vector in vectors)
    return (
        context.mass, frozenset(context.switched), frozenset(assembly.values),
        assembly.inertia.as_immutable(), tuple(parts), tied, tuple(assembly.rates.items()),
        tuple(assembly.substitutions.items()),
    )  # fmt: skip


@lru_cache
def _projected(outline: _Outline) -> tuple[sp.ImmutableMatrix, tuple[sp.Expr, ...]]:
    """Matrix and right side of the equations for the accelerations."""
    assembly = outline.assembly
    context, parts = assembly.context, assembly.parts.values()
    inertia, omega = assembly.inertia, assembly.omega
    internal = assembly.constrained(vector_sum(parts, "momentum"))
    turning = assembly.constrained(vector_sum(parts, "moment"))
    # The naive law leaves this out; of a body that is held, with what Steiner's part has in it.
    naive = any(part.naive for part in parts)
    gyroscopic = (0 if naive else 1) * omega.cross(inertia * omega + internal)
    turning -= gyroscopic + internal.applyfunc(assembly.derivative)
    # A free body: translation and rotation are separate, and the speeds are Omega.
    if assembly.constraint is None:
        return inertia.as_immutable(), tuple(turning)
    v, mass = assembly.velocity_body, context.mass
    pulling = assembly.constrained(ATTITUDE.T * vector_sum(parts, "force"))
    # With constant speeds: how the partial velocities themselves change.
    fixed = replace(
        assembly, rates={s: r for s, r in assembly.rates.items() if s not in assembly.speeds}
    )
    # If no point is held, m Omega x v belongs to m v' in space, and not to Omega x L.
    turned = 0 if naive and assembly.constraint.arm is not None else 1
    pulling -= mass * (v.applyfunc(fixed.derivative) + turned * omega.cross(v))
    turning -= inertia * omega.applyfunc(fixed.derivative)
    pairs = [(omega.diff(speed), v.diff(speed)) for speed in assembly.speeds]
    matrix = sp.Matrix(
        [[sp.expand(w.dot(inertia * o) + mass * m.dot(n)) for o, n in pairs] for w, m in pairs]
    )
    return matrix.as_immutable(), tuple(w.dot(turning) + m.dot(pulling) for w, m in pairs)


def vector_sum(parts: Iterable[Contribution], name: str) -> sp.Matrix:
    """Sum of one kind of vector over all contributions."""
    total = sp.zeros(3, 1)
    for part in parts:
        vector = getattr(part, name)
        if vector is not None:
            total = total + sp.Matrix(list(vector))
    return total


def _solved(
    assembly: Assembly, matrix: sp.ImmutableMatrix, right: Sequence[sp.Expr]
) -> list[sp.Expr]:
    """matrix^-1 right: one term for each product of states, where that is short."""
    size = len(right)
    parameters = frozenset(sp.Symbol(name) for name in assembly.values)
    # Principal axes, as most scenes have them: one division for each speed.
    if all(matrix[i, j] == 0 for i in range(size) for j in range(size) if i != j):
        rows = [_terms(value, parameters) for value in right]
        return [
            _total({rest: n / matrix[k, k] for rest, n in rows[k].items()}) for k in range(size)
        ]
    # A constant matrix is inverted once, in exact numbers.
    if matrix.free_symbols <= parameters and not matrix.free_symbols & assembly.context.switched:
        inverse, rows = _named(assembly, matrix), [_terms(value, parameters) for value in right]
        return [_total(_merged(_products(inverse[k, :], rows))) for k in range(size)]
    # Nothing is multiplied out that engines can take as it is.
    adjugate, determinant = _cofactors(matrix)
    return [
        sp.Add(*(adjugate[k, j] * right[j] for j in range(size))) / determinant for k in range(size)
    ]


@lru_cache
def _cofactors(matrix: sp.ImmutableMatrix) -> tuple[sp.ImmutableMatrix, sp.Expr]:
    """Adjugate and determinant, computed once for all scenes with equal equations."""
    return matrix.adjugate().as_immutable(), matrix.det(method="berkowitz")


@lru_cache
def _terms(value: sp.Expr, parameters: frozenset[sp.Symbol]) -> Sum:
    """The terms of a sum: gathered, but for long ones, which stay as they are."""
    long = [term for term in sp.Add.make_args(value) if term.count_ops() > SHORT]
    terms = gathered(value - sp.Add(*long), parameters)
    return terms | dict.fromkeys(long, sp.S.One)


def _products(factors: Iterable[sp.Expr], rows: Sequence[Sum]) -> Iterable[tuple[sp.Expr, sp.Expr]]:
    """Terms of a sum of factors times rows."""
    for factor, row in zip(factors, rows, strict=True):
        for rest, number in row.items():
            yield rest, number * factor


def _named(assembly: Assembly, matrix: sp.ImmutableMatrix) -> sp.Matrix:
    """The inverse of a constant matrix as parameters J11, J12, ...: exact, and short to write."""
    numbers = {sp.Symbol(name): value for name, value in assembly.values.items()}
    inverse = matrix.xreplace(numbers).inv()
    names = sp.zeros(*matrix.shape)
    for i in range(matrix.rows):
        for j in range(i + 1):
            name = f"J{j + 1}{i + 1}"
            names[i, j] = names[j, i] = assembly.context.parameter(name, inverse[i, j])
    return names


def gathered(expression: sp.Expr, parameters: frozenset[sp.Symbol]) -> Sum:
    """Products of states -> sums of parameters; what cancels is gone.

    Examples
    --------
    >>> I1, I2, Omega1 = sp.symbols("I1 I2 Omega1")
    >>> gathered(I1 * Omega1 - I2 * Omega1, frozenset({I1, I2}))
    {Omega1: I1 - I2}
    """
    parts = []
    for term in sp.Add.make_args(sp.expand_mul(expression)):
        number = sp.Mul(*(f for f in sp.Mul.make_args(term) if f.free_symbols <= parameters))
        parts.append((term / number, number) if number != 0 else (sp.S.One, sp.S.Zero))
    return _merged(parts)


def _merged(parts: Iterable[tuple[sp.Expr, sp.Expr]]) -> Sum:
    sums: Sum = {}
    for rest, number in parts:
        sums[rest] = sums.get(rest, sp.S.Zero) + number
    return {rest: number for rest, number in sums.items() if number != 0}


def _total(table: Sum) -> sp.Expr:
    return sp.Add(*(rest * number for rest, number in table.items()))


WORK = sp.Symbol("work")


@dataclass(frozen=True, eq=False)
class Assembly:
    """The equations of a body under its effects, in symbols.

    context: symbols and values of parameters.
    parts: key of each effect -> what it adds.
    constraint: the one that ties the velocities, if there is one.
    rates: state -> rate. Rows 1 and 2 of R (attitude) and n (vertical) turn with the body and have
        their rates from `turning`.
    start: states of effects -> value at the start.
    substitutions: angular velocity, velocity and position where a constraint gives them.

    Equation
    --------
    omega_k . (I a + omega x L + h' - M) + v_k . (m v' + m omega x v - R^T F) = 0 for each speed,
    omega_k, v_k the partial velocities (body axes), L = I omega + h        [KaneLevinson1985]
    """

    context: Context
    parts: Mapping[str, Contribution]
    constraint: Constraint | None
    rates: Mapping[sp.Symbol, sp.Expr]
    start: Mapping[str, Number]
    substitutions: Mapping[sp.Symbol, sp.Expr]

    @property
    def values(self) -> Mapping[str, sp.Expr]:
        """Parameter -> exact number."""
        return self.context.values

    @property
    def speeds(self) -> Symbols:
        """Symbols of the speeds of rotation (or of the constraint)."""
        if self.constraint is None:
            return tuple(OMEGA)
        return tuple(sp.Symbol(name) for name in self.constraint.speeds)

    def constrained(self, expression: Any) -> Any:
        """An expression or a matrix of expressions, with the values that the constraint fixes."""
        whole = isinstance(expression, sp.MatrixBase)
        value = expression if whole else expression_of(expression)
        return value.xreplace(dict(self.substitutions))

    @cached_property
    def inertia(self) -> sp.Matrix:
        """Inertia tensor about the centre of mass, with what effects add."""
        return _inertia(self.context, self.parts.values())

    @cached_property
    def omega(self) -> sp.Matrix:
        """Body angular velocity, body axes."""
        return sp.Matrix([self.constrained(symbol) for symbol in OMEGA])

    @cached_property
    def velocity_body(self) -> sp.Matrix:
        """Velocity of the centre of mass, body axes."""
        if self.constraint is not None:
            return sp.Matrix(self.constraint.velocity)
        # The transpose of a rotation is its inverse: from space axes to body axes.
        return ATTITUDE.T * sp.Matrix(VELOCITY)

    @cached_property
    def angular_momentum(self) -> sp.Matrix:
        """L in body axes, about the fixed point if there is one, else about the centre of mass."""
        total = self.inertia * self.omega + self.constrained(
            vector_sum(self.parts.values(), "momentum")
        )
        if self.constraint is not None and self.constraint.arm is not None:
            arm = sp.Matrix(self.constraint.arm)
            total += self.context.mass * arm.cross(self.velocity_body)
        return total

    @cached_property
    def rotational_energy(self) -> sp.Expr:
        """Energy of rotation about the centre of mass."""
        return (self.omega.T * self.inertia * self.omega)[0] / 2

    @cached_property
    def kinetic_energy(self) -> sp.Expr:
        """Energy of rotation and translation."""
        free = self.constraint is None
        v = sp.Matrix(VELOCITY) if free else self.velocity_body
        return self.rotational_energy + self.context.mass * v.dot(v) / 2

    @cached_property
    def potential_energy(self) -> sp.Expr:
        """Energy stored in the effects."""
        stored = [part.energy for part in self.parts.values() if part.energy is not None]
        return self.constrained(sp.Add(*map(expression_of, stored)))

    @cached_property
    def power(self) -> sp.Expr:
        """Power of the effects; 0 for effects with a potential."""
        return self.constrained(sp.Add(*(power_of(part) for part in self.parts.values())))

    def turning(self, symbol: sp.Symbol) -> sp.Expr:
        """Rate of an element of R, or of the vertical: R' = R [Omega]x."""
        return self._turning[symbol]

    @cached_property
    def _turning(self) -> Mapping[sp.Basic, sp.Expr]:
        """Rates of all elements of R."""
        omega, rates = tuple(self.omega), {}
        for i in range(3):
            row = tuple(ATTITUDE[i, :])
            for j in range(3):
                a, b = (j + 1) % 3, (j + 2) % 3
                rates[row[j]] = row[a] * omega[b] - row[b] * omega[a]
        return rates

    def rate_of(self, symbol: sp.Basic) -> sp.Expr:
        """Rate of any state; 0 for parameters."""
        if symbol == TIME:
            return sp.S.One
        if symbol in self.rates:
            return self.rates[symbol]
        return self._turning.get(symbol, sp.S.Zero)

    def derivative(self, expression: sp.Expr) -> sp.Expr:
        """Time derivative of an expression along the motion."""
        return sp.Add(*(sp.diff(expression, s) * self.rate_of(s) for s in expression.free_symbols))


def power_of(part: Contribution) -> sp.Expr:
    """Power of a contribution."""
    if part.power is not None:
        return expression_of(part.power)
    if part.energy is not None:
        return sp.diff(expression_of(part.energy), TIME)
    none = (sp.S.Zero,) * 3
    pairs = zip((*(part.moment or none), *(part.force or none)), (*OMEGA, *VELOCITY), strict=True)
    return sp.Add(*(expression_of(value) * speed for value, speed in pairs))


def assemble(body: Body, effects: Mapping[str, Effect]) -> Assembly:
    """The equations of a body under these effects (key -> effect).

    Raises
    ------
    SceneError
        two effects tie the body, or two give the same state.

    Examples
    --------
    >>> from geomtorsion.scenes import Body
    >>> free = assemble(Body(moments=(1, 2, 3)), {})
    >>> free.rates[free.context.Omega[0]]
    Omega2*Omega3*(I2 - I3)/I1
    """
    context = Context(body)
    parts: dict[str, Contribution] = {}
    for key, effect in effects.items():
        context.key = key
        parts[key] = effect.adds(context)
    holding = [key for key, part in parts.items() if part.constraint is not None]
    if len(holding) > 1:
        raise SceneError(
            "expected one effect that constrains the velocities of the body, got "
            f"{' and '.join(holding)}. Keep one of them."
        )
    constraint = parts[holding[0]].constraint if holding else None
    rates, start = _own_states(parts)
    substitutions = _substitutions(constraint)
    # The accelerations need an assembly that knows everything but them.
    assembly = Assembly(context, parts, constraint, rates, start, substitutions)
    own = {s: assembly.constrained(r) for s, r in rates.items()}
    assembly = Assembly(context, parts, constraint, own, start, substitutions)
    own |= dict(zip(assembly.speeds, accelerations(assembly), strict=True))
    if constraint is None:
        force = vector_sum(parts.values(), "force")
        own |= {v: f / context.mass for v, f in zip(VELOCITY, force, strict=True)}
        own |= dict(zip(POSITION, VELOCITY, strict=True))
    else:
        start |= constraint.start
        moving = zip(POSITION, ATTITUDE * assembly.velocity_body, strict=True)
        own |= {place: rate for place, rate in moving if place not in substitutions}
    # Work is a state only where something is put in: its rate is the power.
    if assembly.power == 0:
        substitutions[WORK] = sp.S.Zero
    else:
        own[WORK] = assembly.power
        start[WORK.name] = 0
    # Laws outside of mechanics override the others.
    for part in parts.values():
        own |= {sp.Symbol(name): assembly.constrained(rate) for name, rate in part.replaces.items()}
    own = {symbol: expression_of(rate) for symbol, rate in own.items()}
    return Assembly(context, parts, constraint, own, start, substitutions)


def _own_states(
    parts: Mapping[str, Contribution],
) -> tuple[dict[sp.Symbol, sp.Expr], dict[str, Number]]:
    """Rates and starts of the states that effects bring; none twice, nor what they offer."""
    rates: dict[sp.Symbol, sp.Expr] = {}
    start: dict[str, Number] = {}
    for key, part in parts.items():
        for name, rate in part.states.items():
            if name in start:
                raise SceneError(
                    f"{key}: expected a new state, got {name!r}, which another effect has. Rename "
                    "it."
                )
            if name not in part.start:
                raise SceneError(f"{key}: expected a start for the state {name!r}, got none.")
            rates[sp.Symbol(name)] = expression_of(rate)
            start[name] = part.start[name]
        for name in part.outputs:
            if any(name in other.outputs for k, other in parts.items() if k != key):
                raise SceneError(
                    f"{key}: expected a new name for a watched quantity, got {name!r}, which "
                    "another effect has. Rename it."
                )
    return rates, start


def _substitutions(constraint: Constraint | None) -> dict[sp.Symbol, sp.Expr]:
    """Angular velocity, velocity and position under a constraint."""
    if constraint is None:
        return {}
    substitutions = dict(zip(OMEGA, map(expression_of, constraint.omega), strict=True))
    substitutions |= dict(zip(VELOCITY, ATTITUDE * sp.Matrix(constraint.velocity), strict=True))
    if constraint.position is not None:
        substitutions |= dict(zip(POSITION, map(expression_of, constraint.position), strict=True))
    return {symbol: value for symbol, value in substitutions.items() if symbol != value}


def _inertia(context: Context, parts: Iterable[Contribution]) -> sp.Matrix:
    total = context.inertia
    for part in parts:
        if part.inertia is not None:
            total = total + sp.Matrix([list(row) for row in part.inertia])
    return total


@cache
def by_quaternion() -> Mapping[sp.Symbol, sp.Expr]:
    """Elements of R (and with them the vertical) as polynomials of the unit quaternion."""
    rows = rotation_rows(QUATERNION)
    return {ATTITUDE[i, j]: rows[i][j] for i in range(3) for j in range(3)}

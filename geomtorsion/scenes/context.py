"""Context: the symbols in which effects write their equations, and the values of parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import sympy as sp

from geomtorsion.errors import SceneError
from geomtorsion.scenes.body import Body, Number, exact
from geomtorsion.support import checks

Symbols = tuple[sp.Symbol, ...]

OMEGA: Symbols = sp.symbols("Omega1:4")
ATTITUDE = sp.Matrix(3, 3, sp.symbols("R1:3(1:4) n1:4"))
VERTICAL: Symbols = tuple(ATTITUDE[2, :])
QUATERNION: Symbols = sp.symbols("q0:4")
POSITION: Symbols = sp.symbols("x y z")
VELOCITY: Symbols = sp.symbols("vx vy vz")
TIME = sp.Symbol("t")

# The states of each group; rows 1 and 2 of R represent the whole attitude.
GROUPS: Mapping[str, frozenset[sp.Symbol]] = {
    "omega": frozenset(OMEGA),
    "vertical": frozenset(VERTICAL),
    "attitude": frozenset((*ATTITUDE[0, :], *ATTITUDE[1, :], *QUATERNION)),
    "position": frozenset(POSITION),
    "velocity": frozenset(VELOCITY),
    "time": frozenset((TIME,)),
}

# State -> the group under which tables show it.
_GROUP_OF: dict[str, str] = {
    **dict.fromkeys((s.name for s in OMEGA), "rotation"),
    **dict.fromkeys((s.name for s in QUATERNION), "attitude"),
    **dict.fromkeys((s.name for s in VERTICAL), "vertical"),
    **dict.fromkeys((s.name for s in POSITION), "position"),
    **dict.fromkeys((s.name for s in VELOCITY), "velocity"),
}


def group_of(name: str) -> str:
    """The group that a state belongs to; other nodes of the graph are their own group.

    Examples
    --------
    >>> group_of("q2"), group_of("vz"), group_of("work")
    ('attitude', 'velocity', 'work')
    """
    return _GROUP_OF.get(name, name)


class Context:
    """Context of an effect: symbols for the state of the body, and a function that names numbers.

    Omega: body angular velocity, body axes, three symbols (rad/s).
    R: attitude, 3 x 3 symbols, body to space; its last row is `vertical`.
    vertical: the upward direction (space axis 3) seen from the body, n1, n2, n3.
    position, velocity: of the centre of mass, space axes (m, m/s).
    t: time (s).
    mass: symbol m (kg); inertia: 3 x 3 about the centre of mass, body axes (kg m^2).
    body: the body, for its numbers.

    An effect that uses only `vertical` costs 3 equations; one that uses other rows of R costs 4.

    Examples
    --------
    >>> from geomtorsion.scenes import Body
    >>> context = Context(Body(mass=2.0, moments=(1, 2, 3)))
    >>> g = context.parameter("g", 9.81)
    >>> context.mass * g * context.position[2]
    g*m*z
    >>> context.inertia
    Matrix([
    [I1,  0,  0],
    [ 0, I2,  0],
    [ 0,  0, I3]])
    """

    Omega = OMEGA
    R = ATTITUDE
    vertical = VERTICAL
    position = POSITION
    velocity = VELOCITY
    t = TIME

    def __init__(self, body: Body) -> None:
        self.body = body
        self.values: dict[str, sp.Expr] = {}
        self.switched: set[sp.Symbol] = set()
        self.key = ""
        self._taken = {s.name for group in GROUPS.values() for s in group} | {"work"}
        self.mass: sp.Symbol = self.parameter("m", body.mass)
        self.inertia: sp.Matrix = self._inertia()

    def parameter(self, name: str, value: Number) -> sp.Expr:
        """A symbol for a number, so that another value needs no new equations; 0 stays 0.

        A name that is taken gets the key of the effect after it: `k`, then `k_spring2`.
        """
        number = exact(value, name)
        # Zero terms are omitted from the equations, and with them perhaps a state.
        if number == 0:
            return sp.S.Zero
        return self._named(name, number)

    def switchable(self, name: str, value: Number = 0) -> sp.Symbol:
        """Like `parameter`, and a symbol even for 0: for numbers that switches change."""
        symbol = self._named(name, exact(value, name))
        self.switched.add(symbol)
        return symbol

    def vector(self, name: str, values: Sequence[Number]) -> sp.Matrix:
        """Three numbers as a column of symbols name1, name2, name3; zeros stay zeros."""
        parts = checks.entries(values, name, SceneError, 3, expected="three components")
        return sp.Matrix([self.parameter(f"{name}{k}", v) for k, v in enumerate(parts, 1)])

    def state(self, name: str) -> sp.Symbol:
        """A symbol for a state of the effect's own."""
        self._free(name)
        return sp.Symbol(name)

    def in_body(self, vector: Iterable[sp.Expr]) -> sp.Matrix:
        """A vector given in space axes, as column in body axes: R^T v."""
        return self.R.T * sp.Matrix(list(vector))

    def in_space(self, vector: Iterable[sp.Expr]) -> sp.Matrix:
        """A vector given in body axes, as column in space axes: R v."""
        return self.R * sp.Matrix(list(vector))

    def _named(self, name: str, number: sp.Expr) -> sp.Symbol:
        if name in self._taken:
            name = f"{name}_{self.key}" if self.key else f"{name}_"
        self._free(name)
        self.values[name] = number
        return sp.Symbol(name)

    def _free(self, name: str) -> None:
        """Take a name, once."""
        if name in self._taken:
            raise SceneError(
                f"expected a new name, got {name!r}, which exists already. Choose another."
            )
        self._taken.add(name)

    def _inertia(self) -> sp.Matrix:
        """Symbols of the inertia tensor: equal moments share one, zeros stay zeros."""
        tensor = self.body.exact_tensor
        diagonal = all(tensor[i][j] == 0 for i in range(3) for j in range(3) if i != j)
        rows = sp.zeros(3, 3)
        symbol_of: dict[sp.Expr, sp.Expr] = {}
        for i in range(3):
            value = tensor[i][i]
            name = f"I{i + 1}" if diagonal else f"I{i + 1}{i + 1}"
            # One symbol for equal moments: Euler's equations then show the symmetry by themselves.
            if not (diagonal and value in symbol_of):
                symbol_of[value] = self.parameter(name, value)
            rows[i, i] = symbol_of[value]
            for j in range(i):
                rows[i, j] = rows[j, i] = self.parameter(f"I{j + 1}{i + 1}", tensor[i][j])
        return rows

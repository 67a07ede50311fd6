"""Fluids: sources that are not in the Lagrangian, and the torsion of a spin density."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from os import PathLike

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element
from geomtorsion.geometry import Connection, Frame, Tensor, antisymmetric, at_home
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.gravity.states.equation_of_state import ETA, EquationOfState
from geomtorsion.gravity.states.matter_tables import equation_of_state
from geomtorsion.gravity.theory.fields import HALF, FrameFields, Index, Terms
from geomtorsion.gravity.theory.lagrangian import scalar_of
from geomtorsion.support import checks


@dataclass(frozen=True, eq=False)
class Fluid:
    """A perfect fluid, with spin if there is some; components in the frame.

    density, pressure: scalars.
    velocity: u^i with u_i u^i = 1 or -1.
    spin: s_ij antisymmetric with s_ij u^j = 0, or None.
    matter: the equation of state by which density and pressure depend on one variable, or None.

    Equation
    --------
    E_i^n = p_i u^n + p (E_i^n - u_i u^n / u^2),  C^{n i}_j = s^i_j u^n / 2
    p_i = (u^j D_n(e s_ij u^n)/e - rho u_i) / u^2
    """

    density: sp.Expr | str
    pressure: sp.Expr | str
    velocity: Sequence[sp.Expr | str]
    spin: Sequence[Sequence[sp.Expr | str]] | Tensor | None = None
    matter: EquationOfState | None = None

    def check(self, frame: Frame) -> None:
        """Refuse a velocity that is not normalised and a spin that is not transverse."""
        square = self._square(frame)
        if not (square - 1).is_zero and not (square + 1).is_zero:
            raise GravityError(
                f"velocity: expected u_i u^i = 1 or -1, got {square}. Give components in the frame."
            )
        spin = self._spin(frame)
        n = range(frame.dimension)
        u = self._velocity(frame).components.get
        for i in n:
            if not frame.field.sum([(1, spin.components.get((i, j)), u((j,))) for j in n]).is_zero:
                raise GravityError(
                    f"spin: expected s_ij u^j = 0, got another value for i = {i}. Give a spin "
                    "without components along the velocity."
                )

    def elements(self, frame: Frame) -> list[Element]:
        """The expressions of which the fluid is made: density, pressure, velocity, spin."""
        scalars = [scalar_of(frame, x, "fluid") for x in (self.density, self.pressure)]
        tensors = self._velocity(frame), self._spin(frame)
        return scalars + [x for one in tensors for x in one.components.nonzero.values()]

    def _velocity(self, frame: Frame) -> Tensor:
        """u^i, slots U."""
        return _vector(frame, self.velocity, "velocity")

    def _square(self, frame: Frame) -> Element:
        u = self._velocity(frame)
        return (u.lowered() @ u).element()

    def _spin(self, frame: Frame) -> Tensor:
        """s_ij, slots DD."""
        if self.spin is None:
            return Tensor(frame, "DD", {}, antisymmetric(2))
        return antisymmetric_matrix(frame, self.spin, "spin")

    def _flow(self, frame: Frame) -> Tensor:
        """s_ij u^n at (n, i, j), slots UDD."""
        u, s = self._velocity(frame).components.get, self._spin(frame).components.get
        rule: Callable[[Index], Element] = lambda i: u(i[:1]) * s(i[1:])  # noqa: E731
        return Tensor(frame, "UDD", rule, (((0, 2, 1), -1),))

    def connection_source(self, connection: Connection) -> Tensor:
        """C^{n i}_j of the fluid, slots UUD."""
        frame = connection.frame
        get = self._flow(frame).components.get
        half = Tensor(frame, "UDD", lambda i: get(i) * HALF, (((0, 2, 1), -1),))
        return half.raised(1)

    def coframe_source(self, connection: Connection) -> Tensor:
        """E_i^n of the fluid, slots DU."""
        frame = connection.frame
        n = range(frame.dimension)
        velocity = self._velocity(frame)
        u, lower = velocity.components.get, velocity.lowered().components.get
        rho, p = (
            scalar_of(frame, self.density, "density"),
            scalar_of(frame, self.pressure, "pressure"),
        )
        sign = -1 if (self._square(frame) - 1).is_zero else 1
        turning = FrameFields(connection).divergence(self._flow(frame)).components.get

        def rule(index: Index) -> Element:
            i, k = index
            terms: Terms = [(sign, rho, lower((i,)), u((k,))), (sign, p, lower((i,)), u((k,)))]
            terms += [(-sign, u((j,)), turning((i, j)), u((k,))) for j in n]
            if i == k:
                terms.append((1, p))
            return frame.field.sum(terms)

        return Tensor(frame, "DU", rule)


def fluid(
    density: sp.Expr | str | None = None,
    pressure: sp.Expr | str | None = None,
    velocity: Sequence[sp.Expr | str] = (1, 0, 0, 0),
    *,
    p: EquationOfState | str | PathLike[str] | Sequence[Sequence[float]] | None = None,
) -> Fluid:
    """A perfect fluid as a source; the velocity u^i has components in the frame.

    Parameters
    ----------
    density, pressure
        Scalars; both, or neither if the fluid has an equation of state.
    velocity
        u^i; by default at rest in the first leg.
    p
        Equation of state instead of density and pressure, or a table or a name as
        `equation_of_state` takes it. Both become functions of an unknown function eta(r), and
        `star` and `family` solve the equations.

    Raises
    ------
    GravityError
        density and pressure are missing, or given beside an equation of state.

    Examples
    --------
    >>> fluid("rho", 0, [1, 0, 0, 0]).pressure
    0
    >>> fluid(p="SLy").matter
    SLy: 7 pieces
    """
    if p is None:
        if density is None or pressure is None:
            raise GravityError(
                "fluid: expected a density and a pressure, or an equation of state p, got "
                f"{'none' if density is None and pressure is None else 'one of them'}. Give "
                'gravity.fluid("rho(r)", "p(r)"), or gravity.fluid(p="table.csv").'
            )
        return Fluid(density, pressure, velocity)
    if density is not None or pressure is not None:
        raise GravityError(
            "fluid: expected an equation of state, or a density and a pressure, got both. Omit one."
        )
    matter = equation_of_state(p)
    # As text, so that the function is read with the coordinate r of the frame.
    at = {ETA: sp.Function("eta")(sp.Symbol("r"))}
    density, pressure = (str(x.xreplace(at)) for x in (matter.density, matter.pressure))
    return Fluid(density, pressure, velocity, matter=matter)


def weyssenhoff(
    density: sp.Expr | str,
    pressure: sp.Expr | str,
    velocity: Sequence[sp.Expr | str],
    spin: Sequence[Sequence[sp.Expr | str]] | Tensor,
) -> Fluid:
    """A fluid with spin density s_ij (Weyssenhoff), s_ij u^j = 0, as a source.

    Its momentum density p_i follows from the identity of rotations.

    Examples
    --------
    >>> spin = [[0] * 4, [0, 0, "s", 0], [0, "-s", 0, 0], [0] * 4]
    >>> weyssenhoff("rho", 0, [1, 0, 0, 0], spin).velocity
    [1, 0, 0, 0]
    """
    return Fluid(density, pressure, velocity, spin)


def torsion_from_spin(
    frame: FrameLike, tau: Tensor | Sequence, kappa: sp.Expr | str = "kappa"
) -> Tensor:
    """The torsion T_ij^a of a spin density in the theory L = R/(2 kappa) + L_m, slots DDU.

    Equation
    --------
    T_ij^a + g_i^a v_j - g_j^a v_i = kappa tau^a_ij,  v_i = T_ij^j = - kappa tau^j_ij / (n - 2)

    Parameters
    ----------
    tau
        tau^a_ij = 2 C^a_ij of L_m, antisymmetric in ij, at [a][i][j], in the frame.
    kappa
        Coupling constant; a parameter kappa if not given.

    Returns
    -------
    T with T = 2 S: `gt.from_torsion(frame, T / 2)` is its connection.

    Raises
    ------
    GravityError
        tau is not antisymmetric, or the frame has two dimensions.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> flat = Frame(sp.symbols("t x y z"), sp.eye(4), (-1, 1, 1, 1))
    >>> s = sp.Symbol("s")
    >>> tau = sp.MutableDenseNDimArray.zeros(4, 4, 4)
    >>> tau[0, 1, 2], tau[0, 2, 1] = s, -s
    >>> torsion_from_spin(flat, tau.tolist()).nonzero()
    {(1, 2, 0): kappa*s, (2, 1, 0): -kappa*s}
    """
    frame = as_frame(frame, "frame", GravityError)
    n = frame.dimension
    if n < 3:
        raise GravityError(
            f"frame: expected three or more dimensions, got {n}. The equation does not fix the "
            "torsion vector in two."
        )
    strength = scalar_of(frame, kappa, "kappa")
    spin = _spin_density(frame, tau).components.get
    traces = [frame.field.sum([(1, spin((j, i, j))) for j in range(n)]) for i in range(n)]
    share = Fraction(1, n - 2)

    def rule(index: Index) -> Element:
        i, j, a = index
        terms: Terms = [(1, strength, spin((a, i, j)))]
        if a == i:
            terms.append((share, strength, traces[j]))
        if a == j:
            terms.append((-share, strength, traces[i]))
        return frame.field.sum(terms)

    return Tensor(frame, "DDU", rule, antisymmetric(3), "T", "torsion (2S)")


def _spin_density(frame: Frame, tau: Tensor | Sequence) -> Tensor:
    """tau^a_ij, slots UDD, checked."""
    n = frame.dimension
    if isinstance(tau, Tensor):
        home = at_home(frame, tau)
        if home is None or len(tau.slots) != 3:
            raise GravityError(
                f"tau: expected a tensor tau^a_ij over this frame, got {tau.label}. Build it over "
                "the frame of the equations."
            )
        tensor = home.in_frame().lowered().raised(0)
    else:
        values = {}
        for a, rows in enumerate(_square_list(tau, n, "tau")):
            for i, row in enumerate(_square_list(rows, n, f"tau[{a}]")):
                for j, x in enumerate(_square_list(row, n, f"tau[{a}][{i}]")):
                    values[a, i, j] = scalar_of(frame, x, f"tau[{a}][{i}][{j}]")
        tensor = Tensor(frame, "UDD", values)
    get = tensor.components.get
    for a, i, j in tensor.components.nonzero:
        if not (get((a, i, j)) + get((a, j, i))).is_zero:
            raise GravityError(
                f"tau: expected tau^a_ij antisymmetric in ij, got components [{a}, {i}, {j}] and "
                f"[{a}, {j}, {i}] that do not cancel. Give tau = 2 C of the matter Lagrangian."
            )
    return Tensor(frame, "UDD", tensor.components, (((0, 2, 1), -1),))


def antisymmetric_matrix(frame: Frame, values: object, what: str) -> Tensor:
    """An antisymmetric matrix in the frame, slots DD, checked."""
    n = frame.dimension
    if isinstance(values, Tensor):
        home = at_home(frame, values)
        if home is None or len(values.slots) != 2:
            raise GravityError(f"{what}: expected a tensor of rank 2 over this frame, got another.")
        tensor = home.in_frame().lowered()
    else:
        entries = {}
        for i, row in enumerate(_square_list(values, n, what)):
            for j, x in enumerate(_square_list(row, n, f"{what}[{i}]")):
                entries[i, j] = scalar_of(frame, x, f"{what}[{i}][{j}]")
        tensor = Tensor(frame, "DD", entries)
    get = tensor.components.get
    for i, j in tensor.components.nonzero:
        if not (get((i, j)) + get((j, i))).is_zero:
            raise GravityError(
                f"{what}: expected an antisymmetric matrix, got entries [{i}, {j}] and "
                f"[{j}, {i}] that do not cancel. Change the sign of one of them."
            )
    return Tensor(frame, "DD", tensor.components, antisymmetric(2))


def _square_list(values: object, n: int, what: str) -> list:
    """A list of n entries."""
    entries = list(checks.entries(checks.rows(values), what, GravityError))
    if len(entries) != n:
        raise GravityError(
            f"{what}: expected {n} entries, got {len(entries)}. Give one for each leg."
        )
    return entries


def _vector(frame: Frame, values: object, what: str) -> Tensor:
    """Components of a vector in the frame, slots U."""
    if isinstance(values, Tensor):
        return values.in_frame().raised()
    entries = _square_list(values, frame.dimension, what)
    read = {(i,): scalar_of(frame, x, f"{what}[{i}]") for i, x in enumerate(entries)}
    return Tensor(frame, "U", read)

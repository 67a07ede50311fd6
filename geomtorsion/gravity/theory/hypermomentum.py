"""Hypermomentum: a source with given energy-momentum and hypermomentum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element
from geomtorsion.geometry import Connection, Frame, Tensor, at_home
from geomtorsion.gravity.theory.fluids import Fluid
from geomtorsion.gravity.theory.lagrangian import scalar_of
from geomtorsion.support import checks

Components = Tensor | Sequence


@dataclass(frozen=True, eq=False)
class Hypermomentum:
    """A source of the equations of the connection and of the coframe; components in the frame.

    density: Delta^{ni}_j, at [n][i][j].
    energy_momentum: t_i^n, at [i][n], or None.
    """

    density: Components
    energy_momentum: Components | None = None

    def check(self, frame: Frame) -> None:
        """Read the components."""
        self._density(frame)
        self._energy_momentum(frame)

    def elements(self, frame: Frame) -> list[Element]:
        """The expressions of which the source is made."""
        tensors = self._density(frame), self._energy_momentum(frame)
        return [x for one in tensors for x in one.components.nonzero.values()]

    def _density(self, frame: Frame) -> Tensor:
        return _components(frame, self.density, "UUD", "density")

    def _energy_momentum(self, frame: Frame) -> Tensor:
        if self.energy_momentum is None:
            return Tensor(frame, "DU", {})
        return _components(frame, self.energy_momentum, "DU", "energy_momentum")

    def connection_source(self, connection: Connection) -> Tensor:
        """C^{ni}_j of the source, slots UUD."""
        return self._density(connection.frame)

    def coframe_source(self, connection: Connection) -> Tensor:
        """E_i^n of the source, slots DU."""
        return self._energy_momentum(connection.frame)


Source = Fluid | Hypermomentum


def hypermomentum(density: Components, energy_momentum: Components | None = None) -> Hypermomentum:
    """A source with spin, dilation and shear: hypermomentum of metric-affine gravity.

    Equation
    --------
    C^{ni}_j = Delta^{ni}_j = (1/e) d(e L_m)/d omega_ni^j,  E_i^n = t_i^n      [HehlEtAl1995]

    Parameters
    ----------
    density
        Delta^{ni}_j in the frame, shape (n, n, n), or a tensor with three indices in this order.
        A metric connection is varied among metric ones: only the part antisymmetric in ij, the
        spin, acts on it.
    energy_momentum
        t_i^n in the frame, shape (n, n), or a tensor; without it zero. Dust at rest has
        t_1^1 = -rho.

    Raises
    ------
    GravityError
        In `equations`: an array has another shape, or a tensor belongs to another frame.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> from geomtorsion import gravity
    >>> plane = gt.Frame("x y", [[1, 0], [0, 1]])
    >>> source = gravity.hypermomentum([[["d", 0], [0, "d"]], [[0, 0], [0, 0]]])
    >>> flat = gt.from_coefficients(plane, [[[0, 0], [0, 0]], [[0, 0], [0, 0]]])
    >>> theory = gravity.Lagrangian("R7", "metric-affine")
    >>> gravity.equations(flat, theory, source).C.nonzero()
    {(0, 0, 0): d, (0, 1, 1): d}
    """
    return Hypermomentum(density, energy_momentum)


def _components(frame: Frame, values: Components, slots: str, what: str) -> Tensor:
    """A tensor in the frame, from a tensor with any indices or from an array."""
    if isinstance(values, Tensor):
        home = at_home(frame, values)
        if home is None or len(home.slots) != len(slots):
            raise GravityError(
                f"{what}: expected a tensor with {len(slots)} indices over this frame, got "
                f"{values.label}. Build it over the frame of the equations."
            )
        tensor = home.in_frame()
        for k, slot in enumerate(slots):
            tensor = tensor.raised(k) if slot == "U" else tensor.lowered(k)
        return tensor
    n = frame.dimension
    entries: dict[tuple[int, ...], object] = {(): values}
    for _ in slots:
        deeper: dict[tuple[int, ...], object] = {}
        for place, rows in entries.items():
            name = what + "".join(f"[{k}]" for k in place)
            listed = list(checks.entries(checks.rows(rows), name, GravityError))
            if len(listed) != n:
                raise GravityError(
                    f"{name}: expected {n} entries, got {len(listed)}. Give one for each leg."
                )
            deeper |= {(*place, k): one for k, one in enumerate(listed)}
        entries = deeper
    places = product(range(n), repeat=len(slots))
    read = {
        place: scalar_of(frame, entries[place], what + "".join(f"[{k}]" for k in place))
        for place in places
    }
    return Tensor(frame, slots, read)

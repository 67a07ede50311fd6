"""Stresses: the coframe of least elastic energy with a torsion, and its stress."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from geomtorsion.conventions import burgers as in_convention
from geomtorsion.errors import ArgumentError, GridError, NetworkError
from geomtorsion.materials.elasticity.cell import Cell
from geomtorsion.materials.elasticity.constants import ElasticConstants
from geomtorsion.materials.elasticity.nye_field import NyeField
from geomtorsion.materials.elasticity.readings import Reading, forces, mean_stresses
from geomtorsion.materials.elasticity.stress_errors import Spread, StressErrors
from geomtorsion.materials.elasticity.stress_files import stress_dataset, vtk_bytes
from geomtorsion.materials.elasticity.torsion import TorsionModes, of_frame, of_network, of_nye
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.lines import DislocationNetwork
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.files import ending, written

Source = DislocationNetwork | SampledFrame | NyeField


@dataclass(frozen=True, eq=False, repr=False)
class Stresses:
    """The stress of a torsion in a periodic cell, with all that follows from it.

    source: a network, a coframe or a Nye field. constants: elastic constants. cell: the box and
    the grid of nodes. core: width of the Gaussian over which each line is spread. gauge: the length
    l of the gauge theory. mean_stress: the mean over the cell, shape (3, 3). convention: sign of
    the Burgers vectors of the source. corrections: sentences about changes to the source.

    Stress, strain and distortion describe the real crystal: a positive sigma_xx pulls along x.
    Distortions beta_ij = d_j u_i would belong to a displacement u from the perfect place of an atom
    to its real one, if there were no torsion.

    Made by `stresses`.
    """

    source: Source
    constants: ElasticConstants
    cell: Cell
    core: float
    gauge: float
    mean_stress: np.ndarray
    convention: str
    corrections: tuple[str, ...]
    _torsion: TorsionModes

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        nodes = " x ".join(map(str, self.cell.shape))
        return (
            f"Stresses({nodes} nodes, largest stress {self.largest:.4g}{unit}, energy "
            f"{self.energy:.6g}{f' {self.energy_unit}' if self.energy_unit else ''})"
        )

    # -- fields -----------------------------------------------------------------------------------

    @cached_property
    def _modes(self) -> np.ndarray:
        """Modes of the distortion, shape (modes, 3, 3)."""
        return self._relaxed(self._torsion.modes(self.cell, self._waves), self.cell, self._waves)

    @cached_property
    def _waves(self) -> np.ndarray:
        """Numbers of waves of the modes, shape (modes, 3)."""
        return self.cell.waves()

    def _relaxed(self, incompatible: np.ndarray, cell: Cell, waves: np.ndarray) -> np.ndarray:
        """Modes of the distortion of least energy with the torsion of another distortion."""
        k, c = cell.vectors(waves), self.constants.tensor
        filtered = incompatible / (1 + self.gauge**2 * (k**2).sum(axis=1))[:, None, None]
        # Lengths of k cancel: unit vectors keep the matrices within the range of floats.
        k /= np.linalg.norm(k, axis=1)[:, None]
        acoustic = np.einsum("ijlm,nj,nm->nil", c, k, k, optimize=True)
        load = np.einsum("ijlm,nj,nlm->ni", c, k, filtered, optimize=True)
        u = np.linalg.solve(acoustic, load[..., None])
        return filtered - u * k[:, None, :]

    @cached_property
    def distortion(self) -> np.ndarray:
        """beta_ij, the elastic distortion at the nodes, shape (3, 3, N_1, N_2, N_3)."""
        strain = self.constants.strain(self.mean_stress)
        return self.cell.field(self._modes, self._waves) + strain[..., None, None, None]

    @cached_property
    def strain(self) -> np.ndarray:
        """The elastic strain at the nodes, shape (3, 3, N_1, N_2, N_3)."""
        return (self.distortion + self.distortion.swapaxes(0, 1)) / 2

    @cached_property
    def stress(self) -> np.ndarray:
        """sigma_ij at the nodes, shape (3, 3, N_1, N_2, N_3), in the unit of the constants."""
        return self.constants.stress(self.distortion)

    @property
    def largest(self) -> float:
        """The largest |sigma_ij| at a node."""
        return float(np.abs(self.stress).max())

    @property
    def mises(self) -> np.ndarray:
        """Von Mises stress sqrt(3/2 s_ij s_ij), s the stress without its trace; one per node."""
        trace = np.trace(self.stress) / 3
        deviator = self.stress - np.eye(3)[..., None, None, None] * trace
        return np.sqrt(1.5 * (deviator**2).sum(axis=(0, 1)))

    @cached_property
    def nye(self) -> np.ndarray:
        """alpha^{ik} of the result at the nodes, in the convention of the source.

        It is the torsion of the source as spread by the core, and without the corrections' parts.
        """
        k = self.cell.vectors(self._waves)
        curl = 1j * np.cross(k[:, None, :], self._modes)
        return self._torsion.sign * self.cell.field(curl, self._waves)

    @cached_property
    def frame(self) -> SampledFrame:
        """The coframe <e> (1 - beta), periodic: its circuits measure b in the sense SF/RH.

        <e> is the mean of the coframe of the source, or 1.

        Raises
        ------
        GridError
            The cell is not along the coordinates, or has a single node along x or y.
        """
        cell = self.cell
        dimension = 3 if cell.shape[2] > 1 else 2
        if not cell.is_along_axes or min(cell.shape[:dimension]) < 5:
            raise GridError(
                "frame: expected a cell along the coordinates with five nodes or more along x and "
                f"y, got {' x '.join(map(str, cell.shape))} nodes with the edges "
                f"{checks.shown(np.asarray(cell.box.vectors).tolist())}. Use .distortion."
            )
        unit = np.eye(3)[..., None, None, None]
        coframe = np.tensordot(self._torsion.mean, unit - self.distortion, 1)
        order = max(n for n in (4, 6, 8) if n < min(cell.shape[:dimension]))
        return SampledFrame(
            cell.axes[:dimension],
            coframe[..., 0] if dimension == 2 else coframe,
            order,
            periodic=(True,) * dimension,
            unit=self.length_unit,
        )

    def at(self, points: Sequence[Sequence[float]] | np.ndarray) -> np.ndarray:
        """sigma_ij at any points, shape (points, 3) -> (3, 3, points), by the sum of its waves."""
        places = checks.array(points, "points", GridError, shape=(None, 3))
        checks.measured(places, "points", GridError)
        return self._means(places, np.zeros_like(places), 0.0)

    def _means(self, starts: np.ndarray, steps: np.ndarray, width: float) -> np.ndarray:
        """Mean stress along pieces, spread by a Gaussian, shape (3, 3, pieces)."""
        return self._reader(starts, steps, width)(self.cell, self._waves, self._modes)

    def _reader(self, starts: np.ndarray, steps: np.ndarray, width: float) -> Reading:
        """Computes the mean stress along pieces from modes of the distortion."""
        return mean_stresses(self.constants, self.mean_stress, starts, steps, width)

    # -- numbers ----------------------------------------------------------------------------------

    @cached_property
    def energy(self) -> float:
        """Elastic energy of the cell, in `energy_unit`; of a plane map, per unit of thickness.

        With the gauge theory it includes the energy of the cores, 1/2 l^2 C grad e grad e.
        """
        strain = self.constants.strain(self.mean_stress)
        mean = float((self.mean_stress * strain).sum()) * self.cell.box.volume / 2
        return self._energy(self._modes, self.cell, self._waves) + mean

    def _energy(self, modes: np.ndarray, cell: Cell, waves: np.ndarray) -> float:
        """Energy of modes of the distortion."""
        stress = np.tensordot(modes, self.constants.tensor, ([1, 2], [2, 3]))
        density = (stress * modes.conj()).sum(axis=(1, 2)).real
        k2 = (cell.vectors(waves) ** 2).sum(axis=1)
        gauged = cell.weights(waves) * (1 + self.gauge**2 * k2)
        return float((gauged * density).sum()) * cell.box.volume / 2

    @cached_property
    def forces(self) -> np.ndarray:
        """Peach-Koehler force per length on each straight piece of a network, its mean.

        f = (sigma b) x t with b = closed integral of du about the sense t [Peach, Koehler, Phys.
        Rev. 80 (1950) 436]. sigma is averaged over the core of the piece, so that its own stress
        counts, and the forces are minus the derivatives of the energy.

        Returns
        -------
        Shape (pieces, 3), in the order of `source.arrays`; stress times length.

        Raises
        ------
        NetworkError
            The source is not a network of lines.
        """
        if not isinstance(self.source, DislocationNetwork):
            raise NetworkError(
                "forces: expected a DislocationNetwork as source of the stresses, got "
                f"{type(self.source).__name__}. Give the lines: .forces_on(network)."
            )
        return self._force_reader(self.source)(self.cell, self._waves, self._modes)

    def forces_on(self, network: DislocationNetwork) -> tuple[np.ndarray, np.ndarray]:
        """Peach-Koehler force per length on lines in this stress, and its error.

        Parameters
        ----------
        network
            Lines in the coordinates of the cell, with b in the `convention` of the source.

        Returns
        -------
        Two arrays of shape (pieces, 3), in the order of `network.arrays`; stress times length. The
        errors contain noise, grid and outside as `errors`, and are NaN outside a map.

        Raises
        ------
        NetworkError
            b does not have three components.

        Examples
        --------
        >>> from geomtorsion.materials.lines import Box, LineArrays
        >>> alpha = np.zeros((3, 3, 16, 16, 1))
        >>> alpha[0, 2, 8, 8] = 0.01
        >>> box = Box.of_bounds([0, 0, 0], [16, 16, 1], (False, False, True))
        >>> measured = NyeField(alpha, box, sigma=1e-4).padded(16).balanced()
        >>> found = stresses(measured, ElasticConstants.isotropic(80, 0.3), core=1.0)
        >>> line = LineArrays([[8, 4, 0]], [[0, 0]], [[1, 0, 0]], box, images=[[0, 0, 1]])
        >>> force, error = found.forces_on(DislocationNetwork.of_arrays(line))
        >>> force.round(3)[0, 1].tolist(), error.round(3)[0, 1].tolist()
        (-0.053, 0.005)
        """
        checks.instance(network, DislocationNetwork, "network")
        lines = network.arrays
        if len(lines.pairs) and lines.burgers.shape[1] != 3:
            raise NetworkError(
                f"burgers: expected three components, got {lines.burgers.shape[1]}. Give b in the "
                "coordinates of the nodes."
            )
        read = self._force_reader(network)
        pulls = read(self.cell, self._waves, self._modes)
        if self._spread is None:
            sizes = np.abs(lines.burgers).sum(axis=1, keepdims=True)
            return pulls, np.repeat(self.error * math.sqrt(2) * sizes, 3, axis=1)
        starts = lines.positions[lines.pairs[:, 0]]
        inside = [self._spread.is_measured(x) for x in (starts, starts + lines.steps)]
        return pulls, self._spread.errors(read, np.all(inside, axis=0)[:, None]).total

    def _force_reader(self, network: DislocationNetwork) -> Reading:
        """Computes forces on the pieces of lines from modes of the distortion."""
        lines = network.arrays
        mean = self._reader(lines.positions[lines.pairs[:, 0]], lines.steps, self.core)
        return forces(mean, lines, self._torsion.sign)

    # -- errors -----------------------------------------------------------------------------------

    @cached_property
    def _rest(self) -> tuple[float, float]:
        """Largest stress and energy of the waves of lines that a finer grid adds."""
        lowest = tuple((n - 1) // 2 for n in self.cell.shape)
        # Three halves of the nodes, and the first wave of directions with one node.
        cell = Cell(self.cell.box, tuple(n + max(2, n // 2) for n in self.cell.shape))
        waves = cell.waves(lowest)
        modes = self._relaxed(self._torsion.modes(cell, waves), cell, waves)
        stress = self.constants.stress(cell.field(modes, waves))
        return float(np.abs(stress).max(initial=0.0)), self._energy(modes, cell, waves)

    @property
    def _spread(self) -> Spread | None:
        """How results change with measured data; None for lines."""
        if isinstance(self.source, DislocationNetwork):
            return None
        return Spread(
            self.source, self._torsion, self._relaxed, self.cell, self._waves, self._modes
        )

    @cached_property
    def errors(self) -> StressErrors:
        """Errors of each stress component at the nodes, shape (3, 3, N_1, N_2, N_3), by causes.

        noise: sigma of the data through the linear map from distortion to stress. It is the root
        mean square over random fields with the covariance of the data, from a fixed seed. grid:
        differences of another order, or the stress of waves shorter than four steps. outside: the
        crystal around a map is unknown. It is taken as perfect; the change with the width of
        `NyeField.padded` estimates the error, but dislocations outside the map are not in it.

        For lines it is the stress that a grid with three halves of the nodes adds. The errors of
        the elastic model and of the core are not included.

        Examples
        --------
        >>> from geomtorsion.materials.lines import Box
        >>> alpha = np.zeros((3, 3, 16, 16, 1))
        >>> alpha[0, 2, 7:9, 7:9] = 0.01
        >>> box = Box.of_bounds([0, 0, 0], [16, 16, 1], (False, False, True))
        >>> field = NyeField(alpha, box, sigma=1e-3).padded(16).balanced()
        >>> stresses(field, ElasticConstants.isotropic(80, 0.3, unit="GPa")).errors
        StressErrors(...)
        """
        if self._spread is None:
            return StressErrors.of_grid(np.full(self.stress.shape, self._rest[0]), self.unit)
        return self._spread.at_nodes(self.constants)

    def errors_at(self, points: Sequence[Sequence[float]] | np.ndarray) -> StressErrors:
        """Errors of `at(points)`, shape (3, 3, points); NaN outside a map."""
        places = checks.array(points, "points", GridError, shape=(None, 3))
        checks.measured(places, "points", GridError)
        if self._spread is None:
            return StressErrors.of_grid(np.full((3, 3, len(places)), self._rest[0]), self.unit)
        reading = self._reader(places, np.zeros_like(places), 0.0)
        return self._spread.errors(reading, self._spread.is_measured(places), self.unit)

    @cached_property
    def error(self) -> float:
        """The largest of `errors.total`: one standard error of a stress component at any node."""
        return float(np.nanmax(self.errors.total, initial=0.0))

    @cached_property
    def energy_error(self) -> float:
        """Error of the energy from the same causes as `error`."""
        if self._spread is None:
            return self._rest[1]

        def read(cell: Cell, waves: np.ndarray, modes: np.ndarray) -> np.ndarray:
            return np.array(self._energy(modes, cell, waves))

        return float(self._spread.errors(read).total)

    # -- units and files --------------------------------------------------------------------------

    @property
    def unit(self) -> str:
        """Unit of stresses, the unit of the elastic constants."""
        return self.constants.unit

    @property
    def length_unit(self) -> str:
        """Unit of lengths, if the source states it."""
        return "" if isinstance(self.source, DislocationNetwork) else self.source.unit

    @property
    def energy_unit(self) -> str:
        """Unit of the energy, if the units of stress and length are known."""
        return f"{self.unit} {self.length_unit}^3" if self.unit and self.length_unit else ""

    def to_xarray(self) -> Any:  # xarray is not a dependency
        """Stress, strain and distortion as an xarray Dataset over x, y, z.

        Raises
        ------
        GridError
            The edges of the cell are not along the coordinates.
        MissingExtraError
            xarray is not installed.
        """
        remarks = {
            "energy": self.energy, "error": self.error, "unit": self.unit,
            "length_unit": self.length_unit, "corrections": " ".join(self.corrections),
        }  # fmt: skip
        fields = {"stress": self.stress, "strain": self.strain, "distortion": self.distortion}
        return stress_dataset(self.cell, fields, remarks)

    def save(self, path: str | Path) -> None:
        """Write .vtk for ParaView (any cell), or .nc through xarray.

        Raises
        ------
        GridError
            The name has another ending, or the cell does not fit the format.
        """
        file = checks.file_name(path)
        checks.choice(ending(file), [".vtk", ".nc"], "ending of the file name", GridError)
        with written(file) as target:
            if ending(file) == ".vtk":
                fields = {"stress": self.stress, "strain": self.strain}
                target.write_bytes(vtk_bytes(self.cell, self.mises, fields))
            else:
                self.to_xarray().to_netcdf(target, engine="h5netcdf")

    _repr_html_ = drawn_by("stress", "stress_html")
    plot: ClassVar[Plot] = figure_by("stress", "draw_stress")


def stresses(
    source: Source,
    constants: ElasticConstants,
    *,
    shape: int | Sequence[int] | None = None,
    core: float | None = None,
    gauge: float = 0.0,
    mean_stress: Sequence[Sequence[float]] | np.ndarray | None = None,
    balance: bool = False,
    convention: str = "SF/RH",
) -> Stresses:
    """Stress of a torsion, from the coframe of least elastic energy with this torsion.

    Equation
    --------
    eps^{kab} d_a beta_ib = alpha^{ik}, d_j (C_ijlm beta_lm) = 0 in a periodic cell, with the alpha
    of b = closed integral of du; for a wave k
    beta = i k x alpha / k^2 + i u k with (C k k) u = i k C (i k x alpha / k^2)
    [Kroener, Kontinuumstheorie der Versetzungen und Eigenspannungen, 1958]. In the gauge theory of
    dislocations alpha is divided by 1 + l^2 k^2 [Lazar, J. Phys. A 36 (2003) 1415].

    Parameters
    ----------
    source
        A network of lines in a periodic box; a periodic coframe on a grid without holes; or a Nye
        field. Strains are taken as small, about the mean of the coframe.
    constants
        Elastic constants in the axes of the sample.
    shape
        Networks: number of nodes along each edge, or along the longest edge. One node along an
        edge is enough if all lines run along it. Fields have the nodes of their data. The shortest
        wave on an even number of nodes has no derivative there and is omitted.
    core
        Width of a Gaussian over which the torsion is spread, in units of length; of a line, at
        least one step of the grid. The default is two steps for lines, and 0 for fields.
    gauge
        Length l of the gauge theory, in which the stress of a line is finite; 0: no gauge theory.
    mean_stress
        Mean of the stress over the cell, shape (3, 3), such as a load; the default is 0.
    balance
        Whether to spread a net b through the cell evenly, with opposite sign, instead of refusing
        the source.
    convention
        The sign of the Burgers vectors of the source, see `conventions.burgers`: "Hirth-Lothe" for
        files of ParaDiS, ExaDiS and OpenDiS. The sign of the stress follows it; energy and forces
        do not depend on it.

    Raises
    ------
    NetworkError
        Lines end, the box is not periodic, b does not have three components, or the core is
        narrower than a step.
    GridError
        The field is not periodic or has holes, or a net b pierces the cell.

    Examples
    --------
    A square loop in copper shrinks: the force on its first side points inwards.

    >>> from geomtorsion.materials.lines import Box, LineArrays
    >>> corners = [[1, 1, 2], [3, 1, 2], [3, 3, 2], [1, 3, 2]]
    >>> sides = [[0, 1], [1, 2], [2, 3], [3, 0]]
    >>> box = Box.of_bounds([0, 0, 0], [4, 4, 4])
    >>> net = DislocationNetwork.of_arrays(LineArrays(corners, sides, [[0, 0, 0.1]] * 4, box))
    >>> copper = ElasticConstants.cubic(168.4, 121.4, 75.4, unit="GPa")
    >>> loop = stresses(net, copper, shape=16, core=0.4)
    >>> loop
    Stresses(16 x 16 x 16 nodes, largest stress 3.349 GPa, energy 0.287283)
    >>> (loop.forces[0].round(4) + 0).tolist(), loop.error < 1e-6 * loop.largest
    ([0.0, 0.0515, 0.0], True)
    """
    checks.instance(constants, ElasticConstants, "constants")
    kind = "a length, 0 or positive"
    length = checks.not_negative(gauge, "gauge", GridError, expected=kind)
    width = None if core is None else checks.not_negative(core, "core", GridError, expected=kind)
    checks.flag(balance, "balance", GridError)
    load = np.zeros((3, 3)) if mean_stress is None else mean_stress
    load = checks.array(load, "mean_stress", GridError, shape=(3, 3))
    if not np.allclose(load, load.T, rtol=1e-9, atol=0):
        raise GridError(
            f"mean_stress: expected a symmetric matrix, got {checks.shown(load.tolist())}."
        )
    # b of the crystal in the sense of du, over b of the source.
    sign = int(in_convention(in_convention([1], convention), "Hirth-Lothe")[0])
    if isinstance(source, DislocationNetwork):
        cell, torsion, texts = of_network(source, shape, width, balance=balance, sign=sign)
    else:
        if shape is not None:
            raise GridError(
                f"shape: expected none for a field, which has its nodes, got {checks.shown(shape)}."
            )
        if isinstance(source, SampledFrame):
            cell, torsion, texts = of_frame(source, width or 0.0, sign=sign)
        elif isinstance(source, NyeField):
            cell, torsion, texts = of_nye(source, width or 0.0, balance=balance, sign=sign)
        else:
            raise ArgumentError(
                "source: expected a DislocationNetwork, a SampledFrame or a NyeField, got "
                f"{checks.shown(source)}."
            )
    return Stresses(source, constants, cell, torsion.core, length, load, convention, texts, torsion)

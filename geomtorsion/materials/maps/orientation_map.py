"""Orientation map: measured crystal orientations as a coframe, and circuits in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from geomtorsion.errors import FileFormatError, GeomtorsionError, OrientationError
from geomtorsion.loops import Cochain, Loop
from geomtorsion.materials.burgers import PLANE, Section
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.grid_circuits import unexplained
from geomtorsion.materials.maps.curvature import Curvature, curvature_of
from geomtorsion.materials.maps.grain_frames import frame_of_grain
from geomtorsion.materials.maps.lattice_edges import (
    GrainMap,
    estimated_covariance,
    given_covariance,
    grains_of,
    spread_of,
)
from geomtorsion.materials.maps.map_formats import read_map_file
from geomtorsion.materials.maps.phases import Phase
from geomtorsion.materials.maps.pixel_circuits import Circuit, circuit_of
from geomtorsion.materials.maps.results import MapBurgers, angstrom_in
from geomtorsion.materials.maps.slip import FAMILIES as SLIP
from geomtorsion.materials.maps.squares import COMPONENTS, survey_of_squares
from geomtorsion.materials.maps.step_grid import StepGrid, two_steps
from geomtorsion.materials.maps.symmetry import conjugated
from geomtorsion.materials.source import Backdrop
from geomtorsion.materials.survey import Survey
from geomtorsion.rigid.attitude import (
    checked_matrix,
    matrix_from_quaternion,
    product,
    quaternion_from_euler,
)
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

Steps = float | Sequence[float]


@dataclass(frozen=True, eq=False, repr=False)
class OrientationMap:
    """Crystal orientations on a grid of pixels, such as an EBSD map.

    Equation
    --------
    e^i_mu = R^i_mu, the rotation from specimen to crystal: the coframe of a crystal that is
    rotated but hardly strained. b^i = closed integral of e^i_mu dx^mu within a grain, by the
    trapezoidal rule from pixel to pixel.

    quaternions: rotation from crystal axes to specimen axes (the inverse of Bunge's g), scalar
        first, shape (rows, columns, 4). x runs along rows of pixels, y along columns; the specimen
        axes are the axes of the map.
    phase: number of the phase of each pixel, 0 where nothing is known, shape (rows, columns).
    phases: number -> Phase.
    steps: from pixel to pixel along x and y, in `unit`.
    shift: of every second row along x, as a share of the step: 0 for square grids, 1/2 (or -1/2)
        for hexagonal grids.
    threshold: degrees; neighbours that differ by less belong to one grain.
    sigma: standard deviation of the noise of an orientation about each of the map axes, degrees,
        one number or three. If None, it is estimated from sixth differences for each phase.
    unit: of lengths.
    slip: the structure (such as "fcc") whose slip systems make up b in `MapBurgers.facts`; empty
        for none.

    Raises
    ------
    OrientationError
        Shapes do not fit, a number is not finite, or nothing is known at any pixel.

    Examples
    --------
    A wall of edge dislocations: the lattice turns by 5 degrees at the middle.

    >>> angles = np.zeros((21, 40, 3))
    >>> angles[:, 20:, 0] = 5.0
    >>> wall = OrientationMap.from_euler(angles, 0.5, "m-3m", threshold=10, sigma=0)
    >>> b = wall.burgers(Circuit.rectangle((0, 10), 20, 20))
    >>> b.magnitude / 10, 2 * np.sin(np.radians(2.5))
    (0.08723877473067..., np.float64(0.08723877473067...))
    """

    quaternions: np.ndarray
    phase: np.ndarray
    phases: Mapping[int, Phase]
    steps: tuple[float, float] = (1.0, 1.0)
    shift: float = 0.0
    threshold: float = 5.0
    sigma: float | Sequence[float] | None = None
    unit: str = "um"
    slip: str = ""

    def __post_init__(self) -> None:
        """Check shapes and numbers."""
        q = checks.array(
            self.quaternions, "quaternions", OrientationError, shape=(None, None, 4), infinite=None
        )
        phase = checks.array(self.phase, "phase", OrientationError, shape=(None, None))
        phases = checks.table(self.phases, "phases", OrientationError)
        for number, value in phases.items():
            checks.count(number, "number of a phase", OrientationError, 1)
            checks.instance(value, Phase, f"phase {number}", OrientationError)
        if phase.shape != q.shape[:2] or min(phase.shape) < 2:
            raise OrientationError(
                f"phase: expected shape {q.shape[:2]}, at least (2, 2), got {phase.shape}."
            )
        if not np.isin(phase, [0, *phases]).all():
            strange = phase[~np.isin(phase, [0, *phases])][0]
            raise OrientationError(
                f"phase: expected one of {sorted(phases)} for each pixel, got {strange:g}. "
                "Describe it in phases, or put 0 at pixels without an orientation."
            )
        length = np.linalg.norm(checks.measured(q, "quaternions", OrientationError), axis=-1)
        indexed = phase > 0
        bad = indexed & ~(np.isfinite(length) & (length > 0))
        if bad.any():
            raise OrientationError(
                f"quaternions: expected finite numbers, not all 0, got {q[bad][0].tolist()} at "
                f"pixel {tuple(np.argwhere(bad)[0].tolist())}. Put phase 0 there, or correct them."
            )
        if not indexed.any():
            raise OrientationError(
                "phase: expected a phase for each pixel, got 0 (no orientation) for all."
            )
        unit = np.zeros(4)
        unit[0] = 1.0
        with np.errstate(invalid="ignore", divide="ignore"):
            q = np.where(indexed[..., None], q / length[..., None], unit)
        steps = two_steps(self.steps)
        shift = checks.number(self.shift, "shift", OrientationError)
        if abs(shift) not in (0, 0.5):
            raise OrientationError(
                f"shift: expected 0, or 1/2 or -1/2 for hexagonal grids, got {shift:g}. Export the "
                "map on such a grid."
            )
        threshold = checks.positive(self.threshold, "threshold", OrientationError)
        angstrom_in(self.unit)
        if self.slip:
            checks.known_name(self.slip, SLIP, "slip", OrientationError)
        if self.sigma is not None:
            given_covariance(self.sigma)
        for key, value in (
            ("quaternions", q), ("phase", phase.astype(np.int64)), ("phases", dict(phases)),
            ("steps", steps), ("shift", shift), ("threshold", threshold),
        ):  # fmt: skip
            object.__setattr__(self, key, value)

    # -- makers -----------------------------------------------------------------------------------

    @classmethod
    def read(
        cls,
        path: str | Path,
        *,
        laue: Mapping[int, str] | None = None,
        columns: Mapping[str, int | str] | None = None,
        slice: int | str | None = None,
        axes: Sequence[Sequence[float]] | np.ndarray | None = None,
        threshold: float = 5.0,
        sigma: float | Sequence[float] | None = None,
        slip: str = "",
    ) -> OrientationMap:
        """Read a .ctf, .ang, .cpr or .h5oina file, a text table, or HDF5; lengths in um.

        A .cpr file needs its .crc file in the same folder. A table (.txt, .csv) has a row of names:
        phi1, Phi, phi2, x, y and optionally phase. Its angles are in degrees unless a name has the
        unit (rad), and it needs `laue`. HDF5 needs h5py. Positions decide if a header disagrees
        with them. Angles are in degrees in .ctf files and in radians in .ang files, as instruments
        write them. If a map shows one grain, or noise, instead of several, check the unit.

        Parameters
        ----------
        laue
            Number of a phase (0: all others) -> its Laue group, if not correct in the file.
        columns
            Tables: quantity (phi1, Phi, phi2, x, y, phase) -> name or number of its column, such as
            {"phi1 (rad)": 0}. HDF5: -> path of its data set; euler for all angles.
        slice
            Number or name of one of several maps in an HDF5 file.
        axes
            Rotation from the axes of the map (x along rows, y along columns) to the axes of the
            Euler angles, shape (3, 3); by default these are the same, but not for all instruments.
            It changes b in specimen axes and the directions of the steps in the crystal.
        threshold, sigma, slip
            As for the class.

        Raises
        ------
        FileFormatError
            The file is truncated, or has wrong columns, mixed steps or an unknown phase; the
            message names file, line and remedy.
        """
        path = checks.file_name(path)
        file = read_map_file(path, laue, columns, slice)
        if not (file.phase > 0).any():
            raise FileFormatError(
                f"{path.name}: expected pixels with an orientation, got phase 0 (not indexed) for "
                "all. Export a map with orientations."
            )
        q = quaternion_from_euler(file.euler, "ZXZ")
        if axes is not None:
            try:
                turn = checked_matrix(axes)
            except GeomtorsionError as error:
                raise OrientationError(f"axes: {error}") from None
            q = product(conjugated(turn), q)
        return cls(
            q, file.phase, file.phases, file.steps, file.shift, threshold=threshold, sigma=sigma,
            slip=slip,
        )  # fmt: skip

    @classmethod
    def from_euler(
        cls,
        angles: np.ndarray | Sequence[Sequence[Sequence[float]]],
        steps: Steps,
        phase: Phase | str,
        *,
        threshold: float = 5.0,
        sigma: float | Sequence[float] | None = None,
        unit: str = "um",
    ) -> OrientationMap:
        """Map of one phase from Bunge's angles phi1, Phi, phi2 in degrees; NaN where unknown.

        Parameters
        ----------
        angles
            Shape (rows, columns, 3).
        phase
            A Phase, or the name of a Laue group.
        """
        euler = checks.array(
            angles, "angles", OrientationError, shape=(None, None, 3), infinite=None
        )
        indexed = np.asarray(np.isfinite(euler).all(axis=-1))
        entry = phase if isinstance(phase, Phase) else Phase("crystal", phase)
        q = quaternion_from_euler(np.radians(np.where(indexed[..., None], euler, 0.0)), "ZXZ")
        return cls(
            q, indexed.astype(int), {1: entry}, two_steps(steps), threshold=threshold, sigma=sigma,
            unit=unit,
        )  # fmt: skip

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns of pixels."""
        rows, columns = self.phase.shape
        return rows, columns

    @cached_property
    def grains(self) -> GrainMap:
        """Grains, and the symmetry variants chosen along their spanning trees."""
        groups = {number: phase.group for number, phase in self.phases.items()}
        return grains_of(self.quaternions, self.phase, groups, np.radians(self.threshold))

    @property
    def grain(self) -> np.ndarray:
        """Number of the grain of each pixel, -1 where nothing is known, shape (rows, columns)."""
        return self.grains.grain

    @cached_property
    def coframe(self) -> np.ndarray:
        """e^i_mu in the variant of each grain, for mu = x, y, shape (rows, columns, 3, 2)."""
        return matrix_from_quaternion(conjugated(self.grains.quaternions))[..., :2]

    @cached_property
    def noise(self) -> dict[int, np.ndarray]:
        """Phase -> covariance of the noise of an orientation, map axes, rad^2, shape (3, 3).

        Raises
        ------
        OrientationError
            No grain has seven pixels in a row, which the estimate needs.
        """
        if self.sigma is not None:
            return dict.fromkeys(self.phases, given_covariance(self.sigma))
        covariances = {}
        for number in self.phases:
            mine = self.phase == number
            if mine.any():
                try:
                    covariances[number] = estimated_covariance(self.grains, mine)
                except OrientationError:
                    # The phase has too few pixels in a row, so all phases together are used.
                    covariances[number] = estimated_covariance(self.grains, self.phase > 0)
        return covariances

    @cached_property
    def curvature(self) -> Curvature:
        """Lattice curvature within grains, which gives five components of the Nye tensor."""
        q, most = self.grains.quaternions, np.radians(self.threshold)
        return curvature_of(q, self.grain, self.steps, self.shift, most, self.unit)

    def gnd_density(self, burgers: float) -> tuple[np.ndarray, np.ndarray]:
        """Density of geometrically necessary dislocations from the curvature, and its noise floor.

        Both have shape (rows, columns) and are in lines per square of `unit`; see
        `Curvature.gnd_density`.

        burgers: length of the Burgers vector, in `unit`: 0.25e-3 um for 0.25 nm.
        """
        density = self.curvature.gnd_density(burgers)
        return density, self.curvature.floor(burgers, self.phase, self.noise)

    def frame(self, grain: int, order: int = 2) -> SampledFrame:
        """The coframe of one grain as a sampled frame, for curved loops and the Nye tensor.

        The Nye tensor of a plane frame has only the three components of lines normal to the map.
        `curvature` has the components of a bend about an axis in the plane.

        A node is [column, row]; pixels of other grains are holes. The rows of the coframe are
        crystal axes. Its sigma is the noise of the phase, averaged over the axes and assumed
        independent in each component. The coframe of a hexagonal grid is interpolated along its
        rows, to columns halfway between even and odd rows.

        Parameters
        ----------
        grain
            Number of the grain in `grain`.
        order
            Order of the interpolation, as for `SampledFrame`.

        Raises
        ------
        OrientationError
            There is no such grain.

        Examples
        --------
        >>> bent = np.zeros((9, 9, 3))
        >>> bent[..., 0] = np.arange(9) / 10
        >>> crystal = OrientationMap.from_euler(bent, 1.0, "m-3m", sigma=0)
        >>> crystal.frame(0).nye[0, 0, 4, 4].round(6), np.radians(0.1).round(6)
        (np.float64(0.001745), np.float64(0.001745))
        """
        number = checks.count(grain, "grain", OrientationError, 0, self.grains.count - 1)
        mine = self.grain == number
        covariance = self.noise[int(self.phase[mine][0])]
        sigma = float(np.sqrt(np.trace(covariance) / 3))
        return frame_of_grain(self.coframe, mine, self.steps, self.shift, order, sigma, self.unit)

    # -- circuits ---------------------------------------------------------------------------------

    @cached_property
    def _grid(self) -> StepGrid:
        """The steps between pixels."""
        return StepGrid(self.grains, self.coframe, self.steps, self.shift, self.threshold)

    @property
    def cochain(self) -> Cochain:
        """The steps within grains as a cochain: nodes are pixels, numbered row by row.

        Its spanning forest gives all fundamental cycles of all grains. Sums over a chain are exact
        up to rounding. Its errors do not include noise: `burgers` estimates the noise.
        """
        return self._grid.cochain

    def circuit(self, loop: Loop) -> Circuit:
        """The circuit around the cells whose middles a loop surrounds.

        Parameters
        ----------
        loop
            A loop in the plane; x and y are in `unit`, from the first pixel.

        Raises
        ------
        OrientationError
            The loop leaves the map, or surrounds no cell.
        """
        return circuit_of(loop, self.shape, self.steps, self.shift, self.unit)

    def burgers(self, circuit: Circuit | Loop) -> MapBurgers:
        """Burgers vector of a circuit within a grain, around pixels that are not indexed.

        `MapBurgers.detour` holds these pixels, the change of the area, and the added error.

        Parameters
        ----------
        circuit
            A Circuit from pixel to pixel, or a Loop in the plane, which gives the circuit around
            its cells.

        Raises
        ------
        OrientationError
            The circuit leaves the map or its grain; the message names pixels.
        """
        if isinstance(circuit, Loop):
            circuit = self.circuit(circuit)
        checks.instance(circuit, Circuit, "circuit")
        grid = self._grid
        chain, passages = grid.chain(circuit)
        vector = grid.total(chain)
        first = tuple(chain.starts[0].tolist() if len(passages) else circuit.starts[0].tolist())
        number = int(self.phase[first])
        detour = grid.detour(circuit, chain, passages, self.noise[number])
        circuit = chain.named(circuit.name) if len(passages) else circuit
        covariance = spread_of(grid.moments(chain), self.noise[number])
        spread = np.trace(spread_of(grid.bent_moments(chain), self.noise[number]))
        bend = unexplained(np.asarray(np.linalg.norm(grid.bend(chain))), spread)
        rotation = matrix_from_quaternion(self.grains.quaternions[first])
        return MapBurgers(
            vector=vector,
            unit=self.unit,
            covariance=rotation.T @ covariance @ rotation,
            systematic={"interpolation": float(bend)} | (detour.errors if detour else {}),
            name=circuit.name or "loop",
            path=grid.path(circuit),
            area=grid.area(chain),
            arrow=(rotation @ vector)[:2],
            components=COMPONENTS,
            length_unit=self.unit,
            detour=detour,
            circuit=circuit,
            rotation=rotation,
            grain=int(self.grain[first]),
            phase=self.phases[number],
            structure=self.slip,
        )

    def burgers_map(self, size: int, plane: tuple[int, int] = (0, 1)) -> Survey:
        """Burgers vectors of the square circuits of size x size cells at all positions.

        The cost does not depend on the size. The components of b refer to crystal axes, the arrows
        to specimen axes. Squares go around pixels that are not indexed, as in `burgers`.

        Raises
        ------
        OrientationError
            The size is below 1 or larger than the map, or the plane is not x and y.
        """
        if tuple(plane) != (0, 1):
            raise OrientationError(
                "plane: expected x and y, the only plane of an orientation map. Omit the option."
            )
        most = min(self.shape) - 1
        n = checks.count(size, "size", OrientationError, 1, most)
        return survey_of_squares(
            self._grid, self.phase, partial(getattr, self, "noise"), n, self.unit
        )

    # -- as a source ------------------------------------------------------------------------------

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the axes."""
        return ("x", "y")

    @property
    def description(self) -> tuple[str, ...]:
        """Lines of text about the size, the grains and the noise of the map."""
        grains = self.grains.count
        origin = "estimated from sixth differences" if self.sigma is None else "given"
        noise = [
            # About one axis, from the mean variance of the three axes.
            f"{np.degrees(np.sqrt(np.trace(one) / 3)):.3g} degrees in {self.phases[number].name}"
            for number, one in self.noise.items()
        ]
        return (
            repr(self),
            (
                f"{grains} grain{'s' * (grains != 1)} at {self.threshold:g} degrees, "
                f"{float((self.phase == 0).mean()):.1%} of the pixels not indexed"
            ),
            f"noise: {', '.join(noise)} ({origin})",
        )

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """The grains of the map; its only plane is the section."""
        rows, columns = self.shape
        # Columns of a hexagonal grid are drawn halfway between the even and the odd rows.
        x = self.steps[0] * (np.arange(columns) + self.shift / 2)
        values = np.where(self.grain < 0, np.nan, self.grain).T
        title = f"grains at {self.threshold:g} degrees"
        return Backdrop((x, self.steps[1] * np.arange(rows)), values, "grains", title, down=True)

    def __repr__(self) -> str:
        rows, columns = self.shape
        names = ", ".join(phase.name for phase in self.phases.values())
        step = f"{self.steps[0]:g} {self.unit}"
        return f"OrientationMap({rows} x {columns} pixels, step {step}, {names})"

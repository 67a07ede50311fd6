"""Derivatives of a curve: what may vary, and how its start changes with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from geomtorsion.curves.atlas import ElementMatrix
from geomtorsion.curves.equations import velocity_names
from geomtorsion.curves.transported import Derivatives
from geomtorsion.errors import ExpressionError, StartError
from geomtorsion.geometry import Frame
from geomtorsion.ode.derivatives import checked_by
from geomtorsion.ode.numbers import Real
from geomtorsion.support import checks
from geomtorsion.support.precision import EXACT_BITS


@dataclass(frozen=True, eq=False)
class Beginning:
    """Numbers at the start of a curve; the fields are named as in `CurveProblem`.

    coordinates: names of the coordinates, none where only velocities are followed.
    """

    frame: Frame
    coordinates: tuple[str, ...]
    start: tuple[Real, ...]
    frame_velocity: tuple[Real, ...]
    coordinate_velocity: tuple[Real, ...] | None
    parameters: Mapping[str, Real]

    @property
    def speeds(self) -> tuple[str, ...]:
        """Names of the velocities that were given: r', ... or u1, u2, ..."""
        if self.coordinate_velocity is None:
            return velocity_names(self.frame)
        return tuple(f"{name}'" for name in self.coordinates)

    @property
    def variables(self) -> dict[str, Real]:
        """Parameters and numbers at the start by name, as they were given."""
        place = zip(self.coordinates, self.start, strict=True)
        given = self.coordinate_velocity or self.frame_velocity
        return {**self.parameters, **dict(place), **dict(zip(self.speeds, given, strict=True))}

    def changed(self, values: Mapping[str, Real]) -> tuple[dict[str, Real], list[Real], list[Real]]:
        """Parameters, start and given velocity with some new numbers."""
        table = checks.known_keys(values, self.variables, "values", StartError)
        every = self.variables | table
        return (
            {name: every[name] for name in self.parameters},
            [every[name] for name in self.coordinates],
            [every[name] for name in self.speeds],
        )

    def derivatives(self, by: object) -> Derivatives:
        """Derivatives by some of the variables, at the start.

        Raises
        ------
        UnknownNameError, StartError, ExpressionError
            A name is unknown or repeated, or the name of a derivative is taken.
        """
        words = checked_by(by, tuple(self.variables), "derivatives")
        varied = (*self.coordinates, *velocity_names(self.frame))
        columns = tuple(self._column(word) for word in words)
        derivatives = Derivatives(words, varied, columns, len(self.coordinates))
        clash = {*self.parameters, *varied, "t"} & set(derivatives.names())
        if clash:
            raise ExpressionError(
                f"derivatives: expected {min(clash)} to be free for a derivative, got a coordinate "
                "or parameter of this name. Rename it."
            )
        return derivatives

    def _column(self, by: str) -> tuple[Real, ...]:
        """Derivatives of coordinates and frame velocities at the start."""
        place = [int(name == by) for name in self.coordinates]
        rates, n = self.coordinate_velocity, self.frame.dimension
        if rates is None:
            return (*place, *(int(name == by) for name in self.speeds))
        # The coordinate velocity was given: u^i = e^i_mu q'^mu changes with the coframe.
        entries = self.frame.coframe.components.nonzero
        vector: Sequence[Real] = [int(name == by) for name in self.speeds]
        if not any(vector):
            vector, slopes = rates, {}
            for index, element in entries.items():
                symbol = next((s for s in element.field.symbols if s.name == by), None)
                if symbol is not None:
                    slopes[index] = element.diff(symbol)
            entries = slopes
        point = dict(zip(self.coordinates, self.start, strict=True)) | dict(self.parameters)
        return (*place, *ElementMatrix(entries, (n, n)).precisely(point, vector, EXACT_BITS))

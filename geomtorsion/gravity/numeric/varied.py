"""Varied: the fields of each kind of geometry as power series, and the equations that vary them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.geometry import Connection, Frame, Tensor, cartan, levi_civita
from geomtorsion.geometry.numeric.frames import numeric_frame
from geomtorsion.geometry.numeric.numeric_field import Numeric, NumericField
from geomtorsion.geometry.numeric.power_series import PowerSeries

Place = tuple[int, ...]
# Components of each of some fields.
Potentials = Sequence[Sequence[Tensor]]


@dataclass(frozen=True)
class Varied:
    """The fields that a kind of geometry varies in some dimension.

    coframe: places (i, mu) of the coframe that vary; other entries are 1 or 0.
    turning: places (a, i, j) of the spin connection omega_aij that vary, antisymmetric in ij.
    connection: of a frame; None for a spin connection of its own.
    rows: the equations, by the names of `FieldEquations.tensors`, with their places.
    gauge: pairs (number of gauge functions, derivatives with which they enter the fields).
    """

    coframe: tuple[Place, ...]
    turning: tuple[Place, ...]
    connection: Callable[[Frame], Connection] | None
    rows: Mapping[str, tuple[Place, ...]]
    gauge: tuple[tuple[int, int], ...]


def _coincident(frame: Frame) -> Connection:
    """The connection whose coefficients vanish in these coordinates."""
    zero = Tensor(frame, "ddu", {}, (), "\\Gamma", "", anchored=(1, 2))
    return Connection(frame, zero, "coincident connection", "general")


def varied(geometry: str, n: int) -> Varied:
    """The fields and equations of a kind of geometry."""
    every = tuple(product(range(n), repeat=2))
    lower = tuple((i, mu) for i, mu in every if i >= mu)
    turning = tuple((a, i, j) for a in range(n) for i, j in combinations(range(n), 2))
    rotations = n * (n - 1) // 2
    if geometry == "flat":
        return Varied((), (), levi_civita, {}, ())
    if geometry == "riemannian":
        # Rotations of the legs are used up by the zeros of the coframe.
        return Varied(lower, (), levi_civita, {"E_(ij)": lower}, ((n, 1),))
    if geometry == "teleparallel":
        return Varied(every, (), cartan, {"E": every}, ((n, 1),))
    if geometry == "symmetric teleparallel":
        return Varied(lower, (), _coincident, {"M": lower}, ())
    gauge = ((n, 1), (rotations, 1))
    return Varied(every, turning, None, {"E": every, "C": turning}, gauge)


@dataclass(frozen=True, eq=False)
class Setting:
    """A theory whose fields are power series.

    kind: the varied fields. coordinates: in order. constants: values by name.
    equations: makes field equations from connections and fields of matter.
    scalars, vectors, two_forms: numbers of these fields.
    unit: the size of coefficients in the Lagrangian; equations are multiples of it.
    """

    kind: Varied
    coordinates: tuple[sp.Symbol, ...]
    constants: Mapping[str, float]
    equations: Callable[[Connection, Sequence[Tensor], Potentials, Potentials], Any]
    scalars: int
    vectors: int
    two_forms: int
    unit: Fraction = Fraction(1)

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return len(self.coordinates)

    @property
    def size(self) -> int:
        """Number of fields."""
        own = len(self.kind.coframe) + len(self.kind.turning)
        pairs = self.dimension * (self.dimension - 1) // 2
        return own + self.scalars + self.dimension * self.vectors + pairs * self.two_forms

    def theory(self, series: PowerSeries, fields: np.ndarray, *, moving: bool = True) -> Any:
        """The field equations at power series of the fields; moving: with their operators."""
        n = self.dimension
        field = NumericField(self.coordinates, series, dict(self.constants))
        elements = []
        for k, row in enumerate(fields):
            slope = None
            if moving:
                slope = np.zeros((len(fields), 1, series.size))
                slope[k, 0, 0] = 1.0
            elements.append(Numeric(field, row, slope))
        start = iter(elements)
        coframe = {(i, i): field.one for i in range(n)} | {
            place: next(start) for place in self.kind.coframe
        }
        eta = {(i, i): field.rational(-1 if i == 0 else 1) for i in range(n)}
        empty = Frame(self.coordinates, np.eye(n, dtype=int).tolist(), (-1,) + (1,) * (n - 1))
        frame = numeric_frame(empty, field, {"coframe": coframe, "eta": eta})
        turning = {place: next(start) for place in self.kind.turning}
        make = self.kind.connection
        connection = make(frame) if make else _turned(frame, turning)
        scalars = [_scalar(frame, next(start)) for _ in range(self.scalars)]
        vectors = [[_scalar(frame, next(start)) for _ in range(n)] for _ in range(self.vectors)]
        pairs = range(n * (n - 1) // 2)
        forms = [[_scalar(frame, next(start)) for _ in pairs] for _ in range(self.two_forms)]
        return self.equations(connection, scalars, vectors, forms)

    def residuals(self, series: PowerSeries, fields: np.ndarray) -> list[Numeric]:
        """All equations that vary the fields."""
        theory = self.theory(series, fields)
        listed = []
        for name, places in self.kind.rows.items():
            tensor = theory.symmetric if name == "E_(ij)" else theory.tensors[name]
            listed += [tensor.components.get(place) for place in places]
        for tensor in theory.matter_equations.values():
            indices = product(range(self.dimension), repeat=len(tensor.slots))
            listed += [tensor.components.get(index) for index in indices]
        return [one.field.scaled(one, 1 / self.unit) for one in listed]


def _scalar(frame: Frame, element: Numeric) -> Tensor:
    return frame.scalar(lambda: element)


def _turned(frame: Frame, turning: Mapping[Place, Numeric]) -> Connection:
    """A metric connection from omega_aij with all indices down but a in coordinates."""
    lower: dict[Place, Any] = dict(turning)
    lower |= {(a, j, i): -x for (a, i, j), x in turning.items()}
    spin = Tensor(frame, "dDD", lower).raised(2)
    bent = Tensor(frame, "dDU", spin.components)._with_slot(1, "d").components.get
    derivative, legs = frame.coframe_derivative.get, frame.legs.components

    def rule(index: Place) -> Any:
        a, b, c = index
        terms: list[tuple[Any, ...]] = []
        for j, leg in legs.rows[c]:
            terms += [(1, leg, derivative((a, j, b))), (1, leg, bent((a, b, j)))]
        return frame.field.sum(terms)

    coefficients = Tensor(frame, "ddu", rule, (), "\\Gamma", "", anchored=(1, 2))
    return Connection(frame, coefficients, "connection", "metric")

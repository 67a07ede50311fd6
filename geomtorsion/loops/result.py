"""Result: a Burgers vector with its error, how it was found, and what it cost."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from geomtorsion.conventions import Signed
from geomtorsion.loops import validation
from geomtorsion.loops.arcs import Number
from geomtorsion.loops.defects import EnclosedDefect, enclosed_defects
from geomtorsion.loops.frame_vector import FrameVector
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import ByContent
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.hints import attribute_hints
from geomtorsion.support.outgoing import size_text

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.loops.loop import Loop


@dataclass(frozen=True, eq=False)
class Check(ByContent):
    """The two independent routes side by side.

    line, flux: b^i by each route, shape (n,); flux is None if the torsion has a defect inside.
    line_error, flux_error: their own error estimates.
    agrees: True, False, or None if only one route exists.
    text: the comparison in words.
    """

    line: np.ndarray
    line_error: float
    flux: np.ndarray | None
    flux_error: float | None
    agrees: bool | None
    text: str

    @property
    def difference(self) -> np.ndarray | None:
        """Line minus flux, shape (n,): the part of enclosed defects if the routes disagree."""
        return None if self.flux is None else self.line - self.flux

    def __str__(self) -> str:
        return self.text


@attribute_hints(norm="abs(b)", value="b.vector")
@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class BurgersVector(ByContent, Signed, FrameVector):
    """The Burgers vector of one loop, frame components.

    frame, loop: the frame and the loop of the vector.
    reduced: b^i / size**power, shape (n,): finite even where b itself is below all doubles.
    reduced_error: bound on the error of its largest component, in the same unit.
    size, power: the unit: the size of the loop, and 1 or 2.
    route: "line", "flux", or "line and flux" where the parts of the loop needed different ones.
    reason: why this route was chosen, in words.
    check: the other route, and whether both agree.
    accuracy: the requested relative error.
    evaluations: points at which coframe or curl were evaluated; seconds: wall time.
    parameters: the values of the frame's parameters, by name.

    It is an array of its components for NumPy; sums and multiples have errors as well.
    """

    frame: Frame
    loop: Loop
    reduced: np.ndarray
    reduced_error: float
    size: float
    power: int
    route: str
    reason: str
    check: Check
    accuracy: float
    evaluations: int
    # Two equal computations are equal, however long they took.
    seconds: float = field(compare=False)
    parameters: Mapping[str, Number]

    @property
    def reached(self) -> bool:
        """Whether the requested relative error was reached."""
        return self.relative_error <= self.accuracy

    @cached_property
    def enclosed(self) -> tuple[EnclosedDefect, ...]:
        """Enclosed defects with position and winding number, if line and flux disagree.

        A loop around a defect has a Burgers vector although the torsion vanishes all along it.
        """
        if self.check.agrees is not False:
            return ()
        return enclosed_defects(self.frame, self.loop, self.parameters)

    def in_coordinates(self, point: Sequence[float] | None = None) -> np.ndarray:
        """Coordinate components E_i^mu b^i at a point, shape (n,); None: the centre of the loop.

        Raises
        ------
        SingularPointError
            The legs have no finite value there.
        """
        place = (
            self.loop.centre
            if point is None
            else validation.vector(point, "point", self.frame.dimension)
        )
        values = dict(zip((s.name for s in self.frame.coordinates), place, strict=True))
        return self.frame.legs.at(self._named(values)) @ self.vector

    def __neg__(self) -> BurgersVector:
        """The Burgers vector of the reversed loop."""
        check = self.check
        flux = None if check.flux is None else 0.0 - check.flux
        return replace(
            self,
            loop=self.loop.reversed(),
            reduced=0.0 - self.reduced,
            check=replace(check, line=0.0 - check.line, flux=flux),
        )

    def to_json(self) -> dict[str, Any]:
        """Everything as plain values, ready for json.dumps."""
        flux = self.check.flux
        return {
            "loop": self.loop.name,
            "vector": _plain(self.vector),
            "error": self.error,
            "relative_error": self.relative_error if self.relative_error < math.inf else None,
            "reached": self.reached,
            "magnitude": self.magnitude,
            "reduced": _plain(self.reduced),
            "unit": {"size": self.size, "power": self.power},
            "route": self.route,
            "reason": self.reason,
            "check": {
                "agrees": self.check.agrees,
                "text": self.check.text,
                "enclosed": [str(one) for one in self.enclosed],
                "line": _plain(self.check.line),
                "line_error": self.check.line_error,
                "flux": None if flux is None else _plain(flux),
                "flux_error": self.check.flux_error,
            },
            "accuracy": self.accuracy,
            "evaluations": self.evaluations,
            "seconds": self.seconds,
        }

    _repr_html_ = drawn_by("notebook_pictures", "burgers_html")
    plot: ClassVar[Plot] = figure_by("loops", "draw_closure")

    def __repr__(self) -> str:
        parts = ", ".join(f"{x:.12g}" for x in self.vector.tolist())
        inside = "".join(f", enclosed defect: {one}" for one in self.enclosed)
        return (
            f"BurgersVector([{parts}], error={size_text(self.error)}, route={self.route!r}{inside})"
        )


def _plain(vector: np.ndarray) -> list[float | list[float]]:
    """Components as floats, or as [real, imaginary]."""
    values = vector.tolist()
    return [[x.real, x.imag] if isinstance(x, complex) else x for x in values]

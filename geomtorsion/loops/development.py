"""Development: the path-ordered closure failure of a loop, translation and rotation."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from geomtorsion.errors import ArgumentError
from geomtorsion.geometry import Connection
from geomtorsion.geometry.connections import ConnectionLike, as_connection
from geomtorsion.loops.affine_form import AffineForm, around_cone, line_rate
from geomtorsion.loops.affine_map import AffineMap
from geomtorsion.loops.arcs import Number, Parameters, Part
from geomtorsion.loops.defects import (
    Defect,
    EnclosedDefect,
    enclosed_defects,
    lines_alone,
    winds_around_line,
)
from geomtorsion.loops.domain import refuse_outside
from geomtorsion.loops.forms import perturbed
from geomtorsion.loops.integrals import DISAGREE, probes
from geomtorsion.loops.loop import Loop, check_loop
from geomtorsion.loops.poles import refuse_poles
from geomtorsion.loops.protocols import HasBurgers
from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.loops.symbol_values import with_numbers
from geomtorsion.loops.transport import Transported, transported
from geomtorsion.loops.validation import check_accuracy
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.hints import argument_hints, attribute_hints
from geomtorsion.support.outgoing import measured_text


def along_line(form: AffineForm, part: Part, accuracy: float) -> Transported:
    """The development once along the line, with the effect of rounding the points.

    Raises
    ------
    SingularPointError
        The loop passes through a point where coframe or connection are singular.
    """
    cuts = refuse_poles(form.poles, part)
    result = transported(part.arcs, line_rate(form, part), accuracy, cuts)
    offsets, slopes, weights = probes(part.arcs, cuts)
    centre = np.array(part.centre)[:, None]
    points = centre + part.size * offsets
    here = form.along(points, part.size * slopes)
    moved = form.along(perturbed(points, centre), part.size * slopes)
    turn, shift = (
        float(weights @ np.abs(one - two).reshape(len(one), -1).max(axis=1))
        for one, two in zip(here, moved, strict=True)
    )
    if part.gap:
        start = np.array(part.base)
        result = replace(
            result, motion=result.motion @ back_by(form, start, part.size * np.array(part.gap))
        )
    return replace(
        result,
        error=result.error + ROUNDING * result.scale + shift + turn * result.scale,
        turn_error=result.turn_error + turn,
    )


def back_by(form: AffineForm, start: np.ndarray, gap: np.ndarray) -> AffineMap:
    """The turn from the legs at a point to those whole periods further on, at the same point."""
    here, there = form.coframe(start), form.coframe(start + gap)
    # Components of the legs at the start in those at the end: both sit at the same point.
    turn = np.linalg.solve(here.T, (there - here).T).T
    return AffineMap.of(turn, np.zeros(len(start)))


def _cone(form: AffineForm, part: Part, accuracy: float) -> Transported | None:
    """The development by the cone; None if the part has a gap or the cone is not smooth.

    Near a pole of unknown shape, which may or may not be inside, no cone is used.
    """
    frame, poles = form.connection.frame, form.poles
    if part.gap or (refuse_poles(poles, part) and not lines_alone(frame, poles, form.connection)):
        return None
    cone = around_cone(form, part, accuracy)
    return None if cone is None else repeated(cone, part.times)


def repeated(once: Transported, times: int) -> Transported:
    """The same path several times, or backwards."""
    motion = once.motion if times > 0 else once.motion.inverse
    total = motion
    for _ in range(abs(times) - 1):
        total = total @ motion
    share = abs(times)
    return Transported(
        total, share * once.error, share * once.turn_error, share * once.scale, once.points
    )


def joined(parts: Sequence[Transported]) -> Transported:
    """One path after the other."""
    total = parts[0]
    for part in parts[1:]:
        total = Transported(
            total.motion @ part.motion,
            total.error + part.error + total.turn_error * part.scale,
            total.turn_error + part.turn_error,
            total.scale + part.scale,
            total.points + part.points,
        )
    return total


@dataclass(frozen=True, eq=False)
class _Routes:
    """One part of a loop by both routes; cone is None where only the line is used."""

    line: Transported
    cone: Transported | None

    @cached_property
    def agree(self) -> bool | None:
        """Whether both give the same motion within their errors; None without a cone."""
        line, cone = self.line, self.cone
        if cone is None:
            return None
        difference = np.abs(line.motion.increment - cone.motion.increment)
        shift = float(difference[:-1, -1].max()) <= DISAGREE * (line.error + cone.error)
        turn = float(difference[:-1, :-1].max()) <= DISAGREE * (line.turn_error + cone.turn_error)
        return shift and turn

    @property
    def chosen(self) -> tuple[str, Transported]:
        """The cone if both agree and its translation is no less accurate, otherwise the line."""
        cone = self.cone
        if cone is not None and self.agree and cone.error <= self.line.error:
            return "cone", cone
        return "line", self.line

    @property
    def points(self) -> int:
        """Points of both routes."""
        return self.line.points + (0 if self.cone is None else self.cone.points)


@dataclass(frozen=True, eq=False)
class RouteCheck:
    """The two independent routes side by side.

    line, cone: the motion by each; cone is None where curvature and torsion are not smooth inside.
    agrees: True, False, or None where there is nothing to compare.
    text: the comparison in words.
    """

    line: AffineMap
    cone: AffineMap | None
    agrees: bool | None
    text: str


@attribute_hints()
@dataclass(frozen=True, eq=False, repr=False)
class Development:
    """Closure failure of a developed loop: translation and rotation in the frame at the base.

    connection, loop: the connection and the loop that was developed.
    motion: v -> rotation v + burgers, with its invariants.
    error: bound on the error of burgers; turn_error: of the entries of the rotation.
    route: "line", "cone", or "line and cone" where parts of the loop needed different ones.
    check: the other route, and whether both agree.
    enclosed: defects that the loop winds around, with position and turns.
    evaluations: points at which the connection or its curvature was evaluated.
    seconds: wall time.
    parameters: the values of the frame's parameters, by name.
    """

    connection: Connection
    loop: Loop
    motion: AffineMap
    error: float
    turn_error: float
    route: str
    check: RouteCheck
    enclosed: tuple[EnclosedDefect, ...]
    evaluations: int
    seconds: float
    parameters: Mapping[str, Number]

    @property
    def burgers(self) -> np.ndarray:
        """Closure failure b^i, shape (n,), in the frame at the base point."""
        return self.motion.burgers

    @property
    def rotation(self) -> np.ndarray:
        """R^j_i, shape (n, n): the transported legs in the frame at the base point."""
        return self.motion.rotation

    @property
    def frank(self) -> np.ndarray:
        """Logarithm of the transport of vectors around the loop, shape (n, n): -log(rotation)."""
        return self.motion.frank

    @property
    def angle(self) -> float:
        """Angle by which a vector transported around the loop rotates (see AffineMap.angle)."""
        return self.motion.angle

    @property
    def axis(self) -> np.ndarray | None:
        """Rotation axis in three dimensions; None if there is no rotation."""
        return self.motion.axis

    @property
    def along_axis(self) -> float:
        """Burgers vector along the rotation axis, the same from every base point."""
        return self.motion.along_axis

    def seen_from(self, path: AffineMap) -> AffineMap:
        """Development of the same loop from the end of a path that starts at the base point."""
        return self.motion.seen_from(path)

    plot: ClassVar[Plot] = figure_by("development", "draw_rolled_out")
    _repr_html_ = drawn_by("notebook_pictures", "development_html")

    def __repr__(self) -> str:
        inside = f", encloses {len(self.enclosed)} defect(s)" if self.enclosed else ""
        return (
            f"Development(b = {measured_text(self.burgers.tolist(), self.error)}, "
            f"turn={float(abs(self.motion.turn).max()):.3g}, route={self.route!r}{inside})"
        )


@argument_hints(tol="accuracy=1e-8", rtol="accuracy=1e-8")
def develop(
    connection: ConnectionLike,
    loop: Loop,
    accuracy: float = 1e-12,
    *,
    parameters: Parameters | None = None,
    defects: Sequence[Defect] | None = None,
) -> Development:
    """Cartan development of a loop: Burgers vector and Frank rotation, path-ordered.

    Equation
    --------
    G' = G [[omega, e], [0, 0]], G(0) = 1, G(1) = [[rotation, burgers], [0, 1]] with
    omega_i^j = omega_ai^j q'^a
    e^i = e^i_a q'^a
    (omega_i^j in row j). Small loops of signed area A^ab, summed over all a, b, have
    burgers^j = S_ab^j A^ab
    and the rotation minus 1 is R_abi^j A^ab / 2.

    Parameters
    ----------
    connection
        Any connection; for the Cartan connection of a frame the rotation is 1 and burgers the
        plain loop integral of the coframe.
    accuracy
        Requested error, relative to the integral of the absolute values along the chosen route.
    parameters
        Values of the parameters of frame and loop, {symbol or name: number}.
    defects
        Lines to look for inside the loop. None: where both routes differ, the lines from
        `find_defects`.

    Returns
    -------
    Development: motion in the frame at the base point, errors, route, check, enclosed defects.

    Raises
    ------
    LoopError
        The loop has another dimension than the frame, or the development does not converge.
    SingularPointError
        The loop passes through a point where the frame is singular; the message names it.
    ChartEdgeError
        The loop leaves the domain that the frame declares.
    MissingValueError
        A parameter has no value.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, levi_civita
    >>> theta, phi = sp.symbols("theta phi")
    >>> sphere = levi_civita(Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]]))
    >>> turn = develop(sphere, Loop.plaquette([1, 0], (0.5, 0.25)))
    >>> round(turn.angle, 12), turn.check.agrees     # the area (cos 1 - cos 1.5) / 4
    (0.11739127605, True)
    """
    if isinstance(connection, HasBurgers):
        raise ArgumentError(
            "connection: expected a Connection, got samples of a frame, whose legs count as "
            "parallel: their development is the Burgers vector. Use data.burgers(loop)."
        )
    connection = as_connection(connection)
    frame = connection.frame
    check_loop(loop, frame.dimension)
    check_accuracy(accuracy)
    start = time.perf_counter()
    loop, parameters = with_numbers(frame, loop, parameters)
    form = AffineForm(connection, parameters)
    lines = [repeated(along_line(form, part, accuracy), part.times) for part in loop.parts]
    refuse_outside(frame, loop.parts, parameters)
    routes = [
        _Routes(line, _cone(form, part, accuracy))
        for line, part in zip(lines, loop.parts, strict=True)
    ]
    if form.poles is not None:
        routes = [
            replace(one, cone=None)
            if one.agree and winds_around_line(frame, loop, part, parameters, connection)
            else one
            for one, part in zip(routes, loop.parts, strict=True)
        ]
    enclosed: tuple[EnclosedDefect, ...] = ()
    if defects is not None or not all(one.agree for one in routes):
        enclosed = enclosed_defects(frame, loop, parameters, defects=defects, connection=connection)
    names, chosen = zip(*(one.chosen for one in routes), strict=True)
    total = joined(chosen)
    check = _check(routes, enclosed)
    if loop.gap.any():
        check = replace(
            check, text="the loop closes modulo periods and bounds no cone: only the line"
        )
    return Development(
        connection, loop, total.motion, total.error, total.turn_error,
        " and ".join(sorted(set(names), reverse=True)), check, enclosed,
        sum(one.points for one in routes),
        time.perf_counter() - start, {str(key): x for key, x in (parameters or {}).items()},
    )  # fmt: skip


def _check(routes: Sequence[_Routes], enclosed: tuple[EnclosedDefect, ...]) -> RouteCheck:
    """The comparison of both routes over the whole loop, in words."""
    line = joined([one.line for one in routes]).motion
    present = [one.cone for one in routes if one.cone is not None]
    cone = joined(present).motion if len(present) == len(routes) else None
    agrees = [one.agree for one in routes]
    places = "; ".join(str(one) for one in enclosed)
    if all(agrees):
        text = "line integral and cone over the loop agree"
        return RouteCheck(line, cone, True, text + f"; winds around {places}" * bool(places))
    if False in agrees:
        text = "line integral and cone over the loop differ: "
        text += f"enclosed defect: {places}" if enclosed else "a singularity is inside"
        return RouteCheck(line, cone, False, text)
    text = "curvature and torsion are not smooth on the cone over the loop; only the line is used"
    text += f"; enclosed defect: {places}" if enclosed else ""
    return RouteCheck(line, cone, None, text)

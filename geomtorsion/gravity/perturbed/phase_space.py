"""Phase space: degrees of freedom of a full nonlinear theory, counted on power series."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, ClassVar

import numpy as np
import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.geometry import Connection, Frame, Tensor
from geomtorsion.geometry.numeric.power_series import PowerSeries
from geomtorsion.gravity.charges.spheres import number
from geomtorsion.gravity.numeric.solution_jets import Jet, noise
from geomtorsion.gravity.numeric.varied import Potentials, Setting, varied
from geomtorsion.gravity.perturbed.geometries import GEOMETRIES, geometry_of, names_of, theory_in
from geomtorsion.gravity.perturbed.hilbert import confirmed, fitted, polynomial
from geomtorsion.gravity.perturbed.trial_fields import (
    moved,
    named_fields,
    start_coordinates,
    trial,
)
from geomtorsion.gravity.theory.field_equations import FieldEquations
from geomtorsion.gravity.theory.geometries import listed
from geomtorsion.gravity.theory.invariants import Invariant
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.gravity.theory.matter import maxwell, scalar_field
from geomtorsion.gravity.theory.two_forms import kalb_ramond
from geomtorsion.gravity.theory.vocabulary import declared_constants
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import Plot, figure_by
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import HALF, PRINTED

NAMES = ("flat", "riemannian", "teleparallel", "symmetric teleparallel", "poincare")
COORDINATES = sp.symbols("t x y z")


@dataclass(frozen=True, eq=False, repr=False)
class DegreesOfFreedom:
    """Answer of `degrees_of_freedom`: a count near one solution of a theory, with its evidence.

    lagrangian, geometry, dimension: the theory.
    order: highest order of the power series.
    numbers: H(q), q = 0, 1, ...: Taylor coefficients of all fields up to order q that are free
        for nearby solutions. shorter: the same from series with one order less.
    gauge: pairs (number of gauge functions, derivatives with which they enter the fields).
    place: order from which the confirmed numbers fit a phase space and a gauge symmetry; None if
        they do not fit, or are too few for a check.
    gaps: smallest singular value that counts in a rank, and largest that does not.
    residual: largest coefficient of the equations on the solution.
    branch: names of the invariants of the Lagrangian whose gradient vanishes at the point of the
        solution.
    invariants: values of all invariants of the Lagrangian at the point.
    parameters: values of the constants. assumed: assumptions of the count, in words.
    fields: coefficients of the solution, for a later call (near=answer).
    """

    lagrangian: str
    geometry: str
    dimension: int
    order: int
    numbers: tuple[int, ...]
    shorter: tuple[int, ...]
    gauge: tuple[tuple[int, int], ...]
    place: int | None
    gaps: tuple[float, float]
    residual: float
    branch: tuple[str, ...]
    invariants: Mapping[str, float]
    parameters: Mapping[str, float]
    assumed: tuple[str, ...]
    fields: Mapping[str, np.ndarray]

    plot: ClassVar[Plot] = figure_by("degrees_of_freedom", "draw_degrees_of_freedom")

    @cached_property
    def reduced(self) -> tuple[int, ...]:
        """H(q) minus the coefficients of the gauge functions: the growth of the phase space."""
        n = self.dimension
        return tuple(
            number - sum(m * math.comb(q + o + n, n) for m, o in self.gauge)
            for q, number in enumerate(self.numbers)
        )

    @cached_property
    def differences(self) -> tuple[int, ...]:
        """(n - 1)-th differences of `reduced`; each settled one is the size of the phase space."""
        return tuple(np.diff(self.reduced, self.dimension - 1).tolist())

    @property
    def confirmed(self) -> int:
        """How many of the numbers, from q = 0 on, are the same with one order less."""
        return confirmed(self.numbers, self.shorter)

    def polynomial(self, orders: Iterable[int]) -> list[int]:
        """The polynomial through `reduced` that fits from `place` on, at orders q.

        Raises
        ------
        GravityError
            No polynomial fits.
        """
        if self.place is None:
            raise GravityError(f"polynomial: expected numbers that fit, got none: {self.reason}")
        place, n = self.place, self.dimension
        heads = [int(np.diff(self.reduced, k)[place]) for k in range(n)]
        return [polynomial(heads, q - place) for q in orders]

    @property
    def is_clear(self) -> bool:
        """Whether all ranks are clear: no singular value between rounding and half the digits."""
        size = noise((max(self.numbers),))
        return self.gaps[0] > math.sqrt(size) and self.gaps[1] < 10 * size

    @property
    def settled(self) -> bool:
        """Whether the count is the same with one order less, all ranks are clear, and it fits.

        A phase space of an odd number of functions is not settled.
        """
        if self.place is None or self.differences[self.place] % 2:
            return False
        return self.is_clear and self.residual < HALF

    @property
    def number(self) -> Fraction | None:
        """Degrees of freedom: half the number of phase space functions; None where not settled."""
        if self.place is None or not self.settled:
            return None
        return Fraction(self.differences[self.place], 2)

    @property
    def reason(self) -> str:
        """Why the count is not settled, in words; "" where it is."""
        if self.settled:
            return ""
        if not self.residual < HALF:
            return (
                f"no solution was found from this start (equations are left at "
                f"{self.residual:.0e}). Give another start: near=frame, another seed."
            )
        if not self.is_clear:
            return (
                f"ranks are not sure (singular values {self.gaps[0]:.0e} and {self.gaps[1]:.0e}). "
                "Give another start: near=frame, another seed."
            )
        if self.place is not None:
            size = self.differences[self.place]
            return f"the phase space has an odd number of functions, {size}. Give a higher order."
        names = ", ".join(self.branch)
        constant = f" The gradient of {names} vanishes on this solution." if names else ""
        return (
            "the numbers fit no known gauge symmetry, or change with the order of the series."
            f"{constant} Give a higher order, or another start with near=frame."
        )

    def __str__(self) -> str:
        count = "not settled" if self.number is None else str(self.number)
        where = f"{self.geometry}, {self.dimension} dimensions"
        lines = [f"degrees of freedom of L = {self.lagrangian} ({where}): {count}"]
        if self.reason:
            lines.append(f"  {self.reason}")
        lines += [
            f"  free Taylor coefficients H(q): {', '.join(map(str, self.numbers))}",
            f"  with one order less:           {', '.join(map(str, self.shorter))}",
            f"  gauge functions: {sum(m for m, _ in self.gauge)}",
            f"  phase space functions by q: {', '.join(map(str, self.differences))}",
            f"  singular values: counted from {self.gaps[0]:.0e}, dropped up to {self.gaps[1]:.0e}",
        ]
        values = [f"{x} = {value:.4g}" for x, value in self.invariants.items()]
        constant = ", ".join(self.branch) or "none"
        lines.append(f"  at the point: {', '.join(values)}; constant invariants: {constant}")
        lines += [f"  assumed: {one}" for one in self.assumed]
        return "\n".join(lines)

    __repr__ = __str__

    def to_json(self) -> dict[str, Any]:
        """The answer as plain data."""
        return {
            "lagrangian": self.lagrangian,
            "geometry": self.geometry,
            "dimension": self.dimension,
            "order": self.order,
            "number": None if self.number is None else str(self.number),
            "settled": self.settled,
            "reason": self.reason,
            "numbers": list(self.numbers),
            "shorter": list(self.shorter),
            "gauge": [list(x) for x in self.gauge],
            "differences": list(self.differences),
            "confirmed": self.confirmed,
            "gaps": list(self.gaps),
            "residual": self.residual,
            "branch": list(self.branch),
            "invariants": dict(self.invariants),
            "parameters": dict(self.parameters),
            "assumed": list(self.assumed),
        }


@exclusive
def degrees_of_freedom(
    lagrangian: Lagrangian | str | sp.Expr,
    geometry: str | None = None,
    *,
    dimension: int = 4,
    near: Frame | DegreesOfFreedom | None = None,
    scalars: str | Iterable[str] | Mapping[str, object] = (),
    vectors: int = 0,
    two_forms: int = 0,
    parameters: Mapping[str, object] | None = None,
    constants: str | Iterable[str] = (),
    invariants: Invariant | Iterable[Invariant] = (),
    order: int | None = None,
    seed: int = 0,
) -> DegreesOfFreedom:
    """Degrees of freedom of the full nonlinear theory, near one of its solutions.

    All fields are power series at a point. Newton's method finds a solution of all field equations
    up to an order, and the rank of the linearized equations gives H(q), the number of Taylor
    coefficients up to order q that are free for nearby solutions; hidden constraints are included.
    A free function of all n variables adds binomial(q + n, n) to H(q), and is gauge; a free
    function of n - 1 variables adds binomial(q + n - 1, n - 1). Two functions of n - 1 variables
    are one degree of freedom.

    Nothing is proved: the count is numerical (doubles, with clear ranks) and holds near one
    solution.

    Parameters
    ----------
    lagrangian
        Text or a theory, as in `gravity.equations`.
    geometry
        "flat" (only matter varies), "riemannian", "teleparallel", "symmetric teleparallel" (in the
        coincident gauge) or "poincare" (coframe and metric connection). The default is
        read from the Lagrangian, see `spectrum`; flat where it contains only matter.
    dimension
        2, 3 or 4; 4 takes minutes for theories of a coframe.
    near
        Frame of signature -++... near which the solution is searched, at its sample point, or an
        earlier answer, whose fields are the start; None: flat space. Coordinates are the
        coordinates of the frame.
    scalars
        Names of scalar fields, or names with formulas near which they are searched.
    vectors
        Number of vector fields, with F2 and A_a in the Lagrangian.
    two_forms
        Number of two-forms of Kalb and Ramond, with H2 and B2.
    parameters
        Values of the constants of the Lagrangian; others get a value, which `.assumed` lists.
    order
        Highest order of the power series; by default the dimension plus the order of the
        equations, and up to three more where the count is not settled. A higher order can only
        lower H.
    seed
        Seed of the random change of the start: equal calls give equal answers.

    Raises
    ------
    GravityError
        The Lagrangian does not fit the geometry, its equations do not contain the fields, or near
        has another dimension or signature.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> count = perturbed.degrees_of_freedom("-F2/4", "flat", dimension=3, vectors=1)
    >>> count.number, count.settled, count.gauge
    (Fraction(1, 1), True, ((1, 1),))
    """
    n = checks.count(dimension, "dimension", GravityError, 2, 4)
    own = listed(invariants, Invariant, "invariants", "gravity.invariant(name, formula)")
    bare = "flat" if scalars or vectors or two_forms else "riemannian"
    name = geometry_of(lagrangian, geometry, own, NAMES, bare)
    theory = (
        theory_in(lagrangian, name) if name in GEOMETRIES else theory_in(lagrangian, "poincare")
    )
    theory = replace(theory, geometry="any",
                     constants=(*declared_constants(theory.constants),
                                *declared_constants(constants)),
                     invariants=(*theory.invariants, *own))  # fmt: skip
    formulas = dict(scalars) if isinstance(scalars, Mapping) else dict.fromkeys(names_of(scalars))
    count = checks.count(vectors, "vectors", GravityError, 0, 4)
    count_of_forms = checks.count(two_forms, "two_forms", GravityError, 0, 4)
    coordinates = COORDINATES[:n]
    if isinstance(near, Frame):
        coordinates = start_coordinates(near, n)
    elif near is not None:
        checks.instance(near, DegreesOfFreedom, "near", GravityError)
    kind = varied(name, n)

    def equations(
        connection: Connection, own: Sequence[Tensor], potentials: Potentials, forms: Potentials
    ) -> FieldEquations:
        matter: list[Any] = [
            scalar_field(value, None if text == "phi" else text)
            for text, value in zip(formulas, own, strict=True)
        ]
        matter += [maxwell(x) for x in potentials]
        matter += [kalb_ramond(x) for x in forms]
        made = FieldEquations((connection,), theory, tuple(matter))
        made.check_names()
        made.check_presence()
        return made

    setting = Setting(kind, coordinates, {}, equations, len(formulas), count, count_of_forms)
    if not setting.size:
        raise GravityError(
            f"geometry: expected a matter field for {name}, got none. Give scalars=, vectors= or "
            "two_forms=."
        )
    values, assumed = _constants(setting, parameters)
    setting = replace(setting, constants=values)
    setting = replace(setting, unit=_unit(setting))
    probe = PowerSeries(n, 4)
    source = near.fields if isinstance(near, DegreesOfFreedom) else near
    begun = trial(setting, probe, source, formulas)
    first = Jet(probe, moved(begun, probe, setting, seed), setting.residuals)
    if first.is_empty:
        kept = np.abs(first.residual(probe.order)).max(initial=0) > HALF
        came = "a number that is not zero" if kept else "zero for every field"
        raise GravityError(
            f"lagrangian: expected field equations, got {came} from L = {theory.expression} in {n} "
            "dimensions. Give a Lagrangian whose variation contains the fields."
        )
    highest = first.order
    # In four dimensions, or with a connection of its own, an order more can take minutes.
    more = 2 if n == 4 or kind.turning else 4
    orders = [n + highest + k for k in range(more)]
    if order is not None:
        orders = [checks.count(order, "order", GravityError, highest + 1)]
    begin = "flat space" if near is None else "the start in near"
    assumed += [
        f"a point of one solution, from {begin} with the random change of seed {seed}",
        "ranks of matrices of doubles",
    ]

    def counted(last: int) -> DegreesOfFreedom:
        """The count with series of this order."""
        series = PowerSeries(n, last)
        solved, rest = _solution(setting, series, source, formulas, seed)
        numbers, *gaps = solved.freedom(highest)
        below = PowerSeries(n, last - 1)
        cut_off = Jet(below, solved.fields[:, : below.size], setting.residuals)
        shorter, *others = cut_off.freedom(highest)
        gauge, place = fitted(numbers, shorter, name, kind.gauge, n, (count, count_of_forms))
        branch, scalars_at = _branch(setting, solved)
        return DegreesOfFreedom(
            str(theory.expression), name, n, last, tuple(numbers), tuple(shorter), gauge, place,
            (min(gaps[0], others[0]), max(gaps[1], others[1])), rest, branch, scalars_at,
            dict(values), tuple(assumed), named_fields(setting, solved.fields),
        )  # fmt: skip

    answer = counted(orders[0])
    for last in orders[1:]:
        if answer.residual < HALF and not answer.settled:
            answer = counted(last)
    return answer


def _at_point(setting: Setting) -> FieldEquations:
    """The theory with constant fields."""
    flat = PowerSeries(setting.dimension, 0)
    return setting.theory(flat, trial(setting, flat, None, {}), moving=False)


def _unit(setting: Setting) -> Fraction:
    """The power of two next to the largest coefficient of the Lagrangian: the unit of equations."""
    terms = sp.Add.make_args(sp.expand(_at_point(setting).expression))
    known = setting.constants
    sizes = []
    for term in terms:
        values = {x: sp.Rational(known[x.name]) for x in term.free_symbols if x.name in known}
        sizes.append(abs(float(term.xreplace(values).as_coeff_Mul()[0])))
    return Fraction(2) ** round(math.log2(max(sizes))) if any(sizes) else Fraction(1)


def _solution(
    setting: Setting,
    series: PowerSeries,
    near: Frame | Mapping[str, np.ndarray] | None,
    formulas: Mapping[str, object],
    seed: int,
) -> tuple[Jet, float]:
    """A solution near the start, and its largest residual."""
    fields = trial(setting, series, near, formulas)
    if near is None or isinstance(near, Frame):
        if near is not None:
            # A symmetric start stays symmetric, on the branch of the frame.
            fields = Jet(series, fields, setting.residuals).solved()[0].fields
        fields = moved(fields, series, setting, seed)
    return Jet(series, fields, setting.residuals).solved()


def _constants(
    setting: Setting, parameters: Mapping[str, object] | None
) -> tuple[dict[str, float], list[str]]:
    """Values of the constants of the Lagrangian, and which of them were assumed."""
    given = checks.by_name(checks.table(parameters, "parameters"), "parameters", GravityError)
    names = _at_point(setting).constants
    for text in given:
        checks.known_name(text, names, "parameters", GravityError, expected="a constant of L")
    values, assumed = {}, []
    for k, text in enumerate(names):
        if text in given:
            values[text] = float(number(given[text], f"parameters: {text}"))
        else:
            values[text] = float(Fraction(3 + 4 * k, 10))
            assumed.append(f"{text} = {values[text]:g}")
    return values, assumed


def _branch(setting: Setting, jet: Jet) -> tuple[tuple[str, ...], dict[str, float]]:
    """Invariants that are constant on a solution, and the values of all."""
    theory = setting.theory(jet.series, jet.fields, moving=False)
    constant, values = [], {}
    for name in theory.invariant_names:
        element = theory.scalar(name).element()
        if element.is_constant:
            values[name] = float(element.value)
            constant.append(name)
            continue
        values[name] = float(element.value[0])
        gradient = element.value[jet.series.degrees == 1]
        # Where equations have a double root, half of the digits of a solution are left.
        if not np.any(np.abs(gradient) > PRINTED):
            constant.append(name)
    return tuple(constant), values

"""Brownian: random motion in a frame with torsion, its generator, measure and ensembles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
import sympy as sp

from geomtorsion import codegen
from geomtorsion.errors import (
    ArgumentError,
    ConstraintError,
    MissingValueError,
    ShapeError,
    SignatureError,
    SingularPointError,
    StartError,
    TimeError,
    UndecidedError,
)
from geomtorsion.exact import Element, parse_expression
from geomtorsion.geometry import Connection, Tensor, contract, levi_civita
from geomtorsion.geometry.integrability import volume_of
from geomtorsion.loops import validation
from geomtorsion.loops.arcs import Parameters, exact_number
from geomtorsion.loops.forms import refuse_unknown
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.outgoing import measured_text

HALF = Fraction(1, 2)
REMEDY = "Request fewer members, or average runs with different seeds."


@dataclass(frozen=True, repr=False)
class InvariantMeasure:
    """Exact invariant measure of a diffusion, or the obstructions to a reversible one.

    density: h sqrt|g|, up to a factor; None where no closed form is known. A motion that is not
        reversible may still have a measure, which these formulas do not give.
    reversible: whether the motion, run backwards, has the same law (detailed balance): the form
        2 b_a dq^a is closed. None if this cannot be decided.
    obstructions: (a, b) -> d_a 2 b_b - d_b 2 b_a, coordinates counted from 0, for all components
        that do not vanish.

    Equation
    --------
    d_a log h = 2 b_a              [Kleinert, Shabanov, J. Phys. A 31 (1998) 7005]

    with the drift b^a of the `Diffusion`; the measure is h sqrt|g| dq^1 ... dq^n. For a metric
    connection 2 b_a is minus the torsion vector T_ab^b.

    Examples
    --------
    >>> from geomtorsion import diffusion, cartan, levi_civita, spaces
    >>> diffusion(cartan(spaces.load("flat_polar").frame)).invariant_measure
    InvariantMeasure(density 1, reversible)
    """

    density: sp.Expr | None
    reversible: bool | None
    obstructions: Mapping[tuple[int, int], sp.Expr] = field(default_factory=dict)

    def __repr__(self) -> str:
        words = {True: "reversible", False: "not reversible", None: "undecided"}[self.reversible]
        density = self.density if self.density is not None else "not known"
        parts = [f"density {density}", words]
        parts += [f"d(2 b)_{a + 1}{b + 1} = {x}" for (a, b), x in self.obstructions.items()]
        return f"InvariantMeasure({', '.join(parts)})"


@dataclass(frozen=True)
class EnsembleMean:
    """Mean of a function over an ensemble, with its errors.

    value: the mean. noise: its standard error from the number of members. step_error: difference
    from the run with steps twice as long and the same noise, with its own standard error.

    Examples
    --------
    >>> EnsembleMean(0.5, 0.003, 0.004)
    EnsembleMean(0.5000 +- 0.0050: noise 0.003, steps 0.004)
    """

    value: float
    noise: float
    step_error: float

    @property
    def error(self) -> float:
        """Noise and error of the steps, added in quadrature."""
        return float(np.hypot(self.noise, self.step_error))

    def __repr__(self) -> str:
        return (
            f"EnsembleMean({measured_text(self.value, self.error)}: noise {self.noise:.2g}, "
            f"steps {self.step_error:.2g})"
        )


@dataclass(frozen=True, eq=False, repr=False)
class StochasticEnsemble:
    """Positions of many Brownian motions at one time.

    diffusion: with numbers for all parameters. places: shape (members, n). coarse: the same motions
    with steps twice as long. t, steps, seed: of the run.
    """

    diffusion: Diffusion
    places: np.ndarray
    coarse: np.ndarray
    t: float
    steps: int
    seed: int

    def mean(self, function: object) -> EnsembleMean:
        """Mean of a function of the coordinates, an expression or text.

        Raises
        ------
        ExpressionError
            The function cannot be read.
        SingularPointError
            It has no finite value for a member.
        """
        element = self.diffusion.read("function", function)
        values = codegen.numpy_function(
            [element], self.diffusion.connection.frame.coordinates, check=False
        )
        with np.errstate(all="ignore"):
            fine, coarse = (values(*x.T)[0] for x in (self.places, self.coarse))
        if not (np.isfinite(fine).all() and np.isfinite(coarse).all()):
            raise SingularPointError(
                f"mean of {checks.shown(function)}: expected finite values, got others for some "
                "members. Choose a function that is finite where the motion goes."
            )
        root = np.sqrt(len(fine))
        change = fine - coarse
        return EnsembleMean(
            float(fine.mean()),
            float(fine.std(ddof=1) / root),
            float(abs(change.mean()) + change.std(ddof=1) / root),
        )

    def __repr__(self) -> str:
        return (
            f"StochasticEnsemble({len(self.places):,} members at t = {self.t:g}, "
            f"{self.steps} steps, seed {self.seed})"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Diffusion:
    """Brownian motion with torsion: white noise in the frame, developed by a connection.

    connection: over an orthonormal frame of a positive metric.

    Equation
    --------
    dq^m = E_i^m o dB^i + c^k E_k^m dt, c^k = - sum_i omega_ii^k / 2 (Stratonovich)
    L f = g^{ab} D_a D_b f / 2 = (Laplacian f) / 2 + b^a d_a f

    The law depends on the connection only through the drift b of the generator L. For a metric
    connection b^a = - T^a_b^b / 2: the torsion vector is a drift, and the rest of the torsion has
    no effect [Kleinert, Shabanov, J. Phys. A 31 (1998) 7005; Ikeda, Watanabe, Stochastic
    differential equations, 1989, chapter V].

    Examples
    --------
    >>> from geomtorsion import diffusion, levi_civita, spaces
    >>> sphere = levi_civita(spaces.load("s2").frame.subs({"R": 1}))
    >>> diffusion(sphere).generator("cos(theta)")
    -cos(theta)
    >>> run = diffusion(sphere).ensemble([1.0, 0.0], 0.5, members=4000, steps=64, seed=1)
    >>> heat = run.mean("cos(theta)")
    >>> bool(abs(heat.value - np.cos(1.0) * np.exp(-0.5)) < 3 * heat.error)
    True
    """

    connection: Connection

    @cached_property
    def drift(self) -> Tensor:
        """b^c = - g^{ab} (Gamma_ab^c - Gamma_bar_ab^c) / 2, slots u; zero for Levi-Civita."""
        frame = self.connection.frame
        difference = self.connection.coefficients - levi_civita(frame).coefficients
        traced = contract("ab,abc->c", frame.inverse_metric, difference)
        parts = {place: -HALF * value for place, value in traced.components.nonzero.items()}
        return Tensor(frame, "u", parts, (), "b", "drift")

    def read(self, where: str, value: object) -> Element:
        """A function of the coordinates as an element."""
        frame = self.connection.frame
        names = {symbol.name: symbol for symbol in frame.field.symbols}

        def reader(text: str) -> sp.Expr:
            return parse_expression(text, symbols=names, where=where)

        return frame.read([(where, checks.expression(value, where, read=reader))])[0]

    def generator(self, function: object) -> sp.Expr:
        """L f = g^{ab} D_a D_b f / 2 of a function of the coordinates, exact.

        Raises
        ------
        ExpressionError
            The function cannot be read.
        """
        element = self.read("function", function)
        scalar = self.connection.frame.scalar(lambda: element)
        return (HALF * self.connection.laplacian(scalar).element()).sympy

    @cached_property
    def invariant_measure(self) -> InvariantMeasure:
        """Exact measure that does not change in time, or the obstructions to a reversible one.

        If the drift is not a gradient but free of divergence, the volume is invariant.
        """
        slope = {place: 2 * x for place, x in self.drift.lowered(0).components.nonzero.items()}
        verdict = volume_of(Tensor(self.connection.frame, "d", slope, (), "W", "twice the drift"))
        if verdict.holds:
            try:
                return InvariantMeasure(verdict.density, True)
            except UndecidedError:
                return InvariantMeasure(None, True)
        density = None
        if levi_civita(self.connection.frame).divergence(self.drift).is_zero:
            density = self.connection.frame.volume[()]
        return InvariantMeasure(density, verdict.holds, verdict.obstructions)

    def ensemble(
        self,
        start: object,
        t: float,
        *,
        members: int,
        steps: int,
        seed: int,
        parameters: Parameters | None = None,
    ) -> StochasticEnsemble:
        """Many motions from one point, by Heun's method for Stratonovich equations.

        All members run in one chart, in the frame of the connection. A second run with steps twice
        as long and the same noise gives the error of the steps, which falls as the step.

        Parameters
        ----------
        start
            q^mu, shape (n,).
        t
            duration, positive. The mean square distance grows as n t at first.
        members, steps, seed
            number of motions, even number of steps, and the seed of NumPy's generator.
        parameters
            values of the parameters of the frame.

        Raises
        ------
        StartError, TimeError, ArgumentError
            A value is missing or not valid.
        SingularPointError
            A member reaches a point without finite frame.
        """
        n = self.connection.frame.dimension
        first = [
            float(x) for x in checks.numbers(start, n, "start", StartError, shape_error=ShapeError)
        ]
        duration = checks.positive(t, "t", TimeError)
        checks.count(members, "members", ArgumentError, 2)
        checks.count(steps, "steps", ArgumentError, 2)
        checks.count(seed, "seed", ArgumentError)
        if steps % 2:
            raise ArgumentError(
                f"steps: expected an even number, got {steps}. The error comes from half as many."
            )
        # Places, slopes and noise of both runs.
        checks.check_room(members * n * (n + 6), f"members: {members:,} motions", REMEDY)
        numeric = self._numeric(parameters)
        random = np.random.default_rng(seed)
        fine = np.tile(np.array(first)[:, None], (1, members))
        coarse, dt = fine, duration / steps
        for k in range(steps // 2):
            noise = np.sqrt(dt) * random.standard_normal((2, n, members))
            for one in noise:
                fine = numeric._step(fine, one, dt)
            coarse = numeric._step(coarse, noise.sum(axis=0), 2 * dt)
            bad = ~(np.isfinite(fine).all(axis=0) & np.isfinite(coarse).all(axis=0))
            if bad.any():
                raise SingularPointError(
                    f"{int(bad.sum()):,} of {members:,} members have no finite position after "
                    f"t = {2 * (k + 1) * dt:.4g}: they reached an edge of the chart. Take more "
                    "steps, a shorter time, or coordinates without an edge there."
                )
        return StochasticEnsemble(numeric, fine.T, coarse.T, duration, steps, seed)

    def _numeric(self, parameters: Parameters | None) -> Diffusion:
        """The same with numbers for all parameters."""
        values = {
            name: exact_number(validation.exact_input(value, name))
            for name, value in checks.by_name(parameters, "parameters", ArgumentError).items()
        }
        refuse_unknown(self.connection.frame, values)
        numeric = Diffusion(self.connection.subs(values)) if values else self
        names = [symbol.name for symbol in self.connection.frame.parameters]
        checks.check_values(names, values, "parameters", MissingValueError, validation.VALUES)
        return numeric

    @cached_property
    def _rates(self) -> Callable[..., np.ndarray]:
        """The drift of Stratonovich's equation and all legs at points, (n + n n, members)."""
        frame = self.connection.frame
        n, leg = frame.dimension, frame.legs.components.get
        omega = self.connection.spin_connection.in_frame().components.get
        turn = [frame.field.sum([(-HALF, omega((i, i, k))) for i in range(n)]) for k in range(n)]
        drift = [frame.field.sum([(1, turn[k], leg((mu, k))) for k in range(n)]) for mu in range(n)]
        legs = [leg((mu, k)) for mu in range(n) for k in range(n)]
        return codegen.numpy_function([*drift, *legs], frame.coordinates, check=False)

    def _step(self, places: np.ndarray, noise: np.ndarray, dt: float) -> np.ndarray:
        """One step of Heun's method, places and noise of shape (n, members)."""
        with np.errstate(all="ignore"):
            first = self._increment(places, noise, dt)
            return places + (first + self._increment(places + first, noise, dt)) / 2

    def _increment(self, places: np.ndarray, noise: np.ndarray, dt: float) -> np.ndarray:
        n = len(places)
        bad = ~np.isfinite(places).all(axis=0)
        rates = self._rates(*np.where(bad, 1.0, places))
        legs = rates[n:].reshape(n, n, -1)
        moved = dt * rates[:n] + np.einsum("mkp,kp->mp", legs, noise)
        return np.where(bad, np.nan, moved)

    def __repr__(self) -> str:
        return f"Diffusion({self.connection.name} of {self.connection.frame.name or 'a frame'})"


def diffusion(connection: Connection) -> Diffusion:
    """Brownian motion of a connection, with torsion: generator, invariant measure, ensembles.

    Parameters
    ----------
    connection
        over an orthonormal frame of a positive metric; nonmetricity also acts as a drift.

    Raises
    ------
    SignatureError
        The metric is not positive, or the legs are not orthonormal.
    ConstraintError
        The connection has constraints.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion import Frame, cartan, diffusion
    >>> x, y = sp.symbols("x y", real=True)
    >>> plane = Frame([x, y], [[1, 0], [0, sp.exp(x)]])
    >>> motion = diffusion(cartan(plane))
    >>> motion.drift[0], motion.generator("x"), motion.invariant_measure
    (-1/2, 0, InvariantMeasure(density 1, reversible))
    """
    checks.instance(connection, Connection, "connection")
    frame = connection.frame
    eta = frame.eta.components
    n = frame.dimension
    if any((eta.get((i, j)) - (i == j)).is_zero is not True for i in range(n) for j in range(n)):
        raise SignatureError(
            f"expected orthonormal legs of a positive metric, got eta = {frame.eta.to_sympy()}. "
            "Brownian motion needs a positive metric; Frame.from_metric makes orthonormal legs."
        )
    if connection.allowed is not None:
        raise ConstraintError(
            "expected a connection without constraints, got one with permitted legs "
            f"{connection.allowed}. Use levi_civita(frame) or cartan(frame)."
        )
    return Diffusion(connection)

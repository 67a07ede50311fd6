"""Reductions: geodesics by smaller systems that cost less than the equations of frame velocities.

With the momenta of coordinates that do not occur as constants; and, where they fall apart, as
motions in one coordinate each. Optional: without these the same curves are followed by their
frame velocities, some of them slower.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import sympy as sp

from geomtorsion.codegen import Graph, Products, graph
from geomtorsion.copies import only_fields
from geomtorsion.curves.equations import Equations, Momenta, inverted
from geomtorsion.exact import Element, Field
from geomtorsion.exact.form import of_same_sign
from geomtorsion.ode.members import Members, Part
from geomtorsion.ode.system import System
from geomtorsion.ode.trajectory import PER_STEP
from geomtorsion.precision import EPS

if TYPE_CHECKING:
    pass


# Kinds of steps in a graph that cost little.
_CHEAP = ("argument", "number", "sum")
# Velocities that come back from their momenta more roundings off than this lose digits on the way,
# for large parts cancel: such starts keep the full equations.
ROUNDINGS = 64
# Longer rates (values in a graph) belong to frames whose inverse metric is too long to work with.
LONGEST = 100


@dataclass(frozen=True, eq=False)
class CyclicReduction:
    """Hamilton's equations, the momenta of cyclic coordinates being parameters.

    Equation
    --------
    q'^mu = g^mu nu p_nu,  p_mu = e^i_mu G_ij u^j,
    p'_mu = (N d_mu D - d_mu (D g^nu rho) p_nu p_rho) / (2 D)   with N = g^mu nu p_mu p_nu

    for any function D: N is constant, and a D that clears the denominators of the inverse metric
    makes the rates short (for Kerr they fall apart into functions of r and of theta).

    equations: those of the frame velocities, in whose place these stand.
    momenta: what the momenta are made of.

    Examples
    --------
    >>> from geomtorsion.curves import geodesic
    >>> from geomtorsion.spaces import load
    >>> orbit = geodesic(load("kerr").frame, [0, 8, 1.5, 0], [1.3, 0, 0, 0.05],
    ...                  parameters={"M": 1, "a": 0.9})
    >>> orbit.reductions("kerr").offered[1].system.states
    ('t', 'r', 'theta', 'phi', 'p_r', 'p_theta')
    """

    equations: Equations
    momenta: Momenta

    def __getstate__(self) -> Mapping[str, object]:
        # The graph goes with it, so that a copy gives the same bits.
        return only_fields(self) | {"_to_velocities": self._to_velocities}

    @property
    def _coordinates(self) -> tuple[str, ...]:
        return self.equations.states[: self.equations.width]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the momenta, coordinate by coordinate."""
        taken = (*self.equations.states, *self.equations.parameters)
        letters = ("p_", "momentum_", "P_", "Momentum_")
        letter = next(x for x in letters if not any(name.startswith(x) for name in taken))
        return tuple(letter + name for name in self._coordinates)

    @cached_property
    def moving(self) -> tuple[int, ...]:
        """Places of the coordinates whose momenta change."""
        return tuple(k for k in range(self.equations.width) if k not in self.momenta.cyclic)

    @cached_property
    def _states(self) -> tuple[str, ...]:
        return (*self._coordinates, *(self.names[k] for k in self.moving))

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters: those of the equations, the constant momenta, and N."""
        constant = (self.names[k] for k in self.momenta.cyclic)
        return (*self.equations.parameters, *constant, self._norm)

    @cached_property
    def _norm(self) -> str:
        """Name of the constant N."""
        taken = (*self.equations.states, *self.equations.parameters, *self.names)
        return next(x for x in ("norm", "squared_norm", "norm_of_p") if x not in taken)

    # -- exact matrices --------------------------------------------------------------------------

    @cached_property
    def _lowered(self) -> Mapping[tuple[int, int], Element]:
        """e^i_mu G_ij by (mu, j)."""
        pairs: dict[tuple[int, int], list[Element]] = {}
        for (i, mu), value in self.momenta.frame.coframe.components.nonzero.items():
            for j, weight in self.momenta.lower[i]:
                pairs.setdefault((mu, j), []).append(value * weight)
        return _summed(pairs)

    @cached_property
    def _raised(self) -> Mapping[tuple[int, int], Element]:
        """G^ij E_j^mu by (i, mu)."""
        weights = _inverse(self.momenta.lower)
        chart = self.equations.chart
        assert chart is not None
        pairs: dict[tuple[int, int], list[Element]] = {}
        for mu, row in enumerate(chart.legs):
            for j, value in row:
                for i, weight in enumerate(weights[j]):
                    if weight:
                        pairs.setdefault((i, mu), []).append(value * weight)
        return _summed(pairs)

    @cached_property
    def inverse_metric(self) -> Mapping[tuple[int, int], Element]:
        """g^mu nu by (mu, nu), mu <= nu."""
        chart = self.equations.chart
        assert chart is not None
        pairs: dict[tuple[int, int], list[Element]] = {}
        for mu, row in enumerate(chart.legs):
            for i, value in row:
                for (j, nu), other in self._raised.items():
                    if j == i and mu <= nu:
                        pairs.setdefault((mu, nu), []).append(value * other)
        return _summed(pairs)

    # -- the smaller system ----------------------------------------------------------------------

    @cached_property
    def system(self) -> System:
        """All coordinates, and the momenta that change, with the divisor that costs the least."""
        field = self.momenta.frame.field
        own = [self.inverse_metric.get((k, k)) for k in self.moving]
        divisors = [field.one, *(field.one / x for x in own if x is not None)]
        arguments = (*self._states, *self.parameters)
        made = [graph(arguments, self._rates(x), self.parameters) for x in divisors]
        rates = min(made, key=cost)
        guard, end = self.equations.guards(arguments, self.parameters)
        width = self.equations.width
        places = (group for group in self.equations.groups if group[-1] < width)
        groups = (*places, tuple(range(width, len(self._states))))
        return System(self._states, self.parameters, rates, groups, guard, end)

    def _rates(self, divisor: Element) -> list[Products]:
        """Rates of coordinates and momenta, by D g^mu nu for a divisor D."""
        rates: list[Products] = [()] * self.equations.width
        for (mu, nu), value in self.inverse_metric.items():
            rates[mu] += ((value, (self.names[nu],)),)
            if mu != nu:
                rates[nu] += ((value, (self.names[mu],)),)
        symbols, inverse = self.momenta.frame.coordinates, divisor.field.one / divisor
        for k in self.moving:
            terms: list[tuple[Element, tuple[str, ...]]] = []
            for (mu, nu), value in self.inverse_metric.items():
                slope = (value * divisor).diff(symbols[k])
                if not slope.is_zero:
                    weight = Fraction(-1, 2) if mu == nu else Fraction(-1)
                    terms.append((slope * inverse * weight, (self.names[mu], self.names[nu])))
            slope = divisor.diff(symbols[k])
            if not slope.is_zero:
                terms.append((slope * inverse * Fraction(1, 2), (self._norm,)))
            rates.append(tuple(terms))
        return rates

    @cached_property
    def _to_momenta(self) -> Graph:
        """All momenta, and the constant N, over full states and parameters."""
        velocities = self.equations.velocities
        rows: list[Products] = [()] * self.equations.width
        for (mu, j), value in self._lowered.items():
            rows[mu] += ((value, (velocities[j],)),)
        norm = tuple(
            (x, (velocities[i], velocities[j]))
            for i, row in enumerate(self.momenta.lower)
            for j, x in row
        )
        arguments = (*self.equations.states, *self.equations.parameters)
        return graph(arguments, [*rows, norm], factor=False)

    @cached_property
    def _to_velocities(self) -> Graph:
        """Frame velocities over states and parameters of the smaller system."""
        rows: list[Products] = [()] * len(self.equations.velocities)
        for (i, mu), value in self._raised.items():
            rows[i] += ((value, (self.names[mu],)),)
        return graph((*self._states, *self.parameters), rows, factor=False)

    # -- there and back --------------------------------------------------------------------------

    def reduced(
        self, states: np.ndarray, parameters: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Starts of the smaller system, their parameters, and for which no digits are lost.

        states, parameters: full ones in double precision, shapes (number, size).
        """
        width = self.equations.width
        momenta = self._to_momenta.numpy()(*states.T, *parameters.T).T
        start = np.concatenate((states[:, :width], momenta[:, list(self.moving)]), axis=1)
        constant = [*self.momenta.cyclic, width]
        numbers = np.concatenate((parameters, momenta[:, constant]), axis=1)
        back = self.lifted(numbers, start[:, None, :])[:, 0, width:]
        own = states[:, width:]
        gap = np.abs(back - own).max(axis=1)
        kept = gap <= ROUNDINGS * 2.0**-53 * np.abs(own).max(axis=1)
        return start, numbers, kept & np.isfinite(start).all(axis=1)

    def lifted(self, parameters: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Full states, shape (number, m, size), of states (number, m, smaller size)."""
        columns, width = states.transpose(2, 0, 1), self.equations.width
        velocities = self._to_velocities.numpy()(*columns, *parameters.T[..., None])
        return np.concatenate((columns[:width], velocities)).transpose(1, 2, 0)


def cost(rates: Graph) -> int:
    """Products, quotients and functions in a step, those of parameters alone left out."""
    return sum(not step.constant and step.kind not in _CHEAP for step in rates.steps)


def _summed(
    pairs: Mapping[tuple[int, int], Sequence[Element]],
) -> dict[tuple[int, int], Element]:
    """Sums of elements, those that vanish left out."""
    found = {}
    for key, values in pairs.items():
        total = values[0].field.sum([(1, value) for value in values])
        if not total.is_zero:
            found[key] = total
    return found


def _inverse(lower: Sequence[Sequence[tuple[int, Element]]]) -> list[list[Fraction]]:
    """The inverse of G_ij, whose entries are numbers."""
    n = len(lower)
    matrix = [[Fraction(0)] * n for _ in range(n)]
    for i, row in enumerate(lower):
        for j, value in row:
            matrix[i][j] = value.as_fraction()
    return inverted(matrix)


HALF = Fraction(1, 2)
# Coordinates have to stay within this factor of their start, sines above its inverse: x grows as
# D, most often as their square, and roundings that large are left where it has become small again.
CONFINED = 4.0
# Names of constants -> the function of one coordinate that their product multiplies.
Terms = Mapping[tuple[str, ...], Element]


@dataclass(frozen=True)
class Single:
    """The motion in one coordinate: a p^2 + V = kappa, and x = a p.

    place: of the coordinate; symbol: the coordinate q, or its cosine, with p its momentum;
    is_cosine: which of both; velocity, constant: names of x and kappa.
    """

    place: int
    symbol: sp.Symbol
    is_cosine: bool
    velocity: str
    constant: str
    inertia: Element
    potential: Terms

    def products(self, momentum: str) -> Products:
        """a p^2 + V."""
        terms = ((value, names) for names, value in self.potential.items())
        return ((self.inertia, (momentum, momentum)), *terms)

    @property
    def square(self) -> Products:
        """R = a (kappa - V)."""
        terms = ((-self.inertia * value, names) for names, value in self.potential.items())
        return ((self.inertia, (self.constant,)), *terms)

    @property
    def slope(self) -> Products:
        """R'(q) / 2, by powers of q where it is a polynomial."""
        return tuple(
            (value, (*powers, *names))
            for square, names in self.square
            for value, powers in _by_powers(square.diff(self.symbol) * HALF, self.symbol)
        )


@dataclass(frozen=True, eq=False)
class SeparatedReduction:
    """Equations in which each coordinate that occurs has a constant of its own.

    Equation
    --------
    D (g^mu nu p_mu p_nu - N) = sum_k (a_k p_k^2 + V_k)   with a_k, V_k of q_k alone (Staeckel)
    D q'_k = x_k,  D x'_k = R'_k(q_k) / 2   with x_k = a_k p_k,  x_k^2 = R_k = a_k (kappa_k - V_k)

    kappa_k = a_k p_k^2 + V_k is constant (for Kerr's space this is Carter's constant). The cosine
    of an angle stands in its place where only this and the square of the sine occur.

    cyclic: the equations that these replace; divisor: D; singles: the coordinates that occur;
    along: D g^mu nu p_nu of the cyclic coordinates; edges: what is positive up to the margin of
    the chart, and up to its very end.

    Examples
    --------
    >>> from geomtorsion.curves import geodesic
    >>> from geomtorsion.spaces import load
    >>> orbit = geodesic(load("kerr").frame, [0, 8, 1.5, 0], [1.3, 0, 0, 0.05],
    ...                  parameters={"M": 1, "a": 0.9})
    >>> orbit.reductions("kerr").offered[0].system.states
    ('t', 'r', 'cos_theta', 'phi', 'x_r', 'x_theta')
    """

    cyclic: CyclicReduction
    divisor: Element
    singles: tuple[Single, ...]
    along: Mapping[int, Products]
    edges: tuple[Sequence[Products], Sequence[Products]]

    @cached_property
    def _places(self) -> tuple[str, ...]:
        """Names of the coordinates, or of their cosines."""
        names = list(self.cyclic.equations.states[: self.cyclic.equations.width])
        for one in self.singles:
            names[one.place] = one.symbol.name
        return tuple(names)

    @cached_property
    def _parameters(self) -> tuple[str, ...]:
        return (*self.cyclic.parameters, *(one.constant for one in self.singles))

    @cached_property
    def system(self) -> System:
        """All coordinates, and x_k for each that occurs."""
        states = (*self._places, *(one.velocity for one in self.singles))
        arguments, inverse = (*states, *self._parameters), self.divisor.field.one / self.divisor
        rates: list[Products] = [()] * len(self._places)
        for mu, products in self.along.items():
            rates[mu] = products
        for one in self.singles:
            rates[one.place] = ((self.divisor.field.one, (one.velocity,)),)
        rates += [one.slope for one in self.singles]
        divided = [tuple((x * inverse, names) for x, names in row) for row in rates]
        guard, end = (graph(arguments, x, self._parameters) if x else None for x in self.edges)
        width = len(self._places)
        places = (group for group in self.cyclic.equations.groups if group[-1] < width)
        groups = (*places, tuple(range(width, len(states))))
        made = graph(arguments, divided, self._parameters)
        return System(states, self._parameters, made, groups, guard, end)

    # -- there and back --------------------------------------------------------------------------

    @cached_property
    def _opened(self) -> Graph:
        """x_k and kappa_k over coordinates or cosines, momenta of them, and parameters."""
        momenta = [self.cyclic.names[one.place] for one in self.singles]
        pairs = list(zip(self.singles, momenta, strict=True))
        outputs: list[Products] = [((one.inertia, (p,)),) for one, p in pairs]
        outputs += [one.products(p) for one, p in pairs]
        arguments = (*self._places, *momenta, *self.cyclic.parameters)
        return graph(arguments, outputs, factor=False)

    @cached_property
    def _closed(self) -> Graph:
        """Momenta p_k over states and parameters."""
        outputs = [
            ((self.divisor.field.one / one.inertia, (one.velocity,)),) for one in self.singles
        ]
        return graph((*self.system.states, *self._parameters), outputs, factor=False)

    @cached_property
    def _squares(self) -> tuple[Graph, ...]:
        """R_k over its coordinate or cosine and parameters, one for each."""
        return tuple(
            graph((one.symbol.name, *self._parameters), [one.square]) for one in self.singles
        )

    def _confined(self, places: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """Which motions stay where no digits are lost: R_k is negative on either side of them."""
        kept = np.ones(places.shape[1], dtype=bool)
        edge = np.sqrt(1 - CONFINED**-2)
        shares = np.linspace(0, 1, PER_STEP + 1)[1:, None]
        for one, square in zip(self.singles, self._squares, strict=True):
            here = places[one.place]
            for side in (-1, 1):
                if one.is_cosine:
                    there = here + shares * (side * edge - here)
                else:
                    there = here * CONFINED ** (side * shares)
                kept &= (square.numpy()(there, *numbers)[0] < 0).any(axis=0)
            if one.is_cosine:
                kept &= np.abs(here) <= edge
        return kept

    def reduced(
        self, states: np.ndarray, parameters: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """See `CyclicReduction.reduced`."""
        full, numbers, kept = self.cyclic.reduced(states, parameters)
        columns, width, count = full.T.copy(), len(self._places), len(self.singles)
        with np.errstate(all="ignore"):
            for k, one in enumerate(self.singles):
                if one.is_cosine:
                    angle = columns[one.place].copy()
                    columns[one.place] = np.cos(angle)
                    columns[width + k] /= -np.sin(angle)
            opened = self._opened.numpy()(*columns, *numbers.T)
            start = np.concatenate((columns[:width], opened[:count])).T
            numbers = np.concatenate((numbers.T, opened[count:])).T
            back = self._to_cyclic(start.T, numbers.T)
            kept = kept & self._confined(start.T[:width], numbers.T)
        # An angle beyond those that its cosine stands for does not come back.
        near = np.abs(back - full.T) <= ROUNDINGS * EPS * np.abs(full.T).max(axis=0)
        return start, numbers, kept & near.all(axis=0) & np.isfinite(start).all(axis=1)

    def lifted(self, parameters: np.ndarray, states: np.ndarray) -> np.ndarray:
        """See `CyclicReduction.lifted`."""
        full = self._to_cyclic(states.transpose(2, 0, 1), parameters.T[..., None])
        rest = parameters[:, : len(self.cyclic.parameters)]
        return self.cyclic.lifted(rest, full.transpose(1, 2, 0))

    def _to_cyclic(self, columns: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """States of the cyclic equations, each a row."""
        width = len(self._places)
        found = np.concatenate((columns[:width], self._closed.numpy()(*columns, *numbers)))
        for k, one in enumerate(self.singles):
            if one.is_cosine:
                cosine = columns[one.place]
                found[one.place] = np.arccos(cosine)
                found[width + k] *= -np.sqrt((1 - cosine) * (1 + cosine))
        return found


def separated(cyclic: CyclicReduction) -> SeparatedReduction | None:
    """Equations that fall apart, with the first divisor for which they do; None without one."""
    inverse, moving = cyclic.inverse_metric, cyclic.moving
    if any(mu != nu and {mu, nu} & {*moving} for mu, nu in inverse):
        return None
    cosines = _cosines(cyclic)
    if cosines is None or any((k, k) not in inverse for k in moving):
        return None
    edges = cosines.edges(cyclic)
    if edges is None:
        return None
    over = {key: cosines.read(value.sympy) for key, value in inverse.items()}
    for k in moving:
        found = _with_divisor(cyclic, cosines, over, 1 / over[k, k])
        if found is not None:
            divisor, singles, along = found
            return SeparatedReduction(cyclic, divisor, singles, along, edges)
    return None


@dataclass(frozen=True)
class _Cosines:
    """Angles that give way to their cosines.

    symbols: of what stands for the coordinates that occur, by place; table: sines and cosines of
    the angles in terms of these; field: of them all.
    """

    symbols: Mapping[int, sp.Symbol]
    table: Mapping[sp.Expr, sp.Expr]
    field: Field

    def read(self, expr: sp.Expr) -> Element:
        """An expression in the angles, over their cosines."""
        return self.field.read(expr.subs(self.table))

    @property
    def cosines(self) -> list[sp.Expr]:
        """Those of the symbols that are cosines."""
        return [x for x in self.table.values() if x.is_Symbol]

    def edges(self, cyclic: CyclicReduction) -> tuple[list[Products], list[Products]] | None:
        """What is positive up to the margin of the chart, and up to its end.

        Sines are roots over the cosines: an edge with such a factor is squared, or multiplied with
        it. None where none of the edges keeps an angle between 0 and pi, as its cosine does.
        """
        chart = cyclic.equations.chart
        assert chart is not None
        sines = sp.Mul(*(sp.sqrt(1 - z**2) for z in self.cosines))
        margin, inner, ends = Fraction(chart.margin), [], []
        for edge in chart.edges:
            expr = edge.element.sympy.subs(self.table)
            if expr.is_rational_function(*self.cosines):
                inner.append((expr, margin))
                ends.append(expr)
            elif (expr * sines).is_rational_function(*self.cosines):
                inner.append((expr**2, margin**2))
                ends.append(expr * sines)
            else:
                return None
        for z in self.cosines:
            if not any(all(x.subs(z, end).equals(0) for end in (-1, 1)) for x in ends):
                return None
        read = self.field.read
        last: list[Products] = [((of_same_sign(read(x)), ()),) for x in ends]
        first: list[Products] = [((read(x), ()), (read(-m), ())) for x, m in inner]
        return first if margin else last, last


def _cosines(cyclic: CyclicReduction) -> _Cosines | None:
    """None where the inverse metric is no rational function of coordinates and cosines."""
    frame = cyclic.momenta.frame
    values = [x.sympy for x in cyclic.inverse_metric.values()]
    symbols = {k: frame.coordinates[k] for k in cyclic.moving}
    taken = {*cyclic.names, *(s.name for s in frame.field.symbols)}
    table: dict[sp.Expr, sp.Expr] = {}
    instead: dict[sp.Symbol, sp.Symbol] = {}
    for k, angle in symbols.items():
        if any(x.has(sp.sin(angle), sp.cos(angle)) for x in values):
            symbols[k] = instead[angle] = z = sp.Symbol(_free(f"cos_{angle.name}", taken))
            table |= {sp.sin(angle): sp.sqrt(1 - z**2), sp.cos(angle): z}
    for value in values:
        over = value.subs(table)
        if over.free_symbols & {*instead} or not over.is_rational_function(*symbols.values()):
            return None
    field = Field([instead.get(s, s) for s in frame.field.symbols])
    return _Cosines(symbols, table, field)


def _with_divisor(
    cyclic: CyclicReduction,
    cosines: _Cosines,
    inverse: Mapping[tuple[int, int], Element],
    divisor: Element,
) -> tuple[Element, tuple[Single, ...], Mapping[int, Products]] | None:
    """Motions in one coordinate each, and D g^mu nu p_nu; None where they do not fall apart."""
    names, symbols = cyclic.names, cosines.symbols
    potentials: dict[int, dict[tuple[str, ...], Element]] = {k: {} for k in symbols}
    along: dict[int, Products] = dict.fromkeys(cyclic.momenta.cyclic, ())
    norm = (cyclic.parameters[-1],)
    spread = {(names[mu], names[nu]): (mu, nu) for mu, nu in inverse if mu not in symbols}
    for key, pair in ((norm, None), *spread.items()):
        value = -divisor if pair is None else inverse[pair] * divisor
        parts = _parts(value, symbols, cosines)
        if parts is None:
            return None
        for k, part in parts.items():
            if part.is_zero:
                continue
            if pair is None:
                potentials[k][key] = part
                continue
            mu, nu = pair
            potentials[k][key] = part * (1 if mu == nu else 2)
            along[mu] += ((part, (names[nu],)),)
            if mu != nu:
                along[nu] += ((part, (names[mu],)),)
    singles = []
    taken = {*names, *cyclic.parameters, *(s.name for s in cosines.field.symbols)}
    for k, symbol in symbols.items():
        inertia, place = inverse[k, k] * divisor, cyclic.equations.states[k]
        is_cosine = symbol.name != place
        if is_cosine:
            inertia *= cosines.field.read(1 - symbol**2)
        if any(not inertia.free_of(other) for other in symbols.values() if other != symbol):
            return None
        own = _free(f"x_{place}", taken), _free(f"kappa_{place}", taken)
        singles.append(Single(k, symbol, is_cosine, *own, inertia, potentials[k]))
    return divisor, tuple(singles), along


def _parts(
    value: Element, symbols: Mapping[int, sp.Symbol], cosines: _Cosines
) -> dict[int, Element] | None:
    """A sum of functions of one symbol each, by place; None where it is none.

    All but one symbol of a part are put at a place: cosines at zero, others at one.
    """
    found, rest = {}, value
    # Cosines last: most denominators have no zero there.
    order = sorted(symbols, key=lambda k: symbols[k] in cosines.cosines)
    for at, k in enumerate(order):
        table = {
            symbols[j]: sp.S.Zero if symbols[j] in cosines.cosines else sp.S.One
            for j in order[at + 1 :]
        }
        expr = rest.sympy.subs(table)
        if expr.has(sp.zoo, sp.nan, sp.oo):
            return None
        found[k] = cosines.field.read(expr)
        if any(not found[k].free_of(symbols[j]) for j in order if j != k):
            return None
        rest -= found[k]
    return found


def _by_powers(value: Element, symbol: sp.Symbol) -> list[tuple[Element, tuple[str, ...]]]:
    """Coefficients of a polynomial in a symbol and the powers, spelt out; else the value."""
    expr = value.sympy
    if not expr.is_polynomial(symbol):
        return [(value, ())]
    terms = sp.Poly(expr, symbol).terms()
    return [(value.field.read(x), (symbol.name,) * power) for (power,), x in terms if x]


def _free(name: str, taken: set[str]) -> str:
    """A name that is not taken."""
    while name in taken:
        name += "_"
    return name


# Smaller systems that stand in the place of the equations of frame velocities.
Reduction: TypeAlias = CyclicReduction | SeparatedReduction


@dataclass(frozen=True, eq=False)
class Reductions:
    """The smaller systems that may stand in the place of some equations.

    Examples
    --------
    >>> from geomtorsion.curves import geodesic
    >>> from geomtorsion.spaces import load
    >>> sphere = geodesic(load("s2").frame, [1, 0], [0.1, 0.3], parameters={"R": 1})
    >>> Reductions(sphere.equations("s2")).offered[0].system.states
    ('cos_theta', 'phi', 'x_theta')
    """

    equations: Equations

    def __getstate__(self) -> Mapping[str, object]:
        return only_fields(self)

    @cached_property
    def offered(self) -> tuple[Reduction, ...]:
        """Those that cost less; the cheapest first."""
        full = self.equations
        if full.momenta is None or not full.momenta.cyclic or full.chart is None:
            return ()
        # Where a root of the frame vanishes, momenta may grow without bound; velocities do not.
        if any(edge.is_root for edge in full.chart.edges):
            return ()
        if len(full.system.rates.steps) > LONGEST:
            return ()
        cyclic = CyclicReduction(full, full.momenta)
        offered = [one for one in (separated(cyclic), cyclic) if one is not None]
        costs = {id(one): cost(one.system.rates) for one in (full, *offered)}
        paying = [one for one in offered if costs[id(one)] < costs[id(full)]]
        return tuple(sorted(paying, key=lambda one: costs[id(one)]))

    def parts(self, members: Members) -> Iterator[Part]:
        """Members of an ensemble, each by the first smaller system by which it loses no digits."""
        rest, several = np.arange(len(members.states)), members.system is self.equations.system
        for one in self.offered:
            start, numbers, kept = one.reduced(members.states[rest], members.parameters[rest])
            if kept.any():
                own = numbers[kept]
                system = one.system if several else one.system.to_the_end
                yield Part(rest[kept], system, start[kept], own, one.lifted)
            rest = rest[~kept]
        if len(rest):
            full = members.states[rest], members.parameters[rest]
            yield Part(rest, members.system, *full)

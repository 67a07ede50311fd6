"""Separated: geodesics that fall apart into motions in one coordinate each.

Optional like `cyclic`, whose equations these replace where they are shorter still.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
import sympy as sp

from geomtorsion.codegen import Graph, Products, graph
from geomtorsion.curves.cyclic import ROUNDINGS, CyclicReduction
from geomtorsion.exact import Element, Field
from geomtorsion.exact.form import of_same_sign
from geomtorsion.ode.system import System
from geomtorsion.ode.trajectory import PER_STEP
from geomtorsion.precision import EPS

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
    >>> orbit.equations("kerr").reductions[0].system.states
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
        number, m, size = states.shape
        numbers = parameters[0] if number == 1 else np.repeat(parameters, m, axis=0).T
        full = self._to_cyclic(states.reshape(-1, size).T, numbers)
        rest = parameters[:, : len(self.cyclic.parameters)]
        return self.cyclic.lifted(rest, full.T.reshape(number, m, size))

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

"""Lagrange: the equations in the coordinates themselves, and whether they say the same."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.action.hamel import Hamel, HamelCoefficients, torsion_over
from geomtorsion.action.principles import Principle
from geomtorsion.action.tangent_bundle import TangentBundle

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Connection


@dataclass(frozen=True, eq=False)
class Lagrange:
    """d/dt P_mu - dL/dq^mu + X_mu nu^la q'^nu P_la - Q_mu, P_mu = dL/dq'^mu, from L(q, e q', t).

    X is the torsion that the principle takes off: zero for Hamilton's.

    bundle: the given frame, not adapted to constraints.
    lagrangian, forces: in q, u, t; forces F_k in the frame, Q_mu = e^k_mu F_k.
    principle, connection: how the action is varied.
    """

    bundle: TangentBundle
    lagrangian: sp.Expr
    forces: tuple[sp.Expr, ...]
    principle: Principle
    connection: Connection | None

    @cached_property
    def velocities(self) -> dict[sp.Symbol, sp.Expr]:
        """u^i = e^i_mu q'^mu, written out."""
        symbols = self.bundle.symbols
        found = {}
        for i, row in enumerate(self.bundle.frame.coframe.components.rows):
            terms = [value.sympy * symbols.rates[mu] for mu, value in row]
            found[symbols.velocities[i]] = sp.Add(*terms)
        return found

    def _read(self, where: str, expression: sp.Expr) -> Element:
        """An expression in q, u, t read with the coordinate velocities in place of u."""
        return self.bundle.frame.read([(where, expression.xreplace(self.velocities))])[0]

    @cached_property
    def residuals(self) -> tuple[Element, ...]:
        """One for each coordinate; they vanish on the motions without constraints."""
        bundle, symbols, field = self.bundle, self.bundle.symbols, self.bundle.field
        field.declare((*symbols.rates, *symbols.second_rates))
        rates = [field.symbol(symbol) for symbol in symbols.rates]
        second = [field.symbol(symbol) for symbol in symbols.second_rates]
        energy = self._read("lagrangian", self.lagrangian)
        momenta = [energy.diff(symbol) for symbol in symbols.rates]
        pushes = [self._read(f"forces[{k}]", value) for k, value in enumerate(self.forces)]
        terms: list[list] = []
        for momentum, symbol in zip(momenta, symbols.coordinates, strict=True):
            row = [(1, bundle.change(momentum, rates)), (-1, energy.diff(symbol))]
            pairs = zip(symbols.rates, second, strict=True)
            terms.append(row + [(1, momentum.diff(rate), value) for rate, value in pairs])
        for (a, b, c), value in self._torsion().items():
            terms[a].append((1, value, rates[b], momenta[c]))
        for k, row in enumerate(bundle.frame.coframe.components.rows):
            for mu, value in row:
                terms[mu].append((-1, value, pushes[k]))
        return tuple(field.sum(row) for row in terms)

    def _torsion(self) -> HamelCoefficients:
        """X_mu nu^la, what the principle takes off."""
        principle, frame = self.principle, self.bundle.frame
        if principle.frame_curl and not principle.image_torsion:
            return {}
        connection = self.connection if principle.image_torsion else None
        return torsion_over(frame, connection).components.nonzero

    def agrees(self, hamel: Hamel) -> bool | None:
        """Whether E_k^mu times these equals the equations in quasi-velocities, for free k.

        Decided by exact zero, after q' = E u and q'' = d/dt (E u) are put in.
        """
        field, symbols = hamel.bundle.field, hamel.bundle.symbols
        field.declare(symbols.accelerations)
        moving = {i: field.symbol(symbols.accelerations[i]) for i in hamel.free}
        table = dict(zip(symbols.rates, (rate.sympy for rate in hamel.rates), strict=True))
        for symbol, rate in zip(symbols.second_rates, hamel.rates, strict=True):
            terms = [(1, value, rate.diff(symbols.velocities[i])) for i, value in moving.items()]
            change = field.sum([(1, hamel.bundle.change(rate, hamel.rates)), *terms])
            table[symbol] = change.sympy
        covector = field.read_all(
            [("equation", value.sympy.xreplace(table)) for value in self.residuals]
        )
        verdicts = []
        for k in hamel.free:
            pairs, rest = hamel.residuals[k]
            expected = field.sum([(1, rest), *((1, value, moving[i]) for i, value in pairs)])
            columns = hamel.bundle.frame.legs.components.columns[k]
            terms = [(1, value, covector[mu]) for mu, value in columns]
            verdicts.append(field.sum([*terms, (-1, expected)]).is_zero)
        if False in verdicts:
            return False
        return None if None in verdicts else True

"""Writer: expressions for heyoka that keep their derivatives where a base vanishes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.exact.engine_code import HeyokaWriter

if TYPE_CHECKING:
    from geomtorsion.exact.form import Sum
    from geomtorsion.exact.generators import Generator


class SquaringWriter(HeyokaWriter):
    """Writes powers as squares and products.

    heyoka's series of x**n, n > 2, divides by x: on x = 0 it has no value, while its squares
    and products have.
    """

    def _power(self, base: Generator | Sum, exponent: int) -> Any:
        key = (base, exponent)
        if exponent > 2 and key not in self._known:
            square = self._power(base, exponent // 2) ** 2.0
            odd = exponent % 2
            self._known[key] = self._heyoka.prod([square, self._power(base, 1)]) if odd else square
        return super()._power(base, exponent)

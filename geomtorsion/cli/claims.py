"""claims: what the paper says in its equations (1) to (27), each statement recomputed."""

from __future__ import annotations

from functools import cache

from geomtorsion.cli import claims_geometry, claims_rotation, claims_translation
from geomtorsion.cli.printed import Claim


@cache
def claims() -> tuple[Claim, ...]:
    """All claims in the order of the paper, each recomputed now by the generic classes.

    Examples
    --------
    >>> [claim.equation for claim in claims() if not claim.agrees]
    ['(9) right', 'after (9)', '(17)', '(18)', 'around (21)', '(23)', 'under (24)', '(26)', '(27)']
    """
    turning, flying = claims_rotation, claims_translation
    return (
        *turning.first(),
        *flying.second(),
        *turning.third(),
        *flying.fourth(),
        *turning.between(),
        *claims_geometry.claims(),
        *turning.action(),
        *turning.variations(),
        *turning.principle(),
        *flying.geometry(),
        *flying.variations(),
        *flying.action(),
    )

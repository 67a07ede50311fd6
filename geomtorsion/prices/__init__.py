"""Prices: what digits, certainty and effects of any result cost, and which of them it needs.

ACCURACIES: relative errors that `price` requests by default.
PROOFS: numbers of digits that `price` proves by default.
"""

from geomtorsion.prices.effects.called_for import HasEffects, called_for
from geomtorsion.prices.effects.effect_budget import EffectBudget, EffectInfluence
from geomtorsion.prices.effects.effect_choice import Composite, Trial, choose
from geomtorsion.prices.effects.passed_over import passed_over
from geomtorsion.prices.effects.sensitivity import (
    Sensitivity,
    beside,
    growth,
    moved,
    relative_changes,
)
from geomtorsion.prices.measuring import price
from geomtorsion.prices.motions import Truth, motion_offer, tabulated, truth_of
from geomtorsion.prices.offer import (
    ACCURACIES,
    PROOFS,
    Bounds,
    Claim,
    HasPrice,
    Offer,
    Request,
    Way,
)
from geomtorsion.prices.price_list import PriceList, PriceRow

__all__ = [
    "ACCURACIES",
    "PROOFS",
    "Bounds",
    "Claim",
    "Composite",
    "EffectBudget",
    "EffectInfluence",
    "HasEffects",
    "HasPrice",
    "Offer",
    "PriceList",
    "PriceRow",
    "Request",
    "Sensitivity",
    "Trial",
    "Truth",
    "Way",
    "beside",
    "called_for",
    "choose",
    "growth",
    "motion_offer",
    "moved",
    "passed_over",
    "price",
    "relative_changes",
    "tabulated",
    "truth_of",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]

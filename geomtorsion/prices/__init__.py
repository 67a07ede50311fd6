"""Prices: what digits, certainty and effects of any result cost, and what a time buys."""

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
    "HasPrice",
    "Offer",
    "PriceList",
    "PriceRow",
    "Request",
    "Truth",
    "Way",
    "motion_offer",
    "price",
    "tabulated",
    "truth_of",
]

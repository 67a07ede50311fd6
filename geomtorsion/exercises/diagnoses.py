"""Diagnoses: the mistakes that are recognised, with what is said about each."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

# Code -> what the mistake is, in a few words.
TITLES: Mapping[str, str] = MappingProxyType(
    {
        "factor": "a factor 2",
        "sign": "the sign",
        "permuted": "indices permuted",
        "levi-civita": "Levi-Civita instead of Cartan",
        "cartan": "Cartan instead of Levi-Civita",
        "inverse": "the inverse is missing",
        "basis": "frame and coordinate components confused",
        "direction": "the loop run the other way",
        "axes": "body and space axes confused",
        "degrees": "degrees for radians",
        "domain": "right on a part of the domain only",
        "naive": "the naive variation",
        "principle": "the other action principle",
        "forgotten": "a term is forgotten",
        "counted": "indices counted from 0",
        "unit": "another unit",
        "rounded": "rounded too early",
        "incomplete": "some components are wrong",
        "empty": "no answer",
        "unreadable": "cannot be read",
        "too large": "too large to be checked",
    }
)
# Code -> what is said to a student, if the exercise says nothing of its own.
MESSAGES: Mapping[str, str] = MappingProxyType(
    {
        "factor": "It is off by a factor 2. Is there a half to keep or to drop, as in S = T/2?",
        "sign": "The sign is wrong. Which lower index of the connection differentiates? Here it is "
        "the first; books that put it last have the opposite torsion.",
        "permuted": "The components are right, but stand at other indices: an index was moved, as "
        "if a matrix were transposed or the derivative index stood elsewhere.",
        "levi-civita": "That is what the Levi-Civita connection of the metric gives; the question "
        "is about the Cartan connection of the frame.",
        "cartan": "That is what the Cartan connection of the frame gives; the question is about "
        "the Levi-Civita connection of the metric.",
        "inverse": "An inverse is missing: the coframe stands where its inverse, the legs, should "
        "(or the metric where the inverse metric should), or the other way round.",
        "basis": "That is in another basis: frame components and coordinate components have been "
        "exchanged. Look at where each index is to be taken.",
        "direction": "The loop was run through the other way.",
        "axes": "That is seen from the other axes: body axes and space axes have been exchanged.",
        "degrees": "An angle in degrees was taken for one in radians, or the other way round.",
        "domain": "That is right on a part of the domain only: a root has the wrong sign on the "
        "rest of it.",
        "naive": "That is what varying in the frame as if its forms were closed would give. The "
        "gyroscopic terms are missing.",
        "principle": "That follows from the other action principle: look again at where the "
        "variations close.",
        "forgotten": "A term is missing.",
        "counted": "Indices are counted from 1 here; yours seem to be counted from 0.",
        "unit": "The number has another unit than the question asks for.",
        "rounded": "Close, but not within the tolerance: rounded too early?",
    }
)

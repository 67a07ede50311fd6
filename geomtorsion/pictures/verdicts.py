"""Verdicts: identities and known answers of a space, each with its outcome."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from geomtorsion.geometry import cartan, identities, levi_civita
from geomtorsion.geometry.quantities import entry
from geomtorsion.spaces import disagreements

if TYPE_CHECKING:
    from geomtorsion.geometry import IdentityCheck
    from geomtorsion.spaces import KnownAnswer, Space

# A space's own connection may lack these properties: they are not identities.
PROPERTIES = ("metricity",)


@dataclass(frozen=True)
class Verdict:
    """Result of one check.

    name: of the check. holds: True, False, or None where it cannot be decided. equation: the
    formula that was compared, if any. detail: how often, by whom, and the first place of a failure.
    required: whether it has to hold.
    """

    name: str
    holds: bool | None
    equation: str
    detail: str
    required: bool = True

    @property
    def failed(self) -> bool:
        """Whether something that has to hold does not."""
        return self.required and self.holds is False


def verdicts(
    space: Space, progress: Callable[[str], object] = lambda _: None
) -> dict[str, list[Verdict]]:
    """Verdicts by group: the connections of the space, then its known answers.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> groups = verdicts(load("s2"))
    >>> list(groups)
    ['Cartan connection', 'Levi-Civita connection', 'Known answers']
    >>> all(verdict.holds for found in groups.values() for verdict in found)
    True
    """
    connections = {
        "Cartan connection": cartan(space.frame),
        "Levi-Civita connection": levi_civita(space.frame),
    }
    if space.connection is not None:
        connections["The space's own connection"] = space.connection
    groups = {}
    for title, connection in connections.items():
        progress(title)
        own = connection is space.connection
        groups[title] = [of_identity(identity, own=own) for identity in identities(connection)]
    if space.known:
        progress("known answers")
        groups["Known answers"] = [_of_answer(space, answer) for answer in space.known]
    return groups


def of_identity(identity: IdentityCheck, *, own: bool = False) -> Verdict:
    """The verdict on an identity; own: of a connection that the space brings."""
    # A connection with nonmetricity is not a mistake: metricity is a property there.
    required = not (own and identity.name in PROPERTIES)
    detail = f"{identity.checked} component{'s' * (identity.checked != 1)}"
    if identity.worst is not None:
        # As people count, from 1.
        detail += f", first at component {','.join(str(k + 1) for k in identity.worst)}"
    detail += "" if required else "; a property, not an identity"
    return Verdict(identity.name, identity.holds, identity.equation, detail, required)


def _of_answer(space: Space, answer: KnownAnswer) -> Verdict:
    wrong = disagreements(space, answer)
    name = entry(answer.quantity).title
    source = f": {answer.source}" if answer.source else " with the source"
    if wrong:
        return Verdict(name, False, "", f"{wrong[0]} (disagrees{source})")
    return Verdict(name, True, "", f"agrees{source}")

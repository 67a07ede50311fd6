"""equations: what follows from an action, in closed form, as the page shows it."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.action import EquationsOfMotion, equations_of_motion
from geomtorsion.action.principles import principle_named
from geomtorsion.action.writing import dotted
from geomtorsion.exercises.worker_pool import Json
from geomtorsion.lab import views
from geomtorsion.lab.space_info import space_of
from geomtorsion.lab.tetrad import names_of
from geomtorsion.pictures.formula import mathml
from geomtorsion.pictures.text import greek_words

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

# Principle -> what it is called in the list.
PRINCIPLES = {
    "closed_in_coordinates": "Hamilton: closed in the coordinates",
    "closed_in_image": "Kleinert: closed in the image",
    "naive": "naive: as if there were no torsion",
}


def equations(
    space: str,
    lagrangian: str,
    parameters: str = "",
    principle: str = "closed_in_coordinates",
) -> Json:
    """Equations of motion over a shipped space, and what they keep.

    Parameters
    ----------
    lagrangian
        Text in the coordinates, the velocities u1, u2, ... of the frame, and parameters.
    parameters
        Names with commas between them.
    principle
        A key of PRINCIPLES.

    Returns
    -------
    html: cards. sentence: whether two derivations agree, and what the principle leads to.
    rates: name -> text.

    Examples
    --------
    >>> found = equations("so3", "(I1*u1^2 + I2*u2^2 + I3*u3^2)/2", "I1, I2, I3")
    >>> found["rates"]["u1"], found["sentence"].partition(": ")[2].partition(".")[0]
    ('u2*u3*(I2 - I3)/I1', 'the same, exactly')
    """
    frame = space_of(space).frame
    names = [name for name in names_of(parameters, "parameters") if not _belongs(frame, name)]
    found = equations_of_motion(frame, lagrangian, principle=principle, parameters=names)
    cards = [_card("Equations of motion", found.rates)]
    kept = found.invariants
    if kept:
        cards.append(_card("What stays", kept, is_rate=False))
    said = {
        True: "Derived twice, in the frame and in the coordinates: the same, exactly.",
        False: "Derived twice, in the frame and in the coordinates: not the same.",
        None: "Derived twice, in the frame and in the coordinates: whether they are the same is "
        "not decided.",
    }[found.agrees]
    return {
        "html": "".join(cards),
        "sentence": f"{said} For a kinetic energy: {principle_named(principle).leads_to}.",
        "rates": _texts(found),
    }


def curve_equations(space: str) -> Json:
    """Equations of the straightest and the shortest curves of a shipped space.

    Returns
    -------
    html: cards. sentence: whether they are the same. straightest, shortest: name -> text.

    Examples
    --------
    >>> found = curve_equations("flat_polar")
    >>> found["straightest"]["u2"], found["shortest"]["u2"]
    ('0', '-u1*u2/r')
    """
    frame = space_of(space).frame
    n = frame.dimension
    u = [sp.Symbol(f"u{k + 1}") for k in range(n)]
    length = sum((frame.eta[i, k] * u[i] * u[k] for i in range(n) for k in range(n)), sp.S.Zero) / 2
    straight = equations_of_motion(frame, length, principle="closed_in_image")
    short = equations_of_motion(frame, length)
    first, second = _texts(straight), _texts(short)
    said = (
        "Straightest and shortest curves have one equation here: they are the same."
        if first == second
        else "The straightest keep u; what the shortest have more is the torsion force."
    )
    cards = _card("Straightest (autoparallels)", straight.rates)
    cards += _card("Shortest (geodesics)", short.rates)
    return {"html": cards, "sentence": said, "straightest": first, "shortest": second}


def _belongs(frame: Frame, name: str) -> bool:
    """Whether a name is one of the frame's own."""
    return name in {symbol.name for symbol in (*frame.coordinates, *frame.parameters)}


def _texts(found: EquationsOfMotion) -> dict[str, str]:
    return {name: str(rate) for name, rate in found.rates.items()}


def _card(title: str, values: Mapping[str, sp.Expr], *, is_rate: bool = True) -> str:
    """Lines of formulas, with a button that copies them."""
    lines = [
        (dotted(name) if is_rate else f"\\text{{{greek_words(name)}}}", sp.latex(value))
        for name, value in values.items()
    ]
    joined = " \\\\\n".join(f"{left} &= {right}" for left, right in lines)
    button = views.copy_button(f"\\begin{{aligned}}\n{joined}\n\\end{{aligned}}", title)
    shown = "".join(
        f'<div class="scroll">{mathml(f"{left} = {right}", display=True)}</div>'
        for left, right in lines
    )
    return f'<section class="card"><h3>{escape(title)}</h3>{shown}{button}</section>'

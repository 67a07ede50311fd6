"""particles: the spectrum of a theory as a table and as a figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy

from geomtorsion.gravity.perturbed import Particle, Spectrum
from geomtorsion.pictures.formula import mathml
from geomtorsion.pictures.latex import latex_text
from geomtorsion.pictures.style import SERIES, captioned, new_figure
from geomtorsion.pictures.text import plain_text
from geomtorsion.support import checks
from geomtorsion.support.outgoing import figure_text, html_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Kinds of particles, and what each colour means.
KINDS = {
    "healthy": "positive energy, no tachyon",
    "open": "depends on the couplings",
    "ill": "ghost, tachyon or double pole",
}


def spectrum_html(spectrum: Spectrum) -> str:
    """Particles of a theory as a table with formulas, for notebooks.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> spectrum_html(perturbed.spectrum("R/2 + c*R**2", "riemannian")).count("<tr>")
    3
    """
    head = "".join(f"<th>{x}</th>" for x in ("particle", "mass²", "energy", "modes"))
    rows = [
        f"<tr><td>{html_text(_name(one))}</td><td>{_mass(one)}</td><td>{_energy(one)}</td>"
        f"<td>{one.number}</td></tr>"
        for one in spectrum.particles
    ]
    first, *_, last = str(spectrum).splitlines()
    return (
        f"<div><p>{html_text(first)}</p><table><thead><tr>{head}</tr></thead>"
        f"<tbody>{''.join(rows)}</tbody></table><p>{html_text(last)}</p></div>"
    )


def _name(particle: Particle) -> str:
    return f"helicity {particle.label}" if particle.is_massless else f"spin {particle.label}"


def _mass(particle: Particle) -> str:
    if particle.mass2 is None:
        return mathml(f"{latex_text(particle.equation)} = 0")
    return mathml(latex_text(particle.mass2))


def _energy(particle: Particle) -> str:
    if particle.energy is None:
        return f"double pole {mathml(latex_text(particle.factor**2))}"
    if particle.energy.is_number:
        return "positive" if particle.energy > 0 else "negative (ghost)"
    return f"sign of {mathml(latex_text(particle.energy))}"


def _kind(particle: Particle) -> str:
    energy, mass2 = particle.energy, particle.mass2
    if energy is None or energy.is_negative or particle.is_tachyon:
        return "ill"
    massive = mass2 is not None and (particle.is_massless or mass2.is_positive)
    return "healthy" if energy.is_positive and massive else "open"


def draw_particles(spectrum: Spectrum) -> Figure:
    """Particles of a theory by spin and parity, each with its mass.

    The colour shows whether the energy is positive and the mass real. Massless particles have a row
    of their own, by helicity.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        The argument is not a spectrum.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(spectrum, Spectrum, "spectrum")
    labels = list(dict.fromkeys(_name(one) for one in spectrum.particles))
    figure = new_figure(7.6, 1.7 + 0.55 * max(len(labels), 1))
    axes = figure.add_subplot()
    colours = {"healthy": SERIES[0].color, "open": "0.6", "ill": SERIES[1].color}
    rows = dict.fromkeys(labels, 0)
    for one in spectrum.particles:
        name = _name(one)
        place = rows[name]
        rows[name] += 1
        y = -labels.index(name) - 0.28 * place
        axes.plot(0, y, "o", color=colours[_kind(one)], markersize=6 + 2 * min(one.number, 5))
        axes.annotate(figure_text(_text(one)), (0, y), (22, 0), textcoords="offset points",
                      va="center", fontsize=9)  # fmt: skip
    if not labels:
        axes.text(0.5, 0, "no particles", ha="center", fontsize=9)
    axes.set_yticks([-k for k in range(len(labels))], labels)
    axes.set_xticks([])
    axes.set_xlim(-0.06, 1)
    axes.set_ylim(-max(len(labels), 1) + 0.3, 0.6)
    for side in ("top", "right", "bottom"):
        axes.spines[side].set_visible(False)
    used = {_kind(one) for one in spectrum.particles}
    handles = [
        axes.plot([], [], "o", color=colours[kind], label=text)[0]
        for kind, text in KINDS.items()
        if kind in used
    ]
    if handles:
        figure.legend(handles=handles, loc="outside upper left", ncols=len(handles), frameon=False,
                      fontsize=8)  # fmt: skip
    first, *_, last = str(spectrum).splitlines()
    captioned(figure, [figure_text(first), figure_text(checks.cut(last))])
    return figure


def _text(particle: Particle) -> str:
    """Mass and number of modes in one line."""
    modes = f"{particle.number} mode{'s' if particle.number > 1 else ''}"
    modes += ", double pole" * particle.is_dipole
    if particle.is_massless:
        return f"massless, {modes}"
    if particle.mass2 is None:
        return f"mass from a polynomial of degree {sympy.degree(particle.equation)}, {modes}"
    return f"m² = {checks.cut(plain_text(particle.mass2))}, {modes}"

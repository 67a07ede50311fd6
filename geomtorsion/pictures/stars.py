"""stars: mass and radius of a family of stars, and the inside of one star."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import ArgumentError
from geomtorsion.gravity import Family, Star
from geomtorsion.pictures.style import SERIES, captioned, new_figure, pictured
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_stars(stars: Family | Star) -> Figure:
    """Draw mass over radius of a family with its heaviest star, or the inside of one star.

    The second panel of a family shows the tidal Love number over the compactness.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        It is neither a star nor a family of stars.
    MissingExtraError
        matplotlib is not installed.
    """
    if not isinstance(stars, Family | Star):
        raise ArgumentError(
            f"stars: expected a star or a family of stars, got {checks.shown(stars)}. Give "
            "gt.gravity.family(...) or gt.gravity.star(...)."
        )
    figure = new_figure(9.2, 3.9)
    left, right = figure.subplots(1, 2)
    if isinstance(stars, Star):
        _draw_inside(left, right, stars)
        captioned(figure, [repr(stars)])
    else:
        _draw_family(left, right, stars)
        captioned(figure, str(stars).splitlines())
    return figure


def _draw_family(left: Axes, right: Axes, stars: Family) -> None:
    """Mass over radius; the Love number, or the mass over the density at the centre."""
    scale = stars.matter.scale
    heaviest = stars.peak
    last = int(np.argmax(stars["mass"])) + 1
    parts = [(slice(0, last), "-", "stable")]
    if last < len(stars):
        parts.append((slice(last - 1, None), "--", "unstable"))
    names = ("compactness", "love_number") if "love_number" in stars.columns else (
        "density", "mass"
    )  # fmt: skip
    for part, line, label in parts:
        left.plot(stars["radius"][part], stars["mass"][part], line, marker=".",
                  color=SERIES[0].color, label=label)  # fmt: skip
        right.plot(stars[names[0]][part], stars[names[1]][part], line, marker=".",
                   color=SERIES[0].color)  # fmt: skip
    if heaviest is not None:
        left.plot(heaviest.radius, heaviest.mass, "o", color=SERIES[1].color, label="heaviest")
        right.plot(heaviest.numbers[names[0]], heaviest.numbers[names[1]], "o",
                   color=SERIES[1].color)  # fmt: skip
    left.set_xlabel(_unit("radius", scale.length_word))
    left.set_ylabel(_unit("mass", scale.mass_word))
    left.legend(frameon=False, fontsize=9)
    if names[1] == "love_number":
        right.set_xlabel("compactness GM/(c²R)")
        right.set_ylabel("tidal Love number k₂")
    else:
        right.set_xlabel("density at the centre")
        right.set_ylabel(_unit("mass", scale.mass_word))
        right.set_xscale("log")


def _draw_inside(left: Axes, right: Axes, star: Star) -> None:
    """Pressure and density, and the mass inside of a sphere, over the radius."""
    scale, solution = star.matter.scale, star.solution
    radius = solution["r"]
    left.plot(radius, solution["p"] / solution["p"][0], color=SERIES[0].color, label="pressure")
    left.plot(radius, solution["rho"] / solution["rho"][0], color=SERIES[1].color, label="density")
    left.set_ylabel("part of the value at the centre")
    left.legend(frameon=False, fontsize=9)
    right.plot(radius, solution["m"] / scale.mass, color=SERIES[0].color)
    right.set_ylabel(_unit("mass inside", scale.mass_word))
    for axes in (left, right):
        axes.set_xlabel(_unit("radius", scale.length_word))


def _unit(name: str, unit: str) -> str:
    return f"{name} in {unit}" if unit else name


def stars_html(stars: Family | Star) -> str:
    """Text and figure, for notebooks."""
    return pictured(str(stars), lambda: draw_stars(stars))

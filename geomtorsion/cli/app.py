"""app: the commands in one place."""

from __future__ import annotations

from typing import Annotated, ClassVar

import typer

from geomtorsion.cli.lazy import SETTINGS, LazyGroup
from geomtorsion.support.checks import near_names


class Commands(LazyGroup):
    """The commands: the module geomtorsion.cli.commands.NAME holds the function NAME."""

    module = "geomtorsion.cli.commands.{}"
    summaries: ClassVar = {
        "spaces": "List the shipped spaces.",
        "geometry": "Show metric, connections, torsion and curvature.",
        "symmetries": "Show the symmetries of a space, their Lie algebra, and the holonomy.",
        "gravity": "Show the field equations of a Lagrangian on a space.",
        "spectrum": "List the particles of a theory of gravity about flat space.",
        "count": "Count the degrees of freedom of a full nonlinear theory.",
        "modes": "Report the waves of a theory of gravity on a flat cosmos.",
        "post-newtonian": "Compare a theory of gravity with measurements in the solar system.",
        "ringing": "Compute the quasinormal frequencies at which a static black hole rings.",
        "star": "Compute mass, radius and tidal response of stars from a table of matter.",
        "charge": "Compute the mass, spin or charge inside a surface, or the horizons of a hole.",
        "constraints": "Check whether initial data on a grid satisfy the constraints of gravity.",
        "check": "Check the identities of a space exactly.",
        "same": "Decide whether two spaces are one geometry in different coordinates.",
        "identify": "Find the shipped space that a tetrad describes in other coordinates.",
        "plan": "Show the steps that a quantity or a scene needs, and those it omits.",
        "report": "Write a page with the geometry, motions and a loop of a space.",
        "shadow": "Compute the shadow of a black hole in the light that reaches a camera.",
        "curve": "Follow the straightest and the shortest path from one start.",
        "orbit": "Find a closed orbit, and prove that it exists with its period and stability.",
        "fit": "Fit parameters and the start of a motion to recorded data.",
        "price": "Measure the cost of digits and certainty for a motion, a loop or a scene.",
        "burgers": "Compute the Burgers vectors of loops: the gaps by which they fail to close.",
        "circuit": "Compute the Burgers vectors of circuits through measured data.",
        "map": "Map the Burgers vector per area of a measured field, and compare it with noise.",
        "crystal": "Find the dislocation lines of a crystal, with their Burgers vectors.",
        "network": "Read a dislocation network, and check that b is conserved at its nodes.",
        "stress": "Compute the stress of dislocation lines or of a measured torsion.",
        "run": "Run a scene: a body, the effects on it, and the watched quantities.",
        "scenes": "List the shipped scenes; with a name, print that scene as a file.",
        "paper": "Recompute the equations of Fiziev and Kleinert (1994).",
        "lab": "Serve the classroom page: tetrads, loops, curves, tops and exercises in a browser.",
        "exercises": "List, show, check and grade exercises.",
    }
    groups: ClassVar = {
        "Geometry": (
            "spaces",
            "geometry",
            "symmetries",
            "check",
            "same",
            "identify",
            "plan",
            "gravity",
            "spectrum",
            "count",
            "modes",
            "post-newtonian",
            "ringing",
            "star",
            "charge",
            "constraints",
            "report",
            "paper",
        ),
        "Motions": ("curve", "orbit", "shadow", "fit", "run", "scenes", "price"),
        "Defects and data": ("burgers", "circuit", "map", "crystal", "network", "stress"),
        "Teaching": ("lab", "exercises"),
    }  # fmt: skip
    # Lists are printed at once, and the page is served until Ctrl-C.
    limited = frozenset(summaries) - {"spaces", "scenes", "lab", "exercises"}

    def _about(self, word: str) -> str:
        """Also the command for a quantity, such as ricci, or for a space, such as kerr."""
        # Only a wrong name needs these tables, which take longer to load than the list.
        from geomtorsion.geometry.quantities import QUANTITIES
        from geomtorsion.spaces import names

        quantity = near_names(word.lower(), QUANTITIES)
        other = f"geometry SPACE --only {quantity}" if quantity else ""
        return super()._about(word) or (f"geometry {word}" if word in names() else other)


app = typer.Typer(
    cls=Commands,
    name="geomtorsion",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    **{**SETTINGS, "add_completion": True},
)


def installed_version() -> str:
    """Version of the installed package."""
    # Loading this takes longer than the rest of the list of commands.
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("geomtorsion")
    except PackageNotFoundError:
        return "unknown (not installed)"


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"geomtorsion {installed_version()}")
        raise typer.Exit


@app.callback()
def geomtorsion(
    _version: Annotated[
        bool,
        # Eager: the version is shown although no command is given.
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="Show the version and stop."
        ),
    ] = False,
) -> None:
    """Compute the exact geometry of a tetrad (a field of rulers).

    \b
    Examples:
      geomtorsion spaces
      geomtorsion geometry so3 --only torsion,ricci
      geomtorsion report so3 -o so3-report
    """

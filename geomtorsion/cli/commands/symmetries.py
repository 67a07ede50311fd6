"""symmetries: vector fields that keep a geometry, their algebra, and the holonomy algebra."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import Annotated

import typer

from geomtorsion import gravity
from geomtorsion.cli.options import Form, Shown, SpaceOrFile
from geomtorsion.cli.sources import open_space
from geomtorsion.cli.terminal import working
from geomtorsion.cli.theories import Over, connection_of
from geomtorsion.errors import ArgumentError
from geomtorsion.geometry import HolonomyAlgebra
from geomtorsion.same import Symmetries


class Keep(StrEnum):
    """How far a symmetry keeps the metric."""

    metric = "metric"
    homothetic = "homothetic"
    conformal = "conformal"


def symmetries(
    source: SpaceOrFile,
    connection: Annotated[
        Over,
        typer.Option(
            "--connection",
            "-c",
            help="Connection that the symmetries preserve besides the metric; own: of the space, "
            "or Cartan if it has none.",
        ),
    ] = Over.levi_civita,
    keep: Annotated[
        Keep,
        typer.Option(
            help="metric: isometries. homothetic: the metric changes by a constant factor. "
            "conformal: by a function. The last two need the Levi-Civita connection.",
        ),
    ] = Keep.metric,
    form: Shown = Form.text,
) -> None:
    """Show the symmetries of a space, their Lie algebra, and the holonomy.

    The number of symmetries and the algebra are exact. X_0, X_1, ... are the vectors in their
    order, or a basis at one point if some vectors have no closed form. In JSON the structure
    constants have the keys i,j,k of [X_i, X_j] = C X_k. The holonomy algebra generates the
    rotations of vectors by parallel transport around loops.

    \b
    Examples:
      geomtorsion symmetries schwarzschild
      geomtorsion symmetries frw -c cartan
      geomtorsion symmetries s3 --keep conformal
      geomtorsion symmetries pp_wave --format json
    """
    with working(source):
        space = open_space(source)
        chosen = connection_of(space, connection)
        if keep is not Keep.metric and connection is not Over.levi_civita:
            raise ArgumentError(
                f"--keep {keep.value}: expected the Levi-Civita connection, got "
                f"{connection.value}. Omit -c, or --keep."
            )
        found = gravity.symmetries(space.frame, chosen if keep is Keep.metric else keep.value)
        holonomy = chosen.holonomy_algebra
        # Computed here, so that limits and the progress line apply.
        document = {"space": space.name, **_data(found, holonomy)}
        text = _text(space.name, found, holonomy)
    typer.echo(json.dumps(document, indent=2) if form is Form.json else text)


def _text(name: str, found: Symmetries, holonomy: HolonomyAlgebra) -> str:
    """Both algebras, to read."""
    algebra = [str(found.algebra), ""] if found.dimension else []
    return "\n".join([f"{name}: {found}", "", *algebra, str(holonomy)])


def _data(found: Symmetries, holonomy: HolonomyAlgebra) -> dict[str, object]:
    """Both algebras, for programs."""
    algebra, n = found.algebra, found.frame.dimension
    return {
        "preserved": found.kept,
        "dimension": found.dimension,
        "orbits": found.orbits,
        "algebra": algebra.name,
        "structure_constants": {
            ",".join(map(str, index)): str(value) for index, value in algebra.brackets().items()
        },
        "killing_form": algebra.signature,
        "derived_series": algebra.derived_series,
        "vectors": [[str(one[a]) for a in range(n)] for one in found.closed_form],
        "holonomy": {
            "name": holonomy.name,
            "dimensions": holonomy.dimensions,
            "parallel_vectors": holonomy.parallel("u"),
        },
    }

"""tensors: the components of a tensor with two indices at a point, as a coloured matrix."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from sympy import latex

from geomtorsion.errors import ShapeError
from geomtorsion.geometry import Tensor
from geomtorsion.pictures.style import new_figure
from geomtorsion.support import checks

if TYPE_CHECKING:
    from collections.abc import Mapping

    import sympy
    from matplotlib.figure import Figure


def draw_tensor(tensor: Tensor, at: Mapping[str | sympy.Symbol, float] | None = None) -> Figure:
    """Components of a tensor with two indices at a point: first index down, second index across.

    Colours run from the negative to the positive end of the largest modulus; complex ones show
    their real parts.

    at: value of each coordinate and parameter on which the tensor depends.

    Raises
    ------
    ShapeError
        The tensor does not have two indices.
    MissingValueError
        A symbol has no value.
    MissingExtraError
        matplotlib is not installed.
    """
    checks.instance(tensor, Tensor, "tensor")
    if len(tensor.slots) != 2:
        raise ShapeError(
            f"{tensor.label}: expected a tensor with two indices, got {len(tensor.slots)}. "
            "Contract it, or read its components from tensor.table()."
        )
    values = tensor.at(at or {})
    figure = new_figure(5.2, 4.6)
    axes = figure.add_subplot()
    reach = float(np.abs(values).max()) or 1.0
    image = axes.imshow(np.real(values), cmap="RdBu_r", vmin=-reach, vmax=reach)
    names = [f"${latex(symbol)}$" for symbol in tensor.frame.coordinates]
    legs = [str(k + 1) for k in range(tensor.frame.dimension)]
    down, across = (names if slot in "du" else legs for slot in tensor.slots)
    axes.set_yticks(range(len(down)), down)
    axes.set_xticks(range(len(across)), across)
    for (i, k), value in np.ndenumerate(values):
        ink = "white" if abs(value.real) > reach / 2 else "black"
        axes.text(k, i, f"{value:.4g}", ha="center", va="center", color=ink)
    axes.set_title(tensor.name or tensor.label, fontsize=11)
    figure.colorbar(image, ax=axes)
    return figure

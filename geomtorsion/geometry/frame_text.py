"""Text of a frame: a tetrad file in TOML, as `geomtorsion.read` reads it."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING

import sympy as sp
from sympy.core.function import AppliedUndef

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame

# Assumptions of a tetrad file; the first that a parameter has is written.
ASSUMPTIONS = (
    "positive", "negative", "nonnegative", "nonpositive", "integer", "nonzero", "real", "complex",
)  # fmt: skip


def toml_text(frame: Frame) -> str:
    """See Frame.to_toml."""
    rows = [_list(row) for row in frame.coframe.tolist()]
    eta = frame.eta.tolist()
    diagonal = [eta[k][k] for k in range(frame.dimension)]
    is_diagonal = sp.Matrix(eta) == sp.diag(*diagonal) and set(diagonal) <= {1, -1}
    lines = [f"name = {json.dumps(frame.name)}"] if frame.name else []
    lines.append(f"coordinates = {_list(frame.coordinates)}")
    if not is_diagonal:
        lines += ["signature = [", *(f"  {_list(row)}," for row in eta), "]"]
    elif -1 in diagonal:
        lines.append(f"signature = [{', '.join(map(str, diagonal))}]")
    if frame.complex:
        lines.append("complex = true")
    if frame.domain:
        lines.append(f"domain = {_list(frame.domain)}")
    lines += ["coframe = [", *(f"  {row}," for row in rows), "]"]
    parameters = [f'{symbol} = "{_assumption(symbol)}"' for symbol in frame.parameters]
    applied = sorted(sp.Array(frame.coframe.tolist()).atoms(AppliedUndef), key=str)
    functions = [f"{one.func} = {_list(one.args)}" for one in applied]
    names = [f"{name} = {_text(value)}" for name, value in frame.names.items()]
    tables = {"parameters": parameters, "functions": functions, "names": names}
    for key, entries in tables.items():
        if entries:
            lines += ["", f"[{key}]", *entries]
    return "\n".join(lines) + "\n"


def _list(items: Iterable[object]) -> str:
    return f"[{', '.join(_text(item) for item in items)}]"


def _text(item: object) -> str:
    """A whole number as it is, everything else in quotes."""
    return str(item) if isinstance(item, sp.Integer) else json.dumps(str(item), ensure_ascii=False)


def _assumption(symbol: sp.Symbol) -> str:
    return next((one for one in ASSUMPTIONS if symbol.assumptions0.get(one)), "complex")

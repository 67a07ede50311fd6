"""Evolution: numbers of waves on a given cosmos over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.exact import parse_expression
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.gravity.perturbed.geometries import T, shown
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.support import checks
from geomtorsion.support.displays import Plot, figure_by

# The rate of expansion of a cosmos.
RATE = sp.Function("H")(T)


@dataclass(frozen=True, eq=False, repr=False)
class Evolution:
    """Speeds and other numbers of waves over time on a given cosmos.

    lagrangian: the theory. cosmos: a(t), fields and couplings by name.
    times: shape (n,), in the unit of t. values: numbers by name, each of shape (n,).

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> waves = perturbed.tensor_modes("R/2 + phi**2*R/2 - X/2", "riemannian", scalars="phi")
    >>> evolution = waves.over_time([1, 2], a="t**(1/2)", phi="t")
    >>> evolution.values["alpha_M"].tolist(), evolution.values["speed2"].tolist()
    ([2.0, 3.2], [1.0, 1.0])
    """

    lagrangian: Lagrangian
    cosmos: Mapping[str, sp.Expr]
    times: np.ndarray
    values: Mapping[str, np.ndarray]

    plot: ClassVar[Plot] = figure_by("modes", "draw_evolution")

    def to_json(self) -> dict[str, Any]:
        """The numbers as lists, by name."""
        return {
            "lagrangian": str(self.lagrangian.expression),
            "cosmos": {name: str(x) for name, x in self.cosmos.items()},
            "times": self.times.tolist(),
            **{name: x.tolist() for name, x in self.values.items()},
        }

    def __str__(self) -> str:
        given = ", ".join(f"{name} = {x}" for name, x in self.cosmos.items())
        lines = [f"waves of {self.lagrangian!r} for {given}"]
        first, last = self.times[0], self.times[-1]
        for name, x in self.values.items():
            lines.append(f"{name} from {x[0]:.6g} at t = {first:g} to {x[-1]:.6g} at t = {last:g}")
        return "\n".join(lines)

    __repr__ = __str__


def evolution(
    lagrangian: Lagrangian,
    formulas: Mapping[str, sp.Expr],
    times: ArrayLike,
    cosmos: Mapping[str, object],
) -> Evolution:
    """Formulas in H(t), fields and couplings as numbers at times on a cosmos.

    Raises
    ------
    GravityError
        A function or a coupling has no value, or a name does not occur.
    SingularPointError
        A number is not finite at a time.
    """
    points = checks.array(times, "times", GravityError, shape=(None,))
    if not points.size:
        checks.refuse(GravityError, "times", "at least one time", times)
    given = {name: _read(name, value) for name, value in cosmos.items()}
    functions = {x for one in formulas.values() for x in one.atoms(AppliedUndef)}
    symbols = {x for one in formulas.values() for x in one.free_symbols} - {T}
    known = {x.func.__name__ for x in functions} | {x.name for x in symbols} | {"a"}
    for name in given:
        checks.known_name(name, known - {"H"}, "field or coupling", GravityError)
    if "a" not in given:
        raise GravityError(
            "over_time: expected a scale factor, got none. Give a='t**(2/3)' or another function "
            "of t."
        )
    scale = given["a"]
    values: dict[sp.Basic, sp.Expr] = {RATE: sp.diff(scale, T) / scale}
    for x in (*functions, *symbols):
        name = x.func.__name__ if isinstance(x, AppliedUndef) else str(x)
        if name in given and (x.is_Symbol or x.args == (T,)):
            values[x] = given[name]
    line = Frame([T], [[1]])
    numbers = {}
    for name, one in formulas.items():
        expression = one.subs(values).doit()
        rest = expression.atoms(AppliedUndef) | (expression.free_symbols - {T})
        if rest:
            missing = min(rest, key=str)
            raise GravityError(
                "over_time: expected values for all fields and couplings, got none for "
                f"{shown(missing)}, which occurs in {name}. Give it by name, or write the function "
                "in the Lagrangian."
            )
        numbers[name] = Tensor(line, "", {(): expression}, symbol=name).at({T: points})
    return Evolution(lagrangian, given, points, numbers)


def _read(name: str, value: object) -> sp.Expr:
    """A function of t or a number, from text or an expression."""
    return checks.expression(
        value,
        name,
        GravityError,
        read=lambda text: parse_expression(text, {"t": T}, where=name),
    )

"""Writing: field equations as lines of text and of LaTeX, each equation once."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

import sympy as sp

from geomtorsion.exact import TexPrinter
from geomtorsion.geometry import Tensor
from geomtorsion.gravity.theory.distinct import marks
from geomtorsion.support.displays import latex_of

HOLDS = "all equations hold"


@dataclass(frozen=True)
class Lines:
    """Field equations as lines.

    scalars: values of the invariants. equations: left sides by labels such as E_1^1. fields: names
    of the matter fields.
    """

    scalars: Mapping[str, sp.Expr]
    equations: Mapping[str, sp.Expr]
    fields: Collection[str]

    @property
    def _values(self) -> list[tuple[str, sp.Expr]]:
        """Invariants with their values, without fields that are known by their names."""
        return [(name, value) for name, value in self.scalars.items() if str(value.func) != name]

    def text(self) -> list[str]:
        """Values of invariants, and the equations."""
        lines = [f"{name} = {value}" for name, value in self._values]
        for name, x in self.equations.items():
            bare = bare_name(name)
            label = f"equation of {name}:" if bare in self.fields else f"{name} ="
            lines.append(f"{label} {x} = 0")
        if not self.equations:
            lines.append(HOLDS)
        return [f"  {line}" for line in lines]

    def latex(self) -> str:
        """Values of invariants, and the equations, as an `aligned` environment."""
        write = TexPrinter().doprint
        lines = [f"{latex_of(sp.Symbol(name))} &= {write(value)}" for name, value in self._values]
        for name, x in self.equations.items():
            label = f"{_label(name)} &="
            if bare_name(name) in self.fields:
                label = rf"\text{{equation of }} {_label(name)}: &\quad"
            lines.append(f"{label} {write(x)} = 0")
        if not self.equations:
            lines.append(rf"&\text{{{HOLDS}}}")
        body = r" \\ ".join(lines)
        return rf"\begin{{aligned}} {body} \end{{aligned}}"


def bare_name(label: str) -> str:
    """The name of an equation without the marks of its indices: E of E_1^1."""
    return re.sub(r"([_^]\d+)+$", "", label)


def distinct_components(
    tensors: Mapping[str, Tensor], shown: Callable[..., sp.Expr]
) -> dict[str, sp.Expr]:
    """Components that differ and do not vanish, as they are printed, by labels such as E_1^1."""
    lines: dict[str, sp.Expr] = {}
    for name, tensor in tensors.items():
        for index, element in tensor.components.independent.items():
            expression = shown(tensor, index, element)
            if expression not in lines.values() and -expression not in lines.values():
                lines[name + marks(index, tensor.slots)] = expression
    return lines


def _label(name: str) -> str:
    """E_1^1 in LaTeX, each index in its own column and legs with hats."""
    bare = bare_name(name)
    written = latex_of(sp.Symbol(bare))
    runs = re.findall(r"([_^])(\d+)", name[len(bare) :])
    hats = [sign + "{" + "".join(rf"\hat{{{k}}}" for k in run) + "}" for sign, run in runs]
    return written + "{}".join(hats)

"""Evaluation: which coordinates of a frame are angles."""

import pytest
import sympy as sp

from geomtorsion.geometry import Frame
from geomtorsion.geometry.evaluation import repeats

r, theta = sp.symbols("r theta", positive=True)
f = sp.Function("f")
ENTRIES = (
    sp.Integer(3), sp.sin(theta), sp.sin(2 * theta + r), sp.sin(theta + sp.cos(theta)),
    sp.sin(theta / 2) ** 2, sp.cos(theta / 2), sp.sin(theta / 3) ** 3, sp.tan(theta),
    sp.sqrt(2 + sp.cos(theta)), sp.log(2 + sp.sin(theta)), sp.atan(sp.sin(theta)), theta,
    sp.exp(theta), sp.cosh(theta), sp.sqrt(theta), sp.sin(r * theta), f(theta), f(r),
)  # fmt: skip


@pytest.mark.parametrize("entry", ENTRIES, ids=str)
def test_a_frame_repeats_where_its_entries_do(entry: sp.Expr) -> None:
    """A frame repeats after 2 pi if its entries do; the parts of an entry decide it."""
    frame = Frame([r, theta], [[1, 0], [0, 2 + entry]])
    turned = entry.subs(theta, theta + 2 * sp.pi)
    assert repeats(frame, theta) == (sp.simplify(turned - entry) == 0)

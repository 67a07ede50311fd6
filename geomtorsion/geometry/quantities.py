"""Quantities: one table of all named tensors, as plain data for every layer above.

A new quantity is a property of a frame, a connection, its torsion or its curvature, and a row here.
`Frame.quantity`, plans, reports, commands, the page and known answers of spaces read this table.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

from geomtorsion.errors import UnknownNameError
from geomtorsion.support.checks import close_names, shown

FRAME, TORSION, CONNECTIONS, CURVATURE = "Frame and metric", "Torsion", "Connections", "Curvature"
CONNECTION = "The space's own connection"
SECTIONS = (FRAME, TORSION, CONNECTIONS, CURVATURE, CONNECTION)
_BAR_GAMMA, _BAR_R = "Γ\u0304", "R\u0304"
_RIEMANN = "R_{abc}^d = ∂_a Γ_{bc}^d - ∂_b Γ_{ac}^d - Γ_{ac}^e Γ_{be}^d + Γ_{bc}^e Γ_{ae}^d"
_SCHOUTEN = f"P_{{ab}} = ({_BAR_R}_{{ab}} - g_{{ab}} {_BAR_R}/(2(n - 1)))/(n - 2)"


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A row of the table: how a tensor is called, drawn and computed.

    Fields
    ------
    name, title
        Its name in requests, and its usual name.
    symbol
        Its letter, perhaps with a combining accent.
    equation
        Its definition in one line; indices as in the conventions.
    section
        The heading under which it is shown.
    of, attribute
        The object that has it (the frame, its Cartan or Levi-Civita connection, or the connection
        of a space), and the property of this object. Empty for field equations.
    in_frame
        Whether all indices are moved to the frame.
    needs
        Names of the quantities from which it is computed: the edges of a plan.
    needs_if_dense
        The same for a dense coframe, if shorter: from the anholonomy, in the frame.
    products
        n -> upper bound of the number of products in one component.
    reported
        Whether a report shows it.
    page
        Whether the page of typed tetrads shows it, or only offers it.
    """

    name: str
    title: str
    symbol: str
    equation: str
    section: str
    of: Literal["", "frame", "cartan", "levi_civita", "connection"] = ""
    attribute: str = ""
    in_frame: bool = False
    needs: tuple[str, ...] = ()
    needs_if_dense: tuple[str, ...] = ()
    products: Callable[[int], int] = lambda n: 0
    reported: bool = True
    page: Literal["", "shown", "offered"] = ""


TABLE: tuple[Entry, ...] = (
    Entry(
        name="coframe", title="Coframe", symbol="e", equation="dΦ^i = e^i_a dq^a",
        section=FRAME, of="frame", attribute="coframe",
    ),
    Entry(
        name="metric", title="Metric", symbol="g", equation="g_{ab} = e^i_a η_{ij} e^j_b",
        section=FRAME, of="frame", attribute="metric",
        needs=("coframe",), products=lambda n: n, page="shown",
    ),
    Entry(
        name="inverse_metric", title="Inverse metric", symbol="g",
        equation="g^{ab} g_{bc} = δ^a_c",
        section=FRAME, of="frame", attribute="inverse_metric",
        needs=("metric",), products=lambda n: n,
    ),
    Entry(
        name="legs", title="Legs", symbol="E", equation="e^i_a E_j^a = δ^i_j",
        section=FRAME, of="frame", attribute="legs",
        needs=("coframe",), products=lambda n: n,
    ),
    Entry(
        name="determinant", title="Determinant of the coframe", symbol="e",
        equation="e = det e^i_a",
        section=FRAME, of="frame", attribute="determinant",
        needs=("coframe",), products=lambda n: n,
    ),
    Entry(
        name="anholonomy", title="Object of anholonomy", symbol="C",
        equation="de^k = (1/2) C_{ij}^k e^i ∧ e^j",
        section=TORSION, of="frame", attribute="anholonomy",
        needs=("coframe", "legs"), products=lambda n: n * n, page="offered",
    ),
    Entry(
        name="torsion", title="Torsion", symbol="S",
        equation="S_{ab}^c = (Γ_{ab}^c - Γ_{ba}^c)/2",
        section=TORSION, of="cartan", attribute="torsion.S",
        needs=("torsion_T",), page="shown",
    ),
    Entry(
        name="torsion_T", title="Torsion without the half", symbol="T",
        equation="T_{ab}^c = 2 S_{ab}^c",
        section=TORSION, of="cartan", attribute="torsion.T",
        needs=("cartan_connection",), reported=False,
    ),
    Entry(
        name="torsion_vector", title="Torsion vector", symbol="v", equation="v_a = T_{ab}^b",
        section=TORSION, of="cartan", attribute="torsion.vector",
        needs=("torsion_T",), page="offered",
    ),
    Entry(
        name="torsion_axial", title="Axial torsion", symbol="A", equation="A_{abc} = T_{[abc]}",
        section=TORSION, of="cartan", attribute="torsion.axial",
        needs=("torsion_T", "metric"), products=lambda n: n, page="offered",
    ),
    Entry(
        name="torsion_tensor", title="Tensor part of the torsion", symbol="q",
        equation="q_{abc} = T_{abc} - A_{abc} - (v_a g_{bc} - v_b g_{ac})/(n - 1)",
        section=TORSION, of="cartan", attribute="torsion.tensor",
        needs=("torsion_T", "torsion_vector", "torsion_axial", "metric"),
        products=lambda n: n + 2,
    ),
    Entry(
        name="torsion_scalar", title="Torsion scalar", symbol="T",
        equation="T = T_{abc} T^{abc}/4 + T_{abc} T^{cba}/2 - v_a v^a",
        section=TORSION, of="cartan", attribute="torsion.scalar",
        needs=("anholonomy",), products=lambda n: 3 * n**3,
    ),
    Entry(
        name="superpotential", title="Superpotential of the torsion", symbol="P",
        equation="P^{ab}_c = (T^{ab}_c + T_c^{ba} - T_c^{ab})/2 - v^a δ^b_c + v^b δ^a_c",
        section=TORSION, of="cartan", attribute="torsion.superpotential",
        needs=("torsion_T", "torsion_vector", "metric", "inverse_metric"),
        products=lambda n: 4 * n, reported=False, page="offered",
    ),
    Entry(
        name="torsion_force", title="Torsion force", symbol="f",
        equation="f^c = 2 S_a^c_b q'^a q'^b",
        section=TORSION, of="cartan", attribute="torsion.force_coefficients",
        needs=("torsion", "metric", "inverse_metric"), products=lambda n: 2 * n,
        reported=False, page="offered",
    ),
    Entry(
        name="cartan_connection", title="Cartan connection", symbol="Γ",
        equation="Γ_{ab}^c = E_i^c ∂_a e^i_b",
        section=CONNECTIONS, of="cartan", attribute="coefficients",
        needs=("coframe", "legs"), products=lambda n: n, page="shown",
    ),
    Entry(
        name="christoffel", title="Levi-Civita connection", symbol=_BAR_GAMMA,
        equation=f"{_BAR_GAMMA}_{{ab}}^c = "
        "g^{ce} (∂_a g_{be} + ∂_b g_{ae} - ∂_e g_{ab})/2",
        section=CONNECTIONS, of="levi_civita", attribute="coefficients",
        needs=("metric", "inverse_metric"), products=lambda n: n, page="shown",
    ),
    Entry(
        name="contortion", title="Contortion", symbol="K",
        equation=f"K_{{ab}}^c = Γ_{{ab}}^c - {_BAR_GAMMA}_{{ab}}^c",
        section=CONNECTIONS, of="cartan", attribute="contortion",
        needs=("cartan_connection", "christoffel"),
        needs_if_dense=("anholonomy", "coframe", "legs"), page="shown",
    ),
    Entry(
        name="spin_connection", title="Spin connection of the metric", symbol="ω",
        equation="ω_{ai}^j = e^j_b D_a E_i^b",
        section=CONNECTIONS, of="levi_civita", attribute="spin_connection",
        needs=("coframe", "legs", "christoffel"), products=lambda n: 2 * n,
    ),
    Entry(
        name="cartan_curvature", title="Curvature of the Cartan connection", symbol="R",
        equation=_RIEMANN,
        section=CURVATURE, of="cartan", attribute="curvature.riemann",
        needs=("cartan_connection", "coframe"), products=lambda n: 2 * n, page="shown",
    ),
    Entry(
        name="riemann", title="Riemann tensor", symbol=_BAR_R,
        equation=_RIEMANN.replace("Γ", _BAR_GAMMA).replace("R", _BAR_R),
        section=CURVATURE, of="levi_civita", attribute="curvature.riemann",
        needs=("metric", "christoffel"), needs_if_dense=("riemann_frame", "coframe"),
        products=lambda n: 2 * n, page="shown",
    ),
    Entry(
        name="riemann_frame", title="Riemann tensor in the frame", symbol=_BAR_R,
        equation=f"{_BAR_R}_{{ijkl}} = E_i^a E_j^b E_k^c E_l^d {_BAR_R}_{{abcd}}",
        section=CURVATURE, of="levi_civita", attribute="curvature.lower", in_frame=True,
        needs=("riemann", "legs"), needs_if_dense=("anholonomy", "legs"),
        products=lambda n: n, reported=False,
    ),
    Entry(
        name="ricci", title="Ricci tensor", symbol=_BAR_R,
        equation=f"{_BAR_R}_{{bc}} = {_BAR_R}_{{abc}}^a",
        section=CURVATURE, of="levi_civita", attribute="curvature.ricci",
        needs=("riemann", "inverse_metric"), needs_if_dense=("riemann_frame", "coframe"),
        products=lambda n: n * n, page="shown",
    ),
    Entry(
        name="scalar_curvature", title="Scalar curvature", symbol=_BAR_R,
        equation=f"{_BAR_R} = g^{{ab}} {_BAR_R}_{{ab}}",
        section=CURVATURE, of="levi_civita", attribute="curvature.scalar",
        needs=("ricci", "inverse_metric"), needs_if_dense=("anholonomy", "legs"),
        products=lambda n: n * n, page="shown",
    ),
    Entry(
        name="einstein", title="Einstein tensor", symbol="G",
        equation=f"G_{{ab}} = {_BAR_R}_{{ab}} - g_{{ab}} {_BAR_R}/2",
        section=CURVATURE, of="levi_civita", attribute="curvature.einstein",
        needs=("ricci", "scalar_curvature", "metric"), products=lambda n: 1, page="offered",
    ),
    Entry(
        name="weyl", title="Weyl tensor", symbol="C",
        equation=f"C_{{abcd}} = {_BAR_R}_{{abcd}} - g_{{bc}} P_{{ad}} - g_{{ad}} P_{{bc}} + "
        f"g_{{ac}} P_{{bd}} + g_{{bd}} P_{{ac}}, {_SCHOUTEN}",
        section=CURVATURE, of="levi_civita", attribute="curvature.weyl",
        needs=("riemann", "ricci", "scalar_curvature", "metric"), products=lambda n: 6,
        page="offered",
    ),
    Entry(
        name="schouten", title="Schouten tensor", symbol="P",
        equation=_SCHOUTEN,
        section=CURVATURE, of="levi_civita", attribute="curvature.schouten",
        needs=("ricci", "scalar_curvature", "metric"), products=lambda n: 1, reported=False,
    ),
    Entry(
        name="cotton", title="Cotton tensor", symbol="C",
        equation="C_{abc} = D_a P_{bc} - D_b P_{ac}",
        section=CURVATURE, of="levi_civita", attribute="curvature.cotton",
        needs=("schouten", "christoffel"), products=lambda n: 4 * n, reported=False,
    ),
    Entry(
        name="kretschmann", title="Kretschmann scalar", symbol="K",
        equation=f"K = {_BAR_R}_{{abcd}} {_BAR_R}^{{abcd}}",
        section=CURVATURE, of="levi_civita", attribute="curvature.kretschmann",
        needs=("riemann", "inverse_metric"), needs_if_dense=("riemann_frame",),
        products=lambda n: n**4, page="offered",
    ),
    Entry(
        name="connection", title="Connection", symbol="Γ",
        equation="D_a v^c = ∂_a v^c + Γ_{ab}^c v^b",
        section=CONNECTION, of="connection", attribute="coefficients",
    ),
    Entry(
        name="connection_torsion", title="Torsion of the connection", symbol="S",
        equation="S_{ab}^c = (Γ_{ab}^c - Γ_{ba}^c)/2",
        section=CONNECTION, of="connection", attribute="torsion.S",
    ),
    Entry(
        name="connection_contortion", title="Contortion of the connection", symbol="K",
        equation="K_{ab}^c = S_{ab}^c - S_b^c_a + S^c_{ab}",
        section=CONNECTION, of="connection", attribute="contortion",
    ),
    Entry(
        name="connection_nonmetricity", title="Nonmetricity", symbol="Q",
        equation="Q_{abc} = D_a g_{bc}",
        section=CONNECTION, of="connection", attribute="nonmetricity",
    ),
    Entry(
        name="connection_curvature", title="Curvature of the connection", symbol="R",
        equation=_RIEMANN,
        section=CONNECTION, of="connection", attribute="curvature.riemann",
    ),
    Entry(
        name="connection_ricci", title="Ricci tensor of the connection", symbol="R",
        equation="R_{bc} = R_{abc}^a",
        section=CONNECTION, of="connection", attribute="curvature.ricci",
    ),
    Entry(
        name="connection_scalar", title="Curvature scalar of the connection", symbol="R",
        equation="R = g^{ab} R_{ab}",
        section=CONNECTION, of="connection", attribute="curvature.scalar",
    ),
)  # fmt: skip
QUANTITIES = {one.name: one for one in TABLE}
# The quantities that a frame determines, by name.
FRAME_QUANTITIES = {one.name: one for one in TABLE if one.of != "connection"}


def entry(name: str) -> Entry:
    """The row of a quantity.

    Raises
    ------
    UnknownNameError
        No quantity has this name; the message lists near ones.

    Examples
    --------
    >>> entry("ricci").title
    'Ricci tensor'
    >>> entry("rici")
    Traceback (most recent call last):
    geomtorsion.errors.UnknownNameError: expected the name of a quantity, got 'rici'. Did ...
    """
    text = name if isinstance(name, str) else ""
    if text in QUANTITIES:
        return QUANTITIES[text]
    near = close_names(text.lower().replace("-", "_"), QUANTITIES, 3, 0.5)
    hint = f"Did you mean {' or '.join(near)}?" if near else f"There are: {', '.join(QUANTITIES)}."
    raise UnknownNameError(f"expected the name of a quantity, got {shown(name)}. {hint}")


def entries(names: Iterable[str] = ()) -> tuple[Entry, ...]:
    """Rows of these quantities in the given order; of all in a report if none is given.

    Examples
    --------
    >>> [chosen.name for chosen in entries(["ricci", "torsion"])]
    ['ricci', 'torsion']
    >>> len(entries()) > 15
    True
    """
    return tuple(map(entry, names)) or tuple(one for one in TABLE if one.reported)

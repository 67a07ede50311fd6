"""quantities: quantities of a space to show, each with its tensor and its label."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import UnknownNameError
from geomtorsion.geometry.notation import open_mark
from geomtorsion.pictures.latex import letters, text_label
from geomtorsion.pictures.text import plain_text
from geomtorsion.spaces import CONNECTION_QUANTITIES
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import close_names

if TYPE_CHECKING:
    import sympy

    from geomtorsion.exact import Element
    from geomtorsion.geometry import Tensor
    from geomtorsion.spaces import Space


@dataclass(frozen=True)
class Entry:
    """How a quantity is presented.

    name: its name in `Frame.quantity`. title: its usual name. symbol, latex: its letter.
    equation: its definition in one line; indices as in the conventions.
    section: heading of the report above it; empty: omitted there.
    """

    name: str
    title: str
    symbol: str
    latex: str
    equation: str
    section: str


FRAME, TORSION, CONNECTIONS, CURVATURE = "Frame and metric", "Torsion", "Connections", "Curvature"
CONNECTION = "The space's own connection"
_BAR_GAMMA, _BAR_R = "Γ\u0304", "R\u0304"

CATALOGUE: tuple[Entry, ...] = (
    Entry("coframe", "Coframe", "e", "e", "dΦ^i = e^i_a dq^a", FRAME),
    Entry("legs", "Legs", "E", "E", "e^i_a E_j^a = δ^i_j", FRAME),
    Entry("metric", "Metric", "g", "g", "g_{ab} = e^i_a η_{ij} e^j_b", FRAME),
    Entry("inverse_metric", "Inverse metric", "g", "g", "g^{ab} g_{bc} = δ^a_c", FRAME),
    Entry("determinant", "Determinant of the coframe", "e", "e", "e = det e^i_a", FRAME),
    Entry(
        "anholonomy", "Object of anholonomy", "C", "C", "de^k = (1/2) C_{ij}^k e^i ∧ e^j", TORSION
    ),
    Entry("torsion", "Torsion", "S", "S", "S_{ab}^c = (Γ_{ab}^c - Γ_{ba}^c)/2", TORSION),
    Entry("torsion_T", "Torsion without the half", "T", "T", "T_{ab}^c = 2 S_{ab}^c", ""),
    Entry("torsion_vector", "Torsion vector", "v", "v", "v_a = T_{ab}^b", TORSION),
    Entry("torsion_axial", "Axial torsion", "A", "A", "A_{abc} = T_{[abc]}", TORSION),
    Entry(
        "torsion_tensor",
        "Tensor part of the torsion",
        "q",
        "q",
        "q_{abc} = T_{abc} - A_{abc} - (v_a g_{bc} - v_b g_{ac})/(n - 1)",
        TORSION,
    ),
    Entry(
        "torsion_scalar",
        "Torsion scalar",
        "T",
        "T",
        "T = T_{abc} T^{abc}/4 + T_{abc} T^{cba}/2 - v_a v^a",
        TORSION,
    ),
    Entry("torsion_force", "Torsion force", "f", "f", "f^c = 2 S_a^c_b q'^a q'^b", ""),
    Entry(
        "cartan_connection", "Cartan connection", "Γ", r"\Gamma", "Γ_{ab}^c = E_i^c ∂_a e^i_b",
        CONNECTIONS,
    ),
    Entry(
        "christoffel",
        "Levi-Civita connection",
        _BAR_GAMMA,
        r"\bar\Gamma",
        f"{_BAR_GAMMA}_{{ab}}^c = g^{{ce}} (∂_a g_{{be}} + ∂_b g_{{ae}} - ∂_e g_{{ab}})/2",
        CONNECTIONS,
    ),
    Entry(
        "contortion", "Contortion", "K", "K", f"K_{{ab}}^c = Γ_{{ab}}^c - {_BAR_GAMMA}_{{ab}}^c",
        CONNECTIONS,
    ),
    Entry(
        "spin_connection",
        "Spin connection of the metric",
        "ω",
        r"\omega",
        "ω_{ai}^j = e^j_b D_a E_i^b",
        CONNECTIONS,
    ),
    Entry(
        "cartan_curvature", "Curvature of the Cartan connection", "R", "R",
        "R_{abc}^d = ∂_a Γ_{bc}^d - ∂_b Γ_{ac}^d - Γ_{ac}^e Γ_{be}^d + Γ_{bc}^e Γ_{ae}^d",
        CURVATURE,
    ),
    Entry(
        "riemann", "Riemann tensor", _BAR_R, r"\bar R",
        f"as for the Cartan connection, with {_BAR_GAMMA}", CURVATURE,
    ),
    Entry(
        "ricci", "Ricci tensor", _BAR_R, r"\bar R", f"{_BAR_R}_{{bc}} = {_BAR_R}_{{abc}}^a",
        CURVATURE,
    ),
    Entry(
        "scalar_curvature", "Scalar curvature", _BAR_R, r"\bar R",
        f"{_BAR_R} = g^{{ab}} {_BAR_R}_{{ab}}", CURVATURE,
    ),
    Entry(
        "einstein", "Einstein tensor", "G", "G",
        f"G_{{ab}} = {_BAR_R}_{{ab}} - g_{{ab}} {_BAR_R}/2", CURVATURE,
    ),
    Entry("weyl", "Weyl tensor", "C", "C", "the part of the curvature without traces", CURVATURE),
    Entry(
        "schouten", "Schouten tensor", "P", "P",
        f"P_{{ab}} = ({_BAR_R}_{{ab}} - g_{{ab}} {_BAR_R}/(2(n - 1)))/(n - 2)", "",
    ),
    Entry("cotton", "Cotton tensor", "C", "C", "C_{abc} = D_a P_{bc} - D_b P_{ac}", ""),
    Entry(
        "kretschmann", "Kretschmann scalar", "K", "K",
        f"K = {_BAR_R}_{{abcd}} {_BAR_R}^{{abcd}}", CURVATURE,
    ),
    Entry(
        "connection", "Connection", "Γ", r"\Gamma", "D_a v^c = ∂_a v^c + Γ_{ab}^c v^b", CONNECTION
    ),
    Entry(
        "connection_torsion", "Torsion of the connection", "S", "S",
        "S_{ab}^c = (Γ_{ab}^c - Γ_{ba}^c)/2", CONNECTION,
    ),
    Entry(
        "connection_contortion", "Contortion of the connection", "K", "K",
        "K_{ab}^c = S_{ab}^c - S_b^c_a + S^c_{ab}", CONNECTION,
    ),
    Entry(
        "connection_nonmetricity", "Nonmetricity", "Q", "Q", "Q_{abc} = D_a g_{bc}", CONNECTION,
    ),
    Entry(
        "connection_curvature", "Curvature of the connection", "R", "R",
        "R_{abc}^d = ∂_a Γ_{bc}^d - ∂_b Γ_{ac}^d - Γ_{ac}^e Γ_{be}^d + Γ_{bc}^e Γ_{ae}^d",
        CONNECTION,
    ),
    Entry(
        "connection_ricci", "Ricci tensor of the connection", "R", "R", "R_{bc} = R_{abc}^a",
        CONNECTION,
    ),
    Entry(
        "connection_scalar", "Curvature scalar of the connection", "R", "R",
        "R = g^{ab} R_{ab}", CONNECTION,
    ),
)  # fmt: skip
SECTIONS = (FRAME, TORSION, CONNECTIONS, CURVATURE, CONNECTION)


def entry(name: str) -> Entry:
    """The entry of a quantity.

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
    for item in CATALOGUE:
        if item.name == name:
            return item
    names = [item.name for item in CATALOGUE]
    near = close_names(name.lower().replace("-", "_"), names, 3, 0.5)
    hint = f"Did you mean {' or '.join(near)}? " if near else ""
    raise UnknownNameError(
        f"expected the name of a quantity, got {name!r}. {hint}There are: {', '.join(names)}."
    )


def entries(names: Iterable[str] = ()) -> tuple[Entry, ...]:
    """Entries of these quantities in the given order; of all in a report if none is given.

    Examples
    --------
    >>> [chosen.name for chosen in entries(["ricci", "torsion"])]
    ['ricci', 'torsion']
    >>> len(entries()) > 15
    True
    """
    chosen = tuple(entry(name) for name in names)
    return chosen or tuple(item for item in CATALOGUE if item.section)


# Data written as JSON.
Data = dict[str, Any]
BASES = ("natural", "coordinate", "frame")


@dataclass(frozen=True)
class Quantity:
    """A quantity of a space, computed when its components are read.

    entry: how it is presented. tensor: its components, in the requested basis. printed: a
    component as it is printed; without it, by the names of the frame.
    """

    entry: Entry
    tensor: Tensor
    printed: Callable[[Element], sympy.Expr] | None = None

    @property
    def letters(self) -> list[str]:
        """A letter for each index."""
        return letters(self.tensor.slots)

    @property
    def text_label(self) -> str:
        """Symbol with index letters."""
        return text_label(self.entry.symbol, self.letters, self.tensor.slots)

    def written(self, element: Element) -> sympy.Expr:
        """A component as it is printed."""
        if self.printed is not None:
            return self.printed(element)
        frame = self.tensor.frame
        return frame.written(element) if frame.names else element.sympy

    @cached_property
    def independent(self) -> dict[tuple[int, ...], Element]:
        """Components not known to vanish, one of each set that symmetry ties together."""
        return dict(sorted(self.tensor.components.independent.items()))

    @cached_property
    def nonzero(self) -> dict[tuple[int, ...], Element]:
        """All components that are not known to vanish."""
        return dict(sorted(self.tensor.components.nonzero.items()))

    @cached_property
    def undecided(self) -> tuple[tuple[int, ...], ...]:
        """The indices of undecided components."""
        return tuple(index for index in self.nonzero if open_mark(self.tensor, index))


def chosen_quantities(
    space: Space,
    names: Iterable[str] = (),
    basis: str = "natural",
    progress: Callable[[str], object] = lambda _: None,
) -> list[Quantity]:
    """The quantities of these names, or all that a report shows; progress hears each title.

    Raises
    ------
    UnknownNameError
        No quantity or basis has this name, or it belongs to a connection that the space lacks.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> [ricci] = chosen_quantities(load("s2"), ["ricci"])
    >>> ricci.text_label, len(ricci.independent)
    ('R̄_{ab}', 2)
    """
    if basis not in BASES:
        raise UnknownNameError(f"basis: expected one of {', '.join(BASES)}, got {basis!r}.")
    names = tuple(names)
    quantities = []
    for entry in entries(names):
        own = entry.section == CONNECTION
        if own and space.connection is None:
            if names:
                raise UnknownNameError(
                    f"{entry.name}: expected a space with its own connection, got {space.name}, "
                    "which only has the connections of its frame. Use cartan_connection or "
                    "christoffel."
                )
            continue
        progress(entry.title)
        if own and space.connection is not None:
            tensor = CONNECTION_QUANTITIES[entry.name](space.connection)
        else:
            tensor = space.frame.quantity(entry.name)
        quantity = Quantity(entry, _in_basis(tensor, basis))
        # Computed now, so that progress hears of each quantity before the time that it takes.
        _ = quantity.independent
        quantities.append(quantity)
    return quantities


def _in_basis(tensor: Tensor, basis: str) -> Tensor:
    """The tensor with its indices in a basis; anything else stays as it is."""
    if basis == "natural" or tensor.anchored:
        return tensor
    return tensor.in_frame() if basis == "frame" else tensor.in_coordinates()


def geometry_data(space: Space, quantities: Sequence[Quantity]) -> Data:
    """A space and its quantities as nested dictionaries of text.

    Expressions are written so that ``parse_expression`` reads them back. Indices are counted from
    0; in slots d and u are coordinate indices down and up, D and U frame indices.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> space = load("s2")
    >>> data = geometry_data(space, chosen_quantities(space, ["ricci"]))
    >>> data["quantities"]["ricci"]["components"]
    {'0,0': '1', '1,1': 'sin(theta)^2'}
    """
    frame = space.frame
    return {
        "name": space.name,
        "title": space.title,
        "story": space.story,
        "source": space.source,
        "notes": space.notes,
        "coordinates": [symbol.name for symbol in frame.coordinates],
        "parameters": [symbol.name for symbol in frame.parameters],
        "domain": [str(relation) for relation in frame.domain],
        "frame_metric": [
            [plain_text(frame.eta[i, j]) for j in range(frame.dimension)]
            for i in range(frame.dimension)
        ],
        "branches": [str(branch) for branch in frame.field.branches],
        "conventions": "Gamma_ab^c differentiates along its first index; S = T/2; slots d, u: "
        "coordinate index down, up; D, U: frame index; indices counted from 0",
        "quantities": {one.entry.name: _quantity(one) for one in quantities},
    }


def _quantity(quantity: Quantity) -> Data:
    return {
        "title": quantity.entry.title,
        "equation": quantity.entry.equation,
        "slots": quantity.tensor.slots,
        "components": {
            ",".join(map(str, index)): plain_text(element.sympy)
            for index, element in quantity.nonzero.items()
        },
        **({"undecided": _keys(quantity.undecided)} if quantity.undecided else {}),
    }


def _keys(indices: Iterable[tuple[int, ...]]) -> list[str]:
    return [",".join(map(str, index)) for index in indices]

"""Frame: each way to make one, and the errors if that fails."""

import pytest
import sympy as sp

from geomtorsion.errors import CoordinateError
from geomtorsion.geometry import Frame, levi_civita

r, phi = sp.symbols("r phi", positive=True)
x, y, z = sp.symbols("x y z", real=True)


def test_legs_are_the_inverse_of_the_coframe() -> None:
    """The legs are the inverse of the coframe, by cofactors and through the metric."""
    dense = sp.Matrix([[1, x, 0], [y, 2, z], [0, z, 5]])
    for coframe in (dense, 2 / (1 + x**2) * sp.Matrix([[0, 1, 0], [0, 0, 1], [1, 0, 0]])):
        frame = Frame([x, y, z], coframe)
        product = frame.coframe @ frame.legs
        assert product.nonzero() == {(0, 0): 1, (1, 1): 1, (2, 2): 1}


def test_orthogonal_coframe_goes_through_its_metric() -> None:
    """The legs of a full coframe with a diagonal metric need no cofactors."""
    c, s = sp.cos(x), sp.sin(x)
    frame = Frame([x, y, z], [[c, s, 0], [-s, c, 0], [0, 0, 1]])
    assert [step.name for step in frame.plan("legs").steps][-2:] == ["inverse_metric", "legs"]
    assert frame.legs[0, 1] == -s
    assert (frame.coframe @ frame.legs).nonzero() == {(0, 0): 1, (1, 1): 1, (2, 2): 1}


def test_from_frame_keeps_the_legs() -> None:
    """Legs are columns, and the coframe is their inverse."""
    frame = Frame.from_frame([r, phi], [[1, 2], [0, 1 / r]])
    assert frame.legs[0, 1] == 2
    assert frame.coframe[0, 1] == -2 * r
    assert [step.name for step in frame.plan("legs").steps] == ["legs"]


def test_coordinates_by_name() -> None:
    """Names become the symbols that occur in the entries, with their assumptions."""
    frame = Frame("r phi", [[1, 0], [0, r]])
    assert frame.coordinates == (r, sp.Symbol("phi"))
    assert frame.anholonomy[0, 1, 1] == 1 / r


def test_a_name_means_one_symbol() -> None:
    """A symbol with the name of a coordinate is that coordinate, so that derivatives count."""
    plain = sp.Symbol("r")
    frame = Frame([plain, phi], [[1, 0], [0, r]])
    assert frame.anholonomy[0, 1, 1] == 1 / plain
    with pytest.raises(
        CoordinateError, match=r"two different symbols are called r: .*positive=True"
    ):
        Frame("r phi", [[1, 0], [0, r * plain]])


def test_parameters() -> None:
    """Free symbols are parameters, in the order given, then by name."""
    b, c = sp.symbols("b c")
    frame = Frame([x, y], [[c, 0], [0, b]], parameters=[c])
    assert frame.parameters == (c, b)
    assert levi_civita(frame).is_flat


def test_a_constant_eta_with_entries_off_the_diagonal() -> None:
    """Null coordinates of the plane: eta is off-diagonal, and the metric is flat."""
    frame = Frame([x, y], [[sp.exp(x), 0], [0, sp.exp(-x)]], signature=[[0, -1], [-1, 0]])
    assert frame.metric.nonzero() == {(0, 1): -1, (1, 0): -1}
    assert frame.inverse_eta.nonzero() == {(0, 1): -1, (1, 0): -1}
    assert levi_civita(frame).is_flat
    assert frame.volume[()] == 1


def test_irrational_eta() -> None:
    """Entries of eta may be any constants."""
    frame = Frame([x], [[x]], signature=[[sp.sqrt(2)]])
    assert frame.metric[0, 0] == sp.sqrt(2) * x**2
    assert frame.inverse_metric[0, 0] == sp.sqrt(2) / (2 * x**2)


def test_volume_and_determinant() -> None:
    """The volume has a sign: it is det e times the root of |det eta|."""
    frame = Frame([r, phi], [[0, r], [1, 0]])
    assert frame.determinant[()] == -r
    assert frame.volume[()] == -r
    scaled = Frame([r, phi], [[1, 0], [0, r]], signature=[[1, 0], [0, 4]])
    assert scaled.volume[()] == 2 * r


def test_sample_point_is_in_the_domain() -> None:
    """The sample point satisfies assumptions and domain, and the frame is regular there."""
    mass = sp.Symbol("M", positive=True)
    h = sp.sqrt(1 - 2 * mass / r)
    frame = Frame([r, phi], [[1 / h, 0], [0, r]], domain=[r > 2 * mass, phi < 2 * sp.pi])
    point = frame.sample_point
    assert point[r] > 2 * point[mass] > 0
    assert 0 < point[phi] < 6.3
    assert frame.domain == (r > 2 * mass, phi < 2 * sp.pi)
    with pytest.raises(CoordinateError, match="expected a relation"):
        Frame([x, y], [[1, 0], [0, 1]], domain=[x])
    with pytest.raises(CoordinateError, match="expected a point inside the domain"):
        Frame([x, y], [[1, 0], [0, 1]], domain=[x + y > 1, x + y < 0])


def test_new_symbols_become_parameters() -> None:
    """An expression read later may add a parameter; a symbol of a known name is the known one."""
    frame = Frame([r, phi], [[1, 0], [0, r]])
    c = sp.Symbol("c")
    (element,) = frame.read([("entry", c * r)])
    assert element.diff(r).sympy == c
    (twin,) = frame.read([("entry", c * sp.Symbol("r"))])
    assert twin == element
    with pytest.raises(CoordinateError, match="two different symbols"):
        frame.read([("entry", sp.Symbol("s") + sp.Symbol("s", real=True))])


def test_entries_may_be_nested_deeply():
    """Symbols within 300 brackets are found, although sympy's own search is recursive."""
    x, y = sp.symbols("x y", real=True)
    nested = x
    for _ in range(300):
        nested = 1 / (2 + y * nested)
    frame = Frame([x, y], [[nested, 0], [0, 1]])
    assert frame.parameters == ()
    assert frame.coframe.at({x: 0, y: 1})[0, 0] == pytest.approx(2**0.5 - 1)

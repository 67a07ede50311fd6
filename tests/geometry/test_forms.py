"""Forms: construction, text and refusals, with answers from textbooks."""

# Bad input.
# pyright: reportArgumentType=false, reportCallIssue=false

import copy
import pickle

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError

x, y, z, t = sp.symbols("x y z t", real=True)
r, theta, phi = sp.symbols("r theta phi", positive=True)
SPACE = gt.Frame([x, y, z], sp.eye(3))
BALL = gt.Frame([r, theta, phi], sp.diag(1, r, r * sp.sin(theta)), domain=[r > 0, theta > 0])
MINKOWSKI = gt.Frame([t, x, y, z], sp.eye(4), signature=(-1, 1, 1, 1))


def test_d_and_star_are_gradient_curl_and_divergence():
    """In flat space *d is the curl of a one-form and *d* its divergence."""
    field = gt.Form(SPACE, 1, {0: -y, 1: x, 2: x * z})
    assert field.d.star.nonzero() == {(1,): -z, (2,): 2}
    assert field.star.d.star[()] == x
    scalar = gt.Form(BALL, 0, {(): r**2})
    assert scalar.d.star.d.star[()] == 6
    assert gt.levi_civita(BALL).laplacian(BALL.scalar(r**2))[()] == 6


def test_maxwell_plane_wave():
    """F = dA and d*F = 0 for a wave that runs along z."""
    potential = gt.Form(MINKOWSKI, 1, {1: sp.cos(z - t)})
    field = potential.d
    assert field.d.is_zero
    assert field.star.d.is_zero
    assert not (field * t).d.is_zero
    assert (field ^ field.star).is_zero


def test_dual_of_two_forms_in_minkowski_space():
    """*(dt ^ dx) = - dy ^ dz with epsilon_txyz = +1 and the signature (-+++)."""
    assert repr(gt.Form(MINKOWSKI, 2, {(0, 1): 1}).star) == "-dy ^ dz"
    assert repr(gt.Form(MINKOWSKI, 2, {(2, 3): 1}).star) == "dt ^ dx"


def test_forms_are_written_and_copied():
    """A form reads as in a book, in text and in LaTeX; a copy is equal."""
    form = gt.Form(SPACE, 2, {(1, 0): y - x, (0, 2): sp.sin(x), (1, 2): -1})
    assert repr(form) == "(x - y) dx ^ dy + sin(x) dx ^ dz - dy ^ dz"
    assert repr(form * 0) == "0"
    assert form._repr_latex_().startswith(r"$(x - y) \, \mathrm{d}x \wedge \mathrm{d}y")
    again = pickle.loads(pickle.dumps(form))
    assert again.nonzero() == form.nonzero()
    assert copy.deepcopy(form) is form
    assert hash(form) == hash(form + form * 0)
    assert "T^{i}_{ab} (a, b: coordinates r, theta, phi; i: legs)" in repr(
        gt.cartan(BALL).torsion_form()
    )


def test_form_indices_in_any_order():
    """Exchanged form indices change the sign of a component."""
    form = gt.Form(SPACE, 2, {(2, 0): x})
    assert form[0, 2] == -x
    assert form[2, 0] == x
    assert form[1, 1] == 0
    assert form.tensor[2, 0] == x


def test_forms_above_the_dimension_vanish():
    """A wedge product of degree four in three dimensions is zero."""
    two = gt.Form(SPACE, 2, {(0, 1): x})
    assert (two ^ two).is_zero
    assert two.d.d.is_zero
    assert gt.Form(SPACE, 0, {(): x}).interior([1, 0, 0]).is_zero


def test_divergence_and_laplacian_in_either_basis():
    """The index may be of either kind; div F of rank two is Maxwell's equation D_a F^ab = 0."""
    bar = gt.levi_civita(BALL)
    vector = BALL.vector([1 / r**2, 0, 0])
    assert bar.divergence(vector).is_zero
    assert bar.divergence(vector.in_frame()).is_zero
    assert bar.divergence(vector.lowered(0)).is_zero
    stress = BALL.metric * r
    assert bar.divergence(stress, 1).nonzero() == {(0,): 1}
    flat = gt.levi_civita(MINKOWSKI)
    assert flat.dalembertian(MINKOWSKI.vector([sp.sin(t - z), 0, x**2, 0])).nonzero() == {(2,): 2}


def test_schouten_and_cotton():
    """The Cotton tensor of a conformally flat metric vanishes; in dimension four it is div Weyl."""
    flat = gt.Frame([x, y, z], sp.eye(3) * (1 + x**2 + y * z))
    assert gt.levi_civita(flat).curvature.cotton.is_zero
    squashed = gt.spaces.load("heisenberg").frame
    assert gt.levi_civita(squashed).curvature.cotton.is_zero is False
    assert squashed.quantity("cotton") == gt.levi_civita(squashed).curvature.cotton
    bar = gt.levi_civita(gt.Frame.from_metric([t, x, y, z], sp.diag(-1 - x**2, 1, 1, 1 + x * y)))
    weyl, cotton = bar.curvature.weyl.raised(3), bar.curvature.cotton
    assert cotton.is_zero is False
    assert bar.divergence(weyl, 3) == cotton
    schouten = bar.curvature.schouten
    assert gt.contract("ab,ab->", bar.frame.inverse_metric, schouten) == bar.curvature.scalar / 6


REFUSALS = [
    (lambda: gt.Form(SPACE, 2, {(0, 0): 1}).nonzero(), "index twice"),
    (lambda: gt.Form(SPACE, 2, {(0, 1): 1, (1, 0): 1}).nonzero(), "index twice"),
    (lambda: gt.Form(SPACE, 2, {(0, 3): 1}).nonzero(), "whole numbers from 0 to 2"),
    (lambda: gt.Form(SPACE, 1, {0: 1})[0, 1], "expected 1 whole numbers"),
    (lambda: gt.Form(SPACE, -1, {}), "degree"),
    (lambda: gt.Form(SPACE, 1, {}, "X"), "slots"),
    (lambda: gt.Form.of(SPACE.metric), "antisymmetric"),
    (lambda: gt.Form.of(SPACE.epsilon.raised(2)), "lower"),
    (lambda: gt.Form(SPACE, 1, {0: 1}) + gt.Form(SPACE, 2, {}), "like forms"),
    (lambda: gt.Form(SPACE, 1, {0: 1}) ^ gt.Form(BALL, 1, {0: 1}), "over one"),
    (lambda: gt.Form(SPACE, 1, {0: 1}) ^ x, "other form"),
    (lambda: gt.Form(SPACE, 1, {0: 1}).D(gt.cartan(BALL)), "over one frame"),
    (lambda: gt.Form(SPACE, 1, {0: 1}).interior([1, 2]), "3 entries"),
    (lambda: gt.Form(SPACE, 2, {(0, 1): x}).wedge(gt.Form(SPACE, 2, {(0, 1): 1})).star, "degree 4"),
    (lambda: gt.cartan(SPACE).torsion_form(0, 1), "values: expected 1 whole numbers from 0 to 2"),
    (lambda: gt.cartan(SPACE).torsion_form(3), "from 0 to 2"),
    (lambda: gt.lie([1, 0, 0], gt.cartan(SPACE).coefficients), "connection"),
    (lambda: gt.lie([1, 0, 0], 3), "expected a tensor"),
    (lambda: gt.lie(BALL.vector([1, 0, 0]), SPACE), "xi: expected a tensor over this frame"),
    (lambda: gt.lie(SPACE.metric, SPACE), "one index"),
    (lambda: gt.lie_bracket(SPACE, [1, 0, 0]), "second: expected a second vector field"),
    (lambda: gt.lie_bracket([1, 0, 0], [0, 1, 0]), "Give the frame first"),
    (lambda: gt.lie_bracket(SPACE.vector([1, 0, 0]), [0, 1]), "second: expected 3 entries"),
    (lambda: gt.lie_bracket(SPACE.vector([1, 0, 0]), BALL.vector([1, 0, 0])), "over another frame"),
    (
        lambda: gt.levi_civita(gt.spaces.load("s2").frame).curvature.schouten[0, 0],
        "three dimensions",
    ),
]


def test_a_field_moves_straight_lines():
    """L_xi Gamma_ab^c = d_a d_b xi^c in Cartesian coordinates: here for xi = x^2 y d_x."""
    x, y = sp.symbols("x y", positive=True)
    flat = gt.levi_civita(gt.Frame([x, y], [[1, 0], [0, 1]]))
    moved = gt.lie([x**2 * y, 0], flat).nonzero()
    assert moved == {(0, 0, 0): 2 * y, (0, 1, 0): 2 * x, (1, 0, 0): 2 * x}


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_anything_but_a_form_is_refused(call, words):
    """Each bad form or argument is refused with its own message."""
    with pytest.raises(GeomtorsionError, match=words):
        call()

"""Bad input: each refusal is our own error and names the value and the remedy."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import spaces
from geomtorsion.errors import (
    CoordinateError,
    ExpressionError,
    GeomtorsionError,
    KineticMatrixError,
    LagrangianError,
    ShapeError,
    UnknownNameError,
)

SO3 = spaces.load("so3").frame
U1, U2, U3, U4, U7 = sp.symbols("u1 u2 u3 u4 u7")
SPIN = (U1**2 + 2 * U2**2 + 3 * U3**2) / 2


@pytest.mark.parametrize(
    ("lagrangian", "words"),
    [
        (SPIN + U7, r"lagrangian: expected a coordinate.*, got u7. Velocities are u1 \.\.\. u3"),
        (SPIN + sp.Symbol("phi1dot"), "got phi1dot.*Did you mean phi1"),
        (SPIN + sp.Symbol("u2dot"), "a parameter, got u2dot"),
        ([SPIN], "expected an expression, got \\[u1"),
        (sp.Eq(U1, U2), "expected an expression"),
    ],
)
def test_unknown_symbols(lagrangian, words):
    """Symbols that cannot be parameters are refused, with the nearest known name."""
    with pytest.raises(LagrangianError, match=words):
        gt.equations_of_motion(SO3, lagrangian)


def test_listed_parameters_bind():
    """If parameters are listed, any other symbol is refused."""
    gravity = SPIN - sp.Symbol("mgl") * sp.cos(SO3.coordinates[1])
    assert gt.equations_of_motion(SO3, gravity, parameters=["mgl"]).agrees is True
    with pytest.raises(LagrangianError, match=r"got mgl.*Did you mean mgL\?.*List mgl"):
        gt.equations_of_motion(SO3, gravity, parameters=["mgL"])
    with pytest.raises(LagrangianError, match=r"forces\[1\]: expected .*, got k"):
        gt.equations_of_motion(SO3, SPIN, [0, -sp.Symbol("k") * U1, 0], parameters=[])


def test_functions_of_time_are_refused_as_coordinates():
    """phi1(t), as in sympy.physics.mechanics, would silently count as a given drive."""
    t = sp.Symbol("t")
    with pytest.raises(
        LagrangianError, match=r"expected the symbol phi2, got the function phi2\(t\)"
    ):
        gt.equations_of_motion(SO3, SPIN - sp.cos(sp.Function("phi2")(t)))
    with pytest.raises(LagrangianError, match=r"expected the symbol u1, got the function u1\(t\)"):
        gt.equations_of_motion(SO3, SPIN + sp.Function("u1")(t) ** 2)
    driven = gt.equations_of_motion(SO3, SPIN - sp.Function("f")(t) * sp.cos(SO3.coordinates[1]))
    assert driven.agrees is True


def test_parameters_may_be_one_text():
    """Parameters may be one text, like coordinates; names of changes are refused."""
    found = gt.equations_of_motion(SO3, "I1*(u1**2 + u2**2) + I3*u3**2", parameters="I1, I3")
    assert {symbol.name for symbol in found.lagrangian.free_symbols} > {"I1", "I3"}
    with pytest.raises(LagrangianError, match="parameters: expected .*, got phi1dot"):
        gt.equations_of_motion(SO3, SPIN, parameters=["phi1dot"])


def test_names_that_the_frame_has_taken():
    """With a coordinate xdot and a parameter b1, changes and gaps get other names."""
    x, xdot, b1, d1 = sp.symbols("x xdot b1 dPhi1")
    frame = gt.Frame([x, xdot], [[1, b1 * xdot], [d1, 1 + x]])
    found = gt.equations_of_motion(frame, (U1**2 + U2**2) / 2 - x * xdot)
    assert found.agrees is True
    assert {s.name for s in found.residuals[0].free_symbols} >= {"u1_dot"}
    for principle in ("closed_in_coordinates", "closed_in_image"):
        varied = gt.variation(frame, principle)
        assert varied.proved is True
        assert {s.name for s in varied.images + varied.gaps} == {"delta1", "delta2", "gap1", "gap2"}


def test_texts_are_read_by_the_whitelist():
    """Names must be declared and numbers exact; code is not an expression."""
    with pytest.raises(ExpressionError, match="I1 is neither a coordinate nor a declared"):
        gt.equations_of_motion(SO3, "I1*u1**2/2")
    with pytest.raises(ExpressionError, match=r"0\.5 is a decimal number"):
        gt.equations_of_motion(SO3, "0.5*u1**2")
    with pytest.raises(ExpressionError, match=r"constraints\[0\]"):
        gt.equations_of_motion(SO3, SPIN, constraints=["__import__('os')"])


def test_floats_are_refused_with_the_place():
    """A float has no exact value, and the error names the entry."""
    with pytest.raises(ExpressionError, match=r"forces\[2\]"):
        gt.equations_of_motion(SO3, SPIN, [0, 0, 0.1 * U1])


@pytest.mark.parametrize(
    ("lagrangian", "words"),
    [
        (U1**2 + U2**2, "u3 does not occur quadratically"),
        ((U1 + U2) ** 2 + U3**2, "contains no velocity"),
        (U1 + U2 + U3, "u1 does not occur quadratically"),
        (sp.Integer(0), "u1 does not occur"),
    ],
)
def test_singular_kinetic_matrix(lagrangian, words):
    """Accelerations that are not determined are refused, and the velocity is named."""
    with pytest.raises(KineticMatrixError, match=words):
        gt.equations_of_motion(SO3, lagrangian)


def test_constrained_velocity_may_have_no_energy():
    """A velocity that a constraint fixes needs no kinetic energy."""
    found = gt.equations_of_motion(SO3, U1**2 + U2**2, constraints=[U3])
    assert found.accelerations == (0, 0)


@pytest.mark.parametrize(
    ("forces", "words"),
    [
        ([1, 2], "expected one for each of 3 forms .*, got 2"),
        ({3: 1}, "expected components from 0 to 2, .* got 3"),
        ({"u1": 1}, "expected components .* got 'u1'"),
        ("u1", "expected a list"),
        (7, "expected a list"),
    ],
)
def test_wrong_number_of_forces(forces, words):
    """A list of forces has one entry per leg; keys of a mapping count from zero."""
    with pytest.raises(ShapeError, match=words):
        gt.equations_of_motion(SO3, SPIN, forces)


def test_constraints_must_be_a_list():
    """A single text is refused as a list of constraints."""
    with pytest.raises(ShapeError, match="Put it in brackets"):
        gt.equations_of_motion(SO3, SPIN, constraints="u1")


@pytest.mark.parametrize(
    ("principle", "near"),
    [
        ("closed-in-coordinates", "closed_in_coordinates"),
        ("Naive", "naive"),
        (3, "There are closed_in"),
    ],
)
def test_unknown_principle(principle, near):
    """The error for an unknown principle names the nearest, or all of them."""
    with pytest.raises(UnknownNameError, match=near):
        gt.equations_of_motion(SO3, SPIN, principle=principle)


def test_connection_of_another_frame():
    """The connection of another frame is refused."""
    with pytest.raises(ShapeError, match="another frame"):
        gt.equations_of_motion(
            SO3, SPIN, principle="closed_in_image",
            connection=gt.cartan(spaces.load("s2").frame),
        )  # fmt: skip


def test_complex_frames_do_not_move():
    """A null tetrad is refused for motion, but its variations are algebra and work."""
    frame = spaces.load("kerr_kinnersley").frame
    with pytest.raises(LagrangianError, match="complex"):
        gt.equations_of_motion(frame, "u1*u2")
    assert gt.variation(frame).proved is True


def test_all_refusals_are_ours():
    """All errors derive from one base class, and from ValueError."""
    for error in (LagrangianError, KineticMatrixError, CoordinateError, ShapeError):
        assert issubclass(error, GeomtorsionError)
        assert issubclass(error, ValueError)

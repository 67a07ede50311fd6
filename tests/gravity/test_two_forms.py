"""Two-forms of Kalb and Ramond: field equations, identities, and the dual scalar field."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError

COSMOS = gt.spaces.load("frw_flat").frame
FLAT = gt.Frame("t x y z", [[int(i == j) for j in range(4)] for i in range(4)], "-+++")


def test_a_zero_potential_is_nothing():
    """B = 0 in flat space solves all equations, and so does a gradient, B = d(lambda)."""
    for potential in ([0] * 6, ["x", 0, 0, 0, 0, 0], ["y", 0, 0, "-t - 3*x", 0, 0]):
        system = g.equations(gt.levi_civita(FLAT), "-H2/12", g.kalb_ramond(potential))
        assert system.E.is_zero
        assert all(x.is_zero for x in system.matter_equations.values())


def test_a_homogeneous_strength_is_stiff_matter():
    """H_xyz = h is dual to a scalar field that depends on the time: density = pressure ~ a^-6."""
    field = g.kalb_ramond([0, 0, 0, "h*z", 0, 0])
    frame = gt.Frame(COSMOS.coordinates, COSMOS.coframe[:, :], "-+++", parameters="h")
    system = g.equations(gt.levi_civita(frame), "-H2/12", field)
    h, a = sp.Symbol("h"), sp.Function("a")(frame.coordinates[0])
    assert sp.simplify(system.E[0, 0] + h**2 / (2 * a**6)) == 0
    for k in (1, 2, 3):
        assert sp.simplify(system.E[k, k] - h**2 / (2 * a**6)) == 0


def test_equations_of_a_wave():
    """In flat space (d^a H_amn)/2 - B_mn/2 = 0: B_xy(t, z) solves the wave equation with mass 1."""
    field = g.kalb_ramond([0, 0, 0, "b(t, z)", 0, 0])
    (equation,) = g.equations(
        gt.levi_civita(FLAT), "-H2/12 - B2/4", field
    ).matter_equations.values()
    t, _, _, z = FLAT.coordinates
    b = sp.Function("b")(t, z)
    wave = -b.diff(t, 2) + b.diff(z, 2) - b
    assert sp.simplify(2 * equation[1, 2] - wave) == 0
    assert equation[2, 1] == -equation[1, 2]


@pytest.mark.parametrize("connection", [gt.levi_civita, gt.cartan])
def test_identities_hold_off_shell(connection):
    """Translations and rotations of the legs leave the Lagrangian invariant."""
    theory = "T - H2/12 - B2/4 + H2**2" if connection is gt.cartan else "R - H2/12 - B2/4 + H2*B2"
    field = g.kalb_ramond(["b(t, x)", 0, 0, "t*z", 0, "y*t"])
    checks = g.equations(connection(COSMOS), theory, field).identities()
    assert checks
    assert all(one.holds for one in checks)


def test_two_fields_have_names_of_their_own():
    """A second two-form is H2_2; a scalar field may be called H."""
    zero = g.kalb_ramond([0] * 6)
    matter = [zero, g.kalb_ramond([0, 0, 0, "z", 0, 0]), g.scalar_field("t", name="H")]
    system = g.equations(gt.levi_civita(FLAT), "-H2/12 - H2_2/12 - X/2", matter)
    assert len(system.matter_equations) == 3


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: g.equations(gt.levi_civita(FLAT), "-H2", g.kalb_ramond(["1"])), "6 entries"),
        (lambda: g.equations(gt.levi_civita(FLAT), "-H2", g.kalb_ramond("abc")), "potential"),
        (lambda: g.equations(gt.levi_civita(FLAT), "-H2", g.kalb_ramond(["x +"] * 6)), "potential"),
        (lambda: g.equations(gt.levi_civita(FLAT), "R - H2"), "kalb_ramond"),
    ],
)
def test_refusals(call, words: str):
    """The message of each wrong call names the expected value."""
    with pytest.raises(GeomtorsionError, match=words):
        call()

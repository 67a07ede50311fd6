"""Vocabulary: constants in a Lagrangian, and names that mean nothing."""

# Bad input.
# pyright: reportArgumentType=false

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError, GravityError

HOLE = gt.spaces.load("schwarzschild").frame
CARTAN, BAR = gt.cartan(HOLE), gt.levi_civita(HOLE)
BARE = "expected invariants, or constants that multiply them"
UNKNOWN = "expected the name of an invariant or of a parameter"

# Lagrangian -> words of its refusal.
REFUSED = {
    "": "got an empty text",
    "  ": "got an empty text",
    "nan": "expected a formula in invariants, got nan",
    "nan*T": "expected a formula in invariants, got nan",
    "self": "expected a formula in invariants, got self",
    "None*T": "expected a formula in invariants, got None",
    "T + oo": "expected a formula in invariants, got oo",
    "R + Ric2/2": "got Ric2. Did you mean R4 (R_ab R^ab",
    "R*Ric2": "got Ric2. Did you mean R4 (R_ab R^ab",
    "f(T,B)": "The boundary term B is Rbar + T: give equations([gt.cartan(frame)",
    "T*B": "The boundary term B is Rbar + T",
    "kretschmann": "got kretschmann. Did you mean R1 (R_abcd R^abcd)",
    "Ricci": "got Ricci. Did you mean R (curvature scalar",
    "tensor": "Did you mean tensor2",
    "TEGR": "got TEGR. Did you mean tegr, in Python gravity.tegr?",
    "2*Tegr + 1": "Did you mean tegr",
    "einstein_carton": "Did you mean einstein_cartan, in Python gravity.einstein_cartan",
    "Tt": f"{BARE}, got Tt. ",
    "foo": f"{BARE}, got foo. ",
    "T + foo": f"{BARE}, got foo in T + foo. ",
    "lovelock3": f"{BARE}, got lovelock3",
    "alpha*beta": f"{BARE}, got alpha in alpha*beta",
    "T + alpha*beta": f"{BARE}, got alpha",
    "T**n": f"{BARE}, got n in T**n",
    "f(T, c)": f"{BARE}, got c in f(T, c)",
    "f(T + c)": f"{BARE}, got c in T + c",
    "sqrt(c**2 + T)": f"{BARE}, got c in T + c**2",
    "(T + c)*T": f"{BARE}, got c in T + c",
    "c**T": f"{BARE}, got c",
    "R_abcd*R^abde": "got R_abcd. In a contraction each index",
    "a*T_ab": "got T_ab. In a contraction each index",
    "c/R_ab*R^ab": "got R_ab. In a contraction",
    "R_ab R^ab**2": "got R_ab. In a contraction",
    "c*M_abcd M^abcd": "expected a tensor, got M_abcd",
    "Box(T)": "expected invariants without derivatives, got Box(...)",
    "nabla_a(T)": "expected invariants without derivatives, got nabla_a(...)",
    "diff(T, r)": "only unknown functions are differentiated",
    "Sqrt(T)": "got Sqrt(...). Did you mean sqrt?",
    "kretschmann(T)": "got kretschmann(...). Did you mean R1?",
    "abs(T)": "got Abs(T), which is not smooth",
    "T + X": "X belongs to a matter field, and none is given",
    "T + c*phi*X": 'in perturbations scalars="phi" (on the command line --scalars phi)',
    "T + F2": "in perturbations vectors=1",
}


@pytest.mark.parametrize("text", REFUSED)
def test_names_that_mean_nothing(text: str) -> None:
    """Text and sympy expressions with a name that has no meaning are refused."""
    with pytest.raises(GeomtorsionError) as refused:
        g.equations(CARTAN, text)
    assert REFUSED[text] in str(refused.value)


def test_names_in_an_expression() -> None:
    """The rule for text holds for sympy expressions."""
    T, new, n = g.names["T"], sp.Symbol("Ric2"), sp.Symbol("n", positive=True)
    for expression, words in (
        (T + new / 2, "Did you mean R4"),
        (T**n, "got n in T\\*\\*n"),
        (sp.Function("f")(T, n), "got n in f"),
        (sp.Function("Box")(T), "without derivatives"),
    ):
        with pytest.raises(GravityError, match=words):
            g.equations(CARTAN, expression)
    assert g.equations(CARTAN, T**n, constants=n).constants == ("n",)


ACCEPTED = {
    "T + alpha*T**2": ("alpha",),
    "T + T**2/T0": ("T0",),
    "a*(R - 2*Lambda)": ("Lambda", "a"),
    "a*R - 2*a*Lambda": ("Lambda", "a"),
    "R/(16*pi*G) - Lambda/(8*pi*G)": ("G", "Lambda"),
    "lambda*(sqrt(1 + 2*T/lambda) - 1)": ("lambda",),
    "f(alpha*T) + exp(-T/T0)": ("T0", "alpha"),
    "(c + sin(d))*T": ("c", "d"),
    "T + M**2*f(T) + M": (),
}


@pytest.mark.parametrize("text", ACCEPTED)
def test_coefficients_are_constants(text: str) -> None:
    """A name that multiplies invariants is a constant, and the result lists it. Lambda is added."""
    found = g.equations(CARTAN, text)
    assert found.constants == ACCEPTED[text]
    listed = f"constants: {' '.join(found.constants)}"
    assert (listed if found.constants else "(Cartan connection)") in repr(found)


@pytest.mark.parametrize("constants", ["n v", "n, v", ["n", "v"], sp.symbols("n v")])
def test_declared_constants(constants: object) -> None:
    """A declared name may be an exponent, a term or an argument."""
    found = g.equations(CARTAN, "T**n + f(T, v)", constants=constants)
    assert found.constants == ("n", "v")
    for own in ("n v", ("n", "v")):
        theory = g.Lagrangian("T**n + v", "teleparallel", "power law", own)
        assert g.equations(CARTAN, theory).constants == ("n", "v")
    assert "Ric2" in g.equations(BAR, "R + Ric2/2", constants="Ric2").constants


DECLARED = {
    "unused": ("T", "c", "expected names that occur in the Lagrangian, got c"),
    "misspelt": ("T + alpha", "alhpa", "Did you mean alpha"),
    "invariant": ("T", "R4", "got R4, which has a meaning"),
    "invariant of a second connection": ("T", "Rbar", "got Rbar, which has a meaning"),
    "number": ("T", 3, "expected names such as"),
    "two names in one": ("T", ["a b"], "expected a name such as alpha"),
    "a formula": ("T", "a+b", "expected a name such as alpha, got 'a+b'"),
    "one of two": ("T**n + v", "n", 'declare it: constants="n v"'),
}


@pytest.mark.parametrize("case", DECLARED)
def test_wrong_declarations(case: str) -> None:
    """A declaration that does not fit the Lagrangian is refused."""
    text, constants, words = DECLARED[case]
    with pytest.raises(GravityError) as refused:
        g.equations(CARTAN, text, constants=constants)
    assert words in str(refused.value)


def test_constants_of_other_lagrangians_are_not_remembered() -> None:
    """A constant of one Lagrangian is not a symbol of the frame for the next one."""
    frame = gt.spaces.load("frw_flat").frame
    assert g.equations(gt.cartan(frame), "T + c*T**2").E.is_zero is False
    with pytest.raises(GravityError, match="got c in T"):
        g.equations(gt.cartan(frame), "T + c")


def test_symbols_of_the_connection_have_a_meaning() -> None:
    """A symbol in the torsion may be added to an invariant, and belongs to no constant."""
    x, y, z, s = sp.symbols("x y z s")
    flat = gt.Frame([x, y, z], sp.eye(3))
    torsion = [[[s * sp.LeviCivita(a, b, k) for k in range(3)] for b in range(3)] for a in range(3)]
    found = g.equations(gt.from_torsion(flat, torsion), "T1 + s")
    assert found.constants == ()
    assert (found.L - (24 * s**2 + s)).is_zero


def test_the_boundary_term() -> None:
    """B = Rbar + T is a divergence: it has no equation, but f(T, B) has one."""
    frame = gt.spaces.load("frw_flat").frame
    pair = [gt.cartan(frame), gt.levi_civita(frame)]
    t = frame.coordinates[0]
    a = sp.Function("a")(t)
    H = sp.diff(a, t) / a
    # B = 6 (H' + 3 H^2) (Bahamonde, Boehmer, Wright 2015)
    assert (g.equations(pair, "Rbar + T").L - 6 * (sp.diff(H, t) + 3 * H**2)).is_zero
    assert g.equations(pair, "Rbar + T").E.is_zero
    squared = g.equations(pair, "f(T, Rbar + T)")
    assert not squared.E.is_zero
    assert all(check.holds for check in squared.identities())


def test_presets_know_their_constants() -> None:
    """The cosmological constant of a preset may have any name."""
    connection = gt.spaces.load("torsion_bounce").connection
    found = g.equations(connection, g.poincare("a", "L0", tensor="b"))
    assert found.constants == ("L0", "a", "b")

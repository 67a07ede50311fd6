"""Invariants by formulas with indices: their values, field equations, files and refusals."""

# Compiled functions of arrays, and bad input.
# pyright: reportArgumentType=false

import re
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError
from tests.gravity.action import fields, variation
from tests.gravity.samples import sample_connection, sample_frame
from tests.gravity.test_equations import compiled

# Müller-Hoissen (1985), with R_ab = R_cab^c: his R_abcd is R_abdc here.
LOVELOCK = (
    "-2 R^abcd R_cdef R^ef_ab - 8 R^ab_ce R^cd_bf R^ef_ad + 24 R^abcd R_cdbe R^e_a"
    " + 3 R^abcd R_abcd R - 24 R^abcd R_ac R_bd + 16 R^ab R_bc R^c_a - 12 R^ab R_ab R + R^3"
)


def numbers(formula: str, eta: np.ndarray, known: dict) -> np.ndarray:
    """A product at many points, by one call of einsum in which eta joins all pairs of indices."""
    n = len(eta)
    epsilon = np.zeros((n,) * n)
    for order in np.ndindex(*epsilon.shape):
        if len(set(order)) == n:
            epsilon[order] = np.linalg.det(np.eye(n)[list(order)])
    groups, arrays, seen = [], [], {}
    fresh = iter("MNOPQSUVWXYZ")
    for name, indices in re.findall(r"(\w+?)[_^]([a-z_^]+)", formula):
        group = ""
        for letter in indices.replace("_", "").replace("^", ""):
            if letter in seen:
                groups.append(letter + (new := next(fresh)))
                arrays.append(np.linalg.inv(eta))
                letter = new
            seen[letter] = True
            group += letter
        groups.append(group if name == "eps" else "L" + group)
        arrays.append(epsilon if name == "eps" else known[name])
    return np.einsum(",".join(groups) + "->L", *arrays, optimize=True)


@pytest.mark.parametrize(
    ("n", "metric", "formulas"),
    [
        (3, False, ("R_abcd R^abdc", "R_abcd R^dbca", "R_abcd R^cdef R_ef^ab", "T_abc Q^cab")),
        (
            3,
            True,
            ("eps^abc T_abd T_ce^f T^ed_f", "eps^abc R_abde T_c^de", "T_abc T^bcd T_de^a T^ef_f"),
        ),
        (4, True, ("eps^abcd T_abe T_cd^e", "eps^abcd R_abcd R^ef_fe", "R_abcd R^cdef R_ef^ab")),
    ],
)
def test_equations_are_the_variation_of_the_action(
    n: int, metric: bool, formulas: tuple[str, ...]
) -> None:
    """E and C of formulas agree with complex steps in the action, made of the same letters."""
    frame = sample_frame(n, 30 + n)
    connection = sample_connection(frame, 31 + n, metric=metric)
    own = [g.invariant(f"Y{k}y", text) for k, text in enumerate(formulas, 1)]
    text = " + ".join(f"{k}*Y{k}y" for k in range(1, len(own) + 1)) + " + Y1y*Y2y/7"
    equations = g.equations(connection, text, invariants=own)
    eta = np.diag([-1.0] + [1.0] * (n - 1))

    def density(e, de, w, dw):
        known = fields(eta, e, de, w, dw)
        values = [numbers(formula, eta, known) for formula in formulas]
        total = sum(k * value for k, value in enumerate(values, 1)) + values[0] * values[1] / 7
        return known["e"] * total

    q = frame.coordinates
    point = np.array([0.3, -0.2, 0.5, 0.4][:n])
    of_e, of_w = variation(
        density,
        compiled(frame.coframe.to_sympy(), q),
        compiled(connection.spin_connection.to_sympy(), q),
        point,
    )
    at = dict(zip(q, map(sp.Rational, map(str, point)), strict=True))
    e, legs = frame.determinant.at(at), frame.legs.at(at)
    E = e * np.einsum("in,mn->im", equations.E.at(at), legs)
    C = e * np.einsum("nij,mn->mij", equations.C.at(at), legs)
    if metric:
        # A metric connection is varied within metric connections: omega_aij antisymmetric.
        lower = np.einsum("aij,jk->aik", of_w, eta)
        of_w = np.einsum("aik,kj->aij", (lower - np.swapaxes(lower, 1, 2)) / 2, eta)
    assert np.abs(of_e).max() > 1
    assert np.allclose(E, of_e, rtol=1e-8, atol=1e-8 * np.abs(of_e).max())
    assert np.allclose(C, of_w, rtol=1e-8, atol=1e-8 * np.abs(of_w).max())


# Name -> the same invariant, written in another way.
SPELLED = {
    "T": "1/4 T_abc T^abc + 1/2 T^ab_c T^c_ba - T_ab^b T^ac_c",
    "tensor2": "2/3 T_abc T^abc + 2/3 T_abc T^cba - 2/3 v_a v^a",
    "R": "g^bc R_abcd g^ad",
    "R5": "R_cab^c R^dba_d",
    "GB": "R_abcd R^cdab - 4 R_ab R^ba + g_ab g^ab R^2 / 4",
    "nieh_yan": "eps^abcd T_abe T_cd^e + 2 eps^abcd R_abcd",
    "pontryagin": "eps^abcd R_cd^ef R_abef",
    "Q": "Q_abc Q^abc/4 - Q_abc Q^bac/2 - Q_ab^b Q^ac_c/4 + Q_a q^a/2",
    "U3": "1/2 v_a Q_b^ab + v_a q^a * 1/2",
}


@pytest.mark.parametrize("name", SPELLED)
def test_a_name_and_its_formula_have_the_same_equations(name: str) -> None:
    """E and C of an invariant and of its formula in other words are equal."""
    is_affine = name in ("T", "R", "R5", "Q", "U3")
    frame = sample_frame(4, 3)
    connection = sample_connection(frame, 4, metric=not is_affine)
    spelled = g.invariant("Y", SPELLED[name])
    one, other = (g.equations(connection, x, invariants=spelled) for x in (f"f({name})", "f(Y)"))
    assert (one.L - other.L).is_zero
    assert not one.L.is_zero
    assert (one.E - other.E).is_zero
    assert (one.C - other.C).is_zero


def cosmos(n: int, *scales: str) -> gt.Frame:
    """A homogeneous universe without curvature of space; scales repeat."""
    t, *x = sp.symbols(f"t x1:{n}")
    sizes = [sp.Function(scales[k % len(scales)])(t) for k in range(n - 1)]
    return gt.Frame([t, *x], sp.diag(1, *sizes), (-1,) + (1,) * (n - 1))


def test_the_third_lovelock_invariant() -> None:
    """It vanishes in four dimensions, and has (n - 1) ... (n - 6) H^6 as its energy in seven."""
    lovelock = g.invariant("L3", LOVELOCK)
    flat = gt.levi_civita(cosmos(4, "a", "b", "c"))
    equations = g.equations(flat, "L3", invariants=lovelock)
    assert equations.L.is_zero
    assert equations.E.is_zero
    cubes = g.equations(flat, "L3 + R6*R", invariants=lovelock)
    assert not cubes.E.is_zero
    frame = cosmos(7, "a")
    t, a = frame.coordinates[0], frame.coframe[1, 1]
    energy = g.equations(gt.levi_civita(frame), "L3", invariants=lovelock).E
    assert frame.scalar(energy[0, 0]) == 720 * (sp.diff(a, t) / a) ** 6


def test_the_third_lovelock_invariant_of_three_spheres() -> None:
    """The product of three unit spheres has 3! R_1 R_2 R_3 = 48."""
    q = sp.symbols("a p b q c s")
    legs = [x for k in range(3) for x in (1, sp.sin(q[2 * k]))]
    spheres = gt.levi_civita(gt.Frame(q, sp.diag(*legs)))
    equations = g.equations(spheres, "L3", invariants=g.invariant("L3", LOVELOCK))
    assert equations.scalar("L3") == 48


def test_a_massive_vector_field() -> None:
    """Proca: D_m F^mn = m^2 A^n, and the identities with A itself in the Lagrangian."""
    x, y, z = q = sp.symbols("x y z")
    frame = gt.Frame(q, [[1 + y**2, x * z, 0], [0, 1, x * y], [z, 0, 1]], (-1, 1, 1))
    field = g.maxwell([y * z, x**2, x * y])
    own = [g.invariant("Y", "A_a A^a"), g.invariant("W", "T_abc F^ab A^c")]
    for connection in (gt.cartan(frame), gt.levi_civita(frame)):
        text = "T1*Y + W + F2*Y" if connection.kind == "cartan" else "R - F2/4 - m**2*Y/2"
        equations = g.equations(connection, text, field, invariants=own)
        assert all(check.holds for check in equations.identities())
        assert not equations.matter_equations["A"].is_zero
    massless = g.equations(connection, "-F2/4", field).matter_equations["A"]
    A = gt.Tensor(frame, "d", {(0,): y * z, (1,): x**2, (2,): x * y}).in_frame().raised()
    m = sp.Symbol("m")
    assert (equations.matter_equations["A"] - massless + A * m**2).is_zero


def test_a_static_potential_of_yukawa() -> None:
    """exp(-m r)/r solves Proca's equation in flat space, and not Maxwell's."""
    t, r, theta, phi = sp.symbols("t r theta phi")
    flat = gt.levi_civita(
        gt.Frame([t, r, theta, phi], sp.diag(1, 1, r, r * sp.sin(theta)), (-1, 1, 1, 1))
    )
    field = g.maxwell(["exp(-m*r)/r", 0, 0, 0])
    mass = g.invariant("Y", "A_a A^a")
    proca = g.equations(flat, "-F2/4 - m**2*Y/2", field, invariants=mass)
    assert proca.matter_equations["A"].is_zero
    assert not g.equations(flat, "-F2/4", field).matter_equations["A"].is_zero


def test_a_kinetic_term_with_the_einstein_tensor() -> None:
    """R/2 - X/2 + c G^ab phi_a phi_b / 2: 3 H^2 = phi'^2 (1 + 9 c H^2)/2 (Sushkov 2009)."""
    frame = cosmos(4, "a")
    t, a = frame.coordinates[0], frame.coframe[1, 1]
    H, rate = sp.diff(a, t) / a, sp.diff(sp.Function("u")(t), t)
    own = g.invariant("Y", "G^ab phi_a phi_b")
    field = g.scalar_field("u(t)")
    equations = g.equations(gt.levi_civita(frame), "R/2 - X/2 + c*Y/2", field, invariants=own)
    c = sp.Symbol("c")
    assert frame.scalar(equations.E[0, 0]) == 3 * H**2 - rate**2 / 2 - 9 * c * H**2 * rate**2 / 2
    # The Lagrangian has only derivatives of phi: its equation is a conserved current.
    current = a**3 * rate * (1 + 3 * c * H**2)
    assert equations.matter_equations["phi"] == -sp.diff(current, t) / a**3
    assert all(check.holds for check in equations.identities())


def test_endings_name_the_connection() -> None:
    """Y, Y_2 and Ybar are one formula on three connections; Rbar in a formula is one of them."""
    frame = sample_frame(3, 5)
    bar = gt.levi_civita(frame)
    several = [gt.cartan(frame), sample_connection(frame, 6, metric=True), bar]
    own = [g.invariant("Y", "R_ab R^ab"), g.invariant("W", "Rbar_ab v^a v_2^b")]
    equations = g.equations(several, "T1*Ybar + Y_2*W + Y", invariants=own)
    assert equations.scalar("Y").is_zero
    assert equations.scalar("Ybar") == equations.scalar("R4bar")
    assert equations.scalar("Y_2") == equations.scalar("R4_2")
    assert all(check.holds for check in equations.identities())
    vectors = [contracted(one) for one in several[:2]]
    ricci = bar.curvature.ricci.in_frame()
    assert equations.scalar("W") == gt.contract("ab,a,b->", ricci, *vectors)


def contracted(connection: gt.Connection) -> gt.Tensor:
    """v^a = T^ab_b."""
    torsion = connection.torsion.T.in_frame()
    return gt.contract("abb->a", torsion).raised()


def theory_file(folder: Path, text: str) -> Path:
    """A file with a theory."""
    file = folder / "theory.toml"
    file.write_text(text)
    return file


def test_a_theory_from_a_file(tmp_path: Path) -> None:
    """A file gives the Lagrangian, its constants, invariants and kind of connection."""
    text = (
        '[theory]\nlagrangian = "R + c*Y**n"\nconstants = "n"\n[theory.invariants]\n'
        'Y = "R_abcd R^abdc"\n'
    )
    theory = g.read_theory(theory_file(tmp_path, text))
    assert (theory.name, theory.constants, theory.geometry) == ("theory", "n", "any")
    assert theory.invariants == (g.invariant("Y", "R_abcd R^abdc"),)
    sphere = gt.levi_civita(gt.spaces.load("so3").frame)
    assert g.equations(sphere, theory).constants == ("c", "n")


def test_invariants_of_a_model(tmp_path: Path) -> None:
    """The table [theory] of a tetrad file may contain invariants, and ask for all torsion."""
    text = """
    coordinates = ["t", "x", "y", "z"]
    coframe = [[1, 0, 0, 0], [0, "a(t)", 0, 0], [0, 0, "a(t)", 0], [0, 0, 0, "a(t)"]]
    signature = [-1, 1, 1, 1]
    functions = {a = ["t"]}
    [theory]
    lagrangian = "R/2 + c*Y"
    connection = "invariant-torsion"
    invariants = {Y = "v_a v^a"}
    """
    equations = g.read_model(theory_file(tmp_path, text)).equations
    other = g.equations(equations.connections, "R/2 + c*T3")
    assert (equations.E - other.E).is_zero
    assert "u2(t)" in str(equations.C.nonzero())


BAR = gt.levi_civita(sample_frame(3, 1))
REFUSED = {
    "three indices": (lambda: g.invariant("Y", "R_abc R^abc"), "expected R with 0 or 2 or 4"),
    "once": (lambda: g.invariant("Y", "v_a"), "got it 0 times up and 1 times down"),
    "twice down": (lambda: g.invariant("Y", "v_a v_a"), "expected index a once up and once down"),
    "thrice": (lambda: g.invariant("Y", "T_abc T^abc v_a"), "expected index a once up"),
    "unknown": (lambda: g.invariant("Y", "W_abc T^abc"), "expected a tensor, got W_abc"),
    "name": (lambda: g.invariant("Y", "R1"), "expected a tensor, got R1"),
    "scalar": (lambda: g.invariant("Y", "phi R"), "Multiply an invariant by a scalar in the Lagr"),
    "brackets": (lambda: g.invariant("Y", "(R_ab + R_ba) R^ab"), "without brackets"),
    "square of indices": (lambda: g.invariant("Y", "R_ab^2"), "expected a power from 1 to"),
    "large power": (lambda: g.invariant("Y", "R^999"), "expected a power from 1 to 256"),
    "many products": (
        lambda: g.invariant("Y", " ".join(["G_ab G^ab"] * 5)),
        "expected index a once up and once down",
    ),
    "many sums": (
        lambda: g.invariant("Y", " ".join(f"G_{x} G^{x}" for x in "ab cd ef gh ij".split())),
        "expected at most 256 products, got 1024",
    ),
    "long": (lambda: g.invariant("Y", "R " * 2000), "the limit is 2,000"),
    "denominator": (lambda: g.invariant("Y", "R / R"), "expected a number after /"),
    "zero": (lambda: g.invariant("Y", "R / 0"), "expected a number that is not zero"),
    "decimal": (lambda: g.invariant("Y", "0.5 R"), "Write 1/2"),
    "empty": (lambda: g.invariant("Y", "  "), "expected a product such as"),
    "end": (lambda: g.invariant("Y", "R +"), "expected a product such as"),
    "two signs": (lambda: g.invariant("Y", "R * / 2"), "got / here"),
    "code": (lambda: g.invariant("Y", "__import__('os')"), "not part of an expression"),
    "no text": (lambda: g.invariant("Y", 3), "formula: expected text, got 3"),
    "no name": (lambda: g.invariant(3, "R"), "name: expected text, got 3"),
    "old name": (lambda: g.invariant("T1", "R"), "which has a meaning in Lagrangians"),
    "ending": (lambda: g.invariant("Ybar", "R"), "does not end in bar or _2"),
    "two eps": (lambda: g.invariant("Y", "eps^abc T_abc + eps^ab V_ab"), "got [2, 3]"),
    "metric bar": (lambda: g.invariant("Y", "gbar_ab R^ab"), "all connections have one metric"),
    "dimension": (
        lambda: g.equations(BAR, "Y", invariants=g.invariant("Y", "eps^abcd R_abcd")),
        "Y exists in 4 dimensions only",
    ),
    "twice": (
        lambda: g.equations(BAR, "Y", invariants=[g.invariant("Y", "R"), g.invariant("Y", "R^2")]),
        "got Y for an invariant and for another invariant",
    ),
    "matter": (
        lambda: g.equations(BAR, "R + Y", invariants=g.invariant("Y", "A_a A^a")),
        "A belongs to a matter field, and none is given. Give matter=gravity.maxwell(A)",
    ),
    "other connection": (
        lambda: g.equations(
            gt.cartan(BAR.frame), "Y", invariants=g.invariant("Y", "Rbar_ab v^a v^b")
        ),
        "expected tensors of the given connections, got Rbar",
    ),
    "formula": (lambda: g.equations(BAR, "R", invariants="R_ab R^ab"), "expected gravity.invari"),
    "tensor's name": (lambda: g.scalar_field("u(t)", name="v"), "which is a tensor in formulas"),
    "unused": (lambda: g.equations(BAR, "R + R_abcd"), "once up and once down"),
}
FILES = {
    'lagrangian = "R"': "expected a table [theory], got none",
    "theory = 3": "expected a table [theory], got 3",
    '[theory]\nlagrangian = "R"\nlagrange = "R"': "line 3: theory: unknown key 'lagrange'",
    '[theory]\nname = "R"': "theory: expected a lagrangian",
    "[theory]\nlagrangian = 3": "lagrangian: expected text in quotes, got 3",
    '[theory]\nlagrangian = "Y"\ninvariants = ["R"]': "expected a table [invariants]",
    '[theory]\nlagrangian = "Y"\n[theory.invariants]\nY = 3': "formula: expected text, got 3",
    '[theory]\nlagrangian = "R"\nconstants = ["n"]': "constants: expected text in quotes",
    '[theory]\nlagrangian = "R"\ngeometry = "flat"': "geometry",
    "lagrangian = ": "theory.toml",
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_calls_are_refused(case: str) -> None:
    """Each refusal is an error of this package and names the expectation or the remedy."""
    call, words = REFUSED[case]
    with pytest.raises(GeomtorsionError, match=re.escape(words)):
        call()


@pytest.mark.parametrize("text", FILES)
def test_files_that_are_refused(tmp_path: Path, text: str) -> None:
    """A key or a value with no meaning is refused by the name of the file."""
    with pytest.raises(GeomtorsionError, match=re.escape(FILES[text])):
        g.read_theory(theory_file(tmp_path, text))

"""Contractions in the text of a Lagrangian, as papers write them."""

import pytest

import geomtorsion as gt
from geomtorsion import gravity

BALL = gt.Frame("r theta phi", [["sqrt(1 + r^2)", 0, 0], [0, "r", 0], [0, 0, "r^2*sin(theta)"]])
CONNECTION = gt.cartan(BALL)
METRIC = gt.levi_civita(BALL)

# Contraction as typed, and the same invariant by its name or as `invariant` reads it.
NAMED = [
    ("R_ab R^ab", "R4"),
    ("R_{ab}R^{ab}", "R4"),
    (r"R_{\mu\nu} R^{\mu\nu}", "R4"),
    ("R_{μν}R^{μν}", "R4"),
    ("R_ab*R^ab", "R4"),
    ("R^ab R_ab", "R4"),
    ("R_ab R^ba", "R5"),
    ("Ric_mn Ric^mn", "R4"),
    ("R_abcd R^abcd - 4*R_ab R^ab + R^2", "R1 - 4*R4 + R^2"),
    ("Riem_cdab Riem^cdab", "R1"),
    ("T_abc T^abc/4 + T_abc*T^cba/2 - v_a v^a", "T"),
    ("R_ab R^ab T_abc T^abc", "R4*T1"),
    ("c_s*R_ab R^ab", "c_s*R4"),
    ("(R_ab R^ab)**2/R_cd R^cd", "R4"),
]


@pytest.mark.parametrize(("typed", "meant"), NAMED)
def test_contractions_have_their_value(typed: str, meant: str) -> None:
    connection = METRIC if "R" in typed and "T" not in typed else CONNECTION
    constants = "c_s" if "c_s" in typed else ()
    one = gravity.equations(connection, f"R + {typed}", constants=constants)
    two = gravity.equations(connection, f"R + {meant}", constants=constants)
    assert (one.L - two.L).is_zero
    assert not one.lagrangian.invariants


def test_a_contraction_without_a_name_is_one_of_your_own() -> None:
    own = gravity.invariant("Z", "R_abcd R^acbd")
    typed = gravity.equations(METRIC, "R + c*R_ab R^ac R_c^b")
    other = gravity.equations(
        METRIC, "R + c*Z", invariants=gravity.invariant("Z", "R_ab R^ac R_c^b")
    )
    assert (typed.L - other.L).is_zero
    assert repr(typed.lagrangian).endswith("L = R + c*Y1, Y1 = R_ab R^ac R_c^b")
    twice = gravity.equations(METRIC, "R + Y1 + R_ab R^ac R_c^b", constants="Y1", invariants=own)
    assert "Y2 = " in repr(twice.lagrangian)


def test_matter_in_indices() -> None:
    """Proca's theory as in textbooks: mass m, three modes."""
    spectrum = gravity.perturbed.spectrum(
        "R/2 - F_{ab}F^{ab}/4 - m**2*A_a A^a/2", vectors=1, constants="m"
    )
    (massive,) = [one for one in spectrum.particles if not one.is_massless]
    assert (str(massive.mass2), massive.number) == ("m**2", 3)


def test_new_general_relativity_in_indices() -> None:
    one = gravity.perturbed.spectrum("a*T_abc T^abc + b*T_abc T^cba + c*v_a v^a")
    two = gravity.perturbed.spectrum("a*T1 + b*T2 + c*T3")
    assert one.geometry == "teleparallel"
    assert str(one).split("\n")[1:] == str(two).split("\n")[1:]


@pytest.mark.parametrize(
    "text", ["R_{" + "a" * 60, "R + " + "A_a " * 2000, "R_ab" + " " * 4000 + "!"]
)
def test_long_texts_without_a_contraction_are_refused(text: str) -> None:
    """Searching these for contractions took minutes or more."""
    with pytest.raises(gt.GeomtorsionError):
        gravity.equations(METRIC, text)

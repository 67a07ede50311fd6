"""Stars of polytropes, of tables and of published matter: masses, radii, tides and rotation."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import FileFormatError, GeomtorsionError
from tests.chosen import few

T, R, THETA, PHI = sp.symbols("t r theta phi")
A, B = (sp.Function(name)(R) for name in "AB")
STATIC = gt.Frame([T, R, THETA, PHI], sp.diag(A, B, R, R * sp.sin(THETA)), (-1, 1, 1, 1))
RADIAL = sp.Matrix([sp.sin(THETA) * sp.cos(PHI), sp.sin(THETA) * sp.sin(PHI), sp.cos(THETA)])
LEGS = sp.Matrix.hstack(B * RADIAL, R * RADIAL.diff(THETA), R * RADIAL.diff(PHI))
PROPER = gt.cartan(gt.Frame([T, R, THETA, PHI], sp.diag(A, LEGS), (-1, 1, 1, 1)))
SOFT = g.polytropes(100, [2])
FONT = 100 * 1.28e-3**2
# The other integration omits a layer with this share of the root of the central pressure.
SHARE = 1e-7
NOTHING: Any = None
THREE: Any = 3
OWN = g.equations(gt.levi_civita(STATIC), "R/(16*pi)", g.fluid(p="SLy"))


@pytest.fixture(scope="module")
def sly() -> g.Family:
    """Stars of SLy."""
    return g.family("SLy", [6e14, 9e14, 1.4e15, 2.2e15, 2.8e15, 3.4e15])


@pytest.mark.parametrize("pressure", [1e-9, 1e-4, 1e-3])
def test_constant_density(pressure: float) -> None:
    """Schwarzschild's interior solution, and errors that hold."""
    star = g.star(g.incompressible(1e-3), pressure=pressure)
    # 1 - share^2, without a difference of nearly equal numbers.
    share = 2 * pressure / (1e-3 + 3 * pressure)
    radius = math.sqrt(3 * share * (2 - share) / (8 * math.pi * 1e-3))
    assert abs(star.radius - radius) <= star.errors["radius"] < 1e-9 * radius
    mass = 4 / 3 * math.pi * 1e-3 * radius**3
    # The mass also has the error of the radius at which it is compared.
    assert abs(star.mass - mass) <= star.errors["mass"] + 3 * mass * star.errors["radius"] / radius


@pytest.mark.parametrize(
    ("matter", "love", "inertia"),
    [
        (g.incompressible(1), 3 / 4, 2 / 5),
        (g.energy_polytrope(1, 2), (15 - math.pi**2) / (2 * math.pi**2),
         2 / 3 * (1 - 6 / math.pi**2)),
        (g.polytropes(1, [2]), (15 - math.pi**2) / (2 * math.pi**2), 2 / 3 * (1 - 6 / math.pi**2)),
    ],
)  # fmt: skip
def test_light_stars_are_newtons(matter: g.EquationOfState, love: float, inertia: float) -> None:
    """k2 and I/(M R^2) of Newtonian stars of index 0 and 1 in closed form."""
    pressure = 1e-7 if matter.name.startswith("matter") else 1e-14
    star = g.star(matter, pressure=pressure)
    small = 10 * star.compactness
    assert star.compactness < 1e-6
    assert star.love_number == pytest.approx(love, rel=small)
    assert star.moment_of_inertia / (star.mass * star.radius**2) == pytest.approx(
        inertia, rel=small
    )


def independent(star: g.Star, softness: Callable[[float], tuple[float, float]]) -> list[float]:
    """Mass, radius, k2 and I of a star by an integration over the radius.

    softness: density and its derivative by the pressure, of a pressure.

    Tide: r y' + y^2 + y e^lambda (1 + 4 pi r^2 (p - rho)) + r^2 Q = 0 (Postnikov et al. 2010).
    Rotation: (r^4 j w')' + 4 r^3 j' w = 0 (Hartle 1967).
    """

    def rates(r: float, state: np.ndarray) -> list[float]:
        root, m, y, nu, w, s = state
        # The root of the pressure falls linearly at the surface of these stars.
        p = max(root, 1e-30) ** 2
        rho, change = softness(p)
        stretch = 1 / (1 - 2 * m / r)
        pull = (m + 4 * math.pi * r**3 * p) * stretch / r**2
        q = 4 * math.pi * stretch * (5 * rho + 9 * p + (rho + p) * change)
        q -= 6 * stretch / r**2 + 4 * pull**2
        slope = -(y**2 + y * stretch * (1 + 4 * math.pi * r**2 * (p - rho)) + r**2 * q) / r
        j = math.exp(-nu) / math.sqrt(stretch)
        return [
            -(rho + p) * pull / (2 * math.sqrt(p)), 4 * math.pi * r**2 * rho, slope, pull,
            s / (r**4 * j), 16 * math.pi * r**4 * (rho + p) * stretch * j * w,
        ]  # fmt: skip

    r0, p0 = 1e-5 * star.radius, star.pressure
    first = [math.sqrt(p0), 4 / 3 * math.pi * r0**3 * star.density, 2.0, 0.0, 1.0, 0.0]

    class Surface:
        terminal = True

        def __call__(self, _: float, state: np.ndarray) -> float:
            return state[0] - SHARE * math.sqrt(p0)

    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-18, "events": Surface()}
    answer = solve_ivp(rates, (r0, 2 * star.radius), first, **options)
    r, (_, m, y, nu, w, s) = answer.t[-1], answer.y[:, -1]
    c = m / r
    above = (1 - 2 * c) ** 2 * (2 + 2 * c * (y - 1) - y)
    below = 2 * c * (6 - 3 * y + 3 * c * (5 * y - 8))
    below += 4 * c**3 * (13 - 11 * y + c * (3 * y - 2) + 2 * c**2 * (1 + y))
    below += 3 * above * math.log(1 - 2 * c)
    momentum = s * math.exp(nu) / math.sqrt(1 - 2 * c) / 6
    return [m, r, 8 / 5 * c**5 * above / below, momentum / (w + 2 * momentum / r**3)]


def numbers_of(star: g.Star) -> list[float]:
    return [star.mass, star.radius, star.love_number, star.moment_of_inertia]


# Index n of p = K rho^(1 + 1/n), K = 100, compactness, k2 and central pressure of the stars in
# table 1 of Hinderer, Astrophys. J. 677, 1216 (2008). Its k2 have an accuracy of about 1 %, and of
# 7 % at a compactness of 0.25, which is omitted.
PUBLISHED = [
    (0.7, 0.1, 0.1779, 3.605e-4),
    (0.7, 0.15, 0.1171, 9.459e-4),
    (0.7, 0.2, 0.0721, 2.169e-3),
    (1.0, 0.1, 0.1220, 4.322e-5),
    (1.0, 0.15, 0.0776, 1.395e-4),
    (1.0, 0.2, 0.0459, 3.940e-4),
    (1.2, 0.1, 0.0931, 1.097e-5),
    (1.2, 0.15, 0.0577, 4.129e-5),
    (1.2, 0.2, 0.0327, 1.391e-4),
]


@pytest.mark.parametrize(("index", "compactness", "love", "pressure"), PUBLISHED)
def test_published_love_numbers(
    index: float, compactness: float, love: float, pressure: float
) -> None:
    """Stars of the published table, whose pressures have four digits."""
    star = g.star(g.energy_polytrope(100, 1 + 1 / index), pressure=pressure)
    assert star.compactness == pytest.approx(compactness, rel=1e-3)
    assert star.love_number == pytest.approx(love, rel=0.015)


def test_a_relativistic_star_by_another_integration() -> None:
    """The star of p = 100 rho^2 whose compactness is 0.2."""
    star = g.star(g.energy_polytrope(100, 2), pressure=3.940e-4)
    other = independent(star, lambda p: (math.sqrt(p / 100), 0.05 / math.sqrt(p)))
    assert numbers_of(star) == pytest.approx(other, rel=10 * SHARE)


def test_a_neutron_star_by_another_integration() -> None:
    """The star of Font et al. (2002), M = 1.400 and R = 9.586, with its tide and rotation."""
    star = g.star(SOFT, pressure=FONT)
    other = independent(star, lambda p: (math.sqrt(p / 100) + p, 1 + 0.5 / math.sqrt(100 * p)))
    assert star.mass == pytest.approx(1.400, abs=1e-3)
    assert star.radius == pytest.approx(9.586, abs=1e-3)
    assert numbers_of(star) == pytest.approx(other, rel=10 * SHARE)


def test_published_matter(sly: g.Family) -> None:
    """SLy: the numbers of the fit in table III of Read et al., Phys. Rev. D 79, 124032 (2009).

    The tabulated matter has M_max = 2.049 and R_1.4 = 11.736 km. The fit differs from
    these numbers by 0.02 % and -0.21 %.
    """
    heaviest, usual = sly.heaviest, sly.at_mass(1.4)
    # Constants of 2009 differ from ours by up to a thousandth.
    assert heaviest.mass == pytest.approx(2.049 * 1.0002, rel=1e-3)
    assert heaviest.errors["mass"] < 1e-8
    assert usual.mass == pytest.approx(1.4, rel=1e-9)
    assert usual.radius == pytest.approx(11.736 * (1 - 0.0021), rel=1e-3)
    # The moment of inertia follows from the deformability for all cold matter to 1 % (Yagi, Yunes,
    # Phys. Rev. D 88, 023009, table I).
    logarithm = math.log(usual.deformability)
    series = (1.47, 0.0817, 0.0149, 2.87e-4, -3.64e-5)
    expected = math.exp(sum(c * logarithm**k for k, c in enumerate(series)))
    unit = usual.matter.scale.mass
    assert usual.moment_of_inertia * unit / (usual.mass * unit) ** 3 == pytest.approx(
        expected, rel=0.01
    )


def test_the_maximum_is_one(sly: g.Family) -> None:
    """No star of other densities is heavier, and the density at the centre of it is published."""
    heaviest = sly.heaviest
    assert heaviest.mass > max(sly["mass"])
    for part in (0.99, 1.01):
        assert g.star("SLy", density=part * heaviest.density).mass < heaviest.mass
    assert heaviest.density == pytest.approx(2.86e15, rel=0.02)


@pytest.mark.parametrize("interpolation", few(1, ["monotone", "cubic"]))
def test_a_table_has_the_stars_of_its_matter(interpolation: str, tmp_path: Path) -> None:
    """Rows of a polytrope lead to the stars of the polytrope, from a file in other units also."""
    pressures = np.geomspace(1e-10, 1e-3, 80)
    rows = [(p, math.sqrt(p / 100) + p) for p in pressures]
    table = g.equation_of_state(rows, interpolation=interpolation)
    exact = g.star(SOFT, pressure=FONT)
    star = g.star(table, pressure=FONT)
    assert star.mass == pytest.approx(exact.mass, rel=1e-6)
    assert star.radius == pytest.approx(exact.radius, rel=1e-6)
    assert star.love_number == pytest.approx(exact.love_number, rel=1e-5)
    # The unit of length of a file in cgs is a kilometre.
    unit = g.equation_of_state("SLy").scale
    file = tmp_path / "soft.csv"
    lines = ["rho (g/cm^3), p (dyn/cm^2)"]
    lines += [f"{rho / unit.density:.17g}, {p / unit.pressure:.17g}" for p, rho in rows]
    file.write_text("# a polytrope\n" + "\n".join(lines) + "\n")
    read = g.equation_of_state(file, units="cgs", interpolation=interpolation)
    far = g.star(read, pressure=FONT / unit.pressure)
    assert far.radius == pytest.approx(star.radius, rel=1e-8)
    assert far.mass * unit.mass == pytest.approx(star.mass, rel=1e-8)
    assert far.matter.name == "soft"


def test_units_belong_to_the_numbers_only() -> None:
    """The same star of published matter in each unit; unknown units are refused."""
    usual = g.star("SLy", density=1e15)
    for units in ("si", "mev", "geometric"):
        matter = g.equation_of_state("SLy", units=units)
        density = 1e15 * usual.matter.scale.density / matter.scale.density
        star = g.star(matter, density=density)
        one, two = (x.mass * x.matter.scale.mass for x in (star, usual))
        assert one == pytest.approx(two, rel=1e-9)
    assert g.equation_of_state(g.equation_of_state("SLy"), units="si").units == "si"
    assert g.equation_of_state(SOFT) is SOFT
    for source in ("SLy", SOFT, [(1e-7, 1e-4)]):
        with pytest.raises(GeomtorsionError, match="units: expected .*geometric, si, cgs, mev"):
            g.equation_of_state(source, units=THREE)


def test_a_centre_where_pieces_meet() -> None:
    """Stars on both sides of a knot, and at it, differ as little as their centres."""
    matter = g.polytropes(100, [2, 3], [1e-3])
    eta = matter.knots[1]
    middle, _ = matter.values(eta)
    masses = [g.star(matter, pressure=middle * x).mass for x in (1 - 1e-7, 1, 1 + 1e-9, 1 + 1e-7)]
    for mass in masses:
        assert mass == pytest.approx(masses[0], rel=1e-6)


def test_equal_pieces_are_one_piece() -> None:
    """A polytrope that is cut into two pieces has the same stars."""
    whole, cut = g.polytropes(100, [2]), g.polytropes(100, [2, 2, 2], [1e-4, 6e-4])
    one, two = (g.star(x, pressure=FONT) for x in (whole, cut))
    for name in ("mass", "radius", "love_number", "moment_of_inertia"):
        bound = one.errors[name] + two.errors[name]
        assert abs(getattr(one, name) - getattr(two, name)) <= bound


def test_other_theories() -> None:
    """Field equations with such a fluid: the identity of T and R, and a square of T."""
    torsion = g.equations(PROPER, "-(T + c*T**2)/(16*pi)", g.fluid(p="SLy"))
    usual = g.star("SLy", density=1e15)
    same = g.star(torsion, density=1e15, parameters={"c": 0})
    assert abs(same.mass - usual.mass) <= same.errors["mass"] + usual.errors["mass"]
    assert abs(same.radius - usual.radius) <= same.errors["radius"] + usual.errors["radius"]
    with pytest.raises(GeomtorsionError, match="a star of general relativity"):
        _ = same.love_number
    other = g.star(torsion, density=1e15, parameters={"c": 10})
    assert 1e-3 < abs(other.mass / usual.mass - 1) < 0.1


@pytest.mark.parametrize(
    ("connection", "lagrangian"),
    [(gt.levi_civita(STATIC), "R/(16*pi)"), (PROPER, "-T/(16*pi)")],
    ids=["metric", "teleparallel"],
)
def test_general_relativity_from_its_field_equations(
    connection: gt.Connection, lagrangian: str
) -> None:
    """They have the tide and the rotation of the equation of state, to the bit."""
    theory = g.equations(connection, lagrangian, g.fluid(p=SOFT))
    assert g.star(theory, pressure=FONT).numbers == g.star(SOFT, pressure=FONT).numbers


@pytest.mark.slow
def test_an_exponential_of_torsion_needs_no_condition() -> None:
    """The argument of the function gets a name; for a small c the star is general relativity's."""
    theory = g.equations(PROPER, "-(exp(c*T) - 1)/(16*pi*c)", g.fluid(p=SOFT))
    star = g.star(theory, pressure=FONT, parameters={"c": "1e-4"})
    # c T is about a millionth.
    assert star.mass == pytest.approx(g.star(SOFT, pressure=FONT).mass, rel=1e-6)


@pytest.mark.slow
def test_the_shift_of_a_mass_by_an_exponential_of_torsion() -> None:
    """It is the one of T + T^2/2 up to terms of the third order."""
    lagrangians = "-T/(16*pi)", "-(T + T**2/2)/(16*pi)", "-(exp(T) - 1)/(16*pi)"
    plain, square, whole = (
        g.star(g.equations(PROPER, text, g.fluid(p=SOFT)), pressure=FONT).mass
        for text in lagrangians
    )
    # T is below a hundredth.
    assert whole - plain == pytest.approx(square - plain, rel=1e-2)
    assert abs(square - plain) > 1e-3


def test_a_function_without_a_power_series_names_the_condition() -> None:
    """The message has the line to type, with the invariant of this theory."""
    fluid = g.fluid("rho0", "p(r)", [1, 0, 0, 0])
    theory = g.equations(PROPER, "-(exp(c*T) - 1)/(16*pi*c)", fluid)
    with pytest.raises(GeomtorsionError, match=r"reduce\('r', conditions=\['S\(r\) = T'\]\)"):
        g.solve(theory, "r", 10, {"A": 1, "p": "1e-4"}, {"rho0": "1e-3", "c": 1}, near={"B": 1})


def test_what_a_family_offers(sly: g.Family, tmp_path: Path) -> None:
    """Columns, a file, plain data, and equal bits of equal calls."""
    assert list(sly["density"]) == sorted(sly["density"])
    sly.to_csv(tmp_path / "stars.csv")
    head = (tmp_path / "stars.csv").read_text().splitlines()[0]
    assert head.startswith("density,pressure,mass,radius")
    assert sly.to_json()["heaviest"]["mass"] == sly.heaviest.mass
    again = g.star("SLy", density=9e14)
    assert again.numbers == sly.stars[1].numbers
    light = g.family(SOFT, [1e-4, 2e-4])
    with pytest.raises(GeomtorsionError, match="Give other densities"):
        _ = light.heaviest
    assert "no heaviest star" in str(light)


def rows_of(*pairs: tuple[float, float]) -> list[tuple[float, float]]:
    return [(1e-7, 1e-4), (1e-6, 3e-4), *pairs]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (g.fluid, "expected a density and a pressure, or an equation of state"),
        (lambda: g.fluid("rho", 0, p="SLy"), "got both"),
        (lambda: g.star("SLY", density=1e15), "Did you mean SLy"),
        (lambda: g.star("SLy"), "got both or none"),
        (lambda: g.star(NOTHING, density=1), "expected an equation of state"),
        (lambda: g.star("SLy", density=-1), "expected a positive number"),
        (lambda: g.star("SLy", density="much"), "expected a positive number"),
        (lambda: g.star(g.incompressible(1), density=1), "Give the pressure"),
        (lambda: g.star(SOFT, pressure=1e300), "expected at most"),
        (lambda: g.polytropes(100, [1]), "no surface"),
        (lambda: g.polytropes(100, [2, 3]), "one between any two"),
        (lambda: g.polytropes(100, [2, 3, 4], [2, 1]), "increasing"),
        (lambda: g.polytropes(0, [2]), "constant: expected a positive number"),
        (lambda: g.equation_of_state(rows_of()), "three or more rows"),
        (lambda: g.equation_of_state(rows_of((1e-6, 4e-4))), r"rows\[2\]: expected a larger"),
        (lambda: g.equation_of_state(rows_of((1e-5, math.nan))), r"rows\[2\]"),
        (lambda: g.equation_of_state([(0, 1), (1, 2), (2, 3)]), "positive numbers"),
        (lambda: g.equation_of_state(rows_of((1e-5, 1e-3)), units="feet"), "geometric, si, cgs"),
        (lambda: g.equation_of_state(rows_of((1e-5, 1e-3)), interpolation="best"), "monotone"),
        (lambda: g.equation_of_state("nowhere.csv"), "cannot be read"),
        (lambda: g.family(SOFT, []), "one or more"),
        (lambda: g.family(SOFT, [1e-3], pressures=[1e-4]), "got both"),
        (lambda: g.family(SOFT, [1e-3, 2e-3]).at_mass(5), "expected a mass from"),
        (lambda: g.star(g.equations(gt.levi_civita(STATIC), "R"), pressure=1), "one fluid"),
        (lambda: g.solve(OWN, "r", 10, {"A": 1, "eta": 1}), "to gravity.star"),
    ],
)
def test_refusals(call: Callable[[], object], words: str) -> None:
    """Each error names the expected value and a remedy."""
    with pytest.raises(GeomtorsionError, match=words):
        call()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "three or more rows"),
        ("1e-7,1e-4\n1e-6,x\n", "line 2: expected finite numbers"),
        ("1e-7,1e-4\n1e-6\n", "line 2: expected a pressure and a density"),
        ("a,b\n1,2\n", "line 1: expected a column named p or pressure"),
        ("p,rho\n1e-6,1e-4\n1e-7,1e-5\n1e-5,1e-3\n", "line 3: expected a larger pressure"),
    ],
)
def test_files_that_hold_no_table(text: str, words: str, tmp_path: Path) -> None:
    """The message names the file and the line."""
    file = tmp_path / "matter.csv"
    file.write_text(text)
    with pytest.raises(FileFormatError, match=words):
        g.equation_of_state(file)

"""gravity --solve: a theory in a file, solved, drawn, written and proved; refusals."""

import json
from pathlib import Path

import pytest

from geomtorsion import gravity as g
from geomtorsion.errors import FileFormatError
from geomtorsion.ode import SavedSolution
from tests.cli.running import run

ANSATZ = """
coordinates = ["t", "x", "y", "z"]
coframe = [[1, 0, 0, 0], [0, "a(t)", 0, 0], [0, 0, "a(t)", 0], [0, 0, 0, "a(t)"]]
signature = [-1, 1, 1, 1]
functions = {a = ["t"]}
"""
DUST = """
[theory]
lagrangian = "R/2"
connection = "levi-civita"
fluid = {density = "rho(t)", pressure = 0}
start = {a = 1, rho = 3}
near = {a_1 = 1}
outputs = {H = "a_1/a"}
"""
STAR = """
coordinates = ["t", "r", "theta", "phi"]
coframe = [["A(r)", 0, 0, 0], [0, "B(r)", 0, 0], [0, 0, "r", 0], [0, 0, 0, "r*sin(theta)"]]
signature = [-1, 1, 1, 1]
functions = {A = ["r"], B = ["r"]}

[theory]
lagrangian = "R/2"
connection = "levi-civita"
fluid = {density = 1, pressure = "p(r)"}
start = {A = 1, p = 0.1}
near = {B = 1}
end = "p"
"""


def written(folder: Path, text: str) -> str:
    """A file with some text."""
    file = folder / "model.toml"
    file.write_text(text, encoding="utf-8")
    return str(file)


def test_a_universe_is_solved_and_written(tmp_path: Path) -> None:
    """The equations, a table, the error, the drift and a proof; the solution as a file."""
    source, folder = written(tmp_path, ANSATZ + DUST), tmp_path / "universe"
    text = run("gravity", source, "--solve", "t=10", "--proved", "-o", str(folder)).stdout
    assert "a_1' = -a_1**2/(2*a)" in text
    assert "0 = a**2*rho - 3*a_1**2" in text
    # (1 + 3 t/2)^(2/3)
    assert "6.349604" in text
    assert "drift: constraint" in text
    assert "proved at t = 10" in text
    saved = SavedSolution.load(folder / "solution.npz")
    assert float(saved.at(10.0)["H"]) == pytest.approx(1 / 16)


def test_a_star_ends_at_its_surface(tmp_path: Path) -> None:
    """JSON holds the equations and all columns, radius included."""
    made = run("gravity", written(tmp_path, STAR), "--solve", "r=5", "--format", "json")
    data = json.loads(made.stdout)
    assert data["outcome"] == "stopped"
    assert data["constraints"] == []
    assert data["solution"]["r"][-1] == pytest.approx(12 / 13)
    assert data["error"] < 1e-10
    assert set(data["rates"]) == {"A", "B", "p"}


def test_terms_that_an_accuracy_calls_for(tmp_path: Path) -> None:
    """The table of terms and fluids, its file and its figure."""
    model = DUST.replace('"R/2"', '"R/2 - Lambda"') + "parameters = {Lambda = 1e-6}\n"
    source, folder = written(tmp_path, ANSATZ + model), tmp_path / "universe"
    asked = ("gravity", source, "--solve", "t=1", "--called-for")
    text = run(*asked, "1e-3", "-o", str(folder)).stdout
    assert "accuracy 0.001 of a calls for 2 of 3 effects" in text
    assert "omitted  -Lambda" in text
    data = json.loads((folder / "effects.json").read_text("utf-8"))
    assert data["omitted"] == ["-Lambda"]
    assert (folder / "effects.png").exists()
    made = run(*asked, "1e-9", "--watch", "a,rho", "--format", "json").stdout
    data = json.loads(made)["called_for"]
    assert data["watch"] == ["a", "rho"]
    assert data["omitted"] == []


def test_the_equations_of_a_file(tmp_path: Path) -> None:
    """Without --solve the command shows the field equations of the theory in the file."""
    text = run("gravity", written(tmp_path, ANSATZ + DUST)).stdout
    assert "E_1^1" in text
    assert "ρ(t)" in text
    other = run("gravity", written(tmp_path, ANSATZ + DUST), "-L", "T").stdout
    assert "ρ(t)" not in other


def test_a_scalar_field_and_a_charge(tmp_path: Path) -> None:
    """Fields of a file enter the Lagrangian by their names."""
    inflation = '[theory]\nlagrangian = "-T/2 - X/2 - phi^2"\nscalar = "phi(t)"\n'
    model = g.read_model(written(tmp_path, ANSATZ + inflation))
    assert model.reduce("t").states == ("phi", "phi_1", "a", "a_1")
    charge = STAR.split("[theory]")[0]
    charge += '[theory]\nlagrangian = "R/2 - F2/4"\nconnection = "levi-civita"\n'
    charge += 'potential = ["u(r)", 0, 0, 0]\n'
    assert g.read_model(written(tmp_path, charge)).reduce("r").states == ("A", "B", "u", "u_1")


def test_values_at_the_end(tmp_path: Path) -> None:
    """A file demands values at the end; the command shows the numbers that lead to them."""
    demands = 'free = ["rho"]\nboundary = {a = 2}\n'
    file = written(tmp_path, ANSATZ + DUST + demands)
    made = run("gravity", file, "--solve", "t=1")
    assert "rho = 4.4575276667" in made.stdout
    assert "a = 2: missed by" in made.stdout
    document = json.loads(run("gravity", file, "--solve", "t=1", "--format", "json").stdout)
    exact = 4 * (2**1.5 - 1) ** 2 / 3
    answer = document["free"]["rho"]
    assert abs(answer["value"] - exact) < answer["error"] < 1e-8
    assert abs(document["boundary"]["a = 2"]["miss"]) < 1e-9


FAULTS = {
    "no table": (ANSATZ, "expected a table [theory]"),
    "no Lagrangian": (ANSATZ + "[theory]\n", "expected a lagrangian"),
    "unknown key": (ANSATZ + DUST + "strat = {}\n", "Did you mean start"),
    "no text": (ANSATZ + "[theory]\nlagrangian = 3\n", "expected text in quotes"),
    "no table of numbers": (
        ANSATZ + '[theory]\nlagrangian = "R"\nstart = 1\n',
        "start: expected a table",
    ),
    "no list": (ANSATZ + '[theory]\nlagrangian = "R"\nconditions = 1\n', "expected a list"),
    "no list of numbers": (
        ANSATZ + '[theory]\nlagrangian = "R"\nfree = "a"\n',
        "free: expected a list",
    ),
    "half a fluid": (
        ANSATZ + '[theory]\nlagrangian = "R"\nfluid = {density = 1}\n',
        "expected density and pressure",
    ),
    "unknown connection": (
        ANSATZ + '[theory]\nlagrangian = "R"\nconnection = "weyl"\n',
        "connection",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_files_are_refused(name: str, tmp_path: Path) -> None:
    """Each fault of a file is named."""
    text, words = FAULTS[name]
    with pytest.raises(FileFormatError) as refusal:
        g.read_model(written(tmp_path, text))
    assert words in str(refusal.value)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("frw", "--solve", "t=3"), "expected a tetrad file with a table [theory]"),
        (("frw", "--solve", "t"), "expected a coordinate and its last value"),
        (("frw", "--solve", "t=soon"), "--solve: expected a number"),
        (("frw", "--called-for", "1e-3"), "expected a solution whose terms can be omitted"),
        (("frw", "--watch", "a"), "Add --solve t=10"),
    ],
)
def test_requests_are_refused(arguments: tuple[str, ...], words: str) -> None:
    """A solution needs a theory, a coordinate and a number."""
    made = run("gravity", *arguments, code=2)
    assert words in made.stderr

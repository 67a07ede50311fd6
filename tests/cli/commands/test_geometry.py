"""geometry: one set of components in five formats, each read back or run."""

import json
import math
import re
from pathlib import Path

import numpy
import pytest
import sympy

from geomtorsion.cli.formats import text_of
from geomtorsion.exact import parse_expression
from geomtorsion.geometry.quantities import QUANTITIES
from geomtorsion.pictures.quantities import chosen_quantities
from geomtorsion.spaces import load
from tests.cli.running import run

SPACES = ("so3", "schwarzschild", "frw", "kerr_kinnersley", "s2")


def shown(*arguments: str) -> str:
    """Standard output of the command, which must end with code 0."""
    return run("geometry", *arguments).stdout


def test_text_shows_only_what_does_not_vanish():
    """Labels have coordinate names, equals signs are aligned, a zero tensor takes one line."""
    text = shown("so3", "--only", "cartan_connection,torsion_vector,scalar_curvature")
    lines = text.splitlines()
    assert "  Γ_{φ1 φ3}^{φ2} = sin(φ2)" in lines
    assert "Torsion vector  v_a = 0" in lines
    assert "Scalar curvature  R̄ = 3/2" in lines
    components = [line for line in lines if line.startswith("  Γ")]
    assert len(components) == 5
    assert len({line.index("=") for line in components}) == 1


def test_text_omits_components_that_symmetry_repeats():
    """Only independent components are printed; --every prints the others also."""
    short, long = shown("so3", "--only", "torsion"), shown("so3", "--only", "torsion", "--every")
    assert short.count("\n  S_") == 5
    assert "(5 more follow by symmetry)" in short
    assert long.count("\n  S_") == 10
    assert "symmetry" not in long


def test_text_in_the_frame():
    """In the frame, indices are numbers of legs, counted from 1 as in the paper."""
    text = shown("so3", "--only", "torsion", "--basis", "frame")
    assert "S_{12}^3 = -1/2" in text
    assert "counted from 1; in JSON and Python indices count from 0" in " ".join(
        shown("--help").split()
    )


def test_everything_is_the_default():
    """Without --only the quantities of a report are printed in reading order."""
    text = shown("s2")
    titles = ["Coframe", "Metric", "Torsion", "Contortion", "Riemann tensor", "Kretschmann scalar"]
    places = [text.index(f"\n{title}  ") for title in titles]
    assert places == sorted(places)


def test_no_quantity_is_not_every_quantity():
    """A list that contains only commas is refused."""
    assert "expected at least one name" in run("geometry", "s2", "--only", ",", code=2).stderr


def test_roots_are_stated():
    """The heading states the branch of each root that was read."""
    assert "read as" in shown("schwarzschild", "--only", "determinant")


def test_names_of_a_file(tmp_path):
    """Text and LaTeX use the names of the file and define them; Python and JSON do not."""
    file = tmp_path / "disc.toml"
    file.write_text(
        'coordinates = ["r", "phi"]\ncoframe = [[1, 0], [0, "r*(1 + r**2)"]]\n'
        '[names]\nSigma = "1 + r**2"\n',
        "utf-8",
    )
    text = shown(str(file), "--only", "metric,determinant")
    assert "\nΣ = r^2 + 1\n" in text
    assert "  g_{φφ} = Σ^2*r^2" in text
    assert "e = Σ*r" in text
    latex = shown(str(file), "--only", "metric", "--format", "latex")
    assert "% Sigma = r**2 + 1\n" in latex
    assert r"\Sigma^{2} r^{2}" in latex
    assert "Sigma" not in shown(str(file), "--only", "metric", "--format", "python")
    assert "Sigma" not in shown(str(file), "--only", "metric", "--format", "json")


def test_a_terminal_without_greek():
    """Greek letters are spelled out, and the text is ASCII."""
    space = load("kerr")
    text = text_of(space, chosen_quantities(space), greek=False)
    assert text.isascii()
    assert "Gamma_bar_{tr}^t" in text
    assert "theta" in text


def test_latex_is_balanced():
    """Environments and braces are balanced, and index positions are separate."""
    text = shown("so3", "--format", "latex")
    assert text.count(r"\begin{align*}") == text.count(r"\end{align*}") > 15
    assert text.count("{") == text.count("}")
    assert r"\Gamma_{\phi_{1} \phi_{3}}{}^{\phi_{2}} &= \sin{\left(\phi_{2} \right)}" in text
    assert r"v_{a} &= 0" in text


@pytest.mark.parametrize("name", SPACES)
def test_json_holds_the_components(name):
    """Each component in the JSON equals the computed one when it is read back."""
    data = json.loads(shown(name, "--format", "json"))
    frame = load(name).frame
    symbols = {symbol.name: symbol for symbol in (*frame.coordinates, *frame.parameters)}
    compared = 0
    for quantity in ("coframe", "torsion", "christoffel", "riemann", "kretschmann"):
        tensor = frame.quantity(quantity)
        written = data["quantities"][quantity]
        assert written["slots"] == tensor.slots
        indices = {tuple(map(int, key.split(","))) if key else () for key in written["components"]}
        assert indices == set(tensor.components.nonzero)
        for key, text in written["components"].items():
            index = tuple(map(int, key.split(","))) if key else ()
            value = frame.field.read(parse_expression(text, symbols))
            assert (value - tensor.element(*index)).is_zero
            compared += 1
    assert compared > 10
    assert data["coordinates"] == [symbol.name for symbol in frame.coordinates]


def test_standard_output_has_only_json():
    """Standard output is exactly one JSON document."""
    assert json.loads(shown("so3", "--format", "json", "--only", "ricci"))["name"] == "so3"


@pytest.mark.parametrize("name", SPACES)
def test_python_runs_and_agrees(name):
    """The emitted NumPy code gives the exact values at a point, and it broadcasts."""
    only = "metric,torsion,riemann,kretschmann"
    module: dict = {}
    exec(compile(shown(name, "--format", "python", "--only", only), name, "exec"), module)
    frame = load(name).frame
    values = {"r": 5.0, "M": 1.0, "a": 0.5, "theta": 0.7, "k": 0.01}
    names = [symbol.name for symbol in (*frame.coordinates, *frame.parameters)]
    point = [values.get(symbol, 0.3 + 0.2 * k) for k, symbol in enumerate(names)]
    unknown = {"a": 2.0, "a_t": 0.3, "a_t_t": -0.4} if name == "frw" else {}
    at = dict(zip([*frame.coordinates, *frame.parameters], point, strict=True))
    for quantity in only.split(","):
        tensor, function = frame.quantity(quantity), module[quantity]
        wanted = function.__code__.co_varnames[len(names) : function.__code__.co_argcount]
        result = function(*point, **{key: unknown[key] for key in wanted})
        assert result.shape == (frame.dimension,) * len(tensor.slots)
        checked = 0
        for index in numpy.ndindex(*result.shape):
            expected = complex(_number(tensor[index], at, unknown))
            assert abs(result[index] - expected) <= 1e-12 * max(1, abs(expected))
            checked += 1
        assert checked == frame.dimension ** len(tensor.slots)
        many = [numpy.full((4, 1), point[0]), numpy.full(3, point[1]), *point[2:]]
        several = function(*many, **{key: unknown[key] for key in wanted})
        assert several.shape == (4, 3, *result.shape)
        assert numpy.allclose(several[3, 2], result)


def _number(expression, at, unknown):
    """A sympy expression at a point, evaluated by sympy."""
    t = next(iter(at))
    a = sympy.Function("a")(t)
    jets = {a.diff(t, 2): "a_t_t", a.diff(t): "a_t", a: "a"}
    for jet, name in jets.items():
        if unknown:
            expression = expression.subs(jet, unknown[name])
    return sympy.N(expression.subs(at))


def test_python_keywords_become_arguments(tmp_path):
    """Coordinates called lambda and result become arguments of the emitted functions."""
    file = tmp_path / "words.toml"
    file.write_text(
        'coordinates = ["lambda", "result", "x0"]\n'
        'coframe = [["x0", 0, 0], [0, "lambda", 0], [0, 0, "result + sin(x0)"]]\n'
    )
    module: dict = {}
    exec(shown(str(file), "--format", "python", "--only", "metric,determinant"), module)
    assert module["determinant"](2.0, 3.0, 5.0) == pytest.approx(5 * 2 * (3 + math.sin(5)))
    assert module["metric"](2.0, 3.0, 5.0)[1, 1] == 4


def test_mathematica_looks_right(tmp_path):
    """Indices start at 1, functions have capitals and brackets, reserved names are renamed."""
    text = shown("schwarzschild", "--format", "mathematica", "--only", "christoffel,kretschmann")
    assert "kretschmann = 48*M^2/r^6;" in text.replace(".", "")
    assert "{1, 2, 1} -> " in text
    assert "Sin[theta]" in text
    assert text.count("[") == text.count("]")
    assert text.count("{") == text.count("}")
    file = tmp_path / "names.toml"
    file.write_text(
        'coordinates = ["t", "x_1"]\nparameters = ["E"]\nfunctions = {f = ["x_1"]}\n'
        'coframe = [["E*f", 0], [0, 1]]\n'
    )
    text = shown(str(file), "--format", "mathematica", "--only", "torsion,metric")
    assert "D[f[x1], {x1, 1}]" in text
    assert "Esymbol^2" in text
    # A comment has the names of the file.
    assert "(* for E > 0, f(x_1) > 0, assumed;" in text
    assert not re.search(r"x_1|\bE\b", re.sub(r"\(\*.*?\*\)", "", text))


def test_names_that_are_different_stay_so_in_mathematica(tmp_path):
    """`a_b` and `ab` remain different names; `N` and `p_q` do not become Mathematica syntax."""
    file = tmp_path / "names.toml"
    file.write_text(
        'coordinates = ["x", "y"]\nparameters = {a_b = "positive", ab = "positive"}\n'
        'functions = {N = ["x"], p_q = ["x"]}\nmetric = [["a_b*N(x)", 0], [0, "ab*p_q(x)"]]\n'
    )
    text = shown(str(file), "--format", "mathematica", "--only", "metric")
    assert "{1, 1} -> absymbol*Nsymbol[x]" in text
    assert "{2, 2} -> ab*pq[x]" in text


def test_slopes_elsewhere_are_arguments_and_rules(tmp_path):
    """The slope of f at 2*x is one argument in Python and a replacement rule in Mathematica."""
    file = tmp_path / "elsewhere.toml"
    file.write_text(
        'coordinates = ["x", "y"]\nfunctions = {f = ["x"]}\nmetric = [["f(2*x)**2", 0], [0, 1]]\n'
    )
    only = ("--only", "christoffel")
    module: dict = {}
    exec(shown(str(file), "--format", "python", *only), module)
    # With f(x) = x^3 at x = 3: Gamma = 2 f'(6)/f(6) = 6/6.
    assert module["christoffel"](3.0, 0.0, 6.0**3, 3 * 6.0**2)[0, 0, 0] == 1.0
    text = shown(str(file), "--format", "mathematica", *only)
    assert "(D[f[xi1], {xi1, 1}] /. {xi1 -> 2*x})" in text


def test_names_that_the_written_function_needs_itself(tmp_path):
    """Parameters called `shape` and `float` do not clash with names in the emitted function."""
    file = tmp_path / "own.toml"
    file.write_text(
        'coordinates = ["x", "y"]\nparameters = {shape = "positive", float = "positive"}\n'
        'metric = [["shape", 0], [0, "float"]]\n'
    )
    module: dict = {}
    exec(shown(str(file), "--format", "python", "--only", "metric"), module)
    assert module["metric"](1, 1, 2, 3).tolist() == [[2, 0], [0, 3]]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["so3", "--only", "rici"], "Did you mean ricci"),
        (["so3", "--only", "connection_torsion"], "which only has the connections of its frame"),
        (["so4"], "the name of a shipped space, got 'so4'"),
        (["nowhere.toml"], "No such file"),
        (["so3", "--format", "html"], "html"),
        (["so3", "--basis", "banana"], "banana"),
    ],
)
def test_mistakes_end_with_2_and_one_message(arguments, message):
    """A mistake ends with code 2 and a message on standard error, without a traceback."""
    result = run("geometry", *arguments, code=2)
    assert message in result.stderr
    assert "Traceback" not in result.output
    assert not result.stdout


def test_every_quantity_can_be_named():
    """The command shows each quantity of the table by its name, under its title."""
    names = ",".join(QUANTITIES)
    text = run("geometry", "axial_torsion", "--only", names).stdout
    assert [row.title for row in QUANTITIES.values() if f"\n{row.title}  " not in text] == []
    assert "\nCotton tensor  C_{abc} = 0" in text


def test_the_assumed_region_is_printed(tmp_path: Path) -> None:
    """A file without a domain shows the region that was assumed, and how to declare another."""
    file = tmp_path / "line.toml"
    rows = 'coordinates = ["t", "r"]\ncoframe = [["sqrt(1-r)", 0], [0, "1/sqrt(1-r)"]]\n'
    file.write_text(rows, "utf-8")
    assert "\nregion r < 1, assumed; add domain = [...]" in shown(str(file), "--only", "torsion")
    file.write_text(f'{rows}domain = ["r < 1"]\n', "utf-8")
    assert "assumed" not in shown(str(file), "--only", "torsion")

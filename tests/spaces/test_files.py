"""Tetrad files: contents become a space; each mistake is named, with the remedy."""

import copy
from pathlib import Path

import pytest
import sympy

from geomtorsion.errors import (
    CoframeError,
    ExpressionError,
    FileFormatError,
    GeomtorsionError,
    LimitError,
    StructureConstantError,
)
from geomtorsion.spaces import load, names, read_file

DATA = Path(__file__).parent.parent / "data"
PLANE = 'coordinates = ["r", "phi"]\n'
COFRAME = 'coframe = [[1, 0], [0, "r"]]\n'


@pytest.fixture
def read(tmp_path):
    """Read a space from the text of a file called own.toml."""

    def reader(text: str):
        file = tmp_path / "own.toml"
        file.write_text(text, "utf-8")
        return read_file(file)

    return reader


def components(space, name):
    """Nonzero components of a quantity by index, as text, so that symbols compare by name.

    Factored, because two fields with different roots may write -(r - 2*M) and 2*M - r.
    """
    tensor = space.frame.quantity(name)
    return {index: str(sympy.factor(value)) for index, value in tensor.nonzero().items()}


def test_a_coframe():
    """Rows are one-forms; name, story and parameter are read."""
    space = read_file(DATA / "rindler.toml")
    assert (space.name, space.source) == ("rindler", "rindler.toml")
    assert "rocket" in space.story
    assert [symbol.name for symbol in space.frame.parameters] == ["g"]
    assert space.frame.parameters[0].is_positive
    t, x = space.frame.coordinates
    assert t.is_real
    assert x.is_real
    [g] = space.frame.parameters
    assert space.frame.metric[0, 0] == -sympy.exp(2 * g * x)
    assert space.frame.quantity("torsion")[1, 0, 0] == g / 2
    assert space.frame.quantity("riemann").is_zero


def test_a_metric_agrees_with_the_shipped_space():
    """From its metric, Schwarzschild's curvature equals the curvature of the shipped tetrad."""
    own, shipped = read_file(DATA / "schwarzschild.toml"), load("schwarzschild")
    assert own.name == "hole"
    for name in ("riemann", "kretschmann", "christoffel"):
        assert components(own, name) == components(shipped, name)
        assert components(own, name)
    assert own.frame.quantity("ricci").is_zero
    assert len(own.frame.domain) == 3


def test_an_unknown_function_and_a_sparse_coframe():
    """With a = ["t"] declared, a and a(t) are the same; the name defaults to the file's."""
    own, shipped = read_file(DATA / "universe.toml"), load("frw_flat")
    assert own.name == "universe"
    assert components(own, "einstein") == components(shipped, "einstein")
    assert components(own, "einstein")


def test_legs_are_in_columns():
    """frame = legs[mu][i]: its inverse is the coframe."""
    frame = read_file(DATA / "legs.toml").frame
    assert str(frame.coframe[1, 1]) == "r"
    assert str(frame.legs[1, 1]) == "1/r"


def test_structure_constants_are_completed():
    """One order of the first two indices is enough; coordinates are generated."""
    frame = read_file(DATA / "nil.toml").frame
    assert frame.dimension == 3
    assert frame.anholonomy.nonzero() == {(0, 1, 2): -1, (1, 0, 2): 1}


def test_structure_constants_as_nested_lists(read):
    """Nested lists are taken as given, with both orders."""
    text = "structure_constants = [[[0, 0], [0, 1]], [[0, -1], [0, 0]]]"
    assert read(text).frame.anholonomy.nonzero() == {(0, 1, 1): -1, (1, 0, 1): 1}
    with pytest.raises(StructureConstantError):
        read("structure_constants = [[[0, 0], [0, 1]], [[0, 1], [0, 0]]]")


def test_a_null_tetrad():
    """complex = true and a matrix for the signature: flat space has the metric of Minkowski."""
    frame = read_file(DATA / "null.toml").frame
    diagonal = {(k, k): -1 if k == 0 else 1 for k in range(4)}
    assert frame.metric.nonzero() == diagonal


def test_a_contortion_of_its_own():
    """The connection has the contortion of the file: totally antisymmetric, so S = K."""
    connection = read_file(DATA / "twisted.toml").connection
    assert connection is not None
    k = connection.frame.parameters[0]
    assert connection.contortion[0, 1, 2] == k
    assert connection.torsion.S[0, 1, 2] == k
    assert connection.metric_compatible


def test_a_spin_connection_and_coefficients(read):
    """A vanishing spin connection is Cartan's; coefficients may have nonmetricity."""
    flat = read(PLANE + COFRAME + 'spin_connection = {"0,0,0" = 0}').connection
    assert flat is not None
    assert str(flat[0, 1, 1]) == "1/r"
    bent = read(PLANE + COFRAME + 'connection = {"0,0,1" = "r"}').connection
    assert bent is not None
    assert str(bent[0, 0, 1]) == "r"
    assert bent.metric_compatible is False


@pytest.mark.parametrize(
    ("given", "check"),
    [
        ("positive", "is_positive"),
        ("negative", "is_negative"),
        ("real nonzero", "is_nonzero"),
        ("integer", "is_integer"),
    ],
)
def test_assumptions_reach_the_symbols(read, given, check):
    """Assumptions of a file become assumptions of sympy's symbols."""
    text = PLANE + f'parameters = {{b = "{given}"}}\ncoframe = [[1, 0], [0, "b*r"]]'
    [b] = read(text).frame.parameters
    assert getattr(b, check)
    assert b.is_real


def test_assumptions_may_be_a_list(read):
    """A list of words means the same as the words in one text."""
    text = PLANE + 'parameters = {b = ["real", "nonzero"]}\ncoframe = [[1, 0], [0, "b*r"]]'
    [b] = read(text).frame.parameters
    assert b.is_nonzero


def test_names_of_quantities(read):
    """Names may contain parameters, functions and names above them; the frame keeps them."""
    text = PLANE + (
        'parameters = ["b"]\nfunctions = {f = ["r"]}\n'
        'coframe = [["f(r)**2 + b", 0], [0, "r*(f(r)**2 + b) + b"]]\n'
        '[names]\nF = "f(r)**2 + b"\nG = "r*F + b"\n'
    )
    frame = read(text).frame
    assert [str(name) for name in frame.names] == ["F", "G"]
    assert str(frame.metric).splitlines()[1:] == ["  g[0, 0] = F**2", "  g[1, 1] = G**2"]
    assert str(frame.metric[0, 0]) == "(b + f(r)**2)**2"
    assert list(copy.deepcopy(frame).names) == list(frame.names)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected exactly one of coframe, frame, metric, structure_constants, got none"),
        (PLANE, "got none"),
        (COFRAME, "coordinates are missing"),
        (PLANE + COFRAME + "metric = [[1, 0], [0, 1]]", "got coframe and metric"),
        (PLANE + COFRAME + "cofrane = 1", "a known key, got 'cofrane'. Did you mean coframe"),
        (PLANE + COFRAME + "banana = 1", "a known key, got 'banana'. There are name, title"),
        (PLANE + "coframe = [[1, 0]", "expected TOML, got an error"),
        (PLANE + "coframe = [[1, r], [0, 1]]", r"line 2, column 16.*\n.*coframe = .*\n +\^"),
        (PLANE + "[parameters]\nM = 'real'\n" + COFRAME, "coframe is below .parameters."),
        (PLANE + "coframe = 3", "expected a list of rows, got 3"),
        (PLANE + "coframe = [1, 2]", r"coframe\[0\]: expected a list of 2 entries"),
        (PLANE + "coframe = [[1, 0], [0]]", r"coframe\[1\]: expected a list of 2 entries.* got 1"),
        (
            PLANE + "coframe = [[1, 0], [0, 1], [1, 1]]",
            "coframe: expected a list of 2 entries.* got 3",
        ),
        (PLANE + "coframe = [[1, 0], [0, true]]", r"coframe\[1, 1\]: .* got true or false"),
        (PLANE + "coframe = [[1, 0], [0, 1979-05-27]]", r"coframe\[1, 1\]: .* got 1979-05-27"),
        (PLANE + "coframe = [[1, 0], [0, []]]", r"coframe\[1, 1\]: .* got a list"),
        (
            PLANE + 'coframe = {"0,0" = 1, "1,2" = "r"}',
            '"1,2" is not an index here; expected 2 numbers from 0',
        ),
        (PLANE + 'coframe = {"0,0" = 1, "1;1" = "r"}', '"1;1" is not an index'),
        (PLANE + 'coframe = {"0,0" = 1, "0, 0" = 2, "1,1" = 1}', "expected each index once, got"),
        (PLANE + COFRAME + "signature = [1, 2]", "a list of signs 1 and -1"),
        (PLANE + COFRAME + 'signature = "+-"', "a list of signs 1 and -1"),
        (PLANE + COFRAME + "complex = 1", "complex: expected true or false"),
        (PLANE + COFRAME + "name = 3", "name: expected text in quotes, got 3"),
        (PLANE + COFRAME + "title = 3.5", "title: expected text in quotes"),
        ("coordinates = 3\n" + COFRAME, "coordinates: expected a list of strings"),
        ('coordinates = ["r", 3]\n' + COFRAME, "coordinates: expected a list of strings"),
        ('coordinates = ["r", "2x"]\n' + COFRAME, "expected a name, got '2x'"),
        (PLANE + "parameters = 3\n" + COFRAME, "parameters: expected a table"),
        (PLANE + 'parameters = {M = "postive"}\n' + COFRAME, "Did you mean positive"),
        (PLANE + 'parameters = {r = "real"}\n' + COFRAME, "r: expected one declaration .*, got 2"),
        (
            PLANE + 'functions = {a = ["t"]}\n' + COFRAME,
            "expected a coordinate .*, got 't'",
        ),
        (
            PLANE + 'functions = {phi = ["r"]}\n' + COFRAME,
            "phi: expected one declaration .*, got 2",
        ),
        (PLANE + COFRAME + 'names = "F"', "names: expected a table, got 'F'"),
        (PLANE + COFRAME + 'names = {r = "phi"}', "names: r: expected a new name"),
        (PLANE + COFRAME + 'names = {"2F" = "r"}', "names: 2F: expected a new name"),
        (
            PLANE + COFRAME + "names = {F = [1]}",
            "names: F: expected an integer or an expression in quotes",
        ),
        (PLANE + COFRAME + 'names = {F = "r - r"}', "names: F = 0: expected a short expression"),
        (PLANE + '[names]\nF = "r**2"\n' + COFRAME, "coframe is below .names."),
        (PLANE + COFRAME + 'domain = ["r"]', "expected a comparison, got 'r'"),
        (PLANE + COFRAME + 'domain = "r"', "expected a comparison, got 'r'"),
        (PLANE + COFRAME + "domain = 3", "domain: expected a list of strings"),
        (
            PLANE + COFRAME + "contortion = {}\nconnection = {}",
            "expected at most one of spin_connection, contortion, connection",
        ),
        ('structure_constants = {"0,1,1" = 1}\ncomplex = true', "expected no such key with"),
    ],
)
def test_mistakes_in_the_form(read, text, message):
    """Each mistake is named with the key, the expected input and the given one."""
    with pytest.raises(FileFormatError, match=f"(?s)^own.toml: .*{message}"):
        read(text)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ('"q*r"', r"own.toml: coframe\[1, 1\]: q is neither a coordinate nor a declared param"),
        ('"Phi*r"', "Did you mean phi"),
        ("1.5", "1.5 is a decimal number.*\n.*\n.*\nWrite 3/2"),
        ('"f(r)"', "f is not a function that is known here"),
        ("\"__import__('os').getcwd()\"", "expressions are not code"),
        ('"r.real"', "expressions have no attributes"),
        ('"[r for r in phi]"', "square brackets"),
        ('"sign(r)"', "sign is not smooth"),
        ('"1/0"', "division by zero"),
        ('"r +"', "missing after"),
        ('"I*r"', "complex"),
    ],
)
def test_mistakes_in_an_expression(read, entry, message):
    """Each mistake is named with its entry; nothing is run."""
    with pytest.raises(ExpressionError, match=f"(?s){message}"):
        read(PLANE + f"coframe = [[1, 0], [0, {entry}]]")


def test_a_singular_coframe(read):
    """The error of the frame itself is raised."""
    with pytest.raises(CoframeError, match="determinant"):
        read(PLANE + 'coframe = [["r", 1], ["r^2", "r"]]')


def test_files_that_cannot_be_read(tmp_path):
    """A missing file, a directory and a binary file are refused."""
    with pytest.raises(FileFormatError, match="cannot be read: No such file"):
        read_file(tmp_path / "missing.toml")
    with pytest.raises(FileFormatError, match="cannot be read"):
        read_file(tmp_path)
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xff\x00")
    with pytest.raises(FileFormatError, match="expected UTF-8 text"):
        read_file(binary)


def test_files_that_are_too_large(tmp_path, read):
    """Size, nesting and length of numbers have limits, and none ends in a RecursionError."""
    large = tmp_path / "large.toml"
    large.write_text("#" * 10_000_001)
    with pytest.raises(LimitError, match="longer than the limit of 10,000,000 bytes"):
        read_file(large)
    with pytest.raises(GeomtorsionError):
        read(PLANE + "coframe = " + "[" * 5000 + "]" * 5000)
    with pytest.raises(GeomtorsionError):
        read(PLANE + f"coframe = [[1, 0], [0, {'9' * 5000}]]")
    with pytest.raises(LimitError, match=r"coframe\[1, 1\]: the exponent is 387420489"):
        read(PLANE + 'coframe = [[1, 0], [0, "9**9**9"]]')


@pytest.mark.parametrize("name", names())
def test_a_written_frame_is_read_again(name, tmp_path):
    """`Frame.to_toml` writes a file from which the same frame is read."""
    frame = load(name).frame
    file = tmp_path / "again.toml"
    file.write_text(frame.to_toml(), "utf-8")
    again = read_file(file).frame
    assert str(again.coframe.tolist()) == str(frame.coframe.tolist())
    assert str(again.eta) == str(frame.eta)
    assert again.to_toml() == frame.to_toml()
    assert list(map(str, again.domain)) == list(map(str, frame.domain))

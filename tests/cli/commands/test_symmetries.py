"""symmetries: algebra and holonomy in one line."""

import json

from tests.cli.running import run


def test_symmetries_of_schwarzschild() -> None:
    """Number, algebra and vectors of the symmetries, and the holonomy."""
    text = run("symmetries", "schwarzschild").stdout
    assert text.startswith("schwarzschild: 4 symmetries of the metric, orbits of dimension 3\n")
    assert "\nalgebra: so(3) + R\n" in text
    assert "\nderived series: 4, 3\n" in text
    assert "\nholonomy of the Levi-Civita connection: so(3, 1), dimension 6\n" in text


def test_parallel_legs() -> None:
    """The Cartan connection has no holonomy; its legs keep fewer symmetries than the metric."""
    text = run("symmetries", "schwarzschild", "-c", "cartan").stdout
    assert "2 symmetries of the metric and the Cartan connection" in text
    assert "holonomy of the Cartan connection: trivial, dimension 0" in text


def test_conformal_vectors() -> None:
    """--keep conformal counts the conformal vectors; with another connection it is refused."""
    text = run("symmetries", "s3", "--keep", "conformal").stdout
    assert "10 symmetries of the metric up to a function" in text
    assert "algebra: so(4, 1)" in text
    made = run("symmetries", "s3", "--keep", "conformal", "-c", "cartan", code=2)
    assert "expected the Levi-Civita connection" in made.output


def test_json() -> None:
    """All numbers are in the JSON."""
    data = json.loads(run("symmetries", "s2", "--format", "json").stdout)
    assert (data["dimension"], data["algebra"], data["orbits"]) == (3, "so(3)", 2)
    assert data["killing_form"] == [0, 3, 0]
    assert set(data["structure_constants"]) == {"0,1,2", "0,2,1", "1,2,0"}
    assert data["holonomy"] == {"name": "so(2)", "dimensions": [1], "parallel_vectors": 0}


def test_an_unknown_space_is_refused() -> None:
    """A misspelt name is answered with the right one."""
    made = run("symmetries", "schwarzchild", code=2)
    assert "schwarzschild" in made.output

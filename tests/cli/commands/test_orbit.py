"""orbit: a closed orbit of a file or a space, as a theorem, JSON and a figure."""

import json

import pytest

from tests.cli.running import run

OSCILLATOR = 'rates = {x = "v", v = "(1-x**2)*v-x"}\nstart = {x = 2, v = 0}\n'
PENDULUM = (
    'name = "pendulum"\nrates = {x = "v", v = "-k*sin(x)"}\nstart = {x = 1, v = 0}\n'
    'parameters = {k = 1.0}\ninvariants = {E = "v**2/2-k*cos(x)"}\n'
)
# Axes 1, 1, 3.
ELLIPSOID = (
    'coordinates = ["theta", "phi"]\n'
    'coframe = [["sqrt(cos(theta)**2+9*sin(theta)**2)", 0], [0, "sin(theta)"]]\n'
)


@pytest.fixture
def file(tmp_path):
    """Writes a file and returns its name."""

    def written(text, name="motion.toml"):
        (tmp_path / name).write_text(text, "utf-8")
        return str(tmp_path / name)

    return written


def test_a_limit_cycle(file, tmp_path):
    """Van der Pol's cycle has the period 6.66328685932313 [Andersen, Geer 1982]."""
    folder = tmp_path / "out"
    done = run("orbit", file(OSCILLATOR), "--near", "x=2,v=0", "--period", "6.5", "--section", "v",
               "--proved", "-o", str(folder))  # fmt: skip
    assert "period = 6.6632868593231" in done.stdout
    assert "exactly one closed orbit starts in the box" in done.stdout
    assert "assumed: FLINT" in done.stdout
    document = json.loads((folder / "orbit.json").read_text("utf-8"))
    assert document["stability"] == "attracting"
    assert (folder / "orbit.png").exists()


@pytest.mark.parametrize("options", [
    ["--section", "v", "--conserved", "E"],
    ["--section", "v", "--conserved", "v**2/2-k*cos(x)=-cos(1)"],
    ["--symmetry", "v", "--section", "x-1"],
])  # fmt: skip
def test_a_pendulum_as_json(file, options):
    """From the angle 1 the period is 4 K(sin 1/2) = 6.699975664370452712701211..."""
    done = run("orbit", file(PENDULUM), "--period", "6.5", "--digits", "20", "--format", "json",
               *options)  # fmt: skip
    document = json.loads(done.stdout)
    assert document["period"].startswith("6.6999756643704527127")
    assert document["start"]["x"].startswith("1.0000")
    assert set(document["box"]) >= {"x", "period"}


def test_a_parameter_is_set(file):
    """Four times the force halves the period."""
    done = run("orbit", file(PENDULUM), "--period", "3.2", "--section", "v", "--conserved", "E",
               "--set", "k=4")  # fmt: skip
    assert "period = 3.34998783218523" in done.stdout


def test_the_equator_of_an_ellipsoid(file):
    """Its length is 2 pi."""
    done = run("orbit", file(ELLIPSOID), "--near", "theta=1.57,phi=0,u1=0.01,u2=1",
               "--period", "6.2", "--section", "phi", "--shift", "phi=2*pi",
               "--conserved", "u1**2+u2**2=1")  # fmt: skip
    assert "period = 6.2831853071795" in done.stdout
    assert "elliptic" in done.stdout


@pytest.mark.parametrize(("text", "options", "words"), [
    (OSCILLATOR, ["--near", "w=1"], "expected a state, got 'w'"),
    (OSCILLATOR, ["--near", "x"], "--near: expected NAME=X"),
    (OSCILLATOR, ["--near", "x=1,x=2"], "twice"),
    (OSCILLATOR, ["--symmetry", "x"], "reversed"),
    (OSCILLATOR, ["--moments", "1,2"], "moments: expected nothing for a file of equations"),
    (OSCILLATOR, ["--set", "k=2"], "k"),
    (PENDULUM, ["--section", "v"], "constant in --conserved"),
    (ELLIPSOID, ["--near", "r=1"], "--near: expected one of theta, phi, u1, u2"),
    (OSCILLATOR + "extra = 1\n", [], "unknown key 'extra'"),
    ('rates = {x = "v"}\nstart = {x = 1}\n', [], "v"),
    ('rates = 3\nstart = {x = 1}\n', [], "rates: expected a table"),
    ('rates = {x = "-x"}\n', [], "start: expected a table, got none"),
])  # fmt: skip
def test_refusals(file, text, options, words):
    """Each refusal names the wrong option or key, on one line."""
    done = run("orbit", file(text), "--period", "6.5", *options, code=2)
    assert words in " ".join(done.stderr.split())

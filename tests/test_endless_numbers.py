"""Endless numbers: an expression whose value cannot be computed is refused at every entrance."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from geomtorsion.loops.loop_files import loops_from_json
from geomtorsion.ode import ODE, RungeKutta, SavedSolution, solve
from geomtorsion.scenes.scene_files import read_file as read_scene
from geomtorsion.spaces.tetrad_files import read_file as read_space
from tests.cli.running import run
from tests.rounding import ROUNDED

# Refused before they are computed, which would take hours or all memory.
x, y, a = sp.symbols("x y a", positive=True)
TOWER = sp.exp(sp.exp(sp.exp(99)))
FRAME = gt.Frame([x, y], [[1, 0], [0, a + x**2]])
TEXTS = [
    "exp(exp(exp(99)))",
    "sin(exp(exp(99)))",
    "exp(-exp(exp(99)))",
    "-2**exp(exp(99))",
    "3**exp(exp(exp(9)))**(1/2)",
    "tanh(cosh(exp(50)))",
    "loggamma(10**18)",
    "digamma(10**18 + 1/3)",
    "besselk(999, 999)",
    "9**200**2",
]
WORDS = "of a number above|a power above|the exponent is|larger than the limit"


def saved(folder: Path, part: str, number: str) -> None:
    """Replace a number in the metadata of a saved solution and load it."""
    path = folder / "a.npz"
    solve(ODE.of({"x": "-k*x"}, [1], parameters={"k": 1}), [0.1], 1e-6, RungeKutta()).save(path)
    arrays = dict(np.load(path))
    metadata = json.loads(str(arrays["metadata"]))
    metadata["problem"][part]["k" if part == "parameters" else 0] = number
    arrays["metadata"] = np.array(json.dumps(metadata))
    np.savez(path, **arrays)
    SavedSolution.load(path)


def written(folder: Path, text: str) -> Path:
    """A file with the given text."""
    path = folder / "a.toml"
    path.write_text(text)
    return path


ROUTES: dict[str, Callable[[Path, str], object]] = {
    "start of a saved solution": lambda folder, n: saved(folder, "start", n),
    "parameter of a saved solution": lambda folder, n: saved(folder, "parameters", n),
    "rate": lambda _, n: ODE.of({"x": f"-x*({n})"}, [1]),
    "start": lambda _, n: ODE.of({"x": "-x"}, [n]),
    "parameter": lambda _, n: ODE.of({"x": "-k*x"}, [1], parameters={"k": n}),
    "put in": lambda _, n: FRAME.subs({"a": n}),
    "space": lambda folder, n: read_space(
        written(folder, f'coordinates = ["x", "y"]\ncoframe = [["{n}", 0], [0, 1]]\n')
    ),
    "scene": lambda folder, n: read_scene(
        written(folder, f't = 1\n[body]\nmoments = ["{n}", 2, 3]\n')
    ),
    "loop": lambda _, n: loops_from_json(
        FRAME, json.dumps([{"circle": {"centre": [2, 2], "radius": n}}])
    ),
}


@pytest.mark.parametrize("number", TEXTS)
@pytest.mark.parametrize("route", ROUTES.values(), ids=ROUTES.keys())
def test_texts(route: Callable[[Path, str], object], number: str, tmp_path: Path):
    """Each text is refused before its value is computed."""
    with pytest.raises(GeomtorsionError, match=WORDS):
        route(tmp_path, number)


@pytest.mark.parametrize("number", [text for text in TEXTS if "," not in text])
def test_options(number: str, tmp_path: Path):
    """Such numbers are refused on the command line."""
    space = written(
        tmp_path,
        'coordinates = ["x", "y"]\nparameters = ["k"]\ncoframe = [["k", 0], [0, 1]]\n',
    )
    done = run("curve", str(space), f"--set=k={number}", code=2)
    assert "parameter k: " in done.stderr
    assert re.search(WORDS, done.stdout + done.stderr)


@pytest.mark.parametrize(
    "use",
    [
        lambda n: ODE.of({"x": "-x"}, [n]),
        lambda n: ODE.of({"x": -x * n}, [1]),
        lambda n: gt.geodesic(FRAME, [n, 0.1], [0.2, 0.3], parameters={"a": 1}),
        lambda n: gt.geodesic(FRAME, [1, 0.1], [0.2, 0.3], parameters={"a": n}),
        lambda n: FRAME.subs({"a": n}),
        lambda n: gt.levi_civita(FRAME).curvature.scalar.at({x: 1, y: 1, a: n}),
        lambda n: gt.Loop.circle([2, 2], radius=n),
        lambda n: gt.Frame([x, y], [[1, 0], [0, x + n]]),
    ],
)
@pytest.mark.parametrize("number", [TOWER, sp.sin(sp.log(TOWER)), 1 / TOWER, 2 ** sp.log(TOWER)])
def test_numbers_of_sympy(use: Callable[[sp.Expr], object], number: sp.Expr):
    """Such sympy numbers are refused in Python."""
    with pytest.raises(GeomtorsionError, match=f"{WORDS}|more than 64 bits"):
        use(number)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("exp(-10**9)", 0.0),
        ("sin(10**15)", 0.8582727931702359),
        ("log(10**200)", 460.51701859880916),
        ("sqrt(10**200)", 1e100),
        ("10**(1/3)", 2.154434690031884),
        ("besselj(0, 100)", 0.019985850304223122),
        ("gamma(100)/gamma(99)", 99.0),
        ("exp(exp(5))", 2.851123567946151e64),
    ],
)
def test_numbers_of_use(text: str, value: float):
    """Numbers that can be computed are accepted."""
    read = ODE.of({"x": "-x"}, [text]).start[0]
    assert float(read) == pytest.approx(value, rel=ROUNDED)

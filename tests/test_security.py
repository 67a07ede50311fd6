"""Security: outside text is never executed; each attempt ends in an error of ours."""

import ast
import csv
import io
import json
import re
import warnings
from contextlib import suppress
from functools import cache
from inspect import ismodule
from pathlib import Path
from types import FunctionType
from typing import Any

import click
import numpy as np
import pytest
import sympy as sp
from typer.main import get_command
from typer.testing import CliRunner

import geomtorsion as gt
from geomtorsion import exercises, scenes, spaces
from geomtorsion.cli.app import app
from geomtorsion.errors import GeomtorsionError
from geomtorsion.loops.loop_files import read_loops
from geomtorsion.teaching.exercises.grading import read_submission
from tests import canary_cases
from tests.canary import EVENT, PAYLOAD, WATCH, leaves, payloads, poisoned
from tests.golden import record
from tests.source import tree_of

with suppress(ImportError):
    # The first import may open /dev/null for writing (dill does), which the watch would report.
    import heyoka  # noqa: F401

PACKAGE = Path(gt.__file__).parent
FILES = sorted(PACKAGE.rglob("*.py"))

# -- the source -----------------------------------------------------------------------------------

# These execute text, or read objects that do. (mpmath reads numbers from text, never code.)
BARRED = frozenset({"sympify", "nsimplify", "parse_expr", "literal_eval", "lambdify",
                    "run_path", "run_module"})  # fmt: skip
BARRED_BUILTINS = frozenset({"eval", "exec", "compile", "__import__"})
BARRED_MODULES = frozenset({"pickle", "marshal", "shelve", "dill", "cloudpickle", "joblib", "code"})

# (file, name) -> why it is safe there.
ALLOWED: dict[tuple[str, str], str] = {
    ("teaching/exercises/chapter_folder.py", "run_path"): "the program of a teacher who gives it",
    ("codegen/printers.py", "exec"): "the one place where code of our own is compiled",
    ("codegen/printers.py", "compile"): "the one place where code of our own is compiled",
    ("exact/reading.py", "nsimplify"): "of a Float of sympy, never of text",
    ("gravity/perturbed/collocation.py", "lambdify"): "of fractions that field equations gave",
}


def barred(tree: ast.AST) -> list[tuple[str, int]]:
    """Names in a source that may execute text, with their lines, also where they are passed on.

    A method of the same name (re.compile, a polynomial's eval) does not count; sp.S counts where it
    is called.
    """
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and node.id in BARRED | BARRED_BUILTINS:
            found.append((node.id, node.lineno))
        elif isinstance(node, ast.Attribute) and node.attr in BARRED:
            found.append((node.attr, node.lineno))
        elif isinstance(node, ast.Attribute) and node.attr in BARRED_BUILTINS:
            if isinstance(node.value, ast.Name) and node.value.id == "builtins":
                found.append((node.attr, node.lineno))
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = {alias.name for alias in node.names}
            found += [(name, node.lineno) for name in names & BARRED]
            if node.module.partition(".")[0] in BARRED_MODULES:
                found.append((node.module, node.lineno))
        elif isinstance(node, ast.Import):
            parts = {alias.name.partition(".")[0] for alias in node.names}
            found += [(name, node.lineno) for name in parts & BARRED_MODULES]
        if isinstance(node, ast.Call):
            name = getattr(node.func, "attr", getattr(node.func, "id", ""))
            if name == "S" or (name in ("Rational", "Float", "Integer") and _is_text(node)):
                found.append((name, node.lineno))
            safe = any(
                key.arg == "allow_pickle"
                and isinstance(key.value, ast.Constant)
                and key.value.value is False
                for key in node.keywords
            )
            is_numpy = isinstance(node.func, ast.Attribute) and ast.unparse(node.func) == "np.load"
            if is_numpy and not safe:
                found.append(("np.load", node.lineno))
            if name in ("Popen", "run", "call", "check_output", "system") and any(
                key.arg == "shell" for key in node.keywords
            ):
                found.append((f"{name}(shell=...)", node.lineno))
    return found


def _is_text(call: ast.Call) -> bool:
    """Whether a sympy number is made from an f-string."""
    return any(isinstance(argument, ast.JoinedStr) for argument in call.args)


@cache
def barred_in(file: Path) -> list[tuple[str, int]]:
    """Barred names of a file, which is searched only once."""
    return barred(tree_of(file))


def test_no_source_runs_text():
    """sympify, eval and similar names occur only where ALLOWED gives a reason."""
    wrong = [
        f"{name}:{line}: {what}"
        for file in FILES
        for name in [file.relative_to(PACKAGE).as_posix()]
        for what, line in barred_in(file)
        if (name, what) not in ALLOWED
    ]
    assert len(FILES) > 300
    assert not wrong, f"use checks.expression or exact.parse_expression: {wrong}"


def test_no_reason_is_stale():
    """Each allowed name occurs in its file and has a reason."""
    present = {
        (file.relative_to(PACKAGE).as_posix(), what)
        for file in FILES
        for what, _ in barred_in(file)
    }
    assert set(ALLOWED) <= present, f"remove: {set(ALLOWED) - present}"
    assert all(len(reason) > 5 for reason in ALLOWED.values())


@pytest.mark.parametrize(
    "source",
    [
        "sp.sympify(x)",
        "map(sp.sympify, x)",
        "from sympy import sympify",
        "eval(x)",
        "builtins.exec(x)",
        "sp.S(x)",
        "import pickle",
        "from pickle import loads",
        "np.load(x)",
        "np.load(x, allow_pickle=True)",
        "ast.literal_eval(x)",
        "subprocess.run(x, shell=True)",
    ],
)
def test_the_lint_finds(source):
    """The search finds each of these, so the test above can fail."""
    assert barred(ast.parse(source))


def test_the_lint_lets_through():
    """The search ignores names that only look alike."""
    source = "re.compile(x); poly.eval(0); sp.S.Zero; np.load(x, allow_pickle=False); sp.Integer(3)"
    assert not barred(ast.parse(source))


# -- calls ----------------------------------------------------------------------------------------

CASES = [
    *canary_cases.public_functions(),
    *canary_cases.public_methods(),
    *canary_cases.scene_cases(),
    *canary_cases.other_cases(),
]


# These check all their arguments at once, so no error of Python or sympy may escape.
CHECKED = frozenset(
    "AffineMap At Body Box Cochain Complex Connection Curvature CurveProblem DependencyGraph "
    "DislocationNetwork EdgeList ElasticConstants NyeField stresses LineArrays Element Exercise "
    "Frame RungeKutta State Stiff Taylor Tensor Torsion TransitionMap When blend burgers_vector "
    "cartan conserved_quantities contract dispiration equations_of_motion exact_burgers_vector "
    "kerr_orbit linearized exponential_map free_top from_coefficients from_contortion "
    "from_spin_connection geodesic_deviation holonomy identities levi_civita log_map "
    "numpy_function parallel_transport parse_expression spaces variation Circuit OrientationMap "
    "Phase from_nonmetricity".split()
)
REFUSED_BY_PYTHON = ("unsupported operand", "unhashable type", "can't multiply sequence")


def is_ours(error):
    """Whether a call ended without an error, with one of ours, or with a refusal by Python."""
    if isinstance(error, TypeError) and str(error).startswith(REFUSED_BY_PYTHON):
        return True
    return error is None or isinstance(error, GeomtorsionError)


def test_the_watch_sees():
    """The watch reports executed text and is silent otherwise."""
    assert WATCH.during(lambda: sp.sympify(PAYLOAD))[1][-1] == EVENT
    assert WATCH.during(lambda: sp.Matrix([[PAYLOAD]]))[1]
    assert WATCH.during(lambda: eval("1 + 1")) == (None, [])  # noqa: S307
    assert WATCH.during(lambda: open("/dev/null", "w").close())[1]


def test_everything_public_is_tried():
    """Each public function, class and effect is among the cases, or only the package makes it."""
    tried = {case.name.partition(".")[0].partition(" ")[0] for case in CASES}
    public = {*gt.__all__, *record.read(record.MOVED_FILE)}
    modules = {name for name in gt.__all__ if ismodule(getattr(gt, name))}
    missing = public - tried - modules - {"GeomtorsionError"} - canary_cases.RESULTS
    assert not missing, f"give canary_cases a call that works: {missing}"
    effects = {f"effects.{effect.__name__}" for effect in scenes.effects.EFFECTS}
    assert effects <= {case.name for case in CASES}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_no_argument_is_run(case, tmp_path, monkeypatch):
    """The payload in any argument, bare or nested, has no side effect and raises no sympy error.

    The result of the call itself prints without the address of an object.
    """
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        results = []
        error, seen = WATCH.during(lambda: results.append(case.call(**case.arguments)))
        assert error is None, f"the call itself fails: {error!r}"
        assert not seen
        if not isinstance(results[0], FunctionType):
            assert not re.search("0x[0-9a-f]{6}", f"{results[0]!r} {results[0]}")
        for label, arguments in poisoned(case):
            error, seen = WATCH.during(lambda given=arguments: case.call(**given))
            if "(checkpoint=" in label:
                # The call was to write a file of this name.
                seen = [event for event in seen if "opened for writing" not in event]
            assert not seen, f"{label}: {seen}"
            assert not isinstance(error, sp.SympifyError | SyntaxError), f"{label}: {error!r}"
            if case.name.partition(".")[0].partition(" ")[0] in CHECKED:
                assert is_ours(error), f"{label}: {error!r}"


LOOP = gt.Loop.circle([0.1, 0], 0.5)


def test_names_are_not_run():
    """Symbols and functions named like the payload never reach compiled code."""
    x, y, p = sp.Symbol(PAYLOAD), sp.Symbol("y"), sp.Symbol(f"{PAYLOAD}#", positive=True)
    f = sp.Function(PAYLOAD)
    for entry in (1 + p * x**2, sp.erf(x) + f(y)):
        frame = gt.Frame([x, y], [[1, 0], [0, entry]])
        given = {symbol.name: 1 for symbol in frame.parameters}
        start = ([0.1, 0], [1, 1])

        def solved(engine, frame=frame, given=given, start=start):
            return gt.solve(gt.geodesic(frame, *start, parameters=given), 0.5, 1e-6, engine)

        calls = [
            lambda frame=frame: (str(frame), frame._repr_latex_(), frame.metric._repr_latex_()),
            lambda frame=frame: gt.levi_civita(frame).curvature.ricci.to_sympy(),
            lambda frame=frame, given=given: frame.metric.at({PAYLOAD: 1, "y": 1, **given}),
            lambda frame=frame, given=given: gt.numpy_function(
                [frame.metric.element(1, 1)], [*frame.coordinates, *frame.parameters]
            )(1.0, 1.0, *given.values()),
            lambda: solved(gt.RungeKutta()),
            lambda: solved(gt.Taylor()),
            lambda: solved(gt.Taylor(113)),
            lambda frame=frame, given=given: gt.burgers_vector(frame, LOOP, parameters=given),
            lambda frame=frame: gt.exact_burgers_vector(frame, gt.Loop.circle([0, 0], p)),
            lambda frame=frame: gt.exact_burgers_vector(frame, gt.Loop.circle([0, 0], 1)),
            lambda frame=frame, given=given: gt.develop(gt.cartan(frame), LOOP, parameters=given),
            lambda frame=frame: gt.equations_of_motion(frame, "u1**2/2 + u2**2/2"),
            lambda frame=frame: gt.conserved_quantities(frame, "u1**2/2 + u2**2/2"),
        ]
        for call in calls:
            error, seen = WATCH.during(call)
            assert not seen
            assert error is None or isinstance(error, GeomtorsionError), repr(error)


# -- files ----------------------------------------------------------------------------------------

TETRAD = {
    "name": "bent", "title": "a", "story": "b", "source": "c", "notes": "d",
    "coordinates": ["x", "y"], "domain": ["x > 0"], "coframe": [[1, 0], [0, "M + f(x)"]],
    "signature": [1, 1], "complex": False, "connection": {"0,0,1": "x", "0,1,0": "-x"},
    "parameters": {"M": "positive"}, "functions": {"f": ["x"]},
}  # fmt: skip
SCENE = {
    "name": "top", "title": "a", "story": "b", "watch": ["energy"], "t": "1 s",
    "accuracy": 1e-6, "samples": 11, "body": {"mass": 1, "moments": [1, 2, "3 kg m^2"]},
    "effects": [
        {"kind": "angular_damping", "coefficient": "1"},
        {"kind": "custom", "moment": ["k", 0, 0], "parameters": {"k": 1}, "states": {"s": "-s"},
         "start": {"s": 1}, "outputs": {"twice": "2*s"}},
    ],
    "start": {"omega": [1, 2, "3 rad/s"], "euler": ["20 deg", 0, 0], "euler_convention": "zyz"},
}  # fmt: skip
LOOPS = {
    "loops": [
        {"circle": {"centre": [0, 0], "radius": "1/2", "plane": ["x", "y"]}, "times": 2},
        {"ellipse": {"centre": [0, 0], "axes": [1, 2]}, "name": "b"},
        {"polygon": {"vertices": [[0, 0], [1, 0], [0, 1]], "centre": [0, 0], "size": 1}},
        {"plaquette": {"corner": [0, 0], "steps": [1, 1]}},
        {"curve": {"expressions": ["cos(s)", "sin(s)"], "parameter": "s",
                   "interval": [0, "2*pi"], "centre": [0, 0], "size": 1}},
        {"spline": {"points": [[0, 0], [1, 0], [1, 1], [0, 1]]}},
    ],
    "parameters": {"M": "1/2"}, "accuracy": 1e-6,
}  # fmt: skip
SUBMISSION = {"student": "ada", "seed": 1, "answers": {"3.2": "cot(phi2)", "1.1": ["x", "y"]}}
SHAPES = {
    "text": PAYLOAD,
    "list": [PAYLOAD],
    "rows": [[PAYLOAD, PAYLOAD], [PAYLOAD, PAYLOAD]],
    "table": {"x": PAYLOAD},
    "key": {PAYLOAD: 1},
    "number": 3,
    "nothing": "",
}


def toml(data) -> str:
    """A table as TOML text; tables inside are written inline."""

    def value(x):
        if isinstance(x, dict):
            pairs = (f"{json.dumps(k)} = {value(v)}" for k, v in x.items())
            return f"{{{', '.join(pairs)}}}"
        if isinstance(x, list):
            return f"[{', '.join(map(value, x))}]"
        return json.dumps(x)

    return "".join(f"{json.dumps(key)} = {value(part)}\n" for key, part in data.items())


def read_tetrad(path):
    """Read a space and compute what a report shows."""
    space = spaces.read_file(path)
    return str(space.frame.metric), space.frame.anholonomy.nonzero()


def read_scene(path):
    """Read a scene and derive its equations."""
    return str(scenes.read_file(path).selection)


def read_answers(path):
    """Read answers and check them one by one."""
    answers: dict[str, Any] = dict(read_submission(path).answers)
    return [exercises.check(key, given, 1) for key, given in answers.items()]


READERS = {
    "tetrad": (TETRAD, toml, "a.toml", read_tetrad),
    "scene": (SCENE, toml, "a.toml", read_scene),
    "loops": (LOOPS, json.dumps, "a.json", lambda path: read_loops(canary_cases.PLANE, path)),
    "answers": (SUBMISSION, toml, "a.toml", read_answers),
}


@pytest.mark.parametrize("kind", READERS)
def test_no_file_is_run(kind, tmp_path):
    """The payload in any value of a file, in any shape that the format allows, is not executed."""
    data, write, name, read = READERS[kind]
    path = tmp_path / name
    path.write_text(write(data))
    error, seen = WATCH.during(lambda: read(path))
    assert error is None
    assert not seen
    count = 0
    for place, replaced in leaves(data, depth=-3):
        for shape, payload in SHAPES.items():
            path.write_text(write(replaced(payload)))
            error, seen = WATCH.during(lambda: read(path))
            assert not seen, f"{kind}{place} = {shape}: {seen}"
            assert error is None or isinstance(error, GeomtorsionError), (
                f"{kind}{place} = {shape}: {error!r}"
            )
            count += 1
    assert count > 40


def test_the_file_that_ran_code(tmp_path, monkeypatch):
    """A list instead of an expression in a file of loops, which once ran as code, is refused."""
    monkeypatch.chdir(tmp_path)
    evil = [{"curve": {"expressions": [["__import__('os').system('touch PWNED')"], "1", "0"]}}]
    Path("evil.json").write_text(json.dumps(evil))
    result = CliRunner().invoke(app, ["burgers", "so3", "--loops", "evil.json"])
    assert result.exit_code == 2
    assert "expected one expression, got [" in result.output
    assert not Path("PWNED").exists()


def test_no_table_of_loops_is_run(tmp_path):
    """The payload in each column of a CSV file is not executed."""
    path = tmp_path / "loops.csv"
    for header, row in [
        ("x,y,radius,plane,name", ["0", "0", "1", "x y", "a"]),
        ("x,y,loop", ["0", "0", "a"]),
    ]:
        for place in range(len(row)):
            changed = [PAYLOAD if k == place else cell for k, cell in enumerate(row)]
            text = io.StringIO()
            csv.writer(text).writerows([header.split(","), changed, changed, changed])
            path.write_text(text.getvalue())
            error, seen = WATCH.during(lambda: read_loops(canary_cases.PLANE, path))
            assert not seen
            assert error is None or isinstance(error, GeomtorsionError)


@pytest.mark.parametrize("kind", ["solution", "flow", "scene", "grid", "nye field"])
def test_no_array_file_is_run(kind, tmp_path):
    """Objects, text and the payload instead of each array of an NPZ file are not executed."""
    path = tmp_path / "saved.npz"
    saved = {
        "solution": (canary_cases.SOLVED.save, gt.SavedSolution.load),
        "flow": (canary_cases.RUN.save, gt.SavedSolution.load),
        "scene": (canary_cases.RESULT.save, scenes.SceneResult.load),
        "grid": (canary_cases.GRID.save, gt.SampledFrame.read),
        "nye field": (canary_cases.OPEN_FIELD.save, gt.NyeField.read),
    }
    write, read = saved[kind]
    write(path)
    assert WATCH.during(lambda: read(path)) == (None, [])
    with np.load(path, allow_pickle=False) as content:
        arrays = {name: content[name] for name in content.files}
    objects = np.array([PAYLOAD, {}], dtype=object)
    for name in arrays:
        for wrong in (np.array(PAYLOAD), np.array([PAYLOAD]), objects, np.zeros(())):
            # Arrays may have any name; the type checker mistakes one name for an option.
            np.savez(path, **arrays | {name: wrong})  # type: ignore[arg-type]
            error, seen = WATCH.during(lambda: read(path))
            assert not seen, name
            assert error is None or isinstance(error, GeomtorsionError), f"{name}: {error!r}"


# -- commands -------------------------------------------------------------------------------------

COMMANDS = {
    "geometry": ["s2"],
    "gravity": ["s2"],
    "symmetries": ["s2"],
    "check": ["s2"],
    "plan": ["s2"],
    "curve": ["s2", "--t", "0.1", "--accuracy", "1e-6"],
    "accuracy": ["s2", "--t", "0.1"],
    "burgers": ["s2", "--circle", "1,0:0.1", "--set", "R=1"],
    "circuit": ["none.ctf", "--loop", "circle 1,1:1", "--laue", "1=m-3m"],
    "map": ["none.ctf", "--circle", "1,1:1", "--laue", "1=m-3m"],
    "stress": ["none.data", "--elastic", "isotropic 1 0.3"],
    "run": ["euler_top", "--t", "0.1"],
    "scenes": [],
    "spaces": [],
    "report": ["s2"],
    "exercises list": [],
    "exercises show": ["1.1"],
    "exercises check": ["1.1", "1"],
    "exercises grade": ["none"],
    "exercises sheet": ["1.1"],
    "exercises hint": ["1.1"],
    "exercises export": ["--to", "nbgrader", "-o", "course", "--only", "3.1"],
}
# These start servers or pages, or write pictures that other tests cover.
UNTRIED = {"lab", "paper"}


def commands(group, path=()):
    """Each command with its name."""
    if isinstance(group, click.Group) or hasattr(group, "commands"):
        for name, command in group.commands.items():
            yield from commands(command, (*path, name))
    else:
        yield " ".join(path), group


ALL_COMMANDS = dict(commands(get_command(app)))


def test_all_commands_are_known():
    """Each command is tried below or listed in UNTRIED."""
    assert set(ALL_COMMANDS) - UNTRIED <= set(COMMANDS), set(ALL_COMMANDS) - set(COMMANDS)


@pytest.mark.parametrize("name", [name for name in COMMANDS if name in ALL_COMMANDS])
def test_no_option_is_run(name, tmp_path, monkeypatch):
    """The payload as each argument and each option of each command is not executed."""
    monkeypatch.chdir(tmp_path)
    base = [*name.split(), *COMMANDS[name]]
    given = len(name.split())
    tries = [[*base[:k], PAYLOAD, *base[k + 1 :]] for k in range(given, len(base))]
    for parameter in ALL_COMMANDS[name].params:
        option = next((o for o in parameter.opts if o.startswith("--")), None)
        if option and not getattr(parameter, "is_flag", False):
            # These options may create a folder with the name of the payload.
            if parameter.name in ("output", "folder", "directory"):
                continue
            tries.append([*base, option, PAYLOAD])
            tries.append([*base, option, f"x={PAYLOAD}"])
    for arguments in tries:
        error, seen = WATCH.during(lambda given=arguments: CliRunner().invoke(app, given))
        assert error is None
        ran = [event for event in seen if "opened for writing" not in event]
        assert not ran, f"{arguments}: {seen}"


def test_payloads_are_of_all_kinds():
    """The payloads include text, nested text, arrays and objects."""
    assert {"text", "list", "tuple", "table", "array", "object", "symbol"} <= set(payloads())

"""Exits of commands as processes: ASCII output, Ctrl-C, closed pipe, limits, page for an error."""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion import errors
from geomtorsion.cli.exits import more_on
from tests.cli.running import run
from tests.materials.lines.synthetic_networks import rings
from tests.processes import interruptible

ROOT = Path(__file__).parent.parent.parent


def process(*arguments: str, run=("-m", "geomtorsion"), **options) -> subprocess.Popen:
    """The command in a process of its own."""
    return interruptible(
        [sys.executable, *run, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        **options,
    )


def test_a_process_without_greek():
    """On an ASCII terminal the command succeeds, and check marks are words."""
    with process("check", "s2", env={**os.environ, "PYTHONIOENCODING": "ascii"}) as running:
        out, error = running.communicate(timeout=60)
    assert running.returncode == 0, error
    assert out.isascii()
    assert "ok   metricity" in out


# The command, which prints a line when it opens the file, because its work begins then.
SAYS_WHEN_IT_READS = """
import sys
from geomtorsion.cli import main
opened = lambda event, got: event == "open" and str(got[0]).endswith("long.toml")
sys.addaudithook(lambda *event: opened(*event) and print("reads", flush=True))
main()
"""


def test_ctrl_c_ends_quietly(tmp_path):
    """A long computation stops at once, with code 130 and one line."""
    file = tmp_path / "long.toml"
    terms = "+".join(f"x**{k % 251}*y**{k // 251 % 251}" for k in range(100_000))
    file.write_text(f'coordinates = ["x", "y"]\ncoframe = [["{terms}", 0], [0, 1]]\n')
    with process("geometry", str(file), run=("-c", SAYS_WHEN_IT_READS)) as running:
        assert running.stdout is not None
        assert running.stdout.readline() == "reads\n"
        running.send_signal(signal.SIGINT)
        _, error = running.communicate(timeout=60)
    assert running.returncode == 130
    assert error == "geomtorsion: stopped\n"


# Print a line when a given module begins to load: a library, the package or a command.
SAYS_WHEN_IT_LOADS = """
import runpy, sys
sys.orig_argv[:] = ["python", "-m", "geomtorsion"]
sys.argv[:] = ["geomtorsion", "curve", "s2"]
class Say:
    def find_spec(self, name, path=None, target=None):
        if name == "%s": print("loads", flush=True)
sys.meta_path.insert(0, Say())
runpy.run_module("geomtorsion", run_name="__main__", alter_sys=True)
"""


@pytest.mark.parametrize(
    "module", ["sympy", "geomtorsion.exact.field", "typer", "geomtorsion.curves.problem"]
)
def test_ctrl_c_while_modules_are_loaded(module):
    """Code 130 and one line, also before the command is loaded."""
    code = SAYS_WHEN_IT_LOADS % module
    with process(run=("-c", code), start_new_session=True) as running:
        assert running.stdout is not None
        assert running.stdout.readline() == "loads\n"
        running.send_signal(signal.SIGINT)
        _, error = running.communicate(timeout=60)
    assert running.returncode == 130
    assert error == "geomtorsion: stopped\n"


def test_a_program_that_imports_the_package_gets_its_interrupt():
    """Importing the package does not change what Ctrl-C does in a program."""
    code = (
        "import geomtorsion, signal\n"
        "assert signal.getsignal(signal.SIGINT) is signal.default_int_handler\n"
        "try: print('ready', flush=True); signal.pause()\n"
        "except KeyboardInterrupt: print('mine')\n"
    )
    with process(run=("-c", code)) as running:
        assert running.stdout is not None
        assert running.stdout.readline() == "ready\n"
        running.send_signal(signal.SIGINT)
        out, _ = running.communicate(timeout=60)
    assert out == "mine\n"


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["map", "field.npz"], "map.csv"),
        (["map", "field.npy", "--blocks", "30"], "map.zarr"),
        pytest.param(
            ["circuit", "field.npz", "--loop", "circle 20,20:9"],
            "circuits.png",
            marks=pytest.mark.slow,
        ),
        pytest.param(["curve", "s2"], "curve.csv", marks=pytest.mark.slow),
        pytest.param(
            ["run", "lagrange_cusp", "--t", "0.1"], "checkpoint.npz", marks=pytest.mark.slow
        ),
        pytest.param(["report", "s2"], "geometry.json", marks=pytest.mark.slow),
    ],
    ids=lambda x: x if isinstance(x, str) else x[0],
)
def test_a_full_disk_ends_with_the_name_of_the_file(tmp_path, arguments, named):
    """Code 2 and a message that names the file; no partial file remains."""
    resource = pytest.importorskip("resource")
    values = 1 + np.random.default_rng(0).normal(size=(2, 2, 40, 40))
    np.save(tmp_path / "field.npy", values)
    gt.SampledFrame([np.arange(40.0)] * 2, values).save(tmp_path / "field.npz")
    given = [str(tmp_path / x) if x.startswith("field") else x for x in arguments]
    room = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))  # noqa: E731
    with process(*given, "-o", str(tmp_path / "out"), preexec_fn=room) as running:
        _, error = running.communicate(timeout=120)
    assert running.returncode == 2
    assert f"{named}: " in error
    assert "cannot be written" in error
    assert "Traceback" not in error
    assert not [x for x in tmp_path.rglob("*") if "part" in x.name]


def test_a_closed_pipe_ends_quietly():
    """`geomtorsion ... | head -1` shows no traceback."""
    with process("geometry", "kerr") as running:
        assert running.stdout is not None
        assert running.stderr is not None
        running.stdout.readline()
        running.stdout.close()
        assert "Traceback" not in running.stderr.read()


@pytest.mark.parametrize(
    ("option", "limit"), [(("--seconds", "0.3"), "0.3 s"), (("--megabytes", "50"), "50 MB")]
)
def test_limits_end_a_command(option, limit, tmp_path):
    """A limit of time or memory ends the command with code 2 and a message that names the limit."""
    file = tmp_path / "long.toml"
    terms = "+".join(f"x**{k % 251}*y**{k // 251 % 251}" for k in range(100_000))
    file.write_text(f'coordinates = ["x", "y"]\ncoframe = [["{terms}", 0], [0, 1]]\n')
    with process("geometry", str(file), *option) as running:
        _, error = running.communicate(timeout=60)
    assert running.returncode == 2
    # Users of a command do not know the functions of the package.
    assert f"the work takes more than {limit}" in error
    assert error.startswith("geomtorsion: ")
    assert "Traceback" not in error


def test_a_limit_reports_how_to_resume(tmp_path):
    """A limit reports how to resume as Ctrl-C does, and leaves the checkpoint."""
    out = ("-o", str(tmp_path / "out"))
    # A scene that takes a minute or more.
    scene = ("run", "lagrange_loop", "--engine", "rungekutta", "--t", "20000")
    with process(*scene, *out, "--seconds", "8") as running:
        _, error = running.communicate(timeout=120)
    assert running.returncode == 2
    assert "takes more than 8 s" in error
    assert "resume with --resume" in error
    assert (tmp_path / "out/checkpoint.npz").exists()


def test_ctrl_c_reaches_a_limited_command(tmp_path):
    """Ctrl-C ends a command with limits as one without: code 130 and one line."""
    file = tmp_path / "long.toml"
    terms = "+".join(f"x**{k % 251}*y**{k // 251 % 251}" for k in range(100_000))
    file.write_text(f'coordinates = ["x", "y"]\ncoframe = [["{terms}", 0], [0, 1]]\n')
    given = ("geometry", str(file), "--seconds", "100")
    with process(*given, run=("-c", SAYS_WHEN_IT_READS)) as running:
        assert running.stdout is not None
        assert running.stdout.readline() == "reads\n"
        running.send_signal(signal.SIGINT)
        _, error = running.communicate(timeout=60)
    assert running.returncode == 130
    assert error == "geomtorsion: stopped\n"


def test_a_limited_command_has_its_input_and_output(tmp_path):
    """Standard input, output and the exit code are the same with limits that are not met."""
    loops = '[{"name": "c", "circle": {"center": [0, 0], "radius": 0.1}}]'
    given = ("burgers", "so3", "--loops", "-")
    answers = []
    for more in ((), ("--seconds", "100", "--megabytes", "4000")):
        with process(*given, *more, stdin=subprocess.PIPE) as running:
            answers.append((*running.communicate(loops, timeout=100), running.returncode))
    assert answers[0] == answers[1]
    assert answers[0][0] or answers[0][1]


@pytest.mark.parametrize("line", ["network FILE", "exercises sheet 1 -o OUT"])
def test_long_work_takes_a_limit(line, tmp_path):
    """A short limit ends the command with a message, without files; a negative one is refused."""
    file = tmp_path / "chains.data"
    gt.DislocationNetwork.of_arrays(rings(20, seed=6)).save(file)
    words = line.replace("FILE", str(file)).replace("OUT", str(tmp_path / "out")).split()
    with process(*words, "--seconds", "1e-6") as running:
        _, error = running.communicate(timeout=100)
    assert running.returncode == 2
    assert "the work takes more than 1e-06 s" in error
    assert "expected a positive number" in run(*words, "--seconds", "-1", code=2).stderr
    assert [path.name for path in tmp_path.iterdir()] == ["chains.data"]


@pytest.mark.skipif(sys.platform == "win32", reason="there is no such limit")
def test_too_little_memory_ends_in_words(tmp_path):
    """If memory runs out, the command prints one line without a traceback and ends with 2."""
    nodes = np.arange(2000)
    field = np.zeros((2, 2, len(nodes), len(nodes)), np.float32)
    np.savez_compressed(tmp_path / "a.npz", axis_x=nodes, axis_y=nodes, coframe=field)
    limited = f"ulimit -d 300000 && {sys.executable} -m geomtorsion map a.npz"
    done = subprocess.run(
        ["sh", "-c", limited], cwd=tmp_path, capture_output=True, text=True, check=False,
        env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.startswith("geomtorsion: the machine has too little memory for this.")
    assert done.stderr.count("\n") == 1


def test_expressions_without_a_limit_are_refused():
    """A negative limit is refused."""
    error = run("geometry", "s2", "--seconds", "-1", code=2).stderr
    assert "seconds: expected a positive number, got -1" in error


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(kind, id=name)
        for name, kind in sorted(vars(errors).items())
        if isinstance(kind, type) and issubclass(kind, errors.GeomtorsionError)
    ],
)
def test_every_error_names_a_page_that_is_there(kind):
    """`page` of each error class is a page of the site, and the hint quotes its title."""
    site = ROOT / "examples/site"
    assert (site / f"{kind.page}.md").is_file()
    more = more_on(kind("no"), site)
    assert more.endswith(f", examples/site/{kind.page}.md)")
    title = more.split('"')[1]
    assert f"\n# {title}\n" in f"\n{(site / f'{kind.page}.md').read_text('utf-8')}"


def test_a_file_of_any_kind_links_to_the_general_page():
    """Tetrads, atoms, maps and images share this class, so its page is the general one."""
    assert errors.FileFormatError.page == "errors"


def test_a_checkout_names_the_page_that_helps():
    """The hint has its own line below the message."""
    # A new process, because this one may use an installed package, which has no pages.
    with process("geometry", "nowhere") as running:
        _, error = running.communicate(timeout=60)
    message, more = error.splitlines()
    assert message.startswith("geomtorsion: ")
    assert more.startswith('(More on this: "How errors are reported", examples/site/')
    assert more.endswith(f"/{errors.UnknownNameError.page}.md)")


def test_a_wheel_names_no_page_that_it_lacks(tmp_path):
    """A package without the site, as from a wheel, prints only the message."""
    shutil.copytree(
        ROOT / "geomtorsion", tmp_path / "geomtorsion", ignore=shutil.ignore_patterns("*.pyc")
    )
    done = subprocess.run(
        [sys.executable, "-m", "geomtorsion", "geometry", "nowhere"],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(tmp_path)},
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.startswith("geomtorsion: ")
    assert "examples/site" not in done.stderr

"""The house: imports point down, names are exported once, files are short, importing is light."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import geomtorsion

PACKAGE = Path(geomtorsion.__file__).parent
ROOT = Path(__file__).parent.parent
FILES = sorted(PACKAGE.rglob("*.py"))

# Lowest floor first; packages on one floor do not know each other.
FLOORS = (
    ("errors",),
    ("conventions", "checks"),
    ("files",),
    ("exact",),
    ("codegen",),
    ("geometry", "ode"),
    ("motion",),
    ("action", "curves", "loops", "rigid"),
    ("spaces",),
    ("accuracy", "pictures", "paper"),
    ("scenes", "exercises"),
    ("cli", "lab"),
    ("__main__",),
)
# What stands on one floor and may still be used there, with the reason.
NEIGHBOURS: dict[tuple[str, str], str] = {
    ("accuracy", "pictures"): "a table of costs draws itself in the ink of all pictures",
    ("cli", "lab"): "the command that serves the page",
}
# Files of more lines hold more than one idea, unless a reason stands here.
LONG: dict[str, str] = {
    "checks.py": "all validators side by side, so that nobody writes another; half are examples",
}
LONGEST = 500
HEAVY = ("networkx", "scipy", "typer", "rich", "matplotlib", "heyoka", "marimo", "dask", "ase")


def floor_of(part: str) -> int:
    """The floor on which a package or module of geomtorsion stands."""
    for number, names in enumerate(FLOORS):
        if part in names:
            return number
    raise AssertionError(f"geomtorsion.{part} stands on no floor; add it to FLOORS")


def imported_parts(file: Path) -> set[str]:
    """First names below geomtorsion that a file imports, at any depth of the code."""
    parts: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file.name}: imports are absolute"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in names:
            head, _, rest = name.partition(".")
            if head == "geomtorsion":
                parts.add(rest.partition(".")[0])
    return parts


def upward(own: str, imported: str) -> bool:
    """Whether an import points to a higher floor, or to a neighbour without a reason."""
    if imported == own or (own, imported) in NEIGHBOURS:
        return False
    return floor_of(imported) >= floor_of(own)


def part_of(file: Path) -> str:
    """First name below geomtorsion of a file."""
    return file.relative_to(PACKAGE).parts[0].removesuffix(".py")


def test_there_is_something_to_check():
    """The tests below look at the whole package."""
    assert len(FILES) > 80
    assert {part_of(file) for file in FILES} >= {"exact", "geometry", "spaces", "pictures", "cli"}


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(PACKAGE)))
def test_no_arrow_points_up(file):
    """A file imports only from its own package and from floors below it."""
    own = part_of(file)
    if own == "__init__":
        return
    wrong = sorted(part for part in imported_parts(file) if upward(own, part))
    assert not wrong, f"{file.relative_to(PACKAGE)} imports from above: {wrong}"


def test_an_upward_arrow_would_be_found():
    """The check above can fail: each of these is refused."""
    assert upward("exact", "geometry")
    assert upward("geometry", "cli")
    assert upward("motion", "curves")
    assert not upward("cli", "exact")
    with pytest.raises(AssertionError, match="stands on no floor"):
        floor_of("cellar")


def test_public_names_are_exported_once():
    """geomtorsion exports each name once, has it, and nothing else exports to users."""
    names = geomtorsion.__all__
    assert len(names) == len(set(names))
    assert names == sorted(names, key=lambda name: (name.lower(), name)) or names == sorted(names)
    assert {"Frame", "cartan", "levi_civita", "contract", "spaces"} <= set(names)
    for name in names:
        assert getattr(geomtorsion, name) is not None


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(PACKAGE)))
def test_a_long_file_has_a_reason(file):
    """No file has more than 500 lines, unless a reason is stated here."""
    name = str(file.relative_to(PACKAGE))
    lines = len(file.read_text("utf-8").splitlines())
    assert lines <= LONGEST or LONG.get(name), f"{name} has {lines} lines"
    assert lines > LONGEST or name not in LONG, f"{name} is short again: drop it from LONG"


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(PACKAGE)))
def test_every_file_says_what_it_is(file):
    """The first statement of a file is a docstring."""
    assert ast.get_docstring(ast.parse(file.read_text("utf-8")))


def test_importing_is_light():
    """Importing the package loads neither what an extra brings nor what few uses need."""
    code = "import sys, geomtorsion; print(*sorted({name.split('.')[0] for name in sys.modules}))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    loaded = set(done.stdout.split())
    assert {"sympy", "flint", "geomtorsion"} <= loaded
    assert not loaded & set(HEAVY)


def test_importing_is_quiet():
    """Importing prints nothing and warns of nothing."""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", "import geomtorsion"],
        capture_output=True,
        text=True,
        check=True,
        cwd=ROOT,
    )
    assert not done.stdout
    assert not done.stderr


def test_the_top_level_stays_clear():
    """Nothing but what a visitor expects stands at the top of the checkout."""
    expected = {"pyproject.toml", "README.md", "CHANGELOG.md", "LICENSE"}
    expected |= {"geomtorsion", "tests", "examples"}
    listed = {path.name for path in ROOT.iterdir() if not path.name.startswith(".")}
    made = {"build", "dist", "__pycache__"}
    strangers = {name for name in listed - expected - made if not name.endswith("-report")}
    assert not strangers
    assert expected <= listed

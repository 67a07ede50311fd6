"""Layout: imports point down, names are exported once, files are short, importing is light."""

import ast
import re
import subprocess
import sys
from itertools import chain
from pathlib import Path

import pytest

import geomtorsion
from tests.source import (
    FILES,
    annotated_types,
    bare_inner_imports,
    code_lines,
    file_imports,
    has_any,
    imported_names,
    is_exported,
    looked_for,
    name_of,
    named_modules,
    package_imports,
    part_of,
    questions_of_class,
    rings,
    text_of,
    tree_of,
    tuned_constants,
    walk,
)

TESTS = Path(__file__).parent
ROOT = TESTS.parent

# Lowest layer first; packages in one layer do not import each other.
BELOW_THE_WALL = (
    ("errors",),
    ("support",),
    ("conventions",),
    ("exact",),
    ("codegen",),
    ("geometry", "ode"),
    ("action", "curves", "loops", "rigid"),
    ("proofs", "same"),
    ("spaces",),
)
# Applications: from packages below the wall they import only names in __all__.
ABOVE_THE_WALL = (
    ("fits", "gravity", "materials"),
    ("prices",),
    ("pictures", "paper"),
    ("scenes",),
    ("teaching",),
    ("cli",),
    ("__main__",),
)
FLOORS = BELOW_THE_WALL + ABOVE_THE_WALL
# Allowed imports within one layer, with the reason.
NEIGHBOURS: dict[tuple[str, str], str] = {
    ("gravity", "materials"): "constraints and field equations of frames on a grid",
}
# Folders within a package, lowest layer first; folders in one layer do not import each other. Files
# directly in the package are in the folder "."; its __init__ may import all.
INNER_LAYERS: dict[str, tuple[tuple[str, ...], ...]] = {
    "gravity": (
        ("initial_data", "numeric", "reduced", "states"),
        ("theory",),
        ("charges", "motion", "stars"),
        ("perturbed",),
    ),
    "prices": (("effects", "."),),
}
# A longer file holds more than one idea, unless a reason is given here.
LONG: dict[str, str] = {
    "ode/problem.py": "what a solver asks of equations, in one place; a quarter is documentation",
    "support/files.py": "all that is read from text files, and one way to write a whole file",
    # Each of these replaces several files that were always read together.
    "codegen/reading.py": "all that is read: elements, their products, expressions",
    "curves/atlas.py": "charts, the maps between them, and the point that they carry",
    "curves/readout.py": "all that is read off the states of a curve, and what two runs differ by",
    "curves/problem.py": "a curve from its start, which is checked, through charts; for solvers",
    "exact/element.py": "canonical and lazy elements, their interface and the walks through them",
    "exact/arguments.py": "angles and exponents, over one kind of basis",
    "exact/reading.py": "what may be read, and how it is",
    "exact/roots.py": "all of roots: added, found in the field, cleared from denominators",
    "exact/tower.py": "the arithmetic of a field: generators, sums, denominators, factors",
    "geometry/connection.py": "all that a connection can be asked; half is documentation",
    "loops/exact_integral.py": "line integrals in closed form: kinds of integrands, side by side",
    "geometry/forms.py": "the exterior calculus: a form, its algebra and its derivatives",
    "gravity/theory/field_equations.py": "all that field equations can be asked; half is words",
    "geometry/frame.py": "all that a frame can be asked; two thirds are documentation",
    "geometry/real_points.py": "real points: candidates, their walls, and which one is preferred",
    "geometry/components.py": "sparse arrays with their symmetries, products and inverses",
    "geometry/tensor.py": "all that a tensor can be asked; half is documentation",
    "scenes/scene.py": "a scene and its cost; half is documentation",
    "ode/ensemble.py": "an ensemble, what solves it and its members; a third is documentation",
    "ode/engines/taylor.py": "the engine and the integrators that are compiled for it",
    "ode/solution.py": "a solution with its cost, and the outline of what can be solved",
    "ode/system.py": "equations, engines that take them, and the units they are run in",
}
LONGEST = 500
# Counts that should fall: each ceiling is lowered as soon as the count is lower.
CEILINGS = {
    # homes.py and indexing.py need frames for their types, and tensors need both files.
    # A region and its walls hold their frame, which makes them.
    # A frame writes its own file.
    # Two more: the signs in a region, and the remark on a region beside the tensors of a frame.
    "files in rings": 49,
    "inner imports without a reason": 0,
    "percent of Any": 3.6,
    # 17 of these choose steps and precision in proofs; no ball depends on them.
    # 2 are the number of points tried and the distance from a wall, where a region is searched.
    # One separates a pole of the rates from a removable one.
    # One more: the samples that look for pulses between steps.
    # 8: the grids and the search of the frequencies of a hole.
    # One more: the size of the change from which a solution is searched.
    # One more: the steps of Newton's method for jets of solutions.
    # Two more: the steps of Newton's method for closed orbits, and the bits with which it begins.
    # Two standard errors in tests of gravity, and spare rough frequencies of a hole.
    # One: the cells in which the sign of a polynomial is proved.
    # One: the factor of safety of errors from two steps on a grid.
    # One: the number of points whose field equations are evaluated together.
    # One: how far a mark of missing values is from all other values.
    # Three: the size of changes of a motion on the way, and two rules for when to make them.
    # Seven: where rays of a camera end, how far they are followed, and the stripes of its sky.
    # One: when steps pass over narrow changes of rates, which more digits do not show.
    # One more: the places among which the light ring of a hole is found.
    # One more: the random fields from which errors of stresses come.
    # One: after how many steps a run has optimised code, which takes long to compile.
    # One more: the disks on which the tail of a series at a pole is bounded.
    # One more: how many sigma are no longer ascribed to chance.
    # Two more: the fewest atoms of a grain in a plane, and the atoms around each that are compared.
    # One more: the share of a number below which its error is a power of ten.
    "tuned constants": 208,
    # Two more than before: converters of arguments are three files by kind instead of one of 1,000.
    # Two more: kinetic metrics and forces are files of their own.
    # One more: squares that roots hide in circular functions.
    # Two more: what rates divide by, and whether a motion ends where that vanishes.
    # Four of them find the region in which the motion starts.
    # One: changes on the way, which show what a motion makes of roundings.
    # One more: changes at conditions, whose times are compared.
    "files of a first motion": 56,
    # The first root that is read asks for a sign, and the sign for the region of the frame.
    "frames of a first motion": 44,
}
# Lines of code below and above the wall, rounded up to five hundreds, without docstrings, comments
# and blanks. A change that needs more raises a number and states in its commit what users get.
BUDGET = {"below the wall": 56500, "above the wall": 63500}
# What a program that imports the package does not wait for.
LATER = ("sympy", "flint", "mpmath", "numpy", "multiprocessing", "asyncio", "tomllib", "sqlite3")
HEAVY = ("networkx", "scipy", "typer", "rich", "matplotlib", "heyoka", "marimo", "dask", "ase")


def floor_of(part: str) -> int:
    """Number of the layer of a package or module of geomtorsion."""
    for number, names in enumerate(FLOORS):
        if part in names:
            return number
    raise AssertionError(f"geomtorsion.{part} is not in FLOORS; add it")


def upward(own: str, imported: str) -> bool:
    """Whether an import points to a higher layer, or to a neighbour without a reason."""
    if imported == own or (own, imported) in NEIGHBOURS:
        return False
    return floor_of(imported) >= floor_of(own)


def inner_layer(file: str) -> tuple[str, int]:
    """The folder of a file in a package with inner layers, and the number of its layer."""
    package, *folders, _ = file.split("/")
    folder = folders[0] if folders else "."
    for number, names in enumerate(INNER_LAYERS[package]):
        if folder in names:
            return folder, number
    raise AssertionError(f"{file} is in no folder of INNER_LAYERS; move it, or add its folder")


def inner_upward(own: str, imported: str) -> bool:
    """Whether an import within a package points to a higher layer, or to a neighbour."""
    folder, layer = inner_layer(own)
    other, above = inner_layer(imported)
    return folder != other and above >= layer


def test_there_is_something_to_check():
    """The tests below see the whole package."""
    assert len(FILES) > 80
    assert {part_of(file) for file in FILES} >= {"exact", "geometry", "spaces", "pictures", "cli"}


def test_no_arrow_points_up():
    """A file imports only from its own package and from layers below it."""
    wrong = [
        f"{name_of(file)} imports {name[0]}"
        for file in FILES
        for name in (*imported_names(looked_for(file)), *named_modules(tree_of(file)))
        if part_of(file) != "__init__" and upward(part_of(file), name[0])
    ]
    assert not wrong


@pytest.mark.parametrize("package", INNER_LAYERS)
def test_no_arrow_points_up_within_a_package(package: str):
    """A file imports only from its own folder and from folders in lower layers of its package."""
    start = f"{package}/__init__.py"
    inner = {
        file: [one for one in others if one.startswith(f"{package}/") and one != start]
        for file, others in file_imports().items()
        if file.startswith(f"{package}/") and file != start
    }
    assert {inner_layer(file)[0] for file in inner} == {*chain(*INNER_LAYERS[package])}
    assert not [
        f"{file} imports {other}"
        for file, others in inner.items()
        for other in others
        if inner_upward(file, other)
    ]


def test_an_upward_arrow_would_be_found():
    """The check above can fail: it refuses each of these imports."""
    assert upward("exact", "geometry")
    assert upward("geometry", "cli")
    assert upward("ode", "curves")
    assert not upward("cli", "exact")
    assert inner_upward("gravity/theory/lagrangian.py", "gravity/motion/solving.py")
    assert inner_upward("gravity/stars/star.py", "gravity/motion/solving.py")
    assert inner_upward("prices/motions.py", "prices/effects/sensitivity.py")
    assert not inner_upward("gravity/motion/solving.py", "gravity/theory/lagrangian.py")
    with pytest.raises(AssertionError, match="is in no folder of INNER_LAYERS"):
        inner_layer("gravity/lagrangian.py")
    text = 'import_module("geomtorsion.spaces"), import_module(f"geomtorsion.pictures.{name}")'
    assert list(named_modules(ast.parse(text))) == [("spaces",), ("pictures",)]
    with pytest.raises(AssertionError, match="is not in FLOORS"):
        floor_of("cellar")


def test_applications_import_exported_names():
    """Applications import from a package below the wall only names or modules in its __all__."""
    applications = {name for floor in ABOVE_THE_WALL for name in floor}
    wrong = [
        f"{name_of(file)} imports {'.'.join(name)}"
        for file in FILES
        if part_of(file) in applications
        for name in imported_names(looked_for(file))
        if not is_exported(name) and name[0] not in applications
    ]
    assert not wrong


def test_an_import_through_the_wall_would_be_found():
    """The check above can fail: it refuses an inner module and allows an exported one."""
    assert is_exported(("loops", "Loop"))
    assert is_exported(("rigid", "attitude", "product"))
    assert is_exported(("support", "checks", "count"))
    assert not is_exported(("loops", "loop", "Loop"))
    assert not is_exported(("loops", "winding"))


def test_public_names_are_exported_once():
    """geomtorsion exports each name once, and each exported name exists."""
    names = geomtorsion.__all__
    assert len(names) == len(set(names))
    assert {"Frame", "cartan", "levi_civita", "contract", "spaces"} <= set(names)
    for name in names:
        assert getattr(geomtorsion, name) is not None


def test_a_long_file_has_a_reason():
    """A file with more than 500 lines has a reason in LONG."""
    lines = {name_of(file): len(text_of(file).splitlines()) for file in FILES}
    long = {name: count for name, count in lines.items() if count > LONGEST}
    assert long.keys() == LONG.keys(), "give a new one its reason, drop one that is short again"


def test_every_file_has_a_docstring():
    """The first statement of a file is a docstring."""
    assert not [name_of(file) for file in FILES if not ast.get_docstring(tree_of(file))]


def test_packages_import_in_one_direction():
    """Packages do not import each other in rings; nor do those in gravity, materials, teaching."""
    assert not rings(package_imports())
    assert not rings(package_imports(deep=("gravity", "materials", "teaching")))


def test_files_of_two_packages_are_in_no_ring():
    """A ring of imports stays within its package, counting imports for types and in functions."""
    assert not [ring for ring in rings(file_imports()) if len({n.split("/")[0] for n in ring}) > 1]


def test_few_files_need_each_other():
    """Few files are in a ring of imports."""
    found = {min(ring): len(ring) for ring in rings(file_imports())}
    assert sum(found.values()) <= CEILINGS["files in rings"], found


def test_files_can_be_loaded_in_any_order():
    """Rings of imports are only for types or within functions, not while a file is loaded."""
    assert not rings(file_imports(loaded=True))


def test_imports_are_at_the_top():
    """An import inside a function has a comment with its reason, beside or above it."""
    found = {name_of(file): bare_inner_imports(text_of(file), looked_for(file)) for file in FILES}
    found = {name: lines for name, lines in found.items() if lines}
    assert sum(map(len, found.values())) <= CEILINGS["inner imports without a reason"], found


def test_few_types_are_any():
    """The percentage of annotations with `Any` is small."""
    every = [annotation for file in FILES for annotation in annotated_types(looked_for(file))]
    assert len(every) > 5000
    assert 100 * sum(map(has_any, every)) / len(every) <= CEILINGS["percent of Any"]


def test_few_numbers_are_tuned():
    """Few constants at module level are written numbers."""
    found = {name_of(file): tuned_constants(tree_of(file)) for file in FILES}
    found = {name: names for name, names in found.items() if names}
    assert sum(map(len, found.values())) <= CEILINGS["tuned constants"], found


def test_engines_are_known_by_their_protocol():
    """No code tests the class of an engine; only `named.py` does, to compare with its own copy."""
    assert [
        (name_of(file), line)
        for file in FILES
        if name_of(file) != "ode/engines/named.py"
        for line in questions_of_class(tree_of(file))
    ] == []
    code = ast.parse(
        "isinstance(x, Taylor | Stiff)\nisinstance(self.engine, A)\ntype(engine) is B\n"
        "isinstance(engine, type)\nisinstance(x, str)\nmatch x:\n  case RungeKutta(): 0\n"
    )
    assert questions_of_class(code) == [1, 2, 3, 7]


def test_the_code_keeps_to_its_budget():
    """Neither the mathematics nor the applications exceed their budget of code lines."""
    applications = {name for floor in ABOVE_THE_WALL for name in floor}
    counts = dict.fromkeys(BUDGET, 0)
    for file in FILES:
        place = "above the wall" if part_of(file) in applications else "below the wall"
        counts[place] += code_lines(file)
    over = {name: count for name, count in counts.items() if count > BUDGET[name]}
    under = {name: count for name, count in counts.items() if count < BUDGET[name] - 2000}
    assert not over
    assert not under


def test_measures_find_examples():
    """Each measure finds what it should and nothing else."""
    assert rings({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": {"a"}}) == [{"b", "c"}]
    text = "def f():\n    import a\n\n    # heavy\n    import b\n    import c  # late\nimport d\n"
    assert bare_inner_imports(text, walk(ast.parse(text))) == [2]
    text = "def f():\n try:\n  x\n except E:\n  with x:\n   from geomtorsion.a import b\n"
    assert bare_inner_imports(text, walk(ast.parse(text))) == [6]
    assert list(imported_names(walk(ast.parse(text)))) == [("a", "b")]
    code = ast.parse("X: Any = 1\n_Y, z, W = -2 * 3.0, 4, 5e-3\nV = [1]\nS = f(2)\nB = True\n")
    assert tuned_constants(code) == ["X", "_Y", "W"]
    given = ast.parse("def f(a, b: int, *c: list[Any]) -> Any: ...")
    assert [has_any(annotation) for annotation in annotated_types(walk(given))] == [
        False,
        True,
        True,
    ]


# Who draws points: the candidates, and the two files that select real ones among them.
DRAWN_IN = ("exact/candidates.py", "exact/generic_point.py", "geometry/real_points.py")
# Further files that draw numbers, with the reason: none of them is a point of a frame.
DRAWN_ELSEWHERE = {
    "geometry/regions.py": "points between the bounds of a box, which a region returns",
    "loops/brownian.py": "the noise of a random motion",
    "same/matching.py": "turns at which a match begins",
    "exact/polynomials.py": "numbers modulo a prime",
    "exact/square_factors.py": "numbers modulo a prime",
    "fits/motions.py": "noise in an example",
    "gravity/perturbed/trial_fields.py": "the random change of a start, by a seed",
    "materials/crystals/frames.py": "atoms that represent all of a specimen",
    "materials/crystals/local_frames.py": "disturbed neighbours, from which a bound follows",
    "materials/crystals/triangulation.py": "small moves that make a triangulation unique",
    "materials/elasticity/stress_errors.py": "random noise of measured data, by a seed",
    "materials/fields/scattered.py": "points in examples",
    "materials/lines/circuit.py": "the apex of a cone over a circuit",
    "scenes/to_ode.py": "states of a body, at which a rate vanishes",
    "teaching/lab/address.py": "the access code of a page",
}
DRAWING = re.compile(
    r"\bCandidates\(|value_of_name\(|import random|from random|default_rng|RandomState|PCG64"
    r"|sqrt\(PRIMES|[hH]alton|[sS]obol|\bqmc\b|import secrets|urandom|sample=\{"
)


def test_no_other_module_draws_a_point():
    """A generic point comes from the region of a frame, and from nowhere else."""
    drawing = {name_of(file) for file in FILES if DRAWING.search(text_of(file))}
    assert drawing == {*DRAWN_IN, *DRAWN_ELSEWHERE}


@pytest.mark.parametrize(
    "line",
    [
        "point = Candidates(symbols, 2).exact(0)",
        "from random import Random",
        "rng = np.random.default_rng(1)",
        "field = Field(symbols, sample={s: 1 + k for k, s in enumerate(symbols)})",
        "engine = scipy.stats.qmc.Halton(2)",
    ],
)
def test_a_module_that_draws_a_point_would_be_found(line: str):
    """The law above can fail: each way to draw a point is found."""
    assert DRAWING.search(line)


def test_a_first_motion_can_be_followed():
    """From a Kerr geodesic to the end of its solution, few files run and few calls are nested."""
    walked = [sys.executable, "-m", "tests.walked"]
    done = subprocess.run(walked, cwd=ROOT, capture_output=True, text=True, check=True)
    files, frames = map(int, done.stdout.split())
    # The count is of the tested package and has found something.
    assert files > 20
    assert files <= CEILINGS["files of a first motion"]
    assert frames <= CEILINGS["frames of a first motion"]


def test_importing_is_light():
    """Importing the package loads no library; a frame needs sympy and flint, and no other."""
    show = "print(*sorted({name.split('.')[0] for name in sys.modules}))"
    code = f"import sys, geomtorsion; {show}; geomtorsion.Frame; {show}"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    imported, framed = (set(line.split()) for line in done.stdout.splitlines())
    assert "geomtorsion" in imported
    assert not imported & {*LATER, *HEAVY}
    assert {"sympy", "flint", "geomtorsion"} <= framed
    assert not framed & {"multiprocessing", "asyncio", *HEAVY}


def test_a_first_motion_is_light():
    """A motion loads no part of scipy; to load one takes as long as sympy."""
    code = "import sys, geomtorsion; geomtorsion.solve, geomtorsion.geodesic; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    loaded = set(done.stdout.split())
    assert {"geomtorsion.curves", "geomtorsion.ode.solve"} <= loaded
    parts = ("integrate", "interpolate", "linalg", "optimize", "sparse", "spatial", "special")
    assert not loaded & {f"scipy.{part}" for part in parts}


def test_help_is_light():
    """The list of commands needs no library of mathematics; a refused name of a command neither."""
    for argument in ("--help", "--version", "geomtry"):
        code = (
            "import atexit, sys; from geomtorsion.cli import main\n"
            "names = ('sympy', 'flint', 'numpy', 'mpmath')\n"
            "atexit.register(lambda: print('loaded', *(x for x in names if x in sys.modules)))\n"
            f"sys.argv = ['geomtorsion', {argument!r}]; main()"
        )
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=ROOT
        )
        assert done.stdout.splitlines()[-1].split() == ["loaded"], argument


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
    """The top folder of the checkout contains only the expected files and folders."""
    expected = {"pyproject.toml", "README.md", "CHANGELOG.md", "LICENSE"}
    expected |= {"geomtorsion", "tests", "examples"}
    listed = {path.name for path in ROOT.iterdir() if not path.name.startswith(".")}
    made = {"build", "dist", "__pycache__", "PKG-INFO"}  # the last one in a source distribution
    strangers = {name for name in listed - expected - made if not name.endswith("-report")}
    assert not strangers
    assert expected <= listed


def test_what_ci_names_is_there():
    """Each test file that a script of `.ci` names exists."""
    scripts = [file.read_text("utf-8") for file in (ROOT / ".ci").iterdir() if file.is_file()]
    named = {name for text in scripts for name in re.findall(r"\btests/[\w/]+\.py\b", text)}
    assert len(named) > 10
    assert not [name for name in named if not (ROOT / name).exists()]

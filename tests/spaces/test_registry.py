"""The registry: names without imports, lazy loading, and the errors of unknown names."""

import ast
import subprocess
import sys
from importlib import util
from pathlib import Path

import pytest

import geomtorsion as gt
from geomtorsion.errors import FileFormatError, UnknownNameError
from geomtorsion.spaces import load, names, titles
from geomtorsion.spaces.registry import SPACES

WANTED = """
so3 so3_right so3_zxz so3_xyz so3_zyx so3_quaternion r3xso3 flat_polar flat_cylindrical
flat_spherical s2 s3 s7 heisenberg sol sl2r ax_plus_b bianchi_i bianchi_ii bianchi_iii bianchi_iv
bianchi_v bianchi_vi_0 bianchi_vi_h bianchi_vii_0 bianchi_vii_h bianchi_viii bianchi_ix twisted_bar
screw_dislocation edge_dislocation wedge_disclination axial_torsion schwarzschild
schwarzschild_isotropic kerr kerr_kinnersley frw de_sitter goedel
schwarzschild_cartesian schwarzschild_falling kerr_newman taub_nut pp_wave frw_closed frw_open
torsion_bounce kerr_de_sitter_torsion
""".split()


def imported_after(code: str) -> set[str]:
    """Modules that a fresh Python has loaded after running some code; spaces by their names."""
    listing = "import sys; print(*sys.modules)"
    run = subprocess.run(
        [sys.executable, "-c", f"{code}\n{listing}"], capture_output=True, text=True, check=True
    )
    return {module.removeprefix("geomtorsion.spaces.") for module in run.stdout.split()}


def test_all_spaces_are_listed_once() -> None:
    """Every promised space is listed, no name occurs twice, titles are one short line."""
    assert set(WANTED) <= set(names())
    assert len(set(names())) == len(names()) == len(SPACES)
    assert list(titles()) == list(names())
    for title in titles().values():
        assert 5 < len(title) <= 75
        assert "\n" not in title


def test_every_module_of_the_registry_exists_and_has_a_maker() -> None:
    """A line without a file, or a file without `space(name)`, is found without importing."""
    for module in {one.module or one.name for one in SPACES}:
        spec = util.find_spec(f"geomtorsion.spaces.{module}")
        assert spec is not None, module
        assert spec.origin is not None
        tree = ast.parse(Path(spec.origin).read_text(encoding="utf-8"))
        makers = [n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name == "space"]
        assert [[a.arg for a in maker.args.args] for maker in makers] == [["name"]], module


def test_every_file_that_makes_a_space_is_in_the_registry() -> None:
    """Every file that makes a space is listed; otherwise it would never be checked."""
    listed = {one.module or one.name for one in SPACES}
    spec = util.find_spec("geomtorsion.spaces")
    assert spec is not None
    assert spec.origin is not None
    for path in Path(spec.origin).parent.glob("*.py"):
        makes = "def space(name: str)" in path.read_text(encoding="utf-8")
        assert makes == (path.stem in listed), path.stem


def test_names_import_no_space() -> None:
    """Listing loads none of the spaces."""
    code = "import geomtorsion.spaces as s; s.names(); s.titles()"
    modules = {one.module or one.name for one in SPACES}
    assert imported_after(code) & modules == set()


def test_loading_imports_only_that_space() -> None:
    """Loading one space loads no other, and no part of scipy, which takes as long as the rest."""
    modules = {one.module or one.name for one in SPACES}
    loaded = imported_after("import geomtorsion.spaces as s; s.load('kerr')")
    assert loaded & modules == {"kerr"}
    assert "geomtorsion.curves.atlas" in loaded
    assert not {f"scipy.{part}" for part in ("integrate", "linalg", "optimize", "special")} & loaded


@pytest.mark.parametrize(
    ("wrong", "near"),
    [
        ("kerrr", "kerr"),
        ("Schwarzchild", "schwarzschild"),
        ("bianchi-9", "bianchi_"),
        ("so4", "so3"),
    ],
)
def test_unknown_name_lists_near_ones(wrong: str, near: str) -> None:
    """A misspelled name is answered with the nearest ones."""
    with pytest.raises(UnknownNameError, match=rf"{wrong!r}.*Near: .*{near}") as caught:
        load(wrong)
    assert isinstance(caught.value, LookupError)


def test_unknown_name_without_near_ones() -> None:
    """A name without near ones is refused with a reference to the list."""
    with pytest.raises(UnknownNameError, match=r"None is near.*spaces"):
        load("@@@@")


def test_files_are_loaded_by_path(tmp_path):
    """A tetrad file is read by `gt.read` and by `load`, from a text and from a path."""
    file = tmp_path / "plane.toml"
    file.write_text('coordinates = ["r", "phi"]\ncoframe = [[1, 0], [0, "r"]]\n', "utf-8")
    for read in (gt.read, load):
        for path in (file, str(file)):
            space = read(path)
            assert space.name == "plane"
            assert str(space.frame.metric[1, 1]) == "r**2"
    with pytest.raises(FileFormatError, match=r"missing\.toml"):
        load("missing.toml")


def test_a_space_shows_itself():
    """In a terminal a space is shown without LaTeX, in a notebook with the coframe."""
    space = load("so3")
    text = repr(space)
    assert text.startswith("so3: rotations")
    assert space.story in text
    assert "source: P. Fiziev" in text
    assert "\\" not in text
    assert "**so3**" in space._repr_markdown_()
    assert r"\mathrm{d}" in space._repr_markdown_()

"""The site as readers see it: complete and self-contained, with run cells and valid links."""

import html
import re
from pathlib import Path

import pytest

import geomtorsion
from geomtorsion import errors

EXAMPLES = Path(__file__).parents[2] / "examples"

TUTORIALS = (
    "first_tetrad",
    "connections",
    "straightest_and_shortest",
    "which_path",
    "loops_that_do_not_close",
    "from_data",
    "stress",
    "top_and_effects",
    "own_torsion",
    "universe",
    "gravity",
    "same_geometry",
    "accuracy",
)
TASKS = (
    "tetrad_file", "notebook", "classroom", "second_chart", "effect", "space", "exercise", "engine",
    "how_sure_is_a_number", "translate",
)  # fmt: skip
OTHERS = (
    "index", "api/index", "genindex", "gallery/index", "conventions", "errors", "comparison",
    "design", "changes", "cite", "contribute", "licences", "claims", "lesson", "howto/commands",
    "howto/large_tensors", "howto/measured_fields", "howto/dislocation_lines", "howto/scene_file",
    "howto/action",
)  # fmt: skip


def test_pages_are_there(built):
    """Tutorials, tasks and reference pages exist."""
    names = [
        *OTHERS,
        *(f"tutorials/{one}" for one in TUTORIALS),
        *(f"howto/{one}" for one in TASKS),
    ]
    for name in names:
        assert (built / f"{name}.html").is_file(), name


def test_every_example_has_a_page_and_a_picture(built):
    """The page of each example shows its output, and the gallery links to it."""
    gallery = (built / "gallery" / "index.html").read_text("utf-8")
    scripts = [*EXAMPLES.glob("*.py"), *(EXAMPLES / "scenes").glob("*.py")]
    assert len(scripts) >= 32
    links = re.findall(r'<a class="card" href="([^"]+)"><img src="([^"]+)"', gallery)
    assert len(links) == len(scripts)
    for page, picture in links:
        assert (built / "gallery" / picture).stat().st_size > 500, picture
        assert 'id="what-it-prints"' in (built / "gallery" / page).read_text("utf-8")


def test_home_shows_the_page_of_a_class(built):
    """The home page has an exercise with a wrong and a right answer, and the verdict on each."""
    text = (built / "index.html").read_text("utf-8")
    [shown] = re.findall(r'<div class="classroom".*?</template></div>', text, re.DOTALL)
    said = re.findall(r'<div class="(wrong|right)" role="status"><strong>(.*?)</strong>', shown)
    assert [kind for kind, _ in said] == ["wrong", "right"]
    assert "The sign is wrong." in shown
    assert 'value="-cos(phi2)/sin(phi2)"' in shown


def test_home_shows_python_subjects_and_news(built):
    """Code with its result, a card of one sentence for each subject, and five lines of news."""
    text = (built / "index.html").read_text("utf-8")
    python = text.split('id="three-lines-of-python"')[1].split("</section>")[0]
    assert len(re.findall(r'<div class="cell_input', python)) == 2
    assert "b2 = 3.1415926535" in python  # the area of the loop, by Stokes' theorem
    cards = re.findall(r'<div class="card docutils container">(.*?)</div>', text, re.DOTALL)
    assert len(cards) >= 6
    for card in cards:
        title, sentence = re.findall(r"<p>(.*?)</p>", card, re.DOTALL)
        assert 'href="' in title
        assert re.fullmatch(r"[A-Z][^.]*\.", sentence, re.DOTALL), sentence
    news = text.split('id="whats-new"')[1].split("</section>")[0]
    assert news.count("<li>") == 5
    assert 'href="changes.html"' in news
    assert "Unreleased" in (built / "changes.html").read_text("utf-8")


def test_pages_that_errors_name_are_there(built):
    """For each error of the package `error.page` is a page of the site."""
    kinds = [one for one in vars(errors).values() if isinstance(one, type)]
    pages = {one.page for one in kinds if issubclass(one, errors.GeomtorsionError)}
    assert len(pages) >= 6
    assert not [page for page in pages if not (built / f"{page}.html").is_file()]


def test_help_names_pages_by_their_titles(built):
    """Each quoted title in `help(geomtorsion)` is the title of a page."""
    titles = {
        html.unescape(title)
        for page in built.rglob("*.html")
        for title in re.findall(r"<h1>(.*?)<a class", page.read_text("utf-8"))
    }
    named = re.findall(r'"([^"]+)"', " ".join((geomtorsion.__doc__ or "").split()))
    assert len(named) == 3
    assert set(named) <= titles


@pytest.mark.parametrize("name", TASKS)
def test_a_task_is_really_done(built, name):
    """The cells of a task ran without an error, and some of them assert or raise."""
    text = (built / f"howto/{name}.html").read_text("utf-8")
    assert re.search(r'<span class="k">(assert|raise)</span>', text)
    assert '<div class="cell_output' in text
    assert "Traceback" not in text


def test_pages_are_clean(built):
    """The output has no progress bars, no memory addresses and no raw LaTeX."""
    pages = [built / f"tutorials/{name}.html" for name in TUTORIALS]
    pages += [built / f"howto/{name}.html" for name in TASKS]
    for path in [*pages, built / "errors.html"]:
        shown = re.findall(r'<div class="output .*?</div>', path.read_text("utf-8"), re.DOTALL)
        assert shown, path
        text = " ".join(shown)
        for trash in ("Ctrl-C stops", " object at 0x", r"\begin{", "np.True_"):
            assert trash not in text, (path.name, trash)


def test_versions_agree_with_the_checkout(built):
    """The citation has the version in both forms, and the licences name the dependencies."""
    text = (built / "cite.html").read_text("utf-8")
    assert text.count(geomtorsion.__version__) >= 2
    assert "cff-version" in text
    readme = (EXAMPLES.parent / "README.md").read_text("utf-8")
    cited = readme.split("## Citing and licence")[1]
    plain = html.unescape(re.sub(r"<[^>]*>", "", text))
    blocks = re.findall(r"```\w+\n(.*?)\n```", cited, re.DOTALL)
    assert len(blocks) == 1
    assert not [block for block in blocks if block not in plain]
    licences = (built / "licences.html").read_text("utf-8")
    assert all(name in licences for name in ("sympy", "python-flint", "heyoka"))


def test_nothing_is_asked_of_other_hosts_and_links_lead_somewhere(built):
    """Scripts, styles, images and fonts are all local, and all internal links are valid."""
    laws = pytest.importorskip("laws")
    wrong, outside = laws.faults(built.resolve())
    assert not wrong
    assert (built / "links.txt").read_text("utf-8").splitlines() == outside


def test_every_public_name_has_an_entry(built):
    """The inventory of Sphinx lists all names that the packages export."""
    laws = pytest.importorskip("laws")
    inventory = pytest.importorskip("sphinx.util.inventory").InventoryFile
    with (built / "objects.inv").open("rb") as file:
        listed = inventory.load(file, "", lambda base, page: page)
    names = {name for kind, found in listed.items() if kind.startswith("py:") for name in found}
    assert len(names) > 500
    assert not laws.missing_names(names)
    assert laws.missing_names(names - {"geomtorsion.Frame"})


@pytest.mark.parametrize("name", TUTORIALS)
def test_a_tutorial_ends_in_a_check(built, name):
    """Its cells ran without an error, its formulas are MathML, and it has an answer to open."""
    text = (built / f"tutorials/{name}.html").read_text("utf-8")
    assert "<math" in text
    # Commas and full stops of prose stay with the formula before them.
    shown = r'<div class="cell_output.*?</div>\s*</div>\s*</div>'
    prose = re.sub(rf'{shown}|<span class="together">.*?</span>', "", text, flags=re.DOTALL)
    assert not re.search(r"</math>[.,;:]", prose)
    assert "Traceback" not in text
    assert len(re.findall(r'<div class="cell_output', text)) >= 4
    check = text.split('id="check-yourself"')[1]
    assert "<details" in check
    assert "assert" in check

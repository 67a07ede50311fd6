"""The site as a reader has it: complete, closed, every cell run, every link good."""

import re

import pytest

TUTORIALS = ("first_tetrad",)


def test_pages_are_there(built):
    """One for each tutorial, and the reference."""
    for name in ("index", "api/index", "genindex", *(f"tutorials/{one}" for one in TUTORIALS)):
        assert (built / f"{name}.html").is_file(), name


def test_nothing_is_asked_of_other_hosts_and_links_lead_somewhere(built):
    """No script, style, picture or font comes from elsewhere; every link within is good."""
    laws = pytest.importorskip("laws")
    wrong, outside = laws.faults(built.resolve())
    assert not wrong
    assert (built / "links.txt").read_text("utf-8").splitlines() == outside


def test_every_public_name_has_an_entry(built):
    """The inventory that Sphinx writes lists what the packages export."""
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
    """Its cells ran without an error, its formulas are MathML, and an answer is there to open."""
    text = (built / f"tutorials/{name}.html").read_text("utf-8")
    assert "<math" in text
    assert "Traceback" not in text
    assert len(re.findall(r'<div class="cell_output', text)) >= 4
    check = text.split('id="check-yourself"')[1]
    assert "<details" in check
    assert "assert" in check

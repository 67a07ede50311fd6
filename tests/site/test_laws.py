"""Faults that the build refuses: synthetic pages with one fault each."""

import pytest

pytest.importorskip("myst_nb", reason="the extra docs is not installed")
laws = pytest.importorskip("laws")

SOUND = '<p id="here">see <a href="b.html#there">b</a>, <a href="#here">above</a></p>'


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        pytest.param('<script src="https://cdn.example/x.js"></script>', "loads", id="script"),
        pytest.param('<link rel="stylesheet" href="//cdn.example/x.css">', "loads", id="style"),
        pytest.param('<img src="http://example.org/x.png">', "loads", id="picture"),
        pytest.param("<style>@import 'https://example.org/x.css';</style>", "loads", id="import"),
        pytest.param('<p style="background: url(https://example.org/x.png)">', "loads", id="url"),
        pytest.param('<a href="nowhere.html">x</a>', "leads nowhere", id="page"),
        pytest.param('<a href="b.html#nowhere">x</a>', "leads nowhere", id="anchor"),
        pytest.param('<a href="javascript:alert(1)">x</a>', "leads nowhere", id="javascript"),
    ],
)
def test_a_fault_is_found(tmp_path, text, fault):
    """The fault is the only one found, and only after it is added."""
    (tmp_path / "b.html").write_text('<h1 id="there">b</h1>', "utf-8")
    page = tmp_path / "a.html"
    page.write_text(SOUND, "utf-8")
    assert laws.faults(tmp_path) == ([], [])
    page.write_text(SOUND + text, "utf-8")
    (found,), _ = laws.faults(tmp_path)
    assert fault in found


def test_links_to_other_hosts_are_listed(tmp_path):
    """External links are allowed, and the build does not open them."""
    (tmp_path / "a.html").write_text('<a href="https://example.org/">x</a>', "utf-8")
    assert laws.faults(tmp_path) == ([], ["https://example.org/"])


def test_a_style_sheet_may_load_nothing_either(tmp_path):
    """Fonts must be embedded in the sheet."""
    sheet = tmp_path / "a.css"
    sheet.write_text("x { src: url('data:font/woff2;base64,AA') }", "utf-8")
    assert laws.faults(tmp_path) == ([], [])
    sheet.write_text("x { src: url('https://example.org/a.woff2') }", "utf-8")
    assert laws.faults(tmp_path)[0] == ["a.css loads https://example.org/a.woff2"]

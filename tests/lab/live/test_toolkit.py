"""Toolkit: controls as plain HTML, which escape what is typed and bound what comes back."""

from __future__ import annotations

import pytest

from geomtorsion.lab import controls, exercise_controls, tetrad_controls
from geomtorsion.lab.kept import Kept
from geomtorsion.lab.live.toolkit import Form
from geomtorsion.lab.problems import statement
from geomtorsion.lab.settings import PAGE
from geomtorsion.lab.space_info import space_form

HOSTILE = "\"><script>alert(1)</script><img src=x onerror='alert(2)'>"


def test_what_is_typed_is_escaped():
    """In every kind of control, as value and as label."""
    form = Form({"a": HOSTILE, "b": HOSTILE, "c": HOSTILE, "d": HOSTILE, "e": HOSTILE})
    made = form.dictionary(
        {
            "a": form.text(label=HOSTILE),
            "b": form.text_area(label=HOSTILE),
            "c": form.dropdown({HOSTILE: 1, "other": 2}, value="other", label=HOSTILE),
            "d": form.checkbox(label=HOSTILE),
            "e": form.number(0, 9, value=3, label=HOSTILE),
        }
    )
    for control in made.values():
        text = str(control)
        assert "<script" not in text
        assert "<img" not in text
        assert "&lt;script&gt;" in text
    assert made.value == {"a": HOSTILE, "b": HOSTILE, "c": 1, "d": False, "e": 3}


@pytest.mark.parametrize(
    ("given", "value"),
    [("4", 4), ("1e9", 10**9), ("-3", -3), ("2.7", 2.7), ("nan", 3), ("inf", 3), ("x", 3)],
)
def test_a_number_is_the_one_that_is_shown(given: str, value: float):
    """What does not fit is refused by whoever uses it; what is no number leaves the usual one."""
    field = Form({"n": given}).number(0, 9, value=3, label="n")
    assert field.value == value
    assert f'value="{value}"' in str(field)


def test_a_choice_is_one_of_its_list():
    """Anything else is as if nothing was chosen."""
    options = {"one": 1, "two": 2}
    assert Form({"k": "two"}).dropdown(options, value="one", label="k").value == 2
    assert Form({"k": "three"}).dropdown(options, value="one", label="k").value == 1
    nothing = Form({}).dropdown(options, label="k")
    assert nothing.value is None
    assert "<option></option>" in str(nothing)


def test_a_button_counts_by_its_rule():
    """Hints are counted up to the last one, however often the button is pressed."""
    form = Form({"Next hint": "7"})
    stated = statement("1.1")
    assert exercise_controls.next_hint(form, stated).value == stated["hints"] == 3
    assert exercise_controls.next_hint(Form({"Next hint": "<b>"}), stated).value == 0


def test_a_text_is_cut():
    """No text is longer than any request of the page."""
    assert len(Form({"t": "x" * 10**6}).text(label="t").value) == PAGE.request


def test_the_controls_of_the_served_page_are_made_with_it():
    """The same functions; their values come back under the names of the controls."""
    form = Form({"coordinates": "r, phi, z", "1,1": "r^2", "metric": "true", "torsion": "false"})
    facts = space_form("flat_polar")
    names = tetrad_controls.names(form, facts, Kept())
    assert names.value["coordinates"] == "r, phi, z"
    columns = tetrad_controls.coordinates({k: str(text) for k, text in names.value.items()})
    entries = tetrad_controls.entries(form, columns, tetrad_controls.typed(facts, Kept()))
    rows = tetrad_controls.rows({k: str(text) for k, text in entries.value.items()}, 3)
    assert rows == [["1", "0", "0"], ["0", "r^2", "0"], ["0", "0", "1"]]
    offered = tetrad_controls.offered(form, Kept())
    assert offered.value["metric"]
    assert not offered.value["torsion"]
    assert controls.plane(form, facts, Kept()).value == (0, 1)
    fields = exercise_controls.answers(form, statement("6.4"), Kept())
    assert str(fields).count("data-name") == len(statement("6.4")["questions"])

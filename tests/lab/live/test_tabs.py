"""Tabs: what the browser is sent for a form as it stands."""

from __future__ import annotations

import re
from typing import Any

import pytest

from geomtorsion.exercises import names
from geomtorsion.exercises.worker_pool import Json
from geomtorsion.lab import views
from geomtorsion.lab.live.browser import answer as answered
from geomtorsion.lab.live.guides import UNGRADED
from geomtorsion.lab.live.tabs import TABS, TASKS, show
from geomtorsion.lab.tasks import answer, task
from geomtorsion.lab.tetrad import USUAL


class Here:
    """Carries tasks out here and now, and notes which."""

    def __init__(self) -> None:
        self.asked: list[str] = []

    def ask(self, name: str, attached: bytes | None = None, /, **arguments: object) -> Json:
        self.asked.append(name)
        return answer({"task": name, "arguments": arguments})


def shown(tab: str, values: dict[str, str] | None = None, **more: Any) -> Json:
    """A tab for a form with these values."""
    return show({"tab": tab, "values": values or {}, **more}, Here())


@pytest.mark.parametrize("tab", TABS)
def test_a_tab_is_shown_when_it_is_opened(tab: str):
    """A form and a result, tasks whose time is stated, and nothing for the address."""
    runner = Here()
    found = show({"tab": tab, "values": {}}, runner)
    assert 'data-name="' in found["controls"]
    assert "notice" not in found["parts"]["result"]
    assert not any(found["kept"].values())
    assert set(runner.asked) <= {*TASKS[tab], "listing", "hints"}


def test_a_typed_tetrad():
    """Cards for what is typed; a fault beside its entry, while the form stays as it is."""
    values = {"start from": "flat_polar: the plane, orthonormal polar frame", "1,1": "r^2"}
    right = shown(views.TETRAD, values)
    assert 'id="torsion"' in right["parts"]["result"]
    assert right["kept"]["coframe"] == "1|0;0|r^2"
    assert right["kept"]["start"] == "flat_polar"
    wrong = shown(views.TETRAD, values | {"1,1": "<b>rr"})
    assert "&lt;" in wrong["parts"]["fault 1,1"]
    assert "<b>" not in str(wrong["parts"]) + wrong["controls"]
    assert wrong["shape"] == right["shape"]
    assert shown(views.TETRAD, values | {"coordinates": "r, phi, z"})["shape"] != right["shape"]


def test_another_space_begins_anew():
    """What was typed belonged to the other space; what is to be shown stays."""
    values = {"start from": "s2: the sphere of radius R, compass frame", "0,0": "17"}
    values |= {name: str(name == "metric").lower() for name in USUAL}
    kept_on = shown(views.TETRAD, values)
    anew = shown(views.TETRAD, values, changed=["1,1", "start from"])
    assert kept_on["kept"]["coframe"].startswith("17|")
    assert anew["kept"]["coframe"] == ""
    assert anew["kept"]["show"] == "metric"


def test_an_address_of_the_served_page_opens_the_same():
    """Links between the two pages lead to one tetrad, and to one exercise."""
    kept = {"start": "flat_polar", "coframe": "1|0;0|r^3", "exercise": "3.2", "variant": "4"}
    assert shown(views.TETRAD, kept=kept)["kept"]["coframe"] == "1|0;0|r^3"
    found = shown(views.EXERCISES, kept=kept)
    assert found["shape"] == "3.2|4"


@pytest.mark.parametrize("typed", ["3.7", "-1", "2000000000"])
def test_a_variant_that_there_is_not_is_refused(typed: str):
    """It stays in its field, and no other one is shown in its place."""
    values = {"exercise": "1.1 The legs of a coframe", "variant": typed}
    found = shown(views.EXERCISES, values)
    said = found["parts"]["result"]
    assert f"from 0 to 1,000,000,000 was needed, but {typed} came" in said
    assert f'value="{typed}"' in found["controls"]
    assert "statement" not in found["controls"]
    mended = shown(views.EXERCISES, values | {"variant": "3"}, changed=["variant"])
    assert "variant 3" in mended["controls"]


def test_answers_stay_while_another_exercise_is_looked_at():
    """An exercise that is opened again begins with what was typed; else the form counts."""
    values = {"exercise": "1.1 The legs of a coframe", "variant": "0"}
    kept = {"exercise": "1.2", "answer1.1.0.1": "1,1 = 17"}
    again = shown(views.EXERCISES, values, kept=kept, changed=["exercise"])
    assert again["kept"]["answer1.1.0.1"] == "1,1 = 17"
    assert ">1,1 = 17</textarea>" in again["controls"]
    emptied = shown(views.EXERCISES, values | {"q0": ""}, kept=kept, changed=["q0"])
    assert emptied["kept"]["answer1.1.0.1"] == ""


def test_the_list_says_what_needs_numbers():
    """Beforehand, in a part of the list with a heading of its own."""
    found = shown(views.EXERCISES)["controls"]
    here, not_here = found.split('<optgroup label="need numbers: not in this page">')
    numbers = re.compile(r"<option[^>]*>([0-9.]+) ")
    assert numbers.findall(here) == [number for number in names() if number not in UNGRADED]
    assert numbers.findall(not_here.partition("</optgroup>")[0]) == sorted(UNGRADED)


def test_an_answer_is_looked_at_when_it_is_sent():
    """Right and wrong, with what is said about it; nothing before."""
    values = {"exercise": "2.1 One coefficient of the Cartan connection", "q0": "1,2,2 = 1/r"}
    assert "verdict" not in shown(views.EXERCISES, values)["parts"]
    right = shown(views.EXERCISES, values, action="check")
    assert "✓ right" in right["parts"]["verdict"]
    values["q0"] = "2,1,2 = 1/r"
    wrong = shown(views.EXERCISES, values, action="check")
    assert "✗ not right" in wrong["parts"]["verdict"]
    hints = shown(views.EXERCISES, values | {"Next hint": "2"})
    assert hints["parts"]["result"].count("<li>") == 2


def test_loops_and_equations():
    """b of a screw does not depend on the radius; Euler's equations lose their moments naively."""
    space = "screw_dislocation: screw dislocation along z"
    found = shown(views.LOOPS, {"space": space, "radius": "3*R"})
    assert "it has no value" not in found["parts"]["result"]
    assert found["kept"]["radius form"] == "3*R"
    # On the sphere R is its own radius, not that of the circle.
    sphere = shown(
        views.LOOPS,
        {"space": "s2: the sphere of radius R, compass frame", "radius": "R"},
        changed=["space"],
    )
    assert 'value="rho"' in sphere["controls"]
    assert not sphere["kept"]["radius form"]
    beside = shown(views.LOOPS, {"space": space, "centre x": "2"})
    assert "changes along the circle" in beside["parts"]["result"]
    naive = shown(views.TOP, {"variations": "naive: as if there were no torsion"})
    assert "wrong for a body" in naive["parts"]["result"]
    odd = shown(views.TOP, {"Lagrangian L(q, u, t)": "<script>"})
    assert "<script>" not in odd["parts"]["result"] + odd["controls"]
    assert "notice" in odd["parts"]["result"]


def test_the_time_of_a_tab_is_stated():
    """Each tab has tasks with limits of time."""
    assert TABS.keys() == TASKS.keys()
    assert all(task(name).seconds > 0 for names in TASKS.values() for name in names)


def test_odd_requests_are_ours():
    """A tab that is not there, or values that are none, end in no foreign error."""
    nested, listed = '{"tab": "Loops", "values": 3}', '{"tab": "Loops", "values": {"radius": [1]}}'
    for text in (nested, listed, '{"tab": "x"}', "[]", "{", "7", "null", "[" * 9000, "9" * 9999):
        assert "problem" in answered(text), text[:40]

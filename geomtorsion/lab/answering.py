"""answering: the fields in which an exercise is chosen and answered."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any


def exercises(mo: Any, listing: Mapping[str, Any]) -> Any:
    """A list of all exercises."""
    every = {k: v for chapter in listing.get("chapters", {}).values() for k, v in chapter.items()}
    options = {f"{number} {title}": number for number, title in every.items()}
    return mo.ui.dropdown(options, value=next(iter(options), None), label="exercise")


def seed(mo: Any) -> Any:
    """A field for the variant."""
    return mo.ui.number(0, 999_999, 1, value=0, label="variant")


def answers(mo: Any, exercise: Mapping[str, Any]) -> Any:
    """A form with a field for each question; its value comes when it is sent."""
    fields, parts = {}, []
    for number, question in enumerate(exercise.get("questions", ())):
        key = f"q{number}"
        fields[key] = _field(mo, question)
        # Braces are places for fields in the template.
        prompt = question["prompt"].replace("{", "{{").replace("}", "}}")
        how = f'<p class="note">{escape(question["how"])}</p>'
        parts.append(f'<div class="sideways">{prompt}{{{key}}}{how}</div>')
    template = mo.Html(f'<div class="lab">{"".join(parts)}</div>')
    return template.batch(**fields).form(submit_button_label="Check", bordered=False)


def _field(mo: Any, question: Mapping[str, Any]) -> Any:
    label = question["name"] + (f" in {question['unit']}" if question["unit"] else "")
    if question["kind"] == "choice":
        options = {text: key for key, text in question["options"].items()}
        return mo.ui.dropdown(options, label=label)
    if question["kind"] in ("components", "equations"):
        return mo.ui.text_area(label=label, rows=2, full_width=True)
    return mo.ui.text(label=label, full_width=True)


def given(exercise: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, str]:
    """Fields of the form by the names of the questions.

    Examples
    --------
    >>> given({"questions": [{"name": "legs"}]}, {"q0": "1"})
    {'legs': '1'}
    """
    names = [question["name"] for question in exercise["questions"]]
    return {name: str(values.get(f"q{k}") or "") for k, name in enumerate(names)}


def next_hint(mo: Any, exercise: Mapping[str, Any]) -> Any:
    """A button that counts the hints taken."""
    most = exercise.get("hints", 0)
    return mo.ui.button(
        value=0, on_click=lambda taken: min(taken + 1, most), label="Next hint", kind="neutral"
    )

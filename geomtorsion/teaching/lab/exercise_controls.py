"""exercise controls: the list of exercises, and a form with a field for each question."""

from __future__ import annotations

from html import escape
from types import ModuleType
from typing import TYPE_CHECKING

from geomtorsion.teaching.exercises.limits import MOST
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.localized import CHAPTER
from geomtorsion.teaching.lab.query import Query
from geomtorsion.teaching.texts import ENGLISH, Texts, texts

if TYPE_CHECKING:
    from marimo import ui


def exercises(mo: ModuleType, listing: Json, query: Query, language: str = ENGLISH) -> ui.dropdown:
    """A list of all exercises."""
    every = {k: v for chapter in listing.get("chapters", {}).values() for k, v in chapter.items()}
    options = {f"{number} {title}": number for number, title in every.items()}
    chosen = query.one_of("exercise", list(options.values()), next(iter(options.values()), None))
    first = next((title for title, number in options.items() if number == chosen), None)
    return mo.ui.dropdown(options, value=first, label=_text(language)("exercise"))


def chapter(mo: ModuleType) -> str | None:
    """The folder of the teacher's chapter, which the server names with each session."""
    request = mo.app_meta().request
    return request.meta.get(CHAPTER) if request is not None else None


def seed(mo: ModuleType, query: Query, language: str = ENGLISH) -> ui.number:
    """A field for the variant."""
    [number] = query.numbers("variant", [(0, MOST.seed)], [0])
    label = _text(language)("variant")
    return mo.ui.number(0, MOST.seed, 1, value=int(number), label=label)


def variant(typed: float | None) -> float:
    """The requested seed; the exercise refuses a seed that is not an integer, with a message.

    Examples
    --------
    >>> variant(3.0), variant(3.7), variant(None)
    (3, 3.7, 0)
    """
    number = typed or 0
    return int(number) if float(number).is_integer() else number


def answers(mo: ModuleType, exercise: Json, query: Query, language: str = ENGLISH) -> ui.batch:
    """A field for each question; an answer is checked when it is sent."""
    fields, parts = {}, []
    for number, question in enumerate(exercise.get("questions", ())):
        key = f"q{number}"
        typed = query.text(_answer_key(exercise, number), "")
        fields[key] = _field(mo, question, typed, language)
        # Braces mark the fields in the template.
        prompt = question["prompt"].replace("{", "{{").replace("}", "}}")
        how = f'<p class="note">{escape(question["how"])}</p>'
        parts.append(f'<div class="sideways">{prompt}{{{key}}}{how}</div>')
    template = mo.Html(f'<div class="lab">{"".join(parts)}</div>')
    return template.batch(**fields)


def _answer_key(exercise: Json, number: int) -> str:
    """Key of an answer in the address; it belongs to one exercise in one variant only."""
    return f"answer{exercise['number']}.{exercise['seed']}.{number + 1}"


def exercise_query(exercise: Json, first: str, values: Json) -> dict[str, tuple[str, str]]:
    """The values of an exercise that the address stores: its number, variant and answers."""
    if "number" not in exercise:
        return {}
    typed = {
        _answer_key(exercise, k): (str(values.get(f"q{k}") or ""), "")
        for k in range(len(exercise["questions"]))
    }
    return {
        "exercise": (exercise["number"], first),
        "variant": (str(exercise["seed"]), "0"),
        **typed,
    }


def _field(
    mo: ModuleType, question: Json, typed: str, language: str
) -> ui.dropdown | ui.text | ui.text_area:
    # Each keystroke is sent at once, so that the button checks the current text.
    label = question["name"]
    if question["unit"]:
        label = _text(language)("unit", question=label, unit=question["unit"])
    if question["kind"] == "choice":
        options = {text: key for key, text in question["options"].items()}
        first = next((text for text, key in options.items() if typed and key == typed), None)
        return mo.ui.dropdown(options, value=first, label=label)
    if question["kind"] in ("components", "equations"):
        return mo.ui.text_area(value=typed, label=label, rows=2, full_width=True, debounce=False)
    return mo.ui.text(value=typed, label=label, full_width=True, debounce=False)


def given(exercise: Json, values: Json) -> dict[str, str]:
    """Fields of the form by the names of the questions.

    Examples
    --------
    >>> given({"questions": [{"name": "legs"}]}, {"q0": "1"})
    {'legs': '1'}
    """
    names = [question["name"] for question in exercise["questions"]]
    return {name: str(values.get(f"q{k}") or "") for k, name in enumerate(names)}


def next_hint(mo: ModuleType, exercise: Json, language: str = ENGLISH) -> ui.button:
    """A button that counts the hints taken."""
    most = exercise.get("hints", 0)
    label = _text(language)("next")
    return mo.ui.button(
        value=0, on_click=lambda taken: min(taken + 1, most), label=label, kind="neutral"
    )


def check(mo: ModuleType, language: str = ENGLISH) -> ui.run_button:
    """The button that sends the answers."""
    return mo.ui.run_button(label=_text(language)("check"))


def _text(language: str) -> Texts:
    return texts("lab", "form", language)

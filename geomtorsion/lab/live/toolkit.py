"""toolkit: the controls of the page as plain HTML, where there is no marimo to draw them.

The functions that make the controls of the served page get this in its place: they call
`mo.ui.text` and so on, and what comes back has a value and writes itself as an element of a form.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence, Set
from html import escape
from types import ModuleType
from typing import Any

from geomtorsion.lab.settings import PAGE


class Control(ABC):
    """One element of a form: a name, what it says, and what stands in it."""

    def __init__(self, form: Form, label: str, usual: Any) -> None:
        self.form, self.label, self.usual = form, label, usual
        self.name = label

    @property
    def value(self) -> Any:
        """What somebody put there, if it can be put there; else what stands there at first."""
        given = self.form.values.get(self.name)
        return self.usual if given is None else self.read(given)

    def read(self, given: str) -> Any:
        """A text of the browser as a value."""
        return given[: PAGE.request]

    @abstractmethod
    def element(self) -> str:
        """The element, without its label."""

    def __str__(self) -> str:
        return f"<label><span>{escape(self.label)}</span>{self.element()}</label>"

    def attributes(self) -> str:
        """What all elements carry: the name under which the value comes back."""
        return f'data-name="{escape(self.name)}" autocomplete="off"'


class Text(Control):
    """A line, or several."""

    def __init__(self, form: Form, label: str, usual: str, hint: str = "", rows: int = 1) -> None:
        super().__init__(form, label, usual)
        self.hint, self.rows = hint, rows

    def element(self) -> str:
        """A line, or an area of several rows."""
        more = f'{self.attributes()} spellcheck="false" autocapitalize="off"'
        if self.rows > 1:
            return f'<textarea {more} rows="{self.rows}">{escape(self.value)}</textarea>'
        hint = f' placeholder="{escape(self.hint)}"' if self.hint else ""
        return f'<input type="text" {more}{hint} value="{escape(self.value)}">'


class Choice(Control):
    """One of a list: what is shown -> value."""

    def __init__(
        self, form: Form, label: str, options: Mapping[str, Any], first: str | None
    ) -> None:
        super().__init__(form, label, options[first] if first is not None else None)
        self.options, self.first = options, first
        self.heading, self.below = "", frozenset()

    def apart(self, heading: str, values: Set[Any]) -> None:
        """Let the options of these values stand at the end of the list, below a heading."""
        self.heading, self.below = heading, values

    def read(self, given: str) -> Any:
        """The option of this name."""
        return self.options.get(given, self.usual)

    def element(self) -> str:
        """A list that opens."""
        chosen = self.form.values.get(self.name)
        chosen = chosen if chosen in self.options else self.first
        # Nothing chosen is a choice of its own, until something is.
        blank = "<option></option>" if self.first is None else ""
        items, last = "", ""
        for text, value in self.options.items():
            item = f"<option{' selected' if text == chosen else ''}>{escape(text)}</option>"
            items, last = (items, last + item) if value in self.below else (items + item, last)
        if last:
            last = f'<optgroup label="{escape(self.heading)}">{last}</optgroup>'
        return f"<select {self.attributes()}>{blank}{items}{last}</select>"


class Tick(Control):
    """A box that is ticked or not."""

    def read(self, given: str) -> bool:
        """Whether it is ticked."""
        return given == "true"

    def element(self) -> str:
        """The box."""
        ticked = " checked" if self.value else ""
        return f'<input type="checkbox" {self.attributes()}{ticked}>'

    def __str__(self) -> str:
        return f'<label class="tick">{self.element()}<span>{escape(self.label)}</span></label>'


class Number(Control):
    """A number, which should be a whole one between two; whoever uses another refuses it."""

    def __init__(self, form: Form, label: str, usual: int, ends: tuple[int, int]) -> None:
        super().__init__(form, label, usual)
        self.ends = ends

    def read(self, given: str) -> float:
        """The number as it stands there; the usual one where there is none."""
        try:
            number = float(given)
        except ValueError:
            return self.usual
        if not math.isfinite(number):
            return self.usual
        return int(number) if number.is_integer() else number

    def element(self) -> str:
        """A field with its ends."""
        low, high = self.ends
        return (
            f'<input type="number" {self.attributes()} min="{low}" max="{high}" '
            f'value="{self.value}">'
        )


class Press(Control):
    """A button that counts how often it was pressed, as far as its rule lets it."""

    def __init__(self, form: Form, label: str, rule: Callable[[int], int]) -> None:
        super().__init__(form, label, 0)
        self.rule = rule

    def read(self, given: str) -> int:
        """How often the rule lets it count."""
        count = 0
        # No button is pressed so often that anybody notices the end of this.
        for _ in range(min(int(given) if given.isdecimal() and len(given) < 4 else 0, 100)):
            count = self.rule(count)
        return count

    def element(self) -> str:
        """The button."""
        return (
            f'<button type="button" {self.attributes()} value="{self.value}">'
            f"{escape(self.label)}</button>"
        )

    def __str__(self) -> str:
        return self.element()


class Several(Mapping[str, Control]):
    """Controls by name; a template, if there is one, says where each stands."""

    def __init__(self, controls: Mapping[str, Control], template: str = "") -> None:
        self.controls, self.template = dict(controls), template
        for name, control in self.controls.items():
            control.name = name

    @property
    def value(self) -> dict[str, Any]:
        """All values by name."""
        return {name: control.value for name, control in self.controls.items()}

    def __getitem__(self, name: str) -> Control:
        return self.controls[name]

    def __iter__(self) -> Any:
        return iter(self.controls)

    def __len__(self) -> int:
        return len(self.controls)

    def __str__(self) -> str:
        # format_map would look into what is put in the place of a name; nothing is computed here.
        return self.template.format_map({k: str(v) for k, v in self.controls.items()})


class Template:
    """HTML with places for controls."""

    def __init__(self, html: str) -> None:
        self.html = html

    def batch(self, **fields: Control) -> Several:
        """The HTML with these controls in their places."""
        return Several(fields, self.html)


class Form(ModuleType):
    """Stands where the functions that make controls expect marimo.

    values: name of a control -> what the browser says stands in it.

    Examples
    --------
    >>> form = Form({"radius": "<b>"})
    >>> str(form.ui.text(value="1", label="radius")).count("&lt;b&gt;")
    1
    """

    def __init__(self, values: Mapping[str, str]) -> None:
        super().__init__("form")
        self.values = values

    @property
    def ui(self) -> Form:
        """Where marimo keeps its controls."""
        return self

    def Html(self, html: str) -> Template:
        """A piece of HTML."""
        return Template(html)

    def dictionary(self, controls: Mapping[str, Control]) -> Several:
        """Controls by name."""
        return Several(controls)

    def text(self, value: str = "", placeholder: str = "", label: str = "", **_: object) -> Text:
        """A line of text."""
        return Text(self, label, value, placeholder)

    def text_area(self, value: str = "", label: str = "", rows: int = 2, **_: object) -> Text:
        """Several lines of text."""
        return Text(self, label, value, rows=rows)

    def dropdown(
        self, options: Mapping[str, Any], value: str | None = None, label: str = ""
    ) -> Choice:
        """One of a list."""
        return Choice(self, label, options, value)

    def checkbox(self, value: bool = False, label: str = "") -> Tick:
        """A box to be ticked."""
        return Tick(self, label, value)

    def number(
        self, start: int, stop: int, step: int = 1, value: int = 0, label: str = ""
    ) -> Number:
        """A number."""
        return Number(self, label, value, (start, stop))

    def button(
        self, value: int = 0, on_click: Callable[[int], int] = lambda n: n + 1, label: str = "",
        **_: object,
    ) -> Press:  # fmt: skip
        """A button that counts."""
        return Press(self, label, on_click)


def row(controls: Sequence[object]) -> str:
    """Controls side by side.

    Examples
    --------
    >>> row(["a", "b"])
    '<div class="controls"><div>a</div><div>b</div></div>'
    """
    return f'<div class="controls">{"".join(f"<div>{one}</div>" for one in controls)}</div>'

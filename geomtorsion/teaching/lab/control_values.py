"""control values: what a browser sends for controls, checked before marimo reads it."""

from __future__ import annotations

import base64
import json
import math
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from html import unescape
from typing import Any

from geomtorsion.errors import LimitError
from geomtorsion.support.checks import shown

# A control in the output of a cell: its name, its kind and its attributes.
_CONTROL = re.compile(r"object-id='([^']+)'[^>]*><marimo-([a-z-]+)((?:[^>']|'[^']*')*)>")
_ATTRIBUTE = re.compile(r"data-([a-z-]+)='([^']*)'")


def _is_number(value: object) -> bool:
    """Whether a value is a number that a float can hold."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    # A whole number of JSON may have any number of digits.
    return math.isfinite(value) if isinstance(value, float) else abs(value) < sys.float_info.max


def _is_file(value: object) -> bool:
    """Whether a value is a name and a content in base 64."""
    if not (isinstance(value, list) and len(value) == 2 and all(isinstance(x, str) for x in value)):
        return False
    try:
        base64.b64decode(value[1], validate=True)
    except ValueError:
        return False
    return True


# The kinds of values, by the type of the first value of a control.
_KINDS: Mapping[type, tuple[str, Callable[[object], bool]]] = {
    bool: ("true or false", lambda x: isinstance(x, bool)),
    int: ("a finite number", _is_number),
    float: ("a finite number", _is_number),
    str: ("a text", lambda x: isinstance(x, str)),
    list: ("a list", lambda x: isinstance(x, list)),
    dict: ("a table", lambda x: isinstance(x, dict)),
}


@dataclass(frozen=True)
class Control:
    """What a control accepts.

    kind: of the control, such as "slider". first: its first value. options: the words that it
    offers; None if it offers none. inner: key -> name of a control in it. ends: of a slider.
    whole: whether only whole numbers are positions of a slider.

    Examples
    --------
    >>> Control("slider", 75).fault(80), Control("slider", 75).fault("a")
    ('', "slider: expected a finite number, got 'a'")
    """

    kind: str
    first: object
    options: tuple[str, ...] | None = None
    inner: Mapping[str, str] = field(default_factory=dict)
    ends: tuple[float, float] | None = None
    whole: bool = False

    def fault(self, value: object) -> str:
        """The reason why a value does not fit; empty if it fits."""
        if value is None and (
            self.kind == "number" or (self.kind == "radio" and self.first is None)
        ):
            return ""
        expected, fits = _KINDS.get(type(self.first), ("a text", lambda x: isinstance(x, str)))
        chosen: list[Any] = value if isinstance(value, list) else [value]
        fits_more = True
        if self.options is not None:
            expected = f"one of its {len(self.options)} options"
            fits_more = self._is_option(chosen)
        elif self.kind == "file":
            expected = "a list of files, each a name and a content in base 64"
            fits_more = all(map(_is_file, chosen))
        elif fits(value) and self.ends is not None:
            low, high = self.ends
            expected = f"{'a whole number' if self.whole else 'a number'} from {low:g} to {high:g}"
            fits_more = low <= chosen[0] <= high
            fits_more = fits_more and (not self.whole or float(chosen[0]).is_integer())
        if fits(value) and fits_more:
            return ""
        return f"{self.kind}: expected {expected}, got {shown(value)}"

    def _is_option(self, chosen: list[Any]) -> bool:
        """Whether a choice is one of the options; an empty one, if nothing was chosen at first."""
        if len(chosen) > 1 or (not chosen and self.first):
            return False
        return all(isinstance(x, str) and x in (self.options or ()) for x in chosen)


class ValueRefusedError(LimitError):
    """A request with values that no control of the session has.

    status: of the answer.
    """

    def __init__(self, status: int, text: str) -> None:
        super().__init__(text)
        self.status = status


class ControlValues:
    """The controls that each session shows; `record` reads them from what marimo sends."""

    def __init__(self) -> None:
        self.sessions: dict[str, dict[str, Control]] = {}

    def open(self, session: str) -> None:
        """Begin to record the controls of a session."""
        self.sessions.setdefault(session, {})

    def close(self, session: str) -> None:
        """Drop the controls of a session."""
        self.sessions.pop(session, None)

    def record(self, session: str, message: str) -> None:
        """Read the controls in a message to the browser."""
        if "object-id=" in message and session in self.sessions:
            for text in _texts(json.loads(message)):
                self.sessions[session].update(controls_in(text))

    def checked(self, session: str, body: bytes) -> bytes:
        """Values from a browser that fit their controls, as marimo reads them.

        A value of a control that the session does not show is omitted: a control may have been
        replaced while its last value was on its way.

        Raises
        ------
        ValueRefusedError
            The session is not open, the body is not of this form, or a value does not fit.

        Examples
        --------
        >>> values = ControlValues()
        >>> values.open("s")
        >>> values.checked("s", b'{"objectIds": ["a-0"], "values": [3]}')
        b'{"objectIds": [], "values": []}'
        """
        if session not in self.sessions:
            raise ValueRefusedError(404, "This session is not open. Load the page again.")
        try:
            data = json.loads(body, parse_constant=_refused)
        except (ValueError, RecursionError):
            data = None
        names, values = (
            (data.get("objectIds"), data.get("values")) if isinstance(data, dict) else (None, None)
        )
        if (
            not isinstance(names, list)
            or not isinstance(values, list)
            or len(names) != len(values)
            or not all(isinstance(name, str) for name in names)
        ):
            raise ValueRefusedError(400, _FORM)
        controls = self.sessions[session]
        pairs = [pair for pair in zip(names, values, strict=True) if pair[0] in controls]
        for name, value in pairs:
            if wrong := self._fault(controls, name, value):
                raise ValueRefusedError(422, f"{wrong}. Send a value that this control can have.")
        kept = {"objectIds": [name for name, _ in pairs], "values": [value for _, value in pairs]}
        return json.dumps(data | kept).encode() if isinstance(data, dict) else body

    def _fault(self, controls: Mapping[str, Control], name: str, value: object) -> str:
        """The reason why a value does not fit a control and the controls in it."""
        control = controls.get(name)
        if control is None:
            return ""
        wrong = control.fault(value)
        if wrong or not isinstance(value, dict):
            return wrong
        for key, inner in value.items():
            if control.inner and key not in control.inner:
                return f"{control.kind}: expected one of its names, got {shown(key)}"
            if wrong := self._fault(controls, control.inner.get(key, ""), inner):
                return wrong
        return ""


_FORM = (
    'Expected JSON with a list of names and a list of as many values: {"objectIds": [...], '
    '"values": [...]}. Send it in this form.'
)


def _refused(constant: str) -> None:
    """Refuse NaN and the infinities, which are not JSON."""
    raise ValueError(constant)


def _texts(value: Any) -> Iterator[str]:
    """All texts with controls in a message."""
    if isinstance(value, str):
        if "object-id=" in value:
            yield value
    elif isinstance(value, dict):
        for inner in value.values():
            yield from _texts(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _texts(inner)


def controls_in(html: str) -> dict[str, Control]:
    """Name -> control, of the output of a cell.

    Examples
    --------
    >>> controls_in("<x object-id='a-0'><marimo-slider data-initial-value='75'></marimo-slider>")
    {'a-0': Control(kind='slider', first=75, options=None, inner={}, ends=None, whole=False)}
    """
    controls = {}
    for name, kind, attributes in _CONTROL.findall(html):
        read: dict[str, Any] = {key: _value(text) for key, text in _ATTRIBUTE.findall(attributes)}
        options, inner = read.get("options"), read.get("element-ids", {})
        if isinstance(read.get("tabs"), list):
            # The value of tabs is the number of one, as a text.
            options = range(len(read["tabs"]))
        controls[name] = Control(
            kind,
            read.get("initial-value"),
            tuple(map(str, options)) if isinstance(options, list | range) else None,
            # marimo lists pairs of the name and the key.
            {str(key): str(one) for one, key in inner.items()} if isinstance(inner, dict) else {},
            _ends(read) if kind == "slider" else None,
            bool(read.get("steps")),
        )
    return controls


def _ends(read: Mapping[str, object]) -> tuple[float, float] | None:
    """The ends of a slider."""
    start, stop = read.get("start"), read.get("stop")
    return (
        (start, stop) if isinstance(start, int | float) and isinstance(stop, int | float) else None
    )


def _value(text: str) -> object:
    """The value of an attribute, which is JSON."""
    try:
        return json.loads(unescape(text))
    except ValueError:
        return None

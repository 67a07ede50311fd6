"""Record frozen answers: python -m tests.golden.record NAME ..., or "public names".

Run it only for an intended change, and give the reason in the commit. A message with a new text
keeps its first text beside it, and `may_change` must give the reason.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np

import geomtorsion as gt
from tests.golden.calls import VALUES
from tests.golden.refusals import REFUSALS, WORDS_ONLY, refused

HERE = Path(__file__).parent
VALUES_FILE, MESSAGES_FILE, NAMES_FILE = (
    HERE / name for name in ("values.json", "messages.json", "public_names.json")
)
# Names that `geomtorsion` exported until 0.3.0, with the package that exports them now.
MOVED_FILE = HERE / "moved_names.json"


def plain(value: Any) -> Any:
    """The value with only numbers, texts, lists and mappings."""
    if isinstance(value, dict):
        return {str(key): plain(part) for key, part in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    return value if isinstance(value, str | bool | int | float) or value is None else float(value)


def read(file: Path) -> Any:
    """The content of a data file."""
    return json.loads(file.read_text("utf-8"))


def shown(value: Any, margin: str = "") -> str:
    """JSON with one number, one list of numbers or one text per line."""
    inner = margin + " "
    if isinstance(value, dict) and value:
        rows = [f"{inner}{json.dumps(k)}: {shown(v, inner)}" for k, v in value.items()]
        return "{\n" + ",\n".join(rows) + f"\n{margin}}}"
    text = json.dumps(value, ensure_ascii=False)
    if isinstance(value, list) and len(text) > 90:
        return "[\n" + ",\n".join(inner + shown(v, inner) for v in value) + f"\n{margin}]"
    return text


def message(name: str, call: Any, old: dict[str, Any]) -> dict[str, Any]:
    """Class and text of an error; if the text differs from the first one, the first one as well."""
    found = refused(call)
    if "may_change" in old:
        found["may_change"] = old["may_change"]
    first = old.get("first", old.get("text", found["text"]))
    if not same_words(name, found["text"], first):
        found["first"] = first
    return found


def same_words(name: str, one: str, two: str) -> bool:
    """Whether two texts are equal; for some names numbers are ignored."""
    if name in WORDS_ONLY:
        one, two = (re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", text) for text in (one, two))
    return one == two


def main(names: list[str]) -> None:
    """Record the named answers and messages, or all."""
    values, messages = (read(f) if f.exists() else {} for f in (VALUES_FILE, MESSAGES_FILE))
    for name, (tolerance, call) in VALUES.items():
        if not names or name in names:
            values[name] = {"tolerance": tolerance, "value": plain(call())}
    for name, call in REFUSALS.items():
        if not names or name in names:
            messages[name] = message(name, call, messages.get(name, {}))
    VALUES_FILE.write_text(shown({name: values[name] for name in VALUES}) + "\n", "utf-8")
    MESSAGES_FILE.write_text(shown({name: messages[name] for name in REFUSALS}) + "\n", "utf-8")
    if not names or "public names" in names:
        NAMES_FILE.write_text(json.dumps(sorted(gt.__all__), indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])

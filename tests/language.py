"""Language: words that read like a translation, counted in all text of the project.

    python -m tests.language                 a table: packages and patterns
    python -m tests.language exact loops     each hit in these, with file and line

`PATTERNS` names each pattern with its plain form. Text is strings, docstrings and comments of the
package, its English texts in files, the README, the changelog and the site; code does not count.
Names of functions in tests are sentences, so they count as well.
"""

from __future__ import annotations

import io
import re
import sys
import tokenize
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "geomtorsion"

# Name of a pattern: what to look for, and the plain form.
PATTERNS: dict[str, tuple[str, str]] = {
    "was needed, but": (r"\b(?:was|were|is) needed, but\b", '"expected X, got Y. <remedy>"'),
    "is no noun": (
        r"(?<![Tt]here )\b(?:is|are|was|were|be) no (?!(?:more|less|one|longer|\w+er than)\b)",
        '"is not a number"',
    ),
    "what is": (
        r"\b[Ww]hat (?:is|are|was|were|has|had|came|comes|follows|acts|stands|stood)\b(?![^.]*\?)",
        "name the thing",
    ),
    "told, said": (
        r"\b(?:tell|tells|told|telling|say|says|said|saying)\b",
        "report, estimate, state, name",
    ),
    # The text "lie" by itself, or before a bracket, is the name of a function.
    "stands, lies": (
        r"(?!\Alie\Z)\b(?:stands?|stood|standing|lies|lie(?!\()|lay)\b",
        "is, is in, is at",
    ),
    "alone": (r"\balone\b", "only, by itself"),
    "round": (
        r"\bround\b(?! (?:metric|sphere|spheres|body|bodies|trip|trips|bracket|brackets|off|to)\b)",
        "around",
    ),
    ", too": (r", too(?=[.,;:)]| and\b|$)", "also, or nothing at all"),
    "asked for": (r"\basked\s+for\b", "requested"),
    "in the place of": (r"\bin the place of\b|\bin place of\b", "instead of"),
    "anew": (r"\banew\b", "again, restart"),
    "go on": (r"\b(?:[Gg]o|goes|going|went|gone) on\b", "continue, resume"),
    "left out": (r"\b(?:[Ll]eave|leaves|[Ll]eft|leaving) out\b", "omit"),
    "that of": (r"\b[Tt](?:hat|hose) of\b|\b[Tt]he same of\b", "name the thing"),
    "film": (r"\bfilms?\b", "animation"),
    "floor": (
        r"\b(?:lowest|higher|later|lower|same|one) floors?\b|\brooms?\b",
        "package, layer; memory, space",
    ),
    "fronted of": (r"(?:^|[.;:]\s{1,3})Of (?!course)", "put the subject first"),
    # "Has not one component" reads as "has no component".
    "has not one": (
        r"\b(?:has|have|had) not (?:an?|the|one|two|three|four|as|n|its|their|enough|any)\b",
        "does not have",
    ),
    "that they are": (
        r"\b(?:numbers?|fractions?|ratio|arrays?) that (?:they|it) (?:are|is)\b",
        "exact fractions",
    ),
    "drowns": (r"\bdrowns?\b", "is lost in"),
    "how sure": (r"\bhow sure\b(?! (?:is|are)\b)", "certainty of"),
    "wanted": (r"\bWanted (?:relative )?(?:error|accuracy)\b", "requested"),
    "moment of a force": (r"\bmoments? of (?:a )?forces?\b", "torque"),
    "that is none": (r"\b(?:that|which) (?:is|are) none\b", "invalid"),
}
_COMPILED = {name: re.compile(pattern) for name, (pattern, _) in PATTERNS.items()}
_ANY = re.compile("|".join(pattern for pattern, _ in PATTERNS.values()))
# Code within text: fenced blocks, doctests, inline code, formulas, fields of f-strings.
_CODE = re.compile(
    r"^```.*?^```|^ *(?:>>>|\.\.\. ).*?$|`[^`\n]*`|\$[^$]*\$|\{[^{}\n]*\}", re.MULTILINE | re.DOTALL
)
_DOCTEST = re.compile(r"^ *>>>.*?(?=^\s*$|\Z)", re.MULTILINE | re.DOTALL)
_FUNCTION = re.compile(r"^\s*(?:async )?def (\w+)", re.MULTILINE)
_QUOTES = re.compile(r"^[A-Za-z]*(\"\"\"|'''|\"|')")


class Text(NamedTuple):
    """A piece of text and the line on which it begins."""

    line: int
    text: str


class Hit(NamedTuple):
    """A pattern, where it occurs, and the words around it."""

    file: Path
    line: int
    pattern: str
    words: str


def python_texts(source: str) -> Iterator[Text]:
    """Strings and comments of Python code; adjacent parts of one kind are one text.

    Examples
    --------
    >>> [one.text for one in python_texts('a = "x " "y"  # z\\n# w\\nb = 1')]
    ['x y', 'z w']
    """
    kind, line, parts = 0, 0, list[str]()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        found = ""
        if token.type == tokenize.STRING:
            opening = _QUOTES.match(token.string)
            assert opening
            found = token.string[opening.end() : -len(opening[1])]
        elif token.type == tokenize.COMMENT:
            found = token.string.lstrip("#").strip() + " "
        elif tokenize.tok_name[token.type] == "FSTRING_MIDDLE":
            found = token.string
        elif token.type == tokenize.NL or (token.type, kind) == (
            tokenize.NEWLINE,
            tokenize.COMMENT,
        ):
            continue
        new = tokenize.COMMENT if token.type == tokenize.COMMENT else tokenize.STRING
        if not found or new != kind:
            if parts:
                yield Text(line, "".join(parts).strip())
            kind, line, parts = (new, token.start[0], []) if found else (0, 0, [])
        if found:
            parts.append(found)
    if parts:
        yield Text(line, "".join(parts).strip())


def name_texts(source: str) -> Iterator[Text]:
    """Names of functions as words.

    Examples
    --------
    >>> list(name_texts("def test_what_is_told(): ..."))
    [Text(line=1, text='test what is told')]
    """
    for found in _FUNCTION.finditer(source):
        yield Text(source.count("\n", 0, found.start(1)) + 1, found[1].strip("_").replace("_", " "))


def prose(text: str) -> str:
    """Text without the code in it, with its line numbers unchanged."""
    without = text
    for code in (_DOCTEST, _CODE):
        without = code.sub(lambda found: "x" + "\n" * found[0].count("\n"), without)
    return "\n".join(line.strip() for line in without.split("\n"))


def hits_of(file: Path) -> list[Hit]:
    """All occurrences of all patterns in a file."""
    source = file.read_text("utf-8")
    texts = [*python_texts(source)] if file.suffix == ".py" else [Text(1, source)]
    if file.is_relative_to(ROOT / "tests") or file.name.startswith("test_"):
        texts += name_texts(source)
    found: list[Hit] = []
    for line, text in texts:
        plain = prose(text)
        # A phrase may continue on the next line.
        row_of_words = plain.replace("\n", " ")
        if not _ANY.search(row_of_words):
            continue
        for name, pattern in _COMPILED.items():
            for match in pattern.finditer(row_of_words):
                row = line + plain.count("\n", 0, match.start())
                words = plain[max(match.start() - 50, 0) : match.end() + 50]
                found.append(Hit(file, row, name, " ".join(words.split())))
    return found


def places() -> dict[str, list[Path]]:
    """The files of each package, support files, README, changelog, site, examples and tests."""
    found: dict[str, list[Path]] = {}
    for file in sorted([*PACKAGE.rglob("*.py"), *PACKAGE.rglob("languages/en/*.toml")]):
        parts = file.relative_to(PACKAGE).parts
        found.setdefault(parts[0] if len(parts) > 1 else "support files", []).append(file)
    site = ROOT / "examples" / "site"
    pages = [x for x in sorted(site.rglob("*")) if x.suffix in (".md", ".rst", ".py")]
    found["site"] = [file for file in pages if file.parent.name != "pages"]
    found["README"], found["CHANGELOG"] = [ROOT / "README.md"], [ROOT / "CHANGELOG.md"]
    found["examples"] = sorted((ROOT / "examples").glob("*.py"))
    # This module and its test name each pattern.
    own = {Path(__file__), ROOT / "tests" / "test_language.py"}
    found["tests"] = sorted(set((ROOT / "tests").rglob("*.py")) - own)
    return found


@cache
def counts() -> dict[str, Counter[str]]:
    """Number of occurrences of each pattern in each place."""
    return {
        name: Counter(hit.pattern for file in files for hit in hits_of(file))
        for name, files in places().items()
    }


def main(wanted: list[str]) -> None:
    """Print the table, or the hits in some places."""
    for name in wanted:
        for file in places()[name]:
            for hit in hits_of(file):
                print(f"{hit.file.relative_to(ROOT)}:{hit.line}: [{hit.pattern}] {hit.words}")
    if not wanted:
        found = counts()
        for name, one in found.items():
            print(f"{name:15} {one.total():5}  {dict(one.most_common())}")
        total = sum(found.values(), Counter[str]())
        print(f"{'all':15} {total.total():5}  {dict(total.most_common())}")


if __name__ == "__main__":
    main(sys.argv[1:])

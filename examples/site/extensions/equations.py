"""equations: mathematics as docstrings write it, in LaTeX; lines of it, or pieces in a sentence."""

from __future__ import annotations

import re

from geomtorsion.errors import ExpressionError
from geomtorsion.pictures.formula import mathml
from geomtorsion.pictures.latex import equation_latex
from geomtorsion.pictures.text import GREEK, greek_words

FUNCTIONS = "sin cos tan cot sinh cosh tanh exp log ln det arg tr atan2 grad sn cn dn".split()
# Functions without a command in LaTeX.
_OPERATORS = ("tr", "atan2", "grad", "sn", "cn", "dn")
# A part that is set already is one letter of the private use area until the rest is set.
_FIRST_PRIVATE = 0xE000
_REWRITTEN = (
    (re.compile(r"\bGamma_bar"), "Γ̄"),
    (re.compile(r"\b([RD])_bar"), "\\1̄"),
    (re.compile(r"\^(-\w+)"), r"^{\1}"),
    (re.compile(r"\^\(((?:[^()]|\([^()]*\))*)\)"), r"^{\1}"),
    (re.compile(r"([_^])(mu|nu|rho) (mu|nu|rho)\b"), r"\1{\2 \3}"),
    (re.compile(r"\bdelta-bar "), "δ̄ "),
    (re.compile(r"(?<=[\w)]) x (?=[A-Z(v])"), " × "),
    (re.compile(r" \. "), " ⋅ "),
    (re.compile(r"\b([A-Za-z]|phi|theta)(\d)\b(?!\()(?![^{}]*\})"), r"\1_\2"),
    (re.compile(r"\bpartial(?=_)"), "∂"),
    (re.compile(r"(?<![\w)\]}])\*(?=\w)"), "⋆"),
    (re.compile(r"\bsqrt\|([^|]*)\|"), r"√(|\1|)"),
    (re.compile(r"(?<=\s)\^(?=\s)"), "∧"),
    (re.compile(r"\b(?:closed|loop) integral(?: of)?\b"), "∮"),
    (re.compile(r"\bintegral(?: of)?(?=_|\b)"), "∫"),
    (re.compile(r"\bsum(?: of)?(?=_)"), "∑"),
    (re.compile(r"\bsqrt\b"), "√"),
    (re.compile(r"\beps(?=_|\b)"), "ε"),
    (re.compile(r"\bpi\b"), "π"),
    (re.compile(r"\.\.\."), "…"),
    (re.compile("->"), "→"),
    (re.compile("!="), "≠"),
    (re.compile("<="), "≤"),
    (re.compile(">="), "≥"),
    (re.compile(r"\*"), " "),
)  # fmt: skip
_LETTERS = "|".join(sorted(GREEK, key=len, reverse=True))
_DIFFERENTIAL = re.compile(rf"\bd(?!n u)({_LETTERS}|[a-zA-Z])(?=[\^_\s,;.)/]|$)")
_FUNCTION = re.compile(rf"\b({'|'.join(FUNCTIONS)})\b")
_PRIVATE = re.compile("[\ue000-\uf8ff]")
_GREEK_BASE = re.compile(rf"(?<![A-Za-z\\])({_LETTERS})(?=[_^'0-9(\s,;.)/]|$)")
_GREEK_INDEX = re.compile(rf"([_^])({_LETTERS})(?![a-z])")
_TWO_INDICES = re.compile(r"([_^])\{(\w)\}\1\{(\w)\}")
_CAPITALS = {"Γ": r"\Gamma ", "Ω": r"\Omega ", "Φ": r"\Phi "}
_WORD = re.compile(r"[a-z]{2,}|[A-Z][a-z]+|a|A|I")
_NAME = re.compile(
    # Names of code, bars and abbreviations, which are not letters with indices.
    r"\b[a-z]{3,}_(?:[a-z]{3,}|[A-Z])|_[A-Z]{2}|_in_|\b(?!Gamma_|R_|D_)\w+_bar\b|\^vee|"
    r"[A-Z]'s|\"|[`\[][A-Za-z]{4,}|\.py|[0-9]{4}\]"
)
# A word with a hyphen, as one-forms, and a possessive, as Newton's.
_JOINED = re.compile(r"(?!delta-)[A-Za-z]{3,}-[a-z]{3,}|[A-Za-z]{3,}'s?")
_SIGNS = re.compile(r"[=^_']|->")
_SOURCE = re.compile(r"\s{2,}(?=[\[(])|\s+(?=\[[A-Z][A-Za-z]+[0-9]{4})")
# More words than this in a line make it a sentence.
_MOST_WORDS = 4


def latex_of(text: str) -> str | None:
    """Plain mathematics in LaTeX, or None where it cannot be read."""
    for pattern, new in _REWRITTEN:
        text = pattern.sub(new, text)
    text = _GREEK_INDEX.sub(lambda found: f"{found[1]}{{{GREEK[found[2]]}}}", text)
    text = _TWO_INDICES.sub(r"\1{\2 \3}", text)
    kept: list[str] = []

    def keep(latex: str) -> str:
        kept.append(latex)
        return chr(_FIRST_PRIVATE + len(kept) - 1)

    def differential(found: re.Match[str]) -> str:
        letter = GREEK.get(found[1], found[1])
        return keep(r"\mathrm{d}" + letter)

    text = _DIFFERENTIAL.sub(differential, text)

    def function(found: re.Match[str]) -> str:
        name = found[1]
        return keep(rf"\operatorname{{{name}}} " if name in _OPERATORS else rf"\{name} ")

    text = _FUNCTION.sub(function, text)
    text = _GREEK_BASE.sub(lambda found: GREEK[found[1]], greek_words(text))
    latex = _PRIVATE.sub(lambda found: kept[ord(found[0]) - _FIRST_PRIVATE], equation_latex(text))
    latex = latex.replace("∑", r"\sum ").replace("∫", r"\int ").replace("∮", r"\oint ")
    latex = re.sub(r"√\(([^()]*)\)", r"\\sqrt{\1}", latex).replace(";  ", r";\quad ")
    latex = latex.replace(",  ", r",\quad ")
    for letter, name in _CAPITALS.items():
        latex = latex.replace(letter, name)
    try:
        mathml(latex)
    except ExpressionError:
        return None
    return latex


def is_word(token: str) -> bool:
    """Whether a token is a word of prose, perhaps with a stop."""
    bare = token.strip(",.;:()")
    known = bare in FUNCTIONS or bare in GREEK or bare in ("sqrt", "eps", "integral")
    is_prose = _WORD.fullmatch(bare) or (
        _JOINED.fullmatch(bare) and bare.split("'")[0] not in GREEK
    )
    return bool(is_prose) and not known and not _DIFFERENTIAL.fullmatch(bare)


def whole_line(line: str) -> tuple[str, str] | None:
    """A line that is an equation in LaTeX, and its source; None for a sentence."""
    body, *source = _SOURCE.split(line.strip(), maxsplit=1)
    tokens = body.split()
    words = [token for token in tokens if is_word(token)]
    if not tokens or len(words) > _MOST_WORDS or is_word(tokens[0]) or "=" not in tokens:
        return None
    if _NAME.search(body) or any(word.endswith((".", ":")) for word in words):
        return None
    latex = latex_of(body.rstrip(".,;: "))
    return None if latex is None else (latex, "".join(source))


def pieces(line: str) -> list[tuple[str, str]]:
    """A sentence as pairs: ("text", unchanged) or ("math", LaTeX), blanks between them."""
    found: list[tuple[str, str]] = []
    run: list[str] = []
    for token in [*line.split(), "end"]:
        if not is_word(token):
            run.append(token)
            # A colon ends a formula, and another one may follow.
            if token.endswith((":", ";")):
                found += _piece(" ".join(run))
                run = []
            continue
        if run:
            found += _piece(" ".join(run))
            run = []
        found.append(("text", token))
    return found[:-1]


def _piece(text: str) -> list[tuple[str, str]]:
    body = text.rstrip(",.;:")
    if body.endswith((" +", " -")):
        # The last term is in words.
        return [*_piece(body[:-2]), ("text", body[-1])]
    halves = sum(body.endswith(sign) or body.startswith(sign) for sign in ("=", "+", "-", "/"))
    even = all(body.count(a) == body.count(b) for a, b in ("()", "[]", "{}"))
    if halves or not even or not _SIGNS.search(body) or _NAME.search(body):
        return [("text", text)]
    latex = latex_of(body)
    return [("text", text)] if latex is None else [("math", latex + "\0" + text[len(body) :])]

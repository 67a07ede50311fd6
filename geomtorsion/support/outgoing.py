"""Outgoing: text from outside, made harmless for its output format.

One function for each target. JSON is escaped by `json.dumps`.
"""

from __future__ import annotations

import cmath
import logging
import math
import re
import sys
import unicodedata
import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from html import escape
from typing import TextIO

# Characters that a terminal obeys or hides: controls, and marks that turn the direction of writing.
_UNSEEN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]")
# Bold, faint, colours and their end: all that commands themselves write to a terminal.
_STYLE = re.compile("\x1b\\[(?:0|1|2|3[0-7]|9[0-7])m")
# Special characters of LaTeX -> the commands that show them in a formula.
_LATEX = {
    "\\": r"\backslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%",
    "^": r"\hat{}", "_": r"\_", "~": r"\sim{}",
}  # fmt: skip
# An error below this share of the number is written as a power of ten beside its many digits.
_MANY = 1e-6
# Characters that start a formula in spreadsheets.
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def terminal_text(text: str, *, styled: bool = True) -> str:
    r"""Text without characters that a terminal obeys, hides or writes backwards; these are escaped.

    styled: bold and colours stay.

    Examples
    --------
    >>> print(terminal_text("a\x1b]0;b\x07\n\x1b[1mc\x1b[0m", styled=False))
    a\x1b]0;b\x07
    \x1b[1mc\x1b[0m
    """
    if not _UNSEEN.search(text):
        return text
    styles = _STYLE.findall(text) if styled else []
    parts = _STYLE.split(text) if styled else [text]
    written = [_UNSEEN.sub(lambda sign: ascii(sign[0])[1:-1], part) for part in parts]
    return "".join(part + style for part, style in zip(written, [*styles, ""], strict=True))


def size_text(value: float, digits: int = 1) -> str:
    """The size of an error or a difference; zero is 0, never 0e+00.

    Examples
    --------
    >>> size_text(4.8e-17), size_text(0.0), size_text(2e-9, 0)
    ('4.8e-17', '0', '2e-09')
    """
    return f"{value:.{digits}e}" if value else "0"


def duration_text(seconds: float) -> str:
    """A duration with three digits, in the unit that a reader expects.

    Examples
    --------
    >>> duration_text(75.0), duration_text(0.00125), duration_text(4e-7)
    ('75 s', '1.25 ms', '0.4 us')
    """
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e6:.3g} us"


def number_text(value: complex, error: float, most: int = 15) -> str:
    """A number with the digits that its error allows; 0 where it is not larger than its error.

    Examples
    --------
    >>> number_text(0.123456789, 2e-5), number_text(7e-16, 5e-15), number_text(1.0, 5e-15)
    ('0.12346', '0', '1')
    """
    if not cmath.isfinite(value) or not math.isfinite(error):
        return f"{value:.{most}g}"
    if abs(value) <= error:
        return "0"
    # One digit beyond the first that is uncertain.
    allowed = math.log10(abs(value) / error) + 1 if error else most
    return f"{value:.{max(1, min(most, round(allowed)))}g}"


def measured_text(
    values: float | Sequence[float], errors: float | Sequence[float], unit: str = ""
) -> str:
    """A measured number or vector with its error, both rounded by the error, and its unit.

    The error has two digits, and the number ends at the same place. One error of all components
    follows the vector. Without an error (0) six digits appear; an error of NaN is unknown.

    Examples
    --------
    >>> measured_text(0.31416, 0.0123, "nm"), measured_text(2.5, 0.0, "nm")
    ('0.314 +- 0.012 nm', '2.5 nm')
    >>> measured_text([-2.19047, 14.6524], [22.0, 31.0], "um"), measured_text([1.0, 0.0], 2e-9)
    ('(-2 +- 22, 15 +- 31) um', '(1, 0) +- 2.0e-09')
    >>> measured_text(3.2e-9, 4.1e-10, "m"), measured_text(1.5, math.nan)
    ('(3.20 +- 0.41)e-09 m', '1.5, error unknown')
    """
    is_vector = isinstance(values, Sequence)
    numbers = list(values) if isinstance(values, Sequence) else [values]
    given = list(errors) if isinstance(errors, Sequence) else [errors] * len(numbers)
    power = _power_of_ten(numbers, given)
    size = 10.0**power
    rows = [_rounded(x / size, e / size) for x, e in zip(numbers, given, strict=True)]
    if len(set(given)) == 1:
        text = ", ".join(number for number, _ in rows)
        text = (f"({text})" if is_vector else text) + rows[0][1]
        text = f"({text})" if power and (not is_vector or rows[0][1]) else text
    else:
        text = f"({', '.join(number + error for number, error in rows)})"
    text += f"e{power:+03d}" if power else ""
    return f"{text} {unit}" if unit else text


def _power_of_ten(numbers: Sequence[float], errors: Sequence[float]) -> int:
    """The power of ten of numbers with errors; 0 where they are written without one."""
    scale = max((abs(x) for x in (*numbers, *errors) if math.isfinite(x)), default=0.0)
    power = math.floor(math.log10(scale)) if scale else 0
    # Numbers of everyday sizes need no power of ten, and numbers of many digits choose their own.
    rough = [e for e in errors if _MANY * scale < e < math.inf]
    return 0 if not rough or (-4 <= power < 6 and min(rough) >= _MANY) else power


def _rounded(value: float, error: float) -> tuple[str, str]:
    """A number with the digits that its error allows, and the error as it follows."""
    if error == 0:
        return f"{value:.6g}", ""
    if not (math.isfinite(error) and math.isfinite(value)):
        return f"{value:.6g}", ", error unknown"
    # The rounded error decides: 0.0996 has the digits of 0.10.
    places = max(0, 1 - math.floor(math.log10(float(f"{error:.1e}"))))
    if error < _MANY * abs(value) or error < _MANY:
        return number_text(value, error), f" +- {size_text(error)}"
    number = f"{value:.{places}f}"
    number = number if float(number) else number.lstrip("-")
    return number, f" +- {error:.{places}f}"


def count_text(number: int, noun: str) -> str:
    """A number of things, in the singular for one.

    Examples
    --------
    >>> count_text(1, "node"), count_text(12000, "line"), count_text(0, "circuit")
    ('1 node', '12,000 lines', '0 circuits')
    """
    return f"{number:,} {noun}{'s' * (number != 1)}"


def one_line(text: str) -> str:
    r"""Text in one line, without control characters.

    Examples
    --------
    >>> one_line("a\r\n\\input{b}\u2028c\0")
    'a \\input{b} c'
    """
    kept = (" " if unicodedata.category(x) in ("Cc", "Cs", "Zl", "Zp") else x for x in text)
    return " ".join("".join(kept).split())


def latex_comment(text: str) -> str:
    r"""A line of comment in LaTeX.

    Examples
    --------
    >>> latex_comment("a\n\\input{b}")
    '% a \\input{b}'
    """
    return f"% {one_line(text)}"


def latex_letters(text: str) -> str:
    r"""Letters of a name in a formula of LaTeX: nothing in it is obeyed.

    Examples
    --------
    >>> latex_letters("mass"), latex_letters("a\\input{b}")
    ('mass', 'a\\backslash{}input\\{b\\}')
    """
    return "".join(_LATEX.get(sign, sign) for sign in one_line(text))


# Commands of LaTeX, and of MathJax in notebooks, that read, write, define or lead away.
_ACTING = re.compile(
    r"\\(?=(?:input|include\w*|import|open\w*|read\w*|write\w*|immediate|special|[egx]?def|let"
    r"|catcode|csname|(?:re)?newcommand|require\w*|usepackage|verb\w*|lstinputlisting|url|href|html\w+"
    r"|class|style|cssId|unicode|bbox|loop|end(?:input|csname))(?![a-zA-Z]))"
)


def latex_formula(text: str) -> str:
    r"""A formula in LaTeX, without its dollar signs, whose names came from outside.

    Commands with a visible effect stay, as in the symbol "\\bar{x}".

    Examples
    --------
    >>> latex_formula("\\bar{x} + \\input{b}$")
    '\\bar{x} + \\backslash{}input{b}\\$'
    """
    text = re.sub(r"(?<!\\)\$", r"\\$", _UNSEEN.sub(" ", text))
    # HTML around a formula takes < and a letter for a tag.
    text = re.sub("<(?=[A-Za-z/!?])", "< ", text)
    return _ACTING.sub(lambda _: r"\backslash{}", text)


def markdown_text(text: str) -> str:
    r"""Text in Markdown: no markup, HTML, link or formula.

    Examples
    --------
    >>> print(markdown_text("a *b* [c](d) <i> $x$"))
    a \*b\* \[c\]\(d\) &lt;i&gt; \$x\$
    """
    marked = re.sub(r"([\\`*_{}\[\]()#+!|$~-])", r"\\\1", one_line(text))
    return escape(marked, quote=False)


def html_text(text: str) -> str:
    r"""Text in HTML, and between the quotes of an attribute.

    Examples
    --------
    >>> html_text('<b title="c">'), html_text("a\x1b[2J")
    ('&lt;b title=&quot;c&quot;&gt;', 'a\\x1b[2J')
    """
    return escape(terminal_text(text, styled=False))


def mathematica_comment(text: str) -> str:
    """A comment in Mathematica, whose comments can hold others.

    Examples
    --------
    >>> mathematica_comment("a *) Quit[] (* b")
    '(* a * ) Quit[] ( * b *)'
    """
    # A bracket or star at either end would join the marks of the comment.
    inner = one_line(text).replace("(*", "( *").replace("*)", "* )").replace("(*", "( *")
    return f"(* {inner} *)"


def python_text(text: str) -> str:
    r"""Text inside a docstring of Python.

    Examples
    --------
    >>> python_text('a\"\"\"\nimport os\\')
    "a''' import os/"
    """
    return one_line(text).replace("\\", "/").replace('"', "'")


def json_number(value: float) -> float | None:
    """A number as a double, or None where JSON has no such number.

    Examples
    --------
    >>> json_number(0.5), json_number(float("inf")), json_number(float("nan"))
    (0.5, None, None)
    """
    double = float(value)
    return double if math.isfinite(double) else None


def csv_cell(text: str) -> str:
    """Text in a cell of a CSV file, which no spreadsheet takes for a formula.

    Examples
    --------
    >>> csv_cell("=1+1"), csv_cell("-1"), csv_cell("b1")
    ("'=1+1", "'-1", 'b1')
    """
    return f"'{text}" if text.startswith(_FORMULA) else text


def figure_text(text: str) -> str:
    r"""Text in a figure of matplotlib, which sets text between two $ as mathematics.

    Examples
    --------
    >>> figure_text("a $\\frac$"), figure_text("b")
    ('a \\$\\frac\\$', 'b')
    """
    return text.replace("$", r"\$")


class PlainStream:
    """A stream that removes control sequences of terminals except bold and colours.

    All output of a command passes through it: names, titles and messages hold text of files.
    """

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream
        self.encoding = stream.encoding
        self.errors = stream.errors

    def write(self, text: str) -> int:
        """Write text, with such signs written out."""
        self.stream.write(terminal_text(text))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Write lines."""
        for line in lines:
            self.write(line)

    def flush(self) -> None:
        """Write the waiting text."""
        self.stream.flush()

    def isatty(self) -> bool:
        """Whether it is a terminal."""
        return self.stream.isatty()

    def fileno(self) -> int:
        """Number of the file."""
        return self.stream.fileno()


@contextmanager
def plain_streams() -> Iterator[None]:
    """A block in which standard output and standard error are plain."""
    output, errors = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = PlainStream(output), PlainStream(errors)  # type: ignore[assignment]
    try:
        yield
    finally:
        sys.stdout, sys.stderr = output, errors


@contextmanager
def quiet_libraries() -> Iterator[None]:
    """A block in which libraries that read a file do not warn or log; our errors name the file."""
    handler = logging.NullHandler()
    loggers = [logging.getLogger(name) for name in ("tifffile", "rsciio", "PIL", "ase")]
    for logger in loggers:
        # Python prints a record that has no handler; handlers of the user still get each record.
        logger.addHandler(handler)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        for logger in loggers:
            logger.removeHandler(handler)


def moving(stream: TextIO) -> TextIO:
    """The stream behind a plain one: for a bar, which moves on the terminal."""
    return stream.stream if isinstance(stream, PlainStream) else stream

"""Forms: one answer written in different ways, at random."""

from __future__ import annotations

from random import Random

import sympy as sp

from geomtorsion.pictures.text import expression_text
from geomtorsion.teaching.exercises.answers import answer_text
from geomtorsion.teaching.exercises.question import Question, shown_name


def another_form(question: Question, value, draw: Random) -> str:
    """A value as an answer, in another form than the library writes."""
    if question.kind == "choice":
        key = value[()]
        return draw.choice((key, key.upper(), f" {key} ", question.options.get(key, key)))
    if question.kind == "number":
        return number_form(question, value, draw)
    if question.kind == "equations":
        return equations_form(question, value, draw)
    if not question.shape:
        return expression_form(value.get((), sp.S.Zero), question, draw)
    pairs = list(value.items())
    draw.shuffle(pairs)
    if not pairs:
        return draw.choice(("0", zero_component(question)))
    brackets = draw.choice(("{}", "T[{}]", "Gamma_{}", "({})"))
    return draw.choice(("; ", "\n", " ;")).join(
        f"{brackets.format(','.join(str(k + 1) for k in key))} = "
        f"{expression_form(x, question, draw)}"
        for key, x in pairs
    )


def zero_component(question: Question) -> str:
    """One component that is zero."""
    return ",".join("1" for _ in question.shape) + " = 0"


def expression_form(expr, question: Question, draw: Random) -> str:
    """An expression rewritten once or twice, as text that sympy does not simplify on reading."""
    expr = sp.sympify(expr)
    for _ in range(draw.randint(1, 2)):
        expr = draw.choice(REWRITES)(expr)
    text = expression_text(expr, greek=False)
    symbols = question.domain.symbols
    if symbols:
        x = draw.choice(symbols).name
        text = draw.choice(
            (
                "({t})*(sin({x})^2 + cos({x})**2)",
                "({t}) + 3*(1 - sin({x})^2 - cos({x})^2)",
                "({t})*(cosh({x})^2 - sinh({x})^2)",
                "{t}",
                "-(-({t}))",
                "(({t})*({x}^2 + 1))/(1 + {x}*{x})",
                "({t})*2*0.5",
            )
        ).format(t=text, x=x)
    else:
        text = draw.choice(("{t}", "({t})*2/2", "({t})*sqrt(4)/2", "({t})/1 + 1 - 1")).format(
            t=text
        )
    return shown_name(text)


def tangents(expr):
    """sin(x) as tan(x) cos(x)."""
    return expr.replace(sp.sin, lambda x: sp.tan(x) * sp.cos(x))


def halved(expr):
    """cos(x) by the sine of half the angle."""
    return expr.replace(sp.cos, lambda x: 1 - 2 * sp.sin(x / 2) ** 2)


def exponentials(expr):
    """Hyperbolic functions by exponentials."""
    return expr.replace(sp.sinh, lambda x: (sp.exp(x) - sp.exp(-x)) / 2)


REWRITES = (lambda x: x, sp.expand, sp.together, tangents, halved, exponentials)


def equations_form(question: Question, value, draw: Random) -> str:
    """Rates as equations that are swapped, scaled, reversed and combined."""
    lines = []
    for k, name in enumerate(question.unknowns):
        rate = expression_form(value.get((k,), sp.S.Zero), question, draw)
        factor = draw.randint(2, 5)
        lines.append(
            draw.choice(
                (
                    f"{name} = {rate}",
                    f"{rate} = {name}",
                    f"{factor}*{name} - {factor}*({rate}) = 0",
                    f"0 = ({rate}) - {name}",
                )
            )
        )
    if draw.random() < 0.3:
        first, second = question.unknowns[:2]
        one, two = (answer_text(question, value).split("; ")[k].partition(" = ")[2] for k in (0, 1))
        lines[0] = f"{first} + {second} = {one} + ({two})"
    draw.shuffle(lines)
    return draw.choice(("; ", "\n")).join(lines)


def number_form(question: Question, value, draw: Random) -> str:
    """Numbers with more or fewer digits, with and without unit, as fractions and products."""
    if question.shape:
        size = max((abs(float(x)) for x in value.values()), default=1.0)
        parts = [float(value.get((k,), 0.0)) for k in range(question.shape[0])]
        digits = draw.randint(6, 12)
        return (
            "[" + ", ".join(f"{x if abs(x) > 1e-12 * size else 0:.{digits}f}" for x in parts) + "]"
        )
    x = float(value.get((), 0.0))
    text = f"{x:.{draw.randint(6, 12)}g}"
    unit = question.unit
    forms = [text, f"({text})*2/2", f"{text} {unit}".strip()]
    if question.tolerance < 1e-6:
        forms = [repr(x), f"{x!r}*3/3"]
    elif unit == "rad":
        forms += [f"{sp.deg(sp.Float(x)).evalf(12)} deg", f"{x / 3.141592653589793:.9f}*pi"]
    return draw.choice(forms)

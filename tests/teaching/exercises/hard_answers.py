"""Hard answers: right ones in forms at which known graders fail, and similar wrong ones."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.question import Question

x, theta = sp.symbols("x theta", real=True)
a, b = sp.symbols("a b", positive=True)
UNIT = Domain((x,), (x > 0, x < 2))
LINE = Domain((x,))
LEFT = Domain((x,), (x > -3, x < 0))
HALF = Domain((theta,), (theta > 0, theta < sp.pi))
WHOLE = Domain((theta,), (theta > 0, theta < 2 * sp.pi))
POWERS = Domain((x, a, b), (x > 0,))
BLOCK = [[[1, 0], [0, x]], [[0, 2], [3, 0]]]
MINUS, DASH, WIDE, RAISED = "\u2212", "\u2013", "\uff0d", "\u207b"


@dataclass(frozen=True)
class Hard:
    """A solution with right and wrong answers."""

    solution: object
    domain: Domain
    right: tuple[str, ...]
    wrong: tuple[str, ...]
    kind: str = "expression"
    shape: tuple[int, ...] = ()

    def question(self) -> Question:
        """The question with this solution."""
        return Question("q", self.kind, "?", lambda: self.solution, self.domain, shape=self.shape)


HARD = {
    "sines": Hard(
        sp.sin(x) ** 4 + sp.cos(x) ** 4,
        UNIT,
        ("(3 + cos(4x))/4", "1 - sin(2x)^2/2", "1 - 2 sin^2 x cos^2 x", "(1 + cos^2(2x))/2"),
        ("(3 + sin(4x))/4", "1 - sin(2x)^2"),
    ),
    "half angles": Hard(
        sp.tan(x / 2), UNIT, ("(1 - cos(x))/sin(x)", "sin(x)/(1 + cos(x))"), ("sin(x)/2",)
    ),
    "factored": Hard(
        (x - 1) ** 600,
        LINE,
        ("-(x-1)*(1-x)^599", "(1-x)^600", "(x^2-2x+1)^300", "(1-x)^602/(x-1)^2"),
        ("(1-x)^599", "(x-1)*(1-x)^599", "(x-1)^600*(1+1/10^60)"),
    ),
    "factored, odd": Hard(
        (1 - x) ** 599, LINE, ("-(x-1)^599", "(x-1)^600/(1-x)"), ("(x-1)^599", "(1-x)^600")
    ),
    "matrix": Hard(
        [[1, 0], [0, 1 / x]],
        UNIT,
        (
            "[[1, 0], [0, 1/x]]",
            "matrix([1, 0], [0, 1/x])",
            "Matrix([[1, 0], [0, x**-1]])",
            "np.array([[1, 0], [0, 1/x]])",
            "{{1, 0}, {0, x/x^2}}",
            "[1, 0; 0, 1/x]",
            r"\begin{pmatrix} 1 & 0 \\ 0 & \frac{1}{x} \end{pmatrix}",
        ),
        ("[[1, 0], [0, x]]", "matrix([1, 1/x], [0, 0])"),
        "components",
        (2, 2),
    ),
    "lists in lists": Hard(
        BLOCK,
        UNIT,
        ("[[[1,0],[0,x]],[[0,2],[3,0]]]", "{{{1,0},{0,x}},{{0,2},{3,0}}}"),
        ("[[[1,0],[0,x]],[[0,3],[2,0]]]",),
        "components",
        (2, 2, 2),
    ),
    "roots": Hard(
        x ** sp.Rational(2, 3),
        UNIT,
        ("cbrt(x)^2", "cbrt(x^2)", "x/x^(1/3)", "(x^600)^(1/900)"),
        ("x^2/3", "x^(3/2)"),
    ),
    "symbols above": Hard(
        x ** (a / b),
        POWERS,
        ("(x^a)^(1/b)", "exp(a*log(x)/b)", "x^(a/b - 1)*x", "1/x^(-a/b)"),
        ("x^a/b", "x^(b/a)"),
    ),
    "a root where it is right": Hard(
        sp.sin(theta), HALF, ("sqrt(1 - cos(theta)^2)",), ("-sqrt(1 - cos(theta)^2)",)
    ),
    "a root where it is not": Hard(
        sp.sin(theta), WHOLE, ("2 sin(theta/2) cos(theta/2)",), ("sqrt(1 - cos(theta)^2)",)
    ),
    "a size": Hard(-x, LEFT, ("|x|", "abs(x)", "sqrt(x^2)", r"\left|x\right|"), ("x", "|x| + x")),
    "minus signs": Hard(
        -(x**2) - sp.exp(-x) / x,
        UNIT,
        (
            "-x^2 - e^(-x) x^(-1)",
            f"{MINUS}x^2 {MINUS} e^({MINUS}x) x^({MINUS}1)",
            f"{DASH}x^2 {DASH} e^({DASH}x) x^({DASH}1)",
            f"{WIDE}x^2 {WIDE} e^({WIDE}x) x^({WIDE}1)",
            f"{MINUS}x\u00b2 {MINUS} exp({MINUS}x)\u00b7x{RAISED}\u00b9",
        ),
        (f"{MINUS}x^2 + e^({MINUS}x)/x",),
    ),
    "numbers with a minus sign": Hard(-2.5, Domain(), (f"{MINUS}2.5", f"{MINUS}5/2"), ("2.5",),
                                      "number"),
}  # fmt: skip

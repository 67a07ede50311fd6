"""Notation: right answers in odd forms are accepted, or the message shows how to write them."""

# Tests pass wrong types on purpose, as users do, and read attributes that may be missing.
# pyright: reportOptionalMemberAccess=false, reportOptionalSubscript=false

import contextlib
import re
from random import Random

import pytest
import sympy as sp

from geomtorsion import exercises
from geomtorsion.errors import GeomtorsionError
from geomtorsion.exact import parse_expression
from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.question import Question
from geomtorsion.teaching.exercises.reading import read
from tests.calls import python_calls

# Exercise, question, a right answer in an odd form.
RIGHT = [
    # Names as displayed, and similar ones.
    ("3.2", "christoffel", "cot(phi_2)"),
    ("3.2", "christoffel", "cot(phi_{2})"),
    ("3.2", "christoffel", "cot(φ₂)"),
    ("3.2", "christoffel", "cot(φ_2)"),
    ("3.2", "christoffel", "cot φ2"),
    ("3.2", "christoffel", "cot(ϕ2)"),
    ("3.2", "christoffel", "cot(𝜑2)"),
    ("3.2", "christoffel", "cot(phi 2)"),
    ("3.2", "christoffel", "cot phi2"),
    ("3.2", "christoffel", "cotphi2"),
    # Functions by other names and without brackets.
    ("3.2", "christoffel", "ctg(phi2)"),
    ("3.2", "christoffel", "Cot[phi2]"),
    ("3.2", "christoffel", "cos phi2/sin phi2"),
    ("3.2", "christoffel", "cos phi2 / sin phi2"),
    ("3.2", "christoffel", "np.cos(phi2)/np.sin(phi2)"),
    ("3.2", "christoffel", "math.cos(phi2)/math.sin(phi2)"),
    ("3.2", "christoffel", "1/tg(phi2)"),
    ("3.2", "christoffel", "tan(phi2)^-1"),
    ("3.2", "christoffel", "tan(phi2)⁻¹"),
    ("3.2", "christoffel", "(sin(phi2))^{-1} cos(phi2)"),
    ("3.2", "christoffel", "0.5 sin(2phi2)/sin^2(phi2)"),
    ("3.2", "christoffel", "1/2 sin 2phi2 * (1/sin(phi2))^2"),
    ("3.2", "christoffel", "½ sin(2 phi2)/sin²(phi2)"),
    ("3.2", "christoffel", "cos φ₂ sin φ₂/sin² φ₂ * 1.0"),
    # LaTeX.
    ("3.2", "christoffel", r"\cot\phi_2"),
    ("3.2", "christoffel", r"$\cot\left(\phi_{2}\right)$"),
    ("3.2", "christoffel", r"\frac{\cos\phi_2}{\sin\phi_2}"),
    ("3.2", "christoffel", r"\dfrac{\cos{\phi_{2}}}{\sin{\phi_{2}}}"),
    ("3.2", "christoffel", r"\frac12 \sin(2\varphi_2) \cdot \frac{1}{\sin^{2}\phi_2}"),
    ("3.2", "christoffel", r"\frac{\cos\phi_2}{\sqrt{1-\cos^2\phi_2}}"),
    ("3.2", "christoffel", r"\operatorname{cot}\phi_2"),
    # The name of the quantity, and extra signs.
    ("3.2", "christoffel", "Gamma_12^1 = cot(phi2)"),
    ("3.2", "christoffel", "= cot(phi2)"),
    ("3.2", "christoffel", "Γ̄_12^1 = cot(phi2)."),
    ("3.2", "christoffel", "−cos(phi2)/(−sin(phi2))"),
    # Products, roots and powers.
    ("3.3", "scalar", "2R^-2"),
    ("3.3", "scalar", "2R⁻²"),
    ("3.3", "scalar", "2÷R²"),
    ("3.3", "scalar", "2 R^{-2}"),
    ("3.3", "scalar", "sqrt(4)/R**2"),
    ("3.3", "scalar", "√4 · R^(-2)"),
    ("3.3", "scalar", "2.0/R^2"),
    ("3.3", "scalar", "2000/1000/R^2"),
    ("3.3", "ricci", "[[1/R^2, 0], [0, sin^2(r/R)]]"),
    ("3.3", "ricci", "[[1/R², 0], [0, sin²(r/R)]]"),
    ("3.3", "ricci", "{{1/R^2, 0}, {0, Sin[r/R]^2}}"),
    ("3.3", "ricci", "((1/R^2, 0), (0, sin(r/R)^2))"),
    ("3.3", "ricci", "[1/R^2, 0; 0, sin(r/R)^2]"),
    ("3.3", "ricci", "[1/R^2 0; 0 sin(r/R)^2]"),
    ("3.3", "ricci", "1/R^2, 0; 0, sin(r/R)^2"),
    ("3.3", "ricci", "diag(1/R^2, sin(r/R)^2)"),
    ("3.3", "ricci", "Matrix([[1/R**2, 0], [0, sin(r/R)**2]])"),
    ("3.3", "ricci", "np.array([[1/R**2, 0], [0, np.sin(r/R)**2]])"),
    ("3.3", "ricci", r"\begin{pmatrix} 1/R^2 & 0 \\ 0 & \sin^2(\frac{r}{R}) \end{pmatrix}"
     .replace(r"\sin^2\frac{r}{R}", r"\sin^2\left(\frac{r}{R}\right)")),
    ("3.3", "ricci", "R = [[1/R^2, 0], [0, sin(r/R)^2]]"),
    ("3.3", "ricci", "R_11 = 1/R^2, R_22 = sin(r/R)^2"),
    ("3.3", "ricci", "R_rr = 1/R^2; R_{phi phi} = sin(r/R)^2"),
    ("3.3", "ricci", "11: 1/R^2; 22: sin(r/R)^2"),
    ("3.3", "ricci", "1,1 = 1/R^2, 2,2 = sin(r/R)^2"),
    ("3.3", "ricci", "{'1,1': '1/R**2', '2,2': 'sin(r/R)**2'}"),
    ("3.3", "ricci", [["1/R^2", 0], [0, "sin(r/R)^2"]]),
    # Components with indices above and below.
    ("2.1", "connection", "Γ_12^2 = 1/r"),
    ("2.1", "connection", "Γ^2_12 = 1/r"),
    ("2.1", "connection", "Γ²₁₂ = 1/r"),
    ("2.1", "connection", r"\Gamma_{12}{}^{2} = \frac{1}{r}"),
    ("2.1", "connection", r"\Gamma_{12}^{\;\;2} = \frac1r"),
    ("2.1", "connection", r"\Gamma^{\phi}_{\;r\phi} = \dfrac 1{r}"),
    ("3.2", "christoffel", r"\frac1{\tan\phi_2}"),
    ("4.3", "equations", r"\ddot r=0,\; \ddot{\phi}=-\frac{\dot r\,\dot\phi}r"),
    ("2.1", "connection", r"\Gamma^\phi_{r\phi} = 1/r"),
    ("2.1", "connection", "Gamma_rphi^phi = r^-1"),
    ("2.1", "connection", "Gamma(1,2,2) = 1/r"),
    ("2.1", "connection", "122 = 1/r, 111 = 0"),
    ("2.1", "connection", "[[[0, 0], [0, 1/r]], [[0, 0], [0, 0]]]"),
    ("1.1", "legs", "[[cos phi, sin phi], [-sin(phi)/r, cos(phi)/r]]"),
    ("1.1", "legs", "E_1^1 = cos φ; E_2^1 = sin φ; E_1^2 = -sin(φ)/r; E_2^2 = cos(φ)/r"),
    ("1.1", "legs", (r"\begin{pmatrix}\cos\phi & \sin\phi\\-\frac{\sin\phi}{r} & "
     r"\frac{\cos\phi}{r}\end{pmatrix}")),
    # Vectors.
    ("5.1", "burgers", "(0, 0, -A)"),
    ("5.1", "burgers", "0, 0, −A"),
    ("5.1", "burgers", "b = [0, 0, -A]"),
    ("5.1", "burgers", "b1 = 0, b2 = 0, b3 = -A"),
    ("5.1", "burgers", "b^3 = -A"),
    ("5.2", "burgers", "[0, 0, -πR²]"),
    ("5.2", "burgers", "b_3 = -piR^2"),
    ("5.2", "burgers", r"b^3 = -\pi R^{2}"),
    ("5.4", "around", "b^3 = 2b"),
    ("6.3", "terms", "[u2 dPhi3 - u3 dPhi2, u3 dPhi1 - u1 dPhi3, u1 dPhi2 - u2 dPhi1]"),
    ("6.3", "terms", "[u_2 δΦ_3 - u_3 δΦ_2, u_3 δΦ_1 - u_1 δΦ_3, u_1 δΦ_2 - u_2 δΦ_1]"),
    ("6.3", "terms", (r"[u^2\delta\Phi^3 - u^3\delta\Phi^2, u^3\delta\Phi^1 - u^1\delta\Phi^3, "
     r"u^1\delta\Phi^2 - u^2\delta\Phi^1]")),
    # Rates and equations.
    ("1.4", "rates", ("[phi2' sin phi1 - phi3' cos phi1 sin phi2, "
     "phi2' cos phi1 + phi3' sin phi1 sin phi2, phi1' + phi3' cos phi2]")),
    ("1.4", "rates", ("[φ̇₂ sin φ₁ − φ̇₃ cos φ₁ sin φ₂, φ̇₂ cos φ₁ + φ̇₃ sin φ₁ sin φ₂, "
     "φ̇₁ + φ̇₃ cos φ₂]")),
    ("4.3", "equations", "r'' = 0, phi'' r + r'phi' = 0"),
    ("4.3", "equations", "rr'' = 0, phi'' = -r' phi'/r"),
    ("4.3", "equations", r"\ddot r = 0; \ddot\phi = -\frac{\dot r\dot\phi}{r}"),
    ("4.3", "equations", "d^2r/dt^2 = 0 and d^2phi/dt^2 + (dr/dt)(dphi/dt)/r = 0"),
    ("4.3", "equations", "r̈ = 0; φ̈ == −ṙφ̇/r"),
    ("6.1", "equations", ("I_1 Omega_1' = (I_2 - I_3) Omega_2 Omega_3\n"
     "I_2 Omega_2' = (I_3 - I_1) Omega_3 Omega_1\nI_3 Omega_3' = (I_1 - I_2) Omega_1 Omega_2")),
    ("6.1", "equations", "I1 Ω̇1 = (I2 − I3)Ω2Ω3, I2 Ω̇2 = (I3 − I1)Ω3Ω1, I3 Ω̇3 = (I1 − I2)Ω1Ω2"),
    ("6.1", "equations", (r"I_1\dot\Omega_1 = (I_2-I_3)\Omega_2\Omega_3; "
     r"I_2\dot\Omega_2 = (I_3-I_1)\Omega_3\Omega_1; I_3\dot{\Omega}_3=(I_1-I_2)\Omega_1\Omega_2")),
    ("6.1", "equations", ("I1 dOmega1/dt = (I2-I3) Omega2 Omega3; I2 dOmega2/dt = (I3-I1) Omega3 "
     "Omega1; I3 dOmega3/dt = (I1-I2) Omega1 Omega2")),
    ("6.4", "body", "lambda = (C - A)w/A"),
    ("6.4", "body", "λ = w(C−A)/A"),
    ("6.4", "space", "√(A²v² + C²w²)/A"),
    ("6.4", "space", r"\frac{\sqrt{A^2 v^2 + C^2 w^2}}{A}"),
    # Numbers and choices.
    ("4.1", "radius", "2.00"),
    ("4.1", "radius", "≈ 2"),
    ("4.1", "radius", "r = 2"),
    ("4.1", "angle", "1.586 rad"),
    ("4.1", "angle", "1.586 radians"),
    ("4.1", "angle", "0.2 + 2 ln 2"),
    ("4.1", "angle", "0.2 + 2ln(2)"),
    ("4.1", "angle", "0.2+2ln2"),
    ("4.1", "angle", "1.586294 × 10⁰"),
    ("4.1", "angle", "15.86294·10^-1"),
    ("4.1", "angle", 1.5863),
    ("3.1", "cartan", "Zero."),
    ("3.1", "cartan", "0"),
    ("3.1", "riemann", "nonzero"),
    ("3.1", "riemann", "not-zero"),
    ("3.1", "riemann", "≠ 0"),
    ("4.2", "same", "No."),
    ("6.6", "law", "a geodesic of the metric"),
]  # fmt: skip

# Texts with two meanings, and the advice on how to write them.
TWO_WAYS = [
    ("1/x sin y", "Write (1/x)*sin(y) or 1/(x*sin(y))."),
    ("1/x sin(y)", "Write (1/x)*sin(y) or 1/(x*sin(y))."),
    ("2/x sin^2 2y", "Write (2/x)*sin^2(2*y) or 2/(x*sin^2(2*y))."),
    ("1/(x+1) cos -y", "Write (1/(x+1))*cos(-y) or 1/((x+1)*cos(-y))."),
    ("y/cos(x) (y+1)", "Write (y/cos(x))*(y+1) or y/(cos(x)*(y+1))."),
    ("sin x/(x+1)", "Write sin(x)/(x+1) or sin(x/(x+1))."),
    ("e^2 sin x", "Write exp(2*sin(x)) or exp(2)*sin(x)."),
    ("1/x sin", "Write (1/x)*sin(...) or 1/(x*sin(...))."),
    ("sin x/2", "Write sin(x)/2 or sin(x/2)."),
    ("sin x^2", "Write sin(x)^2 or sin(x^2)."),
    ("cos x y", "Write cos(x)*y or cos(x*y)."),
    ("1/2x", "Write (1/2)*x or 1/(2*x)."),
    ("e^2x", "Write exp(2*x) or exp(2)*x."),
    ("sin^-1(x)", "Write 1/sin(x), or asin(x) for the inverse function."),
    ("sqrt 2 x", "Write sqrt(2)*x or sqrt(2*x)."),
    ("√2x", "Write sqrt(2)*x or sqrt(2*x)."),
    ("2½", "Write 5/2 for two and a half."),
    ("sin x (1+y)", "Write sin(x)*(1+y) or sin(x*(1+y))."),
    ("y/2 x", "Write (y/2)*x or y/(2*x)."),
]


def test_there_are_enough():
    """At least as many as in the trial in which a quarter could not be read."""
    assert len(RIGHT) >= 76


@pytest.mark.parametrize(("number", "name", "answer"), RIGHT, ids=lambda case: str(case)[:40])
def test_odd_forms_are_right(number, name, answer):
    """An answer with one meaning is accepted in each of these notations."""
    verdict = exercises.load(number).check({name: answer})[name]
    assert verdict.right, verdict.message


x, y = sp.symbols("x y", real=True)
ASKED = Question("q", "expression", "?", lambda: x, Domain((x, y)))


@pytest.mark.parametrize(("text", "advice"), TWO_WAYS)
def test_two_ways_to_read(text, advice):
    """The message gives both ways to write the text, and each of them is read differently."""
    said = check_question(ASKED, text)
    assert said.diagnosis == "unreadable"
    assert advice in said.message
    if " or " in advice and "for" not in advice and "..." not in advice:
        one, two = re.search(r"Write (.*) or (.*)\.$", advice).groups()
        assert read(ASKED, one) != read(ASKED, two)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2x^2y", 2 * x**2 * y), ("x y", x * y), ("xy", x * y), ("x(x+1)", x * (x + 1)),
        ("(x+1)(y-1)", (x + 1) * (y - 1)), ("sin 2x cos y", sp.sin(2 * x) * sp.cos(y)),
        ("sin^2 x cos^3 y", sp.sin(x) ** 2 * sp.cos(y) ** 3), ("sin x", sp.sin(x)),
        ("-sin x", -sp.sin(x)), ("sin -x", -sp.sin(x)), ("e^x", sp.exp(x)),
        ("e^-x", sp.exp(-x)), ("e^(2x)y", sp.exp(2 * x) * y), ("e^{2x}", sp.exp(2 * x)),
        ("1/2 sin x", sp.sin(x) / 2), ("x/y", x / y), ("x/(2y)", x / (2 * y)),
        ("sin(x)/2", sp.sin(x) / 2), ("1/2*x", x / 2), ("x^2/y^2", x**2 / y**2),
        ("sqrt x", sp.sqrt(x)), ("2pi x", 2 * sp.pi * x), ("2πx", 2 * sp.pi * x),
        ("exp 2x", sp.exp(2 * x)), ("ln x", sp.log(x)), ("x**2", x**2),
        ("3e-2*x", 3 * x / 100),
        (r"\sqrt[3]{x}", x ** sp.Rational(1, 3)), (r"\frac{\frac{x}{2}}{y}", x / 2 / y),
        (r"\mathrm{e}^{-\frac{x}{2}}", sp.exp(-x / 2)), ("x²y³", x**2 * y**3), ("xʸ", x**y),
        ("x⁻ʸ", x**-y),
        ("arctan(x)", sp.atan(x)), ("sin(x)cos(y)", sp.sin(x) * sp.cos(y)),
        ("sin²x", sp.sin(x) ** 2), ("1/sin^2(x)", 1 / sp.sin(x) ** 2),
    ],
)  # fmt: skip
def test_products_and_brackets(text, value):
    """Omitted signs and brackets are added as in a book."""
    assert sp.simplify(read(ASKED, text)[()] - value) == 0


@pytest.mark.parametrize("text", ["0.25*x + zz", "0.25x + zz", "1.5e-3 + zz"])
def test_decimals_are_shown_as_they_were_written(text):
    """The message holds the student's number, not a fraction."""
    message = check_question(ASKED, text).message
    assert re.match(r"[\d.e-]+", text)[0] in message
    assert "/" not in message


def test_messages_mark_the_mistake_in_the_text():
    """The message marks the mistake in the typed text; it has both texts if signs were replaced."""
    message = check_question(ASKED, "2 sin x zz").message
    assert "can be read in two ways" in message
    lines = check_question(ASKED, "2x sin y + zz").message.splitlines()
    assert lines[1:3] == ["    2x sin y + zz", "               ^^"]
    assert not any("You typed" in line for line in lines)
    message = check_question(ASKED, r"\frac{x}{2} + zz").message
    assert "((x)/(2)) + zz" in message
    assert r"You typed: \frac{x}{2} + zz" in message


@pytest.mark.parametrize(
    ("text", "marked"),
    [
        ("sin zz", "zz"),
        ("2 sin^2 zz", "zz"),
        ("sin(x", "("),
        ("x sqrt(2 + 0.5 zz)", "zz"),
        ("x''", "x''"),
        ("φ zz", "φ"),
        ("|x| + zz", "zz"),
        ("2e^x % 3", "%"),
        ("x,y", ","),
        ("1_2 x", "_2"),
        ("sin", "sin"),
    ],
)
def test_the_mistake_is_marked(text, marked):
    """The signs below the text mark the part that cannot be read."""
    _, shown, signs, *_ = check_question(ASKED, text).message.splitlines()
    assert "".join(sign for sign, mark in zip(shown, signs, strict=False) if mark == "^") == marked


HOSTILE = [
    "x" * 4000, "sin " * 1000, "\\frac{" * 600, "{" * 4000, "\\begin{matrix}" * 280,
    "d" + " " * 3990 + "/", "x'" * 1900, "_" * 4000, "½" * 4000, "x\u0307" * 2000, "²" * 4000,
    "\\sqrt{" * 300 + "x" + "}" * 300, "sin^" * 1000, "a1" * 2000, "=" * 4000, "1,1=" * 900,
    "[" * 6 + "x," * 1900 + "]" * 6, ("[" + "x;" * 1000 + "]"), "(" * 2000 + ")" * 2000,
    "and " * 1000, "1 2 " * 1000, "\\dot" * 900, "Matrix(" * 500, "{:" * 1900, "^{" * 1900,
]  # fmt: skip


@pytest.mark.parametrize("text", HOSTILE, ids=lambda text: repr(text[:12]))
def test_hostile_notation_ends_soon(text):
    """Each hostile text, with many repeated signs, is refused after few Python calls."""
    matrix = Question("q", "components", "?", lambda: [[x, 0], [0, y]], Domain((x, y)),
                      shape=(2, 2))  # fmt: skip
    rates = Question("q", "equations", "?", lambda: [x], Domain((x, y)), unknowns=("x'",))
    for question in (ASKED, matrix, rates):
        calls = python_calls(lambda question=question: check_question(question, text))
        # Five times the largest number here; work that grows with the square of the length of a
        # text has some ten million.
        assert 0 < calls < 2e6
        assert not check_question(question, text).right


def test_nothing_foreign_is_raised():
    """A prefix of an odd form is read, or refused with an error of our own."""
    for number, name, answer in RIGHT:
        if isinstance(answer, str):
            question = exercises.load(number).question(name)
            for size in range(len(answer)):
                with contextlib.suppress(GeomtorsionError):
                    read(question, answer[:size])


def sparse(text: str, draw: Random) -> str:
    """A text from which signs and brackets are removed at random."""
    signs = ("*", " ", "", "·", " * ")
    text = re.sub(r"\*(?!\*)", lambda _: draw.choice(signs), text)
    text = re.sub(
        r"\b(sin|cos|tan|exp|sqrt)\((\w+)\)(\^\d)?",
        lambda m: draw.choice((m[0], f"{m[1]}{m[3] or ''} {m[2]}", f"{m[1]}{m[3] or ''}({m[2]})")),
        text,
    )
    return re.sub(
        r"\b(phi|theta|Omega|I|V)(\d)", lambda m: f"{m[1]}{draw.choice(('', '_'))}{m[2]}", text
    )


@pytest.mark.parametrize("number", exercises.names())
def test_omitted_signs_are_never_restored_wrongly(number):
    """A right answer without some signs is right, or refused as having two readings."""
    draw = Random(f"sparse {number}")
    for seed in range(3):
        exercise = exercises.load(number, seed)
        for name, text in exercise.answers().items():
            if exercise.question(name).kind not in ("choice", "number"):
                for _ in range(3):
                    odd = sparse(text, draw)
                    verdict = check_question(exercise.question(name), odd)
                    refused = "can be read in two ways" in verdict.message
                    assert verdict.right or refused, (text, odd, verdict.message)


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("%pi*x", "pi*x"),
        ("%e^(2*%pi*x)", "E**(2*pi*x)"),
        ("|x - 1|^3", "sqrt((x-1)**2)**3"),
        ("2|x|y", "2*sqrt((x)**2)*y"),
        ("abs x", "sqrt((x)**2)"),
        ("Abs(x)/x", "sqrt((x)**2)/x"),
        (r"\left|x\right|", "sqrt((x)**2)"),
        ("1_000 x", "1000*x"),
    ],
)
def test_maxima_and_sizes(text, meant):
    """Constants of Maxima are read; |x| is the root of its square."""
    assert read(ASKED, text)[()] == parse_expression(meant, {"x": x, "y": y})

"""Bad input: each is refused with an error that names entry, reason and remedy."""

# Calls that a checker of types refuses as well.
# pyright: reportArgumentType=false

import re

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    CoframeError,
    CoordinateError,
    ExpressionError,
    GeomtorsionError,
    LimitError,
    MetricError,
    MissingValueError,
    ShapeError,
    SignatureError,
    SingularPointError,
    StructureConstantError,
    UndecidedError,
)

x, y, z = sp.symbols("x y z", real=True)
r, m = sp.symbols("r M", positive=True)
UNIT = [[1, 0], [0, 1]]


@pytest.mark.parametrize(
    "coframe",
    [[[1, 0]], [[1, 0, 0], [0, 1, 0]], [[1, 0], [0]], [[1], [0, 1]], sp.zeros(2, 3)],
    ids=["one row", "two by three", "short last row", "short first row", "matrix"],
)
def test_coframe_that_is_not_square(coframe):
    """A coframe that is not square is refused."""
    with pytest.raises((CoframeError, ShapeError), match=r"(?i)square|row|column|2"):
        gt.Frame([x, y], coframe)


def test_wrong_number_of_coordinates():
    """Three coordinates do not fit a two by two coframe; the message names both numbers."""
    with pytest.raises(GeomtorsionError, match=r"(?s)3.*2|2.*3|three.*two|two.*three"):
        gt.Frame([x, y, z], UNIT)


def test_no_coordinates():
    """An empty list of coordinates is refused."""
    with pytest.raises(GeomtorsionError, match="coordinate"):
        gt.Frame([], [])


def test_repeated_coordinate():
    """The message names a coordinate that was given twice."""
    with pytest.raises(CoordinateError, match=r"\bx\b"):
        gt.Frame([x, y, x], sp.eye(3))


def test_coordinate_that_is_also_a_parameter():
    """One symbol cannot be both coordinate and parameter."""
    with pytest.raises(CoordinateError, match=r"\by\b"):
        gt.Frame([x, y], [[1, 0], [0, y]], parameters=[y])


@pytest.mark.parametrize("bad", [3, x**2, None, sp.Function("f")(x)], ids=str)
def test_coordinate_other_than_a_symbol(bad):
    """Numbers and expressions are refused as coordinates."""
    with pytest.raises(CoordinateError, match="(?i)symbol|name"):
        gt.Frame([x, bad], UNIT)


def test_singular_coframe_names_the_dependent_rows():
    """If the determinant vanishes identically, the message names the dependent rows."""
    rows = [[1, x, 0], [0, sp.sin(y), 1], [2, 2 * x, 0]]
    with pytest.raises(CoframeError, match=r"(?is)row.*(0.*2|2.*0|1.*3|3.*1)"):
        gt.Frame([x, y, z], rows)


def test_singular_coframe_by_an_identity():
    """A determinant that vanishes only by a trigonometric identity is recognised as zero."""
    rows = [[sp.sin(2 * x), 2 * sp.sin(x)], [sp.cos(x), 1]]
    with pytest.raises(CoframeError, match="(?i)singular|vanish|depend"):
        gt.Frame([x, y], rows)


def test_zero_row_is_named():
    """A coframe with a row of zeros is refused; the message names the row."""
    with pytest.raises(CoframeError, match="(?i)row"):
        gt.Frame([x, y], [[1, 0], [0, 0]])


def test_free_symbols_are_parameters():
    """A free symbol is a parameter; an evaluation without its value names it."""
    frame = gt.Frame([r, x], [[1, 0], [0, sp.sqrt(1 - 2 * m / r)]])
    assert m in frame.parameters
    with pytest.raises(MissingValueError, match=r"\bM\b"):
        frame.metric.at({r: 3})
    with pytest.raises(MissingValueError, match=r"\br\b"):
        frame.metric.at({m: 1})


@pytest.mark.parametrize(
    ("entry", "part"),
    [
        (1 + sp.sign(y), "sign"),
        (sp.Piecewise((x, x > 0), (1, True)), "Piecewise"),
        (sp.floor(x), "floor"),
        (sp.Max(x, 1), "Max"),
        (sp.Heaviside(x), "Heaviside"),
        (sp.oo, "oo"),
        (sp.nan, "nan"),
    ],
    ids=lambda value: str(value)[:20],
)
def test_entries_that_are_not_smooth(entry, part):
    """The message names the position of a non-smooth entry and its non-smooth part."""
    with pytest.raises(ExpressionError, match=part) as caught:
        gt.Frame([x, y], [[1, 0], [entry, 1]])
    assert re.search(r"1, 0", str(caught.value)), str(caught.value)


def test_complex_entry_in_a_real_frame():
    """The imaginary unit requires complex=True; the message names that option."""
    coframe = [[1, sp.I * x], [0, 1]]
    with pytest.raises(ExpressionError, match="complex") as caught:
        gt.Frame([x, y], coframe)
    assert "0, 1" in str(caught.value)
    assert gt.Frame([x, y], coframe, complex=True).dimension == 2


@pytest.mark.parametrize(
    ("entry", "rational"),
    [(0.5, "1/2"), (sp.Float("0.25"), "1/4"), (1 + 0.1 * x, "1/10"), (sp.sin(x / 0.3), "10/3")],
    ids=str,
)
def test_float_entry_is_offered_as_a_rational(entry, rational):
    """The message gives the position of a float entry and the exact rational to write instead."""
    with pytest.raises(ExpressionError, match=rational) as caught:
        gt.Frame([x, y], [[1, 0], [0, entry]])
    assert "1, 1" in str(caught.value)


@pytest.mark.parametrize(
    "entry", ["x +", "z", None, object(), [1]], ids=["text", "name", "None", "object", "list"]
)
def test_entry_other_than_an_expression(entry):
    """Text that is not an expression, unknown names and other objects are refused as entries."""
    with pytest.raises(GeomtorsionError):
        gt.Frame([x, y], [[1, 0], [0, entry]])


def test_numpy_floats_and_integers():
    """NumPy integers are exact; NumPy floats are refused like Python floats."""
    assert gt.Frame([x, y], np.array([[1, 0], [0, 2]])).metric[1, 1] == 4
    with pytest.raises(ExpressionError, match="1/2"):
        gt.Frame([x, y], np.array([[0.5, 0], [0, 2]]))


def test_metric_that_is_not_symmetric():
    """An asymmetric metric is refused."""
    with pytest.raises(MetricError, match=r"(?i)symmetric"):
        gt.Frame.from_metric([x, y], [[1, x], [0, 1]])


def test_metric_that_is_degenerate():
    """A metric without inverse is refused."""
    with pytest.raises((MetricError, CoframeError), match="(?i)degenerate|singular|determinant"):
        gt.Frame.from_metric([x, y], [[1, 1], [1, 1]])


def test_metric_of_wrong_signature():
    """A Lorentzian metric is not Euclidean; the message names the signature."""
    with pytest.raises((MetricError, SignatureError), match="(?i)signature"):
        gt.Frame.from_metric([x, y], [[-1, 0], [0, 1]], signature=(1, 1))


def test_metric_of_wrong_shape():
    """A metric with more rows than coordinates is refused."""
    with pytest.raises((MetricError, ShapeError), match=r"2|square"):
        gt.Frame.from_metric([x, y], sp.eye(3))


@pytest.mark.parametrize(
    "signature",
    [(1,), (1, 2), (1, 0), [[1, 1], [0, 1]], [[1, 1], [1, 1]], [[x, 0], [0, 1]], "euclidean"],
    ids=str,
)
def test_invalid_signature_is_refused(signature):
    """eta must be constant, symmetric, non-degenerate and of the right size."""
    with pytest.raises(SignatureError, match="(?i)signature|eta"):
        gt.Frame([x, y], UNIT, signature=signature)


def structure_constants(**entries):
    """C[i][j][k] = C_ij^k from names like _01_2=value."""
    c = np.zeros((3, 3, 3), dtype=object)
    for name, value in entries.items():
        _, lower, k = name.split("_")
        i, j = int(lower[0]), int(lower[1])
        c[i, j, int(k)] = value
        c[j, i, int(k)] = -value
    return c.tolist()


def test_structure_constants_violating_jacobi():
    """[e0, e1] = e1, [e1, e2] = e0 is not a Lie algebra: it violates the Jacobi identity."""
    with pytest.raises(StructureConstantError, match="(?i)jacobi"):
        gt.Frame.from_structure_constants(structure_constants(_01_1=1, _12_0=1))


def test_structure_constants_that_are_not_antisymmetric():
    """Constants that violate C_ij^k = -C_ji^k are refused."""
    c = structure_constants(_01_2=1)
    c[1][0][2] = 1
    with pytest.raises(StructureConstantError, match="(?i)antisymmetric"):
        gt.Frame.from_structure_constants(c)


def test_structure_constants_of_wrong_shape():
    """Structure constants need three indices with one range."""
    with pytest.raises((ShapeError, StructureConstantError), match="(?i)shape|index|indices|3"):
        gt.Frame.from_structure_constants([[1, 0], [0, 1]])


def test_structure_constants_that_are_not_constant():
    """A float is refused; the message offers the exact rational."""
    with pytest.raises(GeomtorsionError, match="1/2"):
        gt.Frame.from_structure_constants(structure_constants(_01_2=0.5))


def test_huge_expression_works_or_states_its_limit():
    """A sum of 3,000 terms is read, or refused with a message that states a limit."""
    huge = sp.Add(*(x**n / (n + 1) for n in range(3000)))
    try:
        frame = gt.Frame([x, y], [[1, 0], [0, 1 + huge]])
    except LimitError as error:
        limit = str(error)
    else:
        limit = "0"
        assert frame.coframe.element(1, 1).diff(x).evaluate({x: 0}) == 0.5
    assert re.search(r"\d", limit)


def test_messages_name_remedies():
    """Each message is longer than 40 characters, enough for cause and remedy."""
    attempts = [
        lambda: gt.Frame([x, y], [[1, 0]]),
        lambda: gt.Frame([x, x], UNIT),
        lambda: gt.Frame([x, y], [[1, 0], [2, 0]]),
        lambda: gt.Frame([x, y], [[1, sp.Abs(x)], [0, 1]], domain=[x > -1]),
        lambda: gt.Frame([x, y], UNIT, signature=(1, 5)),
        lambda: gt.Frame.from_metric([x, y], [[1, x], [0, 1]]),
    ]
    for attempt in attempts:
        with pytest.raises(GeomtorsionError) as caught:
            attempt()
        assert len(str(caught.value)) > 40, str(caught.value)


def test_nothing_half_computed_is_left():
    """After a refusal the corrected input works."""
    bad, good = [[1, 0], [0, sp.sign(x)]], [[1, 0], [0, 1 + x**2]]
    with pytest.raises(ExpressionError):
        gt.Frame([x, y], bad)
    assert gt.Frame([x, y], good).metric[1, 1] == (1 + x**2) ** 2


@pytest.mark.parametrize("root", [sp.sqrt(-1 - x**2), sp.sqrt(sp.sin(y) - 2)], ids=str)
def test_roots_of_negative_numbers_need_a_complex_frame(root):
    """A leg that is imaginary everywhere is refused: it would silently flip the signature."""
    with pytest.raises(ExpressionError, match="complex|negative") as caught:
        gt.Frame([x, y], [[1, 0], [0, root]])
    assert "1, 1" in str(caught.value)
    assert gt.Frame([x, y], [[1, 0], [0, root]], complex=True).dimension == 2


def test_real_frames_give_no_complex_numbers():
    """Outside the domain of a root an error is raised; no complex number is returned."""
    frame = gt.Frame([x, y], [[1, 0], [0, sp.sqrt(x - 1)]])
    assert frame.coframe.at({x: 5, y: 0})[1, 1] == 2
    with pytest.raises(SingularPointError, match="real|negative"):
        frame.coframe.at({x: 0.3, y: 0})


def test_contradictory_domain():
    """A contradictory domain is refused."""
    with pytest.raises(CoordinateError, match="domain"):
        gt.Frame([x, y], [[x, 0], [0, 1]], domain=[x > 1, x < 0])


def test_determinant_that_cannot_be_decided():
    """A determinant that vanishes by an identity of Bessel functions is refused."""
    hidden = sp.besselj(0, x) + sp.besselj(2, x) - 2 * sp.besselj(1, x) / x
    with pytest.raises((UndecidedError, CoframeError), match="(?i)determinant|singular"):
        gt.Frame([x, y], [[hidden, 0], [0, 1]])


LONG = "a" * 200_000


@pytest.mark.parametrize(
    "call",
    [
        lambda: gt.parse_expression(LONG, {}),
        lambda: gt.parse_expression(LONG + "(x)", {}, {}),
        lambda: gt.parse_expression("1" * 200_000, {}),
        lambda: gt.Frame(LONG, [[1, 0], [0, 1]]),
        lambda: gt.Frame("x y", [[1, 0], [0, LONG]]),
        lambda: gt.Frame("x y", [[1, 0], [0, sp.sign(sp.Symbol(LONG))]]),
        lambda: gt.Frame("x y", [[1, 0], [0, sp.Symbol(LONG) + sp.Symbol(LONG, real=True)]]),
        lambda: gt.Frame("x y", UNIT, signature="+" * 200_000),
        lambda: gt.Frame("x y", UNIT).metric.at({LONG: 1}),
        lambda: gt.Frame("x y", UNIT).metric.at({"x": "a " * 100_000}),
        lambda: gt.contract("a " * 100_000, gt.Frame("x y", UNIT).metric),
        lambda: gt.numpy_function(x, list(range(100_000))),
        lambda: gt.spaces.load(LONG),
        lambda: gt.equations_of_motion(gt.Frame("x y", UNIT), LONG),
        lambda: gt.Loop.circle(LONG, 1),
        lambda: gt.Loop.circle([0, 0], 1, plane=LONG),
        lambda: gt.Loop.parametric([LONG, "1"], "t", (0, 1)),
        lambda: gt.Loop.parametric("b " * 100_000, "t", (0, 1)),
        lambda: gt.geodesic(gt.Frame("x y", UNIT), [0, 0], [0, 1], parameters={LONG: 1}),
    ],
)
def test_no_message_repeats_input_at_length(call):
    """A message shows at most 200 characters of its input."""
    with pytest.raises(GeomtorsionError) as caught:
        call()
    message = str(caught.value)
    assert len(message) < 900
    assert not re.search(r"\S{201}|(a ){150}|([0-9]+, ){100}", message)

"""Regions: where a frame is real, finite and regular, without a domain and without assumptions."""

import math
import pickle
from itertools import islice

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import CoordinateError, ExpressionError, MetricError
from geomtorsion.exact import Specialization

t, r, theta, phi, M = sp.symbols("t r theta phi M")


def diagonal(*entries: str) -> list[list[object]]:
    """A diagonal matrix as rows."""
    size = range(len(entries))
    return [[entries[i] if i == j else 0 for j in size] for i in size]


SPHERE = "r**2", "r**2*sin(theta)**2"
# Name, coordinates, parameters, metric, region that a textbook states for the chart.
METRICS = [
    ("Schwarzschild", "t r theta phi", "M", diagonal("-(1-2*M/r)", "1/(1-2*M/r)", *SPHERE),
     "M > 0, r > 2*M, 0 < theta < pi"),
    ("the same with + - - -", "t r theta phi", "M",
     diagonal("1-2*M/r", "-1/(1-2*M/r)", "-r**2", "-r**2*sin(theta)**2"),
     "M > 0, r > 2*M, 0 < theta < pi"),
    ("the same with t last", "r theta phi t", "M",
     diagonal("1/(1-2*M/r)", *SPHERE, "-(1-2*M/r)"), "M > 0, r > 2*M, 0 < theta < pi"),
    ("the sun in metres", "t r theta phi", "", diagonal("-(1-2953/r)", "1/(1-2953/r)", *SPHERE),
     "r > 2953, 0 < theta < pi"),
    ("static de Sitter", "t r theta phi", "", diagonal("r**2-1", "1/(1-r**2)", *SPHERE),
     "0 < r < 1, 0 < theta < pi"),
    ("Milne", "t psi theta phi", "",
     diagonal("-1", "t**2", "t**2*sinh(psi)**2", "t**2*sinh(psi)**2*sin(theta)**2"),
     "t > 0, psi > 0, 0 < theta < pi"),
    ("Rindler", "t x y z", "", diagonal("-x**2", "1", "1", "1"), "x > 0"),
    ("Minkowski", "t x y z", "", diagonal("-1", "1", "1", "1"), "everywhere"),
    ("Kasner", "t x y z", "", diagonal("-1", "t**(12/7)", "t**(6/7)", "t**(-4/7)"), "t > 0"),
    ("Fisher", "m s", "", diagonal("1/s**2", "2/s**2"), "s > 0"),
    ("one line", "x", "", [["1"]], "everywhere"),
    ("Kerr and Newman", "t r theta phi", "M a Q",
     diagonal(
         "-(r**2 - 2*M*r + a**2 + Q**2)", "1/(r**2 - 2*M*r + a**2 + Q**2)",
         "r**2 + a**2*cos(theta)**2", "sin(theta)**2"
     ), "M > 0, a > 0, Q > 0, -2*M*r + Q**2 + a**2 + r**2 > 0, r > M, 0 < theta < pi"),
    ("isotropic", "t x y z", "M",
     diagonal("-((1-M/(2*sqrt(x**2+y**2+z**2)))/(1+M/(2*sqrt(x**2+y**2+z**2))))**2",
              *["(1+M/(2*sqrt(x**2+y**2+z**2)))**4"] * 3),
     "M > 0, -M**2 + 4*x**2 + 4*y**2 + 4*z**2 > 0"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("coordinates", "parameters", "metric", "words"),
    [case[1:] for case in METRICS],
    ids=[case[0] for case in METRICS],
)
def test_a_typed_metric_has_the_region_of_a_textbook(
    coordinates: str, parameters: str, metric: list[list[object]], words: str
) -> None:
    """A metric without domain and assumptions: the region, with a point inside it."""
    frame = gt.Frame.from_metric(coordinates, metric, parameters=parameters)
    region = frame.region
    assert str(region) == words
    assert region.assumed == (words != "everywhere")
    assert all(relation.subs(region.point) == sp.true for relation in region.relations)
    assert set(region.point) == {*frame.coordinates, *frame.parameters}


COFRAMES = [
    ("t r", diagonal("sqrt(1-r)", "1/sqrt(1-r)"), "r < 1"),
    ("t r", diagonal("sqrt(1-r**2)", "1/sqrt(1-r**2)"), "-1 < r < 1"),
    ("r theta", diagonal("1", "r"), "r > 0"),
    ("x y", diagonal("1", "1"), "everywhere"),
    ("x y", diagonal("log(x)", "1"), "0 < x < 1"),
    ("x y", diagonal("x**2 + y**2", "1"), "x**2 + y**2 > 0"),
]


@pytest.mark.parametrize(("coordinates", "coframe", "words"), COFRAMES)
def test_a_typed_coframe_has_its_region(
    coordinates: str, coframe: list[list[object]], words: str
) -> None:
    """Roots, logarithms, denominators and the determinant bound the region."""
    assert str(gt.Frame(coordinates, coframe).region) == words


@pytest.mark.parametrize("name", gt.spaces.names())
def test_a_shipped_space_without_its_domain_is_found_in_it(name: str) -> None:
    """Stripped of domain and assumptions, each space has its point inside the declared domain."""
    frame = gt.spaces.load(name).frame
    plain = {s: sp.Symbol(s.name) for s in (*frame.coordinates, *frame.parameters)}
    n, shape = frame.dimension, frame.shape
    given = {"coframe": frame.coframe, "legs": frame.legs, "metric": frame.metric}[shape]
    rows = [[sp.sympify(given[i, j]).xreplace(plain) for j in range(n)] for i in range(n)]
    symbols = [plain[s] for s in frame.coordinates], [plain[s] for s in frame.parameters]
    eta = [[frame.eta[i, j] for j in range(n)] for i in range(n)]
    if shape == "metric":
        signs = [eta[i][i] for i in range(n)]
        bare = gt.Frame.from_metric(symbols[0], rows, signature=signs, parameters=symbols[1])
    else:
        make = gt.Frame if shape == "coframe" else gt.Frame.from_frame
        bare = make(symbols[0], rows, signature=eta, parameters=symbols[1], complex=frame.complex)
    point = bare.region.point
    assert all(relation.xreplace(plain).subs(point) == sp.true for relation in frame.domain)
    assert all(point[plain[s]] > 0 for s in plain if s.is_positive)


def test_parameters_are_positive() -> None:
    """No parameter of a typed metric is negative at its point."""
    for _, coordinates, parameters, metric, _ in METRICS:
        frame = gt.Frame.from_metric(coordinates, metric, parameters=parameters)
        assert all(frame.region.point[s] > 0 for s in frame.parameters)


def test_a_declared_domain_is_the_region() -> None:
    """The relations are the domain, and parameters get values consistent with it."""
    frame = gt.Frame("t r", diagonal("sqrt(r-k)", "1"), parameters="k", domain="r > k, k > 5")
    region = frame.region
    assert region.relations == frame.domain
    assert not region.assumed
    assert region.point[frame.parameters[0]] > 5
    assert region.assumption == ""


def test_a_domain_that_is_too_large_is_narrowed() -> None:
    """Where the declared domain contains a wall, the region names the side that was assumed."""
    region = gt.Frame("t r", diagonal("sqrt(1-2/r)", "1"), domain="r > 0").region
    assert region.assumed
    assert region.point[region._walls.symbols[1]] > 2


def test_the_box_is_on_one_side_of_all_walls() -> None:
    """Outside of two horizons the signs are those inside both; the box is in one of the parts."""
    delta = "r**2 - 2*M*r + a**2"
    frame = gt.Frame("t r", diagonal(f"sqrt({delta})", f"1/sqrt({delta})"), parameters="M a")
    region = frame.region
    _, r, M, a = region.point
    low, high = (x for x in region.box if r in x.free_symbols)
    least, most = low.lts, high.gts
    outer = region.point[M] + sp.sqrt(region.point[M] ** 2 - region.point[a] ** 2)
    assert least < region.point[r] < most
    assert outer.is_real
    assert float(least) > float(outer)
    assert str(region) == "M > 0, a > 0, -2*M*r + a**2 + r**2 > 0, r > M"


def test_points_are_inside_and_the_same_at_each_call() -> None:
    """Points without end, all different, with other values of the parameters."""
    frame = gt.Frame.from_metric("t r theta phi", METRICS[0][3], parameters="M")
    region = frame.region
    points = list(islice(region.points(), 2000))
    assert points[:50] == list(islice(region.points(), 50))
    assert points[0] == region.point
    assert len({tuple(point.values()) for point in points}) == len(points)
    assert all(relation.subs(p) == sp.true for p in points[::40] for relation in region.relations)
    (mass,) = frame.parameters
    assert len({point[mass] for point in points[:50]}) > 40


@pytest.mark.parametrize(
    ("expression", "sign"),
    [("r", 1), ("M - r", -1), ("r - M", 1), ("r - 2*M", 1), ("r - 201*M/100", None),
     ("sin(theta)", 1), ("cos(theta)", None), ("t", None), ("M", 1), ("2", 1), ("-1/3", -1),
     ("0", None), ("sin(theta)**2 + cos(theta)**2 - 1", None), ("exp(t)", 1)],
)  # fmt: skip
def test_the_sign_of_an_expression(expression: str, sign: int | None) -> None:
    """+1 or -1 where it is the same all over r > 2 M > 0, 0 < theta < pi; else None."""
    frame = gt.Frame.from_metric("t r theta phi", METRICS[0][3], parameters="M")
    assert frame.region.sign(expression) is sign


def test_the_sign_of_an_element_and_of_a_function() -> None:
    """Elements and sympy expressions are taken; a function of which nothing is known has none."""
    frame = gt.Frame([r, theta], [[1, 0], [0, r]])
    assert frame.region.sign(frame.determinant.element()) == 1
    assert frame.region.sign(-r) == -1
    assert frame.region.sign(sp.Function("f")(r)) is None


def test_unknown_functions_have_values() -> None:
    """The root of an unknown function is real where the function is positive."""
    f = sp.Function("f")(r)
    frame = gt.Frame([t, r], [[sp.sqrt(f), 0], [0, 1 / sp.sqrt(f)]], signature="-+")
    assert str(frame.region) == "f(r) > 0"
    a = sp.Function("a")(t)
    flat = gt.Frame.from_metric([t, r], [[-1, 0], [0, a**2]])
    assert flat.region.signature == (-1, 1)


def test_one_point_for_all() -> None:
    """The point of the region is where the signs of roots were read."""
    frame = gt.Frame("t r", diagonal("sqrt(1-2/r)", "1/sqrt(1-2/r)"), signature="-+")
    values = frame.field.sample.values
    assert frame.region.point == {s: values[s] for s in frame.coordinates}
    assert frame.sample_point == frame.region.point


def test_no_units_are_needed() -> None:
    """The ellipsoid WGS84 in metres, with its height."""
    latitude, longitude, height = sp.symbols("lat lon h")
    a, e2 = sp.Integer(6378137), sp.Rational(669437999014, 10**14)
    prime = 1 - e2 * sp.sin(latitude) ** 2
    north = a * (1 - e2) / prime ** sp.Rational(3, 2) + height
    east = (a / sp.sqrt(prime) + height) * sp.cos(latitude)
    frame = gt.Frame([latitude, longitude, height], sp.diag(north, east, 1))
    assert str(frame.region) == "-pi/2 < lat < pi/2"
    assert abs(frame.region.point[latitude]) < math.pi / 2


def test_other_regions_are_there() -> None:
    """Inside and outside of the horizon, for both signs of M and r."""
    frame = gt.Frame.from_metric("t r", diagonal("-(1-2/r)", "1/(1-2/r)"))
    assert {str(region) for region in frame.regions} == {"r > 2", "0 < r < 2", "r < 0"}


REFUSED = [
    (lambda: gt.Frame("x y", diagonal("1", "1"), domain="x < 0, x > 1").region,
     CoordinateError, "exclude each other"),
    (lambda: gt.Frame("x y", diagonal("1", "1"), domain="x**2 + y**2 < -1").region,
     CoordinateError, "holds at no point that was tried"),
    (lambda: gt.Frame("x y", diagonal("sqrt(x - 1)", "sqrt(-x)")).region,
     ExpressionError, "negative at every point"),
    (lambda: gt.Frame.from_metric("x y", diagonal("1", "1"), signature="-+"),
     MetricError, "expected a metric of signature"),
    (lambda: gt.Frame("x", [["x"]]).region.sign("q"), gt.errors.GeomtorsionError, "q"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_refusals(call: object, error: type[Exception], words: str) -> None:
    """What excludes each other is named."""
    with pytest.raises(error, match=words):
        call()  # type: ignore[operator]


def test_it_is_a_value() -> None:
    """Equal frames have equal regions; a region can be pickled and shown."""
    one, two = (gt.Frame("r theta", diagonal("1", "r")).region for _ in range(2))
    again = pickle.loads(pickle.dumps(one))
    assert one == two == again
    assert hash(one) == hash(again)
    assert repr(one) == "Region(r > 0)"
    assert one._repr_latex_() == "$r > 0$"
    assert one.assumption == "for r > 0, assumed; declare domain=[...] for another region"


@pytest.mark.parametrize("inside", ["1 - r", "1 - r**2"])
def test_symmetries_where_a_root_is_real(inside: str) -> None:
    """Three Killing vectors in closed form, of a flat and of a curved plane with a root."""
    coframe = diagonal(f"sqrt({inside})", f"1/sqrt({inside})")
    vectors = gt.symmetries(gt.Frame("t r", coframe, signature="-+")).vectors
    assert len(vectors) == 3
    assert all(gt.lie(xi, xi.frame.metric).is_zero for xi in vectors)


def test_a_rounded_point_stays_inside() -> None:
    """Between two close walls the coarse fractions of a search are skipped."""
    coframe = diagonal("sqrt(r - 1000)", "sqrt(1001 - r)")
    frame = gt.Frame("t r", coframe, domain="1000 < r, r < 1001")
    places = Specialization.nearer(
        frame.field, frame.coordinates, frame.region.point, frame.region.surrounds
    )
    _, radius = frame.coordinates
    rounded = [place.rounded for place in places]
    assert rounded
    assert all(1000 < values[radius] < 1001 for values in rounded)


def test_a_printed_frame_names_the_region_that_was_assumed():
    """Without a domain the region is printed beside the legs, with one it is not."""
    exterior = diagonal("-(1-2*M/r)", "1/(1-2*M/r)", *SPHERE)
    bare = gt.Frame.from_metric("t r theta phi", exterior, parameters="M")
    words = "for M > 0, r > 2*M, 0 < theta < pi, assumed; declare domain=[...] for another region"
    assert str(bare).splitlines()[-1].strip() == words
    assert "for M &gt; 0, r &gt; 2*M" in bare._repr_html_()
    declared = gt.Frame.from_metric(
        "t r theta phi", exterior, parameters="M", domain="M > 0, r > 2*M, 0 < theta, theta < pi"
    )
    for frame in (declared, gt.Frame("x y", diagonal("1", "1"))):
        assert "assumed" not in str(frame) + frame._repr_html_()


@pytest.mark.parametrize("order", ["a M Q", "M a Q", "Q a M"])
def test_parameters_prefer_horizons(order):
    """The metric of Kerr and Newman in letters is a black hole at its point."""
    sigma, delta = "(r**2 + a**2*cos(theta)**2)", "(r**2 - 2*M*r + a**2 + Q**2)"
    mixed = f"-a*(2*M*r - Q**2)*sin(theta)**2/{sigma}"
    last = f"((r**2 + a**2)**2 - {delta}*a**2*sin(theta)**2)*sin(theta)**2/{sigma}"
    rows = [
        [f"-({delta} - a**2*sin(theta)**2)/{sigma}", 0, 0, mixed],
        [0, f"{sigma}/{delta}", 0, 0],
        [0, 0, sigma, 0],
        [mixed, 0, 0, last],
    ]
    region = gt.Frame.from_metric("t r theta phi", rows, parameters=order).region
    values = {str(s): x for s, x in region.point.items()}
    assert values["M"] ** 2 > values["a"] ** 2 + values["Q"] ** 2
    assert region.sign("r - M") == 1


def test_a_universe_is_closed_first_and_open_next():
    """The curvature of a typed universe has both signs, each with its own region."""
    a = "a(t)**2"
    entries = ["-1", f"{a}/(1 - k*r**2)", f"{a}*r**2", f"{a}*r**2*sin(theta)**2"]
    rows = [[entries[i] if i == k else 0 for k in range(4)] for i in range(4)]
    first, second, *_ = gt.Frame.from_metric("t r theta phi", rows, parameters="k").regions
    assert str(first) == "k > 0, a(t) > 0, k*r**2 - 1 < 0, r > 0, 0 < theta < pi"
    assert str(second) == "k < 0, a(t) > 0, r > 0, 0 < theta < pi"


TYPED = ("t r theta phi", diagonal("sqrt(1-2*M/r)", "1/sqrt(1-2*M/r)", "r", "r*sin(theta)"))
EXTERIOR = "M > 0, r > 2*M, 0 < theta, theta < pi"
FREE = "(-u1**2 + u2**2 + u3**2 + u4**2)/2"
# Everything printed that depends on signs of roots, as text, LaTeX or HTML.
PRINTED = [
    ("frame in LaTeX", lambda frame: frame._repr_latex_()),
    ("legs", lambda frame: str(frame.legs)),
    ("legs in LaTeX", lambda frame: frame.legs._repr_latex_()),
    ("table of the coframe", lambda frame: str(frame.coframe.table())),
    ("coframe in a notebook", lambda frame: frame.coframe._repr_html_()),
    ("connection", lambda frame: repr(gt.cartan(frame))),
    ("connection in a notebook", lambda frame: gt.cartan(frame)._repr_html_()),
    ("torsion", lambda frame: str(gt.cartan(frame).torsion)),
    ("equations of motion", lambda frame: repr(gt.equations_of_motion(frame, FREE))),
    ("the same in LaTeX", lambda frame: gt.equations_of_motion(frame, FREE)._repr_latex_()),
    ("variation", lambda frame: str(gt.variation(frame))),
    (
        "geodesic in LaTeX",
        lambda frame: gt.geodesic(
            frame, [0, 8, 1, 0], frame_velocity=[1, 0, 0, 0], parameters={"M": 1}
        )._repr_latex_(),
    ),
    ("symmetries", lambda frame: str(gt.symmetries(frame))),
    ("holonomy algebra", lambda frame: str(gt.levi_civita(frame).holonomy_algebra)),
]


@pytest.mark.parametrize(("name", "show"), PRINTED, ids=[name for name, _ in PRINTED])
def test_printed_results_name_the_region_that_was_assumed(name: str, show: object) -> None:
    """Each result with signs of roots names its region, unless the domain was declared."""
    bare, declared = (
        gt.Frame(*TYPED, signature="-+++", parameters="M", domain=domain)
        for domain in (None, EXTERIOR)
    )
    assert "assumed" in show(bare), name  # type: ignore[operator]
    assert "assumed" not in show(declared)  # type: ignore[operator]


def test_results_without_signs_name_no_region() -> None:
    """A result that is rational, of a frame without roots, is the same in each region."""
    frame = gt.Frame("r theta", diagonal("1", "r"))
    assert "assumed" not in str(gt.cartan(frame).torsion)
    assert "assumed" in str(frame)


def test_a_constrained_connection_names_the_region() -> None:
    """The permitted legs of a kinetic metric have unit length where the masses are positive."""
    metric = diagonal("m", "m", "I")
    constraint = ["cos(theta)*dy - sin(theta)*dx"]
    skate = gt.constrained(gt.Frame.from_metric("x y theta", metric, parameters="m I"), constraint)
    words = "for m > 0, I > 0, assumed"
    assert words in repr(skate)
    assert words.replace(">", "&gt;") in skate._repr_html_()
    assert "\\text{, assumed}" in skate._repr_latex_()
    numbers = gt.Frame.from_metric("x y theta", diagonal("2", "2", "3"))
    assert "assumed" not in repr(gt.constrained(numbers, constraint))


def test_reduced_equations_name_the_region() -> None:
    """Equations with a root of an unknown function name its sign; rational ones do not."""
    A, h = (sp.Function(name)(r) for name in "Ah")
    frame = gt.Frame([t, r, theta, phi], sp.diag(A, 1 / h, r, r * sp.sin(theta)), "-+++")
    reduced = gt.gravity.equations(gt.levi_civita(frame), "R").reduce("r")
    assert "assumed" not in str(reduced) + reduced.latex
    rooted = gt.Frame([t, r, theta, phi], sp.diag(sp.sqrt(A), h, r, r * sp.sin(theta)), "-+++")
    fluid = gt.gravity.fluid("rho(r)", "sqrt(A(r))", [1, 0, 0, 0])
    reduced = gt.gravity.equations(gt.levi_civita(rooted), "R/2", fluid).reduce("r")
    for one in reduced.branches:
        assert "A(r) > 0" in str(one)
        assert "assumed" in one.latex

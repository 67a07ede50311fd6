"""Sources: for all kinds of data single circuits and surveys agree, and both can be drawn."""

import pickle
from collections.abc import Callable

import networkx as nx
import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from geomtorsion.materials import Source, Survey
from geomtorsion.materials.crystals import Crystal
from geomtorsion.materials.lines import Box, DislocationNetwork
from geomtorsion.materials.maps import Phase
from geomtorsion.pictures.measured import draw_circuits, draw_survey
from tests.materials.images.atoms import crystal
from tests.materials.maps.synthetic import wall

LINES = [np.linspace(0, 5, 11), np.linspace(0, 6, 13)]
X, Y = np.meshgrid(*LINES, indexing="ij")


def twist(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A coframe with torsion 1 + x / 9 in its first row and -cos(y) / 2 in its second."""
    return np.array([[-y, x + x**2 / 9], [np.sin(y), 0 * x]]) / 2


def displaced() -> gt.SampledFrame:
    """Noisy displacements around an edge dislocation."""
    u = 0.286 / (2 * np.pi) * np.arctan2(Y - 2.9, X - 2.3)
    noise = np.random.default_rng(1).normal(0, 1e-3, (2, *X.shape))
    return gt.SampledFrame.from_displacement(
        LINES, np.array([u, 0 * u]) + noise, branch=0.286, sigma=0.05, unit="nm"
    )


def scattered(dimension: int = 2) -> gt.ScatteredFrame:
    """Points of a twist in the plane or in space."""
    points = np.random.default_rng(0).uniform(0, 5, (300, dimension))
    values = twist(*points.T[:2])
    if dimension == 3:
        values = np.concatenate([values, 0 * values[:, :1]], axis=1)
    return gt.ScatteredFrame.from_coframe(points, values, sigma=0.01, unit="um")


SOURCES = {
    "grid": lambda: gt.SampledFrame(LINES, twist(X, Y), sigma=0.01, unit="nm"),
    "correlated": lambda: gt.SampledFrame(
        LINES, twist(X, Y), covariance=1e-4 * (np.eye(4) + 0.5).reshape(2, 2, 2, 2), unit="nm"
    ),
    "displacement": displaced,
    "map": lambda: wall(2.0, (20, 30), 0.5, sigma=0.1),
    "image": lambda: gt.LatticeImage(crystal(96, "square").noisy(0.3, 1), 0.5, "nm").phases(),
    "points": scattered,
}


@pytest.fixture(scope="module", params=SOURCES)
def source(request: pytest.FixtureRequest) -> Source:
    """One source of each kind."""
    return SOURCES[request.param]()


def single(source: Source, survey: Survey, place: tuple[int, ...]):
    """The circuit of a survey at one position, computed separately."""
    if isinstance(source, gt.ScatteredFrame):
        row = source.mesh.complex.boundary(1).tocsr()[[place[0]]].tocoo()
        chain = dict(zip(row.coords[1].tolist(), row.data.tolist(), strict=True))
        return source.burgers(chain)
    one, two = (line[k] for line, k in zip(survey.lines, place, strict=True))
    step = [line[1] - line[0] for line in survey.lines]
    half = [side * h / 2 for side, h in zip(survey.size, step, strict=True)]
    low, high = (one - half[0], two - half[1]), (one + half[0], two + half[1])
    corners = [low, (high[0], low[1]), high, (low[0], high[1])]
    return source.burgers(gt.Loop.polygon([list(map(float, c)) for c in corners], name="square"))


def test_a_survey_holds_what_each_circuit_gives(source):
    """b, its noise, its systematic error and its significance agree at random positions."""
    scatter = isinstance(source, gt.ScatteredFrame)
    survey = source.burgers_map(0 if scatter else 4)
    places = np.argwhere(survey.known & ~survey.widened)
    for place in map(tuple, np.random.default_rng(2).choice(places, 5, replace=False)):
        b = single(source, survey, place)
        at = (slice(None), *place)
        scale = b.magnitude + b.error
        assert survey.vectors[at] == pytest.approx(b.vector, rel=1e-6, abs=1e-9 * scale)
        if b.whole.size:
            assert survey.whole[at].tolist() == b.whole.tolist()
        else:
            assert survey.noise[place] == pytest.approx(b.noise, rel=1e-6)
            assert survey.sigmas[at] == pytest.approx(b.sigmas, rel=1e-6)
        # The error estimate uses a second rule: along grid lines for maps, along curves for loops.
        assert survey.systematic_error[place] == pytest.approx(
            b.systematic_error, rel=0.5, abs=1e-3 * scale
        )
        assert survey.significance[place] == pytest.approx(b.significance, rel=0.1, abs=0.05)
        assert survey.errors[place] == pytest.approx(
            np.hypot(survey.noise[place], survey.systematic_error[place])
        )


def test_results_are_plain_data(source):
    """A pickled copy has the same bits; summary and description are numbers and text."""
    scatter = isinstance(source, gt.ScatteredFrame)
    survey = source.burgers_map(0 if scatter else 4)
    again = pickle.loads(pickle.dumps(survey))
    assert np.array_equal(again.significance, survey.significance, equal_nan=True)
    numbers = survey.summary()
    assert numbers["known"] == survey.known.sum() > 0
    assert numbers["largest"] == pytest.approx(np.nanmax(survey.per_area))
    assert all(isinstance(line, str) and line for line in source.description)


def test_every_source_can_be_drawn(source):
    """A survey is drawn in two panels, and circuits on their backdrop."""
    scatter = isinstance(source, gt.ScatteredFrame)
    survey = source.burgers_map(2 if scatter else 4)
    assert len(draw_survey(survey).axes) == 4
    middle = [float(line.mean()) for line in survey.lines]
    radius = (0.3 if scatter else 0.5) * float(min(np.ptp(line) for line in survey.lines))
    b = source.burgers(gt.Loop.circle(middle, radius))
    figure = draw_circuits(source, [b])
    assert len(figure.axes[0].lines) == 2
    assert b.to_json()["loop"] == b.name


def test_points_in_space():
    """Circuits are drawn in the plane of their largest area, with nearby faces as the backdrop."""
    source = scattered(3)
    b = source.burgers(gt.Loop.circle([2.5, 2.5, 2.5], 1.5, plane=(1, 2)))
    assert b.section.plane == (1, 2)
    assert b.path.shape[0] == 2
    below = source.backdrop(b.section)
    assert 20 < len(below.values) < len(source.mesh.corners)
    assert draw_circuits(source, [b]).axes[0].get_ylabel().startswith("$z$")
    with pytest.raises(gt.GeomtorsionError, match="plane: expected two different axes from 0 to 2"):
        source.burgers_map(0, (0, 3))


def test_tables_of_scattered_points(tmp_path):
    """Each circuit is a row with its centre, and numbers read back as the same doubles."""
    survey = scattered().burgers_map(1)
    survey.write_table(tmp_path / "t.csv")
    text = (tmp_path / "t.csv").read_text().splitlines()
    assert text[3].startswith("x_centre,y_centre,b0,b1,b_per_area")
    assert len(text) == 4 + survey.known.sum()
    first = list(map(float, text[4].split(",")))
    assert first[:4] == [*survey.places[:, 0], *survey.vectors[:, 0]]
    survey.write_arrays(tmp_path / "t.npz")
    with np.load(tmp_path / "t.npz") as arrays:
        assert (arrays["area"] == survey.area).all()


def with_entry(values: np.ndarray, entry: float) -> np.ndarray:
    """An array with another first entry."""
    changed = np.array(values, dtype=float)
    changed.flat[0] = entry
    return changed


def orientations(**changes) -> gt.OrientationMap:
    """A small map of one orientation, with some parts changed."""
    parts = {
        "quaternions": np.eye(4)[np.zeros((4, 4), dtype=int)],
        "phase": np.ones((4, 4)),
        "phases": {1: Phase("Cu", "m-3m")},
        "steps": (1.0, 1.0),
    }
    return gt.OrientationMap(**(parts | changes))


def network(place: float = 0.0, strength: float = 1.0) -> DislocationNetwork:
    """A triangle of lines, with its first coordinate and its b."""
    graph = nx.MultiDiGraph()
    for k, position in enumerate([(place, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]):
        graph.add_node(k, position=position)
        graph.add_edge(k, (k + 1) % 3, burgers=(strength, 0.0, 0.0))
    return DislocationNetwork(graph)


def message_of(make: Callable[[], object]) -> str:
    """The message of our own error, or nothing."""
    try:
        make()
    except GeomtorsionError as error:
        return str(error)
    return ""


POINTS = np.random.default_rng(0).uniform(0, 5, (30, 2))
SITES = np.array([
    np.add(cell, site) * 3.2
    for cell in np.ndindex(4, 4, 4)
    for site in ((0, 0, 0), (0.5, 0.5, 0.5))
])  # fmt: skip
EDGE = 12.8
ENTRANCES = {
    "coframe": lambda x: gt.SampledFrame(LINES, with_entry(twist(X, Y), x)),
    "axis": lambda x: gt.SampledFrame([LINES[0] * x, LINES[1]], twist(X, Y)),
    "sigma": lambda x: gt.SampledFrame(LINES, twist(X, Y), sigma=x),
    "displacement": lambda x: gt.SampledFrame.from_displacement(
        LINES, with_entry(np.array([X, Y]), x)
    ),
    "points": lambda x: gt.ScatteredFrame.from_coframe(POINTS * x, twist(*POINTS.T)),
    "point": lambda x: gt.ScatteredFrame.from_coframe(with_entry(POINTS, x), twist(*POINTS.T)),
    "values": lambda x: gt.ScatteredFrame.from_coframe(POINTS, with_entry(twist(*POINTS.T), x)),
    "longest": lambda x: gt.ScatteredFrame.from_coframe(POINTS, twist(*POINTS.T), longest=x),
    "steps of a map": lambda x: orientations(steps=(1.0, x)),
    "sigma of a map": lambda x: orientations(sigma=x),
    "quaternion": lambda x: orientations(quaternions=np.full((4, 4, 4), x)),
    "phase": lambda x: Phase("Cu", "m-3m", (x, 1.0, 1.0)),
    "image": lambda x: gt.LatticeImage(with_entry(np.eye(64), x)),
    "step of an image": lambda x: gt.LatticeImage(np.eye(64), x),
    "node": lambda x: str(network(x)),
    "b of a line": lambda x: network(strength=x),
    "box": lambda x: Box(np.diag([x, 2.0, 2.0])),
    "atom": lambda x: Crystal(with_entry(SITES, x), [EDGE] * 3),
    "atom, open": lambda x: Crystal(with_entry(SITES, x)),
    "cell": lambda x: Crystal(SITES, [x, EDGE, EDGE]),
    "cell, open": lambda x: Crystal(SITES, [x, EDGE, EDGE], (False, True, True)),
    "constant": lambda x: Crystal(SITES, [EDGE] * 3, constant=x),
}
LENGTHS = (
    *("axis", "points", "longest", "steps of a map", "quaternion", "phase", "step of an image"),
    *("b of a line", "box", "cell", "cell, open", "constant"),
)
# NaN is a hole in a field, and it and infinity have messages of their own.
HOLES = ("coframe", "displacement", "values")


@pytest.mark.parametrize("name", ENTRANCES)
@pytest.mark.filterwarnings("ignore:.*:RuntimeWarning")
def test_numbers_outside_of_the_range_are_refused(name):
    """No source takes numbers whose products overflow, lengths whose products vanish, or infinity;
    numbers just inside of the range are not refused for their size."""
    make = ENTRANCES[name]
    wild = [1e308, -1e308, 1e200, 1.1e70, np.inf, -np.inf]
    for x in [*wild, *([] if name in HOLES else [np.nan])]:
        with pytest.raises(
            GeomtorsionError, match=r"finite|between|positive|infinity|or more|non-"
        ):
            make(x)
    for x in (1e-320, 1e-200) if name in LENGTHS else ():
        with pytest.raises(GeomtorsionError, match=r"between|not all 0|non-zero"):
            make(x)
    for x in (1e69, 2e-70):
        assert "between" not in message_of(lambda x=x: make(x))

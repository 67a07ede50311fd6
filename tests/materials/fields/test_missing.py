"""Values that mean "no data" are holes, and the result reports them."""

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import FileFormatError, GridError

LINE = np.linspace(-3, 3, 41)
FAILED = ((3, 4), (10, 20), (30, 30))


def table(path, mark, *, both=True, separator=",", written=repr):
    """A file of uniform strain in which three nodes have a mark."""
    rows = [separator.join(["x", "y", "u", "v"])]
    for i, x in enumerate(LINE.tolist()):
        for j, y in enumerate(LINE.tolist()):
            u, v = written(0.01 * x + 1), written(0.02 * y)
            if (i, j) in FAILED:
                u, v = mark, mark if both else v
            rows.append(separator.join([written(x), written(y), u, v]))
    path.write_text("\n".join(rows), "utf-8")
    return path


def is_right(field):
    """Whether the field has the three holes, and else the strain 0.01 and 0.02."""
    assert sorted(map(tuple, np.argwhere(field.mask).tolist())) == sorted(FAILED)
    b = field.burgers(gt.Loop.circle([0, 0], 2))
    assert np.abs(b.vector).max() < 1e-9
    strain = field.coframe - np.eye(2)[:, :, None, None]
    assert np.nanmax(np.abs(strain[0, 0] - 0.01)) < 1e-9
    assert np.nanmax(np.abs(strain[1, 1] - 0.02)) < 1e-9
    return True


@pytest.mark.parametrize(
    "mark",
    ["-9999", "-9999.0", "-999.25", "32767", "1e30", "9.96920996838687e+36", "-32768", "1E+20"],
)
@pytest.mark.parametrize("both", [True, False])
def test_a_number_that_all_failed_nodes_share(mark, both, tmp_path):
    """A value far from all others is a hole, whether one component has it or all."""
    field = gt.SampledFrame.read(table(tmp_path / "a.csv", mark, both=both))
    assert is_right(field)
    assert f"3 nodes with the value {float(mark):.10g} are treated as missing" in field.source


@pytest.mark.parametrize(
    "mark",
    [
        *"NA|N/A|#N/A|n/a|NaN|-nan|nan(ind)|NULL|None|missing||--|1.#QNAN".split("|"),
        *("#VALUE!", "no data", "#DIV/0!", "***", "-"),
    ],
)
def test_words(mark, tmp_path):
    """Words for missing values are holes in every spelling."""
    assert is_right(gt.SampledFrame.read(table(tmp_path / "a.csv", mark)))


@pytest.mark.parametrize("separator", ["\t", ";", ","])
def test_separators(separator, tmp_path):
    """Words are found between all separators."""
    assert is_right(gt.SampledFrame.read(table(tmp_path / "a.csv", "NA", separator=separator)))


def test_exponents_of_fortran(tmp_path):
    """1.58D+00 is a number."""

    def written(x):
        return f"{x:.16E}".replace("E", "D")

    path = table(tmp_path / "a.csv", "-9.999D+03", written=written)
    assert is_right(gt.SampledFrame.read(path))


@pytest.mark.parametrize("behind", [" # outside", " // bad", " ! checked", " % 3"])
def test_comments_and_quotes(behind, tmp_path):
    """Comments behind numbers and quotes around them do not count."""
    path = table(tmp_path / "a.csv", "NA", written=lambda x: f'"{x!r}"')
    name, *rows = path.read_text().splitlines()
    path.write_text("\n".join([name, *(row + behind for row in rows)]))
    assert is_right(gt.SampledFrame.read(path))


def test_an_exponent_of_three_digits(tmp_path):
    """1.0+003 is a number: Fortran omits the letter before three digits."""

    def written(x):
        mantissa, exponent = f"{x:.16e}".split("e")
        return f"{mantissa}{int(exponent):+04d}"

    assert is_right(gt.SampledFrame.read(table(tmp_path / "a.csv", "NA", written=written)))


def test_a_declared_value(tmp_path):
    """A value that is not far from the others is missing where it is declared."""
    path = table(tmp_path / "a.csv", "1.01")
    assert not gt.SampledFrame.read(path).holes
    assert is_right(gt.SampledFrame.read(path, missing=1.01))
    assert is_right(gt.SampledFrame.read(path, missing=[-1, 1.01]))
    scattered = gt.ScatteredFrame.read(path, missing=1.01)
    assert "3 nodes with the value 1.01 are treated as missing" in scattered.source


@pytest.mark.parametrize("kind", [".npz", ".nc"])
def test_arrays(kind, tmp_path):
    """Files of arrays obey the same rule."""
    x, y = np.meshgrid(LINE, LINE, indexing="ij")
    beta = np.stack([[0.01 + 0 * x, 0.003 * y], [0.002 * x, 0.02 + 0 * x]])
    for node in FAILED:
        beta[(slice(None), slice(None), *node)] = -9999
    gt.SampledFrame.from_distortion([LINE, LINE], beta - 0).save(tmp_path / f"a{kind}")
    field = gt.SampledFrame.read(tmp_path / f"a{kind}")
    # The coframe is the distortion plus one: its marks are -9999 and -9998.
    assert np.argwhere(field.mask).shape == (3, 2)


def test_data_without_marks_stay(tmp_path):
    """Noise, a step, a core and a constant field have no missing nodes."""
    rng = np.random.default_rng(0)
    x, y = np.meshgrid(LINE, LINE, indexing="ij")
    fields = [
        rng.normal(size=(2, 2, 41, 41)),
        rng.standard_cauchy(size=(2, 2, 41, 41)),
        np.broadcast_to((x > 0) * 50.0, (2, 2, 41, 41)),
        np.array([[-y, x], [x, y]]) / (x**2 + y**2 + 1e-3),
        np.zeros((2, 2, 41, 41)),
        np.where((x == LINE[20]) & (y == LINE[20]), 3.0, 0.0) * np.ones((2, 2, 1, 1)),
    ]
    for k, beta in enumerate(fields):
        file = tmp_path / f"{k}.npz"
        gt.SampledFrame.from_distortion([LINE, LINE], beta).save(file)
        field = gt.SampledFrame.read(file)
        assert not field.holes, k
        assert "missing" not in field.source


@pytest.mark.parametrize("missing", ["x", [1, "x"], [None]])
def test_no_number(missing, tmp_path):
    """A mark that is not a number is refused."""
    with pytest.raises(GridError, match="missing: expected a number"):
        gt.SampledFrame.read(table(tmp_path / "a.csv", "1"), missing=missing)


def test_another_word_is_refused(tmp_path):
    """A word that means nothing is refused, with the line where it is."""
    path = table(tmp_path / "a.csv", "NA")
    rows = path.read_text("utf-8").split("\n")
    rows[-1] = ",".join([*rows[-1].split(",")[:2], "bad", "NA"])
    path.write_text("\n".join(rows), "utf-8")
    with pytest.raises(
        FileFormatError, match="line 1682: expected a number in column 3, got 'bad'"
    ):
        gt.SampledFrame.read(path)


def test_steps_of_roundings_are_not_jumps(tmp_path):
    """A uniform strain has no large steps."""
    path = table(tmp_path / "a.csv", "NA")
    assert "unusually" not in gt.SampledFrame.read(path).source

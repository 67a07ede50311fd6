"""Blocked map: equal bits for any block size, after a kill, and on any scheduler."""

# dask does not declare its types.
# pyright: reportPrivateImportUsage=false, reportArgumentType=false

import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import dask
import dask.array as da
import numpy as np
import pytest

from geomtorsion.errors import (
    ArgumentError,
    CheckpointError,
    FileFormatError,
    GridError,
    LimitError,
)
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.blocked_map import blocked_map
from tests.chosen import one_in

ROOT = Path(__file__).parents[3]
RNG = np.random.default_rng(8)
FLAT = RNG.random((2, 2, 37, 29))
HOLED = FLAT.copy()
HOLED[0, 0, RNG.random((37, 29)) < 0.03] = np.nan
SOLID = RNG.random((1, 3, 13, 12, 11))
STEPS = (0.3, 0.7)


def screws(rows, columns):
    """The field of screws on a square lattice."""
    x, y = np.meshgrid(np.arange(rows) + 0.5, np.arange(columns) + 0.5, indexing="ij")
    return np.array([[np.sin(y / 9), np.cos(x / 7)]])


class Listed:
    """An array that records which nodes are read."""

    def __init__(self, values):
        self.values, self.shape, self.dtype = values, values.shape, values.dtype
        self.asked = []

    def __getitem__(self, index):
        self.asked.append([(s.start, s.stop) for s in index[2:]])
        return self.values[index]


@pytest.mark.parametrize(
    ("size", "order", "kind"),
    one_in(4, [0, 1, (3, 5), 12], [2, 4, 8], ["flat", "holes", "periodic", "noise"]),
)
def test_any_block_size_gives_the_same_bits(tmp_path, size, order, kind):
    """One block, rows, columns and tiny blocks give equal bits, close to the grid in memory."""
    source = HOLED if kind in ("holes", "noise") else FLAT
    options = {"periodic": kind == "periodic", "sigma": 0.01 if kind == "noise" else 0.0}
    found = [
        blocked_map(source, tmp_path / str(k), STEPS, block, size, order=order, **options).read()
        for k, block in enumerate([100, 9, (40, 3), (7, 30)])
    ]
    for other in found[1:]:
        assert np.array_equal(found[0], other, equal_nan=True)
    axes = [np.arange(n) * s for n, s in zip(source.shape[2:], STEPS, strict=True)]
    frame = SampledFrame(
        axes, source, order, periodic=options["periodic"], sigma=options["sigma"] or None
    )
    whole = frame.torsion()[0] if size == 0 else frame.burgers_map(size, widen=False).vectors
    if size and frame.mask.any():
        # Circuits of a map in blocks do not go around missing nodes.
        whole[:, frame.burgers_map(size, widen=False).detoured] = np.nan
    known = np.isfinite(whole)
    assert (known == np.isfinite(found[0][:-1])).all()
    # Differences of order 8 have weights of some hundred beside holes.
    assert np.abs(whole - found[0][:-1])[known].max() < (1e-10 if size == 0 else 1e-12)
    if size and kind == "noise":
        errors = frame.burgers_map(size, widen=False).errors
        assert found[0][-1][known[0]] == pytest.approx(errors[known[0]], rel=1e-6)


def test_three_axes(tmp_path):
    """Blocks also divide the depth, in another plane."""
    one, two = (
        blocked_map(SOLID, tmp_path / str(b), (1, 1, 1), b, 2, (2, 0)).read() for b in (99, 4)
    )
    assert np.array_equal(one, two)
    frame = SampledFrame([np.arange(float(n)) for n in SOLID.shape[2:]], SOLID)
    assert np.abs(frame.burgers_map(2, (2, 0)).vectors - one[:-1]).max() < 1e-13


@pytest.mark.parametrize("size", [0, (2, 3)])
def test_places_apart(tmp_path, size):
    """A stride gives the same bits as the full map, for any block size."""
    every = blocked_map(HOLED, tmp_path / "every", STEPS, 50, size).read()
    for k, block in enumerate([50, 4, (3, 2)]):
        some = blocked_map(HOLED, tmp_path / str(k), STEPS, block, size, stride=(4, 3)).read()
        assert np.array_equal(some, every[:, ::4, ::3], equal_nan=True)


@pytest.mark.parametrize(
    ("circuits", "width", "holes"),
    one_in(2, [(0, 0), ((3, 5), 1)], [(2, 2), (4, 2), (6, 3), (8, 4)], [0, 1]),
)
def test_halos_are_no_wider_than_stencils(tmp_path, circuits, width, holes):
    """order / 2 nodes for torsion, one less for circuits; more only in blocks with holes.

    Order 2 is compared with order 4, and needs the halo of order 4.
    """
    (size, less), (order, halo) = circuits, width
    values = screws(100, 100)
    if holes:
        values[..., ::7, ::7] = np.nan
    source = Listed(values)
    with dask.config.set(scheduler="synchronous"):
        blocked_map(source, tmp_path / "a", (1, 1), 10, size, order=order, plane=(1, 0))
    sides, wide = (5, 3) if size else (0, 0), halo - less
    # At an end of the grid and beside a hole, a stencil may be one-sided.
    more = max(order, 4) - 2 * less if holes else wide
    assert [(0, 10 + side + more) for side in sides] in source.asked
    around = [
        (low - wide, low + 10 + side + wide) for low, side in zip((50, 40), sides, strict=True)
    ]
    assert around in source.asked
    widest = max(high - low for nodes in source.asked for low, high in nodes)
    assert widest <= 10 + max(sides) + 2 * (max(order, 4) if holes else wide)


def test_nothing_is_read_across_the_plane(tmp_path):
    """Layers of a solid are read separately."""
    source = Listed(SOLID)
    with dask.config.set(scheduler="synchronous"):
        blocked_map(source, tmp_path / "a", (1, 1, 1), (99, 99, 1), 2)
    # Four reads are for the reference and the digest.
    assert sorted(source.asked[4:]) == [[(0, 13), (0, 12), (k, k + 1)] for k in range(11)]


def test_killed_and_resumed(tmp_path):
    """After the process ends in the middle, finished blocks stay and the rest has the same bits."""
    code = (
        "import os, dask\n"
        "from geomtorsion.materials.fields import blocked_map\n"
        "from tests.materials.fields.test_blocked_map import Listed, screws\n"
        "class Ending(Listed):\n"
        "    def __getitem__(self, index):\n"
        # One read is for the reference, and three are for the digest.
        "        if len(self.asked) > 8: os._exit(9)\n"
        "        return super().__getitem__(index)\n"
        "dask.config.set(scheduler='synchronous')\n"
        "source = Ending(screws(40, 37))\n"
        f"blocked_map(source, {str(tmp_path / 'a')!r}, (1, 1), 10, 3)\n"
    )
    killed = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False)
    assert killed.returncode == 9
    chunks = [file for file in (tmp_path / "a" / "c").rglob("*") if file.is_file()]
    before = {file: file.stat().st_mtime_ns for file in chunks}
    assert len(before) == 5
    source = Listed(screws(40, 37))
    again = blocked_map(source, tmp_path / "a", (1, 1), 10, 3)
    assert all(file.stat().st_mtime_ns == time for file, time in before.items())
    whole = blocked_map(source, tmp_path / "b", (1, 1), 100, 3)
    assert np.array_equal(again.read(), whole.read())
    # A truncated block is computed again, also at the edge; partial files are removed.
    for number in (again.numbers[0], again.numbers[-1]):
        chunk = again.file(number)
        chunk.write_bytes(chunk.read_bytes()[:100])
        chunk.with_suffix(".0.partial").write_bytes(b"0")
        with pytest.raises(CheckpointError, match="expected 16 finished blocks, got 15"):
            again.read()
        found = blocked_map(source, tmp_path / "a", (1, 1), 10, 3)
        assert np.array_equal(found.read(), whole.read())
    assert not list((tmp_path / "a").rglob("*.partial"))


def test_a_block_of_holes_is_done(tmp_path):
    """A block of holes counts as finished and is not computed again."""
    values = FLAT.copy()
    values[..., :20, :20] = np.nan
    one = blocked_map(values, tmp_path / "a", STEPS, 10)
    assert len(one.done) == len(one.numbers)
    assert np.isnan(one.read()[:, :10, :10]).all()


@pytest.mark.parametrize(
    "scheduler", ["synchronous", "threads", pytest.param("processes", marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("kind", ["path", "dask"])
def test_any_scheduler_gives_the_same_bits(tmp_path, scheduler, kind):
    """Blocks run on the scheduler that dask is set to."""
    np.save(tmp_path / "source.npy", HOLED)
    source = da.from_array(HOLED, chunks=9) if kind == "dask" else tmp_path / "source.npy"
    one = blocked_map(HOLED, tmp_path / "one", STEPS, 100, 4).read()
    with dask.config.set(scheduler=scheduler, num_workers=2):
        two = blocked_map(source, tmp_path / "two", STEPS, 12, 4).read()
    assert np.array_equal(one, two, equal_nan=True)


def test_an_executor_computes_the_blocks(tmp_path):
    """A pool of threads gives the same bits; what takes no work is refused."""
    one = blocked_map(HOLED, tmp_path / "one", STEPS, 100, 4).read()
    with ThreadPoolExecutor(2) as pool:
        two = blocked_map(HOLED, tmp_path / "two", STEPS, 12, 4, executor=pool).read()
    assert np.array_equal(one, two, equal_nan=True)
    with pytest.raises(ArgumentError, match="expected an object with submit"):
        blocked_map(HOLED, tmp_path / "three", STEPS, 12, 4, executor=2)


def test_a_dask_cluster(tmp_path):
    """One task per block on two workers gives the same bits."""
    distributed = pytest.importorskip("dask.distributed")
    one = blocked_map(HOLED, tmp_path / "one", STEPS, 100, 4).read()
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.Client(processes=False, **options) as client:
        blocked_map(HOLED, tmp_path / "sent", STEPS, 12, 4, executor=client)
        two = blocked_map(HOLED, tmp_path / "two", STEPS, 15, 4).read()
    assert np.array_equal(one, two, equal_nan=True)


def test_zarr(tmp_path):
    """An array in two format versions is read; a codec that would run its content is refused."""
    zarr = pytest.importorskip("zarr")
    one = blocked_map(HOLED, tmp_path / "one", STEPS, 100, 4).read()
    for version in (2, 3):
        path = str(tmp_path / f"a{version}.zarr")
        made = zarr.create_array(
            path, shape=HOLED.shape, dtype="f8", chunks=(2, 2, 10, 10), zarr_format=version
        )
        made[...] = HOLED
        found = blocked_map(path, tmp_path / f"z{version}", STEPS, 11, 4)
        assert np.array_equal(one, found.read(), equal_nan=True)
    meta = tmp_path / "a2.zarr" / ".zarray"
    said = json.loads(meta.read_text())
    for key, value in (("compressor", {"id": "pickle"}), ("filters", [{"id": "pickle"}])):
        meta.write_text(json.dumps(said | {key: value}))
        with pytest.raises(FileFormatError, match="expected a supported codec .* got 'pickle'"):
            blocked_map(tmp_path / "a2.zarr", tmp_path / "no", STEPS, 11)


def zarr_array(path: Path, version: int, **options: object) -> list[Path]:
    """An array of 16 chunks without holes, and the files of its chunks."""
    zarr = pytest.importorskip("zarr")
    given = {"chunks": (2, 2, 10, 8)} | options
    made = zarr.create_array(
        str(path), shape=FLAT.shape, dtype="f8", zarr_format=version, overwrite=True, **given
    )
    made[...] = FLAT
    return sorted(x for x in path.rglob("*") if x.is_file() and not x.name.startswith((".z", "z")))


@pytest.mark.parametrize("version", [2, 3])
def test_missing_chunks_of_zarr_are_refused_or_holes(tmp_path, version):
    """Missing chunks are refused, not read as zeros; with NaN as fill value they are holes."""
    path = tmp_path / "a.zarr"
    zarr_array(path, version)[5].unlink()
    with pytest.raises(FileFormatError, match=r"expected 16 chunks, got 15; .* read as"):
        blocked_map(path, tmp_path / "no", STEPS, 11, 4)
    zarr_array(path, version, fill_value=float("nan"))[5].unlink()
    found = blocked_map(path, tmp_path / "one", STEPS, 11, 4).read()
    whole = blocked_map(FLAT, tmp_path / "two", STEPS, 11, 4).read()
    missing = np.isnan(found[0])
    assert 0.05 < missing.mean() < 0.9
    # Beside holes stencils are one-sided.
    assert np.abs(found - whole)[:2, :, :1][~missing[None, :, :1].repeat(2, 0)].max() < 1
    if version == 3:
        shards = zarr_array(path, 3, shards=(2, 2, 20, 16))
        found = blocked_map(path, tmp_path / "shards", STEPS, 11, 4).read()
        assert np.array_equal(found, whole)
        # Other files and foreign chunks do not replace a missing chunk.
        shards[1].rename(path / "c" / "9")
        (path / "README").write_text("")
        with pytest.raises(FileFormatError, match="expected 4 chunks, got 3"):
            blocked_map(path, tmp_path / "no", STEPS, 11, 4)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("key", ["shape", "chunks"])
@pytest.mark.parametrize("value", [0, -3, 10**9, 10**30, "a", 2.5, None])
@pytest.mark.parametrize("fill", [0.0, "NaN"])
def test_declared_sizes_of_zarr_are_checked(tmp_path, version, key, value, fill):
    """Wrong or huge shapes and chunks raise our own errors at once."""
    path = tmp_path / "a.zarr"
    zarr_array(path, version)
    file = path / (".zarray" if version == 2 else "zarr.json")
    said = json.loads(file.read_text())
    said["fill_value"] = fill
    if version == 3 and key == "chunks":
        said["chunk_grid"]["configuration"]["chunk_shape"][2] = value
    else:
        said[key][2] = value
    file.write_text(json.dumps(said))
    with pytest.raises((FileFormatError, LimitError, GridError)):
        blocked_map(path, tmp_path / "out", STEPS, 500, 4)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("content", [b"", b"garbage", None])
def test_damaged_chunks_of_zarr_are_errors_of_ours(tmp_path, version, content):
    """Empty, foreign and truncated chunks raise our own errors."""
    path = tmp_path / "a.zarr"
    chunk = zarr_array(path, version)[5]
    chunk.write_bytes(chunk.read_bytes()[:100] if content is None else content)
    with pytest.raises(FileFormatError, match=r"a.zarr: the file cannot be read: it is truncated"):
        blocked_map(path, tmp_path / "out", STEPS, 11, 4)
    (path / ".zarray" if version == 2 else path / "zarr.json").write_text("[1]")
    with pytest.raises(FileFormatError, match="expected a table"):
        blocked_map(path, tmp_path / "out", STEPS, 11, 4)


def wide(side):
    """A constant field with so many nodes per side, which takes no memory."""
    return np.broadcast_to(np.float64(1.0), (1, 2, side, side))


def test_a_map_without_disk_space_is_refused(tmp_path):
    """Too many blocks or more bytes than the free disk space are refused before the first block."""
    for side, block, message in (
        (10**5, 100, "at most 100,000 blocks, got 1,000,000"),
        (10**6, 5000, "expected .* free bytes for the blocks of the map"),
    ):
        field = Listed(wide(side))
        with pytest.raises(LimitError, match=message):
            blocked_map(field, tmp_path / "a", (1, 1), block)
    assert not (tmp_path / "a").exists()


def test_an_array_of_another_run_is_refused(tmp_path):
    """The message names the difference; a path without a map is refused as well."""
    path = tmp_path / "a"
    blocked_map(FLAT, path, STEPS, 20, 2)
    for arguments, word in (((STEPS, 20, 3), "size"), ((STEPS, 10, 2), "block"),
                            (((0.3, 0.8), 20, 2), "steps")):  # fmt: skip
        with pytest.raises(CheckpointError, match=f"another run, which differs in {word}"):
            blocked_map(FLAT, path, *arguments)
    found = blocked_map(FLAT, path, STEPS, 20, 2)
    found.file(found.numbers[1]).unlink()
    with pytest.raises(CheckpointError, match="expected 4 finished blocks, got 3"):
        found.read()
    meta = path / "zarr.json"
    kept = meta.read_text()
    other = json.loads(kept)
    other["chunk_grid"]["configuration"]["chunk_shape"][1] = 10
    for text in (json.dumps(other), kept.replace("geomtorsion", "another"), "{"):
        meta.write_text(text)
        with pytest.raises(CheckpointError, match="Name another path"):
            blocked_map(FLAT, path, STEPS, 20, 2)
    (tmp_path / "file").write_text("")
    with pytest.raises(CheckpointError, match="got other files"):
        blocked_map(FLAT, tmp_path / "file", STEPS, 20, 2)


@pytest.mark.parametrize("kind", ["array", "dask", "file"])
def test_other_values_of_the_same_size_are_another_field(tmp_path, kind):
    """A difference in one value is refused."""
    other = FLAT.copy()
    other[1, 1, 20, 3] += 1e-9

    def source(values):
        np.save(tmp_path / "field.npy", values)
        whole = da.from_array(values, chunks=10)
        return {"array": values, "dask": whole, "file": tmp_path / "field.npy"}[kind]

    arguments = (tmp_path / "a", STEPS, 20, 2)
    first = blocked_map(source(FLAT), *arguments).read()
    assert np.array_equal(blocked_map(source(FLAT), *arguments).read(), first)
    with pytest.raises(
        CheckpointError, match="got the map of another run, which differs in digest"
    ):
        blocked_map(source(other), *arguments)


INFINITE = FLAT.copy()
INFINITE[1, 0, 20, 3] = np.inf
LYING = da.from_array(FLAT, chunks=10).map_blocks(lambda x: x[:, :, :1], dtype=float)
COMPLEX = da.from_array(FLAT, chunks=10).map_blocks(lambda x: x + 1j, dtype=float)


@pytest.mark.parametrize(
    ("source", "options", "message"),
    [
        (FLAT[0], {}, "source: expected the shape"),
        ("nowhere.npy", {}, "no such file"),
        (FLAT, {"steps": (1, 0)}, r"steps\[1\]: expected a positive number"),
        (FLAT, {"steps": (1,)}, "steps: expected 2 numbers"),
        (FLAT, {"block": 0}, "block: expected a whole number from 1"),
        (FLAT, {"block": (1, 2, 3)}, "block: expected one number or 2"),
        (FLAT, {"size": 40}, "size: expected a whole number from 0 to 36"),
        (FLAT, {"size": (0, 2)}, "size: size 0 means a map of torsion; give 0 for both"),
        (FLAT, {"plane": (0, 0)}, "two different axes"),
        (FLAT, {"plane": (0.0, 1.0)}, "two different axes"),
        (FLAT, {"sigma": -1}, "sigma: expected 0 or more"),
        (FLAT, {"stride": 0}, "stride: expected a whole number from 1"),
        (FLAT[:, :, :4], {}, "axis x: expected 5 points or more"),
        (FLAT.astype(complex), {}, "real numbers"),
        (INFINITE, {}, r"got infinity at node \(20, 3\)"),
        (LYING, {}, r"source: expected real numbers of shape .*, got float64 of shape"),
        (COMPLEX, {}, "source: expected real numbers of shape .*, got complex128"),
    ],
)
def test_maps_that_there_are_not(tmp_path, source, options, message):
    """Each wrong argument has its own message."""
    arguments = {"steps": STEPS, "block": 10} | options
    with pytest.raises((GridError, FileFormatError), match=message):
        blocked_map(source, tmp_path / "a", **arguments)

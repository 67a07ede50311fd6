"""Blocked fields: the same map as in one piece, and equal bits after a kill and resume."""

# dask does not declare its types.
# pyright: reportPrivateImportUsage=false

import signal
import subprocess
import sys
import time
from pathlib import Path

import dask
import numpy as np
import pytest

from geomtorsion.errors import CheckpointError, FileFormatError, GridError
from geomtorsion.materials.fields import BlockMap, SampledFrame
from geomtorsion.materials.fields.blocked_fields import BlockedSurvey, map_in_blocks
from geomtorsion.materials.fields.large_arrays import opened
from geomtorsion.materials.readers import is_array, is_source, open_in_blocks, open_source
from tests.chosen import few
from tests.cli import running
from tests.materials.test_readers import grid
from tests.processes import interruptible

ROOT = Path(__file__).parents[3]


def values(shape: tuple[int, int] = (60, 50)) -> np.ndarray:
    """A coframe with torsion, noise and a hole."""
    x, y = np.meshgrid(*(np.arange(float(n)) for n in shape), indexing="ij")
    found = np.array([[1 - y / 50, x / 50], [0 * x, 1 + np.sin(x / 7)]])
    found += 1e-3 * np.random.default_rng(2).normal(size=found.shape)
    found[:, :, 20:25, 10:16] = np.nan
    return found


def run(
    path: Path, folder: Path, block: int | None, size: int = 4, **options: bool
) -> BlockedSurvey:
    """The map of a file, computed or resumed."""
    return map_in_blocks(open_in_blocks(path), folder / "map.zarr", block, size, (0, 1), **options)


def chunks(folder: Path) -> list[Path]:
    """The finished blocks."""
    return [file for file in (folder / "map.zarr" / "c").rglob("*") if file.is_file()]


@pytest.mark.parametrize("turned", [False, True])
def test_a_map_in_blocks_is_that_at_once(tmp_path, turned):
    """Values, positions, units, maximum and counts agree, also for descending axes."""
    axes = [0.5 * np.arange(60.0), 0.5 * np.arange(50.0)]
    whole = values()
    if turned:
        axes[1], whole = axes[1][::-1], whole[..., ::-1]
    path = tmp_path / "field.npz"
    SampledFrame(axes, whole, sigma=1e-3, unit="um").save(path)
    survey, numbers = run(path, tmp_path / "o", 17).survey()
    once = SampledFrame.read(path).burgers_map(4, widen=False)
    at = np.s_[:, :, ::-1] if turned else np.s_[:, :]
    assert survey.vectors == pytest.approx(once.vectors[at], abs=1e-12, nan_ok=True)
    assert survey.lines[1] == pytest.approx(np.sort(once.lines[1]))
    assert numbers["known"] == once.known.sum() < once.known.size
    assert numbers["largest"] == pytest.approx(np.nanmax(once.per_area))
    assert (survey.unit, survey.density_unit) == ("um", "1/um")


def noisy(n: int, defects: bool) -> np.ndarray:
    """The identity with unequal white noise in each component; with defects, five of b = 0.2."""
    rng = np.random.default_rng(7)
    found = np.eye(2)[:, :, None, None] + np.array([[1e-3, 2e-3], [1e-5, 4e-5]])[
        ..., None, None
    ] * rng.standard_normal((2, 2, n, n))
    if defects:
        x, y = np.meshgrid(*[np.arange(float(n))] * 2, indexing="ij")
        for a, b in rng.uniform(30, n - 30, (5, 2)):
            one, two = x - a + 0.31, y - b + 0.17
            found[0] += 0.2 / (2 * np.pi) * np.array([-two, one]) / (one**2 + two**2)
    return found


@pytest.mark.parametrize(("n", "defects"), few(2, [(200, True), (300, False), (530, False)]))
def test_noise_is_estimated_as_at_once(tmp_path, n, defects):
    """Noise passes in 0.1 % of all circuits in both maps; defects are significant in both.

    The larger field has more nodes than the sample from which its noise is estimated.
    """
    whole = noisy(n, defects)
    np.save(tmp_path / "field.npy", whole)
    survey, numbers = run(tmp_path / "field.npy", tmp_path / "o", 100, size=8).survey()
    SampledFrame([np.arange(float(n))] * 2, whole).save(tmp_path / "field.npz")
    once = open_source(tmp_path / "field.npz").burgers_map(8)
    # The sample gives each sigma within two percent; a small field is used completely.
    exact = n < 500
    assert survey.significance == pytest.approx(once.significance, rel=1e-6 if exact else 0.1)
    assert survey.noise == pytest.approx(once.noise, rel=1e-9 if exact else 0.02)
    assert survey.systematic_error == pytest.approx(
        once.systematic_error, rel=1e-6, abs=1e-9 if exact else 1e-4
    )
    share = numbers["significant"] / numbers["known"]
    assert share == pytest.approx(once.significant.mean(), abs=0 if exact else 3e-4)
    if defects:
        # Each defect is inside 64 circuits.
        found = np.linalg.norm(survey.vectors, axis=0) > 0.15
        assert survey.significant[found].mean() > 0.9
        assert found.sum() > 5 * 50
    else:
        assert 0 < share < 2e-3


def test_noise_of_a_volume_is_estimated_from_a_sample(tmp_path):
    """Three axes, one of them short, with a hole over one half: each sigma is within 3 percent."""
    sigma = np.array([[1e-3, 2e-3, 3e-3]])
    whole = sigma[..., None, None, None] * np.random.default_rng(3).standard_normal(
        (1, 3, 9, 200, 190)
    )
    whole[..., 90:] = np.nan
    np.save(tmp_path / "field.npy", whole)
    field = open_in_blocks(tmp_path / "field.npy")
    assert field.sigma == pytest.approx(sigma, rel=0.03)
    assert "in a sample of the field" in field.description[1]


def test_a_volume_and_its_strongest_layer(tmp_path):
    """For a plane of a grid of three axes, the survey has the layer with the largest b."""
    axes = [np.arange(9.0), np.arange(10.0), np.arange(7.0)]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    SampledFrame(axes, np.array([[-y * z, x * z, 0 * z]]) / 2, sigma=0.1).save(tmp_path / "v.npz")
    survey, numbers = run(tmp_path / "v.npz", tmp_path / "o", 4, size=2).survey()
    assert survey.layers == ("z = 6",)
    assert numbers["largest"] == pytest.approx(6.0)
    assert numbers["circuits"] == 7 * 8 * 7


# Slow runs also kill a zarr map.
@pytest.mark.parametrize("end", [".npy", pytest.param(".zarr", marks=pytest.mark.slow)])
def test_killed_and_taken_up_again(tmp_path, end):
    """The command, killed while it works and resumed, gives the map of one run bit for bit."""
    path = tmp_path / f"field{end}"
    if end == ".npy":
        np.save(path, values((100, 80)))
    else:
        zarr = pytest.importorskip("zarr")
        made = zarr.open_array(str(path), mode="w", shape=(2, 2, 100, 80), chunks=(2, 2, 50, 50),
                               dtype="float64")  # fmt: skip
        made[:] = values((100, 80))
    given = ["map", str(path), "--size", "5", "--sigma", "0.001"]
    out = tmp_path / "out"
    command = [sys.executable, "-m", "geomtorsion", *given, "--blocks", "10", "-o", str(out)]
    began = interruptible(command, cwd=ROOT)
    for _ in range(3000):
        if len(chunks(out)) > 10:
            break
        time.sleep(0.02)
    began.send_signal(signal.SIGKILL)
    assert began.wait() == -signal.SIGKILL
    assert 10 < len(chunks(out)) < 80
    assert "--resume" in running.run(*given, "-o", str(out), code=2).stderr
    running.run(*given, "-o", str(out), "--resume")
    running.run(*given, "-o", str(tmp_path / "one"))
    one, two = (opened(str(folder / "map.zarr"))[:] for folder in (out, tmp_path / "one"))
    assert one.tobytes() == two.tobytes()
    assert (out / "map.json").read_bytes() == (tmp_path / "one" / "map.json").read_bytes()


def test_stopped_by_hand(tmp_path):
    """Ctrl-C: finished blocks are kept, the message names --resume, and the exit code is 130."""
    np.save(tmp_path / "field.npy", values((100, 80)))
    command = [sys.executable, "-m", "geomtorsion", "map", str(tmp_path / "field.npy"), "--blocks",
               "8", "-o", str(tmp_path / "out")]  # fmt: skip
    began = interruptible(command, cwd=ROOT, stderr=subprocess.PIPE)
    for _ in range(3000):
        if chunks(tmp_path / "out"):
            break
        time.sleep(0.02)
    began.send_signal(signal.SIGINT)
    _, said = began.communicate()
    assert began.returncode == 130
    assert b"resume with --resume" in said
    assert b"Traceback" not in said


def test_a_run_is_resumed_as_it_was(tmp_path, monkeypatch):
    """A stopped map needs resume or overwrite; another file, size or block is refused."""
    path, out = grid(tmp_path, sigma=0.1), tmp_path / "o"
    with pytest.raises(CheckpointError, match="expected a stopped map, got none"):
        run(path, out, 5, resume=True)
    compute = BlockMap.compute

    def stopping(self: BlockMap, number: tuple[int, ...]) -> None:
        if len(chunks(out)) == 2:
            raise KeyboardInterrupt
        compute(self, number)

    monkeypatch.setattr(BlockMap, "compute", stopping)
    with pytest.raises(KeyboardInterrupt), dask.config.set(scheduler="synchronous"):
        run(path, out, 5)
    monkeypatch.undo()
    kept = chunks(out)
    assert len(kept) == 2
    times = [file.stat().st_mtime_ns for file in kept]
    for options, message in (
        ({}, "--resume to continue it"),
        ({"resume": True, "overwrite": True}, "Give one of them"),
        ({"resume": True, "size": 2}, "another run, which differs in size"),
        ({"resume": True, "block": 4}, "another run, which differs in block"),
    ):
        with pytest.raises(CheckpointError, match=message):
            run(path, out, **{"block": None, **options})
    with pytest.raises(CheckpointError, match="which differs in sigma"):
        run(grid(tmp_path, "b.npz", sigma=0.2), out, None, resume=True)
    found = run(path, out, None, resume=True)
    assert found.result.block == (5, 5)
    assert [file.stat().st_mtime_ns for file in kept] == times
    # A refused request leaves the finished map, an accepted request replaces it.
    with pytest.raises(GridError, match="size"):
        run(path, out, 5, size=400)
    assert [file.stat().st_mtime_ns for file in kept] == times
    assert run(path, out, 7).result.block == (7, 7)


def test_what_cannot_be_done_leaves_nothing_to_resume(tmp_path):
    """An infinite value ends the first run; after the file is corrected, a new run starts."""
    whole = np.where(np.isnan(values()), 1.0, values())
    whole[0, 0, 3, 3] = np.inf
    np.save(tmp_path / "field.npy", whole)
    field = open_in_blocks(tmp_path / "field.npy", sigma=0.1)
    with pytest.raises(GridError, match="got infinity at node"):
        map_in_blocks(field, tmp_path / "map.zarr", 100, 4, (0, 1))
    whole[0, 0, 3, 3] = 1.0
    np.save(tmp_path / "field.npy", whole)
    field = open_in_blocks(tmp_path / "field.npy", sigma=0.1)
    map_in_blocks(field, tmp_path / "map.zarr", 100, 4, (0, 1))


def test_anything_but_a_field_is_refused(tmp_path):
    """Images, unequal noise, missing files and redundant steps are refused."""
    np.save(tmp_path / "image.npy", np.zeros((40, 40)))
    assert not is_array(tmp_path / "image.npy")
    np.save(tmp_path / "field.npy", values())
    assert is_array(tmp_path / "field.npy")
    with pytest.raises(GridError, match="sigma: expected one of estimate"):
        open_in_blocks(tmp_path / "field.npy", sigma="guess")
    np.save(tmp_path / "unknown.npy", np.full((2, 2, 30, 30), np.nan))
    with pytest.raises(GridError, match="sigma: expected rows of seven known nodes"):
        open_in_blocks(tmp_path / "unknown.npy")
    np.save(tmp_path / "turned.npy", np.moveaxis(values(), (0, 1), (2, 3)))
    with pytest.raises(GridError, match="expected 2 columns, one for each axis of the grid, got"):
        open_in_blocks(tmp_path / "turned.npy")
    np.save(tmp_path / "infinite.npy", np.where(values() > 1, np.inf, values()))
    with pytest.raises(GridError, match="got infinity at node"):
        open_in_blocks(tmp_path / "infinite.npy")
    SampledFrame([np.arange(60.0), np.arange(50.0)], values(), covariance=np.eye(4)).save(
        tmp_path / "joined.npz"
    )
    with pytest.raises(GridError, match="covariance: expected independent noise"):
        open_in_blocks(tmp_path / "joined.npz")
    sigmas = np.linspace(1, 2, 11 * 13).reshape(11, 13)
    with pytest.raises(GridError, match="the same noise at all nodes .* 1 to 2"):
        open_in_blocks(grid(tmp_path, sigma=sigmas))
    with pytest.raises(
        GridError, match=r"steps: expected no option, because field.npz contains the axes"
    ):
        open_in_blocks(tmp_path / "field.npz", steps=[1, 1])
    with pytest.raises(FileFormatError, match="no such file"):
        open_in_blocks(tmp_path / "none.zarr")
    assert is_source(tmp_path / "none.zarr")
    with pytest.raises(GridError, match="mapped in blocks: geomtorsion map FILE -o DIR"):
        open_source(tmp_path / "field.npy")

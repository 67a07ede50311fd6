"""Blocks: a ledger that refuses other work, files that are whole, and runs of what is left."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from geomtorsion.errors import CheckpointError, LimitError
from geomtorsion.materials.blocks import LEDGER, open_ledger, read_array, run_blocks, write_array


def test_a_ledger_takes_up_its_own_work_alone(tmp_path):
    """The same description goes on, another one and damage are refused with what differs."""
    folder = tmp_path / "new"
    assert not open_ledger(folder, {"size": 3, "name": "a"})
    assert open_ledger(folder, {"size": 3, "name": "a"})
    with pytest.raises(CheckpointError, match="another run: size differ"):
        open_ledger(folder, {"size": 4, "name": "a"})
    (folder / LEDGER).write_text("{")
    with pytest.raises(CheckpointError, match="Take an empty folder"):
        open_ledger(folder, {"size": 3, "name": "a"})


def test_arrays_are_whole_or_not_there(tmp_path):
    """What was cut, has another shape or other numbers counts as missing."""
    path, values = tmp_path / "a.npy", np.arange(6.0).reshape(2, 3)
    assert read_array(path, (2, 3)) is None
    write_array(path, values)
    assert [file.name for file in tmp_path.iterdir()] == ["a.npy"]
    for shape in ((2, 3), (None, 3), (None, None)):
        found = read_array(path, shape)
        assert found is not None
        assert np.array_equal(found, values)
    assert read_array(path, (3, 3)) is None
    assert read_array(path, (None,)) is None
    assert read_array(path, (2, 3), np.int64) is None
    path.write_bytes(path.read_bytes()[:-1])
    assert read_array(path, (2, 3)) is None


class Client:
    """As much of a cluster's client as is used."""

    def map(self, task, numbers, pure):
        """Futures of a few threads."""
        assert not pure
        with ThreadPoolExecutor(2) as pool:
            return [pool.submit(task, number) for number in numbers]


def square(number):
    """A task that leaves its trace."""
    path, value = number
    path.write_text(str(value**2))


@pytest.mark.parametrize(("workers", "client"), [(1, None), (2, None), (1, Client())], ids=range(3))
def test_every_block_is_run_once(tmp_path, workers, client):
    """Here, in processes, by a client."""
    run_blocks(square, [(tmp_path / str(k), k) for k in range(5)], workers, client)
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {
        str(k): str(k**2) for k in range(5)
    }


def test_errors_of_blocks_come_through():
    """The first one ends the run."""
    with pytest.raises(ZeroDivisionError):
        run_blocks(lambda number: 1 / number, [1, 0, 2])


def test_a_process_that_ends_is_told():
    """As when the system ends it for want of memory, or it cannot begin."""
    with pytest.raises(LimitError, match=r"ended before .* smaller blocks.* __name__"):
        run_blocks(os._exit, [3, 3], workers=2)

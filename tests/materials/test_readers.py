"""Readers: files are recognised by name and content; foreign options are named."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportAttributeAccessIssue=false, reportArgumentType=false

import gzip
import re

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import (
    ArgumentError,
    FileFormatError,
    GridError,
    ImageError,
    OrientationError,
)
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.images import LatticePhases
from geomtorsion.materials.maps import OrientationMap
from geomtorsion.materials.readers import is_source, open_source
from tests.materials.images.atoms import crystal
from tests.materials.maps.test_map_files import ctf, write
from tests.materials.maps.test_map_points import h5oina


def grid(folder, name="field.npz", **options):
    """A plane grid of constant torsion 1, as a file."""
    axes = [np.linspace(0, 5, 11), np.linspace(0, 6, 13)]
    x, y = np.meshgrid(*axes, indexing="ij")
    SampledFrame(axes, np.array([[-y, x]]) / 2, **options).save(folder / name)
    return folder / name


@pytest.mark.parametrize("name", ["a.npz", "a.nc", "a.csv"])
def test_grids_of_every_kind(tmp_path, name):
    """A saved grid opens with its unit and its noise."""
    field = open_source(grid(tmp_path, name, sigma=0.25, unit="nm"))
    assert isinstance(field, SampledFrame)
    assert field.unit == "nm"
    assert field.sigma.max() == 0.25


def test_noise_is_given_or_estimated(tmp_path):
    """Without noise in the file it is estimated, as the description states; a given value wins."""
    path = grid(tmp_path)
    assert "median of sixth differences" in open_source(path).description[1]
    assert open_source(path, sigma=0.5).sigma.max() == 0.5
    assert open_source(path, order=2).order == 2


def test_orientation_maps(tmp_path):
    """A .ctf file is an orientation map with a threshold and a noise."""
    path = write(tmp_path, ctf(), "a.ctf")
    field = open_source(path, sigma=0.5, threshold=7)
    assert isinstance(field, OrientationMap)
    assert field.threshold == 7
    assert "0.5 degrees in Nickel (given)" in field.description[2]


def test_content_against_name(tmp_path):
    """A renamed file is recognised by its first bytes, and the error gives the remedy."""
    path = grid(tmp_path).rename(tmp_path / "map.ctf")
    with pytest.raises(
        FileFormatError, match=re.escape("ending in .npz, to match the content, got '.ctf'")
    ):
        open_source(path)
    path = write(tmp_path, ctf(), "map.txt")
    assert is_source(path)
    with pytest.raises(FileFormatError, match=re.escape("ending in .ctf") + ".*Rename it"):
        open_source(path)


def test_names_that_mean_nothing(tmp_path):
    """Names of spaces are not sources, and unknown endings are refused."""
    assert not is_source("so3")
    (tmp_path / "a.doc").write_text("nothing")
    with pytest.raises(FileFormatError, match="a name ending in"):
        open_source(tmp_path / "a.doc")


def test_options_that_do_not_belong(tmp_path):
    """Each foreign option is named; some errors also give the remedy."""
    with pytest.raises(GridError, match="threshold: expected a file of orientation maps.*Omit the"):
        open_source(grid(tmp_path), threshold=3)
    with pytest.raises(
        OrientationError, match="order: expected a file of sampled frames, got an orientation map"
    ):
        open_source(write(tmp_path, ctf(), "a.ctf"), order=4)
    with pytest.raises(OrientationError, match="sigma"):
        open_source(write(tmp_path, ctf(), "a.ctf"), sigma="guess")


def test_images(tmp_path):
    """An array of grey values becomes phases; options of other sources are refused."""
    image = crystal(96, "square", dislocated=False)
    path = tmp_path / "atoms.npy"
    np.save(path, image.values)
    field = open_source(
        path, pixel=(0.05, "nm"), spots=(image.vectors / 0.05).tolist(), resolution=0.5
    )
    assert isinstance(field, LatticePhases)
    assert (field.unit, field.resolution) == ("nm", 0.5)
    with pytest.raises(ImageError, match="sigma: expected a file of sampled frames, got an image"):
        open_source(path, sigma=1)
    with pytest.raises(GridError, match="pixel: expected a file of lattice images"):
        open_source(grid(tmp_path), pixel=(1, "nm"))
    np.save(path, np.random.default_rng(0).normal(size=(128, 128)))
    with pytest.raises(ImageError, match="no visible lattice"):
        open_source(path)


def test_hdf5_is_recognized_by_its_content(tmp_path):
    """A file with the data set is a sampled frame; any other file is a map."""
    h5py = pytest.importorskip("h5py")
    assert isinstance(open_source(grid(tmp_path, "field.h5")), SampledFrame)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["numbers"] = np.arange(5)
    with pytest.raises(
        gt.GeomtorsionError, match="phi1, Phi, phi2 .* or coframe of a field, got numbers 5"
    ):
        open_source(tmp_path / "other.h5")


def test_orientations_in_hdf5(tmp_path):
    """A map written by orix is an orientation map."""
    io = pytest.importorskip("orix.io")
    path = write(tmp_path, ctf(), "a.ctf")
    io.save(str(tmp_path / "a.h5"), io.load(str(path)))
    field = open_source(tmp_path / "a.h5", threshold=7)
    assert isinstance(field, OrientationMap)
    assert field.shape == open_source(path).shape


def test_sizes_of_pixels_and_names_of_files(tmp_path):
    """A pixel size that is not a pair and a path that is not a name are refused."""
    path = tmp_path / "atoms.npy"
    np.save(path, np.eye(40))
    for pixel in (0.5, (0.5,), (0.5, "nm", 1)):
        with pytest.raises(ImageError, match="pixel: "):
            open_source(path, pixel=pixel)
    with pytest.raises(ArgumentError, match="path: expected the name of a file, got 5"):
        open_source(5)


@pytest.mark.parametrize("name", ["a.csv", "a.txt", "a.csv.gz"])
def test_endings_that_maps_and_fields_share(tmp_path, name):
    """A table with columns of angles is a map, a table of a coframe is a field."""
    rows = ["phi1,Phi,phi2,x,y", *(f"1,2,{c},{c},{r}" for r in range(5) for c in range(6))]
    path = tmp_path / name
    content = "\n".join(rows).encode()
    path.write_bytes(gzip.compress(content) if name.endswith("gz") else content)
    found = open_source(path, laue={0: "m-3m"}, sigma=0.1)
    assert isinstance(found, OrientationMap)
    assert found.shape == (5, 6)
    if name == "a.csv":
        grid(tmp_path, "b.csv")
        assert isinstance(open_source(tmp_path / "b.csv"), SampledFrame)
        with pytest.raises(GridError, match=r"laue: expected a file of orientation maps"):
            open_source(tmp_path / "b.csv", laue={0: "m-3m"})


def test_packed_and_new_maps(tmp_path):
    """A gzip-packed map and a map in Oxford's HDF5 are recognised by their endings."""
    text = "\n".join(ctf()) + "\n"
    (tmp_path / "a.ctf.gz").write_bytes(gzip.compress(text.encode()))
    assert isinstance(open_source(tmp_path / "a.ctf.gz", sigma=0.1), OrientationMap)
    assert isinstance(open_source(h5oina(tmp_path / "a.h5oina"), sigma=0.1), OrientationMap)


def test_tables_are_recognized_by_their_columns(tmp_path):
    """Text ending in .csv is a sampled frame or an orientation map."""
    assert isinstance(open_source(grid(tmp_path, "a.csv")), SampledFrame)
    rows = ["phi1,Phi,phi2,phase,x,y"]
    rows += [f"{0.1 * x},20,30,1,{x},{y}" for y in range(8) for x in range(9)]
    path = tmp_path / "b.csv"
    path.write_text("\n".join(rows))
    found = open_source(path, laue={1: "m-3m"})
    assert isinstance(found, OrientationMap)
    assert found.shape == (8, 9)
    with pytest.raises(
        OrientationError, match="order: expected a file of sampled frames, got an o"
    ):
        open_source(path, order=4)

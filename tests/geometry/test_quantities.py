"""The table of quantities: each row reaches every place that shows, checks or plans tensors."""

from __future__ import annotations

from dataclasses import replace
from operator import attrgetter

import pytest

import geomtorsion as gt
from geomtorsion import gravity
from geomtorsion.errors import UnknownNameError
from geomtorsion.geometry.quantities import FRAME_QUANTITIES, SECTIONS, TABLE, Entry, entry
from geomtorsion.pictures.quantities import chosen_quantities
from geomtorsion.pictures.report import write_report
from geomtorsion.pictures.sections import aligned, section
from geomtorsion.spaces import KnownAnswer, disagreements
from geomtorsion.teaching.lab.tetrad import tetrad

# A space with a connection of its own, in three dimensions.
SPACE = gt.spaces.load("axial_torsion")
SO3 = gt.spaces.load("so3").frame


@pytest.mark.parametrize("row", TABLE, ids=lambda row: row.name)
def test_a_row_is_enough(row: Entry):
    """A row gives the tensor, its display, its plan, and what known answers check."""
    tensor = SPACE.quantity(row.name)
    assert row.section in SECTIONS
    # Display: title, definition and letter, as text, HTML and LaTeX.
    [shown] = chosen_quantities(SPACE, [row.name])
    assert shown.tensor is tensor
    assert shown.text_label.startswith(row.symbol)
    assert f'id="{row.name}"' in section(shown)
    assert row.title in section(shown)
    assert not any(letter in aligned(shown) for letter in "Γω\u0304")
    # Known answers: the computed components agree, and one more is a disagreement.
    answer = KnownAnswer(row.name, dict(tensor.nonzero()), basis="natural")
    if not tensor.slots:
        answer = replace(answer, components=tensor[()])
    assert disagreements(SPACE, answer) == ()
    index = (0,) * len(tensor.slots)
    wrong = {**dict(tensor.nonzero()), index: tensor[index] + 1}
    [found] = disagreements(SPACE, replace(answer, components=wrong))
    assert (found.quantity, found.index) == (row.name, index)
    # Plan: what the row needs is in the table.
    if row.of != "connection":
        assert SPACE.frame.plan(row.name).steps[-1].meaning == row.title
        assert {*row.needs, *row.needs_if_dense} <= FRAME_QUANTITIES.keys()


def test_the_page_shows_what_the_table_offers():
    """Typed tetrads show the rows that the table marks, and offer the others that it marks."""
    polar = {
        "coordinates": "r, phi, z",
        "entries": [["1", "0", "0"], ["0", "r", "0"], ["0"] * 2 + ["1"]],
    }
    everything = tetrad(**polar, show=list(FRAME_QUANTITIES))["html"]
    usual = tetrad(**polar)["html"]
    for row in TABLE:
        assert (f'id="{row.name}"' in everything) == bool(row.page), row.name
        assert (f'id="{row.name}"' in usual) == (row.page == "shown"), row.name


def test_a_report_shows_what_the_table_reports(tmp_path):
    """A report has a section for each row with `reported`, also of the space's own connection."""
    write_report(SPACE, tmp_path)
    [page] = tmp_path.glob("*.html")
    text = page.read_text("utf-8")
    for row in TABLE:
        assert (f'id="{row.name}"' in text) == row.reported, row.name


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: SO3.quantity("torsoin"), "got 'torsoin'. Did you mean torsion"),
        (lambda: SO3.quantity("é"), "There are: coframe, metric"),
        (lambda: SO3.plan("connection_ricci"), "Use connection.curvature.ricci, or space.quantity"),
        (lambda: SPACE.frame.quantity("connection_scalar"), "got one of a connection"),
        (
            lambda: gt.spaces.load("so3").quantity("connection_torsion"),
            "expected a space with its own connection, got so3",
        ),
        (lambda: entry("Rici-"), "Did you mean ricci"),
    ],
)
def test_refusals(call, words):
    """Unknown names are refused, and quantities of a connection where there is none."""
    with pytest.raises(UnknownNameError, match=words):
        call()


@pytest.mark.parametrize("name", ["schwarzschild", "so3", "frw", "kerr_kinnersley"])
def test_the_superpotential_is_the_momentum_of_the_torsion_scalar(name):
    """T_ab^c P^ab_c = 2 T, and P is the derivative by torsion in the field equations of L = T."""
    frame = gt.spaces.load(name).frame
    torsion = gt.cartan(frame).torsion
    product = gt.contract("abc,abc->", torsion.T, torsion.superpotential)
    assert (product - torsion.scalar * 2).is_zero
    momentum = gravity.equations(gt.cartan(frame), "T").P
    assert (torsion.superpotential.in_frame().raised() - momentum.in_frame().raised()).is_zero


def test_the_superpotential_of_a_general_connection():
    """The relation to the torsion scalar needs no parallel legs and no metric compatibility."""
    torsion = gt.from_torsion(SO3, gt.cartan(SO3).torsion.S * 3).torsion
    assert (
        gt.contract("abc,abc->", torsion.T, torsion.superpotential) - torsion.scalar * 2
    ).is_zero
    assert not torsion.superpotential.is_zero


@pytest.mark.parametrize("row", TABLE, ids=lambda row: row.name)
def test_a_docstring_names_the_slots(row: Entry):
    """Each property names its slots, their kind, and the method that changes the kind."""
    owners = {
        "frame": SO3,
        "cartan": gt.cartan(SO3),
        "levi_civita": gt.levi_civita(SO3),
        "connection": gt.cartan(SO3),
    }
    owner, tensor = owners[row.of], attrgetter(row.attribute)(owners[row.of])
    *path, name = row.attribute.split(".")
    kind = type(attrgetter(".".join(path))(owner) if path else owner)
    # A field of a class has its line in the docstring of the class.
    text = " ".join((getattr(kind, name, kind).__doc__ or "").split())
    if not tensor.slots:
        assert "rank 0" in text
        return
    assert f"slots {tensor.slots}" in text
    if row.attribute == "coefficients":
        assert "`spin_connection` has leg slots" in text
    elif tensor.slots.isupper():
        assert "Leg slots; in coordinates: `.in_coordinates()`." in text
        assert tensor.in_coordinates().slots == tensor.slots.lower()
    else:
        assert "along the legs: `.in_frame()`." in text
        assert ("Coordinate slots" in text) == tensor.slots.islower()
        assert tensor.in_frame().slots == tensor.slots.upper()

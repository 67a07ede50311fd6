"""Families of frames from which a seed chooses."""

import numpy as np
import pytest

from geomtorsion import spaces
from geomtorsion.teaching.exercises.draw import Draw
from geomtorsion.teaching.exercises.families import SHIPPED, Body, bodies, matrix_of
from tests.rounding import ROUNDED


@pytest.mark.parametrize("times", [(1, 1, 1), (2, 1, 1), (1, 3, 1), (1, 1, 2)])
@pytest.mark.parametrize("axes", sorted(SHIPPED))
def test_frames_belong_to_their_attitude(axes, times):
    """R^T R' is the coframe applied to the rates; R' R^T is the space-fixed frame."""
    body = Body(axes, times)
    turn, angles = body.rotation(), body.frame.coordinates
    here = dict(zip(angles, (0.3, 1.1, -0.7), strict=True))

    def numbers_of(matrix) -> np.ndarray:
        return np.array(matrix.subs(here).tolist(), dtype=float)

    body_space = numbers_of(turn)
    assert body_space.T @ body_space == pytest.approx(np.eye(3), abs=ROUNDED)
    for mu, angle in enumerate(angles):
        slope = numbers_of(turn.diff(angle))
        for table, matrix in (
            (body.frame, body_space.T @ slope),
            (body.space_frame, slope @ body_space.T),
        ):
            column = numbers_of(matrix_of(table.coframe))[:, mu]
            assert column == pytest.approx([matrix[2, 1], matrix[0, 2], matrix[1, 0]], abs=1e-13)


def test_the_space_fixed_frame_is_the_shipped_one():
    """For the angles of the paper the space-fixed frame is so3_right."""
    shipped = spaces.load("so3_right").frame
    assert matrix_of(Body("zyz").space_frame.coframe) == matrix_of(shipped.coframe)


def test_a_stretched_form_is_stretched_in_both_frames():
    """A stretch multiplies one row of both coframes."""
    body = next(body for body in bodies() if body.stretch == (1, 3))
    plain = Body(body.axes)
    for one, two in ((body.frame, plain.frame), (body.space_frame, plain.space_frame)):
        rows, plain_rows = matrix_of(one.coframe), matrix_of(two.coframe)
        assert rows[1, :] == 3 * plain_rows[1, :]
        assert rows[0, :] == plain_rows[0, :]


@pytest.mark.parametrize("sizes", [(7,), (2, 3), (4, 3, 5), (2, 2, 2, 2)])
def test_seeds_below_the_number_of_combinations_choose_differently(sizes):
    """Each combination occurs once; seed 0 takes the first of each."""
    taken = []
    for seed in range(int(np.prod(sizes))):
        draw = Draw(seed)
        taken.append(tuple(draw.choice(range(size)) for size in sizes))
    assert len(set(taken)) == len(taken)
    assert taken[0] == (0,) * len(sizes)


def test_neighbouring_seeds_differ_in_every_choice():
    """Neighbouring seeds differ in each choice, because students of a class compare answers."""
    one, two = Draw(3), Draw(4)
    for size in (7, 5, 4):
        assert one.choice(range(size)) != two.choice(range(size))

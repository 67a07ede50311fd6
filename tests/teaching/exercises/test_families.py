"""Families of frames from which a seed takes one."""

import numpy as np
import pytest

from geomtorsion import spaces
from geomtorsion.teaching.exercises.families import ANGLES, attitude, matrix_of, seen_from_space


@pytest.mark.parametrize("name", sorted(ANGLES))
def test_frames_belong_to_their_attitude(name):
    """R^T R' is the coframe applied to the rates, R' R^T that of the space-fixed frame."""
    frame, turn = spaces.load(name).frame, attitude(name)
    angles = frame.coordinates
    here = dict(zip(angles, (0.3, 1.1, -0.7), strict=True))

    def numbers_of(matrix) -> np.ndarray:
        return np.array(matrix.subs(here).tolist(), dtype=float)

    body_space = numbers_of(turn)
    assert body_space.T @ body_space == pytest.approx(np.eye(3), abs=1e-14)
    for mu, angle in enumerate(angles):
        slope = numbers_of(turn.diff(angle))
        for table, matrix in (
            (frame, body_space.T @ slope),
            (seen_from_space(name), slope @ body_space.T),
        ):
            column = numbers_of(matrix_of(table.coframe))[:, mu]
            assert column == pytest.approx([matrix[2, 1], matrix[0, 2], matrix[1, 0]], abs=1e-14)


def test_the_space_fixed_frame_is_the_shipped_one():
    """For the angles of the paper it is so3_right."""
    assert matrix_of(seen_from_space("so3").coframe) == matrix_of(
        spaces.load("so3_right").frame.coframe
    )

"""paper: equations (1) to (27) of Fiziev and Kleinert (1994), each recomputed."""

from __future__ import annotations

from geomtorsion.paper import section1, section2, section3, section4
from geomtorsion.paper.frames import PaperFrames, paper_frames
from geomtorsion.paper.statement import Statement


def statements(frames: PaperFrames | None = None) -> tuple[Statement, ...]:
    """All statements in the order of the paper, each recomputed by the generic classes.

    Parameters
    ----------
    frames
        the frames of rotations and of motions; the frames of the paper if None.

    Examples
    --------
    >>> [one.equation for one in statements() if not one.agrees]
    ['(9) right', 'after (9)', '(11)', '(17)', '(18)', 'around (21)', '(23)', 'under (24)', \
'(26)', '(27)']
    """
    frames = frames or paper_frames()
    sections = (section1, section2, section3, section4)
    return tuple(one for section in sections for one in section.statements(frames))


__all__ = ["PaperFrames", "Statement", "paper_frames", "statements"]

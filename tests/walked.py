"""What a reader passes who follows the first motion of a process: `python -m tests.walked`.

Prints how many files have a function that is called between `geodesic` and the end of `solve`, and
how many frames of the package stand in each other at most; what imports run does not count.
"""

import sys
import threading
from pathlib import Path
from types import FrameType

# Not of the package, and loaded before anything is counted.
import flint  # noqa: F401
import scipy.interpolate  # noqa: F401

import geomtorsion
from geomtorsion import geodesic, solve, spaces

PACKAGE = str(Path(geomtorsion.__file__).parent)
# It stands for functools, of which a reader passes nothing.
CACHING = str(Path(geomtorsion.__file__).parent / "caching.py")


def is_passed(frame: FrameType) -> bool:
    """Whether a reader passes the function of a frame."""
    name = frame.f_code.co_filename
    return name.startswith(PACKAGE) and name != CACHING


class Walk:
    """The files passed so far, and the deepest stack."""

    def __init__(self) -> None:
        self.files: set[str] = set()
        self.depth = 0

    def __call__(self, frame: FrameType, event: str, _: object) -> None:
        """Notes a call."""
        if event != "call" or not is_passed(frame):
            return
        depth, at = 0, frame
        while at is not None:
            if is_passed(at):
                if at.f_code.co_name == "<module>":
                    return
                depth += 1
            at = at.f_back
        self.files.add(frame.f_code.co_filename)
        self.depth = max(self.depth, depth)


def main() -> None:
    """An orbit around Kerr's hole."""
    kerr, walk = spaces.load("kerr").frame, Walk()
    threading.setprofile(walk)
    sys.setprofile(walk)
    orbit = geodesic(kerr, [0, 8, 1.4, 0], [1.2, -0.1, 0.02, 0.05], parameters={"M": 1, "a": 0.5})
    solution = solve(orbit, t=20.0, accuracy=1e-9)
    sys.setprofile(None)
    threading.setprofile(None)
    assert solution.error < 1e-9
    print(len(walk.files), walk.depth)


if __name__ == "__main__":
    main()

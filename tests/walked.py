"""Walked: the code that runs in the first motion of a process: `python -m tests.walked`.

Prints the number of files with a function that runs between `geodesic` and the end of `solve`, and
the largest number of nested calls within the package. Code that runs on import does not count.
"""

import sys
import threading
from pathlib import Path
from types import FrameType

# Other packages are loaded before counting starts.
import flint  # noqa: F401
import scipy.interpolate  # noqa: F401

import geomtorsion
from geomtorsion import geodesic, solve, spaces

PACKAGE = str(Path(geomtorsion.__file__).parent)
# They wrap a function as functools does; the wrapped function itself is read.
WRAPPERS = {str(Path(PACKAGE) / "support" / name) for name in ("caching.py", "exclusive.py")}


def is_passed(frame: FrameType) -> bool:
    """Whether someone who follows the motion reads the function of a frame."""
    name = frame.f_code.co_filename
    return name.startswith(PACKAGE) and name not in WRAPPERS


class Walk:
    """The files visited so far and the depth of the deepest stack."""

    def __init__(self) -> None:
        self.files: set[str] = set()
        self.depth = 0

    def __call__(self, frame: FrameType, event: str, _: object) -> None:
        """Record a call."""
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
    """Solve one orbit around a Kerr black hole and print the counts."""
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

"""scene animation: a body turning and moving, as an animated picture."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from subprocess import CalledProcessError
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import FileFormatError, MissingExtraError
from geomtorsion.pictures.style import SERIES, STYLE, new_figure
from geomtorsion.support.files import written

if TYPE_CHECKING:
    from matplotlib.animation import FFMpegWriter, PillowWriter
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D
    from numpy.typing import ArrayLike

FORMS = (".gif", ".mp4")
FACES = ("#8fc1e3", "#f2b48a", "#9fd6bd")
# Corners of a block, and its faces as corners in cyclic order.
_CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
_FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))


def block_sides(moments: ArrayLike) -> np.ndarray:
    """Half sides of the block with these principal moments, the longest being 1.

    Examples
    --------
    >>> block_sides([1.0, 1.0, 1.0]).tolist()
    [1.0, 1.0, 1.0]
    """
    inertia = np.asarray(moments, dtype=float)
    squares = np.maximum(inertia.sum() / 2 - inertia, 0)
    sides = np.sqrt(squares)
    # Thin sides are drawn thick enough to be seen.
    return np.maximum(sides / sides.max(), 0.08)


def polygons(sides: ArrayLike) -> tuple[list[np.ndarray], list[str]]:
    """Faces of a body about its centre and their colours: a block, or a cylinder for equal sides.

    Examples
    --------
    >>> len(polygons([1.0, 0.5, 0.2])[0]), len(polygons([1.0, 1.0, 0.1])[0])
    (6, 34)
    """
    sides = np.asarray(sides, dtype=float)
    for axis in (2, 0, 1):
        one, other = (k for k in range(3) if k != axis)
        if abs(sides[one] - sides[other]) < 1e-9:
            turn = np.linspace(0, 2 * np.pi, STYLE.sides, endpoint=False)
            rims = np.zeros((2, STYLE.sides, 3))
            rims[:, :, one] = sides[one] * np.cos(turn)
            rims[:, :, other] = sides[one] * np.sin(turn)
            rims[0, :, axis], rims[1, :, axis] = sides[axis], -sides[axis]
            after = np.roll(rims, -1, axis=1)
            walls = [
                np.array([rims[0, k], rims[1, k], after[1, k], after[0, k]])
                for k in range(STYLE.sides)
            ]
            # Quarters of different colours show how it spins.
            quarters = [FACES[int(4 * k / STYLE.sides) % 2] for k in range(STYLE.sides)]
            return [rims[0], rims[1], *walls], [FACES[2], FACES[2], *quarters]
    corners = sides * np.array(_CORNERS, dtype=float)
    return [corners[list(face)] for face in _FACES], [FACES[k // 2] for k in range(6)]


def write_film(
    path: Path,
    times: ArrayLike,
    matrices: ArrayLike,
    positions: ArrayLike | None = None,
    sides: ArrayLike = (1.0, 1.0, 1.0),
    seconds: float = 8.0,
    title: str = "",
    progress: Callable[[float], object] = lambda _: None,
) -> int:
    """Write an animation of a block that turns; return the number of frames.

    Parameters
    ----------
    path
        file to write, .gif or .mp4 (which needs ffmpeg).
    times
        shape (m,), equally spaced; the animation shows them in `seconds`.
    matrices
        rotations from body to space, shape (m, 3, 3).
    positions
        positions in space, shape (m, 3), or None: the block turns on the spot and axis 3 leaves a
        trace.
    sides
        half sides of the block, longest 1.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed, or ffmpeg for .mp4.
    FileFormatError
        the suffix is neither .gif nor .mp4.
    """
    writer = _writer(path)
    clock = np.asarray(times, dtype=float)
    frames = int(min(max(seconds * STYLE.rate, 2), STYLE.frames, len(clock)))
    chosen = np.linspace(0, len(clock) - 1, frames).round().astype(int)
    turn = np.asarray(matrices, dtype=float)
    figure = new_figure(4.6, 4.8)
    # The frames are drawn one by one: a layout engine would make them jitter.
    figure.set_layout_engine("none")
    # A caller with a figure has matplotlib.
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    FigureCanvasAgg(figure)
    axes: Axes3D = figure.add_axes((0.0, 0.02, 1.0, 0.9), projection="3d")
    scene = _Stage(axes, turn, positions, np.asarray(sides, dtype=float))
    label = figure.text(0.5, 0.955, "", ha="center", fontsize=11)
    with written(path) as partial, _saving(writer, figure, partial):
        for count, k in enumerate(chosen.tolist()):
            scene.show(k)
            label.set_text(f"{title}   t = {clock[k]:.3g} s".strip())
            writer.grab_frame()
            progress((count + 1) / frames)
    return frames


@contextmanager
def _saving(writer: FFMpegWriter | PillowWriter, figure: Figure, target: Path) -> Iterator[None]:
    """Frames of an animation between its beginning and its end; errors in between are raised.

    matplotlib's own `saving` always finishes the file, which fails for a GIF without frames: its
    IndexError would hide the reason (or Ctrl-C).
    """
    # An extra: without matplotlib this module can still be imported.
    from matplotlib import rc_context

    writer.setup(figure, str(target), dpi=100)
    with rc_context({"savefig.bbox": None}):
        try:
            yield
        except BaseException:
            with suppress(IndexError, OSError, CalledProcessError):
                writer.finish()
            raise
        writer.finish()


def _writer(path: Path) -> FFMpegWriter | PillowWriter:
    """The writer for a suffix."""
    kind = path.suffix.lower()
    if kind not in FORMS:
        raise FileFormatError(
            f"{path.name}: expected the name of a .gif or .mp4 file for an animation. Change the "
            "suffix."
        )
    try:
        # An extra: its absence is an error that names it.
        from matplotlib.animation import FFMpegWriter, PillowWriter
    except ImportError:
        raise MissingExtraError(
            "animations need matplotlib, which is not installed. Run `pip install "
            "'geomtorsion[plots]'`."
        ) from None
    if kind == ".gif":
        return PillowWriter(fps=STYLE.rate)
    if not FFMpegWriter.isAvailable():
        raise MissingExtraError(
            f"{path.name}: a .mp4 file needs the program ffmpeg, which was not found. Install it, "
            "or write a .gif."
        )
    return FFMpegWriter(fps=STYLE.rate, bitrate=1800)


class _Stage:
    """The drawing that changes from frame to frame."""

    def __init__(
        self, axes: Axes3D, turn: np.ndarray, positions: ArrayLike | None, sides: np.ndarray
    ) -> None:
        # A caller with axes has matplotlib.
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        self.turn = turn
        self.places = (
            np.zeros((len(turn), 3)) if positions is None else np.asarray(positions, dtype=float)
        )
        span = float(np.ptp(self.places, axis=0).max())
        self.size = 0.55 if span == 0 else 0.13 * span
        faces, colors = polygons(sides)
        # Corners are repeated so that all faces have the same number: matplotlib fills shorter ones
        # up with unset memory.
        most = max(map(len, faces))
        self.faces = self.size * np.array([np.resize(face, (most, 3)) for face in faces])
        self.axes = axes
        self.block = Poly3DCollection(
            self.faces, facecolors=colors, edgecolors="#1d2330", linewidths=0.5, alpha=0.95,
        )  # fmt: skip
        axes.add_collection3d(self.block)
        (self.pin,) = axes.plot([], [], [], color="#1d2330", linewidth=2.0)
        (self.trace,) = axes.plot([], [], [], color=SERIES[0].color, linewidth=1.2)
        self.tips = self.places + (1.1 if span == 0 else 1.6 * self.size) * turn[:, :, 2]
        self.path = self.tips if span == 0 else self.places
        low, high = self.places.min(axis=0), self.places.max(axis=0)
        centre, half = (low + high) / 2, 0.5 * span + (1.05 if span == 0 else 2 * self.size)
        for setter, c in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), centre, strict=True):
            setter(c - half, c + half)
        axes.set_box_aspect((1, 1, 1), zoom=1.25 if span == 0 else 1.5)
        axes.set_proj_type("ortho")
        axes.view_init(elev=22.0, azim=-56.0)
        axes.set_axis_off()
        self._frame(centre, half)

    def _frame(self, centre: np.ndarray, half: float) -> None:
        """Faint axes of space."""
        corner = centre - 0.75 * half
        for k, letter in enumerate("xyz"):
            end = corner + 0.5 * half * np.eye(3)[k]
            self.axes.plot(*np.array([corner, end]).T, color="#8b9098", linewidth=1.2)
            self.axes.text(*(corner + 0.6 * half * np.eye(3)[k]), letter, color="#555555")

    def show(self, k: int) -> None:
        """Put the block as it is at sample k."""
        self.block.set_verts([self.places[k] + face @ self.turn[k].T for face in self.faces])
        ends = [self.places[k], self.tips[k]]
        self.pin.set_data_3d(*zip(*ends, strict=True))
        self.trace.set_data_3d(*self.path[: k + 1].T)

"""settings: limits of the page, and the resolution of its figures."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Settings:
    """One number for each limit and each choice, with its reason.

    Limits of input
    ---------------
    sessions: open at once. reserve: sessions that are kept for clients with fewer than this number
    of open sessions, so that one address on the network, which may be a whole class behind one
    router, never takes all sessions. body: bytes of one request; a whole tetrad needs a
    hundredth of this size.
    upload: bytes of one uploaded file, a map of some 70,000 pixels as text: all
    sessions together then keep a few hundred megabytes. unpacked: bytes in a packed one.
    nodes: of a map, so that a circuit is computed while the user waits; pixels: of a lattice image,
    as many as a camera of 1024 x 1024 has. title: letters of its name.
    request: characters of one request; the largest tetrad of the page has 36 entries.
    code: letters of the code that other machines need; a thousand guesses a second need years.
    address: characters of one text that is kept in the address of the page.
    answer: characters of one answer to an exercise. dimensions: coordinates of a typed tetrad;
    name: characters of the name of a coordinate.
    kept: characters of all cached answers, some hundred pictures.
    apart: cases of a list, one after the other, whose fields have numbers of their own; more than
    are drawn at once when the user scrolls through the list with the arrow keys.

    Times
    -----
    opening: seconds that a session may take to show its first page before the next is let in.
    polling: seconds between two looks at a session that starts.
    sending: seconds that a browser may take to read one message.
    reopening: seconds for which a page that was closed can be opened again where it was.
    pause: milliseconds without a key pressed after which a typed text is read.

    Resolution
    ----------
    accuracy: relative error of motions. samples: of two curves. points: of a curve that are sent;
    digits: of each. duration: seconds that an animation lasts. frames: of an animation.
    least_times, most_times, each_turn: number of times at which a top is computed, and their
    number for each turn. reach: steps of a slider on either side of the start; step: usual size.
    across: pixels of a displayed picture. radius: of the first loop. course: of the first ship,
    degrees from north to east; sail: length of its path in radii of the globe, on which it reaches
    no pole. parts: ratio of the shorter side of a map to the side of the first circuit: a smaller
    circuit has more noise, a larger one more grains.
    fastest: speed along a frame vector, and its step. zero: a value within so many errors of zero
    is shown as zero. width, height: of a figure, inches; its letters of ten points then match
    the letters of the page.
    """

    sessions: int = 64
    reserve: int = 8
    body: int = 262_144
    upload: int = 4_000_000
    unpacked: int = 64_000_000
    nodes: int = 250_000
    pixels: int = 1_048_576
    across: int = 400
    title: int = 60
    request: int = 24_000
    address: int = 4000
    code: int = 8
    answer: int = 4000
    dimensions: int = 6
    name: int = 20
    kept: int = 64_000_000
    apart: int = 5
    opening: float = 15.0
    polling: float = 0.1
    sending: float = 30.0
    reopening: int = 120
    pause: int = 350
    accuracy: float = 1e-9
    samples: int = 241
    points: int = 600
    digits: int = 5
    duration: float = 12.0
    frames: int = 601
    least_times: int = 241
    most_times: int = 1201
    each_turn: int = 24
    reach: int = 20
    step: float = 0.05
    course: int = 75
    sail: float = 4.0
    radius: float = 0.3
    parts: int = 8
    fastest: float = 3.0
    zero: float = 3.0
    width: float = 5.2
    height: float = 4.0

    @property
    def carried(self) -> int:
        """Bytes of a request that carries a file: four letters for three bytes, and the rest.

        Examples
        --------
        >>> PAGE.carried
        5595477
        """
        return 4 * self.upload // 3 + self.body


PAGE = Settings()

"""settings: how much the page may take, and how finely it draws."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Settings:
    """One number for each limit and each choice, with its reason.

    Limits of what comes in
    -----------------------
    sessions: open at once. reserve: places that only those get who have fewer than these places
    open, so that one address on the network, which may be a whole class behind one router, fills
    the lab up to there and never all of it. body: bytes of one request; a whole tetrad is a
    hundredth of that.
    upload: bytes of one file that is given to the page, a map of some 70,000 pixels as text: all
    sessions together then keep a few hundred megabytes. unpacked: bytes in a packed one.
    nodes: of a map, so that a circuit is computed while one waits; pixels: of a lattice image, as
    many as a camera of 1024 x 1024 has. title: letters of its name.
    request: characters of one request; the largest tetrad of the page has 36 entries.
    code: letters of the code that other machines need; a thousand guesses a second need years.
    address: characters of one text that is kept in the address of the page.
    answer: characters of one answer to an exercise. dimensions: coordinates of a typed tetrad;
    name: characters of the name of one.
    kept: characters of all answers that are kept, some hundred pictures.
    apart: cases of a list, one after the other, whose fields have numbers of their own; more than
    are drawn at once where somebody goes through the list by keys.

    Times
    -----
    opening: seconds that a session may take to show its first page before the next is let in.
    sending: seconds that a browser may take to read one message.
    reopening: seconds for which a page that was closed can be opened again where it was.
    pause: milliseconds without a key pressed after which a typed text is read.

    How finely
    ----------
    accuracy: of motions, relative. samples: of two curves. points: of a curve that are sent;
    digits: of each. film: seconds that a film lasts. film_points: of its curves.
    least_times, most_times, each_turn: times at which a top is computed, and for each turn.
    reach: steps that a slider goes to either side of the start; step: the usual size of one.
    across: pixels of a picture that is sent. radius: of the first loop. course:
    of the first ship, degrees from north to east; sail: length of its way in radii of the globe, on
    which it reaches no pole. parts: of the shorter side
    of a map, of which the side of the first circuit is one: more noise if it is smaller, more
    grains if it is larger.
    fastest: speed along a frame vector, and its step. zero: a value within so many errors of zero
    is shown as zero. width, height: of a figure, inches; its letters of ten points are then as
    large as those of the page.
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
    sending: float = 30.0
    reopening: int = 120
    pause: int = 350
    accuracy: float = 1e-9
    samples: int = 241
    points: int = 600
    digits: int = 5
    film: float = 12.0
    film_points: int = 601
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

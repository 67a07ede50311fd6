"""Limits: expressions that would grow without end are refused at once; long ones are read."""

import random
import re
import subprocess
import sys

import pytest
import sympy as sp

from geomtorsion.errors import LimitError
from geomtorsion.exact import Field
from geomtorsion.exact.limits import check_power
from geomtorsion.exact.writing import shortest
from geomtorsion.geometry import Frame, levi_civita
from geomtorsion.spaces.tetrad_files import read_file

# Each took from twenty seconds to hours, in reading, in writing or in derived quantities.
ENDLESS = {
    "nested powers": "((((1+x)**200+y)**200+x)**200+y)**200",
    "square of a power": "((1+x+y)**100)**2",
    "powers of sums of powers": "(((x+y)**6+1)**6+x)**6",
    "higher ones": "(((x+1)**16+y)**16+x)**16",
    "product of sums": "*".join(f"(x+{k}*y+sin(x)+cos(y)+exp(x))" for k in range(1, 20)),
    "power of sines": "(sin(x)+cos(y))**256",
    "power of four functions": "(sin(x)+cos(y)+exp(x)+y)**100",
    "sum of fractions": "+".join(f"1/(x**{k}+y**{k + 1}+1)" for k in range(1, 30)),
    "numbers of 180,000 digits": "(x+" + "9" * 900 + ")**200",
    "exp of a number": "exp(exp(exp(exp(10))))+x",
    "root of such a number": "sqrt(exp(exp(exp(10)))-x)",
    "power with such a number": "2**exp(exp(exp(10)))+x",
    "exponents apart": "exp(10**200*x)+exp(x)",
    "tower of twos": "2**(2**(2**(2**2)))*x",
}


@pytest.mark.parametrize("entry", ENDLESS.values(), ids=ENDLESS.keys())
def test_endless_entries_are_refused(entry, tmp_path):
    """The message names the entry and the limit; it does not repeat the entry."""
    file = tmp_path / "a.toml"
    file.write_text(f'coordinates = ["x", "y"]\ncoframe = [["{entry}", 0], [0, 1]]\n')
    with pytest.raises(LimitError, match=r"coframe\[0, 0\]: (?s:.)*(limit|parameter)") as caught:
        read_file(file)
    assert len(str(caught.value)) < 500


@pytest.mark.parametrize(("power", "terms"), [(103, 5460), (104, 5565)])
def test_the_limit_of_terms(power, terms, tmp_path):
    """The square of an entry has to be within the limit of a product: at most 5,477 terms."""
    file = tmp_path / "a.toml"
    file.write_text(f'coordinates = ["x", "y"]\ncoframe = [["(x+y+1)**{power}", 0], [0, 1]]\n')
    if terms < 5477:
        assert read_file(file).frame.dimension == 2
        return
    with pytest.raises(LimitError, match=f"has {terms:,} terms .* the limit is 5,477"):
        read_file(file)


def test_entries_from_python_too():
    """The limit holds for all exact work, not only for files."""
    x, y = sp.symbols("x y", real=True)
    with pytest.raises(LimitError, match="20,301 terms"):
        Frame([x, y], [[((1 + x + y) ** 100) ** 2, 0], [0, 1]])
    with pytest.raises(LimitError, match="exp of a number of more than 64 bits"):
        Frame([x, y], [[sp.exp(sp.Integer(10) ** 20) + x, 0], [0, 1]])
    assert Frame([x, y], [[sp.exp(sp.Integer(10) ** 18) + x, 0], [0, 1]]).dimension == 2


# In a separate process: hypothesis has a callback in the garbage collector of this process, and
# an interruption within that callback is lost.
INTERRUPTED = """
import signal
import sympy as sp
from geomtorsion.geometry import Frame, levi_civita
signal.signal(signal.SIGALRM, signal.default_int_handler)
x, y = sp.symbols("x y", real=True)
rows = [[(x + y + 1) ** 100, x * y], [sp.sin(x) ** 80 + y, (x - y) ** 50 + 2]]
signal.setitimer(signal.ITIMER_REAL, 0.5)
try:
    while True:
        levi_civita(Frame([x, y], rows)).curvature.kretschmann.at({x: 1, y: 1})
except KeyboardInterrupt:
    print("interrupted")
"""


def test_work_can_be_interrupted():
    """Ctrl-C interrupts the computation, because no single step takes long."""
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED],
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.stdout == "interrupted\n", done.stderr
    assert done.returncode == 0


def test_components_too_long_to_write_have_numbers():
    """A component too long to write can still be tested for zero; only writing it is refused."""
    x, y, z = sp.symbols("x y z", real=True)
    f, g = sp.Function("f"), sp.Function("g")
    rows = [
        [2 + f(x) * sp.sqrt(y + 3), sp.sin(x * y) + z, sp.exp(z) / 3],
        [sp.tan(y / 2), 3 + g(z) * sp.sqrt(x**2 + 1), x * z + sp.cos(y - z)],
        [sp.atan(x) * y, sp.sqrt(z + 2) / 2, 4 + f(y) * sp.sinh(z)],
    ]
    ricci = levi_civita(Frame([x, y, z], rows)).curvature.ricci
    assert ricci.is_zero is False
    with pytest.raises(LimitError, match=r"R\[0, 0\]: .*parts would be written; the limit is"):
        _ = ricci.to_sympy()
    with pytest.raises(LimitError, match=r"R\[1, 2\]: .*parts would be written; the limit is"):
        _ = ricci[1, 2]


def test_a_leg_that_is_too_long_is_named():
    """The last leg of a dense metric has too long a root; curvature does not need it."""
    t, x, y, z = sp.symbols("t x y z", positive=True)
    metric = [
        [-(x**2) - y**2 - 1, 0, sp.tanh(y + z) / 6, sp.cos(z / 2) / 5],
        [0, sp.sin(t + z) + 2, sp.tanh(y) / 7, sp.tanh(t) / 5],
        [0, 0, sp.sinh(sp.log(t**2 + 1)) ** 2 / 2 + 6, sp.coth(y**2 + 2) / 7],
        [0, 0, 0, sp.cosh(y)],
    ]
    whole = sp.Matrix(4, 4, lambda i, j: metric[min(i, j)][max(i, j)])
    frame = Frame.from_metric([t, x, y, z], whole, signature=(-1, 1, 1, 1))
    assert levi_civita(frame).curvature.scalar.is_zero is False
    with pytest.raises(LimitError, match="leg 3 of this metric contains the root of a long sum"):
        _ = frame.coframe


def test_far_too_long_components_are_refused_before_they_are_written():
    """The length follows from the sums inside, before sympy expressions are made of them."""
    w, x, y, z = sp.symbols("w x y z")
    field = Field([w, x, y, z])
    power, w = field.read(1 + x + y + z) ** 20, field.symbol(w)
    total = field.sum([(1, power + k * w, power - k * w) for k in range(1, 60)])
    with pytest.raises(LimitError, match=r"an expression of more than 33\d,\d{3} parts would be"):
        _ = total.sympy
    # Below the limit the sum is written.
    few = field.read(1 + x + y + z) ** 12
    one = field.sum([(1, few + w, few - w)])
    assert one.sympy.subs({w.sympy: 2, x: 1, y: 1, z: -2}) == 1 - 4


def test_few_sums_at_many_places_are_refused_before_they_are_written():
    """A sum is counted at each place where it occurs; a factor of all terms is counted once."""
    x, y, z = sp.symbols("x y z")
    field = Field([x, y, z])
    long, one = field.read((1 + x + y + z) ** 18), field.symbol(x)
    power = field.read((1 + x + y + z) ** 12)

    def nested(levels, start, other):
        found = field.sum([(1, start + other, start - other)])
        for _ in range(levels):
            found = field.sum([(1, found, found, start + other), (1, found, start - other)])
        return found

    # Each level occurs twice in the next.
    with pytest.raises(LimitError, match=r"more than [\d,]* parts would be written"):
        _ = nested(8, long, one).sympy
    written = nested(1, power, one)
    assert written.is_kept
    a, b = 3**12 + 1, 3**12 - 1
    assert sp.lambdify([x, y, z], written.sympy)(1, 2, -1) == (a * b) ** 2 * a + a * b * b
    # A factor of all terms is written once, in front, and does not exceed the limit.
    shared = field.sum([(k, written, one**k) for k in range(1, 200)])
    assert sp.lambdify([x, y, z], shared.sympy)(0, 2, -1) == 0


def test_far_too_long_components_are_refused_by_their_longest_sums():
    """The refusal comes after half of the sums are counted; collecting all takes seconds."""
    x, y, z = sp.symbols("x y z")
    field = Field([x, y, z])
    numbers = random.Random(1)

    def long():
        powers = [[numbers.randint(0, 5) for _ in range(3)] for _ in range(25)]
        return field.read(sum(numbers.randint(2, 99) * x**a * y**b * z**c for a, b, c in powers))

    found = field.sum([(1, long(), long(), long()) for _ in range(20)])
    for _ in range(7):
        found = field.sum([(1, found, found, field.symbol(x)), (1, found, field.symbol(y))])
    with pytest.raises(LimitError, match="parts would be written") as caught:
        shortest(found)
    (told,) = re.findall(r"more than ([\d,]+) parts", str(caught.value))
    assert 250_000 < int(told.replace(",", "")) < 500_000


def test_the_largest_multiple_of_an_angle():
    """cos(1000 x) is written as a polynomial of cos(x); the multiple 1001 would be too long."""
    x, y = sp.symbols("x y", real=True)

    def entry(multiple):
        frame = Frame([x, y], [[1, 0], [0, sp.cos(x) + sp.cos(multiple * x)]])
        return frame.coframe[1, 1]

    assert entry(1000) == sp.cos(x) + sp.cos(1000 * x)
    with pytest.raises(LimitError, match="the multiple 1001 would be needed; the limit is 1000"):
        entry(1001)


def test_the_highest_power_that_is_multiplied_out():
    """A power is multiplied out up to a million terms."""
    x, y = sp.symbols("x y", real=True)
    base = Field([x, y]).read(x + y + 1)
    check_power(base, 1412)
    with pytest.raises(LimitError, match="the power 1413 of an expression of 3 terms"):
        check_power(base, 1413)

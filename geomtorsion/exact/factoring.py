"""Factoring: polynomials in factors; long work is done in a process of its own.

Flint is deaf to Ctrl-C and to limits while it factors, which takes half a minute for some
polynomials of 300 terms.  A process can be ended at once; its answer is the same.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import queue
import random
import subprocess
import sys
import threading
from math import gcd, lcm
from pathlib import Path
from typing import TYPE_CHECKING

from flint import Ordering, fmpq, fmpq_mpoly_ctx, fmpq_poly, fmpz
from flint.utils.flint_exceptions import DomainError

from geomtorsion.exact import factoring_process

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    Factors = tuple[fmpq, list[tuple[fmpq_mpoly, int]]]


def factored(poly: fmpq_mpoly, largest: int) -> Factors:
    """(content, [(irreducible factor, exponent)]) of a polynomial that is not zero.

    What has more terms times degrees than the largest is done by the other process.
    """
    degrees = poly.degrees()
    # What has degree 1 in a variable is irreducible up to what its two coefficients share.
    slopes = [poly.derivative(k) for k, degree in enumerate(degrees) if degree == 1]
    slope = min(slopes, key=len, default=None)
    # One term shares nothing where no variable divides the whole.
    single = slope is not None and len(slope) == 1 and not any(poly.term_content().degrees())
    # In few variables Flint is as fast as a line.
    if single or (len(poly) > 2 * poly.total_degree() and is_irreducible_on_a_line(poly)):
        return _irreducible(poly)
    if len(poly) * sum(degrees) > largest:
        found = _OTHER.factored(poly)
        if found is not None:
            return found
    if slope is not None:
        shared = poly.gcd(slope)
        if shared.is_constant():
            return _irreducible(poly)
        content, rest = _irreducible(poly / shared)
        inner, factors = factored(shared, largest)
        return content * inner, factors + rest
    content, factors = poly.factor()
    return fmpq(content), [(factor, int(exponent)) for factor, exponent in factors]


def _irreducible(poly: fmpq_mpoly) -> Factors:
    """What has no factors, as Flint writes it: whole numbers without a common divisor, the first
    one positive.
    """
    coefficients = poly.coeffs()
    content = fmpq(gcd(*(int(c.p) for c in coefficients)), lcm(*(int(c.q) for c in coefficients)))
    content = content if coefficients[0] > 0 else -content
    return content, [(poly / content, 1)]


def is_irreducible_on_a_line(poly: fmpq_mpoly) -> bool:
    """Whether a polynomial is irreducible on a certain line, and hence at all; False says nothing.

    Where the degree on the line is the whole one, so is that of each factor: none is lost.  By
    Hilbert's theorem nearly all lines will do, and factoring in one variable is far quicker.
    """
    numbers = random.Random(1)
    line = fmpq_mpoly_ctx.get(("t",), Ordering.lex)
    t, variables = line.gen(0), range(poly.context().nvars())
    places = [numbers.randint(-9, 9) + numbers.randint(1, 9) * t for _ in variables]
    there = poly.compose(*places, ctx=line)
    degree = int(there.total_degree())
    if degree < poly.total_degree():
        return False
    coefficients = there.to_dict()
    plain = fmpq_poly([coefficients.get((k,), 0) for k in range(degree + 1)])
    _, factors = plain.numer().factor()
    return len(factors) == 1 and factors[0][1] == 1


def known_taken_out(
    poly: fmpq_mpoly, known: list[fmpq_mpoly]
) -> tuple[fmpq, list[tuple[fmpq_mpoly, int]], fmpq_mpoly]:
    """(content, powers, rest) with poly = content * powers * rest, where rest has leading
    coefficient 1; the powers are those of variables and of irreducible polynomials that are known.

    Trial division by a few of these takes a tenth of the time of factoring.
    """
    common, context = poly.term_content(), poly.context()
    powers = [(context.gen(k), int(e)) for k, e in enumerate(common.degrees()) if e]
    rest = poly / common
    for factor in known:
        exponent = 0
        while len(rest) > 1 and len(factor) > 1:
            try:
                rest = rest / factor
            except DomainError:
                break
            exponent += 1
        if exponent:
            powers.append((factor, exponent))
    leading = rest.leading_coefficient()
    return common.leading_coefficient() * leading, powers, rest / leading


class OtherProcess:
    """The process that factors; it is started when it is first needed."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[str] | None = None
        self._replies: queue.Queue[str] = queue.Queue()
        self._owner = 0

    def factored(self, poly: fmpq_mpoly) -> Factors | None:
        """The factors, from the other process; None where there is none."""
        ctx = poly.context()
        # One request at a time; whoever interrupts ends the process.
        with self._lock:
            try:
                line = self._answer(json.dumps([ctx.nvars(), factoring_process.terms_of(poly)]))
            except (OSError, ValueError):
                line = ""
            except BaseException:
                self.end()
                raise
            if not line:
                self.end()
                return None
        p, q, factors = json.loads(line)
        found = [(factoring_process.polynomial(ctx, terms), e) for terms, e in factors]
        return fmpq(fmpz(int(p)), fmpz(int(q))), found

    def _answer(self, request: str) -> str:
        process = self._process
        # A fork of this process has the pipes of its parent.
        if process is None or process.poll() is not None or self._owner != os.getpid():
            process = self._start()
        assert process.stdin is not None
        process.stdin.write(request + "\n")
        process.stdin.flush()
        while True:
            # In short waits: an error that another thread sends arrives between them.
            with contextlib.suppress(queue.Empty):
                return self._replies.get(timeout=0.05)

    def _start(self) -> subprocess.Popen[str]:
        self._process = process = subprocess.Popen(
            [sys.executable, "-P", str(Path(factoring_process.__file__))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            # Ctrl-C is for the one who asked.
            start_new_session=True,
        )
        self._owner, self._replies = os.getpid(), queue.Queue()
        threading.Thread(target=_listen, args=(process, self._replies), daemon=True).start()
        return process

    def end(self) -> None:
        """End the process, at once; the next one who asks starts another."""
        process, self._process = self._process, None
        if process is None or self._owner != os.getpid():
            return
        process.kill()
        process.wait()
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                # What was still to be written has no reader any more.
                with contextlib.suppress(OSError, ValueError):
                    stream.close()


def _listen(process: subprocess.Popen[str], replies: queue.Queue[str]) -> None:
    """Pass on the lines of a process, and one that is empty at its end."""
    assert process.stdout is not None
    with contextlib.suppress(ValueError, OSError):
        for line in process.stdout:
            replies.put(line)
    replies.put("")


_OTHER = OtherProcess()
atexit.register(_OTHER.end)

"""Poincare gauge theories that are renormalisable by power counting: the 58 critical cases.

[Lin, Hobson, Lasenby 2019, arXiv:1812.02675 and 1910.14197], in the form in which the package
PSALTer evaluates them (wevbarker/PSALTer at c32143e, Calibration/PoincareGaugeTheory/
LinHobsonLasenbyTheories: CriticalCases.m and Unitarity.m). All 58 rows of equalities agree with
that form. The printed tables could not be opened; older transcriptions of rows 7, 13, 23, 36, 48
and 58 differ and contradict the masses of Karananas (2014), which demand 2 r1 - 2 r3 + r4, t1 + t2
and t1 t2 (t1 + t2) < 0 there.
"""

from __future__ import annotations

from itertools import count
from random import Random

import pytest
import sympy as sp

from geomtorsion.gravity import perturbed
from tests.chosen import few
from tests.gravity.perturbed.test_spectrum import COUPLINGS, KARANANAS

lam, r1, r2, r3, r4, r5, t1, t2, t3 = symbols = sp.symbols(COUPLINGS)

# Combinations that vanish, besides lam, and conditions for no ghost and no tachyon.
CASES = [
    ((r1, r3 / 2 - r4, t1, t3), (t2 > 0, r2 < 0, r3 * (2 * r3 + r5) * (r3 + 2 * r5) < 0)),
    ((r1, r3 / 2 - r4, t1), (t2 > 0, r2 < 0, r3 * (2 * r3 + r5) * (r3 + 2 * r5) < 0)),
    ((r1, r3, r4, t1 + t2, t3), (r2 < 0, r5 < 0, t1 < 0)),
    ((r2, r1 - r3, r4, t1 + t2, t3), (t1 > 0, r1 + r5 < 0, r1 < 0)),
    ((r2, r1 - r3, r4, t2, t1 + t3), (r5 > 0, 2 * r1 + r5 > 0, t1 > 0, r1 < 0)),
    ((r1, 2 * r3 - r4, t1 + t2, t3), (r2 < 0, 2 * r3 + r5 < 0, t1 < 0)),
    ((r2, 2 * r1 - 2 * r3 + r4, t1 + t2, t3), (t1 > 0, r1 < 0, 2 * r3 + r5 < r1)),
    ((r2, r1 - r3, r4, t1, t2), (r1 * (r1 + r5) * (2 * r1 + r5) < 0,)),
    ((r2, r1 - r3, r4, t1, t2, t3), (r1 * (r1 + r5) * (2 * r1 + r5) < 0,)),
    ((r1, r2, r3 / 2 - r4, t1, t2, t3), (r3 * (2 * r3 + r5) * (r3 + 2 * r5) < 0,)),
    ((r1, r3 / 2 - r4, t1, t2, t3), (r3 * (2 * r3 + r5) * (r3 + 2 * r5) < 0,)),
    ((r1, r2, r3 / 2 - r4, t1, t3), (r3 * (2 * r3 + r5) * (r3 + 2 * r5) < 0,)),
    ((r2, 2 * r1 - 2 * r3 + r4, t1, t2, t3), (r1 * (r1 - 2 * r3 - r5) * (2 * r3 + r5) > 0,)),
    ((r1, r2, r3 / 2 - r4, t1, t2), (r3 * (2 * r3 + r5) * (r3 + 2 * r5) < 0,)),
    ((r1, r2, r3 / 2 - r4, t1), (r3 * (2 * r3 + r5) * (r3 + 2 * r5) < 0,)),
    ((r1, r3 / 2 - r4, t1, t2), (r3 * (2 * r3 + r5) * (r3 + 2 * r5) < 0,)),
    ((r1, r2, r3, r4, t1 + t2, t3), (r5 < 0,)),
    ((r1, r2, r3, r4, t2, t1 + t3), (r5 > 0,)),
    ((r1, r2, 2 * r3 - r4, t1 + t2, t3), (2 * r3 + r5 < 0,)),
    ((r1, r3, r4, r5), (t2 > 0, r2 < 0)),
    ((r1, r3, r4, r5, t1 + t2), (r2 < 0, t1 < 0)),
    ((r1, r3, r4, r5, t1 + t3), (t2 > 0, r2 < 0)),
    ((r1, r3, r4, r5, t1 + t2, t1 + t3), (r2 < 0, t1 < 0)),
    ((r1, r3, r4, t1), (t2 > 0, r2 < 0)),
    ((r1, r3, r4, r5, t1), (t2 > 0, r2 < 0)),
    ((r1, r3, r4, r5, t1, t3), (t2 > 0, r2 < 0)),
    ((r1, r3 / 2 - r4, r3 / 2 + r5, t1, t3), (t2 > 0, r2 < 0)),
    ((r1, r3, r4, t1, t3), (t2 > 0, r2 < 0)),
    ((r1 - r3, r4, 2 * r1 + r5, t1), (t2 > 0, r2 < 0)),
    ((r1 - r3, r4, 2 * r1 + r5, t1, t3), (t2 > 0, r2 < 0)),
    ((r1, 2 * r3 - r4, 2 * r3 + r5, t1, t3), (t2 > 0, r2 < 0)),
    ((r1, r3, r4, r5, t3), (t2 > 0, r2 < 0)),
    ((r1, r3, r4, r5, t1 + t2, t3), (r2 < 0, t1 < 0)),
    ((r1, 2 * r3 - r4, r3 + r5, t1, t3), (t2 > 0, r2 < 0)),
    ((r1, r3 / 2 - r4, 2 * r3 + r5, t1, t3), (t2 > 0, r2 < 0)),
    ((2 * r1 - 2 * r3 + r4, 2 * r3 + r5, t1, t3), (t2 > 0, r2 < 0)),
    ((r1, r3 / 2 - r4, 2 * r3 + r5, t1), (t2 > 0, r2 < 0)),
    ((r1, 2 * r3 - r4, 2 * r3 + r5, t3), (t2 > 0, r2 < 0)),
    ((r1, 2 * r3 - r4, 2 * r3 + r5, t1 + t2, t3), (r2 < 0, t1 < 0)),
    ((r1, r4 + r5, t1, t3), (t2 > 0, r2 < 0)),
    ((r1, r3 / 2 - r4, r3 / 2 + r5, t1), (t2 > 0, r2 < 0)),
    ((r1, r3, r4, t1 + t2), (t3 > 0, r2 < 0, r5 < 0, t1 < 0, t1 + t3 < 0)),
    ((r1, r3, r4, t1 + t3), (r5 > 0, t2 > 0, t1 + t2 > 0, r2 < 0, t1 < 0)),
    ((r2, r1 - r3, r4, t1 + t2), (t1 > 0, r1 < 0, r1 + r5 < 0, t3 * (t1 + t3) > 0)),
    ((r2, r1 - r3, r4, t1 + t3), (r5 > 0, 2 * r1 + r5 > 0, t1 > 0, t1 + t2 > 0, r1 < 0, t2 < 0)),
    ((r1 - r3, r4, 2 * r1 + r5, t1 + t3), (t1 > 0, t2 > 0, r1 < 0, r2 < 0)),
    ((r1, r2, r3, r4, t1 + t2), (r5 < 0, t1 * t3 * (t1 + t3) > 0)),
    ((r1, r2, r3, r4, t1 + t3), (r5 > 0, t1 * t2 * (t1 + t2) < 0)),
    ((r1, r3, r4, t1 + t2, t1 + t3), (r2 < 0, t1 < 0)),
    ((r2, r1 - r3, r4, r1 + r5, t1 + t2), (t1 > 0, r1 < 0)),
    ((r2, r1 - r3, r4, 2 * r1 + r5, t1 + t3), (t1 > 0, r1 < 0)),
    ((r2, r1 - r3, r4, t1 + t2, t1 + t3), (t1 > 0, r1 < 0)),
    ((r2, r1 - r3, r4, r1 + r5, t1 + t2, t1 + t3), (t1 > 0, r1 < 0)),
    ((r2, r1 - r3, r4, 2 * r1 + r5, t1 + t2, t1 + t3), (t1 > 0, r1 < 0)),
    ((r2, r1 - r3, r4, r1 + r5, t1 + t2, t3), (t1 > 0, r1 < 0)),
    ((r2, r1 - r3, r4, 2 * r1 + r5, t2, t1 + t3), (t1 > 0, r1 < 0)),
    ((r1 - r3, r4, 2 * r1 + r5, t2, t1 + t3), (t1 > 0, r1 < 0)),
    ((r2, 2 * r1 - 2 * r3 + r4, r1 - 2 * r3 - r5, t1 + t2, t3), (t1 > 0, r1 < 0)),
]


@pytest.fixture(scope="module")
def general() -> perturbed.Spectrum:
    return perturbed.spectrum(KARANANAS, "poincare", constants=COUPLINGS)


@pytest.mark.parametrize("number", few(12, range(1, len(CASES) + 1)))
def test_healthy_inside_the_published_conditions_and_only_there(
    general: perturbed.Spectrum, number: int
) -> None:
    """Three random points on each side of the conditions decide as published."""
    vanish, conditions = CASES[number - 1]
    (bound,) = sp.solve(vanish, symbols[1:], dict=True)
    critical = general.subs({lam: 0} | bound)
    assert not any(one.spin == 2 and one.is_massless for one in critical.particles)
    random = Random(number)
    left = {True: 3, False: 3}
    for _ in count():
        free = {
            x: sp.Rational(random.choice([-1, 1]) * random.randint(1, 99), random.randint(2, 9))
            for x in symbols[1:]
            if x not in bound
        }
        inside = all(sp.S(one).subs(bound).subs(free) == sp.true for one in conditions)
        if left[inside]:
            left[inside] -= 1
            used = {x: value for x, value in free.items() if x in critical.waves.couplings}
            assert critical.subs(used).healthy == sp.S(inside), free
        if not any(left.values()):
            break

"""Rates of smaller systems against those of the full ones, exactly."""

from geomtorsion.motion.equations import Equations
from geomtorsion.motion.reduced.form import Reduction
from geomtorsion.motion.reduced.split import Split
from geomtorsion.motion.reduced.system import substituted
from geomtorsion.motion.system import derivative


def split_of(equations: Equations) -> Split:
    """The legs along cyclic coordinates, where there are any."""
    assert equations.momenta is not None
    parts = Split.of(equations, equations.momenta)
    assert parts is not None
    return parts


def reduction_of(equations: Equations) -> Reduction:
    """The smaller system, where there is one."""
    assert equations.reduction is not None
    return equations.reduction


def compare(equations, parts, small):
    """Rates of a smaller system and of the full one, both in momenta."""
    u, system, field = equations.velocities, equations.system, parts.frame.field
    known = {u[i]: parts.velocity(i, parts.names) for i in range(parts.frame.dimension)}
    norm = {parts.norm: substituted(parts.square, known)}
    coordinates = [((field.one, (name,)),) for name in system.states[: small.width]]
    own = {
        name: substituted(row, known)
        for name, row in zip(small.system.states[small.width :], small.momenta, strict=True)
        if name not in parts.names.values()
    }
    single = {name: substituted(row, own) for name, row in small.separators.items()}
    rates = dict(zip(system.states, system.rates, strict=True))
    count = 0
    for row, sums in zip(small.system.plain, (*coordinates, *small.momenta), strict=True):
        reduced = substituted(row, small.mixtures)
        for table in (single, own, norm):
            reduced = substituted(reduced, table)
        expected = substituted(change(sums, rates), known)
        assert substituted((*reduced, *((-x, n) for x, n in expected)), {}) == ()
        count += 1
    assert count == len(small.system.states)
    for mu in parts.cyclic:
        assert substituted(change(parts.momentum(mu), rates), known) == ()
    for row, back in zip(small.velocities, known.values(), strict=True):
        gap = (*substituted(row, own), *((-x, n) for x, n in back))
        assert substituted(gap, {}) == ()


def change(sums, rates):
    """The rate of a sum over full states, by their rates."""
    return tuple(
        (value * other, (*names_, *more))
        for state, rate in rates.items()
        for value, names_ in derivative(sums, state)
        for other, more in rate
    )

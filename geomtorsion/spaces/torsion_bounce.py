"""torsion_bounce: a universe of dust with spin, which bounces by its torsion."""

from sympy import Rational, symbols

from geomtorsion.geometry import Frame, Tensor, from_torsion
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric


def space(name: str) -> Space:
    """Coframe (dt, a dx, a dy, a dz) with a^3 = kappa s0^2/(4 rho0) + 3 kappa rho0 t^2/4."""
    t, x, y, z = symbols("t x y z", real=True)
    kappa, density, spin = symbols("kappa rho0 s0", positive=True)
    volume = kappa * spin**2 / (4 * density) + 3 * kappa * density * t**2 / 4
    size = volume ** Rational(1, 3)
    frame = Frame(
        (t, x, y, z),
        [[1, 0, 0, 0], [0, size, 0, 0], [0, 0, size, 0], [0, 0, 0, size]],
        signature=(-1, 1, 1, 1),
        parameters=(kappa, density, spin),
        name=name,
    )
    hubble = volume.diff(t) / (3 * volume)
    half = kappa * spin / (2 * volume)
    torsion = Tensor(frame, "DDU", {(1, 2, 0): half, (2, 1, 0): -half})
    rate = hubble.diff(t)
    return Space(
        name,
        story=(
            "Dust whose particles spin along z makes torsion, T_12^0 = kappa s, which repels.\n"
            "Instead of a singularity the universe has a smallest size, a^3 = kappa s0^2/(4 rho0)."
        ),
        source="W. Kopczynski, Phys. Lett. A 39 (1972) 219; A. Trautman, Nature Phys. Sci. 242 "
        "(1973) 7",
        frame=frame,
        known=(
            KnownAnswer(
                "torsion",
                antisymmetric({(0, j, j): hubble / 2 for j in (1, 2, 3)}),
                basis="frame",
            ),
            KnownAnswer("scalar_curvature", 6 * (rate + 2 * hubble**2)),
            KnownAnswer("weyl", {}),
            KnownAnswer("connection_torsion", antisymmetric({(1, 2, 0): half}), basis="frame"),
        ),
        motion=FirstMotion(
            (-0.5, 0.1, 0.2, 0.3),
            (1.25, 0.5, 0.25, 0.5),
            parameters={"kappa": 1.0, "rho0": 1.0, "s0": 1.0},
        ),
        group="gravity",
        notes="Signature (-, +, +, +). `space.connection` solves the equations of Einstein and "
        "Cartan for R/(2 kappa) with density rho0/a^3 and spin s_12 = s0/a^3.",
        connection=from_torsion(frame, torsion),
    )

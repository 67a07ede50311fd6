"""Free top attitude: the quaternion of a free top in the axes of its angular momentum."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from geomtorsion.rigid.free_top_constants import Constants


def tilted(momentum: NDArray[Any], precession: NDArray[Any], top: Constants) -> NDArray[Any]:
    """Quaternion of Rz(precession) Ry(tilt) Rz(spin), which takes this momentum to axis z.

    z is axis c here. The spin never leaves a half turn about its middle, since the momentum
    about axis a keeps its sign: no jumps, and the quaternion is continuous.
    """
    a, b, c = top.axes
    sign_a = math.copysign(1.0, top.amplitudes[0])
    even = (a, b, c) in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    la, lb, lc = sign_a * momentum[..., a], sign_a * momentum[..., b], momentum[..., c]
    if even:
        # x = a, y = b: sin spin ~ L_y, cos spin ~ -L_x.
        spin = (math.pi if sign_a > 0 else 0.0) + np.arctan2(-lb, la)
    else:
        # x = b, y = a.
        spin = sign_a * math.pi / 2 + np.arctan2(lb, la)
    flat = np.hypot(la, lb)
    tilt = np.arctan2(flat, lc) / 2
    plus, minus = (precession + spin) / 2, (precession - spin) / 2
    cos, sin = np.cos(tilt), np.sin(tilt)
    turned = np.empty((*precession.shape, 4))
    turned[..., 0] = cos * np.cos(plus)
    # Ry leaves sin(tilt) (x, y) = sin(tilt) (-sin minus, cos minus); x, y, z are cyclic axes.
    x, y = (a, b) if even else (b, a)
    turned[..., 1 + x] = -sin * np.sin(minus)
    turned[..., 1 + y] = sin * np.cos(minus)
    turned[..., 1 + c] = cos * np.sin(plus)
    return turned

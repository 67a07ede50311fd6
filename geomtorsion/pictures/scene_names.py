"""scene names: what watched quantities and their parts are called, in tables and in words."""

from __future__ import annotations

from collections.abc import Mapping

# What has these names has its parts along the axes of space.
IN_SPACE = ("position", "velocity", "axis", "_space")
SPOKEN: Mapping[str, str] = {
    "omega": "angular velocity Ω in the body",
    "omega_space": "angular velocity in space",
    "angular_momentum": "angular momentum in the body",
    "angular_momentum_space": "angular momentum in space",
    "axis": "axis of the body in space",
    "quaternion": "quaternion, body to space",
    "matrix": "rotation matrix, body to space",
    "vertical": "vertical, seen from the body",
    "euler": "Euler angles",
}
UNITS: Mapping[str, str] = {
    "omega": "rad/s",
    "omega_space": "rad/s",
    "euler": "rad",
    "nutation": "rad",
    "precession": "rad",
    "spin": "rad",
    "angular_momentum": "N m s",
    "angular_momentum_space": "N m s",
    "energy": "J",
    "kinetic_energy": "J",
    "potential_energy": "J",
    "position": "m",
    "velocity": "m/s",
}


def spoken(name: str) -> str:
    """The name of a quantity as people say it.

    Examples
    --------
    >>> spoken("angular_momentum_space"), spoken("kinetic_energy")
    ('angular momentum in space', 'kinetic energy')
    """
    return SPOKEN.get(name, name.replace("_", " "))


def part_names(name: str, count: int) -> list[str]:
    """The names of the components of a quantity; empty for a single number.

    Examples
    --------
    >>> part_names("omega", 3), part_names("omega_space", 3), part_names("quaternion", 4)
    (['1', '2', '3'], ['x', 'y', 'z'], ['0', '1', '2', '3'])
    >>> part_names("matrix", 9)[:4], part_names("energy", 1)
    (['11', '12', '13', '21'], [''])
    """
    if count == 1:
        return [""]
    if count == 3 and any(word in name for word in IN_SPACE):
        return list("xyz")
    if count == 9:
        return [f"{row}{column}" for row in "123" for column in "123"]
    first = 0 if count == 4 else 1
    return [str(first + k) for k in range(count)]

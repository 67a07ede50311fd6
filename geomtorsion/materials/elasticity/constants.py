"""Constants: elastic constants of any symmetry, in Voigt's order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import LONGEST_SHOWN, ElasticityError
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.files import finite_number
from geomtorsion.support.precision import PRINTED

# Voigt's order: 1..6 mean xx, yy, zz, yz, xz, xy.
PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
_NUMBER = np.zeros((3, 3), dtype=int)
for _k, (_i, _j) in enumerate(PAIRS):
    _NUMBER[_i, _j] = _NUMBER[_j, _i] = _k


@dataclass(frozen=True)
class ElasticConstants:
    """Elastic constants C_IJ of a crystal: stress_I = C_IJ strain_J.

    Voigt's order xx, yy, zz, yz, xz, xy; strain_J has twice the shear strains. The axes are the
    axes of the sample, which also describe torsion and lines; `rotated` turns a crystal.

    voigt: C_IJ, shape (6, 6), symmetric and positive definite.
    unit: of the constants, and so of the stresses; any text.

    Raises
    ------
    ElasticityError
        The matrix has another shape, is not symmetric, or some strain would release energy.

    Examples
    --------
    >>> copper = ElasticConstants.cubic(168.4, 121.4, 75.4, unit="GPa")
    >>> copper.tensor[0, 1, 0, 1], copper.tensor[0, 0, 1, 1]
    (np.float64(75.4), np.float64(121.4))
    >>> copper
    ElasticConstants(c11=168.4, c12=121.4, c13=121.4, c22=168.4, c23=121.4, c33=168.4, c44=75.4, \
c55=75.4, c66=75.4, unit='GPa')
    """

    voigt: tuple[tuple[float, ...], ...] | np.ndarray
    unit: str = ""

    def __post_init__(self) -> None:
        """Check the matrix once."""
        checks.text(self.unit, "unit", ElasticityError, longest=LONGEST_SHOWN)
        c = checks.array(self.voigt, "voigt", ElasticityError, shape=(6, 6))
        checks.measured(c, "voigt", ElasticityError)
        # Constants from a table are rounded.
        if np.abs(c - c.T).max() > PRINTED * np.abs(c).max():
            raise ElasticityError(
                "voigt: expected a symmetric matrix, got C_IJ that differ from C_JI. Give both "
                "halves, or 21 numbers to of_voigt."
            )
        lowest = float(np.linalg.eigvalsh(c).min())
        if not lowest > 0:
            raise ElasticityError(
                "expected elastic constants of a stable crystal, whose matrix has positive "
                f"eigenvalues, got {lowest:.6g} as the lowest. Check their order and unit."
            )
        matrix = tuple(tuple(row) for row in ((c + c.T) / 2).tolist())
        object.__setattr__(self, "voigt", matrix)

    def __repr__(self) -> str:
        c = np.asarray(self.voigt)
        upper = [(i, j) for i in range(6) for j in range(i, 6) if c[i, j]]
        parts = [f"c{i + 1}{j + 1}={c[i, j]:.6g}" for i, j in upper]
        parts += [f"unit={self.unit!r}"] if self.unit else []
        return f"ElasticConstants({', '.join(parts)})"

    @classmethod
    def isotropic(cls, shear: float, poisson: float, unit: str = "") -> ElasticConstants:
        """Isotropic constants from the shear modulus and Poisson's ratio (above -1, below 1/2).

        Examples
        --------
        >>> ElasticConstants.isotropic(48, 0.25).voigt[0]
        (144.0, 48.0, 48.0, 0.0, 0.0, 0.0)
        """
        mu = checks.positive(shear, "shear", ElasticityError)
        nu = checks.number(poisson, "poisson", ElasticityError)
        if not -1 < nu < 0.5:
            raise ElasticityError(
                f"poisson: expected a ratio above -1 and below 1/2, got {nu}. The order is shear "
                "modulus, Poisson's ratio."
            )
        c12 = 2 * mu * nu / (1 - 2 * nu)
        return cls.cubic(c12 + 2 * mu, c12, mu, unit)

    @classmethod
    def cubic(cls, c11: float, c12: float, c44: float, unit: str = "") -> ElasticConstants:
        """Three constants of a cubic crystal, cube axes along the coordinates."""
        return cls._of(unit, xx=c11, yy=c11, zz=c11, xy=c12, xz=c12, yz=c12, shears=(c44,) * 3)

    @classmethod
    def hexagonal(
        cls, c11: float, c12: float, c13: float, c33: float, c44: float, unit: str = ""
    ) -> ElasticConstants:
        """Five constants of a hexagonal crystal, its axis along z."""
        one, two = (checks.number(c, "c", ElasticityError) for c in (c11, c12))
        return cls._of(
            unit, xx=one, yy=one, zz=c33, xy=two, xz=c13, yz=c13, shears=(c44, c44, (one - two) / 2)
        )

    @classmethod
    def of_voigt(cls, values: Sequence[float] | np.ndarray, unit: str = "") -> ElasticConstants:
        """All 21 constants: c11, c12, ..., c16, c22, ..., c66, row by row; or a 6 x 6 matrix.

        Examples
        --------
        >>> iron = [230, 135, 135, 0, 0, 0, 230, 135, 0, 0, 0, 230, 0, 0, 0, 117, 0, 0, 117, 0, 117]
        >>> ElasticConstants.of_voigt(iron) == ElasticConstants.cubic(230, 135, 117)
        True
        """
        c = checks.array(values, "values", ElasticityError)
        if c.shape == (6, 6):
            return cls(c, unit)
        if c.shape != (21,):
            raise ElasticityError(
                f"values: expected 21 numbers or a matrix of shape (6, 6), got shape {c.shape}."
            )
        matrix = np.zeros((6, 6))
        matrix[np.triu_indices(6)] = c
        return cls(matrix + np.triu(matrix, 1).T, unit)

    @classmethod
    def of_text(cls, text: str) -> ElasticConstants:
        """Constants from text such as "cubic 168.4 121.4 75.4 GPa": symmetry, numbers, unit.

        The symmetries are isotropic (shear modulus, Poisson's ratio), cubic (c11, c12, c44),
        hexagonal (c11, c12, c13, c33, c44) and voigt (21 numbers, see `of_voigt`).

        Examples
        --------
        >>> ElasticConstants.of_text("isotropic 48 0.25").voigt[0][:2]
        (144.0, 48.0)
        """
        name, *words = checks.text(text, "elastic constants", ElasticityError).split() or [""]
        makers = {
            "isotropic": (cls.isotropic, 2), "cubic": (cls.cubic, 3),
            "hexagonal": (cls.hexagonal, 5), "voigt": (lambda *c, unit: cls.of_voigt(c, unit), 21),
        }  # fmt: skip
        checks.choice(name, list(makers), "elastic constants", ElasticityError)
        make, count = makers[name]
        values = [x for x in map(finite_number, words[:count]) if x is not None]
        unit = "".join(words[count:])
        if len(values) < count or len(words) > count + 1 or finite_number(unit) is not None:
            raise ElasticityError(
                f"elastic constants: expected {name}, {count} numbers and a unit, got "
                f"{checks.shown(text)}. Write them like 'cubic 168.4 121.4 75.4 GPa'."
            )
        return make(*values, unit=unit)

    @classmethod
    def _of(
        cls, unit: str, *, xx: float, yy: float, zz: float, xy: float, xz: float, yz: float,
        shears: Sequence[float],
    ) -> ElasticConstants:  # fmt: skip
        """Constants of an orthorhombic crystal: all symmetries named here are special cases."""
        c = [checks.number(x, "c", ElasticityError) for x in (xx, yy, zz, xy, xz, yz, *shears)]
        matrix = np.diag([*c[:3], *c[6:]]).astype(float)
        for (i, j), value in zip(((0, 1), (0, 2), (1, 2)), c[3:6], strict=True):
            matrix[i, j] = matrix[j, i] = value
        return cls(matrix, unit)

    @cached_property
    def tensor(self) -> np.ndarray:
        """C_ijkl, shape (3, 3, 3, 3): stress_ij = C_ijkl strain_kl."""
        return np.asarray(self.voigt)[_NUMBER[:, :, None, None], _NUMBER[None, None]]

    def rotated(self, rotation: Sequence[Sequence[float]] | np.ndarray) -> ElasticConstants:
        """The constants of the crystal after a rotation R: C'_ijkl = R_ia R_jb R_kc R_ld C_abcd.

        Parameters
        ----------
        rotation
            R, shape (3, 3); its columns are the axes of the crystal in the sample.

        Raises
        ------
        ElasticityError
            R is not a rotation.

        Examples
        --------
        >>> copper = ElasticConstants.cubic(168.4, 121.4, 75.4)
        >>> turned = copper.rotated([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
        >>> turned == copper
        True
        """
        r = checks.array(rotation, "rotation", ElasticityError, shape=(3, 3))
        if np.abs(r @ r.T - np.eye(3)).max() > PRINTED:
            raise ElasticityError(
                f"rotation: expected an orthogonal matrix, got {checks.shown(r.tolist())}. Its "
                "columns are orthogonal unit vectors."
            )
        turned = np.einsum("ia,jb,kc,ld,abcd->ijkl", r, r, r, r, self.tensor, optimize=True)
        one, two = np.array(PAIRS).T
        return ElasticConstants(turned[one[:, None], two[:, None], one, two], self.unit)

    def stress(self, strain: np.ndarray) -> np.ndarray:
        """C_ijkl strain_kl for fields of shape (3, 3, ...)."""
        return np.tensordot(self.tensor, strain, 2)

    def strain(self, stress: np.ndarray) -> np.ndarray:
        """The strain of a stress, shape (3, 3) both: the inverse of `stress`."""
        column = np.array([stress[i, j] for i, j in PAIRS])
        e = np.linalg.solve(np.asarray(self.voigt), column)
        e[3:] /= 2
        return e[_NUMBER]

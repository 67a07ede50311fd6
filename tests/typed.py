"""Metrics and frames as people type them, with their truth (data/as_typed.toml)."""

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import geomtorsion as gt

FILE = Path(__file__).parent / "data" / "as_typed.toml"


@dataclass(frozen=True)
class Typed:
    """One row of the table; see the file for the fields."""

    name: str
    coordinates: str
    symmetries: int
    parameters: str = ""
    diagonal: tuple[str, ...] = ()
    metric: tuple = ()
    coframe: tuple = ()
    signature: str = ""
    space: str = ""
    values: dict[str, str] = field(default_factory=dict)
    curvature: str = ""
    words: tuple[str, ...] = ()
    undecided: tuple[str, ...] = ()
    same: str = ""
    different: str = ""
    functions: str = ""
    slow: bool = False

    @property
    def frame(self) -> gt.Frame:
        """The frame, without domain and without assumptions."""
        return self.within()

    def within(self, domain: str | None = None) -> gt.Frame:
        """The frame with a domain."""
        constants = self.parameters or None
        if self.coframe:
            return gt.Frame(
                self.coordinates,
                self.coframe,
                self.signature,
                domain=domain,
                parameters=constants,
            )
        n = len(self.coordinates.split())
        rows = self.metric or [
            [self.diagonal[i] if i == k else "0" for k in range(n)] for i in range(n)
        ]
        return gt.Frame.from_metric(self.coordinates, rows, domain=domain, parameters=constants)


ROWS = tuple(Typed(**row) for row in tomllib.loads(FILE.read_text())["row"])

"""Price list: what digits, certainty and effects cost in time and memory, in one table."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar

from geomtorsion.errors import AccuracyError, UnknownNameError
from geomtorsion.prices.offer import Bounds
from geomtorsion.support import checks
from geomtorsion.support.budget import TimeModel
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.files import write_text
from geomtorsion.support.outgoing import csv_cell, duration_text, size_text

HEAD = ("way", "requested", "claimed", "true", "claimed/true", "time", "spread", "memory")


@dataclass(frozen=True)
class PriceRow:
    """Measured cost and error of one way at one accuracy.

    way: name of the row: an engine, a rule or a proof. certainty: "plain", "estimate" or "proof".
    requested: accuracy (or spacing of a grid). claimed: relative error that the run claims.
    true: bounds of the true relative error; None if unknown.
    seconds: processor time of the fastest run; NaN if it failed.
    spread: (median - fastest) / fastest.
    memory: peak of what Python and NumPy allocated, in bytes; None where it was not measured,
        and for proofs, whose balls FLINT allocates.
    note: the reason for a missing result, or empty.
    engine: name of the engine or rule, the same in rows of each certainty.
    """

    way: str
    certainty: str
    requested: float
    claimed: float | None = None
    true: Bounds | None = None
    seconds: float = math.nan
    spread: float = 0.0
    memory: int | None = None
    note: str = ""
    engine: str = ""

    @property
    def measured(self) -> bool:
        """Whether there is a result."""
        return not math.isnan(self.seconds)

    @property
    def holds(self) -> bool | None:
        """Whether the true error is within the claimed one; None where the bounds do not decide."""
        if self.claimed is None or self.true is None:
            return None
        if self.true.high <= self.claimed:
            return True
        return False if self.true.low > self.claimed else None

    @property
    def reached(self) -> bool:
        """Whether the true error is certainly within the request."""
        return self.true is not None and self.true.high <= self.requested

    @property
    def calibration(self) -> float | None:
        """Claimed over true error: 1 is perfect, below 1 is wrong, far above 1 is wasteful."""
        if self.claimed is None or self.true is None or not self.true.high:
            return None
        return self.claimed / self.true.high

    def cells(self) -> tuple[str, ...]:
        """The row as text, in the order of the head of the table."""
        start = (self.way, f"{self.requested:.3g}" if self.requested else "-")
        if not self.measured:
            return (*start, self.note, *[""] * (len(HEAD) - 3))
        ratio = self.calibration
        return (
            *start,
            "-" if self.claimed is None else size_text(self.claimed),
            "-" if self.true is None else _bounds_text(self.true),
            "-" if ratio is None else f"{ratio:.3g}",
            duration_text(self.seconds),
            f"{100 * self.spread:.0f} %",
            "-" if self.memory is None else f"{self.memory / 1024:.0f} kB",
        )


def _bounds_text(true: Bounds) -> str:
    """One number where both bounds agree in two digits, otherwise the upper bound."""
    upper = size_text(true.high)
    return upper if size_text(true.low) == upper else f"<= {upper}"


@dataclass(frozen=True)
class Choice:
    """The rows that a recommendation compares; None where there is none.

    best: the fastest with an error estimate at the finest accuracy that is reached; second: the
    next one. loose: the coarsest request of the same way. plain: the same engine without an error
    estimate. proofs: all that reach their request.
    """

    best: PriceRow | None = None
    second: PriceRow | None = None
    loose: PriceRow | None = None
    plain: PriceRow | None = None
    proofs: tuple[PriceRow, ...] = ()


@dataclass(frozen=True)
class PriceList:
    """Cost of one result: digits, certainty, effects.

    name: of the result. truth: what the true errors are measured against.
    rows: one for each way and accuracy, finer ones later.
    effects: (name, seconds) of a scene with its effects added one by one.
    unit: of requests: "accuracy", or "spacing" of a grid.
    floor: relative error from noise, beyond which finer requests gain nothing; None: no noise.
    """

    name: str
    truth: str
    rows: tuple[PriceRow, ...]
    effects: tuple[tuple[str, float], ...] = ()
    unit: str = "accuracy"
    floor: float | None = None

    @property
    def ways(self) -> tuple[str, ...]:
        """Names of the ways, in order."""
        return tuple(dict.fromkeys(row.way for row in self.rows))

    def of(self, way: str | None = None) -> tuple[PriceRow, ...]:
        """Rows with results of one way; by default the fastest with an error estimate.

        Raises
        ------
        UnknownNameError
            No way has this name.
        AccuracyError
            The way has no result.
        """
        if way is not None and way not in self.ways:
            raise UnknownNameError(
                f"way: expected one of {', '.join(self.ways)}, got {checks.shown(way)}."
            )
        name = way or self._fastest
        rows = tuple(row for row in self.rows if row.way == name and row.measured)
        if not rows:
            notes = [row.note for row in self.rows if row.way == name]
            raise AccuracyError(
                f"way: expected one with results, got {name or 'no way'}, which has none: "
                f"{notes[-1] if notes else 'no rows'}. Request less."
            )
        return rows

    @property
    def _fastest(self) -> str:
        """The fastest way to the finest accuracy that a way with an estimate reaches."""
        rows = [row for row in self.rows if row.measured]
        checked = [row for row in rows if row.certainty == "estimate"] or rows
        good = [row for row in checked if row.reached] or checked
        if not good:
            return self.ways[0] if self.ways else ""
        return min(good, key=lambda row: (row.requested, row.seconds)).way

    def plain(self, row: PriceRow) -> PriceRow | None:
        """The run of the same engine at the same accuracy without error estimate, if any."""
        same = (row.engine, row.requested)
        return next(
            (
                other
                for other in self.rows
                if other.certainty == "plain"
                and (other.engine, other.requested) == same
                and other.measured
            ),
            None,
        )

    def model(self, way: str | None = None) -> TimeModel:
        """Time of d digits, a + b d + c d^2, through three rows of a way."""
        rows = self.of(way)
        digits = [-math.log10(row.requested) if row.requested else 0.0 for row in rows]
        return TimeModel.of(digits, [row.seconds for row in rows])

    def seconds(self, accuracy: float, way: str | None = None) -> float:
        """Predicted processor time for an accuracy.

        Raises
        ------
        AccuracyError
            accuracy is not a positive number, or finer than the finest row, beyond which nothing
            was measured.
        """
        size = checks.positive(accuracy, "accuracy", AccuracyError)
        model = self.model(way)
        if -math.log10(size) > model.digits[-1] + 0.5 / 10:
            raise AccuracyError(
                f"accuracy: expected {10.0 ** -model.digits[-1]:.0e} or more, the finest row, got "
                f"{size:.3g}. Measure the price with accuracies that include it."
            )
        return model.at(-math.log10(size))

    def accuracy(self, seconds: float, way: str | None = None) -> float:
        """The smallest error, in the range of the rows, that a processor time buys.

        Raises
        ------
        AccuracyError
            seconds is not a positive number, or less than the coarsest row takes.
        """
        size = checks.positive(seconds, "seconds", AccuracyError)
        model = self.model(way)
        digits = model.digits_for(size)
        if digits is None:
            raise AccuracyError(
                f"seconds: expected at least {duration_text(min(model.seconds))}, the time of the "
                f"cheapest row, got {duration_text(size)}. Give more time."
            )
        return 10.0**-digits

    def misfit(self, way: str | None = None) -> float:
        """Largest ratio of predicted and measured time in rows that do not make the model."""
        model = self.model(way)
        ratios = [1.0]
        for row in self.of(way):
            if row.requested:
                ratio = model.at(-math.log10(row.requested)) / row.seconds
                ratios.append(max(ratio, 1 / ratio))
        return max(ratios)

    @property
    def recommendation(self) -> str:
        """The fastest way to the finest accuracy, and what less and more cost; a line each."""
        if self.unit != "accuracy":
            return self._wall
        chosen = self.choice
        best, loose, proofs = chosen.best, chosen.loose, chosen.proofs
        if best is None:
            if proofs:
                each = (
                    f"{size_text(r.requested, 0)} in {duration_text(r.seconds)}" for r in proofs
                )
                return f"Proofs: {', '.join(each)}."
            return "No way reaches these accuracies; request less."
        text = f"Take {best.way}: {size_text(best.requested, 0)} in {duration_text(best.seconds)}"
        if chosen.second:
            ratio = chosen.second.seconds / best.seconds
            text += f", {ratio:.2g} times faster than {chosen.second.way}"
        lines = [text]
        if loose:
            part = 100 * loose.seconds / best.seconds
            lines.append(f"{size_text(loose.requested, 0)} takes {part:.0f} % of this time")
        if chosen.plain:
            part = 100 * chosen.plain.seconds / best.seconds
            lines.append(f"Without an error estimate it takes {part:.0f} %")
        if proofs:
            ratio = proofs[0].seconds / best.seconds
            digits = size_text(proofs[0].requested, 0)
            lines.append(f"A proof to {digits} takes {ratio:.2g} times as long")
        return "\n".join(f"{line}." for line in lines)

    @property
    def choice(self) -> Choice:
        """The rows that the recommendation compares."""
        rows = [row for row in self.rows if row.reached]
        checked = [row for row in rows if row.certainty == "estimate"]
        proofs = tuple(row for row in rows if row.certainty == "proof")
        if not checked:
            return Choice(proofs=proofs)
        finest = min(row.requested for row in checked)
        best, *others = sorted(
            (row for row in checked if row.requested == finest), key=lambda row: row.seconds
        )
        loose = self.of(best.way)[0]
        return Choice(
            best,
            others[0] if others else None,
            loose if loose.requested > finest else None,
            self.plain(best),
            proofs,
        )

    @property
    def _wall(self) -> str:
        """How the noise limits a grid."""
        if not self.floor:
            return "No noise is known."
        return (
            f"Noise: {size_text(self.floor)} of the largest component, which a smaller spacing "
            "does not reduce."
        )

    @property
    def table(self) -> list[tuple[str, ...]]:
        """Head and rows as text; without the column of memory where none was measured."""
        rows = [HEAD, *(row.cells() for row in self.rows)]
        if any(row.memory is not None for row in self.rows):
            return rows
        return [row[:-1] for row in rows]

    def __str__(self) -> str:
        table = self.table
        count = len(table[0])
        # Notes go beyond their column.
        widths = [max(len(cells[k]) for cells in table if k < 2 or cells[-1]) for k in range(count)]
        lines = [self.name, f"true errors against {self.truth}"]
        for cells in table:
            start = f"{cells[0]:<{widths[0]}}  {cells[1]:>{widths[1]}}"
            if not cells[-1]:
                lines.append(f"{start}  {cells[2]}")
                continue
            rest = (f"{cell:>{width}}" for cell, width in zip(cells[2:], widths[2:], strict=True))
            lines.append("  ".join([start, *rest]))
        lines += [f"with {name}: {duration_text(seconds)}" for name, seconds in self.effects]
        return "\n".join([*lines, self.recommendation])

    __repr__ = __str__
    _repr_html_ = drawn_by("prices", "price_html")
    plot: ClassVar[Plot] = figure_by("prices", "draw_price")

    def to_json(self) -> dict[str, Any]:
        """The list as a JSON-ready mapping."""
        return asdict(self) | {
            "rows": [
                asdict(row)
                | {
                    "seconds": row.seconds if row.measured else None,
                    "true": None if row.true is None else list(row.true),
                    "holds": row.holds,
                    "calibration": row.calibration,
                }
                for row in self.rows
            ],
            "recommendation": self.recommendation,
        }

    def csv_text(self) -> str:
        """The rows as CSV text; numbers read back as the same doubles."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        names = ("way", "certainty", "requested", "claimed", "true_low", "true_high", "seconds")
        writer.writerow((*names, "spread", "memory", "note", "engine"))
        for row in self.rows:
            low, high = row.true or ("", "")
            values = (row.claimed, low, high, row.seconds, row.spread, row.memory)
            cells = ["" if value is None else str(value) for value in values]
            start = (csv_cell(row.way), row.certainty, str(row.requested))
            writer.writerow((*start, *cells, csv_cell(row.note), csv_cell(row.engine)))
        return text.getvalue()

    def to_csv(self, path: str | Path) -> None:
        """Write the rows as a CSV file."""
        write_text(checks.file_name(path), self.csv_text())

"""A window that was measured on a robot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ._ends import Gap


@dataclass(frozen=True)
class Measurement:
    """A measured window: each end is where half of the attempts insert, mm from the taught start.

    An interval holds its end with 95 % probability. An end that was not met up to the limit, or before
    ``attempts_max`` were made, is ``None``. ``failure_negative`` and ``failure_positive`` are the classes
    met most beyond the ends. ``gaps`` are starts within the window that do not insert; the ends lie beyond
    them. ``settled`` is whether both ends are known as asked; ``doubtful`` of the ``attempts`` do not count.
    """

    negative_mm: float | None
    positive_mm: float | None
    negative_interval_mm: tuple[float, float] | None
    positive_interval_mm: tuple[float, float] | None
    failure_negative: int | None
    failure_positive: int | None
    gaps: tuple[Gap, ...]
    #: The farthest starts that inserted.
    inserted_mm: tuple[float, float]
    peak_force_n: float
    attempts: int
    doubtful: int
    settled: bool
    #: One line of JSON for each attempt.
    log: Path

    @property
    def range_mm(self) -> float | None:
        """Width of the window, mm, if both ends were met."""
        if self.negative_mm is None or self.positive_mm is None:
            return None
        return round(self.positive_mm - self.negative_mm, 2)

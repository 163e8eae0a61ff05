"""Tolerance window measured on a robot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ._ends import Gap


@dataclass(frozen=True)
class Measurement:
    """Measured window: each end is the start from which half of the attempts insert, mm from the taught start.

    An interval contains its end with 95 % probability. An end that was not reached up to the limit, or within
    ``attempts_max``, is ``None``. ``failure_negative`` and ``failure_positive`` are the most frequent failure classes
    beyond the ends. ``gaps`` are starts within the window that do not insert; the ends lie beyond them. ``settled`` is
    whether both ends reached the requested resolution; ``doubtful`` of the ``attempts`` do not count.
    """

    negative_mm: float | None
    positive_mm: float | None
    negative_interval_mm: tuple[float, float] | None
    positive_interval_mm: tuple[float, float] | None
    failure_negative: int | None
    failure_positive: int | None
    gaps: tuple[Gap, ...]
    #: Farthest starts that inserted, negative and positive, mm.
    inserted_mm: tuple[float, float]
    peak_force_n: float
    attempts: int
    doubtful: int
    settled: bool
    #: File of the attempts: a first line of settings, then one JSON line each.
    log: Path

    @property
    def range_mm(self) -> float | None:
        """Width of the window, mm; ``None`` if an end was not reached."""
        if self.negative_mm is None or self.positive_mm is None:
            return None
        return round(self.positive_mm - self.negative_mm, 2)

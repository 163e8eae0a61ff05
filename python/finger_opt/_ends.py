"""The ends of a tolerance window, from attempts that go either way near them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Prior of an end's width, over which the probability to insert goes from 90 to 10 %: log-normal, by its
#: median, mm, and the factor that is a standard deviation. The prior of its place is uniform, from the
#: taught start to a step beyond the limit.
WIDTH_MM, WIDTH_FACTOR = 0.4, 2.0
#: Share of attempts that go wrong for reasons which no place tells.
LAPSE = 0.01
#: Prior probability of a gap on one side, and odds from which one is taken for it.
GAP, TAKEN = 0.02, 10.0
#: What the intervals hold.
INTERVAL = 0.95

_WIDTHS_MM: Floats = WIDTH_MM * WIDTH_FACTOR ** np.linspace(-2.5, 2.5, 13, dtype=np.float64)
#: The logistic's scale for 1 mm from 10 to 90 %.
_SCALE = 1.0 / (2.0 * float(np.log(9.0)))


@dataclass(frozen=True)
class Search:
    """Where is tried; lengths in mm."""

    step_mm: float
    resolution_mm: float
    limit_mm: float
    repeats: int


@dataclass(frozen=True)
class Gap:
    """Starts within the window that do not insert, narrower than two steps of the walk.

    ``failed_mm`` are the first and the last start that failed, ``within_mm`` the nearest that inserted on
    both sides; ``failure`` is the class.
    """

    failed_mm: tuple[float, float]
    within_mm: tuple[float, float]
    failure: int | None = None


@dataclass
class Tally:
    """The attempts from one start."""

    first: bool
    inserted: int = 0
    failed: int = 0


@dataclass
class Side:
    """One end of the window: lengths are mm outward from the taught start."""

    search: Search
    sign: int
    #: Starts and whether they inserted, in the order of the attempts.
    tried: Iterable[tuple[float, bool]]
    #: Runs of starts that are gaps.
    gaps: list[list[float]] = field(default_factory=list[list[float]])
    #: A start in or beyond what may be a gap: to be tried once more.
    doubtful: float | None = None

    def __post_init__(self) -> None:
        search = self.search
        self.tallies: dict[float, Tally] = {}
        for offset, inserted in self.tried:
            if self.sign * offset >= 0.0:
                tally = self.tallies.setdefault(abs(offset), Tally(inserted))
                tally.inserted += inserted
                tally.failed += not inserted
        spacing = search.resolution_mm / 5.0
        self.grid: Floats = np.arange(0.0, search.limit_mm + search.step_mm, spacing, dtype=np.float64)
        widths = np.exp(-0.5 * (np.log(_WIDTHS_MM / WIDTH_MM) / np.log(WIDTH_FACTOR)) ** 2)
        self._prior: Floats = np.log(widths / widths.sum() / len(self.grid))[None, :]
        self._find_gaps()
        left_out = {start for run in self.gaps for start in run}
        log = self._log(left_out)
        joint = np.exp(log - log.max())
        self.joint: Floats = joint / joint.sum()
        self.place: Floats = self.joint.sum(axis=1)

    def _inserts(self, starts: Floats) -> Floats:
        """Probability to insert from these starts, for each place and width of the end."""
        away = (self.grid[None, :, None] - starts[:, None, None]) / (_SCALE * _WIDTHS_MM)
        inserts: Floats = LAPSE + (1.0 - 2.0 * LAPSE) / (1.0 + np.exp(-np.clip(away, -50.0, 50.0)))
        return inserts

    def _log(self, left_out: set[float]) -> Floats:
        """Logarithm of prior times likelihood, without the attempts from some starts."""
        kept = {start: tally for start, tally in self.tallies.items() if start not in left_out}
        inserts = self._inserts(np.array(list(kept)))
        inserted = np.array([tally.inserted for tally in kept.values()])[:, None, None]
        failed = np.array([tally.failed for tally in kept.values()])[:, None, None]
        log: Floats = self._prior + (inserted * np.log(inserts) + failed * np.log1p(-inserts)).sum(axis=0)
        return log

    def _find_gaps(self) -> None:
        """Takes for a gap what fails within the window, where one end alone would hardly do that."""
        for run in self._runs():
            known = {start for gap in self.gaps for start in gap}
            alone, with_gap = self._log(known), self._log(known | set(run))
            failures = sum(self.tallies[start].failed for start in run)
            odds = GAP * (1.0 - LAPSE) ** failures * np.exp(_total(with_gap) - _total(alone))
            if odds > TAKEN:
                self.gaps.append(run)
            elif odds > 1.0:
                # Of a gap, what fails and what inserts beyond it tell by turns.
                beyond = min(start for start, tally in self.tallies.items() if tally.inserted and start > run[-1])
                again = failures > self.tallies[beyond].inserted + self.tallies[beyond].failed
                self.doubtful = beyond if again else run[len(run) // 2]

    def _runs(self) -> list[list[float]]:
        """Neighbouring starts that always failed, with one beyond that inserted."""
        runs: list[list[float]] = [[]]
        for start in sorted(self.tallies):
            if self.tallies[start].inserted:
                runs.append([])
            else:
                runs[-1].append(start)
        return [run for run in runs[:-1] if run]

    def walk(self) -> float | None:
        """The next start of the coarse walk outward, which ends with two failures in a row or at the limit."""
        return self._walked()[0]

    @property
    def open(self) -> bool:
        """Whether the walk came no farther than to starts that inserted: the end lies beyond them."""
        return self._walked()[1] == 0

    def _walked(self) -> tuple[float | None, int]:
        """The walk's next start, and how many failed in a row at its end; what came first counts."""
        failed, steps = 0, 0
        while failed < 2:
            steps += 1
            start = round(steps * self.search.step_mm, 6)
            if start > self.search.limit_mm + 1e-9:
                break
            if start not in self.tallies:
                return start, failed
            failed = 0 if self.tallies[start].first else failed + 1
        return None, failed

    @property
    def farthest(self) -> float:
        """The farthest start that inserted."""
        return max((start for start, tally in self.tallies.items() if tally.inserted), default=0.0)

    def quantile(self, share: float) -> float:
        return float(np.interp(share, np.cumsum(self.place), self.grid))

    @property
    def deviation(self) -> float:
        mean = float(self.place @ self.grid)
        return float(np.sqrt(self.place @ (self.grid - mean) ** 2))

    @property
    def settled(self) -> bool:
        """Whether the end is known to the resolution, with enough attempts on both sides of it."""
        middle, step = self.quantile(0.5), self.search.step_mm
        gaps = {start for run in self.gaps for start in run}
        near = {s: t for s, t in self.tallies.items() if abs(s - middle) <= step and s not in gaps}
        inside = sum(tally.inserted for start, tally in near.items() if start <= middle)
        outside = sum(tally.failed for start, tally in near.items() if start >= middle)
        enough = min(inside, outside) >= self.search.repeats
        return self.open or (enough and self.deviation <= self.search.resolution_mm)

    def telling(self) -> float:
        """The start, a multiple of the resolution, whose outcome is expected to tell most of the end's place."""
        step, search = self.search.resolution_mm, self.search
        low = max(0, int((self.quantile(0.01) - search.step_mm) / step))
        high = min(self.quantile(0.99) + search.step_mm, search.limit_mm)
        starts: Floats = step * np.arange(low, int(high / step + 1e-9) + 1, dtype=np.float64)
        if not len(starts):
            return search.limit_mm
        given = np.einsum("sbw,bw->sb", self._inserts(starts), self.joint)
        given = given / np.maximum(self.place, 1e-300)
        information = _entropy(given @ self.place) - _entropy(given) @ self.place
        return round(float(starts[np.argmax(information)]), 6)


def _total(log: Floats) -> float:
    top = log.max()
    return float(top + np.log(np.exp(log - top).sum()))


def _entropy(share: Floats) -> Floats:
    share = np.clip(share, 1e-12, 1.0 - 1e-12)
    return -(share * np.log(share) + (1.0 - share) * np.log1p(-share))


class Window:
    """What is known of a window, and where to try next; of starts in mm, and whether they inserted."""

    def __init__(self, search: Search, tried: list[tuple[float, bool]]) -> None:
        self.search = search
        self.start = [inserted for offset, inserted in tried if offset == 0.0]
        self.sides = [Side(search, sign, tried) for sign in (-1, 1)] if self.inserts else []

    @property
    def inserts(self) -> bool:
        """Whether the taught start has inserted."""
        return any(self.start)

    def next(self) -> float | None:
        """The next start, mm; none when both ends are known, or the taught start does not insert."""
        if not self.inserts:
            return 0.0 if len(self.start) < self.search.repeats else None
        walked = [(side.sign, side.walk()) for side in self.sides]
        doubtful = [(side.sign, side.doubtful) for side in self.sides]
        for sign, start in (*walked, *doubtful):
            if start is not None:
                return sign * start
        unsettled = [side for side in self.sides if not side.settled]
        if not unsettled:
            return None
        side = max(unsettled, key=lambda side: side.deviation)
        return side.sign * side.telling()
